//! The search for the parts of a line.

use super::super::hex::{self, Span};
use super::super::line::{COUNT, LENGTH, hex_digits};
use super::super::{ascii, literal};
use super::mark::{self, Mark};
use super::run::{Kind, Run, Style, Token};
use super::time::{Stamp, stamp};
use crate::dissect::Direction;
use crate::rtu;

/// The parts of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) direction: Direction,
    /// A mark stands in the line.
    pub(super) marked: bool,
    /// The mark is a word that remarks have as well.
    pub(super) common: bool,
    pub(super) time_us: Option<u64>,
    /// What may be the bytes.
    pub(super) run: Option<Run>,
    /// Another run that is a frame with a right check: a line may hold a request and its response.
    pub(super) other: Option<Run>,
    /// What a mark between the two, other than a common word or an arrow, says of the second.
    pub(super) second: Direction,
    /// Words that are neither marks nor say what bytes these are.
    pub(super) words: usize,
    pub(super) words_since_mark: usize,
    /// Where the mark ends.
    pub(super) mark_end: Option<usize>,
    /// The word is there that libmodbus has for a request that it waits for.
    pub(super) indication: bool,
}

impl Found {
    /// Whether only the brackets around the bytes tell their direction.
    pub(super) fn is_bracketed(&self) -> bool {
        !self.marked && self.direction != Direction::Unknown
    }

    /// Whether the bytes stand in the angle brackets that only libmodbus prints.
    pub(super) fn is_angled(&self) -> bool {
        self.run.is_some_and(|run| run.style == Style::Angle && run.tokens > 2)
    }
}

pub(super) fn scan(codes: &[u8]) -> Found {
    let mut scan = Scan {
        codes,
        at: 0,
        escapes: codes.contains(&b'\\'),
        current: None,
        damaged: None,
        before: None,
        behind: None,
        mark: None,
        late: None,
        other: None,
        mark_end: None,
        day_us: None,
        time_us: None,
        words: 0,
        words_since_mark: 0,
        tag_end: None,
        skip_count: false,
        indication: false,
    };
    while scan.at < codes.len() {
        scan.step();
    }
    scan.finish()
}

struct Scan<'a> {
    codes: &'a [u8],
    at: usize,
    /// There is a backslash somewhere.
    escapes: bool,
    current: Option<Run>,
    /// What stands where a byte should, since the current run's last token.
    damaged: Option<Span>,
    /// The best run before the mark, and behind it.
    before: Option<Run>,
    behind: Option<Run>,
    mark: Option<Mark>,
    /// A mark behind the bytes.
    late: Option<Mark>,
    other: Option<Run>,
    mark_end: Option<usize>,
    day_us: Option<u64>,
    time_us: Option<u64>,
    words: usize,
    words_since_mark: usize,
    /// Where the `>` of a `<` stands.
    tag_end: Option<usize>,
    /// A word says that a count comes next.
    skip_count: bool,
    indication: bool,
}

