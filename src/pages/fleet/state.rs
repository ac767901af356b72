//! What the Fleet page knows: what is compared, a series with what its next device is given, what of the log is looked at.

use std::ops::Range;

use buslens_analyst::configure::{AuditFilter, AuditForm, Hindrance, StoreFault};
use buslens_codec::profile::Profile;
use buslens_configure::{FileFault, Hazard, Plan, Read, Report, Snapshot};

use super::now_ms;
use crate::configure::staged::Staged;
use crate::configure::words;
use crate::configuring::{Ended, Kind};
use crate::device::{self, Device};
use crate::dom::{self, react};
use crate::fleet::series::{Action, Series, State};
use crate::fleet::{audit, labels};
use crate::reactive::prelude::*;
use crate::storage;
use crate::text::Language;
use crate::workbench::Workbench;

/// Names the connected device among the snapshots to choose from.
pub(super) const DEVICE: &str = "device";
/// Under which a series is kept.
const SERIES: &str = "fleet-series";
/// Rows of the log that are asked for beyond those in sight, at both ends.
const AHEAD: u32 = 64;

/// The state of the page. It outlives a visit to another page.
pub(crate) struct Fleet {
    /// The open pane.
    pub(super) pane: RwSignal<String>,
    /// What the user calls the device of which a snapshot is taken.
    pub(super) name: RwSignal<String>,
    /// What is under way, and for what.
    purpose: RwSignal<Option<(u32, Purpose)>>,
    /// The profile of the device that is read for a snapshot.
    read_for: StoredValue<String>,
    /// Whether what is known of the connected device was read since it was connected at this unit id.
    fresh: RwSignal<bool>,
    /// What has come of the last snapshot or file.
    pub(super) told: RwSignal<Option<Told>>,
    /// The snapshot that was deleted last.
    pub(super) deleted: RwSignal<Option<(u64, Snapshot)>>,
    /// The first of two to be compared: a snapshot's number or [`DEVICE`]; empty for none.
    pub(super) left: RwSignal<String>,
    /// The second one.
    pub(super) right: RwSignal<String>,
    /// Whether a comparison shows what is the same, too.
    pub(super) with_same: RwSignal<bool>,
    /// Whether a transfer brings the unit id, too.
    pub(super) with_unit: RwSignal<bool>,
    /// The series.
    pub(super) series: RwSignal<Option<Series>>,
    /// The series that was ended last.
    pub(super) ended: RwSignal<Option<Series>>,
    /// Whether there was no room to keep the series.
    pub(super) series_unkept: RwSignal<bool>,
    /// The first unit id of the next series, as typed.
    pub(super) first: RwSignal<String>,
    /// From one to the next.
    pub(super) step: RwSignal<String>,
    /// What is left out.
    pub(super) skip: RwSignal<String>,
    /// Whether a device is searched with all settings.
    pub(super) everywhere: RwSignal<bool>,
    /// The profile of what is given.
    given_for: RwSignal<Option<String>>,
    /// What every device is given, as typed.
    pub(super) given: RwSignal<Staged>,
    /// The command at the end of each, as its point and code; empty for none.
    pub(super) finish: RwSignal<String>,
    /// What of the dangers was confirmed.
    pub(super) accepted: RwSignal<Vec<Hazard>>,
    /// The name of the next device, as typed.
    pub(super) sensor_name: RwSignal<String>,
    /// The plan that is being written.
    pub(super) writing: RwSignal<Option<Plan>>,
    /// The key of the labels' size.
    pub(super) size: RwSignal<String>,
    /// The device whose writes are looked at; empty for all.
    pub(super) audited: RwSignal<String>,
    /// The chosen row of the log.
    pub(super) row: RwSignal<u32>,
    /// Changes with the rows of the log.
    pub(super) rows_turn: RwSignal<u32>,
    /// Whether the log is about to be emptied.
    pub(super) clearing: RwSignal<bool>,
    /// What of the log was asked for last.
    asked: StoredValue<Option<(AuditFilter, Range<u32>)>>,
}

/// For what something is under way.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Purpose {
    /// A snapshot under this name.
    Take(String),
    /// The device is to be compared.
    Look,
    /// The next step of a series.
    Series,
}

/// What has come of a snapshot or a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Told {
    /// A snapshot was taken, or came in from a file.
    Kept {
        /// Its name.
        name: String,
        /// Parameters that were read.
        read: usize,
        /// All of its parameters.
        all: usize,
    },
    /// The device could not be read.
    NotRead {
        /// Its profile.
        profile: String,
        /// What has come of it.
        outcome: Box<Result<Report, Hindrance>>,
    },
    /// The file is too large.
    Large,
    /// The browser could not read it.
    Unreadable,
    /// It is no snapshot.
    Fault(FileFault),
    /// It is of a device that this page does not know.
    UnknownDevice(String),
}

