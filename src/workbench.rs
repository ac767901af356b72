//! The second program of the window: the pages and cards that explain frames. The first program loads it and tells it
//! by [`ToWorkbench`] what to show, and where.

use std::ops::Deref;

use buslens_analyst::message::{FromAnalyst, Sums, ToAnalyst, ToConsole};
use buslens_codec::intake::IntakeError;
use js_sys::{Array, Function, Uint8Array};
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Element, MessageChannel, Worker};

use crate::ambient::Ambient;
use crate::analyst::Analyst;
use crate::configuring::Configuring;
use crate::crash;
use crate::device;
use crate::dom::{self, El, Handle, el};
use crate::message::{Exchange, ToEngine, ToWorkbench};
use crate::pages::{
    Configure, Console, Decoder, Fleet, Handling, Profiles, banner, builder_page, configure_page, console_page,
    decoder_page, exchange_halves, fleet_page, follow_configuring, follow_fleet, handling, help_sheet,
    listen_at_console, listen_at_profiles, marks, open_help, profiles_page,
};
use crate::profiles;
use crate::reactive::prelude::*;
use crate::reactive::run_forever;
use crate::route::{self, Page};
use crate::text::Language;

/// What every part of this program may look at. Signals only: free of JS handles.
pub(crate) struct Workbench {
    ambient: Ambient,
    /// The page shown, if it is one of this program's.
    pub(crate) page: RwSignal<Option<Page>>,
    /// The last exchange of the Live page, while it is shown.
    pub(crate) exchange: RwSignal<Option<Exchange>>,
    /// What can be done with the device on the Live page.
    pub(crate) handling: Handling,
    /// What the address brings to be read.
    pub(crate) brought: RwSignal<String>,
    /// The digits of the bytes that the address brings to be sent.
    pub(crate) to_send: RwSignal<String>,
    /// The Console page's state.
    pub(crate) console: Console,
    /// What is done to devices.
    pub(crate) configuring: Configuring,
    /// The Configure page's state.
    pub(crate) configure: Configure,
    /// The Fleet page's state.
    pub(crate) fleet: Fleet,
    /// The Decoder page's state.
    pub(crate) decoder: Decoder,
    /// The Profiles page's state.
    pub(crate) profiles: Profiles,
    /// The last text whose checks the analyst has made, and what came of it.
    pub(crate) sums: RwSignal<Option<Summed>>,
    /// Id of the device whose help was asked for, if none is connected.
    pub(crate) help: RwSignal<Option<String>>,
    /// Counts the changes of the window's size.
    pub(crate) size_turn: RwSignal<u32>,
}

/// A text with the checks of its bytes, `None` where it holds none; or its first fault.
pub(crate) type Summed = (String, Result<Option<Sums>, IntakeError>);

impl Deref for Workbench {
    type Target = Ambient;

    fn deref(&self) -> &Ambient {
        &self.ambient
    }
}

impl Workbench {
    fn new(language: Language) -> Self {
        Self {
            ambient: Ambient { language: RwSignal::new(language) },
            page: RwSignal::new(None),
            exchange: RwSignal::new(None),
            handling: Handling::new(),
            brought: route::follow_text(),
            to_send: route::follow_send(),
            console: Console::remembered(),
            configuring: Configuring::new(),
            configure: Configure::remembered(),
            fleet: Fleet::remembered(),
            decoder: Decoder::remembered(),
            profiles: Profiles::remembered(),
            sums: RwSignal::new(None),
            help: RwSignal::new(None),
            size_turn: RwSignal::new(0),
        }
    }

    /// Starts the console's worker and joins it to the engine, if that has not been done: from then on it knows the line.
    pub(crate) fn start_console(&'static self) {
        if self.console.start(&self.configuring) {
            self.tell_device();
        }
    }

    /// Starts the analyst's worker, if it has not been.
    pub(crate) fn start_analyst(&'static self) {
        Analyst::Decoder.start(move |message, beside| match message {
            FromAnalyst::Sums(text, sums) => self.sums.set(Some((text, sums))),
            message => self.decoder.hear(message, &beside),
        });
    }
}

/// Joins the console's worker to the engine by a channel of their own.
pub(crate) fn attach_console() {
    let Ok(channel) = MessageChannel::new() else { return };
    let (Ok(wish), engine) = (postcard::to_allocvec(&ToEngine::Attach), ENGINE.with_borrow(Clone::clone)) else {
        return;
    };
    let port = channel.port1();
    let parts = Array::of2(&Uint8Array::from(wish.as_slice()), &port);
    if let Some(engine) = engine {
        // Bytes and ends of channels can always be posted.
        let _ = engine.post_message_with_transfer(&parts, &Array::of1(&port));
    }
    Analyst::Console.send_port(&ToAnalyst::Console(ToConsole::Attach), &channel.port2());
}

/// The state, and the boxes without a box of their own that stand in the first program's places.
#[derive(Clone)]
struct Running {
    state: &'static Workbench,
    page: Handle,
    exchange: Handle,
    handling: Handle,
    marks: Handle,
    help: Handle,
}

thread_local! {
    /// The engine's worker, which belongs to the first program: a JS handle, and so kept out of signals.
    static ENGINE: std::cell::RefCell<Option<Worker>> = const { std::cell::RefCell::new(None) };
    static RUNNING: std::cell::RefCell<Option<Running>> = const { std::cell::RefCell::new(None) };
}

