//! A transcript as JSON Lines: one object for each entry, with stable keys in a stable order.
//!
//! Numbers are exact: a decimal is written with the digits that its device sends. Written by hand, because the shape is
//! small and fixed and a page pays for every byte of code.

use alloc::collections::BTreeMap;
use alloc::string::String;
use core::fmt::Write as _;

use crate::UnitId;
use crate::diagnose::{Diagnosis, Placed};
use crate::dissect::{Check, Direction, Dissection, NamedValue};
use crate::line::Mode;
use crate::pdu::ExceptionCode;
use crate::profile::{Code, Known, Profile};
use crate::transcript::{Entry, EntryKind, Transcript};
use crate::value::Value;

/// Writes a transcript's entries one after the other.
pub struct Lines<'a> {
    transcript: &'a Transcript,
    profile: Option<&'a Profile>,
    next: usize,
    /// What each unit has told so far of scales and units.
    known: BTreeMap<UnitId, Known>,
}

impl<'a> Lines<'a> {
    /// At the first entry. Values are named by `profile`.
    pub fn new(transcript: &'a Transcript, profile: Option<&'a Profile>) -> Self {
        Self { transcript, profile, next: transcript.first(), known: BTreeMap::new() }
    }

    /// Tells what forgotten entries told of a unit.
    pub fn tell(&mut self, unit: UnitId, known: Known) {
        self.known.insert(unit, known);
    }

    /// Writes the next entry as an object, with a line feed behind it; `false` behind the last one.
    pub fn write_next(&mut self, out: &mut String) -> bool {
        let index = self.next;
        self.next += 1;
        let header = self.transcript.header(index);
        let mut unread = Known::default();
        let known = match (self.profile, header) {
            (Some(_), Some((unit, _))) => self.known.entry(unit).or_default(),
            _ => &mut unread,
        };
        let written = write_entry(out, self.transcript, self.profile, index, known);
        if written {
            out.push('\n');
        }
        written
    }
}

/// Writes an entry as an object; `false` behind the last one. `known` is what earlier frames of its unit told.
pub fn write_entry(
    out: &mut String,
    transcript: &Transcript,
    profile: Option<&Profile>,
    index: usize,
    known: &mut Known,
) -> bool {
    let Some(entry) = transcript.entry(index) else { return false };
    let bytes = transcript.entry_bytes(index);
    let reading = transcript.reading(index, profile, known);
    out.push_str("{\"kind\":");
    string(out, if entry.kind == EntryKind::Frame { "frame" } else { "noise" });
    number(out, "index", index);
    key(out, "offset");
    plain(out, entry.offset);
    match entry.kind {
        EntryKind::Noise => self::bytes(out, "bytes", bytes),
        EntryKind::Frame => {
            frame(out, (bytes, transcript.header(index)), &entry, reading.dissection.as_ref(), profile);
        }
    }
    key(out, "diagnoses");
    list(out, &reading.diagnoses, write_diagnosis);
    out.push('}');
    true
}

/// Writes a diagnosis as an object: its id and its details.
pub fn write_diagnosis(out: &mut String, diagnosis: &Diagnosis) {
    out.push_str("{\"id\":");
    string(out, diagnosis.id());
    match diagnosis {
        Diagnosis::SingleBitError { byte, bit, repaired } => {
            number(out, "byte", *byte);
            number(out, "bit", usize::from(*bit));
            bytes(out, "repaired", repaired);
        }
        Diagnosis::SwappedCrc { repaired } => bytes(out, "repaired", repaired),
        Diagnosis::MissingByte { repair } | Diagnosis::ExtraByte { repair } => {
            if let Some(Placed { at, repaired }) = repair {
                number(out, "at", *at);
                bytes(out, "repaired", repaired);
            }
        }
        Diagnosis::BadCrc { expected } => bytes(out, "expected", expected),
        Diagnosis::BadLrc { expected } => bytes(out, "expected", &[*expected]),
        Diagnosis::AsciiNotHex { at } => number(out, "at", *at),
        Diagnosis::Truncated { expected: Some(expected) } => number(out, "expected", *expected),
        Diagnosis::ByteCountMismatch { found, expected } => {
            number(out, "found", usize::from(*found));
            number(out, "expected", *expected);
        }
        Diagnosis::Exception { code } => number(out, "code", usize::from(*code)),
        Diagnosis::UnitReserved { unit } => number(out, "unit", usize::from(*unit)),
        Diagnosis::ValueOutOfRange { point } => {
            key(out, "point");
            string(out, point);
        }
        Diagnosis::ManualErratum { number: erratum } => number(out, "erratum", *erratum),
        Diagnosis::LrcInRtu | Diagnosis::CrcInAscii | Diagnosis::Truncated { expected: None } | Diagnosis::Echo => {}
    }
    out.push('}');
}

