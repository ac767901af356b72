//! The window's end of the line to the engine's worker.
//!
//! The worker is a JS handle and stays out of the signals: it lives in this module alone.

use std::cell::RefCell;

use js_sys::{Array, Uint8Array};
use wasm_bindgen::prelude::*;
use web_sys::Worker;

use crate::message::{ToEngine, ToWindow};
use crate::{crash, worker};

thread_local! {
    static WORKER: RefCell<Option<Worker>> = const { RefCell::new(None) };
}

/// Starts the engine; `hear` is called with each of its messages. A fault of the engine ends in the crash page.
pub(crate) fn start(hear: impl Fn(ToWindow) + 'static) {
    let worker = worker::start("the engine's worker", "buslensWorker", move |data| {
        let bytes = data.dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec()).unwrap_or_default();
        match postcard::from_bytes(&bytes) {
            Ok(ToWindow::Panicked(details)) => crash::report(&details),
            Ok(message) => hear(message),
            Err(error) => crash::report(&format!("the engine sent a message that cannot be read: {error}")),
        }
    });
    WORKER.set(worker);
}

/// Sends a wish to the engine.
pub(crate) fn send(message: &ToEngine) {
    let Ok(bytes) = postcard::to_allocvec(message) else { return };
    WORKER.with_borrow(|worker| {
        if let Some(worker) = worker {
            // Bytes can always be posted.
            let _ = worker.post_message(&Array::of1(&Uint8Array::from(bytes.as_slice())));
        }
    });
}

/// The worker for the other program in the window.
pub(crate) fn worker() -> JsValue {
    WORKER.with_borrow(|worker| worker.clone().map_or(JsValue::UNDEFINED, JsValue::from))
}

/// Ends the engine at once, which closes its port.
pub(crate) fn end() {
    WORKER.with(|slot| {
        if let Some(worker) = slot.try_borrow_mut().ok().and_then(|mut slot| slot.take()) {
            worker.terminate();
        }
    });
}
