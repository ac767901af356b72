//! The list: the user's own profiles with what can be done to get one, and the built-in ones.

use buslens_codec::profile::Profile;

use super::state::{Told, built_in_key, own_key};
use crate::components::bring;
use crate::components::button::{bare, button, icon_button};
use crate::components::icon::{Icon, icon};
use crate::device::{self, Device};
use crate::dom::{El, el};
use crate::profiles::File;
use crate::profiles::tree::Tree;
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// Both lists.
pub(super) fn shelf(app: &'static Workbench) -> El {
    let header = el("header")
        .child(el("h2").say(app, Language::own_profiles))
        .child(el("span").class("space"))
        .child(
            icon_button(app, "small primary", "profile-new", Icon::Plus, Language::profile_new)
                .click(move || app.profiles.add_new()),
        )
        .child(
            el("label")
                .class("button small file")
                .child(icon(Icon::File))
                .child(el("span").say(app, Language::profile_import))
                .child(
                    bring::chooser("profile-file", move |file| super::take_file(app, file))
                        .attr("accept", ".json,application/json"),
                ),
        );
    let rows = Memo::new(move |_| app.profiles.own.with(|all| all.iter().map(|file| Row::of(app, file)).collect()));
    let own = move || {
        rows.with(|rows: &Vec<Row>| {
            if rows.is_empty() {
                return vec![el("p").class("profile-none muted").say(app, Language::no_own_profiles)];
            }
            rows.iter().map(|row| row.draw(app)).collect()
        })
    };
    let built_in = move || device::built_in().iter().map(|device| Row::built_in(app, device).draw(app)).collect();
    el("section")
        .class("card profile-shelf")
        .child(header)
        .child(el("div").class("profile-rows").test("own-profiles").live(own))
        .child(el("h3").class("profile-kind").say(app, Language::built_in_profiles))
        .child(el("div").class("profile-rows").test("built-in-profiles").live(built_in))
        .child(el("p").class("profile-about muted").say(app, Language::profiles_about))
}

/// A profile as the list shows it.
#[derive(Clone, PartialEq, Eq)]
struct Row {
    key: String,
    id: String,
    /// In both languages.
    names: [String; 2],
    is_changed: bool,
    is_faulty: bool,
    is_connected: bool,
}

impl Row {
    fn of(app: &'static Workbench, file: &File) -> Self {
        let tree = Tree::of(file.text()).or_else(|| Tree::of(file.saved.as_deref()?)).unwrap_or_default();
        let id = tree.get("id").to_owned();
        Self {
            key: own_key(file.key),
            names: [tree.get("name.en").to_owned(), tree.get("name.zh").to_owned()],
            is_changed: file.draft.is_some(),
            is_faulty: file.draft.as_deref().is_some_and(|text| Profile::from_json(text).is_err()),
            is_connected: is_connected(app, &id),
            id,
        }
    }

    fn built_in(app: &'static Workbench, device: &Device) -> Self {
        let id = device.id().to_owned();
        Self {
            key: built_in_key(&id),
            names: [device.name(Language::En).to_owned(), device.name(Language::Zh).to_owned()],
            is_changed: false,
            is_faulty: false,
            is_connected: is_connected(app, &id),
            id,
        }
    }

    fn draw(&self, app: &'static Workbench) -> El {
        let key = self.key.clone();
        let is_chosen = move |key: &str| app.profiles.chosen.with(|chosen| chosen == key);
        let [en, zh] = self.names.clone();
        let name = move || {
            let language = app.language.get();
            let name = if language == Language::En { &en } else { &zh };
            if name.is_empty() { language.profile_unnamed().to_owned() } else { name.clone() }
        };
        let tag = |class: &str, text: fn(Language) -> &'static str| el("span").class(class).say(app, text);
        let tags = [
            self.is_connected.then(|| tag("tag ok", Language::tag_connected)),
            self.is_faulty.then(|| tag("tag bad", Language::tag_faulty)),
            self.is_changed.then(|| tag("tag warn", Language::tag_unsaved)),
        ];
        let (marked, pressed) = (self.key.clone(), self.key.clone());
        bare("quiet profile-row", "profile-row")
            .attr("data-id", &self.id)
            .live_attr("aria-current", move || is_chosen(&marked).then(|| "true".to_owned()))
            .click(move || app.profiles.choose(pressed.clone()))
            .attr("data-key", &key)
            .child(el("b").live_text(name))
            .child(el("code").text(&self.id))
            .child(el("span").class("profile-tags").children(tags.into_iter().flatten()))
    }
}

fn is_connected(app: &'static Workbench, id: &str) -> bool {
    app.console.is_connected(id)
}

/// What is to be known whichever profile is shown.
pub(super) fn notices(app: &'static Workbench) -> El {
    el("div").class("profile-notices").child(refused(app)).child(told(app))
}

/// Says that the browser's storage has refused a change.
fn refused(app: &'static Workbench) -> El {
    el("div").class("contents").live_one(move || {
        app.profiles.refused.get().then(|| {
            let line = el("p").class("parse-error").attr("role", "alert").test("profile-refused");
            line.child(icon(Icon::Fault)).child(el("span").say(app, Language::profile_refused))
        })
    })
}

/// What came of the last action, with a way back where there is one.
fn told(app: &'static Workbench) -> El {
    let profiles = &app.profiles;
    el("div").class("contents").live_one(move || {
        let language = app.language.get();
        let told = profiles.told.get()?;
        let fault = |words: &str| {
            let line = el("p").class("parse-error").attr("role", "alert").test("profile-told");
            line.child(icon(Icon::Fault)).child(el("span").text(words))
        };
        let done = |words: &str| {
            let line = el("p").class("profile-told muted").attr("role", "status").test("profile-told");
            line.child(el("span").text(words))
        };
        let undo = || button(app, "small quiet", "profile-undo", Language::undo).click(move || profiles.undo());
        let name = |file: &File| name_of(language, file);
        Some(match &told {
            Told::TooLong(name) => fault(&language.profile_too_long(name)),
            Told::NoText(name) => fault(&language.profile_no_text(name)),
            Told::TooMany => fault(language.profile_too_many()),
            Told::Imported([en, zh]) => {
                done(&language.profile_imported(if language == Language::En { en } else { zh }))
            }
            Told::Deleted(file, _) => done(&language.profile_deleted(&name(file))).child(undo()),
            Told::Reverted(file) => done(&language.profile_reverted(&name(file))).child(undo()),
        })
    })
}

/// The name of a file's profile for people, as far as it has one.
pub(super) fn name_of(language: Language, file: &File) -> String {
    let tree = Tree::of(file.text()).or_else(|| Tree::of(file.saved.as_deref()?)).unwrap_or_default();
    let name = tree.get(if language == Language::En { "name.en" } else { "name.zh" });
    if name.is_empty() { language.profile_unnamed().to_owned() } else { name.to_owned() }
}
