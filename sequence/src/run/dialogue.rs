//! Steps that send, and what comes of it.

use std::collections::VecDeque;
use std::time::Duration;

use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::pdu::Request;

use super::ask::{self, Task};
use super::{Doing, FORGOTTEN, Order, Run, memory};
use crate::report::{Exchange, Heard, Reason};
use crate::script::{Action, Asking, Repeat, Sending, Time};

/// A step that sends.
#[derive(Debug)]
pub(super) struct Dialogue {
    pub(super) entry: usize,
    unit: UnitId,
    /// `None` for a `send`.
    asking: Option<Asking>,
    tasks: VecDeque<Task>,
    wait: Option<Time>,
    /// The next step judges the answer, whatever it is.
    judged: bool,
    /// What is on its way.
    pub(super) pending: Option<Pending>,
    /// A write waits for the device's pace.
    pub(super) not_before: Option<Instant>,
}

/// Something on its way.
#[derive(Debug)]
pub(super) struct Pending {
    pub(super) id: u32,
    pub(super) unit: UnitId,
    /// What it asks, whatever its check; `None` for bytes that are no request.
    pub(super) request: Option<Request>,
    /// When it is given up.
    pub(super) until: Instant,
}

impl Run {
    pub(super) fn begin_sending(&mut self, at: usize, entry: usize, sending: &Sending) {
        let bytes = ask::payload(sending, self.unit);
        self.doing = Doing::Asking(Box::new(Dialogue {
            entry,
            unit: self.unit,
            asking: None,
            tasks: [Task::Raw(bytes)].into(),
            wait: sending.within.or(self.time_out),
            judged: self.is_judged(at),
            pending: None,
            not_before: None,
        }));
    }

    pub(super) fn begin_asking(&mut self, at: usize, entry: usize, asking: &Asking) {
        let unit = asking.unit.unwrap_or(self.unit);
        self.doing = Doing::Asking(Box::new(Dialogue {
            entry,
            unit,
            tasks: ask::tasks(asking, unit, &self.memory),
            wait: asking.within.or(self.time_out),
            asking: Some(asking.clone()),
            judged: self.is_judged(at),
            pending: None,
            not_before: None,
        }));
    }

    /// Whether what comes next says which answer is right: an `expect` or an `if` about the answer, or the `until` of the
    /// round that ends here.
    fn is_judged(&self, at: usize) -> bool {
        let mut following = self.sequence.steps.iter().skip(at + 1).map(|step| &step.action);
        match following.find(|action| !matches!(action, Action::Log(_) | Action::Wait(_))) {
            Some(Action::Expect(condition) | Action::If { condition, .. }) => condition.judges_the_answer(),
            Some(Action::End { begin }) => match self.sequence.steps.get(*begin).map(|step| &step.action) {
                Some(Action::Repeat { how: Repeat::Until { condition, .. }, .. }) => condition.judges_the_answer(),
                _ => false,
            },
            _ => false,
        }
    }

    /// Sends the next part of a step, or ends it.
    pub(super) fn send_next(&mut self, now: Instant) {
        let Doing::Asking(dialogue) = &mut self.doing else { return };
        let (entry, unit, mode) = (dialogue.entry, dialogue.unit, self.line.mode);
        let Some(task) = dialogue.tasks.front().cloned() else { return self.step_over(now, entry, None, true) };
        let spoiled = dialogue.asking.as_ref().is_some_and(|asking| asking.wrong_check);
        let request: Result<Option<(UnitId, Request)>, Reason> = match (&task, &dialogue.asking) {
            (Task::Raw(bytes), _) => Ok(memory::request_in(mode, bytes)),
            (Task::Before(group), _) => Ok(group.request().map(|request| (unit, request))),
            (Task::Main(request), _) => Ok(Some((unit, request.clone()))),
            (Task::Write, Some(asking)) => {
                ask::write_request(asking, unit, &self.memory).map(|request| Some((unit, request)))
            }
            (Task::Write, None) => Ok(None),
        };
        let request = match request {
            Ok(request) => request,
            Err(reason) => return self.step_over(now, entry, Some(reason), true),
        };
        let writes = request.as_ref().is_some_and(|(_, request)| request.is_write());
        if writes {
            let pace = self.memory.profile.as_ref().map_or(0, |profile| profile.timing.min_write_period_ms);
            let earliest = self.wrote_at.map(|at| at + Duration::from_millis(pace.into()));
            if let Some(earliest) = earliest.filter(|earliest| *earliest > now) {
                dialogue.not_before = Some(earliest);
                return;
            }
            self.wrote_at = Some(now);
        }
        dialogue.tasks.pop_front();
        let before = matches!(task, Task::Before(_));
        let bytes = match (task, &request) {
            (Task::Raw(bytes), _) => bytes,
            (_, Some((_, request))) => ask::frame(mode, unit, request, spoiled && !before).unwrap_or_default(),
            _ => Vec::new(),
        };
        let id = self.next_id;
        self.next_id = self.next_id.wrapping_add(1);
        let wait_ms = dialogue.wait.map(Time::milliseconds);
        let until = now + Duration::from_millis(wait_ms.unwrap_or_default().into()) + FORGOTTEN;
        let (unit, request) = request.map_or((unit, None), |(unit, request)| (unit, Some(request)));
        dialogue.pending = Some(Pending { id, unit, request, until });
        dialogue.not_before = None;
        self.orders.push_back(Order::Send { id, bytes: bytes.clone(), wait_ms });
        self.ledger.entry(entry, |entry| {
            entry.exchanges.push(Exchange { sent: bytes, heard: Vec::new(), round_trip_us: None, end: None });
        });
    }

    /// An exchange has ended: the step goes on, or is over. Raw bytes need no answer; a request does, unless the next step
    /// judges it.
    pub(super) fn heard(&mut self, now: Instant, heard: Heard) {
        let Doing::Asking(dialogue) = &self.doing else { return };
        let good = matches!(heard, Heard::Reply | Heard::Broadcast);
        if good && !dialogue.tasks.is_empty() {
            return;
        }
        let fails = !good && !dialogue.judged && dialogue.asking.is_some();
        let entry = dialogue.entry;
        self.step_over(now, entry, fails.then_some(Reason::NoReply(heard)), true);
    }
}
