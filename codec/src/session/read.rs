//! Reading a session, line by line.

use alloc::string::String;

use super::{Remark, TITLE, Told};
use crate::dissect::Direction;
use crate::intake::IntakeFault;
use crate::line::{DataBits, LineSettings, Mode, Parity, StopBits};
use crate::segment::{Event, Origin, Segment};

/// Whether a text begins as a session of any version does.
pub(crate) fn is_session(text: &str) -> bool {
    let title = TITLE.trim_end_matches(|character: char| character.is_ascii_digit());
    text.trim_start_matches(['\u{FEFF}', ' ', '\t', '\r', '\n']).starts_with(title)
}

/// What a line holds, besides bytes.
pub(crate) enum Read {
    /// Nothing.
    Nothing,
    /// Something before what comes.
    Told(Told),
    /// An entry, whose bytes have been written, with its mark. Its start and its line are not set.
    Entry(Segment, Option<String>),
}

/// A place in a line that makes no sense: bytes of the line before it, and what is wrong.
pub(crate) type Fault = (usize, IntakeFault);

/// Reads a line, counted from 1. Bytes of an entry are added to `bytes`, none if there is a fault.
pub(crate) fn line(text: &str, number: usize, bytes: &mut impl Extend<u8>) -> Result<Read, Fault> {
    let mut words = Words { text, at: 0 };
    let (at, first) = words.next();
    match first {
        "" => return Ok(Read::Nothing),
        _ if first.starts_with('#') || (number == 1 && is_session(text)) => return Ok(Read::Nothing),
        "epoch" => return words.number().map(|us| Read::Told(Told::Epoch(us))),
        "line" => return words.line_settings().map(|(line, mode)| Read::Told(Told::Line(line, mode))),
        _ => {}
    }
    let time_us = if first == "-" { None } else { Some(microseconds(first).ok_or(words.unexpected(at))?) };
    let (at, second) = words.next();
    if let Some(span_us) = microseconds(second) {
        let span_us = u32::try_from(span_us).map_err(|_| words.unexpected(at))?;
        return words.entry(time_us, span_us, bytes);
    }
    let event = match second {
        "error" => Event::LineError,
        "closed" => Event::Closed,
        "lost" => Event::Lost,
        "break" => {
            let at = words.at;
            Event::Break(u32::try_from(words.number()?).map_err(|_| words.unexpected(at))?)
        }
        "forgotten" => Event::Forgotten(words.number()?),
        "opened" => words.line_settings().map(|(line, mode)| Event::Opened(line, mode))?,
        _ => return Err(words.unexpected(at)),
    };
    Ok(Read::Told(Told::Event { at_us: time_us.unwrap_or(0), event }))
}

impl Remark {
    pub(crate) fn new(at: usize, told: Told) -> Self {
        Self { at, told }
    }
}

