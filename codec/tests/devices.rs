//! The built-in devices against their manuals: every register with its functions, what each frame means, and that each
//! device's frames choose its own profile.

use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::profile::{BUILT_IN, Danger, Effect, Interface, Known, Outline, Profile, Reply, most_explaining};
use buslens_codec::quantity::Unit;
use buslens_codec::value::{Decimal, Value};
use buslens_codec::{UnitId, ascii, rtu};

fn built_in() -> Vec<Profile> {
    BUILT_IN.iter().map(|text| Profile::from_json(text).unwrap()).collect()
}

fn device(id: &str) -> Profile {
    built_in().into_iter().find(|profile| profile.id == id).unwrap()
}

/// Device, point, register, functions that read it, functions that write it.
type Register = (&'static str, &'static str, u16, &'static [u8], &'static [u8]);

#[test]
fn every_register_of_the_manuals_is_a_point() {
    let registers: [Register; 26] = [
        ("lvdt", "temperature", 0x0002, &[4], &[]),
        ("lvdt", "displacement", 0x0004, &[4], &[]),
        ("lvdt", "address", 0x0030, &[3], &[16]),
        ("lvdt", "baud", 0x0031, &[3], &[16]),
        ("lvdt", "parity", 0x0032, &[3], &[16]),
        ("lvdt", "compensation", 0x0034, &[3], &[16]),
        ("lvdt", "sample_rate", 0x003F, &[3], &[16]),
        ("lvdt", "zero", 0x0050, &[], &[5]),
        ("lvdt", "factory_reset", 0x0051, &[], &[5]),
        ("lvdt", "output_mode", 0x0060, &[3], &[16]),
        ("gauge-cable", "reading", 0x0000, &[3], &[]),
        ("gauge-cable", "maximum", 0x0100, &[3], &[]),
        ("gauge-cable", "minimum", 0x0200, &[3], &[]),
        ("gauge-cable", "clear_record", 0x0200, &[], &[6]),
        ("gauge-cable", "range", 0x0300, &[3], &[]),
        ("gauge-cable", "zero", 0x0800, &[], &[6]),
        ("level", "address", 0x0000, &[3], &[6]),
        ("level", "baud", 0x0001, &[3], &[6]),
        ("level", "unit", 0x0002, &[3], &[]),
        ("level", "decimals", 0x0003, &[3], &[]),
        ("level", "value", 0x0004, &[3], &[]),
        ("level", "range_zero", 0x0005, &[3], &[]),
        ("level", "range_full", 0x0006, &[3], &[]),
        ("level", "zero_offset", 0x000C, &[3], &[6]),
        ("level", "save", 0x000F, &[], &[6]),
        ("level", "restore_factory", 0x0010, &[], &[6]),
    ];
    for (id, point, register, read, write) in registers {
        let profile = device(id);
        let point = profile.point(point).unwrap();
        assert_eq!((point.register, &point.read[..], &point.write[..]), (register, read, write), "{id} {}", point.id);
    }
    let points: usize = built_in().iter().map(|profile| profile.points.len()).sum();
    assert_eq!(points, registers.len());
}

#[test]
fn every_code_of_the_manuals_is_known() {
    let numbers = |device_id: &str, point: &str| -> Vec<(u16, u32)> {
        let profile = device(device_id);
        profile.point(point).unwrap().codes.iter().filter_map(|code| Some((code.code, code.number?))).collect()
    };
    let names = |device_id: &str, point: &str| -> Vec<(u16, String)> {
        let profile = device(device_id);
        let named = |code: &buslens_codec::profile::Code| Some((code.code, code.name.as_ref()?.en.clone()));
        profile.point(point).unwrap().codes.iter().filter_map(named).collect()
    };
    let bauds = [1200, 2400, 4800, 9600, 19_200, 38_400, 57_600, 115_200];
    assert_eq!(numbers("lvdt", "baud"), (1..).zip(bauds[1..].iter().copied()).collect::<Vec<_>>());
    assert_eq!(numbers("level", "baud"), (0..).zip(bauds).collect::<Vec<_>>());
    assert_eq!(numbers("lvdt", "sample_rate"), (1..).zip([1, 2, 5, 10, 20, 50]).collect::<Vec<_>>());
    let of =
        |names: Vec<(u16, String)>| names.into_iter().map(|(code, name)| format!("{code} {name}")).collect::<Vec<_>>();
    assert_eq!(of(names("lvdt", "parity")), ["1 odd", "2 even", "3 none"]);
    assert_eq!(of(names("lvdt", "compensation")), ["1 on", "2 off"]);
    assert_eq!(of(names("lvdt", "output_mode")), ["1 RTU", "2 ASCII"]);
    let units = ["0 MPa", "1 kPa", "2 Pa", "3 bar", "4 mbar", "5 kg/cm²", "6 psi", "7 mH₂O", "8 mmH₂O"];
    assert_eq!(of(names("level", "unit")), units);
    for (id, point, code) in
        [("lvdt", "zero", 0xFF00), ("gauge-cable", "zero", 0xAB56), ("gauge-cable", "clear_record", 0)]
    {
        let profile = device(id);
        let point = profile.point(point).unwrap();
        assert!(point.allows(Value::Code(code)) && !point.allows(Value::Code(code ^ 1)), "{id}");
    }
}

