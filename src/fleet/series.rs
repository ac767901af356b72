//! A series of devices that are set up one by one. What is done to the line comes out as [`Action`], and what has come of it
//! goes in; time is an argument.

use buslens_analyst::configure::Hindrance;
use buslens_codec::UnitId;
use buslens_codec::profile::Profile;
use buslens_configure::{Edit, Ending, Hazard, Plan, Reach, Refusal, Report, Scope, Snapshot};
use serde::{Deserialize, Serialize};

use super::setup::{Setup, unit_point};
use crate::configuring::Kind;

/// Unit ids that are tried of a device that does not tell its own.
const USUAL_UNITS: std::ops::RangeInclusive<u8> = 1..=16;

/// A series.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Series {
    /// When it was begun, in milliseconds since the Unix epoch.
    pub(crate) begun_unix_ms: u64,
    /// What every device is given.
    pub(crate) setup: Setup,
    /// Unit ids at which somebody else has answered.
    pub(crate) occupied: Vec<u8>,
    /// The devices in the order in which they were begun.
    pub(crate) sensors: Vec<Sensor>,
    /// The place of the one that was worked on last, until it is put aside.
    pub(crate) latest: Option<usize>,
}

/// A device of a series.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sensor {
    /// Its name or serial number as typed; empty for none.
    pub(crate) name: String,
    /// Its unit id, wanted or got; 0 where none was left.
    pub(crate) unit: u8,
    /// When its state was reached, in milliseconds since the Unix epoch.
    pub(crate) unix_ms: u64,
    /// How it stands.
    pub(crate) state: State,
    /// Where it is or may be, the last place first.
    pub(crate) places: Vec<Reach>,
    /// What it was last read to hold.
    pub(crate) snapshot: Option<Snapshot>,
}

/// How a device of a series stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum State {
    /// Something is done to it.
    UnderWay(Stage),
    /// It holds what it should: read back.
    Done,
    /// Something went wrong.
    Failed(Box<Failure>),
    /// It was left out.
    LeftOut,
}

/// What is done to a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Stage {
    /// It is searched.
    Finding,
    /// Its parameters are read.
    Reading,
    /// It is written.
    Writing,
    /// Its parameters are read again.
    Checking,
}

/// What went wrong.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Failure {
    /// What was under way has ended otherwise than it should.
    Ended(Stage, Box<Report>),
    /// It was not begun.
    Hindered(Hindrance),
    /// It answers where the device with this place in the series was left: that one is still plugged in.
    SetUpBefore(usize),
    /// It does not take what it should be given.
    Refused(Vec<Refusal>),
    /// This must be confirmed first.
    Unconfirmed(Vec<Hazard>),
    /// It holds something else afterwards: the points' ids.
    NotHeld(Vec<String>),
    /// No unit id is left.
    NoUnitLeft,
    /// The page was closed meanwhile.
    Broken,
}

/// What shall be done now.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// Nothing.
    Rest,
    /// Search.
    Find(Scope),
    /// Read all parameters.
    Read(Reach),
    /// Write, as one transaction.
    Apply(Box<Apply>),
}

/// A transaction.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Apply {
    /// How the device is reached.
    pub(crate) reach: Reach,
    /// What it holds.
    pub(crate) before: Snapshot,
    /// What it shall hold.
    pub(crate) edits: Vec<Edit>,
    /// The plan that brings it about, for who looks on.
    pub(crate) plan: Plan,
}

/// How many there are of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    /// Set up.
    pub(crate) done: usize,
    /// Something went wrong.
    pub(crate) failed: usize,
}

impl Series {
    /// A series without devices.
    pub(crate) fn new(unix_ms: u64, setup: Setup) -> Self {
        Self { begun_unix_ms: unix_ms, setup, occupied: Vec::new(), sensors: Vec::new(), latest: None }
    }

    /// The place of the device to which something is done.
    pub(crate) fn under_way(&self) -> Option<usize> {
        self.sensors.iter().position(|sensor| matches!(sensor.state, State::UnderWay(_)))
    }

    /// Whether something went wrong with the device at this place.
    pub(crate) fn has_failed(&self, place: usize) -> bool {
        self.sensors.get(place).is_some_and(|sensor| matches!(sensor.state, State::Failed(_)))
    }

    /// How many there are of each.
    pub(crate) fn counts(&self) -> Counts {
        let of = |wanted: fn(&State) -> bool| self.sensors.iter().filter(|sensor| wanted(&sensor.state)).count();
        Counts { done: of(|state| *state == State::Done), failed: of(|state| matches!(state, State::Failed(_))) }
    }

    /// The unit id of the next new device.
    pub(crate) fn next_unit(&self) -> Option<u8> {
        self.setup.addresses.next(&self.used())
    }

    /// Unit ids that are given away.
    fn used(&self) -> Vec<u8> {
        let given = self.sensors.iter().filter(|sensor| sensor.state != State::LeftOut).map(|sensor| sensor.unit);
        given.chain(self.occupied.iter().copied()).collect()
    }

