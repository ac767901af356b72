//! What each device can be told and what its readings are seen with, through the browser's own serial port stack.

use std::collections::BTreeMap;
use std::time::Duration;

use buslens_bus::sim::{Course, Device, GaugeCable, Level, Line, Lvdt, Motion, Reply};
use buslens_bus::time::Instant;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::{UnitId, rtu};
use buslens_tests::pages::{ConsolePage, Handling, LivePage, State, is_read_only, set_read_only};
use buslens_tests::testbed::{Bench, FarEnd, Registers, Relay};

/// Longer than any exchange takes.
const SOON: Duration = Duration::from_secs(10);

fn lvdt(micrometres: i32) -> Line<Lvdt> {
    Line::new([Lvdt::new(1, Motion::Rest { micrometres, decidegrees: 255 })], 1)
}

fn cable(micrometres: i32) -> Line<GaugeCable> {
    Line::new([GaugeCable::new(1, Course::Rest(micrometres), Instant::ZERO)], 1)
}

fn level(value: i32) -> Line<Level> {
    Line::new([Level::new(1, Course::Rest(value))], 1)
}

/// A request to unit 1 as it goes over the line.
fn frame(pdu: &[u8]) -> Vec<u8> {
    rtu::encode(UnitId(1), pdu).expect("a short frame")
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
}

/// How often a frame stands among bytes.
fn times(bytes: &[u8], frame: &[u8]) -> usize {
    bytes.windows(frame.len()).filter(|window| *window == frame).count()
}

