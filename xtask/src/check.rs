//! The steps of `cargo xtask test`. All of them run, whatever the others say; the last line sums up.

use std::fmt::{self, Display, Formatter};
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Command, ExitCode, Stdio};
use std::str::FromStr;

use anyhow::{Context, Error, Result, anyhow};

use crate::browser::Stage;
use crate::libtest::Report;
use crate::machine::{self, Missing};
use crate::site;
use crate::toolchain::Wasm;

/// Part of the reason with which browser tests are ignored by a plain `cargo test`.
const BROWSER_TEST: &str = "needs a browser";

/// A step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// The format of the sources.
    Fmt,
    /// Lints, for this machine and for wasm32.
    Clippy,
    /// Unit, property and integration tests on this machine.
    Unit,
    /// The examples in the documentation.
    Doc,
    /// The protocol crates compile where there is no browser and no operating system.
    Bare,
    /// The built site in a real browser.
    Browser,
}

impl Step {
    /// All of them in the order in which they run.
    pub(crate) const ALL: [Self; 6] = [Self::Fmt, Self::Clippy, Self::Unit, Self::Doc, Self::Bare, Self::Browser];

    fn name(self) -> &'static str {
        match self {
            Self::Fmt => "fmt",
            Self::Clippy => "clippy",
            Self::Unit => "unit",
            Self::Doc => "doc",
            Self::Bare => "bare",
            Self::Browser => "browser",
        }
    }
}

impl FromStr for Step {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|step| step.name() == name).ok_or_else(|| anyhow!("there is no step `{name}`"))
    }
}

