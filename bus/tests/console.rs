//! What a hand at the console may do to a line that is polled: raw bytes, other settings, only reads, a replay.

mod common;

use std::time::Duration;

use buslens_bus::record::{self, End, Note, Origin, Outcome, What};
use buslens_bus::sim::Device;
use buslens_bus::time::Instant;
use buslens_bus::{Answer, Config, Event, Exchange, Failure, Job, LinkState, Master, Poll};
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::pdu::{ExceptionCode, Request, Response};
use buslens_codec::{UnitId, adu, rtu};
use common::{BOTH, Bench, FACTORY, micrometres};
use proptest::prelude::*;

const READ_BAUD: Request = Request::ReadHoldingRegisters { address: 0x31, quantity: 1 };
const PERIOD: Duration = Duration::from_millis(100);

fn frame(mode: Mode, unit: u8, request: &Request) -> Vec<u8> {
    adu::encode(mode, UnitId(unit), &request.encode().unwrap()).unwrap()
}

fn console(bytes: impl Into<Vec<u8>>, wait_ms: Option<u64>) -> Job {
    Job::raw(bytes.into(), wait_ms.map(Duration::from_millis)).by(Origin::Console)
}

fn send(bench: &mut Bench, bytes: impl Into<Vec<u8>>, wait_ms: Option<u64>) -> Exchange {
    let id = bench.submit(console(bytes, wait_ms));
    bench.end_of(id)
}

/// Bytes that no device answers: a right request but for its check.
fn damaged() -> Vec<u8> {
    let mut bytes = frame(Mode::Rtu, 1, &READ_BAUD);
    bytes[7] ^= 0x55;
    bytes
}

fn is_silence<T>(result: &Result<T, Failure>) -> bool {
    matches!(result, Err(Failure::NoAnswer { heard, .. }) if heard.is_empty())
}

#[test]
fn raw_bytes_that_are_a_request_are_a_transaction() {
    let mut bench = Bench::factory();
    let bytes = frame(Mode::Rtu, 1, &READ_BAUD);
    let exchange = send(&mut bench, bytes.clone(), None);
    assert_eq!(exchange.received, [0x01, 0x03, 0x02, 0x00, 0x03, 0xF8, 0x45]);
    let outcome = Outcome::from(&exchange);
    assert_eq!((outcome.end, outcome.at_us), (End::Answered, bench.sent().next().unwrap().0));
    assert!(matches!(exchange.result, Ok(Answer::Reply(Response::ReadHoldingRegisters { .. }))));
    assert_eq!(exchange.at.saturating_since(exchange.sent_at), exchange.round_trip.unwrap());
    assert_eq!(
        bench.sent().map(|(_, origin, bytes)| (origin, bytes)).collect::<Vec<_>>(),
        [(Origin::Console, bytes.as_slice())]
    );
}

#[test]
fn a_request_beyond_the_standard_is_sent_raw_and_its_refusal_is_an_answer() {
    let mut bench = Bench::factory();
    let exchange = send(&mut bench, rtu::encode(UnitId(1), &[0x03, 0, 0x31, 0, 0]).unwrap(), None);
    let code = ExceptionCode::IllegalDataValue;
    assert_eq!(exchange.result, Err(Failure::Exception { function: 3, code }));
}

#[test]
fn ascii_goes_out_as_it_was_typed() {
    let mut bench = Bench::new(Config::new(FACTORY, Mode::Ascii));
    assert!(bench.sensor().preset(0x60, 2));
    let typed = b":010300310001ca\r\n";
    let exchange = send(&mut bench, *typed, None);
    assert_eq!((exchange.sent.as_slice(), exchange.received.as_slice()), (&typed[..], &b":0103020003F7\r\n"[..]));
}

#[test]
fn a_damaged_frame_gets_silence_and_holds_the_line_for_its_wait_alone() {
    let mut bench = Bench::factory();
    bench.poll_every(PERIOD, [BOTH]);
    bench.run(Duration::from_secs(1));
    for wait_ms in [None, Some(0), Some(80), Some(1500)] {
        let exchange = send(&mut bench, damaged(), wait_ms);
        assert!(is_silence(&exchange.result), "{exchange:?}");
        assert_eq!(Outcome::from(&exchange).end, End::Silence);
        assert_eq!((exchange.sent, exchange.round_trip), (damaged(), None));
        let held = exchange.at.saturating_since(exchange.sent_at + FACTORY.character_time(8));
        let asked = Duration::from_millis(wait_ms.unwrap_or(500).max(50));
        assert!(wait_ms.is_none() || held == asked, "{held:?} instead of {asked:?}");
        let after = bench.run(Duration::from_millis(450));
        assert!(after.len() >= 4 && after.iter().all(|exchange| micrometres(exchange) == Some(-328)), "{after:?}");
    }
}

