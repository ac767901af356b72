//! One profile: what can be done with it, what the loader says of it, and its two views.

use buslens_codec::profile::ProfileError;

use super::shelf::name_of;
use super::state::{Owner, Taken};
use super::{form, state};
use crate::components::button::{bare, button};
use crate::components::icon::{Icon, icon};
use crate::components::sheet::{self, Marks, sheet};
use crate::dom::{self, El, el};
use crate::profiles::reasons;
use crate::profiles::tree::Tree;
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// The id of the text's field.
const FIELD: &str = "profile-text";

/// The card of the profile that is shown.
pub(super) fn editor(app: &'static Workbench) -> El {
    let profiles = &app.profiles;
    let text_view = Memo::new(move |_| profiles.view.with(|view| view == "text"));
    el("section")
        .class("card profile-editor")
        .test("profile-editor")
        .on("keydown", move |event| {
            if dom::key(&event) == "s" && dom::is_commanded(&event) {
                event.prevent_default();
                profiles.save();
            }
        })
        .child(header(app))
        .child(standing(app))
        .live_one(move || Some(if text_view.get() { text(app) } else { form::form(app) }))
}

fn header(app: &'static Workbench) -> El {
    let profiles = &app.profiles;
    let is_own = Memo::new(move |_| profiles.file().is_some());
    let is_changed = Memo::new(move |_| profiles.is_changed());
    let revertible =
        Memo::new(move |_| profiles.file().is_some_and(|file| file.draft.is_some() && file.saved.is_some()));
    let title = move || {
        let language = app.language.get();
        let own = || profiles.file().map(|file| name_of(language, &file));
        profiles.built_in().map(|device| device.name(language).to_owned()).or_else(own).unwrap_or_default()
    };
    el("header")
        .child(
            bare("quiet small square profile-back", "profile-back")
                .label(app, Language::own_profiles)
                .click(move || profiles.choose(String::new()))
                .child(icon(Icon::Back)),
        )
        .child(el("h2").test("profile-title").live_text(title))
        .child(el("span").class("space"))
        .child(view_tabs(app))
        .child(
            el("div")
                .class("profile-actions")
                .live(move || {
                    if !is_own.get() {
                        return Vec::new();
                    }
                    let save = button(app, "small", "profile-save", Language::profile_save)
                        .live_class("primary", move || profiles.can_save())
                        .flag("disabled", move || !profiles.can_save())
                        .click(move || profiles.save());
                    let revert = || {
                        button(app, "quiet small", "profile-revert", Language::profile_revert)
                            .click(move || profiles.revert())
                    };
                    std::iter::once(save).chain(revertible.get().then(revert)).collect()
                })
                .child(
                    button(app, "quiet small", "profile-duplicate", Language::profile_duplicate)
                        .click(move || profiles.duplicate()),
                )
                .child(
                    button(app, "quiet small", "profile-export", Language::profile_export).click(move || export(app)),
                )
                .live_one(move || {
                    is_own.get().then(|| {
                        button(app, "quiet small", "profile-delete", Language::profile_delete)
                            .click(move || profiles.asks_delete.set(true))
                    })
                }),
        )
        .live_class("changed", move || is_changed.get())
}

fn view_tabs(app: &'static Workbench) -> El {
    let view = app.profiles.view;
    let tab = |(key, hook, text): (&'static str, &str, Label)| {
        el("button")
            .attr("type", "button")
            .test(hook)
            .state("aria-pressed", move || view.with(|view| (view == "text") == (key == "text")))
            .click(move || view.set(key.to_owned()))
            .say(app, text)
    };
    let tabs = [
        ("form", "profile-view-form", Language::profile_form_tab as Label),
        ("text", "profile-view-text", Language::profile_text_tab),
    ];
    el("div").class("tabs").attr("role", "group").label(app, Language::profile_view).children(tabs.map(tab))
}

/// Saves the text that is shown as a file.
fn export(app: &'static Workbench) {
    let text = app.profiles.text.get_untracked();
    let id = Tree::of(&text).map(|tree| tree.get("id").to_owned()).unwrap_or_default();
    let plain = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_') { c } else { '-' };
    let name: String = id.chars().map(plain).collect();
    let name = if name.is_empty() { "profile" } else { &name };
    dom::save_text(&text, "application/json", &[name, ".json"].concat());
}

