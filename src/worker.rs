//! How the window starts a worker. A worker that does not start, or throws what it does not catch, ends the page.

use js_sys::Reflect;
use wasm_bindgen::prelude::*;
use web_sys::{ErrorEvent, MessageEvent, Worker, WorkerOptions, WorkerType};

use crate::crash;

/// Starts the worker whose address stands in the global variable `address`; `hear` is called with each of its messages.
/// `who` names it in a report.
pub(crate) fn start(who: &'static str, address: &str, hear: impl Fn(JsValue) + 'static) -> Option<Worker> {
    let worker = match new_worker(address) {
        Ok(worker) => worker,
        Err(error) => {
            crash::report(&[who, " does not start: ", &crash::words(&error)].concat());
            return None;
        }
    };
    let on_message = Closure::<dyn Fn(MessageEvent)>::new(move |event: MessageEvent| hear(event.data()));
    worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
    on_message.forget();
    let on_error = Closure::<dyn Fn(ErrorEvent)>::new(move |event: ErrorEvent| {
        let place = [" (", &event.filename(), ":", &event.lineno().to_string(), ")"].concat();
        crash::report(&[who, " failed: ", &event.message(), &place].concat());
    });
    worker.set_onerror(Some(on_error.as_ref().unchecked_ref()));
    on_error.forget();
    Some(worker)
}

fn new_worker(address: &str) -> Result<Worker, JsValue> {
    let address = Reflect::get(&js_sys::global(), &address.into())?;
    let address = address.as_string().ok_or_else(|| JsValue::from_str("its address is not set"))?;
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    Worker::new_with_options(&address, &options)
}
