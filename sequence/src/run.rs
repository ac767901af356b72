//! A sequence being carried out. Nothing here opens a port, reads a clock or sets a timer.
//!
//! In: [`Run::done`], [`Run::state`], [`Run::timeout`], [`Run::stop`]. After any of them, and after [`Run::new`], drain
//! [`Run::poll_order`] until it is empty and look at [`Run::poll_timeout`]; [`Run::poll_changes`] as often as somebody
//! looks. A spurious timeout is harmless.

mod ask;
mod datum;
mod dialogue;
mod ledger;
mod memory;
mod steps;

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use buslens_bus::record::{End, Outcome};
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::Profile;

use crate::report::{Changes, Ended, Reason, Report};
use crate::script::{Action, OnFailure, Sequence, Time};
use dialogue::Dialogue;
use ledger::Ledger;
use memory::Memory;

/// Steps that are made in one call. A `repeat` that neither sends nor waits goes on after [`BREATH`].
const STEPS_AT_ONCE: usize = 500;
const BREATH: Duration = Duration::from_millis(1);
/// How long a port may take to come back with other settings.
const REOPENING: Duration = Duration::from_secs(5);
/// An exchange that was not answered for so long beyond its own time, is given up.
const FORGOTTEN: Duration = Duration::from_secs(30);

/// What the line shall do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Order {
    /// Send bytes, and answer with [`Run::done`].
    Send {
        /// Names the answer. Counts from 0 in each run.
        id: u32,
        /// The bytes.
        bytes: Vec<u8>,
        /// How long to wait for an answer, in milliseconds; `None` leaves it to the master.
        wait_ms: Option<u32>,
    },
    /// Take back what has not been sent yet of this number.
    Withdraw(u32),
    /// Other settings of the port. [`Run::state`] tells when they hold.
    Settings {
        /// Settings of the port.
        line: LineSettings,
        /// RTU or ASCII.
        mode: Mode,
    },
    /// Poll the device, or leave the line to others.
    Poll(bool),
    /// Set outputs of the port; `None` leaves one as it is.
    Signals {
        /// Data terminal ready.
        dtr: Option<bool>,
        /// Request to send.
        rts: Option<bool>,
    },
    /// Hold the line in the break state for so many milliseconds.
    Break(u32),
}

/// The line, as far as a run needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Whether bytes can be sent now.
    pub open: bool,
    /// Settings of the port.
    pub line: LineSettings,
    /// RTU or ASCII.
    pub mode: Mode,
    /// Whether the device is polled.
    pub polling: bool,
}

/// A sequence being carried out.
#[derive(Debug)]
pub struct Run {
    sequence: Arc<Sequence>,
    unit: UnitId,
    line: Line,
    original: Line,
    /// Whether the sequence itself has set polling.
    set_poll: bool,
    next: usize,
    blocks: Vec<Round>,
    doing: Doing,
    memory: Memory,
    ledger: Ledger,
    time_out: Option<Time>,
    on_failure: OnFailure,
    /// Since the last write that was handed on, no other may follow for the profile's shortest time.
    wrote_at: Option<Instant>,
    orders: VecDeque<Order>,
    next_id: u32,
}

/// A `repeat` under way.
#[derive(Debug)]
struct Round {
    begin: usize,
    rounds: u32,
    entry: usize,
}

/// What a run waits for.
#[derive(Debug)]
enum Doing {
    /// Nothing: the next step can begin.
    Nothing,
    /// A time. The entry is none for a pause of its own.
    Waiting { until: Instant, entry: Option<usize> },
    /// The port with other settings.
    Reopening { until: Instant, entry: usize, line: LineSettings, mode: Mode },
    /// Exchanges.
    Asking(Box<Dialogue>),
    /// Nothing any more.
    Ended,
}

impl Run {
    /// Begins. `unit` is the device that the sequence means, `profile` the one that it was read with. If the port is not
    /// open, it ends at once.
    pub fn new(sequence: Arc<Sequence>, unit: UnitId, profile: Option<Arc<Profile>>, line: Line, now: Instant) -> Self {
        let mut ledger = Ledger::default();
        let summary = &mut ledger.report.summary;
        sequence.title().clone_into(&mut summary.title);
        summary.profile = profile.as_ref().map(|profile| profile.id.clone()).unwrap_or_default();
        summary.unit = unit.0;
        (summary.began_us, summary.until_us) = (now.as_micros(), now.as_micros());
        let mut run = Self {
            sequence,
            unit,
            line,
            original: line,
            set_poll: false,
            next: 0,
            blocks: Vec::new(),
            doing: Doing::Nothing,
            memory: Memory::new(profile),
            ledger,
            time_out: None,
            on_failure: OnFailure::Continue,
            wrote_at: None,
            orders: VecDeque::new(),
            next_id: 0,
        };
        run.go_on(now);
        run
    }

    /// Whether nothing more will come.
    pub fn has_ended(&self) -> bool {
        matches!(self.doing, Doing::Ended)
    }

    /// The report as it is now.
    pub fn report(&self) -> &Report {
        &self.ledger.report
    }

    // What happened.

