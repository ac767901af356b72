//! The view as a form: every field stands for a place in the text, and changes only that.

mod points;
mod rows;
mod widget;

use rows::{List, list};
use widget::{Kind, Widget, texts, widget};

use crate::components::icon::{Icon, icon};
use crate::dom::{El, el};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

const PARITIES: &[(&str, Label)] =
    &[("none", Language::parity_none), ("odd", Language::parity_odd), ("even", Language::parity_even)];
const STOP_BITS: &[(&str, Label)] = &[("one", |_| "1"), ("two", |_| "2")];
const DATA_BITS: &[(&str, Label)] = &[("eight", |_| "8"), ("seven", |_| "7")];
const MODES: &[(&str, Label)] = &[("rtu", |_| "RTU"), ("ascii", |_| "ASCII")];
const INTERFACES: &[(&str, Label)] = &[("rs485", |_| "RS485"), ("rs232", |_| "RS232")];

const IDENTITY: &[Widget] = &[
    Widget::new("id", Language::of_id, Kind::Word),
    Widget::new("interface", Language::of_interface, Kind::Choice(INTERFACES)),
    Widget::new("supply", Language::of_supply, Kind::Text),
    Widget::new("source", Language::of_source, Kind::Text),
];

const LINE: &[Widget] = &[
    Widget::new("line.baud", Language::baud, Kind::Number),
    Widget::new("line.parity", Language::parity, Kind::Choice(PARITIES)),
    Widget::new("line.data_bits", Language::data_bits, Kind::Choice(DATA_BITS)),
    Widget::new("line.stop_bits", Language::stop_bits, Kind::Choice(STOP_BITS)),
    Widget::new("mode", Language::mode, Kind::Choice(MODES)),
    Widget::new("unit", Language::of_unit_id, Kind::Number),
    Widget::new("units.first", Language::of_units_first, Kind::Number),
    Widget::new("units.last", Language::of_units_last, Kind::Number),
];

const CHOICES: &[Widget] = &[
    Widget::new("choices.bauds", Language::of_bauds, Kind::List),
    Widget::new("choices.parities", Language::of_parities, Kind::Checks(PARITIES)),
    Widget::new("choices.stop_bits", Language::stop_bits, Kind::Checks(STOP_BITS)),
    Widget::new("choices.modes", Language::of_modes, Kind::Checks(MODES)),
];

const TIMING: &[Widget] = &[
    Widget::new("timing.response_timeout_ms", Language::of_timeout, Kind::Number),
    Widget::new("timing.startup_silence_ms", Language::of_startup, Kind::Number),
    Widget::new("timing.poll_period_ms", Language::of_poll, Kind::Number),
    Widget::new("timing.min_poll_period_ms", Language::of_min_poll, Kind::Number),
    Widget::new("timing.min_write_period_ms", Language::of_min_write, Kind::Number),
    Widget::new("timing.inter_device_pause_ms", Language::of_pause, Kind::Number),
    Widget::new("timing.flash_writes", Language::of_flash, Kind::Number),
];

const READ: &[Widget] = &[
    Widget::new("function", Language::of_function, Kind::Number),
    Widget::new("address", Language::of_address, Kind::Number),
    Widget::new("quantity", Language::of_quantity, Kind::Number),
    Widget::new("tentative", Language::of_tentative, Kind::Flag),
];

const EXAMPLE: &[Widget] = &[
    Widget::new("point", Language::of_point, Kind::Point),
    Widget::new("registers", Language::of_values, Kind::List),
    Widget::new("decimals", Language::of_decimals, Kind::Number),
    Widget::new("text", Language::of_text, Kind::Text),
];

const WIRE: &[Widget] = &[
    Widget::new("color", Language::of_color, Kind::Word),
    Widget::new("name.en", Language::of_name, Kind::English),
    Widget::new("name.zh", Language::of_name, Kind::Chinese),
    Widget::new("signal", Language::of_signal, Kind::Text),
    Widget::new("pin", Language::of_pin, Kind::Number),
    Widget::new("use.en", Language::of_use, Kind::English),
    Widget::new("use.zh", Language::of_use, Kind::Chinese),
];

