//! The frame in the spellings of programs, each to be copied.

use crate::reactive::prelude::*;
use buslens_codec::line::Mode;

use super::form::Form;
use super::{Built, Label, MODES, copy_button, tabs};
use crate::builder::spell::Spelling;
use crate::dom::{El, el};
use crate::text::Language;
use crate::workbench::Workbench;

/// The card.
pub(super) fn spellings_card(app: &'static Workbench, form: Form, built: Memo<Built>) -> El {
    let header = el("header").child(el("h2").say(app, Language::copy_as)).child(el("span").class("space")).child(tabs(
        app,
        Language::mode,
        "spelled",
        form.spelled,
        &MODES,
    ));
    let rows = move || {
        let mode = if form.spelled.with(|mode| mode == "ascii") { Mode::Ascii } else { Mode::Rtu };
        built.with(|built| {
            let Some(frames) = &built.frames else {
                return vec![el("p").class("empty").say(app, Language::frame_incomplete)];
            };
            let shown =
                Spelling::ALL.into_iter().filter(|spelling| mode == Mode::Ascii || *spelling != Spelling::Characters);
            shown.map(|spelling| row(app, spelling, spelling.spell(frames.frame(mode)))).collect()
        })
    };
    el("section").class("card spellings").child(header).child(el("div").class("spelling-rows").live(rows))
}

fn row(app: &'static Workbench, spelling: Spelling, text: String) -> El {
    let (key, name) = named(spelling);
    let id = ["spelling-", key].concat();
    let shown = el("code").attr("id", &id).test(&id).text(&text);
    let button = copy_button(app, &["copy-", key].concat(), id, text);
    let button = button.live_attr("aria-label", move || {
        let language = app.language.get();
        Some(language.copy_spelling(name(language)))
    });
    el("div").class("spelling").child(el("span").class("muted").say(app, name)).child(shown).child(button)
}

fn named(spelling: Spelling) -> (&'static str, Label) {
    match spelling {
        Spelling::Spaced => ("spaced", Language::spelling_spaced),
        Spelling::Plain => ("plain", Language::spelling_plain),
        Spelling::C => ("c", Language::spelling_c),
        Spelling::Python => ("python", Language::spelling_python),
        Spelling::Rust => ("rust", Language::spelling_rust),
        Spelling::Escaped => ("escaped", Language::spelling_escaped),
        Spelling::Decimal => ("decimal", Language::spelling_decimal),
        Spelling::Characters => ("characters", Language::spelling_text),
    }
}
