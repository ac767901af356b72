//! Not connected: the card with the settings and one obvious next action, and beside it how the device is wired.

use buslens_codec::line::Mode;
use leptos::prelude::*;
use wasm_bindgen_futures::spawn_local;

use super::field::{Note, choice, field, number};
use super::wiring::wiring;
use crate::app::{App, Phase};
use crate::components::icon::{Icon, icon};
use crate::device;
use crate::format;
use crate::link;
use crate::message::{Source, ToEngine};
use crate::ports;
use crate::serial;
use crate::settings::{BAUDS, FREE, Settings, demonstration, parity_name};
use crate::text::Language;

/// The card and the wiring beside it.
pub(super) fn connect(app: &'static App) -> AnyView {
    view! {
        <div class="connect">
            {card(app)}
            {wiring(app)}
        </div>
    }
    .into_any()
}

fn card(app: &'static App) -> AnyView {
    let settings = &app.settings;
    let opening = Memo::new(move |_| app.phase.get() == Phase::Opening);
    let port = Memo::new(move |_| app.ports.with(|ports| settings.port.with(|wanted| ports::find(ports, wanted))));
    let connection = Memo::new(move |_| settings.connection(Source::Serial(port.get()?)));
    view! {
        <form
            class="card connect-card"
            on:submit=move |event| {
                event.prevent_default();
                if let Some(connection) = connection.get_untracked() {
                    app.connect(connection);
                }
            }
        >
            <header>
                <h2>{app.text(Language::connect_title)}</h2>
                <span class="space"></span>
                <Show when=move || !settings.is_factory()>
                    <button
                        type="button"
                        class="button quiet small"
                        data-test="reset-settings"
                        on:click=move |_| settings.reset()
                    >
                        {icon(Icon::Reset)}
                        {app.text(Language::reset_to_defaults)}
                    </button>
                </Show>
            </header>
            <fieldset disabled=move || opening.get()>
                {port_field(app)}
                <div class="fields">{fields(app)}</div>
            </fieldset>
            <footer>
                <button
                    type="submit"
                    class="button large"
                    class:primary=move || port.get().is_some()
                    data-test="connect"
                    disabled=move || opening.get() || connection.with(Option::is_none)
                >
                    {icon(Icon::Plug)}
                    {move || {
                        let language = app.language.get();
                        if opening.get() { language.connecting() } else { language.connect() }
                    }}
                </button>
                <button
                    type="button"
                    class="button large"
                    class:primary=move || serial::missing().is_some()
                    data-test="demo"
                    title=app.text(Language::try_hint)
                    disabled=move || opening.get()
                    on:click=move |_| app.connect(demonstration(settings.device()))
                >
                    {app.text(Language::try_without_hardware)}
                </button>
            </footer>
        </form>
    }
    .into_any()
}

