//! The seeds of the fuzz targets obey the laws that the targets hold against any bytes (`docs/fuzzing.md`).

use std::fs;
use std::path::{Path, PathBuf};

#[path = "laws/mod.rs"]
mod laws;

fn seeds() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join("fuzz/seeds")
}

/// The seeds of a target, by name.
fn files(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = seeds().join(target);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<_> = entries
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap()))
        .collect();
    files.sort();
    files
}

fn hold(target: &str) {
    let (_, law) = laws::ALL.into_iter().find(|(name, _)| *name == target).unwrap();
    let files = files(target);
    assert!(files.len() >= 10, "{target} has {} seeds", files.len());
    for (name, data) in files {
        assert!(std::panic::catch_unwind(|| law(&data)).is_ok(), "the seed {target}/{name} breaks the law");
        // So do its beginnings.
        for len in (0..data.len()).step_by(1 + data.len() / 16) {
            law(&data[..len]);
        }
    }
}

#[test]
fn intake() {
    hold("intake");
}

#[test]
fn splitter() {
    hold("splitter");
}

#[test]
fn rtu() {
    hold("rtu");
}

#[test]
fn ascii() {
    hold("ascii");
}

#[test]
fn pdu() {
    hold("pdu");
}

#[test]
fn profile() {
    hold("profile");
}

#[test]
fn transcript() {
    hold("transcript");
}

#[test]
fn each_target_has_a_law_a_file_and_seeds_and_nothing_else_has() {
    let names = |folder: PathBuf| {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    let mut targets: Vec<String> = laws::ALL.iter().map(|(name, _)| (*name).to_owned()).collect();
    targets.sort();
    assert_eq!(names(seeds()), targets);
    let files: Vec<String> = targets.iter().map(|name| format!("{name}.rs")).collect();
    assert_eq!(names(seeds().join("../fuzz_targets")), files);
    let size: usize = targets.iter().flat_map(|target| self::files(target)).map(|(_, data)| data.len()).sum();
    assert!(size < 200_000, "{size} bytes of seeds");
}
