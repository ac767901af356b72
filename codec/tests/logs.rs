//! Logs and dumps of the tools that people have, as they print them: bytes, directions and times come back. The files in
//! `data/logs` hold the same eight frames.

use buslens_codec::dissect::Direction::{self, Request, Response, Unknown};
use buslens_codec::intake::{Form, Intake, read, read_as};
use buslens_codec::line::Mode;
use proptest::prelude::*;

/// What every log holds: reading temperature and displacement, the baud code, the address by broadcast; writing the parity.
const FRAMES: [&[u8]; 8] = [
    b"\x01\x04\x00\x02\x00\x04\x50\x09",
    b"\x01\x04\x08\x00\x00\x01\x1D\x00\x7B\x01\xC8\xB9\xC1",
    b"\x01\x03\x00\x31\x00\x01\xD5\xC5",
    b"\x01\x03\x02\x00\x07\xF9\x86",
    b"\x00\x03\x00\x30\x00\x01\x85\xD4",
    b"\x00\x03\x02\x00\x01\x44\x44",
    b"\x01\x10\x00\x32\x00\x01\x02\x00\x02\x23\x83",
    b"\x01\x10\x00\x32\x00\x01\xA0\x06",
];

/// 2024-05-01, 1970 being 0, and 10:21:33 of a day.
const DAY_US: u64 = 1_714_521_600_000_000;
const START_US: u64 = 37_293_000_000;
/// When the frames went, in milliseconds after that.
const TIMES_MS: [u64; 8] = [482, 509, 612, 631, 1740, 1758, 2868, 2891];

/// The bytes of each segment with its direction and time.
fn parts(intake: &Intake) -> Vec<(&[u8], Direction, Option<u64>)> {
    let ends = intake.segments.iter().skip(1).map(|segment| segment.start).chain([intake.bytes.len()]);
    let parts = intake.segments.iter().zip(ends);
    parts.map(|(segment, end)| (&intake.bytes[segment.start..end], segment.direction, segment.time_us)).collect()
}

fn at_time_of_day(frame: usize) -> u64 {
    START_US + TIMES_MS[frame] * 1000
}

fn at_date(frame: usize) -> u64 {
    DAY_US + at_time_of_day(frame)
}

#[track_caller]
fn check(text: &str, time_us: Option<fn(usize) -> u64>) {
    let intake = read(text);
    assert_eq!(intake.form, Form::Log);
    assert_eq!(intake.faults, []);
    let expected: Vec<_> =
        (0..8).map(|at| (FRAMES[at], [Request, Response][at % 2], time_us.map(|us| us(at)))).collect();
    assert_eq!(parts(&intake), expected);
}

macro_rules! log {
    ($name:literal) => {
        include_str!(concat!("data/logs/", $name))
    };
}

#[test]
fn modbus_poll() {
    check(log!("modbus_poll.txt"), None);
}

#[test]
fn qmodmaster() {
    check(log!("qmodmaster.txt"), Some(at_time_of_day));
}

#[test]
fn modbus_tools() {
    check(log!("modbus_tools.txt"), Some(at_date));
}

#[test]
fn mbpoll() {
    check(log!("mbpoll.txt"), None);
}

#[test]
fn a_libmodbus_server_receives_requests() {
    check(log!("libmodbus_server.txt"), None);
}

#[test]
fn pymodbus() {
    check(log!("pymodbus.txt"), Some(at_date));
    check(log!("pymodbus3.txt"), Some(at_date));
}

#[test]
fn minimalmodbus() {
    check(log!("minimalmodbus.txt"), None);
    check(log!("minimalmodbus_repr.txt"), None);
}

#[test]
fn sscom() {
    check(log!("sscom.txt"), Some(at_time_of_day));
}

#[test]
fn serial_assistants() {
    check(log!("serial_assistant.txt"), Some(at_date));
    check(log!("net_assist.txt"), Some(at_date));
    check(log!("comtool.txt"), Some(at_date));
}

#[test]
fn docklight() {
    check(log!("docklight.txt"), Some(at_date));
}

#[test]
fn a_serial_port_monitor() {
    check(log!("port_monitor.txt"), Some(|frame| START_US + TIMES_MS[frame] / 1000 * 1_000_000));
}

