//! What the master gets right on a line that behaves like one.

mod common;

use std::time::Duration;

use buslens_bus::sim::Device;
use buslens_bus::{Answer, Config, Failure, LinkEvent, LinkState};
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::pdu::{ExceptionCode, Request, Response};
use common::{BOTH, Bench, FACTORY, micrometres};
use proptest::prelude::*;

const READ_BAUD: Request = Request::ReadHoldingRegisters { address: 0x31, quantity: 1 };
const ZERO: Request = Request::WriteSingleCoil { address: 0x50, on: true };

fn exception(code: ExceptionCode, function: u8) -> Result<Answer, Failure> {
    Err(Failure::Exception { function, code })
}

#[test]
fn a_read_brings_the_value_after_the_time_that_the_line_takes() {
    let mut bench = Bench::factory();
    let exchange = bench.ask(1, BOTH);
    assert_eq!(micrometres(&exchange), Some(-328));
    // 8 characters there, 13 back, and the sensor's own time in between.
    let wire = FACTORY.character_time(8 + 13);
    let round_trip = exchange.round_trip.unwrap();
    assert!(round_trip > wire && round_trip < wire + Duration::from_millis(20), "{round_trip:?}");
}

#[test]
fn wrong_settings_are_answered_by_silence() {
    for line in [LineSettings::new(19_200, Parity::Even), LineSettings::new(9600, Parity::None)] {
        let mut bench = Bench::new(Config::new(line, Mode::Rtu));
        let exchange = bench.ask(1, BOTH);
        assert!(matches!(exchange.result, Err(Failure::NoAnswer { .. })), "{line}: {exchange:?}");
    }
    let mut bench = Bench::new(Config::new(FACTORY, Mode::Ascii));
    assert!(matches!(bench.ask(1, BOTH).result, Err(Failure::NoAnswer { .. })));
}

#[test]
fn ascii_mode_works_like_rtu() {
    let mut bench = Bench::new(Config::new(FACTORY, Mode::Ascii));
    assert!(bench.sensor().preset(0x60, 2));
    assert_eq!(micrometres(&bench.ask(1, BOTH)), Some(-328));
    assert_eq!(bench.ask(1, READ_BAUD).received, b":0103020003F7\r\n");
}

#[test]
fn the_sensor_refuses_what_its_manual_says() {
    let mut bench = Bench::factory();
    let refused = [
        (Request::ReadInputRegisters { address: 4, quantity: 1 }, exception(ExceptionCode::IllegalDataAddress, 4)),
        (Request::ReadHoldingRegisters { address: 0x32, quantity: 3 }, exception(ExceptionCode::IllegalDataAddress, 3)),
        (Request::WriteSingleRegister { address: 0x31, value: 3 }, exception(ExceptionCode::IllegalFunction, 6)),
        (
            Request::WriteMultipleRegisters { address: 0x31, values: vec![8] },
            exception(ExceptionCode::IllegalDataValue, 0x10),
        ),
    ];
    for (request, expected) in refused {
        let exchange = bench.ask(1, request.clone());
        assert_eq!(exchange.result, expected, "{request:?}");
        assert_eq!(exchange.received.len(), 5);
    }
    assert!(bench.ask(1, Request::ReadHoldingRegisters { address: 0x30, quantity: 3 }).result.is_ok());
    assert_eq!(bench.sensor().flash_writes(), 0);
}

#[test]
fn a_broadcast_read_is_answered_with_unit_0() {
    let mut bench = Bench::factory();
    let exchange = bench.ask(0, Request::ReadHoldingRegisters { address: 0x30, quantity: 1 });
    assert_eq!(exchange.received, [0x00, 0x03, 0x02, 0x00, 0x01, 0x44, 0x44]);
    assert!(exchange.result.is_ok());
}

#[test]
fn a_change_of_parity_is_answered_on_the_old_settings() {
    let mut bench = Bench::factory();
    let exchange = bench.ask(1, Request::WriteMultipleRegisters { address: 0x32, values: vec![3] });
    let written = Response::WriteMultipleRegisters { address: 0x32, quantity: 1 };
    assert_eq!(exchange.result, Ok(Answer::Reply(written)));
    assert!(matches!(bench.ask(1, READ_BAUD).result, Err(Failure::NoAnswer { .. })));
}

