//! Why a text is no sequence, and where.

use serde::{Deserialize, Serialize};

/// One fault of a text. A text with any is not run at all.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// Counted from 1.
    pub line: u32,
    /// In characters, counted from 1.
    pub column: u32,
    /// What is wrong.
    pub kind: FaultKind,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FaultKind {
    /// The line begins with a word that is no step.
    UnknownStep(String),
    /// Something else is needed here than what was found, which is empty at the end of a line.
    Expected(Expected, String),
    /// The step is complete before this.
    LeftOver(String),
    /// A quoted text has no end on its line.
    QuoteNotClosed,
    /// An escape that does not exist, or `\x` without two digits.
    BadEscape(String),
    /// A brace in a text for the report that opens or closes nothing.
    BadBrace,
    /// A character in quoted bytes that is none of ASCII: which bytes it means is unclear.
    NotAscii(char),
    /// No pair of hexadecimal digits.
    BadByte(String),
    /// No number, or one with more digits than can be kept.
    BadNumber(String),
    /// A number beyond its limits, both included.
    OutOfRange {
        /// The least.
        first: u64,
        /// The most.
        last: u64,
    },
    /// More bytes than one step may have.
    TooManyBytes(u32),
    /// More terms, points or values than one step may have.
    TooManyParts(u32),
    /// A longer text than is read.
    TextTooLong(u32),
    /// More steps than a sequence may have.
    TooManySteps(u32),
    /// Blocks within more blocks than a sequence may have.
    TooDeep(u32),
    /// There are more faults than these.
    TooManyFaults,
    /// `end` or `else` belongs to no block.
    NothingOpen,
    /// The block that begins here has no `end`.
    NotClosed,
    /// A second `else`, or one in a `repeat`.
    ElseNotHere,
    /// `title` and `device` stand before all other steps, each once.
    OnlyAtTheTop,
    /// A point is named and there is no profile to know it.
    NoProfile(String),
    /// The sequence is for another device.
    OtherDevice {
        /// Id of the profile that it is for.
        wanted: String,
        /// Id of the profile in force, empty for none.
        found: String,
    },
    /// No point of the profile and no variable.
    UnknownName(String),
    /// No point of the profile.
    UnknownPoint(String),
    /// A variable's name that is a point's or that a number or a keyword could be taken for.
    NameTaken(String),
    /// The point can only be written.
    NotReadable(String),
    /// The point can only be read.
    NotWritable(String),
    /// The point is no command: it is written.
    NotACommand(String),
    /// No code of the point has this name or stands for this number.
    UnknownCode {
        /// The point's id.
        point: String,
        /// As it stands in the text.
        value: String,
        /// What its codes are called, in English.
        known: Vec<String>,
    },
    /// The profile does not allow this value, or it cannot be written so.
    NotAllowed {
        /// The point's id.
        point: String,
        /// As it stands in the text.
        value: String,
    },
    /// The point has another unit of measure.
    WrongUnit {
        /// Its unit; empty for none.
        wanted: String,
        /// As it stands in the text.
        found: String,
    },
}

/// What is needed in a place of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Expected {
    /// Bytes as pairs of hexadecimal digits or quoted.
    Bytes,
    /// A pattern of bytes or a condition.
    Condition,
    /// `=`, `!=`, `<`, `<=`, `>`, `>=` or `between`.
    Comparison,
    /// A whole number.
    Number,
    /// A number, a name or a quoted text.
    Value,
    /// A time with its unit: `200 ms`, `1.5 s`.
    Time,
    /// A quoted text.
    Text,
    /// A name of letters, digits and `_`.
    Name,
    /// A point of the profile, or `holding`, `input`, `coils`, `discrete`, `all`.
    Readable,
    /// A point of the profile, or `register`, `registers`, `coil`, `coils`.
    Writable,
    /// `on` or `off`.
    OnOff,
    /// `continue` or `stop`.
    ContinueOrStop,
    /// A baud rate and what follows it, or `original`.
    Line,
    /// A number and `times`, `until` or `forever`.
    Repeat,
    /// `=`.
    Equals,
    /// `and`.
    And,
    /// `failure`.
    Failure,
    /// `times`.
    Times,
    /// `crc` or `lrc`; behind a request `check`.
    Check,
}
