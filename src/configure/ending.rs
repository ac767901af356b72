//! How a procedure has ended, as sentences: what happened, what to try, and what the page can do about it.

use buslens_codec::profile::Profile;
use buslens_configure::{Ending, Reach, Report, Snapshot, Why};

use super::words;
use crate::text::Language;

/// How good an ending is, for colours and tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Grade {
    /// As it was wanted.
    Good,
    /// Not as it was wanted, and nothing is lost.
    Harmless,
    /// The device needs its user.
    Bad,
}

impl Grade {
    /// Its name for styles.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Harmless => "warn",
            Self::Bad => "bad",
        }
    }
}

/// An ending as sentences.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Told {
    /// Its stable name, for tests.
    pub(crate) key: &'static str,
    /// How good it is.
    pub(crate) grade: Grade,
    /// What happened, in a few words.
    pub(crate) title: &'static str,
    /// What happened, in a sentence or two.
    pub(crate) what: String,
    /// Single faults of it, if it has several.
    pub(crate) list: Vec<String>,
    /// What to try.
    pub(crate) tip: Option<&'static str>,
    /// Whether the page offers to search the device.
    pub(crate) search: bool,
}

/// The ending of a report. `have` is what the device was last known to hold, for the scale of values.
pub(crate) fn told(language: Language, profile: &Profile, report: &Report, have: &Snapshot) -> Told {
    use Grade::{Bad, Good, Harmless};
    let t = language;
    let at = |place: &Reach| words::reach(t, place);
    let why = |why: &Why| cause(t, profile, report, why, have);
    let plain =
        |key, grade, title, what: String| Told { key, grade, title, what, list: Vec::new(), tip: None, search: false };
    let tip = |told: Told, tip| Told { tip: Some(tip), ..told };
    match &report.ending {
        Ending::Done => plain("done", Good, t.cfg_done(), t.cfg_done_what().to_owned()),
        Ending::Unproven(cause) => {
            let what = t.cfg_unproven_what(&why(cause).0);
            tip(plain("unproven", Harmless, t.cfg_unproven(), what), t.cfg_unproven_tip())
        }
        Ending::Found => {
            let place = report.reach.as_ref().map(at).unwrap_or_default();
            plain("found", Good, t.cfg_found(), t.cfg_found_what(&place))
        }
        Ending::Undone => plain("undone", Good, t.cfg_undone(), t.cfg_undone_what().to_owned()),
        Ending::Unconfirmed(_) => {
            plain("unconfirmed", Harmless, t.cfg_unconfirmed(), t.cfg_unconfirmed_what().to_owned())
        }
        Ending::Refused(refused) => {
            let line = |refusal: &buslens_configure::Refusal| {
                let name = words::name(t, profile, &refusal.point);
                [&name, ": ", &words::unfit(t, profile, &refusal.point, &refusal.why)].concat()
            };
            let told = plain("refused", Harmless, t.cfg_refused(), t.cfg_refused_what().to_owned());
            Told { list: refused.iter().map(line).collect(), ..told }
        }
        Ending::Differs(differences) => {
            let names: Vec<String> = differences.iter().map(|one| words::name(t, profile, &one.point)).collect();
            plain("differs", Harmless, t.cfg_changed(), t.cfg_changed_what(&words::listed(t, &names)))
        }
        Ending::Occupied(place) => {
            let told = plain("occupied", Harmless, t.cfg_occupied(), t.cfg_occupied_what(&at(place)));
            tip(told, t.cfg_occupied_tip())
        }
        Ending::PortRefuses(place) => {
            plain("port-refuses", Harmless, t.cfg_port_refuses(), t.cfg_port_refuses_what(&at(place)))
        }
        Ending::NotKept => {
            tip(plain("not-kept", Harmless, t.cfg_not_kept(), t.cfg_not_kept_what().to_owned()), t.cfg_not_kept_tip())
        }
        Ending::ReadOnly => plain("read-only", Harmless, t.cfg_read_only_ended(), t.cfg_blocked_read_only().to_owned()),
        Ending::NoAnswer => {
            let place = report.candidates.first().map_or_else(|| at(&have.reach), at);
            let told = plain("no-answer", Bad, t.cfg_no_answer(), t.cfg_no_answer_what(&place));
            Told { search: true, ..tip(told, t.cfg_no_answer_tip()) }
        }
        Ending::BadJournal => {
            let told = plain("bad-journal", Bad, t.cfg_bad_journal(), t.cfg_bad_journal_what().to_owned());
            Told { search: true, ..told }
        }
        Ending::RolledBack(cause) => {
            let (name, outcome) = why(cause);
            plain("rolled-back", Harmless, t.cfg_rolled_back(), t.cfg_rolled_back_what(&name, &outcome))
        }
        Ending::Partly(cause) => {
            let (name, outcome) = why(cause);
            plain("partly", Bad, t.cfg_partly(), t.cfg_partly_what(&name, &outcome))
        }
        Ending::Lost(cause) => {
            let (name, outcome) = why(cause);
            let told = plain("lost", Bad, t.cfg_lost(), t.cfg_lost_what(&name, &outcome));
            Told { search: true, ..tip(told, t.cfg_lost_tip()) }
        }
        Ending::NotFound { garbled } => {
            let what = if *garbled { t.cfg_not_found_garbled() } else { t.cfg_not_found_what() };
            let told = plain("not-found", Bad, t.cfg_not_found(), what.to_owned());
            Told { search: true, ..tip(told, t.cfg_not_found_tip()) }
        }
        Ending::Interrupted => {
            let clean = report.journal.is_none();
            let what = if clean { t.cfg_interrupted_clean() } else { t.cfg_interrupted_what() };
            plain("interrupted", if clean { Harmless } else { Bad }, t.cfg_interrupted(), what.to_owned())
        }
        Ending::Cancelled => {
            let what = if report.writes == 0 { t.cfg_cancelled_clean() } else { t.cfg_cancelled_what() };
            plain("cancelled", Harmless, t.cfg_cancelled(), what.to_owned())
        }
    }
}

