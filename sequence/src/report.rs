//! What a run has done, step by step.

use buslens_bus::record::End;
use serde::{Deserialize, Serialize};

/// Entries that a report keeps of what went well. Failures are kept up to twice as many.
pub const MAX_ENTRIES: usize = 5_000;

/// What a run has done.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// All of it in short.
    pub summary: Summary,
    /// The steps in the order in which they began, steps that were never reached at the end.
    pub entries: Vec<Entry>,
}

/// A run in short.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Summary {
    /// The sequence's title, empty for none.
    pub title: String,
    /// Id of the profile in force, empty for none.
    pub profile: String,
    /// The unit id that the sequence means by "the device".
    pub unit: u8,
    /// When it began, in microseconds on the clock of who runs it.
    pub began_us: u64,
    /// When it ended, or until when this is known.
    pub until_us: u64,
    /// How it stands.
    pub verdict: Verdict,
    /// Why it has ended; `None` while it runs.
    pub ended: Option<Ended>,
    /// Requests and expectations that passed.
    pub passed: u32,
    /// Steps that failed.
    pub failed: u32,
    /// Entries that were left out for want of room.
    pub left_out: u32,
}

/// How a run stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// It goes on.
    #[default]
    Running,
    /// It came to its end and nothing failed.
    Passed,
    /// Something failed.
    Failed,
    /// It was stopped before its end; nothing had failed until then.
    Incomplete,
}

/// Why a run has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ended {
    /// It came to the end of its text.
    Finished,
    /// Its own `stop`.
    StopStep,
    /// A step failed after `on failure stop`, or a `fail`.
    Failure,
    /// It was stopped from outside.
    Stopped,
    /// The port was closed or is gone.
    PortLost,
}

/// One step that was run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Line of the text, from 1.
    pub line: u32,
    /// Which time this step runs, from 1.
    pub time: u32,
    /// When it began, in microseconds on the clock of who runs it.
    pub at_us: u64,
    /// How long it took, in microseconds.
    pub took_us: u64,
    /// How it went.
    pub mark: Mark,
    /// What went over the line.
    pub exchanges: Vec<Exchange>,
    /// What was compared.
    pub compared: Option<Compared>,
    /// Why it failed.
    pub reason: Option<Reason>,
    /// What a `log` or a `fail` says, or the value that a `let` has kept.
    pub text: String,
    /// Of an `if`, whether its condition holds; of a `repeat`, how many rounds it made.
    pub outcome: Option<Branch>,
}

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mark {
    /// It is not over yet.
    Running,
    /// It did what it should.
    Passed,
    /// It did not.
    Failed,
    /// It was never reached.
    Skipped,
}

/// Where the sequence went on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Branch {
    /// The condition of an `if` holds.
    Then,
    /// It does not.
    Else,
    /// A `repeat` has made so many rounds.
    Rounds(u32),
}

/// Something sent, and what came of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Exchange {
    /// The bytes as they went out.
    pub sent: Vec<u8>,
    /// The bytes that were heard.
    pub heard: Vec<u8>,
    /// From the first byte sent to the last one heard, in microseconds.
    pub round_trip_us: Option<u32>,
    /// How it ended; `None` while it goes on.
    pub end: Option<End>,
}

/// What a condition compared, as text with units.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Compared {
    /// The left side.
    pub found: String,
    /// The right side, or the least and the most.
    pub wanted: Vec<String>,
}

/// Why a step failed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reason {
    /// A reply was needed and this came instead.
    NoReply(Heard),
    /// The expectation of what is heard was not met: this was heard.
    OtherwiseHeard(Heard),
    /// The bytes that were heard do not fit the pattern.
    DoesNotFit,
    /// The comparison does not hold.
    DoesNotHold,
    /// Nothing has been sent yet that could have been answered.
    NothingSent,
    /// The point was not in the last reply that should have brought it, or was never read.
    NotRead(String),
    /// The last reply holds no such register or coil.
    NotInReply(u16),
    /// The last exchange has no round trip.
    NoRoundTrip,
    /// The variable has got no value.
    NoValue(String),
    /// The register that scales the point could not be read.
    NotScaled(String),
    /// The value's unit is another one than the text says.
    OtherUnit {
        /// The device's.
        found: String,
        /// As in the text.
        wanted: String,
    },
    /// A number and a name, or two names by order.
    NotComparable,
    /// A sum is beyond all limits, or one of its terms is no number.
    NoSum,
    /// The point does not take this value.
    NotAllowed {
        /// The point's id, or the register.
        point: String,
        /// The value.
        value: String,
    },
    /// The registers that the point shares with others could not be read before writing.
    NotReadBefore(String),
    /// The port did not take the settings in time.
    LineNotSet,
    /// The condition of a `repeat` did not hold after all its rounds.
    NeverHeld(u32),
    /// A `fail` step.
    Fail,
    /// Not sent: only reads are let out of the port.
    ReadOnly,
    /// Not sent, or not ended: the port is closed or gone.
    NoPort,
    /// It was taken back, or nothing was heard of it any more.
    Withdrawn,
    /// The sequence was stopped meanwhile.
    Stopped,
}

/// What was heard, in short.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Heard {
    /// A reply.
    Reply,
    /// An exception with this code.
    Exception(u8),
    /// Nothing.
    Silence,
    /// Nothing, as must be for a broadcast.
    Broadcast,
    /// Something that is no reply or whose check is wrong.
    Damaged,
    /// A reply that may belong to an earlier request.
    Doubtful,
    /// Bytes, where no reply could be expected.
    Bytes,
}

/// What has changed in a report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Changes {
    /// The summary as it is now.
    pub summary: Summary,
    /// Place of the first entry that has changed or is new.
    pub from: u32,
    /// All entries from there on.
    pub entries: Vec<Entry>,
}

impl Report {
    /// Puts changes in. They must come in order, the first ones into an empty report.
    pub fn apply(&mut self, changes: Changes) {
        self.entries.truncate(usize::try_from(changes.from).unwrap_or(usize::MAX));
        self.entries.extend(changes.entries);
        self.summary = changes.summary;
    }
}
