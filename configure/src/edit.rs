//! What a user wants changed, checked before anything is sent.

use buslens_codec::UnitId;
use buslens_codec::profile::{Effect, Known, Point, Profile, Role, UnitFit};
use buslens_codec::value::{Decimal, Encoding, Text, Value, ValueError};
use serde::{Deserialize, Serialize};

use crate::Snapshot;
use crate::request::{same, shares_registers};
use crate::snapshot::decode;

/// A point and what it shall hold; of a command the code that it is written with.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edit {
    /// The point's id.
    pub point: String,
    /// Its registers; a coil is FF00 or 0000. Bits of a register that are not the point's own are 0 and stay as they are in
    /// the device.
    pub registers: Vec<u16>,
}

/// What is not written, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refusal {
    /// The point's id.
    pub point: String,
    /// Why.
    pub why: Unfit,
}

/// Why something is not written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unfit {
    /// The profile has no such point.
    UnknownPoint,
    /// Nothing writes it.
    NotWritable,
    /// A number is needed.
    NotANumber,
    /// The value must lie within, in the point's unit.
    OutOfRange {
        /// The least.
        first: Decimal,
        /// The most.
        last: Decimal,
    },
    /// No value of its encoding is so large or so small.
    TooLarge,
    /// It takes only so many digits behind the point.
    TooFine {
        /// Digits behind the point.
        decimals: u8,
    },
    /// Its numbers lie further apart, in the point's unit.
    BetweenSteps {
        /// From one to the next.
        step: Decimal,
        /// The least of them.
        first: Decimal,
    },
    /// Its table of codes knows no such value: [`Point::codes`] has what it takes.
    NotInTable,
    /// The number of its registers or coils is another one.
    NotItsRegisters,
    /// The register that scales it must be read first.
    NotScaled,
    /// It shares its register with others and must be read first.
    NotRead,
    /// It takes a text of so many ASCII characters at most.
    NotAText {
        /// Characters.
        most: u8,
    },
    /// The value is given in another unit than the device's.
    OtherUnit {
        /// The device's.
        device: String,
        /// Of the value.
        value: String,
    },
    /// Unit id 0 is everybody on the line: the device could not be asked alone.
    UnitZero,
    /// The profile does not tell how the device is reached with this value.
    LeadsNowhere,
    /// It is to be written twice.
    Twice,
    /// Another command of the same plan loses the device's settings: after that nothing can follow.
    AfterLoss,
    /// The snapshot is of another profile.
    OtherProfile,
}

/// What brings a device to what a snapshot tells.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Transfer {
    /// What is to be written.
    pub edits: Vec<Edit>,
    /// What differs and cannot be written.
    pub refused: Vec<Refusal>,
}

impl Edit {
    /// Takes what a user typed for a point: a number in its unit, the number or name of a code (in either language), a text,
    /// or registers as `0x0007`. `have` tells its scale and unit. Digits may come from a Chinese keyboard, and the unit may
    /// stand behind.
    pub fn parse(profile: &Profile, point: &Point, typed: &str, have: &Snapshot) -> Result<Self, Refusal> {
        let known = have.known(profile);
        let registers = typed_registers(profile, point, typed, &known).and_then(|registers| {
            check(profile, point, &registers, &known)?;
            Ok(registers)
        });
        match registers {
            Ok(registers) => Ok(Self { point: point.id.clone(), registers }),
            Err(why) => Err(Refusal { point: point.id.clone(), why }),
        }
    }
}

/// What must be written so that a device that holds `have` holds what `want` tells. Values, not registers, are carried
/// over where another register scales them. The unit id is left out unless `with_unit` says so: two devices with one unit
/// id on a line cannot be told apart. What cannot be written or was not read is no part of it.
pub fn edits_to(profile: &Profile, have: &Snapshot, want: &Snapshot, with_unit: bool) -> Transfer {
    let mut transfer = Transfer::default();
    let refuse = |point: &str, why| Refusal { point: point.to_owned(), why };
    if want.profile != profile.id || have.profile != profile.id {
        transfer.refused.push(refuse("", Unfit::OtherProfile));
        return transfer;
    }
    let (known, wanted_known) = (have.known(profile), want.known(profile));
    for point in &profile.points {
        let Some(wanted) = want.registers(&point.id) else { continue };
        let leads_away = point.effects.iter().any(|effect| matches!(effect, Effect::Defaults | Effect::Search));
        let is_unit = point.effects.contains(&Effect::Unit);
        if point.role == Role::Command || leads_away || is_unit && !with_unit {
            continue;
        }
        match carried(profile, point, wanted, (&known, &wanted_known)) {
            _ if point.write.is_empty() => {
                if have.registers(&point.id).is_some_and(|held| !same(point, held, wanted)) {
                    transfer.refused.push(refuse(&point.id, Unfit::NotWritable));
                }
            }
            Ok(registers) if have.registers(&point.id).is_some_and(|held| same(point, held, &registers)) => {}
            Ok(registers) => transfer.edits.push(Edit { point: point.id.clone(), registers }),
            Err(why) => transfer.refused.push(refuse(&point.id, why)),
        }
    }
    transfer
}

