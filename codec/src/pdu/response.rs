use alloc::vec::Vec;

use super::request::{decode_diagnostics, push_diagnostics};
use super::wire::{
    check_count, check_length, check_quantity, coil_is_on, coil_value, counted, counted_words, exactly, push_counted,
    push_words, quantity_of, split, two_words, word_bytes, words,
};
use super::{
    DeviceIdCode, DeviceIdObject, EXCEPTION, ExceptionCode, FileRecord, MAX_EVENTS, MAX_FIFO_COUNT, MAX_READ_BITS,
    MAX_READ_QUANTITY, MAX_WRITE_COILS, MAX_WRITE_QUANTITY, MEI_READ_DEVICE_ID, PduError, SubFunction, record,
};

const MORE_FOLLOWS: u8 = 0xFF;

/// What a device answers. Numbers of functions are hexadecimal.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Response {
    /// Function 01. Only the request tells how many of the bits are coils: see [`super::unpack_bits`].
    ReadCoils {
        /// 1 to 250 bytes, eight coils a byte, the first in the lowest bit.
        status: Vec<u8>,
    },
    /// Function 02. Only the request tells how many of the bits are inputs: see [`super::unpack_bits`].
    ReadDiscreteInputs {
        /// 1 to 250 bytes, eight inputs a byte, the first in the lowest bit.
        status: Vec<u8>,
    },
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
    /// Function 07.
    ReadExceptionStatus {
        /// Eight bits whose meaning the device's maker tells.
        status: u8,
    },
    /// Function 08.
    Diagnostics {
        /// Which one.
        sub_function: SubFunction,
        /// Two bytes; any number for [`SubFunction::RETURN_QUERY_DATA`] and for reserved codes.
        data: Vec<u8>,
    },
    /// Function 0B.
    GetCommEventCounter {
        /// FFFF while the device is busy with a command before, else 0000.
        status: u16,
        /// Messages that were carried out.
        event_count: u16,
    },
    /// Function 0C.
    GetCommEventLog {
        /// FFFF while the device is busy with a command before, else 0000.
        status: u16,
        /// Messages that were carried out.
        event_count: u16,
        /// Messages seen on the bus.
        message_count: u16,
        /// At most 64, the newest first.
        events: Vec<u8>,
    },
    /// Function 0F (15 decimal).
    WriteMultipleCoils {
        /// First coil.
        address: u16,
        /// Coils written, 1 to 1968.
        quantity: u16,
    },
    /// Function 10 (16 decimal).
    WriteMultipleRegisters {
        /// First register.
        address: u16,
        /// Registers written, 1 to 123.
        quantity: u16,
    },
    /// Function 11 (17 decimal).
    ReportServerId {
        /// The device's id, then FF if it runs or 00, then what its maker adds. Only its maker tells how long the id is.
        data: Vec<u8>,
    },
    /// Function 14 (20 decimal).
    ReadFileRecord {
        /// The registers of each range asked for, at least 1 of at least 1.
        records: Vec<Vec<u16>>,
    },
    /// Function 15 (21 decimal): the request again.
    WriteFileRecord {
        /// At least 1.
        records: Vec<FileRecord>,
    },
    /// Function 16 (22 decimal): the request again.
    MaskWriteRegister {
        /// The register.
        address: u16,
        /// Bits that stay.
        and_mask: u16,
        /// Values of the bits that do not.
        or_mask: u16,
    },
    /// Function 17 (23 decimal).
    ReadWriteMultipleRegisters {
        /// 1 to 125 values.
        values: Vec<u16>,
    },
    /// Function 18 (24 decimal).
    ReadFifoQueue {
        /// At most 31 values, in the queue's order.
        values: Vec<u16>,
    },
    /// Function 2B (43 decimal), MEI type 0E.
    ReadDeviceIdentification {
        /// As asked for.
        code: DeviceIdCode,
        /// The highest code that the device knows, with the top bit set if it answers single objects too.
        conformity: u8,
        /// Whether there are more objects than fit this reply.
        more_follows: bool,
        /// Where to go on if there are, else 0.
        next_object: u8,
        /// The objects.
        objects: Vec<DeviceIdObject>,
    },
    /// An exception: the function code with its top bit set.
    Exception {
        /// The function code that is refused, without the top bit.
        function: u8,
        /// Why.
        code: ExceptionCode,
    },
    /// Any other function code, and any other MEI type of function 2B, raw.
    Other {
        /// The function code.
        function: u8,
        /// Everything after it.
        data: Vec<u8>,
    },
}

