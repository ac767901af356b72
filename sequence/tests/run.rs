//! How steps go: against a simulated sensor, and against orders answered by hand.

mod common;

use std::sync::Arc;
use std::time::Duration;

use buslens_bus::record::{End, Outcome};
use buslens_bus::sim::{Device, Lvdt, Motion};
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_sequence::{
    Branch, Ended, Entry, Heard, Line, MAX_ENTRIES, Mark, Order, READY, Reason, Report, Run, Summary, Verdict, Words,
    parse,
};
use common::{Bench, START, failed, profile, sequence};
use proptest::prelude::*;

fn bench() -> Bench<Lvdt> {
    Bench::new(profile("lvdt"), Lvdt::new(1, Motion::Rest { micrometres: -328, decidegrees: 255 }))
}

/// What failed, by line.
fn reasons(report: &Report) -> Vec<(u32, Reason)> {
    failed(report).into_iter().map(|(line, entry)| (line, entry.reason.clone().unwrap())).collect()
}

#[track_caller]
fn passes(text: &str) -> Report {
    let report = bench().run(text);
    assert_eq!(reasons(&report), [], "{text}");
    assert_eq!(report.summary.verdict, Verdict::Passed);
    report
}

fn logs(report: &Report) -> Vec<&str> {
    report.entries.iter().map(|entry| entry.text.as_str()).filter(|text| !text.is_empty()).collect()
}

#[test]
fn values_are_exact_and_compare_with_what_was_kept() {
    let report = passes(
        "read displacement
         expect displacement = -0.328
         expect displacement != -0.3280001
         expect displacement between -0.328 mm and -0.328 mm
         let before = displacement
         expect displacement = before
         expect displacement < before + 0.001
         expect before - 0.1 + 0.2 = -0.228 mm
         log \"{displacement} {before + 0.1} {{x}}\"
         let before = before + 1
         expect before = 0.672",
    );
    assert_eq!(logs(&report), ["-0.328 mm", "-0.328 mm -0.228 mm {x}", "0.672 mm"]);
}

#[test]
fn codes_compare_by_number_name_and_code() {
    passes(
        "read all
         expect baud = 9600
         expect baud >= 9600 Bd
         expect baud = code 3
         expect baud != 115200
         expect parity = even
         expect parity = 偶校验
         expect parity != odd
         expect output_mode = RTU
         expect sample_rate between 5 and 10 Hz",
    );
}

#[test]
fn raw_bytes_patterns_and_registers() {
    passes(
        "send UNIT 03 00 30 00 03 crc
         expect 01 03 06 00 01 00 ?3 00 02 CRC
         expect register 0x31 = 3
         expect parity = even
         expect round trip between 1 ms and 60 ms
         send 01 03 00 30 00 03 wrong crc within 100 ms
         expect silence
         send \"hello\\r\\n\" within 100 ms
         expect silence
         read holding 0x0030 count 3
         expect ..
         expect register 0x30 + 2 = 3",
    );
    let report = bench().run("read holding 0x30\nexpect register 0x31 = 3\nexpect coil 1 = on\nexpect 01 83 .. CRC");
    let missing = |register| Reason::NotInReply(register);
    assert_eq!(reasons(&report), [(2, missing(0x31)), (3, missing(1)), (4, Reason::DoesNotFit)]);
}

#[test]
fn a_request_must_be_answered_unless_the_next_step_says_otherwise() {
    let silence = |line| (line, Reason::NoReply(Heard::Silence));
    let report = bench().run("read displacement unit 9\nlog \"x\"\nread temperature unit 9\nexpect silence");
    assert_eq!(reasons(&report), [silence(1)]);
    let report =
        bench().run("read input 4 count 1\nread input 4 count 1\nexpect exception\nread input 4\nexpect exception 03");
    let exception = Heard::Exception(2);
    assert_eq!(reasons(&report), [(1, Reason::NoReply(exception)), (5, Reason::OtherwiseHeard(exception))]);
    let report = bench().run("read displacement\nexpect silence\nexpect exception\nexpect damage\nexpect reply");
    assert_eq!(reasons(&report).len(), 3);
    assert_eq!(
        reasons(&bench().run("expect reply\nexpect displacement > 0")),
        [(1, Reason::NothingSent), (2, Reason::NotRead("displacement".to_owned())),]
    );
}

