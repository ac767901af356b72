//! The Builder page.

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_tests::pages::{BuilderPage, DecoderPage};
use buslens_tests::testbed::Bench;

async fn bench() -> Bench<Line<Lvdt>> {
    Bench::new(Line::new([Lvdt::new(1, Motion::Swing)], 1)).await
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_command_and_a_setting_of_a_device_become_the_manuals_frames() {
    let bench = bench().await;
    let page = BuilderPage::open(&bench.browser).await;
    page.choose_point("lvdt", "write:zero").await;
    page.wait_for_rtu("01 05 00 50 FF 00 8C 2B").await;
    page.wait_for_ascii(": 0 1 0 5 0 0 5 0 F F 0 0 A B CR LF").await;
    page.choose_point("lvdt", "write:parity").await;
    page.choose_value(2).await;
    page.wait_for_rtu("01 10 00 32 00 01 02 00 02 23 83").await;
    bench.browser.reload().await;
    page.wait().await;
    page.wait_for_rtu("01 10 00 32 00 01 02 00 02 23 83").await;
    bench.browser.click("take-apart-rtu").await;
    let decoder = DecoderPage { browser: &bench.browser };
    assert!(decoder.rows(1).await[0].contains("even"));
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_wrong_field_is_told_with_its_range_and_kept() {
    let bench = bench().await;
    let page = BuilderPage::open(&bench.browser).await;
    page.choose_function("03").await;
    page.fill("quantity", "126").await;
    page.wait_for_note("quantity", "from 1 to 125").await;
    page.fill("unit", "248").await;
    page.wait_for_note("unit", "reserved").await;
    bench.browser.wait_for("!document.querySelector('[data-test=frame-rtu]')").await;
    page.calculate("FF").await;
    page.fill("quantity", "0x7D").await;
    page.fill("unit", "0x01").await;
    page.fill("address", "0x31").await;
    page.wait_for_rtu("01 03 00 31 00 7D D4 24").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_devices_answer_is_faked_also_with_a_wrong_check() {
    let bench = bench().await;
    let page = BuilderPage::open(&bench.browser).await;
    page.choose_point("lvdt", "read:displacement").await;
    bench.browser.click("way-response").await;
    page.fill("unit", "12").await;
    page.fill("point-value", "-0.328").await;
    page.wait_for_rtu("0C 04 04 80 00 01 48 0F 22").await;
    bench.browser.click("builder-wrong-check").await;
    page.wait_for_rtu("0C 04 04 80 00 01 48 0F 23").await;
    bench.browser.wait_for("document.querySelector('[data-test=wrong-check-tag]')").await;
    bench.browser.click("builder-wrong-check").await;
    bench.browser.click("way-exception").await;
    page.wait_for_rtu("0C 84 02 53 02").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_frame_is_copied_in_the_spelling_of_a_program() {
    let bench = bench().await;
    let page = BuilderPage::open(&bench.browser).await;
    page.choose_point("lvdt", "write:zero").await;
    page.wait_for_rtu("01 05 00 50 FF 00 8C 2B").await;
    assert_eq!(page.copy("spaced").await, "01 05 00 50 FF 00 8C 2B");
    assert_eq!(page.copy("c").await, "{ 0x01, 0x05, 0x00, 0x50, 0xFF, 0x00, 0x8C, 0x2B }");
    bench.browser.click("spelled-ascii").await;
    assert_eq!(page.copy("characters").await, ":01050050FF00AB<CR><LF>");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_calculator_tells_both_checks() {
    let bench = bench().await;
    let page = BuilderPage::open(&bench.browser).await;
    page.calculate("01 03 00 31 00 01").await;
    page.wait_for_sums("D5 C5", "CA").await;
    assert_eq!(bench.browser.text("ends-with-crc").await, "the last two bytes are no CRC");
    page.calculate("01 03 00 31 00 01 D5 C5").await;
    bench
        .browser
        .wait_for("document.querySelector('[data-test=ends-with-crc]')?.innerText.includes('are the right')")
        .await;
    page.calculate("01 03\n00 0x xyz").await;
    let error = "document.querySelector('[data-test=calculator-error]')?.innerText.includes('Line 2, column 4')";
    bench.browser.wait_for(error).await;
}
