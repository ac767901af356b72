//! A device that is made of nothing but its profile: for profiles whose device nobody has simulated.
//!
//! Its registers hold what the profile lets expect, its measurements swing, and it takes the writes by functions 05, 06
//! and 10 that the profile allows, with their effects on the line. Commands are answered and do nothing else.

use core::time::Duration;

use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::{Effect, Known, Link, Point, Profile, Reply as Settings, Role};
use buslens_codec::value::{Decimal, Encoding, Value};

use super::course::swing;
use super::server::{
    ILLEGAL_ADDRESS, ILLEGAL_FUNCTION, ILLEGAL_VALUE, answer, bits_reply, pause, read_reply, word, written_registers,
};
use super::station::{Device, Reply};
use crate::time::Instant;

/// Every measurement moves at a pace of its own: the first one so fast, each other slower by [`NEXT_SWING_MICROS`].
const SWING_MICROS: u64 = 13_000_000;
const NEXT_SWING_MICROS: u64 = 4_000_000;
/// Digits behind the point of a float that swings.
const FLOAT_DECIMALS: u8 = 3;

/// A device that is made of its profile.
#[derive(Clone, Debug)]
pub struct Described {
    profile: Profile,
    link: Link,
    cells: Vec<Cell>,
    swings: Vec<Swing>,
    known: Known,
    listening_from: Instant,
    flash_writes: u32,
}

/// One register, or one coil as FF00 and 0000.
#[derive(Clone, Copy, Debug)]
struct Cell {
    table: Table,
    address: u16,
    value: u16,
}

/// The four tables of a Modbus device (MODBUS application protocol V1.1b3, clause 4.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Table {
    Coils,
    DiscreteInputs,
    InputRegisters,
    HoldingRegisters,
}

/// A measurement between two values.
#[derive(Clone, Copy, Debug)]
struct Swing {
    /// Its place in the profile's list of points.
    point: usize,
    /// Its digits at one end, and at the other.
    low: i64,
    high: i64,
    /// How many of them stand behind the point.
    decimals: u8,
    /// Only multiples of it can be held: an encoding may count hundreds.
    step: i64,
    period_micros: u64,
}

impl Described {
    /// A device as it leaves the factory, switched on long ago.
    pub fn new(profile: Profile) -> Self {
        let link = factory_link(&profile);
        let mut device = Self {
            profile,
            link,
            cells: Vec::new(),
            swings: Vec::new(),
            known: Known::default(),
            listening_from: Instant::ZERO,
            flash_writes: 0,
        };
        device.reset();
        device
    }

    /// Everything as it leaves the factory.
    fn reset(&mut self) {
        self.link = factory_link(&self.profile);
        self.cells.clear();
        for point in &self.profile.points {
            put(&mut self.cells, point, &first_registers(&self.profile, point));
        }
        self.learn();
        self.swings = (0..).zip(&self.profile.points).filter_map(|(at, point)| self.swing_of(at, point)).collect();
        for (swing, paces) in self.swings.iter_mut().zip(0..) {
            swing.period_micros += NEXT_SWING_MICROS * paces;
        }
    }

    /// Learns scales and units from its own registers, as a master does.
    fn learn(&mut self) {
        self.known = Known::default();
        for point in &self.profile.points {
            if let Some((function, registers)) = held(&self.cells, point) {
                self.profile.decode_points(function, point.register, &registers, &mut self.known);
            }
        }
    }

