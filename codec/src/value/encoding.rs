//! How registers hold a value. Bytes within a register come high byte first on the wire (MODBUS application protocol
//! V1.1b3, clause 4.2); how several registers make one number is each maker's own affair, hence [`Order`].

use alloc::vec;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Decimal, Text, Value, ValueError};

/// In which order the bytes of a value come, written as the field does: `A` is the highest byte.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Order {
    /// High register first, high byte first.
    #[default]
    Abcd,
    /// Low register first, high byte first.
    Cdab,
    /// High register first, low byte first.
    Badc,
    /// Low register first, low byte first.
    Dcba,
}

impl Order {
    /// All of them, the usual one first.
    pub const ALL: [Self; 4] = [Self::Abcd, Self::Cdab, Self::Badc, Self::Dcba];

    /// Its usual name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Abcd => "ABCD",
            Self::Cdab => "CDAB",
            Self::Badc => "BADC",
            Self::Dcba => "DCBA",
        }
    }

    /// Whether the low register comes first.
    pub const fn low_register_first(self) -> bool {
        matches!(self, Self::Cdab | Self::Dcba)
    }

    /// Whether the low byte of each register comes first.
    pub const fn low_byte_first(self) -> bool {
        matches!(self, Self::Badc | Self::Dcba)
    }

    fn byte_order(self, register: u16) -> u16 {
        if self.low_byte_first() { register.swap_bytes() } else { register }
    }

    /// The bits of up to four registers.
    pub(crate) fn gather(self, registers: &[u16]) -> u64 {
        let join = |bits: u64, register: &u16| bits << 16 | u64::from(self.byte_order(*register));
        if self.low_register_first() { registers.iter().rev().fold(0, join) } else { registers.iter().fold(0, join) }
    }

    /// The registers that hold these bits.
    fn spread(self, bits: u64, width: Width) -> Vec<u16> {
        let word = |place: usize| u16::try_from(bits >> (16 * place) & 0xFFFF).unwrap_or_default();
        let mut registers: Vec<u16> = (0..width.registers()).rev().map(|place| self.byte_order(word(place))).collect();
        if self.low_register_first() {
            registers.reverse();
        }
        registers
    }
}

/// How many registers a number takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Width {
    /// 16 bits.
    One,
    /// 32 bits.
    Two,
    /// 64 bits.
    Four,
}

impl Width {
    /// As a number: 1, 2 or 4.
    pub const fn registers(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
        }
    }

    /// 16, 32 or 64.
    pub const fn bits(self) -> u32 {
        match self {
            Self::One => 16,
            Self::Two => 32,
            Self::Four => 64,
        }
    }
}

/// How registers hold a value. `decimals` is the number of digits behind the point; a negative number counts tens:
/// -2 reads a register of 12 as 1200.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Encoding {
    /// Unsigned, or two's complement. An unsigned value above 2^63 - 1 is out of range.
    Integer {
        /// 1, 2 or 4 registers.
        width: Width,
        /// Two's complement.
        signed: bool,
        /// Digits behind the point, -9 to 18.
        decimals: i8,
        /// Order of bytes.
        order: Order,
    },
    /// The top bit is the sign, the rest is the magnitude.
    SignMagnitude {
        /// 1, 2 or 4 registers.
        width: Width,
        /// Digits behind the point, -9 to 18.
        decimals: i8,
        /// Order of bytes.
        order: Order,
    },
    /// A decimal digit in each four bits.
    Bcd {
        /// 1, 2 or 4 registers: 4, 8 or 16 digits.
        width: Width,
        /// Digits behind the point, -9 to 18.
        decimals: i8,
        /// Order of bytes.
        order: Order,
    },
    /// Two registers, IEEE 754 single precision.
    Float {
        /// Order of bytes.
        order: Order,
    },
    /// Four registers, IEEE 754 double precision.
    Double {
        /// Order of bytes.
        order: Order,
    },
    /// Two registers of which the first is reserved and the second holds a two's complement.
    ReservedI16 {
        /// Digits behind the point, -9 to 18.
        decimals: i8,
    },
    /// Two registers: bit 15 of the first is the sign and the rest whole units, the second holds thousandths (0-999).
    /// 8000 0148 is -0.328: the sign counts even where the whole part is zero.
    SignMagnitudeThousandths,
    /// Two registers: the first byte is the sign (00 plus, 01 minus), the second 00, the second register the magnitude.
    /// 0100 1235 with 3 decimals is -4.661.
    SignByteMagnitude {
        /// Digits behind the point, -9 to 18.
        decimals: i8,
    },
    /// One register with a code.
    Code,
    /// Some bits of one register as a code.
    Bits {
        /// The bits that belong to it.
        mask: u16,
        /// How far they are moved to the right, 0 to 15.
        shift: u8,
    },
    /// Characters, two in each register.
    Text {
        /// 1 to 16 registers.
        registers: u8,
        /// Order of bytes.
        order: Order,
    },
}