#[test]
fn a_factory_reset_is_echoed_and_then_the_sensor_is_deaf() {
    let mut bench = Bench::factory();
    assert!(bench.ask(1, READ_BAUD).result.is_ok());
    assert!(bench.ask(1, Request::WriteSingleCoil { address: 0x51, on: true }).result.is_ok());
    assert!(matches!(bench.ask(1, READ_BAUD).result, Err(Failure::NoAnswer { .. })));
    bench.run(Duration::from_millis(1500));
    bench.run(Duration::from_secs(3));
    assert!(bench.ask(1, READ_BAUD).result.is_ok());
}

#[test]
fn polling_keeps_its_grid() {
    let mut bench = Bench::factory();
    bench.poll_every(Duration::from_millis(100), [BOTH]);
    let exchanges = bench.run(Duration::from_mins(1));
    assert_eq!(exchanges.len(), 600);
    assert!(exchanges.iter().all(|exchange| micrometres(exchange) == Some(-328)));
}

#[test]
fn strays_around_the_reply_do_not_matter() {
    let mut bench = Bench::factory();
    bench.line.faults.noise_before = vec![0x00, 0xFF, 0x01, 0x04];
    bench.line.faults.noise_after = vec![0xFF, 0x00];
    bench.poll_every(Duration::from_millis(200), [BOTH]);
    let exchanges = bench.run(Duration::from_secs(2));
    assert_eq!(exchanges.len(), 10);
    assert!(exchanges.iter().all(|exchange| micrometres(exchange) == Some(-328)));
    assert!(bench.master.counters().noise_bytes >= 4 * 10);
}

#[test]
fn a_damaged_reply_is_no_value() {
    let mut bench = Bench::factory();
    bench.line.faults.corrupted_replies = 50;
    bench.poll_every(Duration::from_millis(500), [BOTH]);
    let exchanges = bench.run(Duration::from_secs(30));
    let (good, bad): (Vec<_>, Vec<_>) = exchanges.iter().partition(|exchange| exchange.result.is_ok());
    assert!(bad.len() >= 50, "{}", bad.len());
    assert!(bad.iter().any(|exchange| matches!(exchange.result, Err(Failure::BadCheck { .. }))));
    assert!(good.iter().all(|exchange| micrometres(exchange) == Some(-328)));
}

#[test]
fn an_echo_is_taken_off_and_never_taken_for_an_answer() {
    let mut bench = Bench::factory();
    bench.line.faults.echo = true;
    assert_eq!(micrometres(&bench.ask(1, BOTH)), Some(-328));
    assert!(bench.ask(1, ZERO).result.is_ok());
    assert_eq!(bench.master.counters().echoes, 2);
    // The sensor is gone, the echo is not.
    bench.line.faults.lost_replies = 1;
    assert!(matches!(bench.ask(1, ZERO).result, Err(Failure::NoAnswer { .. })));
}

#[test]
fn a_lone_copy_of_a_write_proves_nothing_before_the_adapter_is_known() {
    let mut bench = Bench::factory();
    bench.line.faults.echo = true;
    bench.line.faults.lost_replies = 1;
    assert_eq!(bench.ask(1, ZERO).result, Err(Failure::Unproven));
    let mut bench = Bench::factory();
    bench.line.faults.echo = true;
    assert!(bench.ask(1, ZERO).result.is_ok(), "echo and answer are two copies");
    let mut bench = Bench::factory();
    assert!(bench.ask(1, BOTH).result.is_ok());
    assert!(bench.ask(1, ZERO).result.is_ok(), "no echo with the read, so none with the write");
}

#[test]
fn another_units_frames_do_not_stop_the_clock() {
    let mut bench = Bench::factory();
    bench.line.faults.lost_replies = 1;
    bench.master.submit(bench.now, buslens_bus::Job::new(buslens_codec::UnitId(1), READ_BAUD));
    bench.settle();
    bench.run(Duration::from_millis(300));
    // Unit 2 answers 03 with one register.
    bench.hear(&[0x02, 0x03, 0x02, 0x00, 0x03, 0xBC, 0x45]);
    bench.run(Duration::from_millis(700));
    assert_eq!(bench.master.counters().no_answers, 1);
    assert_eq!(bench.master.counters().replies, 0);
}

