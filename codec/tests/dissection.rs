//! Every byte of every function has its name, in both directions, whole or damaged.

mod common;

use buslens_codec::dissect::{Direction, Dissection, Field, FieldKind, dissect};
use buslens_codec::line::Mode;
use buslens_codec::pdu::{PduError, Request, Response, SubFunction};
use buslens_codec::profile::{BUILT_IN, Profile};
use buslens_codec::{UnitId, adu};
use common::{answer, pdus, refusal, requests, responses};
use proptest::prelude::*;

fn frame(mode: Mode, pdu: &[u8]) -> Vec<u8> {
    adu::encode(mode, UnitId(1), pdu).unwrap()
}

fn take(pdu: &[u8], direction: Direction, request: Option<&Request>) -> Dissection {
    dissect(&frame(Mode::Rtu, pdu), Mode::Rtu, direction, request, None).unwrap()
}

/// Kinds of the PDU's data: without unit id, function code and check.
fn kinds(found: &Dissection) -> Vec<FieldKind> {
    let [_, _, data @ .., _] = found.fields.as_slice() else { panic!("{:?}", found.fields) };
    data.iter().map(|field| field.kind).collect()
}

/// Checks the kinds of a PDU's data against the tables of the standard's clause 6.
fn check(pdu: &[u8], direction: Direction, expected: &[FieldKind]) -> Dissection {
    let found = take(pdu, direction, None);
    assert_eq!(kinds(&found), expected, "{pdu:02X?}");
    assert_eq!(found.fault, None, "{pdu:02X?}");
    found
}

fn register(value: u16) -> FieldKind {
    FieldKind::Register { address: None, value }
}

fn register_at(address: u16, value: u16) -> FieldKind {
    FieldKind::Register { address: Some(address), value }
}

fn bits(address: Option<u16>, count: u8, value: u8) -> FieldKind {
    FieldKind::Bits { address, count, value }
}

use Direction::{Request as Asked, Response as Answered, Unknown};
use FieldKind as Kind;

/// Clause 6.1: coils 20 to 38, address 0013.
#[test]
fn coils_are_as_many_as_were_asked_for() {
    let pdu = [0x01, 0x03, 0xCD, 0x6B, 0x05];
    let alone = take(&pdu, Answered, None);
    assert_eq!(alone.bits.len(), 24);
    assert_eq!(kinds(&alone), [Kind::ByteCount(3), bits(None, 8, 0xCD), bits(None, 8, 0x6B), bits(None, 8, 0x05)]);
    let request = Request::ReadCoils { address: 0x13, quantity: 19 };
    let found = take(&pdu, Answered, Some(&request));
    assert_eq!((found.address, found.quantity, found.fault), (Some(0x13), Some(19), None));
    assert_eq!(
        kinds(&found),
        [Kind::ByteCount(3), bits(Some(0x13), 8, 0xCD), bits(Some(0x1B), 8, 0x6B), bits(Some(0x23), 3, 0x05)]
    );
    assert_eq!(found.bits.len(), 19);
    assert_eq!(found.bits[16..], [true, false, true]);
    assert_eq!(found.registers, []);
    let padded = take(&[0x01, 0x03, 0xCD, 0x6B, 0x0D], Answered, Some(&request));
    assert_eq!(padded.fault, Some(PduError::Padding { found: 0x0D }));
    assert_eq!(padded.bits.len(), 19);
}

/// Clause 6.11: ten coils from 0013 on.
#[test]
fn coils_that_are_written() {
    let pdu = [0x0F, 0x00, 0x13, 0x00, 0x0A, 0x02, 0xCD, 0x01];
    let expected = [
        Kind::Address(0x13),
        Kind::Quantity(10),
        Kind::ByteCount(2),
        bits(Some(0x13), 8, 0xCD),
        bits(Some(0x1B), 2, 0x01),
    ];
    let found = check(&pdu, Asked, &expected);
    assert_eq!(found.bits, [true, false, true, true, false, false, true, true, true, false]);
    check(&[0x0F, 0x00, 0x13, 0x00, 0x0A], Answered, &[Kind::Address(0x13), Kind::Quantity(10)]);
    let coil = check(&[0x05, 0x00, 0xAC, 0xFF, 0x00], Asked, &[Kind::Address(0xAC), Kind::Coil(0xFF00)]);
    assert_eq!((coil.bits, coil.registers), (vec![true], vec![]));
    let off = check(&[0x05, 0x00, 0xAC, 0x00, 0x00], Answered, &[Kind::Address(0xAC), Kind::Coil(0)]);
    assert_eq!(off.bits, [false]);
    let neither = take(&[0x05, 0x00, 0xAC, 0x00, 0x01], Asked, None);
    assert_eq!((neither.bits, neither.fault), (vec![], Some(PduError::CoilValue { found: 1 })));
}

