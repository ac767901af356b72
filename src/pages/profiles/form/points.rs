//! The points: a table of all, and the fields of the chosen one.

use super::rows::{count, entries};
use super::widget::{Kind, Widget, fault_note, texts, widget};
use crate::components::button::{bare, icon_button};
use crate::components::icon::{Icon, icon};
use crate::dom::{self, El, el};
use crate::profiles::tree::{Tree, join};
use crate::profiles::{free_id, patch};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

const TYPES: &[(&str, Label)] = &[
    ("u16", |_| "u16"),
    ("i16", |_| "i16"),
    ("u32", |_| "u32"),
    ("i32", |_| "i32"),
    ("u64", |_| "u64"),
    ("i64", |_| "i64"),
    ("f32", |_| "f32"),
    ("f64", |_| "f64"),
    ("code", |_| "code"),
    ("bits", |_| "bits"),
    ("text", |_| "text"),
    ("sign_magnitude_16", |_| "sign_magnitude_16"),
    ("sign_magnitude_32", |_| "sign_magnitude_32"),
    ("sign_magnitude_64", |_| "sign_magnitude_64"),
    ("bcd_16", |_| "bcd_16"),
    ("bcd_32", |_| "bcd_32"),
    ("bcd_64", |_| "bcd_64"),
    ("reserved_i16", |_| "reserved_i16"),
    ("sign_magnitude_thousandths", |_| "sign_magnitude_thousandths"),
    ("sign_byte_magnitude", |_| "sign_byte_magnitude"),
];
const ORDERS: &[(&str, Label)] =
    &[("ABCD", |_| "ABCD"), ("CDAB", |_| "CDAB"), ("BADC", |_| "BADC"), ("DCBA", |_| "DCBA")];
const READS: &[(&str, Label)] = &[("1", |_| "01"), ("2", |_| "02"), ("3", |_| "03"), ("4", |_| "04")];
const WRITES: &[(&str, Label)] = &[("5", |_| "05"), ("6", |_| "06"), ("15", |_| "0F"), ("16", |_| "10")];
const ROLES: &[(&str, Label)] = &[
    ("measurement", Language::role_measurement),
    ("parameter", Language::role_parameter),
    ("command", Language::role_command),
];
const DANGERS: &[(&str, Label)] =
    &[("none", Language::danger_none), ("caution", Language::danger_caution), ("danger", Language::danger_danger)];
const EFFECTS: &[(&str, Label)] = &[
    ("unit", Language::effect_unit),
    ("baud", Language::effect_baud),
    ("parity", Language::effect_parity),
    ("data_bits", Language::effect_data_bits),
    ("stop_bits", Language::effect_stop_bits),
    ("mode", Language::effect_mode),
    ("restart", Language::effect_restart),
    ("defaults", Language::effect_defaults),
    ("search", Language::effect_search),
];
const REPLIES: &[(&str, Label)] =
    &[("either", Language::reply_either), ("old", Language::reply_old), ("new", Language::reply_new)];
const SETS: &[(&str, Label)] = &[
    ("none", Language::set_none),
    ("odd", Language::set_odd),
    ("even", Language::set_even),
    ("rtu", |_| "RTU"),
    ("ascii", |_| "ASCII"),
    ("seven", Language::set_seven),
    ("eight", Language::set_eight),
    ("one", Language::set_one),
    ("two", Language::set_two),
];

