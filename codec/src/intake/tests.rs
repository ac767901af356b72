use alloc::string::ToString;
use alloc::vec;
use alloc::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::dissect::Direction;
use crate::line::Mode;

const FRAME: [u8; 8] = [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5];

#[track_caller]
fn check(text: &str, form: Form, expected: &[u8]) {
    let intake = read(text);
    assert_eq!((intake.form, intake.faults.as_slice(), &*intake.bytes), (form, &[][..], expected), "{text}");
    assert_eq!(intake.bytes.is_empty(), intake.segments.is_empty());
}

#[test]
fn the_same_frame_in_many_spellings() {
    for text in [
        "01 03 00 31 00 01 D5 C5",
        "0103003100 01d5c5",
        "010300310001D5C5",
        "01,03,00,31,00,01,D5,C5",
        "01;03;00;31;00;01;D5;C5",
        "01:03:00:31:00:01:D5:C5",
        "01-03-00-31-00-01-D5-C5",
        "01.03.00.31.00.01.D5.C5",
        "01\t03\t00\t31\t00\t01\tD5\tC5",
        "0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5",
        "0X1 0X3 0X0 0X31 0X0 0X1 0XD5 0XC5",
        "0x01030031 0x0001D5C5",
        "\\x01\\x03\\x00\\x31\\x00\\x01\\xD5\\xC5",
        "\\x01 \\x03 \\x00 \\x31 \\x00 \\x01 \\xD5 \\xC5",
        "\\x01\\x03\\x001\\x00\\x01\\xd5\\xc5",
        "b'\\x01\\x03\\x001\\x00\\x01\\xd5\\xc5'",
        "print(b\"\\x01\\x03\\x001\\x00\\x01\\xd5\\xc5\")",
        "b'010300310001d5c5'",
        "bytearray(b'\\x01\\x03\\x001\\x00\\x01\\xd5\\xc5')",
        "bytes.fromhex('01 03 00 31 00 01 D5 C5')",
        "bytes([0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5])",
        "uint8_t buf[] = {0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5};",
        "uint8_t buf[8] = {\n  0x01, 0x03, 0x00, 0x31, // read\n  0x00, 0x01, 0xD5, 0xC5  /* check */\n};",
        "const unsigned char request[8] = {\n  0x01, 0x03, 0x00, 0x31,\n  0x00, 0x01, 0xD5, 0xC5\n};",
        "[0x01u8, 0x03u8, 0x00u8, 0x31u8, 0x00u8, 0x01u8, 0xD5u8, 0xC5u8]",
        "let frame = vec![0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5];",
        "01h,03h,00h,31h,00h,01h,D5h,C5h",
        "01H 03H 00H 31H 00H 01H D5H C5H",
        "$01 $03 $00 $31 $00 $01 $D5 $C5",
        "&H01 &H03 &H00 &H31 &H00 &H01 &HD5 &HC5",
        "#01#03#00#31#00#01#D5#C5",
        "%01%03%00%31%00%01%D5%C5",
        "[01][03][00][31][00][01][D5][C5]",
        "<01 03 00 31 00 01 D5 C5>",
        "\"01 03 00 31 00 01 D5 C5\"",
        "1 3 0 31 0 1 D5 C5",
        "01 03 00 31\n00 01 D5 C5\r\n",
        "01 03 00 31\r00 01 D5 C5\r",
        "\n\n  01 03 00 31 00 01 D5 C5  \n\n",
        "01 03 00 31 00 01 D5 C5 # 7",
        "01 03 00 31 00 01 D5 C5 // 7",
        "01 03 /* 05 */ 00 31\n/* 07\n08 */ 00 01 D5 C5",
        "０１　０３　００　３１　００　０１　Ｄ５　Ｃ５",
        "０１，０３，００，３１，００，０１，Ｄ５，Ｃ５",
        "01、03、00、31、00、01、D5、C5。",
        "01；03；00；31；00；01；D5；C5",
        "01：03：00：31：00：01：D5：C5",
        "\u{FEFF}01\u{A0}03 00 31 00 01 D5 C5",
        "\u{1B}[32m01 03\u{1B}[0m 00 31 00 01 D5 C5",
    ] {
        check(text, Form::Hex, &FRAME);
    }
}

