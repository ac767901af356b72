//! A device, as far as a procedure must know it.

use std::sync::Arc;

use buslens_codec::profile::{Group, Profile, ProfileError};

use crate::Reach;

/// A device, as far as it is known. A procedure gives it back, bettered, by [`crate::Procedure::device`]: the next one is
/// begun with that.
#[derive(Clone, Debug, PartialEq)]
pub struct Device {
    /// What it is.
    pub profile: Arc<Profile>,
    /// The profile's file, which a journal keeps.
    pub file: Arc<str>,
    /// How it was last reached.
    pub reach: Reach,
    /// Reads of several points that it has refused: not tried again.
    pub refused: Vec<Group>,
    /// The longest that it thought before it answered, with what its adapter held back, in microseconds; 0 if it never
    /// answered.
    pub slowest_us: u32,
}

impl Device {
    /// A device of which nothing is known but its profile's file and how it is reached.
    pub fn new(file: &str, reach: Reach) -> Result<Self, ProfileError> {
        let profile = Arc::new(Profile::from_json(file)?);
        Ok(Self { profile, file: file.into(), reach, refused: Vec::new(), slowest_us: 0 })
    }
}
