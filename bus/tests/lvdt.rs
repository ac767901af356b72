//! The simulated LVDT sensor obeys its manual (version 3.1), asked by the master and by hand.

mod common;

use std::time::Duration;

use buslens_bus::sim::{BroadcastAddress, Device, Lvdt, Motion};
use buslens_bus::time::Instant;
use buslens_bus::{Config, Exchange, Failure};
use buslens_codec::UnitId;
use buslens_codec::line::{DataBits, LineSettings, Mode, Parity};
use buslens_codec::pdu::Request;
use common::{BOTH, Bench, FACTORY, START, micrometres};

const ZERO: Request = Request::WriteSingleCoil { address: 0x50, on: true };
const CANCEL_ZERO: Request = Request::WriteSingleCoil { address: 0x50, on: false };
const FACTORY_RESET: Request = Request::WriteSingleCoil { address: 0x51, on: true };

const fn read(address: u16) -> Request {
    Request::ReadHoldingRegisters { address, quantity: 1 }
}

fn write(address: u16, value: u16) -> Request {
    Request::WriteMultipleRegisters { address, values: vec![value] }
}

fn displacement(bench: &mut Bench) -> Option<i32> {
    micrometres(&bench.ask(1, BOTH))
}

fn is_silence(exchange: &Exchange) -> bool {
    matches!(exchange.result, Err(Failure::NoAnswer { .. })) && exchange.received.is_empty()
}

/// Asks the device itself, by the time on its clock.
fn serve(sensor: &mut Lvdt, at_ms: u64, unit: u8, pdu: &[u8]) -> Option<(UnitId, Vec<u8>)> {
    let now = START + Duration::from_millis(at_ms);
    sensor.serve(now, UnitId(unit), pdu).map(|reply| (reply.unit, reply.pdu))
}

#[test]
fn a_write_that_changes_nothing_wears_the_flash_like_any_other() {
    let mut bench = Bench::factory();
    for (value, writes) in [(4, 1), (4, 2), (5, 3)] {
        assert!(bench.ask(1, write(0x3F, value)).result.is_ok());
        bench.run(Duration::from_millis(200));
        assert_eq!(bench.sensor().flash_writes(), writes);
    }
    // Two settings in one request are one write; what is refused and what goes to no flash is none.
    assert!(bench.ask(1, Request::WriteMultipleRegisters { address: 0x30, values: vec![1, 3] }).result.is_ok());
    bench.run(Duration::from_millis(200));
    assert!(bench.ask(1, write(0x3F, 7)).result.is_err());
    bench.ask(1, ZERO);
    bench.ask(1, BOTH);
    assert_eq!(bench.sensor().flash_writes(), 4);
    // A preset is how it was before.
    assert!(bench.sensor().preset(0x3F, 1) && !bench.sensor().preset(0x3F, 7) && !bench.sensor().preset(0x33, 1));
    assert_eq!(bench.sensor().flash_writes(), 4);
}

#[test]
fn writes_that_come_too_fast_are_neither_taken_nor_answered() {
    let mut sensor = Lvdt::new(1, Motion::Swing);
    let rate = |value: u8| [0x10, 0x00, 0x3F, 0x00, 0x01, 0x02, 0x00, value];
    let echo = Some((UnitId(1), vec![0x10, 0x00, 0x3F, 0x00, 0x01]));
    assert_eq!(serve(&mut sensor, 0, 1, &rate(5)), echo);
    assert_eq!(serve(&mut sensor, 30, 1, &rate(6)), None);
    // Reading goes on meanwhile, and zeroing, which writes no flash.
    assert_eq!(serve(&mut sensor, 40, 1, &[3, 0, 0x3F, 0, 1]), Some((UnitId(1), vec![3, 2, 0, 5])));
    assert!(serve(&mut sensor, 50, 1, &[5, 0, 0x50, 0xFF, 0]).is_some());
    // Ten a second are all taken.
    for tenth in 1..=10 {
        assert_eq!(serve(&mut sensor, tenth * 100, 1, &rate(6)), echo);
    }
    assert_eq!((sensor.flash_writes(), sensor.lost_writes()), (11, 1));
}

