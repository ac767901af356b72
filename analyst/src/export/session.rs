//! The list as a session, which can be brought in again without loss.

use std::ops::RangeInclusive;

use buslens_codec::session::{write_entry, write_event, write_head};

use super::Sheet;
use crate::desk::place;

pub(super) fn head(sheet: &Sheet<'_>, out: &mut String) {
    write_head(out, sheet.diary.epoch_us, sheet.diary.line);
}

/// What happened before these entries.
pub(super) fn events(sheet: &Sheet<'_>, before: RangeInclusive<u32>, out: &mut String) {
    for happened in sheet.diary.within(before) {
        write_event(out, happened.at_us, happened.event);
    }
}

pub(super) fn entry(sheet: &Sheet<'_>, index: usize, out: &mut String) {
    if let Some(entry) = sheet.transcript.entry(index) {
        write_entry(out, &entry, sheet.transcript.entry_bytes(index), sheet.diary.mark_of(place(index)));
    }
}
