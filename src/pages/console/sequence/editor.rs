//! The text, with the numbers of its lines, its faults, and how the steps of the last run went.

use std::collections::BTreeMap;

use buslens_sequence::Mark;

use super::words;
use crate::components::button::{bare, button};
use crate::components::icon::{Icon, icon};
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
    let lines = Memo::new(move |_| sequences.text.with(|text| text.matches('\n').count() + 1));
    let marks = Memo::new(move |_| marks(app));
    let gutter = el("ol").class("seq-numbers").attr("aria-hidden", "true").live(move || {
        let number = |at: usize| {
            let line = u32::try_from(at).unwrap_or(u32::MAX);
            let number = el("li").text(&at.to_string());
            match marks.with(|marks| marks.get(&line).copied()) {
                Some(mark) => number.attr("data-mark", mark),
                None => number,
            }
        };
        (1..=lines.get()).map(number).collect()
    });
    let field = el("textarea")
        .attr("id", FIELD)
        .test(FIELD)
        .label(app, Language::seq_editor)
        .attr("wrap", "off")
        .attr("spellcheck", "false")
        .attr("autocapitalize", "off")
        .attr("autocomplete", "off")
        .attr("aria-describedby", "sequence-faults")
        .live_attr("rows", move || Some((lines.get() + 1).to_string()))
        .flag("readonly", move || sequences.is_ready_made())
        .live_value(move || sequences.text.get())
        .on("input", move |event| sequences.type_text(dom::value(&event)))
        .on("keydown", move |event| {
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
        .child(el("div").class("seq-text").child(el("div").class("seq-sheet").child(gutter).child(field)))
        .child(faults(app))
}

/// How each line stands: its fault, else how its step went in the last run of this text.
fn marks(app: &'static Workbench) -> BTreeMap<u32, &'static str> {
    let sequences = &app.console.sequences;
    let mut marks = BTreeMap::new();
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
                        .click(move || go_to(app, line, column))
                };
                std::iter::once(head).chain(checked.faults.iter().take(MOST_FAULTS).map(fault)).collect()
            }
        })
    };
    el("div")
        .class("seq-faults")
        .attr("id", "sequence-faults")
        .test("sequence-faults")
        .attr("aria-live", "polite")
        .live(content)
}

/// Puts the cursor to a place, counted in lines and characters from 1.
fn go_to(app: &'static Workbench, line: u32, column: u32) {
    let at = app.console.sequences.text.with_untracked(|text| place(text, line, column));
    dom::select(FIELD, at);
}

/// A place in UTF-16 units from the beginning, as browsers count.
fn place(text: &str, line: u32, column: u32) -> u32 {
    let skipped = usize::try_from(line.saturating_sub(1)).unwrap_or(usize::MAX);
    let units = |text: &str| text.encode_utf16().count();
    let before: usize = text.split('\n').take(skipped).map(|line| units(line) + 1).sum();
    let own = text.split('\n').nth(skipped).unwrap_or_default();
    let within: usize =
        own.chars().take(usize::try_from(column.saturating_sub(1)).unwrap_or(usize::MAX)).map(char::len_utf16).sum();
    u32::try_from(before + within).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_counted_as_browsers_do() {
        let text = "ab\n\u{1F600}温x\n\nz";
        let places = [(1, 1), (1, 3), (2, 1), (2, 2), (2, 4), (4, 1)].map(|(line, column)| place(text, line, column));
        assert_eq!(places, [0, 2, 3, 5, 7, 9]);
        // Beyond the end of the line it is the end.
        assert_eq!(place("ab", 1, 99), 2);
    }
}
