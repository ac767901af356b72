//! The example program, from pasted text to JSON Lines, read back by a JSON parser.

#[path = "../examples/dissect.rs"]
#[allow(dead_code)]
mod dissect;

use nojson::{RawJson, RawJsonValue};
use proptest::prelude::*;

/// What the program writes on both outputs, and its exit code.
fn run(arguments: &[&str], text: &[u8]) -> (String, String, u8) {
    let arguments: Vec<String> = arguments.iter().map(ToString::to_string).collect();
    let (mut out, mut notes, mut input) = (Vec::new(), Vec::new(), text);
    let code = dissect::run(&arguments, &mut input, &mut out, &mut notes).unwrap();
    (String::from_utf8(out).unwrap(), String::from_utf8(notes).unwrap(), code)
}

/// The objects that a text comes to under a profile; everything in it can be read.
fn lines(profile: &str, text: &str) -> Vec<String> {
    let (out, notes, code) = run(&["--profile", profile], text.as_bytes());
    assert_eq!((notes.as_str(), code), ("", 0), "{text}");
    out.lines().map(str::to_owned).collect()
}

/// A member of an object, by its keys from outside to inside, as JSON text.
fn at(line: &str, keys: &[&str]) -> String {
    let json = RawJson::parse(line).unwrap_or_else(|error| panic!("{error}: {line}"));
    let mut value: RawJsonValue<'_, '_> = json.value();
    for key in keys {
        value = match key.parse::<usize>() {
            Ok(place) => value.to_array().unwrap().nth(place).unwrap_or_else(|| panic!("{key}: {line}")),
            Err(_) => value.to_member(key).unwrap().required().unwrap(),
        };
    }
    value.as_raw_str().to_owned()
}

fn all(lines: &[String], keys: &[&str]) -> Vec<String> {
    lines.iter().map(|line| at(line, keys)).collect()
}

#[test]
fn the_format_to_the_letter() {
    let expected = r#"{"kind":"frame","index":0,"offset":0,"mode":"rtu","direction":"request","unit":1,"function":3,"bytes":"010300310001D5C5","check":{"kind":"crc16","found":"D5C5","expected":"D5C5","ok":true},"exception":null,"pair":1,"address":49,"quantity":1,"registers":null,"bits":null,"points":[],"diagnoses":[]}
{"kind":"frame","index":1,"offset":8,"mode":"rtu","direction":"response","unit":1,"function":3,"bytes":"0103020007F986","check":{"kind":"crc16","found":"F986","expected":"F986","ok":true},"exception":null,"pair":0,"address":49,"quantity":1,"registers":[7],"bits":null,"points":[{"register":49,"id":"baud","raw":[7],"value":115200,"text":"115200","unit":"Bd"}],"diagnoses":[]}
{"kind":"noise","index":2,"offset":15,"bytes":"00FF","diagnoses":[]}
"#;
    let text = "01 03 00 31 00 01 D5 C5\n01 03 02 00 07 F9 86\n00 FF";
    for arguments in [&[][..], &["--profile", "auto"], &["--profile", "lvdt"]] {
        assert_eq!(run(arguments, text.as_bytes()), (expected.to_owned(), String::new(), 0));
    }
    let glued: String = text.split_ascii_whitespace().collect();
    assert_eq!(run(&[], glued.as_bytes()).0, expected);
}

