//! The simulated level transmitter obeys its protocol, asked by the master and read by its profile.

mod common;

use std::time::Duration;

use buslens_bus::sim::{Course, Device, Level};
use buslens_bus::{Answer, Config};
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::pdu::{ExceptionCode, Request, Response};
use buslens_codec::profile::Known;
use buslens_codec::value::Value;
use common::Bench;
use common::asked::{assert_refused, built_in, is_echoed, is_silent, read, registers, shown, write};

const LEVEL_LINE: LineSettings = LineSettings::new(9600, Parity::None);
const READ_BAUD: Request = read(1, 1);

fn level(course: Course) -> Bench<Level> {
    Bench::with(Config::new(LEVEL_LINE, Mode::Rtu), Level::new(1, course))
}

#[test]
fn a_level_comes_out_in_its_scale_and_unit() {
    let mut bench = level(Course::Rest(6000));
    let profile = built_in("level");
    let live = profile.live_groups();
    assert_eq!(shown(&mut bench, &profile, &live)[2], "value 6.000 mH₂O");
    assert!(bench.sensor().preset(2, 1) && bench.sensor().preset(3, 1));
    assert_eq!(shown(&mut bench, &profile, &live), ["decimals 1", "unit kPa", "value 600.0 kPa"]);
    // Output = calibrated value + zero offset.
    assert!(is_echoed(&mut bench, 1, write(0x000C, (-25_i16).cast_unsigned())));
    assert_eq!(shown(&mut bench, &profile, &live)[2], "value 597.5 kPa");
    bench.sensor().course = Course::Rest(-32_768);
    assert_eq!(shown(&mut bench, &profile, &live)[2], "value -3276.8 kPa");
    let every = profile.groups_of(&profile.points);
    let expected = [
        "address 1",
        "baud 9600 Bd",
        "unit kPa",
        "decimals 1",
        "value -3276.8 kPa",
        "range_zero 0.0 kPa",
        "range_full 1000.0 kPa",
        "zero_offset -2.5 kPa",
    ];
    assert_eq!(every.len(), expected.len());
    let found = shown(&mut bench, &profile, &[&profile.groups, &every[7..]].concat());
    assert_eq!(found, expected, "the block that may work brings the same");
}

#[test]
fn a_level_transmitter_may_know_single_reads_only() {
    let mut bench = level(Course::Rest(0));
    assert_eq!(registers(&mut bench, 1, read(0, 7)), [1, 3, 7, 3, 0, 0, 10_000]);
    let address = ExceptionCode::IllegalDataAddress;
    assert_refused(&mut bench, [(read(0, 8), address), (read(6, 7), address), (read(0x000B, 2), address)]);
    bench.sensor().answers_blocks = false;
    assert_refused(&mut bench, [(read(0, 7), address), (read(3, 2), address)]);
    assert_eq!(registers(&mut bench, 1, read(6, 1)), [10_000]);
}

#[test]
fn a_level_transmitter_refuses_what_users_may_not_write() {
    let mut bench = level(Course::Rest(0));
    let address = ExceptionCode::IllegalDataAddress;
    let value = ExceptionCode::IllegalDataValue;
    let function = ExceptionCode::IllegalFunction;
    let calibration = (2..=6).map(|register| (write(register, 1), address));
    let others = [
        (write(0, 0), value),
        (write(0, 256), value),
        (write(1, 8), value),
        (write(0x000F, 2), value),
        (write(0x0010, 0), value),
        (write(0x0020, 0), address),
        (read(0x000F, 1), address),
        (read(7, 1), address),
        (Request::ReadInputRegisters { address: 4, quantity: 1 }, function),
        (Request::WriteMultipleRegisters { address: 0, values: vec![2] }, function),
    ];
    assert_refused(&mut bench, calibration.chain(others));
    assert_eq!(registers(&mut bench, 1, read(0, 7)), [1, 3, 7, 3, 0, 0, 10_000]);
}

#[test]
fn a_change_of_the_baud_rate_is_answered_at_the_old_one() {
    let mut bench = level(Course::Rest(0));
    let exchange = bench.ask(1, write(1, 7));
    assert_eq!(exchange.received, exchange.sent);
    assert!(is_silent(&mut bench, 1, READ_BAUD));
    bench.reopen(LineSettings::new(115_200, Parity::None), Mode::Rtu);
    assert_eq!(registers(&mut bench, 1, READ_BAUD), [7]);
    // Always without parity.
    bench.reopen(LineSettings::new(115_200, Parity::Even), Mode::Rtu);
    assert!(is_silent(&mut bench, 1, READ_BAUD));
}

#[test]
fn a_change_of_the_address_is_answered_from_the_old_one() {
    let mut bench = level(Course::Rest(0));
    assert!(is_echoed(&mut bench, 1, write(0, 255)));
    assert!(is_silent(&mut bench, 1, READ_BAUD));
    assert_eq!(registers(&mut bench, 255, read(0, 1)), [255]);
    assert!(is_silent(&mut bench, 0, READ_BAUD), "it knows no broadcast");
}

