//! The builder's form, opened over the console.

use crate::components::button::{bare, button};
use crate::dom::{El, el};
use crate::pages::builder_bench;
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// The dialog: the builder's form, the frame, and buttons that send it or put it into the send line.
pub(super) fn builder_dialog(app: &'static Workbench) -> El {
    let console = &app.console;
    let close = move || {
        console.builder_open.set(false);
        super::panes::focus_soon(super::send::LINE);
    };
    let bench = builder_bench(app);
    let frame = bench.frame;
    let mode = move || console.mode();
    let send = button(app, "primary", "builder-send", Language::send_at_console)
        .flag("disabled", move || !console.is_open() || frame.get(mode()).is_none())
        .click(move || {
            if let Some(bytes) = frame.get(mode()) {
                console.dock.send_once(console, bytes, mode());
                close();
            }
        });
    super::panes::focus_soon("builder-close");
    el("div")
        .class("overlay")
        .child(bare("overlay-back", "builder-back").attr("tabindex", "-1").label(app, Language::close).click(close))
        .child(
            el("section")
                .class("card dialog builder")
                .attr("role", "dialog")
                .attr("aria-modal", "true")
                .label(app, Language::builder_title)
                .test("builder-dialog")
                .child(el("header").child(el("span").class("space")).child(send).child(
                    button(app, "small", "builder-close", Language::close).attr("id", "builder-close").click(close),
                ))
                .children(bench.cards),
        )
}
