//! What every part of both programs may look at. Signals only: free of JS handles.

use crate::reactive::prelude::*;
use crate::text::Language;

/// The state that both programs have, each its own. The state of a program can be given wherever this is wanted.
pub(crate) struct Ambient {
    /// The language of all texts.
    pub(crate) language: RwSignal<Language>,
}
