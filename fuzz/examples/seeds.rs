//! Makes the seeds anew from the test data, the built-in profiles and the documented one:
//! `cargo run --manifest-path fuzz/Cargo.toml --example seeds`.

use std::fs;
use std::path::{Path, PathBuf};

use buslens_codec::check::crc16;
use buslens_codec::line::Mode;
use buslens_codec::profile::Profile;
use buslens_codec::{UnitId, adu, rtu};

/// A frame of the test data.
struct Row {
    function: u8,
    is_request: bool,
    unit: u8,
    pdu: Vec<u8>,
}

fn main() {
    let mut rows = manual_frames();
    rows.extend(vectors());
    intake();
    frames("rtu", Mode::Rtu, &rows);
    frames("ascii", Mode::Ascii, &rows);
    pdus(&rows);
    streams(&rows);
    profiles();
    found();
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the project's folder").to_owned()
}

fn text(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn write(target: &str, name: &str, data: &[u8]) {
    let folder = root().join("fuzz/seeds").join(target);
    fs::create_dir_all(&folder).and_then(|()| fs::write(folder.join(name), data)).expect("the seeds can be written");
}

fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> =
        text.chars().filter_map(|digit| digit.to_digit(16)).filter_map(|d| d.try_into().ok()).collect();
    digits.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect()
}

fn row(frame: &[u8], is_request: bool) -> Option<Row> {
    let adu = rtu::decode(frame).ok()?;
    Some(Row { function: adu.pdu[0] & 0x7F, is_request, unit: adu.unit.0, pdu: adu.pdu.to_vec() })
}

fn manual_frames() -> Vec<Row> {
    let text = text("codec/tests/data/manual_frames.csv");
    let lines = text.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    lines.filter(|cells| cells[1] == "rtu").filter_map(|cells| row(&hex(cells[3]), cells[2] == "request")).collect()
}

/// Of each function and direction the first four, of refusals the first one.
fn vectors() -> Vec<Row> {
    let text = text("codec/tests/data/pymodbus_vectors.csv");
    let mut last = ("", "");
    let mut count = 0;
    let mut rows = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        count = if last == (cells[0], cells[1]) { count + 1 } else { 0 };
        last = (cells[0], cells[1]);
        let refused = hex(cells[3]).get(1).is_some_and(|function| *function >= 0x80);
        if count < if refused { 1 } else { 4 } {
            rows.extend(row(&hex(cells[3]), cells[1] == "request"));
        }
    }
    rows
}

/// Logs and dumps, a third of them cut into pieces of several sizes; the frames of the manuals in several spellings.
fn intake() {
    let folder = root().join("codec/tests/data/logs");
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("the logs are there")
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort();
    for (at, name) in (0u8..).zip(&names) {
        let mut data = text(&format!("codec/tests/data/logs/{name}")).into_bytes();
        if at % 3 == 0 {
            data.extend([0xFF, 6, at, 3, 40, 0]);
        }
        write("intake", name, &data);
    }
    let frames = text("codec/tests/data/manual_frames.csv");
    let frames: Vec<&str> = frames.lines().skip(1).filter_map(|line| line.split(',').nth(3)).collect();
    write("intake", "manual_frames", frames.join("\n").as_bytes());
    let first = hex(frames[0]);
    let spell = |form: fn(&u8) -> String, between: &str| first.iter().map(form).collect::<Vec<_>>().join(between);
    write(
        "intake",
        "array",
        format!("uint8_t b[] = {{ {} }};", spell(|byte| format!("0x{byte:02X}"), ", ")).as_bytes(),
    );
    write("intake", "decimal", spell(ToString::to_string, ", ").as_bytes());
    write("intake", "escapes", format!("b'{}'", spell(|byte| format!("\\x{byte:02x}"), "")).as_bytes());
    write("intake", "ascii_frames", b":010300310001CA\r\n:0103020007F3\r\n");
    write("intake", "year_zero", b"0000-02-01 00:00:00 Tx: 01 03 00 31 00 01 D5 C5");
    write("intake", "wide", "０１，０３　发送：００".as_bytes());
}

