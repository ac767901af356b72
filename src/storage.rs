//! What the page remembers on this computer: one string a key. Where the browser forbids it, nothing is remembered.

use crate::reactive::prelude::*;

use crate::dom::react;

/// The string last saved under `key`.
pub(crate) fn load(key: &str) -> Option<String> {
    local()?.get_item(&full(key)).ok().flatten()
}

/// Saves a string. Best effort: a full or forbidden store costs only the memory.
pub(crate) fn save(key: &str, value: &str) {
    if let Some(store) = local() {
        let _ = store.set_item(&full(key), value);
    }
}

/// A signal that starts with what was saved, or `default`, and saves every change.
pub(crate) fn kept(key: &'static str, default: &str) -> RwSignal<String> {
    let signal = RwSignal::new(load(key).unwrap_or_else(|| default.to_owned()));
    let mut first = true;
    react(move || {
        signal.with(|value| {
            if !std::mem::take(&mut first) {
                save(key, value);
            }
        });
    });
    signal
}

fn full(key: &str) -> String {
    ["buslens.", key].concat()
}

fn local() -> Option<web_sys::Storage> {
    window().local_storage().ok().flatten()
}
