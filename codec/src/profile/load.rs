//! Reading a profile's file. Every fault is placed by line and column, also one of meaning: a value that contradicts
//! another, a worked example that does not come out.

use alloc::borrow::Cow;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use nojson::{JsonParseError, RawJson, RawJsonValue};

use super::{
    Access, Code, Effect, Example, FORMAT, Group, Point, Profile, ProfileError, Range, Role, Table, Texts, Timing, Wire,
};
use crate::line::{DataBits, LineSettings, Mode, Parity, StopBits};
use crate::value::{Encoding, WordOrder};

pub(super) fn load(text: &str) -> Result<Profile, ProfileError> {
    let json = RawJson::parse(text).map_err(|error| place(text, syntax_fault(&error)))?;
    profile(json.value()).map_err(|fault| place(text, fault))
}

type Node<'a> = RawJsonValue<'a, 'a>;

/// Something wrong at a byte of the text.
struct Fault {
    position: usize,
    reason: String,
}

type Found<T> = Result<T, Fault>;

fn fault<T>(node: Node<'_>, reason: impl Into<String>) -> Found<T> {
    Err(Fault { position: node.position(), reason: reason.into() })
}

fn syntax_fault(error: &JsonParseError) -> Fault {
    let reason = match error {
        JsonParseError::UnexpectedEos { .. } => "the text ends too early",
        JsonParseError::UnexpectedTrailingChar { .. } => "something follows the end of the profile",
        JsonParseError::UnexpectedValueChar { .. } => "not JSON: unexpected character",
        JsonParseError::InvalidValue { .. } => "not JSON: invalid value",
    };
    Fault { position: error.position(), reason: reason.into() }
}

fn place(text: &str, fault: Fault) -> ProfileError {
    let before = text.get(..fault.position).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    ProfileError { line, column, reason: fault.reason }
}

fn profile(node: Node<'_>) -> Found<Profile> {
    let object = Object::of(
        node,
        &[
            "format",
            "id",
            "name",
            "source",
            "line",
            "mode",
            "unit",
            "units",
            "timing",
            "supply",
            "wiring",
            "points",
            "groups",
            "discovery",
            "examples",
        ],
    )?;
    let format_node = object.need("format")?;
    if integer(format_node, u32::MAX)? != FORMAT {
        return fault(format_node, format!("this program reads format {FORMAT}"));
    }
    let groups = list(object.find("groups"), group)?;
    let points_node = object.need("points")?;
    let mut points: Vec<Point> = Vec::new();
    for node in items(points_node)? {
        let point = point(node)?;
        if points.iter().any(|earlier| earlier.id == point.id) {
            return fault(node, format!("another point has the id {}", point.id));
        }
        if point.role == Role::Measurement && !groups.iter().any(|group: &Group| group.offset_of(&point).is_some()) {
            return fault(node, "no group reads this measurement");
        }
        points.push(point);
    }
    let units_node = object.need("units")?;
    let units = range(units_node, 255)?;
    Ok(Profile {
        format: FORMAT,
        id: id(object.need("id")?)?,
        name: texts(object.need("name")?)?,
        source: optional(object.find("source"), text)?,
        line: line(object.need("line")?)?,
        mode: [Mode::Rtu, Mode::Ascii][one_of(object.need("mode")?, &["rtu", "ascii"])?],
        unit: small(object.need("unit")?)?,
        units,
        timing: timing(object.need("timing")?)?,
        supply: optional(object.find("supply"), text)?,
        wiring: list(object.find("wiring"), wire)?,
        examples: list(object.find("examples"), |node| example(node, &points))?,
        points,
        groups,
        discovery: list(object.find("discovery"), group)?,
    })
}

fn line(node: Node<'_>) -> Found<LineSettings> {
    let object = Object::of(node, &["baud", "parity", "data_bits", "stop_bits"])?;
    let baud_node = object.need("baud")?;
    let baud = integer(baud_node, 100_000_000)?;
    if baud == 0 {
        return fault(baud_node, "must not be 0");
    }
    let parity = one_of(object.need("parity")?, &["none", "odd", "even"])?;
    let seven = optional(object.find("data_bits"), |node| Ok(one_of(node, &["eight", "seven"])? == 1))?;
    let two = optional(object.find("stop_bits"), |node| Ok(one_of(node, &["one", "two"])? == 1))?;
    Ok(LineSettings {
        baud,
        data_bits: if seven { DataBits::Seven } else { DataBits::Eight },
        parity: [Parity::None, Parity::Odd, Parity::Even][parity],
        stop_bits: if two { StopBits::Two } else { StopBits::One },
    })
}

