//! Lines that are kept under names, in folders, and the file that carries them from one machine to another:
//!
//! ```json
//! {"format": "buslens-snippets", "version": 1, "snippets": [
//!   {"folder": "Level", "name": "Read value", "as": "hex", "framing": "rtu", "check": "crc", "line": "01 03 00 04 00 01"}
//! ]}
//! ```

use std::borrow::Cow;

use nojson::{RawJson, RawJsonValue};

use super::{Key, Line};

/// The most snippets in a file.
const MOST: usize = 2000;
/// The longest name of a snippet or a folder, in characters.
pub(crate) const LONGEST_NAME: usize = 80;
/// The longest line, in characters.
const LONGEST_LINE: usize = 20_000;
/// The longest file, in bytes.
const LONGEST_FILE: usize = 8 << 20;
/// What the file says it is.
const FORMAT: &str = "buslens-snippets";

/// A line with a name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Snippet {
    /// The folder; empty for none.
    pub(crate) folder: String,
    /// The name; unique in its folder.
    pub(crate) name: String,
    /// The line.
    pub(crate) line: Line,
}

/// Why a file brings nothing in. Nothing of it is taken then.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// No JSON, from this line on, counted from 1.
    NoJson(usize),
    /// JSON, but no snippets.
    NoSnippets,
    /// The snippet of this number, counted from 1, lacks this or has it wrong.
    Wrong(usize, &'static str),
    /// Too long, or too many.
    TooMany,
}

/// All snippets as a file.
pub(crate) fn write(snippets: &[Snippet]) -> String {
    let mut text = ["{\"format\": \"", FORMAT, "\", \"version\": 1, \"snippets\": ["].concat();
    for (at, Snippet { folder, name, line }) in snippets.iter().enumerate() {
        text.push_str(if at > 0 { ",\n  {" } else { "\n  {" });
        let members = [
            ("folder", folder.as_str()),
            ("name", name),
            ("as", line.writing.key()),
            ("framing", line.framing.key()),
            ("check", line.check.key()),
            ("line", &line.text),
        ];
        for (at, (key, value)) in members.into_iter().enumerate() {
            text.push_str(if at > 0 { ", \"" } else { "\"" });
            text.push_str(key);
            text.push_str("\": ");
            push_string(&mut text, value);
        }
        text.push('}');
    }
    text.push_str("\n]}\n");
    text
}

/// The snippets of a file.
pub(crate) fn read(text: &str) -> Result<Vec<Snippet>, Fault> {
    if text.len() > LONGEST_FILE {
        return Err(Fault::TooMany);
    }
    let json = RawJson::parse(text)
        .map_err(|error| Fault::NoJson(text.get(..error.position()).unwrap_or(text).matches('\n').count() + 1))?;
    let root = json.value();
    let is_ours = member(root, "format").and_then(|format| format.to_unquoted_string_str().ok());
    if is_ours.as_deref() != Some(FORMAT) || member(root, "version").is_none_or(|version| version.as_raw_str() != "1") {
        return Err(Fault::NoSnippets);
    }
    let list = member(root, "snippets").and_then(|list| list.to_array().ok()).ok_or(Fault::NoSnippets)?;
    let mut snippets: Vec<Snippet> = Vec::new();
    for node in list {
        if snippets.len() >= MOST {
            return Err(Fault::TooMany);
        }
        let snippet = snippet(node, snippets.len() + 1)?;
        add(&mut snippets, snippet);
    }
    Ok(snippets)
}

/// Adds a snippet; where its folder has another one of its name it gets a number behind it. One that is there already is
/// not added again. The name under which it is there now.
pub(crate) fn add(snippets: &mut Vec<Snippet>, snippet: Snippet) -> String {
    if snippets.contains(&snippet) {
        return snippet.name;
    }
    let name = free_name(snippets, &snippet.folder, &snippet.name);
    snippets.push(Snippet { name: name.clone(), ..snippet });
    name
}

/// A name that no other snippet of the folder has: this one, or with a number behind it.
pub(crate) fn free_name(snippets: &[Snippet], folder: &str, name: &str) -> String {
    let taken = |name: &str| snippets.iter().any(|known| known.folder == folder && known.name == name);
    let numbered = (2..).map(|number| [name, " (", &u32::to_string(&number), ")"].concat());
    std::iter::once(name.to_owned()).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
}

/// A name as it is kept: one line, without spaces around it, not too long.
pub(crate) fn clean_name(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).take(LONGEST_NAME).collect();
    plain.trim().to_owned()
}

