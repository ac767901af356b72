//! Which entries are shown.

use buslens_codec::dissect::Direction;
use buslens_codec::profile::{Known, Profile};
use buslens_codec::transcript::{EntryKind, Transcript};

use crate::facts::{Facts, bits_of};
use crate::message::Filter;

/// A filter made ready.
#[derive(Clone, Debug)]
pub(crate) struct Sieve {
    unit: Option<u8>,
    function: Option<u8>,
    direction: Option<Direction>,
    errors_only: bool,
    text: Option<Wanted>,
}

/// What is looked for.
#[derive(Clone, Debug)]
struct Wanted {
    /// The text in lower case: comments and characters of frames may hold it.
    word: String,
    /// The digits of the text, if it is nothing but bytes.
    digits: Option<Vec<u8>>,
    /// Diagnoses whose ids hold it.
    diagnoses: u16,
    /// Ids of points whose id or name holds it.
    points: Vec<String>,
}

/// What is known of an entry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate<'a> {
    pub(crate) transcript: &'a Transcript,
    pub(crate) profile: Option<&'a Profile>,
    pub(crate) index: usize,
    pub(crate) facts: Facts,
    /// The comment of its mark.
    pub(crate) mark: Option<&'a str>,
    /// Nothing in the list is wrong for want of a counterpart.
    pub(crate) one_sided: bool,
}

impl Sieve {
    /// `None` for a filter that lets everything through.
    pub(crate) fn new(filter: &Filter, profile: Option<&Profile>) -> Option<Self> {
        let Filter { unit, function, direction, errors_only, ref text } = *filter;
        let text = Wanted::new(text, profile);
        (unit.is_some() || function.is_some() || direction.is_some() || errors_only || text.is_some()).then_some(Self {
            unit,
            function,
            direction,
            errors_only,
            text,
        })
    }

    /// Whether it asks what is wrong with entries.
    pub(crate) fn wants_errors(&self) -> bool {
        self.errors_only
    }

    /// Whether an entry is shown.
    pub(crate) fn passes(&self, candidate: Candidate<'_>) -> bool {
        let Candidate { transcript, index, facts, one_sided, .. } = candidate;
        let Some(entry) = transcript.entry(index) else { return false };
        if self.direction.is_some_and(|wanted| wanted != entry.direction) {
            return false;
        }
        if self.unit.is_some() || self.function.is_some() {
            let Some((unit, function)) = transcript.header(index) else { return false };
            if self.unit.is_some_and(|wanted| wanted != unit.0)
                || self.function.is_some_and(|wanted| wanted != function)
            {
                return false;
            }
        }
        if self.errors_only && !facts.is_wrong(one_sided) {
            return false;
        }
        self.text.as_ref().is_none_or(|text| text.is_in(candidate))
    }
}

impl Wanted {
    fn new(text: &str, profile: Option<&Profile>) -> Option<Self> {
        let word = text.trim().to_lowercase();
        if word.is_empty() {
            return None;
        }
        let digits: Vec<u8> = word.bytes().filter(|byte| !byte.is_ascii_whitespace()).collect();
        let digits = digits.iter().all(u8::is_ascii_hexdigit).then_some(digits);
        let fits = |name: &str| name.to_lowercase().contains(&word);
        let points = profile.iter().flat_map(|profile| &profile.points);
        let points = points.filter(|point| fits(&point.id) || fits(&point.name.en) || fits(&point.name.zh));
        let points = points.map(|point| point.id.clone()).collect();
        let diagnoses = bits_of(|id| id.contains(&word));
        Some(Self { word, digits, diagnoses, points })
    }

    fn is_in(&self, candidate: Candidate<'_>) -> bool {
        let Candidate { transcript, profile, index, facts, mark, .. } = candidate;
        let bytes = transcript.entry_bytes(index);
        facts.has(self.diagnoses)
            || self.digits.as_ref().is_some_and(|digits| holds(bytes, digits))
            || spells(bytes, self.word.as_bytes())
            || mark.is_some_and(|mark| mark.to_lowercase().contains(&self.word))
            || !self.points.is_empty() && self.is_named(transcript, profile, index)
    }

    fn is_named(&self, transcript: &Transcript, profile: Option<&Profile>, index: usize) -> bool {
        if transcript.entry(index).is_none_or(|entry| entry.kind == EntryKind::Noise) {
            return false;
        }
        let dissection = transcript.reading(index, profile, &mut Known::default()).dissection;
        dissection.iter().flat_map(|found| &found.points).any(|point| self.points.contains(&point.point))
    }
}

/// Whether bytes hold these lower-case digits, beginning with a byte's first.
fn holds(bytes: &[u8], digits: &[u8]) -> bool {
    let digit = |value: u8| b"0123456789abcdef"[usize::from(value & 0x0F)];
    let at = |place: usize| {
        bytes.get(place / 2).map(|byte| if place.is_multiple_of(2) { digit(byte >> 4) } else { digit(*byte) })
    };
    (0..bytes.len())
        .any(|start| digits.iter().enumerate().all(|(offset, wanted)| at(2 * start + offset) == Some(*wanted)))
}

/// Whether bytes hold this lower-case text as characters, whatever their case.
fn spells(bytes: &[u8], word: &[u8]) -> bool {
    bytes.windows(word.len()).any(|window| window.eq_ignore_ascii_case(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_found_from_a_bytes_first_on() {
        let bytes = [0x01, 0x03, 0xAB, 0xC0];
        for (digits, found) in
            [("0103", true), ("abc", true), ("03a", true), ("1", false), ("3ab", false), ("01 04", false)]
        {
            assert_eq!(holds(&bytes, digits.as_bytes()), found, "{digits}");
        }
    }

    #[test]
    fn characters_are_found_in_either_case() {
        assert!(spells(b"\x01Ready\r", b"ready") && spells(b"OK", b"ok"));
        assert!(!spells(b"Read", b"ready") && !spells(b"", b"a"));
    }
}