#[test]
fn what_is_heard_after_raw_bytes_is_told_once_the_line_is_quiet() {
    let mut bench = Bench::factory();
    bench.poll_every(PERIOD, [BOTH]);
    bench.run(Duration::from_millis(1050));
    let id = bench.submit(console(*b"*IDN?\r", None));
    bench.run(Duration::from_millis(20));
    for part in ["Gau", "ge ", "7\r\n"] {
        bench.hear(part.as_bytes());
        bench.run(Duration::from_millis(40));
    }
    let polls_before = bench.sent().filter(|(_, origin, _)| *origin == Origin::Poll).count();
    let exchange = bench.end_of(id);
    assert_eq!((exchange.result, exchange.received.as_slice()), (Ok(Answer::Heard), &b"Gauge 7\r\n"[..]));
    assert_eq!(exchange.round_trip, Some(Duration::from_millis(20 + 2 * 40)));
    assert_eq!(exchange.at.saturating_since(exchange.sent_at), Duration::from_millis(20 + 2 * 40 + 50));
    let polls = bench.sent().filter(|(_, origin, _)| *origin == Origin::Poll).count();
    assert_eq!(polls, polls_before, "a poll left in the middle");
}

#[test]
fn the_echo_of_raw_bytes_is_no_answer() {
    let mut bench = Bench::factory();
    bench.line.faults.echo = true;
    let text = b"a line of text that takes longer than the adapter's slack, \
                 because the adapter hands its echo on as it comes";
    for bytes in [damaged(), text.to_vec(), vec![0x55]] {
        let exchange = send(&mut bench, bytes.clone(), None);
        assert!(is_silence(&exchange.result), "{exchange:?}");
    }
    assert_eq!(bench.master.counters().echoes, 3);
    // An adapter that is known to be deaf to itself: the same bytes are somebody's answer.
    let mut bench = Bench::factory();
    assert!(bench.ask(1, BOTH).result.is_ok());
    let id = bench.submit(console([0x55], None));
    bench.run(Duration::from_millis(10));
    bench.hear(&[0x55]);
    assert_eq!(bench.end_of(id).received, [0x55]);
}

#[test]
fn no_bytes_keep_the_line_free() {
    let mut bench = Bench::factory();
    bench.poll_every(PERIOD, [BOTH]);
    bench.run(Duration::from_secs(1));
    let exchange = send(&mut bench, [], Some(700));
    let (from, until) = (exchange.sent_at.as_micros(), exchange.at.as_micros());
    assert_eq!(until - from, 700_000);
    assert!(bench.sent().all(|(at, _, bytes)| bytes.is_empty() || at < from || at > until));
}

#[test]
fn a_withdrawn_job_never_leaves() {
    let mut bench = Bench::factory();
    bench.ask(1, READ_BAUD);
    let first = bench.submit(console(damaged(), None));
    let second = bench.submit(console(*b"never", None));
    bench.run(Duration::from_millis(10));
    assert!(bench.master.withdraw(second));
    assert!(!bench.master.withdraw(second) && !bench.master.withdraw(first));
    bench.end_of(first);
    bench.run(Duration::from_secs(2));
    assert!(bench.sent().all(|(_, _, bytes)| bytes != b"never"));
    assert!(bench.events.iter().all(|event| !matches!(event, Event::Done { .. })));
}

#[test]
fn other_settings_come_between_two_transactions_and_nothing_is_lost() {
    let mut bench = Bench::factory();
    bench.poll_every(PERIOD, [BOTH]);
    bench.run(Duration::from_millis(1050));
    // The sensor answers a change of its parity with the old one.
    let other = LineSettings::new(9600, Parity::Odd);
    let changed = bench.submit(Job::new(UnitId(1), Request::WriteMultipleRegisters { address: 0x32, values: vec![1] }));
    bench.run(Duration::from_millis(10));
    let waits = bench.submit(console(frame(Mode::Rtu, 1, &READ_BAUD), None));
    bench.master.reconfigure(bench.now, other, Mode::Rtu);
    assert!(bench.master.is_reconfiguring(), "the port is still open with the old ones");
    bench.settle();
    assert!(bench.end_of(changed).result.is_ok(), "what has begun ends with the old settings");
    assert!(bench.end_of(waits).result.is_ok(), "what waits goes on with the new ones");
    assert!(bench.master.link_state() == LinkState::Open && !bench.master.is_reconfiguring());
    let polls = bench.run(Duration::from_secs(1));
    assert!(polls.iter().filter(|exchange| micrometres(exchange) == Some(-328)).count() >= 8, "{polls:?}");
}

