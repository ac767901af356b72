//! What the Decoder page knows: the text, and what the analyst has made of it.

use buslens_analyst::message::{
    Filter, Format, FromAnalyst, Look, ProfileChoice, Progress, Row, Rows, Statistics, ToAnalyst,
};
use buslens_codec::intake::Form;
use js_sys::JsString;
use wasm_bindgen::{JsCast, JsValue};

use crate::analyst;
use crate::device;
use crate::reactive::prelude::*;
use crate::storage::{self, kept};
use crate::workbench::Workbench;

/// Rows that are asked for together.
const PAGE: u32 = 64;
/// Pages that are remembered.
const MOST_PAGES: usize = 24;
/// The longest text in characters that stays in the text field: a longer one would hold up the whole page there.
pub(super) const LONGEST_TYPED: u32 = 64 << 10;
/// Characters of a long text that are shown of it.
const PREVIEW: u32 = 2000;

/// The profile that is found out.
pub(super) const AUTO: &str = "auto";
/// No profile at all.
pub(super) const NO_PROFILE: &str = "none";

/// The state of the page. It outlives a visit to another page.
pub(crate) struct Desk {
    /// The text in the field; outlives a reload.
    pub(super) typed: RwSignal<String>,
    /// What stood there before an example or a link replaced it; outlives a reload.
    pub(super) previous: RwSignal<String>,
    /// A text that is too long for the field, or a file.
    pub(super) document: RwSignal<Option<Document>>,
    /// How the user wants it read.
    pub(super) form: RwSignal<Option<Form>>,
    /// How far the analyst has come.
    pub(super) progress: RwSignal<Progress>,
    /// What the list holds.
    pub(super) statistics: RwSignal<Option<Statistics>>,
    /// Why a file could not be read.
    pub(super) unreadable: RwSignal<Option<String>>,
    /// Id of the profile, [`AUTO`] or [`NO_PROFILE`].
    pub(super) profile: RwSignal<String>,
    /// Typed unit id to show.
    pub(super) unit: RwSignal<String>,
    /// Typed function code to show.
    pub(super) function: RwSignal<String>,
    /// Whether only errors are shown.
    pub(super) errors_only: RwSignal<bool>,
    /// Typed text to show.
    pub(super) text: RwSignal<String>,
    /// Place of the chosen row among the shown.
    pub(super) chosen: RwSignal<u32>,
    /// Changes whenever rows have come or gone.
    pub(super) turn: RwSignal<u32>,
    /// The last closer look.
    pub(super) look: RwSignal<Option<Look>>,
    /// What the device's own display shows, typed.
    pub(super) shown: RwSignal<String>,
    /// Whether the views of the registers are open.
    pub(super) views_open: RwSignal<bool>,
    rows: StoredValue<Pages>,
    reading: StoredValue<u32>,
    started: StoredValue<bool>,
}

/// A text that does not stand in the field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Document {
    /// A file's name; `None` for pasted text.
    pub(super) name: Option<String>,
    /// Characters, or bytes of a file; 0 while it is not known.
    pub(super) size: u64,
    /// How it begins; empty for a file.
    pub(super) preview: String,
}

/// Rows that have come, by pages.
#[derive(Clone, Debug, Default)]
struct Pages {
    edition: u32,
    known: Vec<(u32, Vec<Row>)>,
    /// Pages that were asked for, and how many rows there were to be had then.
    asked: Vec<(u32, u32)>,
}

impl Desk {
    /// With what was remembered.
    pub(crate) fn remembered() -> Self {
        Self {
            typed: kept("decoder", ""),
            previous: kept("decoder-previous", ""),
            document: RwSignal::new(None),
            form: RwSignal::new(None),
            progress: RwSignal::new(Progress { finished: true, ..Progress::default() }),
            statistics: RwSignal::new(None),
            unreadable: RwSignal::new(None),
            profile: kept("decoder-profile", AUTO),
            unit: RwSignal::new(String::new()),
            function: RwSignal::new(String::new()),
            errors_only: RwSignal::new(false),
            text: RwSignal::new(String::new()),
            chosen: RwSignal::new(0),
            turn: RwSignal::new(0),
            look: RwSignal::new(None),
            shown: RwSignal::new(String::new()),
            views_open: RwSignal::new(false),
            rows: StoredValue::new(Pages::default()),
            reading: StoredValue::new(0),
            started: StoredValue::new(false),
        }
    }

