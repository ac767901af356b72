use alloc::vec::Vec;

use super::wire::{
    bit_bytes, check_length, check_quantity, coil_is_on, coil_value, counted, exactly, push_counted,
    push_quantity_and_bytes, push_words, quantity_and_bytes, quantity_of, register_bytes, split, two_words, word_bytes,
    words,
};
use super::{
    DeviceIdCode, DeviceIdObject, FileRecord, FileRecordRange, MAX_READ_BITS, MAX_READ_QUANTITY,
    MAX_READ_WRITE_QUANTITY, MAX_WRITE_COILS, MAX_WRITE_QUANTITY, MEI_READ_DEVICE_ID, PduError, Response, SubFunction,
    pack_bits, record, unpack_bits,
};

/// What a master asks. Numbers of functions are hexadecimal.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Request {
    /// Function 01.
    ReadCoils {
        /// First coil.
        address: u16,
        /// 1 to 2000.
        quantity: u16,
    },
    /// Function 02.
    ReadDiscreteInputs {
        /// First input.
        address: u16,
        /// 1 to 2000.
        quantity: u16,
    },
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
    /// Function 07.
    ReadExceptionStatus,
    /// Function 08.
    Diagnostics {
        /// Which one.
        sub_function: SubFunction,
        /// Two bytes; any number for [`SubFunction::RETURN_QUERY_DATA`] and for reserved codes.
        data: Vec<u8>,
    },
    /// Function 0B.
    GetCommEventCounter,
    /// Function 0C.
    GetCommEventLog,
    /// Function 0F (15 decimal).
    WriteMultipleCoils {
        /// First coil.
        address: u16,
        /// 1 to 1968 new states.
        coils: Vec<bool>,
    },
    /// Function 10 (16 decimal).
    WriteMultipleRegisters {
        /// First register.
        address: u16,
        /// 1 to 123 new values.
        values: Vec<u16>,
    },
    /// Function 11 (17 decimal).
    ReportServerId,
    /// Function 14 (20 decimal).
    ReadFileRecord {
        /// 1 to 35; together no more than one reply holds.
        records: Vec<FileRecordRange>,
    },
    /// Function 15 (21 decimal).
    WriteFileRecord {
        /// At least 1; together no more than one request holds.
        records: Vec<FileRecord>,
    },
    /// Function 16 (22 decimal): the register becomes (itself AND `and_mask`) OR (`or_mask` AND NOT `and_mask`).
    MaskWriteRegister {
        /// The register.
        address: u16,
        /// Bits that stay.
        and_mask: u16,
        /// Values of the bits that do not.
        or_mask: u16,
    },
    /// Function 17 (23 decimal): writes first, then reads.
    ReadWriteMultipleRegisters {
        /// First register to read.
        read_address: u16,
        /// 1 to 125 registers to read.
        read_quantity: u16,
        /// First register to write.
        write_address: u16,
        /// 1 to 121 new values.
        values: Vec<u16>,
    },
    /// Function 18 (24 decimal).
    ReadFifoQueue {
        /// The register that holds the queue's count.
        address: u16,
    },
    /// Function 2B (43 decimal), MEI type 0E.
    ReadDeviceIdentification {
        /// What is asked for.
        code: DeviceIdCode,
        /// The first object of a stream, or the one object.
        object: u8,
    },
    /// Any other function code, and any other MEI type of function 2B, raw.
    Other {
        /// The function code.
        function: u8,
        /// Everything after it.
        data: Vec<u8>,
    },
}

impl Request {
    /// The function code.
    pub fn function(&self) -> u8 {
        match self {
            Self::ReadCoils { .. } => 0x01,
            Self::ReadDiscreteInputs { .. } => 0x02,
            Self::ReadHoldingRegisters { .. } => 0x03,
            Self::ReadInputRegisters { .. } => 0x04,
            Self::WriteSingleCoil { .. } => 0x05,
            Self::WriteSingleRegister { .. } => 0x06,
            Self::ReadExceptionStatus => 0x07,
            Self::Diagnostics { .. } => 0x08,
            Self::GetCommEventCounter => 0x0B,
            Self::GetCommEventLog => 0x0C,
            Self::WriteMultipleCoils { .. } => 0x0F,
            Self::WriteMultipleRegisters { .. } => 0x10,
            Self::ReportServerId => 0x11,
            Self::ReadFileRecord { .. } => 0x14,
            Self::WriteFileRecord { .. } => 0x15,
            Self::MaskWriteRegister { .. } => 0x16,
            Self::ReadWriteMultipleRegisters { .. } => 0x17,
            Self::ReadFifoQueue { .. } => 0x18,
            Self::ReadDeviceIdentification { .. } => 0x2B,
            Self::Other { function, .. } => *function,
        }
    }

