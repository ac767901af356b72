//! The bench itself: what the page's tests rely on, shown without the page's program.

use std::time::Duration;

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_codec::line::{LineSettings, Parity};
use buslens_tests::testbed::Bench;
use serde_json::json;

const REST: Motion = Motion::Rest { micrometres: -328, decidegrees: 255 };

async fn bench() -> Bench<Line<Lvdt>> {
    let bench = Bench::new(Line::new([Lvdt::new(1, REST)], 1)).await;
    // A document of the same origin without the program.
    let icon = bench.browser.run("return document.querySelector('link[rel=icon]').href").await;
    bench.browser.open(icon.as_str().unwrap()).await;
    bench
}

const OPEN: &str = "
    const [port] = await navigator.serial.getPorts();
    globalThis.port = port;
    await port.open({ baudRate: 9600, parity: 'even', bufferSize: 8192 });
";

fn script(body: &str) -> String {
    format!("(async () => {{ {body} }})().catch((error) => done(`${{error.name}}: ${{error.message}}`));")
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_browser_opens_the_pty_and_talks_to_the_sensor() {
    let bench = bench().await;
    let native = bench.browser.run("return String(navigator.serial.getPorts)").await;
    assert!(native.as_str().unwrap().contains("[native code]"));
    let info = "const [port] = await navigator.serial.getPorts(); done(port.getInfo());";
    let info = bench.browser.run_async(&script(info)).await;
    assert_eq!(info, json!({ "usbVendorId": 0x1a86, "usbProductId": 0x7523 }));
    let exchange = script(&format!(
        "{OPEN}
         const writer = port.writable.getWriter();
         await writer.write(new Uint8Array([0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5]));
         const reader = port.readable.getReader();
         const bytes = [];
         while (bytes.length < 7) bytes.push(...(await reader.read()).value);
         done(bytes);"
    ));
    assert_eq!(bench.browser.run_async(&exchange).await, json!([0x01, 0x03, 0x02, 0x00, 0x03, 0xF8, 0x45]));
    assert_eq!(bench.wire().settings(), Some(LineSettings::new(9600, Parity::Even)));
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn the_line_sees_what_the_browser_asked_for() {
    let bench = bench().await;
    for (baud, parity, expected) in
        [(115_200, "none", Parity::None), (2400, "odd", Parity::Odd), (19_200, "even", Parity::Even)]
    {
        let open = format!(
            "const [port] = await navigator.serial.getPorts();
             await port.open({{ baudRate: {baud}, parity: '{parity}' }});
             done(true);"
        );
        assert_eq!(bench.browser.run_async(&script(&open)).await, json!(true));
        bench.wire().wait_for_settings(LineSettings::new(baud, expected), Duration::from_secs(5));
        let close = "const [port] = await navigator.serial.getPorts(); await port.close(); done(true);";
        assert_eq!(bench.browser.run_async(&script(close)).await, json!(true));
    }
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn an_unplugged_adapter_is_a_network_error_and_a_plugged_one_an_event() {
    let mut bench = bench().await;
    let watch = script(&format!(
        "{OPEN}
         globalThis.seen = [];
         navigator.serial.addEventListener('disconnect', () => seen.push('disconnect'));
         navigator.serial.addEventListener('connect', () => seen.push('connect'));
         globalThis.ended = port.readable.getReader().read().then(() => 'bytes', (error) => error.name);
         done('open');"
    ));
    assert_eq!(bench.browser.run_async(&watch).await, json!("open"));
    let line = bench.unplug();
    assert_eq!(bench.browser.run_async("ended.then(done);").await, json!("NetworkError"));
    bench.browser.wait_for("seen.includes('disconnect')").await;
    bench.plug(line);
    bench.browser.wait_for("seen.includes('connect')").await;
    let again = script(&format!("{OPEN} done('open');"));
    assert_eq!(bench.browser.run_async(&again).await, json!("open"));
}