/// Whole and with each kind of fault, alone and behind a request.
fn frames(target: &str, mode: Mode, rows: &[Row]) {
    for (at, row) in (0u8..).zip(rows.iter().step_by(2)) {
        let request = rows.iter().find(|other| other.is_request && other.function == row.function);
        let request = request.filter(|_| !row.is_request).map(|found| [&[found.unit], &*found.pdu].concat());
        let request = request.unwrap_or_default();
        let body = [&[row.unit], &*row.pdu].concat();
        let direction = if row.is_request { 1 } else { 2 };
        let frame = adu::encode(mode, UnitId(row.unit), &row.pdu).expect("it was one");
        let frame = if at % 4 == 0 { frame } else { body };
        let head = [direction | (at % 8) << 2, at.wrapping_mul(5), at.wrapping_mul(29), small(request.len())];
        write(target, &name(row, at), &[&head, &*request, &frame].concat());
    }
}

/// Every request with a response to it, every other response alone.
fn pdus(rows: &[Row]) {
    let (requests, responses): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(|row| row.is_request);
    for (at, request) in (0u8..).zip(&requests) {
        let same = responses.iter().filter(|response| response.function == request.function);
        let response = same.cycle().nth(at.into()).map(|found| found.pdu.clone()).unwrap_or_default();
        let data = [&[request.unit, small(request.pdu.len())], &*request.pdu, &response].concat();
        write("pdu", &name(request, at), &data);
    }
    for (at, response) in (100u8..).zip(responses.iter().step_by(2)) {
        write("pdu", &name(response, at), &[&[response.unit, 0], &*response.pdu].concat());
    }
}

/// Scripts of eight frames with segments, repetitions, faults and noise between them.
fn streams(rows: &[Row]) {
    for (at, rows) in (0u8..).zip(rows.chunks(8)) {
        for (target, mode) in [("splitter", at & 1), ("transcript", (at / 8) & 1)] {
            let mut data = vec![mode, 0, at, 7, 30];
            for (nth, row) in (0u8..).zip(rows) {
                let body = [&[row.unit], &*row.pdu].concat();
                let ascii = if at & 1 == 1 { 8 } else { 0 };
                let direction = if row.is_request { 0x10 } else { 0x20 };
                if at % 3 == 0 {
                    data.extend([5 | ascii | direction, 1, 20]);
                }
                match (nth + at) % 8 {
                    3 => data.extend([6 | ascii, nth, 1 << (nth % 8)]),
                    5 => data.extend([7 | ascii, nth, 0]),
                    6 => data.extend([7 | ascii | 0x10, nth, 0x55]),
                    7 => data.extend([0, 3, 0, 0xFF, b':', 2 | ascii]),
                    _ => data.push(2 | ascii),
                }
                data.push(small(body.len()));
                data.extend(body);
                if nth == 4 {
                    data.push(1);
                }
            }
            write(target, &format!("{at:02}"), &data);
        }
    }
}

