//! What browser tests need: a browser, the site on a port, and the permission to use serial ports there.

use std::path::Path;
use std::process::{self, Command};
use std::sync::{Mutex, PoisonError};
use std::{env, fs, io};

use anyhow::{Context, Result, bail};

use crate::machine::{self, Missing};
use crate::site::FirstLoad;
use crate::{serve, site};

/// The first port that tests try.
const PORT: u16 = 8470;

/// Packages of Debian: the browser, its driver, simulated devices, glyphs for Chinese texts, and what reads captures.
const PACKAGES: &[&str] = &["chromium", "chromium-driver", "umockdev", "fonts-noto-cjk", "tshark"];

const PROGRAMS: &[&str] = &["chromium", "chromedriver", "umockdev-run", "tshark"];

const POLICY: &str = "/etc/chromium/policies/managed/buslens-tests.json";

/// A served site that a browser may use serial ports on, for as long as this lives.
pub(crate) struct Stage {
    url: String,
    first_load: FirstLoad,
    _permission: Permission,
}

impl Stage {
    /// Installs a browser where it is missing, builds the site and serves it.
    pub(crate) fn new(options: site::Options) -> Result<Self> {
        if machine::is_debian() {
            machine::install(PACKAGES)?;
        }
        let missing: Vec<_> = PROGRAMS.iter().copied().filter(|program| machine::which(program).is_none()).collect();
        if !missing.is_empty() {
            return Err(Missing(format!("not installed here: {}", missing.join(", "))).into());
        }
        let door = serve::open(PORT)?;
        let url = format!("http://localhost:{}", door.port());
        let folder = machine::root().join(format!("target/site-on-{}", door.port()));
        let first_load = site::build(options, &folder)?;
        door.serve_in_background(folder);
        println!("browser: the site is on {url}");
        Ok(Self { _permission: Permission::give(&url)?, first_load, url })
    }

    /// The site's origin, without a slash at the end.
    pub(crate) fn url(&self) -> &str {
        &self.url
    }

    /// How heavy the site is.
    pub(crate) fn first_load(&self) -> FirstLoad {
        self.first_load
    }
}

/// Takes pictures of the pages.
pub(crate) fn photos(options: site::Options) -> Result<()> {
    let stage = Stage::new(options)?;
    let album = machine::root().join("target/photos");
    fs::create_dir_all(&album)?;
    machine::run(program("photos").arg(stage.url()).arg(&album))?;
    println!("pictures: {}", album.display());
    Ok(())
}

/// Measures the page.
pub(crate) fn measure(options: site::Options) -> Result<()> {
    let stage = Stage::new(options)?;
    machine::run(program("measure").arg(stage.url()))
}

/// A program that drives the browser.
fn program(name: &str) -> Command {
    let mut cargo = machine::cargo();
    cargo.args(["run", "--locked", "--release", "--package", "buslens-tests", "--bin", name, "--"]);
    cargo
}

/// A policy of the browser that grants all serial ports to one origin. It is taken back when this is dropped, and when
/// the program is interrupted.
struct Permission;

/// Whether the policy is there. Held while it is written or removed.
static GIVEN: Mutex<bool> = Mutex::new(false);

impl Permission {
    fn give(url: &str) -> Result<Self> {
        ctrlc::set_handler(|| {
            take_back();
            process::exit(130);
        })?;
        let mut given = GIVEN.lock().unwrap_or_else(PoisonError::into_inner);
        *given = true;
        write_as_root(Path::new(POLICY), &policy(url)).context("cannot write the browser's policy")?;
        Ok(Self)
    }
}

impl Drop for Permission {
    fn drop(&mut self) {
        take_back();
    }
}

fn take_back() {
    let mut given = GIVEN.lock().unwrap_or_else(PoisonError::into_inner);
    if *given {
        match machine::run(machine::as_root("rm").args(["-f", POLICY])) {
            Ok(()) => *given = false,
            Err(error) => eprintln!("error: {POLICY} must be removed by hand: {error:#}"),
        }
    }
}

fn policy(url: &str) -> String {
    format!("{{\"SerialAllowAllPortsForUrls\": [\"{url}\"]}}\n")
}

/// Writes a file that everybody may read in a folder that only root may write to.
fn write_as_root(path: &Path, text: &str) -> Result<()> {
    let draft = env::temp_dir().join(format!("buslens-policy-{}", process::id()));
    fs::write(&draft, text)?;
    let placed = machine::run(machine::as_root("install").args(["-D", "--mode=644"]).arg(&draft).arg(path));
    match fs::remove_file(&draft) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => bail!(error),
        _ => placed,
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn policy_grants_serial_ports_to_one_origin() {
        assert_eq!(
            super::policy("http://localhost:8470"),
            "{\"SerialAllowAllPortsForUrls\": [\"http://localhost:8470\"]}\n"
        );
    }
}
