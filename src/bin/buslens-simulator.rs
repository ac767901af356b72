//! The third program: the simulated line. The engine loads it into its worker and speaks with it as with a port.

use wasm_bindgen::prelude::*;

fn main() {
    buslens::simulator::start();
}

/// Takes a message of the engine at a time on the engine's clock, in microseconds, and answers it.
#[wasm_bindgen]
pub fn hear(now_us: f64, message: &[u8]) -> Vec<u8> {
    buslens::simulator::hear(now_us, message)
}
