//! A point: where it lies, how its registers hold it, what a write does.

use alloc::format;
use alloc::vec::Vec;

use super::json::{
    Found, Node, Object, boolean, choice, decimal, fault, id, integer, items, list, one_of, optional, small, text, word,
};
use super::texts;
use crate::line::{DataBits, Mode, Parity, StopBits};
use crate::profile::known::can_be_scaled;
use crate::profile::{Code, Danger, Effect, Limits, LimitsFrom, Point, Reply, Role, Scale, Setting, Texts};
use crate::value::{Decimal, Encoding, Order, Width};

/// Points that refer to each other rightly.
pub(super) fn points(node: Node<'_>) -> Found<Vec<Point>> {
    let nodes = items(node)?;
    let mut points: Vec<Point> = Vec::new();
    for node in &nodes {
        let point = point(*node)?;
        if points.iter().any(|earlier| earlier.id == point.id) {
            return fault(*node, format!("another point has the id {}", point.id));
        }
        if point.primary && points.iter().any(|earlier| earlier.primary) {
            return fault(*node, "another point is primary");
        }
        points.push(point);
    }
    for (node, point) in nodes.iter().zip(&points) {
        if let Some(reason) = points.iter().find_map(|other| clash(point, other)) {
            return fault(*node, reason);
        }
        for told_by in point.refers_to() {
            let Some(teller) = points.iter().find(|other| other.id == told_by) else {
                return fault(*node, format!("there is no point {told_by}"));
            };
            let depends = teller.refers_to().next().is_some() || teller.scale.is_some();
            if teller.read.is_empty() || teller.encoding.registers() != 1 || depends {
                return fault(
                    *node,
                    format!("{told_by} must be one register that can be read, has no scale and depends on no other"),
                );
            }
        }
        for id in point.limits_from.iter().flat_map(LimitsFrom::ids) {
            let Some(limit) = points.iter().find(|other| other.id == id) else {
                return fault(*node, format!("there is no point {id}"));
            };
            let unit = |point: &Point| (point.decimals_from.clone(), point.unit_from.clone(), point.unit.clone());
            if limit.read.is_empty() || !is_number(limit.encoding) || unit(limit) != unit(point) {
                return fault(
                    *node,
                    format!("{id} must be a number that can be read, with the same unit and decimals"),
                );
            }
        }
        if point.decimals_from.is_some() && !can_be_scaled(point.encoding) {
            return fault(*node, "only whole numbers are scaled by another point, and without decimals of their own");
        }
    }
    Ok(points)
}

/// Two points under the same function in the same register, of which neither is a bitfield, cannot both be right.
fn clash(point: &Point, other: &Point) -> Option<alloc::string::String> {
    let is_bits = |point: &Point| matches!(point.encoding, Encoding::Bits { .. });
    let overlaps = usize::from(point.register) < usize::from(other.register) + other.encoding.registers()
        && usize::from(other.register) < usize::from(point.register) + point.encoding.registers();
    let shared = point.read.iter().chain(&point.write).any(|function| other.uses(*function));
    (point.id != other.id && overlaps && shared && !(is_bits(point) && is_bits(other)))
        .then(|| format!("{} has the same register and function", other.id))
}

const KEYS: [&str; 22] = [
    "id",
    "name",
    "note",
    "consequence",
    "register",
    "encoding",
    "read",
    "write",
    "unit",
    "unit_from",
    "decimals_from",
    "scale",
    "offset",
    "limits_from",
    "role",
    "primary",
    "range",
    "codes",
    "factory",
    "danger",
    "effects",
    "reply",
];

