//! Which entries are shown.

use buslens_codec::dissect::Direction;
use buslens_codec::profile::{Known, Profile};
use buslens_codec::transcript::{EntryKind, Transcript};

use crate::desk::parts;
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
    /// The text in lower case: an id of a diagnosis may hold it.
    word: String,
    /// The digits of the text, if it is nothing but bytes.
    digits: Option<Vec<u8>>,
    /// Ids of points whose id or name holds it.
    points: Vec<String>,
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

    /// Whether an entry is shown. `one_sided` lists hold no errors for want of a counterpart.
    pub(crate) fn passes(
        &self,
        transcript: &Transcript,
        profile: Option<&Profile>,
        index: usize,
        one_sided: bool,
    ) -> bool {
        let Some(entry) = transcript.entry(index) else { return false };
        let bytes = transcript.entry_bytes(index);
        if self.direction.is_some_and(|wanted| wanted != entry.direction) {
            return false;
        }
        if self.unit.is_some() || self.function.is_some() {
            let Some((unit, pdu)) = parts(&entry, bytes) else { return false };
            let function = pdu.first().map(|code| code & 0x7F);
            if self.unit.is_some_and(|wanted| wanted != unit.0)
                || self.function.is_some_and(|wanted| Some(wanted) != function)
            {
                return false;
            }
        }
        if !self.errors_only && self.text.is_none() {
            return true;
        }
        let reading = transcript.reading(index, profile, &mut Known::default());
        let alone = !one_sided && (entry.is_unanswered() || entry.is_orphan());
        let wrong = entry.kind == EntryKind::Noise || !entry.check_ok || alone || !reading.diagnoses.is_empty();
        if self.errors_only && !wrong {
            return false;
        }
        let Some(text) = &self.text else { return true };
        let named =
            reading.dissection.iter().flat_map(|found| &found.points).any(|point| text.points.contains(&point.point));
        let diagnosed = reading.diagnoses.iter().any(|found| found.id().contains(&text.word));
        named || diagnosed || text.digits.as_ref().is_some_and(|digits| holds(bytes, digits))
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
        Some(Self { word, digits, points })
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
}
