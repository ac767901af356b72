//! A list of frames that an analyst keeps, with its filter, the chosen frame taken apart, and its counts: what the Decoder
//! page shows of a text and the Console page of a line.

pub(crate) mod detail;
mod frames;
mod pages;
pub(crate) mod reading;
mod stamps;
pub(crate) mod tools;

use buslens_analyst::message::{
    Filter, Format, FromAnalyst, Look, ProfileChoice, Progress, Row, Statistics, ToAnalyst,
};
use buslens_codec::dissect::Direction;
use wasm_bindgen::{JsCast, JsValue};

use crate::analyst::Analyst;
use crate::device;
use crate::reactive::prelude::*;
use crate::storage::kept;
use pages::{PAGE, Pages};

pub(crate) use frames::{Opened, event, frame_list};
pub(crate) use stamps::{Bytes, Times};

/// The profile that is found out.
pub(crate) const AUTO: &str = "auto";
/// No profile at all.
pub(crate) const NO_PROFILE: &str = "none";
/// The profile of the device that is connected; found out while there is none.
pub(crate) const CONNECTED: &str = "connected";
/// Where no row is chosen.
pub(crate) const NOTHING: u32 = u32::MAX;
/// The most rows that are copied at once.
pub(crate) const MOST_COPIED: u32 = 500;

/// What is known of a list. It outlives a visit to another page.
pub(crate) struct Desk {
    /// Whose list it is.
    pub(crate) analyst: Analyst,
    /// How far the analyst has come.
    pub(crate) progress: RwSignal<Progress>,
    /// What the list holds.
    pub(crate) statistics: RwSignal<Option<Statistics>>,
    /// Id of the profile, [`AUTO`], [`NO_PROFILE`] or [`CONNECTED`].
    pub(crate) profile: RwSignal<String>,
    /// Id of the profile of the device that is connected.
    pub(crate) connected: RwSignal<Option<String>>,
    /// Typed unit id to show.
    pub(crate) unit: RwSignal<String>,
    /// Typed function code to show.
    pub(crate) function: RwSignal<String>,
    /// `tx`, `rx`, or empty for both.
    pub(crate) direction: RwSignal<String>,
    /// Whether only errors are shown.
    pub(crate) errors_only: RwSignal<bool>,
    /// Typed text to show.
    pub(crate) text: RwSignal<String>,
    /// Place of the chosen row among the shown; [`NOTHING`] for none.
    pub(crate) chosen: RwSignal<u32>,
    /// Of a live list, the other end of the chosen rows.
    pub(crate) anchor: RwSignal<u32>,
    /// Of a live list, whether its newest row is kept in sight.
    pub(crate) follow: RwSignal<bool>,
    /// How a row's time is told.
    pub(crate) times: RwSignal<Times>,
    /// How a row's bytes are told.
    pub(crate) bytes: RwSignal<Bytes>,
    /// Changes when the list is to be shown from its beginning.
    pub(crate) rewound: RwSignal<u32>,
    /// How many rows have gone from the front of the whole list.
    pub(crate) gone: RwSignal<u32>,
    /// The clock that the rows' times are those of.
    pub(crate) clock: StoredValue<Clock>,
    /// Changes whenever rows have come or gone.
    pub(crate) turn: RwSignal<u32>,
    /// The last closer look.
    pub(crate) look: RwSignal<Option<Look>>,
    /// What the device's own display shows, typed.
    pub(crate) shown: RwSignal<String>,
    /// Whether the views of the registers are open.
    pub(crate) views_open: RwSignal<bool>,
    /// The entry that is chosen once the whole list is shown again.
    wanted: StoredValue<Option<u32>>,
    /// The entry that is to be brought in sight.
    sought: StoredValue<Option<u32>>,
    rows: StoredValue<Pages>,
    reading: StoredValue<u32>,
    collecting: StoredValue<Option<Collecting>>,
}

/// The clock of a list's times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Clock {
    /// When the list began, in microseconds.
    pub(crate) start_us: u64,
    /// The local time of the day at its zero, in microseconds.
    pub(crate) zero_us: u64,
}

