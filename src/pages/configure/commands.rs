//! What the device does when it is told to: each command with its consequence, never sent without a look at its frame.

use buslens_codec::profile::{Code, Point, Role};
use buslens_configure::Edit;

use super::state::Wish;
use super::table::danger_mark;
use crate::components::button::bare;
use crate::configure::{row, words};
use crate::device::Device;
use crate::dom::{El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// The card; an empty box for a device without commands.
pub(super) fn commands_card(app: &'static Workbench, device: &'static Device) -> El {
    let commands: Vec<&'static Point> =
        device.profile().points.iter().filter(|point| point.role == Role::Command).collect();
    if commands.is_empty() {
        return el("div").class("contents");
    }
    el("section")
        .class("card cfg-commands")
        .test("commands")
        .child(
            el("header")
                .child(el("h2").say(app, Language::cfg_commands))
                .child(el("span").class("muted").say(app, Language::cfg_commands_hint)),
        )
        .child(el("ul").class("cfg-command-list").children(commands.into_iter().map(|point| command(app, point))))
}

fn command(app: &'static Workbench, point: &'static Point) -> El {
    let note = point
        .note
        .as_ref()
        .map(|note| el("small").class("muted").live_text(move || words::pick(app.language.get(), note).clone()));
    let name = el("div")
        .class("cfg-name")
        .child(el("b").live_text(move || words::pick(app.language.get(), &point.name).clone()))
        .children(danger_mark(app, row::danger(point)))
        .child(el("code").class("cfg-raw").text(&format!("0x{:04X}", point.register)))
        .children(note);
    let codes = point.codes.iter().map(|code| code_button(app, point, code));
    el("li").child(name).child(el("div").class("cfg-codes").children(codes))
}

fn code_button(app: &'static Workbench, point: &'static Point, code: &'static Code) -> El {
    let configure = &app.configure;
    let label = move || {
        let language = app.language.get();
        let name = code.name.as_ref().map(|name| words::pick(language, name).clone());
        [&name.unwrap_or_else(|| row::typed_code(code.code)), "\u{2026}"].concat()
    };
    let registers = point.encoding.encode(buslens_codec::value::Value::Code(code.code)).unwrap_or_default();
    let hook = format!("command-{}-{}", point.id, code.code);
    bare("small", &hook).flag("disabled", move || app.configuring.is_busy()).live_text(label).click(move || {
        configure.review(Wish::Command(Edit { point: point.id.clone(), registers: registers.clone() }));
    })
}