/// Clauses 6.7 to 6.10.
#[test]
fn diagnostics_of_the_line() {
    check(&[0x07], Asked, &[]);
    check(&[0x07, 0x6D], Answered, &[Kind::ExceptionStatus(0x6D)]);
    let echo = [Kind::SubFunction(SubFunction::RETURN_QUERY_DATA), Kind::Data];
    check(&[0x08, 0x00, 0x00, 0xA5, 0x37, 0x11], Asked, &echo);
    let count = [Kind::SubFunction(SubFunction::BUS_MESSAGE_COUNT), Kind::DiagnosticValue(0x1234)];
    check(&[0x08, 0x00, 0x0B, 0x12, 0x34], Answered, &count);
    check(&[0x0B, 0xFF, 0xFF, 0x01, 0x08], Answered, &[Kind::Status(0xFFFF), Kind::EventCount(0x0108)]);
    let log = [
        Kind::ByteCount(8),
        Kind::Status(0),
        Kind::EventCount(0x0108),
        Kind::MessageCount(0x0121),
        Kind::Event(0x20),
        Kind::Event(0x00),
    ];
    check(&[0x0C, 0x08, 0x00, 0x00, 0x01, 0x08, 0x01, 0x21, 0x20, 0x00], Answered, &log);
}

/// Clause 6.13: only the maker tells where the id ends, but FF and 00 may tell it too.
#[test]
fn a_run_indicator_is_shown_where_it_can_be_only_one_byte() {
    check(&[0x11, 2, 0x11, 0xFF], Answered, &[Kind::ByteCount(2), Kind::ServerId, Kind::RunIndicator(0xFF)]);
    let text = [0x11, 5, b'A', b'B', 0x00, b'1', b'2'];
    let found = check(&text, Answered, &[Kind::ByteCount(5), Kind::ServerId, Kind::RunIndicator(0), Kind::Data]);
    assert_eq!(found.fields[3], Field { range: 3..5, kind: Kind::ServerId });
    check(&[0x11, 4, 0x00, 0xFF, 0x00, 0x01], Answered, &[Kind::ByteCount(4), Kind::ServerId]);
    check(&[0x11, 0], Answered, &[Kind::ByteCount(0)]);
}

/// The examples of clauses 6.14 and 6.15.
#[test]
fn file_records() {
    let pdu = [0x14, 14, 6, 0, 4, 0, 1, 0, 2, 6, 0, 3, 0, 9, 0, 2];
    let range = |file, record| {
        [Kind::ReferenceType(6), Kind::FileNumber(file), Kind::RecordNumber(record), Kind::RecordLength(2)]
    };
    check(&pdu, Asked, &[&[Kind::ByteCount(14)][..], &range(4, 1), &range(3, 9)].concat());
    let pdu = [0x14, 12, 5, 6, 0x0D, 0xFE, 0x00, 0x20, 5, 6, 0x33, 0xCD, 0x00, 0x40];
    let head = [Kind::RecordByteCount(5), Kind::ReferenceType(6)];
    let expected = [
        &[Kind::ByteCount(12)][..],
        &head,
        &[register(0x0DFE), register(0x20)],
        &head,
        &[register(0x33CD), register(0x40)],
    ];
    check(&pdu, Answered, &expected.concat());
    let pdu = [0x15, 13, 6, 0, 4, 0, 7, 0, 3, 0x06, 0xAF, 0x04, 0xBE, 0x10, 0x0D];
    let expected = [
        Kind::ByteCount(13),
        Kind::ReferenceType(6),
        Kind::FileNumber(4),
        Kind::RecordNumber(7),
        Kind::RecordLength(3),
        register(0x06AF),
        register(0x04BE),
        register(0x100D),
    ];
    for direction in [Asked, Answered, Unknown] {
        check(&pdu, direction, &expected);
    }
}

