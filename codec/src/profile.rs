//! Device profiles: everything that is particular to a device, as data. The built-in ones are read by the same loader as a
//! user's own file.
//!
//! A profile is a JSON file; `CONTRIBUTING.md` of the project tells its keys. [`Profile::from_json`] checks what can be
//! checked without the device, down to the worked examples.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::Deserialize;

use crate::line::{LineSettings, Mode};
use crate::pdu::{MAX_READ_QUANTITY, Request};
use crate::value::{Encoding, Value, ValueError};

/// The files of the built-in profiles.
pub const BUILT_IN: &[&str] = &[include_str!("../profiles/lvdt.json")];

/// The version of the format that this loader reads.
pub const FORMAT: u32 = 1;

/// A device, as data.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// [`FORMAT`].
    pub format: u32,
    /// Name for programs: lower-case letters, digits, `-`.
    pub id: String,
    /// Name for people.
    pub name: Texts,
    /// Where the facts come from.
    #[serde(default)]
    pub source: String,
    /// Factory settings of the line.
    pub line: LineSettings,
    /// Factory mode.
    pub mode: Mode,
    /// Factory unit id, or a usual one where each device has its own.
    pub unit: u8,
    /// Unit ids that the device takes.
    pub units: Range,
    /// How fast and how often.
    pub timing: Timing,
    /// Supply, as printed in its manual.
    #[serde(default)]
    pub supply: String,
    /// Its wires.
    #[serde(default)]
    pub wiring: Vec<Wire>,
    /// Everything that can be read or written, in the order of its registers.
    pub points: Vec<Point>,
    /// Registers that the device lets be read together.
    pub groups: Vec<Group>,
    /// Reads at the broadcast address that bring the unit id, best first.
    #[serde(default)]
    pub discovery: Vec<Group>,
    /// Worked examples: loading fails if one of them does not come out.
    #[serde(default)]
    pub examples: Vec<Example>,
}

/// A text in both languages.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Texts {
    /// English.
    pub en: String,
    /// Simplified Chinese.
    pub zh: String,
}

/// First and last of something, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// The smallest.
    pub first: u16,
    /// The largest.
    pub last: u16,
}

impl Range {
    /// Whether `value` lies in it.
    pub const fn contains(self, value: u16) -> bool {
        self.first <= value && value <= self.last
    }
}

/// Times and endurance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Timing {
    /// Deaf after power-on.
    #[serde(default)]
    pub startup_silence_ms: u32,
    /// How long it may think before it answers.
    pub response_timeout_ms: u32,
    /// Pause before another device is addressed.
    #[serde(default)]
    pub inter_device_pause_ms: u32,
    /// Usual time between two readings.
    pub poll_period_ms: u32,
    /// Shortest useful time between two readings.
    #[serde(default)]
    pub min_poll_period_ms: u32,
    /// Shortest time between two writes.
    #[serde(default)]
    pub min_write_period_ms: u32,
    /// How many writes its memory endures, 0 if unknown.
    #[serde(default)]
    pub flash_writes: u32,
}

/// One wire of its cable.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wire {
    /// Colour as a CSS colour name.
    pub color: String,
    /// Colour in words.
    pub name: Texts,
    /// Its terminal: `V+`, `A`.
    pub signal: String,
    /// What it is for.
    #[serde(rename = "use")]
    pub purpose: Texts,
}

/// Where registers live.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Table {
    /// Input registers: read by function 04.
    Input,
    /// Holding registers: read by function 03, written by 10.
    Holding,
    /// Coils: written by function 05.
    Coil,
}

/// What may be done with a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Access {
    /// Read only.
    Read,
    /// Write only.
    Write,
    /// Both.
    ReadWrite,
}

/// What a point is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// What the device is for.
    Measurement,
    /// A setting.
    Parameter,
    /// Something it does when written.
    Command,
}

