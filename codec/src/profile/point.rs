//! One datum or command of a device.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Group, Scale, Setting, Texts};
use crate::pdu::Request;
use crate::value::{Decimal, Encoding, Value, ValueError};

/// One datum or command of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Name for programs.
    pub id: String,
    /// Name for people.
    pub name: Texts,
    /// What users must know of it.
    pub note: Option<Texts>,
    /// What a write costs, in the user's words; there where [`Point::danger`] is the highest.
    pub consequence: Option<Texts>,
    /// Its first register, or its coil.
    pub register: u16,
    /// How the registers hold it. A coil is a code: FF00 is on, 0000 is off, as function 05 writes it.
    pub encoding: Encoding,
    /// The function codes that read it: of 1, 2, 3, 4. Empty for what is only written.
    pub read: Vec<u8>,
    /// The function codes that write it: of 5, 6, 15, 16. Empty for what is only read.
    pub write: Vec<u8>,
    /// Its unit, empty for none or where a register tells it.
    pub unit: String,
    /// The point whose code names the unit.
    pub unit_from: Option<String>,
    /// The point that says how many digits stand behind the decimal point.
    pub decimals_from: Option<String>,
    /// What lies between the number in its registers and its value.
    pub scale: Option<Scale>,
    /// The points that say where its range begins and ends, in its own scale and unit.
    pub limits_from: Option<LimitsFrom>,
    /// What it is for.
    pub role: Role,
    /// The one value that matters most.
    pub primary: bool,
    /// Values that may be written, or that a measurement can have.
    pub range: Option<Limits>,
    /// Meanings of its codes.
    pub codes: Vec<Code>,
    /// What its register holds when it leaves the factory.
    pub factory: Option<u16>,
    /// What a write can cost.
    pub danger: Danger,
    /// What a write does to the link, all of it.
    pub effects: Vec<Effect>,
    /// With which settings a write that changes the link is answered.
    pub reply: Reply,
}

/// What a point is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Role {
    /// What the device is for.
    Measurement,
    /// A setting, or a fact about the device.
    Parameter,
    /// Something it does when written.
    Command,
}

/// What a write can cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Danger {
    /// Nothing that another write would not undo.
    #[default]
    None,
    /// It changes how the device is reached or what it measures: ask once.
    Caution,
    /// It loses settings or a calibration: explain and ask twice.
    Danger,
}

/// What a write does to the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Effect {
    /// The unit id changes to the written number.
    Unit,
    /// The baud rate changes to the number of the written code, or to the written number.
    Baud,
    /// The parity changes to what the written code sets.
    Parity,
    /// The number of data bits changes to what the written code sets.
    DataBits,
    /// The number of stop bits changes to what the written code sets.
    StopBits,
    /// RTU or ASCII changes to what the written code sets.
    Mode,
    /// The device restarts and is deaf for [`super::Timing::startup_silence_ms`].
    Restart,
    /// Line and mode become those of the profile. The unit id becomes what it was at the factory.
    Defaults,
    /// Unit id and line may be anything afterwards: the device must be searched.
    Search,
}

/// With which settings a write that changes the link is answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reply {
    /// The old or the new ones: take either.
    #[default]
    Either,
    /// The old ones; the new ones hold after the reply.
    Old,
    /// The new ones.
    New,
}

/// Two points that say where the range of a third one begins and ends.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LimitsFrom {
    /// Id of the point that holds its one end.
    pub first: String,
    /// Id of the point that holds its other end.
    pub last: String,
}

impl LimitsFrom {
    /// Both ids.
    pub fn ids(&self) -> [&str; 2] {
        [&self.first, &self.last]
    }
}

/// On which side of its range a value lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// Below the least.
    Below,
    /// Above the most.
    Above,
}

/// Least and most of a value, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// The least.
    pub first: Decimal,
    /// The most.
    pub last: Decimal,
}

impl Limits {
    /// Whether `value` lies within; a code and a text never do.
    pub fn contain(&self, value: Value) -> bool {
        match value {
            Value::Number(number) => self.first.compare(number).is_le() && self.last.compare(number).is_ge(),
            _ => value.to_f64().is_some_and(|float| self.first.to_f64() <= float && float <= self.last.to_f64()),
        }
    }
}