#[test]
fn cutecom() {
    check(log!("cutecom.txt"), Some(at_time_of_day));
    // Without marks of direction.
    let text = log!("cutecom.txt").replace(">> ", "").replace("<< ", "");
    let intake = read(&text);
    let expected: Vec<_> = (0..8).map(|at| (FRAMES[at], Unknown, Some(at_time_of_day(at)))).collect();
    assert_eq!(parts(&intake), expected);
}

/// A capture in hexadecimal with time stamps: it knows no directions.
#[test]
fn realterm() {
    let intake = read(log!("realterm.txt"));
    let expected: Vec<_> = (0..8).map(|at| (FRAMES[at], Unknown, Some(at_date(at)))).collect();
    assert_eq!((intake.form, intake.fault_count, parts(&intake)), (Form::Log, 0, expected));
}

/// "Copy as a hex stream": one long string.
#[test]
fn wireshark_hex_stream() {
    let intake = read(log!("wireshark_stream.txt"));
    assert_eq!((intake.form, intake.fault_count, intake.bytes), (Form::Hex, 0, FRAMES.concat()));
}

#[test]
fn columns_of_time_channel_and_bytes() {
    let intake = read(log!("columns.txt"));
    let expected: Vec<_> = (0..8).map(|at| (FRAMES[at], Unknown, Some(at_date(at)))).collect();
    assert_eq!((intake.form, intake.fault_count, parts(&intake)), (Form::Log, 0, expected));
}

#[test]
fn libraries() {
    check(log!("nmodbus.txt"), None);
    check(log!("modbus_tk.txt"), None);
    check(log!("emodbus.txt"), None);
}

#[test]
fn a_table() {
    check(log!("table.csv"), Some(at_date));
    check(&log!("table.csv").replace(',', "\t"), Some(at_date));
    check(&log!("table.csv").replace(',', " | "), Some(at_date));
}

#[test]
fn the_export_of_a_dissection() {
    check(log!("export.jsonl"), None);
    let text = "{\"kind\":\"frame\",\"mode\":\"ascii\",\"direction\":\"request\",\"bytes\":\"010300310001CA\"}\n\
                { \"kind\": \"noise\", \"bytes\": \"00FF\", \"time_us\": 1500 }";
    let intake = read(text);
    assert_eq!(parts(&intake), [(&b":010300310001CA\r\n"[..], Request, None), (b"\x00\xFF", Unknown, Some(1500))]);
    assert_eq!(intake.segments[0].mode, Mode::Ascii);
}

#[test]
fn frames_of_ascii_mode_in_a_log() {
    let intake = read(log!("ascii_mode.txt"));
    assert!(intake.segments.iter().all(|segment| segment.mode == Mode::Ascii));
    let parts = parts(&intake);
    assert_eq!(parts.len(), 8);
    assert_eq!(parts[0], (&b":010400020004F5\r\n"[..], Request, Some(at_time_of_day(0))));
    assert_eq!(parts[7], (&b":011000320001BC\r\n"[..], Response, Some(at_time_of_day(7))));
}

/// What the dumps hold: the frames, zeros, the first frame again, a stray byte.
fn dumped() -> Vec<u8> {
    [&FRAMES.concat()[..], &[0; 64], FRAMES[0], &[0xFF]].concat()
}

#[test]
fn hex_dumps() {
    for (name, text) in [
        ("xxd", log!("xxd.txt")),
        ("hexdump -C", log!("hexdump_c.txt")),
        ("od -t x1", log!("od.txt")),
        ("od -A x -t x1z", log!("od_hex.txt")),
        ("od -A d -t x1", log!("od_decimal.txt")),
        ("Wireshark", log!("wireshark.txt")),
    ] {
        let intake = read(text);
        assert_eq!((intake.form, intake.faults.len(), intake.bytes), (Form::HexDump, 0, dumped()), "{name}");
    }
    let intake = read(log!("hexdump.txt"));
    assert_eq!((intake.form, intake.faults.len(), intake.bytes), (Form::WordDump, 0, dumped()));
    assert_eq!(intake.alternative, Some(Form::HexDump));
}

