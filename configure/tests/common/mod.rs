//! A procedure, a master and a simulated line in virtual time.

// Each test file uses a part of it.
#![allow(dead_code, unreachable_pub, unused_imports)]

mod sensors;

use std::collections::BTreeMap;
use std::time::Duration;

use buslens_bus::record::{End, Outcome};
use buslens_bus::sim::{Device as Sim, Line as Wire};
use buslens_bus::time::Instant;
use buslens_bus::{Config, Event, Exchange, Job, JobId, LinkEvent, LinkOrder, LinkState, Master, Poll};
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::{BUILT_IN, Profile};
use buslens_codec::{ascii, rtu};
use buslens_configure::{
    AuditEntry, Device, Edit, Hazard, Journal, Line, Order, Plan, Port, Procedure, Progress, Reach, Read, Report,
    Snapshot, StepOutcome, Task, Way,
};

pub use sensors::sensor;

/// When a bench begins.
pub const START: Instant = Instant::from_micros(20_000_000);
/// The time of day then.
pub const UNIX_MS: u64 = 1_777_863_721_000;

pub fn file(id: &str) -> &'static str {
    BUILT_IN.iter().copied().find(|text| Profile::from_json(text).unwrap().id == id).unwrap()
}

pub fn profile(id: &str) -> Profile {
    Profile::from_json(file(id)).unwrap()
}

/// What goes wrong with a write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    ReplyLost,
    ReplyCorrupted,
    ReplyLate,
    UnplugBefore,
    UnplugAfter,
    Reload,
    PowerCycle,
}

impl Trouble {
    pub const ALL: [Self; 7] = [
        Self::ReplyLost,
        Self::ReplyCorrupted,
        Self::ReplyLate,
        Self::UnplugBefore,
        Self::UnplugAfter,
        Self::Reload,
        Self::PowerCycle,
    ];
}

#[allow(clippy::struct_excessive_bools)] // switches and lamps, each on its own
pub struct Bench<D: Sim = Box<dyn Sim>> {
    pub master: Master,
    pub wire: Wire<D>,
    pub now: Instant,
    pub device: Device,
    /// What is kept where it outlives the page.
    pub journals: BTreeMap<u64, Journal>,
    pub audit: Vec<AuditEntry>,
    /// Everything that was sent, with its time.
    pub sent: Vec<(Instant, Vec<u8>)>,
    /// Good polls, with their time.
    pub polls: Vec<Instant>,
    pub told: Vec<Progress>,
    /// Settings that the port does not take.
    pub refuses: Vec<u32>,
    pub keeps_journals: bool,
    pub read_only: bool,
    pub unplugged: bool,
    /// What goes wrong with which write.
    pub troubles: BTreeMap<usize, Trouble>,
    pub reloaded: bool,
    /// What should go wrong has.
    pub has_struck: bool,
    /// How often a procedure has had something sent.
    pub asked: usize,
    writes: usize,
    /// When the write is carried out, and the reply has not come.
    strikes_at: Option<(Instant, Trouble)>,
    settings: (LineSettings, Mode),
    polled: UnitId,
    polling: bool,
    refused: bool,
    last_state: Option<Line>,
    jobs: BTreeMap<u32, JobId>,
}

impl Bench {
    /// One sensor of this kind with factory settings, alone on the line, and being polled.
    pub fn of(id: &str) -> Self {
        Self::new(file(id), [sensor(id)])
    }
}

impl<D: Sim> Bench<D> {
    /// Sensors on the line; the first one is polled.
    pub fn new(file: &str, devices: impl IntoIterator<Item = D>) -> Self {
        let profile = Profile::from_json(file).unwrap();
        let device = Device::new(file, Reach::of_factory(&profile)).unwrap();
        let mut bench = Self {
            master: Master::new(config(&profile)),
            wire: Wire::new(devices, 7),
            now: START,
            journals: BTreeMap::new(),
            audit: Vec::new(),
            sent: Vec::new(),
            polls: Vec::new(),
            told: Vec::new(),
            refuses: Vec::new(),
            keeps_journals: true,
            read_only: false,
            unplugged: false,
            troubles: BTreeMap::new(),
            reloaded: false,
            has_struck: false,
            asked: 0,
            writes: 0,
            strikes_at: None,
            settings: (profile.line, profile.mode),
            polled: device.reach.unit,
            polling: true,
            refused: false,
            last_state: None,
            jobs: BTreeMap::new(),
            device,
        };
        bench.master.connect(bench.now);
        bench.set_poll();
        bench.settle(&mut None);
        bench
    }

