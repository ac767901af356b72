//! Two snapshots side by side, one of which may be the connected device; and the way from there into the device, which is the
//! Configure page's review.

use buslens_codec::profile::Profile;
use buslens_configure::{Refusal, Snapshot, Transfer, edits_to};

use super::snapshots::read_again;
use super::state::{DEVICE, known, named};
use super::{hint, moment, now_ms, plain_day};
use crate::components::button::{bare, button};
use crate::components::field::option;
use crate::configure::row::Held;
use crate::configure::words;
use crate::dom::{self, El, el};
use crate::fleet::comparison::{self, Row};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// Both sides, if both are there and of one kind.
#[derive(Clone, Debug, PartialEq)]
struct Pair {
    left: Snapshot,
    right: Snapshot,
}

/// The card.
pub(super) fn compare_card(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let sides = Memo::new(move |_| {
        let side = |chosen: RwSignal<String>| chosen.with(|chosen| fleet.side(app, chosen));
        (side(fleet.left), side(fleet.right))
    });
    let pair = Memo::new(move |_| {
        sides.with(|sides| match sides {
            (Some(left), Some(right)) if left.profile == right.profile => {
                Some(Pair { left: left.clone(), right: right.clone() })
            }
            _ => None,
        })
    });
    let with_device = move || fleet.left.with(|key| key == DEVICE) || fleet.right.with(|key| key == DEVICE);
    let why_none = move || {
        let language = app.language.get();
        let unread = with_device() && fleet.device_now(app).is_none();
        let text = sides.with(|(left, right)| match (left, right) {
            (Some(_), Some(_)) => language.fleet_other_kinds(),
            _ if unread && app.target().is_none() => language.fleet_connect_first(),
            _ if unread => language.fleet_read_first(),
            _ => language.fleet_choose_two(),
        });
        pair.with(Option::is_none).then(|| el("p").class("empty").test("compare-empty").text(text))
    };
    el("section")
        .class("card fleet-compare")
        .test("compare")
        .child(
            el("header")
                .child(el("h2").attr("id", "fleet-compare").attr("tabindex", "-1").say(app, Language::fleet_compare))
                .child(el("span").class("muted").say(app, Language::fleet_compare_hint))
                .child(el("span").class("space"))
                .live_one(move || with_device().then(|| read_again(app))),
        )
        .child(
            el("div")
                .class("fleet-sides")
                .child(chooser(app, "compare-left", Language::fleet_left, fleet.left))
                .child(bare("quiet small", "compare-swap").say(app, Language::fleet_swap).click(move || {
                    let left = fleet.left.get_untracked();
                    fleet.left.set(fleet.right.get_untracked());
                    fleet.right.set(left);
                }))
                .child(chooser(app, "compare-right", Language::fleet_right, fleet.right)),
        )
        .live_one(why_none)
        .live(move || pair.with(|pair| pair.as_ref().map(|pair| compared(app, pair)).unwrap_or_default()))
}

/// A list of the snapshots and the device.
fn chooser(app: &'static Workbench, id: &'static str, label: Label, value: RwSignal<String>) -> El {
    let options = move || {
        let language = app.language.get();
        let mut all = vec![option("", language.fleet_choose()), option(DEVICE, language.fleet_device_now())];
        app.configuring.snapshots.with(|snapshots| {
            let snapshots = snapshots.iter().flatten().rev();
            all.extend(snapshots.map(|(number, snapshot)| {
                let when = moment(language, snapshot.taken_unix_ms);
                let text = [&named(language, &snapshot.name), " \u{B7} ", &when].concat();
                option(&number.to_string(), &text)
            }));
        });
        all
    };
    el("div").class("field").child(el("label").attr("for", id).say(app, label)).child(crate::components::field::list(
        id,
        value,
        Box::new(options),
    ))
}

fn compared(app: &'static Workbench, pair: &Pair) -> Vec<El> {
    let fleet = &app.fleet;
    let Some(device) = known(&pair.left.profile) else { return Vec::new() };
    let (language, profile) = (app.language.get(), device.profile());
    let rows = comparison::rows(language, profile, &pair.left, &pair.right);
    let names = (title(app, language, fleet.left, &pair.left), title(app, language, fleet.right, &pair.right));
    let differing = rows.iter().filter(|row| row.differs).count();
    let same = rows.len() - differing;
    let shown = fleet.with_same.get();
    let count = match differing {
        0 => language.fleet_no_difference().to_owned(),
        1 => language.fleet_one_difference().to_owned(),
        count => language.fleet_differences(count),
    };
    let fold = (same > 0).then(|| {
        bare("quiet small", "compare-same")
            .attr("aria-pressed", if shown { "true" } else { "false" })
            .text(&if shown { language.fleet_hide_same(same) } else { language.fleet_show_same(same) })
            .attr("id", "compare-same")
            .click(move || {
                fleet.with_same.update(|on| *on = !*on);
                focus_again("compare-same");
            })
    });
    let file = comparison::file(language, &rows, (&names.0, &names.1));
    let export = button(app, "quiet small", "compare-export", Language::fleet_save_csv).click(move || {
        dom::save_text(&file, "text/csv", &["buslens-comparison-", &plain_day(now_ms()), ".csv"].concat());
    });
    let bar = el("div")
        .class("fleet-count")
        .child(el("b").test("compare-count").attr("data-count", &differing.to_string()).text(&count))
        .child(el("span").class("space"))
        .children(fold)
        .child(export);
    let mut all = vec![bar];
    let visible: Vec<&Row> = rows.iter().filter(|row| row.differs || shown).collect();
    if !visible.is_empty() {
        all.push(el("div").class("scroll").child(table(language, &names, &visible)));
    }
    all.extend(transfer(app, language, profile, pair));
    all
}

