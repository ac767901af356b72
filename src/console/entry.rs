//! What is typed to be sent, as bytes; or the place where it goes wrong.
//!
//! Written as hex, a line is pairs of digits with or without spaces and commas between them and `0x` before them; between
//! them stand texts in quotes and escapes. Written as text, a line is its own UTF-8 with escapes. The escapes are `\r`, `\n`,
//! `\t`, `\0`, `\\`, `\"`, `\xHH` for a byte, and `\u{...}` for a character.

use super::Writing;

/// The most bytes that a line can stand for.
pub(crate) const MOST: usize = 4096;

/// Where a line goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    /// Which character, counted from 1.
    pub(crate) column: usize,
    /// What is wrong there.
    pub(crate) kind: FaultKind,
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaultKind {
    /// A character that does not belong there.
    Unexpected(char),
    /// A digit without its other half.
    OddDigits,
    /// Quotes that are never closed.
    OpenQuote,
    /// A backslash with something behind it that is no escape.
    Escape,
    /// A `\u{...}` that names no character.
    NoCharacter,
    /// More bytes than [`MOST`].
    TooLong,
}

/// The bytes of a line.
pub(crate) fn parse(writing: Writing, text: &str) -> Result<Vec<u8>, Fault> {
    let mut reader = Reader { rest: text.chars().collect(), at: 0, bytes: Vec::new() };
    match writing {
        Writing::Hex => reader.hex()?,
        Writing::Text => reader.text()?,
    }
    Ok(reader.bytes)
}

struct Reader {
    rest: Vec<char>,
    at: usize,
    bytes: Vec<u8>,
}

impl Reader {
    fn hex(&mut self) -> Result<(), Fault> {
        while let Some(character) = self.peek() {
            match character {
                ' ' | '\t' | ',' | ';' | '\u{A0}' => self.at += 1,
                '"' => self.quoted()?,
                '\\' => self.escape()?,
                '0' if matches!(self.rest.get(self.at + 1), Some('x' | 'X')) => {
                    self.at += 2;
                    if self.digit().is_none() {
                        return Err(self.fault_here());
                    }
                    self.pair()?;
                }
                _ if character.is_ascii_hexdigit() => self.pair()?,
                _ => return Err(fault(self.at, FaultKind::Unexpected(character))),
            }
        }
        Ok(())
    }

    fn text(&mut self) -> Result<(), Fault> {
        while let Some(character) = self.peek() {
            if character == '\\' { self.escape()? } else { self.character(character)? }
        }
        Ok(())
    }

    /// Two digits.
    fn pair(&mut self) -> Result<(), Fault> {
        let from = self.at;
        let (Some(high), Some(low)) = (self.take_digit(), self.take_digit()) else {
            return Err(fault(from, FaultKind::OddDigits));
        };
        self.push(from, &[high << 4 | low])
    }

    fn quoted(&mut self) -> Result<(), Fault> {
        let from = self.at;
        self.at += 1;
        loop {
            match self.peek() {
                None => return Err(fault(from, FaultKind::OpenQuote)),
                Some('"') => {
                    self.at += 1;
                    return Ok(());
                }
                Some('\\') => self.escape()?,
                Some(character) => self.character(character)?,
            }
        }
    }

    /// A backslash and what belongs to it.
    fn escape(&mut self) -> Result<(), Fault> {
        let from = self.at;
        let wrong = fault(from, FaultKind::Escape);
        let kind = self.rest.get(from + 1).copied().ok_or(wrong)?;
        self.at = from + 2;
        match kind {
            'r' => self.push(from, b"\r"),
            'n' => self.push(from, b"\n"),
            't' => self.push(from, b"\t"),
            '0' => self.push(from, b"\0"),
            '\\' | '"' => self.push(from, kind.to_string().as_bytes()),
            'x' => {
                let (Some(high), Some(low)) = (self.take_digit(), self.take_digit()) else { return Err(wrong) };
                self.push(from, &[high << 4 | low])
            }
            'u' => self.unicode(from),
            _ => Err(wrong),
        }
    }

    /// The braces of `\u{...}`: one to six digits.
    fn unicode(&mut self, from: usize) -> Result<(), Fault> {
        let wrong = fault(from, FaultKind::Escape);
        if self.peek() != Some('{') {
            return Err(wrong);
        }
        self.at += 1;
        let mut code = 0_u32;
        let mut digits = 0;
        while let Some(digit) = self.take_digit() {
            digits += 1;
            if digits > 6 {
                return Err(wrong);
            }
            code = code << 4 | u32::from(digit);
        }
        if digits == 0 || self.peek() != Some('}') {
            return Err(wrong);
        }
        self.at += 1;
        let character = char::from_u32(code).ok_or(fault(from, FaultKind::NoCharacter))?;
        self.push(from, character.to_string().as_bytes())
    }

