//! Wires the window together: the state that outlives a page, the engine's messages, the shell around the pages.

use std::ops::Deref;
use std::time::Duration;

use crate::reactive::prelude::*;
use wasm_bindgen::JsCast;

use crate::ambient::Ambient;
use crate::components::shell::{rail, top_bar};
use crate::crash;
use crate::device;
use crate::dom::{el, mount, on_window, react};
use crate::history::History;
use crate::link;
use crate::loader::{self, Loading};
use crate::message::{Connection, Health, Line, Link, PortId, Source, Status, ToEngine, ToWindow, ToWorkbench};
use crate::pages::{connect_above, live_page};
use crate::route::{self, Page};
use crate::serial::PickFault;
use crate::settings::{self, Settings};
use crate::storage;
use crate::text::Language;
use crate::theme::{self, Theme};

/// Time between two ticks of the page's clock.
const TICK: Duration = Duration::from_millis(100);
/// Under this name it is remembered, by this word, that only reads are let out.
const READ_ONLY: &str = "read-only";

/// Puts the page into the document.
pub(crate) fn start() {
    crash::watch(crash::show);
    crate::reactive::run_forever(build);
}

/// What every part of the page may look at. Signals only: free of JS handles.
pub(crate) struct App {
    ambient: Ambient,
    /// The page shown.
    pub(crate) page: RwSignal<Page>,
    /// Light or dark.
    pub(crate) theme: RwSignal<Theme>,
    /// The granted ports.
    pub(crate) ports: RwSignal<Vec<PortId>>,
    /// What the engine said last.
    pub(crate) status: RwSignal<Status>,
    /// What the engine was last asked to connect, or what it plays, with the settings in force.
    pub(crate) connection: RwSignal<Option<Connection>>,
    /// Whether the device is polled.
    pub(crate) polling: RwSignal<bool>,
    /// Whether only reads are let out.
    pub(crate) read_only: RwSignal<bool>,
    /// Why the picker brought no port.
    pub(crate) pick_fault: RwSignal<Option<PickFault>>,
    /// The fields of the connection card.
    pub(crate) settings: Settings,
    /// The connections to the simulator at which something was last read, one for each profile: a simulated sensor stays
    /// what it was set to.
    demonstrated: StoredValue<Vec<Connection>>,
    /// What has been read; [`Self::history_turn`] tells of changes.
    pub(crate) history: StoredValue<History>,
    /// How far the second program is.
    pub(crate) workbench: RwSignal<Loading>,
    /// Counts how often the device's help was asked for.
    pub(crate) help: RwSignal<u32>,
    /// Counts the changes of the history.
    pub(crate) history_turn: RwSignal<u32>,
    /// Ticks ten times a second while connected, and whenever the window changes its size.
    pub(crate) clock_turn: RwSignal<u32>,
    /// The engine's clock against the window's, in seconds; known from the first sample on.
    pub(crate) clock_lead_s: StoredValue<Option<f64>>,
    /// Link and device in one word.
    pub(crate) phase: Memo<Phase>,
}

impl Deref for App {
    type Target = Ambient;

    fn deref(&self) -> &Ambient {
        &self.ambient
    }
}

/// Link and device in one word: what the top bar says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Not connected.
    Closed,
    /// The port is being opened.
    Opening,
    /// Open, nothing read yet.
    Waiting,
    /// Answers come.
    Reading,
    /// Answers fail to come.
    Failing,
    /// The adapter has vanished.
    Lost,
    /// The port is being closed.
    Closing,
    /// The port could not be opened.
    Failed,
}

impl Phase {
    /// The phase of a link and the device behind it.
    pub(crate) fn of(link: &Link, health: &Health) -> Self {
        match link {
            Link::Closed => Self::Closed,
            Link::Opening => Self::Opening,
            Link::Lost => Self::Lost,
            Link::Closing => Self::Closing,
            Link::Failed(_) => Self::Failed,
            Link::Open => match health {
                Health::Waiting => Self::Waiting,
                Health::Reading => Self::Reading,
                Health::Failing(_) => Self::Failing,
            },
        }
    }

    /// Its stable name, for tests and styles.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Closed => "closed",
            Self::Opening => "opening",
            Self::Waiting => "waiting",
            Self::Reading => "reading",
            Self::Failing => "failing",
            Self::Lost => "lost",
            Self::Closing => "closing",
            Self::Failed => "failed",
        }
    }

    /// Its name for the user; without polling nothing is waited for.
    pub(crate) fn title(self, language: Language, polling: bool) -> &'static str {
        match self {
            Self::Closed => language.state_closed(),
            Self::Opening => language.state_opening(),
            Self::Waiting if !polling => language.state_listening(),
            Self::Waiting => language.state_waiting(),
            Self::Reading => language.state_reading(),
            Self::Failing => language.state_failing(),
            Self::Lost => language.state_lost(),
            Self::Closing => language.state_closing(),
            Self::Failed => language.state_failed(),
        }
    }

    /// Whether a port is held, wanted or being let go.
    pub(crate) fn is_connected(self) -> bool {
        !matches!(self, Self::Closed | Self::Failed)
    }
}

