//! The rules of RTU streams: what stands at one place.

use super::checks::Checks;
use super::lengths::{Candidate, Lengths, Search, lengths, shape_within};
use super::{Shape, Verdict};
use crate::rtu::{MAX_ADU_LEN, MIN_ADU_LEN};

/// Enough to tell whether a frame stands after any other.
const TWO_FRAMES: usize = 2 * MAX_ADU_LEN;

/// A place in the stream and what is known from there on.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    /// The bytes from the place on.
    pub(super) bytes: &'a [u8],
    /// Bytes of the stream before it.
    pub(super) place: u64,
    /// No more bytes come.
    pub(super) finished: bool,
    /// No noise stands before the place.
    pub(super) clean: bool,
}

/// Looks for a frame at the start of the view.
#[inline]
pub(super) fn verdict(view: View<'_>, checks: &mut Checks) -> Verdict {
    let View { bytes, place, finished, clean } = view;
    let lengths = lengths(bytes);
    if lengths.search != Search::No && clean {
        return searched(view, lengths.search, checks);
    }
    if !finished && (lengths.more || lengths.longest() > bytes.len()) {
        return Verdict::Unknown { needed: lengths.longest().max(bytes.len() + 1) };
    }
    let Lengths { short, long, .. } = lengths;
    let found = match (checks.is_right(bytes, place, short.len), checks.is_right(bytes, place, long.len)) {
        (false, false) => return Verdict::NoFrame(1),
        (true, false) => short,
        (false, true) => long,
        (true, true) => match likelier(view, short, long, checks) {
            Some(found) => found,
            None => return Verdict::Unknown { needed: TWO_FRAMES },
        },
    };
    frame(bytes, found)
}

#[inline]
fn frame(bytes: &[u8], found: Candidate) -> Verdict {
    let shape = bytes.get(..found.len).map_or(found.shape, |frame| shape_within(frame, found.shape));
    Verdict::Frame(found.len, shape)
}

/// Of two lengths with a right check one is right by chance: the frame is the one that leaves a frame standing after it,
/// else the longer one. `None` while this cannot be told.
#[cold]
fn likelier(view: View<'_>, short: Candidate, long: Candidate, checks: &mut Checks) -> Option<Candidate> {
    for candidate in [long, short] {
        if is_followed(view, candidate.len, checks)? {
            return Some(candidate);
        }
    }
    Some(long)
}

/// A frame whose length its function does not tell ends where its check is right: at the first such place that has a frame
/// or the end of the stream behind it, else at the first. Only on clean ground: in noise a right check by chance would be
/// frequent.
#[cold]
fn searched(view: View<'_>, search: Search, checks: &mut Checks) -> Verdict {
    let known = view.bytes.get(..MAX_ADU_LEN).unwrap_or(view.bytes);
    if known.len() < MAX_ADU_LEN && !view.finished {
        return Verdict::Unknown { needed: MAX_ADU_LEN };
    }
    let (first, stride) = if search == Search::Words { (6, 2) } else { (MIN_ADU_LEN, 1) };
    let ends: alloc::vec::Vec<usize> = checks.right_lengths(known, first, stride).collect();
    let mut found = ends.first().copied();
    for end in ends {
        if view.finished && end == view.bytes.len() {
            found = Some(end);
            break;
        }
        match is_followed(view, end, checks) {
            Some(true) => {
                found = Some(end);
                break;
            }
            Some(false) => {}
            None => return Verdict::Unknown { needed: TWO_FRAMES },
        }
    }
    found.map_or(Verdict::NoFrame(1), |len| Verdict::Frame(len, Shape::Either))
}

/// Whether a frame of a length that its function tells stands `after` so many bytes.
fn is_followed(view: View<'_>, after: usize, checks: &mut Checks) -> Option<bool> {
    let bytes = view.bytes.get(after..).unwrap_or_default();
    let place = view.place.saturating_add(after as u64);
    let lengths = lengths(bytes);
    if !view.finished && (lengths.more || lengths.longest() > bytes.len()) {
        return None;
    }
    Some([lengths.short, lengths.long].iter().any(|next| checks.is_right(bytes, place, next.len)))
}
