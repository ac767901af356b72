//! Modbus on a serial line, as data: frames, checks, PDUs, values, device profiles, and the dissection of anything that
//! came off a line. No clock, no I/O, no browser; `no_std` with `alloc`.
//!
//! Nothing here panics on input. What one function encodes its twin decodes to the same value; what cannot be encoded or
//! decoded is a typed error.
//!
//! ```
//! use buslens_codec::{UnitId, line::Mode, pdu::{Request, Response}, rtu};
//!
//! let request = Request::ReadHoldingRegisters { address: 0x31, quantity: 1 };
//! let frame = rtu::encode(UnitId(1), &request.encode()?).expect("a PDU that encodes fits a frame");
//! assert_eq!(frame, [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5]);
//!
//! let reply = rtu::decode(&[0x01, 0x03, 0x02, 0x00, 0x07, 0xF9, 0x86]).expect("the check is right");
//! assert_eq!(Response::decode(reply.pdu)?, Response::ReadHoldingRegisters { values: vec![7] });
//! # Ok::<(), buslens_codec::pdu::PduError>(())
//! ```

#![no_std]

extern crate alloc;

pub mod adu;
pub mod ascii;
pub mod check;
pub mod diagnose;
pub mod dissect;
pub mod intake;
pub mod json;
pub mod line;
pub mod outline;
pub mod pdu;
pub mod profile;
pub mod quantity;
pub mod rtu;
pub mod segment;
pub mod session;
pub mod stream;
pub mod transcript;
mod unit;
pub mod value;
pub mod views;

pub use unit::UnitId;