    /// Begins with a new device, or again with the one at `place`. Nothing while one is under way.
    pub(crate) fn begin(&mut self, profile: &Profile, unix_ms: u64, name: &str, place: Option<usize>) -> Action {
        if self.under_way().is_some() {
            return Action::Rest;
        }
        // A unit id that was free again may be somebody else's now.
        if let Some(sensor) =
            place.and_then(|place| self.sensors.get_mut(place)).filter(|one| one.state == State::LeftOut)
        {
            sensor.unit = 0;
        }
        let next = self.next_unit();
        let place = place.unwrap_or_else(|| {
            let (name, state) = (name.trim().to_owned(), failed(Failure::NoUnitLeft));
            self.sensors.push(Sensor { name, unit: 0, unix_ms, state, places: Vec::new(), snapshot: None });
            self.sensors.len() - 1
        });
        self.latest = Some(place);
        let Some(sensor) = self.sensors.get_mut(place) else { return Action::Rest };
        if sensor.unit == 0 {
            let Some(unit) = next else { return Action::Rest };
            sensor.unit = unit;
        }
        sensor.state = State::UnderWay(Stage::Finding);
        sensor.unix_ms = unix_ms;
        Action::Find(scope(profile, &sensor.places, self.setup.everywhere))
    }

    /// Takes a device as another one, though one of the series was left where it answers.
    pub(crate) fn take_anyway(&mut self, unix_ms: u64, place: usize) -> Action {
        let Some(sensor) = self.sensors.get_mut(place) else { return Action::Rest };
        let Some(reach) = sensor.places.first().copied() else { return Action::Rest };
        sensor.state = State::UnderWay(Stage::Reading);
        sensor.unix_ms = unix_ms;
        Action::Read(reach)
    }

    /// Goes on without a device that has failed: it keeps its unit id, and can be begun again later.
    pub(crate) fn put_aside(&mut self, place: usize) {
        self.latest.take_if(|latest| *latest == place);
    }

    /// Leaves a device out: its unit id is free again.
    pub(crate) fn leave_out(&mut self, place: usize) {
        self.put_aside(place);
        if let Some(sensor) = self.sensors.get_mut(place).filter(|sensor| matches!(sensor.state, State::Failed(_))) {
            sensor.state = State::LeftOut;
        }
    }

    /// Takes in what has come of the last action, and says what follows.
    pub(crate) fn hear(
        &mut self,
        profile: &Profile,
        unix_ms: u64,
        kind: Kind,
        outcome: &Result<Report, Hindrance>,
    ) -> Action {
        let Some(place) = self.under_way() else { return Action::Rest };
        let State::UnderWay(stage) = self.sensors[place].state else { return Action::Rest };
        let next = match (outcome, stage, kind) {
            (Err(why), ..) => Err(Failure::Hindered(why.clone())),
            (Ok(report), Stage::Finding, Kind::Find) => self.found(place, report),
            (Ok(report), Stage::Reading, Kind::Read) => self.read(profile, place, report),
            (Ok(report), Stage::Writing, Kind::Apply) => self.written(profile, place, report),
            (Ok(report), Stage::Checking, Kind::Read) => self.checked(profile, place, report),
            // Something else has ended.
            _ => return Action::Rest,
        };
        let sensor = &mut self.sensors[place];
        sensor.unix_ms = unix_ms;
        match next {
            Ok(action) => action,
            Err(failure) => {
                sensor.state = failed(failure);
                Action::Rest
            }
        }
    }

    fn found(&mut self, place: usize, report: &Report) -> Result<Action, Failure> {
        let (Ending::Found, Some(reach)) = (&report.ending, report.reach) else {
            return Err(ended(Stage::Finding, report));
        };
        let is_there = |sensor: &Sensor| sensor.state == State::Done && sensor.places.first() == Some(&reach);
        let before = self.sensors.iter().position(is_there);
        self.sensors[place].put_place(reach);
        if let Some(before) = before {
            return Err(Failure::SetUpBefore(before));
        }
        self.sensors[place].state = State::UnderWay(Stage::Reading);
        Ok(Action::Read(reach))
    }

    fn read(&mut self, profile: &Profile, place: usize, report: &Report) -> Result<Action, Failure> {
        let (Some(reach), Some(snapshot)) = (report.reach, &report.snapshot) else {
            return Err(ended(Stage::Reading, report));
        };
        self.sensors[place].snapshot = Some(snapshot.clone());
        self.write(profile, place, reach)
    }