#[test]
fn other_settings_are_for_the_next_time_while_the_port_is_closed_or_gone() {
    let mut bench = Bench::factory();
    bench.master.disconnect(bench.now);
    bench.settle();
    bench.master.reconfigure(bench.now, LineSettings::new(9600, Parity::Odd), Mode::Rtu);
    bench.settle();
    assert_eq!(bench.master.link_state(), LinkState::Closed);
    bench.master.connect(bench.now);
    bench.settle();
    assert!(is_silence(&bench.ask(1, BOTH).result), "the sensor has even parity");
    bench.unplugged = true;
    bench.master.handle_link(bench.now, buslens_bus::LinkEvent::Lost);
    bench.master.reconfigure(bench.now, FACTORY, Mode::Rtu);
    bench.settle();
    assert_eq!(bench.master.link_state(), LinkState::Lost);
    bench.unplugged = false;
    bench.run(Duration::from_secs(2));
    assert!(bench.ask(1, BOTH).result.is_ok());
}

#[test]
fn only_reads_leave_while_that_is_asked_for() {
    let mut bench = Bench::factory();
    bench.master.set_read_only(true);
    let write = Request::WriteSingleCoil { address: 0x50, on: true };
    let refused = [
        Job::new(UnitId(1), write.clone()),
        console(frame(Mode::Rtu, 1, &write), None),
        console(damaged(), None),
        console(*b"text", None),
        console([], Some(100)),
    ];
    for job in refused {
        let id = bench.submit(job);
        assert_eq!(bench.end_of(id).result, Err(Failure::ReadOnly));
    }
    assert_eq!(bench.sent().count(), 0);
    assert!(bench.ask(1, BOTH).result.is_ok());
    assert!(send(&mut bench, frame(Mode::Rtu, 1, &READ_BAUD), None).result.is_ok());
    bench.master.set_read_only(false);
    assert!(bench.ask(1, write).result.is_ok());
}

/// Polling at 10 Hz and somebody who always has something more to send.
#[test]
fn polling_and_the_console_share_the_line() {
    // A request and its reply take less than half a period at this rate.
    let jobs: [fn() -> Job; 3] = [
        || console(frame(Mode::Rtu, 1, &READ_BAUD), None),
        || console(*b"\x01\x03\x00", Some(0)),
        || Job::new(UnitId(1), READ_BAUD).by(Origin::Sequence),
    ];
    for (at, job) in jobs.into_iter().enumerate() {
        let mut bench = Bench::factory();
        bench.poll_every(PERIOD, [BOTH]);
        bench.run(Duration::from_secs(1));
        let begin = bench.notes.len();
        let (mut waiting, mut polls, mut done) = (Vec::new(), Vec::new(), 0);
        for _ in 0..6000 {
            while waiting.len() < 2 {
                waiting.push(bench.submit(job()));
            }
            polls.extend(bench.run(Duration::from_millis(10)));
            for event in bench.events.drain(..) {
                if let Event::Done { job, exchange } = event {
                    assert_eq!(Some(job), waiting.first().copied());
                    waiting.remove(0);
                    done += 1;
                    assert!(at == 1 || exchange.result.is_ok(), "{exchange:?}");
                }
            }
        }
        assert!(polls.len() >= 480, "job {at}: {} polls of 600", polls.len());
        assert!(done >= 480, "job {at}: {done} of the console's");
        assert!(polls.iter().all(|exchange| micrometres(exchange) == Some(-328)));
        whole_exchanges(&bench.notes[begin..], at == 1);
    }
}

