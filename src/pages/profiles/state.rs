//! What the page knows: the user's files, the one that is shown, what the loader says of it, and how it looks to the form.

use buslens_codec::profile::{Profile, ProfileError};

use crate::device::{self, Device};
use crate::profiles::tree::Tree;
use crate::profiles::{self, File, TEMPLATE, patch};
use crate::reactive::prelude::*;
use crate::storage::{self, OWN_PROFILES, kept};

/// Bytes of a file that is read at all: no profile is a hundredth as long.
pub(super) const LONGEST_FILE: f64 = 4_000_000.0;

/// The page's state. It outlives a visit to another page.
pub(crate) struct Profiles {
    /// The user's own files.
    pub(super) own: RwSignal<Vec<File>>,
    /// Which one is shown: [`built_in_key`] or [`own_key`]; empty for none.
    pub(super) chosen: RwSignal<String>,
    /// `form` or `text`.
    pub(super) view: RwSignal<String>,
    /// The text that is shown.
    pub(super) text: Memo<String>,
    /// What the loader says of it.
    pub(super) loaded: Memo<Result<Loaded, ProfileError>>,
    /// How it looks to the form; `None` while it is no JSON.
    pub(super) tree: Memo<Option<Tree>>,
    /// The path of the fault in it.
    pub(super) fault_path: Memo<Option<String>>,
    /// The number of the point whose details are shown.
    pub(super) point: RwSignal<usize>,
    /// What came of the last action.
    pub(super) told: RwSignal<Option<Told>>,
    /// Whether the browser's storage has refused the last change.
    pub(super) refused: RwSignal<bool>,
    /// A deletion that waits for a second press.
    pub(super) asks_delete: RwSignal<bool>,
}

/// What of a profile the page needs at once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Loaded {
    pub(super) id: String,
    /// Whom the id belongs to already.
    pub(super) taken: Option<Taken>,
}

/// Who has an id already.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Taken {
    pub(super) by: Owner,
    /// One that is free.
    pub(super) free: String,
}

/// Whose id it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    BuiltIn,
    /// The user's own file with this key.
    Own(u32),
}

/// What came of an action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Told {
    /// The file of this name is too long.
    TooLong(String),
    /// The file of this name is no text.
    NoText(String),
    /// No more profiles are kept.
    TooMany,
    /// Brought in and saved: its names in English and Chinese.
    Imported([String; 2]),
    /// Deleted: it was at this place.
    Deleted(File, usize),
    /// The typed changes were dropped.
    Reverted(File),
}

/// Names a built-in profile.
pub(super) fn built_in_key(id: &str) -> String {
    ["built-in-", id].concat()
}

/// Names one of the user's own.
pub(super) fn own_key(key: u32) -> String {
    ["own-", &key.to_string()].concat()
}

fn own_number(chosen: &str) -> Option<u32> {
    chosen.strip_prefix("own-")?.parse().ok()
}

impl Profiles {
    /// With what was remembered.
    pub(crate) fn remembered() -> Self {
        let own = RwSignal::new(stored());
        let chosen = kept("profiles-chosen", "");
        let text = Memo::new(move |_| {
            chosen.with(|chosen| {
                if let Some(key) = own_number(chosen) {
                    return own.with(|all| all.iter().find(|file| file.key == key).map(|file| file.text().to_owned()));
                }
                built_in(chosen).map(|device| device.source().to_owned())
            })
        });
        let text = Memo::new(move |_| text.get().unwrap_or_default());
        let loaded = Memo::new(move |_| {
            let profile = text.with(|text| Profile::from_json(text))?;
            let mine = chosen.with(|chosen| own_number(chosen));
            let is_built_in = built_in(&chosen.get()).is_some();
            let taken = if is_built_in { None } else { own.with(|all| taken(all, mine, &profile.id)) };
            Ok(Loaded { id: profile.id, taken })
        });
        let tree = Memo::new(move |_| text.with(|text| Tree::of(text)));
        let fault_path = Memo::new(move |_| {
            let fault = loaded.with(|loaded| loaded.as_ref().err().cloned())?;
            let at = text.with(|text| profiles::offset(text, &fault));
            tree.with(|tree| tree.as_ref().map(|tree| tree.path_at(at).to_owned()))
        });
        Self {
            own,
            chosen,
            view: kept("profiles-view", "form"),
            text,
            loaded,
            tree,
            fault_path,
            point: RwSignal::new(0),
            told: RwSignal::new(None),
            refused: RwSignal::new(false),
            asks_delete: RwSignal::new(false),
        }
    }

