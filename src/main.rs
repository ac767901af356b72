//! The first program: shell, Live page and engine.

fn main() {
    buslens::run();
}
