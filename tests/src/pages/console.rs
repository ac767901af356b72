//! The Console page.

use serde_json::Value;

use super::LivePage;
use crate::testbed::{Browser, site};

/// The Console page in a browser.
#[derive(Clone, Copy)]
pub struct ConsolePage<'a> {
    /// Where it is open.
    pub browser: &'a Browser,
}

impl<'a> ConsolePage<'a> {
    /// Goes to the page and waits until it is drawn.
    pub async fn open(browser: &'a Browser) -> Self {
        Self::open_at(browser, &site()).await
    }

    /// The same for a site at an address. A connection outlives it: only the part behind `#` changes.
    pub async fn open_at(browser: &'a Browser, site: &str) -> Self {
        browser.open(&format!("{site}/#/console")).await;
        let page = Self { browser };
        page.wait().await;
        page
    }

    /// Waits until the page is drawn.
    pub async fn wait(&self) {
        self.browser.wait_for("document.querySelector('[data-test=page-console]')").await;
    }

    /// Waits until the line is `open`, `simulated`, `replay` or `closed`.
    pub async fn wait_for_line(&self, state: &str) {
        self.browser.wait_for(&format!("document.querySelector('[data-test=line-state][data-state={state}]')")).await;
    }

    /// Connects by the card above the page, only to listen.
    pub async fn connect_listening(&self) {
        self.browser.fill("period", "0").await;
        self.browser.wait_for("document.querySelector('[data-test=port]')?.value").await;
        self.browser.click("connect").await;
    }

    /// Types a line and sends it.
    pub async fn send(&self, line: &str) {
        self.type_line(line).await;
        self.browser.click("send").await;
    }

    /// Types a line, without sending it.
    pub async fn type_line(&self, line: &str) {
        self.browser.fill("send-line", line).await;
    }

    /// What stands in the send line.
    pub async fn line(&self) -> String {
        let text = self.browser.run("return document.querySelector('[data-test=send-line]').value").await;
        text.as_str().unwrap_or_default().to_owned()
    }

    /// Writes lines as `hex` or `text`.
    pub async fn write_as(&self, writing: &str) {
        self.browser.click(&format!("send-as-{writing}")).await;
    }

    /// Chooses the framing: `rtu`, `ascii` or `typed`.
    pub async fn set_framing(&self, framing: &str) {
        self.browser.choose("framing-select", framing).await;
    }

    /// Chooses the check: `crc`, `lrc`, `none` or `wrong`.
    pub async fn set_check(&self, check: &str) {
        self.browser.choose("check-select", check).await;
    }

    /// The bytes that the preview says will go out, as it writes them.
    pub async fn preview(&self) -> String {
        self.browser.text("send-bytes").await
    }

    /// Waits until the line is refused; at which character, counted from 1, and in what words.
    pub async fn fault(&self) -> (u64, String) {
        let fault = "document.querySelector('[data-test=send-fault]')";
        let column = self.browser.wait_for(&format!("{fault}?.dataset.column")).await;
        let column = column.as_str().and_then(|column| column.parse().ok()).unwrap_or_default();
        (column, self.browser.text("send-fault").await)
    }

    /// Waits until the last sending has ended so: `answered`, `broadcast`, `heard`, `silence`, `damaged`, `doubtful`,
    /// `read-only`, `no-port` or `withdrawn`; and returns what the page says of it.
    pub async fn result(&self, end: &str) -> String {
        self.browser.wait_for(&format!("document.querySelector('[data-test=send-result][data-end={end}]')")).await;
        self.browser.text("send-result").await
    }

    /// Sends again and again: every so many milliseconds, so many times.
    pub async fn repeat(&self, every_ms: u32, times: u32) {
        if self.browser.run("return document.querySelector('[data-test=repeat-every]') === null").await == true {
            self.browser.click("repeat").await;
        }
        self.browser.fill("repeat-every", &every_ms.to_string()).await;
        self.browser.fill("repeat-times", &times.to_string()).await;
    }

