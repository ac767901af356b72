//! What the Decoder page knows: the text, and what the analyst has made of it.

use buslens_analyst::message::{FromAnalyst, ToAnalyst};
use buslens_codec::intake::Form;
use js_sys::JsString;
use wasm_bindgen::JsValue;

use crate::analyst::Analyst;
use crate::components::desk::{AUTO, Desk};
use crate::reactive::prelude::*;
use crate::storage::{self, kept};
use crate::workbench::Workbench;

/// The longest text in characters that stays in the text field: a longer one would hold up the whole page there.
pub(super) const LONGEST_TYPED: u32 = 64 << 10;
/// Characters of a long text that are shown of it.
const PREVIEW: u32 = 2000;

/// The state of the page. It outlives a visit to another page.
pub(crate) struct Decoder {
    /// The list of frames.
    pub(super) desk: Desk,
    /// The text in the field; outlives a reload.
    pub(super) typed: RwSignal<String>,
    /// What stood there before an example or a link replaced it; outlives a reload.
    pub(super) previous: RwSignal<String>,
    /// A text that is too long for the field, or a file.
    pub(super) document: RwSignal<Option<Document>>,
    /// How the user wants it read.
    pub(super) form: RwSignal<Option<Form>>,
    /// Why a file could not be read.
    pub(super) unreadable: RwSignal<Option<String>>,
    started: StoredValue<bool>,
}

/// A text that does not stand in the field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Document {
    /// A file's name; `None` for pasted text.
    pub(super) name: Option<String>,
    /// Characters, or bytes of a file; 0 while it is not known.
    pub(super) size: u64,
    /// How it begins; empty for a file.
    pub(super) preview: String,
}

impl Decoder {
    /// With what was remembered.
    pub(crate) fn remembered() -> Self {
        Self {
            desk: Desk::new(Analyst::Decoder, "decoder-profile", AUTO),
            typed: kept("decoder", ""),
            previous: kept("decoder-previous", ""),
            document: RwSignal::new(None),
            form: RwSignal::new(None),
            unreadable: RwSignal::new(None),
            started: StoredValue::new(false),
        }
    }

    /// Starts the analyst at the first visit, and takes up the long text of the last one.
    pub(super) fn start(&self, app: &'static Workbench) {
        if self.started.get_value() {
            return;
        }
        self.started.set_value(true);
        app.start_analyst();
        self.desk.send_profile();
        if let Some(name) = storage::load("decoder-document").filter(|name| !name.is_empty()) {
            let name = Some(name).filter(|name| name != "\n");
            self.document.set(Some(Document { name, size: 0, preview: String::new() }));
            self.begin(&JsValue::UNDEFINED, false);
        }
    }

    /// Puts a text into the field; what stood there can be taken back.
    pub(super) fn replace(&self, text: String) {
        self.close_document();
        let old = self.typed.get_untracked();
        if old != text {
            if !old.trim().is_empty() {
                self.previous.set(old);
            }
            self.typed.set(text);
        }
    }

    /// Reads what stands in the field.
    pub(super) fn read_typed(&self) {
        if self.document.with_untracked(Option::is_none) {
            self.begin(&JsValue::from_str(&self.typed.get_untracked()), false);
        }
    }

    /// Reads a text that is too long for the field.
    pub(super) fn read_long(&self, text: &JsString) {
        let preview = String::from(text.substring(0, PREVIEW));
        self.document.set(Some(Document { name: None, size: text.length().into(), preview }));
        self.form.set(None);
        // Any name but a file's, and not empty.
        storage::save("decoder-document", "\n");
        self.begin(text, true);
    }

    /// Reads a file.
    pub(super) fn read_file(&self, file: &web_sys::File) {
        // A size is a whole number below 2^53.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let size = file.size() as u64;
        storage::save("decoder-document", &file.name());
        self.document.set(Some(Document { name: Some(file.name()), size, preview: String::new() }));
        self.form.set(None);
        self.begin(file, true);
    }

    /// Goes back to the text in the field.
    pub(super) fn close_document(&self) {
        if self.document.with_untracked(Option::is_some) {
            self.document.set(None);
            storage::save("decoder-document", "");
            Analyst::Decoder.send(&ToAnalyst::Forget);
            self.form.set(None);
            self.read_typed();
        }
    }

    /// Reads the same text in another way.
    pub(super) fn read_as(&self, form: Form) {
        self.form.set(Some(form));
        if self.document.with_untracked(Option::is_some) {
            self.begin(&JsValue::UNDEFINED, false);
        } else {
            self.read_typed();
        }
    }

    fn begin(&self, beside: &JsValue, keep: bool) {
        self.unreadable.set(None);
        let (reading, form) = (self.desk.next_reading(), self.form.get_untracked());
        Analyst::Decoder.send_with(&ToAnalyst::Read { reading, form, keep }, beside);
    }

    /// Takes in what the analyst says.
    pub(crate) fn hear(&self, message: FromAnalyst, beside: &JsValue) {
        match self.desk.hear(message, beside) {
            Some(FromAnalyst::NothingKept) => {
                self.document.set(None);
                storage::save("decoder-document", "");
                self.read_typed();
            }
            Some(FromAnalyst::Unreadable(words)) => self.unreadable.set(Some(words)),
            _ => {}
        }
    }
}
