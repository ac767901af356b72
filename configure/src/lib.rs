//! Changing how a device on a serial line is set, without ever losing it.
//!
//! - [`Snapshot`]: what a device holds, with a file form (`docs/snapshots.md` of the project).
//! - [`Edit`] and [`Plan`]: what is wanted, checked before anything is sent, and the steps that bring it about with every
//!   frame and every danger. Both are pure: a page calls them for a review.
//! - [`Procedure`]: a plan being carried out, a device being read, searched for, or brought back. It opens no port, reads no
//!   clock and sets no timer.
//! - [`Journal`]: what outlives the page, from which any later procedure finds the device again, and finishes or undoes.
//! - [`Report`]: what has come of it; what is known by reading apart from what is believed.
//!
//! ```
//! use buslens_codec::profile::{BUILT_IN, Profile};
//! use buslens_configure::{Edit, Hazard, Plan, Reach, Snapshot};
//!
//! let profile = Profile::from_json(BUILT_IN[0]).unwrap();
//! let have = Snapshot::empty(&profile, Reach::of_factory(&profile));
//! let baud = profile.point("baud").unwrap();
//! let edit = Edit::parse(&profile, baud, "2400 Bd", &have).unwrap();
//! assert_eq!(edit.registers, [1]);
//! let plan = Plan::of(&profile, &have, &[edit]).unwrap();
//! assert_eq!(plan.steps[0].request, [0x01, 0x10, 0x00, 0x31, 0x00, 0x01, 0x02, 0x00, 0x01, 0x63, 0xB1]);
//! assert_eq!(plan.hazards, [Hazard::SlowBaud { baud: 2400 }]);
//! assert!(Edit::parse(&profile, baud, "2401", &have).is_err());
//! ```

mod device;
mod edit;
mod journal;
mod plan;
mod procedure;
mod progress;
mod reach;
mod report;
mod request;
mod snapshot;

pub use device::Device;
pub use edit::{Edit, Refusal, Transfer, Unfit, edits_to};
pub use journal::{AuditEntry, Journal, JournalStep, StepState};
pub use plan::{After, Hazard, Plan, Step};
pub use procedure::{Line, Order, Port, Procedure, Scope, Task, Way};
pub use progress::{Phase, Progress};
pub use reach::Reach;
pub use report::{Ending, Exchange, Report, StepOutcome, StepReport, Why};
pub use snapshot::{Datum, Difference, FileFault, FileReason, Read, Shown, Snapshot, compare};
