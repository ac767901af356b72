//! Texts: what reads as what, and what is told of what does not.

use std::sync::LazyLock;

use buslens_codec::profile::{BUILT_IN, Profile};
use buslens_sequence::{Caution, Expected, Fault, FaultKind, READY, Sequence, outline, parse};
use proptest::prelude::*;

static PROFILES: LazyLock<Vec<Profile>> =
    LazyLock::new(|| BUILT_IN.iter().map(|text| Profile::from_json(text).unwrap()).collect());

fn profile(id: &str) -> &'static Profile {
    PROFILES.iter().find(|profile| profile.id == id).unwrap()
}

fn lvdt(text: &str) -> Result<Sequence, Vec<Fault>> {
    parse(text, Some(profile("lvdt")))
}

/// Column and kind of the one fault of one line.
#[track_caller]
fn fault(text: &str) -> (u32, FaultKind) {
    match lvdt(text) {
        Ok(sequence) => panic!("no fault in {text:?}: {sequence}"),
        Err(faults) => {
            assert_eq!(faults.len(), 1, "{text:?}: {faults:?}");
            assert_eq!(faults[0].line, 1, "{text:?}");
            (faults[0].column, faults[0].kind.clone())
        }
    }
}

fn expected(what: Expected, found: &str) -> FaultKind {
    FaultKind::Expected(what, found.to_owned())
}

/// Every step that there is, as the canonical form has it.
const EVERYTHING: &str = r#"# A comment
title "Everything \"quoted\""
device lvdt
unit 2  # from here on
timeout 250.5 ms
on failure stop
on failure continue
line 115200 even 8 1 rtu
line 9600
line 4800 none ascii
line original
poll off
dtr on
rts off
break 100 ms
wait 1.5 s
send 01 03 00 31 00 01 crc
send UNIT 03 FF wrong crc within 300 ms
send ascii 01 03 00 31 00 01
send ascii 01 wrong lrc
send ascii 01 none
send 41 42 0D
expect 01 03 ?? 4? ?4 .. CRC
expect ascii UNIT 03 .. LRC
expect reply
expect exception
expect exception 0B
expect silence
expect damage
read displacement
read temperature, displacement unit 3 within 50 ms wrong check
read all
read holding 0x0031 count 1
read input 0x0002 count 4
read coils 0x0000 count 8
read discrete 0x0000 count 2000
write baud = 115200
write parity = "even"
write baud = code 9
write address = 5 unit 0
write register 0x0005 = -3
write registers 0x0031 = 7, 2
write coil 0x0050 = on
write coils 0x0000 = on, off, on
command zero
command zero = "cancel zero"
let before = displacement
if displacement > 0.5 mm
  log "It is {displacement}, was {before + 0.1}, {{braces}}"
else if displacement between before - 1 mm and before + 1 mm
  repeat 10 times
    wait 1 ms
  end

  repeat until displacement <= -0.328 at most 7 times
    read displacement
  end
else
  repeat until 01 83 .. CRC
    read holding 0x0031 count 1
    stop
  end
  repeat forever
    fail "no {register 0x0031} and {coil 0x0001}"
  end
end
expect round trip < 50 ms
expect register 0x0031 != 7
expect coil 0x0001 = "on"
expect baud >= 9600 Bd
expect parity != code 1
"#;

#[test]
fn the_canonical_form_prints_as_it_is_read() {
    let sequence = lvdt(EVERYTHING).unwrap_or_else(|faults| panic!("{faults:?}"));
    assert_eq!(sequence.to_string(), EVERYTHING);
    assert_eq!(sequence.title(), "Everything \"quoted\"");
    assert_eq!(sequence.device(), Some("lvdt"));
    assert_eq!(sequence.line(4), "unit 2  # from here on");
}

