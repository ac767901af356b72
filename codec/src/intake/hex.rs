//! Hexadecimal bytes in any spelling, also as programs write them.

use super::line::{Line, RAW, hex_digits, is_space, spaces, starts_with};
use super::output::Output;
use super::{IntakeFault, ascii, literal};
use crate::dissect::Direction;

/// What one line tells of the next.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    /// A comment that `/*` began is still open.
    pub(super) comment: bool,
}

/// Reads a line: bytes in hexadecimal digits, or frames of ASCII mode.
pub(super) fn line(line: &Line, state: &mut State, output: &mut Output) {
    let start = output.bytes.len();
    let at = spaces(line.codes, 0);
    if !state.comment && ascii::is_frame(line.codes, at) {
        ascii::frames(line, at, line.codes.len(), output);
    } else {
        each_lexeme(line, state, output, |output, digits, _| self::digits(line, digits.start, digits.end, output));
    }
    output.close(start, line.number, Direction::Unknown, None);
}

/// Gives the numbers of a line to `number`, with whether they are marked as hexadecimal, and handles the rest.
pub(super) fn each_lexeme(
    line: &Line,
    state: &mut State,
    output: &mut Output,
    mut number: impl FnMut(&mut Output, Span, bool),
) {
    let mut lexer = Lexer::new(line.codes, state.comment);
    let code = lexer.at > 0;
    let mut quoted = false;
    while let Some(lexeme) = lexer.next() {
        match lexeme {
            // Behind a text in a program stand lengths and the like.
            Lexeme::Number(..) | Lexeme::Stray(_) if code && quoted => {}
            Lexeme::Number(digits, hex) => number(output, digits, hex),
            Lexeme::Literal(Span { start, end }) => {
                quoted = true;
                literal::decode(line, start, end, output);
            }
            Lexeme::Stray(at) => output.unexpected(line, at),
        }
    }
    state.comment = lexer.comment;
}

/// Writes the bytes of the digits in columns `start..end`: a lone digit is a byte written short; a longer odd run has lost one,
/// and nobody knows where.
pub(super) fn digits(line: &Line, start: usize, end: usize, output: &mut Output) {
    let digits = line.codes.get(start..end).unwrap_or_default();
    if let [digit] = digits {
        output.bytes.push(value(*digit));
        return;
    }
    if !digits.len().is_multiple_of(2) {
        output.fault(line, start, IntakeFault::OddDigits);
    }
    output.bytes.extend(digits.as_chunks().0.iter().map(|[high, low]| value(*high) << 4 | value(*low)));
}

/// The value of a hexadecimal digit.
pub(super) fn value(digit: u8) -> u8 {
    match digit {
        b'0'..=b'9' => digit - b'0',
        b'a'..=b'f' => digit - b'a' + 10,
        b'A'..=b'F' => digit - b'A' + 10,
        _ => 0,
    }
}

/// Columns of a line, without the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) start: usize,
    pub(super) end: usize,
}

/// What may stand between bytes, besides what has a meaning of its own.
const SEPARATORS: &[u8] =
    &[b' ', b',', b'\t', b';', b':', b'-', b'.', b'|', b'=', b'+', b'[', b']', b'{', b'}', b'(', b')', b'<', b'>', RAW];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lexeme {
    /// Digits of a number without its prefix and suffix, and whether these say that it is hexadecimal.
    Number(Span, bool),
    /// Text with escapes.
    Literal(Span),
    /// A word or a character that is no part of a list of bytes; it fits nothing from this column on.
    Stray(usize),
}

pub(super) struct Lexer<'a> {
    codes: &'a [u8],
    /// Where it reads on; at first, behind what a program has before its bytes.
    pub(super) at: usize,
    /// Whether the line ends within a comment.
    pub(super) comment: bool,
    /// A comment stood in the line.
    pub(super) commented: bool,
}

impl<'a> Lexer<'a> {
    /// `comment` says that the line begins within one.
    pub(super) fn new(codes: &'a [u8], comment: bool) -> Self {
        let at = if comment { 0 } else { preamble(codes) };
        Self { codes, at, comment, commented: comment }
    }

