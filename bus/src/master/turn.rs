//! Whose turn it is, and what leaves then.

use std::time::Duration;

use buslens_codec::adu;
use buslens_codec::line::Mode;
use buslens_codec::pdu::PduError;

use super::job::{Addressed, request_of};
use super::{Asker, Content, Current, Master, Queued, Raw, Transaction, Transmit};
use crate::outcome::{Exchange, Failure};
use crate::record::Origin;
use crate::time::Instant;

/// Chatter on the line holds a request back no longer than this.
const CHATTER_PATIENCE: Duration = Duration::from_secs(1);

/// What is about to leave.
struct Departure {
    asker: Asker,
    origin: Origin,
    wait: Option<Duration>,
    content: Content,
}

impl Master {
    /// When the next one may leave, if there is one.
    pub(super) fn next_departure(&self) -> Option<Instant> {
        if self.replay {
            return None;
        }
        let (due, unit) = match (&self.schedule, self.jobs.front()) {
            (Some(schedule), _) if self.is_polls_turn() => (schedule.due(), Some(schedule.unit())),
            (_, Some(queued)) => (queued.since, queued.job.unit(self.config.mode)),
            _ => return None,
        };
        let mut quiet = self.quiet_until;
        if self.last_unit.is_some() && self.last_unit != unit {
            quiet = quiet + self.config.unit_pause;
        }
        if let Some(heard) = self.inbox.last_at() {
            let chatter = heard + self.config.line.frame_gap();
            let limit = quiet.max(due) + CHATTER_PATIENCE;
            quiet = quiet.max(chatter.min(limit));
        }
        Some(due.max(quiet))
    }

    /// Whether the poll goes before the jobs. What is due first goes first; where both could leave as soon as the line
    /// is free, they alternate, so that neither starves the other.
    fn is_polls_turn(&self) -> bool {
        let ready = |due: Instant| due.max(self.quiet_until);
        match (&self.schedule, self.jobs.front()) {
            (Some(schedule), Some(queued)) => {
                let (poll, job) = (ready(schedule.due()), ready(queued.since));
                if poll == job { self.job_went_last } else { poll < job }
            }
            (schedule, _) => schedule.is_some(),
        }
    }

    /// Lets the next one leave.
    pub(super) fn depart(&mut self, now: Instant) {
        let polls_turn = self.is_polls_turn();
        let departure = if let Some(schedule) = self.schedule.as_mut().filter(|_| polls_turn) {
            let unit = schedule.unit();
            let (index, request) = schedule.take(now);
            let content = Content::Request { unit, request };
            Departure { asker: Asker::Poll(index), origin: Origin::Poll, wait: None, content }
        } else if let Some(Queued { id, job, .. }) = self.jobs.pop_front() {
            let (origin, wait, content) = (job.origin, job.wait, job.content.clone());
            Departure { asker: Asker::Job(id, job), origin, wait, content }
        } else {
            return;
        };
        self.job_went_last = !polls_turn;
        match frame(self.config.mode, departure.content) {
            Ok((_, request)) if self.read_only && request.as_ref().is_none_or(|(_, request)| request.is_write()) => {
                self.report(departure.asker, Exchange::unsent(now, Failure::ReadOnly));
            }
            Ok((bytes, request)) => {
                self.outgoing = Some(Transmit { at: now, origin: departure.origin, bytes: bytes.clone() });
                self.begin(now, departure.asker, departure.wait, request, bytes);
            }
            Err(failure) => self.report(departure.asker, Exchange::unsent(now, failure)),
        }
    }

    /// These bytes leave now, and have the line from now on.
    pub(super) fn begin(
        &mut self,
        now: Instant,
        asker: Asker,
        wait: Option<Duration>,
        request: Option<Addressed>,
        bytes: Vec<u8>,
    ) {
        self.counters.noise_bytes += self.inbox.clear();
        self.overdue.prune(now);
        let time_out = self.patience.time_out();
        self.current = Some(match request {
            Some((unit, request)) => {
                self.counters.requests += 1;
                self.last_unit = Some(unit);
                Current::Request(Transaction::new(now, self.config, (wait, time_out), asker, unit, request, bytes))
            }
            None => Current::Raw(Raw::new(now, self.config, wait.unwrap_or(time_out), asker, bytes)),
        });
    }
}

/// The bytes that go out, and the request that they are, if they are one.
fn frame(mode: Mode, content: Content) -> Result<(Vec<u8>, Option<Addressed>), Failure> {
    match content {
        Content::Request { unit, request } => {
            let frame = adu::encode(mode, unit, &request.encode()?).ok_or(PduError::TooLong)?;
            Ok((frame, Some((unit, request))))
        }
        Content::Raw(bytes) => {
            let request = request_of(mode, &bytes);
            Ok((bytes, request))
        }
    }
}
