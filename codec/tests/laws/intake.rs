use buslens_codec::intake::{Form, IntakeError, MAX_FAULTS, Portion, Reader, detect, read, read_as};
use buslens_codec::segment::Segment;

use super::input::Input;

/// Text, FF, a byte for the form, and the sizes of the pieces.
pub(super) fn any_text_is_taken(data: &[u8]) {
    let (text, mut input) = Input::text_and_rest(data);
    let found = detect(&text);
    let form = Form::ALL.get(usize::from(input.byte())).copied().unwrap_or(found.form);

    let best = read(&text);
    assert_eq!((best.form, best.alternative), (found.form, found.alternative));
    assert_ne!(best.alternative, Some(best.form));
    cover(&best.bytes, &best.segments);

    let whole = read_as(&text, form);
    cover(&whole.bytes, &whole.segments);
    assert_eq!(whole.faults.len(), whole.fault_count.min(MAX_FAULTS));
    let lines = 1 + text.bytes().filter(|byte| matches!(byte, b'\n' | b'\r')).count();
    assert!(whole.faults.iter().all(|IntakeError { line, column, .. }| (1..=lines).contains(line) && *column > 0));
    assert!(whole.faults.is_sorted_by_key(|error| error.line));

    let mut reader = Reader::new(form);
    let mut parts = Portion::default();
    let mut rest = text.as_str();
    for size in input.sizes(16) {
        let end = (size..rest.len()).find(|end| rest.is_char_boundary(*end)).unwrap_or(rest.len());
        let (piece, after) = rest.split_at(end);
        reader.push(piece);
        if size % 2 == 0 {
            append(&mut parts, reader.take());
        }
        rest = after;
        if rest.is_empty() {
            break;
        }
    }
    reader.finish();
    append(&mut parts, reader.take());
    let Portion { bytes, segments, faults, remarks } = parts;
    assert_eq!((bytes, segments, faults, remarks), (whole.bytes, whole.segments, whole.faults, whole.remarks));
    assert_eq!((reader.fault_count(), reader.form()), (whole.fault_count, form));
}

/// Segments stand in order and without gaps.
fn cover(bytes: &[u8], segments: &[Segment]) {
    assert_eq!(segments.first().map(|segment| segment.start), (!bytes.is_empty()).then_some(0));
    assert!(segments.windows(2).all(|pair| pair[0].start < pair[1].start && pair[0].line <= pair[1].line));
    assert!(segments.last().is_none_or(|segment| segment.start < bytes.len()));
    assert!(segments.iter().all(|segment| segment.line > 0));
}

fn append(all: &mut Portion, Portion { bytes, segments, faults, remarks }: Portion) {
    all.bytes.extend(bytes);
    all.segments.extend(segments);
    all.faults.extend(faults);
    all.remarks.extend(remarks);
}
