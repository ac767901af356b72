//! Devices that the console configures: an engine with a simulated line beside it, and a database, in virtual time.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use buslens_bus::sim::{Device as _, Line, Lvdt, Motion};
use buslens_bus::{Config, Event, Job, JobId, LinkEvent, LinkOrder, LinkState, Master, Poll};
use buslens_codec::UnitId;
use buslens_codec::profile::{BUILT_IN, Group, Profile};
use buslens_configure::{Edit, Ending, Hazard, Journal, Plan, Reach, Report, Scope, Snapshot, Task, Way};

use super::*;
use crate::configure::{
    AuditFilter, AuditForm, AuditRow, DeviceKey, FromConfigure, FromStore, Hindrance, StoreFault, ToConfigure, ToStore,
};
use crate::line::PortState;

mod cases;

const START: Instant = Instant::from_micros(20_000_000);
const UNIX_US: u64 = 1_777_863_721_000_000;

/// What happened, in its order.
#[derive(Clone, Debug, PartialEq)]
enum Done {
    Sent(Origin, Vec<u8>),
    Kept(u64),
    Forgotten(u64),
    Unit(u8),
}

struct Bench {
    console: Console,
    profile: Profile,
    file: &'static str,
    master: Master,
    wire: Line<Lvdt>,
    now: Instant,
    state: LineState,
    polled: UnitId,
    jobs: BTreeMap<JobId, u32>,
    told_state: Option<LineState>,
    unplugged: bool,
    polls: usize,
    done: Vec<Done>,
    news: Vec<FromConfigure>,
    others: Vec<FromConsole>,
    // The database.
    journals: BTreeMap<u64, Journal>,
    held: BTreeSet<u64>,
    audit: Vec<AuditRow>,
    counts: BTreeMap<DeviceKey, u64>,
    /// What the database says to everything that it is to keep.
    fault: Option<StoreFault>,
    /// It takes its time: nothing is answered.
    slow: bool,
    waiting: VecDeque<ToStore>,
}

impl Bench {
    /// A sensor with factory settings that is polled, and a console that knows of it.
    fn new() -> Self {
        let file = BUILT_IN.iter().find(|text| Profile::from_json(text).unwrap().id == "lvdt").unwrap();
        let profile = Profile::from_json(file).unwrap();
        let state = LineState { line: profile.line, mode: profile.mode, polling: true, ..state(false) };
        let mut bench = Self {
            console: Console::new(),
            master: Master::new(Config::new(profile.line, profile.mode)),
            wire: Line::new([Lvdt::new(1, Motion::Swing)], 7),
            now: START,
            state: LineState { port: PortState::Gone, open: false, ..state },
            polled: UnitId(profile.unit),
            profile,
            file,
            jobs: BTreeMap::new(),
            told_state: None,
            unplugged: false,
            polls: 0,
            done: Vec::new(),
            news: Vec::new(),
            others: Vec::new(),
            journals: BTreeMap::new(),
            held: BTreeSet::new(),
            audit: Vec::new(),
            counts: BTreeMap::new(),
            fault: None,
            slow: false,
            waiting: VecDeque::new(),
        };
        bench.master.connect(bench.now);
        bench.set_poll();
        bench.attach();
        bench
    }

    /// A page begins, with the line as it is.
    fn attach(&mut self) {
        self.console = Console::new();
        (self.told_state, self.held) = (None, BTreeSet::new());
        self.jobs.clear();
        self.waiting.clear();
        self.console.hear(self.now, ToConsole::Attach);
        self.console.hear_line(self.now, UNIX_US, FromLine::Clock(self.now.as_micros()));
        let key = DeviceKey { profile: self.profile.id.clone(), unit: self.polled.0, simulated: false };
        self.hear(ToConfigure::Device(Some(key)));
    }

    fn hear(&mut self, wish: ToConfigure) {
        self.console.hear(self.now, ToConsole::Configure(wish));
        self.settle();
    }

    fn reach(&self) -> Reach {
        Reach { unit: self.polled, line: self.state.line, mode: self.state.mode }
    }

    fn begin(&mut self, task: Task) {
        let (profile, reach) = (self.file.to_owned(), self.reach());
        self.hear(ToConfigure::Begin { run: 7, task, profile, reach });
    }

    fn report(&self) -> Option<Report> {
        self.news.iter().rev().find_map(|news| match news {
            FromConfigure::Report { run: 7, report } => Some((**report).clone()),
            _ => None,
        })
    }

    fn refusal(&self) -> Option<&Hindrance> {
        self.news.iter().rev().find_map(|news| match news {
            FromConfigure::Refused { run: 7, why } => Some(why),
            _ => None,
        })
    }

