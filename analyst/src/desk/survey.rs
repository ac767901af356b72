//! Counting and sifting: all entries once, a new one as soon as it is there, a changed one again.

use buslens_codec::UnitId;
use buslens_codec::diagnose::{Diagnosis, manual_erratum};
use buslens_codec::dissect::Direction;
use buslens_codec::line::Mode;
use buslens_codec::outline::Outline;
use buslens_codec::profile::Known;
use buslens_codec::stream::Shape;
use buslens_codec::transcript::{Entry, EntryKind};

use super::{Desk, parts, place};
use crate::facts::Facts;
use crate::filter::Candidate;
use crate::message::Statistics;
use crate::scale::Scales;
use crate::statistics::{Counted, Counting};

/// Stretches of noise between a frame and the next whose diagnosis may depend on it.
const MOST_NOISE_BETWEEN: usize = 4;

impl Desk {
    /// Counts and sifts up to `limit` entries, of a text once it has ended; whether there is more to do.
    pub fn work(&mut self, limit: usize) -> bool {
        if !self.finished {
            return false;
        }
        let end = self.transcript.end();
        let until = end.min(self.surveyed.saturating_add(limit));
        let left = limit.saturating_sub(until.saturating_sub(self.surveyed));
        if self.surveyed < until {
            for index in self.surveyed..until {
                self.survey(index);
            }
            self.surveyed = until;
            self.transcript.watch(until);
            self.take_sides();
            if until == end && !self.tellers.is_empty() && self.live.is_none() {
                // Rows that were sent before did not know their scales.
                self.new_edition();
            }
        }
        if self.sieve.is_none() {
            return until < end;
        }
        // What is wrong with a text is known when all of it has been counted.
        let ready = if self.live.is_some() || until == end { until } else { self.sifted };
        let sifted = ready.min(self.sifted.saturating_add(left));
        for index in self.sifted..sifted {
            if self.passes(index) {
                self.shown.push_back(place(index));
            }
        }
        self.sifted = self.sifted.max(sifted);
        until < end || self.sifted < end
    }

    /// The counts of a text that has ended, or of a log; `None` while they are being made.
    pub fn statistics(&self) -> Option<Statistics> {
        (self.finished && self.surveyed == self.transcript.end())
            .then(|| self.counting.statistics(self.reading, self.one_sided))
    }

    pub(super) fn begin_survey(&mut self) {
        self.scales = Scales::default();
        self.counting = Counting::default();
        self.facts.clear();
        self.surveyed = self.transcript.first();
        self.transcript.watch(self.surveyed);
    }

    pub(super) fn begin_sifting(&mut self) {
        self.shown.clear();
        self.sifted = self.transcript.first();
        self.new_edition();
    }

    /// Looks again at what later entries have changed.
    pub(super) fn catch_up(&mut self) {
        for index in self.transcript.take_changed() {
            let index = index as usize;
            self.survey_again(index);
            self.outdate(place(index));
            // What is wrong with a response may be that it does not fit the request before it.
            let mut behind = (index + 1..self.surveyed).take(MOST_NOISE_BETWEEN + 1);
            let next = behind.find(|next| self.is_frame(*next));
            if let Some(next) = next {
                self.survey_again(next);
            }
        }
    }

    /// Looks again at an entry that has been counted.
    pub(super) fn survey_again(&mut self, index: usize) {
        let at = index.checked_sub(self.transcript.first());
        let Some(before) = at.and_then(|at| self.facts.get(at).copied()) else { return };
        let Some(entry) = self.transcript.entry(index) else { return };
        let facts = self.facts_of(index, &entry);
        if facts == before {
            return;
        }
        self.counting.remove(self.counted(index, &entry, before));
        self.counting.add(self.counted(index, &entry, facts));
        if let Some(known) = at.and_then(|at| self.facts.get_mut(at)) {
            *known = facts;
        }
        self.take_sides();
        self.sift_again(index);
        self.outdate(place(index));
    }

    /// Looks again whether an entry is shown.
    pub(super) fn sift_again(&mut self, index: usize) {
        if self.sieve.is_none() || index >= self.sifted {
            return;
        }
        match (self.shown.binary_search(&place(index)), self.passes(index)) {
            (Ok(at), false) => drop(self.shown.remove(at)),
            (Err(at), true) => self.shown.insert(at, place(index)),
            _ => return,
        }
        // Those behind it have moved.
        self.new_edition();
    }

    /// Lets go what belongs to entries before `first`, which are about to be forgotten.
    pub(super) fn uncount_before(&mut self, first: usize) {
        for index in self.transcript.first()..first.min(self.surveyed) {
            let (Some(facts), Some(entry)) = (self.facts.pop_front(), self.transcript.entry(index)) else { break };
            self.counting.remove(self.counted(index, &entry, facts));
        }
        self.surveyed = self.surveyed.max(first);
        self.sifted = self.sifted.max(first);
        while self.shown.pop_front_if(|index| (*index as usize) < first).is_some() {}
        self.scales.forget_before(place(first));
    }

