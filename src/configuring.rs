//! What the window knows of devices being read, set, searched for and brought back; for all pages of the workbench. The
//! work itself is done by the console's worker.

use buslens_analyst::configure::{
    AuditFilter, AuditForm, AuditPage, DeviceKey, FromConfigure, Hindrance, StoreFault, ToConfigure,
};
use buslens_analyst::line::PortState;
use buslens_analyst::message::{ToAnalyst, ToConsole};
use buslens_codec::UnitId;
use buslens_configure::{Edit, Hazard, Journal, Progress, Reach, Report, Scope, Snapshot, Task, Way};

use crate::analyst::Analyst;
use crate::device::{self, Device};
use crate::dom;
use crate::reactive::prelude::*;
use crate::workbench::Workbench;

/// The state. It outlives a visit to another page.
pub(crate) struct Configuring {
    /// What is under way; one thing at a time.
    pub(crate) running: RwSignal<Option<Running>>,
    /// What has come of the last one.
    pub(crate) ended: RwSignal<Option<Ended>>,
    /// Journals that nobody works on: each is an offer to finish or to undo.
    pub(crate) open: RwSignal<Vec<Journal>>,
    /// Why nothing can be kept, and so nothing be written.
    pub(crate) store_fault: RwSignal<Option<StoreFault>>,
    /// Writes that have left so far, a device each.
    pub(crate) writes: RwSignal<Vec<(DeviceKey, u64)>>,
    /// What was last asked for of the audit log.
    pub(crate) audit: RwSignal<AuditPage>,
    /// The last file that was made of it.
    pub(crate) audit_file: RwSignal<Option<(AuditForm, String)>>,
    /// The snapshots that are kept, each with its number; `None` until they have been asked for.
    pub(crate) snapshots: RwSignal<Option<Vec<(u64, Snapshot)>>>,
    last_run: StoredValue<u32>,
    /// What waits until the worker has told of the line, and for a device that was found elsewhere where that is.
    waiting: StoredValue<Option<(u32, Task, Option<Reach>)>>,
}

/// Something under way.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Running {
    /// Its number.
    pub(crate) run: u32,
    /// What.
    pub(crate) kind: Kind,
    /// How far it is; `None` until it is known to have begun.
    pub(crate) progress: Option<Progress>,
    /// It was asked to stop.
    pub(crate) stopping: bool,
}

/// Something that has ended, or was not begun.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ended {
    /// Its number.
    pub(crate) run: u32,
    /// What it was.
    pub(crate) kind: Kind,
    /// What has come of it.
    pub(crate) outcome: Result<Report, Hindrance>,
}

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// All parameters are read.
    Read,
    /// Something is written.
    Apply,
    /// The device is searched for.
    Find,
    /// A journal is finished or undone.
    Recover,
}

/// The device that is connected.
#[derive(Clone, Copy)]
pub(crate) struct Target {
    /// What it is.
    pub(crate) device: &'static Device,
    /// The text of its profile's file.
    pub(crate) profile: &'static str,
    /// How it is reached.
    pub(crate) reach: Reach,
    /// Whether it is simulated.
    pub(crate) simulated: bool,
}

impl Target {
    /// What its writes are counted under.
    pub(crate) fn key(&self) -> DeviceKey {
        DeviceKey { profile: self.device.id().to_owned(), unit: self.reach.unit.0, simulated: self.simulated }
    }
}

impl Configuring {
    /// Nothing yet.
    pub(crate) fn new() -> Self {
        Self {
            running: RwSignal::new(None),
            ended: RwSignal::new(None),
            open: RwSignal::new(Vec::new()),
            store_fault: RwSignal::new(None),
            writes: RwSignal::new(Vec::new()),
            audit: RwSignal::new(AuditPage::default()),
            audit_file: RwSignal::new(None),
            snapshots: RwSignal::new(None),
            last_run: StoredValue::new(0),
            waiting: StoredValue::new(None),
        }
    }

    /// Whether something is under way.
    pub(crate) fn is_busy(&self) -> bool {
        self.running.with(Option::is_some)
    }

