//! The Configure page.

use crate::testbed::{Browser, site};

/// The Configure page in a browser.
#[derive(Clone, Copy)]
pub struct ConfigurePage<'a> {
    /// Where it is open.
    pub browser: &'a Browser,
}

impl<'a> ConfigurePage<'a> {
    /// Goes to the page and waits until it is drawn.
    pub async fn open(browser: &'a Browser) -> Self {
        Self::open_at(browser, &site()).await
    }

    /// The same for a site at an address. A connection outlives it: only the part behind `#` changes.
    pub async fn open_at(browser: &'a Browser, site: &str) -> Self {
        browser.open(&format!("{site}/#/configure")).await;
        let page = Self { browser };
        page.wait().await;
        page
    }

    /// Waits until the page is drawn.
    pub async fn wait(&self) {
        self.browser.wait_for("document.querySelector('[data-test=page-configure]')").await;
    }

    /// Waits until everything has been read, and nothing is under way.
    pub async fn wait_until_read(&self) {
        let read = "document.querySelector('[data-test=configure-read][data-state=still]')?.innerText";
        self.browser
            .wait_for(&format!(
                "/\\d/.test({read}) && !document.querySelector('[data-test=run-card]') && \
                 !document.querySelector('[data-test=read-again]').disabled"
            ))
            .await;
    }

    /// Waits until a parameter shows this value.
    pub async fn wait_for_value(&self, point: &str, value: &str) {
        let shown = format!("document.querySelector('[data-test=parameter-{point}] [data-test=value]')?.innerText");
        self.browser.wait_for(&format!("{shown} === {value:?}")).await;
    }

    /// The value of a parameter, as the table shows it.
    pub async fn value(&self, point: &str) -> String {
        let script = format!(
            "return document.querySelector('[data-test=parameter-{point}] [data-test=value]')?.innerText ?? ''"
        );
        self.browser.run(&script).await.as_str().unwrap_or_default().to_owned()
    }

    /// The points of the table, from the top.
    pub async fn points(&self) -> Vec<String> {
        self.all("[data-test^=parameter-]", "dataset.test.slice('parameter-'.length)").await
    }

    /// Chooses the wanted code of a parameter.
    pub async fn choose(&self, point: &str, code: u16) {
        self.browser.choose(&format!("edit-{point}"), &format!("0x{code:04X}")).await;
    }

    /// The codes that can be chosen for a parameter.
    pub async fn choices(&self, point: &str) -> Vec<String> {
        self.all(&format!("[data-test=edit-{point}] option"), "value").await
    }

    /// Chooses a file of parameters with the browser's dialog, as far as a page can know.
    pub async fn bring_file(&self, name: &str, text: &str) {
        let text = serde_json::Value::from(text);
        let script = format!(
            "const dataTransfer = new DataTransfer();
             dataTransfer.items.add(new File([{text}], {name:?}));
             const chooser = document.querySelector('[data-test=configure-file]');
             chooser.files = dataTransfer.files;
             chooser.dispatchEvent(new Event('change', {{ bubbles: true }}));"
        );
        self.browser.wait_for("document.querySelector('[data-test=configure-file]')").await;
        self.browser.run(&script).await;
    }

    /// Types the wanted value of a parameter.
    pub async fn type_value(&self, point: &str, text: &str) {
        // As one stroke: a field that is emptied and left takes its value back.
        let script = format!(
            "const field = document.querySelector('[data-test=edit-{point}]');
             field.focus();
             field.value = {text:?};
             field.dispatchEvent(new Event('input', {{ bubbles: true }}));
             field.dispatchEvent(new Event('change', {{ bubbles: true }}));"
        );
        self.browser.wait_for(&format!("document.querySelector('[data-test=edit-{point}]')")).await;
        self.browser.run(&script).await;
    }

