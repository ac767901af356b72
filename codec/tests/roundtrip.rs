//! Encode and decode are inverse, replies fit their requests, and nothing panics on any bytes.

mod common;

use buslens_codec::check::{crc16, lrc};
use buslens_codec::line::Mode;
use buslens_codec::pdu::{DeviceIdObject, FileRecord, FileRecordRange, PduError, Request, Response, SubFunction};
use buslens_codec::{UnitId, adu, ascii, rtu};
use common::{answer, pdus, refusal, requests, responses};
use proptest::prelude::*;

/// Check values of the catalogue of CRC algorithms (CRC-16/MODBUS) and of the standard's LRC definition.
#[test]
fn checks_have_their_published_values() {
    assert_eq!(crc16(b"123456789"), 0x4B37);
    assert_eq!(lrc(b"123456789"), 0x23);
    assert_eq!(lrc(&[]), 0);
}

#[test]
fn limits_of_the_standard() {
    let read = |quantity| Request::ReadHoldingRegisters { address: 0, quantity }.encode();
    assert!(read(125).is_ok());
    assert_eq!(read(126), Err(PduError::Quantity { found: 126, limit: 125 }));
    assert_eq!(read(0), Err(PduError::Quantity { found: 0, limit: 125 }));
    let write = |quantity| Request::WriteMultipleRegisters { address: 0, values: vec![0; quantity] }.encode();
    assert_eq!(write(123).unwrap().len(), 252);
    assert_eq!(write(124), Err(PduError::Quantity { found: 124, limit: 123 }));
    assert!(rtu::encode(UnitId(1), &[0; 253]).is_ok_and(|frame| frame.len() == rtu::MAX_ADU_LEN));
    assert_eq!(rtu::encode(UnitId(1), &[0; 254]), Err(rtu::AduError::TooLong(257)));
    assert!(ascii::encode(UnitId(1), &[0; 253]).is_ok_and(|frame| frame.len() == ascii::MAX_ADU_LEN));
    assert!(ascii::encode(UnitId(1), &[0; 254]).is_err());
}

#[test]
fn limits_of_coils_and_inputs() {
    let read = |quantity| Request::ReadCoils { address: 0, quantity }.encode();
    assert!(read(2000).is_ok());
    assert_eq!(read(2001), Err(PduError::Quantity { found: 2001, limit: 2000 }));
    assert_eq!(Request::decode(&[0x02, 0, 0, 0, 0]), Err(PduError::Quantity { found: 0, limit: 2000 }));
    let status = |bytes| Response::ReadDiscreteInputs { status: vec![0; bytes] }.encode();
    assert_eq!(status(250).unwrap().len(), 252);
    assert_eq!(status(251), Err(PduError::Quantity { found: 2008, limit: 2000 }));
    assert_eq!(status(0), Err(PduError::Quantity { found: 0, limit: 2000 }));
    assert_eq!(Response::decode(&[0x01, 0x00]), Err(PduError::Quantity { found: 0, limit: 2000 }));
    let write = |coils| Request::WriteMultipleCoils { address: 0, coils: vec![true; coils] }.encode();
    assert_eq!(write(1968).unwrap().len(), 252);
    assert_eq!(write(1969), Err(PduError::Quantity { found: 1969, limit: 1968 }));
    assert_eq!(write(100_000), Err(PduError::Quantity { found: 65535, limit: 1968 }));
    // Three coils in a byte whose fourth bit is set.
    assert_eq!(Request::decode(&[0x0F, 0, 0, 0, 3, 1, 0b1111]), Err(PduError::Padding { found: 0b1111 }));
    assert_eq!(Request::decode(&[0x0F, 0, 0, 0, 3, 2, 7, 0]), Err(PduError::ByteCount { found: 2, expected: 1 }));
    assert_eq!(Request::decode(&[0x0F, 0, 0, 0, 9, 2, 7]), Err(PduError::Length { found: 7, expected: 8 }));
    assert_eq!(Request::decode(&[0x0F, 0, 0, 0]), Err(PduError::Length { found: 4, expected: 7 }));
    assert_eq!(Request::decode(&[0x05, 0, 0, 1, 0]), Err(PduError::CoilValue { found: 0x0100 }));
}

