//! What is wrong with a frame in plain words: what it is, what most likely causes it on a line, what the frame should be.

mod refusal;

use std::ops::Range;

use buslens_codec::diagnose::{Diagnosis, Placed};
use buslens_codec::dissect::{Dissection, FieldKind};
use buslens_codec::line::Mode;
use buslens_codec::pdu::Request;
use buslens_codec::profile::{Profile, UnitFit};
use buslens_codec::{UnitId, adu, ascii};

use crate::anatomy::{allowed, legible};
use crate::device::{pick, value_text};
use crate::format::{hex, hex_spaced};
use crate::text::Language;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Severity {
    /// The frame is damaged or built wrongly.
    Fault,
    /// The frame is whole, but what it says needs attention.
    Warning,
    /// Good to know.
    Info,
}

/// A diagnosis in words.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Told {
    /// Its stable name for programs.
    pub(crate) id: &'static str,
    /// How bad it is.
    pub(crate) severity: Severity,
    /// What is wrong, in a few words.
    pub(crate) title: String,
    /// The particulars and the likely causes, in sentences.
    pub(crate) what: String,
    /// The whole frame as it should be, as on the wire: in ASCII mode its characters, CR LF included.
    pub(crate) repaired: Option<Vec<u8>>,
    /// The bytes of the frame that it is about, characters in ASCII mode; around the gap where one is missing.
    pub(crate) place: Option<Range<usize>>,
}

/// A frame with what is known of it.
#[derive(Clone, Copy)]
pub(crate) struct Case<'a> {
    /// The device that it is taken for.
    pub(crate) profile: Option<&'a Profile>,
    /// As on the wire.
    pub(crate) frame: &'a [u8],
    /// RTU or ASCII.
    pub(crate) mode: Mode,
    /// The frame taken apart, if that is possible.
    pub(crate) dissection: Option<&'a Dissection>,
    /// What it answers, if that is known.
    pub(crate) request: Option<&'a Request>,
}

/// Puts a diagnosis into words.
pub(crate) fn told(language: Language, case: &Case<'_>, diagnosis: &Diagnosis) -> Told {
    let (severity, title, what, place) = match diagnosis {
        Diagnosis::SingleBitError { .. }
        | Diagnosis::SwappedCrc { .. }
        | Diagnosis::MissingByte { .. }
        | Diagnosis::ExtraByte { .. } => case.changed(language, diagnosis),
        Diagnosis::BadCrc { .. }
        | Diagnosis::BadLrc { .. }
        | Diagnosis::LrcInRtu
        | Diagnosis::CrcInAscii
        | Diagnosis::AsciiNotHex { .. }
        | Diagnosis::Truncated { .. } => case.broken(language, diagnosis),
        Diagnosis::Echo
        | Diagnosis::ByteCountMismatch { .. }
        | Diagnosis::Exception { .. }
        | Diagnosis::UnitReserved { .. }
        | Diagnosis::ValueOutOfRange { .. }
        | Diagnosis::ManualErratum { .. } => case.remarkable(language, diagnosis),
    };
    Told { id: diagnosis.id(), severity, title: title.into(), what, repaired: case.repaired(diagnosis), place }
}

/// Severity, title, sentences, place.
type Words = (Severity, Title, String, Option<Range<usize>>);

