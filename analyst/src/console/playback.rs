//! A replay's pace: what of a recording happens next, and when.

use std::collections::VecDeque;
use std::time::Duration;

use buslens_bus::record::{Event, Note, What};
use buslens_bus::time::Instant;

use super::outbox::Outbox;
use crate::line::ToLine;
use crate::message::{FromConsole, Replay};

/// Notes that are handed to the engine together: few enough that it is never busy with them for long.
const PORTION: usize = 256;
/// Time between two portions at a recording's own pace.
const PERIOD: Duration = Duration::from_millis(12);
/// Bytes that the engine may have without having given them back: what it still plays after a stop.
const MOST_AWAY: usize = 16 << 10;
/// When nothing comes back for so long, nothing will.
const PATIENCE: Duration = Duration::from_secs(1);
/// Nobody reads faster how far a replay has come.
const NEWS_PERIOD: Duration = Duration::from_millis(100);

/// A replay that is on.
#[derive(Debug)]
pub(super) struct Playback {
    speed_permille: u32,
    /// What comes next, fetched ahead.
    ahead: VecDeque<Note>,
    /// The recording's first and last moment, in its own microseconds.
    first_us: u64,
    last_us: u64,
    /// When the engine was ready; nothing is played before.
    began: Option<Instant>,
    /// When something was played last, or came back.
    moved: Instant,
    played: Option<Instant>,
    played_us: u64,
    away: usize,
    exhausted: bool,
    told_at: Option<Instant>,
}

impl Playback {
    /// A replay of a recording between two moments of its own clock, at so many thousandths of its speed; 0 as fast as it
    /// goes.
    pub(super) fn new(now: Instant, speed_permille: u32, first_us: u64, last_us: u64) -> Self {
        Self {
            speed_permille,
            ahead: VecDeque::new(),
            first_us,
            last_us,
            began: None,
            moved: now,
            played: None,
            played_us: first_us,
            away: 0,
            exhausted: false,
            told_at: None,
        }
    }

    /// The engine's session is a replay now.
    pub(super) fn begin(&mut self, now: Instant) {
        self.began.get_or_insert(now);
        self.moved = now;
    }

    pub(super) fn has_begun(&self) -> bool {
        self.began.is_some()
    }

    /// These have come back as notes of the line.
    pub(super) fn take_back(&mut self, now: Instant, notes: &[Note]) {
        let bytes: usize = notes.iter().map(weight).sum();
        self.away = self.away.saturating_sub(bytes);
        self.moved = now;
    }

    /// Plays what is due; `fetch` gives the recording's next notes, none at its end. Whether the replay has come to its end.
    pub(super) fn play(&mut self, now: Instant, mut fetch: impl FnMut(usize) -> Vec<Note>, out: &mut Outbox) -> bool {
        let Some(began) = self.began else { return false };
        if self.away > 0 && now.saturating_since(self.moved) >= PATIENCE {
            self.away = 0;
        }
        let now_us = self.moment(now.saturating_since(began));
        while self.away < MOST_AWAY {
            if self.ahead.is_empty() && !self.exhausted {
                self.ahead.extend(fetch(PORTION));
                self.exhausted = self.ahead.is_empty();
            }
            let due = self.ahead.iter().take_while(|note| note.at_us <= now_us).count();
            if due == 0 {
                break;
            }
            let notes: Vec<Note> = self.ahead.drain(..due).collect();
            self.away += notes.iter().map(weight).sum::<usize>();
            self.played_us = notes.iter().map(|note| note.at_us).fold(self.played_us, u64::max);
            (self.moved, self.played) = (now, Some(now));
            out.order(ToLine::Play(notes));
        }
        let ended = self.exhausted && self.ahead.is_empty();
        if !ended && self.told_at.is_none_or(|told_at| now.saturating_since(told_at) >= NEWS_PERIOD) {
            self.told_at = Some(now);
            out.tell(FromConsole::Replay(self.state(true)));
        }
        ended
    }

    /// When [`Self::play`] has something to do next.
    pub(super) fn due(&self) -> Option<Instant> {
        let began = self.began?;
        if self.away >= MOST_AWAY {
            return Some(self.moved + PATIENCE);
        }
        let Some(next) = self.ahead.front() else { return (!self.exhausted).then_some(self.moved) };
        let earliest = self.played.map_or(began, |played| played + PERIOD);
        let news = self.told_at.map_or(began, |told_at| told_at + NEWS_PERIOD);
        match self.speed_permille {
            0 => Some(self.moved),
            speed => {
                let recorded = u128::from(next.at_us.saturating_sub(self.first_us));
                let elapsed = u64::try_from(recorded * 1000 / u128::from(speed)).unwrap_or(u64::MAX);
                let next = began + Duration::from_micros(elapsed) + Duration::from_micros(1);
                Some(next.max(earliest).min(news.max(earliest)))
            }
        }
    }

    /// How it stands.
    pub(super) fn state(&self, playing: bool) -> Replay {
        Replay {
            playing,
            at_us: self.played_us.saturating_sub(self.first_us),
            total_us: self.last_us.saturating_sub(self.first_us),
        }
    }

    /// Time of the recording that passes in so much time, at a pace of its own; none where it goes as fast as it can.
    pub(super) fn recorded(&self, elapsed: Duration) -> Duration {
        let recorded = elapsed.as_micros() * u128::from(self.speed_permille) / 1000;
        Duration::from_micros(u64::try_from(recorded).unwrap_or(u64::MAX))
    }

    /// The recording's moment that so much later is now.
    fn moment(&self, elapsed: Duration) -> u64 {
        match self.speed_permille {
            0 => u64::MAX,
            _ => (Instant::from_micros(self.first_us) + self.recorded(elapsed)).as_micros(),
        }
    }
}

/// Bytes of a note that are on the line.
pub(super) fn weight(note: &Note) -> usize {
    match &note.what {
        What::Sent { bytes, .. } | What::Received(bytes) => bytes.len(),
        What::Port(Event::Forgotten(bytes)) => usize::try_from(*bytes).unwrap_or(usize::MAX),
        What::Port(_) => 0,
    }
}
