//! Damaged frames of RTU mode.

use alloc::vec::Vec;

use super::repair::{self, Repair};
use super::shape::{self, Extent};
use super::{Diagnosis, Placed, Surroundings};
use crate::check::{crc16, lrc};
use crate::dissect::Direction;
use crate::rtu::MAX_ADU_LEN;

/// Fewest bytes of a frame that is cut off: unit id, function code and two more say enough to tell it from noise.
const MIN_TRUNCATED_LEN: usize = 4;
/// Longest frame of a function that the standard does not know and that is still taken for damaged: in a longer one a
/// flipped bit would explain too much by chance.
const MAX_OWN_LEN: usize = 64;
/// Fewest bytes of any frame with one damage.
const MIN_LEN: usize = 3;

/// What is wrong with these bytes, if they are one damaged frame as a whole; else nothing.
pub(super) fn damage(frame: &[u8], around: Surroundings<'_>) -> Vec<Diagnosis> {
    let mut found = specific(frame, around);
    if found.is_empty() {
        found.extend(truncated(frame, around));
        let count = miscounted(frame, around);
        if repair::is_right(frame) {
            found.extend(count);
            return found;
        }
        if found.is_empty() && !is_whole(frame, around) {
            if count.is_none() {
                return found;
            }
            found.extend(count);
        }
    }
    if let Some((body, check)) = frame.split_last_chunk::<2>() {
        let expected = crc16(body).to_le_bytes();
        if expected != *check {
            found.push(Diagnosis::BadCrc { expected });
        }
    }
    found
}

/// The explanations that name one change which makes a whole frame of these bytes.
pub(crate) fn specific(frame: &[u8], around: Surroundings<'_>) -> Vec<Diagnosis> {
    let mut found = Vec::new();
    if frame.len() < MIN_LEN || repair::is_right(frame) {
        return found;
    }
    let (mut inserts, mut removes) = (Vec::new(), Vec::new());
    repair::repairs(frame, |repair| {
        let repaired = repair.apply(frame);
        // Bytes that stay in their places are proof enough for a maker's own function, in a frame of modest length.
        let keeps_places = matches!(repair, Repair::Bit { .. } | Repair::SwapCheck);
        let is_own = keeps_places && frame.len() <= MAX_OWN_LEN && pdu(&repaired).is_some_and(is_own_function);
        if !is_own && !is_whole(&repaired, around) {
            return;
        }
        match repair {
            Repair::Bit { byte, bit } => found.push(Diagnosis::SingleBitError { byte, bit, repaired }),
            Repair::SwapCheck => found.push(Diagnosis::SwappedCrc { repaired }),
            Repair::Insert { at, .. } => inserts.push(Placed { at, repaired }),
            Repair::Remove { at } => removes.push(Placed { at, repaired }),
        }
    });
    if !inserts.is_empty() {
        found.push(Diagnosis::MissingByte { repair: only(inserts, around) });
    }
    if !removes.is_empty() {
        found.push(Diagnosis::ExtraByte { repair: only(removes, around) });
    }
    if let [_, pdu @ .., check] = frame
        && around.admits(shape::sides(pdu))
        && pdu.first().is_some_and(|function| shape::is_known(*function))
        && lrc(&frame[..frame.len() - 1]) == *check
    {
        found.push(Diagnosis::LrcInRtu);
    }
    // A frame that lost its end is cut off as well as short of a byte, and where the byte is lost may stay open.
    if found.iter().any(may_be_cut_off) {
        found.extend(truncated(frame, around));
    }
    found
}

/// Whether the bytes have the shape of a whole frame, whatever their check says.
pub(crate) fn is_whole(frame: &[u8], around: Surroundings<'_>) -> bool {
    let Some(pdu) = pdu(frame).filter(|_| frame.len() <= MAX_ADU_LEN) else { return false };
    pdu.first().is_some_and(|function| shape::is_known(*function)) && around.admits(shape::sides(pdu))
}

/// The PDU of a frame of at least four bytes.
pub(crate) fn pdu(frame: &[u8]) -> Option<&[u8]> {
    match frame {
        [_, pdu @ .., _, _] if !pdu.is_empty() => Some(pdu),
        _ => None,
    }
}

fn is_own_function(pdu: &[u8]) -> bool {
    pdu.first().is_some_and(|function| (1..0x80).contains(function) && !shape::is_known(*function))
}

/// The repair, if they all come to the same frame; of several, the one that answers the request.
fn only(mut repairs: Vec<Placed>, around: Surroundings<'_>) -> Option<Placed> {
    if repairs.len() > 1
        && let Some([asked, head @ ..]) = around.request
    {
        let answers = |placed: &Placed| {
            let unit = placed.repaired.first().copied();
            (unit == Some(*asked) || unit == Some(0))
                && pdu(&placed.repaired).is_some_and(|pdu| shape::accepts(head, pdu))
        };
        if repairs.iter().any(answers) {
            repairs.retain(answers);
        }
    }
    // Repairs come from the frame's end; in a run of equal bytes the first place counts.
    let first = repairs.pop()?;
    repairs.iter().all(|placed| placed.repaired == first.repaired).then_some(first)
}

fn may_be_cut_off(diagnosis: &Diagnosis) -> bool {
    let Diagnosis::MissingByte { repair } = diagnosis else { return false };
    // In a run of equal bytes each may be the lost one.
    repair.as_ref().is_none_or(|placed| {
        let rest = placed.repaired.get(placed.at..).unwrap_or_default();
        rest.iter().all(|byte| Some(byte) == rest.first())
    })
}

/// Whether the bytes begin a frame that is longer than they are.
pub(crate) fn truncated(frame: &[u8], around: Surroundings<'_>) -> Option<Diagnosis> {
    let [unit, pdu @ ..] = frame else { return None };
    let function = *pdu.first()?;
    if !shape::is_known(function) || *unit > 247 {
        return None;
    }
    let answers = around.direction != Direction::Request
        && around.request.is_some_and(|request| {
            request.get(1) == Some(&(function & 0x7F)) && (request.first() == Some(unit) || *unit == 0)
        });
    if frame.len() < if answers { MIN_LEN } else { MIN_TRUNCATED_LEN } {
        return None;
    }
    // What is left may hold a part of the check already.
    let longer = |extent| match extent {
        Extent::Exact(len) if len + 3 > frame.len() => Some(Some(len + 3)),
        Extent::AtLeast(len) if len + 3 > frame.len() => Some(None),
        _ => None,
    };
    let request = longer(shape::request_extent(pdu)).filter(|_| around.direction != Direction::Response);
    let response = longer(shape::response_extent(pdu)).filter(|_| around.direction != Direction::Request);
    let expected = match (request, response) {
        (None, None) => return None,
        (Some(one), None) | (None, Some(one)) => one,
        (Some(request), Some(response)) if request == response => request,
        (Some(_), Some(response)) if answers => response,
        (Some(_), Some(_)) => None,
    };
    Some(Diagnosis::Truncated { expected })
}

/// A byte count that does not fit the bytes there are, where the check is right or the request tells the length.
fn miscounted(frame: &[u8], around: Surroundings<'_>) -> Option<Diagnosis> {
    let [unit, pdu @ .., _, _] = frame else { return None };
    let certain = repair::is_right(frame)
        || around.request.is_some_and(|request| {
            request.first() == Some(unit)
                && request.get(1) == pdu.first()
                && request.get(1..).and_then(shape::response_len) == Some(pdu.len())
        });
    if certain { shape::miscounted(pdu, around.direction) } else { None }
}