fn point(node: Node<'_>) -> Found<Point> {
    let object = Object::of(node, &KEYS)?;
    let encoding_node = object.need("encoding")?;
    let encoding = encoding(encoding_node)?;
    let register_node = object.need("register")?;
    let register = word(register_node)?;
    if usize::from(register) + encoding.registers() > 0x1_0000 {
        return fault(register_node, "runs over the last register");
    }
    let read = functions(object.find("read"), &[1, 2, 3, 4])?;
    let write = functions(object.find("write"), &[5, 6, 15, 16])?;
    if read.is_empty() && write.is_empty() {
        return fault(node, "nothing reads it and nothing writes it");
    }
    let is_bit = read.iter().chain(&write).any(|function| matches!(function, 1 | 2 | 5 | 15));
    if is_bit && encoding != Encoding::Code {
        return fault(encoding_node, "a coil or discrete input is a code");
    }
    if encoding.registers() > 1 && write.contains(&6) {
        return fault(node, "function 6 writes one register");
    }
    let codes_node = object.find("codes");
    let codes = codes_node.map(|node| codes(node, is_bit)).transpose()?.unwrap_or_default();
    let is_code = matches!(encoding, Encoding::Code | Encoding::Bits { .. });
    if let (Some(node), false) = (codes_node, is_code) {
        return fault(node, "only the types code and bits have codes");
    }
    let role_node = object.need("role")?;
    let role = choice(
        role_node,
        &["measurement", "parameter", "command"],
        &[Role::Measurement, Role::Parameter, Role::Command],
    )?;
    if role == Role::Measurement && read.is_empty() {
        return fault(role_node, "a measurement is read by a function");
    }
    let limits_node = object.find("limits_from");
    if let (Some(node), true) = (limits_node, role != Role::Measurement || !is_number(encoding)) {
        return fault(node, "only a measurement that is a number has limits");
    }
    let effects_node = object.find("effects");
    let effects = list(effects_node, effect)?;
    if let (Some(node), true) = (effects_node, write.is_empty()) {
        return fault(node, "what is never written has no effects");
    }
    if let (Some(node), false) = (effects_node, effects.iter().all(|effect| is_told(*effect, encoding, &codes))) {
        return fault(node, "what the codes (number, sets) or the written number do not tell cannot be an effect");
    }
    if let Some(code) = codes.iter().find(|code| code.sets.is_some_and(|setting| !effects.contains(&setting.effect())))
    {
        return fault(node, format!("the code {} sets what is none of the effects", code.code));
    }
    let (danger, consequence) = cost(&object, &codes, write.is_empty())?;
    let replies = |node| choice(node, &["either", "old", "new"], &[Reply::Either, Reply::Old, Reply::New]);
    Ok(Point {
        id: id(object.need("id")?)?,
        name: texts(object.need("name")?)?,
        note: object.find("note").map(texts).transpose()?,
        consequence,
        register,
        encoding,
        read,
        write,
        unit: optional(object.find("unit"), text)?,
        unit_from: object.find("unit_from").map(id).transpose()?,
        decimals_from: object.find("decimals_from").map(id).transpose()?,
        scale: scale(&object, encoding)?,
        limits_from: limits_node.map(limits_from).transpose()?,
        role,
        primary: optional(object.find("primary"), boolean)?,
        range: object.find("range").map(limits).transpose()?,
        codes,
        factory: object.find("factory").map(word).transpose()?,
        danger,
        effects,
        reply: optional(object.find("reply"), replies)?,
    })
}

/// Meanings of codes, each of them once.
fn codes(node: Node<'_>, is_bit: bool) -> Found<Vec<Code>> {
    let mut codes: Vec<Code> = Vec::new();
    for node in items(node)? {
        let code = code(node)?;
        if codes.iter().any(|earlier| earlier.code == code.code) {
            return fault(node, format!("the code {} stands twice", code.code));
        }
        if is_bit && !matches!(code.code, 0x0000 | 0xFF00) {
            return fault(node, format!("a coil or discrete input is 0xFF00 or 0, not {}", code.code));
        }
        codes.push(code);
    }
    Ok(codes)
}

/// What a write can cost and what it does: whoever is to confirm a danger must be told.
fn cost(object: &Object<'_>, codes: &[Code], is_only_read: bool) -> Found<(Danger, Option<Texts>)> {
    let danger_node = object.find("danger");
    let danger = optional(danger_node, danger)?;
    let consequence_node = object.find("consequence");
    let consequence = consequence_node.map(texts).transpose()?;
    if let (Some(node), true) = (consequence_node, is_only_read) {
        return fault(node, "what is never written has no consequence");
    }
    let is_told = |code: &Code| consequence.is_some() || code.consequence.is_some();
    let all_told = if codes.is_empty() { consequence.is_some() } else { codes.iter().all(is_told) };
    if let (Some(node), Danger::Danger, false) = (danger_node, danger, all_told) {
        return fault(node, "tell what this danger costs, as consequence");
    }
    if let (Some(node), Some(code)) =
        (object.find("codes"), codes.iter().find(|code| code.danger == Danger::Danger && !is_told(code)))
    {
        return fault(node, format!("tell what the danger of code {} costs, as consequence", code.code));
    }
    Ok((danger, consequence))
}

