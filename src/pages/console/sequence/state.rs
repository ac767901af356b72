//! What the pane knows: the sequences, the one that is shown, its faults, and the report of the last run.

use buslens_analyst::message::ToConsole;
use buslens_sequence::{Caution, Changes, Fault, MAX_TEXT, READY, Report, Summary, Verdict, outline};
use wasm_bindgen::JsValue;

use super::super::state::Console;
use crate::console::sequences::{self, Own};
use crate::device::{self, Device};
use crate::reactive::prelude::*;
use crate::storage::{self, kept};
use crate::text::Language;

/// Bytes of a file that is read at all.
#[allow(clippy::cast_precision_loss)] // a few hundred thousand
pub(super) const LONGEST_FILE: f64 = MAX_TEXT as f64;

/// Everything about sequences. It outlives a visit to another page.
pub(crate) struct Sequences {
    /// The user's own.
    pub(super) own: RwSignal<Vec<Own>>,
    /// Which one is shown: [`ready_key`] or [`own_key`].
    pub(super) chosen: RwSignal<String>,
    /// Its text.
    pub(super) text: RwSignal<String>,
    /// What the worker says of the text; `None` until it has.
    pub(super) checked: RwSignal<Option<Checked>>,
    /// Names the last check that was asked for.
    edition: StoredValue<u32>,
    /// The last run, for as long as there was one.
    pub(super) summary: RwSignal<Option<Summary>>,
    pub(super) report: StoredValue<Report>,
    /// The first entry that has not been drawn as it is now.
    pub(super) undrawn: StoredValue<usize>,
    /// Counts the changes of the report.
    pub(super) turn: RwSignal<u32>,
    /// The text that was run, when, and under which number.
    pub(super) ran: RwSignal<Option<Ran>>,
    /// Whether the steps of the run are shown in place of the text.
    pub(super) shows_steps: RwSignal<bool>,
    /// Whether a run waits for a yes.
    pub(super) asks: RwSignal<bool>,
    pub(super) renaming: RwSignal<bool>,
    pub(super) told: RwSignal<Option<Told>>,
}

/// What the worker says of a text.
#[derive(Clone, Debug, Default)]
pub(super) struct Checked {
    pub(super) faults: Vec<Fault>,
    pub(super) cautions: Vec<Caution>,
}

/// A run.
#[derive(Clone, Debug, Default)]
pub(super) struct Ran {
    edition: u32,
    pub(super) text: String,
    /// In local time, as the browser writes it.
    pub(super) date: String,
}

/// What came of a change of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Told {
    TooLong,
    NoText,
    /// It was not run: a device is being configured.
    Busy,
    Deleted(Own),
}

/// Names a ready-made sequence in the list.
pub(super) fn ready_key(at: usize) -> String {
    ["ready-", &at.to_string()].concat()
}

/// Names one of the user's own in the list.
pub(super) fn own_key(name: &str) -> String {
    ["own-", name].concat()
}

impl Sequences {
    /// With what was remembered.
    pub(crate) fn remembered() -> Self {
        let own = sequences::read(&storage::load("console-sequences").unwrap_or_default());
        let chosen = kept("console-sequence", &ready_key(0));
        let all = Self {
            own: RwSignal::new(own),
            chosen,
            text: RwSignal::new(String::new()),
            checked: RwSignal::new(None),
            edition: StoredValue::new(0),
            summary: RwSignal::new(None),
            report: StoredValue::new(Report::default()),
            undrawn: StoredValue::new(0),
            turn: RwSignal::new(0),
            ran: RwSignal::new(None),
            shows_steps: RwSignal::new(false),
            asks: RwSignal::new(false),
            renaming: RwSignal::new(false),
            told: RwSignal::new(None),
        };
        let chosen = all.chosen.get_untracked();
        all.choose(chosen);
        all
    }

    // The list.

