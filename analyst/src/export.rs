//! Lists as files.

mod pcap;
mod session;
pub(crate) mod text;

use std::fmt::Write as _;

use buslens_bus::record::Origin;
use buslens_codec::UnitId;
use buslens_codec::dissect::Direction;
use buslens_codec::json::{self, Lines};
use buslens_codec::line::Mode;
use buslens_codec::profile::{Known, Profile};
use buslens_codec::transcript::{Entry, EntryKind, Transcript};

use crate::desk::{known_of, parts, place};
use crate::diary::Diary;
use crate::message::Format;
use crate::scale::Scales;
use crate::timing;

/// Bytes that are collected before they are handed on.
const PORTION: usize = 1 << 16;

/// A list with everything that files tell of it.
#[derive(Clone, Copy)]
pub(crate) struct Sheet<'a> {
    pub(crate) transcript: &'a Transcript,
    pub(crate) profile: Option<&'a Profile>,
    pub(crate) scales: &'a Scales,
    pub(crate) diary: &'a Diary,
    /// Number behind the last entry of the list.
    pub(crate) end: usize,
}

/// Collects a file, and hands it on in portions.
struct Portions<W> {
    text: String,
    write: W,
}

impl<W: FnMut(&[u8])> Portions<W> {
    fn hand_on(&mut self) {
        if self.text.len() >= PORTION {
            self.finish();
        }
    }

    fn finish(&mut self) {
        (self.write)(self.text.as_bytes());
        self.text.clear();
    }
}

