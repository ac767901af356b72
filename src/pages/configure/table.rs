//! The parameters: what the device holds, how it left the factory, and what is wanted instead.

use buslens_codec::profile::{Danger, Point, Role};
use buslens_codec::value::{Encoding, Value};
use buslens_configure::Snapshot;
use wasm_bindgen::JsValue;

use super::file::file_menu;
use super::state::{self, Blocked, Wish};
use super::{banner, hint};
use crate::components::button::{bare, button, icon_button};
use crate::components::icon::{Icon, icon};
use crate::configure::ending;
use crate::configure::row::{self, Held};
use crate::configure::staged::{Staged, Verdicts, factory_edits};
use crate::configure::words;
use crate::configuring::Kind;
use crate::device::Device;
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// What stands in place of the table while no device is known.
pub(super) fn empty_card(app: &'static Workbench) -> El {
    let header = el("header").child(el("h2").say(app, Language::cfg_title));
    let words = el("p").class("empty").test("configure-empty").say(app, Language::cfg_not_connected);
    el("section").class("card").child(header).child(words)
}

/// The table with its head and what is staged.
pub(super) fn parameters_card(app: &'static Workbench, device: &'static Device) -> El {
    let configure = &app.configure;
    let verdicts = Memo::new(move |_| configure.verdicts(app));
    let points: Vec<&'static Point> =
        device.profile().points.iter().filter(|point| point.role == Role::Parameter).collect();
    let card = el("section")
        .class("card cfg-parameters")
        .test("parameters")
        .child(head(app, device))
        .child(hints(app, device));
    if points.is_empty() {
        return card.child(el("p").class("empty").say(app, Language::cfg_none));
    }
    let titles: [(Label, &str); 5] = [
        (Language::cfg_point, ""),
        (Language::cfg_register, ""),
        (Language::cfg_now, "number"),
        (Language::cfg_factory, "number"),
        (Language::cfg_wanted, ""),
    ];
    let titles = titles.map(|(text, class)| el("th").attr("scope", "col").class(class).say(app, text));
    let rows = points.into_iter().map(|point| point_row(app, device, point, verdicts));
    let table = el("table")
        .class("cfg-table")
        .child(el("thead").child(el("tr").children(titles)))
        .child(el("tbody").children(rows));
    card.child(el("div").class("cfg-scroll").flag("inert", move || is_writing(app)).child(table))
        .child(staged_bar(app, verdicts))
}

/// Whether something else than a reading is under way: what is typed meanwhile would be lost behind it.
fn is_writing(app: &'static Workbench) -> bool {
    app.configuring.running.with(|running| running.as_ref().is_some_and(|running| running.kind != Kind::Read))
}

fn head(app: &'static Workbench, device: &'static Device) -> El {
    let configure = &app.configure;
    let reading = Memo::new(move |_| {
        app.configuring.running.with(|running| running.as_ref().is_some_and(|running| running.kind == Kind::Read))
    });
    let about = move || {
        let reach = app.target().map(|target| words::reach(app.language.get(), &target.reach));
        let name = device.name(app.language.get()).to_owned();
        reach.map_or(name.clone(), |reach| [&name, " \u{B7} ", &reach].concat())
    };
    let when = move || {
        let language = app.language.get();
        if reading.get() {
            return read_progress(app, language);
        }
        let taken = configure
            .held
            .with(|held| held.as_ref().filter(|held| held.profile == device.id()).map(|held| held.taken_unix_ms));
        taken.map_or_else(|| language.cfg_never_read().to_owned(), |taken| language.cfg_read_at(&time(language, taken)))
    };
    let state = move || Some(if reading.get() { "reading" } else { "still" }.to_owned());
    let stage_factory = move || {
        let have = untrack(|| configure.have(app, device.profile()));
        let edits = factory_edits(device.profile(), &have);
        configure.stage(|staged| edits.iter().for_each(|edit| staged.put_edit(device.profile(), edit, &have)));
    };
    let actions = el("div")
        .class("cfg-actions")
        .child(
            el("span")
                .class("muted cfg-when")
                .attr("role", "status")
                .test("configure-read")
                .live_attr("data-state", state)
                .live_text(when),
        )
        .child(
            icon_button(app, "quiet small", "read-again", Icon::Reset, Language::cfg_read_again)
                .flag("disabled", move || app.blocked(false).is_some())
                .live_attr("title", move || blocked_title(app))
                .click(move || configure.read(app)),
        )
        .child(
            button(app, "quiet small", "all-factory", Language::cfg_all_factory)
                .live_attr("title", move || Some(app.language.get().cfg_all_factory_hint().to_owned()))
                .click(stage_factory),
        )
        .child(file_menu(app));
    el("header")
        .child(el("h2").say(app, Language::cfg_title))
        .child(el("span").class("muted").test("configure-device").live_text(about))
        .child(actions)
}

