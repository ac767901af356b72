//! The console: the log of a live line and all that is done to the line from it. It says what it wants of the engine and
//! reads no clock; its program gives it a worker to live in.
//!
//! In: [`Console::hear`], [`Console::hear_line`], [`Console::hear_store`], [`Console::handle_time`]. After any of them call [`Console::work`] until
//! it has no more to do, and drain [`Console::poll_line`], [`Console::poll_store`], [`Console::poll_news`], [`Console::poll_progress`],
//! [`Console::poll_statistics`] and [`Console::poll_timeout`]. Times are the worker's own but where an item says that they
//! are the engine's.
//!
//! There are up to three lists: the log of the line, a text that was brought in, and what a replay has brought forth. One
//! of them is in view; the line's log goes on whatever is in view.

mod configuring;
mod ledger;
mod outbox;
mod playback;
mod running;
mod sends;

use std::collections::VecDeque;
use std::time::Duration;

use buslens_bus::record::Note;
use buslens_bus::time::Instant;
use buslens_codec::intake::Form;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::profile::Profile;

use crate::configure::{FromStore, ToStore};
use crate::desk::{Cursor, Desk};
use crate::line::{End, FromLine, LineState, Outcome, ToLine};
use crate::message::{Filter, FromConsole, ProfileChoice, Progress, Replay, Rows, Statistics, ToConsole};
use configuring::Configuring;
use ledger::Ledger;
use outbox::{News, Outbox};
use playback::Playback;
use running::{Running, Wish};
use sends::Sends;

/// Notes that are taken into a list before somebody else is listened to.
const NOTES: usize = 1024;
/// Nobody reads faster how long a list is.
const NEWS_PERIOD: Duration = Duration::from_millis(60);
/// Nobody reads counts faster.
const COUNTS_PERIOD: Duration = Duration::from_secs(1);
/// When nothing was heard for so long, the list is told that time has passed: what was held back for want of its end is all
/// there is, at some lines only after a while, and what was asked for will not be answered any more.
const QUIET: [Duration; 4] =
    [Duration::from_millis(50), Duration::from_millis(600), Duration::from_millis(1200), Duration::from_millis(2300)];

/// A console, or, while no line is attached to it, a reader of texts.
pub struct Console {
    /// The line's log.
    live: Desk,
    /// What was brought in.
    text: Desk,
    /// What a replay has brought forth.
    replayed: Option<Desk>,
    view: View,
    /// What a replay plays.
    source: View,
    cursor: Cursor,
    playback: Option<Playback>,
    choice: ProfileChoice,
    filter: Filter,
    ring: Option<u32>,
    paused: bool,
    /// Is added to a list's own editions, so that none of two lists is the same.
    edition_base: u32,
    line: Option<LineState>,
    sends: Sends,
    running: Option<Running>,
    configuring: Configuring,
    ledger: Ledger,
    /// What the worker's clock lags behind the time of day, in microseconds.
    epoch_us: u64,
    /// Notes that have come and are in no list yet, and whether they are a replay's.
    backlog: VecDeque<(bool, std::vec::IntoIter<Note>)>,
    silence: Option<Silence>,
    knows_clock: bool,
    news: News,
    counts: News,
    out: Outbox,
}

/// The time since the last note.
#[derive(Clone, Copy, Debug)]
struct Silence {
    /// The note's time on its own clock.
    at_us: u64,
    came: Instant,
    /// Whether it was a replay's.
    replay: bool,
    /// How often its list was told.
    told: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum View {
    Live,
    Text,
    Replayed,
}

impl Console {
    /// Without a line: an empty text is in view.
    pub fn new() -> Self {
        Self {
            live: Desk::new(),
            text: Desk::new(),
            replayed: None,
            view: View::Text,
            source: View::Live,
            cursor: Cursor::default(),
            playback: None,
            choice: ProfileChoice::default(),
            filter: Filter::default(),
            ring: None,
            paused: false,
            edition_base: 0,
            line: None,
            sends: Sends::default(),
            running: None,
            configuring: Configuring::default(),
            ledger: Ledger::default(),
            epoch_us: 0,
            backlog: VecDeque::new(),
            silence: None,
            knows_clock: false,
            news: News::every(NEWS_PERIOD),
            counts: News::every(COUNTS_PERIOD),
            out: Outbox::default(),
        }
    }