    /// Shows another one; the first ready-made one where there is none of this name.
    pub(super) fn choose(&self, key: String) {
        let ready = key.strip_prefix("ready-").and_then(|at| READY.get(at.parse::<usize>().ok()?).copied());
        let own = key.strip_prefix("own-").and_then(|name| {
            self.own.with_untracked(|all| all.iter().find(|own| own.name == name).map(|own| own.text.clone()))
        });
        let (key, text) = match (own, ready) {
            (Some(text), _) => (key, text),
            (None, Some(text)) => (key, text.to_owned()),
            (None, None) => (ready_key(0), READY.first().copied().unwrap_or_default().to_owned()),
        };
        self.renaming.set(false);
        self.asks.set(false);
        self.chosen.set(key);
        self.text.set(text);
    }

    pub(super) fn is_ready_made(&self) -> bool {
        self.chosen.with(|key| !key.starts_with("own-"))
    }

    /// Name of the one that is shown.
    pub(super) fn name(&self) -> String {
        let own = self.chosen.with_untracked(|key| key.strip_prefix("own-").map(str::to_owned));
        own.unwrap_or_else(|| self.text.with_untracked(|text| outline(text).1.unwrap_or_default().to_owned()))
    }

    /// Takes over what was typed, here and for the next visit.
    pub(super) fn type_text(&self, typed: String) {
        let name = self.chosen.with_untracked(|key| key.strip_prefix("own-").map(str::to_owned));
        let Some(name) = name else { return };
        self.change(|all| {
            if let Some(own) = all.iter_mut().find(|own| own.name == name) {
                own.text.clone_from(&typed);
            }
        });
        self.text.set(typed);
    }

    pub(super) fn add_new(&self, language: Language) {
        self.add(language.seq_new_name(), String::new());
    }

    pub(super) fn duplicate(&self) {
        self.add(&self.name(), self.text.get_untracked());
    }

    /// Takes a file in.
    pub(super) fn bring(&self, file: &str, text: Option<String>, too_long: bool) {
        // A text has no NULs, and what a browser could not decode holds this character.
        match text.filter(|text| !text.contains(['\0', char::REPLACEMENT_CHARACTER])) {
            Some(text) => self.add(file.strip_suffix(".txt").unwrap_or(file), text.replace("\r\n", "\n")),
            None => self.told.set(Some(if too_long { Told::TooLong } else { Told::NoText })),
        }
    }

    pub(super) fn rename(&self, name: &str) {
        let before = self.name();
        let name = sequences::clean_name(name);
        if !name.is_empty() && name != before {
            let mut renamed = None;
            self.change(|all| {
                if let Some(at) = all.iter().position(|own| own.name == before) {
                    let text = all.remove(at).text;
                    renamed = sequences::add(all, &name, text);
                }
            });
            if let Some(name) = renamed {
                self.chosen.set(own_key(&name));
            }
        }
        self.renaming.set(false);
    }

    pub(super) fn delete(&self) {
        let name = self.name();
        let mut deleted = None;
        self.change(|all| deleted = all.iter().position(|own| own.name == name).map(|at| all.remove(at)));
        self.choose(String::new());
        self.told.set(deleted.map(Told::Deleted));
    }

    /// Takes the last deletion back.
    pub(super) fn put_back(&self) {
        if let Some(Told::Deleted(own)) = self.told.get_untracked() {
            self.add(&own.name, own.text);
        }
    }

    fn add(&self, name: &str, text: String) {
        let mut added = None;
        self.change(|all| added = sequences::add(all, name, text));
        self.told.set(None);
        if let Some(name) = added {
            self.shows_steps.set(false);
            self.choose(own_key(&name));
        }
    }

    fn change(&self, act: impl FnOnce(&mut Vec<Own>)) {
        self.own.update(act);
        storage::save("console-sequences", &self.own.with_untracked(|all| sequences::write(all)));
    }

    // Checks.

