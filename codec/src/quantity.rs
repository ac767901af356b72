//! Units of measure that are told in one another: what a value is in another unit of the same quantity.
//!
//! The unit decides, not the device: whatever says `mH₂O`, in a profile or by a register, can be told in kPa. Factors are
//! exact ratios. Sources: The International System of Units (9th edition) for pascal, bar, metre and degree Celsius; NIST
//! SP 811 (2008), appendix B, for kgf/cm² (98 066.5 Pa), psi (of 0.453 592 37 kg, 9.806 65 m/s² and 25.4 mm), the
//! conventional columns of water (9806.65 Pa a metre, which is 1000 kg/m³), inch and degree Fahrenheit.

use serde::{Deserialize, Serialize};

use crate::value::{Decimal, Value, greatest_common_divisor};

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Quantity {
    /// Also a level of water, told as the pressure at its ground.
    Pressure,
    /// A length, a displacement.
    Length,
    /// A temperature; no difference of two.
    Temperature,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Pressure, Self::Length, Self::Temperature];

    /// Its units, in the order in which they are offered.
    pub const fn units(self) -> &'static [Unit] {
        use Unit::{
            Bar, Celsius, Fahrenheit, Inch, KgfPerCm2, Kilopascal, Megapascal, Metre, MetreOfWater, Micrometre,
            Millibar, Millimetre, MillimetreOfWater, Pascal, Psi,
        };
        match self {
            Self::Pressure => {
                &[Megapascal, Kilopascal, Pascal, Bar, Millibar, KgfPerCm2, Psi, MetreOfWater, MillimetreOfWater]
            }
            Self::Length => &[Metre, Millimetre, Micrometre, Inch],
            Self::Temperature => &[Celsius, Fahrenheit],
        }
    }
}

/// A unit that can be told in others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Unit {
    /// Megapascal.
    Megapascal,
    /// kPa.
    Kilopascal,
    /// Pa.
    Pascal,
    /// bar, 100 kPa.
    Bar,
    /// mbar, 100 Pa.
    Millibar,
    /// kg/cm², a technical atmosphere: 98 066.5 Pa.
    KgfPerCm2,
    /// psi, pound-force on a square inch: 6894.757 Pa.
    Psi,
    /// mH₂O, conventional metre of water: 9806.65 Pa.
    MetreOfWater,
    /// mmH₂O, conventional millimetre of water: 9.806 65 Pa.
    MillimetreOfWater,
    /// m.
    Metre,
    /// mm.
    Millimetre,
    /// µm.
    Micrometre,
    /// in, 25.4 mm.
    Inch,
    /// °C.
    Celsius,
    /// °F.
    Fahrenheit,
}

impl Unit {
    /// The unit that a text names, as [`Unit::symbol`] writes it or as it is written without special characters (`kg/cm2`,
    /// `mH2O`, `um`, `inch`); `None` for units that cannot be converted.
    pub fn named(text: &str) -> Option<Self> {
        match text {
            "kg/cm2" | "kgf/cm²" | "kgf/cm2" => return Some(Self::KgfPerCm2),
            "mH2O" => return Some(Self::MetreOfWater),
            "mmH2O" => return Some(Self::MillimetreOfWater),
            // With the Greek letter instead of the micro sign.
            "um" | "\u{3BC}m" => return Some(Self::Micrometre),
            "inch" => return Some(Self::Inch),
            "℃" => return Some(Self::Celsius),
            "℉" => return Some(Self::Fahrenheit),
            _ => {}
        }
        Quantity::ALL.into_iter().flat_map(Quantity::units).copied().find(|unit| unit.symbol() == text)
    }

