//! What the programs say to each other: the window and the engine's worker, the window's two programs, and the engine and
//! the simulator. Nothing else crosses between them.
//!
//! The window owns no protocol state: it sends wishes and draws the last [`Status`]. The engine sends a status at most at
//! display rate, however fast the line is.

use buslens_bus::Counters;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::pdu::ExceptionCode;
use buslens_codec::value::Value;
use serde::{Deserialize, Serialize};

use crate::route::Page;
use crate::text::Language;

/// Window to engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum ToEngine {
    /// Open the port and start to read.
    Connect(Connection),
    /// Stop reading and close the port.
    Disconnect,
    /// The user has granted a port: look again.
    PortsChanged,
    /// The console's worker is there. Beside it: the channel to it.
    Attach,
}

/// Engine to window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum ToWindow {
    /// The granted ports that are plugged in, in the browser's order. Sent at start and whenever they change.
    Ports(Vec<PortId>),
    /// The state of everything. Sent when something in it has changed.
    Status(Status),
    /// The connection as it is now, which the console may have changed. Sent when something in it has changed.
    Line(Line),
    /// The engine has failed for good; its worker must be ended, which closes the port.
    Panicked(String),
}

/// The window's first program to its second one, the workbench. An element or a function comes beside some of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum ToWorkbench {
    /// Begin, with all texts in this language. Beside it: the function that a fault's details are told to, and the
    /// engine's worker.
    Start(Language),
    /// The language is another one.
    Language(Language),
    /// Show this page, or none. Beside it: the element that it is to stand in.
    Page(Option<Page>),
    /// The device that is connected, or none: its profile's id and its unit id.
    Device(Option<(String, u8)>),
    /// Show an exchange, or none. Beside it: the element that it is to stand in.
    Exchange(Option<Exchange>),
}

/// The engine to the simulator, with the time. Answered by [`FromSimulator`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum ToSimulator {
    /// The port has been opened, or opened anew. What came while it was closed is lost.
    Open {
        /// The profile of the sensor on the line, packed.
        profile: Vec<u8>,
        /// Settings of the port.
        line: LineSettings,
    },
    /// The port sends these bytes.
    Write(Vec<u8>),
    /// The sensor's supply is cut for a moment.
    PowerCycle,
    /// Time has passed.
    Time,
}

/// What has come of a message to the simulator.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct FromSimulator {
    /// Bytes that have come to the port.
    pub arrived: Vec<u8>,
    /// When something happens next by itself, in microseconds on the engine's clock.
    pub due_us: Option<u64>,
}

/// An exchange with what is needed to explain it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Exchange {
    /// Id of the device's profile.
    pub device: String,
    /// RTU or ASCII.
    pub mode: Mode,
    /// The bytes.
    pub frames: Frames,
}

/// A granted serial port, as far as a page may know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) struct PortId {
    /// Its place among the granted ports, the same in window and worker.
    pub index: u32,
    /// USB vendor and product id, if it is a USB port.
    pub usb: Option<(u16, u16)>,
}

/// Everything needed to connect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Connection {
    /// Where the bytes go.
    pub source: Source,
    /// Settings of the port.
    pub line: LineSettings,
    /// RTU or ASCII.
    pub mode: Mode,
    /// The device's address, 0 to 255.
    pub unit: UnitId,
    /// Wanted time between two readings, in milliseconds; 0 only listens.
    pub period_ms: u32,
    /// The device's profile, packed.
    pub profile: Vec<u8>,
}

/// A connection as it is now.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Line {
    /// What is connected, with the settings in force.
    pub connection: Connection,
    /// Whether the device is polled.
    pub polling: bool,
    /// Whether only reads are let out.
    pub read_only: bool,
}

/// Where the bytes go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Source {
    /// The built-in line with a simulated sensor.
    Simulator,
    /// A serial port of this machine.
    Serial(PortId),
    /// Nowhere: a recording is played.
    Replay,
}

/// The state of everything that the engine knows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Status {
    /// The port.
    pub link: Link,
    /// The device behind it.
    pub health: Health,
    /// The last value of each point that has been read, in the profile's order.
    pub readings: Vec<Reading>,
    /// Values that have come since the previous status, oldest first: for plots and statistics.
    pub samples: Vec<Sample>,
    /// Counts since the connection was made.
    pub counters: Counters,
    /// From the first byte of the last request to the last byte of its reply, in microseconds.
    pub round_trip_us: Option<u32>,
    /// Readings per second that really come, over the last seconds.
    pub rate_hz: Option<f32>,
    /// The last exchange as it went over the line: the whole request and whatever came back.
    pub exchange: Option<Frames>,
}

/// State of the port.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Link {
    /// Not connected.
    #[default]
    Closed,
    /// Being opened.
    Opening,
    /// Open.
    Open,
    /// It vanished while open. The engine opens it again by itself as soon as it is back.
    Lost,
    /// Being closed.
    Closing,
    /// It could not be opened.
    Failed(OpenFault),
}

/// Why a port could not be opened.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum OpenFault {
    /// In use by another program or page, or its driver refuses.
    Busy,
    /// Not plugged in any more.
    Missing,
    /// The browser or its policy forbids it.
    Forbidden,
    /// The driver does not know these settings.
    UnsupportedSettings,
    /// The simulator's program could not be loaded: it is asked for when it is first needed.
    NotLoaded,
    /// Anything else, in the browser's own words.
    Other(String),
}

/// State of the device on an open port.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Health {
    /// No answer yet, and none overdue.
    #[default]
    Waiting,
    /// Answers come.
    Reading,
    /// Answers fail to come. The readings shown are old.
    Failing(Trouble),
}

/// What is wrong with the answers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Trouble {
    /// Nothing comes back at all.
    Silence,
    /// Bytes come back, but they make no frame: most often a wrong baud rate or parity.
    Garbage,
    /// Replies come back with a wrong check.
    BadCheck,
    /// The device answers with an exception.
    Exception {
        /// The function code that it refuses.
        function: u8,
        /// Its reason.
        code: ExceptionCode,
    },
    /// Replies come too late to be sure which request they answer.
    Late,
    /// A reply came whose value the device's format does not allow.
    BadValue,
}

/// The last value of a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reading {
    /// The point's id in the profile.
    pub point: String,
    /// Its value.
    pub value: Value,
}

/// One numeric value in time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    /// The point's id in the profile.
    pub point: String,
    /// Seconds since the engine started.
    pub at_s: f64,
    /// The value in the point's unit.
    pub value: f64,
}

/// The bytes of one exchange.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Frames {
    /// The request as sent.
    pub sent: Vec<u8>,
    /// What came back, be it a reply or not.
    pub received: Vec<u8>,
}
