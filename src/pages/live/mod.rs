//! The Live page: connects, and shows what is read.

mod connect;
mod counters;
mod exchange;
mod faults;
mod figures;
mod trend_strip;
mod units;
mod wiring;

use crate::reactive::prelude::*;

use crate::app::{App, Phase};
use crate::components::alert::{Fault, fault_panel};
use crate::components::shell::port_name;
use crate::dom::{El, el};
use crate::loader;
use crate::message::{Health, Link, Live, Source, Status, ToWorkbench};
use crate::serial;
use crate::text::Language;
pub(crate) use exchange::{exchange_halves, exchange_of};
use faults::Facts;
use units::Units;

/// The page.
pub(crate) fn live_page(app: &'static App) -> El {
    let fault = Memo::new(move |_| fault(app));
    let session = session(app);
    el("div")
        .class("page live")
        .test("page-live")
        .child(el("h1").class("visually-hidden").say(app, Language::live))
        .live_one(move || fault.with(|fault| fault.as_ref().map(|fault| fault_panel(app, fault))))
        .live_one(move || Some(if session.get() { session_view(app) } else { connect::connect(app) }))
}

/// Whether a port is open. An attempt that fails stays on the card; a port that was lost and is opened again stays on the
/// readings.
fn session(app: &'static App) -> Memo<bool> {
    Memo::new(move |before: Option<&bool>| match app.phase.get() {
        Phase::Closed | Phase::Failed => false,
        Phase::Opening => before.copied().unwrap_or(false),
        Phase::Waiting | Phase::Reading | Phase::Failing | Phase::Lost | Phase::Closing => true,
    })
}

/// What stands above a page that needs a port, while there is none: why, and the card that opens one.
pub(crate) fn connect_above(app: &'static App) -> El {
    let fault = Memo::new(move |_| fault(app));
    let session = session(app);
    el("div").class("contents").live_one(move || {
        (!session.get()).then(|| {
            el("details")
                .class("connect-above")
                .attr("open", "")
                .child(el("summary").say(app, Language::state_closed))
                .live_one(move || fault.with(|fault| fault.as_ref().map(|fault| fault_panel(app, fault))))
                .child(connect::connect(app))
        })
    })
}

fn session_view(app: &'static App) -> El {
    let units = Units::of(app.settings.device());
    el("div")
        .class("session")
        .child(figures::figures(app, units))
        .child(counters::counts(app))
        .child(el("div").class("handling-place").child(handling(app, units)))
        .child(trend_strip::trend_strip(app, units))
        .child(exchange::last_exchange(app))
}

/// What can be done with the device, as the workbench shows it.
fn handling(app: &'static App, units: Units) -> El {
    let live = move || {
        let used = app.connection.get()?;
        let status = app.status.with(|status| Status { readings: status.readings.clone(), ..Status::default() });
        let phase = app.phase.get();
        Some(Live {
            device: app.settings.device().id().to_owned(),
            unit: used.unit,
            line: used.line,
            mode: used.mode,
            status,
            is_current: phase == Phase::Reading,
            is_open: matches!(phase, Phase::Waiting | Phase::Reading | Phase::Failing),
            is_replay: used.source == Source::Replay,
            read_only: app.read_only.get(),
            units: units.kept(),
        })
    };
    loader::place(app, move || ToWorkbench::Handling(live()), ToWorkbench::Handling(None))
}

/// The one fault to tell: the link's, else the device's, else the picker's, else the missing of serial ports.
fn fault(app: &'static App) -> Option<Fault> {
    let language = app.language.get();
    let facts = || Facts::of(app, port_name(app));
    app.status.with(|status| match (&status.link, &status.health) {
        (Link::Failed(fault), _) => Some(faults::open(language, fault, &facts())),
        (Link::Lost, _) => Some(faults::lost(language, &facts())),
        (Link::Open, Health::Failing(trouble)) => Some(faults::trouble(language, trouble, &facts())),
        (Link::Closed, _) => match app.pick_fault.get() {
            Some(fault) => Some(faults::pick(language, &fault)),
            None => serial::missing().map(|missing| faults::missing(language, missing)),
        },
        _ => None,
    })
}