/// Function codes, each of them allowed.
fn functions(node: Option<Node<'_>>, allowed: &[u8]) -> Found<Vec<u8>> {
    list(node, |node| {
        let function = small(node, u8::MAX)?;
        if !allowed.contains(&function) {
            let allowed: Vec<_> = allowed.iter().map(|function| format!("{function}")).collect();
            return fault(node, format!("must be one of {}", allowed.join(", ")));
        }
        Ok(function)
    })
}

const TYPES: [&str; 20] = [
    "u16",
    "i16",
    "u32",
    "i32",
    "u64",
    "i64",
    "sign_magnitude_16",
    "sign_magnitude_32",
    "sign_magnitude_64",
    "bcd_16",
    "bcd_32",
    "bcd_64",
    "f32",
    "f64",
    "reserved_i16",
    "sign_magnitude_thousandths",
    "sign_byte_magnitude",
    "code",
    "bits",
    "text",
];

fn encoding(node: Node<'_>) -> Found<Encoding> {
    let object = Object::of(node, &["type", "decimals", "order", "mask", "shift", "registers"])?;
    let kind = one_of(object.need("type")?, &TYPES)?;
    let decimals = optional(object.find("decimals"), decimals)?;
    let order_node = object.find("order");
    let order = optional(order_node, |node| choice(node, &Order::ALL.map(Order::name), &Order::ALL))?;
    let width = [Width::One, Width::Two, Width::Four];
    let only = |key: &str, allowed: bool| match object.find(key) {
        Some(node) if !allowed => fault(node, format!("this type has no {key}")),
        _ => Ok(()),
    };
    only("decimals", matches!(kind, 0..=11 | 14 | 16))?;
    only("order", matches!(kind, 0..=13 | 19))?;
    only("mask", kind == 18)?;
    only("shift", kind == 18)?;
    only("registers", kind == 19)?;
    let found = match kind {
        0..=5 => Encoding::Integer { width: width[kind / 2], signed: kind % 2 == 1, decimals, order },
        6..=8 => Encoding::SignMagnitude { width: width[kind - 6], decimals, order },
        9..=11 => Encoding::Bcd { width: width[kind - 9], decimals, order },
        12 => Encoding::Float { order },
        13 => Encoding::Double { order },
        14 => Encoding::ReservedI16 { decimals },
        15 => Encoding::SignMagnitudeThousandths,
        16 => Encoding::SignByteMagnitude { decimals },
        17 => Encoding::Code,
        18 => bits(&object)?,
        _ => {
            let registers_node = object.need("registers")?;
            let registers = small(registers_node, 16)?;
            if registers == 0 {
                return fault(registers_node, "must be 1 to 16");
            }
            Encoding::Text { registers, order }
        }
    };
    if let (Some(node), 1, true) = (order_node, found.registers(), order.low_register_first()) {
        return fault(node, "one register is ABCD, or BADC with its low byte first");
    }
    Ok(found)
}

/// The mask says it all; the shift is told only where a code is written with its place, as 0x20 for bit 5.
fn bits(object: &Object<'_>) -> Found<Encoding> {
    let mask_node = object.need("mask")?;
    let mask = word(mask_node)?;
    if mask == 0 {
        return fault(mask_node, "must have at least one bit");
    }
    let least = u8::try_from(mask.trailing_zeros()).unwrap_or(0);
    let shift = object.find("shift").map(|node| small(node, least)).transpose()?.unwrap_or(least);
    Ok(Encoding::Bits { mask, shift })
}

fn decimals(node: Node<'_>) -> Found<i8> {
    let number = node.as_integer_str().ok().and_then(|digits| digits.parse().ok());
    number
        .filter(|number| (-9..=18).contains(number))
        .map_or_else(|| fault(node, "must be a whole number from -9 to 18"), Ok)
}

fn limits(node: Node<'_>) -> Found<Limits> {
    let object = Object::of(node, &["first", "last"])?;
    let limits = Limits { first: decimal(object.need("first")?)?, last: decimal(object.need("last")?)? };
    if limits.first.compare(limits.last).is_gt() {
        return fault(node, "must run upwards");
    }
    Ok(limits)
}

fn limits_from(node: Node<'_>) -> Found<LimitsFrom> {
    let object = Object::of(node, &["first", "last"])?;
    Ok(LimitsFrom { first: id(object.need("first")?)?, last: id(object.need("last")?)? })
}

