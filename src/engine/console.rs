//! The engine's end of the channel to the console's worker. It outlives the sessions: what nobody has taken waits here.

use std::time::Duration;

use buslens_analyst::line::{FromLine, LineState, PortState, Signals};
use buslens_bus::record::{End, Outcome, What};
use buslens_bus::time::Instant;
use buslens_codec::line::{LineSettings, Mode, Parity};

use super::recorder::Recorder;
use super::scope::Channel;

/// Least time between two messages of notes.
const NOTES_PERIOD: Duration = Duration::from_millis(25);

pub(super) struct Console {
    channel: Option<Channel>,
    recorder: Recorder,
    /// The line as it is now; sessions change it.
    pub(super) line: LineState,
    told: Option<LineState>,
    told_at: Instant,
}

impl Console {
    pub(super) fn new() -> Self {
        Self {
            channel: None,
            recorder: Recorder::default(),
            line: LineState {
                open: false,
                port: PortState::Gone,
                replay: false,
                simulated: false,
                line: LineSettings::new(9600, Parity::None),
                mode: Mode::Rtu,
                // The browser's default of 255 is less than one RTU frame.
                buffer_bytes: 8192,
                polling: false,
                read_only: false,
                signals: Signals::default(),
            },
            told: None,
            told_at: Instant::ZERO,
        }
    }

    /// Somebody listens now, and gets everything that has been kept.
    pub(super) fn attach(&mut self, now: Instant, channel: Channel) {
        self.channel = Some(channel);
        self.told = None;
        self.post(&FromLine::Clock(now.as_micros()));
    }

    /// Tells the clock, behind whatever has happened.
    pub(super) fn tell_clock(&mut self, now: Instant) {
        self.told_at = Instant::ZERO;
        self.tell(now);
        self.post(&FromLine::Clock(now.as_micros()));
    }

    pub(super) fn is_attached(&self) -> bool {
        self.channel.is_some()
    }

    pub(super) fn note(&mut self, now: Instant, what: What) {
        self.recorder.note(now, what);
    }

    pub(super) fn done(&self, id: u32, outcome: Outcome) {
        self.post(&FromLine::Done { id, outcome });
    }

    /// Nothing was sent.
    pub(super) fn unsent(&self, now: Instant, id: u32, end: End) {
        self.done(id, Outcome { at_us: now.as_micros(), heard: Vec::new(), round_trip_us: None, end });
    }

    /// Hands on what has happened, if it is time, and what has changed, after what happened before it. Says when it will
    /// be time.
    pub(super) fn tell(&mut self, now: Instant) -> Option<Instant> {
        self.channel.as_ref()?;
        let changed = self.told.as_ref() != Some(&self.line);
        let due = self.told_at + NOTES_PERIOD;
        if !self.recorder.is_empty() {
            if now < due && !changed {
                return Some(due);
            }
            self.told_at = now;
            let notes = self.recorder.take();
            self.post(&FromLine::Notes(notes));
        }
        if changed {
            self.post(&FromLine::State(self.line.clone()));
            self.told = Some(self.line.clone());
        }
        None
    }

    fn post(&self, message: &FromLine) {
        if let Some(channel) = &self.channel {
            channel.post(message);
        }
    }
}
