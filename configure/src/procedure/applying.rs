//! A plan carried out as one transaction; and going on from the journal of one that was broken off.

use std::sync::Arc;

use buslens_codec::UnitId;
use buslens_codec::profile::{Effect, Point, Profile};

use super::desk::{Desk, Stop};
use super::finding::{search, signs};
use super::reading::{TRIES, read_group, read_points};
use super::transaction::{Failure, Transaction, is_loss, place};
use super::{Scope, Way};
use crate::edit::own_bits;
use crate::request::{Answer, holds, read_request, single};
use crate::snapshot::{is_of_factory, parameters};
use crate::{
    Difference, Edit, Ending, Hazard, Journal, JournalStep, Phase, Plan, Reach, Read, Report, Snapshot, StepOutcome,
    StepState, Unfit, Why, compare,
};

/// Writes edits, all of them or none.
pub(super) async fn apply(desk: &Desk, before: Snapshot, edits: &[Edit], confirmed: Vec<Hazard>) -> Report {
    let reach = desk.reach();
    let mut have = Have { snapshot: Snapshot { reach, ..before }, answered: false };
    let plan = match prepare(desk, &mut have, edits, &confirmed).await {
        Ok(plan) if plan.steps.is_empty() => Err(Ending::Done),
        other => other,
    };
    let plan = match plan {
        Ok(plan) => plan,
        Err(ending) => {
            let at = have.answered.then_some(reach);
            desk.close(at).await;
            return desk.report(ending, at, at.map(|_| have.snapshot));
        }
    };
    let (begun_unix_ms, device) = (desk.unix_ms(), desk.device());
    let steps = plan.steps.iter().map(|step| JournalStep {
        point: step.point.clone(),
        before: step.before.clone(),
        after: step.after.clone(),
        state: StepState::Waiting,
    });
    let journal = Journal {
        id: begun_unix_ms.saturating_mul(1000),
        begun_unix_ms,
        profile: device.profile.id.clone(),
        file: device.file.to_string(),
        reach,
        steps: steps.collect(),
        confirmed,
        reaches: plan.reaches(),
    };
    let mut transaction = Transaction::new(desk, journal, have.snapshot, reach, false);
    let wanted: Vec<_> = plan.steps.iter().map(|step| step.after.clone()).enumerate().collect();
    let ending = match transaction.run(&wanted).await {
        Ok(()) => Ending::Done,
        Err(failure) => undo_or_tell(desk, &mut transaction, failure).await,
    };
    let is_over = matches!(ending, Ending::Done | Ending::RolledBack(_) | Ending::Cancelled | Ending::Unproven(_));
    transaction.close(ending, is_over).await
}

/// Finds the device of a journal, and finishes or undoes.
pub(super) async fn recover(desk: &Desk, journal: Journal, way: Way) -> Report {
    let (id, candidates) = (journal.id, journal.candidates());
    match find_and_read(desk, &journal).await {
        Ok((reach, snapshot)) => {
            let mut transaction = Transaction::new(desk, journal, snapshot, reach, true);
            let ending = go_on(desk, &mut transaction, way).await;
            let is_over = matches!(ending, Ending::Done | Ending::Undone | Ending::Unproven(_));
            transaction.close(ending, is_over).await
        }
        Err(ending) => {
            desk.close(None).await;
            Report { candidates, journal: Some(id), ..desk.report(ending, None, None) }
        }
    }
}

/// What the device holds, as far as it is known.
struct Have {
    snapshot: Snapshot,
    /// The device has answered.
    answered: bool,
}