impl Response {
    /// The function code, without the exception's top bit.
    pub fn function(&self) -> u8 {
        match self {
            Self::ReadCoils { .. } => 0x01,
            Self::ReadDiscreteInputs { .. } => 0x02,
            Self::ReadHoldingRegisters { .. } => 0x03,
            Self::ReadInputRegisters { .. } => 0x04,
            Self::WriteSingleCoil { .. } => 0x05,
            Self::WriteSingleRegister { .. } => 0x06,
            Self::ReadExceptionStatus { .. } => 0x07,
            Self::Diagnostics { .. } => 0x08,
            Self::GetCommEventCounter { .. } => 0x0B,
            Self::GetCommEventLog { .. } => 0x0C,
            Self::WriteMultipleCoils { .. } => 0x0F,
            Self::WriteMultipleRegisters { .. } => 0x10,
            Self::ReportServerId { .. } => 0x11,
            Self::ReadFileRecord { .. } => 0x14,
            Self::WriteFileRecord { .. } => 0x15,
            Self::MaskWriteRegister { .. } => 0x16,
            Self::ReadWriteMultipleRegisters { .. } => 0x17,
            Self::ReadFifoQueue { .. } => 0x18,
            Self::ReadDeviceIdentification { .. } => 0x2B,
            Self::Exception { function, .. } | Self::Other { function, .. } => *function,
        }
    }

    /// The bytes of the PDU, 1 to 253. Cannot fail for what [`Response::decode`] returned.
    pub fn encode(&self) -> Result<Vec<u8>, PduError> {
        let function = self.function();
        if function & EXCEPTION != 0 {
            return Err(PduError::FunctionCode { found: function });
        }
        let mut pdu = Vec::new();
        pdu.push(if matches!(self, Self::Exception { .. }) { function | EXCEPTION } else { function });
        match self {
            Self::ReadCoils { status } | Self::ReadDiscreteInputs { status } => {
                check_quantity(quantity_of(status).saturating_mul(8), MAX_READ_BITS)?;
                push_counted(&mut pdu, status)?;
            }
            Self::ReadHoldingRegisters { values }
            | Self::ReadInputRegisters { values }
            | Self::ReadWriteMultipleRegisters { values } => {
                check_quantity(quantity_of(values), MAX_READ_QUANTITY)?;
                push_counted(&mut pdu, &word_bytes(values))?;
            }
            Self::WriteSingleCoil { address, on } => push_words(&mut pdu, &[*address, coil_value(*on)]),
            Self::WriteSingleRegister { address, value } => push_words(&mut pdu, &[*address, *value]),
            Self::ReadExceptionStatus { status } => pdu.push(*status),
            Self::Diagnostics { sub_function, data } => push_diagnostics(&mut pdu, *sub_function, data)?,
            Self::GetCommEventCounter { status, event_count } => push_words(&mut pdu, &[*status, *event_count]),
            Self::GetCommEventLog { status, event_count, message_count, events } => {
                check_count(quantity_of(events), MAX_EVENTS)?;
                let mut log = word_bytes(&[*status, *event_count, *message_count]);
                log.extend_from_slice(events);
                push_counted(&mut pdu, &log)?;
            }
            Self::WriteMultipleCoils { address, quantity } => {
                check_quantity(*quantity, MAX_WRITE_COILS)?;
                push_words(&mut pdu, &[*address, *quantity]);
            }
            Self::WriteMultipleRegisters { address, quantity } => {
                check_quantity(*quantity, MAX_WRITE_QUANTITY)?;
                push_words(&mut pdu, &[*address, *quantity]);
            }
            Self::ReportServerId { data } => push_counted(&mut pdu, data)?,
            Self::ReadFileRecord { records } => push_counted(&mut pdu, &record::encode_contents(records)?)?,
            Self::WriteFileRecord { records } => push_counted(&mut pdu, &record::encode_records(records)?)?,
            Self::MaskWriteRegister { address, and_mask, or_mask } => {
                push_words(&mut pdu, &[*address, *and_mask, *or_mask]);
            }
            Self::ReadFifoQueue { values } => {
                let count = quantity_of(values);
                check_count(count, MAX_FIFO_COUNT)?;
                push_words(&mut pdu, &[2 + 2 * count, count]);
                push_words(&mut pdu, values);
            }
            Self::ReadDeviceIdentification { code, conformity, more_follows, next_object, objects } => {
                let more_follows = if *more_follows { MORE_FOLLOWS } else { 0 };
                let count = u8::try_from(objects.len()).map_err(|_| PduError::TooLong)?;
                pdu.extend_from_slice(&[MEI_READ_DEVICE_ID, code.code(), *conformity, more_follows]);
                pdu.extend_from_slice(&[*next_object, count]);
                pdu.extend_from_slice(&record::encode_objects(objects)?);
            }
            Self::Exception { code, .. } => pdu.push(code.code()),
            Self::Other { data, .. } => pdu.extend_from_slice(data),
        }
        check_length(pdu)
    }

