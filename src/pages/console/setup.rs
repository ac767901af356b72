//! The line at hand: its settings, changed without losing the log, its switches, its outputs and inputs.

use buslens_analyst::line::{LineState, Signals, ToLine};
use buslens_codec::line::{DataBits, LineSettings, Mode, Parity, StopBits};

use super::compact;
use crate::components::button::{bare, button};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::settings::{BAUDS, FREE, parity_name, parse_baud};
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// What can be chosen as the browser's buffer, in bytes.
const BUFFERS: [&str; 5] = ["255", "1024", "8192", "65536", "1048576"];
/// What a break lasts unless something else is typed, in milliseconds.
const BREAK_MS: &str = "100";
/// The longest break, in milliseconds.
const LONGEST_BREAK_MS: u32 = 10_000;

/// The fields of the settings: what is wanted, which is in force once it is applied.
#[derive(Clone, Copy)]
pub(super) struct Setup {
    baud: RwSignal<String>,
    free_baud: RwSignal<String>,
    data_bits: RwSignal<String>,
    parity: RwSignal<String>,
    stop_bits: RwSignal<String>,
    /// `rtu`, `ascii` or `raw`.
    mode: RwSignal<String>,
    buffer: RwSignal<String>,
    break_ms: RwSignal<String>,
    /// Whether the fields are to be seen.
    open: RwSignal<bool>,
}

/// What the fields say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Wanted {
    line: LineSettings,
    mode: Mode,
    raw: bool,
    buffer_bytes: u32,
}

impl Wanted {
    fn of(state: &LineState, raw: bool) -> Self {
        Self { line: state.line, mode: state.mode, raw, buffer_bytes: state.buffer_bytes }
    }
}

impl Setup {
    pub(super) fn new() -> Self {
        let signal = |text: &str| RwSignal::new(text.to_owned());
        Self {
            baud: signal("9600"),
            free_baud: signal(""),
            data_bits: signal("8"),
            parity: signal("even"),
            stop_bits: signal("1"),
            mode: signal("rtu"),
            buffer: signal("8192"),
            break_ms: signal(BREAK_MS),
            open: RwSignal::new(window().inner_width().ok().and_then(|width| width.as_f64()).is_none_or(|w| w > 900.0)),
        }
    }

    /// Fills the fields with what is in force.
    fn take(&self, Wanted { line, mode, raw, buffer_bytes }: Wanted) {
        let baud = line.baud.to_string();
        let listed = BAUDS.contains(&line.baud);
        self.baud.set(if listed { &baud } else { FREE }.to_owned());
        self.free_baud.set(if listed { String::new() } else { baud });
        self.data_bits.set(if line.data_bits == DataBits::Seven { "7" } else { "8" }.to_owned());
        self.parity.set(parity_name(line.parity).to_owned());
        self.stop_bits.set(if line.stop_bits == StopBits::Two { "2" } else { "1" }.to_owned());
        let mode = match mode {
            Mode::Rtu if raw => "raw",
            Mode::Rtu => "rtu",
            Mode::Ascii => "ascii",
        };
        self.mode.set(mode.to_owned());
        self.buffer.set(buffer_bytes.to_string());
    }

    /// What the fields say; `None` while one is not valid.
    fn wanted(&self) -> Option<Wanted> {
        let listed = self.baud.get();
        let baud = if listed == FREE { parse_baud(&self.free_baud.get()) } else { parse_baud(&listed) }?;
        let is = |field: RwSignal<String>, value: &str| field.with(|text| text == value);
        let parity = match self.parity.get().as_str() {
            "odd" => Parity::Odd,
            "none" => Parity::None,
            _ => Parity::Even,
        };
        let line = LineSettings {
            baud,
            data_bits: if is(self.data_bits, "7") { DataBits::Seven } else { DataBits::Eight },
            parity,
            stop_bits: if is(self.stop_bits, "2") { StopBits::Two } else { StopBits::One },
        };
        Some(Wanted {
            line,
            mode: if is(self.mode, "ascii") { Mode::Ascii } else { Mode::Rtu },
            raw: is(self.mode, "raw"),
            buffer_bytes: self.buffer.with(|text| text.parse().ok())?,
        })
    }
}

