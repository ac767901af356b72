//! The fault matrix: every step of configuring every device, and everything that can go wrong with it. Whatever happens,
//! the report is true and the device is brought back by what a page has.
//!
//! `docs/fault-matrix.md` is made of what happens here. With the variable `BLESS` set it is written anew. The project's
//! browser tests let all of it happen once more, through the page.

mod common;

use std::fmt::Write as _;
use std::path::Path;

use buslens_bus::sim::{Device, Lvdt, Motion};
use buslens_codec::profile::{Code, Effect, Point, Profile, Role};
use buslens_configure::{Edit, Ending, Report, StepOutcome, Task, Way};
use common::{Bench, Trouble, file, profile, sensor};

/// A row of the matrix.
struct Case {
    device: &'static str,
    /// Points and values, as typed.
    edits: Vec<(String, String)>,
    /// With which of its writes it goes wrong.
    write: usize,
    /// What is written before, without trouble, so that the step changes something.
    first: Vec<(&'static str, &'static str)>,
}

/// Each step alone, then several at once.
fn cases(device: &'static str) -> Vec<Case> {
    let profile = profile(device);
    let writable = profile.points.iter().filter(|point| !point.write.is_empty());
    let all = writable.flat_map(|point| typed(&profile, point).into_iter().map(move |typed| (point, typed)));
    let case = |(point, typed): (&Point, String)| {
        let loses = point.effects.iter().any(|effect| matches!(effect, Effect::Defaults | Effect::Search));
        let first = if loses { vec![("address", "9"), ("baud", "19200")] } else { Vec::new() };
        Case { device, edits: vec![(point.id.clone(), typed)], write: 0, first }
    };
    let parameters = profile.points.iter().filter(|point| point.role == Role::Parameter && !point.write.is_empty());
    let together: Vec<(String, String)> =
        parameters.map(|point| (point.id.clone(), typed(&profile, point).remove(0))).collect();
    let at_once = (0..together.len()).map(|write| Case { device, edits: together.clone(), write, first: Vec::new() });
    all.map(case).chain(at_once).collect()
}

/// Of a parameter one value that the device does not have, of a command all.
fn typed(profile: &Profile, point: &Point) -> Vec<String> {
    let text = |code: &Code| match (&code.number, &code.name) {
        (Some(number), _) => number.to_string(),
        (None, name) => name.as_ref().unwrap().en.clone(),
    };
    if point.role == Role::Command {
        return point.codes.iter().map(text).collect();
    }
    let other = |code: &&Code| Some(code.code) != point.factory && code.number != Some(profile.line.baud);
    let most = point.range.map(|range| range.last.to_string());
    vec![point.codes.iter().rev().find(other).map(text).or(most).unwrap_or_else(|| "0.025".to_owned())]
}

/// A sensor in the state in which the step begins.
fn bench(case: &Case, new_settings: bool) -> Bench {
    let device: Box<dyn Device> = if new_settings {
        let mut lvdt = Lvdt::new(1, Motion::Rest { micrometres: -328, decidegrees: 255 });
        lvdt.answers_at_new_settings = true;
        Box::new(lvdt)
    } else {
        sensor(case.device)
    };
    let mut bench = Bench::new(file(case.device), [device]);
    if !case.first.is_empty() {
        assert_eq!(bench.apply(&case.first).ending, Ending::Done);
    }
    bench
}

/// Lets the step go wrong, and has the port there again if it was unplugged. `None` if the page was reloaded meanwhile.
fn go_wrong(case: &Case, bench: &mut Bench, trouble: Trouble) -> Option<Report> {
    let before = bench.read();
    let edits: Vec<Edit> = case.edits.iter().map(|(point, typed)| bench.edit(point, typed, &before)).collect();
    let confirmed = bench.hazards(&before, &edits);
    bench.trouble_after(case.write, trouble);
    let procedure = bench.begin(Task::Apply { before, edits, confirmed });
    let report = bench.run(procedure);
    assert!(bench.has_struck);
    assert_eq!(bench.reloaded, trouble == Trouble::Reload);
    let unplugged = matches!(trouble, Trouble::UnplugBefore | Trouble::UnplugAfter);
    assert_eq!(report.as_ref().is_some_and(|report| report.ending == Ending::Interrupted), unplugged);
    if unplugged {
        bench.replug();
    }
    report
}