    pub(super) fn shown(&self) -> usize {
        let end = self.view_end();
        match (&self.sieve, self.held_from) {
            (None, _) => end - self.transcript.first(),
            (Some(_), None) => self.shown.len(),
            (Some(_), Some(_)) => self.shown.partition_point(|index| (*index as usize) < end),
        }
    }

    pub(super) fn shown_at(&self, at: usize) -> Option<usize> {
        if at >= self.shown() {
            None
        } else if self.sieve.is_some() {
            self.shown.get(at).map(|index| *index as usize)
        } else {
            Some(self.transcript.first() + at)
        }
    }

    fn survey(&mut self, index: usize) {
        let Some(entry) = self.transcript.entry(index) else { return };
        if entry.check_ok && entry.direction == Direction::Response && !self.tellers.is_empty() {
            self.hear(index, &entry);
        }
        let facts = self.facts_of(index, &entry);
        self.counting.add(self.counted(index, &entry, facts));
        self.facts.push_back(facts);
    }

    /// Takes in what the registers of a response tell of scales.
    fn hear(&mut self, index: usize, entry: &Entry) {
        let Some((unit, pdu)) = parts(entry, self.transcript.entry_bytes(index)) else { return };
        let Some(outline) = Outline::of_pdu(unit, &pdu, Shape::Response) else { return };
        let asked = entry.pair.and_then(|pair| self.address_of(pair as usize));
        if let Some(address) = asked.or(outline.address) {
            let registers: Vec<u16> = outline.registers().collect();
            self.scales.hear(&self.tellers, place(index), unit.0, outline.function, address, &registers);
        }
    }

    fn facts_of(&self, index: usize, entry: &Entry) -> Facts {
        Facts::new(entry, &self.diagnoses_of(index, entry), self.waiting == Some(place(index)))
    }

    /// What is wrong with an entry. A whole frame of a known shape needs no closer look but for its values.
    fn diagnoses_of(&self, index: usize, entry: &Entry) -> Vec<Diagnosis> {
        let Some(profile) = self.profile.as_ref().filter(|_| entry.check_ok) else {
            return self.transcript.diagnoses(index);
        };
        let bytes = self.transcript.entry_bytes(index);
        if matches!((entry.mode, entry.direction, bytes), (Mode::Rtu, Direction::Request, [_, 0x01..=0x04, ..])) {
            // It carries no values.
            let erratum = manual_erratum(bytes, profile);
            return erratum.into_iter().chain(self.transcript.diagnoses(index)).collect();
        }
        self.transcript.reading(index, Some(profile), &mut Known::default()).diagnoses
    }

    fn counted(&self, index: usize, entry: &Entry, facts: Facts) -> Counted {
        let header = match (entry.mode, self.transcript.entry_bytes(index)) {
            (_, _) if !entry.check_ok => None,
            (Mode::Rtu, [unit, function, ..]) => Some((*unit, function & 0x7F)),
            _ => self.transcript.header(index).map(|(UnitId(unit), function)| (unit, function)),
        };
        Counted { facts, len: entry.len, header }
    }

    fn address_of(&self, index: usize) -> Option<u16> {
        let entry = self.transcript.entry(index)?;
        let (unit, pdu) = parts(&entry, self.transcript.entry_bytes(index))?;
        Outline::of_pdu(unit, &pdu, Shape::Request)?.address
    }

    fn is_frame(&self, index: usize) -> bool {
        self.transcript.entry(index).is_some_and(|entry| entry.kind == EntryKind::Frame)
    }

    /// Whether an entry that has been counted is shown.
    fn passes(&self, index: usize) -> bool {
        let at = index.checked_sub(self.transcript.first());
        let facts = at.and_then(|at| self.facts.get(at)).copied().unwrap_or_default();
        self.sieve.as_ref().is_none_or(|sieve| {
            sieve.passes(Candidate {
                transcript: &self.transcript,
                profile: self.profile.as_ref(),
                index,
                facts,
                mark: self.diary.mark_of(place(index)),
                one_sided: self.one_sided,
            })
        })
    }

    /// Finds out whether anybody misses the other half of a transaction: not where only one side was ever heard, unless it
    /// was this side that asked.
    pub(super) fn take_sides(&mut self) {
        let sent_here = self.live.is_some() && self.counting.has_sent();
        let one_sided = self.counting.is_one_sided() && !sent_here;
        if one_sided == self.one_sided {
            return;
        }
        self.one_sided = one_sided;
        if self.sieve.as_ref().is_some_and(crate::filter::Sieve::wants_errors) {
            self.begin_sifting();
        } else {
            self.new_edition();
        }
    }
}
