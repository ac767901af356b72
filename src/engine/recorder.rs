//! Keeps what has happened on the line until somebody takes it.

use std::collections::VecDeque;

use buslens_bus::record::{Event, Note, What};
use buslens_bus::time::Instant;

/// Memory for what nobody has taken, in bytes. The oldest goes first.
const MOST: usize = 4 << 20;
/// About what a note takes beside its bytes.
const OVERHEAD: usize = 64;

#[derive(Default)]
pub(super) struct Recorder {
    notes: VecDeque<Note>,
    size: usize,
    forgotten: u64,
}

impl Recorder {
    /// Notes what happens now. Bytes that come in the same moment as others are one arrival.
    pub(super) fn note(&mut self, now: Instant, what: What) {
        let at_us = now.as_micros();
        match (self.notes.back_mut(), &what) {
            (Some(Note { at_us: last, what: What::Received(before) }), What::Received(more)) if *last == at_us => {
                before.extend_from_slice(more);
                self.size += more.len();
            }
            _ => {
                self.size += OVERHEAD + bytes(&what);
                self.notes.push_back(Note { at_us, what });
            }
        }
        while self.size > MOST
            && let Some(oldest) = self.notes.pop_front()
        {
            self.size -= OVERHEAD + bytes(&oldest.what);
            self.forgotten += bytes(&oldest.what) as u64;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.notes.is_empty()
    }

    /// Everything that nobody has taken yet, oldest first; before it what had to be forgotten.
    pub(super) fn take(&mut self) -> Vec<Note> {
        self.size = 0;
        let forgotten = std::mem::take(&mut self.forgotten);
        if let Some(&Note { at_us, .. }) = self.notes.front().filter(|_| forgotten > 0) {
            self.notes.push_front(Note { at_us, what: What::Port(Event::Forgotten(forgotten)) });
        }
        std::mem::take(&mut self.notes).into()
    }
}

fn bytes(what: &What) -> usize {
    match what {
        What::Sent { bytes, .. } | What::Received(bytes) => bytes.len(),
        What::Port(_) => 0,
    }
}

#[cfg(test)]
mod tests {
    use buslens_bus::record::Origin;

    use super::*;

    fn at(us: u64) -> Instant {
        Instant::from_micros(us)
    }

    #[test]
    fn notes_come_out_once_and_in_order() {
        let mut recorder = Recorder::default();
        recorder.note(at(1), What::Sent { origin: Origin::Poll, bytes: vec![1] });
        recorder.note(at(5), What::Received(vec![2]));
        recorder.note(at(5), What::Received(vec![3, 4]));
        recorder.note(at(6), What::Received(vec![5]));
        let came: Vec<_> = recorder.take().into_iter().skip(1).map(|note| (note.at_us, note.what)).collect();
        assert_eq!(came, [(5, What::Received(vec![2, 3, 4])), (6, What::Received(vec![5]))]);
        assert!(recorder.is_empty() && recorder.take().is_empty());
    }

    #[test]
    fn what_nobody_takes_stays_bounded_and_what_is_forgotten_is_told() {
        let mut recorder = Recorder::default();
        let count = 3 * MOST as u64 / 264;
        for step in 0..count {
            recorder.note(at(step), What::Received(vec![0; 200]));
        }
        let notes = recorder.take();
        let kept: usize = notes.iter().map(|note| bytes(&note.what)).sum();
        assert!(kept + notes.len() * OVERHEAD <= MOST + OVERHEAD && kept > MOST / 2, "{kept}");
        assert_eq!(notes[0].what, What::Port(Event::Forgotten(200 * count - kept as u64)));
        assert_eq!(notes[0].at_us, notes[1].at_us);
        assert_eq!(notes.last().unwrap().at_us, count - 1);
        // A new page does not hear of it again.
        recorder.note(at(count), What::Port(Event::Closed));
        assert_eq!(recorder.take(), [Note { at_us: count, what: What::Port(Event::Closed) }]);
    }
}
