//! Reads what Rust's test programs print.

use std::collections::BTreeMap;

/// What the test programs have said so far.
#[derive(Debug, Default)]
pub(crate) struct Report {
    /// Tests that passed.
    pub(crate) passed: usize,
    /// Tests that failed, by name.
    pub(crate) failed: Vec<String>,
    /// Tests that were not run: name and the reason given.
    pub(crate) ignored: Vec<(String, String)>,
    /// Why a test failed: the first line of its panic.
    reasons: BTreeMap<String, String>,
    /// Test programs that began and have not ended.
    unfinished: usize,
    /// The test whose output is being shown, and whether its panic comes next.
    shown: Option<(String, bool)>,
}

impl Report {
    /// Reads the next line.
    pub(crate) fn line(&mut self, line: &str) {
        if line.starts_with("running ") && (line.ends_with(" tests") || line.ends_with(" test")) {
            self.unfinished += 1;
        } else if let Some(counts) = line.strip_prefix("test result: ") {
            self.unfinished = self.unfinished.saturating_sub(1);
            self.passed += count(counts, "passed");
            self.shown = None;
        } else if let Some((name, outcome)) = line.strip_prefix("test ").and_then(|test| test.rsplit_once(" ... ")) {
            self.outcome(name, outcome);
        } else {
            self.output(line);
        }
    }

    /// How many test programs ended without a result.
    pub(crate) fn unfinished(&self) -> usize {
        self.unfinished
    }

    /// Why the test failed, as far as it said so.
    pub(crate) fn reason(&self, test: &str) -> &str {
        self.reasons.get(test).map_or("failed without a panic", String::as_str)
    }

    fn outcome(&mut self, name: &str, outcome: &str) {
        if outcome == "FAILED" {
            let name = name.strip_suffix(" - should panic").unwrap_or(name);
            self.failed.push(name.to_owned());
        } else if let Some(reason) = outcome.strip_prefix("ignored") {
            let reason = reason.strip_prefix(", ").unwrap_or("no reason given");
            self.ignored.push((name.to_owned(), reason.to_owned()));
        }
    }

    fn output(&mut self, line: &str) {
        if let Some(name) = line.strip_prefix("---- ").and_then(|line| line.strip_suffix(" stdout ----")) {
            self.shown = Some((name.to_owned(), false));
        } else if let Some((name, panicked)) = &mut self.shown {
            if line.contains(" panicked at ") {
                *panicked = true;
            } else if *panicked && !line.is_empty() {
                self.reasons.insert(name.clone(), line.to_owned());
                self.shown = None;
            }
        }
    }
}

/// The number before `word` in `ok. 3 passed; 0 failed; 1 ignored; ...`.
fn count(counts: &str, word: &str) -> usize {
    let mut words = counts.split([' ', ';']).filter(|part| !part.is_empty());
    let mut before = "";
    words
        .find_map(|part| {
            if part == word {
                before.parse().ok()
            } else {
                before = part;
                None
            }
        })
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::Report;

    fn report(text: &str) -> Report {
        let mut report = Report::default();
        text.lines().for_each(|line| report.line(line));
        report
    }

    #[test]
    fn passed_tests_of_several_programs_add_up() {
        let report = report(
            "\nrunning 2 tests\ntest a::b ... ok\ntest c ... ok\n\n\
             test result: ok. 2 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\n\n\
             running 1 test\ntest codec/src/lib.rs - crc (line 3) ... ok\n\n\
             test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 7 filtered out; finished in 0.31s\n",
        );
        assert_eq!((report.passed, report.failed.len(), report.ignored.len(), report.unfinished()), (3, 0, 0, 0));
    }

    #[test]
    fn failed_test_has_its_name_and_its_panic() {
        let report = report(
            "running 2 tests\ntest good ... ok\ntest bad::one ... FAILED\n\nfailures:\n\n---- bad::one stdout ----\n\n\
             thread 'bad::one' (77) panicked at src/lib.rs:9:5:\nassertion `left == right` failed\n  left: 1\n right: 2\n\
             note: run with `RUST_BACKTRACE=1`\n\n\nfailures:\n    bad::one\n\n\
             test result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\n",
        );
        assert_eq!((report.passed, report.failed.as_slice()), (1, &["bad::one".to_owned()][..]));
        assert_eq!(report.reason("bad::one"), "assertion `left == right` failed");
    }

    #[test]
    fn ignored_test_has_its_reason() {
        let report = report(
            "running 2 tests\ntest a ... ignored, needs a browser\ntest b ... ignored\n\n\
             test result: ok. 0 passed; 0 failed; 2 ignored; 0 measured; 0 filtered out; finished in 0.00s\n",
        );
        let pairs = [("a", "needs a browser"), ("b", "no reason given")];
        assert_eq!(report.ignored, pairs.map(|(name, reason)| (name.to_owned(), reason.to_owned())));
    }

    #[test]
    fn program_that_dies_is_seen() {
        assert_eq!(report("running 2 tests\ntest a ... ok\n").unfinished(), 1);
    }
}