#[test]
fn many_spellings_mean_the_same() {
    for (spelled, canonical) in [
        ("  send 0x01 0300  crc", "send 01 03 00 crc\n"),
        ("send \"\\x01A\\r\\n\"", "send 01 41 0D 0A\n"),
        ("send ascii 01 03 lrc", "send ascii 01 03\n"),
        ("line 9600 8E1 RTU", "line 9600 even 8 1 rtu\n"),
        ("wait 1500ms", "wait 1.5 s\n"),
        ("wait 0.25 s", "wait 250 ms\n"),
        ("read holding 49", "read holding 0x0031 count 1\n"),
        ("expect baud=115200", "expect baud = 115200\n"),
        ("expect temperature between -1°C and 30°C", "expect temperature between -1 °C and 30 °C\n"),
        ("write parity = 偶校验", "write parity = \"偶校验\"\n"),
        ("write parity = even", "write parity = \"even\"\n"),
        ("expect 0103 .. crc#ok", "expect 01 03 .. CRC  # ok\n"),
        ("if silence\r\nend\r\n", "if silence\nend\n"),
    ] {
        let sequence = lvdt(spelled).unwrap_or_else(|faults| panic!("{spelled:?}: {faults:?}"));
        assert_eq!(sequence.to_string(), canonical, "{spelled:?}");
    }
}

#[test]
fn every_fault_has_its_place_and_kind() {
    let name = |name: &str| name.to_owned();
    for (text, column, kind) in [
        ("sned 01", 1, FaultKind::UnknownStep(name("sned"))),
        ("send", 5, expected(Expected::Bytes, "")),
        ("send 01 0", 9, FaultKind::BadByte(name("0"))),
        ("send 01 zz", 9, FaultKind::BadByte(name("zz"))),
        ("send \"abc", 6, FaultKind::QuoteNotClosed),
        ("send \"a\\q\"", 8, FaultKind::BadEscape(name("\\q"))),
        ("send \"°\"", 7, FaultKind::NotAscii('°')),
        ("send 01 wrong", 14, expected(Expected::Check, "")),
        ("send 01 crc now", 13, FaultKind::LeftOver(name("now"))),
        ("send 01 within 5", 16, expected(Expected::Time, "5")),
        ("wait 5", 6, expected(Expected::Time, "5")),
        ("wait 2 days", 6, expected(Expected::Time, "2")),
        ("wait 100000 s", 6, FaultKind::OutOfRange { first: 0, last: 86_400 }),
        ("unit 256", 6, FaultKind::OutOfRange { first: 0, last: 255 }),
        ("unit 1x", 6, FaultKind::BadNumber(name("1x"))),
        ("line 9600 fast", 11, expected(Expected::Line, "fast")),
        ("line", 5, expected(Expected::Line, "")),
        ("poll", 5, expected(Expected::OnOff, "")),
        ("on error stop", 4, expected(Expected::Failure, "error")),
        ("on failure go", 12, expected(Expected::ContinueOrStop, "go")),
        ("read presure", 6, FaultKind::UnknownPoint(name("presure"))),
        ("read zero", 6, FaultKind::NotReadable(name("zero"))),
        ("read", 5, expected(Expected::Readable, "")),
        ("read holding 0x31 count 126", 25, FaultKind::OutOfRange { first: 1, last: 125 }),
        ("write displacement = 5", 7, FaultKind::NotWritable(name("displacement"))),
        ("write address = 248", 17, FaultKind::NotAllowed { point: name("address"), value: name("248") }),
        ("write address 5", 15, expected(Expected::Equals, "5")),
        ("write register 5 = 65536", 20, FaultKind::OutOfRange { first: 0, last: 65_535 }),
        ("command baud", 9, FaultKind::NotACommand(name("baud"))),
        ("expect", 7, expected(Expected::Condition, "")),
        ("expect displacement", 20, expected(Expected::Comparison, "")),
        ("expect displacement > ", 22, expected(Expected::Value, "")),
        ("expect displacement between 1", 30, expected(Expected::And, "")),
        ("expect displacement > 5 cm", 23, FaultKind::WrongUnit { wanted: name("mm"), found: name("cm") }),
        ("expect round trip < 1 s", 21, FaultKind::WrongUnit { wanted: name("ms"), found: name("s") }),
        ("expect hight > 5", 8, FaultKind::UnknownName(name("hight"))),
        ("expect displacement > 1.2.3", 23, FaultKind::BadNumber(name("1.2.3"))),
        ("expect exception zz", 18, FaultKind::BadByte(name("zz"))),
        ("let baud = 5", 5, FaultKind::NameTaken(name("baud"))),
        ("let unit = 5", 5, FaultKind::NameTaken(name("unit"))),
        ("let 5x = 5", 5, expected(Expected::Name, "5x")),
        ("log hello", 5, expected(Expected::Text, "hello")),
        ("log \"a {displacment}\"", 9, FaultKind::UnknownName(name("displacment"))),
        ("log \"a { b\"", 8, FaultKind::BadBrace),
        ("log \"a } b\"", 8, FaultKind::BadBrace),
        ("repeat", 7, expected(Expected::Repeat, "")),
        ("repeat 0 times", 8, FaultKind::OutOfRange { first: 1, last: 1_000_000 }),
        ("end", 1, FaultKind::NothingOpen),
        ("else", 1, FaultKind::NothingOpen),
        ("if silence", 1, FaultKind::NotClosed),
        ("device level", 8, FaultKind::OtherDevice { wanted: name("level"), found: name("lvdt") }),
        ("break 1 minute", 7, expected(Expected::Time, "1")),
        ("break 11 s", 7, FaultKind::OutOfRange { first: 1, last: 10_000 }),
    ] {
        // A block that is not closed is no fault of its first line's words.
        let text = if text.starts_with("repeat") { format!("{text}\nend") } else { text.to_owned() };
        assert_eq!(fault(&text), (column, kind), "{text:?}");
    }
    let FaultKind::UnknownCode { point, value, known } = fault("expect baud = 115201").1 else { panic!() };
    assert_eq!((point.as_str(), value.as_str(), known.len()), ("baud", "115201", 7));
    let FaultKind::UnknownCode { known, .. } = fault("write parity = mark").1 else { panic!() };
    assert_eq!(known, ["odd", "even", "none"]);
}

