//! A labelled field of a form: control, hint, and what is wrong with it.

use std::rc::Rc;

use crate::reactive::prelude::*;

use crate::ambient::Ambient;
use crate::dom::{El, el};
use crate::text::Language;

/// One field with its note, which is tied to the control by `id`.
pub(crate) fn field(
    app: &'static Ambient,
    id: &'static str,
    label: fn(Language) -> &'static str,
    control: El,
    note: impl Fn() -> Option<Note> + 'static,
) -> El {
    labelled(id, el("label").attr("for", id).say(app, label), control, note)
}

/// The same with a label of any make.
pub(crate) fn labelled(id: &'static str, label: El, control: El, note: impl Fn() -> Option<Note> + 'static) -> El {
    labelled_boxed(id, label, control, Rc::new(note))
}

fn labelled_boxed(id: &'static str, label: El, control: El, note: Rc<dyn Fn() -> Option<Note>>) -> El {
    let kind = Rc::clone(&note);
    el("div").class("field").child(label).child(control).child(
        el("p")
            .class("note")
            .attr("id", &note_id(id))
            .live_attr("data-kind", move || kind().map(|note| note.kind().to_owned()))
            .live_text(move || note().map(Note::text).unwrap_or_default()),
    )
}

/// What stands under a field.
pub(crate) enum Note {
    /// An explanation.
    Hint(String),
    /// Allowed, but think twice.
    Warning(String),
    /// Not allowed.
    Wrong(String),
}

impl Note {
    fn kind(&self) -> &'static str {
        match self {
            Self::Hint(_) => "hint",
            Self::Warning(_) => "warning",
            Self::Wrong(_) => "wrong",
        }
    }

    fn text(self) -> String {
        match self {
            Self::Hint(text) | Self::Warning(text) | Self::Wrong(text) => text,
        }
    }
}

/// A list to choose from, bound to a signal. `options` are values with their labels.
pub(crate) fn choice(
    id: &'static str,
    value: RwSignal<String>,
    options: impl Fn() -> Vec<(String, String)> + 'static,
) -> El {
    choice_boxed(id, value, Box::new(options))
}

fn choice_boxed(id: &'static str, value: RwSignal<String>, options: Box<dyn Fn() -> Vec<(String, String)>>) -> El {
    list(id, value, Box::new(move || options().into_iter().map(|(key, label)| option(&key, &label)).collect()))
}

/// One option of a list.
pub(crate) fn option(key: &str, label: &str) -> El {
    el("option").attr("value", key).text(label)
}

/// As [`choice`], for options in groups.
pub(crate) fn list(id: &'static str, value: RwSignal<String>, options: Box<dyn Fn() -> Vec<El>>) -> El {
    let shown = RwSignal::new(0_u32);
    el("select")
        .attr("id", id)
        .test(id)
        .attr("aria-describedby", &note_id(id))
        .live(move || {
            shown.update(|turn| *turn = turn.wrapping_add(1));
            options()
        })
        .live_value(move || {
            // New options forget what was chosen.
            shown.track();
            value.get()
        })
        .on("change", move |event| value.set(crate::dom::value(&event)))
}

/// A number to type, bound to a signal.
pub(crate) fn number(
    id: &'static str,
    value: RwSignal<String>,
    unit: &str,
    is_wrong: impl Fn() -> bool + 'static,
) -> El {
    let input = entry("input", id, value, is_wrong).attr("type", "text").attr("inputmode", "numeric");
    el("span").class("with-suffix").child(input).child(el("span").class("suffix").text(unit))
}

/// A bare `input` or `textarea` for anything typed, bound to a signal.
pub(crate) fn entry(tag: &str, id: &'static str, value: RwSignal<String>, is_wrong: impl Fn() -> bool + 'static) -> El {
    el(tag)
        .attr("id", id)
        .test(id)
        .attr("autocomplete", "off")
        .attr("autocapitalize", "off")
        .attr("spellcheck", "false")
        .attr("aria-describedby", &note_id(id))
        .live_attr("aria-invalid", move || is_wrong().then(|| "true".to_owned()))
        .bind("input", value)
}

fn note_id(id: &str) -> String {
    [id, "-note"].concat()
}
