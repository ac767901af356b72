//! How a device is reached.

use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::{Link, Profile};
use serde::{Deserialize, Serialize};

/// How a device is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Reach {
    /// Its unit id. 0 is everybody on the line.
    pub unit: UnitId,
    /// Settings of the port.
    pub line: LineSettings,
    /// RTU or ASCII.
    pub mode: Mode,
}

impl Reach {
    /// As the profile says that it leaves the factory.
    pub fn of_factory(profile: &Profile) -> Self {
        Self { unit: UnitId(profile.unit), line: profile.line, mode: profile.mode }
    }

    /// Whether both need the same settings of the port.
    pub fn shares_line(&self, other: &Self) -> bool {
        (self.line, self.mode) == (other.line, other.mode)
    }

    pub(crate) fn link(self) -> Link {
        Link { unit: Some(self.unit), line: self.line, mode: self.mode }
    }
}
