//! The lists of functions 14, 15 and 2B/0E.

use alloc::vec::Vec;

use super::wire::{push_words, quantity_of, words};
use super::{MAX_RECORD_NUMBER, PduError, REFERENCE_TYPE};
use crate::rtu::MAX_PDU_LEN;

/// Reference type, file number, record number and record length.
const RANGE_LEN: usize = 7;

/// Registers of a file that function 14 asks for (clause 6.14).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FileRecordRange {
    /// 1 to 65535.
    pub file_number: u16,
    /// First record, 0 to 9999.
    pub record_number: u16,
    /// Registers, at least 1.
    pub record_length: u16,
}

/// Registers of a file that function 15 writes (clause 6.15).
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FileRecord {
    /// 1 to 65535.
    pub file_number: u16,
    /// First record, 0 to 9999.
    pub record_number: u16,
    /// The registers, at least 1.
    pub values: Vec<u16>,
}

/// An object of a device's identification (clause 6.21).
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct DeviceIdObject {
    /// 00 to 02 are basic, 03 to 7F regular, 80 to FF the vendor's own.
    pub id: u8,
    /// Mostly text.
    pub value: Vec<u8>,
}

/// Length of the reply's PDU.
pub(super) fn reply_len(ranges: &[FileRecordRange]) -> usize {
    ranges.iter().fold(2, |sum, range| sum.saturating_add(2 + 2 * usize::from(range.record_length)))
}

/// Length of a request of function 15 and of its reply, which is the request again.
pub(super) fn echo_len(records: &[FileRecord]) -> usize {
    let len = |record: &FileRecord| record.values.len().saturating_mul(2).saturating_add(RANGE_LEN);
    records.iter().fold(2, |sum, record| sum.saturating_add(len(record)))
}

/// Everything after the byte count of a request of function 14.
pub(super) fn encode_ranges(ranges: &[FileRecordRange]) -> Result<Vec<u8>, PduError> {
    let mut bytes = Vec::new();
    for range in ranges {
        push_range(&mut bytes, *range)?;
    }
    check_ranges(ranges)?;
    Ok(bytes)
}

/// Undoes [`encode_ranges`].
pub(super) fn decode_ranges(bytes: &[u8]) -> Result<Vec<FileRecordRange>, PduError> {
    let mut ranges = Vec::new();
    let mut rest = bytes;
    while !rest.is_empty() {
        let (range, after) = split_range(bytes, rest)?;
        ranges.push(range);
        rest = after;
    }
    check_ranges(&ranges)?;
    Ok(ranges)
}

/// Everything after the byte count of function 15.
pub(super) fn encode_records(records: &[FileRecord]) -> Result<Vec<u8>, PduError> {
    let mut bytes = Vec::new();
    for FileRecord { file_number, record_number, values } in records {
        let record_length = quantity_of(values);
        let range = FileRecordRange { file_number: *file_number, record_number: *record_number, record_length };
        push_range(&mut bytes, range)?;
        push_words(&mut bytes, values);
    }
    check_any(&bytes, RANGE_LEN + 2)?;
    Ok(bytes)
}

/// Undoes [`encode_records`].
pub(super) fn decode_records(bytes: &[u8]) -> Result<Vec<FileRecord>, PduError> {
    check_any(bytes, RANGE_LEN + 2)?;
    let mut records = Vec::new();
    let mut rest = bytes;
    while !rest.is_empty() {
        let (FileRecordRange { file_number, record_number, record_length }, after) = split_range(bytes, rest)?;
        let (values, after) = split_at(bytes, after, 2 * usize::from(record_length))?;
        records.push(FileRecord { file_number, record_number, values: words(values) });
        rest = after;
    }
    Ok(records)
}

/// Everything after the byte count of a reply of function 14.
pub(super) fn encode_contents(records: &[Vec<u16>]) -> Result<Vec<u8>, PduError> {
    let mut bytes = Vec::new();
    for values in records {
        if values.is_empty() {
            return Err(PduError::RecordLength { found: 1 });
        }
        let count = values.len().saturating_mul(2).saturating_add(1);
        bytes.push(u8::try_from(count).map_err(|_| PduError::TooLong)?);
        bytes.push(REFERENCE_TYPE);
        push_words(&mut bytes, values);
    }
    check_any(&bytes, 4)?;
    Ok(bytes)
}

