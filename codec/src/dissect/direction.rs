use crate::pdu::{EXCEPTION, Request, Response};

/// Which way a frame goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the master.
    Request,
    /// From a device.
    Response,
    /// It can be either: functions 05, 06, 08, 15 and 16 are answered by what looks like the request itself, some PDUs of 01,
    /// 02 and 17 have both shapes, and unknown functions any.
    Unknown,
}

/// Which way a PDU goes: as the caller says, else by its shape. An exception is always a response.
pub(super) fn direction_of(pdu: &[u8], hint: Direction) -> Direction {
    let Some(&function) = pdu.first() else { return hint };
    if function & EXCEPTION != 0 {
        return Direction::Response;
    }
    if hint != Direction::Unknown {
        return hint;
    }
    match (Request::decode(pdu).is_ok(), Response::decode(pdu).is_ok()) {
        (true, false) => Direction::Request,
        (false, true) => Direction::Response,
        (true, true) => Direction::Unknown,
        (false, false) => by_length(function, pdu),
    }
}

/// For what is neither a request nor a response of its function: what it resembles.
fn by_length(function: u8, pdu: &[u8]) -> Direction {
    let looks_like_request = match function {
        0x01..=0x04 => pdu.len() == 5,
        0x0B | 0x0C | 0x11 => pdu.len() == 1,
        0x0F | 0x10 => pdu.len() != 5,
        // The reference type of a request stands where a reply has an odd length.
        0x14 => pdu.get(2) == Some(&6),
        0x18 => pdu.len() == 3,
        0x2B => pdu.len() == 4,
        _ => return Direction::Unknown,
    };
    if looks_like_request { Direction::Request } else { Direction::Response }
}
