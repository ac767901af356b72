use buslens_codec::intake::{Form, read_as};
use buslens_codec::json::Lines;
use buslens_codec::line::Mode;
use buslens_codec::profile::{Known, Profile};
use buslens_codec::segment::Segment;
use buslens_codec::transcript::{Entry, EntryKind, Reading, Transcript};
use buslens_codec::{ascii, rtu};
use serde_json::Value;

use super::input::Input;
use super::pdu::{PROFILES, covers};
use super::script::Script;

/// A byte for segments without order, the sizes of the portions, a script.
pub(super) fn entries_cover_the_stream(data: &[u8]) {
    let mut input = Input(data);
    let wild = input.byte() & 1 == 1;
    let mut sizes = input.sizes(4);
    let Script { stream, mut segments } = Script::read(input);
    if wild {
        // No source tells such; it must not harm.
        segments.reverse();
        segments.iter_mut().step_by(3).for_each(|segment| segment.start = usize::MAX - segment.start);
    } else {
        segments.retain(|segment| segment.start < stream.len());
    }
    let mut whole = Transcript::new();
    whole.push(&stream, &segments);
    whole.finish();
    entries(&whole, &stream);

    if !wild {
        let mut portions = Transcript::new();
        let mut at = 0;
        while at < stream.len() {
            let end = stream.len().min(at + sizes.next().unwrap_or(1));
            let here: Vec<Segment> =
                segments.iter().filter(|segment| (at..end).contains(&segment.start)).copied().collect();
            portions.push(&stream[at..end], &here);
            at = end;
        }
        portions.finish();
        assert!(whole.entries().eq(portions.entries()));
    }
    for profile in PROFILES.iter().map(Some).chain([None]) {
        readings(&whole, profile);
    }
    let chosen = whole.most_explaining(&PROFILES);
    lines(&whole, chosen);
    lines(&whole, None);
}

/// Entries stand in order and without gaps, pairs are mutual, and every damaged frame is explained.
fn entries(transcript: &Transcript, stream: &[u8]) {
    let entries: Vec<Entry> = transcript.entries().collect();
    let mut at = 0;
    for (index, entry) in entries.iter().enumerate() {
        let bytes = transcript.entry_bytes(index);
        assert!(entry.offset == at as u64 && entry.len > 0 && bytes.len() == entry.len as usize, "{entry:?}");
        assert_eq!(bytes, &stream[at..at + bytes.len()]);
        at += bytes.len();
        if let Some(pair) = entry.pair {
            let other = &entries[pair as usize];
            assert_eq!(other.pair.map(|back| back as usize), Some(index));
            assert_ne!(other.direction, entry.direction);
            assert!(!entry.echo);
        }
        let right = match entry.mode {
            Mode::Rtu => rtu::decode(bytes).is_ok(),
            Mode::Ascii => ascii::decode(bytes).is_ok(),
        };
        match entry.kind {
            EntryKind::Frame => assert_eq!(right, entry.check_ok, "{entry:?} {bytes:02X?}"),
            EntryKind::Noise => assert!(!entry.check_ok && entry.pair.is_none() && !entry.echo && !entry.repeated),
        }
        let found = transcript.diagnoses(index);
        let explained = entry.kind == EntryKind::Noise || entry.check_ok || !found.is_empty();
        assert!(explained, "{entry:?} {bytes:02X?}");
    }
    assert_eq!(at, stream.len());
    assert!(transcript.held_back().is_empty());
    assert!(transcript.entry_bytes(entries.len()).is_empty());
}

fn readings(transcript: &Transcript, profile: Option<&Profile>) {
    let mut known = Known::default();
    for (index, entry) in transcript.entries().enumerate() {
        let bytes = transcript.entry_bytes(index);
        let Reading { dissection, diagnoses } = transcript.reading(index, profile, &mut known);
        if entry.kind == EntryKind::Noise {
            assert!(dissection.is_none() && diagnoses.is_empty());
        }
        if let Some(found) = dissection {
            covers(&found, bytes);
            assert_eq!(found.check.is_ok(), entry.check_ok);
            assert_eq!(Some((found.unit, found.function)), transcript.header(index));
            assert!(found.points.iter().all(|named| named.range.end <= bytes.len()));
        }
    }
    assert_eq!(transcript.reading(transcript.entries().len(), profile, &mut known), Reading::default());
}

/// Each entry is one line of JSON, and the lines hold the stream.
fn lines(transcript: &Transcript, profile: Option<&Profile>) {
    let mut writer = Lines::new(transcript, profile);
    let mut text = String::new();
    let mut count = 0;
    while writer.write_next(&mut text) {
        count += 1;
    }
    assert_eq!(count, transcript.entries().len());
    assert_eq!(text.lines().count(), count);
    for (line, entry) in text.lines().zip(transcript.entries()) {
        let object: Value = serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"));
        assert_eq!(object["offset"], entry.offset);
        assert_eq!(object["kind"], if entry.kind == EntryKind::Frame { "frame" } else { "noise" });
    }
    // What ASCII mode lets vary, the digits' case and the eighth bit, is not kept.
    if transcript.entries().all(|entry| entry.mode == Mode::Rtu) {
        let again = read_as(&text, Form::Log);
        let stream: Vec<u8> = (0..count).flat_map(|index| transcript.entry_bytes(index).to_vec()).collect();
        assert_eq!((again.bytes, again.fault_count), (stream, 0));
    }
}