    /// Reads a response PDU.
    pub fn decode(pdu: &[u8]) -> Result<Self, PduError> {
        let (function, data) = split(pdu)?;
        match function {
            0x01 => Ok(Self::ReadCoils { status: decode_bits(data)? }),
            0x02 => Ok(Self::ReadDiscreteInputs { status: decode_bits(data)? }),
            0x03 => Ok(Self::ReadHoldingRegisters { values: counted_words(data, MAX_READ_QUANTITY)? }),
            0x04 => Ok(Self::ReadInputRegisters { values: counted_words(data, MAX_READ_QUANTITY)? }),
            0x05 => {
                let [address, value] = two_words(data)?;
                Ok(Self::WriteSingleCoil { address, on: coil_is_on(value)? })
            }
            0x06 => {
                let [address, value] = two_words(data)?;
                Ok(Self::WriteSingleRegister { address, value })
            }
            0x07 => exactly(data).map(|[status]| Self::ReadExceptionStatus { status }),
            0x08 => decode_diagnostics(data).map(|(sub_function, data)| Self::Diagnostics { sub_function, data }),
            0x0B => two_words(data).map(|[status, event_count]| Self::GetCommEventCounter { status, event_count }),
            0x0C => decode_event_log(data),
            0x0F => {
                let [address, quantity] = two_words(data)?;
                check_quantity(quantity, MAX_WRITE_COILS)?;
                Ok(Self::WriteMultipleCoils { address, quantity })
            }
            0x10 => {
                let [address, quantity] = two_words(data)?;
                check_quantity(quantity, MAX_WRITE_QUANTITY)?;
                Ok(Self::WriteMultipleRegisters { address, quantity })
            }
            0x11 => Ok(Self::ReportServerId { data: counted(data)?.to_vec() }),
            0x14 => Ok(Self::ReadFileRecord { records: record::decode_contents(counted(data)?)? }),
            0x15 => Ok(Self::WriteFileRecord { records: record::decode_records(counted(data)?)? }),
            0x16 => exactly(data).map(|[a1, a0, b1, b0, c1, c0]| Self::MaskWriteRegister {
                address: u16::from_be_bytes([a1, a0]),
                and_mask: u16::from_be_bytes([b1, b0]),
                or_mask: u16::from_be_bytes([c1, c0]),
            }),
            0x17 => Ok(Self::ReadWriteMultipleRegisters { values: counted_words(data, MAX_READ_QUANTITY)? }),
            0x18 => decode_fifo(data),
            0x2B => match data {
                [] => Err(PduError::Length { found: 1, expected: 2 }),
                [MEI_READ_DEVICE_ID, ..] => decode_device_id(data),
                _ => Ok(Self::Other { function, data: data.to_vec() }),
            },
            EXCEPTION.. => exactly(data)
                .map(|[code]| Self::Exception { function: function & !EXCEPTION, code: ExceptionCode::from(code) }),
            function => Ok(Self::Other { function, data: data.to_vec() }),
        }
    }
}

fn decode_bits(data: &[u8]) -> Result<Vec<u8>, PduError> {
    let status = counted(data)?;
    check_quantity(quantity_of(status).saturating_mul(8), MAX_READ_BITS)?;
    Ok(status.to_vec())
}

fn decode_event_log(data: &[u8]) -> Result<Response, PduError> {
    let bytes = counted(data)?;
    let Some((&[s1, s0, e1, e0, m1, m0], events)) = bytes.split_first_chunk() else {
        return Err(PduError::Length { found: 1 + data.len(), expected: 8 });
    };
    check_count(quantity_of(events), MAX_EVENTS)?;
    Ok(Response::GetCommEventLog {
        status: u16::from_be_bytes([s1, s0]),
        event_count: u16::from_be_bytes([e1, e0]),
        message_count: u16::from_be_bytes([m1, m0]),
        events: events.to_vec(),
    })
}

fn decode_fifo(data: &[u8]) -> Result<Response, PduError> {
    let Some((byte_count, rest)) = data.split_first_chunk() else {
        return Err(PduError::Length { found: 1 + data.len(), expected: 5 });
    };
    let found = u16::from_be_bytes(*byte_count);
    if usize::from(found) != rest.len() {
        return Err(PduError::FifoByteCount { found, expected: rest.len() });
    }
    let Some((count, values)) = rest.split_first_chunk() else {
        return Err(PduError::Length { found: 1 + data.len(), expected: 5 });
    };
    let count = u16::from_be_bytes(*count);
    check_count(count, MAX_FIFO_COUNT)?;
    if 2 * usize::from(count) != values.len() {
        return Err(PduError::Length { found: 1 + data.len(), expected: 5 + 2 * usize::from(count) });
    }
    Ok(Response::ReadFifoQueue { values: words(values) })
}

fn decode_device_id(data: &[u8]) -> Result<Response, PduError> {
    let Some((&[_, code, conformity, more_follows, next_object, count], objects)) = data.split_first_chunk() else {
        return Err(PduError::Length { found: 1 + data.len(), expected: 7 });
    };
    Ok(Response::ReadDeviceIdentification {
        code: code.try_into()?,
        conformity,
        more_follows: match more_follows {
            MORE_FOLLOWS => true,
            0 => false,
            found => return Err(PduError::MoreFollows { found }),
        },
        next_object,
        objects: record::decode_objects(objects, 7, count)?,
    })
}
