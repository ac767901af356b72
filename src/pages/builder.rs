//! The Frame builder: fields become a frame in both modes, to be copied or taken apart; and a calculator of checks.

mod calculator;
mod fields;
mod form;
mod frame;
mod spellings;
mod words;

use buslens_codec::line::Mode;

use crate::reactive::prelude::*;

use crate::builder::{Draft, Slot};
use crate::components::button::bare;
use crate::components::field::{choice, field};
use crate::dom::{El, el, react};
use crate::format::hex;
use crate::text::Language;
use crate::workbench::Workbench;
use form::Form;
use frame::Frames;

/// A text of the page.
type Label = fn(Language) -> &'static str;

/// What the form makes.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Built {
    draft: Draft,
    /// The frames, if the draft is whole.
    frames: Option<Frames>,
}

impl Built {
    fn of(form: Form) -> Self {
        let draft = form.draft();
        Self { frames: Frames::of(form, &draft), draft }
    }
}

/// The form and the frame that it makes, for another page.
pub(crate) struct Bench {
    /// The two cards.
    pub(crate) cards: [El; 2],
    /// The frame.
    pub(crate) frame: Frame,
}

/// The frame that a form makes.
#[derive(Clone, Copy)]
pub(crate) struct Frame(Memo<Built>);

impl Frame {
    /// It in a mode; `None` while the form is not whole.
    pub(crate) fn get(self, mode: Mode) -> Option<Vec<u8>> {
        self.0.with(|built| built.frames.as_ref().map(|frames| frames.frame(mode).to_vec()))
    }
}

/// The builder without a page of its own.
pub(crate) fn builder_bench(app: &'static Workbench) -> Bench {
    let form = Form::remembered();
    let built = Memo::new(move |_| Built::of(form));
    Bench { cards: [form_card(app, form, built), frame::frame_card(app, form, built)], frame: Frame(built) }
}

/// The page.
pub(crate) fn builder_page(app: &'static Workbench) -> El {
    let form = Form::remembered();
    let built = Memo::new(move |_| Built::of(form));
    el("div")
        .class("page builder")
        .test("page-builder")
        .child(el("h1").class("visually-hidden").say(app, Language::builder))
        .child(form_card(app, form, built))
        .child(frame::frame_card(app, form, built))
        .child(
            el("div")
                .class("builder-pair")
                .child(spellings::spellings_card(app, form, built))
                .child(calculator::calculator_card(app)),
        )
}

fn form_card(app: &'static Workbench, form: Form, built: Memo<Built>) -> El {
    let ways = [
        ("request", Language::way_request as Label),
        ("response", Language::way_response),
        ("exception", Language::way_exception),
    ];
    let header = el("header")
        .child(el("h2").say(app, Language::builder_title))
        .child(el("span").class("space"))
        .child(tabs(app, Language::way, "way", form.way, &ways));
    // Which fields there are, a bit each: they stay, with the cursor in them, as long as these are the same.
    let shape = RwSignal::new(0_u32);
    react(move || {
        let now = built.with(|built| built.draft.fields.iter().fold(0, |shape, field| shape | 1 << field.slot.index()));
        if shape.get_untracked() != now {
            shape.set(now);
        }
    });
    let fields = move || {
        shape.track();
        let slots: Vec<Slot> =
            built.with_untracked(|built| built.draft.fields.iter().map(|field| field.slot).collect());
        slots.into_iter().map(|slot| fields::slot_field(app, form, built, slot)).collect()
    };
    let message =
        el("div").class("fields").child(function_field(app, form)).child(el("div").class("contents").live(fields));
    el("section")
        .class("card builder-form")
        .child(header)
        .child(el("div").class("fields").children(fields::point_fields(app, form, built)))
        .child(message)
}

fn function_field(app: &'static Workbench, form: Form) -> El {
    let options = move || {
        let language = app.language.get();
        let named = crate::builder::FUNCTIONS.map(|code| {
            let code_text = hex(code);
            let label = [&code_text, " ", words::function_name(language, code)].concat();
            (code_text, label)
        });
        named.into_iter().chain([(form::TYPED.to_owned(), language.function_typed().to_owned())]).collect()
    };
    let list = choice("builder-function", form.function, options).on("change", move |_| form.leave_point());
    field(app, "builder-function", Language::function, list, || None)
}

/// Buttons of which one is pressed. Each is named `prefix-key` for the tests.
fn tabs(
    app: &'static Workbench,
    label: Label,
    prefix: &str,
    chosen: RwSignal<String>,
    tabs: &[(&'static str, Label)],
) -> El {
    let tab = |&(key, text): &(&'static str, Label)| {
        el("button")
            .attr("type", "button")
            .test(&[prefix, "-", key].concat())
            .state("aria-pressed", move || chosen.with(|chosen| chosen == key))
            .click(move || chosen.set(key.to_owned()))
            .say(app, text)
    };
    el("div").class("tabs").attr("role", "group").label(app, label).children(tabs.iter().map(tab))
}

/// Modes as tabs: their names are the same in all languages.
const MODES: [(&str, Label); 2] = [("rtu", |_| "RTU"), ("ascii", |_| "ASCII")];

/// A button that copies a text and says so until another text stands there. Where the clipboard is missing or refuses,
/// it selects the element `shown` for the user to copy.
fn copy_button(app: &'static Workbench, hook: &str, shown: String, text: String) -> El {
    let copied = RwSignal::new(false);
    bare("quiet small", hook)
        .attr("aria-live", "polite")
        .live_text(move || {
            let language = app.language.get();
            if copied.get() { language.copied() } else { language.copy() }.to_owned()
        })
        .click(move || crate::clipboard::copy(&text, &shown, copied))
}
