//! What every device of a series is given.

use buslens_codec::profile::{Code, Danger, Effect, Point, Profile, Role};
use buslens_codec::value::Value;
use buslens_configure::{Edit, Hazard, Plan, Reach, Refusal, Snapshot, Unfit};
use serde::{Deserialize, Serialize};

use super::addresses::Addresses;

/// What every device of a series is given.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Setup {
    /// Id of the devices' profile.
    pub(crate) profile: String,
    /// Their unit ids.
    pub(crate) addresses: Addresses,
    /// Points, each with the text that was typed for it.
    pub(crate) settings: Vec<(String, String)>,
    /// A command at the end of each.
    pub(crate) finish: Option<Edit>,
    /// Whether a device that is not as it left the factory is searched with all settings.
    pub(crate) everywhere: bool,
    /// What was confirmed of its dangers.
    pub(crate) accepted: Vec<Hazard>,
}

/// What a setup comes to before there is a device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Check {
    /// What no device would take.
    pub(crate) refused: Vec<Refusal>,
    /// What must be confirmed.
    pub(crate) hazards: Vec<Hazard>,
}

/// The point that holds the unit id, where it can be written.
pub(crate) fn unit_point(profile: &Profile) -> Option<&Point> {
    profile.points.iter().find(|point| point.effects.contains(&Effect::Unit) && !point.write.is_empty())
}

/// What can be given to every device: parameters that can be written, but the unit id.
pub(crate) fn settings(profile: &Profile) -> impl Iterator<Item = &Point> {
    profile.points.iter().filter(|point| {
        let writable = point.role == Role::Parameter && !point.write.is_empty();
        writable && !loses(point) && !point.effects.contains(&Effect::Unit)
    })
}

/// Commands that can stand at the end: they lose nothing, and leave the device where it is.
pub(crate) fn finishes(profile: &Profile) -> impl Iterator<Item = (&Point, &Code)> {
    let commands = profile.points.iter().filter(|point| point.role == Role::Command && point.effects.is_empty());
    commands.flat_map(|point| {
        let grave = |code: &&Code| point.danger_of(Value::Code(code.code)) != Danger::Danger;
        point.codes.iter().filter(grave).map(move |code| (point, code))
    })
}

/// The edit of a command.
pub(crate) fn command(point: &Point, code: u16) -> Option<Edit> {
    let registers = point.encoding.encode(Value::Code(code)).ok()?;
    Some(Edit { point: point.id.clone(), registers })
}

fn loses(point: &Point) -> bool {
    point.effects.iter().any(|effect| matches!(effect, Effect::Defaults | Effect::Search))
}

impl Setup {
    /// What can be said of it before a device is there. What depends on a device's own scale is checked when it was read.
    pub(crate) fn check(&self, profile: &Profile) -> Check {
        let have = Snapshot::empty(profile, Reach::of_factory(profile));
        let mut check = Check::default();
        let texts = self.settings.iter().filter_map(|(id, text)| Some((profile.point(id)?, text.clone())));
        // Above 247 the danger is the same for every unit id: the first one stands for all.
        let reserved = self.addresses.all().find(|unit| *unit > 247).or_else(|| self.addresses.next(&[]));
        let unit = unit_point(profile).zip(reserved).map(|(point, unit)| (point, unit.to_string()));
        for (point, text) in unit.into_iter().chain(texts) {
            match Edit::parse(profile, point, &text, &have) {
                Ok(edit) => check.look_at(profile, &have, edit),
                Err(refusal) => check.refuse(refusal),
            }
        }
        if let Some(finish) = &self.finish {
            check.look_at(profile, &have, finish.clone());
        }
        check
    }