#[test]
fn limits_of_registers_written_and_read_at_once() {
    let both = |read_quantity, written| {
        let values = vec![0; written];
        Request::ReadWriteMultipleRegisters { read_address: 0, read_quantity, write_address: 0, values }.encode()
    };
    assert_eq!(both(125, 121).unwrap().len(), 252);
    assert_eq!(both(126, 1), Err(PduError::Quantity { found: 126, limit: 125 }));
    assert_eq!(both(1, 122), Err(PduError::Quantity { found: 122, limit: 121 }));
    assert_eq!(both(1, 0), Err(PduError::Quantity { found: 0, limit: 121 }));
    let cut = [0x17, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0];
    assert_eq!(Request::decode(&cut), Err(PduError::Length { found: 11, expected: 12 }));
    assert_eq!(Response::decode(&[0x17, 3, 0, 0, 0]), Err(PduError::OddByteCount { found: 3 }));
    assert_eq!(Response::decode(&[0x16, 0, 0, 0, 0, 0]), Err(PduError::Length { found: 6, expected: 7 }));
}

#[test]
fn limits_of_queues_and_logs() {
    let queue = |count| Response::ReadFifoQueue { values: vec![0; count] }.encode();
    assert_eq!(queue(0).unwrap(), [0x18, 0, 2, 0, 0]);
    assert_eq!(queue(31).unwrap().len(), 67);
    assert_eq!(queue(32), Err(PduError::Count { found: 32, limit: 31 }));
    assert_eq!(Response::decode(&[0x18, 0, 4, 0, 1, 0]), Err(PduError::FifoByteCount { found: 4, expected: 3 }));
    assert_eq!(Response::decode(&[0x18, 0, 4, 0, 2, 0, 0]), Err(PduError::Length { found: 7, expected: 9 }));
    let log = |events| {
        Response::GetCommEventLog { status: 0, event_count: 0, message_count: 0, events: vec![0; events] }.encode()
    };
    assert_eq!(log(64).unwrap().len(), 72);
    assert_eq!(log(65), Err(PduError::Count { found: 65, limit: 64 }));
    assert_eq!(Response::decode(&[0x0C, 2, 0, 0]), Err(PduError::Length { found: 4, expected: 8 }));
}

#[test]
fn limits_of_file_records() {
    let read = |file_number, record_number, lengths: &[u16]| {
        let range = |length: &u16| FileRecordRange { file_number, record_number, record_length: *length };
        Request::ReadFileRecord { records: lengths.iter().map(range).collect() }.encode()
    };
    assert_eq!(read(1, 9999, &[124]).unwrap().len(), 9);
    assert_eq!(read(1, 0, &[125]), Err(PduError::ReplyTooLong { found: 254 }));
    assert_eq!(read(1, 0, &[1; 35]).unwrap().len(), 247);
    assert_eq!(read(1, 0, &[1; 36]), Err(PduError::TooLong));
    assert_eq!(read(0, 0, &[1]), Err(PduError::FileNumber));
    assert_eq!(read(1, 10_000, &[1]), Err(PduError::RecordNumber { found: 10_000 }));
    assert_eq!(read(1, 0, &[0]), Err(PduError::RecordLength { found: 0 }));
    assert_eq!(read(1, 0, &[]), Err(PduError::Length { found: 2, expected: 9 }));
    assert_eq!(Request::decode(&[0x14, 7, 5, 0, 1, 0, 0, 0, 1]), Err(PduError::ReferenceType { found: 5 }));
    assert_eq!(Request::decode(&[0x14, 3, 6, 0, 1]), Err(PduError::Length { found: 5, expected: 9 }));
    let write = |length| {
        let record = FileRecord { file_number: 1, record_number: 0, values: vec![0; length] };
        Request::WriteFileRecord { records: vec![record] }.encode()
    };
    assert_eq!(write(122).unwrap().len(), rtu::MAX_PDU_LEN);
    assert_eq!(write(123), Err(PduError::TooLong));
    let cut = [0x15, 9, 6, 0, 1, 0, 0, 0, 2, 0, 0];
    assert_eq!(Request::decode(&cut), Err(PduError::Length { found: 11, expected: 13 }));
    let contents = |length| Response::ReadFileRecord { records: vec![vec![0; length]] }.encode();
    assert_eq!(contents(124).unwrap().len(), 252);
    assert_eq!(contents(125), Err(PduError::TooLong));
    assert_eq!(contents(0), Err(PduError::RecordLength { found: 1 }));
    assert_eq!(Response::decode(&[0x14, 4, 4, 6, 0, 0]), Err(PduError::Length { found: 6, expected: 7 }));
    assert_eq!(Response::decode(&[0x14, 3, 2, 6, 0]), Err(PduError::RecordLength { found: 2 }));
}

