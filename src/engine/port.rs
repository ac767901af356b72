//! What the engine knows of a port, be it a real one or the simulated line.

use buslens_codec::line::LineSettings;

use crate::message::OpenFault;

/// A port takes orders at once and answers by [`PortEvent`]s, in the order in which things happen.
pub(crate) trait Port {
    /// Opens the port, closing it first if it is open; the browser shall buffer so many bytes. Answered by `Opened` or
    /// `OpenFailed`.
    fn open(&self, settings: LineSettings, buffer_bytes: u32);

    /// Hands bytes to the line. Without an open port they are dropped.
    fn write(&self, bytes: &[u8]);

    /// Closes the port and waits for nothing that a dead adapter could withhold. Answered by `Closed`.
    fn close(&self);

    /// Does something to the wires beside the data, as far as the port has them.
    fn signal(&self, signal: Signal);
}

/// What can be done to the wires beside the data.
pub(crate) enum Signal {
    /// Set the outputs data terminal ready and request to send; `None` leaves one as it is.
    Set(Option<bool>, Option<bool>),
    /// Hold the line in the break state for so many milliseconds. What is written next leaves after it.
    Break(u32),
    /// Cut the supply of what is on the line for a moment.
    PowerCycle,
    /// Look at the inputs. Answered by `Inputs`, where the port can.
    Look,
}

/// What a port reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum PortEvent {
    /// Open with the settings last asked for.
    Opened,
    /// Not open, and why.
    OpenFailed(OpenFault),
    /// Bytes from the line, in order; the borders of the chunks mean nothing.
    Bytes(Vec<u8>),
    /// The port has seen a character that breaks its settings; it stays open.
    LineError,
    /// The adapter is gone.
    Lost,
    /// Closed as asked.
    Closed,
    /// The inputs clear to send, data set ready, data carrier detected and ring indicator.
    Inputs([bool; 4]),
}
