//! What has come of it: every step, every frame, where the device is, and the ways on.

use buslens_configure::{Exchange, Reach, Report, Scope, StepReport, Way};
use wasm_bindgen::JsValue;

use super::review::change;
use super::state;
use crate::components::button::{bare, button};
use crate::components::icon::{Icon, icon};
use crate::configure::ending::{self, Grade, Told};
use crate::configure::words;
use crate::device::{self, Device};
use crate::dom::{self, El, el};
use crate::format::{hex_spaced, milliseconds};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// The card.
pub(super) fn report_card(app: &'static Workbench) -> El {
    let configure = &app.configure;
    el("div").class("contents").live_one(move || {
        let language = app.language.get();
        let ended = configure.report.get()?;
        Some(match &ended.outcome {
            Err(why) => not_begun(app, &state::hindrance(language, why)),
            Ok(report) => {
                let device = device_of(app, report)?;
                let have = untrack(|| configure.have(app, device.profile()));
                let told = ending::told(language, device.profile(), report, &have);
                ended_card(app, device, report, &told)
            }
        })
    })
}

/// The device that a report is about.
fn device_of(app: &'static Workbench, report: &Report) -> Option<&'static Device> {
    let read = report.snapshot.as_ref().map(|snapshot| device::find(&snapshot.profile));
    read.or_else(|| untrack(|| app.configure.device(app)))
}

fn card(app: &'static Workbench, grade: Grade, title: &str) -> (El, El) {
    let mark = if grade == Grade::Good { Icon::Info } else { Icon::Fault };
    let heading = el("h2").attr("id", "configure-work").attr("tabindex", "-1").test("report-title").text(title);
    let header = el("header").child(icon(mark)).child(heading).child(el("span").class("space"));
    let close =
        button(app, "quiet small", "report-close", Language::cfg_close_report).click(|| app.configure.report.set(None));
    let card = el("section").class("card cfg-work cfg-report").test("report-card").attr("data-grade", grade.key());
    (card, header.child(close))
}

fn not_begun(app: &'static Workbench, why: &str) -> El {
    let (card, header) = card(app, Grade::Harmless, app.language.get().cfg_refused());
    let body = el("div").class("cfg-body").attr("role", "alert").child(el("p").text(why));
    card.attr("data-ending", "not-begun").child(header).child(body)
}

fn ended_card(app: &'static Workbench, device: &'static Device, report: &Report, told: &Told) -> El {
    let language = app.language.get();
    let profile = device.profile();
    let (card, header) = card(app, told.grade, told.title);
    let have = untrack(|| app.configure.have(app, profile));
    let mut body = el("div")
        .class("cfg-body")
        .attr("role", if told.grade == Grade::Bad { "alert" } else { "status" })
        .child(el("p").test("report-what").text(&told.what));
    if !told.list.is_empty() {
        body = body.child(el("ul").class("cfg-list").children(told.list.iter().map(|line| el("li").text(line))));
    }
    body = body.children(told.tip.map(|tip| el("p").class("muted").text(tip)));
    let text = crate::configure::report::text(language, &now(language), profile, report, told, &have);
    let save = button(app, "", "report-save", Language::cfg_save_report)
        .click(move || dom::save_text(&text, "text/plain", "buslens-report.txt"));
    let steps = report.steps.iter().enumerate().map(|(at, step)| step_item(app, device, at, step));
    let figures = [
        (report.writes > 0).then(|| language.cfg_writes(report.writes)),
        Some(language.cfg_took(&words::tenths(report.took_us / 1000))),
    ];
    let figures = figures.into_iter().flatten().collect::<Vec<_>>().join(" \u{B7} ");
    card.attr("data-ending", told.key)
        .child(header)
        .child(body)
        .children(place(app, report))
        .children((!report.steps.is_empty()).then(|| el("ol").class("cfg-steps").children(steps)))
        .child(
            el("footer")
                .children(ways_on(app, report, told))
                .child(save)
                .child(el("span").class("space"))
                .child(el("span").class("muted").text(&figures)),
        )
}

/// Where the device is, as far as that is known, and how to get there.
fn place(app: &'static Workbench, report: &Report) -> Option<El> {
    let language = app.language.get();
    if let Some(reach) = &report.reach {
        let text = words::reach(language, reach);
        return Some(
            el("p")
                .class("cfg-place")
                .test("report-reach")
                .child(el("span").class("muted").text(language.cfg_where()))
                .child(el("b").text(&text))
                .child(el("span").class("tag ok").text(language.cfg_where_known())),
        );
    }
    if report.candidates.is_empty() {
        return None;
    }
    let candidate = |reach: &Reach| {
        let reach = *reach;
        bare("small", "candidate")
            .flag("disabled", move || app.blocked(false).is_some())
            .text(&language.cfg_connect_with(&words::reach(language, &reach)))
            .click(move || {
                app.find_device(Scope { reaches: vec![reach], everywhere: false, units: Vec::new() });
            })
    };
    Some(
        el("div")
            .class("cfg-place")
            .test("report-candidates")
            .child(el("span").class("muted").text(language.cfg_where_unknown()))
            .children(report.candidates.iter().map(candidate)),
    )
}

/// What can be done about it.
fn ways_on(app: &'static Workbench, report: &Report, told: &Told) -> Vec<El> {
    let configure = &app.configure;
    let blocked = move |write| app.blocked(write).is_some();
    let mut all = Vec::new();
    if let Some(journal) = report.journal {
        let finish = button(app, "primary", "report-finish", Language::cfg_finish)
            .flag("disabled", move || blocked(true))
            .click(move || {
                app.recover(journal, Way::Finish);
            });
        let undo = button(app, "", "report-undo", Language::cfg_undo_journal)
            .flag("disabled", move || blocked(true))
            .click(move || {
                app.recover(journal, Way::Undo);
            });
        all.extend([finish, undo]);
    }
    if told.search {
        let candidates = report.candidates.clone();
        all.push(
            button(app, "", "report-search", Language::cfg_find)
                .flag("disabled", move || blocked(false))
                .click(move || configure.search(app, &candidates)),
        );
    }
    all
}

fn step_item(app: &'static Workbench, device: &'static Device, at: usize, step: &StepReport) -> El {
    let language = app.language.get();
    let profile = device.profile();
    let have = untrack(|| app.configure.have(app, profile));
    let outcome =
        words::outcome(language, &step.outcome, |read| words::read(language, profile, &step.point, read, &have));
    let frames = (!step.exchanges.is_empty()).then(|| {
        el("details")
            .class("cfg-exchanges")
            .child(el("summary").test("step-frames").text(language.cfg_frames_of_step()))
            .children(step.exchanges.iter().map(|exchange| exchange_lines(language, exchange)))
    });
    el("li")
        .class("cfg-step")
        .test("report-step")
        .attr("data-point", &step.point)
        .attr("data-outcome", words::outcome_key(&step.outcome))
        .child(el("span").class("cfg-number").text(&(at + 1).to_string()))
        .child(
            el("div")
                .class("cfg-step-body")
                .child(
                    el("p")
                        .class("cfg-step-line")
                        .child(el("b").class("cfg-step-name").text(&words::name(language, profile, &step.point)))
                        .child(change(language, profile, (&step.point, step.before.as_deref(), &step.after), &have))
                        .child(el("span").class("cfg-state").text(&outcome)),
                )
                .children(frames),
        )
}

fn exchange_lines(language: Language, exchange: &Exchange) -> El {
    let heard = if exchange.heard.is_empty() {
        el("span").class("muted").text(language.cfg_heard_nothing())
    } else {
        el("code").text(&hex_spaced(&exchange.heard))
    };
    let trip = exchange.round_trip_us.filter(|_| !exchange.heard.is_empty()).map(milliseconds).unwrap_or_default();
    el("dl")
        .class("cfg-frames")
        .child(el("dt").class("direction tx").attr("title", language.cfg_sent()).text("TX"))
        .child(
            el("dd")
                .child(el("code").text(&hex_spaced(&exchange.sent)))
                .child(el("small").class("muted").text(&words::reach(language, &exchange.reach))),
        )
        .child(el("dt").class("direction rx").attr("title", language.cfg_heard()).text("RX"))
        .child(el("dd").child(heard).child(el("small").class("muted").text(&trip)))
}

/// Date and time as the language writes them.
fn now(language: Language) -> String {
    String::from(js_sys::Date::new_0().to_locale_string(language.tag(), &JsValue::UNDEFINED))
}
