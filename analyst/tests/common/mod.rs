//! Traffic of a line as notes, and what the tests ask of a desk.
#![allow(dead_code)] // each test file uses a part

use buslens_analyst::Desk;
use buslens_analyst::message::{Format, Row};
use buslens_bus::record::{Event, Note, Origin, What};
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::pdu::{Request, Response};
use buslens_codec::rtu;
use proptest::prelude::*;

pub(crate) const LINE: LineSettings = LineSettings::new(9600, Parity::Even);

pub(crate) fn note(at_us: u64, what: What) -> Note {
    Note { at_us, what }
}

pub(crate) fn sent(at_us: u64, origin: Origin, bytes: Vec<u8>) -> Note {
    note(at_us, What::Sent { origin, bytes })
}

pub(crate) fn received(at_us: u64, bytes: Vec<u8>) -> Note {
    note(at_us, What::Received(bytes))
}

pub(crate) fn opened(at_us: u64) -> Note {
    note(at_us, What::Port(Event::Opened(LINE, Mode::Rtu)))
}

pub(crate) fn frame(unit: u8, pdu: &[u8]) -> Vec<u8> {
    rtu::encode(UnitId(unit), pdu).unwrap()
}

pub(crate) fn ask(unit: u8, address: u16, quantity: u16) -> Vec<u8> {
    frame(unit, &Request::ReadHoldingRegisters { address, quantity }.encode().unwrap())
}

pub(crate) fn answer(unit: u8, values: &[u16]) -> Vec<u8> {
    frame(unit, &Response::ReadHoldingRegisters { values: values.to_vec() }.encode().unwrap())
}

/// All rows of the list, as it is filtered.
pub(crate) fn rows(desk: &Desk) -> Vec<Row> {
    let mut rows = Vec::new();
    loop {
        let more = desk.rows(u32::try_from(rows.len()).unwrap(), 512).rows;
        if more.is_empty() {
            return rows;
        }
        rows.extend(more);
    }
}

pub(crate) fn file(desk: &Desk, format: Format) -> Vec<u8> {
    let mut file = Vec::new();
    desk.export(format, |part| file.extend_from_slice(part));
    file
}

pub(crate) fn text(desk: &Desk, format: Format) -> String {
    String::from_utf8(file(desk, format)).unwrap()
}

/// A desk that has read a text to its end.
pub(crate) fn read(text: &str) -> Desk {
    let mut desk = Desk::new();
    desk.begin(1, None, text.len() as u64);
    desk.push(text, text.len() as u64);
    desk.finish();
    while desk.work(1000) {}
    desk
}

/// Something that happens on a line.
#[derive(Clone, Debug)]
pub(crate) enum Act {
    /// A request and its answer, which arrives in this many chunks.
    Exchange(u8, u16, Vec<u16>, usize),
    /// The same request without an answer.
    Silence(u8, u16),
    Refusal(u8),
    /// Both halves only heard, in one chunk.
    Foreign(u8, Vec<u16>),
    /// A write that is answered by itself, heard with its echo.
    Write(u16),
    Noise(Vec<u8>),
    Raw(Vec<u8>),
    /// An answer with a wrong bit.
    Damaged(u8, usize),
    What(What),
    Wait(u64),
}

pub(crate) fn any_act() -> impl Strategy<Value = Act> {
    let unit = 1u8..4;
    let values = || prop::collection::vec(any::<u16>(), 1..6);
    let bytes = || prop::collection::vec(any::<u8>(), 1..12);
    prop_oneof![
        6 => (unit.clone(), any::<u16>(), values(), 1usize..4).prop_map(|(a, b, c, d)| Act::Exchange(a, b, c, d)),
        2 => (unit.clone(), 0u16..3).prop_map(|(a, b)| Act::Silence(a, b)),
        1 => unit.clone().prop_map(Act::Refusal),
        2 => (unit.clone(), values()).prop_map(|(a, b)| Act::Foreign(a, b)),
        1 => any::<u16>().prop_map(Act::Write),
        1 => bytes().prop_map(Act::Noise),
        1 => bytes().prop_map(Act::Raw),
        1 => (unit, any::<prop::sample::Index>()).prop_map(|(a, b)| Act::Damaged(a, b.index(40))),
        1 => prop_oneof![
            Just(What::Port(Event::LineError)),
            Just(What::Port(Event::Closed)),
            Just(What::Port(Event::Lost)),
            Just(What::Port(Event::Opened(LineSettings::new(115_200, Parity::None), Mode::Rtu))),
            Just(What::Port(Event::Opened(LINE, Mode::Rtu))),
            any::<u32>().prop_map(|milliseconds| What::Port(Event::Break(milliseconds))),
            any::<u64>().prop_map(|bytes| What::Port(Event::Forgotten(bytes))),
        ].prop_map(Act::What),
        1 => (0u64..3_000_000).prop_map(Act::Wait),
    ]
}

/// What is noted of it all.
pub(crate) fn notes(acts: &[Act]) -> Vec<Note> {
    let mut now = 1_000_000;
    let mut notes = vec![opened(now)];
    for act in acts {
        now += 20_000;
        match act {
            Act::Exchange(unit, address, values, chunks) => {
                let quantity = u16::try_from(values.len()).unwrap();
                notes.push(sent(now, Origin::Poll, ask(*unit, *address, quantity)));
                let reply = answer(*unit, values);
                for chunk in reply.chunks(reply.len().div_ceil(*chunks)) {
                    now += 9000;
                    notes.push(received(now, chunk.to_vec()));
                }
            }
            Act::Silence(unit, address) => notes.push(sent(now, Origin::Poll, ask(*unit, *address, 1))),
            Act::Refusal(unit) => {
                notes.push(sent(now, Origin::Sequence, ask(*unit, 7, 1)));
                now += 15_000;
                notes.push(received(now, frame(*unit, &[0x83, 2])));
            }
            Act::Foreign(unit, values) => {
                let quantity = u16::try_from(values.len()).unwrap();
                notes.push(received(now, [ask(*unit, 9, quantity), answer(*unit, values)].concat()));
            }
            Act::Write(value) => {
                let [high, low] = value.to_be_bytes();
                let write = frame(1, &[6, 0, 5, high, low]);
                notes.push(sent(now, Origin::Configuration, write.clone()));
                now += 9000;
                notes.push(received(now, write.clone()));
                now += 15_000;
                notes.push(received(now, write));
            }
            Act::Noise(bytes) => notes.push(received(now, bytes.clone())),
            Act::Raw(bytes) => notes.push(sent(now, Origin::Console, bytes.clone())),
            Act::Damaged(unit, bit) => {
                notes.push(sent(now, Origin::Poll, ask(*unit, 3, 1)));
                now += 15_000;
                let mut reply = answer(*unit, &[7]);
                let at = bit / 8 % reply.len();
                reply[at] ^= 1 << (bit % 8);
                notes.push(received(now, reply));
            }
            Act::What(what) => notes.push(note(now, what.clone())),
            Act::Wait(us) => now += us,
        }
    }
    notes
}

pub(crate) fn any_notes(acts: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Note>> {
    prop::collection::vec(any_act(), acts).prop_map(|acts| notes(&acts))
}

/// A desk that has these notes, told in portions.
pub(crate) fn live(all: &[Note], portion: usize) -> Desk {
    let mut desk = Desk::live(1_714_557_693_000_000);
    for some in all.chunks(portion) {
        desk.record(some);
    }
    desk.settle(u64::MAX);
    while desk.work(1000) {}
    desk
}
