//! Every request and every response that the standard allows, at random, and the answer that fits a request.

use buslens_codec::pdu::{
    DeviceIdCode, DeviceIdObject, ExceptionCode, FileRecord, FileRecordRange, Request, Response, SubFunction, pack_bits,
};
use proptest::collection::vec;
use proptest::prelude::*;

const KNOWN_SUB_FUNCTIONS: [u16; 15] = [0, 1, 2, 3, 4, 10, 11, 12, 13, 14, 15, 16, 17, 18, 20];

/// Function codes without a variant of their own.
fn other_functions() -> impl Strategy<Value = u8> {
    prop_oneof![Just(0u8), Just(0x09), Just(0x0A), Just(0x0D), Just(0x12), Just(0x19), 0x2Cu8..=0x7F]
}

fn words(least: usize, most: usize) -> impl Strategy<Value = Vec<u16>> {
    prop_oneof![vec(any::<u16>(), least..=most), vec(any::<u16>(), most)]
}

fn quantities(most: u16) -> impl Strategy<Value = u16> {
    prop_oneof![1..=most, Just(1), Just(most)]
}

fn diagnostics() -> impl Strategy<Value = (SubFunction, Vec<u8>)> {
    prop_oneof![
        vec(any::<u8>(), 0..=250).prop_map(|data| (SubFunction::RETURN_QUERY_DATA, data)),
        (prop::sample::select(&KNOWN_SUB_FUNCTIONS[1..]), any::<[u8; 2]>())
            .prop_map(|(code, data)| (SubFunction(code), data.to_vec())),
        (21u16.., vec(any::<u8>(), 0..=250)).prop_map(|(code, data)| (SubFunction(code), data)),
    ]
}

fn ranges() -> impl Strategy<Value = Vec<FileRecordRange>> {
    let range = |longest: u16| {
        (1u16.., 0u16..=9999, 1..=longest).prop_map(|(file_number, record_number, record_length)| FileRecordRange {
            file_number,
            record_number,
            record_length,
        })
    };
    prop_oneof![vec(range(124), 1), vec(range(2), 1..=35), vec(range(20), 1..=5)]
}

fn records() -> impl Strategy<Value = Vec<FileRecord>> {
    let record = |longest| {
        (1u16.., 0u16..=9999, words(1, longest)).prop_map(|(file_number, record_number, values)| FileRecord {
            file_number,
            record_number,
            values,
        })
    };
    prop_oneof![vec(record(122), 1), vec(record(1), 1..=27), vec(record(20), 1..=5)]
}

fn device_id_codes() -> impl Strategy<Value = DeviceIdCode> {
    prop::sample::select(vec![
        DeviceIdCode::Basic,
        DeviceIdCode::Regular,
        DeviceIdCode::Extended,
        DeviceIdCode::Specific,
    ])
}

fn objects() -> impl Strategy<Value = Vec<DeviceIdObject>> {
    let object =
        |longest| (any::<u8>(), vec(any::<u8>(), 0..=longest)).prop_map(|(id, value)| DeviceIdObject { id, value });
    prop_oneof![vec(object(244), 0..=1), vec(object(0), 0..=123), vec(object(20), 0..=11)]
}

/// A function without a variant, or an MEI type without one.
fn other() -> impl Strategy<Value = (u8, Vec<u8>)> {
    let mei = any::<u8>().prop_filter("device identification", |mei| *mei != 0x0E);
    prop_oneof![
        (other_functions(), vec(any::<u8>(), 0..=252)),
        (mei, vec(any::<u8>(), 0..=251)).prop_map(|(mei, data)| (0x2B, [vec![mei], data].concat())),
    ]
}

