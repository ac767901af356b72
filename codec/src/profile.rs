//! Device profiles: everything that is particular to a device, as data. The built-in ones are read by the same loader as a
//! user's own file.
//!
//! A profile is a JSON file; `docs/profiles.md` of the project tells its keys. [`Profile::from_json`] checks what can be
//! checked without the device, down to the worked examples.

mod grid;
mod known;
mod link;
mod load;
mod parts;
mod point;
mod scale;
mod score;

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::line::{LineSettings, Mode};
use crate::unit::UnitId;
use crate::value::Value;

pub use grid::Grid;
pub use known::{Known, PointValue};
pub use link::{Link, Setting};
pub use parts::{Choices, Erratum, Example, Group, Help, Interface, Range, Texts, Timing, Wire};
pub use point::{Beyond, Code, Danger, Effect, Limits, LimitsFrom, Point, Reply, Role};
pub use scale::Scale;
pub use score::{Outline, most_explaining};

/// The files of the built-in profiles.
pub const BUILT_IN: &[&str] = &[
    include_str!("../profiles/lvdt.json"),
    include_str!("../profiles/gauge-cable.json"),
    include_str!("../profiles/level.json"),
];

/// The version of the format that this loader reads.
pub const FORMAT: u32 = 1;

/// A device, as data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// [`FORMAT`].
    pub format: u32,
    /// Name for programs: lower-case letters, digits, `-`, `_`.
    pub id: String,
    /// Name for people.
    pub name: Texts,
    /// Where the facts come from.
    pub source: String,
    /// What users must know of the device as a whole.
    pub notes: Vec<Texts>,
    /// Electrical levels.
    pub interface: Interface,
    /// Factory settings of the line.
    pub line: LineSettings,
    /// Factory mode.
    pub mode: Mode,
    /// What the line can be set to.
    pub choices: Choices,
    /// Factory unit id, or a usual one where each device has its own.
    pub unit: u8,
    /// Unit ids that the device takes.
    pub units: Range,
    /// How fast and how often.
    pub timing: Timing,
    /// Supply, as printed in its manual.
    pub supply: String,
    /// Its wires.
    pub wiring: Vec<Wire>,
    /// Everything that can be read or written, in the order of its registers.
    pub points: Vec<Point>,
    /// Registers that can be read together.
    pub groups: Vec<Group>,
    /// Reads at the broadcast address that bring the unit id in their first register, best first. Empty for a device that
    /// does not answer there. Only one device may be connected then.
    pub discovery: Vec<Group>,
    /// Reads by which the device is told from others: a plausible answer ([`Profile::score`]) speaks for it. Best first.
    pub fingerprint: Vec<Group>,
    /// Worked examples: loading fails if one of them does not come out.
    pub examples: Vec<Example>,
    /// Where the manual is wrong.
    pub errata: Vec<Erratum>,
    /// What to try when something is wrong, the most frequent first.
    pub help: Vec<Help>,
}

/// What a device and the standard say to a unit id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitFit {
    /// Both take it.
    Usual,
    /// The device takes it, the standard reserves it (248 to 255, serial line guide V1.02, clause 2.2): warn.
    Reserved,
    /// The device does not take it.
    Refused,
}

/// Why a text is no profile, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {reason}")]
pub struct ProfileError {
    /// Counted from 1.
    pub line: usize,
    /// In characters, counted from 1.
    pub column: usize,
    /// In English.
    pub reason: String,
}

impl Profile {
    /// Reads and checks a profile's file.
    pub fn from_json(text: &str) -> Result<Self, ProfileError> {
        load::load(text)
    }

    /// What is essential of the profile in few bytes, for another program of the same build: the form changes with the
    /// program.
    pub fn pack(&self) -> Vec<u8> {
        // Nothing in a profile is without a packed form, and a vector takes any number of bytes.
        postcard::to_allocvec(&self.clone().essential()).unwrap_or_default()
    }

    /// What it takes to speak with the device, to simulate it and to name its values: without source, notes, what a write
    /// costs, errata and help.
    #[must_use]
    pub fn essential(mut self) -> Self {
        self.source.clear();
        self.notes.clear();
        self.errata.clear();
        self.help.clear();
        for point in &mut self.points {
            point.note = None;
            point.consequence = None;
            for code in &mut point.codes {
                code.consequence = None;
                code.leaves = None;
            }
        }
        self
    }

    /// A packed profile; `None` for other bytes.
    pub fn unpack(packed: &[u8]) -> Option<Self> {
        postcard::from_bytes(packed).ok()
    }

    /// The point with this id.
    pub fn point(&self, id: &str) -> Option<&Point> {
        self.points.iter().find(|point| point.id == id)
    }

    /// What the device is for, the primary one first.
    pub fn measurements(&self) -> Vec<&Point> {
        let measurements = || self.points.iter().filter(|point| point.role == Role::Measurement);
        measurements().filter(|point| point.primary).chain(measurements().filter(|point| !point.primary)).collect()
    }

