//! One connection from [`ToEngine::Connect`](crate::message::ToEngine) on, or one replay: drives the master and the port,
//! notes what goes over it, and tells the window.

use std::rc::Rc;
use std::time::Duration;

use buslens_analyst::line::{PortState, Signals, ToLine};
use buslens_bus::record::{self, End, Note, Origin, Outcome, What};
use buslens_bus::time::Instant;
use buslens_bus::{Config, Event, Job, JobId, LinkEvent, LinkOrder, LinkState, Master, Poll};
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::{Group, Profile};

use super::console::Console;
use super::port::{Port, PortEvent, Signal};
use super::progress::Progress;
use super::scope::{self, Awake, now};
use super::simulator::SimulatedPort;
use super::{Engine, Input};
use crate::message::{Connection, Line, Link, OpenFault, Source, ToWindow};
use crate::serial::WebSerialPort;

/// Nobody reads faster: more statuses a second would only cost.
const STATUS_PERIOD: Duration = Duration::from_millis(50);
/// Time between two looks at the port's inputs, while somebody wants to know.
const LOOK_PERIOD: Duration = Duration::from_millis(250);
/// No break is longer, in milliseconds: nobody else can use the line meanwhile.
const LONGEST_BREAK_MS: u32 = 60_000;
/// What a browser takes for its buffer, in bytes.
const BUFFER_BYTES: std::ops::RangeInclusive<u32> = 1..=1 << 24;

pub(super) struct Session {
    number: u32,
    connection: Connection,
    master: Master,
    /// `None` in a replay.
    port: Option<Box<dyn Port>>,
    progress: Progress,
    polling: bool,
    /// Time between two readings where the connection does not say it.
    usual_period_ms: u32,
    requests: Vec<buslens_codec::pdu::Request>,
    /// What the console has submitted, in order.
    sends: Vec<(JobId, Send)>,
    /// The port has been open since it was last told to be closed.
    opened: bool,
    open_fault: Option<OpenFault>,
    told_at: Instant,
    looked_at: Instant,
    /// In a replay, the recording's time.
    clock: Instant,
    /// What the window knows: settings, unit, whether it is polled, whether only reads are let out.
    told: Option<(LineSettings, Mode, UnitId, bool, bool)>,
    _awake: Awake,
}

/// What the console wants done.
#[derive(Clone, Copy)]
enum Send {
    /// Bytes; the end is told with this number.
    Bytes(u32),
    /// A break of so many milliseconds.
    Break(u32),
}

impl Session {
    /// Starts to open the port. A profile that does not load is refused.
    pub(super) fn start(
        engine: &Rc<Engine>,
        number: u32,
        connection: Connection,
        console: &mut Console,
    ) -> Result<Self, OpenFault> {
        let profile = Profile::unpack(&connection.profile)
            .ok_or_else(|| OpenFault::Other("the profile cannot be read".to_owned()))?;
        let port = make_port(engine, number, connection.source, &profile);
        let mut master = Master::new(config(Some(&profile), connection.line, connection.mode));
        master.set_read_only(console.line.read_only);
        console.line.signals = Signals::default();
        let polling = connection.period_ms > 0;
        let mut session = Self::new(number, connection, master, Some(port), Some(profile));
        session.poll(polling);
        session.master.connect(now());
        Ok(session)
    }

    /// Starts a replay; without a readable profile nothing in it is a reading.
    pub(super) fn replay(number: u32, packed: Vec<u8>, line: LineSettings, mode: Mode) -> Self {
        let profile = Profile::unpack(&packed);
        let master = Master::replaying(config(profile.as_ref(), line, mode));
        let connection =
            Connection { source: Source::Replay, line, mode, unit: UnitId(0), period_ms: 0, profile: packed };
        let mut session = Self::new(number, connection, master, None, profile);
        session.connection.period_ms = session.usual_period_ms;
        session.poll(true);
        session
    }

    fn new(
        number: u32,
        connection: Connection,
        master: Master,
        port: Option<Box<dyn Port>>,
        profile: Option<Profile>,
    ) -> Self {
        let groups = profile.as_ref().map(Profile::live_groups).unwrap_or_default();
        let requests = groups.iter().filter_map(Group::request).collect();
        let usual_period_ms = profile.as_ref().map_or(1000, |profile| profile.timing.poll_period_ms);
        let period = if connection.period_ms > 0 { connection.period_ms } else { usual_period_ms };
        Self {
            number,
            connection,
            master,
            port,
            progress: Progress::new(profile, Duration::from_millis(period.into())),
            polling: false,
            usual_period_ms,
            requests,
            sends: Vec::new(),
            opened: false,
            open_fault: None,
            told_at: Instant::ZERO,
            looked_at: Instant::ZERO,
            clock: Instant::ZERO,
            told: None,
            _awake: Awake::new(),
        }
    }