    /// How often a device was written, as far as this browser knows.
    pub(crate) fn writes_of(&self, key: &DeviceKey) -> u64 {
        self.writes.with(|all| all.iter().find(|(other, _)| other == key).map_or(0, |(_, count)| *count))
    }

    /// Takes what the worker says.
    pub(crate) fn hear(&self, message: FromConfigure) {
        match message {
            FromConfigure::Refused { run, why } => self.end(run, Err(why)),
            FromConfigure::Report { run, report } => self.end(run, Ok(*report)),
            FromConfigure::Progress { run, progress } => self.running.update(|running| {
                if let Some(running) = running.as_mut().filter(|running| running.run == run) {
                    running.progress = Some(progress);
                }
            }),
            FromConfigure::Open(journals) => self.open.set(journals),
            FromConfigure::Store(fault) => {
                if self.store_fault.with_untracked(|before| *before != fault) {
                    self.store_fault.set(fault);
                }
            }
            FromConfigure::Writes(counts) => self.writes.set(counts),
            FromConfigure::Audit(page) => self.audit.set(page),
            FromConfigure::AuditFile(form, text) => self.audit_file.set(Some((form, text))),
            FromConfigure::Snapshots(all) => self.snapshots.set(Some(all)),
        }
    }

    fn end(&self, run: u32, outcome: Result<Report, Hindrance>) {
        let ended = self.running.with_untracked(|running| running.clone().filter(|running| running.run == run));
        if let Some(Running { kind, .. }) = ended {
            // Who looks for what has ended finds it before it is no longer under way.
            self.ended.set(Some(Ended { run, kind, outcome }));
            self.running.set(None);
        }
    }

    fn begin(&self, kind: Kind) -> Option<u32> {
        if self.running.with_untracked(Option::is_some) {
            return None;
        }
        let run = self.last_run.get_value().wrapping_add(1);
        self.last_run.set_value(run);
        self.running.set(Some(Running { run, kind, progress: None, stopping: false }));
        Some(run)
    }
}

impl Workbench {
    /// The device that is connected, once the worker is joined to the engine: see [`Workbench::start_console`]. A port that
    /// is just being opened with other settings counts.
    pub(crate) fn target(&self) -> Option<Target> {
        let unit = UnitId(self.console.unit.get()?);
        let device = device::find(&self.console.desk.connected.get()?);
        let (line, mode, simulated) = self.console.line.with(|line| {
            let line = line.as_ref().filter(|line| line.port != PortState::Gone && !line.replay)?;
            Some((line.line, line.mode, line.simulated))
        })?;
        let reach = Reach { unit, line, mode };
        Some(Target { device, profile: device.source(), reach, simulated })
    }

    /// Reads all parameters of the connected device. Its number, if nothing else is under way.
    pub(crate) fn read_device(&'static self) -> Option<u32> {
        self.begin(Kind::Read, Task::Read)
    }

    /// Writes, as one transaction; see [`Task::Apply`].
    pub(crate) fn apply(&'static self, before: Snapshot, edits: Vec<Edit>, confirmed: Vec<Hazard>) -> Option<u32> {
        self.begin(Kind::Apply, Task::Apply { before, edits, confirmed })
    }

    /// Reads all parameters of a device of the connected kind, which was just found elsewhere.
    pub(crate) fn read_at(&'static self, reach: Reach) -> Option<u32> {
        self.begin_at(Some(reach), Kind::Read, Task::Read)
    }

    /// Writes such a device; see [`Workbench::apply`].
    pub(crate) fn apply_at(
        &'static self,
        reach: Reach,
        before: Snapshot,
        edits: Vec<Edit>,
        confirmed: Vec<Hazard>,
    ) -> Option<u32> {
        self.begin_at(Some(reach), Kind::Apply, Task::Apply { before, edits, confirmed })
    }

    /// Searches for the connected device.
    pub(crate) fn find_device(&'static self, scope: Scope) -> Option<u32> {
        self.begin(Kind::Find, Task::Find { scope })
    }

    /// Goes on from a journal.
    pub(crate) fn recover(&'static self, journal: u64, way: Way) -> Option<u32> {
        self.start_console();
        let run = self.configuring.begin(Kind::Recover)?;
        tell(ToConfigure::Recover { run, journal, way });
        Some(run)
    }

