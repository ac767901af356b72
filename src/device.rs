//! The built-in devices: profiles with what the page needs of them.

use std::sync::{LazyLock, OnceLock};

use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::{BUILT_IN, Point, Profile, Texts, Wire};
use buslens_codec::value::Value;

use crate::format;
use crate::message::Status;
use crate::text::Language;

static DEVICES: LazyLock<Vec<Device>> = LazyLock::new(|| {
    // Packed by this package's build script from the files that the codec's tests load.
    let packed: Vec<&'static [u8]> =
        postcard::from_bytes(include_bytes!(concat!(env!("OUT_DIR"), "/profiles"))).unwrap_or_default();
    if cfg!(test) {
        keep_whole();
    }
    let profile = |place: usize, packed: &[u8]| {
        let whole = WHOLE.get().and_then(|whole| whole(place));
        whole.or_else(|| Profile::unpack(packed))
    };
    let places = packed.into_iter().enumerate();
    places.filter_map(|(place, packed)| Some(Device { place, packed, profile: profile(place, packed)? })).collect()
});

/// Brings a whole profile, where [`keep_whole`] has been called.
static WHOLE: OnceLock<fn(usize) -> Option<Profile>> = OnceLock::new();

/// From here on this program's devices have whole profiles, with their notes and help, not just what is essential. Call it
/// first. The first program does without: it would carry all texts and their loader.
pub(crate) fn keep_whole() {
    // Nobody minds that it has been called before.
    let _ = WHOLE.set(|place| Profile::from_json(BUILT_IN.get(place)?).ok());
}

/// A device that can be chosen.
pub(crate) struct Device {
    /// Its place among the built-in ones.
    place: usize,
    packed: &'static [u8],
    profile: Profile,
}

/// Every built-in device, at least one.
pub(crate) fn all() -> &'static [Device] {
    &DEVICES
}

/// The first one: what a new user gets.
pub(crate) fn first() -> &'static Device {
    &all()[0]
}

/// The device with this id, else the first.
pub(crate) fn find(id: &str) -> &'static Device {
    all().iter().find(|device| device.id() == id).unwrap_or_else(first)
}

/// The device whose packed profile this is.
pub(crate) fn of_packed(packed: &[u8]) -> Option<&'static Device> {
    all().iter().find(|device| device.packed == packed)
}

impl Device {
    /// The text of its profile's file. The first program does without: it would carry all texts.
    pub(crate) fn source(&self) -> &'static str {
        BUILT_IN.get(self.place).copied().unwrap_or_default()
    }

    /// Its profile, packed.
    pub(crate) fn packed(&self) -> &'static [u8] {
        self.packed
    }

    /// Its profile; in the first program what is essential of it.
    pub(crate) fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Its name for programs.
    pub(crate) fn id(&self) -> &str {
        &self.profile.id
    }

    /// Its name for people.
    pub(crate) fn name(&self, language: Language) -> &str {
        pick(language, &self.profile.name)
    }

    /// Factory settings of the line.
    pub(crate) fn line(&self) -> LineSettings {
        self.profile.line
    }

    /// Factory mode.
    pub(crate) fn mode(&self) -> Mode {
        self.profile.mode
    }

    /// Usual time between two readings, in milliseconds.
    pub(crate) fn period_ms(&self) -> u32 {
        self.profile.timing.poll_period_ms
    }

    /// Shortest useful time between two readings, in milliseconds.
    pub(crate) fn least_period_ms(&self) -> u32 {
        self.profile.timing.min_poll_period_ms
    }

    /// What the device is for, the primary one first.
    pub(crate) fn measurements(&self) -> Vec<&Point> {
        self.profile.measurements()
    }

    /// The unit of a point: its own, or what the device says it is.
    pub(crate) fn unit(&self, language: Language, status: &Status, point: &Point) -> String {
        let told = || {
            let teller = self.profile.point(point.unit_from.as_deref()?)?;
            Some(value_text(language, teller, reading(status, &teller.id)?))
        };
        told().unwrap_or_else(|| point.unit.clone())
    }

    /// The wires of its cable.
    pub(crate) fn wires(&self) -> &[Wire] {
        &self.profile.wiring
    }

    /// `9-28 V DC between red (V+) and black (V−)`, as far as the profile tells.
    pub(crate) fn supply(&self, language: Language) -> Option<String> {
        let supply = Some(self.profile.supply.replace('-', "\u{2013}")).filter(|supply| !supply.is_empty())?;
        Some(match (self.wire("V+"), self.wire("V-")) {
            (Some(plus), Some(minus)) => {
                language.supply_between(&supply, pick(language, &plus.name), pick(language, &minus.name))
            }
            _ => supply,
        })
    }

    /// Colours of the data wires A and B in words, if the profile tells.
    pub(crate) fn data_wires(&self, language: Language) -> Option<(&str, &str)> {
        let colour = |signal| self.wire(signal).map(|wire| pick(language, &wire.name));
        colour("A").zip(colour("B"))
    }

    fn wire(&self, signal: &str) -> Option<&Wire> {
        self.wires().iter().find(|wire| wire.signal == signal)
    }
}

