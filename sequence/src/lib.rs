//! Test sequences for devices on a serial line: a readable text, its checker, a runner that opens no port and reads no
//! clock, and its report.

mod fault;
mod report;

pub use fault::{Expected, Fault, FaultKind};
pub use report::{
    Branch, Changes, Compared, Ended, Entry, Exchange, Heard, MAX_ENTRIES, Mark, Reason, Report, Summary, Verdict,
};

use serde::{Deserialize, Serialize};

/// A step that can cost something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Caution {
    /// Line of the text, from 1.
    pub line: u32,
    /// It can lose the device's settings or calibration, not only change how it is reached or what it measures.
    pub grave: bool,
}
