//! Sequences: written, checked and run here; the console's worker reads and carries them out.

mod editor;
mod state;
mod steps;
mod words;

use buslens_sequence::{READY, Verdict, outline};
use wasm_bindgen_futures::{JsFuture, spawn_local};

use super::compact;
use crate::components::bring;
use crate::components::button::{button, icon_button, menu};
use crate::components::icon::{Icon, icon};
use crate::console::sequences::{LONGEST_NAME, file_name};
use crate::device::{self, Device};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;
pub(crate) use state::Sequences;
use state::{Told, own_key, ready_key};

/// The pane.
pub(super) fn sequence_pane(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    // Whatever the text is checked by may have changed while another pane was open.
    let device = Memo::new(move |_| sequences.device(&app.console).map(Device::id));
    dom::react(move || {
        sequences.text.track();
        device.track();
        sequences.check(&app.console);
    });
    el("div")
        .class("sequence")
        .test("sequence")
        .child(
            el("div")
                .class("seq-head")
                .child(choice(app))
                .live_one(move || sequences.renaming.get().then(|| rename_form(app)))
                .live_one(move || sequences.told.get().map(|told| told_line(app, told)))
                .child(run_row(app))
                .child(hints(app)),
        )
        .live_one(move || {
            let content = if sequences.shows_steps.get() { steps::steps(app) } else { editor::editor(app) };
            Some(content)
        })
}

/// Runs the sequence if nothing stands in the way; what can lose the device's settings is asked about before.
pub(super) fn run(app: &'static Workbench) {
    app.console.sequences.run(&app.console, app.language.get_untracked(), false);
}

/// Stops it.
pub(super) fn stop(app: &'static Workbench) {
    app.console.sequences.stop(&app.console);
}

/// Which sequence, and what can be done with it.
fn choice(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    let group = |label: &str, options: Vec<El>| el("optgroup").attr("label", label).children(options);
    let option = |key: &str, label: &str| el("option").attr("value", key).text(label);
    let turn = RwSignal::new(0_u32);
    let list = el("select")
        .attr("id", "sequence-choice")
        .test("sequence-choice")
        .label(app, Language::seq_choose)
        .live(move || {
            turn.update(|turn| *turn = turn.wrapping_add(1));
            let language = app.language.get();
            let ready = READY.iter().enumerate().map(|(at, text)| {
                let (id, title) = outline(text);
                let device = device::all().iter().find(|device| Some(device.id()) == id);
                let named = device.map(|device| language.seq_acceptance(device.name(language)));
                option(&ready_key(at), named.as_deref().or(title).unwrap_or_default())
            });
            let ready = group(language.seq_ready(), ready.collect());
            let own = sequences.own.with(|all| {
                let options: Vec<El> = all.iter().map(|own| option(&own_key(&own.name), &own.name)).collect();
                (!options.is_empty()).then(|| group(language.seq_own(), options))
            });
            own.into_iter().chain([ready]).collect()
        })
        .live_value(move || {
            // New options forget what was chosen.
            turn.track();
            sequences.chosen.get()
        })
        .on("change", move |event| sequences.choose(dom::value(&event)));
    let is_fixed = move || sequences.is_ready_made();
    let items = vec![
        button(app, "quiet small", "sequence-duplicate", Language::seq_duplicate).click(move || sequences.duplicate()),
        button(app, "quiet small", "sequence-rename", Language::seq_rename).flag("disabled", is_fixed).click(
            move || {
                sequences.renaming.set(true);
                super::panes::focus_soon("sequence-name");
            },
        ),
        button(app, "quiet small", "sequence-delete", Language::seq_delete)
            .flag("disabled", is_fixed)
            .click(move || sequences.delete()),
        el("label").class("button quiet small").attr("for", "sequence-file").say(app, Language::seq_import),
        button(app, "quiet small", "sequence-export", Language::seq_export).click(move || {
            let (name, text) = (sequences.name(), sequences.text.get_untracked());
            dom::save_text(&text, "text/plain", &[&file_name(&name), ".txt"].concat());
        }),
    ];
    let new = button(app, "small", "sequence-new", Language::seq_new)
        .click(move || sequences.add_new(app.language.get_untracked()));
    el("div").class("seq-choice").child(list).child(new).child(file_chooser(app)).child(menu(
        app,
        "sequence-manage",
        Language::seq_manage,
        items,
    ))
}

fn file_chooser(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    let chooser = bring::chooser("sequence-file", move |file| {
        // Beyond this no text is read at all.
        let too_long = file.size() > state::LONGEST_FILE;
        spawn_local(async move {
            let read = if too_long { None } else { JsFuture::from(file.text()).await.ok() };
            let text = read.and_then(|text| text.as_string());
            sequences.bring(&file.name(), text, too_long);
        });
    });
    chooser.attr("accept", ".txt,text/plain").attr("tabindex", "-1")
}

