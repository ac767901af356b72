//! The two checks of the serial line: CRC-16 in RTU mode, LRC in ASCII mode.
//!
//! The CRC of a whole frame, check included, is zero exactly where the check is right: the one test that the search for
//! frames needs ([`is_right`]). On a processor 16 bytes are taken at once through 16 tables (8 KB), then eight; in the page,
//! where every byte is downloaded, one table (512 bytes) does.

/// The polynomial x^16 + x^15 + x^2 + 1, lowest bit first (serial line guide, clause 6.2.2).
const POLYNOMIAL: u16 = 0xA001;
/// The CRC of no bytes.
const START: u16 = 0xFFFF;

/// Tables, and bytes that the longest step takes.
const STRIDE: usize = if cfg!(target_arch = "wasm32") { 1 } else { 16 };

/// Bytes that the next shorter step takes.
const HALF: usize = STRIDE.div_ceil(2);

/// `TABLES[n][byte]`: what `byte` leaves in the CRC after itself and `n` zeros.
static TABLES: [[u16; 256]; STRIDE] = tables();

/// CRC-16 over unit id and PDU; sent low byte first (serial line guide, clause 2.5.1.2).
#[inline]
pub fn crc16(bytes: &[u8]) -> u16 {
    extend(START, bytes)
}

/// Whether the last two bytes of `frame` are the CRC-16 of those before them. Not of fewer than two.
#[inline]
pub fn is_right(frame: &[u8]) -> bool {
    frame.len() >= 2 && crc16(frame) == 0
}

/// The same for the first `short` bytes of `frame`, which are two at least, and for all.
#[inline]
pub(crate) fn are_right(frame: &[u8], short: usize) -> [bool; 2] {
    let (first, rest) = frame.split_at_checked(short).unwrap_or((frame, &[]));
    let crc = crc16(first);
    [crc == 0, extend(crc, rest) == 0]
}

/// LRC over the decoded unit id and PDU: the two's complement of their sum (serial line guide, clause 2.5.2.2).
pub fn lrc(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte)).wrapping_neg()
}

/// The CRC `crc` after one more byte.
#[inline]
pub(crate) fn step(crc: u16, byte: u8) -> u16 {
    let [low, high] = (crc ^ u16::from(byte)).to_le_bytes();
    TABLES[0][usize::from(low)] ^ u16::from(high)
}

/// The CRC `crc` after more bytes.
#[inline]
fn extend(crc: u16, bytes: &[u8]) -> u16 {
    let (blocks, rest) = bytes.as_chunks::<STRIDE>();
    let crc = blocks.iter().fold(crc, |crc, block| stride(crc, *block));
    let (blocks, rest) = rest.as_chunks::<HALF>();
    let crc = blocks.iter().fold(crc, |crc, block| stride(crc, *block));
    rest.iter().fold(crc, |crc, byte| step(crc, *byte))
}

/// Takes `N` bytes at once, as many as there are tables at most. The CRC is linear: each byte adds what its table holds, and
/// the CRC so far counts as added to the first two bytes. These come last, so that the next step waits for them alone.
#[inline]
fn stride<const N: usize>(crc: u16, mut block: [u8; N]) -> u16 {
    if N == 1 {
        return step(crc, block[0]);
    }
    for (byte, part) in block.iter_mut().zip(crc.to_le_bytes()) {
        *byte ^= part;
    }
    TABLES.iter().zip(block.into_iter().rev()).fold(0, |sum, (table, byte)| sum ^ table[usize::from(byte)])
}

const fn tables() -> [[u16; 256]; STRIDE] {
    let mut tables = [[0; 256]; STRIDE];
    let mut byte = 0;
    while byte < 256 {
        #[expect(clippy::cast_possible_truncation, reason = "less than 256")]
        let mut crc = byte as u16;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ POLYNOMIAL } else { crc >> 1 };
            bit += 1;
        }
        tables[0][byte] = crc;
        byte += 1;
    }
    let mut zeros = 1;
    while zeros < STRIDE {
        let mut byte = 0;
        while byte < 256 {
            let before = tables[zeros - 1][byte];
            tables[zeros][byte] = before >> 8 ^ tables[0][(before & 0xFF) as usize];
            byte += 1;
        }
        zeros += 1;
    }
    tables
}

/// `crc` after some zeros, in the same time for any number of them: they multiply the CRC by a power of x, which stands at
/// their number in [`powers`].
fn after_zeros(crc: u16, power: u16) -> u16 {
    let (mut sum, mut shifted) = (0, crc);
    for bit in (0..16).rev() {
        sum ^= shifted * (power >> bit & 1);
        shifted = (shifted >> 1) ^ (POLYNOMIAL * (shifted & 1));
    }
    sum
}

/// The factors for 0, 1, 2... zeros.
pub(crate) fn powers() -> impl Iterator<Item = u16> {
    // The highest bit stands for x to the 0.
    core::iter::successors(Some(0x8000), |power| Some(step(*power, 0)))
}

/// The CRC of bytes that begin where a longer run of bytes had `before`, and end where it had `after`, the run having
/// begun with a CRC of zero. `power` is that of their number.
#[inline]
pub(crate) fn between(before: u16, after: u16, power: u16) -> u16 {
    after ^ after_zeros(before ^ START, power)
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use crc::{CRC_16_MODBUS, Crc};
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_catalogue_agrees() {
        assert_eq!(crc16(b"123456789"), 0x4B37);
        assert_eq!(crc16(&[]), 0xFFFF);
        assert!(!is_right(&[]) && !is_right(&[0xFF]));
    }

    proptest! {
        #[test]
        fn any_length_agrees_with_another_implementation(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            prop_assert_eq!(crc16(&bytes), Crc::<u16>::new(&CRC_16_MODBUS).checksum(&bytes));
        }

        #[test]
        fn two_lengths_at_once_agree_with_each(
            mut bytes in prop::collection::vec(any::<u8>(), 4..300),
            short in any::<prop::sample::Index>(),
            right: [bool; 2],
        ) {
            let short = 2 + short.index(bytes.len() - 2);
            for (len, right) in [short, bytes.len()].into_iter().zip(right) {
                let crc = crc16(&bytes[..len - 2]).to_le_bytes();
                if right { bytes[len - 2..len].copy_from_slice(&crc); }
            }
            prop_assert_eq!(are_right(&bytes, short), [is_right(&bytes[..short]), is_right(&bytes)]);
        }

        #[test]
        fn a_run_of_bytes_tells_the_check_of_each_part(
            bytes in prop::collection::vec(any::<u8>(), 0..300),
            ends in any::<[prop::sample::Index; 2]>(),
        ) {
            let mut ends = ends.map(|end| end.index(bytes.len() + 1));
            ends.sort_unstable();
            let run: Vec<u16> = core::iter::once(0)
                .chain(bytes.iter().scan(0, |crc, byte| { *crc = step(*crc, *byte); Some(*crc) }))
                .collect();
            let power = powers().nth(ends[1] - ends[0]).unwrap();
            prop_assert_eq!(between(run[ends[0]], run[ends[1]], power), crc16(&bytes[ends[0]..ends[1]]));
        }
    }
}
