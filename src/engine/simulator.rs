//! The simulated line as a port: the same bytes, at the same pace, through the same engine as a real one. The line itself
//! is a program of its own, which is loaded into this worker when it is first opened.
//!
//! The program is a JS handle: it lives in this module alone.

use std::cell::RefCell;
use std::rc::{Rc, Weak};

use buslens_bus::time::Instant;
use buslens_codec::line::LineSettings;
use js_sys::{Promise, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};

use super::port::{Port, PortEvent, Signal};
use super::scope::{Timer, now};
use crate::message::{FromSimulator, OpenFault, ToSimulator};

thread_local! {
    static PROGRAM: RefCell<Option<Program>> = const { RefCell::new(None) };
}

/// A line with one sensor.
pub(super) struct SimulatedPort {
    state: Rc<RefCell<State>>,
}

struct State {
    /// That of the sensor, packed.
    profile: Vec<u8>,
    open: bool,
    /// While the program is being loaded: with what the port shall be open, and how many orders to open it wait for that.
    opening: Option<(LineSettings, usize)>,
    /// When the line has to be looked after.
    due: Option<Instant>,
    /// Told at the next turn of the event loop, as a browser does.
    news: Vec<PortEvent>,
    sink: Rc<dyn Fn(PortEvent)>,
    timer: Option<Timer>,
}

impl SimulatedPort {
    /// The sensor is the one that a packed profile describes. It has its factory settings when it is first used, and
    /// stays what it has become as long as the worker lives.
    pub(super) fn new(profile: Vec<u8>, sink: impl Fn(PortEvent) + 'static) -> Self {
        let sink = Rc::new(sink);
        let state = State { profile, open: false, opening: None, due: None, news: Vec::new(), sink, timer: None };
        let state = Rc::new(RefCell::new(state));
        let weak = Rc::downgrade(&state);
        state.borrow_mut().timer = Some(Timer::new(move || turn(&weak)));
        Self { state }
    }
}

impl Port for SimulatedPort {
    fn open(&self, settings: LineSettings, _: u32) {
        let state = &mut *self.state.borrow_mut();
        if let Some((wanted, orders)) = &mut state.opening {
            *wanted = settings;
            *orders += 1;
        } else if PROGRAM.with_borrow(Option::is_some) {
            state.open(settings, 1);
        } else {
            state.opening = Some((settings, 1));
            let weak = Rc::downgrade(&self.state);
            spawn_local(async move {
                let loaded = load().await;
                if let Some(state) = weak.upgrade() {
                    state.borrow_mut().end_opening(loaded);
                }
            });
        }
    }

    fn write(&self, bytes: &[u8]) {
        let state = &mut *self.state.borrow_mut();
        if state.open {
            state.ask(&ToSimulator::Write(bytes.to_vec()));
            state.set_timer();
        }
    }

    fn close(&self) {
        let state = &mut *self.state.borrow_mut();
        // Every order to open has its answer; nobody waits for the program any more.
        let orders = state.opening.take().map_or(0, |(_, orders)| orders);
        state.news.extend((0..orders).map(|_| PortEvent::Opened));
        state.open = false;
        state.due = None;
        state.tell(PortEvent::Closed, 1);
    }

    /// The simulated line has two wires, and two more that feed its sensor.
    fn signal(&self, signal: Signal) {
        let state = &mut *self.state.borrow_mut();
        if state.open && matches!(signal, Signal::PowerCycle) {
            state.ask(&ToSimulator::PowerCycle);
            state.set_timer();
        }
    }
}

impl State {
    /// The program has come, or not.
    fn end_opening(&mut self, loaded: bool) {
        if let Some((settings, orders)) = self.opening.take() {
            if loaded {
                self.open(settings, orders);
            } else {
                self.tell(PortEvent::OpenFailed(OpenFault::NotLoaded), orders);
            }
        }
    }

    fn open(&mut self, line: LineSettings, orders: usize) {
        self.open = true;
        self.ask(&ToSimulator::Open { profile: self.profile.clone(), line });
        self.tell(PortEvent::Opened, orders);
    }

    /// Says something to the simulator, and keeps what comes of it.
    fn ask(&mut self, message: &ToSimulator) {
        let answer = PROGRAM.with_borrow(|program| {
            let message = Uint8Array::from(postcard::to_allocvec(message).ok()?.as_slice());
            #[allow(clippy::cast_precision_loss)] // exact for centuries
            let answer = program.as_ref()?.hear(now().as_micros() as f64, &message);
            postcard::from_bytes(&answer.to_vec()).ok()
        });
        let FromSimulator { arrived, due_us } = answer.unwrap_or_default();
        if !arrived.is_empty() {
            self.news.push(PortEvent::Bytes(arrived));
        }
        self.due = due_us.map(Instant::from_micros);
    }

    fn tell(&mut self, event: PortEvent, times: usize) {
        self.news.extend(std::iter::repeat_n(event, times));
        self.set_timer();
    }

    fn set_timer(&self) {
        let now = now();
        if let Some(timer) = &self.timer {
            timer.set(now, if self.news.is_empty() { self.due } else { Some(now) });
        }
    }
}

/// Carries the line up to now and tells what has come of it. The sink may give new orders at once.
fn turn(state: &Weak<RefCell<State>>) {
    let Some(state) = state.upgrade() else { return };
    let (sink, news) = {
        let state = &mut *state.borrow_mut();
        if state.open {
            state.ask(&ToSimulator::Time);
        }
        (Rc::clone(&state.sink), std::mem::take(&mut state.news))
    };
    for event in news {
        sink(event);
    }
    state.borrow().set_timer();
}

/// Loads the program; false if it does not come. The next time it is tried again.
async fn load() -> bool {
    let loaded = match import_simulator() {
        Ok(coming) => JsFuture::from(coming).await.ok(),
        Err(_) => None,
    };
    loaded.map(|program| PROGRAM.set(Some(program.unchecked_into()))).is_some()
}

#[wasm_bindgen]
extern "C" {
    /// Imports the program, once; the worker's script knows where it is.
    #[wasm_bindgen(catch, js_name = buslensSimulator)]
    fn import_simulator() -> Result<Promise, JsValue>;

    type Program;
    /// A program that fails throws what nothing here catches: it ends the worker.
    #[wasm_bindgen(method)]
    fn hear(this: &Program, now_us: f64, message: &Uint8Array) -> Uint8Array;
}
