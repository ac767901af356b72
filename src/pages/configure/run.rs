//! Something under way: every step as it stands, how long it takes, and a way to stop.

use std::time::Duration;

use buslens_configure::{Phase, Plan, Progress};

use super::review::change;
use crate::components::button::bare;
use crate::components::icon::{Icon, icon};
use crate::configure::words;
use crate::configuring::Kind;
use crate::dom::{El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// Time between two looks at the clock.
const TICK: Duration = Duration::from_millis(100);

/// The card.
pub(super) fn run_card(app: &'static Workbench) -> El {
    let configure = &app.configure;
    let running = &app.configuring.running;
    let kind = running.with_untracked(|running| running.as_ref().map_or(Kind::Read, |running| running.kind));
    let progress = Memo::new(move |_| running.with(|running| running.as_ref()?.progress.clone()));
    let stopping = Memo::new(move |_| running.with(|running| running.as_ref().is_some_and(|running| running.stopping)));
    // Something that was left half done has steps of its own, which nobody has planned here.
    let plan = if kind == Kind::Apply { configure.writing.get_untracked() } else { None };
    let title = move || title(app.language.get(), kind).to_owned();
    let step_name = move |language: Language, at: u32| {
        let profile = configure.device(app).map(crate::device::Device::profile);
        let point = configure.writing.with(|plan| {
            let at = usize::try_from(at).ok()?;
            Some(plan.as_ref()?.steps.get(at)?.point.clone())
        });
        match (profile, point.filter(|_| kind == Kind::Apply)) {
            (Some(profile), Some(point)) => words::name(language, profile, &point),
            _ => (at + 1).to_string(),
        }
    };
    let phase = move || {
        let language = app.language.get();
        if stopping.get() {
            return language.cfg_cancelling().to_owned();
        }
        let phase = progress.with(|progress| progress.as_ref().map(|progress| progress.phase.clone()));
        words::phase(language, &phase.unwrap_or(Phase::Beginning), |at| step_name(language, at))
    };
    let phase_key = move || {
        let key = progress.with(|progress| progress.as_ref().map(|progress| words::phase_key(&progress.phase)));
        Some(key.unwrap_or("beginning").to_owned())
    };
    let writes = matches!(kind, Kind::Apply | Kind::Recover);
    // What loses the settings cannot be put back.
    let puts_back = plan.as_ref().is_some_and(|plan| plan.ends.is_some());
    el("section")
        .class("card cfg-work")
        .test("run-card")
        .child(
            el("header")
                .child(el("h2").attr("id", "configure-work").attr("tabindex", "-1").live_text(title))
                .child(el("span").class("space"))
                .child(elapsed(app)),
        )
        .child(
            el("div")
                .class("cfg-body cfg-progress")
                .child(
                    el("p")
                        .attr("role", "status")
                        .test("run-phase")
                        .live_attr("data-phase", phase_key)
                        .live_text(phase),
                )
                .child(bar(progress))
                .child(el("p").class("muted").live_text(move || counts(app.language.get(), progress.get().as_ref()))),
        )
        .live_one(move || plan.clone().and_then(|plan| steps(app, &plan, progress)))
        .child(
            el("footer")
                .child(
                    bare("danger", "cancel-run")
                        .flag("disabled", move || stopping.get())
                        .child(icon(Icon::Stop))
                        .child(el("span").live_text(move || {
                            let language = app.language.get();
                            if puts_back { language.cfg_cancel_undo() } else { language.cfg_cancel() }.to_owned()
                        }))
                        .click(|| app.cancel_configuring()),
                )
                .children(writes.then(|| el("span").class("muted").say(app, Language::cfg_keep_power))),
        )
}

fn title(language: Language, kind: Kind) -> &'static str {
    match kind {
        Kind::Read => language.cfg_running_read(),
        Kind::Apply => language.cfg_running_apply(),
        Kind::Find => language.cfg_running_find(),
        Kind::Recover => language.cfg_running_recover(),
    }
}

/// How long it has been going on.
fn elapsed(app: &'static Workbench) -> El {
    let begun = seconds();
    let turn = RwSignal::new(0_u32);
    if let Ok(timer) = set_interval_with_handle(move || turn.update(|turn| *turn = turn.wrapping_add(1)), TICK) {
        on_cleanup(move || timer.clear());
    }
    el("span").class("muted cfg-clock").live_text(move || {
        turn.track();
        app.language.get().cfg_elapsed(&crate::format::fixed(seconds() - begun, 1))
    })
}

fn seconds() -> f64 {
    window().performance().map_or(0.0, |performance| performance.now() / 1000.0)
}

/// How much of the phase is done; without an end where nobody knows.
fn bar(progress: Memo<Option<Progress>>) -> El {
    let share = move || {
        progress.with(|progress| {
            let progress = progress.as_ref().filter(|progress| progress.total > 0)?;
            Some((progress.done, progress.total))
        })
    };
    el("progress")
        .live_attr("max", move || share().map(|(_, total)| total.to_string()))
        .live_attr("value", move || share().map(|(done, total)| done.min(total).to_string()))
}

fn counts(language: Language, progress: Option<&Progress>) -> String {
    let Some(progress) = progress else { return String::new() };
    let done = (progress.total > 0).then(|| language.cfg_done_of(progress.done, progress.total));
    let left = progress.left_ms.map(|left| language.cfg_left(&words::tenths(left.into())));
    done.into_iter().chain(left).collect::<Vec<_>>().join(" \u{B7} ")
}

/// The steps of the plan as they stand.
fn steps(app: &'static Workbench, plan: &Plan, progress: Memo<Option<Progress>>) -> Option<El> {
    let configure = &app.configure;
    let profile = configure.device(app)?.profile();
    let language = app.language.get();
    let have = untrack(|| configure.have(app, profile));
    let item = |(at, step): (usize, &buslens_configure::Step)| {
        let at = u32::try_from(at).unwrap_or(u32::MAX);
        let now = move || {
            let phase = progress.with(|progress| progress.as_ref().map(|progress| progress.phase.clone()));
            words::step_now(language, &phase.unwrap_or(Phase::Beginning), at, configure.last_step.get())
        };
        el("li")
            .class("cfg-step")
            .test("run-step")
            .attr("data-point", &step.point)
            .live_attr("data-state", move || Some(now().0.to_owned()))
            .child(el("span").class("cfg-number").text(&(at + 1).to_string()))
            .child(
                el("p")
                    .class("cfg-step-line")
                    .child(el("b").class("cfg-step-name").text(&words::name(language, profile, &step.point)))
                    .child(change(language, profile, (&step.point, step.before.as_deref(), &step.after), &have))
                    .child(el("span").class("cfg-state").live_text(move || now().1.to_owned())),
            )
    };
    Some(el("ol").class("cfg-steps").children(plan.steps.iter().enumerate().map(item)))
}
