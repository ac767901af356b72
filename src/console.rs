//! The model of the console's send line: what is typed becomes bytes, with a check or without; what was sent before; what
//! is kept to be sent again. Nothing here knows the page.

pub(crate) mod entry;
pub(crate) mod history;
pub(crate) mod sequences;
pub(crate) mod snippets;

use std::ops::Range;

use buslens_codec::check::{crc16, lrc};
use buslens_codec::line::Mode;
use buslens_codec::{ascii, rtu};

use crate::format::hex_spaced;

/// How a line is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Writing {
    /// Pairs of digits, with texts in quotes and escapes between them.
    #[default]
    Hex,
    /// Text with escapes.
    Text,
}

/// What is put around the bytes of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Framing {
    /// A check behind them.
    #[default]
    Rtu,
    /// A check behind them; all of it as digits between `:` and CR LF.
    Ascii,
    /// Nothing: they go out as they are.
    Typed,
}

/// The check behind the bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Check {
    /// CRC-16, its low byte first.
    #[default]
    Crc,
    /// LRC.
    Lrc,
    /// None.
    None,
    /// That of the framing, wrong on purpose.
    Wrong,
}

/// A line with all that makes bytes of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Line {
    /// How the text is written.
    pub(crate) writing: Writing,
    /// What is put around its bytes.
    pub(crate) framing: Framing,
    /// The check behind them.
    pub(crate) check: Check,
    /// As typed; one line.
    pub(crate) text: String,
}

/// Bytes as they go out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Outgoing {
    /// All of them.
    pub(crate) bytes: Vec<u8>,
    /// Place of the check; empty without one.
    pub(crate) check: Range<usize>,
    /// Whether the check is wrong on purpose.
    pub(crate) is_wrong: bool,
}

/// A name under which a choice is kept and written to files.
pub(crate) trait Key: Copy + Default + 'static {
    /// All choices with their names.
    const ALL: &'static [(&'static str, Self)];

    /// Whether two are the same.
    fn is(self, other: Self) -> bool;

    /// Its name.
    fn key(self) -> &'static str {
        Self::ALL.iter().find(|(_, value)| value.is(self)).map_or("", |(key, _)| key)
    }

    /// The one with this name.
    fn of(key: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == key).map(|(_, value)| *value)
    }
}

impl Key for Writing {
    const ALL: &'static [(&'static str, Self)] = &[("hex", Self::Hex), ("text", Self::Text)];
    fn is(self, other: Self) -> bool {
        self == other
    }
}

impl Key for Framing {
    const ALL: &'static [(&'static str, Self)] = &[("rtu", Self::Rtu), ("ascii", Self::Ascii), ("typed", Self::Typed)];
    fn is(self, other: Self) -> bool {
        self == other
    }
}

impl Key for Check {
    const ALL: &'static [(&'static str, Self)] =
        &[("crc", Self::Crc), ("lrc", Self::Lrc), ("none", Self::None), ("wrong", Self::Wrong)];
    fn is(self, other: Self) -> bool {
        self == other
    }
}

impl Line {
    /// The line that sends exactly these bytes. A frame with a right check is written without it, so that it can be edited.
    pub(crate) fn of_bytes(bytes: &[u8]) -> Self {
        let body = |mode| match mode {
            Mode::Rtu => rtu::decode(bytes).ok().map(|_| bytes.get(..bytes.len() - 2).unwrap_or_default().to_vec()),
            Mode::Ascii => {
                let adu = ascii::decode(bytes).ok()?;
                // A frame with parity in its eighth bits, or small digits, would come out otherwise.
                let same = ascii::encode(adu.unit, &adu.pdu).is_ok_and(|again| again == bytes);
                same.then(|| [&[adu.unit.0], adu.pdu.as_slice()].concat())
            }
        };
        let hex =
            |framing, check, bytes: &[u8]| Self { writing: Writing::Hex, framing, check, text: hex_spaced(bytes) };
        if let Some(body) = body(Mode::Ascii) {
            hex(Framing::Ascii, Check::Lrc, &body)
        } else if let Some(body) = body(Mode::Rtu) {
            hex(Framing::Rtu, Check::Crc, &body)
        } else {
            hex(Framing::Typed, Check::None, bytes)
        }
    }

    /// The bytes that go out; or where the text goes wrong. A line without bytes sends nothing.
    pub(crate) fn outgoing(&self) -> Result<Outgoing, entry::Fault> {
        let body = entry::parse(self.writing, &self.text)?;
        Ok(if body.is_empty() { Outgoing::default() } else { framed(&body, self.framing, self.check) })
    }

    /// As one line of text, for [`Line::from_kept`].
    pub(crate) fn kept(&self) -> String {
        [self.writing.key(), " ", self.framing.key(), " ", self.check.key(), " ", &self.text].concat()
    }

