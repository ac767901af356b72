//! How long to wait for a reply: as long as configured at first, shorter once the device is known to be quick, longer
//! once it is known to be late.

use std::time::Duration;

/// A known quick device still gets this much more than four times its slowest recent reply.
const SLACK: Duration = Duration::from_millis(100);
/// Never longer than this, unless configured so.
const LONGEST: Duration = Duration::from_secs(3);

#[derive(Debug)]
pub(super) struct Patience {
    configured: Duration,
    /// Slowest of the recent replies, forgotten slowly; `None` after a failure.
    recent: Option<Duration>,
    /// Slowest reply that came after its time.
    slowest: Duration,
}

impl Patience {
    pub(super) fn new(configured: Duration) -> Self {
        Self { configured, recent: None, slowest: Duration::ZERO }
    }

    pub(super) fn time_out(&self) -> Duration {
        let usual = self.recent.map_or(self.configured, |recent| (recent * 4 + SLACK).min(self.configured));
        usual.max(self.slowest * 3 / 2).min(LONGEST.max(self.configured))
    }

    pub(super) fn answered(&mut self, latency: Duration) {
        let faded = self.recent.unwrap_or_default() * 15 / 16;
        self.recent = Some(latency.max(faded));
    }

    pub(super) fn exhausted(&mut self) {
        self.recent = None;
    }

    pub(super) fn late(&mut self, latency: Duration) {
        self.slowest = self.slowest.max(latency);
    }

    /// When a reply that is as late as any before would have come.
    pub(super) fn slowest_with_margin(&self) -> Duration {
        self.slowest * 5 / 4
    }
}