    /// Starts the analyst at the first visit, and takes up the long text of the last one.
    pub(super) fn start(&self, app: &'static Workbench) {
        if self.started.get_value() {
            return;
        }
        self.started.set_value(true);
        app.start_analyst();
        self.send_profile();
        if let Some(name) = storage::load("decoder-document").filter(|name| !name.is_empty()) {
            let name = Some(name).filter(|name| name != "\n");
            self.document.set(Some(Document { name, size: 0, preview: String::new() }));
            self.begin(&JsValue::UNDEFINED, false);
        }
    }

    /// Whether the analyst has been started.
    pub(super) fn is_started(&self) -> bool {
        self.started.get_value()
    }

    /// Chooses an entry by its number in the whole list. Where a filter hides it, the filter goes.
    pub(super) fn go_to(&self, index: u32) {
        if self.filter() != Filter::default() {
            self.clear_filter();
        }
        self.chosen.set(index);
    }

    /// Shows everything.
    pub(super) fn clear_filter(&self) {
        for field in [self.unit, self.function, self.text] {
            field.set(String::new());
        }
        self.errors_only.set(false);
    }

    /// Puts a text into the field; what stood there can be taken back.
    pub(super) fn replace(&self, text: String) {
        self.close_document();
        let old = self.typed.get_untracked();
        if old != text {
            if !old.trim().is_empty() {
                self.previous.set(old);
            }
            self.typed.set(text);
        }
    }

    /// Reads what stands in the field.
    pub(super) fn read_typed(&self) {
        if self.document.with_untracked(Option::is_none) {
            self.begin(&JsValue::from_str(&self.typed.get_untracked()), false);
        }
    }

    /// Reads a text that is too long for the field.
    pub(super) fn read_long(&self, text: &JsString) {
        let preview = String::from(text.substring(0, PREVIEW));
        self.document.set(Some(Document { name: None, size: text.length().into(), preview }));
        self.form.set(None);
        // Any name but a file's, and not empty.
        storage::save("decoder-document", "\n");
        self.begin(text, true);
    }

    /// Reads a file.
    pub(super) fn read_file(&self, file: &web_sys::File) {
        // A size is a whole number below 2^53.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let size = file.size() as u64;
        storage::save("decoder-document", &file.name());
        self.document.set(Some(Document { name: Some(file.name()), size, preview: String::new() }));
        self.form.set(None);
        self.begin(file, true);
    }

    /// Goes back to the text in the field.
    pub(super) fn close_document(&self) {
        if self.document.with_untracked(Option::is_some) {
            self.document.set(None);
            storage::save("decoder-document", "");
            analyst::send(&ToAnalyst::Forget);
            self.form.set(None);
            self.read_typed();
        }
    }

    /// Reads the same text in another way.
    pub(super) fn read_as(&self, form: Form) {
        self.form.set(Some(form));
        if self.document.with_untracked(Option::is_some) {
            self.begin(&JsValue::UNDEFINED, false);
        } else {
            self.read_typed();
        }
    }

    /// Tells the analyst which profile names the values.
    pub(super) fn send_profile(&self) {
        let choice = self.profile.with(|id| match id.as_str() {
            AUTO => ProfileChoice::Auto,
            NO_PROFILE => ProfileChoice::None,
            id => ProfileChoice::File(device::find(id).source().to_owned()),
        });
        analyst::send(&ToAnalyst::Profile(choice));
    }