impl App {
    fn new() -> Self {
        let status = RwSignal::new(Status::default());
        Self {
            ambient: Ambient { language: follow_language() },
            theme: theme::follow(),
            ports: RwSignal::default(),
            status,
            connection: RwSignal::new(None),
            polling: RwSignal::new(true),
            read_only: RwSignal::new(storage::load(READ_ONLY).as_deref() == Some(READ_ONLY)),
            pick_fault: RwSignal::new(None),
            settings: Settings::remembered(),
            demonstrated: StoredValue::default(),
            history: StoredValue::new(History::default()),
            page: route::follow(),
            workbench: RwSignal::new(Loading::Absent),
            help: RwSignal::new(0),
            history_turn: RwSignal::new(0),
            clock_turn: RwSignal::new(0),
            clock_lead_s: StoredValue::new(None),
            phase: Memo::new(move |_| status.with(|status| Phase::of(&status.link, &status.health))),
        }
    }

    /// Link and device in words.
    pub(crate) fn phase_title(&self) -> String {
        self.phase.get().title(self.language.get(), self.polling.get()).to_owned()
    }

    /// Whether a recording is played.
    pub(crate) fn is_replay(&self) -> bool {
        self.connection.with(|used| used.as_ref().is_some_and(|used| used.source == Source::Replay))
    }

    /// Asks the engine to connect and starts a new history.
    pub(crate) fn connect(&self, connection: Connection) {
        self.forget_readings();
        self.pick_fault.set(None);
        self.status.set(Status { link: Link::Opening, ..Status::default() });
        link::send(&ToEngine::Connect(connection.clone()));
        self.connection.set(Some(connection));
    }

    /// Connects the chosen device, simulated: with the settings at which it was last read, else with those of the factory,
    /// whatever the fields say.
    pub(crate) fn demonstrate(&self) {
        let mut connection = settings::demonstration(self.settings.device());
        self.demonstrated.with_value(|all| {
            if let Some(last) = all.iter().find(|last| last.profile == connection.profile) {
                (connection.line, connection.mode, connection.unit) = (last.line, last.mode, last.unit);
            }
        });
        self.connect(connection);
    }

    fn remember_demonstration(&self) {
        let used = self.connection.get_untracked().filter(|used| used.source == Source::Simulator);
        if let Some(used) = used {
            self.demonstrated.update_value(|all| {
                all.retain(|last| last.profile != used.profile);
                all.push(used);
            });
        }
    }

    /// Starts the statistics anew.
    pub(crate) fn reset_statistics(&self) {
        self.history.update_value(History::reset_statistics);
        self.history_turn.update(|turn| *turn = turn.wrapping_add(1));
    }

    /// Seconds on the engine's clock, as well as the window knows.
    pub(crate) fn engine_seconds(&self) -> Option<f64> {
        self.clock_lead_s.get_value().map(|lead| lead + window_seconds())
    }

    fn hear(&self, message: ToWindow) {
        match message {
            ToWindow::Ports(ports) => self.ports.set(ports),
            ToWindow::Status(status) => {
                if let Some(newest) = status.samples.last() {
                    // A message only ever takes longer than the fastest one, so the largest lead is the truest.
                    // A recording has a clock and a pace of its own.
                    let lead = newest.at_s - window_seconds();
                    let least = if self.is_replay() { None } else { self.clock_lead_s.get_value() };
                    self.clock_lead_s.set_value(Some(least.map_or(lead, |known| known.max(lead))));
                    self.history.update_value(|history| history.take(&status.samples));
                    self.history_turn.update(|turn| *turn = turn.wrapping_add(1));
                }
                if status.health == Health::Reading {
                    self.remember_demonstration();
                }
                self.status.set(status);
            }
            ToWindow::Line(line) => self.hear_line(line),
            ToWindow::ReadOnly(read_only) => {
                self.read_only.set(read_only);
                storage::save(READ_ONLY, if read_only { READ_ONLY } else { "" });
            }
            // The link has shown the crash page already.
            ToWindow::Panicked(_) => {}
        }
    }

    fn hear_line(&self, line: Line) {
        let Line { connection, polling } = line;
        if connection.source == Source::Replay && !self.is_replay() {
            self.forget_readings();
            // The figures are those of the chosen device.
            if let Some(device) = device::of_packed(&connection.profile) {
                self.settings.device.set(device.id().to_owned());
            }
        }
        let told = |used: &Connection| (used.line, used.mode, used.unit);
        let before = self.connection.with_untracked(|used| used.as_ref().map(told));
        // Whoever connects again finds the device where it is now.
        if matches!(connection.source, Source::Serial(_)) && before.is_some_and(|before| before != told(&connection)) {
            self.settings.follow(&connection);
        }
        self.connection.set(Some(connection));
        self.polling.set(polling);
    }

