//! What happened on a line: every frame and every stretch of noise in order, requests joined to their responses.
//!
//! A [`Transcript`] takes a stream in portions of any size, with what its source tells of it, and owns the bytes; of a stream
//! without end it can forget the oldest entries. Frames
//! with a right check are cut out first; what lies between them is searched for damaged frames ([`crate::diagnose`]),
//! and what is still left is noise. All work is linear in the stream: noise gets a bounded amount of work for each byte.

mod choose;
mod cut;
mod pair;
mod recover;
mod store;

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::ops::Range;

use crate::UnitId;
use crate::diagnose::{self, Diagnosis, Surroundings, rtu, shape};
use crate::dissect::{Direction, Dissection, dissect_known};
use crate::line::Mode;
use crate::pdu::Request;
use crate::profile::{Known, Profile};
use crate::segment::{Origin, Segment};
use cut::Run;
use pair::{Pairing, View};
use recover::Found;
use store::Store;

/// A stream taken apart into frames and noise.
#[derive(Clone, Debug, Default)]
pub struct Transcript {
    entries: Store,
    /// Bytes that are no entry yet, behind some that are.
    tail: Vec<u8>,
    /// Bytes of the stream before them.
    tail_start: u64,
    /// Segments that the last entry has not left behind, in order.
    sources: VecDeque<Source>,
    run: Option<Run>,
    /// Bytes that runs have taken.
    taken: u64,
    pairing: Pairing,
}

/// A segment and its place in a stream of any length.
#[derive(Clone, Copy, Debug)]
struct Source {
    start: u64,
    segment: Segment,
}

/// A frame or a stretch of noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Bytes of the stream before it.
    pub offset: u64,
    /// Its length in bytes, characters in ASCII mode.
    pub len: u32,
    /// The line of the text that it begins on, counted from 1; 0 where there is no text.
    pub line: u32,
    /// When it began, in microseconds on the source's own clock: by the segment that it begins in.
    pub time_us: Option<u64>,
    /// From its beginning to its end, in microseconds, as far as the source tells; else 0.
    pub span_us: u32,
    /// Number of the other half of the transaction.
    pub pair: Option<u32>,
    /// Frame or noise.
    pub kind: EntryKind,
    /// How its bytes are framed.
    pub mode: Mode,
    /// Which way it goes: by its shape where that leaves one way, else as the source says, else by its neighbours.
    pub direction: Direction,
    /// Which way it goes as the source says.
    pub mark: Direction,
    /// The check is right. `false` for noise.
    pub check_ok: bool,
    /// The request again, heard by the adapter that sent it.
    pub echo: bool,
    /// The same request as the one before, which nobody answered.
    pub repeated: bool,
    /// Who had it sent, as the source says.
    pub origin: Origin,
}

/// What an entry is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EntryKind {
    /// A frame with a right check, or a damaged one that [`diagnose`] explains.
    Frame,
    /// Bytes that belong to no frame.
    Noise,
}

/// A frame as a reader sees it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// The frame taken apart; `None` for noise and for bytes that cannot be.
    pub dissection: Option<Dissection>,
    /// What is wrong or remarkable.
    pub diagnoses: Vec<Diagnosis>,
}

impl Entry {
    /// What stands for an entry that is forgotten.
    const BLANK: Self = Self {
        offset: 0,
        len: 0,
        line: 0,
        time_us: None,
        span_us: 0,
        pair: None,
        kind: EntryKind::Noise,
        mode: Mode::Rtu,
        direction: Direction::Unknown,
        mark: Direction::Unknown,
        check_ok: false,
        echo: false,
        repeated: false,
        origin: Origin::Unknown,
    };

    /// Bytes of the stream up to its end.
    pub fn end(&self) -> u64 {
        self.offset.saturating_add(self.len.into())
    }

    /// When it ended, in microseconds on the source's own clock.
    pub fn end_us(&self) -> Option<u64> {
        self.time_us.map(|time| time.saturating_add(self.span_us.into()))
    }

    /// Whether it is a request without a response.
    pub fn is_unanswered(&self) -> bool {
        self.kind == EntryKind::Frame && self.direction == Direction::Request && self.pair.is_none() && !self.echo
    }

    /// Whether it is a response without a request.
    pub fn is_orphan(&self) -> bool {
        self.kind == EntryKind::Frame && self.direction == Direction::Response && self.pair.is_none()
    }
}

