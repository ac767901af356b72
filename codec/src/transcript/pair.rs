//! Which way frames go, and which response answers which request.
//!
//! A line carries one transaction at a time, so a response belongs to the latest request that it fits. Writes are answered
//! by the request itself, and an adapter that hears what it sends repeats every request: of three equal frames the
//! second is the echo, of two the second is the response.

use alloc::borrow::Cow;
use alloc::collections::VecDeque;

use super::Entry;
use super::recover::{Units, is_right};
use super::store::Store;
use crate::diagnose::shape::{self, HEAD_LEN};
use crate::diagnose::{self, Surroundings};
use crate::dissect::Direction;
use crate::line::Mode;

/// Requests that are remembered until their response comes.
const MOST_OPEN: usize = 32;
/// An echo comes within this time, a retry does not: shorter than any master's patience, longer than any adapter's delay.
const LONGEST_ECHO_DELAY_US: u64 = 60_000;
/// Stretches of noise between two frames that still count as neighbours.
const MOST_NOISE_BETWEEN: usize = 4;

/// A frame's unit id and PDU; of a damaged frame as it was meant, where its damage tells.
pub(super) struct View<'a> {
    pub(super) unit: u8,
    pub(super) pdu: Cow<'a, [u8]>,
}

impl<'a> View<'a> {
    /// `None` where not even the function code is left.
    pub(super) fn of(mode: Mode, frame: &'a [u8], around: Surroundings<'_>) -> Option<Self> {
        if !is_right(mode, frame) {
            let damage = diagnose::damage(mode, frame, around);
            if let Some([unit, pdu @ ..]) = damage.iter().find_map(|found| found.repaired()) {
                let check = if mode == Mode::Rtu { 2 } else { 1 };
                let pdu = pdu.get(..pdu.len().saturating_sub(check))?;
                return Some(Self { unit: *unit, pdu: Cow::Owned(pdu.to_vec()) });
            }
        }
        match mode {
            Mode::Rtu => match frame {
                [unit, pdu @ .., _, _] if !pdu.is_empty() => Some(Self { unit: *unit, pdu: Cow::Borrowed(pdu) }),
                [unit, pdu @ ..] if !pdu.is_empty() => Some(Self { unit: *unit, pdu: Cow::Borrowed(pdu) }),
                _ => None,
            },
            Mode::Ascii => {
                let mut bytes = diagnose::ascii::bytes(&diagnose::ascii::digits(frame))?;
                bytes.pop();
                let pdu = bytes.split_off(1);
                Some(Self { unit: *bytes.first()?, pdu: Cow::Owned(pdu) })
            }
        }
    }
}

/// The frame before an entry, a little noise between them put aside.
pub(super) fn frame_before(entries: &Store, index: usize) -> Option<usize> {
    let earlier = (entries.first()..index.min(entries.end())).rev().take(MOST_NOISE_BETWEEN + 1);
    earlier.into_iter().find(|at| entries.is_frame(*at))
}

/// A request that waits for its response.
#[derive(Clone, Debug)]
struct Open {
    index: usize,
    /// Unit id and the PDU's beginning.
    head: [u8; HEAD_LEN + 1],
    len: usize,
}

impl Open {
    fn head(&self) -> &[u8] {
        self.head.get(..self.len).unwrap_or_default()
    }

    fn fits(&self, unit: u8, pdu: &[u8]) -> bool {
        let [asked, head @ ..] = self.head() else { return false };
        // A broadcast may be answered by the device's own unit id, and anything by the broadcast's.
        (*asked == unit || *asked == 0 || unit == 0) && shape::accepts(head, pdu)
    }
}

/// What pairing remembers.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairing {
    /// The latest last.
    open: VecDeque<Open>,
    units: Units,
    /// An echo has been proven: other equal frames are echoes rather than retries.
    hears_itself: bool,
}

/// What an entry and the frames before it are to each other.
enum Copies {
    /// No copy of the frame before.
    None,
    /// A copy of an unanswered request.
    Second,
    /// A copy of a response which is a copy of the request right before it.
    Third { request: usize, response: usize },
    /// A copy of a response which is, with an echo between, a copy of its request.
    Fourth { request: usize, echo: usize, response: usize },
}

impl Pairing {
    /// Unit id and the PDU's beginning of the request that the next frame may answer: the last frame before it.
    pub(super) fn expected(&self, entries: &Store) -> Option<&[u8]> {
        self.expected_before(entries, entries.end())
    }

