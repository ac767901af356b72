//! The calculator: checks of any bytes.

use buslens_analyst::message::{Sums, ToAnalyst};

use crate::reactive::prelude::*;

use super::copy_button;
use super::words::bytes_fault;
use crate::analyst::Analyst;
use crate::builder::point;
use crate::components::field::entry;
use crate::components::icon::{Icon, icon};
use crate::dom::{El, el, react};
use crate::format::{hex, hex_spaced};
use crate::storage::kept;
use crate::text::Language;
use crate::workbench::Workbench;

/// The card.
pub(super) fn calculator_card(app: &'static Workbench) -> El {
    const ID: &str = "calculator-input";
    let typed = kept("calculator", "");
    app.start_analyst();
    react(move || Analyst::Decoder.send(&ToAnalyst::Sums(typed.get())));
    let area = entry("textarea", ID, typed, move || app.sums.with(|summed| matches!(summed, Some((_, Err(_))))))
        .attr("rows", "3")
        .live_attr("placeholder", move || Some(app.language.get().calculator_placeholder().to_owned()));
    let results = move || {
        let summed = app.sums.get();
        vec![match summed.map(|(_, sums)| sums) {
            Some(Err(error)) => {
                let text = bytes_fault(app.language.get(), error);
                let line = el("p").class("parse-error").attr("role", "alert").test("calculator-error");
                line.child(icon(Icon::Fault)).child(el("span").text(&text))
            }
            None | Some(Ok(None)) => el("p").class("empty").say(app, Language::calculator_empty),
            Some(Ok(Some(sums))) => results(app, &sums),
        }]
    };
    el("section")
        .class("card calculator input")
        .child(el("header").child(el("h2").say(app, Language::calculator)))
        .child(el("label").class("visually-hidden").attr("for", ID).say(app, Language::calculator_input))
        .child(area)
        .child(el("div").class("sums").attr("id", "calculator-input-note").live(results))
}

fn results(app: &'static Workbench, sums: &Sums) -> El {
    let language = app.language.get();
    let wire = hex_spaced(&sums.crc.to_le_bytes());
    let lrc = hex(sums.lrc);
    let tag = |test: &str, right: bool, yes: &str, no: &str| {
        let (class, text) = if right { ("tag ok", yes) } else { ("tag", no) };
        el("span").class(class).test(test).text(text)
    };
    let row = |name: &str, value: Vec<El>| el("div").child(el("dt").text(name)).child(el("dd").children(value));
    let figure = |test: &str, text: &str| el("b").attr("id", test).test(test).text(text);
    let crc = vec![
        figure("sum-crc", &wire),
        el("small").class("muted").text(language.on_the_wire()),
        el("span").class("mono muted").test("sum-crc-value").text(&point::hex(sums.crc)),
        copy_button(app, "copy-crc", "sum-crc".to_owned(), wire.clone()),
        tag("ends-with-crc", sums.ends_with_crc, language.ends_with_crc(), language.ends_without_crc()),
    ];
    let lrc = vec![
        figure("sum-lrc", &lrc),
        copy_button(app, "copy-lrc", "sum-lrc".to_owned(), lrc.clone()),
        tag("ends-with-lrc", sums.ends_with_lrc, language.ends_with_lrc(), language.ends_without_lrc()),
    ];
    el("dl")
        .child(row(language.byte_count(), vec![figure("sum-count", &sums.count.to_string())]))
        .child(row("CRC-16/Modbus", crc))
        .child(row("LRC", lrc))
}
