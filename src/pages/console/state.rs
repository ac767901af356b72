//! What the Console page knows: the log, the line, what is typed to be sent.

use buslens_analyst::line::{LineState, ToLine};
use buslens_analyst::message::{FromAnalyst, FromConsole, Replay, ToAnalyst, ToConsole};
use buslens_codec::intake::Form;
use buslens_codec::line::Mode;
use wasm_bindgen::JsValue;

use super::dock::Dock;
use super::sequence::Sequences;
use super::setup::Setup;
use crate::analyst::Analyst;
use crate::components::desk::{Bytes, CONNECTED, Clock, Desk, NO_PROFILE, NOTHING, Times};
use crate::configuring::Configuring;
use crate::console::snippets::{self, Snippet};
use crate::device::{self, Device};
use crate::reactive::prelude::*;
use crate::storage::{self, kept};

/// How many entries the log can be told to keep.
pub(super) const RINGS: [u32; 5] = [1_000, 10_000, 100_000, 1_000_000, 5_000_000];
/// How many it keeps unless it is told.
const RING: &str = "1000000";

thread_local! {
    /// The text or file that was brought in last, to be read again in another way: a JS handle, and so kept out of signals.
    static BROUGHT: std::cell::RefCell<JsValue> = const { std::cell::RefCell::new(JsValue::UNDEFINED) };
}

/// The state of the page. It outlives a visit to another page.
pub(crate) struct Console {
    /// The log.
    pub(crate) desk: Desk,
    /// The line as the engine told it last.
    pub(crate) line: RwSignal<Option<LineState>>,
    /// The unit id of the device that is connected.
    pub(crate) unit: RwSignal<Option<u8>>,
    /// The fields of the line's settings.
    pub(super) setup: Setup,
    /// Whether bytes are shown as they are, without talk of frames.
    pub(super) raw: RwSignal<bool>,
    /// Whether the list is held still.
    pub(super) paused: RwSignal<bool>,
    /// How many entries are kept: one of [`RINGS`].
    pub(super) ring: RwSignal<String>,
    /// The name of the log that was brought in and is shown in place of the line's.
    pub(super) brought: RwSignal<Option<String>>,
    /// Why it could not be read to its end.
    pub(super) unreadable: RwSignal<Option<String>>,
    /// How a replay stands.
    pub(super) replay: RwSignal<Replay>,
    /// Whether the list is what a replay has brought forth.
    pub(super) replayed: RwSignal<bool>,
    /// The replay's speed in thousandths of its own; 0 for as fast as it goes.
    pub(super) speed: RwSignal<String>,
    /// The send line with all that belongs to it.
    pub(super) dock: Dock,
    /// Sequences, and the report of the last run.
    pub(super) sequences: Sequences,
    /// Lines that are kept under names.
    pub(super) snippets: RwSignal<Vec<Snippet>>,
    /// Which of the panes beside the log is open.
    pub(super) tab: RwSignal<String>,
    /// Whether the keys are explained.
    pub(super) keys_open: RwSignal<bool>,
    /// Whether the builder is open.
    pub(super) builder_open: RwSignal<bool>,
    /// The entry whose comment is being written.
    pub(super) marking: RwSignal<Option<u32>>,
    /// How many rows were copied, until another one is chosen.
    pub(super) copied: RwSignal<Option<usize>>,
    /// Entries a second, as the last second was.
    pub(super) rate: RwSignal<u32>,
    started: StoredValue<bool>,
}

impl Console {
    /// With what was remembered.
    pub(crate) fn remembered() -> Self {
        let desk = Desk::new(Analyst::Console, "console-profile", CONNECTED);
        desk.times.set(Times::of(&storage::load("console-times").unwrap_or_default()));
        desk.bytes.set(Bytes::of(&storage::load("console-bytes").unwrap_or_default()));
        let kept_snippets = storage::load("console-snippets").unwrap_or_default();
        Self {
            desk,
            line: RwSignal::new(None),
            unit: RwSignal::new(None),
            setup: Setup::new(),
            raw: RwSignal::new(false),
            paused: RwSignal::new(false),
            ring: kept("console-ring", RING),
            brought: RwSignal::new(None),
            unreadable: RwSignal::new(None),
            replay: RwSignal::new(Replay::default()),
            replayed: RwSignal::new(false),
            speed: kept("console-speed", "1000"),
            dock: Dock::remembered(),
            sequences: Sequences::remembered(),
            snippets: RwSignal::new(snippets::read(&kept_snippets).unwrap_or_default()),
            tab: kept("console-tab", "frame"),
            keys_open: RwSignal::new(false),
            builder_open: RwSignal::new(false),
            marking: RwSignal::new(None),
            copied: RwSignal::new(None),
            rate: RwSignal::new(0),
            started: StoredValue::new(false),
        }
    }

