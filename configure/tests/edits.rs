//! What a user types, plans and carries over, before anything is sent.

mod common;

use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::profile::Profile;
use buslens_codec::value::Decimal;
use buslens_configure::{After, Datum, Edit, Hazard, Plan, Reach, Read, Refusal, Snapshot, Unfit, compare, edits_to};
use common::profile;

fn snapshot(profile: &Profile, held: &[(&str, &[u16])]) -> Snapshot {
    let datum = |(point, registers): &(&str, &[u16])| Datum {
        point: (*point).to_owned(),
        read: Read::Registers(registers.to_vec()),
    };
    let data = held.iter().map(datum).collect();
    Snapshot { data, ..Snapshot::empty(profile, Reach::of_factory(profile)) }
}

fn lvdt() -> (Profile, Snapshot) {
    let profile = profile("lvdt");
    let held: [(&str, &[u16]); 6] = [
        ("address", &[1]),
        ("baud", &[3]),
        ("parity", &[2]),
        ("compensation", &[2]),
        ("sample_rate", &[4]),
        ("output_mode", &[1]),
    ];
    let have = snapshot(&profile, &held);
    (profile, have)
}

fn level(decimals: u16, unit: u16, offset: u16) -> (Profile, Snapshot) {
    let profile = profile("level");
    let held: [(&str, &[u16]); 5] =
        [("address", &[1]), ("baud", &[3]), ("unit", &[unit]), ("decimals", &[decimals]), ("zero_offset", &[offset])];
    let have = snapshot(&profile, &held);
    (profile, have)
}

fn typed(profile: &Profile, have: &Snapshot, point: &str, text: &str) -> Result<Vec<u16>, Unfit> {
    let edit = Edit::parse(profile, profile.point(point).unwrap(), text, have);
    edit.map(|edit| edit.registers).map_err(|refusal| refusal.why)
}

#[test]
fn whatever_means_a_value_is_taken() {
    let (lvdt, have) = lvdt();
    for (point, text, registers) in [
        ("baud", "115200", 7),
        ("baud", " 115200 Bd ", 7),
        ("baud", "115200Bd", 7),
        ("baud", "１１５２００", 7),
        ("baud", "0x0007", 7),
        ("baud", "0x7", 7),
        ("sample_rate", "5", 3),
        ("sample_rate", "5.0 Hz", 3),
        ("parity", "None", 3),
        ("parity", "无校验", 3),
        ("output_mode", "ascii", 2),
        ("address", "247", 247),
        ("address", "+7", 7),
        ("address", "0xF7", 247),
        ("zero", "位移清零", 0xFF00),
        ("zero", "0xFF00", 0xFF00),
    ] {
        assert_eq!(typed(&lvdt, &have, point, text), Ok(vec![registers]), "{point} = {text}");
    }
    let (level, have) = level(3, 7, 0);
    for (text, register) in [("0.025", 25), ("-0.001 mH₂O", 0xFFFF), ("\u{2212}1", 0xFC18), ("0x8000", 0x8000)] {
        assert_eq!(typed(&level, &have, "zero_offset", text), Ok(vec![register]), "{text}");
    }
}

#[test]
fn what_the_device_would_refuse_is_refused_before() {
    let (lvdt, have) = lvdt();
    let range = |first, last| Unfit::OutOfRange { first: Decimal::whole(first), last: Decimal::whole(last) };
    for (point, text, why) in [
        ("baud", "3", Unfit::NotInTable),
        ("baud", "9601", Unfit::NotInTable),
        ("baud", "0x0008", Unfit::NotInTable),
        ("baud", "fast", Unfit::NotInTable),
        ("baud", "", Unfit::NotInTable),
        ("parity", "mark", Unfit::NotInTable),
        ("address", "0", range(1, 247)),
        ("address", "248", range(1, 247)),
        ("address", "-1", range(1, 247)),
        ("address", "1.5", Unfit::TooFine { decimals: 0 }),
        ("address", "one", Unfit::NotANumber),
        ("address", "0x10000", Unfit::NotItsRegisters),
        ("address", "0xZ", Unfit::NotItsRegisters),
        ("displacement", "1", Unfit::NotWritable),
        ("zero", "1", Unfit::NotItsRegisters),
    ] {
        assert_eq!(typed(&lvdt, &have, point, text), Err(why), "{point} = {text}");
    }
    let (level, have) = level(2, 7, 0);
    for (text, why) in [
        ("0.001", Unfit::TooFine { decimals: 2 }),
        (
            "327.68",
            Unfit::OutOfRange { first: Decimal::parse("-327.68").unwrap(), last: Decimal::parse("327.67").unwrap() },
        ),
        ("1,5", Unfit::NotANumber),
        ("1 kPa", Unfit::NotANumber),
    ] {
        assert_eq!(typed(&level, &have, "zero_offset", text), Err(why), "{text}");
    }
    assert_eq!(typed(&level, &have, "address", "256"), Err(range(1, 255)));
    let unread = Snapshot::empty(&level, Reach::of_factory(&level));
    assert_eq!(typed(&level, &unread, "zero_offset", "1"), Err(Unfit::NotScaled));
}

