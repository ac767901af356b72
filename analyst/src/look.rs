//! One entry looked at closely: its JSON, and what its registers could mean.

use buslens_codec::json;
use buslens_codec::profile::{Known, Profile};
use buslens_codec::transcript::Transcript;
use buslens_codec::value::{Decimal, Encoding, Order};
use buslens_codec::views::{ViewKind, encodings_that_show, views_at};

use crate::message::{Fit, Look, RegisterViews, View};

/// Registers that are shown in every way; more would be a wall of numbers.
const MOST_REGISTERS: usize = 16;
/// Encodings that are named for a number.
const MOST_FITS: usize = 24;

/// Looks at an entry. `shown` is what the device's own display shows, as typed.
pub(crate) fn look(
    transcript: &Transcript,
    profile: Option<&Profile>,
    index: usize,
    known: &mut Known,
    shown: &str,
) -> Look {
    let registers = transcript
        .reading(index, profile, &mut known.clone())
        .dissection
        .map(|found| found.registers)
        .unwrap_or_default();
    let mut text = String::new();
    json::write_entry(&mut text, transcript, profile, index, known);
    let views = (0..registers.len().min(MOST_REGISTERS)).map(|offset| {
        let views = views_at(&registers, offset).into_iter().map(|view| View {
            name: name_of(view.kind),
            registers: u8::try_from(view.registers).unwrap_or(u8::MAX),
            text: view.text,
        });
        RegisterViews { offset: crate::desk::place(offset), views: views.collect() }
    });
    let number = Decimal::parse(&shown.trim().replace(['\u{2212}', '\u{FF0D}'], "-").replace(['\u{FF0E}', ','], "."));
    let fits = number.map(|number| encodings_that_show(&registers, number)).unwrap_or_default();
    let fits = fits.into_iter().take(MOST_FITS).map(|fit| Fit {
        offset: crate::desk::place(fit.offset),
        name: encoding_name(fit.encoding),
        decimals: fit.encoding.decimals().unwrap_or(0),
    });
    Look {
        index: crate::desk::place(index),
        json: text,
        views: views.collect(),
        understood: number.is_some(),
        fits: fits.collect(),
    }
}

fn name_of(kind: ViewKind) -> String {
    match kind {
        ViewKind::Hex => "hex".to_owned(),
        ViewKind::Binary => "binary".to_owned(),
        ViewKind::Value(encoding) => encoding_name(encoding),
    }
}

/// The encoding's name in profiles, with an order that is not the usual one.
fn encoding_name(encoding: Encoding) -> String {
    let mut name = encoding.type_name().to_owned();
    if let Some(order) = encoding.order().filter(|order| *order != Order::Abcd) {
        name.push(' ');
        name.push_str(order.name());
    }
    name
}