    /// To the report, within ten minutes of the line.
    fn run(&mut self, task: Task) -> Report {
        self.begin(task);
        self.finish()
    }

    fn finish(&mut self) -> Report {
        let limit = self.now + Duration::from_mins(10);
        while self.report().is_none() {
            assert!(self.step(limit), "it never ended: {:?}", self.news.last());
        }
        let report = self.report().unwrap();
        self.news.clear();
        report
    }

    fn read(&mut self) -> Snapshot {
        self.run(Task::Read).snapshot.unwrap()
    }

    /// Wishes to write what is typed, with everything confirmed.
    fn wish(&mut self, typed: &[(&str, &str)]) -> Task {
        let before = self.read();
        let edit = |(id, text): &(&str, &str)| {
            Edit::parse(&self.profile, self.profile.point(id).unwrap(), text, &before).unwrap()
        };
        let edits: Vec<Edit> = typed.iter().map(edit).collect();
        let confirmed: Vec<Hazard> = Plan::of(&self.profile, &before, &edits).unwrap().hazards;
        self.done.clear();
        Task::Apply { before, edits, confirmed }
    }

    fn pass(&mut self, time: Duration) {
        let until = self.now + time;
        while self.step(until) {}
        self.now = until;
    }

    /// What a procedure has had written.
    fn written(&self) -> Vec<Vec<u8>> {
        let sent = self.done.iter().filter_map(|done| match done {
            Done::Sent(Origin::Configuration, bytes) if matches!(bytes[1], 5 | 6 | 0x0F | 0x10) => Some(bytes.clone()),
            _ => None,
        });
        sent.collect()
    }

    fn count(&self, unit: u8) -> u64 {
        let key = DeviceKey { profile: self.profile.id.clone(), unit, simulated: false };
        self.counts.get(&key).copied().unwrap_or(0)
    }

    fn set_poll(&mut self) {
        let requests = self.profile.live_groups().iter().filter_map(Group::request).collect();
        let period = Duration::from_millis(self.profile.timing.poll_period_ms.into());
        let poll = Poll { unit: self.polled, requests, period };
        self.master.set_poll(self.now, self.state.polling.then_some(poll));
    }

    /// To the next thing that happens, if it happens by `limit`.
    fn step(&mut self, limit: Instant) -> bool {
        let next = [self.master.poll_timeout(), self.wire.poll_timeout(), self.console.poll_timeout()];
        let Some(next) = next.into_iter().flatten().min().filter(|&next| next <= limit) else { return false };
        self.now = next.max(self.now);
        self.wire.handle_timeout(self.now);
        if let Some(bytes) = self.wire.poll_transmit()
            && self.master.link_state() == LinkState::Open
        {
            self.master.handle_bytes(self.now, &bytes);
        }
        self.master.handle_timeout(self.now);
        self.console.handle_time(self.now);
        self.settle();
        true
    }

    fn settle(&mut self) {
        loop {
            while self.console.work() {}
            self.console.poll_progress(self.now);
            self.console.poll_statistics(self.now);
            if let Some(order) = self.console.poll_store() {
                self.waiting.push_back(order);
            } else if let Some(order) = self.waiting.pop_front_if(|_| !self.slow) {
                self.keep(order);
            } else if let Some(order) = self.console.poll_line() {
                self.obey(order);
            } else if let Some(news) = self.console.poll_news() {
                match news {
                    FromConsole::Configure(news) => self.news.push(news),
                    other => self.others.push(other),
                }
            } else if let Some(order) = self.master.poll_link() {
                let event = match order {
                    LinkOrder::Open(_) if self.unplugged => LinkEvent::OpenFailed,
                    LinkOrder::Open(settings) => {
                        self.wire.handle_settings(self.now, settings);
                        LinkEvent::Opened
                    }
                    LinkOrder::Close => LinkEvent::Closed,
                };
                self.master.handle_link(self.now, event);
            } else if let Some(transmit) = self.master.poll_transmit() {
                self.wire.handle_bytes(self.now, &transmit.bytes);
                self.done.push(Done::Sent(transmit.origin, transmit.bytes));
            } else if let Some(event) = self.master.poll_event() {
                match event {
                    Event::Done { job, exchange } => {
                        if let Some(id) = self.jobs.remove(&job) {
                            let outcome = Outcome::from(&exchange);
                            self.console.hear_line(self.now, self.unix_us(), FromLine::Done { id, outcome });
                        }
                    }
                    Event::Polled { exchange, .. } => self.polls += usize::from(exchange.result.is_ok()),
                    Event::Link(_) => {}
                }
            } else if !self.tell_state() {
                return;
            }
        }
    }

    fn unix_us(&self) -> u64 {
        UNIX_US + (self.now.as_micros() - START.as_micros())
    }