    /// Whether it may change something in the device. Unknown functions may, and so may the diagnostics that clear
    /// counters, restart or silence the device.
    pub fn is_write(&self) -> bool {
        match self {
            Self::ReadCoils { .. }
            | Self::ReadDiscreteInputs { .. }
            | Self::ReadHoldingRegisters { .. }
            | Self::ReadInputRegisters { .. }
            | Self::ReadExceptionStatus
            | Self::GetCommEventCounter
            | Self::GetCommEventLog
            | Self::ReportServerId
            | Self::ReadFileRecord { .. }
            | Self::ReadFifoQueue { .. }
            | Self::ReadDeviceIdentification { .. } => false,
            Self::Diagnostics { sub_function, .. } => !sub_function.only_reads(),
            Self::WriteSingleCoil { .. }
            | Self::WriteSingleRegister { .. }
            | Self::WriteMultipleCoils { .. }
            | Self::WriteMultipleRegisters { .. }
            | Self::WriteFileRecord { .. }
            | Self::MaskWriteRegister { .. }
            | Self::ReadWriteMultipleRegisters { .. }
            | Self::Other { .. } => true,
        }
    }

    /// The first coil, input or register that it is about; of function 17 the first that it reads.
    pub fn address(&self) -> Option<u16> {
        match self {
            Self::ReadCoils { address, .. }
            | Self::ReadDiscreteInputs { address, .. }
            | Self::ReadHoldingRegisters { address, .. }
            | Self::ReadInputRegisters { address, .. }
            | Self::WriteSingleCoil { address, .. }
            | Self::WriteSingleRegister { address, .. }
            | Self::WriteMultipleCoils { address, .. }
            | Self::WriteMultipleRegisters { address, .. }
            | Self::MaskWriteRegister { address, .. }
            | Self::ReadWriteMultipleRegisters { read_address: address, .. }
            | Self::ReadFifoQueue { address } => Some(*address),
            _ => None,
        }
    }

    /// How many coils, inputs or registers from [`Request::address`] on, where the request says it in a field.
    pub fn quantity(&self) -> Option<u16> {
        match self {
            Self::ReadCoils { quantity, .. }
            | Self::ReadDiscreteInputs { quantity, .. }
            | Self::ReadHoldingRegisters { quantity, .. }
            | Self::ReadInputRegisters { quantity, .. }
            | Self::ReadWriteMultipleRegisters { read_quantity: quantity, .. } => Some(*quantity),
            Self::WriteMultipleCoils { coils, .. } => Some(quantity_of(coils)),
            Self::WriteMultipleRegisters { values, .. } => Some(quantity_of(values)),
            _ => None,
        }
    }

