//! Bytes as decimal numbers: `1, 4, 0, 2, 0, 4, 80, 9`.

use super::hex::{self, Span};
use super::line::{Line, hex_digits, is_space};
use super::output::Output;
use super::{IntakeFault, ascii};
use crate::dissect::Direction;

/// Reads a line of numbers from 0 to 255; those that a prefix or a suffix marks as hexadecimal are read as such, and those
/// from -128 to -1 as the bytes that Java prints so.
pub(super) fn line(line: &Line, state: &mut hex::State, output: &mut Output) {
    if ascii::is_frame(line.codes, super::line::spaces(line.codes, 0)) {
        return ascii::line(line, state, output);
    }
    let start = output.bytes.len();
    hex::each_lexeme(line, state, output, |output, digits, hex| {
        if hex {
            hex::digits(line, digits.start, digits.end, output);
        } else {
            match byte(line.codes, digits) {
                Ok(byte) => output.bytes.push(byte),
                Err(None) => output.fault(line, digits.start, IntakeFault::TooLarge),
                Err(Some(column)) => output.unexpected(line, column),
            }
        }
    });
    output.close(start, line.number, Direction::Unknown, None);
}

/// The byte of a decimal number; else the column of its first character that is no decimal digit, `None` where it is too large.
pub(super) fn byte(codes: &[u8], Span { start, end }: Span) -> Result<u8, Option<usize>> {
    let mut value = 0u32;
    for (column, code) in (start..).zip(codes.get(start..end).unwrap_or_default()) {
        if !code.is_ascii_digit() {
            return Err(Some(column));
        }
        value = value.saturating_mul(10).saturating_add(u32::from(code - b'0'));
    }
    if is_negative(codes, start) {
        value = 256u32.checked_sub(value).filter(|value| *value >= 128).unwrap_or(256);
    }
    u8::try_from(value).map_err(|_| None)
}

/// Whether a minus sign, and not a dash between bytes, stands before the number at `start`.
pub(super) fn is_negative(codes: &[u8], start: usize) -> bool {
    let before = |back: usize| start.checked_sub(back).and_then(|at| codes.get(at));
    before(1) == Some(&b'-')
        && before(2).is_none_or(|code| is_space(*code) || matches!(code, b',' | b'[' | b'(' | b'{'))
        && hex_digits(codes, start) <= 3
}
