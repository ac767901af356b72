//! The simulated sensors obey their manuals, asked by the master and read by their profiles.

mod common;

use std::time::Duration;

use buslens_bus::sim::{Course, Described, Device, GaugeCable, Level, Lvdt, Motion, sensor};
use buslens_bus::time::Instant;
use buslens_bus::{Answer, Config, Failure};
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::pdu::{ExceptionCode, Request, Response, unpack_bits};
use buslens_codec::profile::{BUILT_IN, Group, Known, Profile};
use buslens_codec::value::Value;
use common::{Bench, START};
use proptest::prelude::*;

const GAUGE_LINE: LineSettings = LineSettings::new(38_400, Parity::None);
const LEVEL_LINE: LineSettings = LineSettings::new(9600, Parity::None);
const ZERO_GAUGE: Request = Request::WriteSingleRegister { address: 0x0800, value: 0xAB56 };
const CLEAR_RECORD: Request = Request::WriteSingleRegister { address: 0x0200, value: 0 };
const READ_BAUD: Request = read(1, 1);

const fn read(address: u16, quantity: u16) -> Request {
    Request::ReadHoldingRegisters { address, quantity }
}

const fn write(address: u16, value: u16) -> Request {
    Request::WriteSingleRegister { address, value }
}

fn gauge(course: Course) -> Bench<GaugeCable> {
    Bench::with(Config::new(GAUGE_LINE, Mode::Rtu), GaugeCable::new(1, course, START))
}

fn level(course: Course) -> Bench<Level> {
    Bench::with(Config::new(LEVEL_LINE, Mode::Rtu), Level::new(1, course))
}

fn built_in(id: &str) -> Profile {
    BUILT_IN.iter().map(|text| Profile::from_json(text).unwrap()).find(|profile| profile.id == id).unwrap()
}

/// Id, value and unit of every point that these reads bring.
fn shown<D: Device>(bench: &mut Bench<D>, profile: &Profile, groups: &[Group]) -> Vec<String> {
    let (mut known, mut all) = (Known::default(), Vec::new());
    for group in groups {
        let exchange = bench.ask(profile.unit, group.request().unwrap());
        let points = match exchange.result {
            Ok(Answer::Reply(Response::ReadHoldingRegisters { values } | Response::ReadInputRegisters { values })) => {
                profile.decode_points(group.function, group.address, &values, &mut known)
            }
            Ok(Answer::Reply(Response::ReadCoils { status } | Response::ReadDiscreteInputs { status })) => {
                profile.decode_bits(group.function, group.address, &unpack_bits(&status, group.quantity.into()))
            }
            _ => panic!("{group:?}: {exchange:?}"),
        };
        for found in points {
            assert!(found.scaled);
            let text = found.point.text(found.value.unwrap(), |texts| &texts.en);
            all.push([&found.point.id, " ", &text, " ", found.unit].concat().trim_end().to_owned());
        }
    }
    all
}

fn registers<D: Device>(bench: &mut Bench<D>, unit: u8, request: Request) -> Vec<u16> {
    match bench.ask(unit, request).result {
        Ok(Answer::Reply(Response::ReadHoldingRegisters { values } | Response::ReadInputRegisters { values })) => {
            values
        }
        other => panic!("{other:?}"),
    }
}

fn is_echoed<D: Device>(bench: &mut Bench<D>, unit: u8, request: Request) -> bool {
    let exchange = bench.ask(unit, request);
    // Before a read the master does not know whether the adapter echoes; here it does not.
    matches!(exchange.result, Ok(_) | Err(Failure::Unproven)) && exchange.sent == exchange.received
}

fn is_silent<D: Device>(bench: &mut Bench<D>, unit: u8, request: Request) -> bool {
    let exchange = bench.ask(unit, request);
    // A late answer would be one to the next question.
    bench.run(Duration::from_secs(5));
    matches!(exchange.result, Err(Failure::NoAnswer { .. }))
}

#[track_caller]
fn assert_refused<D: Device>(bench: &mut Bench<D>, refused: impl IntoIterator<Item = (Request, ExceptionCode)>) {
    for (request, code) in refused {
        let exchange = bench.ask(1, request.clone());
        assert_eq!(exchange.result, Err(Failure::Exception { function: request.function(), code }), "{request:?}");
        assert_eq!(exchange.received.len(), 5);
    }
}

