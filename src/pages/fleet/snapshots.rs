//! The snapshots that are kept, and a new one.

use buslens_configure::{Read, Snapshot};
use wasm_bindgen_futures::{JsFuture, spawn_local};

use super::state::{DEVICE, Told, known, named, store_fault};
use super::{hint, moment, plain_day};
use crate::components::bring::{self, Dropped};
use crate::components::button::{bare, button, icon_button};
use crate::components::icon::{Icon, icon};
use crate::configure::words;
use crate::configuring::Kind;
use crate::dom::{self, El, el};
use crate::fleet::audit;
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// No snapshot's file is larger, in bytes.
const LARGEST: f64 = 1_048_576.0;

/// The card.
pub(super) fn snapshots_card(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let chooser = bring::chooser("fleet-file", move |file| take_file(app, file));
    let chooser = chooser.attr("accept", ".json,application/json").attr("tabindex", "-1");
    let load = el("label")
        .class("button quiet small")
        .attr("for", "fleet-file")
        .child(icon(Icon::File))
        .child(el("span").say(app, Language::fleet_load));
    el("section")
        .class("card")
        .test("snapshots")
        .on("dragover", |event| event.prevent_default())
        .on("drop", move |event| match bring::dropped(&event) {
            Some(Dropped::File(file)) => take_file(app, file),
            Some(Dropped::Text(text)) => fleet.bring(app, &String::from(text)),
            None => {}
        })
        .child(
            el("header")
                .child(el("h2").say(app, Language::fleet_snapshots))
                .child(el("span").class("muted").say(app, Language::fleet_snapshots_hint))
                .child(el("span").class("space"))
                .child(chooser)
                .child(load),
        )
        .child(take_row(app))
        .child(notes(app))
        .live_one(move || table(app))
}

fn take_file(app: &'static Workbench, file: web_sys::File) {
    let fleet = &app.fleet;
    if file.size() > LARGEST {
        fleet.told.set(Some(Told::Large));
        return;
    }
    spawn_local(async move {
        match JsFuture::from(file.text()).await.ok().and_then(|text| text.as_string()) {
            Some(text) => fleet.bring(app, &text),
            None => fleet.told.set(Some(Told::Unreadable)),
        }
    });
}

/// Where a new one is taken.
fn take_row(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let blocked = move || app.why_not(false).is_some();
    let name = el("input")
        .attr("type", "text")
        .attr("id", "fleet-name")
        .test("snapshot-name")
        .attr("autocomplete", "off")
        .attr("maxlength", "80")
        .live_attr("placeholder", move || Some(app.language.get().fleet_name_hint().to_owned()))
        .on("keydown", move |event| {
            if dom::key(&event) == "Enter" && !untrack(blocked) {
                fleet.take_snapshot(app);
            }
        })
        .bind("input", fleet.name);
    let of = move || {
        let target = app.target()?;
        let language = app.language.get();
        let text = [target.device.name(language), " \u{B7} ", &words::reach(language, &target.reach)].concat();
        Some(el("p").class("muted fleet-of").text(&text))
    };
    el("div")
        .class("fleet-take")
        .child(
            el("div")
                .class("field")
                .child(el("label").attr("for", "fleet-name").say(app, Language::fleet_name))
                .child(name),
        )
        .child(
            button(app, "primary", "take-snapshot", Language::fleet_take)
                .flag("disabled", blocked)
                .click(move || fleet.take_snapshot(app)),
        )
        .live_one(of)
}

/// What stands in the way, what has come of the last one, and what can be brought back.
fn notes(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let reading = move || {
        let running = app.configuring.running.with(|running| {
            running.as_ref().filter(|running| running.kind == Kind::Read).map(|running| running.progress.clone())
        })?;
        Some(super::progress::line(app.language.get(), running.as_ref()))
    };
    el("div").class("cfg-hints").live(move || {
        let language = app.language.get();
        let mut all = Vec::new();
        all.extend(app.why_not_hint(false));
        all.extend(reading().map(|text| hint("info", &text).attr("role", "status").test("snapshot-reading")));
        if let Some(fault) = app.configuring.store_fault.get() {
            all.push(hint("bad", &store_fault(language, &fault)).attr("role", "alert").test("store-fault"));
        }
        all.extend(fleet.told.with(|told| {
            let told = told.as_ref()?;
            let kind = if told.is_fault() { "bad" } else { "info" };
            Some(hint(kind, &told.text(language)).attr("role", "status").test("snapshot-told"))
        }));
        all.extend(fleet.deleted.with(|deleted| {
            let (_, snapshot) = deleted.as_ref()?;
            let undo = button(app, "small", "undelete", Language::fleet_undo).click(move || fleet.undelete(app));
            let text = language.fleet_deleted(&named(language, &snapshot.name));
            Some(hint("info", &text).attr("role", "status").test("snapshot-deleted").child(undo))
        }));
        all
    })
}