    /// How a point moves; `None` for what is no number or no measurement.
    fn swing_of(&self, at: usize, point: &Point) -> Option<Swing> {
        if point.role != Role::Measurement {
            return None;
        }
        let (function, registers) = held(&self.cells, point)?;
        let mut known = self.known.clone();
        let found = self.profile.decode_points(function, point.register, &registers, &mut known);
        let found = found.into_iter().find(|found| found.point.id == point.id && found.scaled)?;
        let decimals = match found.value.ok()? {
            Value::Number(number) => number.decimals,
            Value::Float(_) | Value::Double(_) => FLOAT_DECIMALS,
            Value::Code(_) | Value::Text(_) => return None,
        };
        let range = point.range.map(|range| {
            let (first, last) = (mantissa(range.first, decimals), mantissa(range.last, decimals));
            // Neither end is quite reached.
            let margin = last.saturating_sub(first) / 10;
            (first.saturating_add(margin), last.saturating_sub(margin))
        });
        let example = || {
            let example = self.profile.examples.iter().find(|example| example.point == point.id)?;
            let value = mantissa(Decimal::parse(&example.text)?, decimals);
            (value != 0).then(|| (value.min(value / 2), value.max(value / 2)))
        };
        let (low, high) = range.or_else(example).unwrap_or((0, 1000));
        let tens = point.encoding.decimals().filter(|decimals| *decimals < 0).map_or(0, i8::unsigned_abs);
        let step = 10_i64.checked_pow(tens.into())?;
        Some(Swing { point: at, low, high, decimals, step, period_micros: SWING_MICROS })
    }

    /// Puts the measurements where they are at `now`. What an encoding cannot hold stays as it was.
    fn move_on(&mut self, now: Instant) {
        for swing in &self.swings {
            let Some(point) = self.profile.points.get(swing.point) else { continue };
            let number = swing.at(now);
            let value = match point.encoding {
                Encoding::Double { .. } => Value::Double(number.to_f64()),
                #[allow(clippy::cast_possible_truncation)] // the nearest one will do
                Encoding::Float { .. } => Value::Float(number.to_f64() as f32),
                _ => Value::Number(number),
            };
            if let Ok(registers) = self.profile.encode_point(point, value, &self.known) {
                put(&mut self.cells, point, &registers);
            }
        }
    }

    fn read(&mut self, now: Instant, function: u8, address: u16, quantity: u16) -> Result<Vec<u8>, u8> {
        let table = Table::of(function).ok_or(ILLEGAL_FUNCTION)?;
        let bits = matches!(table, Table::Coils | Table::DiscreteInputs);
        if !(1..=if bits { 2000 } else { 125 }).contains(&quantity) {
            return Err(ILLEGAL_VALUE);
        }
        self.move_on(now);
        let end = u32::from(address) + u32::from(quantity);
        // Registers between the points of a group are there, whatever they are for.
        let grouped = self.profile.groups.iter().any(|group| {
            let group_end = u32::from(group.address) + u32::from(group.quantity);
            Table::of(group.function) == Some(table) && group.address <= address && end <= group_end
        });
        let values = (0..quantity).map(|offset| {
            let at = address.checked_add(offset).ok_or(ILLEGAL_ADDRESS)?;
            value_at(&self.cells, table, at).or(grouped.then_some(0)).ok_or(ILLEGAL_ADDRESS)
        });
        let values = values.collect::<Result<Vec<_>, _>>()?;
        Ok(if bits {
            bits_reply(function, &values.iter().map(|value| *value != 0).collect::<Vec<_>>())
        } else {
            read_reply(function, &values)
        })
    }

    /// Takes the registers or none of them, and says by which settings it replies.
    fn write(&mut self, now: Instant, function: u8, address: u16, registers: &[u16]) -> Result<Link, u8> {
        let found = self.profile.decode_points(function, address, registers, &mut self.known.clone());
        let covered = |offset: usize| {
            found.iter().any(|found| (found.offset..found.offset + found.point.encoding.registers()).contains(&offset))
        };
        if !(0..registers.len()).all(covered) {
            return Err(ILLEGAL_ADDRESS);
        }
        if !found.iter().all(|found| found.value.is_ok_and(|value| found.point.allows(value))) {
            return Err(ILLEGAL_VALUE);
        }
        if found.iter().any(|found| found.point.role != Role::Command) {
            self.flash_writes = self.flash_writes.saturating_add(1);
        }
        let before = self.link;
        let (mut starts_over, mut replies_by_new, mut restarts) = (false, false, false);
        for found in &found {
            let (Ok(value), point) = (found.value, found.point) else { continue };
            let own = registers.get(found.offset..).and_then(|rest| rest.get(..point.encoding.registers()));
            if let (Some(own), true) = (own, point.role != Role::Command) {
                put(&mut self.cells, point, own);
            }
            starts_over |= point.effects.iter().any(|effect| matches!(effect, Effect::Defaults | Effect::Search));
            restarts |= point.effects.contains(&Effect::Restart);
            replies_by_new |= point.reply == Settings::New;
            self.link = self.profile.link_after(point, value, self.link).unwrap_or(self.link);
        }
        if starts_over {
            self.reset();
        }
        if restarts {
            self.power_cycle(now);
        }
        self.learn();
        Ok(if replies_by_new { self.link } else { before })
    }
}