/// The last value of a point, if it has been read.
pub(crate) fn reading(status: &Status, point: &str) -> Option<Value> {
    status.readings.iter().find(|reading| reading.point == point).map(|reading| reading.value)
}

/// A profile's text in one language.
pub(crate) fn pick(language: Language, texts: &Texts) -> &str {
    match language {
        Language::En => &texts.en,
        Language::Zh => &texts.zh,
    }
}

/// A point's value for reading, with a real minus sign.
pub(crate) fn value_text(language: Language, point: &Point, value: Value) -> String {
    format::signed(&point.text(value, |texts| match language {
        Language::En => &texts.en,
        Language::Zh => &texts.zh,
    }))
}

/// How many decimals a point's values have, as far as one value tells.
pub(crate) fn decimals(value: Value) -> u8 {
    match value {
        Value::Number(decimal) => decimal.decimals,
        Value::Float(_) | Value::Double(_) => 3,
        Value::Code(_) | Value::Text(_) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use buslens_codec::value::Decimal;

    #[test]
    fn every_built_in_profile_is_a_device_with_a_measurement() {
        assert_eq!(all().len(), BUILT_IN.len());
        assert!(all().iter().all(|device| !device.profile().help.is_empty()));
        assert!(all().iter().all(|device| device.packed() == device.profile().pack()));
        for device in all() {
            assert!(std::ptr::eq(find(device.id()), device));
            assert!(!device.measurements().is_empty(), "{}", device.id());
            assert_ne!(device.name(Language::En), device.name(Language::Zh));
        }
    }

    #[test]
    fn readings_carry_a_real_minus_sign() {
        let device = find("lvdt");
        let value = Value::Number(Decimal { mantissa: -328, decimals: 3 });
        assert_eq!(value_text(Language::En, device.measurements()[0], value), "\u{2212}0.328");
        assert_eq!(decimals(value), 3);
    }

    #[test]
    fn a_device_tells_its_unit() {
        let device = find("level");
        let value = device.profile().point("value").unwrap();
        let reading = crate::message::Reading { point: "unit".to_owned(), value: Value::Code(1) };
        let status = Status { readings: vec![reading], ..Status::default() };
        assert_eq!(device.unit(Language::En, &status, value), "kPa");
        assert_eq!(device.unit(Language::En, &Status::default(), value), "");
        let displacement = find("lvdt").measurements()[0];
        assert_eq!(find("lvdt").unit(Language::En, &status, displacement), "mm");
    }

    #[test]
    fn the_wires_are_named_in_both_languages() {
        let device = find("lvdt");
        assert_eq!(device.data_wires(Language::Zh), Some(("蓝", "白")));
        assert_eq!(
            device.supply(Language::En).as_deref(),
            Some("9\u{2013}28 V DC between red (V+) and black (V\u{2212})")
        );
    }
}
