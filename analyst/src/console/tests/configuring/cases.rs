//! What becomes of a device, and what is kept of it.

use super::*;

#[test]
fn parameters_are_read_while_the_polling_goes_on() {
    let mut bench = Bench::new();
    bench.pass(Duration::from_secs(1));
    let (polls, began) = (bench.polls, bench.now);
    let report = bench.run(Task::Read);
    assert_eq!((report.ending, bench.written()), (Ending::Done, vec![]));
    let snapshot = report.snapshot.unwrap();
    assert_eq!(snapshot.registers("baud"), Some([3].as_slice()));
    assert_eq!(snapshot.taken_unix_ms / 1000, UNIX_US / 1_000_000 + 1);
    assert!(bench.polls > polls || bench.now.saturating_since(began) < Duration::from_millis(500));
    assert!(bench.state.polling);
}

#[test]
fn a_journal_is_kept_before_the_first_write() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("sample_rate", "0x0006")]);
    bench.slow = true;
    bench.begin(task);
    bench.pass(Duration::from_secs(3));
    let waits = bench.waiting.iter().any(|order| matches!(order, ToStore::Keep { .. }));
    assert_eq!((waits, bench.written()), (true, vec![]), "nothing leaves while the journal is not on the disk");
    bench.slow = false;
    bench.settle();
    let report = bench.finish();
    assert_eq!(report.ending, Ending::Done);
    let kept = bench.done.iter().position(|done| matches!(done, Done::Kept(_))).unwrap();
    let first = bench.written()[0].clone();
    let wrote = bench.done.iter().position(|done| *done == Done::Sent(Origin::Configuration, first.clone())).unwrap();
    assert!(kept < wrote);
    assert!(bench.done.iter().any(|done| matches!(done, Done::Forgotten(_))) && bench.journals.is_empty());
    assert_eq!(bench.read().registers("sample_rate"), Some([6].as_slice()));
}

#[test]
fn without_a_journal_nothing_is_written_and_the_reason_is_told() {
    for fault in [StoreFault::Unavailable, StoreFault::Full] {
        let mut bench = Bench::new();
        let task = bench.wish(&[("compensation", "1")]);
        bench.fault = Some(fault.clone());
        bench.begin(task);
        let limit = bench.now + Duration::from_mins(1);
        while bench.report().is_none() && bench.step(limit) {}
        assert!(bench.news.contains(&FromConfigure::Store(Some(fault))));
        assert_eq!(bench.finish().ending, Ending::NotKept);
        assert_eq!((bench.written(), bench.wire.device_mut(0).unwrap().flash_writes()), (vec![], 0));
        // Once there is room again, all is well.
        bench.fault = None;
        let task = bench.wish(&[("compensation", "1")]);
        assert_eq!(bench.run(task).ending, Ending::Done);
    }
}

#[test]
fn the_line_and_the_polling_follow_the_device() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("address", "247"), ("baud", "115200"), ("parity", "none"), ("output_mode", "ASCII")]);
    let report = bench.run(task);
    assert_eq!(report.ending, Ending::Done);
    let reach = report.reach.unwrap();
    assert_eq!((reach.unit.0, reach.line.baud, reach.mode), (247, 115_200, Mode::Ascii));
    assert_eq!(bench.reach(), reach);
    assert!(bench.state.polling && bench.done.contains(&Done::Unit(247)));
    let polls = bench.polls;
    bench.pass(Duration::from_secs(2));
    assert!(bench.polls > polls, "the device is read where it is now");
}

#[test]
fn what_a_closed_page_has_left_is_offered_and_finished_or_undone() {
    for way in [Way::Finish, Way::Undo] {
        let mut bench = Bench::new();
        let task = bench.wish(&[("compensation", "1"), ("baud", "19200")]);
        bench.begin(task);
        let limit = bench.now + Duration::from_mins(1);
        while bench.written().len() < 2 {
            assert!(bench.step(limit), "{:?}", bench.done);
        }
        // The page is gone, and its lock with it. What is on the wire still arrives.
        bench.console = Console::new();
        bench.pass(Duration::from_secs(1));
        bench.news.clear();
        bench.state.polling = true;
        bench.set_poll();
        bench.attach();
        let [id] = bench.offered()[..] else { panic!("{:?}", bench.offered()) };
        bench.hear(ToConfigure::Recover { run: 7, journal: id, way });
        let report = bench.finish();
        let ending = if way == Way::Finish { Ending::Done } else { Ending::Undone };
        assert_eq!(report.ending, ending);
        let snapshot = bench.read();
        let held = ["compensation", "baud"].map(|point| snapshot.registers(point).unwrap()[0]);
        assert_eq!(held, if way == Way::Finish { [1, 4] } else { [2, 3] });
        assert_eq!((bench.journals.len(), bench.offered().len()), (0, 0));
        let polls = bench.polls;
        bench.pass(Duration::from_secs(2));
        assert!(bench.polls > polls);
    }
}