    /// What the fields of the filter say; what cannot be read filters nothing.
    pub(super) fn filter(&self) -> Filter {
        Filter {
            unit: self.unit.with(|text| code(text)),
            function: self.function.with(|text| code(text)),
            direction: None,
            errors_only: self.errors_only.get(),
            text: self.text.get(),
        }
    }

    /// Tells the analyst what is shown.
    pub(super) fn send_filter(&self) {
        analyst::send(&ToAnalyst::Filter(self.filter()));
    }

    /// The row at a place, if it has come.
    pub(super) fn row(&self, at: u32) -> Option<Row> {
        self.rows.with_value(|rows| rows.row(at).cloned())
    }

    /// What is said of the row at a place, if it has come.
    pub(super) fn with_row<T>(&self, at: u32, act: impl FnOnce(&Row) -> T) -> Option<T> {
        self.rows.with_value(|rows| rows.row(at).map(act))
    }

    /// Asks for the rows of these places that have not come.
    pub(super) fn want(&self, places: std::ops::Range<u32>) {
        let shown = self.progress.with_untracked(|progress| progress.shown);
        let missing = self.rows.try_update_value(|rows| rows.missing(&places, shown)).unwrap_or_default();
        for page in missing {
            analyst::send(&ToAnalyst::Rows { from: page * PAGE, count: PAGE });
        }
    }

    /// The profile in force.
    pub(super) fn device(&self) -> Option<&'static device::Device> {
        self.progress.with(|progress| progress.profile.as_deref().map(device::find))
    }

    /// The same without following its changes.
    pub(super) fn device_untracked(&self) -> Option<&'static device::Device> {
        self.progress.with_untracked(|progress| progress.profile.as_deref().map(device::find))
    }

    fn begin(&self, beside: &JsValue, keep: bool) {
        let reading = self.reading.get_value().wrapping_add(1);
        self.reading.set_value(reading);
        self.unreadable.set(None);
        self.statistics.set(None);
        self.chosen.set(0);
        self.progress.update(|progress| {
            progress.finished = false;
            progress.done = 0;
        });
        let form = self.form.get_untracked();
        analyst::send_with(&ToAnalyst::Read { reading, form, keep }, beside);
    }

    /// Takes in what the analyst says.
    pub(crate) fn hear(&self, message: FromAnalyst, beside: &JsValue) {
        let current = self.reading.get_value();
        match message {
            FromAnalyst::Progress(progress) if progress.reading == current => {
                let edition = progress.edition;
                let more = self.progress.with_untracked(|before| before.shown != progress.shown);
                let stale = self.rows.try_update_value(|rows| rows.turn_to(edition)).unwrap_or_default();
                self.progress.set(progress);
                if more || stale {
                    self.bump();
                }
            }
            FromAnalyst::Rows(rows) => {
                if self.rows.try_update_value(|pages| pages.take(rows)).unwrap_or_default() {
                    self.bump();
                }
            }
            FromAnalyst::Statistics(statistics) if statistics.reading == current => {
                self.statistics.set(Some(statistics));
                // Scales and one-sidedness are known now.
                self.rows.update_value(Pages::forget);
                self.bump();
            }
            FromAnalyst::Look(look) => self.look.set(Some(look)),
            FromAnalyst::Exported(format) => save_file(format, beside),
            FromAnalyst::NothingKept => {
                self.document.set(None);
                storage::save("decoder-document", "");
                self.read_typed();
            }
            FromAnalyst::Unreadable(words) => self.unreadable.set(Some(words)),
            FromAnalyst::Progress(_)
            | FromAnalyst::Statistics(_)
            | FromAnalyst::Sums(..)
            | FromAnalyst::Console(_)
            | FromAnalyst::Panicked(_) => {}
        }
    }

    fn bump(&self) {
        self.turn.update(|turn| *turn = turn.wrapping_add(1));
    }
}

impl Pages {
    fn row(&self, at: u32) -> Option<&Row> {
        let (_, rows) = self.known.iter().find(|(page, _)| *page == at / PAGE)?;
        rows.get((at % PAGE) as usize)
    }