    /// The reads that bring the measurements, and before them what those are scaled by and where their units stand. Of
    /// [`Profile::groups`] only those that the manual allows.
    pub fn live_groups(&self) -> Vec<Group> {
        let measured = || self.points.iter().filter(|point| point.role == Role::Measurement);
        let referred = measured().flat_map(Point::refers_to).filter_map(|id| self.point(id));
        self.groups_of(referred.chain(measured()))
    }

    /// The reads that bring what measurements are seen with, such as limits and offsets: parameters that [`Self::live_groups`]
    /// leave out and that do not set the line.
    pub fn context_groups(&self) -> Vec<Group> {
        let live = self.live_groups();
        let beside = |point: &&Point| point.role == Role::Parameter && point.effects.is_empty();
        let mut context = self.groups_of(self.points.iter().filter(beside));
        context.retain(|group| !live.contains(group));
        context
    }

    /// On which side a measurement is beyond its range, as far as that is known: the range of the profile, or what the
    /// device says of itself; `reading` brings a point's last value. `None` also within, and for what is no number.
    pub fn beyond(&self, point: &Point, value: Value, reading: impl Fn(&str) -> Option<Value>) -> Option<Beyond> {
        let own = point.range.map(|range| (Value::Number(range.first), Value::Number(range.last)));
        let told = || {
            let limits = point.limits_from.as_ref()?;
            let (first, last) = (reading(&limits.first)?, reading(&limits.last)?);
            // A transmitter may fall with what it measures.
            Some(if first.compare(last)?.is_le() { (first, last) } else { (last, first) })
        };
        let side = |(first, last): (Value, Value)| {
            if value.compare(first)?.is_lt() {
                return Some(Beyond::Below(first));
            }
            value.compare(last)?.is_gt().then_some(Beyond::Above(last))
        };
        own.and_then(side).or_else(|| told().and_then(side))
    }

    /// The reads that bring these points, in their order, each once; points that cannot be read are left out.
    pub fn groups_of<'a>(&self, points: impl IntoIterator<Item = &'a Point>) -> Vec<Group> {
        let mut reads: Vec<Group> = Vec::new();
        for point in points {
            let known = self.groups.iter().find(|group| !group.tentative && group.offset_of(point).is_some());
            let Some(read) = known.copied().or_else(|| point.read_group()) else { continue };
            if !reads.contains(&read) {
                reads.push(read);
            }
        }
        reads
    }

    /// Every combination of settings that the line of this device can have, the factory's first, then those that differ
    /// least from it. Data bits stay as they leave the factory.
    pub fn line_candidates(&self) -> Vec<(LineSettings, Mode)> {
        let mut all = Vec::new();
        for mode in with_first(self.mode, &self.choices.modes) {
            for parity in with_first(self.line.parity, &self.choices.parities) {
                for stop_bits in with_first(self.line.stop_bits, &self.choices.stop_bits) {
                    for baud in with_first(self.line.baud, &self.choices.bauds) {
                        all.push((LineSettings { baud, parity, stop_bits, ..self.line }, mode));
                    }
                }
            }
        }
        all
    }

    /// What the device and the standard say to a unit id.
    pub const fn unit_fit(&self, unit: UnitId) -> UnitFit {
        if !self.units.contains(unit.0 as u16) {
            UnitFit::Refused
        } else if unit.0 > 247 {
            UnitFit::Reserved
        } else {
            UnitFit::Usual
        }
    }
}

