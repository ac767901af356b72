//! Registers of an unknown device: everything that they could mean, and what makes a number of what its display shows.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use crate::value::{Decimal, Encoding, Order, Value, ValueError, Width};

/// One way to read some registers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct View {
    /// Which way.
    pub kind: ViewKind,
    /// How many registers it takes.
    pub registers: usize,
    /// What they are then.
    pub text: String,
}

/// A way to read registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewKind {
    /// Four hexadecimal digits.
    Hex,
    /// Sixteen bits in groups of four.
    Binary,
    /// A value in this encoding, without digits behind the point.
    Value(Encoding),
}

/// Registers and an encoding in which they are the number that was looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fit {
    /// The first of its registers.
    pub offset: usize,
    /// How they hold it, with order and decimals: as a profile takes it.
    pub encoding: Encoding,
}

/// All views of what begins at `offset`: first those of one register, then of two, of four, and the text from there on.
/// Those that the registers rule out are left out (digits beyond 9, thousandths beyond 999), also those that need more
/// registers than there are. Empty if `offset` is behind the last register.
pub fn views_at(registers: &[u16], offset: usize) -> Vec<View> {
    let Some(&first) = registers.get(offset) else { return Vec::new() };
    let rest = registers.get(offset..).unwrap_or_default();
    let mut views = Vec::new();
    views.push(View { kind: ViewKind::Hex, registers: 1, text: hex(first) });
    views.push(View { kind: ViewKind::Binary, registers: 1, text: binary(first) });
    for encoding in numbers() {
        // It is the second register's own view.
        if matches!(encoding, Encoding::ReservedI16 { .. }) {
            continue;
        }
        let Some(own) = rest.get(..encoding.registers()) else { continue };
        if let Some(text) = value_text(encoding, own) {
            views.push(View { kind: ViewKind::Value(encoding), registers: own.len(), text });
        }
    }
    let letters = rest.len().min(16);
    let own = rest.get(..letters).unwrap_or_default();
    for order in [Order::Abcd, Order::Badc] {
        let encoding = Encoding::Text { registers: u8::try_from(letters).unwrap_or(16), order };
        if let Ok(text) = encoding.decode(own) {
            views.push(View { kind: ViewKind::Value(encoding), registers: letters, text: text.to_string() });
        }
    }
    views
}

/// Every place and encoding in which the registers are `shown`: whole numbers exactly, at whatever power of ten, floats
/// when rounded to the digits shown. The simplest first: few registers, the usual order, as many decimals as shown.
pub fn encodings_that_show(registers: &[u16], shown: Decimal) -> Vec<Fit> {
    let mut fits: Vec<(u32, Fit)> = Vec::new();
    for encoding in numbers() {
        for (offset, own) in registers.windows(encoding.registers()).enumerate() {
            if let Some(encoding) = encoding.decode(own).ok().and_then(|value| fit(encoding, value, shown)) {
                fits.push((effort(encoding, shown), Fit { offset, encoding }));
            }
        }
    }
    fits.sort_by_key(|(effort, fit)| (*effort, fit.offset));
    fits.into_iter().map(|(_, fit)| fit).collect()
}

/// Every encoding of a number, without decimals, those of few registers first.
fn numbers() -> impl Iterator<Item = Encoding> {
    let decimals = 0;
    let of_width = move |width: Width| {
        let orders = if width == Width::One { &[Order::Abcd, Order::Badc][..] } else { &Order::ALL[..] };
        let of_order = move |order: Order| {
            let float = match width {
                Width::One => None,
                Width::Two => Some(Encoding::Float { order }),
                Width::Four => Some(Encoding::Double { order }),
            };
            let whole = [
                Encoding::Integer { width, signed: false, decimals, order },
                Encoding::Integer { width, signed: true, decimals, order },
                Encoding::SignMagnitude { width, decimals, order },
                Encoding::Bcd { width, decimals, order },
            ];
            whole.into_iter().chain(float)
        };
        orders.iter().copied().flat_map(of_order)
    };
    let of_two = [
        Encoding::ReservedI16 { decimals },
        Encoding::SignMagnitudeThousandths,
        Encoding::SignByteMagnitude { decimals },
    ];
    of_width(Width::One).chain(of_width(Width::Two)).chain(of_two).chain(of_width(Width::Four))
}

