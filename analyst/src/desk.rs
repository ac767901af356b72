//! One text at a time, or the log of a line: read in portions, listed, filtered, counted.

mod live;

use buslens_bus::record::Origin;
use buslens_codec::dissect::Direction;
use buslens_codec::intake::{self, Detection, Form, IntakeError, Reader};
use buslens_codec::outline::Outline;
use buslens_codec::profile::{BUILT_IN, Known, Profile};
use buslens_codec::stream::Shape;
use buslens_codec::transcript::{Entry, EntryKind, Transcript};
use buslens_codec::{UnitId, ascii, line::Mode};

use crate::filter::Sieve;
use crate::message::{Filter, Format, Look, ProfileChoice, Progress, Row, Rows, Statistics};
use crate::scale::Scales;
use crate::statistics::Counting;
use crate::{export, look};

/// Places that could not be read that are told.
const MOST_FAULTS: usize = 16;
/// A text's beginning that is kept until there is enough of it to tell how it is to be read.
const SAMPLE: usize = 64 << 10;
/// Bytes of a row that are sent; noise can be longer.
const ROW_BYTES: usize = 520;
/// Rows that are sent at once.
const MOST_ROWS: u32 = 512;

pub use live::Cursor;
use live::Live;

/// A text in work, or a log that grows, and what has come of it.
pub struct Desk {
    live: Option<Live>,
    built_in: Vec<Profile>,
    choice: ProfileChoice,
    /// The profile in force: one of the built-in ones or the chosen file's.
    profile: Option<Profile>,
    filter: Filter,
    reading: u32,
    wish: Option<Form>,
    reader: Option<Reader>,
    alternative: Option<Form>,
    /// What waits for [`SAMPLE`].
    head: String,
    transcript: Transcript,
    faults: Vec<IntakeError>,
    total: u64,
    done: u64,
    finished: bool,
    cancelled: bool,
    edition: u32,
    scales: Scales,
    tellers: Vec<(u8, u16)>,
    counting: Counting,
    /// Entries that have been counted.
    surveyed: usize,
    sieve: Option<Sieve>,
    /// Entries that the sieve let through, and how many it has seen.
    shown: Vec<u32>,
    sifted: usize,
}

impl Desk {
    /// An empty desk.
    pub fn new() -> Self {
        // The codec's tests load every built-in profile.
        Self::with(BUILT_IN.iter().filter_map(|text| Profile::from_json(text).ok()).collect())
    }

    fn with(built_in: Vec<Profile>) -> Self {
        Self {
            live: None,
            built_in,
            choice: ProfileChoice::Auto,
            profile: None,
            filter: Filter::default(),
            reading: 0,
            wish: None,
            reader: None,
            alternative: None,
            head: String::new(),
            transcript: Transcript::new(),
            faults: Vec::new(),
            total: 0,
            done: 0,
            finished: true,
            cancelled: false,
            edition: 0,
            scales: Scales::default(),
            tellers: Vec::new(),
            counting: Counting::default(),
            surveyed: 0,
            sieve: None,
            shown: Vec::new(),
            sifted: 0,
        }
    }

    /// Clears the desk for a text of `total` characters or bytes. `form` says how to read it; `None` finds out.
    pub fn begin(&mut self, reading: u32, form: Option<Form>, total: u64) {
        let fresh = Self::with(std::mem::take(&mut self.built_in));
        let (choice, filter) = (std::mem::take(&mut self.choice), std::mem::take(&mut self.filter));
        let profile = self.profile.take().filter(|_| choice != ProfileChoice::Auto);
        *self = Self {
            choice,
            filter,
            profile,
            reading,
            wish: form,
            total,
            finished: false,
            edition: self.edition + 1,
            ..fresh
        };
    }

    /// Takes the next part of the text, `weight` characters or bytes of the total.
    pub fn push(&mut self, text: &str, weight: u64) {
        if self.finished {
            return;
        }
        self.done = self.done.saturating_add(weight);
        if let Some(reader) = &mut self.reader {
            reader.push(text);
        } else {
            self.head.push_str(text);
            if self.head.len() < SAMPLE {
                return;
            }
            self.start_reader();
        }
        self.transcribe();
    }

    /// The text has ended.
    pub fn finish(&mut self) {
        if self.finished {
            return;
        }
        if self.reader.is_none() {
            self.start_reader();
        }
        if let Some(reader) = &mut self.reader {
            reader.finish();
        }
        self.transcribe();
        self.transcript.finish();
        self.finished = true;
        self.done = self.total;
        self.take_up_profile();
    }

    /// No more of the text is wanted.
    pub fn cancel(&mut self) {
        if !self.finished {
            let done = self.done;
            self.finish();
            self.done = done;
            self.cancelled = true;
        }
    }

    /// Names values under another profile from now on.
    pub fn choose(&mut self, choice: ProfileChoice) {
        self.choice = choice;
        self.profile = None;
        self.take_up_profile();
    }

