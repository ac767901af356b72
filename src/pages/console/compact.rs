//! Small controls with their name beside or above them, for where there is little room.

use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Label;
use crate::workbench::Workbench;

/// A control with its name above it.
pub(super) fn field(app: &'static Workbench, label: Label, control: El) -> El {
    el("label").class("compact").child(el("span").say(app, label)).child(control)
}

/// A list to choose from, bound to a signal. `options` are values with their labels.
pub(super) fn select(
    hook: &'static str,
    value: RwSignal<String>,
    options: impl Fn() -> Vec<(String, String)> + 'static,
) -> El {
    let shown = RwSignal::new(0_u32);
    el("select")
        .attr("id", hook)
        .test(hook)
        .live(move || {
            shown.update(|turn| *turn = turn.wrapping_add(1));
            options().iter().map(|(key, label)| el("option").attr("value", key).text(label)).collect()
        })
        .live_value(move || {
            // New options forget what was chosen.
            shown.track();
            value.get()
        })
        .on("change", move |event| value.set(dom::value(&event)))
}

/// Buttons of which one is pressed. The group has the id `hook`; each is named `hook-key` for the tests.
pub(super) fn tabs<const N: usize>(
    app: &'static Workbench,
    label: Label,
    hook: &str,
    value: impl Fn() -> &'static str + Copy + 'static,
    choose: impl Fn(&'static str) + Copy + 'static,
    tabs: [(&'static str, Label); N],
) -> El {
    let tab = |(key, text): (&'static str, Label)| {
        el("button")
            .attr("type", "button")
            .test(&[hook, "-", key].concat())
            .state("aria-pressed", move || value() == key)
            .click(move || choose(key))
            .say(app, text)
    };
    el("div").class("tabs").attr("id", hook).attr("role", "group").label(app, label).children(tabs.map(tab))
}
