//! Frames that another implementation encoded (`data/make_vectors.py`), with the fields that went in: they decode to these
//! fields, and these fields encode to the same bytes, in both modes.

use std::collections::BTreeMap;

use buslens_codec::dissect::{Direction, dissect};
use buslens_codec::line::Mode;
use buslens_codec::pdu::{
    DeviceIdCode, DeviceIdObject, FileRecord, FileRecordRange, Request, Response, SubFunction, pack_bits,
};
use buslens_codec::{UnitId, adu, ascii, rtu};

struct Row {
    function: u8,
    direction: Direction,
    unit: UnitId,
    rtu: Vec<u8>,
    ascii: Vec<u8>,
    fields: Fields,
}

/// `name=value` pairs.
struct Fields(BTreeMap<&'static str, &'static str>);

fn rows() -> impl Iterator<Item = Row> {
    let lines = include_str!("data/pymodbus_vectors.csv").lines();
    lines.filter(|line| !line.starts_with('#')).skip(1).map(|line| {
        let [function, direction, unit, rtu, ascii, fields] = line.split(',').collect::<Vec<_>>().try_into().unwrap();
        Row {
            function: u8::from_str_radix(function, 16).unwrap(),
            direction: match direction {
                "request" => Direction::Request,
                "response" => Direction::Response,
                other => panic!("{other}"),
            },
            unit: UnitId(unit.parse().unwrap()),
            rtu: hex(rtu),
            ascii: [ascii.as_bytes(), b"\r\n"].concat(),
            fields: Fields(fields.split(';').filter_map(|field| field.split_once('=')).collect()),
        }
    })
}

fn hex(text: &str) -> Vec<u8> {
    assert!(text.len().is_multiple_of(2));
    (0..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap()).collect()
}

fn words(text: &str) -> Vec<u16> {
    text.split_ascii_whitespace().map(|word| word.parse().unwrap()).collect()
}

impl Fields {
    fn text(&self, name: &str) -> &'static str {
        self.0[name]
    }

    fn number<N: TryFrom<u32>>(&self, name: &str) -> N {
        let number: u32 = self.text(name).parse().unwrap();
        N::try_from(number).ok().unwrap()
    }

    fn words(&self, name: &str) -> Vec<u16> {
        words(self.text(name))
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        hex(self.text(name))
    }

    fn bits(&self) -> Vec<bool> {
        self.text("bits").bytes().map(|bit| bit == b'1').collect()
    }

    fn sub_function(&self) -> SubFunction {
        SubFunction(self.number("sub_function"))
    }

    fn code(&self) -> DeviceIdCode {
        DeviceIdCode::try_from(self.number::<u8>("code")).unwrap()
    }

    fn ranges(&self) -> Vec<FileRecordRange> {
        let range = |text: &str| {
            let [file_number, record_number, record_length] =
                text.split(':').map(|number| number.parse().unwrap()).collect::<Vec<_>>().try_into().unwrap();
            FileRecordRange { file_number, record_number, record_length }
        };
        self.text("records").split(' ').map(range).collect()
    }

    fn written(&self) -> Vec<FileRecord> {
        let record = |text: &str| {
            let [file, record, values] = text.split(':').collect::<Vec<_>>().try_into().unwrap();
            FileRecord {
                file_number: file.parse().unwrap(),
                record_number: record.parse().unwrap(),
                values: words(values),
            }
        };
        self.text("written").split('/').map(record).collect()
    }

    fn objects(&self) -> Vec<DeviceIdObject> {
        let object = |text: &str| {
            let (id, value) = text.split_once(':').unwrap();
            DeviceIdObject { id: id.parse().unwrap(), value: hex(value) }
        };
        self.text("objects").split_ascii_whitespace().map(object).collect()
    }

    fn request(&self, function: u8) -> Request {
        let (address, quantity) = (|| self.number("address"), || self.number("quantity"));
        match function {
            0x01 => Request::ReadCoils { address: address(), quantity: quantity() },
            0x02 => Request::ReadDiscreteInputs { address: address(), quantity: quantity() },
            0x03 => Request::ReadHoldingRegisters { address: address(), quantity: quantity() },
            0x04 => Request::ReadInputRegisters { address: address(), quantity: quantity() },
            0x05 => Request::WriteSingleCoil { address: address(), on: self.number::<u8>("on") == 1 },
            0x06 => Request::WriteSingleRegister { address: address(), value: self.number("value") },
            0x07 => Request::ReadExceptionStatus,
            0x08 => Request::Diagnostics { sub_function: self.sub_function(), data: self.bytes("data") },
            0x0B => Request::GetCommEventCounter,
            0x0C => Request::GetCommEventLog,
            0x0F => Request::WriteMultipleCoils { address: address(), coils: self.bits() },
            0x10 => Request::WriteMultipleRegisters { address: address(), values: self.words("values") },
            0x11 => Request::ReportServerId,
            0x14 => Request::ReadFileRecord { records: self.ranges() },
            0x15 => Request::WriteFileRecord { records: self.written() },
            0x16 => Request::MaskWriteRegister {
                address: address(),
                and_mask: self.number("and_mask"),
                or_mask: self.number("or_mask"),
            },
            0x17 => Request::ReadWriteMultipleRegisters {
                read_address: self.number("read_address"),
                read_quantity: self.number("read_quantity"),
                write_address: self.number("write_address"),
                values: self.words("values"),
            },
            0x18 => Request::ReadFifoQueue { address: address() },
            0x2B => Request::ReadDeviceIdentification { code: self.code(), object: self.number("object") },
            other => panic!("{other:02X}"),
        }
    }

    fn response(&self, function: u8) -> Response {
        let (address, quantity) = (|| self.number("address"), || self.number("quantity"));
        match function {
            0x01 => Response::ReadCoils { status: pack_bits(&self.bits()) },
            0x02 => Response::ReadDiscreteInputs { status: pack_bits(&self.bits()) },
            0x03 => Response::ReadHoldingRegisters { values: self.words("values") },
            0x04 => Response::ReadInputRegisters { values: self.words("values") },
            0x05 => Response::WriteSingleCoil { address: address(), on: self.number::<u8>("on") == 1 },
            0x06 => Response::WriteSingleRegister { address: address(), value: self.number("value") },
            0x07 => Response::ReadExceptionStatus { status: self.number("status") },
            0x08 => Response::Diagnostics { sub_function: self.sub_function(), data: self.bytes("data") },
            0x0B => {
                Response::GetCommEventCounter { status: self.number("status"), event_count: self.number("event_count") }
            }
            0x0C => Response::GetCommEventLog {
                status: self.number("status"),
                event_count: self.number("event_count"),
                message_count: self.number("message_count"),
                events: self.bytes("events"),
            },
            0x0F => Response::WriteMultipleCoils { address: address(), quantity: quantity() },
            0x10 => Response::WriteMultipleRegisters { address: address(), quantity: quantity() },
            0x11 => Response::ReportServerId { data: self.bytes("data") },
            0x14 => Response::ReadFileRecord { records: self.text("contents").split('/').map(words).collect() },
            0x15 => Response::WriteFileRecord { records: self.written() },
            0x16 => Response::MaskWriteRegister {
                address: address(),
                and_mask: self.number("and_mask"),
                or_mask: self.number("or_mask"),
            },
            0x17 => Response::ReadWriteMultipleRegisters { values: self.words("values") },
            0x18 => Response::ReadFifoQueue { values: self.words("values") },
            0x2B => Response::ReadDeviceIdentification {
                code: self.code(),
                conformity: self.number("conformity"),
                more_follows: self.number::<u8>("more") == 0xFF,
                next_object: self.number("next"),
                objects: self.objects(),
            },
            0x80.. => Response::Exception { function: function & 0x7F, code: self.number::<u8>("exception").into() },
            other => panic!("{other:02X}"),
        }
    }
}

