//! Not connected: the card with the settings and one obvious next action, and beside it how the device is wired.

use crate::reactive::prelude::*;
use buslens_codec::line::{DataBits, Mode, StopBits};
use wasm_bindgen_futures::spawn_local;

use super::wiring::wiring;
use crate::app::{App, Phase};
use crate::components::button::{bare, button, icon_button};
use crate::components::field::{Note, choice, field, number};
use crate::components::icon::{Icon, icon};
use crate::device;
use crate::dom::{self, El, el};
use crate::format;
use crate::link;
use crate::message::{PortId, Source, ToEngine};
use crate::ports;
use crate::serial;
use crate::settings::{BAUDS, FREE, Settings, parity_name};
use crate::text::Language;

/// The card and the wiring beside it.
pub(super) fn connect(app: &'static App) -> El {
    el("div").class("connect").child(card(app)).child(wiring(app))
}

fn card(app: &'static App) -> El {
    let settings = &app.settings;
    let factory = Memo::new(move |_| settings.is_factory());
    let header = el("header")
        .child(el("h2").say(app, Language::connect_title))
        .child(el("span").class("space"))
        .live_one(move || {
            let reset = || icon_button(app, "quiet small", "reset-settings", Icon::Reset, Language::reset_to_defaults);
            (!factory.get()).then(|| reset().click(move || settings.reset()))
        });
    let fieldset = el("fieldset")
        .flag("disabled", move || is_opening(app))
        .child(port_field(app))
        .child(el("div").class("fields").children(fields(app)));
    el("form")
        .class("card connect-card")
        .on("submit", move |event| {
            event.prevent_default();
            let connection = chosen_port(app).and_then(|port| settings.connection(Source::Serial(port)));
            if let Some(connection) = connection {
                app.connect(connection);
            }
        })
        .child(header)
        .child(fieldset)
        .child(actions(app))
}

fn actions(app: &'static App) -> El {
    let connect = bare("large", "connect")
        .attr("type", "submit")
        .live_class("primary", move || chosen_port(app).is_some())
        .flag("disabled", move || {
            let ready = chosen_port(app).and_then(|port| app.settings.connection(Source::Serial(port)));
            is_opening(app) || ready.is_none()
        })
        .child(icon(Icon::Plug))
        .child(el("span").live_text(move || {
            let language = app.language.get();
            if is_opening(app) { language.connecting() } else { language.connect() }.to_owned()
        }));
    let demo = button(app, "large", "demo", Language::try_without_hardware)
        .live_class("primary", || serial::missing().is_some())
        .live_attr("title", move || Some(app.language.get().try_hint().to_owned()))
        .flag("disabled", move || is_opening(app))
        .click(move || app.demonstrate());
    el("footer").child(connect).child(demo)
}

fn is_opening(app: &'static App) -> bool {
    app.phase.get() == Phase::Opening
}

fn chosen_port(app: &'static App) -> Option<PortId> {
    app.ports.with(|ports| app.settings.port.with(|wanted| ports::find(ports, wanted)))
}

fn port_field(app: &'static App) -> El {
    let chosen = app.settings.port;
    let none = move || app.ports.with(Vec::is_empty);
    let select = el("select")
        .attr("id", "port")
        .test("port")
        .attr("aria-describedby", "port-note")
        .flag("disabled", none)
        .live(move || {
            let language = app.language.get();
            app.ports.with(|ports| {
                if ports.is_empty() {
                    return vec![el("option").attr("value", "").text(language.port_none())];
                }
                let option = |(at, port): (usize, &PortId)| {
                    let title = ports::title(language, ports, *port);
                    el("option").attr("value", &ports::key(ports, at)).text(&title)
                };
                ports.iter().enumerate().map(option).collect()
            })
        })
        .live_value(move || {
            // New options forget what was chosen.
            app.language.track();
            app.ports.with(|ports| {
                let port = chosen.with(|wanted| ports::find(ports, wanted));
                let at = port.and_then(|port| ports.iter().position(|other| *other == port));
                at.map(|at| ports::key(ports, at)).unwrap_or_default()
            })
        })
        .on("change", move |event| chosen.set(dom::value(&event)));
    let choose = button(app, "", "choose-port", Language::choose_port)
        .live_class("primary", move || none() && serial::missing().is_none())
        .flag("disabled", || serial::missing().is_some())
        .click(move || choose_port(app));
    field(app, "port", Language::port, el("div").class("port-row").child(select).child(choose), move || {
        none().then(|| Note::Hint(app.language.get().port_hint().to_owned()))
    })
}

/// Shows the browser's picker; a granted port becomes the chosen one.
fn choose_port(app: &'static App) {
    app.pick_fault.set(None);
    spawn_local(async move {
        match serial::request_port().await {
            Ok(port) => {
                link::send(&ToEngine::PortsChanged);
                let ports = serial::granted().await;
                let at = ports.iter().position(|other| *other == port).unwrap_or(0);
                app.settings.port.set(ports::key(&ports, at));
                app.ports.set(ports);
            }
            Err(fault) => app.pick_fault.set(Some(fault)),
        }
    });
}

