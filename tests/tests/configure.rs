//! The Configure page on a line, through the browser's own serial port stack.

use std::time::{Duration, Instant};

use buslens_bus::sim::{Course, Device, GaugeCable, Level, Line, Lvdt, Motion};
use buslens_bus::time::Instant as BusInstant;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_tests::pages::{ConfigurePage, ConsolePage, LivePage, State};
use buslens_tests::testbed::{Bench, FarEnd, Strike, Struck};

const FACTORY: LineSettings = LineSettings::new(9600, Parity::Even);
/// Long, because a busy machine is no failure.
const LIMIT: Duration = Duration::from_secs(30);
/// Writes 115200 Bd to the register of the baud rate of unit 1.
const WRITE_BAUD: [u8; 11] = [0x01, 0x10, 0x00, 0x31, 0x00, 0x01, 0x02, 0x00, 0x07, 0xE3, 0xB3];

fn lvdt() -> Lvdt {
    Lvdt::new(1, Motion::Rest { micrometres: 123_456, decidegrees: 255 })
}

fn line() -> Line<Lvdt> {
    Line::new([lvdt()], 1)
}

/// A sensor that earlier writes have set otherwise.
fn preset(registers: &[(u16, u16)]) -> Lvdt {
    let mut sensor = lvdt();
    for &(register, value) in registers {
        assert!(sensor.preset(register, value), "{register:04X} takes {value}");
    }
    sensor
}

/// What the sensor holds at its registers 30, 31, 32: unit id, baud rate, parity.
fn held(sensor: &mut Lvdt) -> [u16; 3] {
    let reply = sensor.serve(BusInstant::ZERO + Duration::from_hours(24), UnitId(0), &[3, 0, 0x30, 0, 3]);
    let pdu = reply.expect("it answers a broadcast read").pdu;
    [2, 4, 6].map(|at| u16::from_be_bytes([pdu[at], pdu[at + 1]]))
}

fn has(bytes: &[u8], wanted: &[u8]) -> bool {
    bytes.windows(wanted.len()).any(|window| window == wanted)
}

/// Whether a request of unit 1 with function 10 is among the bytes.
fn wrote(bytes: &[u8]) -> bool {
    has(bytes, &[0x01, 0x10, 0x00])
}

/// The page over a sensor that is being polled with the factory's settings, once everything has been read.
async fn opened<F: FarEnd>(bench: &Bench<F>) -> ConfigurePage<'_> {
    bench.browser.run("location.hash = '#/live'").await;
    let live = LivePage::open(&bench.browser).await;
    live.connect().await;
    live.wait_for(State::Reading).await;
    let page = ConfigurePage::open(&bench.browser).await;
    page.wait_until_read().await;
    page
}

