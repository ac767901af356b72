//! Rules of the house that no compiler holds.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, PackageId};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

fn metadata() -> Metadata {
    MetadataCommand::new()
        .manifest_path(root().join("Cargo.toml"))
        .other_options(vec!["--locked".into()])
        .exec()
        .unwrap()
}

/// Files that git knows or would add, with their text; pictures and the like left out.
fn files() -> Vec<(String, String)> {
    let listed = Command::new("git")
        .args(["ls-files", "--cached", "--others", "--exclude-standard"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(listed.status.success(), "the project is a git checkout");
    let names = String::from_utf8(listed.stdout).unwrap();
    let texts = names.lines().filter_map(|name| Some((name.to_owned(), fs::read_to_string(root().join(name)).ok()?)));
    texts.collect()
}

fn sources(folders: &[&str]) -> Vec<(String, String)> {
    let in_folder = |name: &str| folders.iter().any(|folder| name.starts_with(folder));
    files()
        .into_iter()
        .filter(|(name, _)| Path::new(name).extension().is_some_and(|end| end == "rs") && in_folder(name))
        .collect()
}

/// Names of everything that `package` is built with, itself included.
fn built_with(metadata: &Metadata, package: &str) -> BTreeSet<String> {
    let resolve = metadata.resolve.as_ref().unwrap();
    let start = metadata.packages.iter().find(|found| found.name.as_str() == package).unwrap();
    let mut open: Vec<PackageId> = vec![start.id.clone()];
    let mut seen: BTreeSet<PackageId> = BTreeSet::new();
    while let Some(id) = open.pop() {
        if seen.insert(id.clone()) {
            let node = resolve.nodes.iter().find(|node| node.id == id).unwrap();
            let normal =
                |dep: &&cargo_metadata::NodeDep| dep.dep_kinds.iter().any(|kind| kind.kind == DependencyKind::Normal);
            open.extend(node.deps.iter().filter(normal).map(|dep| dep.pkg.clone()));
        }
    }
    metadata.packages.iter().filter(|found| seen.contains(&found.id)).map(|found| found.name.to_string()).collect()
}

#[test]
fn dependencies_point_from_app_to_bus_to_codec() {
    let metadata = metadata();
    let ours = |package: &str| -> BTreeSet<String> {
        let members: BTreeSet<String> =
            metadata.workspace_packages().iter().map(|member| member.name.to_string()).collect();
        built_with(&metadata, package).intersection(&members).cloned().collect()
    };
    assert_eq!(ours("buslens-codec"), ["buslens-codec"].map(String::from).into());
    assert_eq!(ours("buslens-bus"), ["buslens-bus", "buslens-codec"].map(String::from).into());
    let sequence = ["buslens-bus", "buslens-codec", "buslens-sequence"];
    assert_eq!(ours("buslens-sequence"), sequence.map(String::from).into());
    let configure = ["buslens-bus", "buslens-codec", "buslens-configure"];
    assert_eq!(ours("buslens-configure"), configure.map(String::from).into());
    let analyst = ["buslens-analyst", "buslens-bus", "buslens-codec", "buslens-configure", "buslens-sequence"];
    assert_eq!(ours("buslens-analyst"), analyst.map(String::from).into());
    let all = ["buslens", "buslens-analyst", "buslens-bus", "buslens-codec", "buslens-configure", "buslens-sequence"];
    assert_eq!(ours("buslens"), all.map(String::from).into());
}

#[test]
fn codec_and_bus_know_no_browser() {
    let metadata = metadata();
    for package in ["buslens-codec", "buslens-bus", "buslens-sequence", "buslens-configure"] {
        let all = built_with(&metadata, package);
        for browser in ["wasm-bindgen", "js-sys", "web-sys", "leptos"] {
            assert!(!all.contains(browser), "{package} is built with {browser}");
        }
    }
    let codec = fs::read_to_string(root().join("codec/src/lib.rs")).unwrap();
    assert!(codec.lines().any(|line| line == "#![no_std]"));
}

#[test]
fn nothing_below_the_app_reads_a_clock_or_sets_a_timer() {
    for (name, text) in sources(&["codec/", "bus/", "sequence/", "configure/"]) {
        for clock in ["std::time::Instant", "SystemTime", "Instant::now", "thread::sleep", "std::thread"] {
            assert!(!text.contains(clock), "{name}: {clock}");
        }
    }
}

#[test]
fn one_file_knows_web_serial() {
    for (name, text) in sources(&["src/", "analyst/"]).into_iter().filter(|(name, _)| name != "src/serial.rs") {
        for word in ["getPorts", "requestPort", "type SerialPort", "getReader", "getWriter", "usbVendorId"] {
            assert!(!text.contains(word), "{name}: {word}");
        }
    }
}

/// A device is data: its id stands in its profile, in tests, and where the simulated sensors are made.
#[test]
fn nothing_matches_on_a_devices_name() {
    let ids = files()
        .into_iter()
        .filter_map(|(name, _)| Some(name.strip_prefix("codec/profiles/")?.strip_suffix(".json")?.to_owned()));
    let ids: Vec<String> = ids.collect();
    assert!(!ids.is_empty());
    let simulated = "bus/src/sim/sensor.rs";
    let all = sources(&["src/", "bus/src/", "codec/src/", "sequence/src/", "configure/src/"]);
    assert!(all.iter().any(|(name, _)| name == simulated));
    for (name, text) in all.into_iter().filter(|(name, _)| name != simulated) {
        let code = text.split("#[cfg(test)]").next().unwrap();
        for id in &ids {
            assert!(!code.contains(&format!("\"{id}\"")), "{name}: {id}");
        }
    }
}

#[test]
fn nothing_is_left_for_later() {
    // Put together here, so that this file does not find itself.
    let words =
        [["TO", "DO"], ["FIX", "ME"], ["unimple", "mented!"], ["to", "do!("], ["db", "g!("]].map(|word| word.concat());
    for (name, text) in files().into_iter().filter(|(name, _)| name != "Cargo.lock" && !name.starts_with("LICENSE")) {
        for word in &words {
            assert!(!text.contains(word.as_str()), "{name}: {word}");
        }
    }
}

#[test]
fn files_fit_a_screenful_of_ideas() {
    for (name, text) in sources(&[""]) {
        let code = text.split("#[cfg(test)]").next().unwrap();
        let lines = code.lines().count();
        assert!(lines <= 560, "{name} has {lines} lines");
    }
}

#[test]
fn the_project_names_no_machine() {
    let folders = ["/work", "/root", "/home"].map(|folder| format!("{folder}/"));
    for (name, text) in files() {
        for folder in &folders {
            assert!(name.ends_with("house.rs") || !text.contains(folder.as_str()), "{name}: {folder}");
        }
    }
}

#[test]
fn every_package_takes_the_lints_of_the_workspace() {
    for package in [
        "Cargo.toml",
        "codec/Cargo.toml",
        "bus/Cargo.toml",
        "sequence/Cargo.toml",
        "configure/Cargo.toml",
        "analyst/Cargo.toml",
        "bench/Cargo.toml",
        "xtask/Cargo.toml",
        "tests/Cargo.toml",
    ] {
        let text = fs::read_to_string(root().join(package)).unwrap();
        assert!(text.contains("[lints]\nworkspace = true"), "{package}");
    }
    let workspace = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    assert!(workspace.contains("unsafe_code = \"forbid\""));
}
