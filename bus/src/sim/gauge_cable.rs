//! The gauge cable 217/218, as its instructions (217(218)数据线使用说明) describe it. Sections are those of its chapter on the
//! protocol (通讯协议). It turns a digital gauge or micrometer into a Modbus RTU device.

use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};

use super::course::{Course, swing};
use super::server::{ILLEGAL_ADDRESS, ILLEGAL_FUNCTION, ILLEGAL_VALUE, answer, pause, read_reply, word};
use super::station::{Device, Reply};
use crate::time::Instant;

/// The gauge sends its reading 25 times a second. Gauges differ, and the instructions do not say.
const SAMPLE_MICROS: u64 = 40_000;
/// The slow swing of [`Course::Swing`] and its ripple. Both have come round after their product.
const SWING_MICROS: u64 = 17_000_000;
const RIPPLE_MICROS: u64 = 2_300_000;
const ROUND_MICROS: u64 = 17 * RIPPLE_MICROS * 10;

/// The simulated cable with a gauge in ABS mode at its end.
#[derive(Clone, Debug)]
pub struct GaugeCable {
    course: Course,
    address: u8,
    baud: u32,
    zero_micrometres: i32,
    record: Record,
    /// The last sample that is in the record, microseconds since the origin of time.
    recorded_until: u64,
}

/// What the cable has seen since the record began, in micrometres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Record {
    max: i32,
    min: i32,
}

impl GaugeCable {
    /// A cable with factory settings (section 1) and `address` (1 to 247) that gets its supply at `now`. Its gauge moves
    /// through +-5 mm if it swings.
    pub fn new(address: u8, course: Course, now: Instant) -> Self {
        let mut cable = Self {
            course,
            address,
            baud: 38_400,
            zero_micrometres: 0,
            record: Record { max: 0, min: 0 },
            recorded_until: 0,
        };
        cable.restart_record(now);
        cable
    }

    /// Sets the baud rate, 9600 to 38400, as the maker can; false for any other. No register is known to change it.
    pub fn preset_baud(&mut self, baud: u32) -> bool {
        let known = matches!(baud, 9600 | 19_200 | 38_400);
        if known {
            self.baud = baud;
        }
        known
    }

    /// From `now` on the gauge, zeroed or not, goes this way, in micrometres.
    pub fn set_course(&mut self, now: Instant, course: Course) {
        self.record_until(now);
        self.course = course;
        self.see(self.reading(now));
    }

    /// Somebody zeroes the gauge with its own key. The record goes on: it starts with the host's command only (section 3,
    /// note 1).
    pub fn zero_by_key(&mut self, now: Instant) {
        self.record_until(now);
        self.zero_micrometres = self.position(now);
        self.see(self.reading(now));
    }

    fn read(&mut self, now: Instant, address: u16, quantity: u16) -> Result<Vec<u8>, u8> {
        if !(1..=125).contains(&quantity) {
            return Err(ILLEGAL_VALUE);
        }
        self.record_until(now);
        let micrometres = match (address, quantity) {
            // Sections 2, 4, 5 and 6.
            (0x0000, 2) => self.reading(now),
            (0x0100, 2) => self.record.max,
            (0x0200, 2) => self.record.min,
            (0x0300, 2) => self.record.max - self.record.min,
            _ => return Err(ILLEGAL_ADDRESS),
        };
        Ok(read_reply(3, &sign_and_magnitude(micrometres)))
    }

    fn write(&mut self, now: Instant, address: u16, value: u16) -> Result<(), u8> {
        match (address, value) {
            // Section 3.
            (0x0800, 0xAB56) => self.zero_micrometres = self.position(now),
            // Section 7.
            (0x0200, 0x0000) => {}
            (0x0800 | 0x0200, _) => return Err(ILLEGAL_VALUE),
            _ => return Err(ILLEGAL_ADDRESS),
        }
        self.restart_record(now);
        Ok(())
    }

    fn restart_record(&mut self, now: Instant) {
        let reading = self.reading(now);
        self.record = Record { max: reading, min: reading };
        self.recorded_until = sampled(now);
    }

    /// Takes the samples since the last time. After a whole round every place has been seen.
    fn record_until(&mut self, now: Instant) {
        let last = sampled(now);
        let mut at = self.recorded_until.max(last.saturating_sub(ROUND_MICROS));
        while at < last {
            at += SAMPLE_MICROS;
            self.see(self.reading(Instant::from_micros(at)));
        }
        self.recorded_until = last;
    }

    fn see(&mut self, micrometres: i32) {
        self.record.max = self.record.max.max(micrometres);
        self.record.min = self.record.min.min(micrometres);
    }

    /// What the gauge shows, in micrometres.
    fn reading(&self, now: Instant) -> i32 {
        self.position(now).saturating_sub(self.zero_micrometres)
    }

    fn position(&self, now: Instant) -> i32 {
        match self.course {
            Course::Rest(micrometres) => micrometres,
            Course::Swing => {
                let at = sampled(now);
                swing(at, SWING_MICROS, 4900) + swing(at, RIPPLE_MICROS, 60)
            }
        }
    }
}

impl Device for GaugeCable {
    fn line(&self) -> LineSettings {
        LineSettings::new(self.baud, Parity::None)
    }

    fn mode(&self) -> Mode {
        Mode::Rtu
    }

    fn is_listening(&self, _: Instant) -> bool {
        true
    }

    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
        // Of a broadcast the instructions say nothing.
        if unit.0 != self.address {
            return None;
        }
        let (&function, data) = pdu.split_first()?;
        let result = match (function, data) {
            (3, &[a, b, c, d]) => self.read(now, word(a, b), word(c, d)),
            (6, &[a, b, c, d]) => self.write(now, word(a, b), word(c, d)).map(|()| pdu.to_vec()),
            // A request of the wrong length is no request.
            (3 | 6, _) => return None,
            _ => Err(ILLEGAL_FUNCTION),
        };
        let line = self.line();
        Some(Reply { unit, pdu: answer(function, result), after: pause(line), line, mode: Mode::Rtu })
    }

    /// The cable is fed by the port (section on its pins), so its record is gone; the gauge has a battery and keeps its zero.
    fn power_cycle(&mut self, now: Instant) {
        self.restart_record(now);
    }
}

/// The time of the last sample at `now`, in microseconds.
fn sampled(now: Instant) -> u64 {
    now.as_micros() / SAMPLE_MICROS * SAMPLE_MICROS
}

/// Section 2, note 2: a byte for the sign, a byte of zeros, 16 bits of magnitude. More than 65.535 mm it cannot say.
fn sign_and_magnitude(micrometres: i32) -> [u16; 2] {
    let sign = if micrometres < 0 { 0x0100 } else { 0x0000 };
    [sign, u16::try_from(micrometres.unsigned_abs()).unwrap_or(u16::MAX)]
}