    pub(super) fn number(&self) -> u32 {
        self.number
    }

    pub(super) fn is_replay(&self) -> bool {
        self.port.is_none()
    }

    pub(super) fn disconnect(&mut self) {
        self.master.disconnect(now());
    }

    /// The last of this session: what has not ended ends now.
    pub(super) fn end(mut self, console: &mut Console) {
        if self.is_replay() {
            self.progress.link_changed(self.clock, Link::Closed);
            self.post_status();
        } else {
            self.master.disconnect(now());
            self.drain(console);
            self.note_closed(console, What::Port(record::Event::Closed));
        }
        console.line.open = false;
        console.line.port = PortState::Gone;
        console.line.replay = false;
    }

    pub(super) fn handle_port(&mut self, event: PortEvent, console: &mut Console) {
        let now = now();
        match event {
            PortEvent::Bytes(bytes) => {
                self.master.handle_bytes(now, &bytes);
                console.note(now, What::Received(bytes));
            }
            PortEvent::Opened => {
                self.opened = true;
                self.open_fault = None;
                console.note(now, What::Port(record::Event::Opened(self.connection.line, self.connection.mode)));
                // A port forgets its outputs when it is opened again.
                let Signals { dtr, rts, .. } = console.line.signals;
                if dtr.is_some() || rts.is_some() {
                    self.signal(Signal::Set(dtr, rts));
                }
                self.master.handle_link(now, LinkEvent::Opened);
            }
            PortEvent::Closed => {
                self.note_closed(console, What::Port(record::Event::Closed));
                self.master.handle_link(now, LinkEvent::Closed);
            }
            PortEvent::Lost => {
                self.note_closed(console, What::Port(record::Event::Lost));
                self.master.handle_link(now, LinkEvent::Lost);
            }
            PortEvent::LineError => {
                console.note(now, What::Port(record::Event::LineError));
                self.master.handle_link(now, LinkEvent::LineError);
            }
            PortEvent::OpenFailed(fault) => {
                self.note_closed(console, What::Port(record::Event::Closed));
                self.open_fault = Some(fault);
                self.master.handle_link(now, LinkEvent::OpenFailed);
            }
            PortEvent::Inputs([cts, dsr, dcd, ri]) => {
                let Signals { dtr, rts, .. } = console.line.signals;
                console.line.signals =
                    Signals { dtr, rts, cts: Some(cts), dsr: Some(dsr), dcd: Some(dcd), ri: Some(ri) };
            }
        }
    }

    pub(super) fn handle_plugged(&mut self) {
        self.master.handle_link(now(), LinkEvent::Plugged);
    }

    /// Carries out what the console wants of the line.
    pub(super) fn handle_line(&mut self, message: ToLine, console: &mut Console) {
        let now = now();
        match message {
            ToLine::Play(notes) => self.play(notes, console),
            ToLine::Send { id, .. } if self.is_replay() => console.unsent(now, id, End::NoPort),
            ToLine::Send { id, bytes, .. } if bytes.is_empty() => console.unsent(now, id, End::Silence),
            ToLine::Send { id, origin, bytes, wait_ms } => {
                let job = Job::raw(bytes, wait_ms.map(milliseconds)).by(origin);
                self.submit(now, job, Send::Bytes(id));
            }
            ToLine::Withdraw(id) => {
                let found = self.sends.iter().position(|(_, send)| matches!(send, Send::Bytes(other) if *other == id));
                if let Some(at) = found.filter(|&at| self.master.withdraw(self.sends[at].0)) {
                    self.sends.remove(at);
                    console.unsent(now, id, End::Withdrawn);
                }
            }
            ToLine::Settings { line, mode, buffer_bytes } if !self.is_replay() && line.baud > 0 => {
                console.line.buffer_bytes = buffer_bytes.clamp(*BUFFER_BYTES.start(), *BUFFER_BYTES.end());
                (self.connection.line, self.connection.mode) = (line, mode);
                self.master.reconfigure(now, line, mode);
                // A port that has refused the settings before may take these.
                if self.open_fault.take().is_some() && self.master.link_state() == LinkState::Closed {
                    self.master.connect(now);
                }
            }
            ToLine::Poll(wanted) if !self.is_replay() && wanted != self.polling => {
                self.poll(wanted);
                if self.master.link_state() == LinkState::Open {
                    self.progress.link_changed(now, Link::Open);
                }
            }
            ToLine::Unit(unit) if !self.is_replay() => {
                self.connection.unit = UnitId(unit);
                if self.polling {
                    self.poll(true);
                }
            }
            ToLine::ReadOnly(read_only) => self.master.set_read_only(read_only),
            ToLine::Signals { dtr, rts } if self.connection.source != Source::Simulator && !self.is_replay() => {
                let signals = &mut console.line.signals;
                signals.dtr = dtr.or(signals.dtr);
                signals.rts = rts.or(signals.rts);
                self.signal(Signal::Set(dtr, rts));
            }
            ToLine::Break(length_ms) if !self.is_replay() => {
                let length_ms = length_ms.min(LONGEST_BREAK_MS);
                let job = Job::raw(Vec::new(), Some(milliseconds(length_ms))).by(Origin::Console);
                self.submit(now, job, Send::Break(length_ms));
            }
            _ => {}
        }
    }

