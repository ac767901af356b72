//! Frames of ASCII mode as text: `:010300310001CA`.

use super::hex;
use super::line::{Line, hex_digits, is_space, spaces, starts_with};
use super::output::Output;
use crate::dissect::Direction;

/// A line that begins with a colon holds frames; any other is read as hexadecimal bytes.
pub(super) fn line(line: &Line, state: &mut hex::State, output: &mut Output) {
    let at = spaces(line.codes, 0);
    if line.codes.get(at) != Some(&b':') {
        return hex::line(line, state, output);
    }
    let start = output.bytes.len();
    frames(line, at, line.codes.len(), output);
    output.close(start, line.number, Direction::Unknown, None);
}

/// Whether a frame stands at `at`: a colon and the digits of at least unit id, function code and LRC (serial line guide,
/// clause 2.5.2.1). Spaces between the digits are taken for somebody's care.
pub(super) fn is_frame(codes: &[u8], at: usize) -> bool {
    if codes.get(at) != Some(&b':') {
        return false;
    }
    let digits = codes.iter().skip(at + 1).take_while(|code| code.is_ascii_hexdigit() || is_space(**code));
    digits.filter(|code| !is_space(**code)).take(6).count() == 6 && hex_digits(codes, at + 1) != 1
}

/// Writes the frames from `at`, where a colon stands, to `end` as they are on the wire: each gets its CR LF. A character that
/// belongs in no frame is reported and, if the wire can carry it, kept.
pub(super) fn frames(line: &Line, at: usize, end: usize, output: &mut Output) {
    let codes = line.codes.get(..end).unwrap_or_default();
    let mut at = at;
    let mut open = false;
    while let Some(code) = codes.get(at) {
        match code {
            b':' => {
                if open {
                    output.bytes.extend_from_slice(b"\r\n");
                }
                open = true;
                output.bytes.push(b':');
            }
            _ if code.is_ascii_hexdigit() => output.bytes.push(*code),
            b'\\' if matches!(codes.get(at + 1), Some(b'r' | b'n')) => at += 1,
            b'<' | b'[' if starts_with(codes, at + 1, b"CR") || starts_with(codes, at + 1, b"LF") => at += 3,
            b'"' | b'\'' | b',' | b';' => {}
            _ if is_space(*code) => {}
            _ => {
                if code.is_ascii() {
                    output.bytes.push(*code);
                }
                output.unexpected(line, at);
            }
        }
        at += 1;
    }
    output.bytes.extend_from_slice(b"\r\n");
}

/// Writes a frame of the digits that it carries.
pub(super) fn spell(digits: &[u8], output: &mut Output) {
    output.bytes.push(b':');
    output.bytes.extend(digits.iter().map(u8::to_ascii_uppercase));
    output.bytes.extend_from_slice(b"\r\n");
}
