use buslens_codec::pdu::{MAX_READ_QUANTITY, Request};
use buslens_codec::profile::{Known, Link, Point, PointValue, Profile, ProfileError};
use buslens_codec::value::{Decimal, Value};
use buslens_codec::views::{encodings_that_show, views_at};
use buslens_codec::{UnitId, profile};

use super::input::Input;

/// A profile's text, FF, function, address and registers.
pub(super) fn what_loads_decodes(data: &[u8]) {
    let (text, mut input) = Input::text_and_rest(data);
    let (function, address) = (input.byte(), input.word());
    // As many as a frame carries; more only take time.
    let words = input.0.chunks_exact(2).take(MAX_READ_QUANTITY.into());
    let registers: Vec<u16> = words.map(|word| u16::from_be_bytes([word[0], word[1]])).collect();
    views(&registers, function);
    match Profile::from_json(&text) {
        Ok(profile) => loaded(&profile, function, address, &registers),
        Err(ProfileError { line, column, reason }) => {
            // A fault stands in the text, or at its end.
            let found = text.split('\n').nth(line - 1).unwrap_or_else(|| panic!("line {line}: {reason}"));
            assert!((1..=found.chars().count() + 1).contains(&column), "line {line}, column {column}: {reason}");
            assert!(!reason.is_empty());
        }
    }
}

fn views(registers: &[u16], offset: u8) {
    let offset = usize::from(offset);
    for view in views_at(registers, offset) {
        assert!(view.registers > 0 && offset + view.registers <= registers.len());
    }
    if let Some([first, second, ..]) = registers.get(offset..) {
        let shown = Decimal { mantissa: i64::from(first.cast_signed()), decimals: second.to_be_bytes()[1] & 3 };
        for fit in encodings_that_show(registers, shown) {
            let own = &registers[fit.offset..fit.offset + fit.encoding.registers()];
            if let Value::Number(number) = fit.encoding.decode(own).unwrap() {
                assert!(number.compare(shown).is_eq(), "{fit:?}");
            }
        }
    }
}

fn loaded(profile: &Profile, function: u8, address: u16, registers: &[u16]) {
    let candidates = profile.line_candidates();
    assert_eq!(candidates.first(), Some(&(profile.line, profile.mode)));
    // Three parities, two numbers of stop bits, two modes.
    assert!(candidates.len() <= 12 * (1 + profile.choices.bauds.len()));
    assert!(profile.live_groups().iter().all(|group| group.request().is_some()));
    for group in profile.groups.iter().chain(&profile.discovery).chain(&profile.fingerprint) {
        let request = group.request().unwrap();
        assert_eq!((request.address(), request.quantity()), (Some(group.address), Some(group.quantity)));
        assert!(request.encode().is_ok());
    }
    for example in &profile.examples {
        assert!(profile.point(&example.point).is_some());
    }
    for id in profile.points.iter().flat_map(Point::refers_to) {
        assert!(profile.point(id).is_some(), "{id}");
    }
    let known = &mut Known::default();
    decode(profile, function, address, registers, known);
    // What scales a point may stand behind it.
    for point in &profile.points {
        for function in &point.read {
            profile.decode_points(*function, point.register, registers, known);
        }
    }
    for point in &profile.points {
        let own = &registers[..point.encoding.registers().min(registers.len())];
        for function in point.read.iter().chain(&point.write) {
            decode(profile, *function, point.register, own, known);
        }
    }
    let bits: Vec<bool> = registers.iter().map(|register| register & 1 == 1).collect();
    profile.decode_bits(function, address, &bits);
    for point in profile.points.iter().filter(|point| point.is_bit()) {
        for function in point.read.iter().chain(&point.write) {
            for bit in profile.decode_bits(*function, point.register, &bits) {
                assert!(matches!(bit.value, Ok(Value::Code(0x0000 | 0xFF00))));
            }
        }
    }
    for point in &profile.points {
        let limits = point.limits_from.iter().flat_map(profile::LimitsFrom::ids);
        assert!(limits.into_iter().all(|id| profile.point(id).is_some()), "{}", point.id);
        assert!(point.read.is_empty() == point.read_group().is_none(), "{}", point.id);
    }
    let essential = profile.clone().essential();
    assert_eq!((essential.live_groups(), essential.line_candidates()), (profile.live_groups(), candidates));
    for unit in 0..=u8::MAX {
        profile.unit_fit(UnitId(unit));
    }
    let outline = profile::Outline {
        function,
        address: Some(address).filter(|address| address % 5 != 0),
        quantity: u16::try_from(registers.len()).unwrap_or(u16::MAX),
        registers,
        is_response: address.is_multiple_of(2),
        is_broadcast: address.is_multiple_of(3),
    };
    assert!(profile.score(&outline) <= 20);
}

/// Values stand within the registers, and what decodes encodes to the same value.
fn decode(profile: &Profile, function: u8, address: u16, registers: &[u16], known: &mut Known) {
    let points = profile.decode_points(function, address, registers, known);
    for PointValue { point, offset, value, scaled, unit } in points {
        assert!(point.uses(function));
        let own = &registers[offset..offset + point.encoding.registers()];
        assert_eq!(unit, profile.unit_of(point, known));
        let Ok(value) = value else { continue };
        point.text(value, |texts| &texts.zh);
        point.allows(value);
        point.consequence_of(value).filter(|_| point.danger_of(value) == profile::Danger::Danger);
        profile.beyond(point, value, |_| Some(value));
        let before = Link { unit: Some(UnitId(profile.unit)), line: profile.line, mode: profile.mode };
        let after = profile.link_after(point, value, before);
        assert!(after.is_none_or(|after| after.line.baud > 0));
        if !scaled {
            assert!(profile.encode_point(point, value, known).is_err());
            continue;
        }
        let again = profile.encode_point(point, value, known).unwrap();
        assert_eq!(again.len(), own.len());
        let found = profile.decode_points(function, point.register, &again, &mut known.clone());
        let found = found.iter().find(|found| found.point.id == point.id).unwrap();
        assert!(is_same(found.value.unwrap(), value), "{}: {own:04X?} {again:04X?}", point.id);
        let over = profile.encode_point_over(point, value, known, own).unwrap();
        let found = profile.decode_points(function, point.register, &over, &mut known.clone());
        let found = found.iter().find(|found| found.point.id == point.id).unwrap();
        assert!(is_same(found.value.unwrap(), value), "{}: {own:04X?} {over:04X?}", point.id);
        if let Some(request) = point.write_request(&again) {
            assert!(request.is_write() && Request::decode(&request.encode().unwrap()).as_ref() == Ok(&request));
        }
    }
}

fn is_same(a: Value, b: Value) -> bool {
    match (a, b) {
        // Also what is no number.
        (Value::Float(a), Value::Float(b)) => a.to_bits() == b.to_bits(),
        (Value::Double(a), Value::Double(b)) => a.to_bits() == b.to_bits(),
        (Value::Number(a), Value::Number(b)) => a.compare(b).is_eq(),
        (a, b) => a == b,
    }
}
