//! The chosen frame taken apart: bytes, fields, what is wrong, what its registers could mean.

use buslens_analyst::message::{Look, Row, ToAnalyst};
use buslens_codec::dissect::Direction;

use super::{Desk, NOTHING, Opened};
use crate::anatomy::Anatomy;
use crate::clipboard;
use crate::components::button::{button, menu};
use crate::components::bytes::{byte_groups, lights};
use crate::components::icon::{Icon, icon};
use crate::device::Device;
use crate::diagnosis::{self, Case, Severity, Told};
use crate::dom::{El, el};
use crate::format::{self, hex_spaced};
use crate::reactive::prelude::*;
use crate::route::decoder_link;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// The card of the chosen row, if there is one.
pub(crate) fn detail(app: &'static Workbench, desk: &'static Desk) -> El {
    let row = Memo::new(move |_| {
        desk.turn.track();
        let shown = desk.progress.with(|progress| progress.shown);
        let chosen = Some(desk.chosen.get()).filter(|chosen| *chosen != NOTHING)?;
        desk.row(chosen.min(shown.checked_sub(1)?))
    });
    crate::dom::react(move || {
        if let Some(index) = row.with(|row| row.as_ref().map(|row| row.index)) {
            desk.analyst.send(&ToAnalyst::Look { index, shown: desk.shown.get() });
        }
    });
    el("div").class("contents").live_one(move || row.with(|row| row.as_ref().map(|row| card(app, desk, row))))
}

fn card(app: &'static Workbench, desk: &'static Desk, row: &Row) -> El {
    let language = app.language.get();
    let profile = desk.device().map(Device::profile);
    let Opened { request, dissection } = Opened::of(profile, row);
    let (request, dissection) = (request.as_ref(), dissection.as_ref());
    let found = Anatomy::of_dissection(language, profile, &row.bytes, row.mode, request, dissection);
    let lit = RwSignal::new(None);
    let place = if row.line > 0 { language.line_number(row.line) } else { String::new() };
    let offset = language.offset_is(&format::count(row.offset));
    let pair = row.pair;
    let header = el("header")
        .child(el("h2").say(app, Language::selected_frame))
        .child(
            el("span")
                .class("muted")
                .text(&[place.as_str(), if place.is_empty() { "" } else { " · " }, &offset].concat()),
        )
        .child(el("span").class("space"))
        .children(
            pair.map(|pair| button(app, "quiet small", "to-pair", Language::to_pair).click(move || desk.go_to(pair))),
        )
        .child(copy_menu(app, desk, row, &found));
    let case = Case { profile, frame: &row.bytes, mode: row.mode, dissection, request };
    let told: Vec<Told> = row.diagnoses.iter().map(|found| diagnosis::told(language, &case, found)).collect();
    let hint = || {
        let text = el("span").say(app, Language::reply_needs_request);
        el("p").class("note-line").child(icon(Icon::Info)).child(text)
    };
    el("section")
        .class("card detail")
        .test("detail")
        .child(header)
        .children((!told.is_empty()).then(|| diagnoses(app, &told)))
        .child(byte_groups(&found, lit))
        .children(found.lacks_request().then(hint))
        .child(fields(app, &found, lit))
        .child(views(app, desk, row.index))
}

fn fields(app: &'static Workbench, found: &Anatomy, lit: RwSignal<Option<usize>>) -> El {
    let rows = found.parts.iter().enumerate().map(|(number, part)| {
        let texts: Vec<String> = part.range.clone().map(|at| found.byte_text(at)).collect();
        let row = el("tr").test("field-row").attr("data-kind", part.kind);
        lights(row, number, lit)
            .child(el("td").child(el("i").class("swatch")).text(&part.name))
            .child(el("td").class("mono").text(&texts.join(" ")))
            .child(el("td").class("part-value").text(&part.value))
            .child(el("td").class("muted").text(&part.meaning).children(part.bits.as_ref().map(|bits| bit_row(bits))))
    });
    let heads = [Language::field as Label, Language::bytes, Language::value, Language::meaning];
    let heads = heads.into_iter().map(|text| el("th").say(app, text));
    let head = el("thead").child(el("tr").children(heads));
    let table = el("table").class("fields-table").child(head).child(el("tbody").children(rows));
    el("div").class("scroll").child(table)
}

/// Bits as boxes, the highest first.
fn bit_row(bits: &[crate::anatomy::Bit]) -> El {
    let boxes = bits.iter().map(|bit| {
        let class = if bit.on { "bit on" } else { "bit" };
        el("span")
            .class(class)
            .attr("title", &bit.label)
            .child(el("b").text(if bit.on { "1" } else { "0" }))
            .child(el("small").text(&bit.label))
    });
    el("div").class("bits").children(boxes)
}

fn diagnoses(app: &'static Workbench, told: &[Told]) -> El {
    let items = told.iter().map(|told| {
        let (class, mark) = match told.severity {
            Severity::Fault => ("told fault", Icon::Fault),
            Severity::Warning => ("told warning", Icon::Fault),
            Severity::Info => ("told", Icon::Info),
        };
        let mut body = el("div").child(el("b").text(&told.title)).child(el("p").text(&told.what));
        if let Some(repaired) = &told.repaired {
            let link = el("a")
                .class("button quiet small")
                .test("take-repaired")
                .attr("href", &decoder_link(&[repaired]))
                .say(app, Language::take_repaired);
            body = body.child(
                el("p")
                    .class("repaired")
                    .child(el("span").class("muted").say(app, Language::repaired_frame))
                    .child(el("code").text(&hex_spaced(repaired)))
                    .child(link),
            );
        }
        el("li").class(class).test("diagnosis").attr("data-id", told.id).child(icon(mark)).child(body)
    });
    el("ul").class("diagnoses").label(app, Language::diagnosis).children(items)
}

