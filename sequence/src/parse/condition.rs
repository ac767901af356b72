//! Conditions, comparisons and sums.

use buslens_codec::profile::Point;
use buslens_codec::value::{Decimal, Encoding};

use super::Parser;
use super::cursor::{Cursor, number_and_unit, whole};
use crate::fault::{Expected, Fault, FaultKind};
use crate::lex::TokenKind;
use crate::meaning::{self, Literal};
use crate::pattern::Pattern;
use crate::script::{Comparison, Condition, Expression, Operand, Sign};

/// Terms of a sum.
const MAX_TERMS: usize = 8;
/// Characters of a unit or of a name.
const MAX_NAME: usize = 64;

impl Parser<'_> {
    /// What an `expect`, an `if` or an `until` says; all that is left of the line.
    pub(super) fn condition(&self, cursor: &mut Cursor<'_>) -> Result<Condition, Fault> {
        let compares = cursor
            .rest()
            .iter()
            .any(|token| token.is_word("between") || matches!(&token.kind, TokenKind::Mark(mark) if *mark != ","));
        if compares {
            return self.comparison(cursor);
        }
        let pattern = cursor.rest();
        let condition = match cursor.peek_word() {
            Some("reply") => Condition::Reply,
            Some("silence") => Condition::Silence,
            Some("damage") => Condition::Damage,
            Some("exception") => {
                cursor.skip();
                let Some(word) = cursor.peek_word() else { return Ok(Condition::Exception(None)) };
                let code = u8::from_str_radix(word, 16).ok().filter(|code| *code > 0 && !word.starts_with('+'));
                Condition::Exception(Some(code.ok_or_else(|| cursor.fault(FaultKind::BadByte(word.to_owned())))?))
            }
            None if pattern.is_empty() => return Err(cursor.expected(Expected::Condition)),
            _ => {
                // A lone name is more likely a comparison that is not complete than bytes.
                let name = cursor.peek_word().filter(|name| self.names(name) && pattern.len() == 1);
                if name.is_some() && Pattern::of(cursor.line, pattern).is_err() {
                    cursor.skip();
                    return Err(cursor.expected(Expected::Comparison));
                }
                cursor.skip_all();
                return Pattern::of(cursor.line, pattern).map(Condition::Heard);
            }
        };
        cursor.skip();
        Ok(condition)
    }

    fn comparison(&self, cursor: &mut Cursor<'_>) -> Result<Condition, Fault> {
        let left = self.expression(cursor, None)?;
        let point = match (&left.first, left.rest.as_slice()) {
            (Operand::Point(id), []) => self.profile.and_then(|profile| profile.point(id)),
            _ => None,
        };
        if cursor.takes("between") {
            let least = self.right_side(cursor, &left, point)?;
            cursor.needs("and", Expected::And)?;
            let most = self.right_side(cursor, &left, point)?;
            return Ok(Condition::Between { value: left, least, most });
        }
        let how = match cursor.peek().map(|token| &token.kind) {
            Some(TokenKind::Mark("=")) => Comparison::Equal,
            Some(TokenKind::Mark("!=")) => Comparison::NotEqual,
            Some(TokenKind::Mark("<")) => Comparison::Less,
            Some(TokenKind::Mark("<=")) => Comparison::LessOrEqual,
            Some(TokenKind::Mark(">")) => Comparison::Greater,
            Some(TokenKind::Mark(">=")) => Comparison::GreaterOrEqual,
            _ => return Err(cursor.expected(Expected::Comparison)),
        };
        cursor.skip();
        let before = cursor.fault(FaultKind::TooManyFaults);
        let right = self.right_side(cursor, &left, point)?;
        if let (Some(point), [], Comparison::Equal | Comparison::NotEqual) = (point, right.rest.as_slice(), how) {
            let unknown = meaning::literal(&right.first)
                .filter(|literal| !matches!(literal, Literal::Code(_)) && meaning::value(point, literal).is_none());
            if unknown.is_some() {
                return Err(Fault { kind: unknown_code(point, &right.first), ..before });
            }
        }
        Ok(Condition::Compare { left, how, right })
    }

    /// The right side, whose units must be those of the left.
    fn right_side(
        &self,
        cursor: &mut Cursor<'_>,
        left: &Expression,
        point: Option<&Point>,
    ) -> Result<Expression, Fault> {
        let before = cursor.fault(FaultKind::TooManyFaults);
        let right = self.expression(cursor, point)?;
        let wanted = match (&left.first, point) {
            (Operand::RoundTrip, _) => Some("ms"),
            (_, Some(point)) if point.unit_from.is_none() => Some(point.unit.as_str()),
            _ => None,
        };
        for operand in right.operands() {
            if let (Operand::Number { unit, .. }, Some(wanted)) = (operand, wanted)
                && !unit.is_empty()
                && unit != wanted
            {
                let kind = FaultKind::WrongUnit { wanted: wanted.to_owned(), found: unit.clone() };
                return Err(Fault { kind, ..before });
            }
        }
        Ok(right)
    }

    /// A sum. Names of codes are those of `point`.
    pub(super) fn expression(&self, cursor: &mut Cursor<'_>, point: Option<&Point>) -> Result<Expression, Fault> {
        let first = self.operand(cursor, point)?;
        let mut rest = Vec::new();
        loop {
            let sign = if cursor.takes("+") {
                Sign::Plus
            } else if cursor.takes("-") {
                Sign::Minus
            } else {
                return Ok(Expression { first, rest });
            };
            if rest.len() + 1 >= MAX_TERMS {
                return Err(cursor.fault(FaultKind::TooManyParts(u32::try_from(MAX_TERMS).unwrap_or(u32::MAX))));
            }
            rest.push((sign, self.operand(cursor, point)?));
        }
    }

    fn operand(&self, cursor: &mut Cursor<'_>, point: Option<&Point>) -> Result<Operand, Fault> {
        let token = cursor.peek().ok_or_else(|| cursor.expected(Expected::Value))?;
        let word = match &token.kind {
            TokenKind::Word(word) => word.as_str(),
            TokenKind::Quoted(_) => {
                let fault = cursor.fault(FaultKind::TooManyFaults);
                let name = Self::text(cursor)?;
                return match point {
                    Some(point) if meaning::value(point, &Literal::Name(&name)).is_none() => {
                        Err(Fault { kind: unknown_code(point, &Operand::Name(name)), ..fault })
                    }
                    _ => Ok(Operand::Name(name)),
                };
            }
            TokenKind::Mark(_) => return Err(cursor.expected(Expected::Value)),
        };
        if word.starts_with(|character: char| character.is_ascii_digit() || character == '-') {
            return Self::number(cursor, word);
        }
        let numbered = cursor.second().is_some_and(|next| {
            matches!(&next.kind, TokenKind::Word(next) if next.starts_with(|character: char| character.is_ascii_digit()))
        });
        match word {
            "register" if numbered => {
                cursor.skip();
                Ok(Operand::Register(cursor.register()?))
            }
            "coil" if numbered => {
                cursor.skip();
                Ok(Operand::Coil(cursor.register()?))
            }
            "code" if numbered => {
                cursor.skip();
                Ok(Operand::Code(cursor.register()?))
            }
            "round" if cursor.second().is_some_and(|next| next.is_word("trip")) => {
                cursor.skip();
                cursor.skip();
                Ok(Operand::RoundTrip)
            }
            _ if self.variables.iter().any(|known| known == word) => {
                cursor.skip();
                Ok(Operand::Variable(word.to_owned()))
            }
            // The name of a code goes before that of another point: it is what stands on the right side most.
            _ if point.is_some_and(|point| meaning::value(point, &Literal::Name(word)).is_some()) => {
                cursor.skip();
                Ok(Operand::Name(word.to_owned()))
            }
            _ if self.names(word) => Ok(Operand::Point(self.readable(cursor)?.id)),
            // States of coils.
            "on" | "off" if point.is_none() => {
                cursor.skip();
                Ok(Operand::Name(word.to_owned()))
            }
            _ => Err(match point.filter(|point| !point.codes.is_empty()) {
                Some(point) => cursor.fault(unknown_code(point, &Operand::Name(word.to_owned()))),
                None => cursor.fault(FaultKind::UnknownName(word.to_owned())),
            }),
        }
    }

    /// A number with its unit behind it, if there is one.
    fn number(cursor: &mut Cursor<'_>, word: &str) -> Result<Operand, Fault> {
        let bad = || cursor.fault(FaultKind::BadNumber(word.to_owned()));
        if word.starts_with("0x") || word.starts_with("0X") {
            let number = whole(word).and_then(|number| i64::try_from(number).ok()).ok_or_else(bad)?;
            cursor.skip();
            return Ok(Operand::Number { number: Decimal::whole(number), unit: String::new() });
        }
        let (digits, glued) = number_and_unit(word);
        let number = Decimal::parse(digits).ok_or_else(bad)?;
        if !glued.is_empty() && !is_unit(glued) {
            return Err(bad());
        }
        cursor.skip();
        let mut unit = glued.to_owned();
        if let Some(next) = cursor.peek_word().filter(|next| unit.is_empty() && is_unit(next)) {
            next.clone_into(&mut unit);
            cursor.skip();
        }
        Ok(Operand::Number { number, unit })
    }

    /// Whether the profile has such a point or a `let` such a variable.
    pub(super) fn names(&self, word: &str) -> bool {
        let point = self.profile.is_some_and(|profile| profile.point(word).is_some());
        point || self.variables.iter().any(|known| known == word)
    }
}

/// Whether a word behind a number can be its unit.
fn is_unit(word: &str) -> bool {
    !matches!(word, "and" | "unit" | "within" | "wrong")
        && !word.starts_with(|character: char| character.is_ascii_digit() || matches!(character, '+' | '-' | '.'))
        && word.chars().count() <= MAX_NAME
}

fn unknown_code(point: &Point, found: &Operand) -> FaultKind {
    let value = match found {
        Operand::Name(name) => name.clone(),
        other => other.to_string(),
    };
    if meaning::has_codes(point) {
        FaultKind::UnknownCode { point: point.id.clone(), value, known: meaning::code_names(point) }
    } else if matches!(point.encoding, Encoding::Text { .. }) || matches!(found, Operand::Number { .. }) {
        FaultKind::NotAllowed { point: point.id.clone(), value }
    } else {
        FaultKind::UnknownName(value)
    }
}
