//! The device's own help, a sheet over any page: how it is wired, how it leaves the factory, what it can take, and what to
//! try when something is wrong. All of it stands in the profile.

mod facts;
mod wiring;

use buslens_codec::profile::{Erratum, Help, Profile};
use wasm_bindgen::prelude::*;

use crate::components::button::button;
use crate::device::{self, Device};
use crate::dom::{El, Handle, el};
use crate::format::hex_spaced;
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// The sheet, closed.
pub(crate) fn help_sheet(app: &'static Workbench) -> El {
    let title = el("h2").attr("id", "help-title").live_text(move || {
        let language = app.language.get();
        shown(app).map(|device| language.device_help_of(device.name(language))).unwrap_or_default()
    });
    let sheet = el("dialog").class("help-sheet").test("help-sheet").attr("aria-labelledby", "help-title");
    let handle = sheet.handle();
    let (close, around) = (handle.clone(), handle);
    let print = button(app, "small", "help-print", Language::device_help_print).click(|| {
        // A browser without printing has nothing to say.
        let _ = window().print();
    });
    let buttons = [button(app, "small", "help-close", Language::close).click(move || dialog(&close).close()), print];
    let body = el("div").class("help-body").live(move || {
        let language = app.language.get();
        shown(app).map(|device| sections(language, device)).unwrap_or_default()
    });
    let content = el("div")
        .class("help-content")
        .child(el("header").child(title).child(el("span").class("space")).children(buttons))
        .child(body);
    sheet.child(content).on("click", move |event| {
        // What is beside the sheet belongs to it as well.
        if event.target().is_some_and(|target| JsValue::from(target) == *around.js()) {
            dialog(&around).close();
        }
    })
}

/// Opens the sheet over everything else, as soon as its place is on the page. The browser closes it with Escape, and gives
/// the focus back.
pub(crate) fn open_help(sheet: Handle) {
    request_animation_frame(move || {
        // It may be open already.
        let _ = dialog(&sheet).show_modal();
    });
}

/// The connected device, else the chosen one.
fn shown(app: &'static Workbench) -> Option<&'static Device> {
    let chosen = app.help.get()?;
    Some(device::find(&app.console.connected_device().unwrap_or(chosen)))
}

fn sections(language: Language, device: &'static Device) -> Vec<El> {
    let profile = device.profile();
    let list = |all: Vec<El>| el("ul").children(all);
    let notes: Vec<El> = profile.notes.iter().map(|note| el("li").text(device::pick(language, note))).collect();
    let errata: Vec<El> = profile.errata.iter().map(|erratum| self::erratum(language, erratum)).collect();
    let help: Vec<El> = profile.help.iter().flat_map(|help| self::help(language, help)).collect();
    let all = [
        Some(section("wiring", language.device_help_wiring(), wiring::wiring(language, profile))),
        Some(section("defaults", language.device_help_defaults(), vec![table(facts::defaults(language, profile))])),
        Some(section("limits", language.device_help_limits(), vec![table(facts::limits(language, profile))])),
        (!help.is_empty()).then(|| section("try", language.device_help_try(), help)),
        (!notes.is_empty()).then(|| section("notes", language.device_help_notes(), vec![list(notes)])),
        (!errata.is_empty()).then(|| section("errata", language.device_help_errata(), vec![list(errata)])),
        source(language, profile),
    ];
    all.into_iter().flatten().collect()
}

fn section(hook: &str, title: &str, content: Vec<El>) -> El {
    el("section").test(&["help-", hook].concat()).child(el("h3").text(title)).children(content)
}

/// Names with what is told of them.
fn table(rows: Vec<(String, String)>) -> El {
    let row = |(name, value): (String, String)| el("div").child(el("dt").text(&name)).child(el("dd").text(&value));
    el("dl").class("help-facts").children(rows.into_iter().map(row))
}

fn help(language: Language, help: &Help) -> [El; 2] {
    let steps = help.remedies.iter().map(|step| el("li").text(device::pick(language, step)));
    [el("h4").text(device::pick(language, &help.symptom)), el("ol").children(steps)]
}

fn erratum(language: Language, erratum: &Erratum) -> El {
    let item = el("li").text(device::pick(language, &erratum.text));
    if erratum.printed.is_empty() {
        return item;
    }
    let frame = |label: &str, bytes: &[u8]| {
        el("div").child(el("dt").text(label)).child(el("dd").class("mono").text(&hex_spaced(bytes)))
    };
    let frames = el("dl")
        .class("help-facts")
        .child(frame(language.device_help_printed(), &erratum.printed))
        .child(frame(language.device_help_right(), &erratum.right));
    item.child(frames)
}

fn source(language: Language, profile: &Profile) -> Option<El> {
    let source = Some(&profile.source).filter(|source| !source.is_empty())?;
    Some(el("p").class("muted").text(&language.device_help_source(source)))
}

fn dialog(sheet: &Handle) -> &Dialog {
    sheet.js().unchecked_ref()
}

#[wasm_bindgen]
extern "C" {
    type Dialog;
    #[wasm_bindgen(method, catch, js_name = showModal)]
    fn show_modal(this: &Dialog) -> Result<(), JsValue>;
    #[wasm_bindgen(method)]
    fn close(this: &Dialog);
}