/// What a write does to the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Effect {
    /// The unit id changes.
    Unit,
    /// The baud rate changes.
    Baud,
    /// The parity changes.
    Parity,
    /// RTU or ASCII changes.
    Mode,
    /// The device restarts and is deaf for [`Timing::startup_silence_ms`].
    Restart,
}

/// One datum or command of a device.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// Name for programs.
    pub id: String,
    /// Name for people.
    pub name: Texts,
    /// Where it lives.
    pub table: Table,
    /// Its first register or its coil.
    pub register: u16,
    /// How the registers hold it.
    pub encoding: Encoding,
    /// Its unit, empty for none.
    #[serde(default)]
    pub unit: String,
    /// What may be done with it.
    pub access: Access,
    /// What it is for.
    pub role: Role,
    /// The one value that matters most.
    #[serde(default)]
    pub primary: bool,
    /// Values that may be written.
    #[serde(default)]
    pub range: Option<Range>,
    /// Meanings of its codes.
    #[serde(default)]
    pub codes: Vec<Code>,
    /// Value that it leaves the factory with.
    #[serde(default)]
    pub factory: Option<u16>,
    /// A write can lose the device or its calibration.
    #[serde(default)]
    pub danger: bool,
    /// What a write does to the link.
    #[serde(default)]
    pub effect: Option<Effect>,
}

/// A code with its meaning: a number, a name, or both.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Code {
    /// As in the register.
    pub code: u16,
    /// The number that it stands for.
    #[serde(default)]
    pub number: Option<u32>,
    /// What it means.
    #[serde(default)]
    pub name: Option<Texts>,
}

/// Registers that are read together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// Where they live.
    pub table: Table,
    /// The first.
    pub address: u16,
    /// How many.
    pub quantity: u16,
}

/// Registers and the value that they hold.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Example {
    /// The point's id.
    pub point: String,
    /// As read.
    pub registers: Vec<u16>,
    /// The value as [`Point::text`] writes it.
    pub text: String,
}

/// A point found in registers that were read or written.
#[derive(Clone, Debug, PartialEq)]
pub struct PointValue<'a> {
    /// The point.
    pub point: &'a Point,
    /// Its place among the registers.
    pub offset: usize,
    /// Its value, or why there is none.
    pub value: Result<Value, ValueError>,
}

/// Why a text is no profile.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProfileError {
    /// Not JSON, or not of a profile's shape.
    #[error("line {line}, column {column}: {reason}")]
    Text {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// In English, from the JSON reader.
        reason: String,
    },
    /// Of a profile's shape, but contradicting itself or the standard.
    #[error("{path}: {reason}")]
    Content {
        /// The key at fault, such as `points[2].range`.
        path: String,
        /// In English.
        reason: String,
    },
}

impl Profile {
    /// Reads and checks a profile's file.
    pub fn from_json(text: &str) -> Result<Self, ProfileError> {
        let profile: Self = serde_json::from_str(text).map_err(|error| {
            let message = error.to_string();
            let reason = message.split(" at line ").next().unwrap_or_default().into();
            ProfileError::Text { line: error.line(), column: error.column(), reason }
        })?;
        profile.check()?;
        Ok(profile)
    }

    /// The point with this id.
    pub fn point(&self, id: &str) -> Option<&Point> {
        self.points.iter().find(|point| point.id == id)
    }

    /// What the device is for, the primary one first.
    pub fn measurements(&self) -> Vec<&Point> {
        let mut points: Vec<&Point> = self.points.iter().filter(|point| point.role == Role::Measurement).collect();
        points.sort_by_key(|point| !point.primary);
        points
    }

    /// The groups that bring the measurements.
    pub fn live_groups(&self) -> Vec<Group> {
        let measured = |group: &Group| {
            self.points.iter().any(|point| point.role == Role::Measurement && group.offset_of(point).is_some())
        };
        self.groups.iter().copied().filter(measured).collect()
    }