/// Closer looks that are collected for the clipboard.
struct Collecting {
    wanted: Vec<u32>,
    found: Vec<(u32, String)>,
    done: Done,
}

/// What is done with what was collected.
type Done = Box<dyn FnOnce(&str) + Send + Sync>;

impl Desk {
    /// An empty list; `profile` is what is remembered under this key, else `choice`.
    pub(crate) fn new(analyst: Analyst, profile: &'static str, choice: &str) -> Self {
        let live = analyst == Analyst::Console;
        Self {
            analyst,
            progress: RwSignal::new(Progress { finished: true, ..Progress::default() }),
            statistics: RwSignal::new(None),
            profile: kept(profile, choice),
            connected: RwSignal::new(None),
            unit: RwSignal::new(String::new()),
            function: RwSignal::new(String::new()),
            direction: RwSignal::new(String::new()),
            errors_only: RwSignal::new(false),
            text: RwSignal::new(String::new()),
            chosen: RwSignal::new(if live { NOTHING } else { 0 }),
            anchor: RwSignal::new(NOTHING),
            follow: RwSignal::new(live),
            times: RwSignal::new(Times::Clock),
            bytes: RwSignal::new(Bytes::Hex),
            rewound: RwSignal::new(0),
            gone: RwSignal::new(0),
            clock: StoredValue::new(Clock::default()),
            turn: RwSignal::new(0),
            look: RwSignal::new(None),
            shown: RwSignal::new(String::new()),
            views_open: RwSignal::new(false),
            wanted: StoredValue::new(None),
            sought: StoredValue::new(None),
            rows: StoredValue::new(Pages::default()),
            reading: StoredValue::new(0),
            collecting: StoredValue::new(None),
        }
    }

    /// Whether it is the log of a line, which grows while it is looked at.
    pub(crate) fn is_live(&self) -> bool {
        self.analyst == Analyst::Console
    }

    /// Chooses an entry by its number in the whole list. Where a filter hides it, the filter goes.
    pub(crate) fn go_to(&self, index: u32) {
        if self.filter() != Filter::default() {
            self.clear_filter();
        }
        let first = self.progress.with_untracked(|progress| progress.first);
        self.choose(index.saturating_sub(first));
        self.follow.set(false);
        self.sought.set_value(Some(index));
    }

    /// The place of the entry that was gone to, once its row is there.
    fn sought(&self) -> Option<u32> {
        let wanted = self.sought.get_value()?;
        let at = self.chosen.get_untracked();
        if at == NOTHING {
            return None;
        }
        self.want(at..at + 1);
        let found = self.with_row(at, |row| row.index) == Some(wanted);
        found.then(|| {
            self.sought.set_value(None);
            at
        })
    }

    /// Shows everything.
    pub(crate) fn clear_filter(&self) {
        for field in [self.unit, self.function, self.direction, self.text] {
            field.set(String::new());
        }
        self.errors_only.set(false);
    }

    /// Shows everything, with what is chosen still chosen.
    pub(crate) fn show_in_context(&self) {
        let chosen = self.with_row(self.chosen.get_untracked(), |row| row.index);
        self.wanted.set_value(chosen);
        self.clear_filter();
    }

    /// Tells the analyst which profile names the values.
    pub(crate) fn send_profile(&self) {
        self.analyst.send(&ToAnalyst::Profile(untrack(|| self.profile_choice())));
    }

    /// Which profile is to name the values, with its text as it is now.
    pub(crate) fn profile_choice(&self) -> ProfileChoice {
        let auto = || ProfileChoice::Auto(device::own().iter().map(|device| device.source().to_owned()).collect());
        let file = |id: &str| {
            let device = device::known(id);
            device.map_or_else(auto, |device| ProfileChoice::File(device.source().to_owned()))
        };
        self.profile.with(|id| match id.as_str() {
            AUTO => auto(),
            NO_PROFILE => ProfileChoice::None,
            CONNECTED => self.connected.with(|id| id.as_deref().map_or_else(auto, file)),
            id => file(id),
        })
    }

