//! Entries and their bytes, in pages: the oldest can be let go without touching the others.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::{Entry, EntryKind};
use crate::dissect::Direction;
use crate::line::Mode;
use crate::segment::Origin;

/// Entries of a page.
const PAGE: usize = 4096;
/// An entry without a time.
const NO_TIME: u64 = u64::MAX;

/// Entries in order, without gaps between them in the stream.
#[derive(Clone, Debug, Default)]
pub(super) struct Store {
    pages: VecDeque<Page>,
    /// Number of the first page's first entry.
    base: usize,
    /// Number of the first entry that has not been forgotten.
    first: usize,
    /// Number behind the last entry.
    end: usize,
    /// Bytes of the stream up to there.
    stream_len: u64,
    /// Changes of entries before this one are remembered.
    watched: usize,
    changed: Vec<u32>,
}

#[derive(Clone, Debug, Default)]
struct Page {
    /// Bytes of the stream before it.
    offset: u64,
    bytes: Vec<u8>,
    entries: Vec<Packed>,
    /// Empty as long as no entry has a line.
    lines: Vec<u32>,
}

/// An entry as it is kept.
#[derive(Clone, Copy, Debug)]
struct Packed {
    time_us: u64,
    /// Bytes of the page before it.
    start: u32,
    /// Way to the other half; 0 for none.
    pair: i32,
    span_us: u32,
    flags: Flags,
}

/// From the lowest bit: noise, ASCII mode, direction (2), mark (2), right check, echo, repeated, origin (3).
#[derive(Clone, Copy, Debug)]
struct Flags(u16);

impl Store {
    pub(super) fn first(&self) -> usize {
        self.first
    }

    pub(super) fn end(&self) -> usize {
        self.end
    }

    pub(super) fn stream_len(&self) -> u64 {
        self.stream_len
    }

    pub(super) fn get(&self, index: usize) -> Option<Entry> {
        let (page, slot) = self.place(index)?;
        let page = self.pages.get(page)?;
        page.entries.get(slot).map(|packed| packed.entry(page, slot, index))
    }

    /// An entry; [`Entry::BLANK`] for one that is forgotten.
    pub(super) fn at(&self, index: usize) -> Entry {
        self.get(index).unwrap_or(Entry::BLANK)
    }

    /// Whether an entry is a frame; `false` for one that is forgotten.
    pub(super) fn is_frame(&self, index: usize) -> bool {
        let packed = self.place(index).and_then(|(page, slot)| self.pages.get(page)?.entries.get(slot));
        packed.is_some_and(|packed| packed.flags.0 & 1 == 0)
    }

    /// Empty for an entry that is not there.
    pub(super) fn bytes(&self, index: usize) -> &[u8] {
        let found = self.place(index).and_then(|(page, slot)| {
            let page = self.pages.get(page)?;
            let start = page.entries.get(slot)?.start as usize;
            page.bytes.get(start..page.end_of(slot))
        });
        found.unwrap_or_default()
    }

    /// Adds an entry behind the last. Its offset and its length follow from the bytes.
    pub(super) fn push(&mut self, entry: &Entry, bytes: &[u8]) {
        if self.end.is_multiple_of(PAGE) {
            if let Some(full) = self.pages.back_mut() {
                full.bytes.shrink_to_fit();
            }
            // A short text needs less than a page.
            let room = if self.pages.is_empty() { 0 } else { PAGE };
            self.pages.push_back(Page {
                offset: self.stream_len,
                entries: Vec::with_capacity(room),
                ..Page::default()
            });
        }
        let index = self.end;
        let Some(page) = self.pages.back_mut() else { return };
        if entry.line > 0 {
            page.lines.resize(page.entries.len(), 0);
            page.lines.push(entry.line);
        }
        let start = u32::try_from(page.bytes.len()).unwrap_or(u32::MAX);
        page.entries.push(Packed::new(entry, start, index));
        page.bytes.extend_from_slice(bytes);
        self.stream_len = self.stream_len.saturating_add(bytes.len() as u64);
        self.end += 1;
    }

