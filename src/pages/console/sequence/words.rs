//! Faults, reasons and reports in words.

use buslens_sequence::{Branch, Ended, Entry, Expected, FaultKind, Heard, Mark, Reason, Summary, Verdict};

use crate::device;
use crate::text::Language;

/// A report in a language, with the date of its run.
pub(super) struct Written {
    pub(super) language: Language,
    pub(super) date: String,
}

/// How a run stands.
pub(super) fn verdict(language: Language, verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Running => language.seq_running(),
        Verdict::Passed => language.seq_passed(),
        Verdict::Failed => language.seq_failed(),
        Verdict::Incomplete => language.seq_incomplete(),
    }
}

/// The same for styles and tests.
pub(super) fn verdict_key(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Running => "running",
        Verdict::Passed => "passed",
        Verdict::Failed => "failed",
        Verdict::Incomplete => "incomplete",
    }
}

/// How a step went.
pub(super) fn mark(language: Language, mark: Mark) -> &'static str {
    match mark {
        Mark::Running => language.seq_mark_running(),
        Mark::Passed => language.seq_mark_passed(),
        Mark::Failed => language.seq_mark_failed(),
        Mark::Skipped => language.seq_mark_skipped(),
    }
}

/// Why a run has ended.
pub(super) fn ended(language: Language, ended: Ended) -> &'static str {
    match ended {
        Ended::Finished => language.seq_ended_finished(),
        Ended::StopStep => language.seq_ended_stop(),
        Ended::Failure => language.seq_ended_failure(),
        Ended::Stopped => language.seq_ended_stopped(),
        Ended::PortLost => language.seq_ended_port(),
    }
}

/// What stands above the steps of a report.
pub(super) fn head(written: &Written, summary: &Summary) -> Vec<String> {
    let language = written.language;
    let title = if summary.title.is_empty() { language.seq_head_untitled().to_owned() } else { summary.title.clone() };
    let device = if summary.profile.is_empty() {
        language.seq_head_unit(summary.unit)
    } else {
        language.seq_head_device(device::find(&summary.profile).name(language), summary.unit)
    };
    let ended = summary.ended.map_or("", |reason| ended(language, reason));
    let took = (summary.until_us.saturating_sub(summary.began_us) / 100_000).to_string();
    let (whole, tenth) = took.split_at_checked(took.len() - 1).unwrap_or(("", &took));
    let took = [if whole.is_empty() { "0" } else { whole }, ".", tenth].concat();
    let mut lines = vec![
        language.seq_head_of_program().to_owned(),
        title,
        language.seq_head_verdict(verdict(language, summary.verdict), ended),
        language.seq_counts(summary.passed, summary.failed),
        device,
        language.seq_head_began(&written.date, &took),
    ];
    lines.extend((summary.left_out > 0).then(|| language.seq_left_out(summary.left_out)));
    lines
}

/// What there is to say of a step beside its bytes.
pub(super) fn about(language: Language, entry: &Entry) -> Vec<String> {
    let mut lines = Vec::new();
    if !entry.text.is_empty() {
        lines.push(entry.text.clone());
    }
    if let Some(compared) = &entry.compared {
        lines.push(match compared.wanted.as_slice() {
            [least, most] => language.seq_found_between(&compared.found, least, most),
            wanted => language.seq_found(&compared.found, wanted.first().map_or("", String::as_str)),
        });
    }
    match entry.outcome {
        Some(Branch::Then) => lines.push(language.seq_then().to_owned()),
        Some(Branch::Else) => lines.push(language.seq_else().to_owned()),
        Some(Branch::Rounds(count)) => lines.push(language.seq_rounds(count)),
        None => {}
    }
    lines.extend(entry.reason.as_ref().map(|why| reason(language, why)));
    lines
}

fn heard(language: Language, heard: Heard) -> String {
    match heard {
        Heard::Reply => language.seq_heard_reply().to_owned(),
        Heard::Exception(code) => language.seq_heard_exception(&crate::format::hex(code)),
        Heard::Silence => language.seq_heard_silence().to_owned(),
        Heard::Broadcast => language.seq_heard_broadcast().to_owned(),
        Heard::Damaged => language.seq_heard_damaged().to_owned(),
        Heard::Doubtful => language.seq_heard_doubtful().to_owned(),
        Heard::Bytes => language.seq_heard_bytes().to_owned(),
    }
}

