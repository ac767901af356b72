//! Above the list: whose registers they are, what is shown, files of the list; below it: counts.

use buslens_analyst::message::{Filter, Format, Statistics, Tally, ToAnalyst};

use super::desk::{AUTO, NO_PROFILE};
use crate::analyst;
use crate::clipboard;
use crate::components::button::{bare, button, menu};
use crate::device;
use crate::dom::{self, El, el};
use crate::format;
use crate::reactive::prelude::*;
use crate::route;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// The longest text in characters that a link holds; browsers and mail programs cut longer ones.
const LONGEST_LINK: usize = 8000;

/// The head of the list's card.
pub(super) fn tools(app: &'static Workbench) -> [El; 2] {
    let desk = &app.decoder;
    let counts = move || {
        let (shown, all) = desk.progress.with(|progress| (progress.shown, progress.entries));
        let text = |number: u32| format::count(number.into());
        if shown == all { text(all) } else { app.language.get().shown_of(&text(shown), &text(all)) }
    };
    let header = el("header")
        .child(el("h2").say(app, Language::frames))
        .child(el("span").class("muted").test("frame-count").live_text(counts))
        .child(el("span").class("space"))
        .child(link_button(app))
        .child(export_menu(app));
    [header, filter_bar(app)]
}

fn filter_bar(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    dom::react(move || {
        desk.profile.track();
        if desk.is_started() {
            desk.send_profile();
        }
    });
    let mut before = Filter::default();
    dom::react(move || {
        let filter = desk.filter();
        if filter != before {
            before = filter;
            desk.chosen.set(0);
            desk.send_filter();
        }
    });
    let input = |class: &str, hook: &'static str, label: Label, value: RwSignal<String>| {
        el("input")
            .class(class)
            .attr("autocomplete", "off")
            .attr("spellcheck", "false")
            .test(hook)
            .label(app, label)
            .live_attr("placeholder", move || Some(label(app.language.get()).to_owned()))
            .bind("input", value)
    };
    let errors = bare("small toggle", "filter-errors")
        .state("aria-pressed", move || desk.errors_only.get())
        .say(app, Language::filter_errors)
        .click(move || desk.errors_only.update(|on| *on = !*on));
    let filtered = Memo::new(move |_| desk.filter() != Filter::default());
    let clear =
        move || button(app, "quiet small", "clear-filter", Language::clear_filter).click(move || desk.clear_filter());
    el("div")
        .class("filters")
        .child(profile_select(app))
        .child(input("short", "filter-unit", Language::filter_unit, desk.unit))
        .child(input("short", "filter-function", Language::filter_function, desk.function))
        .child(input("grow", "filter-text", Language::filter_text, desk.text))
        .child(errors)
        .live_one(move || filtered.get().then(clear))
}

fn profile_select(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    el("select")
        .attr("id", "decoder-profile")
        .test("decoder-profile")
        .label(app, Language::profile)
        .live(move || {
            let language = app.language.get();
            let found = desk.device().filter(|_| desk.profile.with(|id| id == AUTO));
            let auto = found.map_or_else(
                || language.profile_auto().to_owned(),
                |device| language.profile_auto_is(device.name(language)),
            );
            let option = |value: &str, text: &str| el("option").attr("value", value).text(text);
            let devices = device::all().iter().map(|device| option(device.id(), device.name(language)));
            [option(AUTO, &auto)]
                .into_iter()
                .chain(devices)
                .chain([option(NO_PROFILE, language.profile_none())])
                .collect()
        })
        .live_value(move || {
            // New options forget what was chosen.
            app.language.track();
            desk.progress.track();
            desk.profile.get()
        })
        .on("change", move |event| desk.profile.set(dom::value(&event)))
}

