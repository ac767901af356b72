//! Values under a profile.

use std::ops::Range;

use buslens_codec::dissect::NamedValue;
use buslens_codec::profile::{Code, Point, Role};
use buslens_codec::value::{Value, ValueError};

use super::{Part, Words, address_text, capital, shortened};
use crate::device::{pick, value_text};
use crate::format::{hex_spaced, signed};
use crate::text::Language;

/// Most codes that are listed.
const MOST_CODES: usize = 12;

/// A value in words.
struct Told {
    value: String,
    meaning: Vec<String>,
    is_right: bool,
}

impl<'a> Words<'a> {
    /// Registers that the profile names. Several points may share them: the longest gives the bytes.
    pub(super) fn point_part(self, function: u8, range: Range<usize>, named: &[&NamedValue]) -> Option<Part> {
        let points: Vec<(&Point, &NamedValue)> =
            named.iter().filter_map(|named| Some((self.profile?.point(&named.point)?, *named))).collect();
        let (first, longest) = points.iter().copied().max_by_key(|(_, named)| named.raw.len())?;
        let place = place_name(self.language, function, first.register);
        let mut told: Vec<Told> = points.iter().map(|(point, named)| self.told(point, named)).collect();
        let kind = if told.iter().all(|told| told.is_right) { "data" } else { "wrong" };
        let mut part = if let ([_], Some(mut told)) = (&*points, told.pop()) {
            told.meaning.insert(0, place);
            let meaning = told.meaning.join(self.language.list_comma());
            Part::new(range, kind, pick(self.language, &first.name), &told.value, &meaning, &told.value)
        } else {
            let all: Vec<String> = points.iter().map(|(point, named)| self.sentence(point, named)).collect();
            let all = all.join(self.language.list_comma());
            Part::new(range, kind, &capital(&place), &all, "", &all)
        };
        part.registers.clone_from(&longest.raw);
        Some(part)
    }

    /// `Temperature 28.5 °C`, or `Zero: zero here` where the value is a name.
    pub(super) fn sentence(self, point: &Point, named: &NamedValue) -> String {
        let told = self.told(point, named);
        let is_name = match named.value {
            Ok(Value::Code(code)) => point.code(code).is_some_and(|code| code.number.is_none() && code.name.is_some()),
            Ok(Value::Text(_)) => true,
            _ => false,
        };
        let between = if is_name { self.language.colon() } else { " " };
        let mut text = [pick(self.language, &point.name), between, &told.value].concat();
        let hint = if !told.is_right && named.value.is_ok() {
            self.language.value_invalid()
        } else if !named.scaled {
            self.language.scale_unknown_short()
        } else {
            return text;
        };
        push_bracketed(self.language, &mut text, hint);
        text
    }

    fn told(self, point: &Point, named: &NamedValue) -> Told {
        let t = self.language;
        let value = match named.value {
            Ok(value) => value,
            Err(error) => {
                let found = match error {
                    ValueError::OutOfRange { found } => hex_spaced(&found.to_be_bytes()),
                    _ => hex_spaced(&named.raw.iter().flat_map(|word| word.to_be_bytes()).collect::<Vec<u8>>()),
                };
                let meaning = vec![t.value_breaks_format(&found)];
                return Told { value: t.value_invalid().to_owned(), meaning, is_right: false };
            }
        };
        let mut told = Told { value: value_text(t, point, value), meaning: Vec::new(), is_right: true };
        let teller = |id: &Option<String>| self.profile?.point(id.as_deref()?);
        if !named.scaled {
            if let Some(teller) = teller(&point.decimals_from) {
                told.meaning.push(t.scale_unknown(pick(t, &teller.name), &address_text(teller.register)));
            }
            return told;
        }
        if !point.allows(value) {
            told.is_right = false;
            told.meaning.push(t.value_takes(&allowed(t, point)));
        } else if let Value::Code(code) = value
            && point.role != Role::Command
            && !point.codes.is_empty()
        {
            told.meaning.push(t.code_is(code));
        }
        let has_unit = match value {
            Value::Code(code) => point.code(code).is_some_and(|code| code.number.is_some()),
            Value::Text(_) => false,
            _ => true,
        };
        if has_unit && !named.unit.is_empty() {
            told.value = [&told.value, "\u{A0}", &named.unit].concat();
        } else if has_unit && let Some(teller) = teller(&point.unit_from) {
            told.meaning.push(t.unit_unknown(pick(t, &teller.name), &address_text(teller.register)));
        }
        told
    }

