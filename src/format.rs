//! Numbers and bytes as people read them. Whole-number arithmetic only: the float formatter would cost the download more
//! than all of this.

/// U+2212, as wide as a plus sign; a hyphen is too short beside digits.
const MINUS: char = '\u{2212}';
/// U+202F between groups of three digits.
const GROUP: char = '\u{202F}';

/// A number with a fixed count of decimals (at most 9) and a real minus sign; an en dash if it is no number.
pub(crate) fn fixed(value: f64, decimals: u8) -> String {
    let decimals = decimals.min(9);
    let scaled = (value * f64::from(10_u32.pow(u32::from(decimals)))).round();
    if !scaled.is_finite() || scaled.abs() > 9e15 {
        return String::from("\u{2013}");
    }
    // In range: checked above.
    #[allow(clippy::cast_possible_truncation)]
    let scaled = scaled as i64;
    let digits = scaled.unsigned_abs().to_string();
    let places = usize::from(decimals);
    let mut text = String::new();
    if scaled < 0 {
        text.push(MINUS);
    }
    for _ in digits.len()..=places {
        text.push('0');
    }
    text.push_str(&digits);
    if places > 0 {
        text.insert(text.len() - places, '.');
    }
    text
}

/// A number's text with a real minus sign.
pub(crate) fn signed(text: &str) -> String {
    text.replacen('-', "\u{2212}", 1)
}

/// A count in groups of three digits.
pub(crate) fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len());
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(GROUP);
        }
        text.push(digit);
    }
    text
}

/// Milliseconds for a time in microseconds: one decimal below 100 ms.
pub(crate) fn milliseconds(microseconds: u32) -> String {
    let value = f64::from(microseconds) / 1000.0;
    let mut text = fixed(value, u8::from(value < 100.0));
    text.push_str(" ms");
    text
}

/// Readings per second: two significant decimals below 10, one below 100, without needless zeros.
pub(crate) fn rate(per_second: f64) -> String {
    let decimals = if per_second < 10.0 { 2 } else { 1 };
    let text = fixed(per_second, decimals);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A time in microseconds as `10:21:33.482`; of an epoch the time of its day. Tenths of milliseconds where there are any.
pub(crate) fn clock(time_us: u64) -> String {
    let of_day = time_us % 86_400_000_000;
    let seconds = of_day / 1_000_000;
    let mut text = String::new();
    let mut push = |value: u64, width: usize, before: &str| {
        text.push_str(before);
        let digits = value.to_string();
        for _ in digits.len()..width {
            text.push('0');
        }
        text.push_str(&digits);
    };
    push(seconds / 3600, 2, "");
    push(seconds / 60 % 60, 2, ":");
    push(seconds % 60, 2, ":");
    let tenths = of_day % 1_000_000 / 100;
    let (fraction, width) = if tenths.is_multiple_of(10) { (tenths / 10, 3) } else { (tenths, 4) };
    push(fraction, width, ".");
    text
}

/// Bytes as the list of a C program: `{0x01, 0x03}`.
pub(crate) fn c_array(bytes: &[u8]) -> String {
    let mut text = "{".to_owned();
    for (at, byte) in bytes.iter().enumerate() {
        text.push_str(if at > 0 { ", 0x" } else { "0x" });
        push_hex(&mut text, &[*byte]);
    }
    text.push('}');
    text
}

/// A byte as two digits.
pub(crate) fn hex(byte: u8) -> String {
    let mut text = String::new();
    push_hex(&mut text, &[byte]);
    text
}

/// Bytes as pairs of digits with spaces between.
pub(crate) fn hex_spaced(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len() * 3);
    for (at, byte) in bytes.iter().enumerate() {
        if at > 0 {
            text.push(' ');
        }
        push_hex(&mut text, &[*byte]);
    }
    text
}

/// Appends bytes as pairs of digits.
pub(crate) fn push_hex(text: &mut String, bytes: &[u8]) {
    for byte in bytes {
        for digit in [byte >> 4, byte & 0x0F] {
            text.push(char::from(b"0123456789ABCDEF"[usize::from(digit)]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_keeps_zeros_and_the_sign_of_small_values() {
        assert_eq!(fixed(-0.328, 3), "\u{2212}0.328");
        assert_eq!(fixed(12.0, 3), "12.000");
        assert_eq!(fixed(25.55, 1), "25.6");
        assert_eq!(fixed(-0.0004, 3), "0.000");
        assert_eq!(fixed(7.0, 0), "7");
        assert_eq!(fixed(f64::NAN, 2), "\u{2013}");
        assert_eq!(fixed(f64::INFINITY, 2), "\u{2013}");
    }

    #[test]
    fn counts_are_grouped() {
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(18_204), "18\u{202F}204");
        assert_eq!(count(1_234_567), "1\u{202F}234\u{202F}567");
    }

    #[test]
    fn times_and_rates_are_short() {
        assert_eq!(milliseconds(41_260), "41.3 ms");
        assert_eq!(milliseconds(412_600), "413 ms");
        assert_eq!(rate(25.0), "25");
        assert_eq!(rate(24.83), "24.8");
        assert_eq!(rate(0.25), "0.25");
        assert_eq!(rate(10.0), "10");
    }

    #[test]
    fn clocks_show_as_many_decimals_as_there_are() {
        assert_eq!(clock(37_293_482_000), "10:21:33.482");
        assert_eq!(clock(37_293_482_300), "10:21:33.4823");
        assert_eq!(clock(1_714_557_693_000_000), "10:01:33.000");
    }

    #[test]
    fn bytes_are_upper_case_pairs() {
        assert_eq!(c_array(&[0x0C, 0xFF]), "{0x0C, 0xFF}");
        assert_eq!(hex_spaced(&[0x0C, 0xFF, 0x00]), "0C FF 00");
        assert_eq!(hex(0xA1), "A1");
    }
}
