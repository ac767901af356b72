//! The Decoder page: whatever came off a line becomes a list of frames, the chosen one is taken apart.

mod desk;
mod input;
mod tools;

use crate::components::desk::detail::detail;
use crate::components::desk::frame_list;
use crate::components::desk::tools::{filter_bar, statistics};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::route;
use crate::text::Language;
use crate::workbench::Workbench;

pub(crate) use desk::Decoder;

/// The page.
pub(crate) fn decoder_page(app: &'static Workbench) -> El {
    let decoder = &app.decoder;
    let desk = &decoder.desk;
    decoder.start(app);
    dom::react(move || {
        let text = app.brought.get();
        if !text.is_empty() {
            decoder.replace(text);
            route::forget_text();
        }
    });
    dom::react(move || {
        decoder.typed.track();
        decoder.form.set(None);
        decoder.read_typed();
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
                    .child(tools::list_header(app))
                    .child(filter_bar(app, desk))
                    .child(frame_list(app, desk))
                    .live_one(move || {
                        none_shown.get().then(|| el("p").class("empty-page").say(app, Language::filter_empty))
                    })
            })
        })
        .live_one(move || any.get().then(|| detail(app, desk)))
        .live_one(move || any.get().then(|| statistics(app, desk)))
}
