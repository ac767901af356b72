//! The window's end of the line to the engine's worker.
//!
//! The worker is a JS handle and stays out of the signals: it lives in this module alone.

use std::cell::RefCell;

use js_sys::{Reflect, Uint8Array};
use wasm_bindgen::prelude::*;
use web_sys::{ErrorEvent, MessageEvent, Worker, WorkerOptions, WorkerType};

use crate::crash;
use crate::message::{ToEngine, ToWindow};

thread_local! {
    static WORKER: RefCell<Option<Worker>> = const { RefCell::new(None) };
}

/// Starts the engine; `hear` is called with each of its messages. A fault of the engine ends in the crash page.
pub(crate) fn start(hear: impl Fn(ToWindow) + 'static) {
    let worker = match new_worker() {
        Ok(worker) => worker,
        Err(error) => return crash::show(&["the engine's worker does not start: ", &crash::words(&error)].concat()),
    };
    let on_message = Closure::<dyn Fn(MessageEvent)>::new(move |event: MessageEvent| {
        let bytes = event.data().dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec()).unwrap_or_default();
        match postcard::from_bytes(&bytes) {
            Ok(ToWindow::Panicked(details)) => crash::show(&details),
            Ok(message) => hear(message),
            Err(error) => crash::show(&format!("the engine sent a message that cannot be read: {error}")),
        }
    });
    worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
    on_message.forget();
    let on_error = Closure::<dyn Fn(ErrorEvent)>::new(|event: ErrorEvent| {
        crash::show(&format!(
            "the engine's worker failed: {} ({}:{})",
            event.message(),
            event.filename(),
            event.lineno()
        ));
    });
    worker.set_onerror(Some(on_error.as_ref().unchecked_ref()));
    on_error.forget();
    WORKER.with_borrow_mut(|slot| *slot = Some(worker));
}

/// Sends a wish to the engine.
pub(crate) fn send(message: &ToEngine) {
    let Ok(bytes) = postcard::to_allocvec(message) else { return };
    WORKER.with_borrow(|worker| {
        if let Some(worker) = worker {
            // Bytes can always be posted.
            let _ = worker.post_message(&Uint8Array::from(bytes.as_slice()));
        }
    });
}

/// Ends the engine at once, which closes its port.
pub(crate) fn end() {
    WORKER.with(|slot| {
        if let Some(worker) = slot.try_borrow_mut().ok().and_then(|mut slot| slot.take()) {
            worker.terminate();
        }
    });
}

fn new_worker() -> Result<Worker, JsValue> {
    let address = Reflect::get(&js_sys::global(), &"buslensWorker".into())?;
    let address = address.as_string().ok_or_else(|| JsValue::from_str("its address is not set"))?;
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    Worker::new_with_options(&address, &options)
}