    /// Starts the worker at the first visit and joins it to the engine.
    /// Whether it starts now.
    pub(crate) fn start(&'static self, configuring: &'static Configuring) -> bool {
        if self.started.get_value() {
            return false;
        }
        self.started.set_value(true);
        Analyst::Console.start(move |message, beside| self.hear(configuring, message, &beside));
        crate::workbench::attach_console();
        self.tell(ToConsole::RingSize(self.ring_size()));
        self.desk.send_profile();
        true
    }

    /// Sends a wish to the worker.
    pub(super) fn tell(&self, wish: ToConsole) {
        self.desk.analyst.send(&ToAnalyst::Console(wish));
    }

    /// Sends an order to the engine, by way of the worker.
    pub(crate) fn order(&self, order: ToLine) {
        self.tell(ToConsole::Line(order));
    }

    /// How many entries are kept.
    pub(super) fn ring_size(&self) -> u32 {
        self.ring.with_untracked(|text| text.parse().ok()).filter(|size| RINGS.contains(size)).unwrap_or(RINGS[3])
    }

    /// Brings a text or a file in, in place of the line's log.
    pub(super) fn bring(&self, name: &str, what: &JsValue) {
        BROUGHT.with_borrow_mut(|kept| *kept = what.clone());
        self.brought.set(Some(name.to_owned()));
        self.read(None);
    }

    /// Reads what was brought in, or reads it again in another way.
    pub(super) fn read(&self, form: Option<Form>) {
        self.unreadable.set(None);
        self.replayed.set(false);
        self.desk.follow.set(false);
        self.desk.rewind();
        let reading = self.desk.next_reading();
        BROUGHT.with_borrow(|what| {
            Analyst::Console.send_with(&ToAnalyst::Read { reading, form, keep: false }, what);
        });
    }

    /// Back to the log of the line.
    pub(super) fn go_live(&self) {
        self.desk.statistics.set(None);
        BROUGHT.with_borrow_mut(|kept| *kept = JsValue::UNDEFINED);
        self.brought.set(None);
        self.unreadable.set(None);
        self.replayed.set(false);
        self.desk.choose(NOTHING);
        self.desk.follow.set(true);
        self.tell(ToConsole::Live);
    }

    /// Whether there is something to be played, and nothing is being played.
    pub(super) fn can_play(&self) -> bool {
        let full = self.desk.progress.with(|progress| progress.entries > 0 && progress.finished);
        full && !self.replay.with(|replay| replay.playing)
    }

    /// Plays the list as if it were live.
    pub(super) fn play(&self) {
        if !self.can_play() {
            return;
        }
        let speed_permille = self.speed.with_untracked(|text| text.parse().unwrap_or(1000));
        self.replayed.set(true);
        self.desk.statistics.set(None);
        self.desk.choose(NOTHING);
        self.desk.follow.set(true);
        self.tell(ToConsole::Replay { speed_permille, profile: self.profile_text() });
    }

    /// Holds the list still, or lets it go on.
    pub(super) fn pause(&self) {
        self.paused.update(|paused| *paused = !*paused);
        self.tell(ToConsole::Pause(self.paused.get_untracked()));
    }

    /// Sets or takes away the mark of the chosen entry. With `comment` its words are asked for.
    pub(super) fn mark(&self, comment: bool) {
        let Some((index, mark)) = self.chosen_mark() else { return };
        if comment {
            self.marking.set(Some(index));
            if mark.is_none() {
                self.tell(ToConsole::Mark { index, comment: Some(String::new()) });
            }
        } else {
            self.tell(ToConsole::Mark { index, comment: mark.is_none().then(String::new) });
        }
    }

    /// The chosen entry and its mark.
    pub(super) fn chosen_mark(&self) -> Option<(u32, Option<String>)> {
        let shown = self.desk.progress.with_untracked(|progress| progress.shown);
        let chosen = Some(self.desk.chosen.get_untracked()).filter(|at| *at < shown)?;
        self.desk.with_row(chosen, |row| (row.index, row.mark.clone()))
    }

