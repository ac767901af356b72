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

#[test]
fn parameters_are_read_while_the_polling_goes_on() {
    let mut bench = Bench::new();
    bench.pass(Duration::from_secs(1));
    let (polls, began) = (bench.polls, bench.now);
    let report = bench.run(Task::Read);
    assert_eq!((report.ending, bench.written()), (Ending::Done, vec![]));
    let snapshot = report.snapshot.unwrap();
    assert_eq!(snapshot.registers("baud"), Some([3].as_slice()));
    assert_eq!(snapshot.taken_unix_ms / 1000, UNIX_US / 1_000_000 + 1);
    assert!(bench.polls > polls || bench.now.saturating_since(began) < Duration::from_millis(500));
    assert!(bench.state.polling);
}

#[test]
fn a_journal_is_kept_before_the_first_write() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("sample_rate", "0x0006")]);
    bench.slow = true;
    bench.begin(task);
    bench.pass(Duration::from_secs(3));
    let waits = bench.waiting.iter().any(|order| matches!(order, ToStore::Keep { .. }));
    assert_eq!((waits, bench.written()), (true, vec![]), "nothing leaves while the journal is not on the disk");
    bench.slow = false;
    bench.settle();
    let report = bench.finish();
    assert_eq!(report.ending, Ending::Done);
    let kept = bench.done.iter().position(|done| matches!(done, Done::Kept(_))).unwrap();
    let first = bench.written()[0].clone();
    let wrote = bench.done.iter().position(|done| *done == Done::Sent(Origin::Configuration, first.clone())).unwrap();
    assert!(kept < wrote);
    assert!(bench.done.iter().any(|done| matches!(done, Done::Forgotten(_))) && bench.journals.is_empty());
    assert_eq!(bench.read().registers("sample_rate"), Some([6].as_slice()));
}

#[test]
fn without_a_journal_nothing_is_written_and_the_reason_is_told() {
    for fault in [StoreFault::Unavailable, StoreFault::Full] {
        let mut bench = Bench::new();
        let task = bench.wish(&[("compensation", "1")]);
        bench.fault = Some(fault.clone());
        bench.begin(task);
        let limit = bench.now + Duration::from_mins(1);
        while bench.report().is_none() && bench.step(limit) {}
        assert!(bench.news.contains(&FromConfigure::Store(Some(fault))));
        assert_eq!(bench.finish().ending, Ending::NotKept);
        assert_eq!((bench.written(), bench.wire.device_mut(0).unwrap().flash_writes()), (vec![], 0));
        // Once there is room again, all is well.
        bench.fault = None;
        let task = bench.wish(&[("compensation", "1")]);
        assert_eq!(bench.run(task).ending, Ending::Done);
    }
}

#[test]
fn the_line_and_the_polling_follow_the_device() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("address", "247"), ("baud", "115200"), ("parity", "none"), ("output_mode", "ASCII")]);
    let report = bench.run(task);
    assert_eq!(report.ending, Ending::Done);
    let reach = report.reach.unwrap();
    assert_eq!((reach.unit.0, reach.line.baud, reach.mode), (247, 115_200, Mode::Ascii));
    assert_eq!(bench.reach(), reach);
    assert!(bench.state.polling && bench.done.contains(&Done::Unit(247)));
    let polls = bench.polls;
    bench.pass(Duration::from_secs(2));
    assert!(bench.polls > polls, "the device is read where it is now");
}

#[test]
fn what_a_closed_page_has_left_is_offered_and_finished_or_undone() {
    for way in [Way::Finish, Way::Undo] {
        let mut bench = Bench::new();
        let task = bench.wish(&[("compensation", "1"), ("baud", "19200")]);
        bench.begin(task);
        let limit = bench.now + Duration::from_mins(1);
        while bench.written().len() < 2 {
            assert!(bench.step(limit), "{:?}", bench.done);
        }
        // The page is gone, and its lock with it. What is on the wire still arrives.
        bench.console = Console::new();
        bench.pass(Duration::from_secs(1));
        bench.news.clear();
        bench.state.polling = true;
        bench.set_poll();
        bench.attach();
        let [id] = bench.offered()[..] else { panic!("{:?}", bench.offered()) };
        bench.hear(ToConfigure::Recover { run: 7, journal: id, way });
        let report = bench.finish();
        let ending = if way == Way::Finish { Ending::Done } else { Ending::Undone };
        assert_eq!(report.ending, ending);
        let snapshot = bench.read();
        let held = ["compensation", "baud"].map(|point| snapshot.registers(point).unwrap()[0]);
        assert_eq!(held, if way == Way::Finish { [1, 4] } else { [2, 3] });
        assert_eq!((bench.journals.len(), bench.offered().len()), (0, 0));
        let polls = bench.polls;
        bench.pass(Duration::from_secs(2));
        assert!(bench.polls > polls);
    }
}

