//! Lines that are kept under names, in folders; and those that the chosen profile brings.

use buslens_codec::profile::{Danger, Point, Profile, Role};
use buslens_codec::{UnitId, adu};
use wasm_bindgen_futures::{JsFuture, spawn_local};

use super::state::Console;
use crate::builder::{Draft, Way, point};
use crate::components::bring;
use crate::components::button::{bare, button, icon_button, menu};
use crate::components::icon::{Icon, icon};
use crate::console::Line;
use crate::console::snippets::{self, Fault, LONGEST_NAME, Snippet};
use crate::device::{self, Device};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::storage;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// The id of the field for a name.
pub(super) const NAME: &str = "snippet-name";

/// What a new snippet is to be called, and what went wrong.
#[derive(Clone, Copy)]
struct Form {
    name: RwSignal<String>,
    folder: RwSignal<String>,
    fault: RwSignal<Option<Fault>>,
    /// How many a file has brought.
    brought: RwSignal<Option<usize>>,
    /// What was deleted last, and can be had back.
    deleted: RwSignal<Option<Snippet>>,
    /// Which one is being renamed.
    renaming: RwSignal<Option<usize>>,
}

/// The pane.
pub(super) fn snippets_pane(app: &'static Workbench) -> El {
    let console = &app.console;
    let text = || RwSignal::new(String::new());
    let form = Form {
        name: text(),
        folder: text(),
        fault: RwSignal::new(None),
        brought: RwSignal::new(None),
        deleted: RwSignal::new(None),
        renaming: RwSignal::new(None),
    };
    el("div")
        .class("snippets")
        .test("snippets")
        .child(keep_form(app, form))
        .live_one(move || form.fault.get().map(|fault| fault_line(app.language.get(), &fault)))
        .live_one(move || {
            form.brought.get().map(|count| {
                el("p")
                    .class("form-line muted")
                    .attr("role", "status")
                    .text(&app.language.get().snippets_brought(count))
            })
        })
        .live_one(move || form.deleted.get().map(|snippet| deleted_line(app, form, snippet)))
        .child(el("div").class("contents").live(move || {
            let renaming = form.renaming.get();
            console.snippets.with(|all| own_folders(app, form, all, renaming))
        }))
        .child(el("div").class("contents").live_one(move || {
            let language = app.language.get();
            console.device().map(|device| of_profile(app, language, device))
        }))
}

/// Keeps what stands in the send line.
fn keep_form(app: &'static Workbench, form: Form) -> El {
    let console = &app.console;
    // There is no room for a label that is seen.
    let said = |id, label: Label, value| {
        name_field(app, id, label, value).live_attr("placeholder", move || Some(label(app.language.get()).to_owned()))
    };
    let folders = el("datalist").attr("id", "snippet-folders").live(move || {
        let mut folders = console.snippets.with(|all| all.iter().map(|one| one.folder.clone()).collect::<Vec<_>>());
        folders.sort();
        folders.dedup();
        folders.iter().filter(|folder| !folder.is_empty()).map(|folder| el("option").attr("value", folder)).collect()
    });
    let ready = move || {
        !form.name.with(|name| snippets::clean_name(name).is_empty())
            && !console.dock.text.with(|text| text.trim().is_empty())
    };
    let items = vec![
        el("label").class("button quiet small").attr("for", "snippet-file").say(app, Language::snippets_import),
        button(app, "quiet small", "snippets-export", Language::snippets_export)
            .flag("disabled", move || console.snippets.with(Vec::is_empty))
            .click(move || export(console)),
    ];
    el("form")
        .class("snippet-form")
        .on("submit", move |event| {
            event.prevent_default();
            let name = form.name.with_untracked(|name| snippets::clean_name(name));
            let folder = form.folder.with_untracked(|folder| snippets::clean_name(folder));
            if !name.is_empty() {
                change(console, |all| {
                    snippets::add(all, Snippet { folder, name, line: console.dock.line() });
                });
                form.name.set(String::new());
            }
        })
        .child(said(NAME, Language::snippet_name, form.name))
        .child(said("snippet-folder", Language::snippet_folder, form.folder).attr("list", "snippet-folders"))
        .child(folders)
        .child(
            button(app, "small", "snippet-save", Language::snippet_save)
                .attr("type", "submit")
                .flag("disabled", move || !ready()),
        )
        .child(file_chooser(console, form))
        .child(menu(app, "snippets-files", Language::snippets_files, items))
}

/// A field for a name or a folder.
fn name_field(app: &'static Workbench, id: &'static str, label: Label, value: RwSignal<String>) -> El {
    el("input")
        .attr("id", id)
        .test(id)
        .attr("autocomplete", "off")
        .attr("maxlength", &LONGEST_NAME.to_string())
        .label(app, label)
        .bind("input", value)
}

