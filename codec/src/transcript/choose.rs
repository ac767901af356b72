//! Which device speaks here.

use super::{EntryKind, Transcript};
use crate::dissect::Direction;
use crate::profile::{Known, Outline, Profile};

/// Frames that are asked; more would only cost time.
const MOST_FRAMES: usize = 10_000;

impl Transcript {
    /// The profile that explains the frames best, judged by the first 10 000; the first one of equals. Damaged frames
    /// count where no others do. `None` if no profile explains any.
    pub fn most_explaining<'a>(&self, profiles: &'a [Profile]) -> Option<&'a Profile> {
        self.most_explaining_from(self.first(), profiles)
    }

    /// The same, judged by the frames from this entry on.
    pub fn most_explaining_from<'a>(&self, first: usize, profiles: &'a [Profile]) -> Option<&'a Profile> {
        self.best(first, profiles, true).or_else(|| self.best(first, profiles, false))
    }

    fn best<'a>(&self, first: usize, profiles: &'a [Profile], check_ok: bool) -> Option<&'a Profile> {
        let mut best: Option<(&Profile, u32)> = None;
        for profile in profiles {
            let score = self.score(first, profile, check_ok);
            if score > best.map_or(0, |(_, most)| most) {
                best = Some((profile, score));
            }
        }
        best.map(|(profile, _)| profile)
    }

    fn score(&self, first: usize, profile: &Profile, check_ok: bool) -> u32 {
        let wanted = (first..self.end()).filter_map(|index| Some((index, self.entry(index)?)));
        let wanted =
            wanted.filter(|(_, entry)| entry.kind == EntryKind::Frame && entry.check_ok == check_ok && !entry.echo);
        let mut sum = 0u32;
        for (index, _) in wanted.take(MOST_FRAMES) {
            let Some(found) = self.reading(index, None, &mut Known::default()).dissection else { continue };
            if found.exception.is_some() {
                continue;
            }
            // A coil's value stands as function 05 sends it.
            let coil = found.bits.first().map(|on| [if *on { 0xFF00 } else { 0 }]);
            let registers = match &coil {
                Some(value) if found.function == 0x05 => value.as_slice(),
                _ => found.registers.as_slice(),
            };
            let count = u16::try_from(registers.len()).unwrap_or(u16::MAX);
            let outline = Outline {
                function: found.function,
                address: found.address,
                quantity: found.quantity.unwrap_or(count),
                registers,
                is_response: found.direction == Direction::Response,
                is_broadcast: found.unit.0 == 0,
            };
            sum = sum.saturating_add(profile.score(&outline));
        }
        sum
    }
}