#[test]
fn the_gauge_answers_with_the_frames_of_its_manual() {
    let mut bench = gauge(Course::Rest(-4661));
    let exchange = bench.ask(1, read(0x0000, 2));
    assert_eq!(exchange.sent, [0x01, 0x03, 0x00, 0x00, 0x00, 0x02, 0xC4, 0x0B]);
    assert_eq!(exchange.received, [0x01, 0x03, 0x04, 0x01, 0x00, 0x12, 0x35, 0x37, 0x78]);
    let exchange = bench.ask(1, ZERO_GAUGE);
    assert_eq!(exchange.received, [0x01, 0x06, 0x08, 0x00, 0xAB, 0x56, 0x74, 0xA4]);
    let exchange = bench.ask(1, CLEAR_RECORD);
    assert_eq!(exchange.received, [0x01, 0x06, 0x02, 0x00, 0x00, 0x00, 0x88, 0x72]);
}

#[test]
fn the_gauges_record_counts_from_the_hosts_last_zero() {
    let mut bench = gauge(Course::Rest(1000));
    let profile = built_in("gauge-cable");
    let go = |bench: &mut Bench<GaugeCable>, micrometres| {
        let now = bench.now;
        bench.sensor().set_course(now, Course::Rest(micrometres));
        bench.run(Duration::from_secs(1));
    };
    let all = |bench: &mut Bench<GaugeCable>| shown(bench, &profile, &profile.live_groups());
    go(&mut bench, -250);
    go(&mut bench, 500);
    let expected = ["reading 0.500 mm", "maximum 1.000 mm", "minimum -0.250 mm", "range 1.250 mm"];
    assert_eq!(all(&mut bench), expected);
    // The host's zero: everything starts anew from here.
    assert!(is_echoed(&mut bench, 1, ZERO_GAUGE));
    assert_eq!(all(&mut bench), ["reading 0.000 mm", "maximum 0.000 mm", "minimum 0.000 mm", "range 0.000 mm"]);
    go(&mut bench, 700);
    assert_eq!(all(&mut bench), ["reading 0.200 mm", "maximum 0.200 mm", "minimum 0.000 mm", "range 0.200 mm"]);
    // The gauge's own key does not start it anew.
    let now = bench.now;
    bench.sensor().zero_by_key(now);
    assert_eq!(all(&mut bench), ["reading 0.000 mm", "maximum 0.200 mm", "minimum 0.000 mm", "range 0.200 mm"]);
    // Clearing starts at the present reading and leaves zero where it is.
    go(&mut bench, 1300);
    assert!(is_echoed(&mut bench, 1, CLEAR_RECORD));
    go(&mut bench, 1200);
    assert_eq!(all(&mut bench), ["reading 0.500 mm", "maximum 0.600 mm", "minimum 0.500 mm", "range 0.100 mm"]);
}

#[test]
fn the_cable_records_while_nobody_asks() {
    for seconds in [17, 3600] {
        let mut bench = gauge(Course::Swing);
        bench.run(Duration::from_secs(seconds));
        let range = registers(&mut bench, 1, read(0x0300, 2));
        assert_eq!(range[0], 0);
        assert!((9700..=9920).contains(&range[1]), "{seconds} s: {range:?}");
    }
}

#[test]
fn no_reading_of_the_gauge_lies_outside_its_record() {
    let mut bench = gauge(Course::Swing);
    let signed = |pair: Vec<u16>| if pair[0] == 0 { i32::from(pair[1]) } else { -i32::from(pair[1]) };
    for _ in 0..100 {
        bench.run(Duration::from_millis(333));
        let reading = signed(registers(&mut bench, 1, read(0x0000, 2)));
        let max = signed(registers(&mut bench, 1, read(0x0100, 2)));
        let min = signed(registers(&mut bench, 1, read(0x0200, 2)));
        assert!((min..=max).contains(&reading), "{min} {reading} {max}");
    }
}