fn timing(node: Node<'_>) -> Found<Timing> {
    let object = Object::of(
        node,
        &[
            "startup_silence_ms",
            "response_timeout_ms",
            "inter_device_pause_ms",
            "poll_period_ms",
            "min_poll_period_ms",
            "min_write_period_ms",
            "flash_writes",
        ],
    )?;
    // A day is longer than any of these times.
    let optional_number = |key| optional(object.find(key), |node| integer(node, 86_400_000));
    let poll_node = object.need("poll_period_ms")?;
    let poll_period_ms = integer(poll_node, 86_400_000)?;
    if poll_period_ms == 0 {
        return fault(poll_node, "must not be 0");
    }
    Ok(Timing {
        startup_silence_ms: optional_number("startup_silence_ms")?,
        response_timeout_ms: integer(object.need("response_timeout_ms")?, 60_000)?,
        inter_device_pause_ms: optional_number("inter_device_pause_ms")?,
        poll_period_ms,
        min_poll_period_ms: optional_number("min_poll_period_ms")?,
        min_write_period_ms: optional_number("min_write_period_ms")?,
        flash_writes: optional_number("flash_writes")?,
    })
}

fn wire(node: Node<'_>) -> Found<Wire> {
    let object = Object::of(node, &["color", "name", "signal", "use"])?;
    Ok(Wire {
        color: text(object.need("color")?)?,
        name: texts(object.need("name")?)?,
        signal: text(object.need("signal")?)?,
        purpose: texts(object.need("use")?)?,
    })
}

fn point(node: Node<'_>) -> Found<Point> {
    let object = Object::of(
        node,
        &[
            "id", "name", "table", "register", "encoding", "unit", "access", "role", "primary", "range", "codes",
            "factory", "danger", "effect",
        ],
    )?;
    let encoding = encoding(object.need("encoding")?)?;
    let register_node = object.need("register")?;
    let register = word(register_node)?;
    if usize::from(register) + encoding.registers() > 0x1_0000 {
        return fault(register_node, "runs over the last register");
    }
    let access = one_of(object.need("access")?, &["read", "write", "read_write"])?;
    let role = one_of(object.need("role")?, &["measurement", "parameter", "command"])?;
    let effects = ["unit", "baud", "parity", "mode", "restart"];
    let effect = object.find("effect").map(|node| one_of(node, &effects)).transpose()?;
    let mut codes: Vec<Code> = Vec::new();
    for node in object.find("codes").map(items).transpose()?.into_iter().flatten() {
        let code = code(node)?;
        if codes.iter().any(|earlier| earlier.code == code.code) {
            return fault(node, format!("the code {} stands twice", code.code));
        }
        codes.push(code);
    }
    Ok(Point {
        id: id(object.need("id")?)?,
        name: texts(object.need("name")?)?,
        table: table(object.need("table")?)?,
        register,
        encoding,
        unit: optional(object.find("unit"), text)?,
        access: [Access::Read, Access::Write, Access::ReadWrite][access],
        role: [Role::Measurement, Role::Parameter, Role::Command][role],
        primary: optional(object.find("primary"), boolean)?,
        range: object.find("range").map(|node| range(node, u16::MAX)).transpose()?,
        codes,
        factory: object.find("factory").map(word).transpose()?,
        danger: optional(object.find("danger"), boolean)?,
        effect: effect.map(|at| [Effect::Unit, Effect::Baud, Effect::Parity, Effect::Mode, Effect::Restart][at]),
    })
}