fn blocked_title(app: &'static Workbench) -> Option<String> {
    app.blocked(false).map(|blocked| blocked.text(app.language.get()).to_owned())
}

fn read_progress(app: &'static Workbench, language: Language) -> String {
    let done = app.configuring.running.with(|running| {
        let progress = running.as_ref()?.progress.as_ref().filter(|progress| progress.total > 0)?;
        Some(language.cfg_done_of(progress.done, progress.total))
    });
    [language.cfg_reading(), " ", &done.unwrap_or_default()].concat()
}

/// The local time of day.
fn time(language: Language, unix_ms: u64) -> String {
    // Milliseconds of some thousand years fit.
    #[allow(clippy::cast_precision_loss)]
    let date = js_sys::Date::new(&JsValue::from_f64(unix_ms as f64));
    String::from(date.to_locale_time_string(language.tag()))
}

/// What stands in the way, and what is to be known.
fn hints(app: &'static Workbench, device: &'static Device) -> El {
    let configure = &app.configure;
    let blocked = Memo::new(move |_| app.blocked(true).filter(|why| *why != Blocked::Running));
    let simulated = Memo::new(move |_| app.target().is_some_and(|target| target.simulated));
    el("div").class("cfg-hints").live(move || {
        let language = app.language.get();
        let mut all = Vec::new();
        match blocked.get() {
            Some(Blocked::Closed) if configure.held.with(Option::is_some) => {
                all.push(hint("info", language.cfg_old_values()).test("configure-blocked").attr("data-why", "closed"));
            }
            Some(Blocked::ReadOnly) => {
                let allow = button(app, "small", "allow-writes", Language::cfg_allow_writes)
                    .click(move || app.console.order(buslens_analyst::line::ToLine::ReadOnly(false)));
                let line = hint("warn", language.cfg_blocked_read_only()).child(allow);
                all.push(line.test("configure-blocked").attr("data-why", "read-only"));
            }
            Some(why) => all.push(hint("info", why.text(language)).test("configure-blocked").attr("data-why", "other")),
            None => {}
        }
        if simulated.get() {
            all.push(hint("info", language.cfg_simulated()));
        }
        if let Some(fault) = app.configuring.store_fault.get() {
            all.push(hint("bad", &banner::store_fault(language, &fault)).attr("role", "alert").test("store-fault"));
        }
        all.extend(configure.read_fault.with(|ended| {
            let text = match &ended.as_ref()?.outcome {
                Err(why) => state::hindrance(language, why),
                Ok(report) => {
                    let have =
                        Snapshot::empty(device.profile(), untrack(|| configure.have(app, device.profile())).reach);
                    let told = ending::told(language, device.profile(), report, &have);
                    [told.title, ". ", &told.what, " ", told.tip.unwrap_or_default()].concat()
                }
            };
            Some(hint("bad", text.trim_end()).attr("role", "alert").test("read-fault"))
        }));
        all.extend(configure.file.with(|told| {
            let told = told.as_ref()?;
            let kind = if told.is_fault() { "bad" } else { "info" };
            Some(hint(kind, &told.text(language, device)).attr("role", "status").test("file-told"))
        }));
        all
    })
}

