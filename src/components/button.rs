//! Buttons.

use super::icon::{Icon, icon};
use crate::ambient::Ambient;
use crate::dom::{El, el};
use crate::text::Language;

/// A button with a text. `hook` names it for the tests, `look` is one or more of `primary`, `quiet`, `small`, `large`, `square`.
pub(crate) fn button(app: &'static Ambient, look: &str, hook: &str, text: fn(Language) -> &'static str) -> El {
    bare(look, hook).say(app, text)
}

/// A button with an icon before its text.
pub(crate) fn icon_button(
    app: &'static Ambient,
    look: &str,
    hook: &str,
    mark: Icon,
    text: fn(Language) -> &'static str,
) -> El {
    bare(look, hook).child(icon(mark)).child(el("span").say(app, text))
}

/// A button that opens a few others below it; choosing one of them, or going elsewhere, closes them again.
pub(crate) fn menu(app: &'static Ambient, hook: &str, text: fn(Language) -> &'static str, items: Vec<El>) -> El {
    let summary = el("summary").class("button quiet small").test(hook).say(app, text);
    let menu = el("details").class("menu").attr("id", &[hook, "-menu"].concat());
    let (chosen, left) = (menu.handle(), menu.handle());
    let items = el("div").class("menu-items").children(items).on("click", move |_| chosen.close());
    menu.child(summary).child(items).on("focusout", move |event| {
        if !left.holds_next_focus(&event) {
            left.close();
        }
    })
}

/// A button without anything in it.
pub(crate) fn bare(look: &str, hook: &str) -> El {
    el("button").attr("type", "button").class(&["button ", look].concat()).test(hook)
}
