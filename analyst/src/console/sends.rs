//! What the window wants sent: once, or again and again.

use std::time::Duration;

use buslens_bus::record::Origin;
use buslens_bus::time::Instant;
use buslens_codec::ascii;
use buslens_codec::line::Mode;
use buslens_sequence::Pattern;

use super::outbox::{News, Outbox};
use crate::line::{End, Outcome, ToLine};
use crate::message::{FromConsole, Sending, Until};

/// Nobody reads faster how often something was sent. The last time is told at once.
const NEWS_PERIOD: Duration = Duration::from_millis(60);

/// Everything that is being sent.
#[derive(Debug, Default)]
pub(super) struct Sends {
    under_way: Vec<Round>,
}

/// One wish and how it stands.
#[derive(Debug)]
struct Round {
    sending: Sending,
    pattern: Option<Pattern>,
    /// The engine's number of what it has not answered yet.
    asked: Option<u32>,
    /// When the present exchange should have begun; the next one is counted from there.
    begun: Instant,
    /// When the next exchange begins, while none is under way.
    next: Option<Instant>,
    times: u32,
    stopped: bool,
    first_heard: Option<Vec<u8>>,
    last: Option<Outcome>,
    news: News,
}

impl Sends {
    /// Begins to send. Something that is repeated takes the place of whatever was repeated before.
    pub(super) fn begin(&mut self, now: Instant, sending: Sending, out: &mut Outbox) {
        let pattern = match sending.repeat.as_ref().map(|repeat| &repeat.until) {
            Some(Until::Heard(text)) => match Pattern::parse(text) {
                Ok(pattern) => Some(pattern),
                // Nothing would ever end it: it does not begin.
                Err(_) => return refuse(&sending, End::Withdrawn, out),
            },
            _ => None,
        };
        if sending.repeat.as_ref().is_some_and(|repeat| repeat.times == Some(0)) {
            return refuse(&sending, End::Withdrawn, out);
        }
        if sending.repeat.is_some() {
            self.stop(out);
        }
        let mut round = Round {
            sending,
            pattern,
            asked: None,
            begun: now,
            next: None,
            times: 0,
            stopped: false,
            first_heard: None,
            last: None,
            news: News::every(NEWS_PERIOD),
        };
        round.ask(now, out);
        self.under_way.push(round);
    }

    /// Ends everything that is repeated. What is on the line already is waited for.
    pub(super) fn stop(&mut self, out: &mut Outbox) {
        for round in self.under_way.iter_mut().filter(|round| round.sending.repeat.is_some()) {
            round.stopped = true;
            round.next = None;
            match round.asked {
                Some(id) => out.order(ToLine::Withdraw(id)),
                None => round.tell(false, out),
            }
        }
        self.under_way.retain(|round| round.asked.is_some());
    }

    /// Whether something is sent again and again.
    pub(super) fn repeats(&self) -> bool {
        self.under_way.iter().any(|round| round.sending.repeat.is_some())
    }

    /// Whether this number is of something here; then its end is taken note of.
    pub(super) fn done(&mut self, now: Instant, id: u32, outcome: &Outcome, mode: Mode, out: &mut Outbox) -> bool {
        let Some(place) = self.under_way.iter().position(|round| round.asked == Some(id)) else { return false };
        if let Some(round) = self.under_way.get_mut(place)
            && !round.done(now, outcome, mode, out)
        {
            self.under_way.remove(place);
        }
        true
    }

    /// Does what is due.
    pub(super) fn handle_time(&mut self, now: Instant, out: &mut Outbox) {
        for round in &mut self.under_way {
            if round.next.is_some_and(|next| next <= now) {
                round.ask(now, out);
            }
            if round.news.take(now) {
                round.tell(true, out);
            }
        }
    }

    /// When there is something to do next.
    pub(super) fn due(&self) -> Option<Instant> {
        self.under_way.iter().flat_map(|round| [round.next, round.news.due()]).flatten().min()
    }
}

impl Round {
    fn ask(&mut self, now: Instant, out: &mut Outbox) {
        let every = self.every();
        // From beginning to beginning. Who has fallen behind by a whole round does not catch up.
        self.begun = self.next.take().filter(|&next| now.saturating_since(next) < every).unwrap_or(now);
        let id = out.number();
        self.asked = Some(id);
        out.order(ToLine::Send {
            id,
            origin: Origin::Console,
            bytes: self.sending.bytes.clone(),
            wait_ms: self.sending.wait_ms,
        });
    }

    /// An exchange has ended. Whether there will be another one.
    fn done(&mut self, now: Instant, outcome: &Outcome, mode: Mode, out: &mut Outbox) -> bool {
        self.asked = None;
        let was_sent = !matches!(outcome.end, End::Withdrawn | End::Busy | End::ReadOnly | End::NoPort);
        self.times += u32::from(was_sent);
        let goes_on = was_sent && !self.stopped && self.goes_on(outcome, mode);
        self.last = Some(outcome.clone());
        if goes_on {
            self.next = Some((self.begun + self.every()).max(now));
            self.news.change();
        } else {
            self.tell(false, out);
        }
        goes_on
    }

    fn goes_on(&mut self, outcome: &Outcome, mode: Mode) -> bool {
        let Some(repeat) = &self.sending.repeat else { return false };
        let is_reply = outcome.end == End::Answered && !is_exception(&outcome.heard, mode);
        let met = match &repeat.until {
            Until::Never => false,
            Until::Answered => is_reply,
            // Nobody answers a broadcast, and bytes that are no request have no reply that could be told from others.
            Until::Failed => !is_reply && !matches!(outcome.end, End::Broadcast | End::Heard),
            Until::Changed => {
                let heard = matches!(outcome.end, End::Answered | End::Heard).then_some(&outcome.heard);
                heard.is_some_and(|heard| self.first_heard.get_or_insert_with(|| heard.clone()) != heard)
            }
            Until::Heard(_) => self.pattern.as_ref().is_some_and(|pattern| pattern.matches(&outcome.heard, None)),
        };
        !met && repeat.times.is_none_or(|times| self.times < times)
    }

    fn tell(&self, more: bool, out: &mut Outbox) {
        if let Some(outcome) = self.last.clone() {
            out.tell(FromConsole::Sent { id: self.sending.id, times: self.times, more, outcome });
        }
    }

    fn every(&self) -> Duration {
        Duration::from_millis(self.sending.repeat.as_ref().map_or(0, |repeat| repeat.every_ms).into())
    }
}

/// Says that something will not be sent.
pub(super) fn refuse(sending: &Sending, end: End, out: &mut Outbox) {
    let outcome = Outcome { at_us: 0, heard: Vec::new(), round_trip_us: None, end };
    out.tell(FromConsole::Sent { id: sending.id, times: 0, more: false, outcome });
}

/// The reply's function code has its highest bit set (application protocol, clause 7).
fn is_exception(frame: &[u8], mode: Mode) -> bool {
    let function = match mode {
        Mode::Rtu => frame.get(1).copied(),
        Mode::Ascii => ascii::decode_body(frame).ok().and_then(|body| body.get(1).copied()),
    };
    function.is_some_and(|function| function & 0x80 != 0)
}
