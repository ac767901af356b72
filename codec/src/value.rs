//! Values as devices send them: exact decimals, codes, floats, texts; and the closed set of encodings that profiles may
//! name.

mod decimal;
mod encoding;
mod float;

use core::cmp::Ordering;
use core::fmt;

use serde::{Deserialize, Serialize};

pub use decimal::Decimal;
pub(crate) use decimal::greatest_common_divisor;
pub use encoding::{Encoding, Order, Width};

/// A value of a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// A number, exact to the last digit that was sent.
    Number(Decimal),
    /// A 32-bit float as sent.
    Float(f32),
    /// A 64-bit float as sent.
    Double(f64),
    /// A code whose meaning the point's table tells; unknown codes stay what they are.
    Code(u16),
    /// Characters.
    Text(Text),
}

impl Value {
    /// The value as a float, if it is a number.
    pub fn to_f64(self) -> Option<f64> {
        match self {
            Self::Number(decimal) => Some(decimal.to_f64()),
            Self::Float(float) => Some(f64::from(float)),
            Self::Double(float) => Some(float),
            Self::Code(_) | Self::Text(_) => None,
        }
    }

    /// How two numbers compare, decimals exactly; `None` if one of them is no number.
    pub fn compare(self, other: Self) -> Option<Ordering> {
        match (self, other) {
            (Self::Number(left), Self::Number(right)) => Some(left.compare(right)),
            (left, right) => left.to_f64()?.partial_cmp(&right.to_f64()?),
        }
    }
}

/// Numbers with all their digits; floats with as many digits as tell them apart, very large and very small ones with an
/// exponent (`1.5e12`).
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(decimal) => decimal.fmt(f),
            Self::Float(float) => float::write(f, f64::from(*float), true),
            Self::Double(float) => float::write(f, *float, false),
            Self::Code(code) => code.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

/// Characters in registers, at most [`Text::MAX_LEN`] bytes of any value. NULs behind the last character are no part of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Text {
    bytes: [u8; Self::MAX_LEN],
    len: u8,
}

impl Text {
    /// Bytes that fit, which is 16 registers.
    pub const MAX_LEN: usize = 32;

    /// The text of these bytes, without the NULs at their end; `None` if they are too many.
    pub fn new(bytes: &[u8]) -> Option<Self> {
        let len = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
        let mut text = Self { bytes: [0; Self::MAX_LEN], len: u8::try_from(len).ok()? };
        text.bytes.get_mut(..len)?.copy_from_slice(bytes.get(..len)?);
        Some(text)
    }

    /// Its bytes.
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.len)).unwrap_or(&self.bytes)
    }
}

/// ASCII as it is, without spaces at the end; U+FFFD for every other byte.
impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use fmt::Write;

        for byte in self.as_bytes().trim_ascii_end() {
            f.write_char(if matches!(byte, b' '..=b'~') { char::from(*byte) } else { char::REPLACEMENT_CHARACTER })?;
        }
        Ok(())
    }
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
    /// The register that scales the value has not been read yet.
    #[error("the register that scales this value is not known yet")]
    NotScaled,
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::*;

    #[test]
    fn floats_print_their_digits_and_huge_ones_an_exponent() {
        let cases = [
            (Value::Float(123.456), "123.456"),
            (Value::Float(-0.25), "-0.25"),
            (Value::Float(0.0), "0"),
            (Value::Float(1e30), "1e30"),
            (Value::Double(1.5e-9), "1.5e-9"),
            (Value::Double(-0.1), "-0.1"),
            (Value::Float(f32::NAN), "NaN"),
            (Value::Double(f64::INFINITY), "inf"),
        ];
        for (value, text) in cases {
            assert_eq!(value.to_string(), text);
        }
    }

    #[test]
    fn texts_end_before_their_nuls_and_show_strange_bytes() {
        let text = Text::new(b"LVDT-5 \x00\x00").unwrap();
        assert_eq!(text.as_bytes(), b"LVDT-5 ");
        assert_eq!(text.to_string(), "LVDT-5");
        assert_eq!(Text::new(b"a\x00\x07b").unwrap().to_string(), "a\u{FFFD}\u{FFFD}b");
        assert!(Text::new(&[b'x'; 33]).is_none());
        assert_eq!(Text::new(&[0; 64]).unwrap().as_bytes(), b"");
    }
}
