//! The list as a capture file that Wireshark takes for Modbus RTU without being told.
//!
//! It is the classic format, little endian, with microseconds. There is no link type for Modbus RTU on a serial line, so each
//! packet is an "upper PDU": tags before the bytes name the dissector and tell where the packet comes from and goes to.
//! Wireshark takes a frame to port 502 for a request and one from it for a response, and finds transactions by the
//! addresses; the device with the unit id N is 10.0.1.N here, the master 10.0.0.1.

use buslens_codec::dissect::Direction;
use buslens_codec::line::Mode;
use buslens_codec::rtu;
use buslens_codec::transcript::{Entry, EntryKind};
use std::borrow::Cow;

use super::{PORTION, Sheet};
use crate::desk::parts;

/// The link type "Wireshark upper PDU export".
const UPPER_PDU: u32 = 252;
/// The longest packet.
const MOST_BYTES: u32 = 65_535;
/// Name of the dissector, as text.
const TAG_DISSECTOR: u16 = 12;
/// Addresses and ports, and what kind of ports they are.
const TAG_SOURCE: u16 = 20;
const TAG_DESTINATION: u16 = 21;
const TAG_PORT_TYPE: u16 = 24;
const TAG_SOURCE_PORT: u16 = 25;
const TAG_DESTINATION_PORT: u16 = 26;
/// TCP.
const PORT_TYPE: u32 = 2;
/// The port by which Wireshark knows a device.
const DEVICE_PORT: u32 = 502;
/// Any other.
const MASTER_PORT: u32 = 50_502;

/// Writes a packet for each frame and each stretch of noise.
pub(super) fn write(sheet: &Sheet<'_>, shown: impl Iterator<Item = usize>, mut write: impl FnMut(&[u8])) {
    let mut out = Vec::new();
    let (magic, version, zone, accuracy) = (0xA1B2_C3D4_u32, [2_u16, 4], 0_u32, 0_u32);
    out.extend(magic.to_le_bytes());
    out.extend(version.map(u16::to_le_bytes).concat());
    out.extend([zone, accuracy, MOST_BYTES, UPPER_PDU].map(u32::to_le_bytes).concat());
    let mut time_us = 0;
    let mut packet = Vec::new();
    for index in shown {
        let Some(entry) = sheet.transcript.entry(index) else { continue };
        // Entries without a time share that of the one before.
        time_us = entry.time_us.unwrap_or(time_us);
        let moment_us = sheet.diary.epoch_us.unwrap_or(0).saturating_add(time_us);
        packet.clear();
        fill(&mut packet, sheet, index, &entry);
        packet.truncate(MOST_BYTES as usize);
        let seconds = u32::try_from(moment_us / 1_000_000).unwrap_or(u32::MAX);
        let micros = u32::try_from(moment_us % 1_000_000).unwrap_or(0);
        let length = u32::try_from(packet.len()).unwrap_or(MOST_BYTES);
        out.extend([seconds, micros, length, length].map(u32::to_le_bytes).concat());
        out.extend_from_slice(&packet);
        if out.len() >= PORTION {
            write(&out);
            out.clear();
        }
    }
    write(&out);
}

fn fill(packet: &mut Vec<u8>, sheet: &Sheet<'_>, index: usize, entry: &Entry) {
    let bytes = sheet.transcript.entry_bytes(index);
    let frame = rtu_frame(entry, bytes);
    tag(packet, TAG_DISSECTOR, if frame.is_some() { b"mbrtu" } else { b"data" });
    let request = entry.pair.filter(|_| entry.direction == Direction::Response);
    // A device answers a broadcast under its own unit id.
    let addressed = request.and_then(|request| sheet.transcript.header(request as usize));
    let unit = addressed.or(sheet.transcript.header(index)).map_or(0, |(unit, _)| unit.0);
    let (master, device) = (([10, 0, 0, 1], MASTER_PORT), ([10, 0, 1, unit], DEVICE_PORT));
    let answers = match entry.direction {
        Direction::Unknown => entry.mark == Direction::Response,
        direction => direction == Direction::Response,
    };
    let (source, destination) = if answers { (device, master) } else { (master, device) };
    tag(packet, TAG_SOURCE, &source.0);
    tag(packet, TAG_DESTINATION, &destination.0);
    tag(packet, TAG_PORT_TYPE, &PORT_TYPE.to_be_bytes());
    tag(packet, TAG_SOURCE_PORT, &source.1.to_be_bytes());
    tag(packet, TAG_DESTINATION_PORT, &destination.1.to_be_bytes());
    tag(packet, 0, &[]);
    packet.extend_from_slice(frame.as_deref().unwrap_or(bytes));
}

/// A frame as RTU has it. Wireshark knows no ASCII mode: a frame of it with a right check is shown by what it carries.
fn rtu_frame<'a>(entry: &Entry, bytes: &'a [u8]) -> Option<Cow<'a, [u8]>> {
    match (entry.kind, entry.mode) {
        (EntryKind::Frame, Mode::Rtu) => Some(Cow::Borrowed(bytes)),
        (EntryKind::Frame, Mode::Ascii) if entry.check_ok => {
            let (unit, pdu) = parts(entry, bytes)?;
            rtu::encode(unit, &pdu).ok().map(Cow::Owned)
        }
        _ => None,
    }
}

/// Number and length, big endian, then the value, filled up to words of four bytes.
fn tag(packet: &mut Vec<u8>, number: u16, value: &[u8]) {
    let length = value.len().next_multiple_of(4);
    packet.extend(number.to_be_bytes());
    packet.extend(u16::try_from(length).unwrap_or(0).to_be_bytes());
    packet.extend_from_slice(value);
    packet.resize(packet.len() + length - value.len(), 0);
}
