//! From the number in registers to the value in its unit and back, where a factor and an offset stand between them.

use serde::{Deserialize, Serialize};

use crate::value::{Decimal, greatest_common_divisor};

/// Value = number in the registers · factor + offset, exactly: what does not come out in decimals is no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Scale {
    /// Any number but 0.
    pub factor: Decimal,
    /// In the point's unit.
    pub offset: Decimal,
}

impl Scale {
    /// The value that a number stands for. It has the digits that factor and offset give it: 200 · 0.005 is 1.000.
    /// `None` for what does not fit a [`Decimal`], there or on the way back.
    pub fn value_of(self, number: Decimal) -> Option<Decimal> {
        let value = self.times_and_plus(number)?;
        self.number_of(value).filter(|back| back.compare(number).is_eq()).map(|_| value)
    }

    fn times_and_plus(self, number: Decimal) -> Option<Decimal> {
        let Self { factor, offset } = self;
        // 63 bits each.
        let product = i128::from(number.mantissa) * i128::from(factor.mantissa);
        let own = u32::from(number.decimals) + u32::from(factor.decimals);
        let decimals = own.max(offset.decimals.into());
        let sum = product.checked_mul(power_of_ten(decimals - own)?)?.checked_add(
            i128::from(offset.mantissa).checked_mul(power_of_ten(decimals - u32::from(offset.decimals))?)?,
        )?;
        fitting(sum, decimals)
    }

    /// The number that stands for a value. `None` where there is none with as few digits.
    pub fn number_of(self, value: Decimal) -> Option<Decimal> {
        let Self { factor, offset } = self;
        let decimals = u32::from(value.decimals.max(offset.decimals));
        let aligned =
            |part: Decimal| i128::from(part.mantissa).checked_mul(power_of_ten(decimals - u32::from(part.decimals))?);
        let difference = aligned(value)?.checked_sub(aligned(offset)?)?;
        let shared = greatest_common_divisor(difference, factor.mantissa.into());
        let (difference, divisor) = (difference / shared, i128::from(factor.mantissa) / shared);
        // difference / (divisor · 10^decimals) · 10^(the factor's decimals), as a decimal if it is one.
        let (places, whole) = (0..=u32::from(Decimal::MAX_DECIMALS))
            .find_map(|places| Some((places, power_of_ten(places)?)).filter(|(_, whole)| whole % divisor == 0))?;
        let mantissa = difference.checked_mul(whole / divisor)?;
        let (down, up) = (places + decimals, u32::from(factor.decimals));
        if down >= up {
            fitting(mantissa, down - up)
        } else {
            fitting(mantissa.checked_mul(power_of_ten(up - down)?)?, 0)
        }
    }
}

/// With fewer digits behind the point where only zeros are left out, if it does not fit otherwise.
fn fitting(mut mantissa: i128, mut decimals: u32) -> Option<Decimal> {
    loop {
        let fits = (i64::try_from(mantissa), u8::try_from(decimals));
        if let (Ok(mantissa), Ok(decimals @ 0..=Decimal::MAX_DECIMALS)) = fits {
            return Some(Decimal { mantissa, decimals });
        }
        if decimals == 0 || mantissa % 10 != 0 {
            return None;
        }
        mantissa /= 10;
        decimals -= 1;
    }
}

fn power_of_ten(places: u32) -> Option<i128> {
    10i128.checked_pow(places)
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use proptest::prelude::*;

    use super::*;

    fn decimal(text: &str) -> Decimal {
        Decimal::parse(text).unwrap()
    }

    #[test]
    fn numbers_become_values_and_come_back() {
        let cases = [
            ("0.1", "-40", "655", "25.5"),
            ("0.005", "0", "200", "1.000"),
            ("2.5", "0", "-3", "-7.5"),
            ("-1", "0.05", "7", "-6.95"),
            ("1000", "0", "12", "12000"),
            ("0.25", "-0.125", "0", "-0.125"),
            ("3", "0", "0.5", "1.5"),
        ];
        for (factor, offset, number, value) in cases {
            let scale = Scale { factor: decimal(factor), offset: decimal(offset) };
            let found = scale.value_of(decimal(number)).unwrap();
            assert_eq!(found.to_string(), value, "{number} · {factor} + {offset}");
            let back = scale.number_of(found).unwrap();
            assert!(back.compare(decimal(number)).is_eq(), "{back} {number}");
        }
    }

    #[test]
    fn what_has_no_end_behind_the_point_is_no_number() {
        let third = Scale { factor: Decimal::whole(3), offset: Decimal::whole(0) };
        assert_eq!(third.number_of(Decimal::whole(1)), None);
        assert_eq!(third.number_of(Decimal::whole(6)), Some(Decimal::whole(2)));
        let half = Scale { factor: decimal("0.5"), offset: Decimal::whole(0) };
        assert_eq!(half.number_of(decimal("1.2")), Some(decimal("2.4")));
    }

    proptest! {
        #[test]
        fn a_number_is_its_value_undone(
            number: i64, decimals in 0u8..=18, factor in any::<i64>().prop_filter("not 0", |factor| *factor != 0),
            places in 0u8..=18, offset: i64, offset_places in 0u8..=18,
        ) {
            let scale = Scale {
                factor: Decimal { mantissa: factor, decimals: places },
                offset: Decimal { mantissa: offset, decimals: offset_places },
            };
            let number = Decimal { mantissa: number, decimals };
            let _ = scale.number_of(number);
            if let Some(value) = scale.value_of(number) {
                let back = scale.number_of(value).unwrap();
                prop_assert!(back.compare(number).is_eq(), "{number} {back}");
            }
        }

        #[test]
        fn what_devices_send_always_comes_back(
            number in any::<i32>(), factor in (-9_999i64..=9_999).prop_filter("not 0", |factor| *factor != 0),
            places in 0u8..=5, offset in -99_999i64..=99_999, offset_places in 0u8..=5,
        ) {
            let scale = Scale {
                factor: Decimal { mantissa: factor, decimals: places },
                offset: Decimal { mantissa: offset, decimals: offset_places },
            };
            let value = scale.value_of(Decimal::whole(number.into())).unwrap();
            let back = scale.number_of(value).unwrap();
            prop_assert_eq!(back.mantissa_with(0), Some(number.into()));
        }
    }
}