#[test]
fn a_lost_port_leaves_the_journal_to_be_gone_on_from() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("baud", "19200")]);
    bench.begin(task);
    let limit = bench.now + Duration::from_mins(1);
    while bench.written().len() < 2 {
        assert!(bench.step(limit));
    }
    bench.unplugged = true;
    bench.master.handle_link(bench.now, LinkEvent::Lost);
    bench.settle();
    let report = bench.finish();
    assert_eq!(report.ending, Ending::Interrupted);
    let id = report.journal.unwrap();
    bench.hear(ToConfigure::Recover { run: 7, journal: id, way: Way::Finish });
    assert_eq!(bench.refusal(), Some(&Hindrance::NoPort));
    bench.pass(Duration::from_secs(1));
    bench.unplugged = false;
    bench.master.handle_link(bench.now, LinkEvent::Plugged);
    bench.settle();
    assert!(!bench.held.contains(&id));
    bench.hear(ToConfigure::Recover { run: 7, journal: id, way: Way::Finish });
    assert_eq!(bench.finish().ending, Ending::Done);
}

#[test]
fn a_journal_that_another_page_works_on_is_left_to_it() {
    let mut bench = Bench::new();
    bench.held.insert(5);
    for (journal, why) in [(5, Hindrance::JournalHeld), (6, Hindrance::JournalGone)] {
        bench.hear(ToConfigure::Recover { run: 7, journal, way: Way::Undo });
        assert_eq!(bench.refusal(), Some(&why));
    }
    assert!(!bench.console.configuring.is_busy());
}

#[test]
fn nothing_is_begun_where_it_could_not_be_done() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1")]);
    // Only reads are let out: reading is still possible.
    bench.console.hear(bench.now, ToConsole::Line(ToLine::ReadOnly(true)));
    bench.settle();
    bench.begin(task.clone());
    assert_eq!(bench.refusal(), Some(&Hindrance::ReadOnly));
    bench.hear(ToConfigure::Recover { run: 7, journal: 1, way: Way::Undo });
    assert_eq!(bench.refusal(), Some(&Hindrance::ReadOnly));
    assert_eq!(bench.run(Task::Read).ending, Ending::Done);
    bench.console.hear(bench.now, ToConsole::Line(ToLine::ReadOnly(false)));
    bench.settle();
    // A replay.
    let replay = LineState { replay: true, open: false, ..bench.state.clone() };
    bench.console.hear_line(bench.now, UNIX_US, FromLine::State(replay));
    bench.begin(task.clone());
    assert_eq!(bench.refusal(), Some(&Hindrance::Replay));
    bench.told_state = None;
    bench.settle();
    // A profile with a fault.
    let reach = bench.reach();
    bench.hear(ToConfigure::Begin { run: 7, task: Task::Read, profile: "{\n]".into(), reach });
    assert!(matches!(bench.refusal(), Some(Hindrance::Profile(fault)) if fault.line == 2), "{:?}", bench.refusal());
    // Something else is under way.
    bench.begin(task.clone());
    bench.begin(Task::Read);
    assert_eq!(bench.refusal(), Some(&Hindrance::Busy));
    assert_eq!(bench.finish().ending, Ending::Done);
    // A hand or a sequence is at work.
    bench.console.hear(bench.now, ToConsole::Send(sending(3, every(10_000, None, Until::Never))));
    bench.settle();
    bench.begin(Task::Read);
    assert_eq!(bench.refusal(), Some(&Hindrance::Sending));
    bench.console.hear(bench.now, ToConsole::StopSending);
    bench.pass(Duration::from_secs(1));
    let (text, profile) = ("wait 60 s\n".to_owned(), String::new());
    bench.console.hear(bench.now, ToConsole::Run { edition: 1, text, profile, unit: 1 });
    bench.settle();
    bench.begin(Task::Read);
    assert_eq!(bench.refusal(), Some(&Hindrance::Sequence));
}

#[test]
fn nobody_else_sends_while_a_device_is_configured() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1")]);
    bench.begin(task);
    bench.others.clear();
    bench.console.hear(bench.now, ToConsole::Send(sending(9, None)));
    let (text, profile) = (String::from("send 01\n"), String::new());
    bench.console.hear(bench.now, ToConsole::Run { edition: 4, text, profile, unit: 1 });
    bench.console.hear(bench.now, ToConsole::Line(ToLine::Poll(true)));
    bench.console.hear(bench.now, ToConsole::Replay { speed_permille: 0, profile: String::new() });
    bench.settle();
    assert_eq!(ending(&bench.others), Some((9, 0, End::Busy)));
    assert!(bench.others.contains(&FromConsole::NotRun { edition: 4 }));
    assert!(!bench.state.polling, "the line is the procedure's");
    assert_eq!(bench.finish().ending, Ending::Done);
    let by_others = |done: &Done| matches!(done, Done::Sent(Origin::Console | Origin::Sequence, _));
    assert!(!bench.done.iter().any(by_others));
}