#[test]
fn all_faults_are_told_in_order_and_blocks_do_not_add_their_own() {
    let text = "wait 5\n\nif nothing > 3\n  sned\nelse wrong\nend\nrepeat\n end now\nelse\ntitle \"late\"\nrepeat 2 times\nelse\nend";
    let faults = lvdt(text).unwrap_err();
    let lines: Vec<u32> = faults.iter().map(|fault| fault.line).collect();
    assert_eq!(lines, [1, 3, 4, 5, 7, 8, 9, 10, 12]);
    assert_eq!(faults[6].kind, FaultKind::NothingOpen);
    assert_eq!(faults[7].kind, FaultKind::OnlyAtTheTop);
    assert_eq!(faults[8].kind, FaultKind::ElseNotHere);
}

#[test]
fn without_a_profile_bytes_and_registers_still_go() {
    parse("read holding 1\nexpect register 1 = 5\nsend 01 crc\nexpect ..", None).unwrap();
    for text in ["read displacement", "read all", "write baud = 5", "device lvdt", "expect displacement > 3"] {
        assert!(parse(text, None).is_err(), "{text}");
    }
}

#[test]
fn sizes_are_bounded() {
    let kind = |text: &str| lvdt(text).unwrap_err().first().map(|fault| fault.kind.clone());
    assert_eq!(kind(&" ".repeat(300_000)), Some(FaultKind::TextTooLong(262_144)));
    assert_eq!(kind(&"stop\n".repeat(6000)), Some(FaultKind::TooManySteps(5000)));
    assert_eq!(kind(&["if silence\n".repeat(17), "end\n".repeat(17)].concat()), Some(FaultKind::TooDeep(16)));
    assert_eq!(kind(&format!("send {}", "00".repeat(1025))), Some(FaultKind::TooManyBytes(1024)));
    assert_eq!(kind(&format!("expect baud = 1{}", " + 1".repeat(9))), Some(FaultKind::TooManyParts(8)));
    let many = lvdt(&"nonsense\n".repeat(500)).unwrap_err();
    assert_eq!((many.len(), many.last().map(|fault| &fault.kind)), (101, Some(&FaultKind::TooManyFaults)));
}

