//! What the Configure page knows: the parameters as they were read, what is staged, what is reviewed, what has come of it.

use buslens_analyst::configure::Hindrance;
use buslens_analyst::line::PortState;
use buslens_codec::profile::Profile;
use buslens_configure::{Edit, Hazard, Plan, Reach, Refusal, Report, Snapshot, StepOutcome};

use super::file::Told;
use crate::configure::staged::{Staged, Verdicts};
use crate::configure::words;
use crate::configuring::{Ended, Kind, Running};
use crate::device::{self, Device};
use crate::dom::react;
use crate::reactive::prelude::*;
use crate::storage;
use crate::workbench::Workbench;

/// The state of the page. It outlives a visit to another page.
pub(crate) struct Configure {
    /// What the device held when it was last read.
    pub(super) held: RwSignal<Option<Snapshot>>,
    /// Why the last reading brought nothing.
    pub(super) read_fault: RwSignal<Option<Ended>>,
    read_for: RwSignal<ReadFor>,
    /// The profile of what is staged.
    staged_for: RwSignal<Option<String>>,
    /// What is typed and not sent.
    pub(super) staged: RwSignal<Staged>,
    /// What is looked at before it is written.
    pub(super) reviewing: RwSignal<Option<Wish>>,
    /// What of its dangers was confirmed.
    pub(super) confirmed: RwSignal<Vec<Hazard>>,
    /// The plan that is being written, or was last.
    pub(super) writing: RwSignal<Option<Plan>>,
    /// Its last step that was begun.
    pub(super) last_step: RwSignal<Option<u32>>,
    /// What has come of the last writing or search.
    pub(super) report: RwSignal<Option<Ended>>,
    /// What has come of a file.
    pub(super) file: RwSignal<Option<Told>>,
    /// Unit ids to be tried by a search, as typed.
    pub(super) units: RwSignal<String>,
    /// Whether a search tries all settings.
    pub(super) everywhere: RwSignal<bool>,
}

/// What is to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Wish {
    /// What is staged.
    Staged,
    /// A command.
    Command(Edit),
}

/// Edits, and the plan that brings them about, or why there is none.
pub(super) type Planned = (Vec<Edit>, Result<Plan, Vec<Refusal>>);

/// What stands in the way of reading, writing or searching.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Blocked {
    /// No port is open.
    Closed,
    /// It is being opened.
    Opening,
    /// A recording is played.
    Replay,
    /// Only reads are let out.
    ReadOnly,
    /// Something is under way.
    Running,
}

/// Which device was read since it was connected or written.
#[derive(Clone, Debug, PartialEq, Eq)]
enum ReadFor {
    /// None.
    Nobody,
    /// None since a change has left one at this unit id: the connection may still be on its way there.
    Moved(u8),
    /// The one with this profile and unit id.
    Device(String, u8),
}

impl Configure {
    /// Nothing read yet.
    pub(crate) fn remembered() -> Self {
        Self {
            held: RwSignal::new(None),
            read_fault: RwSignal::new(None),
            read_for: RwSignal::new(ReadFor::Nobody),
            staged_for: RwSignal::new(None),
            staged: RwSignal::new(Staged::default()),
            reviewing: RwSignal::new(None),
            confirmed: RwSignal::new(Vec::new()),
            writing: RwSignal::new(None),
            last_step: RwSignal::new(None),
            report: RwSignal::new(None),
            file: RwSignal::new(None),
            units: storage::kept("configure-units", ""),
            everywhere: RwSignal::new(true),
        }
    }

    /// Changes what is staged, and keeps it.
    pub(super) fn stage(&self, change: impl FnOnce(&mut Staged)) {
        self.staged.update(change);
        if let Some(profile) = self.staged_for.get_untracked() {
            self.staged.with_untracked(|staged| storage::save(&staged_key(&profile), &staged.kept()));
        }
    }

