//! A plan before it is written: every change, every frame, every danger, and a deliberate second action.

use buslens_codec::profile::Profile;
use buslens_configure::{After, Hazard, Plan, Refusal, Snapshot, Step};

use super::hint;
use super::state::Wish;
use crate::components::button::button;
use crate::components::icon::{Icon, icon};
use crate::configure::words;
use crate::dom::{self, El, el};
use crate::format::{self, hex_spaced};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// The card.
pub(super) fn review_card(app: &'static Workbench) -> El {
    let configure = &app.configure;
    let plan = Memo::new(move |_| configure.plan(app));
    let content = move || {
        // Everything that matters of them is in the plan.
        let device = untrack(|| configure.device(app));
        let Some(profile) = device.map(crate::device::Device::profile) else { return Vec::new() };
        let have = untrack(|| configure.have(app, profile));
        match plan.get() {
            None => Vec::new(),
            Some((_, Ok(plan))) if plan.steps.is_empty() => nothing(app),
            Some((_, Ok(plan))) => planned(app, profile, &plan, &have),
            Some((_, Err(refused))) => faults(app, profile, &refused),
        }
    };
    el("section")
        .class("card cfg-work")
        .test("review-card")
        .on("keydown", move |event| {
            if dom::key(&event) == "Escape" {
                configure.reviewing.set(None);
            }
        })
        .child(
            el("header").child(
                el("h2").attr("id", "configure-work").attr("tabindex", "-1").say(app, Language::cfg_review_title),
            ),
        )
        .live(content)
}

fn back(app: &'static Workbench) -> El {
    button(app, "", "review-back", Language::cfg_back).click(|| app.configure.reviewing.set(None))
}

fn nothing(app: &'static Workbench) -> Vec<El> {
    let words = el("p").class("empty").test("review-empty").say(app, Language::cfg_review_none);
    vec![words, el("footer").child(back(app))]
}

fn faults(app: &'static Workbench, profile: &Profile, refused: &[Refusal]) -> Vec<El> {
    let language = app.language.get();
    let line = |refusal: &Refusal| {
        let name = words::name(language, profile, &refusal.point);
        let why = words::unfit(language, profile, &refusal.point, &refusal.why);
        el("li").child(el("b").text(&name)).text(" \u{2013} ").text(&why)
    };
    let list = el("div")
        .class("cfg-body")
        .attr("role", "alert")
        .test("review-faults")
        .child(el("p").say(app, Language::cfg_review_faults))
        .child(el("ul").class("cfg-list").children(refused.iter().map(line)));
    vec![list, el("footer").child(back(app))]
}

fn planned(app: &'static Workbench, profile: &'static Profile, plan: &Plan, have: &Snapshot) -> Vec<El> {
    let language = app.language.get();
    let steps = plan.steps.iter().enumerate().map(|(at, step)| step_item(language, profile, at, step, have));
    let mut all = vec![
        el("p").class("cfg-ends").test("review-ends").text(&ends(language, plan)),
        el("ol").class("cfg-steps").children(steps),
        el("p").class("cfg-about muted").live_text({
            let (steps, is_lost) = (plan.steps.len(), plan.ends.is_none());
            move || about(app, profile, steps, is_lost)
        }),
    ];
    if !plan.hazards.is_empty() {
        all.push(hazards(app, profile, &plan.hazards));
    }
    all.push(answers(app, profile, plan));
    all
}

/// How the device is reached before and after.
fn ends(language: Language, plan: &Plan) -> String {
    let begins = language.cfg_begins(&words::reach(language, &plan.begins));
    let ends = match plan.ends {
        Some(reach) if reach == plan.begins => language.cfg_ends_same().to_owned(),
        Some(reach) => language.cfg_ends(&words::reach(language, &reach)),
        None => language.cfg_ends_unknown().to_owned(),
    };
    [&begins, " ", &ends].concat()
}

/// Their order, what they cost.
fn about(app: &'static Workbench, profile: &Profile, steps: usize, is_lost: bool) -> String {
    let language = app.language.get();
    let order = if is_lost { language.cfg_order_lost() } else { language.cfg_order() };
    let cost = match steps {
        1 => language.cfg_cost_one().to_owned(),
        count => language.cfg_cost(count),
    };
    let worn = app.worn().map(|count| {
        let count = format::count(count);
        match profile.timing.flash_writes {
            0 => language.cfg_worn_unknown(&count),
            endures => language.cfg_worn(&count, &format::count(endures.into())),
        }
    });
    let mut parts = Vec::new();
    if steps > 1 || is_lost {
        parts.push(order.to_owned());
    }
    parts.push(cost);
    parts.extend(worn);
    parts.join(" ")
}

