//! What the page remembers on this computer: one string a key. Where the browser forbids it, nothing is remembered.

use crate::reactive::prelude::*;

use crate::dom::react;

/// The key of the user's own profiles. It is there only while there are any.
pub(crate) const OWN_PROFILES: &str = "profiles";

/// The string last saved under `key`.
pub(crate) fn load(key: &str) -> Option<String> {
    local()?.get_item(&full(key)).ok().flatten()
}

/// Saves a string. Best effort: a full or forbidden store costs only the memory.
pub(crate) fn save(key: &str, value: &str) {
    let _ = is_saved(key, value);
}

/// Saves a string, and says whether the browser has taken it.
pub(crate) fn is_saved(key: &str, value: &str) -> bool {
    local().is_some_and(|store| store.set_item(&full(key), value).is_ok())
}

/// Forgets what was saved.
pub(crate) fn forget(key: &str) {
    if let Some(store) = local() {
        let _ = store.remove_item(&full(key));
    }
}

/// Saves a string; whether there was room for it.
pub(crate) fn has_saved(key: &str, value: &str) -> bool {
    local().is_some_and(|store| store.set_item(&full(key), value).is_ok())
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
