//! How the device is wired, drawn from its profile, and three steps to the first reading.

use buslens_codec::profile::Wire;
use leptos::prelude::*;

use crate::app::App;
use crate::device;
use crate::format::signed;
use crate::text::Language;

/// Distance of two wires in the drawing.
const PITCH: usize = 30;
/// Height of the first wire.
const FIRST: usize = 34;

/// The card; only the steps for a device whose wires are not known.
pub(super) fn wiring(app: &'static App) -> AnyView {
    view! {
        <aside class="card wiring">
            <header>
                <h2>{app.text(Language::wiring_title)}</h2>
            </header>
            {move || drawing(app)}
            <ol class="steps">
                <li>{app.text(Language::step_wire)}</li>
                <li>{app.text(Language::step_port)}</li>
                <li>{app.text(Language::step_connect)}</li>
            </ol>
        </aside>
    }
    .into_any()
}

fn drawing(app: &'static App) -> Option<AnyView> {
    let language = app.language.get();
    let wires = app.settings.device().wires();
    if wires.is_empty() {
        return None;
    }
    let rows: Vec<_> = wires.iter().enumerate().map(|(at, wire)| row(language, wire, FIRST + at * PITCH)).collect();
    let height = FIRST + wires.len() * PITCH;
    let label = wires
        .iter()
        .map(|wire| [device::pick(language, &wire.name), " → ", &signed(&wire.signal)].concat())
        .collect::<Vec<_>>()
        .join(", ");
    Some(
        view! {
            <svg class="wires" viewBox=["0 0 320 ", &(height + 14).to_string()].concat() role="img" aria-label=label>
                <rect class="housing" x="10" y="8" width="66" height=height rx="8" />
                <text class="part" x="43" y=(height / 2 + 12).to_string() text-anchor="middle">
                    {language.wire_sensor()}
                </text>
                {rows}
            </svg>
        }
        .into_any(),
    )
}

/// One wire: from the sensor's housing to its terminal.
fn row(language: Language, wire: &Wire, y: usize) -> AnyView {
    let line = ["M76 ", &y.to_string(), "H204"].concat();
    let text_y = (y + 4).to_string();
    view! {
        <path class="wire-edge" d=line.clone() />
        <path class="wire" data-color=wire.color.clone() d=line />
        <text class="colour" x="140" y=(y - 6).to_string() text-anchor="middle">
            {device::pick(language, &wire.name).to_owned()}
        </text>
        <circle class="terminal" cx="210" cy=y.to_string() r="6" />
        <text class="signal" x="224" y=text_y.clone()>
            {signed(&wire.signal)}
        </text>
        <text class="use" x="250" y=text_y>
            {device::pick(language, &wire.purpose).to_owned()}
        </text>
    }
    .into_any()
}
