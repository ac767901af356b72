//! Reading a profile's file. Every fault is placed by line and column, also one of meaning: a value that contradicts
//! another, a worked example that does not come out.

mod json;
mod point;

use alloc::format;
use alloc::vec;
use alloc::vec::Vec;

use nojson::RawJson;

use self::json::{
    Fault, Found, Node, Object, boolean, choice, fault, hex, id, integer, list, optional, small, syntax_fault, text,
    word,
};
use super::{
    Choices, Erratum, Example, FORMAT, Group, Help, Interface, Known, Point, Profile, ProfileError, Range, Texts,
    Timing, Wire,
};
use crate::line::{DataBits, LineSettings, Mode, Parity, StopBits};
use crate::value::{Decimal, Value};

pub(super) fn load(text: &str) -> Result<Profile, ProfileError> {
    let json = RawJson::parse(text).map_err(|error| place(text, syntax_fault(&error)))?;
    profile(json.value()).map_err(|fault| place(text, *fault))
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
            "notes",
            "interface",
            "line",
            "mode",
            "choices",
            "unit",
            "units",
            "timing",
            "supply",
            "wiring",
            "points",
            "groups",
            "discovery",
            "fingerprint",
            "examples",
            "errata",
            "help",
        ],
    )?;
    let format_node = object.need("format")?;
    if integer(format_node, u32::MAX)? != FORMAT {
        return fault(format_node, format!("this program reads format {FORMAT}"));
    }
    let points = point::points(object.need("points")?)?;
    let units = range(object.need("units")?, 255)?;
    let unit_node = object.need("unit")?;
    let unit = small(unit_node, u8::MAX)?;
    if !units.contains(unit.into()) {
        return fault(unit_node, "is none of the units");
    }
    let profile = Profile {
        format: FORMAT,
        id: id(object.need("id")?)?,
        name: texts(object.need("name")?)?,
        source: optional(object.find("source"), text)?,
        notes: list(object.find("notes"), texts)?,
        interface: optional(object.find("interface"), |node| {
            choice(node, &["rs485", "rs232"], &[Interface::Rs485, Interface::Rs232])
        })?,
        line: line(object.need("line")?)?,
        mode: mode(object.need("mode")?)?,
        choices: optional(object.find("choices"), choices)?,
        unit,
        units,
        timing: timing(object.need("timing")?)?,
        supply: optional(object.find("supply"), text)?,
        wiring: list(object.find("wiring"), wire)?,
        groups: list(object.find("groups"), |node| group_of_points(node, &points))?,
        fingerprint: list(object.find("fingerprint"), |node| {
            registers(node)?;
            group_of_points(node, &points)
        })?,
        points,
        discovery: list(object.find("discovery"), registers)?,
        examples: Vec::new(),
        errata: list(object.find("errata"), erratum)?,
        help: list(object.find("help"), help)?,
    };
    let examples = list(object.find("examples"), |node| example(node, &profile))?;
    Ok(Profile { examples, ..profile })
}

fn line(node: Node<'_>) -> Found<LineSettings> {
    let object = Object::of(node, &["baud", "parity", "data_bits", "stop_bits"])?;
    let data_bits = |node| choice(node, &["eight", "seven"], &[DataBits::Eight, DataBits::Seven]);
    Ok(LineSettings {
        baud: baud(object.need("baud")?)?,
        data_bits: object.find("data_bits").map_or(Ok(DataBits::Eight), data_bits)?,
        parity: parity(object.need("parity")?)?,
        stop_bits: object.find("stop_bits").map_or(Ok(StopBits::One), stop_bits)?,
    })
}

fn baud(node: Node<'_>) -> Found<u32> {
    match integer(node, 100_000_000)? {
        0 => fault(node, "must not be 0"),
        baud => Ok(baud),
    }
}

fn parity(node: Node<'_>) -> Found<Parity> {
    choice(node, &["none", "odd", "even"], &[Parity::None, Parity::Odd, Parity::Even])
}

fn stop_bits(node: Node<'_>) -> Found<StopBits> {
    choice(node, &["one", "two"], &[StopBits::One, StopBits::Two])
}

fn mode(node: Node<'_>) -> Found<Mode> {
    choice(node, &["rtu", "ascii"], &[Mode::Rtu, Mode::Ascii])
}

