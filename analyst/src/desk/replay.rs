//! The list as notes again, for a replay.

use buslens_bus::record::{Note, What};
use buslens_codec::dissect::Direction;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::segment::Event;
use buslens_codec::transcript::Entry;

use super::{Desk, place};
use crate::timing::Timeline;

/// What a line is taken for that nobody tells of.
const USUAL_LINE: LineSettings = LineSettings::new(9600, Parity::None);

/// A place in a list that is being played.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cursor {
    entry: usize,
    /// Events before this entry that have been given out.
    events: usize,
    timeline: Timeline,
}

/// What happens next.
enum Step {
    Event(Event),
    Entry(usize, Entry),
}

impl Desk {
    /// Settings of the line at the beginning of the list, where it tells them.
    pub fn line_at_start(&self) -> Option<(LineSettings, Mode)> {
        self.diary.line_at_start(place(self.transcript.first()))
    }

    /// The whole list as notes again, whatever the filter: for a replay. What was sent is sent, and so are requests that
    /// were only heard; everything else is received, whole entries at their ends. Times never go back; entries without
    /// times get such as the line's speed allows.
    pub fn notes(&self) -> impl Iterator<Item = Note> + '_ {
        let mut cursor = Cursor::default();
        std::iter::from_fn(move || self.next_note(&mut cursor))
    }

    /// The next of the [`notes`](Self::notes), for who cannot hold an iterator. A new cursor stands at the beginning.
    pub fn next_note(&self, cursor: &mut Cursor) -> Option<Note> {
        let (at_us, step) = self.step(cursor)?;
        let what = match step {
            Step::Event(event) => What::Port(event),
            Step::Entry(index, entry) => {
                let bytes = self.transcript.entry_bytes(index).to_vec();
                if is_sent(&entry) { What::Sent { origin: entry.origin, bytes } } else { What::Received(bytes) }
            }
        };
        Some(Note { at_us, what })
    }

    /// Time from the first of the [`notes`](Self::notes) to the last, in microseconds. Goes through the whole list.
    pub fn duration_us(&self) -> u64 {
        let mut cursor = Cursor::default();
        let mut times = std::iter::from_fn(|| self.step(&mut cursor)).map(|(at_us, _)| at_us);
        let first = times.next().unwrap_or(0);
        times.last().unwrap_or(first).saturating_sub(first)
    }

    fn step(&self, cursor: &mut Cursor) -> Option<(u64, Step)> {
        if cursor.entry < self.transcript.first() {
            (cursor.entry, cursor.events) = (self.transcript.first(), 0);
        }
        if let Some(happened) = self.diary.before(place(cursor.entry)).nth(cursor.events) {
            cursor.events += 1;
            return Some((cursor.timeline.event(happened.at_us), Step::Event(happened.event)));
        }
        let index = cursor.entry;
        let entry = self.transcript.entry(index)?;
        (cursor.entry, cursor.events) = (index + 1, 0);
        let told = self.line_at_start().map(|(line, _)| line);
        let line = told.or(self.profile.as_ref().map(|profile| profile.line)).unwrap_or(USUAL_LINE);
        let sent = is_sent(&entry);
        let (begin, end) = cursor.timeline.entry(&entry, sent, line);
        Some((if sent { begin } else { end }, Step::Entry(index, entry)))
    }
}

fn is_sent(entry: &Entry) -> bool {
    entry.mark == Direction::Request || (entry.direction == Direction::Request && !entry.echo)
}
