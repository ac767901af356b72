//! A snapshot as a file that people read, too. `docs/snapshots.md` of the project tells its keys. The reader is strict: what
//! it does not know it refuses, with line and column.

use std::borrow::Cow;
use std::fmt::Write as _;

use buslens_codec::UnitId;
use buslens_codec::json::string;
use buslens_codec::line::{DataBits, LineSettings, Mode, Parity, StopBits};
use buslens_codec::profile::Profile;
use nojson::{JsonParseError, RawJson, RawJsonValue};
use serde::{Deserialize, Serialize};

use super::{Datum, Read, Snapshot};
use crate::Reach;

/// The version of the format.
const FORMAT: u64 = 1;
/// What the key `kind` says.
const KIND: &str = "buslens-snapshot";
/// No snapshot is longer, in bytes.
const LONGEST: usize = 1 << 20;
/// Objects and lists within each other: a snapshot has four.
const DEEPEST: usize = 16;
/// A point has no more registers.
const MOST_REGISTERS: usize = 16;
/// The last moment of the year 9999, in milliseconds since the Unix epoch.
const LAST_MS: u64 = 253_402_300_799_999;

const PARITIES: [(&str, Parity); 3] = [("none", Parity::None), ("odd", Parity::Odd), ("even", Parity::Even)];
const DATA_BITS: [(&str, DataBits); 2] = [("seven", DataBits::Seven), ("eight", DataBits::Eight)];
const STOP_BITS: [(&str, StopBits); 2] = [("one", StopBits::One), ("two", StopBits::Two)];
const MODES: [(&str, Mode); 2] = [("rtu", Mode::Rtu), ("ascii", Mode::Ascii)];

/// Why a text is no snapshot, and where.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileFault {
    /// Counted from 1.
    pub line: u32,
    /// In characters, counted from 1.
    pub column: u32,
    /// Why.
    pub reason: FileReason,
}

/// Why a text is no snapshot.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FileReason {
    /// It is longer than so many bytes, or nested deeper than any snapshot.
    TooLarge,
    /// It ends too early.
    EndsEarly,
    /// Something follows its end.
    Trailing,
    /// It is not JSON.
    NotJson,
    /// Braces are needed here: an object.
    NotAnObject,
    /// Brackets are needed here: a list.
    NotAList,
    /// A text in quotes is needed here.
    NotAText,
    /// A whole number from `first` to `last` is needed here.
    NotANumber {
        /// The least.
        first: u64,
        /// The most.
        last: u64,
    },
    /// The format knows no such key; these it knows.
    UnknownKey {
        /// As it stands there.
        key: String,
        /// What could stand there.
        known: Vec<String>,
    },
    /// The key stands twice.
    KeyTwice(String),
    /// The key is missing.
    MissingKey(String),
    /// One of these is needed here.
    NoneOf(Vec<String>),
    /// The file is of this version, which this program does not read.
    OtherFormat(u64),
    /// It is another kind of file.
    OtherKind,
    /// A time as 2026-05-04T03:02:01.000Z is needed here, in the years 1970 to 9999.
    NotATime,
    /// Registers as "0x0007" are needed here, 1 to 16 of them.
    NotRegisters,
    /// Exactly one of `registers`, `exception` and `silent` is needed here.
    NotOneResult,
    /// The point stands twice.
    PointTwice(String),
}