    /// The bytes of the PDU, 1 to 253. Cannot fail for what [`Request::decode`] returned.
    pub fn encode(&self) -> Result<Vec<u8>, PduError> {
        let mut pdu = Vec::new();
        pdu.push(self.function());
        match self {
            Self::ReadCoils { address, quantity } | Self::ReadDiscreteInputs { address, quantity } => {
                check_quantity(*quantity, MAX_READ_BITS)?;
                push_words(&mut pdu, &[*address, *quantity]);
            }
            Self::ReadHoldingRegisters { address, quantity } | Self::ReadInputRegisters { address, quantity } => {
                check_quantity(*quantity, MAX_READ_QUANTITY)?;
                push_words(&mut pdu, &[*address, *quantity]);
            }
            Self::WriteSingleCoil { address, on } => push_words(&mut pdu, &[*address, coil_value(*on)]),
            Self::WriteSingleRegister { address, value } => push_words(&mut pdu, &[*address, *value]),
            Self::ReadExceptionStatus | Self::GetCommEventCounter | Self::GetCommEventLog | Self::ReportServerId => {}
            Self::Diagnostics { sub_function, data } => push_diagnostics(&mut pdu, *sub_function, data)?,
            Self::WriteMultipleCoils { address, coils } => {
                let quantity = quantity_of(coils);
                check_quantity(quantity, MAX_WRITE_COILS)?;
                push_words(&mut pdu, &[*address]);
                push_quantity_and_bytes(&mut pdu, quantity, &pack_bits(coils))?;
            }
            Self::WriteMultipleRegisters { address, values } => {
                let quantity = quantity_of(values);
                check_quantity(quantity, MAX_WRITE_QUANTITY)?;
                push_words(&mut pdu, &[*address]);
                push_quantity_and_bytes(&mut pdu, quantity, &word_bytes(values))?;
            }
            Self::ReadFileRecord { records } => push_counted(&mut pdu, &record::encode_ranges(records)?)?,
            Self::WriteFileRecord { records } => push_counted(&mut pdu, &record::encode_records(records)?)?,
            Self::MaskWriteRegister { address, and_mask, or_mask } => {
                push_words(&mut pdu, &[*address, *and_mask, *or_mask]);
            }
            Self::ReadWriteMultipleRegisters { read_address, read_quantity, write_address, values } => {
                check_quantity(*read_quantity, MAX_READ_QUANTITY)?;
                let quantity = quantity_of(values);
                check_quantity(quantity, MAX_READ_WRITE_QUANTITY)?;
                push_words(&mut pdu, &[*read_address, *read_quantity, *write_address]);
                push_quantity_and_bytes(&mut pdu, quantity, &word_bytes(values))?;
            }
            Self::ReadFifoQueue { address } => push_words(&mut pdu, &[*address]),
            Self::ReadDeviceIdentification { code, object } => {
                pdu.extend_from_slice(&[MEI_READ_DEVICE_ID, code.code(), *object]);
            }
            Self::Other { data, .. } => pdu.extend_from_slice(data),
        }
        check_length(pdu)
    }

    /// Reads a request PDU.
    pub fn decode(pdu: &[u8]) -> Result<Self, PduError> {
        let (function, data) = split(pdu)?;
        match function {
            0x01..=0x04 => decode_read(function, data),
            0x05 => {
                let [address, value] = two_words(data)?;
                Ok(Self::WriteSingleCoil { address, on: coil_is_on(value)? })
            }
            0x06 => {
                let [address, value] = two_words(data)?;
                Ok(Self::WriteSingleRegister { address, value })
            }
            0x07 => exactly(data).map(|[]| Self::ReadExceptionStatus),
            0x08 => decode_diagnostics(data).map(|(sub_function, data)| Self::Diagnostics { sub_function, data }),
            0x0B => exactly(data).map(|[]| Self::GetCommEventCounter),
            0x0C => exactly(data).map(|[]| Self::GetCommEventLog),
            0x0F => decode_write_coils(data),
            0x10 => decode_write_registers(data),
            0x11 => exactly(data).map(|[]| Self::ReportServerId),
            0x14 => Ok(Self::ReadFileRecord { records: record::decode_ranges(counted(data)?)? }),
            0x15 => Ok(Self::WriteFileRecord { records: record::decode_records(counted(data)?)? }),
            0x16 => exactly(data).map(|[a1, a0, b1, b0, c1, c0]| Self::MaskWriteRegister {
                address: u16::from_be_bytes([a1, a0]),
                and_mask: u16::from_be_bytes([b1, b0]),
                or_mask: u16::from_be_bytes([c1, c0]),
            }),
            0x17 => decode_read_write(data),
            0x18 => exactly(data).map(|address| Self::ReadFifoQueue { address: u16::from_be_bytes(address) }),
            0x2B => match data {
                [] => Err(PduError::Length { found: 1, expected: 2 }),
                [MEI_READ_DEVICE_ID, ..] => {
                    let [_, code, object] = exactly(data)?;
                    Ok(Self::ReadDeviceIdentification { code: code.try_into()?, object })
                }
                _ => Ok(Self::Other { function, data: data.to_vec() }),
            },
            function => Ok(Self::Other { function, data: data.to_vec() }),
        }
    }