fn file_chooser(console: &'static Console, form: Form) -> El {
    let chooser = bring::chooser("snippet-file", move |file| {
        spawn_local(async move {
            let text = JsFuture::from(file.text()).await.ok().and_then(|text| text.as_string());
            import(console, form, &text.unwrap_or_default());
        });
    });
    chooser.attr("accept", ".json,application/json").attr("tabindex", "-1")
}

fn import(console: &Console, form: Form, text: &str) {
    form.brought.set(None);
    match snippets::read(text) {
        Ok(brought) => {
            form.fault.set(None);
            form.brought.set(Some(brought.len()));
            change(console, |all| {
                for snippet in brought {
                    snippets::add(all, snippet);
                }
            });
        }
        Err(fault) => form.fault.set(Some(fault)),
    }
}

fn export(console: &Console) {
    let text = console.snippets.with_untracked(|all| snippets::write(all));
    dom::save_text(&text, "application/json", "buslens-snippets.json");
}

/// Changes what is kept, here and for the next visit.
fn change(console: &Console, act: impl FnOnce(&mut Vec<Snippet>)) {
    console.snippets.update(act);
    storage::save("console-snippets", &console.snippets.with_untracked(|all| snippets::write(all)));
}

fn fault_line(language: Language, fault: &Fault) -> El {
    let text = match fault {
        Fault::NoJson(line) => language.snippets_no_json(*line),
        Fault::NoSnippets => language.snippets_none().to_owned(),
        Fault::Wrong(number, key) => language.snippets_wrong(*number, key),
        Fault::TooMany => language.snippets_too_many().to_owned(),
    };
    let line = el("p").class("parse-error").attr("role", "alert").test("snippets-fault");
    line.child(icon(Icon::Fault)).child(el("span").text(&text))
}

fn deleted_line(app: &'static Workbench, form: Form, snippet: Snippet) -> El {
    let told = app.language.get().snippet_deleted(&snippet.name);
    let undo = button(app, "small quiet", "snippet-undo", Language::undo).click(move || {
        change(&app.console, |all| {
            snippets::add(all, snippet.clone());
        });
        form.deleted.set(None);
    });
    el("p").class("form-line muted").attr("role", "status").child(el("span").text(&told)).child(undo)
}

/// The user's own, by folders.
fn own_folders(app: &'static Workbench, form: Form, all: &[Snippet], renaming: Option<usize>) -> Vec<El> {
    if all.is_empty() {
        return vec![el("p").class("empty").say(app, Language::snippets_empty)];
    }
    let mut folders: Vec<&str> = all.iter().map(|one| one.folder.as_str()).collect();
    folders.sort_unstable();
    folders.dedup();
    let folder = |name: &&str| {
        let title = if name.is_empty() { app.language.get().no_folder() } else { name };
        let mut inside: Vec<(usize, &Snippet)> =
            all.iter().enumerate().filter(|(_, one)| one.folder == **name).collect();
        inside.sort_by(|(_, a), (_, b)| a.name.cmp(&b.name));
        let rows = inside.into_iter().map(|(at, snippet)| {
            if renaming == Some(at) { rename_row(app, form, at, snippet) } else { own_row(app, form, at, snippet) }
        });
        el("details").class("folder").attr("open", "").child(el("summary").text(title)).children(rows)
    };
    folders.iter().map(folder).collect()
}

fn own_row(app: &'static Workbench, form: Form, at: usize, snippet: &Snippet) -> El {
    let console = &app.console;
    let gone = snippet.clone();
    let items = vec![
        button(app, "quiet small", "snippet-rename", Language::rename).click(move || {
            form.renaming.set(Some(at));
            super::panes::focus_soon("snippet-rename-name");
        }),
        button(app, "quiet small", "snippet-delete", Language::delete).click(move || {
            change(console, |all| all.retain(|one| *one != gone));
            form.deleted.set(Some(gone.clone()));
        }),
    ];
    row(app, &snippet.name, snippet.line.clone(), true).child(menu(app, "snippet-more", Language::more, items))
}

fn rename_row(app: &'static Workbench, form: Form, at: usize, snippet: &Snippet) -> El {
    let console = &app.console;
    let (name, folder) = (RwSignal::new(snippet.name.clone()), RwSignal::new(snippet.folder.clone()));
    let before = snippet.clone();
    el("form")
        .class("snippet-form")
        .on("submit", move |event| {
            event.prevent_default();
            let (name, folder) =
                (snippets::clean_name(&name.get_untracked()), snippets::clean_name(&folder.get_untracked()));
            if name.is_empty() {
                return;
            }
            form.renaming.set(None);
            change(console, |all| {
                if all.get(at) == Some(&before) {
                    let line = all.remove(at).line;
                    snippets::add(all, Snippet { folder, name, line });
                }
            });
        })
        .on("keydown", move |event| {
            if dom::key(&event) == "Escape" {
                event.stop_propagation();
                form.renaming.set(None);
            }
        })
        .child(name_field(app, "snippet-rename-name", Language::snippet_name, name))
        .child(
            name_field(app, "snippet-rename-folder", Language::snippet_folder, folder).attr("list", "snippet-folders"),
        )
        .child(button(app, "small primary", "snippet-rename-save", Language::save).attr("type", "submit"))
}

