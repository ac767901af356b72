//! Scales and units that other registers tell: who said what, and from where on it holds.

use std::collections::{BTreeMap, VecDeque};

use buslens_codec::profile::Profile;

/// A register that tells a scale or a unit: unit id, function, address.
type Teller = (u8, u8, u16);

/// Everything that was told: for each register the entries that brought it and its value then, in order; only changes are
/// kept.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scales {
    told: BTreeMap<Teller, VecDeque<(u32, u16)>>,
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
            let told = self.told.entry((unit, function, place)).or_default();
            if told.back().is_none_or(|(_, known)| *known != value) {
                told.push_back((entry, value));
            }
        }
    }

    /// What was known of a unit just before `entry`: function, address, value, the latest of each, the last one told first.
    pub(crate) fn known_before(&self, entry: u32, unit: u8) -> Vec<(u8, u16, u16)> {
        let of_unit = self.told.range((unit, 0, 0)..=(unit, u8::MAX, u16::MAX));
        let mut found: Vec<(u32, (u8, u16, u16))> = of_unit
            .filter_map(|((_, function, address), told)| {
                let last = told.partition_point(|(at, _)| *at < entry).checked_sub(1)?;
                let (at, value) = *told.get(last)?;
                Some((at, (*function, *address, value)))
            })
            .collect();
        found.sort_by_key(|(at, _)| core::cmp::Reverse(*at));
        found.into_iter().map(|(_, told)| told).collect()
    }

    /// Unit ids that something was told of.
    pub(crate) fn units(&self) -> Vec<u8> {
        let mut units: Vec<u8> = self.told.keys().map(|(unit, ..)| *unit).collect();
        units.dedup();
        units
    }

    /// Forgets what only entries before `first` could ask for: all but the last word of each register.
    pub(crate) fn forget_before(&mut self, first: u32) {
        for told in self.told.values_mut() {
            let gone = told.partition_point(|(at, _)| *at < first).saturating_sub(1);
            told.drain(..gone);
        }
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
        assert_eq!(scales.told.values().map(VecDeque::len).sum::<usize>(), 5);
        assert_eq!(scales.known_before(1, 1), []);
        assert_eq!(scales.known_before(5, 1), [(3, 3, 2)]);
        let mut known = scales.known_before(100, 1);
        known.sort_unstable();
        assert_eq!(known, [(3, 2, 4), (3, 3, 3)]);
        assert_eq!(scales.known_before(100, 7), [(3, 2, 0), (3, 3, 1)]);
        scales.forget_before(6);
        assert_eq!(scales.known_before(5, 1), []);
        assert_eq!(scales.known_before(6, 1).len(), 2);
        assert_eq!(scales.units(), [1, 7]);
    }
}