fn encoding(node: Node<'_>) -> Found<Encoding> {
    let object = Object::of(node, &["type", "decimals", "words"])?;
    let types = ["u16", "i16", "u32", "i32", "f32", "reserved_i16", "sign_magnitude_thousandths", "code"];
    let kind = one_of(object.need("type")?, &types)?;
    let decimals_node = object.find("decimals");
    let decimals = optional(decimals_node, |node| integer(node, 18))?;
    let decimals = u8::try_from(decimals).unwrap_or(0);
    let words_node = object.find("words");
    let low_first = optional(words_node, |node| Ok(one_of(node, &["high_first", "low_first"])? == 1))?;
    let words = if low_first { WordOrder::LowFirst } else { WordOrder::HighFirst };
    if let (Some(node), 4 | 6 | 7) = (decimals_node, kind) {
        return fault(node, "this type has no decimals");
    }
    if let (Some(node), 0 | 1 | 5..) = (words_node, kind) {
        return fault(node, "this type has no order of words");
    }
    Ok(match kind {
        0 => Encoding::U16 { decimals },
        1 => Encoding::I16 { decimals },
        2 => Encoding::U32 { decimals, words },
        3 => Encoding::I32 { decimals, words },
        4 => Encoding::F32 { words },
        5 => Encoding::ReservedI16 { decimals },
        6 => Encoding::SignMagnitudeThousandths,
        _ => Encoding::Code,
    })
}

fn code(node: Node<'_>) -> Found<Code> {
    let object = Object::of(node, &["code", "number", "name"])?;
    Ok(Code {
        code: word(object.need("code")?)?,
        number: object.find("number").map(|node| integer(node, u32::MAX)).transpose()?,
        name: object.find("name").map(texts).transpose()?,
    })
}

fn group(node: Node<'_>) -> Found<Group> {
    let object = Object::of(node, &["table", "address", "quantity"])?;
    let group = Group {
        table: table(object.need("table")?)?,
        address: word(object.need("address")?)?,
        quantity: word(object.need("quantity")?)?,
    };
    if group.request().is_none() {
        return fault(node, "a group is 1 to 125 input or holding registers");
    }
    Ok(group)
}

fn example(node: Node<'_>, points: &[Point]) -> Found<Example> {
    let object = Object::of(node, &["point", "registers", "text"])?;
    let example = Example {
        point: text(object.need("point")?)?,
        registers: list(object.find("registers"), word)?,
        text: text(object.need("text")?)?,
    };
    let Some(point) = points.iter().find(|point| point.id == example.point) else {
        return fault(node, format!("there is no point {}", example.point));
    };
    match point.encoding.decode(&example.registers) {
        Ok(value) => {
            let found = point.text(value, |name| &name.en);
            if found != example.text {
                return fault(node, format!("these registers are {found}, not {}", example.text));
            }
        }
        Err(error) => return fault(node, format!("these registers hold no value: {error}")),
    }
    Ok(example)
}

fn table(node: Node<'_>) -> Found<Table> {
    Ok([Table::Input, Table::Holding, Table::Coil][one_of(node, &["input", "holding", "coil"])?])
}

fn range(node: Node<'_>, most: u16) -> Found<Range> {
    let object = Object::of(node, &["first", "last"])?;
    let range = Range { first: word(object.need("first")?)?, last: word(object.need("last")?)? };
    if range.first > range.last || range.last > most {
        return fault(node, format!("must run upwards and end at {most} at most"));
    }
    Ok(range)
}

fn texts(node: Node<'_>) -> Found<Texts> {
    let object = Object::of(node, &["en", "zh"])?;
    Ok(Texts { en: text(object.need("en")?)?, zh: text(object.need("zh")?)? })
}

/// An object whose keys are all known.
struct Object<'a> {
    node: Node<'a>,
    members: Vec<(Cow<'a, str>, Node<'a>)>,
}

impl<'a> Object<'a> {
    fn of(node: Node<'a>, known: &[&str]) -> Found<Self> {
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

    fn find(&self, key: &str) -> Option<Node<'a>> {
        self.members.iter().find(|(name, _)| name == key).map(|(_, node)| *node)
    }

    fn need(&self, key: &str) -> Found<Node<'a>> {
        self.find(key).map_or_else(|| fault(self.node, format!("the key {key} is missing")), Ok)
    }
}

fn optional<'a, T: Default>(node: Option<Node<'a>>, read: impl Fn(Node<'a>) -> Found<T>) -> Found<T> {
    node.map_or_else(|| Ok(T::default()), read)
}

