//! What goes over a line, noted as it happens: every byte in and out, with its time and who caused it.
//!
//! Notes are what the console shows, what a session file keeps and what a replay plays.

pub use buslens_codec::segment::{Event, Origin};
use serde::{Deserialize, Serialize};

/// Something that happened on the line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// When, in microseconds on the engine's clock. Bytes that were received are noted when they arrived.
    pub at_us: u64,
    /// What.
    pub what: What,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum What {
    /// Bytes were handed to the port.
    Sent {
        /// Who had them sent.
        origin: Origin,
        /// The bytes as they went out.
        bytes: Vec<u8>,
    },
    /// Bytes arrived. Where one chunk ends and the next begins means nothing.
    Received(Vec<u8>),
    /// Something happened to the port.
    Port(Event),
}

/// How sending has ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcome {
    /// When the bytes were handed to the port, in microseconds on the engine's clock; of bytes that were not sent, when
    /// that was decided.
    pub at_us: u64,
    /// What was heard until the end: the reply's frame alone where one was recognised.
    pub heard: Vec<u8>,
    /// From the first byte sent to the last byte heard, in microseconds.
    pub round_trip_us: Option<u32>,
    /// How it ended.
    pub end: End,
}

/// How sending has ended, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum End {
    /// The reply came. An exception is a reply.
    Answered,
    /// A broadcast, which nobody answers, is out.
    Broadcast,
    /// Bytes that are no request of this mode are out, and something was heard.
    Heard,
    /// Nothing was heard.
    Silence,
    /// Something was heard that is no reply, or whose check is wrong.
    Damaged,
    /// A reply came that may belong to an earlier request.
    Doubtful,
    /// Not sent: it would have written, and only reads are let out.
    ReadOnly,
    /// Not sent, or not ended: the port is closed or gone.
    NoPort,
    /// Not sent: it was withdrawn.
    Withdrawn,
    /// Not sent: a device on the line is being configured.
    Busy,
}

impl End {
    /// A name that does not change, for files and tests.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Answered => "answered",
            Self::Broadcast => "broadcast",
            Self::Heard => "heard",
            Self::Silence => "silence",
            Self::Damaged => "damaged",
            Self::Doubtful => "doubtful",
            Self::ReadOnly => "read-only",
            Self::NoPort => "no-port",
            Self::Withdrawn => "withdrawn",
            Self::Busy => "busy",
        }
    }
}