    /// Whether there was something to tell.
    fn tell_state(&mut self) -> bool {
        self.state.port = match self.master.link_state() {
            LinkState::Open if !self.master.is_reconfiguring() => PortState::Open,
            LinkState::Open | LinkState::Opening => PortState::Changing,
            LinkState::Closed | LinkState::Closing | LinkState::Lost => PortState::Gone,
        };
        self.state.open = self.state.port == PortState::Open;
        if self.told_state.as_ref() == Some(&self.state) {
            return false;
        }
        self.told_state = Some(self.state.clone());
        self.console.hear_line(self.now, self.unix_us(), FromLine::State(self.state.clone()));
        true
    }

    fn obey(&mut self, order: ToLine) {
        match order {
            ToLine::Send { id, origin, bytes, wait_ms } => {
                let job = Job::raw(bytes, wait_ms.map(|wait| Duration::from_millis(wait.into()))).by(origin);
                let job = self.master.submit(self.now, job);
                self.jobs.insert(job, id);
            }
            ToLine::Withdraw(id) => {
                let job = self.jobs.iter().find(|(_, own)| **own == id).map(|(job, _)| *job);
                if let Some(job) = job.filter(|job| self.master.withdraw(*job)) {
                    self.jobs.remove(&job);
                    let done = FromLine::Done { id, outcome: outcome(End::Withdrawn, &[]) };
                    self.console.hear_line(self.now, self.unix_us(), done);
                }
            }
            ToLine::Settings { line, mode, .. } => {
                (self.state.line, self.state.mode) = (line, mode);
                self.master.reconfigure(self.now, line, mode);
            }
            ToLine::Poll(on) => {
                self.state.polling = on;
                self.set_poll();
            }
            ToLine::Unit(unit) => {
                self.done.push(Done::Unit(unit));
                self.polled = UnitId(unit);
                self.set_poll();
            }
            ToLine::ReadOnly(on) => {
                self.state.read_only = on;
                self.master.set_read_only(on);
            }
            ToLine::Clock => {
                let clock = FromLine::Clock(self.now.as_micros());
                self.console.hear_line(self.now, self.unix_us(), clock);
            }
            other => panic!("{other:?}"),
        }
    }

    fn keep(&mut self, order: ToStore) {
        let answer = match order {
            ToStore::Keep { journal, .. } => {
                let id = journal.id;
                if self.fault.is_none() {
                    self.held.insert(id);
                    self.journals.insert(id, *journal);
                    self.done.push(Done::Kept(id));
                }
                FromStore::Kept(id, self.fault.clone().map_or(Ok(()), Err))
            }
            ToStore::Take(id) => {
                let taken = self.journals.get(&id).cloned().map(Box::new).ok_or(Hindrance::JournalGone);
                let taken = if self.held.contains(&id) { Err(Hindrance::JournalHeld) } else { taken };
                FromStore::Taken(id, taken)
            }
            ToStore::Forget(id) | ToStore::Discard(id) => {
                self.journals.remove(&id);
                self.done.push(Done::Forgotten(id));
                self.open_journals()
            }
            ToStore::Release => {
                self.held.clear();
                self.open_journals()
            }
            ToStore::Watch => self.open_journals(),
            ToStore::Append(row) => return self.audit.push(*row),
            ToStore::Audit => FromStore::Audit(self.audit.clone()),
            ToStore::ClearAudit => return self.audit.clear(),
            ToStore::Count(counts) => {
                for (key, more) in counts {
                    *self.counts.entry(key).or_default() += more;
                }
                FromStore::Counts(self.counts.clone().into_iter().collect())
            }
            ToStore::Move(before, after) => {
                let count = self.counts.remove(&before).unwrap_or(0);
                let known = self.counts.entry(after).or_default();
                *known = count.max(*known);
                FromStore::Counts(self.counts.clone().into_iter().collect())
            }
            ToStore::Snapshots | ToStore::KeepSnapshot(..) | ToStore::ForgetSnapshot(_) => {
                FromStore::Snapshots(Vec::new())
            }
        };
        self.console.hear_store(self.now, answer);
    }

    fn open_journals(&self) -> FromStore {
        let open = self.journals.iter().filter(|(id, _)| !self.held.contains(id));
        FromStore::Journals(open.map(|(_, journal)| journal.clone()).collect())
    }

    /// The journals that the window was last told of.
    fn offered(&self) -> Vec<u64> {
        let open = self.news.iter().rev().find_map(|news| match news {
            FromConfigure::Open(journals) => Some(journals.iter().map(|journal| journal.id).collect()),
            _ => None,
        });
        open.unwrap_or_default()
    }
}
