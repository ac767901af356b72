//! A long text to be edited, with the numbers of its lines and what is to be known of each.

use std::collections::BTreeMap;

use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Label;
use crate::workbench::Workbench;

/// Marks by the numbers of their lines, counted from 1: the styles know `fault`, `passed`, `failed`, `running`.
pub(crate) type Marks = BTreeMap<u32, &'static str>;

/// The sheet. Its field has the id `hook`, and is described by the element `hook` with `-faults` behind it.
pub(crate) fn sheet(
    app: &'static Workbench,
    hook: &'static str,
    label: Label,
    text: Memo<String>,
    marks: Memo<Marks>,
    is_fixed: impl Fn() -> bool + 'static,
    take: impl Fn(String) + 'static,
) -> El {
    let lines = Memo::new(move |_| text.with(|text| text.matches('\n').count() + 1));
    let gutter =
        el("ol").class("sheet-numbers").attr("id", &lines_id(hook)).attr("aria-hidden", "true").live(move || {
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
        .attr("id", hook)
        .test(hook)
        .label(app, label)
        .attr("wrap", "off")
        .attr("spellcheck", "false")
        .attr("autocapitalize", "off")
        .attr("autocomplete", "off")
        .attr("aria-describedby", &[hook, "-faults"].concat())
        .live_attr("rows", move || Some((lines.get() + 1).to_string()))
        .flag("readonly", is_fixed)
        .live_value(move || text.get())
        .on("input", move |event| take(dom::value(&event)));
    el("div").class("sheet").child(el("div").class("sheet-lines").child(gutter).child(field))
}

/// Puts the cursor of the sheet's field to a place in its text, counted in lines and characters from 1.
pub(crate) fn go_to(hook: &str, text: &str, line: u32, column: u32) {
    dom::select(hook, place(text, line, column));
    // The field itself does not scroll: what is around it does.
    dom::reveal(&lines_id(hook), &["li:nth-child(", &line.to_string(), ")"].concat());
}

fn lines_id(hook: &str) -> String {
    [hook, "-lines"].concat()
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
