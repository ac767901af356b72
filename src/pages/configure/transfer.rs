//! What other pages ask of this one: to stage a snapshot for its review, and to say what stands in the way.

use buslens_analyst::configure::Hindrance;
use buslens_configure::{Plan, Snapshot, edits_to};

use super::state::{self, Blocked, Configure, Wish};
use crate::components::button::button;
use crate::device::Device;
use crate::dom::El;
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// A sentence that says why something cannot be done (`bad`, `warn`), or what it means (`info`).
pub(crate) fn hint(kind: &str, text: &str) -> El {
    super::hint(kind, text)
}

/// Why something was not begun, in words.
pub(crate) fn hindrance(language: Language, why: &Hindrance) -> String {
    state::hindrance(language, why)
}

impl Configure {
    /// What the connected device was last read to hold, reached as it is now; `None` while nothing was read of it.
    pub(crate) fn held_by(&self, app: &'static Workbench) -> Option<Snapshot> {
        let profile = app.target()?.device.profile();
        Some(self.have(app, profile)).filter(|have| !have.data.is_empty())
    }

    /// Stages what a snapshot says otherwise than the connected device, and opens the review of it. Nothing is sent.
    pub(crate) fn bring_snapshot(&self, app: &'static Workbench, wanted: &Snapshot, with_unit: bool) {
        let Some((device, have)) =
            untrack(|| Some((app.target()?.device, self.held_by(app)?))).filter(|(device, _)| fits(device, wanted))
        else {
            return;
        };
        let transfer = edits_to(device.profile(), &have, wanted, with_unit);
        self.stage(|staged| transfer.edits.iter().for_each(|edit| staged.put_edit(device.profile(), edit, &have)));
        self.review(Wish::Staged);
        let _ = window().location().set_hash("/configure");
    }

    /// A plan is about to be written for another page: whoever looks on here sees its steps.
    pub(crate) fn look_on(&self, plan: Plan) {
        self.last_step.set(None);
        self.reviewing.set(None);
        self.writing.set(Some(plan));
    }
}

impl Workbench {
    /// Why nothing can be read or searched now; with `write` written.
    pub(crate) fn why_not(&self, write: bool) -> Option<&'static str> {
        self.blocked(write).map(|why| why.text(self.language.get()))
    }

    /// The same as a sentence of the page, with what helps; `None` while something is under way, which shows by itself.
    pub(crate) fn why_not_hint(&'static self, write: bool) -> Option<El> {
        let why = self.blocked(write).filter(|why| *why != Blocked::Running)?;
        let line = hint("info", why.text(self.language.get()));
        Some(match why {
            Blocked::ReadOnly => line.child(
                button(self, "small", "allow-writes", Language::cfg_allow_writes)
                    .click(move || self.console.order(buslens_analyst::line::ToLine::ReadOnly(false))),
            ),
            _ => line,
        })
    }
}

fn fits(device: &Device, wanted: &Snapshot) -> bool {
    device.id() == wanted.profile
}
