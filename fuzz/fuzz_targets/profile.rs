//! Device profiles and registers. The law stands in `codec/tests/laws`.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| buslens_fuzz::check(env!("CARGO_BIN_NAME"), data));