/// A code with its meaning: a number, a name, or both.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Code {
    /// As in the register.
    pub code: u16,
    /// The number that it stands for.
    pub number: Option<u32>,
    /// What it means.
    pub name: Option<Texts>,
    /// The setting of the line that it stands for.
    pub sets: Option<Setting>,
    /// What writing it can cost, where that is more than the point's.
    pub danger: Danger,
    /// What writing it costs in the user's words, where that is not what the point says.
    pub consequence: Option<Texts>,
}

impl Point {
    /// Whether a function reads or writes it.
    pub fn uses(&self, function: u8) -> bool {
        self.read.contains(&function) || self.write.contains(&function)
    }

    /// Where it lies in `quantity` registers from `address` on, if all of it does.
    pub fn offset_in(&self, address: u16, quantity: usize) -> Option<usize> {
        let offset = usize::from(self.register.checked_sub(address)?);
        (offset + self.encoding.registers() <= quantity).then_some(offset)
    }

    /// Whether it is a coil or a discrete input: FF00 or 0000.
    pub fn is_bit(&self) -> bool {
        self.read.iter().chain(&self.write).any(|function| matches!(function, 0x01 | 0x02 | 0x05 | 0x0F))
    }

    /// The value that its registers hold, as far as no other point scales it.
    pub fn decode(&self, registers: &[u16]) -> Result<Value, ValueError> {
        let raw = self.encoding.decode(registers)?;
        self.value_of(raw)
    }

    /// The registers that hold a value, as far as no other point scales it; see [`Encoding::encode`].
    pub fn encode(&self, value: Value) -> Result<Vec<u16>, ValueError> {
        self.encoding.encode(self.number_of(value)?)
    }

    /// As [`Point::encode`], but what the registers hold besides stays as it is in `before`; see
    /// [`Encoding::encode_over`].
    pub fn encode_over(&self, value: Value, before: &[u16]) -> Result<Vec<u16>, ValueError> {
        self.encoding.encode_over(self.number_of(value)?, before)
    }

    /// The number in its registers, in its unit.
    pub(super) fn value_of(&self, number: Value) -> Result<Value, ValueError> {
        match (self.scale, number) {
            (Some(scale), Value::Number(number)) => {
                scale.value_of(number).map(Value::Number).ok_or(ValueError::Unrepresentable)
            }
            _ => Ok(number),
        }
    }

    /// What its registers hold for a value.
    pub(super) fn number_of(&self, value: Value) -> Result<Value, ValueError> {
        match (self.scale, value) {
            (Some(scale), Value::Number(value)) => {
                scale.number_of(value).map(Value::Number).ok_or(ValueError::Unrepresentable)
            }
            _ => Ok(value),
        }
    }

    /// The read that brings it alone; `None` for what is only written.
    pub fn read_group(&self) -> Option<Group> {
        let function = *self.read.first()?;
        let quantity = u16::try_from(self.encoding.registers()).ok()?;
        Some(Group { function, address: self.register, quantity, tentative: false })
    }

    /// The request that writes these registers to it; `None` if nothing writes it or they are none of its.
    pub fn write_request(&self, registers: &[u16]) -> Option<Request> {
        if registers.len() != self.encoding.registers() {
            return None;
        }
        let address = self.register;
        match *registers {
            [value @ (0x0000 | 0xFF00)] if self.write.contains(&0x05) => {
                Some(Request::WriteSingleCoil { address, on: value != 0 })
            }
            [value @ (0x0000 | 0xFF00)] if self.write.contains(&0x0F) => {
                Some(Request::WriteMultipleCoils { address, coils: [value != 0].to_vec() })
            }
            [value] if self.write.contains(&0x06) => Some(Request::WriteSingleRegister { address, value }),
            _ if self.write.contains(&0x10) => {
                Some(Request::WriteMultipleRegisters { address, values: registers.to_vec() })
            }
            _ => None,
        }
    }

