//! The Profiles page: what is built in, the user's own, and an editor of one as text and as form.

mod editor;
mod form;
mod shelf;
mod state;

use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{Event, File};

use crate::components::bring::{self, Dropped};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

pub(crate) use state::Profiles;

/// The page.
pub(crate) fn profiles_page(app: &'static Workbench) -> El {
    let profiles = &app.profiles;
    let chosen = Memo::new(move |_| profiles.shown());
    el("div")
        .class("page profiles")
        .test("page-profiles")
        .live_class("has-one", move || chosen.get().is_some())
        .on("dragover", |event| event.prevent_default())
        .on("drop", move |event| dropped(app, &event))
        .child(el("h1").class("visually-hidden").say(app, Language::profiles))
        .child(shelf::notices(app))
        .child(shelf::shelf(app))
        .live_one(move || {
            Some(match chosen.get() {
                Some(_) => editor::editor(app),
                None => el("section")
                    .class("card profile-editor")
                    .child(el("p").class("empty-page").say(app, Language::profile_pick)),
            })
        })
}

/// Takes in what is pasted beside the fields for as long as the page is shown.
pub(crate) fn listen(app: &'static Workbench, is_shown: impl Fn() -> bool + Copy + 'static) {
    dom::on_window("paste", move |event| {
        if is_shown()
            && !dom::is_typing(&event)
            && let Some(text) = bring::pasted(&event)
        {
            take_text(app, &String::from(text));
        }
    });
}

fn dropped(app: &'static Workbench, event: &Event) {
    match bring::dropped(event) {
        Some(Dropped::File(file)) => take_file(app, file),
        Some(Dropped::Text(text)) => take_text(app, &String::from(text)),
        None => {}
    }
}

fn take_text(app: &'static Workbench, text: &str) {
    if !text.trim().is_empty() {
        let name = app.language.get_untracked().profile_pasted().to_owned();
        app.profiles.bring(name, Some(text.to_owned()), false);
    }
}

fn take_file(app: &'static Workbench, file: File) {
    // Beyond this no text is read at all.
    let too_long = file.size() > state::LONGEST_FILE;
    spawn_local(async move {
        let read = if too_long { None } else { JsFuture::from(file.text()).await.ok() };
        app.profiles.bring(file.name(), read.and_then(|text| text.as_string()), too_long);
    });
}
