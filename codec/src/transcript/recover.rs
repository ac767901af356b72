//! Damaged frames in bytes without a right check.
//!
//! A stretch lies between two good frames, or at a border of the source. Most often it is one damaged frame: that is tried
//! first, then line by line. Else frames are looked for from place to place. On clean ground, at the stretch's start or
//! right behind a frame, everything counts that explains a frame; within noise only a single wrong bit or a swapped check
//! in a frame of a unit that has spoken before. Searching has a budget in proportion to the stretch.

use alloc::vec::Vec;
use core::ops::Range;

use super::EntryKind;
use crate::diagnose::repair::{self, MAX_LEN};
use crate::diagnose::{Diagnosis, Surroundings, damage, rtu, shape};
use crate::dissect::Direction;
use crate::line::Mode;

/// Bytes that a search may look at, for each byte of its stretch.
const WORK_PER_BYTE: usize = 16;
/// What it may look at in any case: a few damaged frames of the greatest length.
const LEAST_WORK: usize = 8192;

/// A part of a stretch.
pub(super) struct Found {
    pub(super) range: Range<usize>,
    pub(super) kind: EntryKind,
}

impl Found {
    pub(super) fn frame(range: Range<usize>) -> Self {
        Self { range, kind: EntryKind::Frame }
    }
}

/// What is known from before the stretch.
pub(super) struct Known<'a> {
    /// Which way its bytes went, as the source says.
    pub(super) mark: Direction,
    /// Unit id and PDU of the request that waits for its response: the PDU's beginning.
    pub(super) request: Option<&'a [u8]>,
    /// Unit ids that have been seen in frames with a right check.
    pub(super) units: &'a Units,
}

impl Known<'_> {
    fn surroundings(&self) -> Surroundings<'_> {
        Surroundings { direction: self.mark, request: self.request }
    }
}

/// A set of unit ids.
#[derive(Clone, Debug, Default)]
pub(super) struct Units([u64; 4]);

impl Units {
    pub(super) fn insert(&mut self, unit: u8) {
        self.0[usize::from(unit >> 6)] |= 1 << (unit & 63);
    }

    pub(super) fn contains(&self, unit: u8) -> bool {
        self.0[usize::from(unit >> 6)] >> (unit & 63) & 1 == 1
    }
}

/// Whether a frame's check is right.
pub(super) fn is_right(mode: Mode, frame: &[u8]) -> bool {
    match mode {
        Mode::Rtu => crate::rtu::decode(frame).is_ok(),
        Mode::Ascii => crate::ascii::decode(frame).is_ok(),
    }
}

/// A search through one stretch.
pub(super) struct Search {
    mode: Mode,
    /// What is still to be searched, by lines, the next one last.
    lines: Vec<Range<usize>>,
    /// The whole stretch, until it has been tried.
    whole: Option<Range<usize>>,
    /// A frame that lies behind noise that has been given out.
    frame: Option<Range<usize>>,
    work: usize,
}

impl Search {
    /// `borders` lie within the stretch, in order.
    pub(super) fn new(mode: Mode, stretch: Range<usize>, borders: &[usize]) -> Self {
        let mut lines = Vec::with_capacity(borders.len() + 1);
        let mut end = stretch.end;
        for border in borders.iter().rev() {
            if stretch.start < *border && *border < end {
                lines.push(*border..end);
                end = *border;
            }
        }
        lines.push(stretch.start..end);
        let work = stretch.len().saturating_mul(WORK_PER_BYTE).max(LEAST_WORK);
        Self { mode, lines, whole: Some(stretch), frame: None, work }
    }

    /// The next part; the parts follow each other without gaps.
    pub(super) fn next(&mut self, stream: &[u8], known: &Known<'_>) -> Option<Found> {
        if let Some(frame) = self.frame.take() {
            return Some(Found::frame(frame));
        }
        if self.mode == Mode::Ascii {
            return self.next_characters(stream, known);
        }
        if let Some(whole) = self.whole.take()
            && self.is_one_frame(stream, &whole, known)
        {
            self.lines.clear();
            return Some(Found::frame(whole));
        }
        let line = self.lines.pop()?;
        let bytes = stream.get(line.clone())?;
        if is_specific(bytes, known) {
            return Some(Found::frame(line));
        }
        match self.first_frame(bytes, known) {
            Some(place) if place.start == 0 => Some(self.take_frame(line, place.end)),
            Some(place) => {
                // What lies before a frame may be one that is cut off.
                let before = line.start..line.start + place.start;
                self.put_back(before.end + place.len()..line.end);
                self.frame = Some(before.end..before.end + place.len());
                Some(whole_or_noise(Mode::Rtu, stream, before, known))
            }
            None => Some(whole_or_noise(Mode::Rtu, stream, line, known)),
        }
    }

    /// Whether a stretch of several lines, or of one, is one frame as a whole.
    fn is_one_frame(&self, stream: &[u8], whole: &Range<usize>, known: &Known<'_>) -> bool {
        let Some(bytes) = stream.get(whole.clone()).filter(|bytes| bytes.len() <= MAX_LEN) else { return false };
        if self.lines.len() == 1 {
            return is_specific(bytes, known);
        }
        let explained = |line: &Range<usize>| {
            stream.get(line.clone()).is_some_and(|bytes| !damage(Mode::Rtu, bytes, known.surroundings()).is_empty())
        };
        if self.lines.iter().all(explained) {
            return false;
        }
        is_specific(bytes, known) || !damage(Mode::Rtu, bytes, known.surroundings()).is_empty()
    }

