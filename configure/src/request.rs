//! From points to requests, and from replies to registers.

use buslens_bus::record::{End, Outcome};
use buslens_codec::line::Mode;
use buslens_codec::pdu::{Request, Response, unpack_bits};
use buslens_codec::profile::{Group, Point, Profile};
use buslens_codec::value::Encoding;
use buslens_codec::{adu, ascii, rtu};

use crate::{Reach, Read};

/// A coil that is on, as function 05 writes it.
const ON: u16 = 0xFF00;
/// Registers in one read (MODBUS application protocol V1.1b3, clause 6.3).
const MOST_REGISTERS: u16 = 125;

/// What has come of a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// A read's registers; a coil is FF00 or 0000.
    Registers(Vec<u16>),
    /// A write was acknowledged.
    Written,
    /// An exception with this code.
    Refused(u8),
    /// A broadcast is out, and nobody answers it.
    Broadcast,
    /// Nothing was heard.
    Silence,
    /// Something was heard that is no reply, or may be somebody else's.
    Unclear,
}

/// The function that reads a point, and its reads.
fn function_of(point: &Point) -> Option<u8> {
    point.read.iter().copied().find(|function| matches!(function, 1..=4))
}

/// The read that brings a point alone; `None` for what is only written.
pub(crate) fn single(point: &Point) -> Option<Group> {
    let quantity = u16::try_from(point.encoding.registers()).ok()?;
    Some(Group { function: function_of(point)?, address: point.register, quantity, tentative: false })
}

/// The fewest reads that bring these points, in their order, without those that the device refuses. What is no group of
/// the profile is read together where it lies side by side.
pub(crate) fn blocks(profile: &Profile, points: &[&Point], refused: &[Group]) -> Vec<Group> {
    let mut open: Vec<&Point> = points.iter().copied().filter(|point| function_of(point).is_some()).collect();
    let mut all = Vec::new();
    while let Some(first) = open.first() {
        let covers = |group: &Group| open.iter().filter(|point| group.offset_of(point).is_some()).count();
        let of_profile = profile.groups.iter().filter(|group| group.offset_of(first).is_some());
        let known = of_profile.copied().chain(side_by_side(&open)).filter(|group| !is_refused(*group, refused));
        // Of groups that bring as much the shortest.
        let best = known.max_by_key(|group| (covers(group), u16::MAX - group.quantity));
        let Some(block) = best.filter(|block| covers(block) > 1).or_else(|| single(first)) else { break };
        open.retain(|point| block.offset_of(point).is_none());
        all.push(block);
    }
    all
}

/// Whether a device refuses a read. Where nobody promises anything, what lies within a refused one is not tried either.
fn is_refused(group: Group, refused: &[Group]) -> bool {
    let end = |group: Group| u32::from(group.address) + u32::from(group.quantity);
    refused.iter().copied().filter(|known| known.function == group.function).any(|known| {
        let same = (known.address, known.quantity) == (group.address, group.quantity);
        same || group.tentative && known.address <= group.address && end(group) <= end(known)
    })
}

/// The first point and all that follow it without a gap.
fn side_by_side(points: &[&Point]) -> Option<Group> {
    let first = single(points.first()?)?;
    let mut end = u32::from(first.address) + u32::from(first.quantity);
    for point in points.get(1..)? {
        let next = single(point)?;
        if next.function == first.function && u32::from(next.address) == end {
            end += u32::from(next.quantity);
        }
    }
    let quantity = u16::try_from(end - u32::from(first.address)).ok()?.min(MOST_REGISTERS);
    Some(Group { quantity, tentative: true, ..first })
}

/// The request of a read.
pub(crate) fn read_request(group: Group) -> Option<Request> {
    let Group { function, address, quantity, .. } = group;
    match function {
        1 => Some(Request::ReadCoils { address, quantity }),
        2 => Some(Request::ReadDiscreteInputs { address, quantity }),
        _ => group.request(),
    }
}

/// The request that writes these registers to a point; `None` if nothing writes it or they are none of its.
pub(crate) fn write_request(point: &Point, registers: &[u16]) -> Option<Request> {
    let coils = || match *registers {
        [value @ (0 | ON)] if point.write.contains(&0x0F) => {
            Some(Request::WriteMultipleCoils { address: point.register, coils: vec![value == ON] })
        }
        _ => None,
    };
    point.write_request(registers).or_else(coils)
}