fn copy_menu(app: &'static Workbench, desk: &'static Desk, row: &Row, found: &Anatomy) -> El {
    let item = |hook: &str, text: Label, content: String| {
        button(app, "quiet small", hook, text).click(move || clipboard::write(&content, |_| ()))
    };
    let index = row.index;
    let json = button(app, "quiet small", "copy-json", Language::copy_json).click(move || {
        let json = desk
            .look
            .with_untracked(|look| look.as_ref().filter(|look| look.index == index).map(|look| look.json.clone()));
        if let Some(json) = json {
            clipboard::write(&json, |_| ());
        }
    });
    let items = vec![
        item("copy-hex", Language::copy_hex, hex_spaced(&row.bytes)),
        item("copy-c", Language::copy_c, format::c_array(&row.bytes)),
        json,
        item("copy-markdown", Language::copy_markdown, markdown(app, row, found)),
    ];
    menu(app, "copy", Language::copy, items)
}

/// A table of the fields, for an issue or a mail.
fn markdown(app: &'static Workbench, row: &Row, found: &Anatomy) -> String {
    let language = app.language.get_untracked();
    let direction = match row.direction {
        Direction::Request => "TX ",
        Direction::Response => "RX ",
        Direction::Unknown => "",
    };
    let mut text = ["`", direction, &hex_spaced(&row.bytes), "`\n\n"].concat();
    let mut line = |cells: [&str; 4]| {
        for cell in cells {
            text.push_str("| ");
            text.push_str(&cell.replace('|', "\\|").replace('\n', " "));
            text.push(' ');
        }
        text.push_str("|\n");
    };
    line([language.field(), language.bytes(), language.value(), language.meaning()]);
    line(["---", "---", "---", "---"]);
    for part in &found.parts {
        let bytes: Vec<String> = part.range.clone().map(|at| found.byte_text(at)).collect();
        line([&part.name, &bytes.join(" "), &part.value, &part.meaning]);
    }
    text
}

/// Every reading of the registers, and what would show a number.
fn views(app: &'static Workbench, desk: &'static Desk, index: u32) -> El {
    let look = Memo::new(move |_| {
        desk.look.with(|look| look.clone().filter(|look| look.index == index && !look.views.is_empty()))
    });
    let there = Memo::new(move |_| look.with(Option::is_some));
    el("div").class("contents").live_one(move || there.get().then(|| view_box(app, desk, look)))
}

fn view_box(app: &'static Workbench, desk: &'static Desk, look: Memo<Option<Look>>) -> El {
    let input = el("input")
        .attr("id", "shown-value")
        .attr("inputmode", "decimal")
        .attr("autocomplete", "off")
        .attr("placeholder", "123.456")
        .test("shown-value")
        .bind("input", desk.shown);
    let ask = el("div")
        .class("shown-row")
        .child(el("label").attr("for", "shown-value").say(app, Language::shown_label))
        .child(input)
        .child(el("span").class("muted").say(app, Language::shown_hint));
    el("details")
        .class("views")
        .live_attr("open", move || desk.views_open.get().then(String::new))
        .on("toggle", move |event| desk.views_open.set(crate::dom::is_open(&event)))
        .child(el("summary").test("views").say(app, Language::registers_views))
        .child(ask)
        .live(move || look.with(|look| look.as_ref().map(|look| fit_lines(app, desk, look)).unwrap_or_default()))
        .live(move || look.with(|look| look.as_ref().map(|look| view_tables(app, look)).unwrap_or_default()))
}

fn fit_lines(app: &'static Workbench, desk: &'static Desk, look: &Look) -> Vec<El> {
    let language = app.language.get();
    if desk.shown.with_untracked(|shown| shown.trim().is_empty()) {
        return Vec::new();
    }
    let note = |text: &str| vec![el("p").class("form-line muted").test("fits-none").text(text)];
    if !look.understood {
        return note(language.shown_not_number());
    }
    if look.fits.is_empty() {
        return note(language.fits_none());
    }
    let rows = look.fits.iter().map(|fit| {
        el("tr")
            .test("fit-row")
            .child(el("td").class("mono").text(&fit.name))
            .child(el("td").class("number").text(&fit.decimals.to_string()))
            .child(el("td").text(&language.nth_register(fit.offset + 1)))
    });
    let heads = [("", Language::encoding as Label), ("number", Language::decimals), ("", Language::first_register)];
    let heads = heads.into_iter().map(|(class, text)| el("th").class(class).text(text(language)));
    let head = el("thead").child(el("tr").children(heads));
    vec![el("div").class("scroll").child(el("table").class("fits").child(head).child(el("tbody").children(rows)))]
}

fn view_tables(app: &'static Workbench, look: &Look) -> Vec<El> {
    let language = app.language.get();
    let block = |register: &buslens_analyst::message::RegisterViews| {
        let cells = register.views.iter().map(|view| {
            el("div")
                .class("view")
                .child(el("small").class("muted").text(&view.name))
                .child(el("span").class("mono").text(&view.text))
        });
        el("div")
            .class("view-block")
            .child(el("h3").text(&language.nth_register(register.offset + 1)))
            .child(el("div").class("view-grid").children(cells))
    };
    look.views.iter().map(block).collect()
}
