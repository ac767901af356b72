//! The worker's surroundings: messages, clock, and a turn of the event loop.

use buslens_analyst::message::{FromAnalyst, ToAnalyst};
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
    #[wasm_bindgen(method, js_name = postMessage)]
    fn post_message(this: &Scope, data: &Array);
    #[wasm_bindgen(method, setter)]
    fn set_onmessage(this: &Scope, listener: &js_sys::Function);

    type Performance;
    #[wasm_bindgen(method)]
    fn now(this: &Performance) -> f64;

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
