//! The Decoder page: pasted bytes become frames, the chosen frame is taken apart.

mod reading;

use crate::reactive::*;
use buslens_codec::dissect::Direction;
use buslens_codec::intake::{IntakeError, IntakeFault};
use wasm_bindgen::JsCast;

use crate::anatomy::{Anatomy, Facts};
use crate::app::App;
use crate::components::button::{button, icon_button};
use crate::components::bytes::{byte_groups, lights};
use crate::components::icon::{Icon, icon};
use crate::dom::{self, El, el};
use crate::format::hex_spaced;
use crate::route::{self, Route};
use crate::storage::kept;
use crate::text::Language;
use reading::read;

/// A text of the page.
type Label = fn(Language) -> &'static str;

/// Texts to begin with: label and bytes. The reply stands behind its request, which alone tells its registers.
const EXAMPLES: [(&str, Label, &str); 4] = [
    ("request", Language::example_request, "0C 04 00 04 00 02 31 17"),
    ("reply", Language::example_reply, "0C 04 00 04 00 02 31 17\n0C 04 04 80 00 01 48 0F 22"),
    ("exception", Language::example_exception, "0C 04 00 04 00 01 71 16\n0C 84 02 53 02"),
    ("ascii", Language::example_ascii, ":010300310001CA"),
];

/// What was typed, and what stood there before an example or a link replaced it. Both outlive a reload.
#[derive(Clone, Copy)]
struct Texts {
    typed: RwSignal<String>,
    previous: RwSignal<String>,
}

impl Texts {
    fn replace(self, text: String) {
        let old = self.typed.get_untracked();
        if old != text {
            if !old.trim().is_empty() {
                self.previous.set(old);
            }
            self.typed.set(text);
        }
    }
}

/// The page.
pub(crate) fn decoder_page(app: &'static App) -> El {
    let texts = Texts { typed: kept("decoder", ""), previous: kept("decoder-previous", "") };
    dom::react(move || {
        if let Route::Decoder { frames } = app.route.get()
            && !frames.is_empty()
        {
            texts.replace(frames.iter().map(|frame| spaced(frame)).collect::<Vec<_>>().join("\n"));
            route::forget_frames();
        }
    });
    let chosen = RwSignal::new(0_usize);
    let frames = Memo::new(move |_| {
        let device = app.settings.device();
        texts.typed.with(|text| read(app.language.get(), device.profile(), text))
    });
    el("div")
        .class("page decoder")
        .test("page-decoder")
        .child(el("h1").class("visually-hidden").say(app, Language::decoder))
        .child(input_card(app, texts))
        .live(move || {
            frames.with(|frames| match frames {
                Err(error) => vec![error_line(app.language.get(), *error)],
                Ok(frames) if frames.is_empty() => {
                    vec![el("p").class("empty-page").say(app, Language::decoder_empty)]
                }
                Ok(frames) => vec![frame_list(app, frames, chosen)],
            })
        })
        .live_one(move || {
            frames.with(|frames| {
                let frames = frames.as_ref().ok()?;
                frames.get(chosen.get().min(frames.len().checked_sub(1)?)).map(|frame| detail(app, frame))
            })
        })
}

fn input_card(app: &'static App, texts: Texts) -> El {
    let restorable = Memo::new(move |_| texts.previous.with(|previous| !previous.is_empty()));
    let restore = move || {
        icon_button(app, "quiet small", "restore-text", Icon::Reset, Language::restore_text)
            .click(move || texts.replace(texts.previous.get_untracked()))
    };
    let header = el("header")
        .child(el("h2").say(app, Language::decoder_title))
        .child(el("span").class("space"))
        .live_one(move || restorable.get().then(restore));
    let area = el("textarea")
        .attr("id", "decoder-input")
        .test("decoder-input")
        .attr("rows", "4")
        .attr("spellcheck", "false")
        .attr("autocapitalize", "off")
        .attr("autocomplete", "off")
        .live_attr("placeholder", move || Some(app.language.get().decoder_placeholder().to_owned()))
        .bind("input", texts.typed);
    let examples = EXAMPLES.iter().map(|&(test, label, text)| {
        button(app, "small", &["example-", test].concat(), label).click(move || texts.replace(text.to_owned()))
    });
    el("section")
        .class("card input")
        .child(header)
        .child(el("label").class("visually-hidden").attr("for", "decoder-input").say(app, Language::decoder_input))
        .child(area)
        .child(el("footer").child(el("span").class("muted").say(app, Language::examples)).children(examples))
}

