//! The connection in numbers.

use crate::reactive::prelude::*;
use buslens_bus::Counters;

use crate::app::{App, Phase};
use crate::dom::{El, el};
use crate::format;
use crate::text::Language;

/// A text of the page, the name for the tests, the count; all but the first are trouble.
type Row = (fn(Language) -> &'static str, &'static str, fn(&Counters) -> u64);

const ROWS: [Row; 7] = [
    (Language::replies, "count-replies", |counters| counters.replies),
    (Language::no_answers, "count-no-answers", |counters| counters.no_answers),
    (Language::bad_checks, "count-bad-checks", |counters| counters.bad_checks),
    (Language::exceptions, "count-exceptions", |counters| counters.exceptions),
    (Language::late_replies, "count-late", |counters| counters.late_replies),
    (Language::noise_bytes, "count-noise", |counters| counters.noise_bytes),
    (Language::line_errors, "count-line-errors", |counters| counters.line_errors),
];

/// The card with state, counts, rate and round trip.
pub(super) fn counts(app: &'static App) -> El {
    let phase = el("span")
        .class("tag")
        .live_attr("data-state", || Some(app.phase.get().name().to_owned()))
        .live_text(|| app.phase_title());
    let header =
        el("header").child(el("h2").say(app, Language::connection)).child(el("span").class("space")).child(phase);
    let counted = ROWS.iter().enumerate().map(|(at, &(label, test, count))| {
        let count = move || app.status.with(|status| count(&status.counters));
        el("div")
            .live_class("notable", move || at > 0 && count() > 0)
            .child(el("dt").say(app, label))
            .child(el("dd").test(test).live_text(move || format::count(count())))
    });
    let rate = el("div")
        .child(el("dt").say(app, Language::rate))
        .child(el("dd").test("rate").live_text(move || rate_text(app)));
    let trip = el("div").child(el("dt").say(app, Language::round_trip_time)).child(el("dd").live_text(move || {
        let known = app.status.with(|status| status.round_trip_us);
        known.map_or_else(|| "\u{2013}".to_owned(), format::milliseconds)
    }));
    el("section").class("card counts").child(header).child(el("dl").children(counted).child(rate).child(trip))
}

/// `10 / 9.8 Hz`; a dash for a rate that is not known now.
fn rate_text(app: &'static App) -> String {
    let wanted = app.connection.with(|used| used.as_ref().map(|used| 1000.0 / f64::from(used.period_ms.max(1))));
    let wanted = wanted.filter(|_| app.polling.get());
    let reading = app.phase.get() == Phase::Reading;
    let got = app.status.with(|status| status.rate_hz).filter(|_| reading).map(f64::from);
    let text = |rate: Option<f64>| rate.map_or_else(|| "\u{2013}".to_owned(), format::rate);
    [&text(wanted), " / ", &text(got), " Hz"].concat()
}