/// A line with its name: a click puts it into the send line, another sends it.
fn row(app: &'static Workbench, name: &str, line: Line, sendable: bool) -> El {
    let console = &app.console;
    let text = el("code").class("mono muted").text(&line.text);
    let loaded = line.clone();
    let load = bare("quiet snippet-load", "snippet-load")
        .attr("title", &line.text)
        .child(el("span").text(name))
        .child(text)
        .click(move || {
            console.dock.replace(loaded.clone());
            dom::focus(super::send::LINE);
        });
    let send = sendable.then(|| {
        icon_button(app, "small", "snippet-send", Icon::Go, Language::send)
            .flag("disabled", move || !console.is_open())
            .click(move || {
                console.dock.replace(line.clone());
                console.dock.send(console);
            })
    });
    el("div").class("snippet").test("snippet").child(load).children(send)
}

/// What the profile brings: a read for each group of registers, and its commands.
fn of_profile(app: &'static Workbench, language: Language, device: &'static Device) -> El {
    let console = &app.console;
    let profile = device.profile();
    let unit = UnitId(console.unit.get().unwrap_or(profile.unit));
    let mode = console.mode();
    let line = |pdu: &[u8]| adu::encode(mode, unit, pdu).map(|frame| Line::of_bytes(&frame));
    let reads = reads(language, profile).into_iter().filter_map(|(name, pdu)| Some((name, line(&pdu)?)));
    let reads: Vec<El> = reads.map(|(name, line)| row(app, &name, line, true)).collect();
    let commands = profile.points.iter().filter(|point| point.role == Role::Command && !point.write.is_empty());
    let commands = commands.filter_map(|point| {
        // A command is put into the send line only: a slip of the mouse must not carry it out.
        let row = row(app, device::pick(language, &point.name), line(&write(point)?)?, false);
        let danger = point.danger > Danger::None;
        Some(row.children(danger.then(|| el("span").class("tag warn").text(language.careful()))))
    });
    el("details")
        .class("folder")
        .attr("open", "")
        .test("snippets-of-profile")
        .child(
            el("summary")
                .child(el("span").text(device.name(language)))
                .child(el("small").class("muted").text(&language.unit_id(unit.0))),
        )
        .children(reads)
        .children(commands)
}

/// Names and PDUs of the reads.
fn reads(language: Language, profile: &Profile) -> Vec<(String, Vec<u8>)> {
    let named = profile.groups_of(&profile.points).into_iter().filter_map(|group| {
        let inside = profile.points.iter().filter(|point| group.offset_of(point).is_some());
        let names: Vec<&str> = inside.map(|point| device::pick(language, &point.name)).collect();
        let pdu = group.request()?.encode().ok()?;
        let many = names.len();
        let shown = names.into_iter().take(3).collect::<Vec<_>>().join(language.list_of_names());
        let name = if many > 3 { [&shown, language.list_of_names(), "…"].concat() } else { shown };
        Some((language.read_names(&name), pdu))
    });
    named.collect()
}

/// The PDU that carries a command out.
fn write(point: &Point) -> Option<Vec<u8>> {
    let template = point::template(point, true)?;
    let draft = Draft::of(Way::Request, Some(template.function), &|slot| {
        let text = template.texts.iter().find(|(found, _)| *found == slot);
        text.map_or_else(|| slot.default().to_owned(), |(_, text)| text.clone())
    });
    draft.whole.map(|(_, pdu)| pdu)
}

#[cfg(test)]
mod tests {
    use buslens_codec::line::Mode;

    use super::*;

    #[test]
    fn every_device_brings_reads_and_its_commands() {
        for device in device::built_in() {
            let reads = reads(Language::En, device.profile());
            assert!(!reads.is_empty(), "{}", device.id());
            for (name, pdu) in reads {
                assert!(name.starts_with("Read ") && matches!(pdu[0], 3 | 4), "{name}");
            }
            let commands = device.profile().points.iter().filter(|point| point.role == Role::Command);
            for command in commands.filter(|point| !point.write.is_empty()) {
                let line = Line::of_bytes(&adu::encode(Mode::Rtu, UnitId(1), &write(command).unwrap()).unwrap());
                assert!(line.outgoing().is_ok(), "{}", command.id);
            }
        }
    }
}
