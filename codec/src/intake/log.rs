//! Logs: lines of which some carry bytes beside time stamps, marks of direction, counters and words.
//!
//! No tool has a grammar of its own here. A line is searched for its parts: time stamps and dates, the strongest mark of
//! direction, and the run of byte tokens that is most likely what went over the line. A line with marks and no bytes is the
//! heading of the lines of bare bytes below it.

mod export;
mod mark;
mod run;
mod scan;
mod time;

use super::dump::Row;
use super::hex::Span;
use super::line::Line;
use super::output::Output;
use super::{ascii, hex, literal};
use crate::dissect::Direction;
use crate::line::Mode;
use crate::rtu;
use run::{Kind, Run};
use scan::{Found, scan};

/// What the lines so far tell of the next.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    heading: Option<Heading>,
    /// Some line had a mark of direction and bytes: lines of words without a mark are remarks.
    marked: bool,
}

/// What holds for lines of bare bytes.
#[derive(Clone, Copy, Debug)]
struct Heading {
    direction: Direction,
    time_us: Option<u64>,
    /// It stood with bytes that are no whole frame, rather than alone.
    broken: bool,
}

impl State {
    pub(super) fn line(&mut self, line: &Line, output: &mut Output) {
        let codes = line.codes;
        let start = output.bytes.len();
        if let Some(export) = export::find(codes) {
            export.decode(line, output);
            output.close(start, line.number, export.direction, export.time_us);
            return;
        }
        if let Some(row) = dump_row(codes) {
            row.decode(line, output);
            let heading = self.heading;
            let direction = heading.map_or(Direction::Unknown, |heading| heading.direction);
            output.close(start, line.number, direction, heading.and_then(|heading| heading.time_us));
            return;
        }
        let found = scan(codes);
        let remark = self.marked && found.words > 0 && !found.marked;
        let Some(run) = found.run.filter(|run| !remark && is_payload(codes, &found, run)) else {
            if found.direction != Direction::Unknown || found.time_us.is_some() {
                let (direction, time_us) = (found.direction, found.time_us);
                self.heading = Some(Heading { direction, time_us, broken: false });
            }
            return;
        };
        decode(line, run, output);
        let bytes = output.bytes.get(start..).unwrap_or_default();
        let whole = matches!(run.kind, Kind::Frame) || rtu::decode(bytes).is_ok();
        let bare = found.direction == Direction::Unknown && found.time_us.is_none();
        let (direction, time_us) = match self.heading {
            Some(heading) if bare && found.words == 0 => (heading.direction, heading.time_us),
            _ => (found.direction, found.time_us),
        };
        if !bare {
            self.marked |= found.direction != Direction::Unknown;
            self.heading = Some(Heading { direction, time_us, broken: true }).filter(|_| !whole);
        } else if self.heading.is_some_and(|heading| heading.broken) && whole {
            self.heading = None;
        }
        let mode = output.close(start, line.number, direction, time_us);
        if mode == Mode::Ascii {
            self.heading = self.heading.filter(|heading| !heading.broken);
        }
    }
}

/// Whether a run is what went over the line, and no number in a remark.
fn is_payload(codes: &[u8], found: &Found, run: &Run) -> bool {
    if matches!(run.kind, Kind::Frame | Kind::Literal) || run.bytes >= rtu::MIN_ADU_LEN {
        return true;
    }
    // A chunk of few bytes: nothing but marks may stand beside it.
    let ends = codes.iter().skip(run.end).all(|code| !code.is_ascii_alphanumeric() && *code < 0x80);
    let follows = found.words_since_mark == 0 && found.mark_end.is_some_and(|end| end <= run.start);
    ends && !found.common && (found.words == 0 || follows)
}

/// What a line looks like that may be one of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    /// Bytes beside marks, time stamps or words.
    Logged,
    /// Words without bytes.
    Words,
    /// Nothing of a log.
    Bare,
}

pub(super) fn look(codes: &[u8]) -> Look {
    if export::find(codes).is_some() {
        return Look::Logged;
    }
    let found = scan(codes);
    let run = found.run.filter(|run| is_payload(codes, &found, run));
    let told = found.marked || found.time_us.is_some() || found.is_angled();
    match run {
        Some(_) if told => Look::Logged,
        Some(run) if found.words > 0 && run.bytes >= rtu::MIN_ADU_LEN => Look::Logged,
        None if found.words > 0 || told => Look::Words,
        _ => Look::Bare,
    }
}

/// A row of a hex dump within a log.
fn dump_row(codes: &[u8]) -> Option<Row> {
    let row = Row::find(codes)?;
    // An offset of digits alone could be the beginning of the bytes.
    (row.bytes > 0 && row.marked).then_some(row)
}

/// Writes the bytes of a run.
fn decode(line: &Line, run: Run, output: &mut Output) {
    match run.kind {
        Kind::Frame => ascii::frames(line, run.start, run.end, output),
        Kind::Literal => literal::decode(line, run.start, run.end, output),
        Kind::Decimal | Kind::Hex => {
            let mut tokens = run::Tokens::new(line.codes, run);
            while let Some(token) = tokens.next() {
                match (token, run.kind) {
                    (Ok(digits), Kind::Decimal) => output.bytes.extend(super::decimal::byte(line.codes, digits)),
                    (Ok(Span { start, end }), _) => hex::digits(line, start, end, output),
                    (Err(at), _) => output.unexpected(line, at),
                }
            }
        }
    }
}
