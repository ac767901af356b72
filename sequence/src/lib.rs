//! Test sequences for devices on a serial line: a readable text, its checker, a runner that opens no port and reads no
//! clock, and its report.

mod fault;
mod lex;
mod meaning;
mod parse;
mod pattern;
mod print;
mod ready;
mod report;
mod run;
mod script;

pub use fault::{Expected, Fault, FaultKind};
pub use parse::{MAX_DEPTH, MAX_FAULTS, MAX_STEPS, MAX_TEXT, parse};
pub use pattern::{MAX_BYTES, Pattern};
pub use ready::{READY, outline};
pub use report::{
    Branch, Changes, Compared, Ended, Entry, Exchange, Heard, MAX_ENTRIES, Mark, Reason, Report, Summary, Verdict,
};
pub use run::{Line, Order, Run};
pub use script::Sequence;

use serde::{Deserialize, Serialize};

/// A step that can cost something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Caution {
    /// Line of the text, from 1.
    pub line: u32,
    /// It can lose the device's settings or calibration, not only change how it is reached or what it measures.
    pub grave: bool,
}
