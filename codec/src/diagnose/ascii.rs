//! Damaged frames of ASCII mode.
//!
//! An LRC tells less than a CRC: often several characters could be the wrong one. A place is named only where the LRC, the
//! digits and the PDU's shape leave one.

use alloc::vec::Vec;

use super::shape::{self, Extent};
use super::{Diagnosis, Placed, Surroundings};
use crate::check::{crc16, lrc};
use crate::dissect::Direction;

/// Characters of a frame around its digits: colon, CR, LF.
const AROUND_DIGITS: usize = 3;
/// The colon and four digits.
const HEADER_LEN: usize = 5;
/// Fewest characters behind the colon that are taken for a frame.
const MIN_DIGITS: usize = 4;

/// What is wrong with these characters, if they are one damaged frame as a whole; else nothing.
pub(super) fn damage(frame: &[u8], around: Surroundings<'_>) -> Vec<Diagnosis> {
    let text: Vec<u8> = frame.iter().map(|character| character & 0x7F).collect();
    let mut found = Vec::new();
    if text.len() > crate::ascii::MAX_ADU_LEN + 1 {
        return found;
    }
    let Some(digits) = text.strip_prefix(b":") else { return without_colon(&text, around) };
    let Some(digits) = digits.strip_suffix(b"\r\n") else {
        return without_end(digits, around);
    };
    let strange: Vec<usize> = (0..digits.len()).filter(|&at| !digits[at].is_ascii_hexdigit()).collect();
    match strange.as_slice() {
        [] if digits.len() < MIN_DIGITS => {}
        [] if digits.len().is_multiple_of(2) => whole_bytes(digits, around, &mut found),
        [] => odd_digits(digits, around, &mut found),
        [first, rest @ ..] if digits.len() >= MIN_DIGITS.max(2 * (rest.len() + 1)) => {
            if rest.is_empty() {
                one_strange(digits, *first, around, &mut found);
            }
            found.push(Diagnosis::AsciiNotHex { at: first + 1 });
        }
        _ => {}
    }
    found
}

/// The bytes that digits spell: unit id, PDU, LRC; at least three. `None` for anything else.
pub(crate) fn bytes(digits: &[u8]) -> Option<Vec<u8>> {
    if digits.len() < 6 || !digits.len().is_multiple_of(2) {
        return None;
    }
    values(digits)
}

fn values(digits: &[u8]) -> Option<Vec<u8>> {
    let value = |digit: &u8| char::from(*digit).to_digit(16).and_then(|value| u8::try_from(value).ok());
    digits.chunks_exact(2).map(|pair| Some((value(pair.first()?)? << 4) | value(pair.last()?)?)).collect()
}

/// The unit id and the function code of a frame's characters, as long as these are digits.
pub(crate) fn header(frame: &[u8]) -> Option<(u8, u8)> {
    let head = frame.get(..HEADER_LEN).filter(|head| head.first().is_some_and(|colon| colon & 0x7F == b':'))?;
    match values(&digits(head))?.as_slice() {
        [unit, function] => Some((*unit, *function)),
        _ => None,
    }
}

/// The digits of a frame's characters, eighth bits put aside: what stands between colon and line end, where these are.
pub(crate) fn digits(frame: &[u8]) -> Vec<u8> {
    let text: Vec<u8> = frame.iter().map(|character| character & 0x7F).collect();
    let digits = text.strip_prefix(b":").unwrap_or(&text);
    let digits = digits.strip_suffix(b"\n").unwrap_or(digits);
    digits.strip_suffix(b"\r").unwrap_or(digits).to_vec()
}

/// Whether these bytes are a whole frame with a right LRC.
fn is_right(bytes: &[u8], around: Surroundings<'_>) -> bool {
    sum(bytes) == 0 && is_whole(bytes, around)
}

fn is_whole(bytes: &[u8], around: Surroundings<'_>) -> bool {
    matches!(bytes, [_, pdu @ .., _] if !pdu.is_empty() && around.admits(shape::sides(pdu)))
}

fn right(digits: &[u8], around: Surroundings<'_>) -> Option<Vec<u8>> {
    bytes(digits).filter(|bytes| is_right(bytes, around))
}

/// Zero over a frame with a right LRC.
fn sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

fn whole_bytes(digits: &[u8], around: Surroundings<'_>, found: &mut Vec<Diagnosis>) {
    let Some(bytes) = bytes(digits) else {
        found.push(Diagnosis::Truncated { expected: None });
        return;
    };
    let Some((_, body)) = bytes.split_last() else { return };
    let expected = lrc(body);
    if sum(&bytes) == 0 {
        return;
    }
    if let Some((body, check)) = bytes.split_last_chunk::<2>()
        && body.len() >= 2
        && (crc16(body).to_le_bytes() == *check || crc16(body).to_be_bytes() == *check)
    {
        found.push(Diagnosis::CrcInAscii);
    } else {
        let is_whole = is_whole(&bytes, around);
        if is_whole {
            found.extend(wrong_digit(digits, &bytes, around));
        }
        // Where the standard tells no length, any length looks whole.
        if !is_whole || !bytes.get(1..bytes.len() - 1).is_some_and(shape::is_exact) {
            changed_length(&bytes, around, found);
            found.extend(truncated(&bytes, around));
        }
    }
    found.push(Diagnosis::BadLrc { expected });
}

