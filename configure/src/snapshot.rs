//! What a device holds.

mod file;

use buslens_codec::profile::{Known, Point, PointValue, Profile, Role, Texts};
use serde::{Deserialize, Serialize};

use crate::Reach;
use crate::request::same;

pub use file::{FileFault, FileReason};

/// What a device holds: every parameter that can be read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Id of the device's profile.
    pub profile: String,
    /// What its user calls it; empty for nothing.
    pub name: String,
    /// When it was read, in milliseconds since the Unix epoch.
    pub taken_unix_ms: u64,
    /// How the device was reached.
    pub reach: Reach,
    /// Its parameters in the profile's order.
    pub data: Vec<Datum>,
}

/// A parameter, and what reading it has brought.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Datum {
    /// The point's id.
    pub point: String,
    /// What was read.
    pub read: Read,
}

/// What reading a point has brought.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Read {
    /// Its registers; a coil is FF00 or 0000.
    Registers(Vec<u16>),
    /// The device refused by an exception with this code.
    Refused(u8),
    /// It did not answer.
    NoAnswer,
}

/// A parameter as people read it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shown {
    /// The point's id.
    pub point: String,
    /// Its value without unit; `None` where nothing was read, or its registers hold no value of its encoding.
    pub text: Option<String>,
    /// Its unit as far as it is known, empty for none.
    pub unit: String,
    /// Whether it is as it leaves the factory; `None` where the profile does not tell.
    pub factory: Option<bool>,
    /// `false` where another register tells the scale and was not read: the text is the register's own number then.
    pub scaled: bool,
}

/// A parameter that two snapshots tell otherwise.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Difference {
    /// The point's id.
    pub point: String,
    /// In the first; `None` if it tells nothing of it.
    pub left: Option<Read>,
    /// In the second; `None` if it tells nothing of it.
    pub right: Option<Read>,
}

impl Snapshot {
    /// Of a device of which nothing has been read.
    pub fn empty(profile: &Profile, reach: Reach) -> Self {
        Self { profile: profile.id.clone(), name: String::new(), taken_unix_ms: 0, reach, data: Vec::new() }
    }

    /// What reading a point has brought; `None` if it was not read.
    pub fn read(&self, point: &str) -> Option<&Read> {
        self.data.iter().find(|datum| datum.point == point).map(|datum| &datum.read)
    }

    /// A point's registers, if it was read.
    pub fn registers(&self, point: &str) -> Option<&[u16]> {
        match self.read(point)? {
            Read::Registers(registers) => Some(registers),
            Read::Refused(_) | Read::NoAnswer => None,
        }
    }

    /// What it tells about scales and units.
    pub fn known(&self, profile: &Profile) -> Known {
        let mut known = Known::default();
        for point in &profile.points {
            if let (Some(function), Some(registers)) = (point.read.first(), self.registers(&point.id)) {
                profile.decode_points(*function, point.register, registers, &mut known);
            }
        }
        known
    }

    /// Its parameters as people read them, in its own order; those that the profile does not know are left out.
    pub fn values(&self, profile: &Profile, language: impl Fn(&Texts) -> &String) -> Vec<Shown> {
        let known = self.known(profile);
        let shown = |datum: &Datum| {
            let point = profile.point(&datum.point)?;
            let found = match &datum.read {
                Read::Registers(registers) => decode(profile, point, registers, &known),
                Read::Refused(_) | Read::NoAnswer => None,
            };
            let value = found.as_ref().and_then(|found| found.value.ok());
            Some(Shown {
                point: point.id.clone(),
                text: value.map(|value| point.text(value, &language)),
                unit: profile.unit_of(point, &known).to_owned(),
                factory: is_of_factory(point, &datum.read),
                scaled: found.is_none_or(|found| found.scaled),
            })
        };
        self.data.iter().filter_map(shown).collect()
    }

    /// Puts in what was read of a point, at its place in the profile.
    pub(crate) fn put(&mut self, profile: &Profile, point: &str, read: Read) {
        let place = |id: &str| profile.points.iter().position(|point| point.id == id);
        if let Some(datum) = self.data.iter_mut().find(|datum| datum.point == point) {
            datum.read = read;
            return;
        }
        let at = self.data.partition_point(|datum| place(&datum.point) < place(point));
        self.data.insert(at, Datum { point: point.to_owned(), read });
    }
}

/// What differs between two snapshots, in the profile's order. What neither knows is the same.
pub fn compare(profile: &Profile, left: &Snapshot, right: &Snapshot) -> Vec<Difference> {
    let mut all = Vec::new();
    for point in &profile.points {
        let (left, right) = (left.read(&point.id), right.read(&point.id));
        let alike = match (left, right) {
            (Some(Read::Registers(left)), Some(Read::Registers(right))) => same(point, left, right),
            (left, right) => left == right,
        };
        if !alike {
            all.push(Difference { point: point.id.clone(), left: left.cloned(), right: right.cloned() });
        }
    }
    all
}

/// The points that a snapshot holds: parameters that can be read, and what scales them.
pub(crate) fn parameters(profile: &Profile) -> Vec<&Point> {
    let readable = |point: &Point| point.read.iter().any(|function| matches!(function, 1..=4));
    let is_parameter = |point: &Point| point.role == Role::Parameter && readable(point);
    let scales = |id: &str| {
        let mut users = profile.points.iter().filter(|point| is_parameter(point) || !point.write.is_empty());
        users.any(|point| point.refers_to().any(|other| other == id))
    };
    profile.points.iter().filter(|point| is_parameter(point) || readable(point) && scales(&point.id)).collect()
}

/// A point's registers as a value.
pub(crate) fn decode<'a>(
    profile: &'a Profile,
    point: &Point,
    registers: &[u16],
    known: &Known,
) -> Option<PointValue<'a>> {
    let function = point.read.first().or(point.write.first())?;
    let found = profile.decode_points(*function, point.register, registers, &mut known.clone());
    found.into_iter().find(|found| found.point.id == point.id)
}

/// Whether a point is as it leaves the factory; `None` where the profile or the device does not tell.
pub(crate) fn is_of_factory(point: &Point, read: &Read) -> Option<bool> {
    match read {
        Read::Registers(registers) => Some(same(point, registers, &[point.factory?])),
        Read::Refused(_) | Read::NoAnswer => None,
    }
}
