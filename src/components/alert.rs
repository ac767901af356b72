//! A fault as sentences: what happened, what to try, and buttons that really help.

use crate::reactive::prelude::*;

use super::button::button;
use super::icon::{Icon, icon};
use crate::app::App;
use crate::dom::{El, el};
use crate::link;
use crate::message::ToEngine;
use crate::text::Language;

/// A fault, told in the user's language.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    /// Its stable name, for tests.
    pub(crate) id: &'static str,
    /// What happened, in a few words.
    pub(crate) title: String,
    /// What happened, in a sentence or two.
    pub(crate) what: String,
    /// What to try, the likeliest first.
    pub(crate) tips: Vec<String>,
    /// What a button can do about it.
    pub(crate) remedy: Option<Remedy>,
}

/// What a button in the panel does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Remedy {
    /// Closes the port, so that the settings can be changed.
    ChangeSettings,
    /// Connects again as before.
    ConnectAgain,
    /// Takes the panel away.
    Dismiss,
}

/// The panel of a fault.
pub(crate) fn fault_panel(app: &'static App, fault: &Fault) -> El {
    let mut body = el("div").child(el("h2").text(&fault.title)).child(el("p").text(&fault.what));
    if !fault.tips.is_empty() {
        let tips = fault.tips.iter().map(|tip| el("li").text(tip));
        body = body.child(el("p").class("try").say(app, Language::what_to_try)).child(el("ol").children(tips));
    }
    let body = body.children(fault.remedy.map(|remedy| match remedy {
        Remedy::ChangeSettings => {
            button(app, "", "change-settings", Language::change_settings).click(|| link::send(&ToEngine::Disconnect))
        }
        Remedy::ConnectAgain => button(app, "", "connect-again", Language::load_again).click(|| {
            if let Some(connection) = app.connection.get_untracked() {
                app.connect(connection);
            }
        }),
        Remedy::Dismiss => button(app, "", "dismiss", Language::dismiss).click(|| app.pick_fault.set(None)),
    }));
    let panel = el("section").class("alert").attr("role", "alert").test("fault").attr("data-fault", fault.id);
    panel.child(icon(Icon::Fault)).child(body)
}
