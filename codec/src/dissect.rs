//! One frame taken apart: every byte in a named field, values named by a profile, and what is wrong.
//!
//! A frame with a wrong check is taken apart all the same, as far as its shape allows; nothing is guessed and no value is
//! changed. Nothing here makes texts: that is the page's part, in two languages.

use alloc::string::String;
use alloc::vec::Vec;
use core::ops::Range;

use crate::UnitId;
use crate::check::{crc16, lrc};
use crate::line::Mode;
use crate::pdu::{ExceptionCode, PduError, Request, Response};
use crate::profile::{Known, Profile};
use crate::value::{Value, ValueError};

/// Which way a frame goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the master.
    Request,
    /// From a device.
    Response,
    /// It can be either: functions 05 and 06 are answered by the request itself.
    Unknown,
}

/// A frame taken apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Dissection {
    /// RTU or ASCII.
    pub mode: Mode,
    /// Which way it goes.
    pub direction: Direction,
    /// Addressed or answering.
    pub unit: UnitId,
    /// The function code, without an exception's top bit.
    pub function: u8,
    /// The exception code, if it is one.
    pub exception: Option<ExceptionCode>,
    /// First register or coil: from the request, also on its response.
    pub address: Option<u16>,
    /// How many registers.
    pub quantity: Option<u16>,
    /// Registers read or written.
    pub registers: Vec<u16>,
    /// The check.
    pub check: Check,
    /// All bytes in order; each belongs to exactly one field.
    pub fields: Vec<Field>,
    /// Values under the profile.
    pub points: Vec<NamedValue>,
    /// Why the PDU is none of its function, though the frame may be whole.
    pub fault: Option<PduError>,
}

/// Some bytes of the frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Their place.
    pub range: Range<usize>,
    /// What they are.
    pub kind: FieldKind,
}

/// What bytes are.
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
    /// The first register or the coil.
    Address(u16),
    /// How many registers.
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
    /// Bytes without a known meaning.
    Data,
    /// CRC or LRC.
    Check,
    /// CR LF of ASCII mode.
    End,
}

/// The check of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// CRC-16; on the wire the low byte comes first.
    Crc16 {
        /// As in the frame.
        found: u16,
        /// What it should be.
        expected: u16,
    },
    /// LRC.
    Lrc {
        /// As in the frame.
        found: u8,
        /// What it should be.
        expected: u8,
    },
}

impl Check {
    /// Whether it is right.
    pub fn is_ok(self) -> bool {
        match self {
            Self::Crc16 { found, expected } => found == expected,
            Self::Lrc { found, expected } => found == expected,
        }
    }
}

/// A value named by the profile.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedValue {
    /// The point's id.
    pub point: String,
    /// Its first register or coil.
    pub register: u16,
    /// As in the frame.
    pub raw: Vec<u16>,
    /// Its value, or why there is none.
    pub value: Result<Value, ValueError>,
    /// Whether the value is in its unit: `false` while the register that scales it is not known.
    pub scaled: bool,
    /// Its unit as far as it is known, empty for none.
    pub unit: String,
    /// Its bytes in the frame.
    pub range: Range<usize>,
}

