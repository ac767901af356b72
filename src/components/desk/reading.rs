//! How a text was read: how far, in which form, and the places that could not be.

use buslens_analyst::message::ToAnalyst;
use buslens_codec::intake::{Form, IntakeError, IntakeFault};

use super::Desk;
use crate::components::button::button;
use crate::components::icon::{Icon, icon};
use crate::dom::{El, el};
use crate::format;
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// Places that could not be read that are shown.
const FAULTS: usize = 3;

/// How far reading is, how the text was read, and where it could not be.
pub(crate) fn understood(
    app: &'static Workbench,
    desk: &'static Desk,
    unreadable: RwSignal<Option<String>>,
    read_as: impl Fn(Form) + Copy + 'static,
) -> El {
    let busy = Memo::new(move |_| desk.progress.with(|progress| !progress.finished && progress.total > 0));
    let percent = Memo::new(move |_| desk.progress.with(|progress| percent(progress.done, progress.total)));
    let cancelled = Memo::new(move |_| desk.progress.with(|progress| progress.cancelled));
    let forms =
        Memo::new(move |_| desk.progress.with(|progress| (progress.form, progress.alternative, progress.entries > 0)));
    let faults = Memo::new(move |_| {
        desk.progress.with(|progress| {
            let first: Vec<IntakeError> = progress.faults.iter().take(FAULTS).copied().collect();
            (first, progress.fault_count)
        })
    });
    el("div")
        .class("understood")
        .live_one(move || busy.get().then(|| progress_bar(app, desk, percent)))
        .live_one(move || cancelled.get().then(|| note(&app.language.get().stopped_at(percent.get()))))
        .live_one(move || {
            unreadable.with(|words| words.as_ref().map(|words| fault_line(&app.language.get().unreadable_file(words))))
        })
        .live_one(move || match forms.get() {
            (Some(form), alternative, true) => Some(form_line(app, form, alternative, read_as)),
            _ => None,
        })
        .live(move || faults.with(|(first, count)| fault_lines(app.language.get(), first, *count)))
}

fn progress_bar(app: &'static Workbench, desk: &'static Desk, percent: Memo<u32>) -> El {
    let bar = el("progress").attr("max", "100").live_attr("value", move || Some(percent.get().to_string()));
    el("div")
        .class("progress")
        .test("decoder-progress")
        .attr("role", "status")
        .child(bar)
        .child(el("span").class("muted").live_text(move || app.language.get().reading_text(percent.get())))
        .child(
            button(app, "small", "stop-reading", Language::stop).click(move || desk.analyst.send(&ToAnalyst::Cancel)),
        )
}

fn form_line(app: &'static Workbench, form: Form, alternative: Option<Form>, read_as: impl Fn(Form) + 'static) -> El {
    let mut line = el("p").class("form-line muted").test("decoder-form").child(el("span").say(app, form_text(form)));
    if let Some(other) = alternative {
        line =
            line.child(button(app, "quiet small", "read-as-other", instead_text(other)).click(move || read_as(other)));
    }
    line
}

fn form_text(form: Form) -> Label {
    match form {
        Form::Hex => Language::read_as_hex,
        Form::Decimal => Language::read_as_decimal,
        Form::AsciiFrames => Language::read_as_ascii,
        Form::Log => Language::read_as_log,
        Form::HexDump => Language::read_as_dump,
        Form::WordDump => Language::read_as_words,
        Form::Session => Language::read_as_session,
    }
}

fn instead_text(form: Form) -> Label {
    match form {
        Form::Hex => Language::instead_hex,
        Form::Decimal => Language::instead_decimal,
        Form::AsciiFrames => Language::instead_ascii,
        Form::Log => Language::instead_log,
        Form::HexDump => Language::instead_dump,
        Form::WordDump => Language::instead_words,
        Form::Session => Language::instead_session,
    }
}

fn fault_lines(language: Language, first: &[IntakeError], count: u64) -> Vec<El> {
    let mut lines: Vec<El> = first.iter().map(|fault| fault_line(&fault_text(language, *fault))).collect();
    let more = count.saturating_sub(first.len() as u64);
    if more > 0 {
        lines.push(note(&language.faults_more(&format::count(more))));
    }
    lines
}

fn fault_line(text: &str) -> El {
    let line = el("p").class("parse-error").attr("role", "alert").test("decoder-error");
    line.child(icon(Icon::Fault)).child(el("span").text(text))
}

fn note(text: &str) -> El {
    el("p").class("form-line muted").text(text)
}

fn fault_text(language: Language, error: IntakeError) -> String {
    let what = match error.fault {
        IntakeFault::Unexpected(character) => language.unexpected_character(character),
        IntakeFault::OddDigits => language.odd_digits().to_owned(),
        IntakeFault::TooLarge => language.too_large().to_owned(),
        IntakeFault::NotText => language.not_text().to_owned(),
        IntakeFault::RepeatTooLong => language.repeat_too_long().to_owned(),
        IntakeFault::NoBytes => language.no_bytes().to_owned(),
    };
    language.parse_error_at(error.line, error.column, &what)
}

fn percent(done: u64, total: u64) -> u32 {
    let percent = done.saturating_mul(100).checked_div(total).unwrap_or(100);
    u32::try_from(percent).unwrap_or(100)
}
