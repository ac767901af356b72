//! The dock at the bottom: the send line, what goes out, what came back.

use buslens_analyst::line::{End, Outcome};
use buslens_analyst::message::ToConsole;
use buslens_codec::dissect::{Direction, dissect_known};
use buslens_codec::line::Mode;
use buslens_codec::profile::Known;

use super::compact;
use super::dock::{Dock, Sent};
use crate::anatomy::{Facts, request_in};
use crate::components::button::{bare, button, icon_button};
use crate::components::icon::{Icon, icon};
use crate::console::entry::{Fault, FaultKind};
use crate::console::{Framing, Key, Line, Outgoing, Writing};
use crate::device::Device;
use crate::dom::{self, El, el};
use crate::format::{self, hex, hex_spaced};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// Bytes of the preview and of an answer that are drawn.
const MOST: usize = 96;

/// The send line's id.
pub(super) const LINE: &str = "send-line";

/// The dock.
pub(super) fn dock(app: &'static Workbench) -> El {
    let console = &app.console;
    let dock = &console.dock;
    let repeating = Memo::new(move |_| dock.repeat.with(|repeat| !repeat.is_empty()));
    let outgoing = Memo::new(move |_| dock.line().outgoing());
    el("form")
        .class("card dock")
        .test("send-dock")
        .label(app, Language::send_line)
        .on("submit", move |event| {
            event.prevent_default();
            dock.send(console);
        })
        .child(entry_row(app, dock, repeating, outgoing))
        .live_one(move || repeating.get().then(|| repeat_row(app, dock)))
        .child(el("div").class("dock-told").child(preview(app, dock, outgoing)).child(result(app, dock)))
}

/// What the line comes to.
type Made = Memo<Result<Outgoing, Fault>>;

fn entry_row(app: &'static Workbench, dock: &'static Dock, repeating: Memo<bool>, outgoing: Made) -> El {
    let console = &app.console;
    let is_wrong = move || outgoing.with(Result::is_err);
    let input = el("input")
        .class("mono send-line")
        .attr("id", LINE)
        .test(LINE)
        .attr("autocomplete", "off")
        .attr("autocapitalize", "off")
        .attr("spellcheck", "false")
        .attr("enterkeyhint", "send")
        .attr("aria-describedby", "send-told")
        .label(app, Language::send_line)
        .live_attr("aria-invalid", move || is_wrong().then(|| "true".to_owned()))
        .live_attr("placeholder", move || {
            let language = app.language.get();
            let text = dock.writing.with(|key| key == Writing::Text.key());
            Some(if text { language.send_placeholder_text() } else { language.send_placeholder_hex() }.to_owned())
        })
        .on("keydown", move |event| {
            let key = dom::key(&event);
            if let "ArrowUp" | "ArrowDown" = key.as_str() {
                event.prevent_default();
                dock.leaf(key == "ArrowUp");
            }
        })
        .on("input", move |_| dock.edited())
        .bind("input", dock.text);
    let writing = compact::tabs(
        app,
        Language::send_as,
        "send-as",
        move || dock.writing.with(|key| Writing::of(key)).unwrap_or_default().key(),
        move |key| dock.writing.set(key.to_owned()),
        [("hex", Language::as_hex as Label), ("text", Language::as_text)],
    );
    let framing = compact::select("framing-select", dock.framing, move || {
        let language = app.language.get();
        let named = [("rtu", "RTU"), ("ascii", "ASCII"), ("typed", language.as_typed())];
        named.map(|(key, text)| (key.to_owned(), text.to_owned())).into()
    })
    .label(app, Language::framing)
    .on("change", move |event| dock.take_framing(Framing::of(&dom::value(&event)).unwrap_or_default()));
    let check = compact::select("check-select", dock.check, move || {
        let language = app.language.get();
        let named =
            [("crc", "CRC"), ("lrc", "LRC"), ("none", language.check_none()), ("wrong", language.check_wrong())];
        named.map(|(key, text)| (key.to_owned(), text.to_owned())).into()
    })
    .label(app, Language::check)
    .flag("disabled", move || dock.framing.with(|key| key == Framing::Typed.key()));
    let repeat = bare("small toggle", "repeat")
        .attr("id", "repeat")
        .state("aria-pressed", move || repeating.get())
        .say(app, Language::repeat)
        .click(move || dock.repeat.set(if repeating.get() { "" } else { "yes" }.to_owned()));
    let more = Memo::new(move |_| dock.sent.with(|sent| sent.as_ref().is_some_and(|sent| sent.more && sent.times > 0)));
    let send = bare("primary", "send")
        .attr("type", "submit")
        .child(icon(Icon::Go))
        .child(el("span").say(app, Language::send))
        .flag("disabled", move || {
            !console.is_open()
                || outgoing.with(|made| made.as_ref().map_or(true, |outgoing| outgoing.bytes.is_empty()))
                || dock.repetition().is_err()
                || dock.wait_ms().is_err()
        });
    let stop = move || {
        icon_button(app, "", "send-stop", Icon::Stop, Language::stop)
            .click(move || console.tell(ToConsole::StopSending))
    };
    el("div")
        .class("dock-row")
        .child(writing)
        .child(input)
        .child(framing)
        .child(check)
        .child(repeat)
        .child(
            button(app, "small", "build", Language::build)
                .attr("aria-haspopup", "dialog")
                .click(move || console.builder_open.set(true)),
        )
        .child(button(app, "small", "keep-line", Language::keep_line).attr("id", "keep-line").click(move || {
            console.tab.set("snippets".to_owned());
            super::panes::focus_soon(super::kept::NAME);
        }))
        .live_one(move || more.get().then(stop))
        .child(send)
}

