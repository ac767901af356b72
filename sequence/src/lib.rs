//! Test sequences for devices on a serial line: a readable text, its checker, a runner that opens no port and reads no
//! clock, and its report. `docs/sequences.md` of the project tells the language.
//!
//! ```
//! use std::sync::Arc;
//! use buslens_bus::record::{End, Outcome};
//! use buslens_bus::time::Instant;
//! use buslens_codec::{UnitId, line::{LineSettings, Mode, Parity}};
//! use buslens_sequence::{Line, Order, Run, Verdict, parse};
//!
//! let sequence = parse("read holding 0x31\nexpect register 0x31 = 7", None).unwrap();
//! let line = Line { open: true, line: LineSettings::new(9600, Parity::Even), mode: Mode::Rtu, polling: false };
//! let mut run = Run::new(Arc::new(sequence), UnitId(1), None, line, Instant::ZERO);
//! let Some(Order::Send { id, bytes, .. }) = run.poll_order() else { panic!() };
//! assert_eq!(bytes, [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5]);
//! let heard = vec![0x01, 0x03, 0x02, 0x00, 0x07, 0xF9, 0x86];
//! run.done(Instant::ZERO, id, &Outcome { at_us: 0, heard, round_trip_us: None, end: End::Answered });
//! assert_eq!(run.report().summary.verdict, Verdict::Passed);
//!
//! let faults = parse("read holding 0x31\nexpcet reply", None).unwrap_err();
//! assert_eq!((faults[0].line, faults[0].column), (2, 1));
//! ```

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
mod text;

pub use fault::{Expected, Fault, FaultKind};
pub use parse::{MAX_DEPTH, MAX_FAULTS, MAX_STEPS, MAX_TEXT, parse};
pub use pattern::{MAX_BYTES, Pattern};
pub use ready::{READY, outline};
pub use report::{
    Branch, Changes, Compared, Ended, Entry, Exchange, Heard, MAX_ENTRIES, Mark, Reason, Report, Summary, Verdict,
};
pub use run::{Line, Order, Run};
pub use script::Sequence;
pub use text::Words;

use serde::{Deserialize, Serialize};

/// A step that can cost something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Caution {
    /// Line of the text, from 1.
    pub line: u32,
    /// It can lose the device's settings or calibration, not only change how it is reached or what it measures.
    pub grave: bool,
}