    fn forget_readings(&self) {
        self.history.set_value(History::default());
        self.clock_lead_s.set_value(None);
        self.history_turn.update(|turn| *turn = turn.wrapping_add(1));
    }
}

/// Builds the page under Leptos's owner, which lives as long as the page does.
fn build() {
    // One for the life of the page, and cheap for every closure to hold.
    let app: &'static App = Box::leak(Box::new(App::new()));
    tick_while_connected(app);
    link::start(move |message| app.hear(message));
    if app.read_only.get_untracked() {
        link::send(&ToEngine::ReadOnly(true));
    }
    loader::follow(app);
    on_window("pagehide", |_| link::end());
    on_window("resize", |_| app.clock_turn.update(|turn| *turn = turn.wrapping_add(1)));
    // A page that comes back from the browser's memory has lost its engine.
    on_window("pageshow", |event| {
        if event.unchecked_ref::<web_sys::PageTransitionEvent>().persisted() {
            let _ = window().location().reload();
        }
    });
    // What an address carries beside the page is the page's own affair.
    let page = Memo::new(move |_| app.page.get());
    let skip = el("a").class("skip").attr("href", "#content").say(app, Language::skip_to_content);
    mount(skip.on("click", |event| {
        event.prevent_default();
        focus_content();
    }));
    let content = el("main").class("content").attr("id", "content").attr("tabindex", "-1");
    // The workbench tells here what was left half done, if the page was closed amidst a change of a device.
    let content = content.child(el("div").attr("id", "notices"));
    let content = content.live_one(move || {
        Some(match page.get() {
            Page::Live => live_page(app),
            page => {
                let place = loader::place(app, move || ToWorkbench::Page(Some(page)), ToWorkbench::Page(None));
                let needs_port = matches!(page, Page::Console | Page::Configure | Page::Fleet);
                if needs_port { connect_above(app).child(place) } else { place }
            }
        })
    });
    // A new place each time: the workbench opens its sheet in it.
    let help = move || {
        let chosen = move || ToWorkbench::Help(Some(app.settings.device.get_untracked()));
        (app.help.get() > 0).then(|| loader::place(app, chosen, ToWorkbench::Help(None)))
    };
    mount(el("div").class("app").child(rail(app)).child(top_bar(app)).child(content).live_one(help));
    if storage::load("journal").is_some_and(|kept| !kept.is_empty()) {
        loader::load(app);
    }
}

/// Drives what changes with time alone: ages and the moving strip.
fn tick_while_connected(app: &'static App) {
    let connected = Memo::new(move |_| app.phase.get().is_connected());
    react(move || {
        if connected.get() {
            let tick = move || app.clock_turn.update(|turn| *turn = turn.wrapping_add(1));
            if let Ok(timer) = set_interval_with_handle(tick, TICK) {
                on_cleanup(move || timer.clear());
            }
        }
    });
}

/// The address's `#` belongs to the pages, so the skip link moves the focus by hand.
fn focus_content() {
    if let Some(content) = document().get_element_by_id("content").and_then(|found| found.dyn_into().ok()) {
        let content: web_sys::HtmlElement = content;
        let _ = content.focus();
    }
}

/// The language as a signal that `<html lang>` and the title follow and that is remembered.
fn follow_language() -> RwSignal<Language> {
    let remembered = storage::load("language").and_then(|tag| Language::from_tag(&tag));
    let language = RwSignal::new(remembered.unwrap_or_else(browser_language));
    let mut first = true;
    react(move || {
        let tag = language.get().tag();
        if let Some(root) = document().document_element() {
            let _ = root.set_attribute("lang", tag);
        }
        // Only a choice is remembered, so that a change of the browser's language still counts until then.
        if !std::mem::take(&mut first) {
            storage::save("language", tag);
        }
    });
    language
}

/// The first of the browser's languages that is ours, else English.
fn browser_language() -> Language {
    let tags = window().navigator().languages();
    tags.iter().find_map(|tag| Language::from_tag(&tag.as_string()?)).unwrap_or(Language::En)
}

fn window_seconds() -> f64 {
    window().performance().map_or(0.0, |performance| performance.now() / 1000.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::Trouble;

    #[test]
    fn the_device_counts_only_on_an_open_port() {
        let failing = Health::Failing(Trouble::Silence);
        assert_eq!(Phase::of(&Link::Lost, &failing), Phase::Lost);
        assert_eq!(Phase::of(&Link::Open, &failing), Phase::Failing);
        assert_eq!(Phase::of(&Link::Open, &Health::Waiting), Phase::Waiting);
        assert!(!Phase::of(&Link::Closed, &Health::Reading).is_connected());
    }
}