fn export_menu(app: &'static Workbench) -> El {
    let item = |hook: &str, text: Label, format: Format| {
        button(app, "quiet small", hook, text).click(move || analyst::send(&ToAnalyst::Export(format)))
    };
    let items = vec![
        item("export-jsonl", Language::export_jsonl, Format::JsonLines),
        item("export-csv", Language::export_csv, Format::Csv),
        item("export-hex", Language::export_hex, Format::Hex),
    ];
    menu(app, "export", Language::export, items)
}

/// Copies a link that holds the text of the field: nothing leaves the machine before the link does.
fn link_button(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    let copied = RwSignal::new(false);
    let short =
        Memo::new(move |_| desk.document.with(Option::is_none) && desk.typed.with(|text| text.len() <= LONGEST_LINK));
    bare("quiet small", "copy-link")
        .flag("disabled", move || !short.get())
        .live_text(move || {
            desk.typed.track();
            let language = app.language.get();
            if !short.get() {
                language.link_too_long()
            } else if copied.get() {
                language.copied_link()
            } else {
                language.copy_link()
            }
            .to_owned()
        })
        .click(move || {
            let link = route::text_link(&desk.typed.get_untracked());
            clipboard::write(&link, move |well| copied.set(well));
        })
}

/// A row of the table of counts: its name, and the count.
type Count = (Label, fn(&Tally) -> u64);

const COUNTS: [Count; 8] = [
    (Language::count_frames, |tally| tally.frames.into()),
    (Language::count_requests, |tally| tally.requests.into()),
    (Language::count_responses, |tally| tally.responses.into()),
    (Language::count_exceptions, |tally| tally.exceptions.into()),
    (Language::count_damaged, |tally| tally.damaged.into()),
    (Language::count_unanswered, |tally| tally.unanswered.into()),
    (Language::count_orphans, |tally| tally.orphans.into()),
    (Language::count_noise, |tally| tally.noise_bytes),
];

/// The counts, once they are made.
pub(super) fn statistics(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    el("div").class("contents").live_one(move || {
        desk.statistics.with(|statistics| {
            statistics.as_ref().filter(|all| all.total != Tally::default()).map(|all| counts(app, all))
        })
    })
}

fn counts(app: &'static Workbench, all: &Statistics) -> El {
    let language = app.language.get();
    let columns: Vec<(String, &Tally)> = [(language.all_units().to_owned(), &all.total)]
        .into_iter()
        .chain(
            all.units
                .iter()
                .filter(|_| all.units.len() > 1)
                .take(16)
                .map(|(unit, tally)| (language.unit_id(*unit), tally)),
        )
        .collect();
    let head =
        el("tr").child(el("th").text("")).children(columns.iter().map(|(name, _)| el("th").class("number").text(name)));
    let rows = COUNTS.iter().map(|(name, count)| {
        let cells = columns.iter().map(|(_, tally)| {
            let count = count(tally);
            el("td").class(if count == 0 { "number muted" } else { "number" }).text(&format::count(count))
        });
        el("tr").child(el("td").text(name(language))).children(cells)
    });
    let table = el("table").class("counts-table").child(el("thead").child(head)).child(el("tbody").children(rows));
    let chips = |title: Label, items: Vec<(String, String)>| {
        let items = items.into_iter().map(|(name, count)| {
            el("span").class("chip-count").child(el("span").text(&name)).child(el("b").text(&count))
        });
        el("div").class("chips").child(el("span").class("muted").text(title(language))).children(items)
    };
    let functions =
        all.functions.iter().map(|(code, count)| (format::hex(*code), format::count((*count).into()))).collect();
    let diagnoses: Vec<_> =
        all.diagnoses.iter().map(|(id, count)| (id.clone(), format::count((*count).into()))).collect();
    let mut card = el("section")
        .class("card counts-card")
        .test("statistics")
        .child(el("header").child(el("h2").text(language.statistics())))
        .child(el("div").class("scroll").child(table))
        .child(chips(Language::by_function, functions));
    if !diagnoses.is_empty() {
        card = card.child(chips(Language::by_diagnosis, diagnoses));
    }
    card
}
