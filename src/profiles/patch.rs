//! Changes of a profile's text by the form: only what is changed changes. Whatever else the text holds, known to the form
//! or not, stays byte for byte, with its spaces and line ends.

use nojson::{JsonValueKind, RawJson, RawJsonValue};

type Value<'a> = RawJsonValue<'a, 'a>;

/// Puts a JSON value at a path as `line.baud` or `points.0.unit`; objects that are missing on the way are made. `None`
/// where the text is no JSON or the path leads through something else than objects and lists.
pub(crate) fn set(text: &str, path: &str, value: &str) -> Option<String> {
    let json = RawJson::parse(text).ok()?;
    let mut node = json.value();
    let mut rest = path;
    while !rest.is_empty() {
        let (step, further) = rest.split_once('.').unwrap_or((rest, ""));
        match child(node, step) {
            Some(found) => (node, rest) = (found, further),
            None => return append(text, node, step, &wrapped(further, value)),
        }
    }
    Some(spliced(text, node.position(), end(node), value))
}

/// Takes away what stands at a path, and with it an object of which nothing would remain. The text as it is where nothing
/// stands there.
pub(crate) fn remove(text: &str, path: &str) -> Option<String> {
    let json = RawJson::parse(text).ok()?;
    let (mut parent, mut step) = path.rsplit_once('.').unwrap_or(("", path));
    // Around an only member, the object goes too; an item of a list and the whole stay.
    while let Some(node) = at(json.value(), parent)
        && node.kind() == JsonValueKind::Object
        && node.to_object().ok()?.count() == 1
        && child(node, step).is_some()
        && let Some((grandparent, name)) = parent.rsplit_once('.').or((!parent.is_empty()).then_some(("", parent)))
        && at(json.value(), grandparent).is_some_and(|node| node.kind() == JsonValueKind::Object)
    {
        (parent, step) = (grandparent, name);
    }
    let Some(node) = at(json.value(), parent).filter(|node| child(*node, step).is_some()) else {
        return Some(text.to_owned());
    };
    let parts = parts(node);
    let place = match node.kind() {
        JsonValueKind::Array => step.parse().ok()?,
        _ => parts.iter().position(|part| part.name.as_deref() == Some(step))?,
    };
    let part = parts.get(place)?;
    let (from, to) = match (place.checked_sub(1).and_then(|before| parts.get(before)), parts.get(place + 1)) {
        (Some(before), _) => (before.end, part.end),
        (None, Some(after)) => (part.start, after.start),
        (None, None) => (node.position() + 1, end(node) - 1),
    };
    Some(spliced(text, from, to, ""))
}

/// Puts a JSON value into the list at a path, before the item at this place or at its end; makes the list if need be.
pub(crate) fn insert(text: &str, path: &str, place: usize, value: &str) -> Option<String> {
    let json = RawJson::parse(text).ok()?;
    let Some(list) = at(json.value(), path) else { return set(text, path, &["[\n    ", value, "\n  ]"].concat()) };
    let parts = parts(list);
    match parts.get(place) {
        Some(part) if list.kind() == JsonValueKind::Array => {
            let between = [value, ",", &between(text, list, &parts)].concat();
            Some(spliced(text, part.start, part.start, &between))
        }
        _ => append(text, list, &parts.len().to_string(), value),
    }
}

/// The JSON of what stands at a path.
pub(crate) fn raw<'a>(text: &'a str, path: &str) -> Option<&'a str> {
    let json = RawJson::parse(text).ok()?;
    let node = at(json.value(), path)?;
    text.get(node.position()..end(node))
}

/// Lets two items of the list at a path change places.
pub(crate) fn swap(text: &str, path: &str, one: usize, other: usize) -> Option<String> {
    let json = RawJson::parse(text).ok()?;
    let parts = parts(at(json.value(), path)?);
    let (first, second) = (parts.get(one.min(other))?, parts.get(one.max(other))?);
    if one == other {
        return Some(text.to_owned());
    }
    let (early, late) = (text.get(first.start..first.end)?, text.get(second.start..second.end)?);
    Some(spliced(&spliced(text, second.start, second.end, early), first.start, first.end, late))
}

/// What was typed as JSON: a number where it is one, else a text.
pub(crate) fn scalar(typed: &str) -> String {
    let typed = typed.trim();
    let is_number = RawJson::parse(typed).is_ok_and(|json| json.value().as_number_str().is_ok());
    if is_number { typed.to_owned() } else { quoted(typed) }
}

/// A text as JSON.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::new();
    buslens_codec::json::string(&mut out, text);
    out
}

