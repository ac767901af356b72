//! From a text to frames: each with the request that it answers, where one stands before it.

use buslens_codec::dissect::Direction;
use buslens_codec::intake::{self, IntakeError};
use buslens_codec::profile::{Known, Profile};
use buslens_codec::transcript::{EntryKind, Transcript};

use crate::anatomy::{Anatomy, request_in};
use crate::text::Language;

/// Everything that a text holds, in order.
pub(super) fn read(language: Language, profile: &Profile, text: &str) -> Result<Vec<Anatomy>, IntakeError> {
    let intake = intake::read(text);
    if let Some(fault) = intake.faults.first() {
        return Err(*fault);
    }
    let mut transcript = Transcript::new();
    transcript.push(&intake.bytes, &intake.segments);
    transcript.finish();
    // What each unit tells of its scales and units.
    let mut known: Vec<(u8, Known)> = Vec::new();
    let anatomy = |index: usize| {
        let entry = &transcript.entries()[index];
        let asked = entry.pair.filter(|_| entry.direction == Direction::Response);
        let request = asked.and_then(|pair| request_in(transcript.entry_bytes(pair as usize), entry.mode));
        let request = request.as_ref().map(|(_, request)| request);
        let bytes = transcript.entry_bytes(index);
        let unit = transcript.unit(index).map_or(0, |unit| unit.0);
        let place = known.iter().position(|(id, _)| *id == unit).unwrap_or_else(|| {
            known.push((unit, Known::default()));
            known.len() - 1
        });
        let (_, known) = &mut known[place];
        let anatomy = Anatomy::of(language, Some(profile), bytes, entry.mode, entry.direction, request, known);
        if entry.kind == EntryKind::Noise { anatomy.as_noise(language) } else { anatomy }
    };
    Ok((0..transcript.entries().len()).map(anatomy).collect())
}
