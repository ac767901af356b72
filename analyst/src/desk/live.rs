//! The log of a line that is being watched: notes come in, entries come out.

use std::time::Duration;

use buslens_bus::record::{Note, What};
use buslens_codec::dissect::Direction;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::Profile;
use buslens_codec::segment::{Event, Origin, Segment};
use buslens_codec::transcript::{EntryKind, Transcript};
use buslens_codec::{ascii, rtu};

use super::{Desk, place};
use crate::diary::Diary;
use crate::message::ProfileChoice;

/// Entries that a log keeps unless somebody says otherwise.
const RING: u32 = 1_000_000;
/// The fewest and the most that it can be told to keep.
const RING_SIZES: (u32, u32) = (1000, 5_000_000);
/// Bytes that may be kept for each entry of the ring, so that long noise does not fill the memory either.
const BYTES_PER_ENTRY: u64 = 160;
/// Bytes that may be kept in any case.
const LEAST_BYTES: u64 = 16 << 20;
/// Entries that are forgotten at once: letting more go would hold up whoever waits.
const MOST_FORGOTTEN: usize = 8192;
/// Notes between two looks at the ring.
const NOTES: usize = 256;
/// Silence after which nothing is joined to what came before: more than any adapter, or a busy machine, holds bytes back.
const QUIET_US: u64 = 500_000;
/// The same behind a whole frame.
const QUIET_BEHIND_FRAME_US: u64 = 25_000;
/// The standard's patience between two characters in ASCII mode (serial line guide, clause 2.5.2.1).
const QUIET_IN_ASCII_US: u64 = 1_000_000;
/// So long after this side has sent, what is heard may be no answer but another master.
const SILENT_US: u64 = 2_000_000;
/// So long a request may still be answered, unless another frame comes.
const PATIENCE_US: u64 = 1_000_000;
/// Frames by which a log's device is judged, the latest.
const FRAMES_JUDGED: usize = 1000;
/// Entries after which it is judged for the first time; each time after four times as many.
const FIRST_JUDGEMENT: usize = 16;

/// What a desk has for a log that it does not need for a text.
#[derive(Debug)]
pub(super) struct Live {
    ring: u32,
    /// Settings of the line now.
    line: Option<(LineSettings, Mode)>,
    /// When the last note was made.
    last_us: u64,
    /// The latest moment that anybody has told of.
    now_us: u64,
    /// When the last bytes had gone over the line.
    end_us: u64,
    /// When this side sent something last.
    sent_us: Option<u64>,
    /// Which way received bytes go.
    heard: Direction,
    /// The device is judged again when there are so many entries.
    judged_at: usize,
}

impl Live {
    fn new(ring: u32, line: Option<(LineSettings, Mode)>) -> Self {
        Self {
            ring,
            line,
            last_us: 0,
            now_us: 0,
            end_us: 0,
            sent_us: None,
            heard: Direction::Unknown,
            judged_at: FIRST_JUDGEMENT,
        }
    }

    fn mode(&self) -> Mode {
        self.line.map_or(Mode::Rtu, |(_, mode)| mode)
    }

    /// Time that so many bytes take, in microseconds; 0 while the line's speed is not known.
    fn line_time_us(&self, bytes: usize) -> u64 {
        let time = self.line.map_or(Duration::ZERO, |(line, _)| line.character_time(bytes));
        u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
    }

    /// Silence that ends whatever is held back.
    fn patience_us(&self, held_back: &[u8]) -> u64 {
        let is_frame = match self.mode() {
            Mode::Rtu => rtu::decode(held_back).is_ok(),
            Mode::Ascii => ascii::decode(held_back).is_ok(),
        };
        match self.mode() {
            _ if is_frame => QUIET_BEHIND_FRAME_US,
            Mode::Rtu => QUIET_US.max(self.line_time_us(8)),
            Mode::Ascii => QUIET_IN_ASCII_US,
        }
    }

    /// What was handed to the port, and is on its way.
    fn sent(&mut self, at_us: u64, origin: Origin, bytes: usize) -> Segment {
        let span_us = self.line_time_us(bytes);
        self.end_us = at_us.saturating_add(span_us);
        self.sent_us = Some(at_us);
        self.heard = Direction::Response;
        Segment { origin, ..self.segment(Direction::Request, at_us, span_us) }
    }