    /// The value as text, without unit: a number, the number or name of a code, or the code itself if it is unknown; 1 or 0
    /// for a bit without names.
    pub fn text<'a>(&'a self, value: Value, language: impl Fn(&'a Texts) -> &'a String) -> String {
        let Value::Code(code) = value else { return value.to_string() };
        match self.code(code) {
            Some(Code { number: Some(number), .. }) => number.to_string(),
            Some(Code { name: Some(name), .. }) => language(name).clone(),
            _ if self.is_bit() && matches!(code, 0x0000 | 0xFF00) => u8::from(code != 0).to_string(),
            _ => code.to_string(),
        }
    }

    /// What a code means, if its table knows it.
    pub fn code(&self, code: u16) -> Option<&Code> {
        self.codes.iter().find(|known| known.code == code)
    }

    /// Whether its table of codes or its range knows the value. A scaled point's range is that of the scaled value.
    pub fn allows(&self, value: Value) -> bool {
        if let (Value::Code(code), false) = (value, self.codes.is_empty()) {
            return self.code(code).is_some();
        }
        self.range.is_none_or(|range| range.contain(value))
    }

    /// What writing this value can cost.
    pub fn danger_of(&self, value: Value) -> Danger {
        let Value::Code(code) = value else { return self.danger };
        self.code(code).map_or(self.danger, |code| self.danger.max(code.danger))
    }

    /// What writing this value costs, in the user's words, as far as the profile says it.
    pub fn consequence_of(&self, value: Value) -> Option<&Texts> {
        let code = if let Value::Code(code) = value { self.code(code) } else { None };
        code.and_then(|code| code.consequence.as_ref()).or(self.consequence.as_ref())
    }

    /// The ids of the points that it needs for its scale and its unit.
    pub fn refers_to(&self) -> impl Iterator<Item = &str> {
        self.decimals_from.as_deref().into_iter().chain(self.unit_from.as_deref())
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use super::super::tests::built_in;
    use super::*;

    #[test]
    fn unknown_codes_stay_what_they_are() {
        let profile = built_in("lvdt");
        let baud = profile.point("baud").unwrap();
        assert_eq!(baud.text(Value::Code(9), |name| &name.en), "9");
        assert!(!baud.allows(Value::Code(9)) && baud.allows(Value::Code(7)));
        let address = profile.point("address").unwrap();
        assert!(address.allows(Value::Number(Decimal::whole(247))));
        assert!(!address.allows(Value::Number(Decimal::whole(248))));
        assert!(!address.allows(Value::Code(5)));
    }

    #[test]
    fn a_limit_holds_for_floats_and_not_for_nan() {
        let limits = Limits { first: Decimal::whole(-1), last: Decimal { mantissa: 25, decimals: 1 } };
        assert!(limits.contain(Value::Float(2.5)) && limits.contain(Value::Double(-1.0)));
        assert!(!limits.contain(Value::Float(2.51)) && !limits.contain(Value::Float(f32::NAN)));
    }

    #[test]
    fn each_device_is_written_by_its_own_function() {
        let writes = [
            ("lvdt", "baud", 7, Some(Request::WriteMultipleRegisters { address: 0x31, values: vec![7] })),
            ("lvdt", "zero", 0xFF00, Some(Request::WriteSingleCoil { address: 0x50, on: true })),
            ("lvdt", "zero", 1, None),
            ("gauge-cable", "zero", 0xAB56, Some(Request::WriteSingleRegister { address: 0x0800, value: 0xAB56 })),
            ("level", "address", 2, Some(Request::WriteSingleRegister { address: 0, value: 2 })),
            ("level", "decimals", 2, None),
        ];
        for (profile, point, value, request) in writes {
            assert_eq!(built_in(profile).point(point).unwrap().write_request(&[value]), request, "{profile} {point}");
        }
        assert_eq!(built_in("gauge-cable").point("reading").unwrap().write_request(&[0, 0]), None);
    }

    #[test]
    fn a_code_can_be_worse_than_its_point() {
        let level = built_in("level");
        let save = level.point("save").unwrap();
        assert_eq!(save.danger_of(Value::Code(1)), Danger::Danger);
        assert!(save.danger_of(Value::Code(0)) < Danger::Danger);
        assert_eq!(level.point("restore_factory").unwrap().effects, [Effect::Search]);
    }
}
