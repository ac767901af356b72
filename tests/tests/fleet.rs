//! The Fleet page on a line, through the browser's own serial port stack.

use std::time::Duration;

use buslens_bus::sim::{Device, Line, Lvdt, Motion};
use buslens_bus::time::Instant;
use buslens_codec::{UnitId, rtu};
use buslens_tests::pages::{ConfigurePage, FleetPage, LivePage, SensorRow, State};
use buslens_tests::testbed::Bench;

/// The registers of the parameters: unit id, baud rate, parity, compensation, sample rate.
const UNIT: u16 = 0x0030;
const BAUD: u16 = 0x0031;
const COMPENSATION: u16 = 0x0034;
const SAMPLE_RATE: u16 = 0x003F;

fn lvdt(presets: &[(u16, u16)]) -> Lvdt {
    let mut sensor = Lvdt::new(1, Motion::Rest { micrometres: 1000, decidegrees: 255 });
    for &(register, value) in presets {
        assert!(sensor.preset(register, value), "{register:04X} takes {value}");
    }
    sensor
}

async fn bench(presets: &[(u16, u16)]) -> Bench<Line<Lvdt>> {
    Bench::new(Line::new([lvdt(presets)], 1)).await
}

/// What the sensor holds at a register.
fn held(bench: &Bench<Line<Lvdt>>, register: u16) -> u16 {
    let [high, low] = register.to_be_bytes();
    let later = Instant::ZERO + Duration::from_hours(24);
    let read = |sensor: &mut Lvdt| sensor.serve(later, UnitId::BROADCAST, &[3, high, low, 0, 1]);
    let reply = bench.wire().with(|line, _| read(line.device_mut(0).unwrap())).expect("it answers a broadcast read");
    u16::from_be_bytes([reply.pdu[2], reply.pdu[3]])
}

/// Unplugs the sensor and plugs another one in.
fn swap(bench: &Bench<Line<Lvdt>>, presets: &[(u16, u16)]) {
    bench.wire().with(|line, _| *line.device_mut(0).unwrap() = lvdt(presets));
}

/// The writes of registers that have left the browser, as digits with spaces.
fn writes(bench: &Bench<Line<Lvdt>>) -> Vec<String> {
    let sent = bench.wire().sent();
    // One register: address, function, register, count, bytes, value, check.
    let frames = sent.windows(11).filter(|frame| frame[1] == 0x10 && rtu::decode(frame).is_ok());
    frames.map(|frame| frame.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")).collect()
}

/// The page over a sensor that is being polled with the factory's settings under this unit id.
async fn opened(bench: &Bench<Line<Lvdt>>, unit: u8) -> FleetPage<'_> {
    bench.browser.run("location.hash = '#/live'").await;
    let live = LivePage::open(&bench.browser).await;
    live.set_unit(unit).await;
    live.connect().await;
    live.wait_for(State::Reading).await;
    FleetPage::open(&bench.browser).await
}

