//! Which simulated sensor stands for a profile: the one place that knows devices by their names.

use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::{Group, Profile};

use super::course::Course;
use super::described::Described;
use super::gauge_cable::GaugeCable;
use super::level::Level;
use super::lvdt::{Lvdt, Motion};
use super::station::{Device, Reply};
use crate::time::Instant;

/// A sensor that moves, as `profile` describes it and with its factory settings: one that obeys its manual if there is
/// one, else one that is made of the profile.
pub fn sensor(profile: Profile, now: Instant) -> Box<dyn Device> {
    let own: Option<Box<dyn Device>> = match profile.id.as_str() {
        "lvdt" => Some(Box::new(Lvdt::new(profile.unit, Motion::Swing))),
        "gauge-cable" => Some(Box::new(GaugeCable::new(profile.unit, Course::Swing, now))),
        "level" => Some(Box::new(Level::new(profile.unit, Course::Swing))),
        _ => None,
    };
    let own = own.and_then(|mut device| fits(device.as_mut(), &profile, now).then_some(device));
    own.unwrap_or_else(|| Box::new(Described::new(profile)))
}

/// Whether the device is what the profile describes: a user's own file may have the name and say something else.
fn fits(device: &mut dyn Device, profile: &Profile, now: Instant) -> bool {
    let mut answers = |group: &Group| {
        let ([a, b], [c, d]) = (group.address.to_be_bytes(), group.quantity.to_be_bytes());
        let reply = device.serve(now, UnitId(profile.unit), &[group.function, a, b, c, d]);
        reply.is_some_and(|reply| reply.pdu.first() == Some(&group.function))
    };
    let answered = profile.live_groups().iter().all(&mut answers);
    answered && device.line() == profile.line && device.mode() == profile.mode
}

impl Device for Box<dyn Device> {
    fn line(&self) -> LineSettings {
        self.as_ref().line()
    }

    fn mode(&self) -> Mode {
        self.as_ref().mode()
    }

    fn is_listening(&self, now: Instant) -> bool {
        self.as_ref().is_listening(now)
    }

    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
        self.as_mut().serve(now, unit, pdu)
    }

    fn power_cycle(&mut self, now: Instant) {
        self.as_mut().power_cycle(now);
    }

    fn preset(&mut self, register: u16, value: u16) -> bool {
        self.as_mut().preset(register, value)
    }

    fn flash_writes(&self) -> u32 {
        self.as_ref().flash_writes()
    }
}
