//! Texts of fields as numbers, lists and bytes. Decimal, or hexadecimal with `0x`; marks between entries may be Chinese.

use buslens_codec::intake::{IntakeError, IntakeFault};
use buslens_codec::pdu::DeviceIdObject;

use super::Fault;

/// The least that a register takes, as a two's complement.
pub(crate) const FIRST: i32 = -0x8000;
/// The most that a register takes.
pub(crate) const LAST: i32 = 0xFFFF;

/// A whole number: `50`, `0x32`, `-1`.
pub(crate) fn number(text: &str) -> Option<i32> {
    let text = text.trim();
    let (negative, digits) = text.strip_prefix(['-', '\u{2212}']).map_or((false, text), |rest| (true, rest));
    let (digits, radix) =
        digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")).map_or((digits, 10), |rest| (rest, 16));
    if !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let number = i32::from_str_radix(digits, radix).ok()?;
    Some(if negative { -number } else { number })
}

/// The 16 bits of a number from [`FIRST`] to [`LAST`].
pub(crate) fn word(number: i32) -> u16 {
    u16::try_from(number & 0xFFFF).unwrap_or_default()
}

/// The low byte.
pub(crate) const fn low(word: u16) -> u8 {
    word.to_le_bytes()[0]
}

/// Registers.
pub(super) fn words(text: &str) -> Result<Vec<u16>, Fault> {
    numbers(text, FIRST)
}

/// Coils: any row of 0 and 1.
pub(super) fn bits(text: &str) -> Result<Vec<bool>, Fault> {
    let bit = |c| match c {
        '0' => Ok(false),
        '1' => Ok(true),
        _ => Err(Fault::Bit),
    };
    text.chars().filter(|c| !is_gap(*c)).map(bit).collect()
}

/// Bytes as pairs of hexadecimal digits; a lone digit is a byte too.
pub(super) fn bytes(text: &str) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let mut column = 1;
        for entry in line.split_inclusive(is_gap) {
            let digits = entry.trim_end_matches(is_gap);
            let digits = digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")).unwrap_or(digits);
            let prefix = entry.trim_end_matches(is_gap).chars().count() - digits.chars().count();
            let fault =
                |at: usize, fault| Fault::Hex(IntakeError { line: number + 1, column: column + prefix + at, fault });
            if let Some((at, stray)) = digits.chars().enumerate().find(|(_, c)| !c.is_ascii_hexdigit()) {
                return Err(fault(at, IntakeFault::Unexpected(stray)));
            }
            if digits.len() > 1 && digits.len() % 2 != 0 {
                return Err(fault(0, IntakeFault::OddDigits));
            }
            let pair = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
            bytes.extend(digits.as_bytes().chunks(2).filter_map(pair));
            column += entry.chars().count();
        }
    }
    Ok(bytes)
}

/// Numbers line by line, in each line at least so many.
pub(super) fn lines(text: &str, least: usize) -> Result<Vec<Vec<u16>>, Fault> {
    let line = |(at, line): (usize, &str)| match numbers(line, 0) {
        Ok(words) if words.len() >= least => Ok(words),
        _ => Err(Fault::Line(at + 1)),
    };
    text.trim().lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).map(line).collect()
}

/// Objects line by line: number, then text.
pub(super) fn objects(text: &str) -> Result<Vec<DeviceIdObject>, Fault> {
    let line = |(at, line): (usize, &str)| {
        let line = line.trim();
        let (id, value) = line.split_once(is_gap).unwrap_or((line, ""));
        let id = number(id).and_then(|id| u8::try_from(id).ok()).ok_or(Fault::Line(at + 1))?;
        Ok(DeviceIdObject { id, value: value.trim().as_bytes().to_vec() })
    };
    text.trim().lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).map(line).collect()
}

fn numbers(text: &str, first: i32) -> Result<Vec<u16>, Fault> {
    let entry = |(at, entry): (usize, &str)| {
        let number = number(entry).filter(|number| (first..=LAST).contains(number));
        number.map(word).ok_or(Fault::Item { at: at + 1, first, last: LAST })
    };
    text.split(is_gap).filter(|entry| !entry.is_empty()).enumerate().map(entry).collect()
}

fn is_gap(c: char) -> bool {
    c.is_whitespace() || matches!(c, ',' | ';' | '，' | '；' | '、')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_decimal_or_hexadecimal() {
        for (text, wanted) in [
            ("50", Some(50)),
            (" 0x32 ", Some(0x32)),
            ("0XfF", Some(255)),
            ("-1", Some(-1)),
            ("\u{2212}0x10", Some(-16)),
        ] {
            assert_eq!(number(text), wanted, "{text}");
        }
        for wrong in ["", "0x", "1F", "+1", "--1", "1.5", "1 2", "一", "99999999999", "0x-1"] {
            assert_eq!(number(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn lists_take_any_mark_between_their_entries() {
        assert_eq!(words("1, 0x2；-1\n4"), Ok(vec![1, 2, 0xFFFF, 4]));
        assert_eq!(words("1 2 65536"), Err(Fault::Item { at: 3, first: FIRST, last: LAST }));
        assert_eq!(words(" "), Ok(Vec::new()));
        assert_eq!(bits("10 1,0"), Ok(vec![true, false, true, false]));
        assert_eq!(bits("102"), Err(Fault::Bit));
        assert_eq!(bytes("FF00 0x12"), Ok(vec![0xFF, 0, 0x12]));
        assert_eq!(bytes(""), Ok(Vec::new()));
        assert!(matches!(bytes("FFF"), Err(Fault::Hex(_))));
    }

    #[test]
    fn lines_tell_which_one_is_wrong() {
        assert_eq!(lines("4 1 2\n\n3 9 2", 3), Ok(vec![vec![4, 1, 2], vec![3, 9, 2]]));
        assert_eq!(lines("4 1 2\n3 9", 3), Err(Fault::Line(2)));
        assert_eq!(lines("4 1 -2", 3), Err(Fault::Line(1)));
        let object = DeviceIdObject { id: 0x80, value: b"a b".to_vec() };
        assert_eq!(objects("0x80 a b "), Ok(vec![object]));
        assert_eq!(objects("0 a\n256 b"), Err(Fault::Line(2)));
    }
}
