//! One frame taken apart: every byte in a named field, values named by a profile, and what is wrong.
//!
//! A frame with a wrong check is taken apart all the same, as far as its shape allows; nothing is guessed and no value is
//! changed. Nothing here makes texts: that is the page's part, in two languages.
//!
//! [`dissect`] takes any bytes and never panics.

mod direction;
mod fault;
mod field;
mod layout;

use alloc::string::String;
use alloc::vec::Vec;
use core::ops::Range;

use crate::UnitId;
use crate::check::{crc16, lrc};
use crate::line::Mode;
use crate::pdu::{ExceptionCode, PduError, Request};
use crate::profile::{Known, Profile};
use crate::value::{Value, ValueError};

pub use direction::Direction;
pub use field::{Field, FieldKind};

use direction::direction_of;
use fault::fault_of;
use layout::{Layout, lay_out};

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
    /// First register, coil or input: from the request, also on its response. Of function 17 the first that is read.
    pub address: Option<u16>,
    /// How many registers, coils or inputs from there: from the request, also on its response. `None` for functions that
    /// have no such field.
    pub quantity: Option<u16>,
    /// Registers read or written: functions 03, 04, 06, 10, 17 (what this frame carries) and 18, and the two masks of
    /// function 16.
    pub registers: Vec<u16>,
    /// Coils or inputs read or written: functions 01, 02, 05 and 0F. Of replies as many as their request asked for; all
    /// bits of their bytes where it is not known.
    pub bits: Vec<bool>,
    /// The check.
    pub check: Check,
    /// All bytes in order; each belongs to exactly one field.
    pub fields: Vec<Field>,
    /// Values under the profile.
    pub points: Vec<NamedValue>,
    /// Why the PDU is none of its function or does not answer its request, though the frame may be whole.
    pub fault: Option<PduError>,
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

/// Takes one frame apart. `request` is what a response answers, where that is known; it is not looked at for a frame of
/// another function. `None` for bytes that are too few to hold a unit id, a function code and a check, and for characters of
/// ASCII mode that are no frame but for the LRC.
pub fn dissect(
    frame: &[u8],
    mode: Mode,
    direction: Direction,
    request: Option<&Request>,
    profile: Option<&Profile>,
) -> Option<Dissection> {
    dissect_known(frame, mode, direction, request, profile, &mut Known::default())
}

/// Like [`dissect`], where frames of the same device came before: what they told of scales and units is in `known`, and
/// what this one tells is put there.
pub fn dissect_known(
    frame: &[u8],
    mode: Mode,
    direction: Direction,
    request: Option<&Request>,
    profile: Option<&Profile>,
    known: &mut Known,
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
    let (&unit, pdu) = body.split_first()?;
    let function = pdu.first()? & 0x7F;
    let direction = direction_of(pdu, direction);
    let request = request.filter(|request| request.function() == function);
    let layout = lay_out(&body, direction, request);
    let place = Place { mode, len: frame.len() };
    let points = profile.map(|profile| name_values(profile, &layout, function, place, known)).unwrap_or_default();
    Some(Dissection {
        mode,
        direction,
        unit: UnitId(unit),
        function,
        exception: layout.exception,
        address: layout.address,
        quantity: layout.quantity,
        registers: if function == 0x05 { Vec::new() } else { layout.words },
        bits: layout.bits,
        check,
        fields: place.around(layout.fields),
        points,
        fault: fault_of(pdu, direction, request),
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

    /// The frame's fields from the body's.
    fn around(self, body: Vec<Field>) -> Vec<Field> {
        let ascii = self.mode == Mode::Ascii;
        let (start, end) = (usize::from(ascii), if ascii { self.len - 2 } else { self.len });
        let body = body.into_iter().map(|field| Field { range: self.of(field.range), kind: field.kind });
        let start = ascii.then_some(Field { range: 0..start, kind: FieldKind::Start });
        let check = Field { range: end - 2..end, kind: FieldKind::Check };
        let end = ascii.then_some(Field { range: end..self.len, kind: FieldKind::End });
        start.into_iter().chain(body).chain([check]).chain(end).collect()
    }
}

fn name_values(profile: &Profile, layout: &Layout, function: u8, place: Place, known: &mut Known) -> Vec<NamedValue> {
    let Some(address) = layout.words_from else { return Vec::new() };
    // Function 17 reads and writes the registers that function 03 reads.
    let function = if function == 0x17 { 0x03 } else { function };
    let points = profile.decode_points(function, address, &layout.words, known);
    let named = points.into_iter().map(|found| {
        let registers = found.offset..found.offset + found.point.encoding.registers();
        let bytes = layout.words_at + 2 * registers.start..layout.words_at + 2 * registers.end;
        NamedValue {
            point: found.point.id.clone(),
            register: found.point.register,
            raw: layout.words[registers].to_vec(),
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
