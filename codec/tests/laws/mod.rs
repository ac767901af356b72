//! Laws that hold for any bytes. The fuzz targets look for bytes that break them; `laws.rs` holds them for the seeds.
//!
//! Each law takes bytes and reads from them what it needs; bytes that are missing count as zeros, so that any bytes say
//! something.

mod damage;
mod frames;
mod input;
mod intake;
mod pdu;
mod profile;
mod script;
mod splitter;
mod transcript;

/// Panics where bytes break it.
pub(crate) type Law = fn(&[u8]);

/// Name and law of each target.
pub(crate) const ALL: [(&str, Law); 7] = [
    ("intake", intake::any_text_is_taken),
    ("splitter", splitter::pieces_cover_the_stream),
    ("rtu", frames::rtu_frames_come_back),
    ("ascii", frames::ascii_frames_come_back),
    ("pdu", pdu::what_decodes_encodes),
    ("profile", profile::what_loads_decodes),
    ("transcript", transcript::entries_cover_the_stream),
];