    /// Pages to ask for, so that all rows up to `shown` come.
    fn missing(&mut self, places: &std::ops::Range<u32>, shown: u32) -> Vec<u32> {
        if places.is_empty() {
            return Vec::new();
        }
        let wanted = places.start / PAGE..=(places.end - 1) / PAGE;
        let mut missing = Vec::new();
        for page in wanted {
            let full = shown.saturating_sub(page * PAGE).min(PAGE);
            let known = self.known.iter().find(|(known, _)| *known == page).map_or(0, |(_, rows)| rows.len());
            let asked = self.asked.iter().any(|(asked, at)| (*asked, *at) == (page, full));
            if known < full as usize && !asked {
                self.asked.retain(|(asked, _)| *asked != page);
                self.asked.push((page, full));
                missing.push(page);
            }
        }
        missing
    }

    /// Takes rows in; whether they are of use.
    fn take(&mut self, Rows { edition, from, rows }: Rows) -> bool {
        if edition != self.edition {
            return false;
        }
        let page = from / PAGE;
        self.asked.retain(|(asked, _)| *asked != page);
        self.known.retain(|(known, _)| *known != page);
        if self.known.len() >= MOST_PAGES {
            self.known.remove(0);
        }
        self.known.push((page, rows));
        true
    }

    /// Forgets rows of an earlier edition; whether there were any.
    fn turn_to(&mut self, edition: u32) -> bool {
        let stale = self.edition != edition;
        if stale {
            self.edition = edition;
            self.forget();
        }
        stale
    }

    fn forget(&mut self) {
        self.known.clear();
        self.asked.clear();
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

    fn rows(edition: u32, from: u32, count: u32) -> Rows {
        let row = |index| Row {
            index,
            offset: 0,
            line: 0,
            time_us: None,
            is_frame: false,
            mode: buslens_codec::line::Mode::Rtu,
            direction: buslens_codec::dissect::Direction::Unknown,
            pair: None,
            bytes: vec![],
            length: 0,
            request: vec![],
            told: vec![],
            diagnoses: vec![],
            unanswered: false,
            orphan: false,
            origin: buslens_bus::record::Origin::Unknown,
            gap_us: None,
            round_trip_us: None,
            before: vec![],
            mark: None,
        };
        Rows { edition, from, rows: (from..from + count).map(row).collect() }
    }

    #[test]
    fn a_page_is_asked_for_once_and_again_when_there_is_more_of_it() {
        let mut pages = Pages::default();
        assert_eq!(pages.missing(&(60..70), 100), [0, 1]);
        assert_eq!(pages.missing(&(60..70), 100), []);
        assert!(pages.take(rows(0, 64, 36)));
        assert_eq!(pages.row(99).map(|row| row.index), Some(99));
        assert!(pages.row(100).is_none() && pages.row(63).is_none());
        assert_eq!(pages.missing(&(64..100), 100), []);
        assert_eq!(pages.missing(&(64..100), 128), [1]);
    }

    #[test]
    fn rows_of_an_earlier_edition_are_not_shown() {
        let mut pages = Pages::default();
        assert!(pages.turn_to(3));
        assert!(!pages.take(rows(2, 0, 10)));
        assert!(pages.take(rows(3, 0, 10)));
        assert!(pages.turn_to(4));
        assert!(pages.row(0).is_none());
    }

    #[test]
    fn only_the_latest_pages_are_remembered() {
        let mut pages = Pages::default();
        for page in 0..100 {
            pages.take(rows(0, page * PAGE, PAGE));
        }
        assert_eq!(pages.known.len(), MOST_PAGES);
        assert!(pages.row(99 * PAGE).is_some() && pages.row(0).is_none());
    }

    #[test]
    fn codes_are_decimal_or_marked_hexadecimal() {
        assert_eq!(
            (code("16"), code(" 0x10 "), code("300"), code("x"), code("")),
            (Some(16), Some(16), None, None, None)
        );
    }
}
