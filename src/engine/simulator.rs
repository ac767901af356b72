//! The simulated line as a port: the same bytes, at the same pace, through the same engine as a real one.

use std::cell::RefCell;
use std::rc::{Rc, Weak};

use buslens_bus::sim::{Device, Line, sensor};
use buslens_codec::line::LineSettings;
use buslens_codec::profile::Profile;

use super::port::{Port, PortEvent, Signal};
use super::scope::{Timer, now};

/// Any number will do; a fixed one makes every demonstration the same.
const SEED: u64 = 0x0B05_1E45;

/// A line with one sensor that has its factory settings.
pub(super) struct SimulatedPort {
    state: Rc<RefCell<State>>,
}

struct State {
    line: Line<Box<dyn Device>>,
    open: bool,
    /// Told at the next turn of the event loop, as a browser does.
    news: Vec<PortEvent>,
    sink: Rc<dyn Fn(PortEvent)>,
    timer: Option<Timer>,
}

impl SimulatedPort {
    /// The sensor is the one that `profile` describes.
    pub(super) fn new(profile: Profile, sink: impl Fn(PortEvent) + 'static) -> Self {
        let line = Line::new([sensor(profile, now())], SEED);
        let state = State { line, open: false, news: Vec::new(), sink: Rc::new(sink), timer: None };
        let state = Rc::new(RefCell::new(state));
        let weak = Rc::downgrade(&state);
        state.borrow_mut().timer = Some(Timer::new(move || turn(&weak)));
        Self { state }
    }
}

impl Port for SimulatedPort {
    fn open(&self, settings: LineSettings, _: u32) {
        let state = &mut *self.state.borrow_mut();
        state.line.handle_settings(now(), settings);
        state.open = true;
        state.tell(PortEvent::Opened);
    }

    fn write(&self, bytes: &[u8]) {
        let state = &mut *self.state.borrow_mut();
        if state.open {
            state.line.handle_bytes(now(), bytes);
            state.set_timer();
        }
    }

    fn close(&self) {
        let state = &mut *self.state.borrow_mut();
        state.open = false;
        state.tell(PortEvent::Closed);
    }

    /// The simulated line has two wires.
    fn signal(&self, _: Signal) {}
}

impl State {
    fn tell(&mut self, event: PortEvent) {
        self.news.push(event);
        self.set_timer();
    }

    fn set_timer(&self) {
        let now = now();
        let due = if self.news.is_empty() { self.line.poll_timeout() } else { Some(now) };
        if let Some(timer) = &self.timer {
            timer.set(now, due);
        }
    }
}

/// Carries the line up to now and tells what has come of it. The sink may give new orders at once.
fn turn(state: &Weak<RefCell<State>>) {
    let Some(state) = state.upgrade() else { return };
    let (sink, news) = {
        let state = &mut *state.borrow_mut();
        state.line.handle_timeout(now());
        let arrived = state.line.poll_transmit();
        let mut news = std::mem::take(&mut state.news);
        if state.open {
            news.extend(arrived.map(PortEvent::Bytes));
        }
        (Rc::clone(&state.sink), news)
    };
    for event in news {
        sink(event);
    }
    state.borrow().set_timer();
}
