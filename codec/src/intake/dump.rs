//! Hex dumps: rows of an offset, bytes and, mostly, the same bytes as text. Offset and text never become bytes.

use alloc::vec::Vec;

use super::line::{Line, hex_digits, is_space, spaces};
use super::output::Output;
use super::{IntakeFault, hex};
use crate::dissect::Direction;

/// Bytes that repeated rows may add to a text, all together.
const MOST_REPEATED: usize = 16 << 20;

/// What a group of digits is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    /// Bytes in their order: `xxd`, `hexdump -C`, `od -t x1`, Wireshark.
    Bytes,
    /// 16-bit numbers of a little-endian machine: `hexdump` without options.
    Words,
}

/// What the rows so far tell of the next.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    hex: hex::State,
    /// The last row: digits of its offset as numbers of each radix, and its bytes.
    offset: Option<Offset>,
    row: Vec<u8>,
    radix: Radix,
    /// A `*` stands between the last row and the next.
    repeat: bool,
    repeated: usize,
    /// The high byte of the last word: padding if the dump ends within the word.
    held: Option<u8>,
    /// Bytes up to the end of the last row, from its dump's first offset.
    len: usize,
    first: Option<Offset>,
}

impl State {
    pub(super) fn finish(&mut self, output: &mut Output) {
        output.bytes.extend(self.held.take());
    }
}

/// The radix of offsets, once rows have shown it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Radix {
    #[default]
    Unknown,
    Octal,
    Decimal,
    Hex,
}

/// The digits of an offset, read in each radix; `None` where a digit does not fit or the number is too large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Offset {
    octal: Option<usize>,
    decimal: Option<usize>,
    hex: Option<usize>,
    digits: usize,
}

impl Offset {
    fn read(digits: &[u8]) -> Self {
        let value = |radix: u32| {
            digits.iter().try_fold(0usize, |value, code| {
                let digit = usize::try_from(char::from(*code).to_digit(radix)?).ok()?;
                value.checked_mul(usize::try_from(radix).ok()?)?.checked_add(digit)
            })
        };
        Self { octal: value(8), decimal: value(10), hex: value(16), digits: digits.len() }
    }

    fn since(self, before: Self, radix: Radix) -> Option<usize> {
        let (now, before) = match radix {
            Radix::Octal => (self.octal, before.octal),
            Radix::Decimal => (self.decimal, before.decimal),
            Radix::Hex | Radix::Unknown => (self.hex, before.hex),
        };
        now?.checked_sub(before?)
    }
}

/// Whether the offsets of two rows fit the bytes of the first.
pub(super) fn follows(codes: &[u8], row: &Row, before: &[u8], row_before: &Row) -> bool {
    let (now, before) = (row.offset(codes), row_before.offset(before));
    [Radix::Octal, Radix::Decimal, Radix::Hex]
        .into_iter()
        .any(|radix| now.since(before, radix) == Some(row_before.bytes))
}

pub(super) fn line(line: &Line, unit: Unit, state: &mut State, output: &mut Output) {
    let codes = line.codes;
    if codes.trim_ascii() == b"*" {
        state.repeat = true;
        return;
    }
    let Some(row) = Row::find(codes) else {
        // A title, or bytes without an offset.
        let mut lexer = hex::Lexer::new(codes, false);
        let mut lexemes = core::iter::from_fn(|| lexer.next());
        if lexemes.all(|lexeme| matches!(lexeme, hex::Lexeme::Number(..))) {
            hex::line(line, &mut state.hex, output);
        }
        return;
    };
    let offset = row.offset(codes);
    state.learn_radix(offset, &row);
    if row.bytes == 0 {
        let total = state.first.and_then(|first| offset.since(first, state.radix));
        if total.is_some_and(|total| total < state.len) {
            state.held = None;
        }
    }
    state.finish(output);
    if core::mem::take(&mut state.repeat) {
        state.repeat(line, offset, output);
    }
    let start = output.bytes.len();
    row.decode(line, output);
    let row_bytes = output.bytes.get_mut(start..).unwrap_or_default();
    if unit == Unit::Words && row.group == 4 {
        row_bytes.as_chunks_mut::<2>().0.iter_mut().for_each(|word| word.reverse());
    }
    state.row.clear();
    state.row.extend_from_slice(row_bytes);
    if row.bytes == 0 || offset.hex == Some(0) || state.first.is_none() {
        state.first = Some(offset);
        state.len = 0;
    }
    state.len += row.bytes;
    state.offset = Some(offset);
    output.close(start, line.number, Direction::Unknown, None);
    if unit == Unit::Words && row.group == 4 {
        state.held = output.bytes.pop();
    }
}