    /// Length of the normal reply's PDU, 2 to 253 for a request that encodes. `None` where only the reply itself tells it,
    /// and for [`SubFunction::FORCE_LISTEN_ONLY`], which has no reply.
    pub fn response_pdu_len(&self) -> Option<usize> {
        match self {
            Self::ReadCoils { quantity, .. } | Self::ReadDiscreteInputs { quantity, .. } => {
                Some(2 + bit_bytes(*quantity))
            }
            Self::ReadHoldingRegisters { quantity, .. }
            | Self::ReadInputRegisters { quantity, .. }
            | Self::ReadWriteMultipleRegisters { read_quantity: quantity, .. } => Some(2 + register_bytes(*quantity)),
            Self::WriteSingleCoil { .. }
            | Self::WriteSingleRegister { .. }
            | Self::GetCommEventCounter
            | Self::WriteMultipleCoils { .. }
            | Self::WriteMultipleRegisters { .. } => Some(5),
            Self::ReadExceptionStatus => Some(2),
            Self::Diagnostics { sub_function, data } => {
                // Be it the echo or a counter, there is as much data as in the request.
                let answered = sub_function.is_known() && *sub_function != SubFunction::FORCE_LISTEN_ONLY;
                answered.then(|| data.len().saturating_add(3))
            }
            Self::ReadFileRecord { records } => Some(record::reply_len(records)),
            Self::WriteFileRecord { records } => Some(record::echo_len(records)),
            Self::MaskWriteRegister { .. } => Some(7),
            Self::GetCommEventLog
            | Self::ReportServerId
            | Self::ReadFifoQueue { .. }
            | Self::ReadDeviceIdentification { .. }
            | Self::Other { .. } => None,
        }
    }

    /// Whether `response` can answer this: the function, the byte count and the echoed fields fit, or it refuses this
    /// function.
    pub fn accepts(&self, response: &Response) -> bool {
        match (self, response) {
            (_, Response::Exception { function, .. }) => *function == self.function(),
            (Self::ReadCoils { quantity, .. }, Response::ReadCoils { status })
            | (Self::ReadDiscreteInputs { quantity, .. }, Response::ReadDiscreteInputs { status }) => {
                status.len() == bit_bytes(*quantity)
            }
            (Self::ReadHoldingRegisters { quantity, .. }, Response::ReadHoldingRegisters { values })
            | (Self::ReadInputRegisters { quantity, .. }, Response::ReadInputRegisters { values })
            | (
                Self::ReadWriteMultipleRegisters { read_quantity: quantity, .. },
                Response::ReadWriteMultipleRegisters { values },
            ) => values.len() == usize::from(*quantity),
            (Self::WriteSingleCoil { address, on }, Response::WriteSingleCoil { address: a, on: o }) => {
                (address, on) == (a, o)
            }
            (Self::WriteSingleRegister { address, value }, Response::WriteSingleRegister { address: a, value: v }) => {
                (address, value) == (a, v)
            }
            (Self::Diagnostics { sub_function, data }, Response::Diagnostics { sub_function: s, data: d }) => {
                let silent = *sub_function == SubFunction::FORCE_LISTEN_ONLY;
                sub_function == s && !silent && (data == d || !sub_function.is_echoed())
            }
            (Self::WriteMultipleCoils { address, coils }, Response::WriteMultipleCoils { address: a, quantity }) => {
                address == a && coils.len() == usize::from(*quantity)
            }
            (
                Self::WriteMultipleRegisters { address, values },
                Response::WriteMultipleRegisters { address: a, quantity },
            ) => address == a && values.len() == usize::from(*quantity),
            (Self::ReadFileRecord { records }, Response::ReadFileRecord { records: found }) => {
                let wanted = records.iter().map(|range| usize::from(range.record_length));
                wanted.eq(found.iter().map(Vec::len))
            }
            (Self::WriteFileRecord { records }, Response::WriteFileRecord { records: found }) => records == found,
            (
                Self::MaskWriteRegister { address, and_mask, or_mask },
                Response::MaskWriteRegister { address: a, and_mask: and, or_mask: or },
            ) => (address, and_mask, or_mask) == (a, and, or),
            (
                Self::ReadDeviceIdentification { code, object },
                Response::ReadDeviceIdentification { code: answered, objects, .. },
            ) => {
                // A stream that is asked for an unknown object starts again from the first (clause 6.21).
                let one = *code != DeviceIdCode::Specific
                    || matches!(objects.as_slice(), [DeviceIdObject { id, .. }] if id == object);
                code == answered && one
            }
            (Self::ReadExceptionStatus, Response::ReadExceptionStatus { .. })
            | (Self::GetCommEventCounter, Response::GetCommEventCounter { .. })
            | (Self::GetCommEventLog, Response::GetCommEventLog { .. })
            | (Self::ReportServerId, Response::ReportServerId { .. })
            | (Self::ReadFifoQueue { .. }, Response::ReadFifoQueue { .. }) => true,
            // Within function 2B the MEI type must be the same.
            (Self::Other { function: 0x2B, data }, Response::Other { function: 0x2B, data: answered }) => {
                data.first() == answered.first()
            }
            (Self::Other { function: 0x2B, data }, Response::ReadDeviceIdentification { .. }) => {
                data.first() == Some(&MEI_READ_DEVICE_ID)
            }
            (Self::Other { function, .. }, response) => *function == response.function(),
            _ => false,
        }
    }
}

