//! Packs the built-in profiles, so that the first program carries no loader of profiles' files.

use std::{env, fs, path::Path};

use buslens_codec::profile::{BUILT_IN, Profile};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let folder = env::var_os("OUT_DIR").expect("cargo names a folder for what is built");
    let packed: Vec<Vec<u8>> = BUILT_IN
        .iter()
        .map(|text| Profile::from_json(text).unwrap_or_else(|error| panic!("a built-in profile: {error}")).pack())
        .collect();
    let all = postcard::to_allocvec(&packed).expect("bytes can be packed");
    fs::write(Path::new(&folder).join("profiles"), all).expect("the folder can be written to");
}
