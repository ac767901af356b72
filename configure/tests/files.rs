//! What crosses to other programs and outlives this one: files of snapshots, journals, messages.

mod common;

use buslens_codec::UnitId;
use buslens_configure::{
    Ending, FileFault, FileReason, Journal, Phase, Plan, Read, Report, Snapshot, StepState, Task, Way,
};
use common::{Bench, Trouble, profile};
use serde::de::DeserializeOwned;

const GUIDE: &str = include_str!("../../docs/snapshots.md");

fn example() -> &'static str {
    GUIDE.split("```json\n").nth(1).unwrap().split("```").next().unwrap()
}

#[test]
fn the_guides_example_is_a_snapshot_and_would_be_written_so() {
    let snapshot = Snapshot::from_json(example()).unwrap();
    assert_eq!(snapshot.name, "press 4, left");
    assert_eq!(snapshot.taken_unix_ms, common::UNIX_MS);
    assert_eq!(snapshot.registers("baud"), Some(&[3][..]));
    assert_eq!(snapshot.read("compensation"), Some(&Read::Refused(2)));
    assert_eq!(snapshot.read("sample_rate"), Some(&Read::NoAnswer));
    assert_eq!(snapshot.to_json(&profile("lvdt")), example());
}

#[test]
fn the_guide_names_every_key() {
    for key in
        ["format", "kind", "profile", "name", "taken", "reach", "data", "point", "registers", "exception", "silent"]
    {
        assert!(GUIDE.contains(&format!("| `{key}` |")) || GUIDE.contains(&format!("`{key}`")), "{key}");
    }
}

#[test]
fn every_fault_of_a_file_is_told_with_its_place() {
    let known = |keys: &[&str]| keys.iter().map(ToString::to_string).collect::<Vec<String>>();
    let top = known(&["format", "kind", "profile", "name", "taken", "reach", "data"]);
    for (old, new, line, column, reason) in [
        ("\"format\": 1", "\"format\": 2", 2, 13, FileReason::OtherFormat(2)),
        ("\"format\": 1", "\"format\": \"1\"", 2, 13, FileReason::NotANumber { first: 0, last: u64::MAX }),
        ("buslens-snapshot", "buslens-journal", 3, 11, FileReason::OtherKind),
        ("\"name\"", "\"nome\"", 5, 3, FileReason::UnknownKey { key: "nome".to_owned(), known: top }),
        ("\"name\"", "\"kind\"", 5, 3, FileReason::KeyTwice("kind".to_owned())),
        ("  \"profile\": \"lvdt\",\n", "", 1, 1, FileReason::MissingKey("profile".to_owned())),
        ("2026-05-04", "2026-02-30", 6, 12, FileReason::NotATime),
        ("\"unit\": 1", "\"unit\": 256", 7, 22, FileReason::NotANumber { first: 0, last: 255 }),
        ("\"even\", \"stop", "\"mark\", \"stop", 7, 71, FileReason::NoneOf(known(&["none", "odd", "even"]))),
        ("[\"0x0003\"]", "[3]", 10, 38, FileReason::NotAText),
        ("[\"0x0003\"]", "[\"0x03\"]", 10, 38, FileReason::NotRegisters),
        ("[\"0x0003\"]", "[]", 10, 37, FileReason::NotRegisters),
        ("[\"0x0003\"]", "\"0x0003\"", 10, 37, FileReason::NotAList),
        ("\"exception\": 2", "\"exception\": 2, \"silent\": true", 12, 5, FileReason::NotOneResult),
        ("\"silent\": true", "\"silent\": false", 13, 5, FileReason::NotOneResult),
        ("sample_rate", "baud", 13, 5, FileReason::PointTwice("baud".to_owned())),
        ("\"data\": [", "\"data\": [ 7,", 8, 13, FileReason::NotAnObject),
    ] {
        let text = example().replacen(old, new, 1);
        assert_ne!(text, example(), "{old}");
        assert_eq!(Snapshot::from_json(&text), Err(FileFault { line, column, reason }), "{new}");
    }
    let reason = |text: &str| Snapshot::from_json(text).unwrap_err().reason;
    assert_eq!(reason(""), FileReason::EndsEarly);
    assert_eq!(reason("{} {}"), FileReason::Trailing);
    assert_eq!(reason("位移"), FileReason::NotJson);
    assert_eq!(reason(&"[".repeat(1 << 20)), FileReason::TooLarge);
    assert_eq!(reason(&" ".repeat((1 << 20) + 1)), FileReason::TooLarge);
}

/// What is read of what was written in few bytes.
fn crossed<T: serde::Serialize + DeserializeOwned>(value: &T) -> T {
    postcard::from_bytes(&postcard::to_allocvec(value).unwrap()).unwrap()
}

#[test]
fn everything_crosses_to_another_program_as_it_is() {
    let mut bench = Bench::of("lvdt");
    bench.trouble_after(1, Trouble::ReplyLost);
    let before = bench.read();
    let edits = vec![bench.edit("baud", "2400", &before), bench.edit("address", "9", &before)];
    let plan = Plan::of(&bench.profile(), &before, &edits).unwrap();
    assert_eq!(crossed(&plan), plan);
    let confirmed = plan.hazards;
    let task = Task::Apply { before, edits, confirmed };
    assert_eq!(crossed(&task), task);
    let report: Report = bench.carry_out(task);
    assert_eq!(report.ending, Ending::Done);
    assert_eq!(crossed(&report), report);
    assert!(bench.told.iter().any(|told| matches!(told.phase, Phase::Following(reach) if reach.unit == UnitId(9))));
    assert!(bench.told.iter().all(|told| crossed(told) == *told));
    assert!(bench.audit.iter().all(|entry| crossed(entry) == *entry));
}

#[test]
fn a_journal_is_kept_as_a_text_that_later_pages_read() {
    let mut bench = Bench::of("level");
    bench.trouble_after(0, Trouble::Reload);
    let before = bench.read();
    let edits = vec![bench.edit("zero_offset", "0.5", &before)];
    let procedure = bench.begin(Task::Apply { before, edits, confirmed: Vec::new() });
    assert!(bench.run(procedure).is_none());
    let journal = bench.journals.values().next().unwrap().clone();
    assert_eq!(journal.steps[0].state, StepState::Sent);
    assert_eq!(Journal::from_json(&journal.to_json()), Some(journal.clone()));
    assert_eq!(Journal::from_json("{}"), None);
    // A journal whose profile has changed meanwhile is refused, and stays.
    let mut changed = journal.clone();
    changed.file = changed.file.replace("zero_offset", "offset");
    bench.device = changed.device().unwrap();
    let report = bench.carry_out(Task::Recover { journal: changed, way: Way::Undo });
    assert_eq!((report.ending, report.journal), (Ending::BadJournal, Some(journal.id)));
    assert_eq!(bench.recover(Way::Undo).ending, Ending::Undone);
}