    /// The device: the one that is connected, else the one that was last read.
    pub(super) fn device(&self, app: &'static Workbench) -> Option<&'static Device> {
        let connected = app.target().map(|target| target.device);
        connected.or_else(|| self.held.with(|held| held.as_ref().map(|held| device::find(&held.profile))))
    }

    /// What the connected device is known to hold, reached as it is now. Nothing is known of a device that was not read.
    pub(super) fn have(&self, app: &'static Workbench, profile: &Profile) -> Snapshot {
        let held = self.held.with(|held| held.clone().filter(|held| held.profile == profile.id));
        let reach = app.target().map(|target| target.reach);
        let have = held.unwrap_or_else(|| Snapshot::empty(profile, Reach::of_factory(profile)));
        Snapshot { reach: reach.unwrap_or(have.reach), ..have }
    }

    /// What the staged texts come to.
    pub(super) fn verdicts(&self, app: &'static Workbench) -> Verdicts {
        let Some(device) = self.device(app) else { return Verdicts::default() };
        let profile = device.profile();
        let have = self.have(app, profile);
        self.staged.with(|staged| staged.verdicts(profile, &have))
    }

    /// What is under review: the edits and the plan that brings them about, or why there is none.
    pub(super) fn plan(&self, app: &'static Workbench) -> Option<Planned> {
        let wish = self.reviewing.get()?;
        let profile = self.device(app)?.profile();
        let have = self.have(app, profile);
        Some(match wish {
            Wish::Command(edit) => {
                let plan = Plan::of(profile, &have, std::slice::from_ref(&edit));
                (vec![edit], plan)
            }
            Wish::Staged => {
                let verdicts = self.staged.with(|staged| staged.verdicts(profile, &have));
                let plan = Plan::of(profile, &have, &verdicts.edits);
                let refused: Vec<Refusal> =
                    plan.as_ref().err().cloned().unwrap_or_default().into_iter().chain(verdicts.refused).collect();
                let plan = if refused.is_empty() { plan } else { Err(refused) };
                (verdicts.edits, plan)
            }
        })
    }

    /// Reads everything anew.
    pub(super) fn read(&self, app: &'static Workbench) {
        if untrack(|| app.blocked(false)).is_none() {
            self.read_fault.set(None);
            app.read_device();
        }
    }

    /// Looks at what is staged, or at a command, before it is written.
    pub(super) fn review(&self, wish: Wish) {
        self.confirmed.set(Vec::new());
        self.report.set(None);
        self.reviewing.set(Some(wish));
        super::focus_soon("configure-work");
    }

    /// Writes what is under review, if all its dangers were confirmed.
    pub(super) fn write(&self, app: &'static Workbench) {
        let Some((edits, Ok(plan))) = untrack(|| self.plan(app)) else { return };
        let confirmed = self.confirmed.get_untracked();
        let blocked = untrack(|| app.blocked(true)).is_some();
        let unconfirmed = plan.hazards.iter().any(|hazard| !confirmed.contains(hazard));
        let Some(profile) = untrack(|| self.device(app)).map(Device::profile) else { return };
        if blocked || unconfirmed || plan.steps.is_empty() {
            return;
        }
        let before = untrack(|| self.have(app, profile));
        self.last_step.set(None);
        self.writing.set(Some(plan));
        self.reviewing.set(None);
        app.apply(before, edits, confirmed);
        super::focus_soon("configure-work");
    }

    /// The journal that the report on the page is about.
    pub(super) fn reported_journal(&self) -> Option<u64> {
        self.report.with(|ended| ended.as_ref().and_then(|ended| ended.outcome.as_ref().ok()?.journal))
    }

    /// Takes in how something has ended.
    fn take(&self, ended: Ended) {
        let wrote = ended.kind != Kind::Read;
        let reached = ended.outcome.as_ref().ok().and_then(|report| Some(report.reach?.unit.0));
        if let Ok(report) = &ended.outcome {
            self.take_values(report);
            if ended.kind == Kind::Apply {
                self.forget_written(report);
            }
        }
        if wrote {
            self.report.set(Some(ended));
            // What stood there has gone, and the focus with it.
            super::focus_soon("configure-work");
            if let Some(unit) = reached {
                // Whatever it was, what the device holds now is read again, where it is now.
                self.read_for.set(ReadFor::Moved(unit));
            }
        } else {
            let brought = ended.outcome.as_ref().is_ok_and(|report| report.snapshot.is_some());
            self.read_fault.set((!brought).then_some(ended));
        }
    }

    /// Takes over what a procedure has read.
    fn take_values(&self, report: &Report) {
        let Some(read) = &report.snapshot else { return };
        self.held.update(|held| match held {
            // What this one has not read stays as it was last read.
            Some(held) if held.profile == read.profile => {
                let kept = held.data.iter().filter(|datum| read.read(&datum.point).is_none()).cloned();
                let mut data: Vec<_> = read.data.iter().cloned().chain(kept).collect();
                let points = &device::find(&read.profile).profile().points;
                data.sort_by_key(|datum| points.iter().position(|point| point.id == datum.point));
                *held = Snapshot { data, ..read.clone() };
            }
            _ => *held = Some(read.clone()),
        });
    }

    /// What was written is not staged any more.
    fn forget_written(&self, report: &Report) {
        self.stage(|staged| {
            for step in &report.steps {
                use StepOutcome::{Acknowledged, Confirmed, Overwritten};
                if matches!(step.outcome, Confirmed | Acknowledged | Overwritten) {
                    staged.revert(&step.point);
                }
            }
        });
    }
}

impl Workbench {
    /// What stands in the way of reading or searching; and with `write` of writing.
    pub(super) fn blocked(&self, write: bool) -> Option<Blocked> {
        let line = self.console.line.with(|line| line.as_ref().map(|line| (line.port, line.replay, line.read_only)));
        let Some((port, replay, read_only)) = line else { return Some(Blocked::Closed) };
        if replay {
            return Some(Blocked::Replay);
        }
        match port {
            _ if self.configuring.is_busy() => Some(Blocked::Running),
            PortState::Gone => Some(Blocked::Closed),
            PortState::Changing => Some(Blocked::Opening),
            _ if write && read_only => Some(Blocked::ReadOnly),
            PortState::Open | PortState::Refused => None,
        }
    }

