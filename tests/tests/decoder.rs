//! The Decoder page.

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_tests::pages::DecoderPage;
use buslens_tests::testbed::{Bench, site};

/// A request to the LVDT, as one word.
const REQUEST: &str = "0104000200045009";

async fn bench() -> Bench<Line<Lvdt>> {
    Bench::new(Line::new([Lvdt::new(1, Motion::Swing)], 1)).await
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_pasted_exchange_is_taken_apart_with_its_values() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.paste("01 04 00 02 00 04 50 09\n01 04 08 00 00 01 1D 00 7B 01 C8 B9 C1").await;
    let rows = page.rows(2).await;
    assert!(rows[1].contains("123.456 mm") && rows[1].contains("28.5 °C"), "{rows:?}");
    // Unit, function, address, quantity, check.
    page.fields(5).await;
    bench.browser.click_nth("frame-row", 1).await;
    // Unit, function, byte count, two values, check.
    let fields = page.fields(6).await;
    assert!(fields[4].contains("Displacement") && fields[4].contains("00 7B 01 C8"), "{fields:?}");
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

/// The page's second program is loaded when it is first needed; by then the network may be gone.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn what_could_not_be_loaded_is_told_and_loaded_again() {
    let bench = bench().await;
    bench.browser.wait_for("document.querySelector('[data-test=page-live]')").await;
    bench.browser.set_offline(true).await;
    bench.browser.click("nav-decoder").await;
    bench.browser.wait_for("document.querySelector('[data-test=loading-failed]')").await;
    bench.browser.set_offline(false).await;
    bench.browser.click("load-again").await;
    bench.browser.wait_for("document.querySelector('[data-test=page-decoder]')").await;
    let page = DecoderPage { browser: &bench.browser };
    page.paste("01 03 00 31 00 01 D5 C5").await;
    page.rows(1).await;
}

