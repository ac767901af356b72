//! Values from registers and back, also where another register tells the scale or the unit.

use alloc::vec::Vec;

use super::{Point, Profile};
use crate::value::{Decimal, Encoding, Value, ValueError};

/// What one device was last seen to say about scales and units. Keep one for each unit id, for one profile; it fills
/// itself from the reads that [`Profile::decode_points`] is given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// Places in the profile's list of points, with their values.
    values: Vec<(usize, Value)>,
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
    /// Whether the value is in its unit. `false` where another register tells the scale and has not been read yet: the
    /// value is the register's own number then.
    pub scaled: bool,
    /// Its unit as far as it is known, empty for none.
    pub unit: &'a str,
}

impl Profile {
    /// The points in registers that a function read or wrote from `address` on; for function 05 the one register is FF00
    /// or 0000. What scales other points is taken from `known`, and kept there if it is among what was read; a write
    /// makes it unknown until it is read again, for the device may have refused.
    pub fn decode_points<'a>(
        &'a self,
        function: u8,
        address: u16,
        registers: &[u16],
        known: &mut Known,
    ) -> Vec<PointValue<'a>> {
        let found = |(at, point): (usize, &'a Point)| {
            if !point.uses(function) {
                return None;
            }
            let offset = point.offset_in(address, registers.len())?;
            let own = registers.get(offset..)?.get(..point.encoding.registers())?;
            let raw = if point.decimals_from.is_some() { point.encoding.decode(own) } else { point.decode(own) };
            Some((at, point, offset, raw))
        };
        let found: Vec<_> = self.points.iter().enumerate().filter_map(found).collect();
        for (at, point, _, value) in &found {
            if self.points.iter().flat_map(Point::refers_to).any(|id| id == point.id) {
                known.values.retain(|(place, _)| place != at);
                if let (Ok(value), true) =
                    (value, point.read.contains(&function) && value.is_ok_and(|v| point.allows(v)))
                {
                    known.values.push((*at, *value));
                }
            }
        }
        let finish = |(_, point, offset, raw): (usize, &'a Point, usize, Result<Value, ValueError>)| {
            let (value, scaled) = match (&point.decimals_from, raw) {
                (Some(id), Ok(raw)) => match self.decimals(id, known) {
                    Some(decimals) => (scale(raw, decimals).and_then(|number| point.value_of(number)), true),
                    None => (Ok(raw), false),
                },
                (_, raw) => (raw, true),
            };
            PointValue { point, offset, value, scaled, unit: self.unit_of(point, known) }
        };
        found.into_iter().map(finish).collect()
    }

    /// The points among coils or discrete inputs that function 01 or 02 read from `address` on: FF00 where the bit is
    /// set, else 0000.
    pub fn decode_bits<'a>(&'a self, function: u8, address: u16, bits: &[bool]) -> Vec<PointValue<'a>> {
        let registers: Vec<u16> = bits.iter().map(|bit| if *bit { 0xFF00 } else { 0 }).collect();
        match function {
            0x01 | 0x02 | 0x0F => self.decode_points(function, address, &registers, &mut Known::default()),
            _ => Vec::new(),
        }
    }

    /// The registers that hold a value of a point, as [`Profile::decode_points`] gives it: a number is divided by what
    /// scales it, [`ValueError::NotScaled`] if that is not known. Whether the device takes it says [`Point::allows`].
    pub fn encode_point(&self, point: &Point, value: Value, known: &Known) -> Result<Vec<u16>, ValueError> {
        let Some(id) = &point.decimals_from else { return point.encode(value) };
        let decimals = self.decimals(id, known).ok_or(ValueError::NotScaled)?;
        let Value::Number(number) = point.number_of(value)? else { return Err(ValueError::Unrepresentable) };
        let whole = number.mantissa_with(decimals).ok_or(ValueError::Unrepresentable)?;
        point.encoding.encode(Value::Number(Decimal::whole(whole)))
    }

    /// As [`Profile::encode_point`], but what the registers hold besides the value stays as it is in `before`.
    pub fn encode_point_over(
        &self,
        point: &Point,
        value: Value,
        known: &Known,
        before: &[u16],
    ) -> Result<Vec<u16>, ValueError> {
        // What another point scales fills its registers.
        if point.decimals_from.is_some() {
            self.encode_point(point, value, known)
        } else {
            point.encode_over(value, before)
        }
    }

    /// The unit of a point, also where a register tells it; empty for none and where it is not known.
    pub fn unit_of<'a>(&'a self, point: &'a Point, known: &Known) -> &'a str {
        let Some(id) = &point.unit_from else { return &point.unit };
        let named = || {
            let (teller, value) = self.known_of(id, known)?;
            let Value::Code(code) = value else { return None };
            Some(teller.code(code)?.name.as_ref()?.en.as_str())
        };
        named().unwrap_or_default()
    }

    /// How many digits behind the decimal point another point tells.
    pub(super) fn decimals(&self, id: &str, known: &Known) -> Option<i8> {
        let number = match self.known_of(id, known)? {
            (_, Value::Number(number)) => number.mantissa_with(0)?,
            (teller, Value::Code(code)) => teller.code(code)?.number?.into(),
            _ => return None,
        };
        i8::try_from(number).ok().filter(|decimals| (0..=18).contains(decimals))
    }

    fn known_of(&self, id: &str, known: &Known) -> Option<(&Point, Value)> {
        let mut all = known.values.iter().filter_map(|(at, value)| Some((self.points.get(*at)?, *value)));
        all.find(|(point, _)| point.id == id)
    }
}

