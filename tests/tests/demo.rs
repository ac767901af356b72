//! Every device can be tried without hardware.

use std::collections::BTreeSet;

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_tests::pages::{LivePage, State};
use buslens_tests::testbed::Bench;

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn each_device_shows_a_moving_reading_in_its_unit() {
    let bench = Bench::new(Line::new([Lvdt::new(1, Motion::Swing)], 1)).await;
    let browser = &bench.browser;
    let page = LivePage::open(browser).await;
    // With the factory settings of each line, whatever the fields say.
    page.set_unit(9).await;
    let devices = [("lvdt", "displacement", "mm"), ("gauge-cable", "reading", "mm"), ("level", "value", "mH₂O")];
    for (device, point, unit) in devices {
        browser.choose("profile", device).await;
        browser.click("demo").await;
        page.wait_for(State::Reading).await;
        let figure = format!("document.querySelector('[data-test=point-{point}]')");
        browser.wait_for(&format!("{figure}.querySelector('[data-test=unit]').innerText.trim() === {unit:?}")).await;
        let value = format!("{figure}.querySelector('[data-test=value]').innerText.trim()");
        let mut seen = BTreeSet::new();
        while seen.len() < 4 {
            let old = seen.iter().map(|text| format!("{text:?}")).collect::<Vec<_>>().join(",");
            let fresh = format!("{figure}.dataset.stale === 'false' && ![{old}].includes({value}) && {value}");
            let text = browser.wait_for(&fresh).await.as_str().expect("the figure's text").to_owned();
            let number: f64 = text.replace('\u{2212}', "-").parse().unwrap_or_else(|_| panic!("{device}: {text:?}"));
            assert!(number.abs() < 100.0, "{device}: {text}");
            seen.insert(text);
        }
        assert!(page.is_faultless().await, "{device}");
        assert_eq!(page.count("bad-checks").await + page.count("exceptions").await, 0, "{device}");
        browser.click("disconnect").await;
        page.wait_for(State::Closed).await;
    }
    assert!(bench.wire().sent().is_empty(), "the simulation must not touch a real port");
    assert_eq!(browser.complaints().await, [""; 0]);
}
