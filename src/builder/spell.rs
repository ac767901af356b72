//! A frame in the spelling of a program, and frames that are wrong on purpose.

use buslens_codec::line::Mode;

use crate::format::push_hex;

/// How bytes are spelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spelling {
    /// `01 05`
    Spaced,
    /// `0105`
    Plain,
    /// `{ 0x01, 0x05 }`
    C,
    /// `b"\x01\x05"`
    Python,
    /// `[0x01, 0x05]`
    Rust,
    /// `"\x01\x05"`
    Escaped,
    /// `1, 5`
    Decimal,
    /// `:0105FA<CR><LF>`
    Characters,
}

impl Spelling {
    /// All of them; the last makes sense for ASCII frames only.
    pub(crate) const ALL: [Self; 8] =
        [Self::Spaced, Self::Plain, Self::C, Self::Python, Self::Rust, Self::Escaped, Self::Decimal, Self::Characters];

    /// The bytes in this spelling.
    pub(crate) fn spell(self, bytes: &[u8]) -> String {
        let (start, before, between, end) = match self {
            Self::Spaced => ("", "", " ", ""),
            Self::Plain | Self::Characters => ("", "", "", ""),
            Self::C => ("{ ", "0x", ", ", " }"),
            Self::Python => ("b\"", "\\x", "", "\""),
            Self::Rust => ("[", "0x", ", ", "]"),
            Self::Escaped => ("\"", "\\x", "", "\""),
            Self::Decimal => ("", "", ", ", ""),
        };
        let mut text = start.to_owned();
        for (at, byte) in bytes.iter().enumerate() {
            if at > 0 {
                text.push_str(between);
            }
            text.push_str(before);
            match (self, byte) {
                (Self::Decimal, _) => text.push_str(&byte.to_string()),
                (Self::Characters, b'\r') => text.push_str("<CR>"),
                (Self::Characters, b'\n') => text.push_str("<LF>"),
                (Self::Characters, _) => text.push(char::from(*byte)),
                _ => push_hex(&mut text, &[*byte]),
            }
        }
        text.push_str(end);
        text
    }
}

/// Makes the check of a whole frame wrong, and nothing else.
pub(crate) fn spoil(mode: Mode, frame: &mut [u8]) {
    match (mode, frame) {
        (Mode::Rtu, [.., last]) => *last ^= 1,
        (Mode::Ascii, [.., digit, _, _]) => *digit = if *digit == b'0' { b'1' } else { b'0' },
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use buslens_codec::{UnitId, adu, ascii, intake, rtu};

    use super::*;

    const FRAME: [u8; 8] = [0x01, 0x05, 0x00, 0x50, 0xFF, 0x00, 0x8C, 0x2B];

    #[test]
    fn a_frame_is_spelled_for_each_language() {
        let spelled = Spelling::ALL.map(|spelling| spelling.spell(&FRAME[..2]));
        let wanted = ["01 05", "0105", "{ 0x01, 0x05 }", "b\"\\x01\\x05\"", "[0x01, 0x05]", "\"\\x01\\x05\"", "1, 5"];
        assert_eq!(spelled[..7], wanted);
        assert_eq!(Spelling::Characters.spell(b":01\r\n"), ":01<CR><LF>");
    }

    #[test]
    fn what_is_spelled_is_read_again() {
        for spelling in &Spelling::ALL[..6] {
            assert_eq!(intake::read(&spelling.spell(&FRAME)).bytes, FRAME, "{spelling:?}");
        }
        let ascii = ascii::encode(UnitId(1), &FRAME[1..6]).unwrap();
        assert_eq!(intake::read(&Spelling::Characters.spell(&ascii)).bytes, ascii);
    }

    #[test]
    fn a_spoiled_frame_has_a_wrong_check_only() {
        for unit in 0..=u8::MAX {
            for mode in [Mode::Rtu, Mode::Ascii] {
                let mut frame = adu::encode(mode, UnitId(unit), &FRAME[1..6]).unwrap();
                spoil(mode, &mut frame);
                match mode {
                    Mode::Rtu => assert!(matches!(rtu::decode(&frame), Err(rtu::AduError::BadCrc { .. }))),
                    Mode::Ascii => assert!(matches!(ascii::decode(&frame), Err(ascii::AduError::BadLrc { .. }))),
                }
            }
        }
        spoil(Mode::Rtu, &mut []);
        spoil(Mode::Ascii, &mut []);
    }
}
