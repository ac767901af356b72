/// Why bytes are no PDU of their function, or a value makes none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PduError {
    /// No function code.
    #[error("empty PDU")]
    Empty,
    /// Longer than any PDU on a serial line.
    #[error("PDU longer than 253 bytes")]
    TooLong,
    /// Not as long as its function needs.
    #[error("PDU has {found} bytes, its function needs {expected}")]
    Length {
        /// Bytes there are.
        found: usize,
        /// Bytes there must be; the fewest where that depends on bytes that are missing.
        expected: usize,
    },
    /// A quantity that is zero or beyond the standard's limits.
    #[error("quantity {found} is not 1 to {limit}")]
    Quantity {
        /// The quantity.
        found: u16,
        /// The largest that is allowed.
        limit: u16,
    },
    /// A count beyond the standard's limits; zero is allowed.
    #[error("count {found} is more than {limit}")]
    Count {
        /// The count.
        found: u16,
        /// The largest that is allowed.
        limit: u16,
    },
    /// The byte count does not fit the quantity or the bytes that follow.
    #[error("byte count is {found}, must be {expected}")]
    ByteCount {
        /// As in the PDU.
        found: u8,
        /// What it should be.
        expected: usize,
    },
    /// The byte count of a FIFO queue does not fit the bytes that follow. It alone has two bytes.
    #[error("byte count is {found}, must be {expected}")]
    FifoByteCount {
        /// As in the PDU.
        found: u16,
        /// What it should be.
        expected: usize,
    },
    /// A byte count that holds no whole number of registers.
    #[error("byte count {found} is odd, registers have two bytes")]
    OddByteCount {
        /// As in the PDU.
        found: u8,
    },
    /// A bit that stands for no coil or input is set; the standard fills the last byte up with zeros.
    #[error("padding bits of {found:02X} are not zero")]
    Padding {
        /// The last byte.
        found: u8,
    },
    /// A coil value other than FF00 and 0000.
    #[error("coil value {found:04X} is neither FF00 nor 0000")]
    CoilValue {
        /// The value.
        found: u16,
    },
    /// A function code with the exception's bit where none belongs.
    #[error("function code {found:02X} is none of a response")]
    FunctionCode {
        /// The code.
        found: u8,
    },
    /// A reference type other than 6.
    #[error("reference type is {found}, must be 6")]
    ReferenceType {
        /// As in the PDU.
        found: u8,
    },
    /// File 0: files count from 1.
    #[error("there is no file 0")]
    FileNumber,
    /// A record beyond the last of a file.
    #[error("record {found} is not 0 to 9999")]
    RecordNumber {
        /// The record.
        found: u16,
    },
    /// A record of no registers, or one whose length in bytes holds no whole number of them.
    #[error("record length {found} holds no whole registers")]
    RecordLength {
        /// As in the PDU: registers in requests, bytes in the replies of function 14.
        found: u16,
    },
    /// The records that are asked for do not fit one reply.
    #[error("the reply would have {found} bytes, more than 253")]
    ReplyTooLong {
        /// Bytes of the reply's PDU.
        found: usize,
    },
    /// A read device ID code other than 1 to 4.
    #[error("read device ID code {found} is not 1 to 4")]
    DeviceIdCode {
        /// As in the PDU.
        found: u8,
    },
    /// More follows is neither FF nor 00.
    #[error("more follows is {found:02X}, neither FF nor 00")]
    MoreFollows {
        /// As in the PDU.
        found: u8,
    },
    /// The reply is one of its function, but does not repeat what was asked.
    #[error("the reply does not fit its request")]
    Mismatch,
}
