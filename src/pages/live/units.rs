//! In which unit a measurement is shown: the device's own, or another of the same quantity that the user prefers. What
//! the device said stays what is kept; only what is shown is converted.

use buslens_codec::profile::Point;
use buslens_codec::quantity::{self, Unit};
use buslens_codec::value::Value;

use crate::app::App;
use crate::components::field::option;
use crate::device::{self, Device};
use crate::dom::{self, El, el};
use crate::format::fixed;
use crate::message::Status;
use crate::reactive::prelude::*;
use crate::storage;
use crate::text::Language;

/// The units that are preferred for a device, one a quantity.
#[derive(Clone, Copy)]
pub(super) struct Units {
    device: &'static Device,
    chosen: RwSignal<Vec<Unit>>,
}

/// From the device's unit to the one shown: a value becomes `value * factor + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Conversion {
    from: Unit,
    to: Unit,
    factor: f64,
    offset: f64,
}

impl Units {
    /// As they were chosen for this device.
    pub(super) fn of(device: &'static Device) -> Self {
        let kept = storage::load(&key(device)).unwrap_or_default();
        Self { device, chosen: RwSignal::new(kept.split(' ').filter_map(Unit::named).collect()) }
    }

    /// How a point's values become what is shown; `None` for as they are.
    pub(super) fn conversion(&self, status: &Status, point: &Point) -> Option<Conversion> {
        let from = self.own(status, point)?;
        let chosen = |to: &&Unit| to.quantity() == from.quantity();
        let to = self.chosen.with(|all| all.iter().find(chosen).copied())?;
        (from != to).then(|| Conversion::between(from, to))?
    }

    /// The unit in which a point's values are shown.
    pub(super) fn unit(&self, language: Language, status: &Status, point: &Point) -> String {
        match self.conversion(status, point) {
            Some(conversion) => conversion.to.symbol().to_owned(),
            None => self.device.unit(language, status, point),
        }
    }

    /// The symbols of the preferred units.
    pub(super) fn kept(&self) -> String {
        self.chosen.with(|all| all.iter().map(|unit| unit.symbol()).collect::<Vec<_>>().join(" "))
    }

    /// The list to choose the unit of a point from. One for each quantity: whoever reads inches reads all lengths so.
    pub(super) fn choice(self, app: &'static App, point: &'static Point) -> El {
        let own = Memo::new(move |_| app.status.with(|status| self.own(status, point)));
        let first = move |own: Unit| {
            let same = |other: &Point| app.status.with_untracked(|status| self.own(status, other));
            let first = self
                .device
                .measurements()
                .into_iter()
                .find(|other| same(other).is_some_and(|unit| unit.quantity() == own.quantity()));
            first.is_some_and(|first| first.id == point.id)
        };
        el("span").class("contents").live_one(move || {
            let own = own.get().filter(|own| first(*own))?;
            let options = own.quantity().units().iter().map(|unit| option(unit.symbol(), unit.symbol()));
            let list = el("select")
                .class("unit-choice")
                .test("unit-choice")
                .label(app, Language::shown_unit)
                .children(options)
                .live_value(move || {
                    let shown = app.status.with(|status| self.conversion(status, point));
                    shown.map_or(own, |shown| shown.to).symbol().to_owned()
                })
                .on("change", move |event| self.choose(&dom::value(&event)));
            Some(list)
        })
    }

    fn choose(self, name: &str) {
        let Some(unit) = Unit::named(name) else { return };
        self.chosen.update(|all| {
            all.retain(|other| other.quantity() != unit.quantity());
            all.push(unit);
        });
        storage::save(&key(self.device), &untrack(|| self.kept()));
    }

    /// What the device says that its unit is, if it can be told in another one.
    fn own(&self, status: &Status, point: &Point) -> Option<Unit> {
        Unit::named(&self.device.unit(Language::En, status, point))
    }
}

impl Conversion {
    fn between(from: Unit, to: Unit) -> Option<Self> {
        let offset = quantity::convert(0.0, from, to)?;
        Some(Self { from, to, factor: quantity::convert(1.0, from, to)? - offset, offset })
    }

    /// A value in the unit shown.
    pub(super) fn of(&self, value: f64) -> f64 {
        value * self.factor + self.offset
    }

    /// How many digits behind the point tell what so many told.
    pub(super) fn decimals(&self, decimals: u8) -> u8 {
        quantity::decimals_in(decimals, self.from, self.to).unwrap_or(decimals)
    }

    /// A point's value as it is shown.
    pub(super) fn text(&self, value: Value) -> Option<String> {
        Some(fixed(self.of(value.to_f64()?), self.decimals(device::decimals(value))))
    }
}

fn key(device: &Device) -> String {
    ["units.", device.id()].concat()
}

#[cfg(test)]
mod tests {
    use buslens_codec::value::Decimal;

    use super::*;

    #[test]
    fn what_is_shown_tells_as_much_as_what_was_read() {
        let value = Value::Number(Decimal { mantissa: 6000, decimals: 3 });
        let shown = |from, to, value| Conversion::between(from, to).unwrap().text(value);
        assert_eq!(shown(Unit::MetreOfWater, Unit::Kilopascal, value).as_deref(), Some("58.840"));
        assert_eq!(shown(Unit::MetreOfWater, Unit::MillimetreOfWater, value).as_deref(), Some("6000"));
        assert_eq!(shown(Unit::Millimetre, Unit::Inch, value).as_deref(), Some("0.23622"));
        let cold = Value::Number(Decimal { mantissa: -1, decimals: 1 });
        assert_eq!(shown(Unit::Celsius, Unit::Fahrenheit, cold).as_deref(), Some("31.8"));
        assert_eq!(shown(Unit::Celsius, Unit::Fahrenheit, Value::Code(1)), None);
        assert!(Conversion::between(Unit::Celsius, Unit::Psi).is_none());
    }
}
