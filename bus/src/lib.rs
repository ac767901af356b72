//! Sans-io bus master.

pub mod time;
