//! Finding frames in a stream of bytes without time stamps.
//!
//! A [`Splitter`] is fed in chunks of any size and gives the same pieces whatever their borders. RTU frames are found by
//! the lengths that their function lets expect, for requests and for replies, and by their check; what fits no frame is
//! noise, and the search goes on at the next byte. A check that is right by chance in the middle of a frame is not taken
//! for its end: of several lengths that fit, the longest wins. The splitter holds at most one frame more than it was fed.

use alloc::vec::Vec;
use core::ops::Range;

use crate::line::Mode;
use crate::{ascii, rtu};

/// A part of the stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Piece {
    /// A frame with a right check.
    Frame(Span),
    /// Bytes that belong to no frame with a right check.
    Noise(Span),
}

/// Bytes and their place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// Bytes of the stream before it.
    pub offset: usize,
    /// The bytes.
    pub bytes: Vec<u8>,
}

impl Piece {
    /// Its place and bytes.
    pub fn span(&self) -> &Span {
        match self {
            Self::Frame(span) | Self::Noise(span) => span,
        }
    }
}

/// Splits a stream.
#[derive(Clone, Debug)]
pub struct Splitter {
    mode: Mode,
    bytes: Vec<u8>,
    /// Bytes before this have been given out; they are dropped now and then.
    start: usize,
    /// Bytes from `start` to here are noise.
    at: usize,
    /// Bytes of the stream before `bytes[0]`.
    offset: usize,
    finished: bool,
}

impl Splitter {
    /// A splitter at the start of a stream.
    pub fn new(mode: Mode) -> Self {
        Self { mode, bytes: Vec::new(), start: 0, at: 0, offset: 0, finished: false }
    }

    /// Takes the next bytes of the stream in.
    pub fn push(&mut self, bytes: &[u8]) {
        self.offset += self.start;
        self.bytes.drain(..self.start);
        self.at -= self.start;
        self.start = 0;
        self.bytes.extend_from_slice(bytes);
    }

    /// No more bytes come: what is left is given out.
    pub fn finish(&mut self) {
        self.finished = true;
    }

    /// The next piece, once enough of the stream is known to be sure of it.
    pub fn next_piece(&mut self) -> Option<Piece> {
        loop {
            let rest = &self.bytes[self.at..];
            if rest.is_empty() {
                return if self.finished { self.take_noise() } else { None };
            }
            let verdict = match self.mode {
                Mode::Rtu => rtu_frame(rest, self.finished, self.at == self.start),
                Mode::Ascii => ascii_frame(rest, self.finished),
            };
            match verdict {
                Verdict::Frame(_) if self.at > self.start => return self.take_noise(),
                Verdict::Frame(len) => return Some(Piece::Frame(self.take(self.at..self.at + len))),
                Verdict::NoFrame(skip) => self.at += skip,
                Verdict::Unknown => return None,
            }
        }
    }

    fn take_noise(&mut self) -> Option<Piece> {
        (self.at > self.start).then(|| Piece::Noise(self.take(self.start..self.at)))
    }

    fn take(&mut self, range: Range<usize>) -> Span {
        let span = Span { offset: self.offset + range.start, bytes: self.bytes[range.clone()].to_vec() };
        self.start = range.end;
        self.at = range.end;
        span
    }
}

/// All pieces of a whole stream.
pub fn split(mode: Mode, bytes: &[u8]) -> Vec<Piece> {
    let mut splitter = Splitter::new(mode);
    splitter.push(bytes);
    splitter.finish();
    core::iter::from_fn(|| splitter.next_piece()).collect()
}

enum Verdict {
    /// A frame of this length stands at the start.
    Frame(usize),
    /// No frame begins within so many bytes.
    NoFrame(usize),
    /// More bytes are needed to tell.
    Unknown,
}

/// Looks for an RTU frame at the start of `bytes`. `clean` says that no noise stands before it.
fn rtu_frame(bytes: &[u8], finished: bool, clean: bool) -> Verdict {
    let needed = if finished { bytes.len() } else { rtu::MAX_ADU_LEN };
    if bytes.len() < needed.min(rtu::MIN_ADU_LEN) {
        return if finished { Verdict::NoFrame(1) } else { Verdict::Unknown };
    }
    let Some(lengths) = expected_lengths(bytes) else {
        // A length byte is still to come, or nothing is known of this function.
        return match bytes.get(1) {
            Some(function) if !is_known(*function) => unknown_function(bytes, finished, clean),
            _ if finished => Verdict::NoFrame(1),
            _ => Verdict::Unknown,
        };
    };
    for len in lengths.into_iter().flatten() {
        match bytes.get(..len) {
            Some(frame) if rtu::decode(frame).is_ok() => return Verdict::Frame(len),
            None if !finished => return Verdict::Unknown,
            _ => {}
        }
    }
    Verdict::NoFrame(1)
}

/// The lengths that a frame can have by its function, longest first; `None` where they cannot be told (yet).
fn expected_lengths(bytes: &[u8]) -> Option<[Option<usize>; 2]> {
    let &[_, function, ref data @ ..] = bytes else { return None };
    Some(match function {
        0x03 | 0x04 => {
            let count = usize::from(*data.first()?);
            let reply = (count > 0 && count <= 250 && count.is_multiple_of(2)).then_some(count + 5);
            longest_first(Some(8), reply)
        }
        0x05 | 0x06 => [Some(8), None],
        0x10 => {
            let quantity = u16::from_be_bytes([*data.get(2)?, *data.get(3)?]);
            let count = *data.get(4)?;
            let request = (1..=123).contains(&quantity) && u16::from(count) == quantity * 2;
            longest_first(request.then(|| 9 + usize::from(count)), Some(8))
        }
        0x80.. => [Some(5), None],
        _ => return None,
    })
}

