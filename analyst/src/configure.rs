//! What the window and the console's worker say to each other about changing devices; and what of it is kept where it
//! outlives the page.

use buslens_bus::record::{End, Origin};
use buslens_codec::profile::ProfileError;
use buslens_configure::{AuditEntry, Journal, Progress, Reach, Report, Snapshot, Task, Way};
use serde::{Deserialize, Serialize};

/// Window to worker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToConfigure {
    /// The device that is connected, or none: whoever writes to it, its writes are counted under its profile's id.
    Device(Option<DeviceKey>),
    /// Read, write or search. Answered by [`FromConfigure::Refused`], or by [`FromConfigure::Progress`] until
    /// [`FromConfigure::Report`] comes.
    Begin {
        /// Names the answers.
        run: u32,
        /// What.
        task: Task,
        /// The device's profile, as the text of its file.
        profile: String,
        /// How the device is reached.
        reach: Reach,
    },
    /// Go on from a journal that is kept: the same answers.
    Recover {
        /// Names the answers.
        run: u32,
        /// The journal's id.
        journal: u64,
        /// Which way.
        way: Way,
    },
    /// Stop. What was written is undone first: the report comes then.
    Cancel,
    /// Forget a journal that nobody works on: its device is left as it is.
    Discard(u64),
    /// Send some of the audit log, the newest first. Answered by [`FromConfigure::Audit`] now, and again whenever it has
    /// grown.
    Audit {
        /// Only these.
        filter: AuditFilter,
        /// Place of the first, counted from 0.
        from: u32,
        /// How many.
        count: u32,
    },
    /// Make a file of the audit log, the oldest first. Answered by [`FromConfigure::AuditFile`].
    ExportAudit {
        /// Only these.
        filter: AuditFilter,
        /// As what.
        form: AuditForm,
    },
    /// Empty the audit log. The counts of writes stay.
    ClearAudit,
    /// Send the snapshots that are kept. Answered by [`FromConfigure::Snapshots`] now, and again whenever there are others.
    Snapshots,
    /// Keep a snapshot under this number, in place of any other that has it.
    KeepSnapshot(u64, Box<Snapshot>),
    /// Forget the snapshot with this number.
    ForgetSnapshot(u64),
}

/// Worker to window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromConfigure {
    /// It was not begun.
    Refused {
        /// As it was asked.
        run: u32,
        /// Why.
        why: Hindrance,
    },
    /// How far it has come, at most at display rate.
    Progress {
        /// As it was asked.
        run: u32,
        /// How far.
        progress: Progress,
    },
    /// It has ended.
    Report {
        /// As it was asked.
        run: u32,
        /// What has come of it.
        report: Box<Report>,
    },
    /// The journals that nobody works on, in no page of this browser: something was under way when a page was closed, a
    /// port was lost or a device did not answer. The oldest first. Told at the beginning and whenever it has changed.
    Open(Vec<Journal>),
    /// What stands in the way of keeping something; `None` when it was kept again. While there is one, nothing is written
    /// to a device.
    Store(Option<StoreFault>),
    /// Writes that have left so far, a device each. Told at the beginning and when one has changed.
    Writes(Vec<(DeviceKey, u64)>),
    /// Some of the audit log.
    Audit(AuditPage),
    /// The audit log as a file's text.
    AuditFile(AuditForm, String),
    /// The snapshots that are kept, each with its number, the oldest number first.
    Snapshots(Vec<(u64, Snapshot)>),
}

/// Why something was not begun.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Hindrance {
    /// There is no open port.
    NoPort,
    /// A recording is played.
    Replay,
    /// Only reads are let out.
    ReadOnly,
    /// Something else is being done to a device.
    Busy,
    /// A sequence runs.
    Sequence,
    /// Something is sent again and again from the console.
    Sending,
    /// The profile does not load.
    Profile(ProfileFault),
    /// Another page of this browser works on this journal.
    JournalHeld,
    /// There is no such journal any more.
    JournalGone,
    /// It was cancelled before it had begun.
    Cancelled,
    /// Nothing can be kept: without a journal nothing is written.
    Store(StoreFault),
}

/// Where a profile does not load.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProfileFault {
    /// Line of its file, counted from 1.
    pub line: u32,
    /// Character of that line, counted from 1.
    pub column: u32,
    /// What is wrong, in the loader's words.
    pub reason: String,
}

/// What stands in the way of keeping something.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StoreFault {
    /// The browser gives this page no database: a private window, or a setting.
    Unavailable,
    /// There is no room left for it.
    Full,
    /// Anything else, in the browser's words.
    Other(String),
}

