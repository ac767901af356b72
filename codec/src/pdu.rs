//! Protocol data units: function code and data (application protocol V1.1b3, clause 6).
//!
//! Every public function of the standard on a serial line has a variant of its own in [`Request`] and in [`Response`]; any
//! other function, and any MEI type of function 2B but 0E, is kept raw in `Other`.
//!
//! Decoding takes any bytes and never panics. What fails where:
//!
//! - `decode` fails with a [`PduError`] that says why the bytes are no PDU of their function.
//! - `encode` fails only where a list or a quantity is beyond the standard's limits. It cannot fail for what `decode`
//!   returned, and gives the same bytes again.
//! - What `encode` gives has 1 to 253 bytes, so [`crate::rtu::encode`], [`crate::ascii::encode`] and
//!   [`crate::adu::encode`] cannot fail for it.
//! - What `encode` gives decodes to the same value, but for an `Other` whose function has a variant of its own and for an
//!   [`ExceptionCode::Other`] whose code has a name: such an `Other` sends any bytes, also wrong ones, on purpose.

mod bits;
mod code;
mod error;
mod record;
mod request;
mod response;
mod wire;

pub use bits::{pack_bits, unpack_bits};
pub use code::{DeviceIdCode, ExceptionCode, SubFunction};
pub use error::PduError;
pub use record::{DeviceIdObject, FileRecord, FileRecordRange};
pub use request::Request;
pub use response::Response;

/// Most coils or discrete inputs in one read (clauses 6.1 and 6.2).
pub const MAX_READ_BITS: u16 = 2000;
/// Most registers in one read (clauses 6.3, 6.4 and 6.17).
pub const MAX_READ_QUANTITY: u16 = 125;
/// Most coils in one write (clause 6.11).
pub const MAX_WRITE_COILS: u16 = 0x07B0;
/// Most registers in one write (clause 6.12).
pub const MAX_WRITE_QUANTITY: u16 = 123;
/// Most registers that function 17 writes (clause 6.17).
pub const MAX_READ_WRITE_QUANTITY: u16 = 121;
/// Most registers in a FIFO queue (clause 6.18).
pub const MAX_FIFO_COUNT: u16 = 31;
/// Most events in a log (clause 6.10).
pub const MAX_EVENTS: u16 = 64;
/// Last record of a file (clauses 6.14 and 6.15).
pub const MAX_RECORD_NUMBER: u16 = 9999;

/// The MEI type of read device identification under function 2B (clause 6.21).
pub(crate) const MEI_READ_DEVICE_ID: u8 = 0x0E;
/// The only reference type of file records (clauses 6.14 and 6.15).
pub(crate) const REFERENCE_TYPE: u8 = 6;
/// The bit that makes a function code an exception (clause 7).
pub(crate) const EXCEPTION: u8 = 0x80;