fn decode_read(function: u8, data: &[u8]) -> Result<Request, PduError> {
    let [address, quantity] = two_words(data)?;
    check_quantity(quantity, if function < 0x03 { MAX_READ_BITS } else { MAX_READ_QUANTITY })?;
    Ok(match function {
        0x01 => Request::ReadCoils { address, quantity },
        0x02 => Request::ReadDiscreteInputs { address, quantity },
        0x03 => Request::ReadHoldingRegisters { address, quantity },
        _ => Request::ReadInputRegisters { address, quantity },
    })
}

fn decode_write_coils(data: &[u8]) -> Result<Request, PduError> {
    let Some((address, rest)) = data.split_first_chunk() else {
        return Err(PduError::Length { found: 1 + data.len(), expected: 7 });
    };
    let (quantity, bytes) = quantity_and_bytes(rest, 3, MAX_WRITE_COILS, bit_bytes)?;
    if let Some(last) = bytes.last().copied()
        && !quantity.is_multiple_of(8)
        && last >> (quantity % 8) != 0
    {
        return Err(PduError::Padding { found: last });
    }
    Ok(Request::WriteMultipleCoils {
        address: u16::from_be_bytes(*address),
        coils: unpack_bits(bytes, usize::from(quantity)),
    })
}

fn decode_write_registers(data: &[u8]) -> Result<Request, PduError> {
    let Some((address, rest)) = data.split_first_chunk() else {
        return Err(PduError::Length { found: 1 + data.len(), expected: 8 });
    };
    let (_, bytes) = quantity_and_bytes(rest, 3, MAX_WRITE_QUANTITY, register_bytes)?;
    Ok(Request::WriteMultipleRegisters { address: u16::from_be_bytes(*address), values: words(bytes) })
}

fn decode_read_write(data: &[u8]) -> Result<Request, PduError> {
    let Some((&[a1, a0, q1, q0, w1, w0], rest)) = data.split_first_chunk() else {
        return Err(PduError::Length { found: 1 + data.len(), expected: 12 });
    };
    let read_quantity = u16::from_be_bytes([q1, q0]);
    check_quantity(read_quantity, MAX_READ_QUANTITY)?;
    let (_, bytes) = quantity_and_bytes(rest, 7, MAX_READ_WRITE_QUANTITY, register_bytes)?;
    Ok(Request::ReadWriteMultipleRegisters {
        read_address: u16::from_be_bytes([a1, a0]),
        read_quantity,
        write_address: u16::from_be_bytes([w1, w0]),
        values: words(bytes),
    })
}

/// Sub-function and data of function 08, in both directions.
pub(super) fn decode_diagnostics(data: &[u8]) -> Result<(SubFunction, Vec<u8>), PduError> {
    let Some((code, data)) = data.split_first_chunk() else {
        return Err(PduError::Length { found: 1 + data.len(), expected: 5 });
    };
    let sub_function = SubFunction(u16::from_be_bytes(*code));
    check_diagnostics(sub_function, data)?;
    Ok((sub_function, data.to_vec()))
}

/// Undoes [`decode_diagnostics`].
pub(super) fn push_diagnostics(pdu: &mut Vec<u8>, sub_function: SubFunction, data: &[u8]) -> Result<(), PduError> {
    check_diagnostics(sub_function, data)?;
    push_words(pdu, &[sub_function.0]);
    pdu.extend_from_slice(data);
    Ok(())
}

fn check_diagnostics(sub_function: SubFunction, data: &[u8]) -> Result<(), PduError> {
    let free = sub_function == SubFunction::RETURN_QUERY_DATA || !sub_function.is_known();
    if free || data.len() == 2 {
        Ok(())
    } else {
        Err(PduError::Length { found: data.len().saturating_add(3), expected: 5 })
    }
}