    /// Takes a wish of the window.
    pub fn hear(&mut self, now: Instant, message: ToConsole) {
        match message {
            ToConsole::Attach => {
                self.knows_clock = false;
                self.out.store(ToStore::Watch);
                self.go_live();
            }
            ToConsole::Live => self.go_live(),
            ToConsole::RingSize(entries) => {
                self.ring = Some(entries);
                self.live.set_ring(entries);
                self.replayed.iter_mut().for_each(|desk| desk.set_ring(entries));
            }
            ToConsole::Clear => self.desk_mut().clear_log(),
            ToConsole::Pause(paused) => {
                self.paused = paused;
                self.live.pause(paused);
                self.replayed.iter_mut().for_each(|desk| desk.pause(paused));
            }
            ToConsole::Mark { index, comment } => {
                // An entry that is gone has lost its mark with it.
                self.desk_mut().mark(index, comment);
            }
            // Nobody would ever answer.
            ToConsole::Send(sending) if self.line.is_none() => sends::refuse(&sending, End::NoPort, &mut self.out),
            ToConsole::Send(sending) if self.configuring.is_busy() => sends::refuse(&sending, End::Busy, &mut self.out),
            ToConsole::Send(sending) => self.sends.begin(now, sending, &mut self.out),
            ToConsole::StopSending => self.sends.stop(&mut self.out),
            ToConsole::Line(order) => self.hand_on(order),
            ToConsole::Replay { .. } if self.configuring.is_busy() => {
                self.out.tell(FromConsole::Replay(Replay::default()));
            }
            ToConsole::Replay { speed_permille, profile } => self.replay(now, speed_permille, &profile),
            ToConsole::StopReplay => self.end_playback(),
            ToConsole::Check { edition, text, profile } => {
                running::check(&Wish { edition, text, profile }, &mut self.out);
            }
            ToConsole::Run { edition, .. } if self.configuring.is_busy() => {
                self.out.tell(FromConsole::NotRun { edition });
            }
            ToConsole::Run { edition, text, profile, unit } => {
                self.stop_running(now);
                let wish = Wish { edition, text, profile };
                self.running = Running::begin(now, &wish, unit, self.line.as_ref(), &mut self.out);
                self.drain_running(now);
            }
            ToConsole::Stop => self.stop_running(now),
            ToConsole::Configure(wish) => self.hear_configure(now, wish),
        }
        self.news.change();
    }

    /// Takes what the engine says at this time of the worker, `unix_us` microseconds after the beginning of 1970.
    pub fn hear_line(&mut self, now: Instant, unix_us: u64, message: FromLine) {
        self.epoch_us = unix_us.saturating_sub(now.as_micros());
        match message {
            FromLine::Clock(at_us) => self.hear_clock(at_us, unix_us),
            FromLine::Notes(notes) => self.hear_notes(now, notes),
            FromLine::Done { id, outcome } => self.hear_end(now, id, &outcome),
            FromLine::State(state) => self.hear_state(now, state),
        }
    }

    /// Takes what has come of [`Self::poll_store`].
    pub fn hear_store(&mut self, now: Instant, answer: FromStore) {
        if let Some(answer) = self.ledger.hear_store(answer, &mut self.out) {
            let (configuring, around) = self.around(now);
            configuring.hear_store(now, answer, around);
            self.drain_configuring(now);
        }
    }

    /// Does what is due.
    pub fn handle_time(&mut self, now: Instant) {
        self.sends.handle_time(now, &mut self.out);
        self.play(now);
        if let Some(running) = &mut self.running {
            running.handle_time(now);
        }
        self.drain_running(now);
        self.configuring.handle_time(now);
        self.drain_configuring(now);
        if self.quiet_at().is_some_and(|due| due <= now) {
            self.settle(now);
        }
    }

    /// Takes some of the notes that wait into their lists; whether more wait. What the window wants comes in between.
    pub fn work(&mut self) -> bool {
        let Some((replay, notes)) = self.backlog.front_mut() else { return false };
        let replay = *replay;
        let portion: Vec<Note> = notes.by_ref().take(NOTES).collect();
        if notes.len() == 0 {
            self.backlog.pop_front();
        }
        if let Some(desk) = self.log_mut(replay) {
            desk.record(&portion);
            self.news.change();
            self.counts.change();
        }
        !self.backlog.is_empty()
    }

    /// What the engine is to do next.
    pub fn poll_line(&mut self) -> Option<ToLine> {
        let order = self.out.line.pop_front()?;
        self.ledger.note_order(&order, self.line.as_ref());
        Some(order)
    }

    /// What is to be kept where it outlives the page next, in this order.
    pub fn poll_store(&mut self) -> Option<ToStore> {
        self.out.store.pop_front()
    }

    /// What the window is to know next.
    pub fn poll_news(&mut self) -> Option<FromConsole> {
        self.out.window.pop_front()
    }

    /// How long the list in view is, if that has changed and it is time to tell.
    pub fn poll_progress(&mut self, now: Instant) -> Option<Progress> {
        self.news.take(now).then(|| self.progress())
    }

    /// What the log in view holds, if that has changed and it is time to tell.
    pub fn poll_statistics(&mut self, now: Instant) -> Option<Statistics> {
        if self.counts.take(now) { self.desk().statistics() } else { None }
    }