    /// The setters change nothing of an entry that is forgotten.
    pub(super) fn set_direction(&mut self, index: usize, direction: Direction) {
        self.change(index, |packed| packed.flags.set(2, 3, way(direction)));
    }

    pub(super) fn set_echo(&mut self, index: usize, echo: bool) {
        self.change(index, |packed| packed.flags.set(7, 1, echo.into()));
    }

    pub(super) fn set_repeated(&mut self, index: usize, repeated: bool) {
        self.change(index, |packed| packed.flags.set(8, 1, repeated.into()));
    }

    pub(super) fn set_pair(&mut self, index: usize, pair: Option<usize>) {
        self.change(index, |packed| packed.pair = pair.map_or(0, |pair| distance(index, pair)));
    }

    fn change(&mut self, index: usize, change: impl FnOnce(&mut Packed)) {
        let packed = self.place(index).and_then(|(page, slot)| self.pages.get_mut(page)?.entries.get_mut(slot));
        let Some(packed) = packed else { return };
        change(packed);
        if index < self.watched
            && let Ok(index) = u32::try_from(index)
        {
            self.changed.push(index);
        }
    }

    /// Forgets the entries before `first`.
    pub(super) fn forget_before(&mut self, first: usize) {
        self.first = first.clamp(self.first, self.end);
        while self.pages.len() > 1 && self.first - self.base >= PAGE {
            self.pages.pop_front();
            self.base += PAGE;
        }
    }

    pub(super) fn watch(&mut self, until: usize) {
        self.watched = until;
    }

    pub(super) fn take_changed(&mut self) -> Vec<u32> {
        core::mem::take(&mut self.changed)
    }

    /// Bytes of memory that the pages take.
    pub(super) fn footprint(&self) -> usize {
        let pages = self.pages.iter().map(|page| {
            page.bytes.capacity() + page.entries.capacity() * size_of::<Packed>() + page.lines.capacity() * 4
        });
        pages.sum::<usize>() + self.pages.capacity() * size_of::<Page>()
    }

    /// Page and place in it.
    #[inline]
    fn place(&self, index: usize) -> Option<(usize, usize)> {
        let at = index.checked_sub(self.base).filter(|_| index >= self.first)?;
        Some((at / PAGE, at % PAGE))
    }
}

impl Page {
    #[inline]
    fn end_of(&self, slot: usize) -> usize {
        self.entries.get(slot + 1).map_or(self.bytes.len(), |next| next.start as usize)
    }
}

impl Packed {
    fn new(entry: &Entry, start: u32, index: usize) -> Self {
        Self {
            time_us: entry.time_us.map_or(NO_TIME, |time| time.min(NO_TIME - 1)),
            start,
            pair: entry.pair.map_or(0, |pair| distance(index, pair as usize)),
            span_us: entry.span_us,
            flags: Flags::new(entry),
        }
    }

    #[inline]
    fn entry(&self, page: &Page, slot: usize, index: usize) -> Entry {
        let pair = u32::try_from(index).ok().and_then(|index| index.checked_add_signed(self.pair));
        let len = page.end_of(slot).saturating_sub(self.start as usize);
        let entry = Entry {
            offset: page.offset.saturating_add(u64::from(self.start)),
            len: u32::try_from(len).unwrap_or(u32::MAX),
            line: page.lines.get(slot).copied().unwrap_or(0),
            time_us: (self.time_us != NO_TIME).then_some(self.time_us),
            span_us: self.span_us,
            pair: pair.filter(|_| self.pair != 0),
            ..Entry::BLANK
        };
        self.flags.unpack(entry)
    }
}

/// From one entry to another.
fn distance(from: usize, to: usize) -> i32 {
    let number = |index: usize| i64::try_from(index).unwrap_or(i64::MAX);
    i32::try_from(number(to).saturating_sub(number(from))).unwrap_or(0)
}

