//! A headless Chromium with a profile of its own.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

use fantoccini::wd::{Capabilities, WebDriverCompatibleCommand};
use fantoccini::{Client, ClientBuilder, Locator};
use serde_json::{Value, json};

use super::adapter::Adapter;

/// How long the page may take for anything that a test waits for. Long, because a busy machine is no failure.
const PATIENCE: Duration = Duration::from_secs(30);

/// How the page is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Language of the browser: `en` or `zh-CN`.
    pub language: &'static str,
    /// The system's colour scheme.
    pub dark: bool,
    /// Width of the window in CSS pixels.
    pub width: u32,
    /// Height of the window in CSS pixels.
    pub height: u32,
}

impl Default for Look {
    fn default() -> Self {
        Self { language: "en", dark: false, width: 1440, height: 900 }
    }
}

/// A browser session; the browser ends with its adapter.
pub struct Browser {
    client: Client,
    profile: tempfile::TempDir,
}

impl Browser {
    /// Starts the browser in the adapter's world.
    pub async fn start(adapter: &Adapter, look: Look) -> Self {
        let profile = tempfile::tempdir().expect("a folder for temporary files");
        let arguments = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            // The browser would fork itself for a network process, and umockdev's library may hold a lock just then, which
            // the child never gets: it would hang before it has begun.
            "--enable-features=NetworkServiceInProcess2",
            "--hide-scrollbars",
            "--force-color-profile=srgb",
            // A name that is this machine and yet no secure place.
            "--host-resolver-rules=MAP insecure.test 127.0.0.1",
            &format!("--user-data-dir={}", profile.path().display()),
            &format!("--accept-lang={}", look.language),
            &format!("--window-size={},{}", look.width.max(500), look.height),
        ];
        let capabilities = json!({
            "goog:chromeOptions": { "args": arguments },
            "goog:loggingPrefs": { "browser": "ALL" },
            "timeouts": { "script": 120_000 },
        });
        let Value::Object(capabilities) = capabilities else { unreachable!("an object was written") };
        let capabilities: Capabilities = capabilities;
        let driver = format!("http://localhost:{}", adapter.driver_port());
        let client = ClientBuilder::new(hyper_connector()).capabilities(capabilities).connect(&driver).await;
        let browser = Self { client: client.expect("Chromium starts (package chromium)"), profile };
        browser.look(look).await;
        browser
    }

    /// The folder with all that the browser keeps.
    pub(super) fn profile(&self) -> &Path {
        self.profile.path()
    }

    /// Changes width and colour scheme. The language stays that of the start.
    pub async fn look(&self, look: Look) {
        let scheme = if look.dark { "dark" } else { "light" };
        let media = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.devtools("Emulation.setEmulatedMedia", media).await;
        let metrics =
            json!({ "width": look.width, "height": look.height, "deviceScaleFactor": 1, "mobile": look.width < 600 });
        self.devtools("Emulation.setDeviceMetricsOverride", metrics).await;
    }

    /// Opens an address.
    pub async fn open(&self, address: &str) {
        self.client.goto(address).await.expect("the page loads");
    }

    /// Loads the page again.
    pub async fn reload(&self) {
        self.client.refresh().await.expect("the page loads");
    }

    /// Runs a script in the page and returns what it returns.
    pub async fn run(&self, script: &str) -> Value {
        self.client.execute(script, vec![]).await.unwrap_or_else(|error| panic!("{script}\n{error}"))
    }

    /// Runs a script that calls `done(result)` when it is done.
    pub async fn run_async(&self, script: &str) -> Value {
        let script = format!("const done = arguments[arguments.length - 1]; {script}");
        self.client.execute_async(&script, vec![]).await.unwrap_or_else(|error| panic!("{script}\n{error}"))
    }

    /// Opens an address in another tab, does something there, and comes back to this one.
    pub async fn in_another_tab(&self, address: &str, act: impl AsyncFnOnce()) {
        let here = self.client.window().await.expect("the tab has a name");
        let other = self.client.new_window(true).await.expect("a new tab opens");
        self.client.switch_to_window(other.handle).await.expect("the new tab is there");
        self.open(address).await;
        act().await;
        self.client.close_window().await.expect("the tab closes");
        self.client.switch_to_window(here).await.expect("the first tab is still there");
    }

    /// Waits until an expression becomes true, looking whenever the page has changed or drawn.
    pub async fn wait_for(&self, expression: &str) -> Value {
        let mut script = String::new();
        let limit = PATIENCE.as_millis();
        write!(
            script,
            "const look = () => {{ try {{ return ({expression}); }} catch {{ return null; }} }};
             const end = (value) => {{ clearTimeout(timer); clearInterval(beat); watch.disconnect(); done(value); }};
             const check = () => {{ const value = look(); if (value) end({{ value }}); }};
             const timer = setTimeout(() => end({{ text: document.body.innerText }}), {limit});
             const beat = setInterval(check, 25);
             const watch = new MutationObserver(check);
             watch.observe(document, {{ subtree: true, childList: true, attributes: true, characterData: true }});
             check();"
        )
        .expect("a string takes text");
        let result = self.run_async(&script).await;
        match result.get("text") {
            None => result["value"].clone(),
            Some(text) => {
                panic!("`{expression}` did not become true; the page shows:\n{}", text.as_str().unwrap_or(""))
            }
        }
    }

    /// Clicks the element with this `data-test` name.
    pub async fn click(&self, name: &str) {
        self.click_nth(name, 0).await;
    }

    /// Clicks one of several elements with this `data-test` name, counted from 0.
    pub async fn click_nth(&self, name: &str, number: usize) {
        let wanted = format!("document.querySelectorAll({:?})[{number}]", selector(name));
        self.wait_for(&format!("{wanted} && !{wanted}.disabled")).await;
        let found = self.client.find_all(Locator::Css(&selector(name))).await;
        let found = found.unwrap_or_else(|error| panic!("{name}: {error}"));
        found[number].click().await.unwrap_or_else(|error| panic!("{name} {number}: {error}"));
    }

    /// Replaces the text of a field, as typing does.
    pub async fn fill(&self, name: &str, text: &str) {
        self.wait_for(&element(name)).await;
        let found = self.client.find(Locator::Css(&selector(name))).await;
        let found = found.unwrap_or_else(|error| panic!("{name}: {error}"));
        found.clear().await.unwrap_or_else(|error| panic!("{name}: {error}"));
        found.send_keys(text).await.unwrap_or_else(|error| panic!("{name}: {error}"));
    }

    /// Chooses the option of a list by its value.
    pub async fn choose(&self, name: &str, value: &str) {
        let option = format!("{}[value={value:?}]", selector(name) + " option");
        self.wait_for(&format!("document.querySelector({option:?})")).await;
        let found = self.client.find(Locator::Css(&selector(name))).await;
        let found = found.unwrap_or_else(|error| panic!("{name}: {error}"));
        found.select_by_value(value).await.unwrap_or_else(|error| panic!("{name}={value}: {error}"));
    }

    /// The text of an element, or an empty one where it is not there.
    pub async fn text(&self, name: &str) -> String {
        let text = self.run(&format!("return {}?.innerText ?? ''", element(name))).await;
        text.as_str().unwrap_or_default().trim().to_owned()
    }

    /// What the browser has complained about since the last call: errors and violations of the page's policy.
    pub async fn complaints(&self) -> Vec<String> {
        let log = self.command("se/log", json!({ "type": "browser" })).await;
        let entries = log.as_array().cloned().unwrap_or_default();
        let severe = entries.iter().filter(|entry| entry["level"] == "SEVERE");
        severe.map(|entry| entry["message"].as_str().unwrap_or_default().to_owned()).collect()
    }

    /// Makes the page's worker throw an error that nothing catches, the next time that it asks for the time.
    pub async fn break_the_worker(&self) {
        let targets = self.devtools("Target.getTargets", json!({})).await;
        let targets = targets["targetInfos"].as_array().cloned().unwrap_or_default();
        let worker = targets.iter().find(|target| target["type"] == "worker").expect("the page has a worker");
        let attach = json!({ "targetId": worker["targetId"], "flatten": false });
        let session = self.devtools("Target.attachToTarget", attach).await;
        let script = "performance.now = () => { throw new Error('broken by a test'); }";
        let message = json!({ "id": 1, "method": "Runtime.evaluate", "params": { "expression": script } });
        let send = json!({ "sessionId": session["sessionId"], "message": message.to_string() });
        self.devtools("Target.sendMessageToTarget", send).await;
    }

    /// Cuts the page off from the network, or joins it again.
    pub async fn set_offline(&self, offline: bool) {
        self.devtools("Network.enable", json!({})).await;
        let conditions = json!({ "offline": offline, "latency": 0, "downloadThroughput": -1, "uploadThroughput": -1 });
        self.devtools("Network.emulateNetworkConditions", conditions).await;
    }

    /// A picture of the whole page as PNG, also of what is below the window's edge.
    pub async fn picture(&self) -> Vec<u8> {
        let size = "return [innerWidth, innerHeight, document.documentElement.scrollHeight]";
        let size = self.run(size).await;
        let pixels = |at: usize| size[at].as_u64().expect("a size in pixels");
        let (width, height) = (pixels(0), pixels(1).max(pixels(2)));
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600 });
        self.devtools("Emulation.setDeviceMetricsOverride", metrics).await;
        // Transitions have run to their end, and the page has drawn what follows from its new size.
        let settled = "document.getAnimations().forEach((animation) => { try { animation.finish(); } catch {} });
                       requestAnimationFrame(() => requestAnimationFrame(() => done(true)));";
        self.run_async(settled).await;
        self.client.screenshot().await.expect("a picture")
    }

    /// Sends a command of the developer tools' protocol.
    pub async fn devtools(&self, command: &str, parameters: Value) -> Value {
        self.command("goog/cdp/execute", json!({ "cmd": command, "params": parameters })).await
    }

    async fn command(&self, path: &'static str, body: Value) -> Value {
        let command = DriverCommand { path, body };
        self.client.issue_cmd(command).await.unwrap_or_else(|error| panic!("{path}: {error}"))
    }
}

/// A script expression for the element with a `data-test` name.
pub(crate) fn element(name: &str) -> String {
    format!("document.querySelector({:?})", selector(name))
}

fn selector(name: &str) -> String {
    format!("[data-test='{name}']")
}

fn hyper_connector() -> hyper_util::client::legacy::connect::HttpConnector {
    hyper_util::client::legacy::connect::HttpConnector::new()
}

/// A command of chromedriver's own.
#[derive(Debug)]
struct DriverCommand {
    path: &'static str,
    body: Value,
}

impl WebDriverCompatibleCommand for DriverCommand {
    fn endpoint(&self, base_url: &url::Url, session_id: Option<&str>) -> Result<url::Url, url::ParseError> {
        base_url.join(&format!("session/{}/{}", session_id.unwrap_or_default(), self.path))
    }

    fn method_and_body(&self, _: &url::Url) -> (http::Method, Option<String>) {
        (http::Method::POST, Some(self.body.to_string()))
    }
}
