//! The Fleet page.

use serde_json::Value;

use super::{ConsolePage, LivePage};
use crate::testbed::{Browser, site};

/// The Fleet page in a browser.
#[derive(Clone, Copy)]
pub struct FleetPage<'a> {
    /// Where it is open.
    pub browser: &'a Browser,
}

/// A device of a series, as the list shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SensorRow {
    /// Its unit id.
    pub unit: String,
    /// `done`, `failed`, `left-out` or `under-way`.
    pub state: String,
    /// Its name.
    pub name: String,
}

impl<'a> FleetPage<'a> {
    /// Goes to the page and waits until it is drawn.
    pub async fn open(browser: &'a Browser) -> Self {
        Self::open_at(browser, &site()).await
    }

    /// The same for a site at an address. A connection outlives it: only the part behind `#` changes.
    pub async fn open_at(browser: &'a Browser, site: &str) -> Self {
        browser.open(&format!("{site}/#/fleet")).await;
        let page = Self { browser };
        page.wait().await;
        page
    }

    /// Waits until the page is drawn.
    pub async fn wait(&self) {
        self.browser.wait_for("document.querySelector('[data-test=page-fleet]')").await;
    }

    /// Opens a pane: `snapshots`, `series` or `audit`.
    pub async fn pane(&self, key: &str) {
        self.browser.click(&format!("fleet-{key}")).await;
        self.browser.wait_for(&format!("document.querySelector('[data-test=fleet-{key}][aria-selected=true]')")).await;
    }

    /// Connects by the card above the page.
    pub async fn connect(&self) {
        LivePage { browser: self.browser }.connect().await;
    }

    // Snapshots.

    /// Takes a snapshot under a name, and waits until it is kept.
    pub async fn take(&self, name: &str) {
        self.browser.fill("snapshot-name", name).await;
        self.browser.click("take-snapshot").await;
        self.wait_for_told(name).await;
    }

    /// Waits until the page says this of the last snapshot or file; returns all that it says.
    pub async fn wait_for_told(&self, words: &str) -> String {
        let told = "document.querySelector('[data-test=snapshot-told]')?.innerText";
        let text = self.browser.wait_for(&format!("{told}?.includes({words:?}) && {told}")).await;
        text.as_str().unwrap_or_default().to_owned()
    }

    /// Waits until the snapshots that are kept have these names, the newest first.
    pub async fn wait_for_snapshots(&self, names: &[&str]) {
        let rows = "[...document.querySelectorAll('[data-test=snapshot-rename]')].map((field) => field.value)";
        let wanted = Value::from(names.to_vec());
        self.browser
            .wait_for(&format!(
                "(document.querySelector('[data-test=snapshots-empty]') || {rows}.length) && \
                 JSON.stringify({rows}) === JSON.stringify({wanted})"
            ))
            .await;
    }

    /// Saves the snapshot in a row and returns the file.
    pub async fn save(&self, row: usize) -> String {
        let console = self.catch_files().await;
        self.browser.click_nth("snapshot-save", row).await;
        text(console.saved().await)
    }

    /// Drops a file onto the snapshots.
    pub async fn drop_file(&self, content: &str) {
        let content = Value::from(content);
        let script = format!(
            "const dataTransfer = new DataTransfer();
             dataTransfer.items.add(new File([{content}], 'snapshot.json'));
             document.querySelector('[data-test=snapshots]')
               .dispatchEvent(new DragEvent('drop', {{ dataTransfer, bubbles: true, cancelable: true }}));"
        );
        self.browser.run(&script).await;
    }

    // The comparison.

    /// Compares the snapshot in a row with the device as it is now, and waits until the device was read.
    pub async fn compare_with_device(&self, row: usize) {
        self.browser.click_nth("snapshot-compare", row).await;
        self.browser
            .wait_for(
                "document.querySelector('[data-test=transfer]') && \
                 !document.querySelector('[data-test=compare-read]').disabled",
            )
            .await;
    }

    /// Waits for so many differences.
    pub async fn wait_for_differences(&self, count: usize) {
        self.browser
            .wait_for(&format!("document.querySelector('[data-test=compare-count][data-count=\"{count}\"]')"))
            .await;
    }