/// Puts the focus back on what is drawn anew by its own action.
fn focus_again(id: &'static str) {
    request_animation_frame(move || {
        dom::focus(id);
    });
}

fn title(app: &'static Workbench, language: Language, side: RwSignal<String>, snapshot: &Snapshot) -> String {
    if side.with(|key| key == DEVICE) {
        let reach = app.target().map_or(snapshot.reach, |target| target.reach);
        return [language.fleet_device_now(), ", ", &words::reach(language, &reach)].concat();
    }
    named(language, &snapshot.name)
}

fn table(language: Language, names: &(String, String), rows: &[&Row]) -> El {
    let head = |text: &str| el("th").attr("scope", "col").text(text);
    let titles = [language.cfg_point(), language.cfg_register(), &names.0, &names.1].map(head);
    let cell = |held: &Held| {
        el("td")
            .class(if held.is_value { "fleet-held" } else { "fleet-held muted" })
            .child(el("span").text(&comparison::text(held)))
            .child(el("code").class("cfg-raw").text(&held.registers))
    };
    let row = |row: &&Row| {
        el("tr")
            .test("compare-row")
            .attr("data-point", &row.point)
            .attr("data-differs", if row.differs { "true" } else { "false" })
            .child(el("th").attr("scope", "row").text(&row.name))
            .child(el("td").child(el("code").class("cfg-raw").text(&format!("0x{:04X}", row.register))))
            .child(cell(&row.left))
            .child(cell(&row.right))
    };
    el("table")
        .class("fleet-table fleet-differences")
        .child(el("thead").child(el("tr").children(titles)))
        .child(el("tbody").children(rows.iter().map(row)))
}

/// The way from a snapshot into the connected device; none where neither side is the device.
fn transfer(app: &'static Workbench, language: Language, profile: &'static Profile, pair: &Pair) -> Option<El> {
    let fleet = &app.fleet;
    let is_device = |side: RwSignal<String>| side.with(|key| key == DEVICE);
    let (wanted, have) = match (is_device(fleet.left), is_device(fleet.right)) {
        (false, true) => (&pair.left, &pair.right),
        (true, false) => (&pair.right, &pair.left),
        _ => return None,
    };
    let with_unit = fleet.with_unit.get();
    let Transfer { edits, refused } = edits_to(profile, have, wanted, with_unit);
    let tick = el("input")
        .attr("type", "checkbox")
        .attr("id", "fleet-with-unit")
        .test("with-unit")
        .live_checked(move || fleet.with_unit.get())
        .click(move || {
            fleet.with_unit.update(|on| *on = !*on);
            focus_again("fleet-with-unit");
        });
    let unit = el("label")
        .class("cfg-check")
        .attr("for", "fleet-with-unit")
        .child(tick)
        .child(el("span").text(language.fleet_with_unit()))
        .child(el("span").class("muted").text(language.fleet_with_unit_hint()));
    let name = named(language, &wanted.name);
    let (what, blocked) = match edits.len() {
        0 => (language.fleet_nothing_to_bring(&name), true),
        1 => (language.fleet_bring_one(&name), false),
        count => (language.fleet_bring(count, &name), false),
    };
    let snapshot = wanted.clone();
    let go = button(app, "primary", "bring", Language::fleet_to_review)
        .flag("disabled", move || blocked || app.why_not(true).is_some())
        .click(move || app.configure.bring_snapshot(app, &snapshot, with_unit));
    let cannot = (!refused.is_empty()).then(|| {
        let line = |refusal: &Refusal| {
            let name = words::name(language, profile, &refusal.point);
            let why = words::unfit(language, profile, &refusal.point, &refusal.why);
            el("li").child(el("b").text(&name)).text(" \u{2013} ").text(&why)
        };
        el("div")
            .class("fleet-cannot")
            .test("bring-refused")
            .child(el("p").class("muted").text(language.fleet_cannot_bring()))
            .child(el("ul").class("cfg-list").children(refused.iter().map(line)))
    });
    let body = el("div")
        .class("cfg-body")
        .child(el("p").test("bring-what").attr("data-count", &edits.len().to_string()).text(&what))
        .child(unit)
        .children(cannot);
    let foot = el("footer")
        .child(go)
        .child(el("span").class("muted").text(language.fleet_to_review_hint()))
        .live_one(move || app.why_not(true).map(|why| hint("info", why)));
    Some(el("div").class("fleet-transfer").test("transfer").child(body).child(foot))
}