/// Why a step failed.
fn reason(language: Language, reason: &Reason) -> String {
    match reason {
        Reason::NoReply(what) => language.seq_no_reply(&heard(language, *what)),
        Reason::OtherwiseHeard(what) => language.seq_otherwise(&heard(language, *what)),
        Reason::DoesNotFit => language.seq_does_not_fit().to_owned(),
        Reason::DoesNotHold => language.seq_does_not_hold().to_owned(),
        Reason::NothingSent => language.seq_nothing_sent().to_owned(),
        Reason::NotRead(point) => language.seq_not_read(point),
        Reason::NotInReply(address) => {
            let [high, low] = address.to_be_bytes().map(crate::format::hex);
            language.seq_not_in_reply(&["0x", &high, &low].concat())
        }
        Reason::NoRoundTrip => language.seq_no_round_trip().to_owned(),
        Reason::NoValue(variable) => language.seq_no_value(variable),
        Reason::NotScaled(point) => language.seq_not_scaled(point),
        Reason::OtherUnit { found, wanted } => {
            language.seq_other_unit(if found.is_empty() { "\u{2013}" } else { found }, wanted)
        }
        Reason::NotComparable => language.seq_not_comparable().to_owned(),
        Reason::NoSum => language.seq_no_sum().to_owned(),
        Reason::NotAllowed { point, value } => language.seq_not_written(point, value),
        Reason::NotReadBefore(point) => language.seq_not_read_before(point),
        Reason::LineNotSet => language.seq_line_not_set().to_owned(),
        Reason::NeverHeld(count) => language.seq_never_held(*count),
        Reason::Fail => language.seq_fail_step().to_owned(),
        Reason::ReadOnly => language.seq_not_sent_read_only().to_owned(),
        Reason::NoPort => language.seq_no_port().to_owned(),
        Reason::Withdrawn => language.seq_withdrawn().to_owned(),
        Reason::Stopped => language.seq_stopped().to_owned(),
    }
}

/// What is wrong with a text.
pub(super) fn fault(language: Language, kind: &FaultKind) -> String {
    match kind {
        FaultKind::UnknownStep(word) => language.seq_unknown_step(word),
        FaultKind::Expected(what, found) => {
            let found =
                if found.is_empty() { language.seq_end_of_line().to_owned() } else { language.seq_quoted(found) };
            language.seq_expected(&expected(language, *what), &found)
        }
        FaultKind::LeftOver(word) => language.seq_left_over(word),
        FaultKind::QuoteNotClosed => language.seq_quote_open().to_owned(),
        FaultKind::BadEscape(word) => language.seq_bad_escape(word),
        FaultKind::BadBrace => language.seq_bad_brace().to_owned(),
        FaultKind::NotAscii(character) => language.seq_not_ascii(&character.to_string()),
        FaultKind::BadByte(word) => language.seq_bad_byte(word),
        FaultKind::BadNumber(word) => language.seq_bad_number(word),
        FaultKind::OutOfRange { first, last } => language.seq_out_of_range(*first, *last),
        FaultKind::TooManyBytes(limit) | FaultKind::TooManyParts(limit) => language.seq_too_many(*limit),
        FaultKind::TextTooLong(limit) => language.seq_long_text(*limit),
        FaultKind::TooManySteps(limit) => language.seq_too_many_steps(*limit),
        FaultKind::TooDeep(limit) => language.seq_too_deep(*limit),
        FaultKind::TooManyFaults => language.seq_more_faults().to_owned(),
        FaultKind::NothingOpen => language.seq_nothing_open().to_owned(),
        FaultKind::NotClosed => language.seq_not_closed().to_owned(),
        FaultKind::ElseNotHere => language.seq_else_not_here().to_owned(),
        FaultKind::OnlyAtTheTop => language.seq_top_only().to_owned(),
        FaultKind::NoProfile(word) => language.seq_no_profile(word),
        FaultKind::OtherDevice { wanted, .. } if device::known(wanted).is_none() => language.seq_for_unknown(wanted),
        FaultKind::OtherDevice { wanted, found } => language.seq_for_other(wanted, found),
        FaultKind::UnknownName(word) => language.seq_unknown_name(word),
        FaultKind::UnknownPoint(word) => language.seq_unknown_point(word),
        FaultKind::NameTaken(word) => language.seq_name_taken(word),
        FaultKind::NotReadable(word) => language.seq_not_readable(word),
        FaultKind::NotWritable(word) => language.seq_not_writable(word),
        FaultKind::NotACommand(word) => language.seq_no_command(word),
        FaultKind::UnknownCode { point, value, known } => {
            language.seq_unknown_code(point, value, &known.join(language.list_of_names()))
        }
        FaultKind::NotAllowed { point, value } => language.seq_not_allowed(point, value),
        FaultKind::WrongUnit { wanted, found } if wanted.is_empty() => language.seq_no_unit(found),
        FaultKind::WrongUnit { wanted, found } => language.seq_wrong_unit(wanted, found),
    }
}

fn expected(language: Language, expected: Expected) -> String {
    let words = match expected {
        Expected::Bytes => language.seq_needs_bytes(),
        Expected::Condition => language.seq_needs_condition(),
        Expected::Comparison => language.seq_needs_comparison(),
        Expected::Number => language.seq_needs_number(),
        Expected::Value => language.seq_needs_value(),
        Expected::Time => language.seq_needs_time(),
        Expected::Text => language.seq_needs_text(),
        Expected::Name => language.seq_needs_name(),
        Expected::Readable => language.seq_needs_readable(),
        Expected::Writable => language.seq_needs_writable(),
        Expected::OnOff => language.seq_needs_on_off(),
        Expected::ContinueOrStop => language.seq_needs_continue(),
        Expected::Line => language.seq_needs_line(),
        Expected::Repeat => language.seq_needs_repeat(),
        Expected::Check => language.seq_needs_check(),
        Expected::Equals => return language.seq_needs_word("="),
        Expected::And => return language.seq_needs_word("and"),
        Expected::Failure => return language.seq_needs_word("failure"),
        Expected::Times => return language.seq_needs_word("times"),
    };
    words.to_owned()
}
