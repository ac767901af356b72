//! The report while it grows.

use buslens_bus::time::Instant;

use crate::report::{Changes, Ended, Entry, MAX_ENTRIES, Mark, Reason, Report, Verdict};

#[derive(Debug, Default)]
pub(super) struct Ledger {
    pub(super) report: Report,
    /// How often each step has begun, by its place.
    times: Vec<u32>,
    /// The first entry that was not told as it is now.
    untold: usize,
    summary_untold: bool,
}

impl Ledger {
    pub(super) fn begin(&mut self, now: Instant, step: usize, line: u32) -> usize {
        if self.times.len() <= step {
            self.times.resize(step + 1, 0);
        }
        let time = self.times.get_mut(step).map_or(1, |times| {
            *times = times.saturating_add(1);
            *times
        });
        self.report.entries.push(Entry {
            line,
            time,
            at_us: now.as_micros(),
            took_us: 0,
            mark: Mark::Running,
            exchanges: Vec::new(),
            compared: None,
            reason: None,
            text: String::new(),
            outcome: None,
        });
        self.summary_untold = true;
        self.report.entries.len() - 1
    }

    pub(super) fn has_run(&self, step: usize) -> bool {
        self.times.get(step).is_some_and(|times| *times > 0)
    }

    /// Changes an entry.
    pub(super) fn entry(&mut self, at: usize, change: impl FnOnce(&mut Entry)) {
        if let Some(entry) = self.report.entries.get_mut(at) {
            change(entry);
            self.untold = self.untold.min(at);
        }
    }

    /// Ends an entry. `counts` says whether passing it proves something.
    pub(super) fn finish(&mut self, now: Instant, at: usize, reason: Option<Reason>, counts: bool) {
        let failed = reason.is_some();
        self.entry(at, |entry| {
            entry.took_us = now.as_micros().saturating_sub(entry.at_us);
            entry.mark = if failed { Mark::Failed } else { Mark::Passed };
            entry.reason = reason;
        });
        let summary = &mut self.report.summary;
        if failed {
            summary.failed = summary.failed.saturating_add(1);
        } else if counts {
            summary.passed = summary.passed.saturating_add(1);
        }
        self.summary_untold = true;
        let limit = if failed { 2 * MAX_ENTRIES } else { MAX_ENTRIES };
        if at >= limit && at + 1 == self.report.entries.len() {
            self.report.entries.pop();
            self.report.summary.left_out = self.report.summary.left_out.saturating_add(1);
            self.untold = self.untold.min(at);
        }
    }

    /// Ends an entry that was cut off: nothing is known of it.
    pub(super) fn cut(&mut self, now: Instant, at: usize, reason: Reason) {
        self.entry(at, |entry| {
            entry.took_us = now.as_micros().saturating_sub(entry.at_us);
            entry.mark = Mark::Skipped;
            entry.reason = Some(reason);
        });
    }

    /// A step that was never reached.
    pub(super) fn skip(&mut self, now: Instant, step: usize, line: u32) {
        if self.report.entries.len() < 2 * MAX_ENTRIES {
            let at = self.begin(now, step, line);
            self.entry(at, |entry| {
                entry.mark = Mark::Skipped;
                entry.time = 0;
            });
        }
    }

    pub(super) fn end(&mut self, now: Instant, ended: Ended) {
        let summary = &mut self.report.summary;
        summary.ended = Some(ended);
        summary.until_us = now.as_micros();
        summary.verdict = match ended {
            _ if summary.failed > 0 => Verdict::Failed,
            Ended::Finished | Ended::StopStep | Ended::Failure => Verdict::Passed,
            Ended::Stopped | Ended::PortLost => Verdict::Incomplete,
        };
        self.summary_untold = true;
    }

    pub(super) fn changes(&mut self) -> Option<Changes> {
        let from = self.untold.min(self.report.entries.len());
        if !self.summary_untold && from == self.report.entries.len() {
            return None;
        }
        let entries = self.report.entries.get(from..).unwrap_or_default().to_vec();
        // What still runs will change.
        self.untold = self.report.entries.len();
        self.summary_untold = false;
        let summary = self.report.summary.clone();
        Some(Changes { summary, from: u32::try_from(from).unwrap_or(u32::MAX), entries })
    }
}