    /// When something is to be done next.
    pub fn poll_timeout(&self) -> Option<Instant> {
        let playback = self.playback.as_ref().and_then(Playback::due);
        let running = self.running.as_ref().and_then(Running::due);
        [
            self.sends.due(),
            running,
            self.configuring.due(),
            playback,
            self.quiet_at(),
            self.news.due(),
            self.counts.due(),
        ]
        .into_iter()
        .flatten()
        .min()
    }

    /// The list in view.
    pub fn desk(&self) -> &Desk {
        match self.view {
            View::Live => &self.live,
            View::Text => &self.text,
            View::Replayed => self.replayed.as_ref().unwrap_or(&self.live),
        }
    }

    /// The same, to be worked on.
    pub fn desk_mut(&mut self) -> &mut Desk {
        match self.view {
            View::Live => &mut self.live,
            View::Text => &mut self.text,
            View::Replayed => self.replayed.as_mut().unwrap_or(&mut self.live),
        }
    }

    /// The text that is being read, as long as it is what is to be seen.
    pub fn text_mut(&mut self) -> Option<&mut Desk> {
        (self.view == View::Text).then_some(&mut self.text)
    }

    /// Brings a text in, of so many characters or bytes; see [`Desk::begin`].
    pub fn begin(&mut self, reading: u32, form: Option<Form>, total: u64) {
        self.end_playback();
        self.show(View::Text);
        self.replayed = None;
        self.text.begin(reading, form, total);
    }

    /// Names values under another profile from now on, in whatever list is in view.
    pub fn choose(&mut self, choice: ProfileChoice) {
        self.choice = choice.clone();
        self.desk_mut().choose(choice);
        self.news.change();
    }

    /// Shows only what fits from now on, of whatever list is in view.
    pub fn set_filter(&mut self, filter: Filter) {
        self.filter = filter.clone();
        self.desk_mut().set_filter(filter);
        self.news.change();
    }

    /// How far the list in view has come.
    pub fn progress(&self) -> Progress {
        let progress = self.desk().progress();
        Progress { edition: self.edition_base.wrapping_add(progress.edition), ..progress }
    }

    /// Some rows of the list in view.
    pub fn rows(&self, from: u32, count: u32) -> Rows {
        let rows = self.desk().rows(from, count);
        Rows { edition: self.edition_base.wrapping_add(rows.edition), ..rows }
    }

    fn hear_clock(&mut self, at_us: u64, unix_us: u64) {
        if self.knows_clock {
            // Whatever has come meanwhile begins another silence.
            if self.backlog.is_empty() {
                self.pass_time(at_us, false);
            }
        } else {
            self.knows_clock = true;
            self.live = self.new_log(unix_us.saturating_sub(at_us));
        }
    }

    fn hear_notes(&mut self, now: Instant, notes: Vec<Note>) {
        let replay = self.line.as_ref().is_some_and(|line| line.replay);
        if let Some(last) = notes.last() {
            self.silence = Some(Silence { at_us: last.at_us, came: now, replay, told: 0 });
        }
        if replay {
            if let Some(playback) = &mut self.playback {
                playback.take_back(now, &notes);
            }
            self.play(now);
        }
        self.backlog.push_back((replay, notes.into_iter()));
    }

    fn hear_end(&mut self, now: Instant, id: u32, outcome: &Outcome) {
        let mode = self.line.as_ref().map_or(Mode::Rtu, |line| line.mode);
        self.ledger.done(self.unix_ms(now), id, outcome, &mut self.out);
        if self.configuring.done(now, id, outcome) {
            return self.drain_configuring(now);
        }
        if !self.sends.done(now, id, outcome, mode, &mut self.out)
            && let Some(running) = &mut self.running
            && running.done(now, id, outcome)
        {
            self.drain_running(now);
        }
    }

    fn hear_state(&mut self, now: Instant, state: LineState) {
        if let Some(playback) = &mut self.playback {
            if state.replay {
                playback.begin(now);
            } else if playback.has_begun() {
                // Somebody has connected meanwhile.
                self.playback = None;
                self.out.tell(FromConsole::Replay(Replay::default()));
            }
        }
        if let Some(running) = &mut self.running {
            running.hear_state(now, &state);
        }
        self.configuring.hear_state(now, &state);
        self.line = Some(state.clone());
        self.out.tell(FromConsole::Line(state));
        self.drain_running(now);
        self.drain_configuring(now);
        self.play(now);
    }

    /// An order to the engine; while a device is configured, none that would cross it.
    fn hand_on(&mut self, order: ToLine) {
        let crosses = !matches!(order, ToLine::Clock | ToLine::ReadOnly(_));
        match &self.line {
            // It is told again, so that whoever has switched something sees that it was not.
            Some(state) if crosses && self.configuring.is_busy() => self.out.tell(FromConsole::Line(state.clone())),
            _ => self.out.order(order),
        }
    }