    /// The texts of the rows that are in sight, from the top.
    pub async fn rows(&self) -> Vec<String> {
        let script = "return [...document.querySelectorAll('[data-test=console-row]')]
            .sort((a, b) => a.dataset.row - b.dataset.row)
            .map((row) => row.innerText)";
        let texts = self.browser.run(script).await;
        let texts = texts.as_array().cloned().unwrap_or_default();
        let plain = |text: &str| text.replace(['\u{a0}', '\n'], " ");
        texts.iter().filter_map(|text| Some(plain(text.as_str()?))).collect()
    }

    /// The text of one cell of each row that is in sight, from the top: `number`, `time`, `direction`, `origin`, `unit`,
    /// `function`, `meaning`, `check`, `gap`, `trip` or `bytes`.
    pub async fn cells(&self, cell: &str) -> Vec<String> {
        let script = format!(
            "return [...document.querySelectorAll('[data-test=console-row]')]
               .sort((a, b) => a.dataset.row - b.dataset.row)
               .map((row) => row.querySelector('.cell-{cell}')?.textContent ?? '')"
        );
        let texts = self.browser.run(&script).await;
        let texts = texts.as_array().cloned().unwrap_or_default();
        texts.iter().filter_map(|text| Some(text.as_str()?.to_owned())).collect()
    }