/// The strip above the log.
pub(super) fn line_strip(app: &'static Workbench) -> El {
    let console = &app.console;
    let setup = console.setup;
    let in_force =
        Memo::new(move |_| console.line.with(|line| line.as_ref().map(|line| Wanted::of(line, console.raw.get()))));
    dom::react(move || {
        if let Some(in_force) = in_force.get() {
            setup.take(in_force);
        }
    });
    let pending = Memo::new(move |_| in_force.get().is_some_and(|in_force| setup.wanted() != Some(in_force)));
    let open = setup.open;
    let fold = bare("quiet small", "line-fold")
        .state("aria-expanded", move || open.get())
        .attr("aria-controls", "line-fields")
        .live_text(move || line_text(app))
        .click(move || open.update(|open| *open = !*open));
    el("form")
        .class("card line-strip")
        .test("line-strip")
        .label(app, Language::line_settings)
        .live_class("open", move || open.get())
        .on("submit", move |event| {
            event.prevent_default();
            apply(app);
        })
        .child(state_chip(app))
        .child(fold)
        .child(
            el("fieldset")
                .class("line-fields")
                .attr("id", "line-fields")
                .flag("disabled", move || !console.is_open())
                .children(fields(app, setup))
                .live_one(move || pending.get().then(|| pending_buttons(app, setup))),
        )
        .child(el("div").class("line-switches").children(switches(app)))
        .child(signals(app, setup))
}

/// Puts what the fields say in force.
fn apply(app: &'static Workbench) {
    let console = &app.console;
    let in_force = console.line.with_untracked(|line| line.as_ref().map(|line| Wanted::of(line, console.raw.get())));
    let Some((wanted, before)) = console.setup.wanted().zip(in_force) else { return };
    if wanted.raw != before.raw {
        console.raw.set(wanted.raw);
        if wanted.raw {
            console.order(ToLine::Poll(false));
        }
    }
    if (Wanted { raw: false, ..wanted }) != (Wanted { raw: false, ..before }) {
        let Wanted { line, mode, buffer_bytes, .. } = wanted;
        console.order(ToLine::Settings { line, mode, buffer_bytes });
    }
}

fn pending_buttons(app: &'static Workbench, setup: Setup) -> El {
    let apply = button(app, "small primary", "line-apply", Language::apply)
        .attr("type", "submit")
        .flag("disabled", move || setup.wanted().is_none());
    let undo = button(app, "small quiet", "line-undo", Language::undo).click(move || {
        let console = &app.console;
        let in_force = console.line.with(|line| line.as_ref().map(|line| Wanted::of(line, console.raw.get())));
        if let Some(in_force) = in_force {
            setup.take(in_force);
        }
    });
    el("div")
        .class("pending")
        .attr("role", "status")
        .child(el("span").say(app, Language::not_applied))
        .child(apply)
        .child(undo)
}

/// What is there: a port, the simulator, a replay, nothing.
fn state_chip(app: &'static Workbench) -> El {
    let state = move || {
        app.console.line.with(|line| match line {
            Some(line) if line.replay => "replay",
            Some(line) if line.open && line.simulated => "simulated",
            Some(line) if line.open => "open",
            _ => "closed",
        })
    };
    el("span")
        .class("line-state")
        .test("line-state")
        .live_attr("data-state", move || Some(state().to_owned()))
        .child(el("i").class("dot"))
        .child(el("b").live_text(move || {
            let language = app.language.get();
            match state() {
                "replay" => language.line_replay(),
                "simulated" => language.line_simulated(),
                "open" => language.line_open(),
                _ => language.line_closed(),
            }
            .to_owned()
        }))
}

fn line_text(app: &'static Workbench) -> String {
    let console = &app.console;
    let raw = console.raw.get();
    let text = console.line.with(|line| line.as_ref().map(|line| (line.line.to_string(), line.mode)));
    let Some((text, mode)) = text else { return app.language.get().line_settings().to_owned() };
    let mode = match mode {
        Mode::Rtu if raw => app.language.get().mode_raw(),
        Mode::Rtu => "RTU",
        Mode::Ascii => "ASCII",
    };
    [&text, " \u{B7} ", mode].concat()
}

