//! A fault as sentences: what happened, what to try, and buttons that really help.

use leptos::prelude::*;

use super::icon::{Icon, icon};
use crate::app::App;
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
    /// Takes the panel away.
    Dismiss,
}

/// The panel; nothing while there is no fault.
pub(crate) fn fault_panel(app: &'static App, fault: Memo<Option<Fault>>) -> AnyView {
    (move || fault.get().map(|fault| panel(app, fault))).into_any()
}

fn panel(app: &'static App, fault: Fault) -> AnyView {
    let remedy = match fault.remedy {
        Some(Remedy::ChangeSettings) => view! {
            <button type="button" class="button" data-test="change-settings" on:click=move |_| link::send(&ToEngine::Disconnect)>
                {app.text(Language::change_settings)}
            </button>
        }
        .into_any(),
        Some(Remedy::Dismiss) => view! {
            <button type="button" class="button" data-test="dismiss" on:click=move |_| app.pick_fault.set(None)>
                {app.text(Language::dismiss)}
            </button>
        }
        .into_any(),
        None => ().into_any(),
    };
    let tips: Vec<_> = fault.tips.into_iter().map(|tip| view! { <li>{tip}</li> }).collect();
    let heading = (!tips.is_empty()).then(|| view! { <p class="try">{app.text(Language::what_to_try)}</p> });
    view! {
        <section class="alert" role="alert" data-test="fault" data-fault=fault.id>
            {icon(Icon::Fault)}
            <div>
                <h2>{fault.title}</h2>
                <p>{fault.what}</p>
                {heading}
                <ol>{tips}</ol>
                {remedy}
            </div>
        </section>
    }
    .into_any()
}
