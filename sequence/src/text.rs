//! A report as text, to be saved and read by people. The words are the caller's.

use core::fmt::Write;

use crate::report::{Entry, Mark, Report, Summary};

/// The words of a report in some language. Whole sentences or phrases, each on one line.
pub trait Words {
    /// What stands above the steps: title, device, verdict, counts, times.
    fn head(&self, summary: &Summary) -> Vec<String>;

    /// How a step went, in a word.
    fn mark(&self, mark: Mark) -> String;

    /// What there is to say of a step beside its bytes: what was compared, why it failed, what it logs.
    fn about(&self, entry: &Entry) -> Vec<String>;
}

impl Report {
    /// The report as text: a head, then each step with the number of its line, the time since the beginning in seconds, how
    /// it went, its line, the bytes that went out (`>>`) and came in (`<<`), and what there is to say of it. `source` is
    /// the text that was run.
    pub fn text(&self, source: &str, words: &impl Words) -> String {
        let marks = [Mark::Running, Mark::Passed, Mark::Failed, Mark::Skipped].map(|mark| (mark, words.mark(mark)));
        let width = marks.iter().map(|(_, word)| columns(word)).max().unwrap_or(0);
        let steps: Vec<&str> = source.lines().map(str::trim).collect();
        let mut text = String::new();
        for line in words.head(&self.summary) {
            push_line(&mut text, &line);
        }
        text.push('\n');
        for entry in &self.entries {
            let word = marks.iter().find(|(mark, _)| *mark == entry.mark).map_or("", |(_, word)| word.as_str());
            let since = entry.at_us.saturating_sub(self.summary.began_us);
            // A step that was never reached has no time.
            let since = if entry.time == 0 { String::new() } else { seconds(since) };
            let padding = width.saturating_sub(columns(word));
            let at = usize::try_from(entry.line).ok().and_then(|line| line.checked_sub(1));
            let step = at.and_then(|at| steps.get(at)).copied().unwrap_or_default();
            push_line(&mut text, &format!("{:>5}  {since:>10}  {word}{:padding$}  {step}", entry.line, ""));
            let indent = 5 + 2 + 10 + 2 + width + 2;
            let mut push_below = |below: &str| push_line(&mut text, &format!("{:indent$}{below}", ""));
            for exchange in &entry.exchanges {
                push_below(&format!(">> {}", hex(&exchange.sent)));
                if !exchange.heard.is_empty() {
                    let trip = exchange.round_trip_us.map(|micros| format!("  {} ms", thousandths(micros.into())));
                    push_below(&format!("<< {}{}", hex(&exchange.heard), trip.unwrap_or_default()));
                }
            }
            for line in words.about(entry) {
                push_below(&line);
            }
        }
        text
    }
}

fn push_line(text: &mut String, line: &str) {
    text.push_str(line.trim_end());
    text.push('\n');
}

/// Columns that a fixed font gives a word: Chinese characters take two.
fn columns(word: &str) -> usize {
    word.chars().map(|character| if character >= '\u{1100}' { 2 } else { 1 }).sum()
}

/// Seconds with four digits behind the point: 0.1 ms.
fn seconds(micros: u64) -> String {
    format!("{}.{:04}", micros / 1_000_000, micros % 1_000_000 / 100)
}

fn thousandths(micros: u64) -> String {
    format!("{}.{:01}", micros / 1000, micros % 1000 / 100)
}

fn hex(bytes: &[u8]) -> String {
    let mut text = String::new();
    for byte in bytes {
        let space = if text.is_empty() { "" } else { " " };
        let _ = write!(text, "{space}{byte:02X}");
    }
    text
}