/// The same for another device than the first.
async fn opened_as<'a, F: FarEnd>(bench: &'a Bench<F>, device: &str) -> ConfigurePage<'a> {
    LivePage::open(&bench.browser).await;
    bench.browser.choose("profile", device).await;
    opened(bench).await
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn every_parameter_of_the_lvdt_is_read_when_the_page_is_opened() {
    let bench = Bench::with_wire(buslens_tests::testbed::Wire::new(Line::new([preset(&[(0x003F, 6)])], 1))).await;
    let page = opened(&bench).await;
    assert_eq!(page.points().await, ["address", "baud", "parity", "compensation", "sample_rate", "output_mode"]);
    for (point, value) in [
        ("address", "1"),
        ("baud", "9600"),
        ("parity", "even"),
        ("compensation", "off"),
        ("sample_rate", "50"),
        ("output_mode", "RTU"),
    ] {
        assert_eq!(page.value(point).await, value, "{point}");
    }
    let rate = bench.browser.text("parameter-sample_rate").await;
    assert!(rate.contains("10 Hz") && rate.contains("differs from the factory default"), "{rate}");
    assert!(!wrote(&bench.wire().sent()));
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn every_parameter_of_a_level_transmitter_is_read_with_its_scale_and_unit() {
    for answers_blocks in [true, false] {
        let mut level = Level::new(1, Course::Rest(6000));
        level.answers_blocks = answers_blocks;
        assert!(level.preset(0x000C, 0xFFF4));
        let bench = Bench::new(Line::new([level], 1)).await;
        let page = opened_as(&bench, "level").await;
        for (point, value) in [
            ("address", "1"),
            ("baud", "9600"),
            ("unit", "mH₂O"),
            ("decimals", "3"),
            ("range_zero", "0.000"),
            ("range_full", "10.000"),
            ("zero_offset", "\u{2212}0.012"),
        ] {
            page.wait_for_value(point, value).await;
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_gauge_cable_has_commands_and_no_parameters() {
    let cable = GaugeCable::new(1, Course::Rest(-4661), BusInstant::ZERO);
    let bench = Bench::new(Line::new([cable], 1)).await;
    let live = LivePage::open(&bench.browser).await;
    bench.browser.choose("profile", "gauge-cable").await;
    live.connect().await;
    live.wait_for(State::Reading).await;
    let page = ConfigurePage::open(&bench.browser).await;
    page.command("zero", 0xAB56).await;
    assert_eq!(page.requests().await, ["01 06 08 00 AB 56 74 A4"]);
    page.confirm_all().await;
    page.write().await;
    page.wait_for_ending("done").await;
    assert!(has(&bench.wire().sent(), &[0x01, 0x06, 0x08, 0x00, 0xAB, 0x56]));
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn what_is_not_allowed_is_refused_with_what_is_and_nothing_is_sent() {
    let bench = Bench::new(line()).await;
    let page = opened(&bench).await;
    page.type_value("address", "300").await;
    assert_eq!(page.refusal("address").await, "allowed: 1 to 247");
    page.type_value("address", "2.5").await;
    assert_eq!(page.refusal("address").await, "a whole number is needed");
    page.choose("baud", 7).await;
    page.wait_for_staged("1 change staged, nothing sent · 1 not accepted").await;
    page.review().await;
    let faults = bench.browser.text("review-faults").await;
    assert!(faults.contains("Device address"), "{faults}");
    assert_eq!(bench.browser.run("return document.querySelector('[data-test=write]')").await, serde_json::Value::Null);
    // What is staged outlives the page and a reload of it.
    ConsolePage::open(&bench.browser).await;
    let page = ConfigurePage::open(&bench.browser).await;
    page.wait_for_staged("1 not accepted").await;
    bench.browser.reload().await;
    let page = opened(&bench).await;
    page.wait_for_staged("1 change staged").await;
    assert_eq!((page.typed("address").await, page.typed("baud").await), ("2.5".to_owned(), "0x0007".to_owned()));
    bench.browser.click("revert-address").await;
    bench.browser.click("revert-all").await;
    page.wait_for_staged("Nothing staged").await;
    assert!(!wrote(&bench.wire().sent()));
}

/// A change of how the sensor is reached: the codes, and how the top bar tells it afterwards.
struct Move {
    edits: &'static [(&'static str, u16)],
    settings: &'static str,
    line: LineSettings,
    held: [u16; 3],
    mode: Mode,
    /// How a poll afterwards begins.
    poll: &'static [u8],
}

async fn follow(wanted: &Move) {
    let bench = Bench::new(line()).await;
    let page = opened(&bench).await;
    for &(point, code) in wanted.edits {
        match point {
            "address" => page.type_value(point, &code.to_string()).await,
            _ => page.choose(point, code).await,
        }
    }
    page.review().await;
    assert_eq!(page.planned().await.len(), wanted.edits.len());
    page.confirm_all().await;
    let begun = Instant::now();
    page.write().await;
    page.wait_for_ending("done").await;
    // Of two polls the second follows upon the first one's answer.
    let from = bench.wire().sent().len();
    let polls = |sent: &[u8]| sent.windows(wanted.poll.len()).filter(|window| *window == wanted.poll).count();
    bench.wire().wait_for_sent(from, LIMIT, |sent| polls(sent) > 1);
    page.wait_for_reading_at(wanted.settings).await;
    println!("{}: reading again {:?} after the click", wanted.settings, begun.elapsed());
    assert!(page.outcomes().await.iter().all(|outcome| outcome.ends_with(": confirmed")));
    bench.wire().wait_for_settings(wanted.line, LIMIT);
    let (held, mode) = bench.wire().with(|line, _| {
        let sensor = line.device_mut(0).expect("it is on the line");
        (held(sensor), sensor.mode())
    });
    assert_eq!((held, mode), (wanted.held, wanted.mode));
    page.wait_for_no_journal().await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn after_a_change_of_the_baud_rate_the_page_reads_on() {
    follow(&Move {
        edits: &[("baud", 7)],
        settings: "115200 8E1 · RTU · unit 1",
        line: LineSettings::new(115_200, Parity::Even),
        held: [1, 7, 2],
        mode: Mode::Rtu,
        poll: &[0x01, 0x04, 0x00, 0x02],
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn after_a_change_of_the_parity_the_page_reads_on() {
    follow(&Move {
        edits: &[("parity", 3)],
        settings: "9600 8N1 · RTU · unit 1",
        line: LineSettings::new(9600, Parity::None),
        held: [1, 3, 3],
        mode: Mode::Rtu,
        poll: &[0x01, 0x04, 0x00, 0x02],
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn after_a_change_of_the_unit_id_the_page_reads_on() {
    follow(&Move {
        edits: &[("address", 247)],
        settings: "9600 8E1 · RTU · unit 247",
        line: FACTORY,
        held: [247, 3, 2],
        mode: Mode::Rtu,
        poll: &[0xF7, 0x04, 0x00, 0x02],
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn after_a_change_to_ascii_the_page_reads_on() {
    follow(&Move {
        edits: &[("output_mode", 2)],
        settings: "9600 8E1 · ASCII · unit 1",
        line: FACTORY,
        held: [1, 3, 2],
        mode: Mode::Ascii,
        poll: b":01040002",
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn after_a_change_of_all_of_it_at_once_the_page_reads_on() {
    follow(&Move {
        edits: &[("address", 247), ("baud", 7), ("parity", 3), ("output_mode", 2)],
        settings: "115200 8N1 · ASCII · unit 247",
        line: LineSettings::new(115_200, Parity::None),
        held: [247, 7, 3],
        mode: Mode::Ascii,
        poll: b":F7040002",
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_review_shows_every_frame_before_it_goes_out() {
    let bench = Bench::new(line()).await;
    let page = opened(&bench).await;
    page.choose("baud", 7).await;
    page.review().await;
    assert_eq!(page.requests().await, ["01 10 00 31 00 01 02 00 07 E3 B3"]);
    let card = bench.browser.text("review-card").await;
    assert!(card.contains("115200 8E1 · RTU · unit 1"), "{card}");
    assert!(!wrote(&bench.wire().sent()));
    page.write().await;
    page.wait_for_ending("done").await;
    assert!(has(&bench.wire().sent(), &WRITE_BAUD));
    page.wait_for_value("baud", "115200").await;
    page.wait_for_staged("Nothing staged").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_unit_id_that_another_device_has_is_not_written() {
    let other = Lvdt::new(5, Motion::Rest { micrometres: 0, decidegrees: 200 });
    let bench = Bench::new(Line::new([lvdt(), other], 1)).await;
    let page = opened(&bench).await;
    page.type_value("address", "5").await;
    page.write_all().await;
    let text = page.wait_for_ending("occupied").await;
    assert!(text.contains("unit 5"), "{text}");
    assert!(!wrote(&bench.wire().sent()));
    page.wait_for_reading_at("9600 8E1 · RTU · unit 1").await;
    // What was typed is still there.
    assert_eq!(page.typed("address").await, "5");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn what_loses_settings_needs_its_consequence_confirmed() {
    let mut level = Level::new(1, Course::Rest(6000));
    assert!(level.preset(0x000C, 5));
    let bench = Bench::new(Line::new([level], 1)).await;
    let page = opened_as(&bench, "level").await;
    // To the user area: nothing is lost.
    page.command("save", 0).await;
    assert_eq!(page.confirm_all().await, [""; 0]);
    page.write().await;
    page.wait_for_ending("done").await;
    bench.browser.click("report-close").await;
    // To the factory area: what a restore brings back is overwritten.
    page.command("save", 1).await;
    assert!(!page.can_write().await);
    let hazards = page.confirm_all().await;
    assert!(hazards.len() == 1 && hazards[0].contains("cannot be brought back"), "{hazards:?}");
    bench.browser.click("write").await;
    page.wait_for_ending("done").await;
    assert!(has(&bench.wire().sent(), &[0x01, 0x06, 0x00, 0x0F, 0x00, 0x01]));
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_restored_level_transmitter_is_searched_and_read_again() {
    // The restore brings back 9600 Bd and unit 1.
    let mut level = Level::new(1, Course::Rest(6000));
    assert!(level.preset(0x0000, 9) && level.preset(0x000C, 5));
    let bench = Bench::new(Line::new([level], 1)).await;
    LivePage::open(&bench.browser).await.set_unit(9).await;
    let page = opened_as(&bench, "level").await;
    page.command("restore_factory", 1).await;
    assert!(!page.can_write().await);
    page.confirm_all().await;
    page.write().await;
    page.wait_for_ending("done").await;
    page.wait_for_reading_at("9600 8N1 · RTU · unit 1").await;
    page.wait_for_value("zero_offset", "0.000").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_sensor_reset_to_its_factory_settings_is_found_and_read_again() {
    let sensor = preset(&[(0x0030, 9), (0x0031, 5), (0x0032, 3)]);
    let bench = Bench::new(Line::new([sensor], 1)).await;
    let live = LivePage::open(&bench.browser).await;
    live.set_line(38_400, Parity::None).await;
    live.set_unit(9).await;
    let page = opened(&bench).await;
    page.command("factory_reset", 0xFF00).await;
    assert!(!page.can_write().await);
    let hazards = page.confirm_all().await;
    assert!(hazards[0].contains("What is set now is lost"), "{hazards:?}");
    page.write().await;
    page.wait_for_ending("done").await;
    page.wait_for_reading_at("9600 8E1 · RTU · unit 1").await;
    page.wait_until_read().await;
    page.wait_for_value("baud", "9600").await;
    page.wait_for_no_journal().await;
}

async fn struck(strike: Strike) {
    let bench = Bench::new(Struck::new(line(), &WRITE_BAUD, strike)).await;
    let page = opened(&bench).await;
    page.choose("baud", 7).await;
    page.write_all().await;
    page.wait_for_ending("done").await;
    assert!(bench.wire().with(|line, _| line.has_struck()));
    page.wait_for_reading_at("115200 8E1 · RTU · unit 1").await;
    let held = bench.wire().with(|line, _| held(line.line.device_mut(0).expect("it is on the line")));
    assert_eq!(held, [1, 7, 2]);
    page.wait_for_no_journal().await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_write_whose_reply_is_lost_is_followed() {
    struck(Strike::Lost).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_write_whose_reply_is_corrupted_is_followed() {
    struck(Strike::Corrupted).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_write_whose_reply_is_late_is_followed() {
    struck(Strike::Late(Duration::from_millis(900))).await;
}

/// Loads the page again amidst a change of baud rate and unit id, and goes on from what was kept.
async fn after_a_reload(way: &str, settings: &str, wanted: [u16; 3]) {
    let bench = Bench::new(Struck::new(line(), &WRITE_BAUD, Strike::Dumb)).await;
    let page = opened(&bench).await;
    page.choose("baud", 7).await;
    page.choose("parity", 3).await;
    // Parity goes first, so that the write of the baud rate has no parity, and another CRC is none.
    page.write_all().await;
    bench.wire().wait_for_sent(0, LIMIT, |sent| has(sent, &WRITE_BAUD));
    // The offer stands on every page, also on one that has nothing to do with configuring.
    bench.browser.run("location.hash = '#/live'").await;
    bench.browser.reload().await;
    bench.wire().with(|line, _| line.line.faults.lost_replies = 0);
    let offer = page.wait_for_journal().await;
    assert!(offer.contains("Baud rate") && offer.contains("Parity"), "{offer}");
    LivePage::open(&bench.browser).await.connect().await;
    bench.browser.click(way).await;
    page.wait().await;
    page.wait_for_ending(if way == "journal-finish" { "done" } else { "undone" }).await;
    page.wait_for_reading_at(settings).await;
    let held = bench.wire().with(|line, _| held(line.line.device_mut(0).expect("it is on the line")));
    assert_eq!(held, wanted);
    page.wait_for_no_journal().await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_change_that_a_reload_has_cut_off_is_offered_and_finished() {
    after_a_reload("journal-finish", "115200 8N1 · RTU · unit 1", [1, 7, 3]).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_change_that_a_reload_has_cut_off_is_offered_and_undone() {
    after_a_reload("journal-undo", "9600 8E1 · RTU · unit 1", [1, 3, 2]).await;
}

/// Unplugs the adapter when the baud rate was written; afterwards the sensor is as `sensor`.
async fn unplugged(sensor: Lvdt, way: &str, settings: &str, wanted: [u16; 3]) {
    let mut bench = Bench::new(Struck::new(line(), &WRITE_BAUD, Strike::Dumb)).await;
    {
        let page = opened(&bench).await;
        page.choose("baud", 7).await;
        page.write_all().await;
    }
    bench.wire().wait_for_sent(0, LIMIT, |sent| has(sent, &WRITE_BAUD));
    bench.unplug();
    let page = ConfigurePage { browser: &bench.browser };
    page.wait_for_ending("interrupted").await;
    // Its node is another one: nothing of the old wire is left.
    let far_end = Struck::new(Line::new([sensor], 1), &[0xFF; 16], Strike::Lost);
    bench.plug(far_end);
    let page = ConfigurePage { browser: &bench.browser };
    bench.browser.click(way).await;
    page.wait_for_ending(if way == "report-finish" { "done" } else { "undone" }).await;
    page.wait_for_reading_at(settings).await;
    let held = bench.wire().with(|line, _| held(line.line.device_mut(0).expect("it is on the line")));
    assert_eq!(held, wanted);
    page.wait_for_no_journal().await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn unplugged_before_the_write_arrived_the_change_is_finished() {
    unplugged(lvdt(), "report-finish", "115200 8E1 · RTU · unit 1", [1, 7, 2]).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn unplugged_after_the_write_arrived_the_change_is_undone() {
    unplugged(preset(&[(0x0031, 7)]), "report-undo", "9600 8E1 · RTU · unit 1", [1, 3, 2]).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_sensor_whose_settings_nobody_knows_is_found() {
    let bench = Bench::new(Line::new([preset(&[(0x0030, 77), (0x0031, 4), (0x0032, 3)])], 1)).await;
    let live = LivePage::open(&bench.browser).await;
    live.connect().await;
    live.wait_for(State::Failing).await;
    let page = ConfigurePage::open(&bench.browser).await;
    bench.browser.wait_for("document.querySelector('[data-test=read-fault]')").await;
    bench.browser.click("find").await;
    bench.browser.wait_for("document.querySelector('[data-test=run-phase][data-phase=searching]')").await;
    page.wait_for_ending("found").await;
    page.wait_for_reading_at("19200 8N1 · RTU · unit 77").await;
    page.wait_for_value("address", "77").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn under_read_only_nothing_is_written_and_the_page_says_why() {
    let bench = Bench::new(line()).await;
    let page = opened(&bench).await;
    ConsolePage::open(&bench.browser).await.switch("read-only", true).await;
    let page = ConfigurePage::open(page.browser).await;
    bench.browser.wait_for("document.querySelector('[data-test=configure-blocked][data-why=read-only]')").await;
    page.choose("baud", 7).await;
    page.review().await;
    assert!(!page.can_write().await);
    let why = bench.browser.text("write-blocked").await;
    assert!(why.contains("Read only"), "{why}");
    bench.browser.click("allow-writes").await;
    bench.browser.wait_for("!document.querySelector('[data-test=write]').disabled").await;
    page.write().await;
    page.wait_for_ending("done").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_simulated_sensor_is_configured_like_a_real_one() {
    let bench = Bench::new(line()).await;
    let live = LivePage::open(&bench.browser).await;
    bench.browser.click("demo").await;
    live.wait_for(State::Reading).await;
    let page = ConfigurePage::open(&bench.browser).await;
    page.wait_until_read().await;
    page.choose("baud", 7).await;
    page.choose("output_mode", 2).await;
    page.write_all().await;
    page.wait_for_ending("done").await;
    page.wait_for_reading_at("115200 8E1 · ASCII · unit 1").await;
    assert!(bench.wire().sent().is_empty());
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn saved_parameters_are_staged_where_they_differ() {
    let bench = Bench::new(Line::new([preset(&[(0x003F, 6), (0x0034, 1)])], 1)).await;
    let page = opened(&bench).await;
    let console = ConsolePage { browser: &bench.browser };
    console.catch_files().await;
    bench.browser.click("configure-files").await;
    bench.browser.click("configure-save").await;
    let saved = String::from_utf8(console.saved().await).expect("a file of parameters is text");
    assert!(saved.contains("\"buslens-snapshot\"") && saved.contains("\"0x0006\""), "{saved}");
    bench.browser.click("all-factory").await;
    page.wait_for_staged("2 changes staged").await;
    page.write_all().await;
    page.wait_for_ending("done").await;
    page.wait_until_read().await;
    page.wait_for_value("sample_rate", "10").await;
    let text = serde_json::Value::from(saved);
    let bring = |text: &serde_json::Value| {
        format!(
            "const files = new DataTransfer();
             files.items.add(new File([{text}], 'bench.json'));
             const chooser = document.querySelector('[data-test=configure-file]');
             chooser.files = files.files;
             chooser.dispatchEvent(new Event('change', {{ bubbles: true }}));"
        )
    };
    bench.browser.run(&bring(&text)).await;
    page.wait_for_staged("2 changes staged").await;
    assert_eq!(page.typed("sample_rate").await, "0x0006");
    bench.browser.run(&bring(&"{ \"format\": 1,\n \"kind\": 5 }".into())).await;
    bench.browser.wait_for("document.querySelector('[data-test=file-told]')?.innerText.includes('Line 2')").await;
}
