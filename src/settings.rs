//! What the user has set for the connection: one remembered string a field, and what the strings mean.

use crate::reactive::prelude::*;
use buslens_codec::UnitId;
use buslens_codec::line::{DataBits, LineSettings, Mode, Parity, StopBits};

use crate::device::{self, Device};
use crate::message::{Connection, Source};
use crate::storage::kept;

/// The baud rates that are offered by name; any other can be typed.
pub(crate) const BAUDS: [u32; 10] = [1200, 2400, 4800, 9600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800];

/// The choice in the list of baud rates that stands for a typed one.
pub(crate) const FREE: &str = "free";

/// Every field as it stands on the page.
#[derive(Clone, Copy)]
pub(crate) struct Settings {
    /// The chosen port's key, see [`crate::ports::key`].
    pub(crate) port: RwSignal<String>,
    /// The device's profile id.
    pub(crate) device: RwSignal<String>,
    /// One of [`BAUDS`] or [`FREE`].
    pub(crate) baud: RwSignal<String>,
    /// The typed baud rate, used with [`FREE`].
    pub(crate) free_baud: RwSignal<String>,
    /// `none`, `odd` or `even`.
    pub(crate) parity: RwSignal<String>,
    /// `7` or `8`; ASCII only.
    pub(crate) data_bits: RwSignal<String>,
    /// `1` or `2`.
    pub(crate) stop_bits: RwSignal<String>,
    /// `rtu` or `ascii`.
    pub(crate) mode: RwSignal<String>,
    /// The unit id, typed.
    pub(crate) unit: RwSignal<String>,
    /// The period in milliseconds, typed.
    pub(crate) period: RwSignal<String>,
}

impl Settings {
    /// What was remembered, else the first device's defaults.
    pub(crate) fn remembered() -> Self {
        let factory = Factory::of(device::first());
        Self {
            port: kept("port", ""),
            device: kept("device", device::first().id()),
            baud: kept("baud", &factory.baud),
            free_baud: kept("free-baud", ""),
            parity: kept("parity", factory.parity),
            data_bits: kept("data-bits", factory.data_bits),
            stop_bits: kept("stop-bits", factory.stop_bits),
            mode: kept("mode", factory.mode),
            unit: kept("unit", "1"),
            period: kept("period", &factory.period),
        }
    }

    /// The chosen device.
    pub(crate) fn device(&self) -> &'static Device {
        self.device.with(|id| device::find(id))
    }

    /// Sets everything to the device's factory settings. The unit id stays: it is printed on the housing.
    pub(crate) fn reset(&self) {
        let factory = Factory::of(self.device());
        self.period.set(factory.period.clone());
        self.set_line(factory);
    }

    /// Takes over how a device is reached that has been connected, and was set otherwise meanwhile.
    pub(crate) fn follow(&self, used: &Connection) {
        self.set_line(Factory::of_line(used.line, used.mode));
        self.unit.set(used.unit.0.to_string());
    }

    fn set_line(&self, to: Factory) {
        let is_listed = parse_baud(&to.baud).is_some_and(|baud| BAUDS.contains(&baud));
        if !is_listed {
            self.free_baud.set(to.baud.clone());
        }
        self.baud.set(if is_listed { to.baud } else { FREE.to_owned() });
        self.parity.set(to.parity.to_owned());
        self.data_bits.set(to.data_bits.to_owned());
        self.stop_bits.set(to.stop_bits.to_owned());
        self.mode.set(to.mode.to_owned());
    }

    /// Whether every field is as [`Self::reset`] would set it.
    pub(crate) fn is_factory(&self) -> bool {
        let factory = Factory::of(self.device());
        let same = |field: RwSignal<String>, value: &str| field.with(|text| text == value);
        same(self.baud, &factory.baud)
            && same(self.parity, factory.parity)
            && same(self.data_bits, factory.data_bits)
            && same(self.stop_bits, factory.stop_bits)
            && same(self.mode, factory.mode)
            && same(self.period, &factory.period)
    }

    /// The baud rate in force, if it is one.
    pub(crate) fn baud(&self) -> Option<u32> {
        let listed = self.baud.get();
        if listed == FREE { parse_baud(&self.free_baud.get()) } else { parse_baud(&listed) }
    }

    /// The unit id, if it is one.
    pub(crate) fn unit(&self) -> Option<u8> {
        self.unit.with(|text| parse_unit(text))
    }

    /// The period in milliseconds, if it is one.
    pub(crate) fn period_ms(&self) -> Option<u32> {
        self.period.with(|text| parse_period(text))
    }

    /// The transmission mode.
    pub(crate) fn mode(&self) -> Mode {
        self.mode.with(|text| parse_mode(text))
    }

    /// Everything needed to connect; `None` while a field is not valid.
    pub(crate) fn connection(&self, source: Source) -> Option<Connection> {
        let mode = self.mode();
        let line = LineSettings {
            baud: self.baud()?,
            data_bits: self.data_bits.with(|text| parse_data_bits(mode, text)),
            parity: self.parity.with(|text| parse_parity(text)),
            stop_bits: self.stop_bits.with(|text| parse_stop_bits(text)),
        };
        let (unit, period_ms) = (UnitId(self.unit()?), self.period_ms()?);
        Some(Connection { source, line, mode, unit, period_ms, profile: self.device().packed().to_owned() })
    }
}