#[test]
fn it_is_deaf_for_a_second_and_a_half_after_power_on_and_after_a_reset() {
    let mut bench = Bench::factory();
    let deaf = Duration::from_millis(1500);
    let answers_at = |bench: &mut Bench, at: Instant| {
        bench.run(at.saturating_since(bench.now));
        !is_silence(&bench.ask(1, read(0x30)))
    };
    for (early, answers) in [(10, false), (0, true)] {
        bench.power_cycle();
        let hears = bench.now + deaf;
        assert_eq!(answers_at(&mut bench, hears - Duration::from_millis(early)), answers);
        // The reset is echoed first; its time counts from there.
        bench.run(Duration::from_secs(2));
        let exchange = bench.ask(1, FACTORY_RESET);
        assert_eq!(exchange.received, exchange.sent);
        let echoed = exchange.sent_at + FACTORY.character_time(8 + 8) + FACTORY.frame_gap() * 2;
        assert_eq!(answers_at(&mut bench, echoed + deaf - Duration::from_millis(early)), answers);
        bench.run(Duration::from_secs(2));
    }
}

#[test]
fn a_reset_is_echoed_at_the_old_settings_and_brings_those_of_the_factory() {
    for answers_at_new_settings in [false, true] {
        let mut bench = Bench::factory();
        bench.sensor().answers_at_new_settings = answers_at_new_settings;
        for (register, value) in [(0x30, 9), (0x31, 7), (0x32, 3), (0x34, 1), (0x3F, 6), (0x60, 2)] {
            assert!(bench.sensor().preset(register, value));
        }
        bench.reopen(LineSettings::new(115_200, Parity::None), Mode::Ascii);
        let exchange = bench.ask(9, FACTORY_RESET);
        assert_eq!(exchange.received, b":09050051FF00A2\r\n");
        bench.run(Duration::from_secs(2));
        bench.reopen(FACTORY, Mode::Rtu);
        for (register, value) in [(0x30, 1), (0x31, 3), (0x32, 2), (0x34, 2), (0x3F, 4), (0x60, 1)] {
            assert_eq!(bench.ask(1, read(register)).received[3..5], [0, value], "{register:#06x}");
        }
        assert_eq!(bench.sensor().flash_writes(), 1);
    }
}

#[test]
fn the_zero_lasts_until_the_supply_is_cut() {
    let mut bench = Bench::factory();
    assert_eq!(displacement(&mut bench), Some(-328));
    bench.ask(1, ZERO);
    assert_eq!(displacement(&mut bench), Some(0));
    bench.rest_at(1672);
    assert_eq!(displacement(&mut bench), Some(2000));
    bench.ask(1, CANCEL_ZERO);
    assert_eq!(displacement(&mut bench), Some(1672));
    for (keeps_zero, after) in [(false, 1672), (true, 0)] {
        bench.ask(1, ZERO);
        bench.sensor().keeps_zero = keeps_zero;
        bench.power_cycle();
        bench.run(Duration::from_secs(2));
        assert_eq!(displacement(&mut bench), Some(after));
    }
    // A reset takes it away, whatever a power failure does.
    bench.ask(1, FACTORY_RESET);
    bench.run(Duration::from_secs(2));
    assert_eq!(displacement(&mut bench), Some(1672));
}

#[test]
fn settings_outlive_a_power_failure() {
    let mut bench = Bench::factory();
    assert!(bench.ask(1, write(0x3F, 6)).result.is_ok());
    bench.power_cycle();
    bench.run(Duration::from_secs(2));
    assert_eq!(bench.ask(1, read(0x3F)).received[3..5], [0, 6]);
}

