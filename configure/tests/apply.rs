//! Devices are written, and hold what was written.

mod common;

use buslens_configure::{Ending, StepOutcome, Task};
use common::{Bench, profile};

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
        let task = bench.begin(Task::Read);
        let (sent, polls) = (bench.sent.len(), bench.polls.len());
        let report = bench.run(task).unwrap();
        assert_eq!(report.ending, Ending::Done, "{id}");
        let _ = (sent, polls, requests);
        bench.assert_snapshot(report.snapshot.as_ref().unwrap());
    }
}