#[test]
fn the_gauge_refuses_what_its_manual_does_not_know() {
    let mut bench = gauge(Course::Rest(0));
    let address = ExceptionCode::IllegalDataAddress;
    let value = ExceptionCode::IllegalDataValue;
    let function = ExceptionCode::IllegalFunction;
    let refused = [
        (read(0x0000, 1), address),
        (read(0x0000, 4), address),
        (read(0x0001, 2), address),
        (read(0x0800, 2), address),
        (write(0x0000, 0), address),
        (write(0x0800, 0), value),
        (write(0x0200, 1), value),
        (Request::ReadInputRegisters { address: 0, quantity: 2 }, function),
        (Request::WriteMultipleRegisters { address: 0x0200, values: vec![0] }, function),
    ];
    assert_refused(&mut bench, refused);
}

#[test]
fn the_gauge_says_no_more_than_its_format_holds() {
    let mut bench = gauge(Course::Rest(-70_000));
    assert_eq!(registers(&mut bench, 1, read(0x0000, 2)), [0x0100, 0xFFFF]);
}

#[test]
fn the_gauge_is_silent_at_other_settings_and_units() {
    let mut bench = gauge(Course::Rest(0));
    assert!(is_silent(&mut bench, 2, read(0, 2)));
    for line in [LineSettings::new(9600, Parity::None), LineSettings::new(38_400, Parity::Even)] {
        bench.reopen(line, Mode::Rtu);
        assert!(is_silent(&mut bench, 1, read(0, 2)), "{line}");
    }
    assert!(bench.sensor().preset_baud(9600) && !bench.sensor().preset_baud(115_200));
    bench.reopen(LEVEL_LINE, Mode::Rtu);
    assert_eq!(registers(&mut bench, 1, read(0, 2)), [0, 0]);
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
    bench.sensor().power_cycle();
    assert_eq!(registers(&mut bench, 1, read(4, 1)), [100]);
    bench.sensor().keeps_unsaved = true;
    assert!(is_echoed(&mut bench, 1, write(0x000C, 50)));
    bench.sensor().power_cycle();
    assert_eq!(registers(&mut bench, 1, read(4, 1)), [150]);
    bench.sensor().keeps_unsaved = false;
    assert!(is_echoed(&mut bench, 1, write(0x000F, 0)));
    bench.sensor().power_cycle();
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

/// A profile without a simulated sensor: every encoding that a demonstration should move, and settings of all kinds.
const STRANGER: &str = r#"{
  "format": 1, "id": "stranger", "name": { "en": "Stranger", "zh": "陌生设备" },
  "line": { "baud": 19200, "parity": "odd", "stop_bits": "two" }, "mode": "rtu", "unit": 42, "units": { "first": 1, "last": 247 },
  "timing": { "response_timeout_ms": 500, "poll_period_ms": 200, "startup_silence_ms": 800 },
  "points": [
    { "id": "pressure", "name": { "en": "Pressure", "zh": "压力" }, "register": 0, "encoding": { "type": "f32", "order": "CDAB" }, "read": [4], "unit": "bar", "role": "measurement", "primary": true, "range": { "first": -1, "last": 2.5 } },
    { "id": "flow", "name": { "en": "Flow", "zh": "流量" }, "register": 4, "encoding": { "type": "i32" }, "decimals_from": "digits", "read": [4], "unit": "l/min", "role": "measurement" },
    { "id": "speed", "name": { "en": "Speed", "zh": "转速" }, "register": 6, "encoding": { "type": "u16", "decimals": -2 }, "read": [4], "unit": "rpm", "role": "measurement", "range": { "first": 0, "last": 6000 } },
    { "id": "digits", "name": { "en": "Digits", "zh": "小数位" }, "register": 100, "encoding": { "type": "u16" }, "read": [3], "role": "parameter", "factory": 2 },
    { "id": "unit_id", "name": { "en": "Unit id", "zh": "从机地址" }, "register": 101, "encoding": { "type": "u16" }, "read": [3], "write": [6, 16], "role": "parameter", "range": { "first": 1, "last": 247 }, "effects": ["unit"], "reply": "old" },
    { "id": "line", "name": { "en": "Baud rate", "zh": "波特率" }, "register": 102, "encoding": { "type": "code" }, "read": [3], "write": [6, 16], "role": "parameter", "effects": ["baud"], "reply": "new",
      "codes": [ { "code": 96, "number": 9600 }, { "code": 192, "number": 19200 } ] },
    { "id": "filter", "name": { "en": "Filter", "zh": "滤波" }, "register": 110, "encoding": { "type": "u16", "decimals": 1 }, "read": [3], "write": [6], "unit": "s", "role": "parameter", "range": { "first": 0.5, "last": 10 } },
    { "id": "alarm", "name": { "en": "Alarm", "zh": "报警" }, "register": 5, "encoding": { "type": "code" }, "read": [1], "write": [5], "role": "parameter", "codes": [ { "code": 0, "name": { "en": "off", "zh": "关" } }, { "code": "0xFF00", "name": { "en": "on", "zh": "开" } } ] },
    { "id": "reset", "name": { "en": "Reset", "zh": "复位" }, "register": 200, "encoding": { "type": "code" }, "write": [6], "role": "command", "effects": ["restart", "defaults"], "codes": [ { "code": 1, "name": { "en": "reset", "zh": "复位" } } ] }
  ],
  "groups": [ { "function": 4, "address": 0, "quantity": 7 } ],
  "examples": [ { "point": "flow", "registers": [0, 1250], "decimals": 2, "text": "12.50" } ]
}"#;