impl Snapshot {
    /// The text of its file. Values and units are written beside the registers, in English, for people only.
    pub fn to_json(&self, profile: &Profile) -> String {
        let mut out = String::new();
        let LineSettings { baud, data_bits, parity, stop_bits } = self.reach.line;
        out.push_str("{\n  \"format\": 1,\n  \"kind\": ");
        string(&mut out, KIND);
        for (key, text) in [("profile", &self.profile), ("name", &self.name)] {
            let _ = write!(out, ",\n  \"{key}\": ");
            string(&mut out, text);
        }
        let _ = write!(out, ",\n  \"taken\": \"{}\"", time_text(self.taken_unix_ms));
        let _ = write!(
            out,
            ",\n  \"reach\": {{ \"unit\": {}, \"baud\": {baud}, \"data_bits\": \"{}\", \"parity\": \"{}\", \
             \"stop_bits\": \"{}\", \"mode\": \"{}\" }},\n  \"data\": [",
            self.reach.unit,
            name_of(data_bits, &DATA_BITS),
            name_of(parity, &PARITIES),
            name_of(stop_bits, &STOP_BITS),
            name_of(self.reach.mode, &MODES),
        );
        let shown = self.values(profile, |texts| &texts.en);
        for (at, datum) in self.data.iter().enumerate() {
            out.push_str(if at == 0 { "\n    { \"point\": " } else { ",\n    { \"point\": " });
            string(&mut out, &datum.point);
            match &datum.read {
                Read::Registers(registers) => {
                    let words: Vec<String> = registers.iter().map(|word| format!("\"0x{word:04X}\"")).collect();
                    let _ = write!(out, ", \"registers\": [{}]", words.join(", "));
                }
                Read::Refused(code) => {
                    let _ = write!(out, ", \"exception\": {code}");
                }
                Read::NoAnswer => out.push_str(", \"silent\": true"),
            }
            if let Some(shown) = shown.iter().find(|shown| shown.point == datum.point)
                && let Some(text) = &shown.text
            {
                out.push_str(", \"value\": ");
                string(&mut out, text);
                if !shown.unit.is_empty() {
                    out.push_str(", \"unit\": ");
                    string(&mut out, &shown.unit);
                }
            }
            out.push_str(" }");
        }
        out.push_str(if self.data.is_empty() { "]\n}\n" } else { "\n  ]\n}\n" });
        out
    }

    /// Reads the text of a file. What it says for people only is not looked at but must be well formed.
    pub fn from_json(text: &str) -> Result<Self, FileFault> {
        if text.len() > LONGEST || is_deep(text) {
            return Err(place(text, Fault { position: 0, reason: FileReason::TooLarge }));
        }
        let json = RawJson::parse(text).map_err(|error| place(text, syntax_fault(&error)))?;
        snapshot(json.value()).map_err(|fault| place(text, fault))
    }
}

type Node<'a> = RawJsonValue<'a, 'a>;

/// Something wrong at a byte of the text.
struct Fault {
    position: usize,
    reason: FileReason,
}

type Found<T> = Result<T, Fault>;

fn snapshot(node: Node<'_>) -> Found<Snapshot> {
    let object = Object::of(node, &["format", "kind", "profile", "name", "taken", "reach", "data"])?;
    let kind = object.need("kind")?;
    if text(kind)? != KIND {
        return fault(kind, FileReason::OtherKind);
    }
    let format = object.need("format")?;
    let version = number(format, 0, u64::MAX)?;
    if version != FORMAT {
        return fault(format, FileReason::OtherFormat(version));
    }
    let taken = object.need("taken")?;
    let Some(taken_unix_ms) = time(&text(taken)?) else { return fault(taken, FileReason::NotATime) };
    let mut data: Vec<Datum> = Vec::new();
    for item in items(object.need("data")?)? {
        let datum = datum(item)?;
        if data.iter().any(|earlier| earlier.point == datum.point) {
            return fault(item, FileReason::PointTwice(datum.point));
        }
        data.push(datum);
    }
    Ok(Snapshot {
        profile: text(object.need("profile")?)?.into_owned(),
        name: object.find("name").map_or_else(|| Ok(String::new()), |node| text(node).map(Cow::into_owned))?,
        taken_unix_ms,
        reach: reach(object.need("reach")?)?,
        data,
    })
}

fn reach(node: Node<'_>) -> Found<Reach> {
    let object = Object::of(node, &["unit", "baud", "data_bits", "parity", "stop_bits", "mode"])?;
    let small = |node, last| number(node, 0, last).map(|number| u8::try_from(number).unwrap_or(u8::MAX));
    let baud = number(object.need("baud")?, 1, 100_000_000)?;
    Ok(Reach {
        unit: UnitId(small(object.need("unit")?, u8::MAX.into())?),
        line: LineSettings {
            baud: u32::try_from(baud).unwrap_or(u32::MAX),
            data_bits: choice(object.need("data_bits")?, &DATA_BITS)?,
            parity: choice(object.need("parity")?, &PARITIES)?,
            stop_bits: choice(object.need("stop_bits")?, &STOP_BITS)?,
        },
        mode: choice(object.need("mode")?, &MODES)?,
    })
}

