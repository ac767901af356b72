//! The engine: port and master, in a worker of their own, whose timers run on when the page is hidden.

mod console;
mod context;
pub(crate) mod port;
mod progress;
mod recorder;
mod scope;
mod session;
mod simulator;

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use buslens_analyst::line::ToLine;
use buslens_bus::record::End;
use wasm_bindgen::JsValue;
use wasm_bindgen_futures::spawn_local;

use crate::message::{Link, Status, ToEngine, ToWindow};
use crate::serial;
use console::Console;
use port::PortEvent;
use scope::{Channel, Timer, now};
use session::Session;

/// Runs the engine in this worker.
pub(crate) fn run() {
    std::panic::set_hook(Box::new(|info| scope::post(&ToWindow::Panicked(info.to_string()))));
    let engine = Rc::new_cyclic(|weak: &std::rc::Weak<Engine>| {
        let engine = weak.clone();
        let timer = Timer::new(move || {
            if let Some(engine) = engine.upgrade() {
                engine.take(Input::Time);
            }
        });
        Engine {
            state: RefCell::new(State { session: None, sessions: 0, console: Console::new() }),
            inputs: RefCell::default(),
            timer,
        }
    });
    let from_window = Rc::clone(&engine);
    scope::on_message(move |message, beside| from_window.take(Input::Window(message, beside)));
    let from_ports = Rc::clone(&engine);
    serial::watch(move |plugged| {
        list_ports();
        if plugged {
            from_ports.take(Input::Plugged);
        }
    });
    list_ports();
}

/// What moves the engine. Inputs are taken one after the other: what one of them causes at once waits its turn.
pub(super) enum Input {
    /// From the window, with what came beside it.
    Window(ToEngine, JsValue),
    /// From the console's worker.
    Line(ToLine),
    /// From the port of the session with this number.
    Port(u32, PortEvent),
    /// The timer.
    Time,
    Plugged,
}

pub(super) struct Engine {
    state: RefCell<State>,
    inputs: RefCell<VecDeque<Input>>,
    timer: Timer,
}

struct State {
    session: Option<Session>,
    /// How many there have been: each has a number of its own.
    sessions: u32,
    console: Console,
}

impl Engine {
    pub(super) fn take(self: &Rc<Self>, input: Input) {
        self.inputs.borrow_mut().push_back(input);
        let Ok(mut state) = self.state.try_borrow_mut() else { return };
        loop {
            let Some(input) = self.inputs.borrow_mut().pop_front() else { break };
            self.handle(&mut state, input);
            let State { session, console, .. } = &mut *state;
            if let Some(session) = session {
                session.drain(console);
            }
        }
        let State { session, console, .. } = &mut *state;
        let session_due = session.as_mut().and_then(|session| session.handle_time(console));
        let now = now();
        let due = [session_due, console.tell(now)].into_iter().flatten().min();
        self.timer.set(now, due);
    }

    fn handle(self: &Rc<Self>, state: &mut State, input: Input) {
        let State { session, sessions, console } = state;
        match input {
            Input::Window(ToEngine::PortsChanged, _) => list_ports(),
            Input::Window(ToEngine::Attach, end) => {
                let engine = Rc::clone(self);
                console.attach(now(), Channel::new(end, move |message| engine.take(Input::Line(message))));
            }
            Input::Window(ToEngine::Connect(connection), _) => {
                // The old session's port closes by itself when it is dropped; the new one waits for nothing else.
                end(session, console);
                *sessions += 1;
                match Session::start(self, *sessions, connection, console) {
                    Ok(started) => *session = Some(started),
                    Err(fault) => {
                        scope::post(&ToWindow::Status(Status { link: Link::Failed(fault), ..Status::default() }));
                    }
                }
            }
            Input::Line(ToLine::Replay { profile, line, mode }) => {
                end(session, console);
                *sessions += 1;
                *session = Some(Session::replay(*sessions, profile, line, mode));
            }
            Input::Window(ToEngine::Disconnect, _) => match session {
                Some(connected) if !connected.is_replay() => connected.disconnect(),
                _ => end(session, console),
            },
            Input::Line(ToLine::Clock) => console.tell_clock(now()),
            Input::Line(ToLine::ReplayEnded) => {
                if session.as_ref().is_some_and(Session::is_replay) {
                    end(session, console);
                }
            }
            Input::Window(ToEngine::ReadOnly(read_only), _) | Input::Line(ToLine::ReadOnly(read_only)) => {
                console.line.read_only = read_only;
                if let Some(session) = session {
                    session.set_read_only(read_only);
                }
                scope::post(&ToWindow::ReadOnly(read_only));
            }
            Input::Line(message) => match (session, message) {
                (Some(session), message) => session.handle_line(message, console),
                (None, ToLine::Send { id, .. }) => console.unsent(now(), id, End::NoPort),
                (None, _) => {}
            },
            Input::Port(number, event) => {
                if let Some(session) = session.as_mut().filter(|session| session.number() == number) {
                    session.handle_port(event, console);
                }
            }
            Input::Plugged => {
                if let Some(session) = session {
                    session.handle_plugged();
                }
            }
            // Whatever has happened, it is looked at afterwards what is due.
            Input::Time => {}
        }
    }
}

/// Ends a session. Its notes go before whatever the next one does.
fn end(session: &mut Option<Session>, console: &mut Console) {
    if let Some(session) = session.take() {
        session.end(console);
        console.tell(now());
    }
}

/// Tells the window which ports there are.
fn list_ports() {
    spawn_local(async { scope::post(&ToWindow::Ports(serial::granted().await)) });
}
