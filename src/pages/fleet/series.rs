//! A series: one device after the other is plugged in, found, given its unit id and settings, and proven.

use std::cmp::Ordering;

use buslens_codec::profile::Profile;
use buslens_configure::{Hazard, Refusal};

use super::progress::{self, Ended};
use super::state::Fleet;
use super::{hint, labels, sensors, setup};
use crate::components::button::{bare, button, icon_button};
use crate::components::icon::{Icon, icon};
use crate::configure::words;
use crate::dom::{self, El, el};
use crate::fleet::series::{Failure, Series, Stage, State};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// The pane.
pub(super) fn series_pane(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let has = Memo::new(move |_| fleet.series.with(Option::is_some));
    el("div").class("contents").live(move || {
        if has.get() {
            vec![work_card(app), sensors::sensors_card(app), labels::labels_card(app)]
        } else {
            let undo = move || {
                fleet.ended.with(Option::is_some).then(|| {
                    let back = button(app, "small", "series-resume", Language::fleet_undo).click(move || {
                        fleet.series.set(fleet.ended.get_untracked());
                        fleet.ended.set(None);
                    });
                    hint("info", app.language.get().fleet_series_ended()).test("series-ended").child(back)
                })
            };
            vec![el("div").class("contents").live_one(undo), setup::setup_card(app)]
        }
    })
}

/// What the card shows.
#[derive(Clone, Debug, PartialEq)]
enum Now {
    /// The next device is to be plugged in.
    Next,
    /// Something is done to the device at this place.
    Running(usize),
    /// Something went wrong with the device at this place, which was the last one.
    Failed(usize),
}

fn work_card(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let now = Memo::new(move |_| {
        fleet.series.with(|series| {
            let Some(series) = series else { return Now::Next };
            match (series.under_way(), series.latest) {
                (Some(place), _) => Now::Running(place),
                (None, Some(place)) if series.has_failed(place) => Now::Failed(place),
                _ => Now::Next,
            }
        })
    });
    let about = move || {
        let language = app.language.get();
        let name = fleet.device(app).map(|device| device.name(language).to_owned()).unwrap_or_default();
        let counts = fleet.series.with(|series| series.as_ref().map(Series::counts).unwrap_or_default());
        [&name, " \u{B7} ", &language.fleet_counts(counts.done, counts.failed)].concat()
    };
    let content = move || match now.get() {
        Now::Next => next(app),
        Now::Running(place) => running(app, place),
        Now::Failed(place) => failed(app, place),
    };
    el("section")
        .class("card fleet-work")
        .test("series")
        .live_attr("data-now", move || {
            Some(
                now.with(|now| match now {
                    Now::Next => "next",
                    Now::Running(_) => "running",
                    Now::Failed(_) => "failed",
                })
                .to_owned(),
            )
        })
        .child(
            el("header")
                .child(el("h2").say(app, Language::fleet_series))
                .child(el("span").class("muted").test("series-counts").live_text(about))
                .child(el("span").class("space"))
                .child(end(app)),
        )
        .child(notes(app))
        .live(content)
}

/// What stands in the way of the whole series.
fn notes(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    el("div").class("cfg-hints").live(move || {
        let language = app.language.get();
        let mut all = Vec::new();
        all.extend(app.why_not_hint(true));
        let other = app.target().filter(|target| {
            fleet.series.with(|series| series.as_ref().is_some_and(|all| all.setup.profile != target.device.id()))
        });
        if let Some((target, device)) = other.zip(fleet.device(app)) {
            let text = language.fleet_other_device(target.device.name(language), device.name(language));
            all.push(hint("warn", &text).test("series-other-device"));
        }
        if fleet.series_unkept.get() {
            all.push(hint("bad", language.fleet_series_unkept()).attr("role", "alert"));
        }
        if !app.configuring.open.with(Vec::is_empty) {
            all.push(hint("warn", language.fleet_journal_first()));
        }
        all
    })
}

/// The next device.
fn next(app: &'static Workbench) -> Vec<El> {
    let fleet = &app.fleet;
    let language = app.language.get();
    let (place, unit) =
        fleet.series.with(|series| series.as_ref().map_or((1, None), |all| (all.sensors.len() + 1, all.next_unit())));
    let Some(unit) = unit else {
        return vec![el("p").class("empty").test("series-full").text(language.fleet_none_left())];
    };
    let blocked = move || !fleet.can_set_up(app);
    let name = el("input")
        .attr("type", "text")
        .attr("id", NAME)
        .test("sensor-name")
        .attr("autocomplete", "off")
        .attr("maxlength", "60")
        .on("keydown", move |event| {
            if dom::key(&event) == "Enter" && !untrack(blocked) {
                fleet.set_up(app, None);
            }
        })
        .bind("input", fleet.sensor_name);
    let go = icon_button(app, "primary large", "set-up", Icon::Play, Language::fleet_set_up)
        .flag("disabled", blocked)
        .click(move || fleet.set_up(app, None));
    vec![
        el("div")
            .class("fleet-next")
            .child(
                el("p")
                    .class("fleet-unit")
                    .child(el("small").text(language.fleet_becomes()))
                    .child(el("b").test("next-unit").text(&unit.to_string())),
            )
            .child(
                el("div")
                    .class("fleet-next-words")
                    .child(el("h3").text(&language.fleet_plug_in(place)))
                    .child(el("p").class("muted").text(language.fleet_plug_in_hint()))
                    .child(
                        el("div")
                            .class("field")
                            .child(el("label").attr("for", NAME).text(language.fleet_name_or_serial()))
                            .child(name),
                    ),
            ),
        el("footer").child(go).child(el("span").class("muted").text(language.fleet_set_up_hint())),
    ]
}

