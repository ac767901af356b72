// Loads the second program with its style; the first one imports this. The build puts the generated bindings in front of
// this text and the real names into the addresses.
const style = document.createElement("link");
style.rel = "stylesheet";
style.href = new URL("workbench.css", import.meta.url).href;
const styled = new Promise((resolve, reject) => {
  style.onload = resolve;
  style.onerror = () => reject(new Error("the style did not load"));
});
document.head.append(style);
await Promise.all([styled, start({ module_or_path: new URL("workbench.wasm", import.meta.url) })]);
