//! Bytes from text that somebody pasted, with what the text says of direction, time and line.
//!
//! [`detect`] tells how a text is best read, a [`Reader`] reads it in pieces of any size, [`read`] does both at once. A fault
//! never stops the reading: whatever can be decoded is, the place is reported, and reading goes on behind it. The reader keeps
//! what has not been taken and at most one line of text; every line costs time in proportion to its length.
//!
//! ```
//! use buslens_codec::{dissect::Direction, intake};
//!
//! let intake = intake::read("Tx:000012-01 03 00 31 00 01 D5 C5\nRx:000013-01 03 02 00 07 F9 86");
//! assert_eq!(intake.bytes.len(), 15);
//! assert_eq!(intake.segments[1].start, 8);
//! assert_eq!(intake.segments[1].direction, Direction::Response);
//! ```

mod ascii;
mod decimal;
mod dump;
mod form;
mod hex;
mod line;
mod literal;
mod log;
mod output;

use alloc::string::String;
use alloc::vec::Vec;
use core::mem;

use serde::{Deserialize, Serialize};

pub use form::{Detection, Form, detect};

use crate::segment::Segment;
use crate::session::{self, Remark, Told};
use line::Line;
use output::Output;

/// Faults that are kept with their places; those after them are counted only.
pub const MAX_FAULTS: usize = 1000;

/// What a text holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Intake {
    /// The bytes of the stream; in ASCII mode the characters as on the wire, CR LF included.
    pub bytes: Vec<u8>,
    /// Where they come from: without gaps, in order; none where there are no bytes. A segment begins at each line that
    /// carries bytes.
    pub segments: Vec<Segment>,
    /// The first [`MAX_FAULTS`] faults, in the order of the text.
    pub faults: Vec<IntakeError>,
    /// All of them.
    pub fault_count: usize,
    /// How the text was read.
    pub form: Form,
    /// Another sensible reading.
    pub alternative: Option<Form>,
    /// What a session tells beside its bytes, in order.
    pub remarks: Vec<Remark>,
}

/// Where a text stops making sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
pub enum IntakeFault {
    /// A character that fits nothing there. Once for a word.
    #[error("unexpected {0:?}")]
    Unexpected(char),
    /// A run of hexadecimal digits that does not make whole bytes; the pairs from its left are taken.
    #[error("an odd number of digits")]
    OddDigits,
    /// A decimal number that no byte holds.
    #[error("a number that fits no byte")]
    TooLarge,
    /// Control characters: these are raw bytes, not text that names bytes. Once for lines in a row.
    #[error("this is not text")]
    NotText,
    /// A `*` of a hex dump that stands for more bytes than are taken in.
    #[error("a repetition that is too long")]
    RepeatTooLong,
    /// Text, and no bytes anywhere in it.
    #[error("no bytes in this text")]
    NoBytes,
}

/// What a [`Reader`] has read since it was last asked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Portion {
    /// The next bytes of the stream.
    pub bytes: Vec<u8>,
    /// The segments that begin among them; their starts count from the beginning of the whole stream.
    pub segments: Vec<Segment>,
    /// Faults found, as long as there have been no more than [`MAX_FAULTS`].
    pub faults: Vec<IntakeError>,
    /// What a session tells beside its bytes, in order; places count from the beginning of the whole stream.
    pub remarks: Vec<Remark>,
}

/// Reads a text of one form, in pieces of any size: their borders mean nothing.
#[derive(Clone, Debug)]
pub struct Reader {
    form: Form,
    /// The beginning of a line whose end has not come.
    pending: String,
    /// The last character was CR: an LF that follows ends the same line.
    after_cr: bool,
    lines: usize,
    any_text: bool,
    /// Room for the plain characters of a line.
    codes: Vec<u8>,
    hex: hex::State,
    dump: dump::State,
    log: log::State,
    output: Output,
}

impl Reader {
    /// A reader at the start of a text.
    pub fn new(form: Form) -> Self {
        Self {
            form,
            pending: String::new(),
            after_cr: false,
            lines: 0,
            any_text: false,
            codes: Vec::new(),
            hex: hex::State::default(),
            dump: dump::State::default(),
            log: log::State::default(),
            output: Output::default(),
        }
    }

