//! Steps being written, one after the other, each proven before the next; and written back where one fails.

mod proof;

use std::sync::Arc;
use std::time::Duration;

use buslens_codec::pdu::Request;
use buslens_codec::profile::{Effect, Point, Profile, Reply};

use self::proof::Proof;
use super::desk::{Desk, Stop};
use crate::plan::after_write;
use crate::request::{Answer, holds, over, single, write_request};
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
#[allow(clippy::struct_excessive_bools)] // each tells of another thing
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
    /// What it writes is what was there before.
    pub(super) undoes: bool,
    /// Something happened that can have changed more than what was written: a loss of supply, for one.
    is_stirred: bool,
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
        Self {
            desk,
            profile,
            journal,
            steps,
            snapshot,
            at: Some(at),
            maybe: vec![at],
            commanded: false,
            is_old,
            undoes: false,
            is_stirred: false,
        }
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
            self.tell_overwritten(index);
            match outcome {
                Ok(StepOutcome::Confirmed) if self.undoes => self.set(index, StepOutcome::Undone, StepState::Undone),
                Ok(outcome @ (StepOutcome::Confirmed | StepOutcome::Acknowledged)) => {
                    self.commanded |= self.steps.get(index).is_some_and(|step| step.before.is_none());
                    self.set(index, outcome, StepState::Confirmed);
                }
                Ok(outcome) => {
                    self.set(index, outcome.clone(), StepState::Sent);
                    if outcome == StepOutcome::Unproven {
                        self.commanded = true;
                        self.verify(index).await?;
                    }
                    return Err(Failure::Step(Why { step: place(index), outcome }));
                }
                Err(stop) => return Err(Failure::Stop(index, stop)),
            }
        }
        // What was read back before it was followed by something else may have changed since.
        match wanted.last() {
            Some((last, _)) if self.steps.len() > 1 || self.is_stirred => self.verify(*last).await,
            _ => Ok(()),
        }
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
        self.is_stirred |= !acknowledged;
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

/// Whether writing a point loses the settings of the device.
pub(super) fn is_loss(point: &Point) -> bool {
    point.effects.iter().any(|effect| matches!(effect, Effect::Defaults | Effect::Search))
}

/// A step's place in a report.
pub(super) fn place(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
