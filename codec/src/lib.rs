//! Modbus codec.
#![no_std]
extern crate alloc;

pub mod adu;
pub mod ascii;
pub mod check;
pub mod line;
pub mod pdu;
pub mod profile;
pub mod rtu;
mod unit;
pub mod value;

pub use unit::UnitId;
