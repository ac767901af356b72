//! The one change that makes a wrong CRC right: a flipped bit, a lost byte, an added byte, a swapped check.
//!
//! The CRC's register is run forward from the frame's start and backward from its end. Where one changed byte joins both
//! runs, that byte is the repair: a single pass finds every candidate, whatever the length.

use alloc::vec::Vec;

use crate::check::crc16;

/// Longest run of bytes that is looked at: the longest frame and one byte more.
pub(crate) const MAX_LEN: usize = crate::rtu::MAX_ADU_LEN + 1;

/// A change that makes a frame's CRC right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Repair {
    /// A bit is turned over. The generator has an order of 32767, so no frame has two such bits.
    Bit {
        /// Its byte's place in the frame.
        byte: usize,
        /// 0 is the least significant bit.
        bit: u8,
    },
    /// A byte is put in.
    Insert {
        /// Bytes of the frame before it.
        at: usize,
        /// The byte.
        value: u8,
    },
    /// A byte is taken out.
    Remove {
        /// Its place in the frame.
        at: usize,
    },
    /// The two bytes of the check change places.
    SwapCheck,
}

impl Repair {
    /// The frame with this change. A place beyond the frame changes nothing.
    pub(crate) fn apply(self, frame: &[u8]) -> Vec<u8> {
        let mut repaired = frame.to_vec();
        match self {
            Self::Bit { byte, bit } => {
                if let Some(byte) = repaired.get_mut(byte) {
                    *byte ^= 1 << (bit & 7);
                }
            }
            Self::Insert { at, value } => repaired.insert(at.min(frame.len()), value),
            Self::Remove { at } => {
                if at < frame.len() {
                    repaired.remove(at);
                }
            }
            Self::SwapCheck => {
                if let [.., low, high] = repaired.as_mut_slice() {
                    core::mem::swap(low, high);
                }
            }
        }
        repaired
    }
}

/// Calls `found` with every repair of a frame whose CRC is wrong. Nothing for fewer than 3 and more than [`MAX_LEN`]
/// bytes.
///
/// An added byte that is equal to its neighbour, or a lost one, has several places that come to the same; only the first
/// is given.
pub(crate) fn repairs(frame: &[u8], mut found: impl FnMut(Repair)) {
    let Some((body, &[low, high])) = frame.split_last_chunk::<2>() else { return };
    if body.is_empty() || frame.len() > MAX_LEN {
        return;
    }
    let mut before = [INITIAL; MAX_LEN];
    for (at, byte) in body.iter().enumerate() {
        before[at + 1] = shift(before[at] ^ u16::from(*byte));
    }
    let (wrong, right) = (u16::from_le_bytes([low, high]), before[body.len()]);
    if wrong == right {
        return;
    }
    if wrong.swap_bytes() == right {
        found(Repair::SwapCheck);
    }
    if let Some(bit) = single_bit(wrong ^ right) {
        found(Repair::Bit { byte: body.len() + usize::from(bit / 8), bit: bit % 8 });
    }
    repair_check(frame, body, before[body.len() - 1], &mut found);
    // What the register must be before the byte at `at` for the check to come out right.
    let mut needed = wrong;
    for at in (0..=body.len()).rev() {
        // A byte put in here would lead from `before` to `needed`.
        let value = unshift(needed) ^ before[at];
        if let Ok(value) = u8::try_from(value)
            && (at == 0 || body.get(at - 1) != Some(&value))
        {
            found(Repair::Insert { at, value });
        }
        let Some(last) = at.checked_sub(1) else { break };
        if before[last] == needed && (last == 0 || body[last - 1] != body[last]) {
            found(Repair::Remove { at: last });
        }
        let byte = body[last];
        needed = unshift(needed);
        if let Some(bit @ 0..8) = single_bit(needed ^ before[last] ^ u16::from(byte)) {
            found(Repair::Bit { byte: last, bit });
        }
        needed ^= u16::from(byte);
    }
}

