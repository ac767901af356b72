//! Ready-made sequences: an acceptance test for each built-in device.

/// Their texts. Which device one is for, its `device` line tells.
pub const READY: &[&str] =
    &[include_str!("../ready/lvdt.txt"), include_str!("../ready/gauge-cable.txt"), include_str!("../ready/level.txt")];

/// The id that a text's `device` line names, and its `title`, without looking for faults in the rest.
pub fn outline(text: &str) -> (Option<&str>, Option<&str>) {
    let after = |word| {
        let mut lines = text.lines().map(str::trim).filter_map(move |line| line.strip_prefix(word));
        lines.find(|rest| rest.starts_with(char::is_whitespace)).map(str::trim)
    };
    let title = after("title").and_then(|title| title.strip_prefix('"')?.split('"').next());
    (after("device").and_then(|id| id.split_whitespace().next()), title)
}
