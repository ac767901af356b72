//! The steps that bring a device from what it holds to what is wanted, before anything is sent.

use buslens_codec::UnitId;
use buslens_codec::profile::{Danger, Effect, Known, Point, Profile, Role};
use buslens_codec::value::Encoding;
use serde::{Deserialize, Serialize};

use crate::edit::{check, needs_reading};
use crate::request::{frame, over, reply_frame, same, write_reply, write_request};
use crate::snapshot::decode;
use crate::{Edit, Reach, Read, Refusal, Snapshot, Unfit};

/// Below this, exchanges become slow (LVDT manual, section 2.2; the standard's own default is 19200 Bd).
const SLOW_BAUD: u32 = 9600;

/// The steps that bring a device from what it holds to what is wanted.
///
/// What is safe comes first: plain parameters, then the unit id, then the settings of the line, each a step, then commands,
/// and last of all what loses the device's settings. The unit id goes before the line, so that a new device can be added to
/// a line whose other devices still have the factory's unit id. What changes nothing is left out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// How the device is reached before.
    pub begins: Reach,
    /// In their order.
    pub steps: Vec<Step>,
    /// What needs a deliberate second action.
    pub hazards: Vec<Hazard>,
    /// Where the device will be on the way. Nobody else may be there: this is looked into before the first write.
    pub targets: Vec<Reach>,
    /// How the device is reached afterwards; `None` where it must be searched.
    pub ends: Option<Reach>,
}

/// One write.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Step {
    /// The point's id.
    pub point: String,
    /// What it holds before; `None` for a command, and where it was not read.
    pub before: Option<Vec<u16>>,
    /// What it shall hold, or the command.
    pub after: Vec<u16>,
    /// How the device is reached then.
    pub at: Reach,
    /// The bytes that go out.
    pub request: Vec<u8>,
    /// The reply of a device that does it, at the settings before; empty where nobody answers.
    pub reply: Vec<u8>,
    /// How the device is reached afterwards.
    pub then: After,
}

/// How a device is reached after a write.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum After {
    /// As before.
    Same,
    /// Differently.
    Moves(Reach),
    /// After a restart, during which it is deaf.
    Restarts {
        /// How.
        reach: Reach,
        /// So long it is deaf, in milliseconds.
        silence_ms: u32,
    },
    /// As it left the factory. Its unit id of then may not be known.
    Defaults {
        /// The likely ones.
        candidates: Vec<Reach>,
        /// So long it is deaf, in milliseconds.
        silence_ms: u32,
    },
    /// Nobody knows: it must be searched.
    Unknown {
        /// So long it is deaf, in milliseconds.
        silence_ms: u32,
    },
}

/// What can be lost, and needs a deliberate second action that names it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Hazard {
    /// All settings become those of the factory, the unit id and the line among them.
    Defaults {
        /// The command's point.
        point: String,
    },
    /// The unit id, the line and the calibration may be anything afterwards.
    Search {
        /// The command's point.
        point: String,
    },
    /// The profile says that this loses settings or a calibration.
    Grave {
        /// The point.
        point: String,
        /// What is written.
        registers: Vec<u16>,
    },
    /// The standard keeps unit ids above 247 for later use: other masters may not reach the device.
    ReservedUnit {
        /// The unit id.
        unit: u8,
    },
    /// So slow that every exchange takes long.
    SlowBaud {
        /// Bits per second.
        baud: u32,
    },
    /// The unit id is 0: every device on the line takes what is written.
    Broadcast,
}

impl Plan {
    /// The plan that brings these edits about in a device that holds what `have` tells. Everything that cannot be done is
    /// told at once. Before a parameter was read its steps have no `before`.
    pub fn of(profile: &Profile, have: &Snapshot, edits: &[Edit]) -> Result<Self, Vec<Refusal>> {
        let mut refused = Vec::new();
        let mut chosen: Vec<(&Point, &Edit)> = Vec::new();
        let known = have.known(profile);
        for edit in edits {
            let refuse = |why| Refusal { point: edit.point.clone(), why };
            let Some(point) = profile.point(&edit.point) else {
                refused.push(refuse(Unfit::UnknownPoint));
                continue;
            };
            if chosen.iter().any(|(other, _)| other.id == point.id) {
                refused.push(refuse(Unfit::Twice));
            } else if let Err(why) = check(profile, point, &edit.registers, &known) {
                refused.push(refuse(why));
            } else if needs_reading(point) && have.registers(&point.id).is_none() {
                refused.push(refuse(Unfit::NotRead));
            } else if order_of(point) == LAST && chosen.iter().any(|(other, _)| order_of(other) == LAST) {
                refused.push(refuse(Unfit::AfterLoss));
            } else {
                chosen.push((point, edit));
            }
        }
        chosen.sort_by_key(|(point, _)| order_of(point));
        let mut plan = Self {
            begins: have.reach,
            steps: Vec::new(),
            hazards: Vec::new(),
            targets: Vec::new(),
            ends: Some(have.reach),
        };
        let mut held = have.clone();
        for (point, edit) in chosen {
            if let Err(why) = plan.add(profile, point, &edit.registers, &mut held) {
                refused.push(Refusal { point: point.id.clone(), why });
            }
        }
        if have.reach.unit.0 == 0 && !plan.steps.is_empty() {
            plan.hazards.push(Hazard::Broadcast);
        }
        if refused.is_empty() { Ok(plan) } else { Err(refused) }
    }

