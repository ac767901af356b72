//! Streams of every kind come apart as they were put together.

use alloc::vec;
use alloc::vec::Vec;

use proptest::prelude::*;
use proptest::sample::Index;

use super::*;
use crate::UnitId;
use crate::check::is_right;

/// A PDU and what a frame with it is, for every public function, as request and as reply, and for exceptions.
fn pdus() -> impl Strategy<Value = (Vec<u8>, Shape)> {
    let word = any::<u16>;
    let words = |most| prop::collection::vec(any::<u16>(), 1..=most);
    let bytes = |range| prop::collection::vec(any::<u8>(), range);
    let head = |function: u8, a: u16, b: u16| [&[function][..], &a.to_be_bytes(), &b.to_be_bytes()].concat();
    let be = |words: &[u16]| words.iter().flat_map(|word| word.to_be_bytes()).collect::<Vec<u8>>();
    let len = |bytes: &[u8]| u8::try_from(bytes.len()).unwrap();
    let counted = move |function: u8, bytes: Vec<u8>| [&[function, len(&bytes)][..], &bytes].concat();
    let group = move |data: &[u16]| [&[len(&be(data)) + 1, 6][..], &be(data)].concat();
    let asked = (any::<[u16; 3]>()).prop_map(move |at| [&[6][..], &be(&at)].concat());
    let written = (any::<[u16; 2]>(), words(20))
        .prop_map(move |(at, data)| [&[6][..], &be(&at), &[0, u8::try_from(data.len()).unwrap()], &be(&data)].concat());
    let object = (any::<u8>(), bytes(0..40)).prop_map(move |(id, text)| [&[id, len(&text)][..], &text].concat());
    let requests = prop_oneof![
        (1u8..=4, word(), 1u16..=125).prop_map(move |(function, at, count)| head(function, at, count)),
        prop_oneof![Just(0x07u8), Just(0x0B), Just(0x0C), Just(0x11)].prop_map(|function| vec![function]),
        (word(), 1u16..=1968, any::<u8>()).prop_map(move |(at, coils, fill)| {
            let count = usize::from(coils.div_ceil(8));
            [head(0x0F, at, coils), vec![u8::try_from(count).unwrap()], vec![fill; count]].concat()
        }),
        (word(), words(123)).prop_map(move |(at, values)| {
            let count = u16::try_from(values.len()).unwrap();
            [head(0x10, at, count), vec![len(&be(&values))], be(&values)].concat()
        }),
        prop::collection::vec(asked, 1..=35).prop_map(move |groups| counted(0x14, groups.concat())),
        (word(), 1u16..=125, word(), words(121)).prop_map(move |(from, count, to, values)| {
            let write = u16::try_from(values.len()).unwrap();
            [head(0x17, from, count), be(&[to, write]), vec![len(&be(&values))], be(&values)].concat()
        }),
        word().prop_map(move |at| [&[0x18][..], &at.to_be_bytes()].concat()),
        (1u8..=4, any::<u8>()).prop_map(|(code, object)| vec![0x2B, 0x0E, code, object]),
    ];
    let replies = prop_oneof![
        (1u8..=2, bytes(1..251)).prop_map(move |(function, bits)| counted(function, bits)),
        (prop_oneof![Just(0x03u8), Just(0x04), Just(0x17)], words(125))
            .prop_map(move |(function, values)| counted(function, be(&values))),
        any::<u8>().prop_map(|status| vec![0x07, status]),
        (word(), word()).prop_map(move |(status, count)| head(0x0B, status, count)),
        bytes(6..71).prop_map(move |log| counted(0x0C, log)),
        (0x0Fu8..=0x10, word(), 1u16..=123).prop_map(move |(function, at, count)| head(function, at, count)),
        bytes(1..101).prop_map(move |text| counted(0x11, text)),
        prop::collection::vec(words(15).prop_map(move |data| group(&data)), 1..=7)
            .prop_map(move |groups| counted(0x14, groups.concat())),
        prop::collection::vec(word(), 0..=31).prop_map(move |values| {
            let count = u16::try_from(values.len()).unwrap();
            [vec![0x18], be(&[2 * count + 2, count]), be(&values)].concat()
        }),
        (1u8..=4, prop::collection::vec(object, 0..=5)).prop_map(|(code, objects)| {
            let count = u8::try_from(objects.len()).unwrap();
            [vec![0x2B, 0x0E, code, 0x82, 0x00, 0x00, count], objects.concat()].concat()
        }),
        (0x81u8..=0xFF, any::<u8>()).prop_map(|(function, code)| vec![function, code]),
    ];
    let echoes = prop_oneof![
        (word(), any::<bool>()).prop_map(move |(at, on)| head(0x05, at, if on { 0xFF00 } else { 0 })),
        (word(), word()).prop_map(move |(at, value)| head(0x06, at, value)),
        (1u16..=20, word()).prop_map(move |(sub, data)| head(0x08, sub, data)),
        prop::collection::vec(written, 1..=3).prop_map(move |groups| counted(0x15, groups.concat())),
        any::<[u16; 3]>().prop_map(move |words| [&[0x16][..], &be(&words)].concat()),
    ];
    prop_oneof![
        requests.prop_map(|pdu| (pdu, Shape::Request)),
        replies.prop_map(|pdu| (pdu, Shape::Response)),
        echoes.prop_map(|pdu| (pdu, Shape::Either)),
    ]
}