    /// The points in registers that a function read or wrote from `address` on.
    pub fn decode_points<'a>(&'a self, function: u8, address: u16, registers: &[u16]) -> Vec<PointValue<'a>> {
        let table = match function {
            0x04 => Table::Input,
            0x03 | 0x06 | 0x10 => Table::Holding,
            0x05 => Table::Coil,
            _ => return Vec::new(),
        };
        let quantity = u16::try_from(registers.len()).unwrap_or(u16::MAX);
        let group = Group { table, address, quantity };
        let found = self.points.iter().filter_map(|point| {
            let offset = group.offset_of(point)?;
            let value = point.encoding.decode(&registers[offset..offset + point.encoding.registers()]);
            Some(PointValue { point, offset, value })
        });
        found.collect()
    }

    fn check(&self) -> Result<(), ProfileError> {
        let fail = |path: String, reason: &str| Err(ProfileError::Content { path, reason: reason.into() });
        if self.format != FORMAT {
            return fail("format".into(), "this version reads format 1");
        }
        let plain = |id: &str| {
            !id.is_empty() && id.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-' || b == b'_')
        };
        if !plain(&self.id) {
            return fail("id".into(), "use lower-case letters, digits, - and _");
        }
        if self.line.baud == 0 {
            return fail("line.baud".into(), "must not be 0");
        }
        if self.units.first > self.units.last || self.units.last > 255 {
            return fail("units".into(), "must lie within 0 and 255");
        }
        if self.timing.poll_period_ms == 0 {
            return fail("timing.poll_period_ms".into(), "must not be 0");
        }
        for (index, point) in self.points.iter().enumerate() {
            let path = |key: &str| format!("points[{index}].{key}");
            if !plain(&point.id) {
                return fail(path("id"), "use lower-case letters, digits, - and _");
            }
            if self.points[..index].iter().any(|earlier| earlier.id == point.id) {
                return fail(path("id"), "another point has this id");
            }
            if usize::from(point.register) + point.encoding.registers() > 0x1_0000 {
                return fail(path("register"), "runs over the last register");
            }
            if point.range.is_some_and(|range| range.first > range.last) {
                return fail(path("range"), "first is larger than last");
            }
            let twice = |(at, code): (usize, &Code)| point.codes[..at].iter().any(|earlier| earlier.code == code.code);
            if point.codes.iter().enumerate().any(twice) {
                return fail(path("codes"), "a code stands twice");
            }
            let readable = point.access != Access::Write;
            if point.role == Role::Measurement && readable && !self.groups.iter().any(|g| g.offset_of(point).is_some())
            {
                return fail(path("register"), "no group reads this measurement");
            }
        }
        for (index, group) in self.groups.iter().chain(&self.discovery).enumerate() {
            if group.request().is_none() {
                return fail(format!("groups[{index}]"), "must be 1 to 125 input or holding registers");
            }
        }
        for (index, example) in self.examples.iter().enumerate() {
            let path = format!("examples[{index}]");
            let Some(point) = self.point(&example.point) else {
                return fail(path, "there is no such point");
            };
            let text = point.encoding.decode(&example.registers).map(|value| point.text(value, |name| &name.en));
            if text.as_deref() != Ok(&example.text) {
                let reason = format!("{:?} is {text:?}", example.registers);
                return fail(path, &reason);
            }
        }
        Ok(())
    }
}

impl Group {
    /// The request that reads it; `None` for coils and for quantities beyond the standard.
    pub fn request(&self) -> Option<Request> {
        let Self { table, address, quantity } = *self;
        if !(1..=MAX_READ_QUANTITY).contains(&quantity) || usize::from(address) + usize::from(quantity) > 0x1_0000 {
            return None;
        }
        match table {
            Table::Input => Some(Request::ReadInputRegisters { address, quantity }),
            Table::Holding => Some(Request::ReadHoldingRegisters { address, quantity }),
            Table::Coil => None,
        }
    }

