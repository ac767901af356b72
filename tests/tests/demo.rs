//! Every device can be tried without hardware.

use std::collections::BTreeSet;

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_tests::pages::{ConsolePage, LivePage, State};
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

/// The simulated line is a program that is loaded when somebody first connects to it; by then the network may be gone.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_simulator_that_could_not_be_loaded_is_told_and_tried_again() {
    let bench = Bench::new(Line::new([Lvdt::new(1, Motion::Swing)], 1)).await;
    let browser = &bench.browser;
    let page = LivePage::open(browser).await;
    let mut withheld = browser.withhold("/buslens-simulator-");
    browser.click("demo").await;
    page.wait_for(State::Failed).await;
    let told = page.fault("not-loaded").await;
    assert!(told.contains("simulated sensor") && told.contains("network"), "{told}");
    // The script comes, and the program that it starts does not.
    withheld.instead(".wasm");
    browser.run("document.querySelector('[data-test=fault]').dataset.seen = 'yes'").await;
    browser.click("connect-again").await;
    browser.wait_for("document.querySelector('[data-test=fault][data-fault=not-loaded]:not([data-seen])')").await;
    withheld.end();
    browser.click("connect-again").await;
    page.wait_for(State::Reading).await;
    assert!(page.is_faultless().await);
    page.watch_displacement().await;
    browser.wait_for("displacements.length >= 3").await;
}

/// The supply of the simulated sensor can be cut, which no setting of the port does.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_simulated_sensor_can_be_power_cycled() {
    let bench = Bench::new(Line::new([Lvdt::new(1, Motion::Swing)], 1)).await;
    let browser = &bench.browser;
    let live = LivePage::open(browser).await;
    browser.choose("profile", "level").await;
    browser.click("demo").await;
    live.wait_for(State::Reading).await;
    let console = ConsolePage::open(browser).await;
    console.switch("polling", false).await;
    // A zero offset that is not saved: there until the supply fails.
    console.send("01 06 00 0C 00 32").await;
    console.wait_for_row("RX", "01 06 00 0C 00 32 C8 1C").await;
    console.send("01 03 00 0C 00 01").await;
    console.wait_for_row("RX", "01 03 02 00 32 39 91").await;
    browser.click("line-power-cycle").await;
    console.send("01 03 00 0C 00 01").await;
    console.wait_for_row("RX", "01 03 02 00 00 B8 44").await;
    assert_eq!(browser.complaints().await, [""; 0]);
}

/// What is written to the simulated sensor stays written while the page lives, as with a real one.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_simulated_sensor_stays_what_it_was_set_to() {
    let bench = Bench::new(Line::new([Lvdt::new(1, Motion::Swing)], 1)).await;
    let browser = &bench.browser;
    let live = LivePage::open(browser).await;
    browser.click("demo").await;
    live.wait_for(State::Reading).await;
    let console = ConsolePage::open(browser).await;
    console.wait_for_line("simulated").await;
    // The baud rate becomes 19200.
    console.send("01 10 00 31 00 01 02 00 04").await;
    console.result("answered").await;
    live.wait_for(State::Failing).await;
    let demonstrate = async |state: State| {
        browser.click("disconnect").await;
        live.wait_for(State::Closed).await;
        browser.click("demo").await;
        live.wait_for(state).await;
    };
    // Closing the port is no power failure, and a power failure would change nothing: it is still at 19200.
    demonstrate(State::Failing).await;
    console.set_line("baud", "19200").await;
    console.apply_line().await;
    live.wait_for(State::Reading).await;
    // Where it was last read, it is looked for.
    demonstrate(State::Reading).await;
    // Another device in between.
    browser.click("disconnect").await;
    live.wait_for(State::Closed).await;
    browser.choose("profile", "level").await;
    browser.click("demo").await;
    live.wait_for(State::Reading).await;
    browser.click("disconnect").await;
    live.wait_for(State::Closed).await;
    browser.choose("profile", "lvdt").await;
    browser.click("demo").await;
    live.wait_for(State::Reading).await;
    // A fresh page has a sensor from the factory.
    browser.reload().await;
    console.wait().await;
    browser.click("demo").await;
    live.wait_for(State::Reading).await;
    console.send("01 03 00 31 00 01").await;
    assert!(console.result("answered").await.contains("9600"));
    assert_eq!(browser.complaints().await, [""; 0]);
}
