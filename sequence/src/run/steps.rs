//! Steps, one after the other.

use std::sync::Arc;
use std::time::Duration;

use buslens_bus::time::Instant;
use buslens_codec::line::LineSettings;

use super::{Doing, Order, REOPENING, Round, Run};
use crate::report::{Branch, Ended, Reason};
use crate::script::{Action, Condition, LineChange, OnFailure, Repeat, Time};

impl Run {
    pub(super) fn begin_step(&mut self, now: Instant) {
        let at = self.next;
        let sequence = Arc::clone(&self.sequence);
        let Some(step) = sequence.steps.get(at) else { return };
        self.next += 1;
        match &step.action {
            Action::Title(_) | Action::Device(_) => return,
            Action::End { begin } => return self.end_of_block(now, *begin),
            // Reached from above: the branch before it was taken.
            Action::Else { end } | Action::ElseIf { end, .. } => {
                self.next = *end;
                return;
            }
            _ => {}
        }
        let entry = self.ledger.begin(now, at, step.line);
        match &step.action {
            Action::Unit(unit) => self.unit = *unit,
            Action::Timeout(time) => self.time_out = Some(*time),
            Action::OnFailure(what) => self.on_failure = *what,
            Action::Line(change) => return self.change_line(now, entry, *change),
            Action::Poll(on) => {
                self.set_poll = true;
                self.orders.push_back(Order::Poll(*on));
            }
            Action::Dtr(on) => self.orders.push_back(Order::Signals { dtr: Some(*on), rts: None }),
            Action::Rts(on) => self.orders.push_back(Order::Signals { dtr: None, rts: Some(*on) }),
            Action::Break(time) => {
                self.orders.push_back(Order::Break(time.milliseconds()));
                return self.wait(now, entry, *time);
            }
            Action::Wait(time) => return self.wait(now, entry, *time),
            Action::Send(sending) => return self.begin_sending(at, entry, sending),
            Action::Ask(asking) => return self.begin_asking(at, entry, asking),
            Action::Expect(condition) => {
                let reason = self.judge(entry, condition).err();
                return self.step_over(now, entry, reason, true);
            }
            Action::If { condition, next } => return self.branch(now, entry, condition, *next),
            Action::Repeat { .. } => {
                self.blocks.push(Round { begin: at, rounds: 0, entry });
                return;
            }
            Action::Let { name, value } => {
                let value = self.memory.evaluate(value);
                if let Ok(datum) = &value {
                    self.ledger.entry(entry, |entry| entry.text = datum.to_string());
                }
                let reason = value.map(|datum| self.memory.keep(name, datum)).err();
                return self.step_over(now, entry, reason, false);
            }
            Action::Log(pieces) | Action::Fail(pieces) => {
                let text = self.memory.fill(pieces);
                self.ledger.entry(entry, |entry| entry.text = text);
                let fails = matches!(step.action, Action::Fail(_));
                return self.step_over(now, entry, fails.then_some(Reason::Fail), false);
            }
            Action::Stop => {
                self.ledger.finish(now, entry, None, false);
                return self.end(now, Ended::StopStep);
            }
            Action::Title(_) | Action::Device(_) | Action::End { .. } | Action::Else { .. } | Action::ElseIf { .. } => {
            }
        }
        self.step_over(now, entry, None, false);
    }

    /// Ends a step, and the run where a failure does.
    pub(super) fn step_over(&mut self, now: Instant, entry: usize, reason: Option<Reason>, counts: bool) {
        let failed = reason.is_some();
        self.ledger.finish(now, entry, reason, counts);
        self.doing = Doing::Nothing;
        if failed && self.on_failure == OnFailure::Stop {
            self.end(now, Ended::Failure);
        }
    }

    fn judge(&mut self, entry: usize, condition: &Condition) -> Result<(), Reason> {
        let (result, compared) = self.memory.judge(condition);
        self.ledger.entry(entry, |entry| entry.compared = compared);
        result
    }

    fn wait(&mut self, now: Instant, entry: usize, time: Time) {
        self.doing = Doing::Waiting { until: now + Duration::from_micros(time.0), entry: Some(entry) };
    }

    // Branches and rounds.

    /// An `if`, and those of its `else if` that are asked after it. A condition that cannot be judged does not hold; that
    /// nothing was read or heard is a failure all the same.
    fn branch(&mut self, now: Instant, entry: usize, condition: &Condition, next: usize) {
        let sequence = Arc::clone(&self.sequence);
        let result = self.judge(entry, condition);
        let holds = result.is_ok();
        self.ledger.entry(entry, |entry| entry.outcome = Some(if holds { Branch::Then } else { Branch::Else }));
        let unknown = result
            .err()
            .filter(|reason| !matches!(reason, Reason::DoesNotHold | Reason::DoesNotFit | Reason::OtherwiseHeard(_)));
        self.step_over(now, entry, unknown, false);
        if holds || self.has_ended() {
            return;
        }
        self.next = next + 1;
        match sequence.steps.get(next).map(|step| (step.line, &step.action)) {
            Some((line, Action::ElseIf { condition, next: further, .. })) => {
                let entry = self.ledger.begin(now, next, line);
                self.branch(now, entry, condition, *further);
            }
            Some((_, Action::Else { .. })) => {}
            // The end itself has nothing to do.
            _ => self.next = next,
        }
    }

    fn end_of_block(&mut self, now: Instant, begin: usize) {
        let sequence = Arc::clone(&self.sequence);
        let Some(Action::Repeat { how, .. }) = sequence.steps.get(begin).map(|step| &step.action) else { return };
        let Some(round) = self.blocks.last_mut().filter(|round| round.begin == begin) else { return };
        round.rounds = round.rounds.saturating_add(1);
        let (rounds, entry) = (round.rounds, round.entry);
        let (over, reason) = match how {
            Repeat::Forever => (false, None),
            Repeat::Times(times) => (rounds >= *times, None),
            Repeat::Until { condition, at_most } => {
                let holds = self.judge(entry, condition).is_ok();
                let in_vain = !holds && at_most.is_some_and(|most| rounds >= most);
                (holds || in_vain, in_vain.then_some(Reason::NeverHeld(rounds)))
            }
        };
        self.ledger.entry(entry, |entry| entry.outcome = Some(Branch::Rounds(rounds)));
        if over {
            self.blocks.pop();
            self.step_over(now, entry, reason, false);
        } else {
            self.next = begin + 1;
        }
    }

    fn change_line(&mut self, now: Instant, entry: usize, change: LineChange) {
        let (line, mode) = match change {
            LineChange::Original => (self.original.line, self.original.mode),
            LineChange::To { baud, parity, data_bits, stop_bits, mode } => {
                let before = self.line.line;
                let line = LineSettings {
                    baud,
                    parity: parity.unwrap_or(before.parity),
                    data_bits: data_bits.unwrap_or(before.data_bits),
                    stop_bits: stop_bits.unwrap_or(before.stop_bits),
                };
                (line, mode.unwrap_or(self.line.mode))
            }
        };
        if (line, mode) != (self.line.line, self.line.mode) {
            self.orders.push_back(Order::Settings { line, mode });
        }
        self.doing = Doing::Reopening { until: now + REOPENING, entry, line, mode };
    }
}
