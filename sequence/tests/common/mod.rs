//! A sequence, a master and a simulated line in virtual time.

// Each test file uses a part of it.
#![allow(dead_code, unreachable_pub)]

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use buslens_bus::record::{End, Outcome};
use buslens_bus::sim::{Device, Line};
use buslens_bus::time::Instant;
use buslens_bus::{Config, Event, Job, JobId, LinkEvent, LinkOrder, LinkState, Master, Poll};
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::{BUILT_IN, Profile};
use buslens_sequence::{Entry, Mark, Order, Report, Run, Sequence, parse};

/// When a bench begins.
pub const START: Instant = Instant::from_micros(20_000_000);

pub fn profile(id: &str) -> Profile {
    let all = BUILT_IN.iter().map(|text| Profile::from_json(text).unwrap());
    all.into_iter().find(|profile| profile.id == id).unwrap()
}

pub fn sequence(text: &str, profile: &Profile) -> Arc<Sequence> {
    Arc::new(parse(text, Some(profile)).unwrap_or_else(|faults| panic!("{faults:?}\n{text}")))
}

pub struct Bench<D: Device> {
    pub master: Master,
    pub line: Line<D>,
    pub now: Instant,
    pub profile: Arc<Profile>,
    /// Orders that are not the master's.
    pub others: Vec<Order>,
    /// What the report becomes by its changes alone.
    pub told: Report,
    pub unplugged: bool,
    settings: (LineSettings, Mode),
    polling: bool,
    last_state: Option<buslens_sequence::Line>,
    jobs: BTreeMap<u32, JobId>,
}

impl<D: Device> Bench<D> {
    /// One device alone on the line, an open link with the profile's settings, and a poll.
    pub fn new(profile: Profile, device: D) -> Self {
        let mut bench = Self {
            master: Master::new(Config::new(profile.line, profile.mode)),
            line: Line::new([device], 7),
            now: START,
            settings: (profile.line, profile.mode),
            profile: Arc::new(profile),
            others: Vec::new(),
            told: Report::default(),
            unplugged: false,
            polling: true,
            last_state: None,
            jobs: BTreeMap::new(),
        };
        bench.master.connect(bench.now);
        bench.set_poll(true);
        let mut run = bench.begin("");
        bench.settle(&mut run);
        assert_eq!(bench.master.link_state(), LinkState::Open);
        bench
    }

    pub fn sensor(&mut self) -> &mut D {
        self.line.device_mut(0).unwrap()
    }

    pub fn begin(&mut self, text: &str) -> Run {
        let sequence = sequence(text, &self.profile);
        self.told = Report::default();
        let unit = UnitId(self.profile.unit);
        Run::new(sequence, unit, Some(Arc::clone(&self.profile)), self.state(), self.now)
    }

    /// Runs a text to its end, within ten minutes of the line.
    pub fn run(&mut self, text: &str) -> Report {
        let mut run = self.begin(text);
        let limit = self.now + Duration::from_mins(10);
        self.settle(&mut run);
        while !run.has_ended() {
            assert!(self.step(&mut run, limit), "it never ended: {:#?}", run.report().entries.last());
        }
        self.settle(&mut run);
        assert_eq!(&self.told, run.report(), "the changes make the report");
        self.told.clone()
    }

    fn state(&self) -> buslens_sequence::Line {
        let (line, mode) = self.settings;
        let open = self.master.link_state() == LinkState::Open;
        buslens_sequence::Line { open, line, mode, polling: self.polling }
    }

    fn set_poll(&mut self, on: bool) {
        self.polling = on;
        let requests = self.profile.live_groups().iter().filter_map(buslens_codec::profile::Group::request).collect();
        let period = Duration::from_millis(self.profile.timing.poll_period_ms.into());
        let poll = Poll { unit: UnitId(self.profile.unit), requests, period };
        self.master.set_poll(self.now, on.then_some(poll));
    }

    /// To the next thing that happens, if it happens by `limit`.
    pub fn step(&mut self, run: &mut Run, limit: Instant) -> bool {
        let next = [self.master.poll_timeout(), self.line.poll_timeout(), run.poll_timeout()];
        let Some(next) = next.into_iter().flatten().min().filter(|&next| next <= limit) else { return false };
        self.now = next.max(self.now);
        self.line.handle_timeout(self.now);
        if let Some(bytes) = self.line.poll_transmit() {
            self.master.handle_bytes(self.now, &bytes);
        }
        self.master.handle_timeout(self.now);
        run.timeout(self.now);
        self.settle(run);
        true
    }

    pub fn settle(&mut self, run: &mut Run) {
        loop {
            if let Some(changes) = run.poll_changes() {
                self.told.apply(changes);
            }
            if let Some(order) = run.poll_order() {
                self.obey(order, run);
            } else if let Some(order) = self.master.poll_link() {
                let event = match order {
                    LinkOrder::Open(_) if self.unplugged => LinkEvent::OpenFailed,
                    LinkOrder::Open(settings) => {
                        self.line.handle_settings(self.now, settings);
                        LinkEvent::Opened
                    }
                    LinkOrder::Close => LinkEvent::Closed,
                };
                self.master.handle_link(self.now, event);
            } else if let Some(transmit) = self.master.poll_transmit() {
                self.line.handle_bytes(self.now, &transmit.bytes);
            } else if let Some(event) = self.master.poll_event() {
                match event {
                    Event::Done { job, exchange } => {
                        let id = self.jobs.iter().find(|(_, own)| **own == job).map(|(id, _)| *id);
                        if let Some(id) = id {
                            self.jobs.remove(&id);
                            run.done(self.now, id, &Outcome::from(&exchange));
                        }
                    }
                    Event::Link(_) | Event::Polled { .. } => {}
                }
            } else if self.last_state != Some(self.state()) {
                self.last_state = Some(self.state());
                run.state(self.now, self.state());
            } else {
                return;
            }
        }
    }

    fn obey(&mut self, order: Order, run: &mut Run) {
        match order {
            Order::Send { id, bytes, wait_ms } => {
                let job = Job::raw(bytes, wait_ms.map(|wait| Duration::from_millis(wait.into())));
                let job = self.master.submit(self.now, job);
                self.jobs.insert(id, job);
            }
            Order::Withdraw(id) => {
                if self.jobs.remove(&id).is_some_and(|job| self.master.withdraw(job)) {
                    let end = End::Withdrawn;
                    let outcome = Outcome { at_us: 0, heard: Vec::new(), round_trip_us: None, end };
                    run.done(self.now, id, &outcome);
                }
            }
            Order::Settings { line, mode } => {
                self.settings = (line, mode);
                self.master.reconfigure(self.now, line, mode);
            }
            Order::Poll(on) => {
                self.set_poll(on);
                self.others.push(Order::Poll(on));
            }
            other => self.others.push(other),
        }
    }
}

/// Steps that failed, by their lines.
pub fn failed(report: &Report) -> Vec<(u32, &Entry)> {
    report.entries.iter().filter(|entry| entry.mark == Mark::Failed).map(|entry| (entry.line, entry)).collect()
}

/// The line of a text that is this.
#[track_caller]
pub fn line_of(text: &str, line: &str) -> u32 {
    let at = text.lines().position(|own| own.trim() == line).unwrap_or_else(|| panic!("no line {line:?}"));
    u32::try_from(at + 1).unwrap()
}