    /// Lets recorded notes happen.
    fn play(&mut self, notes: Vec<Note>, console: &mut Console) {
        if !self.is_replay() {
            return;
        }
        for Note { at_us, what } in notes {
            let at = Instant::from_micros(at_us);
            self.clock = self.clock.max(at);
            self.master.replay(self.clock, &what);
            if let What::Port(record::Event::Opened(line, mode)) = what {
                (self.connection.line, self.connection.mode) = (line, mode);
            }
            console.note(at, what);
            self.hear_master(self.clock, console);
        }
        self.connection.unit = self.master.polled_unit().unwrap_or(self.connection.unit);
    }

    /// Time has passed; says when the next has.
    pub(super) fn handle_time(&mut self, console: &mut Console) -> Option<Instant> {
        let now = now();
        let mut look = None;
        if console.is_attached() && self.opened && self.connection.source != Source::Simulator {
            if now >= self.looked_at + LOOK_PERIOD {
                self.looked_at = now;
                self.signal(Signal::Look);
            }
            look = Some(self.looked_at + LOOK_PERIOD);
        }
        let mut due = None;
        if !self.is_replay() {
            if self.master.poll_timeout().is_some_and(|due| due <= now) {
                self.master.handle_timeout(now);
                self.drain(console);
            }
            due = self.master.poll_timeout();
        }
        [due, look, self.tell(now)].into_iter().flatten().min()
    }

    /// Carries out what the master wants, and keeps what the console is told of the line. Due after everything else.
    pub(super) fn drain(&mut self, console: &mut Console) {
        let now = now();
        while let Some(order) = self.master.poll_link() {
            if let Some(port) = &self.port {
                match order {
                    LinkOrder::Open(settings) => port.open(settings, console.line.buffer_bytes),
                    LinkOrder::Close => port.close(),
                }
            }
        }
        while let Some(transmit) = self.master.poll_transmit() {
            if !transmit.bytes.is_empty() {
                if let Some(port) = &self.port {
                    port.write(&transmit.bytes);
                }
                console.note(transmit.at, What::Sent { origin: transmit.origin, bytes: transmit.bytes });
            } else if let Some(length_ms) = self.sends.iter().find_map(|(_, send)| match send {
                Send::Break(length_ms) => Some(*length_ms),
                Send::Bytes(_) => None,
            }) {
                self.signal(Signal::Break(length_ms));
                console.note(now, What::Port(record::Event::Break(length_ms)));
            }
        }
        self.hear_master(if self.is_replay() { self.clock } else { now }, console);
        let line = &mut console.line;
        line.replay = self.is_replay();
        // With other settings it is open only when it has them.
        let in_force = self.master.link_state() == LinkState::Open && !self.master.is_reconfiguring();
        line.open = !line.replay && in_force;
        line.port = self.port_state(in_force);
        line.simulated = self.connection.source == Source::Simulator;
        (line.line, line.mode) = (self.connection.line, self.connection.mode);
        line.polling = self.polling && !line.replay;
        if !line.open {
            let Signals { dtr, rts, .. } = line.signals;
            line.signals = Signals { dtr, rts, ..Signals::default() };
        }
        self.tell_line(line.read_only);
    }