/// Every request is whole, and its reply comes before anything else leaves.
fn whole_exchanges(notes: &[Note], fragments: bool) {
    let mut heard: Option<(Vec<u8>, Vec<u8>)> = None;
    for note in notes {
        match &note.what {
            What::Sent { bytes, .. } => {
                if let Some((request, reply)) = heard.replace((bytes.clone(), Vec::new())) {
                    let answered = rtu::decode(&reply).is_ok_and(|adu| adu.pdu[0] == request[1]);
                    let fragment = fragments && rtu::decode(&request).is_err() && reply.is_empty();
                    assert!(answered || fragment, "{request:02X?} was followed by {reply:02X?}");
                }
            }
            What::Received(bytes) => {
                if let Some((_, reply)) = &mut heard {
                    reply.extend(bytes);
                }
            }
            What::Port(_) => {}
        }
    }
}

#[test]
fn a_flood_of_foreign_frames_leaves_nothing_behind() {
    let mut bench = Bench::factory();
    let mut pushed = 0;
    for step in 0..20_000 {
        let reply = rtu::encode(UnitId(9), &[0x03, 0x02, 0x00, u8::try_from(step % 256).unwrap()]).unwrap();
        pushed += reply.len() as u64;
        bench.now = bench.now + Duration::from_micros(100);
        bench.hear(&reply);
        bench.notes.clear();
    }
    // What is counted is not kept.
    assert_eq!(bench.master.counters().noise_bytes, pushed);
    bench.run(Duration::from_millis(10));
    assert!(bench.ask(1, BOTH).result.is_ok());
}

/// A master that steps through the notes of another, with the same poll.
fn replayed(notes: &[Note], config: Config, poll: Poll) -> (Vec<(usize, Exchange)>, Master) {
    let mut master = Master::replaying(config);
    master.set_poll(Instant::ZERO, Some(poll));
    let mut polls = Vec::new();
    for note in notes {
        master.replay(Instant::from_micros(note.at_us), &note.what);
        assert_eq!(master.poll_transmit(), None);
        assert_eq!(master.poll_link(), None);
        while let Some(event) = master.poll_event() {
            if let Event::Polled { index, exchange } = event {
                polls.push((index, exchange));
            }
        }
    }
    (polls, master)
}

#[test]
fn a_replay_tells_what_was_told_live() {
    let mut bench = Bench::factory();
    let settings = Note { at_us: bench.now.as_micros(), what: What::Port(record::Event::Opened(FACTORY, Mode::Rtu)) };
    bench.notes.push(settings);
    let requests = [BOTH, READ_BAUD, BOTH];
    bench.poll_every(PERIOD, requests.clone());
    let mut live = Vec::new();
    for step in 0..300 {
        bench.rest_at(step * 10);
        bench.line.faults.lost_replies = u32::from(step % 40 == 7);
        bench.line.faults.corrupted_replies = u32::from(step % 40 == 17);
        bench.line.faults.noise_before = if step % 3 == 0 { vec![0, 0xFF] } else { Vec::new() };
        if step % 9 == 0 {
            bench.submit(console(damaged(), Some(60)));
            bench.submit(console(frame(Mode::Rtu, 1, &READ_BAUD), None));
        }
        live.extend(bench.run(Duration::from_millis(130)));
    }
    // Whose poll it was is not told beside the recording.
    let poll = Poll { unit: UnitId(77), requests: requests.to_vec(), period: PERIOD };
    let (again, master) = replayed(&bench.notes, Config::new(FACTORY, Mode::Rtu), poll);
    assert!(live.iter().filter(|exchange| exchange.result.is_err()).count() >= 10);
    let good = |exchange: &Exchange| exchange.result.is_ok().then(|| (exchange.sent_at, exchange.received.clone()));
    let told: Vec<_> = live.iter().filter_map(good).collect();
    let told_again: Vec<_> = again.iter().filter_map(|(_, exchange)| good(exchange)).collect();
    assert_eq!(told_again.iter().filter(|one| !told.contains(one)).collect::<Vec<_>>(), [] as [&_; 0]);
    assert_eq!(told.iter().filter(|one| !told_again.contains(one)).collect::<Vec<_>>(), [] as [&_; 0]);
    assert!(again.iter().zip(&again[1..]).all(|((a, _), (b, _))| (a + 1) % 3 == *b));
    assert_eq!(master.polled_unit(), Some(UnitId(1)));
    assert!(master.counters().replies >= bench.master.counters().replies - 1);
}

