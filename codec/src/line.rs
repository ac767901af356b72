//! What both ends of a serial line must agree on, and what follows from it: the time a character takes.
//!
//! Clause numbers are those of *MODBUS over Serial Line, Specification and Implementation Guide V1.02*.

use core::fmt;
use core::time::Duration;

use serde::{Deserialize, Serialize};

/// Parity bit of each character.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Parity {
    /// No parity bit.
    None,
    /// Odd number of ones, parity bit included.
    Odd,
    /// Even number of ones, parity bit included. The standard's default (clause 2.5.1).
    Even,
}

/// Data bits of each character: RTU needs eight, ASCII works with seven or eight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DataBits {
    /// Seven bits (ASCII mode only).
    Seven,
    /// Eight bits.
    Eight,
}

/// Stop bits of each character.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StopBits {
    /// One stop bit.
    One,
    /// Two stop bits.
    Two,
}

/// Transmission mode of Modbus on a serial line (clause 2.5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Binary, CRC-16, frames bounded by silence (clause 2.5.1).
    Rtu,
    /// Hexadecimal text, LRC, frames bounded by `:` and CR LF (clause 2.5.2).
    Ascii,
}

/// Electrical settings of a serial port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct LineSettings {
    /// Bits per second (Bd), never zero in a settings value that reaches a port.
    pub baud: u32,
    /// Data bits of a character.
    #[serde(default = "eight")]
    pub data_bits: DataBits,
    /// Parity bit of a character.
    pub parity: Parity,
    /// Stop bits of a character.
    #[serde(default = "one")]
    pub stop_bits: StopBits,
}

fn eight() -> DataBits {
    DataBits::Eight
}

fn one() -> StopBits {
    StopBits::One
}

impl LineSettings {
    /// Settings with eight data bits and one stop bit.
    pub const fn new(baud: u32, parity: Parity) -> Self {
        Self { baud, data_bits: DataBits::Eight, parity, stop_bits: StopBits::One }
    }

    /// Bits of one character on the wire: start, data, parity, stop. 9 to 12.
    pub const fn bits_per_character(self) -> u32 {
        let data = match self.data_bits {
            DataBits::Seven => 7,
            DataBits::Eight => 8,
        };
        let parity = match self.parity {
            Parity::None => 0,
            Parity::Odd | Parity::Even => 1,
        };
        let stop = match self.stop_bits {
            StopBits::One => 1,
            StopBits::Two => 2,
        };
        1 + data + parity + stop
    }

    /// Time that `characters` back to back take on the wire. A baud rate of zero counts as one.
    pub fn character_time(self, characters: usize) -> Duration {
        let bits = characters as u64 * u64::from(self.bits_per_character());
        Duration::from_nanos(bits.saturating_mul(1_000_000_000) / u64::from(self.baud.max(1)))
    }

    /// Silence that ends an RTU frame: 3.5 characters, 1.75 ms above 19200 Bd (clause 2.5.1.1).
    pub fn frame_gap(self) -> Duration {
        if self.baud > 19_200 { Duration::from_micros(1750) } else { self.character_time(7) / 2 }
    }
}

/// The field's short form: `9600 8E1`.
impl fmt::Display for LineSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let data = match self.data_bits {
            DataBits::Seven => 7,
            DataBits::Eight => 8,
        };
        let parity = match self.parity {
            Parity::None => 'N',
            Parity::Odd => 'O',
            Parity::Even => 'E',
        };
        let stop = match self.stop_bits {
            StopBits::One => 1,
            StopBits::Two => 2,
        };
        write!(f, "{} {data}{parity}{stop}", self.baud)
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::*;

    #[test]
    fn a_character_at_9600_8e1_takes_eleven_bits() {
        let line = LineSettings::new(9600, Parity::Even);
        assert_eq!(line.bits_per_character(), 11);
        assert_eq!(line.character_time(96), Duration::from_millis(110));
        assert_eq!(line.to_string(), "9600 8E1");
    }

    #[test]
    fn the_frame_gap_is_fixed_above_19200() {
        assert_eq!(LineSettings::new(38_400, Parity::None).frame_gap(), Duration::from_micros(1750));
        assert_eq!(LineSettings::new(19_200, Parity::Even).frame_gap(), Duration::from_nanos(4_010_416 / 2));
    }
}