/// A title that stands for itself or that was put together.
enum Title {
    Fixed(&'static str),
    Made(String),
}

impl From<Title> for String {
    fn from(title: Title) -> Self {
        match title {
            Title::Fixed(text) => text.to_owned(),
            Title::Made(text) => text,
        }
    }
}

impl Case<'_> {
    /// One change makes it whole.
    fn changed(self, t: Language, diagnosis: &Diagnosis) -> Words {
        let right = self.repaired(diagnosis).unwrap_or_default();
        let (title, particulars, cause, place) = match diagnosis {
            Diagnosis::SingleBitError { byte, bit, .. } => {
                let range = *byte..byte + 1;
                let (found, right) = (self.quoted(self.frame, range.clone()), self.quoted(&right, range.clone()));
                let text = match self.mode {
                    Mode::Rtu => t.bit_turned_in_byte(byte + 1, &found, &right, *bit),
                    Mode::Ascii => t.bit_turned_in_character(byte + 1, &found, &right, *bit),
                };
                (t.bit_turned(), text, t.bit_turned_cause(), Some(range))
            }
            Diagnosis::MissingByte { repair: Some(Placed { at, .. }) } => {
                let lost = right.len().saturating_sub(self.frame.len());
                let text = t.byte_missing_at(at + 1, &self.quoted(&right, *at..at + lost));
                (t.byte_missing(), text, t.byte_missing_cause(), Some(at.saturating_sub(1)..at + 1))
            }
            Diagnosis::MissingByte { repair: None } => {
                (t.byte_missing(), t.byte_missing_somewhere().to_owned(), t.byte_missing_cause(), None)
            }
            Diagnosis::ExtraByte { repair: Some(Placed { at, .. }) } => {
                let range = *at..at + self.frame.len().saturating_sub(right.len());
                let text = t.byte_extra_at(at + 1, &self.quoted(self.frame, range.clone()));
                (t.byte_extra(), text, t.byte_extra_cause(), Some(range))
            }
            Diagnosis::ExtraByte { repair: None } => {
                (t.byte_extra(), t.byte_extra_somewhere().to_owned(), t.byte_extra_cause(), None)
            }
            _ => (t.crc_swapped(), String::new(), t.crc_swapped_cause(), self.last(2)),
        };
        let what = sentences(t, &[&particulars, cause]);
        (Severity::Fault, Title::Fixed(title), what, place.map(|place| self.within(place)))
    }

    /// It is no frame as it stands.
    fn broken(self, t: Language, diagnosis: &Diagnosis) -> Words {
        let (title, what, place) = match diagnosis {
            Diagnosis::BadCrc { expected } => {
                (t.crc_wrong(), t.check_for_these_bytes(&hex_spaced(expected)), self.last(2))
            }
            Diagnosis::BadLrc { expected } => (t.lrc_wrong(), t.check_for_these_bytes(&hex(*expected)), self.last(2)),
            Diagnosis::LrcInRtu => (t.lrc_in_rtu(), t.lrc_in_rtu_cause().to_owned(), self.last(1)),
            Diagnosis::CrcInAscii => (t.crc_in_ascii(), t.crc_in_ascii_cause().to_owned(), self.last(4)),
            Diagnosis::AsciiNotHex { at } => {
                let place = Some(self.within(*at..at + 1));
                match self.frame.get(*at) {
                    Some(digit) if (digit & 0x7F).is_ascii_hexdigit() => {
                        (t.digits_odd(), sentences(t, &[t.digits_odd_what(), t.not_hex_cause()]), place)
                    }
                    _ => {
                        let found = t.not_hex_at(at + 1, &self.quoted(self.frame, *at..at + 1));
                        (t.not_hex(), sentences(t, &[&found, t.not_hex_cause()]), place)
                    }
                }
            }
            Diagnosis::Truncated { expected } => {
                let length = self.frame.len();
                let counted = match (expected, self.mode) {
                    (Some(expected), Mode::Rtu) => t.cut_off_of(length, *expected),
                    (Some(expected), Mode::Ascii) => t.cut_off_characters_of(length, *expected),
                    (None, _) => String::new(),
                };
                (t.cut_off(), sentences(t, &[&counted, t.cut_off_cause()]), self.last(1))
            }
            _ => ("", String::new(), None),
        };
        (Severity::Fault, Title::Fixed(title), what, place)
    }

