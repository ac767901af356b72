//! The device's own help, a sheet over any page.

use crate::testbed::Browser;

/// The sheet in a browser.
#[derive(Clone, Copy)]
pub struct HelpSheet<'a> {
    /// Where it is.
    pub browser: &'a Browser,
}

impl<'a> HelpSheet<'a> {
    /// Opens it by its button in the top bar and waits until it tells something.
    pub async fn open(browser: &'a Browser) -> Self {
        browser.run("document.querySelector('[data-test=help]').focus()").await;
        browser.click("help").await;
        let sheet = Self { browser };
        browser.wait_for("document.querySelector('[data-test=help-sheet][open] [data-test=help-wiring]')").await;
        sheet
    }

    /// Waits until its heading holds a text.
    pub async fn wait_for_title(&self, part: &str) {
        let title = "document.querySelector('#help-title').innerText";
        self.browser.wait_for(&format!("{title}.includes({part:?})")).await;
    }

    /// The text of one of its sections: `wiring`, `defaults`, `limits`, `try`, `notes`, `errata`.
    pub async fn section(&self, name: &str) -> String {
        self.browser.text(&format!("help-{name}")).await
    }

    /// Signals of the wires in the drawing, from the top down.
    pub async fn wires(&self) -> Vec<String> {
        let all = "return [...document.querySelectorAll('.help-wires .signal')].map(text => text.textContent)";
        let found = self.browser.run(all).await;
        let texts = found.as_array().expect("a list").iter();
        texts.map(|text| text.as_str().expect("a text").to_owned()).collect()
    }

    /// Presses Escape as a hand does and waits until the sheet is closed.
    pub async fn escape(&self) {
        let key = |kind: &str| serde_json::json!({ "type": kind, "key": "Escape", "code": "Escape", "windowsVirtualKeyCode": 27 });
        for kind in ["keyDown", "keyUp"] {
            self.browser.devtools("Input.dispatchKeyEvent", key(kind)).await;
        }
        self.wait_for_closed().await;
    }

    /// Closes it by its button.
    pub async fn close(&self) {
        self.browser.click("help-close").await;
        self.wait_for_closed().await;
    }

    /// Whether the focus is on the button that opens it.
    pub async fn wait_for_focus_on_its_button(&self) {
        self.browser.wait_for("document.activeElement?.dataset.test === 'help'").await;
    }

    async fn wait_for_closed(&self) {
        self.browser.wait_for("document.querySelector('[data-test=help-sheet]:not([open])')").await;
    }
}
