//! Whatever is written, and whatever goes wrong with it: the device is never lost, and no report is untrue.

mod common;

use buslens_bus::sim::{Course, Device, Level, Lvdt, Motion};
use buslens_codec::UnitId;
use buslens_configure::{Datum, Edit, Ending, Plan, Reach, Read, Report, Scope, Snapshot, Task, Way};
use common::{Bench, Trouble, file, profile, sensor};
use proptest::prelude::*;

/// Points with values that the device takes, chosen by numbers.
fn edits(bench: &Bench, before: &Snapshot, choices: &[(usize, usize)]) -> Vec<Edit> {
    let profile = bench.profile();
    let writable: Vec<_> = profile.points.iter().filter(|point| !point.write.is_empty()).collect();
    let mut all: Vec<Edit> = Vec::new();
    for (point, value) in choices {
        let point = writable[point % writable.len()];
        let codes = point.codes.iter().map(|code| format!("0x{:04X}", code.code));
        let numbers = (1..=9).map(|number| number.to_string());
        let typed: Vec<String> = if point.codes.is_empty() { numbers.collect() } else { codes.collect() };
        let edit = bench.edit(&point.id, &typed[value % typed.len()], before);
        if all.iter().all(|other| other.point != point.id) {
            all.push(edit);
        }
    }
    all
}

fn bench(device: usize, new_settings: bool) -> Bench {
    match (device, new_settings) {
        (0, false) => Bench::of("lvdt"),
        (0, true) => {
            let mut lvdt = Lvdt::new(1, Motion::Rest { micrometres: 5, decidegrees: 5 });
            lvdt.answers_at_new_settings = true;
            let lvdt: Box<dyn Device> = Box::new(lvdt);
            Bench::new(file("lvdt"), [lvdt])
        }
        (1, keeps_unsaved) => {
            let mut level = Level::new(1, Course::Rest(5));
            (level.keeps_unsaved, level.answers_blocks) = (keeps_unsaved, !keeps_unsaved);
            let level: Box<dyn Device> = Box::new(level);
            Bench::new(file("level"), [level])
        }
        _ => Bench::new(file("gauge-cable"), [sensor("gauge-cable")]),
    }
}

fn ended(bench: &mut Bench, report: Option<Report>) {
    if let Some(report) = report {
        bench.assert_true(&report);
    }
    if bench.unplugged {
        bench.replug();
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn no_device_is_ever_lost(
        device in 0usize..3,
        new_settings: bool,
        choices in prop::collection::vec((0usize..16, 0usize..16), 1..6),
        troubles in prop::collection::vec((0usize..7, 0usize..Trouble::ALL.len()), 0..4),
        ways in prop::collection::vec(any::<bool>(), 4),
        lost in 0u32..3,
    ) {
        let mut bench = bench(device, new_settings);
        let before = bench.read();
        let edits = edits(&bench, &before, &choices);
        // Two commands that lose the settings are refused by the plan.
        prop_assume!(Plan::of(&bench.profile(), &before, &edits).is_ok());
        let confirmed = bench.hazards(&before, &edits);
        for (write, trouble) in troubles {
            bench.trouble_after(write, Trouble::ALL[trouble]);
        }
        bench.wire.faults.lost_replies = lost;
        let procedure = bench.begin(Task::Apply { before, edits, confirmed });
        let report = bench.run(procedure);
        ended(&mut bench, report);
        for finish in ways {
            let Some(journal) = bench.journals.values().next().cloned() else { break };
            let way = if finish { Way::Finish } else { Way::Undo };
            bench.device = journal.device().unwrap();
            let procedure = bench.begin(Task::Recover { journal, way });
            let report = bench.run(procedure);
            ended(&mut bench, report);
        }
        // At last nothing goes wrong any more.
        bench.troubles.clear();
        if !bench.journals.is_empty() {
            let report = bench.recover(Way::Undo);
            prop_assert!(matches!(report.ending, Ending::Undone), "{:?}", report.ending);
            ended(&mut bench, Some(report));
        }
        prop_assert!(bench.journals.is_empty());
        let units = (1..=9).map(UnitId).collect();
        let report = bench.carry_out(Task::Find { scope: Scope { reaches: Vec::new(), everywhere: true, units } });
        prop_assert_eq!(&report.ending, &Ending::Found);
        bench.assert_polls(&report);
    }

    #[test]
    fn a_snapshots_file_is_read_as_it_was_written(
        name in ".{0,20}",
        taken_unix_ms in 0u64..253_402_300_799_999,
        unit: u8,
        line in 0usize..42,
        reads in prop::collection::vec(prop_oneof![
            prop::collection::vec(any::<u16>(), 1..=16).prop_map(Read::Registers),
            (1u8..).prop_map(Read::Refused),
            Just(Read::NoAnswer),
        ], 0..9),
    ) {
        let profile = profile("lvdt");
        let (line, mode) = profile.line_candidates()[line];
        let ids = profile.points.iter().map(|point| point.id.clone()).chain((0..).map(|number| format!("other-{number}")));
        let data = ids.zip(reads).map(|(point, read)| Datum { point, read }).collect();
        let reach = Reach { unit: UnitId(unit), line, mode };
        let snapshot = Snapshot { profile: profile.id.clone(), name, taken_unix_ms, reach, data };
        let text = snapshot.to_json(&profile);
        prop_assert_eq!(Snapshot::from_json(&text), Ok(snapshot));
    }

    #[test]
    fn no_text_panics(text in ".{0,200}", at in 0usize..900, other in any::<char>()) {
        let _ = Snapshot::from_json(&text);
        let profile = profile("level");
        let snapshot = Snapshot { name: text.clone(), ..Snapshot::empty(&profile, Reach::of_factory(&profile)) };
        // Without the line's end behind it: cut there, it would be whole.
        let written: Vec<char> = snapshot.to_json(&profile).trim_end().chars().collect();
        let at = at % written.len();
        let spoiled: String = written[..at].iter().chain([&other]).chain(&written[at + 1..]).collect();
        let _ = Snapshot::from_json(&spoiled);
        let cut: String = written[..at].iter().collect();
        prop_assert!(Snapshot::from_json(&cut).is_err());
        for point in &profile.points {
            let _ = Edit::parse(&profile, point, &text, &snapshot);
        }
    }

    #[test]
    fn whatever_can_be_typed_is_what_the_device_takes(device in 0usize..3, point in 0usize..20, register: u16) {
        let bench = bench(device, false);
        let profile = bench.profile();
        let writable: Vec<_> = profile.points.iter().filter(|point| !point.write.is_empty()).collect();
        let point = writable[point % writable.len()];
        let have = Snapshot::empty(&profile, bench.device.reach);
        let typed = Edit::parse(&profile, point, &format!("0x{register:04X}"), &have);
        let edit = Edit { point: point.id.clone(), registers: vec![register] };
        prop_assert_eq!(typed.is_ok(), Plan::of(&profile, &have, &[edit]).is_ok());
    }
}