/// The step that went wrong, and how.
fn cause(language: Language, profile: &Profile, report: &Report, why: &Why, have: &Snapshot) -> (String, String) {
    let step = usize::try_from(why.step).ok().and_then(|at| report.steps.get(at));
    let point = step.map(|step| step.point.as_str()).unwrap_or_default();
    let outcome = words::outcome(language, &why.outcome, |read| words::read(language, profile, point, read, have));
    (words::name(language, profile, point), outcome)
}

#[cfg(test)]
mod tests {
    use buslens_configure::{StepOutcome, StepReport};

    use super::*;
    use crate::device;

    fn report(ending: Ending) -> Report {
        Report {
            ending,
            steps: vec![StepReport {
                point: "baud".to_owned(),
                before: Some(vec![3]),
                after: vec![7],
                outcome: StepOutcome::Silent,
                exchanges: Vec::new(),
            }],
            reach: None,
            candidates: Vec::new(),
            snapshot: None,
            journal: Some(1),
            writes: 1,
            took_us: 0,
        }
    }

    #[test]
    fn every_ending_says_what_happened_in_both_languages() {
        let profile = device::find("lvdt").profile();
        let have = Snapshot::empty(profile, Reach::of_factory(profile));
        let why = Why { step: 0, outcome: StepOutcome::Silent };
        let at = Reach::of_factory(profile);
        let all = [
            Ending::Done,
            Ending::Unproven(why.clone()),
            Ending::Found,
            Ending::Undone,
            Ending::Unconfirmed(Vec::new()),
            Ending::Refused(Vec::new()),
            Ending::Differs(Vec::new()),
            Ending::Occupied(at),
            Ending::PortRefuses(at),
            Ending::NotKept,
            Ending::ReadOnly,
            Ending::NoAnswer,
            Ending::BadJournal,
            Ending::RolledBack(why.clone()),
            Ending::Partly(why.clone()),
            Ending::Lost(why),
            Ending::NotFound { garbled: true },
            Ending::NotFound { garbled: false },
            Ending::Interrupted,
            Ending::Cancelled,
        ];
        let mut keys = Vec::new();
        for ending in all {
            let report = report(ending);
            let english = told(Language::En, profile, &report, &have);
            let chinese = told(Language::Zh, profile, &report, &have);
            assert!(!english.what.is_empty() && english.title != chinese.title, "{}", english.key);
            keys.push(english.key);
        }
        keys.dedup();
        assert_eq!(keys.len(), 19);
    }

    #[test]
    fn a_lost_device_is_told_with_the_step_and_the_search() {
        let profile = device::find("lvdt").profile();
        let have = Snapshot::empty(profile, Reach::of_factory(profile));
        let lost = report(Ending::Lost(Why { step: 0, outcome: StepOutcome::Silent }));
        let told = told(Language::En, profile, &lost, &have);
        assert!(told.what.starts_with("Baud rate: the device did not answer after it."), "{}", told.what);
        assert!(told.search && told.grade == Grade::Bad && told.tip.is_some());
    }
}
