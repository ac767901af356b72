//! What is told of a log beside its entries: what happened to the port between them, and the user's marks.

use std::collections::{BTreeMap, VecDeque};
use std::ops::RangeInclusive;

use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::segment::Event;
use buslens_codec::session::{Remark, Told};
use buslens_codec::transcript::Transcript;

use crate::desk::place;

/// Events between two entries that are kept; a line that is nothing but faults has no end of them.
const MOST_BETWEEN: usize = 256;

/// The diary of a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct Diary {
    /// Unix time of the origin of the log's clock, in microseconds.
    pub(crate) epoch_us: Option<u64>,
    /// Settings of the line before the first event that is kept.
    pub(crate) line: Option<(LineSettings, Mode)>,
    events: VecDeque<Happened>,
    marks: BTreeMap<u32, String>,
    /// What waits until the stream up to its place has become entries.
    waiting: VecDeque<(u64, Waiting)>,
}

/// Something that happened to the port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Happened {
    /// Number of the entry that came next.
    pub(crate) before: u32,
    /// When, in microseconds on the log's clock.
    pub(crate) at_us: u64,
    /// What.
    pub(crate) event: Event,
}

#[derive(Clone, Debug)]
enum Waiting {
    Event(u64, Event),
    Mark(String),
}

impl Diary {
    /// An empty diary of a log whose clock and line are known.
    pub(crate) fn new(epoch_us: Option<u64>, line: Option<(LineSettings, Mode)>) -> Self {
        Self { epoch_us, line, ..Self::default() }
    }

    /// Something happened when the stream had come to `at`.
    pub(crate) fn happen(&mut self, at: u64, at_us: u64, event: Event) {
        self.waiting.push_back((at, Waiting::Event(at_us, event)));
    }

    /// A session tells something.
    pub(crate) fn hear(&mut self, Remark { at, told }: Remark) {
        match told {
            Told::Epoch(epoch_us) => self.epoch_us = Some(epoch_us),
            Told::Line(line, mode) => self.line = Some((line, mode)),
            Told::Event { at_us, event } => self.happen(at as u64, at_us, event),
            Told::Mark(comment) => self.waiting.push_back((at as u64, Waiting::Mark(comment))),
        }
    }

    /// Finds the entries of what waits, as far as they are there.
    pub(crate) fn settle(&mut self, transcript: &Transcript) {
        while let Some(index) = self.waiting.front().and_then(|(at, _)| transcript.entry_at(*at)) {
            if matches!(self.waiting.front(), Some((_, Waiting::Mark(_)))) && index == transcript.end() {
                break;
            }
            match self.waiting.pop_front() {
                Some((_, Waiting::Event(at_us, event))) => {
                    let happened = Happened { before: place(index), at_us, event };
                    let first = self.events.len().checked_sub(MOST_BETWEEN).and_then(|first| self.events.get(first));
                    if first.is_none_or(|first| first.before != happened.before) {
                        self.events.push_back(happened);
                    }
                }
                Some((_, Waiting::Mark(comment))) => self.mark(place(index), Some(comment)),
                None => {}
            }
        }
    }

    /// What happened right before an entry, in order; behind the last one for the number behind it.
    pub(crate) fn before(&self, index: u32) -> impl ExactSizeIterator<Item = Happened> + '_ {
        let first = self.events.partition_point(|happened| happened.before < index);
        let behind = self.events.partition_point(|happened| happened.before <= index);
        self.events.range(first..behind).copied()
    }

    /// What happened right before any of these entries, in order.
    pub(crate) fn within(&self, entries: RangeInclusive<u32>) -> impl Iterator<Item = Happened> + '_ {
        let first = self.events.partition_point(|happened| happened.before < *entries.start());
        self.events.iter().skip(first).copied().take_while(move |happened| happened.before <= *entries.end())
    }

    /// Sets a mark, or takes it away.
    pub(crate) fn mark(&mut self, index: u32, comment: Option<String>) {
        match comment {
            Some(comment) => drop(self.marks.insert(index, comment)),
            None => drop(self.marks.remove(&index)),
        }
    }

    /// The comment of an entry that is marked.
    pub(crate) fn mark_of(&self, index: u32) -> Option<&str> {
        self.marks.get(&index).map(String::as_str)
    }

    /// Forgets what belongs to entries before `first`.
    pub(crate) fn forget_before(&mut self, first: u32) {
        while let Some(happened) = self.events.pop_front_if(|happened| happened.before < first) {
            if let Event::Opened(line, mode) = happened.event {
                self.line = Some((line, mode));
            }
        }
        if self.marks.first_key_value().is_some_and(|(index, _)| *index < first) {
            self.marks = self.marks.split_off(&first);
        }
    }

    /// Settings of the line when the first entry was made: by an event before it, else by what was told before.
    pub(crate) fn line_at_start(&self, first: u32) -> Option<(LineSettings, Mode)> {
        let opened = |happened: Happened| match happened.event {
            Event::Opened(line, mode) => Some((line, mode)),
            _ => None,
        };
        self.before(first).filter_map(opened).last().or(self.line)
    }
}
