//! Text with escapes, as Python, C and Rust print bytes: `\x01\x03\x000`, printable characters standing for themselves.

use super::line::Line;
use super::output::Output;

/// Writes the bytes of the characters in columns `at..end`. A character up to U+00FF is the byte of its number, as in a
/// Python `str` that carries bytes.
pub(super) fn decode(line: &Line, at: usize, end: usize, output: &mut Output) {
    let codes = line.codes.get(..end).unwrap_or_default();
    let mut at = at;
    while let Some(code) = codes.get(at) {
        if *code != b'\\' {
            match line.latin(at) {
                Some(byte) => output.bytes.push(byte),
                None => output.unexpected(line, at),
            }
            at += 1;
            continue;
        }
        let escaped = codes.get(at + 1).copied().unwrap_or(b'\\');
        let (radix, most) = match escaped {
            b'x' | b'X' => (16, 2),
            b'0'..=b'7' => (8, 3),
            _ => (0, 0),
        };
        if radix == 0 {
            match simple(escaped) {
                Some(byte) => output.bytes.push(byte),
                None => output.unexpected(line, at),
            }
            at += 2;
            continue;
        }
        at += if radix == 16 { 2 } else { 1 };
        let digits = codes.iter().skip(at).take(most);
        let mut taken = 0;
        let mut value = 0u32;
        for digit in digits.map_while(|code| char::from(*code).to_digit(radix)) {
            value = value * radix + digit;
            taken += 1;
        }
        match u8::try_from(value) {
            Ok(byte) if taken > 0 => output.bytes.push(byte),
            _ => output.unexpected(line, at.saturating_sub(1)),
        }
        at += taken;
    }
}

/// The byte of a one-letter escape.
fn simple(letter: u8) -> Option<u8> {
    Some(match letter {
        b'n' => b'\n',
        b'r' => b'\r',
        b't' => b'\t',
        b'a' => 0x07,
        b'b' => 0x08,
        b'v' => 0x0B,
        b'f' => 0x0C,
        b'e' => 0x1B,
        b'\\' | b'\'' | b'"' => letter,
        _ => return None,
    })
}

/// Where the quoted text that begins behind the quote at `at` ends, and whether it has escapes; `None` if it does not end.
pub(super) fn quoted(codes: &[u8], at: usize) -> Option<(usize, bool)> {
    let quote = *codes.get(at)?;
    let mut end = at + 1;
    let mut escapes = false;
    loop {
        match codes.get(end)? {
            b'\\' => {
                escapes = true;
                end += 1;
            }
            code if *code == quote => return Some((end, escapes)),
            _ => {}
        }
        end += 1;
    }
}
