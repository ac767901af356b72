//! The frame in both modes, byte by byte.

use std::time::Duration;

use crate::reactive::prelude::*;
use buslens_codec::dissect::Direction;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::pdu::Request;
use buslens_codec::profile::Known;
use buslens_codec::{UnitId, adu};

use super::Built;
use super::form::Form;
use super::words::{function_name, label};
use crate::anatomy::Anatomy;
use crate::builder::{Draft, Field, Message, Slot, Way, spell};
use crate::components::button::button;
use crate::components::bytes::byte_groups;
use crate::components::field::choice;
use crate::components::icon::{Icon, icon};
use crate::components::shell::mode_name;
use crate::dom::{El, el};
use crate::format::{hex, hex_spaced, milliseconds};
use crate::route::{console_link, decoder_link};
use crate::settings::BAUDS;
use crate::text::Language;
use crate::workbench::Workbench;

/// A whole message as it goes over the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Frames {
    /// In RTU mode.
    pub(super) rtu: Vec<u8>,
    /// In ASCII mode.
    pub(super) ascii: Vec<u8>,
    way: Direction,
    /// The request itself, or the one that a reply answers, as far as the form tells.
    request: Option<Request>,
    unit: u8,
}

impl Frames {
    /// The frames of a draft, if it is whole.
    pub(super) fn of(form: Form, draft: &Draft) -> Option<Self> {
        let (message, pdu) = draft.whole.as_ref()?;
        let (way, request) = match message {
            Message::Request(request) => (Direction::Request, Some(request.clone())),
            Message::Response(response) => {
                let asked = || match form.draft_of(Way::Request).whole?.0 {
                    Message::Request(request) => Some(request).filter(|request| request.accepts(response)),
                    Message::Response(_) => None,
                };
                // Only a point's read is known to be what was asked.
                (Direction::Response, form.point().and_then(|_| asked()))
            }
        };
        let frame = |mode| {
            let mut frame = adu::encode(mode, UnitId(draft.unit), pdu)?;
            if form.is_spoiled() {
                spell::spoil(mode, &mut frame);
            }
            Some(frame)
        };
        Some(Self { rtu: frame(Mode::Rtu)?, ascii: frame(Mode::Ascii)?, way, request, unit: draft.unit })
    }

    /// The frame in a mode.
    pub(super) fn frame(&self, mode: Mode) -> &[u8] {
        match mode {
            Mode::Rtu => &self.rtu,
            Mode::Ascii => &self.ascii,
        }
    }

    /// How long the reply is, if this is a request that has one.
    fn reply(&self, language: Language, line: LineSettings, mode: Mode) -> Option<String> {
        let request = self.request.as_ref().filter(|_| self.way == Direction::Request)?;
        let silent = self.unit == UnitId::BROADCAST.0 && request.is_write();
        Some(match request.response_pdu_len() {
            _ if silent => language.reply_none().to_owned(),
            Some(pdu) => {
                language.reply_is(&length(language, line, mode, if mode == Mode::Rtu { pdu + 3 } else { 2 * pdu + 7 }))
            }
            None if matches!(request, Request::Diagnostics { sub_function, .. } if sub_function.is_known()) => {
                language.reply_none().to_owned()
            }
            None => language.reply_unknown().to_owned(),
        })
    }
}

/// The card.
pub(super) fn frame_card(app: &'static Workbench, form: Form, built: Memo<Built>) -> El {
    let spoiled = Memo::new(move |_| form.is_spoiled());
    let rates = choice("builder-baud", form.baud, || BAUDS.map(|baud| (baud.to_string(), baud.to_string())).into());
    let header = el("header")
        .child(el("h2").say(app, Language::frame))
        .live_one(move || {
            spoiled
                .get()
                .then(|| el("span").class("tag bad").test("wrong-check-tag").say(app, Language::wrong_check_tag))
        })
        .child(el("span").class("space"))
        .child(el("label").class("muted").attr("for", "builder-baud").say(app, Language::baud))
        .child(rates)
        .child(el("span").class("muted format").live_text(move || {
            let text = form.line().to_string();
            text.split_once(' ').map(|(_, format)| format.to_owned()).unwrap_or_default()
        }));
    let switch = button(app, "small", "builder-wrong-check", Language::wrong_check)
        .state("aria-pressed", move || spoiled.get())
        .click(move || form.wrong_check.set(if spoiled.get() { "" } else { "yes" }.to_owned()));
    el("section")
        .class("card built")
        .child(header)
        .live(move || {
            let language = app.language.get();
            built.with(|built| match &built.frames {
                Some(frames) => [Mode::Rtu, Mode::Ascii].map(|mode| half(language, form, frames, mode)).into(),
                None => vec![pieces(language, &built.draft)],
            })
        })
        .child(el("footer").child(switch))
}

