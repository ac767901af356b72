//! The steps of a run, growing while it goes on, and its report.

use buslens_sequence::{Entry, Mark, Words};

use super::words::{self, Written};
use crate::components::button::{bare, icon_button};
use crate::components::icon::Icon;
use crate::console::sequences::file_name;
use crate::dom::{self, El, el};
use crate::format::{self, hex_spaced};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// Steps that are drawn. All are in the report.
const MOST: usize = 300;
/// Bytes of an exchange that are drawn.
const MOST_BYTES: usize = 300;

/// The steps, the verdict, and the report.
pub(super) fn steps(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    let ran = Memo::new(move |_| sequences.ran.with(Option::is_some));
    el("div").class("contents").live_one(move || {
        if !ran.get() {
            return Some(el("div").class("pane-empty").child(el("p").say(app, Language::seq_steps_none)));
        }
        Some(el("div").class("contents").child(ending(app)).live_one(move || {
            // Another run or another language draws everything anew.
            let language = app.language.get();
            sequences.ran.track();
            Some(list(app, language))
        }))
    })
}

/// Why it has ended, and what can be done with the report.
fn ending(app: &'static Workbench) -> El {
    let sequences = &app.console.sequences;
    let ended = Memo::new(move |_| {
        sequences.summary.with(|summary| summary.as_ref().and_then(|all| Some((all.ended?, all.verdict))))
    });
    el("div").class("contents").live_one(move || {
        let (ended, verdict) = ended.get()?;
        let language = app.language.get();
        let copied = RwSignal::new(false);
        let save = icon_button(app, "small", "sequence-save", Icon::File, Language::seq_save).click(move || {
            let name = file_name(&sequences.name());
            dom::save_text(&report(app), "text/plain", &[&name, "-report.txt"].concat());
        });
        let copy = bare("quiet small", "sequence-report-copy")
            .attr("aria-live", "polite")
            .live_text(move || {
                let language = app.language.get();
                if copied.get() { language.seq_copied() } else { language.seq_copy() }.to_owned()
            })
            .click(move || crate::clipboard::copy(&report(app), "sequence-steps", copied));
        let (passed, failed) = sequences
            .summary
            .with_untracked(|summary| summary.as_ref().map_or((0, 0), |summary| (summary.passed, summary.failed)));
        let told = [language.seq_counts(passed, failed), words::ended(language, ended).to_owned()].join(". ");
        Some(
            el("div")
                .class("seq-ending")
                .attr("data-verdict", words::verdict_key(verdict))
                .attr("role", "status")
                .test("sequence-ending")
                .child(el("b").text(words::verdict(language, verdict)))
                .child(el("span").text(&told))
                .child(el("span").class("seq-answers").child(save).child(copy)),
        )
    })
}

/// The report in the language of the page.
fn report(app: &'static Workbench) -> String {
    let sequences = &app.console.sequences;
    let ran = sequences.ran.get_untracked().unwrap_or_default();
    let written = Written { language: app.language.get_untracked(), date: ran.date };
    sequences.report.with_value(|report| report.text(&ran.text, &written))
}

/// The rows. New entries are added to them, and those that have changed drawn anew; what is old is taken away.
fn list(app: &'static Workbench, language: Language) -> El {
    let sequences = &app.console.sequences;
    let source: Vec<String> = sequences
        .ran
        .with_untracked(|ran| ran.as_ref().map(|ran| ran.text.lines().map(|line| line.trim().to_owned()).collect()))
        .unwrap_or_default();
    let earlier = RwSignal::new(0_usize);
    let rows = el("ol").class("seq-steps").attr("id", "sequence-steps").test("sequence-steps");
    let place = rows.handle();
    let mut drawn: Vec<El> = Vec::new();
    let mut first = 0;
    let mut scrolled = 0.0;
    sequences.undrawn.set_value(0);
    dom::react(move || {
        sequences.turn.track();
        let from = sequences.undrawn.get_value();
        sequences.report.with_value(|report| {
            sequences.undrawn.set_value(report.entries.len());
            let begun =
                sequences.summary.with_untracked(|summary| summary.as_ref().map_or(0, |summary| summary.began_us));
            // Whoever has scrolled away from the end stays where they are.
            let follows = place.scroll_top() + 4.0 >= scrolled;
            let start = report.entries.len().saturating_sub(MOST);
            if from < first {
                first = start;
            }
            for old in drawn.drain(from.saturating_sub(first).min(drawn.len())..) {
                old.remove();
            }
            for entry in report.entries.iter().skip(first + drawn.len()) {
                let row = row(language, entry, begun, &source);
                place.append(&row);
                drawn.push(row);
            }
            for old in drawn.drain(..drawn.len().saturating_sub(MOST)) {
                old.remove();
                first += 1;
            }
            earlier.set(first);
            if follows {
                place.set_scroll_top(1e6);
                scrolled = place.scroll_top();
            }
        });
    });
    el("div")
        .class("contents")
        .live_one(move || {
            let count = Some(earlier.get()).filter(|count| *count > 0)?;
            Some(el("p").class("seq-hint").attr("data-kind", "info").text(&language.seq_earlier(count)))
        })
        .child(rows)
}

