//! The rules of ASCII streams: what stands at one place.

use super::lengths::{Candidate, lengths, shape_within};
use super::{Shape, Verdict};
use crate::ascii::{MAX_ADU_LEN, decode};

/// Looks for a line at the start of `bytes`. `seen` counts characters that hold no end of the line; the next look begins
/// behind them.
pub(super) fn verdict(bytes: &[u8], finished: bool, seen: &mut usize) -> Verdict {
    if !matches!(bytes, [first, ..] if first & 0x7F == b':') {
        return Verdict::NoFrame(1);
    }
    let line = bytes.get(..MAX_ADU_LEN).unwrap_or(bytes);
    let from = (*seen).max(1);
    let stop = line.iter().enumerate().skip(from).find(|(_, byte)| matches!(*byte & 0x7F, b':' | b'\n'));
    let (len, is_line) = match stop {
        Some((at, byte)) if byte & 0x7F == b'\n' => (at + 1, true),
        // A new colon begins a new line, whatever was before.
        Some((at, _)) => (at, false),
        None if finished || line.len() == MAX_ADU_LEN => (line.len(), false),
        None => {
            *seen = line.len();
            return Verdict::Unknown { needed: line.len() + 1 };
        }
    };
    *seen = 0;
    match line.get(..len).map(decode) {
        Some(Ok(adu)) if is_line => {
            let mut body = adu.pdu;
            body.insert(0, adu.unit.0);
            Verdict::Frame(len, shape(body))
        }
        _ => Verdict::Broken(len),
    }
}

/// What a frame is whose unit id and PDU are `body`.
fn shape(mut body: alloc::vec::Vec<u8>) -> Shape {
    // The rules tell lengths with a CRC of two bytes.
    body.extend([0, 0]);
    let lengths = lengths(&body);
    let told = [lengths.short, lengths.long].into_iter().find(|candidate| candidate.len == body.len());
    told.map_or(Shape::Either, |Candidate { shape, .. }| shape_within(&body, shape))
}
