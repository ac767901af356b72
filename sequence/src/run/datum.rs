//! Values while a sequence runs, and how they compare.

use core::cmp::Ordering;

use buslens_codec::profile::{Point, PointValue};
use buslens_codec::value::{Decimal, Value};

use crate::meaning::{self, Literal};
use crate::report::Reason;
use crate::script::{Comparison, Sign};

/// A value that can be compared, added, written back and shown.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Datum {
    pub(super) what: What,
    /// Empty for none and where it is not known.
    pub(super) unit: String,
    /// Whether the text says so, not a device.
    pub(super) literal: bool,
    /// The code as it stands in its register, with its point's id.
    code: Option<(String, u16)>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum What {
    /// Also floats, by their shortest digits.
    Number(Decimal),
    /// A float that no decimal holds.
    Float(f64),
    /// In English and in Chinese.
    Name(String, String),
    /// A code that its table does not know, or that the text names as such.
    Code(u16),
}

impl Datum {
    pub(super) fn number(number: Decimal, unit: &str, literal: bool) -> Self {
        Self { what: What::Number(number), unit: unit.to_owned(), literal, code: None }
    }

    pub(super) fn name(name: &str) -> Self {
        Self { what: What::Name(name.to_owned(), name.to_owned()), unit: String::new(), literal: true, code: None }
    }

    pub(super) fn code(code: u16) -> Self {
        Self { what: What::Code(code), unit: String::new(), literal: true, code: None }
    }

    /// A coil or an input.
    pub(super) fn bit(on: bool) -> Self {
        Self { literal: false, ..Self::name(if on { "on" } else { "off" }) }
    }

    /// What was read of a point.
    pub(super) fn of(point: &Point, value: Value, unit: &str) -> Self {
        let plain = |what| Self { what, unit: unit.to_owned(), literal: false, code: None };
        match value {
            Value::Number(number) => plain(What::Number(number)),
            Value::Float(_) | Value::Double(_) => plain(match Decimal::parse(&value.to_string()) {
                Some(number) => What::Number(number),
                None => What::Float(value.to_f64().unwrap_or(f64::NAN)),
            }),
            Value::Text(text) => plain(What::Name(text.to_string(), text.to_string())),
            Value::Code(code) => {
                let known = point.code(code);
                let what = match known.map(|known| (known.number, &known.name)) {
                    Some((Some(number), _)) => What::Number(Decimal::whole(number.into())),
                    Some((None, Some(name))) => What::Name(name.en.clone(), name.zh.clone()),
                    _ => What::Code(code),
                };
                Self { code: Some((point.id.clone(), code)), ..plain(what) }
            }
        }
    }

    /// In a variable: its unit is no claim of the text any more.
    pub(super) fn kept(self) -> Self {
        Self { literal: false, ..self }
    }

    /// The value that writes this to a point.
    pub(super) fn value_for(&self, point: &Point) -> Option<Value> {
        match (&self.what, &self.code) {
            (_, Some((id, code))) if *id == point.id => Some(Value::Code(*code)),
            (What::Number(number), _) => meaning::value(point, &Literal::Number(*number)),
            (What::Name(name, _), _) => meaning::value(point, &Literal::Name(name)),
            (What::Code(code), _) => meaning::value(point, &Literal::Code(*code)),
            (What::Float(_), _) => None,
        }
    }

    /// The register of 16 bits that holds this: a whole number with or without sign, or a code.
    pub(super) fn register(&self) -> Option<u16> {
        match (&self.what, &self.code) {
            (_, Some((_, code))) | (What::Code(code), _) => Some(*code),
            (What::Number(number), _) => {
                let whole = number.mantissa_with(0)?;
                u16::try_from(whole).ok().or_else(|| i16::try_from(whole).ok().map(i16::cast_unsigned))
            }
            _ => None,
        }
    }