impl Encoding {
    /// How many registers it takes.
    pub const fn registers(self) -> usize {
        match self {
            Self::Integer { width, .. } | Self::SignMagnitude { width, .. } | Self::Bcd { width, .. } => {
                width.registers()
            }
            Self::Code | Self::Bits { .. } => 1,
            Self::Float { .. }
            | Self::ReservedI16 { .. }
            | Self::SignMagnitudeThousandths
            | Self::SignByteMagnitude { .. } => 2,
            Self::Double { .. } => 4,
            Self::Text { registers, .. } => registers as usize,
        }
    }

    /// Its type as a profile's file names it.
    pub const fn type_name(self) -> &'static str {
        match self {
            Self::Integer { width: Width::One, signed: false, .. } => "u16",
            Self::Integer { width: Width::One, signed: true, .. } => "i16",
            Self::Integer { width: Width::Two, signed: false, .. } => "u32",
            Self::Integer { width: Width::Two, signed: true, .. } => "i32",
            Self::Integer { width: Width::Four, signed: false, .. } => "u64",
            Self::Integer { width: Width::Four, signed: true, .. } => "i64",
            Self::SignMagnitude { width: Width::One, .. } => "sign_magnitude_16",
            Self::SignMagnitude { width: Width::Two, .. } => "sign_magnitude_32",
            Self::SignMagnitude { width: Width::Four, .. } => "sign_magnitude_64",
            Self::Bcd { width: Width::One, .. } => "bcd_16",
            Self::Bcd { width: Width::Two, .. } => "bcd_32",
            Self::Bcd { width: Width::Four, .. } => "bcd_64",
            Self::Float { .. } => "f32",
            Self::Double { .. } => "f64",
            Self::ReservedI16 { .. } => "reserved_i16",
            Self::SignMagnitudeThousandths => "sign_magnitude_thousandths",
            Self::SignByteMagnitude { .. } => "sign_byte_magnitude",
            Self::Code => "code",
            Self::Bits { .. } => "bits",
            Self::Text { .. } => "text",
        }
    }

    /// The order of its bytes, for those that come in several.
    pub const fn order(self) -> Option<Order> {
        match self {
            Self::Integer { order, .. }
            | Self::SignMagnitude { order, .. }
            | Self::Bcd { order, .. }
            | Self::Float { order }
            | Self::Double { order }
            | Self::Text { order, .. } => Some(order),
            _ => None,
        }
    }

    /// Its digits behind the point, for those that have any number of them.
    pub const fn decimals(self) -> Option<i8> {
        match self {
            Self::Integer { decimals, .. }
            | Self::SignMagnitude { decimals, .. }
            | Self::Bcd { decimals, .. }
            | Self::ReservedI16 { decimals }
            | Self::SignByteMagnitude { decimals } => Some(decimals),
            _ => None,
        }
    }

    /// The digits behind the point of the numbers that it holds; `None` for what is no decimal number.
    pub(crate) const fn fixed_decimals(self) -> Option<i8> {
        match self {
            Self::SignMagnitudeThousandths => Some(3),
            _ => self.decimals(),
        }
    }

    /// The least and the most of the numbers that it holds, as digits without a point; `None` for what is no decimal
    /// number.
    pub(crate) const fn ends(self) -> Option<(i64, i64)> {
        let (least, most) = match self {
            Self::Integer { width, signed: true, .. } => {
                let most = i64::MAX >> (64 - width.bits());
                (-most - 1, most)
            }
            Self::Integer { width: Width::Four, signed: false, .. } => (0, i64::MAX),
            Self::Integer { width, signed: false, .. } => (0, (1 << width.bits()) - 1),
            Self::SignMagnitude { width, .. } => {
                let most = i64::MAX >> (64 - width.bits());
                (-most, most)
            }
            Self::Bcd { width, .. } => (0, 10i64.pow(width.bits() / 4) - 1),
            Self::ReservedI16 { .. } => (i16::MIN as i64, i16::MAX as i64),
            Self::SignMagnitudeThousandths => (-32_767_999, 32_767_999),
            Self::SignByteMagnitude { .. } => (-(u16::MAX as i64), u16::MAX as i64),
            Self::Float { .. } | Self::Double { .. } | Self::Code | Self::Bits { .. } | Self::Text { .. } => {
                return None;
            }
        };
        Some((least, most))
    }

    /// The same with other digits behind the point, where that can be chosen.
    #[must_use]
    pub const fn with_decimals(mut self, digits: i8) -> Self {
        if let Self::Integer { decimals, .. }
        | Self::SignMagnitude { decimals, .. }
        | Self::Bcd { decimals, .. }
        | Self::ReservedI16 { decimals }
        | Self::SignByteMagnitude { decimals } = &mut self
        {
            *decimals = digits;
        }
        self
    }

    /// The value that `registers` hold.
    pub fn decode(self, registers: &[u16]) -> Result<Value, ValueError> {
        let Some(&first) = registers.first().filter(|_| registers.len() == self.registers()) else {
            return Err(ValueError::Count { found: registers.len(), expected: self.registers() });
        };
        let last = registers.last().copied().unwrap_or(first);
        let beyond = |found| Err(ValueError::OutOfRange { found });
        let number = |mantissa: i64, decimals: i8| {
            Decimal::scaled(mantissa, decimals).map_or_else(|| beyond(first), |number| Ok(Value::Number(number)))
        };
        match self {
            Self::Integer { width, signed, decimals, order } => {
                let bits = order.gather(registers);
                if signed {
                    let unused = 64 - width.bits();
                    return number((bits << unused).cast_signed() >> unused, decimals);
                }
                i64::try_from(bits).map_or_else(|_| beyond(first), |mantissa| number(mantissa, decimals))
            }
            Self::SignMagnitude { width, decimals, order } => {
                let bits = order.gather(registers);
                let sign = 1 << (width.bits() - 1);
                let magnitude = (bits & (sign - 1)).cast_signed();
                number(if bits & sign == 0 { magnitude } else { -magnitude }, decimals)
            }
            Self::Bcd { width, decimals, order } => {
                let bits = order.gather(registers);
                let mut digits = (0..width.bits()).step_by(4).rev().map(|shift| (bits >> shift & 0xF).cast_signed());
                // Sixteen digits at most.
                let value = digits.try_fold(0i64, |sum, digit| (digit < 10).then_some(sum * 10 + digit));
                value.map_or_else(|| beyond(first), |mantissa| number(mantissa, decimals))
            }
            Self::Float { order } => {
                // Two registers: 32 bits.
                Ok(Value::Float(f32::from_bits(u32::try_from(order.gather(registers)).unwrap_or_default())))
            }
            Self::Double { order } => Ok(Value::Double(f64::from_bits(order.gather(registers)))),
            Self::ReservedI16 { decimals } => number(last.cast_signed().into(), decimals),
            Self::SignMagnitudeThousandths if last > 999 => beyond(last),
            Self::SignMagnitudeThousandths => {
                let magnitude = i64::from(first & 0x7FFF) * 1000 + i64::from(last);
                number(if first & 0x8000 == 0 { magnitude } else { -magnitude }, 3)
            }
            Self::SignByteMagnitude { decimals } => match first {
                PLUS => number(last.into(), decimals),
                MINUS => number(-i64::from(last), decimals),
                found => beyond(found),
            },
            Self::Code => Ok(Value::Code(first)),
            Self::Bits { mask, shift } => Ok(Value::Code((first & mask).checked_shr(shift.into()).unwrap_or(0))),
            Self::Text { order, .. } => {
                let in_order = |registers: &mut dyn Iterator<Item = &u16>| -> Vec<u8> {
                    registers.flat_map(|register| order.byte_order(*register).to_be_bytes()).collect()
                };
                let bytes = if order.low_register_first() {
                    in_order(&mut registers.iter().rev())
                } else {
                    in_order(&mut registers.iter())
                };
                Text::new(&bytes).map_or_else(|| beyond(first), |text| Ok(Value::Text(text)))
            }
        }
    }

    /// The registers that hold `value`. Bits that do not belong to it are 0, see [`Encoding::encode_over`].
    pub fn encode(self, value: Value) -> Result<Vec<u16>, ValueError> {
        self.encoded(value).ok_or(ValueError::Unrepresentable)
    }

    /// As [`Encoding::encode`], but bits that do not belong to the value stay as they are in `before`: some bits of a
    /// register, or a reserved register.
    pub fn encode_over(self, value: Value, before: &[u16]) -> Result<Vec<u16>, ValueError> {
        let mut registers = self.encode(value)?;
        if before.len() != registers.len() {
            return Err(ValueError::Count { found: before.len(), expected: registers.len() });
        }
        let kept = match self {
            Self::Bits { mask, .. } => !mask,
            Self::ReservedI16 { .. } => u16::MAX,
            _ => 0,
        };
        if let (Some(first), Some(old)) = (registers.first_mut(), before.first()) {
            *first |= old & kept;
        }
        Ok(registers)
    }

    fn encoded(self, value: Value) -> Option<Vec<u16>> {
        let mantissa = |decimals: i8| match value {
            Value::Number(decimal) => decimal.mantissa_with(decimals),
            _ => None,
        };
        Some(match (self, value) {
            (Self::Integer { width, signed, decimals, order }, _) => {
                let mantissa = mantissa(decimals)?;
                let unused = 64 - width.bits();
                let bits = mantissa.cast_unsigned() << unused >> unused;
                let fits = if signed {
                    (bits << unused).cast_signed() >> unused == mantissa
                } else {
                    mantissa >= 0 && bits == mantissa.cast_unsigned()
                };
                fits.then(|| order.spread(bits, width))?
            }
            (Self::SignMagnitude { width, decimals, order }, _) => {
                let mantissa = mantissa(decimals)?;
                let sign = 1 << (width.bits() - 1);
                let magnitude = Some(mantissa.unsigned_abs()).filter(|magnitude| *magnitude < sign)?;
                order.spread(if mantissa < 0 { sign | magnitude } else { magnitude }, width)
            }
            (Self::Bcd { width, decimals, order }, _) => {
                let mut rest = u64::try_from(mantissa(decimals)?).ok()?;
                let mut bits = 0;
                for shift in (0..width.bits()).step_by(4) {
                    bits |= (rest % 10) << shift;
                    rest /= 10;
                }
                (rest == 0).then(|| order.spread(bits, width))?
            }
            (Self::Float { order }, Value::Float(float)) => order.spread(float.to_bits().into(), Width::Two),
            (Self::Double { order }, Value::Double(float)) => order.spread(float.to_bits(), Width::Four),
            (Self::ReservedI16 { decimals }, _) => {
                vec![0, i16::try_from(mantissa(decimals)?).ok()?.cast_unsigned()]
            }
            (Self::SignMagnitudeThousandths, _) => {
                let thousandths = mantissa(3)?;
                let whole = u16::try_from(thousandths.unsigned_abs() / 1000).ok().filter(|whole| *whole <= 0x7FFF)?;
                let sign = if thousandths < 0 { 0x8000 } else { 0 };
                vec![sign | whole, u16::try_from(thousandths.unsigned_abs() % 1000).ok()?]
            }
            (Self::SignByteMagnitude { decimals }, _) => {
                let mantissa = mantissa(decimals)?;
                vec![if mantissa < 0 { MINUS } else { PLUS }, u16::try_from(mantissa.unsigned_abs()).ok()?]
            }
            (Self::Code, Value::Code(code)) => vec![code],
            (Self::Bits { mask, shift }, Value::Code(code)) => {
                let bits = code.checked_shl(shift.into())?;
                (bits & mask == bits && bits.checked_shr(shift.into()) == Some(code)).then(|| vec![bits])?
            }
            (Self::Text { registers, order }, Value::Text(text)) => {
                let bytes = text.as_bytes();
                if bytes.len() > 2 * usize::from(registers) {
                    return None;
                }
                let byte = |at: usize| bytes.get(at).copied().unwrap_or(0);
                let register = |at| order.byte_order(u16::from_be_bytes([byte(2 * at), byte(2 * at + 1)]));
                let mut words: Vec<u16> = (0..usize::from(registers)).map(register).collect();
                if order.low_register_first() {
                    words.reverse();
                }
                words
            }
            _ => return None,
        })
    }
}

