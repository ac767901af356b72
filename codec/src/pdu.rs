//! Protocol data units: function code and data (application protocol V1.1b3, clause 6).
//!
//! [`Request`] and [`Response`] can hold only what fits a PDU, but for quantities, which [`Request::encode`] and
//! [`Response::encode`] check. What they encode decodes to the same value, and what decodes encodes to the same bytes.
//! Decoding takes any bytes and never panics.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::rtu::MAX_PDU_LEN;

/// Most registers in one read (clauses 6.3 and 6.4).
pub const MAX_READ_QUANTITY: u16 = 125;
/// Most registers in one write (clause 6.12).
pub const MAX_WRITE_QUANTITY: u16 = 123;

const COIL_ON: u16 = 0xFF00;
const COIL_OFF: u16 = 0x0000;
const EXCEPTION: u8 = 0x80;

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
        /// Bytes there must be.
        expected: usize,
    },
    /// A quantity beyond the standard's limits.
    #[error("quantity {found} is not 1 to {limit}")]
    Quantity {
        /// The quantity.
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
    /// A coil value other than FF00 and 0000.
    #[error("coil value {found:04X} is neither FF00 nor 0000")]
    CoilValue {
        /// The value.
        found: u16,
    },
}

/// What a master asks.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Request {
    /// Function 03.
    ReadHoldingRegisters {
        /// First register.
        address: u16,
        /// 1 to 125.
        quantity: u16,
    },
    /// Function 04.
    ReadInputRegisters {
        /// First register.
        address: u16,
        /// 1 to 125.
        quantity: u16,
    },
    /// Function 05.
    WriteSingleCoil {
        /// The coil.
        address: u16,
        /// FF00 or 0000.
        on: bool,
    },
    /// Function 06.
    WriteSingleRegister {
        /// The register.
        address: u16,
        /// Its new value.
        value: u16,
    },
    /// Function 10 (16 decimal).
    WriteMultipleRegisters {
        /// First register.
        address: u16,
        /// 1 to 123 new values.
        values: Vec<u16>,
    },
    /// Any other function code, raw.
    Other {
        /// The function code.
        function: u8,
        /// Everything after it.
        data: Vec<u8>,
    },
}

/// What a device answers.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Response {
    /// Function 03.
    ReadHoldingRegisters {
        /// 1 to 125 values.
        values: Vec<u16>,
    },
    /// Function 04.
    ReadInputRegisters {
        /// 1 to 125 values.
        values: Vec<u16>,
    },
    /// Function 05: the request again.
    WriteSingleCoil {
        /// The coil.
        address: u16,
        /// FF00 or 0000.
        on: bool,
    },
    /// Function 06: the request again.
    WriteSingleRegister {
        /// The register.
        address: u16,
        /// Its new value.
        value: u16,
    },
    /// Function 10 (16 decimal).
    WriteMultipleRegisters {
        /// First register.
        address: u16,
        /// Registers written, 1 to 123.
        quantity: u16,
    },
    /// An exception: the function code with its top bit set.
    Exception {
        /// The function code that is refused, without the top bit.
        function: u8,
        /// Why.
        code: ExceptionCode,
    },
    /// Any other function code, raw.
    Other {
        /// The function code.
        function: u8,
        /// Everything after it.
        data: Vec<u8>,
    },
}

/// Why a device refuses (clause 7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(from = "u8", into = "u8")]
pub enum ExceptionCode {
    /// 01
    IllegalFunction,
    /// 02
    IllegalDataAddress,
    /// 03
    IllegalDataValue,
    /// 04
    ServerDeviceFailure,
    /// 05
    Acknowledge,
    /// 06
    ServerDeviceBusy,
    /// 08
    MemoryParityError,
    /// 0A
    GatewayPathUnavailable,
    /// 0B
    GatewayTargetFailedToRespond,
    /// A code that the standard does not name.
    Other(u8),
}

impl From<u8> for ExceptionCode {
    fn from(code: u8) -> Self {
        match code {
            1 => Self::IllegalFunction,
            2 => Self::IllegalDataAddress,
            3 => Self::IllegalDataValue,
            4 => Self::ServerDeviceFailure,
            5 => Self::Acknowledge,
            6 => Self::ServerDeviceBusy,
            8 => Self::MemoryParityError,
            10 => Self::GatewayPathUnavailable,
            11 => Self::GatewayTargetFailedToRespond,
            other => Self::Other(other),
        }
    }
}

impl From<ExceptionCode> for u8 {
    fn from(code: ExceptionCode) -> Self {
        code.code()
    }
}

impl ExceptionCode {
    /// The code on the wire.
    pub const fn code(self) -> u8 {
        match self {
            Self::IllegalFunction => 1,
            Self::IllegalDataAddress => 2,
            Self::IllegalDataValue => 3,
            Self::ServerDeviceFailure => 4,
            Self::Acknowledge => 5,
            Self::ServerDeviceBusy => 6,
            Self::MemoryParityError => 8,
            Self::GatewayPathUnavailable => 10,
            Self::GatewayTargetFailedToRespond => 11,
            Self::Other(code) => code,
        }
    }
}

