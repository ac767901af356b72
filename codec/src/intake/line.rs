//! One line of a text, each character as one byte.
//!
//! Plain ASCII stays as it is and is not copied. A full-width character, Chinese punctuation or an arrow becomes its plain
//! twin; a Chinese character that tells of direction becomes one of the codes below; everything else is [`OTHER`]. So the
//! place of a byte is the column of its character.

use alloc::vec::Vec;
use core::cell::Cell;

/// 发: sent.
pub(super) const SEND: u8 = 0x80;
/// 收: received.
pub(super) const RECEIVE: u8 = 0x81;
/// 写: written.
pub(super) const WRITE: u8 = 0x82;
/// 读: read.
pub(super) const READ: u8 = 0x83;
/// 求, of 请求: a request.
pub(super) const REQUEST: u8 = 0x84;
/// 响, 应, 回, 答: a response.
pub(super) const RESPONSE: u8 = 0x85;
/// 主: the master.
pub(super) const MASTER: u8 = 0x86;
/// 从: a slave.
pub(super) const SLAVE: u8 = 0x87;
/// 字, 个, 毫, 秒: what stands behind a count.
pub(super) const COUNT: u8 = 0x88;
/// 长: a length comes next.
pub(super) const LENGTH: u8 = 0x89;
/// Any other character beyond ASCII.
pub(super) const OTHER: u8 = 0x8A;
/// A control character, or what is left of bytes that are no text.
pub(super) const RAW: u8 = 0x8B;

pub(super) struct Line<'a> {
    text: &'a str,
    pub(super) codes: &'a [u8],
    /// Counted from 1.
    pub(super) number: usize,
    /// The first [`RAW`] character.
    pub(super) raw: Option<usize>,
    /// A character and the byte of the text at which it begins: faults come in the order of the text.
    cursor: Cell<(usize, usize)>,
}

impl<'a> Line<'a> {
    pub(super) fn new(text: &'a str, number: usize, room: &'a mut Vec<u8>) -> Self {
        let plain = text.bytes().all(|byte| matches!(byte, b' '..=b'~' | b'\t'));
        let (codes, raw) = if plain {
            (text.as_bytes(), None)
        } else {
            normalise(text, room);
            let codes: &[u8] = room;
            (codes, codes.iter().position(|code| *code == RAW))
        };
        Self { text, codes, number, raw, cursor: Cell::new((0, 0)) }
    }

    pub(super) fn is_blank(&self) -> bool {
        self.codes.iter().all(|code| is_space(*code))
    }

    /// Whether it is no text at all, rather than text with a stray control character.
    pub(super) fn is_raw(&self) -> bool {
        let raw = self.codes.iter().fold(0, |raw, code| raw + usize::from(*code == RAW));
        raw > self.codes.len() / 8
    }

    /// The byte that a character stands for by its number, if it is at most U+00FF or the twin of such a one.
    pub(super) fn latin(&self, column: usize) -> Option<u8> {
        let code = self.codes.get(column).copied()?;
        if self.text.len() == self.codes.len() {
            return Some(code);
        }
        u8::try_from(self.character(column)).ok().or(code.is_ascii().then_some(code))
    }

    /// The character in a column, counted from 0; a space behind the end.
    pub(super) fn character(&self, column: usize) -> char {
        let (mut at, mut byte) = self.cursor.get();
        if column < at {
            (at, byte) = (0, 0);
        }
        let mut rest = self.text.get(byte..).unwrap_or_default().chars();
        let found = if self.text.is_ascii() && at == 0 {
            self.text.as_bytes().get(column).map(|byte| char::from(*byte))
        } else {
            let found = rest.by_ref().nth(column - at);
            let len = found.map_or(0, char::len_utf8);
            self.cursor.set((column, self.text.len() - rest.as_str().len() - len));
            found
        };
        found.unwrap_or(' ')
    }
}

pub(super) fn is_space(code: u8) -> bool {
    matches!(code, b' ' | b'\t')
}

