//! What a PDU's own bytes say of its length and its direction (application protocol V1.1b3, clause 6), without taking it
//! apart. Takes any bytes and never panics.

use super::Diagnosis;
use crate::dissect::Direction;

/// How long a PDU is, by what it begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    /// So many bytes, function code included.
    Exact(usize),
    /// The byte that tells is not there yet; so many bytes are needed at least.
    AtLeast(usize),
    /// A field holds what the standard forbids.
    Forbidden,
    /// The standard does not tell for this function.
    Unknown,
}

use Extent::{AtLeast, Exact, Forbidden, Unknown};

/// Longest list of data bytes behind a byte count.
const MAX_COUNT: u8 = 251;
/// Bytes of the longest answer to function 2B/0E.
const MAX_PDU_LEN: usize = crate::rtu::MAX_PDU_LEN;

/// Which ways a whole PDU can go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sides {
    /// It can be a request.
    pub(crate) request: bool,
    /// It can be a response.
    pub(crate) response: bool,
}

/// Which ways a PDU can go. A function that the standard does not know goes both ways; bytes that fit neither way go
/// none.
pub(crate) fn sides(pdu: &[u8]) -> Sides {
    let fits = |extent| match extent {
        Exact(len) => len == pdu.len(),
        Unknown => !pdu.is_empty(),
        AtLeast(_) | Forbidden => false,
    };
    Sides { request: fits(request_extent(pdu)), response: fits(response_extent(pdu)) }
}

/// Whether the standard tells a length for this PDU, and it has it.
pub(crate) fn is_exact(pdu: &[u8]) -> bool {
    [request_extent(pdu), response_extent(pdu)].contains(&Exact(pdu.len()))
}

/// Whether the standard tells the lengths of this function, an exception's top bit put aside.
pub(crate) fn is_known(function: u8) -> bool {
    matches!(function & 0x7F, 0x01..=0x08 | 0x0B | 0x0C | 0x0F..=0x11 | 0x14..=0x18 | 0x2B)
}

/// The extent of a request that begins with `pdu`.
pub(crate) fn request_extent(pdu: &[u8]) -> Extent {
    let Some(&function) = pdu.first() else { return AtLeast(1) };
    match function {
        0x01 | 0x02 => with_quantity(pdu, 5, 2000),
        0x03 | 0x04 => with_quantity(pdu, 5, 125),
        0x05 => coil_value(pdu),
        0x06 | 0x08 => Exact(5),
        0x07 | 0x0B | 0x0C | 0x11 => Exact(1),
        0x0F => counted_write(pdu, |quantity| quantity.div_ceil(8), 1968),
        0x10 => counted_write(pdu, |quantity| quantity * 2, 123),
        0x14 => counted(pdu, |count| count % 7 == 0 && (7..=245).contains(&count)),
        0x15 => counted(pdu, |count| (9..=MAX_COUNT).contains(&count)),
        0x16 => Exact(7),
        0x17 => read_write(pdu),
        0x18 => Exact(3),
        0x2B => match pdu.get(1) {
            Some(0x0E) => Exact(4),
            Some(_) => Unknown,
            None => AtLeast(2),
        },
        0x80.. => Forbidden,
        _ => Unknown,
    }
}

/// The extent of a response that begins with `pdu`.
pub(crate) fn response_extent(pdu: &[u8]) -> Extent {
    let Some(&function) = pdu.first() else { return AtLeast(1) };
    match function {
        0x01 | 0x02 => counted(pdu, |count| (1..=250).contains(&count)),
        0x03 | 0x04 | 0x17 => counted(pdu, |count| count % 2 == 0 && (2..=250).contains(&count)),
        0x05 => coil_value(pdu),
        0x06 | 0x08 | 0x0B => Exact(5),
        0x07 => Exact(2),
        0x0C => counted(pdu, |count| (6..=70).contains(&count)),
        0x0F => with_quantity(pdu, 5, 1968),
        0x10 => with_quantity(pdu, 5, 123),
        0x11 | 0x14 | 0x15 => counted(pdu, |count| (1..=MAX_COUNT).contains(&count)),
        0x16 => Exact(7),
        0x18 => match word(pdu, 1) {
            Some(count) if (2..=64).contains(&count) && count % 2 == 0 => Exact(3 + usize::from(count)),
            Some(_) => Forbidden,
            None => AtLeast(5),
        },
        0x2B => match pdu.get(1) {
            Some(0x0E) => identification(pdu),
            Some(_) => Unknown,
            None => AtLeast(2),
        },
        0x80.. if is_known(function) => match pdu.get(1) {
            Some(0 | 12..) => Forbidden,
            _ => Exact(2),
        },
        0x80.. => Forbidden,
        _ => Unknown,
    }
}

