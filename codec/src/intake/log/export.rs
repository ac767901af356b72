//! The JSON Lines that a dissection is exported as: one object for each frame or stretch of noise.

use super::super::hex::{self, Span};
use super::super::line::{Line, hex_digits, spaces};
use super::super::output::Output;
use super::super::{IntakeFault, ascii};
use crate::dissect::Direction;

/// What such a line tells of its bytes.
pub(super) struct Export {
    digits: Span,
    pub(super) direction: Direction,
    pub(super) time_us: Option<u64>,
    /// The bytes are those that ASCII mode carries, not its characters.
    ascii: bool,
}

/// Takes a line apart; `None` if it is no object with bytes.
pub(super) fn find(codes: &[u8]) -> Option<Export> {
    if codes.get(spaces(codes, 0)) != Some(&b'{') {
        return None;
    }
    let start = value(codes, b"\"bytes\"")?;
    let start = start + usize::from(codes.get(start) == Some(&b'"'));
    let end = start + hex_digits(codes, start);
    if codes.get(end) != Some(&b'"') {
        return None;
    }
    let text = |key| value(codes, key).and_then(|at| codes.get(at..)).unwrap_or_default();
    let direction = match text(b"\"direction\"") {
        [b'"', b'r', b'e', b'q', ..] => Direction::Request,
        [b'"', b'r', b'e', b's', ..] => Direction::Response,
        _ => Direction::Unknown,
    };
    let time = text(b"\"time_us\"");
    let digits = time.iter().map_while(|code| code.is_ascii_digit().then(|| u64::from(code - b'0')));
    let us = digits.fold(0u64, |us, digit| us.saturating_mul(10).saturating_add(digit));
    let time_us = time.first().is_some_and(u8::is_ascii_digit).then_some(us);
    Some(Export { digits: Span { start, end }, direction, time_us, ascii: text(b"\"mode\"").starts_with(b"\"ascii\"") })
}

impl Export {
    pub(super) fn decode(&self, line: &Line, output: &mut Output) {
        let Span { start, end } = self.digits;
        if !self.ascii {
            return hex::digits(line, start, end, output);
        }
        let digits = line.codes.get(start..end).unwrap_or_default();
        if !digits.len().is_multiple_of(2) {
            output.fault(line, start, IntakeFault::OddDigits);
        }
        ascii::spell(digits, output);
    }
}

/// Where the value of the first member of this name begins.
fn value(codes: &[u8], key: &[u8]) -> Option<usize> {
    let at = codes.windows(key.len()).position(|window| window == key)? + key.len();
    let at = at + spaces(codes, at);
    (codes.get(at) == Some(&b':')).then(|| at + 1 + spaces(codes, at + 1))
}
