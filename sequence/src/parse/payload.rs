//! What goes out, and texts for the report.

use buslens_codec::pdu::{MAX_READ_BITS, MAX_READ_QUANTITY, MAX_WRITE_COILS, MAX_WRITE_QUANTITY};
use buslens_codec::profile::{Point, Role};
use buslens_codec::{UnitId, profile::Danger};

use super::Parser;
use super::cursor::Cursor;
use crate::fault::{Expected, Fault, FaultKind};
use crate::lex::{self, Character, TokenKind};
use crate::meaning;
use crate::pattern::{MAX_BYTES, pairs, quoted_bytes};
use crate::script::{Asking, Byte, Check, Expression, Operand, Piece, Sending, Table, What};

/// Characters of a title or of a text for the report.
const MAX_TEXT: usize = 1000;
/// Points of one `read`.
const MAX_POINTS: usize = 64;

impl Parser<'_> {
    /// Everything after `send`.
    pub(super) fn sending(cursor: &mut Cursor<'_>) -> Result<Sending, Fault> {
        let ascii = cursor.takes("ascii");
        let mut bytes = Vec::new();
        while let Some(token) = cursor.peek() {
            match &token.kind {
                TokenKind::Word(word) if matches!(word.as_str(), "UNIT" | "unit") => bytes.push(Byte::Unit),
                TokenKind::Word(word)
                    if matches!(word.as_str(), "crc" | "CRC" | "lrc" | "LRC" | "none" | "wrong" | "within") =>
                {
                    break;
                }
                TokenKind::Word(word) => {
                    let bad = || cursor.fault(FaultKind::BadByte(word.clone()));
                    for (high, low) in pairs(word).ok_or_else(bad)? {
                        let byte = high.to_digit(16).zip(low.to_digit(16)).map(|(high, low)| high << 4 | low);
                        bytes.push(Byte::Is(byte.and_then(|byte| u8::try_from(byte).ok()).ok_or_else(bad)?));
                    }
                }
                TokenKind::Quoted(inner) => {
                    bytes.extend(quoted_bytes(cursor.line, token.column, inner)?.into_iter().map(Byte::Is));
                }
                TokenKind::Mark(mark) => return Err(cursor.fault(FaultKind::BadByte((*mark).to_owned()))),
            }
            if bytes.len() > MAX_BYTES {
                return Err(cursor.fault(FaultKind::TooManyBytes(u32::try_from(MAX_BYTES).unwrap_or(u32::MAX))));
            }
            cursor.skip();
        }
        if bytes.is_empty() {
            return Err(cursor.expected(Expected::Bytes));
        }
        let check = if cursor.takes("wrong") {
            match cursor.peek_word() {
                Some("crc" | "CRC") => Check::WrongCrc,
                Some("lrc" | "LRC") => Check::WrongLrc,
                _ => return Err(cursor.expected(Expected::Check)),
            }
        } else {
            match cursor.peek_word() {
                Some("crc" | "CRC") => Check::Crc,
                Some("lrc" | "LRC") => Check::Lrc,
                Some("none") => Check::None,
                // Nobody means an ASCII frame without its check.
                _ if ascii => Check::Lrc,
                _ => Check::None,
            }
        };
        if !matches!(cursor.peek_word(), None | Some("within")) {
            cursor.skip();
        }
        let within = if cursor.takes("within") { Some(cursor.time()?) } else { None };
        Ok(Sending { ascii, bytes, check, within })
    }

    /// Everything after `read`.
    pub(super) fn reading(&self, cursor: &mut Cursor<'_>) -> Result<Asking, Fault> {
        let numbered = cursor.second().is_some_and(|token| {
            matches!(&token.kind, TokenKind::Word(word) if word.starts_with(|character: char| character.is_ascii_digit()))
        });
        let table = match cursor.peek_word() {
            Some("holding") if numbered => Some(Table::Holding),
            Some("input") if numbered => Some(Table::Input),
            Some("coils") if numbered => Some(Table::Coils),
            Some("discrete") if numbered => Some(Table::Discrete),
            _ => None,
        };
        let what = if let Some(table) = table {
            cursor.skip();
            let address = cursor.register()?;
            let limit = match table {
                Table::Holding | Table::Input => MAX_READ_QUANTITY,
                Table::Coils | Table::Discrete => MAX_READ_BITS,
            };
            let count = if cursor.takes("count") { cursor.within(1, limit)? } else { 1 };
            What::Read { table, address, count }
        } else if cursor.peek_word() == Some("all") && self.profile.is_none_or(|profile| profile.point("all").is_none())
        {
            if self.profile.is_none() {
                return Err(cursor.fault(FaultKind::NoProfile("all".to_owned())));
            }
            cursor.skip();
            What::ReadAll
        } else {
            let mut points = Vec::new();
            loop {
                points.push(self.readable(cursor)?.id.clone());
                if !cursor.takes_mark(",") {
                    break;
                }
                if points.len() >= MAX_POINTS {
                    return Err(cursor.fault(FaultKind::TooManyParts(u32::try_from(MAX_POINTS).unwrap_or(u32::MAX))));
                }
            }
            What::ReadPoints(points)
        };
        Self::asking(cursor, what)
    }

    /// Everything after `write`.
    pub(super) fn writing(&mut self, cursor: &mut Cursor<'_>) -> Result<Asking, Fault> {
        let numbered = !matches!(cursor.second().map(|token| &token.kind), Some(TokenKind::Mark(_)) | None);
        let what = match cursor.peek_word() {
            Some("register") if numbered => {
                cursor.skip();
                let address = cursor.register()?;
                equals(cursor)?;
                What::WriteRegister { address, value: self.register_value(cursor)? }
            }
            Some("registers") if numbered => {
                cursor.skip();
                let address = cursor.register()?;
                equals(cursor)?;
                let values = list(cursor, MAX_WRITE_QUANTITY, |cursor| self.register_value(cursor))?;
                What::WriteRegisters { address, values }
            }
            Some("coil") if numbered => {
                cursor.skip();
                let address = cursor.register()?;
                equals(cursor)?;
                What::WriteCoil { address, on: cursor.on_off()? }
            }
            Some("coils") if numbered => {
                cursor.skip();
                let address = cursor.register()?;
                equals(cursor)?;
                What::WriteCoils { address, coils: list(cursor, MAX_WRITE_COILS, Cursor::on_off)? }
            }
            _ => {
                let point = self.writable(cursor)?;
                equals(cursor)?;
                let value = self.value_of(cursor, &point)?;
                What::WritePoint { point: point.id, value }
            }
        };
        Self::asking(cursor, what)
    }

    /// Everything after `command`.
    pub(super) fn command(&mut self, cursor: &mut Cursor<'_>) -> Result<Asking, Fault> {
        let fault = cursor.expected(Expected::Writable);
        let point = self.writable(cursor)?;
        if point.role != Role::Command {
            return Err(Fault { kind: FaultKind::NotACommand(point.id), ..fault });
        }
        let value = if cursor.takes_mark("=") {
            Some(self.value_of(cursor, &point)?)
        } else {
            let Some(first) = point.codes.first() else { return Err(cursor.expected(Expected::Equals)) };
            self.caution(cursor.line, point.danger.max(first.danger));
            None
        };
        Self::asking(cursor, What::Command { point: point.id, value })
    }

    /// What may follow every request.
    fn asking(cursor: &mut Cursor<'_>, what: What) -> Result<Asking, Fault> {
        let mut asking = Asking { what, unit: None, within: None, wrong_check: false };
        loop {
            if asking.unit.is_none() && cursor.takes("unit") {
                let unit = cursor.within(0, 255)?;
                asking.unit = Some(UnitId(u8::try_from(unit).unwrap_or(u8::MAX)));
            } else if asking.within.is_none() && cursor.takes("within") {
                asking.within = Some(cursor.time()?);
            } else if !asking.wrong_check && cursor.takes("wrong") {
                cursor.needs("check", Expected::Check)?;
                asking.wrong_check = true;
            } else {
                return Ok(asking);
            }
        }
    }

    pub(super) fn readable(&self, cursor: &mut Cursor<'_>) -> Result<Point, Fault> {
        let point = self.point(cursor, Expected::Readable)?;
        if point.read_group().is_none() {
            return Err(cursor.fault(FaultKind::NotReadable(point.id)));
        }
        cursor.skip();
        Ok(point)
    }

    fn writable(&self, cursor: &mut Cursor<'_>) -> Result<Point, Fault> {
        let point = self.point(cursor, Expected::Writable)?;
        if point.write.is_empty() {
            return Err(cursor.fault(FaultKind::NotWritable(point.id)));
        }
        cursor.skip();
        Ok(point)
    }

    /// The point that the next word names; it is not taken.
    fn point(&self, cursor: &Cursor<'_>, expected: Expected) -> Result<Point, Fault> {
        let id = cursor.peek_word().ok_or_else(|| cursor.expected(expected))?;
        let profile = self.profile.ok_or_else(|| cursor.fault(FaultKind::NoProfile(id.to_owned())))?;
        profile.point(id).cloned().ok_or_else(|| cursor.fault(FaultKind::UnknownPoint(id.to_owned())))
    }

    /// A value to be written to a point.
    fn value_of(&mut self, cursor: &mut Cursor<'_>, point: &Point) -> Result<Expression, Fault> {
        let before = cursor.fault(FaultKind::TooManyFaults);
        let expression = self.expression(cursor, Some(point))?;
        let mut danger = point.danger;
        if let ([], Some(literal)) = (expression.rest.as_slice(), meaning::literal(&expression.first)) {
            let known = meaning::value(point, &literal);
            // A code is written on purpose, whatever the table says.
            let deliberate = matches!(literal, meaning::Literal::Code(_));
            if !deliberate && known.is_none_or(|value| !meaning::may_be_written(point, value)) {
                let (point, value) = (point.id.clone(), expression.first.to_string());
                return Err(Fault { kind: FaultKind::NotAllowed { point, value }, ..before });
            }
            danger = known.map_or(danger, |value| point.danger_of(value));
        }
        self.caution(cursor.line, danger);
        Ok(expression)
    }

    /// A number of 16 bits with or without sign, or a variable.
    fn register_value(&self, cursor: &mut Cursor<'_>) -> Result<Expression, Fault> {
        let before = cursor.fault(FaultKind::OutOfRange { first: 0, last: u16::MAX.into() });
        let expression = self.expression(cursor, None)?;
        match &expression {
            Expression { first: Operand::Number { number, unit }, rest } if rest.is_empty() => {
                let whole = number.mantissa_with(0).filter(|number| (-0x8000..=0xFFFF).contains(number));
                if whole.is_none() || !unit.is_empty() { Err(before) } else { Ok(expression) }
            }
            Expression { first: Operand::Name(_), .. } => {
                Err(Fault { kind: FaultKind::Expected(Expected::Number, expression.first.to_string()), ..before })
            }
            _ => Ok(expression),
        }
    }

    fn caution(&mut self, line: u32, danger: Danger) {
        if danger > Danger::None {
            let grave = danger == Danger::Danger;
            self.sequence.cautions.push(crate::Caution { line, grave });
        }
    }

    /// A plain quoted text.
    pub(super) fn text(cursor: &mut Cursor<'_>) -> Result<String, Fault> {
        let before = cursor.fault(FaultKind::TextTooLong(u32::try_from(MAX_TEXT).unwrap_or(u32::MAX)));
        let (column, inner) = cursor.quoted()?;
        if inner.chars().count() > MAX_TEXT {
            return Err(before);
        }
        let characters = characters(cursor.line, column, inner)?;
        Ok(characters.into_iter().map(|(_, character)| character).collect())
    }

    /// A quoted text with values in braces.
    pub(super) fn pieces(&self, cursor: &mut Cursor<'_>) -> Result<Vec<Piece>, Fault> {
        let too_long = cursor.fault(FaultKind::TextTooLong(u32::try_from(MAX_TEXT).unwrap_or(u32::MAX)));
        let (column, inner) = cursor.quoted()?;
        if inner.chars().count() > MAX_TEXT {
            return Err(too_long);
        }
        let place = |at: usize| column.saturating_add(u32::try_from(at + 1).unwrap_or(u32::MAX));
        let line = cursor.line;
        let fault = |at: usize, kind| Fault { line, column: place(at), kind };
        let mut pieces = Vec::new();
        let mut plain = String::new();
        let mut characters = characters(line, column, inner)?.into_iter().peekable();
        while let Some((at, character)) = characters.next() {
            let doubled = characters.peek().is_some_and(|(_, next)| *next == character);
            match character {
                '{' | '}' if doubled => {
                    characters.next();
                    plain.push(character);
                }
                '}' => return Err(fault(at, FaultKind::BadBrace)),
                '{' => {
                    let inside: Vec<char> =
                        characters.by_ref().map(|(_, character)| character).take_while(|next| *next != '}').collect();
                    let closed = inner.chars().skip(at + 1).any(|next| next == '}');
                    if !closed || inside.iter().any(|next| matches!(next, '{' | '"' | '#')) {
                        return Err(fault(at, FaultKind::BadBrace));
                    }
                    let inside: String = inside.into_iter().collect();
                    let moved = |fault: Fault| Fault { column: place(at).saturating_add(fault.column), ..fault };
                    let (tokens, _) = lex::line(line, &inside).map_err(moved)?;
                    let mut value = Cursor::new(line, &tokens);
                    let expression = self.expression(&mut value, None).map_err(moved)?;
                    value.finish().map_err(moved)?;
                    if expression.operands().any(|operand| matches!(operand, Operand::Name(_))) {
                        return Err(fault(at, FaultKind::UnknownName(inside)));
                    }
                    if !plain.is_empty() {
                        pieces.push(Piece::Text(core::mem::take(&mut plain)));
                    }
                    pieces.push(Piece::Value(expression));
                }
                _ => plain.push(character),
            }
        }
        if !plain.is_empty() {
            pieces.push(Piece::Text(plain));
        }
        Ok(pieces)
    }
}