/// The built-in and the documented ones, and small ones that are quickly tried.
fn profiles() {
    let registers = [3, 0, 2, 0, 0, 1, 0x1D, 0x80, 0, 1, 0x48, 0, 7, 0, 1, 0x12, 0x34, 0xFF, 0, 0, 3];
    let add = |name: &str, text: &str| {
        if let Err(error) = Profile::from_json(text) {
            panic!("{name}: {error}");
        }
        write("profile", name, &[text.as_bytes(), &[0xFF], &registers].concat());
    };
    for id in ["lvdt", "gauge-cable", "level"] {
        add(id, &text(&format!("codec/profiles/{id}.json")));
    }
    let page = text("docs/profiles.md");
    let example = page.split_once("```json\n").and_then(|(_, rest)| rest.split_once("```"));
    add("documented", example.expect("the page shows a profile").0);
    let head = r#""format":1,"id":"x","name":{"en":"","zh":""},"line":{"baud":9600,"parity":"even"},"mode":"rtu","unit":1,"units":{"first":1,"last":247},"timing":{"response_timeout_ms":9,"poll_period_ms":9}"#;
    let small = |name: &str, points: &str, rest: &str| {
        let text = format!("{{{head},\"points\":[{points}]{rest}}}");
        add(name, &text);
    };
    let point = |id: &str, register: u16, encoding: &str, rest: &str| {
        format!(
            r#"{{"id":"{id}","name":{{"en":"","zh":""}},"register":{register},"encoding":{encoding},"read":[3],"write":[16],"role":"parameter"{rest}}}"#
        )
    };
    let words = r#","order":"CDAB""#;
    for (name, encoding) in [
        ("u16", r#"{"type":"u16","decimals":1}"#.to_owned()),
        ("i32", format!(r#"{{"type":"i32"{words}}}"#)),
        ("u64", r#"{"type":"u64"}"#.to_owned()),
        ("f32", format!(r#"{{"type":"f32"{words}}}"#)),
        ("f64", r#"{"type":"f64"}"#.to_owned()),
        ("bcd_32", r#"{"type":"bcd_32"}"#.to_owned()),
        ("bits", r#"{"type":"bits","mask":"0x0070","shift":4}"#.to_owned()),
        ("text", r#"{"type":"text","registers":3}"#.to_owned()),
        ("sign_magnitude", r#"{"type":"sign_magnitude_16","decimals":2}"#.to_owned()),
    ] {
        small(name, &point("a", 2, &encoding, ""), "");
    }
    let scale = point("d", 1, r#"{"type":"u16"}"#, "");
    let scaled = point("v", 2, r#"{"type":"i16"}"#, r#","decimals_from":"d""#);
    let example = r#","examples":[{"point":"v","registers":[65535],"decimals":2,"text":"-0.01"}]"#;
    small("scaled", &format!("{scale},{scaled}"), example);
    small("factor", &point("v", 2, r#"{"type":"i16"}"#, r#","scale":0.005,"offset":"-40""#), "");
    let coil = r#"{"id":"p","name":{"en":"","zh":""},"register":2,"encoding":{"type":"code"},"read":[1,3],"write":[15],"role":"measurement"}"#;
    small("coil", coil, r#","groups":[{"function":1,"address":0,"quantity":9}]"#);
    let codes = r#","effects":["baud"],"codes":[{"code":1,"number":9600}]"#;
    let group = r#","groups":[{"function":3,"address":0,"quantity":4}],"choices":{"bauds":[9600,19200],"modes":["rtu","ascii"]}"#;
    small("codes", &point("b", 3, r#"{"type":"code"}"#, codes), group);
}

/// What broke a law once, or would break it where a rule that is easily forgotten were missing.
fn found() {
    // A frame of 257 bytes that lost one.
    let mut long = [&[1, 0x2B, 4][..], &[7; 252]].concat();
    long.extend(crc16(&long).to_le_bytes());
    long.remove(200);
    write("rtu", "too_long_a_repair", &[&[0; 4][..], &long].concat());
    // A function that tells no length, and noise before a silence.
    let own = [2, 6, 1, 0x41, 1, 2, 3, 4, 0, 3, 0xFF, 0xFE, 0xFD];
    write("splitter", "noise_before_a_silence", &[&[0, 0, 5, 7, 30][..], &own].concat());
    // Combinations beyond number.
    let many = |word: &str| vec![format!("\"{word}\""); 300].join(",");
    let line = text("codec/profiles/level.json").replace("[\"none\"]", &format!("[{}]", many("odd")));
    write(
        "profile",
        "listed_twice",
        line.replace("\"modes\"", &format!("\"stop_bits\":[{}],\"modes\"", many("two"))).as_bytes(),
    );
}

/// Function, direction and number.
fn name(row: &Row, at: u8) -> String {
    let direction = if row.is_request { "request" } else { "response" };
    format!("{:02x}_{direction}_{at:03}", row.function)
}

fn small(len: usize) -> u8 {
    u8::try_from(len).expect("a PDU is shorter than 255 bytes")
}