/// The examples of clauses 6.16 to 6.18.
#[test]
fn registers_of_the_rarer_functions() {
    let mask = [Kind::Address(4), Kind::AndMask(0xF2), Kind::OrMask(0x25)];
    let found = check(&[0x16, 0x00, 0x04, 0x00, 0xF2, 0x00, 0x25], Answered, &mask);
    assert_eq!((found.address, found.registers), (Some(4), vec![0xF2, 0x25]));
    let pdu = [0x17, 0, 3, 0, 6, 0, 14, 0, 3, 6, 0, 0xFF, 0, 0xFE, 0, 0xFD];
    let expected = [
        Kind::Address(3),
        Kind::Quantity(6),
        Kind::WriteAddress(14),
        Kind::WriteQuantity(3),
        Kind::ByteCount(6),
        register_at(14, 0xFF),
        register_at(15, 0xFE),
        register_at(16, 0xFD),
    ];
    let found = check(&pdu, Asked, &expected);
    assert_eq!((found.address, found.quantity), (Some(3), Some(6)));
    assert_eq!(found.registers, [0xFF, 0xFE, 0xFD]);
    let request = Request::decode(&pdu).unwrap();
    let found = take(&[0x17, 12, 0, 0xFE, 0x0A, 0xCD, 0, 1, 0, 3, 0, 13, 0, 0xFF], Answered, Some(&request));
    assert_eq!((found.address, found.quantity, found.fault), (Some(3), Some(6), None));
    assert_eq!(found.registers, [0xFE, 0x0ACD, 1, 3, 13, 0xFF]);
    assert_eq!(found.fields[3].kind, register_at(3, 0xFE));
    let queue = [Kind::FifoByteCount(6), Kind::FifoCount(2), register(0x01B8), register(0x1284)];
    let found = check(&[0x18, 0, 6, 0, 2, 0x01, 0xB8, 0x12, 0x84], Answered, &queue);
    assert_eq!(found.registers, [0x01B8, 0x1284]);
    check(&[0x18, 0x04, 0xDE], Asked, &[Kind::Address(0x04DE)]);
}

/// Clause 6.21.
#[test]
fn identification_of_a_device() {
    let expected = [Kind::MeiType(0x0E), Kind::DeviceIdCode(1), Kind::ObjectId(0)];
    check(&[0x2B, 0x0E, 1, 0], Asked, &expected);
    let pdu = [&[0x2B, 0x0E, 1, 1, 0xFF, 2, 2, 0, 2][..], b"Co", &[1, 0]].concat();
    let expected = [
        Kind::MeiType(0x0E),
        Kind::DeviceIdCode(1),
        Kind::Conformity(1),
        Kind::MoreFollows(0xFF),
        Kind::NextObject(2),
        Kind::ObjectCount(2),
        Kind::ObjectId(0),
        Kind::ObjectLength(2),
        Kind::ObjectValue,
        Kind::ObjectId(1),
        Kind::ObjectLength(0),
    ];
    check(&pdu, Answered, &expected);
    check(&[0x2B, 0x0D, 1, 0], Unknown, &[Kind::MeiType(0x0D), Kind::Data]);
}

#[test]
fn values_written_by_function_17_have_their_names() {
    let profile = Profile::from_json(BUILT_IN[0]).unwrap();
    let values = vec![7, 2];
    let request =
        Request::ReadWriteMultipleRegisters { read_address: 0x30, read_quantity: 1, write_address: 0x31, values };
    let bytes = frame(Mode::Rtu, &request.encode().unwrap());
    let found = dissect(&bytes, Mode::Rtu, Unknown, None, Some(&profile)).unwrap();
    let named: Vec<_> = found.points.iter().map(|named| (named.point.as_str(), named.range.clone())).collect();
    assert_eq!(named, [("baud", 11..13), ("parity", 13..15)]);
}

