//! A sequence that is carried out on the line.

use std::sync::Arc;
use std::time::Duration;

use buslens_bus::record::{Origin, Outcome};
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::profile::Profile;
use buslens_sequence::{Fault, Line, Order, Run, Sequence, parse};

use super::outbox::{News, Outbox};
use crate::line::{LineState, ToLine};
use crate::message::FromConsole;

/// Nobody reads faster what a sequence has done. Its end is told at once.
const NEWS_PERIOD: Duration = Duration::from_millis(60);

/// What is needed to read a sequence, and to run it.
pub(super) struct Wish {
    /// Names the answers.
    pub(super) edition: u32,
    pub(super) text: String,
    /// The device's profile, as the text of its file; empty for none.
    pub(super) profile: String,
}

impl Wish {
    fn read(&self) -> (Option<Profile>, Result<Sequence, Vec<Fault>>) {
        let profile = Profile::from_json(&self.profile).ok();
        let sequence = parse(&self.text, profile.as_ref());
        (profile, sequence)
    }
}

/// Looks for faults in a sequence.
pub(super) fn check(wish: &Wish, out: &mut Outbox) {
    tell_faults(wish.edition, &wish.read().1, out);
}

fn tell_faults(edition: u32, sequence: &Result<Sequence, Vec<Fault>>, out: &mut Outbox) {
    let (faults, cautions) = match sequence {
        Ok(sequence) => (Vec::new(), sequence.cautions().to_vec()),
        Err(faults) => (faults.clone(), Vec::new()),
    };
    out.tell(FromConsole::Checked { edition, faults, cautions });
}

/// A sequence under way.
#[derive(Debug)]
pub(super) struct Running {
    edition: u32,
    run: Run,
    /// The engine's number and the sequence's of what has not ended.
    asked: Vec<(u32, u32)>,
    buffer_bytes: u32,
    news: News,
}

impl Running {
    /// Begins, unless there is a fault, which is told.
    pub(super) fn begin(
        now: Instant,
        wish: &Wish,
        unit: u8,
        state: Option<&LineState>,
        out: &mut Outbox,
    ) -> Option<Self> {
        let (profile, sequence) = wish.read();
        tell_faults(wish.edition, &sequence, out);
        let run = Run::new(Arc::new(sequence.ok()?), UnitId(unit), profile.map(Arc::new), line_of(state), now);
        let buffer_bytes = state.map_or(8192, |state| state.buffer_bytes);
        let mut news = News::every(NEWS_PERIOD);
        news.change();
        Some(Self { edition: wish.edition, run, asked: Vec::new(), buffer_bytes, news })
    }

    /// Something with this number of the engine's has ended; whether it was this sequence's.
    pub(super) fn done(&mut self, now: Instant, id: u32, outcome: &Outcome) -> bool {
        let Some(place) = self.asked.iter().position(|(asked, _)| *asked == id) else { return false };
        let (_, id) = self.asked.remove(place);
        self.run.done(now, id, outcome);
        self.news.change();
        true
    }

    pub(super) fn hear_state(&mut self, now: Instant, state: &LineState) {
        self.buffer_bytes = state.buffer_bytes;
        self.run.state(now, line_of(Some(state)));
        self.news.change();
    }

    pub(super) fn stop(&mut self, now: Instant) {
        self.run.stop(now);
        self.news.change();
    }

    pub(super) fn handle_time(&mut self, now: Instant) {
        if self.run.poll_timeout().is_some_and(|due| due <= now) {
            self.run.timeout(now);
            self.news.change();
        }
    }

    /// Hands on what the sequence wants, and tells what it has done. Due after everything above; whether it goes on.
    pub(super) fn drain(&mut self, now: Instant, out: &mut Outbox) -> bool {
        while let Some(order) = self.run.poll_order() {
            let order = self.translate(order, out);
            out.order(order);
        }
        let ended = self.run.has_ended();
        if (self.news.take(now) || ended)
            && let Some(changes) = self.run.poll_changes()
        {
            out.tell(FromConsole::Run { edition: self.edition, changes });
        }
        !ended
    }

    /// When [`Self::handle_time`] and [`Self::drain`] have something to do next.
    pub(super) fn due(&self) -> Option<Instant> {
        [self.run.poll_timeout(), self.news.due()].into_iter().flatten().min()
    }

    fn translate(&mut self, order: Order, out: &mut Outbox) -> ToLine {
        match order {
            Order::Send { id, bytes, wait_ms } => {
                let number = out.number();
                self.asked.push((number, id));
                ToLine::Send { id: number, origin: Origin::Sequence, bytes, wait_ms }
            }
            Order::Withdraw(id) => {
                let asked = self.asked.iter().find(|(_, own)| *own == id);
                // What has ended cannot be withdrawn, and number 0 is nobody's.
                ToLine::Withdraw(asked.map_or(0, |(number, _)| *number))
            }
            Order::Settings { line, mode } => ToLine::Settings { line, mode, buffer_bytes: self.buffer_bytes },
            Order::Poll(on) => ToLine::Poll(on),
            Order::Signals { dtr, rts } => ToLine::Signals { dtr, rts },
            Order::Break(milliseconds) => ToLine::Break(milliseconds),
        }
    }
}

/// The line as a sequence sees it. In a replay nothing can be sent.
fn line_of(state: Option<&LineState>) -> Line {
    match state {
        Some(state) => {
            Line { open: state.open && !state.replay, line: state.line, mode: state.mode, polling: state.polling }
        }
        None => Line { open: false, line: LineSettings::new(9600, Parity::None), mode: Mode::Rtu, polling: false },
    }
}