    /// The texts that were saved, one each.
    pub(crate) fn saved(&self) -> Vec<String> {
        self.own.with(|all| all.iter().filter_map(|file| file.saved.clone()).collect())
    }

    /// Another tab has changed what is stored.
    pub(crate) fn stored_elsewhere(&self) {
        // What could not be stored is here alone.
        if !self.refused.get_untracked() {
            let all = stored();
            if self.own.with_untracked(|own| *own != all) {
                self.own.set(all);
            }
        }
    }

    // What is shown.

    pub(super) fn choose(&self, key: String) {
        self.point.set(0);
        self.asks_delete.set(false);
        self.chosen.set(key);
    }

    /// The key of what is shown; `None` where nothing is, or no more.
    pub(super) fn shown(&self) -> Option<String> {
        let is_there = self.file().is_some() || self.built_in().is_some();
        is_there.then(|| self.chosen.get())
    }

    /// The user's own file that is shown.
    pub(super) fn file(&self) -> Option<File> {
        let key = self.chosen.with(|chosen| own_number(chosen))?;
        self.own.with(|all| all.iter().find(|file| file.key == key).cloned())
    }

    /// The built-in device that is shown.
    pub(super) fn built_in(&self) -> Option<&'static Device> {
        self.chosen.with(|chosen| built_in(chosen))
    }

    /// Whether the user's own file that is shown has changes that are not saved.
    pub(super) fn is_changed(&self) -> bool {
        self.file().is_some_and(|file| file.draft.is_some())
    }

    /// Whether it can be saved.
    pub(super) fn can_save(&self) -> bool {
        self.is_changed() && self.loaded.with(|loaded| loaded.as_ref().is_ok_and(|loaded| loaded.taken.is_none()))
    }

    // Changes.

    /// Takes over what was typed, here and for the next visit.
    pub(super) fn type_text(&self, typed: &str) {
        let Some(key) = self.chosen.with_untracked(|chosen| own_number(chosen)) else { return };
        self.change(|all| {
            if let Some(file) = all.iter_mut().find(|file| file.key == key) {
                file.draft = (file.saved.as_deref() != Some(typed)).then(|| typed.to_owned());
            }
        });
    }

    /// Changes the text as the form wants it; what is no JSON stays as it is.
    pub(super) fn patch(&self, act: impl FnOnce(&str) -> Option<String>) {
        if let Some(changed) = self.text.with_untracked(|text| act(text)) {
            self.type_text(&changed);
        }
    }

    pub(super) fn save(&self) {
        let Some(mine) = untrack(|| self.file()).filter(|_| untrack(|| self.can_save())) else { return };
        self.told.set(None);
        self.change(|all| {
            if let Some(file) = all.iter_mut().find(|file| file.key == mine.key) {
                file.saved = mine.draft;
                file.draft = None;
            }
        });
    }

    /// Saves it in place of the user's own that has the same id.
    pub(super) fn save_in_place_of(&self, other: u32) {
        let Some(mine) = untrack(|| self.file()) else { return };
        self.told.set(None);
        self.change(|all| {
            if let Some(file) = all.iter_mut().find(|file| file.key == other) {
                *file = File { saved: Some(mine.text().to_owned()), draft: None, ..file.clone() };
                all.retain(|file| file.key != mine.key);
            }
        });
        self.choose(own_key(other));
    }

    /// Drops what was typed since it was saved.
    pub(super) fn revert(&self) {
        let Some(mine) = untrack(|| self.file()).filter(|file| file.saved.is_some()) else { return };
        self.change(|all| {
            if let Some(file) = all.iter_mut().find(|file| file.key == mine.key) {
                file.draft = None;
            }
        });
        self.told.set(Some(Told::Reverted(mine)));
    }

    pub(super) fn add_new(&self) {
        self.add_draft(TEMPLATE);
    }

    /// A copy under an id of its own, to be changed.
    pub(super) fn duplicate(&self) {
        let text = self.text.get_untracked();
        self.add_draft(&text);
    }

    /// Adds a text that is not saved yet, under a free id.
    fn add_draft(&self, text: &str) {
        let id = Tree::of(text).map(|tree| tree.get("id").to_owned()).unwrap_or_default();
        let free = untrack(|| self.own.with(|all| free_id(all, None, &id)));
        let draft = if free == id { None } else { numbered(text, &id, &free) };
        self.add(None, Some(draft.unwrap_or_else(|| text.to_owned())));
    }

    /// Takes a file in: saves a profile whose id is free, shows any other text with what is wrong with it.
    pub(super) fn bring(&self, name: String, text: Option<String>, too_long: bool) {
        // A text has no NULs, and what a browser could not decode holds this character.
        let Some(text) = text.filter(|text| !text.contains(['\0', char::REPLACEMENT_CHARACTER])) else {
            return self.told.set(Some(if too_long { Told::TooLong(name) } else { Told::NoText(name) }));
        };
        let text = text.strip_prefix('\u{FEFF}').unwrap_or(&text).replace("\r\n", "\n");
        let profile = Profile::from_json(&text).ok();
        let free = profile.filter(|profile| self.own.with_untracked(|all| taken(all, None, &profile.id).is_none()));
        if let Some(profile) = free {
            if self.add(Some(text), None) {
                self.told.set(Some(Told::Imported([profile.name.en, profile.name.zh])));
            }
        } else {
            self.add(None, Some(text));
            self.view.set("text".to_owned());
        }
    }

    pub(super) fn delete(&self) {
        let Some(mine) = untrack(|| self.file()) else { return };
        let mut place = 0;
        self.change(|all| {
            place = all.iter().position(|file| file.key == mine.key).unwrap_or_default();
            all.retain(|file| file.key != mine.key);
        });
        self.choose(String::new());
        self.told.set(Some(Told::Deleted(mine, place)));
    }

    /// Takes the last deletion or dropping of changes back.
    pub(super) fn undo(&self) {
        let (back, place) = match self.told.get_untracked() {
            Some(Told::Deleted(file, place)) => (file, Some(place)),
            Some(Told::Reverted(file)) => (file, None),
            _ => return,
        };
        self.told.set(None);
        let chosen = own_key(back.key);
        self.change(|all| match (all.iter_mut().find(|file| file.key == back.key), place) {
            (Some(file), None) => file.draft = back.draft,
            (None, Some(place)) => all.insert(place.min(all.len()), back),
            _ => {}
        });
        self.choose(chosen);
    }

    /// Another id for the text that is shown.
    pub(super) fn use_id(&self, id: &str) {
        self.patch(|text| patch::set(text, "id", &patch::quoted(id)));
    }

    fn add(&self, saved: Option<String>, draft: Option<String>) -> bool {
        let mut added = None;
        self.told.set(None);
        self.change(|all| added = profiles::add(all, saved, draft));
        match added {
            Some(key) => self.choose(own_key(key)),
            None => self.told.set(Some(Told::TooMany)),
        }
        added.is_some()
    }

    /// Changes the files, those that another tab may have stored meanwhile, and stores them.
    fn change(&self, act: impl FnOnce(&mut Vec<File>)) {
        let mut all = if self.refused.get_untracked() { self.own.get_untracked() } else { stored() };
        act(&mut all);
        let is_stored = if all.is_empty() {
            storage::forget(OWN_PROFILES);
            true
        } else {
            storage::is_saved(OWN_PROFILES, &profiles::write(&all))
        };
        self.own.set(all);
        if self.refused.get_untracked() == is_stored {
            self.refused.set(!is_stored);
        }
    }
}

