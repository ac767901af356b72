//! The tables of the three manuals, value by value, through the browser's own serial port stack: what each register takes
//! is written and held, and what it does not take is refused by the page, and by the device where it is forced.
//!
//! The tables stand here once more, as the manuals have them, so that a slip in a profile is found.

use std::collections::BTreeSet;
use std::time::Duration;

use buslens_bus::sim::{Course, Device, GaugeCable, Level, Line, Lvdt, Motion};
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_tests::pages::{ConfigurePage, ConsolePage, Handling, LivePage, State};
use buslens_tests::testbed::{Bench, FarEnd};

/// Longer than any exchange takes.
const SOON: Duration = Duration::from_secs(30);
const RTU: u16 = 1;
const ASCII: u16 = 2;

/// A register that can be written, as its manual's table has it.
struct Row {
    point: &'static str,
    register: u16,
    /// What it takes, as the page shows it; the last is how it leaves the factory, and no two in a row are the same.
    takes: &'static [(u16, &'static str)],
    /// What lies beyond its table.
    refuses: &'static [u16],
    /// What the page says of anything else: what is allowed.
    allowed: &'static str,
}

impl Row {
    const fn new(
        point: &'static str,
        register: u16,
        takes: &'static [(u16, &'static str)],
        refuses: &'static [u16],
        allowed: &'static str,
    ) -> Self {
        Self { point, register, takes, refuses, allowed }
    }
}

/// LVDT manual 3.1, tables 1 to 3; in the order in which the page writes them.
const LVDT: [Row; 6] = [
    Row::new("compensation", 0x0034, &[(1, "on"), (2, "off")], &[0, 3, 65_535], "allowed: on, off"),
    Row::new(
        "sample_rate",
        0x003F,
        &[(1, "1"), (2, "2"), (3, "5"), (5, "20"), (6, "50"), (4, "10")],
        &[0, 7, 65_535],
        "allowed: 1 Hz, 2 Hz, 5 Hz, 10 Hz, 20 Hz, 50 Hz",
    ),
    Row::new(
        "address",
        0x0030,
        &[(2, "2"), (100, "100"), (246, "246"), (247, "247"), (1, "1")],
        &[0, 248, 65_535],
        "allowed: 1 to 247",
    ),
    Row::new("output_mode", 0x0060, &[(ASCII, "ASCII"), (RTU, "RTU")], &[0, 3, 65_535], "allowed: RTU, ASCII"),
    Row::new("parity", 0x0032, &[(1, "odd"), (3, "none"), (2, "even")], &[0, 4, 65_535], "allowed: odd, even, none"),
    Row::new(
        "baud",
        0x0031,
        &[(1, "2400"), (2, "4800"), (4, "19200"), (5, "38400"), (6, "57600"), (7, "115200"), (3, "9600")],
        &[0, 8, 65_535],
        "allowed: 2400 Bd, 4800 Bd, 9600 Bd, 19200 Bd, 38400 Bd, 57600 Bd, 115200 Bd",
    ),
];

/// The level transmitter's protocol, section 4; in the order in which the page writes them.
const LEVEL: [Row; 3] = [
    Row::new(
        "zero_offset",
        0x000C,
        &[(0xFFF4, "\u{2212}0.012"), (0x7FFF, "32.767"), (0x8000, "\u{2212}32.768"), (0, "0.000")],
        // All that 16 bits with sign can hold is a value.
        &[],
        "allowed: \u{2212}32.768 to 32.767",
    ),
    Row::new(
        "address",
        0x0000,
        &[(2, "2"), (247, "247"), (248, "248"), (255, "255"), (1, "1")],
        &[0, 256, 65_535],
        "allowed: 1 to 255",
    ),
    Row::new(
        "baud",
        0x0001,
        &[(0, "1200"), (1, "2400"), (2, "4800"), (4, "19200"), (5, "38400"), (6, "57600"), (7, "115200"), (3, "9600")],
        &[8, 65_535],
        "allowed: 1200 Bd, 2400 Bd, 4800 Bd, 9600 Bd, 19200 Bd, 38400 Bd, 57600 Bd, 115200 Bd",
    ),
];

