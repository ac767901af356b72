//! From a step to the bytes that carry it out.

use std::collections::VecDeque;

use buslens_codec::check::{crc16, lrc};
use buslens_codec::line::Mode;
use buslens_codec::pdu::Request;
use buslens_codec::profile::{Group, Point};
use buslens_codec::value::{Encoding, Value};
use buslens_codec::{UnitId, adu};

use super::memory::Memory;
use crate::meaning;
use crate::report::Reason;
use crate::script::{Asking, Byte, Check, Expression, Sending, Table, What};

/// A part of what a step sends.
#[derive(Clone, Debug)]
pub(super) enum Task {
    /// Bytes as they are.
    Raw(Vec<u8>),
    /// A read that must come first: of what scales a value, or of what a write must leave alone.
    Before(Group),
    /// What the step is about.
    Main(Request),
    /// The step's write, whose registers are known after what comes before.
    Write,
}

/// What a step has to send, in order.
pub(super) fn tasks(asking: &Asking, unit: UnitId, memory: &Memory) -> VecDeque<Task> {
    let scales = |points: &[&Point]| -> Vec<Task> {
        let Some(profile) = &memory.profile else { return Vec::new() };
        let known = memory.known(unit);
        let unscaled = points.iter().filter(|point| {
            let unit_open = point.unit_from.is_some() && profile.unit_of(point, &known).is_empty();
            let scale_open = point.decimals_from.is_some() && !is_scaled(memory, point, unit);
            unit_open || scale_open
        });
        let referred = unscaled.flat_map(|point| point.refers_to()).filter_map(|id| profile.point(id));
        profile.groups_of(referred).into_iter().map(Task::Before).collect()
    };
    let reads = |points: &[&Point]| -> VecDeque<Task> {
        let Some(profile) = &memory.profile else { return VecDeque::new() };
        let own = profile.groups_of(points.iter().copied());
        let before =
            scales(points).into_iter().filter(|task| !matches!(task, Task::Before(group) if own.contains(group)));
        let own_first = own.iter().filter_map(Group::request).map(Task::Main);
        before.chain(own_first).collect()
    };
    match &asking.what {
        What::ReadPoints(ids) => reads(&ids.iter().filter_map(|id| memory.point(id)).collect::<Vec<_>>()),
        What::ReadAll => {
            let all = memory.profile.as_ref().map(|profile| profile.points.iter().collect::<Vec<_>>());
            reads(&all.unwrap_or_default())
        }
        What::WritePoint { point, .. } | What::Command { point, .. } => {
            let Some(point) = memory.point(point) else { return [Task::Write].into() };
            let mut all: VecDeque<Task> = scales(&[point]).into();
            if shares_registers(point) {
                all.extend(point.read_group().map(Task::Before));
            }
            all.push_back(Task::Write);
            all
        }
        What::Read { table, address, count } => {
            let (address, quantity) = (*address, *count);
            [Task::Main(match table {
                Table::Holding => Request::ReadHoldingRegisters { address, quantity },
                Table::Input => Request::ReadInputRegisters { address, quantity },
                Table::Coils => Request::ReadCoils { address, quantity },
                Table::Discrete => Request::ReadDiscreteInputs { address, quantity },
            })]
            .into()
        }
        What::WriteCoil { address, on } => [Task::Main(Request::WriteSingleCoil { address: *address, on: *on })].into(),
        What::WriteCoils { address, coils } => {
            [Task::Main(Request::WriteMultipleCoils { address: *address, coils: coils.clone() })].into()
        }
        What::WriteRegister { .. } | What::WriteRegisters { .. } => [Task::Write].into(),
    }
}

/// Whether the registers hold something else as well, which a write must leave alone.
fn shares_registers(point: &Point) -> bool {
    matches!(point.encoding, Encoding::Bits { .. } | Encoding::ReservedI16 { .. }) && point.read_group().is_some()
}

fn is_scaled(memory: &Memory, point: &Point, unit: UnitId) -> bool {
    let zero = Value::Number(buslens_codec::value::Decimal::whole(0));
    memory.profile.as_ref().is_some_and(|profile| profile.encode_point(point, zero, &memory.known(unit)).is_ok())
}