#[test]
fn an_old_value_never_stands_for_one_that_did_not_come() {
    let report = bench().run(
        "read displacement
         read displacement wrong check within 50 ms
         expect silence
         expect displacement = -0.328
         read sample_rate
         write sample_rate = 20
         expect sample_rate = 20",
    );
    let not_read = |name: &str| Reason::NotRead(name.to_owned());
    assert_eq!(reasons(&report), [(4, not_read("displacement")), (7, not_read("sample_rate"))]);
}

#[test]
fn branches_and_rounds() {
    let report = passes(
        "read displacement
         if displacement > 0
           fail \"above\"
         else if displacement > -0.1
           fail \"between\"
         else if displacement > -1
           log \"below\"
           if exception
             fail \"no\"
           end
         else
           fail \"else\"
         end
         let n = 0
         repeat until n = 3 at most 10 times
           let n = n + 1
           repeat 2 times
             log \"{n}\"
           end
         end
         if silence
           fail \"no\"
         end
         log \"end\"",
    );
    assert_eq!(logs(&report), ["below", "0", "1", "1", "1", "2", "2", "2", "3", "3", "3", "end"]);
    let branches: Vec<Branch> = report.entries.iter().filter_map(|entry| entry.outcome).collect();
    let rounds = [Branch::Rounds(3), Branch::Rounds(2), Branch::Rounds(2), Branch::Rounds(2)];
    let ifs = [Branch::Else, Branch::Else, Branch::Then, Branch::Else];
    assert_eq!(branches, [ifs.as_slice(), &rounds, &[Branch::Else]].concat());
    let skipped: Vec<u32> =
        report.entries.iter().filter(|entry| entry.mark == Mark::Skipped).map(|entry| entry.line).collect();
    assert_eq!(skipped, [3, 5, 9, 12, 22]);
    let report = bench().run("repeat until reply at most 3 times\nread displacement unit 5 within 20 ms\nend");
    assert_eq!(reasons(&report), [(1, Reason::NeverHeld(3))]);
}

#[test]
fn a_failure_goes_on_or_stops() {
    let report = bench().run("fail \"one\"\nlog \"two\"");
    assert_eq!((report.summary.ended, report.summary.failed), (Some(Ended::Finished), 1));
    assert_eq!(logs(&report), ["one", "two"]);
    let report = bench().run("on failure stop\nrepeat 2 times\nfail \"one\"\nend\nlog \"two\"");
    assert_eq!((report.summary.verdict, report.summary.ended), (Verdict::Failed, Some(Ended::Failure)));
    assert_eq!(logs(&report), ["one"]);
    let report = bench().run("log \"one\"\nstop\nfail \"two\"");
    assert_eq!((report.summary.verdict, report.summary.ended), (Verdict::Passed, Some(Ended::StopStep)));
}

#[test]
fn the_line_follows_the_device_and_comes_back() {
    let mut bench = bench();
    let report = bench.run(
        "poll off
         write baud = 115200
         line 115200
         read baud
         expect baud = 115200
         write output_mode = ASCII
         line 115200 ascii
         read displacement
         expect displacement = -0.328
         send ascii UNIT 03 00 30 00 01
         expect ascii UNIT 03 02 00 01 LRC
         expect address = 1
         send ascii UNIT 03 00 30 00 01 wrong lrc within 100 ms
         expect silence
         read address wrong check within 100 ms
         expect silence
         write output_mode = RTU
         line 115200 rtu
         write baud = 9600
         line original
         read displacement",
    );
    assert_eq!(reasons(&report), []);
    // Whatever a sequence does to the poll, in the end it is as before.
    assert_eq!(bench.others, [Order::Poll(false), Order::Poll(true)]);
    let flash = bench.sensor().flash_writes();
    assert_eq!(flash, 4);
}

