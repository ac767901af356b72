//! What a profile says in numbers, in words: how the device leaves the factory, and what it can take.

use buslens_codec::profile::{Effect, Interface, Point, Profile, Role};
use buslens_codec::value::Value;

use crate::components::shell::mode_name;
use crate::device::{pick, value_text};
use crate::format::{count, signed};
use crate::text::Language;

/// How the device leaves the factory: names and values.
pub(super) fn defaults(language: Language, profile: &Profile) -> Vec<(String, String)> {
    let interface = match profile.interface {
        Interface::Rs485 => "RS485",
        Interface::Rs232 => "RS232",
    };
    let mut rows = vec![
        (language.device_help_line().to_owned(), [interface, " · ", &profile.line.to_string()].concat()),
        (language.device_help_mode().to_owned(), mode_name(profile.mode).to_owned()),
    ];
    // Where each device has a number of its own, the point says so.
    let unit = match profile.points.iter().find(|point| point.effects.contains(&Effect::Unit)) {
        Some(Point { factory: None, note: Some(note), .. }) => pick(language, note).to_owned(),
        Some(Point { factory: None, .. }) => language.device_help_usually(profile.unit),
        _ => profile.unit.to_string(),
    };
    rows.push((language.device_help_unit().to_owned(), unit));
    // The line is told above.
    let others = profile.points.iter().filter(|point| point.effects.is_empty());
    rows.extend(others.filter_map(|point| Some((pick(language, &point.name).to_owned(), factory(language, point)?))));
    rows
}

/// What a point holds when it leaves the factory.
fn factory(language: Language, point: &Point) -> Option<String> {
    let value = point.decode(&[point.factory?]).ok()?;
    Some(with_unit(&value_text(language, point, value), &point.unit))
}

/// What the device can take: names and values.
pub(super) fn limits(language: Language, profile: &Profile) -> Vec<(String, String)> {
    let timing = &profile.timing;
    let mut rows = Vec::new();
    let mut row = |name: &str, value: String| rows.push((name.to_owned(), value));
    if !profile.supply.is_empty() {
        row(language.device_help_supply(), profile.supply.replace('-', "\u{2013}"));
    }
    let from_to = |first: &str, last: &str| language.device_help_from_to(first, last);
    row(language.device_help_units(), from_to(&profile.units.first.to_string(), &profile.units.last.to_string()));
    if !profile.choices.bauds.is_empty() {
        let bauds: Vec<String> = profile.choices.bauds.iter().map(u32::to_string).collect();
        row(language.device_help_bauds(), bauds.join(", "));
    }
    for point in profile.points.iter().filter(|point| point.role == Role::Measurement) {
        let name = |id: &str| profile.point(id).map(|point| pick(language, &point.name));
        let told = point.limits_from.as_ref().and_then(|limits| name(&limits.first).zip(name(&limits.last)));
        let own = point.range.map(|range| {
            let [first, last] = [range.first, range.last].map(|end| value_text(language, point, Value::Number(end)));
            with_unit(&from_to(&first, &last), &point.unit)
        });
        let told = told.map(|(first, last)| language.device_help_limits_of(first, last));
        if let Some(text) = own.or(told) {
            row(pick(language, &point.name), text);
        }
    }
    if timing.startup_silence_ms > 0 {
        row(language.device_help_startup(), language.device_help_silent(&time(timing.startup_silence_ms)));
    }
    row(language.device_help_answer(), language.device_help_within(&time(timing.response_timeout_ms)));
    let (usual, least) = (timing.poll_period_ms, timing.min_poll_period_ms);
    row(language.device_help_readings(), language.device_help_every(&time(usual), &time(least.max(1))));
    if timing.min_write_period_ms > 0 {
        let mut text = language.device_help_one_in(&time(timing.min_write_period_ms));
        if timing.flash_writes > 0 {
            text = [&text, " · ", &language.device_help_endures(&count(timing.flash_writes.into()))].concat();
        }
        row(language.device_help_writes(), text);
    }
    if timing.inter_device_pause_ms > 0 {
        row(language.device_help_pause(), language.device_help_wait(&time(timing.inter_device_pause_ms)));
    }
    rows
}

/// `1.5 s`, or `100 ms` below a second.
fn time(milliseconds: u32) -> String {
    if milliseconds < 1000 {
        return [&milliseconds.to_string(), " ms"].concat();
    }
    let seconds = buslens_codec::value::Decimal { mantissa: milliseconds.into(), decimals: 3 }.to_string();
    [seconds.trim_end_matches('0').trim_end_matches('.'), " s"].concat()
}

fn with_unit(text: &str, unit: &str) -> String {
    signed([text, " ", unit].concat().trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device;

    fn shown(rows: &[(String, String)]) -> Vec<String> {
        rows.iter().map(|(name, value)| [name, ": ", value].concat()).collect()
    }

    #[test]
    fn factory_settings_are_told_once() {
        let rows = shown(&defaults(Language::En, device::find("lvdt").profile()));
        assert_eq!(rows[..2], ["Line: RS485 · 9600 8E1", "Mode: RTU"]);
        assert!(rows[2].starts_with("Address: Leaves the factory as the number on the housing"), "{rows:?}");
        assert_eq!(rows[3..], ["Compensation: off", "Sample rate: 10 Hz"]);
        let rows = shown(&defaults(Language::En, device::find("level").profile()));
        assert_eq!(rows[2..], ["Address: usually 1", "Zero offset: 0"]);
    }

    #[test]
    fn limits_are_those_of_the_profile() {
        let all = |id| shown(&limits(Language::En, device::find(id).profile()));
        let lvdt = all("lvdt");
        for row in [
            "Supply: 9\u{2013}28 V DC",
            "Addresses: 1 to 247",
            "After power-on: it does not answer for 1.5 s",
            "Readings: usually every 100 ms, never faster than every 40 ms",
            "Before another device is asked: wait 100 ms",
        ] {
            assert!(lvdt.iter().any(|found| found == row), "{row}: {lvdt:?}");
        }
        assert!(all("gauge-cable").iter().any(|row| row == "Reading: \u{2212}65.535 to 65.535 mm"));
        assert!(all("level").iter().any(|row| row.contains("“Range zero” to “Range full”")));
    }
}
