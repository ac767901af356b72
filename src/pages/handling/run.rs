//! A command on its way, and what has come of it. It goes out as a change of the device: kept in a journal, watched until
//! it is known what has become of it, never sent twice.

use buslens_analyst::configure::Hindrance;
use buslens_codec::profile::Profile;
use buslens_configure::{Edit, Ending, Hazard, Plan, Reach, Report, Snapshot, StepOutcome};

use super::{Command, marks, words};
use crate::anatomy::request_in;
use crate::components::button::button;
use crate::components::icon::{Icon, icon};
use crate::device::{self, Device};
use crate::dom::{self, El, el};
use crate::format;
use crate::message::{Exchange, Frames, Live};
use crate::pages::exchange_of;
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// The last command.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    pub(super) command: Command,
    /// The device's profile id.
    device: String,
    /// What the user has confirmed.
    confirmed: Vec<Hazard>,
    state: State,
}

#[derive(Clone, Debug, PartialEq)]
enum State {
    /// The worker that carries it out is being started.
    Waiting,
    /// On its way, under this number.
    UnderWay(u32),
    Ended {
        outcome: Box<Result<Report, Hindrance>>,
        /// Time of day, as `12:03:04`.
        time: String,
    },
}

/// How a command has ended, as far as its words and its look are concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Done,
    /// By an exception with this code.
    Refused(u8),
    Unproven,
    ReadOnly,
    NoAnswer,
    NotSent,
    Interrupted,
    Lost,
}

impl Run {
    pub(super) fn is_under_way(&self) -> bool {
        matches!(self.state, State::Waiting | State::UnderWay(_))
    }
}

/// Gives a command, with everything confirmed that it can cost.
pub(super) fn begin(app: &'static Workbench, command: Command) {
    let Some(live) = app.handling.live.get_untracked() else { return };
    let device = device::find(&live.device);
    let confirmed = hazards(device, &live, &command);
    app.handling.run.set(Some(Run { command, device: live.device, confirmed, state: State::Waiting }));
    app.start_console();
}

/// Hands a command on as soon as there is somebody to carry it out, and takes what has come of it.
pub(super) fn follow(app: &'static Workbench) {
    dom::react(move || {
        let waits = app.handling.run.with(|run| run.as_ref().is_some_and(|run| run.state == State::Waiting));
        // The worker tells the line at once when it is there.
        if waits && app.console.line.with(Option::is_some) {
            untrack(|| hand_on(app));
        }
    });
    dom::react(move || {
        let ended = app.configuring.ended.get();
        if let Some(ended) = ended {
            untrack(|| take(app, ended.run, ended.outcome));
        }
    });
}

fn hand_on(app: &'static Workbench) {
    let Some((run, live)) = app.handling.run.get().zip(app.handling.live.get()) else { return };
    let (before, edits) = change(device::find(&run.device).profile(), &live, &run.command);
    match app.apply(before, edits, run.confirmed.clone()) {
        // Where it could not be begun, that is told already, under this number.
        Some(number) => {
            set_state(app, State::UnderWay(number));
            if let Some(ended) = app.configuring.ended.get().filter(|ended| ended.run == number) {
                take(app, number, ended.outcome);
            }
        }
        None => end(app, Err(Hindrance::Busy)),
    }
}

fn take(app: &'static Workbench, number: u32, outcome: Result<Report, Hindrance>) {
    let is_ours = app.handling.run.with(|run| run.as_ref().is_some_and(|run| run.state == State::UnderWay(number)));
    if is_ours {
        end(app, outcome);
    }
}

fn end(app: &'static Workbench, outcome: Result<Report, Hindrance>) {
    let time = time_of_day();
    if let (Some(run), Verdict::Done) = (app.handling.run.get(), verdict(&outcome))
        && let Some(point) = device::find(&run.device).profile().point(&run.command.point)
    {
        app.handling.marks.update(|marks| *marks = marks::after(std::mem::take(marks), point, &run.command, &time));
    }
    set_state(app, State::Ended { outcome: Box::new(outcome), time });
}

fn set_state(app: &'static Workbench, state: State) {
    app.handling.run.update(|run| {
        if let Some(run) = run {
            run.state = state;
        }
    });
}

/// As `12:03:04`.
fn time_of_day() -> String {
    let now = js_sys::Date::new_0();
    let seconds = u64::from(now.get_hours()) * 3600 + u64::from(now.get_minutes()) * 60 + u64::from(now.get_seconds());
    // Without the milliseconds.
    format::clock(seconds * 1_000_000).chars().take(8).collect()
}

/// How the device is reached.
fn reach(live: &Live) -> Reach {
    Reach { unit: live.unit, line: live.line, mode: live.mode }
}

/// The command as a change of a device of which nothing else is to be known.
fn change(profile: &Profile, live: &Live, command: &Command) -> (Snapshot, Vec<Edit>) {
    let edit = Edit { point: command.point.clone(), registers: vec![command.code] };
    (Snapshot::empty(profile, reach(live)), vec![edit])
}

/// What the command can cost.
pub(super) fn hazards(device: &Device, live: &Live, command: &Command) -> Vec<Hazard> {
    let (have, edits) = change(device.profile(), live, command);
    Plan::of(device.profile(), &have, &edits).map(|plan| plan.hazards).unwrap_or_default()
}