/// What has happened, in the words of the table.
fn cell(case: &Case, trouble: Trouble, new_settings: bool) -> String {
    let context = format!("{} {:?} {} {trouble:?} {new_settings}", case.device, case.edits, case.write);
    let mut words = Vec::new();
    let mut first = bench(case, new_settings);
    let report = go_wrong(case, &mut first, trouble);
    if let Some(report) = &report {
        words.push(word(report));
        first.assert_true(report);
        if report.reach.is_some() {
            first.assert_polls(report);
        }
    } else {
        words.push("reloaded".to_owned());
    }
    if first.journals.is_empty() {
        assert!(report.is_some_and(|report| report.reach.is_some()), "{context}: it is lost and nothing is kept");
        return words.join("; ");
    }
    let ways = [(Way::Finish, "finish"), (Way::Undo, "undo")].map(|(way, name)| {
        let mut bench = bench(case, new_settings);
        go_wrong(case, &mut bench, trouble);
        let report = bench.recover(way);
        bench.assert_true(&report);
        bench.assert_polls(&report);
        assert!(bench.journals.is_empty(), "{context} {way:?}: {:?}", report.ending);
        format!("{name}: {}", word(&report))
    });
    words.extend(ways);
    words.join("; ")
}

fn word(report: &Report) -> String {
    let all = |outcome: &StepOutcome| report.steps.iter().all(|step| step.outcome == *outcome);
    match report.ending {
        Ending::Done if all(&StepOutcome::Acknowledged) => "acknowledged",
        Ending::Done => "done",
        Ending::Unproven(_) => "unproven",
        Ending::Undone if all(&StepOutcome::Undone) => "undone",
        Ending::Undone => "stays",
        Ending::RolledBack(_) => "rolled back",
        Ending::Partly(_) => "partly",
        Ending::Lost(_) => "lost",
        Ending::Interrupted => "interrupted",
        ref other => panic!("{other:?} is no ending of a write that went wrong"),
    }
    .to_owned()
}

fn step_of(case: &Case) -> String {
    match case.edits.as_slice() {
        [(point, typed)] => format!("`{point}` = {typed}"),
        several => format!("all {} parameters at once, write {}", several.len(), case.write + 1),
    }
}

#[test]
fn whatever_goes_wrong_the_report_is_true_and_the_device_comes_back() {
    let mut text = HEAD.to_owned();
    for device in ["lvdt", "gauge-cable", "level"] {
        let _ = writeln!(text, "\n## {}\n\n{COLUMNS}", profile(device).name.en);
        for case in cases(device) {
            let settles_open = device == "lvdt" && case.edits.len() == 1;
            let variants: &[bool] = if settles_open { &[false, true] } else { &[false] };
            let mut rows =
                variants.iter().map(|new| Trouble::ALL.map(|trouble| cell(&case, trouble, *new)).join(" | "));
            let row = rows.next().unwrap();
            let _ = writeln!(text, "| {} | {row} |", step_of(&case));
            for other in rows.filter(|other| *other != row) {
                let _ = writeln!(text, "| the same, answered at the new settings | {other} |");
            }
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/fault-matrix.md");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == text,
        "docs/fault-matrix.md is not what happens: run with BLESS=1 and look at what has changed"
    );
}

const COLUMNS: &str = "\
| step | reply lost | reply damaged | reply late | unplugged before | unplugged after | page reloaded | power cut |
| --- | --- | --- | --- | --- | --- | --- | --- |";

const HEAD: &str = "\
# What can go wrong when a device is configured

Every step of configuring every built-in device, and everything that can go wrong just then. This page is made by a test
(`configure/tests/matrix.rs`), which lets each of it happen on a simulated line, compares the report with what the device
really holds, and brings the device back with nothing but what a page has. It fails if this page says otherwise. Then every
cell happens once more through the page itself, in a browser with a serial port (`tests/tests/matrix.rs`).

| column | what happens |
| --- | --- |
| reply lost | the device does what was written, and its reply never arrives |
| reply damaged | a bit of the reply is turned |
| reply late | the reply comes 0.7 s later than usual |
| unplugged before | the adapter is unplugged when the write should leave |
| unplugged after | the adapter is unplugged after the write was carried out, before its reply |
| page reloaded | the page is closed after the write was carried out, before its reply |
| power cut | the device loses its supply after the write was carried out, before its reply, and gets it back at once |

| word | what is known | what the page says and offers |
| --- | --- | --- |
| done | everything holds, by reading it back | done; the polling goes on, at the new settings |
| acknowledged | the device said that it did; it cannot be read back | done, as the device says |
| unproven | the device is there and polled; whether the command was carried out cannot be read | it may or may not have been carried out; look at the reading, and give the command again if need be. It is never repeated by itself |
| rolled back | everything holds what it held before, by reading it back | which step failed and why; the device is as it was |
| partly | some steps hold and others do not, by reading them back | which; finish or undo |
| lost | the device did not answer any more, wherever it was looked for | where it may be, best first; search, finish or undo |
| interrupted | the port is gone; the journal tells what was being written | plug in the adapter; then finish or undo |
| reloaded | the same, found by the page when it is opened again | finish or undo |
| finish: ... | the device was found, and what was missing is written | as above |
| undo: undone | the device was found, and holds what it held before, by reading it back | undone |
| undo: stays | the device was found and polled; what was commanded cannot be undone | that it cannot |
";
