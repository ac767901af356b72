//! Above the list: whose registers they are, what is shown, files of the list; below it: counts.

use buslens_analyst::message::{Filter, Format, Statistics, Tally, ToAnalyst};

use super::{AUTO, CONNECTED, Desk, NO_PROFILE};
use crate::components::button::{bare, button, menu};
use crate::device;
use crate::dom::{self, El, el};
use crate::format;
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// How many entries are shown, of how many.
pub(crate) fn counts_text(app: &'static Workbench, desk: &'static Desk) -> String {
    let (shown, all) = desk.progress.with(|progress| (progress.shown, progress.entries));
    let text = |number: u32| format::count(number.into());
    if shown == all { text(all) } else { app.language.get().shown_of(&text(shown), &text(all)) }
}

/// What is shown, and whose registers they are.
pub(crate) fn filter_bar(app: &'static Workbench, desk: &'static Desk) -> El {
    let mut before = None;
    dom::react(move || {
        let now = desk.profile_choice();
        // The analyst is told at its start.
        if before.replace(now.clone()).is_some_and(|before| before != now) {
            desk.send_profile();
        }
    });
    let mut before = None;
    dom::react(move || {
        let filter = desk.filter();
        if before.replace(filter.clone()).is_some_and(|before| before != filter) {
            desk.send_filter();
        }
    });
    let input = |class: &str, hook: &'static str, label: Label, value: RwSignal<String>| {
        el("input")
            .class(class)
            .attr("id", hook)
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
        .child(profile_select(app, desk))
        .child(input("short", "filter-unit", Language::filter_unit, desk.unit))
        .child(input("short", "filter-function", Language::filter_function, desk.function))
        .children(desk.is_live().then(|| direction_select(app, desk)))
        .child(input("grow", "filter-text", Language::filter_text, desk.text))
        .child(errors)
        .live_one(move || filtered.get().then(clear))
}

/// One direction or both.
fn direction_select(app: &'static Workbench, desk: &'static Desk) -> El {
    let options = move || {
        let language = app.language.get();
        let ways = [("", language.both_directions()), ("tx", "TX"), ("rx", "RX")];
        ways.map(|(value, text)| el("option").attr("value", value).text(text)).into()
    };
    el("select")
        .test("filter-direction")
        .label(app, Language::direction)
        .live(options)
        .live_value(move || {
            app.language.track();
            desk.direction.get()
        })
        .on("change", move |event| desk.direction.set(dom::value(&event)))
}

fn profile_select(app: &'static Workbench, desk: &'static Desk) -> El {
    let hook = if desk.is_live() { "console-profile" } else { "decoder-profile" };
    el("select")
        .attr("id", hook)
        .test(hook)
        .label(app, Language::profile)
        .live(move || {
            let language = app.language.get();
            let found = desk.device().filter(|_| desk.profile.with(|id| id == AUTO));
            let auto = found.map_or_else(
                || language.profile_auto().to_owned(),
                |device| language.profile_auto_is(device.name(language)),
            );
            let option = |value: &str, text: &str| el("option").attr("value", value).text(text);
            let devices = device::all();
            let devices = devices.iter().map(|device| option(device.id(), device.name(language)));
            let connected = || {
                let device = desk.connected.with(|id| id.as_deref().map(|id| device::find(id).name(language)));
                let text = device.map_or_else(
                    || language.profile_connected().to_owned(),
                    |name| language.profile_connected_is(name),
                );
                option(CONNECTED, &text)
            };
            let connected = desk.is_live().then(connected);
            connected
                .into_iter()
                .chain([option(AUTO, &auto)])
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

/// Files of the list as it is filtered: names for the tests, labels, formats.
pub(crate) fn export_menu(
    app: &'static Workbench,
    desk: &'static Desk,
    formats: &[(&'static str, Label, Format)],
) -> El {
    let item = |&(hook, text, format): &(&'static str, Label, Format)| {
        button(app, "quiet small", hook, text).click(move || desk.analyst.send(&ToAnalyst::Export(format)))
    };
    menu(app, "export", Language::export, formats.iter().map(item).collect())
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
pub(crate) fn statistics(app: &'static Workbench, desk: &'static Desk) -> El {
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
