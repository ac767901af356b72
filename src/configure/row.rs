//! A parameter as a row of the table.

use buslens_codec::profile::{Danger, Point, Profile};
use buslens_codec::value::Decimal;
use buslens_configure::{Read, Snapshot};

use super::words;
use crate::format::signed;
use crate::text::Language;

/// What a row says of what the device holds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Held {
    /// The value, or why there is none.
    pub(crate) text: String,
    /// Whether it is a value.
    pub(crate) is_value: bool,
    /// Its unit.
    pub(crate) unit: String,
    /// The registers in hexadecimal, empty if they were not read.
    pub(crate) registers: String,
    /// Whether it is as it leaves the factory, if that is known.
    pub(crate) factory: Option<bool>,
    /// From one value that its registers can hold to the next, in its unit.
    pub(crate) step: Option<Decimal>,
    /// What is to be known of the value.
    pub(crate) note: Option<&'static str>,
}

impl Held {
    /// What a snapshot says of a point.
    pub(crate) fn of(language: Language, profile: &Profile, point: &Point, have: Option<&Snapshot>) -> Self {
        let read = have.and_then(|have| have.read(&point.id));
        let (Some(have), Some(Read::Registers(registers))) = (have, read) else {
            return Self { text: unread(language, read), ..Self::default() };
        };
        let shown = words::shown(profile, point, registers, have, |texts| words::pick(language, texts));
        let value = shown.as_ref().and_then(|shown| shown.text.as_deref());
        Self {
            text: value
                .map_or_else(|| language.cfg_no_value().to_owned(), |text| words::readable(language, point, text)),
            is_value: value.is_some(),
            unit: shown.as_ref().map_or_else(String::new, |shown| shown.unit.clone()),
            registers: words::registers(registers),
            factory: shown.as_ref().and_then(|shown| shown.factory),
            step: profile.grid(point, &have.known(profile)).map(|grid| grid.step),
            note: shown.filter(|shown| !shown.scaled).map(|_| language.cfg_not_scaled()),
        }
    }
}

fn unread(language: Language, read: Option<&Read>) -> String {
    match read {
        Some(Read::Refused(code)) => language.cfg_refused_read(*code, language.exception_name(*code)),
        Some(Read::NoAnswer) => language.cfg_no_answer_read().to_owned(),
        Some(Read::Registers(_)) | None => language.cfg_not_read().to_owned(),
    }
}

/// The factory's value of a point with its unit, as far as the profile tells.
pub(crate) fn factory(language: Language, profile: &Profile, point: &Point, have: &Snapshot) -> Option<String> {
    let registers = [point.factory?];
    Some(words::value(language, profile, point, &registers, have))
}

/// What is allowed, in a few words: `allowed: 1 to 247`, the unit, the smallest step. Empty where nothing is to be said.
pub(crate) fn range(language: Language, point: &Point, held: &Held) -> String {
    let limits = point.range.map(|limits| (limits.first.to_string(), limits.last.to_string()));
    let limits = limits.map(|(first, last)| language.cfg_unfit_range(&signed(&first), &signed(&last)));
    let unit = Some(held.unit.as_str()).filter(|unit| !unit.is_empty()).map(|unit| language.cfg_unit_in(unit));
    // Whole numbers go without saying.
    let step = held.step.filter(|step| step.compare(Decimal::whole(1)).is_ne());
    let step = step.map(|step| language.cfg_step_is(&step.to_string()));
    limits.into_iter().chain(unit).chain(step).collect::<Vec<_>>().join(" \u{B7} ")
}

/// The codes that can be chosen, each as it is typed, with its name.
pub(crate) fn options(language: Language, point: &Point) -> Vec<(String, String)> {
    let option = |code: &buslens_codec::profile::Code| {
        let name = code.name.as_ref().map(|name| words::pick(language, name).clone());
        let number = code.number.map(|number| number.to_string());
        let label = match (number, name) {
            (Some(number), Some(name)) => format!("{number} ({name})"),
            (Some(text), None) | (None, Some(text)) => text,
            (None, None) => code.code.to_string(),
        };
        let label = if point.unit.is_empty() { label } else { format!("{label} {}", point.unit) };
        (typed_code(code.code), label)
    };
    point.codes.iter().map(option).collect()
}

/// A code as the list's value has it.
pub(crate) fn typed_code(code: u16) -> String {
    format!("0x{code:04X}")
}