/// Everything before the first write.
async fn prepare(desk: &Desk, have: &mut Have, edits: &[Edit], confirmed: &[Hazard]) -> Result<Plan, Ending> {
    let profile = desk.profile();
    if desk.is_read_only() {
        return Err(Ending::ReadOnly);
    }
    match Plan::of(&profile, &have.snapshot, edits) {
        Ok(plan) => confirm(&plan, confirmed)?,
        // What must be read first will be.
        Err(refused) if refused.iter().all(|one| matches!(one.why, Unfit::NotScaled | Unfit::NotRead)) => {}
        Err(refused) => return Err(Ending::Refused(refused)),
    }
    desk.stop_polling();
    let differs = read_again(desk, &profile, have, edits).await.map_err(stopped)?;
    if !have.answered {
        return Err(Ending::NoAnswer);
    }
    if !differs.is_empty() {
        return Err(Ending::Differs(differs));
    }
    let plan = Plan::of(&profile, &have.snapshot, edits).map_err(Ending::Refused)?;
    confirm(&plan, confirmed)?;
    check_free(desk, &profile, &plan).await?;
    Ok(plan)
}

fn confirm(plan: &Plan, confirmed: &[Hazard]) -> Result<(), Ending> {
    let open: Vec<Hazard> = plan.hazards.iter().filter(|hazard| !confirmed.contains(hazard)).cloned().collect();
    if open.is_empty() { Ok(()) } else { Err(Ending::Unconfirmed(open)) }
}

/// Reads what is to be changed, and tells what differs from what the user was shown.
async fn read_again(desk: &Desk, profile: &Profile, have: &mut Have, edits: &[Edit]) -> Result<Vec<Difference>, Stop> {
    let shown = have.snapshot.clone();
    let edited = edits.iter().filter_map(|edit| profile.point(&edit.point));
    let needed: Vec<&Point> = edited.flat_map(|point| with_scales(profile, point)).collect();
    let in_order: Vec<&Point> =
        profile.points.iter().filter(|point| needed.iter().any(|other| other.id == point.id)).collect();
    let readable: Vec<&Point> = in_order.into_iter().filter(|point| single(point).is_some()).collect();
    if readable.is_empty() {
        // A command needs somebody who hears it.
        for sign in signs(profile) {
            let answer = read_group(desk, shown.reach, sign, TRIES).await?;
            have.answered |= matches!(answer, Answer::Registers(_) | Answer::Refused(_));
            if have.answered {
                break;
            }
        }
        return Ok(Vec::new());
    }
    for (point, read) in read_points(desk, shown.reach, &readable).await? {
        have.answered |= read != Read::NoAnswer;
        have.snapshot.put(profile, &point, read);
    }
    let mut differs = compare(profile, &shown, &have.snapshot);
    differs.retain(|difference| difference.left.is_some());
    Ok(differs)
}

fn with_scales<'a>(profile: &'a Profile, point: &'a Point) -> Vec<&'a Point> {
    point.refers_to().filter_map(|id| profile.point(id)).chain([point]).collect()
}

/// Looks whether anybody else is where the device will be. Whatever answers there, were it by an exception, is one too many.
/// At the settings of the line as it is, and where the device will stay, anything may stand and is waited for in full. On
/// the way it is for a moment only, at settings that hardly anybody else has: there, one of its own kind is waited for.
async fn check_free(desk: &Desk, profile: &Profile, plan: &Plan) -> Result<(), Ending> {
    let Some(sign) = signs(profile).first().copied() else { return Ok(()) };
    for (at, target) in plan.targets.iter().enumerate() {
        desk.progress(Phase::CheckingFree(*target), at, plan.targets.len(), None);
        if !desk.enter(*target).await.map_err(stopped)? {
            return Err(Ending::PortRefuses(*target));
        }
        let Some(request) = read_request(sign) else { continue };
        // Noise is not heard twice.
        for last in [false, true] {
            let is_on_the_way = at > 0 && at + 1 < plan.targets.len();
            let wait = if is_on_the_way { desk.brief_wait(*target) } else { desk.full_wait(*target) };
            let answer = desk.ask(*target, &request, Some(wait)).await.map_err(stopped)?;
            match answer {
                Answer::Silence => break,
                Answer::Unclear if !last => {}
                _ => return Err(Ending::Occupied(*target)),
            }
        }
    }
    // The port is as the device needs it before anything is begun. A port that was opened again learns from a read
    // whether its adapter hears itself: without that the reply to function 05 or 06 proves nothing.
    if plan.targets.is_empty() {
        return Ok(());
    }
    match read_group(desk, plan.begins, sign, TRIES).await.map_err(stopped)? {
        Answer::Registers(_) | Answer::Refused(_) => Ok(()),
        _ => Err(Ending::NoAnswer),
    }
}

