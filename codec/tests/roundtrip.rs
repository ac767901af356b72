//! Encode and decode are inverse, and nothing panics on any bytes.

use buslens_codec::check::{crc16, lrc};
use buslens_codec::pdu::{PduError, Request, Response};
use buslens_codec::{UnitId, ascii, rtu};
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

fn requests() -> impl Strategy<Value = Request> {
    prop_oneof![
        (any::<u16>(), 1u16..=125).prop_map(|(address, quantity)| Request::ReadHoldingRegisters { address, quantity }),
        (any::<u16>(), 1u16..=125).prop_map(|(address, quantity)| Request::ReadInputRegisters { address, quantity }),
        (any::<u16>(), any::<bool>()).prop_map(|(address, on)| Request::WriteSingleCoil { address, on }),
        (any::<u16>(), any::<u16>()).prop_map(|(address, value)| Request::WriteSingleRegister { address, value }),
        (any::<u16>(), prop::collection::vec(any::<u16>(), 1..=123))
            .prop_map(|(address, values)| Request::WriteMultipleRegisters { address, values }),
        (0x41u8..=0x48, prop::collection::vec(any::<u8>(), 0..=252))
            .prop_map(|(function, data)| Request::Other { function, data }),
    ]
}

proptest! {
    #[test]
    fn requests_round_trip(request in requests(), unit: u8) {
        let pdu = request.encode().unwrap();
        prop_assert_eq!(Request::decode(&pdu).unwrap(), request);
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
    fn whatever_decodes_encodes_to_the_same_bytes(pdu in prop::collection::vec(any::<u8>(), 0..300)) {
        if let Ok(request) = Request::decode(&pdu) {
            prop_assert_eq!(request.encode().unwrap(), pdu.clone());
        }
        if let Ok(response) = Response::decode(&pdu) {
            prop_assert_eq!(response.encode().unwrap(), pdu.clone());
        }
        let _ = (rtu::decode(&pdu), ascii::decode(&pdu));
    }

    #[test]
    fn a_single_wrong_bit_never_passes(pdu in prop::collection::vec(any::<u8>(), 1..60), bit in 0usize..10_000) {
        let mut frame = rtu::encode(UnitId(1), &pdu).unwrap();
        let bit = bit % (frame.len() * 8);
        frame[bit / 8] ^= 1 << (bit % 8);
        prop_assert!(rtu::decode(&frame).is_err());
    }
}