fn fields(app: &'static Workbench, setup: Setup) -> Vec<El> {
    let free = Memo::new(move |_| setup.baud.with(|baud| baud == FREE));
    let bauds = move || {
        let listed = BAUDS.iter().map(|baud| (baud.to_string(), baud.to_string()));
        listed.chain([(FREE.to_owned(), app.language.get().baud_other().to_owned())]).collect()
    };
    let free_field = move || {
        let input = el("input")
            .attr("inputmode", "numeric")
            .attr("autocomplete", "off")
            .test("line-baud-free")
            .live_attr("aria-invalid", move || {
                setup.free_baud.with(|text| parse_baud(text).is_none()).then(|| "true".to_owned())
            })
            .live_attr("title", move || Some(app.language.get().invalid_baud().to_owned()))
            .bind("input", setup.free_baud);
        compact::field(app, Language::baud_free, input)
    };
    let plain = |values: &'static [&'static str]| {
        move || values.iter().map(|value| ((*value).to_owned(), (*value).to_owned())).collect()
    };
    let parities = move || {
        let language = app.language.get();
        let named =
            [("none", language.parity_none()), ("even", language.parity_even()), ("odd", language.parity_odd())];
        named.map(|(key, label)| (key.to_owned(), label.to_owned())).into()
    };
    let modes = move || {
        let raw = app.language.get().mode_raw();
        [("rtu", "RTU"), ("ascii", "ASCII"), ("raw", raw)].map(|(key, label)| (key.to_owned(), label.to_owned())).into()
    };
    let field = |label: Label, hook: &'static str, value, options: Box<dyn Fn() -> Vec<(String, String)>>| {
        compact::field(app, label, compact::select(hook, value, options))
    };
    vec![
        field(Language::baud, "line-baud", setup.baud, Box::new(bauds)),
        el("div").class("contents").live_one(move || free.get().then(free_field)),
        field(Language::data_bits, "line-data-bits", setup.data_bits, Box::new(plain(&["8", "7"]))),
        field(Language::parity, "line-parity", setup.parity, Box::new(parities)),
        field(Language::stop_bits, "line-stop-bits", setup.stop_bits, Box::new(plain(&["1", "2"]))),
        field(Language::mode, "line-mode", setup.mode, Box::new(modes)),
        field(Language::buffer, "line-buffer", setup.buffer, {
            Box::new(move || {
                let known = BUFFERS.map(str::to_owned).to_vec();
                let current = setup.buffer.get();
                let other = (!known.contains(&current)).then_some(current);
                known.into_iter().chain(other).map(|size| (size.clone(), size)).collect()
            })
        }),
    ]
}

fn switches(app: &'static Workbench) -> [El; 2] {
    let console = &app.console;
    let on = move |pick: fn(&LineState) -> bool| console.line.with(|line| line.as_ref().is_some_and(pick));
    let switch =
        move |hook: &'static str, text: Label, hint: Label, pick: fn(&LineState) -> bool, order: fn(bool) -> ToLine| {
            bare("small switch", hook)
                .attr("id", hook)
                .attr("role", "switch")
                .state("aria-checked", move || on(pick))
                .live_attr("title", move || Some(hint(app.language.get()).to_owned()))
                .flag("disabled", move || console.line.with(|line| line.as_ref().is_none_or(|line| line.replay)))
                .child(el("i"))
                .child(el("span").say(app, text))
                .click(move || console.order(order(!on(pick))))
        };
    [
        switch("line-polling", Language::polling, Language::polling_hint, |line| line.polling, ToLine::Poll),
        switch(
            "line-read-only",
            Language::read_only,
            Language::read_only_hint,
            |line| line.read_only,
            ToLine::ReadOnly,
        )
        .live_class("caution", move || on(|line| line.read_only)),
    ]
}