    /// What is to be written into a device that holds what `have` tells.
    pub(crate) fn edits(&self, profile: &Profile, have: &Snapshot, unit: u8) -> Result<Vec<Edit>, Vec<Refusal>> {
        let (mut edits, mut refused) = (Vec::new(), Vec::new());
        let of_unit = unit_point(profile).map(|point| (point, unit.to_string()));
        let texts = self.settings.iter().filter_map(|(id, text)| Some((profile.point(id)?, text.clone())));
        for (point, text) in texts.chain(of_unit) {
            match Edit::parse(profile, point, &text, have) {
                Ok(edit) => edits.push(edit),
                Err(refusal) => refused.push(refusal),
            }
        }
        if refused.is_empty() { Ok(edits) } else { Err(refused) }
    }

    /// What of these dangers was not confirmed.
    pub(crate) fn unconfirmed(&self, hazards: &[Hazard]) -> Vec<Hazard> {
        let is_reserved = |hazard: &Hazard| matches!(hazard, Hazard::ReservedUnit { .. });
        let accepted = |hazard: &Hazard| {
            self.accepted.contains(hazard) || is_reserved(hazard) && self.accepted.iter().any(is_reserved)
        };
        hazards.iter().filter(|hazard| !accepted(hazard)).cloned().collect()
    }
}

impl Check {
    fn look_at(&mut self, profile: &Profile, have: &Snapshot, edit: Edit) {
        match Plan::of(profile, have, &[edit]) {
            Ok(plan) => self.hazards.extend(plan.hazards),
            Err(refused) => refused.into_iter().for_each(|refusal| self.refuse(refusal)),
        }
    }

    /// What must be read first will be.
    fn refuse(&mut self, refusal: Refusal) {
        if !matches!(refusal.why, Unfit::NotScaled | Unfit::NotRead) {
            self.refused.push(refusal);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device;

    fn setup(device: &str, first: &str, settings: &[(&str, &str)]) -> Setup {
        let profile = device::find(device).profile();
        Setup {
            profile: profile.id.clone(),
            addresses: Addresses::parse(profile, first, "1", "").unwrap(),
            settings: settings.iter().map(|(point, text)| ((*point).to_owned(), (*text).to_owned())).collect(),
            finish: None,
            everywhere: true,
            accepted: Vec::new(),
        }
    }

    #[test]
    fn a_profile_tells_what_a_series_can_set() {
        let ids = |device: &str| -> Vec<&str> {
            settings(device::find(device).profile()).map(|point| point.id.as_str()).collect()
        };
        assert_eq!(ids("lvdt"), ["baud", "parity", "compensation", "sample_rate", "output_mode"]);
        assert_eq!(ids("level"), ["baud", "zero_offset"]);
        assert!(unit_point(device::find("gauge-cable").profile()).is_none());
        let ends: Vec<(&str, u16)> =
            finishes(device::find("level").profile()).map(|(point, code)| (point.id.as_str(), code.code)).collect();
        assert_eq!(ends, [("save", 0)]);
    }

    #[test]
    fn dangers_and_faults_are_known_before_the_first_device() {
        let profile = device::find("lvdt").profile();
        let check = setup("lvdt", "10", &[("baud", "2400"), ("parity", "mark")]).check(profile);
        assert_eq!(check.hazards, [Hazard::SlowBaud { baud: 2400 }]);
        assert_eq!(check.refused.len(), 1);
        // The scale of an offset is the device's own: it is checked when that was read.
        let level = device::find("level").profile();
        let check = setup("level", "247", &[("zero_offset", "0.5")]).check(level);
        assert_eq!((check.hazards, check.refused), (vec![Hazard::ReservedUnit { unit: 248 }], Vec::new()));
    }

    #[test]
    fn one_confirmation_stands_for_all_reserved_unit_ids() {
        let mut setup = setup("level", "248", &[]);
        let hazards = [Hazard::ReservedUnit { unit: 250 }, Hazard::SlowBaud { baud: 1200 }];
        assert_eq!(setup.unconfirmed(&hazards), hazards);
        setup.accepted.push(Hazard::ReservedUnit { unit: 248 });
        assert_eq!(setup.unconfirmed(&hazards), [Hazard::SlowBaud { baud: 1200 }]);
    }
}
