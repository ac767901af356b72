//! Checks of any bytes.

use buslens_codec::ascii;
use buslens_codec::check::{crc16, is_right, lrc};
use buslens_codec::intake::{self, Form, IntakeError};

use crate::message::Sums;

impl Sums {
    /// The checks of the bytes in a text; `None` where there is none.
    pub fn of(text: &str) -> Result<Option<Self>, IntakeError> {
        // Bare bytes: words beside them are faults here, not a log.
        let form = if intake::detect(text).form == Form::AsciiFrames { Form::AsciiFrames } else { Form::Hex };
        let intake = intake::read_as(text, form);
        if let Some(error) = intake.faults.first() {
            return Err(*error);
        }
        let spelled = if intake.form == Form::AsciiFrames { ascii::decode_body(&intake.bytes).ok() } else { None };
        let bytes = spelled.unwrap_or(intake.bytes);
        Ok((!bytes.is_empty()).then(|| Self {
            count: crate::desk::place(bytes.len()),
            crc: crc16(&bytes),
            lrc: lrc(&bytes),
            // A check of nothing is none.
            ends_with_crc: bytes.len() > 2 && is_right(&bytes),
            ends_with_lrc: bytes.len() > 1 && lrc(&bytes) == 0,
        }))
    }
}

#[cfg(test)]
mod tests {
    use buslens_codec::intake::IntakeFault;

    use super::*;

    #[test]
    fn checks_of_a_request() {
        let sums = Sums::of("01 03 00 31 00 01").unwrap().unwrap();
        assert_eq!((sums.count, sums.crc.to_le_bytes(), sums.lrc), (6, [0xD5, 0xC5], 0xCA));
        assert!(!sums.ends_with_crc && !sums.ends_with_lrc);
    }

    #[test]
    fn a_frame_with_its_check_is_recognised() {
        assert!(Sums::of("01 03 00 31 00 01 D5 C5").unwrap().unwrap().ends_with_crc);
        assert!(!Sums::of("01 03 00 31 00 01 C5 D5").unwrap().unwrap().ends_with_crc);
        let ascii = Sums::of(":010300310001CA").unwrap().unwrap();
        assert_eq!((ascii.count, ascii.ends_with_lrc), (7, true));
        assert!(!Sums::of("FF FF").unwrap().unwrap().ends_with_crc);
    }

    #[test]
    fn nothing_has_no_check_and_faults_have_a_place() {
        assert_eq!(Sums::of(" \n"), Ok(None));
        let error = Sums::of("01 03\n0x xyz").unwrap_err();
        assert_eq!((error.line, matches!(error.fault, IntakeFault::Unexpected(_))), (2, true));
    }
}
