//! A device being read, set, searched for or brought back. Nothing here opens a port, reads a clock or sets a timer.
//!
//! In: [`Procedure::done`], [`Procedure::state`], [`Procedure::kept`], [`Procedure::not_kept`], [`Procedure::timeout`],
//! [`Procedure::cancel`]. After any of them, and after [`Procedure::begin`], drain [`Procedure::poll_order`] until it is
//! empty and look at [`Procedure::poll_timeout`]; [`Procedure::poll_progress`] as often as somebody looks. A spurious timeout
//! is harmless. [`Procedure::report`] is there once it has ended; the last orders come with it.
//!
//! Inside, a procedure is written as what it is: one thing after the other, awaiting what happens on the line. It is polled
//! whenever something has happened, by nobody but the methods above; there is no executor and no waker.
//!
//! Dropping a procedure stops it where it is: nothing more is sent. If it had begun to write, its journal is kept, and
//! [`Task::Recover`] goes on from there.

mod applying;
mod desk;
mod finding;
mod reading;
mod transaction;

use std::fmt;
use std::future::Future;
use std::pin::Pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};

use buslens_bus::record::Outcome;
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use serde::{Deserialize, Serialize};

use crate::{AuditEntry, Device, Edit, Hazard, Journal, Progress, Reach, Report, Snapshot};
use desk::Desk;

/// What a procedure shall do.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Task {
    /// Read every parameter, in as few requests as the device allows. The polling goes on beside it.
    Read,
    /// Write, as one transaction: all of it or nothing.
    Apply {
        /// What the user was shown. The device is read again before it is written: if what is to be changed differs from
        /// this, nothing is written. What stands not in it is not compared.
        before: Snapshot,
        /// What shall be written.
        edits: Vec<Edit>,
        /// What was confirmed of [`crate::Plan::hazards`].
        confirmed: Vec<Hazard>,
    },
    /// Search the device.
    Find {
        /// Where.
        scope: Scope,
    },
    /// Go on from a journal: find the device, and finish or undo.
    Recover {
        /// The journal.
        journal: Journal,
        /// Which of both.
        way: Way,
    },
}

/// Where to search.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Scope {
    /// Tried first, in this order.
    pub reaches: Vec<Reach>,
    /// Whether to try every combination of settings that the device can have, the factory's first.
    pub everywhere: bool,
    /// Unit ids that are tried at each combination, in this order, of a device that does not tell its unit id when asked
    /// at the broadcast address; of any other if that did not help.
    pub units: Vec<UnitId>,
}

/// How to go on from a journal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Way {
    /// Write what is missing.
    Finish,
    /// Write back what was there before.
    Undo,
}

/// What the line shall do, or who keeps the journals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Order {
    /// Send bytes, and answer with [`Procedure::done`].
    Send {
        /// Names the answer. Counts from 0 in each procedure.
        id: u32,
        /// The bytes.
        bytes: Vec<u8>,
        /// How long to wait for an answer, in milliseconds; `None` leaves it to the master.
        wait_ms: Option<u32>,
    },
    /// Take back what has not been sent yet of this number.
    Withdraw(u32),
    /// Other settings of the port. [`Procedure::state`] tells when they hold, or that the port refuses them. A port that
    /// has refused the settings before is opened again.
    Settings {
        /// Settings of the port.
        line: LineSettings,
        /// RTU or ASCII.
        mode: Mode,
    },
    /// Poll the device, or leave the line to others.
    Poll(bool),
    /// Whom the polling asks from now on.
    Unit(UnitId),
    /// Keep this journal in place of any other with its id where it outlives the page, and answer with
    /// [`Procedure::kept`] or [`Procedure::not_kept`].
    Keep(Box<Journal>),
    /// Forget the journal with this id: the device is known to be all right.
    Forget(u64),
    /// Keep what was written.
    Audit(Box<AuditEntry>),
}