    /// What the fields of the filter say; what cannot be read filters nothing.
    pub(crate) fn filter(&self) -> Filter {
        Filter {
            unit: self.unit.with(|text| code(text)),
            function: self.function.with(|text| code(text)),
            direction: self.direction.with(|way| match way.as_str() {
                "tx" => Some(Direction::Request),
                "rx" => Some(Direction::Response),
                _ => None,
            }),
            errors_only: self.errors_only.get(),
            text: self.text.get(),
        }
    }

    /// Tells the analyst what is shown; what is chosen is another row from then on.
    pub(crate) fn send_filter(&self) {
        let wanted = self.wanted.try_update_value(Option::take).flatten();
        let first = self.progress.with_untracked(|progress| progress.first);
        self.sought.set_value(wanted);
        self.choose(match wanted {
            Some(index) => index.saturating_sub(first),
            None if self.is_live() => NOTHING,
            None => 0,
        });
        if wanted.is_some() {
            self.follow.set(false);
        }
        self.analyst.send(&ToAnalyst::Filter(self.filter()));
    }

    /// Shows the list from its beginning.
    pub(crate) fn rewind(&self) {
        self.rewound.update(|turn| *turn = turn.wrapping_add(1));
    }

    /// Chooses one row by its place.
    pub(crate) fn choose(&self, at: u32) {
        self.anchor.set(at);
        self.chosen.set(at);
    }

    /// The row at a place, if it has come.
    pub(crate) fn row(&self, at: u32) -> Option<Row> {
        self.rows.with_value(|rows| rows.row(at).cloned())
    }

    /// What is said of the row at a place, if it has come.
    pub(crate) fn with_row<T>(&self, at: u32, act: impl FnOnce(&Row) -> T) -> Option<T> {
        self.rows.with_value(|rows| rows.row(at).map(act))
    }

    /// The chosen rows as far as they have come, the first ones.
    pub(crate) fn chosen_rows(&self) -> Vec<Row> {
        let shown = self.progress.with_untracked(|progress| progress.shown);
        let chosen = self.chosen.get_untracked();
        let Some(last) = shown.checked_sub(1).filter(|_| chosen != NOTHING) else { return Vec::new() };
        let chosen = chosen.min(last);
        let anchor = Some(self.anchor.get_untracked()).filter(|anchor| *anchor <= last).unwrap_or(chosen);
        let (first, last) = (chosen.min(anchor), chosen.max(anchor));
        (first..=last.min(first.saturating_add(MOST_COPIED - 1))).filter_map(|at| self.row(at)).collect()
    }

    /// Asks for the rows of these places that have not come.
    pub(crate) fn want(&self, places: std::ops::Range<u32>) {
        let shown = self.progress.with_untracked(|progress| progress.shown);
        let missing = self.rows.try_update_value(|rows| rows.missing(&places, shown)).unwrap_or_default();
        for page in missing {
            self.analyst.send(&ToAnalyst::Rows { from: page * PAGE, count: PAGE });
        }
    }

    /// Has these entries told as JSON, a line each, and hands the text to `done`.
    pub(crate) fn collect_json(&self, wanted: Vec<u32>, done: Done) {
        for index in &wanted {
            self.analyst.send(&ToAnalyst::Look { index: *index, shown: String::new() });
        }
        self.collecting.set_value(Some(Collecting { wanted, found: Vec::new(), done }));
    }

