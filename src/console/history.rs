//! What was sent before, to be had back with the arrow keys.

use super::Line;

/// The most lines that are remembered.
const MOST: usize = 200;

/// Lines, the oldest first, and where the arrow keys have led to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct History {
    lines: Vec<Line>,
    /// Which of them stands in the field; `None` for what was being typed.
    at: Option<usize>,
    /// What was being typed when the arrow keys led away from it.
    draft: Line,
}

impl History {
    /// What was kept by [`History::kept`].
    pub(crate) fn from_kept(text: &str) -> Self {
        let lines: Vec<Line> = text.lines().filter_map(Line::from_kept).collect();
        let surplus = lines.len().saturating_sub(MOST);
        Self { lines: lines.into_iter().skip(surplus).collect(), ..Self::default() }
    }

    /// All lines as a text.
    pub(crate) fn kept(&self) -> String {
        let lines: Vec<String> = self.lines.iter().map(Line::kept).collect();
        lines.join("\n")
    }

    /// A line was sent: it is the newest now, and stands only there.
    pub(crate) fn push(&mut self, mut line: Line) {
        // A line holds no line end: the field has none.
        line.text = line.text.replace(['\r', '\n'], " ");
        self.lines.retain(|known| *known != line);
        if self.lines.len() >= MOST {
            self.lines.remove(0);
        }
        self.lines.push(line);
        self.at = None;
    }

    /// The line before the one in the field, which is `current`.
    pub(crate) fn older(&mut self, current: &Line) -> Option<Line> {
        let at = match self.at {
            None => {
                self.draft = current.clone();
                self.lines.len().checked_sub(1)?
            }
            Some(at) => at.checked_sub(1)?,
        };
        self.at = Some(at);
        self.lines.get(at).cloned()
    }

    /// The line after it, and at the end what was being typed.
    pub(crate) fn newer(&mut self) -> Option<Line> {
        let at = self.at? + 1;
        let next = self.lines.get(at).cloned();
        self.at = next.is_some().then_some(at);
        Some(next.unwrap_or_else(|| std::mem::take(&mut self.draft)))
    }

    /// Something else was typed: the arrow keys start from there.
    pub(crate) fn leave(&mut self) {
        self.at = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str) -> Line {
        Line { text: text.to_owned(), ..Line::default() }
    }

    fn history(texts: &[&str]) -> History {
        let mut history = History::default();
        for text in texts {
            history.push(line(text));
        }
        history
    }

    #[test]
    fn arrows_lead_back_and_forth_to_what_was_being_typed() {
        let mut history = history(&["01", "02"]);
        assert_eq!(history.newer(), None);
        assert_eq!(history.older(&line("half")), Some(line("02")));
        assert_eq!(history.older(&line("02")), Some(line("01")));
        assert_eq!(history.older(&line("01")), None);
        assert_eq!(history.newer(), Some(line("02")));
        assert_eq!(history.newer(), Some(line("half")));
        assert_eq!(history.newer(), None);
        assert_eq!(History::default().older(&line("")), None);
    }

    #[test]
    fn a_line_that_is_sent_again_is_the_newest() {
        let mut history = history(&["01", "02", "01"]);
        assert_eq!(history.older(&line("")), Some(line("01")));
        assert_eq!(history.older(&line("")), Some(line("02")));
        assert_eq!(history.older(&line("")), None);
    }

    #[test]
    fn so_many_are_kept_and_come_back() {
        let texts: Vec<String> = (0..MOST + 50).map(|number| format!("{number:04}")).collect();
        let mut history = history(&texts.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(history.lines.len(), MOST);
        assert_eq!(
            History::from_kept(&history.kept()),
            History { at: None, draft: Line::default(), ..history.clone() }
        );
        assert_eq!(history.older(&line("")), Some(line("0249")));
        assert_eq!(History::from_kept("nonsense\n\nhex rtu crc 01").lines, [line("01")]);
    }

    #[test]
    fn a_line_end_does_not_break_what_is_kept() {
        let history = history(&["01\n02"]);
        assert_eq!(History::from_kept(&history.kept()).lines, [line("01 02")]);
    }
}