/// A lamp's name and how it is read.
type Lamp = (&'static str, fn(&Signals) -> Option<bool>);

fn signals(app: &'static Workbench, setup: Setup) -> El {
    let console = &app.console;
    let signal = move |pick: fn(&Signals) -> Option<bool>| {
        console.line.with(|line| line.as_ref().and_then(|line| pick(&line.signals)))
    };
    let has_signals = move || {
        console.line.with(|line| line.as_ref().is_some_and(|line| line.open && !line.simulated && !line.replay))
    };
    let output =
        move |name: &'static str, hook: &str, pick: fn(&Signals) -> Option<bool>, order: fn(bool) -> ToLine| {
            bare("small lamp-button", hook)
                .attr("id", hook)
                .state("aria-pressed", move || signal(pick) == Some(true))
                .flag("disabled", move || !has_signals())
                .child(el("i").class("lamp").live_attr("data-on", move || lamp_state(signal(pick))))
                .child(el("span").text(name))
                .click(move || console.order(order(signal(pick) != Some(true))))
        };
    let inputs: [Lamp; 4] =
        [("CTS", |all| all.cts), ("DSR", |all| all.dsr), ("DCD", |all| all.dcd), ("RI", |all| all.ri)];
    let lamp = move |(name, pick): Lamp| {
        let told = move || {
            let language = app.language.get();
            let state = match signal(pick) {
                Some(true) => language.lamp_on(),
                Some(false) => language.lamp_off(),
                None => language.lamp_unknown(),
            };
            Some([name, language.colon(), state].concat())
        };
        el("span")
            .class("lamp-name")
            .attr("role", "img")
            .live_attr("aria-label", told)
            .live_attr("title", told)
            .child(el("i").class("lamp").live_attr("data-on", move || lamp_state(signal(pick))))
            .child(el("span").text(name))
    };
    let milliseconds = move || {
        setup.break_ms.with(|text| text.trim().parse::<u32>().ok()).filter(|ms| (1..=LONGEST_BREAK_MS).contains(ms))
    };
    let duration = el("input")
        .class("break-ms")
        .attr("inputmode", "numeric")
        .attr("autocomplete", "off")
        .test("line-break-ms")
        .label(app, Language::break_duration)
        .live_attr("aria-invalid", move || milliseconds().is_none().then(|| "true".to_owned()))
        .bind("input", setup.break_ms);
    let hold = button(app, "small", "line-break", Language::break_line)
        .attr("id", "line-break")
        .live_attr("title", move || Some(app.language.get().break_hint().to_owned()))
        .flag("disabled", move || !console.is_open() || milliseconds().is_none())
        .click(move || {
            if let Some(milliseconds) = milliseconds() {
                console.order(ToLine::Break(milliseconds));
            }
        });
    // Nobody can do this to a sensor of his own from here.
    let simulated = Memo::new(move |_| console.line.with(|line| line.as_ref().is_some_and(|line| line.simulated)));
    let power_cycle = move || {
        button(app, "small", "line-power-cycle", Language::power_cycle)
            .attr("id", "line-power-cycle")
            .live_attr("title", move || Some(app.language.get().power_cycle_hint().to_owned()))
            .flag("disabled", move || !console.is_open())
            .click(move || console.order(ToLine::PowerCycle))
    };
    let dtr = output("DTR", "line-dtr", |all| all.dtr, |on| ToLine::Signals { dtr: Some(on), rts: None });
    let rts = output("RTS", "line-rts", |all| all.rts, |on| ToLine::Signals { dtr: None, rts: Some(on) });
    el("div")
        .class("line-signals")
        .attr("role", "group")
        .label(app, Language::signals)
        .children([dtr, rts])
        .children(inputs.map(lamp))
        .child(el("span").class("break").child(hold).child(duration).child(el("span").class("muted").text("ms")))
        .child(el("span").class("contents").live_one(move || simulated.get().then(power_cycle)))
}

fn lamp_state(on: Option<bool>) -> Option<String> {
    on.map(|on| if on { "true" } else { "false" }.to_owned())
}