/// The registers that hold in one device what `registers` hold in another one, checked.
fn carried(
    profile: &Profile,
    point: &Point,
    registers: &[u16],
    (known, other): (&Known, &Known),
) -> Result<Vec<u16>, Unfit> {
    let (device, value) = (profile.unit_of(point, known), profile.unit_of(point, other));
    if device != value {
        return Err(Unfit::OtherUnit { device: device.to_owned(), value: value.to_owned() });
    }
    let registers = if point.decimals_from.is_some() {
        let found = decode(profile, point, registers, other).filter(|found| found.scaled).ok_or(Unfit::NotScaled)?;
        let value = found.value.map_err(|_| Unfit::TooLarge)?;
        encoded(profile, point, value, known)?
    } else {
        own_bits(point, registers)
    };
    check(profile, point, &registers, known)?;
    Ok(registers)
}

/// Whether a point takes these registers.
pub(crate) fn check(profile: &Profile, point: &Point, registers: &[u16], known: &Known) -> Result<(), Unfit> {
    if point.write.is_empty() {
        return Err(Unfit::NotWritable);
    }
    if registers.len() != point.encoding.registers() || crate::request::write_request(point, registers).is_none() {
        return Err(Unfit::NotItsRegisters);
    }
    let found = decode(profile, point, registers, known).ok_or(Unfit::NotItsRegisters)?;
    let value = found.value.map_err(|_| Unfit::TooLarge)?;
    if !found.scaled && point.range.is_some() {
        return Err(Unfit::NotScaled);
    }
    if !point.allows(value) {
        return Err(match (&point.range, value) {
            (Some(range), Value::Number(_) | Value::Float(_) | Value::Double(_)) => {
                Unfit::OutOfRange { first: range.first, last: range.last }
            }
            _ => Unfit::NotInTable,
        });
    }
    if point.effects.contains(&Effect::Unit) {
        let Value::Number(number) = value else { return Ok(()) };
        let unit = number.mantissa_with(0).and_then(|number| u8::try_from(number).ok()).map(UnitId);
        if unit == Some(UnitId::BROADCAST) {
            return Err(Unfit::UnitZero);
        }
        if unit.is_none_or(|unit| profile.unit_fit(unit) == UnitFit::Refused) {
            let whole = |number: u16| Decimal::whole(number.into());
            return Err(Unfit::OutOfRange {
                first: whole(profile.units.first.max(1)),
                last: whole(profile.units.last),
            });
        }
    }
    Ok(())
}

/// A point's registers without the bits of others.
pub(crate) fn own_bits(point: &Point, registers: &[u16]) -> Vec<u16> {
    match (point.encoding, registers) {
        (Encoding::Bits { mask, .. }, [register]) => vec![register & mask],
        (Encoding::ReservedI16 { .. }, [_, low]) => vec![0, *low],
        _ => registers.to_vec(),
    }
}

fn typed_registers(profile: &Profile, point: &Point, typed: &str, known: &Known) -> Result<Vec<u16>, Unfit> {
    let typed = plain(typed);
    if let Encoding::Text { registers, .. } = point.encoding {
        let most = registers.saturating_mul(2);
        let printable = typed.bytes().all(|byte| matches!(byte, b' '..=b'~')) && typed.len() <= most.into();
        let text = Text::new(typed.as_bytes()).filter(|_| printable).ok_or(Unfit::NotAText { most })?;
        return profile.encode_point(point, Value::Text(text), known).map_err(unfit);
    }
    if let Some(code) = named(point, &typed) {
        return encoded(profile, point, Value::Code(code), known);
    }
    if let Some(registers) = hexadecimal(point, &typed)? {
        return Ok(registers);
    }
    let number = without_unit(profile, point, &typed, known);
    let number = Decimal::parse(number.strip_prefix('+').unwrap_or(number)).ok_or(match point.encoding {
        Encoding::Code | Encoding::Bits { .. } if !point.codes.is_empty() => Unfit::NotInTable,
        _ => Unfit::NotANumber,
    })?;
    let value = match point.encoding {
        Encoding::Code | Encoding::Bits { .. } => Value::Code(code_of(point, number)?),
        // A float has what precision it has.
        #[allow(clippy::cast_possible_truncation)]
        Encoding::Float { .. } => Value::Float(number.to_f64() as f32),
        Encoding::Double { .. } => Value::Double(number.to_f64()),
        _ => Value::Number(number),
    };
    encoded(profile, point, value, known)
}

