//! One request on its way and the wait for its reply.

use std::time::Duration;

use buslens_codec::UnitId;
use buslens_codec::line::Mode;
use buslens_codec::pdu::{Request, Response};

use super::echo::Echo;
use super::expect::Expected;
use super::inbox::Inbox;
use super::overdue::Overdue;
use super::patience::Patience;
use super::{Asker, Config};
use crate::outcome::{Answer, Counters, Exchange, Failure};
use crate::time::Instant;

/// USB adapters hold bytes back: a latency timer of 16 ms is common, and the system adds its own.
const USB_SLACK: Duration = Duration::from_millis(50);
/// A broadcast write gives the devices time to carry it out (serial line guide, clause 2.4.1: 100 to 200 ms).
const BROADCAST_TURNAROUND: Duration = Duration::from_millis(150);

impl Config {
    /// A line that was heard and is quiet for so long has said all, whatever an adapter holds back.
    pub(super) fn silence(self) -> Duration {
        self.line.frame_gap().max(USB_SLACK)
    }
}

#[derive(Debug)]
pub(super) struct Transaction {
    pub(super) asker: Asker,
    pub(super) unit: UnitId,
    pub(super) request: Request,
    /// The earliest moment at which the last character can have left.
    pub(super) on_wire_until: Instant,
    pub(super) line_errors: u32,
    mode: Mode,
    sent: Vec<u8>,
    sent_at: Instant,
    deadline: Instant,
    /// The echo of this request has been taken off.
    echo_taken: bool,
    /// One copy of a request whose reply equals it has come, and nobody knows whose it is.
    unproven: bool,
    /// A reply has come that is or is not an earlier request's. By this time it would have been followed by our own.
    doubt_until: Option<Instant>,
    /// The last byte after which silence was looked into.
    silence_seen: Option<Instant>,
    silence: Duration,
}

pub(super) enum Progress {
    Waiting,
    Ended(Exchange),
}

/// What the transaction shares with the master.
pub(super) struct Surroundings<'a> {
    pub(super) inbox: &'a mut Inbox,
    pub(super) echo: &'a mut Echo,
    pub(super) overdue: &'a mut Overdue,
    pub(super) patience: &'a mut Patience,
    pub(super) counters: &'a mut Counters,
}

impl Transaction {
    /// A request that is handed to the port now. A `wait` that was asked for goes before the usual `time_out`.
    pub(super) fn new(
        now: Instant,
        config: Config,
        (wait, time_out): (Option<Duration>, Duration),
        asker: Asker,
        unit: UnitId,
        request: Request,
        sent: Vec<u8>,
    ) -> Self {
        let on_wire_until = now + config.line.character_time(sent.len());
        let reply_len = Expected { mode: config.mode, unit, request: &request }.reply_len();
        let silence = config.silence();
        let deadline = on_wire_until
            + match wait {
                // An echo that comes after its time could be taken for a reply to the next request.
                Some(wait) => wait.max(silence),
                None if unit == UnitId::BROADCAST && request.is_write() => BROADCAST_TURNAROUND,
                None => time_out + config.line.character_time(reply_len) + USB_SLACK,
            };
        Self {
            asker,
            unit,
            request,
            on_wire_until,
            line_errors: 0,
            mode: config.mode,
            sent,
            sent_at: now,
            deadline,
            echo_taken: false,
            unproven: false,
            doubt_until: None,
            silence_seen: None,
            silence,
        }
    }

    /// Looks at what has come by `now`.
    pub(super) fn look(&mut self, now: Instant, around: &mut Surroundings<'_>) -> Progress {
        self.take_echo(around);
        let silent = around.inbox.last_at().is_some_and(|last| last + self.silence <= now);
        if let Some(ended) = self.take_reply(now, silent, around) {
            return ended;
        }
        if silent {
            self.silence_seen = around.inbox.last_at();
            if self.doubt_until.is_none() && self.expected().finds_damaged(around.inbox.bytes()) {
                let heard = around.inbox.take();
                return self.ended(now, heard.clone(), None, Err(Failure::BadCheck { heard }));
            }
        }
        if now < self.last_moment() {
            return Progress::Waiting;
        }
        let heard = around.inbox.take();
        around.counters.noise_bytes += heard.len() as u64;
        let result = if self.doubt_until.is_some() {
            Err(Failure::Doubtful)
        } else if self.unproven {
            Err(Failure::Unproven)
        } else if self.is_broadcast_write() {
            Ok(Answer::BroadcastSent)
        } else {
            Err(Failure::NoAnswer { heard: heard.clone(), line_errors: self.line_errors })
        };
        self.ended(now, heard, None, result)
    }

