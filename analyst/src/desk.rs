//! One text at a time, or the log of a line: read in portions, listed, filtered, counted.

mod live;
mod replay;
mod rows;
mod survey;

use std::cell::Cell;
use std::collections::VecDeque;

use buslens_codec::intake::{self, Detection, Form, IntakeError, Reader};
use buslens_codec::line::Mode;
use buslens_codec::profile::{BUILT_IN, Known, Profile};
use buslens_codec::transcript::{Entry, EntryKind, Transcript};
use buslens_codec::{UnitId, ascii};

use crate::diary::Diary;
use crate::export::Sheet;
use crate::facts::Facts;
use crate::filter::Sieve;
use crate::look;
use crate::message::{Filter, Format, Look, ProfileChoice, Progress};
use crate::scale::Scales;
use crate::statistics::Counting;
use live::Live;
pub use replay::Cursor;

/// Places that could not be read that are told.
const MOST_FAULTS: usize = 16;
/// A text's beginning that is kept until there is enough of it to tell how it is to be read.
const SAMPLE: usize = 64 << 10;

/// A text in work, or a log that grows, and what has come of it.
pub struct Desk {
    /// Those among which the one that explains most is found: the built-in ones, then the user's own.
    candidates: Vec<Profile>,
    choice: ProfileChoice,
    /// The profile in force: one of the candidates or the chosen file's.
    profile: Option<Profile>,
    filter: Filter,
    /// What only a log has that grows.
    live: Option<Live>,
    reading: u32,
    wish: Option<Form>,
    reader: Option<Reader>,
    alternative: Option<Form>,
    /// What waits for [`SAMPLE`].
    head: String,
    transcript: Transcript,
    diary: Diary,
    faults: Vec<IntakeError>,
    total: u64,
    done: u64,
    finished: bool,
    cancelled: bool,
    edition: u32,
    /// The first and the last entry that were sent as rows of this edition.
    told: Cell<Option<(u32, u32)>>,
    /// The list ends before this entry, although more are there.
    held_from: Option<u32>,
    scales: Scales,
    tellers: Vec<(u8, u16)>,
    counting: Counting,
    /// Nobody misses the other half of a transaction.
    one_sided: bool,
    /// What is known of the entries that are kept and have been counted.
    facts: VecDeque<Facts>,
    /// Number behind the last of them.
    surveyed: usize,
    /// A request whose answer may still come.
    waiting: Option<u32>,
    sieve: Option<Sieve>,
    /// Entries that the sieve let through, and the number behind the last that it has seen.
    shown: VecDeque<u32>,
    sifted: usize,
}

impl Desk {
    /// An empty desk.
    pub fn new() -> Self {
        // The codec's tests load every built-in profile.
        Self::with(BUILT_IN.iter().filter_map(|text| Profile::from_json(text).ok()).collect())
    }

    fn with(candidates: Vec<Profile>) -> Self {
        Self {
            candidates,
            choice: ProfileChoice::default(),
            profile: None,
            filter: Filter::default(),
            live: None,
            reading: 0,
            wish: None,
            reader: None,
            alternative: None,
            head: String::new(),
            transcript: Transcript::new(),
            diary: Diary::default(),
            faults: Vec::new(),
            total: 0,
            done: 0,
            finished: true,
            cancelled: false,
            edition: 0,
            told: Cell::new(None),
            held_from: None,
            scales: Scales::default(),
            tellers: Vec::new(),
            counting: Counting::default(),
            one_sided: true,
            facts: VecDeque::new(),
            surveyed: 0,
            waiting: None,
            sieve: None,
            shown: VecDeque::new(),
            sifted: 0,
        }
    }

