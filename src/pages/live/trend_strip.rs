//! The last minute as a moving curve. Drawn anew at each tick of the page's clock, never oftener.

use leptos::html::Div;
use leptos::prelude::*;

use crate::app::App;
use crate::device;
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
#[derive(Clone, Default, PartialEq)]
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
pub(super) fn trend_strip(app: &'static App) -> AnyView {
    let points = app.settings.device().measurements();
    let chosen = RwSignal::new(0_usize);
    let area = NodeRef::<Div>::new();
    let point = {
        let points = points.clone();
        move || points.get(chosen.get()).copied()
    };
    let drawn = point.clone();
    let picture = Memo::new(move |_| {
        app.clock_turn.track();
        let area = area.get()?;
        let size = (f64::from(area.client_width()), f64::from(area.client_height()));
        let point = drawn()?;
        let gap_s = app.connection.with(|used| used.as_ref().map_or(1.0, |used| f64::from(used.period_ms) * 0.003));
        let now_s = app.engine_seconds()?;
        let decimals = app.status.with_untracked(|status| {
            let reading = status.readings.iter().find(|reading| reading.point == point.id);
            reading.map_or(0, |reading| device::decimals(reading.value))
        });
        let strip = Strip { size, now_s, gap_s: gap_s.max(1.0), decimals };
        app.history.with_value(|history| Some(draw(history.of(&point.id)?, &strip)))
    });
    let named = point.clone();
    let label = move || {
        let language = app.language.get();
        language.trend_label(named().map_or("", |point| device::pick(language, &point.name)))
    };
    let tabs: Vec<_> = points
        .iter()
        .copied()
        .enumerate()
        .map(|(at, point)| {
            view! {
                <button type="button" aria-pressed=move || (chosen.get() == at).to_string() on:click=move |_| chosen.set(at)>
                    {move || device::pick(app.language.get(), &point.name).to_owned()}
                </button>
            }
        })
        .collect();
    view! {
        <section class="card trend">
            <header>
                <h2>{app.text(Language::last_minute)}</h2>
                <span class="muted">{move || point().map(|point| point.unit.clone())}</span>
                <span class="space"></span>
                <div class="tabs" class:hidden=points.len() < 2>{tabs}</div>
            </header>
            <div class="strip" node_ref=area>
                {move || match picture.get() {
                    Some(picture) => curve(app.language.get(), picture, label()),
                    None => view! { <p class="empty">{app.text(Language::trend_waiting)}</p> }.into_any(),
                }}
            </div>
        </section>
    }
    .into_any()
}

/// What the picture depends on besides the samples.
struct Strip {
    /// Width and height in pixels.
    size: (f64, f64),
    now_s: f64,
    gap_s: f64,
    /// Decimals of the point's values.
    decimals: u8,
}

fn draw(series: &Series, strip: &Strip) -> Picture {
    let Strip { size: (width, height), now_s, gap_s, decimals } = *strip;
    let shown = || series.recent().filter(|(at_s, _)| now_s - at_s <= SPAN_S);
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

fn curve(language: Language, picture: Picture, label: String) -> AnyView {
    let right = pixel(picture.right);
    let lines: Vec<_> = picture
        .lines
        .into_iter()
        .map(|(y, label)| {
            // On a whole pixel and a half the line is one pixel thin.
            let line = ["M", &pixel(LEFT), " ", &pixel(y.floor() + 0.5), "H", &right].concat();
            view! {
                <path class="grid" d=line />
                <text class="scale" x=pixel(LEFT - 10.0) y=pixel(y + 4.0) text-anchor="end">
                    {label}
                </text>
            }
        })
        .collect();
    let marks: Vec<_> = picture
        .marks
        .into_iter()
        .map(|(x, age)| {
            let line = ["M", &pixel(x.floor() + 0.5), " ", &pixel(picture.bottom), "v5"].concat();
            let anchor = if age == 0 { "end" } else { "middle" };
            let text = if age == 0 { language.trend_now().to_owned() } else { language.trend_seconds(age) };
            view! {
                <path class="grid" d=line />
                <text class="scale" x=pixel(x) y=pixel(picture.bottom + 19.0) text-anchor=anchor>
                    {text}
                </text>
            }
        })
        .collect();
    view! {
        <svg class="plot" viewBox=picture.view_box role="img" aria-label=label>
            {lines}
            {marks}
            <path class="curve" d=picture.curve />
        </svg>
    }
    .into_any()
}