impl Transcript {
    /// An empty transcript.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the next bytes in. `segments` tell of them, in order, their starts counted from the stream's start; bytes
    /// before the first segment belong to the last one that came before, or go unmarked in RTU mode. A segment that is
    /// whole ends with these bytes.
    pub fn push(&mut self, bytes: &[u8], segments: &[Segment]) {
        self.tail.extend_from_slice(bytes);
        let end = self.stream_len();
        for segment in segments {
            let start = (segment.start as u64).clamp(self.taken, end);
            self.feed(start);
            self.begin(start, segment);
        }
        self.feed(end);
        self.trim();
    }

    /// Takes the next bytes in, which are a segment of their own; its start is not looked at.
    pub fn append(&mut self, bytes: &[u8], segment: &Segment) {
        self.begin(self.stream_len(), segment);
        self.tail.extend_from_slice(bytes);
        self.feed(self.stream_len());
        self.trim();
    }

    /// The line is quiet: what is held back becomes entries. More may come; it is not joined to what came before.
    pub fn settle(&mut self) {
        let Some(run) = &self.run else { return };
        let next = Run::new(run.mode, run.mark, self.taken);
        self.end_run();
        self.run = Some(next);
        self.trim();
    }

    /// No more bytes come: what is left becomes entries.
    pub fn finish(&mut self) {
        self.end_run();
        self.trim();
    }

    /// Bytes that are no entry yet.
    pub fn held_back(&self) -> &[u8] {
        self.tail.get(self.relative(self.entries.stream_len())..).unwrap_or_default()
    }

    /// Bytes of the whole stream so far.
    pub fn stream_len(&self) -> u64 {
        self.tail_start.saturating_add(self.tail.len() as u64)
    }

    /// Number of the first entry that is kept: 0, unless some have been forgotten.
    pub fn first(&self) -> usize {
        self.entries.first()
    }

    /// Number behind the last entry.
    pub fn end(&self) -> usize {
        self.entries.end()
    }

    /// An entry by its number. A later one may still change its direction, its pair and its echo mark.
    pub fn entry(&self, index: usize) -> Option<Entry> {
        self.entries.get(index)
    }

    /// Number of the first kept entry that begins at a place of the stream or behind it; the number behind the last entry
    /// for the place where the next one begins. `None` beyond that.
    pub fn entry_at(&self, place: u64) -> Option<usize> {
        let behind = self.entries.stream_len();
        if place >= behind {
            return (place == behind).then_some(self.end());
        }
        let (mut low, mut high) = (self.first(), self.end());
        while low < high {
            let middle = low + (high - low) / 2;
            if self.entries.at(middle).offset < place { low = middle + 1 } else { high = middle }
        }
        Some(low)
    }

