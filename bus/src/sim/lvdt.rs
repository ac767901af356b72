//! The digital LVDT displacement sensor, as its programming manual (version 3.1) describes it. Tables are the manual's.

use core::time::Duration;

use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};

use super::course::swing;
use super::server::{
    ILLEGAL_ADDRESS, ILLEGAL_FUNCTION, ILLEGAL_VALUE, answer, pause, read_reply, word, written_registers,
};
use super::station::{Device, Reply};
use crate::time::Instant;

/// Deaf after power-on and after a factory reset (section 1.1, notes 2 and 6).
const START_UP: Duration = Duration::from_millis(1500);
/// How long it is busy with its flash after a write: somewhat less than the tenth of a second that the manual asks for
/// between two writes (section 1.3, note 2), so that nobody who keeps to it loses one.
const FLASH_BUSY: Duration = Duration::from_millis(80);

/// How the probe moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// It rests at a displacement in micrometres and a temperature in tenths of a degree Celsius.
    Rest {
        /// Displacement, micrometres.
        micrometres: i32,
        /// Temperature, 0.1 degC.
        decidegrees: i16,
    },
    /// It swings slowly through +-12 mm with a little ripple, and warms and cools by a degree.
    Swing,
}

/// From which register a sensor tells its address when everybody is asked. The manual says both: the text 0x0030
/// (section 3.1), the questions and answers 0x0000 (section 5.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BroadcastAddress {
    /// From 0x0030 only.
    At0030,
    /// From 0x0000 only.
    At0000,
    /// From either.
    Either,
}

/// The simulated sensor.
#[derive(Clone, Debug)]
pub struct Lvdt {
    /// How the probe moves.
    pub motion: Motion,
    /// The reply to a change of the line's settings comes at the new settings already. The manual leaves it open.
    pub answers_at_new_settings: bool,
    /// Where it is asked for its address by those who have forgotten it.
    pub broadcast_address: BroadcastAddress,
    /// The zero outlives a power failure. The manual leaves it open. It calls the zero a logical one, set in the course of
    /// use (section 2.1), and does not count it among what is written to flash (section 1.3, note 2): so it is lost, unless
    /// this is set.
    pub keeps_zero: bool,
    /// The number printed on the housing, to which a factory reset returns.
    housing: u8,
    parameters: Parameters,
    zero_micrometres: i32,
    listening_from: Instant,
    flash_writes: u32,
    /// Until then it is busy with its flash, and takes no further parameter.
    writing_until: Instant,
    lost_writes: u32,
}

/// What the sensor keeps in flash (table 3), as codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Parameters {
    address: u16,
    baud: u16,
    parity: u16,
    compensation: u16,
    sample_rate: u16,
    output_mode: u16,
}

impl Parameters {
    /// Table 2.
    fn factory(housing: u8) -> Self {
        Self { address: u16::from(housing), baud: 3, parity: 2, compensation: 2, sample_rate: 4, output_mode: 1 }
    }

    /// The parameter at a register with the values that it takes (tables 1 and 3).
    fn at(&mut self, register: u16) -> Option<(&mut u16, core::ops::RangeInclusive<u16>)> {
        Some(match register {
            0x0030 => (&mut self.address, 1..=247),
            0x0031 => (&mut self.baud, 1..=7),
            0x0032 => (&mut self.parity, 1..=3),
            0x0034 => (&mut self.compensation, 1..=2),
            0x003F => (&mut self.sample_rate, 1..=6),
            0x0060 => (&mut self.output_mode, 1..=2),
            _ => return None,
        })
    }
}

impl Lvdt {
    /// A sensor with factory settings and `housing` (1 to 247) as its address, switched on long ago.
    pub fn new(housing: u8, motion: Motion) -> Self {
        Self {
            motion,
            answers_at_new_settings: false,
            broadcast_address: BroadcastAddress::At0030,
            keeps_zero: false,
            housing,
            parameters: Parameters::factory(housing),
            zero_micrometres: 0,
            listening_from: Instant::ZERO,
            flash_writes: 0,
            writing_until: Instant::ZERO,
            lost_writes: 0,
        }
    }