#[test]
fn a_reply_that_contradicts_its_request_is_a_fault_and_shown_all_the_same() {
    let request = Request::ReadHoldingRegisters { address: 0x10, quantity: 2 };
    let found = take(&[0x03, 0x02, 0x00, 0x07], Unknown, Some(&request));
    assert_eq!(found.fault, Some(PduError::ByteCount { found: 2, expected: 4 }));
    assert_eq!((found.registers.as_slice(), found.quantity), (&[7][..], Some(2)));
    let request = Request::ReadDiscreteInputs { address: 0, quantity: 9 };
    let found = take(&[0x02, 0x01, 0x07], Unknown, Some(&request));
    assert_eq!(found.fault, Some(PduError::ByteCount { found: 1, expected: 2 }));
    assert_eq!(found.bits.len(), 8);
    let request = Request::WriteSingleRegister { address: 1, value: 2 };
    let found = take(&[0x06, 0, 1, 0, 3], Answered, Some(&request));
    assert_eq!((found.fault, found.registers), (Some(PduError::Mismatch), vec![3]));
    let other = Request::ReadCoils { address: 0, quantity: 1 };
    assert_eq!(take(&[0x06, 0, 1, 0, 3], Answered, Some(&other)).fault, None, "of another function");
}

#[test]
fn an_exception_keeps_what_was_asked() {
    let request = Request::ReadInputRegisters { address: 4, quantity: 1 };
    let found = take(&[0x84, 0x02], Unknown, Some(&request));
    assert_eq!((found.address, found.quantity, found.fault), (Some(4), Some(1), None));
}

#[test]
fn a_direction_is_told_only_by_what_a_pdu_can_be() {
    let told = |pdu: &[u8]| take(pdu, Unknown, None).direction;
    // One byte of coils and the address 0100 with the quantity 1: replies have a byte less.
    assert_eq!(told(&[0x01, 0x01, 0x00, 0x00, 0x01]), Asked);
    assert_eq!(told(&[0x01, 0x01, 0x05]), Answered);
    // Three bytes of coils, or 0x0101 coils from 0x0300 on.
    assert_eq!(told(&[0x01, 0x03, 0x00, 0x01, 0x01]), Unknown);
    // Three bytes of coils, or 0x4B6B coils: too many.
    assert_eq!(told(&[0x02, 0x03, 0x00, 0x4B, 0x6B]), Answered);
    assert_eq!(told(&[0x03, 0x03, 0x00, 0x00, 0x7D]), Asked);
    assert_eq!(told(&[0x03, 0x00, 0x00, 0x00, 0xFF]), Asked);
    assert_eq!(told(&[0x06, 0, 1, 0, 1]), Unknown);
    assert_eq!(told(&[0x07]), Asked);
    assert_eq!(told(&[0x07, 1]), Answered);
    assert_eq!(told(&[0x07, 1, 2]), Unknown);
    assert_eq!(told(&[0x08, 0, 0, 1, 2]), Unknown);
    assert_eq!(told(&[0x0B]), Asked);
    assert_eq!(told(&[0x0B, 0, 0, 0, 1]), Answered);
    assert_eq!(told(&[0x0C, 7, 0, 0, 0, 0, 0, 1]), Answered);
    assert_eq!(told(&[0x0F, 0, 0, 0, 9]), Answered);
    assert_eq!(told(&[0x10, 0, 0, 0, 1, 2]), Asked);
    assert_eq!(told(&[0x11]), Asked);
    assert_eq!(told(&[0x14, 7, 6, 0, 1, 0, 0, 0, 1]), Asked);
    assert_eq!(told(&[0x14, 4, 3, 6, 0, 1]), Answered);
    assert_eq!(told(&[0x17, 2, 0, 1]), Answered);
    assert_eq!(told(&[0x17, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 0]), Asked);
    assert_eq!(told(&[0x18, 0, 1]), Asked);
    assert_eq!(told(&[0x18, 0, 2, 0, 0]), Answered);
    assert_eq!(told(&[0x2B, 0x0E, 1, 0]), Asked);
    assert_eq!(told(&[0x2B, 0x0E, 1, 1, 0, 0, 0]), Answered);
    assert_eq!(told(&[0x41, 1]), Unknown);
    assert_eq!(told(&[0x80, 1]), Answered);
}