    /// The profile in force.
    pub(crate) fn device(&self) -> Option<&'static device::Device> {
        self.progress.with(|progress| progress.profile.as_deref().map(device::find))
    }

    /// The same without following its changes.
    pub(crate) fn device_untracked(&self) -> Option<&'static device::Device> {
        self.progress.with_untracked(|progress| progress.profile.as_deref().map(device::find))
    }

    /// A new reading begins: its number, which the analyst's answers carry.
    pub(crate) fn next_reading(&self) -> u32 {
        let reading = self.reading.get_value().wrapping_add(1);
        self.reading.set_value(reading);
        self.statistics.set(None);
        self.choose(if self.is_live() { NOTHING } else { 0 });
        self.progress.update(|progress| {
            progress.finished = false;
            progress.done = 0;
        });
        reading
    }

    /// Takes in what the analyst says of the list; gives back what is not about the list.
    pub(crate) fn hear(&self, message: FromAnalyst, beside: &JsValue) -> Option<FromAnalyst> {
        match message {
            FromAnalyst::Progress(progress) if self.is_current(progress.reading) => self.advance(progress),
            FromAnalyst::Rows(rows) => {
                if self.rows.try_update_value(|pages| pages.take(rows)).unwrap_or_default() {
                    self.bump();
                }
            }
            FromAnalyst::Statistics(statistics) if self.is_current(statistics.reading) => {
                self.statistics.set(Some(statistics));
                if !self.is_live() {
                    // Scales and one-sidedness are known now.
                    self.rows.update_value(Pages::forget);
                    self.bump();
                }
            }
            FromAnalyst::Look(look) => self.take_look(look),
            FromAnalyst::Exported(format) => save_file(format, beside),
            FromAnalyst::Progress(_) | FromAnalyst::Statistics(_) | FromAnalyst::Panicked(_) => {}
            message => return Some(message),
        }
        None
    }

    /// The log of a line belongs to no reading: its worker says which list is shown.
    fn is_current(&self, reading: u32) -> bool {
        self.is_live() || reading == self.reading.get_value()
    }

    fn advance(&self, progress: Progress) {
        let edition = progress.edition;
        let (shown, first, entries) =
            self.progress.with_untracked(|before| (before.shown, before.first, before.entries));
        let whole = |entries: u32, shown: u32| entries == shown;
        let gone = progress.first.saturating_sub(first);
        if gone > 0 && whole(entries, shown) && whole(progress.entries, progress.shown) {
            self.gone.update(|all| *all = all.wrapping_add(gone));
            for place in [self.chosen, self.anchor] {
                if place.get_untracked() != NOTHING {
                    place.update(|place| *place = place.checked_sub(gone).unwrap_or(NOTHING));
                }
            }
        }
        let stale = self.rows.try_update_value(|rows| rows.turn_to(edition)).unwrap_or_default();
        let more = shown != progress.shown;
        self.progress.set(progress);
        if more || stale {
            self.bump();
        }
    }

    fn take_look(&self, look: Look) {
        let collected = self.collecting.try_update_value(|collecting| {
            let running = collecting.as_mut()?;
            if running.wanted.contains(&look.index) && !running.found.iter().any(|(index, _)| *index == look.index) {
                running.found.push((look.index, look.json.clone()));
            }
            (running.found.len() == running.wanted.len()).then(|| collecting.take()).flatten()
        });
        if let Some(mut collected) = collected.flatten() {
            collected.found.sort_by_key(|(index, _)| *index);
            let lines: Vec<String> = collected.found.into_iter().map(|(_, json)| json).collect();
            (collected.done)(&lines.join("\n"));
        }
        let chosen = self.with_row(self.chosen.get_untracked(), |row| row.index);
        if !self.is_live() || chosen == Some(look.index) {
            self.look.set(Some(look));
        }
    }

    fn bump(&self) {
        self.turn.update(|turn| *turn = turn.wrapping_add(1));
    }
}

/// A unit id or a function code: decimal, or hexadecimal with `0x`.
fn code(text: &str) -> Option<u8> {
    let text = text.trim();
    match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => u8::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

/// Lets the browser save a file under a fitting name.
fn save_file(format: Format, file: &JsValue) {
    let name = match format {
        Format::JsonLines => "buslens.jsonl",
        Format::Csv => "buslens.csv",
        Format::Hex | Format::Text => "buslens.txt",
        Format::Pcap => "buslens.pcap",
        Format::Session => "buslens.session",
    };
    if let Some(file) = file.dyn_ref::<web_sys::Blob>() {
        crate::dom::save_file(file, name);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_decimal_or_marked_hexadecimal() {
        assert_eq!(
            (code("16"), code(" 0x10 "), code("300"), code("x"), code("")),
            (Some(16), Some(16), None, None, None)
        );
    }
}