    pub(super) fn next(&mut self) -> Option<Lexeme> {
        loop {
            if self.comment {
                let end = self.codes.get(self.at..)?.windows(2).position(|pair| pair == b"*/")?;
                self.at += end + 2;
                self.comment = false;
            }
            let at = self.at;
            // What most lines are made of.
            if let [high, low, b' ' | b',', ..] = self.codes.get(at..)?
                && high.is_ascii_hexdigit()
                && low.is_ascii_hexdigit()
            {
                self.at += 3;
                return Some(Lexeme::Number(Span { start: at, end: at + 2 }, false));
            }
            let code = *self.codes.get(at)?;
            self.at += 1;
            match code {
                b'0'..=b'9' | b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
                    if let Some(lexeme) = self.word(at) {
                        return Some(lexeme);
                    }
                }
                b'"' | b'\'' | b'`' => {
                    if let Some((end, true)) = literal::quoted(self.codes, at) {
                        self.at = end + 1;
                        return Some(Lexeme::Literal(Span { start: at + 1, end }));
                    }
                }
                b'/' if starts_with(self.codes, at, b"/*") => {
                    (self.comment, self.commented) = (true, true);
                    self.at += 1;
                }
                b'/' if starts_with(self.codes, at, b"//") => self.skip_comment(),
                b'#' if !self.prefixes_byte(at + 1) => self.skip_comment(),
                b'#' | b'$' | b'%' if self.prefixes_byte(at + 1) => return Some(self.prefixed(at + 1)),
                b'&' if matches!(self.codes.get(at + 1), Some(b'H' | b'h')) && hex_digits(self.codes, at + 2) > 0 => {
                    return Some(self.prefixed(at + 2));
                }
                b'\\' if self.escapes(at) > at => {
                    let span = Span { start: at, end: self.escapes(at) };
                    self.at = span.end;
                    return Some(Lexeme::Literal(span));
                }
                // A line that a program continues.
                b'\\' if self.codes.iter().skip(at + 1).all(|code| is_space(*code)) => {}
                _ if SEPARATORS.contains(&code) => {}
                _ => return Some(Lexeme::Stray(at)),
            }
        }
    }

    fn skip_comment(&mut self) {
        self.commented = true;
        self.at = self.codes.len();
    }

    /// One or two digits that end a word.
    fn prefixes_byte(&self, at: usize) -> bool {
        let digits = hex_digits(self.codes, at);
        let after = self.codes.get(at + digits);
        matches!(digits, 1..=2) && !after.is_some_and(|code| code.is_ascii_alphanumeric() || *code == b'_')
    }

    fn prefixed(&mut self, start: usize) -> Lexeme {
        self.at = start + hex_digits(self.codes, start);
        Lexeme::Number(Span { start, end: self.at }, true)
    }

    /// Where escapes that stand free, and digits glued to them, end.
    fn escapes(&self, at: usize) -> usize {
        let mut end = at;
        while self.codes.get(end) == Some(&b'\\')
            && self.codes.get(end + 1).is_some_and(|code| b"xXrnt0".contains(code))
        {
            end += 2;
            end += self.codes.iter().skip(end).take_while(|code| code.is_ascii_alphanumeric()).count();
        }
        end
    }

    /// Takes the word that begins at `at`; nothing for the letter before a quoted text.
    fn word(&mut self, at: usize) -> Option<Lexeme> {
        let rest = self.codes.get(at..).unwrap_or_default();
        let len = rest.iter().take_while(|code| code.is_ascii_alphanumeric() || **code == b'_').count();
        self.at = at + len;
        let word = rest.get(..len).unwrap_or_default();
        if matches!(word, b"b" | b"B" | b"r" | b"rb" | b"br" | b"u") && matches!(rest.get(len), Some(b'"' | b'\'')) {
            return None;
        }
        Some(if let Some((Span { start, end }, hex)) = number(word) {
            Lexeme::Number(Span { start: at + start, end: at + end }, hex)
        } else {
            let stray = hex_digits(word, 0);
            Lexeme::Stray(at + if stray == len || word.starts_with(b"0x") { 0 } else { stray })
        })
    }
}

/// The digits of a word that is a number, and whether prefix or suffix say that it is hexadecimal.
pub(super) fn number(word: &[u8]) -> Option<(Span, bool)> {
    let start = match word {
        [b'0', b'x' | b'X', ..] => 2,
        [b'x' | b'X', ..] => 1,
        _ => 0,
    };
    let end = start + hex_digits(word, start);
    let hex = match word.get(end..)? {
        _ if end == start => return None,
        b"h" | b"H" if start == 0 => true,
        b"" | b"u8" | b"_u8" | b"u" | b"U" | b"UL" | b"ul" => start > 0,
        _ => return None,
    };
    Some((Span { start, end }, hex))
}

