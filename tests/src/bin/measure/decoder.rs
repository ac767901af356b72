//! The Decoder page.

use std::time::Instant;

use buslens_analyst::Desk;
use buslens_analyst::message::{ProfileChoice, ToAnalyst};
use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_tests::pages::DecoderPage;
use buslens_tests::testbed::{Bench, Look, Wire};

use crate::{percentile, row, scrolled};

/// An exchange as a line-by-line log of bare bytes, 63 characters.
const EXCHANGE: &str = "01 04 00 02 00 04 50 09\n01 04 08 00 00 01 1D 00 7B 01 C8 B9 C1\n";
const EXCHANGES: usize = 166_000;

pub(crate) async fn measure(site: &str) {
    let line = Line::new([Lvdt::new(1, Motion::Swing)], 1);
    let bench = Bench::at(site, Wire::new(line), Look::default()).await;
    let page = DecoderPage::open_at(&bench.browser, site).await;
    pasted_text(&bench, &page).await;
    scrolled_list(&bench, &page).await;
    large_file(&bench, &page).await;
}

/// Ten megabytes of pasted text.
async fn pasted_text(bench: &Bench<Line<Lvdt>>, page: &DecoderPage<'_>) {
    // The page's own program is warm: what is measured is the text.
    page.paste(EXCHANGE).await;
    page.rows(2).await;
    bench
        .browser
        .run(
            "globalThis.longest = 0; globalThis.firstRow = 0; globalThis.all = 0;
             new PerformanceObserver((list) => list.getEntries().forEach((task) => longest = Math.max(longest, task.duration)))
               .observe({ type: 'longtask' });
             const look = () => {
               const count = document.querySelector('[data-test=frame-count]')?.textContent.replace(/\\D/g, '') ?? '';
               const drawn = document.querySelectorAll('[data-test=frame-row]').length;
               if (!firstRow && count.length > 2 && drawn > 10) firstRow = performance.now();
               if (!all && count === '332000') all = performance.now();
               if (!all) requestAnimationFrame(look);
             };
             requestAnimationFrame(look);",
        )
        .await;
    let text = format!("{EXCHANGE:?}.repeat({EXCHANGES})");
    let pasted = page.paste_expression(&text).await;
    let all = bench.browser.wait_for("globalThis.all").await.as_f64().expect("a time");
    let first = bench.browser.run("return firstRow").await.as_f64().expect("a time");
    let longest = bench.browser.run("return longest").await.as_f64().expect("a time");
    row("10 MB pasted: first rows on screen", first - pasted, "ms", "300 ms");
    row("10 MB pasted: all of it", all - pasted, "ms", "2000 ms");
    row("10 MB pasted: longest task of the page", longest, "ms", "50 ms");
    let (native, worker) = (native_reading(), worker_reading(bench).await);
    row("10 MB read by the analyst, natively", native, "ms", "");
    row("10 MB read by the analyst, in the browser", worker, "ms", "");
    row("browser against native", worker / native, "x", "2.5 x");
}

/// The analyst's work in a worker that nobody looks at, in milliseconds: the best of five.
async fn worker_reading(bench: &Bench<Line<Lvdt>>) -> f64 {
    let read = ToAnalyst::Read { reading: 1, form: None, keep: false };
    let read = postcard::to_allocvec(&read).expect("a message");
    // The first field of the answers tells progress from the rest; its fields are whole numbers, then whether it is over.
    let script = format!(
        "const text = {EXCHANGE:?}.repeat({EXCHANGES});
         const worker = new Worker(buslensAnalyst, {{ type: 'module' }});
         const times = [];
         let start;
         const begin = () => {{ start = performance.now(); worker.postMessage([new Uint8Array({read:?}), text]); }};
         worker.onmessage = ({{ data: [bytes] }}) => {{
           if (bytes[0] !== 0) return;
           let at = 1;
           for (let field = 0; field < 3; field++) {{ while (bytes[at++] & 128); }}
           if (bytes[at] !== 1 || start === undefined) return;
           times.push(performance.now() - start);
           start = undefined;
           if (times.length < 5) setTimeout(begin, 300);
           else {{ worker.terminate(); done(Math.min(...times)); }}
         }};
         begin();"
    );
    bench.browser.run_async(&script).await.as_f64().expect("a time")
}

/// The analyst's work on the same text on this machine, in milliseconds: the best of five.
fn native_reading() -> f64 {
    let text = EXCHANGE.repeat(EXCHANGES);
    let once = || {
        let mut desk = Desk::new();
        desk.choose(ProfileChoice::default());
        let start = Instant::now();
        desk.begin(1, None, text.len() as u64);
        for part in text.as_bytes().chunks(256 << 10) {
            desk.push(std::str::from_utf8(part).expect("plain text"), part.len() as u64);
        }
        desk.finish();
        start.elapsed().as_secs_f64() * 1000.0
    };
    (0..5).map(|_| once()).fold(f64::INFINITY, f64::min)
}

/// A million rows, scrolled for some seconds.
async fn scrolled_list(bench: &Bench<Line<Lvdt>>, page: &DecoderPage<'_>) {
    bench.browser.click("close-document").await;
    page.drop_file("million.txt", "'0104000200045009\\n'.repeat(1e6)").await;
    page.wait_for_entries("1000000").await;
    bench.browser.wait_for("document.querySelector('[data-test=statistics]')").await;
    let frames = scrolled(&bench.browser).await;
    row("1 000 000 rows scrolled: median frame", percentile(&frames, 50), "ms", "");
    row("1 000 000 rows scrolled: 99th percentile frame", percentile(&frames, 99), "ms", "20 ms");
}

/// A file of 200 MB.
async fn large_file(bench: &Bench<Line<Lvdt>>, page: &DecoderPage<'_>) {
    bench.browser.click("close-document").await;
    let start = Instant::now();
    page.drop_file("large.log", "...Array(84).fill('01 03 00 31 00 01 D5 C5\\n'.repeat(1e5))").await;
    page.wait_for_entries("8400000").await;
    row("200 MB dropped: all of it", start.elapsed().as_secs_f64(), "s", "");
    bench.browser.click("close-document").await;
}