    /// Writes of parameters that came too soon after another one, and were neither taken nor answered. The manual says only
    /// that more than ten a second are too many, because writing to flash takes time; a sensor that is busy with it and
    /// misses the next write is the least that this can mean.
    pub fn lost_writes(&self) -> u32 {
        self.lost_writes
    }

    fn read_input(&self, now: Instant, address: u16, quantity: u16) -> Result<Vec<u8>, u8> {
        let (micrometres, decidegrees) = self.sample(now);
        let registers = [0, decidegrees.cast_unsigned(), sign_magnitude_high(micrometres), thousandths(micrometres)];
        // Pairs only (section 3.2).
        let wanted = match (address, quantity) {
            (0x0002, 2) => &registers[..2],
            (0x0004, 2) => &registers[2..],
            (0x0002, 4) => &registers[..],
            _ => return Err(ILLEGAL_ADDRESS),
        };
        Ok(read_reply(4, wanted))
    }

    fn read_holding(&mut self, unit: UnitId, address: u16, quantity: u16) -> Result<Vec<u8>, u8> {
        if !(1..=125).contains(&quantity) {
            return Err(ILLEGAL_VALUE);
        }
        if unit == UnitId::BROADCAST && quantity == 1 {
            match (self.broadcast_address, address) {
                (BroadcastAddress::At0000 | BroadcastAddress::Either, 0x0000) => {
                    return Ok(read_reply(3, &[self.parameters.address]));
                }
                (BroadcastAddress::At0000, 0x0030) => return Err(ILLEGAL_ADDRESS),
                _ => {}
            }
        }
        let registers = (0..quantity).map(|offset| {
            let register = address.checked_add(offset).ok_or(ILLEGAL_ADDRESS)?;
            self.parameters.at(register).map(|(value, _)| *value).ok_or(ILLEGAL_ADDRESS)
        });
        Ok(read_reply(3, &registers.collect::<Result<Vec<_>, _>>()?))
    }

    /// All values are checked before any is written.
    fn write_holding(&mut self, now: Instant, address: u16, values: &[u16]) -> Result<(), u8> {
        let mut changed = self.parameters;
        for (offset, &value) in (0u16..).zip(values) {
            let register = address.checked_add(offset).ok_or(ILLEGAL_ADDRESS)?;
            let (parameter, values) = changed.at(register).ok_or(ILLEGAL_ADDRESS)?;
            if !values.contains(&value) {
                return Err(ILLEGAL_VALUE);
            }
            *parameter = value;
        }
        self.parameters = changed;
        self.write_flash(now);
        Ok(())
    }

    /// Counts a write, also one that changes nothing: the manual promises no comparison, and a page of flash that is written
    /// again with the same content wears all the same.
    fn write_flash(&mut self, now: Instant) {
        self.flash_writes = self.flash_writes.saturating_add(1);
        self.writing_until = now + FLASH_BUSY;
    }

    fn write_coil(&mut self, now: Instant, address: u16, value: u16) -> Result<(), u8> {
        match (address, value) {
            (0x0050, 0xFF00) => self.zero_micrometres = self.position(now),
            (0x0050, 0x0000) => self.zero_micrometres = 0,
            (0x0051, 0xFF00) => {
                // It echoes at the settings that it had, and restarts then (section 3.5).
                let echoed = now + pause(self.line()) + self.line().character_time(self.echo_length());
                self.parameters = Parameters::factory(self.housing);
                self.write_flash(now);
                self.zero_micrometres = 0;
                self.listening_from = echoed + START_UP;
            }
            (0x0050 | 0x0051, _) => return Err(ILLEGAL_VALUE),
            _ => return Err(ILLEGAL_ADDRESS),
        }
        Ok(())
    }

    /// Characters of a frame that writes a coil.
    fn echo_length(&self) -> usize {
        if self.mode() == Mode::Ascii { 17 } else { 8 }
    }

