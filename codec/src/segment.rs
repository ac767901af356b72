//! What a text or a recording tells of its bytes beyond the bytes themselves.

use serde::{Deserialize, Serialize};

use crate::dissect::Direction;
use crate::line::{LineSettings, Mode};

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
    /// When its first byte went, in microseconds on the source's own clock, where it says so.
    pub time_us: Option<u64>,
    /// From its first byte to the end of its last one, in microseconds; 0 where nobody knows.
    pub span_us: u32,
    /// The line of the text that it begins on, counted from 1. 0 where there is no text: then its borders mean nothing.
    pub line: u32,
    /// Who had it sent.
    pub origin: Origin,
    /// It is one frame or one stretch of noise, as somebody found out before.
    pub whole: bool,
}

impl Default for Segment {
    /// From the stream's start, RTU, and nothing else is known.
    fn default() -> Self {
        Self {
            start: 0,
            mode: Mode::Rtu,
            direction: Direction::Unknown,
            time_us: None,
            span_us: 0,
            line: 0,
            origin: Origin::Unknown,
            whole: false,
        }
    }
}

/// Who had bytes sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Origin {
    /// Nobody on this side, or nobody knows: a log that was brought in, another master on the line.
    #[default]
    Unknown,
    /// The periodic reading of the Live page.
    Poll,
    /// A hand at the console.
    Console,
    /// A sequence.
    Sequence,
    /// A change of a device's settings.
    Configuration,
}

impl Origin {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Unknown, Self::Poll, Self::Console, Self::Sequence, Self::Configuration];

    /// A name that does not change: `-`, `poll`, `console`, `sequence`, `configuration`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unknown => "-",
            Self::Poll => "poll",
            Self::Console => "console",
            Self::Sequence => "sequence",
            Self::Configuration => "configuration",
        }
    }
}

/// What happens to a port while bytes go over it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Event {
    /// The port has seen a character that breaks its settings.
    LineError,
    /// A break was sent, for so many milliseconds.
    Break(u32),
    /// The port is open with these settings.
    Opened(LineSettings, Mode),
    /// The port was closed as asked.
    Closed,
    /// The adapter is gone.
    Lost,
    /// So many bytes had to be forgotten before anybody noted them down.
    Forgotten(u64),
}