impl Device for Described {
    fn line(&self) -> LineSettings {
        self.link.line
    }

    fn mode(&self) -> Mode {
        self.link.mode
    }

    fn is_listening(&self, now: Instant) -> bool {
        now >= self.listening_from
    }

    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
        let (&function, data) = pdu.split_first()?;
        // A broadcast is answered by those only of which the profile says so.
        let asked_all = unit == UnitId::BROADCAST && !self.profile.discovery.is_empty() && matches!(function, 1..=4);
        if !asked_all && self.link.unit != Some(unit) {
            return None;
        }
        let mut replies_by = self.link;
        let is_used = self.profile.points.iter().any(|point| point.uses(function));
        let result = match (function, data) {
            _ if !is_used => Err(ILLEGAL_FUNCTION),
            (1..=4, &[a, b, c, d]) => self.read(now, function, word(a, b), word(c, d)),
            (5, &[_, _, c, d]) if !matches!((c, d), (0x00 | 0xFF, 0x00)) => Err(ILLEGAL_VALUE),
            (5 | 6, &[a, b, c, d]) => self.write(now, function, word(a, b), &[word(c, d)]).map(|link| {
                replies_by = link;
                pdu.to_vec()
            }),
            (0x10, &[a, b, c, d, count, ref values @ ..]) => {
                let values = written_registers(word(c, d), count, values).ok_or(ILLEGAL_VALUE);
                let written = values.and_then(|values| self.write(now, function, word(a, b), &values));
                written.map(|link| {
                    replies_by = link;
                    pdu[..5].to_vec()
                })
            }
            // A request of the wrong length is no request.
            (1..=6 | 0x10, _) => return None,
            _ => Err(ILLEGAL_FUNCTION),
        };
        let Link { line, mode, .. } = replies_by;
        Some(Reply { unit, pdu: answer(function, result), after: pause(line), line, mode })
    }

    /// Everything is kept: a profile does not say what is not.
    fn power_cycle(&mut self, now: Instant) {
        self.listening_from = now + Duration::from_millis(self.profile.timing.startup_silence_ms.into());
    }

    /// Any register of a point, also one that no request may write; what it sets on the line is in force.
    fn preset(&mut self, register: u16, value: u16) -> bool {
        let is_own = |cell: &&mut Cell| cell.table == Table::HoldingRegisters && cell.address == register;
        // Of a value of several registers one alone says nothing, and no point is found.
        let found = self.profile.decode_points(3, register, &[value], &mut self.known.clone());
        let allowed = found.iter().all(|found| found.value.is_ok_and(|value| found.point.allows(value)));
        let Some(cell) = self.cells.iter_mut().find(is_own).filter(|_| allowed) else { return false };
        cell.value = value;
        for found in &found {
            if let Ok(value) = found.value {
                self.link = self.profile.link_after(found.point, value, self.link).unwrap_or(self.link);
            }
        }
        self.learn();
        true
    }

    /// Requests that wrote a setting; commands alone leave no trace.
    fn flash_writes(&self) -> u32 {
        self.flash_writes
    }
}

impl Table {
    fn of(function: u8) -> Option<Self> {
        Some(match function {
            0x01 | 0x05 | 0x0F => Self::Coils,
            0x02 => Self::DiscreteInputs,
            0x03 | 0x06 | 0x10 => Self::HoldingRegisters,
            0x04 => Self::InputRegisters,
            _ => return None,
        })
    }
}