impl Fleet {
    /// As it was left.
    pub(crate) fn remembered() -> Self {
        Self {
            pane: storage::kept("fleet-pane", ""),
            name: storage::kept("fleet-name", ""),
            purpose: RwSignal::new(None),
            read_for: StoredValue::new(String::new()),
            fresh: RwSignal::new(false),
            told: RwSignal::new(None),
            deleted: RwSignal::new(None),
            left: RwSignal::new(String::new()),
            right: RwSignal::new(String::new()),
            with_same: RwSignal::new(false),
            with_unit: RwSignal::new(false),
            series: RwSignal::new(storage::load(SERIES).and_then(|kept| Series::from_json(&kept))),
            ended: RwSignal::new(None),
            series_unkept: RwSignal::new(false),
            first: storage::kept("fleet-first", "1"),
            step: storage::kept("fleet-step", "1"),
            skip: storage::kept("fleet-skip", ""),
            everywhere: RwSignal::new(true),
            given_for: RwSignal::new(None),
            given: RwSignal::new(Staged::default()),
            finish: RwSignal::new(String::new()),
            accepted: RwSignal::new(Vec::new()),
            sensor_name: storage::kept("fleet-sensor", ""),
            writing: RwSignal::new(None),
            size: storage::kept("fleet-label", labels::SIZES[0].key),
            audited: RwSignal::new(String::new()),
            row: RwSignal::new(u32::MAX),
            rows_turn: RwSignal::new(0),
            clearing: RwSignal::new(false),
            asked: StoredValue::new(None),
        }
    }

    /// Whether what is under way is a step of the series.
    pub(super) fn is_in_series(&self, app: &'static Workbench) -> bool {
        let run = app.configuring.running.with(|running| running.as_ref().map(|running| running.run));
        run.is_some()
            && self.purpose.with(|purpose| {
                purpose.as_ref().is_some_and(|(own, purpose)| Some(*own) == run && *purpose == Purpose::Series)
            })
    }

    // Snapshots.

    /// Takes one of the connected device.
    pub(super) fn take_snapshot(&self, app: &'static Workbench) {
        let name = self.name.with_untracked(|name| name.trim().to_owned());
        self.read(app, Purpose::Take(name));
    }

    /// Reads the connected device, to compare it.
    pub(super) fn look(&self, app: &'static Workbench) {
        self.read(app, Purpose::Look);
    }

    fn read(&self, app: &'static Workbench, purpose: Purpose) {
        self.told.set(None);
        let target = untrack(|| app.target());
        if let (Some(target), Some(run)) = (target, app.read_device()) {
            self.read_for.set_value(target.device.id().to_owned());
            self.purpose.set(Some((run, purpose)));
        }
    }

    /// Keeps a snapshot as a new one.
    pub(super) fn keep(&self, app: &'static Workbench, snapshot: Snapshot) {
        let read = snapshot.data.iter().filter(|datum| matches!(datum.read, Read::Registers(_)));
        let told = Told::Kept { name: snapshot.name.clone(), read: read.count(), all: snapshot.data.len() };
        self.told.set(Some(told));
        app.keep_snapshot(new_number(app), snapshot);
    }

    /// Takes in the text of a file.
    pub(super) fn bring(&self, app: &'static Workbench, text: &str) {
        match Snapshot::from_json(text) {
            Ok(snapshot) if known(&snapshot.profile).is_some() => self.keep(app, snapshot),
            Ok(snapshot) => self.told.set(Some(Told::UnknownDevice(snapshot.profile))),
            Err(fault) => self.told.set(Some(Told::Fault(fault))),
        }
    }

    /// Deletes a snapshot. It can be brought back until the next one is deleted.
    pub(super) fn delete(&self, app: &'static Workbench, number: u64, snapshot: Snapshot) {
        let key = number.to_string();
        for side in [self.left, self.right] {
            if side.with_untracked(|chosen| *chosen == key) {
                side.set(String::new());
            }
        }
        self.deleted.set(Some((number, snapshot)));
        app.forget_snapshot(number);
    }

    /// Brings back what was deleted last.
    pub(super) fn undelete(&self, app: &'static Workbench) {
        if let Some((number, snapshot)) = self.deleted.get_untracked() {
            self.deleted.set(None);
            app.keep_snapshot(number, snapshot);
        }
    }

    /// What the connected device holds, if it was read since it was connected: another one may have stood there before.
    pub(super) fn device_now(&self, app: &'static Workbench) -> Option<Snapshot> {
        if self.fresh.get() { app.configure.held_by(app) } else { None }
    }