impl Sheet<'_> {
    /// Writes entries, given by their numbers in ascending order, in portions.
    pub(crate) fn write(&self, format: Format, shown: impl Iterator<Item = usize>, write: impl FnMut(&[u8])) {
        let mut out = Portions { text: String::new(), write };
        match format {
            Format::Pcap => return pcap::write(self, shown, out.write),
            Format::JsonLines => self.write_json(shown, &mut out),
            Format::Csv => {
                out.text.push_str("index,offset,line,time_us,kind,mode,direction,unit,function,check,pair,bytes,");
                out.text.push_str("diagnoses,origin,gap_us,round_trip_us,mark\r\n");
                self.write_each(shown, &mut out, Self::csv_row);
            }
            Format::Hex => self.write_each(shown, &mut out, Self::hex_line),
            Format::Text => self.write_each(shown, &mut out, text::line),
            Format::Session => {
                session::head(self, &mut out.text);
                let mut written = place(self.transcript.first());
                for index in shown {
                    session::events(self, written..=place(index), &mut out.text);
                    written = place(index + 1);
                    session::entry(self, index, &mut out.text);
                    out.hand_on();
                }
                session::events(self, written..=place(self.end), &mut out.text);
            }
        }
        out.finish();
    }

    fn write_each<W: FnMut(&[u8])>(
        &self,
        shown: impl Iterator<Item = usize>,
        out: &mut Portions<W>,
        line: impl Fn(&Self, usize, &Entry, &mut String),
    ) {
        for index in shown {
            let Some(entry) = self.transcript.entry(index) else { continue };
            line(self, index, &entry, &mut out.text);
            out.hand_on();
        }
    }

    /// What single registers told of an entry's unit before it.
    fn known_before(&self, index: usize) -> Known {
        let unit = self.transcript.header(index).map(|(unit, _)| unit);
        let told = unit.map(|unit| self.scales.known_before(place(index), unit.0)).unwrap_or_default();
        known_of(self.profile, &told)
    }

    fn write_json<W: FnMut(&[u8])>(&self, shown: impl Iterator<Item = usize>, out: &mut Portions<W>) {
        let mut shown = shown.peekable();
        // Values are scaled by what came before, so that every entry is gone through.
        let mut lines = Lines::new(self.transcript, self.profile);
        let first = self.transcript.first();
        for unit in self.scales.units() {
            let told = self.scales.known_before(place(first), unit);
            lines.tell(UnitId(unit), known_of(self.profile, &told));
        }
        for index in first..self.end {
            let before = out.text.len();
            lines.write_next(&mut out.text);
            if shown.next_if_eq(&index).is_none() {
                out.text.truncate(before);
            } else if let Some(entry) = self.transcript.entry(index) {
                self.add_to_json(index, &entry, &mut out.text);
            }
            out.hand_on();
        }
    }

    /// Adds to an object, behind which a line feed stands, what a list knows beyond a dissection.
    fn add_to_json(&self, index: usize, entry: &Entry, out: &mut String) {
        // The diagnoses come last, as a list.
        out.truncate(out.trim_end().trim_end_matches('}').len());
        let numbers = [
            ("time_us", entry.time_us),
            ("gap_us", timing::gap_us(self.transcript, index, entry)),
            ("round_trip_us", timing::round_trip_us(self.transcript, entry)),
        ];
        for (key, value) in numbers {
            if let Some(value) = value {
                // Writing to a string cannot fail.
                let _ = write!(out, ",\"{key}\":{value}");
            }
        }
        let origin = timing::origin_of(self.transcript, entry);
        if origin != Origin::Unknown {
            let _ = write!(out, ",\"origin\":\"{}\"", origin.name());
        }
        if let Some(mark) = self.diary.mark_of(place(index)) {
            out.push_str(",\"mark\":");
            json::string(out, mark);
        }
        out.push_str("}\n");
    }

    fn hex_line(&self, index: usize, entry: &Entry, out: &mut String) {
        out.push_str(match (entry.kind, entry.direction) {
            (EntryKind::Frame, Direction::Request) => "TX: ",
            (EntryKind::Frame, Direction::Response) => "RX: ",
            _ => "",
        });
        hex(self.transcript.entry_bytes(index), Some(' '), out);
        out.push('\n');
    }

    /// A row of a table (RFC 4180). Only a comment can hold a comma or a quote.
    fn csv_row(&self, index: usize, entry: &Entry, out: &mut String) {
        let bytes = self.transcript.entry_bytes(index);
        let frame = parts(entry, bytes);
        let is_frame = entry.kind == EntryKind::Frame;
        let direction = match entry.direction {
            Direction::Request => "request",
            Direction::Response => "response",
            Direction::Unknown => "unknown",
        };
        let number = |value: Option<u64>| value.map(|value| value.to_string()).unwrap_or_default();
        let cells = [
            index.to_string(),
            entry.offset.to_string(),
            number(Some(entry.line.into()).filter(|line| *line > 0)),
            number(entry.time_us),
            if is_frame { "frame" } else { "noise" }.to_owned(),
            if entry.mode == Mode::Rtu { "rtu" } else { "ascii" }.to_owned(),
            if is_frame { direction } else { "" }.to_owned(),
            number(frame.as_ref().map(|(unit, _)| unit.0.into())),
            number(frame.as_ref().and_then(|(_, pdu)| pdu.first().map(|code| (code & 0x7F).into()))),
            match (is_frame, entry.check_ok) {
                (false, _) => "",
                (true, true) => "ok",
                (true, false) => "wrong",
            }
            .to_owned(),
            number(entry.pair.map(u64::from)),
        ];
        for cell in cells {
            out.push_str(&cell);
            out.push(',');
        }
        hex(bytes, None, out);
        out.push(',');
        for (at, diagnosis) in self.transcript.diagnoses(index).iter().enumerate() {
            out.push_str(if at > 0 { " " } else { "" });
            out.push_str(diagnosis.id());
        }
        let origin = timing::origin_of(self.transcript, entry);
        let cells = [
            if origin == Origin::Unknown { "" } else { origin.name() }.to_owned(),
            number(timing::gap_us(self.transcript, index, entry)),
            number(timing::round_trip_us(self.transcript, entry)),
            self.diary.mark_of(place(index)).map(quoted).unwrap_or_default(),
        ];
        for cell in cells {
            out.push(',');
            out.push_str(&cell);
        }
        out.push_str("\r\n");
    }
}

pub(crate) fn quoted(text: &str) -> String {
    ["\"", &text.replace('"', "\"\""), "\""].concat()
}

pub(crate) fn hex(bytes: &[u8], separator: Option<char>, out: &mut String) {
    let digits = b"0123456789ABCDEF";
    for (at, byte) in bytes.iter().enumerate() {
        out.extend(separator.filter(|_| at > 0));
        out.push(char::from(digits[usize::from(byte >> 4)]));
        out.push(char::from(digits[usize::from(byte & 0x0F)]));
    }
}