/// Repairs that touch the check itself. `shorter` is the register before the body's last byte.
fn repair_check(frame: &[u8], body: &[u8], shorter: u16, found: &mut impl FnMut(Repair)) {
    let [.., first, second, third] = *frame else { return };
    let len = frame.len();
    // One byte of the check is lost: `second` still belongs to the body.
    let [low, high] = shift(shift(shorter ^ u16::from(first)) ^ u16::from(second)).to_le_bytes();
    if third == high && second != low {
        found(Repair::Insert { at: len - 1, value: low });
    }
    if third == low && third != high {
        found(Repair::Insert { at: len, value: high });
    }
    // One byte too many within the check or behind it: `first` belongs to the check already.
    if body.len() < 2 {
        return;
    }
    let [low, high] = shorter.to_le_bytes();
    if first == low && third == high && second != first {
        found(Repair::Remove { at: len - 2 });
    }
    if first == low && second == high && third != second {
        found(Repair::Remove { at: len - 1 });
    }
}

/// The register before the first byte (serial line guide, clause 2.5.1.2).
const INITIAL: u16 = 0xFFFF;
/// The generator, least significant bit first.
const GENERATOR: u16 = 0xA001;

/// The register after the byte that was added to it has gone through.
fn shift(register: u16) -> u16 {
    (0..8).fold(register, |r, _| if r & 1 == 0 { r >> 1 } else { r >> 1 ^ GENERATOR })
}

/// The inverse of [`shift`].
fn unshift(register: u16) -> u16 {
    (0..8).fold(register, |r, _| if r & 0x8000 == 0 { r << 1 } else { (r ^ GENERATOR) << 1 | 1 })
}

/// The place of the only bit that is set.
fn single_bit(bits: u16) -> Option<u8> {
    (0..16).find(|bit| bits == 1 << bit)
}

/// Whether a frame of at least 3 bytes ends with its CRC.
pub(crate) fn is_right(frame: &[u8]) -> bool {
    frame.split_last_chunk::<2>().is_some_and(|(body, check)| !body.is_empty() && crc16(body).to_le_bytes() == *check)
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use proptest::prelude::*;

    use super::*;
    use crate::UnitId;

    fn all(frame: &[u8]) -> Vec<Repair> {
        let mut found = vec![];
        repairs(frame, |repair| found.push(repair));
        found
    }

    fn frames(most: usize) -> impl Strategy<Value = Vec<u8>> {
        (any::<u8>(), prop::collection::vec(any::<u8>(), 1..most))
            .prop_map(|(unit, pdu)| crate::rtu::encode(UnitId(unit), &pdu).unwrap())
    }

    #[test]
    fn every_single_bit_of_frames_of_every_length_is_found() {
        for len in 1..=253 {
            let pdu: Vec<u8> = (0..len).map(|at: u8| at.wrapping_mul(37).wrapping_add(len)).collect();
            let frame = crate::rtu::encode(UnitId(17), &pdu).unwrap();
            let step = if frame.len() <= 64 { 1 } else { 13 };
            let bits = (0..frame.len()).flat_map(|byte| (0..8).map(move |bit| (byte, bit)));
            for (byte, bit) in bits.step_by(step) {
                let damaged = Repair::Bit { byte, bit }.apply(&frame);
                let bits: Vec<Repair> =
                    all(&damaged).into_iter().filter(|repair| matches!(repair, Repair::Bit { .. })).collect();
                assert_eq!(bits, [Repair::Bit { byte, bit }], "length {}", frame.len());
            }
        }
    }

    proptest! {
        /// Whatever is found makes the check right.
        #[test]
        fn repairs_repair(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            for repair in all(&bytes) {
                prop_assert!(is_right(&repair.apply(&bytes)), "{:?}", repair);
            }
        }

        #[test]
        fn a_lost_byte_is_among_the_repairs(frame in frames(250), at in any::<prop::sample::Index>()) {
            let mut damaged = frame.clone();
            damaged.remove(at.index(frame.len()));
            prop_assume!(!is_right(&damaged));
            prop_assert!(all(&damaged).iter().any(|repair| repair.apply(&damaged) == frame));
        }

        #[test]
        fn an_added_byte_is_among_the_repairs(frame in frames(250), at in any::<prop::sample::Index>(), value: u8) {
            let mut damaged = frame.clone();
            damaged.insert(at.index(frame.len() + 1), value);
            prop_assume!(!is_right(&damaged));
            prop_assert!(all(&damaged).iter().any(|repair| repair.apply(&damaged) == frame));
        }

        #[test]
        fn a_swapped_check_is_found(frame in frames(250)) {
            let damaged = Repair::SwapCheck.apply(&frame);
            prop_assume!(damaged != frame);
            prop_assert!(all(&damaged).contains(&Repair::SwapCheck));
        }
    }
}
