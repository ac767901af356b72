//! How far a procedure has come.

use serde::{Deserialize, Serialize};

use crate::Reach;

/// How far a procedure has come.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Progress {
    /// What it does.
    pub phase: Phase,
    /// How much of this phase is done, of `total`: reads, reaches tried, steps.
    pub done: u32,
    /// How much there is to do in this phase, 0 where nobody knows.
    pub total: u32,
    /// How long this phase still takes at most, in milliseconds, where it can be told.
    pub left_ms: Option<u32>,
}

/// What a procedure does.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Waits for the polling under way to end, and for the port.
    Beginning,
    /// Reads parameters.
    Reading,
    /// Looks whether anybody else is where the device will be.
    CheckingFree(Reach),
    /// Writes a step of the plan, by its place in it.
    Writing {
        /// Its place in [`crate::Report::steps`].
        step: u32,
    },
    /// Follows the device to other settings.
    Following(Reach),
    /// Waits until it has restarted.
    Restarting,
    /// Searches it; tries this.
    Searching(Reach),
    /// Reads everything back that was written.
    Verifying,
    /// Writes back what a step has changed.
    Undoing {
        /// Its place in [`crate::Report::steps`].
        step: u32,
    },
    /// Sets the port and the polling as they shall stay.
    Ending,
}