    /// What a side of the comparison stands for.
    pub(super) fn side(&self, app: &'static Workbench, chosen: &str) -> Option<Snapshot> {
        if chosen == DEVICE {
            return self.device_now(app);
        }
        let number: u64 = chosen.parse().ok()?;
        app.configuring.snapshots.with(|all| {
            let found = all.as_ref()?.iter().find(|(known, _)| *known == number);
            found.map(|(_, snapshot)| snapshot.clone())
        })
    }

    // The series.

    /// What every device is given, with the profile that it is for.
    pub(super) fn give(&self, change: impl FnOnce(&mut Staged)) {
        self.given.update(change);
        if let Some(profile) = self.given_for.get_untracked() {
            self.given.with_untracked(|given| storage::save(&given_key(&profile), &given.kept()));
        }
    }

    /// The device of the series; that of the connected one while there is no series.
    pub(super) fn device(&self, app: &'static Workbench) -> Option<&'static Device> {
        let of_series = self.series.with(|series| series.as_ref().map(|series| series.setup.profile.clone()));
        match of_series {
            Some(profile) => known(&profile),
            None => app.target().map(|target| target.device),
        }
    }

    /// Sets up a new device, or again the one at `place`.
    pub(super) fn set_up(&self, app: &'static Workbench, place: Option<usize>) {
        let name = self.sensor_name.get_untracked();
        if place.is_none() {
            self.sensor_name.set(String::new());
        }
        self.go_on(app, |series, profile| series.begin(profile, now_ms(), &name, place));
    }

    /// Does something to the series, and what follows from it.
    pub(super) fn go_on(&self, app: &'static Workbench, step: impl FnOnce(&mut Series, &Profile) -> Action) {
        let Some(device) = untrack(|| self.device(app)) else { return };
        let mut action = Action::Rest;
        self.series.update(|series| {
            if let Some(series) = series {
                action = step(series, device.profile());
            }
        });
        self.act(app, action);
    }

    fn act(&self, app: &'static Workbench, action: Action) {
        let begun = match action {
            Action::Rest => return,
            Action::Find(scope) => app.find_device(scope),
            Action::Read(reach) => app.read_at(reach),
            Action::Apply(apply) => {
                let apply = *apply;
                self.writing.set(Some(apply.plan.clone()));
                let confirmed = apply.plan.hazards.clone();
                app.configure.look_on(apply.plan);
                app.apply_at(apply.reach, apply.before, apply.edits, confirmed)
            }
        };
        match begun {
            Some(run) => self.purpose.set(Some((run, Purpose::Series))),
            None => self.hear_series(app, None),
        }
    }

    /// Something of the series has ended; `None` where something else was under way.
    fn hear_series(&self, app: &'static Workbench, ended: Option<&Ended>) {
        let busy = Err(Hindrance::Busy);
        let (kind, outcome) = match ended {
            Some(ended) => (ended.kind, &ended.outcome),
            None => (Kind::Read, &busy),
        };
        let place = self.series.with_untracked(|series| series.as_ref().and_then(Series::under_way));
        self.go_on(app, |series, profile| series.hear(profile, now_ms(), kind, outcome));
        self.keep_set_up(app, place);
    }

    /// Keeps a snapshot of a device that is set up now.
    fn keep_set_up(&self, app: &'static Workbench, place: Option<usize>) {
        let done = self.series.with_untracked(|series| {
            let sensor = series.as_ref()?.sensors.get(place?)?;
            (sensor.state == State::Done).then(|| sensor.snapshot.clone()).flatten()
        });
        if let Some(snapshot) = done {
            app.keep_snapshot(new_number(app), snapshot);
            // The next one can be named at once.
            super::series::focus_name();
        }
    }

    /// Takes in how something has ended.
    fn take(&self, app: &'static Workbench, ended: &Ended) {
        if ended.outcome.as_ref().is_ok_and(|report| report.snapshot.is_some()) {
            self.fresh.set(true);
        }
        let own = self.purpose.with_untracked(|purpose| purpose.clone().filter(|(run, _)| *run == ended.run));
        let Some((_, purpose)) = own else { return };
        self.purpose.set(None);
        let read = ended.outcome.as_ref().ok().and_then(|report| report.snapshot.clone());
        match (purpose, read) {
            (Purpose::Series, _) => self.hear_series(app, Some(ended)),
            (Purpose::Take(name), Some(snapshot)) => self.keep(app, Snapshot { name, ..snapshot }),
            (Purpose::Look, Some(_)) => {}
            (Purpose::Take(_) | Purpose::Look, None) => {
                let outcome = Box::new(ended.outcome.clone());
                self.told.set(Some(Told::NotRead { profile: self.read_for.get_value(), outcome }));
            }
        }
    }

    // The log.

    /// What of the log is looked at.
    pub(super) fn filter(&self) -> AuditFilter {
        self.audited.with(|key| audit::filter(key))
    }

    /// Asks for rows of the log, unless they are here or on their way.
    pub(super) fn want_rows(&self, app: &'static Workbench, rows: &Range<u32>) {
        let filter = untrack(|| self.filter());
        let covered = self.asked.with_value(|asked| {
            let (known, have) = asked.as_ref()?;
            Some(*known == filter && have.start <= rows.start && rows.end <= have.end)
        });
        if covered == Some(true) {
            return;
        }
        let wanted = rows.start.saturating_sub(AHEAD)..rows.end.saturating_add(AHEAD);
        self.asked.set_value(Some((filter.clone(), wanted.clone())));
        app.ask_audit(filter, wanted.start, wanted.end - wanted.start);
    }
}

impl Told {
    /// Whether something went wrong.
    pub(super) fn is_fault(&self) -> bool {
        !matches!(self, Self::Kept { .. })
    }