    /// Every reach that the device may have on the way, the last one first.
    pub fn reaches(&self) -> Vec<Reach> {
        let mut all: Vec<Reach> = Vec::new();
        let of_steps = self.steps.iter().rev().flat_map(|step| match &step.then {
            After::Moves(reach) | After::Restarts { reach, .. } => vec![*reach],
            After::Defaults { candidates, .. } => candidates.clone(),
            After::Same | After::Unknown { .. } => Vec::new(),
        });
        for reach in of_steps.chain([self.begins]) {
            if !all.contains(&reach) {
                all.push(reach);
            }
        }
        all
    }

    /// Adds a step unless it changes nothing.
    fn add(&mut self, profile: &Profile, point: &Point, registers: &[u16], held: &mut Snapshot) -> Result<(), Unfit> {
        let is_command = point.role == Role::Command;
        let before = held.registers(&point.id).filter(|_| !is_command).map(<[u16]>::to_vec);
        let after = before.as_ref().map_or_else(|| registers.to_vec(), |before| over(point, registers, before));
        if before.as_ref().is_some_and(|before| same(point, before, &after)) {
            return Ok(());
        }
        let at = self.ends.ok_or(Unfit::AfterLoss)?;
        let then = after_write(profile, point, &after, at, &held.known(profile))?;
        let request = write_request(point, &after).ok_or(Unfit::NotItsRegisters)?;
        let reply = if at.unit.0 == 0 { None } else { write_reply(&request) };
        self.hazards.extend(hazard_of(profile, point, &after, &held.known(profile)));
        self.ends = match &then {
            After::Same => Some(at),
            After::Moves(reach) | After::Restarts { reach, .. } => Some(*reach),
            After::Defaults { .. } | After::Unknown { .. } => None,
        };
        if let Some(reach) = self.ends
            && reach != self.begins
            && !self.targets.contains(&reach)
        {
            self.targets.push(reach);
        }
        if !is_command {
            put_shared(profile, point, &after, held);
        }
        self.steps.push(Step {
            point: point.id.clone(),
            before,
            after,
            at,
            request: frame(at, &request).ok_or(Unfit::NotItsRegisters)?,
            reply: reply.and_then(|reply| reply_frame(at, &reply)).unwrap_or_default(),
            then,
        });
        Ok(())
    }
}

/// The last place in a plan.
const LAST: u8 = 8;

/// Where in a plan a point has its place.
fn order_of(point: &Point) -> u8 {
    let has = |effect: Effect| point.effects.contains(&effect);
    if has(Effect::Defaults) || has(Effect::Search) {
        LAST
    } else if point.role == Role::Command {
        if has(Effect::Restart) { 7 } else { 6 }
    } else if has(Effect::Baud) {
        5
    } else if has(Effect::Parity) || has(Effect::DataBits) || has(Effect::StopBits) {
        4
    } else if has(Effect::Mode) {
        3
    } else if has(Effect::Unit) {
        2
    } else {
        u8::from(has(Effect::Restart))
    }
}

/// How a device is reached after a write; refused where the profile should tell and does not.
pub(crate) fn after_write(
    profile: &Profile,
    point: &Point,
    registers: &[u16],
    at: Reach,
    known: &Known,
) -> Result<After, Unfit> {
    let restarts = point.effects.contains(&Effect::Restart);
    let silence_ms = if restarts { profile.timing.startup_silence_ms } else { 0 };
    if point.effects.contains(&Effect::Search) {
        return Ok(After::Unknown { silence_ms });
    }
    let value = decode(profile, point, registers, known).and_then(|found| found.value.ok()).ok_or(Unfit::TooLarge)?;
    let link = profile.link_after(point, value, at.link()).ok_or(Unfit::LeadsNowhere)?;
    let to = |unit| Reach { unit, line: link.line, mode: link.mode };
    Ok(match link.unit {
        None => {
            let factory = Reach::of_factory(profile).unit;
            let candidates = if factory == at.unit { vec![to(factory)] } else { vec![to(at.unit), to(factory)] };
            After::Defaults { candidates, silence_ms }
        }
        Some(unit) if restarts => After::Restarts { reach: to(unit), silence_ms },
        Some(unit) if to(unit) == at => After::Same,
        Some(unit) => After::Moves(to(unit)),
    })
}

/// The hazard of a write.
fn hazard_of(profile: &Profile, point: &Point, registers: &[u16], known: &Known) -> Option<Hazard> {
    let id = || point.id.clone();
    if point.effects.contains(&Effect::Search) {
        return Some(Hazard::Search { point: id() });
    }
    if point.effects.contains(&Effect::Defaults) {
        return Some(Hazard::Defaults { point: id() });
    }
    let value = decode(profile, point, registers, known)?.value.ok()?;
    if point.danger_of(value) == Danger::Danger {
        return Some(Hazard::Grave { point: id(), registers: registers.to_vec() });
    }
    let after = profile.link_after(point, value, Reach::of_factory(profile).link())?;
    if point.effects.contains(&Effect::Unit) && after.unit.is_some_and(UnitId::is_reserved) {
        return after.unit.map(|unit| Hazard::ReservedUnit { unit: unit.0 });
    }
    let slow = point.effects.contains(&Effect::Baud) && after.line.baud < SLOW_BAUD;
    slow.then_some(Hazard::SlowBaud { baud: after.line.baud })
}

/// Puts what is written into all points that have a share of the register.
fn put_shared(profile: &Profile, point: &Point, registers: &[u16], held: &mut Snapshot) {
    let shares = |other: &&Point| {
        let bits = |point: &Point| matches!(point.encoding, Encoding::Bits { .. });
        bits(point) && bits(other) && other.register == point.register && other.read == point.read
    };
    let others: Vec<&Point> = profile.points.iter().filter(shares).collect();
    for other in others.into_iter().chain([point]) {
        held.put(profile, &other.id, Read::Registers(registers.to_vec()));
    }
}
