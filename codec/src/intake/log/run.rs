//! Runs of tokens that can be bytes: written and parted in one manner.

use alloc::vec::Vec;

use super::super::decimal;
use super::super::hex::{self, Span};
use super::super::line::is_space;
use crate::rtu;

/// How a token is written; a run has one style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Style {
    Bare,
    /// `0x01`, `$01`, `#01`, `&H01`.
    Prefix,
    /// `\x01`.
    Escape,
    /// `01h`.
    Suffix,
    /// `[01]`
    Square,
    /// `<01>`
    Angle,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub(super) start: usize,
    pub(super) end: usize,
    pub(super) digits: Span,
    pub(super) style: Style,
}

impl Token {
    fn len(&self) -> usize {
        self.digits.end - self.digits.start
    }

    fn bytes(&self) -> usize {
        self.len().div_ceil(2)
    }
}

/// What a run holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Hex,
    Decimal,
    /// The characters of an ASCII frame.
    Frame,
    /// Text with escapes.
    Literal,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub(super) start: usize,
    pub(super) end: usize,
    pub(super) kind: Kind,
    pub(super) style: Style,
    pub(super) bytes: usize,
    pub(super) tokens: usize,
    class: Class,
    first: Token,
    /// Where the second token begins.
    second: usize,
    last: Token,
    /// Where the last token but one ends.
    before_last: usize,
    /// All tokens are decimal numbers of a byte, as one writes them; and one has three digits.
    decimal: bool,
    three: bool,
}

/// What stands between two tokens: a sign or none, and how wide the gap is where it is wide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Class {
    sign: u8,
    gap: usize,
}

/// What parts the tokens around `start..end`; `None` where no two tokens of a run can be parted so.
fn class(codes: &[u8], start: usize, end: usize) -> Option<Class> {
    let mut class = Class::default();
    for code in codes.get(start..end)? {
        match code {
            b' ' => class.gap += 1,
            b'\t' if matches!(class.sign, 0 | b'\t') => class.sign = b'\t',
            b',' | b';' | b'-' | b':' if matches!(class.sign, 0 | b'\t') => class.sign = *code,
            _ => return None,
        }
    }
    // A colon parts bytes only where it stands alone; else it is behind a name.
    if class.sign == b':' && class.gap > 0 {
        return None;
    }
    // A byte or two of space are no columns.
    if class.gap < 3 || class.sign != 0 {
        class.gap = 0;
    }
    Some(class)
}

impl Run {
    pub(super) fn new(codes: &[u8], token: Token) -> Self {
        let mut run = Self::whole(token.start, token.end, Kind::Hex, token.bytes());
        (run.style, run.first, run.last) = (token.style, token, token);
        run.note_decimal(codes, token);
        run
    }

    /// A run that is no list of tokens.
    pub(super) fn whole(start: usize, end: usize, kind: Kind, bytes: usize) -> Self {
        let token = Token { start, end, digits: Span { start, end }, style: Style::Bare };
        Self {
            start,
            end,
            kind,
            style: Style::Bare,
            bytes,
            tokens: 1,
            class: Class::default(),
            first: token,
            second: end,
            last: token,
            before_last: start,
            decimal: true,
            three: false,
        }
    }

    fn note_decimal(&mut self, codes: &[u8], token: Token) {
        let padded = token.len() > 1 && codes.get(token.digits.start) == Some(&b'0');
        self.decimal &= token.style == Style::Bare && !padded && decimal::byte(codes, token.digits).is_ok();
        self.three |= token.len() == 3;
    }