#[test]
fn a_plan_goes_from_what_is_safe_to_what_is_not() {
    let (lvdt, have) = lvdt();
    let texts = [
        ("factory_reset", "reset and restart"),
        ("zero", "zero here"),
        ("baud", "2400"),
        ("parity", "none"),
        ("sample_rate", "50"),
        ("address", "9"),
        ("compensation", "off"),
        ("output_mode", "ASCII"),
    ];
    let edits = texts.map(|(point, text)| Edit::parse(&lvdt, lvdt.point(point).unwrap(), text, &have).unwrap());
    let plan = Plan::of(&lvdt, &have, &edits).unwrap();
    let points: Vec<&str> = plan.steps.iter().map(|step| step.point.as_str()).collect();
    // What changes nothing is left out.
    assert_eq!(points, ["sample_rate", "address", "output_mode", "parity", "baud", "zero", "factory_reset"]);
    assert_eq!(plan.hazards, [Hazard::SlowBaud { baud: 2400 }, Hazard::Defaults { point: "factory_reset".to_owned() }]);
    let reach = |unit, baud, parity, mode| Reach { unit: UnitId(unit), line: LineSettings::new(baud, parity), mode };
    let targets = [
        reach(9, 9600, Parity::Even, Mode::Rtu),
        reach(9, 9600, Parity::Even, Mode::Ascii),
        reach(9, 9600, Parity::None, Mode::Ascii),
        reach(9, 2400, Parity::None, Mode::Ascii),
    ];
    assert_eq!(plan.targets, targets);
    assert_eq!(plan.ends, None);
    // Each frame goes out as the device then listens.
    assert_eq!(plan.steps[1].request, [0x01, 0x10, 0x00, 0x30, 0x00, 0x01, 0x02, 0x00, 0x09, 0x63, 0xA6]);
    assert_eq!(plan.steps[3].request, b":091000320001020003AF\r\n");
    assert_eq!(plan.steps[3].reply, b":091000320001B4\r\n");
    assert_eq!((&plan.steps[3].before, &plan.steps[3].after), (&Some(vec![2]), &vec![3]));
    let factory = [reach(9, 9600, Parity::Even, Mode::Rtu), reach(1, 9600, Parity::Even, Mode::Rtu)];
    let defaults = After::Defaults { candidates: factory.to_vec(), silence_ms: 1500 };
    assert_eq!(plan.steps[6].then, defaults);
    let reaches = plan.reaches();
    assert_eq!(reaches.len(), 5);
    assert!(targets.iter().chain(&factory).chain([&have.reach]).all(|reach| reaches.contains(reach)));
}

