//! The device's commands: a button each, the question before one that can cost something, and what has come of the last.

use buslens_codec::profile::{Code, Danger, Point, Role};
use buslens_codec::value::Value;

use super::run::{Run, begin, hazards, outcome};
use super::{Command, words};
use crate::components::button::{bare, button};
use crate::components::icon::{Icon, icon};
use crate::device::{self, Device};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// All of them; those that can lose settings are folded away.
pub(super) fn commands(app: &'static Workbench, device: &'static Device) -> El {
    let locked = app.handling.live(words::lock);
    let locked = Memo::new(move |_| locked.get().flatten());
    let why = move || {
        locked.get().map(|lock| {
            el("p")
                .class("commands-locked")
                .test("commands-locked")
                .attr("data-why", lock.name())
                .child(icon(Icon::Lock))
                .child(el("span").say(app, lock.text()))
        })
    };
    let groups = |risky: bool| {
        let points = device.profile().points.iter().filter(|point| point.role == Role::Command);
        points.filter_map(|point| group(app, point, locked, risky)).collect::<Vec<_>>()
    };
    let risky = groups(true);
    let folded = (!risky.is_empty()).then(|| {
        el("details")
            .class("risky")
            .test("risky")
            .child(el("summary").say(app, Language::commands_risky))
            .child(el("div").class("command-groups").children(risky))
    });
    el("div")
        .class("commands")
        .live_one(why)
        .child(el("div").class("command-groups").children(groups(false)))
        .children(folded)
        .live_one(move || app.handling.asked.get().and_then(|command| question(app, device, command)))
        .child(outcome(app, device))
}

/// The buttons of one point, as far as they can lose settings or cannot.
fn group(app: &'static Workbench, point: &'static Point, locked: Memo<Option<words::Lock>>, risky: bool) -> Option<El> {
    let fits = |code: &&Code| (point.danger_of(Value::Code(code.code)) == Danger::Danger) == risky;
    let buttons: Vec<El> =
        point.codes.iter().filter(fits).map(|code| command_button(app, point, code, locked)).collect();
    if buttons.is_empty() {
        return None;
    }
    // A point with one command is named by its button.
    let name = move || device::pick(app.language.get(), &point.name).to_owned();
    let title = (point.codes.len() > 1).then(|| el("small").live_text(name));
    Some(
        el("div")
            .class("command-group")
            .attr("role", "group")
            .live_attr("aria-label", move || Some(name()))
            .children(title)
            .child(el("div").class("command-buttons").children(buttons)),
    )
}

fn command_button(
    app: &'static Workbench,
    point: &'static Point,
    code: &'static Code,
    locked: Memo<Option<words::Lock>>,
) -> El {
    let command = Command { point: point.id.clone(), code: code.code };
    let danger = point.danger_of(Value::Code(code.code));
    let (asked, running) = (command.clone(), command.clone());
    let running_now = move || app.handling.run.with(|run| run.as_ref().is_some_and(Run::is_under_way));
    let busy = Memo::new(move |_| running_now() || app.configuring.is_busy());
    bare(if danger == Danger::Danger { "danger" } else { "" }, &command.hook())
        .attr("id", &command.hook())
        .flag("disabled", move || locked.get().is_some() || busy.get())
        .live_attr("title", move || locked.get().map(|lock| lock.text()(app.language.get()).to_owned()))
        .state("aria-expanded", move || app.handling.asked.with(|now| now.as_ref() == Some(&asked)))
        .state("data-running", move || {
            app.handling.run.with(|run| run.as_ref().is_some_and(|run| run.is_under_way() && run.command == running))
        })
        .live_text(move || words::button(app.language.get(), point, code))
        .click(move || press(app, point, command.clone()))
}

/// What costs nothing is done at once; everything else is asked first.
fn press(app: &'static Workbench, point: &'static Point, command: Command) {
    let can_cost = app.handling.live.with_untracked(|live| {
        let device = live.as_ref().map(|live| (device::find(&live.device), live));
        device.is_none_or(|(device, live)| !hazards(device, live, &command).is_empty())
    });
    if !can_cost && point.danger_of(Value::Code(command.code)) == Danger::None {
        begin(app, command);
        return;
    }
    app.handling.asked.set(Some(command));
    request_animation_frame(|| {
        if !dom::focus(ACCEPT) {
            dom::focus(CONFIRM);
        }
    });
}

/// The first box to be ticked.
const ACCEPT: &str = "command-accept";
/// The button that sends.
const CONFIRM: &str = "command-confirm";

/// The question, with everything that the command costs. What can lose settings is only sent once each cost is ticked.
fn question(app: &'static Workbench, device: &'static Device, command: Command) -> Option<El> {
    let point = device.profile().point(&command.point)?;
    let code = point.code(command.code)?;
    let live = app.handling.live.get_untracked()?;
    let hazards = hazards(device, &live, &command);
    let risky = !hazards.is_empty();
    let accepted = RwSignal::new(vec![false; hazards.len()]);
    let close = {
        let hook = command.hook();
        move || {
            app.handling.asked.set(None);
            dom::focus(&hook);
        }
    };
    let costs: Vec<El> = hazards
        .into_iter()
        .enumerate()
        .map(|(at, hazard)| {
            let tick = el("input").attr("type", "checkbox").test("command-accept").on("change", move |event| {
                let on = dom::is_checked(&event);
                accepted.update(|all| {
                    if let Some(accepted) = all.get_mut(at) {
                        *accepted = on;
                    }
                });
            });
            let tick = if at == 0 { tick.attr("id", ACCEPT) } else { tick };
            let text = move || words::hazard(app.language.get(), device, &hazard);
            el("label").class("accept").child(tick).child(el("span").live_text(text))
        })
        .collect();
    let cost = point.consequence_of(Value::Code(code.code));
    let costs_told = cost.into_iter().filter(|_| !risky).chain(&point.note);
    let note = costs_told.map(|note| el("p").live_text(move || device::pick(app.language.get(), note).to_owned()));
    let ask = move || app.language.get().command_ask(&words::command(app.language.get(), point, code));
    let confirm = bare(if risky { "danger" } else { "primary" }, CONFIRM)
        .attr("id", CONFIRM)
        .flag("disabled", move || accepted.with(|all| all.contains(&false)))
        .live_text(move || words::button(app.language.get(), point, code));
    let cancel = button(app, "quiet", "command-cancel", Language::command_cancel).click(close.clone());
    let escape = close.clone();
    Some(
        el("section")
            .class("command-question")
            .attr("role", "alertdialog")
            .attr("data-risky", if risky { "true" } else { "false" })
            .test("command-question")
            .live_attr("aria-label", move || Some(ask()))
            .on("keydown", move |event| {
                if dom::key(&event) == "Escape" {
                    event.prevent_default();
                    escape();
                }
            })
            .child(el("h3").live_text(ask))
            .children(note)
            .children(risky.then(|| el("p").say(app, Language::command_accept)))
            .children(costs)
            .child(el("div").class("command-answers").child(cancel).child(confirm.click(move || {
                close();
                begin(app, command.clone());
            }))),
    )
}

impl Command {
    /// Its name for tests, which is its button's id.
    fn hook(&self) -> String {
        ["command-", &self.point, "-", &self.code.to_string()].concat()
    }
}
