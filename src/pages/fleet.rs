//! The Fleet page: what devices hold, kept and compared; devices set up one after the other; and every write that was made.

mod audit;
mod compare;
mod labels;
mod progress;
mod sensors;
mod series;
mod setup;
mod snapshots;
mod state;

use wasm_bindgen::JsValue;

use crate::components::tabs::{place, tab_id, tabs};
use crate::dom::{El, el};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

pub(crate) use crate::pages::configure::configure_hint as hint;
pub(crate) use state::{Fleet, follow as follow_fleet};

/// The panes by their keys, in order.
const PANES: [(&str, Label); 3] =
    [("snapshots", Language::fleet_snapshots), ("series", Language::fleet_series), ("audit", Language::fleet_audit)];
/// The id of what the tabs show.
const PANEL: &str = "fleet-panel";

/// The page.
pub(crate) fn fleet_page(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    app.ask_snapshots();
    let open = Memo::new(move |_| place(&PANES, &fleet.pane.get()));
    let content = move || match open.get() {
        0 => vec![snapshots::snapshots_card(app), compare::compare_card(app)],
        1 => vec![series::series_pane(app)],
        _ => vec![audit::writes_card(app), audit::log_card(app)],
    };
    el("div")
        .class("page fleet")
        .test("page-fleet")
        .child(el("h1").class("visually-hidden").say(app, Language::fleet))
        .child(tabs(app, Language::fleet, "fleet-", PANEL, &PANES, fleet.pane))
        .child(
            el("div")
                .class("fleet-panel")
                .attr("id", PANEL)
                .attr("role", "tabpanel")
                .live_attr("aria-labelledby", move || PANES.get(open.get()).map(|(key, _)| tab_id(PANEL, key)))
                .live(content),
        )
}

/// The time of day now, in milliseconds since the Unix epoch.
fn now_ms() -> u64 {
    // In range until the year 10889.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let now = js_sys::Date::now().max(0.0) as u64;
    now
}

fn date(unix_ms: u64) -> js_sys::Date {
    // Milliseconds of some thousand years fit.
    #[allow(clippy::cast_precision_loss)]
    js_sys::Date::new(&JsValue::from_f64(unix_ms as f64))
}

/// The local date and time, as the language writes them.
fn moment(language: Language, unix_ms: u64) -> String {
    date(unix_ms).to_locale_string(language.tag(), &JsValue::UNDEFINED).into()
}

/// The local date, as the language writes it.
fn day(language: Language, unix_ms: u64) -> String {
    date(unix_ms).to_locale_date_string(language.tag(), &JsValue::UNDEFINED).into()
}

/// The local date and time as `2026-05-04 11:02:01`, for files: as Swedish writes them.
fn plain_moment(unix_ms: u64) -> String {
    date(unix_ms).to_locale_string("sv-SE", &JsValue::UNDEFINED).into()
}

/// The local date as `2026-05-04`, for names of files.
fn plain_day(unix_ms: u64) -> String {
    date(unix_ms).to_locale_date_string("sv-SE", &JsValue::UNDEFINED).into()
}
