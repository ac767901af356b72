//! Bytes with gaps: what an `expect` wants to hear.

use buslens_codec::UnitId;
use buslens_codec::check::{crc16, lrc};

use crate::fault::{Expected, Fault, FaultKind};
use crate::lex::{self, Character, Token, TokenKind};

/// The most items of a pattern, and bytes of a [`crate::Sequence`]'s `send`.
pub const MAX_BYTES: usize = 1024;
/// The most bytes from the start of what is checked to the end of what was heard, behind noise. Two frames go into it.
const MAX_CHECKED: usize = 512;
/// A unit id and a function code: a check is never over less.
const LEAST_CHECKED: usize = 2;

/// Bytes with gaps, over all that was heard: `01 03 ?? .. CRC`.
///
/// - `01 03`, `0103`, `0x01`: these bytes; `"OK\r\n"`: these characters;
/// - `??`: any byte; `4?`, `?4`: any byte with this half;
/// - `..`: any number of any bytes, none among them;
/// - `CRC`: the two bytes of the right CRC-16 of all bytes before it, low byte first (serial line guide, clause 2.5.1.2);
/// - `LRC`: the right LRC of all bytes before it (clause 2.5.2.2);
/// - `UNIT`: the unit id in force.
///
/// A check is over two bytes at least. A `..` at the very beginning may also stand for noise, which the check is not over. With `ascii`
/// before it the pattern is that of the bytes which an ASCII frame's digits spell, the LRC among them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    pub(crate) ascii: bool,
    pub(crate) items: Vec<Item>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Item {
    /// The byte, as far as the mask has ones.
    Byte {
        value: u8,
        mask: u8,
    },
    Any,
    Crc,
    Lrc,
    Unit,
}

impl Pattern {
    /// Reads a pattern that stands alone, on one line. Columns count from its beginning.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        let text: String = text.chars().map(|character| if character == '\n' { ' ' } else { character }).collect();
        let (tokens, _) = lex::line(1, &text)?;
        Self::of(1, &tokens)
    }

    /// Reads a pattern that takes all of these words.
    pub(crate) fn of(line: u32, tokens: &[Token]) -> Result<Self, Fault> {
        let fault = |token: &Token, kind| Fault { line, column: token.column, kind };
        let (ascii, tokens) = match tokens.split_first() {
            Some((first, rest)) if first.is_word("ascii") => (true, rest),
            _ => (false, tokens),
        };
        let mut items = Vec::new();
        for token in tokens {
            match &token.kind {
                TokenKind::Word(word) => push_word(&mut items, word).map_err(|kind| fault(token, kind))?,
                TokenKind::Quoted(inner) => {
                    let bytes = quoted_bytes(line, token.column, inner)?;
                    items.extend(bytes.into_iter().map(|value| Item::Byte { value, mask: 0xFF }));
                }
                TokenKind::Mark(mark) => return Err(fault(token, FaultKind::BadByte((*mark).to_owned()))),
            }
            if items.len() > MAX_BYTES {
                let limit = u32::try_from(MAX_BYTES).unwrap_or(u32::MAX);
                return Err(fault(token, FaultKind::TooManyBytes(limit)));
            }
        }
        if items.is_empty() {
            let column = tokens.first().map_or(1, |token| token.column);
            return Err(Fault { line, column, kind: FaultKind::Expected(Expected::Bytes, String::new()) });
        }
        items.dedup_by(|next, before| *next == Item::Any && *before == Item::Any);
        Ok(Self { ascii, items })
    }

    /// Whether all of `heard` fits. With no `unit`, `UNIT` stands for any byte.
    pub fn matches(&self, heard: &[u8], unit: Option<UnitId>) -> bool {
        if !self.ascii {
            return self.fits(heard, unit);
        }
        buslens_codec::ascii::decode_body(heard).is_ok_and(|body| self.fits(&body, unit))
    }

    fn fits(&self, bytes: &[u8], unit: Option<UnitId>) -> bool {
        let checked = self.items.iter().any(|item| matches!(item, Item::Crc | Item::Lrc));
        let first = match self.items.first() {
            // Without a check it does not matter where the noise ends: the gap is like any other.
            Some(Item::Any) if checked => bytes.len().saturating_sub(MAX_CHECKED),
            _ => bytes.len(),
        };
        let noisy =
            (first..bytes.len()).rev().any(|start| fit(&self.items, bytes.get(start..).unwrap_or_default(), unit));
        noisy || fit(&self.items, bytes, unit)
    }
}