    /// Shows only what fits from now on.
    pub fn set_filter(&mut self, filter: Filter) {
        self.filter = filter;
        self.take_up_filter();
    }

    /// Counts and sifts up to `limit` entries of a text that has ended; whether there is more to do.
    pub fn work(&mut self, limit: usize) -> bool {
        let entries = self.transcript.end();
        if !self.finished {
            return false;
        }
        let until = entries.min(self.surveyed.saturating_add(limit));
        for index in self.surveyed..until {
            self.survey(index);
        }
        if self.surveyed < until {
            self.surveyed = until;
            return until < entries || self.sieve.is_some();
        }
        let Some(sieve) = &self.sieve else { return false };
        let until = entries.min(self.sifted.saturating_add(limit));
        let one_sided = self.counting.is_one_sided();
        let passes = |index: &usize| sieve.passes(&self.transcript, self.profile.as_ref(), *index, one_sided);
        self.shown.extend((self.sifted..until).filter(passes).map(place));
        self.sifted = until;
        until < entries
    }

    /// How far everything has come.
    pub fn progress(&self) -> Progress {
        Progress {
            reading: self.reading,
            done: self.done,
            total: self.total,
            finished: self.finished,
            cancelled: self.cancelled,
            first: 0,
            entries: place(self.transcript.end()),
            shown: place(self.shown()),
            edition: self.edition,
            form: self.reader.as_ref().map(Reader::form),
            alternative: self.alternative,
            faults: self.faults.clone(),
            fault_count: self.reader.as_ref().map_or(0, Reader::fault_count) as u64,
            profile: self.profile.as_ref().map(|profile| profile.id.clone()),
            held: 0,
            after: Vec::new(),
            start_us: self.transcript.entries().next().and_then(|entry| entry.time_us),
            epoch_us: self.epoch_us(),
        }
    }

    /// The counts of a text that has ended; `None` while they are being made.
    pub fn statistics(&self) -> Option<Statistics> {
        (self.finished && self.surveyed == self.transcript.end()).then(|| self.counting.statistics(self.reading))
    }

    /// Some of the list as it is filtered.
    pub fn rows(&self, from: u32, count: u32) -> Rows {
        let wanted = (from..from.saturating_add(count.min(MOST_ROWS))).map_while(|at| self.shown_at(at as usize));
        Rows { edition: self.edition, from, rows: wanted.filter_map(|index| self.row(index)).collect() }
    }

    /// Looks closely at an entry, given by its number in the whole list; `shown` is what the device's display shows.
    pub fn look(&self, index: u32, shown: &str) -> Look {
        let at = index as usize;
        let told = self
            .transcript
            .header(at)
            .map(|(unit, _)| unit)
            .map(|unit| self.scales.known_before(index, unit.0))
            .unwrap_or_default();
        let mut known = known_of(self.profile.as_ref(), &told);
        look::look(&self.transcript, self.profile.as_ref(), at, &mut known, shown)
    }

    /// Writes the list as it is filtered, in parts that are handed to `write` one after the other.
    pub fn export(&self, format: Format, write: impl FnMut(&[u8])) {
        let shown = (0..self.shown()).filter_map(|at| self.shown_at(at));
        export::write(&self.transcript, self.profile.as_ref(), format, shown, write);
    }

    fn start_reader(&mut self) {
        let head = std::mem::take(&mut self.head);
        let Detection { form, alternative } = intake::detect(&head);
        let (form, alternative) = match self.wish {
            // What was read before is the other way now.
            Some(wish) if wish != form => (wish, Some(form)),
            _ => (form, alternative),
        };
        let mut reader = Reader::new(form);
        reader.push(&head);
        self.alternative = alternative;
        self.reader = Some(reader);
    }

    fn transcribe(&mut self) {
        let Some(reader) = &mut self.reader else { return };
        let portion = reader.take();
        let room = MOST_FAULTS.saturating_sub(self.faults.len());
        self.faults.extend(portion.faults.into_iter().take(room));
        self.transcript.push(&portion.bytes, &portion.segments);
    }

    fn take_up_profile(&mut self) {
        self.profile = match &self.choice {
            ProfileChoice::None => None,
            ProfileChoice::File(text) => Profile::from_json(text).ok(),
            ProfileChoice::Auto => self.transcript.most_explaining(&self.built_in).cloned(),
        };
        self.tellers = self.profile.as_ref().map(Scales::tellers).unwrap_or_default();
        self.scales = Scales::default();
        self.counting = Counting::default();
        self.surveyed = 0;
        self.take_up_filter();
    }

    fn take_up_filter(&mut self) {
        self.sieve = Sieve::new(&self.filter, self.profile.as_ref());
        self.shown = Vec::new();
        self.sifted = 0;
        self.edition += 1;
    }