async fn closed(bench: &Bench<Line<Lvdt>>) {
    bench.browser.click("disconnect").await;
    LivePage { browser: &bench.browser }.wait_for(State::Closed).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_device_is_restored_from_a_file_that_was_saved_before() {
    let bench = bench(&[(SAMPLE_RATE, 6), (COMPENSATION, 1)]).await;
    let page = opened(&bench, 1).await;
    page.wait_for_snapshots(&[]).await;
    page.take("press 4, left").await;
    page.wait_for_snapshots(&["press 4, left"]).await;
    let file = page.save(0).await;
    assert!(file.contains("\"name\": \"press 4, left\"") && file.contains("\"value\": \"50\""), "{file}");
    // What is deleted comes back as long as nothing else was.
    bench.browser.click("snapshot-delete").await;
    page.wait_for_snapshots(&[]).await;
    bench.browser.click("undelete").await;
    page.wait_for_snapshots(&["press 4, left"]).await;
    // It outlives the page; deleted, it does not.
    bench.browser.reload().await;
    page.wait().await;
    page.wait_for_snapshots(&["press 4, left"]).await;
    bench.browser.click("snapshot-delete").await;
    page.wait_for_snapshots(&[]).await;
    // Meanwhile somebody sets the device otherwise.
    swap(&bench, &[(SAMPLE_RATE, 1), (COMPENSATION, 2)]);
    let page = opened(&bench, 1).await;
    page.drop_file(&file.replace("\"format\": 1", "\"format\": 2")).await;
    let fault = page.wait_for_told("Line 2, character 13").await;
    assert!(fault.contains("version 2"), "{fault}");
    page.drop_file(&file).await;
    page.wait_for_told("6 parameters").await;
    page.wait_for_snapshots(&["press 4, left"]).await;
    page.compare_with_device(0).await;
    page.wait_for_differences(2).await;
    let rows = page.differences().await;
    assert_eq!(rows, [["compensation", "on", "off"], ["sample_rate", "50 Hz", "1 Hz"]]);
    assert!(writes(&bench).is_empty());
    page.bring().await;
    let review = ConfigurePage { browser: &bench.browser };
    assert_eq!(review.planned().await, ["compensation", "sample_rate"]);
    review.confirm_all().await;
    review.write().await;
    review.wait_for_ending("done").await;
    assert_eq!((held(&bench, SAMPLE_RATE), held(&bench, COMPENSATION)), (6, 1));
    // Compared again, device and snapshot are the same.
    let page = FleetPage::open(&bench.browser).await;
    page.wait_for_differences(0).await;
    page.wait_for_changes(0).await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_copy_leaves_the_unit_id_of_the_second_device_alone() {
    let bench = bench(&[(SAMPLE_RATE, 6)]).await;
    let page = opened(&bench, 1).await;
    page.take("original").await;
    closed(&bench).await;
    swap(&bench, &[(UNIT, 5)]);
    let page = opened(&bench, 5).await;
    page.compare_with_device(0).await;
    page.wait_for_differences(2).await;
    page.wait_for_changes(1).await;
    // The unit id comes along only if that is asked for.
    bench.browser.click("with-unit").await;
    page.wait_for_changes(2).await;
    bench.browser.click("with-unit").await;
    page.wait_for_changes(1).await;
    page.bring().await;
    let review = ConfigurePage { browser: &bench.browser };
    assert_eq!(review.requests().await, ["05 10 00 3F 00 01 02 00 06 11 9D"]);
    review.confirm_all().await;
    review.write().await;
    review.wait_for_ending("done").await;
    assert_eq!((held(&bench, UNIT), held(&bench, SAMPLE_RATE)), (5, 6));
    assert_eq!(writes(&bench), ["05 10 00 3F 00 01 02 00 06 11 9D"]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn two_snapshots_are_compared_in_words_and_as_a_file() {
    let bench = bench(&[]).await;
    let page = opened(&bench, 1).await;
    page.take("before").await;
    bench.wire().with(|line, _| assert!(line.device_mut(0).unwrap().preset(SAMPLE_RATE, 5)));
    page.take("after").await;
    page.wait_for_snapshots(&["after", "before"]).await;
    let numbers = "return [...document.querySelectorAll('[data-test=snapshot-row]')].map((row) => row.dataset.number)";
    let numbers: Vec<String> = serde_json::from_value(bench.browser.run(numbers).await).unwrap();
    bench.browser.choose("compare-left", &numbers[1]).await;
    bench.browser.choose("compare-right", &numbers[0]).await;
    page.wait_for_differences(1).await;
    assert_eq!(page.differences().await, [["sample_rate", "10 Hz", "20 Hz"]]);
    bench.browser.click("compare-same").await;
    bench.browser.wait_for("document.querySelectorAll('[data-test=compare-row]').length === 6").await;
    let console = buslens_tests::pages::ConsolePage { browser: &bench.browser };
    console.catch_files().await;
    bench.browser.click("compare-export").await;
    let file = String::from_utf8(console.saved().await).unwrap();
    assert!(file.contains("before") && file.contains("0x003F,10 Hz,0004,20 Hz,0005,yes"), "{file}");
    // Neither is the device: there is nothing to be written.
    assert_eq!(
        bench.browser.run("return document.querySelector('[data-test=transfer]')").await,
        serde_json::Value::Null
    );
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn sensors_plugged_in_one_by_one_get_their_unit_ids_settings_and_labels() {
    let bench = bench(&[]).await;
    let page = opened(&bench, 1).await;
    page.begin_series(10, &[("baud", 4), ("sample_rate", 6)]).await;
    assert_eq!(bench.browser.text("next-unit").await, "10");
    page.set_up("SN 0815").await;
    assert_eq!((held(&bench, UNIT), held(&bench, BAUD), held(&bench, SAMPLE_RATE)), (10, 4, 6));
    // The same one once more: it is told, and not set up twice.
    page.set_up("").await;
    let (failure, words) = page.failure().await;
    assert_eq!(failure, "set-up-before", "{words}");
    assert!(words.contains("device 1"), "{words}");
    // Another one is plugged in whose factory unit id is another one.
    swap(&bench, &[(UNIT, 33)]);
    bench.browser.click("series-again").await;
    page.wait_for_series("next").await;
    assert_eq!((held(&bench, UNIT), held(&bench, BAUD), held(&bench, SAMPLE_RATE)), (11, 4, 6));
    swap(&bench, &[]);
    page.set_up("SN 0817").await;
    assert_eq!(held(&bench, UNIT), 12);
    let row = |unit: &str, name: &str| SensorRow { unit: unit.into(), state: "done".into(), name: name.into() };
    assert_eq!(page.sensors().await, [row("10", "SN 0815"), row("11", ""), row("12", "SN 0817")]);
    let labels = page.labels().await;
    assert_eq!(labels.len(), 3);
    for part in ["12", "SN 0817", "19200 8E1 · RTU", "Sample rate 50 Hz"] {
        assert!(labels[2].contains(part), "{part}: {}", labels[2]);
    }
    // On paper there are the labels and nothing else.
    bench.browser.devtools("Emulation.setEmulatedMedia", serde_json::json!({ "media": "print" })).await;
    let visible = "return ['label', 'sensors', 'series', 'nav-live', 'disconnect', 'fleet-series'].filter((name) =>
        document.querySelector(`[data-test=${name}]`).checkVisibility())";
    assert_eq!(bench.browser.run(visible).await, serde_json::json!(["label"]));
    bench.browser.devtools("Emulation.setEmulatedMedia", serde_json::json!({ "media": "" })).await;
    let file = page.save_series().await;
    let lines: Vec<&str> = file.lines().collect();
    assert_eq!(lines.len(), 4, "{file}");
    assert!(lines[3].starts_with("3,12,SN 0817,") && lines[3].contains("19200 Bd"), "{file}");
    // Each is kept as a snapshot as well.
    page.pane("snapshots").await;
    page.wait_for_snapshots(&["SN 0817", "", "SN 0815"]).await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_failed_sensor_stops_nothing_and_the_series_goes_on_after_a_reload() {
    let bench = bench(&[]).await;
    let page = opened(&bench, 1).await;
    page.pane("series").await;
    bench.browser.click("series-everywhere").await;
    page.begin_series(20, &[("sample_rate", 5)]).await;
    // Not at the factory's settings, and nobody shall look elsewhere.
    swap(&bench, &[(BAUD, 6)]);
    page.set_up("used one").await;
    let (failure, words) = page.failure().await;
    assert_eq!(failure, "not-found", "{words}");
    bench.browser.click("series-later").await;
    page.wait_for_series("next").await;
    swap(&bench, &[]);
    page.set_up("new one").await;
    assert_eq!((held(&bench, UNIT), held(&bench, SAMPLE_RATE)), (21, 5));
    bench.browser.reload().await;
    page.wait().await;
    page.wait_for_series("next").await;
    let row =
        |unit: &str, state: &str, name: &str| SensorRow { unit: unit.into(), state: state.into(), name: name.into() };
    assert_eq!(page.sensors().await, [row("20", "failed", "used one"), row("21", "done", "new one")]);
    swap(&bench, &[]);
    page.connect().await;
    page.set_up_again(0).await;
    assert_eq!(page.sensors().await, [row("20", "done", "used one"), row("21", "done", "new one")]);
    assert_eq!((held(&bench, UNIT), held(&bench, SAMPLE_RATE)), (20, 5));
    assert_eq!(bench.browser.text("next-unit").await, "22");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_log_holds_exactly_the_writes_that_were_seen_on_the_wire() {
    let bench = bench(&[]).await;
    let page = opened(&bench, 1).await;
    page.pane("audit").await;
    page.wait_for_entries(0).await;
    page.begin_series(40, &[("compensation", 1), ("sample_rate", 6)]).await;
    page.set_up("one").await;
    swap(&bench, &[]);
    page.set_up("two").await;
    let seen = writes(&bench);
    assert_eq!(seen.len(), 6, "{seen:?}");
    page.pane("audit").await;
    page.wait_for_entries(6).await;
    let file = page.save_log("jsonl").await;
    let entries: Vec<serde_json::Value> = file.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let sent: Vec<&str> = entries.iter().filter_map(|entry| entry["sent"].as_str()).collect();
    assert_eq!(sent, seen);
    assert!(entries.iter().all(|entry| entry["end"] == "answered" && entry["origin"] == "configuration"), "{file}");
    assert_eq!((entries[0]["point"].as_str(), entries[0]["old"].as_str()), (Some("compensation"), Some("0002")));
    // The newest stands first, and shows its frames when it is chosen.
    bench.browser.click("audit-row").await;
    bench.browser.wait_for("document.querySelector('[data-test=audit-detail]')").await;
    assert_eq!(bench.browser.text("audit-sent").await, *seen.last().unwrap());
    // The counts go with the devices to their new unit ids.
    let counts = "return [...document.querySelectorAll('[data-test=writes-row]')].map((row) =>
        [row.children[1].innerText, row.querySelector('[data-test=writes-count]').innerText])";
    assert_eq!(bench.browser.run(counts).await, serde_json::json!([["40", "3"], ["41", "3"]]));
    let table = page.save_log("csv").await;
    assert_eq!(table.lines().count(), 7, "{table}");
    // It is emptied by a deliberate second step only; the counts stay.
    bench.browser.click("audit-clear").await;
    page.wait_for_entries(6).await;
    bench.browser.click("audit-clear-now").await;
    page.wait_for_entries(0).await;
    assert_eq!(bench.browser.run(counts).await, serde_json::json!([["40", "3"], ["41", "3"]]));
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}
