//! Plans, dangers, refusals and progress in words.

use buslens_codec::profile::{Point, Profile, Texts};
use buslens_codec::value::Encoding;
use buslens_configure::{
    After, Datum, FileFault, FileReason, Hazard, Phase, Plan, Reach, Read, Shown, Snapshot, StepOutcome, Unfit,
};

use crate::format::{self, signed};
use crate::text::Language;

/// A profile's text in one language.
pub(crate) fn pick(language: Language, texts: &Texts) -> &String {
    match language {
        Language::En => &texts.en,
        Language::Zh => &texts.zh,
    }
}

/// The name of a point; its id where the profile knows none.
pub(crate) fn name(language: Language, profile: &Profile, point: &str) -> String {
    profile.point(point).map_or_else(|| point.to_owned(), |point| pick(language, &point.name).clone())
}

/// `9600 8E1 · RTU · unit 12`.
pub(crate) fn reach(language: Language, reach: &Reach) -> String {
    let mode = crate::components::shell::mode_name(reach.mode);
    [&reach.line.to_string(), " \u{B7} ", mode, " \u{B7} ", &language.unit_id(reach.unit.0)].concat()
}

/// Registers as pairs of bytes in hexadecimal.
pub(crate) fn registers(registers: &[u16]) -> String {
    let words: Vec<String> = registers.iter().map(|word| format!("{word:04X}")).collect();
    words.join(" ")
}

/// What registers say of a point of a device that otherwise holds what `have` tells.
pub(crate) fn shown(
    profile: &Profile,
    point: &Point,
    registers: &[u16],
    have: &Snapshot,
    language: impl Fn(&Texts) -> &String,
) -> Option<Shown> {
    let mut told = have.clone();
    told.data.retain(|datum| datum.point != point.id);
    told.data.push(Datum { point: point.id.clone(), read: Read::Registers(registers.to_vec()) });
    told.values(profile, language).into_iter().find(|shown| shown.point == point.id)
}

/// A point's value as people read it: with a real minus sign, and a word for a text without characters. In a name and in
/// a text a hyphen is a hyphen.
pub(crate) fn readable(language: Language, point: &Point, text: &str) -> String {
    match point.encoding {
        _ if text.is_empty() => language.cfg_empty().to_owned(),
        Encoding::Code | Encoding::Bits { .. } | Encoding::Text { .. } => text.to_owned(),
        _ => signed(text),
    }
}

/// The same as people read it, with its unit; the registers where they hold no value.
pub(crate) fn value(
    language: Language,
    profile: &Profile,
    point: &Point,
    registers: &[u16],
    have: &Snapshot,
) -> String {
    let shown = shown(profile, point, registers, have, |texts| pick(language, texts));
    match shown.and_then(|shown| Some((shown.text?, shown.unit))) {
        Some((text, unit)) if unit.is_empty() || text.is_empty() => readable(language, point, &text),
        Some((text, unit)) => [&readable(language, point, &text), " ", &unit].concat(),
        None => self::registers(registers),
    }
}

/// The same for what was read.
pub(crate) fn read(language: Language, profile: &Profile, point: &str, read: &Read, have: &Snapshot) -> String {
    match (read, profile.point(point)) {
        (Read::Registers(registers), Some(point)) => value(language, profile, point, registers, have),
        (Read::Registers(registers), None) => self::registers(registers),
        (Read::Refused(code), _) => language.cfg_refused_read(*code, language.exception_name(*code)),
        (Read::NoAnswer, _) => language.cfg_no_answer_read().to_owned(),
    }
}

