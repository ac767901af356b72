//! A report as a text file.

use buslens_codec::profile::Profile;
use buslens_configure::{Exchange, Report, Snapshot};

use super::ending::Told;
use super::words;
use crate::format::{hex_spaced, milliseconds};
use crate::text::Language;

/// The file's text: the ending, where the device is, every step with every frame.
pub(crate) fn text(
    language: Language,
    date: &str,
    profile: &Profile,
    report: &Report,
    told: &Told,
    have: &Snapshot,
) -> String {
    let t = language;
    let mut lines = vec![
        ["Buslens ", t.cfg_report()].concat(),
        date.to_owned(),
        words::pick(t, &profile.name).clone(),
        String::new(),
        told.title.to_owned(),
        told.what.clone(),
    ];
    lines.extend(told.list.iter().map(|fault| ["- ", fault].concat()));
    if let Some(at) = &report.reach {
        lines.push([t.cfg_where(), " ", &words::reach(t, at), " (", t.cfg_where_known(), ")"].concat());
    } else if !report.candidates.is_empty() {
        lines.push([t.cfg_where_unknown(), ":"].concat());
        lines.extend(report.candidates.iter().map(|at| ["- ", &words::reach(t, at)].concat()));
    }
    lines.push(t.cfg_writes(report.writes));
    lines.push(t.cfg_took(&words::tenths(report.took_us / 1000)));
    for (at, step) in report.steps.iter().enumerate() {
        let value = |registers: &[u16]| match profile.point(&step.point) {
            Some(point) => words::value(t, profile, point, registers, have),
            None => words::registers(registers),
        };
        let before = step.before.as_deref().map(|registers| [&value(registers), " -> "].concat()).unwrap_or_default();
        let outcome = words::outcome(t, &step.outcome, |read| words::read(t, profile, &step.point, read, have));
        lines.push(String::new());
        let name = words::name(t, profile, &step.point);
        lines.push([&(at + 1).to_string(), ". ", &name, ": ", &before, &value(&step.after)].concat());
        lines.push(["   ", &outcome].concat());
        for exchange in &step.exchanges {
            lines.extend(exchange_lines(t, exchange).map(|line| ["   ", &line].concat()));
        }
    }
    lines.push(String::new());
    lines.join("\n")
}

/// An exchange as two lines: what was sent, what was heard.
fn exchange_lines(language: Language, exchange: &Exchange) -> [String; 2] {
    let reach = words::reach(language, &exchange.reach);
    let heard =
        if exchange.heard.is_empty() { language.cfg_heard_nothing().to_owned() } else { hex_spaced(&exchange.heard) };
    let trip = exchange.round_trip_us.map(|trip| [" (", &milliseconds(trip), ")"].concat()).unwrap_or_default();
    [["TX ", &hex_spaced(&exchange.sent), "  [", &reach, "]"].concat(), ["RX ", &heard, &trip].concat()]
}

#[cfg(test)]
mod tests {
    use buslens_bus::record::End;
    use buslens_configure::{Ending, Reach, StepOutcome, StepReport};

    use super::*;
    use crate::configure::ending;
    use crate::device;

    #[test]
    fn the_file_has_the_ending_the_place_and_every_frame() {
        let profile = device::find("lvdt").profile();
        let reach = Reach::of_factory(profile);
        let have = Snapshot::empty(profile, reach);
        let sent = vec![0x01, 0x10, 0x00, 0x31];
        let exchange = Exchange { reach, sent, heard: Vec::new(), round_trip_us: Some(12_300), end: End::Silence };
        let step = StepReport {
            point: "baud".to_owned(),
            before: Some(vec![3]),
            after: vec![7],
            outcome: StepOutcome::Confirmed,
            exchanges: vec![exchange],
        };
        let report = Report {
            ending: Ending::Done,
            steps: vec![step],
            reach: Some(reach),
            candidates: Vec::new(),
            snapshot: None,
            journal: None,
            writes: 1,
            took_us: 1_234_000,
        };
        let told = ending::told(Language::En, profile, &report, &have);
        let text = text(Language::En, "2026-05-04", profile, &report, &told, &have);
        for line in [
            "Done",
            "The device is at 9600 8E1 \u{B7} RTU \u{B7} unit 1 (known by its reply)",
            "1. Baud rate: 9600 Bd -> 115200 Bd",
            "   read back: it holds",
            "   TX 01 10 00 31  [9600 8E1 \u{B7} RTU \u{B7} unit 1]",
            "   RX nothing (12.3 ms)",
            "took 1.3 s",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\n{text}");
        }
    }
}