impl Item {
    /// The fewest bytes that it stands for.
    fn len(self) -> usize {
        match self {
            Self::Any => 0,
            Self::Crc => 2,
            Self::Byte { .. } | Self::Lrc | Self::Unit => 1,
        }
    }

    /// Whether it stands for the bytes at `at`.
    fn stands_at(self, bytes: &[u8], at: usize, unit: Option<UnitId>) -> bool {
        let (Some(before), Some(own)) = (bytes.get(..at), bytes.get(at..at + self.len())) else { return false };
        match self {
            Self::Byte { value, mask } => own.first().is_some_and(|byte| byte & mask == value),
            Self::Any => true,
            Self::Crc => before.len() >= LEAST_CHECKED && own == crc16(before).to_le_bytes(),
            Self::Lrc => before.len() >= LEAST_CHECKED && own == [lrc(before)],
            Self::Unit => unit.is_none_or(|unit| own == [unit.0]),
        }
    }
}

/// Goes through the items; what follows a gap is tried as early as it stands, and again later if the rest does not fit.
/// That the last gap alone is stretched is enough, for what an item stands for depends on its place alone.
fn fit(items: &[Item], bytes: &[u8], unit: Option<UnitId>) -> bool {
    let (mut item, mut at) = (0, 0);
    let mut gap: Option<(usize, usize)> = None;
    loop {
        match items.get(item) {
            Some(Item::Any) => {
                gap = Some((item + 1, at));
                item += 1;
                continue;
            }
            Some(own) if own.stands_at(bytes, at, unit) => {
                item += 1;
                at += own.len();
                continue;
            }
            None if at == bytes.len() => return true,
            _ => {}
        }
        let Some((after, from)) = gap.filter(|(_, from)| *from < bytes.len()) else { return false };
        gap = Some((after, from + 1));
        (item, at) = (after, from + 1);
    }
}

fn push_word(items: &mut Vec<Item>, word: &str) -> Result<(), FaultKind> {
    match word {
        ".." | "..." | "…" => items.push(Item::Any),
        "CRC" | "crc" => items.push(Item::Crc),
        "LRC" | "lrc" => items.push(Item::Lrc),
        "UNIT" | "unit" => items.push(Item::Unit),
        _ => {
            for (high, low) in pairs(word).ok_or_else(|| FaultKind::BadByte(word.to_owned()))? {
                let half = |digit: char| match digit {
                    '?' => Some((0, 0)),
                    digit => Some((u8::try_from(digit.to_digit(16)?).ok()?, 0x0F)),
                };
                let (Some((high, high_mask)), Some((low, low_mask))) = (half(high), half(low)) else {
                    return Err(FaultKind::BadByte(word.to_owned()));
                };
                items.push(Item::Byte { value: high << 4 | low, mask: high_mask << 4 | low_mask });
            }
        }
    }
    Ok(())
}

/// The digits of a word two by two; `None` for an odd number of them or none.
pub(crate) fn pairs(word: &str) -> Option<Vec<(char, char)>> {
    let digits: Vec<char> = word.strip_prefix("0x").or(word.strip_prefix("0X")).unwrap_or(word).chars().collect();
    let (pairs, rest) = digits.as_chunks::<2>();
    (!pairs.is_empty() && rest.is_empty()).then(|| pairs.iter().map(|[high, low]| (*high, *low)).collect())
}

