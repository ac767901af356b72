//! The words of one line, taken one after the other.

use buslens_codec::value::Decimal;

use crate::fault::{Expected, Fault, FaultKind};
use crate::lex::{Token, TokenKind};
use crate::script::Time;

/// A day, in microseconds: the longest time that a step may name.
const MAX_TIME: u64 = 86_400_000_000;

pub(super) struct Cursor<'a> {
    pub(super) line: u32,
    tokens: &'a [Token],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(line: u32, tokens: &'a [Token]) -> Self {
        Self { line, tokens, at: 0 }
    }

    pub(super) fn peek(&self) -> Option<&'a Token> {
        self.tokens.get(self.at)
    }

    pub(super) fn peek_word(&self) -> Option<&'a str> {
        match &self.peek()?.kind {
            TokenKind::Word(word) => Some(word),
            _ => None,
        }
    }

    pub(super) fn peek_is_mark(&self, wanted: &str) -> bool {
        self.peek().is_some_and(|token| matches!(&token.kind, TokenKind::Mark(mark) if *mark == wanted))
    }

    /// The word after the next.
    pub(super) fn second(&self) -> Option<&'a Token> {
        self.tokens.get(self.at + 1)
    }

    pub(super) fn rest(&self) -> &'a [Token] {
        self.tokens.get(self.at..).unwrap_or_default()
    }

    pub(super) fn skip(&mut self) {
        self.at += 1;
    }

    pub(super) fn skip_all(&mut self) {
        self.at = self.tokens.len();
    }

    /// These next words alone, the rest being left.
    pub(super) fn split(&mut self, count: usize) -> Self {
        let tokens = self.rest().get(..count).unwrap_or_default();
        self.at += count;
        Self { line: self.line, tokens, at: 0 }
    }

    /// Takes the word if it is the next.
    pub(super) fn takes(&mut self, word: &str) -> bool {
        let taken = self.peek().is_some_and(|token| token.is_word(word));
        if taken {
            self.at += 1;
        }
        taken
    }

    /// Takes the mark if it is the next.
    pub(super) fn takes_mark(&mut self, mark: &str) -> bool {
        let taken = self.peek_is_mark(mark);
        if taken {
            self.at += 1;
        }
        taken
    }

    /// Takes the word, which must be the next.
    pub(super) fn needs(&mut self, word: &str, expected: Expected) -> Result<(), Fault> {
        if self.takes(word) { Ok(()) } else { Err(self.expected(expected)) }
    }

    /// Where a fault in the next word stands: behind the line at its end.
    pub(super) fn fault(&self, kind: FaultKind) -> Fault {
        let column = match (self.peek(), self.tokens.last()) {
            (Some(token), _) => token.column,
            (None, Some(last)) => {
                last.column.saturating_add(u32::try_from(last.text().chars().count()).unwrap_or(u32::MAX))
            }
            (None, None) => 1,
        };
        Fault { line: self.line, column, kind }
    }

    pub(super) fn expected(&self, expected: Expected) -> Fault {
        let found = self.peek().map(Token::text).unwrap_or_default();
        self.fault(FaultKind::Expected(expected, found))
    }

    /// Nothing more may follow.
    pub(super) fn finish(&self) -> Result<(), Fault> {
        match self.peek() {
            Some(token) => Err(self.fault(FaultKind::LeftOver(token.text()))),
            None => Ok(()),
        }
    }

    pub(super) fn word(&mut self, expected: Expected) -> Result<&'a str, Fault> {
        let word = self.peek_word().ok_or_else(|| self.expected(expected))?;
        self.at += 1;
        Ok(word)
    }

    /// A whole number, decimal or with `0x`.
    pub(super) fn whole(&mut self, first: u64, last: u64) -> Result<u64, Fault> {
        let word = self.peek_word().ok_or_else(|| self.expected(Expected::Number))?;
        let number = whole(word).ok_or_else(|| {
            let digits = word.starts_with(|character: char| character.is_ascii_digit());
            if digits { self.fault(FaultKind::BadNumber(word.to_owned())) } else { self.expected(Expected::Number) }
        })?;
        if !(first..=last).contains(&number) {
            return Err(self.fault(FaultKind::OutOfRange { first, last }));
        }
        self.at += 1;
        Ok(number)
    }

    /// A number of 16 bits.
    pub(super) fn register(&mut self) -> Result<u16, Fault> {
        self.within(0, u16::MAX)
    }

    pub(super) fn within(&mut self, first: u16, last: u16) -> Result<u16, Fault> {
        let number = self.whole(first.into(), last.into())?;
        Ok(u16::try_from(number).unwrap_or(last))
    }

    pub(super) fn count(&mut self, last: u32) -> Result<u32, Fault> {
        let number = self.whole(1, last.into())?;
        Ok(u32::try_from(number).unwrap_or(last))
    }

    /// A time with its unit.
    pub(super) fn time(&mut self) -> Result<Time, Fault> {
        let word = self.peek_word().ok_or_else(|| self.expected(Expected::Time))?;
        let (digits, glued) = number_and_unit(word);
        let unit = if glued.is_empty() { self.second().map(Token::text).unwrap_or_default() } else { glued.to_owned() };
        let Some(number) = Decimal::parse(digits) else { return Err(self.expected(Expected::Time)) };
        let decimals = match unit.as_str() {
            "ms" => 3,
            "s" => 6,
            _ => return Err(self.expected(Expected::Time)),
        };
        let time = number.mantissa_with(decimals).and_then(|time| u64::try_from(time).ok());
        let limit = MAX_TIME / if decimals == 3 { 1000 } else { 1_000_000 };
        let time = time.filter(|time| *time <= MAX_TIME);
        let time = time.ok_or_else(|| self.fault(FaultKind::OutOfRange { first: 0, last: limit }))?;
        self.at += if glued.is_empty() { 2 } else { 1 };
        Ok(Time(time))
    }

    pub(super) fn on_off(&mut self) -> Result<bool, Fault> {
        if self.takes("on") {
            Ok(true)
        } else if self.takes("off") {
            Ok(false)
        } else {
            Err(self.expected(Expected::OnOff))
        }
    }

    /// What stands between quotes, and the column of the first of them.
    pub(super) fn quoted(&mut self) -> Result<(u32, &'a str), Fault> {
        match self.peek() {
            Some(Token { column, kind: TokenKind::Quoted(inner) }) => {
                self.at += 1;
                Ok((*column, inner))
            }
            _ => Err(self.expected(Expected::Text)),
        }
    }
}

/// A whole number, decimal or with `0x`.
pub(super) fn whole(word: &str) -> Option<u64> {
    let plain = |digits: &str| !digits.starts_with('+');
    match word.strip_prefix("0x").or(word.strip_prefix("0X")) {
        Some(digits) => u64::from_str_radix(digits, 16).ok().filter(|_| plain(digits)),
        None => word.parse().ok().filter(|_| plain(word)),
    }
}

/// A number and the unit that stands right behind it: `20°C`.
pub(super) fn number_and_unit(word: &str) -> (&str, &str) {
    let sign = usize::from(word.starts_with('-'));
    let behind = word.get(sign..).unwrap_or_default();
    let end = behind.find(|character: char| !character.is_ascii_digit() && character != '.');
    word.split_at_checked(end.map_or(word.len(), |end| sign + end)).unwrap_or((word, ""))
}