fn rtu(unit: u8, pdu: &[u8]) -> Vec<u8> {
    crate::rtu::encode(UnitId(unit), pdu).unwrap()
}

fn ascii(unit: u8, pdu: &[u8]) -> Vec<u8> {
    crate::ascii::encode(UnitId(unit), pdu).unwrap()
}

fn frames() -> impl Strategy<Value = Vec<(Vec<u8>, Shape)>> {
    prop::collection::vec((1u8..=247, pdus()).prop_map(|(unit, (pdu, shape))| (rtu(unit, &pdu), shape)), 1..12)
}

fn pieces(mode: Mode, bytes: &[u8]) -> Vec<Piece> {
    split(mode, bytes).collect()
}

fn frame(range: Range<usize>, shape: Shape) -> Piece {
    Piece { range, kind: PieceKind::Frame(shape) }
}

fn noise(range: Range<usize>) -> Piece {
    Piece { range, kind: PieceKind::Noise }
}

/// Whether any bytes that begin in `range` and go over its end have a right check by chance.
fn is_unlucky(bytes: &[u8], range: Range<usize>) -> bool {
    range.clone().any(|from| {
        let crcs = bytes[from..].iter().take(256).scan(0xFFFF, |crc, byte| {
            *crc = crate::check::step(*crc, *byte);
            Some(*crc)
        });
        crcs.skip(range.end - from).any(|crc| crc == 0)
    })
}

/// A frame that has a right check for a shorter length too.
fn frame_with_a_right_check_inside(count: u8) -> Vec<u8> {
    let begin = rtu(1, &[0x03, count, 7, 7, 7]);
    let values = (0..count - 5).map(|at| at ^ 0x35);
    let frame = rtu(1, &begin.iter().copied().chain(values).skip(1).collect::<Vec<u8>>());
    assert!(is_right(&frame) && is_right(&frame[..8]));
    frame
}