#[test]
fn a_lost_port_leaves_the_journal_to_be_gone_on_from() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("baud", "19200")]);
    bench.begin(task);
    let limit = bench.now + Duration::from_mins(1);
    while bench.written().len() < 2 {
        assert!(bench.step(limit));
    }
    bench.unplugged = true;
    bench.master.handle_link(bench.now, LinkEvent::Lost);
    bench.settle();
    let report = bench.finish();
    assert_eq!(report.ending, Ending::Interrupted);
    let id = report.journal.unwrap();
    bench.hear(ToConfigure::Recover { run: 7, journal: id, way: Way::Finish });
    assert_eq!(bench.refusal(), Some(&Hindrance::NoPort));
    bench.pass(Duration::from_secs(1));
    bench.unplugged = false;
    bench.master.handle_link(bench.now, LinkEvent::Plugged);
    bench.settle();
    assert!(!bench.held.contains(&id));
    bench.hear(ToConfigure::Recover { run: 7, journal: id, way: Way::Finish });
    assert_eq!(bench.finish().ending, Ending::Done);
}

#[test]
fn a_journal_that_another_page_works_on_is_left_to_it() {
    let mut bench = Bench::new();
    bench.held.insert(5);
    for (journal, why) in [(5, Hindrance::JournalHeld), (6, Hindrance::JournalGone)] {
        bench.hear(ToConfigure::Recover { run: 7, journal, way: Way::Undo });
        assert_eq!(bench.refusal(), Some(&why));
    }
    assert!(!bench.console.configuring.is_busy());
}

#[test]
fn nothing_is_begun_where_it_could_not_be_done() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1")]);
    // Only reads are let out: reading is still possible.
    bench.console.hear(bench.now, ToConsole::Line(ToLine::ReadOnly(true)));
    bench.settle();
    bench.begin(task.clone());
    assert_eq!(bench.refusal(), Some(&Hindrance::ReadOnly));
    bench.hear(ToConfigure::Recover { run: 7, journal: 1, way: Way::Undo });
    assert_eq!(bench.refusal(), Some(&Hindrance::ReadOnly));
    assert_eq!(bench.run(Task::Read).ending, Ending::Done);
    bench.console.hear(bench.now, ToConsole::Line(ToLine::ReadOnly(false)));
    bench.settle();
    // A replay.
    let replay = LineState { replay: true, open: false, ..bench.state.clone() };
    bench.console.hear_line(bench.now, UNIX_US, FromLine::State(replay));
    bench.begin(task.clone());
    assert_eq!(bench.refusal(), Some(&Hindrance::Replay));
    bench.told_state = None;
    bench.settle();
    // A profile with a fault.
    let reach = bench.reach();
    bench.hear(ToConfigure::Begin { run: 7, task: Task::Read, profile: "{\n]".into(), reach });
    assert!(matches!(bench.refusal(), Some(Hindrance::Profile(fault)) if fault.line == 2), "{:?}", bench.refusal());
    // Something else is under way.
    bench.begin(task.clone());
    bench.begin(Task::Read);
    assert_eq!(bench.refusal(), Some(&Hindrance::Busy));
    assert_eq!(bench.finish().ending, Ending::Done);
    // A hand or a sequence is at work.
    bench.console.hear(bench.now, ToConsole::Send(sending(3, every(10_000, None, Until::Never))));
    bench.settle();
    bench.begin(Task::Read);
    assert_eq!(bench.refusal(), Some(&Hindrance::Sending));
    bench.console.hear(bench.now, ToConsole::StopSending);
    bench.pass(Duration::from_secs(1));
    let (text, profile) = ("wait 60 s\n".to_owned(), String::new());
    bench.console.hear(bench.now, ToConsole::Run { edition: 1, text, profile, unit: 1 });
    bench.settle();
    bench.begin(Task::Read);
    assert_eq!(bench.refusal(), Some(&Hindrance::Sequence));
}

#[test]
fn nobody_else_sends_while_a_device_is_configured() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1")]);
    bench.begin(task);
    bench.others.clear();
    bench.console.hear(bench.now, ToConsole::Send(sending(9, None)));
    let (text, profile) = (String::from("send 01\n"), String::new());
    bench.console.hear(bench.now, ToConsole::Run { edition: 4, text, profile, unit: 1 });
    bench.console.hear(bench.now, ToConsole::Line(ToLine::Poll(true)));
    bench.console.hear(bench.now, ToConsole::Replay { speed_permille: 0, profile: String::new() });
    bench.settle();
    assert_eq!(ending(&bench.others), Some((9, 0, End::Busy)));
    assert!(bench.others.contains(&FromConsole::NotRun { edition: 4 }));
    assert!(!bench.state.polling, "the line is the procedure's");
    assert_eq!(bench.finish().ending, Ending::Done);
    let by_others = |done: &Done| matches!(done, Done::Sent(Origin::Console | Origin::Sequence, _));
    assert!(!bench.done.iter().any(by_others));
}

#[test]
fn what_is_cancelled_leaves_the_line_quiet_and_as_it_was() {
    let mut bench = Bench::new();
    // Nobody answers any more.
    bench.wire.faults.lost_replies = u32::MAX;
    let before = (bench.reach(), bench.state.polling);
    bench.begin(Task::Find {
        scope: Scope { reaches: Vec::new(), everywhere: true, units: (1..=20).map(UnitId).collect() },
    });
    bench.pass(Duration::from_secs(5));
    assert!(bench.report().is_none());
    bench.hear(ToConfigure::Cancel);
    let report = bench.finish();
    assert_eq!(report.ending, Ending::Cancelled);
    bench.settle();
    assert_eq!((bench.reach(), bench.state.polling), before);
    bench.done.clear();
    bench.pass(Duration::from_secs(5));
    assert!(!bench.done.iter().any(|done| matches!(done, Done::Sent(Origin::Configuration, _))));
}