    pub fn sensor(&mut self) -> &mut D {
        self.wire.device_mut(0).unwrap()
    }

    pub fn profile(&self) -> Profile {
        (*self.device.profile).clone()
    }

    /// Sets the port as the sensor needs it, as a user who knows.
    pub fn follow(&mut self) {
        let reach = self.truth(0).0;
        self.device.reach = reach;
        self.polled = reach.unit;
        self.settings = (reach.line, reach.mode);
        self.master.reconfigure(self.now, reach.line, reach.mode);
        self.set_poll();
        self.settle(&mut None);
    }

    /// The truth: how a sensor is reached and what its parameters hold, asked without any line.
    pub fn truth(&mut self, index: usize) -> (Reach, BTreeMap<String, Vec<u16>>) {
        let (profile, now) = (self.profile(), self.now);
        let sensor = self.wire.device_mut(index).unwrap();
        let mut held = BTreeMap::new();
        let sign = profile.live_groups()[0];
        let mut ask = |unit: u8, function: u8, address: u16, quantity: u16| {
            let ([a, b], [c, d]) = (address.to_be_bytes(), quantity.to_be_bytes());
            let reply = sensor.serve(now, UnitId(unit), &[function, a, b, c, d])?;
            (reply.pdu[0] == function).then_some(reply.pdu)
        };
        let unit = (1..=255).find(|unit| ask(*unit, sign.function, sign.address, sign.quantity).is_some()).unwrap();
        for point in &profile.points {
            let Some(function) = point.read.first().filter(|function| matches!(function, 3 | 4)) else { continue };
            let quantity = u16::try_from(point.encoding.registers()).unwrap();
            if let Some(pdu) = ask(unit, *function, point.register, quantity) {
                let words = pdu[2..].chunks(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect();
                held.insert(point.id.clone(), words);
            }
        }
        (Reach { unit: UnitId(unit), line: sensor.line(), mode: sensor.mode() }, held)
    }

    pub fn edit(&self, point: &str, text: &str, have: &Snapshot) -> Edit {
        let profile = self.profile();
        let found = profile.point(point).unwrap();
        Edit::parse(&profile, found, text, have).unwrap_or_else(|refusal| panic!("{point} = {text}: {refusal:?}"))
    }

    /// Reads every parameter.
    pub fn read(&mut self) -> Snapshot {
        let report = self.carry_out(Task::Read);
        report.snapshot.unwrap_or_else(|| panic!("{:?}", report.ending))
    }

    /// Reads, edits as typed, confirms everything, applies.
    pub fn apply(&mut self, typed: &[(&str, &str)]) -> Report {
        let before = self.read();
        let edits: Vec<Edit> = typed.iter().map(|(point, text)| self.edit(point, text, &before)).collect();
        self.apply_edits(before, edits)
    }

    pub fn apply_edits(&mut self, before: Snapshot, edits: Vec<Edit>) -> Report {
        let confirmed = self.hazards(&before, &edits);
        self.carry_out(Task::Apply { before, edits, confirmed })
    }

    pub fn hazards(&self, before: &Snapshot, edits: &[Edit]) -> Vec<Hazard> {
        Plan::of(&self.device.profile, before, edits).map(|plan| plan.hazards).unwrap_or_default()
    }

    pub fn recover(&mut self, way: Way) -> Report {
        let journal = self.journals.values().next().cloned().expect("a journal is kept");
        self.device = Device { slowest_us: 0, refused: Vec::new(), ..journal.device().unwrap() };
        self.carry_out(Task::Recover { journal, way })
    }

    pub fn begin(&mut self, task: Task) -> Option<Procedure> {
        self.told.clear();
        let unix_ms = UNIX_MS + u64::try_from(self.now.saturating_since(START).as_millis()).unwrap();
        let mut procedure = Some(Procedure::begin(self.now, unix_ms, task, self.device.clone(), self.state()));
        self.settle(&mut procedure);
        procedure
    }

    /// To its end, within an hour of the line; or until the page is reloaded: then `None`.
    pub fn run(&mut self, mut procedure: Option<Procedure>) -> Option<Report> {
        let limit = self.now + Duration::from_hours(1);
        while procedure.as_ref().is_some_and(|procedure| !procedure.has_ended()) {
            assert!(self.step(&mut procedure, limit), "it never ended: {procedure:?}");
        }
        let procedure = procedure?;
        self.device = procedure.device();
        procedure.report().cloned()
    }

    pub fn carry_out(&mut self, task: Task) -> Report {
        let procedure = self.begin(task);
        self.run(procedure).expect("the page was not reloaded")
    }

    /// Lets the polling go on for so long, and says how many polls were good.
    pub fn poll_for(&mut self, time: Duration) -> usize {
        let until = self.now + time;
        let before = self.polls.len();
        while self.step(&mut None, until) {}
        self.now = until;
        self.polls.len() - before
    }

    /// The port is there again and opens with the settings that it had.
    pub fn replug(&mut self) {
        self.unplugged = false;
        self.master.handle_link(self.now, LinkEvent::Plugged);
        self.settle(&mut None);
        assert_eq!(self.master.link_state(), LinkState::Open);
    }

    pub fn unplug(&mut self) {
        self.unplugged = true;
        self.master.handle_link(self.now, LinkEvent::Lost);
    }

    fn state(&self) -> Line {
        let (line, mode) = self.settings;
        let port = match self.master.link_state() {
            LinkState::Open if !self.master.is_reconfiguring() => Port::Open,
            LinkState::Open | LinkState::Opening => Port::Changing,
            LinkState::Closed if self.refused => Port::Refused,
            LinkState::Closed | LinkState::Closing | LinkState::Lost => Port::Gone,
        };
        Line { port, line, mode, polling: self.polling, read_only: self.read_only }
    }

    fn set_poll(&mut self) {
        let profile = &self.device.profile;
        let requests = profile.live_groups().iter().filter_map(buslens_codec::profile::Group::request).collect();
        let period = Duration::from_millis(profile.timing.poll_period_ms.into());
        let poll = Poll { unit: self.polled, requests, period };
        self.master.set_poll(self.now, self.polling.then_some(poll));
    }

    /// To the next thing that happens, if it happens by `limit`.
    pub fn step(&mut self, procedure: &mut Option<Procedure>, limit: Instant) -> bool {
        let next = [
            self.master.poll_timeout(),
            self.wire.poll_timeout(),
            procedure.as_ref().and_then(Procedure::poll_timeout),
            self.strikes_at.map(|(at, _)| at),
        ];
        let Some(next) = next.into_iter().flatten().min().filter(|&next| next <= limit) else { return false };
        self.now = next.max(self.now);
        self.wire.handle_timeout(self.now);
        if let Some((_, trouble)) = self.strikes_at.take_if(|(at, _)| *at <= next) {
            self.strike(trouble, procedure);
        }
        if let Some(bytes) = self.wire.poll_transmit()
            && self.master.link_state() == LinkState::Open
        {
            self.master.handle_bytes(self.now, &bytes);
        }
        self.master.handle_timeout(self.now);
        if let Some(procedure) = procedure {
            procedure.timeout(self.now);
        }
        self.settle(procedure);
        true
    }

    pub fn settle(&mut self, procedure: &mut Option<Procedure>) {
        loop {
            if let Some(told) = procedure.as_mut().and_then(Procedure::poll_progress) {
                self.told.push(told);
            }
            if let Some(order) = procedure.as_mut().and_then(Procedure::poll_order) {
                self.obey(order, procedure);
            } else if let Some(order) = self.master.poll_link() {
                let event = match order {
                    LinkOrder::Open(_) if self.unplugged => LinkEvent::OpenFailed,
                    LinkOrder::Open(settings) if self.refuses.contains(&settings.baud) => {
                        self.refused = true;
                        LinkEvent::OpenFailed
                    }
                    LinkOrder::Open(settings) => {
                        self.refused = false;
                        self.wire.handle_settings(self.now, settings);
                        LinkEvent::Opened
                    }
                    LinkOrder::Close => LinkEvent::Closed,
                };
                self.master.handle_link(self.now, event);
            } else if let Some(transmit) = self.master.poll_transmit() {
                self.transmit(&transmit.bytes);
            } else if let Some(event) = self.master.poll_event() {
                self.hear(event, procedure);
            } else if self.last_state != Some(self.state()) {
                self.last_state = Some(self.state());
                if let Some(procedure) = procedure {
                    procedure.state(self.now, self.state());
                }
            } else {
                return;
            }
        }
    }

    fn transmit(&mut self, bytes: &[u8]) {
        self.sent.push((self.now, bytes.to_vec()));
        let is_write = matches!(function_of(self.settings.1, bytes), Some(5 | 6 | 15 | 16));
        let trouble = self.troubles.get(&self.writes).copied().filter(|_| is_write);
        self.writes += usize::from(is_write);
        self.has_struck |= trouble.is_some();
        let faults = &mut self.wire.faults;
        let (line, _) = self.settings;
        let carried_out = self.now + line.character_time(bytes.len()) + line.frame_gap() + Duration::from_millis(1);
        match trouble {
            None | Some(Trouble::UnplugBefore) => {}
            Some(Trouble::ReplyLost) => faults.lost_replies = 1,
            Some(Trouble::ReplyCorrupted) => faults.corrupted_replies = 1,
            Some(Trouble::ReplyLate) => {
                faults.reply_delay = Duration::from_millis(700);
                faults.delayed_replies = Some(1);
            }
            Some(other) => {
                faults.lost_replies = 1;
                self.strikes_at = Some((carried_out, other));
            }
        }
        if trouble == Some(Trouble::UnplugBefore) {
            self.unplug();
        } else {
            self.wire.handle_bytes(self.now, bytes);
        }
    }

    fn strike(&mut self, trouble: Trouble, procedure: &mut Option<Procedure>) {
        match trouble {
            Trouble::UnplugAfter => self.unplug(),
            Trouble::PowerCycle => {
                let now = self.now;
                self.sensor().power_cycle(now);
            }
            Trouble::Reload => {
                // The page goes, and with it the master and the port. The new one opens the port as it was.
                *procedure = None;
                self.reloaded = true;
                self.jobs.clear();
                self.master = Master::new(Config {
                    line: self.settings.0,
                    mode: self.settings.1,
                    ..config(&self.device.profile)
                });
                self.master.connect(self.now);
                self.polling = true;
                self.set_poll();
            }
            other => panic!("{other:?} does not strike later"),
        }
    }

    fn hear(&mut self, event: Event, procedure: &mut Option<Procedure>) {
        match event {
            Event::Done { job, exchange } => {
                let id = self.jobs.iter().find(|(_, own)| **own == job).map(|(id, _)| *id);
                if let (Some(id), Some(procedure)) = (id, procedure) {
                    self.jobs.remove(&id);
                    procedure.done(self.now, id, &Outcome::from(&exchange));
                }
            }
            Event::Polled { exchange: Exchange { result: Ok(_), .. }, .. } => self.polls.push(self.now),
            Event::Link(_) | Event::Polled { .. } => {}
        }
    }

    fn obey(&mut self, order: Order, procedure: &mut Option<Procedure>) {
        let Some(procedure) = procedure else { return };
        match order {
            Order::Send { id, bytes, wait_ms } => {
                let job = Job::raw(bytes, wait_ms.map(|wait| Duration::from_millis(wait.into())));
                let job = self.master.submit(self.now, job);
                self.jobs.insert(id, job);
                self.asked += 1;
            }
            Order::Withdraw(id) => {
                if self.jobs.get(&id).is_some_and(|job| self.master.withdraw(*job)) {
                    self.jobs.remove(&id);
                    let end = End::Withdrawn;
                    let outcome = Outcome { at_us: 0, heard: Vec::new(), round_trip_us: None, end };
                    procedure.done(self.now, id, &outcome);
                }
            }
            Order::Settings { line, mode } => {
                self.settings = (line, mode);
                if self.master.link_state() == LinkState::Closed {
                    self.refused = false;
                    self.master = Master::new(Config { line, mode, ..config(&self.device.profile) });
                    self.master.connect(self.now);
                } else {
                    self.master.reconfigure(self.now, line, mode);
                }
                self.set_poll();
            }
            Order::Poll(on) => {
                self.polling = on;
                self.set_poll();
            }
            Order::Unit(unit) => {
                self.polled = unit;
                self.set_poll();
            }
            Order::Keep(journal) if self.keeps_journals => {
                let id = journal.id;
                let text = journal.to_json();
                self.journals.insert(id, Journal::from_json(&text).unwrap());
                procedure.kept(self.now, id);
            }
            Order::Keep(journal) => procedure.not_kept(self.now, journal.id),
            Order::Forget(id) => {
                self.journals.remove(&id);
            }
            Order::Audit(entry) => self.audit.push(*entry),
        }
    }

    /// The device is polled with success where the report says that it is, and nowhere else.
    #[track_caller]
    pub fn assert_polls(&mut self, report: &Report) {
        assert_eq!(report.reach, Some(self.truth(0).0), "the report's reach is the truth");
        assert!(self.poll_for(Duration::from_secs(5)) > 2, "the device is not polled: {:?}", self.settings);
    }

    /// Everything that the report claims to know is so.
    #[track_caller]
    pub fn assert_true(&mut self, report: &Report) {
        let (reach, held) = self.truth(0);
        if let Some(claimed) = report.reach {
            assert_eq!(claimed, reach, "{:?}", report.ending);
        }
        if let Some(snapshot) = &report.snapshot {
            self.assert_snapshot(snapshot);
        }
        for step in &report.steps {
            let holds = |registers: &[u16]| held.get(&step.point).is_none_or(|held| held == registers);
            let so = match &step.outcome {
                StepOutcome::Confirmed => holds(&step.after),
                StepOutcome::Undone => step.before.as_ref().is_none_or(|before| holds(before)),
                StepOutcome::NotHeld(Read::Registers(registers)) => holds(registers),
                StepOutcome::Waiting | StepOutcome::NotSent if report.reach.is_some() => {
                    step.before.as_ref().is_none_or(|before| holds(before))
                }
                _ => true,
            };
            assert!(so, "{step:?} in {:?}, and it holds {:?}", report.ending, held.get(&step.point));
        }
        let kept = self.journals.keys().next().copied();
        assert_eq!(report.journal, kept, "the journal that is open is kept: {:?}", report.ending);
    }

    /// This goes wrong with the write after so many others.
    pub fn trouble_after(&mut self, writes: usize, trouble: Trouble) {
        self.troubles.insert(self.writes + writes, trouble);
    }

    /// What the report's snapshot says is what the device holds.
    #[track_caller]
    pub fn assert_snapshot(&mut self, snapshot: &Snapshot) {
        let (_, held) = self.truth(0);
        for datum in &snapshot.data {
            let Read::Registers(registers) = &datum.read else { continue };
            assert_eq!(held.get(&datum.point), Some(registers), "{}", datum.point);
        }
    }
}

fn config(profile: &Profile) -> Config {
    Config {
        response_timeout: Duration::from_millis(profile.timing.response_timeout_ms.into()),
        unit_pause: Duration::from_millis(profile.timing.inter_device_pause_ms.into()),
        ..Config::new(profile.line, profile.mode)
    }
}

pub fn function_of(mode: Mode, frame: &[u8]) -> Option<u8> {
    match mode {
        Mode::Rtu => rtu::decode(frame).ok().and_then(|adu| adu.pdu.first().copied()),
        Mode::Ascii => ascii::decode(frame).ok().and_then(|adu| adu.pdu.first().copied()),
    }
}