    /// Displacement in micrometres, zero taken off, and temperature in 0.1 degC, as of the last sample.
    fn sample(&self, now: Instant) -> (i32, i16) {
        let decidegrees = match self.motion {
            Motion::Rest { decidegrees, .. } => decidegrees,
            Motion::Swing => 255 + i16::try_from(swing(now.as_micros(), 97_000_000, 10)).unwrap_or(0),
        };
        (self.position(now) - self.zero_micrometres, decidegrees)
    }

    fn position(&self, now: Instant) -> i32 {
        let sample_hz: u64 = match self.parameters.sample_rate {
            1 => 1,
            2 => 2,
            3 => 5,
            5 => 20,
            6 => 50,
            _ => 10,
        };
        let period = 1_000_000 / sample_hz;
        let sampled = now.as_micros() / period * period;
        match self.motion {
            Motion::Rest { micrometres, .. } => micrometres,
            Motion::Swing => swing(sampled, 13_000_000, 11_800) + swing(sampled, 1_700_000, 180),
        }
    }
}

impl Device for Lvdt {
    fn line(&self) -> LineSettings {
        let baud = match self.parameters.baud {
            1 => 2400,
            2 => 4800,
            4 => 19_200,
            5 => 38_400,
            6 => 57_600,
            7 => 115_200,
            _ => 9600,
        };
        let parity = match self.parameters.parity {
            1 => Parity::Odd,
            3 => Parity::None,
            _ => Parity::Even,
        };
        LineSettings::new(baud, parity)
    }

    fn mode(&self) -> Mode {
        if self.parameters.output_mode == 2 { Mode::Ascii } else { Mode::Rtu }
    }

    fn is_listening(&self, now: Instant) -> bool {
        now >= self.listening_from
    }

    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
        // A broadcast is answered too, with the broadcast address (section 3.1).
        if unit != UnitId::BROADCAST && u16::from(unit.0) != self.parameters.address {
            return None;
        }
        let (line, mode) = (self.line(), self.mode());
        let (&function, data) = pdu.split_first()?;
        let result = match (function, data) {
            (3, &[a, b, c, d]) => self.read_holding(unit, word(a, b), word(c, d)),
            (4, &[a, b, c, d]) => self.read_input(now, word(a, b), word(c, d)),
            (5, &[a, b, c, d]) => self.write_coil(now, word(a, b), word(c, d)).map(|()| pdu.to_vec()),
            (0x10, _) if now < self.writing_until => {
                self.lost_writes = self.lost_writes.saturating_add(1);
                return None;
            }
            (0x10, &[a, b, c, d, count, ref values @ ..]) => {
                let values = written_registers(word(c, d), count, values).ok_or(ILLEGAL_VALUE);
                let written = values.and_then(|values| self.write_holding(now, word(a, b), &values));
                written.map(|()| pdu[..5].to_vec())
            }
            // A request of the wrong length is no request.
            (3..=5 | 0x10, _) => return None,
            _ => Err(ILLEGAL_FUNCTION),
        };
        let pdu = answer(function, result);
        let at_new = self.answers_at_new_settings && function == 0x10;
        let (line, mode) = if at_new { (self.line(), self.mode()) } else { (line, mode) };
        Some(Reply { unit, pdu, after: pause(line), line, mode })
    }

    fn power_cycle(&mut self, now: Instant) {
        self.listening_from = now + START_UP;
        if !self.keeps_zero {
            self.zero_micrometres = 0;
        }
    }

    fn preset(&mut self, register: u16, value: u16) -> bool {
        match self.parameters.at(register) {
            Some((parameter, values)) if values.contains(&value) => {
                *parameter = value;
                true
            }
            _ => false,
        }
    }

    /// It endures about 100 000 (section 1.3, note 2).
    fn flash_writes(&self) -> u32 {
        self.flash_writes
    }
}

/// Table 4: bit 15 is the sign, the rest whole millimetres.
fn sign_magnitude_high(micrometres: i32) -> u16 {
    let millimetres = u16::try_from(micrometres.unsigned_abs() / 1000).unwrap_or(u16::MAX) & 0x7FFF;
    millimetres | if micrometres < 0 { 0x8000 } else { 0 }
}

fn thousandths(micrometres: i32) -> u16 {
    u16::try_from(micrometres.unsigned_abs() % 1000).unwrap_or(0)
}
