//! The worker's surroundings: clock, timers and the way to the window.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use buslens_analyst::line::{FromLine, ToLine};
use buslens_bus::time::Instant;
use js_sys::{Array, Function, Uint8Array};
use serde::de::DeserializeOwned;
use wasm_bindgen::prelude::*;

use crate::message::{ToEngine, ToWindow};

/// The time since the worker started.
pub(super) fn now() -> Instant {
    // Monotonic and never negative; an f64 holds centuries of microseconds exactly.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    Instant::from_micros((scope().performance().now() * 1000.0) as u64)
}

/// Sends a message to the window.
pub(crate) fn post(message: &ToWindow) {
    if let Ok(bytes) = postcard::to_allocvec(message) {
        scope().post_message(&Uint8Array::from(bytes.as_slice()));
    }
}

/// Calls back for every message from the window, with what came beside it, for as long as the worker lives.
pub(super) fn on_message(handle: impl Fn(ToEngine, JsValue) + 'static) {
    scope().set_onmessage(&listener(move |data| {
        let parts: Array = data.unchecked_into();
        if let Some(message) = read(&parts.get(0)) {
            handle(message, parts.get(1));
        }
    }));
}

/// The channel to the console's worker.
pub(super) struct Channel(MessagePort);

impl Channel {
    /// Takes up the end that came beside a message; `handle` is called with each message.
    pub(super) fn new(end: JsValue, handle: impl Fn(ToLine) + 'static) -> Self {
        let port: MessagePort = end.unchecked_into();
        port.set_onmessage(&listener(move |data| {
            if let Some(message) = read(&data) {
                handle(message);
            }
        }));
        Self(port)
    }

    /// Sends a message.
    pub(super) fn post(&self, message: &FromLine) {
        if let Ok(bytes) = postcard::to_allocvec(message) {
            self.0.post_message(&Uint8Array::from(bytes.as_slice()));
        }
    }
}

/// A function that hands on what an event carries. It lives as long as the worker: consoles come once a visit.
fn listener(handle: impl Fn(JsValue) + 'static) -> Function {
    Closure::<dyn Fn(MessageEvent)>::new(move |event: MessageEvent| handle(event.data()))
        .into_js_value()
        .unchecked_into()
}

fn read<T: DeserializeOwned>(data: &JsValue) -> Option<T> {
    postcard::from_bytes(&data.dyn_ref::<Uint8Array>()?.to_vec()).ok()
}

/// Holds a Web Lock for as long as it lives: the browser does not freeze a page that holds one.
pub(super) struct Awake {
    release: Rc<RefCell<Option<Function>>>,
}

impl Awake {
    pub(super) fn new() -> Self {
        let release = Rc::new(RefCell::new(None));
        let kept = Rc::clone(&release);
        let held = js_sys::Promise::new(&mut |resolve, _| *kept.borrow_mut() = Some(resolve));
        if let Some(locks) = scope().navigator().locks() {
            let keep = Closure::once_into_js(move || held);
            let options = js_sys::Object::new();
            // A plain object takes any property.
            let _ = js_sys::Reflect::set(&options, &"mode".into(), &"shared".into());
            locks.request("buslens-connected", &options, keep.unchecked_ref());
        }
        Self { release }
    }
}

impl Drop for Awake {
    fn drop(&mut self) {
        if let Some(release) = self.release.borrow_mut().take() {
            // Resolving a promise does not throw.
            let _ = release.call0(&JsValue::UNDEFINED);
        }
    }
}

/// One timer that can be set again and again; only the last setting counts.
pub(super) struct Timer {
    callback: Closure<dyn FnMut()>,
    handle: Rc<Cell<Option<i32>>>,
    due: Cell<Option<Instant>>,
}

impl Timer {
    pub(super) fn new(mut callback: impl FnMut() + 'static) -> Self {
        let handle = Rc::new(Cell::new(None));
        let fired = Rc::clone(&handle);
        let callback = Closure::new(move || {
            fired.set(None);
            callback();
        });
        Self { callback, handle, due: Cell::new(None) }
    }

    /// Fires at `due`, or never.
    pub(super) fn set(&self, now: Instant, due: Option<Instant>) {
        if self.handle.get().is_some() && self.due.get() == due {
            return;
        }
        if let Some(handle) = self.handle.take() {
            scope().clear_timeout(handle);
        }
        self.due.set(due);
        if let Some(due) = due {
            // Rounded up: a timer that fires early would only be set again.
            let milliseconds = due.saturating_since(now).as_micros().div_ceil(1000);
            let milliseconds = i32::try_from(milliseconds).unwrap_or(i32::MAX);
            self.handle.set(Some(scope().set_timeout(self.callback.as_ref().unchecked_ref(), milliseconds)));
        }
    }
}

impl Drop for Timer {
    fn drop(&mut self) {
        if let Some(handle) = self.handle.take() {
            scope().clear_timeout(handle);
        }
    }
}

fn scope() -> Scope {
    js_sys::global().unchecked_into()
}

#[wasm_bindgen]
extern "C" {
    type Scope;
    #[wasm_bindgen(method, getter)]
    fn performance(this: &Scope) -> Performance;
    #[wasm_bindgen(method, getter)]
    fn navigator(this: &Scope) -> Navigator;
    #[wasm_bindgen(method, js_name = setTimeout)]
    fn set_timeout(this: &Scope, callback: &Function, milliseconds: i32) -> i32;
    #[wasm_bindgen(method, js_name = clearTimeout)]
    fn clear_timeout(this: &Scope, handle: i32);
    #[wasm_bindgen(method, js_name = postMessage)]
    fn post_message(this: &Scope, data: &Uint8Array);
    #[wasm_bindgen(method, setter)]
    fn set_onmessage(this: &Scope, listener: &Function);

    type MessagePort;
    #[wasm_bindgen(method, js_name = postMessage)]
    fn post_message(this: &MessagePort, data: &Uint8Array);
    #[wasm_bindgen(method, setter)]
    fn set_onmessage(this: &MessagePort, listener: &Function);

    type Performance;
    #[wasm_bindgen(method)]
    fn now(this: &Performance) -> f64;

    type Navigator;
    #[wasm_bindgen(method, getter)]
    fn locks(this: &Navigator) -> Option<Locks>;

    type Locks;
    #[wasm_bindgen(method)]
    fn request(this: &Locks, name: &str, options: &js_sys::Object, hold: &Function);

    type MessageEvent;
    #[wasm_bindgen(method, getter)]
    fn data(this: &MessageEvent) -> JsValue;
}
