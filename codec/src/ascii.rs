//! ASCII mode: `:`, unit id and PDU and LRC as hexadecimal digits, CR LF (serial line guide, clause 2.5.2).
//!
//! A frame that [`encode`] made always [`decode`]s to the same unit and PDU, and [`encode`] cannot fail for a PDU of 1 to 253
//! bytes. [`decode`] takes any bytes and never panics. It takes characters of seven bits and of eight, whose eighth may be
//! a parity bit, and digits in either case; [`encode`] makes upper-case digits with the eighth bit clear.

use alloc::vec::Vec;

use crate::UnitId;
use crate::check::lrc;

/// Longest frame in characters.
pub const MAX_ADU_LEN: usize = 513;
/// Shortest frame in characters: colon, unit id, function code, LRC, CR LF.
pub const MIN_ADU_LEN: usize = 9;

/// Why characters are no ASCII frame, or a PDU fits none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AduError {
    /// Fewer characters than the shortest frame has.
    #[error("{0} characters are too short for a frame")]
    TooShort(usize),
    /// More characters than the longest frame has.
    #[error("{0} characters are too long for a frame")]
    TooLong(usize),
    /// It does not begin with a colon.
    #[error("the frame does not begin with a colon")]
    NoColon,
    /// It does not end with CR LF.
    #[error("the frame does not end with CR LF")]
    NoLineEnd,
    /// An odd number of digits.
    #[error("an odd number of digits")]
    OddDigits,
    /// A character that is no hexadecimal digit.
    #[error("character {position} is no hexadecimal digit")]
    NotHex {
        /// Place in the frame, the colon being 0.
        position: usize,
    },
    /// The check does not fit the bytes before it.
    #[error("LRC is {found:02X}, must be {expected:02X}")]
    BadLrc {
        /// As in the frame.
        found: u8,
        /// What it should be.
        expected: u8,
    },
}

/// A frame with a right check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AsciiAdu {
    /// The device addressed or answering.
    pub unit: UnitId,
    /// Function code and data, 1 to 253 bytes.
    pub pdu: Vec<u8>,
}

/// Puts a PDU of 1 to 253 bytes into a frame.
pub fn encode(unit: UnitId, pdu: &[u8]) -> Result<Vec<u8>, AduError> {
    let len = pdu.len().saturating_mul(2).saturating_add(7);
    if len < MIN_ADU_LEN {
        return Err(AduError::TooShort(len));
    }
    if len > MAX_ADU_LEN {
        return Err(AduError::TooLong(len));
    }
    let mut body = Vec::with_capacity(pdu.len() + 2);
    body.push(unit.0);
    body.extend_from_slice(pdu);
    body.push(lrc(&body));
    let mut frame = Vec::with_capacity(len);
    frame.push(b':');
    frame.extend(body.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 0x0F)]));
    frame.extend_from_slice(b"\r\n");
    Ok(frame)
}

/// Checks a whole frame. The eighth bit of a character is taken for a parity bit and ignored.
pub fn decode(frame: &[u8]) -> Result<AsciiAdu, AduError> {
    let mut body = decode_body(frame)?;
    let Some(found) = body.pop() else { return Err(AduError::TooShort(frame.len())) };
    let expected = lrc(&body);
    if found != expected {
        return Err(AduError::BadLrc { found, expected });
    }
    let pdu = body.split_off(1);
    Ok(AsciiAdu { unit: UnitId(body[0]), pdu })
}

/// The bytes that the digits spell: unit id, PDU, LRC; at least three.
pub fn decode_body(frame: &[u8]) -> Result<Vec<u8>, AduError> {
    if frame.len() > MAX_ADU_LEN {
        return Err(AduError::TooLong(frame.len()));
    }
    let plain = |byte: &u8| byte & 0x7F;
    if frame.first().map(plain) != Some(b':') {
        return Err(AduError::NoColon);
    }
    let [_, digits @ .., cr, lf] = frame else { return Err(AduError::TooShort(frame.len())) };
    if (plain(cr), plain(lf)) != (b'\r', b'\n') {
        return Err(AduError::NoLineEnd);
    }
    if frame.len() < MIN_ADU_LEN {
        return Err(AduError::TooShort(frame.len()));
    }
    let values = digits.iter().enumerate().map(|(at, byte)| {
        let value = char::from(plain(byte)).to_digit(16).and_then(|value| u8::try_from(value).ok());
        value.ok_or(AduError::NotHex { position: at + 1 })
    });
    let values: Vec<u8> = values.collect::<Result<_, _>>()?;
    if !values.len().is_multiple_of(2) {
        return Err(AduError::OddDigits);
    }
    Ok(values.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect())
}

fn digit(value: u8) -> u8 {
    b"0123456789ABCDEF"[usize::from(value & 0x0F)]
}
