//! The last minute as a moving curve. Drawn anew at each tick of the page's clock, never oftener.

use crate::reactive::prelude::*;
use buslens_codec::profile::Point;

use super::units::{Conversion, Units};
use crate::app::App;
use crate::device;
use crate::dom::{El, el, svg};
use crate::history::{SPAN_S, Series};
use crate::text::Language;
use crate::trend::{self, Frame, Scale, pixel};

/// Room for the labels of the vertical scale.
const LEFT: f64 = 64.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 14.0;
/// Room for the labels of the time.
const BOTTOM: f64 = 26.0;

/// What the strip shows at one moment.
struct Picture {
    view_box: String,
    /// Height and label of each line of the scale.
    lines: Vec<(f64, String)>,
    /// Place and age of each mark of the time.
    marks: Vec<(f64, u32)>,
    right: f64,
    bottom: f64,
    curve: String,
}

/// The card with the curve of one point.
pub(super) fn trend_strip(app: &'static App, units: Units) -> El {
    let points = app.settings.device().measurements();
    let chosen = RwSignal::new(0_usize);
    let names = points.iter().copied().enumerate().map(|(at, point)| {
        el("button")
            .attr("type", "button")
            .state("aria-pressed", move || chosen.get() == at)
            .live_text(move || device::pick(app.language.get(), &point.name).to_owned())
            .click(move || chosen.set(at))
    });
    let tabs = el("div").class(if points.len() < 2 { "tabs hidden" } else { "tabs" }).children(names);
    let point = move || points.get(chosen.get()).copied();
    let unit = point.clone();
    let header = el("header")
        .child(el("h2").say(app, Language::last_minute))
        .child(el("span").class("muted").live_text(move || {
            let language = app.language.get();
            let text = |point: &Point| app.status.with(|status| units.unit(language, status, point));
            unit().map(text).unwrap_or_default()
        }))
        .child(el("span").class("space"))
        .child(tabs);
    // The size is known only once the strip is on the page.
    let size = RwSignal::new((0.0, 0.0));
    let strip = el("div")
        .class("strip")
        .live_one(move || {
            app.clock_turn.track();
            let language = app.language.get();
            let drawn = point().and_then(|point| Some((point, picture(app, units, point, size.get_untracked())?)));
            Some(match drawn {
                Some((point, picture)) => curve(language, picture, device::pick(language, &point.name)),
                None => el("p").class("empty").text(language.trend_waiting()),
            })
        })
        .live_size(move |width, height| {
            app.clock_turn.track();
            size.set((width, height));
        });
    el("section").class("card trend").child(header).child(strip)
}

fn picture(app: &'static App, units: Units, point: &Point, size: (f64, f64)) -> Option<Picture> {
    let gap_s = app.connection.with(|used| used.as_ref().map_or(1.0, |used| f64::from(used.period_ms) * 0.003));
    let (decimals, conversion) = app.status.with_untracked(|status| {
        let decimals = device::reading(status, &point.id).map_or(0, device::decimals);
        (decimals, units.conversion(status, point))
    });
    let decimals = conversion.map_or(decimals, |conversion| conversion.decimals(decimals));
    let strip = Strip { size, now_s: app.engine_seconds()?, gap_s: gap_s.max(1.0), decimals, conversion };
    app.history.with_value(|history| Some(draw(history.of(&point.id)?, &strip)))
}

/// What the picture depends on besides the samples.
struct Strip {
    /// Width and height in pixels.
    size: (f64, f64),
    now_s: f64,
    gap_s: f64,
    /// Decimals of the values shown.
    decimals: u8,
    conversion: Option<Conversion>,
}

fn draw(series: &Series, strip: &Strip) -> Picture {
    let Strip { size: (width, height), now_s, gap_s, decimals, conversion } = *strip;
    let converted = |(at_s, value)| (at_s, conversion.map_or(value, |conversion| conversion.of(value)));
    let shown = || series.recent().filter(|(at_s, _)| now_s - at_s <= SPAN_S).map(converted);
    let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
    for (_, value) in shown() {
        (min, max) = (min.min(value), max.max(value));
    }
    if min > max {
        (min, max) = (0.0, 0.0);
    }
    let frame = Frame {
        left: LEFT,
        top: TOP,
        width: (width - LEFT - RIGHT).max(1.0),
        height: (height - TOP - BOTTOM).max(1.0),
        now_s,
        span_s: SPAN_S,
        gap_s,
    };
    let scale = Scale::around(min, max, decimals);
    let lines = scale.lines().map(|(value, label)| (TOP + frame.height * (1.0 - scale.height(value)), label)).collect();
    let marks = [60, 45, 30, 15, 0].map(|age| (LEFT + frame.width * (1.0 - f64::from(age) / SPAN_S), age)).into();
    Picture {
        view_box: ["0 0 ", &pixel(width), " ", &pixel(height)].concat(),
        lines,
        marks,
        right: width - RIGHT,
        bottom: TOP + frame.height,
        curve: trend::path(shown(), &frame, &scale),
    }
}

fn curve(language: Language, picture: Picture, name: &str) -> El {
    let right = pixel(picture.right);
    let lines = picture.lines.into_iter().flat_map(|(y, label)| {
        // On a whole pixel and a half the line is one pixel thin.
        let line = ["M", &pixel(LEFT), " ", &pixel(y.floor() + 0.5), "H", &right].concat();
        [svg("path").class("grid").attr("d", &line), label_at(LEFT - 10.0, y + 4.0, "end", &label)]
    });
    let bottom = picture.bottom;
    let marks = picture.marks.into_iter().flat_map(|(x, age)| {
        let line = ["M", &pixel(x.floor() + 0.5), " ", &pixel(bottom), "v5"].concat();
        let (anchor, text) = match age {
            0 => ("end", language.trend_now().to_owned()),
            _ => ("middle", language.trend_seconds(age)),
        };
        [svg("path").class("grid").attr("d", &line), label_at(x, bottom + 19.0, anchor, &text)]
    });
    svg("svg")
        .class("plot")
        .attr("viewBox", &picture.view_box)
        .attr("role", "img")
        .attr("aria-label", &language.trend_label(name))
        .children(lines)
        .children(marks)
        .child(svg("path").class("curve").attr("d", &picture.curve))
}

fn label_at(x: f64, y: f64, anchor: &str, text: &str) -> El {
    let label = svg("text").class("scale").attr("x", &pixel(x)).attr("y", &pixel(y));
    label.attr("text-anchor", anchor).text(text)
}