#[test]
fn what_can_cost_something_is_told_before() {
    let text = "read all\nwrite baud = 9600\nwrite sample_rate = 10\ncommand zero\ncommand factory_reset\n";
    let cautions = lvdt(text).unwrap();
    let caution = |line, grave| Caution { line, grave };
    assert_eq!(cautions.cautions(), [caution(2, false), caution(4, false), caution(5, true)]);
    let level = parse("command save\ncommand save = 1", Some(profile("level"))).unwrap();
    assert_eq!(level.cautions(), [caution(2, true)]);
}

#[test]
fn the_ready_made_ones_have_no_fault_and_say_what_they_are() {
    for text in READY {
        let (id, title) = outline(text);
        let sequence = parse(text, Some(profile(id.unwrap()))).unwrap_or_else(|faults| panic!("{id:?}: {faults:?}"));
        assert_eq!((sequence.device(), Some(sequence.title())), (id, title));
        assert!(sequence.cautions().iter().all(|caution| !caution.grave));
    }
}

#[test]
fn the_examples_of_the_documentation_have_no_fault() {
    let text = include_str!("../../docs/sequences.md");
    let mut examples = 0;
    for block in text.split("\n```").skip(1).step_by(2) {
        let known = if block.contains("title") { "" } else { "let before = 1" };
        let block = [known, block].concat();
        lvdt(&block).unwrap_or_else(|faults| panic!("{faults:?}\n{block}"));
        examples += 1;
    }
    assert!(examples >= 5);
}

/// Words of the language and others, in any order.
fn words() -> impl Strategy<Value = String> {
    let known: Vec<&str> =
        EVERYTHING.split_whitespace().chain(["\n", "\n", "\n", "end\n", "\"", "{", "}", "-", "0x"]).collect();
    prop::collection::vec(
        prop_oneof![4 => prop::sample::select(known).prop_map(str::to_owned), 1 => "\\PC{0,6}"],
        0..60,
    )
    .prop_map(|words| words.join(" "))
}

/// Lines of the canonical text and variations of them; blocks may be closed or not.
fn lines() -> impl Strategy<Value = String> {
    let known: Vec<&str> = EVERYTHING.lines().collect();
    let line = (prop::sample::select(known), any::<prop::sample::Index>(), 0u8..6, "\\PC").prop_map(
        |(line, at, how, other)| {
            let mut words: Vec<&str> = line.split(' ').collect();
            let index = at.index(words.len());
            match how {
                0 => drop(words.remove(index)),
                1 => words.insert(index, &other),
                2 => words.insert(index, words[index]),
                _ => {}
            }
            words.join(" ")
        },
    );
    prop::collection::vec(line, 0..12).prop_map(|lines| lines.join("\n"))
}

#[track_caller]
fn check_law(text: &str, profile: Option<&Profile>) {
    match parse(text, profile) {
        Ok(sequence) => {
            let printed = sequence.to_string();
            let again =
                parse(&printed, profile).unwrap_or_else(|faults| panic!("{faults:?} in\n{printed}\nof\n{text}"));
            assert_eq!(again, sequence, "{printed}");
            assert_eq!(again.to_string(), printed);
        }
        Err(faults) => {
            assert!(
                !faults.is_empty() && faults.is_sorted_by_key(|fault| (fault.line, fault.column)) || faults.len() > 100
            );
            let lines = u32::try_from(text.lines().count().max(1)).unwrap();
            assert!(faults.iter().all(|fault| (1..=lines).contains(&fault.line) && fault.column >= 1));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn any_text_is_a_sequence_or_faults(text in "(?s).{0,200}") {
        check_law(&text, Some(profile("lvdt")));
    }

    #[test]
    fn what_is_read_is_printed_and_read_again(text in prop_oneof![words(), lines()]) {
        check_law(&text, Some(profile("lvdt")));
        check_law(&text, None);
    }

    #[test]
    fn single_lines_of_every_kind_survive(line in lines(), text in "\\PC{0,30}") {
        check_law(&line, Some(profile("lvdt")));
        check_law(&format!("log \"{text}\""), Some(profile("lvdt")));
        check_law(&format!("title \"{text}\"\n# {text}"), None);
    }
}
