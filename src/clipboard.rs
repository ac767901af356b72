//! The way to the clipboard.

use wasm_bindgen_futures::{JsFuture, spawn_local};

use crate::reactive::*;

/// Copies a text and tells `copied`. Where the clipboard is missing or refuses, selects the element with the id `shown`
/// instead, so that the user can copy it.
pub(crate) fn copy(text: &str, shown: &str, copied: RwSignal<bool>) {
    if !window().is_secure_context() {
        select(shown);
        return;
    }
    let writing = window().navigator().clipboard().write_text(text);
    let shown = shown.to_owned();
    spawn_local(async move {
        match JsFuture::from(writing).await {
            Ok(_) => copied.set(true),
            Err(_) => select(&shown),
        }
    });
}

fn select(id: &str) {
    let selection = window().get_selection().ok().flatten();
    if let Some((selection, element)) = selection.zip(document().get_element_by_id(id)) {
        let _ = selection.select_all_children(&element);
    }
}
