//! The ways by which a file or a text comes into the page: chosen, dropped, pasted. A text stays the browser's own: a long
//! one is never copied into the program.

use js_sys::JsString;
use wasm_bindgen::prelude::*;
use web_sys::{DragEvent, Event, File, HtmlInputElement};

use crate::dom::{El, el};

/// A chooser of one file, to be shown by a label of its own.
pub(crate) fn chooser(hook: &str, take: impl Fn(File) + 'static) -> El {
    el("input").attr("type", "file").attr("id", hook).class("visually-hidden").test(hook).on("change", move |event| {
        let Some(chooser) = event.target().map(JsCast::unchecked_into::<HtmlInputElement>) else { return };
        if let Some(file) = chooser.files().and_then(|files| files.get(0)) {
            take(file);
        }
        // The same file can be chosen again.
        chooser.set_value("");
    })
}

/// What was dropped.
pub(crate) enum Dropped {
    /// The first of the files.
    File(File),
    /// A text; may be empty.
    Text(JsString),
}

/// Takes what was dropped, so that the browser does not open it.
pub(crate) fn dropped(event: &Event) -> Option<Dropped> {
    event.prevent_default();
    let transfer = event.unchecked_ref::<DragEvent>().data_transfer()?;
    Some(match transfer.files().and_then(|files| files.get(0)) {
        Some(file) => Dropped::File(file),
        None => Dropped::Text(transfer.unchecked_ref::<Clipboard>().text("text")),
    })
}

/// The text that is being pasted.
pub(crate) fn pasted(event: &Event) -> Option<JsString> {
    Some(event.unchecked_ref::<Transfer>().clipboard()?.text("text"))
}

#[wasm_bindgen]
extern "C" {
    type Transfer;
    #[wasm_bindgen(method, getter, js_name = clipboardData)]
    fn clipboard(this: &Transfer) -> Option<Clipboard>;

    type Clipboard;
    #[wasm_bindgen(method, js_name = getData)]
    fn text(this: &Clipboard, kind: &str) -> JsString;
}