    /// The rows of the comparison that are in sight, each as the texts of its cells.
    pub async fn differences(&self) -> Vec<Vec<String>> {
        let script = "return [...document.querySelectorAll('[data-test=compare-row]')].map((row) =>
            [row.dataset.point, ...[...row.querySelectorAll('.fleet-held > span')].map((cell) => cell.innerText)])";
        serde_json::from_value(self.browser.run(script).await).expect("rows of texts")
    }

    /// Waits until so many changes would bring the device to the snapshot.
    pub async fn wait_for_changes(&self, count: usize) {
        self.browser
            .wait_for(&format!("document.querySelector('[data-test=bring-what][data-count=\"{count}\"]')"))
            .await;
    }

    /// Goes on to the review of what brings the device to the snapshot.
    pub async fn bring(&self) {
        self.browser.click("bring").await;
        self.browser.wait_for("document.querySelector('[data-test=review-card]')").await;
    }

    // A series.

    /// Begins a series from this unit id on, with these settings of every device by their codes.
    pub async fn begin_series(&self, first: u8, settings: &[(&str, u16)]) {
        self.pane("series").await;
        self.browser.fill("series-first", &first.to_string()).await;
        for (point, code) in settings {
            self.browser.choose(&format!("give-{point}"), &format!("0x{code:04X}")).await;
        }
        self.browser.click("series-begin").await;
        self.wait_for_series("next").await;
    }

    /// Waits until the series waits for the `next` device, is `running`, or the last one has `failed`.
    pub async fn wait_for_series(&self, now: &str) {
        self.browser.wait_for(&format!("document.querySelector('[data-test=series][data-now={now}]')")).await;
    }

    /// Sets up the device that is plugged in, under a name, and waits until something has come of it.
    pub async fn set_up(&self, name: &str) {
        let before = self.sensors().await.len();
        if !name.is_empty() {
            self.browser.fill("sensor-name", name).await;
        }
        self.browser.click("set-up").await;
        self.browser
            .wait_for(&format!(
                "document.querySelectorAll('[data-test=sensor-row]').length === {} && \
                 document.querySelector('[data-test=series]:not([data-now=running])')",
                before + 1
            ))
            .await;
    }

    /// Sets up a device of the list again, and waits until something has come of it.
    pub async fn set_up_again(&self, row: usize) {
        self.browser.click_nth("sensor-again", row).await;
        self.wait_for_series("running").await;
        self.browser.wait_for("document.querySelector('[data-test=series]:not([data-now=running])')").await;
    }

    /// Why the last device has failed.
    pub async fn failure(&self) -> (String, String) {
        let key = self.browser.wait_for("document.querySelector('[data-test=series-failed]')?.dataset.failure").await;
        (key.as_str().unwrap_or_default().to_owned(), self.browser.text("series-failed").await)
    }

    /// The devices of the series.
    pub async fn sensors(&self) -> Vec<SensorRow> {
        let script = "return [...document.querySelectorAll('[data-test=sensor-row]')].map((row) =>
            [row.dataset.unit, row.dataset.state, row.querySelector('input').value])";
        let rows: Vec<[String; 3]> = serde_json::from_value(self.browser.run(script).await).expect("rows of texts");
        rows.into_iter().map(|[unit, state, name]| SensorRow { unit, state, name }).collect()
    }

    /// The texts of the labels.
    pub async fn labels(&self) -> Vec<String> {
        let script = "return [...document.querySelectorAll('[data-test=label]')].map((label) => label.innerText)";
        serde_json::from_value(self.browser.run(script).await).expect("texts")
    }

    /// Saves the list of the series and returns the file.
    pub async fn save_series(&self) -> String {
        let console = self.catch_files().await;
        self.browser.click("series-export").await;
        text(console.saved().await)
    }

    /// Catches what is saved from now on.
    async fn catch_files(&self) -> ConsolePage<'a> {
        let console = ConsolePage { browser: self.browser };
        if self.browser.run("return globalThis.saved === undefined").await == true {
            console.catch_files().await;
        }
        console
    }

    // The log.

    /// Waits until the log has so many entries.
    pub async fn wait_for_entries(&self, count: usize) {
        self.browser
            .wait_for(&format!("document.querySelector('[data-test=audit-count][data-count=\"{count}\"]')"))
            .await;
    }

    /// Saves the log as `csv` or `jsonl` and returns the file.
    pub async fn save_log(&self, form: &str) -> String {
        let console = self.catch_files().await;
        self.browser.click("audit-export").await;
        self.browser.click(&format!("audit-{form}")).await;
        text(console.saved().await)
    }
}

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).expect("a file of text")
}