    fn expected_before(&self, entries: &Store, index: usize) -> Option<&[u8]> {
        let before = frame_before(entries, index);
        self.open.back().filter(|open| Some(open.index) == before).map(Open::head)
    }

    pub(super) fn units(&self) -> &Units {
        &self.units
    }

    /// Finds the direction and the other half of the last entry, given as it was put in, with its bytes.
    pub(super) fn place(&mut self, entries: &mut Store, entry: &Entry, frame: &[u8]) {
        let Some(index) = entries.end().checked_sub(1) else { return };
        let request = self.expected_before(entries, index);
        let around = Surroundings { direction: entry.mark, request };
        let Some(View { unit, pdu }) = View::of(entry.mode, frame, around) else { return };
        if entry.check_ok {
            self.units.insert(unit);
        }
        let sides = shape::sides(&pdu);
        match (sides.request, sides.response) {
            (true, false) => self.ask(entries, index, unit, &pdu),
            (false, true) => self.answer(entries, index, unit, &pdu),
            (true, true) => self.either(entries, index, unit, &pdu),
            (false, false) => self.misshapen(entries, index, unit, &pdu),
        }
    }

    /// A request by its shape or by the source.
    fn ask(&mut self, entries: &mut Store, index: usize, unit: u8, pdu: &[u8]) {
        entries.set_direction(index, Direction::Request);
        if let Some(before) = frame_before(entries, index)
            && entries.at(before).is_unanswered()
            && is_copy(entries, before, index)
        {
            // What was sent and then came in has been heard.
            if (entries.at(before).mark, entries.at(index).mark) == (Direction::Request, Direction::Response) {
                entries.set_echo(index, true);
                self.hears_itself = true;
                return;
            }
            entries.set_repeated(index, true);
        }
        self.open(index, unit, pdu);
    }

    /// A response by its shape or by the source.
    fn answer(&mut self, entries: &mut Store, index: usize, unit: u8, pdu: &[u8]) {
        entries.set_direction(index, Direction::Response);
        let Some(at) = self.open.iter().rposition(|open| open.fits(unit, pdu)) else {
            self.answer_behind_echo(entries, index, pdu);
            return;
        };
        let Some(asked) = self.open.remove(at) else { return };
        let mut request = asked.index;
        if let Some(first) = self.first_of_echo(entries, request, index) {
            self.hears_itself = true;
            self.open.retain(|open| open.index != first);
            entries.set_echo(request, true);
            entries.set_repeated(request, false);
            request = first;
        }
        join(entries, request, index);
    }

    /// A frame that goes either way: the answer to a write is the request again.
    fn either(&mut self, entries: &mut Store, index: usize, unit: u8, pdu: &[u8]) {
        let copies = if shape::is_echoed(pdu) { copies(entries, index) } else { Copies::None };
        match entries.at(index).mark {
            Direction::Request => self.ask(entries, index, unit, pdu),
            Direction::Response => self.answer(entries, index, unit, pdu),
            Direction::Unknown => match copies {
                Copies::Second => self.answer(entries, index, unit, pdu),
                Copies::Third { request, response } => {
                    take_for_echo(entries, request, response);
                    entries.set_direction(index, Direction::Response);
                    join(entries, request, index);
                }
                Copies::Fourth { request, echo, response } if !self.hears_itself => {
                    entries.set_echo(echo, false);
                    entries.set_direction(echo, Direction::Response);
                    join(entries, request, echo);
                    entries.set_direction(response, Direction::Request);
                    entries.set_direction(index, Direction::Response);
                    join(entries, response, index);
                }
                Copies::Fourth { .. } => self.ask(entries, index, unit, pdu),
                Copies::None => {
                    let before = frame_before(entries, index);
                    let waits = self.open.back().filter(|open| Some(open.index) == before);
                    if waits.is_some_and(|open| open.fits(unit, pdu)) {
                        self.answer(entries, index, unit, pdu);
                    } else {
                        self.ask(entries, index, unit, pdu);
                    }
                }
            },
        }
    }