fn datum(node: Node<'_>) -> Found<Datum> {
    let object = Object::of(node, &["point", "registers", "exception", "silent", "value", "unit"])?;
    for key in ["value", "unit"] {
        object.find(key).map_or(Ok(()), |node| text(node).map(|_| ()))?;
    }
    let read = match (object.find("registers"), object.find("exception"), object.find("silent")) {
        (Some(node), None, None) => Read::Registers(registers(node)?),
        (None, Some(node), None) => {
            let code = number(node, 1, u8::MAX.into())?;
            Read::Refused(u8::try_from(code).unwrap_or(u8::MAX))
        }
        (None, None, Some(node)) if node.as_raw_str() == "true" => Read::NoAnswer,
        _ => return fault(node, FileReason::NotOneResult),
    };
    Ok(Datum { point: text(object.need("point")?)?.into_owned(), read })
}

fn registers(node: Node<'_>) -> Found<Vec<u16>> {
    let nodes = items(node)?;
    if nodes.is_empty() || nodes.len() > MOST_REGISTERS {
        return fault(node, FileReason::NotRegisters);
    }
    let register = |node: Node<'_>| {
        let text = text(node)?;
        let digits = text.strip_prefix("0x").filter(|digits| digits.len() == 4);
        let digits = digits.filter(|digits| digits.bytes().all(|byte| byte.is_ascii_hexdigit()));
        let word = digits.and_then(|digits| u16::from_str_radix(digits, 16).ok());
        word.map_or_else(|| fault(node, FileReason::NotRegisters), Ok)
    };
    nodes.into_iter().map(register).collect()
}

/// An object whose keys are all known.
struct Object<'a> {
    node: Node<'a>,
    members: Vec<(Cow<'a, str>, Node<'a>)>,
}

impl<'a> Object<'a> {
    fn of(node: Node<'a>, known: &[&str]) -> Found<Self> {
        let Ok(pairs) = node.to_object() else { return fault(node, FileReason::NotAnObject) };
        let mut members: Vec<(Cow<'a, str>, Node<'a>)> = Vec::new();
        for (key, value) in pairs {
            let name = text(key)?;
            if !known.contains(&&*name) {
                let known = known.iter().map(ToString::to_string).collect();
                return fault(key, FileReason::UnknownKey { key: name.into_owned(), known });
            }
            if members.iter().any(|(earlier, _)| *earlier == name) {
                return fault(key, FileReason::KeyTwice(name.into_owned()));
            }
            members.push((name, value));
        }
        Ok(Self { node, members })
    }

    fn find(&self, key: &str) -> Option<Node<'a>> {
        self.members.iter().find(|(name, _)| name == key).map(|(_, node)| *node)
    }

    fn need(&self, key: &str) -> Found<Node<'a>> {
        self.find(key).map_or_else(|| fault(self.node, FileReason::MissingKey(key.to_owned())), Ok)
    }
}

