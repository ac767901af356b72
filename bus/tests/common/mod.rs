//! A master and a simulated line in virtual time.

// Each test file uses a part of it.
#![allow(dead_code, unreachable_pub)]

pub mod asked;

use std::time::Duration;

use buslens_bus::record::{Note, Origin, What};
use buslens_bus::sim::{Device, Line, Lvdt, Motion};
use buslens_bus::time::Instant;
use buslens_bus::{Answer, Config, Event, Exchange, Job, JobId, LinkEvent, LinkOrder, Master, Poll};
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::pdu::{Request, Response};

pub const FACTORY: LineSettings = LineSettings::new(9600, Parity::Even);
/// When a bench begins.
pub const START: Instant = Instant::from_micros(10_000_000);
pub const BOTH: Request = Request::ReadInputRegisters { address: 2, quantity: 4 };

pub struct Bench<D: Device = Lvdt> {
    pub master: Master,
    pub line: Line<D>,
    pub now: Instant,
    pub events: Vec<Event>,
    /// Everything that went over the host's port.
    pub notes: Vec<Note>,
    /// The port does not open while this is set.
    pub unplugged: bool,
}

impl Bench {
    /// A sensor at unit 1 that rests at -0.328 mm and 25.5 degC, and an open link.
    pub fn new(config: Config) -> Self {
        Self::with(config, Lvdt::new(1, Motion::Rest { micrometres: -328, decidegrees: 255 }))
    }

    pub fn factory() -> Self {
        Self::new(Config::new(FACTORY, Mode::Rtu))
    }

    pub fn rest_at(&mut self, micrometres: i32) {
        self.sensor().motion = Motion::Rest { micrometres, decidegrees: 255 };
    }
}

impl<D: Device> Bench<D> {
    /// One device alone on the line, and an open link.
    pub fn with(config: Config, device: D) -> Self {
        let mut bench = Self {
            master: Master::new(config),
            line: Line::new([device], 7),
            now: START,
            events: Vec::new(),
            notes: Vec::new(),
            unplugged: false,
        };
        bench.master.connect(bench.now);
        bench.settle();
        bench
    }

    pub fn sensor(&mut self) -> &mut D {
        self.line.device_mut(0).unwrap()
    }

    /// Cuts the supply of the line for a moment.
    pub fn power_cycle(&mut self) {
        self.line.power_cycle(self.now);
    }

    /// Opens the port anew with other settings.
    pub fn reopen(&mut self, line: LineSettings, mode: Mode) {
        self.master = Master::new(Config::new(line, mode));
        self.master.connect(self.now);
        self.settle();
    }

    pub fn poll_every(&mut self, period: Duration, requests: impl Into<Vec<Request>>) {
        let poll = Poll { unit: UnitId(1), requests: requests.into(), period };
        self.master.set_poll(self.now, Some(poll));
        self.settle();
    }

    /// Makes one request and returns how it ended, within ten seconds.
    pub fn ask(&mut self, unit: u8, request: Request) -> Exchange {
        let id = self.submit(Job::new(UnitId(unit), request));
        self.end_of(id)
    }

    /// Queues a job.
    pub fn submit(&mut self, job: Job) -> JobId {
        let id = self.master.submit(self.now, job);
        self.settle();
        id
    }

    /// How a job ends, within ten seconds.
    pub fn end_of(&mut self, id: JobId) -> Exchange {
        let limit = self.now + Duration::from_secs(10);
        loop {
            let done = self.events.iter().position(|event| matches!(event, Event::Done { job, .. } if *job == id));
            if let Some(Event::Done { exchange, .. }) = done.map(|index| self.events.remove(index)) {
                return exchange;
            }
            assert!(self.step(limit), "the job never ended");
        }
    }

    /// Runs for `time` and returns the exchanges of the poll that ended in it.
    pub fn run(&mut self, time: Duration) -> Vec<Exchange> {
        let until = self.now + time;
        while self.step(until) {}
        self.now = until;
        self.line.handle_timeout(until);
        self.master.handle_timeout(until);
        self.settle();
        let polled = |event| match event {
            Event::Polled { exchange, .. } => Some(exchange),
            _ => None,
        };
        let (polls, others) = self.events.drain(..).partition(|event| matches!(event, Event::Polled { .. }));
        self.events = others;
        let polls: Vec<Event> = polls;
        polls.into_iter().filter_map(polled).collect()
    }

    /// Bytes out of nowhere.
    pub fn hear(&mut self, bytes: &[u8]) {
        self.master.handle_bytes(self.now, bytes);
        self.note(What::Received(bytes.to_vec()));
        self.settle();
    }

    fn note(&mut self, what: What) {
        self.notes.push(Note { at_us: self.now.as_micros(), what });
    }

    /// What has left, with its time and who wanted it.
    pub fn sent(&self) -> impl Iterator<Item = (u64, Origin, &[u8])> {
        self.notes.iter().filter_map(|note| match &note.what {
            What::Sent { origin, bytes } => Some((note.at_us, *origin, bytes.as_slice())),
            _ => None,
        })
    }

    /// To the next thing that happens, if it happens by `limit`.
    fn step(&mut self, limit: Instant) -> bool {
        let next = [self.master.poll_timeout(), self.line.poll_timeout()].into_iter().flatten().min();
        let Some(next) = next.filter(|&next| next <= limit) else { return false };
        self.now = next.max(self.now);
        self.line.handle_timeout(self.now);
        if let Some(bytes) = self.line.poll_transmit() {
            self.master.handle_bytes(self.now, &bytes);
            self.note(What::Received(bytes));
        }
        self.master.handle_timeout(self.now);
        self.settle();
        true
    }

    pub fn settle(&mut self) {
        loop {
            if let Some(order) = self.master.poll_link() {
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
                self.note(What::Sent { origin: transmit.origin, bytes: transmit.bytes });
            } else if let Some(event) = self.master.poll_event() {
                self.events.push(event);
            } else {
                return;
            }
        }
    }
}

/// Displacement in micrometres of a reply to [`BOTH`].
pub fn micrometres(exchange: &Exchange) -> Option<i32> {
    match &exchange.result {
        Ok(Answer::Reply(Response::ReadInputRegisters { values })) if values.len() == 4 => {
            let magnitude = i32::from(values[2] & 0x7FFF) * 1000 + i32::from(values[3]);
            Some(if values[2] & 0x8000 == 0 { magnitude } else { -magnitude })
        }
        _ => None,
    }
}
