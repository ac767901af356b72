//! A toolchain for wasm32: rustup's or the system's own, and on Debian one that compiles the standard library itself.

use std::env;
use std::path::Path;
use std::process::Command;

use anyhow::Result;

use crate::machine::{self, Missing};

/// The target of the site.
pub(crate) const TARGET: &str = "wasm32-unknown-unknown";

/// What Debian needs: its newest compiler, the standard library's source and a linker.
const DEBIAN_PACKAGES: &[&str] = &["rustc-web", "cargo-web", "rust-web-src", "lld"];

/// A toolchain that compiles for [`TARGET`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wasm {
    /// The one that runs this program: it has the target.
    Own,
    /// Debian's, which compiles the standard library from source.
    Debian,
}

impl Wasm {
    /// Finds or installs a toolchain; `debian_std` takes Debian's even if the target is there.
    pub(crate) fn find(debian_std: bool) -> Result<Self> {
        if !debian_std {
            if target_is_there() {
                println!("toolchain: the installed target {TARGET}");
                return Ok(Self::Own);
            }
            if machine::which("rustup").is_some() {
                println!("toolchain: rustup target add {TARGET}");
                let added = machine::run(Command::new("rustup").args(["target", "add", TARGET]));
                if added.is_ok() && target_is_there() {
                    return Ok(Self::Own);
                }
                println!("toolchain: rustup could not add {TARGET}");
            }
        }
        if machine::is_debian() {
            println!("toolchain: Debian's {}, the standard library from source", DEBIAN_PACKAGES.join(", "));
            machine::install(DEBIAN_PACKAGES)?;
            return Ok(Self::Debian);
        }
        Err(Missing(format!("the Rust target {TARGET} is missing: install it with `rustup target add {TARGET}`"))
            .into())
    }

    /// A cargo command such as `build` for [`TARGET`] in the project's folder.
    pub(crate) fn cargo(self, subcommand: &str) -> Command {
        let mut command = match self {
            Self::Own => machine::cargo(),
            Self::Debian => debian("/usr/bin/cargo"),
        };
        command.args([subcommand, "--locked", "--target", TARGET, "--target-dir", "target/wasm"]);
        command
    }

    /// `cargo clippy` for [`TARGET`].
    pub(crate) fn clippy(self) -> Result<Command> {
        match self {
            Self::Own => Ok(self.cargo("clippy")),
            Self::Debian => {
                machine::install(&["rust-web-clippy"])?;
                // Called by its path: cargo would look into rustup's folder first.
                let mut command = debian("/usr/bin/cargo-clippy");
                command.env("CARGO", "/usr/bin/cargo");
                command.args(["clippy", "--locked", "--target", TARGET, "--target-dir", "target/wasm"]);
                Ok(command)
            }
        }
    }
}

fn target_is_there() -> bool {
    machine::output(Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]))
        .is_ok_and(|folder| Path::new(&folder).is_dir())
}

/// A program of Debian's toolchain, free of what rustup and the outer cargo have set.
fn debian(program: &str) -> Command {
    let mut command = Command::new(program);
    command.current_dir(machine::root());
    for (key, _) in env::vars_os() {
        let name = key.to_string_lossy();
        let inherited = ["CARGO", "RUSTC", "RUSTDOC", "RUSTC_WRAPPER", "LD_LIBRARY_PATH", "RUST_RECURSION_COUNT"];
        let prefixes = ["RUSTUP_", "CARGO_PKG_", "CARGO_MANIFEST_"];
        if inherited.contains(&&*name) || prefixes.iter().any(|prefix| name.starts_with(prefix)) {
            command.env_remove(&key);
        }
    }
    let path = env::var("PATH").unwrap_or_default();
    command
        .env("PATH", format!("/usr/bin:{path}"))
        .env("RUSTC", "/usr/bin/rustc")
        // Building the standard library is not stable; only this child is told to do it all the same.
        .env("RUSTC_BOOTSTRAP", "1")
        .env("CARGO_UNSTABLE_BUILD_STD", "std,panic_abort")
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", "wasm-ld");
    command
}