/// Whether it is saved, or what stands in the way.
fn standing(app: &'static Workbench) -> El {
    let profiles = &app.profiles;
    let has_file = Memo::new(move |_| profiles.file().is_some());
    let is_changed = Memo::new(move |_| profiles.is_changed());
    let in_use = Memo::new(move |_| {
        let id = profiles.tree.with(|tree| tree.as_ref().map(|tree| tree.get("id").to_owned()));
        id.is_some_and(|id| app.console.is_connected(&id))
    });
    let line = |kind: &str, hook: &str, text: &str| {
        el("div").class("profile-line").attr("data-kind", kind).test(hook).child(el("span").text(text))
    };
    el("div").class("profile-standing").attr("aria-live", "polite").attr("id", "profile-text-faults").live(move || {
        let language = app.language.get();
        let mut all = Vec::new();
        if !has_file.get() {
            all.push(line("info", "profile-fixed", language.profile_fixed()));
            return all;
        }
        if profiles.asks_delete.get() {
            all.push(delete_question(app, language));
        }
        profiles.loaded.with(|loaded| match loaded {
            Err(fault) => {
                let (row, column) = (fault.line, fault.column);
                let told = language.profile_fault(row, column, &reason(language, fault));
                let show = button(app, "small quiet", "profile-go-to-fault", Language::profile_go_to_fault)
                    .click(move || show_place(app, row, column));
                let line = line("bad", "profile-fault", &told).child(show);
                all.push(line.child(el("small").text(language.profile_fault_about())));
            }
            Ok(state::Loaded { id, taken: Some(taken) }) => all.push(taken_id(app, language, id, taken)),
            Ok(_) if is_changed.get() => all.push(line("info", "profile-ready", language.profile_ready())),
            Ok(_) => all.push(line("ok", "profile-saved", language.profile_saved())),
        });
        if in_use.get() {
            all.push(line("info", "profile-in-use", language.profile_in_use()));
        }
        all
    })
}

fn delete_question(app: &'static Workbench, language: Language) -> El {
    let profiles = &app.profiles;
    let name = untrack(|| profiles.file()).map(|file| name_of(language, &file)).unwrap_or_default();
    let go = button(app, "small danger", "profile-delete-sure", Language::profile_delete_sure)
        .click(move || profiles.delete());
    let not = button(app, "small quiet", "profile-delete-not", Language::cancel)
        .click(move || profiles.asks_delete.set(false));
    el("div")
        .class("profile-line")
        .attr("data-kind", "warn")
        .attr("role", "alert")
        .child(el("span").text(&language.profile_delete_ask(&name)))
        .child(go)
        .child(not)
}

/// The id belongs to another profile: what can be done about it.
fn taken_id(app: &'static Workbench, language: Language, id: &str, taken: &Taken) -> El {
    let profiles = &app.profiles;
    let owner = match taken.by {
        Owner::Own(key) => profiles.own.with_untracked(|all| {
            all.iter().find(|file| file.key == key).map(|file| name_of(language, file)).unwrap_or_default()
        }),
        Owner::BuiltIn => {
            let device = crate::device::built_in().iter().find(|device| device.id() == id);
            device.map(|device| device.name(language).to_owned()).unwrap_or_default()
        }
    };
    let free = taken.free.clone();
    let other =
        bare("small", "profile-use-id").text(&language.profile_use_id(&free)).click(move || profiles.use_id(&free));
    let replace = match taken.by {
        Owner::BuiltIn => None,
        Owner::Own(key) => Some(
            button(app, "small", "profile-replace", Language::profile_replace)
                .click(move || profiles.save_in_place_of(key)),
        ),
    };
    el("div")
        .class("profile-line")
        .attr("data-kind", "bad")
        .attr("role", "alert")
        .test("profile-id-taken")
        .child(el("span").text(&language.profile_id_taken(id, &owner)))
        .child(other)
        .children(replace)
}

/// Shows a place of the text with the cursor in it.
fn show_place(app: &'static Workbench, line: usize, column: usize) {
    app.profiles.view.set("text".to_owned());
    let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    // The view is drawn by then.
    request_animation_frame(move || {
        let text = app.profiles.text.get_untracked();
        sheet::go_to(FIELD, &text, number(line), number(column));
    });
}

/// Why the loader does not take the text.
pub(super) fn reason(language: Language, fault: &ProfileError) -> String {
    match language {
        Language::En => fault.reason.clone(),
        Language::Zh => reasons::in_chinese(&fault.reason),
    }
}

/// The view as text.
fn text(app: &'static Workbench) -> El {
    let profiles = &app.profiles;
    let marks = Memo::new(move |_| {
        let fault = profiles.loaded.with(|loaded| loaded.as_ref().err().map(|fault| fault.line));
        let line = fault.map(|line| u32::try_from(line).unwrap_or(u32::MAX));
        line.map(|line| (line, "fault")).into_iter().collect::<Marks>()
    });
    let is_fixed = move || profiles.file().is_none();
    sheet(app, FIELD, Language::profile_editor, profiles.text, marks, is_fixed, move |typed| profiles.type_text(&typed))
}