fn snippet(node: RawJsonValue<'_, '_>, number: usize) -> Result<Snippet, Fault> {
    let text = |key: &'static str, longest: usize| {
        let text = member(node, key).and_then(|value| value.to_unquoted_string_str().ok());
        let text = text.filter(|text| text.chars().count() <= longest).ok_or(Fault::Wrong(number, key))?;
        Ok::<Cow<'_, str>, Fault>(Cow::Owned(text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()))
    };
    let name = clean_name(&text("name", LONGEST_NAME)?);
    if name.is_empty() {
        return Err(Fault::Wrong(number, "name"));
    }
    let line = Line {
        writing: Key::of(&text("as", LONGEST_NAME)?).ok_or(Fault::Wrong(number, "as"))?,
        framing: Key::of(&text("framing", LONGEST_NAME)?).ok_or(Fault::Wrong(number, "framing"))?,
        check: Key::of(&text("check", LONGEST_NAME)?).ok_or(Fault::Wrong(number, "check"))?,
        text: text("line", LONGEST_LINE)?.into_owned(),
    };
    Ok(Snippet { folder: clean_name(&text("folder", LONGEST_NAME)?), name, line })
}

/// A member of an object; the first of its name.
fn member<'a>(object: RawJsonValue<'a, 'a>, wanted: &str) -> Option<RawJsonValue<'a, 'a>> {
    let mut members = object.to_object().ok()?;
    members.find(|(key, _)| key.to_unquoted_string_str().is_ok_and(|key| key == wanted)).map(|(_, value)| value)
}

/// A text in quotes, as JSON wants it.
fn push_string(out: &mut String, text: &str) {
    out.push('"');
    for character in text.chars() {
        match character {
            '"' | '\\' => out.extend(['\\', character]),
            // No control character takes more than two digits.
            _ if character.is_control() => {
                out.push_str("\\u00");
                crate::format::push_hex(out, &[u8::try_from(u32::from(character)).unwrap_or_default()]);
            }
            _ => out.push(character),
        }
    }
    out.push('"');
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::{Check, Framing, Writing};

    fn snippet(folder: &str, name: &str, text: &str) -> Snippet {
        let line = Line { writing: Writing::Text, framing: Framing::Ascii, check: Check::Wrong, text: text.to_owned() };
        Snippet { folder: folder.to_owned(), name: name.to_owned(), line }
    }

    #[test]
    fn a_file_brings_back_what_was_written() {
        let all = vec![
            snippet("", "a", "01"),
            snippet("<img src=x onerror=alert(1)>", "\"quoted\\\" \u{1F600}", r#"\u{4E2D}"\""#),
            snippet("电平", "读数", ""),
        ];
        assert_eq!(read(&write(&all)), Ok(all));
        assert_eq!(read(&write(&[])), Ok(vec![]));
    }

    #[test]
    fn other_files_are_refused_with_a_reason() {
        assert_eq!(read("{\n\n!"), Err(Fault::NoJson(3)));
        assert_eq!(read(""), Err(Fault::NoJson(1)));
        for other in ["[]", "7", "{}", r#"{"format": "buslens-snippets", "version": 2, "snippets": []}"#] {
            assert_eq!(read(other), Err(Fault::NoSnippets), "{other}");
        }
        let file = |member: &str| {
            let rest = r#""as": "hex", "framing": "rtu", "check": "crc", "line": "01""#;
            format!(r#"{{"format": "buslens-snippets", "version": 1, "snippets": [{{{member}, {rest}}}]}}"#)
        };
        assert_eq!(read(&file(r#""folder": """#)), Err(Fault::Wrong(1, "name")));
        assert_eq!(read(&file(r#""folder": "", "name": " ""#)), Err(Fault::Wrong(1, "name")));
        assert_eq!(read(&file(r#""folder": 5, "name": "a""#)), Err(Fault::Wrong(1, "folder")));
        assert_eq!(read(&file(r#""folder": "", "name": "a", "as": "octal""#)), Err(Fault::Wrong(1, "as")));
        let long = format!(r#""folder": "", "name": "{}""#, "x".repeat(81));
        assert_eq!(read(&file(&long)), Err(Fault::Wrong(1, "name")));
    }

    #[test]
    fn there_is_an_end_to_how_many() {
        let many = |count: usize| (0..count).map(|at| snippet("", &at.to_string(), "")).collect::<Vec<_>>();
        assert_eq!(read(&write(&many(MOST))).map(|all| all.len()), Ok(MOST));
        assert_eq!(read(&write(&many(MOST + 1))), Err(Fault::TooMany));
    }

    #[test]
    fn line_ends_in_names_do_not_get_far() {
        let text = write(&[snippet("a\nb", " c\u{7}d ", "01\n02")]);
        let back = read(&text).unwrap();
        assert_eq!(
            (back[0].folder.as_str(), back[0].name.as_str(), back[0].line.text.as_str()),
            ("a b", "c d", "01 02")
        );
    }

    #[test]
    fn names_are_unique_in_their_folder() {
        let mut all = vec![snippet("", "a", "01")];
        assert_eq!(add(&mut all, snippet("", "a", "01")), "a");
        assert_eq!(add(&mut all, snippet("", "a", "02")), "a (2)");
        assert_eq!(add(&mut all, snippet("", "a", "03")), "a (3)");
        assert_eq!(add(&mut all, snippet("b", "a", "01")), "a");
        assert_eq!(all.len(), 4);
    }
}
