//! One step.

use buslens_codec::UnitId;
use buslens_codec::line::{DataBits, Mode, Parity, StopBits};

use super::Parser;
use super::cursor::Cursor;
use crate::fault::{Expected, Fault, FaultKind};
use crate::lex::Token;
use crate::script::{Action, LineChange, OnFailure, Repeat, Time};

/// Bits per second that a port may be asked for.
const MAX_BAUD: u32 = 10_000_000;
/// Rounds of a `repeat`.
const MAX_ROUNDS: u32 = 1_000_000;
/// The longest break, in microseconds.
const MAX_BREAK: u64 = 10_000_000;
/// Variables.
const MAX_VARIABLES: usize = 256;

/// Words that a variable would be mistaken for.
const KEYWORDS: &[&str] = &[
    "and",
    "ascii",
    "between",
    "code",
    "coil",
    "crc",
    "damage",
    "end",
    "exception",
    "lrc",
    "none",
    "off",
    "on",
    "register",
    "reply",
    "round",
    "silence",
    "unit",
    "within",
    "wrong",
];

impl Parser<'_> {
    /// A line that is not `else` or `end`. The places that blocks go on at come later.
    pub(super) fn action(&mut self, line: u32, tokens: &[Token]) -> Result<Action, Fault> {
        let mut cursor = Cursor::new(line, tokens);
        let unknown = cursor.fault(FaultKind::UnknownStep(tokens.first().map(Token::text).unwrap_or_default()));
        let Some(word) = cursor.peek_word() else { return Err(unknown) };
        cursor.skip();
        let action = match word {
            "title" => {
                self.top_only(&unknown, |action| matches!(action, Action::Title(_)))?;
                Action::Title(Self::text(&mut cursor)?)
            }
            "device" => {
                self.top_only(&unknown, |action| matches!(action, Action::Device(_)))?;
                Action::Device(self.device(&mut cursor)?)
            }
            "unit" => Action::Unit(UnitId(u8::try_from(cursor.within(0, 255)?).unwrap_or(u8::MAX))),
            "timeout" => Action::Timeout(cursor.time()?),
            "on" => {
                cursor.needs("failure", Expected::Failure)?;
                match cursor.peek_word() {
                    Some("continue") => cursor.skip(),
                    Some("stop") => {
                        cursor.skip();
                        cursor.finish()?;
                        return Ok(Action::OnFailure(OnFailure::Stop));
                    }
                    _ => return Err(cursor.expected(Expected::ContinueOrStop)),
                }
                Action::OnFailure(OnFailure::Continue)
            }
            "line" => Action::Line(line_change(&mut cursor)?),
            "poll" => Action::Poll(cursor.on_off()?),
            "dtr" => Action::Dtr(cursor.on_off()?),
            "rts" => Action::Rts(cursor.on_off()?),
            "break" => {
                let last = MAX_BREAK / 1000;
                let too_long = cursor.fault(FaultKind::OutOfRange { first: 1, last });
                let time = cursor.time()?;
                if !(1000..=MAX_BREAK).contains(&time.0) {
                    return Err(too_long);
                }
                Action::Break(Time(time.0.div_ceil(1000) * 1000))
            }
            "wait" => Action::Wait(cursor.time()?),
            "send" => Action::Send(Self::sending(&mut cursor)?),
            "read" => Action::Ask(self.reading(&mut cursor)?),
            "write" => Action::Ask(self.writing(&mut cursor)?),
            "command" => Action::Ask(self.command(&mut cursor)?),
            "expect" => Action::Expect(self.condition(&mut cursor)?),
            "if" => Action::If { condition: self.condition(&mut cursor)?, next: 0 },
            "repeat" => Action::Repeat { how: self.repeat(&mut cursor)?, end: 0 },
            "let" => self.variable(&mut cursor)?,
            "log" => Action::Log(self.pieces(&mut cursor)?),
            "fail" => Action::Fail(self.pieces(&mut cursor)?),
            "stop" => Action::Stop,
            _ => return Err(unknown),
        };
        cursor.finish()?;
        Ok(action)
    }

    fn top_only(&self, here: &Fault, same: impl Fn(&Action) -> bool) -> Result<(), Fault> {
        let steps = &self.sequence.steps;
        let top = steps.iter().all(|step| matches!(step.action, Action::Title(_) | Action::Device(_)));
        if top && !steps.iter().any(|step| same(&step.action)) {
            Ok(())
        } else {
            Err(Fault { kind: FaultKind::OnlyAtTheTop, ..here.clone() })
        }
    }

    fn device(&self, cursor: &mut Cursor<'_>) -> Result<String, Fault> {
        let before = cursor.fault(FaultKind::TooManyFaults);
        let wanted = cursor.word(Expected::Name)?.to_owned();
        let found = self.profile.map(|profile| profile.id.clone()).unwrap_or_default();
        if found == wanted {
            Ok(wanted)
        } else {
            Err(Fault { kind: FaultKind::OtherDevice { wanted, found }, ..before })
        }
    }

    fn repeat(&self, cursor: &mut Cursor<'_>) -> Result<Repeat, Fault> {
        if cursor.takes("forever") {
            return Ok(Repeat::Forever);
        }
        if cursor.takes("until") {
            let rest = cursor.rest();
            let limit = rest
                .windows(2)
                .rposition(|pair| matches!(pair, [first, second] if first.is_word("at") && second.is_word("most")));
            let mut own = cursor.split(limit.unwrap_or(rest.len()));
            let condition = self.condition(&mut own)?;
            own.finish()?;
            if limit.is_none() {
                return Ok(Repeat::Until { condition, at_most: None });
            }
            cursor.skip();
            cursor.skip();
            let at_most = Some(cursor.count(MAX_ROUNDS)?);
            cursor.needs("times", Expected::Times)?;
            return Ok(Repeat::Until { condition, at_most });
        }
        if cursor.peek().is_none() {
            return Err(cursor.expected(Expected::Repeat));
        }
        let times = cursor.count(MAX_ROUNDS)?;
        cursor.needs("times", Expected::Times)?;
        Ok(Repeat::Times(times))
    }

    fn variable(&mut self, cursor: &mut Cursor<'_>) -> Result<Action, Fault> {
        let before = cursor.expected(Expected::Name);
        let name = cursor.word(Expected::Name)?.to_owned();
        let mut characters = name.chars();
        let letters = characters.next().is_some_and(|first| first.is_alphabetic() || first == '_')
            && characters.all(|character| character.is_alphanumeric() || character == '_')
            && name.len() <= 64;
        if !letters {
            return Err(before);
        }
        let point = self.profile.is_some_and(|profile| profile.point(&name).is_some());
        if point || KEYWORDS.contains(&name.as_str()) {
            return Err(Fault { kind: FaultKind::NameTaken(name), ..before });
        }
        if !cursor.takes_mark("=") {
            return Err(cursor.expected(Expected::Equals));
        }
        let value = self.expression(cursor, None)?;
        if !self.variables.contains(&name) {
            if self.variables.len() >= MAX_VARIABLES {
                let limit = u32::try_from(MAX_VARIABLES).unwrap_or(u32::MAX);
                return Err(Fault { kind: FaultKind::TooManyParts(limit), ..before });
            }
            self.variables.push(name.clone());
        }
        Ok(Action::Let { name, value })
    }
}

