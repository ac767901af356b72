//! The user's own profiles: the texts, how they are kept on this computer, how the form changes a text.

pub(crate) mod patch;
pub(crate) mod reasons;
pub(crate) mod tree;

use buslens_codec::profile::{Profile, ProfileError};
use nojson::RawJson;

/// The most that are kept.
const MOST: usize = 200;
/// What a new profile begins with.
pub(crate) const TEMPLATE: &str = include_str!("profiles/template.json");

/// One of the user's own files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct File {
    /// Names it for as long as it is kept, whatever becomes of its text.
    pub(crate) key: u32,
    /// The text as it was last saved: a profile that loads. `None` before that.
    pub(crate) saved: Option<String>,
    /// The text as it was typed since, in whatever state.
    pub(crate) draft: Option<String>,
}

impl File {
    /// What is to be shown of it.
    pub(crate) fn text(&self) -> &str {
        self.draft.as_deref().or(self.saved.as_deref()).unwrap_or_default()
    }
}

/// All files as one text, for the browser's storage.
pub(crate) fn write(all: &[File]) -> String {
    let mut kept = String::from("[");
    for (at, file) in all.iter().enumerate() {
        for part in [if at == 0 { "" } else { "," }, "{\"key\":", &file.key.to_string()] {
            kept.push_str(part);
        }
        for (name, text) in [(",\"saved\":", &file.saved), (",\"draft\":", &file.draft)] {
            if let Some(text) = text {
                kept.push_str(name);
                buslens_codec::json::string(&mut kept, text);
            }
        }
        kept.push('}');
    }
    kept.push(']');
    kept
}

/// What [`write()`] wrote. What it cannot have written is left out.
pub(crate) fn read(kept: &str) -> Vec<File> {
    let Ok(json) = RawJson::parse(kept) else { return Vec::new() };
    let mut all: Vec<File> = Vec::new();
    for item in json.value().to_array().into_iter().flatten() {
        let mut file = File::default();
        for (name, value) in item.to_object().into_iter().flatten() {
            let text = || value.to_unquoted_string_str().ok().map(String::from);
            match name.as_raw_str() {
                "\"key\"" => file.key = value.as_raw_str().parse().unwrap_or_default(),
                "\"saved\"" => file.saved = text(),
                "\"draft\"" => file.draft = text(),
                _ => {}
            }
        }
        let is_new = all.iter().all(|earlier| earlier.key != file.key);
        if is_new && all.len() < MOST && (file.saved.is_some() || file.draft.is_some()) {
            all.push(file);
        }
    }
    all
}

/// Adds a file and returns its key; `None` where there are too many.
pub(crate) fn add(all: &mut Vec<File>, saved: Option<String>, draft: Option<String>) -> Option<u32> {
    let key = all.iter().map(|file| file.key).max().unwrap_or(0).checked_add(1)?;
    (all.len() < MOST).then(|| all.push(File { key, saved, draft }))?;
    Some(key)
}

/// The files that can be chosen as devices: each saved text with its profile. An id that is taken is left out.
pub(crate) fn devices<'a>(saved: impl IntoIterator<Item = &'a str>, taken: &[&str]) -> Vec<(String, Profile)> {
    let mut all: Vec<(String, Profile)> = Vec::new();
    for text in saved {
        let Ok(profile) = Profile::from_json(text) else { continue };
        if !taken.contains(&profile.id.as_str()) && all.iter().all(|(_, earlier)| earlier.id != profile.id) {
            all.push((text.to_owned(), profile));
        }
    }
    all
}

/// This id, or where it is taken one with a number behind it.
pub(crate) fn free_id(id: &str, is_taken: impl Fn(&str) -> bool) -> String {
    // Of `sensor-2` the next one is `sensor-3`.
    let (stem, from) = match id.rsplit_once('-') {
        Some((stem, number)) if !stem.is_empty() => number.parse().map_or((id, 1), |number: u32| (stem, number)),
        _ => (id, 1),
    };
    let stem = if stem.is_empty() { "sensor" } else { stem };
    let numbered = (from..u32::MAX).map(|number| [stem, "-", &number.saturating_add(1).to_string()].concat());
    let first = std::iter::once(id.to_owned()).filter(|id| !id.is_empty());
    first.chain(numbered).find(|id| !is_taken(id)).unwrap_or_default()
}

/// Where in the text, in bytes, a fault is that the loader tells by line and column.
pub(crate) fn offset(text: &str, fault: &ProfileError) -> usize {
    let before: usize = text.split_inclusive('\n').take(fault.line.saturating_sub(1)).map(str::len).sum();
    let line = text.get(before..).unwrap_or_default();
    let within: usize = line.chars().take(fault.column.saturating_sub(1)).map(char::len_utf8).sum();
    before + within
}

#[cfg(test)]
mod tests {
    use super::*;
    use buslens_codec::profile::BUILT_IN;

    #[test]
    fn what_is_kept_comes_back() {
        let all = vec![
            File { key: 1, saved: Some(BUILT_IN[0].to_owned()), draft: None },
            File { key: 7, saved: None, draft: Some("{ \"half\": \"位\\\u{1}\n".to_owned()) },
            File { key: 3, saved: Some(String::new()), draft: Some(String::new()) },
        ];
        assert_eq!(read(&write(&all)), all);
        for nonsense in ["", "[", "7", "[{}]", "{\"key\":1}", "[{\"key\":1}]", "[{\"key\":\"a\",\"saved\":7}]"] {
            assert!(read(nonsense).is_empty(), "{nonsense}");
        }
    }

    #[test]
    fn there_is_an_end_to_how_many_and_keys_are_unique() {
        let mut all = Vec::new();
        for _ in 0..MOST {
            assert!(add(&mut all, None, Some(String::new())).is_some());
        }
        assert_eq!(add(&mut all, None, None), None);
        let keys: std::collections::BTreeSet<u32> = all.iter().map(|file| file.key).collect();
        assert_eq!(keys.len(), MOST);
    }

    #[test]
    fn a_taken_id_gets_a_number() {
        let taken = ["a", "a-2", "b-9", "c"];
        let free = |id: &str| free_id(id, |id| taken.contains(&id));
        assert_eq!(
            ["a", "a-2", "b", "b-9", "c", "", "-"].map(free),
            ["a-3", "a-3", "b", "b-10", "c-2", "sensor-2", "-"]
        );
        assert_eq!(free_id("a-4294967295", |id| id == "a-4294967295"), "");
    }

    #[test]
    fn the_template_is_a_profile_and_ids_count_once() {
        let profile = Profile::from_json(TEMPLATE).unwrap();
        assert!(!profile.live_groups().is_empty());
        let other = TEMPLATE.replace(&profile.id, "other");
        let found = devices([TEMPLATE, "{", other.as_str(), TEMPLATE], &["other"]);
        assert_eq!(found.iter().map(|(_, profile)| profile.id.as_str()).collect::<Vec<_>>(), [profile.id.as_str()]);
    }

    #[test]
    fn a_fault_is_found_in_the_text() {
        let text = TEMPLATE.replace("\"rtu\"", "\"rtx\"").replace("\"mode\"", "  \"mode\"");
        let fault = Profile::from_json(&text).unwrap_err();
        assert!(text[offset(&text, &fault)..].starts_with("\"rtx\""), "{fault}");
        let beyond = ProfileError { line: 900, column: 9, reason: String::new() };
        assert_eq!(offset("ab\n", &beyond), 3);
    }
}