fn frame_list(app: &'static App, frames: &[Anatomy], chosen: RwSignal<usize>) -> El {
    let last = frames.len().saturating_sub(1);
    let rows = frames.iter().enumerate().map(|(number, frame)| {
        let selected = move || chosen.get().min(last) == number;
        el("tr")
            .test("frame-row")
            .attr("tabindex", "0")
            .live_class("selected", selected)
            .state("aria-selected", selected)
            .click(move || chosen.set(number))
            .on("keydown", move |event| {
                let key = event.dyn_ref::<web_sys::KeyboardEvent>().map(web_sys::KeyboardEvent::key);
                if key.is_some_and(|key| key == "Enter" || key == " ") {
                    event.prevent_default();
                    chosen.set(number);
                }
            })
            .children(row(app.language.get(), frame))
    });
    let heads = [
        ("", Language::direction as Label),
        ("number", Language::unit_short),
        ("", Language::function),
        ("", Language::meaning),
        ("", Language::check),
        ("", Language::bytes),
    ];
    let header = el("header")
        .child(el("h2").say(app, Language::frames))
        .child(el("span").class("muted").text(&frames.len().to_string()));
    el("section").class("card").child(header).child(table(app, "frames", &heads, rows))
}

/// A table that scrolls sideways where it does not fit.
fn table(app: &'static App, class: &str, heads: &[(&str, Label)], rows: impl Iterator<Item = El>) -> El {
    let heads = heads.iter().map(|&(class, text)| el("th").class(class).say(app, text));
    let head = el("thead").child(el("tr").children(heads));
    let table = el("table").class(class).child(head).child(el("tbody").children(rows));
    el("div").class("scroll").child(table)
}

fn row(language: Language, frame: &Anatomy) -> Vec<El> {
    let cell = |class: &str, text: &str| el("td").class(class).text(text);
    let bytes = cell("mono", &hex_spaced(&frame.bytes));
    let Some(Facts { direction, unit, function, meaning, check_ok, expected, .. }) = &frame.facts else {
        let tag = el("span").class("tag").text(language.noise());
        let empty = || el("td");
        return vec![empty(), empty(), empty(), cell("muted", language.no_frame()), el("td").child(tag), bytes];
    };
    let (class, direction) = match direction {
        Direction::Request => ("direction tx", "TX"),
        Direction::Response => ("direction rx", "RX"),
        Direction::Unknown => ("direction", "?"),
    };
    let check = if *check_ok {
        el("td").child(el("span").class("tag ok").text(language.check_ok()))
    } else {
        el("td")
            .child(el("span").class("tag bad").text(language.check_bad()))
            .child(el("span").class("expected").text(&language.check_expected(expected)))
    };
    vec![cell(class, direction), cell("number", &unit.to_string()), cell("", function), cell("", meaning), check, bytes]
}

fn detail(app: &'static App, frame: &Anatomy) -> El {
    let lit = RwSignal::new(None);
    let rows = frame.parts.iter().enumerate().map(|(number, part)| {
        let texts: Vec<String> = part.range.clone().map(|at| frame.byte_text(at)).collect();
        let row = el("tr").test("field-row").attr("data-kind", part.kind);
        lights(row, number, lit)
            .child(el("td").child(el("i").class("swatch")).text(&part.name))
            .child(el("td").class("mono").text(&texts.join(" ")))
            .child(el("td").class("part-value").text(&part.value))
            .child(el("td").class("muted").text(&part.meaning))
    });
    let heads = [("", Language::field as Label), ("", Language::bytes), ("", Language::value), ("", Language::meaning)];
    let header = el("header")
        .child(el("h2").say(app, Language::selected_frame))
        .child(el("span").class("muted hint").say(app, Language::pick_a_frame));
    let hint = || {
        let text = el("span").say(app, Language::reply_needs_request);
        el("p").class("note-line").child(icon(Icon::Info)).child(text)
    };
    el("section")
        .class("card detail")
        .child(header)
        .child(byte_groups(frame, lit))
        .children(frame.lacks_request().then(hint))
        .child(table(app, "fields-table", &heads, rows))
}

fn error_line(language: Language, error: IntakeError) -> El {
    let line = el("p").class("parse-error").attr("role", "alert").test("decoder-error");
    line.child(icon(Icon::Fault)).child(el("span").text(&error_text(language, error)))
}

fn error_text(language: Language, error: IntakeError) -> String {
    let what = match error.fault {
        IntakeFault::Unexpected(character) => language.unexpected_character(character),
        _ => language.odd_digits().to_owned(),
    };
    language.parse_error_at(error.line, error.column, &what)
}

/// Digits of a link in pairs, as long as they are digits; anything else stays for the parser to complain about.
fn spaced(digits: &str) -> String {
    let mut text = String::with_capacity(digits.len() * 3 / 2);
    for (at, character) in digits.chars().enumerate() {
        if at > 0 && at % 2 == 0 {
            text.push(' ');
        }
        text.push(character);
    }
    text
}
