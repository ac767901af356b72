//! What must outlive a page: the journal of a change, before its first byte is on the line.

use std::time::Duration;

use buslens_bus::sim::{Device, Line, Lvdt, Motion, Reply};
use buslens_bus::time::Instant;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::{UnitId, rtu};
use buslens_tests::pages::{ConfigurePage, LivePage, State};
use buslens_tests::testbed::{Bench, Browser, site};
use serde_json::Value;

/// Longer than any exchange takes.
const SOON: Duration = Duration::from_secs(10);
/// Zero here: function 05.
const ZERO: [u8; 5] = [5, 0, 0x50, 0xFF, 0];

/// A sensor that is dumb from the first write on, until it is told to speak.
struct Dumb {
    sensor: Lvdt,
    has_fallen_silent: bool,
    speaks_always: bool,
}

impl Device for Dumb {
    fn line(&self) -> LineSettings {
        self.sensor.line()
    }

    fn mode(&self) -> Mode {
        self.sensor.mode()
    }

    fn is_listening(&self, now: Instant) -> bool {
        self.sensor.is_listening(now)
    }

    fn serve(&mut self, now: Instant, unit: UnitId, request: &[u8]) -> Option<Reply> {
        let reply = self.sensor.serve(now, unit, request);
        self.has_fallen_silent |= request.first() == Some(&5);
        reply.filter(|_| self.speaks_always || !self.has_fallen_silent)
    }
}

fn dumb(speaks_always: bool) -> Line<Dumb> {
    let sensor = Lvdt::new(1, Motion::Rest { micrometres: 1_234, decidegrees: 255 });
    Line::new([Dumb { sensor, has_fallen_silent: false, speaks_always }], 1)
}

/// Connects to the sensor on the Live page.
async fn connect(browser: &Browser) {
    let live = LivePage::open(browser).await;
    live.connect().await;
    live.wait_for(State::Reading).await;
}

/// Has the Live page's command given, and answers its question.
async fn zero(browser: &Browser) {
    browser.click("command-zero-65280").await;
    browser.click("command-confirm").await;
}

/// Waits until the command has ended so.
async fn ended(browser: &Browser, verdict: &str) {
    browser.wait_for(&format!("document.querySelector('[data-test=command-outcome][data-verdict={verdict}]')")).await;
}

/// All texts of a table that outlives the page.
async fn kept(browser: &Browser, table: &str) -> Vec<Value> {
    let script = format!(
        "const opening = indexedDB.open('buslens');
         opening.onsuccess = () => {{
           const request = opening.result.transaction('{table}').objectStore('{table}').getAll();
           request.onsuccess = () => {{ opening.result.close(); done(request.result); }};
         }};"
    );
    let texts = browser.run_async(&script).await;
    let texts = texts.as_array().expect("a list");
    texts.iter().map(|text| serde_json::from_str(text.as_str().expect("a text")).expect("an object")).collect()
}

/// How many journals some page works on.
async fn held(browser: &Browser) -> u64 {
    let script = "navigator.locks.query().then(({ held }) => \
                  done(held.filter(({ name }) => name.startsWith('buslens-journal-')).length));";
    browser.run_async(script).await.as_u64().expect("a count")
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_journal_is_on_the_disk_when_the_write_leaves_and_outlives_the_page() {
    let bench = Bench::new(dumb(false)).await;
    connect(&bench.browser).await;
    let frame = rtu::encode(UnitId(1), &ZERO).expect("a short frame");
    zero(&bench.browser).await;
    bench.wire().wait_for_sent(0, SOON, |sent| sent.windows(frame.len()).any(|bytes| bytes == frame));
    // The sensor does not answer, so that it is under way yet.
    let journals = kept(&bench.browser, "journals").await;
    assert_eq!(journals.len(), 1);
    assert_eq!((&journals[0]["profile"], &journals[0]["steps"][0]["point"]), (&"lvdt".into(), &"zero".into()));
    assert_eq!(held(&bench.browser).await, 1);
    bench.browser.reload().await;
    // The browser takes the lock back from the page that is gone.
    let free = format!("navigator.locks.request('buslens-journal-{}', () => done(true));", journals[0]["id"]);
    bench.browser.run_async(&free).await;
    assert_eq!(kept(&bench.browser, "journals").await, journals);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn another_tab_offers_a_journal_once_nobody_works_on_it_any_more() {
    let bench = Bench::new(dumb(false)).await;
    let page = ConfigurePage::open(&bench.browser).await;
    // This tab notes whether the other one was there when it made its offer.
    let watch = "globalThis.offered = null;
                 new MutationObserver(() => {
                   if (document.querySelector('[data-test=journal]')) offered ??= localStorage.getItem('other') ?? 'alone';
                 }).observe(document, { subtree: true, childList: true });";
    bench.browser.run(watch).await;
    let write = async || {
        let told = "localStorage.setItem('other', 'there');
                    addEventListener('pagehide', () => localStorage.removeItem('other'));";
        bench.browser.run(told).await;
        connect(&bench.browser).await;
        zero(&bench.browser).await;
        let frame = rtu::encode(UnitId(1), &ZERO).expect("a short frame");
        bench.wire().wait_for_sent(0, SOON, |sent| sent.windows(frame.len()).any(|bytes| bytes == frame));
        // The first tab has read the journal, and waits for this one.
        let waits = "const look = () => navigator.locks.query().then(({ pending }) =>
                       pending.some(({ name }) => name.startsWith('buslens-journal-')) ? done(true) : setTimeout(look));
                     look();";
        bench.browser.run_async(waits).await;
    };
    bench.browser.in_another_tab(&site(), write).await;
    assert!(page.wait_for_journal().await.contains("ero"));
    assert_eq!(bench.browser.run("return offered").await, "alone");
    // What one tab does with it, the other one sees.
    let leave = async || {
        page.wait_for_journal().await;
        bench.browser.click("journal-leave").await;
        bench.browser.click("journal-leave-now").await;
        page.wait_for_no_journal().await;
    };
    bench.browser.in_another_tab(&format!("{}/#/configure", site()), leave).await;
    page.wait_for_no_journal().await;
    assert_eq!(kept(&bench.browser, "journals").await, [Value::Null; 0]);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_write_that_is_proven_leaves_no_journal_and_stands_in_the_audit_log() {
    let bench = Bench::new(dumb(true)).await;
    connect(&bench.browser).await;
    for _ in 0..2 {
        zero(&bench.browser).await;
        ended(&bench.browser, "done").await;
        bench.browser.click("command-dismiss").await;
        bench.browser.wait_for("!document.querySelector('[data-test=command-outcome]')?.innerText").await;
    }
    assert_eq!((kept(&bench.browser, "journals").await.len(), held(&bench.browser).await), (0, 0));
    let audit = kept(&bench.browser, "audit").await;
    assert_eq!(audit.len(), 2);
    assert_eq!((&audit[0]["entry"]["point"], &audit[0]["simulated"]), (&"zero".into(), &false.into()));
    assert_eq!(kept(&bench.browser, "counts").await, [Value::from(2)]);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn where_nothing_can_be_kept_nothing_is_written() {
    let bench = Bench::new(dumb(true)).await;
    connect(&bench.browser).await;
    // A database of a version to come is none for this page.
    let script = "const opening = indexedDB.open('buslens', 1000);
                  opening.onsuccess = () => { opening.result.close(); done(true); };";
    bench.browser.run_async(script).await;
    zero(&bench.browser).await;
    ended(&bench.browser, "not-sent").await;
    assert!(!bench.wire().sent().chunks_exact(8).any(|request| request[1] == 5));
}
