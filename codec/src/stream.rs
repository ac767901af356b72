//! Finding frames in a stream of bytes without time stamps.
//!
//! [`split`] goes through bytes that are all there and copies none of them. A [`Splitter`] is fed in chunks of any size and
//! finds the same, whatever their borders. Both follow the same rules:
//!
//! - RTU frames are found by the lengths that their function lets expect, for requests and for replies of every public
//!   function, and by their check. A frame of a function that tells no length ends where its check is right; it is looked
//!   for only at the start and right behind another frame.
//! - A check that is right by chance in the middle of a frame is not taken for its end, nor one behind it: of two lengths
//!   with a right check the shorter one is taken if it leaves a frame standing after it, else the longer one.
//! - What fits no frame is noise, and the search goes on at the next byte.
//! - An ASCII frame is a line from a colon to CR LF with a right LRC, the eighth bit of each character being ignored; a
//!   colon always begins a new line. A line that is no frame is noise of its own.
//!
//! The work for each byte is bounded, whatever the bytes are.

mod ascii;
mod checks;
mod lengths;
mod rtu;

use alloc::vec::Vec;
use core::iter::FusedIterator;
use core::ops::Range;

use crate::line::Mode;
use checks::Checks;

/// Longer noise comes in pieces of at least this many bytes and at most 255 more, so that a [`Splitter`] need not hold all.
pub const MAX_NOISE_LEN: usize = 4096;

/// A part of a stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Its place in the bytes of the stream; never empty.
    pub range: Range<usize>,
    /// What it is.
    pub kind: PieceKind,
}

/// What a part of a stream is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PieceKind {
    /// A frame with a right check.
    Frame(Shape),
    /// Bytes that belong to no frame with a right check.
    Noise,
}

/// Which way a frame goes, as far as its function and its length tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// From the master.
    Request,
    /// From a device.
    Response,
    /// It can be either: the function is answered by the request itself, or is not known.
    Either,
}

/// All parts of a whole stream, in order: each byte is in exactly one of them.
pub fn split(mode: Mode, bytes: &[u8]) -> Pieces<'_> {
    Pieces { bytes, cutter: Cutter::new(mode) }
}

/// The parts of a stream, made by [`split`].
#[derive(Clone, Debug)]
pub struct Pieces<'a> {
    bytes: &'a [u8],
    cutter: Cutter,
}

impl Iterator for Pieces<'_> {
    type Item = Piece;

    #[inline]
    fn next(&mut self) -> Option<Piece> {
        self.cutter.next(self.bytes, 0, true)
    }
}

impl FusedIterator for Pieces<'_> {}

/// A part of a stream that came in chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found<'a> {
    /// Bytes of the stream before it.
    pub offset: u64,
    /// Its bytes, at least one.
    pub bytes: &'a [u8],
    /// What it is.
    pub kind: PieceKind,
}

/// Splits a stream that comes in chunks.
///
/// It waits until it knows as much as is needed to be sure: for the longest frame that can stand at a place. When the line
/// falls silent, [`finish`](Self::finish) says that nothing belongs to what has come.
///
/// With all pieces taken, it holds no more than two frames of the greatest length (the second one where the first can end
/// at two places) and the noise before them, [`MAX_NOISE_LEN`] bytes at most.
#[derive(Clone, Debug)]
pub struct Splitter {
    bytes: Vec<u8>,
    cutter: Cutter,
    /// Bytes of the stream before `bytes`.
    before: u64,
    finished: bool,
}

impl Splitter {
    /// A splitter at the start of a stream.
    pub fn new(mode: Mode) -> Self {
        Self { bytes: Vec::new(), cutter: Cutter::new(mode), before: 0, finished: false }
    }

    /// Takes the next bytes of the stream in. After [`finish`](Self::finish) take all pieces first: what is left would be
    /// joined with what comes.
    pub fn push(&mut self, chunk: &[u8]) {
        let given = self.cutter.forget();
        self.before = self.before.saturating_add(given as u64);
        self.bytes.drain(..given.min(self.bytes.len()));
        if core::mem::take(&mut self.finished) {
            self.cutter.clean |= self.bytes.is_empty();
            self.cutter.checks.bare = 0..0;
        }
        self.bytes.extend_from_slice(chunk);
    }