    /// In words.
    pub(super) fn text(&self, language: Language) -> String {
        match self {
            Self::Kept { name, read, all } if read == all => language.fleet_kept(&named(language, name), *all),
            Self::Kept { name, read, all } => language.fleet_kept_partly(&named(language, name), *read, *all),
            Self::NotRead { profile, outcome } => {
                let ended = super::progress::Ended::of(language, device::find(profile).profile(), outcome);
                [&ended.title, ". ", &ended.what, " ", &ended.tip].concat().trim_end().to_owned()
            }
            Self::Large => language.cfg_file_large().to_owned(),
            Self::Unreadable => language.cfg_file_unreadable().to_owned(),
            Self::Fault(fault) => words::file_fault(language, fault),
            Self::UnknownDevice(profile) => language.fleet_file_unknown(profile),
        }
    }
}

/// Follows, for as long as the program lives, what has ended and what came.
pub(crate) fn follow(app: &'static Workbench) {
    let fleet = &app.fleet;
    let who = Memo::new(move |_| app.target().map(|target| (target.device.id().to_owned(), target.reach.unit.0)));
    react(move || {
        who.track();
        fleet.fresh.set(false);
    });
    react(move || {
        if let Some(ended) = app.configuring.ended.get() {
            untrack(|| fleet.take(app, &ended));
        }
    });
    react(move || {
        app.configuring.audit.track();
        fleet.rows_turn.update(|turn| *turn = turn.wrapping_add(1));
    });
    react(move || {
        if let Some((form, text)) = app.configuring.audit_file.get() {
            app.configuring.audit_file.set(None);
            let (kind, end) = match form {
                AuditForm::Csv => ("text/csv", "csv"),
                AuditForm::JsonLines => ("application/x-ndjson", "jsonl"),
            };
            dom::save_text(&text, kind, &["buslens-writes-", &super::plain_day(now_ms()), ".", end].concat());
        }
    });
    let mut first = true;
    react(move || {
        let kept = fleet.series.with(|series| series.as_ref().map(Series::to_json).unwrap_or_default());
        if !std::mem::take(&mut first) {
            fleet.series_unkept.set(!storage::has_saved(SERIES, &kept));
        }
    });
    react(move || {
        let profile = fleet.device(app).map(|device| device.id().to_owned());
        if profile.is_some() && profile != fleet.given_for.get_untracked() {
            let kept = profile.as_ref().and_then(|profile| storage::load(&given_key(profile)));
            fleet.given.set(Staged::from_kept(&kept.unwrap_or_default()));
            fleet.given_for.set(profile);
            fleet.accepted.set(Vec::new());
            fleet.finish.set(String::new());
        }
    });
}

/// A snapshot's name for people.
pub(super) fn named(language: Language, name: &str) -> String {
    if name.is_empty() { language.fleet_unnamed().to_owned() } else { name.to_owned() }
}

/// Why snapshots are not kept, in words.
pub(super) fn store_fault(language: Language, fault: &StoreFault) -> String {
    match fault {
        StoreFault::Unavailable => language.fleet_store_unavailable().to_owned(),
        StoreFault::Full => language.fleet_store_full().to_owned(),
        StoreFault::Other(words) => language.fleet_store_other(words),
    }
}

/// The device with this profile, if it is one of those known.
pub(super) fn known(profile: &str) -> Option<&'static Device> {
    crate::device::known(profile)
}

/// A number that no snapshot has: the time, or what follows the last one.
fn new_number(app: &'static Workbench) -> u64 {
    let last = app.configuring.snapshots.with_untracked(|all| {
        all.as_ref().and_then(|all| all.iter().map(|(number, _)| *number).max()).unwrap_or_default()
    });
    now_ms().max(last + 1)
}

fn given_key(profile: &str) -> String {
    ["fleet-given.", profile].concat()
}
