//! The way to the clipboard.

use wasm_bindgen_futures::{JsFuture, spawn_local};

use crate::reactive::prelude::*;

/// Copies a text and tells whether that went well: a page that is not secure has no clipboard, and a browser may refuse.
pub(crate) fn write(text: &str, done: impl FnOnce(bool) + 'static) {
    if !window().is_secure_context() {
        done(false);
        return;
    }
    let writing = window().navigator().clipboard().write_text(text);
    spawn_local(async move { done(JsFuture::from(writing).await.is_ok()) });
}

/// Copies a text and tells `copied`. Where that fails, selects the element with the id `shown` instead, so that the user
/// can copy it.
pub(crate) fn copy(text: &str, shown: &str, copied: RwSignal<bool>) {
    let shown = shown.to_owned();
    write(text, move |well| if well { copied.set(true) } else { select(&shown) });
}

fn select(id: &str) {
    let selection = window().get_selection().ok().flatten();
    if let Some((selection, element)) = selection.zip(document().get_element_by_id(id)) {
        let _ = selection.select_all_children(&element);
    }
}
