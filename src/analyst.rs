//! The window's ends of the lines to its analysts: one program in two workers, one for each page that lists frames.
//!
//! The workers are JS handles and stay out of the signals: they live in this module alone.

use std::cell::RefCell;

use buslens_analyst::message::{FromAnalyst, ToAnalyst};
use js_sys::{Array, Uint8Array};
use wasm_bindgen::prelude::*;
use web_sys::{MessagePort, Worker};

use crate::{crash, worker};

/// Which analyst.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Analyst {
    /// That of the Decoder page, which reads texts.
    Decoder,
    /// That of the Console page, which keeps the log of the line.
    Console,
}

thread_local! {
    static WORKERS: RefCell<[Option<Worker>; 2]> = const { RefCell::new([None, None]) };
}

impl Analyst {
    /// Starts the worker, if it has not been; `hear` is called with each of its messages and what comes beside it. Whether
    /// it starts now.
    pub(crate) fn start(self, hear: impl Fn(FromAnalyst, JsValue) + 'static) -> bool {
        if WORKERS.with_borrow(|workers| workers[self as usize].is_some()) {
            return false;
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
        WORKERS.with_borrow_mut(|workers| workers[self as usize] = worker);
        true
    }

    /// Sends a wish.
    pub(crate) fn send(self, message: &ToAnalyst) {
        self.send_with(message, &JsValue::UNDEFINED);
    }

    /// Sends a wish with a text or a file of the browser's beside it.
    pub(crate) fn send_with(self, message: &ToAnalyst, beside: &JsValue) {
        self.post(message, beside, &Array::new());
    }

    /// Sends a wish with the end of a channel beside it, which is the worker's from then on.
    pub(crate) fn send_port(self, message: &ToAnalyst, port: &MessagePort) {
        self.post(message, port, &Array::of1(port));
    }

    fn post(self, message: &ToAnalyst, beside: &JsValue, moved: &Array) {
        let Ok(bytes) = postcard::to_allocvec(message) else { return };
        WORKERS.with_borrow(|workers| {
            if let Some(worker) = &workers[self as usize] {
                let parts = Array::of2(&Uint8Array::from(bytes.as_slice()), beside);
                // Bytes, texts, files and ends of channels can always be posted.
                let _ = worker.post_message_with_transfer(&parts, moved);
            }
        });
    }
}