#[test]
fn writes_keep_the_devices_pace() {
    let report = passes("write sample_rate = 20\nwrite sample_rate = 10\nwrite registers 0x3F = 5\nread all");
    let times: Vec<u64> = report.entries.iter().map(|entry| entry.at_us + entry.took_us).collect();
    assert!(times.windows(2).take(2).all(|pair| pair[1] - pair[0] >= 100_000), "{times:?}");
}

#[test]
fn a_value_that_the_profile_does_not_allow_is_not_written() {
    let report = bench().run("let x = 248\nwrite address = x\nlet y = 5 mm\nwrite register 0x3F = 1.5 + y");
    assert_eq!(
        reasons(&report),
        [
            (2, Reason::NotAllowed { point: "address".to_owned(), value: "248".to_owned() }),
            (4, Reason::NotAllowed { point: "0x003F".to_owned(), value: "6.5 mm".to_owned() }),
        ]
    );
    assert!(report.entries.iter().all(|entry| entry.exchanges.is_empty()));
}

#[test]
fn a_scale_is_read_before_it_is_needed_and_a_unit_must_be_the_devices() {
    let mut level = Bench::new(profile("level"), buslens_bus::sim::Level::new(1, buslens_bus::sim::Course::Rest(5000)));
    let report = level.run(
        "read value
         expect value = 5 mH₂O
         write zero_offset = -0.25
         read value
         expect value = 4.750
         expect value < 10 kPa",
    );
    let other = Reason::OtherUnit { found: "mH₂O".to_owned(), wanted: "kPa".to_owned() };
    assert_eq!(reasons(&report), [(6, other)]);
    assert_eq!(report.entries[0].exchanges.len(), 3);
    assert_eq!(report.entries[3].exchanges.len(), 1);
}

// Orders answered by hand.

const OPEN: Line = Line { open: true, line: LineSettings::new(9600, Parity::Even), mode: Mode::Rtu, polling: false };

fn start(text: &str) -> Run {
    let profile = profile("lvdt");
    Run::new(sequence(text, &profile), UnitId(1), Some(Arc::new(profile)), OPEN, START)
}

fn outcome(end: End, heard: &[u8]) -> Outcome {
    Outcome { at_us: 0, heard: heard.to_vec(), round_trip_us: None, end }
}

fn at(ms: u64) -> Instant {
    START + Duration::from_millis(ms)
}

#[test]
fn a_lost_port_stops_it_and_the_report_stays() {
    let mut run = start("log \"one\"\nrepeat forever\nread displacement\nend\nlog \"two\"");
    assert!(matches!(run.poll_order(), Some(Order::Send { id: 0, .. })));
    run.state(at(5), Line { open: false, ..OPEN });
    assert!(run.has_ended() && run.poll_timeout().is_none());
    assert_eq!(run.poll_order(), Some(Order::Withdraw(0)));
    let report = run.report();
    assert_eq!((report.summary.verdict, report.summary.ended), (Verdict::Incomplete, Some(Ended::PortLost)));
    let marks: Vec<_> = report.entries.iter().map(|entry| (entry.line, entry.mark, entry.reason.clone())).collect();
    assert_eq!(
        marks,
        [
            (1, Mark::Passed, None),
            (2, Mark::Skipped, Some(Reason::NoPort)),
            (3, Mark::Skipped, Some(Reason::NoPort)),
            (5, Mark::Skipped, None),
        ]
    );
    run.done(at(6), 0, &outcome(End::NoPort, &[]));
    assert!(run.poll_order().is_none());
    let closed =
        Run::new(sequence("log \"x\"", &profile("lvdt")), UnitId(1), None, Line { open: false, ..OPEN }, START);
    assert_eq!(closed.report().summary.ended, Some(Ended::PortLost));
}