#[test]
fn frames_are_glued_and_cut_as_they_come() {
    check("010300310001D5C50103020007F986", Form::Hex, b"\x01\x03\x00\x31\x00\x01\xD5\xC5\x01\x03\x02\x00\x07\xF9\x86");
    let intake = read("01 03 00\n\n31 00 01\nD5 C5 01 03");
    let starts: Vec<_> = intake.segments.iter().map(|segment| (segment.start, segment.line)).collect();
    assert_eq!(starts, [(0, 1), (3, 3), (6, 4)]);
    assert_eq!(intake.bytes.len(), 10);
}

#[test]
fn decimal_numbers_where_nothing_else_makes_sense() {
    let frame = [1, 3, 0, 49, 0, 1, 213, 197];
    for text in [
        "1, 3, 0, 49, 0, 1, 213, 197",
        "1 3 0 49 0 1 213 197",
        "001 003 000 049 000 001 213 197",
        "[1, 3, 0, 49, 0, 1, 213, 197]",
        "bytes([1, 3, 0, 49, 0, 1, 213, 197])",
        "byte[] frame = {1, 3, 0, 49, 0, 1, -43, -59};",
        "let f = [1u8, 3u8, 0u8, 49u8, 0u8, 1u8, 213u8, 197u8];",
        "１，３，０，４９，０，１，２１３，１９７",
    ] {
        check(text, Form::Decimal, &frame);
    }
    // Two readings: a list of a program says so, else the check decides, else hexadecimal is the rule.
    let two = [1, 4, 0, 2, 0, 4, 80, 9];
    check("[1, 4, 0, 2, 0, 4, 80, 9]", Form::Decimal, &two);
    check("1, 4, 0, 2, 0, 4, 80, 9", Form::Decimal, &two);
    assert_eq!(read("1, 4, 0, 2, 0, 4, 80, 9").alternative, Some(Form::Hex));
    let text = "10, 20, 30, 40";
    check(text, Form::Hex, &[0x10, 0x20, 0x30, 0x40]);
    assert_eq!(read(text).alternative, Some(Form::Decimal));
    assert_eq!(read_as(text, Form::Decimal).bytes, [10, 20, 30, 40]);
    for text in ["1 3 0 1", "01 03 00 10", "0x10, 0x20", "10 20 zz", "10 20 AA", "1020 3040"] {
        assert_eq!(read(text).alternative, None, "{text}");
    }
}

#[test]
fn ascii_frames_as_text_and_as_codes() {
    let expected = b":010300310001CA\r\n";
    for (text, form) in [
        (":010300310001CA", Form::AsciiFrames),
        ("  ：010300310001CA\r\n", Form::AsciiFrames),
        (":010300310001CA\\r\\n", Form::AsciiFrames),
        (":010300310001CA<CR><LF>", Form::AsciiFrames),
        (":01 03 00 31 00 01 CA", Form::AsciiFrames),
        ("3A 30 31 30 33 30 30 33 31 30 30 30 31 43 41 0D 0A", Form::Hex),
        ("3A 30 31 30 33 30 30\n33 31 30 30 30 31 43 41 0D 0A", Form::Hex),
        ("b':010300310001CA\\r\\n'", Form::Hex),
    ] {
        check(text, form, expected);
        assert!(read(text).segments.iter().all(|segment| segment.mode == Mode::Ascii), "{text}");
    }
    let parity: Vec<u8> =
        expected.iter().map(|byte| if byte.count_ones() % 2 == 0 { *byte } else { byte | 0x80 }).collect();
    let hex: Vec<_> = parity.iter().map(|byte| alloc::format!("{byte:02X}")).collect();
    let intake = read(&hex.join(" "));
    assert_eq!((intake.bytes, intake.segments[0].mode), (parity, Mode::Ascii));
}