/// Why something is not written, with what is allowed.
pub(crate) fn unfit(language: Language, profile: &Profile, point: &str, why: &Unfit) -> String {
    match why {
        Unfit::UnknownPoint => language.cfg_unfit_unknown().to_owned(),
        Unfit::NotWritable => language.cfg_unfit_not_writable().to_owned(),
        Unfit::NotANumber => {
            let unit = profile.point(point).map(|point| point.unit.as_str()).filter(|unit| !unit.is_empty());
            let unit = unit.map(|unit| language.cfg_unit_in(unit)).unwrap_or_default();
            language.cfg_unfit_number(&unit).trim_end().to_owned()
        }
        Unfit::OutOfRange { first, last } => {
            language.cfg_unfit_range(&signed(&first.to_string()), &signed(&last.to_string()))
        }
        Unfit::TooLarge => language.cfg_unfit_large().to_owned(),
        Unfit::TooFine { decimals: 0 } => language.cfg_unfit_whole().to_owned(),
        Unfit::TooFine { decimals } => language.cfg_unfit_fine(*decimals),
        Unfit::BetweenSteps { step, first } => language.cfg_unfit_step(&step.to_string(), &signed(&first.to_string())),
        Unfit::NotInTable => {
            let options = profile.point(point).map(|point| super::row::options(language, point)).unwrap_or_default();
            let labels: Vec<String> = options.into_iter().map(|(_, label)| label).collect();
            language.cfg_unfit_table(&listed(language, &labels))
        }
        Unfit::NotItsRegisters => {
            let count = profile.point(point).map_or(1, |point| point.encoding.registers());
            language.cfg_unfit_registers(count)
        }
        Unfit::NotScaled => language.cfg_unfit_scale().to_owned(),
        Unfit::NotRead => language.cfg_unfit_not_read().to_owned(),
        Unfit::NotAText { most } => language.cfg_unfit_text(*most),
        Unfit::OtherUnit { device, value } => language.cfg_unfit_unit(device, value),
        Unfit::UnitZero => language.cfg_unfit_zero().to_owned(),
        Unfit::LeadsNowhere => language.cfg_unfit_nowhere().to_owned(),
        Unfit::Twice => language.cfg_unfit_twice().to_owned(),
        Unfit::AfterLoss => language.cfg_unfit_after_loss().to_owned(),
        Unfit::OtherProfile => language.cfg_unfit_profile().to_owned(),
    }
}

/// What can be lost, in the profile's own words where it has some.
pub(crate) fn hazard(language: Language, profile: &Profile, hazard: &Hazard) -> String {
    let cost = |point: &str, registers: Option<&[u16]>| {
        let cost = profile.point(point).and_then(|point| {
            let value = registers.and_then(|registers| point.decode(registers).ok());
            let written = value.and_then(|value| point.consequence_of(value)).or(point.consequence.as_ref());
            let of_codes = || point.codes.iter().find_map(|code| code.consequence.as_ref());
            written.or_else(of_codes).or(point.note.as_ref())
        });
        cost.map(|cost| pick(language, cost).clone()).unwrap_or_default()
    };
    let named = |point: &str| name(language, profile, point);
    let text = match hazard {
        Hazard::Defaults { point } => language.cfg_hazard_defaults(&named(point), &cost(point, None)),
        Hazard::Search { point } => language.cfg_hazard_search(&named(point), &cost(point, None)),
        Hazard::Grave { point, registers } => {
            let empty = Snapshot::empty(profile, Reach::of_factory(profile));
            let value = profile.point(point).map(|point| value(language, profile, point, registers, &empty));
            language.cfg_hazard_grave(&named(point), &value.unwrap_or_default(), &cost(point, Some(registers)))
        }
        Hazard::ReservedUnit { unit } => language.cfg_hazard_reserved(*unit),
        Hazard::SlowBaud { baud } => language.cfg_hazard_slow(*baud),
        Hazard::Broadcast => language.cfg_hazard_broadcast().to_owned(),
    };
    text.trim_end().to_owned()
}