#[test]
fn a_restore_brings_back_what_was_saved_to_the_factory_area() {
    let mut bench = level(Course::Rest(100));
    assert!(is_echoed(&mut bench, 1, write(0x000C, 50)));
    assert!(is_echoed(&mut bench, 1, write(0, 9)));
    // Unsaved: gone with the supply, unless the device keeps it.
    bench.power_cycle();
    assert_eq!(registers(&mut bench, 1, read(4, 1)), [100]);
    assert_eq!(bench.sensor().flash_writes(), 0);
    bench.sensor().keeps_unsaved = true;
    assert!(is_echoed(&mut bench, 1, write(0x000C, 50)));
    bench.power_cycle();
    assert_eq!(registers(&mut bench, 1, read(4, 1)), [150]);
    bench.sensor().keeps_unsaved = false;
    assert!(is_echoed(&mut bench, 1, write(0x000F, 0)));
    assert_eq!(bench.sensor().flash_writes(), 2);
    bench.power_cycle();
    assert_eq!(registers(&mut bench, 1, read(4, 1)), [150]);
    // The restore is answered at the old settings, and then everything is as it left the factory.
    assert!(is_echoed(&mut bench, 1, write(0, 9)) && is_echoed(&mut bench, 9, write(1, 4)));
    bench.reopen(LineSettings::new(19_200, Parity::None), Mode::Rtu);
    assert!(is_echoed(&mut bench, 9, write(0x0010, 1)));
    assert!(is_silent(&mut bench, 9, READ_BAUD) && is_silent(&mut bench, 1, READ_BAUD));
    bench.reopen(LEVEL_LINE, Mode::Rtu);
    assert_eq!(registers(&mut bench, 1, read(4, 1)), [100]);
    // Saved to the factory area, a change comes back with the restore.
    assert!(is_echoed(&mut bench, 1, write(0x000C, 7)) && is_echoed(&mut bench, 1, write(0x000F, 1)));
    assert!(is_echoed(&mut bench, 1, write(0x000C, 0)) && is_echoed(&mut bench, 1, write(0x0010, 1)));
    assert_eq!(registers(&mut bench, 1, read(4, 1)), [107]);
}

#[test]
fn a_restore_may_bring_another_address_and_baud_rate() {
    let mut bench = level(Course::Rest(100));
    assert!(
        [(0, 77), (1, 5), (0xC, 3)].iter().all(|&(register, value)| bench.sensor().preset_factory(register, value))
    );
    assert!(!bench.sensor().preset_factory(1, 8) && !bench.sensor().preset(0x0004, 1));
    // Until then nothing shows it, not even a power failure.
    bench.power_cycle();
    assert_eq!(registers(&mut bench, 1, read(0, 2)), [1, 3]);
    assert!(is_echoed(&mut bench, 1, write(0x0010, 1)));
    assert!(is_silent(&mut bench, 1, READ_BAUD) && is_silent(&mut bench, 77, READ_BAUD));
    bench.reopen(LineSettings::new(38_400, Parity::None), Mode::Rtu);
    assert_eq!(registers(&mut bench, 77, read(0, 2)), [77, 5]);
    assert_eq!(registers(&mut bench, 77, read(4, 1)), [103]);
    bench.power_cycle();
    assert_eq!(registers(&mut bench, 77, read(0, 2)), [77, 5], "it is what the user has now");
}

#[test]
fn the_two_areas_of_a_level_transmitter_are_apart() {
    let mut bench = level(Course::Rest(0));
    let offset = |bench: &mut Bench<Level>| registers(bench, 1, read(0xC, 1))[0];
    assert!(is_echoed(&mut bench, 1, write(0xC, 10)) && is_echoed(&mut bench, 1, write(0xF, 1)));
    assert!(is_echoed(&mut bench, 1, write(0xC, 20)) && is_echoed(&mut bench, 1, write(0xF, 0)));
    assert!(is_echoed(&mut bench, 1, write(0xC, 30)));
    assert_eq!(offset(&mut bench), 30);
    bench.power_cycle();
    assert_eq!(offset(&mut bench), 20);
    assert!(is_echoed(&mut bench, 1, write(0x10, 1)));
    assert_eq!(offset(&mut bench), 10);
}

#[test]
fn a_swinging_level_stays_in_its_range() {
    let mut bench = level(Course::Swing);
    bench.poll_every(Duration::from_millis(500), [read(4, 1)]);
    let exchanges = bench.run(Duration::from_mins(2));
    let values: Vec<u16> =
        exchanges.iter().map(|exchange| u16::from_be_bytes([exchange.received[3], exchange.received[4]])).collect();
    assert_eq!(values.len(), 240);
    assert!(values.iter().all(|value| (500..=9500).contains(value)), "{values:?}");
    assert!(values.iter().max().unwrap() - values.iter().min().unwrap() > 7000);
}

#[test]
fn a_level_has_up_to_three_decimals() {
    let mut bench = level(Course::Rest(1234));
    let profile = built_in("level");
    for (decimals, text) in [(0, "1234"), (1, "123.4"), (2, "12.34"), (3, "1.234")] {
        assert!(bench.sensor().preset(3, decimals));
        let exchange = bench.ask(1, read(0, 7));
        let Ok(Answer::Reply(Response::ReadHoldingRegisters { values })) = exchange.result else { panic!() };
        let found = profile.decode_points(3, 0, &values, &mut Known::default());
        let value = found.iter().find(|found| found.point.id == "value").and_then(|found| found.value.ok());
        assert_eq!(value.map(|value| Value::to_string(&value)).as_deref(), Some(text));
    }
}