/// Goes through the words of a line.
struct Words<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Words<'a> {
    /// The next word and its place; an empty one at the end.
    fn next(&mut self) -> (usize, &'a str) {
        let rest = self.text.get(self.at..).unwrap_or_default();
        let space = |character: char| matches!(character, ' ' | '\t' | '\u{FEFF}');
        let word = rest.trim_start_matches(space);
        let start = self.at + (rest.len() - word.len());
        let word = word.split(space).next().unwrap_or_default();
        self.at = start + word.len();
        (start, word)
    }

    fn unexpected(&self, at: usize) -> Fault {
        let character = self.text.get(at..).and_then(|rest| rest.chars().next());
        (at, IntakeFault::Unexpected(character.unwrap_or(' ')))
    }

    fn number(&mut self) -> Result<u64, Fault> {
        let (at, word) = self.next();
        whole(word).ok_or(self.unexpected(at))
    }

    /// As in `9600 8E1 rtu`.
    fn line_settings(&mut self) -> Result<(LineSettings, Mode), Fault> {
        let (at, baud) = self.next();
        let baud = whole(baud).and_then(|baud| u32::try_from(baud).ok()).filter(|baud| *baud > 0);
        let baud = baud.ok_or(self.unexpected(at))?;
        let (at, character) = self.next();
        let [data_bits, parity, stop_bits] = *character.as_bytes() else { return Err(self.unexpected(at)) };
        let data_bits = match data_bits {
            b'7' => DataBits::Seven,
            b'8' => DataBits::Eight,
            _ => return Err(self.unexpected(at)),
        };
        let parity = match parity {
            b'N' => Parity::None,
            b'O' => Parity::Odd,
            b'E' => Parity::Even,
            _ => return Err(self.unexpected(at)),
        };
        let stop_bits = match stop_bits {
            b'1' => StopBits::One,
            b'2' => StopBits::Two,
            _ => return Err(self.unexpected(at)),
        };
        let (at, mode) = self.next();
        let mode = match mode {
            "rtu" => Mode::Rtu,
            "ascii" => Mode::Ascii,
            _ => return Err(self.unexpected(at)),
        };
        Ok((LineSettings { baud, data_bits, parity, stop_bits }, mode))
    }

    /// From the mark of direction on.
    fn entry(&mut self, time_us: Option<u64>, span_us: u32, bytes: &mut impl Extend<u8>) -> Result<Read, Fault> {
        let (at, way) = self.next();
        let direction = match way {
            "TX" => Direction::Request,
            "RX" => Direction::Response,
            "??" => Direction::Unknown,
            _ => return Err(self.unexpected(at)),
        };
        let (at, name) = self.next();
        let origin = Origin::ALL.into_iter().find(|origin| origin.name() == name).ok_or(self.unexpected(at))?;
        let before = self.at;
        let mode = if self.next().1 == "ascii" { Mode::Ascii } else { Mode::Rtu };
        if mode == Mode::Rtu {
            self.at = before;
        }
        let start = self.at;
        let (mut count, mut mark) = (0usize, None);
        // All of it is looked at before any of it is taken.
        loop {
            match self.next() {
                (_, "") => break,
                (_, "*") => {
                    mark = Some(self.quoted()?);
                    break;
                }
                (at, word) => {
                    byte(word).ok_or(self.unexpected(at))?;
                    count += 1;
                }
            }
        }
        if count == 0 {
            return Err(self.unexpected(start));
        }
        let mut again = Words { text: self.text, at: start };
        bytes.extend((0..count).filter_map(|_| byte(again.next().1)));
        let segment = Segment { mode, direction, time_us, span_us, origin, whole: true, ..Segment::default() };
        Ok(Read::Entry(segment, mark))
    }

    /// A text between quotes, up to the end of the line.
    fn quoted(&mut self) -> Result<String, Fault> {
        let rest = self.text.get(self.at..).unwrap_or_default();
        let start = self.text.len() - rest.trim_start_matches([' ', '\t']).len();
        let body = self.text.get(start..).and_then(|rest| rest.strip_prefix('"')).ok_or(self.unexpected(start))?;
        let mut text = String::new();
        let mut characters = body.char_indices();
        while let Some((place, character)) = characters.next() {
            let at = start + 1 + place;
            match character {
                '"' => {
                    let rest = characters.as_str();
                    let stray = self.text.len() - rest.trim_start().len();
                    return if rest.trim().is_empty() { Ok(text) } else { Err(self.unexpected(stray)) };
                }
                '\\' => match characters.next() {
                    Some((_, 'n')) => text.push('\n'),
                    Some((_, 'r')) => text.push('\r'),
                    Some((_, 't')) => text.push('\t'),
                    Some((_, escaped @ ('"' | '\\'))) => text.push(escaped),
                    Some((_, 'u')) => {
                        let code = characters.as_str().strip_prefix('{').and_then(|rest| rest.split_once('}'));
                        let found = code.and_then(|(digits, _)| {
                            let number = u32::from_str_radix(digits, 16).ok()?;
                            Some((char::from_u32(number)?, digits.len() + 2))
                        });
                        let (character, length) = found.ok_or(self.unexpected(at))?;
                        text.push(character);
                        // Braces and digits are a byte each.
                        characters.nth(length - 1);
                    }
                    _ => return Err(self.unexpected(at)),
                },
                _ => text.push(character),
            }
        }
        Err(self.unexpected(self.text.len()))
    }
}

/// Seconds with up to six decimals.
fn microseconds(word: &str) -> Option<u64> {
    let (seconds, decimals) = word.split_once('.')?;
    if decimals.is_empty() || decimals.len() > 6 {
        return None;
    }
    let scale = (decimals.len()..6).fold(1, |scale, _| scale * 10);
    whole(seconds)?.checked_mul(1_000_000)?.checked_add(whole(decimals)? * scale)
}

/// A number of decimal digits and nothing else.
fn whole(word: &str) -> Option<u64> {
    word.bytes().all(|digit| digit.is_ascii_digit()).then(|| word.parse().ok()).flatten()
}

/// Two hexadecimal digits.
fn byte(word: &str) -> Option<u8> {
    let digit = |code: u8| char::from(code).to_digit(16).and_then(|value| u8::try_from(value).ok());
    let [high, low] = *word.as_bytes() else { return None };
    Some(digit(high)? << 4 | digit(low)?)
}