    /// Takes a token in; else gives the run that begins with it instead, and leaves in `self` what is before that run.
    pub(super) fn push(&mut self, codes: &[u8], token: Token, damaged: Option<Span>) -> Option<Self> {
        if self.kind != Kind::Hex || self.style != token.style {
            return Some(Self::new(codes, token));
        }
        let class = match damaged {
            None => class(codes, self.end, token.start),
            Some(Span { start, end }) => {
                class(codes, end, token.start).filter(|after| class(codes, self.end, start) == Some(*after))
            }
        };
        // Behind a sign, a word of many digits and a short number are columns of a table.
        let uneven = token.len() != self.last.len() && token.len().max(self.last.len()) > 3;
        let Some(class) = class.filter(|class| class.sign == 0 || !uneven) else {
            return Some(Self::new(codes, token));
        };
        if self.tokens == 1 && damaged.is_none() {
            self.class = class;
        } else if class != self.class {
            let mut run = Self::new(codes, token);
            // A number before the bytes is parted from them in a manner of its own.
            if self.tokens == 2 && damaged.is_none() {
                run = Self::new(codes, self.last);
                self.drop_last();
                run.push(codes, token, None);
            }
            return Some(run);
        }
        if self.tokens == 1 {
            self.second = token.start;
        }
        self.before_last = self.end;
        self.end = token.end;
        self.last = token;
        self.tokens += 1;
        self.bytes += token.bytes();
        self.note_decimal(codes, token);
        None
    }

    /// Takes pairs of digits in that follow with a space before and behind each: what most logs are made of.
    pub(super) fn push_plain(&mut self, codes: &[u8]) {
        if self.style != Style::Bare || self.tokens < 2 || self.class != Class::default() {
            return;
        }
        while let Some([b' ', high, low, b' ']) = codes.get(self.end..self.end + 4)
            && high.is_ascii_hexdigit()
            && low.is_ascii_hexdigit()
        {
            let start = self.end + 1;
            let token = Token { start, end: start + 2, digits: Span { start, end: start + 2 }, style: Style::Bare };
            self.before_last = self.end;
            self.end = token.end;
            self.last = token;
            self.tokens += 1;
            self.bytes += 1;
            if self.decimal {
                self.note_decimal(codes, token);
            }
        }
    }

    /// Takes the last token away; nothing is left of a run of one.
    pub(super) fn drop_last(&mut self) {
        self.end = self.before_last;
        self.tokens -= 1;
        self.bytes = self.bytes.saturating_sub(self.last.bytes());
    }

    fn drop_first(&mut self) {
        self.start = self.second;
        self.tokens -= 1;
        self.bytes = self.bytes.saturating_sub(self.first.bytes());
    }

    /// How much speaks for it beside another: more than its bytes where there is only a long number.
    fn weight(&self, codes: &[u8]) -> (usize, usize) {
        let number =
            self.kind == Kind::Hex && self.tokens == 1 && self.first.len() > 2 && is_decimal(codes, self.first);
        (if number { self.bytes / 2 } else { self.bytes }, self.tokens)
    }

    pub(super) fn is_better(&self, codes: &[u8], other: &Self) -> bool {
        let long = |run: &Self| run.kind == Kind::Hex && run.bytes >= rtu::MIN_ADU_LEN;
        if long(self) && long(other) {
            let whole = (self.is_frame(codes), other.is_frame(codes));
            if whole.0 != whole.1 {
                return whole.0;
            }
        }
        self.weight(codes) >= other.weight(codes)
    }

    /// Decides between hexadecimal and decimal numbers and leaves numbers at its ends out that are none of its bytes; `None`
    /// where nothing remains.
    pub(super) fn settle(mut self, codes: &[u8]) -> Option<Self> {
        if self.kind != Kind::Hex {
            return Some(self);
        }
        if self.decimal && self.tokens > 3 {
            let decimal = Self { kind: Kind::Decimal, bytes: self.tokens, ..self };
            if self.three || (decimal.is_frame(codes) && !self.is_frame(codes)) {
                return Some(decimal);
            }
        }
        let odd = |token: Token| token.len() > 1 && !token.len().is_multiple_of(2) && is_decimal(codes, token);
        if odd(self.last) {
            self.drop_last();
        }
        if self.tokens > 0 && self.start == self.first.start && odd(self.first) {
            self.drop_first();
        }
        if self.tokens == 0 {
            return None;
        }
        if self.tokens < 2 || self.is_frame(codes) {
            return Some(self);
        }
        // A number beside the bytes is as wide as they are or parted from them as they are, but not both.
        let mut shorter = self;
        let gap = |start: usize, end: usize| end.saturating_sub(start);
        if self.end == self.last.end
            && self.last.bytes() < 4
            && (self.last.len() != 2 || gap(self.before_last, self.last.start) > 1)
        {
            shorter.drop_last();
            if shorter.is_frame(codes) {
                return Some(shorter);
            }
        }
        if self.start == self.first.start
            && self.first.bytes() < 4
            && (self.first.len() != 2 || gap(self.first.end, self.second) > 1)
        {
            shorter.drop_first();
            if shorter.is_frame(codes) {
                return Some(shorter);
            }
            let mut tail = self;
            tail.drop_first();
            if tail.is_frame(codes) {
                return Some(tail);
            }
        }
        Some(self)
    }

