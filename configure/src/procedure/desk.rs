//! What a procedure has in its hands: the line and what is heard of it, the clock, the device. All waiting is done here.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::future::poll_fn;
use std::sync::Arc;
use std::task::Poll;
use std::time::Duration;

use buslens_bus::record::{End, Outcome};
use buslens_bus::time::Instant;
use buslens_codec::pdu::Request;
use buslens_codec::profile::{Point, Profile};

use super::{Line, Order, Port};
use crate::request::{Answer, answer, frame};
use crate::{AuditEntry, Device, Ending, Exchange, Journal, Phase, Progress, Reach, Report, Snapshot};

/// How long a port may take to come back with other settings.
const REOPENING: Duration = Duration::from_secs(5);
/// An exchange that was not answered for so long beyond any time-out, is given up.
const FORGOTTEN: Duration = Duration::from_secs(30);
/// A journal that was not kept by then is not kept.
const KEEPING: Duration = Duration::from_secs(10);
/// USB adapters hold bytes back: a latency timer of 16 ms is common, and the system adds its own.
const USB_SLACK: Duration = Duration::from_millis(50);
/// A device that writes to its memory before it answers takes longer than for a read.
const SHORTEST_WRITE: Duration = Duration::from_millis(200);
/// The longest reply that is waited for in a search, in characters: an ASCII frame with eight registers.
const REPLY_CHARACTERS: usize = 47;

/// Why a procedure cannot go on as it would.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// The port is closed or gone.
    Gone,
    /// It was cancelled.
    Cancelled,
    /// Only reads are let out.
    ReadOnly,
    /// The journal could not be kept.
    NotKept,
}

/// What a procedure has in its hands.
#[derive(Debug)]
pub(super) struct Desk(RefCell<State>);

#[derive(Debug)]
struct State {
    now: Instant,
    began: Instant,
    began_unix_ms: u64,
    device: Device,
    line: Line,
    original: Line,
    /// The polling was stopped by this procedure.
    stopped_polling: bool,
    orders: VecDeque<Order>,
    next_id: u32,
    outcome: Option<(u32, Outcome)>,
    kept: Option<(u64, bool)>,
    until: Option<Instant>,
    /// How often it was cancelled, and how often it must be so that it is looked at: once at first, once more while what
    /// was written is being undone, and no more while the port is set as it stays.
    cancelled: u32,
    cancelled_by: u32,
    wrote_at: Option<Instant>,
    writes: u32,
    exchanges: Vec<Exchange>,
    progress: Progress,
    told: Option<Progress>,
}

impl Desk {
    pub(super) fn new(now: Instant, unix_ms: u64, device: Device, line: Line) -> Self {
        Self(RefCell::new(State {
            now,
            began: now,
            began_unix_ms: unix_ms,
            line,
            original: line,
            stopped_polling: false,
            device,
            orders: VecDeque::new(),
            next_id: 0,
            outcome: None,
            kept: None,
            until: None,
            cancelled: 0,
            cancelled_by: 1,
            wrote_at: None,
            writes: 0,
            exchanges: Vec::new(),
            progress: Progress { phase: Phase::Beginning, done: 0, total: 0, left_ms: None },
            told: None,
        }))
    }

    // What happened.

    pub(super) fn set_clock(&self, now: Instant) {
        let mut state = self.0.borrow_mut();
        state.now = state.now.max(now);
    }

    pub(super) fn take_outcome(&self, id: u32, outcome: &Outcome) {
        self.0.borrow_mut().outcome = Some((id, outcome.clone()));
    }

    pub(super) fn take_line(&self, line: Line) {
        self.0.borrow_mut().line = line;
    }

    pub(super) fn take_kept(&self, journal: u64, kept: bool) {
        self.0.borrow_mut().kept = Some((journal, kept));
    }

    pub(super) fn cancel(&self) {
        self.0.borrow_mut().cancelled += 1;
    }

    // What to do about it.

    pub(super) fn next_order(&self) -> Option<Order> {
        self.0.borrow_mut().orders.pop_front()
    }

    pub(super) fn due(&self) -> Option<Instant> {
        self.0.borrow().until
    }

    pub(super) fn next_progress(&self) -> Option<Progress> {
        let mut state = self.0.borrow_mut();
        if state.told.as_ref() == Some(&state.progress) {
            return None;
        }
        state.told = Some(state.progress.clone());
        state.told.clone()
    }