    /// A frame that is cut off or miscounted: the response to the request right before it, if it has its function.
    fn misshapen(&mut self, entries: &mut Store, index: usize, unit: u8, pdu: &[u8]) {
        let before = frame_before(entries, index);
        let function = pdu.first().map(|function| function & 0x7F);
        let waits = self.open.back().is_some_and(|open| {
            Some(open.index) == before
                && open.head().get(1).copied() == function
                && (open.head().first() == Some(&unit) || unit == 0)
        });
        let entry = entries.at(index);
        let is_response = pdu.first().is_some_and(|function| *function >= 0x80)
            || entry.mark == Direction::Response
            || (entry.mark == Direction::Unknown && waits);
        if !is_response {
            return;
        }
        entries.set_direction(index, Direction::Response);
        if waits
            && !entry.check_ok
            && let Some(open) = self.open.pop_back()
        {
            join(entries, open.index, index);
        }
    }

    fn open(&mut self, index: usize, unit: u8, pdu: &[u8]) {
        if self.open.len() >= MOST_OPEN {
            self.open.pop_front();
        }
        let mut open = Open { index, head: [0; HEAD_LEN + 1], len: 1 + pdu.len().min(HEAD_LEN) };
        for (place, byte) in open.head.iter_mut().zip(core::iter::once(&unit).chain(pdu)) {
            *place = *byte;
        }
        self.open.push_back(open);
    }

    /// The request of which `second` is the echo, now that `answer` is known to answer them.
    fn first_of_echo(&self, entries: &Store, second: usize, answer: usize) -> Option<usize> {
        if frame_before(entries, answer) != Some(second) || entries.at(second).mark == Direction::Request {
            return None;
        }
        let first = frame_before(entries, second)?;
        if !entries.at(first).is_unanswered() || !is_copy(entries, first, second) {
            return None;
        }
        if let (Some(sent), Some(heard)) = (entries.at(first).time_us, entries.at(second).time_us) {
            return (heard.wrapping_sub(sent) <= LONGEST_ECHO_DELAY_US).then_some(first);
        }
        // A third equal request says that nobody answered: then they are retries.
        let earlier = frame_before(entries, first);
        let is_retry =
            earlier.is_some_and(|earlier| entries.at(earlier).is_unanswered() && is_copy(entries, earlier, first));
        (self.hears_itself || !is_retry).then_some(first)
    }

    /// A response that no request waits for: what was taken for the answer before it may have been the echo.
    fn answer_behind_echo(&mut self, entries: &mut Store, index: usize, pdu: &[u8]) {
        let Some(before) = frame_before(entries, index) else { return };
        let Some(request) = entries.at(before).pair.map(|pair| pair as usize) else { return };
        let was_answered = entries.at(before).direction == Direction::Response
            && frame_before(entries, before) == Some(request)
            && is_copy(entries, request, before);
        let around = Surroundings { direction: Direction::Request, request: None };
        let asked = View::of(entries.at(request).mode, entries.bytes(request), around);
        if was_answered
            && let Some(View { pdu: asked, .. }) = asked
            && shape::accepts(asked.get(..HEAD_LEN).unwrap_or(&asked), pdu)
        {
            self.hears_itself = true;
            take_for_echo(entries, request, before);
            join(entries, request, index);
        }
    }
}

fn take_for_echo(entries: &mut Store, request: usize, copy: usize) {
    entries.set_echo(copy, true);
    entries.set_pair(copy, None);
    entries.set_direction(copy, Direction::Request);
    entries.set_pair(request, None);
}

fn join(entries: &mut Store, request: usize, response: usize) {
    entries.set_pair(request, Some(response));
    entries.set_pair(response, Some(request));
}

fn is_copy(entries: &Store, first: usize, second: usize) -> bool {
    let copy = entries.at(second);
    copy.check_ok && entries.bytes(first) == entries.bytes(second) && entries.at(first).mode == copy.mode
}

fn copies(entries: &Store, index: usize) -> Copies {
    let Some(before) = frame_before(entries, index).filter(|before| is_copy(entries, *before, index)) else {
        return Copies::None;
    };
    if entries.at(before).is_unanswered() {
        return Copies::Second;
    }
    let request = entries
        .at(before)
        .pair
        .map(|pair| pair as usize)
        .filter(|_| entries.at(before).direction == Direction::Response);
    let (Some(request), Some(earlier)) = (request, frame_before(entries, before)) else { return Copies::None };
    if earlier == request && is_copy(entries, request, before) {
        Copies::Third { request, response: before }
    } else if entries.at(earlier).echo && frame_before(entries, earlier) == Some(request) {
        Copies::Fourth { request, echo: earlier, response: before }
    } else {
        Copies::None
    }
}
