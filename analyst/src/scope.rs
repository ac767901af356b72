//! The worker's surroundings: messages, clock, timer, and a turn of the event loop.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use buslens_analyst::line::{FromLine, ToLine};
use buslens_analyst::message::{FromAnalyst, ToAnalyst};
use buslens_bus::time::Instant;
use js_sys::{Array, Object, Promise, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

/// Sends a message to the window.
pub(crate) fn post(message: &FromAnalyst) {
    post_with(message, &JsValue::UNDEFINED);
}

/// Sends a message with an object of the browser beside it.
pub(crate) fn post_with(message: &FromAnalyst, beside: &JsValue) {
    if let Ok(bytes) = postcard::to_allocvec(message) {
        scope().post_message(&Array::of(&[Uint8Array::from(bytes.as_slice()).into(), beside.clone()]));
    }
}

/// Calls back for every message from the window, with what came beside it, for as long as the worker lives.
pub(crate) fn on_message(handle: impl Fn(ToAnalyst, JsValue) + 'static) {
    let listener = Closure::<dyn Fn(MessageEvent)>::new(move |event: MessageEvent| {
        let parts = event.data();
        let bytes = parts.get(0).dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec()).unwrap_or_default();
        if let Ok(message) = postcard::from_bytes(&bytes) {
            handle(message, parts.get(1));
        }
    });
    scope().set_onmessage(listener.as_ref().unchecked_ref());
    listener.forget();
}

/// Milliseconds since the worker started.
pub(crate) fn milliseconds() -> f64 {
    scope().performance().now()
}

/// The time since the worker started.
pub(crate) fn now() -> Instant {
    // Monotonic and never negative; an f64 holds centuries of microseconds exactly.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    Instant::from_micros((milliseconds() * 1000.0) as u64)
}

/// The time since the beginning of 1970, in microseconds.
pub(crate) fn unix_us() -> u64 {
    // As above.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let micros = ((scope().performance().time_origin() + milliseconds()) * 1000.0) as u64;
    micros
}

/// The channel to the engine.
pub(crate) struct Line {
    port: MessagePort,
    /// Is called for as long as the channel is held.
    _listener: Closure<dyn Fn(MessageEvent)>,
}

impl Line {
    /// Takes up the channel whose end came beside a message; `hear` is called with each message of the engine.
    pub(crate) fn attach(end: JsValue, hear: impl Fn(FromLine) + 'static) -> Self {
        let listener = Closure::<dyn Fn(MessageEvent)>::new(move |event: MessageEvent| {
            let bytes = JsValue::from(event.data()).dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec());
            if let Ok(message) = postcard::from_bytes(&bytes.unwrap_or_default()) {
                hear(message);
            }
        });
        let port: MessagePort = end.unchecked_into();
        port.set_onmessage(listener.as_ref().unchecked_ref());
        Self { port, _listener: listener }
    }

    /// Sends a message to the engine.
    pub(crate) fn post(&self, message: &ToLine) {
        if let Ok(bytes) = postcard::to_allocvec(message) {
            self.port.post_message(&Uint8Array::from(bytes.as_slice()));
        }
    }
}

/// One timer that can be set again and again; only the last setting counts.
pub(crate) struct Timer {
    callback: RefCell<Option<Closure<dyn FnMut()>>>,
    handle: Rc<Cell<Option<i32>>>,
    due: Cell<Option<Instant>>,
}

impl Timer {
    pub(crate) fn new() -> Self {
        Self { callback: RefCell::new(None), handle: Rc::new(Cell::new(None)), due: Cell::new(None) }
    }

    /// Calls this whenever the timer fires.
    pub(crate) fn on_time(&self, callback: impl Fn() + 'static) {
        let fired = Rc::clone(&self.handle);
        *self.callback.borrow_mut() = Some(Closure::new(move || {
            fired.set(None);
            callback();
        }));
    }