#[test]
fn modes_alternate_by_line() {
    let intake = read(":010300310001CA\n01 03 00 31 00 01 D5 C5\n:010300310001CA:0103020007F3\n3A300D0A");
    let modes: Vec<_> = intake.segments.iter().map(|segment| (segment.start, segment.mode, segment.line)).collect();
    let expected = [(0, Mode::Ascii, 1), (17, Mode::Rtu, 2), (25, Mode::Ascii, 3), (57, Mode::Ascii, 4)];
    assert_eq!(modes, expected);
    assert_eq!(&intake.bytes[25..57], b":010300310001CA\r\n:0103020007F3\r\n");
    assert_eq!(intake.fault_count, 0);
}

#[test]
fn faults_are_placed_and_reading_goes_on() {
    use IntakeFault::{OddDigits, TooLarge, Unexpected};
    for (text, form, bytes, faults) in [
        ("01 03\n00 3", Form::Hex, &[1, 3, 0, 3][..], &[][..]),
        ("01 03\n00 312 05", Form::Hex, &[1, 3, 0, 0x31, 5], &[(2, 4, OddDigits)]),
        ("01 03 zz 05", Form::Hex, &[1, 3, 5], &[(1, 7, Unexpected('z'))]),
        ("01 0G 05", Form::Hex, &[1, 5], &[(1, 5, Unexpected('G'))]),
        ("01 ？ 05 é", Form::Hex, &[1, 5], &[(1, 4, Unexpected('？')), (1, 9, Unexpected('é'))][..1]),
        ("0x", Form::Hex, &[], &[(1, 1, Unexpected('0'))]),
        (":0103G0CA", Form::AsciiFrames, b":0103G0CA\r\n", &[(1, 6, Unexpected('G'))]),
        ("1 300 2", Form::Decimal, &[1, 2], &[(1, 3, TooLarge)]),
        ("1 A 2", Form::Decimal, &[1, 2], &[(1, 3, Unexpected('A'))]),
        ("Tx: 01 03 003 31 0G 01", Form::Log, &[1, 3, 0, 0x31, 1], &[(1, 11, OddDigits), (1, 18, Unexpected('0'))]),
    ] {
        let text = text.trim_end_matches(" é");
        let intake = read_as(text, form);
        let found: Vec<_> = intake.faults.iter().map(|error| (error.line, error.column, error.fault)).collect();
        assert_eq!((&*intake.bytes, &*found), (bytes, faults), "{text}");
        assert_eq!(intake.fault_count, faults.len());
    }
    assert_eq!(read("01 zz").faults[0].to_string(), "line 1, column 4: unexpected 'z'");
}

#[test]
fn what_holds_nothing() {
    for text in ["", " \n\t\n", "\u{FEFF}"] {
        let intake = read(text);
        assert_eq!((intake.bytes.len(), intake.segments.len(), intake.fault_count), (0, 0, 0), "{text:?}");
    }
    let intake = read("The sensor does not answer.\nWhat now?");
    assert_eq!(intake.faults, [IntakeError { line: 1, column: 1, fault: IntakeFault::NoBytes }]);
    let raw: alloc::string::String = (0..30_000u32).filter_map(|n| char::from_u32(n * 7919 % 60)).collect();
    let intake = read(&raw);
    let raw_faults = intake.faults.iter().filter(|error| error.fault == IntakeFault::NotText).count();
    assert_eq!((raw_faults, intake.fault_count), (1, 1));
    // One control character does not spoil a line.
    let intake = read("01 03 00 31 00 01 D5 C5\u{1A}");
    assert_eq!((&*intake.bytes, intake.faults[0].fault, intake.fault_count), (&FRAME[..], IntakeFault::NotText, 1));
}

#[test]
fn only_the_first_faults_are_kept() {
    let intake = read_as(&"zz ".repeat(5000), Form::Hex);
    assert_eq!((intake.faults.len(), intake.fault_count), (MAX_FAULTS, 5000));
    assert_eq!(intake.faults[999].column, 2998);
}

