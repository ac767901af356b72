//! Steps being written, one after the other, each proven before the next; and written back where one fails.

use std::sync::Arc;
use std::time::Duration;

use buslens_codec::UnitId;
use buslens_codec::pdu::Request;
use buslens_codec::profile::{Effect, Point, Profile, Reply};

use super::Scope;
use super::desk::{Desk, Stop};
use super::finding::{search, signs};
use super::reading::{TRIES, read_group, read_points};
use crate::plan::after_write;
use crate::request::{Answer, holds, over, single, write_request};
use crate::snapshot::{is_of_factory, parameters};
use crate::{After, Ending, Journal, Phase, Reach, Read, Report, Snapshot, StepOutcome, StepReport, StepState, Why};

/// How often a parameter is written whose write was lost: read back, it held what it had held before.
const WRITES: u32 = 2;
/// A memory that is still being written may be read back too early.
const SETTLING: Duration = Duration::from_millis(100);
/// How often a device is looked for where it should be. It may be restarting.
const ROUNDS: u32 = 3;
/// Shortest pause between two of these rounds.
const ROUND_PAUSE: Duration = Duration::from_millis(200);
/// Exception 05: accepted, and takes a while. Exception 06: busy, not accepted (application protocol, clause 7).
const ACKNOWLEDGE: u8 = 5;
const SERVER_BUSY: u8 = 6;

/// Steps being written.
pub(super) struct Transaction<'a> {
    desk: &'a Desk,
    profile: Arc<Profile>,
    pub(super) journal: Journal,
    pub(super) steps: Vec<StepReport>,
    /// What is known by reading.
    pub(super) snapshot: Snapshot,
    /// Where the device answered last, if nothing was done since that could have moved it.
    at: Option<Reach>,
    /// Where it may be, best first.
    maybe: Vec<Reach>,
    /// A command was sent that nothing undoes.
    commanded: bool,
    /// It goes on from where an earlier procedure has stopped.
    is_old: bool,
}

/// Why writing did not come to its end.
#[derive(Clone, Debug)]
pub(super) enum Failure {
    /// A step was not as it should be.
    Step(Why),
    /// It had to stop at this step.
    Stop(usize, Stop),
}

/// What has become of one write.
enum Written {
    /// It is over.
    Ended(StepOutcome),
    /// It never came to the device, which holds what it held: once more.
    Lost,
}

/// A device that was looked for.
struct Seen {
    reach: Reach,
    /// What the point holds; `None` if it cannot be read.
    read: Option<Read>,
}

impl<'a> Transaction<'a> {
    /// Of a device that has just answered at `at`. The journal's steps are those of the report; it `is_old` if an earlier
    /// procedure has written under it.
    pub(super) fn new(desk: &'a Desk, journal: Journal, snapshot: Snapshot, at: Reach, is_old: bool) -> Self {
        let steps = journal.steps.iter().map(|step| StepReport {
            point: step.point.clone(),
            before: step.before.clone(),
            after: step.after.clone(),
            outcome: StepOutcome::Waiting,
            exchanges: Vec::new(),
        });
        let (profile, steps) = (desk.profile(), steps.collect());
        Self { desk, profile, journal, steps, snapshot, at: Some(at), maybe: vec![at], commanded: false, is_old }
    }