    fn go_live(&mut self) {
        self.end_playback();
        self.show(View::Live);
        self.replayed = None;
        // The memory of a text that was brought in is free again.
        self.text.begin(0, None, 0);
        self.text.finish();
    }

    /// Plays the list in view; of a replay's own list, what it has played.
    fn replay(&mut self, now: Instant, speed_permille: u32, profile: &str) {
        self.end_playback();
        if self.view != View::Replayed {
            self.source = self.view;
        }
        let source = if self.source == View::Text { &self.text } else { &self.live };
        let Some(first_us) = source.next_note(&mut Cursor::default()).map(|note| note.at_us) else {
            return self.out.tell(FromConsole::Replay(Replay::default()));
        };
        let last_us = first_us.saturating_add(source.duration_us());
        let (line, mode) = source.line_at_start().unwrap_or_else(|| match &self.line {
            Some(state) => (state.line, state.mode),
            None => (LineSettings::new(9600, Parity::None), Mode::Rtu),
        });
        self.cursor = Cursor::default();
        self.playback = Some(Playback::new(now, speed_permille, first_us, last_us));
        self.replayed = Some(self.new_log(source.epoch_us().unwrap_or(0)));
        self.show(View::Replayed);
        let profile = Profile::from_json(profile).map(|profile| profile.pack()).unwrap_or_default();
        self.out.order(ToLine::Replay { profile, line, mode });
    }

    fn play(&mut self, now: Instant) {
        let Some(playback) = &mut self.playback else { return };
        let source = if self.source == View::Text { &self.text } else { &self.live };
        let cursor = &mut self.cursor;
        let fetch = |count| std::iter::from_fn(|| source.next_note(cursor)).take(count).collect();
        if playback.play(now, fetch, &mut self.out) {
            self.end_playback();
        }
    }

    fn end_playback(&mut self) {
        if let Some(playback) = self.playback.take() {
            self.out.order(ToLine::ReplayEnded);
            self.out.tell(FromConsole::Replay(playback.state(false)));
        }
    }

    /// Puts a list in view, under the profile and the filter that are wanted.
    fn show(&mut self, view: View) {
        if view == self.view && view != View::Replayed {
            return;
        }
        let last = self.edition_base.wrapping_add(self.desk().progress().edition);
        self.view = view;
        let (choice, filter) = (self.choice.clone(), self.filter.clone());
        self.desk_mut().choose(choice);
        self.desk_mut().set_filter(filter);
        self.edition_base = last.wrapping_add(1).wrapping_sub(self.desk().progress().edition);
        self.news.change();
    }

    /// An empty log. `epoch_us` is the Unix time of its clock's origin.
    fn new_log(&self, epoch_us: u64) -> Desk {
        let mut log = Desk::live(epoch_us);
        if let Some(entries) = self.ring {
            log.set_ring(entries);
        }
        log.choose(self.choice.clone());
        log.set_filter(self.filter.clone());
        log.pause(self.paused);
        log
    }

    /// The list that notes go into.
    fn log_mut(&mut self, replay: bool) -> Option<&mut Desk> {
        if replay { self.replayed.as_mut() } else { Some(&mut self.live) }
    }

    fn stop_running(&mut self, now: Instant) {
        if let Some(running) = &mut self.running {
            running.stop(now);
        }
        self.drain_running(now);
    }

    fn drain_running(&mut self, now: Instant) {
        if let Some(running) = &mut self.running
            && !running.drain(now, &mut self.out)
        {
            self.running = None;
        }
    }

    /// Finds out whether nothing has been heard for a while. Only the engine knows: what it has heard may be on its way. In
    /// a replay nothing is on its way but whole frames.
    fn settle(&mut self, now: Instant) {
        let Some(silence) = &mut self.silence else { return };
        silence.told += 1;
        let Silence { at_us, came, replay, .. } = *silence;
        if !replay {
            return self.out.order(ToLine::Clock);
        }
        let elapsed = now.saturating_since(came);
        let elapsed = self.playback.as_ref().map_or(elapsed, |playback| playback.recorded(elapsed));
        self.pass_time((Instant::from_micros(at_us) + elapsed).as_micros(), true);
    }

    /// Tells the list that nothing was heard until then.
    fn pass_time(&mut self, now_us: u64, replay: bool) {
        if let Some(desk) = self.log_mut(replay) {
            desk.settle(now_us);
            self.news.change();
            self.counts.change();
        }
    }

    /// When the list is to hear that time has passed, if nothing more is heard.
    fn quiet_at(&self) -> Option<Instant> {
        let silence = self.silence.filter(|_| self.backlog.is_empty())?;
        QUIET.get(silence.told).map(|quiet| silence.came + *quiet)
    }
}

impl Default for Console {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