/// The encoding with the decimals that make the value what is shown.
fn fit(encoding: Encoding, value: Value, shown: Decimal) -> Option<Encoding> {
    match value {
        Value::Number(number) if encoding.decimals().is_none() => number.compare(shown).is_eq().then_some(encoding),
        Value::Number(number) if number.mantissa == 0 || shown.mantissa == 0 => {
            let decimals = i8::try_from(shown.decimals.min(Decimal::MAX_DECIMALS)).ok()?;
            (number.mantissa == shown.mantissa).then_some(encoding.with_decimals(decimals))
        }
        Value::Number(number) => {
            let decimals = (-9..=18).find(|decimals| shown.mantissa_with(*decimals) == Some(number.mantissa))?;
            Some(encoding.with_decimals(decimals))
        }
        Value::Float(_) | Value::Double(_) => shows_rounded(value.to_f64()?, shown).then_some(encoding),
        Value::Code(_) | Value::Text(_) => None,
    }
}

/// Whether a float is `shown` when it is rounded to as many digits. Nothing but zero is shown as zero here: every pair
/// of small registers is a float of almost zero.
#[allow(clippy::cast_precision_loss)] // a display has fewer than 16 digits
fn shows_rounded(float: f64, shown: Decimal) -> bool {
    if shown.mantissa == 0 {
        return float == 0.0;
    }
    let last_digit = Decimal { mantissa: 1, decimals: shown.decimals }.to_f64();
    (float / last_digit - shown.mantissa as f64).abs() <= 0.5
}

/// How far from simple an encoding is that shows the number.
fn effort(encoding: Encoding, shown: Decimal) -> u32 {
    let registers = u32::try_from(encoding.registers()).unwrap_or(u32::MAX).saturating_mul(4);
    let order = match encoding.order() {
        None | Some(Order::Abcd) => 0,
        Some(Order::Cdab) => 3,
        Some(Order::Badc | Order::Dcba) => 6,
    };
    let kind = match encoding {
        Encoding::Integer { signed: false, .. } => 0,
        Encoding::Integer { signed: true, .. } | Encoding::Float { .. } | Encoding::Double { .. } => 1,
        Encoding::SignMagnitudeThousandths | Encoding::SignByteMagnitude { .. } => 2,
        Encoding::ReservedI16 { .. } => 3,
        _ => 4,
    };
    let decimals = encoding.decimals().map_or(0, |decimals| i32::from(decimals).abs_diff(shown.decimals.into()));
    registers + order + kind + decimals.saturating_mul(12)
}

fn value_text(encoding: Encoding, registers: &[u16]) -> Option<String> {
    match (encoding.decode(registers), encoding) {
        (Ok(value), _) => Some(value.to_string()),
        // The upper half of 64 bits is beyond a decimal, but not beyond its own digits.
        (Err(ValueError::OutOfRange { .. }), Encoding::Integer { order, .. }) => {
            Some(order.gather(registers).to_string())
        }
        (Err(_), _) => None,
    }
}

fn hex(register: u16) -> String {
    digits(register, 4).collect()
}

fn binary(register: u16) -> String {
    let spaced = |(at, digit)| (at > 0 && at % 4 == 0).then_some(' ').into_iter().chain([digit]);
    digits(register, 1).enumerate().flat_map(spaced).collect()
}

