//! Pieces of a run: bytes of the same mode that went the same way.

use core::ops::Range;

use crate::diagnose::{Surroundings, repair, rtu, shape};
use crate::dissect::Direction;
use crate::line::Mode;
use crate::stream::{Found, MAX_NOISE_LEN, PieceKind, Splitter};

/// A stretch of the stream that no frame crosses.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) mode: Mode,
    pub(super) mark: Direction,
    start: u64,
    splitter: Splitter,
    finished: bool,
    /// Noise that may go on.
    noise: Option<Range<u64>>,
    /// A frame that waits until the noise before it is given out.
    held: Option<Frame>,
}

/// A frame with a right check, or bytes without one.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    /// Its place in the whole stream.
    pub(super) range: Range<u64>,
    pub(super) is_frame: bool,
}

#[derive(Clone, Debug)]
struct Frame {
    range: Range<u64>,
    has_stray_zero: bool,
}

impl Run {
    /// A run that begins `start` bytes into the stream.
    pub(super) fn new(mode: Mode, mark: Direction, start: u64) -> Self {
        Self { mode, mark, start, splitter: Splitter::new(mode), finished: false, noise: None, held: None }
    }

    /// Whether a segment of this kind belongs to it.
    pub(super) fn continues(&self, mode: Mode, mark: Direction) -> bool {
        self.mode == mode && self.mark == mark
    }

    pub(super) fn push(&mut self, bytes: &[u8]) {
        self.splitter.push(bytes);
    }

    pub(super) fn finish(&mut self) {
        self.splitter.finish();
        self.finished = true;
    }

    /// The next part, once it is sure; the parts follow each other without gaps.
    pub(super) fn next_piece(&mut self) -> Option<Cut> {
        if let Some(frame) = self.held.take() {
            return Some(self.give(frame));
        }
        loop {
            let Some(Found { offset, bytes, kind }) = self.splitter.next_piece() else {
                let range = self.noise.take_if(|_| self.finished)?;
                return Some(Cut { range, is_frame: false });
            };
            let start = self.start.saturating_add(offset);
            let range = start..start.saturating_add(bytes.len() as u64);
            let is_rtu = self.mode == Mode::Rtu;
            let by_chance = self.noise.is_some() && is_rtu && is_by_chance(bytes);
            if matches!(kind, PieceKind::Frame(_)) && !by_chance {
                let frame = Frame { range, has_stray_zero: is_rtu && has_stray_zero(bytes) };
                let Some(noise) = self.noise.take() else { return Some(self.give(frame)) };
                self.held = Some(frame);
                return Some(Cut { range: noise, is_frame: false });
            }
            let start = self.noise.take().map_or(range.start, |noise| noise.start);
            let noise = start..range.end;
            if noise.end.saturating_sub(noise.start) >= MAX_NOISE_LEN as u64 {
                return Some(Cut { range: noise, is_frame: false });
            }
            self.noise = Some(noise);
        }
    }

    fn give(&mut self, frame: Frame) -> Cut {
        let Frame { mut range, has_stray_zero } = frame;
        if has_stray_zero {
            range.end -= 1;
            self.noise = Some(range.end..range.end + 1);
        }
        Cut { range, is_frame: true }
    }
}

/// Whether a frame with a right check is a shorter frame with a zero behind it: the check stays right then. Only where the
/// longer one is no frame of its function, and the shorter one is.
fn has_stray_zero(frame: &[u8]) -> bool {
    let [shorter @ .., 0] = frame else { return false };
    let fits = |frame: &[u8]| rtu::is_whole(frame, Surroundings::UNKNOWN);
    !fits(frame) && fits(shorter) && repair::is_right(shorter)
}

/// Whether bytes within noise have a right check by chance: with these fields there is no such request or response.
fn is_by_chance(frame: &[u8]) -> bool {
    match frame {
        [_, function @ 0x80..=0xFF, ..] => !shape::is_known(*function),
        frame => !rtu::is_whole(frame, Surroundings::UNKNOWN),
    }
}
