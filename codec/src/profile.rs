//! Device profiles: everything that is particular to a device, as data. The built-in ones are read by the same loader as a
//! user's own file.
//!
//! A profile is a JSON file; `CONTRIBUTING.md` of the project tells its keys. [`Profile::from_json`] checks what can be
//! checked without the device, down to the worked examples.

mod load;

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use crate::line::{LineSettings, Mode};
use crate::pdu::{MAX_READ_QUANTITY, Request};
use crate::value::{Encoding, Value, ValueError};

/// The files of the built-in profiles.
pub const BUILT_IN: &[&str] = &[include_str!("../profiles/lvdt.json")];

/// The version of the format that this loader reads.
pub const FORMAT: u32 = 1;

/// A device, as data.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// [`FORMAT`].
    pub format: u32,
    /// Name for programs: lower-case letters, digits, `-`.
    pub id: String,
    /// Name for people.
    pub name: Texts,
    /// Where the facts come from.
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
    pub supply: String,
    /// Its wires.
    pub wiring: Vec<Wire>,
    /// Everything that can be read or written, in the order of its registers.
    pub points: Vec<Point>,
    /// Registers that the device lets be read together.
    pub groups: Vec<Group>,
    /// Reads at the broadcast address that bring the unit id, best first.
    pub discovery: Vec<Group>,
    /// Worked examples: loading fails if one of them does not come out.
    pub examples: Vec<Example>,
}

/// A text in both languages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Texts {
    /// English.
    pub en: String,
    /// Simplified Chinese.
    pub zh: String,
}

/// First and last of something, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Deaf after power-on.
    pub startup_silence_ms: u32,
    /// How long it may think before it answers.
    pub response_timeout_ms: u32,
    /// Pause before another device is addressed.
    pub inter_device_pause_ms: u32,
    /// Usual time between two readings.
    pub poll_period_ms: u32,
    /// Shortest useful time between two readings.
    pub min_poll_period_ms: u32,
    /// Shortest time between two writes.
    pub min_write_period_ms: u32,
    /// How many writes its memory endures, 0 if unknown.
    pub flash_writes: u32,
}

/// One wire of its cable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wire {
    /// Colour as a CSS colour name.
    pub color: String,
    /// Colour in words.
    pub name: Texts,
    /// Its terminal: `V+`, `A`.
    pub signal: String,
    /// What it is for.
    pub purpose: Texts,
}

/// Where registers live.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// Input registers: read by function 04.
    Input,
    /// Holding registers: read by function 03, written by 10.
    Holding,
    /// Coils: written by function 05.
    Coil,
}

/// What may be done with a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Read only.
    Read,
    /// Write only.
    Write,
    /// Both.
    ReadWrite,
}

/// What a point is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// What the device is for.
    Measurement,
    /// A setting.
    Parameter,
    /// Something it does when written.
    Command,
}

/// What a write does to the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Debug, PartialEq)]
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
    pub unit: String,
    /// What may be done with it.
    pub access: Access,
    /// What it is for.
    pub role: Role,
    /// The one value that matters most.
    pub primary: bool,
    /// Values that may be written.
    pub range: Option<Range>,
    /// Meanings of its codes.
    pub codes: Vec<Code>,
    /// Value that it leaves the factory with.
    pub factory: Option<u16>,
    /// A write can lose the device or its calibration.
    pub danger: bool,
    /// What a write does to the link.
    pub effect: Option<Effect>,
}

/// A code with its meaning: a number, a name, or both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Code {
    /// As in the register.
    pub code: u16,
    /// The number that it stands for.
    pub number: Option<u32>,
    /// What it means.
    pub name: Option<Texts>,
}

/// Registers that are read together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// Where they live.
    pub table: Table,
    /// The first.
    pub address: u16,
    /// How many.
    pub quantity: u16,
}

/// Registers and the value that they hold.
#[derive(Clone, Debug, PartialEq, Eq)]
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

/// Why a text is no profile, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {reason}")]
pub struct ProfileError {
    /// Counted from 1.
    pub line: usize,
    /// In characters, counted from 1.
    pub column: usize,
    /// In English.
    pub reason: String,
}

impl Profile {
    /// Reads and checks a profile's file.
    pub fn from_json(text: &str) -> Result<Self, ProfileError> {
        load::load(text)
    }

    /// The point with this id.
    pub fn point(&self, id: &str) -> Option<&Point> {
        self.points.iter().find(|point| point.id == id)
    }

    /// What the device is for, the primary one first.
    pub fn measurements(&self) -> Vec<&Point> {
        let measurements = || self.points.iter().filter(|point| point.role == Role::Measurement);
        measurements().filter(|point| point.primary).chain(measurements().filter(|point| !point.primary)).collect()
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
}
