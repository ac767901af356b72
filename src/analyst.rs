//! The window's end of the line to the analyst's worker, which starts with the first thing that is said to it.
//!
//! The worker is a JS handle and stays out of the signals: it lives in this module alone.

use std::cell::RefCell;

use buslens_analyst::message::{FromAnalyst, ToAnalyst};
use js_sys::{Array, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;
use web_sys::{ErrorEvent, MessageEvent, Worker, WorkerOptions, WorkerType};

use crate::crash;

thread_local! {
    static WORKER: RefCell<Option<Worker>> = const { RefCell::new(None) };
}

/// Starts the worker, if it has not been; `hear` is called with each of its messages and what comes beside it.
pub(crate) fn start(hear: impl Fn(FromAnalyst, JsValue) + 'static) {
    if WORKER.with_borrow(Option::is_some) {
        return;
    }
    let worker = match new_worker() {
        Ok(worker) => worker,
        Err(error) => return crash::report(&["the analyst's worker does not start: ", &crash::words(&error)].concat()),
    };
    let on_message = Closure::<dyn Fn(MessageEvent)>::new(move |event: MessageEvent| {
        let parts: Array = event.data().unchecked_into();
        let bytes = parts.get(0).dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec()).unwrap_or_default();
        match postcard::from_bytes(&bytes) {
            Ok(FromAnalyst::Panicked(details)) => crash::report(&details),
            Ok(message) => hear(message, parts.get(1)),
            Err(error) => crash::report(&format!("the analyst sent a message that cannot be read: {error}")),
        }
    });
    worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
    on_message.forget();
    let on_error = Closure::<dyn Fn(ErrorEvent)>::new(|event: ErrorEvent| {
        crash::report(&["the analyst's worker failed: ", &event.message()].concat());
    });
    worker.set_onerror(Some(on_error.as_ref().unchecked_ref()));
    on_error.forget();
    WORKER.with_borrow_mut(|slot| *slot = Some(worker));
}

/// Sends a wish.
pub(crate) fn send(message: &ToAnalyst) {
    send_with(message, &JsValue::UNDEFINED);
}

/// Sends a wish with a text or a file of the browser's beside it.
pub(crate) fn send_with(message: &ToAnalyst, beside: &JsValue) {
    let Ok(bytes) = postcard::to_allocvec(message) else { return };
    WORKER.with_borrow(|worker| {
        if let Some(worker) = worker {
            // Bytes, texts and files can always be posted.
            let _ = worker.post_message(&Array::of2(&Uint8Array::from(bytes.as_slice()), beside));
        }
    });
}

fn new_worker() -> Result<Worker, JsValue> {
    let address = Reflect::get(&js_sys::global(), &"buslensAnalyst".into())?;
    let address = address.as_string().ok_or_else(|| JsValue::from_str("its address is not set"))?;
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    Worker::new_with_options(&address, &options)
}