    /// Clears the desk for a text of `total` characters or bytes. `form` says how to read it; `None` finds out.
    pub fn begin(&mut self, reading: u32, form: Option<Form>, total: u64) {
        let fresh = Self::with(std::mem::take(&mut self.candidates));
        let (choice, filter) = (std::mem::take(&mut self.choice), std::mem::take(&mut self.filter));
        let profile = self.profile.take().filter(|_| !matches!(choice, ProfileChoice::Auto(_)));
        *self = Self {
            choice,
            filter,
            profile,
            reading,
            wish: form,
            total,
            finished: false,
            edition: self.edition.wrapping_add(1),
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
        self.diary.settle(&self.transcript);
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
        if let ProfileChoice::Auto(own) = &choice {
            self.candidates.truncate(BUILT_IN.len());
            self.candidates.extend(own.iter().filter_map(|text| Profile::from_json(text).ok()));
        }
        self.choice = choice;
        self.profile = None;
        self.take_up_profile();
    }

    /// Shows only what fits from now on.
    pub fn set_filter(&mut self, filter: Filter) {
        self.filter = filter;
        self.take_up_filter();
    }

    /// How far everything has come.
    pub fn progress(&self) -> Progress {
        let (first, end) = (self.transcript.first(), self.view_end());
        let after = self.diary.before(place(end)).map(|happened| happened.event);
        Progress {
            reading: self.reading,
            done: self.done,
            total: self.total,
            finished: self.finished,
            cancelled: self.cancelled,
            first: place(first),
            entries: place(end - first),
            shown: place(self.shown()),
            edition: self.edition,
            form: self.reader.as_ref().map(Reader::form),
            alternative: self.alternative,
            faults: self.faults.clone(),
            fault_count: self.reader.as_ref().map_or(0, Reader::fault_count) as u64,
            profile: self.profile.as_ref().map(|profile| profile.id.clone()),
            held: place(self.transcript.end() - end),
            after: if self.held_from.is_none() { after.collect() } else { Vec::new() },
            start_us: self.transcript.entries().next().and_then(|entry| entry.time_us),
            epoch_us: self.epoch_us(),
        }
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

    /// Marks an entry, given by its number in the whole list, or takes its mark away; `false` if there is no such entry.
    pub fn mark(&mut self, index: u32, comment: Option<String>) -> bool {
        if self.transcript.entry(index as usize).is_none() {
            return false;
        }
        self.diary.mark(index, comment);
        self.sift_again(index as usize);
        self.outdate(index);
        true
    }

    /// Writes the list as it is filtered, in parts that are handed to `write` one after the other. All are text but those of
    /// a capture file.
    pub fn export(&self, format: Format, write: impl FnMut(&[u8])) {
        let shown = (0..self.shown()).filter_map(|at| self.shown_at(at));
        self.sheet().write(format, shown, write);
    }

    /// Unix time of the origin of the entries' clock, in microseconds, where it is known.
    pub fn epoch_us(&self) -> Option<u64> {
        self.diary.epoch_us
    }

    fn sheet(&self) -> Sheet<'_> {
        Sheet {
            transcript: &self.transcript,
            profile: self.profile.as_ref(),
            scales: &self.scales,
            diary: &self.diary,
            end: self.view_end(),
        }
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
        portion.remarks.into_iter().for_each(|remark| self.diary.hear(remark));
        self.diary.settle(&self.transcript);
    }

    fn take_up_profile(&mut self) {
        self.profile = match &self.choice {
            ProfileChoice::None => None,
            ProfileChoice::File(text) => Profile::from_json(text).ok(),
            ProfileChoice::Auto(_) if self.live.is_some() => self.most_explaining_lately(),
            ProfileChoice::Auto(_) => self.transcript.most_explaining(&self.candidates).cloned(),
        };
        self.tellers = self.profile.as_ref().map(Scales::tellers).unwrap_or_default();
        self.begin_survey();
        self.take_up_filter();
    }

    fn take_up_filter(&mut self) {
        self.sieve = Sieve::new(&self.filter, self.profile.as_ref());
        self.begin_sifting();
    }

    /// Number behind the last entry of the list.
    fn view_end(&self) -> usize {
        let (first, end) = (self.transcript.first(), self.transcript.end());
        self.held_from.map_or(end, |held| (held as usize).clamp(first, end))
    }

    /// Rows that were sent are no longer what they were.
    fn new_edition(&mut self) {
        self.edition = self.edition.wrapping_add(1);
        self.told.set(None);
    }

    /// A row has changed.
    fn outdate(&mut self, index: u32) {
        if self.told.get().is_some_and(|(first, last)| (first..=last).contains(&index)) {
            self.new_edition();
        }
    }
}

impl Default for Desk {
    fn default() -> Self {
        Self::new()
    }
}

/// What single registers that were seen tell under a profile.
pub(crate) fn known_of(profile: Option<&Profile>, told: &[(u8, u16, u16)]) -> Known {
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
