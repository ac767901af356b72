//! Streams that hold frames with right checks, which hardly come by chance.

use buslens_codec::line::Mode;
use buslens_codec::segment::Segment;
use buslens_codec::{UnitId, adu};

use super::input::{Input, direction};

/// Longer streams show nothing more: noise is given out after 4096 bytes.
const MOST_BYTES: usize = 16 << 10;

/// A stream and what is told of it.
#[derive(Default)]
pub(super) struct Script {
    pub(super) stream: Vec<u8>,
    pub(super) segments: Vec<Segment>,
}

impl Script {
    /// Piece after piece: a byte for its kind, then what the kind takes.
    pub(super) fn read(mut input: Input<'_>) -> Self {
        let mut script = Self::default();
        let mut last = Vec::new();
        let mut time_us = 0;
        while !input.is_empty() && script.stream.len() < MOST_BYTES {
            let kind = input.byte();
            let (place, value) = if kind & 7 >= 5 { (input.byte(), input.byte()) } else { (0, 0) };
            let mode = if kind & 8 == 0 { Mode::Rtu } else { Mode::Ascii };
            match kind & 7 {
                // The same again.
                1 => {}
                // Another segment.
                5 => {
                    time_us += u64::from(value) * 1000;
                    script.segments.push(Segment {
                        start: script.stream.len(),
                        mode,
                        direction: direction(kind >> 4),
                        time_us: (kind & 0x40 == 0).then_some(time_us),
                        line: script.segments.last().map_or(1, |segment| segment.line) + u32::from(place & 1),
                        ..Segment::default()
                    });
                    continue;
                }
                // Damaged: changed, lost, doubled.
                6 | 7 => {
                    last = frame(mode, input.counted());
                    if !last.is_empty() {
                        let place = usize::from(place) % last.len();
                        match (kind & 7, kind & 0x10) {
                            (6, _) => last[place] ^= value,
                            (_, 0) => drop(last.remove(place)),
                            _ => last.insert(place, value),
                        }
                    }
                }
                2..=4 => last = frame(mode, input.counted()),
                _ => last = input.counted().to_vec(),
            }
            script.stream.extend_from_slice(&last);
        }
        script
    }
}

/// Unit id and PDU in a frame; as they are where they do not fit one.
fn frame(mode: Mode, body: &[u8]) -> Vec<u8> {
    let framed = body.split_first().and_then(|(unit, pdu)| adu::encode(mode, UnitId(*unit), pdu));
    framed.unwrap_or_else(|| body.to_vec())
}
