//! The rail with the pages and the top bar that always tells port, settings, state and round trip.

use buslens_codec::line::Mode;
use leptos::prelude::*;

use super::icon::{Icon, icon};
use crate::app::{App, Phase};
use crate::format;
use crate::link;
use crate::message::{Connection, Source, ToEngine};
use crate::ports;
use crate::route::Route;
use crate::text::Language;
use crate::theme::Theme;

/// The pages. A bar at the bottom of a narrow screen.
pub(crate) fn rail(app: &'static App) -> AnyView {
    let live = Memo::new(move |_| app.route.with(|route| matches!(route, Route::Live)));
    let rate = Memo::new(move |_| {
        let reading = app.phase.get() == Phase::Reading;
        app.status.with(|status| status.rate_hz.filter(|_| reading).map(|rate| format::rate(whole_above_ten(rate))))
    });
    view! {
        <nav class="rail" aria-label=app.text(Language::pages)>
            <div class="brand">
                <svg class="brand-mark" viewBox="0 0 20 20" aria-hidden="true">
                    <circle cx="9" cy="9" r="6.5" />
                    <path d="M13.8 13.8 18 18M5 9h2l1.2-2.6L10 11.6 11.2 9H13" />
                </svg>
                <span>{app.text(Language::brand)}</span>
            </div>
            <a class="nav" href="#/live" data-test="nav-live" aria-current=move || live.get().then_some("page")>
                {icon(Icon::Live)} <span>{app.text(Language::live)}</span>
                <small>{move || rate.get().map(|rate| [&rate, "/s"].concat())}</small>
            </a>
            <a class="nav" href="#/decoder" data-test="nav-decoder" aria-current=move || (!live.get()).then_some("page")>
                {icon(Icon::Decoder)} <span>{app.text(Language::decoder)}</span>
            </a>
            <small class="version">{env!("CARGO_PKG_VERSION")}</small>
        </nav>
    }
    .into_any()
}

/// The bar at the top of every page.
pub(crate) fn top_bar(app: &'static App) -> AnyView {
    let connected = Memo::new(move |_| app.phase.get().is_connected());
    let round_trip = Memo::new(move |_| {
        let reading = app.phase.get() == Phase::Reading;
        app.status.with(|status| status.round_trip_us.filter(|_| reading).map(format::milliseconds))
    });
    view! {
        <header class="top">
            <div class="chip">
                <span class="state" data-test="state" data-state=move || app.phase.get().name() aria-live="polite">
                    <i class="dot" data-state=move || app.phase.get().name()></i>
                    <span class="state-text">{move || app.phase.get().title(app.language.get())}</span>
                </span>
                <b class="port-name">{move || port_name(app)}</b>
                <span class="line-text">{move || line_text(app)}</span>
            </div>
            <span class="chip round-trip" class:hidden=move || round_trip.with(Option::is_none)>
                <span>{app.text(Language::round_trip)}</span>
                <b data-test="round-trip">{move || round_trip.get()}</b>
            </span>
            <span class="space"></span>
            {switches(app)}
            <Show when=move || connected.get()>
                <button
                    type="button"
                    class="button"
                    data-test="disconnect"
                    disabled=move || app.phase.get() == Phase::Closing
                    on:click=move |_| link::send(&ToEngine::Disconnect)
                >
                    {app.text(Language::disconnect)}
                </button>
            </Show>
        </header>
    }
    .into_any()
}

fn switches(app: &'static App) -> AnyView {
    let theme_text = move || match app.theme.get() {
        Theme::Auto => app.language.get().theme_auto(),
        Theme::Light => app.language.get().theme_light(),
        Theme::Dark => app.language.get().theme_dark(),
    };
    view! {
        <button
            type="button"
            class="button quiet square"
            data-test="theme"
            aria-label=theme_text
            title=theme_text
            on:click=move |_| app.theme.update(|theme| *theme = theme.next())
        >
            {move || {
                icon(
                    match app.theme.get() {
                        Theme::Auto => Icon::ThemeAuto,
                        Theme::Light => Icon::ThemeLight,
                        Theme::Dark => Icon::ThemeDark,
                    },
                )
            }}
        </button>
        <button
            type="button"
            class="button quiet language"
            data-test="language"
            lang=move || app.language.get().other().tag()
            aria-label=app.text(Language::switch_language_label)
            on:click=move |_| app.language.update(|language| *language = language.other())
        >
            {app.text(Language::switch_language)}
        </button>
    }
    .into_any()
}

/// The port in use, else the one that would be used.
pub(crate) fn port_name(app: &'static App) -> String {
    let language = app.language.get();
    let ports = app.ports.get();
    let used = app.connection.with(|connection| connection.as_ref().map(|connection| connection.source));
    match used.filter(|_| app.phase.get().is_connected()) {
        Some(Source::Simulator) => language.simulator().to_owned(),
        Some(Source::Serial(port)) => ports::title(language, &ports, port),
        None => {
            let chosen = app.settings.port.with(|wanted| ports::find(&ports, wanted));
            chosen.map_or_else(|| language.no_port().to_owned(), |port| ports::title(language, &ports, port))
        }
    }
}

/// The settings in use, else those that would be used.
fn line_text(app: &'static App) -> String {
    let language = app.language.get();
    let used = app.connection.get().filter(|_| app.phase.get().is_connected());
    let shown = used.or_else(|| app.settings.connection(Source::Simulator));
    shown.map(|connection| connection_text(language, &connection)).unwrap_or_default()
}

/// `9600 8E1 · RTU · unit 12`.
fn connection_text(language: Language, connection: &Connection) -> String {
    let mode = mode_name(connection.mode);
    [&settings_text(connection), " · ", mode, " · ", &language.unit_id(connection.unit.0)].concat()
}

/// `9600 8E1`.
pub(crate) fn settings_text(connection: &Connection) -> String {
    connection.line.to_string()
}

/// The name of a transmission mode, the same in all languages.
pub(crate) fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Rtu => "RTU",
        Mode::Ascii => "ASCII",
    }
}

/// The rail has room for whole numbers only, once they are large.
fn whole_above_ten(rate: f32) -> f64 {
    let rate = f64::from(rate);
    if rate < 10.0 { rate } else { rate.round() }
}
