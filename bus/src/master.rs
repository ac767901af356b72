//! The master's state machine for one line.
//!
//! In: [`Master::handle_bytes`], [`Master::handle_timeout`], [`Master::handle_link`], and the wishes [`Master::connect`],
//! [`Master::disconnect`], [`Master::reconfigure`], [`Master::submit`], [`Master::withdraw`], [`Master::set_poll`],
//! [`Master::set_read_only`]. After any of them drain, in this order and until empty: [`Master::poll_link`],
//! [`Master::poll_transmit`], [`Master::poll_event`], [`Master::poll_timeout`]. A spurious timeout is harmless.
//!
//! One transaction has the line at a time, be it the poll's, a job's or raw bytes; the poll and the jobs take turns when
//! both could leave.
//!
//! Rules that keep a wrong value from ever being taken for an answer:
//! - a reply is found by what the request lets expect (unit, function, byte count, echoed fields, check), anywhere among
//!   stray bytes; silence only tells that no more is to come;
//! - a request that timed out may still be answered. While that is possible, a reply of its shape is not believed to
//!   answer a newer request, unless there are as many replies as requests;
//! - the echo of a half-duplex adapter is taken off by content, never by flushing.

mod echo;
mod expect;
mod inbox;
mod job;
mod link;
mod overdue;
mod patience;
mod poll;
mod raw;
mod replay;
mod transaction;
mod turn;

use std::collections::VecDeque;
use std::time::Duration;

use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::{UnitId, ascii};

use crate::outcome::{Counters, Exchange, Failure, NextStep};
use crate::time::Instant;
use echo::Echo;
use inbox::Inbox;
pub use job::{Content, Job, JobId, Transmit};
use link::LinkControl;
pub use link::{LinkEvent, LinkOrder, LinkState};
use overdue::Overdue;
use patience::Patience;
pub use poll::Poll;
use poll::Schedule;
use raw::Raw;
use transaction::{Progress, Surroundings, Transaction};

/// Quiet time after a time-out, within the 100 to 200 ms that the standard gives a broadcast's turnaround
/// (serial line guide, clause 2.4.1).
const TURNAROUND: Duration = Duration::from_millis(100);

/// What a master needs to know of its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Settings of the port.
    pub line: LineSettings,
    /// RTU or ASCII.
    pub mode: Mode,
    /// How long a device may think, from the end of the request to the start of its reply.
    pub response_timeout: Duration,
    /// Pause before another unit is addressed than the last one.
    pub unit_pause: Duration,
    /// How often a lost port is tried again without a sign that it is back.
    pub reopen_period: Duration,
}

impl Config {
    /// A response time-out of 500 ms, no pause between units, a lost port tried every second.
    pub fn new(line: LineSettings, mode: Mode) -> Self {
        Self {
            line,
            mode,
            response_timeout: Duration::from_millis(500),
            unit_pause: Duration::ZERO,
            reopen_period: Duration::from_secs(1),
        }
    }
}

/// What the master tells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// A job has ended.
    Done {
        /// As returned by [`Master::submit`].
        job: JobId,
        /// How.
        exchange: Exchange,
    },
    /// One request of the poll has ended.
    Polled {
        /// Its place in [`Poll::requests`].
        index: usize,
        /// How.
        exchange: Exchange,
    },
    /// The state of the link has changed.
    Link(LinkState),
}

/// The master of one line.
#[derive(Debug)]
pub struct Master {
    config: Config,
    link: LinkControl,
    jobs: VecDeque<Queued>,
    next_job: u64,
    schedule: Option<Schedule>,
    current: Option<Current>,
    /// Other settings that wait for the end of the current transaction.
    wanted: Option<(LineSettings, Mode)>,
    /// Only reads leave.
    read_only: bool,
    /// What happened before happens again: nothing leaves.
    replay: bool,
    /// The last that left was a job and not the poll.
    job_went_last: bool,
    inbox: Inbox,
    echo: Echo,
    overdue: Overdue,
    patience: Patience,
    /// No request leaves before this.
    quiet_until: Instant,
    last_unit: Option<UnitId>,
    outgoing: Option<Transmit>,
    events: VecDeque<Event>,
    counters: Counters,
}

/// A job that waits for its turn.
#[derive(Debug)]
struct Queued {
    id: JobId,
    job: Job,
    since: Instant,
}

/// Who asked for a transaction.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Asker {
    Job(JobId, Job),
    Poll(usize),
    /// Whoever had it sent when it was recorded.
    Recorded,
}

/// What has the line.
#[derive(Debug)]
enum Current {
    Request(Transaction),
    Raw(Raw),
}

