//! How a device is reached, and how after a write that changes just that.

use serde::{Deserialize, Serialize};

use super::{Effect, Point, Profile};
use crate::UnitId;
use crate::line::{DataBits, LineSettings, Mode, Parity, StopBits};
use crate::value::Value;

/// How a device is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Link {
    /// Its unit id; `None` after a reset, where the factory's own number is not known: ask by broadcast or search.
    pub unit: Option<UnitId>,
    /// The line.
    pub line: LineSettings,
    /// RTU or ASCII.
    pub mode: Mode,
}

/// A setting of the line that a code stands for. A baud rate is the code's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Setting {
    /// Parity bit.
    Parity(Parity),
    /// RTU or ASCII.
    Mode(Mode),
    /// Data bits.
    DataBits(DataBits),
    /// Stop bits.
    StopBits(StopBits),
}

impl Setting {
    /// What changes where this is written.
    pub const fn effect(self) -> Effect {
        match self {
            Self::Parity(_) => Effect::Parity,
            Self::Mode(_) => Effect::Mode,
            Self::DataBits(_) => Effect::DataBits,
            Self::StopBits(_) => Effect::StopBits,
        }
    }
}

impl Profile {
    /// How the device is reached once it has taken this value of a point, if it was reached so before; unchanged for a
    /// point without effects on the link. `None` where nobody can know: the device must be searched, or the value is none
    /// that the profile knows.
    pub fn link_after(&self, point: &Point, value: Value, before: Link) -> Option<Link> {
        let mut link = before;
        let number = || match value {
            Value::Number(number) => number.mantissa_with(0),
            Value::Code(code) => point.code(code)?.number.map(i64::from),
            _ => None,
        };
        let setting = || match value {
            Value::Code(code) => point.code(code)?.sets,
            _ => None,
        };
        for effect in &point.effects {
            match effect {
                Effect::Unit => link.unit = Some(UnitId(u8::try_from(number()?).ok()?)),
                Effect::Baud => link.line.baud = u32::try_from(number()?).ok().filter(|baud| *baud > 0)?,
                Effect::Parity | Effect::Mode | Effect::DataBits | Effect::StopBits => match setting()? {
                    Setting::Parity(parity) => link.line.parity = parity,
                    Setting::Mode(mode) => {
                        link.mode = mode;
                        // Seven are left behind with ASCII: RTU has eight always (clause 2.5.1).
                        if mode == Mode::Rtu {
                            link.line.data_bits = DataBits::Eight;
                        }
                    }
                    Setting::DataBits(data_bits) => link.line.data_bits = data_bits,
                    Setting::StopBits(stop_bits) => link.line.stop_bits = stop_bits,
                },
                Effect::Restart => {}
                Effect::Defaults => link = Link { unit: None, line: self.line, mode: self.mode },
                Effect::Search => return None,
            }
        }
        Some(link)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::built_in;
    use super::*;
    use crate::value::Decimal;

    #[test]
    fn every_change_of_the_link_is_foreseen() {
        let lvdt = built_in("lvdt");
        let before = Link { unit: Some(UnitId(7)), line: LineSettings::new(9600, Parity::Even), mode: Mode::Rtu };
        let after = |point: &str, value| lvdt.link_after(lvdt.point(point).unwrap(), value, before);
        let line = |line| Some(Link { line, ..before });
        assert_eq!(after("baud", Value::Code(7)), line(LineSettings::new(115_200, Parity::Even)));
        assert_eq!(after("baud", Value::Code(8)), None);
        assert_eq!(after("parity", Value::Code(3)), line(LineSettings::new(9600, Parity::None)));
        assert_eq!(after("output_mode", Value::Code(2)), Some(Link { mode: Mode::Ascii, ..before }));
        let seven = LineSettings { data_bits: DataBits::Seven, ..before.line };
        let ascii = Link { line: seven, mode: Mode::Ascii, ..before };
        assert_eq!(lvdt.link_after(lvdt.point("output_mode").unwrap(), Value::Code(1), ascii), Some(before));
        let nine = Value::Number(Decimal::whole(9));
        assert_eq!(after("address", nine), Some(Link { unit: Some(UnitId(9)), ..before }));
        assert_eq!(after("address", Value::Number(Decimal::whole(256))), None);
        assert_eq!(after("sample_rate", Value::Code(6)), Some(before));
        let changed = Link { unit: Some(UnitId(9)), line: LineSettings::new(2400, Parity::Odd), mode: Mode::Ascii };
        let reset = lvdt.link_after(lvdt.point("factory_reset").unwrap(), Value::Code(0xFF00), changed);
        assert_eq!(reset, Some(Link { unit: None, ..before }));
        let level = built_in("level");
        assert_eq!(level.link_after(level.point("restore_factory").unwrap(), Value::Code(1), before), None);
        let slow = level.link_after(level.point("baud").unwrap(), Value::Code(0), before).unwrap();
        assert_eq!(slow.line.baud, 1200);
    }
}
