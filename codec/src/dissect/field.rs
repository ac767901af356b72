use core::ops::Range;

use crate::UnitId;
use crate::pdu::{ExceptionCode, SubFunction};

/// Some bytes of the frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Their place.
    pub range: Range<usize>,
    /// What they are.
    pub kind: FieldKind,
}

/// What bytes are. Values are as sent, also where the standard does not allow them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// The colon of ASCII mode.
    Start,
    /// The unit id.
    Unit(UnitId),
    /// The function code as sent, with an exception's top bit.
    Function(u8),
    /// Why the device refuses.
    Exception(ExceptionCode),
    /// The first register, coil or input; of function 17 the first that is read.
    Address(u16),
    /// How many registers, coils or inputs; of function 17 how many are read.
    Quantity(u16),
    /// How many bytes follow.
    ByteCount(u8),
    /// A register's value.
    Register {
        /// Its address, where it is known.
        address: Option<u16>,
        /// Its value.
        value: u16,
    },
    /// A coil's value: FF00 is on, 0000 is off.
    Coil(u16),
    /// A byte of coils or inputs, the first in the lowest bit.
    Bits {
        /// The first coil or input, where it is known.
        address: Option<u16>,
        /// How many of the bits stand for one, 0 to 8; the others fill up.
        count: u8,
        /// The byte.
        value: u8,
    },
    /// The eight exception status bits of function 07.
    ExceptionStatus(u8),
    /// Which diagnostic, function 08.
    SubFunction(SubFunction),
    /// The two bytes of a diagnostic: a counter, a register or the parameter. The data that function 08/00 sends back is
    /// [`FieldKind::Data`].
    DiagnosticValue(u16),
    /// FFFF if the device is still busy with a command, functions 0B and 0C.
    Status(u16),
    /// Messages carried out, functions 0B and 0C.
    EventCount(u16),
    /// Messages seen on the bus, function 0C.
    MessageCount(u16),
    /// One entry of the event log, function 0C (clause 6.10 tells its bits).
    Event(u8),
    /// The id of function 11, or all of its data where it does not show where the id ends.
    ServerId,
    /// Whether the device runs: FF or 00, function 11.
    RunIndicator(u8),
    /// 6, functions 14 and 15.
    ReferenceType(u8),
    /// A file, functions 14 and 15.
    FileNumber(u16),
    /// The first record in a file, functions 14 and 15.
    RecordNumber(u16),
    /// Registers of a file, functions 14 and 15.
    RecordLength(u16),
    /// Bytes of one record with its reference type, in replies of function 14.
    RecordByteCount(u8),
    /// Bits that stay, function 16.
    AndMask(u16),
    /// Values of the bits that do not stay, function 16.
    OrMask(u16),
    /// The first register that function 17 writes.
    WriteAddress(u16),
    /// How many registers function 17 writes.
    WriteQuantity(u16),
    /// How many bytes follow, function 18.
    FifoByteCount(u16),
    /// How many registers are in the queue, function 18.
    FifoCount(u16),
    /// What function 2B carries; 0E is device identification.
    MeiType(u8),
    /// Which identification: 1 basic, 2 regular, 3 extended, 4 one object.
    DeviceIdCode(u8),
    /// The highest identification that the device knows, with the top bit set if it answers single objects too.
    Conformity(u8),
    /// FF if there are more objects than fit the reply, else 00.
    MoreFollows(u8),
    /// Where to go on if there are.
    NextObject(u8),
    /// How many objects follow.
    ObjectCount(u8),
    /// An object, or the first one asked for.
    ObjectId(u8),
    /// Bytes of an object.
    ObjectLength(u8),
    /// What an object says, mostly text.
    ObjectValue,
    /// Bytes without a known meaning.
    Data,
    /// CRC or LRC.
    Check,
    /// CR LF of ASCII mode.
    End,
}
