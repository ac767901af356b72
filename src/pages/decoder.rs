//! The Decoder page: whatever came off a line becomes a list of frames, the chosen one is taken apart.

mod desk;
mod detail;
mod frames;
mod input;
mod tools;

use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::route;
use crate::text::Language;
use crate::workbench::Workbench;

pub(crate) use desk::Desk;

/// The page.
pub(crate) fn decoder_page(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    desk.start(app);
    dom::react(move || {
        let text = app.brought.get();
        if !text.is_empty() {
            desk.replace(text);
            route::forget_text();
        }
    });
    dom::react(move || {
        desk.typed.track();
        desk.form.set(None);
        desk.read_typed();
    });
    let any = Memo::new(move |_| desk.progress.with(|progress| progress.entries > 0));
    let none_shown = Memo::new(move |_| desk.progress.with(|progress| progress.entries > 0 && progress.shown == 0));
    let empty = Memo::new(move |_| {
        desk.progress.with(|progress| progress.finished && progress.entries == 0 && progress.fault_count == 0)
    });
    el("div")
        .class("page decoder")
        .test("page-decoder")
        .child(el("h1").class("visually-hidden").say(app, Language::decoder))
        .child(input::input_card(app))
        .live_one(move || empty.get().then(|| el("p").class("empty-page").say(app, Language::decoder_empty)))
        .live_one(move || {
            any.get().then(|| {
                el("section")
                    .class("card list-card")
                    .children(tools::tools(app))
                    .child(frames::frame_list(app))
                    .live_one(move || {
                        none_shown.get().then(|| el("p").class("empty-page").say(app, Language::filter_empty))
                    })
            })
        })
        .live_one(move || any.get().then(|| detail::detail(app)))
        .live_one(move || any.get().then(|| tools::statistics(app)))
}