    /// Whether it looks like bytes even among words: one by one, or in a long word, or with a right check.
    pub(super) fn is_convincing(&self, codes: &[u8]) -> bool {
        let (one_by_one, word) = (self.tokens > 3 && self.bytes == self.tokens, self.tokens == 1 && self.bytes > 5);
        self.kind != Kind::Hex || one_by_one || word || self.is_frame(codes)
    }

    /// Whether its bytes are an RTU frame with a right check.
    pub(super) fn is_frame(&self, codes: &[u8]) -> bool {
        let numbers = matches!(self.kind, Kind::Hex | Kind::Decimal);
        if !numbers || self.bytes < rtu::MIN_ADU_LEN || self.bytes > rtu::MAX_ADU_LEN {
            return false;
        }
        let mut bytes = Vec::with_capacity(self.bytes);
        let mut tokens = Tokens::new(codes, *self);
        while let Some(token) = tokens.next() {
            let Ok(digits) = token else { return false };
            if self.kind == Kind::Decimal {
                bytes.extend(decimal::byte(codes, digits));
                continue;
            }
            match codes.get(digits.start..digits.end).unwrap_or_default() {
                [digit] => bytes.push(hex::value(*digit)),
                digits if !digits.len().is_multiple_of(2) => return false,
                digits => bytes
                    .extend(digits.as_chunks().0.iter().map(|[high, low]| hex::value(*high) << 4 | hex::value(*low))),
            }
        }
        rtu::decode(&bytes).is_ok()
    }
}

fn is_decimal(codes: &[u8], token: Token) -> bool {
    codes.get(token.digits.start..token.digits.end).is_some_and(|digits| digits.iter().all(u8::is_ascii_digit))
}

/// The numbers of a run once more: their digits, or the column of what is none.
pub(super) struct Tokens<'a> {
    codes: &'a [u8],
    at: usize,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(codes: &'a [u8], run: Run) -> Self {
        Self { codes: codes.get(..run.end).unwrap_or_default(), at: run.start }
    }

    pub(super) fn next(&mut self) -> Option<Result<Span, usize>> {
        let rest = self.codes.get(self.at..)?;
        // What most runs are made of.
        if let [b' ', high, low, b' ', ..] = rest
            && high.is_ascii_hexdigit()
            && low.is_ascii_hexdigit()
        {
            self.at += 3;
            return Some(Ok(Span { start: self.at - 2, end: self.at }));
        }
        let gap = rest.iter().take_while(|code| !code.is_ascii_alphanumeric()).count();
        let mut start = self.at + gap;
        // The letter of `&H01`.
        if matches!(rest.get(..gap), Some([.., b'&'])) {
            start += 1;
        }
        let word = self.codes.get(start..).unwrap_or_default();
        let len = word.iter().take_while(|code| !is_space(**code) && code.is_ascii_alphanumeric()).count();
        let word = word.get(..len).filter(|word| !word.is_empty())?;
        self.at = start + len;
        Some(match hex::number(word) {
            Some((digits, _)) => Ok(Span { start: start + digits.start, end: start + digits.end }),
            None => Err(start),
        })
    }
}
