//! What the console's worker and the engine say to each other, over a channel of their own. Neither waits for the window.

pub use buslens_bus::record::{End, Outcome};
use buslens_bus::record::{Note, Origin};
use buslens_codec::line::{LineSettings, Mode};
use serde::{Deserialize, Serialize};

/// Console to engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToLine {
    /// Tell the clock: only who keeps it knows that nothing has happened. Answered by [`FromLine::Clock`].
    Clock,
    /// Send bytes as they are, in a quiet slot between other transactions. Answered by [`FromLine::Done`].
    ///
    /// Bytes that are one whole request with a right check in the line's mode are a transaction like any other; other
    /// bytes hold the line until something was heard and it is quiet again, or until `wait_ms` have passed.
    Send {
        /// Names the answer.
        id: u32,
        /// Who wants it.
        origin: Origin,
        /// The bytes.
        bytes: Vec<u8>,
        /// How long to wait for an answer, in milliseconds from the last bit sent; `None` leaves it to the master.
        wait_ms: Option<u32>,
    },
    /// Take back what has not been sent yet of this number.
    Withdraw(u32),
    /// Other settings of the port, with so many bytes of the browser's buffer. The port is closed and opened again.
    Settings {
        /// Settings of the port.
        line: LineSettings,
        /// RTU or ASCII.
        mode: Mode,
        /// Bytes that the browser buffers between two reads.
        buffer_bytes: u32,
    },
    /// Poll the device, or leave the line to others.
    Poll(bool),
    /// Whom the polling asks from now on: this unit id.
    Unit(u8),
    /// Let only reads out of the port, or everything.
    ReadOnly(bool),
    /// Set outputs of the port; `None` leaves one as it is.
    Signals {
        /// Data terminal ready.
        dtr: Option<bool>,
        /// Request to send.
        rts: Option<bool>,
    },
    /// Hold the line in the break state for so many milliseconds.
    Break(u32),
    /// Begin a replay under this profile: whatever port is open is closed.
    Replay {
        /// The device's profile, packed; empty for none.
        profile: Vec<u8>,
        /// Settings that the recording was made with.
        line: LineSettings,
        /// RTU or ASCII.
        mode: Mode,
    },
    /// Let this happen now, as if it came from a port. Only in a replay; times are the recording's own.
    Play(Vec<Note>),
    /// The replay has ended.
    ReplayEnded,
}

/// Engine to console.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromLine {
    /// The engine's clock as it is now, in microseconds, after everything that happened before. The first message of all.
    Clock(u64),
    /// What has happened since the last notes, at most at display rate.
    Notes(Vec<Note>),
    /// A [`ToLine::Send`] has ended.
    Done {
        /// Its number.
        id: u32,
        /// How.
        outcome: Outcome,
    },
    /// The line as it is now. Sent at the beginning and whenever something in it has changed.
    State(LineState),
}

/// The line as it is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[allow(clippy::struct_excessive_bools)] // switches and lamps, each on its own
pub struct LineState {
    /// Whether bytes can be sent now.
    pub open: bool,
    /// The port.
    pub port: PortState,
    /// A replay is on: nothing can be sent.
    pub replay: bool,
    /// Whether the bytes go to the simulator.
    pub simulated: bool,
    /// Settings of the port.
    pub line: LineSettings,
    /// RTU or ASCII.
    pub mode: Mode,
    /// Bytes that the browser buffers between two reads.
    pub buffer_bytes: u32,
    /// Whether the device is polled.
    pub polling: bool,
    /// Whether only reads are let out.
    pub read_only: bool,
    /// Outputs and inputs of the port, as far as it has them.
    pub signals: Signals,
}

/// How a port is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PortState {
    /// Open, with the settings that are told.
    Open,
    /// Being opened with them.
    Changing,
    /// It could not be opened with them. Others may do: [`ToLine::Settings`] tries.
    Refused,
    /// There is none: closed by its user, unplugged, or a recording is played.
    Gone,
}

/// Outputs and inputs of a port; `None` where the port does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Signals {
    /// Data terminal ready, as last set.
    pub dtr: Option<bool>,
    /// Request to send, as last set.
    pub rts: Option<bool>,
    /// Clear to send.
    pub cts: Option<bool>,
    /// Data set ready.
    pub dsr: Option<bool>,
    /// Data carrier detected.
    pub dcd: Option<bool>,
    /// Ring indicator.
    pub ri: Option<bool>,
}
