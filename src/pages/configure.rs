//! The Configure page: what a device is set to, changed without ever losing it.

mod banner;
mod commands;
mod file;
mod find;
mod report;
mod review;
mod run;
mod state;
mod table;
mod transfer;

use crate::components::icon::{Icon, icon};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

pub(crate) use banner::banner;
pub(crate) use state::{Configure, follow as follow_configuring};
pub(crate) use transfer::{hindrance, hint as configure_hint};

use crate::configuring::Kind;

/// What the card above the parameters shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Work {
    /// A plan, before it is written.
    Review,
    /// Something under way.
    Run(u32),
    /// What has come of it.
    Report(u32),
}

/// The page.
pub(crate) fn configure_page(app: &'static Workbench) -> El {
    let configure = &app.configure;
    app.start_console();
    state::read_when_new(app);
    let device = Memo::new(move |_| configure.device(app).map(|device| device.id().to_owned()));
    let work = Memo::new(move |_| {
        let running = app.configuring.running.with(|running| running.as_ref().map(|one| (one.run, one.kind)));
        match running {
            Some((run, kind)) if kind != Kind::Read => Some(Work::Run(run)),
            _ if configure.reviewing.with(Option::is_some) => Some(Work::Review),
            _ => configure.report.with(|ended| ended.as_ref().map(|ended| Work::Report(ended.run))),
        }
    });
    el("div")
        .class("page configure")
        .test("page-configure")
        .child(el("h1").class("visually-hidden").say(app, Language::configure))
        .live_one(move || {
            Some(match work.get()? {
                Work::Review => review::review_card(app),
                Work::Run(_) => run::run_card(app),
                Work::Report(_) => report::report_card(app),
            })
        })
        .live(move || {
            let Some(id) = device.get() else { return vec![table::empty_card(app)] };
            let device = crate::device::find(&id);
            vec![table::parameters_card(app, device), commands::commands_card(app, device)]
        })
        .child(find::find_card(app))
}

/// A sentence that says why something cannot be done, or what it means.
fn hint(kind: &str, text: &str) -> El {
    let mark = if kind == "info" { Icon::Info } else { Icon::Fault };
    el("p").class("cfg-hint").attr("data-kind", kind).child(icon(mark)).child(el("span").text(text))
}

/// Puts the focus on an element that is about to be drawn.
fn focus_soon(id: &'static str) {
    request_animation_frame(move || {
        dom::focus(id);
    });
}

/// The same for an element that stands there.
fn focus_on(id: &str) {
    dom::focus(id);
}