#[test]
fn lines_and_link_changes_are_those_of_the_manuals() {
    let line = |id| {
        let profile = device(id);
        (profile.line, profile.mode, profile.interface, profile.units.first, profile.units.last)
    };
    let rs485 = Interface::Rs485;
    assert_eq!(line("lvdt"), (LineSettings::new(9600, Parity::Even), Mode::Rtu, rs485, 1, 247));
    assert_eq!(line("gauge-cable"), (LineSettings::new(38_400, Parity::None), Mode::Rtu, Interface::Rs232, 1, 247));
    assert_eq!(line("level"), (LineSettings::new(9600, Parity::None), Mode::Rtu, rs485, 1, 255));
    let change = |id, point: &str| {
        let profile = device(id);
        let point = profile.point(point).unwrap();
        (point.effects.clone(), point.reply, point.danger)
    };
    assert_eq!(change("lvdt", "address"), (vec![Effect::Unit], Reply::Either, Danger::Caution));
    assert_eq!(change("lvdt", "output_mode"), (vec![Effect::Mode], Reply::Either, Danger::Caution));
    assert_eq!(change("lvdt", "factory_reset"), (vec![Effect::Restart, Effect::Defaults], Reply::Old, Danger::Danger));
    assert_eq!(change("level", "baud"), (vec![Effect::Baud], Reply::Old, Danger::Caution));
    assert_eq!(change("level", "restore_factory"), (vec![Effect::Search], Reply::Old, Danger::Danger));
    assert_eq!(change("gauge-cable", "zero").0, []);
}

#[test]
fn factory_settings_are_those_of_the_manuals() {
    let factory = |id: &str| -> Vec<(String, u16)> {
        let points = device(id).points;
        points.into_iter().filter_map(|point| Some((point.id.clone(), point.factory?))).collect()
    };
    let settings = |pairs: &[(&str, u16)]| pairs.iter().map(|(id, word)| ((*id).to_owned(), *word)).collect::<Vec<_>>();
    let lvdt = [("baud", 3), ("parity", 2), ("compensation", 2), ("sample_rate", 4), ("output_mode", 1)];
    assert_eq!(factory("lvdt"), settings(&lvdt));
    assert_eq!(factory("level"), settings(&[("baud", 3), ("zero_offset", 0)]));
    // Nothing can be set by a register.
    assert_eq!(factory("gauge-cable"), []);
    for id in ["lvdt", "gauge-cable", "level"] {
        assert_eq!(device(id).unit, 1, "{id}");
    }
}

#[test]
fn limits_and_times_are_those_of_the_manuals() {
    let timing = device("lvdt").timing;
    assert_eq!((timing.startup_silence_ms, timing.inter_device_pause_ms), (1500, 100));
    assert_eq!((timing.poll_period_ms, timing.min_poll_period_ms), (100, 40));
    assert_eq!((timing.min_write_period_ms, timing.flash_writes), (100, 100_000));
    let range = device("gauge-cable").point("reading").unwrap().range.unwrap();
    assert_eq!((range.first.to_string(), range.last.to_string()), ("-65.535".to_owned(), "65.535".to_owned()));
    let level = device("level");
    assert_eq!(level.point("value").unwrap().limits_from.as_ref().unwrap().ids(), ["range_zero", "range_full"]);
    for unit in &level.point("unit").unwrap().codes {
        let name = &unit.name.as_ref().unwrap().en;
        assert_eq!(Unit::named(name).map(Unit::symbol), Some(name.as_str()));
    }
    for (id, point) in [("lvdt", "temperature"), ("lvdt", "displacement"), ("gauge-cable", "reading")] {
        assert!(Unit::named(&device(id).point(point).unwrap().unit).is_some(), "{id} {point}");
    }
}

#[test]
fn everything_is_told_in_both_languages() {
    for profile in built_in() {
        let points = profile.points.iter().flat_map(|point| {
            let codes = point.codes.iter().flat_map(|code| code.name.iter().chain(&code.consequence));
            [&point.name].into_iter().chain(&point.note).chain(&point.consequence).chain(codes)
        });
        let wires = profile.wiring.iter().flat_map(|wire| [&wire.name, &wire.purpose]);
        let errata = profile.errata.iter().map(|erratum| &erratum.text);
        let help = profile.help.iter().flat_map(|help| [&help.symptom].into_iter().chain(&help.remedies));
        let told =
            [&profile.name].into_iter().chain(&profile.notes).chain(points).chain(wires).chain(errata).chain(help);
        for texts in told {
            assert!(!texts.en.is_empty() && !texts.zh.is_empty(), "{} {texts:?}", profile.id);
            assert!(texts.en.chars().all(|c| c.is_ascii() || "°²₂µ".contains(c)), "{}", texts.en);
        }
        assert!(!profile.help.is_empty(), "{}", profile.id);
        // Whatever is asked before it is written says what it costs.
        for point in &profile.points {
            let mut values: Vec<Value> = point.codes.iter().map(|code| Value::Code(code.code)).collect();
            if values.is_empty() {
                values.push(Value::Number(Decimal::whole(1)));
            }
            for value in values {
                let costs = point.danger_of(value) > Danger::None;
                assert!(!costs || point.consequence_of(value).is_some(), "{} {} {value}", profile.id, point.id);
            }
        }
    }
}