/// Most bytes that [`accepts`] reads of a request.
pub(crate) const HEAD_LEN: usize = 8;

/// Whether `response` can answer the request that begins with `head`: [`HEAD_LEN`] bytes of it, or all there are. The
/// byte count fits the quantity and echoed fields are equal, or the request's function is refused.
pub(crate) fn accepts(head: &[u8], response: &[u8]) -> bool {
    let (Some(&asked), Some(&answered)) = (head.first(), response.first()) else { return false };
    if answered >= 0x80 {
        return answered & 0x7F == asked && response.len() == 2;
    }
    if asked != answered {
        return false;
    }
    let counts = |bytes: u16| {
        response.get(1).is_some_and(|count| u16::from(*count) == bytes) && response.len() == 2 + usize::from(bytes)
    };
    match asked {
        0x01 | 0x02 => word(head, 3).is_some_and(|quantity| counts(quantity.div_ceil(8))),
        0x03 | 0x04 | 0x17 => word(head, 3).is_some_and(|quantity| counts(quantity.saturating_mul(2))),
        0x05 | 0x06 | 0x16 => head == response,
        0x08 => head.get(1..3) == response.get(1..3) && (head.get(1..3) != Some(&[0, 0]) || response.starts_with(head)),
        0x0F | 0x10 => head.get(1..5) == response.get(1..5) && response.len() == 5,
        _ => sides(response).response,
    }
}

/// Bytes that the normal response to a request has, its function code included, where the request tells.
pub(crate) fn response_len(head: &[u8]) -> Option<usize> {
    let quantity = || word(head, 3).map(usize::from);
    match head.first()? {
        0x01 | 0x02 => Some(2 + quantity()?.div_ceil(8)),
        0x03 | 0x04 | 0x17 => Some(2 + quantity()? * 2),
        0x05 | 0x06 | 0x08 | 0x0B | 0x0F | 0x10 => Some(5),
        0x07 => Some(2),
        0x16 => Some(7),
        _ => None,
    }
}

/// A byte count that does not fit the bytes behind it.
pub(crate) fn miscounted(pdu: &[u8], direction: Direction) -> Option<Diagnosis> {
    let sides = sides(pdu);
    if sides.request || sides.response {
        return None;
    }
    let place = match pdu.first()? {
        0x01..=0x04 | 0x0C | 0x11 | 0x17 if direction != Direction::Request => 1,
        0x0F | 0x10 if direction != Direction::Response => 5,
        _ => return None,
    };
    let found = *pdu.get(place)?;
    let expected = pdu.len().checked_sub(place + 1)?;
    (usize::from(found) != expected).then_some(Diagnosis::ByteCountMismatch { found, expected })
}

/// Whether the normal response to this function is the request itself.
pub(crate) fn is_echoed(pdu: &[u8]) -> bool {
    matches!(pdu, [0x05 | 0x06 | 0x16, ..] | [0x08, 0, 0, ..])
}

fn word(pdu: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes([*pdu.get(at)?, *pdu.get(at + 1)?]))
}

fn with_quantity(pdu: &[u8], len: usize, most: u16) -> Extent {
    match word(pdu, 3) {
        Some(quantity) if !(1..=most).contains(&quantity) => Forbidden,
        _ => Exact(len),
    }
}

fn coil_value(pdu: &[u8]) -> Extent {
    match word(pdu, 3) {
        Some(0xFF00 | 0x0000) | None => Exact(5),
        Some(_) => Forbidden,
    }
}

/// A byte count behind the function code.
fn counted(pdu: &[u8], allowed: impl Fn(u8) -> bool) -> Extent {
    match pdu.get(1) {
        Some(count) if allowed(*count) => Exact(2 + usize::from(*count)),
        Some(_) => Forbidden,
        None => AtLeast(3),
    }
}

fn counted_write(pdu: &[u8], bytes: impl Fn(u16) -> u16, most: u16) -> Extent {
    match word(pdu, 3) {
        Some(quantity) if (1..=most).contains(&quantity) => {
            let expected = bytes(quantity);
            match pdu.get(5) {
                Some(count) if u16::from(*count) != expected => Forbidden,
                _ => Exact(6 + usize::from(expected)),
            }
        }
        Some(_) => Forbidden,
        None => AtLeast(7),
    }
}

