//! How a text is read, and how to tell.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::dump::{self, Row};
use super::hex::{self, Lexeme, Lexer};
use super::line::{Line, spaces};
use super::{ascii, decimal, log};
use crate::rtu;

/// How a text is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Form {
    /// Hexadecimal bytes in any spelling: with or without separators, prefixes and suffixes, as arrays and strings of
    /// programs, with comments. A line that is a frame of ASCII mode is read as one.
    Hex,
    /// Decimal numbers from 0 to 255, or down to -128.
    Decimal,
    /// Frames of ASCII mode: a line that begins with a colon is one, whatever it holds.
    AsciiFrames,
    /// Lines with bytes beside time stamps, marks of direction, counters and words, of whatever tool.
    Log,
    /// Rows of an offset, bytes and their text.
    HexDump,
    /// The same with 16-bit numbers of a little-endian machine instead of bytes, as `hexdump` prints without options.
    WordDump,
    /// A session that was saved, with everything that its log told.
    Session,
}

impl Form {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Hex, Self::Decimal, Self::AsciiFrames, Self::Log, Self::HexDump, Self::WordDump, Self::Session];

    /// A name that does not change: `hex`, `decimal`, `ascii_frames`, `log`, `hex_dump`, `word_dump`, `session`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hex => "hex",
            Self::Decimal => "decimal",
            Self::AsciiFrames => "ascii_frames",
            Self::Log => "log",
            Self::HexDump => "hex_dump",
            Self::WordDump => "word_dump",
            Self::Session => "session",
        }
    }
}

/// What a text looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Detection {
    /// The best reading.
    pub form: Form,
    /// Another sensible one.
    pub alternative: Option<Form>,
}

/// Bytes of a text that are looked at.
const SAMPLE_LEN: usize = 64 << 10;

/// Tells how a text is best read, from its first 64 KiB. A text that holds nothing is hexadecimal.
pub fn detect(sample: &str) -> Detection {
    if crate::session::is_session(sample) {
        return Detection { form: Form::Session, alternative: None };
    }
    let mut sight = Sight::default();
    let mut room = Vec::new();
    for text in head(sample).split(['\n', '\r']) {
        let line = Line::new(text, 1, &mut room);
        if !line.is_blank() && !line.is_raw() {
            sight.see(line.codes);
        }
    }
    sight.judge()
}

/// The whole lines that fit the sample; the beginning of the first if none does.
fn head(text: &str) -> &str {
    if text.len() <= SAMPLE_LEN {
        return text;
    }
    let end = (0..=SAMPLE_LEN).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    let head = text.get(..end).unwrap_or_default();
    head.rfind(['\n', '\r']).and_then(|end| head.get(..end)).unwrap_or(head)
}

/// What has been seen of a text.
#[derive(Default)]
struct Sight {
    /// Lines of bytes with marks of direction, time stamps or words; lines of words only.
    logged: usize,
    words: usize,
    /// Lines of a frame and a number or two beside it.
    numbered: usize,
    /// Lines of a program.
    code: usize,
    /// Lines of marks that may tell of bytes below them.
    headings: usize,
    ascii: usize,
    /// Lines of nothing but numbers.
    numbers: usize,
    rows: Rows,
    decimals: Decimals,
    comment: bool,
}

#[derive(Default)]
struct Rows {
    last: Option<(Vec<u8>, Row)>,
    count: usize,
    /// Rows whose offset fits the row before; a `*` counts as well.
    chained: usize,
    /// The first row begins at offset 0, apart from its bytes.
    first: bool,
    words: usize,
}

/// Whether numbers may be decimal.
struct Decimals {
    possible: bool,
    /// Numbers of two digits, of three, with a zero in front, below zero.
    two: usize,
    three: usize,
    padded: usize,
    negative: usize,
    /// A program's list of numbers with commas.
    listed: bool,
    /// The first numbers in both readings.
    as_hex: Vec<u8>,
    as_decimal: Vec<u8>,
    count: usize,
}

impl Default for Decimals {
    fn default() -> Self {
        Self {
            possible: true,
            two: 0,
            three: 0,
            padded: 0,
            negative: 0,
            listed: false,
            as_hex: Vec::new(),
            as_decimal: Vec::new(),
            count: 0,
        }
    }
}

