//! A simulated line with simulated sensors, sans-io like the master: time is an argument and bytes are all that crosses.
//!
//! The line knows what a wire knows: who drives it, at which settings, and how long a character takes. Wrong settings
//! give silence or garbage, talking at the same time destroys both, and an adapter may echo. Demo mode and the tests use
//! the same line: `handle_settings`, `handle_bytes` and `handle_timeout` go in, `poll_transmit` and `poll_timeout` are
//! drained afterwards. [`Demonstration`] keeps such lines for as long as a page lives.

mod course;
mod demonstration;
mod described;
mod faults;
mod gauge_cable;
mod level;
mod line;
mod lvdt;
mod sensor;
mod server;
mod station;

pub use course::Course;
pub use demonstration::Demonstration;
pub use described::Described;
pub use faults::Faults;
pub use gauge_cable::GaugeCable;
pub use level::Level;
pub use line::Line;
pub use lvdt::{BroadcastAddress, Lvdt, Motion};
pub use sensor::sensor;
pub use station::{Device, Reply};
