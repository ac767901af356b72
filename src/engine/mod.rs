//! The engine: port and master, in a worker of their own, whose timers run on when the page is hidden.

pub(crate) mod port;
mod progress;
mod scope;
mod session;
mod simulator;

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use wasm_bindgen_futures::spawn_local;

use crate::message::{Link, Status, ToEngine, ToWindow};
use crate::serial;
use port::PortEvent;
use session::Session;

/// Runs the engine in this worker.
pub(crate) fn run() {
    std::panic::set_hook(Box::new(|info| scope::post(&ToWindow::Panicked(info.to_string()))));
    let engine = Rc::new(Engine { session: RefCell::new(None), inputs: RefCell::default() });
    let from_window = Rc::clone(&engine);
    scope::on_message(move |message| from_window.take(Input::Window(message)));
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
    Window(ToEngine),
    /// From the port of the session with this number.
    Port(u32, PortEvent),
    /// The session's timer.
    Time,
    Plugged,
}

pub(super) struct Engine {
    session: RefCell<Option<Session>>,
    inputs: RefCell<VecDeque<Input>>,
}

impl Engine {
    pub(super) fn take(self: &Rc<Self>, input: Input) {
        self.inputs.borrow_mut().push_back(input);
        let Ok(mut session) = self.session.try_borrow_mut() else { return };
        loop {
            let Some(input) = self.inputs.borrow_mut().pop_front() else { return };
            self.handle(&mut session, input);
        }
    }

    fn handle(self: &Rc<Self>, slot: &mut Option<Session>, input: Input) {
        match input {
            Input::Window(ToEngine::PortsChanged) => list_ports(),
            Input::Window(ToEngine::Attach) => {}
            Input::Window(ToEngine::Connect(connection)) => {
                // The old session's port closes by itself when it is dropped; the new one waits for nothing else.
                let number = slot.take().map_or(0, |old| old.number() + 1);
                match Session::start(self, number, &connection) {
                    Ok(session) => *slot = Some(session),
                    Err(fault) => {
                        scope::post(&ToWindow::Status(Status { link: Link::Failed(fault), ..Status::default() }));
                    }
                }
            }
            Input::Window(ToEngine::Disconnect) => {
                if let Some(session) = slot {
                    session.disconnect();
                }
            }
            Input::Port(number, event) => {
                if let Some(session) = slot.as_mut().filter(|session| session.number() == number) {
                    session.handle_port(event);
                }
            }
            Input::Plugged => {
                if let Some(session) = slot {
                    session.handle_plugged();
                }
            }
            Input::Time => {
                if let Some(session) = slot {
                    session.handle_time();
                }
            }
        }
    }
}

/// Tells the window which ports there are.
fn list_ports() {
    spawn_local(async { scope::post(&ToWindow::Ports(serial::granted().await)) });
}