/// Takes one frame apart. `request` is what a response answers, where that is known. `None` for bytes that are too few to
/// hold a unit id, a function code and a check, and for characters of ASCII mode that are no digits.
pub fn dissect(
    frame: &[u8],
    mode: Mode,
    direction: Direction,
    request: Option<&Request>,
    profile: Option<&Profile>,
) -> Option<Dissection> {
    let (body, check) = match mode {
        Mode::Rtu => {
            let (body, &[low, high]) = frame.split_last_chunk::<2>()?;
            (body.to_vec(), Check::Crc16 { found: u16::from_le_bytes([low, high]), expected: crc16(body) })
        }
        Mode::Ascii => {
            let mut body = crate::ascii::decode_body(frame).ok()?;
            let found = body.pop()?;
            let expected = lrc(&body);
            (body, Check::Lrc { found, expected })
        }
    };
    let &[unit, function, ..] = body.as_slice() else { return None };
    let direction = direction_of(&body[1..], direction);
    let request = request.filter(|request| request.function() == function & 0x7F);
    let layout = lay_out(&body, direction, request);
    let place = Place { mode, len: frame.len() };
    let mut fields = Vec::new();
    if mode == Mode::Ascii {
        fields.push(Field { range: 0..1, kind: FieldKind::Start });
    }
    fields.extend(layout.fields.iter().map(|(range, kind)| Field { range: place.of(range.clone()), kind: *kind }));
    fields.push(Field { range: place.check(), kind: FieldKind::Check });
    if mode == Mode::Ascii {
        fields.push(Field { range: frame.len() - 2..frame.len(), kind: FieldKind::End });
    }
    let points = profile.map(|profile| name_values(profile, &layout, function, place)).unwrap_or_default();
    Some(Dissection {
        mode,
        direction,
        unit: UnitId(unit),
        function: function & 0x7F,
        exception: layout.exception,
        address: layout.address,
        quantity: layout.quantity,
        registers: layout.registers,
        check,
        fields,
        points,
        fault: layout.fault,
    })
}

/// Where bytes of the body (unit id and PDU) stand in the frame.
#[derive(Clone, Copy)]
struct Place {
    mode: Mode,
    len: usize,
}

impl Place {
    fn of(self, body: Range<usize>) -> Range<usize> {
        match self.mode {
            Mode::Rtu => body,
            Mode::Ascii => 1 + 2 * body.start..1 + 2 * body.end,
        }
    }

    fn check(self) -> Range<usize> {
        match self.mode {
            Mode::Rtu => self.len - 2..self.len,
            Mode::Ascii => self.len - 4..self.len - 2,
        }
    }
}

/// The body's bytes in fields, and what they say.
#[derive(Default)]
struct Layout {
    fields: Vec<(Range<usize>, FieldKind)>,
    exception: Option<ExceptionCode>,
    address: Option<u16>,
    quantity: Option<u16>,
    registers: Vec<u16>,
    /// Where the registers begin in the body.
    registers_at: usize,
    fault: Option<PduError>,
}

/// Judges by the shape of the PDU where the caller does not know: a read request has five bytes and a read reply never.
fn direction_of(pdu: &[u8], hint: Direction) -> Direction {
    match (pdu[0], pdu.len()) {
        (0x80.., _) => Direction::Response,
        _ if hint != Direction::Unknown => hint,
        (0x03 | 0x04, len) => {
            if len == 5 {
                Direction::Request
            } else {
                Direction::Response
            }
        }
        (0x10, len) => {
            if len == 5 {
                Direction::Response
            } else {
                Direction::Request
            }
        }
        _ => Direction::Unknown,
    }
}

