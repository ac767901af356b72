//! Parameters as files: what differs from the device is staged, and what the device holds is saved.

use buslens_configure::{Snapshot, edits_to};
use wasm_bindgen_futures::{JsFuture, spawn_local};

use super::state::Configure;
use crate::components::bring;
use crate::components::button::{button, menu};
use crate::configure::words;
use crate::device::{self, Device};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// No file of parameters is larger, in bytes.
const LARGEST: f64 = 1_048_576.0;

/// What has come of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Told {
    /// It is too large.
    Large,
    /// The browser could not read it.
    Unreadable,
    /// It is no file of parameters.
    Fault(buslens_configure::FileFault),
    /// It is of a device with this profile.
    Other(String),
    /// The device must be read first.
    ReadFirst,
    /// So many values were staged.
    Staged {
        /// Of what file.
        name: String,
        /// How many.
        count: usize,
        /// What differs and cannot be written.
        refused: Vec<String>,
    },
}

impl Told {
    /// Whether nothing was staged though something should have been.
    pub(super) fn is_fault(&self) -> bool {
        !matches!(self, Self::Staged { .. })
    }

    /// In words.
    pub(super) fn text(&self, language: Language, device: &Device) -> String {
        match self {
            Self::Large => language.cfg_file_large().to_owned(),
            Self::Unreadable => language.cfg_file_unreadable().to_owned(),
            Self::Fault(fault) => words::file_fault(language, fault),
            Self::Other(profile) => {
                let known = device::all().into_iter().find(|device| device.id() == profile);
                language.cfg_file_other(known.map_or(profile.as_str(), |device| device.name(language)))
            }
            Self::ReadFirst => language.cfg_file_read_first().to_owned(),
            Self::Staged { name, count, refused } => {
                let names: Vec<String> =
                    refused.iter().map(|point| words::name(language, device.profile(), point)).collect();
                let cannot = (!names.is_empty()).then(|| language.cfg_file_cannot(&words::listed(language, &names)));
                match (count, cannot) {
                    (0, None) => language.cfg_file_same(name),
                    // What differs is not the same as the device.
                    (0, Some(cannot)) => cannot,
                    (count, None) => language.cfg_file_taken(*count, name),
                    (count, Some(cannot)) => [&language.cfg_file_taken(*count, name), " ", &cannot].concat(),
                }
            }
        }
    }
}

/// The menu with loading and saving, and the chooser that it opens.
pub(super) fn file_menu(app: &'static Workbench) -> El {
    let configure = &app.configure;
    let chooser = bring::chooser("configure-file", move |file| {
        let too_large = file.size() > LARGEST;
        spawn_local(async move {
            let read = if too_large { None } else { JsFuture::from(file.text()).await.ok() };
            let text = read.and_then(|text| text.as_string());
            let told = match text {
                None if too_large => Told::Large,
                None => Told::Unreadable,
                Some(text) => configure.bring(app, &file.name(), &text),
            };
            configure.file.set(Some(told));
        });
    });
    let chooser = chooser.attr("accept", ".json,application/json").attr("tabindex", "-1");
    let load = el("label").class("button quiet small").attr("for", "configure-file").say(app, Language::cfg_load);
    let save = button(app, "quiet small", "configure-save", Language::cfg_save)
        .flag("disabled", move || configure.held.with(Option::is_none))
        .click(move || configure.save());
    el("div").class("contents").child(chooser).child(menu(
        app,
        "configure-files",
        Language::cfg_files,
        vec![load, save],
    ))
}

impl Configure {
    /// Stages what a file says otherwise than the device.
    fn bring(&self, app: &'static Workbench, name: &str, text: &str) -> Told {
        let Some(device) = untrack(|| self.device(app)) else { return Told::ReadFirst };
        let profile = device.profile();
        let wanted = match Snapshot::from_json(text) {
            Ok(wanted) => wanted,
            Err(fault) => return Told::Fault(fault),
        };
        if wanted.profile != profile.id {
            return Told::Other(wanted.profile);
        }
        let have = untrack(|| self.have(app, profile));
        if have.data.is_empty() {
            return Told::ReadFirst;
        }
        let transfer = edits_to(profile, &have, &wanted, false);
        self.stage(|staged| transfer.edits.iter().for_each(|edit| staged.put_edit(profile, edit, &have)));
        let refused = transfer.refused.into_iter().map(|refusal| refusal.point).collect();
        Told::Staged { name: name.to_owned(), count: transfer.edits.len(), refused }
    }

    /// Lets the browser save what the device held when it was last read.
    fn save(&self) {
        let Some(held) = self.held.get_untracked() else { return };
        let profile = device::find(&held.profile).profile();
        let name = ["buslens-", &held.profile, "-", &held.reach.unit.0.to_string(), ".json"].concat();
        dom::save_text(&held.to_json(profile), "application/json", &name);
    }
}
