//! What the window and the analyst's worker say to each other. In the worker's messages a text or a file travels beside
//! these, as the browser's own object: they are never copied into a message.

use buslens_bus::record::{Event, Origin};
use buslens_codec::diagnose::Diagnosis;
use buslens_codec::dissect::Direction;
use buslens_codec::intake::{Form, IntakeError};
use buslens_codec::line::Mode;
use buslens_sequence::{Caution, Changes, Fault};
use serde::{Deserialize, Serialize};

use crate::configure::{FromConfigure, ToConfigure};
use crate::line::{LineState, Outcome, ToLine};

/// Window to analyst.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToAnalyst {
    /// Read the text or the file that comes with this message; with neither, the one that was kept last.
    Read {
        /// Names what is said about this text: the answers carry it.
        reading: u32,
        /// How to read it; `None` finds out.
        form: Option<Form>,
        /// Keep it for the next visit.
        keep: bool,
    },
    /// Stop reading; what has been read stays.
    Cancel,
    /// Name values under this profile.
    Profile(ProfileChoice),
    /// Show only what fits.
    Filter(Filter),
    /// Send some of the list, as it is filtered.
    Rows {
        /// The first, counted from 0.
        from: u32,
        /// How many.
        count: u32,
    },
    /// Look closely at an entry.
    Look {
        /// Its number in the whole list.
        index: u32,
        /// The number that the device's own display shows, as typed; empty for none.
        shown: String,
    },
    /// Make a file of the list, as it is filtered.
    Export(Format),
    /// Forget what was kept.
    Forget,
    /// The checks of the bytes in a short text.
    Sums(String),
    /// Only of the worker that serves the Console page.
    Console(ToConsole),
}

/// Window to the console's worker: the same program as the analyst, with a live line in place of a text. Reading a text
/// there brings it in as a session in place of the log; everything else of [`ToAnalyst`] is about the log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToConsole {
    /// The channel to the engine comes beside this message; the log of the live line begins, or goes on.
    Attach,
    /// Keep so many entries; the oldest go first.
    RingSize(u32),
    /// Empty the log.
    Clear,
    /// Hold the list still, or let it go on. What happens meanwhile is kept and comes in afterwards.
    Pause(bool),
    /// Mark an entry, given by its number in the whole list, or, with `None`, take its mark away.
    Mark {
        /// Its number.
        index: u32,
        /// What is to be remembered of it; may be empty.
        comment: Option<String>,
    },
    /// Send bytes, once or again and again.
    Send(Sending),
    /// No more of what is being sent again and again.
    StopSending,
    /// Hand this on to the engine.
    Line(ToLine),
    /// Look for faults in a sequence's text. Answered by [`FromConsole::Checked`].
    Check {
        /// Names the answer.
        edition: u32,
        /// The sequence's text.
        text: String,
        /// The device's profile, as the text of its file; empty for none.
        profile: String,
    },
    /// Run a sequence, if its text has no fault. Answered by [`FromConsole::Checked`], then by [`FromConsole::Run`]
    /// until it has ended.
    Run {
        /// Names the answers.
        edition: u32,
        /// The sequence's text.
        text: String,
        /// The device's profile, as the text of its file; empty for none.
        profile: String,
        /// The unit id that the sequence means by "the device".
        unit: u8,
    },
    /// Stop the sequence.
    Stop,
    /// Play the log as if it were live, at so many thousandths of its own speed; 0 as fast as it goes.
    Replay {
        /// 1000 for its own speed.
        speed_permille: u32,
        /// The device's profile, as the text of its file; empty for none.
        profile: String,
    },
    /// Stop the replay: what has been played stays.
    StopReplay,
    /// Back to the live line's log, which went on meanwhile.
    Live,
    /// About reading, writing and finding devices. While that is under way, neither sequences nor hands send anything.
    Configure(ToConfigure),
}

/// What is to be sent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sending {
    /// Names what is said about it.
    pub id: u32,
    /// The bytes as they go out.
    pub bytes: Vec<u8>,
    /// How long to wait for an answer, in milliseconds; `None` leaves it to the master.
    pub wait_ms: Option<u32>,
    /// How often; `None` for once.
    pub repeat: Option<Repeat>,
}

/// How often something is sent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Repeat {
    /// Time between two beginnings, in milliseconds; the end of an exchange is waited for.
    pub every_ms: u32,
    /// So many times; `None` until stopped.
    pub times: Option<u32>,
    /// Stop when this happens.
    pub until: Until,
}

/// What ends a repetition.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Until {
    /// Nothing but the count.
    #[default]
    Never,
    /// Any reply that is no exception.
    Answered,
    /// Anything but a reply: silence, damage, an exception.
    Failed,
    /// A reply other than the first one.
    Changed,
    /// Bytes heard that fit a pattern as a sequence's `expect` has it.
    Heard(String),
}