#[test]
fn a_stop_takes_back_what_is_on_its_way_and_restores_the_poll() {
    let mut run = start("poll on\nwait 5 ms\nread displacement");
    assert_eq!((run.poll_order(), run.poll_order()), (Some(Order::Poll(true)), None));
    assert_eq!(run.poll_timeout(), Some(at(5)));
    run.timeout(at(5));
    assert!(matches!(run.poll_order(), Some(Order::Send { .. })));
    run.stop(at(6));
    assert_eq!(
        [run.poll_order(), run.poll_order(), run.poll_order()],
        [Some(Order::Withdraw(0)), Some(Order::Poll(false)), None]
    );
    assert_eq!(run.report().summary.verdict, Verdict::Incomplete);
    run.stop(at(7));
    assert_eq!(run.report().summary.until_us, at(6).as_micros());
}

#[test]
fn what_is_not_sent_fails_and_what_is_never_answered_is_given_up() {
    let mut run = start("timeout 250 ms\nwrite sample_rate = 10\nread displacement within 1 s");
    assert!(matches!(run.poll_order(), Some(Order::Send { id: 0, wait_ms: Some(250), .. })));
    run.done(at(1), 0, &outcome(End::ReadOnly, &[]));
    assert!(matches!(run.poll_order(), Some(Order::Send { id: 1, wait_ms: Some(1000), .. })));
    assert_eq!(run.poll_timeout(), Some(at(31_001)));
    run.timeout(at(31_001));
    assert_eq!(run.poll_order(), Some(Order::Withdraw(1)));
    assert!(run.has_ended());
    assert_eq!(reasons(run.report()), [(2, Reason::ReadOnly), (3, Reason::Withdrawn)]);
}

#[test]
fn a_port_that_does_not_come_back_in_time_is_a_failure_or_the_end() {
    let settings = LineSettings::new(115_200, Parity::Even);
    let text = "line 115200\nlog \"x\"";
    let mut run = start(text);
    assert_eq!(run.poll_order(), Some(Order::Settings { line: settings, mode: Mode::Rtu }));
    run.state(at(1), Line { open: false, ..OPEN });
    assert!(!run.has_ended());
    run.state(at(50), Line { line: settings, ..OPEN });
    assert_eq!(run.report().summary.verdict, Verdict::Passed);
    let mut run = start(text);
    run.timeout(at(5000));
    assert_eq!(reasons(run.report()), [(1, Reason::LineNotSet)]);
    let mut run = start(text);
    run.state(at(1), Line { open: false, ..OPEN });
    run.timeout(at(5000));
    assert_eq!(run.report().summary.ended, Some(Ended::PortLost));
    // Settings that hold already are not set again.
    assert_eq!(start("line 9600 8E1").poll_order(), None);
}

#[test]
fn signals_and_breaks_are_ordered() {
    let mut run = start("dtr on\nrts off\nbreak 100 ms\nlog \"x\"");
    let signals = |dtr, rts| Some(Order::Signals { dtr, rts });
    assert_eq!(run.poll_order(), signals(Some(true), None));
    assert_eq!(run.poll_order(), signals(None, Some(false)));
    assert_eq!(run.poll_order(), Some(Order::Break(100)));
    assert_eq!(run.poll_timeout(), Some(at(100)));
    run.timeout(at(100));
    assert!(run.has_ended());
}

#[test]
fn rounds_without_end_neither_hang_nor_fill_the_memory() {
    let mut run = start("repeat forever\nlet x = 1\nif x = 1\nlog \"{x}\"\nend\nexpect x = 2\nend");
    let mut told = Report::default();
    for ms in 0..250 {
        run.timeout(at(ms));
        told.apply(run.poll_changes().unwrap());
        assert!(!run.has_ended() && run.poll_timeout().is_some_and(|due| due > at(ms)));
    }
    assert!(run.report().entries.len() <= 2 * MAX_ENTRIES + 16);
    assert!(run.report().summary.failed > 15_000 && run.report().summary.left_out > 30_000);
    run.stop(at(700));
    told.apply(run.poll_changes().unwrap());
    assert_eq!(&told, run.report());
    assert_eq!(run.poll_changes(), None);
}

#[derive(Clone, Debug)]
enum Input {
    Done(End, Vec<u8>),
    Open(bool),
    Wait(u64),
    Stop,
}