/// A parameter.
fn point_row(app: &'static Workbench, device: &'static Device, point: &'static Point, verdicts: Memo<Verdicts>) -> El {
    let configure = &app.configure;
    let profile = device.profile();
    let held = Memo::new(move |_| {
        let language = app.language.get();
        configure
            .held
            .with(|held| Held::of(language, profile, point, held.as_ref().filter(|held| held.profile == profile.id)))
    });
    let factory = move || {
        let have = configure.have(app, profile);
        row::factory(app.language.get(), profile, point, &have).unwrap_or_default()
    };
    // On a phone the column has no head.
    let label = move || (!factory().is_empty()).then(|| app.language.get().cfg_factory().to_owned());
    let mark = move || {
        let differs = held.with(|held| held.factory == Some(false));
        let language = app.language.get();
        differs.then(|| {
            el("i")
                .class("cfg-differs")
                .attr("title", language.cfg_differs())
                .child(el("span").class("visually-hidden").text(language.cfg_differs()))
        })
    };
    let name = el("td")
        .class("cfg-name")
        .child(el("b").live_text(move || words::pick(app.language.get(), &point.name).clone()))
        .children(danger_mark(app, row::danger(point)))
        .children(
            point
                .note
                .as_ref()
                .map(|note| el("small").live_text(move || words::pick(app.language.get(), note).clone())),
        );
    let now = el("td")
        .class("number cfg-now")
        .live_class("muted", move || held.with(|held| !held.is_value))
        .child(el("span").test("value").live_text(move || held.with(|held| held.text.clone())))
        .child(el("span").class("cfg-unit").live_text(move || held.with(|held| held.unit.clone())))
        .child(el("code").class("cfg-raw").live_text(move || held.with(|held| held.registers.clone())))
        .child(
            el("small")
                .class("cfg-about-value")
                .live_text(move || held.with(|held| held.note).unwrap_or_default().to_owned()),
        );
    let register = format!("0x{:04X}", point.register);
    el("tr")
        .test(&["parameter-", &point.id].concat())
        .state("data-changed", move || verdicts.with(|all| all.changes(&point.id)))
        .state("data-wrong", move || verdicts.with(|all| all.refusal(&point.id).is_some()))
        .child(name)
        .child(el("td").class("cfg-register").child(el("code").text(&register)))
        .child(now)
        .child(
            el("td")
                .class("number cfg-factory")
                .live_attr("data-label", label)
                .live_one(mark)
                .child(el("span").live_text(factory)),
        )
        .child(el("td").class("cfg-editor").child(editor(app, device, point, (held, verdicts))))
}

/// What a write can cost, as a mark with words.
pub(super) fn danger_mark(app: &'static Workbench, danger: Danger) -> Option<El> {
    let (class, text): (&str, Label) = match danger {
        Danger::None => return None,
        Danger::Caution => ("cfg-mark caution", Language::cfg_caution_mark),
        Danger::Danger => ("cfg-mark danger", Language::cfg_danger_mark),
    };
    let mark = el("span").class(class).attr("role", "img").label(app, text);
    Some(mark.live_attr("title", move || Some(text(app.language.get()).to_owned())).child(icon(Icon::Fault)))
}

/// Where the wanted value is chosen or typed.
fn editor(
    app: &'static Workbench,
    device: &'static Device,
    point: &'static Point,
    (held, verdicts): (Memo<Held>, Memo<Verdicts>),
) -> El {
    if point.write.is_empty() {
        return el("span").class("muted").say(app, Language::cfg_only_read);
    }
    let configure = &app.configure;
    let profile = device.profile();
    let note_id = ["cfg-note-", &point.id].concat();
    let note = move || {
        let language = app.language.get();
        let why = verdicts.with(|all| all.refusal(&point.id).map(|refusal| refusal.why.clone()));
        match why {
            Some(why) => words::unfit(language, profile, &point.id, &why),
            None if point.codes.is_empty() => held.with(|held| row::range(language, point, held)),
            None => String::new(),
        }
    };
    let control = if point.codes.is_empty() { typed(app, device, point, verdicts) } else { chosen(app, device, point) };
    let name = move || words::pick(app.language.get(), &point.name).clone();
    let control = control
        .attr("id", &["cfg-", &point.id].concat())
        .test(&["edit-", &point.id].concat())
        .attr("aria-describedby", &note_id)
        .live_attr("aria-label", move || Some(name()))
        .live_attr("aria-invalid", move || {
            verdicts.with(|all| all.refusal(&point.id).is_some()).then(|| "true".to_owned())
        });
    let is_staged = Memo::new(move |_| configure.staged.with(|staged| staged.text(&point.id).is_some()));
    let revert = move || {
        is_staged.get().then(|| {
            bare("quiet square", &["revert-", &point.id].concat())
                .live_attr("aria-label", move || Some(app.language.get().cfg_revert_names(&name())))
                .live_attr("title", move || Some(app.language.get().cfg_revert().to_owned()))
                .child(icon(Icon::Reset))
                .click(move || {
                    configure.stage(|staged| staged.revert(&point.id));
                    super::focus_on(&["cfg-", &point.id].concat());
                })
        })
    };
    el("div").class("cfg-edit").child(el("div").class("cfg-control").child(control).live_one(revert)).child(
        el("p")
            .class("note")
            .attr("id", &note_id)
            .test(&["note-", &point.id].concat())
            .live_attr("data-kind", move || {
                verdicts.with(|all| all.refusal(&point.id).is_some()).then(|| "wrong".to_owned())
            })
            .live_text(note),
    )
}

