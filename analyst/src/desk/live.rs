//! The log of a line that is being watched: notes come in, entries come out.

use std::collections::BTreeMap;

use buslens_bus::record::{Note, What};
use buslens_codec::dissect::Direction;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::segment::Segment;

use super::{Desk, place};

/// Entries that a log keeps unless somebody says otherwise.
const RING: u32 = 1_000_000;
/// The fewest and the most that it can be told to keep.
const RING_SIZES: (u32, u32) = (1000, 5_000_000);

/// What a desk has for a log that it does not need for a text.
#[derive(Debug)]
pub(super) struct Live {
    /// Unix time of the clock's origin, in microseconds.
    epoch_us: u64,
    ring: u32,
    line: Option<(LineSettings, Mode)>,
    marks: BTreeMap<u32, String>,
    held_from: Option<u32>,
}

/// A place in a log that is being played.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cursor {
    entry: u32,
}

impl Desk {
    /// A desk for the log of a line. `epoch_us` is the Unix time of the origin of the notes' clock, in microseconds.
    pub fn live(epoch_us: u64) -> Self {
        let live = Live { epoch_us, ring: RING, line: None, marks: BTreeMap::new(), held_from: None };
        Self { live: Some(live), ..Self::new() }
    }

    /// Takes notes in, in the order in which they were made. Every note costs time in proportion to its bytes, however
    /// long the log is. Rows, filter and counts follow at once, unless [`work`](Self::work) is still going through the
    /// whole log for a new filter or profile.
    pub fn record(&mut self, notes: &[Note]) {
        for Note { at_us, what } in notes {
            let (bytes, direction) = match what {
                What::Sent { bytes, .. } => (bytes, Direction::Request),
                What::Received(bytes) => (bytes, Direction::Response),
                _ => continue,
            };
            let mode = self.live.as_ref().and_then(|live| live.line).map_or(Mode::Rtu, |(_, mode)| mode);
            let time_us = Some(*at_us);
            self.transcript.append(bytes, &Segment { mode, direction, time_us, ..Segment::default() });
        }
    }

    /// Makes entries of what is held back, if the line is quiet at `now_us`, a time of the notes' clock. Call it some
    /// 50 ms after the last notes; `u64::MAX` says that nothing will be joined to what has come.
    pub fn settle(&mut self, now_us: u64) {
        if now_us > 0 {
            self.transcript.settle();
        }
    }

    /// Keeps about so many entries from now on, 1000 to 5 000 000: at most an eighth more. The oldest go first; numbers of
    /// entries stay as they are.
    pub fn set_ring(&mut self, entries: u32) {
        if let Some(live) = &mut self.live {
            live.ring = entries.clamp(RING_SIZES.0, RING_SIZES.1);
        }
    }

    /// Empties the log. The line's settings, filter, profile and ring size stay; numbers begin at 0 again.
    pub fn clear_log(&mut self) {
        self.transcript = buslens_codec::transcript::Transcript::new();
        self.take_up_profile();
    }

    /// Holds the list still, or lets it go on: what was recorded meanwhile comes in then. The ring goes on forgetting.
    pub fn pause(&mut self, hold: bool) {
        let entries = place(self.transcript.end());
        if let Some(live) = &mut self.live {
            live.held_from = hold.then(|| live.held_from.unwrap_or(entries));
        }
    }

    /// Marks an entry, given by its number, or takes its mark away; `false` if there is no such entry.
    pub fn mark(&mut self, index: u32, comment: Option<String>) -> bool {
        let Some(live) = &mut self.live else { return false };
        match comment {
            Some(comment) => drop(live.marks.insert(index, comment)),
            None => drop(live.marks.remove(&index)),
        }
        (index as usize) < self.transcript.end()
    }

    /// Unix time of the origin of the entries' clock, in microseconds, where it is known.
    pub fn epoch_us(&self) -> Option<u64> {
        self.live.as_ref().map(|live| live.epoch_us)
    }

    /// The settings of the line at the beginning of the log, where it tells them.
    pub fn line_at_start(&self) -> Option<(LineSettings, Mode)> {
        self.live.as_ref().and_then(|live| live.line)
    }

    /// The log as notes again, from its beginning: for a replay. What was sent is sent, and so are requests that were only
    /// heard; everything else is received, whole frames at their ends. Times never go back; entries of texts without
    /// times get such as the line's speed allows.
    pub fn notes(&self) -> impl Iterator<Item = Note> + '_ {
        let mut cursor = Cursor::default();
        std::iter::from_fn(move || self.next_note(&mut cursor))
    }

    /// The next of the [`notes`](Self::notes), for who cannot hold an iterator. A new cursor stands at the beginning.
    pub fn next_note(&self, cursor: &mut Cursor) -> Option<Note> {
        let entry = self.transcript.entry(cursor.entry as usize)?;
        let bytes = self.transcript.entry_bytes(cursor.entry as usize).to_vec();
        cursor.entry += 1;
        let what = match entry.direction {
            Direction::Request => What::Sent { origin: entry.origin, bytes },
            _ => What::Received(bytes),
        };
        Some(Note { at_us: entry.time_us.unwrap_or(0), what })
    }

    /// Time from the first of the [`notes`](Self::notes) to the last, in microseconds.
    pub fn duration_us(&self) -> u64 {
        let mut notes = self.notes().map(|note| note.at_us);
        let first = notes.next().unwrap_or(0);
        notes.last().unwrap_or(first).saturating_sub(first)
    }
}