    fn character(&mut self, character: char) -> Result<(), Fault> {
        let from = self.at;
        self.at += 1;
        self.push(from, character.to_string().as_bytes())
    }

    fn push(&mut self, from: usize, bytes: &[u8]) -> Result<(), Fault> {
        if self.bytes.len() + bytes.len() > MOST {
            return Err(fault(from, FaultKind::TooLong));
        }
        self.bytes.extend_from_slice(bytes);
        Ok(())
    }

    fn peek(&self) -> Option<char> {
        self.rest.get(self.at).copied()
    }

    fn digit(&self) -> Option<u8> {
        self.peek()?.to_digit(16).and_then(|digit| u8::try_from(digit).ok())
    }

    fn take_digit(&mut self) -> Option<u8> {
        let digit = self.digit()?;
        self.at += 1;
        Some(digit)
    }

    /// Something is missing here, or something else stands here.
    fn fault_here(&self) -> Fault {
        match self.peek() {
            Some(character) => fault(self.at, FaultKind::Unexpected(character)),
            None => fault(self.at.saturating_sub(1), FaultKind::OddDigits),
        }
    }
}

fn fault(at: usize, kind: FaultKind) -> Fault {
    Fault { column: at + 1, kind }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hex(text: &str) -> Result<Vec<u8>, (usize, FaultKind)> {
        parse(Writing::Hex, text).map_err(|fault| (fault.column, fault.kind))
    }

    fn text(text: &str) -> Result<Vec<u8>, (usize, FaultKind)> {
        parse(Writing::Text, text).map_err(|fault| (fault.column, fault.kind))
    }

    #[test]
    fn digits_may_stand_close_or_apart() {
        for spelling in ["01 03 00 FF", "010300ff", "0x01, 0x03, 0x00, 0xFF", " 01\t03;00,FF ", "0X01030x00FF"] {
            assert_eq!(hex(spelling), Ok(vec![1, 3, 0, 0xFF]), "{spelling}");
        }
        assert_eq!(hex(""), Ok(vec![]));
    }

    #[test]
    fn a_missing_digit_is_placed() {
        assert_eq!(hex("01 3"), Err((4, FaultKind::OddDigits)));
        assert_eq!(hex("01 3 05"), Err((4, FaultKind::OddDigits)));
        assert_eq!(hex("010"), Err((3, FaultKind::OddDigits)));
        assert_eq!(hex("0x"), Err((2, FaultKind::OddDigits)));
        assert_eq!(hex("0x, 01"), Err((3, FaultKind::Unexpected(','))));
    }

    #[test]
    fn what_does_not_belong_is_named() {
        assert_eq!(hex("01 03 8G"), Err((7, FaultKind::OddDigits)));
        assert_eq!(hex("01 G8"), Err((4, FaultKind::Unexpected('G'))));
        assert_eq!(hex("01 \u{FF10}1"), Err((4, FaultKind::Unexpected('\u{FF10}'))));
    }

    #[test]
    fn texts_stand_among_digits() {
        assert_eq!(hex(r#"02 "A\r" 03 \n"#), Ok(vec![2, b'A', b'\r', 3, b'\n']));
        assert_eq!(hex("01 \"ab"), Err((4, FaultKind::OpenQuote)));
        assert_eq!(hex(r#""a\""#), Err((1, FaultKind::OpenQuote)));
    }

    #[test]
    fn every_escape_has_its_byte() {
        assert_eq!(text(r#"\r\n\t\0\\\"\x7f"#), Ok(b"\r\n\t\0\\\"\x7F".to_vec()));
        assert_eq!(text(r"\u{4E2D}\u{0}"), Ok("\u{4E2D}\0".as_bytes().to_vec()));
        assert_eq!(text("\u{4E2D}"), Ok("\u{4E2D}".as_bytes().to_vec()));
    }

    #[test]
    fn what_is_no_escape_is_placed() {
        for wrong in [r"ab\", r"ab\q", r"ab\x1", r"ab\xG1", r"ab\u41", r"ab\u{}", r"ab\u{41", r"ab\u{0000041}"] {
            assert_eq!(text(wrong), Err((3, FaultKind::Escape)), "{wrong}");
        }
        for wrong in [r"\u{D800}", r"\u{110000}", r"\u{FFFFFF}"] {
            assert_eq!(text(wrong), Err((1, FaultKind::NoCharacter)), "{wrong}");
        }
    }

    #[test]
    fn a_line_has_an_end() {
        assert_eq!(hex(&"00".repeat(MOST)).map(|bytes| bytes.len()), Ok(MOST));
        assert_eq!(hex(&"00".repeat(MOST + 1)), Err((2 * MOST + 1, FaultKind::TooLong)));
        assert_eq!(text(&"x".repeat(MOST + 1)), Err((MOST + 1, FaultKind::TooLong)));
    }
}