fn lay_out(body: &[u8], direction: Direction, request: Option<&Request>) -> Layout {
    let mut layout = Layout::default();
    layout.fields.push((0..1, FieldKind::Unit(UnitId(body[0]))));
    layout.fields.push((1..2, FieldKind::Function(body[1])));
    let mut walk = Walk { body, at: 2 };
    let fault = match direction {
        Direction::Response => Response::decode(&body[1..]).err(),
        Direction::Request | Direction::Unknown => Request::decode(&body[1..]).err(),
    };
    layout.fault = fault;
    match (body[1], direction) {
        (0x80.., _) => {
            if let Some(range) = walk.take(1) {
                let code = ExceptionCode::from(body[range.start]);
                layout.exception = Some(code);
                layout.fields.push((range, FieldKind::Exception(code)));
            }
        }
        (0x03 | 0x04, Direction::Response) => {
            let (address, quantity) = match request {
                Some(
                    Request::ReadHoldingRegisters { address, quantity }
                    | Request::ReadInputRegisters { address, quantity },
                ) => (Some(*address), Some(*quantity)),
                _ => (None, None),
            };
            (layout.address, layout.quantity) = (address, quantity);
            layout.byte_count(&mut walk);
            layout.take_registers(&mut walk);
        }
        (0x03 | 0x04, _) | (0x10, Direction::Response) => {
            layout.take_address(&mut walk);
            layout.take_quantity(&mut walk);
        }
        (0x05, _) => {
            layout.take_address(&mut walk);
            if let Some((range, value)) = walk.word() {
                layout.registers_at = range.start;
                layout.registers.push(value);
                layout.fields.push((range, FieldKind::Coil(value)));
            }
        }
        (0x06, _) => {
            layout.take_address(&mut walk);
            if let Some((range, value)) = walk.word() {
                layout.registers_at = range.start;
                layout.registers.push(value);
                layout.fields.push((range, FieldKind::Register { address: layout.address, value }));
            }
        }
        (0x10, _) => {
            layout.take_address(&mut walk);
            layout.take_quantity(&mut walk);
            layout.byte_count(&mut walk);
            layout.take_registers(&mut walk);
        }
        _ => {}
    }
    if walk.at < body.len() {
        layout.fields.push((walk.at..body.len(), FieldKind::Data));
    }
    layout
}

impl Layout {
    fn take_address(&mut self, walk: &mut Walk<'_>) {
        if let Some((range, address)) = walk.word() {
            self.address = Some(address);
            self.fields.push((range, FieldKind::Address(address)));
        }
    }

    fn take_quantity(&mut self, walk: &mut Walk<'_>) {
        if let Some((range, quantity)) = walk.word() {
            self.quantity = Some(quantity);
            self.fields.push((range, FieldKind::Quantity(quantity)));
        }
    }

    fn byte_count(&mut self, walk: &mut Walk<'_>) {
        if let Some(range) = walk.take(1) {
            self.fields.push((range.clone(), FieldKind::ByteCount(walk.body[range.start])));
        }
    }

    fn take_registers(&mut self, walk: &mut Walk<'_>) {
        self.registers_at = walk.at;
        let mut address = self.address;
        while let Some((range, value)) = walk.word() {
            self.registers.push(value);
            self.fields.push((range, FieldKind::Register { address, value }));
            address = address.and_then(|address| address.checked_add(1));
        }
    }
}

/// Goes through the body and never over its end.
struct Walk<'a> {
    body: &'a [u8],
    at: usize,
}

impl Walk<'_> {
    fn take(&mut self, count: usize) -> Option<Range<usize>> {
        let range = self.at..self.at + count;
        self.body.get(range.clone())?;
        self.at = range.end;
        Some(range)
    }

    fn word(&mut self) -> Option<(Range<usize>, u16)> {
        let range = self.take(2)?;
        Some((range.clone(), u16::from_be_bytes([self.body[range.start], self.body[range.start + 1]])))
    }
}