/// Columns before the bytes that a program's line sets: names, types, dimensions, the opening of a call or a list.
pub(super) fn preamble(codes: &[u8]) -> usize {
    let mut at = spaces(codes, 0);
    // Most lines are bytes: looked at no further.
    let Some(opening) = codes.iter().position(|code| matches!(code, b'=' | b'(' | b'[' | b'{')) else { return 0 };
    let name = codes.get(at..opening).unwrap_or_default();
    if !is_name(name) && !matches!(codes.get(opening), Some(b'=')) {
        return 0;
    }
    if is_name(name)
        && let Some(sign) = codes.iter().position(|code| *code == b'=')
        && !codes.iter().take(sign).any(|code| matches!(code, b'"' | b'\'' | b'/' | b'#'))
    {
        at = sign + 1;
    }
    loop {
        let start = at + spaces(codes, at);
        let rest = codes.get(start..).unwrap_or_default();
        let Some(len) = rest.iter().position(|code| matches!(code, b'(' | b'[' | b'{' | b'"' | b'\'')) else { break };
        let name = rest.get(..len).unwrap_or_default();
        if !is_name(name) || matches!(rest.get(len), Some(b'"' | b'\'')) {
            break;
        }
        at = start + len + 1;
        // A dimension is not a byte.
        let dimension = codes.iter().skip(at).take_while(|code| code.is_ascii_digit()).count();
        if rest.get(len) == Some(&b'[') && codes.get(at + dimension) == Some(&b']') {
            at += dimension + 1;
        }
    }
    at
}

/// Words as programs name things: at least one letter that is no hexadecimal digit.
fn is_name(text: &[u8]) -> bool {
    let fits = |code: &u8| code.is_ascii_alphanumeric() || is_space(*code) || b"_.:!&*<>".contains(code);
    let words = text.split(|code| !code.is_ascii_alphanumeric() && *code != b'_');
    text.iter().all(fits)
        && words.into_iter().any(|word| {
            number(word).is_none() && word.first().is_some_and(|code| code.is_ascii_alphabetic() || *code == b'_')
        })
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;

    fn texts(text: &str) -> Vec<&str> {
        let mut lexer = Lexer::new(text.as_bytes(), false);
        let mut found = Vec::new();
        while let Some(lexeme) = lexer.next() {
            found.push(match lexeme {
                Lexeme::Number(Span { start, end }, _) | Lexeme::Literal(Span { start, end }) => &text[start..end],
                Lexeme::Stray(at) => &text[at..],
            });
        }
        found
    }

    #[test]
    fn programs_are_seen_through() {
        for (text, expected) in [
            ("uint8_t buf[8] = {0x01, 0x03};", &["01", "03"][..]),
            ("const unsigned char req[] PROGMEM = { 01h, 0x03 };", &["01", "03"]),
            ("byte[] frame = new byte[] { 0x01, 0x03 };", &["01", "03"]),
            ("let f = vec![0x01u8, 0x03_u8];", &["01", "03"]),
            ("let f: [u8; 2] = [0x01, 0x03];", &["01", "03"]),
            ("uint8_t buf[] {0x01, 0x03};", &["01", "03"]),
            ("buf[0] = 0x01; /* unit 5 */", &["01"]),
            ("bytes.fromhex('0103')", &["0103"]),
            ("ser.write(b'\\x01\\x03', 2)", &["\\x01\\x03"]),
            ("uart.write(\"\\x01\\x03\" \"\\x00\", 3);", &["\\x01\\x03", "\\x00"]),
            ("\\x01\\x03\\x000 \\x05", &["\\x01\\x03\\x000", "\\x05"]),
            ("#01 #03 # and 05", &["01", "03"]),
            ("$01,&H03,%05 // 07", &["01", "03", "05"]),
        ] {
            let mut found = texts(text);
            if found.len() > expected.len() {
                found.retain(|found| {
                    found.bytes().next().is_some_and(|first| first.is_ascii_hexdigit() || first == b'\\')
                });
                found.truncate(expected.len());
            }
            assert_eq!(found, expected, "{text}");
        }
    }
}