    // What is known.

    pub(super) fn device(&self) -> Device {
        self.0.borrow().device.clone()
    }

    pub(super) fn profile(&self) -> Arc<Profile> {
        Arc::clone(&self.0.borrow().device.profile)
    }

    pub(super) fn reach(&self) -> Reach {
        self.0.borrow().device.reach
    }

    pub(super) fn now(&self) -> Instant {
        self.0.borrow().now
    }

    /// The time of day, in milliseconds since the Unix epoch.
    pub(super) fn unix_ms(&self) -> u64 {
        let state = self.0.borrow();
        let since = state.now.saturating_since(state.began).as_millis();
        state.began_unix_ms.saturating_add(u64::try_from(since).unwrap_or(u64::MAX))
    }

    pub(super) fn is_read_only(&self) -> bool {
        self.0.borrow().line.read_only
    }

    /// Writes that have left.
    pub(super) fn writes(&self) -> u32 {
        self.0.borrow().writes
    }

    /// How long to wait at these settings for a device that thinks no longer than its profile says.
    pub(super) fn full_wait(&self, reach: Reach) -> Duration {
        let longest = self.0.borrow().device.profile.timing.response_timeout_ms;
        Duration::from_millis(longest.into()) + reach.line.character_time(REPLY_CHARACTERS) + USB_SLACK
    }

    /// How long to wait at these settings for a device that thinks about as long as it did before.
    pub(super) fn short_wait(&self, reach: Reach) -> Duration {
        self.known_wait(reach, 4, USB_SLACK * 2)
    }

    /// How long to wait at these settings for another one of the device's own kind, behind the same adapter.
    pub(super) fn brief_wait(&self, reach: Reach) -> Duration {
        self.known_wait(reach, 2, USB_SLACK)
    }

    /// A wait of so many times what the device has needed, if that is known yet.
    fn known_wait(&self, reach: Reach, times: u32, slack: Duration) -> Duration {
        let slowest = Duration::from_micros(self.0.borrow().device.slowest_us.into());
        let full = self.full_wait(reach);
        if slowest.is_zero() {
            return full;
        }
        (slowest * times + slack + reach.line.character_time(REPLY_CHARACTERS)).min(full)
    }

    /// How long to wait for the reply to a write that may come with settings that the port has not yet.
    pub(super) fn write_wait(&self, reach: Reach) -> Duration {
        self.short_wait(reach).max(SHORTEST_WRITE).min(self.full_wait(reach))
    }

    /// The exchanges since the last call.
    pub(super) fn take_exchanges(&self) -> Vec<Exchange> {
        std::mem::take(&mut self.0.borrow_mut().exchanges)
    }

    /// An empty snapshot that is taken now.
    pub(super) fn snapshot(&self, reach: Reach) -> Snapshot {
        let taken_unix_ms = self.unix_ms();
        Snapshot { taken_unix_ms, ..Snapshot::empty(&self.profile(), reach) }
    }

    pub(super) fn learn(&self, change: impl FnOnce(&mut Device)) {
        change(&mut self.0.borrow_mut().device);
    }

    /// A report without steps.
    pub(super) fn report(&self, ending: Ending, reach: Option<Reach>, snapshot: Option<Snapshot>) -> Report {
        let state = self.0.borrow();
        let took = state.now.saturating_since(state.began).as_micros();
        Report {
            ending,
            steps: Vec::new(),
            reach,
            candidates: Vec::new(),
            snapshot,
            journal: None,
            writes: state.writes,
            took_us: u64::try_from(took).unwrap_or(u64::MAX),
        }
    }

    pub(super) fn progress(&self, phase: Phase, done: usize, total: usize, left: Option<Duration>) {
        let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        let left_ms = left.map(|left| u32::try_from(left.as_millis()).unwrap_or(u32::MAX));
        self.0.borrow_mut().progress = Progress { phase, done: count(done), total: count(total), left_ms };
    }

    /// From now on only another cancellation is looked at.
    pub(super) fn clean_up(&self) {
        let mut state = self.0.borrow_mut();
        state.cancelled_by = state.cancelled.saturating_add(1);
    }

    // What is done.

