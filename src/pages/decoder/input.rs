//! The text: typed, pasted, dropped, from a file. What is too long for a field is read beside it.

use js_sys::JsString;
use wasm_bindgen::prelude::*;
use web_sys::Event;

use super::desk::{Decoder, Document, LONGEST_TYPED};
use crate::components::bring::{self, Dropped};
use crate::components::button::{button, icon_button};
use crate::components::desk::reading::understood;
use crate::components::icon::{Icon, icon};
use crate::dom::{El, el};
use crate::format;
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// Texts to begin with: name for the tests, label, text. A reply stands behind its request, which alone tells its registers.
const EXAMPLES: [(&str, Label, &str); 4] = [
    ("request", Language::example_request, "0C 04 00 04 00 02 31 17"),
    ("reply", Language::example_reply, "0C 04 00 04 00 02 31 17\n0C 04 04 80 00 01 48 0F 22"),
    ("exception", Language::example_exception, "0C 04 00 04 00 01 71 16\n0C 84 02 53 02"),
    ("ascii", Language::example_ascii, ":010300310001CA"),
];

/// The card with the text and what was understood of it.
pub(super) fn input_card(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    let restorable = Memo::new(move |_| desk.previous.with(|previous| !previous.is_empty()));
    let restore = move || {
        icon_button(app, "quiet small", "restore-text", Icon::Reset, Language::restore_text)
            .click(move || desk.replace(desk.previous.get_untracked()))
    };
    let header = el("header")
        .child(el("h2").say(app, Language::decoder_title))
        .child(el("span").class("space"))
        .live_one(move || restorable.get().then(restore))
        .child(file_button(app));
    let examples = EXAMPLES.iter().map(|&(test, label, text)| {
        button(app, "small", &["example-", test].concat(), label).click(move || desk.replace(text.to_owned()))
    });
    let footer = el("footer").child(el("span").class("muted").say(app, Language::examples)).children(examples);
    let long = Memo::new(move |_| desk.document.with(Option::is_some));
    el("section")
        .class("card input")
        .test("decoder-drop")
        .child(header)
        .live_one(move || Some(if long.get() { document(app) } else { field(app) }))
        .child(understood(app, &desk.desk, desk.unreadable, move |form| desk.read_as(form)))
        .child(footer)
        .on("dragover", |event| event.prevent_default())
        .on("drop", move |event| dropped(desk, &event))
}

/// The field for what fits one.
fn field(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    let area = el("textarea")
        .attr("id", "decoder-input")
        .test("decoder-input")
        .attr("rows", "5")
        .attr("spellcheck", "false")
        .attr("autocapitalize", "off")
        .attr("autocomplete", "off")
        .live_attr("placeholder", move || Some(app.language.get().decoder_placeholder().to_owned()))
        .on("paste", move |event| pasted(desk, &event))
        .on("input", move |event| typed_long(desk, &event))
        .bind("input", desk.typed);
    el("div")
        .class("contents")
        .child(el("label").class("visually-hidden").attr("for", "decoder-input").say(app, Language::decoder_input))
        .child(area)
}

/// A text that is too long for the field pastes beside it: laying it out would hold up the page for seconds.
fn pasted(desk: &Decoder, event: &Event) {
    let Some(text) = bring::pasted(event) else { return };
    if text.length() > LONGEST_TYPED {
        event.prevent_default();
        desk.read_long(&text);
    }
}

/// Whatever else brings a long text into the field.
fn typed_long(desk: &Decoder, event: &Event) {
    let Some(field) = event.target() else { return };
    let Ok(text) = field.unchecked_into::<Field>().value().dyn_into::<JsString>() else { return };
    if text.length() > LONGEST_TYPED {
        event.stop_immediate_propagation();
        desk.read_long(&text);
    }
}

fn dropped(desk: &Decoder, event: &Event) {
    match bring::dropped(event) {
        Some(Dropped::File(file)) => desk.read_file(&file),
        Some(Dropped::Text(text)) if text.length() > LONGEST_TYPED => desk.read_long(&text),
        Some(Dropped::Text(text)) if text.length() > 0 => desk.replace(text.into()),
        _ => {}
    }
}

fn file_button(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    let chooser = bring::chooser("decoder-file", move |file| desk.read_file(&file));
    el("label")
        .class("button small file")
        .child(icon(Icon::File))
        .child(el("span").say(app, Language::open_file))
        .child(chooser)
}

/// A text that does not stand in the field.
fn document(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    let told = move || {
        let language = app.language.get();
        desk.document
            .with(|document| document.as_ref().map(|document| description(language, document)).unwrap_or_default())
    };
    let preview =
        move || desk.document.with(|document| document.as_ref().map(|found| found.preview.clone()).unwrap_or_default());
    let has_preview = Memo::new(move |_| !preview().is_empty());
    el("div")
        .class("document")
        .test("decoder-document")
        .child(
            el("div")
                .class("document-head")
                .child(icon(Icon::File))
                .child(el("b").live_text(told))
                .child(el("span").class("space"))
                .child(
                    button(app, "small", "close-document", Language::close_document)
                        .click(move || desk.close_document()),
                ),
        )
        .live_one(move || {
            has_preview
                .get()
                .then(|| el("pre").attr("tabindex", "0").label(app, Language::begins_with).live_text(preview))
        })
}

fn description(language: Language, document: &Document) -> String {
    let Document { name, size, .. } = document;
    let size = format::count(*size);
    match name {
        Some(name) if document.size == 0 => name.clone(),
        Some(name) => [name, ", ", &language.size_bytes(&size)].concat(),
        None if document.size == 0 => language.pasted_text().to_owned(),
        None => [language.pasted_text(), language.list_comma(), &language.size_characters(&size)].concat(),
    }
}

#[wasm_bindgen]
extern "C" {
    type Field;
    #[wasm_bindgen(method, getter)]
    fn value(this: &Field) -> JsValue;
}
