//! A frame for the eye: the codec's dissection in words, with the bytes of one value held together.

use std::ops::Range;

use buslens_codec::dissect::{Check, Direction, Dissection, FieldKind, NamedValue, dissect};
use buslens_codec::line::Mode;
use buslens_codec::pdu::Request;
use buslens_codec::profile::{Point, Profile};
use buslens_codec::{ascii, rtu};

use crate::device::{pick, value_text};
use crate::format::{self, hex, hex_spaced};
use crate::text::Language;

/// A frame taken apart and put into words.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Anatomy {
    /// The frame as on the wire.
    pub(crate) bytes: Vec<u8>,
    /// RTU or ASCII: how a byte is written.
    pub(crate) mode: Mode,
    /// All bytes in order, in groups that belong together.
    pub(crate) parts: Vec<Part>,
    /// The bare facts; `None` for bytes that make no frame.
    pub(crate) facts: Option<Facts>,
}

/// What a list of frames tells of each.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Facts {
    /// Which way it goes.
    pub(crate) direction: Direction,
    /// Unit id.
    pub(crate) unit: u8,
    /// Function code with its name.
    pub(crate) function: String,
    /// What it says.
    pub(crate) meaning: String,
    /// Whether the check is right.
    pub(crate) check_ok: bool,
    /// What the check should be, as on the wire.
    pub(crate) expected: String,
    /// Whether length and contents fit a function that is known.
    pub(crate) known_shape: bool,
    /// Whether it holds registers whose addresses are not known.
    pub(crate) nameless: bool,
}

/// Bytes that belong together.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// Their place in the frame.
    pub(crate) range: Range<usize>,
    /// For the colour: `unit`, `function`, `place`, `data`, `check`, `wrong` or `mark`.
    pub(crate) kind: &'static str,
    /// What they are.
    pub(crate) name: String,
    /// Their value.
    pub(crate) value: String,
    /// What the value means.
    pub(crate) meaning: String,
    /// The shortest useful words, to stand under the bytes.
    pub(crate) caption: String,
}

impl Part {
    fn new(range: Range<usize>, kind: &'static str, name: &str, value: &str, meaning: &str, caption: &str) -> Self {
        let [name, value, meaning, caption] = [name, value, meaning, caption].map(str::to_owned);
        Self { range, kind, name, value, meaning, caption }
    }
}

impl Anatomy {
    /// Takes bytes apart. `request` is what they answer, if that is known.
    pub(crate) fn of(
        language: Language,
        profile: &Profile,
        bytes: &[u8],
        mode: Mode,
        direction: Direction,
        request: Option<&Request>,
    ) -> Self {
        let found = dissect(bytes, mode, direction, request, Some(profile));
        let words = Words { language, profile, bytes };
        Self {
            bytes: bytes.to_vec(),
            mode,
            parts: found.as_ref().map_or_else(|| noise(language, bytes.len()), |found| words.parts(found)),
            facts: found.as_ref().map(|found| words.facts(found)),
        }
    }

    /// The same bytes as mere bytes.
    pub(crate) fn as_noise(&self, language: Language) -> Self {
        let parts = noise(language, self.bytes.len());
        Self { bytes: self.bytes.clone(), mode: self.mode, parts, facts: None }
    }

    /// Whether it is a reply whose registers nobody can name, because its request is not known.
    pub(crate) fn lacks_request(&self) -> bool {
        self.facts.as_ref().is_some_and(|facts| facts.nameless)
    }

    /// How the byte at a place is written: two digits, or the character itself in ASCII mode.
    pub(crate) fn byte_text(&self, at: usize) -> String {
        self.bytes.get(at).map(|byte| byte_text(self.mode, *byte)).unwrap_or_default()
    }
}

