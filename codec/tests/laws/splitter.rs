use buslens_codec::check::is_right;
use buslens_codec::line::Mode;
use buslens_codec::stream::{Found, MAX_NOISE_LEN, Piece, PieceKind, Splitter, split};
use buslens_codec::{ascii, rtu};

use super::input::Input;
use super::script::Script;

/// A byte for the mode, the sizes of the chunks, a script.
pub(super) fn pieces_cover_the_stream(data: &[u8]) {
    let mut input = Input(data);
    let mode = if input.byte() & 1 == 0 { Mode::Rtu } else { Mode::Ascii };
    let sizes = input.sizes(4);
    let Script { stream, .. } = Script::read(input);

    let whole: Vec<Piece> = split(mode, &stream).collect();
    let mut at = 0;
    for Piece { range, kind } in &whole {
        assert!(range.start == at && range.end > at && range.end <= stream.len());
        at = range.end;
        let piece = &stream[range.clone()];
        match (kind, mode) {
            (PieceKind::Frame(_), Mode::Rtu) => assert!(is_right(piece) && rtu::decode(piece).is_ok()),
            (PieceKind::Frame(_), Mode::Ascii) => assert!(ascii::decode(piece).is_ok()),
            (PieceKind::Noise, _) => assert!(piece.len() < MAX_NOISE_LEN + ascii::MAX_ADU_LEN),
        }
    }
    assert_eq!(at, stream.len());

    // Twice the same with a silence between: it says the same again.
    let mut splitter = Splitter::new(mode);
    for before in [0, stream.len()] {
        let mut at = 0;
        let mut pieces = Vec::new();
        let mut rest = stream.as_slice();
        for size in sizes.clone() {
            let (chunk, after) = rest.split_at(size.min(rest.len()));
            splitter.push(chunk);
            rest = after;
            if rest.is_empty() {
                splitter.finish();
            }
            while let Some(Found { offset, bytes, kind }) = splitter.next_piece() {
                assert_eq!(offset, (before + at) as u64);
                let range = at..at + bytes.len();
                assert_eq!(bytes, &stream[range.clone()]);
                at = range.end;
                pieces.push(Piece { range, kind });
            }
            if rest.is_empty() {
                break;
            }
            assert!(stream.len() - rest.len() - at <= 2 * rtu::MAX_ADU_LEN + MAX_NOISE_LEN);
        }
        assert_eq!(pieces, whole);
    }
}