fn items(node: Node<'_>) -> Found<Vec<Node<'_>>> {
    node.to_array().map_or_else(|_| fault(node, FileReason::NotAList), |items| Ok(items.collect()))
}

fn text(node: Node<'_>) -> Found<Cow<'_, str>> {
    node.to_unquoted_string_str().map_or_else(|_| fault(node, FileReason::NotAText), Ok)
}

fn number(node: Node<'_>, first: u64, last: u64) -> Found<u64> {
    let number = node.as_integer_str().ok().and_then(|digits| digits.parse().ok());
    let number = number.filter(|number| (first..=last).contains(number));
    number.map_or_else(|| fault(node, FileReason::NotANumber { first, last }), Ok)
}

fn choice<T: Copy>(node: Node<'_>, all: &[(&str, T)]) -> Found<T> {
    let name = text(node)?;
    let found = all.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
    found.map_or_else(|| fault(node, FileReason::NoneOf(all.iter().map(|(name, _)| (*name).to_owned()).collect())), Ok)
}

fn name_of<T: Copy + PartialEq>(value: T, all: &[(&'static str, T)]) -> &'static str {
    all.iter().find(|(_, known)| *known == value).map_or("", |(name, _)| name)
}

fn fault<T>(node: Node<'_>, reason: FileReason) -> Found<T> {
    Err(Fault { position: node.position(), reason })
}

fn syntax_fault(error: &JsonParseError) -> Fault {
    let reason = match error {
        JsonParseError::UnexpectedEos { .. } => FileReason::EndsEarly,
        JsonParseError::UnexpectedTrailingChar { .. } => FileReason::Trailing,
        JsonParseError::UnexpectedValueChar { .. } | JsonParseError::InvalidValue { .. } => FileReason::NotJson,
    };
    Fault { position: error.position(), reason }
}

fn place(text: &str, fault: Fault) -> FileFault {
    let before = text.get(..fault.position).unwrap_or(text);
    let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    let line = count(before.matches('\n').count() + 1);
    let column = count(before.rsplit('\n').next().unwrap_or_default().chars().count() + 1);
    FileFault { line, column, reason: fault.reason }
}

/// Whether objects and lists stand within each other deeper than in any snapshot: a parser goes as deep as they do.
fn is_deep(text: &str) -> bool {
    let (mut depth, mut quoted, mut escaped) = (0_usize, false, false);
    for byte in text.bytes() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if quoted => escaped = true,
            b'"' => quoted = !quoted,
            b'{' | b'[' if !quoted => depth += 1,
            b'}' | b']' if !quoted => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > DEEPEST {
            return true;
        }
    }
    false
}

/// `2026-05-04T03:02:01.000Z`.
fn time_text(unix_ms: u64) -> String {
    let unix_ms = unix_ms.min(LAST_MS);
    let (days, ms) = (unix_ms / 86_400_000, unix_ms % 86_400_000);
    // Years begin with March, so that a leap day is the last of its year (Howard Hinnant, chrono-compatible low-level date
    // algorithms, civil_from_days).
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (ms / 3_600_000, ms / 60_000 % 60, ms / 1000 % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{:03}Z", ms % 1000)
}

/// Milliseconds since the Unix epoch of such a text; `None` for any other.
fn time(text: &str) -> Option<u64> {
    let part = |from: usize, to: usize| {
        let digits = text.get(from..to).filter(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()))?;
        digits.parse::<u64>().ok()
    };
    let (year, month, day) = (part(0, 4)?, part(5, 7)?, part(8, 10)?);
    let (hour, minute, second, ms) = (part(11, 13)?, part(14, 16)?, part(17, 19)?, part(20, 23)?);
    if year < 1970 || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    let year_from_march = year - u64::from(month <= 2);
    let (era, year_of_era) = (year_from_march / 400, year_from_march % 400);
    let day_of_year = (153 * (if month > 2 { month - 3 } else { month + 9 }) + 2) / 5 + day - 1;
    let days = era * 146_097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
    let days = days.checked_sub(719_468)?;
    let unix_ms = days * 86_400_000 + hour * 3_600_000 + minute * 60_000 + second * 1000 + ms;
    // Marks between the parts, and days and hours that there are not, show when it is written back.
    (time_text(unix_ms) == text).then_some(unix_ms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_they_are_written() {
        for (unix_ms, written) in [
            (0, "1970-01-01T00:00:00.000Z"),
            (951_782_400_123, "2000-02-29T00:00:00.123Z"),
            (1_777_863_721_000, "2026-05-04T03:02:01.000Z"),
            (LAST_MS, "9999-12-31T23:59:59.999Z"),
        ] {
            assert_eq!(time_text(unix_ms), written);
            assert_eq!(time(written), Some(unix_ms));
        }
        for wrong in
            ["", "2026-05-04", "2026-02-29T00:00:00.000Z", "2026-05-04T24:00:00.000Z", "2026-05-04 03:02:01.000Z"]
        {
            assert_eq!(time(wrong), None, "{wrong}");
        }
    }
}
