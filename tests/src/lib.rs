//! Drives the built page in real Chromium through its real Web Serial stack.
//!
//! Nothing replaces `navigator.serial`: umockdev shows the browser a USB serial adapter, whose device node leads to a pty,
//! and at the pty's other end a line paced at the true character time carries bytes to a simulated sensor or to a Modbus
//! server that this project did not write. The line sees the baud rate and parity that the browser asked for.

// What a test needs and does not get ends the test.
#![allow(clippy::missing_panics_doc)]

pub mod pages;
pub mod testbed;
