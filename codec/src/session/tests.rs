use alloc::string::ToString;
use alloc::vec;
use alloc::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::intake::{Form, IntakeFault, read};
use crate::line::{DataBits, Parity, StopBits};
use crate::segment::{Origin, Segment};
use crate::transcript::Transcript;

const SESSION: &str = "\
Buslens session 1
epoch 1714557693482000
line 9600 8E1 rtu
# what was polled
0.000000 opened 115200 8N1 rtu

0.120034 0.009167 TX poll 01 04 00 02 00 04 50 09
0.1523 0.011458 RX - 01 04 08 00 00 01 1D 00 7B 01 C8 B9 C1 * \"4.\\u{2028}\\\"\u{4F4D}\\n\"
7.000000 lost
- 0.000000 ?? - ascii 3A 30 31
";

#[test]
fn a_session_tells_all_that_it_holds() {
    let found = read(SESSION);
    assert_eq!((found.form, found.fault_count), (Form::Session, 0));
    assert_eq!(found.bytes.len(), 8 + 13 + 3);
    let entry = |start, line| Segment { start, line, whole: true, ..Segment::default() };
    let sent = Segment { direction: Direction::Request, origin: Origin::Poll, ..entry(0, 7) };
    let heard = Segment { direction: Direction::Response, ..entry(8, 8) };
    assert_eq!(
        found.segments,
        [
            Segment { time_us: Some(120_034), span_us: 9167, ..sent },
            Segment { time_us: Some(152_300), span_us: 11_458, ..heard },
            Segment { mode: Mode::Ascii, ..entry(21, 10) },
        ]
    );
    let line = |baud, parity| LineSettings::new(baud, parity);
    let opened = Event::Opened(line(115_200, Parity::None), Mode::Rtu);
    assert_eq!(
        found.remarks,
        [
            Remark::new(0, Told::Epoch(1_714_557_693_482_000)),
            Remark::new(0, Told::Line(line(9600, Parity::Even), Mode::Rtu)),
            Remark::new(0, Told::Event { at_us: 0, event: opened }),
            Remark::new(8, Told::Mark("4.\u{2028}\"\u{4F4D}\n".to_string())),
            Remark::new(21, Told::Event { at_us: 7_000_000, event: Event::Lost }),
        ]
    );
}

#[test]
fn what_makes_no_sense_is_told_with_its_place() {
    for (line, column, character) in [
        ("nonsense", 1, 'n'),
        ("1.5 later", 5, 'l'),
        ("1.5 0.0 TX me 01", 12, 'm'),
        ("1.5 0.0 UP poll 01", 9, 'U'),
        ("1.5 0.0 TX poll 01 0", 20, '0'),
        ("1.5 0.0 TX poll 01 * \u{4F4D}", 22, '\u{4F4D}'),
        ("1.5 0.0 TX poll 01 * \"\u{4F4D}\" 2", 26, '2'),
        ("1.5 0.0 TX poll 01 * \"\\x\"", 23, '\\'),
        ("1.5 0.0 TX poll 01 * \"", 23, ' '),
        ("1.5 0.0 TX poll", 16, ' '),
        ("1.5 5000.0 TX poll 01", 5, '5'),
        ("1.5 opened 0 8N1 rtu", 12, '0'),
        ("1.5 opened 9600 8X1 rtu", 17, '8'),
        ("1.5 break 5000000000", 10, ' '),
        ("epoch +1", 7, '+'),
        ("1.1234567 closed", 1, '1'),
    ] {
        let found = read(&[TITLE, line, "2.0 0.0 RX - 07"].join("\n"));
        let places: Vec<_> = found.faults.iter().map(|fault| (fault.line, fault.column, fault.fault)).collect();
        assert_eq!(places, [(2, column, IntakeFault::Unexpected(character))], "{line}");
        assert_eq!(found.bytes, [7], "{line}");
    }
}

fn any_line() -> impl Strategy<Value = (LineSettings, Mode)> {
    let data_bits = prop_oneof![Just(DataBits::Seven), Just(DataBits::Eight)];
    let parity = prop_oneof![Just(Parity::None), Just(Parity::Odd), Just(Parity::Even)];
    let stop_bits = prop_oneof![Just(StopBits::One), Just(StopBits::Two)];
    let mode = prop_oneof![Just(Mode::Rtu), Just(Mode::Ascii)];
    (1u32.., data_bits, parity, stop_bits, mode).prop_map(|(baud, data_bits, parity, stop_bits, mode)| {
        (LineSettings { baud, data_bits, parity, stop_bits }, mode)
    })
}

