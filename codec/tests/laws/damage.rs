//! Frames with one fault, and what is said of them.

use buslens_codec::check::lrc;
use buslens_codec::diagnose::{Diagnosis, Surroundings, damage};
use buslens_codec::line::Mode;
use buslens_codec::rtu;

/// The frame with one fault: a bit, a byte lost or added, an end cut off, the last bytes swapped. The frame itself for
/// other kinds.
pub(super) fn with_fault(frame: &[u8], kind: u8, place: u8, value: u8) -> Vec<u8> {
    let mut frame = frame.to_vec();
    let len = frame.len();
    if len < 2 {
        return frame;
    }
    let at = usize::from(place) % len;
    match kind & 7 {
        1 => frame[at] ^= 1 << (value & 7),
        2 => drop(frame.remove(at)),
        3 => frame.insert(at, value),
        4 => frame.truncate(at),
        5 => frame.swap(len - 1, len - 2),
        6 => frame[at] = value,
        _ => {}
    }
    frame
}

/// The wrong check comes last, and what is said to be the whole frame has a right one. For frames with a wrong check.
pub(super) fn is_explained(mode: Mode, frame: &[u8], surroundings: Surroundings<'_>) {
    let found = damage(mode, frame, surroundings);
    for diagnosis in &found {
        assert!(!diagnosis.id().is_empty());
        if let Some(repaired) = diagnosis.repaired() {
            match mode {
                Mode::Rtu => assert!(rtu::decode(repaired).is_ok(), "{diagnosis:?}"),
                // Unit id, PDU and LRC: their sum is zero.
                Mode::Ascii => assert!(repaired.len() >= 3 && lrc(repaired) == 0, "{diagnosis:?}"),
            }
        }
    }
    let wrong = |diagnosis: &Diagnosis| matches!(diagnosis, Diagnosis::BadCrc { .. } | Diagnosis::BadLrc { .. });
    assert!(found.iter().rev().skip(1).all(|diagnosis| !wrong(diagnosis)), "{found:?}");
}