/// A list of the codes that the table knows.
fn chosen(app: &'static Workbench, device: &'static Device, point: &'static Point) -> El {
    let configure = &app.configure;
    let profile = device.profile();
    let held = Memo::new(move |_| {
        let registers = configure.held.with(|held| {
            let held = held.as_ref().filter(|held| held.profile == profile.id)?;
            held.registers(&point.id).map(<[u16]>::to_vec)
        });
        match registers.and_then(|registers| point.encoding.decode(&registers).ok()) {
            Some(Value::Code(code)) => row::typed_code(code),
            _ => String::new(),
        }
    });
    let turn = RwSignal::new(0_u32);
    el("select")
        .live(move || {
            turn.update(|turn| *turn = turn.wrapping_add(1));
            let language = app.language.get();
            let options = row::options(language, point);
            let held = held.get();
            // What the table does not know can be kept, and not chosen again.
            let unknown = !options.iter().any(|(key, _)| *key == held);
            let unknown = unknown.then(|| (held.clone(), language.cfg_unchanged().to_owned()));
            let all = unknown.into_iter().chain(options);
            all.map(|(key, label)| el("option").attr("value", &key).text(&label)).collect()
        })
        .live_value(move || {
            // New options forget what was chosen.
            turn.track();
            configure.staged.with(|staged| staged.text(&point.id).map(str::to_owned)).unwrap_or_else(|| held.get())
        })
        .on("change", move |event| {
            let value = dom::value(&event);
            let same = held.with_untracked(|held| *held == value);
            configure.stage(|staged| if same { staged.revert(&point.id) } else { staged.put(&point.id, &value) });
        })
}

/// A field for a number or a text.
fn typed(app: &'static Workbench, device: &'static Device, point: &'static Point, verdicts: Memo<Verdicts>) -> El {
    let configure = &app.configure;
    let profile = device.profile();
    // A text can be empty, a number cannot.
    let is_text = matches!(point.encoding, Encoding::Text { .. });
    let held = Memo::new(move |_| {
        configure.held.with(|held| {
            let held = held.as_ref().filter(|held| held.profile == profile.id)?;
            let registers = held.registers(&point.id)?;
            words::shown(profile, point, registers, held, |texts| words::pick(app.language.get(), texts))?.text
        })
    });
    el("input")
        .attr("type", "text")
        .attr("inputmode", if is_text { "text" } else { "decimal" })
        .attr("autocomplete", "off")
        .attr("spellcheck", "false")
        .live_value(move || {
            let staged = configure.staged.with(|staged| staged.text(&point.id).map(str::to_owned));
            staged.unwrap_or_else(|| held.get().unwrap_or_default())
        })
        .on("input", move |event| {
            let value = dom::value(&event);
            configure.stage(|staged| staged.put(&point.id, &value));
        })
        .on("change", move |event| {
            let changes = verdicts.with_untracked(|all| all.changes(&point.id) || all.refusal(&point.id).is_some());
            if !changes || !is_text && dom::value(&event).trim().is_empty() {
                configure.stage(|staged| staged.revert(&point.id));
            }
        })
}

/// How much is staged, and the way to the review.
fn staged_bar(app: &'static Workbench, verdicts: Memo<Verdicts>) -> El {
    let configure = &app.configure;
    let counts = Memo::new(move |_| verdicts.with(|all| (all.edits.len(), all.refused.len())));
    let text = move || {
        let language = app.language.get();
        let (edits, refused) = counts.get();
        let mut text = match edits {
            0 if refused == 0 => return language.cfg_staged_none().to_owned(),
            1 => language.cfg_staged_one().to_owned(),
            edits => language.cfg_staged(edits),
        };
        if refused > 0 {
            text.push_str(" \u{B7} ");
            text.push_str(&language.cfg_wrong_count(refused));
        }
        text
    };
    el("footer")
        .class("cfg-bar")
        .live_class("staged", move || counts.get() != (0, 0))
        .child(el("span").class("cfg-count").attr("role", "status").test("staged-count").live_text(text))
        .child(el("span").class("space"))
        .child(
            button(app, "quiet", "revert-all", Language::cfg_revert_all)
                .flag("disabled", move || configure.staged.with(Staged::is_empty))
                .click(move || configure.stage(Staged::clear)),
        )
        .child(
            button(app, "primary", "review", Language::cfg_review)
                .flag("disabled", move || counts.get().0 == 0 || is_writing(app))
                .click(move || configure.review(Wish::Staged)),
        )
}
