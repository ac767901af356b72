//! What names and numbers of a text mean for a point of a profile.

use buslens_codec::profile::{Code, Point};
use buslens_codec::value::{Decimal, Encoding, Text, Value};

use crate::script::Operand;

/// What is written for a value, as far as the text alone tells it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Literal<'a> {
    Number(Decimal),
    Name(&'a str),
    Code(u16),
}

/// What an operand says by itself.
pub(crate) fn literal(operand: &Operand) -> Option<Literal<'_>> {
    match operand {
        Operand::Number { number, .. } => Some(Literal::Number(*number)),
        Operand::Name(name) => Some(Literal::Name(name)),
        Operand::Code(code) => Some(Literal::Code(*code)),
        _ => None,
    }
}

/// Whether the point's values are codes.
pub(crate) fn has_codes(point: &Point) -> bool {
    matches!(point.encoding, Encoding::Code | Encoding::Bits { .. })
}

/// The value of a point that a text means; `None` where no code has this name or number, or the encoding has no such
/// values. A number is a code's number; the code itself where its codes have none.
pub(crate) fn value(point: &Point, literal: &Literal<'_>) -> Option<Value> {
    if has_codes(point) {
        return Some(Value::Code(match literal {
            Literal::Code(code) => *code,
            Literal::Name(name) => point.codes.iter().find(|code| is_called(code, name))?.code,
            Literal::Number(number) => {
                let number = u32::try_from(number.mantissa_with(0)?).ok()?;
                if point.codes.iter().any(|code| code.number.is_some()) {
                    point.codes.iter().find(|code| code.number == Some(number))?.code
                } else {
                    let code = u16::try_from(number).ok()?;
                    (point.codes.is_empty() || point.code(code).is_some()).then_some(code)?
                }
            }
        }));
    }
    match (point.encoding, literal) {
        (Encoding::Float { .. }, Literal::Number(number)) => number.to_string().parse().ok().map(Value::Float),
        (Encoding::Double { .. }, Literal::Number(number)) => number.to_string().parse().ok().map(Value::Double),
        (Encoding::Text { .. }, Literal::Name(name)) => Text::new(name.as_bytes()).map(Value::Text),
        (Encoding::Text { .. }, _) | (_, Literal::Name(_)) => None,
        (_, Literal::Number(number)) => Some(Value::Number(*number)),
        (_, Literal::Code(code)) => Some(Value::Number(Decimal::whole(i64::from(*code)))),
    }
}

/// Whether a code goes by this name, in either language.
fn is_called(code: &Code, name: &str) -> bool {
    code.name.as_ref().is_some_and(|texts| texts.en == name || texts.zh == name)
}

/// What the codes of a point are called: by number or by English name.
pub(crate) fn code_names(point: &Point) -> Vec<String> {
    let called = |code: &Code| match (code.number, &code.name) {
        (Some(number), _) => number.to_string(),
        (None, Some(name)) => name.en.clone(),
        (None, None) => code.code.to_string(),
    };
    point.codes.iter().map(called).collect()
}

/// Whether a value may be written to a point, by the text alone: the profile allows it and it can be encoded. Scaled points
/// are encoded when their scale is known.
pub(crate) fn may_be_written(point: &Point, value: Value) -> bool {
    point.allows(value) && (point.decimals_from.is_some() || point.encode(value).is_ok())
}