/// The registers of a value.
fn encoded(profile: &Profile, point: &Point, value: Value, known: &Known) -> Result<Vec<u16>, Unfit> {
    if let (Some(range), Value::Number(_)) = (&point.range, value)
        && !point.allows(value)
    {
        return Err(Unfit::OutOfRange { first: range.first, last: range.last });
    }
    profile.encode_point(point, value, known).map_err(|error| match (error, value) {
        (ValueError::Unrepresentable, Value::Number(number)) => misfit(profile, point, number, known),
        (error, _) => unfit(error),
    })
}

fn unfit(error: ValueError) -> Unfit {
    match error {
        ValueError::NotScaled => Unfit::NotScaled,
        ValueError::Count { .. } => Unfit::NotItsRegisters,
        ValueError::OutOfRange { .. } | ValueError::Unrepresentable => Unfit::TooLarge,
    }
}

/// Why no registers hold a number: it is beyond them, or lies between two that they hold.
fn misfit(profile: &Profile, point: &Point, number: Decimal, known: &Known) -> Unfit {
    let Some(grid) = profile.grid(point, known) else { return Unfit::TooLarge };
    if !grid.contains(number) {
        return Unfit::OutOfRange { first: grid.first, last: grid.last };
    }
    let is_aligned = |decimals: u8| grid.first.mantissa_with(i8::try_from(decimals).unwrap_or(i8::MAX)).is_some();
    match grid.step {
        Decimal { mantissa: 1, decimals } if is_aligned(decimals) => Unfit::TooFine { decimals },
        step => Unfit::BetweenSteps { step, first: grid.first },
    }
}

/// The code with this name in either language, whatever its case.
fn named(point: &Point, typed: &str) -> Option<u16> {
    let alike = |name: &str| plain(name).to_lowercase() == typed.to_lowercase();
    let code =
        point.codes.iter().find(|code| code.name.as_ref().is_some_and(|name| alike(&name.en) || alike(&name.zh)));
    code.map(|code| code.code)
}

/// Registers as `0x0007`; of several the first one comes first.
fn hexadecimal(point: &Point, typed: &str) -> Result<Option<Vec<u16>>, Unfit> {
    let Some(digits) = typed.strip_prefix("0x").or_else(|| typed.strip_prefix("0X")) else { return Ok(None) };
    let count = point.encoding.registers();
    let digits: String = digits.chars().filter(|c| !c.is_whitespace()).collect();
    let plain = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    if !plain || digits.len() > 4 * count {
        return Err(Unfit::NotItsRegisters);
    }
    let digits = format!("{digits:0>width$}", width = 4 * count);
    let words = digits.as_bytes().chunks(4).map(|word| u16::from_str_radix(std::str::from_utf8(word).ok()?, 16).ok());
    let registers: Option<Vec<u16>> = words.collect();
    let registers = registers.ok_or(Unfit::NotItsRegisters)?;
    match (point.encoding, registers.as_slice()) {
        // What is typed is the code, wherever in the register its bits are.
        (Encoding::Bits { .. }, [code]) => {
            point.encoding.encode(Value::Code(*code)).map(Some).map_err(|_| Unfit::NotInTable)
        }
        _ => Ok(Some(registers)),
    }
}

/// The code that stands for a number. Where codes stand for numbers, a number is never a code itself: 3 is no baud rate.
fn code_of(point: &Point, number: Decimal) -> Result<u16, Unfit> {
    let whole = number.mantissa_with(0).ok_or(Unfit::NotInTable)?;
    if point.codes.iter().any(|code| code.number.is_some()) {
        let code = point.codes.iter().find(|code| code.number.map(i64::from) == Some(whole));
        return code.map(|code| code.code).ok_or(Unfit::NotInTable);
    }
    u16::try_from(whole).map_err(|_| Unfit::NotInTable)
}

/// What was typed without the point's unit behind it.
fn without_unit<'a>(profile: &Profile, point: &Point, typed: &'a str, known: &Known) -> &'a str {
    let unit = profile.unit_of(point, known);
    let number = if unit.is_empty() { None } else { typed.strip_suffix(plain(unit).as_str()) };
    number.map_or(typed, str::trim_end)
}

/// Without spaces around, and with the digits and signs of a Chinese keyboard as ASCII.
fn plain(typed: &str) -> String {
    let ascii = |c: char| match c {
        '\u{3000}' => ' ',
        '\u{2212}' => '-',
        '\u{FF01}'..='\u{FF5E}' => char::from_u32(u32::from(c) - 0xFEE0).unwrap_or(c),
        other => other,
    };
    typed.trim().chars().map(ascii).collect::<String>().trim().to_owned()
}

/// Whether a write of this point needs what its registers hold now.
pub(crate) fn needs_reading(point: &Point) -> bool {
    shares_registers(point) && !point.read.is_empty()
}
