//! Counting what a list holds.

use std::collections::BTreeMap;

use crate::facts::{Facts, IDS};
use crate::message::{Statistics, Tally};

/// The counts of the entries that are kept.
#[derive(Clone, Debug, Default)]
pub(crate) struct Counting {
    total: Tally,
    units: BTreeMap<u8, Tally>,
    functions: BTreeMap<u8, u32>,
    diagnoses: [u32; IDS.len()],
    sent: u32,
}

/// What is counted of an entry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counted {
    pub(crate) facts: Facts,
    /// Its length in bytes.
    pub(crate) len: u32,
    /// Unit id and function code, where they can be read.
    pub(crate) header: Option<(u8, u8)>,
}

/// Into the counts, or out of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    In,
    Out,
}

impl Counting {
    /// Counts an entry.
    pub(crate) fn add(&mut self, entry: Counted) {
        self.count(entry, Way::In);
    }

    /// Takes an entry out that was counted like this.
    pub(crate) fn remove(&mut self, entry: Counted) {
        self.count(entry, Way::Out);
    }

    fn count(&mut self, entry: Counted, way: Way) {
        let Counted { facts, header, .. } = entry;
        way.step(&mut self.sent, facts.is(Facts::SENT));
        way.tally(&mut self.total, entry);
        if let Some((unit, function)) = header.filter(|_| facts.is(Facts::FRAME)) {
            let tally = self.units.entry(unit).or_default();
            way.tally(tally, entry);
            if *tally == Tally::default() {
                self.units.remove(&unit);
            }
            let count = self.functions.entry(function).or_default();
            way.step(count, true);
            if *count == 0 {
                self.functions.remove(&function);
            }
        }
        for place in facts.diagnoses() {
            if let Some(count) = self.diagnoses.get_mut(place) {
                way.step(count, true);
            }
        }
    }

    /// Whether only requests or only responses were seen: then nobody misses the other half.
    pub(crate) fn is_one_sided(&self) -> bool {
        self.total.requests == 0 || self.total.responses == 0
    }

    /// Whether anything was sent from here: then an answer is missed.
    pub(crate) fn has_sent(&self) -> bool {
        self.sent > 0
    }

    pub(crate) fn statistics(&self, reading: u32, one_sided: bool) -> Statistics {
        let sided = |mut tally: Tally| {
            if one_sided {
                (tally.unanswered, tally.orphans) = (0, 0);
            }
            tally
        };
        let mut diagnoses: Vec<(String, u32)> = IDS.iter().map(|id| (*id).to_owned()).zip(self.diagnoses).collect();
        diagnoses.retain(|(_, count)| *count > 0);
        diagnoses.sort();
        Statistics {
            reading,
            total: sided(self.total),
            units: self.units.iter().map(|(unit, tally)| (*unit, sided(*tally))).collect(),
            functions: self.functions.iter().map(|(function, count)| (*function, *count)).collect(),
            diagnoses,
        }
    }
}

impl Way {
    fn step(self, count: &mut u32, counts: bool) {
        *count = match self {
            Self::In => count.saturating_add(counts.into()),
            Self::Out => count.saturating_sub(counts.into()),
        };
    }

    fn tally(self, tally: &mut Tally, Counted { facts, len, .. }: Counted) {
        self.step(&mut tally.damaged, facts.is(Facts::DAMAGED));
        if facts.is(Facts::NOISE) {
            self.step(&mut tally.stretches, true);
            tally.noise_bytes = match self {
                Self::In => tally.noise_bytes.saturating_add(len.into()),
                Self::Out => tally.noise_bytes.saturating_sub(len.into()),
            };
        }
        if !facts.is(Facts::FRAME) {
            return;
        }
        self.step(&mut tally.frames, true);
        self.step(&mut tally.requests, facts.is(Facts::REQUEST));
        self.step(&mut tally.responses, facts.is(Facts::RESPONSE));
        self.step(&mut tally.exceptions, facts.is_exception());
        self.step(&mut tally.unanswered, facts.is(Facts::UNANSWERED));
        self.step(&mut tally.orphans, facts.is(Facts::ORPHAN));
    }
}