#[test]
fn everything_that_loses_something_asks_for_a_deliberate_second_action() {
    let (level, have) = level(3, 7, 0);
    for (point, text, hazard) in [
        ("save", "to the user area", None),
        ("save", "to the factory area", Some(Hazard::Grave { point: "save".to_owned(), registers: vec![1] })),
        ("restore_factory", "restore factory settings", Some(Hazard::Search { point: "restore_factory".to_owned() })),
        ("address", "247", None),
        ("address", "248", Some(Hazard::ReservedUnit { unit: 248 })),
        ("baud", "4800", Some(Hazard::SlowBaud { baud: 4800 })),
        ("baud", "115200", None),
        ("zero_offset", "0.1", None),
    ] {
        let edit = Edit::parse(&level, level.point(point).unwrap(), text, &have).unwrap();
        let plan = Plan::of(&level, &have, &[edit]).unwrap();
        assert_eq!(plan.hazards, hazard.into_iter().collect::<Vec<_>>(), "{point} = {text}");
    }
    let everybody = Snapshot { reach: Reach { unit: UnitId(0), ..have.reach }, ..have };
    let edit = Edit { point: "zero_offset".to_owned(), registers: vec![1] };
    assert_eq!(Plan::of(&level, &everybody, &[edit]).unwrap().hazards, [Hazard::Broadcast]);
}

#[test]
fn everything_wrong_with_a_plan_is_told_at_once() {
    let (lvdt, have) = lvdt();
    let edit = |point: &str, register| Edit { point: point.to_owned(), registers: vec![register] };
    let edits = [
        edit("nothing", 1),
        edit("temperature", 1),
        edit("baud", 8),
        edit("parity", 1),
        edit("parity", 3),
        edit("zero", 7),
        edit("factory_reset", 0xFF00),
    ];
    let refused = Plan::of(&lvdt, &have, &edits).unwrap_err();
    let refuse = |point: &str, why| Refusal { point: point.to_owned(), why };
    let wanted = [
        refuse("nothing", Unfit::UnknownPoint),
        refuse("temperature", Unfit::NotWritable),
        refuse("baud", Unfit::NotInTable),
        refuse("parity", Unfit::Twice),
        refuse("zero", Unfit::NotItsRegisters),
    ];
    assert_eq!(refused, wanted);
}

#[test]
fn a_command_needs_no_snapshot() {
    for (id, point) in [("lvdt", "zero"), ("gauge-cable", "clear_record"), ("level", "save")] {
        let profile = profile(id);
        let nothing = Snapshot::empty(&profile, Reach::of_factory(&profile));
        let code = profile.point(point).unwrap().codes[0].code;
        let plan = Plan::of(&profile, &nothing, &[Edit { point: point.to_owned(), registers: vec![code] }]).unwrap();
        let [step] = plan.steps.as_slice() else { panic!("{id}: {plan:?}") };
        assert_eq!((&step.before, &step.then), (&None, &After::Same), "{id}");
    }
}

/// A sensor whose alarms share a register, and whose relay is a coil.
fn alarms() -> Profile {
    Profile::from_json(
        r#"{ "format": 1, "id": "alarms", "name": { "en": "Alarms", "zh": "报警" },
        "line": { "baud": 9600, "parity": "none" }, "mode": "rtu", "unit": 1, "units": { "first": 1, "last": 247 },
        "timing": { "response_timeout_ms": 300, "poll_period_ms": 200 },
        "points": [
          { "id": "low", "name": { "en": "Low", "zh": "低" }, "register": 0, "encoding": { "type": "bits", "mask": "0x000F" }, "read": [3], "write": [6], "role": "parameter" },
          { "id": "high", "name": { "en": "High", "zh": "高" }, "register": 0, "encoding": { "type": "bits", "mask": "0x00F0" }, "read": [3], "write": [6], "role": "parameter" },
          { "id": "tag", "name": { "en": "Tag", "zh": "位号" }, "register": 1, "encoding": { "type": "text", "registers": 2 }, "read": [3], "write": [16], "role": "parameter" },
          { "id": "relay", "name": { "en": "Relay", "zh": "继电器" }, "register": 5, "encoding": { "type": "code" }, "read": [1], "write": [15], "role": "parameter",
            "codes": [ { "code": 0, "name": { "en": "off", "zh": "关" } }, { "code": "0xFF00", "name": { "en": "on", "zh": "开" } } ] }
        ] }"#,
    )
    .unwrap()
}