/// The columns from `at` on that are spaces.
pub(super) fn spaces(codes: &[u8], at: usize) -> usize {
    codes.iter().skip(at).take_while(|code| is_space(**code)).count()
}

/// The columns from `at` on that are hexadecimal digits.
pub(super) fn hex_digits(codes: &[u8], at: usize) -> usize {
    codes.iter().skip(at).take_while(|code| code.is_ascii_hexdigit()).count()
}

pub(super) fn starts_with(codes: &[u8], at: usize, what: &[u8]) -> bool {
    codes.get(at..).is_some_and(|rest| rest.starts_with(what))
}

fn normalise(text: &str, room: &mut Vec<u8>) {
    room.clear();
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        if character != '\u{1B}' {
            room.push(code(character));
            continue;
        }
        // A terminal's colour: ESC, bracket, numbers, letter.
        room.push(b' ');
        if characters.next_if_eq(&'[').is_some() {
            room.push(b' ');
            while characters.next_if(|next| matches!(next, ' '..='?')).is_some() {
                room.push(b' ');
            }
            if characters.next_if(|next| matches!(next, '@'..='~')).is_some() {
                room.push(b' ');
            }
        }
    }
}

fn code(character: char) -> u8 {
    match character {
        '\t' | ' '..='~' => u8::try_from(character).unwrap_or(b' '),
        '\u{B}'
        | '\u{C}'
        | '\u{85}'
        | '\u{A0}'
        | '\u{2000}'..='\u{200D}'
        | '\u{2028}'
        | '\u{2029}'
        | '\u{202F}'
        | '\u{2060}'
        | '\u{3000}'
        | '\u{FEFF}'
        | '□'
        | '■'
        | '·'
        | '•' => b' ',
        '\0'..='\u{1F}' | '\u{7F}'..='\u{9F}' | '\u{FFFD}' => RAW,
        '\u{FF01}'..='\u{FF5E}' => u8::try_from(u32::from(character) - 0xFEE0).unwrap_or(OTHER),
        '、' => b',',
        '。' => b'.',
        '【' | '〔' | '「' => b'[',
        '】' | '〕' | '」' => b']',
        '《' => b'(',
        '》' => b')',
        '“' | '”' => b'"',
        '‘' | '’' => b'\'',
        '‐'..='―' | '−' | '─' => b'-',
        '│' => b'|',
        '→' | '⇒' | '➔' | '➜' | '►' | '▶' | '»' | '◇' | '⟶' => b'>',
        '←' | '⇐' | '◄' | '◀' | '«' | '◆' | '⟵' => b'<',
        '发' | '發' => SEND,
        '收' => RECEIVE,
        '写' | '寫' => WRITE,
        '读' | '讀' => READ,
        '求' => REQUEST,
        '响' | '響' | '应' | '應' | '回' | '答' => RESPONSE,
        '主' => MASTER,
        '从' | '從' => SLAVE,
        '字' | '个' | '個' | '毫' | '秒' => COUNT,
        '长' | '長' => LENGTH,
        _ => OTHER,
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;

    #[test]
    fn a_column_is_a_character() {
        let mut room = Vec::new();
        let line = Line::new("[发]→０１，ＦＦ \u{1B}[31mé", 1, &mut room);
        assert_eq!(line.codes, [b"[", &[SEND][..], b"]>01,FF      ", &[OTHER]].concat());
        for (column, expected) in [(1, '发'), (3, '→'), (5, '１'), (1, '发'), (15, 'é'), (99, ' '), (0, '[')] {
            assert_eq!(line.character(column), expected);
        }
    }

    #[test]
    fn raw_bytes_are_told_from_a_stray_control_character() {
        let mut room = Vec::new();
        assert!(Line::new("\0\u{1}\u{FFFD}ab", 1, &mut room).is_raw());
        let line = Line::new("01 03 00 31 00 01 D5 C5\u{1A}", 1, &mut room);
        assert_eq!((line.raw, line.is_raw()), (Some(23), false));
    }
}
