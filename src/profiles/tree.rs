//! A profile's text as the form sees it: what stands at each path, as `points.0.register`, and where.

use std::collections::BTreeMap;

use nojson::{JsonValueKind, RawJson, RawJsonValue};

/// A text that is JSON, whether it makes a profile or not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tree(BTreeMap<String, Branch>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Branch {
    /// Its first byte in the text.
    at: usize,
    content: Content,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Content {
    /// A text without its quotes, or any other value as it is written.
    Plain(String),
    /// A list of so many.
    List(usize),
    Object,
}

impl Tree {
    /// The tree of a text; `None` where it is no JSON.
    pub(crate) fn of(text: &str) -> Option<Self> {
        let json = RawJson::parse(text).ok()?;
        let mut tree = Self::default();
        tree.grow("", json.value());
        Some(tree)
    }

    fn grow(&mut self, path: &str, value: RawJsonValue<'_, '_>) {
        let content = match value.kind() {
            JsonValueKind::Object => {
                for (key, member) in value.to_object().into_iter().flatten() {
                    let key = key.to_unquoted_string_str().unwrap_or_default();
                    self.grow(&join(path, &key), member);
                }
                Content::Object
            }
            JsonValueKind::Array => {
                let mut count = 0;
                for (at, item) in value.to_array().into_iter().flatten().enumerate() {
                    self.grow(&join(path, &at.to_string()), item);
                    count = at + 1;
                }
                Content::List(count)
            }
            JsonValueKind::String => Content::Plain(value.to_unquoted_string_str().unwrap_or_default().into_owned()),
            _ => Content::Plain(value.as_raw_str().to_owned()),
        };
        // Of a key that stands twice, the first counts, as where it is changed.
        self.0.entry(path.to_owned()).or_insert(Branch { at: value.position(), content });
    }

    /// The text or number at a path; empty for none.
    pub(crate) fn get(&self, path: &str) -> &str {
        match self.0.get(path).map(|branch| &branch.content) {
            Some(Content::Plain(text)) => text,
            _ => "",
        }
    }

    /// Whether anything stands at a path.
    pub(crate) fn has(&self, path: &str) -> bool {
        self.0.contains_key(path)
    }

    /// How many items the list at a path has; 0 where there is none.
    pub(crate) fn count(&self, path: &str) -> usize {
        match self.0.get(path).map(|branch| &branch.content) {
            Some(Content::List(count)) => *count,
            _ => 0,
        }
    }

    /// The texts and numbers of the list at a path.
    pub(crate) fn list(&self, path: &str) -> Vec<&str> {
        (0..self.count(path)).map(|at| self.get(&join(path, &at.to_string()))).collect()
    }

    /// The path of what begins at this byte of the text, or else of what is the nearest around it.
    pub(crate) fn path_at(&self, at: usize) -> &str {
        let begun = self.0.iter().filter(|(_, branch)| branch.at <= at);
        begun.max_by_key(|(path, branch)| (branch.at, path.len())).map_or("", |(path, _)| path)
    }
}

/// A path one step further.
pub(crate) fn join(path: &str, step: &str) -> String {
    if path.is_empty() { step.to_owned() } else { [path, ".", step].concat() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"{ "id": "a°", "points": [ { "register": "0x0010", "read": [3, 4], "primary": true }, {} ] }"#;

    #[test]
    fn everything_stands_at_its_path() {
        let tree = Tree::of(TEXT).unwrap();
        assert_eq!(
            (tree.get("id"), tree.get("points.0.register"), tree.get("points.0.primary")),
            ("a°", "0x0010", "true")
        );
        assert_eq!((tree.count("points"), tree.count("points.0.read"), tree.count("id")), (2, 2, 0));
        assert_eq!(tree.list("points.0.read"), ["3", "4"]);
        assert!(tree.has("points.1") && !tree.has("points.2") && tree.get("points").is_empty());
        assert_eq!(Tree::of("{ \"a\": 1"), None);
        assert_eq!(Tree::of("{ \"a\": 1, \"a\": 2 }").unwrap().get("a"), "1");
    }

    #[test]
    fn a_place_leads_to_its_path() {
        let tree = Tree::of(TEXT).unwrap();
        for (needle, path) in [("\"0x0010\"", "points.0.register"), ("[3", "points.0.read"), ("{ \"id\"", "")] {
            assert_eq!(tree.path_at(TEXT.find(needle).unwrap()), path);
        }
        assert_eq!(tree.path_at(TEXT.find("{}").unwrap()), "points.1");
    }
}