/// Every byte of the frame belongs to exactly one field, in order.
fn covers(found: &Dissection, frame: &[u8]) -> Result<(), TestCaseError> {
    let mut at = 0;
    for field in &found.fields {
        prop_assert_eq!(field.range.start, at);
        prop_assert!(field.range.end > at);
        at = field.range.end;
    }
    prop_assert_eq!(at, frame.len());
    Ok(())
}

fn directions() -> impl Strategy<Value = Direction> {
    prop_oneof![Just(Asked), Just(Answered), Just(Unknown)]
}

proptest! {
    #[test]
    fn fields_cover_whole_and_damaged_frames(
        pdu in pdus().prop_filter("fits a frame", |pdu| (1..=253).contains(&pdu.len())),
        direction in directions(),
        request in prop::option::of(requests()),
        ascii: bool,
    ) {
        let mode = if ascii { Mode::Ascii } else { Mode::Rtu };
        let frame = frame(mode, &pdu);
        let profile = Profile::from_json(BUILT_IN[0]).unwrap();
        let found = dissect(&frame, mode, direction, request.as_ref(), Some(&profile)).unwrap();
        covers(&found, &frame)?;
        prop_assert!(found.check.is_ok());
        for named in &found.points {
            prop_assert!(named.range.end <= frame.len());
        }
    }

    #[test]
    fn a_request_and_its_answer_are_without_fault(request in requests()) {
        let pdu = request.encode().unwrap();
        let asked = take(&pdu, Unknown, None);
        prop_assert_ne!(asked.direction, Answered);
        prop_assert_eq!(asked.fault, None);
        prop_assert_eq!((asked.address, asked.quantity), (request.address(), request.quantity()));
        let raw = matches!(request, Request::Other { .. } | Request::Diagnostics { .. });
        prop_assert!(raw || !kinds(&asked).contains(&Kind::Data), "{:?}", asked.fields);
        for response in answer(&request).into_iter().chain([refusal(&request)]) {
            let refused = matches!(response, Response::Exception { .. });
            let answered = take(&response.encode().unwrap(), Unknown, Some(&request));
            prop_assert_ne!(answered.direction, Asked);
            let known = answered.direction == Answered;
            prop_assert!(!known || answered.fault.is_none(), "{:?}", answered.fault);
            prop_assert!(!known || answered.address == request.address());
            prop_assert!(!known || answered.quantity == request.quantity());
            prop_assert_eq!(answered.exception.is_some(), refused);
        }
    }

    /// What a response carries comes out again.
    #[test]
    fn data_of_responses_come_out(response in responses()) {
        let found = take(&response.encode().unwrap(), Answered, None);
        prop_assert_eq!(found.fault, None);
        match response {
            Response::ReadHoldingRegisters { values }
            | Response::ReadInputRegisters { values }
            | Response::ReadWriteMultipleRegisters { values }
            | Response::ReadFifoQueue { values } => prop_assert_eq!(found.registers, values),
            Response::ReadCoils { status } | Response::ReadDiscreteInputs { status } => {
                prop_assert_eq!(buslens_codec::pdu::pack_bits(&found.bits), status);
            }
            Response::WriteSingleCoil { on, .. } => prop_assert_eq!(found.bits, [on]),
            Response::WriteSingleRegister { value, .. } => prop_assert_eq!(found.registers, [value]),
            Response::MaskWriteRegister { and_mask, or_mask, .. } => {
                prop_assert_eq!(found.registers, [and_mask, or_mask]);
            }
            Response::Exception { code, .. } => prop_assert_eq!(found.exception, Some(code)),
            _ => prop_assert!(found.registers.is_empty() && found.bits.is_empty()),
        }
    }

    #[test]
    fn data_of_requests_come_out(request in requests()) {
        let found = take(&request.encode().unwrap(), Asked, None);
        match request {
            Request::WriteMultipleCoils { coils, .. } => prop_assert_eq!(found.bits, coils),
            Request::WriteMultipleRegisters { values, .. } | Request::ReadWriteMultipleRegisters { values, .. } => {
                prop_assert_eq!(found.registers, values);
            }
            _ => {}
        }
    }
}