    fn take_frame(&mut self, line: Range<usize>, len: usize) -> Found {
        let end = line.start + len;
        self.put_back(end..line.end);
        Found::frame(line.start..end)
    }

    fn put_back(&mut self, rest: Range<usize>) {
        if !rest.is_empty() {
            self.lines.push(rest);
        }
    }

    /// The first place in a line where a damaged frame stands and ends before the line does.
    fn first_frame(&mut self, bytes: &[u8], known: &Known<'_>) -> Option<Range<usize>> {
        let lengths = self.lengths(bytes, known);
        if let Some(len) = lengths.iter().find(|len| mended(&bytes[..**len], known, is_in_place)) {
            return Some(0..*len);
        }
        if rtu::is_whole(bytes, known.surroundings()) {
            return None;
        }
        // A header that asks for more bytes than there are tells more than a byte that may be lost or added.
        let is_cut_off = bytes.len() <= MAX_LEN && rtu::truncated(bytes, known.surroundings()).is_some();
        if !is_cut_off && let Some(len) = length_on_clean_ground(bytes, &lengths, known) {
            return Some(0..len);
        }
        for at in 1..bytes.len() {
            let rest = &bytes[at..];
            let [unit, function, ..] = *rest else { return None };
            if !known.units.contains(unit) || !shape::is_known(function) {
                continue;
            }
            let lengths = self.lengths(rest, known);
            if let Some(len) = lengths.into_iter().find(|len| mended(&rest[..*len], known, is_in_place)) {
                return Some(at..at + len);
            }
        }
        None
    }

    /// Lengths that a frame at the start of `bytes` may have, as far as they end within it and the budget allows.
    fn lengths(&mut self, bytes: &[u8], known: &Known<'_>) -> Vec<usize> {
        let mut lengths = Vec::new();
        let mut add = |pdu_len: usize| {
            let len = pdu_len + 3;
            if len <= bytes.len() && len <= crate::rtu::MAX_ADU_LEN && !lengths.contains(&len) && self.work >= len {
                self.work -= len;
                lengths.push(len);
            }
        };
        let pdu = bytes.get(1..).unwrap_or_default();
        for extent in [shape::request_extent(pdu), shape::response_extent(pdu)] {
            if let shape::Extent::Exact(len) = extent {
                add(len);
            }
        }
        let expected = known.request.and_then(|request| shape::response_len(request.get(1..)?));
        expected.into_iter().for_each(&mut add);
        // Most requests, and exceptions.
        add(5);
        add(2);
        lengths
    }

    /// The next part in ASCII mode: a colon begins a frame, a line feed ends it.
    fn next_characters(&mut self, stream: &[u8], known: &Known<'_>) -> Option<Found> {
        let line = self.lines.pop()?;
        let characters = stream.get(line.clone())?;
        let ends = |(at, character): (usize, &u8)| match character & 0x7F {
            b'\n' => Some(at + 1),
            b':' if at > 0 => Some(at),
            _ => None,
        };
        let len = characters.iter().enumerate().find_map(ends).unwrap_or(characters.len());
        self.put_back(line.start + len..line.end);
        Some(whole_or_noise(Mode::Ascii, stream, line.start..line.start + len, known))
    }
}

/// Whether the bytes are one frame beyond doubt: the check is right, though not the length, or one change mends them.
fn is_specific(bytes: &[u8], known: &Known<'_>) -> bool {
    is_right(Mode::Rtu, bytes) || mended(bytes, known, |_| true)
}

/// The length of a frame at the start of a stretch that lost or gained a byte, or that has nothing but its shape.
fn length_on_clean_ground(bytes: &[u8], lengths: &[usize], known: &Known<'_>) -> Option<usize> {
    for len in lengths {
        let shorter = bytes.get(..len.saturating_sub(1)).unwrap_or_default();
        if mended(shorter, known, |found| matches!(found, Diagnosis::MissingByte { .. } | Diagnosis::LrcInRtu)) {
            return Some(shorter.len());
        }
        let Some(longer) = bytes.get(..len + 1) else { continue };
        if mended(longer, known, |found| matches!(found, Diagnosis::ExtraByte { .. })) {
            return Some(longer.len());
        }
    }
    lengths.iter().copied().find(|len| {
        bytes.get(..*len).is_some_and(|frame| {
            frame.first().is_some_and(|unit| known.units.contains(*unit)) && rtu::is_whole(frame, known.surroundings())
        })
    })
}

fn is_in_place(found: &Diagnosis) -> bool {
    matches!(found, Diagnosis::SingleBitError { .. } | Diagnosis::SwappedCrc { .. })
}

fn mended(bytes: &[u8], known: &Known<'_>, by: impl FnMut(&Diagnosis) -> bool) -> bool {
    bytes.len() <= MAX_LEN && !repair::is_right(bytes) && rtu::specific(bytes, known.surroundings()).iter().any(by)
}

/// A range that is one entry: a frame, if it is right or explained.
pub(super) fn whole_or_noise(mode: Mode, stream: &[u8], range: Range<usize>, known: &Known<'_>) -> Found {
    let bytes = stream.get(range.clone()).unwrap_or_default();
    let is_frame =
        bytes.len() <= 2 * MAX_LEN && (is_right(mode, bytes) || !damage(mode, bytes, known.surroundings()).is_empty());
    Found { range, kind: if is_frame { EntryKind::Frame } else { EntryKind::Noise } }
}