#[test]
fn progress_comes_at_display_rate_and_the_report_at_once() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("sample_rate", "0x0006"), ("baud", "57600")]);
    let began = bench.now;
    let report = bench.run(task);
    assert_eq!(report.ending, Ending::Done);
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("sample_rate", "0x0006"), ("baud", "57600")]);
    bench.begin(task);
    let limit = bench.now + Duration::from_mins(1);
    while bench.report().is_none() {
        assert!(bench.step(limit));
    }
    let told = bench.news.iter().filter(|news| matches!(news, FromConfigure::Progress { .. })).count();
    let most = bench.now.saturating_since(began).as_millis() / 60 + 2;
    assert!(told >= 2 && told as u128 <= most, "{told}");
}

#[test]
fn every_write_is_counted_and_goes_with_the_device_to_its_new_unit_id() {
    let mut bench = Bench::new();
    let task = bench.wish(&[("compensation", "1"), ("address", "9")]);
    assert_eq!(bench.run(task).ending, Ending::Done);
    assert_eq!((bench.count(1), bench.count(9)), (0, 2));
    let key = DeviceKey { profile: bench.profile.id.clone(), unit: 9, simulated: false };
    bench.hear(ToConfigure::Device(Some(key)));
    // A hand writes, too, and reads.
    let by_hand = |unit: u8, pdu: &[u8]| buslens_codec::rtu::encode(UnitId(unit), pdu).unwrap();
    for (id, bytes) in [(1, by_hand(9, &[5, 0, 0x50, 0xFF, 0])), (2, by_hand(9, &[3, 0, 0x31, 0, 1]))] {
        bench.console.hear(bench.now, ToConsole::Send(Sending { id, bytes, wait_ms: None, repeat: None }));
        bench.settle();
        bench.pass(Duration::from_secs(1));
    }
    assert_eq!(bench.count(9), 3);
    let rows: Vec<_> =
        bench.audit.iter().map(|row| (row.origin, row.entry.point.as_str(), row.entry.reach.unit.0)).collect();
    let [configured @ .., (Origin::Console, "", 9)] = rows.as_slice() else { panic!("{rows:?}") };
    assert_eq!(configured, [(Origin::Configuration, "compensation", 1), (Origin::Configuration, "address", 1)]);
    let frames: Vec<_> = bench.audit.iter().take(2).map(|row| row.entry.sent.clone()).collect();
    assert_eq!(frames, bench.written());
    assert_eq!(bench.audit[0].entry.old, Some(vec![2]));
    assert_eq!(bench.audit[2].entry.new, [0xFF00]);
    // What only reads are let out for has not left.
    bench.console.hear(bench.now, ToConsole::Line(ToLine::ReadOnly(true)));
    let bytes = by_hand(9, &[5, 0, 0x50, 0xFF, 0]);
    bench.console.hear(bench.now, ToConsole::Send(Sending { id: 3, bytes, wait_ms: None, repeat: None }));
    bench.settle();
    bench.pass(Duration::from_secs(1));
    assert_eq!((bench.count(9), bench.audit.len()), (3, 3));
}

#[test]
fn the_audit_log_is_shown_newest_first_and_as_it_grows() {
    let mut bench = Bench::new();
    bench.hear(ToConfigure::Audit { filter: AuditFilter::default(), from: 0, count: 1 });
    let task = bench.wish(&[("compensation", "1"), ("sample_rate", "0x0006")]);
    bench.begin(task);
    let limit = bench.now + Duration::from_mins(1);
    while bench.report().is_none() {
        assert!(bench.step(limit));
    }
    let pages = bench.news.iter().filter_map(|news| match news {
        FromConfigure::Audit(page) => Some((page.total, page.rows.first().map(|row| row.entry.point.clone()))),
        _ => None,
    });
    assert_eq!(pages.collect::<Vec<_>>().last(), Some(&(2, Some("sample_rate".to_owned()))));
    let unit = Some(8);
    bench.hear(ToConfigure::Audit { filter: AuditFilter { unit, ..AuditFilter::default() }, from: 0, count: 9 });
    assert!(matches!(bench.news.last(), Some(FromConfigure::Audit(page)) if page.total == 0 && page.rows.is_empty()));
    bench.hear(ToConfigure::ExportAudit { filter: AuditFilter::default(), form: AuditForm::JsonLines });
    let Some(text) = bench.news.iter().rev().find_map(|news| match news {
        FromConfigure::AuditFile(AuditForm::JsonLines, text) => Some(text),
        _ => None,
    }) else {
        panic!("{:?}", bench.news)
    };
    assert_eq!(text.lines().count(), 2);
    assert!(text.contains("\"point\":\"compensation\""));
}
