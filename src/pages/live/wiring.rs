//! How the device is wired, drawn from its profile, and three steps to the first reading.

use crate::reactive::prelude::*;
use buslens_codec::profile::Wire;

use crate::app::App;
use crate::device;
use crate::dom::{El, el, svg};
use crate::format::signed;
use crate::text::Language;

/// Distance of two wires in the drawing.
const PITCH: usize = 30;
/// Height of the first wire.
const FIRST: usize = 34;

/// The card; only the steps for a device whose wires are not known.
pub(super) fn wiring(app: &'static App) -> El {
    let step = |text| el("li").say(app, text);
    let steps = el("ol")
        .class("steps")
        .child(step(Language::step_wire))
        .child(step(Language::step_port))
        .child(step(Language::step_connect));
    el("aside")
        .class("card wiring")
        .child(el("header").child(el("h2").say(app, Language::wiring_title)))
        .live_one(move || drawing(app.language.get(), app.settings.device().wires()))
        .child(steps)
}

fn drawing(language: Language, wires: &[Wire]) -> Option<El> {
    if wires.is_empty() {
        return None;
    }
    let height = FIRST + wires.len() * PITCH - 6;
    let label = wires
        .iter()
        .map(|wire| [device::pick(language, &wire.name), " → ", &signed(&wire.signal)].concat())
        .collect::<Vec<_>>()
        .join(", ");
    let housing = svg("rect").class("housing").attr("x", "10").attr("y", "8").attr("width", "62").attr("rx", "8");
    let drawing = svg("svg")
        .class("wires")
        .attr("viewBox", &["0 0 340 ", &(height + 14).to_string()].concat())
        .attr("role", "img")
        .attr("aria-label", &label)
        .child(housing.attr("height", &height.to_string()))
        .child(label_at("part", 41, height / 2 + 12, language.wire_sensor()).attr("text-anchor", "middle"));
    let rows = wires.iter().enumerate().flat_map(|(at, wire)| row(language, wire, FIRST + at * PITCH));
    Some(drawing.children(rows))
}

/// One wire: from the sensor's housing to its terminal.
fn row(language: Language, wire: &Wire, y: usize) -> [El; 6] {
    let line = ["M72 ", &y.to_string(), "H160"].concat();
    [
        svg("path").class("wire-edge").attr("d", &line),
        svg("path").class("wire").attr("data-color", &wire.color).attr("d", &line),
        label_at("colour", 115, y - 6, device::pick(language, &wire.name)).attr("text-anchor", "middle"),
        svg("circle").class("terminal").attr("cx", "166").attr("cy", &y.to_string()).attr("r", "6"),
        label_at("signal", 180, y + 4, &signed(&wire.signal)),
        label_at("use", 216, y + 4, &device::pick(language, &wire.purpose).replace('-', "\u{2013}")),
    ]
}

fn label_at(class: &str, x: usize, y: usize, text: &str) -> El {
    svg("text").class(class).attr("x", &x.to_string()).attr("y", &y.to_string()).text(text)
}
