//! Every write that has left, whoever wanted it; and how often each device was written.

use std::hash::{DefaultHasher, Hash, Hasher};

use buslens_analyst::configure::{AuditForm, AuditRow, DeviceKey};

use super::moment;
use crate::components::button::{button, menu};
use crate::components::field::list as choose;
use crate::components::field::option;
use crate::components::icon::{Icon, icon};
use crate::components::list::{Source, list};
use crate::configure::words;
use crate::dom::{El, el};
use crate::fleet::audit::{device_name, end, endures, is_refused, is_well, key_text, origin, told};
use crate::format::{self, hex_spaced};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// From this share of what a memory endures on, the count warns.
const WORN: f64 = 0.8;

/// How often each device was written.
pub(super) fn writes_card(app: &'static Workbench) -> El {
    let rows = move || {
        let language = app.language.get();
        app.configuring.writes.with(|all| {
            if all.is_empty() {
                return Some(el("p").class("empty").test("writes-empty").text(language.fleet_no_writes()));
            }
            let mut all = all.clone();
            all.sort();
            let titles: [Label; 3] = [Language::fleet_device, Language::fleet_unit_id, Language::fleet_writes];
            let titles = titles.map(|title| el("th").attr("scope", "col").text(title(language)));
            let rows = all.iter().map(|(key, count)| writes_row(language, key, *count));
            let table = el("table")
                .class("fleet-table fleet-writes")
                .child(el("thead").child(el("tr").children(titles)))
                .child(el("tbody").children(rows));
            Some(el("div").class("scroll").child(table))
        })
    };
    el("section")
        .class("card")
        .test("writes")
        .child(
            el("header")
                .child(el("h2").say(app, Language::fleet_worn))
                .child(el("span").class("muted").say(app, Language::fleet_worn_hint)),
        )
        .live_one(rows)
}

fn writes_row(language: Language, key: &DeviceKey, count: u64) -> El {
    let endures = endures(&key.profile);
    // A count of writes is far below what a float holds.
    #[allow(clippy::cast_precision_loss)]
    let share = if endures == 0 { 0.0 } else { count as f64 / f64::from(endures) };
    let of = match endures {
        0 => language.fleet_endures_unknown().to_owned(),
        endures => language.fleet_endures(&format::count(endures.into())),
    };
    let bar = (endures > 0).then(|| {
        el("progress")
            .attr("max", &endures.to_string())
            .attr("value", &count.min(endures.into()).to_string())
            .attr("aria-label", &of)
    });
    let simulated = key.simulated.then(|| el("span").class("tag").text(language.simulator()));
    el("tr")
        .test("writes-row")
        .attr("data-worn", if share >= WORN { "true" } else { "false" })
        .child(el("td").child(el("span").text(&device_name(language, &key.profile))).text(" ").children(simulated))
        .child(el("td").text(&key.unit.to_string()))
        .child(
            el("td")
                .class("fleet-wear")
                .child(el("b").test("writes-count").text(&format::count(count)))
                .child(el("span").class("muted").text(&of))
                .children(bar),
        )
}

/// The log.
pub(super) fn log_card(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let total = Memo::new(move |_| app.configuring.audit.with(|page| page.total));
    let options = move || {
        let language = app.language.get();
        let mut keys: Vec<DeviceKey> =
            app.configuring.writes.with(|all| all.iter().map(|(key, _)| key.clone()).collect());
        keys.sort();
        // The log's filter does not tell a simulated device from a real one.
        keys.dedup_by(|one, other| (&one.profile, one.unit) == (&other.profile, other.unit));
        let named = |key: &DeviceKey| {
            let name = device_name(language, &key.profile);
            option(&key_text(key), &[&name, " \u{B7} ", &language.unit_id(key.unit)].concat())
        };
        std::iter::once(option("", language.fleet_all_devices())).chain(keys.iter().map(named)).collect()
    };
    // Asked for at first, and again with another filter.
    crate::dom::react(move || {
        fleet.audited.track();
        fleet.row.set(u32::MAX);
        fleet.want_rows(app, &(0..1));
    });
    let export = menu(
        app,
        "audit-export",
        Language::fleet_export,
        [
            (AuditForm::Csv, "audit-csv", Language::fleet_export_csv as Label),
            (AuditForm::JsonLines, "audit-jsonl", Language::fleet_export_jsonl),
        ]
        .map(|(form, hook, text)| {
            button(app, "quiet small", hook, text).click(move || app.export_audit(untrack(|| fleet.filter()), form))
        })
        .into(),
    );
    let filter = el("div")
        .class("fleet-filter")
        .child(el("label").class("visually-hidden").attr("for", "audit-device").say(app, Language::fleet_device))
        .child(choose("audit-device", fleet.audited, Box::new(options)));
    el("section")
        .class("card fleet-log")
        .test("audit")
        .child(
            el("header")
                .child(el("h2").say(app, Language::fleet_audit))
                .child(
                    el("span")
                        .class("muted")
                        .test("audit-count")
                        .live_attr("data-count", move || Some(total.get().to_string()))
                        .live_text(move || app.language.get().fleet_entries(&format::count(total.get().into()))),
                )
                .child(el("span").class("space"))
                .child(filter)
                .child(export)
                .child(clear(app, total)),
        )
        .live_one(move || {
            (total.get() == 0).then(|| el("p").class("empty").test("audit-empty").say(app, Language::fleet_no_entries))
        })
        .child(rows(app, total))
        .live_one(move || detail(app))
}

