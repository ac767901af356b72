//! Floats as text by whole-number arithmetic. The standard library's way is made for every format and every float; on a
//! web page it would be 20 KB of program.

use alloc::string::ToString;
use core::fmt;

/// The most digits that a double needs to be told from its neighbours.
const MOST_DIGITS: i32 = 17;

/// Bits of a double's fraction, and how many of them a single float lacks.
const FRACTION_BITS: u32 = 52;
const SINGLE_LACKS: u32 = 29;

/// Powers of ten, each the square of the one before.
const SQUARES: [f64; 9] = [1e1, 1e2, 1e4, 1e8, 1e16, 1e32, 1e64, 1e128, 1e256];

/// Writes a float with as many digits as tell it from other doubles, or from other single floats if it is one. From 1e12
/// on and below 1e-6 it gets an exponent: the digits of 1e300 would fill five lines. Of doubles from 1e37 on and below
/// 1e-22 the last of 17 digits may be off.
pub(super) fn write(f: &mut fmt::Formatter<'_>, value: f64, single: bool) -> fmt::Result {
    let size = value.abs();
    if value < 0.0 {
        f.write_str("-")?;
    }
    if size.is_nan() {
        f.write_str("NaN")
    } else if size.is_infinite() {
        f.write_str("inf")
    } else if size == 0.0 {
        f.write_str("0")
    } else if (1e-6..1e12).contains(&size) {
        let (digits, decimals) = plain(size, single);
        let digits = digits.to_string();
        for missing in 0..(decimals + 1).saturating_sub(digits.len()) {
            f.write_str(if missing == 0 { "0." } else { "0" })?;
        }
        match digits.len().checked_sub(decimals).filter(|whole| (1..digits.len()).contains(whole)) {
            Some(whole) => write!(f, "{}.{}", &digits[..whole], &digits[whole..]),
            None => f.write_str(&digits),
        }
    } else {
        let (digits, last) = scientific(size, single);
        let digits = digits.to_string();
        let exponent = last + i32::try_from(digits.len()).unwrap_or_default() - 1;
        let (first, more) = digits.trim_end_matches('0').split_at(1);
        write!(f, "{first}{}{more}e{exponent}", if more.is_empty() { "" } else { "." })
    }
}

/// The shortest decimal that lies nearer to a float of 1e-6 to 1e12 than to its neighbours, as its digits and how many of
/// them are decimals. Exact.
fn plain(size: f64, single: bool) -> (u64, usize) {
    let bits = size.to_bits();
    // Such a float is no subnormal, and less than its mantissa.
    let fraction = bits & ((1 << FRACTION_BITS) - 1);
    let (mantissa, halvings) = (u128::from(fraction | 1 << FRACTION_BITS), 1075 - (bits >> FRACTION_BITS));
    let lacks = if single { SINGLE_LACKS } else { 0 };
    let even = (mantissa >> lacks).is_multiple_of(2);
    let (mut scale, mut decimals) = (1_u128, 0);
    loop {
        // The float is mantissa / 2^halvings; at most 2^53 and 10^22 are multiplied here.
        let exact = mantissa * scale;
        let digits = (exact + (1 << (halvings - 1))) >> halvings;
        let back = digits << halvings;
        // Below a power of two the neighbours are twice as near. An even mantissa wins a tie.
        let off = back.abs_diff(exact) * if fraction == 0 && back < exact { 4 } else { 2 };
        let gap = scale << lacks;
        if off < gap || (off == gap && even) || decimals == 22 {
            // At most 17 digits.
            return (u64::try_from(digits).unwrap_or(u64::MAX), decimals);
        }
        (scale, decimals) = (scale * 10, decimals + 1);
    }
}