/// A connection to the simulator: all settings as the device leaves the factory, whatever the fields say.
pub(crate) fn demonstration(device: &Device) -> Connection {
    Connection {
        source: Source::Simulator,
        line: device.line(),
        mode: device.mode(),
        unit: UnitId(device.profile().unit),
        period_ms: device.period_ms(),
        profile: device.packed().to_owned(),
    }
}

/// A device's factory settings, or others, as the fields hold them.
struct Factory {
    baud: String,
    parity: &'static str,
    data_bits: &'static str,
    stop_bits: &'static str,
    mode: &'static str,
    period: String,
}

impl Factory {
    fn of(device: &Device) -> Self {
        Self { period: device.period_ms().to_string(), ..Self::of_line(device.line(), device.mode()) }
    }

    fn of_line(line: LineSettings, mode: Mode) -> Self {
        Self {
            baud: line.baud.to_string(),
            parity: parity_name(line.parity),
            data_bits: if line.data_bits == DataBits::Seven { "7" } else { "8" },
            stop_bits: if line.stop_bits == StopBits::Two { "2" } else { "1" },
            mode: if mode == Mode::Ascii { "ascii" } else { "rtu" },
            period: String::new(),
        }
    }
}

/// The name of a parity among the fields' values.
pub(crate) fn parity_name(parity: Parity) -> &'static str {
    match parity {
        Parity::None => "none",
        Parity::Odd => "odd",
        Parity::Even => "even",
    }
}

/// A baud rate of 50 to 4 000 000.
pub(crate) fn parse_baud(text: &str) -> Option<u32> {
    whole(text).filter(|baud| (50..=4_000_000).contains(baud))
}

/// A unit id of 0 to 255.
pub(crate) fn parse_unit(text: &str) -> Option<u8> {
    whole(text).and_then(|unit| u8::try_from(unit).ok())
}

/// A period of 1 ms to an hour; 0 only listens.
pub(crate) fn parse_period(text: &str) -> Option<u32> {
    whole(text).filter(|period| *period <= 3_600_000)
}

fn parse_parity(text: &str) -> Parity {
    match text {
        "none" => Parity::None,
        "odd" => Parity::Odd,
        _ => Parity::Even,
    }
}

fn parse_mode(text: &str) -> Mode {
    if text == "ascii" { Mode::Ascii } else { Mode::Rtu }
}

/// RTU needs eight bits, whatever was chosen for ASCII.
fn parse_data_bits(mode: Mode, text: &str) -> DataBits {
    if mode == Mode::Ascii && text == "7" { DataBits::Seven } else { DataBits::Eight }
}

fn parse_stop_bits(text: &str) -> StopBits {
    if text == "2" { StopBits::Two } else { StopBits::One }
}

/// Digits only, with spaces around: no sign, no exponent.
fn whole(text: &str) -> Option<u32> {
    let text = text.trim();
    if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    text.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_ids_end_at_255() {
        assert_eq!(parse_unit("0"), Some(0));
        assert_eq!(parse_unit(" 12 "), Some(12));
        assert_eq!(parse_unit("255"), Some(255));
        for wrong in ["", "256", "-1", "+1", "0x10", "1.5", "1e2", "一"] {
            assert_eq!(parse_unit(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn baud_rates_and_periods_have_limits() {
        assert_eq!(parse_baud("250000"), Some(250_000));
        assert_eq!((parse_baud("0"), parse_baud("49"), parse_baud("99999999999")), (None, None, None));
        assert_eq!(parse_period("100"), Some(100));
        assert_eq!((parse_period("0"), parse_period("3600001")), (Some(0), None));
        assert!(BAUDS.iter().all(|baud| parse_baud(&baud.to_string()) == Some(*baud)));
    }

    #[test]
    fn rtu_has_eight_data_bits_always() {
        assert_eq!(parse_data_bits(Mode::Rtu, "7"), DataBits::Eight);
        assert_eq!(parse_data_bits(Mode::Ascii, "7"), DataBits::Seven);
        assert_eq!(parse_data_bits(Mode::Ascii, "8"), DataBits::Eight);
    }

    #[test]
    fn factory_settings_read_back_as_they_were() {
        for device in device::all() {
            let factory = Factory::of(device);
            let mode = parse_mode(factory.mode);
            let line = LineSettings {
                baud: parse_baud(&factory.baud).unwrap(),
                data_bits: parse_data_bits(mode, factory.data_bits),
                parity: parse_parity(factory.parity),
                stop_bits: parse_stop_bits(factory.stop_bits),
            };
            assert_eq!((line, mode), (device.line(), device.mode()));
            assert_eq!(parse_period(&factory.period), Some(device.period_ms()));
        }
    }
}
