//! A profile's point as fields: what a read, a write or a command of it puts into them, and its value.

use buslens_codec::profile::Point;
use buslens_codec::value::{Decimal, Encoding, Text, Value};

use super::{Draft, FUNCTIONS, Slot, parse};

/// What a point puts into the form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Template {
    /// One of [`FUNCTIONS`].
    pub(crate) function: u8,
    /// Fields with their texts.
    pub(crate) texts: Vec<(Slot, String)>,
}

/// The read or write of a point; `None` where the device knows none.
pub(crate) fn template(point: &Point, write: bool) -> Option<Template> {
    let count = point.encoding.registers();
    let functions = if write { &point.write } else { &point.read };
    // Functions 05 and 06 take one register only.
    let fits = |function: &&u8| FUNCTIONS.contains(function) && (count == 1 || !matches!(**function, 5 | 6 | 15));
    let function = *functions.iter().find(fits)?;
    let mut texts = texts(&first_registers(point));
    texts.push((Slot::Address, hex(point.register)));
    texts.push((Slot::Quantity, count.to_string()));
    Some(Template { function, texts })
}

/// Registers as every field that can hold them.
pub(crate) fn texts(registers: &[u16]) -> Vec<(Slot, String)> {
    let first = registers.first().copied().unwrap_or_default();
    let list: Vec<String> = registers.iter().map(ToString::to_string).collect();
    let on = first != 0;
    vec![
        (Slot::Values, list.join(" ")),
        (Slot::Value, first.to_string()),
        (Slot::Coil, if on { "on" } else { "off" }.to_owned()),
        (Slot::Bits, if on { "1" } else { "0" }.to_owned()),
    ]
}

/// The registers that the fields hold, if they are as many as the point has.
pub(crate) fn registers_in(draft: &Draft, point: &Point) -> Option<Vec<u16>> {
    let field = draft.fields.iter().find(|field| is_carrier(field.slot))?;
    let bytes = field.bytes.as_ref().ok()?;
    let registers: Vec<u16> = if field.slot == Slot::Bits {
        bytes.first().map(|byte| if byte & 1 == 1 { 0xFF00 } else { 0 }).into_iter().collect()
    } else {
        bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect()
    };
    (registers.len() == point.encoding.registers()).then_some(registers)
}

/// Whether a field holds registers of points.
pub(crate) fn is_carrier(slot: Slot) -> bool {
    matches!(slot, Slot::Values | Slot::Value | Slot::Coil | Slot::Bits)
}

/// The registers that hold what was typed. Whether the device takes it is another matter: [`Point::allows`].
pub(crate) fn registers_of(point: &Point, text: &str) -> Option<(Value, Vec<u16>)> {
    let value = value_of(point, text)?;
    Some((value, point.encode(value).ok()?))
}

/// The value of registers as it would be typed.
pub(crate) fn text_of(point: &Point, registers: &[u16]) -> Option<String> {
    Some(point.decode(registers).ok()?.to_string())
}

/// `0x0032`.
pub(crate) fn hex(word: u16) -> String {
    let mut text = "0x".to_owned();
    crate::format::push_hex(&mut text, &word.to_be_bytes());
    text
}

fn value_of(point: &Point, text: &str) -> Option<Value> {
    let text = text.trim().replace('\u{2212}', "-");
    let decimal = || Decimal::parse(&text);
    match point.encoding {
        Encoding::Code | Encoding::Bits { .. } => Some(Value::Code(u16::try_from(parse::number(&text)?).ok()?)),
        Encoding::Text { .. } => Text::new(text.as_bytes()).map(Value::Text),
        // A float has what precision it has.
        #[allow(clippy::cast_possible_truncation)]
        Encoding::Float { .. } => Some(Value::Float(decimal()?.to_f64() as f32)),
        Encoding::Double { .. } => Some(Value::Double(decimal()?.to_f64())),
        _ => decimal().map(Value::Number),
    }
}

/// What to begin with: the factory's setting, else the first code, else the least that may be written.
fn first_registers(point: &Point) -> Vec<u16> {
    let code = point.factory.or_else(|| point.codes.first().map(|code| code.code));
    let least = || point.encode(Value::Number(point.range?.first)).ok();
    code.map(|code| vec![code]).or_else(least).unwrap_or_else(|| vec![0; point.encoding.registers()])
}

#[cfg(test)]
mod tests {
    use super::super::Way;
    use super::*;
    use crate::device;

    fn point(device: &str, id: &str) -> &'static Point {
        device::find(device).profile().point(id).unwrap()
    }

    fn draft(way: Way, template: &Template) -> Draft {
        Draft::of(way, Some(template.function), &|slot| {
            let text = template.texts.iter().find(|(found, _)| *found == slot);
            text.map_or_else(|| slot.default().to_owned(), |(_, text)| text.clone())
        })
    }

    fn pdu(way: Way, template: &Template) -> Vec<u8> {
        draft(way, template).whole.unwrap().1
    }

    #[test]
    fn a_point_is_read_and_written_by_the_functions_of_its_profile() {
        let read = template(point("lvdt", "displacement"), false).unwrap();
        assert_eq!(pdu(Way::Request, &read), [4, 0, 4, 0, 2]);
        assert_eq!(pdu(Way::Response, &read), [4, 4, 0, 0, 0, 0]);
        let parity = template(point("lvdt", "parity"), true).unwrap();
        assert_eq!(pdu(Way::Request, &parity), [0x10, 0, 0x32, 0, 1, 2, 0, 2]);
        assert_eq!(pdu(Way::Response, &parity), [0x10, 0, 0x32, 0, 1]);
        let zero = template(point("lvdt", "zero"), true).unwrap();
        assert_eq!(pdu(Way::Request, &zero), [5, 0, 0x50, 0xFF, 0]);
        let address = template(point("level", "address"), true).unwrap();
        assert_eq!(pdu(Way::Request, &address), [6, 0, 0, 0, 1]);
        assert_eq!(template(point("lvdt", "displacement"), true), None);
        assert_eq!(template(point("lvdt", "zero"), false), None);
    }

    #[test]
    fn every_point_of_every_device_fills_the_form() {
        for device in device::built_in() {
            for point in &device.profile().points {
                for write in [false, true] {
                    let functions = if write { &point.write } else { &point.read };
                    let Some(found) = template(point, write) else {
                        assert!(functions.is_empty(), "{} {}", device.id(), point.id);
                        continue;
                    };
                    let draft = draft(Way::Request, &found);
                    assert!(draft.whole.is_some(), "{} {}", device.id(), point.id);
                    if write {
                        assert_eq!(registers_in(&draft, point), Some(first_registers(point)));
                    }
                }
            }
        }
    }

    #[test]
    fn a_typed_value_becomes_registers_and_comes_back() {
        let displacement = point("lvdt", "displacement");
        let (value, registers) = registers_of(displacement, "\u{2212}0.328").unwrap();
        assert_eq!(registers, [0x8000, 0x0148]);
        assert!(displacement.allows(value));
        assert_eq!(text_of(displacement, &registers).as_deref(), Some("-0.328"));
        assert_eq!(registers_of(displacement, "0.0001"), None);
        assert_eq!(registers_of(displacement, "1e3"), None);
        let address = point("lvdt", "address");
        assert!(registers_of(address, "248").is_some_and(|(value, _)| !address.allows(value)));
    }
}
