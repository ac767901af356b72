//! The labels of a series, as they will be printed.

use super::{day, series};
use crate::components::field::choice;
use crate::dom::{El, el};
use crate::fleet::labels::{SIZES, Tag, tags};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// Whether there is nothing to be printed.
pub(super) fn none(app: &'static Workbench) -> bool {
    app.fleet.series.with(|series| series.as_ref().is_none_or(|series| series.counts().done == 0))
}

/// Opens the browser's print dialog: the style sheet leaves only the labels.
pub(super) fn print() {
    // A browser that cannot print has no dialog.
    let _ = window().print();
}

/// The card; an empty box while there is nothing to be printed.
pub(super) fn labels_card(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let empty = Memo::new(move |_| none(app));
    let size =
        Memo::new(move |_| fleet.size.with(|key| SIZES.iter().find(|size| size.key == key).unwrap_or(&SIZES[0]).key));
    el("div").class("contents").live_one(move || {
        if empty.get() {
            return None;
        }
        let options = move || {
            let language = app.language.get();
            SIZES.iter().map(|size| (size.key.to_owned(), (size.text)(language).to_owned())).collect()
        };
        Some(
            el("section")
                .class("card fleet-labels-card")
                .test("labels")
                .child(
                    el("header")
                        .child(el("h2").say(app, Language::fleet_labels))
                        .child(el("span").class("space"))
                        .child(el("label").class("muted").attr("for", "label-size").say(app, Language::fleet_size))
                        .child(choice("label-size", fleet.size, options)),
                )
                .live_one(move || sheet(app, size.get())),
        )
    })
}

fn sheet(app: &'static Workbench, size: &str) -> Option<El> {
    let language = app.language.get();
    let device = app.fleet.device(app)?;
    let all = app.fleet.series.with(|series| series.as_ref().map(|series| tags(language, device.profile(), series)))?;
    let name = device.name(language);
    let head = el("p").class("label-head").text(&[name, " \u{B7} ", &day(language, series::begun(app))].concat());
    let labels = all.iter().map(|tag| label(language, name, tag));
    Some(
        el("div")
            .class("labels")
            .attr("data-size", size)
            .child(head)
            .child(el("ol").class("label-list").children(labels)),
    )
}

fn label(language: Language, device: &str, tag: &Tag) -> El {
    let title = if tag.name.is_empty() { device } else { &tag.name };
    el("li")
        .class("label")
        .test("label")
        .child(
            el("p")
                .class("label-unit")
                .child(el("small").text(language.fleet_unit_id()))
                .child(el("b").text(&tag.unit)),
        )
        .child(
            el("div")
                .class("label-words")
                .child(el("b").text(title))
                .children((!tag.name.is_empty()).then(|| el("span").text(device)))
                .child(el("span").text(&tag.line))
                .children((!tag.settings.is_empty()).then(|| el("span").text(&tag.settings.join(" \u{B7} "))))
                .child(el("span").text(&day(language, tag.unix_ms))),
        )
}