fn way(direction: Direction) -> u16 {
    match direction {
        Direction::Unknown => 0,
        Direction::Request => 1,
        Direction::Response => 2,
    }
}

impl Flags {
    /// Puts a value into the bits of a mask from a place on.
    fn set(&mut self, place: u16, mask: u16, value: u16) {
        self.0 = self.0 & !(mask << place) | value << place;
    }

    fn new(entry: &Entry) -> Self {
        let bits = u16::from(entry.kind == EntryKind::Noise)
            | u16::from(entry.mode == Mode::Ascii) << 1
            | way(entry.direction) << 2
            | way(entry.mark) << 4
            | u16::from(entry.check_ok) << 6
            | u16::from(entry.echo) << 7
            | u16::from(entry.repeated) << 8;
        let origin = match entry.origin {
            Origin::Unknown => 0,
            Origin::Poll => 1,
            Origin::Console => 2,
            Origin::Sequence => 3,
            Origin::Configuration => 4,
        };
        Self(bits | origin << 9)
    }

    fn unpack(self, entry: Entry) -> Entry {
        let is = |bit: u16| self.0 >> bit & 1 == 1;
        let way = |bit: u16| match self.0 >> bit & 3 {
            1 => Direction::Request,
            2 => Direction::Response,
            _ => Direction::Unknown,
        };
        Entry {
            kind: if is(0) { EntryKind::Noise } else { EntryKind::Frame },
            mode: if is(1) { Mode::Ascii } else { Mode::Rtu },
            direction: way(2),
            mark: way(4),
            check_ok: is(6),
            echo: is(7),
            repeated: is(8),
            origin: match self.0 >> 9 {
                1 => Origin::Poll,
                2 => Origin::Console,
                3 => Origin::Sequence,
                4 => Origin::Configuration,
                _ => Origin::Unknown,
            },
            ..entry
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_small() {
        assert_eq!(size_of::<Packed>(), 24);
    }

    #[test]
    fn what_is_put_in_comes_out_until_it_is_forgotten() {
        let mut store = Store::default();
        let entry = |index: usize| Entry {
            offset: 2 * index as u64,
            len: 2,
            line: if index.is_multiple_of(3) { 0 } else { u32::try_from(index).unwrap() },
            time_us: (!index.is_multiple_of(5)).then_some(index as u64),
            span_us: 7,
            pair: u32::try_from(index ^ 1).ok(),
            kind: if index.is_multiple_of(7) { EntryKind::Noise } else { EntryKind::Frame },
            mode: if index.is_multiple_of(11) { Mode::Ascii } else { Mode::Rtu },
            direction: [Direction::Request, Direction::Response, Direction::Unknown][index % 3],
            mark: [Direction::Unknown, Direction::Request, Direction::Response][index % 3],
            check_ok: index.is_multiple_of(2),
            echo: index.is_multiple_of(13),
            repeated: index.is_multiple_of(17),
            origin: Origin::ALL[index % 5],
        };
        for index in 0..3 * PAGE + 5 {
            store.push(&entry(index), &[u8::try_from(index % 251).unwrap(), 1]);
        }
        store.forget_before(PAGE + 1);
        store.watch(2 * PAGE);
        for index in [2 * PAGE - 1, 2 * PAGE, 17] {
            store.set_pair(index, None);
        }
        assert_eq!(store.take_changed(), [u32::try_from(2 * PAGE - 1).unwrap()]);
        assert_eq!((store.get(PAGE), store.bytes(PAGE), store.pages.len()), (None, &[][..], 3));
        for index in PAGE + 1..3 * PAGE + 5 {
            let mut expected = entry(index);
            if index == 2 * PAGE - 1 || index == 2 * PAGE {
                expected.pair = None;
            }
            assert_eq!(store.get(index), Some(expected));
            assert_eq!(store.bytes(index), [u8::try_from(index % 251).unwrap(), 1]);
        }
        assert_eq!(store.get(3 * PAGE + 5), None);
    }
}
