//! From steps to text: each step in its own line again, blocks indented, words as the documentation has them.

use core::fmt;

use buslens_codec::line::{DataBits, Mode, Parity, StopBits};
use buslens_codec::value::Decimal;

use crate::pattern::{Item, Pattern};
use crate::script::{
    Action, Asking, Byte, Check, Comparison, Condition, Expression, LineChange, OnFailure, Operand, Piece, Repeat,
    Sending, Sequence, Sign, Table, Time, What,
};

/// The text in its canonical form. It reads as the same steps in the same lines; comments stay, and so do empty lines.
impl fmt::Display for Sequence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut steps = self.steps.iter().peekable();
        let mut comments = self.comments.iter().peekable();
        for line in 1..=u32::try_from(self.source.len()).unwrap_or(u32::MAX) {
            let comment = comments.next_if(|(at, _)| *at == line);
            if let Some(step) = steps.next_if(|step| step.line == line) {
                let indent = usize::from(step.depth) * 2;
                write!(f, "{:indent$}{}", "", step.action)?;
                if comment.is_some() {
                    f.write_str("  ")?;
                }
            }
            if let Some((_, comment)) = comment {
                f.write_str("#")?;
                if !comment.is_empty() {
                    write!(f, " {comment}")?;
                }
            }
            f.write_str("\n")?;
        }
        Ok(())
    }
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Title(title) => write!(f, "title {}", Quoted(title)),
            Self::Device(id) => write!(f, "device {id}"),
            Self::Unit(unit) => write!(f, "unit {unit}"),
            Self::Timeout(time) => write!(f, "timeout {time}"),
            Self::OnFailure(OnFailure::Continue) => f.write_str("on failure continue"),
            Self::OnFailure(OnFailure::Stop) => f.write_str("on failure stop"),
            Self::Line(change) => write!(f, "line {change}"),
            Self::Poll(on) => write!(f, "poll {}", on_off(*on)),
            Self::Dtr(on) => write!(f, "dtr {}", on_off(*on)),
            Self::Rts(on) => write!(f, "rts {}", on_off(*on)),
            Self::Break(time) => write!(f, "break {time}"),
            Self::Wait(time) => write!(f, "wait {time}"),
            Self::Send(sending) => write!(f, "send {sending}"),
            Self::Ask(asking) => asking.fmt(f),
            Self::Expect(condition) => write!(f, "expect {condition}"),
            Self::If { condition, .. } => write!(f, "if {condition}"),
            Self::ElseIf { condition, .. } => write!(f, "else if {condition}"),
            Self::Else { .. } => f.write_str("else"),
            Self::Repeat { how, .. } => write!(f, "repeat {how}"),
            Self::End { .. } => f.write_str("end"),
            Self::Let { name, value } => write!(f, "let {name} = {value}"),
            Self::Log(pieces) => write!(f, "log {}", Pieces(pieces)),
            Self::Fail(pieces) => write!(f, "fail {}", Pieces(pieces)),
            Self::Stop => f.write_str("stop"),
        }
    }
}

fn on_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (unit, scale) = if self.0 >= 1_000_000 && self.0.is_multiple_of(100_000) { ("s", 6) } else { ("ms", 3) };
        let mantissa = i64::try_from(self.0).unwrap_or(i64::MAX);
        let shortest = (0..scale).find_map(|decimals| {
            let cut = Decimal { mantissa, decimals: scale }.mantissa_with(i8::try_from(decimals).ok()?)?;
            Some(Decimal { mantissa: cut, decimals })
        });
        write!(f, "{} {unit}", shortest.unwrap_or(Decimal { mantissa, decimals: scale }))
    }
}

impl fmt::Display for LineChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::To { baud, parity, data_bits, stop_bits, mode } = self else { return f.write_str("original") };
        write!(f, "{baud}")?;
        let parity = parity.map(|parity| match parity {
            Parity::None => "none",
            Parity::Odd => "odd",
            Parity::Even => "even",
        });
        let data_bits = data_bits.map(|bits| match bits {
            DataBits::Seven => "7",
            DataBits::Eight => "8",
        });
        let stop_bits = stop_bits.map(|bits| match bits {
            StopBits::One => "1",
            StopBits::Two => "2",
        });
        let mode = mode.map(|mode| match mode {
            Mode::Rtu => "rtu",
            Mode::Ascii => "ascii",
        });
        for word in [parity, data_bits, stop_bits, mode].into_iter().flatten() {
            write!(f, " {word}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Sending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut space = "";
        if self.ascii {
            f.write_str("ascii")?;
            space = " ";
        }
        for byte in &self.bytes {
            match byte {
                Byte::Is(byte) => write!(f, "{space}{byte:02X}")?,
                Byte::Unit => write!(f, "{space}UNIT")?,
            }
            space = " ";
        }
        match self.check {
            Check::None if self.ascii => f.write_str(" none")?,
            Check::None => {}
            Check::Lrc if self.ascii => {}
            Check::Crc => f.write_str(" crc")?,
            Check::Lrc => f.write_str(" lrc")?,
            Check::WrongCrc => f.write_str(" wrong crc")?,
            Check::WrongLrc => f.write_str(" wrong lrc")?,
        }
        within(f, self.within)
    }
}

fn within(f: &mut fmt::Formatter<'_>, time: Option<Time>) -> fmt::Result {
    time.map_or(Ok(()), |time| write!(f, " within {time}"))
}

