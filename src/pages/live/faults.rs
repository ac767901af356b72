//! Every fault as sentences. What is wrong, which settings were in force, and what to try, the likeliest first.

use buslens_codec::pdu::ExceptionCode;

use crate::app::App;
use crate::components::alert::{Fault, Remedy};
use crate::components::shell::mode_name;
use crate::message::{OpenFault, Trouble};
use crate::reactive::prelude::*;
use crate::serial::{PickFault, SerialMissing};
use crate::text::Language;

/// What the sentences name.
pub(super) struct Facts {
    port: String,
    unit: u8,
    /// `9600 8E1 RTU`, as set now.
    settings: String,
    /// The same as the device leaves the factory.
    factory: String,
    /// The supply that the device needs, if its profile tells.
    supply: Option<String>,
    /// The names of the data wires, if the profile tells.
    data_wires: Option<(&'static str, &'static str)>,
}

impl Facts {
    pub(super) fn of(app: &'static App, port: String) -> Self {
        let device = app.settings.device();
        let language = app.language.get();
        let connection = app.connection.get();
        let in_force = connection.map_or((1, device.line(), device.mode()), |used| (used.unit.0, used.line, used.mode));
        let (unit, line, mode) = in_force;
        Self {
            port,
            unit,
            settings: [&line.to_string(), " ", mode_name(mode)].concat(),
            factory: [&device.line().to_string(), " ", mode_name(device.mode())].concat(),
            supply: device.supply(language),
            data_wires: device.data_wires(language),
        }
    }
}

/// The browser has no serial ports for this page.
pub(super) fn missing(language: Language, missing: SerialMissing) -> Fault {
    let t = language;
    match missing {
        SerialMissing::Unsupported => fault(
            "no-web-serial",
            t.no_web_serial(),
            t.no_web_serial_what(),
            &[t.no_web_serial_browser(), t.no_web_serial_phone(), t.no_web_serial_policy()],
        ),
        SerialMissing::InsecurePage => {
            fault("insecure", t.insecure(), t.insecure_what(), &[t.insecure_https(), t.insecure_localhost()])
        }
        SerialMissing::PermissionPolicy => {
            fault("policy", t.policy(), t.policy_what(), &[t.policy_own_tab(), t.policy_embed(), t.policy_admin()])
        }
    }
}

/// The picker brought no port.
pub(super) fn pick(language: Language, pick: &PickFault) -> Fault {
    let t = language;
    let told = match pick {
        PickFault::Missing(why) => return missing(language, *why),
        PickFault::Cancelled => fault(
            "picker-closed",
            t.picker_closed(),
            t.picker_closed_what(),
            &[t.picker_cable(), t.picker_driver(), t.picker_linux()],
        ),
        PickFault::Other(words) => fault("other", t.pick_other(), &t.open_other_what(words), &[]),
    };
    Fault { remedy: Some(Remedy::Dismiss), ..told }
}

/// The port could not be opened.
pub(super) fn open(language: Language, open: &OpenFault, facts: &Facts) -> Fault {
    let t = language;
    let port = &facts.port;
    match open {
        OpenFault::Busy => {
            fault("busy", t.busy(), &t.busy_what(port), &[t.busy_close(), t.busy_replug(), t.busy_linux()])
        }
        OpenFault::Missing => {
            fault("missing", t.missing(), &t.missing_what(port), &[t.missing_plug(), t.missing_choose()])
        }
        OpenFault::Forbidden => {
            fault("forbidden", t.forbidden(), &t.forbidden_what(port), &[t.forbidden_choose(), t.forbidden_admin()])
        }
        OpenFault::UnsupportedSettings => fault(
            "unsupported-settings",
            t.unsupported(),
            &t.unsupported_what(port, &facts.settings),
            &[t.unsupported_standard(), t.unsupported_bits()],
        ),
        OpenFault::NotLoaded => Fault {
            remedy: Some(Remedy::ConnectAgain),
            ..fault("not-loaded", t.not_loaded(), t.not_loaded_what(), &[t.not_loaded_network(), t.not_loaded_reload()])
        },
        OpenFault::Other(words) => {
            fault("other", t.open_other(), &t.open_other_what(words), &[t.busy_close(), t.busy_replug()])
        }
    }
}

/// The adapter has vanished.
pub(super) fn lost(language: Language, facts: &Facts) -> Fault {
    fault("lost", language.lost(), &language.lost_what(&facts.port), &[language.lost_socket()])
}

/// The device does not answer as it should.
pub(super) fn trouble(language: Language, trouble: &Trouble, facts: &Facts) -> Fault {
    let t = language;
    let told = match trouble {
        Trouble::Silence => silence(language, facts),
        Trouble::Garbage => {
            let other = if facts.settings == facts.factory {
                t.try_any_baud().to_owned()
            } else {
                t.try_other_baud(&facts.factory)
            };
            let tips = [other.as_str(), t.try_noise(), t.try_one_sensor()];
            fault("garbage", t.garbage(), &t.garbage_what(&facts.settings), &tips)
        }
        Trouble::BadCheck => fault(
            "bad-check",
            t.bad_check(),
            t.bad_check_what(),
            &[t.try_noise(), t.try_termination(), t.try_one_sensor()],
        ),
        Trouble::Exception { function, code } => exception(language, *function, *code, facts),
        Trouble::Late => fault("late", t.late(), t.late_what(), &[t.try_slower(), t.try_latency(), t.try_gateway()]),
        Trouble::BadValue => fault("bad-value", t.bad_value(), t.bad_value_what(), &[t.try_profile(), t.try_restart()]),
    };
    Fault { remedy: Some(Remedy::ChangeSettings), ..told }
}

fn silence(language: Language, facts: &Facts) -> Fault {
    let t = language;
    let power = facts.supply.as_ref().map_or_else(|| t.try_power().to_owned(), |supply| t.try_power_of(supply));
    let swap = facts.data_wires.map_or_else(|| t.try_swap().to_owned(), |(a, b)| t.try_swap_of(a, b));
    let settings = t.try_settings(&facts.settings, &facts.factory);
    let (title, unit) = if facts.unit == 0 {
        (t.silence_broadcast().to_owned(), t.unit_broadcast().to_owned())
    } else {
        (t.silence(facts.unit), t.try_unit(facts.unit))
    };
    fault("silence", &title, &t.silence_what(&facts.settings), &[&power, &swap, &unit, &settings, t.try_termination()])
}

fn exception(language: Language, function: u8, code: ExceptionCode, facts: &Facts) -> Fault {
    let t = language;
    let name = t.exception_name(code.code());
    let tips: &[&str] = match code.code() {
        5 | 6 => &[t.try_wait()],
        4 | 8 => &[t.try_restart()],
        _ => &[t.try_profile(), t.try_restart()],
    };
    fault("exception", &t.exception(code.code()), &t.exception_what(facts.unit, function & 0x7F, name), tips)
}

fn fault(id: &'static str, title: &str, what: &str, tips: &[&str]) -> Fault {
    let tips = tips.iter().map(|&tip| tip.to_owned()).collect();
    Fault { id, title: title.to_owned(), what: what.to_owned(), tips, remedy: None }
}
