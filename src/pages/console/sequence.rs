//! Sequences.

use crate::dom::{El, el};
use crate::text::Language;
use crate::workbench::Workbench;

/// The pane.
pub(super) fn sequence_pane(app: &'static Workbench) -> El {
    el("div").class("pane-empty").child(el("p").say(app, Language::pane_sequence))
}