#[test]
fn what_is_cancelled_leaves_the_line_quiet_and_as_it_was() {
    let mut bench = Bench::new();
    // Nobody answers any more.
    bench.wire.faults.lost_replies = u32::MAX;
    let before = (bench.reach(), bench.state.polling);
    bench.begin(Task::Find {
        scope: Scope { reaches: Vec::new(), everywhere: true, units: (1..=20).map(UnitId).collect() },
    });
    bench.pass(Duration::from_secs(5));
    assert!(bench.report().is_none());
    bench.hear(ToConfigure::Cancel);
    let report = bench.finish();
    assert_eq!(report.ending, Ending::Cancelled);
    bench.settle();
    assert_eq!((bench.reach(), bench.state.polling), before);
    bench.done.clear();
    bench.pass(Duration::from_secs(5));
    assert!(!bench.done.iter().any(|done| matches!(done, Done::Sent(Origin::Configuration, _))));
}

#[test]
fn progress_comes_at_display_rate_and_the_report_at_once() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("sample_rate", "0x0006"), ("baud", "57600")]);
    let began = bench.now;
    let report = bench.run(task);
    assert_eq!(report.ending, Ending::Done);
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("sample_rate", "0x0006"), ("baud", "57600")]);
    bench.begin(task);
    let limit = bench.now + Duration::from_mins(1);
    while bench.report().is_none() {
        assert!(bench.step(limit));
    }
    let told = bench.news.iter().filter(|news| matches!(news, FromConfigure::Progress { .. })).count();
    let most = bench.now.saturating_since(began).as_millis() / 60 + 2;
    assert!(told >= 2 && told as u128 <= most, "{told}");
}

#[test]
fn every_write_is_counted_and_goes_with_the_device_to_its_new_unit_id() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("address", "9")]);
    assert_eq!(bench.run(task).ending, Ending::Done);
    assert_eq!((bench.count(1), bench.count(9)), (0, 2));
    let key = DeviceKey { profile: bench.profile.id.clone(), unit: 9, simulated: false };
    bench.hear(ToConfigure::Device(Some(key)));
    // A hand writes, too, and reads.
    let by_hand = |unit: u8, pdu: &[u8]| buslens_codec::rtu::encode(UnitId(unit), pdu).unwrap();
    for (id, bytes) in [(1, by_hand(9, &[5, 0, 0x50, 0xFF, 0])), (2, by_hand(9, &[3, 0, 0x31, 0, 1]))] {
        bench.console.hear(bench.now, ToConsole::Send(Sending { id, bytes, wait_ms: None, repeat: None }));
        bench.settle();
        bench.pass(Duration::from_secs(1));
    }
    assert_eq!(bench.count(9), 3);
    let rows: Vec<_> =
        bench.audit.iter().map(|row| (row.origin, row.entry.point.as_str(), row.entry.reach.unit.0)).collect();
    let [configured @ .., (Origin::Console, "", 9)] = rows.as_slice() else { panic!("{rows:?}") };
    assert_eq!(configured, [(Origin::Configuration, "compensation", 1), (Origin::Configuration, "address", 1)]);
    let frames: Vec<_> = bench.audit.iter().take(2).map(|row| row.entry.sent.clone()).collect();
    assert_eq!(frames, bench.written());
    assert_eq!(bench.audit[0].entry.old, Some(vec![2]));
    assert_eq!(bench.audit[2].entry.new, [0xFF00]);
    // What only reads are let out for has not left.
    bench.console.hear(bench.now, ToConsole::Line(ToLine::ReadOnly(true)));
    let bytes = by_hand(9, &[5, 0, 0x50, 0xFF, 0]);
    bench.console.hear(bench.now, ToConsole::Send(Sending { id: 3, bytes, wait_ms: None, repeat: None }));
    bench.settle();
    bench.pass(Duration::from_secs(1));
    assert_eq!((bench.count(9), bench.audit.len()), (3, 3));
}

#[test]
fn the_audit_log_is_shown_newest_first_and_as_it_grows() {
    let mut bench = Bench::new();
    bench.hear(ToConfigure::Audit { filter: AuditFilter::default(), from: 0, count: 1 });
    let task = bench.wish(&[("compensation", "1"), ("sample_rate", "0x0006")]);
    bench.begin(task);
    let limit = bench.now + Duration::from_mins(1);
    while bench.report().is_none() {
        assert!(bench.step(limit));
    }
    let pages = bench.news.iter().filter_map(|news| match news {
        FromConfigure::Audit(page) => Some((page.total, page.rows.first().map(|row| row.entry.point.clone()))),
        _ => None,
    });
    assert_eq!(pages.collect::<Vec<_>>().last(), Some(&(2, Some("sample_rate".to_owned()))));
    let unit = Some(8);
    bench.hear(ToConfigure::Audit { filter: AuditFilter { unit, ..AuditFilter::default() }, from: 0, count: 9 });
    assert!(matches!(bench.news.last(), Some(FromConfigure::Audit(page)) if page.total == 0 && page.rows.is_empty()));
    bench.hear(ToConfigure::ExportAudit { filter: AuditFilter::default(), form: AuditForm::JsonLines });
    let Some(text) = bench.news.iter().rev().find_map(|news| match news {
        FromConfigure::AuditFile(AuditForm::JsonLines, text) => Some(text),
        _ => None,
    }) else {
        panic!("{:?}", bench.news)
    };
    assert_eq!(text.lines().count(), 2);
    assert!(text.contains("\"point\":\"compensation\""));
}
