//! A sequence as data: one step a line.

use buslens_codec::UnitId;
use buslens_codec::line::{DataBits, Mode, Parity, StopBits};
use buslens_codec::value::Decimal;

use crate::pattern::Pattern;

/// A text without faults. Every line that does something is one step; blocks are steps with places to go on at.
///
/// Two are equal that have the same steps and comments in the same lines, however they are spelled.
#[derive(Clone, Debug, Default)]
pub struct Sequence {
    /// The steps in the order of their lines.
    pub(crate) steps: Vec<Step>,
    /// Comments with their lines, without their mark.
    pub(crate) comments: Vec<(u32, String)>,
    /// The lines of the text, without spaces around them.
    pub(crate) source: Vec<String>,
    /// Steps that can cost something.
    pub(crate) cautions: Vec<crate::Caution>,
}

impl PartialEq for Sequence {
    fn eq(&self, other: &Self) -> bool {
        self.steps == other.steps && self.comments == other.comments && self.source.len() == other.source.len()
    }
}

impl Eq for Sequence {}

impl Sequence {
    /// Its `title`, empty for none.
    pub fn title(&self) -> &str {
        let title = self.steps.iter().find_map(|step| match &step.action {
            Action::Title(title) => Some(title.as_str()),
            _ => None,
        });
        title.unwrap_or_default()
    }

    /// Id of the profile that it is for, `None` if it names none.
    pub fn device(&self) -> Option<&str> {
        self.steps.iter().find_map(|step| match &step.action {
            Action::Device(id) => Some(id.as_str()),
            _ => None,
        })
    }

    /// How many steps it has, ends of blocks among them.
    pub fn step_count(&self) -> usize {
        self.steps.len()
    }

    /// A line of its text, counted from 1, without spaces around it.
    pub fn line(&self, line: u32) -> &str {
        let at = usize::try_from(line).ok().and_then(|line| line.checked_sub(1));
        at.and_then(|at| self.source.get(at)).map_or("", String::as_str)
    }

    /// Steps that can change how the device is reached or what it measures, or lose its settings.
    pub fn cautions(&self) -> &[crate::Caution] {
        &self.cautions
    }
}

/// One line that does something.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Step {
    /// From 1.
    pub(crate) line: u32,
    /// Blocks around it.
    pub(crate) depth: u8,
    pub(crate) action: Action,
}

/// Places are those in [`Sequence::steps`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    Title(String),
    Device(String),
    Unit(UnitId),
    Timeout(Time),
    OnFailure(OnFailure),
    Line(LineChange),
    Poll(bool),
    Dtr(bool),
    Rts(bool),
    Break(Time),
    Wait(Time),
    Send(Sending),
    Ask(Asking),
    Expect(Condition),
    /// `next` is its `else`, `else if` or `end`.
    If {
        condition: Condition,
        next: usize,
    },
    ElseIf {
        condition: Condition,
        next: usize,
        end: usize,
    },
    Else {
        end: usize,
    },
    Repeat {
        how: Repeat,
        end: usize,
    },
    /// `begin` is the `if` or `repeat`.
    End {
        begin: usize,
    },
    Let {
        name: String,
        value: Expression,
    },
    Log(Vec<Piece>),
    Fail(Vec<Piece>),
    Stop,
}

/// In microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Time(pub(crate) u64);

impl Time {
    /// Whole milliseconds, rounded up.
    pub(crate) fn milliseconds(self) -> u32 {
        u32::try_from(self.0.div_ceil(1000)).unwrap_or(u32::MAX)
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum OnFailure {
    #[default]
    Continue,
    Stop,
}

/// What stays as it is, is `None`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LineChange {
    /// As it was when the sequence began.
    Original,
    To {
        baud: u32,
        parity: Option<Parity>,
        data_bits: Option<DataBits>,
        stop_bits: Option<StopBits>,
        mode: Option<Mode>,
    },
}

/// Raw bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Sending {
    /// As `:`, hexadecimal digits, CR LF.
    pub(crate) ascii: bool,
    pub(crate) bytes: Vec<Byte>,
    pub(crate) check: Check,
    pub(crate) within: Option<Time>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Byte {
    Is(u8),
    /// The unit id in force.
    Unit,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Check {
    None,
    Crc,
    Lrc,
    WrongCrc,
    WrongLrc,
}

/// A request that is made of points or registers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Asking {
    pub(crate) what: What,
    pub(crate) unit: Option<UnitId>,
    pub(crate) within: Option<Time>,
    pub(crate) wrong_check: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum What {
    ReadPoints(Vec<String>),
    ReadAll,
    Read { table: Table, address: u16, count: u16 },
    WritePoint { point: String, value: Expression },
    Command { point: String, value: Option<Expression> },
    WriteRegister { address: u16, value: Expression },
    WriteRegisters { address: u16, values: Vec<Expression> },
    WriteCoil { address: u16, on: bool },
    WriteCoils { address: u16, coils: Vec<bool> },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Table {
    Holding,
    Input,
    Coils,
    Discrete,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Condition {
    Reply,
    /// `None` for any.
    Exception(Option<u8>),
    Silence,
    Damage,
    Heard(Pattern),
    Compare {
        left: Expression,
        how: Comparison,
        right: Expression,
    },
    Between {
        value: Expression,
        least: Expression,
        most: Expression,
    },
}

impl Condition {
    /// Whether it is about what was heard, not about values in it.
    pub(crate) fn judges_the_answer(&self) -> bool {
        !matches!(self, Self::Compare { .. } | Self::Between { .. })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comparison {
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

/// A sum of operands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Expression {
    pub(crate) first: Operand,
    pub(crate) rest: Vec<(Sign, Operand)>,
}

impl Expression {
    pub(crate) fn operands(&self) -> impl Iterator<Item = &Operand> {
        core::iter::once(&self.first).chain(self.rest.iter().map(|(_, operand)| operand))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    Plus,
    Minus,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Operand {
    Point(String),
    Variable(String),
    /// Of the last reply.
    Register(u16),
    /// Of the last reply.
    Coil(u16),
    /// Of the last exchange.
    RoundTrip,
    Number {
        number: Decimal,
        unit: String,
    },
    /// Name of a code, or text.
    Name(String),
    /// A code as it stands in its register.
    Code(u16),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Repeat {
    Times(u32),
    Forever,
    Until { condition: Condition, at_most: Option<u32> },
}

/// Part of a text for the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    Text(String),
    Value(Expression),
}