/// What a device is asked with, of the gauge cable's instructions, sections 2 and 4 to 6.
const GAUGE_READS: [&str; 4] =
    ["01 03 00 00 00 02 C4 0B", "01 03 01 00 00 02 C5 F7", "01 03 02 00 00 02 C5 B3", "01 03 03 00 00 02 C4 4F"];

/// Bytes with the check of RTU behind them, low byte first.
fn rtu(bytes: &[u8]) -> Vec<u8> {
    let crc = bytes.iter().fold(0xFFFF_u16, |crc, &byte| {
        (0..8).fold(crc ^ u16::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xA001 } else { crc >> 1 })
    });
    [bytes, &crc.to_le_bytes()].concat()
}

/// The same as ASCII has it.
fn ascii(bytes: &[u8]) -> Vec<u8> {
    let lrc = bytes.iter().fold(0_u8, |lrc, &byte| lrc.wrapping_sub(byte));
    let digits = hex(&[bytes, &[lrc]].concat()).replace(' ', "");
    format!(":{digits}\r\n").into_bytes()
}

/// Unit id, function 10, one register.
fn write_10(unit: u8, register: u16, value: u16) -> Vec<u8> {
    [&[unit, 0x10][..], &register.to_be_bytes(), &[0, 1, 2], &value.to_be_bytes()].concat()
}

/// Unit id, function 06.
fn write_06(unit: u8, register: u16, value: u16) -> Vec<u8> {
    [&[unit, 6][..], &register.to_be_bytes(), &value.to_be_bytes()].concat()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
}

fn has(bytes: &[u8], wanted: &[u8]) -> bool {
    bytes.windows(wanted.len()).any(|window| window == wanted)
}

fn lvdt() -> Line<Lvdt> {
    Line::new([Lvdt::new(1, Motion::Rest { micrometres: 123_456, decidegrees: 255 })], 1)
}

fn level() -> Line<Level> {
    Line::new([Level::new(1, Course::Rest(6000))], 1)
}

/// What a device holds at a register, past the page; `unit` is where it answers.
fn held<D: Device + 'static>(bench: &Bench<Line<D>>, unit: u8, register: u16) -> u16 {
    let pdu = [&[3][..], &register.to_be_bytes(), &[0, 1]].concat();
    let reply = bench.wire().with(|line, _| {
        let device = line.device_mut(0).expect("it is on the line");
        device.serve(Instant::ZERO + Duration::from_hours(24), UnitId(unit), &pdu)
    });
    let pdu = reply.unwrap_or_else(|| panic!("unit {unit} answers")).pdu;
    assert_eq!(pdu[..2], [3, 2], "{register:04X}: {pdu:02X?}");
    u16::from_be_bytes([pdu[2], pdu[3]])
}

/// How often a device has written to its memory.
fn flash_writes<D: Device + 'static>(bench: &Bench<Line<D>>) -> u32 {
    bench.wire().with(|line, _| line.device_mut(0).expect("it is on the line").flash_writes())
}

/// Connects with a device and waits for its readings.
async fn connect<F: FarEnd>(bench: &Bench<F>, device: &str) {
    let live = LivePage::open(&bench.browser).await;
    live.choose_device(device).await;
    live.connect().await;
    live.wait_for(State::Reading).await;
}

/// The Configure page over a device that is being polled, once everything has been read.
async fn opened<'a, F: FarEnd>(bench: &'a Bench<F>, device: &str) -> ConfigurePage<'a> {
    connect(bench, device).await;
    let page = ConfigurePage::open(&bench.browser).await;
    page.wait_until_read().await;
    page
}

/// The Console page with the line left to it.
async fn quiet<'a, F: FarEnd>(bench: &'a Bench<F>, device: &str) -> ConsolePage<'a> {
    connect(bench, device).await;
    left_alone(bench).await
}