/// The line, as far as a procedure needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Whether bytes can be sent now.
    pub port: Port,
    /// Settings of the port, or those that it shall have or has refused.
    pub line: LineSettings,
    /// RTU or ASCII.
    pub mode: Mode,
    /// Whether the device is polled.
    pub polling: bool,
    /// Whether only reads are let out.
    pub read_only: bool,
}

/// How a port is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// Open, with the settings that are told.
    Open,
    /// Being opened with them.
    Changing,
    /// It could not be opened with them. Others may do.
    Refused,
    /// Closed by its user, or unplugged.
    Gone,
}

/// Something being done to a device.
pub struct Procedure {
    desk: Rc<Desk>,
    /// `None` once it has ended.
    work: Option<Pin<Box<dyn Future<Output = Report>>>>,
    report: Option<Report>,
}

impl Procedure {
    /// Begins. `unix_ms` is the time of day, in milliseconds since the Unix epoch; `device` is what the one before gave
    /// back, or [`Device::new`]. For [`Task::Recover`] it is [`Journal::device`].
    pub fn begin(now: Instant, unix_ms: u64, task: Task, device: Device, line: Line) -> Self {
        let desk = Rc::new(Desk::new(now, unix_ms, device, line));
        let work = Box::pin(carry_out(Rc::clone(&desk), task));
        let mut procedure = Self { desk, work: Some(work), report: None };
        procedure.go_on(now);
        procedure
    }

    /// Whether nothing more will come.
    pub fn has_ended(&self) -> bool {
        self.work.is_none()
    }

    /// What has come of it, once it has ended.
    pub fn report(&self) -> Option<&Report> {
        self.report.as_ref()
    }

    /// The device as it is known now.
    pub fn device(&self) -> Device {
        self.desk.device()
    }

    // What happened.

    /// An [`Order::Send`] has ended.
    pub fn done(&mut self, now: Instant, id: u32, outcome: &Outcome) {
        self.desk.take_outcome(id, outcome);
        self.go_on(now);
    }

    /// The line is so now.
    pub fn state(&mut self, now: Instant, line: Line) {
        self.desk.take_line(line);
        self.go_on(now);
    }

    /// The journal with this id was kept.
    pub fn kept(&mut self, now: Instant, journal: u64) {
        self.desk.take_kept(journal, true);
        self.go_on(now);
    }

    /// The journal with this id could not be kept.
    pub fn not_kept(&mut self, now: Instant, journal: u64) {
        self.desk.take_kept(journal, false);
        self.go_on(now);
    }

    /// Time has passed.
    pub fn timeout(&mut self, now: Instant) {
        self.go_on(now);
    }

    /// It shall stop. What was written is undone first: it has ended when [`Procedure::report`] is there. A second time
    /// stops the undoing, too; then the journal stays open.
    pub fn cancel(&mut self, now: Instant) {
        self.desk.cancel();
        self.go_on(now);
    }

    // What to do about it.

    /// What shall be done.
    pub fn poll_order(&mut self) -> Option<Order> {
        self.desk.next_order()
    }

    /// When [`Procedure::timeout`] is due.
    pub fn poll_timeout(&self) -> Option<Instant> {
        self.work.as_ref().and_then(|_| self.desk.due())
    }

    /// How far it has come, if that has changed since the last call.
    pub fn poll_progress(&mut self) -> Option<Progress> {
        self.desk.next_progress()
    }

    fn go_on(&mut self, now: Instant) {
        self.desk.set_clock(now);
        let Some(work) = &mut self.work else { return };
        if let Poll::Ready(report) = work.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            self.report = Some(report);
            self.work = None;
        }
    }
}

impl fmt::Debug for Procedure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Procedure").field("desk", &self.desk).field("report", &self.report).finish_non_exhaustive()
    }
}

async fn carry_out(desk: Rc<Desk>, task: Task) -> Report {
    match task {
        Task::Read => reading::read_all(&desk).await,
        Task::Apply { before, edits, confirmed } => applying::apply(&desk, before, &edits, confirmed).await,
        Task::Find { scope } => finding::find(&desk, &scope).await,
        Task::Recover { journal, way } => applying::recover(&desk, journal, way).await,
    }
}