/// Function 17: the part that is read, then the part that is written.
fn read_write(pdu: &[u8]) -> Extent {
    if word(pdu, 3).is_some_and(|quantity| !(1..=125).contains(&quantity)) {
        return Forbidden;
    }
    match word(pdu, 7) {
        Some(quantity) if (1..=121).contains(&quantity) => match pdu.get(9) {
            Some(count) if u16::from(*count) != quantity * 2 => Forbidden,
            _ => Exact(10 + usize::from(quantity) * 2),
        },
        Some(_) => Forbidden,
        None => AtLeast(12),
    }
}

/// Function 2B/0E: six bytes, a number of objects, and each object with its id and length.
fn identification(pdu: &[u8]) -> Extent {
    let Some(objects) = pdu.get(6) else { return AtLeast(7) };
    let mut len = 7;
    for _ in 0..*objects {
        match pdu.get(len + 1) {
            Some(object) => len += 2 + usize::from(*object),
            None => return AtLeast(len + 2),
        }
        if len > MAX_PDU_LEN {
            return Forbidden;
        }
    }
    Exact(len)
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use proptest::prelude::*;

    use super::*;
    use crate::pdu::{Request, Response};

    #[test]
    fn lengths_are_told_by_the_function() {
        assert_eq!(request_extent(&[0x03]), Exact(5));
        assert_eq!(request_extent(&[0x03, 0, 0, 0, 0]), Forbidden);
        assert_eq!(response_extent(&[0x03]), AtLeast(3));
        assert_eq!(response_extent(&[0x03, 4]), Exact(6));
        assert_eq!(response_extent(&[0x03, 3]), Forbidden);
        assert_eq!(request_extent(&[0x10, 0, 0x32, 0, 1]), Exact(8));
        assert_eq!(request_extent(&[0x10, 0, 0x32, 0, 1, 3]), Forbidden);
        assert_eq!(response_extent(&[0x83, 2]), Exact(2));
        assert_eq!(response_extent(&[0x2B, 0x0E, 1, 1, 0, 0, 2, 0, 3, 65, 66, 67, 1, 1, 65]), Exact(15));
        assert_eq!(response_extent(&[0x2B, 0x0E, 1, 1, 0, 0, 1, 0]), AtLeast(9));
        assert_eq!(response_extent(&[0x41, 1, 2]), Unknown);
    }

    proptest! {
        /// What decodes as a request or a response has the shape of one.
        #[test]
        fn what_decodes_has_its_shape(pdu in prop::collection::vec(any::<u8>(), 1..20)) {
            let sides = sides(&pdu);
            if is_known(pdu[0]) && matches!(pdu[0], 0x03..=0x06 | 0x10) {
                prop_assert_eq!(Request::decode(&pdu).is_ok(), sides.request);
                prop_assert_eq!(Response::decode(&pdu).is_ok(), sides.response);
            }
        }

        /// The bytes of request and response accept each other exactly where their values do.
        #[test]
        fn bytes_accept_what_values_accept(address in 0u16..3, quantity in 1u16..4, values in prop::collection::vec(0u16..2, 1..4), function in 0usize..5, answer in 0usize..6) {
            let request = match function {
                0 => Request::ReadHoldingRegisters { address, quantity },
                1 => Request::ReadInputRegisters { address, quantity },
                2 => Request::WriteSingleCoil { address, on: quantity > 1 },
                3 => Request::WriteSingleRegister { address, value: quantity },
                _ => Request::WriteMultipleRegisters { address, values: values.clone() },
            };
            let response = match answer {
                0 => Response::ReadHoldingRegisters { values },
                1 => Response::ReadInputRegisters { values },
                2 => Response::WriteSingleCoil { address: 1, on: values[0] > 0 },
                3 => Response::WriteSingleRegister { address: 1, value: 1 + values[0] },
                4 => Response::WriteMultipleRegisters { address: 1, quantity },
                _ => Response::Exception { function: 3, code: 2.into() },
            };
            let (asked, answered) = (request.encode().unwrap(), response.encode().unwrap());
            let head: Vec<u8> = asked.iter().copied().take(HEAD_LEN).collect();
            prop_assert_eq!(accepts(&head, &answered), request.accepts(&response));
            prop_assert_eq!(response_len(&head), request.response_pdu_len());
        }

        #[test]
        fn any_bytes_are_judged(pdu in prop::collection::vec(any::<u8>(), 0..300), other in prop::collection::vec(any::<u8>(), 0..20)) {
            let _ = (sides(&pdu), accepts(&other, &pdu), response_len(&other), is_echoed(&pdu));
        }
    }
}
