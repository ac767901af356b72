//! How far something is, and how it has ended, in words.

use buslens_analyst::configure::Hindrance;
use buslens_codec::profile::Profile;
use buslens_configure::{Phase, Plan, Progress, Reach, Report, Snapshot};

use crate::configure::{ending, words};
use crate::text::Language;

/// How something has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Ended {
    /// Its stable name, for tests.
    pub(super) key: &'static str,
    /// In a few words.
    pub(super) title: String,
    /// In a sentence or two.
    pub(super) what: String,
    /// What to try; may be empty.
    pub(super) tip: String,
}

impl Ended {
    /// Of a procedure's outcome.
    pub(super) fn of(language: Language, profile: &Profile, outcome: &Result<Report, Hindrance>) -> Self {
        match outcome {
            Ok(report) => Self::of_report(language, profile, report),
            Err(why) => Self::of_hindrance(language, why),
        }
    }

    /// Of a report.
    pub(super) fn of_report(language: Language, profile: &Profile, report: &Report) -> Self {
        let reach = report.reach.unwrap_or_else(|| Reach::of_factory(profile));
        let told = ending::told(language, profile, report, &Snapshot::empty(profile, reach));
        let what = [told.what].into_iter().chain(told.list).collect::<Vec<_>>().join(" ");
        Self { key: told.key, title: told.title.to_owned(), what, tip: told.tip.unwrap_or_default().to_owned() }
    }

    /// Of something that was not begun.
    pub(super) fn of_hindrance(language: Language, why: &Hindrance) -> Self {
        let what = crate::pages::configure::hindrance(language, why);
        Self { key: "not-begun", title: language.fleet_not_begun().to_owned(), what, tip: String::new() }
    }
}

/// How far something is, in a line.
pub(super) fn line(language: Language, progress: Option<&Progress>) -> String {
    of_plan(language, progress, None)
}

/// The same for a plan that is being written.
pub(super) fn of_plan(language: Language, progress: Option<&Progress>, plan: Option<(&Profile, &Plan)>) -> String {
    let name = |at: u32| {
        let step = usize::try_from(at).ok().and_then(|at| plan?.1.steps.get(at).map(|step| step.point.clone()));
        match (plan, step) {
            (Some((profile, _)), Some(point)) => words::name(language, profile, &point),
            _ => (at + 1).to_string(),
        }
    };
    let phase = progress.map_or(Phase::Beginning, |progress| progress.phase.clone());
    let mut parts = vec![words::phase(language, &phase, name)];
    if let Some(progress) = progress {
        parts.extend((progress.total > 0).then(|| language.cfg_done_of(progress.done, progress.total)));
        parts.extend(progress.left_ms.map(|left| language.cfg_left(&words::tenths(left.into()))));
    }
    parts.join(" \u{B7} ")
}
