//! The Console page, against a pty on which others talk, and against a replay.

use std::time::{Duration, Instant};

use buslens_tests::pages::ConsolePage;
use buslens_tests::testbed::{Bench, Chatter, Look, Wire};

use crate::{percentile, row, scrolled};

/// 2000 frames a second.
const PACE: Duration = Duration::from_micros(500);
/// As fast as a pty takes it.
const FAST: Duration = Duration::from_micros(50);
const MINUTE: u32 = 60_000;
/// Frames of a list at its fullest.
const MILLION: u32 = 1_000_000;
/// Time between two keys.
const KEYS: Duration = Duration::from_millis(250);

pub(crate) async fn measure(site: &str) {
    let bench = Bench::at(site, Wire::new(Chatter::silent(false)), Look::default()).await;
    bench.browser.open("about:blank").await;
    let blank = bench.adapter.resident_bytes();
    let page = ConsolePage::open_at(&bench.browser, site).await;
    page.connect_listening().await;
    page.wait_for_line("open").await;
    watch(&bench).await;
    minute(&bench, &page).await;
    million(&bench, &page, blank).await;
    burst(&bench, &page).await;
}

/// Keeps the longest task of the window, and of each key the time until what follows from it is painted.
async fn watch(bench: &Bench<Chatter>) {
    bench
        .browser
        .run(
            "globalThis.longest = 0; globalThis.latencies = [];
             new PerformanceObserver((list) => list.getEntries().forEach((task) => longest = Math.max(longest, task.duration)))
               .observe({ type: 'longtask' });
             // The time stamp is when the browser has got the key: what makes it wait counts.
             addEventListener('keydown', ({ timeStamp }) => requestAnimationFrame(() => requestAnimationFrame(
               () => latencies.push(performance.now() - timeStamp))), true);",
        )
        .await;
}

async fn number(bench: &Bench<Chatter>, expression: &str) -> f64 {
    bench.browser.run(&format!("return {expression}")).await.as_f64().expect("a number")
}

/// A thousand exchanges a second for a minute, while somebody types.
async fn minute(bench: &Bench<Chatter>, page: &ConsolePage<'_>) {
    bench.wire().with(|others, now| others.talk(now, MINUTE, PACE));
    let begin = Instant::now();
    let mut next = begin;
    let mut keys = 0_usize;
    while bench.wire().with(|others, _| !others.is_done()) {
        // Half of the time in the send line, then in the filter: there each key sifts the whole list anew.
        let field = if begin.elapsed() < Duration::from_secs(30) { "send-line" } else { "filter-text" };
        let key = if keys.is_multiple_of(2) { "0" } else { "Backspace" };
        page.press_in(field, key).await;
        keys += 1;
        next += KEYS;
        tokio::time::sleep(next.saturating_duration_since(Instant::now())).await;
    }
    let said = bench.wire().with(|others, _| others.count());
    let told = format!("{}", begin.elapsed().as_secs());
    bench.browser.fill("filter-text", "").await;
    page.wait_for_count(&said.to_string()).await;
    let latencies = bench.browser.run("return latencies").await;
    let latencies: Vec<f64> =
        latencies.as_array().into_iter().flatten().filter_map(serde_json::Value::as_f64).collect();
    row(&format!("2000 frames/s: written in {told} s"), f64::from(said), "", "");
    row(
        "2000 frames/s: missing in the list",
        f64::from(said) - page.count().await.parse().unwrap_or(f64::NAN),
        "",
        "0",
    );
    row("2000 frames/s: 95th percentile from key to paint", percentile(&latencies, 95), "ms", "100 ms");
    row("2000 frames/s: longest task of the window", number(bench, "longest").await, "ms", "");
}

/// A full list: scrolled, and what it weighs.
async fn million(bench: &Bench<Chatter>, page: &ConsolePage<'_>, blank: f64) {
    let said = bench.wire().with(|others, _| others.count());
    let begin = Instant::now();
    bench.wire().with(|others, now| others.talk(now, (MILLION - said) / 2, FAST));
    page.wait_for_all(MILLION).await;
    let per_second = f64::from(MILLION - said) / begin.elapsed().as_secs_f64();
    row("filling the list: frames a second", per_second, "", "");
    let frames = scrolled(&bench.browser).await;
    row("1 000 000 rows scrolled: median frame", percentile(&frames, 50), "ms", "");
    row("1 000 000 rows scrolled: 99th percentile frame", percentile(&frames, 99), "ms", "20 ms");
    let resident = bench.adapter.resident_bytes() - blank;
    let held = bench.browser.held_bytes();
    row("1 000 000 rows: memories of WebAssembly", held.wasm / 1e6, "MB", "");
    row("1 000 000 rows: heaps of JavaScript", held.heaps / 1e6, "MB", "");
    row("1 000 000 rows: both together", (held.wasm + held.heaps) / 1e6, "MB", "250 MB");
    row("1 000 000 rows: resident, more than an empty page", resident / 1e6, "MB", "");
}

/// A recording with 10 000 frames a second, played at its own speed.
async fn burst(bench: &Bench<Chatter>, page: &ConsolePage<'_>) {
    const FRAMES: u32 = 100_000;
    let line = |at: u32| {
        let (second, rest) = (at / 10_000, at % 10_000);
        let frame = if at.is_multiple_of(2) {
            "TX 01 04 00 02 00 04 50 09"
        } else {
            "RX 01 04 08 00 00 01 1D 00 7B 01 C8 B9 C1"
        };
        format!("00:00:{second:02}.{rest:04}00 {frame}\n")
    };
    let recording: String = (0..FRAMES).map(line).collect();
    page.drop_file("burst.log", &recording).await;
    page.wait_for_count(&FRAMES.to_string()).await;
    bench.browser.run("longest = 0").await;
    let begin = Instant::now();
    page.replay(1000).await;
    // Until it has begun, the count is that of the recording.
    bench.browser.wait_for("document.querySelector('[data-test=replay-progress]')").await;
    page.wait_for_replay_end().await;
    page.wait_for_count(&FRAMES.to_string()).await;
    row("10 000 frames/s played: 10 s took", begin.elapsed().as_secs_f64(), "s", "");
    row("10 000 frames/s played: longest task of the window", number(bench, "longest").await, "ms", "50 ms");
}
