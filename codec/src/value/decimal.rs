//! Exact decimals.

use core::cmp::Ordering;
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
    /// The most digits behind the point.
    pub const MAX_DECIMALS: u8 = 18;

    /// A whole number.
    pub const fn whole(number: i64) -> Self {
        Self { mantissa: number, decimals: 0 }
    }

    /// The nearest float, as far as the mantissa has at most 53 bits.
    #[allow(clippy::cast_precision_loss)] // devices send at most 32 bits
    pub fn to_f64(self) -> f64 {
        self.mantissa as f64 / power_of_ten(self.decimals) as f64
    }

    /// Reads `-0.328` as -328 with 3 decimals; nothing but digits with at most one point and a leading minus.
    pub fn parse(text: &str) -> Option<Self> {
        let (negative, digits) = text.strip_prefix('-').map_or((false, text), |rest| (true, rest));
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let plain = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
        if whole.is_empty() || !plain(whole) || !plain(fraction) || fraction.len() > usize::from(Self::MAX_DECIMALS) {
            return None;
        }
        let decimals = u8::try_from(fraction.len()).ok()?;
        let scaled = whole.parse::<i64>().ok()?.checked_mul(power_of_ten(decimals))?;
        let mantissa = scaled.checked_add(if fraction.is_empty() { 0 } else { fraction.parse().ok()? })?;
        Some(Self { mantissa: if negative { -mantissa } else { mantissa }, decimals })
    }

    /// How the values compare: 25 and 25.0 are equal.
    pub fn compare(self, other: Self) -> Ordering {
        // 63 bits times 10^18 (60 bits) fit.
        let left = i128::from(self.mantissa) * i128::from(power_of_ten(other.decimals));
        left.cmp(&(i128::from(other.mantissa) * i128::from(power_of_ten(self.decimals))))
    }

    /// The digits before and behind a point that stands `decimals` places from the right (from -18; a negative number
    /// counts tens), if that loses nothing: 1.5 has 1500 with 3 decimals, and none with 0.
    pub fn mantissa_with(self, decimals: i8) -> Option<i64> {
        let shift = i32::from(decimals) - i32::from(self.decimals);
        if self.mantissa == 0 {
            return Some(0);
        }
        let scale = 10i64.checked_pow(shift.unsigned_abs())?;
        if shift >= 0 {
            return self.mantissa.checked_mul(scale);
        }
        (self.mantissa % scale == 0).then_some(self.mantissa / scale)
    }

    /// `mantissa` / 10^`decimals` (a negative number counts tens), if it fits.
    pub fn scaled(mantissa: i64, decimals: i8) -> Option<Self> {
        match u8::try_from(decimals) {
            Ok(decimals) => (decimals <= Self::MAX_DECIMALS).then_some(Self { mantissa, decimals }),
            Err(_) if mantissa == 0 => Some(Self::whole(0)),
            Err(_) => {
                let tens = 10i64.checked_pow(u32::from(decimals.unsigned_abs()))?;
                Some(Self::whole(mantissa.checked_mul(tens)?))
            }
        }
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

/// At least 1. For numbers far from the ends of their range.
pub(crate) const fn greatest_common_divisor(a: i128, b: i128) -> i128 {
    let (mut a, mut b) = (a.unsigned_abs(), b.unsigned_abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    if a == 0 { 1 } else { a.cast_signed() }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_point_moves_without_loss_or_not_at_all() {
        let half = Decimal::parse("1.50").unwrap();
        assert_eq!(half.mantissa_with(3), Some(1500));
        assert_eq!(half.mantissa_with(1), Some(15));
        assert_eq!(half.mantissa_with(0), None);
        assert_eq!(Decimal::whole(1200).mantissa_with(-2), Some(12));
        assert_eq!(Decimal::whole(i64::MAX).mantissa_with(1), None);
        assert_eq!(Decimal::whole(0).mantissa_with(i8::MAX), Some(0));
        assert_eq!(Decimal::scaled(12, -2), Some(Decimal::whole(1200)));
        assert_eq!(Decimal::scaled(12, -19), None);
        assert_eq!(Decimal::scaled(12, 19), None);
    }

    #[test]
    fn values_compare_whatever_their_digits() {
        let of = |text| Decimal::parse(text).unwrap();
        assert_eq!(of("25").compare(of("25.000")), Ordering::Equal);
        assert_eq!(of("-0.1").compare(of("0")), Ordering::Less);
        assert_eq!(of("9223372036854775807").compare(of("0.000000000000000001")), Ordering::Greater);
    }

    proptest! {
        #[test]
        fn decimals_print_and_parse(mantissa in -999_999_999i64..999_999_999, decimals in 0u8..7) {
            let decimal = Decimal { mantissa, decimals };
            prop_assert_eq!(Decimal::parse(&decimal.to_string()), Some(decimal));
        }

        #[test]
        fn no_decimal_panics(mantissa: i64, decimals: u8, other: i8) {
            let decimal = Decimal { mantissa, decimals };
            let _ = (decimal.to_string(), decimal.to_f64(), decimal.mantissa_with(other), decimal.compare(decimal));
            if let Some(scaled) = Decimal::scaled(mantissa, other) {
                prop_assert_eq!(scaled.mantissa_with(other), Some(mantissa));
            }
        }
    }
}
