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
use buslens_codec::profile::Profile;

use super::{Line, Order, Port};
use crate::request::{Answer, answer, frame};
use crate::{Device, Ending, Exchange, Phase, Progress, Reach, Report, Snapshot};

/// How long a port may take to come back with other settings.
const REOPENING: Duration = Duration::from_secs(5);
/// An exchange that was not answered for so long beyond any time-out, is given up.
const FORGOTTEN: Duration = Duration::from_secs(30);
/// A journal that was not kept by then is not kept.
const KEEPING: Duration = Duration::from_secs(10);

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
    original_reach: Reach,
    orders: VecDeque<Order>,
    next_id: u32,
    outcome: Option<(u32, Outcome)>,
    kept: Option<(u64, bool)>,
    until: Option<Instant>,
    cancelled: bool,
    /// A cancellation is not looked at any more: what was written is being undone.
    cleaning: bool,
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
            original_reach: device.reach,
            device,
            orders: VecDeque::new(),
            next_id: 0,
            outcome: None,
            kept: None,
            until: None,
            cancelled: false,
            cleaning: false,
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
        self.0.borrow_mut().cancelled = true;
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

    /// From now on everything is brought to its end, whatever the user wishes.
    pub(super) fn clean_up(&self) {
        self.0.borrow_mut().cleaning = true;
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
        if state.line.polling {
            state.orders.push_back(Order::Poll(false));
        }
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
        match seen.await {
            Some(outcome) => outcome,
            None => {
                self.0.borrow_mut().orders.push_back(Order::Withdraw(id));
                Err(Stop::Gone)
            }
        }
    }
}

impl State {
    /// Whether it cannot go on.
    fn stop(&self) -> Option<Stop> {
        if self.line.port == Port::Gone {
            Some(Stop::Gone)
        } else if self.cancelled && !self.cleaning {
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
