use std::sync::LazyLock;

use buslens_codec::dissect::{Direction, Dissection, dissect};
use buslens_codec::line::Mode;
use buslens_codec::outline::Outline;
use buslens_codec::pdu::{PduError, Request, Response, SubFunction};
use buslens_codec::profile::{BUILT_IN, Profile};
use buslens_codec::stream::{PieceKind, Shape, split};
use buslens_codec::{UnitId, adu, rtu};

use super::input::Input;

/// The built-in profiles.
pub(super) static PROFILES: LazyLock<Vec<Profile>> =
    LazyLock::new(|| BUILT_IN.iter().map(|text| Profile::from_json(text).unwrap()).collect());

/// A byte for the unit id, a request with its length before it, a response.
pub(super) fn what_decodes_encodes(data: &[u8]) {
    let mut input = Input(data);
    let unit = UnitId(input.byte());
    let (request, response) = (input.counted(), input.0);
    let asked = Request::decode(request).ok();
    let answered = Response::decode(response).ok();
    if let Some(asked) = &asked {
        is_request(unit, request, asked);
    }
    if let Some(answered) = &answered {
        assert_eq!(answered.encode().as_deref(), Ok(response));
        assert_eq!(answered.function(), response[0] & 0x7F);
    }
    if let (Some(asked), Some(answered)) = (&asked, &answered) {
        fit(asked, answered, unit, response);
    }
    // Each in both roles, for nothing stops a device or a master from sending anything.
    for pdu in [request, response] {
        for direction in [Direction::Unknown, Direction::Request, Direction::Response] {
            for mode in [Mode::Rtu, Mode::Ascii] {
                let Some(frame) = adu::encode(mode, unit, pdu) else { continue };
                for profile in PROFILES.iter().map(Some).chain([None]) {
                    let found = dissect(&frame, mode, direction, asked.as_ref(), profile).unwrap();
                    covers(&found, &frame);
                    assert!(found.check.is_ok());
                    assert_eq!((found.unit, found.function), (unit, pdu[0] & 0x7F));
                    assert!(found.points.iter().all(|named| named.range.end <= frame.len()));
                }
            }
        }
    }
}

fn is_request(unit: UnitId, pdu: &[u8], asked: &Request) {
    assert_eq!(asked.encode().as_deref(), Ok(pdu));
    assert_eq!(asked.function(), pdu[0]);
    assert!(asked.response_pdu_len().is_none_or(|len| (2..=rtu::MAX_PDU_LEN).contains(&len)));
    if pdu[0] >= 0x80 {
        // Sent on purpose; on the line it looks like a refusal.
        return;
    }
    let frame = rtu::encode(unit, pdu).unwrap();
    let found = dissect(&frame, Mode::Rtu, Direction::Request, None, None).unwrap();
    assert_eq!((found.direction, found.fault), (Direction::Request, None));
    assert_eq!((found.address, found.quantity), (asked.address(), asked.quantity()));
    let outline = Outline::of_rtu(&frame, Shape::Request).unwrap();
    assert_eq!((outline.unit, outline.function), (unit, pdu[0]));
    let outlined = !matches!(asked, Request::Other { .. });
    assert!(!outlined || outline.address == asked.address());
    // The search for frames knows where it ends: there, or at a shorter length with a right check. Where the function does
    // not tell its length, a frame of another one that happens to stand within may be found instead.
    let told = match asked {
        Request::Diagnostics { sub_function, data } => *sub_function != SubFunction(0) && data.len() == 2,
        Request::Other { .. } => false,
        _ => true,
    };
    if told {
        let first = split(Mode::Rtu, &frame).next().unwrap();
        let found = first.range.start == 0 && matches!(first.kind, PieceKind::Frame(_));
        assert!(found, "{first:?} {frame:02X?}");
    }
}

/// What is accepted has the function and the length that were expected, and is no fault.
fn fit(asked: &Request, answered: &Response, unit: UnitId, response: &[u8]) {
    let refused = matches!(answered, Response::Exception { .. });
    let frame = rtu::encode(unit, response).unwrap();
    let fault = dissect(&frame, Mode::Rtu, Direction::Response, Some(asked), None).unwrap().fault;
    if asked.accepts(answered) {
        assert_eq!(asked.function(), answered.function());
        assert!(refused || asked.response_pdu_len().is_none_or(|len| len == response.len()));
        assert!(matches!(fault, None | Some(PduError::Padding { .. })), "{fault:?}");
    } else {
        assert!(asked.function() != answered.function() || fault.is_some());
    }
}

/// Every byte of the frame belongs to exactly one field, in order.
pub(super) fn covers(found: &Dissection, frame: &[u8]) {
    let mut at = 0;
    for field in &found.fields {
        assert!(field.range.start == at && field.range.end > at, "{:?}", found.fields);
        at = field.range.end;
    }
    assert_eq!(at, frame.len());
}