/// A device, as far as two of a kind can be told apart. It has no number of its own that could be read, so that it is its
/// unit id that names it: when configuring changes that, its count of writes goes with it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct DeviceKey {
    /// Id of its profile; empty for a device that nobody has told anything of.
    pub profile: String,
    /// Its unit id.
    pub unit: u8,
    /// Whether it is simulated.
    pub simulated: bool,
}

/// What of the audit log is wanted. The default is everything.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AuditFilter {
    /// Only devices with this profile.
    pub profile: Option<String>,
    /// Only devices with this unit id.
    pub unit: Option<u8>,
}

/// A form of the audit log's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AuditForm {
    /// A table with a head, separated by commas.
    Csv,
    /// One JSON object a line.
    JsonLines,
}

/// Some of the audit log.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AuditPage {
    /// As it was asked.
    pub filter: AuditFilter,
    /// How many there are that fit the filter.
    pub total: u32,
    /// Place of the first row, counted from 0, which is the newest.
    pub from: u32,
    /// The rows, the newest first.
    pub rows: Vec<AuditRow>,
}

/// A write that has left, as it is kept.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AuditRow {
    /// Whether the device was simulated.
    pub simulated: bool,
    /// Who had it written.
    pub origin: Origin,
    /// What was written. Its point is empty where nobody but the bytes tells what it was.
    pub entry: AuditEntry,
}

impl AuditFilter {
    /// Whether a row is wanted.
    pub fn lets(&self, row: &AuditRow) -> bool {
        self.profile.as_ref().is_none_or(|profile| *profile == row.entry.profile)
            && self.unit.is_none_or(|unit| unit == row.entry.reach.unit.0)
    }
}

impl From<ProfileError> for ProfileFault {
    fn from(error: ProfileError) -> Self {
        let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        Self { line: count(error.line), column: count(error.column), reason: error.reason }
    }
}

/// What the worker wants of whoever keeps things where they outlive the page: a database and its locks.
#[derive(Clone, Debug, PartialEq)]
pub enum ToStore {
    /// Tell the journals that nobody holds, and the counts: [`FromStore::Journals`], [`FromStore::Counts`]; and the
    /// journals again whenever they have changed in any page of the browser.
    Watch,
    /// Hold a journal with this page's lock, unless this page holds it already, and keep it for good; of a simulated
    /// device, which ends with the page, as long as that lasts. Answered by [`FromStore::Kept`].
    Keep {
        /// The journal.
        journal: Box<Journal>,
        /// Whether its device is simulated.
        simulated: bool,
    },
    /// Hold a journal that nobody else holds. Answered by [`FromStore::Taken`].
    Take(u64),
    /// Forget a journal and let it go.
    Forget(u64),
    /// Forget a journal that nobody holds.
    Discard(u64),
    /// Let all journals go that this page holds.
    Release,
    /// Add a row to the audit log.
    Append(Box<AuditRow>),
    /// Tell the whole audit log: [`FromStore::Audit`], and again whenever it has changed in another page.
    Audit,
    /// Empty the audit log.
    ClearAudit,
    /// Add so many to the counts of these devices. Answered by [`FromStore::Counts`].
    Count(Vec<(DeviceKey, u64)>),
    /// A device has got another unit id: its count goes with it. Answered by [`FromStore::Counts`].
    Move(DeviceKey, DeviceKey),
    /// Tell the snapshots: [`FromStore::Snapshots`].
    Snapshots,
    /// Keep a snapshot under a number. Answered by [`FromStore::Snapshots`].
    KeepSnapshot(u64, Box<Snapshot>),
    /// Forget a snapshot. Answered by [`FromStore::Snapshots`].
    ForgetSnapshot(u64),
}

/// What has come of it. Answers come in the order of the orders.
#[derive(Clone, Debug, PartialEq)]
pub enum FromStore {
    /// The journals that nobody holds, the oldest first.
    Journals(Vec<Journal>),
    /// A [`ToStore::Keep`] has ended: on the disk, or not at all.
    Kept(u64, Result<(), StoreFault>),
    /// A [`ToStore::Take`] has ended.
    Taken(u64, Result<Box<Journal>, Hindrance>),
    /// All counts.
    Counts(Vec<(DeviceKey, u64)>),
    /// The whole audit log, the oldest first.
    Audit(Vec<AuditRow>),
    /// All snapshots.
    Snapshots(Vec<(u64, Snapshot)>),
    /// Something else than a journal could not be kept or read.
    Failed(StoreFault),
}

/// Whether a write has left, by its end.
pub(crate) fn has_left(end: End) -> bool {
    !matches!(end, End::ReadOnly | End::NoPort | End::Withdrawn | End::Busy)
}