    /// The device that the text is for: the one that it names, else the one that names the log's values.
    pub(super) fn device(&self, console: &Console) -> Option<&'static Device> {
        let named = self.text.with(|text| outline(text).0.and_then(known_device));
        named.or_else(|| console.device())
    }

    /// The device that the text names, and another one that is connected.
    pub(super) fn other_device(&self, console: &Console) -> Option<(&'static Device, &'static Device)> {
        let named = self.text.with(|text| outline(text).0.and_then(known_device))?;
        let connected = console.desk.connected.get().map(|id| device::find(&id))?;
        (connected.id() != named.id()).then_some((named, connected))
    }

    /// Asks the worker for the faults of the text.
    pub(super) fn check(&self, console: &Console) {
        let edition = self.edition.get_value().wrapping_add(1);
        self.edition.set_value(edition);
        self.checked.set(None);
        let profile = untrack(|| self.device(console)).map(|device| device.source().to_owned()).unwrap_or_default();
        console.tell(ToConsole::Check { edition, text: self.text.get_untracked(), profile });
    }

    /// Takes the answer, unless it is that to an earlier question.
    pub(crate) fn take_checked(&self, edition: u32, faults: Vec<Fault>, cautions: Vec<Caution>) {
        if edition == self.edition.get_value() {
            self.checked.set(Some(Checked { faults, cautions }));
        }
    }

    /// Lines of the grave steps, and of all that change something.
    pub(super) fn cautions(&self) -> (String, String) {
        let lines = |grave: bool| {
            self.checked.with(|checked| {
                let all = checked.iter().flat_map(|checked| &checked.cautions);
                let lines = all.filter(|caution| caution.grave || !grave).map(|caution| caution.line.to_string());
                lines.collect::<Vec<_>>().join(", ")
            })
        };
        (lines(true), lines(false))
    }

    // Runs.

    pub(super) fn is_running(&self) -> bool {
        self.summary.with(|summary| summary.as_ref().is_some_and(|summary| summary.verdict == Verdict::Running))
    }

    pub(super) fn can_run(&self, console: &Console) -> bool {
        let right = self.checked.with(|checked| checked.as_ref().is_some_and(|checked| checked.faults.is_empty()));
        right && console.is_open() && !self.is_running()
    }

    /// Runs what is shown, if nothing stands in the way; what is grave only when that was confirmed.
    pub(super) fn run(&self, console: &Console, language: Language, confirmed: bool) {
        if !self.can_run(console) {
            return;
        }
        if !confirmed && !self.cautions().0.is_empty() {
            self.asks.set(true);
            return;
        }
        self.asks.set(false);
        self.told.set(None);
        let device = untrack(|| self.device(console));
        let unit = console.unit.get_untracked().or(device.map(|device| device.profile().unit)).unwrap_or(1);
        let profile = device.map(|device| device.source().to_owned()).unwrap_or_default();
        let text = self.text.get_untracked();
        let edition = self.edition.get_value().wrapping_add(1);
        self.edition.set_value(edition);
        let date = String::from(js_sys::Date::new_0().to_locale_string(language.tag(), &JsValue::UNDEFINED));
        self.ran.set(Some(Ran { edition, text: text.clone(), date }));
        self.report.set_value(Report::default());
        self.undrawn.set_value(0);
        self.summary.set(Some(Summary::default()));
        self.shows_steps.set(true);
        console.tell(ToConsole::Run { edition, text, profile, unit });
    }

    pub(super) fn stop(&self, console: &Console) {
        if self.is_running() {
            console.tell(ToConsole::Stop);
        }
    }

    /// It was not run.
    pub(crate) fn take_refusal(&self, edition: u32) {
        if self.ran.with_untracked(|ran| ran.as_ref().is_some_and(|ran| ran.edition == edition)) {
            self.summary.set(None);
            self.ran.set(None);
            self.shows_steps.set(false);
            self.told.set(Some(Told::Busy));
        }
    }

    /// Takes over what has changed in the report.
    pub(crate) fn take_changes(&self, edition: u32, changes: Changes) {
        if !self.ran.with_untracked(|ran| ran.as_ref().is_some_and(|ran| ran.edition == edition)) {
            return;
        }
        let from = usize::try_from(changes.from).unwrap_or(usize::MAX);
        self.undrawn.update_value(|undrawn| *undrawn = from.min(*undrawn));
        self.summary.set(Some(changes.summary.clone()));
        self.report.update_value(|report| report.apply(changes));
        self.turn.update(|turn| *turn = turn.wrapping_add(1));
    }
}

fn known_device(id: &str) -> Option<&'static Device> {
    device::all().iter().find(|device| device.id() == id)
}
