//! The devices: profiles with what the page needs of them, the built-in ones and the user's own.

use std::cell::RefCell;
use std::sync::{LazyLock, OnceLock};

use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::profile::{BUILT_IN, Point, Profile, Texts, Wire};
use buslens_codec::value::Value;
use reactive_graph::signal::ArcRwSignal;

use crate::format;
use crate::message::Status;
use crate::reactive::prelude::*;
use crate::text::Language;

static BUILT_IN_DEVICES: LazyLock<Vec<Device>> = LazyLock::new(|| {
    // Packed by this package's build script from the files that the codec's tests load.
    let packed: Vec<&'static [u8]> =
        postcard::from_bytes(include_bytes!(concat!(env!("OUT_DIR"), "/profiles"))).unwrap_or_default();
    if cfg!(test) {
        keep_whole();
    }
    let unpacked = packed.into_iter().enumerate();
    unpacked.filter_map(|(place, packed)| Device::of(Text::BuiltIn(place), packed.to_vec())).collect()
});

/// Brings a whole profile of its text, where [`keep_whole`] has been called.
static WHOLE: OnceLock<fn(&Text) -> Option<Profile>> = OnceLock::new();

/// From here on this program's devices have whole profiles, with their notes and help, not just what is essential. Call it
/// first. The first program does without: it would carry all texts and their loader.
pub(crate) fn keep_whole() {
    // Nobody minds that it has been called before.
    let _ = WHOLE.set(|text| Profile::from_json(text.read()).ok());
}

/// The user's own devices as they are now, and the one that is connected.
static OWN: LazyLock<ArcRwSignal<Own>> = LazyLock::new(ArcRwSignal::default);

#[derive(Clone, Default)]
struct Own {
    listed: Vec<&'static Device>,
    /// The connection goes on with what it was made with, whatever has become of the profile since.
    held: Option<&'static Device>,
}

thread_local! {
    /// Every device of the user's that there has been: what is drawn holds them for good. One more a saved change.
    static EVER: RefCell<Vec<&'static Device>> = const { RefCell::new(Vec::new()) };
}

/// A device that can be chosen.
pub(crate) struct Device {
    text: Text,
    packed: Vec<u8>,
    profile: Profile,
}

/// Where the text of a profile's file is.
enum Text {
    /// At this place among the built-in ones.
    BuiltIn(usize),
    /// Here; empty in the first program, which does without.
    Own(String),
}

impl Text {
    fn read(&self) -> &str {
        match self {
            Self::BuiltIn(place) => BUILT_IN.get(*place).copied().unwrap_or_default(),
            Self::Own(text) => text,
        }
    }
}

/// The built-in devices, at least one.
pub(crate) fn built_in() -> &'static [Device] {
    &BUILT_IN_DEVICES
}

/// Every device that can be chosen: the built-in ones, then the user's own. Follows their changes.
pub(crate) fn all() -> Vec<&'static Device> {
    built_in().iter().chain(own()).collect()
}

/// The user's own devices. Follows their changes.
pub(crate) fn own() -> Vec<&'static Device> {
    OWN.with(|own| own.listed.clone())
}

/// The first one: what a new user gets.
pub(crate) fn first() -> &'static Device {
    &built_in()[0]
}

/// The device with this id, else the first. While a device is connected, it is as it was when that began.
pub(crate) fn find(id: &str) -> &'static Device {
    known(id).unwrap_or_else(first)
}

/// The device with this id, if there is one.
pub(crate) fn known(id: &str) -> Option<&'static Device> {
    let held = OWN.with(|own| own.held).filter(|device| device.id() == id);
    held.or_else(|| all().into_iter().find(|device| device.id() == id))
}

/// The device whose packed profile this is, be it of an earlier edition.
pub(crate) fn of_packed(packed: &[u8]) -> Option<&'static Device> {
    let fits = |device: &&'static Device| device.packed == packed;
    let ever = EVER.with_borrow(|ever| ever.iter().rev().copied().find(fits));
    ever.or_else(|| built_in().iter().find(fits))
}

