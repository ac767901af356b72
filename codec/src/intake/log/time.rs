//! Time stamps: time of day, dates, seconds with a fraction.

use super::super::line::{is_space, starts_with};

const DAY_US: u64 = 86_400_000_000;

/// A stamp or a part of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stamp {
    /// Microseconds from 1970 to the beginning of a day; `None` where it cannot be told whether day or month comes first.
    Date(Option<u64>),
    /// Microseconds since midnight.
    Time(u64),
    /// A number of seconds, in microseconds.
    Seconds(u64),
}

/// The stamp that begins at `at`, and where it ends. `at` is the first character of a word.
pub(super) fn stamp(codes: &[u8], at: usize) -> Option<(Stamp, usize)> {
    let (first, end) = number(codes, at, 10)?;
    match codes.get(end)? {
        b'-' | b'/' => date(codes, at, first, end),
        b'.' => date(codes, at, first, end).or_else(|| seconds(codes, at)),
        b':' => time(codes, at, first, end),
        _ => None,
    }
}

/// `2024-05-01`, `2024/5/1`, `1.5.2024`, `5/1/2024`.
fn date(codes: &[u8], at: usize, first: u64, end: usize) -> Option<(Stamp, usize)> {
    let sign = *codes.get(end)?;
    let (second, middle) = number(codes, end + 1, 2)?;
    if codes.get(middle) != Some(&sign) {
        return None;
    }
    let (third, last) = number(codes, middle + 1, 4)?;
    let first_digits = end - at;
    let (year, month, day) = match (first_digits, last - middle - 1) {
        (4, 1..=2) => (first, second, third),
        (1..=2, 4) if sign == b'.' => (third, second, first),
        (1..=2, 4) => {
            let plausible = (1..=31).contains(&first) && (1..=31).contains(&second) && (1970..=2199).contains(&third);
            return plausible.then_some((Stamp::Date(None), after_date(codes, last)?));
        }
        _ => return None,
    };
    let plausible = (1970..=2199).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day);
    if !plausible {
        return None;
    }
    Some((Stamp::Date(Some(days(year, month, day) * DAY_US)), after_date(codes, last)?))
}

/// Behind a date, a `T` before the time goes with it; a letter or a digit makes it no date.
fn after_date(codes: &[u8], at: usize) -> Option<usize> {
    match codes.get(at) {
        Some(b'T') if codes.get(at + 1).is_some_and(u8::is_ascii_digit) => Some(at + 1),
        Some(code) if code.is_ascii_alphanumeric() => None,
        _ => Some(at),
    }
}

/// Days from 1970-01-01 to a day not before it, in the Gregorian calendar; the year begins in March for the leap day to be
/// its last.
fn days(year: u64, month: u64, day: u64) -> u64 {
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let before = year * 365 + year / 4 - year / 100 + year / 400 + (month * 153 + 2) / 5 + day;
    before.saturating_sub(719_469)
}

/// `10:21:33`, with `.482`, `,482` or `:482`, a zone, `AM` or `PM`; `21:33.482`.
fn time(codes: &[u8], at: usize, first: u64, end: usize) -> Option<(Stamp, usize)> {
    if end - at > 2 {
        return None;
    }
    let (second, middle) = number(codes, end + 1, 2)?;
    if middle != end + 3 {
        return None;
    }
    let (hours, minutes, seconds, mut end) = match codes.get(middle) {
        Some(b':') => {
            let (third, last) = number(codes, middle + 1, 2)?;
            (first, second, third, if last == middle + 3 { last } else { return None })
        }
        Some(b'.') => (0, first, second, middle),
        _ => return None,
    };
    let mut fraction_us = 0;
    if let Some(sign @ (b'.' | b',' | b':')) = codes.get(end)
        && let Some((us, after)) = fraction(codes, end + 1)
        && (*sign == b'.' || matches!(after - end - 1, 3 | 6))
        && (!is_word(codes, after) || matches!(codes.get(after), Some(b'Z')))
    {
        (fraction_us, end) = (us, after);
    }
    let mut hours = hours;
    let half = end + usize::from(codes.get(end).is_some_and(|code| is_space(*code)));
    if codes.get(half + 1).is_some_and(|code| code.eq_ignore_ascii_case(&b'M')) && !is_word(codes, half + 2) {
        match codes.get(half) {
            Some(b'A' | b'a') => (hours, end) = (hours % 12, half + 2),
            Some(b'P' | b'p') => (hours, end) = (hours % 12 + 12, half + 2),
            _ => {}
        }
    }
    end = zone(codes, end);
    // More groups: these are bytes with colons between them.
    let more = codes.get(end) == Some(&b':') && codes.get(end + 1).is_some_and(u8::is_ascii_hexdigit);
    if hours > 23 || minutes > 59 || seconds > 60 || more && !starts_with(codes, end, b"::") || is_word(codes, end) {
        return None;
    }
    Some((Stamp::Time(((hours * 60 + minutes) * 60 + seconds) * 1_000_000 + fraction_us), end))
}