const PLACE: &[Widget] = &[
    Widget::new("id", Language::of_id, Kind::Word),
    Widget::new("role", Language::of_role, Kind::Choice(ROLES)),
    Widget::new("primary", Language::of_primary, Kind::Flag),
    Widget::new("register", Language::of_register, Kind::Number),
    Widget::new("read", Language::of_read, Kind::Checks(READS)),
    Widget::new("write", Language::of_write, Kind::Checks(WRITES)),
];
const MEANING: &[Widget] = &[
    Widget::new("unit", Language::of_unit, Kind::Text),
    Widget::new("unit_from", Language::of_unit_from, Kind::Point),
    Widget::new("decimals_from", Language::of_decimals_from, Kind::Point),
    Widget::new("scale", Language::of_scale, Kind::Number),
    Widget::new("offset", Language::of_offset, Kind::Number),
    Widget::new("range.first", Language::of_first, Kind::Number),
    Widget::new("range.last", Language::of_last, Kind::Number),
    Widget::new("limits_from.first", Language::of_limits_first, Kind::Point),
    Widget::new("limits_from.last", Language::of_limits_last, Kind::Point),
    Widget::new("factory", Language::of_factory, Kind::Number),
];
const WRITING: &[Widget] = &[
    Widget::new("danger", Language::of_danger, Kind::Choice(DANGERS)),
    Widget::new("reply", Language::of_reply, Kind::Choice(REPLIES)),
    Widget::new("effects", Language::of_effects, Kind::Checks(EFFECTS)),
];
const CODE: &[Widget] = &[
    Widget::new("code", Language::of_code, Kind::Number),
    Widget::new("number", Language::of_number, Kind::Number),
    Widget::new("name.en", Language::of_name, Kind::English),
    Widget::new("name.zh", Language::of_name, Kind::Chinese),
    Widget::new("sets", Language::of_sets, Kind::Choice(SETS)),
    Widget::new("danger", Language::of_danger, Kind::Choice(DANGERS)),
    Widget::new("consequence.en", Language::of_consequence, Kind::English),
    Widget::new("consequence.zh", Language::of_consequence, Kind::Chinese),
];
const ORDER: Widget = Widget::new("order", Language::of_order, Kind::Choice(ORDERS));
const DECIMALS: Widget = Widget::new("decimals", Language::of_decimals, Kind::Number);
const REGISTERS: Widget = Widget::new("registers", Language::of_registers, Kind::Number);
const MASK: Widget = Widget::new("mask", Language::of_mask, Kind::Number);
const SHIFT: Widget = Widget::new("shift", Language::of_shift, Kind::Number);

const NEW_CODE: &str = r#"{ "code": 0, "name": { "en": "", "zh": "" } }"#;

/// What belongs to a type beside its name.
fn keys_of(kind: &str) -> &'static [Widget] {
    match kind {
        "f32" | "f64" => &[ORDER],
        "code" | "sign_magnitude_thousandths" => &[],
        "bits" => &[MASK, SHIFT],
        "text" => &[REGISTERS, ORDER],
        "reserved_i16" | "sign_byte_magnitude" => &[DECIMALS],
        _ => &[DECIMALS, ORDER],
    }
}

/// The encoding of another type: the keys that belong to it stay.
fn retyped(text: &str, encoding: &str, kind: &str) -> Option<String> {
    let mut text = text.to_owned();
    let known = keys_of(kind);
    for key in [ORDER, DECIMALS, REGISTERS, MASK, SHIFT].map(|widget| widget.key) {
        if known.iter().all(|widget| widget.key != key) {
            text = patch::remove(&text, &join(encoding, key))?;
        }
    }
    let tree = Tree::of(&text)?;
    let needed = [("bits", "mask", "\"0x0001\""), ("text", "registers", "4")];
    for (_, key, value) in needed.iter().filter(|(of, key, _)| *of == kind && !tree.has(&join(encoding, key))) {
        text = patch::set(&text, &join(encoding, key), value)?;
    }
    Some(text)
}