/// From now on these are the user's own devices: the text of each file, if this program has use for it, and its packed
/// profile. One whose id is taken is left out.
pub(crate) fn set_own(files: Vec<(String, Vec<u8>)>) {
    let mut listed: Vec<&'static Device> = Vec::new();
    for (text, packed) in files {
        let device = EVER.with_borrow_mut(|ever| {
            if let Some(found) = ever.iter().copied().find(|device| device.is(&text, &packed)) {
                return Some(found);
            }
            let device: &'static Device = Box::leak(Box::new(Device::of(Text::Own(text), packed)?));
            ever.push(device);
            Some(device)
        });
        let taken = |id: &str| built_in().iter().chain(listed.iter().copied()).any(|device| device.id() == id);
        if let Some(device) = device.filter(|device| !taken(device.id())) {
            listed.push(device);
        }
    }
    OWN.update(|own| own.listed = listed);
}

/// This device is connected, or none. Whether that is another one than before.
pub(crate) fn hold(device: Option<&'static Device>) -> bool {
    let same = |held: Option<&'static Device>| match (held, device) {
        (Some(held), Some(device)) => std::ptr::eq(held, device),
        (None, None) => true,
        _ => false,
    };
    let changed = !OWN.with_untracked(|own| same(own.held));
    if changed {
        OWN.update(|own| own.held = device);
    }
    changed
}

impl Device {
    fn of(text: Text, packed: Vec<u8>) -> Option<Self> {
        let whole = WHOLE.get().and_then(|whole| whole(&text));
        let profile = whole.or_else(|| Profile::unpack(&packed))?;
        Some(Self { text, packed, profile })
    }

    fn is(&self, text: &str, packed: &[u8]) -> bool {
        self.packed == packed && matches!(&self.text, Text::Own(own) if own == text)
    }

    /// The text of its profile's file. The first program does without: it would carry all texts.
    pub(crate) fn source(&self) -> &str {
        self.text.read()
    }

    /// Its profile, packed.
    pub(crate) fn packed(&self) -> &[u8] {
        &self.packed
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

/// A point's value for reading; a number has a real minus sign, a text stays as the device tells it.
pub(crate) fn value_text(language: Language, point: &Point, value: Value) -> String {
    let text = point.text(value, |texts| match language {
        Language::En => &texts.en,
        Language::Zh => &texts.zh,
    });
    match value {
        Value::Number(_) | Value::Float(_) | Value::Double(_) => format::signed(&text),
        Value::Code(_) | Value::Text(_) => text,
    }
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
        assert_eq!(built_in().len(), BUILT_IN.len());
        assert!(built_in().iter().all(|device| !device.profile().help.is_empty()));
        assert!(built_in().iter().all(|device| device.packed() == device.profile().pack()));
        for device in built_in() {
            assert!(std::ptr::eq(find(device.id()), device));
            assert!(!device.measurements().is_empty(), "{}", device.id());
            assert_ne!(device.name(Language::En), device.name(Language::Zh));
        }
    }

    /// Device signals are shared by all tests of this program, so one test does it all.
    #[test]
    fn the_users_own_are_listed_behind_the_built_in_ones_and_a_connection_keeps_its_own() {
        let file = |id: &str, name: &str| {
            let text =
                BUILT_IN[1].replace("gauge-cable", id).replace("\"en\": \"Gauge", &["\"en\": \"", name].concat());
            let packed = Profile::from_json(&text).unwrap().pack();
            (text, packed)
        };
        let (first_edition, second) = (file("mine", "One"), file("mine", "Two"));
        set_own(vec![first_edition.clone(), file("lvdt", "Taken"), file("mine", "Twice")]);
        let ids: Vec<&str> = all().iter().skip(built_in().len()).map(|device| device.id()).collect();
        assert_eq!(ids, ["mine"]);
        let one = known("mine").unwrap();
        assert_eq!(one.source(), first_edition.0);
        hold(of_packed(&first_edition.1));
        set_own(vec![second.clone()]);
        assert!(std::ptr::eq(find("mine"), one));
        assert_eq!(all().last().unwrap().source(), second.0);
        set_own(vec![]);
        assert!(std::ptr::eq(find("mine"), one));
        hold(None);
        assert!(known("mine").is_none() && std::ptr::eq(find("mine"), first()));
        assert!(of_packed(&first_edition.1).is_some() && of_packed(&second.1).is_some());
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