proptest! {
    #[test]
    fn glued_frames_come_apart(frames in frames()) {
        let stream: Vec<u8> = frames.iter().flat_map(|(frame, _)| frame.clone()).collect();
        let mut at = 0;
        let mut found = split(Mode::Rtu, &stream);
        for (frame, shape) in frames {
            let piece = found.next().unwrap();
            prop_assert_eq!(&piece.range, &(at..at + frame.len()));
            at = piece.range.end;
            match piece.kind {
                // A file or a list of bits can look like its request.
                PieceKind::Frame(Shape::Either) if matches!(frame[1], 1 | 2 | 0x14 | 0x17) => {}
                kind => prop_assert_eq!(kind, PieceKind::Frame(shape)),
            }
        }
        prop_assert_eq!(found.next(), None);
    }

    #[test]
    fn the_borders_of_chunks_mean_nothing(
        mode in prop_oneof![Just(Mode::Rtu), Just(Mode::Ascii)],
        parts in prop::collection::vec(prop_oneof![
            pdus().prop_map(|(pdu, _)| rtu(1, &pdu)),
            pdus().prop_map(|(pdu, _)| ascii(1, &pdu)),
            prop::collection::vec(any::<u8>(), 0..20),
            (0x41u8..0x48, prop::collection::vec(any::<u8>(), 0..20)).prop_map(|(own, data)| rtu(1, &[&[own][..], &data].concat())),
            (6u8..60).prop_map(|half| frame_with_a_right_check_inside(half * 2)),
            Just(vec![0x01, 0x10, 0x00, 0x00, 0x00, 0x7B, 0xF6]),
        ], 0..8),
        cuts in prop::collection::vec(1usize..40, 1..30),
    ) {
        let stream = parts.concat();
        let whole = pieces(mode, &stream);
        let mut splitter = Splitter::new(mode);
        let mut found: Vec<Piece> = vec![];
        let mut at = 0;
        let mut rest = stream.as_slice();
        for cut in cuts.iter().cycle() {
            let (chunk, after) = rest.split_at((*cut).min(rest.len()));
            splitter.push(chunk);
            rest = after;
            if rest.is_empty() { splitter.finish(); }
            while let Some(Found { offset, bytes, kind }) = splitter.next_piece() {
                prop_assert_eq!(offset, at as u64);
                let range = at..at + bytes.len();
                prop_assert_eq!(bytes, &stream[range.clone()]);
                at = range.end;
                found.push(Piece { range, kind });
            }
            if rest.is_empty() { break; }
            prop_assert!(stream.len() - rest.len() - at <= 512 + MAX_NOISE_LEN);
        }
        prop_assert_eq!(&found, &whole);
    }

    #[test]
    fn pieces_cover_any_stream(
        mode in prop_oneof![Just(Mode::Rtu), Just(Mode::Ascii)],
        bytes in prop_oneof![
            prop::collection::vec(any::<u8>(), 0..1500),
            prop::collection::vec(0u8..0x18, 0..1500),
            prop::collection::vec(prop_oneof![Just(b':'), Just(b'0'), Just(b'\r'), Just(b'\n'), Just(b'\n' | 0x80)], 0..1500),
        ],
    ) {
        let mut at = 0;
        for piece in split(mode, &bytes) {
            prop_assert_eq!(piece.range.start, at);
            prop_assert!(piece.range.end > at);
            at = piece.range.end;
            let is_frame = match mode {
                Mode::Rtu => is_right(&bytes[piece.range]),
                Mode::Ascii => crate::ascii::decode(&bytes[piece.range]).is_ok(),
            };
            prop_assert!(is_frame || piece.kind == PieceKind::Noise);
        }
        prop_assert_eq!(at, bytes.len());
    }

    #[test]
    fn a_frame_after_noise_is_found(
        noise in prop_oneof![
            prop::collection::vec(0x80u8..=0xFF, 0..50),
            prop::collection::vec(any::<u8>(), 0..50),
            // What claims to be a long frame.
            prop::collection::vec(prop_oneof![Just(vec![1, 3, 0xFA]), Just(vec![1, 0x14, 0xF5]),
                Just(vec![1, 0x10, 0, 0, 0, 0x7B, 0xF6])], 0..6).prop_map(|parts| parts.concat()),
        ],
        (pdu, _) in pdus(),
    ) {
        let frame = rtu(1, &pdu);
        let stream = [noise.clone(), frame].concat();
        let clean = noise.is_empty();
        // Noise of an unknown function at the very start is looked through for a right check.
        prop_assume!(clean || !is_unlucky(&stream, 0..noise.len()));
        let last = split(Mode::Rtu, &stream).last().unwrap();
        prop_assert_eq!(last.range, noise.len()..stream.len());
        prop_assert!(last.kind != PieceKind::Noise);
    }

    #[test]
    fn a_wrong_bit_costs_one_frame(frames in frames(), at in any::<Index>(), bit in 0u8..8) {
        let mut stream: Vec<u8> = frames.iter().flat_map(|(frame, _)| frame.clone()).collect();
        let at = at.index(stream.len());
        stream[at] ^= 1 << bit;
        let mut start = 0;
        let ranges: Vec<_> = frames.iter().map(|(frame, _)| { start += frame.len(); start - frame.len()..start }).collect();
        let broken = ranges.iter().find(|range| range.contains(&at)).unwrap().clone();
        prop_assume!(!is_unlucky(&stream, broken.clone()));
        let found: Vec<Range<usize>> =
            split(Mode::Rtu, &stream).filter(|piece| piece.kind != PieceKind::Noise).map(|piece| piece.range).collect();
        for range in ranges {
            prop_assert_eq!(found.contains(&range), range != broken);
        }
    }
}

#[test]
fn a_right_check_inside_a_frame_is_no_end() {
    let long = frame_with_a_right_check_inside(20);
    assert_eq!(pieces(Mode::Rtu, &long), [frame(0..25, Shape::Response)]);
    let two = [long.clone(), rtu(1, &[0x83, 2])].concat();
    assert_eq!(pieces(Mode::Rtu, &two), [frame(0..25, Shape::Response), frame(25..30, Shape::Response)]);
}

