//! The fields: the device's point with its value, and those of the message.

use crate::reactive::prelude::*;
use buslens_codec::profile::{Code, Point, Role};

use super::Built;
use super::form::Form;
use super::words::{label, note};
use crate::builder::{Slot, point};
use crate::components::field::{Note, choice, entry, field, labelled, list, option};
use crate::device::{self, pick};
use crate::dom::{El, el};
use crate::text::Language;
use crate::workbench::Workbench;

/// Device, point, and the point's value where the message holds it.
pub(super) fn point_fields(app: &'static Workbench, form: Form, built: Memo<Built>) -> Vec<El> {
    let devices = choice("builder-device", form.device, move || {
        let language = app.language.get();
        device::all().iter().map(|device| (device.id().to_owned(), device.name(language).to_owned())).collect()
    });
    let devices = devices.on("change", move |_| form.leave_point());
    let points = list("builder-point", form.point, Box::new(move || point_options(app.language.get(), form)));
    let points = points.on("change", move |_| form.take_point());
    let told = move || {
        let (chosen, _) = form.point()?;
        Some(Note::Hint(pick(app.language.get(), chosen.note.as_ref()?).to_owned()))
    };
    let carried =
        Memo::new(move |_| built.with(|built| built.draft.fields.iter().any(|field| point::is_carrier(field.slot))));
    let value = move || form.point().filter(|_| carried.get()).map(|(chosen, _)| value_field(app, form, chosen));
    vec![
        field(app, "builder-device", Language::device, devices, || None),
        field(app, "builder-point", Language::builder_point, points, told),
        el("div").class("contents").live_one(value),
    ]
}

/// One field of the message.
pub(super) fn slot_field(app: &'static Workbench, form: Form, built: Memo<Built>, slot: Slot) -> El {
    let text = form.slot(slot);
    let key = slot.key();
    let is_wrong = move || built.with(|built| built.draft.fault(slot).is_some());
    let control = if slot == Slot::Coil {
        choice(key, text, move || {
            let language = app.language.get();
            let options = [("on", language.coil_on(), " FF 00"), ("off", language.coil_off(), " 00 00")];
            options.map(|(key, name, bytes)| (key.to_owned(), [name, bytes].concat())).into()
        })
    } else if slot.is_long() {
        entry("textarea", key, text, is_wrong).attr("rows", "2")
    } else {
        entry("input", key, text, is_wrong).attr("type", "text")
    };
    let control = control.on(if slot == Slot::Coil { "change" } else { "input" }, move |_| {
        if point::is_carrier(slot) {
            built.with_untracked(|built| form.read_value(&built.draft));
        } else if matches!(slot, Slot::Address | Slot::Quantity) {
            form.leave_point();
        }
    });
    let field = field(app, key, label(slot), control, move || {
        built.with(|built| text.with(|text| note(app.language.get(), &built.draft, slot, text)))
    });
    if slot.is_long() { field.class("field wide") } else { field }
}

/// The value of a point, in its unit or by the names of its codes.
fn value_field(app: &'static Workbench, form: Form, chosen: &'static Point) -> El {
    const ID: &str = "builder-point-value";
    let understood = move || form.value.with(|text| point::registers_of(chosen, text));
    let control = if chosen.codes.is_empty() {
        let input = entry("input", ID, form.value, move || understood().is_none()).attr("type", "text");
        let input = input.on("input", move |_| form.write_value());
        el("span").class("with-suffix").child(input).child(el("span").class("suffix").text(&chosen.unit))
    } else {
        let options = move || form.value.with(|current| code_options(app.language.get(), chosen, current));
        list(ID, form.value, Box::new(options)).on("change", move |_| form.write_value())
    };
    let caption = el("label")
        .attr("for", ID)
        .live_text(move || app.language.get().builder_point_value(pick(app.language.get(), &chosen.name)));
    let told = move || {
        let language = app.language.get();
        let range =
            chosen.range.map(|range| [range.first, range.last].map(|end| crate::format::signed(&end.to_string())));
        match (understood(), range) {
            (None, _) => Some(Note::Wrong(language.value_misfit().to_owned())),
            (Some((value, _)), Some([first, last])) if !chosen.allows(value) => {
                Some(Note::Warning(language.value_outside(&first, &last)))
            }
            (_, Some([first, last])) => Some(Note::Hint(language.value_range(&first, &last))),
            _ => None,
        }
    };
    labelled(ID, caption, control, told)
}

fn point_options(language: Language, form: Form) -> Vec<El> {
    let points = &form.device().profile().points;
    let group = |title: &str, kind: &str, wanted: fn(&Point) -> bool| {
        let options = points.iter().filter(|found| wanted(found)).map(|found| {
            let title = [pick(language, &found.name), " \u{B7} ", &point::hex(found.register)].concat();
            option(&[kind, &found.id].concat(), &title)
        });
        el("optgroup").attr("label", title).children(options)
    };
    vec![
        option("", language.builder_no_point()),
        group(language.builder_reads(), "read:", |point| !point.read.is_empty()),
        group(language.builder_writes(), "write:", |point| !point.write.is_empty() && point.role != Role::Command),
        group(language.builder_commands(), "write:", |point| !point.write.is_empty() && point.role == Role::Command),
    ]
}

/// The codes of a point by name, and what stands there if it is none of them.
fn code_options(language: Language, of: &Point, current: &str) -> Vec<El> {
    let title = |code: &Code| {
        let name = match (&code.name, code.number) {
            (Some(name), _) => pick(language, name).to_owned(),
            (None, Some(number)) => number.to_string(),
            (None, None) => String::new(),
        };
        let unit =
            if code.number.is_some() && !of.unit.is_empty() { ["\u{A0}", &of.unit].concat() } else { String::new() };
        let digits = if code.code > 0xFF { point::hex(code.code) } else { code.code.to_string() };
        [&name, &unit, " (", &digits, ")"].concat()
    };
    let known = |code: &Code| code.code.to_string() == current;
    let unknown = !of.codes.iter().any(known);
    let listed = of.codes.iter().map(|code| option(&code.code.to_string(), &title(code)));
    let stray = unknown.then(|| option(current, current));
    listed.chain(stray).collect()
}
