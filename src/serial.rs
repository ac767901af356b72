//! The browser's serial ports: the only file that knows Web Serial.
//!
//! web-sys types `readable` and `writable` as never null; the specification makes them nullable, so the few externs
//! here are our own. The window asks for permission ([`request_port`]); the worker opens ([`WebSerialPort`]).

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use buslens_codec::line::{DataBits, LineSettings, Parity, StopBits};
use futures_channel::{mpsc, oneshot};
use futures_util::StreamExt;
use futures_util::future::{Either, select};
use js_sys::{Array, Object, Promise, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};

use crate::crash;
use crate::engine::port::{Port, PortEvent, Signal};
use crate::message::{OpenFault, PortId};

/// A dead adapter never settles a promise: no step of closing waits longer than this, in milliseconds.
const STEP_MS: i32 = 1000;

/// Why this page has no serial ports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SerialMissing {
    /// The page did not come over https or from localhost.
    InsecurePage,
    /// The page stands in a frame that was not given the permission.
    PermissionPolicy,
    /// The browser has no Web Serial.
    Unsupported,
}

/// Why the picker brought no port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum PickFault {
    /// The user closed it, perhaps because the port was not listed.
    Cancelled,
    /// There are no serial ports here at all.
    Missing(SerialMissing),
    /// Anything else, in the browser's own words.
    Other(String),
}

/// Why serial ports are missing, or `None` where they are there.
pub(crate) fn missing() -> Option<SerialMissing> {
    if serial().is_some() {
        return None;
    }
    Some(if scope().is_secure_context() == Some(false) {
        SerialMissing::InsecurePage
    } else {
        SerialMissing::Unsupported
    })
}

/// Shows the browser's picker. Needs a window and a user's click.
pub(crate) async fn request_port() -> Result<PortId, PickFault> {
    let serial = serial().ok_or_else(|| PickFault::Missing(missing().unwrap_or(SerialMissing::Unsupported)))?;
    let picked = async { JsFuture::from(serial.request_port()?).await }.await.map_err(|error| {
        match error_name(&error).as_str() {
            "NotFoundError" => PickFault::Cancelled,
            "SecurityError" => PickFault::Missing(SerialMissing::PermissionPolicy),
            _ => PickFault::Other(error_message(&error)),
        }
    })?;
    let ports = granted_ports().await;
    let index = ports.iter().position(|port| Object::is(port, &picked)).unwrap_or(0);
    Ok(port_id(index, picked.unchecked_ref()))
}

/// The granted ports that are plugged in.
pub(crate) async fn granted() -> Vec<PortId> {
    granted_ports().await.iter().enumerate().map(|(index, port)| port_id(index, port)).collect()
}

/// Calls back when a granted port is plugged in (`true`) or unplugged (`false`), for as long as the worker lives.
pub(crate) fn watch(changed: impl Fn(bool) + 'static) {
    let Some(serial) = serial() else { return };
    let changed = Rc::new(changed);
    for (event, plugged) in [("connect", true), ("disconnect", false)] {
        let changed = Rc::clone(&changed);
        let listener = Closure::<dyn Fn()>::new(move || changed(plugged));
        serial.add_event_listener(event, listener.as_ref().unchecked_ref());
        listener.forget();
    }
}

/// One real port. All orders go through one queue, because `open` and `close` must never overlap.
pub(crate) struct WebSerialPort {
    orders: mpsc::UnboundedSender<Order>,
}

enum Order {
    Open(LineSettings, u32),
    Write(Vec<u8>),
    Signal(Signal),
    Close,
}

impl WebSerialPort {
    /// The port `id`, not opened yet. Events go to `sink` until the port is dropped.
    pub(crate) fn new(id: PortId, sink: impl Fn(PortEvent) + 'static) -> Self {
        let (orders, queue) = mpsc::unbounded();
        spawn_local(serve(id, queue, Rc::new(sink)));
        Self { orders }
    }

    fn order(&self, order: Order) {
        // The receiver lives as long as this sender.
        let _ = self.orders.unbounded_send(order);
    }
}

impl Port for WebSerialPort {
    fn open(&self, settings: LineSettings, buffer_bytes: u32) {
        self.order(Order::Open(settings, buffer_bytes));
    }

    fn write(&self, bytes: &[u8]) {
        self.order(Order::Write(bytes.to_vec()));
    }

    fn close(&self) {
        self.order(Order::Close);
    }

    fn signal(&self, signal: Signal) {
        self.order(Order::Signal(signal));
    }
}

type Sink = Rc<dyn Fn(PortEvent)>;

