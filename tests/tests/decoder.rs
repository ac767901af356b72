//! The Decoder page.

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_tests::pages::DecoderPage;
use buslens_tests::testbed::{Bench, site};

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
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_lrc_that_the_manual_prints_wrong_is_told_with_the_right_one() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.paste("3A 30 31 30 33 30 30 33 31 30 30 30 31 43 31 0D 0A").await;
    let rows = page.rows(1).await;
    assert!(rows[0].contains("CA"), "{rows:?}");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_text_that_makes_no_bytes_is_placed_and_kept() {
    let bench = bench().await;
    let page = DecoderPage::open(&bench.browser).await;
    page.paste("01 03 00\n31 00 0x <b>hi</b>").await;
    let error = page.error().await;
    assert!(error.contains("Line 2, column 9"), "{error}");
    let kept = "return document.querySelector('[data-test=decoder-input]').value";
    assert_eq!(bench.browser.run(kept).await, "01 03 00\n31 00 0x <b>hi</b>");
    bench.browser.reload().await;
    bench.browser.wait_for("document.querySelector('[data-test=decoder-input]')?.value.includes('<b>hi')").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_link_opens_its_frame() {
    let bench = bench().await;
    bench.browser.open(&format!("{}/#/decoder?frame=0105005000FF8C2B", site())).await;
    bench.browser.open(&format!("{}/#/decoder?frame=01050050FF008C2B", site())).await;
    bench.browser.wait_for("document.querySelector('[data-test=frame-row]')").await;
    let page = DecoderPage { browser: &bench.browser };
    assert!(page.rows(1).await[0].to_lowercase().contains("zero"));
}