/// When the series was begun, in milliseconds since the Unix epoch.
pub(super) fn begun(app: &'static Workbench) -> u64 {
    app.fleet.series.with(|series| series.as_ref().map(|series| series.begun_unix_ms).unwrap_or_default())
}

/// The field for a device's name.
const NAME: &str = "series-name";

/// Puts the cursor there, when it is drawn.
pub(super) fn focus_name() {
    request_animation_frame(|| {
        dom::focus(NAME);
    });
}

fn running(app: &'static Workbench, place: usize) -> Vec<El> {
    let fleet = &app.fleet;
    let stage = Memo::new(move |_| {
        fleet.series.with(|series| match series.as_ref()?.sensors.get(place)?.state {
            State::UnderWay(stage) => Some(stage),
            _ => None,
        })
    });
    let progress = Memo::new(move |_| {
        app.configuring.running.with(|running| running.as_ref().and_then(|running| running.progress.clone()))
    });
    let line = move || {
        let language = app.language.get();
        let profile = fleet.device(app).map(crate::device::Device::profile);
        fleet.writing.with(|plan| {
            let plan = plan.as_ref().filter(|_| stage.get() == Some(Stage::Writing));
            progress.with(|progress| progress::of_plan(language, progress.as_ref(), profile.zip(plan)))
        })
    };
    let share = move || {
        progress.with(|progress| progress.as_ref().filter(|all| all.total > 0).map(|all| (all.done, all.total)))
    };
    let steps = STAGES.iter().map(|(of, text)| {
        let at = *of as u8;
        let standing = move || {
            let now = stage.get().map_or(u8::MAX, |stage| stage as u8);
            match now.cmp(&at) {
                Ordering::Less => "waiting",
                Ordering::Equal => "running",
                Ordering::Greater => "done",
            }
        };
        el("li").live_attr("data-state", move || Some(standing().to_owned())).say(app, *text)
    });
    let language = app.language.get();
    let unit = fleet.series.with_untracked(|series| series.as_ref().and_then(|all| Some(all.sensors.get(place)?.unit)));
    let stopping =
        move || app.configuring.running.with(|running| running.as_ref().is_some_and(|running| running.stopping));
    vec![
        el("div")
            .class("fleet-next")
            .child(
                el("p")
                    .class("fleet-unit")
                    .child(el("small").text(language.fleet_becomes()))
                    .child(el("b").text(&unit.unwrap_or_default().to_string())),
            )
            .child(
                el("div")
                    .class("fleet-next-words")
                    .child(el("h3").text(&language.fleet_setting_up(place + 1)))
                    .child(el("ol").class("fleet-stages").children(steps))
                    .child(el("p").attr("role", "status").test("series-phase").live_text(line))
                    .child(
                        el("progress")
                            .live_attr("max", move || share().map(|(_, total)| total.to_string()))
                            .live_attr("value", move || share().map(|(done, total)| done.min(total).to_string())),
                    ),
            ),
        el("footer")
            .child(
                bare("danger", "series-cancel")
                    .flag("disabled", stopping)
                    .child(icon(Icon::Stop))
                    .child(el("span").say(app, Language::cfg_cancel))
                    .click(|| app.cancel_configuring()),
            )
            .child(el("span").class("muted").say(app, Language::cfg_keep_power)),
    ]
}

/// What is done to each device, in order.
const STAGES: [(Stage, Label); 4] = [
    (Stage::Finding, Language::fleet_stage_finding),
    (Stage::Reading, Language::fleet_stage_reading),
    (Stage::Writing, Language::fleet_stage_writing),
    (Stage::Checking, Language::fleet_stage_checking),
];

