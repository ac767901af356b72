//! The head of the list: how long it is, a link to its text, files of it.

use buslens_analyst::message::Format;

use crate::clipboard;
use crate::components::button::bare;
use crate::components::desk::tools::{counts_text, export_menu};
use crate::dom::{El, el};
use crate::reactive::prelude::*;
use crate::route;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// The longest text in characters that a link holds; browsers and mail programs cut longer ones.
const LONGEST_LINK: usize = 8000;

/// What the list can be saved as.
const FORMATS: [(&str, Label, Format); 3] = [
    ("export-jsonl", Language::export_jsonl, Format::JsonLines),
    ("export-csv", Language::export_csv, Format::Csv),
    ("export-hex", Language::export_hex, Format::Hex),
];

/// The head of the list's card.
pub(super) fn list_header(app: &'static Workbench) -> El {
    let desk = &app.decoder.desk;
    el("header")
        .child(el("h2").say(app, Language::frames))
        .child(el("span").class("muted").test("frame-count").live_text(move || counts_text(app, desk)))
        .child(el("span").class("space"))
        .child(link_button(app))
        .child(export_menu(app, desk, &FORMATS))
}

/// Copies a link that holds the text of the field: nothing leaves the machine before the link does.
fn link_button(app: &'static Workbench) -> El {
    let decoder = &app.decoder;
    let copied = RwSignal::new(false);
    let short = Memo::new(move |_| {
        decoder.document.with(Option::is_none) && decoder.typed.with(|text| text.len() <= LONGEST_LINK)
    });
    bare("quiet small", "copy-link")
        .flag("disabled", move || !short.get())
        .live_text(move || {
            decoder.typed.track();
            let language = app.language.get();
            if !short.get() {
                language.link_too_long()
            } else if copied.get() {
                language.copied_link()
            } else {
                language.copy_link()
            }
            .to_owned()
        })
        .click(move || {
            let link = route::text_link(&decoder.typed.get_untracked());
            clipboard::write(&link, move |well| copied.set(well));
        })
}
