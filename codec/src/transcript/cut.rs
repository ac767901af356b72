//! Pieces of a run: bytes of the same mode that went the same way.

use core::ops::Range;

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
}

/// A frame with a right check, or bytes without one.
pub(super) struct Cut {
    /// Its place in the whole stream.
    pub(super) range: Range<usize>,
    pub(super) is_frame: bool,
}

impl Run {
    /// A run that begins `start` bytes into the stream.
    pub(super) fn new(mode: Mode, mark: Direction, start: usize) -> Self {
        Self { mode, mark, start, splitter: Splitter::new(mode) }
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
    }

    pub(super) fn next_piece(&mut self) -> Option<Cut> {
        let Found { offset, bytes, kind } = self.splitter.next_piece()?;
        let start = self.start.saturating_add(usize::try_from(offset).ok()?);
        Some(Cut { range: start..start.saturating_add(bytes.len()), is_frame: matches!(kind, PieceKind::Frame(_)) })
    }
}