/// What went wrong with the last device, and the ways on. None of them stops the series.
fn failed(app: &'static Workbench, place: usize) -> Vec<El> {
    let fleet = &app.fleet;
    let language = app.language.get();
    let Some(profile) = fleet.device(app).map(crate::device::Device::profile) else { return Vec::new() };
    let failure = fleet.series.with(|series| match &series.as_ref()?.sensors.get(place)?.state {
        State::Failed(failure) => Some((**failure).clone()),
        _ => None,
    });
    let Some(failure) = failure else { return Vec::new() };
    let told = told(language, profile, &failure);
    let blocked = move || !fleet.can_set_up(app);
    let again = button(app, "primary", "series-again", Language::fleet_again)
        .flag("disabled", blocked)
        .click(move || fleet.set_up(app, Some(place)));
    let anyway = matches!(failure, Failure::SetUpBefore(_)).then(|| {
        button(app, "", "series-anyway", Language::fleet_anyway)
            .flag("disabled", blocked)
            .click(move || fleet.go_on(app, |series, _| series.take_anyway(super::now_ms(), place)))
    });
    let accept = match &failure {
        Failure::Unconfirmed(hazards) => {
            let hazards = hazards.clone();
            Some(button(app, "danger", "series-accept", Language::fleet_accept).flag("disabled", blocked).click(
                move || {
                    fleet.series.update(|series| {
                        if let Some(series) = series {
                            series.setup.accepted.extend(hazards.iter().cloned());
                        }
                    });
                    fleet.set_up(app, Some(place));
                },
            ))
        }
        _ => None,
    };
    let later = button(app, "", "series-later", Language::fleet_later).click(move || {
        fleet.series.update(|series| {
            if let Some(series) = series {
                series.put_aside(place);
            }
        });
    });
    let out = button(app, "quiet", "series-leave-out", Language::fleet_leave_out).click(move || {
        fleet.series.update(|series| {
            if let Some(series) = series {
                series.leave_out(place);
            }
        });
    });
    vec![
        el("div")
            .class("fleet-failed")
            .attr("role", "alert")
            .test("series-failed")
            .attr("data-failure", told.key)
            .child(icon(Icon::Fault))
            .child(
                el("div")
                    .child(el("h3").text(&language.fleet_failed(place + 1, &told.title)))
                    .child(el("p").text(&told.what))
                    .child(el("p").class("muted").text(&told.tip)),
            ),
        el("footer").child(again).children(anyway).children(accept).child(later).child(out),
    ]
}

/// A failure in words.
pub(super) fn told(language: Language, profile: &Profile, failure: &Failure) -> Ended {
    let t = language;
    let plain =
        |key, title: &str, what: String, tip: &str| Ended { key, title: title.to_owned(), what, tip: tip.to_owned() };
    match failure {
        Failure::Ended(Stage::Finding, report) => {
            Ended { tip: t.fleet_not_found_tip().to_owned(), ..Ended::of_report(t, profile, report) }
        }
        Failure::Ended(_, report) => {
            let told = Ended::of_report(t, profile, report);
            if told.tip.is_empty() { Ended { tip: t.fleet_try_again().to_owned(), ..told } } else { told }
        }
        Failure::Hindered(why) => Ended::of_hindrance(t, why),
        Failure::SetUpBefore(place) => {
            plain("set-up-before", t.fleet_before(), t.fleet_before_what(place + 1), t.fleet_before_tip())
        }
        Failure::Refused(refused) => {
            let line = |refusal: &Refusal| {
                let name = words::name(t, profile, &refusal.point);
                [&name, ": ", &words::unfit(t, profile, &refusal.point, &refusal.why)].concat()
            };
            let lines: Vec<String> = refused.iter().map(line).collect();
            plain("refused", t.fleet_refused(), lines.join("; "), t.fleet_refused_tip())
        }
        Failure::Unconfirmed(hazards) => {
            let lines: Vec<String> = hazards.iter().map(|hazard: &Hazard| words::hazard(t, profile, hazard)).collect();
            plain("unconfirmed", t.fleet_unconfirmed(), lines.join(" "), "")
        }
        Failure::NotHeld(points) => {
            let names: Vec<String> = points.iter().map(|point| words::name(t, profile, point)).collect();
            plain("not-held", t.fleet_not_held(), t.fleet_not_held_what(&words::listed(t, &names)), t.fleet_try_again())
        }
        Failure::NoUnitLeft => plain("no-unit", t.fleet_no_unit(), t.fleet_none_left().to_owned(), ""),
        Failure::Broken => plain("broken", t.fleet_broken(), t.fleet_broken_what().to_owned(), t.fleet_broken_tip()),
    }
}

/// The end of the series, by a second step. The list can be brought back until a new one is begun.
fn end(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let asking = RwSignal::new(false);
    el("div").class("fleet-end").live(move || {
        if !asking.get() {
            let end = button(app, "quiet small", "series-end", Language::fleet_end)
                .flag("disabled", move || fleet.is_in_series(app))
                .click(move || asking.set(true));
            return vec![end];
        }
        vec![
            el("span").class("muted").say(app, Language::fleet_end_question),
            button(app, "small danger", "series-end-now", Language::fleet_end_now).click(move || {
                fleet.ended.set(fleet.series.get_untracked());
                fleet.series.set(None);
            }),
            button(app, "small quiet", "series-end-not", Language::cancel).click(move || asking.set(false)),
        ]
    })
}

impl Fleet {
    /// Whether the next device can be set up now: the right kind is connected, and nothing stands in the way.
    pub(super) fn can_set_up(&self, app: &'static Workbench) -> bool {
        let fits = app.target().is_some_and(|target| {
            self.series.with(|series| series.as_ref().is_some_and(|all| all.setup.profile == target.device.id()))
        });
        fits && app.why_not(true).is_none()
    }
}