    /// Where in this group a point lies, if all of it does.
    pub fn offset_of(&self, point: &Point) -> Option<usize> {
        let offset = usize::from(point.register.checked_sub(self.address)?);
        let fits = offset + point.encoding.registers() <= usize::from(self.quantity);
        (point.table == self.table && fits).then_some(offset)
    }
}

impl Point {
    /// The value as text, without unit: a number, the number or name of a code, or the code itself if it is unknown.
    pub fn text<'a>(&'a self, value: Value, language: impl Fn(&'a Texts) -> &'a String) -> String {
        let Value::Code(code) = value else { return value.to_string() };
        match self.codes.iter().find(|known| known.code == code) {
            Some(Code { number: Some(number), .. }) => number.to_string(),
            Some(Code { name: Some(name), .. }) => language(name).clone(),
            _ => code.to_string(),
        }
    }

    /// Whether the table of codes or the range knows `raw`.
    pub fn allows(&self, raw: u16) -> bool {
        let known = self.codes.is_empty() || self.codes.iter().any(|code| code.code == raw);
        known && self.range.is_none_or(|range| range.contains(raw))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lvdt() -> Profile {
        Profile::from_json(BUILT_IN[0]).unwrap()
    }

    #[test]
    fn every_built_in_profile_loads_and_its_examples_come_out() {
        for text in BUILT_IN {
            let profile = Profile::from_json(text).unwrap();
            assert!(!profile.live_groups().is_empty(), "{}", profile.id);
            assert!(!profile.examples.is_empty(), "{}", profile.id);
        }
    }

    #[test]
    fn one_group_brings_both_measurements() {
        let profile = lvdt();
        let groups = profile.live_groups();
        assert_eq!(groups.len(), 1);
        let points = profile.decode_points(4, groups[0].address, &[0, 285, 0x8000, 0x0148]);
        let texts: Vec<_> = points.iter().map(|p| (p.point.id.as_str(), p.value.unwrap().to_string())).collect();
        assert_eq!(texts, [("temperature", "28.5".to_string()), ("displacement", "-0.328".to_string())]);
        assert_eq!(profile.measurements()[0].id, "displacement");
    }

    #[test]
    fn unknown_codes_stay_what_they_are() {
        let profile = lvdt();
        let baud = profile.point("baud").unwrap();
        assert_eq!(baud.text(Value::Code(9), |name| &name.en), "9");
        assert!(!baud.allows(9) && baud.allows(7));
        assert!(!profile.point("address").unwrap().allows(248));
    }

    #[test]
    fn a_wrong_text_is_placed_by_line_and_column() {
        let text = BUILT_IN[0].replace("\"mode\": \"rtu\"", "\"mode\": \"rtx\"");
        let Err(ProfileError::Text { line, reason, .. }) = Profile::from_json(&text) else { panic!("accepted") };
        assert_eq!(line, 7);
        assert!(reason.contains("rtx"), "{reason}");
    }

    #[test]
    fn contradictions_are_named_by_their_key() {
        let wrong = [
            ("\"format\": 1", "\"format\": 2", "format"),
            ("\"id\": \"displacement\"", "\"id\": \"temperature\"", "points[1].id"),
            ("\"quantity\": 4", "\"quantity\": 126", "groups[0]"),
            ("\"address\": 2, \"quantity\": 4", "\"address\": 3, \"quantity\": 3", "points[0].register"),
            ("[32768, 328], \"text\": \"-0.328\"", "[32768, 328], \"text\": \"0.328\"", "examples[2]"),
            ("\"first\": 1, \"last\": 247 },\n  \"timing\"", "\"first\": 1, \"last\": 256 },\n  \"timing\"", "units"),
        ];
        for (from, to, expected) in wrong {
            assert!(BUILT_IN[0].contains(from), "{from}");
            match Profile::from_json(&BUILT_IN[0].replacen(from, to, 1)) {
                Err(ProfileError::Content { path, .. }) => assert_eq!(path, expected),
                other => panic!("{from}: {other:?}"),
            }
        }
    }
}
