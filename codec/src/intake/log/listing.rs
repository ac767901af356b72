//! The text that a list is exported as: columns between tabs, of which the second is the way and the fifth the bytes.

use super::super::ascii;
use super::super::hex::{self, Span};
use super::super::line::Line;
use super::super::output::Output;
use super::time::{Stamp, stamp};
use crate::dissect::Direction;

/// What such a line tells of its bytes.
pub(super) struct Listed {
    bytes: Span,
    pub(super) direction: Direction,
    pub(super) time_us: Option<u64>,
}

/// Takes a line apart; `None` if it is none of these.
pub(super) fn find(codes: &[u8]) -> Option<Listed> {
    let mut start = 0;
    let mut columns = codes.split(|code| *code == b'\t').map(|column| {
        let span = Span { start, end: start + column.len() };
        start = span.end + 1;
        (span, column)
    });
    let (time, way) = (columns.next()?.0, columns.next()?.1);
    let direction = match way {
        b"TX" => Direction::Request,
        b"RX" => Direction::Response,
        b"--" => Direction::Unknown,
        _ => return None,
    };
    let (bytes, text) = columns.nth(2)?;
    let pair = |text: &[u8]| text.len() == 2 && text.iter().all(u8::is_ascii_hexdigit);
    let is_payload = match text {
        [b':', digits @ ..] => digits.iter().all(u8::is_ascii_hexdigit),
        text => text.split(|code| *code == b' ').all(pair),
    };
    (is_payload && text.len() > 1).then(|| Listed { bytes, direction, time_us: time_of(codes, time) })
}

fn time_of(codes: &[u8], time: Span) -> Option<u64> {
    let codes = codes.get(..time.end)?;
    match stamp(codes, time.start)? {
        (Stamp::Seconds(us) | Stamp::Time(us), _) => Some(us),
        (Stamp::Date(day_us), end) => match stamp(codes, end)? {
            (Stamp::Time(us), _) => Some(day_us?.saturating_add(us)),
            _ => None,
        },
    }
}

impl Listed {
    pub(super) fn decode(&self, line: &Line, output: &mut Output) {
        let Span { start, end } = self.bytes;
        if line.codes.get(start) == Some(&b':') {
            return ascii::frames(line, start, end, output);
        }
        for at in (start..end).step_by(3) {
            hex::digits(line, at, at + 2, output);
        }
    }
}