/// The reply to a write that is carried out.
pub(crate) fn write_reply(request: &Request) -> Option<Response> {
    Some(match *request {
        Request::WriteSingleCoil { address, on } => Response::WriteSingleCoil { address, on },
        Request::WriteSingleRegister { address, value } => Response::WriteSingleRegister { address, value },
        Request::WriteMultipleCoils { address, .. } => {
            Response::WriteMultipleCoils { address, quantity: request.quantity()? }
        }
        Request::WriteMultipleRegisters { address, .. } => {
            Response::WriteMultipleRegisters { address, quantity: request.quantity()? }
        }
        _ => return None,
    })
}

/// A request as it goes out; `None` if it breaks a limit of the standard.
pub(crate) fn frame(reach: Reach, request: &Request) -> Option<Vec<u8>> {
    adu::encode(reach.mode, reach.unit, &request.encode().ok()?)
}

/// A reply as it comes.
pub(crate) fn reply_frame(reach: Reach, response: &Response) -> Option<Vec<u8>> {
    adu::encode(reach.mode, reach.unit, &response.encode().ok()?)
}

/// What a reply says, given how sending has ended.
pub(crate) fn answer(mode: Mode, request: &Request, outcome: &Outcome) -> Answer {
    match outcome.end {
        End::Answered => {}
        End::Broadcast => return Answer::Broadcast,
        End::Silence => return Answer::Silence,
        _ => return Answer::Unclear,
    }
    let response = match mode {
        Mode::Rtu => rtu::decode(&outcome.heard).ok().and_then(|adu| Response::decode(adu.pdu).ok()),
        Mode::Ascii => ascii::decode(&outcome.heard).ok().and_then(|adu| Response::decode(&adu.pdu).ok()),
    };
    let bits = |status: &[u8]| {
        let bits = unpack_bits(status, request.quantity().unwrap_or_default().into());
        Answer::Registers(bits.into_iter().map(|bit| if bit { ON } else { 0 }).collect())
    };
    match response {
        Some(Response::Exception { code, .. }) => Answer::Refused(code.code()),
        Some(Response::ReadHoldingRegisters { values } | Response::ReadInputRegisters { values }) => {
            Answer::Registers(values)
        }
        Some(Response::ReadCoils { status } | Response::ReadDiscreteInputs { status }) => bits(&status),
        Some(_) => Answer::Written,
        None => Answer::Unclear,
    }
}

/// A point's own among what a read has brought.
pub(crate) fn part_of(group: Group, point: &Point, registers: &[u16]) -> Option<Vec<u16>> {
    let offset = group.offset_of(point)?;
    registers.get(offset..)?.get(..point.encoding.registers()).map(<[u16]>::to_vec)
}

/// Whether two states of a point's registers are the same to it: bits of others do not count.
pub(crate) fn same(point: &Point, left: &[u16], right: &[u16]) -> bool {
    match (point.encoding, left, right) {
        (Encoding::Bits { mask, .. }, [left], [right]) => left & mask == right & mask,
        (Encoding::ReservedI16 { .. }, [_, left], [_, right]) => left == right,
        _ => left == right,
    }
}

/// Whether a point holds this.
pub(crate) fn holds(point: &Point, read: &Read, wanted: &[u16]) -> bool {
    matches!(read, Read::Registers(registers) if same(point, registers, wanted))
}

/// The registers of a write: what is not the point's own stays as it was in `before`.
pub(crate) fn over(point: &Point, registers: &[u16], before: &[u16]) -> Vec<u16> {
    match (point.encoding, registers, before) {
        (Encoding::Bits { mask, .. }, [new], [old]) => vec![old & !mask | new & mask],
        (Encoding::ReservedI16 { .. }, [_, new], [old, _]) => vec![*old, *new],
        _ => registers.to_vec(),
    }
}

/// Whether its registers hold something else as well, which a write must leave alone.
pub(crate) fn shares_registers(point: &Point) -> bool {
    matches!(point.encoding, Encoding::Bits { .. } | Encoding::ReservedI16 { .. })
}