    /// The editors that are behind something else after the focus has come to them from the edge of the window, by their
    /// points.
    pub async fn hidden_by_focus(&self) -> Vec<String> {
        let script = "return [...document.querySelectorAll('[data-test^=edit-]')].filter((editor) => {
               document.activeElement?.blur();
               scrollBy(0, editor.getBoundingClientRect().bottom - innerHeight);
               editor.focus();
               const place = editor.getBoundingClientRect();
               const seen = document.elementFromPoint(place.x + place.width / 2, place.bottom - 4);
               return seen !== editor;
             }).map((editor) => editor.dataset.test.slice('edit-'.length))";
        let found = self.browser.run(script).await;
        let found = found.as_array().cloned().unwrap_or_default();
        found.iter().filter_map(|text| Some(text.as_str()?.to_owned())).collect()
    }

    /// Takes back what is typed for a parameter, with the button that the Tab key has come to.
    pub async fn revert(&self, point: &str) {
        let button = format!("document.querySelector('[data-test=revert-{point}]')");
        self.browser.wait_for(&button).await;
        self.browser.run(&format!("{button}.focus()")).await;
        self.browser.click(&format!("revert-{point}")).await;
    }

    /// Brings a value into a parameter's list that does not offer it, and chooses it: as whoever tampers with the page would.
    pub async fn forge(&self, point: &str, value: &str) {
        let script = format!(
            "const list = document.querySelector('[data-test=edit-{point}]');
             list.add(new Option('forged', {value:?}));
             list.value = {value:?};
             list.dispatchEvent(new Event('change', {{ bubbles: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// What stands in a parameter's editor.
    pub async fn typed(&self, point: &str) -> String {
        let script = format!("return document.querySelector('[data-test=edit-{point}]').value");
        self.browser.run(&script).await.as_str().unwrap_or_default().to_owned()
    }

    /// Waits until what is typed for a parameter is refused, and returns in what words.
    pub async fn refusal(&self, point: &str) -> String {
        let note = format!("document.querySelector('[data-test=note-{point}][data-kind=wrong]')?.innerText");
        self.browser.wait_for(&note).await.as_str().unwrap_or_default().to_owned()
    }

    /// Waits until the bar below the table says this.
    pub async fn wait_for_staged(&self, words: &str) {
        let text = "document.querySelector('[data-test=staged-count]')?.innerText";
        self.browser.wait_for(&format!("{text}?.includes({words:?})")).await;
    }

    /// Opens the review of what is staged.
    pub async fn review(&self) {
        self.browser.click("review").await;
        self.browser.wait_for("document.querySelector('[data-test=review-card]')").await;
    }

    /// The points of the steps under review, in their order.
    pub async fn planned(&self) -> Vec<String> {
        self.all("[data-test=review-step]", "dataset.point").await
    }

    /// The requests of the steps under review, as the page writes them.
    pub async fn requests(&self) -> Vec<String> {
        self.all("[data-test=step-request]", "innerText").await
    }

    /// Begins a command: its review is open then.
    pub async fn command(&self, point: &str, code: u16) {
        self.browser.click(&format!("command-{point}-{code}")).await;
        self.browser.wait_for("document.querySelector('[data-test=review-card]')").await;
    }

    /// Confirms every danger of the plan under review, and returns them in the page's words.
    pub async fn confirm_all(&self) -> Vec<String> {
        let count = self.browser.run("return document.querySelectorAll('[data-test=hazard]').length").await;
        for number in 0..usize::try_from(count.as_u64().unwrap_or_default()).unwrap_or_default() {
            self.browser.click_nth("hazard", number).await;
        }
        self.all("[data-test=hazard-text]", "innerText").await
    }

    /// Whether what is under review can be written.
    pub async fn can_write(&self) -> bool {
        self.browser.run("return !document.querySelector('[data-test=write]').disabled").await == true
    }

    /// Writes what is under review.
    pub async fn write(&self) {
        self.browser.click("write").await;
    }

    /// Reviews what is staged, confirms all dangers, writes.
    pub async fn write_all(&self) {
        self.review().await;
        self.confirm_all().await;
        self.write().await;
    }

    /// Types a parameter's value, writes it with all dangers confirmed, and waits until the page shows it as `shown`.
    pub async fn write_value(&self, point: &str, text: &str, shown: &str) {
        self.type_value(point, text).await;
        self.write_all().await;
        self.wait_for_ending("done").await;
        self.browser.click("report-close").await;
        self.wait_until_read().await;
        self.wait_for_value(point, shown).await;
    }

    /// Gives a command with all dangers confirmed, waits until it is done, and returns its request as the page writes it.
    pub async fn carry_out(&self, point: &str, code: u16) -> String {
        self.command(point, code).await;
        let requests = self.requests().await;
        self.confirm_all().await;
        self.write().await;
        self.wait_for_ending("done").await;
        self.browser.click("report-close").await;
        self.wait_until_read().await;
        requests.join("; ")
    }

    /// Waits until a report is there that has ended so: `done`, `found`, `occupied`, `rolled-back`, `lost`...
    pub async fn wait_for_ending(&self, ending: &str) -> String {
        let card = "document.querySelector('[data-test=report-card]')";
        let found = self.browser.wait_for(&format!("{card}?.dataset.ending")).await;
        let text = self.browser.text("report-card").await;
        assert_eq!(found.as_str(), Some(ending), "{text}");
        text
    }

    /// How the steps of the report stand, as `point: outcome`.
    pub async fn outcomes(&self) -> Vec<String> {
        let points = self.all("[data-test=report-step]", "dataset.point").await;
        let outcomes = self.all("[data-test=report-step]", "dataset.outcome").await;
        points.into_iter().zip(outcomes).map(|(point, outcome)| format!("{point}: {outcome}")).collect()
    }

    /// Waits until a journal is offered, and returns all its text.
    pub async fn wait_for_journal(&self) -> String {
        let text = self.browser.wait_for("document.querySelector('[data-test=journal]')?.innerText").await;
        text.as_str().unwrap_or_default().to_owned()
    }

    /// Waits until none is offered.
    pub async fn wait_for_no_journal(&self) {
        self.browser.wait_for("!document.querySelector('[data-test=journal]')").await;
    }

    /// Waits until the top bar says that answers come, at these settings.
    pub async fn wait_for_reading_at(&self, settings: &str) {
        self.browser
            .wait_for(&format!(
                "document.querySelector('[data-test=state][data-state=reading]') && \
                 document.querySelector('.line-text').innerText === {settings:?}"
            ))
            .await;
    }

    async fn all(&self, selector: &str, property: &str) -> Vec<String> {
        let script = format!("return [...document.querySelectorAll({selector:?})].map((found) => found.{property})");
        let found = self.browser.run(&script).await;
        let found = found.as_array().cloned().unwrap_or_default();
        found.iter().filter_map(|text| Some(text.as_str()?.to_owned())).collect()
    }
}
