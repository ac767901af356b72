//! Pieces of a run: bytes of the same mode that went the same way.

use core::ops::Range;

use crate::diagnose::{Surroundings, repair, rtu};
use crate::dissect::Direction;
use crate::line::Mode;
use crate::stream::{Found, PieceKind, Splitter};

/// A stretch of the stream that no frame crosses.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) mode: Mode,
    pub(super) mark: Direction,
    start: usize,
    splitter: Splitter,
    finished: bool,
    /// A zero behind the last frame, which belongs to what follows.
    stray: Option<usize>,
    /// A frame that waits until the zero before it is given out.
    held: Option<Cut>,
}

/// A frame with a right check, or bytes without one.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    /// Its place in the whole stream.
    pub(super) range: Range<usize>,
    pub(super) is_frame: bool,
    has_stray_zero: bool,
}

impl Cut {
    fn stray(place: usize) -> Self {
        Self { range: place..place + 1, is_frame: false, has_stray_zero: false }
    }
}

impl Run {
    /// A run that begins `start` bytes into the stream.
    pub(super) fn new(mode: Mode, mark: Direction, start: usize) -> Self {
        Self { mode, mark, start, splitter: Splitter::new(mode), finished: false, stray: None, held: None }
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
        if let Some(held) = self.held.take() {
            return Some(held);
        }
        let Some(mut cut) = self.next_cut() else {
            let stray = self.stray.take_if(|_| self.finished)?;
            return Some(Cut::stray(stray));
        };
        match self.stray.take() {
            Some(stray) if cut.is_frame => {
                self.held = Some(cut);
                cut = Cut::stray(stray);
            }
            Some(stray) => cut.range.start = stray,
            None => {}
        }
        let frame = self.held.as_mut().unwrap_or(&mut cut);
        if frame.is_frame && frame.has_stray_zero {
            frame.range.end -= 1;
            self.stray = Some(frame.range.end);
        }
        Some(cut)
    }

    fn next_cut(&mut self) -> Option<Cut> {
        let Found { offset, bytes, kind } = self.splitter.next_piece()?;
        let start = self.start.saturating_add(usize::try_from(offset).ok()?);
        let is_frame = matches!(kind, PieceKind::Frame(_));
        let has_stray_zero = is_frame && self.mode == Mode::Rtu && has_stray_zero(bytes);
        Some(Cut { range: start..start.saturating_add(bytes.len()), is_frame, has_stray_zero })
    }
}

/// Whether a frame with a right check is a shorter frame with a zero behind it: the check stays right then. Only where the
/// longer one is no frame of its function, and the shorter one is.
fn has_stray_zero(frame: &[u8]) -> bool {
    let [shorter @ .., 0] = frame else { return false };
    let fits = |frame: &[u8]| rtu::is_whole(frame, Surroundings::UNKNOWN);
    !fits(frame) && fits(shorter) && repair::is_right(shorter)
}
