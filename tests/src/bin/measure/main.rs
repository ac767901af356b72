//! Measures what a user feels, in the real browser: `measure <address of the site> [page]`. Each figure stands beside its
//! target; nothing fails by time here, because a busy machine is no fault of the page.

mod console;
mod decoder;

use std::env;

use buslens_tests::testbed::Browser;

#[tokio::main]
async fn main() {
    let site = env::args().nth(1).expect("measure <address of the site> [decoder|console]");
    let only = env::args().nth(2);
    let is_wanted = |page: &str| only.as_deref().is_none_or(|only| only == page);
    if is_wanted("decoder") {
        title("Decoder page");
        decoder::measure(&site).await;
    }
    if is_wanted("console") {
        title("Console page");
        console::measure(&site).await;
    }
}

fn title(page: &str) {
    println!("{page:<62}{:>12}{:>14}", "measured", "target");
}

fn row(name: &str, measured: f64, unit: &str, target: &str) {
    println!("{name:<62}{:>12}{target:>14}", format!("{measured:.1} {unit}"));
}

/// The value below which so many hundredths of the values lie.
fn percentile(values: &[f64], hundredths: usize) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = sorted.len() * hundredths / 100;
    sorted.get(place.min(sorted.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
}

/// Scrolls the list for some seconds at several speeds, up to a hundred thousand pixels a frame; the time of each frame in
/// milliseconds.
async fn scrolled(browser: &Browser) -> Vec<f64> {
    let frames = browser
        .run_async(
            "const frame = document.querySelector('.list-frame');
             const times = [];
             let last = performance.now(), speed = 37;
             frame.scrollTop = 0;
             const step = (now) => {
               times.push(now - last);
               last = now;
               frame.scrollTop += speed;
               if (times.length % 60 === 0) speed = speed === 37 ? 997 : speed === 997 ? 100003 : 37;
               if (times.length < 600) requestAnimationFrame(step);
               else done(times.slice(5));
             };
             requestAnimationFrame(step);",
        )
        .await;
    frames.as_array().into_iter().flatten().filter_map(serde_json::Value::as_f64).collect()
}