/// How the device is reached after a step.
pub(crate) fn after(language: Language, after: &After) -> String {
    let seconds = |milliseconds: &u32| tenths(u64::from(*milliseconds));
    match after {
        After::Same => language.cfg_after_same().to_owned(),
        After::Moves(to) => language.cfg_after_moves(&reach(language, to)),
        After::Restarts { reach: to, silence_ms } => {
            language.cfg_after_restart(&seconds(silence_ms), &reach(language, to))
        }
        After::Defaults { candidates, silence_ms } => {
            let all: Vec<String> = candidates.iter().map(|to| reach(language, to)).collect();
            language.cfg_after_defaults(&seconds(silence_ms), &listed(language, &all))
        }
        After::Unknown { .. } => language.cfg_after_unknown().to_owned(),
    }
}

/// What a procedure does; `step` names a step of its plan.
pub(crate) fn phase(language: Language, phase: &Phase, step: impl Fn(u32) -> String) -> String {
    match phase {
        Phase::Beginning => language.cfg_phase_beginning().to_owned(),
        Phase::Reading => language.cfg_phase_reading().to_owned(),
        Phase::CheckingFree(at) => language.cfg_phase_free(&reach(language, at)),
        Phase::Writing { step: at } => language.cfg_phase_writing(&step(*at)),
        Phase::Following(to) => language.cfg_phase_following(&reach(language, to)),
        Phase::Restarting => language.cfg_phase_restarting().to_owned(),
        Phase::Searching(at) => language.cfg_phase_searching(&reach(language, at)),
        Phase::Verifying => language.cfg_phase_verifying().to_owned(),
        Phase::Undoing { step: at } => language.cfg_phase_undoing(&step(*at)),
        Phase::Ending => language.cfg_phase_ending().to_owned(),
    }
}

/// Its name for tests.
pub(crate) fn phase_key(phase: &Phase) -> &'static str {
    match phase {
        Phase::Beginning => "beginning",
        Phase::Reading => "reading",
        Phase::CheckingFree(_) => "checking-free",
        Phase::Writing { .. } => "writing",
        Phase::Following(_) => "following",
        Phase::Restarting => "restarting",
        Phase::Searching(_) => "searching",
        Phase::Verifying => "verifying",
        Phase::Undoing { .. } => "undoing",
        Phase::Ending => "ending",
    }
}

/// The step of a plan that a phase is about. A phase may be over before anybody looks, so that each tells as much as it can.
pub(crate) fn step_of(plan: &Plan, phase: &Phase) -> Option<u32> {
    let place = |leads: &dyn Fn(&After) -> bool| plan.steps.iter().position(|step| leads(&step.then));
    let at = match phase {
        Phase::Writing { step } => return Some(*step),
        Phase::Following(to) => place(&|then| match then {
            After::Moves(reach) | After::Restarts { reach, .. } => reach == to,
            _ => false,
        }),
        Phase::Restarting | Phase::Searching(_) => place(&|then| !matches!(then, After::Same | After::Moves(_))),
        Phase::Verifying => plan.steps.len().checked_sub(1),
        _ => None,
    };
    at.and_then(|at| u32::try_from(at).ok())
}

/// How a step of the plan stands while a procedure is in a phase of its own: a name for styles, and words. Steps are carried
/// out in their order; `last` is the last one that was begun.
pub(crate) fn step_now(language: Language, phase: &Phase, at: u32, last: Option<u32>) -> (&'static str, &'static str) {
    let begun = last.is_some_and(|last| at < last);
    match phase {
        Phase::Undoing { step } if *step == at => ("running", language.cfg_step_undoing()),
        Phase::Undoing { step } if at > *step => ("waiting", language.cfg_step_undone()),
        Phase::Verifying if last.is_some_and(|last| at <= last) => ("running", language.cfg_step_verifying()),
        Phase::Following(_) | Phase::Restarting | Phase::Searching(_) if last == Some(at) => {
            ("running", language.cfg_step_following())
        }
        Phase::Writing { step } if *step == at => ("running", language.cfg_step_writing()),
        Phase::Ending if last.is_some_and(|last| at <= last) => ("done", language.cfg_step_written()),
        _ if begun => ("done", language.cfg_step_written()),
        _ => ("waiting", language.cfg_step_waiting()),
    }
}

