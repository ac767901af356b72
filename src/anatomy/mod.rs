//! A frame for the eye: the codec's dissection in words, with the bytes of one value held together.

mod bits;
mod fields;
mod names;
mod points;
mod summary;

use std::ops::Range;

use buslens_codec::dissect::{Check, Direction, Dissection, dissect_known};
use buslens_codec::line::Mode;
use buslens_codec::pdu::Request;
use buslens_codec::profile::{Known, Profile};
use buslens_codec::{ascii, rtu};

use crate::format::{self, hex, hex_spaced};
use crate::text::Language;

pub(crate) use bits::Bit;
pub(crate) use names::function_name;
pub(crate) use points::{allowed, place_name, push_bracketed};

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
    /// Whether it holds registers, coils or inputs whose addresses are not known.
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
    /// Of flags: every bit, the highest first.
    pub(crate) bits: Option<Vec<Bit>>,
    /// Of registers: what they hold.
    pub(crate) registers: Vec<u16>,
}

impl Part {
    fn new(range: Range<usize>, kind: &'static str, name: &str, value: &str, meaning: &str, caption: &str) -> Self {
        let [name, value, meaning, caption] = [name, value, meaning, caption].map(str::to_owned);
        Self { range, kind, name, value, meaning, caption, bits: None, registers: Vec::new() }
    }
}

impl Anatomy {
    /// Takes bytes apart. `request` is what they answer, if that is known; `known` is what earlier frames of the same unit
    /// told of scales and units under this profile; a frame with a right check adds to it.
    pub(crate) fn of(
        language: Language,
        profile: Option<&Profile>,
        bytes: &[u8],
        mode: Mode,
        direction: Direction,
        request: Option<&Request>,
        known: &mut Known,
    ) -> Self {
        let mut learnt = known.clone();
        let found = dissect_known(bytes, mode, direction, request, profile, &mut learnt);
        // A damaged frame tells nothing for others.
        if found.as_ref().is_some_and(|found| found.check.is_ok()) {
            *known = learnt;
        }
        Self::of_dissection(language, profile, bytes, mode, request, found.as_ref())
    }