#[test]
fn frames_decode_to_their_fields_and_fields_encode_to_their_frames() {
    for row in rows() {
        let at = String::from_utf8_lossy(&row.ascii).into_owned();
        let pdu = rtu::decode(&row.rtu).unwrap().pdu.to_vec();
        let from_ascii = ascii::decode(&row.ascii).unwrap();
        assert_eq!((from_ascii.unit, &from_ascii.pdu), (row.unit, &pdu), "{at}");
        let again = if row.direction == Direction::Request {
            let expected = row.fields.request(row.function);
            assert_eq!(Request::decode(&pdu).as_ref(), Ok(&expected), "{at}");
            expected.encode().unwrap()
        } else {
            let expected = row.fields.response(row.function);
            assert_eq!(Response::decode(&pdu).as_ref(), Ok(&expected), "{at}");
            expected.encode().unwrap()
        };
        assert_eq!(adu::encode(Mode::Rtu, row.unit, &again).unwrap(), row.rtu, "{at}");
        assert_eq!(adu::encode(Mode::Ascii, row.unit, &again).unwrap(), row.ascii, "{at}");
    }
}

#[test]
fn frames_are_dissected_without_fault_and_never_taken_for_the_other_direction() {
    for row in rows() {
        for (mode, frame) in [(Mode::Rtu, &row.rtu), (Mode::Ascii, &row.ascii)] {
            let found = dissect(frame, mode, Direction::Unknown, None, None).unwrap();
            let at = String::from_utf8_lossy(&row.ascii).into_owned();
            assert!(found.check.is_ok(), "{at}");
            assert_eq!(found.fault, None, "{at}");
            assert!([row.direction, Direction::Unknown].contains(&found.direction), "{at}");
            let told = dissect(frame, mode, row.direction, None, None).unwrap();
            assert_eq!((told.direction, told.fault), (row.direction, None), "{at}");
            assert_eq!(told.function, row.function & 0x7F, "{at}");
            if let Some(values) = row.fields.0.get("values") {
                assert_eq!(told.registers, words(values), "{at}");
            }
            if row.fields.0.contains_key("bits") {
                let bits = row.fields.bits();
                assert_eq!(told.bits[..bits.len()], bits, "{at}");
                assert!(told.bits[bits.len()..].iter().all(|bit| !bit), "{at}");
            }
        }
    }
}

/// The file has every function in both directions, each more than once where it has fields.
#[test]
fn every_function_is_there() {
    let functions = [
        0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x08, 0x0B, 0x0C, 0x0F, 0x10, 0x11, 0x14, 0x15, 0x16, 0x17, 0x18,
        0x2B,
    ];
    for function in functions {
        let count = |direction| rows().filter(|row| row.function == function && row.direction == direction).count();
        let bare = matches!(function, 0x07 | 0x0B | 0x0C | 0x11);
        assert!(count(Direction::Request) >= if bare { 1 } else { 3 }, "{function:02X}");
        assert!(count(Direction::Response) >= 3, "{function:02X}");
        assert_eq!(rows().filter(|row| row.function == function | 0x80).count(), 10, "{function:02X}");
    }
    let sub_functions: Vec<u16> = (0..=20).filter(|code| SubFunction(*code).is_known()).collect();
    for code in sub_functions {
        let has = |direction| {
            rows().any(|row| {
                row.function == 0x08 && row.direction == direction && row.fields.sub_function() == SubFunction(code)
            })
        };
        assert!(has(Direction::Request), "{code}");
        // Force listen only is never answered.
        assert_eq!(has(Direction::Response), code != 4, "{code}");
    }
}
