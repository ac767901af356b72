//! The submersible level transmitter, as its protocol (MODBUS 投入式液位变送器通信协议) describes it. The table is that of
//! section 4 (支持的命令及命令和数据意义); notes are those below it.

use core::ops::RangeInclusive;

use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};

use super::course::{Course, swing};
use super::server::{ILLEGAL_ADDRESS, ILLEGAL_FUNCTION, ILLEGAL_VALUE, answer, pause, read_reply, word};
use super::station::{Device, Reply};
use crate::time::Instant;

/// Baud rates by their codes.
const BAUDS: [u32; 8] = [1200, 2400, 4800, 9600, 19_200, 38_400, 57_600, 115_200];
/// Ten times a second there is a new value. The protocol does not say.
const SAMPLE_MICROS: u64 = 100_000;

/// The simulated transmitter.
#[derive(Clone, Debug)]
pub struct Level {
    /// The calibrated value in the last digit's unit, without the zero offset.
    pub course: Course,
    /// It answers reads of several neighbouring registers. The table has reads of one only; if this is off, exception 02
    /// answers all others.
    pub answers_blocks: bool,
    /// What was written and not saved outlives a power failure. The protocol leaves it open.
    pub keeps_unsaved: bool,
    now_used: Parameters,
    user_area: Parameters,
    factory_area: Parameters,
    flash_writes: u32,
}

/// Everything that it keeps, as registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Parameters {
    address: u16,
    baud: u16,
    unit: u16,
    decimals: u16,
    zero: u16,
    full: u16,
    offset: u16,
}

impl Parameters {
    /// 0 to 10.000 mH2O.
    fn factory(address: u8) -> Self {
        Self { address: address.into(), baud: 3, unit: 7, decimals: 3, zero: 0, full: 10_000, offset: 0 }
    }

    /// The parameter at a register with the values that it takes.
    fn at(&mut self, register: u16) -> Option<(&mut u16, RangeInclusive<u16>)> {
        Some(match register {
            0x0000 => (&mut self.address, 1..=255),
            0x0001 => (&mut self.baud, 0..=7),
            0x0002 => (&mut self.unit, 0..=8),
            0x0003 => (&mut self.decimals, 0..=3),
            0x0005 => (&mut self.zero, 0..=u16::MAX),
            0x0006 => (&mut self.full, 0..=u16::MAX),
            0x000C => (&mut self.offset, 0..=u16::MAX),
            _ => return None,
        })
    }

    /// False if there is no such register or value.
    fn set(&mut self, register: u16, value: u16) -> bool {
        let parameter = self.at(register).filter(|(_, values)| values.contains(&value));
        parameter.map(|(parameter, _)| *parameter = value).is_some()
    }
}

impl Level {
    /// A transmitter with the usual settings (section 2) and `address` (1 to 255), whose range is 0 to 10.000 mH2O.
    pub fn new(address: u8, course: Course) -> Self {
        let factory = Parameters::factory(address);
        Self {
            course,
            answers_blocks: true,
            keeps_unsaved: false,
            now_used: factory,
            user_area: factory,
            factory_area: factory,
            flash_writes: 0,
        }
    }

    /// Sets a parameter in the factory area, be it calibration data: a restore brings it back. False if there is no such
    /// register or value.
    pub fn preset_factory(&mut self, register: u16, value: u16) -> bool {
        self.factory_area.set(register, value)
    }

    fn count_write(&mut self) {
        self.flash_writes = self.flash_writes.saturating_add(1);
    }

    fn read(&mut self, now: Instant, address: u16, quantity: u16) -> Result<Vec<u8>, u8> {
        if !(1..=125).contains(&quantity) {
            return Err(ILLEGAL_VALUE);
        }
        if quantity > 1 && !self.answers_blocks {
            return Err(ILLEGAL_ADDRESS);
        }
        let output = self.output(now).cast_unsigned();
        let registers = (0..quantity).map(|offset| match address.checked_add(offset) {
            Some(0x0004) => Ok(output),
            Some(register) => self.now_used.at(register).map(|(value, _)| *value).ok_or(ILLEGAL_ADDRESS),
            None => Err(ILLEGAL_ADDRESS),
        });
        Ok(read_reply(3, &registers.collect::<Result<Vec<_>, _>>()?))
    }

