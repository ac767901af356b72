//! A simulated line with simulated sensors, sans-io like the master: time is an argument and bytes are all that crosses.
//!
//! The line knows what a wire knows: who drives it, at which settings, and how long a character takes. Wrong settings
//! give silence or garbage, talking at the same time destroys both, and an adapter may echo. Demo mode and the tests use
//! the same line: `handle_settings`, `handle_bytes` and `handle_timeout` go in, `poll_transmit` and `poll_timeout` are
//! drained afterwards.

mod faults;
mod line;
mod lvdt;
mod station;

pub use faults::Faults;
pub use line::Line;
pub use lvdt::{Lvdt, Motion};
pub use station::{Device, Reply};