#[test]
fn bits_of_one_register_are_written_one_after_the_other() {
    let profile = alarms();
    let have = snapshot(&profile, &[("low", &[0xAB12]), ("high", &[0xAB12]), ("tag", &[0x4142, 0]), ("relay", &[0])]);
    let edits = [("low", "5"), ("high", "0x6"), ("tag", "T-7"), ("relay", "on")]
        .map(|(point, text)| Edit::parse(&profile, profile.point(point).unwrap(), text, &have).unwrap());
    assert_eq!(edits[1].registers, [0x0060]);
    let plan = Plan::of(&profile, &have, &edits).unwrap();
    let steps: Vec<_> = plan.steps.iter().map(|step| (step.before.clone().unwrap(), step.after.clone())).collect();
    let wanted = [
        (vec![0xAB12], vec![0xAB15]),
        (vec![0xAB15], vec![0xAB65]),
        (vec![0x4142, 0], vec![0x542D, 0x3700]),
        (vec![0], vec![0xFF00]),
    ];
    assert_eq!(steps, wanted);
    assert_eq!(plan.steps[3].request[..7], [0x01, 0x0F, 0x00, 0x05, 0x00, 0x01, 0x01]);
    assert_eq!(typed(&profile, &have, "tag", "TAG-7"), Err(Unfit::NotAText { most: 4 }));
    assert_eq!(typed(&profile, &have, "tag", "位"), Err(Unfit::NotAText { most: 4 }));
    assert_eq!(typed(&profile, &have, "high", "16"), Err(Unfit::TooLarge));
    // Unread, the other bits would be lost.
    let nothing = Snapshot::empty(&profile, have.reach);
    let refused = Plan::of(&profile, &nothing, &edits[..1]).unwrap_err();
    assert_eq!(refused, [Refusal { point: "low".to_owned(), why: Unfit::NotRead }]);
}

#[test]
fn values_are_carried_over_and_not_registers() {
    let (profile, have) = level(2, 7, 0);
    let (_, want) = level(3, 7, 250);
    let transfer = edits_to(&profile, &have, &want, false);
    // 0.250 with three digits is 0.25 with two.
    assert_eq!(transfer.edits, [Edit { point: "zero_offset".to_owned(), registers: vec![25] }]);
    assert_eq!(transfer.refused, [Refusal { point: "decimals".to_owned(), why: Unfit::NotWritable }]);
    let (_, fine) = level(3, 7, 255);
    let refused = edits_to(&profile, &have, &fine, false).refused;
    assert_eq!(refused[1], Refusal { point: "zero_offset".to_owned(), why: Unfit::TooFine { decimals: 2 } });
    let (_, other) = level(2, 1, 250);
    let refused = edits_to(&profile, &have, &other, false).refused;
    let why = Unfit::OtherUnit { device: "mH₂O".to_owned(), value: "kPa".to_owned() };
    assert!(refused.contains(&Refusal { point: "zero_offset".to_owned(), why }), "{refused:?}");
}

#[test]
fn a_clone_keeps_its_own_unit_id_unless_that_is_asked_for() {
    let (lvdt, have) = lvdt();
    let mut want = have.clone();
    want.data[0].read = Read::Registers(vec![9]);
    want.data[4].read = Read::Registers(vec![6]);
    want.data[5].read = Read::NoAnswer;
    let points = |with_unit| -> Vec<String> {
        edits_to(&lvdt, &have, &want, with_unit).edits.into_iter().map(|edit| edit.point).collect()
    };
    assert_eq!(points(false), ["sample_rate"]);
    assert_eq!(points(true), ["address", "sample_rate"]);
    let differences: Vec<String> = compare(&lvdt, &have, &want).into_iter().map(|one| one.point).collect();
    assert_eq!(differences, ["address", "sample_rate", "output_mode"]);
    want.profile = "other".to_owned();
    assert_eq!(edits_to(&lvdt, &have, &want, true).refused[0].why, Unfit::OtherProfile);
}

#[test]
fn a_snapshot_is_read_by_people() {
    let (level, mut have) = level(3, 7, 0xFFFF);
    have.data[1].read = Read::Refused(2);
    let shown = have.values(&level, |texts| &texts.zh);
    let line = |index: usize| (shown[index].text.clone(), shown[index].unit.as_str(), shown[index].factory);
    assert_eq!(line(0), (Some("1".to_owned()), "", None));
    assert_eq!(line(1), (None, "Bd", None));
    assert_eq!(line(4), (Some("-0.001".to_owned()), "mH₂O", Some(false)));
}