/// `first` and whatever else there is.
fn with_first<T: Copy + PartialEq>(first: T, all: &[T]) -> impl Iterator<Item = T> {
    core::iter::once(first).chain(all.iter().copied().filter(move |other| *other != first))
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use super::*;
    use crate::line::Parity;
    use crate::value::Decimal;

    pub(super) fn built_in(id: &str) -> Profile {
        let all = BUILT_IN.iter().map(|text| Profile::from_json(text).unwrap());
        all.into_iter().find(|profile| profile.id == id).unwrap()
    }

    #[test]
    fn every_built_in_profile_loads_and_its_examples_come_out() {
        for text in BUILT_IN {
            let profile = Profile::from_json(text).unwrap_or_else(|error| panic!("{error}\n{}", &text[..60]));
            assert!(!profile.live_groups().is_empty(), "{}", profile.id);
            assert!(profile.live_groups().iter().all(|group| group.request().is_some()), "{}", profile.id);
            assert!(!profile.examples.is_empty(), "{}", profile.id);
            assert!(profile.line_candidates().starts_with(&[(profile.line, profile.mode)]), "{}", profile.id);
            assert_eq!(profile.measurements().iter().filter(|point| point.primary).count(), 1, "{}", profile.id);
            let registers: Vec<u16> = profile.points.iter().map(|point| point.register).collect();
            assert!(registers.is_sorted(), "{}", profile.id);
        }
    }

    #[test]
    fn what_is_essential_of_a_profile_comes_out_as_it_was_packed_and_cut_off_not_at_all() {
        for text in BUILT_IN {
            let profile = Profile::from_json(text).unwrap();
            let packed = profile.pack();
            assert_eq!(Profile::unpack(&packed), Some(profile.clone().essential()));
            assert!((0..packed.len()).all(|len| Profile::unpack(&packed[..len]).is_none()), "{}", profile.id);
        }
    }

    #[test]
    fn what_is_essential_reads_and_names_the_same() {
        for text in BUILT_IN {
            let whole = Profile::from_json(text).unwrap();
            let essential = whole.clone().essential();
            assert_eq!(essential.live_groups(), whole.live_groups());
            assert_eq!(essential.line_candidates(), whole.line_candidates());
            assert!(whole.pack().len() * 5 < text.len() * 2, "{}: {} bytes", whole.id, whole.pack().len());
            for (point, other) in essential.points.iter().zip(&whole.points) {
                assert_eq!((&point.name, point.encoding, &point.unit), (&other.name, other.encoding, &other.unit));
            }
            assert_eq!(essential.clone().essential(), essential);
        }
    }

    #[test]
    fn a_measurement_beyond_its_range_is_told() {
        let number = |text| Value::Number(Decimal::parse(text).unwrap());
        let level = built_in("level");
        let value = level.point("value").unwrap();
        let reading = |first: &'static str, last: &'static str| {
            move |id: &str| match id {
                "range_zero" => Some(number(first)),
                "range_full" => Some(number(last)),
                _ => None,
            }
        };
        let side = |text, first, last| level.beyond(value, number(text), reading(first, last));
        assert_eq!(side("6.000", "0.000", "5.000"), Some(Beyond::Above(number("5.000"))));
        assert_eq!(side("5.000", "0.000", "5.000"), None);
        assert_eq!(side("-0.001", "0.000", "5.000"), Some(Beyond::Below(number("0.000"))));
        assert_eq!(side("-0.001", "5.000", "0.000"), Some(Beyond::Below(number("0.000"))));
        assert_eq!(level.beyond(value, number("6.000"), |_| None), None);
        let gauge = built_in("gauge-cable");
        assert_eq!(gauge.beyond(gauge.point("reading").unwrap(), number("-65.535"), |_| None), None);
        let most = Some(Beyond::Above(number("65.535")));
        assert_eq!(gauge.beyond(gauge.point("reading").unwrap(), Value::Float(70.0), |_| None), most);
        assert_eq!(gauge.beyond(gauge.point("reading").unwrap(), Value::Float(f32::NAN), |_| None), None);
    }

    #[test]
    fn a_scaled_measurement_is_read_after_what_scales_it() {
        let reads: Vec<_> =
            built_in("level").live_groups().iter().map(|group| (group.address, group.quantity)).collect();
        assert_eq!(reads, [(3, 1), (2, 1), (4, 1)]);
        let reads: Vec<_> =
            built_in("lvdt").live_groups().iter().map(|group| (group.address, group.quantity)).collect();
        assert_eq!(reads, [(2, 4)]);
        assert_eq!(built_in("gauge-cable").live_groups().len(), 4);
    }

    #[test]
    fn what_measurements_are_seen_with_is_read_beside_them() {
        let registers =
            |id| built_in(id).context_groups().iter().map(|group| (group.address, group.quantity)).collect::<Vec<_>>();
        assert_eq!(registers("level"), [(5, 1), (6, 1), (0xC, 1)]);
        assert_eq!(registers("lvdt"), [(0x34, 1), (0x3F, 1)]);
        assert_eq!(registers("gauge-cable"), []);
    }

    #[test]
    fn forty_two_combinations_of_settings_are_tried_factory_first() {
        let candidates = built_in("lvdt").line_candidates();
        assert_eq!(candidates.len(), 42);
        assert_eq!(candidates[0], (LineSettings::new(9600, Parity::Even), Mode::Rtu));
        assert_eq!(built_in("level").line_candidates().len(), 8);
        let bauds: Vec<u32> = built_in("gauge-cable").line_candidates().iter().map(|(line, _)| line.baud).collect();
        assert_eq!(bauds, vec![38_400, 9600, 19_200]);
    }

    #[test]
    fn unit_ids_beyond_the_standard_are_told() {
        let level = built_in("level");
        let fits = [0, 1, 247, 248, 255].map(|unit| level.unit_fit(UnitId(unit)));
        assert_eq!(fits, [UnitFit::Refused, UnitFit::Usual, UnitFit::Usual, UnitFit::Reserved, UnitFit::Reserved]);
        assert_eq!(built_in("lvdt").unit_fit(UnitId(248)), UnitFit::Refused);
    }
}