impl State {
    fn learn_radix(&mut self, offset: Offset, row: &Row) {
        if let Some(before) = self.offset
            && !self.repeat
            && !self.row.is_empty()
        {
            let fits = |radix: &Radix| offset.since(before, *radix) == Some(self.row.len());
            if let Some(radix) = [Radix::Hex, Radix::Octal, Radix::Decimal].into_iter().find(fits) {
                self.radix = radix;
            }
        } else if self.radix == Radix::Unknown && offset.digits == 7 && row.group == 2 {
            // `od`; `hexdump` has as many digits before words and eight before bytes.
            self.radix = Radix::Octal;
        }
    }

    /// Writes the last row again up to an offset.
    fn repeat(&mut self, line: &Line, offset: Offset, output: &mut Output) {
        let row = self.row.len();
        let Some(gap) = self.offset.and_then(|before| offset.since(before, self.radix)) else { return };
        let missing = gap.saturating_sub(row);
        if row == 0 || missing == 0 {
            return;
        }
        self.repeated = self.repeated.saturating_add(missing);
        if self.repeated > MOST_REPEATED {
            output.fault(line, 0, IntakeFault::RepeatTooLong);
            return;
        }
        let start = output.bytes.len();
        output.bytes.extend(self.row.iter().cycle().take(missing));
        self.len += missing;
        output.close(start, line.number, Direction::Unknown, None);
    }
}

/// The places of a row's parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Row {
    offset: hex::Span,
    data: hex::Span,
    /// Digits of a group: two for a byte, four for a word.
    pub(super) group: usize,
    /// How many bytes stand there.
    pub(super) bytes: usize,
    /// Whether more than a space parts the offset from the bytes.
    pub(super) marked: bool,
    /// Whether something follows the bytes.
    pub(super) text: bool,
}

impl Row {
    /// Finds the parts of a row; `None` where it does not begin with an offset.
    pub(super) fn find(codes: &[u8]) -> Option<Self> {
        let mut at = spaces(codes, 0);
        if codes.get(at) == Some(&b'|') {
            at += 1 + spaces(codes, at + 1);
        }
        if codes.get(at..)?.starts_with(b"0x") {
            at += 2;
        }
        let digits = hex_digits(codes, at);
        if !(4..=16).contains(&digits) {
            return None;
        }
        let offset = hex::Span { start: at, end: at + digits };
        at = offset.end + usize::from(matches!(codes.get(offset.end), Some(b'h' | b'H')));
        let gap = spaces(codes, at);
        at += gap;
        let sign = matches!(codes.get(at), Some(b':' | b'|'));
        if sign {
            at += 1;
            at += spaces(codes, at);
        } else if gap == 0 && at < codes.len() {
            return None;
        }
        let mut row = Self {
            offset,
            data: hex::Span { start: at, end: at },
            group: 0,
            bytes: 0,
            marked: sign || gap > 1,
            text: false,
        };
        row.find_data(codes, at);
        (row.bytes > 0 || row.data.start >= codes.len()).then_some(row)
    }

    fn find_data(&mut self, codes: &[u8], at: usize) {
        let mut at = at;
        loop {
            let digits = hex_digits(codes, at);
            let fits = if self.bytes == 0 {
                matches!(digits, 2 | 4 | 8 | 16 | 32)
            } else {
                digits > 0 && digits <= self.group
            };
            let after = codes.get(at + digits);
            if !fits
                || !digits.is_multiple_of(2)
                || !after.is_none_or(|code| is_space(*code) || matches!(code, b'|' | b'-'))
            {
                break;
            }
            if self.bytes == 0 {
                self.group = digits;
            }
            self.bytes += digits / 2;
            at += digits;
            self.data.end = at;
            let gap = spaces(codes, at);
            let half = self.bytes == 8 && self.group == 2;
            match codes.get(at + gap) {
                Some(b'-') if half && gap == 0 => at += 1,
                // Behind the bytes stands their text, further off than a byte from the next; a row may have a gap in its middle.
                Some(b'|') => break,
                _ if gap == 1 || (gap == 2 && half) => at += gap,
                _ => break,
            }
        }
        self.text = codes.iter().skip(self.data.end).any(|code| !is_space(*code));
    }

    fn offset(&self, codes: &[u8]) -> Offset {
        Offset::read(codes.get(self.offset.start..self.offset.end).unwrap_or_default())
    }

    /// Whether it is the first of a dump.
    pub(super) fn is_first(&self, codes: &[u8]) -> bool {
        self.offset(codes).hex == Some(0)
    }

    /// Writes its bytes.
    pub(super) fn decode(&self, line: &Line, output: &mut Output) {
        let mut at = self.data.start;
        while at < self.data.end {
            let digits = hex_digits(line.codes, at);
            hex::digits(line, at, at + digits, output);
            at += digits.max(1);
            at += line.codes.iter().skip(at).take_while(|code| !code.is_ascii_hexdigit()).count();
        }
    }
}