fn longest_first(a: Option<usize>, b: Option<usize>) -> [Option<usize>; 2] {
    if a >= b { [a, b] } else { [b, a] }
}

fn is_known(function: u8) -> bool {
    matches!(function, 0x03..=0x06 | 0x10 | 0x80..)
}

/// A frame of a function whose lengths nobody knows ends where its check is right. Only where no noise stands before it:
/// in noise a right check by chance would be frequent.
fn unknown_function(bytes: &[u8], finished: bool, clean: bool) -> Verdict {
    if !clean || !(1..0x80).contains(&bytes[1]) {
        return Verdict::NoFrame(1);
    }
    if bytes.len() < rtu::MAX_ADU_LEN && !finished {
        return Verdict::Unknown;
    }
    let longest = bytes.len().min(rtu::MAX_ADU_LEN);
    let found = (rtu::MIN_ADU_LEN..=longest).find(|&len| rtu::decode(&bytes[..len]).is_ok());
    found.map_or(Verdict::NoFrame(1), Verdict::Frame)
}

fn ascii_frame(bytes: &[u8], finished: bool) -> Verdict {
    if bytes[0] & 0x7F != b':' {
        return Verdict::NoFrame(1);
    }
    let line = &bytes[..bytes.len().min(ascii::MAX_ADU_LEN)];
    let stop = line.iter().skip(1).position(|byte| matches!(byte & 0x7F, b':' | b'\n')).map(|at| at + 1);
    match stop {
        Some(at) if line[at] & 0x7F == b'\n' && ascii::decode(&line[..=at]).is_ok() => Verdict::Frame(at + 1),
        Some(at) if line[at] & 0x7F == b'\n' => Verdict::NoFrame(at + 1),
        Some(at) => Verdict::NoFrame(at),
        None if finished || line.len() == ascii::MAX_ADU_LEN => Verdict::NoFrame(line.len()),
        None => Verdict::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use proptest::prelude::*;

    use super::*;
    use crate::UnitId;
    use crate::pdu::{ExceptionCode, Request, Response};

    fn pdus() -> impl Strategy<Value = Vec<u8>> {
        let registers = |most| prop::collection::vec(any::<u16>(), 1..=most);
        prop_oneof![
            (any::<u16>(), 1u16..=125).prop_map(|(address, quantity)| Request::ReadHoldingRegisters {
                address,
                quantity
            }
            .encode()),
            (any::<u16>(), any::<bool>()).prop_map(|(address, on)| Request::WriteSingleCoil { address, on }.encode()),
            (any::<u16>(), registers(123)).prop_map(|(address, values)| Request::WriteMultipleRegisters {
                address,
                values
            }
            .encode()),
            registers(125).prop_map(|values| Response::ReadInputRegisters { values }.encode()),
            Just(Response::Exception { function: 4, code: ExceptionCode::IllegalDataAddress }.encode()),
        ]
        .prop_map(Result::unwrap)
    }

    proptest! {
        #[test]
        fn glued_frames_come_apart(frames in prop::collection::vec((1u8..=247, pdus()), 1..12)) {
            let frames: Vec<Vec<u8>> = frames.iter().map(|(unit, pdu)| rtu::encode(UnitId(*unit), pdu).unwrap()).collect();
            let pieces = split(Mode::Rtu, &frames.concat());
            let found: Vec<_> = pieces.into_iter().map(|piece| match piece {
                Piece::Frame(span) => span.bytes,
                Piece::Noise(span) => panic!("noise: {span:?}"),
            }).collect();
            prop_assert_eq!(found, frames);
        }

        #[test]
        fn the_borders_of_chunks_mean_nothing(
            mode in prop_oneof![Just(Mode::Rtu), Just(Mode::Ascii)],
            parts in prop::collection::vec(prop_oneof![
                pdus().prop_map(|pdu| rtu::encode(UnitId(1), &pdu).unwrap()),
                pdus().prop_map(|pdu| crate::ascii::encode(UnitId(1), &pdu).unwrap()),
                prop::collection::vec(any::<u8>(), 0..20),
            ], 0..8),
            cuts in prop::collection::vec(1usize..40, 1..30),
        ) {
            let stream = parts.concat();
            let whole = split(mode, &stream);
            let mut splitter = Splitter::new(mode);
            let (mut pieces, mut rest) = (vec![], stream.as_slice());
            for cut in cuts.iter().cycle() {
                let (chunk, after) = rest.split_at((*cut).min(rest.len()));
                splitter.push(chunk);
                while let Some(piece) = splitter.next_piece() { pieces.push(piece); }
                rest = after;
                if rest.is_empty() { break; }
            }
            splitter.finish();
            while let Some(piece) = splitter.next_piece() { pieces.push(piece); }
            prop_assert_eq!(&pieces, &whole);
            // Nothing is lost and nothing moves.
            let mut at = 0;
            for piece in &pieces {
                prop_assert_eq!(piece.span().offset, at);
                at += piece.span().bytes.len();
            }
            prop_assert_eq!(at, stream.len());
        }

        #[test]
        fn a_frame_after_noise_without_its_unit_is_found(noise in prop::collection::vec(0x80u8..=0xFF, 0..50), pdu in pdus()) {
            let frame = rtu::encode(UnitId(1), &pdu).unwrap();
            let pieces = split(Mode::Rtu, &[noise.clone(), frame.clone()].concat());
            let last = pieces.last().unwrap();
            prop_assert_eq!(&last.span().bytes, &frame);
        }
    }
}
