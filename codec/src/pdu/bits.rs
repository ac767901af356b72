use alloc::vec::Vec;

/// Bits as coils and inputs travel: eight a byte, the first in the lowest bit, the last byte filled up with zeros
/// (clause 6.1).
pub fn pack_bits(bits: &[bool]) -> Vec<u8> {
    let pack = |eight: &[bool]| eight.iter().rev().fold(0u8, |byte, bit| byte << 1 | u8::from(*bit));
    bits.chunks(8).map(pack).collect()
}

/// The first `quantity` bits of `bytes`, fewer where there are fewer. Undoes [`pack_bits`].
pub fn unpack_bits(bytes: &[u8], quantity: usize) -> Vec<bool> {
    bytes.iter().flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1 != 0)).take(quantity).collect()
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use proptest::prelude::*;

    use super::*;

    /// Clause 6.11: ten coils from 20 on, of which the first byte is CD and the second 01.
    #[test]
    fn the_standards_own_example() {
        let coils = [true, false, true, true, false, false, true, true, true, false];
        assert_eq!(pack_bits(&coils), vec![0xCD, 0x01]);
        assert_eq!(unpack_bits(&[0xCD, 0x01], 10), coils);
        assert_eq!(unpack_bits(&[0xCD], 10).len(), 8);
    }

    proptest! {
        #[test]
        fn unpacking_undoes_packing(bits in prop::collection::vec(any::<bool>(), 0..100)) {
            let bytes = pack_bits(&bits);
            prop_assert_eq!(bytes.len(), bits.len().div_ceil(8));
            prop_assert_eq!(unpack_bits(&bytes, bits.len()), bits);
        }
    }
}
