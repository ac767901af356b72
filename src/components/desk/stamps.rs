//! How a row's time and bytes are told.

use buslens_analyst::message::Row;

use crate::format::{self, hex_spaced};

/// How a row's time is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Times {
    /// The time of the day.
    #[default]
    Clock,
    /// Since the log began.
    Start,
    /// Since the row before.
    Gap,
}

/// How a row's bytes are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Bytes {
    /// As pairs of digits.
    #[default]
    Hex,
    /// As characters, with a dot for what is none.
    Ascii,
    /// As both.
    Both,
}

/// Bytes of a row that are drawn; the rest is cut off by the row's edge anyway.
pub(super) const MOST: usize = 64;

impl Times {
    /// The name under which it is remembered.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Clock => "clock",
            Self::Start => "start",
            Self::Gap => "gap",
        }
    }

    /// The one with this name.
    pub(crate) fn of(key: &str) -> Self {
        [Self::Start, Self::Gap].into_iter().find(|times| times.key() == key).unwrap_or_default()
    }

    /// A row's time. `start_us` is when the log began, `zero_us` the time of the day at the zero of its clock.
    pub(super) fn text(self, row: &Row, start_us: u64, zero_us: u64) -> String {
        match self {
            Self::Clock => {
                row.time_us.map(|time| time_of_day(time.wrapping_add(zero_us), zero_us > 0)).unwrap_or_default()
            }
            Self::Start => row.time_us.map(|time| since(time.saturating_sub(start_us))).unwrap_or_default(),
            Self::Gap => row.gap_us.map(since).unwrap_or_default(),
        }
    }
}

impl Bytes {
    /// The name under which it is remembered.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Hex => "hex",
            Self::Ascii => "ascii",
            Self::Both => "both",
        }
    }

    /// The one with this name.
    pub(crate) fn of(key: &str) -> Self {
        [Self::Ascii, Self::Both].into_iter().find(|bytes| bytes.key() == key).unwrap_or_default()
    }

    /// A row's bytes.
    pub(super) fn text(self, bytes: &[u8]) -> String {
        let bytes = &bytes[..bytes.len().min(MOST)];
        match self {
            Self::Hex => hex_spaced(bytes),
            Self::Ascii => characters(bytes),
            Self::Both => [&hex_spaced(bytes), "  ", &characters(bytes)].concat(),
        }
    }
}

/// The time of the day; of a clock that tells tenths of milliseconds, always with them.
fn time_of_day(time_us: u64, has_tenths: bool) -> String {
    let mut text = format::clock(time_us);
    if has_tenths && text.len() < "00:00:00.0000".len() {
        text.push('0');
    }
    text
}

/// Bytes as characters, each one wide: a dot for what is no printable ASCII.
fn characters(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| if matches!(byte, b' '..=b'~') { char::from(*byte) } else { '\u{B7}' }).collect()
}

/// Seconds to a tenth of a millisecond, minutes and hours before them where there are any: `+1:02:03.0412`.
fn since(microseconds: u64) -> String {
    let tenths = microseconds / 100;
    let seconds = tenths / 10_000;
    let two = |value: u64| format!("{value:02}");
    let fraction = format!(".{:04}", tenths % 10_000);
    let whole = match (seconds / 3600, seconds / 60 % 60) {
        (0, 0) => seconds.to_string(),
        (0, minutes) => [&minutes.to_string(), ":", &two(seconds % 60)].concat(),
        (hours, minutes) => [&hours.to_string(), ":", &two(minutes), ":", &two(seconds % 60)].concat(),
    };
    ["+", &whole, &fraction].concat()
}

/// A span of time in the unit that shows it best, to a tenth of a millisecond.
pub(super) fn span(microseconds: u64) -> String {
    let tenths = microseconds.saturating_add(50) / 100;
    if tenths < 100_000 {
        format!("{}.{} ms", tenths / 10, tenths % 10)
    } else {
        let hundredths = tenths / 100;
        format!("{}.{:02} s", hundredths / 100, hundredths % 100)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_told_to_a_tenth_of_a_millisecond() {
        assert_eq!(since(0), "+0.0000");
        assert_eq!(since(1_234_567), "+1.2345");
        assert_eq!(since(62_000_100), "+1:02.0001");
        assert_eq!(since(3_723_041_200), "+1:02:03.0412");
    }

    #[test]
    fn times_of_the_day_stand_below_each_other() {
        assert_eq!(time_of_day(37_293_482_000, true), "10:21:33.4820");
        assert_eq!(time_of_day(37_293_482_300, true), "10:21:33.4823");
        assert_eq!(time_of_day(37_293_482_000, false), "10:21:33.482");
    }

    #[test]
    fn spans_are_short() {
        assert_eq!(span(0), "0.0 ms");
        assert_eq!(span(1_750), "1.8 ms");
        assert_eq!(span(49), "0.0 ms");
        assert_eq!(span(9_999_900), "9999.9 ms");
        assert_eq!(span(12_345_678), "12.34 s");
        assert_eq!(span(u64::MAX).rsplit(' ').next(), Some("s"));
    }

    #[test]
    fn bytes_are_told_as_digits_and_characters() {
        let bytes = b":01\r\n\x80";
        assert_eq!(Bytes::Hex.text(bytes), "3A 30 31 0D 0A 80");
        assert_eq!(Bytes::Ascii.text(bytes), ":01\u{B7}\u{B7}\u{B7}");
        assert_eq!(Bytes::Both.text(b"A"), "41  A");
        assert_eq!(Bytes::Ascii.text(&[b'x'; 1000]).len(), MOST);
    }

    #[test]
    fn what_is_remembered_comes_back() {
        for times in [Times::Clock, Times::Start, Times::Gap] {
            assert_eq!(Times::of(times.key()), times);
        }
        for bytes in [Bytes::Hex, Bytes::Ascii, Bytes::Both] {
            assert_eq!(Bytes::of(bytes.key()), bytes);
        }
        assert_eq!((Times::of(""), Bytes::of("x")), (Times::Clock, Bytes::Hex));
    }
}
