//! Bytes from text that somebody pasted.

use alloc::vec::Vec;

use crate::line::Mode;

/// What a text holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Intake {
    /// The bytes of the stream; in ASCII mode the characters.
    pub bytes: Vec<u8>,
    /// How they are framed.
    pub mode: Mode,
}

/// Where a text stops making sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {fault}")]
pub struct IntakeError {
    /// Counted from 1.
    pub line: usize,
    /// In characters, counted from 1.
    pub column: usize,
    /// What is wrong there.
    pub fault: IntakeFault,
}

/// What is wrong with a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum IntakeFault {
    /// A character that is neither a hexadecimal digit nor a separator.
    #[error("unexpected {0:?}")]
    Unexpected(char),
    /// A run of digits that does not make whole bytes.
    #[error("an odd number of digits")]
    OddDigits,
}

/// Reads hexadecimal bytes, with or without separators, `0x` and `\x`; or frames of ASCII mode, as text that begins with a
/// colon or as the hexadecimal codes of its characters. Full-width characters count as their plain twins.
pub fn parse(text: &str) -> Result<Intake, IntakeError> {
    let characters = text.chars().map(plain);
    if characters.clone().find(|c| !c.is_whitespace()) == Some(':') {
        return parse_ascii(text);
    }
    let bytes = parse_hex(text)?;
    let is_text = |byte: &u8| matches!(byte & 0x7F, b':' | b'0'..=b'9' | b'A'..=b'F' | b'a'..=b'f' | b'\r' | b'\n');
    let mode = if bytes.first() == Some(&b':') && bytes.iter().all(is_text) { Mode::Ascii } else { Mode::Rtu };
    Ok(Intake { bytes, mode })
}

/// Each line that begins with a colon is a frame; its line end is made CR LF, as on the wire.
fn parse_ascii(text: &str) -> Result<Intake, IntakeError> {
    let mut bytes = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let indent = line.chars().take_while(|c| c.is_whitespace()).count();
        let content = line.trim();
        if content.is_empty() {
            continue;
        }
        for (column, character) in content.chars().map(plain).enumerate() {
            if character != ':' && !character.is_ascii_hexdigit() {
                let fault = IntakeFault::Unexpected(character);
                return Err(IntakeError { line: number + 1, column: indent + column + 1, fault });
            }
            bytes.extend(u8::try_from(character));
        }
        bytes.extend_from_slice(b"\r\n");
    }
    Ok(Intake { bytes, mode: Mode::Ascii })
}

fn parse_hex(text: &str) -> Result<Vec<u8>, IntakeError> {
    let mut bytes = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let characters: Vec<char> = line.chars().map(plain).collect();
        let mut at = 0;
        while at < characters.len() {
            let rest = &characters[at..];
            if is_separator(rest[0]) {
                at += 1;
                continue;
            }
            if matches!(rest, ['0' | '\\', 'x' | 'X', ..]) {
                at += 2;
            }
            let digits = characters[at..].iter().take_while(|c| c.is_ascii_hexdigit()).count();
            let error = |at: usize, fault| Err(IntakeError { line: number + 1, column: at + 1, fault });
            if digits == 0 {
                let found = characters.get(at).or(rest.first()).copied().unwrap_or(' ');
                return error(at.min(characters.len() - 1), IntakeFault::Unexpected(found));
            }
            let run = &characters[at..at + digits];
            // A lone digit is a byte written short; a longer odd run has lost one, and nobody knows where.
            if digits > 1 && digits % 2 != 0 {
                return error(at, IntakeFault::OddDigits);
            }
            let values = run.iter().filter_map(|c| c.to_digit(16)).filter_map(|value| u8::try_from(value).ok());
            let values: Vec<u8> = values.collect();
            bytes.extend(values.chunks(2).map(|pair| pair.iter().fold(0, |byte, digit| byte << 4 | digit)));
            at += digits;
        }
    }
    Ok(bytes)
}

fn is_separator(character: char) -> bool {
    character.is_whitespace() || matches!(character, ',' | ';' | '-' | '[' | ']' | '{' | '}' | '(' | ')' | '<' | '>')
}

/// The plain twin of a full-width character, as Chinese input methods and documents have them.
fn plain(character: char) -> char {
    match character {
        '\u{3000}' => ' ',
        '、' => ',',
        '\u{FF01}'..='\u{FF5E}' => char::from_u32(u32::from(character) - 0xFEE0).unwrap_or(character),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FRAME: [u8; 8] = [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5];

    #[test]
    fn the_same_frame_in_many_spellings() {
        for text in [
            "01 03 00 31 00 01 D5 C5",
            "0103003100 01d5c5",
            "01,03,00,31,00,01,D5,C5",
            "0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5",
            "\\x01\\x03\\x00\\x31\\x00\\x01\\xD5\\xC5",
            "01-03-00-31-00-01-D5-C5",
            "[01][03][00][31][00][01][D5][C5]",
            "1 3 0 31 0 1 D5 C5",
            "01 03 00 31\n00 01 D5 C5\r\n",
            "０１　０３　００　３１　００　０１　Ｄ５　Ｃ５",
        ] {
            assert_eq!(parse(text), Ok(Intake { bytes: FRAME.to_vec(), mode: Mode::Rtu }), "{text}");
        }
    }

    #[test]
    fn ascii_frames_as_text_and_as_codes() {
        let expected = Ok(Intake { bytes: b":010300310001CA\r\n".to_vec(), mode: Mode::Ascii });
        assert_eq!(parse(":010300310001CA"), expected);
        assert_eq!(parse("  ：010300310001CA\r\n"), expected);
        assert_eq!(parse("3A 30 31 30 33 30 30 33 31 30 30 30 31 43 41 0D 0A"), expected);
    }

    #[test]
    fn faults_are_placed() {
        let cases = [
            ("01 03\n00 3", None),
            ("01 03\n00 312", Some((2, 4, IntakeFault::OddDigits))),
            ("01 03 zz", Some((1, 7, IntakeFault::Unexpected('z')))),
            ("0x", Some((1, 2, IntakeFault::Unexpected('0')))),
            (":01 03", Some((1, 4, IntakeFault::Unexpected(' ')))),
        ];
        for (text, expected) in cases {
            let found = parse(text).err().map(|error| (error.line, error.column, error.fault));
            assert_eq!(found, expected, "{text}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_taken_or_refused(text in ".*") {
            let _ = parse(&text);
        }
    }
}