#[test]
fn one_row_of_a_dump() {
    for text in [
        "00000000: 0103 0031 0001 d5c5                      ...1....",
        "0000   01 03 00 31 00 01 d5 c5                           ...1....",
        "0000  01 03 00 31 00 01 d5 c5",
        "0000000 01 03 00 31 00 01 d5 c5\n0000010",
        "0x0000: 01 03 00 31 00 01 d5 c5 |...1....|",
        "00000000  01 03 00 31 00 01 d5 c5  01 03 00 31 00 01 d5 c5  |01 03 05 07 09 0B|",
    ] {
        let intake = read(text);
        assert_eq!((intake.form, intake.fault_count), (Form::HexDump, 0), "{text}");
        assert!(intake.bytes.chunks(8).all(|frame| frame == FRAMES[2]), "{text}");
    }
    // Groups of digits that are no dump.
    assert_eq!(read("0103 0031 0001 D5C5\n0103 0200 07F9 86").form, Form::Hex);
}

#[test]
fn a_repetition_without_end_is_refused() {
    let intake = read_as("00000000  00 00 00 00\n*\nffffffff  01 02\n", Form::HexDump);
    assert_eq!((intake.bytes.len(), intake.fault_count), (6, 1));
}

const TIME: Option<u64> = Some(37_293_482_000);
const DATE: Option<u64> = Some(DAY_US + 37_293_482_000);

/// What unnamed tools, locales and hands make of a line; the bytes stand at `{}`.
const VARIATIONS: &[(&str, Direction, Option<u64>)] = &[
    ("TX: {}", Request, None),
    ("tx {}", Request, None),
    ("[TX] {}", Request, None),
    ("<TX> {}", Request, None),
    ("RX: {}", Response, None),
    ("Rx<- {}", Response, None),
    ("RXD {}", Response, None),
    ("COM3 TX1: {}", Request, None),
    ("uart_tx: {}", Request, None),
    ("Send: {}", Request, None),
    ("Sent 8 bytes: {}", Request, None),
    ("Received 8 bytes: {}", Response, None),
    ("recv[8] {}", Response, None),
    ("Tx (8): {}", Request, None),
    ("write len=8 {}", Request, None),
    ("len=8 read {}", Response, None),
    ("IRP_MJ_WRITE Length 8: {}", Request, None),
    ("IRP_MJ_READ Length 8: {}", Response, None),
    ("Request: {}", Request, None),
    ("Read response: {}", Response, None),
    ("Received request: {}", Request, None),
    ("Sending response: {}", Response, None),
    ("Master -> Slave: {}", Request, None),
    ("Slave -> Master: {}", Response, None),
    ("> {}", Request, None),
    ("< {}", Response, None),
    (">> {}", Request, None),
    ("<< {}", Response, None),
    ("--> {}", Request, None),
    ("<-- {}", Response, None),
    ("=> {}", Request, None),
    ("→ {}", Request, None),
    ("← {}", Response, None),
    ("◇{}", Request, None),
    ("◆{}", Response, None),
    ("发送：{}", Request, None),
    ("接收：{}", Response, None),
    ("发: {}", Request, None),
    ("收: {}", Response, None),
    ("【发送】{}", Request, None),
    ("【接收】８字节：{}", Response, None),
    ("发送数据(8字节): {}", Request, None),
    ("接收 长度8: {}", Response, None),
    ("请求报文：{}", Request, None),
    ("响应报文：{}", Response, None),
    ("主站请求 {}", Request, None),
    ("从站应答 {}", Response, None),
    ("串口3 发送 -> {} √", Request, None),
    ("10:21:33.482 {}", Unknown, TIME),
    ("10:21:33:482 TX {}", Request, TIME),
    ("10:21:33,482 TX {}", Request, TIME),
    ("[10:21:33.482]TX:{}", Request, TIME),
    ("【10:21:33.482】发送：{}", Request, TIME),
    ("(10:21:33.482000) >> {}", Request, TIME),
    ("{} 10:21:33.482 TX", Request, TIME),
    ("1/5/2024 10:21:33.482 AM [TX] - {}", Request, TIME),
    ("5/13/24 10:21:33.482 [TX] - {}", Request, TIME),
    ("2024-05-01 10:21:33.482 TX {}", Request, DATE),
    ("2024-05-01T10:21:33.482Z TX {}", Request, DATE),
    ("2024-05-01T10:21:33.482+08:00 TX {}", Request, DATE),
    ("2024/05/01 10:21:33.482 发送 {}", Request, DATE),
    ("2024年5月1日 10:21:33.482 发送 {}", Request, TIME),
    ("1714558893.482 TX {}", Request, DATE),
    ("12.345678 TX {}", Request, Some(12_345_678)),
    ("000012 10:21:33.482 TX {}", Request, TIME),
    ("12: TX {}", Request, None),
    ("12) TX {}", Request, None),
    ("#12 TX {}", Request, None),
    ("[12] TX {}", Request, None),
    ("12\tTX\t{}\t8", Request, None),
    ("12,TX,{},8,OK", Request, None),
    ("12;TX;{};8;12 ms", Request, None),
    ("\"12\",\"TX\",\"{}\",\"8\"", Request, None),
    ("| 12 | TX | {} | 8 |", Request, None),
    ("| TX |   {} | 12.5 ms", Request, None),
    ("TX 0012 {}  8", Request, None),
    ("TX: {} 100", Request, None),
    ("TX: {} (8 bytes)", Request, None),
    ("TX: {} 8 bytes", Request, None),
    ("TX: {} len=8", Request, None),
    ("TX: {} ok", Request, None),
    ("TX: {} CRC OK", Request, None),
    ("TX: {} // read the baud code", Request, None),
    ("\u{1B}[32m10:21:33.482\u{1B}[0m \u{1B}[1;31mTX\u{1B}[0m {}", Request, TIME),
    ("I (12345) MODBUS: TX {}", Request, None),
    ("D/Modbus  ( 1234): TX {}", Request, None),
    ("192.168.1.10:502 TX {}", Request, None),
    ("/dev/ttyUSB0 TX {}", Request, None),
    ("May  1 10:21:33 host modbusd[1234]: TX {}", Request, Some(START_US)),
    ("INFO:root:Request {}", Request, None),
    ("{} TX", Request, None),
    ("ＴＸ：{}", Request, None),
    ("TX：\u{3000}{}", Request, None),
];

