//! The smaller parts of a profile.

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::Point;
use crate::line::{Mode, Parity, StopBits};
use crate::pdu::{MAX_READ_BITS, MAX_READ_QUANTITY, Request};

/// A text in both languages.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Texts {
    /// English.
    pub en: String,
    /// Simplified Chinese.
    pub zh: String,
}

/// First and last of something, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Range {
    /// The smallest.
    pub first: u16,
    /// The largest.
    pub last: u16,
}

impl Range {
    /// Whether `value` lies in it.
    pub const fn contains(self, value: u16) -> bool {
        self.first <= value && value <= self.last
    }
}

/// Electrical levels of the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interface {
    /// Two wires, half duplex, many devices.
    #[default]
    Rs485,
    /// Three wires, one device.
    Rs232,
}

/// What the line of a device can be set to. An empty list means that only the factory's setting is known.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Choices {
    /// Bits per second (Bd).
    pub bauds: Vec<u32>,
    /// Parity bits.
    pub parities: Vec<Parity>,
    /// Stop bits.
    pub stop_bits: Vec<StopBits>,
    /// RTU and ASCII.
    pub modes: Vec<Mode>,
}

/// Times and endurance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Timing {
    /// Deaf after power-on and after a restart.
    pub startup_silence_ms: u32,
    /// How long it may think before it answers.
    pub response_timeout_ms: u32,
    /// Pause before another device is addressed.
    pub inter_device_pause_ms: u32,
    /// Usual time between two readings.
    pub poll_period_ms: u32,
    /// Shortest useful time between two readings.
    pub min_poll_period_ms: u32,
    /// Shortest time between two writes.
    pub min_write_period_ms: u32,
    /// How many writes its memory endures, 0 if unknown.
    pub flash_writes: u32,
}

/// One wire of its cable.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wire {
    /// Colour as a CSS colour name.
    pub color: String,
    /// Colour in words.
    pub name: Texts,
    /// Its terminal: `V+`, `A`.
    pub signal: String,
    /// Its pin where the device has a plug instead of bare wires.
    pub pin: Option<u8>,
    /// What it is for.
    pub purpose: Texts,
}

/// Registers, coils or inputs that are read together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Group {
    /// 1 for coils, 2 for discrete inputs, 3 for holding registers, 4 for input registers.
    pub function: u8,
    /// The first.
    pub address: u16,
    /// How many.
    pub quantity: u16,
    /// The manual does not promise it: after an exception the points are read one by one.
    pub tentative: bool,
}

impl Group {
    /// The request that reads it; `None` for other functions and for quantities beyond the standard (MODBUS application
    /// protocol V1.1b3, clauses 6.1 to 6.4).
    pub fn request(&self) -> Option<Request> {
        let Self { function, address, quantity, .. } = *self;
        let most = if self.is_bits() { MAX_READ_BITS } else { MAX_READ_QUANTITY };
        if !(1..=most).contains(&quantity) || usize::from(address) + usize::from(quantity) > 0x1_0000 {
            return None;
        }
        match function {
            0x01 => Some(Request::ReadCoils { address, quantity }),
            0x02 => Some(Request::ReadDiscreteInputs { address, quantity }),
            0x03 => Some(Request::ReadHoldingRegisters { address, quantity }),
            0x04 => Some(Request::ReadInputRegisters { address, quantity }),
            _ => None,
        }
    }

    /// Whether its answer is a row of bits, see [`super::Profile::decode_bits`].
    pub const fn is_bits(&self) -> bool {
        matches!(self.function, 0x01 | 0x02)
    }

    /// Where in this group a point lies, if all of it does and the function reads it.
    pub fn offset_of(&self, point: &Point) -> Option<usize> {
        if point.read.contains(&self.function) { point.offset_in(self.address, self.quantity.into()) } else { None }
    }
}

/// Registers and the value that they hold.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Example {
    /// The point's id.
    pub point: String,
    /// As read.
    pub registers: Vec<u16>,
    /// What the register that scales it says, where there is one.
    pub decimals: Option<u8>,
    /// The value as [`Point::text`] writes it, in English.
    pub text: String,
}

/// What to try when something is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Help {
    /// What one sees.
    pub symptom: Texts,
    /// What to try, one after the other.
    pub remedies: Vec<Texts>,
}

/// A mistake of the device's manual.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Erratum {
    /// The frame as printed, empty where no frame is wrong.
    pub printed: Vec<u8>,
    /// The frame as it should be, empty where no frame is wrong.
    pub right: Vec<u8>,
    /// What is wrong and what is right.
    pub text: Texts,
}
