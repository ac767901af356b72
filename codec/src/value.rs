//! Values as devices send them: exact decimals, codes, floats; and the closed set of encodings that profiles may name.

use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use serde::{Deserialize, Serialize};

/// An exact decimal: `mantissa` / 10^`decimals`. -328 with 3 decimals is -0.328.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Decimal {
    /// The digits, with sign and without point.
    pub mantissa: i64,
    /// Digits behind the point, at most 18.
    pub decimals: u8,
}

impl Decimal {
    /// The nearest float.
    #[allow(clippy::cast_precision_loss)] // devices send at most 32 bits
    pub fn to_f64(self) -> f64 {
        self.mantissa as f64 / power_of_ten(self.decimals) as f64
    }

    /// Reads `-0.328` as -328 with 3 decimals; nothing but digits with at most one point and a leading minus.
    pub fn parse(text: &str) -> Option<Self> {
        let (negative, digits) = text.strip_prefix('-').map_or((false, text), |rest| (true, rest));
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let plain = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
        if whole.is_empty() || !plain(whole) || !plain(fraction) || fraction.len() > 18 {
            return None;
        }
        let decimals = u8::try_from(fraction.len()).ok()?;
        let scaled = whole.parse::<i64>().ok()?.checked_mul(power_of_ten(decimals))?;
        let mantissa = scaled.checked_add(if fraction.is_empty() { 0 } else { fraction.parse().ok()? })?;
        Some(Self { mantissa: if negative { -mantissa } else { mantissa }, decimals })
    }
}

/// All digits behind the point, with ASCII signs: `-0.328`, `25.0`.
impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scale = power_of_ten(self.decimals).unsigned_abs();
        let (magnitude, sign) = (self.mantissa.unsigned_abs(), if self.mantissa < 0 { "-" } else { "" });
        match self.decimals {
            0 => write!(f, "{sign}{magnitude}"),
            decimals => {
                write!(f, "{sign}{}.{:0width$}", magnitude / scale, magnitude % scale, width = usize::from(decimals))
            }
        }
    }
}

fn power_of_ten(decimals: u8) -> i64 {
    10i64.checked_pow(u32::from(decimals)).unwrap_or(i64::MAX)
}

/// A value of a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// A number.
    Number(Decimal),
    /// A 32-bit float as sent.
    Float(f32),
    /// A code whose meaning the point's table tells; unknown codes stay what they are.
    Code(u16),
}

impl Value {
    /// The value as a float, if it is a number.
    pub fn to_f64(self) -> Option<f64> {
        match self {
            Self::Number(decimal) => Some(decimal.to_f64()),
            Self::Float(float) => Some(f64::from(float)),
            Self::Code(_) => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(decimal) => decimal.fmt(f),
            Self::Float(float) => float.fmt(f),
            Self::Code(code) => code.fmt(f),
        }
    }
}

/// Which register of a pair comes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WordOrder {
    /// High word first, as bytes within a register.
    #[default]
    HighFirst,
    /// Low word first.
    LowFirst,
}

/// How registers hold a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// One register, unsigned.
    U16 {
        /// Digits behind the point.
        decimals: u8,
    },
    /// One register, two's complement.
    I16 {
        /// Digits behind the point.
        decimals: u8,
    },
    /// Two registers, unsigned.
    U32 {
        /// Digits behind the point.
        decimals: u8,
        /// Which register comes first.
        words: WordOrder,
    },
    /// Two registers, two's complement.
    I32 {
        /// Digits behind the point.
        decimals: u8,
        /// Which register comes first.
        words: WordOrder,
    },
    /// Two registers, IEEE 754 single precision.
    F32 {
        /// Which register comes first.
        words: WordOrder,
    },
    /// Two registers of which the first is reserved and the second holds a two's complement.
    ReservedI16 {
        /// Digits behind the point.
        decimals: u8,
    },
    /// Two registers: bit 15 of the first is the sign and the rest whole units, the second holds thousandths (0-999).
    /// 8000 0148 is -0.328: the sign counts even where the whole part is zero.
    SignMagnitudeThousandths,
    /// One register with a code.
    Code,
}

