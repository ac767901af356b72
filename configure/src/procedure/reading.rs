//! Reading parameters in as few requests as the device allows.

use std::time::Duration;

use buslens_codec::profile::{Group, Point};

use super::desk::{Desk, Stop};
use crate::request::{Answer, blocks, part_of, read_request, single};
use crate::snapshot::parameters;
use crate::{Ending, Phase, Reach, Read, Report};

/// How often a read is made that is not answered, or whose answer is damaged.
pub(super) const TRIES: u32 = 3;
/// A busy device is asked again after this.
const BUSY_PAUSE: Duration = Duration::from_millis(100);
/// Exceptions 05 (acknowledge) and 06 (server device busy): ask again later (application protocol, clause 7).
const BUSY: [u8; 2] = [5, 6];

/// Reads every parameter.
pub(super) async fn read_all(desk: &Desk) -> Report {
    let (profile, reach) = (desk.profile(), desk.reach());
    let points = parameters(&profile);
    match read_points(desk, reach, &points).await {
        Ok(reads) => {
            let answered = reads.iter().any(|(_, read)| *read != Read::NoAnswer) || points.is_empty();
            let mut snapshot = desk.snapshot(reach);
            for (point, read) in reads {
                snapshot.put(&profile, &point, read);
            }
            let ending = if answered { Ending::Done } else { Ending::NoAnswer };
            desk.report(ending, answered.then_some(reach), answered.then_some(snapshot))
        }
        Err(Stop::Cancelled) => desk.report(Ending::Cancelled, None, None),
        Err(Stop::ReadOnly) => desk.report(Ending::ReadOnly, None, None),
        Err(Stop::Gone | Stop::NotKept) => desk.report(Ending::Interrupted, None, None),
    }
}

/// Reads these points. A device that is silent once, again and for each point alone is not asked any more.
pub(super) async fn read_points(desk: &Desk, reach: Reach, points: &[&Point]) -> Result<Vec<(String, Read)>, Stop> {
    let profile = desk.profile();
    let mut open: Vec<&Point> = points.to_vec();
    let mut reads = Vec::new();
    let mut answered = false;
    let total = open.len();
    while !open.is_empty() {
        desk.progress(Phase::Reading, total - open.len(), total, None);
        let Some(block) = blocks(&profile, &open, &desk.device().refused).first().copied() else { break };
        let inside: Vec<&Point> = open.iter().copied().filter(|point| block.offset_of(point).is_some()).collect();
        let found = read_group(desk, reach, block, TRIES).await?;
        answered |= !matches!(found, Answer::Silence | Answer::Unclear);
        match found {
            Answer::Registers(registers) => {
                for point in &inside {
                    let own = part_of(block, point, &registers).map_or(Read::NoAnswer, Read::Registers);
                    reads.push((point.id.clone(), own));
                }
            }
            Answer::Refused(_) if inside.len() > 1 => {
                desk.learn(|device| device.refused.push(block));
                continue;
            }
            Answer::Refused(code) => reads.extend(inside.iter().map(|point| (point.id.clone(), Read::Refused(code)))),
            // Some devices do not answer what they do not like.
            _ if inside.len() > 1 && (answered || answers_alone(desk, reach, inside[0]).await?) => {
                answered = true;
                desk.learn(|device| device.refused.push(block));
                continue;
            }
            _ => reads.extend(inside.iter().map(|point| (point.id.clone(), Read::NoAnswer))),
        }
        open.retain(|point| block.offset_of(point).is_none());
        if !answered {
            reads.extend(open.drain(..).map(|point| (point.id.clone(), Read::NoAnswer)));
        }
    }
    Ok(reads)
}

async fn answers_alone(desk: &Desk, reach: Reach, point: &Point) -> Result<bool, Stop> {
    let Some(alone) = single(point) else { return Ok(false) };
    Ok(!matches!(read_group(desk, reach, alone, 1).await?, Answer::Silence | Answer::Unclear))
}

/// Makes one read, again if it is not answered.
pub(super) async fn read_group(desk: &Desk, reach: Reach, group: Group, tries: u32) -> Result<Answer, Stop> {
    let Some(request) = read_request(group) else { return Ok(Answer::Unclear) };
    let mut answer = Answer::Silence;
    for _ in 0..tries {
        answer = desk.ask(reach, &request, None).await?;
        match answer {
            Answer::Refused(code) if BUSY.contains(&code) => desk.pause(BUSY_PAUSE).await?,
            Answer::Silence | Answer::Unclear => {}
            _ => return Ok(answer),
        }
    }
    Ok(answer)
}