/// A list as JSON, of items that are JSON.
pub(crate) fn listed<T: AsRef<str>>(items: impl IntoIterator<Item = T>) -> String {
    let mut out = String::from("[");
    for item in items {
        if out.len() > 1 {
            out.push_str(", ");
        }
        out.push_str(item.as_ref());
    }
    out.push(']');
    out
}

/// A member with its key, or an item: where it begins and ends.
struct Part {
    name: Option<String>,
    start: usize,
    end: usize,
}

fn parts(node: Value<'_>) -> Vec<Part> {
    let members = node.to_object().into_iter().flatten().map(|(key, value)| Part {
        name: key.to_unquoted_string_str().ok().map(String::from),
        start: key.position(),
        end: end(value),
    });
    let items = node.to_array().into_iter().flatten();
    members.chain(items.map(|item| Part { name: None, start: item.position(), end: end(item) })).collect()
}

fn end(node: Value<'_>) -> usize {
    node.position() + node.as_raw_str().len()
}

fn child<'a>(node: Value<'a>, step: &str) -> Option<Value<'a>> {
    match node.kind() {
        JsonValueKind::Object => {
            let named = |key: Value<'a>| key.to_unquoted_string_str().is_ok_and(|name| name == step);
            node.to_object().ok()?.find(|(key, _)| named(*key)).map(|(_, value)| value)
        }
        JsonValueKind::Array => node.to_array().ok()?.nth(step.parse().ok()?),
        _ => None,
    }
}

fn at<'a>(root: Value<'a>, path: &str) -> Option<Value<'a>> {
    path.split('.').filter(|step| !step.is_empty()).try_fold(root, child)
}

/// A member behind the last one, or an item at the end.
fn append(text: &str, node: Value<'_>, step: &str, value: &str) -> Option<String> {
    let parts = parts(node);
    let member = match node.kind() {
        JsonValueKind::Object => [&quoted(step), ": ", value].concat(),
        JsonValueKind::Array if step.parse() == Ok(parts.len()) => value.to_owned(),
        _ => return None,
    };
    let Some(last) = parts.last() else {
        let open = node.position() + 1;
        let lined = node.as_raw_str().contains('\n');
        let inside = if lined {
            ["\n", &indent(text, node.position()), "  ", &member, "\n", &indent(text, node.position())].concat()
        } else {
            [" ", &member, " "].concat()
        };
        return Some(spliced(text, open, end(node) - 1, &inside));
    };
    Some(spliced(text, last.end, last.end, &[",", &between(text, node, &parts), &member].concat()))
}

/// The space that this list or object has before its entries: a new line with what it is indented by, or a blank.
fn between(text: &str, node: Value<'_>, parts: &[Part]) -> String {
    let Some(first) = parts.first() else { return " ".to_owned() };
    let lead = text.get(node.position() + 1..first.start).unwrap_or_default();
    match lead.rsplit_once('\n') {
        Some((_, indent)) => ["\n", indent].concat(),
        None => " ".to_owned(),
    }
}

/// The blanks at the beginning of the line of this byte.
fn indent(text: &str, at: usize) -> String {
    let line = text.get(..at).unwrap_or_default().rsplit('\n').next().unwrap_or_default();
    line.chars().take_while(|c| *c == ' ' || *c == '\t').collect()
}

/// The value within an object for each step.
fn wrapped(steps: &str, value: &str) -> String {
    let mut all = value.to_owned();
    for step in steps.rsplit('.').filter(|step| !step.is_empty()) {
        all = if step == "0" { ["[", &all, "]"].concat() } else { ["{ ", &quoted(step), ": ", &all, " }"].concat() };
    }
    all
}

