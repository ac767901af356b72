//! The connection in numbers.

use leptos::prelude::*;

use crate::app::{App, Phase};
use crate::format;
use crate::text::Language;
use buslens_bus::Counters;

/// The card with state, counts, rate and round trip.
pub(super) fn counts(app: &'static App) -> AnyView {
    let counters = Memo::new(move |_| app.status.with(|status| status.counters));
    let row = move |label: fn(Language) -> &'static str, test: &'static str, bad: bool, pick: fn(&Counters) -> u64| {
        let value = Memo::new(move |_| counters.with(pick));
        view! {
            <div class:notable=move || { bad && value.get() > 0 }>
                <dt>{app.text(label)}</dt>
                <dd data-test=test>{move || format::count(value.get())}</dd>
            </div>
        }
        .into_any()
    };
    view! {
        <section class="card counts">
            <header>
                <h2>{app.text(Language::connection)}</h2>
                <span class="space"></span>
                <span class="tag" data-state=move || app.phase.get().name()>
                    {move || app.phase.get().title(app.language.get())}
                </span>
            </header>
            <dl>
                {row(Language::replies, "count-replies", false, |counters| counters.replies)}
                {row(Language::no_answers, "count-no-answers", true, |counters| counters.no_answers)}
                {row(Language::bad_checks, "count-bad-checks", true, |counters| counters.bad_checks)}
                {row(Language::exceptions, "count-exceptions", true, |counters| counters.exceptions)}
                {row(Language::late_replies, "count-late", true, |counters| counters.late_replies)}
                {row(Language::noise_bytes, "count-noise", true, |counters| counters.noise_bytes)}
                {row(Language::line_errors, "count-line-errors", true, |counters| counters.line_errors)}
                <div>
                    <dt>{app.text(Language::rate)}</dt>
                    <dd data-test="rate">{move || rate_text(app)}</dd>
                </div>
                <div>
                    <dt>{app.text(Language::round_trip_time)}</dt>
                    <dd>
                        {move || {
                            let known = app.status.with(|status| status.round_trip_us);
                            known.map_or_else(|| "\u{2013}".to_owned(), format::milliseconds)
                        }}
                    </dd>
                </div>
            </dl>
        </section>
    }
    .into_any()
}

/// `10 / 9.8 Hz`; a dash for a rate that is not known now.
fn rate_text(app: &'static App) -> String {
    let wanted = app.connection.with(|used| used.as_ref().map(|used| 1000.0 / f64::from(used.period_ms.max(1))));
    let reading = app.phase.get() == Phase::Reading;
    let got = app.status.with(|status| status.rate_hz).filter(|_| reading).map(f64::from);
    let text = |rate: Option<f64>| rate.map_or_else(|| "\u{2013}".to_owned(), format::rate);
    [&text(wanted), " / ", &text(got), " Hz"].concat()
}