    fn hear_master(&mut self, now: Instant, console: &Console) {
        while let Some(event) = self.master.poll_event() {
            match event {
                Event::Link(state) => {
                    let link = self.link(state);
                    self.progress.link_changed(now, link);
                }
                Event::Polled { index, exchange } => self.progress.polled(index, &exchange),
                Event::Done { job, exchange } => {
                    let Some(at) = self.sends.iter().position(|(other, _)| *other == job) else { continue };
                    if let (_, Send::Bytes(id)) = self.sends.remove(at) {
                        console.done(id, Outcome::from(&exchange));
                    }
                }
            }
        }
    }

    /// The window learns what the console has changed.
    fn tell_line(&mut self, read_only: bool) {
        let Connection { line, mode, unit, .. } = self.connection;
        let now = (line, mode, unit, self.polling, read_only);
        if self.told.replace(now) != Some(now) {
            let line = Line { connection: self.connection.clone(), polling: self.polling, read_only };
            scope::post(&ToWindow::Line(line));
        }
    }

    /// Sends the status if it has changed and it is time; says when it will be time.
    fn tell(&mut self, now: Instant) -> Option<Instant> {
        if !self.progress.has_news() {
            return None;
        }
        let due = self.told_at + STATUS_PERIOD;
        if now < due && self.told_at != Instant::ZERO {
            return Some(due);
        }
        self.told_at = now;
        self.post_status();
        None
    }

    fn post_status(&mut self) {
        let clock = if self.is_replay() { self.clock } else { now() };
        scope::post(&ToWindow::Status(self.progress.status(clock, self.master.counters())));
    }

    fn poll(&mut self, wanted: bool) {
        self.polling = wanted;
        if wanted && self.connection.period_ms == 0 {
            self.connection.period_ms = self.usual_period_ms;
        }
        let period = milliseconds(self.connection.period_ms);
        let poll = Poll { unit: self.connection.unit, requests: self.requests.clone(), period };
        self.master.set_poll(now(), wanted.then_some(poll));
    }

    fn submit(&mut self, now: Instant, job: Job, send: Send) {
        let job = self.master.submit(now, job);
        self.sends.push((job, send));
    }

    fn signal(&self, signal: Signal) {
        if let Some(port) = &self.port {
            port.signal(signal);
        }
    }

    fn note_closed(&mut self, console: &mut Console, what: What) {
        if std::mem::take(&mut self.opened) {
            console.note(now(), what);
        }
    }

    fn port_state(&self, in_force: bool) -> PortState {
        match (self.master.link_state(), &self.open_fault) {
            _ if self.is_replay() => PortState::Gone,
            (LinkState::Open, _) if in_force => PortState::Open,
            (LinkState::Open | LinkState::Opening, _) => PortState::Changing,
            (LinkState::Closed, Some(OpenFault::Busy | OpenFault::UnsupportedSettings | OpenFault::Other(_))) => {
                PortState::Refused
            }
            (LinkState::Closed | LinkState::Closing | LinkState::Lost, _) => PortState::Gone,
        }
    }

    fn link(&self, state: LinkState) -> Link {
        match state {
            LinkState::Closed => self.open_fault.clone().map_or(Link::Closed, Link::Failed),
            LinkState::Opening => Link::Opening,
            LinkState::Open => Link::Open,
            LinkState::Lost => Link::Lost,
            LinkState::Closing => Link::Closing,
        }
    }
}

fn milliseconds(count: u32) -> Duration {
    Duration::from_millis(count.into())
}

fn config(profile: Option<&Profile>, line: LineSettings, mode: Mode) -> Config {
    let mut config = Config::new(line, mode);
    if let Some(profile) = profile {
        config.response_timeout = milliseconds(profile.timing.response_timeout_ms);
        config.unit_pause = milliseconds(profile.timing.inter_device_pause_ms);
    }
    config
}

fn make_port(engine: &Rc<Engine>, number: u32, source: Source, profile: &Profile) -> Box<dyn Port> {
    let weak = Rc::downgrade(engine);
    let sink = move |event| {
        if let Some(engine) = weak.upgrade() {
            engine.take(Input::Port(number, event));
        }
    };
    match source {
        Source::Serial(id) => Box::new(WebSerialPort::new(id, sink)),
        Source::Simulator | Source::Replay => Box::new(SimulatedPort::new(profile.clone(), sink)),
    }
}
