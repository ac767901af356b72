//! Pieces that several functions share.

use alloc::vec::Vec;

use super::PduError;
use crate::rtu::MAX_PDU_LEN;

const COIL_ON: u16 = 0xFF00;
const COIL_OFF: u16 = 0x0000;

/// The function code and what follows it.
pub(super) fn split(pdu: &[u8]) -> Result<(u8, &[u8]), PduError> {
    if pdu.len() > MAX_PDU_LEN {
        return Err(PduError::TooLong);
    }
    pdu.split_first().map(|(function, data)| (*function, data)).ok_or(PduError::Empty)
}

/// All of what follows the function code, where its length is fixed.
pub(super) fn exactly<const N: usize>(data: &[u8]) -> Result<[u8; N], PduError> {
    data.try_into().map_err(|_| PduError::Length { found: 1 + data.len(), expected: 1 + N })
}

/// The four bytes after many function codes.
pub(super) fn two_words(data: &[u8]) -> Result<[u16; 2], PduError> {
    exactly(data).map(|[a, b, c, d]| [u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d])])
}

/// What follows a byte count, which must tell how much that is.
pub(super) fn counted(data: &[u8]) -> Result<&[u8], PduError> {
    match data {
        [count, bytes @ ..] if usize::from(*count) == bytes.len() => Ok(bytes),
        [count, bytes @ ..] => Err(PduError::ByteCount { found: *count, expected: bytes.len() }),
        [] => Err(PduError::Length { found: 1, expected: 2 }),
    }
}

/// The registers that follow a byte count.
pub(super) fn counted_words(data: &[u8], limit: u16) -> Result<Vec<u16>, PduError> {
    let bytes = counted(data)?;
    let found = u8::try_from(bytes.len()).unwrap_or(u8::MAX);
    if found % 2 != 0 {
        return Err(PduError::OddByteCount { found });
    }
    check_quantity(u16::from(found / 2), limit)?;
    Ok(words(bytes))
}

/// Quantity, byte count and the bytes themselves: the end of functions 0F, 10 and 17. `before` is how much of the PDU
/// stands before `data`, `bytes_of` how many bytes a quantity takes.
pub(super) fn quantity_and_bytes(
    data: &[u8],
    before: usize,
    limit: u16,
    bytes_of: fn(u16) -> usize,
) -> Result<(u16, &[u8]), PduError> {
    let length = |expected| PduError::Length { found: before + data.len(), expected: before + 3 + expected };
    let &[high, low, found, ref bytes @ ..] = data else { return Err(length(bytes_of(1))) };
    let quantity = u16::from_be_bytes([high, low]);
    check_quantity(quantity, limit)?;
    let expected = bytes_of(quantity);
    if usize::from(found) != expected {
        Err(PduError::ByteCount { found, expected })
    } else if bytes.len() != expected {
        Err(length(expected))
    } else {
        Ok((quantity, bytes))
    }
}

pub(super) fn register_bytes(quantity: u16) -> usize {
    2 * usize::from(quantity)
}

pub(super) fn bit_bytes(quantity: u16) -> usize {
    usize::from(quantity).div_ceil(8)
}

/// Writes what [`quantity_and_bytes`] reads; `quantity` belongs to `bytes`.
pub(super) fn push_quantity_and_bytes(pdu: &mut Vec<u8>, quantity: u16, bytes: &[u8]) -> Result<(), PduError> {
    push_words(pdu, &[quantity]);
    push_counted(pdu, bytes)
}

/// Writes what [`counted`] reads.
pub(super) fn push_counted(pdu: &mut Vec<u8>, bytes: &[u8]) -> Result<(), PduError> {
    pdu.push(u8::try_from(bytes.len()).map_err(|_| PduError::TooLong)?);
    pdu.extend_from_slice(bytes);
    Ok(())
}

pub(super) fn push_words(pdu: &mut Vec<u8>, words: &[u16]) {
    pdu.extend(words.iter().flat_map(|word| word.to_be_bytes()));
}

pub(super) fn words(bytes: &[u8]) -> Vec<u16> {
    bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect()
}

pub(super) fn word_bytes(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_be_bytes()).collect()
}

/// How many, as far as a PDU can say it; what is more is beyond every limit.
pub(super) fn quantity_of<T>(list: &[T]) -> u16 {
    u16::try_from(list.len()).unwrap_or(u16::MAX)
}

pub(super) fn check_quantity(found: u16, limit: u16) -> Result<(), PduError> {
    if (1..=limit).contains(&found) { Ok(()) } else { Err(PduError::Quantity { found, limit }) }
}

pub(super) fn check_count(found: u16, limit: u16) -> Result<(), PduError> {
    if found <= limit { Ok(()) } else { Err(PduError::Count { found, limit }) }
}

pub(super) fn check_length(pdu: Vec<u8>) -> Result<Vec<u8>, PduError> {
    if pdu.len() > MAX_PDU_LEN { Err(PduError::TooLong) } else { Ok(pdu) }
}

pub(super) fn coil_value(on: bool) -> u16 {
    if on { COIL_ON } else { COIL_OFF }
}

pub(super) fn coil_is_on(found: u16) -> Result<bool, PduError> {
    match found {
        COIL_ON => Ok(true),
        COIL_OFF => Ok(false),
        found => Err(PduError::CoilValue { found }),
    }
}
