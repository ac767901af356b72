//! The simulated sensors obey their manuals, asked by the master and read by their profiles.

mod common;

use std::time::Duration;

use buslens_bus::sim::{Course, Described, Device, GaugeCable, Level, Lvdt, Motion, sensor};
use buslens_bus::time::Instant;
use buslens_bus::{Config, Failure};
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::pdu::{ExceptionCode, Request};
use buslens_codec::profile::{BUILT_IN, Profile};
use common::asked::{assert_refused, built_in, is_echoed, is_silent, read, registers, shown, write};
use common::{Bench, START};
use proptest::prelude::*;

const GAUGE_LINE: LineSettings = LineSettings::new(38_400, Parity::None);
const LEVEL_LINE: LineSettings = LineSettings::new(9600, Parity::None);
const ZERO_GAUGE: Request = Request::WriteSingleRegister { address: 0x0800, value: 0xAB56 };
const CLEAR_RECORD: Request = Request::WriteSingleRegister { address: 0x0200, value: 0 };

fn gauge(course: Course) -> Bench<GaugeCable> {
    Bench::with(Config::new(GAUGE_LINE, Mode::Rtu), GaugeCable::new(1, course, START))
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
    let now = bench.now;
    bench.sensor().set_course(now, Course::Rest(65_535));
    assert_eq!(registers(&mut bench, 1, read(0x0000, 2)), [0x0000, 0xFFFF]);
    bench.sensor().set_course(now, Course::Rest(65_536));
    let all = [0x0000, 0x0100, 0x0200, 0x0300].map(|register| registers(&mut bench, 1, read(register, 2)));
    assert_eq!(all, [[0, 0xFFFF], [0, 0xFFFF], [0x0100, 0xFFFF], [0, 0xFFFF]], "the range as well");
}

#[test]
fn the_cable_forgets_its_record_without_its_supply_and_the_gauge_keeps_its_zero() {
    let mut bench = gauge(Course::Rest(1000));
    assert!(is_echoed(&mut bench, 1, ZERO_GAUGE));
    let now = bench.now;
    bench.sensor().set_course(now, Course::Rest(1800));
    bench.sensor().set_course(now, Course::Rest(1300));
    assert_eq!(registers(&mut bench, 1, read(0x0100, 2)), [0, 800]);
    bench.power_cycle();
    let all = [0x0000, 0x0100, 0x0200, 0x0300].map(|register| registers(&mut bench, 1, read(register, 2))[1]);
    assert_eq!(all, [300, 300, 300, 0]);
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
fn a_device_of_a_profile_can_be_in_any_state() {
    let mut bench = stranger();
    assert!(bench.sensor().preset(110, 25) && bench.sensor().preset(100, 1), "also what nobody may write");
    // No such register, a value that it does not take, a code that nobody knows, a table that is not meant.
    for (register, value) in [(103, 1), (110, 4), (102, 1), (0, 1)] {
        assert!(!bench.sensor().preset(register, value), "{register} {value}");
    }
    assert_eq!(registers(&mut bench, 42, read(110, 1)), [25]);
    assert_eq!(registers(&mut bench, 42, read(102, 1)), [192]);
    assert!(bench.sensor().preset(101, 7) && bench.sensor().preset(102, 96));
    assert!(is_silent(&mut bench, 42, read(110, 1)));
    let line = LineSettings { baud: 9600, ..Profile::from_json(STRANGER).unwrap().line };
    bench.reopen(line, Mode::Rtu);
    assert_eq!(registers(&mut bench, 7, read(101, 2)), [7, 96]);
    assert_eq!(bench.sensor().flash_writes(), 0);
    assert!(is_echoed(&mut bench, 7, write(110, 30)));
    assert_eq!(bench.sensor().flash_writes(), 1);
    // It is deaf for a while after a power failure, and is then as it was.
    bench.power_cycle();
    assert!(is_silent(&mut bench, 7, read(110, 1)));
    assert_eq!(registers(&mut bench, 7, read(110, 1)), [30]);
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