fn row(language: Language, entry: &Entry, begun_us: u64, source: &[String]) -> El {
    let at = usize::try_from(entry.line).unwrap_or(usize::MAX).wrapping_sub(1);
    let step = source.get(at).map_or("", String::as_str);
    let time = if entry.time == 0 { String::new() } else { seconds(entry.at_us.saturating_sub(begun_us)) };
    let state = match entry.mark {
        Mark::Running => "running",
        Mark::Passed => "passed",
        Mark::Failed => "failed",
        Mark::Skipped => "skipped",
    };
    let exchanges = entry.exchanges.iter().flat_map(|exchange| {
        let bytes = |way: &'static str, bytes: &[u8]| {
            let shown = bytes.get(..MOST_BYTES).unwrap_or(bytes);
            let mut text = hex_spaced(shown);
            if shown.len() < bytes.len() {
                text.push_str(" …");
            }
            el("p").class("seq-bytes").attr("data-way", way).child(el("b").text(way)).child(el("code").text(&text))
        };
        let heard = (!exchange.heard.is_empty()).then(|| {
            let trip =
                exchange.round_trip_us.map(|micros| el("small").class("muted").text(&format::milliseconds(micros)));
            bytes("RX", &exchange.heard).children(trip)
        });
        [Some(bytes("TX", &exchange.sent)), heard].into_iter().flatten()
    });
    let about = words::about(language, entry);
    let about = about.iter().map(|line| el("p").class("seq-about").text(line));
    el("li")
        .attr("data-mark", state)
        .test("sequence-step")
        .child(
            el("div")
                .class("seq-step")
                .child(
                    el("span")
                        .class("seq-line")
                        .attr("title", &language.seq_at_line(entry.line))
                        .text(&entry.line.to_string()),
                )
                .child(el("code").class("seq-source").text(step))
                .child(el("small").class("muted").text(&time))
                .child(el("span").class("seq-mark").text(words::mark(language, entry.mark))),
        )
        .children(exchanges)
        .children(about)
}

/// Seconds with four digits behind the point.
fn seconds(micros: u64) -> String {
    let tenths = (micros / 100).to_string();
    let padded = ["0000".get(tenths.len().min(4)..).unwrap_or_default(), &tenths].concat();
    let padded = if padded.len() == 4 { ["0", &padded].concat() } else { padded };
    let point = padded.len().saturating_sub(4);
    let (whole, fraction) = padded.split_at_checked(point).unwrap_or((&padded, ""));
    [whole, ".", fraction].concat()
}

impl Words for Written {
    fn head(&self, summary: &buslens_sequence::Summary) -> Vec<String> {
        words::head(self, summary)
    }

    fn mark(&self, mark: Mark) -> String {
        words::mark(self.language, mark).to_owned()
    }

    fn about(&self, entry: &Entry) -> Vec<String> {
        words::about(self.language, entry)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_four_digits_behind_the_point() {
        let times = [0, 99, 12_345, 999_999, 1_000_000, 61_234_567].map(seconds);
        assert_eq!(times, ["0.0000", "0.0000", "0.0123", "0.9999", "1.0000", "61.2345"]);
    }
}