/// The digits of a register of so many bits each, upper-case.
fn digits(register: u16, bits: usize) -> impl Iterator<Item = char> {
    let digit = move |shift: usize| u32::from(register >> shift) & ((1 << bits) - 1);
    let character = |digit| char::from_digit(digit, 16).unwrap_or('?').to_ascii_uppercase();
    (0..16).step_by(bits).rev().map(move |shift| character(digit(shift)))
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use proptest::prelude::*;

    use super::*;

    fn text_of(registers: &[u16], kind: ViewKind) -> Option<String> {
        views_at(registers, 0).into_iter().find(|view| view.kind == kind).map(|view| view.text)
    }

    fn shown(registers: &[u16], type_name: &str, order: Option<Order>) -> Option<String> {
        let of_kind = |view: &View| match view.kind {
            ViewKind::Value(encoding) => encoding.type_name() == type_name && encoding.order() == order,
            ViewKind::Hex | ViewKind::Binary => false,
        };
        views_at(registers, 0).into_iter().find(of_kind).map(|view| view.text)
    }

    /// Offset, type, order, decimals.
    type Parts = (usize, &'static str, Option<Order>, Option<i8>);

    fn fits(registers: &[u16], number: &str) -> Vec<Parts> {
        let found = encodings_that_show(registers, Decimal::parse(number).unwrap());
        let parts = |fit: Fit| (fit.offset, fit.encoding.type_name(), fit.encoding.order(), fit.encoding.decimals());
        found.into_iter().map(parts).collect()
    }

    #[test]
    fn one_register_in_every_way() {
        let registers = [0x8042];
        assert_eq!(text_of(&registers, ViewKind::Hex).unwrap(), "8042");
        assert_eq!(text_of(&registers, ViewKind::Binary).unwrap(), "1000 0000 0100 0010");
        let cases = [
            ("u16", Order::Abcd, Some("32834")),
            ("u16", Order::Badc, Some("17024")),
            ("i16", Order::Abcd, Some("-32702")),
            ("sign_magnitude_16", Order::Abcd, Some("-66")),
            ("bcd_16", Order::Abcd, Some("8042")),
            ("u32", Order::Abcd, None),
        ];
        for (name, order, text) in cases {
            assert_eq!(shown(&registers, name, Some(order)).as_deref(), text, "{name}");
        }
        assert_eq!(shown(&[0x4F4B], "text", Some(Order::Abcd)).unwrap(), "OK");
        assert_eq!(shown(&[0x4B4F], "text", Some(Order::Badc)).unwrap(), "OK");
        assert_eq!(shown(&[0x12AB], "bcd_16", Some(Order::Abcd)), None);
    }

    #[test]
    fn two_and_four_registers_in_every_order() {
        let float = [0x42F6, 0xE979];
        assert_eq!(shown(&float, "f32", Some(Order::Abcd)).unwrap(), "123.456");
        assert_eq!(shown(&[0xE979, 0x42F6], "f32", Some(Order::Cdab)).unwrap(), "123.456");
        assert_eq!(shown(&[0xF642, 0x79E9], "f32", Some(Order::Badc)).unwrap(), "123.456");
        assert_eq!(shown(&[0x79E9, 0xF642], "f32", Some(Order::Dcba)).unwrap(), "123.456");
        assert_eq!(shown(&float, "u32", Some(Order::Cdab)).unwrap(), "3917038326");
        assert_eq!(shown(&[0x8000, 0x0148], "sign_magnitude_thousandths", None).unwrap(), "-0.328");
        assert_eq!(shown(&[0x0100, 0x1235], "sign_byte_magnitude", None).unwrap(), "-4661");
        let all = [0xFFFF; 4];
        assert_eq!(shown(&all, "u64", Some(Order::Abcd)).unwrap(), "18446744073709551615");
        assert_eq!(shown(&all, "i64", Some(Order::Dcba)).unwrap(), "-1");
        assert_eq!(shown(&all[..3], "i64", Some(Order::Dcba)), None);
        assert_eq!(shown(&[0x3FF8, 0, 0, 0], "f64", Some(Order::Abcd)).unwrap(), "1.5");
        assert_eq!(views_at(&all, 4), vec![]);
    }

    #[test]
    fn the_formats_of_the_devices_are_found() {
        // The sensor's sign and thousandths behind its temperature.
        let found = fits(&[0, 285, 0x007B, 0x01C8], "123.456");
        assert_eq!(found, [(2, "sign_magnitude_thousandths", None, None)]);
        assert_eq!(fits(&[0x8000, 0x0148], "-0.328")[0].1, "sign_magnitude_thousandths");
        // The temperature itself is simplest as the second register; its reserved word is a candidate too.
        let found = fits(&[0, 285, 0x007B, 0x01C8], "28.5");
        assert_eq!(found[0], (1, "u16", Some(Order::Abcd), Some(1)));
        assert!(found.contains(&(0, "reserved_i16", None, Some(1))));
        // The gauge's sign byte.
        assert_eq!(fits(&[0x0100, 0x1235], "-4.661"), [(0, "sign_byte_magnitude", None, Some(3))]);
        assert!(fits(&[0x0000, 0x1235], "4.661").contains(&(0, "sign_byte_magnitude", None, Some(3))));
        // The transmitter's whole number, scaled elsewhere.
        assert_eq!(fits(&[6000], "6.000")[0], (0, "u16", Some(Order::Abcd), Some(3)));
        assert_eq!(fits(&[0xFFFF], "-0.001")[0], (0, "i16", Some(Order::Abcd), Some(3)));
    }

    #[test]
    fn common_formats_of_other_makers_are_found() {
        let found = |registers: &[u16], number, name, order, decimals| {
            let found = fits(registers, number);
            let parts = (0, name, Some(order), decimals);
            assert!(found.contains(&parts), "{registers:04X?} {number}: {found:?}");
        };
        found(&[0x42F6, 0xE979], "123.456", "f32", Order::Abcd, None);
        found(&[0xE979, 0x42F6], "123.46", "f32", Order::Cdab, None);
        found(&[0x79E9, 0xF642], "123.5", "f32", Order::Dcba, None);
        found(&[0x0001, 0xE240], "123.456", "u32", Order::Abcd, Some(3));
        found(&[0xE240, 0x0001], "123.456", "u32", Order::Cdab, Some(3));
        found(&[0x0012, 0x3456], "123.456", "bcd_32", Order::Abcd, Some(3));
        found(&[0x0C00], "1200", "u16", Order::Badc, Some(-2));
        found(&[0x405E, 0xDD2F, 0x1A9F, 0xBE77], "123.456", "f64", Order::Abcd, None);
        found(&[0xFFFF, 0xFFFF, 0xFFFE, 0x1DC0], "-123.456", "i64", Order::Abcd, Some(3));
        assert_eq!(fits(&[0x42F6, 0xE979], "123.457"), []);
        assert_eq!(fits(&[12], "1200")[0], (0, "u16", Some(Order::Abcd), Some(-2)));
    }

    #[test]
    fn zero_is_shown_by_zeros_only() {
        let found = fits(&[0, 5], "0.00");
        assert!(found.iter().all(|(offset, ..)| *offset == 0));
        assert_eq!(found[0], (0, "u16", Some(Order::Abcd), Some(2)));
        assert!(found.iter().all(|(_, name, ..)| *name != "f32"));
        assert!(fits(&[0, 0], "0").contains(&(0, "f32", Some(Order::Abcd), None)));
    }

    proptest! {
        #[test]
        fn what_fits_decodes_to_what_is_shown(
            registers in prop::collection::vec(any::<u16>(), 0..8),
            encoding in prop::sample::select(numbers().collect::<Vec<_>>()),
            decimals in 0i8..6,
            offset in 0usize..5,
        ) {
            let encoding = encoding.with_decimals(decimals);
            let value = registers.get(offset..offset + encoding.registers()).and_then(|own| encoding.decode(own).ok());
            if let Some(Value::Number(number)) = value {
                let fits = encodings_that_show(&registers, number);
                let expected = Fit { offset, encoding };
                prop_assert!(fits.contains(&expected), "{:?}", fits);
                for Fit { offset, encoding } in fits {
                    let own = &registers[offset..offset + encoding.registers()];
                    match encoding.decode(own).unwrap() {
                        Value::Number(found) => prop_assert!(found.compare(number).is_eq()),
                        other => prop_assert!(shows_rounded(other.to_f64().unwrap(), number)),
                    }
                }
            }
        }

        #[test]
        fn no_registers_panic(
            registers in prop::collection::vec(any::<u16>(), 0..20),
            offset: usize,
            small in 0usize..24,
            mantissa: i64,
            decimals: u8,
        ) {
            prop_assert!(views_at(&registers, offset % 1000).len() < 100);
            for view in views_at(&registers, small) {
                prop_assert!(small + view.registers <= registers.len());
            }
            let _ = encodings_that_show(&registers, Decimal { mantissa, decimals });
        }
    }
}