    /// Frames and noise that are kept, in order and without gaps.
    pub fn entries(&self) -> impl ExactSizeIterator<Item = Entry> + DoubleEndedIterator + '_ {
        (self.first()..self.end()).map(|index| self.entries.at(index))
    }

    /// The bytes of an entry, characters in ASCII mode. Empty for one that is not there.
    pub fn entry_bytes(&self, index: usize) -> &[u8] {
        self.entries.bytes(index)
    }

    /// Forgets the entries before this one. Numbers stay as they are, those in [`Entry::pair`] too.
    pub fn forget_before(&mut self, index: usize) {
        self.entries.forget_before(index);
    }

    /// From now on [`take_changed`](Self::take_changed) tells which entries before this one have changed.
    pub fn watch(&mut self, until: usize) {
        self.entries.watch(until);
    }

    /// Numbers of the watched entries that later ones have changed since this was last asked, some of them several times.
    pub fn take_changed(&mut self) -> Vec<u32> {
        self.entries.take_changed()
    }

    /// Bytes of memory that entries and their bytes take.
    pub fn footprint(&self) -> usize {
        self.entries.footprint() + self.tail.capacity() + self.sources.capacity() * size_of::<Source>()
    }

    /// A frame taken apart, as it stands, and what is wrong with it or remarkable, most important first; nothing for noise.
    ///
    /// `known` is what earlier frames of its unit told under this profile; a frame with a right check adds to it.
    pub fn reading(&self, index: usize, profile: Option<&Profile>, known: &mut Known) -> Reading {
        let Some(entry) = self.entries.get(index).filter(|entry| entry.kind == EntryKind::Frame) else {
            return Reading::default();
        };
        let frame = self.entry_bytes(index);
        let request = self.request_of(&entry).and_then(|request| Request::decode(request.get(1..)?).ok());
        let mut unsure = None;
        let known = if entry.check_ok { known } else { unsure.insert(known.clone()) };
        let dissection = dissect_known(frame, entry.mode, entry.direction, request.as_ref(), profile, known);
        let mut diagnoses: Vec<Diagnosis> = Vec::new();
        diagnoses.extend(profile.and_then(|profile| diagnose::manual_erratum(frame, profile)));
        diagnoses.extend(self.diagnoses(index));
        if let (Some(profile), Some(dissection), true) = (profile, &dissection, entry.check_ok) {
            diagnoses.extend(diagnose::values_out_of_range(dissection, profile));
        }
        Reading { dissection, diagnoses }
    }

    /// What is wrong with an entry or remarkable about it, whatever device it comes from, most important first.
    pub fn diagnoses(&self, index: usize) -> Vec<Diagnosis> {
        let Some(entry) = self.entries.get(index).filter(|entry| entry.kind == EntryKind::Frame) else {
            return Vec::new();
        };
        let frame = self.entry_bytes(index);
        let request = self.request_of(&entry);
        // A damaged frame's own bytes say little of its direction.
        let around = Surroundings { direction: entry.mark, request: request.as_deref() };
        if !entry.check_ok {
            return diagnose::damage(entry.mode, frame, around);
        }
        let mut found = Vec::new();
        let Some(View { unit, pdu }) = View::of(entry.mode, frame, around) else { return found };
        if entry.echo {
            found.push(Diagnosis::Echo);
        }
        found.extend(shape::miscounted(&pdu, entry.direction));
        if entry.mode == Mode::Rtu && found.is_empty() && !rtu::is_whole(frame, around) {
            // A frame that ends with a zero has a right check without it, too.
            found.extend(rtu::truncated(frame, around));
        }
        if found.is_empty() {
            found.extend(self.unfitting(index, &entry, unit, &pdu));
        }
        if let [0x80..=0xFF, code, ..] = *pdu {
            found.push(Diagnosis::Exception { code });
        }
        if unit > 247 {
            found.push(Diagnosis::UnitReserved { unit });
        }
        found
    }

    /// The unit id and the function code of a frame as they stand, the code without an exception's top bit; `None` for noise
    /// and where they cannot be read.
    pub fn header(&self, index: usize) -> Option<(UnitId, u8)> {
        let entry = self.entries.get(index).filter(|entry| entry.kind == EntryKind::Frame)?;
        let frame = self.entry_bytes(index);
        let (unit, function) = match entry.mode {
            Mode::Rtu => (*frame.first()?, *frame.get(1)?),
            Mode::Ascii => diagnose::ascii::header(frame)?,
        };
        Some((UnitId(unit), function & 0x7F))
    }

    /// Unit id and PDU of the request that a response answers; a damaged one as it was meant.
    fn request_of(&self, entry: &Entry) -> Option<Vec<u8>> {
        let pair = entry.pair.filter(|_| entry.direction == Direction::Response)?;
        self.meant(usize::try_from(pair).ok()?, Direction::Request)
    }

    /// Unit id and PDU of a frame; a damaged one as it was meant.
    fn meant(&self, index: usize, direction: Direction) -> Option<Vec<u8>> {
        let entry = self.entries.get(index)?;
        let around = Surroundings { direction, request: None };
        let View { unit, pdu } = View::of(entry.mode, self.entry_bytes(index), around)?;
        Some([&[unit], &*pdu].concat())
    }

    /// A response right behind a request of its unit and function whose quantity its byte count does not fit.
    fn unfitting(&self, index: usize, entry: &Entry, unit: u8, pdu: &[u8]) -> Option<Diagnosis> {
        if !entry.is_orphan() {
            return None;
        }
        let before = pair::frame_before(&self.entries, index)?;
        self.entries.get(before).filter(Entry::is_unanswered)?;
        let request = self.meant(before, Direction::Request)?;
        let (asked, head) = request.split_first()?;
        let (function, count) = (*pdu.first()?, *pdu.get(1)?);
        let counts = matches!(function, 0x01..=0x04 | 0x17);
        if !counts || head.first() != Some(&function) || (*asked != unit && unit != 0) {
            return None;
        }
        let expected = shape::response_len(head)?.checked_sub(2)?;
        (usize::from(count) != expected).then_some(Diagnosis::ByteCountMismatch { found: count, expected })
    }

    /// Another segment begins.
    fn begin(&mut self, start: u64, segment: &Segment) {
        let alone = segment.whole || self.sources.back().is_some_and(|source| source.segment.whole);
        self.sources.push_back(Source { start, segment: *segment });
        let continues = self.run.as_ref().is_some_and(|run| run.continues(segment.mode, segment.direction));
        if alone || !continues {
            self.end_run();
            self.run = Some(Run::new(segment.mode, segment.direction, start));
        }
    }

    /// Lets the run have the stream up to `end`, and takes in what it finds.
    fn feed(&mut self, end: u64) {
        if end <= self.taken {
            return;
        }
        let start = self.taken;
        let fresh = self.relative(start)..self.relative(end);
        self.taken = end;
        if let Some(source) = self.sources.back().filter(|source| source.segment.whole) {
            let Segment { mode, direction, .. } = source.segment;
            let found = recover::whole_or_noise(mode, &self.tail, fresh, &self.known(direction));
            return self.admit(found, mode, direction);
        }
        let run = self.run.get_or_insert_with(|| Run::new(Mode::Rtu, Direction::Unknown, start));
        run.push(self.tail.get(fresh).unwrap_or_default());
        self.drain();
    }

    fn end_run(&mut self) {
        if let Some(run) = &mut self.run {
            run.finish();
            self.drain();
        }
        self.run = None;
    }

    fn drain(&mut self) {
        let Some(mut run) = self.run.take() else { return };
        while let Some(piece) = run.next_piece() {
            let range = self.relative(piece.range.start)..self.relative(piece.range.end);
            if piece.is_frame {
                self.admit(Found::frame(range), run.mode, run.mark);
            } else {
                self.search(range, run.mode, run.mark);
            }
        }
        self.run = Some(run);
    }

    /// Looks for damaged frames in a stretch without a right check.
    fn search(&mut self, stretch: Range<usize>, mode: Mode, mark: Direction) {
        let lines = self.sources.iter().filter(|source| source.segment.line > 0);
        let lines = lines.map(|source| self.relative(source.start)).skip_while(|start| *start <= stretch.start);
        let borders: Vec<usize> = lines.take_while(|start| *start < stretch.end).collect();
        let mut search = recover::Search::new(mode, stretch, &borders);
        while let Some(found) = search.next(&self.tail, &self.known(mark)) {
            self.admit(found, mode, mark);
        }
    }

    fn known(&self, mark: Direction) -> recover::Known<'_> {
        recover::Known { mark, request: self.pairing.expected(&self.entries), units: self.pairing.units() }
    }

    fn admit(&mut self, found: Found, mode: Mode, mark: Direction) {
        let Found { range, kind } = found;
        let offset = self.tail_start.saturating_add(range.start as u64);
        let end = self.tail_start.saturating_add(range.end as u64);
        while self.sources.get(1).is_some_and(|next| next.start <= offset) {
            self.sources.pop_front();
        }
        let source = self.sources.front().filter(|source| source.start <= offset).copied();
        let segment = source.map(|source| source.segment).unwrap_or_default();
        let time_us = self.time_at(0, offset);
        let last = match self.sources.get(1) {
            Some(next) if next.start < end => {
                self.sources.iter().take_while(|source| source.start < end).count().saturating_sub(1)
            }
            _ => 0,
        };
        let end_us = self.time_at(last, end);
        let span = end_us.unwrap_or(0).saturating_sub(time_us.unwrap_or(u64::MAX));
        let frame = self.tail.get(range).unwrap_or_default();
        let entry = Entry {
            line: segment.line,
            time_us,
            span_us: u32::try_from(span).unwrap_or(u32::MAX),
            kind,
            mode,
            direction: mark,
            mark,
            check_ok: kind == EntryKind::Frame && recover::is_right(mode, frame),
            origin: segment.origin,
            ..Entry::BLANK
        };
        self.entries.push(&entry, frame);
        if kind == EntryKind::Frame {
            self.pairing.place(&mut self.entries, &entry, frame);
        }
    }

    /// When the stream had come to a place, by one of the segments that still count: its bytes share its time evenly.
    fn time_at(&self, source: usize, place: u64) -> Option<u64> {
        let Source { start, segment } = self.sources.get(source)?;
        let time_us = segment.time_us?;
        let passed = place.checked_sub(*start)?;
        if segment.span_us == 0 {
            return Some(time_us);
        }
        let end = self.sources.get(source + 1).map_or(self.taken, |next| next.start);
        let span = u64::from(segment.span_us).saturating_mul(passed).checked_div(end.saturating_sub(*start));
        Some(time_us.saturating_add(span.unwrap_or(0)))
    }

    /// Where a place of the stream is in the tail.
    fn relative(&self, place: u64) -> usize {
        usize::try_from(place.saturating_sub(self.tail_start)).unwrap_or(usize::MAX)
    }

    /// Drops bytes that are entries, once they are the greater part.
    fn trim(&mut self) {
        let given = self.relative(self.entries.stream_len());
        if given > self.tail.len() / 2 {
            self.tail.drain(..given.min(self.tail.len()));
            self.tail_start = self.tail_start.saturating_add(given as u64);
        }
    }
}

#[cfg(test)]
mod tests;
