//! Counting what a list holds.

use std::collections::BTreeMap;

use buslens_codec::dissect::Direction;
use buslens_codec::transcript::{Entry, EntryKind};

use crate::message::{Statistics, Tally};

/// The counts of the entries so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Counting {
    total: Tally,
    units: BTreeMap<u8, Tally>,
    functions: BTreeMap<u8, u32>,
    diagnoses: BTreeMap<&'static str, u32>,
}

impl Counting {
    /// Counts an entry; `frame` is its unit id, function code and whether it is an exception.
    pub(crate) fn count(&mut self, entry: &Entry, frame: Option<(u8, u8, bool)>, diagnoses: &[&'static str]) {
        let is_exception = frame.is_some_and(|(.., exception)| exception);
        add(&mut self.total, entry, is_exception);
        if let Some((unit, function, _)) = frame.filter(|_| entry.check_ok) {
            add(self.units.entry(unit).or_default(), entry, is_exception);
            *self.functions.entry(function).or_default() += 1;
        }
        for id in diagnoses {
            *self.diagnoses.entry(id).or_default() += 1;
        }
    }

    /// Whether only requests or only responses were seen: then nobody misses the other half.
    pub(crate) fn is_one_sided(&self) -> bool {
        self.total.requests == 0 || self.total.responses == 0
    }

    pub(crate) fn statistics(&self, reading: u32) -> Statistics {
        let sided = |mut tally: Tally| {
            if self.is_one_sided() {
                (tally.unanswered, tally.orphans) = (0, 0);
            }
            tally
        };
        Statistics {
            reading,
            total: sided(self.total),
            units: self.units.iter().map(|(unit, tally)| (*unit, sided(*tally))).collect(),
            functions: self.functions.iter().map(|(function, count)| (*function, *count)).collect(),
            diagnoses: self.diagnoses.iter().map(|(id, count)| ((*id).to_owned(), *count)).collect(),
        }
    }
}

fn add(tally: &mut Tally, entry: &Entry, is_exception: bool) {
    if entry.kind == EntryKind::Noise {
        tally.stretches += 1;
        tally.noise_bytes += u64::from(entry.len);
        return;
    }
    if !entry.check_ok {
        tally.damaged += 1;
        return;
    }
    tally.frames += 1;
    tally.requests += u32::from(entry.direction == Direction::Request);
    tally.responses += u32::from(entry.direction == Direction::Response);
    tally.exceptions += u32::from(is_exception);
    tally.unanswered += u32::from(entry.is_unanswered());
    tally.orphans += u32::from(entry.is_orphan());
}