/// The write of a step, now that all is known that can be.
pub(super) fn write_request(asking: &Asking, unit: UnitId, memory: &Memory) -> Result<Request, Reason> {
    let register = |address: u16, value: &Expression| {
        let datum = memory.evaluate(value)?;
        datum
            .register()
            .ok_or_else(|| Reason::NotAllowed { point: format!("0x{address:04X}"), value: datum.to_string() })
    };
    match &asking.what {
        What::WriteRegister { address, value } => {
            Ok(Request::WriteSingleRegister { address: *address, value: register(*address, value)? })
        }
        What::WriteRegisters { address, values } => {
            let values = values.iter().map(|value| register(*address, value)).collect::<Result<_, _>>()?;
            Ok(Request::WriteMultipleRegisters { address: *address, values })
        }
        What::WritePoint { point, value } | What::Command { point, value: Some(value) } => {
            let datum = memory.evaluate(value)?;
            let refused = || Reason::NotAllowed { point: point.clone(), value: datum.to_string() };
            let point = memory.point(point).ok_or_else(refused)?;
            if !datum.unit.is_empty() && datum.literal {
                let own = memory
                    .profile
                    .as_ref()
                    .map_or("", |profile| profile.unit_of(point, &memory.known(unit)))
                    .to_owned();
                if own != datum.unit {
                    return Err(Reason::OtherUnit { found: own, wanted: datum.unit });
                }
            }
            let value_to_write = datum.value_for(point).ok_or_else(refused)?;
            let deliberate = matches!(meaning::literal(&value.first), Some(meaning::Literal::Code(_)));
            if !deliberate && !point.allows(value_to_write) {
                return Err(refused());
            }
            point_request(point, value_to_write, unit, memory, refused)
        }
        What::Command { point, value: None } => {
            let refused = || Reason::NotAllowed { point: point.clone(), value: String::new() };
            let point = memory.point(point).ok_or_else(refused)?;
            let code = point.codes.first().ok_or_else(refused)?.code;
            point_request(point, Value::Code(code), unit, memory, refused)
        }
        What::ReadPoints(_) | What::ReadAll | What::Read { .. } | What::WriteCoil { .. } | What::WriteCoils { .. } => {
            Err(Reason::Withdrawn)
        }
    }
}

fn point_request(
    point: &Point,
    value: Value,
    unit: UnitId,
    memory: &Memory,
    refused: impl Fn() -> Reason,
) -> Result<Request, Reason> {
    let registers = if shares_registers(point) {
        let before = memory.registers_of(point).ok_or_else(|| Reason::NotReadBefore(point.id.clone()))?;
        point.encode_over(value, &before)
    } else {
        let profile = memory.profile.as_ref().ok_or_else(&refused)?;
        profile.encode_point(point, value, &memory.known(unit))
    };
    match registers {
        Ok(registers) => point.write_request(&registers).ok_or_else(refused),
        Err(buslens_codec::value::ValueError::NotScaled) => Err(Reason::NotScaled(point.id.clone())),
        Err(_) => Err(refused()),
    }
}

/// A request as it goes out, its check wrong on purpose if that is wanted.
pub(super) fn frame(mode: Mode, unit: UnitId, request: &Request, spoiled: bool) -> Option<Vec<u8>> {
    let mut frame = adu::encode(mode, unit, &request.encode().ok()?)?;
    if spoiled {
        match (mode, frame.as_mut_slice()) {
            (Mode::Rtu, [.., last]) => *last ^= 1,
            (Mode::Ascii, [.., digit, _, _]) => *digit = if *digit == b'0' { b'1' } else { b'0' },
            _ => {}
        }
    }
    Some(frame)
}

/// Bytes of a `send` as they go out.
pub(super) fn payload(sending: &Sending, unit: UnitId) -> Vec<u8> {
    let byte = |byte: &Byte| match byte {
        Byte::Is(byte) => *byte,
        Byte::Unit => unit.0,
    };
    let mut bytes: Vec<u8> = sending.bytes.iter().map(byte).collect();
    match sending.check {
        Check::None => {}
        Check::Crc => bytes.extend(crc16(&bytes).to_le_bytes()),
        Check::WrongCrc => bytes.extend((crc16(&bytes) ^ 0x0100).to_le_bytes()),
        Check::Lrc => bytes.push(lrc(&bytes)),
        Check::WrongLrc => bytes.push(lrc(&bytes) ^ 1),
    }
    if sending.ascii {
        let digit = |value: u8| b"0123456789ABCDEF"[usize::from(value & 0x0F)];
        let digits = bytes.iter().flat_map(|byte| [digit(byte >> 4), digit(*byte)]);
        return core::iter::once(b':').chain(digits).chain(*b"\r\n").collect();
    }
    bytes
}
