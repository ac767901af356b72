//! The readings: large figures with unit and statistics. Old ones are dimmed and say how old they are.

use buslens_codec::profile::Point;
use leptos::prelude::*;

use crate::app::{App, Phase};
use crate::components::icon::{Icon, icon};
use crate::device;
use crate::format::fixed;
use crate::history::Statistics;
use crate::text::Language;

/// The card with all measurements of the device, the primary one largest.
pub(super) fn figures(app: &'static App) -> AnyView {
    let device = app.settings.device();
    let figures: Vec<_> = device.measurements().into_iter().map(|point| figure(app, point)).collect();
    view! {
        <section class="card figures" data-stale=move || (app.phase.get() != Phase::Reading).to_string()>
            <header>
                <h2>{move || device.name(app.language.get())}</h2>
                <span class="muted">{move || unit_text(app)}</span>
                <span class="space"></span>
                <button
                    type="button"
                    class="button quiet small"
                    data-test="reset-statistics"
                    title=app.text(Language::statistics_since)
                    on:click=move |_| app.reset_statistics()
                >
                    {icon(Icon::Reset)}
                    {app.text(Language::reset_statistics)}
                </button>
            </header>
            <div class="figure-row">{figures}</div>
        </section>
    }
    .into_any()
}

fn unit_text(app: &'static App) -> Option<String> {
    app.connection.with(|connection| connection.as_ref().map(|used| app.language.get().unit_id(used.unit.0)))
}

fn figure(app: &'static App, point: &'static Point) -> AnyView {
    let value = Memo::new(move |_| {
        app.status.with(|status| {
            let reading = status.readings.iter().find(|reading| reading.point == point.id)?;
            Some((device::value_text(app.language.get(), point, reading.value), device::decimals(reading.value)))
        })
    });
    let stale = Memo::new(move |_| app.phase.get() != Phase::Reading);
    let statistics = Memo::new(move |_| {
        app.history_turn.track();
        app.history.with_value(|history| history.of(&point.id)?.statistics())
    });
    let decimals = Memo::new(move |_| value.with(|value| value.as_ref().map_or(0, |(_, decimals)| *decimals)));
    let statistic = move |label: fn(Language) -> &'static str, pick: fn(&Statistics) -> f64| {
        view! {
            <div>
                <dt>{app.text(label)}</dt>
                <dd>
                    {move || {
                        let shown = statistics.get().map(|statistics| fixed(pick(&statistics), decimals.get()));
                        shown.unwrap_or_else(|| "\u{2013}".to_owned())
                    }}
                </dd>
            </div>
        }
    };
    view! {
        <div
            class="figure"
            class:primary=point.primary
            data-test=["point-", &point.id].concat()
            data-stale=move || stale.get().to_string()
        >
            <h3>{move || device::pick(app.language.get(), &point.name).to_owned()}</h3>
            <p class="reading">
                <span class="value" data-test="value">
                    {move || value.get().map_or_else(|| "\u{2013}".to_owned(), |(text, _)| text)}
                </span>
                <span class="unit" data-test="unit">{point.unit.clone()}</span>
            </p>
            <p class="age">{move || if stale.get() { age_text(app, point) } else { String::new() }}</p>
            <dl class="statistics">
                {statistic(Language::minimum, |statistics| statistics.min)}
                {statistic(Language::maximum, |statistics| statistics.max)}
                {statistic(Language::mean, |statistics| statistics.mean)}
            </dl>
        </div>
    }
    .into_any()
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