    /// It is whole, but there is something to say of it.
    fn remarkable(self, t: Language, diagnosis: &Diagnosis) -> Words {
        match diagnosis {
            Diagnosis::ByteCountMismatch { found, expected } => {
                let what = sentences(t, &[&t.byte_count_wrong_what(*found, *expected), t.byte_count_wrong_cause()]);
                let place = self.field(|kind| matches!(kind, FieldKind::ByteCount(_)));
                (Severity::Fault, Title::Fixed(t.byte_count_wrong()), what, place)
            }
            Diagnosis::Exception { code } => {
                let place = self.field(|kind| matches!(kind, FieldKind::Exception(_)));
                // Accepted or busy: asking again is all there is to do.
                let severity = if matches!(code, 5 | 6) { Severity::Info } else { Severity::Warning };
                let title = t.refused(*code, t.exception_name(*code));
                let title = if *code == 5 { t.exception_is(*code, t.exception_name(*code)) } else { title };
                (severity, Title::Made(title), refusal::why(t, &self, *code), place)
            }
            Diagnosis::UnitReserved { unit } => {
                let here = self.profile.map(|profile| match profile.unit_fit(UnitId(*unit)) {
                    UnitFit::Refused => t.unit_not_taken(profile.units.first, profile.units.last),
                    UnitFit::Usual | UnitFit::Reserved => t.unit_taken_here().to_owned(),
                });
                let what = sentences(t, &[t.unit_is_reserved_what(), &here.unwrap_or_default()]);
                let place = self.field(|kind| matches!(kind, FieldKind::Unit(_)));
                (Severity::Warning, Title::Made(t.unit_is_reserved_title(*unit)), what, place)
            }
            Diagnosis::ValueOutOfRange { point } => self.value(t, point),
            Diagnosis::ManualErratum { number } => {
                let erratum = self.profile.and_then(|profile| profile.errata.get(number.checked_sub(1)?));
                let what = erratum.map(|erratum| {
                    let right = if erratum.right.is_empty() {
                        String::new()
                    } else {
                        t.manual_right_frame(&self.shown(&erratum.right))
                    };
                    sentences(t, &[pick(t, &erratum.text), &right])
                });
                let place = erratum.and_then(|erratum| difference(&erratum.printed, &erratum.right));
                (Severity::Info, Title::Fixed(t.manual_is_wrong()), what.unwrap_or_default(), place)
            }
            _ => (Severity::Info, Title::Fixed(t.echo()), t.echo_what().to_owned(), None),
        }
    }

    fn value(self, t: Language, id: &str) -> Words {
        let point = self.profile.and_then(|profile| profile.point(id));
        let named = self.dissection.and_then(|found| found.points.iter().find(|named| named.point == id));
        let what = point.zip(named).map(|(point, named)| {
            let name = pick(t, &point.name);
            let particulars = if let Ok(value) = named.value {
                t.value_is(name, &value_text(t, point, value))
            } else {
                let bytes: Vec<u8> = named.raw.iter().flat_map(|register| register.to_be_bytes()).collect();
                t.value_has_no_format(name, &hex_spaced(&bytes))
            };
            let allowed = allowed(t, point);
            let allowed = if allowed.is_empty() { String::new() } else { t.value_may_be(&allowed) };
            sentences(t, &[&particulars, &allowed, t.value_cause()])
        });
        let what = what.unwrap_or_else(|| t.value_cause().to_owned());
        (Severity::Warning, Title::Fixed(t.value_not_allowed()), what, named.map(|named| named.range.clone()))
    }

    /// The whole frame as it should be, as on the wire.
    fn repaired(self, diagnosis: &Diagnosis) -> Option<Vec<u8>> {
        if let Some(repaired) = diagnosis.repaired() {
            return self.on_the_wire(repaired, if self.mode == Mode::Rtu { 2 } else { 1 });
        }
        match diagnosis {
            Diagnosis::LrcInRtu => self.on_the_wire(self.frame, 1),
            Diagnosis::CrcInAscii => self.on_the_wire(&ascii::decode_body(self.frame).ok()?, 2),
            Diagnosis::ManualErratum { number } => {
                let erratum = self.profile?.errata.get(number.checked_sub(1)?)?;
                Some(erratum.right.clone()).filter(|right| !right.is_empty())
            }
            _ => None,
        }
    }