/// The hard case: identical polls in a row, and replies that come after their time.
#[test]
fn a_late_reply_never_answers_the_next_poll() {
    for late_ms in [200, 450, 560, 600, 650, 700, 900, 1300, 1900, 2500] {
        let mut bench = Bench::factory();
        bench.line.faults.reply_delay = Duration::from_millis(late_ms);
        bench.poll_every(Duration::from_millis(100), [BOTH]);
        let mut read = 0;
        for step in 0..200 {
            bench.rest_at(step * 1000);
            for exchange in bench.run(Duration::from_millis(250)) {
                let Some(value) = micrometres(&exchange) else { continue };
                read += 1;
                let sent = exchange.at - exchange.round_trip.unwrap();
                // The probe's place when the request was on its way, or at any time since.
                let at = |time: buslens_bus::time::Instant| {
                    i32::try_from((time.as_micros() - 10_000_000) / 250_000).unwrap() * 1000
                };
                assert!(
                    (at(sent)..=at(exchange.at)).contains(&value),
                    "{late_ms} ms late: {value} is older than its request"
                );
            }
        }
        if late_ms < 1500 {
            assert!(read > 5, "{late_ms} ms late: {read} readings only");
        }
    }
}

#[test]
fn one_lost_reply_costs_no_more_than_a_second() {
    let mut bench = Bench::factory();
    bench.poll_every(Duration::from_millis(100), [BOTH]);
    bench.run(Duration::from_secs(5));
    bench.line.faults.lost_replies = 1;
    let exchanges = bench.run(Duration::from_secs(3));
    let good: Vec<_> = exchanges.iter().filter(|exchange| exchange.result.is_ok()).collect();
    let longest = good.windows(2).map(|pair| pair[1].at.saturating_since(pair[0].at)).max().unwrap();
    assert!(longest < Duration::from_secs(1), "{longest:?}");
}

#[test]
fn a_sensor_that_comes_back_is_read_again() {
    let mut bench = Bench::factory();
    bench.poll_every(Duration::from_millis(100), [BOTH]);
    bench.run(Duration::from_secs(2));
    let now = bench.now;
    bench.sensor().power_cycle(now + Duration::from_secs(20));
    assert!(bench.run(Duration::from_secs(20)).iter().all(|exchange| exchange.result.is_err()));
    let exchanges = bench.run(Duration::from_secs(8));
    let back = exchanges.iter().find(|exchange| exchange.result.is_ok()).expect("never read again");
    assert!(back.at.saturating_since(now) < Duration::from_secs(27), "{:?}", back.at.saturating_since(now));
}

#[test]
fn a_lost_port_is_opened_again_and_polling_resumes() {
    let mut bench = Bench::factory();
    bench.poll_every(Duration::from_millis(100), [BOTH]);
    bench.run(Duration::from_secs(1));
    bench.unplugged = true;
    bench.master.handle_link(bench.now, LinkEvent::Lost);
    bench.settle();
    assert_eq!(bench.master.link_state(), LinkState::Lost);
    assert!(bench.run(Duration::from_secs(10)).is_empty());
    bench.unplugged = false;
    bench.master.handle_link(bench.now, LinkEvent::Plugged);
    bench.settle();
    assert_eq!(bench.master.link_state(), LinkState::Open);
    assert!(bench.run(Duration::from_secs(1)).iter().filter(|exchange| exchange.result.is_ok()).count() > 5);
}

#[test]
fn jobs_fail_at_once_without_a_link() {
    let mut bench = Bench::factory();
    bench.master.disconnect(bench.now);
    bench.settle();
    assert_eq!(bench.master.link_state(), LinkState::Closed);
    assert_eq!(bench.ask(1, READ_BAUD).result, Err(Failure::LinkLost));
}

#[test]
fn a_request_beyond_the_standard_is_not_sent() {
    let mut bench = Bench::factory();
    let exchange = bench.ask(1, Request::ReadHoldingRegisters { address: 0, quantity: 126 });
    assert!(matches!(exchange.result, Err(Failure::Invalid(_))));
    assert!(exchange.sent.is_empty());
}

proptest! {
    /// Whatever comes, at any time: no panic, no timer in the past, and nothing but true values.
    #[test]
    fn noise_never_becomes_a_value(chunks in prop::collection::vec((0u64..300, prop::collection::vec(any::<u8>(), 0..40)), 0..60)) {
        let mut bench = Bench::factory();
        bench.poll_every(Duration::from_millis(100), [BOTH]);
        for (pause_ms, bytes) in chunks {
            bench.hear(&bytes);
            for exchange in bench.run(Duration::from_millis(pause_ms)) {
                prop_assert!(micrometres(&exchange).is_none_or(|value| value == -328));
            }
        }
        prop_assert_eq!(bench.master.link_state(), LinkState::Open);
    }
}