/// Skips `Z` or `+08:00`: a stamp counts on its own clock.
fn zone(codes: &[u8], at: usize) -> usize {
    match codes.get(at) {
        Some(b'Z') => at + 1,
        Some(b'+' | b'-') => match number(codes, at + 1, 4) {
            Some((_, end)) if end == at + 3 && codes.get(end) == Some(&b':') => {
                number(codes, end + 1, 2).map_or(at, |(_, end)| end)
            }
            Some((_, end)) if end == at + 5 => end,
            _ => at,
        },
        _ => at,
    }
}

/// `1714557693.482`: a number with a fraction is no byte, and at the head of a line it is a time.
fn seconds(codes: &[u8], at: usize) -> Option<(Stamp, usize)> {
    let (seconds, end) = number(codes, at, 10)?;
    let (us, end) = fraction(codes, end + 1)?;
    let end = end + usize::from(codes.get(end) == Some(&b's'));
    let goes_on = is_word(codes, end) || (codes.get(end) == Some(&b'.') && is_word(codes, end + 1));
    (!goes_on).then_some((Stamp::Seconds(seconds * 1_000_000 + us), end))
}

/// One to nine digits behind a point, in microseconds.
fn fraction(codes: &[u8], at: usize) -> Option<(u64, usize)> {
    let (_, end) = number(codes, at, 9)?;
    let digits = codes.get(at..end)?.iter().chain(core::iter::repeat(&b'0')).take(6);
    let us = digits.fold(0, |us, digit| us * 10 + u64::from(digit - b'0'));
    Some((us, end))
}

/// The decimal number at `at`, of at most `most` digits, and where it ends.
fn number(codes: &[u8], at: usize, most: usize) -> Option<(u64, usize)> {
    let digits = codes.iter().skip(at).take(most + 1).take_while(|code| code.is_ascii_digit()).count();
    let text = codes.get(at..at + digits).filter(|_| (1..=most).contains(&digits))?;
    Some((text.iter().fold(0, |value, digit| value * 10 + u64::from(digit - b'0')), at + digits))
}

fn is_word(codes: &[u8], at: usize) -> bool {
    codes.get(at).is_some_and(|code| code.is_ascii_alphanumeric() || *code == b'_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, expected: Option<(Stamp, &str)>) {
        let found = stamp(text.as_bytes(), 0).map(|(stamp, end)| (stamp, &text[end..]));
        assert_eq!(found, expected, "{text}");
    }

    #[test]
    fn times_of_day() {
        let time = |us, rest| Some((Stamp::Time(us), rest));
        check("10:21:33", time(37_293_000_000, ""));
        check("10:21:33.482] 01", time(37_293_482_000, "] 01"));
        check("10:21:33,482 01", time(37_293_482_000, " 01"));
        check("10:21:33:482 - 01", time(37_293_482_000, " - 01"));
        check("10:21:33.4", time(37_293_400_000, ""));
        check("10:21:33.482123Z", time(37_293_482_123, ""));
        check("10:21:33.482+08:00 x", time(37_293_482_000, " x"));
        check("9:21:33 PM 01", time(76_893_000_000, " 01"));
        check("21:33.482 01", time(1_293_482_000, " 01"));
        check("10:21:33, 01 03", time(37_293_000_000, ", 01 03"));
        check("10:21:33,01 03", time(37_293_000_000, ",01 03"));
        check("10:21:33,0103D5C5", time(37_293_000_000, ",0103D5C5"));
    }

    #[test]
    fn seconds_with_a_fraction() {
        let seconds = |us, rest| Some((Stamp::Seconds(us), rest));
        check("1714557693.482) can0", seconds(1_714_557_693_482_000, ") can0"));
        check("0.000123 01", seconds(123, " 01"));
        check("12.5s 01", seconds(12_500_000, " 01"));
    }

    #[test]
    fn dates() {
        let day = 1_714_521_600_000_000;
        let date = |us, rest| Some((Stamp::Date(us), rest));
        check("2024-05-01 10:00:00", date(Some(day), " 10:00:00"));
        check("2024/5/1 10", date(Some(day), " 10"));
        check("2024-05-01T10:00:00Z", date(Some(day), "10:00:00Z"));
        check("01.05.2024 10", date(Some(day), " 10"));
        check("1/5/2024 10:21", date(None, " 10:21"));
        check("1970-01-01", date(Some(0), ""));
        check("2000-02-29", date(Some(951_782_400_000_000), ""));
        check("2000-03-01", date(Some(951_868_800_000_000), ""));
    }

    #[test]
    fn bytes_and_addresses_are_no_times() {
        for text in [
            "01:03:00:31:00:01:D5:C5",
            "01-03-00-31-00-01-D5-C5",
            "01:03:00:31",
            "25:03:00",
            "192.168.1.10:502",
            "01 03",
            "12:3",
            "1.2.3",
            "2024-05-010",
            // There is no year before it to which January and February could belong.
            "0000-02-01",
        ] {
            check(text, None);
        }
    }
}