fn scale(raw: Value, decimals: i8) -> Result<Value, ValueError> {
    match raw {
        // The loader lets only whole numbers be scaled.
        Value::Number(number) => {
            Decimal::scaled(number.mantissa, decimals).map(Value::Number).ok_or(ValueError::Unrepresentable)
        }
        other => Ok(other),
    }
}

/// Whether another register may scale this: whole numbers only.
pub(super) fn can_be_scaled(encoding: Encoding) -> bool {
    match encoding {
        Encoding::Integer { decimals, .. }
        | Encoding::SignMagnitude { decimals, .. }
        | Encoding::Bcd { decimals, .. }
        | Encoding::SignByteMagnitude { decimals } => decimals == 0,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::{String, ToString};
    use alloc::vec;

    use proptest::prelude::*;

    use super::super::Scale;
    use super::super::tests::built_in;
    use super::*;
    use crate::value::{Order, Width};

    /// Id, value and unit of each point; a star where the scale is not known.
    fn shown(profile: &Profile, function: u8, address: u16, registers: &[u16], known: &mut Known) -> Vec<String> {
        let points = profile.decode_points(function, address, registers, known);
        let line = |found: PointValue<'_>| {
            let star = if found.scaled { "" } else { "*" };
            let value = found.point.text(found.value.unwrap(), |name| &name.en);
            [&found.point.id, " ", &value, star, " ", found.unit].concat().trim_end().to_string()
        };
        points.into_iter().map(line).collect()
    }

    #[test]
    fn one_read_brings_both_values_of_the_lvdt() {
        let known = &mut Known::default();
        let found = shown(&built_in("lvdt"), 4, 2, &[0, 285, 0x8000, 0x0148], known);
        assert_eq!(found, ["temperature 28.5 °C", "displacement -0.328 mm"]);
        assert!(shown(&built_in("lvdt"), 6, 0x31, &[7], known).is_empty());
        assert_eq!(shown(&built_in("lvdt"), 0x10, 0x31, &[7], known), ["baud 115200 Bd"]);
    }

    #[test]
    fn one_register_of_the_gauge_cable_means_this_or_that_by_its_function() {
        let (gauge, known) = (built_in("gauge-cable"), &mut Known::default());
        assert_eq!(shown(&gauge, 3, 0x0200, &[0x0100, 0x1235], known), ["minimum -4.661 mm"]);
        assert_eq!(shown(&gauge, 6, 0x0200, &[0], known), ["clear_record clear maximum and minimum"]);
        assert_eq!(shown(&gauge, 6, 0x0800, &[0xAB56], known), ["zero zero the gauge"]);
        assert!(shown(&gauge, 3, 0x0200, &[0], known).is_empty());
    }

    #[test]
    fn a_value_waits_for_its_scale() {
        let (level, known) = (built_in("level"), &mut Known::default());
        assert_eq!(shown(&level, 3, 4, &[6000], known), ["value 6000*"]);
        assert_eq!(shown(&level, 3, 3, &[3], known), ["decimals 3"]);
        assert_eq!(shown(&level, 3, 4, &[6000], known), ["value 6.000"]);
        assert_eq!(shown(&level, 3, 2, &[7], known), ["unit mH₂O"]);
        assert_eq!(shown(&level, 3, 0xC, &[0xFFFF], known), ["zero_offset -0.001 mH₂O"]);
        // The same read may hold the scale behind or before the value.
        let all = [1, 3, 1, 2, 6000, 0, 10_000];
        let found = shown(&level, 3, 0, &all, &mut Known::default());
        let values = ["value 60.00 kPa", "range_zero 0.00 kPa", "range_full 100.00 kPa"];
        assert_eq!(found[..4], ["address 1", "baud 9600 Bd", "unit kPa", "decimals 2"]);
        assert_eq!(found[4..], values);
        // Five digits behind the point do not exist: then nothing is known any more.
        assert_eq!(shown(&level, 3, 3, &[5], known), ["decimals 5"]);
        assert_eq!(shown(&level, 3, 4, &[6000], known), ["value 6000* mH₂O"]);
    }

    #[test]
    fn what_is_scaled_is_written_back_by_the_same_scale() {
        let (level, mut known) = (built_in("level"), Known::default());
        let offset = level.point("zero_offset").unwrap();
        let value = Value::Number(Decimal { mantissa: -25, decimals: 1 });
        assert_eq!(level.encode_point(offset, value, &known), Err(ValueError::NotScaled));
        level.decode_points(3, 3, &[2], &mut known);
        assert_eq!(level.encode_point(offset, value, &known), Ok(vec![0xFF06]));
        let too_fine = Value::Number(Decimal { mantissa: 1, decimals: 3 });
        assert_eq!(level.encode_point(offset, too_fine, &known), Err(ValueError::Unrepresentable));
    }

    #[test]
    fn a_coil_is_on_or_off() {
        let mut lvdt = built_in("lvdt");
        let zero = lvdt.points.iter_mut().find(|point| point.id == "zero").unwrap();
        zero.read = vec![1];
        let values = |function| {
            let found = lvdt.decode_bits(function, 0x4F, &[false, true, true]);
            found.iter().map(|found| (found.offset, found.value)).collect::<Vec<_>>()
        };
        assert_eq!(values(1), [(1, Ok(Value::Code(0xFF00)))]);
        assert_eq!(values(2), []);
        // Function 05 is no row of bits.
        assert_eq!(values(5), []);
    }

    #[test]
    fn a_written_scale_is_unknown_until_it_is_read() {
        let mut level = built_in("level");
        level.points.iter_mut().find(|point| point.id == "decimals").unwrap().write = vec![6];
        let known = &mut Known::default();
        level.decode_points(3, 3, &[2], known);
        level.decode_points(6, 3, &[1], known);
        assert_eq!(shown(&level, 3, 4, &[6000], known), ["value 6000*"]);
    }

    proptest! {
        #[test]
        fn what_is_scaled_by_a_factor_comes_back(
            registers in any::<[u16; 2]>(), factor in (-999i64..=999).prop_filter("not 0", |factor| *factor != 0),
            places in 0u8..=4, offset in -9999i64..=9999, decimals in 0u8..=3, kind in 0usize..4,
        ) {
            let mut level = built_in("level");
            let at = level.points.iter().position(|point| point.id == "value").unwrap();
            let (width, order) = (Width::One, Order::Abcd);
            level.points[at].encoding = match kind {
                0 => Encoding::Integer { width, signed: true, decimals: 0, order },
                1 => Encoding::Integer { width, signed: false, decimals: 0, order },
                2 => Encoding::SignMagnitude { width, decimals: 0, order },
                _ => Encoding::Bcd { width, decimals: 0, order },
            };
            let scale = Scale {
                factor: Decimal { mantissa: factor, decimals: places },
                offset: Decimal { mantissa: offset, decimals: 2 },
            };
            level.points[at].scale = Some(scale);
            let known = &mut Known::default();
            level.decode_points(3, 3, &[decimals.into()], known);
            let point = &level.points[at];
            for register in registers {
                let found = level.decode_points(3, 4, &[register], known);
                let Ok(value) = found[0].value else { continue };
                prop_assert!(found[0].scaled);
                let again = level.encode_point(point, value, known).unwrap();
                // A negative zero is a zero.
                prop_assert_eq!(level.decode_points(3, 4, &again, known)[0].value, Ok(value));
                prop_assert_eq!(level.encode_point_over(point, value, known, &[register]), Ok(again));
            }
        }

        #[test]
        fn no_registers_panic(function: u8, address: u16, registers in prop::collection::vec(any::<u16>(), 0..12), low: bool) {
            for id in ["lvdt", "gauge-cable", "level"] {
                let profile = built_in(id);
                let address = if low { address % 16 } else { address };
                let known = &mut Known::default();
                for found in profile.decode_points(function, address, &registers, known) {
                    prop_assert!(found.offset + found.point.encoding.registers() <= registers.len());
                }
            }
        }
    }
}