/// First register of [`Encoding::SignByteMagnitude`] for zero and above.
const PLUS: u16 = 0x0000;
/// First register of [`Encoding::SignByteMagnitude`] below zero.
const MINUS: u16 = 0x0100;

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use proptest::prelude::*;

    use super::*;

    const DISPLACEMENT: Encoding = Encoding::SignMagnitudeThousandths;
    const TEMPERATURE: Encoding = Encoding::ReservedI16 { decimals: 1 };
    const GAUGE: Encoding = Encoding::SignByteMagnitude { decimals: 3 };

    fn integer(width: Width, signed: bool, decimals: i8, order: Order) -> Encoding {
        Encoding::Integer { width, signed, decimals, order }
    }

    fn shows(encoding: Encoding, registers: &[u16], text: &str) {
        assert_eq!(encoding.decode(registers).unwrap().to_string(), text, "{encoding:?} {registers:04X?}");
    }

    #[test]
    fn values_of_the_manuals_and_their_errata() {
        shows(DISPLACEMENT, &[0x0137, 0x0148], "311.328");
        shows(DISPLACEMENT, &[0x8137, 0x0148], "-311.328");
        shows(DISPLACEMENT, &[0x8000, 0x0148], "-0.328");
        shows(DISPLACEMENT, &[0x007B, 0x01C8], "123.456");
        shows(DISPLACEMENT, &[0x8000, 0x0000], "0.000");
        shows(TEMPERATURE, &[0x0000, 0x00FF], "25.5");
        shows(TEMPERATURE, &[0x0000, 0xFFFF], "-0.1");
        shows(GAUGE, &[0x0100, 0x1235], "-4.661");
        shows(GAUGE, &[0x0000, 0x1235], "4.661");
        shows(GAUGE, &[0x0100, 0xFFFF], "-65.535");
        shows(GAUGE, &[0x0100, 0x0000], "0.000");
    }

    #[test]
    fn one_number_in_every_order() {
        let orders = [[0x0001u16, 0xE240], [0xE240, 0x0001], [0x0100, 0x40E2], [0x40E2, 0x0100]];
        for (order, registers) in Order::ALL.into_iter().zip(orders) {
            shows(integer(Width::Two, false, 3, order), &registers, "123.456");
            let float = f32::to_bits(123.456);
            let [a, b, c, d] = float.to_be_bytes();
            let registers = match order {
                Order::Abcd => [[a, b], [c, d]],
                Order::Cdab => [[c, d], [a, b]],
                Order::Badc => [[b, a], [d, c]],
                Order::Dcba => [[d, c], [b, a]],
            };
            shows(Encoding::Float { order }, &registers.map(u16::from_be_bytes), "123.456");
        }
        shows(integer(Width::Four, true, 0, Order::Cdab), &[0xFFFE, 0xFFFF, 0xFFFF, 0xFFFF], "-2");
        shows(integer(Width::One, false, -2, Order::Badc), &[0x0C00], "1200");
        shows(Encoding::Double { order: Order::Abcd }, &[0x3FB9, 0x9999, 0x9999, 0x999A], "0.1");
    }

    #[test]
    fn digits_in_four_bits_and_a_sign_in_the_top_bit() {
        let bcd = Encoding::Bcd { width: Width::Two, decimals: 3, order: Order::Abcd };
        shows(bcd, &[0x0012, 0x3456], "123.456");
        assert_eq!(bcd.decode(&[0x001A, 0]), Err(ValueError::OutOfRange { found: 0x001A }));
        shows(Encoding::SignMagnitude { width: Width::One, decimals: 1, order: Order::Abcd }, &[0x8019], "-2.5");
    }

    #[test]
    fn what_an_encoding_does_not_allow_is_no_value() {
        assert_eq!(DISPLACEMENT.decode(&[0, 1000]), Err(ValueError::OutOfRange { found: 1000 }));
        assert_eq!(GAUGE.decode(&[0x0200, 0]), Err(ValueError::OutOfRange { found: 0x0200 }));
        assert_eq!(GAUGE.decode(&[0x0101, 0]), Err(ValueError::OutOfRange { found: 0x0101 }));
        assert_eq!(GAUGE.decode(&[0]), Err(ValueError::Count { found: 1, expected: 2 }));
        let big = integer(Width::Four, false, 0, Order::Abcd);
        assert_eq!(big.decode(&[0x8000, 0, 0, 0]), Err(ValueError::OutOfRange { found: 0x8000 }));
        let too_long = Encoding::Text { registers: 17, order: Order::Abcd };
        assert_eq!(too_long.decode(&[0x4141; 17]), Err(ValueError::OutOfRange { found: 0x4141 }));
    }

    #[test]
    fn bits_leave_their_neighbours_alone() {
        let bits = Encoding::Bits { mask: 0x0070, shift: 4 };
        assert_eq!(bits.decode(&[0xFFDF]), Ok(Value::Code(5)));
        assert_eq!(bits.encode(Value::Code(5)), Ok(vec![0x0050]));
        assert_eq!(bits.encode(Value::Code(8)), Err(ValueError::Unrepresentable));
        assert_eq!(bits.encode_over(Value::Code(5), &[0xFF8F]), Ok(vec![0xFFDF]));
        assert_eq!(TEMPERATURE.encode_over(Value::Number(Decimal::whole(1)), &[7, 7]), Ok(vec![7, 10]));
        assert_eq!(Encoding::Bits { mask: 1, shift: 16 }.decode(&[1]), Ok(Value::Code(0)));
        assert_eq!(Encoding::Bits { mask: 1, shift: 16 }.encode(Value::Code(0)), Err(ValueError::Unrepresentable));
    }

    #[test]
    fn characters_come_in_either_order() {
        let text = |order| Encoding::Text { registers: 2, order };
        shows(text(Order::Abcd), &[0x4C56, 0x4454], "LVDT");
        shows(text(Order::Badc), &[0x564C, 0x5444], "LVDT");
        shows(text(Order::Cdab), &[0x4454, 0x4C56], "LVDT");
        shows(text(Order::Abcd), &[0x4C56, 0x0000], "LV");
    }

    /// Encodings as a profile may name them.
    pub(crate) fn encodings() -> impl Strategy<Value = Encoding> {
        let width = prop_oneof![Just(Width::One), Just(Width::Two), Just(Width::Four)];
        let order = prop::sample::select(Order::ALL.to_vec());
        (-9i8..=18, width, order, any::<bool>(), any::<u16>(), 0u8..=15, 1u8..=16, 0usize..11).prop_map(
            |(decimals, width, order, signed, mask, shift, registers, kind)| match kind {
                0 | 1 => Encoding::Integer { width, signed, decimals, order },
                2 => Encoding::SignMagnitude { width, decimals, order },
                3 => Encoding::Bcd { width, decimals, order },
                4 => Encoding::Float { order },
                5 => Encoding::Double { order },
                6 => Encoding::ReservedI16 { decimals },
                7 => Encoding::SignMagnitudeThousandths,
                8 => Encoding::SignByteMagnitude { decimals },
                // A mask reaches down to its shift, no further.
                9 => Encoding::Bits { mask: mask >> shift << shift, shift },
                10 => Encoding::Text { registers, order },
                _ => Encoding::Code,
            },
        )
    }

    fn same(a: Value, b: Value) -> bool {
        match (a, b) {
            (Value::Float(a), Value::Float(b)) => a.to_bits() == b.to_bits(),
            (Value::Double(a), Value::Double(b)) => a.to_bits() == b.to_bits(),
            (Value::Number(a), Value::Number(b)) => a.compare(b).is_eq(),
            (a, b) => a == b,
        }
    }

    fn values() -> impl Strategy<Value = Value> {
        prop_oneof![
            (-99_999i64..99_999, 0u8..5).prop_map(|(mantissa, decimals)| Value::Number(Decimal { mantissa, decimals })),
            (any::<i64>(), any::<u8>()).prop_map(|(mantissa, decimals)| Value::Number(Decimal { mantissa, decimals })),
            any::<f32>().prop_map(Value::Float),
            any::<f64>().prop_map(Value::Double),
            any::<u16>().prop_map(Value::Code),
            prop::collection::vec(any::<u8>(), 0..=32).prop_map(|bytes| Value::Text(Text::new(&bytes).unwrap())),
        ]
    }

    proptest! {
        #[test]
        fn what_decodes_encodes_to_the_same_value(encoding in encodings(), all in any::<[u16; 16]>(), small: bool) {
            let all = if small { all.map(|word| word % 0x0400) } else { all };
            let registers = &all[..encoding.registers()];
            if let Ok(value) = encoding.decode(registers) {
                let again = encoding.encode(value).unwrap();
                prop_assert!(same(encoding.decode(&again).unwrap(), value));
                let over = encoding.encode_over(value, registers).unwrap();
                prop_assert!(same(encoding.decode(&over).unwrap(), value));
                if matches!(encoding, Encoding::Integer { .. } | Encoding::Bits { .. } | Encoding::Text { .. }) {
                    prop_assert_eq!(over, registers);
                }
            }
        }

        #[test]
        fn what_encodes_decodes_to_the_same_value(encoding in encodings(), value in values()) {
            if let Ok(registers) = encoding.encode(value) {
                prop_assert_eq!(registers.len(), encoding.registers());
                prop_assert!(same(encoding.decode(&registers).unwrap(), value));
            }
        }

        #[test]
        fn any_number_of_registers_is_a_value_or_an_error(encoding in encodings(), all in prop::collection::vec(any::<u16>(), 0..20)) {
            prop_assert_eq!(encoding.decode(&all).is_err_and(|error| matches!(error, ValueError::Count { .. })), all.len() != encoding.registers());
        }
    }
}
