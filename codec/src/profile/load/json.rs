//! JSON values that are placed where they stand: texts, numbers, lists, and objects whose keys are all known.

use alloc::borrow::Cow;
use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use nojson::{JsonParseError, RawJsonValue};

use crate::value::Decimal;

pub(super) type Node<'a> = RawJsonValue<'a, 'a>;

/// Something wrong at a byte of the text.
pub(super) struct Fault {
    pub(super) position: usize,
    pub(super) reason: String,
}

/// The fault is boxed: it is rare, and every reader carries one.
pub(super) type Found<T> = Result<T, Box<Fault>>;

pub(super) fn fault<T>(node: Node<'_>, reason: impl Into<String>) -> Found<T> {
    Err(Box::new(Fault { position: node.position(), reason: reason.into() }))
}

pub(super) fn syntax_fault(error: &JsonParseError) -> Fault {
    let reason = match error {
        JsonParseError::UnexpectedEos { .. } => "the text ends too early",
        JsonParseError::UnexpectedTrailingChar { .. } => "something follows the end of the profile",
        JsonParseError::UnexpectedValueChar { .. } => "not JSON: unexpected character",
        JsonParseError::InvalidValue { .. } => "not JSON: invalid value",
    };
    Fault { position: error.position(), reason: reason.into() }
}

/// An object whose keys are all known.
pub(super) struct Object<'a> {
    node: Node<'a>,
    members: Vec<(Cow<'a, str>, Node<'a>)>,
}

impl<'a> Object<'a> {
    pub(super) fn of(node: Node<'a>, known: &[&str]) -> Found<Self> {
        let Ok(pairs) = node.to_object() else { return fault(node, "must be an object in braces") };
        let mut members: Vec<(Cow<'a, str>, Node<'a>)> = Vec::new();
        for (key, value) in pairs {
            let Ok(name) = key.to_unquoted_string_str() else { return fault(key, "this key is no text") };
            if !known.contains(&&*name) {
                return fault(key, format!("unknown key {name}; known are {}", known.join(", ")));
            }
            if members.iter().any(|(earlier, _)| *earlier == name) {
                return fault(key, format!("the key {name} stands twice"));
            }
            members.push((name, value));
        }
        Ok(Self { node, members })
    }

    pub(super) fn find(&self, key: &str) -> Option<Node<'a>> {
        self.members.iter().find(|(name, _)| name == key).map(|(_, node)| *node)
    }

    pub(super) fn need(&self, key: &str) -> Found<Node<'a>> {
        self.find(key).map_or_else(|| fault(self.node, format!("the key {key} is missing")), Ok)
    }
}

pub(super) fn optional<'a, T: Default>(node: Option<Node<'a>>, read: impl Fn(Node<'a>) -> Found<T>) -> Found<T> {
    node.map_or_else(|| Ok(T::default()), read)
}

pub(super) fn items(node: Node<'_>) -> Found<Vec<Node<'_>>> {
    node.to_array().map_or_else(|_| fault(node, "must be a list in brackets"), |items| Ok(items.collect()))
}

pub(super) fn list<'a, T>(node: Option<Node<'a>>, read: impl Fn(Node<'a>) -> Found<T>) -> Found<Vec<T>> {
    // A plain loop: collecting results costs twice the code for each type.
    let mut all = Vec::new();
    for item in optional(node, items)? {
        all.push(read(item)?);
    }
    Ok(all)
}

/// A list that holds nothing twice.
pub(super) fn choices<'a, T: PartialEq>(node: Option<Node<'a>>, read: impl Fn(Node<'a>) -> Found<T>) -> Found<Vec<T>> {
    let mut all = Vec::new();
    for item in optional(node, items)? {
        let choice = read(item)?;
        if all.contains(&choice) {
            return fault(item, "is listed twice");
        }
        all.push(choice);
    }
    Ok(all)
}

pub(super) fn text(node: Node<'_>) -> Found<String> {
    node.to_unquoted_string_str().map_or_else(|_| fault(node, "must be a text in quotes"), |text| Ok(text.into_owned()))
}

pub(super) fn id(node: Node<'_>) -> Found<String> {
    let id = text(node)?;
    let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-' || b == b'_';
    if id.is_empty() || !id.bytes().all(plain) {
        return fault(node, "use lower-case letters, digits, - and _");
    }
    Ok(id)
}

pub(super) fn boolean(node: Node<'_>) -> Found<bool> {
    node.as_boolean_str().map_or_else(|_| fault(node, "must be true or false"), |text| Ok(text == "true"))
}

/// A whole number as a JSON number, or as the manuals print it: `"0x0030"`.
pub(super) fn integer(node: Node<'_>, most: u32) -> Found<u32> {
    let hex = || u32::from_str_radix(node.to_unquoted_string_str().ok()?.strip_prefix("0x")?, 16).ok();
    let plain = node.as_integer_str().ok().and_then(|digits| digits.parse().ok());
    let number = plain.or_else(hex).filter(|number| *number <= most);
    number.map_or_else(|| fault(node, format!("must be a whole number from 0 to {most}")), Ok)
}

pub(super) fn word(node: Node<'_>) -> Found<u16> {
    Ok(u16::try_from(integer(node, u16::MAX.into())?).unwrap_or(u16::MAX))
}

pub(super) fn small(node: Node<'_>, most: u8) -> Found<u8> {
    Ok(u8::try_from(integer(node, most.into())?).unwrap_or(most))
}

/// A number with its decimals as written, also in quotes for programs that write numbers in a way of their own.
pub(super) fn decimal(node: Node<'_>) -> Found<Decimal> {
    let quoted = || Decimal::parse(&node.to_unquoted_string_str().ok()?);
    let number = node.as_number_str().ok().and_then(Decimal::parse).or_else(quoted);
    number.map_or_else(|| fault(node, "must be a number without exponent, with at most 18 decimals"), Ok)
}

/// The place of a text among those that are allowed.
pub(super) fn one_of(node: Node<'_>, allowed: &[&str]) -> Found<usize> {
    let text = text(node)?;
    let at = allowed.iter().position(|name| *name == text);
    at.map_or_else(|| fault(node, format!("{text} is none of {}", allowed.join(", "))), Ok)
}

/// The value whose name the text is.
pub(super) fn choice<T: Copy>(node: Node<'_>, names: &[&str], values: &[T]) -> Found<T> {
    let at = one_of(node, names)?;
    values.get(at).map_or_else(|| fault(node, "is not known"), |value| Ok(*value))
}

/// Bytes in hexadecimal digits, spaces between them as one likes.
pub(super) fn hex(node: Node<'_>) -> Found<Vec<u8>> {
    let text = text(node)?;
    let digits: Option<Vec<u32>> = text.chars().filter(|c| *c != ' ').map(|c| c.to_digit(16)).collect();
    let bytes = digits.filter(|digits| digits.len() % 2 == 0).map(|digits| {
        let byte = |pair: &[u32]| pair.iter().fold(0, |byte, digit| byte << 4 | u8::try_from(*digit).unwrap_or(0));
        digits.chunks(2).map(byte).collect()
    });
    bytes.map_or_else(|| fault(node, "must be bytes in hexadecimal digits"), Ok)
}
