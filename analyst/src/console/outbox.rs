//! What the console has to say, until somebody takes it, and when it says it.

use std::collections::VecDeque;
use std::time::Duration;

use buslens_bus::time::Instant;

use crate::configure::ToStore;
use crate::line::ToLine;
use crate::message::FromConsole;

/// Messages to all sides, and the numbers under which the engine knows what it is to send.
#[derive(Debug, Default)]
pub(super) struct Outbox {
    pub(super) line: VecDeque<ToLine>,
    pub(super) window: VecDeque<FromConsole>,
    pub(super) store: VecDeque<ToStore>,
    last_number: u32,
}

impl Outbox {
    /// A number that names something to be sent and nothing before it.
    pub(super) fn number(&mut self) -> u32 {
        self.last_number = self.last_number.wrapping_add(1);
        self.last_number
    }

    pub(super) fn order(&mut self, order: ToLine) {
        self.line.push_back(order);
    }

    pub(super) fn store(&mut self, order: ToStore) {
        self.store.push_back(order);
    }

    pub(super) fn tell(&mut self, news: FromConsole) {
        self.window.push_back(news);
    }
}

/// Something that changes more often than anybody reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct News {
    period: Duration,
    changed: bool,
    told_at: Option<Instant>,
}

impl News {
    /// Nothing yet; to be told at most once in a period.
    pub(super) fn every(period: Duration) -> Self {
        Self { period, changed: false, told_at: None }
    }

    /// There is something to tell.
    pub(super) fn change(&mut self) {
        self.changed = true;
    }

    /// When it is to be told.
    pub(super) fn due(&self) -> Option<Instant> {
        self.changed.then(|| self.told_at.map_or(Instant::ZERO, |told_at| told_at + self.period))
    }

    /// Whether it is to be told now; then it is.
    pub(super) fn take(&mut self, now: Instant) -> bool {
        let is_due = self.due().is_some_and(|due| due <= now);
        if is_due {
            (self.changed, self.told_at) = (false, Some(now));
        }
        is_due
    }
}