impl Sight {
    fn see(&mut self, codes: &[u8]) {
        if self.rows.see(codes) {
            return;
        }
        if ascii::is_frame(codes, spaces(codes, 0)) {
            self.ascii += 1;
            return;
        }
        let mut lexer = Lexer::new(codes, self.comment);
        let code = is_code(codes, lexer.at);
        let (mut numbers, mut strays) = (0usize, 0usize);
        let listed = codes.contains(&b',') && (code || matches!(codes.trim_ascii_start().first(), Some(b'[' | b'{')));
        self.decimals.listed |= listed;
        while let Some(lexeme) = lexer.next() {
            match lexeme {
                Lexeme::Number(digits, hex) => {
                    numbers += 1;
                    self.decimals.see(codes, digits, hex);
                }
                Lexeme::Literal(_) => numbers += 1,
                Lexeme::Stray(_) => strays += 1,
            }
        }
        self.comment = lexer.comment;
        let look = log::look(codes);
        // Words in comments make no log.
        let commented = numbers > 0 && lexer.commented && look != log::Look::Heading;
        if strays == 0 && look != log::Look::Stamped && (code || commented) {
            self.numbers += usize::from(numbers > 0);
            self.code += usize::from(code);
            return;
        }
        match look {
            log::Look::Stamped | log::Look::Logged => self.logged += 1,
            log::Look::Heading if strays + numbers > 0 => self.headings += 1,
            log::Look::Words if strays > 0 && strays >= numbers => self.words += 1,
            _ => {
                // Line numbers and lengths beside frames.
                let beside = log::framed(codes).map_or(0, |framed| numbers.saturating_sub(framed));
                self.numbered += usize::from((1..=2).contains(&beside));
                self.numbers += usize::from(numbers + strays > 0);
                self.decimals.possible &= strays == 0;
            }
        }
    }

    fn judge(mut self) -> Detection {
        let only = |form| Detection { form, alternative: None };
        let rows = &self.rows;
        let dump = rows.chained > 0 || rows.first;
        if self.logged > 0 || self.headings > 0 && self.numbers + rows.count > 0 {
            return only(Form::Log);
        }
        if dump {
            return if rows.words == rows.count {
                Detection { form: Form::WordDump, alternative: Some(Form::HexDump) }
            } else {
                only(Form::HexDump)
            };
        }
        if rows.count > 0 {
            self.numbers += rows.count;
            self.decimals.possible = false;
        }
        if self.ascii > 0 {
            return only(if self.numbers == 0 { Form::AsciiFrames } else { Form::Hex });
        }
        if self.numbers == 0 && self.words + self.headings > 0 {
            return only(Form::Log);
        }
        let decimals = &self.decimals;
        if self.code == 0 && (self.words > 0 || self.numbered * 2 > self.numbers) && !decimals.is_certain() {
            return Detection { form: Form::Log, alternative: Some(Form::Hex) };
        }
        if decimals.is_certain() {
            return Detection { form: Form::Decimal, alternative: (decimals.three == 0).then_some(Form::Hex) };
        }
        let ambiguous = decimals.possible && decimals.two > 0 && decimals.padded == 0 && self.words == 0;
        Detection { form: Form::Hex, alternative: ambiguous.then_some(Form::Decimal) }
    }
}

impl Rows {
    /// Takes a row of a dump in; says whether the line was one.
    fn see(&mut self, codes: &[u8]) -> bool {
        if codes.trim_ascii() == b"*" && self.last.is_some() {
            self.chained += 1;
            self.last = None;
            return true;
        }
        let Some(row) = Row::find(codes) else { return false };
        if self.last.as_ref().is_some_and(|(before, row_before)| dump::follows(codes, &row, before, row_before)) {
            self.chained += 1;
        } else if row.bytes == 0 {
            // Digits alone: a frame in one word.
            return self.chained > 0;
        }
        self.first |= self.count == 0 && row.marked && row.is_first(codes);
        if row.bytes > 0 {
            self.count += 1;
            self.words += usize::from(row.group == 4 && !row.marked && !row.text);
        }
        self.last = Some((codes.to_vec(), row));
        true
    }
}

impl Decimals {
    fn see(&mut self, codes: &[u8], digits: hex::Span, hex: bool) {
        let text = codes.get(digits.start..digits.end).unwrap_or_default();
        let (false, Ok(byte), 1..=3) = (hex, decimal::byte(codes, digits), text.len()) else {
            self.possible = false;
            return;
        };
        self.count += 1;
        self.two += usize::from(text.len() == 2);
        self.three += usize::from(text.len() == 3);
        self.padded += usize::from(text.len() > 1 && text.first() == Some(&b'0'));
        self.negative += usize::from(decimal::is_negative(codes, digits.start));
        if self.as_hex.len() < rtu::MAX_ADU_LEN {
            self.as_hex.push(text.iter().fold(0, |value, digit| value << 4 | hex::value(*digit)));
            self.as_decimal.push(byte);
        }
    }

    /// No other reading makes sense.
    fn is_certain(&self) -> bool {
        let framed = || rtu::decode(&self.as_decimal).is_ok() && rtu::decode(&self.as_hex).is_err();
        let plain = self.padded == 0 && (self.three > 0 || self.negative > 0 || self.listed || framed());
        self.possible && self.count > 1 && (plain || self.three == self.count)
    }
}

/// Whether a line, whose bytes begin at `at`, is one of a program rather than a remark with brackets.
fn is_code(codes: &[u8], at: usize) -> bool {
    let comment = codes.windows(2).position(|pair| pair == b"//" || pair == b"# " || pair == b"/*");
    let body = codes.get(..comment.unwrap_or(codes.len())).unwrap_or_default();
    at > 0
        && matches!(
            body.trim_ascii_end().last(),
            Some(b')' | b']' | b'}' | b';' | b',' | b'{' | b'[' | b'(' | b'"' | b'\'')
        )
}