/// Undoes what was written if that can be done, and tells what is now.
async fn undo_or_tell(desk: &Desk, transaction: &mut Transaction<'_>, failure: Failure) -> Ending {
    let (why, stop) = match failure {
        Failure::Step(why) if why.outcome == StepOutcome::Unproven => return Ending::Unproven(why),
        Failure::Step(why) => (why, None),
        Failure::Stop(index, stop) => (Why { step: place(index), outcome: StepOutcome::NotSent }, Some(stop)),
    };
    match stop {
        Some(Stop::Gone) => return Ending::Interrupted,
        Some(stop) if desk.writes() == 0 => return stopped(stop),
        None | Some(Stop::Cancelled | Stop::NotKept)
            if !transaction.has_commanded() && why.outcome != StepOutcome::Silent =>
        {
            desk.clean_up();
            let undone = match transaction.undo().await {
                Ok(true) => transaction.is_still_true().await,
                other => other,
            };
            match undone {
                Ok(true) if stop == Some(Stop::Cancelled) => return Ending::Cancelled,
                Ok(true) => return Ending::RolledBack(why),
                Err(Stop::Gone) => return Ending::Interrupted,
                Ok(false) | Err(_) => {}
            }
        }
        _ => {}
    }
    told(transaction, why).await
}

/// Neither all nor nothing.
async fn told(transaction: &mut Transaction<'_>, why: Why) -> Ending {
    if transaction.at().is_some() && transaction.is_still_true().await == Err(Stop::Gone) {
        return Ending::Interrupted;
    }
    if transaction.at().is_some() { Ending::Partly(why) } else { Ending::Lost(why) }
}

/// Finds the device of a journal and reads all of its parameters.
async fn find_and_read(desk: &Desk, journal: &Journal) -> Result<(Reach, Snapshot), Ending> {
    let profile = desk.profile();
    if profile.id != journal.profile || journal.steps.iter().any(|step| profile.point(&step.point).is_none()) {
        return Err(Ending::BadJournal);
    }
    if desk.is_read_only() {
        return Err(Ending::ReadOnly);
    }
    desk.stop_polling();
    let reaches = journal.candidates();
    let mut units: Vec<UnitId> = Vec::new();
    for reach in reaches.iter().chain([&Reach::of_factory(&profile)]) {
        if !units.contains(&reach.unit) {
            units.push(reach.unit);
        }
    }
    let found = search(desk, &Scope { reaches, everywhere: true, units }).await.map_err(stopped)?;
    let Some(reach) = found.found else { return Err(Ending::NotFound { garbled: found.garbled }) };
    let mut snapshot = desk.snapshot(reach);
    let points = parameters(&profile);
    for (point, read) in read_points(desk, reach, &points).await.map_err(stopped)? {
        snapshot.put(&profile, &point, read);
    }
    desk.learn(|device| device.reach = reach);
    Ok((reach, snapshot))
}

