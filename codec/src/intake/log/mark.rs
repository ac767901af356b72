//! Words and signs that tell which way bytes went.

use super::super::line;
use crate::dissect::Direction;

/// A mark and how much it says: a stronger one on the same line overrules it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mark {
    pub(super) direction: Direction,
    pub(super) strength: u8,
    /// It is a word that remarks have as well.
    pub(super) common: bool,
}

/// What may mean something else: reading and writing, in and out, arrows, the two ends.
const WEAK: u8 = 1;
/// What a serial port did.
const PORT: u8 = 2;
/// What a frame is, whoever prints it.
const FRAME: u8 = 3;

/// An arrow, or the brackets that libmodbus puts around a byte.
pub(super) fn sign(sent: bool) -> Mark {
    Mark { common: false, ..mark(sent, WEAK) }
}

/// A word's meaning: upper or lower case, with a number or a name in front of an underscore.
pub(super) fn word(word: &[u8]) -> Option<Mark> {
    let word = word.rsplit(|code| *code == b'_').next().unwrap_or_default();
    let digits = word.iter().rev().take_while(|code| code.is_ascii_digit()).count();
    let word = word.get(..word.len() - digits).unwrap_or_default();
    let mut lower = [0; 12];
    let lower = lower.get_mut(..word.len())?;
    lower.copy_from_slice(word);
    lower.make_ascii_lowercase();
    let (sent, strength) = match &*lower {
        b"request" | b"req" | b"query" | b"command" | b"cmd" => (true, FRAME),
        b"response" | b"resp" | b"reply" | b"answer" | b"rsp" => (false, FRAME),
        b"tx" | b"txd" | b"send" | b"sent" | b"sending" | b"sends" | b"transmit" | b"transmitted" => (true, PORT),
        b"rx" | b"rxd" | b"recv" | b"rcv" | b"received" | b"receive" | b"receiving" | b"receives" => (false, PORT),
        b"write" | b"writing" | b"written" | b"wrote" | b"out" | b"output" | b"master" | b"host" => (true, WEAK),
        b"read" | b"reading" | b"in" | b"input" | b"slave" => (false, WEAK),
        _ => return None,
    };
    Some(mark(sent, strength))
}

/// A Chinese character's meaning.
pub(super) fn character(code: u8) -> Option<Mark> {
    let (sent, strength) = match code {
        line::REQUEST => (true, FRAME),
        line::RESPONSE => (false, FRAME),
        line::SEND => (true, PORT),
        line::RECEIVE => (false, PORT),
        line::WRITE | line::MASTER => (true, WEAK),
        line::READ | line::SLAVE => (false, WEAK),
        _ => return None,
    };
    Some(mark(sent, strength))
}

/// Words that stand beside bytes and say nothing of them.
pub(super) fn is_filler(word: &[u8]) -> bool {
    let digits = word.iter().rev().take_while(|code| code.is_ascii_digit()).count();
    let word = word.get(..word.len() - digits).unwrap_or_default();
    [&b"hex"[..], b"rtu", b"ascii", b"modbus", b"data", b"bytes", b"byte", b"com", b"len", b"length", b"b", b"x", b"ms"]
        .iter()
        .any(|filler| word.eq_ignore_ascii_case(filler))
}

fn mark(sent: bool, strength: u8) -> Mark {
    let direction = if sent { Direction::Request } else { Direction::Response };
    Mark { direction, strength, common: strength == WEAK }
}
