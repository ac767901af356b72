use alloc::string::{String, ToString};
use alloc::vec;

use super::*;
use crate::pdu::Response;
use crate::rtu;

/// A line of a log: its mark, its time in milliseconds if it has one, its frames.
type Line<'a> = (char, Option<u64>, &'a [Vec<u8>]);

fn read(lines: &[Line<'_>]) -> Transcript {
    let mut transcript = Transcript::new();
    for (number, (mark, time_ms, frames)) in lines.iter().enumerate() {
        let direction = match mark {
            '>' => Direction::Request,
            '<' => Direction::Response,
            _ => Direction::Unknown,
        };
        let segment = Segment {
            start: usize::try_from(transcript.stream_len()).unwrap(),
            mode: Mode::Rtu,
            direction,
            time_us: time_ms.map(|time| time * 1000),
            line: u32::try_from(number).unwrap() + 1,
            ..Segment::default()
        };
        transcript.push(&frames.concat(), &[segment]);
    }
    transcript.finish();
    transcript
}

/// One letter a frame (`q` request, `r` response, `e` echo, `?` unknown, `-` noise), a star for a wrong check, and the pair.
fn shown(transcript: &Transcript) -> Vec<String> {
    let show = |entry: &Entry| {
        let letter = match (entry.kind, entry.direction) {
            (EntryKind::Noise, _) => "-",
            _ if entry.echo => "e",
            (_, Direction::Request) => "q",
            (_, Direction::Response) => "r",
            (_, Direction::Unknown) => "?",
        };
        let star = if entry.kind == EntryKind::Frame && !entry.check_ok { "*" } else { "" };
        let pair = entry.pair.map(|pair| pair.to_string()).unwrap_or_default();
        [letter, star, &pair].concat()
    };
    transcript.entries().map(|entry| show(&entry)).collect()
}

fn all(frames: &[Vec<u8>]) -> Vec<String> {
    shown(&read(&[(' ', None, frames)]))
}

fn frame(unit: u8, pdu: &[u8]) -> Vec<u8> {
    rtu::encode(UnitId(unit), pdu).unwrap()
}

fn ask(unit: u8, address: u16, quantity: u16) -> Vec<u8> {
    frame(unit, &Request::ReadHoldingRegisters { address, quantity }.encode().unwrap())
}

fn answer(unit: u8, values: &[u16]) -> Vec<u8> {
    frame(unit, &Response::ReadHoldingRegisters { values: values.to_vec() }.encode().unwrap())
}

fn write(value: u16) -> Vec<u8> {
    frame(1, &Request::WriteSingleRegister { address: 0x800, value }.encode().unwrap())
}

fn exception(unit: u8, function: u8) -> Vec<u8> {
    frame(unit, &[function | 0x80, 2])
}

fn damaged(mut frame: Vec<u8>) -> Vec<u8> {
    frame[3] ^= 0x10;
    frame
}

#[test]
fn requests_and_responses_alternate() {
    assert_eq!(all(&[ask(1, 0, 1), answer(1, &[7]), ask(1, 1, 2), answer(1, &[7, 8])]), ["q1", "r0", "q3", "r2"]);
    assert_eq!(all(&[ask(1, 0, 1), ask(2, 0, 1), answer(2, &[7])]), ["q", "q2", "r1"]);
    assert_eq!(all(&[answer(1, &[7]), ask(1, 0, 1)]), ["r", "q"]);
}

#[test]
fn a_response_fits_its_request() {
    // Unit, function and byte count.
    assert_eq!(all(&[ask(1, 0, 1), answer(2, &[7])]), ["q", "r"]);
    assert_eq!(all(&[ask(1, 0, 1), answer(1, &[7, 8])]), ["q", "r"]);
    assert_eq!(all(&[ask(1, 0, 2), ask(1, 0, 1), answer(1, &[7, 8])]), ["q2", "q", "r0"]);
    // The broadcast address on either side.
    assert_eq!(all(&[ask(0, 0x30, 1), answer(1, &[1])]), ["q1", "r0"]);
    assert_eq!(all(&[ask(1, 0x30, 1), exception(0, 3)]), ["q1", "r0"]);
    assert_eq!(all(&[ask(1, 0x30, 1), exception(1, 4)]), ["q", "r"]);
}

#[test]
fn a_byte_count_that_does_not_fit_is_told() {
    let transcript = read(&[(' ', None, &[ask(1, 0, 1), answer(1, &[7, 8])])]);
    assert_eq!(transcript.diagnoses(1), [Diagnosis::ByteCountMismatch { found: 4, expected: 2 }]);
    let contradiction = frame(1, &[3, 4, 0, 7]);
    let transcript = read(&[(' ', None, &[ask(1, 0, 1), contradiction])]);
    assert_eq!(shown(&transcript), ["q", "r"]);
    assert_eq!(transcript.diagnoses(1), [Diagnosis::ByteCountMismatch { found: 4, expected: 2 }]);
}

#[test]
fn the_last_retry_gets_the_answer() {
    let again = [('>', None), ('>', None), ('>', None)].map(|(mark, time)| (mark, time, ask(1, 0, 1)));
    let mut lines: Vec<Line<'_>> =
        again.iter().map(|(mark, time, frame)| (*mark, *time, core::slice::from_ref(frame))).collect();
    let answers = [answer(1, &[7])];
    lines.push(('<', None, &answers));
    let transcript = read(&lines);
    assert_eq!(shown(&transcript), ["q", "q", "q3", "r2"]);
    assert!(!transcript.entry(0).unwrap().repeated && transcript.entry(2).unwrap().repeated);
    assert!(transcript.entry(0).unwrap().is_unanswered() && !transcript.entry(2).unwrap().is_unanswered());
    // Without marks: by their number, or by their times.
    let three = [ask(1, 0, 1), ask(1, 0, 1), ask(1, 0, 1), answer(1, &[7])];
    assert_eq!(all(&three), ["q", "q", "q3", "r2"]);
    let [first, second] = [[ask(1, 0, 1)], [ask(1, 0, 1)]];
    let at = |ms| read(&[(' ', Some(0), &first), (' ', Some(ms), &second), (' ', Some(ms + 20), &answers)]);
    assert_eq!(shown(&at(1000)), ["q", "q2", "r1"]);
    assert_eq!(shown(&at(3)), ["q2", "e", "r0"]);
}

#[test]
fn the_echo_of_a_read_is_recognised() {
    let transcript = read(&[(' ', None, &[ask(1, 0, 1), ask(1, 0, 1), answer(1, &[7])])]);
    assert_eq!(shown(&transcript), ["q2", "e", "r0"]);
    assert_eq!(transcript.diagnoses(1), [Diagnosis::Echo]);
    let sent = [ask(1, 0, 1)];
    let heard = [ask(1, 0, 1), answer(1, &[7])];
    assert_eq!(shown(&read(&[('>', None, &sent), ('<', None, &heard)])), ["q2", "e", "r0"]);
    assert_eq!(shown(&read(&[('>', None, &sent), ('<', None, &heard[..1])])), ["q", "e"]);
}

#[test]
fn of_two_equal_writes_the_second_is_the_answer_and_of_three_the_third() {
    let writes = vec![write(5); 5];
    assert_eq!(all(&writes[..1]), ["q"]);
    assert_eq!(all(&writes[..2]), ["q1", "r0"]);
    assert_eq!(all(&writes[..3]), ["q2", "e", "r0"]);
    assert_eq!(all(&writes[..4]), ["q1", "r0", "q3", "r2"]);
    assert_eq!(all(&writes), ["q1", "r0", "q4", "e", "r2"]);
    // Where reads have shown that the adapter hears itself, six are two writes.
    let mut stream = vec![ask(1, 0, 1), ask(1, 0, 1), answer(1, &[7])];
    stream.extend(vec![write(5); 6]);
    assert_eq!(all(&stream), ["q2", "e", "r0", "q5", "e", "r3", "q8", "e", "r6"]);
    assert_eq!(shown(&read(&[('>', None, &writes[..1]), ('<', None, &writes[..2])])), ["q2", "e", "r0"]);
    assert_eq!(shown(&read(&[('>', None, &writes[..1]), ('<', None, &writes[..1])])), ["q1", "r0"]);
    assert_eq!(shown(&read(&[('>', None, &writes[..1]), ('>', None, &writes[..1])])), ["q", "q"]);
    assert_eq!(all(&[write(5), write(6)]), ["q", "q"]);
}

#[test]
fn an_echo_before_an_exception_is_no_answer() {
    assert_eq!(all(&[write(5), write(5), exception(1, 6)]), ["q2", "e", "r0"]);
}

#[test]
fn a_damaged_response_is_joined_to_its_request() {
    assert_eq!(all(&[ask(1, 0, 2), damaged(answer(1, &[7, 8])), ask(1, 0, 1)]), ["q1", "r*0", "q"]);
    assert_eq!(all(&[damaged(ask(1, 0, 1)), ask(1, 0, 1), answer(1, &[7])]), ["q*", "q2", "r1"]);
    // Cut off behind three bytes.
    let cut_off = answer(1, &[7, 8])[..3].to_vec();
    assert_eq!(all(&[ask(1, 0, 2), cut_off]), ["q1", "r*0"]);
}

#[test]
fn shape_tells_more_than_marks() {
    // A listener marks everything as received.
    let heard = [ask(1, 0, 1), answer(1, &[7])];
    assert_eq!(shown(&read(&[('<', None, &heard)])), ["q1", "r0"]);
}

#[test]
fn lines_and_times_are_those_of_the_source() {
    let (first, second) = ([ask(1, 0, 1)], [answer(1, &[7]), vec![0xFF]]);
    let transcript = read(&[('>', Some(10), &first), ('<', Some(25), &second)]);
    let seen: Vec<_> = transcript.entries().map(|entry| (entry.line, entry.time_us, entry.offset)).collect();
    assert_eq!(seen, [(1, Some(10_000), 0), (2, Some(25_000), 8), (2, Some(25_000), 15)]);
}

#[test]
fn noise_is_cut_at_lines_and_no_frame_crosses_a_change_of_direction() {
    let noise = [vec![0xFF, 0x00, 0xFE]];
    assert_eq!(shown(&read(&[(' ', None, &noise), (' ', None, &noise)])), ["-", "-"]);
    let request = ask(1, 0, 0x60);
    let halves = [[request[..4].to_vec()], [request[4..].to_vec()]];
    assert_eq!(shown(&read(&[(' ', None, &halves[0]), (' ', None, &halves[1])])), ["q"]);
    assert_eq!(shown(&read(&[('>', None, &halves[0]), ('<', None, &halves[1])])), ["q*", "-"]);
}

#[test]
fn every_line_of_damaged_frames_is_a_frame() {
    let [first, second] = [[damaged(ask(1, 0, 1))], [damaged(ask(1, 1, 1))]];
    assert_eq!(shown(&read(&[('>', None, &first), ('>', None, &second)])), ["q*", "q*"]);
}

#[test]
fn reserved_units_and_exceptions_are_told() {
    let transcript = read(&[(' ', None, &[ask(250, 0, 1), exception(250, 3)])]);
    assert_eq!(transcript.diagnoses(0), [Diagnosis::UnitReserved { unit: 250 }]);
    let expected = [Diagnosis::Exception { code: 2 }, Diagnosis::UnitReserved { unit: 250 }];
    assert_eq!(transcript.diagnoses(1), expected);
}

#[test]
fn a_zero_behind_a_frame_is_noise() {
    // The check of a frame with a zero behind it is right, too.
    let mut reply = answer(1, &[7]);
    reply.push(0);
    assert!(rtu::decode(&reply).is_ok());
    assert_eq!(all(&[ask(1, 0, 1), reply.clone(), ask(1, 0, 1)]), ["q1", "r0", "-", "q"]);
    assert_eq!(all(&[ask(1, 0, 1), reply]), ["q1", "r0", "-"]);
}

/// Noise costs a bounded amount of work: each of these would take minutes if a search went through all of it for each byte.
#[test]
fn noise_of_the_worst_kind_ends() {
    let header = [1, 0x10, 0, 0, 0, 0x7B, 0xF6];
    let mut stream = [ask(1, 0, 1), header.repeat(20_000)].concat();
    stream.extend(ask(1, 0, 1));
    let transcript = read(&[(' ', None, &[stream.clone()])]);
    assert_eq!(transcript.entries().last().map(|entry| entry.end()), Some(stream.len() as u64));
    assert!(transcript.entries().last().is_some_and(|entry| entry.check_ok));
}