    /// Waits for a row in sight with these bytes, as digits with spaces, that goes `TX` or `RX`; returns its text.
    pub async fn wait_for_row(&self, direction: &str, bytes: &str) -> String {
        let row = format!(
            "[...document.querySelectorAll('[data-test=console-row]')].find((row) =>
               row.querySelector('.cell-bytes').textContent === {bytes:?} &&
               row.querySelector('.cell-direction').textContent === {direction:?})?.innerText"
        );
        let text = self.browser.wait_for(&row).await;
        text.as_str().unwrap_or_default().replace(['\u{a0}', '\n'], " ")
    }

    /// How many entries the log has, or `shown of all`.
    pub async fn count(&self) -> String {
        self.browser.text("frame-count").await.replace('\u{202f}', "")
    }

    /// Waits until the count beside the log's title is this.
    pub async fn wait_for_count(&self, count: &str) {
        let text = "document.querySelector('[data-test=frame-count]')?.innerText.replace(/\\u202f/g, '')";
        self.browser.wait_for(&format!("{text} === {count:?}")).await;
    }

    /// Waits until the log has so many entries, or more.
    pub async fn wait_for_count_at_least(&self, count: u32) {
        let text = "document.querySelector('[data-test=frame-count]')?.innerText.replace(/\\u202f/g, '')";
        self.browser.wait_for(&format!("parseInt({text} ?? '0') >= {count}")).await;
    }

    /// Types into a field of the filter: `unit`, `function` or `text`.
    pub async fn filter(&self, field: &str, text: &str) {
        self.browser.fill(&format!("filter-{field}"), text).await;
    }

    /// Shows one direction: `tx`, `rx`, or with an empty text both.
    pub async fn filter_direction(&self, direction: &str) {
        self.browser.choose("filter-direction", direction).await;
    }

    /// Shows errors only, or everything again.
    pub async fn toggle_errors(&self) {
        self.browser.click("filter-errors").await;
    }

    /// Shows everything.
    pub async fn clear_filter(&self) {
        self.browser.click("clear-filter").await;
    }

    /// Holds the list still, or lets it go on.
    pub async fn toggle_pause(&self) {
        self.browser.click("pause").await;
    }

    /// How many entries are kept.
    pub async fn set_ring(&self, entries: u32) {
        self.browser.choose("ring-size", &entries.to_string()).await;
    }

    /// Empties the log; the page asks once.
    pub async fn clear(&self) {
        self.browser.click("clear").await;
        self.browser.click("clear-confirm").await;
    }

    /// Chooses one of the rows in sight, counted from 0 from the top, once it is there.
    pub async fn choose_row(&self, number: usize) {
        let row = format!(
            "[...document.querySelectorAll('[data-test=console-row]')]
               .sort((a, b) => a.dataset.row - b.dataset.row)[{number}]"
        );
        self.browser.wait_for(&row).await;
        self.browser.run(&format!("{row}.click()")).await;
    }

    /// Marks the chosen row, or takes its mark away.
    pub async fn toggle_mark(&self) {
        self.browser.click("mark").await;
    }

    /// Writes a comment on the chosen row.
    pub async fn comment(&self, words: &str) {
        self.browser.click("comment").await;
        self.browser.fill("mark-comment", words).await;
        self.browser.click("comment-save").await;
    }

    /// Changes a field of the line's settings: `baud`, `data-bits`, `parity`, `stop-bits`, `mode` or `buffer`.
    pub async fn set_line(&self, field: &str, value: &str) {
        self.browser.choose(&format!("line-{field}"), value).await;
    }

    /// Puts the settings in force.
    pub async fn apply_line(&self) {
        self.browser.click("line-apply").await;
        self.browser.wait_for("!document.querySelector('[data-test=line-apply]')").await;
    }

    /// Switches `polling` or `read-only`, and waits until the engine has done it.
    pub async fn switch(&self, switch: &str, on: bool) {
        let is_on = format!("document.querySelector('[data-test=line-{switch}]').ariaChecked === '{on}'");
        if self.browser.run(&format!("return {is_on}")).await != true {
            self.browser.click(&format!("line-{switch}")).await;
        }
        self.browser.wait_for(&is_on).await;
    }

    /// Opens a pane beside the log: `frame`, `counts`, `snippets` or `sequence`.
    pub async fn open_pane(&self, pane: &str) {
        self.browser.click(&format!("pane-{pane}")).await;
    }

    /// From now on, keeps what the page gives the user to save, as text in which each character is a byte.
    pub async fn catch_files(&self) {
        self.browser
            .run(
                "globalThis.saved = [];
                 const make = URL.createObjectURL;
                 URL.createObjectURL = (file) => {
                   file.arrayBuffer().then((bytes) => {
                     let text = '';
                     for (const byte of new Uint8Array(bytes)) text += String.fromCharCode(byte);
                     saved.push(text);
                   });
                   return make(file);
                 };",
            )
            .await;
    }

    /// Saves the log as `text`, `jsonl`, `csv`, `pcap` or `session` and returns the file. Call [`Self::catch_files`] first.
    pub async fn export(&self, format: &str) -> Vec<u8> {
        self.browser.click("export").await;
        self.browser.click(&format!("export-{format}")).await;
        self.saved().await
    }

    /// The only file that was saved.
    pub async fn saved(&self) -> Vec<u8> {
        let text = self.browser.wait_for("saved.length === 1 && saved[0]").await;
        self.browser.run("saved.length = 0").await;
        let byte = |character: char| u8::try_from(u32::from(character)).expect("a byte");
        text.as_str().unwrap_or_default().chars().map(byte).collect()
    }

    /// Drops a file with this text onto the page.
    pub async fn drop_file(&self, name: &str, text: &str) {
        let text = Value::from(text);
        let script = format!(
            "const dataTransfer = new DataTransfer();
             dataTransfer.items.add(new File([{text}], {name:?}));
             document.querySelector('[data-test=page-console]')
               .dispatchEvent(new DragEvent('drop', {{ dataTransfer, bubbles: true, cancelable: true }}));"
        );
        self.browser.run(&script).await;
    }

    /// Plays what is in the list at 100, 500, 1000, 2000 or 10000 thousandths of its own speed; 0 as fast
    /// as it goes.
    pub async fn replay(&self, speed_permille: u32) {
        self.browser.click("replay").await;
        self.browser.click(&format!("replay-{speed_permille}")).await;
    }

    /// Waits until the replay has ended.
    pub async fn wait_for_replay_end(&self) {
        self.browser
            .wait_for(
                "document.querySelector('[data-test=log-banner]') && \
                 !document.querySelector('[data-test=replay-progress]')",
            )
            .await;
    }

    /// Back to the log of the line.
    pub async fn go_live(&self) {
        self.browser.click("back-to-live").await;
    }

    /// Waits until the list has taken in so many entries, however long it takes as long as more come.
    pub async fn wait_for_all(&self, count: u32) {
        let mut least = 0;
        while least < count {
            least = (least + 20_000).min(count);
            self.wait_for_count_at_least(least).await;
        }
        self.wait_for_count(&count.to_string()).await;
    }

    /// Waits until the list is held still with so many entries behind it.
    pub async fn wait_for_held(&self, count: u32) {
        let text = "document.querySelector('[data-test=pause]').innerText.replace(/\\D/g, '')";
        self.browser.wait_for(&format!("{text} === '{count}'")).await;
    }

    /// Waits until the entry in the last row is the one with this number, counted from 1.
    pub async fn wait_for_number(&self, number: u32) {
        let cells = "[...document.querySelectorAll('[data-test=console-row] .cell-number')]";
        let text = format!("{cells}.some((cell) => cell.textContent.replace(/\\D/g, '') === '{number}')");
        self.browser.wait_for(&text).await;
    }

    /// Waits until what was sent last has ended, in whatever way.
    pub async fn wait_for_ended(&self) {
        self.browser.wait_for("document.querySelector('[data-test=send-result]')?.dataset.end").await;
    }

    /// Waits until what is repeated was sent so many times.
    pub async fn wait_for_repetitions(&self, times: u32) {
        let told = "document.querySelector('[data-test=send-result]')?.dataset.times";
        self.browser.wait_for(&format!("Number({told}) >= {times}")).await;
    }

    /// Waits until nothing has come into the list for half a second.
    pub async fn wait_for_quiet(&self) {
        let count = "document.querySelector('[data-test=frame-count]')?.innerText";
        let quiet = format!(
            "let last, since = performance.now();
             const look = setInterval(() => {{
               const now = {count};
               if (now !== last) {{ last = now; since = performance.now(); }}
               else if (performance.now() - since > 500) {{ clearInterval(look); done(true); }}
             }}, 25);"
        );
        self.browser.run_async(&quiet).await;
    }

    /// Waits until this element has the focus.
    pub async fn wait_for_focus(&self, name: &str) {
        self.browser.wait_for(&format!("document.activeElement?.dataset.test === {name:?}")).await;
    }

    /// Types, wherever the focus is.
    pub async fn type_keys(&self, text: &str) {
        for character in text.chars() {
            self.press(&[character.to_string().as_str()]).await;
        }
    }

    /// Presses a key in a field.
    pub async fn press_in(&self, field: &str, key: &str) {
        self.browser.run(&format!("document.querySelector('[data-test={field}]').focus()")).await;
        self.press(&[key]).await;
    }

    /// Goes to the Live page by the rail, as a user does.
    pub async fn go_to_live(&self) -> LivePage<'a> {
        self.browser.run("location.hash = '#/live'").await;
        LivePage::open(self.browser).await
    }

    /// Presses keys wherever the focus is, one after the other, as `Enter` or `a`.
    pub async fn press(&self, keys: &[&str]) {
        for key in keys {
            let text = match *key {
                "Enter" => "\r",
                key if key.chars().count() == 1 => key,
                _ => "",
            };
            let code = key_code(key);
            for kind in ["keyDown", "keyUp"] {
                let mut event =
                    serde_json::json!({ "type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code });
                if kind == "keyDown" && !text.is_empty() {
                    event["text"] = text.into();
                }
                self.browser.devtools("Input.dispatchKeyEvent", event).await;
            }
        }
    }

    /// Goes from element to element with the tab key until this one has the focus.
    pub async fn tab_to(&self, name: &str) {
        let has_focus = format!("return document.activeElement?.dataset.test === {name:?}");
        for _ in 0..100 {
            if self.browser.run(&has_focus).await == true {
                return;
            }
            self.press(&["Tab"]).await;
        }
        panic!("{name} is not reached by the tab key");
    }
}

/// What the browser wants to know of keys that type nothing.
fn key_code(key: &str) -> u32 {
    match key {
        "Backspace" => 8,
        "Tab" => 9,
        "Enter" => 13,
        "Escape" => 27,
        "End" => 35,
        "Home" => 36,
        "ArrowUp" => 38,
        "ArrowDown" => 40,
        "F6" => 117,
        _ => 0,
    }
}