/// The part of the form with the points.
pub(super) fn points(app: &'static Workbench) -> El {
    let count = count(app, "points".to_owned());
    let chosen = app.profiles.point;
    let shown = Memo::new(move |_| chosen.get().min(count.get().saturating_sub(1)));
    let rows = move || (0..count.get()).map(|at| row(app, at, shown)).collect();
    let head = [
        Language::of_register as Label,
        Language::of_name,
        Language::of_id,
        Language::of_encoding,
        Language::of_unit,
        Language::of_role,
        Language::of_read,
        Language::of_write,
    ];
    let head = head.map(|title| el("th").attr("scope", "col").say(app, title));
    let table = el("table")
        .class("profile-table")
        .child(el("thead").child(el("tr").children(head)))
        .child(el("tbody").live(rows));
    let summary = el("summary")
        .child(el("h3").say(app, Language::form_points))
        .child(el("span").class("muted").live_text(move || count.get().to_string()));
    el("details")
        .class("profile-section")
        .attr("open", "")
        .test("section-points")
        .child(summary)
        .child(el("div").class("scroll").child(table))
        .child(tools(app, count, shown))
        .live_one(move || {
            // Its number alone says which it is: a place in the list, whatever stands there.
            let at = shown.get();
            (at < count.get()).then(|| details(app, &join("points", &at.to_string())))
        })
}

fn row(app: &'static Workbench, at: usize, shown: Memo<usize>) -> El {
    let path = join("points", &at.to_string());
    let cell = |key: &'static str, class: &str| {
        let path = join(&path, key);
        el("td").class(class).live_text(move || of_tree(app, |tree| tree.get(&path).to_owned()))
    };
    let list = |key: &'static str, words: &'static [(&'static str, Label)]| {
        let path = join(&path, key);
        el("td").class("code").live_text(move || {
            let spelled = |word: &str| match words.iter().find(|(known, _)| *known == word) {
                Some((_, label)) => label(Language::En).to_owned(),
                None => word.to_owned(),
            };
            of_tree(app, |tree| tree.list(&path).into_iter().map(spelled).collect::<Vec<_>>().join(" "))
        })
    };
    let name = {
        let path = path.clone();
        move || {
            let end = if app.language.get() == Language::En { "name.en" } else { "name.zh" };
            of_tree(app, |tree| tree.get(&join(&path, end)).to_owned())
        }
    };
    let role = {
        let path = join(&path, "role");
        move || {
            let language = app.language.get();
            let role = of_tree(app, |tree| tree.get(&path).to_owned());
            ROLES.iter().find(|(word, _)| *word == role).map_or(role, |(_, label)| label(language).to_owned())
        }
    };
    let faulty = {
        let path = path.clone();
        move || {
            app.profiles.fault_path.with(|fault| {
                let rest = fault.as_deref().and_then(|fault| fault.strip_prefix(path.as_str()));
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
            })
        }
    };
    let choose = move || app.profiles.point.set(at);
    el("tr")
        .test("profile-point")
        .attr("tabindex", "0")
        .state("aria-selected", move || shown.get() == at)
        .live_class("faulty", faulty)
        .click(choose)
        .on("keydown", move |event| {
            if matches!(dom::key(&event).as_str(), "Enter" | " ") {
                event.prevent_default();
                choose();
            }
        })
        .child(cell("register", "code"))
        .child(el("td").live_text(name))
        .child(cell("id", "code"))
        .child(cell("encoding.type", "code"))
        .child(cell("unit", ""))
        .child(el("td").live_text(role))
        .child(list("read", READS))
        .child(list("write", WRITES))
}

fn of_tree(app: &'static Workbench, read: impl FnOnce(&Tree) -> String) -> String {
    app.profiles.tree.with(|tree| tree.as_ref().map(read)).unwrap_or_default()
}

