//! The text, with the numbers of its lines, its faults, and how the steps of the last run went.

use buslens_sequence::Mark;

use super::words;
use crate::components::button::{bare, button};
use crate::components::icon::{Icon, icon};
use crate::components::sheet::{self, Marks, sheet};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// The id of the field.
const FIELD: &str = "sequence-text";
/// Faults that are listed.
const MOST_FAULTS: usize = 20;

/// The text and what is wrong with it.
pub(super) fn editor(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    let marks = Memo::new(move |_| marks(app));
    let text = Memo::new(move |_| sequences.text.get());
    let is_fixed = move || sequences.is_ready_made();
    let sheet = sheet(app, FIELD, Language::seq_editor, text, marks, is_fixed, move |typed| sequences.type_text(typed));
    let sheet = sheet.on("keydown", move |event| {
        if dom::key(&event) == "Enter" && dom::is_commanded(&event) {
            event.prevent_default();
            super::run(app);
        }
    });
    el("div")
        .class("contents")
        .live_one(move || {
            sequences.is_ready_made().then(|| {
                let copy =
                    button(app, "small", "sequence-copy", Language::seq_duplicate).click(move || sequences.duplicate());
                el("p").class("seq-hint").attr("data-kind", "info").say(app, Language::seq_fixed).child(copy)
            })
        })
        .child(sheet)
        .child(faults(app))
}

/// How each line stands: its fault, else how its step went in the last run of this text.
fn marks(app: &'static Workbench) -> Marks {
    let sequences = &app.console.sequences;
    let mut marks = Marks::new();
    let is_text_that_ran =
        sequences.ran.with(|ran| ran.as_ref().is_some_and(|ran| sequences.text.with(|text| *text == ran.text)));
    if is_text_that_ran {
        sequences.turn.track();
        sequences.report.with_value(|report| {
            for entry in &report.entries {
                let mark = match entry.mark {
                    Mark::Running => "running",
                    Mark::Passed => "passed",
                    Mark::Failed => "failed",
                    Mark::Skipped => continue,
                };
                // A step that has failed once has failed.
                if marks.get(&entry.line) != Some(&"failed") {
                    marks.insert(entry.line, mark);
                }
            }
        });
    }
    sequences.checked.with(|checked| {
        for fault in checked.iter().flat_map(|checked| &checked.faults) {
            marks.insert(fault.line, "fault");
        }
    });
    marks
}

/// The faults; a click on one leads to its place.
fn faults(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    let content = move || {
        let language = app.language.get();
        sequences.checked.with(|checked| match checked {
            None => vec![el("p").class("seq-checked muted").text(language.seq_checking())],
            Some(checked) if checked.faults.is_empty() => {
                vec![el("p").class("seq-checked ok").test("sequence-right").text(language.seq_right())]
            }
            Some(checked) => {
                let told = language.seq_fault_count(checked.faults.len());
                let head = el("p").class("seq-checked bad").test("sequence-faults-head").text(&told);
                let fault = |fault: &buslens_sequence::Fault| {
                    let (line, column) = (fault.line, fault.column);
                    let text = language.seq_fault(line, column, &words::fault(language, &fault.kind));
                    bare("quiet small seq-fault", "sequence-fault")
                        .child(icon(Icon::Fault))
                        .child(el("span").text(&text))
                        .click(move || sequences.text.with_untracked(|text| sheet::go_to(FIELD, text, line, column)))
                };
                std::iter::once(head).chain(checked.faults.iter().take(MOST_FAULTS).map(fault)).collect()
            }
        })
    };
    el("div")
        .class("seq-faults")
        .attr("id", "sequence-text-faults")
        .test("sequence-faults")
        .attr("aria-live", "polite")
        .live(content)
}