    /// When to look again if no byte comes.
    pub(super) fn next_look(&self, last_byte_at: Option<Instant>) -> Instant {
        match last_byte_at {
            Some(last) if self.silence_seen != Some(last) => self.last_moment().min(last + self.silence),
            _ => self.last_moment(),
        }
    }

    /// Time since the request had left.
    pub(super) fn latency(&self, now: Instant) -> Duration {
        now.saturating_since(self.on_wire_until)
    }

    /// How this ends when the link is gone.
    pub(super) fn abandoned(&self, now: Instant) -> Exchange {
        self.exchange(now, Vec::new(), None, Err(Failure::LinkLost))
    }

    /// How this ends when the recording goes on with another request.
    pub(super) fn cut_short(&self, now: Instant, inbox: &mut Inbox) -> Exchange {
        let heard = inbox.take();
        let result = Err(Failure::NoAnswer { heard: heard.clone(), line_errors: self.line_errors });
        self.exchange(now, heard, None, result)
    }

    /// Takes off what the adapter heard of ourselves, exactly the bytes that were sent and nothing else.
    fn take_echo(&mut self, around: &mut Surroundings<'_>) {
        if self.echo_taken {
            return;
        }
        let Some(copy) = around.inbox.find(&self.sent, 0) else { return };
        if self.reply_equals_request() {
            match around.echo {
                Echo::Absent => return,
                Echo::Unknown if around.inbox.find(&self.sent, copy.end).is_none() => {
                    self.unproven = true;
                    return;
                }
                Echo::Unknown | Echo::Present => {}
            }
        }
        around.inbox.remove(copy);
        around.counters.echoes += 1;
        *around.echo = Echo::Present;
        self.echo_taken = true;
        self.unproven = false;
    }

    /// Takes the reply out of the inbox, and before it replies to requests that are overdue.
    fn take_reply(&mut self, now: Instant, silent: bool, around: &mut Surroundings<'_>) -> Option<Progress> {
        if self.unproven {
            return None;
        }
        loop {
            let expected = Expected { mode: self.mode, unit: self.unit, request: &self.request };
            let own = expected.find(around.inbox.bytes(), silent);
            let late = around.overdue.find_reply(now, around.inbox, self.mode);
            let late = late.filter(|late| own.as_ref().is_none_or(|own| late.start <= own.range.start));
            if let Some(late) = late {
                around.counters.late_replies += 1;
                if around.overdue.settle(&late, around.inbox, Some(&expected)) {
                    // If it is as late as it looks, then ours comes as late: only that time without another proves
                    // that it was ours.
                    let until = self.on_wire_until + late.latency * 5 / 4 + USB_SLACK;
                    self.doubt_until = Some(self.doubt_until.map_or(until, |before| before.max(until)));
                } else {
                    around.patience.late(late.latency);
                }
                continue;
            }
            let own = own?;
            if !self.echo_taken && !self.reply_equals_request() {
                *around.echo = Echo::Absent;
            }
            around.counters.noise_bytes += own.range.start as u64;
            let frame = around.inbox.remove(own.range.clone());
            around.inbox.remove(0..own.range.start);
            let result = match own.response {
                Response::Exception { function, code } => Err(Failure::Exception { function, code }),
                response => Ok(Answer::Reply(response)),
            };
            // A reply whose length nobody knows is only seen in the silence after it.
            let last = around.inbox.last_at().unwrap_or(now);
            return Some(self.ended(now, frame, Some(last.saturating_since(self.sent_at)), result));
        }
    }

    fn ended(
        &self,
        now: Instant,
        received: Vec<u8>,
        round_trip: Option<Duration>,
        result: Result<Answer, Failure>,
    ) -> Progress {
        Progress::Ended(self.exchange(now, received, round_trip, result))
    }

    fn exchange(
        &self,
        now: Instant,
        received: Vec<u8>,
        round_trip: Option<Duration>,
        result: Result<Answer, Failure>,
    ) -> Exchange {
        Exchange { sent: self.sent.clone(), received, sent_at: self.sent_at, at: now, round_trip, result }
    }

    fn last_moment(&self) -> Instant {
        self.doubt_until.map_or(self.deadline, |until| until.max(self.on_wire_until))
    }

    fn expected(&self) -> Expected<'_> {
        Expected { mode: self.mode, unit: self.unit, request: &self.request }
    }

    fn is_broadcast_write(&self) -> bool {
        self.unit == UnitId::BROADCAST && self.request.is_write()
    }

    /// Functions 05 and 06 are answered by the request itself (application protocol, clauses 6.5 and 6.6).
    fn reply_equals_request(&self) -> bool {
        matches!(self.request, Request::WriteSingleCoil { .. } | Request::WriteSingleRegister { .. })
    }
}
