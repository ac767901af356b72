//! The device's own help.

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_tests::pages::{HelpSheet, LivePage, State};
use buslens_tests::testbed::Bench;

async fn bench() -> Bench<Line<Lvdt>> {
    Bench::new(Line::new([Lvdt::new(1, Motion::Swing)], 1)).await
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn each_device_tells_its_wires_settings_limits_and_what_to_try() {
    let bench = bench().await;
    let browser = &bench.browser;
    LivePage::open(browser).await;
    let devices = [
        ("lvdt", "LVDT", vec!["V+", "V\u{2212}", "A", "B"], "9600 8E1", "1.5 s", "broadcast address"),
        ("gauge-cable", "217/218", vec!["RXD", "TXD", "+5V", "GND"], "38400 8N1", "65.535", "ABS mode"),
        ("level", "level transmitter", vec![], "9600 8N1", "1 to 255", "user area"),
    ];
    for (device, name, wires, line, limit, remedy) in devices {
        browser.choose("profile", device).await;
        let sheet = HelpSheet::open(browser).await;
        sheet.wait_for_title(name).await;
        assert_eq!(sheet.wires().await, wires, "{device}");
        let sections = [("defaults", line), ("limits", limit), ("try", remedy)];
        for (section, part) in sections {
            let text = sheet.section(section).await;
            assert!(text.contains(part), "{device} {section}: {text}");
        }
        assert!(!sheet.section("notes").await.is_empty());
        sheet.close().await;
    }
    assert_eq!(browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_connected_device_is_explained_on_every_page_and_escape_gives_the_focus_back() {
    let bench = bench().await;
    let browser = &bench.browser;
    let page = LivePage::open(browser).await;
    browser.choose("profile", "gauge-cable").await;
    browser.click("demo").await;
    page.wait_for(State::Reading).await;
    browser.click("nav-decoder").await;
    browser.wait_for("document.querySelector('[data-test=page-decoder]')").await;
    let sheet = HelpSheet::open(browser).await;
    sheet.wait_for_title("217/218").await;
    browser.wait_for("document.activeElement?.dataset.test === 'help-close'").await;
    sheet.escape().await;
    sheet.wait_for_focus_on_its_button().await;
    browser.click("language").await;
    let sheet = HelpSheet::open(browser).await;
    sheet.wait_for_title("量表数据线").await;
    assert!(sheet.section("try").await.contains("ABS 模式"));
    sheet.escape().await;
    // The device goes on meanwhile.
    browser.click("nav-live").await;
    page.wait_for(State::Reading).await;
    assert_eq!(browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn on_paper_stands_the_sheet_alone() {
    let bench = bench().await;
    let browser = &bench.browser;
    LivePage::open(browser).await;
    let sheet = HelpSheet::open(browser).await;
    browser.devtools("Emulation.setEmulatedMedia", serde_json::json!({ "media": "print" })).await;
    let hidden = "['.rail', '.top', '.content'].every(part => getComputedStyle(document.querySelector(part)).display === 'none')";
    browser.wait_for(hidden).await;
    let sheet_text = sheet.section("errata").await;
    assert!(sheet_text.contains("43 41"), "{sheet_text}");
    let whole =
        "(sheet => sheet.scrollHeight <= sheet.clientHeight + 1)(document.querySelector('[data-test=help-sheet]'))";
    browser.wait_for(whole).await;
}
