//! What outlives the page: what was to be written, and everywhere that the device may be.

use buslens_bus::record::End;
use buslens_codec::profile::ProfileError;
use serde::{Deserialize, Serialize};

use crate::{Device, Hazard, Reach};

/// A transaction that has begun to write. Whoever carries out the orders keeps it where it outlives the page, before the
/// first byte is written, until [`crate::Order::Forget`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Journal {
    /// Names it: when it began, in microseconds since the Unix epoch.
    pub id: u64,
    /// When it began, in milliseconds since the Unix epoch.
    pub begun_unix_ms: u64,
    /// Id of the device's profile.
    pub profile: String,
    /// The profile's file.
    pub file: String,
    /// How the device was reached before.
    pub reach: Reach,
    /// Its steps in their order.
    pub steps: Vec<JournalStep>,
    /// What was confirmed.
    pub confirmed: Vec<Hazard>,
    /// Everywhere that the device may be, best first.
    pub reaches: Vec<Reach>,
}

/// A step of a journal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JournalStep {
    /// The point's id.
    pub point: String,
    /// What it held before; `None` for a command, and for what cannot be read.
    pub before: Option<Vec<u16>>,
    /// What it should hold, or the command.
    pub after: Vec<u16>,
    /// How far it has come.
    pub state: StepState,
}

/// How far a step has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StepState {
    /// Nothing of it was sent.
    Waiting,
    /// It is about to be sent, or was.
    Sent,
    /// It was carried out.
    Confirmed,
    /// It was undone.
    Undone,
}

impl Journal {
    /// Everywhere that the device may be, best first. Never empty.
    pub fn candidates(&self) -> Vec<Reach> {
        let mut all: Vec<Reach> = Vec::new();
        for reach in self.reaches.iter().chain([&self.reach]) {
            if !all.contains(reach) {
                all.push(*reach);
            }
        }
        all
    }

    /// Whether anything may have been written.
    pub fn has_written(&self) -> bool {
        self.steps.iter().any(|step| step.state != StepState::Waiting)
    }

    /// The device that it is about.
    pub fn device(&self) -> Result<Device, ProfileError> {
        Device::new(&self.file, self.candidates().first().copied().unwrap_or(self.reach))
    }

    /// As a text that later versions of the page read, too.
    pub fn to_json(&self) -> String {
        // Nothing in a journal is without a form in JSON.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Reads such a text; `None` for any other.
    pub fn from_json(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }
}

/// A write that has left: who keeps these knows every change of a device, and how often its memory was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AuditEntry {
    /// When it ended, in milliseconds since the Unix epoch.
    pub unix_ms: u64,
    /// Id of the device's profile.
    pub profile: String,
    /// With which settings, to whom.
    pub reach: Reach,
    /// The point's id.
    pub point: String,
    /// What it was last read to hold; `None` for a command, and for what cannot be read.
    pub old: Option<Vec<u16>>,
    /// What was written.
    pub new: Vec<u16>,
    /// The bytes as they went out.
    pub sent: Vec<u8>,
    /// The bytes that were heard.
    pub received: Vec<u8>,
    /// How it ended.
    pub end: End,
}
