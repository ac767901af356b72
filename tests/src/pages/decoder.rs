//! The Decoder page.

use serde_json::Value;

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

    /// Puts a text into the field, as typing does.
    pub async fn paste(&self, text: &str) {
        let text = Value::from(text);
        let script = format!(
            "const field = document.querySelector('[data-test=decoder-input]');
             field.value = {text};
             field.dispatchEvent(new InputEvent('input', {{ bubbles: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Pastes what a script expression gives, through the browser's own event; says when, on the page's clock. The text is
    /// made before, so that only the paste is the page's work.
    pub async fn paste_expression(&self, expression: &str) -> f64 {
        let make = format!(
            "globalThis.toPaste = new DataTransfer();
             toPaste.setData('text', {expression});"
        );
        self.browser.run(&make).await;
        let paste = "const field = document.querySelector('[data-test=decoder-input]');
             globalThis.longest = 0;
             const pastedAt = performance.now();
             field.dispatchEvent(
               new ClipboardEvent('paste', { clipboardData: toPaste, bubbles: true, cancelable: true }));
             return pastedAt;";
        self.browser.run(paste).await.as_f64().expect("a time")
    }

    /// Drops a file with these bytes, given as a script expression, onto the card.
    pub async fn drop_file(&self, name: &str, bytes: &str) {
        let script = format!(
            "const dataTransfer = new DataTransfer();
             dataTransfer.items.add(new File([{bytes}], {name:?}));
             document.querySelector('[data-test=decoder-drop]')
               .dispatchEvent(new DragEvent('drop', {{ dataTransfer, bubbles: true, cancelable: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Waits for so many rows and returns the text of each.
    pub async fn rows(&self, rows: usize) -> Vec<String> {
        self.texts("frame-row", rows).await
    }

    /// Waits until so many rows, or more, are in sight.
    pub async fn rows_at_least(&self, count: usize) {
        self.browser.wait_for(&format!("document.querySelectorAll('[data-test=frame-row]').length >= {count}")).await;
    }

    /// Waits until the count beside the list's title is this.
    pub async fn wait_for_entries(&self, count: &str) {
        let text = "document.querySelector('[data-test=frame-count]')?.innerText.replace(/\\u202f/g, '')";
        self.browser.wait_for(&format!("{text} === {count:?}")).await;
    }

    /// The text of each field of the chosen frame.
    pub async fn fields(&self, count: usize) -> Vec<String> {
        self.texts("field-row", count).await
    }

    /// Waits for a diagnosis of the chosen frame and returns its text.
    pub async fn diagnosis(&self, id: &str) -> String {
        let text = format!("document.querySelector('[data-test=diagnosis][data-id={id}]')?.innerText");
        self.browser.wait_for(&text).await.as_str().unwrap_or_default().to_owned()
    }

    /// What the page says of a text that it cannot read.
    pub async fn error(&self) -> String {
        let text = "document.querySelector('[data-test=decoder-error]')?.innerText";
        self.browser.wait_for(text).await.as_str().unwrap_or_default().trim().to_owned()
    }

    /// From now on, keeps what the page gives the user to save, as text.
    pub async fn catch_files(&self) {
        self.browser
            .run(
                "globalThis.saved = [];
                 const make = URL.createObjectURL;
                 URL.createObjectURL = (file) => { file.text().then((text) => saved.push(text)); return make(file); };",
            )
            .await;
    }

    /// The text of the only file that was saved.
    pub async fn saved(&self) -> String {
        let text = self.browser.wait_for("saved.length === 1 && saved[0]").await;
        self.browser.run("saved.length = 0").await;
        text.as_str().unwrap_or_default().to_owned()
    }

    async fn texts(&self, name: &str, count: usize) -> Vec<String> {
        let rows = format!("[...document.querySelectorAll('[data-test={name}]')]");
        self.browser.wait_for(&format!("{rows}.length === {count}")).await;
        let texts = self.browser.run(&format!("return {rows}.map((row) => row.innerText)")).await;
        let texts = texts.as_array().cloned().unwrap_or_default();
        let plain = |text: &str| text.replace(['\u{a0}', '\n'], " ");
        texts.iter().filter_map(|text| Some(plain(text.as_str()?))).collect()
    }
}