    /// What has arrived: it was on the line before, but not before what came earlier.
    fn received(&mut self, at_us: u64, bytes: usize) -> Segment {
        let begin_us = at_us.saturating_sub(self.line_time_us(bytes)).max(self.end_us).min(at_us);
        self.end_us = at_us;
        self.segment(self.heard, begin_us, at_us - begin_us)
    }

    fn segment(&self, direction: Direction, time_us: u64, span_us: u64) -> Segment {
        let span_us = u32::try_from(span_us).unwrap_or(u32::MAX);
        Segment { mode: self.mode(), direction, time_us: Some(time_us), span_us, ..Segment::default() }
    }
}

impl Desk {
    /// A desk for the log of a line. `epoch_us` is the Unix time of the origin of the notes' clock, in microseconds.
    pub fn live(epoch_us: u64) -> Self {
        let diary = Diary::new(Some(epoch_us), None);
        Self { live: Some(Live::new(RING, None)), diary, ..Self::new() }
    }

    /// Takes notes in, in the order in which they were made. Every note costs time in proportion to its bytes, however
    /// long the log is. Rows, filter and counts follow at once, unless [`work`](Self::work) is still going through the
    /// whole log for a new filter or profile. Nothing on a desk for texts.
    pub fn record(&mut self, notes: &[Note]) {
        for some in notes.chunks(NOTES) {
            let before = self.transcript.end();
            for note in some {
                self.take(note);
            }
            self.keep_up(before);
        }
    }

    /// Makes entries of what is held back, if the line is quiet at `now_us`, a time of the notes' clock. Call it some
    /// 50 ms after the last notes; `u64::MAX` says that nothing will be joined to what has come.
    pub fn settle(&mut self, now_us: u64) {
        let before = self.transcript.end();
        self.pass_time(now_us);
        self.keep_up(before);
    }

    /// Keeps about so many entries from now on, 1000 to 5 000 000: at most an eighth more. The oldest go first; numbers of
    /// entries stay as they are.
    pub fn set_ring(&mut self, entries: u32) {
        if let Some(live) = &mut self.live {
            live.ring = entries.clamp(RING_SIZES.0, RING_SIZES.1);
            self.forget_oldest();
        }
    }

    /// Empties the log. The line's settings, filter, profile and ring size stay; numbers begin at 0 again.
    pub fn clear_log(&mut self) {
        let Some(live) = &mut self.live else { return };
        let fresh = Live::new(live.ring, live.line);
        *live = Live { heard: live.heard, sent_us: live.sent_us, ..fresh };
        self.diary = Diary::new(self.diary.epoch_us, live.line);
        self.transcript = Transcript::new();
        self.waiting = None;
        self.held_from = self.held_from.map(|_| 0);
        self.begin_survey();
        self.begin_sifting();
    }

    /// Holds the list still, or lets it go on: what was recorded meanwhile comes in then. The ring goes on forgetting.
    pub fn pause(&mut self, hold: bool) {
        let end = place(self.transcript.end());
        self.held_from = hold.then(|| self.held_from.unwrap_or(end));
    }

    /// Bytes of memory that the log takes, as far as they grow with it.
    pub fn footprint(&self) -> usize {
        let facts = self.facts.capacity() * size_of::<crate::facts::Facts>();
        self.transcript.footprint() + facts + self.shown.capacity() * size_of::<u32>()
    }

    /// The profile that explains most of the latest frames.
    pub(super) fn most_explaining_lately(&self) -> Option<Profile> {
        let first = self.transcript.end().saturating_sub(FRAMES_JUDGED).max(self.transcript.first());
        self.transcript.most_explaining_from(first, &self.candidates).cloned()
    }

    fn take(&mut self, note: &Note) {
        self.pass_time(note.at_us);
        let Some(live) = &mut self.live else { return };
        live.last_us = note.at_us;
        match &note.what {
            What::Sent { bytes, .. } | What::Received(bytes) if bytes.is_empty() => {}
            What::Sent { origin, bytes } => {
                let segment = live.sent(note.at_us, *origin, bytes.len());
                // It is whole: nothing goes on in it or behind it.
                self.transcript.settle();
                self.transcript.append(bytes, &segment);
                self.transcript.settle();
            }
            What::Received(bytes) => {
                let segment = live.received(note.at_us, bytes.len());
                self.transcript.append(bytes, &segment);
            }
            What::Port(event) => {
                let event = *event;
                if let Event::Opened(line, mode) = event {
                    live.line = Some((line, mode));
                    live.judged_at = live.judged_at.min(self.transcript.end() + FIRST_JUDGEMENT);
                }
                if matches!(event, Event::Opened(..) | Event::Closed | Event::Lost) {
                    (live.heard, live.sent_us) = (Direction::Unknown, None);
                }
                // After a damaged character the frame goes on.
                if event != Event::LineError {
                    self.transcript.settle();
                }
                self.diary.happen(self.transcript.stream_len(), note.at_us, event);
            }
        }
    }

