//! What can be done with the device that the Live page reads: commands, units, limits.

use super::LivePage;
use crate::testbed::{Browser, site};

/// The part of the Live page below its figures.
#[derive(Clone, Copy)]
pub struct Handling<'a> {
    /// Where it is open.
    pub browser: &'a Browser,
}

impl<'a> Handling<'a> {
    /// Chooses the device, connects, and waits for the first readings and for this part of the page.
    pub async fn connect(browser: &'a Browser, device: &str) -> Self {
        let live = LivePage::open(browser).await;
        live.choose_device(device).await;
        live.connect().await;
        live.wait_for(super::State::Reading).await;
        Self::open(browser).await
    }

    /// Waits until it is drawn.
    pub async fn open(browser: &'a Browser) -> Self {
        browser.wait_for("document.querySelector('[data-test=handling]')").await;
        Self { browser }
    }

    /// The Live page around it.
    pub fn live(&self) -> LivePage<'a> {
        LivePage { browser: self.browser }
    }

    /// Presses the button of a command.
    pub async fn press(&self, point: &str, code: u16) {
        self.browser.click(&format!("command-{point}-{code}")).await;
    }

    /// Presses it and answers the question.
    pub async fn give(&self, point: &str, code: u16) {
        self.press(point, code).await;
        self.confirm().await;
    }

    /// The question that stands there now.
    pub async fn question(&self) -> String {
        self.browser.wait_for("document.querySelector('[data-test=command-question]')").await;
        self.browser.text("command-question").await
    }

    /// Whether the question can be answered with yes.
    pub async fn can_confirm(&self) -> bool {
        let enabled = "return document.querySelector('[data-test=command-confirm]:enabled') !== null";
        self.browser.run(enabled).await == true
    }

    /// Ticks all consequences.
    pub async fn accept_all(&self) {
        let count = "return document.querySelectorAll('[data-test=command-accept]').length";
        let count = self.browser.run(count).await.as_u64().unwrap_or(0);
        for number in 0..count {
            self.browser.click_nth("command-accept", usize::try_from(number).unwrap_or(0)).await;
        }
    }

    /// Answers the question with yes.
    pub async fn confirm(&self) {
        self.browser.click("command-confirm").await;
    }

    /// Waits until the last command has ended so: `done`, `refused`, `unproven`, `read-only`, `no-answer`, `not-sent`,
    /// `interrupted` or `lost`; and returns what the page says of it.
    pub async fn outcome(&self, verdict: &str) -> String {
        let outcome = format!("document.querySelector('[data-test=command-outcome][data-verdict={verdict}]')");
        self.browser.wait_for(&outcome).await;
        self.browser.text("command-outcome").await
    }

    /// The frames of the last command as hexadecimal digits: what was sent, what came back.
    pub async fn frames(&self) -> [String; 2] {
        let open = "document.querySelector('[data-test=command-frames]').open = true;
                    return [...document.querySelectorAll('[data-test=command-frames] .half')]
                      .map((half) => [...half.querySelectorAll('[data-test=byte]')].map((byte) => byte.innerText).join(' '))";
        let halves = self.browser.run(open).await;
        [0, 1].map(|at| halves[at].as_str().unwrap_or_default().to_owned())
    }

    /// Takes the last command's outcome off the page.
    pub async fn dismiss(&self) {
        self.browser.click("command-dismiss").await;
        self.browser.wait_for("!document.querySelector('[data-test=command-outcome]')?.innerText").await;
    }

    /// Whether any command can be given.
    pub async fn is_any_enabled(&self) -> bool {
        let any = "return document.querySelector('.command-buttons .button:enabled') !== null";
        self.browser.run(any).await == true
    }

    /// Waits until no command can be given for this reason: `replay`, `read-only` or `closed`; what is said of it.
    pub async fn locked(&self, why: &str) -> String {
        self.browser.wait_for(&format!("document.querySelector('[data-test=commands-locked][data-why={why}]')")).await;
        self.browser.text("commands-locked").await
    }

    /// Waits until commands can be given.
    pub async fn unlocked(&self) {
        let open = "document.querySelector('.command-buttons .button:enabled') && \
                    !document.querySelector('[data-test=commands-locked]')";
        self.browser.wait_for(open).await;
    }

    /// Unfolds the commands that can lose settings.
    pub async fn unfold_risky(&self) {
        self.browser.run("document.querySelector('[data-test=risky]').open = true").await;
    }

    /// What the device was made to be, as the page says beside its name.
    pub async fn marks(&self) -> Vec<String> {
        let marks =
            self.browser.run("return [...document.querySelectorAll('[data-test=mark]')].map((m) => m.innerText)");
        let marks = marks.await;
        marks.as_array().into_iter().flatten().filter_map(|mark| Some(mark.as_str()?.to_owned())).collect()
    }

    /// Waits until a parameter beside the readings reads so.
    pub async fn wait_for_context(&self, point: &str, text: &str) {
        let found = format!("document.querySelector('[data-test=context-{point}]')?.innerText.trim()");
        self.browser.wait_for(&format!("{found} === {text:?}")).await;
    }

    /// Waits until the bar says so where the value stands.
    pub async fn wait_for_share(&self, text: &str) {
        let found = "document.querySelector('[data-test=range-share]')?.innerText.trim()";
        self.browser.wait_for(&format!("{found} === {text:?}")).await;
    }

    /// The notes on single points.
    pub async fn notes(&self) -> String {
        self.browser.text("point-notes").await
    }

    /// Lets only reads out, or everything, by the switch at the top of every page.
    pub async fn set_read_only(&self, on: bool) {
        set_read_only(self.browser, on).await;
    }

    /// Loads the page again.
    pub async fn reload(&self) {
        self.browser.open(&site()).await;
        self.browser.reload().await;
    }
}

/// Lets only reads out, or everything, by the switch at the top of every page.
pub async fn set_read_only(browser: &Browser, on: bool) {
    if is_read_only(browser).await != on {
        browser.click("read-only").await;
    }
    browser.wait_for(&format!("document.querySelector('[data-test=read-only][aria-checked={on}]')")).await;
}

/// Whether the switch at the top of the page is on.
pub async fn is_read_only(browser: &Browser) -> bool {
    browser.wait_for("document.querySelector('[data-test=read-only]')").await;
    browser.run("return document.querySelector('[data-test=read-only]').ariaChecked === 'true'").await == true
}