/// The only digit of which one turned bit makes the LRC right.
fn wrong_digit(digits: &[u8], bytes: &[u8], around: Surroundings<'_>) -> Option<Diagnosis> {
    let excess = sum(bytes);
    let mut found = None;
    for (at, digit) in digits.iter().enumerate() {
        let Some(old) = char::from(*digit).to_digit(16) else { continue };
        for bit in 0..7 {
            let Some(new) = char::from(digit ^ 1 << bit).to_digit(16) else { continue };
            let weight = if at.is_multiple_of(2) { 16 } else { 1 };
            let change = (old.wrapping_sub(new)).wrapping_mul(weight) & 0xFF;
            if new == old || change != u32::from(excess) {
                continue;
            }
            let repaired = with_digit(digits, at, digit ^ 1 << bit, around);
            if let Some(repaired) = repaired {
                if found.is_some() {
                    return None;
                }
                found = Some(Diagnosis::SingleBitError { byte: at + 1, bit, repaired });
            }
        }
    }
    found
}

/// A whole byte lost or added: two characters.
fn changed_length(bytes: &[u8], around: Surroundings<'_>, found: &mut Vec<Diagnosis>) {
    let excess = sum(bytes);
    let mut removes = Vec::new();
    let mut inserts = Vec::new();
    for at in 0..=bytes.len() {
        let earlier = at.checked_sub(1).and_then(|before| bytes.get(before)).copied();
        if bytes.get(at) == Some(&excess) && earlier != Some(excess) {
            let mut repaired = bytes.to_vec();
            repaired.remove(at);
            removes.push(Placed { at: 2 * at + 1, repaired });
        }
        if earlier != Some(excess.wrapping_neg()) {
            let mut repaired = bytes.to_vec();
            repaired.insert(at, excess.wrapping_neg());
            inserts.push(Placed { at: 2 * at + 1, repaired });
        }
    }
    let whole = |placed: &Placed| is_right(&placed.repaired, around);
    removes.retain(whole);
    inserts.retain(whole);
    length_changes(removes, inserts, found);
}

/// An added character or byte explains by its value, too; a lost one may have any.
fn length_changes(removes: Vec<Placed>, inserts: Vec<Placed>, found: &mut Vec<Diagnosis>) {
    if !removes.is_empty() {
        found.push(Diagnosis::ExtraByte { repair: only(removes) });
    }
    if !inserts.is_empty() {
        found.push(Diagnosis::MissingByte { repair: only(inserts) });
    }
}

/// A single character lost or added. The digits before it keep their places; those behind it change from high to low.
fn odd_digits(digits: &[u8], around: Surroundings<'_>, found: &mut Vec<Diagnosis>) {
    let mut removes = Vec::new();
    let mut inserts = Vec::new();
    // The sum over the digits before a place as they stand, and from it on as they stand with one digit more before them.
    let mut before = 0u8;
    let mut behind = digits.iter().enumerate().fold(0u8, |sum, (at, digit)| sum.wrapping_add(weighed(*digit, at + 1)));
    for at in 0..=digits.len() {
        let earlier = at.checked_sub(1).and_then(|before| digits.get(before));
        let wanted = 0u8.wrapping_sub(before).wrapping_sub(behind);
        let digit = if at.is_multiple_of(2) { wanted.rotate_right(4) } else { wanted };
        if let Some(digit) = char::from_digit(digit.into(), 16).and_then(|digit| u8::try_from(digit).ok())
            && earlier.is_none_or(|earlier| !earlier.eq_ignore_ascii_case(&digit))
        {
            let mut changed = digits.to_vec();
            changed.insert(at, digit);
            inserts.extend(right(&changed, around).map(|repaired| Placed { at: at + 1, repaired }));
        }
        let Some(digit) = digits.get(at) else { break };
        behind = behind.wrapping_sub(weighed(*digit, at + 1));
        if before.wrapping_add(behind) == 0 && earlier != Some(digit) {
            let mut changed = digits.to_vec();
            changed.remove(at);
            removes.extend(right(&changed, around).map(|repaired| Placed { at: at + 1, repaired }));
        }
        before = before.wrapping_add(weighed(*digit, at));
    }
    length_changes(removes, inserts, found);
    found.push(Diagnosis::AsciiNotHex { at: digits.len() });
}

/// What a digit adds to the sum of bytes at a place among the digits.
fn weighed(digit: u8, at: usize) -> u8 {
    let value = char::from(digit).to_digit(16).and_then(|value| u8::try_from(value).ok()).unwrap_or_default();
    if at.is_multiple_of(2) { value << 4 } else { value }
}

