//! A row of tabs, one of them chosen, moved along by the arrow keys.

use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Label;
use crate::workbench::Workbench;

/// The tabs, each with its key and its name, under a label for those who cannot see them. `hook` stands before the keys for
/// tests; `panel` is the id of what they show.
pub(crate) fn tabs(
    app: &'static Workbench,
    label: Label,
    hook: &'static str,
    panel: &'static str,
    all: &'static [(&'static str, Label)],
    chosen: RwSignal<String>,
) -> El {
    let open = Memo::new(move |_| place(all, &chosen.get()));
    let tab = |(at, &(key, text)): (usize, &(&'static str, Label))| {
        el("button")
            .attr("type", "button")
            .attr("role", "tab")
            .attr("id", &tab_id(panel, key))
            .attr("aria-controls", panel)
            .test(&[hook, key].concat())
            .state("aria-selected", move || open.get() == at)
            .live_attr("tabindex", move || Some(if open.get() == at { "0" } else { "-1" }.to_owned()))
            .click(move || chosen.set(key.to_owned()))
            .say(app, text)
    };
    el("div").class("pane-tabs").attr("role", "tablist").label(app, label).children(all.iter().enumerate().map(tab)).on(
        "keydown",
        move |event| {
            let (now, last) = (open.get_untracked(), all.len().saturating_sub(1));
            let next = match dom::key(&event).as_str() {
                "ArrowRight" if now == last => 0,
                "ArrowRight" => now + 1,
                "ArrowLeft" => now.checked_sub(1).unwrap_or(last),
                _ => return,
            };
            if let Some((key, _)) = all.get(next) {
                event.prevent_default();
                chosen.set((*key).to_owned());
                dom::focus(&tab_id(panel, key));
            }
        },
    )
}

/// The place of the tab with a key; the first one for any other text.
pub(crate) fn place(all: &[(&str, Label)], key: &str) -> usize {
    all.iter().position(|(known, _)| *known == key).unwrap_or(0)
}

/// The id of a tab's button.
pub(crate) fn tab_id(panel: &str, key: &str) -> String {
    [panel, "-", key].concat()
}
