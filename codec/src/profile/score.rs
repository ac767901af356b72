//! Which device does a frame come from? Each profile says how well it explains a frame; the sum over all frames decides.

use alloc::vec::Vec;

use super::{Group, Known, Point, Profile};

/// What a frame tells apart from its unit id and its check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outline<'a> {
    /// The function code, without an exception's top bit.
    pub function: u8,
    /// The first register or the coil; `None` where it is not known, as in a read reply without its request.
    pub address: Option<u16>,
    /// How many registers are meant, at least those that are here.
    pub quantity: u16,
    /// The registers that were read or are written; empty in a read request, a write-many reply and an exception.
    pub registers: &'a [u16],
    /// Whether it is a reply, which only a device sends.
    pub is_response: bool,
    /// Whether it goes to or comes from the broadcast address.
    pub is_broadcast: bool,
}

/// The profile that explains these frames best, the first one of equals; `None` if none explains any of them.
pub fn most_explaining<'a>(
    profiles: impl IntoIterator<Item = &'a Profile>,
    frames: &[Outline<'_>],
) -> Option<&'a Profile> {
    let mut best: Option<(&Profile, u32)> = None;
    for profile in profiles {
        let score = frames.iter().fold(0u32, |sum, frame| sum.saturating_add(profile.score(frame)));
        if score > best.map_or(0, |(_, most)| most) {
            best = Some((profile, score));
        }
    }
    best.map(|(profile, _)| profile)
}

/// Exactly what the manual shows: one point, a known group, a known search; its values are plausible.
const EXACT: u32 = 20;
/// Several points side by side.
const WHOLE: u32 = 10;
/// Registers of the device, but not as it wants to be asked.
const PARTLY: u32 = 2;
/// Nothing but the function and the quantity is known.
const VAGUE: u32 = 1;

impl Profile {
    /// How well this profile explains a frame: 0 for not at all, 20 for exactly.
    pub fn score(&self, frame: &Outline<'_>) -> u32 {
        let quantity = usize::from(frame.quantity).max(frame.registers.len());
        let Some(address) = frame.address else { return self.score_without_address(frame) };
        let group = Group { function: frame.function, address, quantity: frame.quantity, tentative: false };
        if frame.is_broadcast && matches!(frame.function, 0x01..=0x04) {
            // The standard has no broadcast reads; a device that answers them says so.
            return if self.discovery.contains(&group) { EXACT } else { 0 };
        }
        let touched: Vec<&Point> =
            self.points.iter().filter(|point| touches(point, frame.function, address, quantity)).collect();
        if touched.is_empty() || self.contradicts(frame, address) {
            return 0;
        }
        let is_whole = |point: &&&Point| point.offset_in(address, quantity).is_some();
        let registers: usize = touched.iter().filter(is_whole).map(|point| point.encoding.registers()).sum();
        match touched.as_slice() {
            _ if registers != quantity => PARTLY,
            [_] => EXACT,
            _ if self.groups.iter().any(|known| Group { tentative: false, ..*known } == group) => EXACT,
            _ => WHOLE,
        }
    }

    /// Whether a value is one that this device does not send, or does not take.
    fn contradicts(&self, frame: &Outline<'_>, address: u16) -> bool {
        let points = self.decode_points(frame.function, address, frame.registers, &mut Known::default());
        points.iter().any(|found| found.value.map_or(true, |value| found.scaled && !found.point.allows(value)))
    }

    /// A reply to an unknown read: any read of this profile that could be meant.
    fn score_without_address(&self, frame: &Outline<'_>) -> u32 {
        let own = self.points.iter().filter_map(Point::read_group);
        let mut reads = self.groups.iter().copied().chain(own);
        let fits = |read: Group| {
            read.function == frame.function
                && usize::from(read.quantity) == frame.registers.len()
                && !self.contradicts(frame, read.address)
        };
        if frame.is_response && reads.any(fits) { VAGUE } else { 0 }
    }
}

fn touches(point: &Point, function: u8, address: u16, quantity: usize) -> bool {
    let (first, start) = (usize::from(point.register), usize::from(address));
    point.uses(function) && first < start + quantity && start < first + point.encoding.registers()
}

#[cfg(test)]
mod tests {
    use super::super::tests::built_in;
    use super::*;

    const READ: Outline<'_> =
        Outline { function: 3, address: Some(0), quantity: 1, registers: &[], is_response: false, is_broadcast: false };

    fn scores(frame: &Outline<'_>) -> [u32; 3] {
        ["lvdt", "gauge-cable", "level"].map(|id| built_in(id).score(frame))
    }

    #[test]
    fn the_same_register_is_another_datum_of_each_device() {
        assert_eq!(scores(&READ), [0, PARTLY, EXACT]);
        assert_eq!(scores(&Outline { quantity: 2, ..READ }), [0, EXACT, WHOLE]);
        assert_eq!(scores(&Outline { is_broadcast: true, ..READ }), [EXACT, 0, 0]);
        assert_eq!(scores(&Outline { function: 6, registers: &[2], ..READ }), [0, 0, EXACT]);
    }

    #[test]
    fn a_reply_that_a_device_cannot_send_speaks_against_it() {
        let reply = Outline { quantity: 2, registers: &[0x0100, 0x1235], is_response: true, ..READ };
        assert_eq!(scores(&reply), [0, EXACT, 0]);
        let unknown = Outline { address: None, ..reply };
        assert_eq!(scores(&unknown), [0, VAGUE, 0]);
        let both = Outline { function: 4, address: None, registers: &[0, 285, 123, 456], ..reply };
        assert_eq!(scores(&both), [VAGUE, 0, 0]);
        let broken = Outline { registers: &[0, 285, 123, 1000], ..both };
        assert_eq!(scores(&broken), [0, 0, 0]);
    }

    #[test]
    fn half_a_value_is_told_from_a_whole_one() {
        let half = Outline { function: 4, address: Some(4), ..READ };
        assert_eq!(scores(&half), [PARTLY, 0, 0]);
        assert_eq!(scores(&Outline { quantity: 4, address: Some(2), ..half }), [EXACT, 0, 0]);
        assert_eq!(scores(&Outline { address: Some(0xFFFF), quantity: u16::MAX, ..READ }), [0, 0, 0]);
    }

    #[test]
    fn frames_that_nothing_explains_choose_nothing() {
        let profiles = ["lvdt", "level"].map(built_in);
        assert_eq!(most_explaining(&profiles, &[]), None);
        assert_eq!(most_explaining(&profiles, &[Outline { function: 0x2B, ..READ }]), None);
        assert_eq!(most_explaining(&profiles, &[READ]).unwrap().id, "level");
    }
}