/// Every request.
pub(crate) fn requests() -> impl Strategy<Value = Request> {
    prop_oneof![
        (any::<u16>(), quantities(2000)).prop_map(|(address, quantity)| Request::ReadCoils { address, quantity }),
        (any::<u16>(), quantities(2000))
            .prop_map(|(address, quantity)| Request::ReadDiscreteInputs { address, quantity }),
        (any::<u16>(), quantities(125))
            .prop_map(|(address, quantity)| Request::ReadHoldingRegisters { address, quantity }),
        (any::<u16>(), quantities(125))
            .prop_map(|(address, quantity)| Request::ReadInputRegisters { address, quantity }),
        (any::<u16>(), any::<bool>()).prop_map(|(address, on)| Request::WriteSingleCoil { address, on }),
        (any::<u16>(), any::<u16>()).prop_map(|(address, value)| Request::WriteSingleRegister { address, value }),
        Just(Request::ReadExceptionStatus),
        diagnostics().prop_map(|(sub_function, data)| Request::Diagnostics { sub_function, data }),
        Just(Request::GetCommEventCounter),
        Just(Request::GetCommEventLog),
        (any::<u16>(), prop_oneof![vec(any::<bool>(), 1..=20), vec(any::<bool>(), 1..=1968)])
            .prop_map(|(address, coils)| Request::WriteMultipleCoils { address, coils }),
        (any::<u16>(), words(1, 123)).prop_map(|(address, values)| Request::WriteMultipleRegisters { address, values }),
        Just(Request::ReportServerId),
        ranges().prop_map(|records| Request::ReadFileRecord { records }),
        records().prop_map(|records| Request::WriteFileRecord { records }),
        any::<(u16, u16, u16)>().prop_map(|(address, and_mask, or_mask)| Request::MaskWriteRegister {
            address,
            and_mask,
            or_mask
        }),
        (any::<u16>(), quantities(125), any::<u16>(), words(1, 121)).prop_map(
            |(read_address, read_quantity, write_address, values)| Request::ReadWriteMultipleRegisters {
                read_address,
                read_quantity,
                write_address,
                values
            }
        ),
        any::<u16>().prop_map(|address| Request::ReadFifoQueue { address }),
        (device_id_codes(), any::<u8>()).prop_map(|(code, object)| Request::ReadDeviceIdentification { code, object }),
        other().prop_map(|(function, data)| Request::Other { function, data }),
    ]
}

/// Every response.
pub(crate) fn responses() -> impl Strategy<Value = Response> {
    let status = || prop_oneof![vec(any::<u8>(), 1..=250), vec(any::<u8>(), 250)];
    let codes =
        prop_oneof![Just(1u8), Just(2), Just(3), Just(4), Just(5), Just(6), Just(8), Just(10), Just(11), any::<u8>()];
    prop_oneof![
        status().prop_map(|status| Response::ReadCoils { status }),
        status().prop_map(|status| Response::ReadDiscreteInputs { status }),
        words(1, 125).prop_map(|values| Response::ReadHoldingRegisters { values }),
        words(1, 125).prop_map(|values| Response::ReadInputRegisters { values }),
        (any::<u16>(), any::<bool>()).prop_map(|(address, on)| Response::WriteSingleCoil { address, on }),
        (any::<u16>(), any::<u16>()).prop_map(|(address, value)| Response::WriteSingleRegister { address, value }),
        any::<u8>().prop_map(|status| Response::ReadExceptionStatus { status }),
        diagnostics().prop_map(|(sub_function, data)| Response::Diagnostics { sub_function, data }),
        any::<(u16, u16)>().prop_map(|(status, event_count)| Response::GetCommEventCounter { status, event_count }),
        (any::<(u16, u16, u16)>(), vec(any::<u8>(), 0..=64)).prop_map(
            |((status, event_count, message_count), events)| Response::GetCommEventLog {
                status,
                event_count,
                message_count,
                events
            }
        ),
        (any::<u16>(), quantities(1968))
            .prop_map(|(address, quantity)| Response::WriteMultipleCoils { address, quantity }),
        (any::<u16>(), quantities(123))
            .prop_map(|(address, quantity)| Response::WriteMultipleRegisters { address, quantity }),
        vec(any::<u8>(), 0..=251).prop_map(|data| Response::ReportServerId { data }),
        prop_oneof![vec(words(1, 124), 1), vec(words(1, 2), 1..=35), vec(words(1, 20), 1..=5)]
            .prop_map(|records| Response::ReadFileRecord { records }),
        records().prop_map(|records| Response::WriteFileRecord { records }),
        any::<(u16, u16, u16)>().prop_map(|(address, and_mask, or_mask)| Response::MaskWriteRegister {
            address,
            and_mask,
            or_mask
        }),
        words(1, 125).prop_map(|values| Response::ReadWriteMultipleRegisters { values }),
        words(0, 31).prop_map(|values| Response::ReadFifoQueue { values }),
        (device_id_codes(), any::<(u8, bool, u8)>(), objects()).prop_map(
            |(code, (conformity, more_follows, next_object), objects)| Response::ReadDeviceIdentification {
                code,
                conformity,
                more_follows,
                next_object,
                objects
            }
        ),
        (0u8..0x80, codes).prop_map(|(function, code)| Response::Exception { function, code: code.into() }),
        other().prop_map(|(function, data)| Response::Other { function, data }),
    ]
}