/// A request, its reply, and bytes that make the check right for the length that the request would have as a reply. What
/// stands after that length does not count.
#[test]
fn of_two_right_lengths_the_one_before_a_frame_counts() {
    let stream = [rtu(1, &[0x03, 20, 0, 0, 1]), rtu(1, &[0x03, 2, 0, 7]), rtu(1, &[0x84, 2])].concat();
    let mut stream = [stream, vec![0x55; 3]].concat();
    let crc = crate::check::crc16(&stream[..23]).to_le_bytes();
    stream.splice(23.., crc);
    assert!(is_right(&stream[..25]) && is_right(&stream[..8]));
    for after in [vec![], rtu(1, &[0x84, 2])] {
        let found = pieces(Mode::Rtu, &[stream.clone(), after].concat());
        assert_eq!(found[..2], [frame(0..8, Shape::Request), frame(8..15, Shape::Response)]);
    }
}

#[test]
fn both_lengths_of_a_short_reply_and_a_request_are_tried() {
    // Function 03 from register 0x0200: looks like a reply of two bytes.
    let request = [0x01, 0x03, 0x02, 0x00, 0x00, 0x02, 0xC5, 0xB3];
    let reply = [0x01, 0x03, 0x02, 0x00, 0x07, 0xF9, 0x86];
    let stream = [&request[..], &reply, &request].concat();
    let found = [frame(0..8, Shape::Request), frame(8..15, Shape::Response), frame(15..23, Shape::Request)];
    assert_eq!(pieces(Mode::Rtu, &stream), found);
}

#[test]
fn stray_bytes_around_frames_are_noise() {
    let read = rtu(1, &[0x03, 0x00, 0x31, 0x00, 0x01]);
    let stream = [&[0x00][..], &read, &[0xFF, 0x00], &read, &[0xFF]].concat();
    let found = [noise(0..1), frame(1..9, Shape::Request), noise(9..11), frame(11..19, Shape::Request), noise(19..20)];
    assert_eq!(pieces(Mode::Rtu, &stream), found);
}

#[test]
fn an_unknown_function_is_found_on_clean_ground_only() {
    let own = rtu(9, &[0x41, 1, 2, 3]);
    let read = rtu(1, &[0x03, 0x00, 0x31, 0x00, 0x01]);
    let both = [own.clone(), own.clone(), read].concat();
    let found = [frame(0..7, Shape::Either), frame(7..14, Shape::Either), frame(14..22, Shape::Request)];
    assert_eq!(pieces(Mode::Rtu, &both), found);
    assert_eq!(pieces(Mode::Rtu, &[&[0xFF][..], &own].concat()), [noise(0..8)]);
}

#[test]
fn a_right_check_inside_a_frame_of_an_unknown_function_is_no_end() {
    let long = rtu(9, &[&rtu(9, &[0x41, 1, 2, 3])[1..], &[5, 6, 7][..]].concat());
    let read = rtu(1, &[0x03, 0x00, 0x31, 0x00, 0x01]);
    assert_eq!(pieces(Mode::Rtu, &long), [frame(0..12, Shape::Either)]);
    let found = pieces(Mode::Rtu, &[long, read].concat());
    assert_eq!(found, [frame(0..12, Shape::Either), frame(12..20, Shape::Request)]);
}

#[test]
fn noise_with_a_right_check_swallows_no_frame() {
    let read = rtu(1, &[0x03, 0x00, 0x31, 0x00, 0x01]);
    // Noise of an unknown function, and a check that is right over the two frames behind it.
    let mut stream = [&read[..], &[0x55, 0x41, 0x07], &read, &read, &[0x55; 3]].concat();
    let crc = crate::check::crc16(&stream[8..30]).to_le_bytes();
    stream.splice(30.., crc);
    assert!(is_right(&stream[8..]));
    let request = |at| frame(at..at + 8, Shape::Request);
    assert_eq!(pieces(Mode::Rtu, &stream), [request(0), noise(8..11), request(11), request(19), noise(27..32)]);
}

#[test]
fn query_data_of_any_length_is_returned() {
    let test = rtu(1, &[0x08, 0, 0, 1, 2, 3, 4, 5, 6]);
    let stream = [test.clone(), test, rtu(1, &[0x08, 0, 0, 0xA5, 0x37]), rtu(1, &[0x08, 0, 0])].concat();
    let ends: Vec<usize> = split(Mode::Rtu, &stream).map(|piece| piece.range.end).collect();
    assert_eq!(ends, [12, 24, 32, 38]);
}

