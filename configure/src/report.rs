//! What a procedure has come to.

use buslens_bus::record::End;
use serde::{Deserialize, Serialize};

use crate::{Difference, Hazard, Reach, Read, Refusal, Snapshot};

/// What a procedure has come to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// How it has ended.
    pub ending: Ending,
    /// The steps of the plan in their order, of what was to be written.
    pub steps: Vec<StepReport>,
    /// How the device is reached, known by a reply of it and nothing that was done since; `None` if that is not known.
    pub reach: Option<Reach>,
    /// Where it may be if [`Self::reach`] is none, best first. This is believed, not known.
    pub candidates: Vec<Reach>,
    /// What it holds, as far as this procedure has read it after the last write.
    pub snapshot: Option<Snapshot>,
    /// The id of the journal that stays open: finish or undo it with [`crate::Task::Recover`].
    pub journal: Option<u64>,
    /// Writes that have left, retries and what was undone among them.
    pub writes: u32,
    /// How long it took, in microseconds.
    pub took_us: u64,
}

/// How a procedure has ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Ending {
    // All went well.
    /// Everything is as it was wanted: read back where it can be read, acknowledged where not.
    Done,
    /// Everything was sent; of a command that cannot be read back no reply came: it may or may not have been carried out.
    /// It was not repeated.
    Unproven(Why),
    /// The device was found, at [`Report::reach`].
    Found,
    /// What a journal tells of is undone, as far as it can be: read back.
    Undone,

    // Nothing was written.
    /// These need a confirmation that they have not got.
    Unconfirmed(Vec<Hazard>),
    /// The plan cannot be carried out.
    Refused(Vec<Refusal>),
    /// The device holds something else than what the plan was made from; [`Report::snapshot`] tells what.
    Differs(Vec<Difference>),
    /// Somebody else answers where the device would be.
    Occupied(Reach),
    /// The port does not take the settings that the device would have.
    PortRefuses(Reach),
    /// The journal could not be kept.
    NotKept,
    /// Only reads are let out of the port.
    ReadOnly,
    /// The device does not answer where it should be.
    NoAnswer,
    /// The journal's profile does not load any more.
    BadJournal,

    // Something went wrong.
    /// A step failed, and everything that was written before is undone: read back. The device is at [`Report::reach`].
    RolledBack(Why),
    /// Some steps hold and others do not; [`Report::steps`] tells which. The device is at [`Report::reach`], and the journal
    /// stays open.
    Partly(Why),
    /// The device was written to and does not answer any more, not even at the [`Report::candidates`]. The journal stays
    /// open.
    Lost(Why),
    /// The device answers nowhere.
    NotFound {
        /// Bytes were heard that were no reply: two devices that answer at once, or other settings than those tried.
        garbled: bool,
    },
    /// The port is closed or gone. The journal stays open if anything was written.
    Interrupted,
    /// It was cancelled. What had been written is undone.
    Cancelled,
}

/// Why the ending is what it is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Why {
    /// The step's place in [`Report::steps`].
    pub step: u32,
    /// What went wrong with it.
    pub outcome: StepOutcome,
}

/// A step of the plan, and what has come of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepReport {
    /// The point's id.
    pub point: String,
    /// What it held before; `None` for a command, and for what cannot be read.
    pub before: Option<Vec<u16>>,
    /// What it should hold, or the command.
    pub after: Vec<u16>,
    /// How it stands.
    pub outcome: StepOutcome,
    /// Everything that was sent for it, what proves it and what undoes it included.
    pub exchanges: Vec<Exchange>,
}

/// How a step stands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StepOutcome {
    /// Nothing of it was sent.
    Waiting,
    /// It was sent, and what has become of it is not known: the port has vanished, or the device is lost.
    Sent,
    /// Read back: it holds. Known.
    Confirmed,
    /// The device said that it did. It cannot be read back: believed.
    Acknowledged,
    /// It was sent, and no reply came. It cannot be read back: unknown.
    Unproven,
    /// Refused by an exception with this code.
    Refused(u8),
    /// Read back: it holds something else.
    NotHeld(Read),
    /// Read back: a command was not carried out.
    NotDone,
    /// The device did not answer any more after it: unknown.
    Silent,
    /// It was cancelled, or the journal could not be kept: not sent.
    NotSent,
    /// It was undone, and read back.
    Undone,
    /// It was confirmed, and then a command of the same plan that loses the device's settings has changed it: read back.
    Overwritten,
}

/// Something that was sent, and what came of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Exchange {
    /// With which settings, to whom.
    pub reach: Reach,
    /// The bytes as they went out.
    pub sent: Vec<u8>,
    /// The bytes that were heard.
    pub heard: Vec<u8>,
    /// From the first byte sent to the last one heard, in microseconds.
    pub round_trip_us: Option<u32>,
    /// How it ended.
    pub end: End,
}
