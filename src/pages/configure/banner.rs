//! What was under way when a page was closed, a port was lost or a device fell silent: on every page, until it is finished,
//! undone or deliberately left.

use buslens_analyst::configure::StoreFault;
use buslens_configure::{Journal, JournalStep, Snapshot, StepState, Way};
use wasm_bindgen::JsValue;

use super::review::change;
use super::state::Blocked;
use super::{focus_soon, hint};
use crate::components::button::button;
use crate::components::icon::{Icon, icon};
use crate::configure::words;
use crate::configuring::Kind;
use crate::device;
use crate::dom::{El, el, react};
use crate::reactive::prelude::*;
use crate::route::Page;
use crate::storage;
use crate::text::Language;
use crate::workbench::Workbench;

/// The key under which the first program finds that something is to be offered.
const KEY: &str = "journal";

/// The banner; empty while nothing was left.
pub(crate) fn banner(app: &'static Workbench) -> El {
    follow_key(app);
    if storage::load(KEY).is_some_and(|kept| !kept.is_empty()) {
        // The worker looks what was left.
        app.start_console();
    }
    let leaving = RwSignal::new(None);
    // What is being written here is no offer; and while a journal is gone on from, the page shows how far that is.
    let busy = Memo::new(move |_| {
        app.configuring
            .running
            .with(|running| running.as_ref().is_some_and(|running| matches!(running.kind, Kind::Apply | Kind::Recover)))
    });
    el("div").class("contents").live(move || {
        if busy.get() {
            return Vec::new();
        }
        // What the report on the page offers already is not offered twice.
        let reported = app.configure.reported_journal().filter(|_| app.page.get() == Some(Page::Configure));
        app.configuring.open.with(|open| {
            let others = open.iter().filter(|journal| reported != Some(journal.id));
            others.map(|journal| offer(app, journal, leaving)).collect()
        })
    })
}

/// Keeps in step what the first program looks for at its start: it loads this one only if there is something to offer.
fn follow_key(app: &'static Workbench) {
    let had = StoredValue::new(false);
    react(move || {
        let open = app.configuring.open.with(|open| !open.is_empty());
        let running = app.configuring.running.with(|running| {
            running.as_ref().is_some_and(|running| matches!(running.kind, Kind::Apply | Kind::Recover))
        });
        let has = open || running;
        // What another tab has left there stays: it is taken away by whoever has had something to offer.
        if has || had.get_value() {
            storage::save(KEY, if has { "open" } else { "" });
        }
        had.set_value(has);
    });
}

/// What was left, and the three ways on.
fn offer(app: &'static Workbench, journal: &Journal, leaving: RwSignal<Option<u64>>) -> El {
    let language = app.language.get();
    let id = journal.id;
    let known = device::all().into_iter().find(|device| device.id() == journal.profile);
    let name = known.map_or(journal.profile.as_str(), |device| device.name(language));
    let reach = words::reach(language, &journal.reach);
    let when = date(language, journal.begun_unix_ms);
    let sent = journal.steps.iter().filter(|step| step.state != StepState::Waiting).count();
    let steps = known.map(|device| {
        let profile = device.profile();
        let have = Snapshot::empty(profile, journal.reach);
        let item = |step: &JournalStep| {
            let name = words::name(language, profile, &step.point);
            el("li").child(el("span").class("cfg-step-name").text(&name)).child(change(
                language,
                profile,
                (&step.point, step.before.as_deref(), &step.after),
                &have,
            ))
        };
        el("ul").class("cfg-left").children(journal.steps.iter().map(item))
    });
    let go_on = move |way: Way| {
        move || {
            if app.recover(id, way).is_some() {
                app.configure.report.set(None);
                let _ = window().location().set_hash("/configure");
                focus_soon("configure-work");
            }
        }
    };
    let blocked = Memo::new(move |_| app.blocked(true));
    let actions = move || {
        if leaving.get() == Some(id) {
            let yes = button(app, "small danger", "journal-leave-now", Language::cfg_leave_now).click(move || {
                app.discard_journal(id);
                leaving.set(None);
            });
            let no = button(app, "small quiet", "journal-keep", Language::cancel).click(move || leaving.set(None));
            let question = el("span").say(app, Language::cfg_leave_question);
            return el("div").class("cfg-offers").attr("role", "alert").child(question).child(yes).child(no);
        }
        let finish = button(app, "small primary", "journal-finish", Language::cfg_finish)
            .flag("disabled", move || blocked.get().is_some())
            .click(go_on(Way::Finish));
        let undo = button(app, "small", "journal-undo", Language::cfg_undo_journal)
            .flag("disabled", move || blocked.get().is_some())
            .click(go_on(Way::Undo));
        let leave =
            button(app, "small quiet", "journal-leave", Language::cfg_leave).click(move || leaving.set(Some(id)));
        let why = move || {
            let language = app.language.get();
            Some(match blocked.get()? {
                Blocked::Closed => hint("info", language.cfg_banner_connect())
                    .child(el("a").class("button small").attr("href", "#/configure").text(language.cfg_go_connect())),
                other => hint("info", other.text(language)),
            })
        };
        el("div").class("cfg-offers").child(finish).child(undo).child(leave).live_one(why)
    };
    el("section").class("alert cfg-banner").attr("role", "alert").test("journal").child(icon(Icon::Fault)).child(
        el("div")
            .child(el("h2").text(language.cfg_banner_title()))
            .child(
                el("p")
                    .text(&language.cfg_banner_what(name, &reach, &when))
                    .text(" ")
                    .text(&language.cfg_banner_steps(sent, journal.steps.len())),
            )
            .children(steps)
            .live_one(move || Some(actions())),
    )
}

/// Why nothing can be kept, in words.
pub(super) fn store_fault(language: Language, fault: &StoreFault) -> String {
    match fault {
        StoreFault::Unavailable => language.cfg_store_unavailable().to_owned(),
        StoreFault::Full => language.cfg_store_full().to_owned(),
        StoreFault::Other(words) => language.cfg_store_other(words),
    }
}

fn date(language: Language, unix_ms: u64) -> String {
    // Milliseconds of some thousand years fit.
    #[allow(clippy::cast_precision_loss)]
    let date = js_sys::Date::new(&JsValue::from_f64(unix_ms as f64));
    String::from(date.to_locale_string(language.tag(), &JsValue::UNDEFINED))
}