#[test]
fn whoever_asks_everybody_is_answered_with_address_0() {
    let mut sensor = Lvdt::new(7, Motion::Swing);
    let refused = |function: u8, code: u8| Some((UnitId(0), vec![function | 0x80, code]));
    assert_eq!(serve(&mut sensor, 0, 0, &[3, 0, 0x30, 0, 1]), Some((UnitId(0), vec![3, 2, 0, 7])));
    assert_eq!(serve(&mut sensor, 0, 0, &[4, 0, 4, 0, 2]).unwrap().0, UnitId(0));
    assert_eq!(serve(&mut sensor, 0, 0, &[4, 0, 4, 0, 1]), refused(4, 2));
    assert_eq!(serve(&mut sensor, 0, 0, &[6, 0, 0x30, 0, 1]), refused(6, 1));
    assert_eq!(serve(&mut sensor, 0, 0, &[0x10, 0, 0x31, 0, 1, 2, 0, 8]), refused(0x10, 3));
    assert_eq!(serve(&mut sensor, 0, 8, &[3, 0, 0x30, 0, 1]), None);
}

#[test]
fn firmware_differs_in_the_register_that_tells_the_address_to_everybody() {
    let address = Some((UnitId(0), vec![3, 2, 0, 7]));
    let refused = Some((UnitId(0), vec![0x83, 2]));
    for (firmware, at_0030, at_0000) in [
        (BroadcastAddress::At0030, &address, &refused),
        (BroadcastAddress::At0000, &refused, &address),
        (BroadcastAddress::Either, &address, &address),
    ] {
        let mut sensor = Lvdt::new(7, Motion::Swing);
        sensor.broadcast_address = firmware;
        assert_eq!(&serve(&mut sensor, 0, 0, &[3, 0, 0x30, 0, 1]), at_0030, "{firmware:?}");
        assert_eq!(&serve(&mut sensor, 0, 0, &[3, 0, 0, 0, 1]), at_0000, "{firmware:?}");
        // Who knows the address finds it where table 1 says, and only there.
        assert_eq!(serve(&mut sensor, 0, 7, &[3, 0, 0x30, 0, 1]), Some((UnitId(7), vec![3, 2, 0, 7])));
        assert_eq!(serve(&mut sensor, 0, 7, &[3, 0, 0, 0, 1]), Some((UnitId(7), vec![0x83, 2])));
    }
}

#[test]
fn it_takes_seven_and_eight_data_bits_in_ascii_and_eight_only_in_rtu() {
    let seven = LineSettings { data_bits: DataBits::Seven, ..FACTORY };
    let mut bench = Bench::new(Config::new(seven, Mode::Rtu));
    assert!(is_silence(&bench.ask(1, BOTH)));
    assert!(bench.sensor().preset(0x60, 2));
    let mut took = Vec::new();
    for line in [seven, FACTORY] {
        bench.reopen(line, Mode::Ascii);
        let exchange = bench.ask(1, BOTH);
        assert_eq!(micrometres(&exchange), Some(-328), "{line}");
        took.push(exchange.round_trip.unwrap());
    }
    // The answer comes in as many data bits as the question: of 17 and 27 characters, each is a bit shorter.
    let bits_saved = (took[1].as_secs_f64() - took[0].as_secs_f64()) * 9600.0;
    assert!((bits_saved - 44.0).abs() < 1.0, "{bits_saved}");
}

#[test]
fn what_it_has_not_said_when_the_supply_is_cut_it_never_says() {
    let mut sensor = Bench::factory();
    sensor.line.handle_settings(START, FACTORY);
    sensor.line.handle_bytes(START, &[0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5]);
    let answering = START + FACTORY.character_time(8 + 4) + Duration::from_millis(9);
    sensor.line.handle_timeout(answering);
    let said = sensor.line.poll_transmit().unwrap_or_default();
    assert!((1..7).contains(&said.len()), "{said:?}");
    sensor.line.power_cycle(answering);
    sensor.line.handle_timeout(Instant::from_micros(u64::MAX));
    assert_eq!(sensor.line.poll_transmit(), None);
}
