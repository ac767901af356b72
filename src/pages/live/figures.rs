//! The readings: large figures with unit and statistics. Old ones are dimmed and say how old they are.

use crate::reactive::prelude::*;
use buslens_codec::profile::{Beyond, Point};

use super::units::Units;
use crate::app::{App, Phase};
use crate::components::button::icon_button;
use crate::components::icon::Icon;
use crate::device::{self, Device};
use crate::dom::{El, el};
use crate::format::fixed;
use crate::history::Statistics;
use crate::loader;
use crate::message::{Status, ToWorkbench};
use crate::text::Language;

/// The card with all measurements of the device, the primary one largest.
pub(super) fn figures(app: &'static App, units: Units) -> El {
    let device = app.settings.device();
    let reset = icon_button(app, "quiet small", "reset-statistics", Icon::Reset, Language::reset_statistics)
        .live_attr("title", move || Some(app.language.get().statistics_since().to_owned()))
        .click(move || app.reset_statistics());
    let header = el("header")
        .child(el("h2").live_text(move || device.name(app.language.get()).to_owned()))
        .child(el("span").class("muted").live_text(move || {
            let unit = app.connection.with(|used| used.as_ref().map(|used| used.unit.0));
            unit.map(|unit| app.language.get().unit_id(unit)).unwrap_or_default()
        }))
        .child(el("span").class("muted").test("live-note").live_text(move || {
            let language = app.language.get();
            match (app.is_replay(), app.polling.get()) {
                (true, _) => language.a_replay(),
                (false, false) => language.polling_paused(),
                _ => "",
            }
            .to_owned()
        }))
        .child(loader::place(app, || ToWorkbench::Marks, ToWorkbench::Marks))
        .child(el("span").class("space"))
        .child(reset);
    let all = device.measurements().into_iter().map(|point| figure(app, units, point));
    el("section").class("card figures").child(header).child(el("div").class("figure-row").children(all))
}

fn figure(app: &'static App, units: Units, point: &'static Point) -> El {
    let stale = move || app.phase.get() != Phase::Reading;
    let device = app.settings.device();
    let own = move |status: &Status| {
        let value = device::reading(status, &point.id);
        value.map_or_else(|| "\u{2013}".to_owned(), |value| device::value_text(app.language.get(), point, value))
    };
    let value = el("span").class("value").test("value").live_text(move || {
        app.status.with(|status| {
            let converted = || units.conversion(status, point)?.text(device::reading(status, &point.id)?);
            converted().unwrap_or_else(|| own(status))
        })
    });
    let unit = el("span").class("unit").test("unit").live_text(move || {
        let language = app.language.get();
        app.status.with(|status| units.unit(language, status, point))
    });
    let reading = el("p").class("reading").child(value).child(unit).child(units.choice(app, point));
    let beyond = Memo::new(move |_| app.status.with(|status| beyond(device, status, point)));
    let limit = el("p").class("beyond").test("beyond").attr("role", "status").live_text(move || {
        let language = app.language.get();
        app.status.with(|status| {
            let text = |limit| {
                let converted = units.conversion(status, point).and_then(|conversion| conversion.text(limit));
                let value = converted.unwrap_or_else(|| device::value_text(language, point, limit));
                [&value, " ", &units.unit(language, status, point)].concat()
            };
            match beyond.get() {
                Some(Beyond::Below(least)) => language.below_range(&text(least)),
                Some(Beyond::Above(most)) => language.above_range(&text(most)),
                None => String::new(),
            }
        })
    });
    // What the device itself said, where something else is shown.
    let converted = el("p").class("converted").test("converted").live_text(move || {
        let language = app.language.get();
        app.status.with(|status| {
            let from = |_| language.converted_from(&own(status), &device.unit(language, status, point));
            units.conversion(status, point).map(from).unwrap_or_default()
        })
    });
    let age = el("p").class("age").live_text(move || if stale() { age_text(app, point) } else { String::new() });
    let statistic = |label, pick| statistic(app, units, point, label, pick);
    let statistics = el("dl")
        .class("statistics")
        .child(statistic(Language::minimum, |statistics| statistics.min))
        .child(statistic(Language::maximum, |statistics| statistics.max))
        .child(statistic(Language::mean, |statistics| statistics.mean));
    el("div")
        .class(if point.primary { "figure primary" } else { "figure" })
        .test(&["point-", &point.id].concat())
        .state("data-stale", stale)
        .state("data-beyond", move || beyond.get().is_some())
        .child(el("h3").live_text(move || device::pick(app.language.get(), &point.name).to_owned()))
        .child(reading)
        .child(limit)
        .child(converted)
        .child(age)
        .child(statistics)
}

/// On which side of its range a point's last value lies.
fn beyond(device: &Device, status: &Status, point: &Point) -> Option<Beyond> {
    let reading = |id: &str| device::reading(status, id);
    device.profile().beyond(point, reading(&point.id)?, reading)
}

fn statistic(
    app: &'static App,
    units: Units,
    point: &'static Point,
    label: fn(Language) -> &'static str,
    pick: fn(&Statistics) -> f64,
) -> El {
    let text = move || {
        app.history_turn.track();
        let statistics = app.history.with_value(|history| history.of(&point.id)?.statistics());
        let (decimals, conversion) = app.status.with_untracked(|status| {
            let decimals = device::reading(status, &point.id).map_or(0, device::decimals);
            (decimals, units.conversion(status, point))
        });
        statistics.map_or_else(
            || "\u{2013}".to_owned(),
            |statistics| match conversion {
                Some(conversion) => fixed(conversion.of(pick(&statistics)), conversion.decimals(decimals)),
                None => fixed(pick(&statistics), decimals),
            },
        )
    };
    el("div").child(el("dt").say(app, label)).child(el("dd").live_text(text))
}

/// How old the last reading is. Follows the clock.
fn age_text(app: &'static App, point: &'static Point) -> String {
    app.clock_turn.track();
    let language = app.language.get();
    let last = app.history.with_value(|history| history.of(&point.id)?.last_s());
    match app.engine_seconds().zip(last) {
        None => language.no_reading_yet().to_owned(),
        Some((now, last)) => {
            // Never negative, and a page does not live for a century.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let seconds = (now - last).max(0.0) as u32;
            if seconds < 120 { language.old_reading(seconds) } else { language.old_reading_minutes(seconds / 60) }
        }
    }
}