#[test]
fn limits_of_diagnostics_and_identification() {
    let clear = |data| Request::Diagnostics { sub_function: SubFunction::CLEAR_COUNTERS, data }.encode();
    assert_eq!(clear(vec![0, 0]).unwrap(), [0x08, 0, 10, 0, 0]);
    assert_eq!(clear(vec![]), Err(PduError::Length { found: 3, expected: 5 }));
    let echo = |data| Request::Diagnostics { sub_function: SubFunction::RETURN_QUERY_DATA, data }.encode();
    assert_eq!(echo(vec![1; 250]).unwrap().len(), rtu::MAX_PDU_LEN);
    assert_eq!(echo(vec![1; 251]), Err(PduError::TooLong));
    assert_eq!(Request::decode(&[0x2B, 0x0E, 5, 0]), Err(PduError::DeviceIdCode { found: 5 }));
    assert_eq!(Request::decode(&[0x2B]), Err(PduError::Length { found: 1, expected: 2 }));
    let more = [0x2B, 0x0E, 1, 1, 1, 0, 0];
    assert_eq!(Response::decode(&more), Err(PduError::MoreFollows { found: 1 }));
    let short = [0x2B, 0x0E, 1, 1, 0, 0, 2, 0, 1, b'A', 1];
    assert_eq!(Response::decode(&short), Err(PduError::Length { found: 11, expected: 12 }));
    let long = [0x2B, 0x0E, 1, 1, 0, 0, 1, 0, 1, b'A', 1];
    assert_eq!(Response::decode(&long), Err(PduError::Length { found: 11, expected: 10 }));
}

#[test]
fn an_exception_has_no_top_bit_of_its_own() {
    let code = 2.into();
    assert_eq!(Response::Exception { function: 0x03, code }.encode().unwrap(), [0x83, 0x02]);
    let error = Err(PduError::FunctionCode { found: 0x83 });
    assert_eq!(Response::Exception { function: 0x83, code }.encode(), error);
    assert_eq!(Response::Other { function: 0x83, data: vec![] }.encode(), error);
    assert_eq!(Response::decode(&[0x83, 2, 0]), Err(PduError::Length { found: 3, expected: 2 }));
}

