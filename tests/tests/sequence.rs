//! Sequences on the Console page, through the browser's own serial port stack.

use std::collections::{BTreeMap, BTreeSet};

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_codec::line::Parity;
use buslens_tests::pages::{ConsolePage, LivePage, State};
use buslens_tests::testbed::{Bench, FarEnd, Registers, Relay};

fn lvdt() -> Line<Lvdt> {
    Line::new([Lvdt::new(1, Motion::Rest { micrometres: 5_250, decidegrees: 255 })], 1)
}

/// The sequences of a console whose line is connected and not polled.
async fn console<F: FarEnd>(bench: &Bench<F>, unit: u8, parity: Parity) -> ConsolePage<'_> {
    let live = LivePage::open(&bench.browser).await;
    live.set_line(9600, parity).await;
    live.set_unit(unit).await;
    live.connect().await;
    live.wait_for(State::Reading).await;
    let page = ConsolePage::open(&bench.browser).await;
    page.wait_for_line("open").await;
    page.switch("polling", false).await;
    page.open_sequences().await;
    page
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_ready_made_test_accepts_the_sensor() {
    let bench = Bench::new(lvdt()).await;
    let page = console(&bench, 1, Parity::Even).await;
    page.choose_ready_made(0).await;
    page.wait_for_right_sequence().await;
    page.run_sequence().await;
    page.wait_for_verdict("passed").await;
    assert_eq!(page.steps("failed").await, [""; 0]);
    assert!(page.steps("passed").await.iter().any(|step| step.contains("expect exception 02")));
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_step_that_fails_is_reported_with_what_was_read() {
    let bench = Bench::new(lvdt()).await;
    let page = console(&bench, 1, Parity::Even).await;
    page.catch_files().await;
    page.write_sequence(
        "device lvdt\nread displacement\nexpect displacement between 5 mm and 6 mm\nexpect displacement > 6 mm\n\
         send 01 03 00 31 00 01 wrong crc within 200 ms\nexpect silence\nread baud\nexpect baud = 9600\n",
    )
    .await;
    page.wait_for_right_sequence().await;
    page.run_sequence().await;
    page.wait_for_verdict("failed").await;
    let failed = page.steps("failed").await;
    assert_eq!(failed.len(), 1, "{failed:?}");
    assert!(failed[0].contains("expect displacement > 6 mm") && failed[0].contains("5.250"), "{failed:?}");
    // It went on after that: the last step is there and has passed.
    assert!(page.steps("passed").await.iter().any(|step| step.contains("expect baud = 9600")));
    bench.browser.click("sequence-save").await;
    let report = String::from_utf8(page.saved().await).expect("a report is text");
    assert!(report.contains("expect displacement > 6 mm") && report.contains("5.250"), "{report}");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_server_that_this_project_did_not_write_is_put_to_the_test() {
    let registers = Registers {
        unit: 17,
        input: BTreeMap::from([(2, 0), (3, 285), (4, 0x8000), (5, 328)]),
        holding: BTreeMap::from([(7, 1234)]),
        locked: BTreeSet::from([7]),
        ..Registers::default()
    };
    let bench = Bench::with_wire(Relay::serve(registers)).await;
    let page = console(&bench, 17, Parity::None).await;
    page.write_sequence(
        "read holding 7 count 1\nexpect register 7 = 1234\nread holding 8 count 1\nexpect exception 02\n\
         send UNIT 04 00 03 00 01 crc\nexpect 11 04 02 01 1D CRC\nwrite register 7 = 1\nexpect exception 03\n\
         read holding 7 count 1\nexpect register 7 = 1\n",
    )
    .await;
    page.wait_for_right_sequence().await;
    page.run_sequence().await;
    page.wait_for_verdict("failed").await;
    let failed = page.steps("failed").await;
    assert_eq!(failed.len(), 1, "{failed:?}");
    assert!(failed[0].contains("expect register 7 = 1") && failed[0].contains("1234"), "{failed:?}");
    let passed = page.steps("passed").await;
    assert_eq!(passed.iter().filter(|step| step.contains("expect")).count(), 4, "{passed:?}");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_text_with_faults_says_where_and_sends_nothing() {
    let bench = Bench::new(lvdt()).await;
    let page = console(&bench, 1, Parity::Even).await;
    page.wait_for_quiet().await;
    let before = bench.wire().sent().len();
    page.write_sequence("device lvdt\nread displacement\nexpekt displacement > 1\nsend 01 0G crc\n").await;
    let faults = page.sequence_faults().await;
    assert_eq!(faults.len(), 2, "{faults:?}");
    assert!(faults[0].contains('3') && faults[0].contains("expekt"), "{faults:?}");
    assert!(faults[1].contains('4'), "{faults:?}");
    let disabled = "return document.querySelector('[data-test=sequence-run]').disabled";
    assert_eq!(bench.browser.run(disabled).await, true);
    page.change_sequence("device lvdt\nread displacement\nexpect displacement > 1 mm\n").await;
    page.wait_for_right_sequence().await;
    assert_eq!(bench.wire().sent().len(), before);
    page.run_sequence().await;
    page.wait_for_verdict("passed").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn an_unplugged_adapter_stops_the_sequence_and_leaves_its_report() {
    let mut bench = Bench::new(lvdt()).await;
    {
        let page = console(&bench, 1, Parity::Even).await;
        page.write_sequence(
            "device lvdt\nread baud\nexpect baud = 9600\nrepeat 100000 times\n  read displacement\nend\n",
        )
        .await;
        page.wait_for_right_sequence().await;
        page.run_sequence().await;
        page.wait_for_step("passed", "expect baud = 9600").await;
    }
    let line = bench.unplug();
    let page = ConsolePage::open(&bench.browser).await;
    page.wait_for_verdict("incomplete").await;
    let ending = page.sequence_ending().await;
    assert!(ending.contains("port"), "{ending}");
    // The report keeps what had been done.
    page.open_sequences().await;
    bench.browser.click("sequence-view-steps").await;
    assert!(!page.steps("passed").await.is_empty());
    drop(line);
}
