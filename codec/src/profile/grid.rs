//! The numbers that a point's registers can hold.

use serde::{Deserialize, Serialize};

use super::{Known, Point, Profile, Scale};
use crate::value::{Decimal, Value};

/// Numbers from the first to the last, in even steps, in the point's unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Grid {
    /// The least.
    pub first: Decimal,
    /// The most.
    pub last: Decimal,
    /// From one to the next, more than 0.
    pub step: Decimal,
}

impl Grid {
    /// Whether a number lies within, on a step or between two.
    pub fn contains(&self, number: Decimal) -> bool {
        self.first.compare(number).is_le() && number.compare(self.last).is_le()
    }
}

impl Profile {
    /// The numbers that a point's registers can hold, whatever its range says. `None` for codes, bits, texts and floats;
    /// where another point scales it that is not known; and for numbers that no [`Decimal`] holds.
    pub fn grid(&self, point: &Point, known: &Known) -> Option<Grid> {
        let (low, high) = point.encoding.ends()?;
        let decimals = match &point.decimals_from {
            Some(id) => self.decimals(id, known)?,
            None => point.encoding.fixed_decimals()?,
        };
        let value = |mantissa: i64| match point.value_of(Value::Number(Decimal::scaled(mantissa, decimals)?)).ok()? {
            Value::Number(number) => Some(number),
            _ => None,
        };
        let (a, b) = (value(low)?, value(high)?);
        let (first, last) = if a.compare(b).is_le() { (a, b) } else { (b, a) };
        let factor = point.scale.map_or(Decimal::whole(1), |scale| scale.factor);
        let factor = Decimal { mantissa: factor.mantissa.checked_abs()?, ..factor };
        let step = Scale { factor, offset: Decimal::whole(0) }.value_of(Decimal::scaled(1, decimals)?)?;
        Some(Grid { first, last, step })
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::super::tests::built_in;
    use super::*;
    use crate::value::{Encoding, Order, Width};

    fn point(encoding: Encoding, scale: Option<(&str, &str)>) -> Point {
        let decimal = |text| Decimal::parse(text).unwrap();
        let scale = scale.map(|(factor, offset)| Scale { factor: decimal(factor), offset: decimal(offset) });
        Point { encoding, scale, decimals_from: None, ..built_in("level").point("zero_offset").unwrap().clone() }
    }

    #[test]
    fn the_ends_can_be_written_and_nothing_beyond_them() {
        let order = Order::default();
        let mut all = alloc::vec![
            Encoding::ReservedI16 { decimals: 1 },
            Encoding::SignMagnitudeThousandths,
            Encoding::SignByteMagnitude { decimals: 3 },
        ];
        for width in [Width::One, Width::Two, Width::Four] {
            all.extend([
                Encoding::Integer { width, signed: true, decimals: 2, order },
                Encoding::Integer { width, signed: false, decimals: 0, order },
                Encoding::SignMagnitude { width, decimals: 1, order },
                Encoding::Bcd { width, decimals: 1, order },
            ]);
        }
        let profile = built_in("level");
        for encoding in all {
            let point = point(encoding, None);
            let Grid { first, last, step } = profile.grid(&point, &Known::default()).unwrap();
            for end in [first, last] {
                assert!(point.encode(Value::Number(end)).is_ok(), "{encoding:?} {end}");
            }
            assert_eq!(step.mantissa, 1);
            for (end, beyond) in [(first, first.mantissa.checked_sub(1)), (last, last.mantissa.checked_add(1))] {
                let Some(mantissa) = beyond else { continue };
                assert!(point.encode(Value::Number(Decimal { mantissa, ..end })).is_err(), "{encoding:?} {mantissa}");
            }
        }
    }

    #[test]
    fn a_factor_makes_the_steps_wider_and_an_offset_moves_them() {
        let encoding = Encoding::Integer { width: Width::One, signed: false, decimals: 0, order: Order::default() };
        let profile = built_in("level");
        let grid = |scale| {
            let grid = profile.grid(&point(encoding, Some(scale)), &Known::default()).unwrap();
            [grid.first, grid.last, grid.step].map(|number| number.to_string())
        };
        assert_eq!(grid(("0.005", "0")), ["0.000", "327.675", "0.005"]);
        assert_eq!(grid(("5", "-40")), ["-40", "327635", "5"]);
        assert_eq!(grid(("-0.1", "10")), ["-6543.5", "10.0", "0.1"]);
    }

    #[test]
    fn what_another_point_scales_is_known_with_it_alone() {
        let profile = built_in("level");
        let offset = profile.point("zero_offset").unwrap();
        assert_eq!(profile.grid(offset, &Known::default()), None);
        let mut known = Known::default();
        profile.decode_points(3, 3, &[2], &mut known);
        let grid = profile.grid(offset, &known).unwrap();
        assert_eq!([grid.first, grid.last, grid.step].map(|number| number.to_string()), ["-327.68", "327.67", "0.01"]);
        assert_eq!(profile.grid(profile.point("baud").unwrap(), &known), None);
    }
}
