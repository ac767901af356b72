//! Frames in either mode.

use alloc::vec::Vec;

use crate::line::Mode;
use crate::{UnitId, ascii, rtu};

/// Puts a PDU into a frame of `mode`; `None` for a PDU that is empty or longer than 253 bytes, which is never what
/// [`crate::pdu::Request::encode`] or [`crate::pdu::Response::encode`] gave.
pub fn encode(mode: Mode, unit: UnitId, pdu: &[u8]) -> Option<Vec<u8>> {
    match mode {
        Mode::Rtu => rtu::encode(unit, pdu).ok(),
        Mode::Ascii => ascii::encode(unit, pdu).ok(),
    }
}
