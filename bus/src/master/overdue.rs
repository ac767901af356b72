//! Requests that timed out and may still be answered.

use std::collections::VecDeque;
use std::time::Duration;

use buslens_codec::UnitId;
use buslens_codec::line::Mode;
use buslens_codec::pdu::Request;

use super::expect::Expected;
use super::inbox::Inbox;
use crate::time::Instant;

/// How long an unanswered request is remembered. A reply later than this is not reckoned with.
const MEMORY: Duration = Duration::from_secs(3);

#[derive(Debug, Default)]
pub(super) struct Overdue {
    requests: VecDeque<Unanswered>,
}

#[derive(Debug)]
struct Unanswered {
    unit: UnitId,
    request: Request,
    on_wire_until: Instant,
}

/// A late reply to one of them.
pub(super) struct LateReply {
    /// Where it stood in the inbox.
    pub(super) start: usize,
    /// Which request it answers, the oldest if there are several.
    index: usize,
    range_end: usize,
    /// Time since that request had left.
    pub(super) latency: Duration,
}

impl Overdue {
    pub(super) fn push(&mut self, unit: UnitId, request: Request, on_wire_until: Instant) {
        self.requests.push_back(Unanswered { unit, request, on_wire_until });
    }

    pub(super) fn forget(&mut self) {
        self.requests.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.requests.is_empty()
    }

    /// A unit answers in order: after a reply that is surely to a newer request, nothing older is to come from it.
    pub(super) fn forget_unit(&mut self, unit: UnitId) {
        self.requests.retain(|overdue| overdue.unit != unit);
    }

    pub(super) fn prune(&mut self, now: Instant) {
        self.requests.retain(|overdue| now.saturating_since(overdue.on_wire_until) < MEMORY);
    }

    /// The first late reply in the inbox. A device answers in order, so the oldest request comes first.
    pub(super) fn find_reply(&self, now: Instant, inbox: &Inbox, mode: Mode) -> Option<LateReply> {
        let found = self.requests.iter().enumerate().filter_map(|(index, overdue)| {
            let expected = overdue.expected(mode);
            let found = expected.find(inbox.bytes(), false)?;
            let latency = now.saturating_since(overdue.on_wire_until);
            Some(LateReply { start: found.range.start, range_end: found.range.end, index, latency })
        });
        found.min_by_key(|late| (late.start, late.index))
    }

    /// Takes a late reply out of the inbox and strikes its request off. Says whether it could have been taken for the
    /// reply to `expected`.
    pub(super) fn settle(&mut self, late: &LateReply, inbox: &mut Inbox, expected: Option<&Expected<'_>>) -> bool {
        inbox.remove(late.start..late.range_end);
        let Some(overdue) = self.requests.remove(late.index) else { return false };
        expected.is_some_and(|expected| expected.is_confusable_with(&overdue.expected(expected.mode)))
    }

    /// Takes out the first late reply while nobody is asked, and tells how late it came.
    pub(super) fn take_reply(&mut self, now: Instant, inbox: &mut Inbox, mode: Mode) -> Option<Duration> {
        let late = self.find_reply(now, inbox, mode)?;
        self.settle(&late, inbox, None);
        Some(late.latency)
    }
}

impl Unanswered {
    fn expected(&self, mode: Mode) -> Expected<'_> {
        Expected { mode, unit: self.unit, request: &self.request }
    }
}