/// Empties the log by a deliberate second step.
fn clear(app: &'static Workbench, total: Memo<u32>) -> El {
    let fleet = &app.fleet;
    el("div").class("fleet-end").live(move || {
        if !fleet.clearing.get() {
            let clear = button(app, "quiet small", "audit-clear", Language::fleet_clear)
                .flag("disabled", move || total.get() == 0)
                .click(move || fleet.clearing.set(true));
            return vec![clear];
        }
        vec![
            el("span").class("muted").say(app, Language::fleet_clear_question),
            button(app, "small danger", "audit-clear-now", Language::fleet_clear_now).click(move || {
                fleet.clearing.set(false);
                fleet.row.set(u32::MAX);
                app.clear_audit();
            }),
            button(app, "small quiet", "audit-clear-not", Language::cancel).click(move || fleet.clearing.set(false)),
        ]
    })
}

fn rows(app: &'static Workbench, total: Memo<u32>) -> El {
    let fleet = &app.fleet;
    let source = Source {
        total,
        gone: RwSignal::new(0),
        turn: fleet.rows_turn,
        stamp: Box::new(move |at| with_row(app, at, |row| stamp(app, row))),
        draw: Box::new(move |at| with_row(app, at, |row| draw(app.language.get_untracked(), row))),
        want: Box::new(move |rows| {
            if !rows.is_empty() {
                fleet.want_rows(app, &rows);
            }
        }),
        seek: Box::new(|| None),
        chosen: fleet.row,
        growing: None,
        hook: "audit-row",
    };
    list(app, "fleet-rows", Language::fleet_audit, head(app), source)
}

/// A row of the log, if it is here.
fn with_row<T>(app: &'static Workbench, at: u32, act: impl FnOnce(&AuditRow) -> T) -> Option<T> {
    app.configuring.audit.with_untracked(|page| {
        let place = usize::try_from(at.checked_sub(page.from)?).ok()?;
        page.rows.get(place).map(act)
    })
}

fn stamp(app: &'static Workbench, row: &AuditRow) -> u64 {
    let mut hasher = DefaultHasher::new();
    let zh = app.language.get_untracked() == Language::Zh;
    (row.entry.unix_ms, &row.entry.sent, &row.entry.received, &row.entry.profile, &row.entry.point, zh)
        .hash(&mut hasher);
    hasher.finish()
}

fn head(app: &'static Workbench) -> El {
    let titles: [(&str, Label); 7] = [
        ("audit-time", Language::fleet_when),
        ("audit-device", Language::fleet_device),
        ("audit-unit number", Language::fleet_unit_id),
        ("audit-point", Language::cfg_point),
        ("audit-change", Language::fleet_change),
        ("audit-end", Language::fleet_outcome),
        ("audit-origin", Language::origin),
    ];
    let cells = titles.map(|(class, text)| el("span").class(class).say(app, text));
    el("div").class("list-row list-head").attr("aria-hidden", "true").children(cells)
}

fn draw(language: Language, row: &AuditRow) -> El {
    let told = told(language, row);
    let entry = &row.entry;
    let change = el("span").class("audit-change");
    let change = if told.old.is_empty() {
        change.child(el("b").text(&told.new))
    } else {
        change.child(el("span").class("cfg-old").text(&told.old)).text(" \u{2192} ").child(el("b").text(&told.new))
    };
    let outcome =
        el("span").class(if is_well(row) { "audit-end ok" } else { "audit-end bad" }).text(outcome(language, row));
    let cells = [
        ("audit-time", moment(language, entry.unix_ms)),
        ("audit-device", told.device),
        ("audit-unit number", entry.reach.unit.0.to_string()),
        ("audit-point", told.point),
    ];
    el("div")
        .class("list-row")
        .children(cells.map(|(class, text)| el("span").class(class).attr("title", &text).text(&text)))
        .child(change)
        .child(outcome)
        .child(el("span").class("audit-origin").text(origin(language, row.origin)))
}

fn outcome(language: Language, row: &AuditRow) -> &'static str {
    if is_refused(&row.entry.received, row.entry.reach.mode) {
        return language.fleet_end_refused();
    }
    end(language, row.entry.end)
}

/// The chosen write with its frames.
fn detail(app: &'static Workbench) -> Option<El> {
    app.fleet.rows_turn.track();
    let (at, language) = (app.fleet.row.get(), app.language.get());
    with_row(app, at, |row| {
        let told = told(language, row);
        let entry = &row.entry;
        let heard = if entry.received.is_empty() {
            language.cfg_heard_nothing().to_owned()
        } else {
            hex_spaced(&entry.received)
        };
        let old = (!told.old.is_empty()).then(|| el("span").class("cfg-old").text(&told.old));
        let arrow = (!told.old.is_empty()).then(|| icon(Icon::Go));
        let simulated = row.simulated.then(|| el("span").class("tag").text(language.simulator()));
        el("div")
            .class("fleet-detail")
            .test("audit-detail")
            .child(
                el("p")
                    .class("cfg-step-line")
                    .child(el("b").class("cfg-step-name").text(&told.point))
                    .child(el("span").class("cfg-change").children(old).children(arrow).child(el("b").text(&told.new)))
                    .child(el("span").class("muted").text(outcome(language, row)))
                    .children(simulated),
            )
            .child(
                el("p").class("muted").text(
                    &[
                        &moment(language, entry.unix_ms),
                        " \u{B7} ",
                        &told.device,
                        " \u{B7} ",
                        &words::reach(language, &entry.reach),
                    ]
                    .concat(),
                ),
            )
            .child(
                el("dl")
                    .class("cfg-frames")
                    .child(el("dt").class("direction tx").text("TX"))
                    .child(el("dd").child(el("code").test("audit-sent").text(&hex_spaced(&entry.sent))))
                    .child(el("dt").class("direction rx").text("RX"))
                    .child(el("dd").child(el("code").test("audit-received").text(&heard))),
            )
    })
}