fn choices(node: Node<'_>) -> Found<Choices> {
    let object = Object::of(node, &["bauds", "parities", "stop_bits", "modes"])?;
    Ok(Choices {
        bauds: json::choices(object.find("bauds"), baud)?,
        parities: json::choices(object.find("parities"), parity)?,
        stop_bits: json::choices(object.find("stop_bits"), stop_bits)?,
        modes: json::choices(object.find("modes"), mode)?,
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
        flash_writes: optional(object.find("flash_writes"), |node| integer(node, u32::MAX))?,
    })
}

fn wire(node: Node<'_>) -> Found<Wire> {
    let object = Object::of(node, &["color", "name", "signal", "pin", "use"])?;
    Ok(Wire {
        color: text(object.need("color")?)?,
        name: texts(object.need("name")?)?,
        signal: text(object.need("signal")?)?,
        pin: object.find("pin").map(|node| small(node, u8::MAX)).transpose()?,
        purpose: texts(object.need("use")?)?,
    })
}

fn group(node: Node<'_>) -> Found<Group> {
    let object = Object::of(node, &["function", "address", "quantity", "tentative"])?;
    let group = Group {
        function: small(object.need("function")?, u8::MAX)?,
        address: word(object.need("address")?)?,
        quantity: word(object.need("quantity")?)?,
        tentative: optional(object.find("tentative"), boolean)?,
    };
    if group.request().is_none() {
        return fault(node, "a group is 1 to 2000 bits read by function 1 or 2, or 1 to 125 registers by 3 or 4");
    }
    Ok(group)
}

/// A group of registers: a unit id, or values that tell one device from another.
fn registers(node: Node<'_>) -> Found<Group> {
    let group = group(node)?;
    if group.is_bits() { fault(node, "must be registers, read by function 3 or 4") } else { Ok(group) }
}

fn group_of_points(node: Node<'_>, points: &[Point]) -> Found<Group> {
    let group = group(node)?;
    if !points.iter().any(|point| group.offset_of(point).is_some()) {
        return fault(node, "no point lies in this group");
    }
    Ok(group)
}

fn example(node: Node<'_>, profile: &Profile) -> Found<Example> {
    let object = Object::of(node, &["point", "registers", "decimals", "text"])?;
    let example = Example {
        point: text(object.need("point")?)?,
        registers: list(object.find("registers"), word)?,
        decimals: object.find("decimals").map(|node| small(node, Decimal::MAX_DECIMALS)).transpose()?,
        text: text(object.need("text")?)?,
    };
    let Some(point) = profile.point(&example.point) else {
        return fault(node, format!("there is no point {}", example.point));
    };
    let known = match (example.decimals, point.decimals_from.as_deref()) {
        (Some(decimals), Some(teller)) => profile.known_decimals(teller, decimals),
        (None, None) => Some(Known::default()),
        (Some(_), None) => return fault(node, "no other point scales this one: leave out decimals"),
        (None, Some(_)) => return fault(node, "another point scales this one: tell its decimals"),
    };
    let Some(mut known) = known else { return fault(node, "the point that scales this one has no such value") };
    let Some(function) = point.read.iter().chain(&point.write).next() else { return fault(node, "is never read") };
    let found = profile.decode_points(*function, point.register, &example.registers, &mut known);
    let value = found.iter().find(|found| found.point.id == point.id).map(|found| found.value);
    match value {
        Some(Ok(value)) => {
            let found = point.text(value, |name| &name.en);
            if found != example.text {
                return fault(node, format!("these registers are {found}, not {}", example.text));
            }
        }
        Some(Err(error)) => return fault(node, format!("these registers hold no value: {error}")),
        None => return fault(node, format!("this point has {} registers", point.encoding.registers())),
    }
    Ok(example)
}

impl Profile {
    /// As if this number of decimals had been read.
    fn known_decimals(&self, teller: &str, decimals: u8) -> Option<Known> {
        let teller = self.point(teller)?;
        let number = Value::Number(Decimal::whole(decimals.into()));
        let code = || teller.codes.iter().find(|code| code.number == Some(decimals.into())).map(|code| code.code);
        let registers = teller.encoding.encode(number).ok().or_else(|| Some(vec![code()?]))?;
        let mut known = Known::default();
        self.decode_points(*teller.read.first()?, teller.register, &registers, &mut known);
        (known != Known::default()).then_some(known)
    }
}

fn erratum(node: Node<'_>) -> Found<Erratum> {
    let object = Object::of(node, &["printed", "right", "text"])?;
    Ok(Erratum {
        printed: optional(object.find("printed"), hex)?,
        right: optional(object.find("right"), hex)?,
        text: texts(object.need("text")?)?,
    })
}