/// How often, and how long an answer is waited for.
fn repeat_row(app: &'static Workbench, dock: &'static Dock) -> El {
    let number = |hook: &'static str, label: Label, value: RwSignal<String>, wrong: fn(&Dock) -> bool| {
        let input = el("input")
            .attr("inputmode", "numeric")
            .attr("autocomplete", "off")
            .test(hook)
            .live_attr("aria-invalid", move || wrong(dock).then(|| "true".to_owned()))
            .bind("input", value);
        compact::field(app, label, input)
    };
    let untils = move || {
        let language = app.language.get();
        let named = [
            ("never", language.until_never()),
            ("answered", language.until_answered()),
            ("failed", language.until_failed()),
            ("changed", language.until_changed()),
            ("heard", language.until_heard()),
        ];
        named.map(|(key, text)| (key.to_owned(), text.to_owned())).into()
    };
    let heard = Memo::new(move |_| dock.until.with(|until| until == "heard"));
    let pattern = move || {
        let input = el("input")
            .class("mono pattern")
            .attr("autocomplete", "off")
            .attr("spellcheck", "false")
            .attr("placeholder", "01 03 ?? ..")
            .test("repeat-pattern")
            .bind("input", dock.pattern);
        compact::field(app, Language::pattern, input)
    };
    el("div")
        .class("dock-row repeat-row")
        .child(number("repeat-every", Language::repeat_every, dock.every, |dock| dock.every_ms().is_err()))
        .child(number("repeat-times", Language::repeat_times, dock.times, |dock| dock.count().is_err()))
        .child(compact::field(app, Language::until, compact::select("repeat-until", dock.until, untils)))
        .live_one(move || heard.get().then(pattern))
        .child(number("send-wait", Language::wait_for_answer, dock.wait, |dock| dock.wait_ms().is_err()))
}

/// The bytes as they will go out, or what is wrong with the line.
fn preview(app: &'static Workbench, dock: &'static Dock, outgoing: Made) -> El {
    let drawn = move || {
        let language = app.language.get();
        match outgoing.get() {
            Err(fault) => vec![fault_line(language, fault)],
            Ok(outgoing) if outgoing.bytes.is_empty() => {
                vec![el("p").class("muted").say(app, Language::send_hint)]
            }
            Ok(outgoing) => vec![bytes_line(app, language, &dock.line(), &outgoing)],
        }
    };
    el("div").class("preview").attr("id", "send-told").test("send-preview").live(drawn)
}

fn bytes_line(app: &'static Workbench, language: Language, line: &Line, outgoing: &Outgoing) -> El {
    let Outgoing { bytes, check, is_wrong } = outgoing;
    let ascii = line.framing == Framing::Ascii;
    let kind = if *is_wrong { "wrong" } else { "check" };
    let parts = [(0..check.start, "body"), (check.clone(), kind), (check.end..bytes.len(), "body")];
    let part = |(range, kind): (std::ops::Range<usize>, &str)| {
        let shown = range.start..range.end.min(MOST);
        let text = bytes.get(shown).map(|bytes| if ascii { characters(bytes) } else { hex_spaced(bytes) })?;
        (!text.is_empty()).then(|| el("span").attr("data-kind", kind).text(&text))
    };
    let mode = if ascii { Mode::Ascii } else { app.console.mode() };
    let profile = app.console.device().map(Device::profile);
    let meaning = meaning(language, profile, bytes, mode, Direction::Request, None);
    el("p")
        .class("bytes-line")
        .child(el("b").class("direction tx").text("TX"))
        .child(el("span").class("mono").test("send-bytes").children(parts.into_iter().filter_map(part)))
        .children((bytes.len() > MOST).then(|| el("span").class("muted").text("…")))
        .child(el("span").class("muted count").text(&language.bytes_count(bytes.len())))
        .children(is_wrong.then(|| el("span").class("tag bad").text(language.wrong_check_tag())))
        .children(meaning.map(|meaning| el("span").class("told-meaning").text(&meaning)))
}