#[test]
fn odd_variations() {
    let request = "01 03 00 31 00 01 D5 C5";
    for (line, direction, time_us) in VARIATIONS {
        for payload in [
            request.to_owned(),
            request.to_lowercase(),
            request.replace(' ', ""),
            request.replace(' ', "-"),
            format!("0x{}", request.replace(' ', " 0x")),
            format!("0x{}", request.replace(' ', ",0x")),
            format!("{}h", request.replace(' ', "h ")),
            format!("\\x{}", request.replace(' ', "\\x")),
            request.replace(' ', "  "),
        ] {
            let text = line.replace("{}", &payload);
            let intake = read_as(&text, Form::Log);
            assert_eq!((parts(&intake), intake.fault_count), (vec![(FRAMES[2], *direction, *time_us)], 0), "{text}");
            let text = format!("{text}\n");
            assert_eq!(read(&text).bytes, FRAMES[2], "{text}: {:?}", read(&text).form);
        }
    }
}

#[test]
fn remarks_hold_no_bytes() {
    for line in [
        "Sys > 10:21:33:482 - values read correctly.",
        "[10]: \t16",
        "[2]: 285",
        "2024-05-01 10:21:33,482 DEBUG transaction:145 Running transaction 7",
        "MinimalModbus debug mode. Clearing serial buffers for port COM6",
        "COM3 opened, 9600 8E1",
        "read 2 registers at 0x0031",
        "request for 69/10",
        "Timeout: 1000 ms",
        "Slave 1 does not answer",
        "串口已打开：COM3，9600，E，8，1",
    ] {
        let text = format!("TX: 01 03 00 31 00 01 D5 C5\n{line}\nRX: 01 03 02 00 07 F9 86");
        let intake = read(&text);
        assert_eq!(parts(&intake), [(FRAMES[2], Request, None), (FRAMES[3], Response, None)], "{line}");
    }
}

