//! The unit ids that a series of devices gets, one after the other.

use buslens_codec::profile::Profile;
use serde::{Deserialize, Serialize};

/// Unit ids from a first one on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Addresses {
    /// The first.
    pub(crate) first: u8,
    /// From one to the next.
    pub(crate) step: u8,
    /// The last that the device takes.
    pub(crate) last: u8,
    /// Those that are left out.
    pub(crate) skip: Vec<u8>,
}

/// Which of the fields is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wrong {
    /// The first is no unit id of the device.
    First,
    /// The step is no number from 1 on.
    Step,
    /// What is left out are no unit ids.
    Skip,
    /// Everything is left out.
    Empty,
}

impl Addresses {
    /// Of what was typed, for a kind of device. Unit id 0 is everybody's.
    pub(crate) fn parse(profile: &Profile, first: &str, step: &str, skip: &str) -> Result<Self, Wrong> {
        let limit = |number: u16| u8::try_from(number).unwrap_or(u8::MAX);
        let (lowest, last) = (limit(profile.units.first.max(1)), limit(profile.units.last));
        let first = plain(first).parse().ok().filter(|first| (lowest..=last).contains(first)).ok_or(Wrong::First)?;
        let step = plain(step).parse().ok().filter(|step| *step > 0).ok_or(Wrong::Step)?;
        let skip = unit_ids(skip).ok_or(Wrong::Skip)?;
        let all = Self { first, step, last, skip };
        if all.next(&[]).is_none() { Err(Wrong::Empty) } else { Ok(all) }
    }

    /// The first that is neither left out nor used.
    pub(crate) fn next(&self, used: &[u8]) -> Option<u8> {
        self.all().find(|unit| !used.contains(unit))
    }

    /// All of them, the first one first.
    pub(crate) fn all(&self) -> impl Iterator<Item = u8> + '_ {
        let steps = (self.first..=self.last).step_by(usize::from(self.step.max(1)));
        steps.filter(|unit| !self.skip.contains(unit))
    }
}

/// Unit ids as `1-10, 12`; `None` for anything else.
pub(crate) fn unit_ids(text: &str) -> Option<Vec<u8>> {
    let mut all = Vec::new();
    let text = plain(text);
    for part in text.split([',', ' ', '\u{3001}', ';']).map(str::trim).filter(|part| !part.is_empty()) {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last): (u8, u8) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
        if first == 0 || first > last {
            return None;
        }
        all.extend(first..=last);
    }
    Some(all)
}

/// Without spaces around, and with the digits of a Chinese keyboard as ASCII.
fn plain(typed: &str) -> String {
    let ascii = |c: char| match c {
        '\u{FF01}'..='\u{FF5E}' => char::from_u32(u32::from(c) - 0xFEE0).unwrap_or(c),
        other => other,
    };
    typed.trim().chars().map(ascii).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device;

    fn parse(first: &str, step: &str, skip: &str) -> Result<Addresses, Wrong> {
        Addresses::parse(device::find("lvdt").profile(), first, step, skip)
    }

    #[test]
    fn used_and_left_out_ones_are_passed_over() {
        let all = parse("10", "2", "14, 16-19").unwrap();
        assert_eq!(all.all().take(4).collect::<Vec<_>>(), [10, 12, 20, 22]);
        assert_eq!(all.next(&[10, 12, 20]), Some(22));
        let last = parse("246", "1", "").unwrap();
        assert_eq!((last.next(&[246]), last.next(&[246, 247])), (Some(247), None));
    }

    #[test]
    fn unit_ids_are_typed_one_by_one_or_in_ranges() {
        assert_eq!(unit_ids("1-3, 12"), Some(vec![1, 2, 3, 12]));
        assert_eq!(unit_ids(" 247 "), Some(vec![247]));
        assert_eq!(unit_ids(""), Some(Vec::new()));
        for wrong in ["0", "5-1", "256", "a", "1-"] {
            assert_eq!(unit_ids(wrong), None, "{wrong}");
        }
        // As a Chinese keyboard writes them.
        assert_eq!(unit_ids("１－３，１２"), Some(vec![1, 2, 3, 12]));
        assert_eq!(unit_ids("1，2、3"), Some(vec![1, 2, 3]));
        assert_eq!(parse(" １０ ", "1", "").map(|all| all.first), Ok(10));
    }

    #[test]
    fn what_is_wrong_is_told_by_its_field() {
        for (first, step, skip, wrong) in [
            ("0", "1", "", Wrong::First),
            ("248", "1", "", Wrong::First),
            ("", "1", "", Wrong::First),
            ("1", "0", "", Wrong::Step),
            ("1", "256", "", Wrong::Step),
            ("1", "1", "3-1", Wrong::Skip),
            ("1", "1", "0", Wrong::Skip),
            ("1", "1", "1-247", Wrong::Empty),
        ] {
            assert_eq!(parse(first, step, skip), Err(wrong), "{first} {step} {skip}");
        }
        let level = Addresses::parse(device::find("level").profile(), "255", "255", "").unwrap();
        assert_eq!(level.all().collect::<Vec<_>>(), [255]);
    }
}
