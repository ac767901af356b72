//! Rows of the list.

use buslens_codec::dissect::Direction;
use buslens_codec::transcript::EntryKind;

use super::{Desk, known_of, parts, place};
use crate::message::{Row, Rows};
use crate::timing;

/// Bytes of a row that are sent; noise can be longer.
const ROW_BYTES: usize = 520;
/// Rows that are sent at once.
const MOST_ROWS: u32 = 512;

impl Desk {
    /// Some of the list as it is filtered.
    pub fn rows(&self, from: u32, count: u32) -> Rows {
        let wanted = (from..from.saturating_add(count.min(MOST_ROWS))).map_while(|at| self.shown_at(at as usize));
        let rows: Vec<Row> = wanted.filter_map(|index| self.row(index)).collect();
        if let (Some(first), Some(last)) = (rows.first(), rows.last()) {
            let (least, most) = self.told.get().unwrap_or((first.index, last.index));
            self.told.set(Some((least.min(first.index), most.max(last.index))));
        }
        Rows { edition: self.edition, from, rows }
    }

    fn row(&self, index: usize) -> Option<Row> {
        let entry = self.transcript.entry(index)?;
        let bytes = self.transcript.entry_bytes(index);
        let unit = self.transcript.header(index).map(|(unit, _)| unit);
        let told = unit.map(|unit| self.scales.known_before(place(index), unit.0)).unwrap_or_default();
        let mut known = known_of(self.profile.as_ref(), &told);
        let reading = self.transcript.reading(index, self.profile.as_ref(), &mut known);
        let request = entry.pair.filter(|_| entry.direction == Direction::Response);
        let request = request.and_then(|pair| {
            let asked = self.transcript.entry(pair as usize)?;
            parts(&asked, self.transcript.entry_bytes(pair as usize))
        });
        let waits = self.waiting == Some(place(index));
        Some(Row {
            index: place(index),
            offset: entry.offset,
            line: entry.line,
            time_us: entry.time_us,
            is_frame: entry.kind == EntryKind::Frame,
            mode: entry.mode,
            direction: entry.direction,
            pair: entry.pair,
            bytes: bytes.iter().take(ROW_BYTES).copied().collect(),
            length: entry.len,
            request: request.map(|(_, pdu)| pdu).unwrap_or_default(),
            told,
            diagnoses: reading.diagnoses,
            unanswered: entry.is_unanswered() && !self.one_sided && !waits,
            orphan: entry.is_orphan() && !self.one_sided,
            origin: timing::origin_of(&self.transcript, &entry),
            gap_us: timing::gap_us(&self.transcript, index, &entry),
            round_trip_us: timing::round_trip_us(&self.transcript, &entry),
            before: self.diary.before(place(index)).map(|happened| happened.event).collect(),
            mark: self.diary.mark_of(place(index)).map(str::to_owned),
        })
    }
}