/// A factor, an offset, or both.
fn scale(object: &Object<'_>, encoding: Encoding) -> Found<Option<Scale>> {
    let (factor_node, offset_node) = (object.find("scale"), object.find("offset"));
    let Some(node) = factor_node.or(offset_node) else { return Ok(None) };
    if !is_exact(encoding) {
        return fault(node, "only whole numbers and decimals have a scale and an offset");
    }
    let factor = factor_node.map_or(Ok(Decimal::whole(1)), decimal)?;
    if factor.mantissa == 0 {
        return fault(node, "must not be 0");
    }
    Ok(Some(Scale { factor, offset: offset_node.map_or(Ok(Decimal::whole(0)), decimal)? }))
}

/// A number with all its digits, unlike a float.
fn is_exact(encoding: Encoding) -> bool {
    matches!(
        encoding,
        Encoding::Integer { .. }
            | Encoding::SignMagnitude { .. }
            | Encoding::Bcd { .. }
            | Encoding::ReservedI16 { .. }
            | Encoding::SignMagnitudeThousandths
            | Encoding::SignByteMagnitude { .. }
    )
}

fn is_number(encoding: Encoding) -> bool {
    is_exact(encoding) || matches!(encoding, Encoding::Float { .. } | Encoding::Double { .. })
}

fn code(node: Node<'_>) -> Found<Code> {
    let object = Object::of(node, &["code", "number", "name", "sets", "danger", "consequence"])?;
    let code = Code {
        code: word(object.need("code")?)?,
        number: object.find("number").map(|node| integer(node, u32::MAX)).transpose()?,
        name: object.find("name").map(texts).transpose()?,
        sets: object.find("sets").map(setting).transpose()?,
        danger: optional(object.find("danger"), danger)?,
        consequence: object.find("consequence").map(texts).transpose()?,
    };
    if code.number.is_none() && code.name.is_none() {
        return fault(node, "a code has a number or a name");
    }
    Ok(code)
}

fn setting(node: Node<'_>) -> Found<Setting> {
    choice(
        node,
        &["none", "odd", "even", "rtu", "ascii", "seven", "eight", "one", "two"],
        &[
            Setting::Parity(Parity::None),
            Setting::Parity(Parity::Odd),
            Setting::Parity(Parity::Even),
            Setting::Mode(Mode::Rtu),
            Setting::Mode(Mode::Ascii),
            Setting::DataBits(DataBits::Seven),
            Setting::DataBits(DataBits::Eight),
            Setting::StopBits(StopBits::One),
            Setting::StopBits(StopBits::Two),
        ],
    )
}

/// Whether what a write does to the link can be told from what is written.
fn is_told(effect: Effect, encoding: Encoding, codes: &[Code]) -> bool {
    let sets = |code: &Code| code.sets.is_some_and(|setting| setting.effect() == effect);
    match effect {
        Effect::Unit | Effect::Baud if codes.is_empty() => matches!(encoding, Encoding::Integer { .. }),
        Effect::Unit | Effect::Baud => codes.iter().all(|code| code.number.is_some()),
        Effect::Parity | Effect::DataBits | Effect::StopBits | Effect::Mode => {
            !codes.is_empty() && codes.iter().all(sets)
        }
        Effect::Restart | Effect::Defaults | Effect::Search => true,
    }
}

fn danger(node: Node<'_>) -> Found<Danger> {
    choice(node, &["none", "caution", "danger"], &[Danger::None, Danger::Caution, Danger::Danger])
}

fn effect(node: Node<'_>) -> Found<Effect> {
    choice(
        node,
        &["unit", "baud", "parity", "data_bits", "stop_bits", "mode", "restart", "defaults", "search"],
        &[
            Effect::Unit,
            Effect::Baud,
            Effect::Parity,
            Effect::DataBits,
            Effect::StopBits,
            Effect::Mode,
            Effect::Restart,
            Effect::Defaults,
            Effect::Search,
        ],
    )
}

#[cfg(test)]
mod tests {
    use nojson::RawJson;

    use super::*;

    #[test]
    fn every_type_is_read_as_what_it_is_called() {
        for name in TYPES {
            let more = match name {
                "bits" => ", \"mask\": \"0x0F00\"",
                "text" => ", \"registers\": 3",
                _ => "",
            };
            let text = format!("{{ \"type\": \"{name}\"{more} }}");
            let json = RawJson::parse(&text).unwrap();
            let found = encoding(json.value()).unwrap_or_else(|fault| panic!("{name}: {}", fault.reason));
            assert_eq!(found.type_name(), name);
            match found {
                Encoding::Bits { mask, shift } => assert_eq!((mask, shift), (0x0F00, 8)),
                Encoding::Text { registers, .. } => assert_eq!(registers, 3),
                _ => assert!(matches!(found.decimals(), None | Some(0))),
            }
        }
    }
}