    /// Unit id, PDU and so many bytes of check as the frame of this mode that they should be.
    fn on_the_wire(self, bytes: &[u8], check: usize) -> Option<Vec<u8>> {
        let (unit, pdu) = bytes.get(..bytes.len().checked_sub(check)?)?.split_first()?;
        adu::encode(self.mode, UnitId(*unit), pdu)
    }

    /// Bytes as digits, or the characters of ASCII mode in quotation marks.
    fn quoted(self, bytes: &[u8], range: Range<usize>) -> String {
        let bytes = bytes.get(range).unwrap_or_default();
        match self.mode {
            Mode::Rtu => hex_spaced(bytes),
            Mode::Ascii => ["“", &legible(bytes), "”"].concat(),
        }
    }

    /// A whole frame for reading.
    fn shown(self, frame: &[u8]) -> String {
        match self.mode {
            Mode::Rtu => hex_spaced(frame),
            Mode::Ascii => legible(frame.strip_suffix(b"\r\n").unwrap_or(frame)),
        }
    }

    /// The last bytes, or the last characters before the line end.
    fn last(self, count: usize) -> Option<Range<usize>> {
        let ends_line = self.mode == Mode::Ascii && self.frame.ends_with(b"\r\n");
        let end = if ends_line { self.frame.len() - 2 } else { self.frame.len() };
        Some(end.checked_sub(count)?..end)
    }

    fn within(self, place: Range<usize>) -> Range<usize> {
        let end = place.end.min(self.frame.len());
        place.start.min(end.saturating_sub(1))..end
    }

    fn field(self, is_it: fn(FieldKind) -> bool) -> Option<Range<usize>> {
        let field = self.dissection?.fields.iter().find(|field| is_it(field.kind))?;
        Some(field.range.clone())
    }
}

/// From the first to the last byte in which two frames of one length differ.
fn difference(one: &[u8], other: &[u8]) -> Option<Range<usize>> {
    let differs = |at: &usize| one.get(*at) != other.get(*at);
    let first = (0..one.len()).find(differs)?;
    let last = (0..one.len()).rev().find(differs)?;
    (one.len() == other.len()).then_some(first..last + 1)
}

/// Sentences in a row, empty ones left out. Chinese ones bring their own space.
fn sentences(t: Language, parts: &[&str]) -> String {
    let parts: Vec<&str> = parts.iter().copied().filter(|part| !part.is_empty()).collect();
    parts.join(match t {
        Language::En => " ",
        Language::Zh => "",
    })
}

#[cfg(test)]
mod tests {
    use buslens_codec::diagnose::{Surroundings, damage};
    use buslens_codec::dissect::{Direction, dissect};
    use buslens_codec::profile::Known;
    use buslens_codec::rtu;
    use buslens_codec::segment::Segment;
    use buslens_codec::transcript::Transcript;

    use super::*;
    use crate::device;

    const LANGUAGES: [Language; 2] = [Language::En, Language::Zh];

