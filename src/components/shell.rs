//! The rail with the pages and the top bar that always tells port, settings, state and round trip.

use crate::reactive::prelude::*;
use buslens_codec::line::Mode;

use super::button::{bare, button, icon_button};
use super::icon::{Icon, icon};
use crate::app::{App, Phase};
use crate::dom::{El, el, svg};
use crate::format;
use crate::link;
use crate::message::{Connection, Source, ToEngine};
use crate::ports;
use crate::route::Page;
use crate::text::Language;
use crate::theme::Theme;

/// The pages. A bar at the bottom of a narrow screen.
pub(crate) fn rail(app: &'static App) -> El {
    let live = move || app.page.get() == Page::Live;
    let console = move || app.page.get() == Page::Console;
    let decoder = move || app.page.get() == Page::Decoder;
    let configure = move || app.page.get() == Page::Configure;
    let fleet = move || app.page.get() == Page::Fleet;
    let builder = move || app.page.get() == Page::Builder;
    let profiles = move || app.page.get() == Page::Profiles;
    let mark = svg("svg").class("brand-mark").attr("viewBox", "0 0 20 20").attr("aria-hidden", "true");
    let mark = mark
        .child(svg("circle").attr("cx", "9").attr("cy", "9").attr("r", "6.5"))
        .child(svg("path").attr("d", "M13.8 13.8 18 18M5 9h2l1.2-2.6L10 11.6 11.2 9H13"));
    let rate = el("small").live_text(move || {
        let reading = app.phase.get() == Phase::Reading;
        let rate = app.status.with(|status| status.rate_hz.filter(|_| reading));
        rate.map(|rate| [&format::rate(whole_above_ten(rate)), "/s"].concat()).unwrap_or_default()
    });
    el("nav")
        .class("rail")
        .label(app, Language::pages)
        .child(el("div").class("brand").child(mark).child(el("span").text("Buslens")))
        .child(page_link(app, "#/live", "nav-live", Icon::Live, Language::live, live).child(rate))
        .child(page_link(app, "#/configure", "nav-configure", Icon::Configure, Language::configure, configure))
        .child(page_link(app, "#/fleet", "nav-fleet", Icon::Fleet, Language::fleet, fleet))
        .child(page_link(app, "#/console", "nav-console", Icon::Console, Language::console, console))
        .child(page_link(app, "#/decoder", "nav-decoder", Icon::Decoder, Language::decoder, decoder))
        .child(page_link(app, "#/builder", "nav-builder", Icon::Builder, Language::builder, builder))
        .child(page_link(app, "#/profiles", "nav-profiles", Icon::Profiles, Language::profiles, profiles))
        .child(el("small").class("version").text(env!("CARGO_PKG_VERSION")))
}

fn page_link(
    app: &'static App,
    address: &str,
    hook: &str,
    mark: Icon,
    text: fn(Language) -> &'static str,
    is_current: impl Fn() -> bool + 'static,
) -> El {
    el("a")
        .class("nav")
        .attr("href", address)
        .test(hook)
        .live_attr("aria-current", move || is_current().then(|| "page".to_owned()))
        .child(icon(mark))
        .child(el("span").say(app, text))
}

/// The bar at the top of every page.
pub(crate) fn top_bar(app: &'static App) -> El {
    let phase_name = move || Some(app.phase.get().name().to_owned());
    let state = el("span")
        .class("state")
        .test("state")
        .attr("aria-live", "polite")
        .live_attr("data-state", phase_name)
        .child(el("i").class("dot").live_attr("data-state", phase_name))
        .child(el("span").class("state-text").live_text(|| app.phase_title()));
    let round_trip = move || {
        let reading = app.phase.get() == Phase::Reading;
        app.status.with(|status| status.round_trip_us.filter(|_| reading))
    };
    let chip = el("div")
        .class("chip")
        .child(state)
        .child(el("b").class("port-name").live_text(move || port_name(app)))
        .child(el("span").class("line-text").live_text(move || line_text(app)));
    let trip = el("span")
        .class("chip round-trip")
        .live_class("hidden", move || round_trip().is_none())
        .child(el("span").say(app, Language::round_trip))
        .child(
            el("b").test("round-trip").live_text(move || round_trip().map(format::milliseconds).unwrap_or_default()),
        );
    let connected = Memo::new(move |_| app.phase.get().is_connected());
    el("header")
        .class("top")
        .child(chip)
        .child(trip)
        .child(el("span").class("space"))
        .child(read_only_switch(app))
        .child(
            bare("quiet square", "help")
                .label(app, Language::device_help)
                .child(icon(Icon::Help))
                .click(|| app.help.update(|turn| *turn += 1)),
        )
        .child(theme_switch(app))
        .child(language_switch(app))
        .live_one(move || {
            connected.get().then(|| {
                button(app, "", "disconnect", Language::disconnect)
                    .flag("disabled", move || app.phase.get() == Phase::Closing)
                    .click(|| link::send(&ToEngine::Disconnect))
            })
        })
}

/// On every page: whoever wants something written, nothing is while it is on.
fn read_only_switch(app: &'static App) -> El {
    icon_button(app, "quiet read-only", "read-only", Icon::Lock, Language::read_only)
        .label(app, Language::read_only)
        .attr("role", "switch")
        .state("aria-checked", move || app.read_only.get())
        .live_attr("title", move || Some(app.language.get().read_only_hint().to_owned()))
        .click(move || link::send(&ToEngine::ReadOnly(!app.read_only.get_untracked())))
}

fn theme_switch(app: &'static App) -> El {
    let text = move || {
        let language = app.language.get();
        Some(
            match app.theme.get() {
                Theme::Auto => language.theme_auto(),
                Theme::Light => language.theme_light(),
                Theme::Dark => language.theme_dark(),
            }
            .to_owned(),
        )
    };
    bare("quiet square", "theme")
        .live_attr("aria-label", text)
        .live_attr("title", text)
        .click(move || app.theme.update(|theme| *theme = theme.next()))
        .live_one(move || {
            Some(icon(match app.theme.get() {
                Theme::Auto => Icon::ThemeAuto,
                Theme::Light => Icon::ThemeLight,
                Theme::Dark => Icon::ThemeDark,
            }))
        })
}

fn language_switch(app: &'static App) -> El {
    button(app, "quiet language", "language", Language::switch_language)
        .label(app, Language::switch_language_label)
        .live_attr("lang", move || Some(app.language.get().other().tag().to_owned()))
        .click(move || app.language.update(|language| *language = language.other()))
}

/// The port in use, else the one that would be used.
pub(crate) fn port_name(app: &'static App) -> String {
    let language = app.language.get();
    let ports = app.ports.get();
    let used = app.connection.with(|connection| connection.as_ref().map(|connection| connection.source));
    match used.filter(|_| app.phase.get().is_connected()) {
        Some(Source::Simulator) => language.simulator().to_owned(),
        Some(Source::Replay) => language.replay_source().to_owned(),
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