/// Carries out the orders one after the other; a dropped port is closed.
async fn serve(id: PortId, mut queue: mpsc::UnboundedReceiver<Order>, sink: Sink) {
    let mut choice = Choice { id, ours: None, others: Vec::new() };
    let mut session: Option<Session> = None;
    while let Some(order) = queue.next().await {
        match order {
            Order::Open(settings, buffer_bytes) => {
                if let Some(open) = session.take() {
                    open.close().await;
                }
                match open(&mut choice, &open_options(settings, buffer_bytes), &sink).await {
                    Ok(open) => {
                        session = Some(open);
                        sink(PortEvent::Opened);
                    }
                    Err(fault) => sink(PortEvent::OpenFailed(fault)),
                }
            }
            Order::Write(bytes) => {
                if let Some(open) = &session {
                    open.write(&bytes);
                }
            }
            Order::Signal(signal) => {
                if let Some(open) = &session {
                    open.signal(signal).await;
                }
            }
            Order::Close => {
                if let Some(open) = session.take() {
                    open.close().await;
                }
                sink(PortEvent::Closed);
            }
        }
    }
    if let Some(open) = session {
        open.close().await;
    }
}

/// Which of the granted ports is ours. After a replug the browser makes a new object for the same adapter, so it is
/// known by its USB ids, and by not being one of the twins that were plugged in beside it before.
struct Choice {
    id: PortId,
    ours: Option<SerialPort>,
    others: Vec<SerialPort>,
}

impl Choice {
    async fn find(&mut self) -> Option<SerialPort> {
        let ports = granted_ports().await;
        let same_kind = |port: &SerialPort| port_id(0, port).usb == self.id.usb;
        let same = |a: &SerialPort, b: &SerialPort| Object::is(a, b);
        let found = match &self.ours {
            None => {
                let at_index = ports.get(self.id.index as usize).filter(|port| same_kind(port));
                at_index.or_else(|| ports.iter().find(|port| same_kind(port)))
            }
            Some(ours) => ports.iter().find(|port| same(port, ours)).or_else(|| {
                ports.iter().find(|port| same_kind(port) && !self.others.iter().any(|other| same(port, other)))
            }),
        }?
        .clone();
        self.others = ports.into_iter().filter(|port| !same(port, &found)).collect();
        self.ours = Some(found.clone());
        Some(found)
    }
}

/// An open port with its one permanent read loop.
struct Session {
    port: SerialPort,
    writer: Option<Writer>,
    reader: Rc<RefCell<Option<Reader>>>,
    closing: Rc<Cell<bool>>,
    reading_ended: oneshot::Receiver<()>,
    sink: Sink,
}

async fn open(choice: &mut Choice, options: &Object, sink: &Sink) -> Result<Session, OpenFault> {
    let port = choice.find().await.ok_or(OpenFault::Missing)?;
    let opening = port.open(options).map_err(|error| open_fault(&error))?;
    JsFuture::from(opening).await.map_err(|error| open_fault(&error))?;
    let writer = port.writable().and_then(|writable| writable.writer().ok());
    let reader = Rc::new(RefCell::new(None));
    let closing = Rc::new(Cell::new(false));
    let (ended, reading_ended) = oneshot::channel();
    {
        let (port, reader, closing, sink) = (port.clone(), Rc::clone(&reader), Rc::clone(&closing), Rc::clone(sink));
        spawn_local(async move {
            read(&port, &reader, &closing, &sink).await;
            let _ = ended.send(());
        });
    }
    Ok(Session { port, writer, reader, closing, reading_ended, sink: Rc::clone(sink) })
}

impl Session {
    /// Hands bytes to the browser. A write that fails means a port that is gone, unless it is being closed.
    fn write(&self, bytes: &[u8]) {
        let Some(writer) = &self.writer else {
            (self.sink)(PortEvent::Lost);
            return;
        };
        let writing = JsFuture::from(writer.write(&Uint8Array::from(bytes)));
        let (closing, sink) = (Rc::clone(&self.closing), Rc::clone(&self.sink));
        spawn_local(async move {
            if writing.await.is_err() && !closing.get() {
                sink(PortEvent::Lost);
            }
        });
    }