const NOTE: &[Widget] =
    &[Widget::new("en", Language::of_note, Kind::English), Widget::new("zh", Language::of_note, Kind::Chinese)];

const ERRATUM: &[Widget] = &[
    Widget::new("text.en", Language::of_erratum, Kind::English),
    Widget::new("text.zh", Language::of_erratum, Kind::Chinese),
    Widget::new("printed", Language::of_printed, Kind::Word),
    Widget::new("right", Language::of_right, Kind::Word),
];

/// What a new entry of each list begins with.
const NEW_READ: &str = r#"{ "function": 3, "address": 0, "quantity": 1 }"#;
const NEW_EXAMPLE: &str = r#"{ "point": "", "registers": [0], "text": "0" }"#;
const NEW_WIRE: &str =
    r#"{ "color": "", "name": { "en": "", "zh": "" }, "signal": "", "use": { "en": "", "zh": "" } }"#;
const NEW_NOTE: &str = r#"{ "en": "", "zh": "" }"#;
const NEW_ERRATUM: &str = r#"{ "text": { "en": "", "zh": "" } }"#;

/// The form; while the text is no JSON, a sentence that says so.
pub(super) fn form(app: &'static Workbench) -> El {
    let is_json = Memo::new(move |_| app.profiles.tree.with(Option::is_some));
    // Another profile has other fields, also where the paths are the same: what was typed in them is not its own.
    let shown = app.profiles.chosen;
    el("div").class("contents").live_one(move || {
        shown.track();
        Some(if is_json.get() {
            fields(app)
        } else {
            el("div")
                .class("profile-no-form")
                .test("profile-no-form")
                .child(icon(Icon::Info))
                .child(el("p").say(app, Language::profile_no_form))
        })
    })
}

fn fields(app: &'static Workbench) -> El {
    let identity = texts(app, "name", Language::of_name)
        .into_iter()
        .chain(IDENTITY.iter().map(|spec| widget(app, spec.key.to_owned(), spec)));
    let all = |specs: &'static [Widget]| specs.iter().map(move |spec| widget(app, spec.key.to_owned(), spec));
    let reads =
        |path: &'static str, title: Label| list(app, List { path, title, about: None, specs: READ, new: NEW_READ });
    el("fieldset")
        .class("profile-form")
        .flag("disabled", move || app.profiles.built_in().is_some())
        .child(section(app, "identity", Language::form_identity, true, identity))
        .child(section(app, "line", Language::form_line, true, all(LINE)))
        .child(section(app, "choices", Language::form_choices, false, all(CHOICES)))
        .child(section(app, "timing", Language::form_timing, false, all(TIMING)))
        .child(points::points(app))
        .child(reads("groups", Language::form_groups))
        .child(list(
            app,
            List {
                path: "examples",
                title: Language::form_examples,
                about: Some(Language::form_examples_about),
                specs: EXAMPLE,
                new: NEW_EXAMPLE,
            },
        ))
        .child(reads("discovery", Language::form_discovery))
        .child(reads("fingerprint", Language::form_fingerprint))
        .child(plain_list(app, "wiring", Language::form_wiring, WIRE, NEW_WIRE))
        .child(plain_list(app, "notes", Language::form_notes, NOTE, NEW_NOTE))
        .child(plain_list(app, "errata", Language::form_errata, ERRATUM, NEW_ERRATUM))
}

fn plain_list(
    app: &'static Workbench,
    path: &'static str,
    title: Label,
    specs: &'static [Widget],
    new: &'static str,
) -> El {
    list(app, List { path, title, about: None, specs, new })
}

/// A part of the form that opens and closes; it opens by itself where the fault is inside.
fn section(
    app: &'static Workbench,
    hook: &str,
    title: Label,
    is_open: bool,
    content: impl IntoIterator<Item = El>,
) -> El {
    let details = el("details").class("profile-section").test(&["section-", hook].concat());
    let details = if is_open { details.attr("open", "") } else { details };
    details
        .child(el("summary").child(el("h3").say(app, title)))
        .child(el("div").class("profile-fields").children(content))
}