/// PDUs in either direction, whole or slightly damaged: a byte changed, cut off or added.
pub(crate) fn pdus() -> impl Strategy<Value = Vec<u8>> {
    let whole = prop_oneof![
        requests().prop_map(|request| request.encode().unwrap()),
        responses().prop_map(|response| response.encode().unwrap()),
    ];
    (whole, any::<(u8, prop::sample::Index, u8)>()).prop_map(|(mut pdu, (damage, at, value))| {
        let at = at.index(pdu.len());
        match damage % 8 {
            0 => pdu[at] = value,
            1 => pdu.truncate(at),
            2 => pdu.push(value),
            3 => pdu.insert(at, value),
            4 => pdu.truncate(at.min(8)),
            5 if pdu.len() > 4 => pdu[at % 5] = value,
            _ => {}
        }
        pdu
    })
}

/// A right answer with some values; `None` for what is never answered.
pub(crate) fn answer(request: &Request) -> Option<Response> {
    let values = |quantity: u16| (0..quantity).map(|value| value.wrapping_mul(0x0101)).collect::<Vec<u16>>();
    let status = |quantity: u16| pack_bits(&(0..quantity).map(|bit| bit % 3 == 0).collect::<Vec<bool>>());
    Some(match request.clone() {
        Request::ReadCoils { quantity, .. } => Response::ReadCoils { status: status(quantity) },
        Request::ReadDiscreteInputs { quantity, .. } => Response::ReadDiscreteInputs { status: status(quantity) },
        Request::ReadHoldingRegisters { quantity, .. } => Response::ReadHoldingRegisters { values: values(quantity) },
        Request::ReadInputRegisters { quantity, .. } => Response::ReadInputRegisters { values: values(quantity) },
        Request::WriteSingleCoil { address, on } => Response::WriteSingleCoil { address, on },
        Request::WriteSingleRegister { address, value } => Response::WriteSingleRegister { address, value },
        Request::ReadExceptionStatus => Response::ReadExceptionStatus { status: 0x6D },
        Request::Diagnostics { sub_function: SubFunction::FORCE_LISTEN_ONLY, .. } => return None,
        Request::Diagnostics { sub_function, data } if sub_function.is_echoed() => {
            Response::Diagnostics { sub_function, data }
        }
        Request::Diagnostics { sub_function, .. } => Response::Diagnostics { sub_function, data: vec![0x01, 0x02] },
        Request::GetCommEventCounter => Response::GetCommEventCounter { status: 0xFFFF, event_count: 0x0108 },
        Request::GetCommEventLog => Response::GetCommEventLog {
            status: 0,
            event_count: 0x0108,
            message_count: 0x0121,
            events: vec![0x20, 0x00],
        },
        Request::WriteMultipleCoils { address, coils } => {
            Response::WriteMultipleCoils { address, quantity: u16::try_from(coils.len()).unwrap() }
        }
        Request::WriteMultipleRegisters { address, values } => {
            Response::WriteMultipleRegisters { address, quantity: u16::try_from(values.len()).unwrap() }
        }
        Request::ReportServerId => Response::ReportServerId { data: vec![0x12, 0xFF, 0x34] },
        Request::ReadFileRecord { records } => {
            Response::ReadFileRecord { records: records.iter().map(|range| values(range.record_length)).collect() }
        }
        Request::WriteFileRecord { records } => Response::WriteFileRecord { records },
        Request::MaskWriteRegister { address, and_mask, or_mask } => {
            Response::MaskWriteRegister { address, and_mask, or_mask }
        }
        Request::ReadWriteMultipleRegisters { read_quantity, .. } => {
            Response::ReadWriteMultipleRegisters { values: values(read_quantity) }
        }
        Request::ReadFifoQueue { .. } => Response::ReadFifoQueue { values: values(2) },
        Request::ReadDeviceIdentification { code, object } => Response::ReadDeviceIdentification {
            code,
            conformity: 0x81,
            more_follows: false,
            next_object: 0,
            objects: vec![DeviceIdObject { id: object, value: b"Company".to_vec() }],
        },
        Request::Other { function, data } => Response::Other { function, data },
    })
}

/// A refusal of a request.
pub(crate) fn refusal(request: &Request) -> Response {
    Response::Exception { function: request.function(), code: ExceptionCode::IllegalDataAddress }
}