/// A frame in one mode: length and time, the reply's, the way to the decoder, and the bytes.
fn half(language: Language, form: Form, frames: &Frames, mode: Mode) -> El {
    let (frame, line) = (frames.frame(mode), form.line());
    let (hook, test) = match mode {
        Mode::Rtu => ("take-apart-rtu", "frame-rtu"),
        Mode::Ascii => ("take-apart-ascii", "frame-ascii"),
    };
    let open = el("a")
        .class("button quiet small")
        .test(hook)
        .attr("href", &decoder_link(&[frame]))
        .child(el("span").text(language.take_apart()))
        .child(icon(Icon::Go));
    let to_console = el("a")
        .class("button quiet small")
        .test(match mode {
            Mode::Rtu => "to-console-rtu",
            Mode::Ascii => "to-console-ascii",
        })
        .attr("href", &console_link(frame))
        .child(icon(Icon::Console))
        .child(el("span").text(language.to_console()));
    let facts = el("p")
        .class("facts")
        .child(el("b").text(mode_name(mode)))
        .child(el("span").text(&length(language, line, mode, frame.len())))
        .children(frames.reply(language, line, mode).map(|reply| el("span").class("muted").test("reply").text(&reply)))
        .child(el("span").class("space"))
        .child(to_console)
        .child(open);
    el("div")
        .class("built-half")
        .test(test)
        .child(facts)
        .child(byte_groups(&anatomy(language, form, frames, mode), RwSignal::new(None)))
}

/// The frame in words: the only place of this page that takes frames apart.
fn anatomy(language: Language, form: Form, frames: &Frames, mode: Mode) -> Anatomy {
    let request = frames.request.as_ref().filter(|_| frames.way == Direction::Response);
    let known = &mut Known::default();
    Anatomy::of(language, Some(form.device().profile()), frames.frame(mode), mode, frames.way, request, known)
}

/// What the right fields give, as long as there is no frame.
fn pieces(language: Language, draft: &Draft) -> El {
    let part = |kind: &str, bytes: &str, caption: &str| {
        el("div")
            .class("part")
            .attr("data-kind", kind)
            .child(el("span").class("part-bytes").text(bytes))
            .child(el("small").text(caption))
    };
    let field = |field: &Field| match &field.bytes {
        Ok(bytes) => {
            let kind = match field.slot {
                Slot::Unit => "unit",
                Slot::Code => "function",
                Slot::Address | Slot::Quantity | Slot::WriteAddress => "place",
                _ => "data",
            };
            part(kind, &hex_spaced(bytes), label(field.slot)(language))
        }
        Err(_) => part("wrong", "?", label(field.slot)(language)),
    };
    let mut parts: Vec<El> = draft.fields.iter().map(field).collect();
    if !draft.fields.iter().any(|field| field.slot == Slot::Code) {
        let code = draft.function;
        parts.insert(1, part("function", &hex(code), function_name(language, code & 0x7F)));
    }
    parts.push(part("mark", "?", language.check()));
    el("div")
        .class("built-half")
        .test("frame-incomplete")
        .child(
            el("p")
                .class("facts incomplete")
                .child(icon(Icon::Info))
                .child(el("span").text(language.frame_incomplete())),
        )
        .child(el("div").class("bytes").children(parts))
}

/// `8 bytes · 9.2 ms`.
fn length(language: Language, line: LineSettings, mode: Mode, characters: usize) -> String {
    let count = match mode {
        Mode::Rtu => language.bytes_count(characters),
        Mode::Ascii => language.characters_many(characters),
    };
    [&count, " \u{B7} ", &time(line.character_time(characters))].concat()
}

fn time(time: Duration) -> String {
    milliseconds(u32::try_from(time.as_micros()).unwrap_or(u32::MAX))
}