    /// Writes the steps at these places, each with these registers, and reads everything back in the end.
    pub(super) async fn run(&mut self, wanted: &[(usize, Vec<u16>)]) -> Result<(), Failure> {
        for (index, registers) in wanted {
            let index = *index;
            self.set(index, StepOutcome::Sent, StepState::Sent);
            if let Err(stop) = self.desk.keep(&self.journal).await {
                self.set(index, StepOutcome::NotSent, StepState::Waiting);
                return Err(Failure::Stop(index, stop));
            }
            self.desk.progress(Phase::Writing { step: place(index) }, index, self.steps.len(), None);
            let outcome = self.write(index, registers).await;
            self.collect(index);
            match outcome {
                Ok(outcome @ (StepOutcome::Confirmed | StepOutcome::Acknowledged)) => {
                    self.commanded |= self.steps.get(index).is_some_and(|step| step.before.is_none());
                    self.set(index, outcome, StepState::Confirmed);
                }
                Ok(outcome) => {
                    self.commanded |= outcome == StepOutcome::Unproven;
                    self.set(index, outcome.clone(), StepState::Sent);
                    return Err(Failure::Step(Why { step: place(index), outcome }));
                }
                Err(stop) => return Err(Failure::Stop(index, stop)),
            }
        }
        // What was read back before it was followed by something else may have changed since.
        if wanted.len() > 1 { self.verify(wanted).await } else { Ok(()) }
    }

