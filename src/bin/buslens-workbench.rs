//! The second program: explains and builds frames. The first loads it and tells it what to show.

use wasm_bindgen::prelude::*;

fn main() {}

/// Takes a message of the first program, with what comes beside it.
#[wasm_bindgen]
pub fn hear(message: &[u8], beside: JsValue) {
    buslens::workbench::hear(message, beside);
}