impl Scan<'_> {
    fn step(&mut self) {
        let at = self.at;
        let Some(code) = self.codes.get(at).copied() else { return };
        self.at += 1;
        match code {
            b'0'..=b'9' | b'a'..=b'z' | b'A'..=b'Z' | b'_' => self.word(at),
            b'[' | b'<' => self.bracket(at, code),
            b'>' if self.tag_end != Some(at) => {
                self.at += self.codes.iter().skip(at).take_while(|code| **code == b'>').count() - 1;
                self.mark(mark::sign(true));
            }
            b':' if ascii::is_frame(self.codes, at) => self.frame(at),
            b'"' | b'\'' if self.escapes => {
                if let Some((end, true)) = literal::quoted(self.codes, at) {
                    self.take(Run::whole(at + 1, end, Kind::Literal, end - at - 1));
                    self.at = end + 1;
                }
            }
            b'\\' if matches!(self.codes.get(at + 1), Some(b'x' | b'X')) && hex_digits(self.codes, at + 2) == 2 => {
                self.token(at, at + 4, Span { start: at + 2, end: at + 4 }, Style::Escape);
                self.at = at + 4;
            }
            0x80.. => self.characters(at),
            _ => {}
        }
    }

    fn word(&mut self, at: usize) {
        let rest = self.codes.get(at..).unwrap_or_default();
        let before = at.checked_sub(1).and_then(|at| self.codes.get(at)).copied().unwrap_or(b' ');
        if rest.first().is_some_and(u8::is_ascii_digit)
            && !matches!(before, b'.' | b'-' | b'+')
            && let Some((stamp, end)) = stamp(self.codes, at)
        {
            return self.stamp(stamp, end);
        }
        let len = rest.iter().take_while(|code| code.is_ascii_alphanumeric() || **code == b'_').count();
        let word = rest.get(..len).unwrap_or_default();
        let end = at + len;
        self.at = end;
        let joined = |code: u8| matches!(code, b'.' | b'/' | b'@' | b'+' | b'~');
        let is_word = |at: usize| self.codes.get(at).is_some_and(u8::is_ascii_alphanumeric);
        let after = self.codes.get(end).copied().unwrap_or(b' ');
        if joined(before) && at >= 2 && is_word(at - 2) || joined(after) && is_word(end + 1) {
            // An address, a path, a number with a fraction.
            self.count_word(word);
            return;
        }
        if matches!(word, b"b" | b"rb") && matches!(after, b'"' | b'\'') {
            return;
        }
        let ampersand = before == b'&' && word.first().is_some_and(|code| matches!(code, b'H' | b'h'));
        let skipped = usize::from(ampersand);
        match hex::number(word.get(skipped..).unwrap_or_default()) {
            Some((digits, hex)) => {
                let style = match (before, hex) {
                    (b'$' | b'#' | b'%' | b'&', _) => Style::Prefix,
                    (_, true) if digits.start == 0 && digits.end < len => Style::Suffix,
                    (_, true) => Style::Prefix,
                    _ => Style::Bare,
                };
                let start = if style == Style::Prefix && digits.start == 0 { at.saturating_sub(1) } else { at };
                let at = at + skipped;
                let digits = Span { start: at + digits.start, end: at + digits.end };
                if !core::mem::take(&mut self.skip_count) && !self.is_counter(digits) {
                    self.token(start, end, digits, style);
                }
            }
            None => self.named(at, end, word),
        }
    }

    /// A number with leading zeros and a dash before the first byte: `000012-01 03`.
    fn is_counter(&self, Span { start, end }: Span) -> bool {
        let digits = hex_digits(self.codes, end + 1);
        end - start >= 4
            && self.codes.get(end) == Some(&b'-')
            && digits == 2
            && self.codes.get(end + 3) != Some(&b'-')
            && self.codes.get(start..end).is_some_and(|digits| digits.iter().all(u8::is_ascii_digit))
    }

    /// A word that is no number.
    fn named(&mut self, at: usize, end: usize, word: &[u8]) {
        self.skip_count = false;
        if let Some(mark) = mark::word(word) {
            self.mark(mark);
            return;
        }
        if matches!(word, [a, b] if a.is_ascii_digit() != b.is_ascii_digit()) && self.current.is_some() {
            // A byte of which one digit is spoilt, if bytes follow.
            let start = self.damaged.map_or(at, |damaged| damaged.start);
            self.damaged = Some(Span { start, end });
            return;
        }
        if [&b"bytes"[..], b"byte", b"ms", b"us", b"s"].iter().any(|unit| word.eq_ignore_ascii_case(unit)) {
            self.drop_count(at);
        }
        self.indication |= word == b"indication";
        self.skip_count = [&b"len"[..], b"length", b"size", b"count", b"cnt", b"seq", b"dlc"]
            .iter()
            .any(|name| word.eq_ignore_ascii_case(name));
        self.count_word(word);
    }

    /// Counts a word that says nothing of bytes; shorter ones are spoilt bytes, or say nothing at all.
    fn count_word(&mut self, word: &[u8]) {
        let long = word.len() > 2 && word.first().is_some_and(u8::is_ascii_alphabetic);
        if long && !mark::is_filler(word) {
            self.words += 1;
            self.words_since_mark += 1;
        }
    }

    /// The number right before `at` was a count.
    fn drop_count(&mut self, at: usize) {
        let gap = |run: &Run| at.saturating_sub(run.end) <= 1;
        if let Some(run) = self.current.as_mut().filter(|run| gap(run)) {
            run.drop_last();
            if run.tokens == 0 {
                self.current = None;
            }
        }
    }

    /// Characters beyond ASCII in a row: marks, or a word.
    fn characters(&mut self, at: usize) {
        let rest = self.codes.get(at..).unwrap_or_default();
        let len = rest.iter().take_while(|code| **code >= 0x80).count();
        let word = rest.get(..len).unwrap_or_default();
        self.at = at + len;
        if word.first() == Some(&COUNT) {
            self.drop_count(at);
        }
        self.skip_count = word.first() == Some(&LENGTH);
        // In a longer word, reading and writing are what it is about.
        let marks = word.iter().filter_map(|code| mark::character(*code)).filter(|mark| !mark.common || len <= 4);
        // Of equals the first counts.
        match marks.reduce(|first, next| if next.strength > first.strength { next } else { first }) {
            Some(mark) => self.mark(mark),
            None if matches!(word.first(), Some(&(COUNT | LENGTH))) => {}
            None => {
                self.words += 1;
                self.words_since_mark += 1;
            }
        }
    }

    fn stamp(&mut self, stamp: Stamp, end: usize) {
        match stamp {
            Stamp::Date(day_us) => self.day_us = self.day_us.or(day_us),
            Stamp::Time(us) => self.time_us = self.time_us.or(Some(us)),
            // Further on it is some reading.
            Stamp::Seconds(us) if self.words == 0 && self.mark.is_none() && self.before.is_none() => {
                self.time_us = self.time_us.or(Some(us));
            }
            Stamp::Seconds(_) => {}
        }
        self.at = end;
    }

    /// A byte in brackets, a tag, or an arrow.
    fn bracket(&mut self, at: usize, code: u8) {
        let (close, style) = if code == b'[' { (b']', Style::Square) } else { (b'>', Style::Angle) };
        let end = at + 1 + hex_digits(self.codes, at + 1);
        if end - at == 3 && self.codes.get(end) == Some(&close) {
            self.token(at, end + 1, Span { start: at + 1, end }, style);
            self.at = end + 1;
        } else if code == b'<' {
            let rest = self.codes.get(at + 1..).unwrap_or_default();
            let close = rest.iter().position(|code| matches!(code, b'<' | b'>'));
            match close.and_then(|close| Some((close, *rest.get(close)?))) {
                Some((close, b'>')) if rest.first().is_some_and(u8::is_ascii_alphanumeric) => {
                    self.tag_end = Some(at + 1 + close);
                }
                _ => {
                    self.at += rest.iter().take_while(|code| **code == b'<').count();
                    self.mark(mark::sign(false));
                }
            }
        }
    }

    /// A colon and digits: an ASCII frame, unless it parts a word from RTU bytes.
    fn frame(&mut self, at: usize) {
        let digits = hex_digits(self.codes, at + 1);
        let end = at + 1 + digits;
        if digits < 6 || !digits.is_multiple_of(2) {
            return;
        }
        let before = at.checked_sub(1).and_then(|at| self.codes.get(at)).copied().unwrap_or(b' ');
        let pairs = self.codes.get(at + 1..end).unwrap_or_default().as_chunks().0.iter();
        let sum = pairs.fold(0u8, |sum, [high, low]| sum.wrapping_add(hex::value(*high) << 4 | hex::value(*low)));
        if sum == 0 || !(before.is_ascii_alphanumeric() || before >= 0x80) {
            self.take(Run::whole(at, end, Kind::Frame, digits));
            self.at = end;
        }
    }

    fn token(&mut self, start: usize, end: usize, digits: Span, style: Style) {
        let token = Token { start, end, digits, style };
        let damaged = self.damaged.take();
        let Some(run) = &mut self.current else {
            self.current = Some(Run::new(self.codes, token));
            return;
        };
        match run.push(self.codes, token, damaged) {
            None => {
                run.push_plain(self.codes);
                self.at = self.at.max(run.end);
            }
            Some(next) => {
                let run = core::mem::replace(run, next);
                self.take(run);
            }
        }
    }

    /// A run has ended.
    fn take(&mut self, run: Run) {
        if run.tokens == 0 {
            return;
        }
        let best = if self.mark.is_some() { &mut self.behind } else { &mut self.before };
        let Some(best) = best else {
            *best = Some(run);
            return;
        };
        let better = run.is_better(self.codes, best);
        let worse = if better { core::mem::replace(best, run) } else { run };
        if worse.is_frame(self.codes) {
            self.other = Some(worse);
        }
    }

    fn end_run(&mut self) {
        self.damaged = None;
        if let Some(run) = self.current.take() {
            self.take(run);
        }
    }

    fn mark(&mut self, mark: Mark) {
        self.end_run();
        self.skip_count = false;
        let long = |run: &Option<Run>| run.is_some_and(|run| run.bytes >= rtu::MIN_ADU_LEN);
        if long(&self.before) || long(&self.behind) {
            self.late = self.late.filter(|late| late.strength >= mark.strength).or(Some(mark));
            return;
        }
        if self.mark.is_none_or(|found| mark.strength > found.strength) {
            self.mark = Some(mark);
            if let Some(run) = self.behind.take() {
                let best = &mut self.before;
                if best.as_ref().is_none_or(|best| run.is_better(self.codes, best)) {
                    *best = Some(run);
                }
            }
        }
        self.mark_end = Some(self.at);
        self.words_since_mark = 0;
    }

    fn finish(mut self) -> Found {
        self.end_run();
        let run = match (self.behind, self.before) {
            (Some(behind), Some(before)) if behind.bytes < rtu::MIN_ADU_LEN && before.bytes >= rtu::MIN_ADU_LEN => {
                Some(before)
            }
            (behind, before) => behind.or(before),
        };
        let run = run.and_then(|run| run.settle(self.codes));
        let found = self.mark.or(self.late);
        let mark = found.or_else(|| {
            let run = run.filter(|run| run.tokens > 1)?;
            match run.style {
                Style::Square => Some(mark::sign(true)),
                Style::Angle => Some(mark::sign(false)),
                _ => None,
            }
        });
        Found {
            direction: mark.map_or(Direction::Unknown, |mark| mark.direction),
            marked: found.is_some(),
            common: found.is_some_and(|mark| mark.common),
            time_us: self.time_us.map(|time_us| time_us.saturating_add(self.day_us.unwrap_or(0))),
            run,
            other: self.other.filter(|other| run.is_some_and(|run| run.end <= other.start || other.end <= run.start)),
            second: self.late.filter(|late| late.strength > 1).map_or(Direction::Unknown, |late| late.direction),
            words: self.words,
            words_since_mark: self.words_since_mark,
            mark_end: self.mark_end,
            indication: self.indication,
        }
    }
}