fn port_field(app: &'static App) -> AnyView {
    let chosen = app.settings.port;
    let none = Memo::new(move |_| app.ports.with(Vec::is_empty));
    let options = move || {
        let language = app.language.get();
        app.ports.with(|ports| {
            let named = ports.iter().enumerate();
            named.map(|(at, port)| (ports::key(ports, at), ports::title(language, ports, *port))).collect::<Vec<_>>()
        })
    };
    let select = view! {
        <div class="port-row">
            <select
                id="port"
                data-test="port"
                aria-describedby="port-note"
                disabled=move || none.get()
                on:change=move |event| chosen.set(event_target_value(&event))
            >
                {move || {
                    let selected = app.ports.with(|ports| {
                        let port = chosen.with(|wanted| ports::find(ports, wanted))?;
                        let at = ports.iter().position(|other| *other == port)?;
                        Some(ports::key(ports, at))
                    });
                    let mut options = options();
                    if options.is_empty() {
                        options.push((String::new(), app.language.get().port_none().to_owned()));
                    }
                    options
                        .into_iter()
                        .map(|(key, label)| {
                            let selected = selected.as_ref() == Some(&key);
                            view! { <option value=key prop:selected=selected>{label}</option> }
                        })
                        .collect::<Vec<_>>()
                }}
            </select>
            <button
                type="button"
                class="button"
                class:primary=move || none.get() && serial::missing().is_none()
                data-test="choose-port"
                disabled=move || serial::missing().is_some()
                on:click=move |_| choose_port(app)
            >
                {app.text(Language::choose_port)}
            </button>
        </div>
    }
    .into_any();
    field("port", app.text(Language::port), select, move || {
        none.get().then(|| Note::Hint(app.language.get().port_hint().to_owned()))
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

fn fields(app: &'static App) -> Vec<AnyView> {
    let settings = &app.settings;
    let ascii = Memo::new(move |_| settings.mode() == Mode::Ascii);
    vec![
        device_field(app),
        unit_field(app),
        baud_field(app),
        (move || (settings.baud.with(|baud| baud == FREE)).then(|| free_baud_field(app))).into_any(),
        line_field(app, "parity", Language::parity, settings.parity, parities, |settings| {
            parity_name(settings.device().line().parity)
        }),
        line_field(
            app,
            "stop-bits",
            Language::stop_bits,
            settings.stop_bits,
            |_| plain(&["1", "2"]),
            |settings| match settings.device().line().stop_bits {
                buslens_codec::line::StopBits::One => "1",
                buslens_codec::line::StopBits::Two => "2",
            },
        ),
        line_field(app, "mode", Language::mode, settings.mode, modes, |settings| match settings.device().mode() {
            Mode::Rtu => "rtu",
            Mode::Ascii => "ascii",
        }),
        (move || {
            ascii.get().then(|| {
                line_field(
                    app,
                    "data-bits",
                    Language::data_bits,
                    settings.data_bits,
                    |_| plain(&["8", "7"]),
                    |settings| match settings.device().line().data_bits {
                        buslens_codec::line::DataBits::Seven => "7",
                        buslens_codec::line::DataBits::Eight => "8",
                    },
                )
            })
        })
        .into_any(),
        period_field(app),
    ]
}

fn device_field(app: &'static App) -> AnyView {
    let settings = &app.settings;
    let options = move || {
        let language = app.language.get();
        device::all().iter().map(|device| (device.id().to_owned(), device.name(language).to_owned())).collect()
    };
    // Another device means other factory settings.
    Effect::new(move |before: Option<String>| {
        let now = settings.device.get();
        if before.is_some_and(|before| before != now) {
            settings.reset();
        }
        now
    });
    let select = choice("profile", "profile", settings.device, options);
    view! { <div class="wide">{field("profile", app.text(Language::device), select, || None)}</div> }.into_any()
}

fn unit_field(app: &'static App) -> AnyView {
    let settings = &app.settings;
    let wrong = move || settings.unit().is_none();
    field("unit", app.text(Language::unit), number("unit", "unit", settings.unit, "", wrong), move || {
        let language = app.language.get();
        match settings.unit() {
            None => Some(Note::Wrong(language.invalid_unit().to_owned())),
            Some(0) => Some(Note::Warning(language.unit_broadcast().to_owned())),
            Some(248..) => Some(Note::Warning(language.unit_reserved().to_owned())),
            Some(_) => Some(Note::Hint(language.unit_printed().to_owned())),
        }
    })
}

fn baud_field(app: &'static App) -> AnyView {
    let settings = &app.settings;
    let options = move || {
        let listed = BAUDS.iter().map(|baud| (baud.to_string(), baud.to_string()));
        listed.chain([(FREE.to_owned(), app.language.get().baud_other().to_owned())]).collect()
    };
    let select = choice("baud", "baud", settings.baud, options);
    field("baud", app.text(Language::baud), select, move || {
        let factory = settings.device().line().baud.to_string();
        Some(factory_note(app, settings.baud.with(|baud| *baud == factory), &factory))
    })
}

fn free_baud_field(app: &'static App) -> AnyView {
    let settings = &app.settings;
    let wrong = move || settings.baud().is_none();
    let input = number("baud-free", "baud-free", settings.free_baud, "Bd", wrong);
    field("baud-free", app.text(Language::baud_free), input, move || {
        wrong().then(|| Note::Wrong(app.language.get().invalid_baud().to_owned()))
    })
}

/// A field whose few values have factory settings. `test` is also its id.
fn line_field(
    app: &'static App,
    test: &'static str,
    label: fn(Language) -> &'static str,
    value: RwSignal<String>,
    options: fn(Language) -> Vec<(String, String)>,
    factory: fn(&Settings) -> &'static str,
) -> AnyView {
    let select = choice(test, test, value, move || options(app.language.get()));
    field(test, app.text(label), select, move || {
        let factory = factory(&app.settings);
        let named = options(app.language.get()).into_iter().find(|(key, _)| key == factory);
        let named = named.map(|(_, label)| label).unwrap_or_default();
        Some(factory_note(app, value.with(|value| value == factory), &named))
    })
}

fn period_field(app: &'static App) -> AnyView {
    let settings = &app.settings;
    let wrong = move || settings.period_ms().is_none();
    let input = number("period", "period", settings.period, "ms", wrong);
    field("period", app.text(Language::period), input, move || {
        let language = app.language.get();
        let least = settings.device().least_period_ms();
        Some(match settings.period_ms() {
            None => Note::Wrong(language.invalid_period().to_owned()),
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
