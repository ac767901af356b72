//! Finding out what has become of a write: where the device is, and what it holds.

use std::sync::Arc;
use std::time::Duration;

use buslens_codec::UnitId;
use buslens_codec::profile::{Effect, Point};

use super::super::Scope;
use super::super::desk::Stop;
use super::super::finding::{search, signs};
use super::super::reading::{TRIES, read_group, read_points};
use super::{Failure, ROUND_PAUSE, ROUNDS, SETTLING, Transaction, Written, is_loss, place};
use crate::request::{Answer, holds, single};
use crate::snapshot::{is_of_factory, parameters};
use crate::{Phase, Reach, Read, StepOutcome, StepReport, StepState, Why};

/// What a write must be proven by.
pub(super) struct Proof<'a> {
    pub(super) point: &'a Point,
    pub(super) registers: &'a [u16],
    /// What the point held before, as far as it was read.
    pub(super) old: Option<Vec<u16>>,
    pub(super) at: Reach,
    pub(super) acknowledged: bool,
}

/// A device that was looked for.
pub(super) struct Seen {
    pub(super) reach: Reach,
    /// What the point holds; `None` if it cannot be read.
    pub(super) read: Option<Read>,
}

impl Transaction<'_> {
    /// Finds out what has become of a write that leaves the device at `reach`.
    pub(super) async fn prove(&mut self, proof: &Proof<'_>, reach: Reach) -> Result<Written, Stop> {
        let mut early = 2;
        loop {
            let maybe = self.maybe.clone();
            let Some(seen) = self.look(proof.point, &maybe, ROUNDS).await? else {
                return Ok(Written::Ended(StepOutcome::Silent));
            };
            let arrived = seen.reach == reach;
            let Some(read) = seen.read else {
                // What cannot be read is shown by where the device answers, if that is what it changes.
                let outcome = match (arrived && reach != proof.at, arrived && proof.acknowledged) {
                    (true, _) => StepOutcome::Confirmed,
                    (false, true) => StepOutcome::Acknowledged,
                    (false, false) => StepOutcome::Unproven,
                };
                return Ok(Written::Ended(outcome));
            };
            if arrived && holds(proof.point, &read, proof.registers) {
                return Ok(Written::Ended(StepOutcome::Confirmed));
            }
            let as_before = proof.old.as_ref().is_some_and(|old| holds(proof.point, &read, old));
            if as_before && !proof.acknowledged {
                return Ok(Written::Lost);
            }
            if early == 0 || !as_before {
                return Ok(Written::Ended(StepOutcome::NotHeld(read)));
            }
            early -= 1;
            self.desk.pause(SETTLING).await?;
        }
    }

    /// Finds the device again after a command that loses its settings, and reads everything.
    pub(super) async fn prove_loss(&mut self, proof: &Proof<'_>) -> Result<Written, Stop> {
        let profile = Arc::clone(&self.profile);
        let maybe = self.maybe.clone();
        let Some(seen) = self.look(proof.point, &maybe, 1).await? else {
            return Ok(Written::Ended(StepOutcome::Silent));
        };
        let points = parameters(&profile);
        for (point, read) in read_points(self.desk, seen.reach, &points).await? {
            self.snapshot.put(&profile, &point, read);
        }
        let reads = points.iter().filter_map(|point| is_of_factory(point, self.snapshot.read(&point.id)?));
        let of_factory: Vec<bool> = reads.collect();
        let tells = proof.point.effects.contains(&Effect::Defaults) && !of_factory.is_empty();
        Ok(Written::Ended(match (tells, proof.acknowledged) {
            (true, _) if of_factory.iter().all(|is| *is) => StepOutcome::Confirmed,
            (true, _) => StepOutcome::NotDone,
            (false, true) => StepOutcome::Acknowledged,
            (false, false) => StepOutcome::Unproven,
        }))
    }

    pub(super) async fn restart(&mut self, silence_ms: u32) -> Result<(), Stop> {
        self.desk.progress(Phase::Restarting, 0, 0, Some(Duration::from_millis(silence_ms.into())));
        self.desk.pause(Duration::from_millis(silence_ms.into())).await
    }

    /// Looks for the device at these reaches, then everywhere, and keeps what it holds.
    pub(super) async fn look(&mut self, point: &Point, reaches: &[Reach], rounds: u32) -> Result<Option<Seen>, Stop> {
        let own = single(point);
        let Some(group) = own.or_else(|| signs(&self.profile).first().copied()) else { return Ok(None) };
        let pause = Duration::from_millis(self.profile.timing.startup_silence_ms.into()).max(ROUND_PAUSE);
        for round in 0..rounds {
            if round > 0 {
                self.desk.pause(pause).await?;
            }
            for (at, reach) in reaches.iter().enumerate() {
                // Where it should be a reply may be lost.
                let tries = if at == 0 && round == 0 { TRIES - 1 } else { 1 };
                let read = match read_group(self.desk, *reach, group, tries).await? {
                    Answer::Registers(registers) => Read::Registers(registers),
                    Answer::Refused(code) => Read::Refused(code),
                    _ => continue,
                };
                return Ok(Some(self.seen(point, *reach, own.map(|_| read))));
            }
        }
        let reaches = self.candidates();
        let mut units: Vec<UnitId> = Vec::new();
        for reach in reaches.iter().chain([&Reach::of_factory(&self.profile)]) {
            if !units.contains(&reach.unit) {
                units.push(reach.unit);
            }
        }
        let others = (self.profile.units.first..=self.profile.units.last).filter_map(|unit| u8::try_from(unit).ok());
        let others: Vec<UnitId> = others.map(UnitId).filter(|unit| !units.contains(unit)).collect();
        let mut found = search(self.desk, &Scope { reaches, everywhere: true, units }).await?.found;
        if found.is_none() && point.effects.contains(&Effect::Search) {
            found = search(self.desk, &Scope { reaches: Vec::new(), everywhere: true, units: others }).await?.found;
        }
        let Some(reach) = found else { return Ok(None) };
        let read = match read_group(self.desk, reach, group, TRIES).await? {
            Answer::Registers(registers) => Read::Registers(registers),
            Answer::Refused(code) => Read::Refused(code),
            _ => Read::NoAnswer,
        };
        Ok(Some(self.seen(point, reach, own.map(|_| read))))
    }

    /// Keeps where the device has answered, and what it holds.
    fn seen(&mut self, point: &Point, reach: Reach, read: Option<Read>) -> Seen {
        self.is_stirred |= self.maybe.first() != Some(&reach);
        self.at = Some(reach);
        self.maybe = vec![reach];
        if let Some(read) = &read {
            let profile = Arc::clone(&self.profile);
            self.snapshot.put(&profile, &point.id, read.clone());
        }
        Seen { reach, read }
    }

    /// Reads back what was written and can be read, and everything else where that may have changed. `last` is the step
    /// that was written last.
    pub(super) async fn verify(&mut self, last: usize) -> Result<(), Failure> {
        self.read_back().await.map_err(|stop| Failure::Stop(last, stop))?;
        self.collect(last);
        let failed = (0..self.steps.len()).rev().filter_map(|index| self.contradicted(index)).last();
        failed.map_or(Ok(()), |why| Err(Failure::Step(why)))
    }

    /// Whether what was proven is still so. Where something happened that nobody asked for it is looked at once more.
    pub(in crate::procedure) async fn is_still_true(&mut self) -> Result<bool, Stop> {
        if self.is_stirred {
            self.read_back().await?;
        }
        let contradicted = (0..self.steps.len()).filter_map(|index| self.contradicted(index)).count();
        Ok(contradicted == 0 && self.at.is_some())
    }

    /// Why a step that was proven is not proven any more.
    fn contradicted(&mut self, index: usize) -> Option<Why> {
        let step = self.steps.get(index)?;
        let wanted = wanted_of(step)?;
        let point = self.profile.point(&step.point).filter(|point| single(point).is_some())?;
        let read = self.snapshot.read(&point.id).cloned().unwrap_or(Read::NoAnswer);
        if self.at.is_some() && holds(point, &read, wanted) {
            return None;
        }
        let outcome = if self.at.is_some() { StepOutcome::NotHeld(read) } else { StepOutcome::Silent };
        self.set(index, outcome.clone(), StepState::Sent);
        Some(Why { step: place(index), outcome })
    }

    /// Reads what is claimed. A device that does not answer is looked for.
    async fn read_back(&mut self) -> Result<(), Stop> {
        let profile = Arc::clone(&self.profile);
        let proven = self.steps.iter().filter(|step| wanted_of(step).is_some());
        let proven = proven.filter_map(|step| profile.point(&step.point)).filter(|point| single(point).is_some());
        let mut points: Vec<&Point> = if self.is_stirred { parameters(&profile) } else { proven.collect() };
        let (Some(at), Some(first)) = (self.at, points.first().copied()) else { return Ok(()) };
        self.desk.progress(Phase::Verifying, 0, 0, None);
        let mut reads = read_points(self.desk, at, &points).await?;
        if reads.iter().all(|(_, read)| *read == Read::NoAnswer) {
            self.at = None;
            let maybe = self.candidates();
            let Some(seen) = self.look(first, &maybe, ROUNDS).await? else { return Ok(()) };
            points = parameters(&profile);
            reads = read_points(self.desk, seen.reach, &points).await?;
        }
        for (point, read) in reads {
            self.snapshot.put(&profile, &point, read);
        }
        Ok(())
    }

    /// What a command that loses the settings, behind which everything was read again, has changed of the steps before.
    pub(super) fn tell_overwritten(&mut self, index: usize) {
        let command = self.steps.get(index).and_then(|step| self.profile.point(&step.point));
        if !command.is_some_and(is_loss) {
            return;
        }
        for step in self.steps.iter_mut().filter(|step| step.outcome == StepOutcome::Confirmed) {
            let read = self.profile.point(&step.point).zip(self.snapshot.read(&step.point));
            let differs = read.is_some_and(|(point, read)| !holds(point, read, &step.after));
            match self.at {
                None => step.outcome = StepOutcome::Sent,
                Some(_) if differs => step.outcome = StepOutcome::Overwritten,
                Some(_) => {}
            }
        }
    }
}

/// What a step that is proven claims that the device holds.
fn wanted_of(step: &StepReport) -> Option<&[u16]> {
    match step.outcome {
        StepOutcome::Confirmed => Some(&step.after),
        StepOutcome::Undone => step.before.as_deref(),
        _ => None,
    }
}