    /// Whether the text names another unit for the number that stands on the other side.
    pub(super) fn check_unit(&self, other: &Self) -> Result<(), Reason> {
        let (text, device) = if self.literal { (self, other) } else { (other, self) };
        if text.unit.is_empty() || text.unit == device.unit {
            return Ok(());
        }
        Err(Reason::OtherUnit { found: device.unit.clone(), wanted: text.unit.clone() })
    }

    pub(super) fn plus(&self, sign: Sign, other: &Self) -> Result<Self, Reason> {
        if !self.unit.is_empty() {
            self.check_unit(other).or_else(|reason| if other.unit.is_empty() { Ok(()) } else { Err(reason) })?;
        }
        let (What::Number(left), What::Number(right)) = (&self.what, &other.what) else { return Err(Reason::NoSum) };
        let decimals = left.decimals.max(right.decimals);
        let sum = || {
            let places = i8::try_from(decimals).ok()?;
            let (left, right) = (left.mantissa_with(places)?, right.mantissa_with(places)?);
            match sign {
                Sign::Plus => left.checked_add(right),
                Sign::Minus => left.checked_sub(right),
            }
        };
        let mantissa = sum().ok_or(Reason::NoSum)?;
        let unit = if self.unit.is_empty() { &other.unit } else { &self.unit };
        Ok(Self::number(Decimal { mantissa, decimals }, unit, self.literal && other.literal))
    }

    pub(super) fn holds(&self, how: Comparison, other: &Self) -> Result<bool, Reason> {
        self.check_unit(other)?;
        let order = self.order(other);
        Ok(match how {
            Comparison::Equal => self.equals(other, order),
            Comparison::NotEqual => !self.equals(other, order),
            Comparison::Less => order.ok_or(Reason::NotComparable)?.is_lt(),
            Comparison::LessOrEqual => order.ok_or(Reason::NotComparable)?.is_le(),
            Comparison::Greater => order.ok_or(Reason::NotComparable)?.is_gt(),
            Comparison::GreaterOrEqual => order.ok_or(Reason::NotComparable)?.is_ge(),
        })
    }

    /// `None` for what has no order, a float that is no number among it.
    fn order(&self, other: &Self) -> Option<Ordering> {
        match (&self.what, &other.what) {
            (What::Number(left), What::Number(right)) => Some(left.compare(*right)),
            (What::Number(left), What::Float(right)) => left.to_f64().partial_cmp(right),
            (What::Float(left), What::Number(right)) => left.partial_cmp(&right.to_f64()),
            (What::Float(left), What::Float(right)) => left.partial_cmp(right),
            _ => None,
        }
    }

    fn equals(&self, other: &Self, order: Option<Ordering>) -> bool {
        if let (What::Name(en, zh), What::Name(other_en, other_zh)) = (&self.what, &other.what) {
            return en == other_en || zh == other_zh;
        }
        if order.is_some() {
            return order == Some(Ordering::Equal);
        }
        // A code against a number or a code: as it stands in the register, if one side means it so.
        let raw = |datum: &Self| match (&datum.what, &datum.code) {
            (What::Code(code), _) | (_, Some((_, code))) => Some(*code),
            (What::Number(number), None) => u16::try_from(number.mantissa_with(0)?).ok(),
            _ => None,
        };
        raw(self).is_some() && raw(self) == raw(other)
    }
}

/// With its unit, codes by number or English name.
impl core::fmt::Display for Datum {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match &self.what {
            What::Number(number) => number.fmt(f)?,
            What::Float(float) => Value::Double(*float).fmt(f)?,
            What::Name(en, _) => en.fmt(f)?,
            What::Code(code) => code.fmt(f)?,
        }
        if self.unit.is_empty() { Ok(()) } else { write!(f, " {}", self.unit) }
    }
}

/// What a read has brought of a point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Seen {
    /// `None` where the registers hold no value.
    pub(super) datum: Option<Datum>,
    pub(super) scaled: bool,
}

impl Seen {
    pub(super) fn of(found: &PointValue<'_>) -> Self {
        Self { datum: found.value.ok().map(|value| Datum::of(found.point, value, found.unit)), scaled: found.scaled }
    }
}
