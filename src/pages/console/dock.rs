//! What is typed to be sent, how often, and what came of it.

use buslens_analyst::line::{End, Outcome};
use buslens_analyst::message::{Repeat, Sending, ToConsole, Until};
use buslens_codec::line::Mode;

use super::state::Console;
use crate::console::history::History;
use crate::console::{Check, Framing, Key, Line, Writing};
use crate::reactive::prelude::*;
use crate::storage::{self, kept};

/// The longest time between two sendings or that is waited for an answer, in milliseconds.
const LONGEST_MS: u32 = 3_600_000;

/// The send line with all that belongs to it.
pub(super) struct Dock {
    /// As typed; outlives a reload.
    pub(super) text: RwSignal<String>,
    /// Key of a [`Writing`].
    pub(super) writing: RwSignal<String>,
    /// Key of a [`Framing`].
    pub(super) framing: RwSignal<String>,
    /// Key of a [`Check`].
    pub(super) check: RwSignal<String>,
    /// Not empty where it is sent again and again.
    pub(super) repeat: RwSignal<String>,
    /// Typed milliseconds between two beginnings.
    pub(super) every: RwSignal<String>,
    /// Typed count; empty until it is stopped.
    pub(super) times: RwSignal<String>,
    /// `never`, `answered`, `failed`, `changed` or `heard`.
    pub(super) until: RwSignal<String>,
    /// What is to be heard then.
    pub(super) pattern: RwSignal<String>,
    /// Typed milliseconds that are waited for an answer; empty leaves it to the master.
    pub(super) wait: RwSignal<String>,
    /// The last sending.
    pub(super) sent: RwSignal<Option<Sent>>,
    history: StoredValue<History>,
}

/// A sending and what came of it so far.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Sent {
    id: u32,
    /// The bytes that went out.
    pub(super) bytes: Vec<u8>,
    /// How they are to be taken apart.
    pub(super) mode: Mode,
    /// How often so far.
    pub(super) times: u32,
    /// Whether it goes on.
    pub(super) more: bool,
    /// How the last one ended.
    pub(super) outcome: Option<Outcome>,
}

/// A field does not hold what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Invalid;

impl Dock {
    pub(super) fn remembered() -> Self {
        let history = storage::load("console-history").unwrap_or_default();
        Self {
            text: kept("console-line", ""),
            writing: kept("console-writing", "hex"),
            framing: kept("console-framing", "rtu"),
            check: kept("console-check", "crc"),
            repeat: kept("console-repeat", ""),
            every: kept("console-every", "1000"),
            times: kept("console-repeat-times", ""),
            until: kept("console-until", "never"),
            pattern: kept("console-pattern", ""),
            wait: kept("console-wait", ""),
            sent: RwSignal::new(None),
            history: StoredValue::new(History::from_kept(&history)),
        }
    }

    /// What is typed.
    pub(super) fn line(&self) -> Line {
        Line {
            writing: self.writing.with(|key| Writing::of(key)).unwrap_or_default(),
            framing: self.framing.with(|key| Framing::of(key)).unwrap_or_default(),
            check: self.check.with(|key| Check::of(key)).unwrap_or_default(),
            text: self.text.get(),
        }
    }

    /// Puts a line into the field.
    pub(super) fn put(&self, line: Line) {
        self.writing.set(line.writing.key().to_owned());
        self.framing.set(line.framing.key().to_owned());
        self.check.set(line.check.key().to_owned());
        self.text.set(line.text);
    }

    /// The same; what stood there is among what was sent, so that it is not lost.
    pub(super) fn replace(&self, line: Line) {
        let before = self.line();
        if !before.text.trim().is_empty() && before != line {
            self.remember(before);
        }
        self.put(line);
        self.history.update_value(History::leave);
    }

    /// The line before, or after, among those that were sent.
    pub(super) fn leaf(&self, older: bool) {
        let current = self.line();
        let found =
            self.history.try_update_value(|history| if older { history.older(&current) } else { history.newer() });
        if let Some(line) = found.flatten() {
            self.put(line);
        }
    }

    /// Something was typed.
    pub(super) fn edited(&self) {
        self.history.update_value(History::leave);
    }