/// The request in a frame, if it is one with a right check.
pub(crate) fn request_in(frame: &[u8], mode: Mode) -> Option<(u8, Request)> {
    let (unit, pdu) = match mode {
        Mode::Rtu => rtu::decode(frame).map(|adu| (adu.unit.0, adu.pdu.to_vec())).ok()?,
        Mode::Ascii => ascii::decode(frame).map(|adu| (adu.unit.0, adu.pdu)).ok()?,
    };
    Request::decode(&pdu).ok().map(|request| (unit, request))
}

/// Bytes that belong to no frame, as one part.
fn noise(language: Language, length: usize) -> Vec<Part> {
    let whole = Part::new(0..length, "mark", language.noise(), "", language.noise_meaning(), language.noise());
    if length == 0 { Vec::new() } else { vec![whole] }
}

struct Words<'a> {
    language: Language,
    profile: &'a Profile,
    bytes: &'a [u8],
}

impl Words<'_> {
    fn parts(&self, found: &Dissection) -> Vec<Part> {
        let mut parts: Vec<Part> = Vec::with_capacity(found.fields.len());
        for field in &found.fields {
            let within =
                |named: &&NamedValue| named.range.start <= field.range.start && field.range.end <= named.range.end;
            match found.points.iter().find(within) {
                // The first of a value's registers brings the whole value, the others nothing.
                Some(named) if named.range.start == field.range.start => {
                    if let Some(point) = self.profile.point(&named.point) {
                        parts.push(self.point_part(point, named));
                    }
                }
                Some(_) => {}
                None => parts.push(self.field_part(found, field.range.clone(), field.kind)),
            }
        }
        parts
    }

    fn point_part(&self, point: &Point, named: &NamedValue) -> Part {
        let t = self.language;
        let value = match named.value {
            Ok(value) => with_unit(value_text(t, point, value), &named.unit),
            Err(_) => t.value_invalid().to_owned(),
        };
        let kind = if named.value.is_ok() { "data" } else { "wrong" };
        let place = t.register_at(&address_text(named.register));
        Part::new(named.range.clone(), kind, pick(t, &point.name), &value, &place, &value)
    }

    fn field_part(&self, found: &Dissection, range: Range<usize>, kind: FieldKind) -> Part {
        let t = self.language;
        let part = |kind, name: &str, value: &str, meaning: &str, caption: &str| {
            Part::new(range.clone(), kind, name, value, meaning, caption)
        };
        match kind {
            FieldKind::Start => part("mark", t.field_start(), ":", "", t.field_start()),
            FieldKind::End => part("mark", t.field_end(), "CR LF", "", t.field_end()),
            FieldKind::Unit(unit) => {
                let meaning = match unit.0 {
                    0 => t.unit_is_broadcast(),
                    248.. => t.unit_is_reserved(),
                    _ => "",
                };
                part("unit", t.unit(), &unit.to_string(), meaning, &t.unit_id(unit.0))
            }
            FieldKind::Function(code) => {
                let (name, text) = (function_name(t, code & 0x7F), hex(code));
                if code & 0x80 == 0 {
                    part("function", t.function(), &text, name, name)
                } else {
                    part("wrong", t.function(), &text, &t.function_refused(name), t.exception_word())
                }
            }
            FieldKind::Exception(code) => {
                let name = t.exception_name(code.code());
                part("wrong", t.exception_code(), &hex(code.code()), name, name)
            }
            FieldKind::Address(address) => {
                let text = address_text(address);
                part("place", t.register_address(), &text, &self.names_at(found.function, address, 1), &text)
            }
            FieldKind::Quantity(quantity) => {
                let text = quantity.to_string();
                part("place", t.quantity(), &text, "", &["×", &text].concat())
            }
            FieldKind::ByteCount(count) => part("place", t.byte_count(), &count.to_string(), "", &t.bytes_many(count)),
            FieldKind::Register { address, value } => {
                let name =
                    address.map_or_else(|| t.register().to_owned(), |address| t.register_at(&address_text(address)));
                let signed = format::signed(&value.cast_signed().to_string());
                let meaning = if value > 0x7FFF { t.signed_is(&signed) } else { String::new() };
                let text = value.to_string();
                part("data", &name, &text, &meaning, &text)
            }
            FieldKind::Coil(value) => {
                let state = match value {
                    0xFF00 => t.coil_on(),
                    0 => t.coil_off(),
                    _ => t.value_invalid(),
                };
                part("data", t.coil_value(), &hex_spaced(&value.to_be_bytes()), state, state)
            }
            FieldKind::Check => self.check_part(range.clone(), found.check),
            _ => part("data", t.data(), &hex_spaced(&self.bytes[range.clone()]), "", t.data()),
        }
    }

    fn check_part(&self, range: Range<usize>, check: Check) -> Part {
        let t = self.language;
        let (name, found, expected) = check_texts(check);
        if check.is_ok() {
            Part::new(range, "check", name, &found, t.check_ok(), &t.check_caption_ok(name))
        } else {
            Part::new(range, "wrong", name, &found, &t.check_wrong_expected(&expected), &t.check_expected(&expected))
        }
    }

    fn facts(&self, found: &Dissection) -> Facts {
        let (_, _, expected) = check_texts(found.check);
        Facts {
            direction: found.direction,
            unit: found.unit.0,
            function: [&hex(found.function), " ", function_name(self.language, found.function)].concat(),
            meaning: self.meaning(found),
            check_ok: found.check.is_ok(),
            expected,
            nameless: found.address.is_none() && !found.registers.is_empty(),
            known_shape: found.fault.is_none() && matches!(found.function, 1..=6 | 15 | 16),
        }
    }

    fn meaning(&self, found: &Dissection) -> String {
        let t = self.language;
        if let Some(code) = found.exception {
            return t.exception_is(code.code(), t.exception_name(code.code()));
        }
        if found.fault.is_some() {
            return t.wrong_shape().to_owned();
        }
        let values: Vec<String> = found
            .points
            .iter()
            .filter_map(|named| {
                let point = self.profile.point(&named.point)?;
                let value =
                    named.value.ok().map_or_else(|| t.value_invalid().to_owned(), |value| value_text(t, point, value));
                Some([pick(t, &point.name), " ", &with_unit(value, &named.unit)].concat())
            })
            .collect();
        if !values.is_empty() {
            return values.join(t.list_comma());
        }
        let registers = || {
            let mut words = String::new();
            for word in &found.registers {
                if !words.is_empty() {
                    words.push(' ');
                }
                format::push_hex(&mut words, &word.to_be_bytes());
            }
            words
        };
        match (found.direction, found.address) {
            (Direction::Response, _) if !found.registers.is_empty() => registers(),
            (_, Some(address)) => {
                let quantity = found.quantity.unwrap_or(1);
                let names = self.names_at(found.function, address, quantity);
                if names.is_empty() { t.registers_from(quantity, &address_text(address)) } else { names }
            }
            _ => String::new(),
        }
    }

    /// The names of the points that lie in these registers.
    fn names_at(&self, function: u8, address: u16, quantity: u16) -> String {
        let inside = |point: &&Point| {
            let last = u32::from(address) + u32::from(quantity);
            point.uses(function) && point.register >= address && u32::from(point.register) < last
        };
        let names: Vec<&str> =
            self.profile.points.iter().filter(inside).map(|point| pick(self.language, &point.name)).collect();
        names.join(self.language.list_comma())
    }
}