/// What may change something: a broadcast of it gets no answer, and it is not tried again by itself.
#[test]
fn writes() {
    let diagnostic = |code| Request::Diagnostics { sub_function: SubFunction(code), data: vec![0, 0] }.is_write();
    let clears: Vec<u16> = (0..=20).filter(|code| diagnostic(*code) && SubFunction(*code).is_known()).collect();
    assert_eq!(clears, [1, 3, 4, 10, 20]);
    assert!(diagnostic(21));
    assert!(!Request::ReadFifoQueue { address: 0 }.is_write());
    assert!(Request::MaskWriteRegister { address: 0, and_mask: 0, or_mask: 0 }.is_write());
    let values = vec![1];
    let both = Request::ReadWriteMultipleRegisters { read_address: 0, read_quantity: 1, write_address: 0, values };
    assert!(both.is_write());
    assert_eq!((both.address(), both.quantity()), (Some(0), Some(1)));
    assert!(Request::Other { function: 0x41, data: vec![] }.is_write());
}

#[test]
fn an_answer_to_something_else_is_not_accepted() {
    let echo =
        |sub_function, byte| Response::Diagnostics { sub_function: SubFunction(sub_function), data: vec![0, byte] };
    let ask = |sub_function| Request::Diagnostics { sub_function: SubFunction(sub_function), data: vec![0, 1] };
    assert!(ask(0).accepts(&echo(0, 1)) && !ask(0).accepts(&echo(0, 2)));
    assert!(ask(11).accepts(&echo(11, 2)) && !ask(11).accepts(&echo(12, 1)));
    assert!(!ask(4).accepts(&echo(4, 1)), "a device that only listens answers nothing");
    let identify = |code: u8, object| Request::ReadDeviceIdentification { code: code.try_into().unwrap(), object };
    let identified = |code: u8, id| Response::ReadDeviceIdentification {
        code: code.try_into().unwrap(),
        conformity: 0x81,
        more_follows: false,
        next_object: 0,
        objects: vec![DeviceIdObject { id, value: vec![] }],
    };
    assert!(identify(1, 5).accepts(&identified(1, 0)), "a stream from an unknown object starts from the first");
    assert!(identify(4, 5).accepts(&identified(4, 5)) && !identify(4, 5).accepts(&identified(4, 0)));
    assert!(!identify(1, 0).accepts(&identified(2, 0)));
    let mei = |mei| Request::Other { function: 0x2B, data: vec![mei, 0] };
    assert!(mei(0x0D).accepts(&Response::Other { function: 0x2B, data: vec![0x0D] }));
    assert!(!mei(0x0D).accepts(&Response::Other { function: 0x2B, data: vec![0x0F] }));
    assert!(mei(0x0E).accepts(&identified(1, 0)) && !mei(0x0D).accepts(&identified(1, 0)));
    let raw = Request::Other { function: 0x03, data: vec![0, 0, 0, 0] };
    assert!(raw.accepts(&Response::ReadHoldingRegisters { values: vec![1] }), "a known function sent raw");
}