    /// An adapter without these wires, or a driver that refuses, is left as it is.
    async fn signal(&self, signal: Signal) {
        match signal {
            Signal::Set(dtr, rts) => {
                self.set(&[("dataTerminalReady", dtr), ("requestToSend", rts)]).await;
            }
            Signal::Break(milliseconds) => {
                self.set(&[("break", Some(true))]).await;
                let _ = JsFuture::from(sleep(i32::try_from(milliseconds).unwrap_or(i32::MAX))).await;
                self.set(&[("break", Some(false))]).await;
            }
            // An adapter feeds nobody.
            Signal::PowerCycle => {}
            Signal::Look => {
                let Ok(looking) = self.port.signals() else { return };
                let sink = Rc::clone(&self.sink);
                // What is written meanwhile does not wait.
                spawn_local(async move {
                    if let Ok(found) = JsFuture::from(looking).await {
                        let inputs = ["clearToSend", "dataSetReady", "dataCarrierDetect", "ringIndicator"];
                        let is_on = |key: &str| Reflect::get(&found, &key.into()).is_ok_and(|value| value.is_truthy());
                        sink(PortEvent::Inputs(inputs.map(is_on)));
                    }
                });
            }
        }
    }

    async fn set(&self, signals: &[(&str, Option<bool>)]) {
        let wanted = Object::new();
        for (key, value) in signals {
            if let Some(value) = value {
                // A plain object takes any property.
                let _ = Reflect::set(&wanted, &(*key).into(), &(*value).into());
            }
        }
        if let Ok(setting) = self.port.set_signals(&wanted) {
            settled(setting).await;
        }
    }

    async fn close(self) {
        self.closing.set(true);
        if let Some(writer) = &self.writer {
            // What was handed over leaves first, so that no frame is cut off.
            if !settled(writer.close()).await {
                settled(writer.abort()).await;
            }
            writer.release_lock();
        }
        let reader = self.reader.borrow().clone();
        if let Some(reader) = reader {
            settled(reader.cancel()).await;
        }
        select(self.reading_ended, JsFuture::from(sleep(STEP_MS))).await;
        if let Ok(closing) = self.port.close() {
            settled(closing).await;
        }
    }
}

/// Reads until the port is gone or being closed. Line errors end the stream but not the port, which then has a new one.
async fn read(port: &SerialPort, current: &RefCell<Option<Reader>>, closing: &Cell<bool>, sink: &Sink) {
    while let Some(readable) = port.readable() {
        let Ok(reader) = readable.reader() else { break };
        *current.borrow_mut() = Some(reader.clone());
        let end = read_stream(&reader, sink).await;
        *current.borrow_mut() = None;
        reader.release_lock();
        match end {
            StreamEnd::LineError if !closing.get() => sink(PortEvent::LineError),
            _ => break,
        }
    }
    if !closing.get() {
        sink(PortEvent::Lost);
    }
}

enum StreamEnd {
    Done,
    LineError,
    Gone,
}

async fn read_stream(reader: &Reader, sink: &Sink) -> StreamEnd {
    loop {
        match JsFuture::from(reader.read()).await {
            Ok(result) => {
                let result: ReadResult = result.unchecked_into();
                if result.done() {
                    return StreamEnd::Done;
                }
                if let Some(value) = result.value() {
                    sink(PortEvent::Bytes(value.to_vec()));
                }
            }
            Err(error) => {
                return match error_name(&error).as_str() {
                    "BufferOverrunError" | "BreakError" | "FramingError" | "ParityError" => StreamEnd::LineError,
                    _ => StreamEnd::Gone,
                };
            }
        }
    }
}

/// Whether `promise` was fulfilled within one step's time.
async fn settled(promise: Promise) -> bool {
    match select(JsFuture::from(promise), JsFuture::from(sleep(STEP_MS))).await {
        Either::Left((result, _)) => result.is_ok(),
        Either::Right(_) => false,
    }
}

fn sleep(milliseconds: i32) -> Promise {
    Promise::new(&mut |resolve, _| scope().set_timeout(&resolve, milliseconds))
}

fn open_options(settings: LineSettings, buffer_bytes: u32) -> Object {
    let options = Object::new();
    let set = |key: &str, value: JsValue| {
        // A plain object takes any property.
        let _ = Reflect::set(&options, &key.into(), &value);
    };
    set("baudRate", settings.baud.into());
    set("dataBits", if settings.data_bits == DataBits::Seven { 7 } else { 8 }.into());
    set("stopBits", if settings.stop_bits == StopBits::Two { 2 } else { 1 }.into());
    let parity = match settings.parity {
        Parity::None => "none",
        Parity::Odd => "odd",
        Parity::Even => "even",
    };
    set("parity", parity.into());
    set("bufferSize", buffer_bytes.into());
    set("flowControl", "none".into());
    options
}

fn open_fault(error: &JsValue) -> OpenFault {
    match error_name(error).as_str() {
        "NetworkError" | "InvalidStateError" => OpenFault::Busy,
        "SecurityError" | "NotAllowedError" => OpenFault::Forbidden,
        "NotFoundError" => OpenFault::Missing,
        "TypeError" | "NotSupportedError" => OpenFault::UnsupportedSettings,
        _ => OpenFault::Other(error_message(error)),
    }
}