fn help(node: Node<'_>) -> Found<Help> {
    let object = Object::of(node, &["symptom", "try"])?;
    let remedies_node = object.need("try")?;
    let help = Help { symptom: texts(object.need("symptom")?)?, remedies: list(Some(remedies_node), texts)? };
    if help.remedies.is_empty() {
        return fault(remedies_node, "must name something to try");
    }
    Ok(help)
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

#[cfg(test)]
mod tests {
    use alloc::string::String;

    use proptest::prelude::*;

    use super::super::BUILT_IN;
    use super::*;

    fn line_of(text: &str, needle: &str) -> usize {
        text.lines().position(|line| line.contains(needle)).unwrap() + 1
    }

    /// In a built-in file: what is replaced, by what, a text on the line of the fault, and a part of the reason.
    fn refused(file: usize, wrong: &[(&str, &str, &str, &str)]) {
        let text = BUILT_IN[file];
        for (from, to, place, reason) in wrong {
            assert!(text.contains(from), "{from}");
            let error = Profile::from_json(&text.replacen(from, to, 1)).expect_err(to);
            assert!(error.reason.contains(reason), "{to}: {error}");
            assert_eq!(error.line, line_of(text, place), "{to}: {error}");
        }
    }

    #[test]
    fn faults_name_line_and_reason() {
        refused(
            0,
            &[
                ("\"mode\": \"rtu\"", "\"mode\": \"rtx\"", "\"mode\": ", "rtx is none of rtu, ascii"),
                ("\"bauds\": [", "\"bauds\": [9600, ", "\"bauds\"", "listed twice"),
                ("\"format\": 1", "\"format\": 2", "\"format\"", "reads format 1"),
                ("\"id\": \"displacement\"", "\"id\": \"temperature\"", "\"id\": \"displacement\"", "another point"),
                ("\"id\": \"displacement\"", "\"id\": \"Displacement\"", "\"id\": \"displacement\"", "lower-case"),
                ("\"quantity\": 4", "\"quantity\": 126", "\"quantity\": 4", "1 to 125"),
                ("\"quantity\": 4", "\"quantity\": 1", "\"quantity\": 4", "no point lies"),
                ("\"text\": \"-0.328\"", "\"text\": \"0.328\"", "\"text\": \"-0.328\"", "are -0.328, not 0.328"),
                ("\"last\": 247 },\n  \"timing\"", "\"last\": 256 },\n  \"timing\"", "\"units\"", "255 at most"),
                ("\"unit\": 1,", "\"unit\": 248,", "\"unit\": 1,", "none of the units"),
                ("\"signal\": \"V+\"", "\"signal\": 5", "\"V+\"", "text in quotes"),
                ("\"danger\": \"danger\"", "\"danger\": true", "\"danger\": \"danger\"", "text in quotes"),
                ("\"primary\": true", "\"primary\": 1", "\"primary\"", "true or false"),
                ("\"signal\": \"A\"", "\"signl\": \"A\"", "\"A\"", "unknown key signl; known are color, name"),
                ("\"sets\": \"odd\"", "\"sets\": \"rtu\"", "\"id\": \"parity\"", "cannot be an effect"),
                ("\"effects\": [\"parity\"]", "\"effects\": [\"mode\"]", "\"id\": \"parity\"", "cannot be an effect"),
                ("\"effects\": [\"parity\"]", "\"effects\": []", "\"id\": \"parity\"", "sets what is none"),
                (
                    "\"role\": \"measurement\" },",
                    "\"role\": \"measurement\", \"primary\": true },",
                    "\"id\": \"displacement\"",
                    "another point is primary",
                ),
                ("\"write\": [5]", "\"write\": [3]", "\"id\": \"zero\"", "one of 5, 6, 15, 16"),
                ("\"write\": [5]", "\"read\": []", "\"id\": \"zero\"", "nothing reads it and nothing writes it"),
                ("\"register\": \"0x0060\"", "\"register\": \"0x10000\"", "0x0060", "from 0 to 65535"),
                (
                    "\"register\": \"0x0060\"",
                    "\"register\": \"0x0031\"",
                    "\"id\": \"baud\"",
                    "output_mode has the same",
                ),
                ("\"printed\": \"3A", "\"printed\": \"3", "\"printed\"", "hexadecimal"),
                ("\"symptom\": {", "\"sympton\": {", "It does not answer", "known are symptom, try"),
            ],
        );
    }

    #[test]
    fn points_that_depend_on_others_are_checked() {
        refused(
            2,
            &[
                (
                    "\"decimals_from\": \"decimals\"",
                    "\"decimals_from\": \"digits\"",
                    "\"id\": \"value\"",
                    "no point digits",
                ),
                ("\"decimals_from\": \"decimals\"", "\"decimals_from\": \"save\"", "\"id\": \"value\"", "can be read"),
                (
                    "{ \"type\": \"i16\" }, \"decimals_from\"",
                    "{ \"type\": \"i16\", \"decimals\": 1 }, \"decimals_from\"",
                    "\"id\": \"value\"",
                    "only whole numbers",
                ),
                ("\"decimals\": 3, \"text\": \"6.000\"", "\"text\": \"6.000\"", "\"6.000\"", "tell its decimals"),
                (
                    "\"decimals\": 3, \"text\": \"6.000\"",
                    "\"decimals\": 4, \"text\": \"6.000\"",
                    "\"6.000\"",
                    "no such value",
                ),
                (
                    "\"decimals\": 3, \"text\": \"6.000\"",
                    "\"decimals\": 2, \"text\": \"6.000\"",
                    "\"6.000\"",
                    "are 60.00",
                ),
            ],
        );
    }

    /// The level transmitter with other keys in its measurement, and a coil behind its points.
    fn level_with(measurement: &str, coil: &str) -> Result<Profile, String> {
        let from = "\"limits_from\": { \"first\": \"range_zero\", \"last\": \"range_full\" } },";
        let text = BUILT_IN[2];
        assert!(text.contains(from));
        let last = text.find("  ],\n  \"groups\"").unwrap();
        let (head, tail) = text.split_at(last);
        let name = "\"name\": { \"en\": \"Pump\", \"zh\": \"泵\" }";
        let coil = format!(
            "    , {{ \"id\": \"pump\", {name}, \"register\": 7, \"encoding\": {{ \"type\": \"code\" }}, {coil} }}\n"
        );
        let text = [&head.replacen(from, &format!("{measurement} }},"), 1), &coil, tail].concat();
        Profile::from_json(&text).map_err(|error| error.reason)
    }

    const COIL: &str = "\"read\": [1], \"write\": [15], \"role\": \"measurement\"";

    #[test]
    fn a_coil_is_a_measurement_with_a_read_and_a_write_of_its_own() {
        use crate::pdu::Request;

        let profile = level_with("\"scale\": 2", COIL).unwrap_err();
        // The worked example of the measurement no longer comes out; that of a whole scale does.
        assert!(profile.contains("are 12.000, not 6.000"), "{profile}");
        let profile = level_with("\"scale\": \"1.0\"", COIL).unwrap_err();
        assert!(profile.contains("are 6.0000, not 6.000"), "{profile}");
        let profile = level_with("\"offset\": \"0\"", COIL).unwrap();
        let pump = profile.point("pump").unwrap();
        assert!(profile.live_groups().iter().any(|group| (group.function, group.address, group.quantity) == (1, 7, 1)));
        assert_eq!(pump.read_group().unwrap().request(), Some(Request::ReadCoils { address: 7, quantity: 1 }));
        let on = Request::WriteMultipleCoils { address: 7, coils: vec![true] };
        assert_eq!(pump.write_request(&pump.encode(Value::Code(0xFF00)).unwrap()), Some(on));
        let found = profile.decode_bits(1, 6, &[false, true]);
        assert_eq!(found[0].value, Ok(Value::Code(0xFF00)));
        assert_eq!(pump.text(Value::Code(0xFF00), |name| &name.en), "1");
    }

    #[test]
    fn what_a_point_says_of_others_and_of_a_write_is_checked() {
        let measurements = [
            ("\"scale\": 0", "must not be 0"),
            ("\"scale\": 1e3", "without exponent"),
            ("\"scale\": \"x\"", "without exponent"),
            ("\"limits_from\": { \"first\": \"range_zero\", \"last\": \"full\" }", "no point full"),
            ("\"limits_from\": { \"first\": \"range_zero\", \"last\": \"baud\" }", "baud must be a number"),
            ("\"limits_from\": { \"first\": \"range_zero\", \"last\": \"address\" }", "same unit and decimals"),
            ("\"limits_from\": { \"first\": \"range_zero\" }", "the key last is missing"),
            ("\"consequence\": { \"en\": \"a\", \"zh\": \"b\" }", "never written has no consequence"),
        ];
        for (keys, reason) in measurements {
            let found = level_with(keys, COIL).expect_err(keys);
            assert!(found.contains(reason), "{keys}: {found}");
        }
        let coils = [
            ("\"write\": [15], \"role\": \"measurement\"", "read by a function"),
            ("\"write\": [15], \"role\": \"command\", \"danger\": \"danger\"", "tell what this danger costs"),
            (
                "\"write\": [5], \"role\": \"command\", \"codes\": [ { \"code\": 1, \"number\": 1 } ]",
                "0xFF00 or 0, not 1",
            ),
            (
                "\"write\": [5], \"role\": \"command\", \"codes\": [ { \"code\": 0, \"number\": 1, \"danger\": \"danger\" } ]",
                "the danger of code 0 costs",
            ),
            ("\"read\": [1], \"role\": \"parameter\", \"scale\": 2", "only whole numbers"),
            (
                "\"read\": [1], \"role\": \"parameter\", \"limits_from\": { \"first\": \"range_zero\", \"last\": \"range_full\" }",
                "only a measurement that is a number",
            ),
        ];
        for (keys, reason) in coils {
            let found = level_with("\"offset\": 0", keys).expect_err(keys);
            assert!(found.contains(reason), "{keys}: {found}");
        }
    }

    #[test]
    fn encodings_take_only_their_own_keys() {
        let with = |encoding: &str| {
            let from = "{ \"type\": \"sign_magnitude_thousandths\" }";
            assert!(BUILT_IN[0].contains(from));
            Profile::from_json(&BUILT_IN[0].replacen(from, encoding, 1)).map_err(|error| error.reason)
        };
        let wrong = [
            ("{ \"type\": \"code\", \"decimals\": 1 }", "this type has no decimals"),
            ("{ \"type\": \"code\", \"order\": \"ABCD\" }", "this type has no order"),
            ("{ \"type\": \"u32\", \"mask\": 1 }", "this type has no mask"),
            ("{ \"type\": \"u32\", \"decimals\": 19 }", "from -9 to 18"),
            ("{ \"type\": \"u16\", \"order\": \"CDAB\" }", "one register is ABCD"),
            ("{ \"type\": \"u32\", \"order\": \"ACBD\" }", "ACBD is none of ABCD"),
            ("{ \"type\": \"bits\", \"mask\": 0 }", "at least one bit"),
            ("{ \"type\": \"bits\", \"mask\": 4, \"shift\": 3 }", "from 0 to 2"),
            ("{ \"type\": \"bits\" }", "the key mask is missing"),
            ("{ \"type\": \"text\", \"registers\": 0 }", "must be 1 to 16"),
            ("{ \"type\": \"text\", \"registers\": 17 }", "from 0 to 16"),
        ];
        for (encoding, reason) in wrong {
            assert!(with(encoding).unwrap_err().contains(reason), "{encoding}");
        }
        // A right one fails only later, at the worked examples.
        let reason = with("{ \"type\": \"i32\", \"decimals\": -1, \"order\": \"DCBA\" }").unwrap_err();
        assert!(reason.contains("these registers are"), "{reason}");
    }

    #[test]
    fn broken_json_is_placed() {
        let error = Profile::from_json("{\n  \"format\": 1,\n  \"id\" 5\n}").unwrap_err();
        assert_eq!((error.line, error.column), (3, 8), "{error}");
        assert_eq!(Profile::from_json("{").unwrap_err().reason, "the text ends too early");
        assert_eq!(Profile::from_json("[]").unwrap_err().reason, "must be an object in braces");
    }

    #[test]
    fn deep_nesting_is_a_fault_like_others() {
        assert!(Profile::from_json(&"[".repeat(200_000)).is_err());
        assert!(Profile::from_json(&"{\"a\":".repeat(200_000)).is_err());
    }

    proptest! {
        #[test]
        fn no_damage_to_a_file_panics(file in 0..3usize, at: prop::sample::Index, len in 0..40usize, new in "\\PC{0,8}") {
            let text = BUILT_IN[file];
            let floor = |at: usize| (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap();
            let start = floor(at.index(text.len()));
            let damaged = [&text[..start], &new, &text[floor(start + len)..]].concat();
            if let Err(error) = Profile::from_json(&damaged) {
                prop_assert!(error.line <= damaged.matches('\n').count() + 1, "{error}");
            }
        }
    }
}
