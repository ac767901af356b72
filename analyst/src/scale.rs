//! Scales and units that other registers tell: who said what, and from where on it holds.

use buslens_codec::profile::Profile;

/// A register that tells a scale or a unit, as it was seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Told {
    /// The entry that brought it.
    entry: u32,
    unit: u8,
    function: u8,
    address: u16,
    value: u16,
}

/// Everything that was told, in the order of the entries; only changes are kept.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scales {
    told: Vec<Told>,
}

impl Scales {
    /// The single registers of a profile that tell something about other points.
    pub(crate) fn tellers(profile: &Profile) -> Vec<(u8, u16)> {
        let ids = profile.points.iter().flat_map(buslens_codec::profile::Point::refers_to);
        let points = ids.filter_map(|id| profile.point(id));
        let mut tellers: Vec<(u8, u16)> = points
            .filter(|point| point.encoding.registers() == 1)
            .filter_map(|point| Some((*point.read.first()?, point.register)))
            .collect();
        tellers.sort_unstable();
        tellers.dedup();
        tellers
    }

    /// Takes registers in that `entry` has read.
    pub(crate) fn hear(
        &mut self,
        tellers: &[(u8, u16)],
        entry: u32,
        unit: u8,
        function: u8,
        address: u16,
        registers: &[u16],
    ) {
        for &(teller, place) in tellers {
            let Some(at) = place.checked_sub(address).filter(|_| teller == function) else { continue };
            let Some(&value) = registers.get(usize::from(at)) else { continue };
            let known = self
                .told
                .iter()
                .rev()
                .find(|told| told.unit == unit && (told.function, told.address) == (function, place));
            if known.is_none_or(|known| known.value != value) {
                self.told.push(Told { entry, unit, function, address: place, value });
            }
        }
    }

    /// What was known of a unit just before `entry`: function, address, value, the latest of each.
    pub(crate) fn known_before(&self, entry: u32, unit: u8) -> Vec<(u8, u16, u16)> {
        let until = self.told.partition_point(|told| told.entry < entry);
        let mut found: Vec<(u8, u16, u16)> = Vec::new();
        for told in self.told.iter().take(until).rev().filter(|told| told.unit == unit) {
            if !found.iter().any(|(function, address, _)| (*function, *address) == (told.function, told.address)) {
                found.push((told.function, told.address, told.value));
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_word_before_an_entry_counts_for_its_unit() {
        let tellers = [(3, 2), (3, 3)];
        let mut scales = Scales::default();
        scales.hear(&tellers, 1, 1, 3, 3, &[2]);
        scales.hear(&tellers, 2, 1, 3, 3, &[2]);
        scales.hear(&tellers, 3, 7, 3, 2, &[0, 1]);
        scales.hear(&tellers, 5, 1, 3, 0, &[1, 3, 4, 3]);
        scales.hear(&tellers, 6, 1, 4, 3, &[9]);
        assert_eq!(scales.told.len(), 5);
        assert_eq!(scales.known_before(1, 1), []);
        assert_eq!(scales.known_before(5, 1), [(3, 3, 2)]);
        assert_eq!(scales.known_before(100, 1), [(3, 3, 3), (3, 2, 4)]);
        assert_eq!(scales.known_before(100, 7), [(3, 3, 1), (3, 2, 0)]);
    }
}
