//! Rows of the audit log in words.

use buslens_analyst::configure::{AuditFilter, AuditRow, DeviceKey};
use buslens_bus::record::{End, Origin};
use buslens_codec::profile::Profile;
use buslens_configure::Snapshot;

use crate::configure::words;
use crate::device;
use crate::text::Language;

/// A row in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Told {
    /// The device's name.
    pub(crate) device: String,
    /// The parameter or command; what is known of it where nobody but the bytes tells.
    pub(crate) point: String,
    /// What it held before; empty where that is not known.
    pub(crate) old: String,
    /// What was written.
    pub(crate) new: String,
}

/// A row in words.
pub(crate) fn told(language: Language, row: &AuditRow) -> Told {
    let entry = &row.entry;
    let profile = known(&entry.profile);
    let value = |registers: &[u16]| match profile.and_then(|profile| Some((profile, profile.point(&entry.point)?))) {
        // The log does not keep the scale that held when it was written.
        Some((profile, point)) if point.decimals_from.is_none() && !registers.is_empty() => {
            words::value(language, profile, point, registers, &Snapshot::empty(profile, entry.reach))
        }
        _ => words::registers(registers),
    };
    let point = match profile {
        _ if entry.point.is_empty() => language.fleet_point_unknown().to_owned(),
        Some(profile) => words::name(language, profile, &entry.point),
        None => entry.point.clone(),
    };
    Told {
        device: device_name(language, &entry.profile),
        point,
        old: entry.old.as_deref().map(value).unwrap_or_default(),
        new: value(&entry.new),
    }
}

/// The name of the device with this profile; its id where that is none of those known.
pub(crate) fn device_name(language: Language, profile: &str) -> String {
    let found = device::known(profile);
    match found {
        Some(device) => device.name(language).to_owned(),
        None if profile.is_empty() => language.fleet_device_unknown().to_owned(),
        None => profile.to_owned(),
    }
}

/// How many writes the memory of a device with this profile endures; 0 where that is not known.
pub(crate) fn endures(profile: &str) -> u32 {
    known(profile).map_or(0, |profile| profile.timing.flash_writes)
}

fn known(id: &str) -> Option<&'static Profile> {
    device::known(id).map(device::Device::profile)
}

/// How a write has ended.
pub(crate) fn end(language: Language, end: End) -> &'static str {
    match end {
        End::Answered => language.fleet_end_answered(),
        End::Broadcast => language.fleet_end_broadcast(),
        End::Heard => language.fleet_end_heard(),
        End::Silence => language.fleet_end_silence(),
        End::Damaged => language.fleet_end_damaged(),
        End::Doubtful => language.fleet_end_doubtful(),
        End::ReadOnly | End::NoPort | End::Withdrawn | End::Busy => language.fleet_end_not_sent(),
    }
}

/// Whether a write was acknowledged, for colours: an exception is an answer, too.
pub(crate) fn is_well(row: &AuditRow) -> bool {
    match row.entry.end {
        End::Broadcast => true,
        End::Answered => !is_refused(&row.entry.received, row.entry.reach.mode),
        _ => false,
    }
}

/// Whether a reply is an exception.
pub(crate) fn is_refused(received: &[u8], mode: buslens_codec::line::Mode) -> bool {
    use buslens_codec::line::Mode;
    use buslens_codec::{ascii, rtu};
    let function = match mode {
        Mode::Rtu => rtu::decode(received).ok().and_then(|adu| adu.pdu.first().copied()),
        Mode::Ascii => ascii::decode(received).ok().and_then(|adu| adu.pdu.first().copied()),
    };
    function.is_some_and(|function| function & 0x80 != 0)
}

/// Who had it written.
pub(crate) fn origin(language: Language, origin: Origin) -> &'static str {
    match origin {
        Origin::Configuration => language.origin_configuration(),
        Origin::Console => language.origin_console(),
        Origin::Sequence => language.origin_sequence(),
        Origin::Poll => language.origin_poll(),
        Origin::Unknown => "",
    }
}

/// A device's key as one text, for lists to choose from.
pub(crate) fn key_text(key: &DeviceKey) -> String {
    format!("{}/{}", key.profile, key.unit)
}

/// The filter for a key's text; everything for any other text.
pub(crate) fn filter(text: &str) -> AuditFilter {
    let found = text.rsplit_once('/').and_then(|(profile, unit)| Some((profile.to_owned(), unit.parse().ok()?)));
    found.map_or_else(AuditFilter::default, |(profile, unit)| AuditFilter { profile: Some(profile), unit: Some(unit) })
}

#[cfg(test)]
mod tests {
    use buslens_codec::line::Mode;
    use buslens_configure::{AuditEntry, Reach};

    use super::*;

    fn row(profile: &str, point: &str, old: Option<Vec<u16>>, new: Vec<u16>) -> AuditRow {
        let reach = Reach::of_factory(device::find(profile).profile());
        let entry = AuditEntry {
            unix_ms: 0,
            profile: profile.into(),
            reach,
            point: point.into(),
            old,
            new,
            sent: vec![],
            received: vec![0x01, 0x90, 0x03, 0x0C, 0x01],
            end: End::Answered,
        };
        AuditRow { simulated: false, origin: Origin::Configuration, entry }
    }

    #[test]
    fn a_row_is_told_in_the_profiles_words() {
        let told = told(Language::En, &row("lvdt", "baud", Some(vec![3]), vec![7]));
        assert_eq!((told.point.as_str(), told.old.as_str(), told.new.as_str()), ("Baud rate", "9600 Bd", "115200 Bd"));
    }

    #[test]
    fn what_has_lost_its_scale_is_told_by_its_registers() {
        let told = told(Language::En, &row("level", "zero_offset", Some(vec![0]), vec![0xFFFF]));
        assert_eq!((told.old.as_str(), told.new.as_str()), ("0000", "FFFF"));
    }

    #[test]
    fn bytes_of_the_console_and_unknown_devices_are_told_as_far_as_they_are_known() {
        let mut row = row("lvdt", "", None, vec![1, 2]);
        row.entry.profile = String::new();
        let told = told(Language::En, &row);
        assert_eq!((told.new.as_str(), told.old.as_str()), ("0001 0002", ""));
        assert!(!told.device.is_empty() && !told.point.is_empty());
    }

    #[test]
    fn an_exception_is_no_good_end() {
        assert!(!is_well(&row("lvdt", "baud", None, vec![7])));
        assert!(is_refused(&[0x01, 0x90, 0x03, 0x0C, 0x01], Mode::Rtu));
        assert!(!is_refused(&[], Mode::Rtu));
    }

    #[test]
    fn a_filter_is_remembered_as_a_text() {
        let key = DeviceKey { profile: "a/b".into(), unit: 12, simulated: false };
        assert_eq!(filter(&key_text(&key)), AuditFilter { profile: Some("a/b".into()), unit: Some(12) });
        assert_eq!(filter(""), AuditFilter::default());
    }
}
