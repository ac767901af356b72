//! Sequences that the console runs.

use buslens_sequence::{Ended, Mark, Report, Verdict};

use super::super::Running;
use super::*;

const SEQUENCE: &str =
    "send 01 03 00 31 00 01 crc\nexpect 01 03 02 00 07 CRC\nwait 100 ms\nexpect 01 03 02 00 08 CRC\n";

fn run(console: &mut Console, now: Instant, text: &str) -> (Vec<ToLine>, Vec<FromConsole>) {
    let (text, profile) = (text.to_owned(), String::new());
    console.hear(now, ToConsole::Run { edition: 3, text, profile, unit: 1 });
    drain(console)
}

/// The report that the window has put together, and how often it was told of it.
fn report(news: &[FromConsole]) -> (Report, usize) {
    let changes = news.iter().filter_map(|news| match news {
        FromConsole::Run { edition: 3, changes } => Some(changes.clone()),
        _ => None,
    });
    let mut report = Report::default();
    let count = changes.map(|changes| report.apply(changes)).count();
    (report, count)
}

/// Lets time pass until something is to be sent, or the sequence is over.
fn pass_time(console: &mut Console, now: &mut Instant, news: &mut Vec<FromConsole>) -> Vec<ToLine> {
    while console.running.is_some() {
        let (orders, told) = drain(console);
        news.extend(told);
        if !orders.is_empty() {
            return orders;
        }
        *now = (*now).max(console.running.as_ref().and_then(Running::due).unwrap_or(*now));
        console.handle_time(*now);
    }
    let (orders, told) = drain(console);
    news.extend(told);
    orders
}

#[test]
fn a_sequence_is_checked_and_its_faults_are_told() {
    let mut console = attached();
    let text = "send 01 03\nfrobnicate\n".to_owned();
    console.hear(ms(0), ToConsole::Check { edition: 9, text: text.clone(), profile: String::new() });
    let (orders, news) = drain(&mut console);
    let [FromConsole::Checked { edition: 9, faults, .. }] = news.as_slice() else { panic!("{news:?}") };
    assert_eq!((orders.len(), faults[0].line), (0, 2));
    // With a fault nothing of it is run.
    let (orders, news) = run(&mut console, ms(0), &text);
    assert_eq!((orders.len(), console.running.is_some()), (0, false));
    assert!(matches!(news.as_slice(), [FromConsole::Checked { edition: 3, faults, .. }] if !faults.is_empty()));
}

#[test]
fn a_sequence_runs_beside_what_a_hand_sends() {
    let mut console = attached();
    let (orders, mut news) = run(&mut console, ms(0), SEQUENCE);
    let [ToLine::Send { id, origin: Origin::Sequence, bytes, .. }] = orders.as_slice() else { panic!("{orders:?}") };
    assert_eq!(*bytes, REQUEST);
    console.hear(ms(1), ToConsole::Send(sending(7, None)));
    let by_hand = asked(&mut console).unwrap();
    assert_ne!(by_hand, *id);
    news.extend(answer(&mut console, ms(30), by_hand, outcome(End::Silence, &[])));
    news.extend(answer(&mut console, ms(40), *id, outcome(End::Answered, &REPLY)));
    let mut now = ms(40);
    assert_eq!(pass_time(&mut console, &mut now, &mut news), []);
    let (report, told) = report(&news);
    assert_eq!((report.summary.verdict, report.summary.ended), (Verdict::Failed, Some(Ended::Finished)));
    let marks: Vec<_> = report.entries.iter().map(|entry| (entry.line, entry.mark)).collect();
    assert_eq!(marks, [(1, Mark::Passed), (2, Mark::Passed), (3, Mark::Passed), (4, Mark::Failed)]);
    assert!(now >= ms(140) && told <= 5, "{now:?} {told}");
    assert_eq!(ending(&news), Some((7, 1, End::Silence)));
}

#[test]
fn a_sequence_ends_with_its_line_and_its_report_stays() {
    let mut console = attached();
    let (orders, mut news) = run(&mut console, ms(0), SEQUENCE);
    let [ToLine::Send { id, .. }] = orders.as_slice() else { panic!("{orders:?}") };
    news.extend(answer(&mut console, ms(30), *id, outcome(End::Answered, &REPLY)));
    console.hear_line(ms(50), 0, FromLine::State(LineState { open: false, ..state(false) }));
    let (orders, told) = drain(&mut console);
    news.extend(told);
    let (report, _) = report(&news);
    assert_eq!((orders, report.summary.ended), (vec![], Some(Ended::PortLost)));
    assert_eq!(report.entries.iter().filter(|entry| entry.mark == Mark::Passed).count(), 2);
    assert!(console.running.is_none());
}

#[test]
fn a_sequence_is_stopped_and_takes_back_what_was_not_sent() {
    let mut console = attached();
    let (orders, mut news) = run(&mut console, ms(0), SEQUENCE);
    let [ToLine::Send { id, .. }] = orders.as_slice() else { panic!("{orders:?}") };
    let id = *id;
    console.hear(ms(5), ToConsole::Stop);
    let (orders, told) = drain(&mut console);
    news.extend(told);
    assert_eq!((orders, report(&news).0.summary.ended), (vec![ToLine::Withdraw(id)], Some(Ended::Stopped)));
    // What the engine still says of it is for nobody.
    assert_eq!(answer(&mut console, ms(6), id, outcome(End::Withdrawn, &[])), []);
}

#[test]
fn a_sequence_waits_for_the_line_with_other_settings() {
    let mut console = attached();
    let (orders, mut news) = run(&mut console, ms(0), "line 115200\nsend 01 03 00 31 00 01 crc\n");
    let [ToLine::Settings { line, buffer_bytes: 8192, .. }] = orders.as_slice() else { panic!("{orders:?}") };
    assert_eq!(line.baud, 115_200);
    let line = *line;
    console.hear_line(ms(1), 0, FromLine::State(LineState { open: false, line, ..state(false) }));
    assert_eq!(drain(&mut console).0, []);
    console.hear_line(ms(2), 0, FromLine::State(LineState { line, ..state(false) }));
    let mut now = ms(2);
    let orders = pass_time(&mut console, &mut now, &mut news);
    assert!(matches!(orders.as_slice(), [ToLine::Send { .. }]), "{orders:?}");
}
