//! The Builder page.

use crate::testbed::{Browser, site};

/// The Builder page in a browser.
#[derive(Clone, Copy)]
pub struct BuilderPage<'a> {
    /// Where it is open.
    pub browser: &'a Browser,
}

impl<'a> BuilderPage<'a> {
    /// Goes to the page and waits until it is drawn.
    pub async fn open(browser: &'a Browser) -> Self {
        Self::open_at(browser, &site()).await
    }

    /// The same for a site at an address.
    pub async fn open_at(browser: &'a Browser, site: &str) -> Self {
        browser.open(&format!("{site}/#/builder")).await;
        let page = Self { browser };
        page.wait().await;
        page
    }

    /// Waits until the page is drawn.
    pub async fn wait(&self) {
        self.browser.wait_for("document.querySelector('[data-test=page-builder]')").await;
    }

    /// Chooses a device and what to do with one of its points: `read:` or `write:` with its id.
    pub async fn choose_point(&self, device: &str, point: &str) {
        self.browser.choose("builder-device", device).await;
        self.browser.choose("builder-point", point).await;
    }

    /// Chooses the value of the point by its code.
    pub async fn choose_value(&self, code: u16) {
        self.browser.choose("builder-point-value", &code.to_string()).await;
    }

    /// Chooses a function by its two digits.
    pub async fn choose_function(&self, code: &str) {
        self.browser.choose("builder-function", code).await;
    }

    /// Types into a field.
    pub async fn fill(&self, field: &str, text: &str) {
        self.browser.fill(&format!("builder-{field}"), text).await;
    }

    /// Waits until the RTU frame reads so, as digits with spaces.
    pub async fn wait_for_rtu(&self, text: &str) {
        self.wait_for_bytes("rtu", text).await;
    }

    /// Waits until the ASCII frame reads so, character by character.
    pub async fn wait_for_ascii(&self, text: &str) {
        self.wait_for_bytes("ascii", text).await;
    }

    /// Waits until the note under a field holds `text`.
    pub async fn wait_for_note(&self, field: &str, text: &str) {
        let note = format!("document.getElementById('builder-{field}-note')?.innerText");
        self.browser.wait_for(&format!("{note}?.includes({text:?})")).await;
    }

    /// Copies the frame in a spelling and returns what is in the clipboard then.
    pub async fn copy(&self, spelling: &str) -> String {
        let browser = self.browser;
        let grant = serde_json::json!({ "permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"] });
        browser.devtools("Browser.grantPermissions", grant).await;
        browser.click(&format!("copy-{spelling}")).await;
        browser
            .wait_for(&format!("document.querySelector('[data-test=copy-{spelling}]').innerText === 'Copied'"))
            .await;
        let text = browser.run_async("navigator.clipboard.readText().then(done, (error) => done(String(error)))").await;
        text.as_str().unwrap_or_default().to_owned()
    }

    /// Puts a text into the calculator, as pasting does.
    pub async fn calculate(&self, text: &str) {
        let script = format!(
            "const field = document.querySelector('[data-test=calculator-input]');
             field.value = {text:?};
             field.dispatchEvent(new InputEvent('input', {{ bubbles: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Waits until the calculator shows this CRC, as on the line, and this LRC.
    pub async fn wait_for_sums(&self, crc: &str, lrc: &str) {
        for (name, text) in [("sum-crc", crc), ("sum-lrc", lrc)] {
            let shown = format!("document.querySelector('[data-test={name}]')?.innerText");
            self.browser.wait_for(&format!("{shown} === {text:?}")).await;
        }
    }

    async fn wait_for_bytes(&self, mode: &str, text: &str) {
        let bytes = format!("[...document.querySelectorAll('[data-test=frame-{mode}] [data-test=byte]')]");
        self.browser.wait_for(&format!("{bytes}.map((byte) => byte.innerText.trim()).join(' ') === {text:?}")).await;
    }
}