    /// Nothing more belongs to the bytes so far: what is left of them is given out.
    pub fn finish(&mut self) {
        self.finished = true;
    }

    /// The next part, once enough of the stream is known to be sure of it.
    pub fn next_piece(&mut self) -> Option<Found<'_>> {
        let Piece { range, kind } = self.cutter.next(&self.bytes, self.before, self.finished)?;
        let offset = self.before.saturating_add(range.start as u64);
        Some(Found { offset, bytes: self.bytes.get(range)?, kind })
    }
}

/// What stands at one place.
enum Verdict {
    /// A frame of this length.
    Frame(usize, Shape),
    /// A line of this length that is no frame.
    Broken(usize),
    /// No frame begins within so many bytes.
    NoFrame(usize),
    /// More bytes are needed to tell: so many at least.
    Unknown { needed: usize },
}

/// Cuts piece after piece off. Positions count in the bytes that it is given, which are the same each time or more.
#[derive(Clone, Debug)]
struct Cutter {
    mode: Mode,
    /// Everything before has been given out.
    start: usize,
    /// From `start` to here is noise.
    at: usize,
    /// No noise stands before `start`.
    clean: bool,
    /// What stands at `at`, found before the noise was given out.
    next: Option<Piece>,
    /// Bytes from `at` on without which nothing new can be told.
    needed: usize,
    /// Characters from `at` on that hold no end of a line.
    seen: usize,
    checks: Checks,
}

impl Cutter {
    fn new(mode: Mode) -> Self {
        Self { mode, start: 0, at: 0, clean: true, next: None, needed: 0, seen: 0, checks: Checks::default() }
    }

    /// How many bytes have been given out; they are gone from now on.
    fn forget(&mut self) -> usize {
        let given = core::mem::take(&mut self.start);
        self.at = self.at.saturating_sub(given);
        if let Some(Piece { range, .. }) = &mut self.next {
            *range = range.start.saturating_sub(given)..range.end.saturating_sub(given);
        }
        given
    }

    /// The next piece of `bytes`, which have `before` bytes of the stream before them.
    #[inline]
    fn next(&mut self, bytes: &[u8], before: u64, finished: bool) -> Option<Piece> {
        if let Some(piece) = self.next.take() {
            return Some(self.give(piece));
        }
        loop {
            let rest = bytes.get(self.at..).unwrap_or_default();
            if rest.is_empty() {
                return if finished { self.noise() } else { None };
            }
            if rest.len() < self.needed && !finished {
                return None;
            }
            self.needed = 0;
            let clean = self.clean && self.at == self.start;
            let verdict = match self.mode {
                Mode::Rtu => {
                    let place = before.saturating_add(self.at as u64);
                    rtu::verdict(rtu::View { bytes: rest, place, finished, clean }, &mut self.checks)
                }
                Mode::Ascii => ascii::verdict(rest, finished, &mut self.seen),
            };
            let (len, kind) = match verdict {
                Verdict::Frame(len, shape) => (len, PieceKind::Frame(shape)),
                Verdict::Broken(len) => (len, PieceKind::Noise),
                Verdict::NoFrame(skip) => {
                    self.at += skip.min(rest.len());
                    if self.at - self.start >= MAX_NOISE_LEN {
                        return self.noise();
                    }
                    continue;
                }
                Verdict::Unknown { needed } => {
                    self.needed = needed;
                    return None;
                }
            };
            let piece = Piece { range: self.at..self.at + len.min(rest.len()), kind };
            if self.at == self.start {
                return Some(self.give(piece));
            }
            self.next = Some(piece);
            return self.noise();
        }
    }

    #[inline]
    fn give(&mut self, piece: Piece) -> Piece {
        self.start = piece.range.end;
        self.at = piece.range.end;
        self.clean = piece.kind != PieceKind::Noise;
        piece
    }

    fn noise(&mut self) -> Option<Piece> {
        (self.at > self.start).then(|| self.give(Piece { range: self.start..self.at, kind: PieceKind::Noise }))
    }
}

#[cfg(test)]
mod tests;