fn inputs() -> impl Strategy<Value = Input> {
    let ends = [End::Answered, End::Broadcast, End::Heard, End::Silence, End::Damaged, End::Doubtful, End::ReadOnly];
    let reply = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..12),
        Just(vec![0x01, 0x03, 0x02, 0x00, 0x07, 0xF9, 0x86]),
        Just(vec![0x01, 0x84, 0x02, 0xC2, 0xC1]),
    ];
    prop_oneof![
        20 => (prop::sample::select(ends.to_vec()), reply).prop_map(|(end, heard)| Input::Done(end, heard)),
        1 => any::<bool>().prop_map(Input::Open),
        20 => (0u64..2000).prop_map(Input::Wait),
        1 => Just(Input::Stop),
    ]
}

proptest! {
    /// Whatever the line does, there is either something to wait for or the end, and the changes make the report.
    #[test]
    fn no_line_confuses_a_run(text in 0usize..3, inputs in prop::collection::vec(inputs(), 0..120)) {
        let text = READY[text];
        let profile = profile(buslens_sequence::outline(text).0.unwrap());
        let sequence = Arc::new(parse(text, Some(&profile)).unwrap());
        let steps = sequence.step_count();
        let mut run = Run::new(sequence, UnitId(1), Some(Arc::new(profile)), OPEN, START);
        let (mut now, mut told, mut asked, mut line) = (START, Report::default(), None, OPEN);
        for input in inputs.into_iter().chain([Input::Stop]) {
            while let Some(order) = run.poll_order() {
                match order {
                    Order::Send { id, .. } => asked = Some(id),
                    Order::Withdraw(id) => prop_assert_eq!(asked.take(), Some(id)),
                    _ => {}
                }
            }
            match input {
                Input::Done(end, heard) => {
                    if let Some(id) = asked.take() {
                        run.done(now, id, &outcome(end, &heard));
                    }
                }
                Input::Open(open) => {
                    line.open = open;
                    run.state(now, line);
                }
                Input::Wait(ms) => {
                    now = now + Duration::from_millis(ms);
                    run.timeout(now);
                }
                Input::Stop => run.stop(now),
            }
            prop_assert!(run.has_ended() || run.poll_timeout().is_some());
            if let Some(changes) = run.poll_changes() {
                told.apply(changes);
            }
        }
        prop_assert!(run.has_ended());
        prop_assert_eq!(&told, run.report());
        prop_assert!(run.report().entries.iter().all(|entry| entry.mark != Mark::Running));
        prop_assert!(run.report().entries.len() <= 2 * steps + 120);
    }
}

#[test]
fn a_report_reads_as_text() {
    struct Plain;
    impl Words for Plain {
        fn head(&self, summary: &Summary) -> Vec<String> {
            vec![summary.title.clone(), format!("{:?}", summary.verdict)]
        }
        fn mark(&self, mark: Mark) -> String {
            format!("{mark:?}")
        }
        fn about(&self, entry: &Entry) -> Vec<String> {
            let compared = entry.compared.as_ref().map(|compared| format!("found {}", compared.found));
            let reason = entry.reason.as_ref().map(|reason| format!("{reason:?}"));
            [compared, reason]
                .into_iter()
                .flatten()
                .chain((!entry.text.is_empty()).then(|| entry.text.clone()))
                .collect()
        }
    }
    let text = "title \"A test\"\n  read baud\nexpect baud = 115200\nlog \"it is {baud}\"\nstop\nwait 1 s";
    let report = bench().run(text);
    let mut lines: Vec<String> = report.text(text, &Plain).lines().map(str::to_owned).collect();
    // Times are the simulated line's.
    assert!(lines[5].ends_with(" ms"));
    lines.remove(5);
    assert_eq!(
        lines,
        [
            "A test",
            "Failed",
            "",
            "    2      0.0000  Passed   read baud",
            "                            >> 01 03 00 30 00 03 05 C4",
            "    3      0.0338  Failed   expect baud = 115200",
            "                            found 9600 Bd",
            "                            DoesNotHold",
            "    4      0.0338  Passed   log \"it is {baud}\"",
            "                            it is 9600 Bd",
            "    5      0.0338  Passed   stop",
            "    6              Skipped  wait 1 s",
        ]
    );
}
