//! Lists as files.

use buslens_codec::dissect::Direction;
use buslens_codec::json::Lines;
use buslens_codec::line::Mode;
use buslens_codec::profile::Profile;
use buslens_codec::transcript::{EntryKind, Transcript};

use crate::desk::parts;
use crate::message::Format;

/// Characters that are collected before they are handed on.
const PORTION: usize = 1 << 16;

/// Writes entries, given by their numbers in ascending order, in portions.
pub(crate) fn write(
    transcript: &Transcript,
    profile: Option<&Profile>,
    format: Format,
    shown: impl Iterator<Item = usize>,
    mut write: impl FnMut(&[u8]),
) {
    let mut text = String::new();
    let mut hand_on = |text: &mut String| {
        if text.len() >= PORTION {
            write(text.as_bytes());
            text.clear();
        }
    };
    let mut shown = shown.peekable();
    match format {
        Format::JsonLines => {
            // Values are scaled by what came before, so that every entry is gone through.
            let mut lines = Lines::new(transcript, profile);
            for index in 0..transcript.end() {
                let before = text.len();
                lines.write_next(&mut text);
                if shown.next_if_eq(&index).is_none() {
                    text.truncate(before);
                }
                hand_on(&mut text);
            }
        }
        Format::Csv => {
            text.push_str("index,offset,line,time_us,kind,mode,direction,unit,function,check,pair,bytes,diagnoses\r\n");
            for index in shown {
                csv_row(transcript, index, &mut text);
                hand_on(&mut text);
            }
        }
        Format::Hex | Format::Text | Format::Pcap | Format::Session => {
            for index in shown {
                let Some(entry) = transcript.entry(index) else { break };
                text.push_str(match (entry.kind, entry.direction) {
                    (EntryKind::Frame, Direction::Request) => "TX: ",
                    (EntryKind::Frame, Direction::Response) => "RX: ",
                    _ => "",
                });
                hex(transcript.entry_bytes(index), Some(' '), &mut text);
                text.push('\n');
                hand_on(&mut text);
            }
        }
    }
    write(text.as_bytes());
}

/// A row of a table (RFC 4180). No cell can hold a comma or a quote.
fn csv_row(transcript: &Transcript, index: usize, out: &mut String) {
    let Some(entry) = transcript.entry(index) else { return };
    let bytes = transcript.entry_bytes(index);
    let frame = parts(&entry, bytes);
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
        if !is_frame {
            ""
        } else if entry.check_ok {
            "ok"
        } else {
            "wrong"
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
    for (at, diagnosis) in transcript.diagnoses(index).iter().enumerate() {
        out.push_str(if at > 0 { " " } else { "" });
        out.push_str(diagnosis.id());
    }
    out.push_str("\r\n");
}

fn hex(bytes: &[u8], separator: Option<char>, out: &mut String) {
    let digits = b"0123456789ABCDEF";
    for (at, byte) in bytes.iter().enumerate() {
        out.extend(separator.filter(|_| at > 0));
        out.push(char::from(digits[usize::from(byte >> 4)]));
        out.push(char::from(digits[usize::from(byte & 0x0F)]));
    }
}