    /// How it reads.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Faults found so far, kept or not.
    pub fn fault_count(&self) -> usize {
        self.output.fault_count
    }

    /// Takes the next piece of the text in.
    pub fn push(&mut self, text: &str) {
        let mut rest = text;
        if self.after_cr && !rest.is_empty() {
            self.after_cr = false;
            rest = rest.strip_prefix('\n').unwrap_or(rest);
        }
        while let Some(at) = rest.bytes().position(|byte| matches!(byte, b'\n' | b'\r')) {
            let (line, after) = rest.split_at(at);
            if self.pending.is_empty() {
                self.line(line);
            } else {
                self.pending.push_str(line);
                self.pending_line();
            }
            rest = after.strip_prefix("\r\n").or_else(|| after.get(1..)).unwrap_or_default();
            self.after_cr = after == "\r";
        }
        self.pending.push_str(rest);
    }

    /// No more text comes: the last line counts as whole.
    pub fn finish(&mut self) {
        if !self.pending.is_empty() {
            self.pending_line();
        }
        self.dump.finish(&mut self.output);
        if self.any_text && self.output.is_empty() && self.output.fault_count == 0 {
            self.output.place(1, 1, IntakeFault::NoBytes);
        }
    }

    /// What has been read since it was last taken. Before [`finish`](Self::finish) the line that is still open is not in it.
    pub fn take(&mut self) -> Portion {
        self.output.take()
    }

    fn pending_line(&mut self) {
        let mut pending = mem::take(&mut self.pending);
        self.line(&pending);
        pending.clear();
        self.pending = pending;
    }

    fn line(&mut self, text: &str) {
        self.lines += 1;
        if self.form == Form::Session {
            // It may hold no entry.
            return self.session_line(text);
        }
        let line = Line::new(text, self.lines, &mut self.codes);
        if line.is_blank() {
            return;
        }
        self.any_text = true;
        if let Some(column) = line.raw {
            self.output.not_text(&line, column);
            if line.is_raw() {
                return;
            }
        } else {
            self.output.text();
        }
        match self.form {
            Form::Hex => hex::line(&line, &mut self.hex, &mut self.output),
            Form::Decimal => decimal::line(&line, &mut self.hex, &mut self.output),
            Form::AsciiFrames => ascii::line(&line, &mut self.hex, &mut self.output),
            Form::HexDump => dump::line(&line, dump::Unit::Bytes, &mut self.dump, &mut self.output),
            Form::WordDump => dump::line(&line, dump::Unit::Words, &mut self.dump, &mut self.output),
            // It has no lines of this kind.
            Form::Session => {}
            Form::Log => self.log.line(&line, &mut self.output),
        }
    }

    fn session_line(&mut self, text: &str) {
        let number = u32::try_from(self.lines).unwrap_or(u32::MAX);
        let start = self.output.stream_len();
        match session::line(text, self.lines, &mut self.output.bytes) {
            Ok(session::Read::Nothing) => {}
            Ok(session::Read::Told(told)) => self.output.remark(Remark::new(start, told)),
            Ok(session::Read::Entry(segment, mark)) => {
                self.output.segment(Segment { start, line: number, ..segment });
                if let Some(mark) = mark {
                    self.output.remark(Remark::new(start, Told::Mark(mark)));
                }
            }
            Err((at, fault)) => {
                let column = text.get(..at).unwrap_or(text).chars().count();
                self.output.place(self.lines, column + 1, fault);
            }
        }
    }
}

/// Reads a whole text as what it looks like.
pub fn read(text: &str) -> Intake {
    let Detection { form, alternative } = detect(text);
    Intake { alternative, ..read_as(text, form) }
}

/// Reads a whole text in a given form; no alternative is looked for.
pub fn read_as(text: &str, form: Form) -> Intake {
    let mut reader = Reader::new(form);
    reader.push(text);
    reader.finish();
    let Portion { bytes, segments, faults, remarks } = reader.take();
    Intake { bytes, segments, faults, fault_count: reader.fault_count(), form, alternative: None, remarks }
}

#[cfg(test)]
mod tests;
