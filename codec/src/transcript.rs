//! What happened on a line: every frame and every stretch of noise in order, requests joined to their responses.
//!
//! A [`Transcript`] takes a stream in portions of any size, with what its source tells of it, and owns the bytes. Frames
//! with a right check are cut out first; what lies between them is searched for damaged frames ([`crate::diagnose`]),
//! and what is still left is noise. All work is linear in the stream: noise gets a bounded amount of work for each byte.

mod choose;
mod cut;
mod pair;
mod recover;

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::ops::Range;

use crate::UnitId;
use crate::diagnose::{self, Diagnosis, Surroundings, rtu, shape};
use crate::dissect::{Direction, Dissection, dissect_known};
use crate::line::Mode;
use crate::pdu::Request;
use crate::profile::{Known, Profile};
use crate::segment::Segment;
use cut::Run;
use pair::{Pairing, View};
use recover::Found;

/// A stream taken apart into frames and noise.
#[derive(Clone, Debug, Default)]
pub struct Transcript {
    bytes: Vec<u8>,
    entries: Vec<Entry>,
    /// Segments that the last entry has not left behind, in order.
    segments: VecDeque<Segment>,
    run: Option<Run>,
    /// Bytes that runs have taken.
    taken: usize,
    pairing: Pairing,
}

/// A frame or a stretch of noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Bytes of the stream before it.
    pub offset: usize,
    /// Its length in bytes, characters in ASCII mode.
    pub len: u32,
    /// The line of the text that it begins on, counted from 1; 0 where there is no text.
    pub line: u32,
    /// When, in microseconds on the source's own clock: the time of the segment that it begins in.
    pub time_us: Option<u64>,
    /// Index of the other half of the transaction.
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
    /// Its place in the stream.
    pub fn range(&self) -> Range<usize> {
        self.offset..self.offset.saturating_add(self.len as usize)
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
    /// before the first segment belong to the last one that came before, or go unmarked in RTU mode.
    pub fn push(&mut self, bytes: &[u8], segments: &[Segment]) {
        self.bytes.extend_from_slice(bytes);
        for segment in segments {
            let start = segment.start.clamp(self.taken, self.bytes.len());
            self.feed(start);
            self.segments.push_back(Segment { start, ..*segment });
            let continues = self.run.as_ref().is_some_and(|run| run.continues(segment.mode, segment.direction));
            if !continues {
                self.end_run();
                self.run = Some(Run::new(segment.mode, segment.direction, start));
            }
        }
        self.feed(self.bytes.len());
    }

    /// The line is quiet: what is held back becomes entries. More may come; it is not joined to what came before.
    pub fn settle(&mut self) {
        let Some(run) = &self.run else { return };
        let (mode, mark) = (run.mode, run.mark);
        self.end_run();
        self.run = Some(Run::new(mode, mark, self.taken));
    }

    /// No more bytes come: what is left becomes entries.
    pub fn finish(&mut self) {
        self.end_run();
    }

    /// The whole stream so far.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Frames and noise so far, in order and without gaps. A later one may still change the direction, the pair and the
    /// echo mark of those before it.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The bytes of an entry, characters in ASCII mode. Empty beyond the last.
    pub fn entry_bytes(&self, index: usize) -> &[u8] {
        self.entries.get(index).and_then(|entry| self.bytes.get(entry.range())).unwrap_or_default()
    }

    /// A frame taken apart, as it stands, and what is wrong with it or remarkable, most important first; nothing for noise.
    ///
    /// `known` is what earlier frames of its unit told under this profile; a frame with a right check adds to it.
    pub fn reading(&self, index: usize, profile: Option<&Profile>, known: &mut Known) -> Reading {
        let Some(entry) = self.entries.get(index).filter(|entry| entry.kind == EntryKind::Frame) else {
            return Reading::default();
        };
        let frame = self.entry_bytes(index);
        let request = self.request_of(entry).and_then(|request| Request::decode(request.get(1..)?).ok());
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
        let request = self.request_of(entry);
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
            found.extend(self.unfitting(index, entry, unit, &pdu));
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
        self.entries.get(before).filter(|entry| entry.is_unanswered())?;
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

    /// Lets the run have the stream up to `end`, and takes in what it finds.
    fn feed(&mut self, end: usize) {
        if end <= self.taken {
            return;
        }
        let start = self.taken;
        let run = self.run.get_or_insert_with(|| Run::new(Mode::Rtu, Direction::Unknown, start));
        run.push(self.bytes.get(start..end).unwrap_or_default());
        self.taken = end;
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
            if piece.is_frame {
                self.admit(Found::frame(piece.range), run.mode, run.mark);
            } else {
                self.search(piece.range, run.mode, run.mark);
            }
        }
        self.run = Some(run);
    }

    /// Looks for damaged frames in a stretch without a right check.
    fn search(&mut self, stretch: Range<usize>, mode: Mode, mark: Direction) {
        let first = self.segments.partition_point(|segment| segment.start <= stretch.start);
        let later = self.segments.iter().skip(first).map(|segment| segment.start);
        let borders: Vec<usize> = later.take_while(|start| *start < stretch.end).collect();
        let mut search = recover::Search::new(mode, stretch, &borders);
        loop {
            let known =
                recover::Known { mark, request: self.pairing.expected(&self.entries), units: self.pairing.units() };
            let Some(found) = search.next(&self.bytes, &known) else { return };
            self.admit(found, mode, mark);
        }
    }

    fn admit(&mut self, found: Found, mode: Mode, mark: Direction) {
        let Found { range, kind } = found;
        while self.segments.get(1).is_some_and(|next| next.start <= range.start) {
            self.segments.pop_front();
        }
        let source = self.segments.front().filter(|segment| segment.start <= range.start);
        let frame = self.bytes.get(range.clone()).unwrap_or_default();
        let entry = Entry {
            offset: range.start,
            len: u32::try_from(range.len()).unwrap_or(u32::MAX),
            line: source.map_or(0, |segment| segment.line),
            time_us: source.and_then(|segment| segment.time_us),
            pair: None,
            kind,
            mode,
            direction: mark,
            mark,
            check_ok: kind == EntryKind::Frame && recover::is_right(mode, frame),
            echo: false,
            repeated: false,
        };
        self.entries.push(entry);
        if kind == EntryKind::Frame {
            self.pairing.place(&mut self.entries, &self.bytes);
        }
    }
}

#[cfg(test)]
mod tests;