    /// Stops what is under way. What was written is undone first.
    pub(crate) fn cancel_configuring(&self) {
        self.configuring.running.update(|running| {
            if let Some(running) = running {
                running.stopping = true;
            }
        });
        match self.configuring.waiting.try_update_value(Option::take).flatten() {
            Some((run, ..)) => self.configuring.end(run, Err(Hindrance::Cancelled)),
            None => tell(ToConfigure::Cancel),
        }
    }

    /// Forgets a journal: its device is left as it is.
    pub(crate) fn discard_journal(&'static self, journal: u64) {
        self.start_console();
        tell(ToConfigure::Discard(journal));
    }

    /// Asks for some of the audit log, the newest first: [`Configuring::audit`] follows it from then on.
    pub(crate) fn ask_audit(&'static self, filter: AuditFilter, from: u32, count: u32) {
        self.start_console();
        tell(ToConfigure::Audit { filter, from, count });
    }

    /// Has a file made of the audit log: [`Configuring::audit_file`].
    pub(crate) fn export_audit(&'static self, filter: AuditFilter, form: AuditForm) {
        self.start_console();
        tell(ToConfigure::ExportAudit { filter, form });
    }

    /// Empties the audit log. Counts stay.
    pub(crate) fn clear_audit(&'static self) {
        self.start_console();
        tell(ToConfigure::ClearAudit);
    }

    /// Asks for the snapshots that are kept: [`Configuring::snapshots`].
    pub(crate) fn ask_snapshots(&'static self) {
        self.start_console();
        tell(ToConfigure::Snapshots);
    }

    /// Keeps a snapshot under a number, in place of any other that has it.
    pub(crate) fn keep_snapshot(&'static self, number: u64, snapshot: Snapshot) {
        self.start_console();
        tell(ToConfigure::KeepSnapshot(number, Box::new(snapshot)));
    }

    /// Forgets a snapshot.
    pub(crate) fn forget_snapshot(&'static self, number: u64) {
        self.start_console();
        tell(ToConfigure::ForgetSnapshot(number));
    }

    /// Takes over what the first program says of the connection.
    pub(crate) fn device_connected(&self, device: Option<&'static Device>, unit: Option<u8>) {
        self.console.connected(device, unit);
        self.tell_device();
    }

    /// Tells the worker whose writes are counted.
    pub(crate) fn tell_device(&self) {
        let device = self.console.desk.connected.get_untracked().zip(self.console.unit.get_untracked());
        // Whether it is simulated the worker knows by the line.
        let key = device.map(|(profile, unit)| DeviceKey { profile, unit, simulated: false });
        tell(ToConfigure::Device(key));
    }

    fn begin(&'static self, kind: Kind, task: Task) -> Option<u32> {
        self.begin_at(None, kind, task)
    }

    fn begin_at(&'static self, at: Option<Reach>, kind: Kind, task: Task) -> Option<u32> {
        self.start_console();
        let run = self.configuring.begin(kind)?;
        self.configuring.waiting.set_value(Some((run, task, at)));
        untrack(|| self.hand_on());
        Some(run)
    }

    /// Keeps what was wanted before the worker has told of the line until it has.
    pub(crate) fn follow_line(&'static self) {
        dom::react(move || {
            if self.console.line.with(Option::is_some) {
                untrack(|| self.hand_on());
            }
        });
    }

    fn hand_on(&self) {
        if self.console.line.with(Option::is_none) {
            return;
        }
        let waiting = self.configuring.waiting.try_update_value(Option::take).flatten();
        let Some((run, task, at)) = waiting else { return };
        match self.target() {
            Some(Target { profile, reach, .. }) => {
                let reach = at.unwrap_or(reach);
                tell(ToConfigure::Begin { run, task, profile: profile.to_owned(), reach });
            }
            None => self.configuring.end(run, Err(Hindrance::NoPort)),
        }
    }
}

fn tell(wish: ToConfigure) {
    Analyst::Console.send(&ToAnalyst::Console(ToConsole::Configure(wish)));
}