impl fmt::Display for Asking {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.what.fmt(f)?;
        if let Some(unit) = self.unit {
            write!(f, " unit {unit}")?;
        }
        within(f, self.within)?;
        f.write_str(if self.wrong_check { " wrong check" } else { "" })
    }
}

impl fmt::Display for What {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ReadPoints(points) => write!(f, "read {}", points.join(", ")),
            Self::ReadAll => f.write_str("read all"),
            Self::Read { table, address, count } => {
                let table = match table {
                    Table::Holding => "holding",
                    Table::Input => "input",
                    Table::Coils => "coils",
                    Table::Discrete => "discrete",
                };
                write!(f, "read {table} 0x{address:04X} count {count}")
            }
            Self::WritePoint { point, value } => write!(f, "write {point} = {value}"),
            Self::Command { point, value: None } => write!(f, "command {point}"),
            Self::Command { point, value: Some(value) } => write!(f, "command {point} = {value}"),
            Self::WriteRegister { address, value } => write!(f, "write register 0x{address:04X} = {value}"),
            Self::WriteRegisters { address, values } => {
                write!(f, "write registers 0x{address:04X} = ")?;
                list(f, values)
            }
            Self::WriteCoil { address, on } => write!(f, "write coil 0x{address:04X} = {}", on_off(*on)),
            Self::WriteCoils { address, coils } => {
                write!(f, "write coils 0x{address:04X} = ")?;
                list(f, &coils.iter().map(|on| on_off(*on)).collect::<Vec<_>>())
            }
        }
    }
}

fn list(f: &mut fmt::Formatter<'_>, all: &[impl fmt::Display]) -> fmt::Result {
    for (at, one) in all.iter().enumerate() {
        write!(f, "{}{one}", if at > 0 { ", " } else { "" })?;
    }
    Ok(())
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reply => f.write_str("reply"),
            Self::Exception(None) => f.write_str("exception"),
            Self::Exception(Some(code)) => write!(f, "exception {code:02X}"),
            Self::Silence => f.write_str("silence"),
            Self::Damage => f.write_str("damage"),
            Self::Heard(pattern) => pattern.fmt(f),
            Self::Compare { left, how, right } => write!(f, "{left} {how} {right}"),
            Self::Between { value, least, most } => write!(f, "{value} between {least} and {most}"),
        }
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Equal => "=",
            Self::NotEqual => "!=",
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
        })
    }
}

impl fmt::Display for Repeat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Times(times) => write!(f, "{times} times"),
            Self::Forever => f.write_str("forever"),
            Self::Until { condition, at_most: None } => write!(f, "until {condition}"),
            Self::Until { condition, at_most: Some(times) } => write!(f, "until {condition} at most {times} times"),
        }
    }
}

/// As [`Pattern::parse`] reads it.
impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut space = "";
        if self.ascii {
            f.write_str("ascii")?;
            space = " ";
        }
        for item in &self.items {
            f.write_str(space)?;
            space = " ";
            match item {
                Item::Any => f.write_str("..")?,
                Item::Crc => f.write_str("CRC")?,
                Item::Lrc => f.write_str("LRC")?,
                Item::Unit => f.write_str("UNIT")?,
                Item::Byte { value, mask } => {
                    for (half, known) in [(value >> 4, mask >> 4), (value & 0x0F, mask & 0x0F)] {
                        if known == 0 { f.write_str("?")? } else { write!(f, "{half:X}")? }
                    }
                }
            }
        }
        Ok(())
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.first.fmt(f)?;
        for (sign, operand) in &self.rest {
            write!(f, " {} {operand}", if *sign == Sign::Plus { '+' } else { '-' })?;
        }
        Ok(())
    }
}

impl fmt::Display for Operand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Point(name) | Self::Variable(name) => f.write_str(name),
            Self::Register(address) => write!(f, "register 0x{address:04X}"),
            Self::Coil(address) => write!(f, "coil 0x{address:04X}"),
            Self::RoundTrip => f.write_str("round trip"),
            Self::Number { number, unit } if unit.is_empty() => number.fmt(f),
            Self::Number { number, unit } => write!(f, "{number} {unit}"),
            Self::Name(name) => Quoted(name).fmt(f),
            Self::Code(code) => write!(f, "code {code}"),
        }
    }
}

/// A text in quotes, what cannot stand there escaped.
struct Quoted<'a>(&'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"")?;
        escape(f, self.0)?;
        f.write_str("\"")
    }
}

struct Pieces<'a>(&'a [Piece]);

impl fmt::Display for Pieces<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"")?;
        for piece in self.0 {
            match piece {
                Piece::Text(text) => escape(f, &text.replace('{', "{{").replace('}', "}}"))?,
                Piece::Value(value) => {
                    f.write_str("{")?;
                    escape(f, &value.to_string())?;
                    f.write_str("}")?;
                }
            }
        }
        f.write_str("\"")
    }
}

fn escape(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    use fmt::Write;

    for character in text.chars() {
        match character {
            '"' | '\\' => write!(f, "\\{character}")?,
            '\n' => f.write_str("\\n")?,
            '\r' => f.write_str("\\r")?,
            '\t' => f.write_str("\\t")?,
            '\0'..='\u{1F}' | '\u{7F}'..='\u{FF}' if character.is_control() => {
                write!(f, "\\x{:02X}", u32::from(character))?;
            }
            _ => f.write_char(character)?,
        }
    }
    Ok(())
}
