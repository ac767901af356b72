//! From a text to frames: each with the request that it answers, where one stands before it.

use buslens_codec::dissect::Direction;
use buslens_codec::intake::{self, Intake, IntakeError};
use buslens_codec::line::Mode;
use buslens_codec::pdu::Request;
use buslens_codec::profile::Profile;
use buslens_codec::stream::{Piece, split};

use crate::anatomy::{Anatomy, request_in};
use crate::text::Language;

/// Everything that a text holds, in order.
pub(super) fn read(language: Language, profile: &Profile, text: &str) -> Result<Vec<Anatomy>, IntakeError> {
    let Intake { bytes, mode } = intake::parse(text)?;
    let mut asked: Option<Asked> = None;
    let take = |piece: Piece| match piece {
        Piece::Frame(span) => frame(language, profile, mode, &span.bytes, &mut asked),
        Piece::Noise(span) => broken(language, profile, mode, &span.bytes, asked.as_ref()),
    };
    Ok(split(mode, &bytes).into_iter().map(take).collect())
}

/// The request that waits for its reply.
struct Asked {
    unit: u8,
    request: Request,
    bytes: Vec<u8>,
}

/// A frame with a right check. A write's echo is its reply when the request has just been seen.
fn frame(language: Language, profile: &Profile, mode: Mode, bytes: &[u8], asked: &mut Option<Asked>) -> Anatomy {
    let echo = asked.as_ref().is_some_and(|asked| asked.bytes == bytes && asked.request.is_write());
    let hint = if echo { Direction::Response } else { Direction::Unknown };
    let of = |direction, request| Anatomy::of(language, profile, bytes, mode, direction, request);
    let seen = of(hint, None);
    let Some(facts) = &seen.facts else { return seen };
    match facts.direction {
        Direction::Response => {
            // A sensor asked by broadcast answers as 0.
            let answered = asked.take().filter(|asked| asked.unit == facts.unit || asked.unit == 0 || facts.unit == 0);
            of(Direction::Response, answered.as_ref().map(|asked| &asked.request))
        }
        Direction::Request | Direction::Unknown => {
            *asked = request_in(bytes, mode).map(|(unit, request)| Asked { unit, request, bytes: bytes.to_vec() });
            of(if asked.is_some() { Direction::Request } else { Direction::Unknown }, None)
        }
    }
}

/// Bytes without a right check: a frame of a known function that was damaged, or just bytes.
fn broken(language: Language, profile: &Profile, mode: Mode, bytes: &[u8], asked: Option<&Asked>) -> Anatomy {
    let request = asked.map(|asked| &asked.request);
    let seen = Anatomy::of(language, profile, bytes, mode, Direction::Unknown, request);
    if seen.has_known_shape() { seen } else { seen.as_noise(language) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device;

    fn read_en(text: &str) -> Vec<Anatomy> {
        read(Language::En, device::find("lvdt").profile(), text).unwrap()
    }

    #[test]
    fn a_reply_takes_its_registers_from_the_request_before_it() {
        let frames = read_en("0C 04 00 04 00 02 31 17 0C 04 04 80 00 01 48 0F 22");
        let facts: Vec<_> = frames.iter().map(|frame| frame.facts.clone().unwrap()).collect();
        assert_eq!(facts[0].direction, Direction::Request);
        assert_eq!(facts[0].meaning, "Displacement");
        assert_eq!(facts[1].direction, Direction::Response);
        assert_eq!(facts[1].meaning, "Displacement \u{2212}0.328\u{A0}mm");
    }

    #[test]
    fn a_reply_alone_shows_its_registers() {
        assert_eq!(read_en("0C 04 04 80 00 01 48 0F 22")[0].facts.clone().unwrap().meaning, "8000 0148");
    }

    #[test]
    fn a_write_and_its_echo_go_opposite_ways() {
        let frames = read_en("01 05 00 50 FF 00 8C 2B 01 05 00 50 FF 00 8C 2B");
        let directions: Vec<_> = frames.iter().map(|frame| frame.facts.clone().unwrap().direction).collect();
        assert_eq!(directions, [Direction::Request, Direction::Response]);
    }

    #[test]
    fn a_damaged_frame_keeps_its_shape_and_rubbish_does_not() {
        let frames = read_en("0C 04 00 04 00 02 31 18");
        assert!(!frames[0].facts.as_ref().unwrap().check_ok);
        let frames = read_en("FE FE FE FE FE FE");
        assert_eq!(frames[0].facts, None);
        assert_eq!(frames[0].parts.len(), 1);
    }
}