impl Request {
    /// The function code.
    pub fn function(&self) -> u8 {
        match self {
            Self::ReadHoldingRegisters { .. } => 0x03,
            Self::ReadInputRegisters { .. } => 0x04,
            Self::WriteSingleCoil { .. } => 0x05,
            Self::WriteSingleRegister { .. } => 0x06,
            Self::WriteMultipleRegisters { .. } => 0x10,
            Self::Other { function, .. } => *function,
        }
    }

    /// Whether it may change something in the device. Unknown functions may.
    pub fn is_write(&self) -> bool {
        !matches!(self, Self::ReadHoldingRegisters { .. } | Self::ReadInputRegisters { .. })
    }

    /// The bytes of the PDU.
    pub fn encode(&self) -> Result<Vec<u8>, PduError> {
        let mut pdu = Vec::new();
        pdu.push(self.function());
        match self {
            Self::ReadHoldingRegisters { address, quantity } | Self::ReadInputRegisters { address, quantity } => {
                check_quantity(*quantity, MAX_READ_QUANTITY)?;
                push_words(&mut pdu, &[*address, *quantity]);
            }
            Self::WriteSingleCoil { address, on } => push_words(&mut pdu, &[*address, coil_value(*on)]),
            Self::WriteSingleRegister { address, value } => push_words(&mut pdu, &[*address, *value]),
            Self::WriteMultipleRegisters { address, values } => {
                let quantity = u16::try_from(values.len()).unwrap_or(u16::MAX);
                check_quantity(quantity, MAX_WRITE_QUANTITY)?;
                push_words(&mut pdu, &[*address, quantity]);
                // At most 246.
                pdu.push(u8::try_from(quantity * 2).unwrap_or(u8::MAX));
                push_words(&mut pdu, values);
            }
            Self::Other { data, .. } => pdu.extend_from_slice(data),
        }
        check_length(pdu)
    }

    /// Reads a request PDU.
    pub fn decode(pdu: &[u8]) -> Result<Self, PduError> {
        let (&function, data) = split(pdu)?;
        match function {
            0x03 | 0x04 => {
                let [address, quantity] = two_words(data)?;
                check_quantity(quantity, MAX_READ_QUANTITY)?;
                Ok(if function == 0x03 {
                    Self::ReadHoldingRegisters { address, quantity }
                } else {
                    Self::ReadInputRegisters { address, quantity }
                })
            }
            0x05 => {
                let [address, value] = two_words(data)?;
                Ok(Self::WriteSingleCoil { address, on: coil_is_on(value)? })
            }
            0x06 => {
                let [address, value] = two_words(data)?;
                Ok(Self::WriteSingleRegister { address, value })
            }
            0x10 => {
                let Some((head, values)) = data.split_at_checked(5) else {
                    return Err(PduError::Length { found: pdu.len(), expected: 8 });
                };
                let [address, quantity] = two_words(&head[..4])?;
                check_quantity(quantity, MAX_WRITE_QUANTITY)?;
                let expected = usize::from(quantity) * 2;
                if usize::from(head[4]) != expected {
                    return Err(PduError::ByteCount { found: head[4], expected });
                }
                if values.len() != expected {
                    return Err(PduError::Length { found: pdu.len(), expected: 6 + expected });
                }
                Ok(Self::WriteMultipleRegisters { address, values: words(values) })
            }
            function => Ok(Self::Other { function, data: data.to_vec() }),
        }
    }

    /// Length of the normal reply's PDU, where the function tells it.
    pub fn response_pdu_len(&self) -> Option<usize> {
        match self {
            Self::ReadHoldingRegisters { quantity, .. } | Self::ReadInputRegisters { quantity, .. } => {
                Some(2 + 2 * usize::from(*quantity))
            }
            Self::WriteSingleCoil { .. } | Self::WriteSingleRegister { .. } | Self::WriteMultipleRegisters { .. } => {
                Some(5)
            }
            Self::Other { .. } => None,
        }
    }

    /// Whether `response` can answer this: the function, the byte count and the echoed fields fit, or it refuses this
    /// function.
    pub fn accepts(&self, response: &Response) -> bool {
        match (self, response) {
            (_, Response::Exception { function, .. }) => *function == self.function(),
            (Self::ReadHoldingRegisters { quantity, .. }, Response::ReadHoldingRegisters { values })
            | (Self::ReadInputRegisters { quantity, .. }, Response::ReadInputRegisters { values }) => {
                values.len() == usize::from(*quantity)
            }
            (Self::WriteSingleCoil { address, on }, Response::WriteSingleCoil { address: a, on: o }) => {
                (address, on) == (a, o)
            }
            (Self::WriteSingleRegister { address, value }, Response::WriteSingleRegister { address: a, value: v }) => {
                (address, value) == (a, v)
            }
            (
                Self::WriteMultipleRegisters { address, values },
                Response::WriteMultipleRegisters { address: a, quantity },
            ) => address == a && values.len() == usize::from(*quantity),
            (Self::Other { function, .. }, Response::Other { function: answered, .. }) => function == answered,
            _ => false,
        }
    }
}

