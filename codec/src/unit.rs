//! The address of a device on the line.

use core::fmt;

use serde::{Deserialize, Serialize};

/// A unit id: 1 to 247 name a device, 0 is broadcast, 248 to 255 are reserved (serial line guide, clause 2.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct UnitId(pub u8);

impl UnitId {
    /// Everybody at once.
    pub const BROADCAST: Self = Self(0);

    /// Whether the standard keeps this id for later use. Some devices use it all the same.
    pub const fn is_reserved(self) -> bool {
        self.0 > 247
    }
}

impl fmt::Display for UnitId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