fn rename_form(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    let name = RwSignal::new(sequences.name());
    el("form")
        .class("seq-rename")
        .on("submit", move |event| {
            event.prevent_default();
            sequences.rename(&name.get_untracked());
        })
        .on("keydown", move |event| {
            if dom::key(&event) == "Escape" {
                event.stop_propagation();
                sequences.renaming.set(false);
            }
        })
        .child(
            el("input")
                .attr("id", "sequence-name")
                .test("sequence-name")
                .attr("autocomplete", "off")
                .attr("maxlength", &LONGEST_NAME.to_string())
                .label(app, Language::seq_name)
                .bind("input", name),
        )
        .child(button(app, "small primary", "sequence-rename-save", Language::save).attr("type", "submit"))
        .child(
            button(app, "small quiet", "sequence-rename-cancel", Language::cancel)
                .click(move || sequences.renaming.set(false)),
        )
}

/// What came of a change of the list.
fn told_line(app: &'static Workbench, told: Told) -> El {
    let sequences = &app.console.sequences;
    let language = app.language.get();
    match told {
        Told::TooLong | Told::NoText | Told::Busy => {
            let words = match told {
                Told::TooLong => language.seq_too_long(),
                Told::NoText => language.seq_no_text(),
                _ => language.seq_busy(),
            };
            let line = el("p").class("parse-error").attr("role", "alert").test("sequence-told");
            line.child(icon(Icon::Fault)).child(el("span").text(words))
        }
        Told::Deleted(own) => {
            let words = language.seq_deleted(&own.name);
            let undo = button(app, "small quiet", "sequence-undo", Language::undo).click(move || sequences.put_back());
            el("p").class("form-line muted").attr("role", "status").child(el("span").text(&words)).child(undo)
        }
    }
}

/// Run and stop, the two views, and how the last run stands.
fn run_row(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    let running = Memo::new(move |_| sequences.is_running());
    let view = move || if sequences.shows_steps.get() { "steps" } else { "text" };
    let verdict = Memo::new(move |_| {
        sequences
            .summary
            .with(|summary| summary.as_ref().map(|summary| (summary.verdict, summary.passed, summary.failed)))
    });
    el("div")
        .class("seq-run")
        .live_one(move || {
            Some(if running.get() {
                icon_button(app, "small danger", "sequence-stop", Icon::Stop, Language::seq_stop)
                    .click(move || stop(app))
            } else {
                icon_button(app, "small primary", "sequence-run", Icon::Play, Language::seq_run)
                    .live_attr("title", move || Some(app.language.get().seq_run_hint().to_owned()))
                    .flag("disabled", move || !sequences.can_run(&app.console))
                    .click(move || run(app))
            })
        })
        .child(compact::tabs(
            app,
            Language::seq_choose,
            "sequence-view",
            view,
            move |key| sequences.shows_steps.set(key == "steps"),
            [("text", Language::seq_text_tab), ("steps", Language::seq_steps_tab)],
        ))
        .live_one(move || {
            let (verdict, passed, failed) = verdict.get()?;
            let language = app.language.get();
            let state = match verdict {
                Verdict::Passed => "reading",
                Verdict::Failed => "failed",
                Verdict::Running | Verdict::Incomplete => "waiting",
            };
            let counts = [passed.to_string(), failed.to_string()].join(" / ");
            Some(
                el("span")
                    .class("seq-verdict")
                    .attr("role", "status")
                    .attr("title", &language.seq_counts(passed, failed))
                    .child(
                        el("span")
                            .class("tag")
                            .test("sequence-verdict")
                            .attr("data-state", state)
                            .text(words::verdict(language, verdict)),
                    )
                    .child(el("small").class("muted").text(&counts)),
            )
        })
}

/// What stands in the way of a run, or is to be known before it.
fn hints(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    let console = &app.console;
    let closed = Memo::new(move |_| !console.is_open());
    let read_only = Memo::new(move |_| console.line.with(|line| line.as_ref().is_some_and(|line| line.read_only)));
    let line = |kind: &str, text: &str| el("p").class("seq-hint").attr("data-kind", kind).text(text);
    el("div").class("contents").live(move || {
        let language = app.language.get();
        let mut all = Vec::new();
        if sequences.is_running() {
            return all;
        }
        if closed.get() {
            all.push(line("info", language.seq_closed()));
        }
        if let Some((wanted, found)) = sequences.other_device(console) {
            all.push(line("warn", &language.seq_other_device(wanted.name(language), found.name(language))));
        }
        let (grave, cautions) = sequences.cautions();
        if sequences.asks.get() {
            let ask = line("bad", &language.seq_grave(&grave)).attr("role", "alert").test("sequence-ask");
            let go = button(app, "small danger", "sequence-run-anyway", Language::seq_run_anyway)
                .click(move || sequences.run(console, app.language.get_untracked(), true));
            let not = button(app, "small quiet", "sequence-run-not", Language::cancel)
                .click(move || sequences.asks.set(false));
            all.push(ask.child(el("span").class("seq-answers").child(go).child(not)));
        } else if !cautions.is_empty() {
            all.push(line("warn", &language.seq_cautions(&cautions)));
            if read_only.get() {
                all.push(line("warn", language.seq_read_only()));
            }
        }
        all
    })
}