    /// `4 registers from 0x0002`.
    pub(super) fn places(self, function: u8, address: u16, quantity: u16) -> String {
        if quantity == 1 {
            return place_name(self.language, function, address);
        }
        let address = address_text(address);
        match function {
            0x01 | 0x05 | 0x0F => self.language.coils_from(quantity, &address),
            0x02 => self.language.inputs_from(quantity, &address),
            _ => self.language.registers_from(quantity, &address),
        }
    }

    /// The points of which something lies here.
    pub(super) fn points_at(self, function: u8, address: u16, quantity: u16) -> Vec<&'a Point> {
        let function = match function {
            // These change or read the registers that function 03 reads.
            0x16 | 0x17 => 0x03,
            function => function,
        };
        let (first, end) = (usize::from(address), usize::from(address) + usize::from(quantity));
        let touches = |point: &&Point| {
            let at = usize::from(point.register);
            point.uses(function) && at < end && first < at + point.encoding.registers()
        };
        self.profile.into_iter().flat_map(|profile| &profile.points).filter(touches).collect()
    }

    /// Their names.
    pub(super) fn names_at(self, function: u8, address: u16, quantity: u16) -> String {
        let names: Vec<&str> =
            self.points_at(function, address, quantity).iter().map(|point| pick(self.language, &point.name)).collect();
        names.join(self.language.list_of_names())
    }
}

/// What stands at an address that a function reads or writes: a register, a coil or an input.
pub(crate) fn place_name(t: Language, function: u8, address: u16) -> String {
    let address = address_text(address);
    match function {
        0x01 | 0x05 | 0x0F => t.coil_at(&address),
        0x02 => t.input_at(&address),
        _ => t.register_at(&address),
    }
}

/// The values that a point takes: its codes with their meanings, or its range. Empty if the profile does not tell.
pub(crate) fn allowed(language: Language, point: &Point) -> String {
    if !point.codes.is_empty() {
        let codes: Vec<String> = point.codes.iter().map(|code| code_text(language, point, code)).collect();
        return shortened(language, codes, language.list_comma(), MOST_CODES);
    }
    let Some(limits) = point.range else { return String::new() };
    let text = |limit| signed(&Value::Number(limit).to_string());
    let mut text = language.range_is(&text(limits.first), &text(limits.last));
    if !point.unit.is_empty() {
        text.push('\u{A0}');
        text.push_str(&point.unit);
    }
    text
}

/// `7 = 115200 Bd`.
fn code_text(language: Language, point: &Point, code: &Code) -> String {
    let meaning = value_text(language, point, Value::Code(code.code));
    let number = if code.code > 0xFF { address_text(code.code) } else { code.code.to_string() };
    if number == meaning && code.name.is_none() && code.number.is_none() {
        return number;
    }
    let unit =
        if code.number.is_some() && !point.unit.is_empty() { ["\u{A0}", &point.unit].concat() } else { String::new() };
    [&number, " = ", &meaning, &unit].concat()
}

/// ` (words)`.
pub(crate) fn push_bracketed(language: Language, text: &mut String, words: &str) {
    let [open, close] = match language {
        Language::En => [" (", ")"],
        Language::Zh => ["（", "）"],
    };
    for part in [open, words, close] {
        text.push_str(part);
    }
}