fn stored() -> Vec<File> {
    storage::load(OWN_PROFILES).map(|kept| profiles::read(&kept)).unwrap_or_default()
}

fn built_in(chosen: &str) -> Option<&'static Device> {
    let id = chosen.strip_prefix("built-in-")?;
    device::built_in().iter().find(|device| device.id() == id)
}

/// Whom an id belongs to, other than the file of this key.
fn taken(all: &[File], mine: Option<u32>, id: &str) -> Option<Taken> {
    let by = owner(all, mine, id)?;
    Some(Taken { by, free: free_id(all, mine, id) })
}

fn owner(all: &[File], mine: Option<u32>, id: &str) -> Option<Owner> {
    if device::built_in().iter().any(|device| device.id() == id) {
        return Some(Owner::BuiltIn);
    }
    let others = all.iter().filter(|file| Some(file.key) != mine);
    let mut saved = others.filter_map(|file| Some((file.key, saved_id(file.saved.as_deref()?)?)));
    saved.find(|(_, other)| other == id).map(|(key, _)| Owner::Own(key))
}

fn free_id(all: &[File], mine: Option<u32>, id: &str) -> String {
    profiles::free_id(id, |id| owner(all, mine, id).is_some())
}

fn saved_id(text: &str) -> Option<String> {
    Some(Tree::of(text)?.get("id").to_owned())
}