    /// Writes back what was there before, the last step first, and says whether that is proven.
    pub(super) async fn undo(&mut self) -> Result<bool, Stop> {
        for index in (0..self.steps.len()).rev() {
            let profile = Arc::clone(&self.profile);
            let Some((step, own)) = self.journal.steps.get(index).zip(self.steps.get(index)) else { continue };
            let (Some(point), Some(before)) = (profile.point(&step.point), step.before.clone()) else { continue };
            if matches!(step.state, StepState::Waiting | StepState::Undone) {
                continue;
            }
            let refused = matches!(own.outcome, StepOutcome::Refused(_));
            self.desk.progress(
                Phase::Undoing { step: place(index) },
                self.steps.len() - 1 - index,
                self.steps.len(),
                None,
            );
            let maybe = self.maybe.clone();
            let seen = self.look(point, &maybe, ROUNDS).await;
            self.collect(index);
            let Some(seen) = seen? else {
                self.set(index, StepOutcome::Silent, StepState::Sent);
                return Ok(false);
            };
            let Some(Read::Registers(now)) = &seen.read else {
                self.set(index, StepOutcome::NotHeld(seen.read.unwrap_or(Read::NoAnswer)), StepState::Sent);
                return Ok(false);
            };
            let before = over(point, &before, now);
            let outcome = if holds(point, &Read::Registers(now.clone()), &before) {
                Ok(StepOutcome::Confirmed)
            } else {
                self.write(index, &before).await
            };
            self.collect(index);
            match outcome? {
                StepOutcome::Confirmed if refused => self.set_state(index, StepState::Undone),
                StepOutcome::Confirmed => self.set(index, StepOutcome::Undone, StepState::Undone),
                outcome => {
                    self.set(index, outcome, StepState::Sent);
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// Whether a command was sent that nothing undoes: what was written before may have been saved by it.
    pub(super) fn has_commanded(&self) -> bool {
        self.commanded
    }

    /// Sets the port and the polling as they stay, and tells what has become of the device. A journal that `is_over` is
    /// forgotten, and so is one under which nothing was ever written.
    pub(super) async fn close(mut self, ending: Ending, is_over: bool) -> Report {
        let stays_open = !is_over && (self.is_old || self.desk.writes() > 0);
        if !stays_open {
            self.desk.forget(self.journal.id);
        }
        self.desk.close(self.at).await;
        let candidates = if self.at.is_some() { Vec::new() } else { self.candidates() };
        self.snapshot.taken_unix_ms = self.desk.unix_ms();
        if let Some(at) = self.at {
            self.snapshot.reach = at;
        }
        let snapshot = self.at.map(|_| self.snapshot);
        let journal = stays_open.then_some(self.journal.id);
        Report { steps: self.steps, candidates, journal, ..self.desk.report(ending, self.at, snapshot) }
    }

    /// Where the device is, known by its reply.
    pub(super) fn at(&self) -> Option<Reach> {
        self.at
    }

    /// Everywhere that it may be, best first.
    fn candidates(&self) -> Vec<Reach> {
        let mut all = self.maybe.clone();
        for reach in self.journal.candidates() {
            if !all.contains(&reach) {
                all.push(reach);
            }
        }
        all
    }

    /// Writes a point and follows the device. Its outcome is `Confirmed` if it now holds this.
    async fn write(&mut self, index: usize, registers: &[u16]) -> Result<StepOutcome, Stop> {
        let profile = Arc::clone(&self.profile);
        let point = self.journal.steps.get(index).and_then(|step| profile.point(&step.point));
        let Some((point, request)) = point.and_then(|point| Some((point, write_request(point, registers)?))) else {
            return Ok(StepOutcome::NotSent);
        };
        for _ in 0..WRITES {
            match self.write_once(point, &request, registers).await? {
                Written::Ended(outcome) => return Ok(outcome),
                Written::Lost => {}
            }
        }
        let held = self.snapshot.read(&point.id).cloned().unwrap_or(Read::NoAnswer);
        Ok(StepOutcome::NotHeld(held))
    }

    async fn write_once(&mut self, point: &Point, request: &Request, registers: &[u16]) -> Result<Written, Stop> {
        let (profile, desk) = (Arc::clone(&self.profile), self.desk);
        let Some(at) = self.at else { return Ok(Written::Ended(StepOutcome::NotSent)) };
        let Ok(then) = after_write(&profile, point, registers, at, &self.snapshot.known(&profile)) else {
            return Ok(Written::Ended(StepOutcome::NotSent));
        };
        let next = match &then {
            After::Same => Vec::new(),
            After::Moves(reach) | After::Restarts { reach, .. } => vec![*reach],
            After::Defaults { candidates, .. } => candidates.clone(),
            After::Unknown { .. } => vec![Reach::of_factory(&profile)],
        };
        let moves = next.iter().any(|reach| *reach != at) || matches!(then, After::Unknown { .. });
        let wait = (moves && point.reply != Reply::Old).then(|| desk.write_wait(at));
        let old = self.snapshot.registers(&point.id).map(<[u16]>::to_vec);
        self.maybe = next;
        if !self.maybe.contains(&at) {
            self.maybe.push(at);
        }
        self.at = None;
        let answer = match desk.write(at, request, (point, old.as_deref(), registers), wait).await {
            Ok(answer) => answer,
            Err(stop) => {
                // What was taken back has moved nobody.
                self.at = (stop != Stop::Gone).then_some(at);
                return Err(stop);
            }
        };
        let acknowledged = match answer {
            Answer::Refused(ACKNOWLEDGE) => false,
            Answer::Refused(SERVER_BUSY) => {
                (self.at, self.maybe) = (Some(at), vec![at]);
                desk.pause(SETTLING).await?;
                return Ok(Written::Lost);
            }
            Answer::Refused(code) => {
                (self.at, self.maybe) = (Some(at), vec![at]);
                return Ok(Written::Ended(StepOutcome::Refused(code)));
            }
            answer => answer == Answer::Written,
        };
        let proof = Proof { point, registers, old, at, acknowledged };
        match then {
            After::Same if single(point).is_none() && acknowledged => {
                self.at = Some(at);
                Ok(Written::Ended(StepOutcome::Acknowledged))
            }
            After::Same => self.prove(&proof, at).await,
            After::Moves(reach) => {
                desk.progress(Phase::Following(reach), 0, 0, None);
                self.prove(&proof, reach).await
            }
            After::Restarts { reach, silence_ms } => {
                self.restart(silence_ms).await?;
                self.prove(&proof, reach).await
            }
            After::Defaults { silence_ms, .. } | After::Unknown { silence_ms } => {
                self.restart(silence_ms).await?;
                self.prove_loss(&proof).await
            }
        }
    }

    /// Finds out what has become of a write that leaves the device at `reach`.
    async fn prove(&mut self, proof: &Proof<'_>, reach: Reach) -> Result<Written, Stop> {
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
    async fn prove_loss(&mut self, proof: &Proof<'_>) -> Result<Written, Stop> {
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

    async fn restart(&mut self, silence_ms: u32) -> Result<(), Stop> {
        self.desk.progress(Phase::Restarting, 0, 0, Some(Duration::from_millis(silence_ms.into())));
        self.desk.pause(Duration::from_millis(silence_ms.into())).await
    }

    /// Looks for the device at these reaches, then everywhere, and keeps what it holds.
    async fn look(&mut self, point: &Point, reaches: &[Reach], rounds: u32) -> Result<Option<Seen>, Stop> {
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
        self.at = Some(reach);
        self.maybe = vec![reach];
        if let Some(read) = &read {
            let profile = Arc::clone(&self.profile);
            self.snapshot.put(&profile, &point.id, read.clone());
        }
        Seen { reach, read }
    }

    /// Reads everything back that was written and can be read.
    async fn verify(&mut self, wanted: &[(usize, Vec<u16>)]) -> Result<(), Failure> {
        let profile = Arc::clone(&self.profile);
        let last = wanted.last().map_or(0, |(index, _)| *index);
        let Some(at) = self.at else { return Ok(()) };
        let written: Vec<(usize, &Point, &Vec<u16>)> = wanted
            .iter()
            .filter_map(|(index, registers)| {
                let step = self.steps.get(*index).filter(|step| step.outcome == StepOutcome::Confirmed)?;
                Some((*index, profile.point(&step.point).filter(|point| single(point).is_some())?, registers))
            })
            .collect();
        let loses =
            |point: &Point| point.effects.iter().any(|effect| matches!(effect, Effect::Defaults | Effect::Search));
        let is_gone = wanted.iter().filter_map(|(index, _)| profile.point(&self.steps.get(*index)?.point)).any(loses);
        if written.is_empty() || is_gone {
            return Ok(());
        }
        self.desk.progress(Phase::Verifying, 0, 0, None);
        let points: Vec<&Point> = written.iter().map(|(_, point, _)| *point).collect();
        let reads = read_points(self.desk, at, &points).await.map_err(|stop| Failure::Stop(last, stop))?;
        let mut failed = None;
        for (index, point, registers) in written {
            // The first that is not as it should be is told; the others are undone all the same.
            let mut read =
                reads.iter().find(|(id, _)| *id == point.id).map_or(Read::NoAnswer, |(_, read)| read.clone());
            if read == Read::NoAnswer {
                self.at = None;
                let maybe = self.candidates();
                let seen = self.look(point, &maybe, ROUNDS).await.map_err(|stop| Failure::Stop(last, stop))?;
                read = seen.and_then(|seen| seen.read).unwrap_or(Read::NoAnswer);
            }
            self.snapshot.put(&profile, &point.id, read.clone());
            if !holds(point, &read, registers) {
                let outcome = if read == Read::NoAnswer { StepOutcome::Silent } else { StepOutcome::NotHeld(read) };
                self.set(index, outcome.clone(), StepState::Sent);
                failed = Some(Why { step: place(index), outcome });
            }
        }
        self.collect(last);
        failed.map_or(Ok(()), |why| Err(Failure::Step(why)))
    }

    fn set(&mut self, index: usize, outcome: StepOutcome, state: StepState) {
        if let Some(step) = self.steps.get_mut(index) {
            step.outcome = outcome;
        }
        self.set_state(index, state);
    }

    fn set_state(&mut self, index: usize, state: StepState) {
        if let Some(step) = self.journal.steps.get_mut(index) {
            step.state = state;
        }
    }

    /// Puts what has gone over the line into a step's report.
    fn collect(&mut self, index: usize) {
        let exchanges = self.desk.take_exchanges();
        if let Some(step) = self.steps.get_mut(index) {
            step.exchanges.extend(exchanges);
        }
    }
}

/// What a write must be proven by.
struct Proof<'a> {
    point: &'a Point,
    registers: &'a [u16],
    /// What the point held before, as far as it was read.
    old: Option<Vec<u16>>,
    at: Reach,
    acknowledged: bool,
}

pub(super) fn place(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