/// How a step has ended; `held` words what a device was found to hold.
pub(crate) fn outcome(language: Language, outcome: &StepOutcome, held: impl Fn(&Read) -> String) -> String {
    match outcome {
        StepOutcome::Waiting => language.cfg_step_waiting().to_owned(),
        StepOutcome::Sent => language.cfg_step_sent().to_owned(),
        StepOutcome::Confirmed => language.cfg_step_confirmed().to_owned(),
        StepOutcome::Acknowledged => language.cfg_step_acknowledged().to_owned(),
        StepOutcome::Unproven => language.cfg_step_unproven().to_owned(),
        StepOutcome::Refused(code) => language.cfg_step_refused(*code, language.exception_name(*code)),
        StepOutcome::NotHeld(read) => language.cfg_step_not_held(&held(read)),
        StepOutcome::NotDone => language.cfg_step_not_done().to_owned(),
        StepOutcome::Silent => language.cfg_step_silent().to_owned(),
        StepOutcome::NotSent => language.cfg_step_not_sent().to_owned(),
        StepOutcome::Undone => language.cfg_step_undone().to_owned(),
        StepOutcome::Overwritten => language.cfg_step_overwritten().to_owned(),
    }
}

/// The same for styles and tests.
pub(crate) fn outcome_key(outcome: &StepOutcome) -> &'static str {
    match outcome {
        StepOutcome::Waiting => "waiting",
        StepOutcome::Sent => "sent",
        StepOutcome::Confirmed => "confirmed",
        StepOutcome::Acknowledged => "acknowledged",
        StepOutcome::Unproven => "unproven",
        StepOutcome::Refused(_) => "refused",
        StepOutcome::NotHeld(_) => "not-held",
        StepOutcome::NotDone => "not-done",
        StepOutcome::Silent => "silent",
        StepOutcome::NotSent => "not-sent",
        StepOutcome::Undone => "undone",
        StepOutcome::Overwritten => "overwritten",
    }
}

/// Why a file of parameters was not taken, and where.
pub(crate) fn file_fault(language: Language, fault: &FileFault) -> String {
    let known = |names: &[String]| listed(language, names);
    let what = match &fault.reason {
        FileReason::TooLarge => return language.cfg_file_large().to_owned(),
        FileReason::EndsEarly => language.cfg_reason_early().to_owned(),
        FileReason::Trailing => language.cfg_reason_trailing().to_owned(),
        FileReason::NotJson => language.cfg_reason_json().to_owned(),
        FileReason::NotAnObject => language.cfg_reason_object().to_owned(),
        FileReason::NotAList => language.cfg_reason_list().to_owned(),
        FileReason::NotAText => language.cfg_reason_text().to_owned(),
        FileReason::NotANumber { first, last } => language.cfg_reason_number(*first, *last),
        FileReason::UnknownKey { key, known: names } => language.cfg_reason_key(key, &known(names)),
        FileReason::KeyTwice(key) => language.cfg_reason_key_twice(key),
        FileReason::MissingKey(key) => language.cfg_reason_key_missing(key),
        FileReason::NoneOf(names) => language.cfg_reason_none_of(&known(names)),
        FileReason::OtherFormat(version) => language.cfg_reason_format(*version),
        FileReason::OtherKind => language.cfg_reason_kind().to_owned(),
        FileReason::NotATime => language.cfg_reason_time().to_owned(),
        FileReason::NotRegisters => language.cfg_reason_registers().to_owned(),
        FileReason::NotOneResult => language.cfg_reason_result().to_owned(),
        FileReason::PointTwice(point) => language.cfg_reason_point_twice(point),
    };
    language.cfg_file_fault(fault.line, fault.column, &what)
}

/// Names in a row.
pub(crate) fn listed(language: Language, names: &[String]) -> String {
    names.join(match language {
        Language::En => ", ",
        Language::Zh => "、",
    })
}