/// Everything that was sent and is no read.
fn writes<F: FarEnd>(bench: &Bench<F>) -> usize {
    bench.wire().sent().chunks_exact(8).filter(|request| !matches!(request[1], 1..=4)).count()
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn limits_and_settings_are_read_once_beside_the_poll() {
    let bench = Bench::new(level(6000)).await;
    let page = Handling::connect(&bench.browser, "level").await;
    page.wait_for_context("zero_offset", "0.000 mH₂O").await;
    page.wait_for_context("range_full", "10.000 mH₂O").await;
    page.live().wait_for_count("replies", 30).await;
    let sent = bench.wire().sent();
    for register in [0x05, 0x06, 0x0C] {
        assert_eq!(times(&sent, &frame(&[3, 0, register, 0, 1])), 1, "{register}");
    }
    assert!(times(&sent, &frame(&[3, 0, 4, 0, 1])) > 5);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_level_is_shown_in_the_preferred_unit_and_stays_so() {
    let bench = Bench::new(level(6000)).await;
    let page = Handling::connect(&bench.browser, "level").await;
    let live = page.live();
    live.wait_for_figure("value", "6.000 mH₂O").await;
    assert_eq!(live.converted_from().await, "");
    page.wait_for_share("60.0 % of the range").await;
    let shown = [
        ("kPa", "58.840 kPa"),
        ("Pa", "58840 Pa"),
        ("MPa", "0.058840 MPa"),
        ("bar", "0.58840 bar"),
        ("mbar", "588.40 mbar"),
        ("kg/cm²", "0.6000 kg/cm²"),
        ("psi", "8.534 psi"),
        ("mmH₂O", "6000 mmH₂O"),
    ];
    for (unit, text) in shown {
        live.show_in(unit).await;
        live.wait_for_figure("value", text).await;
        assert_eq!(live.converted_from().await, "converted from 6.000 mH₂O");
    }
    page.wait_for_context("range_full", "10000 mmH₂O").await;
    page.wait_for_share("60.0 % of the range").await;
    live.show_in("psi").await;
    page.reload().await;
    let page = Handling::connect(&bench.browser, "level").await;
    page.live().wait_for_figure("value", "8.534 psi").await;
    page.live().show_in("mH₂O").await;
    page.live().wait_for_figure("value", "6.000 mH₂O").await;
    assert_eq!(page.live().converted_from().await, "");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_level_beyond_its_range_is_marked_and_said() {
    let bench = Bench::new(level(9_999)).await;
    let page = Handling::connect(&bench.browser, "level").await;
    let live = page.live();
    live.wait_for_figure("value", "9.999 mH₂O").await;
    page.wait_for_share("100.0 % of the range").await;
    live.wait_for_beyond("value", "").await;
    bench.wire().with(|line, _| line.device_mut(0).unwrap().course = Course::Rest(10_001));
    live.wait_for_beyond("value", "above the range, which ends at 10.000 mH₂O").await;
    bench.wire().with(|line, _| line.device_mut(0).unwrap().course = Course::Rest(-1));
    live.wait_for_beyond("value", "below the range, which begins at 0.000 mH₂O").await;
    live.show_in("mmH₂O").await;
    live.wait_for_beyond("value", "below the range, which begins at 0 mmH₂O").await;
    bench.wire().with(|line, _| line.device_mut(0).unwrap().course = Course::Rest(0));
    live.wait_for_beyond("value", "").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn an_lvdt_is_zeroed_and_its_zero_cancelled() {
    let bench = Bench::new(lvdt(1_234)).await;
    let page = Handling::connect(&bench.browser, "lvdt").await;
    page.live().wait_for_figure("displacement", "1.234 mm").await;
    page.live().wait_for_figure("temperature", "25.5 °C").await;
    page.wait_for_context("sample_rate", "10 Hz").await;
    page.wait_for_context("compensation", "off").await;
    let zero = frame(&[5, 0, 0x50, 0xFF, 0]);
    let question = {
        page.press("zero", 0xFF00).await;
        page.question().await
    };
    assert!(question.contains("zero here"), "{question}");
    assert_eq!(times(&bench.wire().sent(), &zero), 0, "nothing is sent before the answer");
    page.confirm().await;
    let told = page.outcome("done").await;
    assert!(told.contains("confirmed"), "{told}");
    page.live().wait_for_figure("displacement", "0.000 mm").await;
    assert_eq!(times(&bench.wire().sent(), &zero), 1);
    assert_eq!(page.frames().await, [hex(&zero), hex(&zero)]);
    let marks = page.marks().await;
    assert!(marks.len() == 1 && marks[0].contains("zeroed"), "{marks:?}");
    page.give("zero", 0).await;
    page.outcome("done").await;
    page.live().wait_for_figure("displacement", "1.234 mm").await;
    assert_eq!(times(&bench.wire().sent(), &frame(&[5, 0, 0x50, 0, 0])), 1);
    assert_eq!(page.marks().await, [""; 0]);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_gauge_is_zeroed_and_its_record_cleared() {
    let bench = Bench::new(cable(1_000)).await;
    let page = Handling::connect(&bench.browser, "gauge-cable").await;
    let live = page.live();
    live.wait_for_figure("reading", "1.000 mm").await;
    bench.wire().with(|line, now| line.device_mut(0).unwrap().set_course(now, Course::Rest(-4_661)));
    let figures = async |reading: &str, maximum: &str, minimum: &str, range: &str| {
        live.wait_for_figure("reading", reading).await;
        live.wait_for_figure("maximum", maximum).await;
        live.wait_for_figure("minimum", minimum).await;
        live.wait_for_figure("range", range).await;
    };
    figures("−4.661 mm", "1.000 mm", "−4.661 mm", "5.661 mm").await;
    let notes = page.notes().await;
    assert!(notes.contains("key") && notes.contains("host"), "{notes}");
    page.give("clear_record", 0).await;
    page.outcome("done").await;
    figures("−4.661 mm", "−4.661 mm", "−4.661 mm", "0.000 mm").await;
    assert_eq!(times(&bench.wire().sent(), &frame(&[6, 2, 0, 0, 0])), 1);
    page.give("zero", 0xAB56).await;
    page.outcome("done").await;
    figures("0.000 mm", "0.000 mm", "0.000 mm", "0.000 mm").await;
    assert_eq!(times(&bench.wire().sent(), &frame(&[6, 8, 0, 0xAB, 0x56])), 1);
    // The gauge's own key zeroes the gauge and leaves the record.
    bench.wire().with(|line, now| line.device_mut(0).unwrap().set_course(now, Course::Rest(-3_661)));
    figures("1.000 mm", "1.000 mm", "0.000 mm", "1.000 mm").await;
    bench.wire().with(|line, now| line.device_mut(0).unwrap().zero_by_key(now));
    figures("0.000 mm", "1.000 mm", "0.000 mm", "1.000 mm").await;
    // All lengths of a device are shown in the same unit.
    live.show_in("µm").await;
    figures("0 µm", "1000 µm", "0 µm", "1000 µm").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn what_can_lose_settings_waits_until_every_cost_is_accepted() {
    let bench = Bench::new(level(6000)).await;
    let page = Handling::connect(&bench.browser, "level").await;
    page.unfold_risky().await;
    page.press("save", 1).await;
    let question = page.question().await;
    assert!(question.contains("restore"), "{question}");
    assert!(!page.can_confirm().await);
    assert_eq!(writes(&bench), 0);
    page.accept_all().await;
    page.confirm().await;
    page.outcome("done").await;
    assert_eq!(times(&bench.wire().sent(), &frame(&[6, 0, 0x0F, 0, 1])), 1);
    // What costs nothing is not asked.
    page.press("save", 0).await;
    page.outcome("done").await;
    assert_eq!(times(&bench.wire().sent(), &frame(&[6, 0, 0x0F, 0, 0])), 1);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn after_a_factory_reset_the_sensor_is_read_again_by_itself() {
    let mut wire = lvdt(1_234);
    assert!(wire.device_mut(0).unwrap().preset(0x31, 4));
    let bench = Bench::new(wire).await;
    let figures = LivePage::open(&bench.browser).await;
    figures.choose_device("lvdt").await;
    figures.set_line(19_200, Parity::Even).await;
    figures.connect().await;
    figures.wait_for(State::Reading).await;
    let page = Handling::open(&bench.browser).await;
    page.unfold_risky().await;
    page.press("factory_reset", 0xFF00).await;
    assert!(!page.can_confirm().await);
    page.accept_all().await;
    page.confirm().await;
    page.outcome("done").await;
    bench.wire().wait_for_settings(LineSettings::new(9600, Parity::Even), SOON);
    figures.wait_for(State::Reading).await;
    figures.wait_for_figure("displacement", "1.234 mm").await;
    assert_eq!(times(&bench.wire().sent(), &frame(&[5, 0, 0x51, 0xFF, 0])), 1);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_refusal_is_told_by_its_meaning_and_with_both_frames() {
    let input = BTreeMap::from([(2, 0), (3, 285), (4, 0), (5, 328)]);
    let registers = Registers { unit: 1, input, ..Registers::default() };
    let bench = Bench::with_wire(Relay::serve(registers)).await;
    let live = LivePage::open(&bench.browser).await;
    live.set_line(9600, Parity::None).await;
    live.connect().await;
    live.wait_for(State::Reading).await;
    let page = Handling::open(&bench.browser).await;
    page.give("zero", 0xFF00).await;
    let told = page.outcome("refused").await;
    assert!(told.contains("02") && told.contains("address"), "{told}");
    assert_eq!(page.frames().await, [hex(&frame(&[5, 0, 0x50, 0xFF, 0])), hex(&frame(&[0x85, 2]))]);
    assert_eq!(page.marks().await, [""; 0]);
    page.dismiss().await;
}

/// A sensor whose replies to commands get lost.
struct Mute(Lvdt);

impl Device for Mute {
    fn line(&self) -> LineSettings {
        self.0.line()
    }

    fn mode(&self) -> Mode {
        self.0.mode()
    }

    fn is_listening(&self, now: Instant) -> bool {
        self.0.is_listening(now)
    }

    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
        let reply = self.0.serve(now, unit, pdu);
        reply.filter(|_| pdu.first() != Some(&5))
    }
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_command_without_an_answer_is_not_sent_twice_and_says_what_to_try() {
    let motion = Motion::Rest { micrometres: 1_234, decidegrees: 255 };
    let bench = Bench::new(Line::new([Mute(Lvdt::new(1, motion))], 1)).await;
    let page = Handling::connect(&bench.browser, "lvdt").await;
    page.give("zero", 0xFF00).await;
    let told = page.outcome("unproven").await;
    assert!(told.contains("reading"), "{told}");
    let zero = frame(&[5, 0, 0x50, 0xFF, 0]);
    assert_eq!(page.frames().await, [hex(&zero), String::new()]);
    assert_eq!(page.marks().await, [""; 0], "nobody knows whether it is zeroed");
    // It was all the same.
    page.live().wait_for_figure("displacement", "0.000 mm").await;
    assert_eq!(times(&bench.wire().sent(), &zero), 1);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn read_only_is_one_switch_on_every_page_and_blocks_every_write() {
    let bench = Bench::new(lvdt(1_234)).await;
    let page = Handling::connect(&bench.browser, "lvdt").await;
    page.unlocked().await;
    page.set_read_only(true).await;
    let why = page.locked("read-only").await;
    assert!(why.contains("Read only"), "{why}");
    assert!(!page.is_any_enabled().await);
    // The Console page has the same switch, and its sends meet the same wall.
    let console = ConsolePage::open(&bench.browser).await;
    console.wait_for_line("open").await;
    bench.browser.wait_for("document.querySelector('[data-test=line-read-only][aria-checked=true]')").await;
    console.send("01 05 00 50 FF 00").await;
    console.result("read-only").await;
    assert_eq!(writes(&bench), 0);
    console.switch("read-only", false).await;
    assert!(!is_read_only(&bench.browser).await);
    set_read_only(&bench.browser, true).await;
    bench.browser.wait_for("document.querySelector('[data-test=line-read-only][aria-checked=true]')").await;
    for address in ["#/decoder", "#/builder", "#/live"] {
        bench.browser.run(&format!("location.hash = '{address}'")).await;
        assert!(is_read_only(&bench.browser).await, "{address}");
    }
    // It outlives the page: what was safe stays so.
    page.reload().await;
    assert!(is_read_only(&bench.browser).await);
    let page = Handling::connect(&bench.browser, "lvdt").await;
    page.locked("read-only").await;
    page.set_read_only(false).await;
    page.unlocked().await;
    page.give("zero", 0xFF00).await;
    page.outcome("done").await;
    assert_eq!(times(&bench.wire().sent(), &frame(&[5, 0, 0x50, 0xFF, 0])), 1);
}
