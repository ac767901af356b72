//! RTU mode: unit id, PDU, CRC-16 low byte first (serial line guide, clause 2.5.1).
//!
//! A frame that [`encode`] made always [`decode`]s to the same unit and PDU, and [`encode`] cannot fail for a PDU of 1 to 253
//! bytes. [`decode`] takes any bytes and never panics.

use alloc::vec::Vec;

use crate::UnitId;
use crate::check::crc16;

/// Longest frame: unit id, PDU of 253, CRC.
pub const MAX_ADU_LEN: usize = 256;
/// Shortest frame: unit id, function code, CRC.
pub const MIN_ADU_LEN: usize = 4;
/// Longest PDU on a serial line.
pub const MAX_PDU_LEN: usize = MAX_ADU_LEN - 3;

/// Why bytes are no RTU frame, or a PDU fits none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AduError {
    /// Fewer bytes than the shortest frame has.
    #[error("{0} bytes are too short for a frame")]
    TooShort(usize),
    /// More bytes than the longest frame has.
    #[error("{0} bytes are too long for a frame")]
    TooLong(usize),
    /// The check does not fit the bytes before it.
    #[error("CRC is {found:04X}, must be {expected:04X}")]
    BadCrc {
        /// The frame's last two bytes as a number (low byte first on the wire).
        found: u16,
        /// What they should be.
        expected: u16,
    },
}

/// A frame with a right check, seen through its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Adu<'a> {
    /// The device addressed or answering.
    pub unit: UnitId,
    /// Function code and data, 1 to 253 bytes.
    pub pdu: &'a [u8],
}

/// Puts a PDU of 1 to 253 bytes into a frame.
pub fn encode(unit: UnitId, pdu: &[u8]) -> Result<Vec<u8>, AduError> {
    let len = pdu.len().saturating_add(3);
    if len < MIN_ADU_LEN {
        return Err(AduError::TooShort(len));
    }
    if len > MAX_ADU_LEN {
        return Err(AduError::TooLong(len));
    }
    let mut frame = Vec::with_capacity(len);
    frame.push(unit.0);
    frame.extend_from_slice(pdu);
    frame.extend_from_slice(&crc16(&frame).to_le_bytes());
    Ok(frame)
}

/// Checks a whole frame.
pub fn decode(frame: &[u8]) -> Result<Adu<'_>, AduError> {
    if frame.len() > MAX_ADU_LEN {
        return Err(AduError::TooLong(frame.len()));
    }
    match frame {
        [body @ .., low, high] if body.len() >= 2 => {
            let (found, expected) = (u16::from_le_bytes([*low, *high]), crc16(body));
            if found == expected {
                Ok(Adu { unit: UnitId(body[0]), pdu: &body[1..] })
            } else {
                Err(AduError::BadCrc { found, expected })
            }
        }
        _ => Err(AduError::TooShort(frame.len())),
    }
}
