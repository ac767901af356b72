//! One connection from [`ToEngine::Connect`](crate::message::ToEngine) on: drives the master and the port, and tells the
//! window.

use std::rc::Rc;
use std::time::Duration;

use buslens_bus::time::Instant;
use buslens_bus::{Config, Event, LinkEvent, LinkOrder, LinkState, Master, Poll};
use buslens_codec::profile::{Group, Profile};

use super::port::{Port, PortEvent};
use super::progress::Progress;
use super::scope::{self, Awake, Timer, now};
use super::simulator::SimulatedPort;
use super::{Engine, Input};
use crate::message::{Connection, Link, OpenFault, Source, ToWindow};
use crate::serial::WebSerialPort;

/// Nobody reads faster: more statuses a second would only cost.
const STATUS_PERIOD: Duration = Duration::from_millis(50);

pub(super) struct Session {
    number: u32,
    master: Master,
    port: Box<dyn Port>,
    progress: Progress,
    timer: Timer,
    open_fault: Option<OpenFault>,
    told_at: Instant,
    _awake: Awake,
}

impl Session {
    /// Starts to open the port. A profile that does not load is refused.
    pub(super) fn start(engine: &Rc<Engine>, number: u32, connection: &Connection) -> Result<Self, OpenFault> {
        let port = make_port(engine, number, connection)?;
        let profile = load_profile(connection)?;
        let groups = profile.live_groups();
        let mut master = Master::new(Config {
            response_timeout: Duration::from_millis(profile.timing.response_timeout_ms.into()),
            unit_pause: Duration::from_millis(profile.timing.inter_device_pause_ms.into()),
            ..Config::new(connection.line, connection.mode)
        });
        let period = Duration::from_millis(connection.period_ms.into());
        let requests = groups.iter().filter_map(Group::request).collect();
        let now = now();
        master.set_poll(now, Some(Poll { unit: connection.unit, requests, period }));
        master.connect(now);
        let from_timer = Rc::downgrade(engine);
        let mut session = Self {
            number,
            master,
            port,
            progress: Progress::new(profile, period),
            timer: Timer::new(move || {
                if let Some(engine) = from_timer.upgrade() {
                    engine.take(Input::Time);
                }
            }),
            open_fault: None,
            told_at: Instant::ZERO,
            _awake: Awake::new(),
        };
        session.drain();
        Ok(session)
    }

    pub(super) fn number(&self) -> u32 {
        self.number
    }

    pub(super) fn disconnect(&mut self) {
        self.master.disconnect(now());
        self.drain();
    }

    pub(super) fn handle_port(&mut self, event: PortEvent) {
        let now = now();
        match event {
            PortEvent::Bytes(bytes) => self.master.handle_bytes(now, &bytes),
            PortEvent::Opened => self.master.handle_link(now, LinkEvent::Opened),
            PortEvent::Closed => self.master.handle_link(now, LinkEvent::Closed),
            PortEvent::Lost => self.master.handle_link(now, LinkEvent::Lost),
            PortEvent::LineError => self.master.handle_link(now, LinkEvent::LineError),
            PortEvent::OpenFailed(fault) => {
                self.open_fault = Some(fault);
                self.master.handle_link(now, LinkEvent::OpenFailed);
            }
        }
        self.drain();
    }

    pub(super) fn handle_plugged(&mut self) {
        self.master.handle_link(now(), LinkEvent::Plugged);
        self.drain();
    }

    pub(super) fn handle_time(&mut self) {
        self.master.handle_timeout(now());
        self.drain();
    }

    /// Carries out what the master wants, tells the window, and sets the timer.
    fn drain(&mut self) {
        let now = now();
        while let Some(order) = self.master.poll_link() {
            match order {
                LinkOrder::Open(settings) => self.port.open(settings),
                LinkOrder::Close => self.port.close(),
            }
        }
        while let Some(transmit) = self.master.poll_transmit() {
            self.port.write(&transmit.bytes);
        }
        while let Some(event) = self.master.poll_event() {
            match event {
                Event::Link(state) => {
                    let link = self.link(state);
                    self.progress.link_changed(now, link);
                }
                Event::Polled { index, exchange } => self.progress.polled(index, &exchange),
                Event::Done { .. } => {}
            }
        }
        let told = self.tell(now);
        let due = [self.master.poll_timeout(), told].into_iter().flatten().min();
        self.timer.set(now, due);
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
        scope::post(&ToWindow::Status(self.progress.status(now, self.master.counters())));
        None
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

fn load_profile(connection: &Connection) -> Result<Profile, OpenFault> {
    Profile::unpack(&connection.profile).ok_or_else(|| OpenFault::Other("the profile cannot be read".to_owned()))
}

fn make_port(engine: &Rc<Engine>, number: u32, connection: &Connection) -> Result<Box<dyn Port>, OpenFault> {
    let weak = Rc::downgrade(engine);
    let sink = move |event| {
        if let Some(engine) = weak.upgrade() {
            engine.take(Input::Port(number, event));
        }
    };
    Ok(match connection.source {
        Source::Simulator => Box::new(SimulatedPort::new(load_profile(connection)?, sink)),
        Source::Serial(id) => Box::new(WebSerialPort::new(id, sink)),
    })
}