#[test]
fn what_is_taken_early_is_not_given_again() {
    let mut reader = Reader::new(Form::Log);
    reader.push("Tx: 01 03 00 31 00 01 D5 C5\r");
    let first = reader.take();
    assert_eq!((first.bytes, first.segments[0].start), (FRAME.to_vec(), 0));
    reader.push("\nRx: 01 03 02 00 07");
    assert_eq!(reader.take(), Portion::default());
    reader.push(" F9 86");
    reader.finish();
    let second = reader.take();
    assert_eq!(second.bytes, [1, 3, 2, 0, 7, 0xF9, 0x86]);
    let expected = Segment { start: 8, direction: Direction::Response, line: 2, ..Segment::default() };
    assert_eq!(second.segments, [expected]);
    assert_eq!(reader.take(), Portion::default());
}

/// Texts of the pieces that readers look for, so that they are found in odd places.
fn texts() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        4 => "[0-9A-Fa-f]{1,5}",
        4 => prop::sample::select(vec![
            " ", "  ", "\n", "\r", "\r\n", "\t", ",", ":", "-", ";", "|", "*", "\n*\n", "[", "]", "<", ">", "{", "}", "(", ")",
            "=", "\"", "'", "\\", "\\x", "\\x0", "0x", "&H", "#", "# ", "//", "/*", "*/", "$", "%", "h", "u8", "Tx:", "RX ",
            "发", "收→", "请求", "字节", "长度", "->", "<<", "10:21:33", "10:21:33.48", "2024-05-01", "1/5/2024 ", "12.5",
            "\n0000  ", "\n00000010: ", "\n0000020 ", "{\"bytes\":\"01", "\"mode\":\"ascii\"", "\"time_us\":12",
            ":010300310001CA", "01 03 00 31 00 01 D5 C5", "len=", "bytes", "\u{1B}[31m", "\0", "é", "\u{FFFD}", "１", "，",
        ]).prop_map(String::from),
        1 => ".{0,6}",
    ];
    prop::collection::vec(piece, 0..40).prop_map(|pieces| pieces.concat())
}

proptest! {
    #[test]
    fn any_text_is_taken_the_same_in_any_pieces(text in texts(), cuts in prop::collection::vec(1usize..12, 1..20), form in 0..7usize) {
        let form = Form::ALL.get(form).copied().unwrap_or_else(|| detect(&text).form);
        let whole = read_as(&text, form);
        let mut reader = Reader::new(form);
        let mut all = Portion::default();
        let characters: Vec<char> = text.chars().collect();
        let mut rest = &characters[..];
        for cut in cuts.iter().cycle() {
            let (piece, after) = rest.split_at((*cut).min(rest.len()));
            reader.push(&piece.iter().collect::<String>());
            if cut % 2 == 0 {
                let portion = reader.take();
                all.bytes.extend(portion.bytes);
                all.segments.extend(portion.segments);
                all.faults.extend(portion.faults);
            }
            rest = after;
            if rest.is_empty() { break; }
        }
        reader.finish();
        let portion = reader.take();
        all.bytes.extend(portion.bytes);
        all.segments.extend(portion.segments);
        all.faults.extend(portion.faults);
        prop_assert_eq!(&all.bytes, &whole.bytes);
        prop_assert_eq!(&all.segments, &whole.segments);
        prop_assert_eq!(&all.faults, &whole.faults);
        prop_assert_eq!(reader.fault_count(), whole.fault_count);
        // Segments cover the bytes without gaps, and faults come in the order of the text.
        prop_assert_eq!(whole.segments.first().map(|segment| segment.start), (!whole.bytes.is_empty()).then_some(0));
        prop_assert!(whole.segments.windows(2).all(|pair| pair[0].start < pair[1].start && pair[0].line <= pair[1].line));
        prop_assert!(whole.segments.last().is_none_or(|segment| segment.start < whole.bytes.len()));
        prop_assert!(whole.faults.windows(2).all(|pair| pair[0].line <= pair[1].line));
    }

    #[test]
    fn any_text_at_all_is_taken(text in ".*") {
        let intake = read(&text);
        prop_assert_eq!(intake.form, detect(&text).form);
    }
}
