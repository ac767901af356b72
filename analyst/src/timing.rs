//! Times of entries to each other.

use buslens_bus::record::Origin;
use buslens_codec::dissect::Direction;
use buslens_codec::line::LineSettings;
use buslens_codec::transcript::{Entry, Transcript};

/// Silence before a reply, where nobody noted times: devices think for some milliseconds.
const TURNAROUND_US: u64 = 5000;
/// Silence before a request.
const PAUSE_US: u64 = 20_000;

/// Time since the end of the entry before, in microseconds; `None` where there is none, or where times go back.
pub(crate) fn gap_us(transcript: &Transcript, index: usize, entry: &Entry) -> Option<u64> {
    let before = transcript.entry(index.checked_sub(1)?)?;
    let (time, earlier) = (entry.time_us?, before.time_us?);
    // The end of what was sent is reckoned: an answer may seem to begin before it.
    (time >= earlier).then(|| time.saturating_sub(before.end_us().unwrap_or(earlier)))
}

/// Of a reply, the time from the beginning of its request to its own end, in microseconds.
pub(crate) fn round_trip_us(transcript: &Transcript, entry: &Entry) -> Option<u64> {
    let request = request_of(transcript, entry)?;
    entry.end_us()?.checked_sub(request.time_us?)
}

/// Who had an entry sent; of a reply, who had its request sent.
pub(crate) fn origin_of(transcript: &Transcript, entry: &Entry) -> Origin {
    match entry.origin {
        Origin::Unknown => request_of(transcript, entry).map_or(Origin::Unknown, |request| request.origin),
        origin => origin,
    }
}

fn request_of(transcript: &Transcript, entry: &Entry) -> Option<Entry> {
    let pair = entry.pair.filter(|_| entry.direction == Direction::Response)?;
    transcript.entry(pair as usize)
}

/// Puts entries and events on one clock that never goes back, whatever their own times are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Timeline {
    now_us: u64,
    /// Added to own times.
    shift_us: u64,
    begun: bool,
}

impl Timeline {
    /// An own time on this clock.
    pub(crate) fn event(&mut self, at_us: u64) -> u64 {
        let at_us = at_us.saturating_add(self.shift_us);
        if self.begun && at_us < self.now_us {
            // The clock was set back, or another log begins: it goes on from here.
            self.shift_us = self.shift_us.saturating_add(self.now_us - at_us);
        }
        self.begun = true;
        self.now_us = self.now_us.max(at_us);
        self.now_us
    }

    /// Beginning and end of an entry on this clock. Without a time of its own it comes when the line allows; `sent` has a
    /// pause before it. The clock then stands at the beginning of what was sent, and at the end of what was received.
    pub(crate) fn entry(&mut self, entry: &Entry, sent: bool, line: LineSettings) -> (u64, u64) {
        let span = u64::from(entry.span_us);
        if let Some(time_us) = entry.time_us {
            let noted = if sent { time_us } else { time_us.saturating_add(span) };
            let noted = self.event(noted);
            return if sent { (noted, noted.saturating_add(span)) } else { (noted.saturating_sub(span), noted) };
        }
        let micros =
            |characters: u32| u64::try_from(line.character_time(characters as usize).as_micros()).unwrap_or(u64::MAX);
        let silence = if sent { PAUSE_US } else { TURNAROUND_US };
        let gap = silence.max(u64::try_from(line.frame_gap().as_micros()).unwrap_or(u64::MAX));
        let begin = if self.begun { self.now_us.saturating_add(gap) } else { 0 };
        let end = begin.saturating_add(micros(entry.len));
        self.begun = true;
        // What comes without a time after this one comes after its end.
        self.now_us = end;
        (begin, end)
    }
}
