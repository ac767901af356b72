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
    let found = match checks.are_right(bytes, place, short.len, long.len) {
        [false, false] => return Verdict::NoFrame(1),
        [true, false] => short,
        [false, true] => long,
        [true, true] => match likelier(view, short, long, checks) {
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

/// Of two lengths with a right check one is right by chance: the shorter one counts if a frame stands after it, for that is
/// next to impossible in the middle of a longer frame; else the longer one. `None` while this cannot be told.
#[cold]
fn likelier(view: View<'_>, short: Candidate, long: Candidate, checks: &mut Checks) -> Option<Candidate> {
    is_followed(view, short.len, checks).map(|followed| if followed { short } else { long })
}

/// A frame whose length its function does not tell ends where its check is right: at the place that has a frame or the end
/// of the stream behind it, else at the first. It ends where the next frame of a known function begins, or before: a check
/// that is right over that frame too is right by chance.
///
/// Only on clean ground: in noise a right check by chance would be frequent.
#[cold]
fn searched(view: View<'_>, search: Search, checks: &mut Checks) -> Verdict {
    let known = view.bytes.get(..MAX_ADU_LEN).unwrap_or(view.bytes);
    if known.len() < MAX_ADU_LEN && !view.finished {
        return Verdict::Unknown { needed: MAX_ADU_LEN };
    }
    let (mut first, mut crc) = (None, 0xFFFF);
    for (&byte, len) in known.iter().zip(1..) {
        crc = checks.step(crc, byte);
        let right = crc == 0 && fits(search, len);
        let last = view.finished && len == view.bytes.len();
        let followed = if last {
            false
        } else {
            match is_followed_once(view, len, checks) {
                Some(followed) => followed,
                None => return Verdict::Unknown { needed: TWO_FRAMES },
            }
        };
        match first {
            _ if right && (last || followed) => return Verdict::Frame(len, Shape::Either),
            None if followed => return Verdict::NoFrame(len),
            None if right => first = Some(len),
            Some(first) if followed => return Verdict::Frame(first, Shape::Either),
            _ => {}
        }
    }
    match first {
        Some(len) => Verdict::Frame(len, Shape::Either),
        // Nothing begins within.
        None => Verdict::NoFrame(known.len()),
    }
}

/// Whether a frame of an unknown function can have this length.
fn fits(search: Search, len: usize) -> bool {
    match search {
        Search::Words => len >= 6 && len.is_multiple_of(2),
        _ => len >= MIN_ADU_LEN,
    }
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

/// The same for a search, which asks for the places one after the other: no place is looked at twice for a `false`.
fn is_followed_once(view: View<'_>, after: usize, checks: &mut Checks) -> Option<bool> {
    let place = view.place.saturating_add(after as u64);
    if checks.bare.contains(&place) {
        return Some(false);
    }
    let followed = is_followed(view, after, checks)?;
    if !followed {
        let from = if checks.bare.end == place { checks.bare.start } else { place };
        checks.bare = from..place.saturating_add(1);
    }
    Some(followed)
}
