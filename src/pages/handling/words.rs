//! Commands, what they cost, and why they cannot be given, in words.

use buslens_analyst::configure::Hindrance;
use buslens_codec::profile::{Code, Point};
use buslens_codec::value::Value;
use buslens_configure::{Ending, Hazard, Report};

use crate::device::{self, Device};
use crate::message::Live;
use crate::text::{Label, Language};

/// Why no command can be given now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lock {
    /// A recording is played.
    Replay,
    /// Only reads are let out.
    ReadOnly,
    /// There is no open port.
    Closed,
}

/// Why no command can be given to the device now, if so.
pub(super) fn lock(live: &Live) -> Option<Lock> {
    if live.is_replay {
        Some(Lock::Replay)
    } else if live.read_only {
        Some(Lock::ReadOnly)
    } else {
        (!live.is_open).then_some(Lock::Closed)
    }
}

impl Lock {
    /// Its stable name, for tests.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Replay => "replay",
            Self::ReadOnly => "read-only",
            Self::Closed => "closed",
        }
    }

    pub(super) fn text(self) -> Label {
        match self {
            Self::Replay => Language::commands_locked_replay,
            Self::ReadOnly => Language::commands_locked_read_only,
            Self::Closed => Language::commands_locked_closed,
        }
    }
}

/// What stands on a command's button: the name of its code, of a point with one command its own.
pub(super) fn button(language: Language, point: &Point, code: &Code) -> String {
    let name = code.name.as_ref().filter(|_| point.codes.len() > 1).unwrap_or(&point.name);
    capital(device::pick(language, name))
}

/// What a command is called in a sentence.
pub(super) fn command(language: Language, point: &Point, code: &Code) -> String {
    let name = device::pick(language, &point.name);
    match code.name.as_ref().filter(|_| point.codes.len() > 1) {
        Some(code) => language.command_of(name, device::pick(language, code)),
        None => name.to_owned(),
    }
}

/// Why nothing was sent.
pub(super) fn hindrance(language: Language, outcome: &Result<Report, Hindrance>) -> Option<&'static str> {
    Some(match outcome {
        Err(Hindrance::Replay) => language.commands_locked_replay(),
        Err(Hindrance::Busy | Hindrance::Sequence | Hindrance::Sending) => language.command_busy(),
        Err(Hindrance::Store(_)) | Ok(Report { ending: Ending::NotKept, .. }) => language.command_not_kept(),
        Ok(Report { ending: Ending::Cancelled, .. }) => language.command_cancelled(),
        _ => return None,
    })
}

/// What can be lost, as far as the profile says it in its own words, else in general ones.
pub(super) fn hazard(language: Language, device: &Device, hazard: &Hazard) -> String {
    let told = |point: &str, value: Option<u16>| {
        let point = device.profile().point(point)?;
        // A point without values of its own says the same of all of them.
        let value = Value::Code(value.or_else(|| point.codes.first().map(|code| code.code))?);
        point.consequence_of(value).map(|texts| device::pick(language, texts).to_owned())
    };
    match hazard {
        Hazard::Defaults { point } => told(point, None).unwrap_or_else(|| language.hazard_defaults().to_owned()),
        Hazard::Search { point } => told(point, None).unwrap_or_else(|| language.hazard_search().to_owned()),
        Hazard::Grave { point, registers } => {
            told(point, registers.first().copied()).unwrap_or_else(|| language.hazard_grave().to_owned())
        }
        Hazard::ReservedUnit { unit } => language.hazard_reserved_unit(*unit),
        Hazard::SlowBaud { baud } => language.hazard_slow_baud(*baud),
        Hazard::Broadcast => language.hazard_broadcast().to_owned(),
    }
}

/// With a capital letter at its beginning, where the script has such.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buttons_say_what_the_profile_calls_its_commands() {
        let text = |device: &str, id: &str, code, language| {
            let point = device::find(device).profile().point(id).unwrap();
            button(language, point, point.code(code).unwrap())
        };
        assert_eq!(text("lvdt", "zero", 0xFF00, Language::En), "Zero here");
        assert_eq!(text("lvdt", "zero", 0, Language::Zh), "取消清零");
        assert_eq!(text("gauge-cable", "zero", 0xAB56, Language::En), "Zero");
        assert_eq!(text("gauge-cable", "clear_record", 0, Language::Zh), "清最大最小值");
    }

    #[test]
    fn every_dangerous_command_says_what_it_costs() {
        for device in device::all() {
            let profile = device.profile();
            let grave = profile.points.iter().flat_map(|point| point.codes.iter().map(move |code| (point, code)));
            for (point, code) in grave.filter(|(point, code)| {
                point.danger_of(Value::Code(code.code)) == buslens_codec::profile::Danger::Danger
            }) {
                for language in [Language::En, Language::Zh] {
                    let cost = Hazard::Grave { point: point.id.clone(), registers: vec![code.code] };
                    assert_ne!(
                        hazard(language, device, &cost),
                        language.hazard_grave(),
                        "{} {}",
                        device.id(),
                        point.id
                    );
                }
            }
        }
    }
}
