//! Values as the figures show them: in the units that the user prefers.

use buslens_codec::profile::Point;
use buslens_codec::quantity::{self, Unit};
use buslens_codec::value::Value;

use crate::device::{self, Device};
use crate::format;
use crate::message::Live;
use crate::text::Language;

/// A value as it is shown.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shown {
    pub(super) value: String,
    pub(super) unit: String,
}

impl Shown {
    /// Value and unit.
    pub(super) fn text(&self) -> String {
        if self.unit.is_empty() { self.value.clone() } else { [&self.value, " ", &self.unit].concat() }
    }
}

/// The last value of a point as it is shown; `None` where it has not been read.
pub(super) fn value(language: Language, live: &Live, device: &Device, point: &Point) -> Option<Shown> {
    let value = device::reading(&live.status, &point.id)?;
    Some(in_unit(language, live, device, point, value))
}

fn in_unit(language: Language, live: &Live, device: &Device, point: &Point, value: Value) -> Shown {
    let converted = || {
        let own = Unit::named(&device.unit(Language::En, &live.status, point))?;
        let preferred = live.units.split(' ').filter_map(Unit::named).find(|unit| unit.quantity() == own.quantity())?;
        if preferred == own {
            return None;
        }
        let value = quantity::convert_value(value, own, preferred)?;
        Some(Shown { value: format::signed(&value.to_string()), unit: preferred.symbol().to_owned() })
    };
    converted().unwrap_or_else(|| Shown {
        value: device::value_text(language, point, value),
        unit: device.unit(language, &live.status, point),
    })
}

#[cfg(test)]
mod tests {
    use buslens_codec::UnitId;
    use buslens_codec::line::{LineSettings, Mode, Parity};
    use buslens_codec::value::Decimal;

    use super::*;
    use crate::message::{Reading, Status};

    fn live(units: &str) -> Live {
        let number = |mantissa| Value::Number(Decimal { mantissa, decimals: 3 });
        let reading = |point: &str, value| Reading { point: point.to_owned(), value };
        let readings =
            vec![reading("unit", Value::Code(7)), reading("value", number(6000)), reading("zero_offset", number(-1))];
        Live {
            device: "level".to_owned(),
            unit: UnitId(1),
            line: LineSettings::new(9600, Parity::None),
            mode: Mode::Rtu,
            status: Status { readings, ..Status::default() },
            is_current: true,
            is_open: true,
            is_replay: false,
            read_only: false,
            units: units.to_owned(),
        }
    }

    fn shown(units: &str, point: &str) -> Option<String> {
        let device = device::find("level");
        let point = device.profile().point(point)?;
        value(Language::En, &live(units), device, point).map(|shown| shown.text())
    }

    #[test]
    fn values_are_told_in_the_preferred_unit_of_their_quantity() {
        assert_eq!(shown("", "value").as_deref(), Some("6.000 mH\u{2082}O"));
        assert_eq!(shown("in kPa", "value").as_deref(), Some("58.840 kPa"));
        assert_eq!(shown("kPa", "zero_offset").as_deref(), Some("\u{2212}0.010 kPa"));
        assert_eq!(shown("in °F", "value").as_deref(), Some("6.000 mH\u{2082}O"));
        assert_eq!(shown("kPa", "range_full"), None);
    }
}
