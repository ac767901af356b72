//! The Live page against sensors on a line, through the browser's own serial port stack.

use std::collections::BTreeMap;
use std::time::Duration;

use buslens_bus::sim::{Device, Line, Lvdt, Motion};
use buslens_codec::line::{DataBits, LineSettings, Parity};
use buslens_tests::pages::{ConfigurePage, Figures, LivePage, State};
use buslens_tests::testbed::{Bench, Registers, Relay, site};

const FACTORY: LineSettings = LineSettings::new(9600, Parity::Even);

fn rest(micrometres: i32) -> Motion {
    Motion::Rest { micrometres, decidegrees: 255 }
}

fn lvdt(micrometres: i32) -> Line<Lvdt> {
    Line::new([Lvdt::new(1, rest(micrometres))], 1)
}

async fn reading(bench: &Bench<Line<Lvdt>>) -> LivePage<'_> {
    let page = LivePage::open(&bench.browser).await;
    page.connect().await;
    page.wait_for(State::Reading).await;
    page
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_page_reads_the_right_figures() {
    let bench = Bench::new(lvdt(-328)).await;
    let page = reading(&bench).await;
    page.wait_for_displacement("−0.328 mm").await;
    assert_eq!(page.figures().await.temperature, "25.5 °C");
    assert_eq!(bench.wire().settings(), Some(FACTORY));
    assert!(page.is_faultless().await);
    bench.wire().with(|line, _| line.device_mut(0).unwrap().motion = rest(123_456));
    page.wait_for_displacement("123.456 mm").await;
    page.wait_for_count("replies", 20).await;
    assert_eq!(page.count("bad-checks").await + page.count("exceptions").await, 0);
    assert!(bench.wire().sent().starts_with(&[0x01, 0x04, 0x00, 0x02, 0x00, 0x04, 0x50, 0x09]));
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn an_ascii_sensor_is_read_and_written_at_seven_and_eight_data_bits() {
    let mut sensor = Lvdt::new(1, rest(-328));
    assert!(sensor.preset(0x0060, 2));
    let bench = Bench::new(Line::new([sensor], 1)).await;
    let page = LivePage::open(&bench.browser).await;
    bench.browser.choose("mode", "ascii").await;
    for (choice, bits, settings) in
        [("8", DataBits::Eight, "9600 8E1 · ASCII · unit 1"), ("7", DataBits::Seven, "9600 7E1 · ASCII · unit 1")]
    {
        bench.browser.choose("data-bits", choice).await;
        page.connect().await;
        page.wait_for_displacement("−0.328 mm").await;
        assert_eq!(bench.adapter.data_bits(), Some(bits));
        let configure = ConfigurePage::open(&bench.browser).await;
        configure.wait_until_read().await;
        configure.choose("sample_rate", if bits == DataBits::Seven { 5 } else { 6 }).await;
        configure.write_all().await;
        configure.wait_for_ending("done").await;
        configure.wait_for_reading_at(settings).await;
        assert_eq!(bench.adapter.data_bits(), Some(bits));
        if bits == DataBits::Eight {
            bench.browser.click("nav-live").await;
            LivePage::open(&bench.browser).await;
            bench.browser.click("disconnect").await;
            page.wait_for(State::Closed).await;
        }
    }
    // RTU has eight always.
    let configure = ConfigurePage::open(&bench.browser).await;
    configure.wait_until_read().await;
    configure.choose("output_mode", 1).await;
    configure.write_all().await;
    configure.wait_for_ending("done").await;
    configure.wait_for_reading_at("9600 8E1 · RTU · unit 1").await;
    assert_eq!(bench.adapter.data_bits(), Some(DataBits::Eight));
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn wrong_settings_are_told_with_what_to_try() {
    let bench = Bench::new(lvdt(1000)).await;
    let page = LivePage::open(&bench.browser).await;
    for (baud, parity, shown) in [(19_200, Parity::Even, "19200"), (9600, Parity::None, "8N1")] {
        page.set_line(baud, parity).await;
        page.connect().await;
        let fault = page.fault("silence").await;
        assert!(fault.contains("unit 1") && fault.contains(shown) && fault.contains("9600 8E1"), "{fault}");
        assert_eq!(bench.wire().settings(), Some(LineSettings::new(baud, parity)));
        bench.browser.click("disconnect").await;
        page.wait_for(State::Closed).await;
    }
    page.set_line(9600, Parity::Even).await;
    page.connect().await;
    page.wait_for_displacement("1.000 mm").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_wrong_unit_is_told_too() {
    let bench = Bench::new(lvdt(1000)).await;
    let page = LivePage::open(&bench.browser).await;
    page.set_unit(7).await;
    page.connect().await;
    assert!(page.fault("silence").await.contains("unit 7"));
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn reading_resumes_after_unplug_and_replug_without_a_reload() {
    let mut bench = Bench::new(lvdt(1000)).await;
    let page = LivePage::open(&bench.browser).await;
    page.connect().await;
    page.wait_for_displacement("1.000 mm").await;
    bench.browser.run("globalThis.notReloaded = true").await;
    let mut line = bench.unplug();
    let page = LivePage::open(&bench.browser).await;
    page.wait_for(State::Lost).await;
    page.fault("lost").await;
    let stale = "document.querySelector('[data-test=point-displacement]').dataset.stale === 'true'";
    bench.browser.wait_for(stale).await;
    line.device_mut(0).unwrap().motion = rest(2000);
    bench.plug(line);
    let page = LivePage::open(&bench.browser).await;
    page.wait_for(State::Reading).await;
    page.wait_for_displacement("2.000 mm").await;
    assert!(page.is_faultless().await);
    assert_eq!(bench.browser.run("return globalThis.notReloaded").await, true);
}

/// The port vanishes without any event, as when a driver dies: only the stream's `NetworkError` tells.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_closed_pty_is_a_lost_port() {
    let mut bench = Bench::new(lvdt(1000)).await;
    let page = LivePage::open(&bench.browser).await;
    page.connect().await;
    page.wait_for(State::Reading).await;
    let line = bench.wire.take().unwrap().take_apart();
    page.wait_for(State::Lost).await;
    // The same node leads to a new pty; no event says so, and the page finds it all the same.
    bench.plug_silently(line);
    let page = LivePage::open(&bench.browser).await;
    page.wait_for(State::Reading).await;
}

/// Everything that makes a wrong figure likely, while the true one changes all the time.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn garbage_echo_and_late_replies_never_show_a_wrong_figure() {
    let bench = Bench::new(lvdt(0)).await;
    let page = reading(&bench).await;
    page.watch_displacement().await;
    let faults = [
        "garbage around replies",
        "echo",
        "corrupted replies",
        "replies late by 650 ms",
        "replies late by 1.4 s",
        "lost replies",
        "garbage out of nowhere",
    ];
    let mut step = 0;
    for fault in faults {
        bench.wire().with(|line, _| {
            line.faults.noise_before =
                if fault.contains("around") { vec![0x00, 0xFF, 0x01, 0x04, 0x08] } else { vec![] };
            line.faults.noise_after = if fault.contains("around") { vec![0xFF, 0x00, 0x01] } else { vec![] };
            line.faults.echo = fault == "echo";
            line.faults.corrupted_replies = if fault.contains("corrupted") { 5 } else { 0 };
            line.faults.lost_replies = if fault.contains("lost") { 3 } else { 0 };
            let late_ms = [650, 1400].into_iter().find(|ms| fault.contains(&ms.to_string()[..2].replace("14", "1.4")));
            line.faults.delayed_replies = Some(if late_ms.is_some() { 4 } else { 0 });
            line.faults.reply_delay = Duration::from_millis(late_ms.unwrap_or(0));
        });
        // The probe moves on with every request that reaches the line, so that an old reply is an old figure.
        for _ in 0..12 {
            let before = bench.wire().sent().len();
            step += 1;
            bench.wire().with(|line, _| line.device_mut(0).unwrap().motion = rest(step * 1000));
            if fault == "garbage out of nowhere" {
                bench.wire().inject(&[0x01, 0x04, 0x08, 0x00, 0x00, 0x55, 0xAA, 0x3A, 0x0D, 0x0A]);
            }
            bench.wire().wait_for_sent(before, Duration::from_secs(20), |sent| sent.len() >= 8);
        }
    }
    bench.wire().with(|line, _| {
        line.faults = buslens_bus::sim::Faults::default();
        line.device_mut(0).unwrap().motion = rest(999_000);
    });
    page.wait_for_displacement("999.000 mm").await;
    let shown = page.watched_displacements().await;
    assert!(shown.len() > 20, "{shown:?}");
    // Every figure is a place where the probe was, and no figure is older than one that was shown before.
    assert!(shown.iter().all(|mm| mm.fract() == 0.0 && (0.0..=999.0).contains(mm)), "{shown:?}");
    assert!(shown.windows(2).all(|pair| pair[0] < pair[1]), "{shown:?}");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_server_that_this_project_did_not_write_is_read() {
    let registers = Registers {
        unit: 17,
        input: BTreeMap::from([(2, 0), (3, 285), (4, 0x8000), (5, 328)]),
        ..Registers::default()
    };
    let bench = Bench::with_wire(Relay::serve(registers)).await;
    let page = LivePage::open(&bench.browser).await;
    page.set_line(9600, Parity::None).await;
    page.set_unit(17).await;
    page.connect().await;
    page.wait_for(State::Reading).await;
    page.wait_for_displacement("−0.328 mm").await;
    let expected = Figures { displacement: "−0.328 mm".into(), temperature: "28.5 °C".into() };
    assert_eq!(page.figures().await, expected);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn an_exception_is_told_by_name() {
    let registers = Registers { unit: 1, ..Registers::default() };
    let bench = Bench::with_wire(Relay::serve(registers)).await;
    let page = LivePage::open(&bench.browser).await;
    page.set_line(9600, Parity::None).await;
    page.connect().await;
    let fault = page.fault("exception").await;
    assert!(fault.contains("02") && fault.contains("data address"), "{fault}");
    page.wait_for(State::Failing).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_port_that_is_in_use_is_told() {
    let bench = Bench::new(lvdt(1000)).await;
    let page = LivePage::open(&bench.browser).await;
    bench.adapter.set_busy(true);
    page.connect().await;
    page.fault("busy").await;
    page.wait_for(State::Failed).await;
    bench.adapter.set_busy(false);
    page.connect().await;
    page.wait_for(State::Reading).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn without_hardware_one_click_reads_a_moving_displacement() {
    let bench = Bench::new(lvdt(1000)).await;
    let page = LivePage::open(&bench.browser).await;
    bench.browser.click("demo").await;
    page.wait_for(State::Reading).await;
    page.watch_displacement().await;
    bench.browser.wait_for("displacements.length >= 10").await;
    assert!(bench.wire().sent().is_empty(), "the simulation must not touch a real port");
    bench.browser.click("disconnect").await;
    page.wait_for(State::Closed).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn an_insecure_page_says_why_there_are_no_ports() {
    let bench = Bench::new(lvdt(1000)).await;
    // The browser was told that this name is this machine; without https that is no secure place.
    let insecure = site().replace("localhost", "insecure.test");
    bench.browser.open(&insecure).await;
    let page = LivePage::open(&bench.browser).await;
    assert!(page.fault("insecure").await.contains("https"));
    bench.browser.click("demo").await;
    page.wait_for(State::Reading).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_fault_of_the_engine_is_a_plain_page_and_closes_the_port() {
    let bench = Bench::new(lvdt(1000)).await;
    let page = reading(&bench).await;
    page.wait_for_displacement("1.000 mm").await;
    // What a panic of the engine sends: an error that its worker does not catch.
    bench.browser.break_the_worker().await;
    bench.browser.wait_for("document.querySelector('[data-test=crash] [data-test=copy-details]')").await;
    let open = "navigator.serial.getPorts()
        .then(([port]) => port.open({ baudRate: 9600 }))
        .then(() => done('free'), (error) => done(error.message));";
    assert_eq!(bench.browser.run_async(open).await, "free");
}