    /// The profile that names values, as far as it is chosen or found.
    pub(super) fn device(&self) -> Option<&'static Device> {
        let chosen = self.desk.profile.get();
        if chosen == NO_PROFILE {
            return None;
        }
        let connected = || self.desk.connected.get().map(|id| device::find(&id));
        let named = device::known(&chosen);
        named.or_else(|| self.desk.device()).or_else(connected)
    }

    /// The text of that profile; empty for none.
    pub(super) fn profile_text(&self) -> String {
        self.device().map(|device| device.source().to_owned()).unwrap_or_default()
    }

    /// The mode of the line.
    pub(super) fn mode(&self) -> Mode {
        self.line.with(|line| line.as_ref().map_or(Mode::Rtu, |line| line.mode))
    }

    /// Whether the device with this id is connected.
    pub(crate) fn is_connected(&self, id: &str) -> bool {
        self.desk.connected.with(|connected| connected.as_deref() == Some(id))
    }

    /// Whether something can be sent.
    pub(super) fn is_open(&self) -> bool {
        self.line.with(|line| line.as_ref().is_some_and(|line| line.open && !line.replay))
    }

    /// Id of the profile of the device that is connected.
    pub(crate) fn connected_device(&self) -> Option<String> {
        self.desk.connected.get()
    }

    /// Takes over what the first program says of the connection.
    pub(crate) fn connected(&self, device: Option<&'static Device>, unit: Option<u8>) {
        self.unit.set(unit);
        let edition_changed = device::hold(device);
        let device = device.map(|device| device.id().to_owned());
        if edition_changed || self.desk.connected.with_untracked(|before| *before != device) {
            self.desk.connected.set(device);
            if self.started.get_value() {
                self.desk.send_profile();
            }
        }
    }

    fn hear(&self, configuring: &Configuring, message: FromAnalyst, beside: &JsValue) {
        if let FromAnalyst::Progress(progress) = &message {
            self.take_clock(progress.start_us, progress.epoch_us);
        }
        match self.desk.hear(message, beside) {
            Some(FromAnalyst::Console(FromConsole::Configure(message))) => configuring.hear(message),
            Some(FromAnalyst::Console(message)) => self.hear_console(message),
            Some(FromAnalyst::Unreadable(words)) => self.unreadable.set(Some(words)),
            _ => {}
        }
    }

    fn hear_console(&self, message: FromConsole) {
        match message {
            FromConsole::Line(state) => self.line.set(Some(state)),
            FromConsole::Sent { id, times, more, outcome } => self.dock.take_outcome(id, times, more, outcome),
            FromConsole::Replay(replay) => self.replay.set(replay),
            FromConsole::Checked { edition, faults, cautions } => {
                self.sequences.take_checked(edition, faults, cautions);
            }
            FromConsole::Run { edition, changes } => self.sequences.take_changes(edition, changes),
            FromConsole::NotRun { edition } => self.sequences.take_refusal(edition),
            // Heard before.
            FromConsole::Configure(_) => {}
        }
    }

    /// The clock of the list in view, for the times of its rows.
    fn take_clock(&self, start_us: Option<u64>, epoch_us: Option<u64>) {
        let zero_us = epoch_us.map_or(0, |epoch_us| epoch_us.wrapping_add_signed(local_us(epoch_us)));
        let clock = Clock { start_us: start_us.unwrap_or(0), zero_us };
        // Of a log that has lost its beginning, the beginning stays what it was.
        let begun = self.desk.progress.with_untracked(|progress| progress.first > 0);
        let clock = if begun { Clock { start_us: self.desk.clock.get_value().start_us, ..clock } } else { clock };
        if self.desk.clock.get_value() != clock {
            self.desk.clock.set_value(clock);
            self.desk.turn.update(|turn| *turn = turn.wrapping_add(1));
        }
    }
}

/// What the local time of the day is ahead of the universal one, in microseconds.
fn local_us(epoch_us: u64) -> i64 {
    // Milliseconds of some thousand years fit.
    #[allow(clippy::cast_precision_loss)]
    let date = js_sys::Date::new(&JsValue::from_f64((epoch_us / 1000) as f64));
    // A whole number of minutes, less than a day.
    #[allow(clippy::cast_possible_truncation)]
    let minutes = date.get_timezone_offset() as i64;
    -minutes * 60_000_000
}
