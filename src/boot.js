// Starts the program in the window and in the worker that the window starts from this script's own address.
// The build puts the generated bindings in front of this text and the real name into the address.
const inWindow = typeof document !== "undefined";
const early = [];
const hold = (event) => early.push(event);
// What is loaded when it is first needed. A browser may remember that an address failed, so each further attempt has one of
// its own.
const later = (name) => {
  const address = new URL(name, import.meta.url).href;
  let attempts = 0;
  let coming = null;
  const failed = (error) => {
    coming = null;
    throw error;
  };
  return () => (coming ??= import(attempts++ ? `${address}?${attempts}` : address).catch(failed));
};
if (inWindow) {
  globalThis.buslensWorker = import.meta.url;
  globalThis.buslensAnalyst = new URL("analyst.js", import.meta.url).href;
  globalThis.buslensWorkbench = later("workbench.js");
} else {
  globalThis.buslensSimulator = later("simulator.js");
  // What the window says before the worker's program listens is kept for it.
  addEventListener("message", hold);
}
try {
  await start({ module_or_path: new URL("buslens.wasm", import.meta.url) });
  if (!inWindow) {
    removeEventListener("message", hold);
    for (const event of early) onmessage(event);
  }
} catch (error) {
  // A worker's error reaches the window as an event. A program that came far enough has drawn a page of its own.
  if (!inWindow || document.querySelector("body > :not(noscript)")) throw error;
  document.body.textContent =
    "Buslens could not start. Reload the page; if that does not help, use a current browser. " +
    `Buslens 无法启动。请重新加载页面；如果仍然无法启动，请使用新版浏览器。 (${error})`;
  console.error(error);
}
