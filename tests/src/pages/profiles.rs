//! The Profiles page.

use serde_json::Value;

use crate::testbed::{Browser, site};

/// The Profiles page in a browser.
#[derive(Clone, Copy)]
pub struct ProfilesPage<'a> {
    /// Where it is open.
    pub browser: &'a Browser,
}

impl<'a> ProfilesPage<'a> {
    /// Goes to the page and waits until it is drawn.
    pub async fn open(browser: &'a Browser) -> Self {
        Self::open_at(browser, &site()).await
    }

    /// The same for a site at an address. A connection outlives it: only the part behind `#` changes.
    pub async fn open_at(browser: &'a Browser, site: &str) -> Self {
        browser.open(&format!("{site}/#/profiles")).await;
        let page = Self { browser };
        page.wait().await;
        page
    }

    /// Waits until the page is drawn.
    pub async fn wait(&self) {
        self.browser.wait_for("document.querySelector('[data-test=page-profiles]')").await;
    }

    /// The ids of the user's own profiles, as they are listed.
    pub async fn own(&self) -> Vec<String> {
        let ids = "return [...document.querySelectorAll('[data-test=own-profiles] [data-test=profile-row]')]
                     .map((row) => row.dataset.id)";
        let found = self.browser.run(ids).await;
        found.as_array().into_iter().flatten().filter_map(|id| id.as_str().map(str::to_owned)).collect()
    }

    /// Waits until the user's own profiles are these, by their ids.
    pub async fn wait_for_own(&self, ids: &[&str]) {
        let rows = "[...document.querySelectorAll('[data-test=own-profiles] [data-test=profile-row]')]";
        let wanted = ids.join(" ");
        self.browser.wait_for(&format!("{rows}.map((row) => row.dataset.id).join(' ') === {wanted:?}")).await;
    }

    /// Shows the profile with this id.
    pub async fn choose(&self, id: &str) {
        let row = format!("document.querySelector('[data-test=profile-row][data-id={id:?}]')");
        self.browser.wait_for(&row).await;
        self.browser.run(&format!("{row}.click()")).await;
        self.browser.wait_for(&format!("{row}?.getAttribute('aria-current') === 'true'")).await;
    }

    /// Shows the form.
    pub async fn show_form(&self) {
        self.browser.click("profile-view-form").await;
        self.browser
            .run("document.querySelectorAll('.profile-section').forEach((part) => { part.open = true; })")
            .await;
    }

    /// Shows the text.
    pub async fn show_text(&self) {
        self.browser.click("profile-view-text").await;
        self.browser.wait_for("document.querySelector('[data-test=profile-text]')").await;
    }

    /// Types into the field of the form that stands for a path of the text.
    pub async fn fill(&self, path: &str, text: &str) {
        self.browser.fill(&format!("field-{path}"), text).await;
    }

    /// Chooses a word in the field of the form that stands for a path of the text.
    pub async fn pick(&self, path: &str, word: &str) {
        self.browser.choose(&format!("field-{path}"), word).await;
    }

    /// Ticks or unticks a box of the form.
    pub async fn tick(&self, path: &str, on: bool) {
        let found = format!("document.querySelector('[data-test=\"field-{path}\"]')");
        self.browser.wait_for(&found).await;
        if self.browser.run(&format!("return {found}.checked")).await.as_bool() != Some(on) {
            self.browser.click(&format!("field-{path}")).await;
        }
    }

    /// What a field of the form shows.
    pub async fn field(&self, path: &str) -> String {
        let found = format!("document.querySelector('[data-test=\"field-{path}\"]')");
        self.browser.wait_for(&found).await;
        self.browser.run(&format!("return {found}.value")).await.as_str().unwrap_or_default().to_owned()
    }

    /// The text of the profile that is shown; the text view must be open.
    pub async fn text(&self) -> String {
        let text = self.browser.run("return document.querySelector('[data-test=profile-text]').value").await;
        text.as_str().unwrap_or_default().to_owned()
    }

    /// Replaces the text of the profile that is shown, as pasting into the field does; the text view must be open.
    pub async fn write(&self, text: &str) {
        let text = Value::from(text);
        let script = format!(
            "const field = document.querySelector('[data-test=profile-text]');
             field.value = {text};
             field.dispatchEvent(new Event('input', {{ bubbles: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Waits for the fault to be told, and returns its words.
    pub async fn fault(&self) -> String {
        let text = "document.querySelector('[data-test=profile-fault] > span')?.innerText";
        self.browser.wait_for(text).await.as_str().unwrap_or_default().to_owned()
    }

    /// Waits until no fault is found in what is not saved yet.
    pub async fn wait_until_ready(&self) {
        self.browser.wait_for("document.querySelector('[data-test=profile-ready]')").await;
    }

    /// Saves, and waits until it says so.
    pub async fn save(&self) {
        self.browser.click("profile-save").await;
        self.wait_until_saved().await;
    }

    /// Waits until what is shown is saved.
    pub async fn wait_until_saved(&self) {
        self.browser.wait_for("document.querySelector('[data-test=profile-saved]')").await;
    }

    /// Drops a file onto the page.
    pub async fn drop_file(&self, name: &str, text: &str) {
        let text = Value::from(text);
        let script = format!(
            "const dataTransfer = new DataTransfer();
             dataTransfer.items.add(new File([{text}], {name:?}));
             document.querySelector('[data-test=page-profiles]')
               .dispatchEvent(new DragEvent('drop', {{ dataTransfer, bubbles: true, cancelable: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Chooses a file with the browser's dialog, as far as a page can know.
    pub async fn choose_file(&self, name: &str, text: &str) {
        let text = Value::from(text);
        let script = format!(
            "const dataTransfer = new DataTransfer();
             dataTransfer.items.add(new File([{text}], {name:?}));
             const chooser = document.querySelector('[data-test=profile-file]');
             chooser.files = dataTransfer.files;
             chooser.dispatchEvent(new Event('change', {{ bubbles: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Pastes a text beside all fields.
    pub async fn paste(&self, text: &str) {
        let text = Value::from(text);
        let script = format!(
            "const clipboardData = new DataTransfer();
             clipboardData.setData('text', {text});
             document.body.dispatchEvent(new ClipboardEvent('paste', {{ clipboardData, bubbles: true, cancelable: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Waits for what came of the last action, and returns its words.
    pub async fn told(&self) -> String {
        let text = "document.querySelector('[data-test=profile-told]')?.innerText";
        self.browser.wait_for(text).await.as_str().unwrap_or_default().to_owned()
    }

    /// Saves what is shown as a file: its name and its text.
    pub async fn export(&self) -> (String, String) {
        self.browser
            .run(
                "globalThis.exported = null;
                 const make = URL.createObjectURL;
                 URL.createObjectURL = (file) => {
                   file.text().then((text) => { exported = { ...exported, text }; });
                   return make(file);
                 };
                 document.addEventListener('click', (event) => {
                   if (event.target.download) exported = { ...exported, name: event.target.download };
                 }, { capture: true, once: true });
                 const press = HTMLElement.prototype.click;
                 HTMLElement.prototype.click = function () {
                   if (this.download) exported = { ...exported, name: this.download };
                   return press.call(this);
                 };",
            )
            .await;
        self.browser.click("profile-export").await;
        let found = self.browser.wait_for("exported?.name && exported?.text && exported").await;
        let part = |key: &str| found[key].as_str().unwrap_or_default().to_owned();
        (part("name"), part("text"))
    }

    /// Deletes what is shown, by both steps.
    pub async fn delete(&self) {
        self.browser.click("profile-delete").await;
        self.browser.click("profile-delete-sure").await;
    }
}