#[test]
fn every_frame_of_the_manuals() {
    let mut count = 0;
    for row in include_str!("data/manual_frames.csv").lines().skip(1) {
        let columns: Vec<&str> = row.split(',').collect();
        let (profile, direction, text) = (columns[0].replace('_', "-"), columns[2], columns[3]);
        let lines = lines(&profile, text);
        assert_eq!(lines.len(), 1, "{row}");
        let line = &lines[0];
        assert_eq!(at(line, &["kind"]), "\"frame\"", "{row}");
        assert_eq!(at(line, &["direction"]), format!("\"{direction}\""), "{row}");
        assert_eq!(at(line, &["mode"]), format!("\"{}\"", columns[1]), "{row}");
        if columns.last() == Some(&"ok") {
            assert_eq!(at(line, &["check", "ok"]), "true", "{row}");
            assert_eq!(at(line, &["diagnoses"]), "[]", "{row}");
        } else {
            assert_eq!(at(line, &["check"]), r#"{"kind":"lrc","found":"C1","expected":"CA","ok":false}"#);
            let expected = r#"[{"id":"manual_erratum","erratum":1},{"id":"bad_lrc","expected":"CA"}]"#;
            assert_eq!(at(line, &["diagnoses"]), expected);
        }
        count += 1;
    }
    assert_eq!(count, 25);
}

#[test]
fn values_of_all_devices_are_exact() {
    let cases = [
        ("lvdt", "010400020004 5009 0104080000011D007B01C8B9C1", "[28.5,123.456]"),
        ("lvdt", "010400040002 300A 0104048137 0148 E2E4", "[-311.328]"),
        ("lvdt", "01 05 00 50 FF 00 8C 2B 01 05 00 50 FF 00 8C 2B", r#"["zero here"]"#),
        ("lvdt", "01 10 00 32 00 01 02 00 02 23 83", r#"["even"]"#),
        ("gauge-cable", "01 03 00 00 00 02 C4 0B 01 03 04 01 00 12 35 37 78", "[-4.661]"),
        ("gauge-cable", "01 03 00 00 00 02 C4 0B 01 03 04 00 00 12 35 36 84", "[4.661]"),
        ("gauge-cable", "01 06 08 00 AB 56 74 A4", r#"["zero the gauge"]"#),
        ("level", "01 06 00 00 00 02 08 0B", "[2]"),
    ];
    for (profile, text, values) in cases {
        for profile in [profile, "auto"] {
            let text: String = text.split(' ').collect();
            let lines = lines(profile, &text);
            let last = lines.last().unwrap();
            let json = RawJson::parse(last).unwrap();
            let points = json.value().to_member("points").unwrap().required().unwrap();
            let found: Vec<&str> = points
                .to_array()
                .unwrap()
                .map(|point| point.to_member("value").unwrap().required().unwrap().as_raw_str())
                .collect();
            assert_eq!(format!("[{}]", found.join(",")), values, "{profile}: {last}");
        }
    }
}

#[test]
fn a_value_waits_for_its_scale() {
    let text = "01 03 00 04 00 01 C5 CB 01 03 02 17 70 B6 50\n\
                01 03 00 03 00 01 74 0A 01 03 02 00 03 F8 45\n\
                01 03 00 04 00 01 C5 CB 01 03 02 17 70 B6 50\n";
    let lines = lines("level", text);
    let raw = r#"{"register":4,"id":"value","raw":[6000],"value":6000,"text":"6000","unit":null,"scaled":false}"#;
    assert_eq!(at(&lines[1], &["points", "0"]), raw);
    let scaled = r#"{"register":4,"id":"value","raw":[6000],"value":6.000,"text":"6.000","unit":null}"#;
    assert_eq!(at(&lines[5], &["points", "0"]), scaled);
    // What another unit says of its scale is its own matter.
    let other = text.lines().nth(2).unwrap().replace("01 03 00 04 00 01 C5 CB", "02 03 00 04 00 01 C5 F8");
    let other =
        [text.lines().nth(1).unwrap(), &other.replace("01 03 02 17 70 B6 50", "02 03 02 17 70 F2 50")].join("\n");
    let lines = self::lines("level", &other);
    assert_eq!(at(&lines[3], &["points", "0", "scaled"]), "false", "{}", lines[3]);
}

#[test]
fn marks_and_times_of_a_log() {
    let text = "[10:00:01.123] TX: 01 03 00 31 00 01 D5 C5\n\
                [10:00:01.140] RX: 01 03 00 31 00 01 D5 C5 01 03 02 00 07 F9 86\n\
                [10:00:02.123] TX: 01 03 00 31 00 01 D5 C5\n";
    let lines = lines("auto", text);
    assert_eq!(all(&lines, &["direction"]), ["\"request\"", "\"request\"", "\"response\"", "\"request\""]);
    assert_eq!(all(&lines, &["pair"]), ["2", "null", "0", "null"]);
    assert_eq!(at(&lines[1], &["diagnoses"]), r#"[{"id":"echo"}]"#);
}

#[test]
fn damaged_frames_carry_their_diagnoses_first_to_last() {
    let cases = [
        (
            "01 03 00 31 00 01 D5 C4",
            r#"[{"id":"single_bit_error","byte":7,"bit":0,"repaired":"010300310001D5C5"},{"id":"bad_crc","expected":"D5C5"}]"#,
        ),
        (
            "01 03 00 31 00 01 C5 D5",
            r#"[{"id":"swapped_crc","repaired":"010300310001D5C5"},{"id":"bad_crc","expected":"D5C5"}]"#,
        ),
        (
            "01 03 00 31 01 D5 C5",
            r#"[{"id":"missing_byte","at":4,"repaired":"010300310001D5C5"},{"id":"bad_crc","expected":"9004"}]"#,
        ),
        (
            "01 03 00 31 77 00 01 D5 C5",
            r#"[{"id":"extra_byte","at":4,"repaired":"010300310001D5C5"},{"id":"bad_crc","expected":"8F6E"}]"#,
        ),
        ("01 03 00 31 00 01 CA", r#"[{"id":"lrc_in_rtu"},{"id":"bad_crc","expected":"7415"}]"#),
        ("01 84 02 C2 C1", r#"[{"id":"exception","code":2}]"#),
        ("FA 03 00 00 00 01 91 81", r#"[{"id":"unit_reserved","unit":250}]"#),
        (":010300310001D5C5\n", r#"[{"id":"crc_in_ascii"},{"id":"bad_lrc","expected":"F5"}]"#),
    ];
    for (text, expected) in cases {
        let lines = lines("auto", text);
        assert_eq!(lines.len(), 1, "{text}: {lines:?}");
        let found = at(&lines[0], &["diagnoses"]);
        // What the wrong check should have been is the other tests' matter.
        let cut = |json: &str| json.split(",{\"id\":\"bad_").next().unwrap().to_owned();
        assert_eq!(cut(&found), cut(expected), "{text}");
        assert_eq!(found.contains("\"bad_"), expected.contains("\"bad_"), "{text}: {found}");
    }
}

#[test]
fn what_cannot_be_taken_apart_still_has_its_header() {
    let (out, notes, code) = run(&[], b":010300G10001CA");
    assert_eq!((notes.as_str(), code), ("line 1, column 8: unexpected 'G'\n", 0));
    let lines = vec![out];
    assert_eq!(all(&lines, &["unit"]), ["1"]);
    assert_eq!(all(&lines, &["function"]), ["3"]);
    assert_eq!(at(&lines[0], &["bytes"]), "\"3A30313033303047313030303143410D0A\"");
    assert_eq!(at(&lines[0], &["check"]), r#"{"kind":"lrc","found":null,"expected":null,"ok":false}"#);
    assert_eq!(at(&lines[0], &["diagnoses"]), r#"[{"id":"ascii_not_hex","at":7}]"#);
}

#[test]
fn values_beyond_the_profile_are_told() {
    // Parity code 9.
    let lines = lines("lvdt", "01 10 00 32 00 01 02 00 09 62 44");
    assert_eq!(at(&lines[0], &["check", "ok"]), "true", "{}", lines[0]);
    assert_eq!(at(&lines[0], &["diagnoses"]), r#"[{"id":"value_out_of_range","point":"parity"}]"#);
}

#[test]
fn coils_are_bits() {
    let lines = lines("auto", "01 01 00 13 00 0A 4D C8 01 01 02 CD 01 2D 6C");
    assert_eq!(at(&lines[1], &["pair"]), "0", "{}", lines[1]);
    assert_eq!(at(&lines[1], &["bits"]), "[true,false,true,true,false,false,true,true,true,false]");
    assert_eq!(at(&lines[1], &["registers"]), "null");
}

#[test]
fn places_that_cannot_be_read_are_named_and_the_rest_is_read() {
    let (out, notes, code) = run(&[], "01 03 00 31 00 01 D5 C5\n01 03 zz 02 00 07 F9 86\n".as_bytes());
    assert_eq!(code, 0);
    assert!(notes.starts_with("line 2, column 7: "), "{notes}");
    assert!(out.lines().count() >= 2 && out.contains("\"bytes\":\"010300310001D5C5\""));
    // Text that is no UTF-8.
    let (out, _, code) = run(&[], b"\xB7\xA2: 01 03 00 31 00 01 D5 C5\r\n\xCA\xD5: 01 03 02 00 07 F9 86");
    assert_eq!(code, 0);
    assert_eq!(out.lines().count(), 2, "{out}");
    assert!(out.contains("\"bytes\":\"010300310001D5C5\"") && out.contains("115200"), "{out}");
}

#[test]
fn nothing_to_read_and_wrong_arguments() {
    for text in ["", "\n\n", "good morning"] {
        let (out, notes, code) = run(&[], text.as_bytes());
        assert_eq!((out.as_str(), code), ("", 1), "{text}");
        assert!(!notes.is_empty());
    }
    for arguments in [&["--profile"][..], &["--profile", "none such"], &["--help"], &["--profile", "lvdt", "more"]] {
        let (out, notes, code) = run(arguments, b"01 03 00 31 00 01 D5 C5");
        assert_eq!((out.as_str(), code), ("", 2), "{arguments:?}");
        assert!(notes.starts_with("usage: dissect [--profile lvdt|gauge-cable|level|auto]"), "{notes}");
    }
}

/// Each line is an object with stable keys, whatever is read.
#[test]
fn every_line_is_json() {
    let texts = [
        "FF FF FF FF FF 00 00",
        ":01\n:\n:zz03\n:0103003100\n:010300310001CA\n",
        "01 10 00 00 00 7B F6 01 10 00 00 00 7B F6",
        "01 2B 0E 01 00 70 77 01 11 C0 2C 01 41 42 43 44",
        "00 00 00 00 00 00 00 00 00 00 00 00",
        "3A 30 31",
    ];
    for text in texts {
        let (out, _, code) = run(&[], text.as_bytes());
        assert_eq!(code, 0, "{text}");
        for (index, line) in out.lines().enumerate() {
            assert_eq!(at(line, &["index"]), index.to_string(), "{line}");
            let kind = at(line, &["kind"]);
            let keys: &[&str] = if kind == "\"noise\"" {
                &["offset", "bytes", "diagnoses"]
            } else {
                &[
                    "offset",
                    "mode",
                    "direction",
                    "unit",
                    "function",
                    "bytes",
                    "check",
                    "exception",
                    "pair",
                    "address",
                    "quantity",
                    "registers",
                    "bits",
                    "points",
                    "diagnoses",
                ]
            };
            for key in keys {
                at(line, &[key]);
            }
        }
    }
}

proptest! {
    /// Whatever bytes a text holds, each line is an object, and the bytes come back in their order.
    #[test]
    fn any_bytes_become_json(bytes in prop::collection::vec(any::<u8>(), 1..80), known in 0usize..4) {
        let mut stream = vec![1, 3, 0, 0x31, 0, 1, 0xD5, 0xC5];
        stream.truncate(known * 3);
        stream.extend(bytes);
        let text: String = stream.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ");
        let (out, _, code) = run(&["--profile", "level"], text.as_bytes());
        prop_assert_eq!(code, 0);
        let found: Vec<String> = out.lines().map(|line| at(line, &["bytes"]).trim_matches('"').to_owned()).collect();
        if !out.contains("\"ascii\"") {
            prop_assert_eq!(found.concat(), text.replace(' ', ""));
        }
    }
}