/// Takes a message of the first program, with what comes beside it.
pub fn hear(message: &[u8], beside: JsValue) {
    match postcard::from_bytes(message) {
        Ok(ToWorkbench::Start(language)) => start(language, beside),
        Ok(message) => {
            if let Some(running) = RUNNING.with_borrow(Option::clone) {
                running.obey(message, &beside);
            }
        }
        Err(error) => crash::report(&["the workbench cannot read a message: ", &error.to_string()].concat()),
    }
}

impl Running {
    fn obey(&self, message: ToWorkbench, beside: &JsValue) {
        let state = self.state;
        match message {
            ToWorkbench::Start(_) => {}
            ToWorkbench::Language(language) => state.ambient.language.set(language),
            ToWorkbench::Page(page) => {
                put(&self.page, beside);
                state.page.set(page);
            }
            ToWorkbench::Device(told) => {
                let (packed, unit) = told.unzip();
                state.handling.connected(unit.is_some());
                state.device_connected(packed.and_then(|packed| device::of_packed(&packed)), unit);
            }
            ToWorkbench::Help(chosen) => {
                put(&self.help, beside);
                let open = chosen.is_some();
                state.help.set(chosen);
                if open {
                    open_help(self.help.clone());
                }
            }
            ToWorkbench::Exchange(exchange) => {
                put(&self.exchange, beside);
                state.exchange.set(exchange);
            }
            ToWorkbench::Handling(live) => {
                put(&self.handling, beside);
                state.handling.hear(live);
            }
            ToWorkbench::Marks => put(&self.marks, beside),
        }
    }
}

/// Puts a box into a place of the first program's, if it is not there already.
fn put(content: &Handle, place: &JsValue) {
    if let Some(place) = place.dyn_ref::<Element>() {
        content.move_into(place);
    }
}

/// Keeps both programs' devices as the user's files say.
fn follow_own_profiles(state: &'static Workbench, tell: Function) {
    let saved = Memo::new(move |_| state.profiles.saved());
    dom::react(move || {
        let taken: Vec<&str> = device::built_in().iter().map(device::Device::id).collect();
        let all = saved.with(|saved| profiles::devices(saved.iter().map(String::as_str), &taken));
        let all: Vec<(String, Vec<u8>)> = all.into_iter().map(|(text, profile)| (text, profile.pack())).collect();
        let packed: Vec<&[u8]> = all.iter().map(|(_, packed)| packed.as_slice()).collect();
        // Bytes in a list can always be packed.
        let packed = postcard::to_allocvec(&packed).unwrap_or_default();
        device::set_own(all);
        // A first program that fails has told so before.
        let _ = tell.call1(&JsValue::UNDEFINED, &Uint8Array::from(packed.as_slice()));
    });
    dom::on_window("storage", move |_| state.profiles.stored_elsewhere());
}

/// Begins. Beside it come the function that ends the whole page after a fault, the engine's worker, and the function that
/// takes the user's own profiles.
fn start(language: Language, beside: JsValue) {
    let parts: Array = beside.unchecked_into();
    let tell: Function = parts.get(0).unchecked_into();
    ENGINE.set(parts.get(1).dyn_into().ok());
    let take_own: Function = parts.get(2).unchecked_into();
    device::keep_whole();
    crash::watch(move |details| {
        // The first program draws the page of the crash; there is nobody else to tell.
        let _ = tell.call1(&JsValue::UNDEFINED, &details.into());
    });
    run_forever(move || {
        // One for the life of the page, and cheap for every closure to hold.
        let state: &'static Workbench = Box::leak(Box::new(Workbench::new(language)));
        dom::on_window("resize", |_| state.size_turn.update(|turn| *turn = turn.wrapping_add(1)));
        Handling::follow(state);
        follow_own_profiles(state, take_own);
        listen_at_profiles(state, || state.page.get_untracked() == Some(Page::Profiles));
        state.follow_line();
        listen_at_console(state, || state.page.get_untracked() == Some(Page::Console));
        follow_configuring(state);
        follow_fleet(state);
        if let Some(place) = document().get_element_by_id("notices") {
            banner(state).handle().move_into(&place);
        }
        let content = |build: fn(&'static Workbench) -> Option<El>| {
            el("div").class("contents").live_one(move || build(state)).handle()
        };
        let page = content(|state| {
            Some(match state.page.get()? {
                Page::Live => return None,
                Page::Decoder => decoder_page(state),
                Page::Builder => builder_page(state),
                Page::Console => console_page(state),
                Page::Profiles => profiles_page(state),
                Page::Configure => configure_page(state),
                Page::Fleet => fleet_page(state),
            })
        });
        let shown = Memo::new(move |_| state.exchange.with(Option::is_some));
        let exchange = el("div").class("contents").live_one(move || shown.get().then(|| exchange_halves(state)));
        let exchange = exchange.handle();
        let (handling, marks) = (handling(state).handle(), marks(state).handle());
        let help = help_sheet(state).handle();
        RUNNING.with_borrow_mut(|slot| *slot = Some(Running { state, page, exchange, handling, marks, help }));
    });
}