/// Whose registers they are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProfileChoice {
    /// The profile that explains most frames: a built-in one, or one of these, as the texts of their files.
    Auto(Vec<String>),
    /// None: bare registers.
    None,
    /// A profile, as the text of its file.
    File(String),
}

/// Nobody has made profiles of their own, or said which device speaks.
impl Default for ProfileChoice {
    fn default() -> Self {
        Self::Auto(Vec::new())
    }
}

/// What of the list is shown. The default shows everything.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Filter {
    /// Only this unit id.
    pub unit: Option<u8>,
    /// Only this function code, its exceptions included.
    pub function: Option<u8>,
    /// Only this direction.
    #[serde(default)]
    pub direction: Option<Direction>,
    /// Only what is wrong: damaged frames, noise, exceptions, requests without answer, answers without request.
    pub errors_only: bool,
    /// Only what holds this: bytes in hexadecimal, the name of a point, or the id of a diagnosis. Empty for all.
    pub text: String,
}

/// A form of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Format {
    /// One JSON object a line.
    JsonLines,
    /// A table with a head, separated by commas.
    Csv,
    /// Bytes in hexadecimal, a frame a line, with marks of direction.
    Hex,
    /// A line an entry: time, direction, bytes, meaning.
    Text,
    /// A capture file of Modbus RTU frames with their times.
    Pcap,
    /// A session that can be brought in and played again without loss: times, origins, marks and comments.
    Session,
}

/// Analyst to window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromAnalyst {
    /// How far reading has come. The last one of a reading says so.
    Progress(Progress),
    /// Some of the list.
    Rows(Rows),
    /// What the whole list holds, once it has been read.
    Statistics(Statistics),
    /// An entry, looked at closely.
    Look(Look),
    /// The file that comes with this message is ready.
    Exported(Format),
    /// The checks of the bytes in a text that was asked for, `None` where it holds no bytes; or its first fault.
    Sums(String, Result<Option<Sums>, IntakeError>),
    /// There was no kept text, or it cannot be read.
    NothingKept,
    /// The text could not be read to its end, in the browser's words.
    Unreadable(String),
    /// Only of the worker that serves the Console page.
    Console(FromConsole),
    /// The analyst has failed for good.
    Panicked(String),
}

/// The console's worker to the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromConsole {
    /// The line as it is now.
    Line(LineState),
    /// Something was sent, or could not be.
    Sent {
        /// The [`Sending`]'s number.
        id: u32,
        /// How often so far.
        times: u32,
        /// Whether it goes on.
        more: bool,
        /// How the last one ended.
        outcome: Outcome,
    },
    /// How a replay stands.
    Replay(Replay),
    /// A sequence's text was looked at.
    Checked {
        /// As it was asked.
        edition: u32,
        /// All that is wrong; empty for a text that can run.
        faults: Vec<Fault>,
        /// Steps that can lose the device, or change how it is reached or what it measures.
        cautions: Vec<Caution>,
    },
    /// What has changed in a running sequence's report, at most at display rate.
    Run {
        /// As it was asked.
        edition: u32,
        /// To be put into the report with `Report::apply`.
        changes: Changes,
    },
    /// A sequence was not run: a device on the line is being configured.
    NotRun {
        /// As it was asked.
        edition: u32,
    },
    /// About reading, writing and finding devices.
    Configure(FromConfigure),
}

/// How a replay stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Replay {
    /// Whether it is on.
    pub playing: bool,
    /// Time of the recording that has been played, in microseconds.
    pub at_us: u64,
    /// Of how much.
    pub total_us: u64,
}

/// Bytes with their checks.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sums {
    /// How many bytes; of ASCII frames those that the digits spell.
    pub count: u32,
    /// CRC-16 of all of them; its low byte goes over the line first.
    pub crc: u16,
    /// LRC of all of them.
    pub lrc: u8,
    /// Whether the last two are the CRC of those before them.
    pub ends_with_crc: bool,
    /// Whether the last one is the LRC of those before it.
    pub ends_with_lrc: bool,
}