    /// How ASCII or RTU bytes are checked unless something else is chosen.
    pub(super) fn take_framing(&self, framing: Framing) {
        self.framing.set(framing.key().to_owned());
        let usual = if framing == Framing::Ascii { Check::Lrc } else { Check::Crc };
        if self.check.with_untracked(|key| matches!(Check::of(key), Some(Check::Crc | Check::Lrc))) {
            self.check.set(usual.key().to_owned());
        }
    }

    /// How often the line is sent; `None` for once.
    pub(super) fn repetition(&self) -> Result<Option<Repeat>, Invalid> {
        if self.repeat.with(String::is_empty) {
            return Ok(None);
        }
        let (every_ms, times) = (self.every_ms()?, self.count()?);
        let until = self.until.with(|key| match key.as_str() {
            "answered" => Until::Answered,
            "failed" => Until::Failed,
            "changed" => Until::Changed,
            "heard" => Until::Heard(self.pattern.get()),
            _ => Until::Never,
        });
        Ok(Some(Repeat { every_ms, times, until }))
    }

    /// The time between two beginnings, if it is one.
    pub(super) fn every_ms(&self) -> Result<u32, Invalid> {
        self.every.with(|text| milliseconds(text))
    }

    /// How often; `None` until it is stopped.
    pub(super) fn count(&self) -> Result<Option<u32>, Invalid> {
        self.times.with(|text| match text.trim() {
            "" => Ok(None),
            text => text.parse().ok().filter(|times| *times > 0).map(Some).ok_or(Invalid),
        })
    }

    /// How long an answer is waited for; `None` as long as the master does.
    pub(super) fn wait_ms(&self) -> Result<Option<u32>, Invalid> {
        self.wait.with(|text| if text.trim().is_empty() { Ok(None) } else { milliseconds(text).map(Some) })
    }

    /// Sends what is typed. Nothing that has a fault is sent.
    pub(super) fn send(&self, console: &Console) {
        let line = self.line();
        let Ok(outgoing) = line.outgoing() else { return };
        let (Ok(repeat), Ok(wait_ms)) = (self.repetition(), self.wait_ms()) else { return };
        if outgoing.bytes.is_empty() {
            return;
        }
        let mode = if line.framing == Framing::Ascii { Mode::Ascii } else { console.mode() };
        self.remember(line);
        self.send_bytes(console, outgoing.bytes, mode, repeat, wait_ms);
    }

    /// Sends bytes that stand ready, once.
    pub(super) fn send_once(&self, console: &Console, bytes: Vec<u8>, mode: Mode) {
        self.send_bytes(console, bytes, mode, None, None);
    }

    fn send_bytes(&self, console: &Console, bytes: Vec<u8>, mode: Mode, repeat: Option<Repeat>, wait_ms: Option<u32>) {
        let id = self.sent.with_untracked(|sent| sent.as_ref().map_or(0, |sent| sent.id)).wrapping_add(1);
        self.sent.set(Some(Sent { id, bytes: bytes.clone(), mode, times: 0, more: true, outcome: None }));
        console.tell(ToConsole::Send(Sending { id, bytes, wait_ms, repeat }));
    }

    /// Takes in how a sending has ended, or one of many.
    pub(super) fn take_outcome(&self, id: u32, times: u32, more: bool, outcome: Outcome) {
        self.sent.update(|sent| {
            if let Some(sent) = sent.as_mut().filter(|sent| sent.id == id) {
                *sent = Sent { times, more, outcome: Some(outcome), ..sent.clone() };
            }
        });
    }

    fn remember(&self, line: Line) {
        self.history.update_value(|history| history.push(line));
        self.history.with_value(|history| storage::save("console-history", &history.kept()));
    }
}

impl Sent {
    /// Whether it ended well, badly, or has not ended: for the colour.
    pub(super) fn state(&self) -> &'static str {
        match self.outcome.as_ref().map(|outcome| outcome.end) {
            None => "waiting",
            Some(End::Answered | End::Broadcast | End::Heard) => "good",
            Some(End::Silence | End::Doubtful | End::Withdrawn | End::Busy) => "warning",
            Some(End::Damaged | End::ReadOnly | End::NoPort) => "bad",
        }
    }
}

/// A time of 1 ms to an hour.
fn milliseconds(text: &str) -> Result<u32, Invalid> {
    text.trim().parse().ok().filter(|time| (1..=LONGEST_MS).contains(time)).ok_or(Invalid)
}
