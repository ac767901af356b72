//! What a text or a recording tells of its bytes beyond the bytes themselves.

use crate::dissect::Direction;
use crate::line::Mode;

/// A run of bytes of a stream that came from one place: a line of a log, a chunk of a recording. It ends where the next
/// one begins, or with the stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Bytes of the stream before it.
    pub start: usize,
    /// How its bytes are framed. In ASCII mode they are the characters, CR LF included.
    pub mode: Mode,
    /// Which way they went, as the source says; [`Direction::Unknown`] where it says nothing.
    pub direction: Direction,
    /// When, in microseconds on the source's own clock, where it says so.
    pub time_us: Option<u64>,
    /// The line of the text that it begins on, counted from 1; 0 where there is no text.
    pub line: u32,
}
