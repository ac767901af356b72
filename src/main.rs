//! App.
use leptos::prelude::*;
use wasm_bindgen::prelude::*;
#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = console)]
    fn log(s: &str);
    /// SerialPort
    type SerialPort;
    #[wasm_bindgen(method, getter)]
    fn readable(this: &SerialPort) -> Option<js_sys::Object>;
}
fn main() {
    log("x");
    leptos::mount::mount_to_body(|| view! { <p>"hi"</p> });
}