/// What a write of a point can cost, by the worst of its codes.
pub(crate) fn danger(point: &Point) -> Danger {
    point.codes.iter().map(|code| code.danger).chain([point.danger]).max().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use buslens_configure::{Datum, Reach};

    use super::*;
    use crate::device;

    fn have(profile: &Profile, data: &[(&str, Read)]) -> Snapshot {
        let mut have = Snapshot::empty(profile, Reach::of_factory(profile));
        have.data = data.iter().map(|(id, read)| Datum { point: (*id).to_owned(), read: read.clone() }).collect();
        have
    }

    #[test]
    fn a_row_says_value_unit_registers_and_whether_the_factory_set_it() {
        let profile = device::find("lvdt").profile();
        let point = profile.point("baud").unwrap();
        let have = have(profile, &[("baud", Read::Registers(vec![7]))]);
        let held = Held::of(Language::En, profile, point, Some(&have));
        assert_eq!((held.text.as_str(), held.unit.as_str(), held.registers.as_str()), ("115200", "Bd", "0007"));
        assert_eq!(held.factory, Some(false));
        assert_eq!(factory(Language::En, profile, point, &have).as_deref(), Some("9600 Bd"));
        assert_eq!(options(Language::En, point)[6], ("0x0007".to_owned(), "115200 Bd".to_owned()));
    }

    #[test]
    fn a_hyphen_in_a_text_or_a_name_is_no_minus_sign_and_neither_has_steps() {
        let text = include_str!("../../codec/profiles/lvdt.json");
        let text = text.replacen(
            "\"points\": [",
            r#""points": [
              { "id": "tag", "name": { "en": "Tag", "zh": "位号" }, "register": 512,
                "encoding": { "type": "text", "registers": 2 }, "read": [3], "write": [16], "role": "parameter" },
              { "id": "mode", "name": { "en": "Mode", "zh": "模式" }, "register": 514, "encoding": { "type": "code" },
                "read": [3], "write": [6], "role": "parameter",
                "codes": [ { "code": 0, "name": { "en": "stand-by", "zh": "待机" } } ] },
              { "id": "trim", "name": { "en": "Trim", "zh": "微调" }, "register": 515,
                "encoding": { "type": "i16", "decimals": 2 }, "read": [3], "write": [6], "role": "parameter" },
              { "id": "span", "name": { "en": "Span", "zh": "跨度" }, "register": 516,
                "encoding": { "type": "u16" }, "scale": 5, "offset": 2.5, "read": [3], "write": [6],
                "role": "parameter" },
              { "id": "offset", "name": { "en": "Offset", "zh": "偏移" }, "register": 517,
                "encoding": { "type": "u16", "decimals": 1 }, "offset": 0.05, "read": [3], "write": [6],
                "role": "parameter" },"#,
            1,
        );
        let profile = Profile::from_json(&text).expect("five points more");
        let data = [
            ("tag", Read::Registers(vec![0x412D, 0x2E37])),
            ("mode", Read::Registers(vec![0])),
            ("trim", Read::Registers(vec![0xFFF4])),
            ("span", Read::Registers(vec![4])),
        ];
        let have = have(&profile, &data);
        let said = |point: &str| {
            let point = profile.point(point).unwrap();
            let held = Held::of(Language::En, &profile, point, Some(&have));
            (held.text.clone(), range(Language::En, point, &held))
        };
        assert_eq!(said("tag"), ("A-.7".to_owned(), String::new()));
        assert_eq!(said("mode"), ("stand-by".to_owned(), String::new()));
        assert_eq!(said("trim"), ("\u{2212}0.12".to_owned(), "in steps of 0.01".to_owned()));
        assert_eq!(said("span"), ("22.5".to_owned(), "in steps of 5".to_owned()));
        for (point, typed, why) in
            [("span", "24", "in steps of 5, from 2.5 on"), ("offset", "0.1", "in steps of 0.1, from 0.05 on")]
        {
            let found = profile.point(point).unwrap();
            let refused = buslens_configure::Edit::parse(&profile, found, typed, &have).expect_err("it lies between");
            assert_eq!(words::unfit(Language::En, &profile, point, &refused.why), why);
        }
    }

    #[test]
    fn what_was_not_read_says_why() {
        let profile = device::find("lvdt").profile();
        let point = profile.point("parity").unwrap();
        let said = |read| Held::of(Language::En, profile, point, Some(&have(profile, &[("parity", read)]))).text;
        assert_eq!(said(Read::Refused(2)), "not read: exception 02, wrong data address");
        assert_eq!(said(Read::NoAnswer), "not read: no answer");
        assert_eq!(Held::of(Language::Zh, profile, point, None).text, "未读取");
        assert!(!Held::of(Language::En, profile, point, None).is_value);
    }

    #[test]
    fn a_scaled_value_has_its_minus_and_its_unit() {
        let profile = device::find("level").profile();
        let point = profile.point("zero_offset").unwrap();
        let have = have(
            profile,
            &[
                ("unit", Read::Registers(vec![1])),
                ("decimals", Read::Registers(vec![3])),
                ("zero_offset", Read::Registers(vec![0xFFFF])),
            ],
        );
        let held = Held::of(Language::En, profile, point, Some(&have));
        assert_eq!((held.text.as_str(), held.unit.as_str()), ("\u{2212}0.001", "kPa"));
        assert_eq!(range(Language::En, point, &held), "in kPa \u{B7} in steps of 0.001");
        assert_eq!(factory(Language::En, profile, point, &have).as_deref(), Some("0.000 kPa"));
    }

    #[test]
    fn a_value_without_its_scale_says_so() {
        let profile = device::find("level").profile();
        let point = profile.point("range_full").unwrap();
        let have = have(profile, &[("range_full", Read::Registers(vec![10_000]))]);
        let held = Held::of(Language::En, profile, point, Some(&have));
        assert_eq!((held.text.as_str(), held.note), ("10000", Some(Language::En.cfg_not_scaled())));
    }

    #[test]
    fn the_worst_code_marks_a_command() {
        let profile = device::find("level").profile();
        assert_eq!(danger(profile.point("save").unwrap()), Danger::Danger);
        assert_eq!(danger(profile.point("baud").unwrap()), Danger::Caution);
    }
}