fn spliced(text: &str, from: usize, to: usize, new: &str) -> String {
    let before = text.get(..from).unwrap_or_default();
    [before, new, text.get(to..).unwrap_or_default()].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profiles::TEMPLATE;
    use crate::profiles::tree::Tree;
    use buslens_codec::profile::{BUILT_IN, Profile};

    #[test]
    fn only_what_is_set_changes() {
        let text = "{\n  \"id\": \"a\",\r\n  \"x\": [1,2],  \"line\": { \"baud\": 9600 }\n}";
        let set = |path, value| set(text, path, value).unwrap();
        assert_eq!(set("line.baud", "19200"), text.replace("9600", "19200"));
        assert_eq!(set("line.parity", "\"even\""), text.replace("9600 }", "9600, \"parity\": \"even\" }"));
        assert_eq!(set("unit", "7"), text.replace("9600 }\n", "9600 },\n  \"unit\": 7\n"));
        assert_eq!(set("range.first", "1"), text.replace("9600 }\n", "9600 },\n  \"range\": { \"first\": 1 }\n"));
        assert_eq!(set("x.1", "5"), text.replace("[1,2]", "[1,5]"));
        assert_eq!(set("x.2", "5"), text.replace("[1,2]", "[1,2, 5]"));
        assert_eq!(super::set(text, "x.7", "5"), None);
        assert_eq!(super::set(text, "id.more", "5"), None);
        assert_eq!(super::set("{", "id", "5"), None);
        assert_eq!(super::set("{}", "a.b", "5").unwrap(), "{ \"a\": { \"b\": 5 } }");
        assert_eq!(super::set("{\n}", "a", "5").unwrap(), "{\n  \"a\": 5\n}");
    }

    #[test]
    fn what_is_taken_away_leaves_no_comma_and_no_empty_object() {
        let text = "{ \"a\": 1, \"b\": { \"c\": { \"d\": 2 } }, \"e\": [ 3, 4, {\"f\": 5} ] }";
        let remove = |path| remove(text, path).unwrap();
        assert_eq!(remove("a"), text.replace("\"a\": 1, ", ""));
        assert_eq!(remove("b.c.d"), text.replace(", \"b\": { \"c\": { \"d\": 2 } }", ""));
        assert_eq!(remove("e.0"), text.replace("3, ", ""));
        assert_eq!(remove("e.2"), text.replace(", {\"f\": 5}", ""));
        assert_eq!(remove("e.2.f"), text.replace("{\"f\": 5}", "{}"));
        assert_eq!((remove("z"), remove("a.z"), remove("e.9")), (text.into(), text.into(), text.into()));
        assert_eq!(super::remove("{ \"a\": 1 }", "a").unwrap(), "{}");
        assert_eq!(super::remove("[1]", "0").unwrap(), "[]");
    }

    #[test]
    fn items_come_go_and_change_places() {
        let text = "{ \"l\": [\n    1,\n    [2]\n  ] }";
        assert_eq!(insert(text, "l", 1, "9").unwrap(), "{ \"l\": [\n    1,\n    9,\n    [2]\n  ] }");
        assert_eq!(insert(text, "l", 5, "9").unwrap(), "{ \"l\": [\n    1,\n    [2],\n    9\n  ] }");
        assert_eq!(swap(text, "l", 1, 0).unwrap(), "{ \"l\": [\n    [2],\n    1\n  ] }");
        assert_eq!((swap(text, "l", 0, 0).unwrap().as_str(), swap(text, "l", 0, 2)), (text, None));
        assert_eq!((raw(text, "l.1"), raw(text, "l.2")), (Some("[2]"), None));
        let made = insert("{ \"a\": 1 }", "l", 0, "9").unwrap();
        assert_eq!(Tree::of(&made).unwrap().list("l"), ["9"]);
        assert_eq!(insert("{ \"l\": [] }", "l", 0, "9").unwrap(), "{ \"l\": [ 9 ] }");
    }

    #[test]
    fn what_is_typed_is_a_number_or_a_text() {
        for (typed, json) in [
            ("9600", "9600"),
            (" -0.5 ", "-0.5"),
            ("0x10", "\"0x10\""),
            ("007", "\"007\""),
            ("-", "\"-\""),
            ("", "\"\""),
            ("true", "\"true\""),
            ("a\"b", "\"a\\\"b\""),
            ("1 2", "\"1 2\""),
        ] {
            assert_eq!(scalar(typed), json);
        }
        assert_eq!((listed(["1", "2"]), listed::<&str>([])), ("[1, 2]".into(), "[]".into()));
    }

    /// Every leaf of every built-in file can be set to what it is, and taken away and put back, and the file is the same
    /// profile.
    #[test]
    fn setting_what_stands_there_changes_nothing() {
        for text in BUILT_IN.iter().chain([&TEMPLATE]) {
            let profile = Profile::from_json(text).unwrap();
            for path in ["id", "line.baud", "points.0.register", "points.0.encoding", "groups.0.quantity"] {
                let value = raw(text, path).unwrap();
                assert_eq!(set(text, path, value).as_deref(), Some(*text));
                let without = remove(text, path).unwrap();
                assert!(Profile::from_json(&without).is_err(), "{path}");
                let again = set(&without, path, value).unwrap();
                assert_eq!(Profile::from_json(&again).as_ref(), Ok(&profile), "{path}");
            }
            let swapped = swap(text, "points", 0, profile.points.len() - 1).unwrap();
            assert_eq!(swap(&swapped, "points", 0, profile.points.len() - 1).as_deref(), Some(*text));
        }
    }
}
