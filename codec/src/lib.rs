//! Modbus codec.
#![no_std]
extern crate alloc;

pub mod line;