#[test]
fn a_replay_ends_a_request_that_the_next_one_follows() {
    let read = frame(Mode::Rtu, 1, &BOTH);
    let sent = |at_us| Note { at_us, what: What::Sent { origin: Origin::Unknown, bytes: read.clone() } };
    let garbage = Note { at_us: 40_000, what: What::Received(vec![0x7F]) };
    let notes =
        [sent(0), garbage, sent(60_000), Note { at_us: 90_000, what: What::Port(record::Event::Lost) }, sent(200_000)];
    let poll = Poll { unit: UnitId(1), requests: vec![BOTH], period: PERIOD };
    let (polls, _) = replayed(&notes, Config::new(FACTORY, Mode::Rtu), poll);
    assert_eq!(polls.len(), 1);
    assert!(matches!(&polls[0].1.result, Err(Failure::NoAnswer { heard, .. }) if *heard == [0x7F]));
}

/// Bytes that are no frame, but hold a request that a device answers, late: never a value of the poll.
#[test]
fn a_late_answer_to_raw_bytes_is_never_a_polls() {
    for late_ms in [60, 200, 450, 600, 900, 1500] {
        let mut bench = Bench::new(Config::new(FACTORY, Mode::Ascii));
        assert!(bench.sensor().preset(0x60, 2));
        bench.line.faults.reply_delay = Duration::from_millis(late_ms);
        bench.poll_every(PERIOD, [BOTH]);
        let mut read = 0;
        for step in 0..400 {
            bench.rest_at(step * 1000);
            if step % 16 == 3 {
                bench.submit(console([b"??".to_vec(), frame(Mode::Ascii, 1, &BOTH)].concat(), Some(50)));
            }
            for exchange in bench.run(Duration::from_millis(250)) {
                let Some(value) = micrometres(&exchange) else { continue };
                read += 1;
                let place = |time: Instant| i32::try_from((time.as_micros() - 10_000_000) / 250_000).unwrap() * 1000;
                let fresh = place(exchange.sent_at)..=place(exchange.at);
                assert!(fresh.contains(&value), "{late_ms} ms late: {value} is older than its request");
            }
        }
        assert!(late_ms > 1000 || read > 20, "{late_ms} ms late: {read} readings only");
    }
}

fn anything() -> impl Strategy<Value = Vec<u8>> {
    let requests = prop_oneof![
        Just(BOTH),
        Just(READ_BAUD),
        Just(Request::WriteSingleCoil { address: 0x50, on: true }),
        Just(Request::WriteMultipleRegisters { address: 0x32, values: vec![2] }),
    ];
    let framed = (requests, 0u8..3, prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..2));
    let framed = framed.prop_map(|(request, unit, damage)| {
        let mut bytes = frame(Mode::Rtu, unit, &request);
        for (at, flip) in damage {
            let at = at.index(bytes.len());
            bytes[at] ^= flip;
        }
        bytes
    });
    prop_oneof![framed, prop::collection::vec(any::<u8>(), 0..30)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever is sent, heard and wanted in between: no timer stands still, each job ends once, the poll goes on and
    /// reads nothing but the truth, and read-only lets nothing else out.
    #[test]
    fn whatever_the_console_does_the_poll_reads_the_truth(
        steps in prop::collection::vec((anything(), prop::option::of(0u64..800), 0u64..200, 0u8..8, anything()), 1..20),
        echo in any::<bool>(),
        read_only in any::<bool>(),
    ) {
        let mut bench = Bench::factory();
        bench.line.faults.echo = echo;
        bench.master.set_read_only(read_only);
        bench.poll_every(PERIOD, [BOTH]);
        let mut open = Vec::new();
        let mut polls = Vec::new();
        for (bytes, wait, pause, wish, noise) in steps {
            open.push(bench.submit(console(bytes, wait)));
            match wish {
                0 => bench.hear(&noise),
                1 => bench.master.reconfigure(bench.now, FACTORY, Mode::Rtu),
                2 if bench.master.withdraw(open[0]) => { open.remove(0); }
                _ => {}
            }
            bench.settle();
            polls.extend(bench.run(Duration::from_millis(pause)));
        }
        polls.extend(bench.run(Duration::from_mins(1)));
        for exchange in &polls {
            prop_assert!(micrometres(exchange).is_none_or(|value| value == -328 || value == 0), "{:?}", exchange);
        }
        let mut done: Vec<_> = bench.events.iter().filter_map(|event| match event {
            Event::Done { job, .. } => Some(*job),
            _ => None,
        }).collect();
        done.sort();
        open.sort();
        prop_assert_eq!(done, open);
        if read_only {
            prop_assert!(bench.sent().all(|(_, _, bytes)| matches!(bytes.get(1), Some(3 | 4)) && rtu::decode(bytes).is_ok()));
        }
    }
}
