//! The Decoder page.

use crate::testbed::{Browser, site};

/// The Decoder page in a browser.
#[derive(Clone, Copy)]
pub struct DecoderPage<'a> {
    /// Where it is open.
    pub browser: &'a Browser,
}

impl<'a> DecoderPage<'a> {
    /// Goes to the page and waits until it is drawn.
    pub async fn open(browser: &'a Browser) -> Self {
        Self::open_at(browser, &site()).await
    }

    /// The same for a site at an address.
    pub async fn open_at(browser: &'a Browser, site: &str) -> Self {
        browser.open(&format!("{site}/#/decoder")).await;
        browser.wait_for("document.querySelector('[data-test=page-decoder]')").await;
        Self { browser }
    }

    /// Puts a text into the field, as pasting does.
    pub async fn paste(&self, text: &str) {
        let script = format!(
            "const field = document.querySelector('[data-test=decoder-input]');
             field.value = {text:?};
             field.dispatchEvent(new InputEvent('input', {{ bubbles: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Waits for so many frames and returns the text of each row.
    pub async fn rows(&self, count: usize) -> Vec<String> {
        self.texts("frame-row", count).await
    }

    /// The text of each field of the chosen frame.
    pub async fn fields(&self, count: usize) -> Vec<String> {
        self.texts("field-row", count).await
    }

    /// What the page says of a text that it cannot read.
    pub async fn error(&self) -> String {
        let text = "document.querySelector('[data-test=decoder-error]')?.innerText";
        self.browser.wait_for(text).await.as_str().unwrap_or_default().trim().to_owned()
    }

    async fn texts(&self, name: &str, count: usize) -> Vec<String> {
        let rows = format!("[...document.querySelectorAll('[data-test={name}]')]");
        self.browser.wait_for(&format!("{rows}.length === {count}")).await;
        let texts = self.browser.run(&format!("return {rows}.map((row) => row.innerText)")).await;
        let texts = texts.as_array().cloned().unwrap_or_default();
        texts.iter().filter_map(|text| Some(text.as_str()?.replace('\u{a0}', " "))).collect()
    }
}