/// Every frame of the devices' manuals through the page, each alone, with its mark and check.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn every_frame_of_the_manuals_comes_out_right() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.catch_files().await;
    page.paste("01 03 00 31 00 01 D5 C5").await;
    for line in include_str!("../../codec/tests/data/manual_frames.csv").lines().skip(1) {
        let columns: Vec<&str> = line.split(',').collect();
        let (device, mode, direction, frame) = (columns[0], columns[1], columns[2], columns[3]);
        let right = *columns.last().unwrap() == "ok";
        bench.browser.choose("decoder-profile", &device.replace('_', "-")).await;
        let mark = if direction == "request" { "TX" } else { "RX" };
        page.paste(&format!("{mark}: {frame}")).await;
        let digits: String = frame.split(' ').collect();
        let hook = format!(
            "document.querySelectorAll('[data-test=frame-row]').length === 1 &&
             document.querySelector('[data-test=frame-row] .cell-bytes').textContent === {frame:?}"
        );
        bench.browser.wait_for(&hook).await;
        bench.browser.wait_for("document.querySelector('[data-test=statistics]')").await;
        bench.browser.click("export").await;
        bench.browser.click("export-jsonl").await;
        let json: serde_json::Value = serde_json::from_str(&page.saved().await).unwrap();
        assert_eq!(json["mode"], mode, "{line}");
        assert_eq!(json["direction"], direction, "{line}");
        assert_eq!(json["check"]["ok"], right, "{line}");
        if mode == "rtu" {
            assert_eq!(json["bytes"], digits, "{line}");
        }
        if !right {
            assert_eq!(json["check"]["expected"], "CA");
            assert!(page.diagnosis("manual_erratum").await.contains("CA"));
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_lrc_that_the_manual_prints_wrong_is_told_with_the_right_one() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.paste("3A 30 31 30 33 30 30 33 31 30 30 30 31 43 31 0D 0A").await;
    let rows = page.rows(1).await;
    assert!(rows[0].contains("CA"), "{rows:?}");
    page.diagnosis("bad_lrc").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_text_that_makes_no_bytes_is_placed_and_kept() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.paste("01 03 00 31 00 01 D5 C5\n01 03 02 00 07 F9 8G").await;
    let error = page.error().await;
    assert!(error.contains("Line 2, column "), "{error}");
    // Whatever can be decoded is.
    page.rows_at_least(1).await;
    let kept = "return document.querySelector('[data-test=decoder-input]').value";
    assert_eq!(bench.browser.run(kept).await, "01 03 00 31 00 01 D5 C5\n01 03 02 00 07 F9 8G");
    bench.browser.reload().await;
    bench.browser.wait_for("document.querySelector('[data-test=decoder-input]')?.value.endsWith('8G')").await;
    page.error().await;
}

/// A device that calls itself by the name of an element stays a text.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn hostile_names_are_shown_as_text() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.paste("012B0E0101000001001C3C696D67207372633D78206F6E6572726F723D616C6572742831293E1484").await;
    page.rows(1).await;
    bench.browser.wait_for("document.querySelector('[data-test=detail]')?.innerText.includes('<img src=x')").await;
    assert_eq!(bench.browser.run("return document.querySelectorAll('img').length").await, 0);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_link_opens_its_frame_and_a_copied_link_its_text() {
    let bench = bench().await;
    bench.browser.open(&format!("{}/#/decoder?frame=01050050FF008C2B", site())).await;
    bench.browser.wait_for("document.querySelector('[data-test=frame-row]')").await;
    let page = DecoderPage { browser: &bench.browser };
    assert!(page.rows(1).await[0].to_lowercase().contains("zero"));
    page.paste("发: 01 03 00 31 00 01 D5 C5 & more").await;
    page.rows(1).await;
    bench.browser.run("navigator.clipboard.writeText = async (text) => { globalThis.copied = text; }").await;
    bench.browser.click("copy-link").await;
    let link = bench.browser.wait_for("globalThis.copied").await;
    bench.browser.open("about:blank").await;
    bench.browser.open(link.as_str().unwrap()).await;
    bench.browser.wait_for("document.querySelector('[data-test=decoder-input]')?.value.endsWith('C5 & more')").await;
    assert!(page.rows(1).await[0].contains("TX"));
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_log_is_filtered_counted_and_saved() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.paste(
        "[10:00:01.123]发→◇01 03 00 31 00 01 D5 C5 □\n[10:00:01.140]收←◆01 03 02 00 07 F9 86 \n\
         [10:00:02.000]发→◇07 04 00 02 00 04 50 6F □\n[10:00:02.020]收←◆07 84 02 22 C0 \n\
         [10:00:03.000]发→◇01 03 00 31 00 01 D5 C5 □\n[10:00:03.020]收←◆01 03 02 00 07 F9 87 \n",
    )
    .await;
    let rows = page.rows(6).await;
    assert!(rows[0].contains("10:00:01.123") && rows[0].contains("TX"), "{rows:?}");
    assert!(rows[1].contains("115200"), "{rows:?}");
    assert!(bench.browser.text("decoder-form").await.contains("log"));
    bench.browser.click("filter-errors").await;
    page.wait_for_entries("2 of 6").await;
    let errors = page.rows(2).await;
    assert!(errors[0].contains("exception 02") && errors[1].contains("wrong"), "{errors:?}");
    bench.browser.click_nth("frame-row", 1).await;
    let told = page.diagnosis("single_bit_error").await;
    assert!(told.contains("01 03 02 00 07 F9 86"), "{told}");
    bench.browser.click("filter-errors").await;
    bench.browser.fill("filter-unit", "7").await;
    page.wait_for_entries("2 of 6").await;
    page.catch_files().await;
    bench.browser.click("export").await;
    bench.browser.click("export-csv").await;
    let csv = page.saved().await;
    assert_eq!(csv.lines().count(), 3, "{csv}");
    bench.browser.click("clear-filter").await;
    page.wait_for_entries("6").await;
    let statistics = bench.browser.text("statistics").await;
    assert!(statistics.contains("unit 7") && statistics.contains("single_bit_error"), "{statistics}");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn what_the_device_shows_finds_its_encoding() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.paste("0C 04 00 04 00 02 31 17\n0C 04 04 80 00 01 48 0F 22").await;
    page.rows(2).await;
    bench.browser.choose("decoder-profile", "none").await;
    bench.browser.click_nth("frame-row", 1).await;
    bench.browser.click("views").await;
    bench.browser.fill("shown-value", "-0.328").await;
    // The number is typed key by key, and its beginnings fit other encodings: the look at the whole of it comes last.
    let first = "document.querySelector('[data-test=fit-row]')?.innerText";
    bench.browser.wait_for(&format!("{first}.includes('sign_magnitude_thousandths')")).await;
}

/// Ten megabytes of text: rows soon, all of it in time, and the page never blocked. The times are printed, not asserted:
/// a busy machine is no failure; what must hold is what the user sees.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn ten_megabytes_are_listed_scrolled_and_kept() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    let exchange = "01 04 00 02 00 04 50 09\\n01 04 08 00 00 01 1D 00 7B 01 C8 B9 C1\\n";
    // 63 characters an exchange.
    let text = format!("{exchange:?}.replaceAll('\\\\n', '\\n').repeat(166000)");
    page.paste_expression(&text).await;
    page.wait_for_entries("332000").await;
    let last = "const frame = document.querySelector('.list-frame'); frame.scrollTop = frame.scrollHeight;";
    bench.browser.run(last).await;
    bench
        .browser
        .wait_for("document.querySelector('#frame-row-331999 .cell-meaning')?.textContent.includes('123.456')")
        .await;
    // The field holds no long text, and what stood in it before is still there.
    bench.browser.wait_for("document.querySelector('[data-test=decoder-document]')").await;
    bench.browser.reload().await;
    page.wait_for_entries("332000").await;
    bench.browser.click("close-document").await;
    bench.browser.wait_for("document.querySelector('[data-test=decoder-input]')").await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn reading_a_large_file_can_be_stopped() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.drop_file("line.log", "'01 03 00 31 00 01 D5 C5\\n'.repeat(4e6)").await;
    bench.browser.click("stop-reading").await;
    bench.browser.wait_for("document.querySelector('.understood')?.innerText.includes('Stopped')").await;
    page.rows_at_least(1).await;
    bench.browser.click("close-document").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn binary_files_and_chinese_encodings_are_taken() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    // GBK: 发→◇01 03 00 31 00 01 D5 C5
    let gbk = "new Uint8Array([0xB7,0xA2,0xA1,0xFA,0xA1,0xF3, ...new TextEncoder().encode('01 03 00 31 00 01 D5 C5 \\r\\n')])";
    page.drop_file("sscom.txt", gbk).await;
    assert!(page.rows(1).await[0].contains("TX"));
    page.drop_file("firmware.bin", "new Uint8Array(5000).map((_, at) => at * 7)").await;
    assert!(page.error().await.contains("not text"));
    page.drop_file("empty.txt", "''").await;
    bench.browser.wait_for("!document.querySelector('[data-test=frame-row]')").await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_list_is_used_by_keys_alone() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.paste(&format!("{REQUEST}\n").repeat(100)).await;
    page.wait_for_entries("100").await;
    let press = |key: &str| {
        format!(
            "const list = document.querySelector('.list-frame');
             list.dispatchEvent(new KeyboardEvent('keydown', {{ key: {key:?}, bubbles: true, cancelable: true }}));"
        )
    };
    bench.browser.run(&press("End")).await;
    bench.browser.wait_for("document.querySelector('#frame-row-99[aria-selected=true]')").await;
    bench.browser.run(&press("ArrowUp")).await;
    bench.browser.wait_for("document.querySelector('#frame-row-98[aria-selected=true]')").await;
    bench.browser.run(&press("Home")).await;
    bench.browser.wait_for("document.querySelector('#frame-row-0[aria-selected=true]')").await;
}