    /// Puts bytes into words that are taken apart already; `None` are no frame.
    pub(crate) fn of_dissection(
        language: Language,
        profile: Option<&Profile>,
        bytes: &[u8],
        mode: Mode,
        request: Option<&Request>,
        found: Option<&Dissection>,
    ) -> Self {
        let parts = match found {
            Some(found) => Words { language, profile, frame: bytes }.parts(found, request),
            None => noise(language, bytes.len()),
        };
        let facts = found.map(|found| Facts::of(language, profile, bytes, found));
        Self { bytes: bytes.to_vec(), mode, parts, facts }
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

impl Facts {
    /// What a frame tells that is taken apart already.
    pub(crate) fn of(language: Language, profile: Option<&Profile>, frame: &[u8], found: &Dissection) -> Self {
        let (_, _, expected) = check_texts(found.check);
        let holds_something = !found.registers.is_empty() || !found.bits.is_empty();
        Self {
            direction: found.direction,
            unit: found.unit.0,
            function: [&hex(found.function), " ", names::function_in(language, found)].concat(),
            meaning: Words { language, profile, frame }.meaning(found),
            check_ok: found.check.is_ok(),
            expected,
            nameless: found.address.is_none() && holds_something && matches!(found.function, 0x01..=0x04 | 0x17),
        }
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

/// Puts one frame into words: in which language, and with which device in mind.
#[derive(Clone, Copy)]
struct Words<'a> {
    language: Language,
    profile: Option<&'a Profile>,
    frame: &'a [u8],
}

impl Words<'_> {
    /// Some bytes of the frame: of characters in ASCII mode the bytes that they spell.
    fn spelled(self, mode: Mode, range: Range<usize>) -> Vec<u8> {
        let bytes = self.frame.get(range).unwrap_or_default();
        let digit = |digit: u8| char::from(digit & 0x7F).to_digit(16).and_then(|digit| u8::try_from(digit).ok());
        match mode {
            Mode::Rtu => bytes.to_vec(),
            Mode::Ascii => {
                let pairs = bytes.as_chunks::<2>().0.iter();
                pairs.filter_map(|[high, low]| Some(digit(*high)? << 4 | digit(*low)?)).collect()
            }
        }
    }
}

/// Bytes that belong to no frame, as one part.
fn noise(language: Language, length: usize) -> Vec<Part> {
    let whole = Part::new(0..length, "mark", language.noise(), "", language.noise_meaning(), language.noise());
    if length == 0 { Vec::new() } else { vec![whole] }
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

/// `0x0031`.
pub(crate) fn address_text(address: u16) -> String {
    let mut text = "0x".to_owned();
    format::push_hex(&mut text, &address.to_be_bytes());
    text
}

/// Bytes that are mostly text: printable ASCII as it is, everything else as `\xNN`, a backslash as `\\`.
pub(crate) fn legible(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len());
    for byte in bytes {
        match byte {
            b'\\' => text.push_str("\\\\"),
            b' '..=b'~' => text.push(char::from(*byte)),
            _ => {
                text.push_str("\\x");
                format::push_hex(&mut text, &[*byte]);
            }
        }
    }
    text
}

/// A text as the name of a part, with a capital letter.
fn capital(text: &str) -> String {
    let mut text = text.to_owned();
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text
}

/// The first few of a list, and how many more there are.
fn shortened(language: Language, mut list: Vec<String>, separator: &str, most: usize) -> String {
    let more = list.len().saturating_sub(most);
    list.truncate(most);
    let mut text = list.join(separator);
    if more > 0 {
        text.push_str(&language.list_and_more(more));
    }
    text
}

#[cfg(test)]
mod tests {
    use buslens_codec::dissect::Direction;
    use buslens_codec::line::Mode;
    use buslens_codec::pdu::{FileRecordRange, Request};
    use buslens_codec::profile::{Known, Profile};
    use buslens_codec::{UnitId, adu};

    use super::*;
    use crate::device;

    const LANGUAGES: [Language; 2] = [Language::En, Language::Zh];

    fn profile(id: &str) -> &'static Profile {
        device::find(id).profile()
    }

    /// A PDU to or from unit 17, without a profile.
    fn taken(language: Language, pdu: &[u8], direction: Direction, request: Option<&Request>) -> Anatomy {
        let frame = adu::encode(Mode::Rtu, UnitId(17), pdu).unwrap();
        Anatomy::of(language, None, &frame, Mode::Rtu, direction, request, &mut Known::default())
    }

    /// The same for a device.
    fn of_device(id: &str, language: Language, pdu: &[u8], request: Option<&Request>) -> Anatomy {
        let frame = adu::encode(Mode::Rtu, UnitId(1), pdu).unwrap();
        let direction = if request.is_some() { Direction::Response } else { Direction::Unknown };
        Anatomy::of(language, Some(profile(id)), &frame, Mode::Rtu, direction, request, &mut Known::default())
    }

    fn meaning(anatomy: &Anatomy) -> &str {
        &anatomy.facts.as_ref().unwrap().meaning
    }

    /// Name, value and meaning of each part between function code and check.
    fn told(anatomy: &Anatomy) -> Vec<[&str; 3]> {
        let parts = &anatomy.parts[2..anatomy.parts.len() - 1];
        parts.iter().map(|part| [&*part.name, &*part.value, &*part.meaning]).collect()
    }

    fn assert_covers(anatomy: &Anatomy) {
        let mut at = 0;
        for part in &anatomy.parts {
            assert_eq!(part.range.start, at, "{anatomy:?}");
            assert!(!part.name.is_empty() && !part.kind.is_empty(), "{part:?}");
            at = part.range.end;
        }
        assert_eq!(at, anatomy.bytes.len());
    }

    #[test]
    fn a_value_of_two_registers_is_one_part() {
        let request = Request::ReadInputRegisters { address: 4, quantity: 2 };
        let pdu = [0x04, 0x04, 0x80, 0x00, 0x01, 0x48];
        let found = of_device("lvdt", Language::Zh, &pdu, Some(&request));
        let parts: Vec<_> = found.parts.iter().map(|part| (part.kind, part.range.clone())).collect();
        assert_eq!(parts, [("unit", 0..1), ("function", 1..2), ("place", 2..3), ("data", 3..7), ("check", 7..9)]);
        assert_eq!(found.parts[3].value, "\u{2212}0.328\u{A0}mm");
        assert_eq!(found.parts[3].registers, [0x8000, 0x0148]);
        assert_eq!(meaning(&found), "位移 \u{2212}0.328\u{A0}mm");
    }

    #[test]
    fn lists_tell_values_or_what_is_asked() {
        let [en, zh] = LANGUAGES.map(|language| {
            move |pdu: &[u8], request: Option<&Request>| meaning(&of_device("lvdt", language, pdu, request)).to_owned()
        });
        let request = Request::ReadInputRegisters { address: 2, quantity: 4 };
        let reply = [0x04, 8, 0x00, 0x00, 0x01, 0x1D, 0x00, 0x7B, 0x01, 0xC8];
        assert_eq!(en(&reply, Some(&request)), "Temperature 28.5\u{A0}°C, Displacement 123.456\u{A0}mm");
        assert_eq!(zh(&reply, Some(&request)), "温度 28.5\u{A0}°C，位移 123.456\u{A0}mm");
        assert_eq!(en(&[0x04, 0, 2, 0, 4], None), "4 registers from 0x0002: Temperature, Displacement");
        assert_eq!(zh(&[0x04, 0, 2, 0, 4], None), "从 0x0002 起 4 个寄存器：温度、位移");
        assert_eq!(en(&[0x03, 0, 0x31, 0, 1], None), "register 0x0031: Baud rate");
        assert_eq!(en(&[0x05, 0, 0x50, 0xFF, 0], None), "Zero / cancel zero: zero here");
        assert_eq!(zh(&[0x05, 0, 0x50, 0xFF, 0], None), "位移清零/取消清零：位移清零");
        assert_eq!(en(&[0x10, 0, 0x31, 0, 1, 2, 0, 7], None), "Baud rate 115200\u{A0}Bd");
        assert_eq!(zh(&[0x10, 0, 0x32, 0, 1, 2, 0, 2], None), "奇偶校验：偶校验");
        assert_eq!(en(&[0x84, 2], Some(&request)), "exception 02: wrong data address");
        assert_eq!(zh(&[0x84, 2], Some(&request)), "异常码 02：数据地址错误");
        assert_eq!(en(&[0x03, 0, 0x70, 0, 2], None), "2 registers from 0x0070");
    }

    #[test]
    fn values_that_a_device_does_not_allow_are_marked_with_what_it_takes() {
        let found = of_device("lvdt", Language::En, &[0x10, 0, 0x31, 0, 1, 2, 0, 9], None);
        let part = &found.parts[5];
        assert_eq!((part.kind, &*part.value), ("wrong", "9"));
        assert!(part.meaning.contains("not allowed; it takes 1 = 2400\u{A0}Bd, 2 = 4800\u{A0}Bd"), "{}", part.meaning);
        assert_eq!(meaning(&found), "Baud rate 9 (not allowed)");
        let found = of_device("lvdt", Language::Zh, &[0x10, 0, 0x30, 0, 1, 2, 0, 250], None);
        assert_eq!(found.parts[5].meaning, "寄存器 0x0030，不在允许范围内；允许值：1 到 247");
        let request = Request::ReadInputRegisters { address: 4, quantity: 2 };
        let found = of_device("lvdt", Language::En, &[0x04, 4, 0, 1, 0x03, 0xE8], Some(&request));
        assert_eq!((found.parts[3].kind, &*found.parts[3].value), ("wrong", "not allowed"));
        assert_eq!(found.parts[3].meaning, "register 0x0004, 03 E8 does not fit how this device writes the value");
        assert_eq!(meaning(&found), "Displacement not allowed");
    }

    #[test]
    fn codes_are_named_with_the_number_on_the_wire() {
        let request = Request::ReadHoldingRegisters { address: 0x31, quantity: 2 };
        let found = of_device("lvdt", Language::En, &[0x03, 4, 0, 3, 0, 2], Some(&request));
        assert_eq!(told(&found)[1], ["Baud rate", "9600\u{A0}Bd", "register 0x0031, code 3"]);
        assert_eq!(told(&found)[2], ["Parity", "even", "register 0x0032, code 2"]);
    }

    #[test]
    fn half_a_value_says_what_it_is_a_half_of() {
        let request = Request::ReadInputRegisters { address: 4, quantity: 1 };
        let found = of_device("lvdt", Language::En, &[0x04, 2, 0x80, 0x01], Some(&request));
        assert_eq!(told(&found)[1], ["Register 0x0004", "32769", "a part of Displacement, which takes 2 registers"]);
        let found = of_device("lvdt", Language::Zh, &[0x04, 2, 0x80, 0x01], Some(&request));
        assert_eq!(told(&found)[1][2], "只是位移的一部分，完整值占 2 个寄存器");
    }

    #[test]
    fn a_scale_that_is_not_known_is_told_until_it_has_been_read() {
        let mut known = Known::default();
        let mut read = |language, address: u16, value: u8| {
            let request = Request::ReadHoldingRegisters { address, quantity: 1 };
            let frame = adu::encode(Mode::Rtu, UnitId(1), &[0x03, 2, 0x17 * u8::from(value > 9), value]).unwrap();
            Anatomy::of(
                language,
                Some(profile("level")),
                &frame,
                Mode::Rtu,
                Direction::Response,
                Some(&request),
                &mut known,
            )
        };
        let found = read(Language::En, 4, 0x70);
        assert_eq!(
            told(&found)[1],
            [
                "Output value",
                "6000",
                "register 0x0004, the register's own number, its scale is not known yet: read Decimal places (0x0003) first"
            ]
        );
        assert_eq!(meaning(&found), "Output value 6000 (scale not known)");
        assert_eq!(meaning(&read(Language::Zh, 4, 0x70)), "测量输出值 6000（小数位数未知）");
        assert_eq!(meaning(&read(Language::En, 3, 3)), "Decimal places 3");
        let found = read(Language::En, 4, 0x70);
        assert_eq!(told(&found)[1][1], "6.000");
        assert!(told(&found)[1][2].ends_with("its unit is not known yet: read Unit (0x0002) first"));
        read(Language::En, 2, 1);
        assert_eq!(meaning(&read(Language::En, 4, 0x70)), "Output value 6.000\u{A0}kPa");
    }

    #[test]
    fn a_damaged_frame_teaches_no_scale() {
        let mut known = Known::default();
        let request = Request::ReadHoldingRegisters { address: 3, quantity: 1 };
        let mut frame = adu::encode(Mode::Rtu, UnitId(1), &[0x03, 2, 0, 3]).unwrap();
        frame[5] ^= 1;
        Anatomy::of(
            Language::En,
            Some(profile("level")),
            &frame,
            Mode::Rtu,
            Direction::Response,
            Some(&request),
            &mut known,
        );
        assert_eq!(known, Known::default());
    }

    /// Clauses 6.1, 6.2, 6.5 and 6.11.
    #[test]
    fn coils_and_inputs_are_listed_by_their_addresses() {
        let request = Request::ReadCoils { address: 19, quantity: 10 };
        let found = taken(Language::En, &[0x01, 2, 0xCD, 0x01], Direction::Response, Some(&request));
        assert_eq!(
            meaning(&found),
            "on: 0x0013, 0x0015, 0x0016, 0x0019, 0x001A, 0x001B; off: 0x0014, 0x0017, 0x0018, 0x001C"
        );
        assert_eq!(told(&found)[2], ["Coils", "0000 0001", "on: 0x001B; off: 0x001C"]);
        let bits = found.parts[4].bits.as_ref().unwrap();
        assert_eq!(bits.len(), 8);
        assert_eq!((bits[7].position, bits[7].on, &*bits[7].label), (0, true, "0x001B"));
        assert_eq!((bits[0].position, &*bits[0].label), (7, "unused"));
        let found = taken(Language::Zh, &[0x02, 1, 0x00], Direction::Response, None);
        assert_eq!(meaning(&found), "全部断开");
        assert!(found.lacks_request());
        let found = taken(Language::Zh, &[0x02, 2, 0x00, 0x02], Direction::Response, None);
        assert_eq!(told(&found)[2], ["离散输入状态", "0000 0010", "接通：+9；断开：+8、+10、+11、+12、+13、+14、+15"]);
        assert_eq!(
            meaning(&taken(Language::En, &[0x01, 0, 19, 0, 19], Direction::Request, None)),
            "19 coils from 0x0013"
        );
        assert_eq!(
            meaning(&taken(Language::Zh, &[0x05, 0, 0xAC, 0xFF, 0], Direction::Request, None)),
            "线圈 0x00AC 接通"
        );
        assert_eq!(
            meaning(&taken(Language::En, &[0x0F, 0, 3, 0, 1, 1, 0], Direction::Request, None)),
            "coil 0x0003 off"
        );
        let one = Request::ReadCoils { address: 3, quantity: 1 };
        assert_eq!(meaning(&taken(Language::Zh, &[0x01, 1, 1], Direction::Response, Some(&one))), "0x0003 接通");
        let found = taken(Language::En, &[0x0F, 0, 0x13, 0, 10, 2, 0xFF, 0x03], Direction::Request, None);
        assert_eq!(meaning(&found), "10 coils from 0x0013: all on");
        let found = taken(Language::Zh, &[0x0F, 0, 0x13, 0, 10], Direction::Response, None);
        assert_eq!(meaning(&found), "从 0x0013 起 10 个线圈");
    }

    #[test]
    fn long_lists_end_with_how_many_more_there_are() {
        let request = Request::ReadCoils { address: 0, quantity: 16 };
        let found = taken(Language::En, &[0x01, 2, 0xFF, 0x7F], Direction::Response, Some(&request));
        assert!(meaning(&found).contains("0x0007 and 7 more; off: 0x000F"), "{}", meaning(&found));
        let found = taken(Language::Zh, &[[0x03, 20].as_slice(), &[0xAB; 20]].concat(), Direction::Response, None);
        assert_eq!(meaning(&found), "ABAB ABAB ABAB ABAB ABAB ABAB ABAB ABAB，另有 2 个");
    }

    #[test]
    fn registers_tell_their_signed_value() {
        let request = Request::ReadHoldingRegisters { address: 0x6B, quantity: 2 };
        let found = taken(Language::En, &[0x03, 4, 0xFF, 0xFE, 0, 7], Direction::Response, Some(&request));
        assert_eq!(told(&found)[1], ["Register 0x006B", "65534", "signed: \u{2212}2"]);
        assert_eq!(told(&found)[2], ["Register 0x006C", "7", ""]);
        assert_eq!(found.parts[3].registers, [0xFFFE]);
        assert_eq!(meaning(&found), "FFFE 0007");
        assert_eq!(meaning(&taken(Language::En, &[0x06, 0, 1, 0, 3], Direction::Request, None)), "register 0x0001 = 3");
    }

    /// Clause 6.7.
    #[test]
    fn the_exception_status_is_told_bit_by_bit() {
        let found = taken(Language::En, &[0x07, 0x6D], Direction::Response, None);
        assert_eq!(meaning(&found), "bits set: 0, 2, 3, 5, 6");
        assert_eq!(found.parts[2].bits.as_ref().unwrap().len(), 8);
        assert_eq!(told(&found)[0][1], "0110 1101");
        assert_eq!(meaning(&taken(Language::Zh, &[0x07, 0], Direction::Response, None)), "各位均为 0");
    }

    /// Clause 6.8.
    #[test]
    fn diagnostics_are_named_and_their_data_told() {
        let en = |pdu: &[u8], direction| {
            let found = taken(Language::En, pdu, direction, None);
            (meaning(&found).to_owned(), told(&found).last().map(|part| part[2].to_owned()).unwrap())
        };
        let pair = |text: &str, data: &str| (text.to_owned(), data.to_owned());
        assert_eq!(
            en(&[8, 0, 0, 0xA5, 0x37], Direction::Request),
            pair("return query data, A5 37", "comes back as it is")
        );
        assert_eq!(
            en(&[8, 0, 1, 0xFF, 0], Direction::Request),
            pair("restart communications, clears the event log too", "clears the event log too")
        );
        assert_eq!(en(&[8, 0, 3, 0x0D, 0], Direction::Request).1, "new last character of an ASCII frame: \\x0D");
        assert_eq!(
            en(&[8, 0, 11, 0, 0], Direction::Request),
            pair("return bus message count", "always 0000 in a request")
        );
        assert_eq!(
            en(&[8, 0, 11, 1, 2], Direction::Response),
            pair("return bus message count, counter: 258", "counter: 258")
        );
        assert_eq!(en(&[8, 0, 99, 1, 2], Direction::Response).0, "reserved sub-function, 01 02");
        let found = taken(Language::Zh, &[8, 0, 2, 0x80, 1], Direction::Response, None);
        assert_eq!(told(&found)[0], ["子功能码", "00 02", "返回诊断寄存器"]);
        assert_eq!(told(&found)[1], ["诊断数据", "1000 0000 0000 0001", "各位的含义由设备厂家定义"]);
    }

    /// Clauses 6.9 and 6.10, with the example of the latter.
    #[test]
    fn the_event_log_is_decoded() {
        let found = taken(Language::En, &[0x0C, 8, 0, 0, 1, 8, 1, 0x21, 0x20, 0x00], Direction::Response, None);
        assert_eq!(meaning(&found), "event count 264, message count 289");
        assert_eq!(told(&found)[1], ["Status", "00 00", "ready"]);
        assert_eq!(told(&found)[4], ["Event 1, the newest", "20", "entered listen only mode"]);
        assert_eq!(told(&found)[5], ["Event 2", "00", "communication restarted"]);
        let events = [0x0C, 10, 0xFF, 0xFF, 0, 0, 0, 0, 0xD2, 0x43, 0x04, 0x61];
        let found = taken(Language::En, &events, Direction::Response, None);
        let told = told(&found);
        assert_eq!(told[4][2], "message received, communication error, character overrun, broadcast received");
        assert_eq!(told[5][2], "message sent, exception 01 to 03 sent, exception 04 sent");
        assert_eq!(told[6][2], "entered listen only mode");
        assert_eq!(told[7][2], "message sent, exception 01 to 03 sent, in listen only mode");
        assert_eq!(found.parts[6].bits.as_ref().unwrap()[3].label, "character overrun");
        let found = taken(Language::Zh, &[0x0B, 0xFF, 0xFF, 1, 8], Direction::Response, None);
        assert_eq!(meaning(&found), "仍在执行上一条命令，事件计数 264");
    }

    /// Clause 6.13.
    #[test]
    fn a_server_id_is_shown_as_text_and_nothing_strange_gets_through() {
        let found = taken(Language::En, b"\x11\x06<b>\x1B\\\xFF", Direction::Response, None);
        assert_eq!(told(&found)[1], ["Server id", "<b>\\x1B\\\\", "3C 62 3E 1B 5C"]);
        assert_eq!(told(&found)[2], ["Run indicator", "FF", "running"]);
        assert_eq!(meaning(&found), "<b>\\x1B\\\\, running");
    }

    /// Clauses 6.14 and 6.15.
    #[test]
    fn registers_of_files_are_told_by_their_records() {
        let records = vec![
            FileRecordRange { file_number: 4, record_number: 1, record_length: 2 },
            FileRecordRange { file_number: 3, record_number: 9, record_length: 1 },
        ];
        let request = Request::ReadFileRecord { records };
        let found = taken(Language::En, &request.encode().unwrap(), Direction::Request, None);
        assert_eq!(meaning(&found), "file 4, record 1: 2 registers; file 3, record 9: 1 register");
        let reply = [0x14, 10, 5, 6, 0x0D, 0xFE, 0, 0x20, 3, 6, 0x33, 0xCD];
        let found = taken(Language::En, &reply, Direction::Response, Some(&request));
        let names: Vec<&str> = told(&found).iter().map(|part| part[0]).collect();
        assert_eq!(names[3..5], ["File 4, record 1", "File 4, record 2"]);
        assert_eq!(names[7], "File 3, record 9");
        let found = taken(Language::Zh, &reply, Direction::Response, None);
        assert_eq!(told(&found)[3][0], "寄存器");
        let write = [0x15, 13, 6, 0, 4, 0, 7, 0, 3, 6, 0xAF, 4, 0xBE, 0x10, 0x0D];
        let found = taken(Language::Zh, &write, Direction::Request, None);
        assert_eq!(meaning(&found), "文件 4，记录 7：3 个寄存器");
        assert_eq!(told(&found)[7][0], "文件 4，记录 9");
    }

    /// Clause 6.16.
    #[test]
    fn masks_are_told_in_binary_with_what_each_bit_does() {
        let found = taken(Language::En, &[0x16, 0, 4, 0, 0xF2, 0, 0x25], Direction::Request, None);
        assert_eq!(meaning(&found), "register 0x0004: AND 0x00F2, OR 0x0025");
        assert_eq!(told(&found)[1][1], "0000 0000 1111 0010");
        let bits = found.parts[4].bits.as_ref().unwrap();
        assert_eq!((&*bits[15].label, &*bits[14].label, &*bits[12].label), ("→ 1", "stays", "→ 0"));
        let found = taken(Language::Zh, &[0x16, 0, 4, 0, 0xF2, 0, 0x25], Direction::Request, None);
        assert_eq!(meaning(&found), "寄存器 0x0004：与 0x00F2，或 0x0025");
    }

    /// Clauses 6.17 and 6.18.
    #[test]
    fn reading_and_writing_at_once_and_queues() {
        let both = [0x17, 0, 3, 0, 6, 0, 14, 0, 3, 6, 0, 0xFF, 0, 0xFF, 0, 0xFF];
        let found = taken(Language::En, &both, Direction::Request, None);
        assert_eq!(meaning(&found), "6 registers from 0x0003; writes 3 registers from 0x000E");
        let names: Vec<&str> = told(&found).iter().map(|part| part[0]).collect();
        assert_eq!(names[..4], ["Address to read", "Quantity to read", "Address to write", "Quantity to write"]);
        assert_eq!(names[5], "Register 0x000E");
        let request = Request::ReadFifoQueue { address: 0x04DE };
        let found = taken(Language::Zh, &[0x18, 0, 6, 0, 2, 1, 0xB8, 0x12, 0x84], Direction::Response, Some(&request));
        assert_eq!(meaning(&found), "队列中有 2 个：01B8 1284");
        assert_eq!(told(&found)[1], ["队列计数", "2", "队列中有 2 个"]);
    }

    /// Clause 6.21.
    #[test]
    fn a_device_id_is_told_object_by_object() {
        let reply = [&[0x2B, 0x0E, 1, 0x81, 0xFF, 2, 2, 0, 7][..], b"Company", &[0x80, 2, 0x07, b'x']].concat();
        let found = taken(Language::En, &reply, Direction::Response, None);
        assert_eq!(found.facts.as_ref().unwrap().function, "2B read device identification");
        assert_eq!(meaning(&found), "VendorName: Company, maker's own object 80: \\x07x");
        let told_en = told(&found);
        assert_eq!(told_en[0], ["MEI type", "0E", "read device identification"]);
        assert_eq!(told_en[2], ["Conformity level", "81", "basic identification, also object by object"]);
        assert_eq!(told_en[3][2], "there are more objects");
        assert_eq!(told_en[4], ["Next object id", "02", "MajorMinorRevision"]);
        assert_eq!(told_en[8], ["VendorName", "Company", ""]);
        let found = taken(Language::Zh, &reply, Direction::Response, None);
        assert_eq!(told(&found)[8][0], "厂商名称（VendorName）");
        let asked = |code, object| {
            meaning(&taken(Language::En, &[0x2B, 0x0E, code, object], Direction::Request, None)).to_owned()
        };
        assert_eq!(asked(1, 0), "basic identification");
        assert_eq!(asked(4, 1), "one object, ProductCode");
        let other = taken(Language::Zh, &[0x2B, 0x0D, 1, 2], Direction::Request, None);
        assert_eq!(other.facts.as_ref().unwrap().function, "2B 封装接口传输");
        // In ASCII mode the text is what the characters spell.
        let frame = adu::encode(Mode::Ascii, UnitId(1), &reply).unwrap();
        let found =
            Anatomy::of(Language::En, None, &frame, Mode::Ascii, Direction::Response, None, &mut Known::default());
        assert!(meaning(&found).starts_with("VendorName: Company"));
        assert_covers(&found);
    }

    #[test]
    fn functions_have_the_standards_names() {
        let names = |function| LANGUAGES.map(|language| function_name(language, function));
        assert_eq!(names(0x01), ["read coils", "读线圈"]);
        assert_eq!(names(0x16), ["mask write register", "屏蔽写寄存器"]);
        assert_eq!(names(0x17), ["read/write multiple registers", "读/写多个寄存器"]);
        assert_eq!(names(0x41)[0], "maker's own function");
        assert_eq!(names(0x59)[1], "未知功能码");
        let public = [1, 2, 3, 4, 5, 6, 7, 8, 0x0B, 0x0C, 0x0F, 0x10, 0x11, 0x14, 0x15, 0x16, 0x17, 0x18, 0x2B];
        for language in LANGUAGES {
            let mut all: Vec<&str> = public.iter().map(|function| function_name(language, *function)).collect();
            all.dedup();
            assert_eq!(all.len(), public.len());
            assert!(!all.contains(&language.function_other()));
        }
    }

    #[test]
    fn faults_are_told_in_words_at_the_field_that_is_wrong() {
        let found = taken(Language::En, &[0x03, 0, 0, 0, 126], Direction::Request, None);
        assert_eq!(meaning(&found), "quantity 126 is not 1 to 125");
        assert_eq!((found.parts[3].kind, &*found.parts[3].meaning), ("wrong", "quantity 126 is not 1 to 125"));
        let found = taken(Language::Zh, &[0x03, 4, 0, 7], Direction::Response, None);
        assert_eq!((found.parts[2].kind, &*found.parts[2].meaning), ("wrong", "字节数为 4，应为 2"));
        let found = taken(Language::En, &[0x05, 0, 1, 0x12, 0x34], Direction::Request, None);
        assert_eq!((found.parts[3].kind, meaning(&found)), ("wrong", "coil value 1234 is neither FF00 nor 0000"));
        let found = taken(Language::En, &[0x2B, 0x0E, 7, 0], Direction::Request, None);
        assert_eq!((found.parts[3].kind, meaning(&found)), ("wrong", "read device id code 7 is not 1 to 4"));
        let found = taken(Language::En, &[0x06, 0, 1], Direction::Request, None);
        assert_eq!(meaning(&found), "length 3 from the function code on, but this function needs 5");
        let request = Request::ReadCoils { address: 0, quantity: 3 };
        let found = taken(Language::Zh, &[0x01, 1, 0xFF], Direction::Response, Some(&request));
        assert_eq!(found.parts[3].meaning, "不对应任何线圈或输入的填充位不为 0");
    }

    #[test]
    fn a_wrong_check_tells_the_right_one_as_on_the_wire() {
        let frame = [0x0C, 0x04, 0x00, 0x04, 0x00, 0x02, 0x31, 0x18];
        let known = &mut Known::default();
        let found =
            Anatomy::of(Language::En, Some(profile("lvdt")), &frame, Mode::Rtu, Direction::Unknown, None, known);
        let facts = found.facts.unwrap();
        assert!(!facts.check_ok);
        assert_eq!(facts.expected, "31 17");
        assert_eq!(facts.meaning, "2 registers from 0x0004: Displacement");
        assert_eq!(found.parts.last().unwrap().kind, "wrong");
    }

    #[test]
    fn bits_of_a_register_come_highest_first() {
        let bits = bits::bits_of(0x8001);
        assert_eq!((bits[0], bits[1], bits[15]), ((15, true), (14, false), (0, true)));
    }

    #[test]
    fn a_request_is_found_in_either_mode() {
        let request = Request::ReadHoldingRegisters { address: 0x31, quantity: 1 };
        assert_eq!(request_in(b":010300310001CA\r\n", Mode::Ascii), Some((1, request.clone())));
        let frame = [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5];
        assert_eq!(request_in(&frame, Mode::Rtu), Some((1, request)));
        assert_eq!(request_in(&frame[..7], Mode::Rtu), None);
    }

    /// Chinese texts hold together where they are put together: a space between Han and Latin, full-width marks.
    fn assert_well_set(text: &str) {
        let characters: Vec<char> = text.chars().collect();
        let han = |c: char| matches!(c, '\u{4E00}'..='\u{9FFF}');
        for pair in characters.windows(2) {
            let (one, other) = (pair[0], pair[1]);
            let latin = |c: char| c.is_ascii_alphanumeric();
            assert!(!(han(one) && latin(other) || latin(one) && han(other)), "{text}");
            assert!(!(han(one) && ",;:?!()".contains(other)), "{text}");
        }
    }

    /// Every frame that another implementation makes, in both modes and languages, with every profile and with none.
    #[test]
    fn every_byte_of_every_known_frame_belongs_to_one_named_part() {
        let table = include_str!("../../codec/tests/data/pymodbus_vectors.csv");
        let rows = table.lines().skip(2).map(|line| line.split(',').collect::<Vec<&str>>());
        let mut frames = 0;
        let mut requests: Vec<(u8, Request)> = Vec::new();
        for row in rows {
            let digits = row[3].as_bytes().chunks(2).map(|pair| std::str::from_utf8(pair).unwrap());
            let rtu: Vec<u8> = digits.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect();
            let ascii = [row[4].as_bytes(), b"\r\n"].concat();
            let direction = if row[1] == "request" { Direction::Request } else { Direction::Response };
            if direction == Direction::Request {
                requests.extend(request_in(&rtu, Mode::Rtu));
            }
            let fitting = requests.iter().rev().find(|(_, request)| request.function() == rtu[1] & 0x7F);
            let request = fitting.map(|(_, request)| request).filter(|_| direction == Direction::Response);
            let profiles = device::built_in().iter().map(|device| Some(device.profile())).chain([None]);
            for (profile, language) in profiles.flat_map(|profile| LANGUAGES.map(|language| (profile, language))) {
                for (bytes, mode) in [(&rtu, Mode::Rtu), (&ascii, Mode::Ascii)] {
                    for request in [None, request] {
                        let known = &mut Known::default();
                        let found = Anatomy::of(language, profile, bytes, mode, direction, request, known);
                        assert_covers(&found);
                        let facts = found.facts.as_ref().unwrap();
                        assert!(facts.check_ok && facts.direction == direction, "{row:?}");
                        if language == Language::Zh {
                            let parts = found.parts.iter().flat_map(|part| [&part.name, &part.meaning, &part.caption]);
                            parts.chain([&facts.meaning, &facts.function]).for_each(|text| assert_well_set(text));
                        }
                        frames += 1;
                    }
                }
            }
        }
        assert!(frames > 400 * 32, "{frames}");
    }

    #[test]
    fn damaged_frames_are_covered_too() {
        let whole = [0x01, 0x10, 0x00, 0x31, 0x00, 0x01, 0x02, 0x00, 0x07, 0xE0, 0x63];
        for end in 0..=whole.len() {
            for function in 0..=0xFF {
                let mut frame = whole[..end].to_vec();
                if let Some(byte) = frame.get_mut(1) {
                    *byte = function;
                }
                for direction in [Direction::Request, Direction::Response, Direction::Unknown] {
                    let known = &mut Known::default();
                    let found =
                        Anatomy::of(Language::Zh, Some(profile("lvdt")), &frame, Mode::Rtu, direction, None, known);
                    assert_covers(&found);
                    let noise = Anatomy::of_dissection(Language::En, None, &frame, Mode::Rtu, None, None);
                    assert_covers(&noise);
                }
            }
        }
    }

    #[test]
    fn points_that_share_a_register_stand_in_one_part() {
        let file = include_str!("../../codec/profiles/lvdt.json");
        let bit = |id: &str, mask: u16, shift: u8, name: &str| {
            format!(
                r#"{{ "id": "{id}", "name": {{ "en": "{name}", "zh": "{name}" }}, "register": "0x0001", "encoding": {{ "type": "bits", "mask": {mask}, "shift": {shift} }}, "read": [4], "role": "parameter" }},"#
            )
        };
        let more = [r#""points": ["#, &bit("low", 0x0F, 0, "Low"), &bit("high", 0xF0, 4, "High")].concat();
        let profile = Profile::from_json(&file.replace(r#""points": ["#, &more)).unwrap();
        let request = Request::ReadInputRegisters { address: 1, quantity: 1 };
        let frame = adu::encode(Mode::Rtu, UnitId(1), &[0x04, 2, 0, 0x53]).unwrap();
        let known = &mut Known::default();
        let found =
            Anatomy::of(Language::En, Some(&profile), &frame, Mode::Rtu, Direction::Response, Some(&request), known);
        assert_covers(&found);
        assert_eq!(told(&found)[1], ["Register 0x0001", "Low 3, High 5", ""]);
        assert_eq!(meaning(&found), "Low 3, High 5");
    }
}
