//! What is read periodically, on a steady grid.

use std::time::Duration;

use buslens_codec::UnitId;
use buslens_codec::pdu::Request;

use crate::time::Instant;

/// Requests that are made in turn, one round a period.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Poll {
    /// To whom.
    pub unit: UnitId,
    /// What, in this order.
    pub requests: Vec<Request>,
    /// From the start of one round to the start of the next. A round that takes longer delays the next.
    pub period: Duration,
}

#[derive(Debug)]
pub(super) struct Schedule {
    poll: Poll,
    next: usize,
    due: Instant,
    round_started: Instant,
    /// A request of this poll was found in a recording, so that its unit is known.
    recognised: bool,
}

impl Schedule {
    /// `None` for a poll without requests or without time between two rounds.
    pub(super) fn new(now: Instant, poll: Poll) -> Option<Self> {
        (!poll.requests.is_empty() && !poll.period.is_zero()).then_some(Self {
            poll,
            next: 0,
            due: now,
            round_started: now,
            recognised: false,
        })
    }

    pub(super) fn restart(&mut self, now: Instant) {
        self.next = 0;
        self.due = now;
    }

    pub(super) fn unit(&self) -> UnitId {
        self.poll.unit
    }

    /// When the next request may be made.
    pub(super) fn due(&self) -> Instant {
        self.due
    }

    /// The next request and its place. Rounds stay on the grid of the first one; missed ones are left out.
    pub(super) fn take(&mut self, now: Instant) -> (usize, Request) {
        let index = self.next;
        self.next = (index + 1) % self.poll.requests.len();
        if index == 0 {
            self.round_started = self.due;
        }
        if self.next == 0 {
            let next_round = self.round_started + self.poll.period;
            self.due = if next_round < now { now } else { next_round };
        }
        (index, self.poll.requests[index].clone())
    }

    /// The place of a request that was made anyway, searched for from the one that is next. The first one tells whose
    /// poll it is.
    pub(super) fn recognise(&mut self, unit: UnitId, request: &Request) -> Option<usize> {
        let count = self.poll.requests.len();
        let mut places = (self.next..count).chain(0..self.next).filter(|_| !self.recognised || unit == self.poll.unit);
        let index = places.find(|&at| self.poll.requests.get(at) == Some(request))?;
        self.next = (index + 1) % count;
        self.poll.unit = unit;
        self.recognised = true;
        Some(index)
    }
}
