//! The page after an internal fault: plain DOM, because nothing else can be trusted any more.

use std::cell::{Cell, RefCell};

use wasm_bindgen::prelude::*;
use web_sys::{Document, Element};

use crate::text::Language;

/// What is done about a fault.
type Act = Box<dyn Fn(&str)>;

thread_local! {
    static ACT: RefCell<Option<Act>> = const { RefCell::new(None) };
}

/// Has `act` called with the details of every fault of the program, panics among them.
pub(crate) fn watch(act: impl Fn(&str) + 'static) {
    ACT.set(Some(Box::new(act)));
    std::panic::set_hook(Box::new(|info| report(&info.to_string())));
}

/// Reports a fault that leaves nothing to go on with.
pub(crate) fn report(details: &str) {
    ACT.with(|act| {
        if let Ok(act) = act.try_borrow()
            && let Some(act) = &*act
        {
            act(details);
        }
    });
}

/// Ends the engine, which closes the port, and shows what happened. Only the first fault counts: the rest follow from it.
pub(crate) fn show(details: &str) {
    thread_local! {
        static SHOWN: Cell<bool> = const { Cell::new(false) };
    }
    if SHOWN.replace(true) {
        return;
    }
    crate::link::end();
    // A page without a document cannot be shown; there is nobody left to tell.
    let _ = draw(details);
}

#[wasm_bindgen]
extern "C" {
    /// Any value of the browser's as a text.
    #[wasm_bindgen(js_name = String)]
    pub(crate) fn words(value: &JsValue) -> String;
}

fn draw(details: &str) -> Option<()> {
    let document = web_sys::window()?.document()?;
    let body = document.body()?;
    body.set_text_content(None);
    let main = add(&document, &body, "main", "crash")?;
    main.set_attribute("data-test", "crash").ok()?;
    main.set_attribute("role", "alert").ok()?;
    let first = document.document_element().and_then(|root| root.get_attribute("lang"));
    let first = first.and_then(|tag| Language::from_tag(&tag)).unwrap_or(Language::En);
    // Both languages: the switch is gone.
    for (language, heading) in [(first, "h1"), (first.other(), "h2")] {
        let section = add(&document, &main, "section", "")?;
        section.set_attribute("lang", language.tag()).ok()?;
        add(&document, &section, heading, "")?.set_text_content(Some(language.crash_title()));
        add(&document, &section, "p", "")?.set_text_content(Some(language.crash_what()));
        add(&document, &section, "p", "")?.set_text_content(Some(language.crash_report()));
    }
    let report = ["Buslens ", env!("CARGO_PKG_VERSION"), "\n", &user_agent(), "\n", details].concat();
    let actions = add(&document, &main, "div", "actions")?;
    actions.set_attribute("lang", first.tag()).ok()?;
    let copy = button(&document, &actions, "button", first.copy_details())?;
    copy.set_attribute("data-test", "copy-details").ok()?;
    let reload = button(&document, &actions, "button primary", first.reload())?;
    let shown = add(&document, &main, "pre", "")?;
    shown.set_attribute("tabindex", "0").ok()?;
    shown.set_attribute("aria-label", first.crash_details()).ok()?;
    shown.set_text_content(Some(&report));
    on_click(&copy, {
        let copy = copy.clone();
        move || copy_text(&report, &shown, &copy, first)
    });
    on_click(&reload, || {
        if let Some(window) = web_sys::window() {
            let _ = window.location().reload();
        }
    });
    Some(())
}

fn add(document: &Document, parent: &Element, tag: &str, class: &str) -> Option<Element> {
    let element = document.create_element(tag).ok()?;
    element.set_class_name(class);
    parent.append_child(&element).ok()?;
    Some(element)
}

fn button(document: &Document, parent: &Element, class: &str, label: &str) -> Option<Element> {
    let button = add(document, parent, "button", class)?;
    button.set_attribute("type", "button").ok()?;
    button.set_text_content(Some(label));
    Some(button)
}

fn on_click(button: &Element, act: impl Fn() + 'static) {
    let listener = Closure::<dyn Fn()>::new(act);
    let _ = button.add_event_listener_with_callback("click", listener.as_ref().unchecked_ref());
    listener.forget();
}

/// Copies the report. Where the clipboard is missing or refuses, selects it for the user to copy.
fn copy_text(report: &str, shown: &Element, button: &Element, language: Language) {
    let Some(window) = web_sys::window() else { return };
    if window.is_secure_context() {
        let (button, shown) = (button.clone(), shown.clone());
        let copied = Closure::once(move |_: JsValue| button.set_text_content(Some(language.copied())));
        let refused = Closure::once(move |_: JsValue| select(&shown));
        let _ = window.navigator().clipboard().write_text(report).then2(&copied, &refused);
        copied.forget();
        refused.forget();
    } else {
        select(shown);
    }
}

fn select(shown: &Element) {
    if let Some(selection) = web_sys::window().and_then(|window| window.get_selection().ok().flatten()) {
        let _ = selection.select_all_children(shown);
    }
}

fn user_agent() -> String {
    web_sys::window().and_then(|window| window.navigator().user_agent().ok()).unwrap_or_default()
}
