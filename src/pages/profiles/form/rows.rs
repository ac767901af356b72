//! Lists of the form: an entry a row, with a button that takes it away, and one that adds another.

use super::widget::{Widget, fault_note, widget};
use crate::components::button::{bare, icon_button};
use crate::components::icon::{Icon, icon};
use crate::dom::{El, el};
use crate::profiles::patch;
use crate::profiles::tree::join;
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// A list of the profile.
#[derive(Clone, Copy)]
pub(super) struct List {
    /// Its path, which also names it for the tests.
    pub(super) path: &'static str,
    pub(super) title: Label,
    pub(super) about: Option<Label>,
    /// The fields of an entry.
    pub(super) specs: &'static [Widget],
    /// What a new entry begins with, as JSON.
    pub(super) new: &'static str,
}

/// A part of the form that holds a list.
pub(super) fn list(app: &'static Workbench, list: List) -> El {
    let count = count(app, list.path.to_owned());
    let details = el("details").class("profile-section").test(&["section-", list.path].concat());
    let details = if count.get_untracked() > 0 { details.attr("open", "") } else { details };
    let head = el("summary")
        .child(el("h3").say(app, list.title))
        .child(el("span").class("muted").live_text(move || count.get().to_string()));
    details
        .child(head)
        .children(list.about.map(|about| el("p").class("profile-about muted").say(app, about)))
        .child(entries(app, list.path.to_owned(), list.specs, list.new, list.path))
}

/// The entries of a list, and the button for one more. `hook` names the buttons for the tests.
pub(super) fn entries(
    app: &'static Workbench,
    path: String,
    specs: &'static [Widget],
    new: &'static str,
    hook: &'static str,
) -> El {
    let count = count(app, path.clone());
    let add = {
        let path = path.clone();
        icon_button(app, "small", &["add-", hook].concat(), Icon::Plus, Language::form_add).click(move || {
            let place = count.get_untracked();
            app.profiles.patch(|text| patch::insert(text, &path, place, new));
        })
    };
    let rows = move || {
        let row = |at: usize| {
            let entry = join(&path, &at.to_string());
            let fields = specs.iter().map(|spec| widget(app, join(&entry, spec.key), spec)).collect::<Vec<_>>();
            let note = fault_note(app, entry.clone());
            let remove = bare("quiet small square", &["remove-", hook].concat())
                .label(app, Language::form_remove)
                .live_attr("title", move || Some(app.language.get().form_remove().to_owned()))
                .child(icon(Icon::Remove))
                .click(move || app.profiles.patch(|text| patch::remove(text, &entry)));
            let fields = el("div").class("profile-fields").children(fields);
            el("div").class("profile-entry").child(fields).child(remove).child(note)
        };
        (0..count.get()).map(row).collect()
    };
    el("div").class("profile-entries").live(rows).child(add)
}

/// How many entries the list at a path has.
pub(super) fn count(app: &'static Workbench, path: String) -> Memo<usize> {
    Memo::new(move |_| app.profiles.tree.with(|tree| tree.as_ref().map_or(0, |tree| tree.count(&path))))
}