impl Master {
    /// A master whose link is closed.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            link: LinkControl::new(),
            jobs: VecDeque::new(),
            next_job: 0,
            schedule: None,
            current: None,
            wanted: None,
            read_only: false,
            replay: false,
            job_went_last: false,
            inbox: Inbox::default(),
            echo: Echo::Unknown,
            overdue: Overdue::default(),
            patience: Patience::new(config.response_timeout),
            quiet_until: Instant::ZERO,
            last_unit: None,
            outgoing: None,
            events: VecDeque::new(),
            counters: Counters::default(),
        }
    }

    /// State of the link.
    pub fn link_state(&self) -> LinkState {
        self.link.state()
    }

    /// Whether other settings are wanted than those that the port is open with. It is closed before it has them.
    pub fn is_reconfiguring(&self) -> bool {
        self.wanted.is_some()
    }

    /// Counts since this master was made.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    // Wishes.

    /// Opens the link, and keeps it open: a lost port is opened again as soon as it is back.
    pub fn connect(&mut self, now: Instant) {
        self.link.connect(self.config.line);
        self.advance(now);
    }

    /// Closes the link. Jobs that have not ended fail with [`Failure::LinkLost`]; the poll stays set.
    pub fn disconnect(&mut self, now: Instant) {
        self.link.disconnect();
        self.wanted = None;
        self.abandon(now);
        self.advance(now);
    }

    /// Uses other settings from the next quiet slot on: the transaction under way still ends with the old ones, then the
    /// port is closed and opened again. Jobs that wait and the poll go on with the new settings.
    pub fn reconfigure(&mut self, now: Instant, line: LineSettings, mode: Mode) {
        self.wanted = Some((line, mode));
        self.advance(now);
    }

    /// Whether only requests that change nothing in a device may leave. Everything else fails with
    /// [`Failure::ReadOnly`], also what waits already.
    pub fn set_read_only(&mut self, read_only: bool) {
        self.read_only = read_only;
    }

    /// Queues a job. Jobs go in order, and take turns with the poll. Without a link the job fails at once.
    pub fn submit(&mut self, now: Instant, job: Job) -> JobId {
        let id = JobId(self.next_job);
        self.next_job += 1;
        self.jobs.push_back(Queued { id, job, since: now });
        if !self.link.is_hopeful() {
            self.abandon(now);
        }
        self.advance(now);
        id
    }

    /// Takes a job back that waits for its turn, and says whether it did. Nothing more is heard of it.
    pub fn withdraw(&mut self, job: JobId) -> bool {
        let before = self.jobs.len();
        self.jobs.retain(|queued| queued.id != job);
        self.jobs.len() < before
    }

    /// Sets what is read periodically, from now on; `None` stops it. A request under way still ends.
    pub fn set_poll(&mut self, now: Instant, poll: Option<Poll>) {
        self.schedule = poll.and_then(|poll| Schedule::new(now, poll));
        self.advance(now);
    }

    // What happened.

    /// Bytes from the line.
    pub fn handle_bytes(&mut self, now: Instant, bytes: &[u8]) {
        self.counters.noise_bytes += self.inbox.push(now, bytes);
        self.advance(now);
    }

    /// Time has passed.
    pub fn handle_timeout(&mut self, now: Instant) {
        self.advance(now);
    }

    /// The port did something.
    pub fn handle_link(&mut self, now: Instant, event: LinkEvent) {
        if event == LinkEvent::LineError {
            self.counters.line_errors += 1;
            match &mut self.current {
                Some(Current::Request(current)) => current.line_errors += 1,
                Some(Current::Raw(current)) => current.line_errors += 1,
                None => {}
            }
        }
        let before = self.link.state();
        self.link.handle(now, event, self.config);
        match (before, self.link.state()) {
            (LinkState::Open, LinkState::Open) | (_, LinkState::Opening) => {}
            (_, LinkState::Open) => self.start_afresh(now),
            (_, LinkState::Closed | LinkState::Closing | LinkState::Lost) => self.abandon(now),
        }
        self.advance(now);
    }

    // What to do about it.

    /// What the port shall do.
    pub fn poll_link(&mut self) -> Option<LinkOrder> {
        self.link.poll_order()
    }

    /// Bytes to be sent now.
    pub fn poll_transmit(&mut self) -> Option<Transmit> {
        self.outgoing.take()
    }

    /// What has ended or changed.
    pub fn poll_event(&mut self) -> Option<Event> {
        self.link.poll_change().map(Event::Link).or_else(|| self.events.pop_front())
    }

    /// When [`Master::handle_timeout`] is due.
    pub fn poll_timeout(&self) -> Option<Instant> {
        if self.link.state() != LinkState::Open {
            return self.link.timeout();
        }
        match &self.current {
            Some(Current::Request(current)) => Some(current.next_look(self.inbox.last_at())),
            Some(Current::Raw(current)) => Some(current.end(&self.inbox)),
            None => self.next_departure(),
        }
    }

    /// Moves on as far as the time and the bytes allow.
    fn advance(&mut self, now: Instant) {
        self.link.handle_timeout(now, self.config);
        if self.link.state() != LinkState::Open && self.wanted.is_none() {
            return;
        }
        loop {
            if self.current.is_some() {
                if !self.look_for_reply(now) {
                    return;
                }
            } else if let Some((line, mode)) = self.wanted.take() {
                if (self.config.line, self.config.mode) != (line, mode) {
                    self.overdue.forget();
                }
                (self.config.line, self.config.mode) = (line, mode);
                self.link.reopen(line);
                return;
            } else {
                self.sort_stray_bytes(now);
                match self.next_departure() {
                    Some(at) if at <= now => self.depart(now),
                    _ => return,
                }
            }
        }
    }

    /// Whether the current transaction ended.
    fn look_for_reply(&mut self, now: Instant) -> bool {
        let Some(current) = &mut self.current else { return false };
        let mut around = Surroundings {
            inbox: &mut self.inbox,
            echo: &mut self.echo,
            overdue: &mut self.overdue,
            patience: &mut self.patience,
            counters: &mut self.counters,
        };
        let progress = match current {
            Current::Request(current) => current.look(now, &mut around),
            Current::Raw(current) => current.look(now, &mut around),
        };
        match progress {
            Progress::Waiting => false,
            Progress::Ended(exchange) => {
                self.finish(now, exchange);
                true
            }
        }
    }

    fn finish(&mut self, now: Instant, exchange: Exchange) {
        let Some(current) = self.current.take() else { return };
        self.quiet_until = now + self.config.line.frame_gap();
        let asker = match current {
            Current::Request(ended) => {
                self.counters.count(&exchange);
                self.learn(now, &ended, &exchange);
                ended.asker
            }
            Current::Raw(ended) => {
                for (unit, request) in ended.unanswered(&exchange.received) {
                    self.overdue.push(unit, request, ended.on_wire_until);
                }
                ended.asker
            }
        };
        self.report(asker, exchange);
    }

    /// What the end of a transaction tells about the device, and how long to leave the line alone after it.
    fn learn(&mut self, now: Instant, ended: &Transaction, exchange: &Exchange) {
        match &exchange.result {
            Ok(_) | Err(Failure::Exception { .. }) => {
                self.patience.answered(ended.latency(now));
                self.overdue.forget_unit(ended.unit);
            }
            Err(Failure::Doubtful) => {
                self.patience.exhausted();
                self.overdue.forget_unit(ended.unit);
            }
            Err(Failure::NoAnswer { .. } | Failure::Unproven) => {
                self.patience.exhausted();
                self.overdue.push(ended.unit, ended.request.clone(), ended.on_wire_until);
                self.quiet_until = (now + TURNAROUND).max(ended.on_wire_until + self.patience.slowest_with_margin());
            }
            Err(Failure::BadCheck { .. }) => self.quiet_until = now + TURNAROUND,
            Err(Failure::LinkLost | Failure::ReadOnly | Failure::Invalid(_)) => {}
        }
    }

    /// Tells how a transaction ended, or puts a job back that may be tried again.
    fn report(&mut self, asker: Asker, exchange: Exchange) {
        match asker {
            Asker::Recorded => {}
            Asker::Poll(index) => self.events.push_back(Event::Polled { index, exchange }),
            Asker::Job(id, mut job) => {
                let reads = matches!(&job.content, Content::Request { request, .. } if !request.is_write());
                let again = exchange
                    .result
                    .as_ref()
                    .is_err_and(|failure| job.retries > 0 && reads && failure.next_step(false) == NextStep::Retry);
                if again {
                    job.retries -= 1;
                    self.jobs.push_front(Queued { id, job, since: exchange.at });
                } else {
                    self.events.push_back(Event::Done { job: id, exchange });
                }
            }
        }
    }

    /// Bytes that come while nobody is asked: overdue replies, or noise. Only what may become a late reply is kept.
    fn sort_stray_bytes(&mut self, now: Instant) {
        self.overdue.prune(now);
        while let Some(latency) = self.overdue.take_reply(now, &mut self.inbox, self.config.mode) {
            self.counters.late_replies += 1;
            self.patience.late(latency);
        }
        let longest = if self.overdue.is_empty() { 0 } else { ascii::MAX_ADU_LEN };
        self.counters.noise_bytes += self.inbox.keep(longest);
    }

    /// A new link has no history, but a device still owes what it owes if only the port was opened again.
    fn start_afresh(&mut self, now: Instant) {
        self.inbox.clear();
        self.echo = Echo::Unknown;
        self.patience = Patience::new(self.config.response_timeout);
        self.quiet_until = now + self.config.line.frame_gap();
        self.last_unit = None;
        if let Some(schedule) = &mut self.schedule {
            schedule.restart(now);
        }
    }

    /// Ends everything under way: there is no link.
    fn abandon(&mut self, now: Instant) {
        self.outgoing = None;
        self.overdue.forget();
        self.counters.noise_bytes += self.inbox.clear();
        if let Some(current) = self.current.take() {
            let (exchange, asker) = match current {
                Current::Request(current) => (current.abandoned(now), current.asker),
                Current::Raw(current) => (current.abandoned(now), current.asker),
            };
            if let Asker::Job(id, _) = asker {
                self.events.push_back(Event::Done { job: id, exchange });
            }
        }
        for Queued { id, .. } in std::mem::take(&mut self.jobs) {
            self.events.push_back(Event::Done { job: id, exchange: Exchange::unsent(now, Failure::LinkLost) });
        }
    }
}
