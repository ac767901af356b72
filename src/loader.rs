//! The way to the second program, the workbench, which is loaded when it is first needed.
//!
//! The program is a JS handle and stays out of the signals: it lives in this module alone.

use std::cell::RefCell;

use js_sys::{Array, Promise, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};

use crate::app::App;
use crate::components::button::button;
use crate::components::icon::{Icon, icon};
use crate::crash;
use crate::device;
use crate::dom::{El, el, on_window, react};
use crate::link;
use crate::message::ToWorkbench;
use crate::reactive::prelude::*;
use crate::storage::{self, OWN_PROFILES};
use crate::text::Language;

/// How far the second program is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Loading {
    /// Nobody has needed it yet.
    Absent,
    /// It is coming.
    Coming,
    /// It is there.
    There,
    /// It did not come.
    Failed,
}

thread_local! {
    static PROGRAM: RefCell<Option<Program>> = const { RefCell::new(None) };
}

/// Keeps the workbench in the page's language. Where there are profiles of the user's, it is needed from the start: it
/// alone can read their files.
pub(crate) fn follow(app: &'static App) {
    if storage::load(OWN_PROFILES).is_some() {
        load(app);
    }
    on_window("storage", move |_| {
        // Another tab may have made the first one.
        if storage::load(OWN_PROFILES).is_some() {
            load(app);
        }
    });
    react(move || {
        let language = app.language.get();
        send(&ToWorkbench::Language(language), &JsValue::UNDEFINED);
    });
    react(move || {
        // A chosen device whose profile is gone for good: not one whose file is still to be read, nor the connected one.
        let is_read = app.workbench.get() == Loading::There || storage::load(OWN_PROFILES).is_none();
        if is_read && app.settings.known_device().is_none() {
            app.settings.device.set(device::first().id().to_owned());
        }
    });
    react(move || {
        let used = app.connection.get().filter(|_| app.phase.get().is_connected());
        let unit = used.as_ref().map_or(0, |used| used.unit.0);
        let device = used.and_then(|used| device::of_packed(&used.profile));
        device::hold(device);
        let device = device.map(|device| (device.packed().to_owned(), unit));
        if app.workbench.get() == Loading::There {
            send(&ToWorkbench::Device(device), &JsValue::UNDEFINED);
        }
    });
}

/// A place that the workbench fills: `content` is what it is told, and follows signals. Until the program is there, the
/// place says so.
pub(crate) fn place(app: &'static App, content: impl Fn() -> ToWorkbench + 'static, end: ToWorkbench) -> El {
    load(app);
    let place = el("div").class("contents");
    let handle = place.handle();
    react(move || {
        if app.workbench.get() == Loading::There {
            send(&content(), handle.js());
        }
    });
    on_cleanup(move || send(&end, &JsValue::UNDEFINED));
    place.live_one(move || match app.workbench.get() {
        Loading::There => None,
        Loading::Absent | Loading::Coming => {
            Some(el("p").class("empty loading").attr("role", "status").say(app, Language::loading))
        }
        Loading::Failed => Some(failure(app)),
    })
}

fn failure(app: &'static App) -> El {
    let retry = button(app, "small", "load-again", Language::load_again).click(move || load(app));
    let what = el("div").child(el("p").say(app, Language::loading_failed)).child(retry);
    el("section").class("alert").attr("role", "alert").test("loading-failed").child(icon(Icon::Fault)).child(what)
}

/// Loads it, unless it is there or on its way: two in one page would get in each other's way.
pub(crate) fn load(app: &'static App) {
    if matches!(app.workbench.get_untracked(), Loading::Coming | Loading::There) {
        return;
    }
    app.workbench.set(Loading::Coming);
    spawn_local(async move {
        let loaded = match import_workbench() {
            Ok(coming) => JsFuture::from(coming).await,
            Err(error) => Err(error),
        };
        let Ok(program) = loaded else { return app.workbench.set(Loading::Failed) };
        PROGRAM.with_borrow_mut(|slot| *slot = Some(program.unchecked_into()));
        let tell = Closure::<dyn Fn(String)>::new(|details: String| crash::report(&details));
        let own = Closure::<dyn Fn(Vec<u8>)>::new(|packed: Vec<u8>| take_own(&packed));
        let beside = Array::of3(tell.as_ref(), &link::worker(), own.as_ref());
        send(&ToWorkbench::Start(app.language.get_untracked()), &beside);
        tell.forget();
        own.forget();
        app.workbench.set(Loading::There);
    });
}

/// The user's own devices as the workbench has read them: a list of packed profiles, packed.
fn take_own(packed: &[u8]) {
    let all: Vec<Vec<u8>> = postcard::from_bytes(packed).unwrap_or_default();
    device::set_own(all.into_iter().map(|packed| (String::new(), packed)).collect());
}

/// Sends a message with what comes beside it.
fn send(message: &ToWorkbench, beside: &JsValue) {
    let Ok(bytes) = postcard::to_allocvec(message) else { return };
    PROGRAM.with_borrow(|program| {
        if let Some(program) = program {
            // A program that fails has told so before.
            let _ = program.hear(&Uint8Array::from(bytes.as_slice()), beside);
        }
    });
}

#[wasm_bindgen]
extern "C" {
    /// Imports the second program; the page's script knows where it is.
    #[wasm_bindgen(catch, js_name = buslensWorkbench)]
    fn import_workbench() -> Result<Promise, JsValue>;

    type Program;
    #[wasm_bindgen(method, catch)]
    fn hear(this: &Program, message: &Uint8Array, beside: &JsValue) -> Result<(), JsValue>;
}