#[test]
fn a_broken_line_is_noise_of_its_own() {
    let good = ascii(1, &[0x03, 0x00, 0x31, 0x00, 0x01]);
    let broken = b":010300310001C1\r\n";
    let stream = [&b"\r\nxx"[..], &good, broken, broken, b"yy", &good, b":0103", &good, b":01"].concat();
    let found = [
        noise(0..4),
        frame(4..21, Shape::Request),
        noise(21..38),
        noise(38..55),
        noise(55..57),
        frame(57..74, Shape::Request),
        noise(74..79),
        frame(79..96, Shape::Request),
        noise(96..99),
    ];
    assert_eq!(pieces(Mode::Ascii, &stream), found);
}

#[test]
fn ascii_ignores_the_eighth_bit_and_ends_long_lines() {
    let good: Vec<u8> = ascii(1, &[0x83, 2]).iter().map(|byte| byte | 0x80).collect();
    let endless = [&b":"[..], &[b'0'; 600]].concat();
    let stream = [endless, good].concat();
    let found = [noise(0..513), noise(513..601), frame(601..612, Shape::Response)];
    assert_eq!(pieces(Mode::Ascii, &stream), found);
}

#[test]
fn a_splitter_goes_on_after_silence() {
    let own = rtu(9, &[0x41, 1, 2, 3]);
    let mut splitter = Splitter::new(Mode::Rtu);
    for offset in [0, 9] {
        splitter.push(&own);
        assert_eq!(splitter.next_piece(), None);
        splitter.finish();
        let found = Found { offset, bytes: &own, kind: PieceKind::Frame(Shape::Either) };
        assert_eq!(splitter.next_piece(), Some(found));
        assert_eq!(splitter.next_piece(), None);
        splitter.push(&[0xFF, 0xFF]);
        splitter.finish();
        assert_eq!(splitter.next_piece().map(|found| found.kind), Some(PieceKind::Noise));
        assert_eq!(splitter.next_piece(), None);
    }
}

/// Steps that all checks take.
fn work(stream: &[u8]) -> u64 {
    let mut pieces = split(Mode::Rtu, stream);
    assert!(pieces.by_ref().map(|piece| piece.range.len()).sum::<usize>() == stream.len());
    pieces.cutter.checks.work
}

/// Streams made to be slow. What is counted is the bytes that go through a check.
#[test]
fn the_work_for_each_byte_is_bounded() {
    let frame = rtu(1, &[0x07]);
    let own = rtu(9, &[0x41]);
    let parts: [&[u8]; 10] = [
        &[0x01, 0x10, 0x00, 0x00, 0x00, 0x7B, 0xF6],
        &[0x14, 0xFB],
        &[0x02, 0xFA],
        &[0x14],
        &[0x11],
        &[0x17, 0xFA, 0x00, 0x7D, 0x00, 0x79, 0xF2],
        &[&frame[..], &[0x01, 0x14, 0xFB]].concat(),
        &own,
        &[&frame[..], &[0x09, 0x41]].concat(),
        &frame_with_a_right_check_inside(30),
    ];
    for part in parts {
        let once: Vec<u8> = part.iter().copied().cycle().take(50_000).collect();
        let twice: Vec<u8> = part.iter().copied().cycle().take(100_000).collect();
        let (once, twice) = (work(&once), work(&twice));

        // The search for the end of an unknown function takes 256 steps, for a frame of four bytes at least.
        let limit = if part == own.as_slice() { 70 } else { 40 };
        assert!(twice <= limit * 100_000, "{part:02X?}: {} steps for each byte", twice / 100_000);
        assert!(twice <= 2 * once + once / 10, "{part:02X?}: {once} and {twice}");
    }
    // Frames as they should be: each byte once, and the length that a request would have.
    let clean: Vec<u8> = rtu(1, &[0x03, 20, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20]);
    let clean = clean.repeat(1000);
    assert!(work(&clean) <= 2 * clean.len() as u64);
}

/// The same where the stream comes byte by byte.
#[test]
fn the_work_is_bounded_for_the_smallest_chunks() {
    let own = rtu(9, &[0x41, 1, 2, 3]);
    for part in [&own[..], &[0x01, 0x10, 0x00, 0x00, 0x00, 0x7B, 0xF6], &frame_with_a_right_check_inside(30)] {
        let mut splitter = Splitter::new(Mode::Rtu);
        for byte in part.iter().cycle().take(20_000) {
            splitter.push(&[*byte]);
            while splitter.next_piece().is_some() {}
        }
        assert!(splitter.cutter.checks.work <= 100 * 20_000, "{part:02X?}: {}", splitter.cutter.checks.work);
    }
}