/// Characters with the line end by name.
fn characters(bytes: &[u8]) -> String {
    let text = |byte: &u8| match byte {
        b'\r' => " CR".to_owned(),
        b'\n' => " LF".to_owned(),
        b'!'..=b'~' => char::from(*byte).to_string(),
        _ => [" ", &hex(*byte), " "].concat(),
    };
    bytes.iter().map(text).collect()
}

fn fault_line(language: Language, Fault { column, kind }: Fault) -> El {
    let what = match kind {
        FaultKind::Unexpected(character) => language.unexpected_character(character),
        FaultKind::OddDigits => language.digit_missing().to_owned(),
        FaultKind::OpenQuote => language.quote_open().to_owned(),
        FaultKind::Escape => language.no_escape().to_owned(),
        FaultKind::NoCharacter => language.no_character().to_owned(),
        FaultKind::TooLong => language.line_too_long(&format::count(crate::console::entry::MOST as u64)),
    };
    let text = language.entry_fault(column, &what);
    el("p")
        .class("fault-line")
        .attr("role", "alert")
        .test("send-fault")
        .attr("data-column", &column.to_string())
        .child(icon(Icon::Fault))
        .child(el("span").text(&text))
}

/// What a frame says, in words; `None` where it is no frame.
fn meaning(
    language: Language,
    profile: Option<&buslens_codec::profile::Profile>,
    bytes: &[u8],
    mode: Mode,
    direction: Direction,
    request: Option<&buslens_codec::pdu::Request>,
) -> Option<String> {
    let found = dissect_known(bytes, mode, direction, request, profile, &mut Known::default())?;
    let facts = Facts::of(language, profile, bytes, &found);
    let unit = language.unit_id(facts.unit);
    let parts = [unit.as_str(), &facts.function, &facts.meaning].into_iter().filter(|part| !part.is_empty());
    Some(parts.collect::<Vec<_>>().join(" \u{B7} "))
}

/// What came of the last sending.
fn result(app: &'static Workbench, dock: &'static Dock) -> El {
    el("div")
        .class("send-result")
        .attr("role", "status")
        .attr("aria-live", "polite")
        .test("send-result")
        .live_attr("data-state", move || dock.sent.with(|sent| sent.as_ref().map(|sent| sent.state().to_owned())))
        .live_attr("data-times", move || dock.sent.with(|sent| sent.as_ref().map(|sent| sent.times.to_string())))
        .live_attr("data-end", move || {
            dock.sent.with(|sent| Some(sent.as_ref()?.outcome.as_ref()?.end.name().to_owned()))
        })
        .live(move || {
            let profile = app.console.device().map(Device::profile);
            let language = app.language.get();
            dock.sent.with(|sent| sent.as_ref().map(|sent| result_line(language, profile, sent)).unwrap_or_default())
        })
}

fn result_line(language: Language, profile: Option<&buslens_codec::profile::Profile>, sent: &Sent) -> Vec<El> {
    let Sent { bytes, mode, times, more, outcome, .. } = sent;
    let Some(Outcome { heard, round_trip_us, end, .. }) = outcome else {
        return vec![el("span").class("muted").text(language.sending())];
    };
    let words = match end {
        End::Answered => language.end_answered(),
        End::Broadcast => language.end_broadcast(),
        End::Heard => language.end_heard(),
        End::Silence => language.end_silence(),
        End::Damaged => language.end_damaged(),
        End::Doubtful => language.end_doubtful(),
        End::ReadOnly => language.end_read_only(),
        End::NoPort => language.end_no_port(),
        End::Withdrawn => language.end_withdrawn(),
        End::Busy => language.end_busy(),
    };
    let request = request_in(bytes, *mode).map(|(_, request)| request);
    let told = (!heard.is_empty())
        .then(|| meaning(language, profile, heard, *mode, Direction::Response, request.as_ref()))
        .flatten();
    let many = (*times > 1 || *more).then(|| language.sent_times(&format::count((*times).into())));
    let tag = el("span").class("end-tag").text(words);
    let span = |class: &str, text: &str| el("span").class(class).text(text);
    let bytes = (!heard.is_empty()).then(|| {
        let shown = heard.get(..heard.len().min(MOST)).unwrap_or_default();
        span("mono", &if *mode == Mode::Ascii { characters(shown) } else { hex_spaced(shown) })
    });
    let way = (!heard.is_empty()).then(|| el("b").class("direction rx").text("RX"));
    way.into_iter()
        .chain(bytes)
        .chain([tag])
        .chain(round_trip_us.map(|trip| span("muted", &format::milliseconds(trip))))
        .chain(told.map(|told| span("told-meaning", &told)))
        .chain(many.map(|many| span("muted", &many)))
        .collect()
}
