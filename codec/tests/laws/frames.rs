use buslens_codec::check::{crc16, is_right};
use buslens_codec::diagnose::Surroundings;
use buslens_codec::line::Mode;
use buslens_codec::outline::Outline;
use buslens_codec::stream::Shape;
use buslens_codec::{UnitId, adu, ascii, rtu};

use super::damage::{is_explained, with_fault};
use super::input::{Input, direction};

/// What a frame is tried with: a byte of flags, place and value of a fault, the request before it, then its bytes.
struct Trial<'a> {
    flags: u8,
    place: u8,
    value: u8,
    request: &'a [u8],
    bytes: &'a [u8],
}

impl<'a> Trial<'a> {
    fn read(data: &'a [u8]) -> Self {
        let mut input = Input(data);
        let (flags, place, value) = (input.byte(), input.byte(), input.byte());
        Self { flags, place, value, request: input.counted(), bytes: input.0 }
    }

    fn surroundings(&self) -> Surroundings<'a> {
        Surroundings { direction: direction(self.flags), request: Some(self.request).filter(|all| !all.is_empty()) }
    }

    /// The frame itself, damaged or not.
    fn damaged(&self, frame: &[u8]) -> Vec<u8> {
        with_fault(frame, self.flags >> 2, self.place, self.value)
    }
}

/// The bytes are taken for a frame, and for unit id and PDU.
pub(super) fn rtu_frames_come_back(data: &[u8]) {
    let trial = Trial::read(data);
    rtu_frame(&trial, trial.bytes);
    let Some((unit, pdu)) = trial.bytes.split_first() else { return };
    match rtu::encode(UnitId(*unit), pdu) {
        Ok(frame) => {
            assert_eq!(rtu::decode(&frame), Ok(rtu::Adu { unit: UnitId(*unit), pdu }));
            assert_eq!(adu::encode(Mode::Rtu, UnitId(*unit), pdu).as_ref(), Some(&frame));
            for shape in [Shape::Request, Shape::Response, Shape::Either] {
                assert_eq!(Outline::of_rtu(&frame, shape), Outline::of_pdu(UnitId(*unit), pdu, shape));
            }
            // A CRC finds every single wrong bit.
            let at = usize::from(trial.place) % frame.len();
            let flipped = with_fault(&frame, 1, trial.place, trial.value);
            assert!(matches!(rtu::decode(&flipped), Err(rtu::AduError::BadCrc { .. })), "{at}");
            rtu_frame(&trial, &trial.damaged(&frame));
        }
        Err(_) => assert!(pdu.is_empty() || pdu.len() > rtu::MAX_PDU_LEN),
    }
}

fn rtu_frame(trial: &Trial<'_>, frame: &[u8]) {
    use rtu::AduError::{BadCrc, TooLong, TooShort};
    match rtu::decode(frame) {
        Ok(adu) => {
            assert!(is_right(frame));
            assert_eq!(rtu::encode(adu.unit, adu.pdu).as_deref(), Ok(frame));
            return;
        }
        Err(TooShort(len)) => assert!(len == frame.len() && len < rtu::MIN_ADU_LEN),
        Err(TooLong(len)) => assert!(len == frame.len() && len > rtu::MAX_ADU_LEN),
        Err(BadCrc { expected, .. }) => {
            assert!(!is_right(frame) && expected == crc16(&frame[..frame.len() - 2]));
        }
    }
    is_explained(Mode::Rtu, frame, trial.surroundings());
}

/// The same for ASCII mode.
pub(super) fn ascii_frames_come_back(data: &[u8]) {
    let trial = Trial::read(data);
    ascii_frame(&trial, trial.bytes);
    let Some((unit, pdu)) = trial.bytes.split_first() else { return };
    match ascii::encode(UnitId(*unit), pdu) {
        Ok(frame) => {
            let adu = ascii::AsciiAdu { unit: UnitId(*unit), pdu: pdu.to_vec() };
            assert_eq!(frame.len(), 7 + 2 * pdu.len());
            assert_eq!(ascii::decode(&frame).as_ref(), Ok(&adu));
            assert_eq!(ascii::decode(&frame.to_ascii_lowercase()).as_ref(), Ok(&adu));
            let parity: Vec<u8> = frame.iter().map(|byte| byte | 0x80).collect();
            assert_eq!(ascii::decode(&parity).as_ref(), Ok(&adu));
            assert_eq!(adu::encode(Mode::Ascii, UnitId(*unit), pdu).as_ref(), Some(&frame));
            ascii_frame(&trial, &trial.damaged(&frame));
        }
        Err(_) => assert!(pdu.is_empty() || pdu.len() > rtu::MAX_PDU_LEN),
    }
}

fn ascii_frame(trial: &Trial<'_>, frame: &[u8]) {
    if let Ok(body) = ascii::decode_body(frame) {
        assert_eq!(2 * body.len() + 3, frame.len());
    }
    match ascii::decode(frame) {
        Ok(adu) => {
            let plain: Vec<u8> = frame.iter().map(|byte| (byte & 0x7F).to_ascii_uppercase()).collect();
            assert_eq!(ascii::encode(adu.unit, &adu.pdu), Ok(plain));
        }
        Err(_) => is_explained(Mode::Ascii, frame, trial.surroundings()),
    }
}
