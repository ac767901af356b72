//! What stands beside the log: the chosen frame, counts, snippets, sequences.

use buslens_analyst::message::Tally;

use super::kept::snippets_pane;
use super::sequence::sequence_pane;
use crate::components::desk::NOTHING;
use crate::components::desk::detail::detail;
use crate::components::desk::tools::statistics;
use crate::components::icon::{Icon, icon};
use crate::components::tabs::{place, tab_id, tabs};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// The panes by their keys, in order.
pub(super) const PANES: [(&str, Label); 4] = [
    ("frame", Language::pane_frame),
    ("counts", Language::statistics),
    ("snippets", Language::pane_snippets),
    ("sequence", Language::pane_sequence),
];

/// The id of what the tabs show.
const PANEL: &str = "console-pane";

/// The panes; one of them is open.
pub(super) fn panes(app: &'static Workbench) -> El {
    let console = &app.console;
    let open = Memo::new(move |_| place(&PANES, &console.tab.get()));
    let content = move || {
        Some(match open.get() {
            0 => frame_pane(app),
            1 => el("div").class("contents").child(statistics(app, &console.desk)).child(counts_empty(app)),
            2 => snippets_pane(app),
            _ => sequence_pane(app),
        })
    };
    el("section").class("card panes").child(tabs(app, Language::panes, "pane-", PANEL, &PANES, console.tab)).child(
        el("div")
            .class("pane")
            .attr("id", PANEL)
            .attr("role", "tabpanel")
            .live_attr("aria-labelledby", move || PANES.get(open.get()).map(|(key, _)| tab_id(PANEL, key)))
            .live_one(content),
    )
}

fn frame_pane(app: &'static Workbench) -> El {
    let desk = &app.console.desk;
    let chosen = Memo::new(move |_| {
        let chosen = desk.chosen.get();
        chosen != NOTHING && desk.progress.with(|progress| progress.shown > 0)
    });
    el("div").class("contents").live_one(move || {
        Some(if chosen.get() {
            detail(app, desk)
        } else {
            el("div").class("pane-empty").child(icon(Icon::Info)).child(el("p").say(app, Language::choose_row))
        })
    })
}

fn counts_empty(app: &'static Workbench) -> El {
    let none = Memo::new(move |_| {
        let statistics = app.console.desk.statistics;
        statistics.with(|all| all.as_ref().is_none_or(|all| all.total == Tally::default()))
    });
    el("div").class("contents").live_one(move || {
        none.get().then(|| el("div").class("pane-empty").child(el("p").say(app, Language::counts_none)))
    })
}

/// Moves the focus to an element that is about to be drawn.
pub(super) fn focus_soon(id: &'static str) {
    request_animation_frame(move || {
        dom::focus(id);
    });
}