    /// As it stands behind a value.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Megapascal => "MPa",
            Self::Kilopascal => "kPa",
            Self::Pascal => "Pa",
            Self::Bar => "bar",
            Self::Millibar => "mbar",
            Self::KgfPerCm2 => "kg/cm²",
            Self::Psi => "psi",
            Self::MetreOfWater => "mH₂O",
            Self::MillimetreOfWater => "mmH₂O",
            Self::Metre => "m",
            Self::Millimetre => "mm",
            Self::Micrometre => "µm",
            Self::Inch => "in",
            Self::Celsius => "°C",
            Self::Fahrenheit => "°F",
        }
    }

    /// What it measures.
    pub const fn quantity(self) -> Quantity {
        match self {
            Self::Megapascal
            | Self::Kilopascal
            | Self::Pascal
            | Self::Bar
            | Self::Millibar
            | Self::KgfPerCm2
            | Self::Psi
            | Self::MetreOfWater
            | Self::MillimetreOfWater => Quantity::Pressure,
            Self::Metre | Self::Millimetre | Self::Micrometre | Self::Inch => Quantity::Length,
            Self::Celsius | Self::Fahrenheit => Quantity::Temperature,
        }
    }

    /// How it becomes pascal, micrometre or degree Celsius.
    const fn to_base(self) -> Line {
        match self {
            Self::Megapascal | Self::Metre => Line::times(1_000_000, 1),
            Self::Kilopascal | Self::Millimetre => Line::times(1000, 1),
            Self::Pascal | Self::Micrometre | Self::Celsius => Line::times(1, 1),
            Self::Bar => Line::times(100_000, 1),
            Self::Millibar => Line::times(100, 1),
            Self::KgfPerCm2 => Line::times(196_133, 2),
            // 0.453 592 37 · 9.806 65 / 0.0254².
            Self::Psi => Line::times(8_896_443_230_521, 1_290_320_000),
            Self::MetreOfWater => Line::times(196_133, 20),
            Self::MillimetreOfWater => Line::times(196_133, 20_000),
            Self::Inch => Line::times(25_400, 1),
            Self::Fahrenheit => Line { factor: 5, offset: -160, divisor: 9 },
        }
    }
}

/// A value in another unit of the same quantity; `None` for units of two quantities. In the same unit it is the same.
pub fn convert(value: f64, from: Unit, to: Unit) -> Option<f64> {
    let line = Line::between(from, to)?;
    if from == to {
        return Some(value);
    }
    Some((value * float(line.factor) + float(line.offset)) / float(line.divisor))
}

/// The same for an exact decimal. It gets as many digits behind the point as its own last digit is worth in the other
/// unit: 1.234 mm is 0.04858 in and 1234 µm. `None` also for what no longer fits.
pub fn convert_decimal(value: Decimal, from: Unit, to: Unit) -> Option<Decimal> {
    let line = Line::between(from, to)?;
    if from == to {
        return Some(value);
    }
    let decimals = decimals_in(value.decimals, from, to)?;
    // (mantissa / 10^own · factor + offset) / divisor, in steps of 10^-decimals, rounded half away from zero.
    let own = 10i128.checked_pow(value.decimals.into())?;
    let steps = 10i128.checked_pow(decimals.into())?;
    let sum = i128::from(value.mantissa).checked_mul(line.factor)?.checked_add(line.offset.checked_mul(own)?)?;
    let divisor = line.divisor.checked_mul(own)?;
    let shared = greatest_common_divisor(steps, divisor);
    let (steps, divisor) = (steps / shared, divisor / shared);
    let (scaled, half) = (sum.checked_mul(steps)?, divisor / 2);
    let rounded = if scaled < 0 { scaled.checked_sub(half)? } else { scaled.checked_add(half)? } / divisor;
    Some(Decimal { mantissa: i64::try_from(rounded).ok()?, decimals })
}

/// The same for a value of a point: decimals stay exact, floats floats; `None` also for codes and texts.
pub fn convert_value(value: Value, from: Unit, to: Unit) -> Option<Value> {
    match value {
        Value::Number(number) => convert_decimal(number, from, to).map(Value::Number),
        #[allow(clippy::cast_possible_truncation)] // as exact as it came
        Value::Float(float) => convert(float.into(), from, to).map(|float| Value::Float(float as f32)),
        Value::Double(float) => convert(float, from, to).map(Value::Double),
        Value::Code(_) | Value::Text(_) => None,
    }
}

/// How many digits behind the point tell all that this many told in the first unit, at most [`Decimal::MAX_DECIMALS`];
/// `None` for units of two quantities.
pub fn decimals_in(decimals: u8, from: Unit, to: Unit) -> Option<u8> {
    let line = Line::between(from, to)?;
    // The last digit is worth factor / (divisor · 10^decimals): the first power of ten that is not above it.
    let worth = |places: u32| line.factor.checked_mul(10i128.checked_pow(places)?);
    let digit = line.divisor.checked_mul(10i128.checked_pow(decimals.into())?)?;
    let enough = |places: &u8| worth((*places).into()).is_none_or(|worth| worth >= digit);
    Some((0..Decimal::MAX_DECIMALS).find(enough).unwrap_or(Decimal::MAX_DECIMALS))
}