    /// Waits until something is seen, or the time has come: then `None`.
    async fn wait<T>(&self, until: Option<Instant>, mut look: impl FnMut(&mut State) -> Option<T>) -> Option<T> {
        let found = poll_fn(|_| {
            let mut state = self.0.borrow_mut();
            if let Some(found) = look(&mut state) {
                return Poll::Ready(Some(found));
            }
            if until.is_some_and(|until| until <= state.now) {
                return Poll::Ready(None);
            }
            state.until = until;
            Poll::Pending
        })
        .await;
        self.0.borrow_mut().until = None;
        found
    }

    /// Lets time pass.
    pub(super) async fn pause(&self, time: Duration) -> Result<(), Stop> {
        let until = self.now() + time;
        let stopped = self.wait(Some(until), |state| state.stop()).await;
        stopped.map_or(Ok(()), Err)
    }

    /// Leaves the line to this procedure alone.
    pub(super) fn stop_polling(&self) {
        let mut state = self.0.borrow_mut();
        if state.line.polling && !state.stopped_polling {
            state.stopped_polling = true;
            state.orders.push_back(Order::Poll(false));
        }
    }

    /// Leaves the port as this reach needs it, and the polling to the device there; without one both as they were.
    pub(super) async fn close(&self, stay: Option<Reach>) {
        let original = {
            let mut state = self.0.borrow_mut();
            state.cancelled_by = u32::MAX;
            Reach { line: state.original.line, mode: state.original.mode, ..state.device.reach }
        };
        self.progress(Phase::Ending, 0, 0, None);
        // A port that does not come back is told by its own state.
        let _ = self.enter(stay.unwrap_or(original)).await;
        let mut state = self.0.borrow_mut();
        if let Some(reach) = stay {
            state.device.reach = reach;
            state.orders.push_back(Order::Unit(reach.unit));
        }
        if std::mem::take(&mut state.stopped_polling) {
            state.orders.push_back(Order::Poll(true));
        }
    }

    /// Has a journal kept, and waits until it is.
    pub(super) async fn keep(&self, journal: &Journal) -> Result<(), Stop> {
        {
            let mut state = self.0.borrow_mut();
            state.kept = None;
            state.orders.push_back(Order::Keep(Box::new(journal.clone())));
        }
        let until = self.now() + KEEPING;
        let seen = self.wait(Some(until), |state| {
            let kept = state.kept.take_if(|(id, _)| *id == journal.id);
            kept.map(|(_, kept)| kept)
        });
        if seen.await == Some(true) { Ok(()) } else { Err(Stop::NotKept) }
    }

    /// Has a journal forgotten.
    pub(super) fn forget(&self, journal: u64) {
        self.0.borrow_mut().orders.push_back(Order::Forget(journal));
    }

    /// Writes a point, no sooner after the last write than the device likes, and has it kept for the audit.
    pub(super) async fn write(
        &self,
        reach: Reach,
        request: &Request,
        (point, old, new): (&Point, Option<&[u16]>, &[u16]),
        wait: Option<Duration>,
    ) -> Result<Answer, Stop> {
        if !self.enter(reach).await? {
            return Ok(Answer::Silence);
        }
        let period = Duration::from_millis(self.profile().timing.min_write_period_ms.into());
        let last = self.0.borrow().wrote_at;
        if let Some(last) = last {
            self.pause((last + period).saturating_since(self.now())).await?;
        }
        let before = self.0.borrow().exchanges.len();
        let answer = self.ask(reach, request, wait).await;
        if matches!(answer, Err(Stop::ReadOnly | Stop::Cancelled | Stop::NotKept)) {
            return answer;
        }
        let unix_ms = self.unix_ms();
        let mut state = self.0.borrow_mut();
        state.wrote_at = Some(state.now);
        state.writes += 1;
        let exchange = state.exchanges.get(before).cloned();
        let (sent, received, end) = match exchange {
            Some(exchange) => (exchange.sent, exchange.heard, exchange.end),
            // The port vanished before anybody could tell whether it has left.
            None => (frame(reach, request).unwrap_or_default(), Vec::new(), End::NoPort),
        };
        let entry = AuditEntry {
            unix_ms,
            profile: state.device.profile.id.clone(),
            reach,
            point: point.id.clone(),
            old: old.map(<[u16]>::to_vec),
            new: new.to_vec(),
            sent,
            received,
            end,
        };
        state.orders.push_back(Order::Audit(Box::new(entry)));
        answer
    }