fn name_values(profile: &Profile, layout: &Layout, function: u8, place: Place) -> Vec<NamedValue> {
    let Some(address) = layout.address else { return Vec::new() };
    let points = profile.decode_points(function, address, &layout.registers, &mut Known::default());
    let named = points.into_iter().map(|found| {
        let registers = found.offset..found.offset + found.point.encoding.registers();
        let bytes = layout.registers_at + 2 * registers.start..layout.registers_at + 2 * registers.end;
        NamedValue {
            point: found.point.id.clone(),
            register: found.point.register,
            raw: layout.registers[registers].to_vec(),
            value: found.value,
            scaled: found.scaled,
            unit: found.unit.into(),
            range: place.of(bytes),
        }
    });
    named.collect()
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;
    use alloc::vec;

    use proptest::prelude::*;

    use super::*;

    fn lvdt() -> Profile {
        Profile::from_json(crate::profile::BUILT_IN[0]).unwrap()
    }

    #[test]
    fn a_reply_with_its_request_names_its_values() {
        let frame = [0x01, 0x04, 0x08, 0x00, 0x00, 0x01, 0x1D, 0x00, 0x7B, 0x01, 0xC8, 0xB9, 0xC1];
        let request = Request::ReadInputRegisters { address: 2, quantity: 4 };
        let found = dissect(&frame, Mode::Rtu, Direction::Unknown, Some(&request), Some(&lvdt())).unwrap();
        assert_eq!(found.direction, Direction::Response);
        assert!(found.check.is_ok());
        let points: Vec<_> = found.points.iter().map(|p| (p.point.as_str(), p.value.unwrap().to_string())).collect();
        assert_eq!(points, [("temperature", "28.5".to_string()), ("displacement", "123.456".to_string())]);
        assert_eq!(found.points[1].range, 7..11);
    }

    #[test]
    fn the_lrc_printed_in_table_19_is_wrong() {
        let found = dissect(b":010300310001C1\r\n", Mode::Ascii, Direction::Unknown, None, Some(&lvdt())).unwrap();
        assert_eq!(found.check, Check::Lrc { found: 0xC1, expected: 0xCA });
        assert_eq!(found.address, Some(0x31));
        assert_eq!(found.fields[3], Field { range: 5..9, kind: FieldKind::Address(0x31) });
    }

    #[test]
    fn an_echoed_write_goes_either_way_and_names_its_command() {
        let frame = [0x01, 0x05, 0x00, 0x50, 0xFF, 0x00, 0x8C, 0x2B];
        let found = dissect(&frame, Mode::Rtu, Direction::Unknown, None, Some(&lvdt())).unwrap();
        assert_eq!(found.direction, Direction::Unknown);
        assert_eq!(found.points[0].point, "zero");
        assert_eq!(found.points[0].value, Ok(Value::Code(0xFF00)));
    }

    #[test]
    fn an_exception_is_a_response_whatever_was_said() {
        let frame = crate::rtu::encode(UnitId(0), &[0x84, 0x02]).unwrap();
        let found = dissect(&frame, Mode::Rtu, Direction::Request, None, None).unwrap();
        assert_eq!(found.direction, Direction::Response);
        assert_eq!(found.exception, Some(ExceptionCode::IllegalDataAddress));
        assert_eq!((found.function, found.unit), (4, UnitId(0)));
    }

    #[test]
    fn a_byte_count_that_does_not_fit_is_a_fault_but_everything_is_shown() {
        let frame = crate::rtu::encode(UnitId(1), &[0x03, 0x04, 0x00, 0x07]).unwrap();
        let found = dissect(&frame, Mode::Rtu, Direction::Unknown, None, None).unwrap();
        assert_eq!(found.fault, Some(PduError::ByteCount { found: 4, expected: 2 }));
        assert_eq!(found.registers, vec![7]);
    }

    proptest! {
        /// Every byte belongs to exactly one field, in order, whatever the bytes are.
        #[test]
        fn fields_cover_the_frame(bytes in prop::collection::vec(any::<u8>(), 0..300), response: bool, ascii: bool) {
            let direction = if response { Direction::Response } else { Direction::Unknown };
            let mode = if ascii { Mode::Ascii } else { Mode::Rtu };
            let frame = if ascii && bytes.len() > 1 && bytes.len() < 200 {
                crate::ascii::encode(UnitId(bytes[0]), &bytes[1..]).unwrap()
            } else {
                bytes
            };
            if let Some(found) = dissect(&frame, mode, direction, None, Some(&lvdt())) {
                let mut at = 0;
                for field in &found.fields {
                    prop_assert_eq!(field.range.start, at);
                    prop_assert!(field.range.end > at);
                    at = field.range.end;
                }
                prop_assert_eq!(at, frame.len());
            }
        }
    }
}