fn error_name(error: &JsValue) -> String {
    text_property(error, "name")
}

fn error_message(error: &JsValue) -> String {
    let message = text_property(error, "message");
    if message.is_empty() { crash::words(error) } else { message }
}

fn text_property(value: &JsValue, key: &str) -> String {
    Reflect::get(value, &key.into()).ok().and_then(|text| text.as_string()).unwrap_or_default()
}

async fn granted_ports() -> Vec<SerialPort> {
    let Some(serial) = serial() else { return Vec::new() };
    let Ok(listing) = serial.ports() else { return Vec::new() };
    match JsFuture::from(listing).await {
        Ok(ports) => Array::from(&ports).iter().map(JsCast::unchecked_into).collect(),
        Err(_) => Vec::new(),
    }
}

fn port_id(index: usize, port: &SerialPort) -> PortId {
    let info = port.info();
    let usb = info.usb_vendor_id().zip(info.usb_product_id());
    PortId { index: u32::try_from(index).unwrap_or(u32::MAX), usb }
}

fn serial() -> Option<Serial> {
    scope().navigator().serial()
}

fn scope() -> Scope {
    js_sys::global().unchecked_into()
}

#[wasm_bindgen]
extern "C" {
    /// The global object of a window or a worker.
    type Scope;
    #[wasm_bindgen(method, getter)]
    fn navigator(this: &Scope) -> Navigator;
    #[wasm_bindgen(method, getter, js_name = isSecureContext)]
    fn is_secure_context(this: &Scope) -> Option<bool>;
    #[wasm_bindgen(method, js_name = setTimeout)]
    fn set_timeout(this: &Scope, callback: &js_sys::Function, milliseconds: i32);

    type Navigator;
    #[wasm_bindgen(method, getter)]
    fn serial(this: &Navigator) -> Option<Serial>;

    type Serial;
    #[wasm_bindgen(method, catch, js_name = getPorts)]
    fn ports(this: &Serial) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch, js_name = requestPort)]
    fn request_port(this: &Serial) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, js_name = addEventListener)]
    fn add_event_listener(this: &Serial, event: &str, listener: &js_sys::Function);

    #[derive(Clone)]
    type SerialPort;
    #[wasm_bindgen(method, js_name = getInfo)]
    fn info(this: &SerialPort) -> PortInfo;
    #[wasm_bindgen(method, catch)]
    fn open(this: &SerialPort, options: &Object) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn close(this: &SerialPort) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch, js_name = setSignals)]
    fn set_signals(this: &SerialPort, signals: &Object) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch, js_name = getSignals)]
    fn signals(this: &SerialPort) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, getter)]
    fn readable(this: &SerialPort) -> Option<Readable>;
    #[wasm_bindgen(method, getter)]
    fn writable(this: &SerialPort) -> Option<Writable>;

    type PortInfo;
    #[wasm_bindgen(method, getter, js_name = usbVendorId)]
    fn usb_vendor_id(this: &PortInfo) -> Option<u16>;
    #[wasm_bindgen(method, getter, js_name = usbProductId)]
    fn usb_product_id(this: &PortInfo) -> Option<u16>;

    type Readable;
    #[wasm_bindgen(method, catch, js_name = getReader)]
    fn reader(this: &Readable) -> Result<Reader, JsValue>;

    #[derive(Clone)]
    type Reader;
    #[wasm_bindgen(method)]
    fn read(this: &Reader) -> Promise;
    #[wasm_bindgen(method)]
    fn cancel(this: &Reader) -> Promise;
    #[wasm_bindgen(method, js_name = releaseLock)]
    fn release_lock(this: &Reader);

    type ReadResult;
    #[wasm_bindgen(method, getter)]
    fn done(this: &ReadResult) -> bool;
    #[wasm_bindgen(method, getter)]
    fn value(this: &ReadResult) -> Option<Uint8Array>;

    type Writable;
    #[wasm_bindgen(method, catch, js_name = getWriter)]
    fn writer(this: &Writable) -> Result<Writer, JsValue>;

    type Writer;
    #[wasm_bindgen(method)]
    fn write(this: &Writer, bytes: &Uint8Array) -> Promise;
    #[wasm_bindgen(method)]
    fn close(this: &Writer) -> Promise;
    #[wasm_bindgen(method)]
    fn abort(this: &Writer) -> Promise;
    #[wasm_bindgen(method, js_name = releaseLock)]
    fn release_lock(this: &Writer);
}