/// A copy with another id, and the id's number in its names, so that the two are told apart.
fn numbered(text: &str, id: &str, free: &str) -> Option<String> {
    let mut copy = patch::set(text, "id", &patch::quoted(free))?;
    let stem = id.rsplit_once('-').filter(|(_, number)| number.parse::<u32>().is_ok()).map_or(id, |(stem, _)| stem);
    let number = free.strip_prefix(stem)?.strip_prefix('-')?;
    for path in ["name.en", "name.zh"] {
        let name = Tree::of(&copy)?.get(path).to_owned();
        let is_number = |end: &str| end.strip_suffix(')').is_some_and(|number| number.parse::<u32>().is_ok());
        let bare = name.rsplit_once(" (").filter(|(_, end)| is_number(end)).map_or(name.as_str(), |(bare, _)| bare);
        copy = patch::set(&copy, path, &patch::quoted(&[bare, " (", number, ")"].concat()))?;
    }
    Some(copy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use buslens_codec::profile::BUILT_IN;

    #[test]
    fn a_copy_has_an_id_and_names_of_its_own() {
        let profile = |text: &str| Profile::from_json(text).unwrap();
        let first = profile(BUILT_IN[0]);
        let free = free_id(&[], None, &first.id);
        let copy = numbered(BUILT_IN[0], &first.id, &free).unwrap();
        let loaded = profile(&copy);
        assert_eq!(loaded.id, [&first.id, "-2"].concat());
        assert_eq!(loaded.name.en, [&first.name.en, " (2)"].concat());
        let file = File { key: 1, saved: Some(copy.clone()), draft: None };
        let again = free_id(std::slice::from_ref(&file), None, &loaded.id);
        let again = profile(&numbered(&copy, &loaded.id, &again).unwrap());
        assert_eq!((again.id, again.name.zh), ([&first.id, "-3"].concat(), [&first.name.zh, " (3)"].concat()));
        assert_eq!(taken(std::slice::from_ref(&file), Some(1), &loaded.id), None);
        assert_eq!(taken(&[file], None, &loaded.id).unwrap().by, Owner::Own(1));
        assert_eq!(taken(&[], None, &first.id).unwrap(), Taken { by: Owner::BuiltIn, free });
    }
}