fn characters(line: u32, column: u32, inner: &str) -> Result<Vec<(usize, char)>, Fault> {
    let bad = |(at, escape): (usize, String)| {
        let column = column.saturating_add(u32::try_from(at + 1).unwrap_or(u32::MAX));
        Fault { line, column, kind: FaultKind::BadEscape(escape) }
    };
    let plain = |(at, character)| match character {
        Character::Plain(character) => (at, character),
        Character::Escaped(byte) => (at, char::from(byte)),
    };
    Ok(lex::unescape(inner).map_err(bad)?.into_iter().map(plain).collect())
}

fn equals(cursor: &mut Cursor<'_>) -> Result<(), Fault> {
    if cursor.takes_mark("=") { Ok(()) } else { Err(cursor.expected(Expected::Equals)) }
}

fn list<'a, T>(
    cursor: &mut Cursor<'a>,
    limit: u16,
    one: impl Fn(&mut Cursor<'a>) -> Result<T, Fault>,
) -> Result<Vec<T>, Fault> {
    let mut all = vec![one(cursor)?];
    while cursor.takes_mark(",") {
        if all.len() >= usize::from(limit) {
            return Err(cursor.fault(FaultKind::TooManyParts(limit.into())));
        }
        all.push(one(cursor)?);
    }
    Ok(all)
}