/// Undoes [`encode_contents`].
pub(super) fn decode_contents(bytes: &[u8]) -> Result<Vec<Vec<u16>>, PduError> {
    check_any(bytes, 4)?;
    let mut records = Vec::new();
    let mut rest = bytes;
    while let [count, after @ ..] = rest {
        let (record, after) = split_at(bytes, after, usize::from(*count))?;
        match record {
            [REFERENCE_TYPE, values @ ..] if !values.is_empty() && values.len() % 2 == 0 => records.push(words(values)),
            [REFERENCE_TYPE, ..] | [] => return Err(PduError::RecordLength { found: u16::from(*count) }),
            [found, ..] => return Err(PduError::ReferenceType { found: *found }),
        }
        rest = after;
    }
    Ok(records)
}

/// Everything after the number of objects in a reply of function 2B/0E.
pub(super) fn encode_objects(objects: &[DeviceIdObject]) -> Result<Vec<u8>, PduError> {
    let mut bytes = Vec::new();
    for DeviceIdObject { id, value } in objects {
        bytes.push(*id);
        bytes.push(u8::try_from(value.len()).map_err(|_| PduError::TooLong)?);
        bytes.extend_from_slice(value);
    }
    Ok(bytes)
}

/// Undoes [`encode_objects`]; `before` is how much of the PDU stands before `bytes`.
pub(super) fn decode_objects(bytes: &[u8], before: usize, count: u8) -> Result<Vec<DeviceIdObject>, PduError> {
    let length = |expected| PduError::Length { found: before + bytes.len(), expected };
    let (mut objects, mut at) = (Vec::new(), 0);
    for _ in 0..count {
        let Some(&[id, len]) = bytes.get(at..at + 2) else { return Err(length(before + at + 2)) };
        let end = at + 2 + usize::from(len);
        let Some(value) = bytes.get(at + 2..end) else { return Err(length(before + end)) };
        objects.push(DeviceIdObject { id, value: value.to_vec() });
        at = end;
    }
    if at == bytes.len() { Ok(objects) } else { Err(length(before + at)) }
}

fn push_range(bytes: &mut Vec<u8>, range: FileRecordRange) -> Result<(), PduError> {
    check_range(range)?;
    bytes.push(REFERENCE_TYPE);
    push_words(bytes, &[range.file_number, range.record_number, range.record_length]);
    Ok(())
}

/// Takes one range off `rest`, which is the end of `bytes`.
fn split_range<'a>(bytes: &[u8], rest: &'a [u8]) -> Result<(FileRecordRange, &'a [u8]), PduError> {
    let Some((&[reference_type, f1, f0, r1, r0, l1, l0], after)) = rest.split_first_chunk::<RANGE_LEN>() else {
        return Err(too_short(bytes, rest, RANGE_LEN));
    };
    if reference_type != REFERENCE_TYPE {
        return Err(PduError::ReferenceType { found: reference_type });
    }
    let range = FileRecordRange {
        file_number: u16::from_be_bytes([f1, f0]),
        record_number: u16::from_be_bytes([r1, r0]),
        record_length: u16::from_be_bytes([l1, l0]),
    };
    check_range(range)?;
    Ok((range, after))
}

fn check_range(range: FileRecordRange) -> Result<(), PduError> {
    if range.file_number == 0 {
        Err(PduError::FileNumber)
    } else if range.record_number > MAX_RECORD_NUMBER {
        Err(PduError::RecordNumber { found: range.record_number })
    } else if range.record_length == 0 {
        Err(PduError::RecordLength { found: 0 })
    } else {
        Ok(())
    }
}

/// The reply must fit a PDU.
fn check_ranges(ranges: &[FileRecordRange]) -> Result<(), PduError> {
    if ranges.is_empty() {
        return Err(PduError::Length { found: 2, expected: 2 + RANGE_LEN });
    }
    match reply_len(ranges) {
        found if found > MAX_PDU_LEN => Err(PduError::ReplyTooLong { found }),
        _ => Ok(()),
    }
}

fn check_any(bytes: &[u8], fewest: usize) -> Result<(), PduError> {
    if bytes.is_empty() { Err(PduError::Length { found: 2, expected: 2 + fewest }) } else { Ok(()) }
}

/// Takes `count` bytes off `rest`, which is the end of `bytes`, which follow function code and byte count.
fn split_at<'a>(bytes: &[u8], rest: &'a [u8], count: usize) -> Result<(&'a [u8], &'a [u8]), PduError> {
    rest.split_at_checked(count).ok_or_else(|| too_short(bytes, rest, count))
}

fn too_short(bytes: &[u8], rest: &[u8], count: usize) -> PduError {
    PduError::Length { found: 2 + bytes.len(), expected: 2 + bytes.len() - rest.len() + count }
}