    /// Fires at `due`, or never.
    pub(crate) fn set(&self, now: Instant, due: Option<Instant>) {
        if self.handle.get().is_some() && self.due.get() == due {
            return;
        }
        if let Some(handle) = self.handle.take() {
            scope().clear_timeout(handle);
        }
        self.due.set(due);
        if let (Some(due), Some(callback)) = (due, &*self.callback.borrow()) {
            // Rounded up: a timer that fires early would only be set again.
            let milliseconds = due.saturating_since(now).as_micros().div_ceil(1000);
            let milliseconds = i32::try_from(milliseconds).unwrap_or(i32::MAX);
            self.handle.set(Some(scope().set_timeout(callback.as_ref().unchecked_ref(), milliseconds)));
        }
    }
}

/// Lets whatever waits in the event loop have its turn. A timer would cost 4 ms each time.
pub(crate) async fn turn() {
    let channel = MessageChannel::new();
    let (here, there) = (channel.port1(), channel.port2());
    let turned = Promise::new(&mut |resolve, _| here.set_onmessage(&resolve));
    there.post_message(&JsValue::NULL);
    let _ = JsFuture::from(turned).await;
    here.close();
}

/// A file of texts.
pub(crate) fn blob(parts: &Array, kind: &str) -> JsValue {
    Blob::new(parts, &options("type", &kind.into())).into()
}

/// An object with one property.
pub(crate) fn options(key: &str, value: &JsValue) -> Object {
    let options = Object::new();
    // A plain object takes any property.
    let _ = Reflect::set(&options, &key.into(), value);
    options
}

/// The folder in which the browser keeps files of this page, where there is one.
pub(crate) fn storage() -> Option<StorageManager> {
    scope().navigator().storage()
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
    fn set_timeout(this: &Scope, callback: &js_sys::Function, milliseconds: i32) -> i32;
    #[wasm_bindgen(method, js_name = clearTimeout)]
    fn clear_timeout(this: &Scope, handle: i32);
    #[wasm_bindgen(method, js_name = postMessage)]
    fn post_message(this: &Scope, data: &Array);
    #[wasm_bindgen(method, setter)]
    fn set_onmessage(this: &Scope, listener: &js_sys::Function);

    type Performance;
    #[wasm_bindgen(method)]
    fn now(this: &Performance) -> f64;
    #[wasm_bindgen(method, getter, js_name = timeOrigin)]
    fn time_origin(this: &Performance) -> f64;

    type Navigator;
    #[wasm_bindgen(method, getter)]
    fn storage(this: &Navigator) -> Option<StorageManager>;

    pub(crate) type StorageManager;
    #[wasm_bindgen(method, catch, js_name = getDirectory)]
    pub(crate) fn directory(this: &StorageManager) -> Result<Promise, JsValue>;

    type MessageEvent;
    #[wasm_bindgen(method, getter)]
    fn data(this: &MessageEvent) -> Array;

    type MessageChannel;
    #[wasm_bindgen(constructor)]
    fn new() -> MessageChannel;
    #[wasm_bindgen(method, getter)]
    fn port1(this: &MessageChannel) -> MessagePort;
    #[wasm_bindgen(method, getter)]
    fn port2(this: &MessageChannel) -> MessagePort;

    type MessagePort;
    #[wasm_bindgen(method, js_name = postMessage)]
    fn post_message(this: &MessagePort, data: &JsValue);
    #[wasm_bindgen(method, setter)]
    fn set_onmessage(this: &MessagePort, listener: &js_sys::Function);
    #[wasm_bindgen(method)]
    fn close(this: &MessagePort);

    pub(crate) type Blob;
    #[wasm_bindgen(constructor)]
    fn new(parts: &Array, options: &Object) -> Blob;
    #[wasm_bindgen(method, getter)]
    pub(crate) fn size(this: &Blob) -> f64;
    #[wasm_bindgen(method)]
    pub(crate) fn slice(this: &Blob, from: f64, to: f64) -> Blob;
    #[wasm_bindgen(method, js_name = arrayBuffer)]
    pub(crate) fn array_buffer(this: &Blob) -> Promise;

    /// The browser's decoder of texts: it knows the encodings that Chinese tools write.
    pub(crate) type TextDecoder;
    #[wasm_bindgen(constructor)]
    pub(crate) fn new(encoding: &str) -> TextDecoder;
    #[wasm_bindgen(method)]
    pub(crate) fn decode(this: &TextDecoder, bytes: &Uint8Array, options: &Object) -> String;
}