    fn survey(&mut self, index: usize) {
        let Some(entry) = self.transcript.entry(index) else { return };
        let bytes = self.transcript.entry_bytes(index);
        let Some((unit, pdu)) = parts(&entry, bytes) else {
            return self.counting.count(&entry, None, &[]);
        };
        let shape = if entry.direction == Direction::Response { Shape::Response } else { Shape::Request };
        let outline = Outline::of_pdu(unit, &pdu, shape);
        if let (Some(outline), true, false) = (&outline, entry.check_ok, self.tellers.is_empty()) {
            let pair = entry.pair.filter(|_| shape == Shape::Response);
            let address = pair.and_then(|pair| self.address_of(pair as usize)).or(outline.address);
            if let (Some(address), Shape::Response) = (address, shape) {
                let registers: Vec<u16> = outline.registers().collect();
                self.scales.hear(&self.tellers, place(index), unit.0, outline.function, address, &registers);
            }
        }
        let diagnoses = self.diagnoses_of(index, &entry);
        self.counting.count(
            &entry,
            outline.map(|outline| (unit.0, outline.function, outline.exception.is_some())),
            &diagnoses,
        );
    }

    /// Ids of what is wrong with an entry. A whole frame of a known shape needs no closer look but for its values.
    fn diagnoses_of(&self, index: usize, entry: &Entry) -> Vec<&'static str> {
        let found = if self.profile.is_some() && entry.check_ok {
            self.transcript.reading(index, self.profile.as_ref(), &mut Known::default()).diagnoses
        } else {
            self.transcript.diagnoses(index)
        };
        found.iter().map(buslens_codec::diagnose::Diagnosis::id).collect()
    }

    fn address_of(&self, index: usize) -> Option<u16> {
        let entry = self.transcript.entry(index)?;
        let (unit, pdu) = parts(&entry, self.transcript.entry_bytes(index))?;
        Outline::of_pdu(unit, &pdu, Shape::Request)?.address
    }

    fn shown(&self) -> usize {
        if self.sieve.is_some() { self.shown.len() } else { self.transcript.end() }
    }

    fn shown_at(&self, at: usize) -> Option<usize> {
        if self.sieve.is_some() {
            self.shown.get(at).map(|index| *index as usize)
        } else {
            (at < self.transcript.end()).then_some(at)
        }
    }

    fn row(&self, index: usize) -> Option<Row> {
        let entry = self.transcript.entry(index)?;
        let bytes = self.transcript.entry_bytes(index);
        let unit = self.transcript.header(index).map(|(unit, _)| unit);
        let told = unit.map(|unit| self.scales.known_before(place(index), unit.0)).unwrap_or_default();
        let mut known = known_of(self.profile.as_ref(), &told);
        let reading = self.transcript.reading(index, self.profile.as_ref(), &mut known);
        let request = entry.pair.filter(|_| entry.direction == Direction::Response);
        let request = request.and_then(|pair| {
            let asked = self.transcript.entry(pair as usize)?;
            parts(&asked, self.transcript.entry_bytes(pair as usize))
        });
        Some(Row {
            index: place(index),
            offset: entry.offset as u64,
            line: entry.line,
            time_us: entry.time_us,
            is_frame: entry.kind == EntryKind::Frame,
            mode: entry.mode,
            direction: entry.direction,
            pair: entry.pair,
            bytes: bytes.iter().take(ROW_BYTES).copied().collect(),
            length: entry.len,
            request: request.map(|(_, pdu)| pdu).unwrap_or_default(),
            told,
            diagnoses: reading.diagnoses,
            unanswered: entry.is_unanswered() && !self.counting.is_one_sided(),
            orphan: entry.is_orphan() && !self.counting.is_one_sided(),
            origin: Origin::Unknown,
            gap_us: None,
            round_trip_us: None,
            before: Vec::new(),
            mark: None,
        })
    }
}

impl Default for Desk {
    fn default() -> Self {
        Self::new()
    }
}

/// What single registers that were seen tell under a profile.
fn known_of(profile: Option<&Profile>, told: &[(u8, u16, u16)]) -> Known {
    let mut known = Known::default();
    if let Some(profile) = profile {
        for (function, address, value) in told {
            profile.decode_points(*function, *address, &[*value], &mut known);
        }
    }
    known
}

/// Unit id and PDU of a frame as it stands, whatever its check says; `None` for noise and for what cannot be read.
pub(crate) fn parts(entry: &Entry, bytes: &[u8]) -> Option<(UnitId, Vec<u8>)> {
    if entry.kind == EntryKind::Noise {
        return None;
    }
    match entry.mode {
        Mode::Rtu => {
            let (unit, rest) = bytes.split_first()?;
            Some((UnitId(*unit), rest.get(..rest.len().checked_sub(2)?)?.to_vec()))
        }
        Mode::Ascii => {
            let body = ascii::decode_body(bytes).ok()?;
            let (unit, rest) = body.split_first()?;
            Some((UnitId(*unit), rest.get(..rest.len().checked_sub(1)?)?.to_vec()))
        }
    }
}

/// A place in a list. Four thousand million frames are more than a browser's memory holds.
pub(crate) fn place(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests;