    fn write(&mut self, address: u16, value: u16) -> Result<(), u8> {
        match (address, value) {
            // Users may write these three only (note 5).
            (0x0000 | 0x0001 | 0x000C, _) => {
                if !self.now_used.set(address, value) {
                    return Err(ILLEGAL_VALUE);
                }
                if self.keeps_unsaved {
                    self.count_write();
                }
            }
            (0x000F, 0) => {
                self.user_area = self.now_used;
                self.count_write();
            }
            (0x000F, 1) => {
                self.factory_area = self.now_used;
                self.count_write();
            }
            // Address, baud rate and calibration may all be others afterwards (note 4).
            (0x0010, 1) => {
                self.now_used = self.factory_area;
                self.user_area = self.factory_area;
                self.count_write();
            }
            (0x000F | 0x0010, _) => return Err(ILLEGAL_VALUE),
            // Note 6: calibration data is refused. By which exception, it does not say.
            _ => return Err(ILLEGAL_ADDRESS),
        }
        Ok(())
    }

    /// The calibrated value plus the zero offset (section 4), in the last digit's unit.
    fn output(&self, now: Instant) -> i16 {
        let [zero, full, offset] =
            [self.now_used.zero, self.now_used.full, self.now_used.offset].map(|value| i32::from(value.cast_signed()));
        let calibrated = match self.course {
            Course::Rest(value) => value,
            Course::Swing => {
                let at = now.as_micros() / SAMPLE_MICROS * SAMPLE_MICROS;
                let span = full - zero;
                zero + span / 2 + swing(at, 23_000_000, span / 5 * 2) + swing(at, 3_100_000, span / 200)
            }
        };
        let output = calibrated.saturating_add(offset).clamp(i16::MIN.into(), i16::MAX.into());
        i16::try_from(output).unwrap_or_default()
    }
}

impl Device for Level {
    fn line(&self) -> LineSettings {
        let baud = BAUDS.get(usize::from(self.now_used.baud)).copied().unwrap_or(9600);
        LineSettings::new(baud, Parity::None)
    }

    fn mode(&self) -> Mode {
        Mode::Rtu
    }

    fn is_listening(&self, _: Instant) -> bool {
        true
    }

    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
        // Of a broadcast the protocol says nothing.
        if u16::from(unit.0) != self.now_used.address {
            return None;
        }
        // A change is answered from the old address at the old baud rate, and then takes effect (notes 1 and 2).
        let line = self.line();
        let (&function, data) = pdu.split_first()?;
        let result = match (function, data) {
            (3, &[a, b, c, d]) => self.read(now, word(a, b), word(c, d)),
            (6, &[a, b, c, d]) => self.write(word(a, b), word(c, d)).map(|()| pdu.to_vec()),
            // A request of the wrong length is no request.
            (3 | 6, _) => return None,
            _ => Err(ILLEGAL_FUNCTION),
        };
        Some(Reply { unit, pdu: answer(function, result), after: pause(line), line, mode: Mode::Rtu })
    }

    fn power_cycle(&mut self, _: Instant) {
        if !self.keeps_unsaved {
            self.now_used = self.user_area;
        }
    }

    /// Also calibration data, as the maker's software would have; saved for the user. What a restore brings back stays.
    fn preset(&mut self, register: u16, value: u16) -> bool {
        self.now_used.set(register, value) && self.user_area.set(register, value)
    }

    /// Saves and restores; and changes, where they are kept unsaved.
    fn flash_writes(&self) -> u32 {
        self.flash_writes
    }
}