#[test]
fn numbers_and_words_beside_bare_frames_are_no_bytes() {
    for text in [
        "1) {0}\n2) {1}",
        "1. {0}\n2. {1}",
        "1: {0}\n2: {1}",
        "12\t{0}\n13\t{1}",
        "000012-{0}\n000013-{1}",
        "{0} (8 bytes)\n{1} (7 bytes)",
        "{0}   8\n{1}   7",
        "Please look at this:\n{0}\n{1}\nWhat is wrong?",
        "请看：\n{0}\n{1}\n超时",
        "地址1 读取波特率 {0}\n{1}",
    ] {
        let text = text.replace("{0}", "01 03 00 31 00 01 D5 C5").replace("{1}", "01 03 02 00 07 F9 86");
        let intake = read(&text);
        assert_eq!(intake.fault_count, 0, "{text}");
        assert_eq!(parts(&intake), [(FRAMES[2], Unknown, None), (FRAMES[3], Unknown, None)], "{text}");
    }
    // Frames in words of their own are all kept.
    let text = "TX 010300310001D5C5 0103020007F986";
    assert_eq!(read(text).bytes, [FRAMES[2], FRAMES[3]].concat());
}

#[test]
fn a_line_may_hold_both_halves_of_an_exchange() {
    let frames = ["01 03 00 31 00 01 D5 C5", "01 03 02 00 07 F9 86"];
    for (line, directions) in [
        ("TX: {0} RX: {1}", [Request, Response]),
        ("10:21:33.482 TX {0} | RX {1}", [Request, Response]),
        ("发送 {0} 接收 {1}", [Request, Response]),
        ("{0} -> {1}", [Unknown, Unknown]),
        ("Exchange: {0} / {1}", [Unknown, Unknown]),
    ] {
        let intake = read(&line.replace("{0}", frames[0]).replace("{1}", frames[1]));
        let found: Vec<_> = parts(&intake).iter().map(|(bytes, direction, _)| (*bytes, *direction)).collect();
        assert_eq!(found, [(FRAMES[2], directions[0]), (FRAMES[3], directions[1])], "{line}");
    }
}

#[test]
fn a_chunk_may_be_a_byte_and_a_frame_may_be_cut() {
    let intake = read("[10:21:33.482]收←◆01\n[10:21:33.484]收←◆03 02 00\n[10:21:33.486]收←◆07 F9 86");
    let expected: [(&[u8], _, _); 3] = [
        (&[1], Response, Some(37_293_482_000)),
        (&[3, 2, 0], Response, Some(37_293_484_000)),
        (&[7, 0xF9, 0x86], Response, Some(37_293_486_000)),
    ];
    assert_eq!(parts(&intake), expected);
    // What is cut goes on in the next line, what is whole does not.
    let intake = read("RX: 01 03 02 00\n    07 F9 86\n01 03 00 31 00 01 D5 C5");
    let expected: [(&[u8], _, _); 3] =
        [(&[1, 3, 2, 0], Response, None), (&[7, 0xF9, 0x86], Response, None), (FRAMES[2], Unknown, None)];
    assert_eq!(parts(&intake), expected);
}

fn frame() -> impl Strategy<Value = (Vec<u8>, Direction, u64)> {
    // A frame comes back whether its check is right or wrong.
    let bytes = (prop::collection::vec(any::<u8>(), 2..40), any::<bool>()).prop_map(|(mut bytes, damaged)| {
        let check = buslens_codec::check::crc16(&bytes);
        bytes.extend((check ^ u16::from(damaged)).to_le_bytes());
        bytes
    });
    (bytes, prop_oneof![Just(Request), Just(Response)], 0..86_400_000_000u64)
}

fn join(bytes: &[u8], before: &str, between: &str) -> String {
    spell(bytes, between, |byte| format!("{before}{byte:02X}"))
}

fn spell(bytes: &[u8], between: &str, spelling: impl Fn(&u8) -> String) -> String {
    bytes.iter().map(spelling).collect::<Vec<_>>().join(between)
}