/// Why registers hold no value of an encoding, or a value does not fit it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ValueError {
    /// Another number of registers is needed.
    #[error("{found} registers, must be {expected}")]
    Count {
        /// Registers there are.
        found: usize,
        /// Registers needed.
        expected: usize,
    },
    /// A part of the encoding is beyond what it allows.
    #[error("{found} is not allowed here")]
    OutOfRange {
        /// The register as it came.
        found: u16,
    },
    /// The value cannot be written in this encoding.
    #[error("the value does not fit its encoding")]
    Unrepresentable,
}

impl Encoding {
    /// How many registers it takes.
    pub const fn registers(self) -> usize {
        match self {
            Self::U16 { .. } | Self::I16 { .. } | Self::Code => 1,
            Self::U32 { .. }
            | Self::I32 { .. }
            | Self::F32 { .. }
            | Self::ReservedI16 { .. }
            | Self::SignMagnitudeThousandths => 2,
        }
    }

    /// The value that `registers` hold.
    pub fn decode(self, registers: &[u16]) -> Result<Value, ValueError> {
        let number = |mantissa: i64, decimals: u8| Ok(Value::Number(Decimal { mantissa, decimals }));
        match (self, registers) {
            (Self::U16 { decimals }, &[word]) => number(word.into(), decimals),
            (Self::I16 { decimals }, &[word]) | (Self::ReservedI16 { decimals }, &[_, word]) => {
                number(word.cast_signed().into(), decimals)
            }
            (Self::U32 { decimals, words }, &[a, b]) => number(join(words, a, b).into(), decimals),
            (Self::I32 { decimals, words }, &[a, b]) => number(join(words, a, b).cast_signed().into(), decimals),
            (Self::F32 { words }, &[a, b]) => Ok(Value::Float(f32::from_bits(join(words, a, b)))),
            (Self::SignMagnitudeThousandths, &[high, low]) => {
                if low > 999 {
                    return Err(ValueError::OutOfRange { found: low });
                }
                let magnitude = i64::from(high & 0x7FFF) * 1000 + i64::from(low);
                number(if high & 0x8000 == 0 { magnitude } else { -magnitude }, 3)
            }
            (Self::Code, &[code]) => Ok(Value::Code(code)),
            _ => Err(ValueError::Count { found: registers.len(), expected: self.registers() }),
        }
    }

    /// The registers that hold `value`.
    pub fn encode(self, value: Value) -> Result<Vec<u16>, ValueError> {
        const MISFIT: ValueError = ValueError::Unrepresentable;
        let mantissa = |decimals: u8| match value {
            Value::Number(decimal) => rescale(decimal, decimals).ok_or(MISFIT),
            Value::Float(_) | Value::Code(_) => Err(MISFIT),
        };
        let signed = |decimals: u8| i16::try_from(mantissa(decimals)?).map(i16::cast_unsigned).map_err(|_| MISFIT);
        Ok(match self {
            Self::U16 { decimals } => vec![u16::try_from(mantissa(decimals)?).map_err(|_| MISFIT)?],
            Self::I16 { decimals } => vec![signed(decimals)?],
            Self::ReservedI16 { decimals } => vec![0, signed(decimals)?],
            Self::U32 { decimals, words } => split(words, u32::try_from(mantissa(decimals)?).map_err(|_| MISFIT)?),
            Self::I32 { decimals, words } => {
                split(words, i32::try_from(mantissa(decimals)?).map_err(|_| MISFIT)?.cast_unsigned())
            }
            Self::F32 { words } => match value {
                Value::Float(float) => split(words, float.to_bits()),
                Value::Number(_) | Value::Code(_) => return Err(MISFIT),
            },
            Self::SignMagnitudeThousandths => {
                let thousandths = mantissa(3)?;
                let whole = u16::try_from(thousandths.unsigned_abs() / 1000).map_err(|_| MISFIT)?;
                if whole > 0x7FFF {
                    return Err(MISFIT);
                }
                let sign = if thousandths < 0 { 0x8000 } else { 0 };
                vec![sign | whole, u16::try_from(thousandths.unsigned_abs() % 1000).map_err(|_| MISFIT)?]
            }
            Self::Code => match value {
                Value::Code(code) => vec![code],
                Value::Number(_) | Value::Float(_) => return Err(MISFIT),
            },
        })
    }
}