/// (value · factor + offset) / divisor, in lowest terms; factor and divisor above 0.
#[derive(Clone, Copy)]
struct Line {
    factor: i128,
    offset: i128,
    divisor: i128,
}

impl Line {
    const fn times(factor: i128, divisor: i128) -> Self {
        Self { factor, offset: 0, divisor }
    }

    fn between(from: Unit, to: Unit) -> Option<Self> {
        if from.quantity() != to.quantity() {
            return None;
        }
        let (first, second) = (from.to_base(), to.to_base());
        let factor = first.factor * second.divisor;
        let offset = first.offset * second.divisor - second.offset * first.divisor;
        let divisor = first.divisor * second.factor;
        let shared = greatest_common_divisor(greatest_common_divisor(factor, offset), divisor);
        Some(Self { factor: factor / shared, offset: offset / shared, divisor: divisor / shared })
    }
}

#[allow(clippy::cast_precision_loss)] // no part of a ratio has more than 53 bits that count
fn float(number: i128) -> f64 {
    number as f64
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use proptest::prelude::*;

    use super::*;

    fn units() -> impl Iterator<Item = Unit> {
        Quantity::ALL.into_iter().flat_map(Quantity::units).copied()
    }

    #[test]
    fn published_factors_come_out() {
        // NIST SP 811 (2008), appendix B.8 and B.9, to its seven digits.
        let published = [
            (Unit::Psi, Unit::Pascal, 6.894_757e3),
            (Unit::Psi, Unit::Kilopascal, 6.894_757),
            (Unit::KgfPerCm2, Unit::Pascal, 9.806_65e4),
            (Unit::KgfPerCm2, Unit::Kilopascal, 98.0665),
            (Unit::MillimetreOfWater, Unit::Pascal, 9.806_65),
            (Unit::MetreOfWater, Unit::Pascal, 9806.65),
            (Unit::Bar, Unit::Kilopascal, 100.0),
            (Unit::Bar, Unit::Pascal, 1e5),
            (Unit::Bar, Unit::Psi, 14.503_77),
            (Unit::Millibar, Unit::Kilopascal, 0.1),
            (Unit::Millibar, Unit::Pascal, 100.0),
            (Unit::Megapascal, Unit::Pascal, 1e6),
            (Unit::Megapascal, Unit::Psi, 145.0377),
            (Unit::MetreOfWater, Unit::MillimetreOfWater, 1000.0),
            (Unit::KgfPerCm2, Unit::MetreOfWater, 10.0),
            (Unit::Inch, Unit::Millimetre, 25.4),
            (Unit::Metre, Unit::Inch, 39.370_08),
            (Unit::Millimetre, Unit::Micrometre, 1000.0),
        ];
        for (from, to, factor) in published {
            let found = convert(1.0, from, to).unwrap();
            assert!((found / factor - 1.0).abs() < 1e-6, "1 {} = {found} {}", from.symbol(), to.symbol());
        }
        // More digits than any table prints: 4.448 221 615 260 5 N on 6.4516 cm².
        assert_eq!(convert(1.0, Unit::Psi, Unit::Pascal), Some(6_894.757_293_168_362));
        for (fahrenheit, celsius) in [(32.0, 0.0), (212.0, 100.0), (-40.0, -40.0), (98.6, 37.0)] {
            let found = convert(fahrenheit, Unit::Fahrenheit, Unit::Celsius).unwrap();
            assert!((found - celsius).abs() < 1e-12, "{fahrenheit} °F = {found} °C");
            assert!((convert(celsius, Unit::Celsius, Unit::Fahrenheit).unwrap() - fahrenheit).abs() < 1e-12);
        }
    }

    #[test]
    fn decimals_keep_what_their_last_digit_is_worth() {
        let cases = [
            ("1.234", Unit::Millimetre, Unit::Micrometre, "1234"),
            ("1.234", Unit::Millimetre, Unit::Inch, "0.04858"),
            ("-0.328", Unit::Millimetre, Unit::Micrometre, "-328"),
            ("25.5", Unit::Celsius, Unit::Fahrenheit, "77.9"),
            ("-0.1", Unit::Celsius, Unit::Fahrenheit, "31.8"),
            ("77.9", Unit::Fahrenheit, Unit::Celsius, "25.50"),
            ("6.000", Unit::MetreOfWater, Unit::MillimetreOfWater, "6000"),
            ("6.000", Unit::MetreOfWater, Unit::Kilopascal, "58.840"),
            ("6000", Unit::MillimetreOfWater, Unit::MetreOfWater, "6.000"),
            ("100", Unit::Pascal, Unit::Megapascal, "0.000100"),
            ("1", Unit::Megapascal, Unit::Pascal, "1000000"),
            ("0.05", Unit::Bar, Unit::Bar, "0.05"),
        ];
        for (value, from, to, text) in cases {
            let found = convert_decimal(Decimal::parse(value).unwrap(), from, to).unwrap();
            assert_eq!(found.to_string(), text, "{value} {}", from.symbol());
        }
        assert_eq!(convert_decimal(Decimal::whole(i64::MAX), Unit::Megapascal, Unit::Pascal), None);
    }

    #[test]
    fn units_are_known_by_every_usual_spelling_and_no_other() {
        for unit in units() {
            assert_eq!(Unit::named(unit.symbol()), Some(unit));
            assert!(unit.quantity().units().contains(&unit), "{unit:?}");
        }
        for (text, unit) in [("mH2O", Unit::MetreOfWater), ("kg/cm2", Unit::KgfPerCm2), ("um", Unit::Micrometre)] {
            assert_eq!(Unit::named(text), Some(unit));
        }
        for text in ["", "Hz", "Mpa", "mm ", "V"] {
            assert_eq!(Unit::named(text), None, "{text}");
        }
    }

    #[test]
    fn what_is_no_number_or_another_quantity_has_no_conversion() {
        assert_eq!(convert(1.0, Unit::Bar, Unit::Millimetre), None);
        assert_eq!(convert_decimal(Decimal::whole(1), Unit::Celsius, Unit::Psi), None);
        assert_eq!(decimals_in(3, Unit::Metre, Unit::Bar), None);
        assert_eq!(convert_value(Value::Code(1), Unit::Bar, Unit::Pascal), None);
        assert_eq!(convert_value(Value::Float(1.5), Unit::Bar, Unit::Kilopascal), Some(Value::Float(150.0)));
    }

    proptest! {
        #[test]
        fn there_and_back_is_the_same(value in -1e6..1e6, from in prop::sample::select(units().collect::<alloc::vec::Vec<_>>())) {
            for to in from.quantity().units() {
                let there = convert(value, from, *to).unwrap();
                let back = convert(there, *to, from).unwrap();
                prop_assert!((back - value).abs() <= 1e-9 * value.abs().max(1.0), "{value} {from:?} {to:?} {back}");
            }
        }

        #[test]
        fn decimals_and_floats_agree(mantissa in -9_999_999i64..9_999_999, decimals in 0u8..6, from in prop::sample::select(units().collect::<alloc::vec::Vec<_>>())) {
            let exact = Decimal { mantissa, decimals };
            for to in from.quantity().units() {
                let float = convert(exact.to_f64(), from, *to).unwrap();
                let decimal = convert_decimal(exact, from, *to).unwrap();
                let step = 10f64.powi(-i32::from(decimal.decimals));
                prop_assert!((decimal.to_f64() - float).abs() <= 0.5001 * step + 1e-9 * float.abs(), "{exact} {from:?} {to:?} {decimal}");
                // And back: nothing that the device told is lost.
                let back = convert_decimal(decimal, *to, from).unwrap();
                prop_assert!((back.to_f64() - exact.to_f64()).abs() <= 0.5001 * 10f64.powi(-i32::from(decimals)) + 1e-9 * exact.to_f64().abs());
            }
        }

        #[test]
        fn no_decimal_panics(mantissa: i64, decimals: u8, from in prop::sample::select(units().collect::<alloc::vec::Vec<_>>())) {
            for to in units() {
                let _ = (convert_decimal(Decimal { mantissa, decimals }, from, to), decimals_in(decimals, from, to));
            }
        }
    }
}