/// The same once it is connected.
async fn left_alone<F: FarEnd>(bench: &Bench<F>) -> ConsolePage<'_> {
    let page = ConsolePage::open(&bench.browser).await;
    page.wait_for_line("open").await;
    page.switch("polling", false).await;
    page.wait_for_quiet().await;
    page
}

/// Stages a value as a user does: a number is typed, a code is chosen.
async fn stage(page: &ConfigurePage<'_>, row: &Row, value: u16, shown: &str) {
    match row.point {
        "address" | "zero_offset" => page.type_value(row.point, &shown.replace('\u{2212}', "-")).await,
        _ => page.choose(row.point, value).await,
    }
}

/// Stages what lies beyond each table, and sees it refused. The editors offer and take nothing else.
async fn refused_by_the_page(page: &ConfigurePage<'_>, rows: &[Row]) {
    for row in rows {
        let is_list = !matches!(row.point, "address" | "zero_offset");
        if is_list {
            let mut codes: Vec<u16> = row.takes.iter().map(|(code, _)| *code).collect();
            codes.sort_unstable();
            let codes: Vec<String> = codes.into_iter().map(|code| format!("0x{code:04X}")).collect();
            assert_eq!(page.choices(row.point).await, codes, "{}", row.point);
        }
        for &value in row.refuses {
            // As digits, and as the register itself.
            for typed in [value.to_string(), format!("0x{value:04X}")] {
                if is_list {
                    page.forge(row.point, &typed).await;
                } else {
                    page.type_value(row.point, &typed).await;
                }
                assert_eq!(page.refusal(row.point).await, row.allowed, "{} = {typed}", row.point);
                page.wait_for_staged("0 changes staged, nothing sent · 1 not accepted").await;
                assert_eq!(
                    page.browser.run("return document.querySelector('[data-test=review]').disabled").await,
                    true
                );
                page.browser.click(&format!("revert-{}", row.point)).await;
                page.wait_for_staged("Nothing staged").await;
            }
        }
    }
}

/// Sends a frame by hand, without its check, and waits for this answer; returns what the page says of it.
async fn forced(page: &ConsolePage<'_>, request: &[u8], answer: &[u8]) -> String {
    page.clear().await;
    page.wait_for_count("0").await;
    page.send(&hex(request)).await;
    page.wait_for_row("TX", &hex(&rtu(request))).await;
    let row = page.wait_for_row("RX", &hex(&rtu(answer))).await;
    page.wait_for_count("2").await;
    [&row, "\n", &page.result("answered").await].concat()
}

/// The same for frames that are answered by exception 03.
async fn refused_by_the_device<F: FarEnd>(page: &ConsolePage<'_>, bench: &Bench<F>, requests: &[Vec<u8>]) {
    let from = bench.wire().sent().len();
    for request in requests {
        let told = forced(page, request, &[request[0], request[1] | 0x80, 3]).await;
        let words = told.lines().filter(|line| line.contains("03") && line.contains("value out of range")).count();
        assert_eq!(words, 2, "{}: {told}", hex(request));
    }
    let all: Vec<u8> = requests.iter().flat_map(|request| rtu(request)).collect();
    assert_eq!(hex(&bench.wire().sent()[from..]), hex(&all));
}

/// What each row is to take in a round.
fn due(rows: &'static [Row], round: usize) -> Vec<(&'static Row, u16, &'static str)> {
    rows.iter().filter_map(|row| row.takes.get(round).map(|&(value, shown)| (row, value, shown))).collect()
}

/// A round's values with their frames, and how the device is reached afterwards: in the top bar's words, and its unit id.
struct Round {
    wanted: Vec<(&'static Row, u16, &'static str)>,
    frames: Vec<Vec<u8>>,
    told: String,
    line: LineSettings,
    unit: u8,
}

