//! Logs: lines of which some carry bytes beside time stamps, marks of direction, counters and words.
//!
//! No tool has a grammar of its own here. A line is searched for its parts: time stamps and dates, the strongest mark of
//! direction, and the run of byte tokens that is most likely what went over the line. A line with marks and no bytes is the
//! heading of the lines of bare bytes below it.

mod export;
mod listing;
mod mark;
mod run;
mod scan;
mod time;

use alloc::vec::Vec;

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
    /// Bytes that stood with the heading and are no whole frame: bare bytes go on from there, up to a whole frame.
    part: Vec<u8>,
    /// Some line had a mark of direction and bytes: lines of words without a mark are remarks.
    marked: bool,
    /// The log is that of a libmodbus server, which receives requests.
    serves: bool,
}

/// What holds for lines of bare bytes.
#[derive(Clone, Copy, Debug)]
struct Heading {
    direction: Direction,
    time_us: Option<u64>,
}

impl State {
    pub(super) fn line(&mut self, line: &Line, output: &mut Output) {
        let start = output.bytes.len();
        if let Some(export) = export::find(line.codes) {
            export.decode(line, output);
            output.close(start, line.number, export.direction, export.time_us);
        } else if let Some(listed) = listing::find(line.codes) {
            listed.decode(line, output);
            output.close(start, line.number, listed.direction, listed.time_us);
        } else if let Some(row) = dump_row(line.codes) {
            row.decode(line, output);
            let Heading { direction, time_us } = self.heading.unwrap_or(Heading::NONE);
            output.close(start, line.number, direction, time_us);
        } else {
            self.scanned(line, output);
        }
    }

    fn scanned(&mut self, line: &Line, output: &mut Output) {
        let (codes, start) = (line.codes, output.bytes.len());
        let mut found = scan(codes);
        if self.serves && found.is_bracketed() {
            found.direction = match found.direction {
                Direction::Request => Direction::Response,
                Direction::Response => Direction::Request,
                Direction::Unknown => Direction::Unknown,
            };
        }
        self.serves |= found.indication;
        let own = Heading { direction: found.direction, time_us: found.time_us };
        let remark = self.marked && found.words > 0 && !found.marked;
        let Some(run) = found.run.filter(|run| !remark && is_payload(codes, &found, run)) else {
            if is_heading(&found) {
                self.heading = Some(own);
                self.part.clear();
            }
            return;
        };
        if let Some(other) = found.other {
            let (first, second) = if other.start < run.start { (other, run) } else { (run, other) };
            // An arrow between the two says nothing of the first.
            let direction = if found.mark_end.is_some() { own.direction } else { Direction::Unknown };
            decode(line, first, output);
            output.close(start, line.number, direction, own.time_us);
            let start = output.bytes.len();
            decode(line, second, output);
            output.close(start, line.number, found.second, own.time_us);
            self.heading = None;
            self.part.clear();
            return;
        }
        decode(line, run, output);
        let bytes = output.bytes.get(start..).unwrap_or_default();
        let bare = found.direction == Direction::Unknown && found.time_us.is_none() && found.words == 0;
        let heading = if bare { self.heading.unwrap_or(own) } else { own };
        if !bare {
            self.marked |= found.direction != Direction::Unknown;
            self.heading = Some(own);
            self.part.clear();
        }
        if !bare || !self.part.is_empty() {
            self.part.extend_from_slice(bytes);
            // Whole, or too long to become so.
            if run.kind == Kind::Frame || rtu::decode(&self.part).is_ok() || self.part.len() >= rtu::MAX_ADU_LEN {
                self.heading = None;
                self.part.clear();
            }
        }
        if output.close(start, line.number, heading.direction, heading.time_us) == Mode::Ascii && !self.part.is_empty()
        {
            self.heading = None;
            self.part.clear();
        }
    }
}

impl Heading {
    const NONE: Self = Self { direction: Direction::Unknown, time_us: None };
}

/// Whether a line without bytes speaks of those below it, and is no remark that has a common word of direction.
fn is_heading(found: &Found) -> bool {
    (found.marked && (!found.common || found.words == 0)) || found.time_us.is_some()
}

/// Whether a run is what went over the line, and no number in a remark.
fn is_payload(codes: &[u8], found: &Found, run: &Run) -> bool {
    if matches!(run.kind, Kind::Frame | Kind::Literal) {
        return true;
    }
    if run.bytes >= rtu::MIN_ADU_LEN {
        let told = found.marked && !found.common || found.words == 0 || found.is_bracketed();
        return told || run.is_convincing(codes);
    }
    // A chunk of few bytes: nothing but marks may stand beside it.
    let ends = codes.iter().skip(run.end).all(|code| !code.is_ascii_alphanumeric() && *code < 0x80);
    let stamped = found.marked || found.time_us.is_some();
    let begins = codes.iter().position(u8::is_ascii_alphanumeric).is_none_or(|at| at >= run.start);
    let follows = found.words_since_mark == 0 && found.mark_end.is_some_and(|end| end <= run.start);
    ends && !found.common && (stamped || begins) && (found.words == 0 || follows)
}

/// What a line looks like that may be one of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    /// Bytes beside a time stamp, or an export.
    Stamped,
    /// Bytes beside marks or words.
    Logged,
    /// A mark of direction, and bytes below it.
    Heading,
    /// Words without bytes.
    Words,
    /// Nothing of a log.
    Bare,
}

/// How many tokens of a line are a frame with a right check.
pub(super) fn framed(codes: &[u8]) -> Option<usize> {
    let found = scan(codes);
    let frame = found.run.filter(|run| run.is_frame(codes))?;
    Some(frame.tokens + found.other.map_or(0, |other| other.tokens))
}

pub(super) fn look(codes: &[u8]) -> Look {
    if export::find(codes).is_some() || listing::find(codes).is_some() {
        return Look::Stamped;
    }
    let found = scan(codes);
    let run = found.run.filter(|run| is_payload(codes, &found, run));
    let told = found.marked || found.time_us.is_some() || found.is_angled();
    match run {
        Some(_) if found.time_us.is_some() => Look::Stamped,
        Some(_) if told => Look::Logged,
        Some(run) if found.words > 0 && run.bytes >= rtu::MIN_ADU_LEN => Look::Logged,
        None if found.marked && is_heading(&found) => Look::Heading,
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