/// Seconds with one decimal, of milliseconds.
pub(crate) fn tenths(milliseconds: u64) -> String {
    let tenths = milliseconds.div_ceil(100);
    // A day has fewer.
    #[allow(clippy::cast_precision_loss)]
    format::fixed(tenths as f64 / 10.0, 1)
}

#[cfg(test)]
mod tests {
    use buslens_codec::UnitId;
    use buslens_codec::value::Decimal;
    use buslens_configure::Edit;

    use super::*;
    use crate::device;

    #[test]
    fn a_refusal_tells_what_is_allowed() {
        let profile = device::find("lvdt").profile();
        let range = Unfit::OutOfRange { first: Decimal::whole(1), last: Decimal::whole(247) };
        assert_eq!(unfit(Language::En, profile, "address", &range), "allowed: 1 to 247");
        let parities = unfit(Language::Zh, profile, "parity", &Unfit::NotInTable);
        assert_eq!(parities, "允许的值：奇校验、偶校验、无校验");
        let bauds = unfit(Language::En, profile, "baud", &Unfit::NotInTable);
        assert!(bauds.contains("9600 Bd") && bauds.contains("115200 Bd"), "{bauds}");
        assert_eq!(unfit(Language::En, profile, "address", &Unfit::NotANumber), "a number is needed");
    }

    #[test]
    fn a_danger_is_told_in_the_profiles_words() {
        let profile = device::find("level").profile();
        let save = Hazard::Grave { point: "save".to_owned(), registers: vec![1] };
        let text = hazard(Language::En, profile, &save);
        assert!(text.contains("to the factory area") && text.contains("cannot be brought back"), "{text}");
        let restore = hazard(Language::Zh, profile, &Hazard::Search { point: "restore_factory".to_owned() });
        assert!(restore.contains("必须重新搜索"), "{restore}");
    }

    #[test]
    fn a_way_to_a_device_is_told_like_in_the_top_bar() {
        let profile = device::find("lvdt").profile();
        let at = Reach { unit: UnitId(247), ..Reach::of_factory(profile) };
        assert_eq!(reach(Language::En, &at), "9600 8E1 \u{B7} RTU \u{B7} unit 247");
        let moves = after(Language::En, &After::Moves(at));
        assert!(moves.contains("unit 247"), "{moves}");
        assert_eq!((tenths(1500), tenths(20), tenths(0)), ("1.5".to_owned(), "0.1".to_owned(), "0.0".to_owned()));
    }

    #[test]
    fn steps_go_from_waiting_over_writing_to_written() {
        let at = |phase: &Phase, at, last| step_now(Language::En, phase, at, last).0;
        let writing = Phase::Writing { step: 1 };
        assert_eq!(
            (at(&writing, 0, Some(1)), at(&writing, 1, Some(1)), at(&writing, 2, Some(1))),
            ("done", "running", "waiting")
        );
        assert_eq!(at(&Phase::Restarting, 1, Some(1)), "running");
        assert_eq!(at(&Phase::Beginning, 0, None), "waiting");
        assert_eq!(at(&Phase::Ending, 2, Some(2)), "done");
    }

    #[test]
    fn a_phase_tells_its_step() {
        let profile = device::find("lvdt").profile();
        let have = Snapshot::empty(profile, Reach::of_factory(profile));
        let edit = |point: &str, code| Edit { point: point.to_owned(), registers: vec![code] };
        let plan =
            Plan::of(profile, &have, &[edit("baud", 7), edit("address", 9), edit("factory_reset", 0xFF00)]).unwrap();
        let After::Moves(fast) = plan.steps[1].then else { panic!("{:?}", plan.steps[1]) };
        assert_eq!(step_of(&plan, &Phase::Following(fast)), Some(1));
        assert_eq!(step_of(&plan, &Phase::Restarting), Some(2));
        assert_eq!(step_of(&plan, &Phase::Verifying), Some(2));
        assert_eq!(step_of(&plan, &Phase::Reading), None);
    }
}