/// Everything after `line`.
fn line_change(cursor: &mut Cursor<'_>) -> Result<LineChange, Fault> {
    if cursor.takes("original") {
        return Ok(LineChange::Original);
    }
    if cursor.peek().is_none() {
        return Err(cursor.expected(Expected::Line));
    }
    let baud = cursor.count(MAX_BAUD)?;
    let (mut parity, mut data_bits, mut stop_bits, mut mode) = (None, None, None, None);
    while let Some(word) = cursor.peek_word() {
        if let (Some(short), None, None, None) = (short_form(word), parity, data_bits, stop_bits) {
            (data_bits, parity, stop_bits) = (Some(short.0), Some(short.1), Some(short.2));
            cursor.skip();
            continue;
        }
        match word {
            "none" if parity.is_none() => parity = Some(Parity::None),
            "odd" if parity.is_none() => parity = Some(Parity::Odd),
            "even" if parity.is_none() => parity = Some(Parity::Even),
            "7" if data_bits.is_none() => data_bits = Some(DataBits::Seven),
            "8" if data_bits.is_none() => data_bits = Some(DataBits::Eight),
            "1" if stop_bits.is_none() => stop_bits = Some(StopBits::One),
            "2" if stop_bits.is_none() => stop_bits = Some(StopBits::Two),
            "rtu" | "RTU" if mode.is_none() => mode = Some(Mode::Rtu),
            "ascii" | "ASCII" if mode.is_none() => mode = Some(Mode::Ascii),
            _ => return Err(cursor.expected(Expected::Line)),
        }
        cursor.skip();
    }
    Ok(LineChange::To { baud, parity, data_bits, stop_bits, mode })
}

/// `8E1`
fn short_form(word: &str) -> Option<(DataBits, Parity, StopBits)> {
    let [data, parity, stop] = word.as_bytes() else { return None };
    let data = match data {
        b'7' => DataBits::Seven,
        b'8' => DataBits::Eight,
        _ => return None,
    };
    let parity = match parity.to_ascii_uppercase() {
        b'N' => Parity::None,
        b'O' => Parity::Odd,
        b'E' => Parity::Even,
        _ => return None,
    };
    let stop = match stop {
        b'1' => StopBits::One,
        b'2' => StopBits::Two,
        _ => return None,
    };
    Some((data, parity, stop))
}