fn byte_text(mode: Mode, byte: u8) -> String {
    match (mode, byte) {
        (Mode::Ascii, b'\r') => "CR".to_owned(),
        (Mode::Ascii, b'\n') => "LF".to_owned(),
        (Mode::Ascii, 0x21..=0x7E) => char::from(byte).to_string(),
        _ => hex(byte),
    }
}

/// Name of a check, and its bytes found and expected as on the wire.
fn check_texts(check: Check) -> (&'static str, String, String) {
    match check {
        Check::Crc16 { found, expected } => {
            ("CRC-16", hex_spaced(&found.to_le_bytes()), hex_spaced(&expected.to_le_bytes()))
        }
        Check::Lrc { found, expected } => ("LRC", hex_spaced(&[found]), hex_spaced(&[expected])),
    }
}

fn with_unit(value: String, unit: &str) -> String {
    if unit.is_empty() { value } else { [&value, "\u{A0}", unit].concat() }
}

/// `0x0031`.
fn address_text(address: u16) -> String {
    let mut text = "0x".to_owned();
    format::push_hex(&mut text, &address.to_be_bytes());
    text
}

/// What a function does, in the standard's words.
pub(crate) fn function_name(language: Language, function: u8) -> &'static str {
    match function {
        1 => language.function_1(),
        2 => language.function_2(),
        3 => language.function_3(),
        4 => language.function_4(),
        5 => language.function_5(),
        6 => language.function_6(),
        15 => language.function_15(),
        16 => language.function_16(),
        _ => language.function_other(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device;

    fn anatomy(language: Language, bytes: &[u8], mode: Mode, request: Option<&Request>) -> Anatomy {
        Anatomy::of(language, device::find("lvdt").profile(), bytes, mode, Direction::Unknown, request)
    }

    #[test]
    fn a_value_of_two_registers_is_one_part() {
        let frame = [0x0C, 0x04, 0x04, 0x80, 0x00, 0x01, 0x48, 0x0F, 0x22];
        let request = Request::ReadInputRegisters { address: 4, quantity: 2 };
        let found = anatomy(Language::Zh, &frame, Mode::Rtu, Some(&request));
        let parts: Vec<_> = found.parts.iter().map(|part| (part.kind, part.range.clone())).collect();
        assert_eq!(parts, [("unit", 0..1), ("function", 1..2), ("place", 2..3), ("data", 3..7), ("check", 7..9)]);
        assert_eq!(found.parts[3].value, "\u{2212}0.328\u{A0}mm");
        assert_eq!(found.facts.unwrap().meaning, "位移 \u{2212}0.328\u{A0}mm");
    }

    #[test]
    fn every_byte_belongs_to_one_part() {
        let frames: [(&[u8], Mode); 4] = [
            (b":010300310001CA\r\n", Mode::Ascii),
            (&[0x0C, 0x84, 0x02, 0x53, 0x02], Mode::Rtu),
            (&[0x01, 0x10, 0x00, 0x31, 0x00, 0x01, 0x02, 0x00, 0x07, 0xE0, 0x63], Mode::Rtu),
            (&[0xFF, 0x00], Mode::Rtu),
        ];
        for (frame, mode) in frames {
            let found = anatomy(Language::En, frame, mode, None);
            let mut at = 0;
            for part in &found.parts {
                assert_eq!(part.range.start, at);
                at = part.range.end;
            }
            assert_eq!(at, frame.len());
        }
    }

    #[test]
    fn a_wrong_check_tells_the_right_one_as_on_the_wire() {
        let found = anatomy(Language::En, &[0x0C, 0x04, 0x00, 0x04, 0x00, 0x02, 0x31, 0x18], Mode::Rtu, None);
        let facts = found.facts.unwrap();
        assert!(!facts.check_ok);
        assert_eq!(facts.expected, "31 17");
        assert_eq!(facts.meaning, "Displacement");
    }

    #[test]
    fn a_request_is_found_in_either_mode() {
        let request = Request::ReadHoldingRegisters { address: 0x31, quantity: 1 };
        assert_eq!(request_in(b":010300310001CA\r\n", Mode::Ascii), Some((1, request.clone())));
        let frame = [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5];
        assert_eq!(request_in(&frame, Mode::Rtu), Some((1, request)));
        assert_eq!(request_in(&frame[..7], Mode::Rtu), None);
    }
}