/// What can be done with points as a whole.
fn tools(app: &'static Workbench, count: Memo<usize>, shown: Memo<usize>) -> El {
    let profiles = &app.profiles;
    let tool = |hook: &str, mark: Icon, label: Label| {
        bare("quiet small square", hook)
            .label(app, label)
            .live_attr("title", move || Some(label(app.language.get()).to_owned()))
            .child(icon(mark))
    };
    let none = move || count.get() == 0;
    let swap = move |other: usize| {
        profiles.patch(|text| patch::swap(text, "points", shown.get_untracked(), other));
        profiles.point.set(other);
    };
    el("div")
        .class("profile-tools")
        .child(icon_button(app, "small", "add-point", Icon::Plus, Language::form_add).click(move || {
            let place = count.get_untracked();
            profiles.patch(|text| patch::insert(text, "points", place, &fresh_point(text)?));
            profiles.point.set(place);
        }))
        .child(
            icon_button(app, "small", "copy-point", Icon::File, Language::profile_duplicate)
                .flag("disabled", none)
                .click(move || {
                    let at = shown.get_untracked();
                    profiles.patch(|text| duplicated(text, at));
                    profiles.point.set(at + 1);
                }),
        )
        .child(
            tool("point-up", Icon::Up, Language::form_up)
                .flag("disabled", move || shown.get() == 0)
                .click(move || swap(shown.get_untracked().saturating_sub(1))),
        )
        .child(
            tool("point-down", Icon::Down, Language::form_down)
                .flag("disabled", move || shown.get() + 1 >= count.get())
                .click(move || swap(shown.get_untracked() + 1)),
        )
        .child(tool("remove-point", Icon::Remove, Language::form_remove).flag("disabled", none).click(move || {
            let path = join("points", &shown.get_untracked().to_string());
            profiles.patch(|text| patch::remove(text, &path));
        }))
}

/// A point behind the last one, in the register after it.
fn fresh_point(text: &str) -> Option<String> {
    let tree = Tree::of(text)?;
    let id = free_point_id(&tree, "point");
    let registers =
        (0..tree.count("points")).map(|at| register(tree.get(&join(&join("points", &at.to_string()), "register"))));
    let next = registers.max().flatten().map_or(0, |last| last.saturating_add(1));
    let name = ["{ \"en\": ", &patch::quoted(&id), ", \"zh\": ", &patch::quoted(&id), " }"].concat();
    let parts = [
        "{\n      \"id\": ",
        &patch::quoted(&id),
        ", \"name\": ",
        &name,
        ", \"register\": ",
        &next.to_string(),
        ",\n      \"encoding\": { \"type\": \"u16\" }, \"read\": [3], \"role\": \"measurement\"\n    }",
    ];
    Some(parts.concat())
}

fn duplicated(text: &str, at: usize) -> Option<String> {
    let path = join("points", &at.to_string());
    let copy = patch::insert(text, "points", at + 1, patch::raw(text, &path)?)?;
    let tree = Tree::of(text)?;
    let id = free_point_id(&tree, tree.get(&join(&path, "id")));
    let path = join("points", &(at + 1).to_string());
    let copy = patch::set(&copy, &join(&path, "id"), &patch::quoted(&id))?;
    // Only one point is the most important one.
    patch::remove(&copy, &join(&path, "primary"))
}

fn free_point_id(tree: &Tree, id: &str) -> String {
    let is_taken =
        |id: &str| (0..tree.count("points")).any(|at| tree.get(&join(&join("points", &at.to_string()), "id")) == id);
    free_id(id, is_taken)
}