fn table(app: &'static Workbench) -> Option<El> {
    let language = app.language.get();
    app.configuring.snapshots.with(|all| {
        let all = all.as_ref()?;
        if all.is_empty() {
            return Some(el("p").class("empty").test("snapshots-empty").text(language.fleet_none()));
        }
        let titles: [Label; 5] = [
            Language::fleet_name,
            Language::fleet_device,
            Language::fleet_reached,
            Language::fleet_taken,
            Language::fleet_parameters,
        ];
        let titles = titles.map(|title| el("th").attr("scope", "col").text(title(language)));
        let rows = all.iter().rev().map(|(number, snapshot)| row(app, language, *number, snapshot));
        let head = el("thead").child(el("tr").children(titles).child(el("th")));
        let table = el("table").class("fleet-table").child(head).child(el("tbody").children(rows));
        Some(el("div").class("scroll").child(table))
    })
}

fn row(app: &'static Workbench, language: Language, number: u64, snapshot: &Snapshot) -> El {
    let fleet = &app.fleet;
    let kept = snapshot.clone();
    let renamed = move |event: web_sys::Event| {
        let name = dom::value(&event).trim().to_owned();
        app.keep_snapshot(number, Snapshot { name, ..kept.clone() });
    };
    let name = el("input")
        .class("fleet-rename")
        .attr("type", "text")
        .test("snapshot-rename")
        .attr("maxlength", "80")
        .attr("autocomplete", "off")
        .attr("aria-label", language.fleet_name())
        .attr("placeholder", language.fleet_unnamed())
        .attr("value", &snapshot.name)
        .on("change", renamed);
    let read = snapshot.data.iter().filter(|datum| matches!(datum.read, Read::Registers(_))).count();
    let count = language.fleet_read_of(read, snapshot.data.len());
    let titled = |text: &str| named(language, text);
    let compare = bare("small", "snapshot-compare")
        .attr("aria-label", &language.fleet_restore_names(&titled(&snapshot.name)))
        .text(language.fleet_restore())
        .click(move || {
            fleet.left.set(number.to_string());
            fleet.right.set(DEVICE.to_owned());
            // Whatever was known of the device, it may hold something else now.
            if untrack(|| app.why_not(false).is_none()) {
                fleet.look(app);
            }
            focus_compare();
        });
    let kept = snapshot.clone();
    let save = bare("quiet small", "snapshot-save")
        .attr("aria-label", &language.fleet_save_names(&titled(&snapshot.name)))
        .text(language.fleet_save())
        .flag("disabled", {
            let profile = snapshot.profile.clone();
            move || known(&profile).is_none()
        })
        .click(move || save(&kept));
    let kept = snapshot.clone();
    let delete = bare("quiet small", "snapshot-delete")
        .attr("aria-label", &language.fleet_delete_names(&titled(&snapshot.name)))
        .text(language.fleet_delete())
        .click(move || fleet.delete(app, number, kept.clone()));
    el("tr")
        .test("snapshot-row")
        .attr("data-number", &number.to_string())
        .child(el("td").class("fleet-name").child(name))
        .child(el("td").text(&audit::device_name(language, &snapshot.profile)))
        .child(el("td").class("fleet-reach").text(&words::reach(language, &snapshot.reach)))
        .child(el("td").text(&moment(language, snapshot.taken_unix_ms)))
        .child(el("td").class(if read < snapshot.data.len() { "fleet-short" } else { "" }).text(&count))
        .child(el("td").class("fleet-actions").child(compare).child(save).child(delete))
}

/// Lets the browser save a snapshot.
fn save(snapshot: &Snapshot) {
    let Some(device) = known(&snapshot.profile) else { return };
    let name: String = snapshot.name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect::<String>();
    let name = if name.is_empty() { snapshot.reach.unit.0.to_string() } else { name };
    let file = ["buslens-", device.id(), "-", &name, "-", &plain_day(snapshot.taken_unix_ms), ".json"].concat();
    dom::save_text(&snapshot.to_json(device.profile()), "application/json", &file);
}

/// Brings the comparison in sight.
fn focus_compare() {
    request_animation_frame(|| {
        dom::focus("fleet-compare");
    });
}

/// A button with an icon that reads the device again.
pub(super) fn read_again(app: &'static Workbench) -> El {
    icon_button(app, "quiet small", "compare-read", Icon::Reset, Language::cfg_read_again)
        .flag("disabled", move || app.why_not(false).is_some())
        .click(move || app.fleet.look(app))
}