/// Writes them through the page and sees them on the wire, in the device and on the page; returns the dangers confirmed.
async fn written_and_held<D: Device + 'static>(
    (bench, page): (&Bench<Line<D>>, &ConfigurePage<'_>),
    round: &Round,
) -> Vec<String> {
    for &(row, value, shown) in &round.wanted {
        stage(page, row, value, shown).await;
    }
    page.review().await;
    assert_eq!(page.requests().await, round.frames.iter().map(|frame| hex(frame)).collect::<Vec<_>>());
    let dangers = page.confirm_all().await;
    let from = bench.wire().sent().len();
    page.write().await;
    page.wait_for_ending("done").await;
    let outcomes = page.outcomes().await;
    assert!(outcomes.iter().all(|outcome| outcome.ends_with(": confirmed")), "{outcomes:?}");
    page.wait_for_reading_at(&round.told).await;
    bench.wire().wait_for_settings(round.line, SOON);
    page.wait_until_read().await;
    let sent = bench.wire().sent()[from..].to_vec();
    for (&(row, value, shown), frame) in round.wanted.iter().zip(&round.frames) {
        assert!(has(&sent, frame), "{}: {} among {}", row.point, hex(frame), hex(&sent));
        page.wait_for_value(row.point, shown).await;
        assert_eq!(held(bench, round.unit, row.register), value, "{}", row.point);
    }
    dangers
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn every_value_of_the_lvdts_table_is_written_and_held() {
    let bench = Bench::new(lvdt()).await;
    let page = opened(&bench, "lvdt").await;
    let (mut unit, mut baud, mut parity, mut mode) = (1_u8, "9600", 2, RTU);
    for round in 0..LVDT.iter().map(|row| row.takes.len()).max().unwrap() {
        let wanted = due(&LVDT, round);
        let mut frames = Vec::new();
        for &(row, value, shown) in &wanted {
            let bytes = write_10(unit, row.register, value);
            frames.push(if mode == ASCII { ascii(&bytes) } else { rtu(&bytes) });
            match row.point {
                "address" => unit = u8::try_from(value).unwrap(),
                "baud" => baud = shown,
                "parity" => parity = value,
                "output_mode" => mode = value,
                _ => {}
            }
        }
        let (letter, bit) = [('O', Parity::Odd), ('E', Parity::Even), ('N', Parity::None)][usize::from(parity) - 1];
        let told = format!("{baud} 8{letter}1 · {} · unit {unit}", if mode == ASCII { "ASCII" } else { "RTU" });
        let round = Round { wanted, frames, told, line: LineSettings::new(baud.parse().unwrap(), bit), unit };
        let writes = flash_writes(&bench);
        written_and_held((&bench, &page), &round).await;
        assert_eq!(usize::try_from(flash_writes(&bench) - writes).unwrap(), round.wanted.len(), "each once");
        let framing = bench.wire().with(|line, _| line.device_mut(0).unwrap().mode());
        assert_eq!(framing, if mode == ASCII { Mode::Ascii } else { Mode::Rtu });
    }
    // All of it is again as it left the factory.
    assert_eq!((unit, baud, parity, mode), (1, "9600", 2, RTU));
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn what_is_beyond_the_lvdts_table_is_refused_by_page_and_sensor() {
    let bench = Bench::new(lvdt()).await;
    quiet(&bench, "lvdt").await;
    let page = ConfigurePage::open(&bench.browser).await;
    page.wait_until_read().await;
    let before = bench.wire().sent();
    refused_by_the_page(&page, &LVDT).await;
    let console = ConsolePage::open(&bench.browser).await;
    console.wait_for_quiet().await;
    assert_eq!(hex(&bench.wire().sent()[before.len()..]), "", "nothing is sent of what is not taken");
    let mut frames: Vec<Vec<u8>> = Vec::new();
    for row in &LVDT {
        frames.extend(row.refuses.iter().map(|&value| write_10(1, row.register, value)));
    }
    // A coil is FF00 or 0000, and the factory reset FF00 only.
    frames
        .extend([&[1, 5, 0, 0x50, 0, 1][..], &[1, 5, 0, 0x50, 0x12, 0x34], &[1, 5, 0, 0x51, 0, 0]].map(<[u8]>::to_vec));
    refused_by_the_device(&console, &bench, &frames).await;
    for row in &LVDT {
        assert_eq!(held(&bench, 0, row.register), row.takes.last().unwrap().0, "{}", row.point);
    }
    assert_eq!(flash_writes(&bench), 0);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn every_value_of_a_level_transmitters_table_is_written_and_held() {
    let bench = Bench::new(level()).await;
    let page = opened(&bench, "level").await;
    let (mut unit, mut baud) = (1_u8, "9600");
    for round in 0..LEVEL.iter().map(|row| row.takes.len()).max().unwrap() {
        let wanted = due(&LEVEL, round);
        let (mut frames, mut dangers) = (Vec::new(), Vec::new());
        for &(row, value, shown) in &wanted {
            frames.push(rtu(&write_06(unit, row.register, value)));
            match row.point {
                "address" => unit = u8::try_from(value).unwrap(),
                "baud" => baud = shown,
                _ => {}
            }
            match (row.point, value) {
                ("address", 248..) => dangers.push(format!("Unit id {value} lies outside the Modbus range (1 to 247)")),
                ("baud", 0..3) => dangers.push(format!("At {shown} Bd")),
                _ => {}
            }
        }
        let line = LineSettings::new(baud.parse().unwrap(), Parity::None);
        let round = Round { wanted, frames, told: format!("{baud} 8N1 · RTU · unit {unit}"), line, unit };
        let told = written_and_held((&bench, &page), &round).await;
        assert_eq!(told.len(), dangers.len(), "{told:?}");
        assert!(told.iter().zip(&dangers).all(|(told, danger)| told.starts_with(danger)), "{told:?}");
    }
    assert_eq!((unit, baud), (1, "9600"));
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn what_is_beyond_a_level_transmitters_table_is_refused_by_page_and_device() {
    let bench = Bench::new(level()).await;
    quiet(&bench, "level").await;
    let page = ConfigurePage::open(&bench.browser).await;
    page.wait_until_read().await;
    let before = bench.wire().sent();
    refused_by_the_page(&page, &LEVEL).await;
    // The zero offset takes all that 16 bits with sign can hold, and no more.
    for (typed, why) in
        [("32.768", LEVEL[0].allowed), ("-32.769", LEVEL[0].allowed), ("0.0001", "at most 3 digits behind the point")]
    {
        page.type_value("zero_offset", typed).await;
        assert_eq!(page.refusal("zero_offset").await, why, "{typed}");
        bench.browser.click("revert-zero_offset").await;
        page.wait_for_staged("Nothing staged").await;
    }
    let console = ConsolePage::open(&bench.browser).await;
    console.wait_for_quiet().await;
    assert_eq!(hex(&bench.wire().sent()[before.len()..]), "", "nothing is sent of what is not taken");
    let mut frames: Vec<Vec<u8>> = Vec::new();
    for row in &LEVEL {
        frames.extend(row.refuses.iter().map(|&value| write_06(1, row.register, value)));
    }
    // To save is 0 or 1, to restore is 1.
    frames.extend([(0x000F, 2), (0x000F, 65_535), (0x0010, 0), (0x0010, 2)].map(|(at, value)| write_06(1, at, value)));
    refused_by_the_device(&console, &bench, &frames).await;
    for row in &LEVEL {
        assert_eq!(held(&bench, 1, row.register), row.takes.last().unwrap().0, "{}", row.point);
    }
    assert_eq!(flash_writes(&bench), 0);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn what_a_level_transmitter_saves_outlives_power_and_restore() {
    let bench = Bench::new(level()).await;
    let page = opened(&bench, "level").await;
    // To the user area: it outlives a power failure.
    page.write_value("zero_offset", "-0.012", "\u{2212}0.012").await;
    let save_user = rtu(&write_06(1, 0x000F, 0));
    assert_eq!(page.carry_out("save", 0).await, hex(&save_user));
    bench.wire().with(|line, now| line.device_mut(0).unwrap().power_cycle(now));
    assert_eq!(held(&bench, 1, 0x000C), 0xFFF4);
    // A restore brings back how it left the factory.
    let restore = rtu(&write_06(1, 0x0010, 1));
    assert_eq!(page.carry_out("restore_factory", 1).await, hex(&restore));
    page.wait_for_value("zero_offset", "0.000").await;
    assert_eq!(held(&bench, 1, 0x000C), 0);
    // To the factory area: from then on a restore brings back this.
    page.write_value("zero_offset", "0.007", "0.007").await;
    let save_factory = rtu(&write_06(1, 0x000F, 1));
    assert_eq!(page.carry_out("save", 1).await, hex(&save_factory));
    page.write_value("zero_offset", "1", "1.000").await;
    assert_eq!(page.carry_out("restore_factory", 1).await, hex(&restore));
    page.wait_for_value("zero_offset", "0.007").await;
    assert_eq!(held(&bench, 1, 0x000C), 7);
    let sent = bench.wire().sent();
    for frame in [save_user, save_factory, restore] {
        assert!(has(&sent, &frame), "{}", hex(&frame));
    }
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_gauge_cable_is_asked_for_four_values_and_refuses_other_commands() {
    let cable = GaugeCable::new(1, Course::Rest(65_535), Instant::ZERO);
    let bench = Bench::new(Line::new([cable], 1)).await;
    let live = Handling::connect(&bench.browser, "gauge-cable").await.live();
    let figures = async |reading: &str, maximum: &str, minimum: &str, range: &str| {
        for (point, text) in [("reading", reading), ("maximum", maximum), ("minimum", minimum), ("range", range)] {
            live.wait_for_figure(point, text).await;
        }
    };
    // The ends of what 16 bits and a sign can say.
    figures("65.535 mm", "65.535 mm", "65.535 mm", "0.000 mm").await;
    bench.wire().with(|line, now| line.device_mut(0).unwrap().set_course(now, Course::Rest(40_000)));
    figures("40.000 mm", "65.535 mm", "40.000 mm", "25.535 mm").await;
    let console = left_alone(&bench).await;
    let sent = bench.wire().sent();
    let asked: BTreeSet<String> = sent.chunks(8).map(hex).collect();
    assert_eq!(asked, GAUGE_READS.map(str::to_owned).into());
    let told = forced(&console, &[1, 3, 0, 0, 0, 2], &[1, 3, 4, 0, 0, 0x9C, 0x40]).await;
    assert!(told.contains("40.000"), "{told}");
    // Zeroing is AB56, clearing is 0.
    let wrong = [(0x0800, 0), (0x0800, 0xAB55), (0x0800, 0x56AB), (0x0200, 1), (0x0200, 0xAB56), (0x0200, 65_535)];
    refused_by_the_device(&console, &bench, &wrong.map(|(at, value)| write_06(1, at, value))).await;
    // Nothing has come of them.
    forced(&console, &[1, 3, 1, 0, 0, 2], &[1, 3, 4, 0, 0, 0xFF, 0xFF]).await;
    // The right ones are echoed, and done.
    let from = bench.wire().sent().len();
    forced(&console, &[1, 6, 2, 0, 0, 0], &[1, 6, 2, 0, 0, 0]).await;
    forced(&console, &[1, 3, 1, 0, 0, 2], &[1, 3, 4, 0, 0, 0x9C, 0x40]).await;
    forced(&console, &[1, 6, 8, 0, 0xAB, 0x56], &[1, 6, 8, 0, 0xAB, 0x56]).await;
    let expected = "01 06 02 00 00 00 88 72 01 03 01 00 00 02 C5 F7 01 06 08 00 AB 56 74 A4";
    assert_eq!(hex(&bench.wire().sent()[from..]), expected);
    console.switch("polling", true).await;
    console.go_to_live().await;
    bench.wire().with(|line, now| line.device_mut(0).unwrap().set_course(now, Course::Rest(-25_535)));
    figures("\u{2212}65.535 mm", "0.000 mm", "\u{2212}65.535 mm", "65.535 mm").await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn an_lvdt_is_read_in_pairs_and_by_nothing_else() {
    let bench = Bench::new(lvdt()).await;
    let console = quiet(&bench, "lvdt").await;
    let polled = bench.wire().sent();
    // The parameters beside the readings are asked for once, alone or as a block.
    assert!(polled.starts_with(&[0x01, 0x04, 0x00, 0x02, 0x00, 0x04, 0x50, 0x09]), "{}", hex(&polled));
    let from = polled.len();
    let told = forced(&console, &[1, 4, 0, 2, 0, 2], &[1, 4, 4, 0, 0, 0, 0xFF]).await;
    assert!(told.contains("25.5"), "{told}");
    let told = forced(&console, &[1, 4, 0, 4, 0, 2], &[1, 4, 4, 0, 0x7B, 1, 0xC8]).await;
    assert!(told.contains("123.456"), "{told}");
    // A whole pair or none, contiguous registers or none.
    for request in [[1, 4, 0, 2, 0, 1], [1, 4, 0, 4, 0, 1], [1, 4, 0, 3, 0, 2], [1, 3, 0, 0x30, 0, 4]] {
        let told = forced(&console, &request, &[1, request[1] | 0x80, 2]).await;
        assert!(told.contains("wrong data address"), "{told}");
    }
    // A write with function 06 is none of its functions.
    let told = forced(&console, &write_06(1, 0x0031, 3), &[1, 0x86, 1]).await;
    assert!(told.contains("function not supported"), "{told}");
    let expected = "01 04 00 02 00 02 D0 0B 01 04 00 04 00 02 30 0A";
    assert!(hex(&bench.wire().sent()[from..]).starts_with(expected));
    // It moves below zero by less than a millimetre, and the sign is there.
    bench.wire().with(|line, _| {
        line.device_mut(0).unwrap().motion = Motion::Rest { micrometres: -328, decidegrees: -1 };
    });
    let told = forced(&console, &[1, 4, 0, 4, 0, 2], &[1, 4, 4, 0x80, 0, 1, 0x48]).await;
    assert!(told.contains("\u{2212}0.328"), "{told}");
    let told = forced(&console, &[1, 4, 0, 2, 0, 2], &[1, 4, 4, 0, 0, 0xFF, 0xFF]).await;
    assert!(told.contains("\u{2212}0.1"), "{told}");
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn an_lvdt_in_ascii_takes_its_commands_and_is_reset_to_rtu() {
    let bench = Bench::new(lvdt()).await;
    let page = opened(&bench, "lvdt").await;
    page.choose("output_mode", ASCII).await;
    page.write_all().await;
    page.wait_for_ending("done").await;
    page.wait_for_reading_at("9600 8E1 · ASCII · unit 1").await;
    page.wait_until_read().await;
    let frames = [
        ("zero", 0xFF00, ":01050050FF00AB\r\n"),
        ("zero", 0x0000, ":010500500000AA\r\n"),
        ("factory_reset", 0xFF00, ":01050051FF00AA\r\n"),
    ];
    for (point, code, frame) in frames {
        let from = bench.wire().sent().len();
        assert_eq!(page.carry_out(point, code).await, hex(frame.as_bytes()), "{point}");
        let sent = bench.wire().sent()[from..].to_vec();
        let written: Vec<&[u8]> =
            sent.split_inclusive(|byte| *byte == b'\n').filter(|line| line.starts_with(b":0105")).collect();
        assert_eq!(written, [frame.as_bytes()], "once");
    }
    page.wait_for_reading_at("9600 8E1 · RTU · unit 1").await;
    page.wait_for_value("output_mode", "RTU").await;
    assert_eq!(held(&bench, 0, 0x0060), RTU);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}
