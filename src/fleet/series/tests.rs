use buslens_configure::{Datum, Read, StepOutcome, Why};

use super::*;
use crate::device;
use crate::fleet::addresses::Addresses;

fn profile() -> &'static Profile {
    device::first().profile()
}

fn series(first: &str) -> Series {
    let setup = Setup {
        profile: profile().id.clone(),
        addresses: Addresses::parse(profile(), first, "1", "").unwrap(),
        settings: vec![("baud".to_owned(), "19200".to_owned()), ("sample_rate".to_owned(), "50".to_owned())],
        finish: None,
        everywhere: false,
        accepted: Vec::new(),
    };
    Series::new(1, setup)
}

fn at(unit: u8, baud: u32) -> Reach {
    let mut reach = Reach { unit: UnitId(unit), ..Reach::of_factory(profile()) };
    reach.line.baud = baud;
    reach
}

// As it comes from the worker.
#[allow(clippy::unnecessary_wraps)]
fn report(ending: Ending, reach: Option<Reach>, snapshot: Option<Snapshot>) -> Result<Report, Hindrance> {
    Ok(Report {
        ending,
        steps: Vec::new(),
        reach,
        candidates: Vec::new(),
        snapshot,
        journal: None,
        writes: 0,
        took_us: 0,
    })
}

fn holds(reach: Reach, baud: u16, rate: u16) -> Snapshot {
    let mut snapshot = Snapshot::empty(profile(), reach);
    let unit = u16::from(reach.unit.0);
    for (point, register) in [("address", unit), ("baud", baud), ("parity", 2), ("sample_rate", rate)] {
        snapshot.data.push(Datum { point: point.to_owned(), read: Read::Registers(vec![register]) });
    }
    snapshot
}

/// Plays a device that does everything.
fn set_up(series: &mut Series, name: &str, place: Option<usize>) {
    let found = at(1, 9600);
    assert!(matches!(series.begin(profile(), 2, name, place), Action::Find(_)));
    let read = series.hear(profile(), 3, Kind::Find, &report(Ending::Found, Some(found), None));
    assert_eq!(read, Action::Read(found));
    let done = report(Ending::Done, Some(found), Some(holds(found, 3, 4)));
    let Action::Apply(apply) = series.hear(profile(), 4, Kind::Read, &done) else { panic!("nothing is written") };
    let goes = apply.plan.ends.unwrap();
    let check = series.hear(profile(), 5, Kind::Apply, &report(Ending::Done, Some(goes), None));
    assert_eq!(check, Action::Read(goes));
    let done = report(Ending::Done, Some(goes), Some(holds(goes, 4, 6)));
    assert_eq!(series.hear(profile(), 6, Kind::Read, &done), Action::Rest);
}

#[test]
fn devices_are_found_written_and_checked_one_after_the_other() {
    let mut series = series("10");
    for (place, name) in ["A", "B", "C"].into_iter().enumerate() {
        set_up(&mut series, name, None);
        assert_eq!(series.sensors[place].state, State::Done);
    }
    let got: Vec<(&str, u8, u32)> =
        series.sensors.iter().map(|sensor| (sensor.name.as_str(), sensor.unit, sensor.places[0].line.baud)).collect();
    assert_eq!(got, [("A", 10, 19_200), ("B", 11, 19_200), ("C", 12, 19_200)]);
    assert_eq!(series.sensors[2].snapshot.as_ref().map(|snapshot| snapshot.name.as_str()), Some("C"));
    assert_eq!(series.counts(), Counts { done: 3, failed: 0 });
}

#[test]
fn the_one_that_is_there_is_asked_at_the_broadcast_address_first() {
    let Action::Find(scope) = series("10").begin(profile(), 2, "", None) else { panic!("nothing is searched") };
    assert_eq!(scope.reaches, [at(0, 9600), at(1, 9600)]);
    // One that does not tell its unit id to everybody.
    let mute =
        |device: &&'static device::Device| device.profile().discovery.is_empty() && can_be_set_up(device.profile());
    let profile = device::all().into_iter().find(mute).unwrap().profile();
    let factory = Reach::of_factory(profile);
    let scope = super::scope(profile, &[], true);
    assert_eq!((scope.reaches, scope.units.len()), (vec![factory], 16));
}

#[test]
fn an_occupied_unit_id_is_passed_over() {
    let mut series = series("10");
    let found = at(1, 9600);
    series.begin(profile(), 2, "", None);
    series.hear(profile(), 3, Kind::Find, &report(Ending::Found, Some(found), None));
    let held = report(Ending::Done, Some(found), Some(holds(found, 3, 4)));
    series.hear(profile(), 4, Kind::Read, &held);
    let occupied = report(Ending::Occupied(at(10, 19_200)), Some(found), None);
    let Action::Apply(apply) = series.hear(profile(), 5, Kind::Apply, &occupied) else { panic!("it gave up") };
    assert_eq!(apply.plan.ends, Some(at(11, 19_200)));
    assert_eq!(
        (series.occupied.as_slice(), series.sensors[0].unit, series.next_unit()),
        ([10].as_slice(), 11, Some(12))
    );
}