    /// How often the connected device was written from here.
    pub(super) fn worn(&self) -> Option<u64> {
        let target = self.target()?;
        Some(self.configuring.writes_of(&target.key()))
    }
}

impl Blocked {
    /// In words.
    pub(super) fn text(self, language: crate::text::Language) -> &'static str {
        match self {
            Self::Closed => language.cfg_blocked_closed(),
            Self::Opening => language.cfg_blocked_opening(),
            Self::Replay => language.cfg_blocked_replay(),
            Self::ReadOnly => language.cfg_blocked_read_only(),
            Self::Running => language.cfg_blocked_running(),
        }
    }
}

/// Why something was not begun, in words.
pub(super) fn hindrance(language: crate::text::Language, why: &Hindrance) -> String {
    match why {
        Hindrance::NoPort => language.cfg_blocked_closed().to_owned(),
        Hindrance::Replay => language.cfg_blocked_replay().to_owned(),
        Hindrance::ReadOnly => language.cfg_blocked_read_only().to_owned(),
        Hindrance::Busy => language.cfg_blocked_running().to_owned(),
        Hindrance::Sequence => language.cfg_blocked_sequence().to_owned(),
        Hindrance::Sending => language.cfg_blocked_sending().to_owned(),
        Hindrance::Profile(fault) => language.cfg_blocked_profile(fault.line, fault.column, &fault.reason),
        Hindrance::Cancelled => language.cfg_cancelled_clean().to_owned(),
        Hindrance::JournalHeld => language.cfg_blocked_held().to_owned(),
        Hindrance::JournalGone => language.cfg_blocked_gone().to_owned(),
        Hindrance::Store(fault) => super::banner::store_fault(language, fault),
    }
}

/// Follows, for as long as the program lives, what ends and how far what is under way has come.
pub(crate) fn follow(app: &'static Workbench) {
    let configure = &app.configure;
    react(move || {
        if let Some(ended) = app.configuring.ended.get() {
            untrack(|| configure.take(ended));
        }
    });
    react(move || {
        let phase = app.configuring.running.with(|running| match running {
            Some(Running { kind: Kind::Apply, progress: Some(progress), .. }) => Some(progress.phase.clone()),
            _ => None,
        });
        let step = configure.writing.with_untracked(|plan| words::step_of(plan.as_ref()?, phase.as_ref()?));
        if step.is_some() {
            configure.last_step.set(step);
        }
    });
    // What is staged for a kind of device is there whenever one is looked at.
    react(move || {
        let profile = configure.device(app).map(|device| device.id().to_owned());
        let known = untrack(|| configure.staged_for.get());
        if profile.is_some() && profile != known {
            let kept = profile.as_ref().and_then(|profile| storage::load(&staged_key(profile)));
            configure.staged.set(Staged::from_kept(&kept.unwrap_or_default()));
            configure.staged_for.set(profile);
            configure.reviewing.set(None);
            configure.file.set(None);
        }
    });
}

/// Reads the device whenever there is one that has not been read since it was connected or written; as long as the page is
/// shown.
pub(super) fn read_when_new(app: &'static Workbench) {
    let configure = &app.configure;
    react(move || {
        let target = app.target().map(|target| (target.device.id().to_owned(), target.reach.unit.0));
        // Nobody knows how a device with an open journal is reached: the ways on that its report offers come first.
        let open = app.blocked(false).is_none() && configure.reported_journal().is_none();
        match (target, configure.read_for.get()) {
            (None, ReadFor::Nobody) => {}
            // Unplugged or closed: it is read again when it is back.
            (None, _) => configure.read_for.set(ReadFor::Nobody),
            (Some((_, unit)), ReadFor::Moved(there)) if there != unit => {}
            (Some((profile, unit)), known) => {
                let read = ReadFor::Device(profile, unit);
                if open && known != read {
                    configure.read_for.set(read);
                    untrack(|| configure.read(app));
                }
            }
        }
    });
}

fn staged_key(profile: &str) -> String {
    ["configure-staged.", profile].concat()
}
