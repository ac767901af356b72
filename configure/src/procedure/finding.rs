//! Searching a device: where it was last, as it leaves the factory, with every setting that it can have.

use std::collections::VecDeque;
use std::time::Duration;

use buslens_codec::UnitId;
use buslens_codec::profile::{Group, Profile};

use super::Scope;
use super::desk::{Desk, Stop};
use crate::request::{Answer, read_request, single};
use crate::{Ending, Phase, Reach, Report};

/// The master leaves the line alone for so long after a silence (serial line guide, clause 2.4.1).
const TURNAROUND: Duration = Duration::from_millis(100);

/// What a search has brought.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Search {
    /// Where the device answers.
    pub(super) found: Option<Reach>,
    /// Bytes were heard that were no reply.
    pub(super) garbled: bool,
}

/// One question of a search.
#[derive(Clone, Copy, Debug)]
enum Probe {
    /// Are you there?
    Unit(Reach),
    /// Whoever is there, what is your unit id? By this discovery of the profile.
    Everybody(Reach, usize),
}

/// Searches, as a task of its own.
pub(super) async fn find(desk: &Desk, scope: &Scope) -> Report {
    desk.stop_polling();
    let ending = match search(desk, scope).await {
        Ok(Search { found: Some(reach), .. }) => {
            desk.close(Some(reach)).await;
            return desk.report(Ending::Found, Some(reach), None);
        }
        Ok(Search { garbled, .. }) => Ending::NotFound { garbled },
        Err(Stop::Cancelled) => Ending::Cancelled,
        Err(Stop::ReadOnly) => Ending::ReadOnly,
        Err(Stop::Gone | Stop::NotKept) => Ending::Interrupted,
    };
    desk.close(None).await;
    let mut report = desk.report(ending, None, None);
    report.candidates.clone_from(&scope.reaches);
    report
}

/// Searches until the device has answered. A port that does not take some settings is not asked with them.
pub(super) async fn search(desk: &Desk, scope: &Scope) -> Result<Search, Stop> {
    let profile = desk.profile();
    let mut open = probes(&profile, scope);
    let (mut search, total) = (Search::default(), open.len());
    let mut tried = 0;
    while let Some(probe) = open.pop_front() {
        let (Probe::Unit(reach) | Probe::Everybody(reach, _)) = probe;
        let left =
            open.iter().map(|(Probe::Unit(reach) | Probe::Everybody(reach, _))| desk.short_wait(*reach) + TURNAROUND);
        desk.progress(Phase::Searching(reach), tried, total, Some(left.sum()));
        tried += 1;
        match probe {
            Probe::Unit(reach) => match is_there(desk, &profile, reach).await? {
                Answer::Registers(_) => return Ok(Search { found: Some(reach), ..search }),
                Answer::Unclear => search.garbled = true,
                _ => {}
            },
            Probe::Everybody(reach, way) => match discover(desk, &profile, reach, way).await? {
                Answer::Registers(registers) => {
                    let unit = registers.first().and_then(|unit| u8::try_from(*unit).ok()).filter(|unit| *unit > 0);
                    let Some(unit) = unit else { continue };
                    let reach = Reach { unit: UnitId(unit), ..reach };
                    // Two devices that answer at once can look like a third; and a reply can be lost.
                    for _ in 0..2 {
                        if matches!(is_there(desk, &profile, reach).await?, Answer::Registers(_)) {
                            return Ok(Search { found: Some(reach), ..search });
                        }
                    }
                    search.garbled = true;
                }
                // Somebody is there who does not tell it so.
                Answer::Refused(_) if way + 1 < profile.discovery.len() => {
                    open.push_front(Probe::Everybody(reach, way + 1));
                }
                Answer::Unclear => search.garbled = true,
                _ => {}
            },
        }
    }
    Ok(search)
}

/// Everything that is asked, best first: what was given twice, because a reply can be lost.
fn probes(profile: &Profile, scope: &Scope) -> VecDeque<Probe> {
    let given = scope.reaches.iter().map(|reach| match reach.unit {
        UnitId::BROADCAST if !profile.discovery.is_empty() => Probe::Everybody(*reach, 0),
        _ => Probe::Unit(*reach),
    });
    let mut all: VecDeque<Probe> = given.clone().chain(given).collect();
    if !scope.everywhere {
        return all;
    }
    let lines = profile.line_candidates();
    let at = |unit| lines.iter().map(move |(line, mode)| Reach { unit, line: *line, mode: *mode });
    for way in 0..profile.discovery.len() {
        all.extend(at(UnitId::BROADCAST).map(|reach| Probe::Everybody(reach, way)));
    }
    for (line, mode) in &lines {
        let units = scope.units.iter().filter(|unit| **unit != UnitId::BROADCAST);
        all.extend(units.map(|unit| Probe::Unit(Reach { unit: *unit, line: *line, mode: *mode })));
    }
    all
}

/// Asks for one of the reads that tell the device from others. Only registers say that it is there.
pub(super) async fn is_there(desk: &Desk, profile: &Profile, reach: Reach) -> Result<Answer, Stop> {
    let mut answer = Answer::Silence;
    for group in signs(profile) {
        let Some(request) = read_request(group) else { continue };
        answer = desk.ask(reach, &request, Some(desk.short_wait(reach))).await?;
        if !matches!(answer, Answer::Refused(_)) {
            break;
        }
    }
    Ok(answer)
}

async fn discover(desk: &Desk, profile: &Profile, reach: Reach, way: usize) -> Result<Answer, Stop> {
    match profile.discovery.get(way).copied().and_then(read_request) {
        Some(request) => desk.ask(reach, &request, Some(desk.short_wait(reach))).await,
        None => Ok(Answer::Silence),
    }
}

/// The reads whose answer shows the device, best first. Never empty for a profile of which anything can be read.
pub(super) fn signs(profile: &Profile) -> Vec<Group> {
    let any = || profile.points.iter().filter_map(single).take(1);
    let mut all = profile.fingerprint.clone();
    all.extend(profile.live_groups().into_iter().take(1));
    if all.is_empty() {
        all.extend(any());
    }
    all
}