/// A log line in the manner of a tool.
fn render(
    manner: usize,
    number: usize,
    (bytes, direction, time_us): &(Vec<u8>, Direction, u64),
) -> (String, Option<u64>) {
    let pick = |sent, received| if *direction == Request { sent } else { received };
    let seconds = time_us / 1_000_000;
    let clock = format!("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
    let (ms, us) = (time_us / 1000 % 1000, time_us % 1_000_000);
    let at_ms = Some(time_us / 1000 * 1000);
    let plain = join(bytes, "", " ");
    let low = spell(bytes, " ", |byte| format!("0x{byte:x}"));
    let escaped: String = spell(bytes, "", |byte| format!("\\x{byte:02x}"));
    match manner {
        0 => (format!("{}:{number:06}-{plain}", pick("Tx", "Rx")), None),
        1 => (format!("[RTU]>{} > {clock}:{ms:03} - {}", pick("Tx", "Rx"), join(bytes, "", "  ")), at_ms),
        2 => (format!("[{clock}.{ms:03}]{}{plain} □", pick("发→◇", "收←◆")), at_ms),
        3 => (
            format!("2024-05-01 {clock},{ms:03} DEBUG t:1 {}: {}", pick("SEND", "RECV"), low),
            at_ms.map(|us| us + DAY_US),
        ),
        4 => (format!("{} instrument: {plain} ({} bytes)", pick("Will write to", "Response from"), bytes.len()), None),
        5 => (format!("{} instrument: '{escaped}'", pick("Writing to", "Response from")), None),
        6 => (
            format!("{number},2024-05-01T{clock}.{us:06}Z,{},{}", pick("TX", "RX"), join(bytes, "", "")),
            Some(time_us + DAY_US),
        ),
        7 => (format!("{clock}.{us:06} {} {}", pick(">>", "<<"), join(bytes, "", "-")), Some(*time_us)),
        8 => (spell(bytes, "", |byte| format!("{}{byte:02X}{}", pick("[", "<"), pick("]", ">"))), None),
        _ => (format!("{}：{}", pick("发送", "接收"), join(bytes, "0x", ", ")), None),
    }
}

proptest! {
    #[test]
    fn random_frames_come_back_from_every_manner(frames in prop::collection::vec(frame(), 1..8), manner in 0usize..10) {
        let lines: Vec<_> = frames.iter().enumerate().map(|(number, frame)| render(manner, number + 1, frame)).collect();
        let text: String = lines.iter().flat_map(|(line, _)| [line, "\n"]).collect();
        let intake = read_as(&text, Form::Log);
        let expected: Vec<_> = frames.iter().zip(&lines).map(|((bytes, direction, _), (_, time_us))| (&bytes[..], *direction, *time_us)).collect();
        prop_assert_eq!(parts(&intake), expected, "{}", text);
        prop_assert_eq!(intake.fault_count, 0);
        // Square brackets alone are no log.
        if manner != 8 || frames.iter().any(|(_, direction, _)| *direction == Response) {
            prop_assert_eq!(read(&text).form, Form::Log, "{}", text);
        }
    }

    #[test]
    fn random_bytes_come_back_from_every_spelling(bytes in prop::collection::vec(any::<u8>(), 1..80), manner in 0usize..9) {
        let escaped: String = spell(&bytes, "", |byte| format!("\\x{byte:02x}"));
        let text = match manner {
            0 => join(&bytes, "", " "),
            1 => join(&bytes, "", ""),
            2 => join(&bytes, "0x", ", "),
            3 => escaped,
            4 => format!("b'{escaped}'"),
            5 => format!("uint8_t frame[{}] = {{{}}};", bytes.len(), join(&bytes, "0x", ", ")),
            6 => join(&bytes, "", "\n"),
            7 => format!("[{}]", spell(&bytes, ", ", u8::to_string)),
            _ => format!("bytes([{}])", spell(&bytes, ", ", u8::to_string)),
        };
        let form = if manner > 6 { Form::Decimal } else { Form::Hex };
        let intake = read_as(&text, form);
        prop_assert_eq!((&intake.bytes, intake.fault_count), (&bytes, 0));
        if bytes.len() > 3 && manner != 6 {
            prop_assert_eq!(read(&text).bytes, bytes);
        }
    }
}