    fn profile(id: &str) -> &'static Profile {
        device::find(id).profile()
    }

    /// The first diagnosis of a damaged frame in both languages.
    fn damaged(mode: Mode, frame: &[u8]) -> [Told; 2] {
        let found = damage(mode, frame, Surroundings::UNKNOWN);
        words(mode, frame, &found[0])
    }

    fn words(mode: Mode, frame: &[u8], diagnosis: &Diagnosis) -> [Told; 2] {
        let dissection = dissect(frame, mode, Direction::Unknown, None, Some(profile("lvdt")));
        let case = Case { profile: Some(profile("lvdt")), frame, mode, dissection: dissection.as_ref(), request: None };
        LANGUAGES.map(|language| told(language, &case, diagnosis))
    }

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

    /// Every diagnosis says something, in good Chinese too, and marks bytes of the frame only.
    fn assert_whole(told: &[Told; 2], frame: &[u8]) {
        for told in told {
            assert!(!told.title.is_empty() && !told.what.is_empty(), "{told:?}");
            assert!(
                told.place.as_ref().is_none_or(|place| place.start < place.end && place.end <= frame.len()),
                "{told:?}"
            );
        }
        let [en, zh] = told;
        assert_eq!((en.id, en.severity, &en.repaired, &en.place), (zh.id, zh.severity, &zh.repaired, &zh.place));
        assert!(en.title != zh.title && en.what != zh.what);
        assert_well_set(&zh.title);
        assert_well_set(&zh.what);
    }

    /// Reads temperature and displacement of unit 1.
    const READ: [u8; 8] = [0x01, 0x04, 0x00, 0x02, 0x00, 0x04, 0x50, 0x09];
    const READ_ASCII: &[u8] = b":010400020004F5\r\n";

    #[test]
    fn a_turned_bit_is_told_with_its_byte() {
        let mut frame = READ;
        frame[3] ^= 0x04;
        let told = damaged(Mode::Rtu, &frame);
        assert_whole(&told, &frame);
        assert_eq!((told[0].id, told[0].severity), ("single_bit_error", Severity::Fault));
        assert!(
            told[0].what.starts_with("Byte 4 came as 06 instead of 02: with bit 2 turned back"),
            "{}",
            told[0].what
        );
        assert!(told[1].what.starts_with("第 4 个字节收到的是 06，应为 02"), "{}", told[1].what);
        assert_eq!((told[0].place.clone(), told[0].repaired.as_deref()), (Some(3..4), Some(&READ[..])));
    }

    #[test]
    fn a_swapped_crc_is_the_programs_fault() {
        let frame = [&READ[..6], &[0x09, 0x50]].concat();
        let told = damaged(Mode::Rtu, &frame);
        assert_whole(&told, &frame);
        assert_eq!((told[0].id, told[0].place.clone()), ("swapped_crc", Some(6..8)));
        assert!(told[0].what.contains("high byte first"));
        assert_eq!(told[1].repaired.as_deref(), Some(&READ[..]));
    }

    #[test]
    fn lost_and_added_bytes_are_placed() {
        let frame = [&READ[..3], &READ[4..]].concat();
        let told = damaged(Mode::Rtu, &frame);
        assert_whole(&told, &frame);
        assert_eq!((told[0].id, told[0].place.clone()), ("missing_byte", Some(2..4)));
        assert!(told[0].what.starts_with("02 got lost at place 4"), "{}", told[0].what);
        let frame = [&READ[..3], &[0x77], &READ[3..]].concat();
        let told = damaged(Mode::Rtu, &frame);
        assert_whole(&told, &frame);
        assert_eq!((told[0].id, told[0].place.clone()), ("extra_byte", Some(3..4)));
        assert!(told[1].what.starts_with("位置 4 处多出 77"), "{}", told[1].what);
        for diagnosis in [Diagnosis::MissingByte { repair: None }, Diagnosis::ExtraByte { repair: None }] {
            let told = words(Mode::Rtu, &frame, &diagnosis);
            assert_whole(&told, &frame);
            assert!(told[0].what.contains("several places would do"));
        }
    }

    #[test]
    fn wrong_checks_tell_the_right_ones() {
        let frame = [0x01, 0x04, 0x00, 0x02, 0x00, 0x04, 0xAB, 0xCD];
        let told = words(Mode::Rtu, &frame, &Diagnosis::BadCrc { expected: [0x50, 0x09] });
        assert_whole(&told, &frame);
        assert!(told[0].what.contains("50 09"));
        let frame = b":010400020004F4\r\n";
        let told = words(Mode::Ascii, frame, &Diagnosis::BadLrc { expected: 0xF5 });
        assert_whole(&told, frame);
        assert_eq!((told[1].title.as_str(), told[1].place.clone()), ("LRC 错误", Some(13..15)));
    }

    #[test]
    fn a_check_of_the_other_mode_is_replaced() {
        let frame = [&READ[..6], &[0xF5]].concat();
        let told = words(Mode::Rtu, &frame, &Diagnosis::LrcInRtu);
        assert_whole(&told, &frame);
        assert_eq!((told[0].repaired.as_deref(), told[0].place.clone()), (Some(&READ[..]), Some(6..7)));
        let frame = b":0104000200045009\r\n";
        let told = words(Mode::Ascii, frame, &Diagnosis::CrcInAscii);
        assert_whole(&told, frame);
        assert_eq!((told[0].repaired.as_deref(), told[0].place.clone()), (Some(READ_ASCII), Some(13..17)));
    }

    #[test]
    fn damaged_characters_are_told_as_characters() {
        let frame = b":0104000r0004F5\r\n";
        let told = words(Mode::Ascii, frame, &Diagnosis::AsciiNotHex { at: 8 });
        assert_whole(&told, frame);
        assert!(told[0].what.starts_with("Character 9 is “r”"), "{}", told[0].what);
        let told = damaged(Mode::Ascii, frame);
        assert_whole(&told, frame);
        assert!(told[0].what.starts_with("Character 9 came as “r” instead of “2”"), "{}", told[0].what);
        assert_eq!(told[0].repaired.as_deref(), Some(READ_ASCII));
        let frame = b":01040002004F5\r\n";
        let told = words(Mode::Ascii, frame, &Diagnosis::AsciiNotHex { at: 13 });
        assert_whole(&told, frame);
        assert_eq!(told[0].title, "A digit without its twin");
        let frame = b"010400020004F5\r\n";
        let told = damaged(Mode::Ascii, frame);
        assert_whole(&told, frame);
        assert!(told[1].what.starts_with("位置 1 处丢失了 “:”"), "{}", told[1].what);
    }

    #[test]
    fn a_frame_that_ends_early_tells_how_much_is_missing() {
        let told = words(Mode::Rtu, &READ[..5], &Diagnosis::Truncated { expected: Some(8) });
        assert_whole(&told, &READ[..5]);
        assert!(
            told[0].what.starts_with("5 bytes came of 8.") && told[1].what.starts_with("应有 8 字节，只收到 5 字节。")
        );
        let told = words(Mode::Ascii, &READ_ASCII[..9], &Diagnosis::Truncated { expected: None });
        assert_whole(&told, &READ_ASCII[..9]);
    }

    #[test]
    fn a_wrong_byte_count_and_an_echo() {
        let frame = rtu::encode(UnitId(1), &[0x03, 0x04, 0x00, 0x07]).unwrap();
        let told = words(Mode::Rtu, &frame, &Diagnosis::ByteCountMismatch { found: 4, expected: 2 });
        assert_whole(&told, &frame);
        assert_eq!((told[0].severity, told[0].place.clone()), (Severity::Fault, Some(2..3)));
        let told = words(Mode::Rtu, &READ, &Diagnosis::Echo);
        assert_whole(&told, &READ);
        assert_eq!((told[0].severity, told[0].place.clone()), (Severity::Info, None));
    }

    #[test]
    fn reserved_unit_ids_are_told_by_device() {
        let frame = rtu::encode(UnitId(250), &[0x03, 0, 4, 0, 1]).unwrap();
        let diagnosis = Diagnosis::UnitReserved { unit: 250 };
        let told = words(Mode::Rtu, &frame, &diagnosis);
        assert_whole(&told, &frame);
        assert!(told[0].what.ends_with("The chosen device takes 1 to 247."), "{}", told[0].what);
        let dissection = dissect(&frame, Mode::Rtu, Direction::Request, None, None);
        let case = Case {
            profile: Some(profile("level")),
            frame: &frame,
            mode: Mode::Rtu,
            dissection: dissection.as_ref(),
            request: None,
        };
        let told = super::told(Language::Zh, &case, &diagnosis);
        assert!(told.what.contains("所选设备支持该地址"), "{}", told.what);
        assert_eq!(told.place, Some(0..1));
    }

    #[test]
    fn a_value_that_is_not_allowed_is_told_with_what_is() {
        let frame = rtu::encode(UnitId(1), &[0x10, 0, 0x31, 0, 1, 2, 0, 9]).unwrap();
        let told = words(Mode::Rtu, &frame, &Diagnosis::ValueOutOfRange { point: "baud".into() });
        assert_whole(&told, &frame);
        assert!(told[0].what.starts_with("Baud rate is 9. Allowed: 1 = 2400\u{A0}Bd,"), "{}", told[0].what);
        assert!(told[1].what.starts_with("波特率的值为 9。允许值：1 = 2400"), "{}", told[1].what);
        assert_eq!(told[0].place, Some(7..9));
        let request = Request::ReadInputRegisters { address: 4, quantity: 2 };
        let frame = rtu::encode(UnitId(1), &[0x04, 4, 0, 1, 0x03, 0xE8]).unwrap();
        let dissection = dissect(&frame, Mode::Rtu, Direction::Response, Some(&request), Some(profile("lvdt")));
        let case = Case {
            profile: Some(profile("lvdt")),
            frame: &frame,
            mode: Mode::Rtu,
            dissection: dissection.as_ref(),
            request: Some(&request),
        };
        let told = super::told(Language::En, &case, &Diagnosis::ValueOutOfRange { point: "displacement".into() });
        assert!(told.what.starts_with("Displacement is written as 00 01 03 E8, which is none of its values."));
    }

    #[test]
    fn the_manuals_errata_say_which_side_is_right() {
        let frame = b":010300310001C1\r\n";
        let told = words(Mode::Ascii, frame, &Diagnosis::ManualErratum { number: 1 });
        assert_whole(&told, frame);
        assert_eq!(told[0].repaired.as_deref(), Some(&b":010300310001CA\r\n"[..]));
        assert_eq!(told[0].place, Some(14..15));
        assert!(told[0].what.ends_with("Right is :010300310001CA: the device takes this one."), "{}", told[0].what);
        let nothing = words(Mode::Ascii, frame, &Diagnosis::ManualErratum { number: 0 });
        assert_eq!((nothing[0].repaired.clone(), nothing[0].place.clone()), (None, None));
    }

    /// What is told of an exception to this request.
    fn refused(device: &str, pdu: &[u8], code: u8) -> [String; 2] {
        let request = Request::decode(pdu).unwrap();
        let frame = rtu::encode(UnitId(1), &[pdu[0] | 0x80, code]).unwrap();
        let dissection = dissect(&frame, Mode::Rtu, Direction::Response, Some(&request), Some(profile(device)));
        let case = Case {
            profile: Some(profile(device)),
            frame: &frame,
            mode: Mode::Rtu,
            dissection: dissection.as_ref(),
            request: Some(&request),
        };
        let told = LANGUAGES.map(|language| told(language, &case, &Diagnosis::Exception { code }));
        assert_whole(&told, &frame);
        assert_eq!(told[0].place, Some(2..3));
        told.map(|told| told.what)
    }

    #[test]
    fn a_refusal_is_explained_by_the_devices_profile() {
        let cases: [(&str, &[u8], u8, &str, &str); 12] = [
            (
                "lvdt",
                &[0x04, 0, 4, 0, 1],
                2,
                "Displacement takes 2 registers from 0x0004 on",
                "位移占用从 0x0004 起的 2 个寄存器",
            ),
            (
                "lvdt",
                &[0x04, 0, 3, 0, 3],
                2,
                "Temperature takes 2 registers from 0x0002 on",
                "温度占用从 0x0002 起的 2 个寄存器",
            ),
            ("lvdt", &[0x03, 0, 0x31, 0, 4], 2, "goes over register 0x0033", "没有的寄存器 0x0033"),
            ("lvdt", &[0x03, 0, 0x70, 0, 1], 2, "has nothing at register 0x0070", "没有寄存器 0x0070"),
            (
                "lvdt",
                &[0x06, 0, 0x31, 0, 7],
                1,
                "Baud rate is written with function 10 (write multiple registers), not with 06.",
                "波特率的写功能码是 10（写多个寄存器），不是 06。",
            ),
            ("lvdt", &[0x06, 0, 0x31, 0, 7], 2, "Baud rate is written with function 10", "波特率的写功能码是 10"),
            (
                "lvdt",
                &[0x03, 0, 2, 0, 2],
                2,
                "Temperature is read with function 04 (read input registers), not with 03.",
                "温度的读功能码是 04（读输入寄存器），不是 03。",
            ),
            (
                "lvdt",
                &[0x10, 0, 4, 0, 1, 2, 0, 0],
                2,
                "Displacement can be read, but not written.",
                "位移只能读取，不能写入。",
            ),
            (
                "lvdt",
                &[0x10, 0, 0x31, 0, 1, 2, 0, 9],
                3,
                "Baud rate does not take 9. Allowed: 1 = 2400",
                "波特率不接受 9。允许值：1 = 2400",
            ),
            ("lvdt", &[0x07], 1, "knows only the functions 03, 04, 05, 10.", "只支持功能码 03、04、05、10。"),
            (
                "level",
                &[0x03, 0, 0, 0, 7],
                2,
                "does not promise that these can be read at once: Slave address, Baud rate",
                "请逐个读取",
            ),
            (
                "gauge-cable",
                &[0x10, 0x08, 0, 0, 1, 2, 0xAB, 0x56],
                1,
                "Zero is written with function 06",
                "清零的写功能码是 06",
            ),
        ];
        for (device, pdu, code, english, chinese) in cases {
            let [en, zh] = refused(device, pdu, code);
            assert!(en.contains(english), "{en}");
            assert!(zh.contains(chinese), "{zh}");
        }
    }

    #[test]
    fn an_exception_without_a_reason_in_the_profile_is_told_as_usual() {
        for code in [1, 2, 3, 4, 5, 6, 8, 10, 11, 77] {
            refused("lvdt", &[0x04, 0, 2, 0, 4], code);
            let frame = rtu::encode(UnitId(1), &[0x84, code]).unwrap();
            let case = Case { profile: None, frame: &frame, mode: Mode::Rtu, dissection: None, request: None };
            let told = LANGUAGES.map(|language| told(language, &case, &Diagnosis::Exception { code }));
            assert_whole(&told, &frame);
            assert_eq!(told[0].severity == Severity::Info, matches!(code, 5 | 6));
        }
    }

    /// Whatever a damaged stream gives can be told.
    #[test]
    fn every_diagnosis_of_a_damaged_stream_is_told() {
        let mut seen = Vec::new();
        for (frame, mode) in [(&READ[..], Mode::Rtu), (READ_ASCII, Mode::Ascii)] {
            for at in 0..frame.len() {
                for change in 0..4 {
                    let mut bytes = frame.to_vec();
                    match change {
                        0 => bytes[at] ^= 0x10,
                        1 => drop(bytes.remove(at)),
                        2 => bytes.insert(at, 0x55),
                        _ => bytes.truncate(at),
                    }
                    let segment = Segment { mode, line: 1, ..Segment::default() };
                    let mut transcript = Transcript::new();
                    transcript.push(&bytes, &[segment]);
                    transcript.finish();
                    for index in 0..transcript.entries().len() {
                        let reading = transcript.reading(index, Some(profile("lvdt")), &mut Known::default());
                        let frame = transcript.entry_bytes(index);
                        let dissection = reading.dissection.as_ref();
                        let case = Case { profile: Some(profile("lvdt")), frame, mode, dissection, request: None };
                        for diagnosis in &reading.diagnoses {
                            let told = LANGUAGES.map(|language| told(language, &case, diagnosis));
                            assert_whole(&told, frame);
                            seen.push(told[0].id);
                        }
                    }
                }
            }
        }
        seen.sort_unstable();
        seen.dedup();
        for id in ["ascii_not_hex", "bad_crc", "bad_lrc", "extra_byte", "missing_byte", "single_bit_error", "truncated"]
        {
            assert!(seen.contains(&id), "{id} of {seen:?}");
        }
    }
}