/// Each differs from a right answer in one field.
#[test]
fn every_echoed_field_and_every_quantity_counts() {
    let refuses = |request: &Request, wrong: &[Response]| {
        assert!(request.accepts(&answer(request).unwrap()));
        for response in wrong {
            assert!(!request.accepts(response), "{request:?}: {response:?}");
        }
    };
    let read = Request::ReadCoils { address: 1, quantity: 9 };
    refuses(
        &read,
        &[
            Response::ReadCoils { status: vec![0; 1] },
            Response::ReadCoils { status: vec![0; 3] },
            Response::ReadDiscreteInputs { status: vec![0; 2] },
        ],
    );
    let read = Request::ReadInputRegisters { address: 1, quantity: 2 };
    refuses(
        &read,
        &[Response::ReadInputRegisters { values: vec![0; 3] }, Response::ReadHoldingRegisters { values: vec![0; 2] }],
    );
    let coil = Request::WriteSingleCoil { address: 1, on: true };
    let wrong = |address, on| Response::WriteSingleCoil { address, on };
    refuses(&coil, &[wrong(2, true), wrong(1, false)]);
    let single = Request::WriteSingleRegister { address: 1, value: 2 };
    let wrong = |address, value| Response::WriteSingleRegister { address, value };
    refuses(&single, &[wrong(2, 2), wrong(1, 1)]);
    let coils = Request::WriteMultipleCoils { address: 1, coils: vec![true; 3] };
    let wrong = |address, quantity| Response::WriteMultipleCoils { address, quantity };
    refuses(&coils, &[wrong(2, 3), wrong(1, 2), Response::WriteMultipleRegisters { address: 1, quantity: 3 }]);
    let registers = Request::WriteMultipleRegisters { address: 1, values: vec![7; 3] };
    let wrong = |address, quantity| Response::WriteMultipleRegisters { address, quantity };
    refuses(&registers, &[wrong(2, 3), wrong(1, 2)]);
    let range = |record_length| FileRecordRange { file_number: 1, record_number: 2, record_length };
    let file = Request::ReadFileRecord { records: vec![range(1), range(2)] };
    let wrong = |lengths: &[usize]| Response::ReadFileRecord {
        records: lengths.iter().map(|length| vec![0; *length]).collect(),
    };
    refuses(&file, &[wrong(&[2, 1]), wrong(&[1]), wrong(&[1, 2, 1])]);
    let record = |file_number, record_number, value| FileRecord { file_number, record_number, values: vec![value] };
    let file = Request::WriteFileRecord { records: vec![record(1, 2, 3)] };
    let wrong = |record| Response::WriteFileRecord { records: vec![record] };
    refuses(&file, &[wrong(record(2, 2, 3)), wrong(record(1, 3, 3)), wrong(record(1, 2, 4))]);
    let mask = Request::MaskWriteRegister { address: 1, and_mask: 2, or_mask: 3 };
    let wrong = |address, and_mask, or_mask| Response::MaskWriteRegister { address, and_mask, or_mask };
    refuses(&mask, &[wrong(2, 2, 3), wrong(1, 3, 3), wrong(1, 2, 4)]);
    let values = vec![1; 5];
    let both = Request::ReadWriteMultipleRegisters { read_address: 1, read_quantity: 2, write_address: 3, values };
    refuses(&both, &[Response::ReadWriteMultipleRegisters { values: vec![0; 5] }]);
    let code = 1.into();
    refuses(&Request::ReportServerId, &[Response::Exception { function: 0x12, code }]);
}

#[test]
fn faults_of_ascii_frames() {
    use ascii::AduError::{BadLrc, NoColon, NoLineEnd, NotHex, OddDigits, TooLong, TooShort};
    let decode = |frame: &[u8]| ascii::decode(frame).map(|adu| adu.pdu);
    assert_eq!(decode(b":010300310001CA\r\n").unwrap(), [3, 0, 0x31, 0, 1]);
    assert_eq!(decode(b""), Err(NoColon));
    assert_eq!(decode(b"010300310001CA\r\n"), Err(NoColon));
    assert_eq!(decode(b":010300310001CA\n\r"), Err(NoLineEnd));
    assert_eq!(decode(b":\r\n"), Err(TooShort(3)));
    assert_eq!(decode(b":01FF\r\n"), Err(TooShort(7)));
    assert_eq!(decode(b":010300310001C\r\n"), Err(OddDigits));
    assert_eq!(decode(b":010300G10001CA\r\n"), Err(NotHex { position: 7 }));
    assert_eq!(decode(b":010300310001CB\r\n"), Err(BadLrc { found: 0xCB, expected: 0xCA }));
    let longest = ascii::encode(UnitId(1), &[0x41; 253]).unwrap();
    assert_eq!(decode(&longest).unwrap().len(), 253);
    let longer = [b":00", &longest[1..]].concat();
    assert_eq!(decode(&longer), Err(TooLong(515)));
    assert_eq!(ascii::encode(UnitId(1), &[]), Err(TooShort(7)));
}

