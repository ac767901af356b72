//! Checks of many overlapping candidates, with bounded work for each byte of the stream.
//!
//! A candidate is checked byte by byte as long as this costs no more than a few steps for each byte of the stream so far:
//! always so in a stream of frames and common noise. A stream made to be slow claims a long frame at every place; there one
//! CRC runs over the stream once, and the check of every part of it follows from the CRC before and behind the part.

use alloc::vec::Vec;
use core::ops::Range;

use crate::check::{are_right, between, is_right, powers, step};
use crate::rtu::MAX_ADU_LEN;

/// Steps allowed for each byte of the stream, and at its start.
const STEPS_PER_BYTE: u64 = 4;
const STEPS_AT_START: u64 = 1024;
/// Checked byte by byte in any case: no dearer than the other way.
const SHORT: usize = 16;
/// The running CRC is kept for so many bytes before the place in question, at most.
const KEPT: usize = 4096;

#[derive(Clone, Debug, Default)]
pub(super) struct Checks {
    /// Steps made byte by byte.
    spent: u64,
    run: Run,
    /// Places at which no frame begins whose function tells its length.
    pub(super) bare: Range<u64>,
    #[cfg(test)]
    pub(super) work: u64,
}

/// A CRC that runs over a part of the stream, begun with zero.
#[derive(Clone, Debug, Default)]
struct Run {
    /// Place of the first byte.
    from: u64,
    /// The CRC before it, after it, after the next...
    crcs: Vec<u16>,
    /// The factors for up to the longest frame.
    powers: Vec<u16>,
}

impl Checks {
    /// Whether `bytes` begins with a frame of `len` bytes with a right check. `place`: bytes of the stream before them.
    #[inline]
    pub(super) fn is_right(&mut self, bytes: &[u8], place: u64, len: usize) -> bool {
        let Some(frame) = bytes.get(..len) else { return false };
        if self.allows(place, len) { is_right(frame) } else { self.is_right_by_run(frame, place) }
    }

    /// The same for two lengths, the shorter one first; a length of zero is none.
    #[inline]
    pub(super) fn are_right(&mut self, bytes: &[u8], place: u64, short: usize, long: usize) -> [bool; 2] {
        match bytes.get(..long) {
            Some(frame) if long > 0 && self.allows(place, long) => are_right(frame, short),
            _ => [short, long].map(|len| self.is_right(bytes, place, len)),
        }
    }

    /// Whether bytes may be checked one by one.
    #[inline]
    fn allows(&mut self, place: u64, len: usize) -> bool {
        let spent = self.spent.saturating_add(len as u64);
        let allowed = len <= SHORT || spent / STEPS_PER_BYTE <= place.saturating_add(STEPS_AT_START);
        if allowed {
            self.spent = spent;
            self.count(len);
        }
        allowed
    }

    /// The CRC `crc` after one more byte.
    pub(super) fn step(&mut self, crc: u16, byte: u8) -> u16 {
        self.count(1);
        step(crc, byte)
    }

    #[cold]
    fn is_right_by_run(&mut self, frame: &[u8], place: u64) -> bool {
        let (steps, right) = self.run.is_right(frame, place);
        self.count(steps + 16);
        right
    }

    #[cfg_attr(not(test), expect(clippy::unused_self, reason = "only tests count"))]
    #[inline]
    fn count(&mut self, steps: usize) {
        #[cfg(test)]
        {
            self.work += steps as u64;
        }
        #[cfg(not(test))]
        let _ = steps;
    }
}

impl Run {
    /// Steps made, and whether the check of `frame` is right.
    fn is_right(&mut self, frame: &[u8], place: u64) -> (usize, bool) {
        if self.powers.is_empty() {
            self.powers = powers().take(MAX_ADU_LEN + 1).collect();
        }
        let start = self.reach(place);
        // CRCs that are there already belong to the frame's first bytes.
        let known = self.crcs.len().saturating_sub(start + 1);
        let (_, new) = frame.split_at_checked(known).unwrap_or_default();
        let mut crc = self.crcs.last().copied().unwrap_or_default();
        for byte in new {
            crc = step(crc, *byte);
            self.crcs.push(crc);
        }
        let ends = (self.crcs.get(start), self.crcs.get(start + frame.len()), self.powers.get(frame.len()));
        let right = match ends {
            (Some(before), Some(after), Some(power)) => between(*before, *after, *power) == 0,
            _ => is_right(frame),
        };
        (new.len(), right)
    }

    /// Where the CRC before `place` stands; the run begins anew there if it has not come so far.
    fn reach(&mut self, place: u64) -> usize {
        let start = place.checked_sub(self.from).and_then(|start| usize::try_from(start).ok());
        match start {
            Some(start) if start < self.crcs.len() => {
                if start < KEPT {
                    return start;
                }
                self.crcs.drain(..start);
            }
            _ => {
                self.crcs.clear();
                self.crcs.push(0);
            }
        }
        self.from = place;
        0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::check::crc16;

    proptest! {
        /// Both ways say the same, whatever was asked before.
        #[test]
        fn the_run_agrees_with_each_check(
            mut bytes in prop::collection::vec(0u8..4, 600),
            asked in prop::collection::vec((0usize..340, 2usize..=256), 1..60),
            right in any::<u64>(),
        ) {
            let mut run = Run::default();
            let mut checks: Vec<(usize, usize)> = asked;
            checks.sort_unstable();
            for (nth, (place, len)) in checks.into_iter().enumerate() {
                if right >> (nth % 64) & 1 == 1 && nth == 0 {
                    let crc = crc16(&bytes[place..place + len - 2]).to_le_bytes();
                    bytes[place + len - 2..place + len].copy_from_slice(&crc);
                }
                let frame = &bytes[place..place + len];
                prop_assert_eq!(run.is_right(frame, place as u64).1, is_right(frame));
            }
        }
    }
}
