//! The documented format against the loader: the schema knows exactly the loader's keys and accepts the built-in profiles,
//! and the example of the documentation loads.

use std::collections::BTreeSet;

use buslens_codec::profile::{BUILT_IN, Profile};
use serde_json::{Value, json};

fn schema() -> Value {
    serde_json::from_str(include_str!("../../docs/profile.schema.json")).unwrap()
}

/// The first block of JSON in the documentation.
fn example() -> &'static str {
    let page = include_str!("../../docs/profiles.md");
    let block = page.split_once("```json\n").unwrap().1;
    block.split_once("```").unwrap().0
}

#[test]
fn the_documented_example_loads_and_uses_every_key() {
    let profile = Profile::from_json(example()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(profile.points.len(), 14);
    let document: Value = serde_json::from_str(example()).unwrap();
    let mut used = BTreeSet::new();
    gather_keys(&document, &mut used);
    for (_, keys) in loader_keys() {
        for key in keys {
            assert!(used.contains(&key), "{key} is not shown");
            assert!(include_str!("../../docs/profiles.md").contains(&format!("`{key}`")), "{key} is not explained");
        }
    }
}

#[test]
fn the_schema_knows_the_keys_of_the_loader_and_no_others() {
    let schema = schema();
    for (definition, keys) in loader_keys() {
        let definition = if definition.is_empty() { &schema } else { &schema["$defs"][definition] };
        let mut documented = BTreeSet::new();
        for part in [definition].into_iter().chain(definition["oneOf"].as_array().into_iter().flatten()) {
            documented.extend(part["properties"].as_object().into_iter().flatten().map(|(key, _)| key.clone()));
            let closed = part["properties"].is_null() || part["additionalProperties"] == json!(false);
            assert!(closed, "{part}");
        }
        assert_eq!(documented, keys.into_iter().collect());
    }
}

#[test]
fn the_schema_knows_the_words_of_the_loader() {
    // A wrong word is answered with the right ones.
    let words = [
        ("/interface", "/properties/interface/enum"),
        ("/mode", "/$defs/mode/enum"),
        ("/line/parity", "/$defs/parity/enum"),
        ("/line/data_bits", "/$defs/line/properties/data_bits/enum"),
        ("/line/stop_bits", "/$defs/stop_bits/enum"),
        ("/points/0/role", "/$defs/point/properties/role/enum"),
        ("/points/11/danger", "/$defs/danger/enum"),
        ("/points/10/effects/0", "/$defs/point/properties/effects/items/enum"),
        ("/points/12/codes/0/sets", "/$defs/code/properties/sets/enum"),
        ("/points/10/reply", "/$defs/point/properties/reply/enum"),
        ("/points/3/encoding/order", "/$defs/order/enum"),
    ];
    let schema = schema();
    for (place, pointer) in words {
        let documented: Vec<&str> =
            schema.pointer(pointer).unwrap().as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
        assert_eq!(allowed_at(place), documented, "{place}");
    }
    let variants = schema.pointer("/$defs/encoding/oneOf").unwrap().as_array().unwrap();
    let types =
        variants.iter().flat_map(|variant| variant.pointer("/properties/type/enum").unwrap().as_array().unwrap());
    let types: BTreeSet<&str> = types.map(|word| word.as_str().unwrap()).collect();
    assert_eq!(allowed_at("/points/0/encoding/type").iter().map(String::as_str).collect::<BTreeSet<_>>(), types);
}

#[test]
fn the_schema_accepts_the_built_in_profiles() {
    let schema = schema();
    for text in BUILT_IN.iter().copied().chain([example()]) {
        let profile: Value = serde_json::from_str(text).unwrap();
        assert_eq!(check(&schema, &schema, &profile), Ok(()), "{}", profile["id"]);
    }
}

#[test]
fn the_schema_refuses_what_the_loader_refuses() {
    let changes = [
        ("/format", json!(2)),
        ("/id", json!("Tank")),
        ("/unit", json!(256)),
        ("/mode", json!("tcp")),
        ("/name/zh", Value::Null),
        ("/timing/poll_period_ms", json!(0)),
        ("/points/0/register", json!("48")),
        ("/points/0/register", json!(65536)),
        ("/points/0/read", json!([6])),
        ("/points/0/encoding", json!({ "type": "i16", "order": "CDAB" })),
        ("/points/0/encoding", json!({ "type": "code", "decimals": 1 })),
        ("/points/0/encoding", json!({ "type": "bits" })),
        ("/points/2/codes/0", json!({ "code": 1 })),
        ("/groups/0/quantity", json!(126)),
        ("/groups/1/quantity", json!(2001)),
        ("/fingerprint/0/function", json!(2)),
        ("/discovery/0/function", json!(1)),
        ("/points/4/scale", json!("1/10")),
        ("/points/4/offset", json!(null)),
        ("/points/0/limits_from", json!({ "first": "range_start" })),
        ("/help/0/try", json!([])),
        ("/help/0/symptom", json!("It creeps")),
        ("/groups/0/tentative", json!("no")),
        ("/examples/0/registers", json!(1)),
        ("/errata/0/printed", json!("0")),
        ("/notes", json!(["text"])),
        ("/choices/bauds", json!([9600, 9600])),
    ];
    let schema = schema();
    for (place, value) in changes {
        let document = with(place, value.clone());
        assert!(check(&schema, &schema, &document).is_err(), "the schema takes {value} at {place}");
        assert!(Profile::from_json(&document.to_string()).is_err(), "the loader takes {value} at {place}");
    }
    let mut extra: Value = serde_json::from_str(example()).unwrap();
    extra["colour"] = json!("red");
    assert_eq!(check(&schema, &schema, &extra), Err("unknown key colour".to_owned()));
}

/// Each kind of object: the schema's definition, and the keys that the loader says it knows.
fn loader_keys() -> Vec<(&'static str, Vec<String>)> {
    let kinds = [
        ("", ""),
        ("texts", "/name"),
        ("line", "/line"),
        ("choices", "/choices"),
        ("units", "/units"),
        ("timing", "/timing"),
        ("wire", "/wiring/0"),
        ("point", "/points/0"),
        ("encoding", "/points/0/encoding"),
        ("limits", "/points/1/range"),
        ("limits_from", "/points/0/limits_from"),
        ("code", "/points/2/codes/0"),
        ("read", "/groups/0"),
        ("read", "/discovery/0"),
        ("read", "/fingerprint/0"),
        ("example", "/examples/0"),
        ("erratum", "/errata/0"),
        ("help", "/help/0"),
    ];
    let keys = |(definition, place): (&'static str, &str)| {
        let mut document: Value = serde_json::from_str(example()).unwrap();
        document.pointer_mut(place).unwrap()["nonsense"] = json!(1);
        let reason = Profile::from_json(&document.to_string()).unwrap_err().reason;
        let known =
            reason.strip_prefix("unknown key nonsense; known are ").unwrap_or_else(|| panic!("{place}: {reason}"));
        (definition, known.split(", ").map(str::to_owned).collect())
    };
    kinds.into_iter().map(keys).collect()
}

/// The words that the loader says are allowed at a place.
fn allowed_at(place: &str) -> Vec<String> {
    let reason = Profile::from_json(&with(place, json!("nonsense")).to_string()).unwrap_err().reason;
    let known = reason.strip_prefix("nonsense is none of ").unwrap_or_else(|| panic!("{place}: {reason}"));
    known.split(", ").map(str::to_owned).collect()
}

/// The example with another value in one place.
fn with(place: &str, value: Value) -> Value {
    let mut document: Value = serde_json::from_str(example()).unwrap();
    *document.pointer_mut(place).unwrap() = value;
    document
}

fn gather_keys(value: &Value, keys: &mut BTreeSet<String>) {
    for (key, value) in value.as_object().into_iter().flatten() {
        keys.insert(key.clone());
        gather_keys(value, keys);
    }
    value.as_array().into_iter().flatten().for_each(|value| gather_keys(value, keys));
}

/// As much of JSON Schema as the schema uses; a keyword beyond that fails the test.
fn check(root: &Value, schema: &Value, value: &Value) -> Result<(), String> {
    for (keyword, rule) in schema.as_object().unwrap() {
        let holds = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" => true,
            "$ref" => {
                let target = root.pointer(rule.as_str().unwrap().strip_prefix('#').unwrap()).unwrap();
                check(root, target, value).map(|()| true)?
            }
            "type" => match rule.as_str().unwrap() {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "boolean" => value.is_boolean(),
                "number" => value.is_number(),
                "integer" => value.is_i64() || value.is_u64(),
                other => panic!("type {other}"),
            },
            "const" => value == rule,
            "enum" => rule.as_array().unwrap().contains(value),
            "minimum" => value.as_f64().is_none_or(|number| number >= rule.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|number| number <= rule.as_f64().unwrap()),
            "pattern" => value.as_str().is_none_or(|text| matches(rule.as_str().unwrap(), text)),
            "required" => {
                let keys = rule.as_array().unwrap();
                value.as_object().is_none_or(|object| keys.iter().all(|key| object.contains_key(key.as_str().unwrap())))
            }
            "properties" => {
                for (key, value) in value.as_object().into_iter().flatten() {
                    if let Some(rule) = rule.get(key) {
                        check(root, rule, value).map_err(|reason| format!("{key}: {reason}"))?;
                    }
                }
                true
            }
            "additionalProperties" => {
                assert_eq!(rule, false);
                let unknown = |key: &&String| schema["properties"].get(key).is_none();
                if let Some(key) = value.as_object().into_iter().flatten().map(|(key, _)| key).find(unknown) {
                    return Err(format!("unknown key {key}"));
                }
                true
            }
            "items" => {
                for item in value.as_array().into_iter().flatten() {
                    check(root, rule, item)?;
                }
                true
            }
            "minItems" => value.as_array().is_none_or(|items| items.len() as u64 >= rule.as_u64().unwrap()),
            "uniqueItems" => {
                let items = value.as_array().into_iter().flatten();
                let twice = items.enumerate().any(|(at, item)| value.as_array().unwrap()[..at].contains(item));
                rule != true || !twice
            }
            "anyOf" => rule.as_array().unwrap().iter().any(|rule| check(root, rule, value).is_ok()),
            "oneOf" => rule.as_array().unwrap().iter().filter(|rule| check(root, rule, value).is_ok()).count() == 1,
            other => panic!("keyword {other}"),
        };
        if !holds {
            return Err(format!("{keyword} {rule}, but {value}"));
        }
    }
    Ok(())
}

/// The few patterns of the schema.
fn matches(pattern: &str, text: &str) -> bool {
    let hex = |text: &str| text.bytes().all(|byte| byte.is_ascii_hexdigit());
    match pattern {
        "^-?[0-9]+(\\.[0-9]*)?$" => {
            let digits = text.strip_prefix('-').unwrap_or(text);
            let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
            !whole.is_empty() && whole.bytes().chain(fraction.bytes()).all(|byte| byte.is_ascii_digit())
        }
        "^[a-z0-9_-]+$" => {
            let plain = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_' || byte == b'-';
            !text.is_empty() && text.bytes().all(plain)
        }
        "^0x[0-9A-Fa-f]{1,4}$" => {
            text.strip_prefix("0x").is_some_and(|word| (1..=4).contains(&word.len()) && hex(word))
        }
        "^([0-9A-Fa-f]{2} *)*$" => {
            let bytes = text.split(' ').filter(|part| !part.is_empty());
            bytes.into_iter().all(|part| part.len() % 2 == 0 && hex(part))
        }
        other => panic!("pattern {other}"),
    }
}
