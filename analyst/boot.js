// Starts the analyst in its worker. What the window says before its program listens is kept for it.
const early = [];
const hold = (event) => early.push(event);
addEventListener("message", hold);
await start({ module_or_path: new URL("analyst.wasm", import.meta.url) });
removeEventListener("message", hold);
for (const event of early) onmessage(event);