#[test]
fn the_printed_erratum_is_put_right() {
    let profile = device("lvdt");
    let frames: Vec<_> = profile.errata.iter().filter(|erratum| !erratum.printed.is_empty()).collect();
    assert_eq!(frames.len(), 1);
    assert!(ascii::decode(&frames[0].printed).is_err());
    assert_eq!(ascii::decode(&frames[0].right).unwrap().unit, UnitId(1));
}

/// A manual's frame with what is known of it; a reply takes its address from the request before it.
struct Frame {
    device: String,
    meaning: String,
    unit: UnitId,
    function: u8,
    address: Option<u16>,
    quantity: u16,
    registers: Vec<u16>,
    is_response: bool,
}

impl Frame {
    fn outline(&self) -> Outline<'_> {
        Outline {
            function: self.function,
            address: self.address,
            quantity: self.quantity,
            registers: &self.registers,
            is_response: self.is_response,
            is_broadcast: self.unit == UnitId(0),
        }
    }
}

fn manual_frames() -> Vec<Frame> {
    let mut asked = None;
    let mut frames = Vec::new();
    for line in include_str!("data/manual_frames.csv").lines().skip(1) {
        let columns: Vec<&str> = line.split(',').collect();
        let bytes: Vec<u8> = columns[3].split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect();
        let decoded = match columns[1] {
            "rtu" => rtu::decode(&bytes).ok().map(|adu| (adu.unit, adu.pdu.to_vec())),
            _ => ascii::decode(&bytes).ok().map(|adu| (adu.unit, adu.pdu)),
        };
        // One LRC is printed wrong.
        let Some((unit, pdu)) = decoded else { continue };
        let is_response = columns[2] == "response";
        let word = |at: usize| u16::from_be_bytes([pdu[at], pdu[at + 1]]);
        let words = |at: usize| -> Vec<u16> { (at..pdu.len()).step_by(2).map(word).collect() };
        let (address, quantity, registers) = match (pdu[0], is_response) {
            (3 | 4, false) | (16, true) => (Some(word(1)), word(3), vec![]),
            (3 | 4, true) => (asked, u16::from(pdu[1]) / 2, words(2)),
            (5 | 6, _) => (Some(word(1)), 1, words(3)),
            (16, false) => (Some(word(1)), word(3), words(6)),
            (function, _) => panic!("function {function}"),
        };
        asked = address;
        frames.push(Frame {
            device: columns[0].replace('_', "-"),
            meaning: columns[4].to_owned(),
            unit,
            function: pdu[0],
            address,
            quantity,
            registers,
            is_response,
        });
    }
    frames
}

#[test]
fn each_devices_frames_choose_its_own_profile() {
    let (profiles, frames) = (built_in(), manual_frames());
    assert_eq!(frames.len(), 24);
    for frame in &frames {
        let chosen = most_explaining(&profiles, &[frame.outline()]).map(|profile| profile.id.as_str());
        assert_eq!(chosen, Some(frame.device.as_str()), "{}", frame.meaning);
    }
    for profile in &profiles {
        // Also without the requests that tell what a reply is about.
        let mut outlines = Vec::new();
        for frame in frames.iter().filter(|frame| frame.device == profile.id) {
            let address = frame.address.filter(|_| !frame.is_response);
            outlines.push(Outline { address, ..frame.outline() });
        }
        assert_eq!(most_explaining(&profiles, &outlines).unwrap().id, profile.id);
    }
}

#[test]
fn the_frames_mean_what_the_manuals_say() {
    let mut told = Vec::new();
    for frame in manual_frames().iter().filter(|frame| !frame.registers.is_empty()) {
        let profile = device(&frame.device);
        let address = frame.address.unwrap();
        for found in profile.decode_points(frame.function, address, &frame.registers, &mut Known::default()) {
            let text = found.point.text(found.value.unwrap(), |name| &name.en);
            told.push(format!("{} {} {} {}", frame.device, found.point.id, text, found.unit).trim_end().to_owned());
        }
    }
    // The reply to the question at register 0 is the address, but no point lies there.
    let expected = [
        "lvdt baud 115200 Bd",
        "lvdt parity even",
        "lvdt zero zero here",
        "lvdt zero cancel zero",
        "lvdt factory_reset reset and restart",
        "lvdt temperature 28.5 °C",
        "lvdt displacement 123.456 mm",
        "gauge-cable reading -4.661 mm",
        "gauge-cable zero zero the gauge",
        "gauge-cable range 4.661 mm",
        "gauge-cable clear_record clear maximum and minimum",
        "level address 1",
        "level address 2",
    ];
    assert_eq!(told, expected);
}