impl Swing {
    fn at(&self, now: Instant) -> Decimal {
        const FULL: i32 = 10_000;
        let place = i128::from(swing(now.as_micros(), self.period_micros, FULL) + FULL);
        let (low, high) = (i128::from(self.low), i128::from(self.high));
        let mantissa = low + (high - low) * place / i128::from(2 * FULL);
        // Between two numbers of 64 bits.
        let mantissa = i64::try_from(mantissa).unwrap_or(self.low);
        Decimal { mantissa: mantissa / self.step * self.step, decimals: self.decimals }
    }
}

fn factory_link(profile: &Profile) -> Link {
    Link { unit: Some(UnitId(profile.unit)), line: profile.line, mode: profile.mode }
}

/// What a point holds at first: what the line is set to, what the factory has set, what an example reads, or else the
/// first code or the least number that it takes.
fn first_registers(profile: &Profile, point: &Point) -> Vec<u16> {
    let registers = point.encoding.registers();
    let encode = |value: Value| profile.encode_point(point, value, &Known::default()).ok();
    let codes = || point.codes.iter().map(|code| Value::Code(code.code));
    let link = factory_link(profile);
    let in_force = || {
        let numbers =
            [profile.unit.into(), profile.line.baud.into()].map(|number| Value::Number(Decimal::whole(number)));
        let changes_nothing = |value: &Value| profile.link_after(point, *value, link) == Some(link);
        codes().chain(numbers).find(changes_nothing).and_then(encode)
    };
    let of_the_line = if point.effects.is_empty() { None } else { in_force() };
    let of_the_factory = || point.factory.filter(|_| registers == 1).map(|register| vec![register]);
    let of_an_example = || {
        let example = profile.examples.iter().find(|example| example.point == point.id)?;
        Some(example.registers.clone()).filter(|found| found.len() == registers)
    };
    let allowed = || codes().next().or_else(|| Some(Value::Number(point.range?.first))).and_then(encode);
    let found = of_the_line.or_else(of_the_factory).or_else(of_an_example).or_else(allowed);
    found.unwrap_or_else(|| vec![0; registers])
}

/// Puts a point's registers into every table that it is read from. Bits that are not its own stay.
fn put(cells: &mut Vec<Cell>, point: &Point, registers: &[u16]) {
    let mask = if let Encoding::Bits { mask, .. } = point.encoding { mask } else { u16::MAX };
    for table in point.read.iter().filter_map(|function| Table::of(*function)) {
        for (offset, &register) in (0..).zip(registers) {
            let Some(address) = point.register.checked_add(offset) else { return };
            match cells.iter_mut().find(|cell| cell.table == table && cell.address == address) {
                Some(cell) => cell.value = cell.value & !mask | register & mask,
                None => cells.push(Cell { table, address, value: register & mask }),
            }
        }
    }
}

fn value_at(cells: &[Cell], table: Table, address: u16) -> Option<u16> {
    cells.iter().find(|cell| cell.table == table && cell.address == address).map(|cell| cell.value)
}

/// A function that reads a point, and its registers.
fn held(cells: &[Cell], point: &Point) -> Option<(u8, Vec<u16>)> {
    let function = *point.read.first()?;
    let table = Table::of(function)?;
    let registers = (0..).take(point.encoding.registers());
    let values = registers.map(|offset| value_at(cells, table, point.register.checked_add(offset)?));
    Some((function, values.collect::<Option<Vec<_>>>()?))
}

/// The digits of a number with so many behind its point; further ones are cut off.
fn mantissa(number: Decimal, decimals: u8) -> i64 {
    let power = |decimals: u8| 10_i128.pow(decimals.min(Decimal::MAX_DECIMALS).into());
    let scaled = i128::from(number.mantissa) * power(decimals) / power(number.decimals);
    i64::try_from(scaled).unwrap_or(if scaled < 0 { i64::MIN } else { i64::MAX })
}
