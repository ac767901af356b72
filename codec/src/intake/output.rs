//! What has been read: bytes, segments and faults, kept until they are taken.

use alloc::vec::Vec;
use core::mem;

use super::line::Line;
use super::{IntakeError, IntakeFault, MAX_FAULTS, Portion};
use crate::dissect::Direction;
use crate::line::Mode;
use crate::segment::Segment;
use crate::session::Remark;

#[derive(Clone, Debug, Default)]
pub(super) struct Output {
    pub(super) bytes: Vec<u8>,
    segments: Vec<Segment>,
    faults: Vec<IntakeError>,
    remarks: Vec<Remark>,
    pub(super) fault_count: usize,
    /// Bytes of the stream that have been taken.
    taken: usize,
    /// The last segment is an ASCII frame in hexadecimal codes whose line feed has not come.
    open: bool,
    /// The last line was no text, and it has been said.
    raw: bool,
}

impl Output {
    /// No byte has come in the whole stream.
    pub(super) fn is_empty(&self) -> bool {
        self.taken == 0 && self.bytes.is_empty()
    }

    /// Bytes of the whole stream so far.
    pub(super) fn stream_len(&self) -> usize {
        self.taken.saturating_add(self.bytes.len())
    }

    pub(super) fn segment(&mut self, segment: Segment) {
        self.segments.push(segment);
    }

    pub(super) fn remark(&mut self, remark: Remark) {
        self.remarks.push(remark);
    }

    pub(super) fn fault(&mut self, line: &Line, column: usize, fault: IntakeFault) {
        self.place(line.number, column + 1, fault);
    }

    /// The character in a column (from 0) fits nothing.
    pub(super) fn unexpected(&mut self, line: &Line, column: usize) {
        // To look a character up takes time: not for faults that nobody will see.
        let character = if self.fault_count < MAX_FAULTS { line.character(column) } else { ' ' };
        self.fault(line, column, IntakeFault::Unexpected(character));
    }

    pub(super) fn not_text(&mut self, line: &Line, column: usize) {
        if !mem::replace(&mut self.raw, true) {
            self.fault(line, column, IntakeFault::NotText);
        }
    }

    pub(super) fn text(&mut self) {
        self.raw = false;
    }

    pub(super) fn place(&mut self, line: usize, column: usize, fault: IntakeFault) {
        if self.fault_count < MAX_FAULTS {
            self.faults.push(IntakeError { line, column, fault });
        }
        self.fault_count = self.fault_count.saturating_add(1);
    }

    /// The bytes from `start` (in `bytes`) on are what a line holds: as they are on the wire, so that codes of ASCII
    /// characters make it an ASCII frame. Gives its mode.
    pub(super) fn close(&mut self, start: usize, line: usize, direction: Direction, time_us: Option<u64>) -> Mode {
        let bytes = self.bytes.get(start..).unwrap_or_default();
        if bytes.is_empty() {
            return Mode::Rtu;
        }
        let ascii = spells_ascii(bytes, self.open);
        self.open = ascii && bytes.last().is_some_and(|byte| byte & 0x7F != b'\n');
        let mode = if ascii { Mode::Ascii } else { Mode::Rtu };
        let (start, line) = (self.taken + start, u32::try_from(line).unwrap_or(u32::MAX));
        self.segments.push(Segment { start, mode, direction, time_us, line, ..Segment::default() });
        mode
    }

    pub(super) fn take(&mut self) -> Portion {
        self.taken += self.bytes.len();
        Portion {
            bytes: mem::take(&mut self.bytes),
            segments: mem::take(&mut self.segments),
            faults: mem::take(&mut self.faults),
            remarks: mem::take(&mut self.remarks),
        }
    }
}

/// Whether bytes are the characters of ASCII frames: a colon, digits, CR LF; each may have a parity bit. A line from colon
/// to CR LF may hold a few that are damaged. `open` says that a frame began before them.
fn spells_ascii(bytes: &[u8], open: bool) -> bool {
    let begins = |byte: &u8| byte & 0x7F == b':';
    let fits = |byte: &u8| matches!(byte & 0x7F, b':' | b'0'..=b'9' | b'A'..=b'F' | b'a'..=b'f' | b'\r' | b'\n');
    if !open && (bytes.len() < 3 || !bytes.first().is_some_and(begins)) {
        return false;
    }
    let strange = bytes.iter().filter(|byte| !fits(byte)).count();
    strange == 0 || (bytes.ends_with(b"\r\n") && strange.saturating_mul(4) < bytes.len())
}
