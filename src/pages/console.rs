//! The Console page: everything that goes over the line, and whatever is to be sent over it.

mod building;
mod compact;
mod dock;
mod kept;
mod keys;
mod log;
mod panes;
mod replay;
mod send;
mod sequence;
mod setup;
mod state;

use crate::console::Line;
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::route;
use crate::text::Language;
use crate::workbench::Workbench;

pub(crate) use state::Console;

/// The page.
pub(crate) fn console_page(app: &'static Workbench) -> El {
    app.start_console();
    let console = &app.console;
    dom::react(move || {
        let digits = app.to_send.get();
        if !digits.is_empty() {
            // What stands in the line must not bring the bytes back.
            untrack(|| take_bytes(app, &digits));
            route::forget_send();
        }
    });
    el("div")
        .class("page console")
        .test("page-console")
        .on("dragover", |event| event.prevent_default())
        .on("drop", move |event| log::dropped(app, &event))
        .child(el("h1").class("visually-hidden").say(app, Language::console))
        .child(
            el("div")
                .class("contents")
                .flag("inert", move || console.keys_open.get() || console.builder_open.get())
                .child(setup::line_strip(app))
                .child(el("div").class("console-main").child(log::log_card(app)).child(panes::panes(app)))
                .child(send::dock(app)),
        )
        .live_one(move || console.keys_open.get().then(|| keys::sheet(app)))
        .live_one(move || console.builder_open.get().then(|| building::builder_dialog(app)))
}

/// Listens to keys and to what is pasted for as long as the page is shown.
pub(crate) fn listen(app: &'static Workbench, is_shown: impl Fn() -> bool + Copy + 'static) {
    dom::on_window("keydown", move |event| {
        if is_shown() && !event.default_prevented() {
            keys::pressed(app, &event);
        }
    });
    dom::on_window("paste", move |event| {
        if is_shown() {
            log::pasted(app, &event);
        }
    });
}

/// Puts the bytes that an address brings into the send line; what stood there can be had back with the arrow keys.
fn take_bytes(app: &'static Workbench, digits: &str) {
    let hex = Line { text: digits.to_owned(), ..Line::of_bytes(&[]) };
    let line = match hex.outgoing() {
        Ok(outgoing) => Line::of_bytes(&outgoing.bytes),
        // The line says what is wrong with them.
        Err(_) => hex,
    };
    app.console.dock.replace(line);
    app.console.builder_open.set(false);
    panes::focus_soon(send::LINE);
}
