//! Bytes that are no request, on their way, and what is heard until the line is quiet.

use std::time::Duration;

use super::echo::Echo;
use super::inbox::Inbox;
use super::job::{Addressed, unanswered_reads};
use super::transaction::{Progress, Surroundings};
use super::{Asker, Config};
use crate::outcome::{Answer, Exchange, Failure};
use crate::time::Instant;

#[derive(Debug)]
pub(super) struct Raw {
    pub(super) asker: Asker,
    /// The earliest moment at which the last character can have left.
    pub(super) on_wire_until: Instant,
    pub(super) line_errors: u32,
    config: Config,
    sent: Vec<u8>,
    sent_at: Instant,
    deadline: Instant,
    silence: Duration,
    echo_taken: bool,
}

impl Raw {
    /// Bytes that are handed to the port now.
    pub(super) fn new(now: Instant, config: Config, wait: Duration, asker: Asker, sent: Vec<u8>) -> Self {
        let on_wire_until = now + config.line.character_time(sent.len());
        let silence = config.silence();
        Self {
            asker,
            on_wire_until,
            line_errors: 0,
            config,
            sent,
            sent_at: now,
            deadline: on_wire_until + wait.max(silence),
            silence,
            echo_taken: false,
        }
    }

    /// Looks at what has come by `now`.
    pub(super) fn look(&mut self, now: Instant, around: &mut Surroundings<'_>) -> Progress {
        while let Some(latency) = around.overdue.take_reply(now, around.inbox, self.config.mode) {
            around.counters.late_replies += 1;
            around.patience.late(latency);
        }
        self.take_echo(around);
        if now < self.end(around.inbox) {
            return Progress::Waiting;
        }
        let last_at = around.inbox.last_at();
        let received = around.inbox.take();
        let (round_trip, result) = if received.is_empty() {
            (None, Err(Failure::NoAnswer { heard: Vec::new(), line_errors: self.line_errors }))
        } else {
            (last_at.map(|at| at.saturating_since(self.sent_at)), Ok(Answer::Heard))
        };
        Progress::Ended(self.ended(now, received, round_trip, result))
    }

    /// When this ends if no byte comes.
    pub(super) fn end(&self, inbox: &Inbox) -> Instant {
        match inbox.last_at() {
            Some(last) if !inbox.bytes().is_empty() && !self.sent.is_empty() => {
                self.deadline.min(last.max(self.on_wire_until) + self.silence)
            }
            _ => self.deadline,
        }
    }

    /// How this ends when the link is gone.
    pub(super) fn abandoned(&self, now: Instant) -> Exchange {
        self.ended(now, Vec::new(), None, Err(Failure::LinkLost))
    }

    /// What a device may still answer after these bytes, of which `heard` has come.
    pub(super) fn unanswered(&self, heard: &[u8]) -> Vec<Addressed> {
        unanswered_reads(self.config.mode, &self.sent, heard)
    }

    /// Takes off what the adapter heard of ourselves. A lone copy counts as that unless the adapter is known to be deaf
    /// to itself; it proves nothing about the adapter, because a device may say the same.
    fn take_echo(&mut self, around: &mut Surroundings<'_>) {
        if self.echo_taken || self.sent.is_empty() || *around.echo == Echo::Absent {
            return;
        }
        if let Some(copy) = around.inbox.find(&self.sent, 0) {
            around.inbox.remove(copy);
            around.counters.echoes += 1;
            self.echo_taken = true;
        }
    }

    fn ended(
        &self,
        now: Instant,
        received: Vec<u8>,
        round_trip: Option<Duration>,
        result: Result<Answer, Failure>,
    ) -> Exchange {
        Exchange { sent: self.sent.clone(), received, sent_at: self.sent_at, at: now, round_trip, result }
    }
}