/// One character that is no digit: a digit with a wrong bit, or one too many.
fn one_strange(digits: &[u8], at: usize, around: Surroundings<'_>, found: &mut Vec<Diagnosis>) {
    let Some(character) = digits.get(at) else { return };
    let mut repairs = (0..7).filter_map(|bit| {
        let repaired = with_digit(digits, at, character ^ 1 << bit, around)?;
        Some(Diagnosis::SingleBitError { byte: at + 1, bit, repaired })
    });
    found.extend(repairs.next());
    let mut shorter = digits.to_vec();
    shorter.remove(at);
    let repair = right(&shorter, around).map(|repaired| Placed { at: at + 1, repaired });
    found.extend(repair.map(|repair| Diagnosis::ExtraByte { repair: Some(repair) }));
}

fn with_digit(digits: &[u8], at: usize, digit: u8, around: Surroundings<'_>) -> Option<Vec<u8>> {
    let mut changed = digits.to_vec();
    *changed.get_mut(at)? = digit;
    right(&changed, around)
}

/// A frame whose colon is lost or damaged.
fn without_colon(text: &[u8], around: Surroundings<'_>) -> Vec<Diagnosis> {
    let mut found = Vec::new();
    let Some(digits) = text.strip_suffix(b"\r\n") else { return found };
    if let Some(repaired) = right(digits, around) {
        found.push(Diagnosis::MissingByte { repair: Some(Placed { at: 0, repaired }) });
    } else if let [first, digits @ ..] = digits
        && let Some(bit) = (0..7).find(|bit| first ^ 1 << bit == b':')
        && let Some(repaired) = right(digits, around)
    {
        found.push(Diagnosis::SingleBitError { byte: 0, bit, repaired });
    }
    found
}

/// A frame whose CR LF is lost or damaged, or that ends before it.
fn without_end(digits: &[u8], around: Surroundings<'_>) -> Vec<Diagnosis> {
    let mut found = Vec::new();
    if let Some((digits, &[cr, lf])) = digits.split_last_chunk::<2>()
        && let Some(repaired) = right(digits, around)
    {
        let turned = |character: u8, meant: u8| (0..7).find(|bit| character ^ 1 << bit == meant);
        let (byte, bit) = match (turned(cr, b'\r'), turned(lf, b'\n')) {
            (Some(bit), None) if lf == b'\n' => (digits.len() + 1, bit),
            (None, Some(bit)) if cr == b'\r' => (digits.len() + 2, bit),
            _ => return found,
        };
        found.push(Diagnosis::SingleBitError { byte, bit, repaired });
        return found;
    }
    let stripped = digits.strip_suffix(b"\n").or(digits.strip_suffix(b"\r")).unwrap_or(digits);
    let place = stripped.len() + 1 + usize::from(digits.ends_with(b"\r"));
    if let Some(repaired) = right(stripped, around) {
        if stripped.len() < digits.len() {
            found.push(Diagnosis::MissingByte { repair: Some(Placed { at: place, repaired }) });
        }
        found.push(Diagnosis::Truncated { expected: Some(stripped.len() + AROUND_DIGITS) });
    } else if stripped.len() >= MIN_DIGITS && stripped.iter().all(u8::is_ascii_hexdigit) {
        let even = stripped.len() & !1;
        let bytes = bytes(&stripped[..even]);
        let expected = bytes.as_deref().and_then(|bytes| truncated(bytes, around));
        found.push(expected.unwrap_or(Diagnosis::Truncated { expected: None }));
        if let Some((check, body)) = bytes.as_deref().and_then(<[u8]>::split_last)
            && lrc(body) != *check
        {
            found.push(Diagnosis::BadLrc { expected: lrc(body) });
        }
    }
    found
}

fn truncated(bytes: &[u8], around: Surroundings<'_>) -> Option<Diagnosis> {
    let pdu = bytes.get(1..)?;
    if !shape::is_known(*pdu.first()?) {
        return None;
    }
    let longer = |extent| match extent {
        Extent::Exact(len) if len + 2 > bytes.len() => Some(Some(2 * (len + 2) + AROUND_DIGITS)),
        Extent::AtLeast(len) if len + 2 > bytes.len() => Some(None),
        _ => None,
    };
    let request = longer(shape::request_extent(pdu)).filter(|_| around.direction != Direction::Response);
    let response = longer(shape::response_extent(pdu)).filter(|_| around.direction != Direction::Request);
    let expected = match (request, response) {
        (None, None) => return None,
        (Some(one), None) | (None, Some(one)) => one,
        (Some(request), Some(response)) => request.filter(|_| request == response),
    };
    Some(Diagnosis::Truncated { expected })
}

/// The repair, if they all come to the same frame.
fn only(repairs: Vec<Placed>) -> Option<Placed> {
    let mut repairs = repairs.into_iter();
    let first = repairs.next()?;
    repairs.all(|placed| placed.repaired == first.repaired).then_some(first)
}