fn frame(
    out: &mut String,
    (frame, header): (&[u8], Option<(UnitId, u8)>),
    entry: &Entry,
    dissection: Option<&Dissection>,
    profile: Option<&Profile>,
) {
    key(out, "mode");
    string(out, if entry.mode == Mode::Rtu { "rtu" } else { "ascii" });
    key(out, "direction");
    let direction = match entry.direction {
        Direction::Request => "request",
        Direction::Response => "response",
        Direction::Unknown => "unknown",
    };
    string(out, direction);
    key(out, "unit");
    optional(out, header.map(|(unit, _)| unit));
    key(out, "function");
    optional(out, header.map(|(_, function)| function));
    key(out, "bytes");
    // Characters that spell no bytes are shown as they are.
    match crate::ascii::decode_body(frame).ok().filter(|_| entry.mode == Mode::Ascii) {
        Some(body) => hex(out, &body),
        None => hex(out, frame),
    }
    check(out, entry.mode, dissection);
    key(out, "exception");
    optional(out, dissection.and_then(|found| found.exception).map(ExceptionCode::code));
    key(out, "pair");
    optional(out, entry.pair);
    key(out, "address");
    optional(out, dissection.and_then(|found| found.address));
    key(out, "quantity");
    optional(out, dissection.and_then(|found| found.quantity));
    key(out, "registers");
    match dissection.map(|found| found.registers.as_slice()) {
        Some(registers @ [_, ..]) => list(out, registers, |out, register| plain(out, *register)),
        _ => out.push_str("null"),
    }
    key(out, "bits");
    match dissection.map(|found| found.bits.as_slice()) {
        Some(bits @ [_, ..]) => list(out, bits, |out, bit| plain(out, *bit)),
        _ => out.push_str("null"),
    }
    key(out, "points");
    let points = dissection.map(|found| found.points.as_slice()).unwrap_or_default();
    list(out, points, |out, point| named(out, point, profile));
}

fn check(out: &mut String, mode: Mode, dissection: Option<&Dissection>) {
    key(out, "check");
    out.push_str("{\"kind\":");
    string(out, if mode == Mode::Rtu { "crc16" } else { "lrc" });
    match dissection.map(|found| found.check) {
        Some(Check::Crc16 { found, expected }) => {
            bytes(out, "found", &found.to_le_bytes());
            bytes(out, "expected", &expected.to_le_bytes());
        }
        Some(Check::Lrc { found, expected }) => {
            bytes(out, "found", &[found]);
            bytes(out, "expected", &[expected]);
        }
        None => out.push_str(",\"found\":null,\"expected\":null"),
    }
    key(out, "ok");
    out.push_str(if dissection.is_some_and(|found| found.check.is_ok()) { "true" } else { "false" });
    out.push('}');
}

fn named(out: &mut String, named: &NamedValue, profile: Option<&Profile>) {
    let point = profile.and_then(|profile| profile.point(&named.point));
    out.push_str("{\"register\":");
    plain(out, named.register);
    key(out, "id");
    string(out, &named.point);
    key(out, "raw");
    list(out, &named.raw, |out, register| plain(out, *register));
    let text = match (named.value, point) {
        (Ok(value), Some(point)) => point.text(value, |texts| &texts.en),
        _ => String::new(),
    };
    key(out, "value");
    match named.value {
        Ok(Value::Number(decimal)) => plain(out, decimal),
        Ok(value @ (Value::Float(_) | Value::Double(_))) if value.to_f64().is_some_and(f64::is_finite) => {
            plain(out, value);
        }
        Ok(Value::Float(_) | Value::Double(_)) | Err(_) => out.push_str("null"),
        Ok(Value::Text(_)) => string(out, &text),
        Ok(Value::Code(code)) => match point.and_then(|point| point.code(code)) {
            Some(Code { number: Some(number), .. }) => plain(out, number),
            Some(Code { name: Some(name), .. }) => string(out, &name.en),
            _ => plain(out, code),
        },
    }
    key(out, "text");
    string(out, &text);
    key(out, "unit");
    if named.unit.is_empty() {
        out.push_str("null");
    } else {
        string(out, &named.unit);
    }
    if !named.scaled {
        out.push_str(",\"scaled\":false");
    }
    out.push('}');
}

fn key(out: &mut String, name: &str) {
    out.push_str(",\"");
    out.push_str(name);
    out.push_str("\":");
}

fn number(out: &mut String, name: &str, value: usize) {
    key(out, name);
    plain(out, value);
}

fn bytes(out: &mut String, name: &str, value: &[u8]) {
    key(out, name);
    hex(out, value);
}

/// A number as it prints.
fn plain(out: &mut String, value: impl core::fmt::Display) {
    // Writing into a string cannot fail.
    let _ = write!(out, "{value}");
}

fn optional(out: &mut String, value: Option<impl core::fmt::Display>) {
    match value {
        Some(value) => plain(out, value),
        None => out.push_str("null"),
    }
}

fn list<T>(out: &mut String, items: &[T], mut write: impl FnMut(&mut String, &T)) {
    out.push('[');
    for (at, item) in items.iter().enumerate() {
        if at > 0 {
            out.push(',');
        }
        write(out, item);
    }
    out.push(']');
}

fn hex(out: &mut String, bytes: &[u8]) {
    const DIGITS: &[u8; 16] = b"0123456789ABCDEF";
    out.push('"');
    for byte in bytes {
        out.push(char::from(DIGITS[usize::from(byte >> 4)]));
        out.push(char::from(DIGITS[usize::from(byte & 15)]));
    }
    out.push('"');
}

/// Writes a text as JSON does: between quotes, escaped where it must be.
pub fn string(out: &mut String, text: &str) {
    out.push('"');
    for character in text.chars() {
        match character {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\u{0}'..='\u{1F}' => {
                let _ = write!(out, "\\u{:04x}", u32::from(character));
            }
            other => out.push(other),
        }
    }
    out.push('"');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_are_escaped() {
        let mut out = String::new();
        string(&mut out, "a\"b\\c\nd\u{1}°位");
        assert_eq!(out, "\"a\\\"b\\\\c\\nd\\u0001°位\"");
    }
}