fn any_event() -> impl Strategy<Value = Event> {
    prop_oneof![
        Just(Event::LineError),
        any::<u32>().prop_map(Event::Break),
        any_line().prop_map(|(line, mode)| Event::Opened(line, mode)),
        Just(Event::Closed),
        Just(Event::Lost),
        any::<u64>().prop_map(Event::Forgotten),
    ]
}

fn any_segment() -> impl Strategy<Value = Segment> {
    let mode = prop_oneof![Just(Mode::Rtu), Just(Mode::Ascii)];
    let direction = prop_oneof![Just(Direction::Unknown), Just(Direction::Request), Just(Direction::Response)];
    let origin = prop::sample::select(Origin::ALL.to_vec());
    let time_us = prop::option::of(0..u64::MAX / 2);
    (mode, direction, origin, time_us, any::<u32>()).prop_map(|(mode, direction, origin, time_us, span_us)| {
        // Without a beginning there is no end.
        let span_us = if time_us.is_some() { span_us } else { 0 };
        Segment { mode, direction, origin, time_us, span_us, whole: true, ..Segment::default() }
    })
}

proptest! {
    /// Whatever is written is read again, and reading and writing it once more changes no byte.
    #[test]
    fn nothing_is_lost(
        epoch_us in prop::option::of(any::<u64>()),
        line in prop::option::of(any_line()),
        entries in prop::collection::vec(
            (
                prop::collection::vec((0..u64::MAX / 2, any_event()), 0..3),
                any_segment(),
                prop::collection::vec(any::<u8>(), 1..20),
                prop::option::of(any::<String>()),
            ),
            1..20,
        ),
    ) {
        let mut transcript = Transcript::new();
        let mut text = String::new();
        let mut remarks = Vec::new();
        write_head(&mut text, epoch_us, line);
        remarks.extend(epoch_us.map(|epoch| Remark::new(0, Told::Epoch(epoch))));
        remarks.extend(line.map(|(line, mode)| Remark::new(0, Told::Line(line, mode))));
        let mut at = 0;
        for (index, (events, segment, bytes, mark)) in entries.iter().enumerate() {
            for (at_us, event) in events {
                write_event(&mut text, *at_us, *event);
                remarks.push(Remark::new(at, Told::Event { at_us: *at_us, event: *event }));
            }
            transcript.append(bytes, segment);
            let entry = transcript.entry(index).unwrap();
            prop_assert_eq!((entry.time_us, entry.span_us), (segment.time_us, segment.span_us));
            write_entry(&mut text, &entry, transcript.entry_bytes(index), mark.as_deref());
            remarks.extend(mark.clone().map(|mark| Remark::new(at, Told::Mark(mark))));
            at += bytes.len();
        }
        let found = read(&text);
        prop_assert_eq!((found.form, &found.faults), (Form::Session, &vec![]), "{}", text);
        prop_assert_eq!(found.remarks, remarks);
        let mut again = Transcript::new();
        again.push(&found.bytes, &found.segments);
        prop_assert_eq!(again.end(), entries.len());
        for (index, (_, segment, bytes, _)) in entries.iter().enumerate() {
            let (one, other) = (transcript.entry(index).unwrap(), again.entry(index).unwrap());
            prop_assert_eq!(crate::transcript::Entry { line: 0, ..other }, one);
            prop_assert_eq!((one.mode, one.mark, one.origin), (segment.mode, segment.direction, segment.origin));
            prop_assert_eq!(again.entry_bytes(index), bytes.as_slice());
        }
    }

    #[test]
    fn any_text_can_be_read(lines in prop::collection::vec("[0-9.]{0,4} ?[0-9.]{0,4} ?(TX|RX)? ?(poll|-)? ?([0-9A-F]{2} )*(\\* \".*)?", 0..8)) {
        let found = read(&[TITLE, &lines.join("\n")].join("\n"));
        prop_assert_eq!(found.form, Form::Session);
        prop_assert_eq!(found.bytes.is_empty(), found.segments.is_empty());
    }
}