#[test]
fn a_failed_device_does_not_stop_the_series_and_keeps_its_unit_id() {
    let mut series = series("10");
    series.begin(profile(), 2, "A", None);
    series.hear(profile(), 3, Kind::Find, &report(Ending::NotFound { garbled: false }, None, None));
    assert!(
        matches!(&series.sensors[0].state, State::Failed(failure) if matches!(**failure, Failure::Ended(Stage::Finding, _)))
    );
    set_up(&mut series, "B", None);
    assert_eq!(series.sensors[1].unit, 11);
    set_up(&mut series, "", Some(0));
    assert_eq!((series.sensors[0].name.as_str(), series.sensors[0].unit), ("A", 10));
    assert_eq!(series.counts(), Counts { done: 2, failed: 0 });
}

#[test]
fn a_left_out_devices_unit_id_is_free_again() {
    let mut series = series("10");
    series.begin(profile(), 2, "", None);
    series.hear(profile(), 3, Kind::Find, &Err(Hindrance::NoPort));
    series.leave_out(0);
    assert_eq!((series.next_unit(), series.sensors[0].state.clone()), (Some(10), State::LeftOut));
    // Once it is given away, the one that was left out gets another one.
    set_up(&mut series, "B", None);
    set_up(&mut series, "", Some(0));
    assert_eq!((series.sensors[1].unit, series.sensors[0].unit), (10, 11));
}

#[test]
fn a_device_that_is_still_plugged_in_is_not_set_up_twice() {
    let mut series = series("10");
    set_up(&mut series, "A", None);
    let there = series.sensors[0].places[0];
    series.begin(profile(), 7, "B", None);
    let next = series.hear(profile(), 8, Kind::Find, &report(Ending::Found, Some(there), None));
    assert_eq!((next, series.sensors[1].state.clone()), (Action::Rest, failed(Failure::SetUpBefore(0))));
    assert_eq!(series.take_anyway(9, 1), Action::Read(there));
}

#[test]
fn a_device_that_holds_something_else_afterwards_has_failed() {
    let mut series = series("10");
    let (found, goes) = (at(1, 9600), at(10, 19_200));
    series.begin(profile(), 2, "", None);
    series.hear(profile(), 3, Kind::Find, &report(Ending::Found, Some(found), None));
    series.hear(profile(), 4, Kind::Read, &report(Ending::Done, Some(found), Some(holds(found, 3, 4))));
    series.hear(profile(), 5, Kind::Apply, &report(Ending::Done, Some(goes), None));
    series.hear(profile(), 6, Kind::Read, &report(Ending::Done, Some(goes), Some(holds(goes, 4, 4))));
    assert_eq!(series.sensors[0].state, failed(Failure::NotHeld(vec!["sample_rate".to_owned()])));
}

#[test]
fn a_lost_device_is_searched_where_it_may_be() {
    let mut series = series("10");
    let (found, goes) = (at(1, 9600), at(10, 19_200));
    series.begin(profile(), 2, "", None);
    series.hear(profile(), 3, Kind::Find, &report(Ending::Found, Some(found), None));
    series.hear(profile(), 4, Kind::Read, &report(Ending::Done, Some(found), Some(holds(found, 3, 4))));
    let lost = Ending::Lost(Why { step: 0, outcome: StepOutcome::Silent });
    let mut lost = report(lost, None, None);
    if let Ok(report) = &mut lost {
        report.candidates = vec![goes, at(10, 9600), found];
    }
    series.hear(profile(), 5, Kind::Apply, &lost);
    let Action::Find(scope) = series.begin(profile(), 6, "", Some(0)) else { panic!("nothing is searched") };
    assert_eq!(scope.reaches, [at(0, 9600), found, goes, at(10, 9600)]);
}

#[test]
fn dangers_that_nobody_has_confirmed_stop_the_device() {
    let mut series = series("10");
    series.setup.settings = vec![("baud".to_owned(), "2400".to_owned())];
    let found = at(1, 9600);
    series.begin(profile(), 2, "", None);
    series.hear(profile(), 3, Kind::Find, &report(Ending::Found, Some(found), None));
    let held = report(Ending::Done, Some(found), Some(holds(found, 3, 4)));
    series.hear(profile(), 4, Kind::Read, &held);
    let slow = Hazard::SlowBaud { baud: 2400 };
    assert_eq!(series.sensors[0].state, failed(Failure::Unconfirmed(vec![slow.clone()])));
    series.setup.accepted.push(slow);
    series.begin(profile(), 5, "", Some(0));
    series.hear(profile(), 6, Kind::Find, &report(Ending::Found, Some(found), None));
    assert!(matches!(series.hear(profile(), 7, Kind::Read, &held), Action::Apply(_)));
}

#[test]
fn a_series_outlives_the_page() {
    let mut series = series("10");
    set_up(&mut series, "A", None);
    series.begin(profile(), 7, "B", None);
    let kept = Series::from_json(&series.to_json()).unwrap();
    assert_eq!(kept.sensors[0], series.sensors[0]);
    assert_eq!(kept.sensors[1].state, failed(Failure::Broken));
    assert_eq!((kept.under_way(), kept.setup), (None, series.setup));
    assert_eq!(Series::from_json("{}"), None);
}

#[test]
fn no_unit_id_is_given_twice() {
    let mut series = series("247");
    set_up(&mut series, "", None);
    assert_eq!(series.begin(profile(), 7, "", None), Action::Rest);
    assert_eq!(series.sensors[1].state, failed(Failure::NoUnitLeft));
}