impl Response {
    /// The function code, without the exception's top bit.
    pub fn function(&self) -> u8 {
        match self {
            Self::ReadHoldingRegisters { .. } => 0x03,
            Self::ReadInputRegisters { .. } => 0x04,
            Self::WriteSingleCoil { .. } => 0x05,
            Self::WriteSingleRegister { .. } => 0x06,
            Self::WriteMultipleRegisters { .. } => 0x10,
            Self::Exception { function, .. } | Self::Other { function, .. } => *function,
        }
    }

    /// The bytes of the PDU.
    pub fn encode(&self) -> Result<Vec<u8>, PduError> {
        let mut pdu = Vec::new();
        pdu.push(self.function());
        match self {
            Self::ReadHoldingRegisters { values } | Self::ReadInputRegisters { values } => {
                let quantity = u16::try_from(values.len()).unwrap_or(u16::MAX);
                check_quantity(quantity, MAX_READ_QUANTITY)?;
                // At most 250.
                pdu.push(u8::try_from(quantity * 2).unwrap_or(u8::MAX));
                push_words(&mut pdu, values);
            }
            Self::WriteSingleCoil { address, on } => push_words(&mut pdu, &[*address, coil_value(*on)]),
            Self::WriteSingleRegister { address, value } => push_words(&mut pdu, &[*address, *value]),
            Self::WriteMultipleRegisters { address, quantity } => {
                check_quantity(*quantity, MAX_WRITE_QUANTITY)?;
                push_words(&mut pdu, &[*address, *quantity]);
            }
            Self::Exception { function, code } => {
                pdu[0] = function | EXCEPTION;
                pdu.push(code.code());
            }
            Self::Other { data, .. } => pdu.extend_from_slice(data),
        }
        check_length(pdu)
    }

    /// Reads a response PDU.
    pub fn decode(pdu: &[u8]) -> Result<Self, PduError> {
        let (&function, data) = split(pdu)?;
        match function {
            0x03 | 0x04 => {
                let Some((&count, values)) = data.split_first() else {
                    return Err(PduError::Length { found: pdu.len(), expected: 4 });
                };
                if usize::from(count) != values.len() || count % 2 != 0 {
                    return Err(PduError::ByteCount { found: count, expected: values.len() });
                }
                check_quantity(u16::from(count / 2), MAX_READ_QUANTITY)?;
                let values = words(values);
                Ok(if function == 0x03 {
                    Self::ReadHoldingRegisters { values }
                } else {
                    Self::ReadInputRegisters { values }
                })
            }
            0x05 => {
                let [address, value] = two_words(data)?;
                Ok(Self::WriteSingleCoil { address, on: coil_is_on(value)? })
            }
            0x06 => {
                let [address, value] = two_words(data)?;
                Ok(Self::WriteSingleRegister { address, value })
            }
            0x10 => {
                let [address, quantity] = two_words(data)?;
                check_quantity(quantity, MAX_WRITE_QUANTITY)?;
                Ok(Self::WriteMultipleRegisters { address, quantity })
            }
            0x80.. => match data {
                [code] => Ok(Self::Exception { function: function & !EXCEPTION, code: (*code).into() }),
                _ => Err(PduError::Length { found: pdu.len(), expected: 2 }),
            },
            function => Ok(Self::Other { function, data: data.to_vec() }),
        }
    }
}

fn split(pdu: &[u8]) -> Result<(&u8, &[u8]), PduError> {
    if pdu.len() > MAX_PDU_LEN {
        return Err(PduError::TooLong);
    }
    pdu.split_first().ok_or(PduError::Empty)
}

fn check_length(pdu: Vec<u8>) -> Result<Vec<u8>, PduError> {
    if pdu.len() > MAX_PDU_LEN { Err(PduError::TooLong) } else { Ok(pdu) }
}

fn check_quantity(found: u16, limit: u16) -> Result<(), PduError> {
    if (1..=limit).contains(&found) { Ok(()) } else { Err(PduError::Quantity { found, limit }) }
}

fn coil_value(on: bool) -> u16 {
    if on { COIL_ON } else { COIL_OFF }
}

fn coil_is_on(found: u16) -> Result<bool, PduError> {
    match found {
        COIL_ON => Ok(true),
        COIL_OFF => Ok(false),
        found => Err(PduError::CoilValue { found }),
    }
}

/// The four bytes after most function codes.
fn two_words(data: &[u8]) -> Result<[u16; 2], PduError> {
    match data {
        &[a, b, c, d] => Ok([u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d])]),
        _ => Err(PduError::Length { found: data.len() + 1, expected: 5 }),
    }
}

fn words(bytes: &[u8]) -> Vec<u16> {
    bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect()
}

fn push_words(pdu: &mut Vec<u8>, words: &[u16]) {
    pdu.extend(words.iter().flat_map(|word| word.to_be_bytes()));
}