/// Runs `steps`, prints the summary as the last line and tells whether all is well.
pub(crate) fn run(options: site::Options, steps: &[Step]) -> ExitCode {
    let mut tally = Tally::default();
    for step in Step::ALL.into_iter().filter(|step| steps.contains(step)) {
        match step {
            Step::Fmt => tally.single("fmt", || machine::run(machine::cargo().args(["fmt", "--all", "--check"]))),
            Step::Clippy => {
                tally.single("clippy", clippy);
                tally.single("clippy for wasm32", || clippy_wasm(options));
            }
            Step::Unit => tally.tests("unit", || {
                let mut cargo = machine::cargo();
                cargo.args(["test", "--workspace", "--locked", "--no-fail-fast", "--lib", "--bins", "--tests"]);
                run_tests(&mut cargo)
            }),
            Step::Doc => tally.tests("doc", || {
                let mut cargo = machine::cargo();
                run_tests(cargo.args(["test", "--workspace", "--locked", "--no-fail-fast", "--doc"]))
            }),
            Step::Bare => tally.single("bare", || bare(options)),
            Step::Browser => {
                println!("==> site for the browser");
                match Stage::new(options) {
                    Ok(stage) => {
                        tally.single("size", || stage.first_load().check());
                        tally.tests("browser", || browser(&stage));
                    }
                    Err(error) => tally.error("browser", &error),
                }
            }
        }
    }
    // Whatever the children have written comes before this.
    let _ = io::stderr().flush();
    println!();
    for note in &tally.notes {
        println!("{note}");
    }
    println!("{tally}");
    if tally.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn clippy() -> Result<()> {
    let mut cargo = machine::cargo();
    cargo.args(["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"]);
    machine::run(&mut cargo)
}

fn clippy_wasm(options: site::Options) -> Result<()> {
    let mut clippy = Wasm::find(options.debian_std)?.clippy()?;
    machine::run(clippy.args(["--package", "buslens", "--package", "buslens-analyst", "--", "-D", "warnings"]))
}

fn bare(options: site::Options) -> Result<()> {
    let mut cargo = Wasm::find(options.debian_std)?.cargo("check");
    machine::run(cargo.args(["--package", "buslens-codec", "--package", "buslens-bus"]))
}

fn browser(stage: &Stage) -> Result<Report> {
    let mut cargo = machine::cargo();
    cargo.args(["test", "--package", "buslens-tests", "--locked", "--no-fail-fast", "--tests", "--", "--ignored"]);
    cargo.env("BUSLENS_SITE", stage.url());
    if std::env::var_os("RUST_TEST_THREADS").is_none() {
        // Each test has a browser of its own.
        cargo.env("RUST_TEST_THREADS", "2");
    }
    let report = run_tests(&mut cargo)?;
    if report.passed == 0 && report.failed.is_empty() {
        return Err(anyhow!("no browser test was found"));
    }
    Ok(report)
}

/// Runs test programs, shows what they print and reads it. An error means that something other than a test failed.
fn run_tests(command: &mut Command) -> Result<Report> {
    let name = machine::name(command);
    let mut child =
        command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().with_context(|| format!("cannot start {name}"))?;
    let mut report = Report::default();
    let mut lines = BufReader::new(child.stdout.take().context("no output")?);
    let mut line = Vec::new();
    while lines.read_until(b'\n', &mut line)? > 0 {
        io::stdout().write_all(&line)?;
        report.line(String::from_utf8_lossy(&line).trim_end());
        line.clear();
    }
    let status = child.wait()?;
    if !status.success() && report.failed.is_empty() && report.unfinished() == 0 {
        return Err(anyhow!("{name} ended with {status}"));
    }
    Ok(report)
}

/// What came of everything so far.
#[derive(Debug, Default)]
struct Tally {
    passed: usize,
    failed: usize,
    skipped: usize,
    /// A line for each thing that failed or was skipped.
    notes: Vec<String>,
}

impl Tally {
    /// Runs a step that is one thing.
    fn single(&mut self, name: &str, step: impl FnOnce() -> Result<()>) {
        println!("==> {name}");
        match step() {
            Ok(()) => self.passed += 1,
            Err(error) => self.error(name, &error),
        }
    }

    /// Runs a step that is many tests.
    fn tests(&mut self, name: &str, step: impl FnOnce() -> Result<Report>) {
        println!("==> {name}");
        match step() {
            Ok(report) => self.report(name, &report),
            Err(error) => self.error(name, &error),
        }
    }

    fn report(&mut self, name: &str, report: &Report) {
        self.passed += report.passed;
        for test in &report.failed {
            self.fail(&format!("{name}: {test}: {}", report.reason(test)));
        }
        for _ in 0..report.unfinished() {
            self.fail(&format!("{name}: a test program ended early"));
        }
        // Browser tests have a step of their own.
        for (test, reason) in report.ignored.iter().filter(|(_, reason)| !reason.contains(BROWSER_TEST)) {
            self.skip(&format!("{name}: {test}: {reason}"));
        }
    }

    fn error(&mut self, name: &str, error: &Error) {
        if error.is::<Missing>() {
            self.skip(&format!("{name}: {error:#}"));
        } else {
            self.fail(&format!("{name}: {error:#}"));
        }
    }

    fn fail(&mut self, what: &str) {
        self.failed += 1;
        self.notes.push(format!("failed: {what}"));
    }

    fn skip(&mut self, what: &str) {
        self.skipped += 1;
        self.notes.push(format!("skipped: {what}"));
    }
}

impl Display for Tally {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "summary: {} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_has_its_form() {
        let mut tally = Tally::default();
        tally.single("a", || Ok(()));
        tally.single("b", || Err(anyhow!("broken")));
        tally.single("c", || Err(Missing("no browser".into()).into()));
        assert_eq!(tally.to_string(), "summary: 1 passed, 1 failed, 1 skipped");
        assert_eq!(tally.notes, ["failed: b: broken", "skipped: c: no browser"]);
    }

    #[test]
    fn browser_tests_are_not_skipped_but_others_are() {
        let mut report = Report::default();
        report.line("test live ... ignored, needs a browser: cargo xtask test");
        report.line("test soak ... ignored, takes a night");
        let mut tally = Tally::default();
        tally.report("unit", &report);
        assert_eq!(tally.notes, ["skipped: unit: soak: takes a night"]);
    }

    #[test]
    fn dead_test_program_is_a_failure() {
        let mut report = Report::default();
        report.line("running 3 tests");
        let mut tally = Tally::default();
        tally.report("unit", &report);
        assert_eq!((tally.passed, tally.failed), (0, 1));
    }

    #[test]
    fn steps_are_known_by_their_names() {
        for step in Step::ALL {
            assert_eq!(step.name().parse::<Step>().unwrap(), step);
        }
        assert!("nonsense".parse::<Step>().is_err());
    }
}
