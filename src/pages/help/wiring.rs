//! How the device is wired, drawn from its profile: its wires to the supply and to the adapter, and its plug.

use buslens_codec::profile::{Interface, Profile, Wire};

use crate::device::pick;
use crate::dom::{El, el, svg};
use crate::format::signed;
use crate::text::Language;

/// Distance of two wires in the drawing.
const PITCH: usize = 32;
/// Height of the first wire.
const FIRST: usize = 40;
/// Right edge of the device, and left edge of what its wires lead to.
const LEFT: usize = 84;
const RIGHT: usize = 232;

/// The drawing, the plug where there is one, and the wires in a table. A sentence where no wires are known.
pub(super) fn wiring(language: Language, profile: &Profile) -> Vec<El> {
    let rs232 = profile.interface == Interface::Rs232;
    if profile.wiring.is_empty() {
        let text = if rs232 { language.device_help_rs232() } else { language.device_help_no_wires() };
        return vec![el("p").text(text)];
    }
    let hint = if rs232 { language.device_help_rs232() } else { language.device_help_rs485() };
    let mut all = vec![drawing(language, profile)];
    if profile.wiring.iter().any(|wire| wire.pin.is_some()) {
        all.push(el("p").class("muted").text(language.device_help_plug()));
        all.push(plug(profile));
    }
    all.push(table(language, &profile.wiring));
    all.push(el("p").text(hint));
    all
}

fn drawing(language: Language, profile: &Profile) -> El {
    let wires = &profile.wiring;
    let bottom = FIRST + wires.len() * PITCH;
    let label: Vec<String> =
        wires.iter().map(|wire| [pick(language, &wire.name), " → ", &signed(&wire.signal)].concat()).collect();
    let device = frame(8, LEFT, 14, bottom - 12);
    let mut drawing = svg("svg")
        .class("wires help-wires")
        .attr("viewBox", &["0 0 340 ", &(bottom + 4).to_string()].concat())
        .attr("role", "img")
        .attr("aria-label", &label.join(", "))
        .child(device)
        .child(text("part", 46, bottom / 2 + 4, language.device_help_device()).attr("text-anchor", "middle"));
    // Neighbours that lead to the same thing share a box.
    let mut at = 0;
    for run in wires.chunk_by(|wire, next| is_supply(wire) == is_supply(next)) {
        let (top, end) = (FIRST + at * PITCH, FIRST + (at + run.len() - 1) * PITCH);
        let name = match (run.first().is_some_and(is_supply), profile.interface) {
            (true, _) => language.device_help_supply(),
            (false, Interface::Rs485) => language.device_help_adapter(),
            (false, Interface::Rs232) => "RS232",
        };
        drawing = drawing
            .child(frame(RIGHT, 332, top - 13, end + 13))
            .child(text("part", 324, usize::midpoint(top, end) + 4, name).attr("text-anchor", "end"));
        at += run.len();
    }
    let rows = wires.iter().enumerate().flat_map(|(at, wire)| row(language, wire, FIRST + at * PITCH));
    drawing.children(rows)
}

fn is_supply(wire: &Wire) -> bool {
    wire.signal.starts_with(['V', '+']) || wire.signal == "GND"
}

/// One wire: from the device to its terminal.
fn row(language: Language, wire: &Wire, y: usize) -> [El; 5] {
    let line = ["M", &LEFT.to_string(), " ", &y.to_string(), "H", &RIGHT.to_string()].concat();
    let middle = usize::midpoint(LEFT, RIGHT);
    [
        svg("path").class("wire-edge").attr("d", &line),
        svg("path").class("wire").attr("data-color", &wire.color).attr("d", &line),
        text("colour", middle, y - 6, pick(language, &wire.name)).attr("text-anchor", "middle"),
        svg("circle").class("terminal").attr("cx", &RIGHT.to_string()).attr("cy", &y.to_string()).attr("r", "5"),
        text("signal", RIGHT + 12, y + 4, &signed(&wire.signal)),
    ]
}

/// A plug with nine pins (DE-9), the used ones in the colours of their wires.
fn plug(profile: &Profile) -> El {
    let pins = (1..=9_u8).flat_map(|pin| {
        let (row, place) = if pin <= 5 { (0, usize::from(pin) - 1) } else { (1, usize::from(pin) - 6) };
        let (x, y) = (38 + place * 32 + row * 16, 36 + row * 36);
        let wire = profile.wiring.iter().find(|wire| wire.pin == Some(pin));
        let dot = svg("circle").class("pin").attr("cx", &x.to_string()).attr("cy", &y.to_string()).attr("r", "6");
        let dot = if let Some(wire) = wire { dot.attr("data-color", &wire.color) } else { dot };
        let signal = wire.map(|wire| signed(&wire.signal)).unwrap_or_default();
        let number = text("colour", x, y + 18, &pin.to_string());
        [dot, number.attr("text-anchor", "middle"), text("colour", x, y - 11, &signal).attr("text-anchor", "middle")]
    });
    svg("svg")
        .class("wires plug")
        .attr("viewBox", "0 0 204 104")
        .attr("aria-hidden", "true")
        .child(
            svg("path")
                .class("housing")
                .attr("d", "M16 8h172q10 0 8 10l-14 70q-2 8-10 8h-140q-8 0-10-8l-14-70q-2-10 8-10z"),
        )
        .children(pins)
}

fn table(language: Language, wires: &[Wire]) -> El {
    let has_pins = wires.iter().any(|wire| wire.pin.is_some());
    let head = [
        Some(language.device_help_wire()),
        Some(language.device_help_terminal()),
        has_pins.then(|| language.device_help_pin()),
        Some(language.device_help_use()),
    ];
    let heads = head.into_iter().flatten().map(|text| el("th").attr("scope", "col").text(text));
    let rows = wires.iter().map(|wire| {
        let pin = has_pins.then(|| wire.pin.map(|pin| pin.to_string()).unwrap_or_default());
        let use_text = pick(language, &wire.purpose).replace('-', "\u{2013}");
        let cells = [Some(pick(language, &wire.name).to_owned()), Some(signed(&wire.signal)), pin, Some(use_text)];
        el("tr").children(cells.into_iter().flatten().map(|cell| el("td").text(&cell)))
    });
    el("table").child(el("thead").child(el("tr").children(heads))).child(el("tbody").children(rows))
}

fn frame(left: usize, right: usize, top: usize, bottom: usize) -> El {
    svg("rect")
        .class("housing")
        .attr("x", &left.to_string())
        .attr("y", &top.to_string())
        .attr("width", &(right - left).to_string())
        .attr("height", &(bottom - top).to_string())
        .attr("rx", "7")
}

fn text(class: &str, x: usize, y: usize, text: &str) -> El {
    svg("text").class(class).attr("x", &x.to_string()).attr("y", &y.to_string()).text(text)
}