/// Finishes or undoes, in a device that was found.
async fn go_on(desk: &Desk, transaction: &mut Transaction<'_>, way: Way) -> Ending {
    let profile = desk.profile();
    transaction.undoes = way == Way::Undo;
    let mut edits = Vec::new();
    for index in 0..transaction.steps.len() {
        let (outcome, edit) = next_of(&profile, transaction, index, way);
        if let Some(step) = transaction.steps.get_mut(index) {
            step.outcome = outcome;
        }
        edits.extend(edit);
    }
    let plan = match Plan::of(&profile, &transaction.snapshot, &edits) {
        Ok(plan) => plan,
        Err(refused) => return Ending::Refused(refused),
    };
    let confirmed = &transaction.journal.confirmed;
    if way == Way::Finish
        && let Err(ending) = confirm(&plan, confirmed)
    {
        return ending;
    }
    if let Err(ending) = check_free(desk, &profile, &plan).await {
        return ending;
    }
    let mut reaches = plan.reaches();
    reaches.extend(transaction.journal.candidates());
    transaction.journal.reaches = reaches;
    let index_of = |point: &str| transaction.steps.iter().position(|step| step.point == point);
    let wanted = plan.steps.iter().filter_map(|step| Some((index_of(&step.point)?, step.after.clone())));
    let wanted: Vec<(usize, Vec<u16>)> = wanted.collect();
    match transaction.run(&wanted).await {
        Ok(()) => {}
        Err(Failure::Step(why)) if why.outcome == StepOutcome::Unproven => return Ending::Unproven(why),
        Err(Failure::Step(why)) => return told(transaction, why).await,
        Err(Failure::Stop(_, Stop::Gone)) => return Ending::Interrupted,
        Err(Failure::Stop(_, stop)) if desk.writes() == 0 => return stopped(stop),
        Err(Failure::Stop(index, _)) => {
            return told(transaction, Why { step: place(index), outcome: StepOutcome::NotSent }).await;
        }
    }
    if way == Way::Undo {
        return Ending::Undone;
    }
    let unproven = transaction.steps.iter().position(|step| step.outcome == StepOutcome::Unproven);
    let why = |index| Why { step: place(index), outcome: StepOutcome::Unproven };
    unproven.map_or(Ending::Done, |index| Ending::Unproven(why(index)))
}

/// How a journal's step stands in the device, and what is still to be written for it.
fn next_of(
    profile: &Arc<Profile>,
    transaction: &Transaction<'_>,
    index: usize,
    way: Way,
) -> (StepOutcome, Option<Edit>) {
    let journal = &transaction.journal;
    let found = journal.steps.get(index).and_then(|step| Some((step, profile.point(&step.point)?)));
    let Some((step, point)) = found else { return (StepOutcome::Waiting, None) };
    let write = |registers: &[u16]| Some(Edit { point: point.id.clone(), registers: own_bits(point, registers) });
    let read = transaction.snapshot.read(&point.id);
    let wanted = if way == Way::Finish { Some(&step.after) } else { step.before.as_ref() };
    if let (Some(read), Some(wanted)) = (read, wanted) {
        let as_wanted = if way == Way::Finish { StepOutcome::Confirmed } else { StepOutcome::Undone };
        if holds(point, read, wanted) {
            return (as_wanted, None);
        }
        // What a command behind it has changed is as it should be.
        let overwritten = way == Way::Finish
            && journal
                .steps
                .iter()
                .any(|later| later.state != StepState::Waiting && profile.point(&later.point).is_some_and(is_loss));
        return if overwritten { (StepOutcome::Overwritten, None) } else { (StepOutcome::Waiting, write(wanted)) };
    }
    let done = match step.state {
        StepState::Waiting => (StepOutcome::Waiting, write(&step.after)),
        StepState::Sent if point.effects.contains(&Effect::Defaults) => {
            let mut all = parameters(profile).into_iter();
            let tells: Vec<bool> =
                all.by_ref().filter_map(|point| is_of_factory(point, transaction.snapshot.read(&point.id)?)).collect();
            match tells.iter().all(|is| *is) {
                true if tells.is_empty() => (StepOutcome::Unproven, None),
                true => (StepOutcome::Confirmed, None),
                false => (StepOutcome::NotDone, write(&step.after)),
            }
        }
        StepState::Sent => (StepOutcome::Unproven, None),
        StepState::Confirmed => (StepOutcome::Acknowledged, None),
        StepState::Undone => (StepOutcome::Undone, None),
    };
    // What cannot be read is not undone.
    if way == Way::Finish { done } else { (done.0, None) }
}

/// How a procedure ends that had to stop before anything was written.
fn stopped(stop: Stop) -> Ending {
    match stop {
        Stop::Gone => Ending::Interrupted,
        Stop::Cancelled => Ending::Cancelled,
        Stop::ReadOnly => Ending::ReadOnly,
        Stop::NotKept => Ending::NotKept,
    }
}