/// How far reading has come.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Which reading.
    pub reading: u32,
    /// Characters read, bytes of a file.
    pub done: u64,
    /// Of how many.
    pub total: u64,
    /// Nothing more comes.
    pub finished: bool,
    /// It was stopped before its end.
    pub cancelled: bool,
    /// Number of the first entry that is kept; 0 unless a ring has forgotten some.
    pub first: u32,
    /// Frames and stretches of noise that are kept.
    pub entries: u32,
    /// Of those, how many the filter lets through.
    pub shown: u32,
    /// Changes whenever rows that were sent before are no longer what they were.
    pub edition: u32,
    /// How the text is read.
    pub form: Option<Form>,
    /// Another sensible way.
    pub alternative: Option<Form>,
    /// The first places that could not be read.
    pub faults: Vec<IntakeError>,
    /// How many there are.
    pub fault_count: u64,
    /// Id of the profile in force.
    pub profile: Option<String>,
    /// Entries that have come since the list is held still.
    pub held: u32,
    /// What has happened to the port since the last entry, in order.
    pub after: Vec<Event>,
    /// Time of the first entry that is kept, in microseconds on the source's clock.
    pub start_us: Option<u64>,
    /// Unix time of that clock's origin in microseconds, where it is known.
    pub epoch_us: Option<u64>,
}

/// Some rows of the list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rows {
    /// As in [`Progress::edition`].
    pub edition: u32,
    /// Place of the first among the shown.
    pub from: u32,
    /// The rows.
    pub rows: Vec<Row>,
}

/// A frame or a stretch of noise, with all that is needed to put it into words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Its number in the whole list, from 0.
    pub index: u32,
    /// Place in the stream of bytes.
    pub offset: u64,
    /// Line of the text, from 1; 0 for none.
    pub line: u32,
    /// Microseconds on the source's clock.
    pub time_us: Option<u64>,
    /// Frame or noise.
    pub is_frame: bool,
    /// RTU or ASCII.
    pub mode: Mode,
    /// Which way it goes.
    pub direction: Direction,
    /// Number of the other half of the exchange.
    pub pair: Option<u32>,
    /// The bytes; of long noise the first.
    pub bytes: Vec<u8>,
    /// How many bytes there are.
    pub length: u32,
    /// The request's PDU, if this answers one.
    pub request: Vec<u8>,
    /// Registers seen before that tell scales and units of this unit's values: function, address, value.
    pub told: Vec<(u8, u16, u16)>,
    /// What is wrong or remarkable.
    pub diagnoses: Vec<Diagnosis>,
    /// A request that nothing answers.
    pub unanswered: bool,
    /// An answer that nothing asked for.
    pub orphan: bool,
    /// Who had it sent; of a reply, who had its request sent.
    pub origin: Origin,
    /// Time since the end of the entry before it, as far as that end is known, else since its beginning; in microseconds.
    pub gap_us: Option<u64>,
    /// Of a reply, the time from the beginning of its request to its own end, in microseconds.
    pub round_trip_us: Option<u64>,
    /// What happened to the port before it, in order.
    pub before: Vec<Event>,
    /// The user's mark, with what is to be remembered.
    pub mark: Option<String>,
}

/// An entry, looked at closely.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Look {
    /// Its number in the whole list.
    pub index: u32,
    /// The entry as an exported object.
    pub json: String,
    /// Everything that its registers could mean, a register each.
    pub views: Vec<RegisterViews>,
    /// Whether what was typed is a number.
    pub understood: bool,
    /// What would show that number, the simplest first.
    pub fits: Vec<Fit>,
}

/// Everything that could begin at a register.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegisterViews {
    /// Its place among the frame's registers, from 0.
    pub offset: u32,
    /// The views.
    pub views: Vec<View>,
}

/// One way to read registers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// As a profile names it, with the order of its bytes.
    pub name: String,
    /// How many registers it takes.
    pub registers: u8,
    /// What they are then.
    pub text: String,
}

/// A way to read registers that gives the number that was looked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// Its first register's place among the frame's registers, from 0.
    pub offset: u32,
    /// As a profile names it, with the order of its bytes.
    pub name: String,
    /// Digits behind the point; below zero for tens.
    pub decimals: i8,
}

/// What a list holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Which reading.
    pub reading: u32,
    /// Everything together.
    pub total: Tally,
    /// The same for each unit id that was seen.
    pub units: Vec<(u8, Tally)>,
    /// How many frames of each function code.
    pub functions: Vec<(u8, u32)>,
    /// How often each diagnosis was made, by its id.
    pub diagnoses: Vec<(String, u32)>,
}

/// Counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    /// Frames with a right check.
    pub frames: u32,
    /// Of those, requests.
    pub requests: u32,
    /// Of those, responses, exceptions among them.
    pub responses: u32,
    /// Exceptions.
    pub exceptions: u32,
    /// Frames with a wrong check.
    pub damaged: u32,
    /// Requests that nothing answers.
    pub unanswered: u32,
    /// Responses that nothing asked for.
    pub orphans: u32,
    /// Stretches of noise.
    pub stretches: u32,
    /// Bytes in them.
    pub noise_bytes: u64,
}