/// The shortest digits that give a float of another size back, and the last one's power of ten.
fn scientific(size: f64, single: bool) -> (u64, i32) {
    let (mut scaled, mut exponent) = (size, 0_i32);
    for (power, square) in SQUARES.iter().enumerate().rev() {
        if size >= 1.0 && scaled >= *square {
            (scaled, exponent) = (scaled / square, exponent + (1 << power));
        } else if size < 1.0 && scaled * square < 10.0 {
            (scaled, exponent) = (scaled * square, exponent - (1 << power));
        }
    }
    let (mut unit, mut last) = (1.0, exponent);
    loop {
        // Below 10^17.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let digits = (scaled * unit + 0.5) as u64;
        #[allow(clippy::cast_precision_loss)]
        let back = shifted(digits as f64, last);
        // To give the very same float back is the point.
        #[allow(clippy::cast_possible_truncation, clippy::float_cmp)]
        let same = if single { back as f32 == size as f32 } else { back == size };
        if same || exponent - last == MOST_DIGITS - 1 {
            return (digits, last);
        }
        (unit, last) = (unit * 10.0, last - 1);
    }
}

/// A float times a power of ten. Rounded only once up to 10^22, whose powers are exact.
fn shifted(mut float: f64, exponent: i32) -> f64 {
    let mut factor = 1.0;
    for (power, square) in SQUARES.iter().enumerate() {
        if exponent.unsigned_abs() >> power & 1 == 1 {
            // The largest one apart: together they may be too much.
            if power == SQUARES.len() - 1 {
                float = if exponent < 0 { float / square } else { float * square };
            } else {
                factor *= square;
            }
        }
    }
    if exponent < 0 { float / factor } else { float * factor }
}

#[cfg(test)]
mod tests {
    use alloc::format;
    use alloc::string::String;

    use proptest::prelude::*;

    use super::*;

    struct Shown(f64, bool);

    impl fmt::Display for Shown {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write(f, self.0, self.1)
        }
    }

    fn double(value: f64) -> String {
        format!("{}", Shown(value, false))
    }

    fn single(value: f32) -> String {
        format!("{}", Shown(value.into(), true))
    }

    #[test]
    fn limits_of_the_forms() {
        for (value, text) in [
            (1e-6, "0.000001"),
            (9.999e-7, "9.999e-7"),
            (1e12, "1e12"),
            (999_999_999_999.5, "999999999999.5"),
            (0.1 + 0.2, "0.30000000000000004"),
            (-1e300, "-1e300"),
            (5e-324, "5e-324"),
            (-2.0, "-2"),
            (1024.0, "1024"),
            (9.5, "9.5"),
        ] {
            assert_eq!(double(value), text);
        }
        assert_eq!(
            (single(0.1), single(16_777_216.0), single(f32::MAX)),
            ("0.1".into(), "16777216".into(), "3.4028235e38".into())
        );
    }

    proptest! {
        #[test]
        fn doubles_are_written_as_the_standard_library_does(mantissa in any::<u64>(), exponent in 1003_u64..=1062) {
            let value = f64::from_bits(exponent << 52 | mantissa >> 12);
            prop_assume!((1e-6..1e12).contains(&value));
            prop_assert_eq!(double(value), format!("{value}"));
        }

        #[test]
        fn every_double_of_another_size_comes_back_nearly(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let back: f64 = double(value).parse().unwrap();
            prop_assert!((back - value).abs() <= value.abs() * 4e-15);
        }

        #[test]
        fn every_single_float_comes_back(bits in any::<u32>()) {
            let value = f32::from_bits(bits);
            prop_assume!(value.is_finite());
            prop_assert_eq!(single(value).parse(), Ok(value));
        }

        #[test]
        fn short_decimals_stay_short(mantissa in -99_999_i32..=99_999, decimals in 0_i32..=6) {
            let text = format!("{}", f64::from(mantissa) / 10_f64.powi(decimals));
            prop_assert_eq!(single(text.parse().unwrap()), text.clone());
            prop_assert_eq!(double(text.parse().unwrap()), text);
        }
    }
}