    /// Sets the port as a reach needs it, and says whether the port has taken it.
    pub(super) async fn enter(&self, reach: Reach) -> Result<bool, Stop> {
        let is_set = |state: &State| (state.line.line, state.line.mode) == (reach.line, reach.mode);
        {
            let mut state = self.0.borrow_mut();
            if let Some(stop) = state.stop() {
                return Err(stop);
            }
            if is_set(&state) && state.line.port == Port::Open {
                return Ok(true);
            }
            if !(is_set(&state) && state.line.port == Port::Changing) {
                state.orders.push_back(Order::Settings { line: reach.line, mode: reach.mode });
            }
        }
        let until = self.now() + REOPENING;
        let seen = self.wait(Some(until), |state| match state.line.port {
            Port::Gone => Some(Err(Stop::Gone)),
            Port::Open if is_set(state) => Some(Ok(true)),
            Port::Refused if is_set(state) => Some(Ok(false)),
            _ => state.stop().map(Err),
        });
        seen.await.unwrap_or(Ok(false))
    }

    /// Asks, at these settings. A port that does not take them is silent.
    pub(super) async fn ask(&self, reach: Reach, request: &Request, wait: Option<Duration>) -> Result<Answer, Stop> {
        if !self.enter(reach).await? {
            return Ok(Answer::Silence);
        }
        let Some(bytes) = frame(reach, request) else { return Ok(Answer::Unclear) };
        let wait_ms = wait.map(|wait| u32::try_from(wait.as_millis()).unwrap_or(u32::MAX));
        let id = {
            let mut state = self.0.borrow_mut();
            if let Some(stop) = state.stop() {
                return Err(stop);
            }
            let id = state.next_id;
            state.next_id += 1;
            state.outcome = None;
            state.orders.push_back(Order::Send { id, bytes: bytes.clone(), wait_ms });
            id
        };
        let outcome = self.outcome_of(id, wait).await?;
        let end = outcome.end;
        self.0.borrow_mut().note(reach, bytes, &outcome);
        match end {
            End::NoPort => Err(Stop::Gone),
            End::ReadOnly => Err(Stop::ReadOnly),
            End::Withdrawn => Err(Stop::Cancelled),
            _ => Ok(answer(reach.mode, request, &outcome)),
        }
    }

    /// How sending ends. It is withdrawn when the procedure is cancelled; what has left already still ends.
    async fn outcome_of(&self, id: u32, wait: Option<Duration>) -> Result<Outcome, Stop> {
        let longest = self.now() + FORGOTTEN + wait.unwrap_or_default();
        let mut withdrawn = false;
        let seen = self.wait(Some(longest), |state| {
            if let Some((_, outcome)) = state.outcome.take_if(|(own, _)| *own == id) {
                return Some(Ok(outcome));
            }
            if state.line.port == Port::Gone {
                return Some(Err(Stop::Gone));
            }
            if !withdrawn && state.stop() == Some(Stop::Cancelled) {
                withdrawn = true;
                state.orders.push_back(Order::Withdraw(id));
            }
            None
        });
        if let Some(outcome) = seen.await {
            return outcome;
        }
        self.0.borrow_mut().orders.push_back(Order::Withdraw(id));
        Err(Stop::Gone)
    }
}

impl State {
    /// Whether it cannot go on.
    fn stop(&self) -> Option<Stop> {
        if self.line.port == Port::Gone {
            Some(Stop::Gone)
        } else if self.cancelled >= self.cancelled_by {
            Some(Stop::Cancelled)
        } else {
            None
        }
    }

    /// Remembers an exchange and learns from it.
    fn note(&mut self, reach: Reach, sent: Vec<u8>, outcome: &Outcome) {
        if let (End::Answered, Some(round_trip_us)) = (outcome.end, outcome.round_trip_us) {
            let on_wire = reach.line.character_time(sent.len() + outcome.heard.len()).as_micros();
            let thought = round_trip_us.saturating_sub(u32::try_from(on_wire).unwrap_or(u32::MAX));
            self.device.slowest_us = self.device.slowest_us.max(thought).max(1);
        }
        self.exchanges.push(Exchange {
            reach,
            sent,
            heard: outcome.heard.clone(),
            round_trip_us: outcome.round_trip_us,
            end: outcome.end,
        });
    }
}
