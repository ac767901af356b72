//! A line an entry, in columns between tabs: time, way, unit id, gap, bytes, meaning.

use std::fmt::Write as _;

use buslens_codec::dissect::{Direction, Dissection, NamedValue};
use buslens_codec::line::Mode;
use buslens_codec::transcript::{Entry, EntryKind};

use super::{Sheet, hex};
use crate::timing;

const DAY_US: u64 = 86_400_000_000;

/// Writes an entry's line. Intake reads it as what it is.
pub(super) fn line(sheet: &Sheet<'_>, index: usize, entry: &Entry, out: &mut String) {
    match (entry.time_us, sheet.diary.epoch_us) {
        (Some(time_us), Some(epoch_us)) => write_moment(out, epoch_us.saturating_add(time_us)),
        (Some(time_us), None) => write_seconds(out, time_us),
        (None, _) => out.push('-'),
    }
    out.push_str(match entry.direction {
        Direction::Request => "\tTX\t",
        Direction::Response => "\tRX\t",
        Direction::Unknown => "\t--\t",
    });
    match sheet.transcript.header(index) {
        // Writing to a string cannot fail.
        Some((unit, _)) => drop(write!(out, "{unit}\t")),
        None => out.push_str("-\t"),
    }
    match timing::gap_us(sheet.transcript, index, entry) {
        Some(gap_us) => {
            out.push('+');
            write_seconds(out, gap_us);
        }
        None => out.push('-'),
    }
    out.push('\t');
    write_bytes(sheet.transcript.entry_bytes(index), entry.mode, out);
    out.push('\t');
    let start = out.len();
    write_meaning(sheet, index, entry, out);
    // A profile's texts are its author's: one line is one entry whatever they hold.
    if out.get(start..).is_some_and(|meaning| meaning.contains(char::is_control)) {
        let meaning = out.split_off(start);
        out.extend(meaning.chars().map(|character| if character.is_control() { ' ' } else { character }));
    }
    out.push('\n');
}

/// The bytes; frames of ASCII mode as their characters, as long as these are plain.
fn write_bytes(bytes: &[u8], mode: Mode, out: &mut String) {
    let digits = match bytes {
        [b':', digits @ .., b'\r', b'\n'] if mode == Mode::Ascii && digits.iter().all(u8::is_ascii_hexdigit) => digits,
        _ => return hex(bytes, Some(' '), out),
    };
    out.push(':');
    out.extend(digits.iter().copied().map(char::from));
}

/// In the words of files for programs: what a request asks for, named values of a response, what is wrong.
fn write_meaning(sheet: &Sheet<'_>, index: usize, entry: &Entry, out: &mut String) {
    if entry.kind == EntryKind::Noise {
        return out.push_str("noise");
    }
    let reading = sheet.transcript.reading(index, sheet.profile, &mut sheet.known_before(index));
    if let Some(found) = &reading.dissection {
        let _ = write!(out, "function {}", found.function);
        write_fields(found, out);
        for point in &found.points {
            write_point(sheet, point, out);
        }
    }
    for diagnosis in &reading.diagnoses {
        out.push_str("; ");
        out.push_str(diagnosis.id());
    }
}

fn write_fields(found: &Dissection, out: &mut String) {
    if let Some(exception) = found.exception {
        let _ = write!(out, ", exception {}", exception.code());
        return;
    }
    if let Some(address) = found.address {
        let _ = write!(out, ", address {address}");
    }
    if let Some(quantity) = found.quantity {
        let _ = write!(out, ", quantity {quantity}");
    }
    // Named values say more.
    if found.points.is_empty() && !found.registers.is_empty() {
        out.push_str(", registers");
        for register in &found.registers {
            let _ = write!(out, " {register}");
        }
    }
}

fn write_point(sheet: &Sheet<'_>, named: &NamedValue, out: &mut String) {
    out.push_str("; ");
    out.push_str(&named.point);
    let point = sheet.profile.and_then(|profile| profile.point(&named.point));
    if let (Ok(value), Some(point)) = (named.value, point) {
        let _ = write!(out, " {}", point.text(value, |texts| &texts.en));
    }
    if !named.unit.is_empty() {
        let _ = write!(out, " {}", named.unit);
    }
}

fn write_seconds(out: &mut String, us: u64) {
    let _ = write!(out, "{}.{:06}", us / 1_000_000, us % 1_000_000);
}

/// A moment since 1970 as ISO 8601 has it, in UTC.
pub(crate) fn write_moment(out: &mut String, us: u64) {
    let (days, us) = (us / DAY_US, us % DAY_US);
    let (year, month, day) = date(days);
    let seconds = us / 1_000_000;
    let _ = write!(
        out,
        "{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}.{:06}Z",
        seconds / 3600,
        seconds / 60 % 60,
        seconds % 60,
        us % 1_000_000
    );
}

/// The date so many days after 1970-01-01, in the Gregorian calendar.
fn date(days: u64) -> (u64, u64, u64) {
    // Eras of 400 years; years begin in March, so that the leap day is the last one.
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, later) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    (era * 400 + year + later, month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_written_as_iso_8601() {
        for (us, expected) in [
            (0, "1970-01-01T00:00:00.000000Z"),
            (1_714_557_693_482_103, "2024-05-01T10:01:33.482103Z"),
            (951_782_399_999_999, "2000-02-28T23:59:59.999999Z"),
            (951_868_799_000_000, "2000-02-29T23:59:59.000000Z"),
            (951_868_800_000_000, "2000-03-01T00:00:00.000000Z"),
            (1_735_689_599_000_001, "2024-12-31T23:59:59.000001Z"),
            (4_107_542_400_000_000, "2100-03-01T00:00:00.000000Z"),
        ] {
            let mut out = String::new();
            write_moment(&mut out, us);
            assert_eq!(out, expected);
        }
    }
}
