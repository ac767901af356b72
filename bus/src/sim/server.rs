//! What the simulated devices have in common: PDUs by hand, so that they owe nothing to what the master is made of.

use core::time::Duration;

use buslens_codec::line::LineSettings;

/// The device does not know the function.
pub(super) const ILLEGAL_FUNCTION: u8 = 1;
/// The device does not know the register, or not together with its neighbours.
pub(super) const ILLEGAL_ADDRESS: u8 = 2;
/// The value or the number of registers is none that the device takes.
pub(super) const ILLEGAL_VALUE: u8 = 3;

/// From the end of a request to the start of the answer. No manual says; fast sensors of these kinds need so much.
const THINKING: Duration = Duration::from_millis(4);

/// When an answer starts, after the silence that has ended the request.
pub(super) fn pause(line: LineSettings) -> Duration {
    line.frame_gap().max(THINKING)
}

/// The answer's PDU: as it is, or the exception with this code.
pub(super) fn answer(function: u8, answer: Result<Vec<u8>, u8>) -> Vec<u8> {
    answer.unwrap_or_else(|code| vec![function | 0x80, code])
}

/// The reply to a read of registers, at most 125.
pub(super) fn read_reply(function: u8, registers: &[u16]) -> Vec<u8> {
    let bytes: Vec<u8> = registers.iter().flat_map(|register| register.to_be_bytes()).collect();
    counted(function, &bytes)
}

/// The reply to a read of coils or discrete inputs, at most 2000: the first one is the lowest bit of the first byte.
pub(super) fn bits_reply(function: u8, bits: &[bool]) -> Vec<u8> {
    let byte = |eight: &[bool]| eight.iter().rev().fold(0, |byte, bit| byte << 1 | u8::from(*bit));
    let bytes: Vec<u8> = bits.chunks(8).map(byte).collect();
    counted(function, &bytes)
}

/// Two bytes as they come over the line.
pub(super) fn word(high: u8, low: u8) -> u16 {
    u16::from_be_bytes([high, low])
}

/// The new registers in the data of function 10 behind its address; `None` where its counts contradict each other.
pub(super) fn written_registers(quantity: u16, count: u8, values: &[u8]) -> Option<Vec<u16>> {
    let whole = (1..=123).contains(&quantity)
        && values.len() == usize::from(quantity) * 2
        && values.len() == usize::from(count);
    whole.then(|| values.chunks_exact(2).map(|pair| word(pair[0], pair[1])).collect())
}

fn counted(function: u8, bytes: &[u8]) -> Vec<u8> {
    [&[function, u8::try_from(bytes.len()).unwrap_or(u8::MAX)], bytes].concat()
}