fn verdict(outcome: &Result<Report, Hindrance>) -> Verdict {
    let report = match outcome {
        Ok(report) => report,
        Err(Hindrance::ReadOnly) => return Verdict::ReadOnly,
        Err(Hindrance::NoPort) => return Verdict::Interrupted,
        Err(_) => return Verdict::NotSent,
    };
    let refused = report.steps.iter().find_map(|step| match step.outcome {
        StepOutcome::Refused(code) => Some(code),
        _ => None,
    });
    match (&report.ending, refused) {
        (Ending::Done | Ending::Found, _) => Verdict::Done,
        (_, Some(code)) => Verdict::Refused(code),
        (Ending::Unproven(_), _) => Verdict::Unproven,
        (Ending::ReadOnly, _) => Verdict::ReadOnly,
        (Ending::NoAnswer, _) => Verdict::NoAnswer,
        (Ending::Interrupted, _) => Verdict::Interrupted,
        (Ending::Lost(_) | Ending::NotFound { .. } | Ending::Partly(_) | Ending::RolledBack(_), _) => Verdict::Lost,
        _ => Verdict::NotSent,
    }
}

/// What has come of the last command.
pub(super) fn outcome(app: &'static Workbench, device: &'static Device) -> El {
    let verdict_now = move || {
        app.handling.run.with(|run| match run.as_ref().map(|run| &run.state) {
            Some(State::Ended { outcome, .. }) => Some(verdict(outcome)),
            _ => None,
        })
    };
    let state = move || {
        app.handling.run.with(Option::is_some).then(|| verdict_now().map_or("running", Verdict::state).to_owned())
    };
    el("div")
        .class("command-outcome")
        .attr("role", "status")
        .test("command-outcome")
        .live_attr("data-state", state)
        .live_attr("data-verdict", move || verdict_now().map(|verdict| verdict.name().to_owned()))
        .live(move || {
            let language = app.language.get();
            app.handling.run.with(|run| {
                let run = run.as_ref().filter(|run| run.device == device.id());
                run.map(|run| told(app, language, device, run)).unwrap_or_default()
            })
        })
}

fn told(app: &'static Workbench, language: Language, device: &'static Device, run: &Run) -> Vec<El> {
    let point = device.profile().point(&run.command.point);
    let Some((point, code)) = point.and_then(|point| Some((point, point.code(run.command.code)?))) else {
        return Vec::new();
    };
    let name = words::command(language, point, code);
    let line = |mark: Option<Icon>, text: &str| {
        el("p").class("command-line").children(mark.map(icon)).child(el("span").text(text))
    };
    let State::Ended { outcome, time } = &run.state else {
        return vec![line(None, &language.command_sending(&name))];
    };
    let verdict = verdict(outcome);
    let text = match verdict {
        Verdict::Done => language.command_done(&name, time),
        Verdict::Refused(code) => language.command_refused(&name, code, language.exception_name(code)),
        Verdict::Unproven => language.command_unproven(&name),
        Verdict::ReadOnly | Verdict::NotSent => language.command_not_sent(&name),
        Verdict::NoAnswer => language.command_no_answer(&name),
        Verdict::Interrupted => language.command_interrupted(&name),
        Verdict::Lost => language.command_lost(&name),
    };
    let tip = match verdict {
        Verdict::Unproven => Some(language.command_unproven_tip()),
        Verdict::ReadOnly => Some(language.commands_locked_read_only()),
        Verdict::NotSent => words::hindrance(language, outcome),
        _ => None,
    };
    let dismiss =
        button(app, "quiet small", "command-dismiss", Language::dismiss).click(move || app.handling.run.set(None));
    let mark = if verdict == Verdict::Done { Icon::Done } else { Icon::Fault };
    let mut all = vec![line(Some(mark), &text).child(dismiss)];
    all.extend(tip.map(|tip| el("p").class("tip").text(tip)));
    // The command's own exchange: what looks for the device before and afterwards is the log's affair.
    let steps = outcome.as_ref().as_ref().map(|report| report.steps.as_slice()).unwrap_or_default();
    if let Some(exchange) = steps.iter().flat_map(|step| &step.exchanges).find(|exchange| writes(exchange)) {
        let frames = Frames { sent: exchange.sent.clone(), received: exchange.heard.clone() };
        let exchange = Exchange { device: run.device.clone(), mode: exchange.reach.mode, frames };
        all.push(
            el("details")
                .class("command-frames")
                .test("command-frames")
                .child(el("summary").say(app, Language::command_frames))
                .children(exchange_of(language, &exchange)),
        );
    }
    all
}

fn writes(exchange: &buslens_configure::Exchange) -> bool {
    request_in(&exchange.sent, exchange.reach.mode).is_some_and(|(_, request)| request.is_write())
}

impl Verdict {
    /// Its stable name, for tests.
    fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Refused(_) => "refused",
            Self::Unproven => "unproven",
            Self::ReadOnly => "read-only",
            Self::NoAnswer => "no-answer",
            Self::NotSent => "not-sent",
            Self::Interrupted => "interrupted",
            Self::Lost => "lost",
        }
    }

    /// How it looks.
    fn state(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Unproven | Self::Interrupted | Self::Lost => "unknown",
            Self::Refused(_) | Self::ReadOnly | Self::NoAnswer | Self::NotSent => "failed",
        }
    }
}