/// What is written over what.
pub(super) fn change(
    language: Language,
    profile: &Profile,
    step: (&str, Option<&[u16]>, &[u16]),
    have: &Snapshot,
) -> El {
    let (point, before, after) = step;
    let value = |registers: &[u16]| match profile.point(point) {
        Some(point) => words::value(language, profile, point, registers, have),
        None => words::registers(registers),
    };
    let change = el("span").class("cfg-change");
    let new = el("b").text(&value(after));
    match before {
        Some(before) => change.child(el("span").class("cfg-old").text(&value(before))).child(icon(Icon::Go)).child(new),
        None => change.child(new),
    }
}

fn step_item(language: Language, profile: &Profile, at: usize, step: &Step, have: &Snapshot) -> El {
    let name = words::name(language, profile, &step.point);
    let moves = step.then != After::Same;
    let effect = el("p").class("cfg-effect").text(&words::after(language, &step.then));
    let reply = if step.reply.is_empty() { language.cfg_reply_none().to_owned() } else { hex_spaced(&step.reply) };
    let at_reach = words::reach(language, &step.at);
    let frames = el("dl")
        .class("cfg-frames")
        .child(el("dt").class("direction tx").attr("title", language.cfg_request()).text("TX"))
        .child(
            el("dd")
                .child(el("code").test("step-request").text(&hex_spaced(&step.request)))
                .child(el("small").class("muted").text(&at_reach)),
        )
        .child(el("dt").class("direction rx").attr("title", language.cfg_reply()).text("RX"))
        .child(
            el("dd")
                .child(el("code").test("step-reply").text(&reply))
                .child(el("small").class("muted").text(language.cfg_reply())),
        );
    el("li")
        .class("cfg-step")
        .test("review-step")
        .attr("data-point", &step.point)
        .child(el("span").class("cfg-number").text(&(at + 1).to_string()))
        .child(
            el("div")
                .class("cfg-step-body")
                .child(el("p").class("cfg-step-line").child(el("b").class("cfg-step-name").text(&name)).child(change(
                    language,
                    profile,
                    (&step.point, step.before.as_deref(), &step.after),
                    have,
                )))
                .children(moves.then_some(effect))
                .child(frames),
        )
}

/// A box to tick for each danger: it names the consequence.
fn hazards(app: &'static Workbench, profile: &'static Profile, hazards: &[Hazard]) -> El {
    let configure = &app.configure;
    let tick = |(at, hazard): (usize, &Hazard)| {
        let text = words::hazard(app.language.get(), profile, hazard);
        let (shown, hazard) = (hazard.clone(), hazard.clone());
        let is_confirmed = move || configure.confirmed.with(|confirmed| confirmed.contains(&shown));
        let id = format!("cfg-hazard-{at}");
        let tick = el("input").attr("type", "checkbox").attr("id", &id).test("hazard").click(move || {
            configure.confirmed.update(|confirmed| match confirmed.iter().position(|known| *known == hazard) {
                Some(place) => {
                    confirmed.remove(place);
                }
                None => confirmed.push(hazard.clone()),
            });
        });
        let tick = tick.live_checked(is_confirmed);
        el("label").class("cfg-hazard").attr("for", &id).child(tick).child(el("span").test("hazard-text").text(&text))
    };
    el("fieldset")
        .class("cfg-hazards")
        .test("hazards")
        .child(el("legend").child(icon(Icon::Fault)).child(el("span").say(app, Language::cfg_confirm_title)))
        .children(hazards.iter().enumerate().map(tick))
}

/// The two ways on, and why the one that writes cannot be taken.
fn answers(app: &'static Workbench, profile: &'static Profile, plan: &Plan) -> El {
    let configure = &app.configure;
    let wanted = plan.hazards.clone();
    let grave = !wanted.is_empty();
    let missing = Memo::new(move |_| {
        configure.confirmed.with(|confirmed| wanted.iter().any(|hazard| !confirmed.contains(hazard)))
    });
    let count = plan.steps.len();
    let command = match configure.reviewing.get_untracked() {
        Some(Wish::Command(edit)) => Some(edit),
        _ => None,
    };
    let have = Snapshot::empty(profile, plan.begins);
    let text = move || {
        let language = app.language.get();
        match (&command, count) {
            (Some(edit), _) => {
                let point = profile.point(&edit.point);
                let value = point.map(|point| words::value(language, profile, point, &edit.registers, &have));
                language.cfg_carry_out(&value.unwrap_or_default())
            }
            (None, 1) => language.cfg_write_one().to_owned(),
            (None, count) => language.cfg_write(count),
        }
    };
    let why = move || {
        let language = app.language.get();
        let blocked = app.blocked(true).map(|blocked| blocked.text(language).to_owned());
        blocked.or_else(|| missing.get().then(|| language.cfg_confirm_missing().to_owned()))
    };
    let write = crate::components::button::bare(if grave { "danger" } else { "primary" }, "write")
        .flag("disabled", move || why().is_some())
        .live_text(text)
        .click(move || configure.write(app));
    el("footer").child(write).child(back(app)).live_one(move || {
        let why = why()?;
        Some(hint("info", &why).test("write-blocked"))
    })
}