fn stranger() -> Bench<Box<dyn Device>> {
    let profile = Profile::from_json(STRANGER).unwrap();
    Bench::with(Config::new(profile.line, profile.mode), sensor(profile, START))
}

#[test]
fn any_profile_becomes_a_device_that_moves() {
    let profile = Profile::from_json(STRANGER).unwrap();
    let mut bench = stranger();
    let mut rounds = Vec::new();
    for _ in 0..20 {
        bench.run(Duration::from_secs(1));
        let all = shown(&mut bench, &profile, &[profile.live_groups(), profile.groups_of(&profile.points)].concat());
        rounds.push(all);
    }
    let number = |text: &str| text.split(' ').nth(1).unwrap().parse::<f64>().unwrap();
    let all_of = |id: &str| -> Vec<f64> {
        let lines = rounds.iter().map(|all| all.iter().rfind(|line| line.starts_with(id)).unwrap());
        lines.map(|line| number(line)).collect()
    };
    for (id, low, high) in [("pressure", -1.0, 2.5), ("flow", 6.25, 12.5), ("speed", 0.0, 6000.0)] {
        let values = all_of(id);
        assert!(values.iter().all(|value| (low..=high).contains(value)), "{id}: {values:?}");
        assert!(values.windows(2).filter(|pair| (pair[0] - pair[1]).abs() > 1e-9).count() > 10, "{id}: {values:?}");
    }
    assert!(
        rounds[0].iter().any(|line| line.ends_with(" bar")) && rounds[0].iter().any(|line| line.ends_with(" l/min"))
    );
    for fixed in ["digits 2", "unit_id 42", "line 19200", "filter 0.5 s"] {
        assert!(rounds[0].iter().any(|line| line == fixed), "{fixed}: {:?}", rounds[0]);
    }
}

#[test]
fn a_device_of_a_profile_takes_what_the_profile_allows() {
    let mut bench = stranger();
    let exception = |exchange: buslens_bus::Exchange| match exchange.result {
        Err(Failure::Exception { code, .. }) => code,
        other => panic!("{other:?}"),
    };
    for (request, code) in [
        (write(110, 4), ExceptionCode::IllegalDataValue),
        (write(100, 1), ExceptionCode::IllegalDataAddress),
        (write(102, 1), ExceptionCode::IllegalDataValue),
        (write(0, 1), ExceptionCode::IllegalDataAddress),
        (read(103, 1), ExceptionCode::IllegalDataAddress),
        (Request::ReadDiscreteInputs { address: 5, quantity: 1 }, ExceptionCode::IllegalFunction),
    ] {
        assert_eq!(exception(bench.ask(42, request.clone())), code, "{request:?}");
    }
    assert!(is_echoed(&mut bench, 42, write(110, 25)));
    assert_eq!(registers(&mut bench, 42, read(110, 1)), [25]);
    assert!(is_echoed(&mut bench, 42, Request::WriteSingleCoil { address: 5, on: true }));
    let coils = bench.ask(42, Request::ReadCoils { address: 5, quantity: 1 });
    assert_eq!(coils.received[..4], [42, 0x01, 0x01, 0x01]);
    assert!(is_silent(&mut bench, 0, read(110, 1)), "the profile knows no broadcast");
    // Two settings in one request; the reply comes from the old unit and, as the profile says, at the new baud rate.
    let line = LineSettings { baud: 9600, ..Profile::from_json(STRANGER).unwrap().line };
    assert!(bench.ask(42, Request::WriteMultipleRegisters { address: 101, values: vec![7, 96] }).result.is_err());
    bench.reopen(line, Mode::Rtu);
    assert_eq!(registers(&mut bench, 7, read(101, 2)), [7, 96]);
    // The reset is echoed; then the device is deaf, and back at its first settings.
    assert!(is_echoed(&mut bench, 7, write(200, 1)));
    bench.reopen(Profile::from_json(STRANGER).unwrap().line, Mode::Rtu);
    assert!(is_silent(&mut bench, 42, read(110, 1)));
    assert_eq!(registers(&mut bench, 42, read(110, 1)), [5]);
}