/// The mantissa with other decimals, if that loses nothing.
fn rescale(value: Decimal, decimals: u8) -> Option<i64> {
    if let Some(more) = decimals.checked_sub(value.decimals) {
        return value.mantissa.checked_mul(power_of_ten(more));
    }
    let scale = power_of_ten(value.decimals - decimals);
    (value.mantissa % scale == 0).then_some(value.mantissa / scale)
}

fn join(order: WordOrder, first: u16, second: u16) -> u32 {
    let (high, low) = match order {
        WordOrder::HighFirst => (first, second),
        WordOrder::LowFirst => (second, first),
    };
    u32::from(high) << 16 | u32::from(low)
}

fn split(order: WordOrder, value: u32) -> Vec<u16> {
    let [a, b, c, d] = value.to_be_bytes();
    let (high, low) = (u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d]));
    match order {
        WordOrder::HighFirst => vec![high, low],
        WordOrder::LowFirst => vec![low, high],
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use proptest::prelude::*;

    use super::*;

    const DISPLACEMENT: Encoding = Encoding::SignMagnitudeThousandths;
    const TEMPERATURE: Encoding = Encoding::ReservedI16 { decimals: 1 };

    #[test]
    fn values_of_the_manual_and_its_errata() {
        let cases = [
            (DISPLACEMENT, [0x0137, 0x0148], "311.328"),
            (DISPLACEMENT, [0x8137, 0x0148], "-311.328"),
            (DISPLACEMENT, [0x8000, 0x0148], "-0.328"),
            (DISPLACEMENT, [0x007B, 0x01C8], "123.456"),
            (DISPLACEMENT, [0x8000, 0x0000], "0.000"),
            (TEMPERATURE, [0x0000, 0x00FF], "25.5"),
            (TEMPERATURE, [0x0000, 0xFFFF], "-0.1"),
        ];
        for (encoding, registers, text) in cases {
            assert_eq!(encoding.decode(&registers).unwrap().to_string(), text);
        }
    }

    #[test]
    fn a_thousand_thousandths_are_no_value() {
        assert_eq!(DISPLACEMENT.decode(&[0, 1000]), Err(ValueError::OutOfRange { found: 1000 }));
    }

    fn encodings() -> impl Strategy<Value = Encoding> {
        let words = prop_oneof![Just(WordOrder::HighFirst), Just(WordOrder::LowFirst)];
        (0u8..7, words, 0usize..8).prop_map(|(decimals, words, kind)| match kind {
            0 => Encoding::U16 { decimals },
            1 => Encoding::I16 { decimals },
            2 => Encoding::U32 { decimals, words },
            3 => Encoding::I32 { decimals, words },
            4 => Encoding::F32 { words },
            5 => Encoding::ReservedI16 { decimals },
            6 => Encoding::SignMagnitudeThousandths,
            _ => Encoding::Code,
        })
    }

    proptest! {
        #[test]
        fn what_decodes_encodes_to_the_same_value(encoding in encodings(), a: u16, b: u16) {
            let registers = &[a, b][..encoding.registers()];
            if let Ok(value) = encoding.decode(registers) {
                let again = encoding.encode(value).unwrap();
                if let Value::Float(float) = value {
                    prop_assert_eq!(float.to_bits(), join_of(encoding, &again));
                } else {
                    prop_assert_eq!(encoding.decode(&again).unwrap(), value);
                }
            }
        }

        #[test]
        fn decimals_print_and_parse(mantissa in -999_999_999i64..999_999_999, decimals in 0u8..7) {
            let decimal = Decimal { mantissa, decimals };
            prop_assert_eq!(Decimal::parse(&decimal.to_string()), Some(decimal));
        }
    }

    fn join_of(encoding: Encoding, registers: &[u16]) -> u32 {
        let Encoding::F32 { words } = encoding else { return 0 };
        join(words, registers[0], registers[1])
    }
}