    /// The line that was kept.
    pub(crate) fn from_kept(text: &str) -> Option<Self> {
        let mut parts = text.splitn(4, ' ');
        let mut next = || parts.next();
        let (writing, framing, check) = (Key::of(next()?)?, Key::of(next()?)?, Key::of(next()?)?);
        Some(Self { writing, framing, check, text: next()?.to_owned() })
    }
}

/// Bytes with what belongs around them.
fn framed(body: &[u8], framing: Framing, check: Check) -> Outgoing {
    let check_bytes = match (framing, check) {
        (Framing::Typed, _) | (_, Check::None) => Vec::new(),
        (_, Check::Crc) | (Framing::Rtu, Check::Wrong) => crc16(body).to_le_bytes().to_vec(),
        (_, Check::Lrc) | (Framing::Ascii, Check::Wrong) => vec![lrc(body)],
    };
    let is_wrong = check == Check::Wrong && framing != Framing::Typed;
    // The bits of every byte turned over are certainly others.
    let check_bytes: Vec<u8> = check_bytes.into_iter().map(|byte| if is_wrong { !byte } else { byte }).collect();
    if framing == Framing::Ascii {
        let mut text = ":".to_owned();
        crate::format::push_hex(&mut text, body);
        let from = text.len();
        crate::format::push_hex(&mut text, &check_bytes);
        let check = from..text.len();
        text.push_str("\r\n");
        Outgoing { bytes: text.into_bytes(), check, is_wrong }
    } else {
        let bytes = [body, &check_bytes].concat();
        Outgoing { check: body.len()..bytes.len(), bytes, is_wrong }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(framing: Framing, check: Check, text: &str) -> Line {
        Line { writing: Writing::Hex, framing, check, text: text.to_owned() }
    }

    fn bytes(framing: Framing, check: Check, text: &str) -> Vec<u8> {
        line(framing, check, text).outgoing().unwrap().bytes
    }

    #[test]
    fn a_line_gets_its_check_and_its_framing() {
        let body = "01 03 00 31 00 01";
        assert_eq!(hex_spaced(&bytes(Framing::Rtu, Check::Crc, body)), "01 03 00 31 00 01 D5 C5");
        assert_eq!(bytes(Framing::Ascii, Check::Lrc, body), b":010300310001CA\r\n");
        assert_eq!(hex_spaced(&bytes(Framing::Rtu, Check::Lrc, body)), "01 03 00 31 00 01 CA");
        for check in [Check::Crc, Check::Lrc, Check::None, Check::Wrong] {
            assert_eq!(hex_spaced(&bytes(Framing::Typed, check, body)), body);
        }
        assert_eq!(bytes(Framing::Ascii, Check::None, "01"), b":01\r\n");
    }

    #[test]
    fn a_wrong_check_is_wrong_and_as_long_as_the_right_one() {
        for (framing, check) in [(Framing::Rtu, Check::Crc), (Framing::Ascii, Check::Lrc)] {
            let right = line(framing, check, "01 03 00 31 00 01").outgoing().unwrap();
            let wrong = line(framing, Check::Wrong, "01 03 00 31 00 01").outgoing().unwrap();
            assert_eq!((right.bytes.len(), &right.check), (wrong.bytes.len(), &wrong.check));
            assert!(wrong.is_wrong && !right.is_wrong);
            assert!(right.check.clone().all(|at| right.bytes[at] != wrong.bytes[at]));
        }
    }

    #[test]
    fn nothing_gets_no_check() {
        assert_eq!(line(Framing::Ascii, Check::Lrc, "  ").outgoing(), Ok(Outgoing::default()));
    }

    #[test]
    fn any_bytes_become_a_line_that_sends_them() {
        let frames: [&[u8]; 6] = [
            &[1, 3, 0, 0x31, 0, 1, 0xD5, 0xC5],
            b":010300310001CA\r\n",
            b":010300310001cA\r\n",
            &[1, 3, 0, 0x31, 0, 1, 0xD5, 0xC6],
            &[0xFF],
            b":0103\r\n",
        ];
        for frame in frames {
            assert_eq!(Line::of_bytes(frame).outgoing().unwrap().bytes, frame);
        }
        assert_eq!(Line::of_bytes(frames[0]), line(Framing::Rtu, Check::Crc, "01 03 00 31 00 01"));
        assert_eq!(Line::of_bytes(frames[1]).framing, Framing::Ascii);
        assert_eq!(Line::of_bytes(&[]).outgoing().unwrap().bytes, [0_u8; 0]);
    }

    #[test]
    fn a_line_is_kept_whole() {
        for text in ["", "01 03", "  \"a b\"  "] {
            let line = line(Framing::Ascii, Check::Wrong, text);
            assert_eq!(Line::from_kept(&line.kept()), Some(line));
        }
        for wrong in ["", "hex", "hex rtu crc", "hex rtu none", "octal rtu crc 01"] {
            assert_eq!(Line::from_kept(wrong), None, "{wrong}");
        }
    }
}
