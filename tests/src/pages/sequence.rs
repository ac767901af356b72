//! The Console page's pane of sequences.

use serde_json::Value;

use super::ConsolePage;

impl ConsolePage<'_> {
    /// Opens the pane and shows the text.
    pub async fn open_sequences(&self) {
        self.open_pane("sequence").await;
        self.browser.click("sequence-view-text").await;
    }

    /// Chooses the ready-made sequence of this number, counted from 0.
    pub async fn choose_ready_made(&self, number: usize) {
        self.browser.choose("sequence-choice", &format!("ready-{number}")).await;
    }

    /// Begins a new sequence with this text.
    pub async fn write_sequence(&self, text: &str) {
        self.browser.run("document.querySelector('[data-test=sequence-manage]').closest('details').open = true").await;
        self.browser.click("sequence-new").await;
        self.browser.wait_for("!document.querySelector('[data-test=sequence-text]').readOnly").await;
        self.change_sequence(text).await;
    }

    /// Replaces the text of the sequence that is shown, as pasting does.
    pub async fn change_sequence(&self, text: &str) {
        let text = Value::from(text);
        let script = format!(
            "const field = document.querySelector('[data-test=sequence-text]');
             field.value = {text};
             field.dispatchEvent(new Event('input', {{ bubbles: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Waits until the text has no fault.
    pub async fn wait_for_right_sequence(&self) {
        self.browser.wait_for("document.querySelector('[data-test=sequence-right]')").await;
    }

    /// Waits for faults, and returns them in the page's words.
    pub async fn sequence_faults(&self) -> Vec<String> {
        let all = "[...document.querySelectorAll('[data-test=sequence-fault]')].map((fault) => fault.innerText.trim())";
        let found = self.browser.wait_for(&format!("{all}.length > 0 && {all}")).await;
        found.as_array().into_iter().flatten().filter_map(|text| text.as_str().map(str::to_owned)).collect()
    }

    /// Runs the sequence that is shown.
    pub async fn run_sequence(&self) {
        self.browser.click("sequence-run").await;
        self.browser.wait_for("document.querySelector('[data-test=sequence-steps]')").await;
    }

    /// Waits until the run has ended with `passed`, `failed` or `incomplete`.
    pub async fn wait_for_verdict(&self, verdict: &str) {
        let ending = "document.querySelector('[data-test=sequence-ending]')";
        self.browser.wait_for(&format!("{ending}?.dataset.verdict === {verdict:?}")).await;
    }

    /// Why the run has ended, in the page's words.
    pub async fn sequence_ending(&self) -> String {
        self.browser.text("sequence-ending").await
    }

    /// Waits until a step with this text bears a mark.
    pub async fn wait_for_step(&self, mark: &str, text: &str) {
        let marked = format!("document.querySelectorAll('[data-test=sequence-step][data-mark={mark}]')");
        self.browser.wait_for(&format!("[...{marked}].some((step) => step.innerText.includes({text:?}))")).await;
    }

    /// The steps that are marked `passed`, `failed`, `skipped` or `running`, with their bytes and reasons.
    pub async fn steps(&self, mark: &str) -> Vec<String> {
        let all = format!(
            "return [...document.querySelectorAll('[data-test=sequence-step][data-mark={mark}]')]
                .map((step) => step.innerText.replace(/\\s+/g, ' ').trim())"
        );
        let found = self.browser.run(&all).await;
        found.as_array().into_iter().flatten().filter_map(|text| text.as_str().map(str::to_owned)).collect()
    }
}