    /// Writes what is wanted, or goes on if the device holds it already.
    fn write(&mut self, profile: &Profile, place: usize, reach: Reach) -> Result<Action, Failure> {
        let sensor = &mut self.sensors[place];
        let before = sensor.snapshot.clone().unwrap_or_else(|| Snapshot::empty(profile, reach));
        let before = Snapshot { reach, ..before };
        let mut edits = self.setup.edits(profile, &before, sensor.unit).map_err(Failure::Refused)?;
        edits.extend(self.setup.finish.clone());
        let plan = Plan::of(profile, &before, &edits).map_err(Failure::Refused)?;
        let open = self.setup.unconfirmed(&plan.hazards);
        if !open.is_empty() {
            return Err(Failure::Unconfirmed(open));
        }
        if plan.steps.is_empty() {
            sensor.state = State::UnderWay(Stage::Checking);
            return Ok(Action::Read(reach));
        }
        if let Some(goes) = plan.ends.filter(|goes| !sensor.places.contains(goes)) {
            sensor.places.push(goes);
        }
        sensor.state = State::UnderWay(Stage::Writing);
        Ok(Action::Apply(Box::new(Apply { reach, before, edits, plan })))
    }

    fn written(&mut self, profile: &Profile, place: usize, report: &Report) -> Result<Action, Failure> {
        match (&report.ending, report.reach) {
            (Ending::Done, Some(reach)) => {
                let sensor = &mut self.sensors[place];
                sensor.put_place(reach);
                sensor.state = State::UnderWay(Stage::Checking);
                Ok(Action::Read(reach))
            }
            // Somebody of the line has this unit id already: the next one is tried by itself.
            (Ending::Occupied(target), Some(reach)) if target.unit.0 == self.sensors[place].unit => {
                self.occupied.push(target.unit.0);
                let Some(unit) = self.next_unit() else { return Err(Failure::NoUnitLeft) };
                self.sensors[place].unit = unit;
                self.write(profile, place, reach)
            }
            _ => {
                for reach in report.candidates.iter().rev().chain(&report.reach) {
                    self.sensors[place].put_place(*reach);
                }
                Err(ended(Stage::Writing, report))
            }
        }
    }

    fn checked(&mut self, profile: &Profile, place: usize, report: &Report) -> Result<Action, Failure> {
        let (Some(reach), Some(snapshot)) = (report.reach, &report.snapshot) else {
            return Err(ended(Stage::Checking, report));
        };
        let sensor = &mut self.sensors[place];
        sensor.put_place(reach);
        let snapshot = Snapshot { name: sensor.name.clone(), ..snapshot.clone() };
        sensor.snapshot = Some(snapshot.clone());
        let edits = self.setup.edits(profile, &snapshot, sensor.unit).map_err(Failure::Refused)?;
        let plan = Plan::of(profile, &snapshot, &edits).map_err(Failure::Refused)?;
        if !plan.steps.is_empty() {
            return Err(Failure::NotHeld(plan.steps.into_iter().map(|step| step.point).collect()));
        }
        sensor.state = State::Done;
        Ok(Action::Rest)
    }

    /// As one text, for [`Self::from_json`].
    pub(crate) fn to_json(&self) -> String {
        // Nothing in it is without a form in JSON.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// What was kept; `None` for any other text. What was under way when the page was closed is not any more.
    pub(crate) fn from_json(text: &str) -> Option<Self> {
        let mut series: Self = serde_json::from_str(text).ok()?;
        for sensor in &mut series.sensors {
            if matches!(sensor.state, State::UnderWay(_)) {
                sensor.state = failed(Failure::Broken);
            }
        }
        Some(series)
    }
}

impl Sensor {
    /// It is here now, as far as is known.
    fn put_place(&mut self, reach: Reach) {
        self.places.retain(|place| *place != reach);
        self.places.insert(0, reach);
    }
}

fn failed(failure: Failure) -> State {
    State::Failed(Box::new(failure))
}

fn ended(stage: Stage, report: &Report) -> Failure {
    // What it holds stands elsewhere.
    Failure::Ended(stage, Box::new(Report { snapshot: None, ..report.clone() }))
}

/// Whether devices of this kind can be set up in a series: each needs a unit id of its own.
pub(crate) fn can_be_set_up(profile: &Profile) -> bool {
    unit_point(profile).is_some()
}

/// Where the device that was plugged in is searched: as it leaves the factory, whatever its unit id if it tells that to
/// everybody; then where it was seen before.
fn scope(profile: &Profile, places: &[Reach], everywhere: bool) -> Scope {
    let factory = Reach::of_factory(profile);
    let tells = !profile.discovery.is_empty();
    let asked = tells.then_some(Reach { unit: UnitId::BROADCAST, ..factory });
    let mut reaches: Vec<Reach> = Vec::new();
    for reach in asked.into_iter().chain([factory]).chain(places.iter().copied()) {
        if !reaches.contains(&reach) {
            reaches.push(reach);
        }
    }
    let mut units = Vec::new();
    if !tells {
        units.push(factory.unit);
        units.extend(USUAL_UNITS.map(UnitId).filter(|unit| *unit != factory.unit));
    }
    Scope { reaches, everywhere, units }
}

#[cfg(test)]
mod tests;
