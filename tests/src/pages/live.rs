//! The Live page.

use buslens_codec::line::Parity;

use crate::testbed::Browser;

/// What the top bar says of link and device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Not connected.
    Closed,
    /// Answers come.
    Reading,
    /// Answers fail to come.
    Failing,
    /// The adapter is gone.
    Lost,
    /// The port could not be opened.
    Failed,
}

impl State {
    fn name(self) -> &'static str {
        match self {
            Self::Closed => "closed",
            Self::Reading => "reading",
            Self::Failing => "failing",
            Self::Lost => "lost",
            Self::Failed => "failed",
        }
    }
}

/// Texts of the two figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figures {
    /// With unit.
    pub displacement: String,
    /// With unit.
    pub temperature: String,
}

/// The Live page in a browser.
#[derive(Clone, Copy)]
pub struct LivePage<'a> {
    /// Where it is open.
    pub browser: &'a Browser,
}

impl<'a> LivePage<'a> {
    /// The page, once it is drawn.
    pub async fn open(browser: &'a Browser) -> Self {
        browser.wait_for("document.querySelector('[data-test=page-live]')").await;
        Self { browser }
    }

    /// Chooses the settings of the line.
    pub async fn set_line(&self, baud: u32, parity: Parity) {
        self.browser.choose("baud", &baud.to_string()).await;
        let parity = match parity {
            Parity::None => "none",
            Parity::Odd => "odd",
            Parity::Even => "even",
        };
        self.browser.choose("parity", parity).await;
    }

    /// Chooses the device by its profile's id.
    pub async fn choose_device(&self, id: &str) {
        self.browser.choose("profile", id).await;
    }

    /// Types the unit id.
    pub async fn set_unit(&self, unit: u8) {
        self.browser.fill("unit", &unit.to_string()).await;
    }

    /// Types the wanted time between two readings, in milliseconds.
    pub async fn set_period(&self, period_ms: u32) {
        self.browser.fill("period", &period_ms.to_string()).await;
    }

    /// Connects to the adapter, which the browser may use without asking.
    pub async fn connect(&self) {
        self.browser.wait_for("document.querySelector('[data-test=port]')?.value").await;
        self.browser.click("connect").await;
    }

    /// Waits for a state.
    pub async fn wait_for(&self, state: State) {
        let name = state.name();
        self.browser.wait_for(&format!("document.querySelector('[data-test=state][data-state={name}]')")).await;
    }

    /// Waits for a fault to be told, and returns all of its text.
    pub async fn fault(&self, name: &str) -> String {
        let text = format!("document.querySelector('[data-test=fault][data-fault=\"{name}\"]')?.innerText");
        self.browser.wait_for(&text).await.as_str().unwrap_or_default().to_owned()
    }

    /// Whether no fault is told.
    pub async fn is_faultless(&self) -> bool {
        self.browser.run("return !document.querySelector('[data-test=fault]')").await.as_bool().unwrap_or(false)
    }

    /// The figures as they stand.
    pub async fn figures(&self) -> Figures {
        let figure = async |point: &str| {
            let script = format!(
                "const figure = document.querySelector('[data-test=point-{point}]');
                 const part = (name) => figure?.querySelector(`[data-test=${{name}}]`)?.innerText.trim() ?? '';
                 return `${{part('value')}} ${{part('unit')}}`;"
            );
            self.browser.run(&script).await.as_str().unwrap_or_default().to_owned()
        };
        Figures { displacement: figure("displacement").await, temperature: figure("temperature").await }
    }

    /// Waits until a measurement reads `text`, unit included.
    pub async fn wait_for_figure(&self, point: &str, text: &str) {
        let part = |name: &str| {
            format!("document.querySelector('[data-test=point-{point}] [data-test={name}]')?.innerText.trim()")
        };
        self.browser.wait_for(&format!("`${{{}}} ${{{}}}` === {text:?}", part("value"), part("unit"))).await;
    }

    /// Chooses the unit in which a measurement, and all others of its quantity, are shown.
    pub async fn show_in(&self, unit: &str) {
        self.browser.choose("unit-choice", unit).await;
    }

    /// What a converted measurement is said to be converted from; empty where it is shown as it was read.
    pub async fn converted_from(&self) -> String {
        self.browser.text("converted").await
    }

    /// Waits until a measurement is said to be beyond its range, in these words; until it is within for an empty text.
    pub async fn wait_for_beyond(&self, point: &str, text: &str) {
        let figure = format!("document.querySelector('[data-test=point-{point}]')");
        let words = format!("{figure}.querySelector('[data-test=beyond]').innerText.trim()");
        let beyond = !text.is_empty();
        self.browser.wait_for(&format!("{figure}?.dataset.beyond === '{beyond}' && {words} === {text:?}")).await;
    }

    /// Waits until the displacement reads `text`, unit included.
    pub async fn wait_for_displacement(&self, text: &str) {
        let value = "document.querySelector('[data-test=point-displacement] [data-test=value]')?.innerText.trim()";
        let unit = "document.querySelector('[data-test=point-displacement] [data-test=unit]')?.innerText.trim()";
        self.browser.wait_for(&format!("`${{{value}}} ${{{unit}}}` === {text:?}")).await;
    }

    /// A counter of the connection.
    pub async fn count(&self, name: &str) -> u64 {
        let text = self.browser.text(&format!("count-{name}")).await;
        let digits: String = text.chars().filter(char::is_ascii_digit).collect();
        digits.parse().unwrap_or_else(|_| panic!("count-{name} reads {text:?}"))
    }

    /// Waits until a counter has reached `least`.
    pub async fn wait_for_count(&self, name: &str, least: u64) {
        let digits = format!("document.querySelector('[data-test=count-{name}]')?.innerText.replace(/\\D/g, '')");
        self.browser.wait_for(&format!("Number({digits}) >= {least}")).await;
    }

    /// From now on, writes down every displacement that the page shows as current.
    pub async fn watch_displacement(&self) {
        self.browser
            .run(
                "globalThis.displacements = [];
                 const note = () => {
                   const figure = document.querySelector('[data-test=point-displacement]');
                   const text = figure?.querySelector('[data-test=value]')?.innerText.trim();
                   if (text && figure.dataset.stale === 'false' && displacements.at(-1) !== text) displacements.push(text);
                 };
                 new MutationObserver(note)
                   .observe(document.body, { subtree: true, childList: true, characterData: true, attributes: true });
                 note();",
            )
            .await;
    }

    /// What [`Self::watch_displacement`] has written down, in millimetres.
    pub async fn watched_displacements(&self) -> Vec<f64> {
        let texts = self.browser.run("return displacements").await;
        let texts = texts.as_array().cloned().unwrap_or_default();
        let number = |text: &str| text.replace('\u{2212}', "-").parse().unwrap_or_else(|_| panic!("{text:?}"));
        texts.iter().filter_map(|text| text.as_str()).filter(|text| *text != "–" && *text != "—").map(number).collect()
    }
}