/// The bytes of a quoted text.
pub(crate) fn quoted_bytes(line: u32, column: u32, inner: &str) -> Result<Vec<u8>, Fault> {
    let place = |at: usize| column.saturating_add(u32::try_from(at + 1).unwrap_or(u32::MAX));
    let bad = |(at, escape)| Fault { line, column: place(at), kind: FaultKind::BadEscape(escape) };
    let characters = lex::unescape(inner).map_err(bad)?;
    let byte = |(at, character)| match character {
        Character::Escaped(byte) => Ok(byte),
        Character::Plain(character) if character.is_ascii() => Ok(u8::try_from(character).unwrap_or_default()),
        Character::Plain(other) => Err(Fault { line, column: place(at), kind: FaultKind::NotAscii(other) }),
    };
    characters.into_iter().map(byte).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const REPLY: &[u8] = &[0x01, 0x03, 0x02, 0x00, 0x07, 0xF9, 0x86];

    fn fits(pattern: &str, bytes: &[u8]) -> bool {
        Pattern::parse(pattern).unwrap().matches(bytes, Some(UnitId(1)))
    }

    #[test]
    fn patterns_of_a_reply() {
        for pattern in [
            "01 03 02 00 07 F9 86",
            "01030200 07 CRC",
            "UNIT 03 .. CRC",
            "01 ?? 02 .. 0? ..",
            "..",
            ".. 86",
            ".. 01 03 .. CRC",
            "0x01 0x03 ?2 00 07 CRC",
        ] {
            assert!(fits(pattern, REPLY), "{pattern}");
        }
        for pattern in ["01 03", "02 ..", "01 03 02 00 08 CRC", "01 .. CRC ??", "01 83 .. CRC", ".. 87", "1? 1? .."] {
            assert!(!fits(pattern, REPLY), "{pattern}");
        }
        assert!(!Pattern::parse("UNIT ..").unwrap().matches(REPLY, Some(UnitId(2))));
        assert!(Pattern::parse("UNIT ..").unwrap().matches(REPLY, None));
    }

    #[test]
    fn noise_before_a_frame_is_not_in_its_check() {
        let noisy = [&[0x00, 0xFF], REPLY].concat();
        assert!(fits(".. 01 03 .. CRC", &noisy) && fits(".. CRC", &noisy));
        assert!(!fits("00 FF .. CRC", &noisy));
        assert!(fits("..", &[]) && !fits("??", &[]));
    }

    #[test]
    fn an_ascii_frame_by_its_characters_or_by_its_bytes() {
        let frame = b":010302000BEF\r\n";
        for pattern in ["\":0103\" .. \"\\r\\n\"", "ascii 01 03 02 00 0B LRC", "ascii UNIT .. LRC"] {
            assert!(fits(pattern, frame), "{pattern}");
        }
        assert!(!fits("ascii 01 03 02 00 0C LRC", frame) && !fits("ascii ..", REPLY));
    }

    #[test]
    fn what_is_no_pattern_is_told_with_its_place() {
        for (pattern, column, kind) in [
            ("01 0", 4, FaultKind::BadByte("0".to_owned())),
            ("01 zz", 4, FaultKind::BadByte("zz".to_owned())),
            ("\"a\\q\"", 3, FaultKind::BadEscape("\\q".to_owned())),
            ("\"°\"", 2, FaultKind::NotAscii('°')),
            ("01 \"a", 4, FaultKind::QuoteNotClosed),
            ("", 1, FaultKind::Expected(Expected::Bytes, String::new())),
        ] {
            assert_eq!(Pattern::parse(pattern), Err(Fault { line: 1, column, kind }), "{pattern}");
        }
    }

    /// The plain definition, exponential and all.
    fn fits_plainly(items: &[Item], bytes: &[u8], at: usize) -> bool {
        match items.split_first() {
            None => at == bytes.len(),
            Some((Item::Any, rest)) => (at..=bytes.len()).any(|next| fits_plainly(rest, bytes, next)),
            Some((item, rest)) => item.stands_at(bytes, at, None) && fits_plainly(rest, bytes, at + item.len()),
        }
    }

    proptest! {
        #[test]
        fn stretching_the_last_gap_is_enough(
            items in prop::collection::vec(
                prop_oneof![
                    Just(Item::Any),
                    (0u8..3).prop_map(|value| Item::Byte { value, mask: 0xFF }),
                    Just(Item::Byte { value: 0, mask: 0 }),
                    Just(Item::Lrc),
                ],
                0..7,
            ),
            bytes in prop::collection::vec(prop_oneof![0u8..3, 0xFDu8..=0xFF], 0..8),
        ) {
            prop_assert_eq!(fit(&items, &bytes, None), fits_plainly(&items, &bytes, 0));
        }

        #[test]
        fn no_pattern_and_no_bytes_panic(text in ".{0,40}", bytes in prop::collection::vec(any::<u8>(), 0..40)) {
            if let Ok(pattern) = Pattern::parse(&text) {
                pattern.matches(&bytes, None);
            }
        }
    }
}