    /// Nothing has been heard between the last note and `now_us`.
    fn pass_time(&mut self, now_us: u64) {
        let Some(live) = &mut self.live else { return };
        live.now_us = now_us;
        let silence = now_us.saturating_sub(live.last_us);
        if silence < QUIET_BEHIND_FRAME_US {
            return;
        }
        let held_back = self.transcript.held_back();
        let is_quiet = held_back.is_empty() || silence >= live.patience_us(held_back);
        if !is_quiet {
            return;
        }
        if !held_back.is_empty() {
            self.transcript.settle();
        }
        let is_silent = live.sent_us.is_none_or(|sent_us| now_us.saturating_sub(sent_us) >= SILENT_US);
        if silence >= QUIET_US && is_silent {
            live.heard = Direction::Unknown;
        }
    }

    /// Lists what has come, `before` being the number behind the last entry that was there before.
    fn keep_up(&mut self, before: usize) {
        self.diary.settle(&self.transcript);
        self.forget_oldest();
        self.judge();
        self.catch_up();
        self.wait();
        let fresh = self.transcript.end().saturating_sub(before);
        // A little more than what has come, so that a longer work comes to its end.
        self.work(2 * fresh + 16);
    }

    /// Finds the request whose answer may still come.
    fn wait(&mut self) {
        let Some(live) = &self.live else { return };
        let end = self.transcript.end();
        let latest = (self.transcript.first()..end).rev().take(5);
        let mut frames = latest.filter_map(|index| Some((index, self.transcript.entry(index)?)));
        let last = frames.find(|(_, entry)| entry.kind == EntryKind::Frame);
        let waiting = last.filter(|(_, entry)| {
            let time_us = entry.time_us.unwrap_or(0);
            entry.is_unanswered() && live.now_us.saturating_sub(time_us) < PATIENCE_US
        });
        let waiting = waiting.map(|(index, _)| place(index));
        if waiting != self.waiting
            && let Some(before) = std::mem::replace(&mut self.waiting, waiting)
        {
            self.survey_again(before as usize);
        }
    }

    /// Lets the oldest entries go, if there are too many or too much of them.
    fn forget_oldest(&mut self) {
        let Some(live) = &self.live else { return };
        let (first, end) = (self.transcript.first(), self.transcript.end());
        let ring = live.ring as usize;
        let mut keep_from = first;
        if end - first > ring + (ring / 8).min(MOST_FORGOTTEN) {
            keep_from = end - ring;
        }
        let most = (u64::from(live.ring) * BYTES_PER_ENTRY).max(LEAST_BYTES);
        let behind = self.transcript.stream_len();
        let offset = self.transcript.entry(keep_from).map_or(behind, |entry| entry.offset);
        if behind - offset > most + most / 8 {
            keep_from = self.transcript.entry_at(behind - most).unwrap_or(keep_from).max(keep_from);
        }
        if keep_from > first {
            self.uncount_before(keep_from);
            self.transcript.forget_before(keep_from);
            self.diary.forget_before(place(keep_from));
            self.take_sides();
            self.new_edition();
        }
    }

    /// Finds out now and then which device speaks, if nobody says.
    fn judge(&mut self) {
        let end = self.transcript.end();
        let Some(live) = self.live.as_mut().filter(|live| live.judged_at <= end) else { return };
        live.judged_at = end.saturating_mul(4);
        if !matches!(self.choice, ProfileChoice::Auto(_)) {
            return;
        }
        let found = self.most_explaining_lately();
        let id = |profile: &Option<Profile>| profile.as_ref().map(|profile| profile.id.clone());
        if found.is_some() && id(&found) != id(&self.profile) {
            self.take_up_profile();
        }
    }
}
