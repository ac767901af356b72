//! The rows of a list that have come, by pages.

use buslens_analyst::message::{Row, Rows};

/// Rows that are asked for together.
pub(super) const PAGE: u32 = 64;
/// Pages that are remembered.
const MOST_PAGES: usize = 24;

/// Rows that have come, by pages.
#[derive(Clone, Debug, Default)]
pub(super) struct Pages {
    edition: u32,
    known: Vec<Page>,
    asked: Vec<Asked>,
}

#[derive(Clone, Debug)]
struct Page {
    number: u32,
    rows: Vec<Row>,
    /// How many rows the list had when it was asked for.
    shown: u32,
}

/// A page that was asked for.
#[derive(Clone, Copy, Debug)]
struct Asked {
    number: u32,
    /// How many rows it should have.
    full: u32,
    shown: u32,
}

impl Page {
    /// Whether what is still to come may change it: the answer to one of its requests.
    fn may_change(&self, shown: u32) -> bool {
        let last = shown.saturating_sub(1) / PAGE;
        self.shown != shown && self.number + 1 >= last && self.rows.iter().any(|row| row.unanswered)
    }
}

impl Pages {
    pub(super) fn row(&self, at: u32) -> Option<&Row> {
        let page = self.known.iter().find(|page| page.number == at / PAGE)?;
        page.rows.get((at % PAGE) as usize)
    }

    /// Pages to ask for, so that all rows up to `shown` come.
    pub(super) fn missing(&mut self, places: &std::ops::Range<u32>, shown: u32) -> Vec<u32> {
        if places.is_empty() {
            return Vec::new();
        }
        let wanted = places.start / PAGE..=(places.end - 1) / PAGE;
        let mut missing = Vec::new();
        for number in wanted {
            let full = shown.saturating_sub(number * PAGE).min(PAGE);
            let known = self.known.iter().find(|page| page.number == number);
            let lacks = known.is_none_or(|page| page.rows.len() < full as usize || page.may_change(shown));
            let asked = self.asked.iter().any(|asked| (asked.number, asked.full) == (number, full));
            if full > 0 && lacks && !asked {
                self.asked.retain(|asked| asked.number != number);
                self.asked.push(Asked { number, full, shown });
                missing.push(number);
            }
        }
        missing
    }

    /// Takes rows in; whether they are of use.
    pub(super) fn take(&mut self, Rows { edition, from, rows }: Rows) -> bool {
        if edition != self.edition {
            return false;
        }
        let number = from / PAGE;
        let shown = self.asked.iter().find(|asked| asked.number == number).map_or(0, |asked| asked.shown);
        self.asked.retain(|asked| asked.number != number);
        self.known.retain(|page| page.number != number);
        if self.known.len() >= MOST_PAGES {
            self.known.remove(0);
        }
        self.known.push(Page { number, rows, shown });
        true
    }

    /// Forgets rows of an earlier edition; whether there were any.
    pub(super) fn turn_to(&mut self, edition: u32) -> bool {
        let stale = self.edition != edition;
        if stale {
            self.edition = edition;
            self.forget();
        }
        stale
    }

    pub(super) fn forget(&mut self) {
        self.known.clear();
        self.asked.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(edition: u32, from: u32, count: u32) -> Rows {
        let row = |index| Row {
            index,
            offset: 0,
            line: 0,
            time_us: None,
            is_frame: false,
            mode: buslens_codec::line::Mode::Rtu,
            direction: buslens_codec::dissect::Direction::Unknown,
            pair: None,
            bytes: vec![],
            length: 0,
            request: vec![],
            told: vec![],
            diagnoses: vec![],
            unanswered: false,
            orphan: false,
            origin: buslens_bus::record::Origin::Unknown,
            gap_us: None,
            round_trip_us: None,
            before: vec![],
            mark: None,
        };
        Rows { edition, from, rows: (from..from + count).map(row).collect() }
    }

    #[test]
    fn a_page_is_asked_for_once_and_again_when_there_is_more_of_it() {
        let mut pages = Pages::default();
        assert_eq!(pages.missing(&(60..70), 100), [0, 1]);
        assert_eq!(pages.missing(&(60..70), 100), [0_u32; 0]);
        assert!(pages.take(rows(0, 64, 36)));
        assert_eq!(pages.row(99).map(|row| row.index), Some(99));
        assert!(pages.row(100).is_none() && pages.row(63).is_none());
        assert_eq!(pages.missing(&(64..100), 100), [0_u32; 0]);
        assert_eq!(pages.missing(&(64..100), 128), [1]);
    }

    #[test]
    fn rows_of_an_earlier_edition_are_not_shown() {
        let mut pages = Pages::default();
        assert!(pages.turn_to(3));
        assert!(!pages.take(rows(2, 0, 10)));
        assert!(pages.take(rows(3, 0, 10)));
        assert!(pages.turn_to(4));
        assert!(pages.row(0).is_none());
    }

    #[test]
    fn only_the_latest_pages_are_remembered() {
        let mut pages = Pages::default();
        for page in 0..100 {
            pages.take(rows(0, page * PAGE, PAGE));
        }
        assert_eq!(pages.known.len(), MOST_PAGES);
        assert!(pages.row(99 * PAGE).is_some() && pages.row(0).is_none());
    }

    #[test]
    fn a_page_whose_request_may_have_been_answered_since_is_asked_for_again() {
        let mut pages = Pages::default();
        assert_eq!(pages.missing(&(0..64), 64), [0]);
        let mut waiting = rows(0, 0, 64);
        waiting.rows[63].unanswered = true;
        assert!(pages.take(waiting));
        assert_eq!(pages.missing(&(0..64), 64), [0_u32; 0]);
        assert_eq!(pages.missing(&(0..64), 65), [0]);
        assert!(pages.take(rows(0, 0, 64)));
        assert_eq!(pages.missing(&(0..64), 66), [0_u32; 0]);
    }
}