proptest! {
    #[test]
    fn requests_round_trip(request in requests(), unit: u8) {
        let pdu = request.encode().unwrap();
        prop_assert_eq!(Request::decode(&pdu), Ok(request.clone()));
        prop_assert_eq!(pdu[0], request.function());
        prop_assert!(request.response_pdu_len().is_none_or(|len| (2..=rtu::MAX_PDU_LEN).contains(&len)));
        let frame = rtu::encode(UnitId(unit), &pdu).unwrap();
        let adu = rtu::decode(&frame).unwrap();
        prop_assert_eq!((adu.unit, adu.pdu), (UnitId(unit), pdu.as_slice()));
        let frame = ascii::encode(UnitId(unit), &pdu).unwrap();
        let adu = ascii::decode(&frame).unwrap();
        prop_assert_eq!((adu.unit, adu.pdu.as_slice()), (UnitId(unit), pdu.as_slice()));
        let lower = ascii::decode(&frame.to_ascii_lowercase()).unwrap();
        prop_assert_eq!(lower.pdu, pdu);
    }

    #[test]
    fn responses_round_trip(response in responses()) {
        let pdu = response.encode().unwrap();
        prop_assert_eq!(pdu[0] & 0x7F, response.function());
        prop_assert_eq!(Response::decode(&pdu), Ok(response));
        prop_assert!(adu::encode(Mode::Rtu, UnitId(1), &pdu).is_some());
        prop_assert!(adu::encode(Mode::Ascii, UnitId(1), &pdu).is_some());
    }

    #[test]
    fn whatever_decodes_encodes_to_the_same_bytes(
        pdu in prop_oneof![4 => pdus(), 1 => prop::collection::vec(any::<u8>(), 0..300)]
    ) {
        if let Ok(request) = Request::decode(&pdu) {
            prop_assert_eq!(request.encode().unwrap(), pdu.clone());
        }
        if let Ok(response) = Response::decode(&pdu) {
            prop_assert_eq!(response.encode().unwrap(), pdu.clone());
        }
        let _ = (rtu::decode(&pdu), ascii::decode(&pdu));
    }

    #[test]
    fn a_right_answer_is_accepted_and_has_the_length_that_was_told(request in requests()) {
        prop_assert!(request.accepts(&refusal(&request)));
        let Some(response) = answer(&request) else {
            prop_assert_eq!(request.response_pdu_len(), None);
            return Ok(());
        };
        prop_assert!(request.accepts(&response));
        let len = response.encode().unwrap().len();
        prop_assert!(request.response_pdu_len().is_none_or(|told| told == len), "{len}");
    }

    /// The master waits for as many bytes as the request lets expect: nothing of another length may be accepted.
    #[test]
    fn nothing_of_another_length_or_function_is_accepted(request in requests(), response in responses()) {
        if request.accepts(&response) {
            prop_assert_eq!(request.function(), response.function());
            let refused = matches!(response, Response::Exception { .. });
            let len = response.encode().unwrap().len();
            prop_assert!(refused || request.response_pdu_len().is_none_or(|told| told == len));
        }
    }

    #[test]
    fn a_parity_bit_on_any_character_changes_nothing(request in requests(), parity in prop::collection::vec(any::<bool>(), 513)) {
        let pdu = request.encode().unwrap();
        let mut frame = ascii::encode(UnitId(7), &pdu).unwrap();
        for (character, parity) in frame.iter_mut().zip(parity) {
            *character |= u8::from(parity) << 7;
        }
        prop_assert_eq!(ascii::decode(&frame).unwrap().pdu, pdu);
    }

    #[test]
    fn a_single_wrong_bit_never_passes(pdu in prop::collection::vec(any::<u8>(), 1..60), bit in 0usize..10_000) {
        let mut frame = rtu::encode(UnitId(1), &pdu).unwrap();
        let bit = bit % (frame.len() * 8);
        frame[bit / 8] ^= 1 << (bit % 8);
        prop_assert!(rtu::decode(&frame).is_err());
    }
}
