//! Every frame that the devices' manuals print, with what it means. The file holds facts: device, mode, direction, bytes,
//! meaning, and whether the check is right (one LRC is printed wrong).

use buslens_codec::dissect::{Check, Direction, dissect};
use buslens_codec::intake;
use buslens_codec::line::Mode;
use buslens_codec::pdu::{Request, Response};
use buslens_codec::stream::{PieceKind, Shape, split};
use buslens_codec::{adu, ascii, rtu};

struct Row {
    mode: Mode,
    direction: Direction,
    text: &'static str,
    check: &'static str,
}

fn rows() -> Vec<Row> {
    let rows = include_str!("data/manual_frames.csv").lines().skip(1);
    let rows = rows.map(|line| {
        let columns: Vec<&'static str> = line.split(',').collect();
        Row {
            mode: if columns[1] == "ascii" { Mode::Ascii } else { Mode::Rtu },
            direction: if columns[2] == "request" { Direction::Request } else { Direction::Response },
            text: columns[3],
            check: columns.last().unwrap(),
        }
    });
    rows.collect()
}

#[test]
fn every_frame_is_read_split_decoded_and_encoded_again() {
    assert_eq!(rows().len(), 25);
    for Row { mode, direction, text, check } in rows() {
        let intake = intake::read(text);
        assert_eq!((intake.segments[0].mode, intake.fault_count), (mode, 0), "{text}");
        let frame = intake.bytes;
        let taken = dissect(&frame, mode, Direction::Unknown, None, None).unwrap();
        if check == "bad_lrc_expected_CA" {
            assert_eq!(taken.check, Check::Lrc { found: 0xC1, expected: 0xCA });
            let pieces: Vec<_> = split(mode, &frame).collect();
            assert!(pieces.len() == 1 && pieces[0].kind == PieceKind::Noise, "{text}: {pieces:?}");
            continue;
        }
        assert!(taken.check.is_ok(), "{text}");
        assert!(taken.direction == direction || taken.direction == Direction::Unknown, "{text}: {:?}", taken.direction);
        assert_eq!(taken.fault, None, "{text}");
        let pieces: Vec<_> = split(mode, &frame).collect();
        assert_eq!(pieces.len(), 1, "{text}: {pieces:?}");
        assert_eq!(pieces[0].range, 0..frame.len(), "{text}");
        let told = if direction == Direction::Request { Shape::Request } else { Shape::Response };
        assert!([told, Shape::Either].map(PieceKind::Frame).contains(&pieces[0].kind), "{text}: {pieces:?}");
        let (unit, pdu) = match mode {
            Mode::Rtu => rtu::decode(&frame).map(|adu| (adu.unit, adu.pdu.to_vec())).unwrap(),
            Mode::Ascii => ascii::decode(&frame).map(|adu| (adu.unit, adu.pdu)).unwrap(),
        };
        let again = match direction {
            Direction::Request => Request::decode(&pdu).unwrap().encode(),
            _ => Response::decode(&pdu).unwrap().encode(),
        };
        assert_eq!(adu::encode(mode, unit, &again.unwrap()), Some(frame), "{text}");
    }
}