#[test]
fn every_built_in_profile_has_a_sensor_that_moves_as_it_says() {
    for text in BUILT_IN {
        let profile = || Profile::from_json(text).unwrap();
        for device in [sensor(profile(), START), Box::new(Described::new(profile()))] {
            let profile = profile();
            let mut bench = Bench::with(Config::new(profile.line, profile.mode), device);
            let primary = &profile.measurements()[0].id;
            let mut seen: Vec<String> = Vec::new();
            for _ in 0..20 {
                bench.run(Duration::from_millis(700));
                let all = shown(&mut bench, &profile, &profile.live_groups());
                assert!(profile.measurements().iter().all(|point| all.iter().any(|line| line.starts_with(&point.id))));
                seen.extend(all.into_iter().filter(|line| line.starts_with(primary.as_str())));
            }
            seen.dedup();
            assert!(seen.len() > 15, "{}: {seen:?}", profile.id);
        }
    }
}

#[test]
fn a_file_that_only_has_the_name_of_a_sensor_gets_a_device_of_its_own() {
    for (from, to) in
        [("\"baud\": 38400", "\"baud\": 9600"), ("\"0x0300\"", "\"0x0310\""), ("\"unit\": 1", "\"unit\": 5")]
    {
        let text = BUILT_IN.iter().find(|text| text.contains("\"gauge-cable\"")).unwrap().replace(from, to);
        let profile = Profile::from_json(&text).unwrap();
        let mut bench = Bench::with(Config::new(profile.line, profile.mode), sensor(profile.clone(), START));
        let found = shown(&mut bench, &profile, &profile.live_groups());
        assert_eq!(found.len(), 4, "{to}: {found:?}");
    }
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

proptest! {
    #[test]
    fn no_request_panics_and_every_answer_belongs_to_it(
        requests in prop::collection::vec((any::<u8>(), prop_oneof![Just(0_u8), Just(1), 3..7_u8, Just(16), any::<u8>()], prop::collection::vec(prop_oneof![0..4_u8, any::<u8>()], 0..12), any::<u32>()), 1..20)
    ) {
        let mut devices: Vec<Box<dyn Device>> = vec![
            Box::new(Lvdt::new(1, Motion::Swing)),
            Box::new(GaugeCable::new(1, Course::Swing, Instant::ZERO)),
            Box::new(Level::new(1, Course::Swing)),
            sensor(Profile::from_json(STRANGER).unwrap(), Instant::ZERO),
        ];
        devices.extend(BUILT_IN.iter().map(|text| -> Box<dyn Device> { Box::new(Described::new(Profile::from_json(text).unwrap())) }));
        for (unit, function, data, at) in requests {
            let pdu = [&[function], data.as_slice()].concat();
            for device in &mut devices {
                for unit in [UnitId(1), UnitId(42), UnitId(unit)] {
                    if let Some(reply) = device.serve(Instant::from_micros(at.into()), unit, &pdu) {
                        prop_assert!(reply.pdu[0] & 0x7F == function & 0x7F);
                        prop_assert!(reply.pdu.len() <= 253);
                        prop_assert_eq!(reply.unit, unit);
                    }
                }
            }
        }
    }
}
