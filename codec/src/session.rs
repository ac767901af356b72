//! A saved session: a log as text, a line an entry, from which nothing of it is lost.
//!
//! The file is described in `docs/sessions.md`. This module writes it; [`intake`](crate::intake) reads it as
//! [`Form::Session`](crate::intake::Form::Session).

mod read;

use alloc::string::String;
use core::fmt::Write as _;

pub(crate) use read::{Read, is_session, line};

use crate::dissect::Direction;
use crate::line::{LineSettings, Mode};
use crate::segment::Event;
use crate::transcript::Entry;

/// The first line of every session of this version.
pub const TITLE: &str = "Buslens session 1";

/// What a session tells beside its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// Bytes of the stream before it; of a mark those before the entry that is marked.
    pub at: usize,
    /// What.
    pub told: Told,
}

/// What is told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Told {
    /// Unix time of the origin of the session's clock, in microseconds.
    Epoch(u64),
    /// Settings in force at the beginning.
    Line(LineSettings, Mode),
    /// Something happened to the port.
    Event {
        /// When, in microseconds on the session's clock.
        at_us: u64,
        /// What.
        event: Event,
    },
    /// The user's mark on an entry, with what is to be remembered.
    Mark(String),
}

/// Writes the head: Unix time of the clock's origin in microseconds, and settings in force at the beginning, where they are
/// known.
pub fn write_head(out: &mut String, epoch_us: Option<u64>, line: Option<(LineSettings, Mode)>) {
    out.push_str(TITLE);
    out.push('\n');
    if let Some(epoch_us) = epoch_us {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "epoch {epoch_us}");
    }
    if let Some((line, mode)) = line {
        let _ = writeln!(out, "line {line} {}", mode_name(mode));
    }
}

/// Writes the line of an event.
pub fn write_event(out: &mut String, at_us: u64, event: Event) {
    write_time(out, at_us);
    let _ = match event {
        Event::LineError => out.write_str(" error"),
        Event::Break(ms) => write!(out, " break {ms}"),
        Event::Opened(line, mode) => write!(out, " opened {line} {}", mode_name(mode)),
        Event::Closed => out.write_str(" closed"),
        Event::Lost => out.write_str(" lost"),
        Event::Forgotten(bytes) => write!(out, " forgotten {bytes}"),
    };
    out.push('\n');
}

/// Writes the line of an entry with its bytes, and its mark if it has one.
pub fn write_entry(out: &mut String, entry: &Entry, bytes: &[u8], mark: Option<&str>) {
    match entry.time_us {
        Some(time_us) => write_time(out, time_us),
        None => out.push('-'),
    }
    out.push(' ');
    write_time(out, entry.span_us.into());
    out.push_str(match entry.mark {
        Direction::Request => " TX ",
        Direction::Response => " RX ",
        Direction::Unknown => " ?? ",
    });
    out.push_str(entry.origin.name());
    if entry.mode == Mode::Ascii {
        out.push_str(" ascii");
    }
    let digits = b"0123456789ABCDEF";
    for byte in bytes {
        out.push(' ');
        out.extend([byte >> 4, byte & 0x0F].map(|digit| char::from(digits[usize::from(digit)])));
    }
    if let Some(mark) = mark {
        out.push_str(" * ");
        write_quoted(out, mark);
    }
    out.push('\n');
}

fn write_time(out: &mut String, us: u64) {
    let _ = write!(out, "{}.{:06}", us / 1_000_000, us % 1_000_000);
}

fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Rtu => "rtu",
        Mode::Ascii => "ascii",
    }
}

/// A text between quotes, on one line whatever it holds.
fn write_quoted(out: &mut String, text: &str) {
    out.push('"');
    for character in text.chars() {
        match character {
            '"' | '\\' => out.extend(['\\', character]),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            // Some editors end a line at the last two.
            _ if character.is_control() || matches!(character, '\u{2028}' | '\u{2029}') => {
                let _ = write!(out, "\\u{{{:x}}}", u32::from(character));
            }
            _ => out.push(character),
        }
    }
    out.push('"');
}

#[cfg(test)]
mod tests;
