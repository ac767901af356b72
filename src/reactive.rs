//! Leptos, by the parts that the page is built on: its signals and its way to the document.
//!
//! Its façade crate brings server functions too, whose exported classes no linker can drop: 8 KB of the first load, and
//! sixty crates to compile, for nothing. Elements are made by [`crate::dom`], for the same reason.

use reactive_graph::owner::Owner;

/// What every part of the page needs.
pub(crate) mod prelude {
    pub(crate) use leptos_dom::helpers::{document, request_animation_frame, set_interval_with_handle, window};
    pub(crate) use reactive_graph::computed::Memo;
    pub(crate) use reactive_graph::effect::RenderEffect;
    pub(crate) use reactive_graph::graph::untrack;
    pub(crate) use reactive_graph::owner::{StoredValue, on_cleanup};
    pub(crate) use reactive_graph::signal::RwSignal;
    pub(crate) use reactive_graph::traits::{
        Get, GetUntracked, GetValue, Set, SetValue, Track, Update, UpdateValue, With, WithUntracked, WithValue,
    };
}

/// Runs `build` under an owner that lives as long as the page does.
pub(crate) fn run_forever(build: impl FnOnce()) {
    // Fails only if it has been done before.
    let _ = any_spawner::Executor::init_wasm_bindgen();
    let owner = Owner::new();
    owner.with(build);
    std::mem::forget(owner);
}
