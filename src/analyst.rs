//! The window's end of the line to the analyst's worker, which starts with the first thing that is said to it.
//!
//! The worker is a JS handle and stays out of the signals: it lives in this module alone.

use std::cell::RefCell;

use buslens_analyst::message::{FromAnalyst, ToAnalyst};
use js_sys::{Array, Uint8Array};
use wasm_bindgen::prelude::*;
use web_sys::Worker;

use crate::{crash, worker};

thread_local! {
    static WORKER: RefCell<Option<Worker>> = const { RefCell::new(None) };
}

/// Starts the worker, if it has not been; `hear` is called with each of its messages and what comes beside it.
pub(crate) fn start(hear: impl Fn(FromAnalyst, JsValue) + 'static) {
    if WORKER.with_borrow(Option::is_some) {
        return;
    }
    let worker = worker::start("the analyst's worker", "buslensAnalyst", move |data| {
        let parts: Array = data.unchecked_into();
        let bytes = parts.get(0).dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec()).unwrap_or_default();
        match postcard::from_bytes(&bytes) {
            Ok(FromAnalyst::Panicked(details)) => crash::report(&details),
            Ok(message) => hear(message, parts.get(1)),
            Err(error) => crash::report(&format!("the analyst sent a message that cannot be read: {error}")),
        }
    });
    WORKER.set(worker);
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