    /// An [`Order::Send`] has ended.
    pub fn done(&mut self, now: Instant, id: u32, outcome: &Outcome) {
        let Doing::Asking(dialogue) = &mut self.doing else { return };
        let Some(pending) = dialogue.pending.take_if(|pending| pending.id == id) else { return };
        let (entry, unit) = (dialogue.entry, pending.unit);
        let heard = self.memory.take(self.line.mode, unit, pending.request, outcome);
        self.ledger.entry(entry, |entry| {
            if let Some(exchange) = entry.exchanges.last_mut() {
                exchange.heard.clone_from(&outcome.heard);
                exchange.round_trip_us = outcome.round_trip_us;
                exchange.end = Some(outcome.end);
            }
        });
        match outcome.end {
            End::NoPort => return self.end(now, Ended::PortLost),
            End::ReadOnly => self.step_over(now, entry, Some(Reason::ReadOnly), true),
            End::Withdrawn | End::Busy => self.step_over(now, entry, Some(Reason::Withdrawn), true),
            _ => self.heard(now, heard),
        }
        self.go_on(now);
    }

    /// The line is so now.
    pub fn state(&mut self, now: Instant, line: Line) {
        self.line = line;
        self.go_on(now);
    }

    /// Time has passed.
    pub fn timeout(&mut self, now: Instant) {
        self.go_on(now);
    }

    /// It shall stop: nothing more is sent, and the report stays.
    pub fn stop(&mut self, now: Instant) {
        self.end(now, Ended::Stopped);
    }

    // What to do about it.

    /// What the line shall do.
    pub fn poll_order(&mut self) -> Option<Order> {
        self.orders.pop_front()
    }

    /// When [`Run::timeout`] is due.
    pub fn poll_timeout(&self) -> Option<Instant> {
        match &self.doing {
            Doing::Nothing | Doing::Ended => None,
            Doing::Waiting { until, .. } | Doing::Reopening { until, .. } => Some(*until),
            Doing::Asking(dialogue) => dialogue.pending.as_ref().map(|pending| pending.until).or(dialogue.not_before),
        }
    }

    /// What has changed in the report since the last call.
    pub fn poll_changes(&mut self) -> Option<Changes> {
        self.ledger.changes()
    }

    /// Makes steps until one has to wait.
    fn go_on(&mut self, now: Instant) {
        for _ in 0..STEPS_AT_ONCE {
            match &mut self.doing {
                Doing::Ended => return,
                Doing::Reopening { until, entry, line, mode } => {
                    let (until, entry) = (*until, *entry);
                    if self.line.open && (self.line.line, self.line.mode) == (*line, *mode) {
                        self.step_over(now, entry, None, false);
                    } else if until <= now {
                        if !self.line.open {
                            return self.end(now, Ended::PortLost);
                        }
                        self.step_over(now, entry, Some(Reason::LineNotSet), true);
                    } else {
                        return;
                    }
                }
                _ if !self.line.open => return self.end(now, Ended::PortLost),
                Doing::Waiting { until, entry } => {
                    if *until > now {
                        return;
                    }
                    match *entry {
                        Some(entry) => self.step_over(now, entry, None, false),
                        None => self.doing = Doing::Nothing,
                    }
                }
                Doing::Asking(dialogue) => match &dialogue.pending {
                    Some(pending) if pending.until > now => return,
                    Some(pending) => {
                        let (id, entry) = (pending.id, dialogue.entry);
                        self.orders.push_back(Order::Withdraw(id));
                        self.step_over(now, entry, Some(Reason::Withdrawn), true);
                    }
                    None if dialogue.not_before.is_some_and(|until| until > now) => return,
                    None => self.send_next(now),
                },
                Doing::Nothing => {
                    if self.next >= self.sequence.steps.len() {
                        return self.end(now, Ended::Finished);
                    }
                    self.begin_step(now);
                }
            }
        }
        if matches!(self.doing, Doing::Nothing) {
            self.doing = Doing::Waiting { until: now + BREATH, entry: None };
        }
    }

    fn end(&mut self, now: Instant, ended: Ended) {
        let cut = match ended {
            Ended::PortLost => Some(Reason::NoPort),
            Ended::Stopped | Ended::Failure => Some(Reason::Stopped),
            Ended::Finished | Ended::StopStep => None,
        };
        let open = match core::mem::replace(&mut self.doing, Doing::Ended) {
            Doing::Ended => return,
            Doing::Nothing => None,
            Doing::Waiting { entry, .. } => entry,
            Doing::Reopening { entry, .. } => Some(entry),
            Doing::Asking(dialogue) => {
                if let Some(pending) = &dialogue.pending {
                    self.orders.push_back(Order::Withdraw(pending.id));
                }
                Some(dialogue.entry)
            }
        };
        let rounds = core::mem::take(&mut self.blocks);
        for entry in open.into_iter().chain(rounds.into_iter().rev().map(|round| round.entry)) {
            match &cut {
                Some(reason) => self.ledger.cut(now, entry, reason.clone()),
                None => self.ledger.finish(now, entry, None, false),
            }
        }
        for (at, step) in self.sequence.steps.iter().enumerate() {
            let silent =
                matches!(step.action, Action::Title(_) | Action::Device(_) | Action::End { .. } | Action::Else { .. });
            if !silent && !self.ledger.has_run(at) {
                self.ledger.skip(now, at, step.line);
            }
        }
        // Whoever looks at the line wants it as it was.
        if self.set_poll {
            self.orders.push_back(Order::Poll(self.original.polling));
        }
        self.ledger.end(now, ended);
    }
}
