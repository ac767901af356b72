//! Devices are written, and hold what was written.

mod common;

use std::time::Duration;

use buslens_bus::sim::{Lvdt, Motion};
use buslens_codec::line::Mode;
use buslens_configure::{Ending, StepOutcome, Task};
use common::{Bench, file, profile};

/// Every value that the tables of a device have, as it would be typed.
fn choices(id: &str) -> Vec<(String, String)> {
    let profile = profile(id);
    let writable = profile.points.iter().filter(|point| !point.write.is_empty());
    let all = writable.flat_map(|point| {
        let codes = point.codes.iter().map(|code| match (&code.number, &code.name) {
            (Some(number), _) => number.to_string(),
            (None, Some(name)) => name.zh.clone(),
            (None, None) => format!("0x{:04X}", code.code),
        });
        let limits = point.range.iter().flat_map(|range| [range.first.to_string(), range.last.to_string()]);
        codes.chain(limits).map(|text| (point.id.clone(), text)).collect::<Vec<_>>()
    });
    all.collect()
}

#[test]
fn every_value_of_every_table_is_written_and_held() {
    for id in ["lvdt", "gauge-cable", "level"] {
        for (point, text) in choices(id) {
            let mut bench = Bench::of(id);
            let before = bench.read();
            let edit = bench.edit(&point, &text, &before);
            let report = bench.apply(&[(&point, &text)]);
            assert_eq!(report.ending, Ending::Done, "{id} {point} = {text}: {:?}", report.steps);
            let found = bench.profile();
            let readable = !found.point(&point).unwrap().read.is_empty();
            if readable {
                assert_eq!(bench.truth(0).1.get(&point), Some(&edit.registers), "{id} {point} = {text}");
            }
            for step in &report.steps {
                let wanted = if readable { StepOutcome::Confirmed } else { step.outcome.clone() };
                assert_eq!(step.outcome, wanted, "{id} {point} = {text}");
            }
            assert!(bench.journals.is_empty(), "{id} {point}");
            assert_eq!(bench.audit.len(), report.steps.len());
            bench.assert_polls(&report);
            bench.assert_snapshot(report.snapshot.as_ref().unwrap());
        }
    }
}

#[test]
fn reading_takes_as_few_requests_as_the_device_allows() {
    for (id, requests) in [("lvdt", 4), ("gauge-cable", 0), ("level", 2)] {
        let mut bench = Bench::of(id);
        let report = bench.carry_out(Task::Read);
        assert_eq!(report.ending, Ending::Done, "{id}");
        assert_eq!(bench.asked, requests, "{id}");
        bench.assert_snapshot(report.snapshot.as_ref().unwrap());
    }
}

#[test]
fn the_line_is_changed_within_three_seconds_each_setting_alone_and_all_at_once() {
    let alone: [&[(&str, &str)]; 4] =
        [&[("baud", "115200")], &[("parity", "none")], &[("address", "247")], &[("output_mode", "ASCII")]];
    let at_once: &[(&str, &str)] =
        &[("baud", "115200"), ("parity", "none"), ("address", "247"), ("output_mode", "ASCII")];
    for answers_at_new_settings in [false, true] {
        for typed in alone.into_iter().chain([at_once]) {
            let mut lvdt = Lvdt::new(1, Motion::Rest { micrometres: -328, decidegrees: 255 });
            lvdt.answers_at_new_settings = answers_at_new_settings;
            let mut bench = Bench::new(file("lvdt"), [lvdt]);
            let report = bench.apply(typed);
            assert_eq!(report.ending, Ending::Done, "{typed:?}: {:#?}", report.steps);
            let written = bench.sent.iter().find(|(_, bytes)| bytes.get(1) == Some(&0x10)).unwrap().0;
            bench.assert_polls(&report);
            let polled = bench.polls.iter().find(|at| **at > written).unwrap();
            let took = polled.saturating_since(written);
            println!("{typed:?}, replies at new settings: {answers_at_new_settings}: {took:?}");
            assert!(took < Duration::from_secs(3), "{typed:?} took {took:?}");
            let reach = report.reach.unwrap();
            let (line, mode, unit) = (reach.line.to_string(), reach.mode, reach.unit.0);
            if typed.len() == 4 {
                assert_eq!((line.as_str(), mode, unit), ("115200 8N1", Mode::Ascii, 247));
            }
        }
    }
}