fn items(node: Node<'_>) -> Found<Vec<Node<'_>>> {
    node.to_array().map_or_else(|_| fault(node, "must be a list in brackets"), |items| Ok(items.collect()))
}

fn list<'a, T>(node: Option<Node<'a>>, read: impl Fn(Node<'a>) -> Found<T>) -> Found<Vec<T>> {
    optional(node, items)?.into_iter().map(read).collect()
}

fn text(node: Node<'_>) -> Found<String> {
    node.to_unquoted_string_str().map_or_else(|_| fault(node, "must be a text in quotes"), |text| Ok(text.into_owned()))
}

fn id(node: Node<'_>) -> Found<String> {
    let id = text(node)?;
    let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-' || b == b'_';
    if id.is_empty() || !id.bytes().all(plain) {
        return fault(node, "use lower-case letters, digits, - and _");
    }
    Ok(id)
}

fn boolean(node: Node<'_>) -> Found<bool> {
    node.as_boolean_str().map_or_else(|_| fault(node, "must be true or false"), |text| Ok(text == "true"))
}

fn integer(node: Node<'_>, most: u32) -> Found<u32> {
    let number = node.as_integer_str().ok().and_then(|digits| digits.parse().ok()).filter(|number| *number <= most);
    number.map_or_else(|| fault(node, format!("must be a whole number from 0 to {most}")), Ok)
}

fn word(node: Node<'_>) -> Found<u16> {
    Ok(u16::try_from(integer(node, u16::MAX.into())?).unwrap_or(u16::MAX))
}

fn small(node: Node<'_>) -> Found<u8> {
    Ok(u8::try_from(integer(node, u8::MAX.into())?).unwrap_or(u8::MAX))
}

/// The place of a text among those that are allowed.
fn one_of(node: Node<'_>, allowed: &[&str]) -> Found<usize> {
    let text = text(node)?;
    let at = allowed.iter().position(|name| *name == text);
    at.map_or_else(|| fault(node, format!("{text} is none of {}", allowed.join(", "))), Ok)
}

#[cfg(test)]
mod tests {
    use super::super::BUILT_IN;
    use super::*;

    fn line_of(needle: &str) -> usize {
        BUILT_IN[0].lines().position(|line| line.contains(needle)).unwrap() + 1
    }

    #[test]
    fn faults_name_line_and_reason() {
        let wrong = [
            ("\"mode\": \"rtu\"", "\"mode\": \"rtx\"", "\"mode\"", "rtx is none of rtu, ascii"),
            ("\"format\": 1", "\"format\": 2", "\"format\"", "reads format 1"),
            ("\"id\": \"displacement\"", "\"id\": \"temperature\"", "\"displacement\"", "another point"),
            ("\"id\": \"displacement\"", "\"id\": \"Displacement\"", "\"displacement\"", "lower-case"),
            ("\"quantity\": 4", "\"quantity\": 126", "\"quantity\": 4", "1 to 125"),
            ("\"address\": 2, \"quantity\": 4", "\"address\": 3, \"quantity\": 3", "\"temperature\"", "no group"),
            ("\"text\": \"-0.328\"", "\"text\": \"0.328\"", "\"text\": \"-0.328\"", "are -0.328, not 0.328"),
            ("\"last\": 247 },\n  \"timing\"", "\"last\": 256 },\n  \"timing\"", "\"units\"", "255 at most"),
            ("\"signal\": \"V+\"", "\"signal\": 5", "\"V+\"", "text in quotes"),
            ("\"danger\": true", "\"danger\": 1", "\"danger\"", "true or false"),
            (
                "\"type\": \"code\" }, \"unit\": \"Bd\"",
                "\"type\": \"code\", \"decimals\": 1 }",
                "\"Bd\"",
                "no decimals",
            ),
            ("\"signal\": \"A\"", "\"signl\": \"A\"", "\"A\"", "unknown key signl"),
        ];
        for (from, to, place, reason) in wrong {
            assert!(BUILT_IN[0].contains(from), "{from}");
            let error = Profile::from_json(&BUILT_IN[0].replacen(from, to, 1)).expect_err(to);
            assert!(error.reason.contains(reason), "{to}: {error}");
            assert_eq!(error.line, line_of(place), "{to}: {error}");
        }
    }

    #[test]
    fn broken_json_is_placed() {
        let error = Profile::from_json("{\n  \"format\": 1,\n  \"id\" 5\n}").unwrap_err();
        assert_eq!((error.line, error.column), (3, 8), "{error}");
        assert_eq!(Profile::from_json("{").unwrap_err().reason, "the text ends too early");
        assert_eq!(Profile::from_json("[]").unwrap_err().reason, "must be an object in braces");
    }
}
