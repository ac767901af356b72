// Loads the third program; the engine's worker imports this. The build puts the generated bindings in front of this text and
// the real name into the address.
await start({ module_or_path: new URL("simulator.wasm", import.meta.url) });