/// A register as profiles write them: `48` or `0x0030`.
fn register(text: &str) -> Option<u16> {
    match text.strip_prefix("0x") {
        Some(digits) => u16::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

/// The fields of a point.
fn details(app: &'static Workbench, path: &str) -> El {
    let all =
        |specs: &'static [Widget]| specs.iter().map(|spec| widget(app, join(path, spec.key), spec)).collect::<Vec<_>>();
    let encoding = join(path, "encoding");
    let kind = {
        let path = join(&encoding, "type");
        Memo::new(move |_| of_tree(app, |tree| tree.get(&path).to_owned()))
    };
    let codes = join(path, "codes");
    let has_table = {
        let codes = codes.clone();
        Memo::new(move |_| {
            let has_codes = app.profiles.tree.with(|tree| tree.as_ref().is_some_and(|tree| tree.has(&codes)));
            has_codes || kind.with(|kind| matches!(kind.as_str(), "code" | "bits"))
        })
    };
    let kind_field = {
        let encoding = encoding.clone();
        let field = widget(app, join(&encoding, "type"), &Widget::new("", Language::of_encoding, Kind::Choice(TYPES)));
        // The list has put the type into the text by then.
        field.on("change", move |_| {
            kind.with_untracked(|kind| app.profiles.patch(|text| retyped(text, &encoding, kind)));
        })
    };
    let of_kind = {
        let encoding = encoding.clone();
        move || {
            let specs = kind.with(|kind| keys_of(kind));
            specs.iter().map(|spec| widget(app, join(&encoding, spec.key), spec)).collect()
        }
    };
    let block = |content: Vec<El>| el("div").class("profile-fields").children(content);
    el("div")
        .class("profile-point")
        .test("profile-point-details")
        .child(fault_note(app, path.to_owned()))
        .child(fault_note(app, encoding.clone()))
        .child(block(all(PLACE)))
        .child(block(texts(app, &join(path, "name"), Language::of_name).into()))
        .child(el("div").class("profile-fields").child(kind_field).child(el("div").class("contents").live(of_kind)))
        .child(block(all(MEANING)))
        .child(block(texts(app, &join(path, "note"), Language::of_note).into()))
        .child(block(all(WRITING)))
        .child(block(texts(app, &join(path, "consequence"), Language::of_consequence).into()))
        .live_one(move || {
            has_table.get().then(|| {
                el("div").class("profile-codes").child(el("h4").say(app, Language::of_codes)).child(entries(
                    app,
                    codes.clone(),
                    CODE,
                    NEW_CODE,
                    "code",
                ))
            })
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profiles::TEMPLATE;
    use buslens_codec::profile::{BUILT_IN, Profile};

    #[test]
    fn a_point_that_is_added_or_copied_loads() {
        let with_one = patch::insert(TEMPLATE, "points", 1, &fresh_point(TEMPLATE).unwrap()).unwrap();
        let profile = Profile::from_json(&with_one).unwrap();
        assert_eq!((profile.points[1].id.as_str(), profile.points[1].register), ("point", 1));
        // A copy is in the same register: the loader says so until it is moved.
        let copy = duplicated(&with_one, 0).unwrap();
        let moved = patch::set(&copy, "points.1.register", "7").unwrap();
        let profile = Profile::from_json(&moved).unwrap();
        let ids: Vec<&str> = profile.points.iter().map(|point| point.id.as_str()).collect();
        assert_eq!(ids, ["value", "value-2", "point"]);
        assert!(profile.points[0].primary && !profile.points[1].primary);
    }

    #[test]
    fn every_type_loads_once_it_is_chosen_whatever_it_was_before() {
        for (before, _) in TYPES {
            for (kind, _) in TYPES {
                let mut text = TEMPLATE.to_owned();
                for kind in [before, kind] {
                    text = patch::set(&text, "points.0.encoding.type", &patch::quoted(kind)).unwrap();
                    text = retyped(&text, "points.0.encoding", kind).unwrap();
                }
                // An order of two registers would be none of one.
                let loaded = Profile::from_json(&text.replace("\"quantity\": 1", "\"quantity\": 4"));
                assert!(loaded.is_ok(), "{before} {kind}: {loaded:?}");
            }
        }
    }

    /// The words of the form are those of the loader: each stands in a built-in file or is taken where it fits.
    #[test]
    fn the_form_knows_every_word_of_the_built_in_files() {
        for text in BUILT_IN {
            let tree = Tree::of(text).unwrap();
            for at in 0..tree.count("points") {
                let path = join("points", &at.to_string());
                let known = |words: &[(&str, Label)], word: &str| words.iter().any(|(known, _)| *known == word);
                assert!(known(TYPES, tree.get(&join(&path, "encoding.type"))), "{path}");
                assert!(known(ROLES, tree.get(&join(&path, "role"))), "{path}");
                for (key, words) in [("read", READS), ("write", WRITES), ("effects", EFFECTS)] {
                    let all = tree.list(&join(&path, key));
                    assert!(all.iter().all(|word| known(words, word)), "{path} {key}: {all:?}");
                }
                for (key, words) in [("danger", DANGERS), ("reply", REPLIES), ("encoding.order", ORDERS)] {
                    let word = tree.get(&join(&path, key));
                    assert!(word.is_empty() || known(words, word), "{path} {key}: {word}");
                }
            }
        }
    }
}