fn fields(app: &'static App) -> Vec<El> {
    let settings = &app.settings;
    let free = Memo::new(move |_| settings.baud.with(|baud| baud == FREE));
    let ascii = Memo::new(move |_| settings.mode() == Mode::Ascii);
    // Fields that come and go are held by a box without a box of its own.
    let sometimes = |wanted: Memo<bool>, build: fn(&'static App) -> El| {
        el("div").class("contents").live_one(move || wanted.get().then(|| build(app)))
    };
    vec![
        device_field(app),
        unit_field(app),
        baud_field(app),
        sometimes(free, free_baud_field),
        line_field(app, "parity", Language::parity, settings.parity, parities, |settings| {
            parity_name(settings.device().line().parity)
        }),
        line_field(
            app,
            "stop-bits",
            Language::stop_bits,
            settings.stop_bits,
            |_| plain(&["1", "2"]),
            |settings| {
                if settings.device().line().stop_bits == StopBits::Two { "2" } else { "1" }
            },
        ),
        line_field(app, "mode", Language::mode, settings.mode, modes, |settings| {
            if settings.device().mode() == Mode::Ascii { "ascii" } else { "rtu" }
        }),
        sometimes(ascii, data_bits_field),
        period_field(app),
    ]
}

fn device_field(app: &'static App) -> El {
    let settings = &app.settings;
    // Another device means other factory settings.
    let mut before = None;
    dom::react(move || {
        let now = settings.device.get();
        if before.replace(now.clone()).is_some_and(|before| before != now) {
            settings.reset();
        }
    });
    let select = choice("profile", settings.device, move || {
        let language = app.language.get();
        device::all().iter().map(|device| (device.id().to_owned(), device.name(language).to_owned())).collect()
    });
    el("div").class("wide").child(field(app, "profile", Language::device, select, || None))
}

fn unit_field(app: &'static App) -> El {
    let settings = &app.settings;
    let input = number("unit", settings.unit, "", move || settings.unit().is_none());
    field(app, "unit", Language::unit, input, move || {
        let language = app.language.get();
        Some(match settings.unit() {
            None => Note::Wrong(language.invalid_unit().to_owned()),
            Some(0) => Note::Warning(language.unit_broadcast().to_owned()),
            Some(248..) => Note::Warning(language.unit_reserved().to_owned()),
            Some(_) => Note::Hint(language.unit_printed().to_owned()),
        })
    })
}

fn baud_field(app: &'static App) -> El {
    let settings = &app.settings;
    let factory = move || settings.device().line().baud;
    let select = choice("baud", settings.baud, move || {
        let mut bauds = BAUDS.to_vec();
        if !bauds.contains(&factory()) {
            bauds.insert(0, factory());
        }
        let listed = bauds.iter().map(|baud| (baud.to_string(), baud.to_string()));
        listed.chain([(FREE.to_owned(), app.language.get().baud_other().to_owned())]).collect()
    });
    field(app, "baud", Language::baud, select, move || {
        let factory = factory().to_string();
        Some(factory_note(app, settings.baud.with(|baud| *baud == factory), &factory))
    })
}

fn free_baud_field(app: &'static App) -> El {
    let settings = &app.settings;
    let wrong = move || settings.baud().is_none();
    field(app, "baud-free", Language::baud_free, number("baud-free", settings.free_baud, "Bd", wrong), move || {
        wrong().then(|| Note::Wrong(app.language.get().invalid_baud().to_owned()))
    })
}

fn data_bits_field(app: &'static App) -> El {
    let value = app.settings.data_bits;
    line_field(
        app,
        "data-bits",
        Language::data_bits,
        value,
        |_| plain(&["8", "7"]),
        |settings| {
            if settings.device().line().data_bits == DataBits::Seven { "7" } else { "8" }
        },
    )
}

/// A field whose few values have a factory setting among them.
fn line_field(
    app: &'static App,
    id: &'static str,
    label: fn(Language) -> &'static str,
    value: RwSignal<String>,
    options: fn(Language) -> Vec<(String, String)>,
    factory: fn(&Settings) -> &'static str,
) -> El {
    let select = choice(id, value, move || options(app.language.get()));
    field(app, id, label, select, move || {
        let factory = factory(&app.settings);
        let named = options(app.language.get()).into_iter().find(|(key, _)| key == factory);
        let named = named.map(|(_, label)| label).unwrap_or_default();
        Some(factory_note(app, value.with(|value| value == factory), &named))
    })
}

fn period_field(app: &'static App) -> El {
    let settings = &app.settings;
    let input = number("period", settings.period, "ms", move || settings.period_ms().is_none());
    field(app, "period", Language::period, input, move || {
        let language = app.language.get();
        let least = settings.device().least_period_ms();
        Some(match settings.period_ms() {
            None => Note::Wrong(language.invalid_period().to_owned()),
            Some(0) => Note::Hint(language.listen_only().to_owned()),
            Some(period) if period < least => Note::Warning(language.period_short(least)),
            Some(period) => Note::Hint(language.period_is(&format::rate(1000.0 / f64::from(period)))),
        })
    })
}

/// Tells that a value is the factory's, or what the factory's would be.
fn factory_note(app: &'static App, is_factory: bool, factory: &str) -> Note {
    let language = app.language.get();
    Note::Hint(if is_factory { language.factory_default().to_owned() } else { language.factory_default_is(factory) })
}

fn parities(language: Language) -> Vec<(String, String)> {
    let named = [("even", language.parity_even()), ("odd", language.parity_odd()), ("none", language.parity_none())];
    named.map(|(key, label)| (key.to_owned(), label.to_owned())).into()
}

fn modes(_: Language) -> Vec<(String, String)> {
    [("rtu", "RTU"), ("ascii", "ASCII")].map(|(key, label)| (key.to_owned(), label.to_owned())).into()
}

fn plain(values: &[&str]) -> Vec<(String, String)> {
    values.iter().map(|&value| (value.to_owned(), value.to_owned())).collect()
}
