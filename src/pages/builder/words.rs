//! The fields in words: labels, hints, faults.

use buslens_codec::intake::{IntakeError, IntakeFault};

use super::Label;
use crate::builder::{Draft, Fault, Slot};
use crate::components::field::Note;
use crate::format::push_hex;
use crate::text::Language;

/// What a function does.
pub(super) fn function_name(language: Language, code: u8) -> &'static str {
    crate::anatomy::function_name(language, code)
}

/// A field's name.
pub(super) fn label(slot: Slot) -> Label {
    match slot {
        Slot::Unit => Language::unit,
        Slot::Code => Language::function,
        Slot::Exception => Language::exception_code,
        Slot::SubFunction => Language::sub_function_code,
        Slot::Address => Language::start_address,
        Slot::Quantity => Language::quantity,
        Slot::Coil => Language::coil_value,
        Slot::Value => Language::register_value,
        Slot::WriteAddress => Language::write_address,
        Slot::Values => Language::register_values,
        Slot::Bits => Language::bit_values,
        Slot::Status => Language::status_byte,
        Slot::Data => Language::data,
        Slot::AndMask => Language::and_mask,
        Slot::OrMask => Language::or_mask,
        Slot::Ranges => Language::file_ranges,
        Slot::Records => Language::file_records,
        Slot::Contents => Language::file_contents,
        Slot::IdCode => Language::id_code,
        Slot::Object => Language::object_id,
        Slot::Conformity => Language::conformity,
        Slot::More => Language::more_follows,
        Slot::Objects => Language::id_objects,
        Slot::Busy => Language::busy_word,
        Slot::EventCount => Language::event_count,
        Slot::MessageCount => Language::message_count,
    }
}

/// What stands under a field: what is wrong with it, else what to think of, else how to fill it.
pub(super) fn note(language: Language, draft: &Draft, slot: Slot, text: &str) -> Option<Note> {
    if let Some(fault) = draft.fault(slot) {
        return Some(Note::Wrong(fault_text(language, fault)));
    }
    let number = draft.number(slot);
    let hint = |hint: &str| Some(Note::Hint(hint.to_owned()));
    match slot {
        Slot::Unit => match number? {
            0 => Some(Note::Warning(language.unit_broadcast().to_owned())),
            248.. => Some(Note::Warning(language.unit_reserved().to_owned())),
            _ => other_notation(language, draft, slot, text),
        },
        Slot::Quantity => {
            let last = u32::from(draft.number(Slot::Address)?) + u32::from(number?);
            let past = || Note::Warning(language.past_the_end().to_owned());
            (last > 0x1_0000).then(past)
        }
        Slot::Exception => hint(language.exception_name(u8::try_from(number?).ok()?)),
        Slot::SubFunction => hint(language.hint_sub_functions()),
        Slot::Values => hint(language.hint_values()),
        Slot::Bits => hint(language.hint_bits()),
        Slot::Data => hint(language.hint_data()),
        Slot::Ranges => hint(language.hint_ranges()),
        Slot::Records => hint(language.hint_records()),
        Slot::Contents => hint(language.hint_contents()),
        Slot::IdCode => hint(language.hint_id_code()),
        Slot::Objects => hint(language.hint_objects()),
        Slot::Coil => None,
        _ => other_notation(language, draft, slot, text),
    }
}

/// Where a text of bytes stops making sense.
pub(super) fn bytes_fault(language: Language, error: IntakeError) -> String {
    let what = match error.fault {
        IntakeFault::Unexpected(character) => language.unexpected_character(character),
        IntakeFault::OddDigits => language.odd_digits().to_owned(),
        _ => language.fault_bytes().to_owned(),
    };
    language.parse_error_at(error.line, error.column, &what)
}

/// The number as it was not typed: decimal for hexadecimal and the other way round.
fn other_notation(language: Language, draft: &Draft, slot: Slot, text: &str) -> Option<Note> {
    let other = if text.contains(['x', 'X']) {
        draft.number(slot)?.to_string()
    } else {
        let mut other = "0x".to_owned();
        push_hex(&mut other, draft.bytes(slot)?);
        other
    };
    Some(Note::Hint(language.same_as(&other)))
}

/// A limit with a real minus sign.
fn limit(number: i32) -> String {
    crate::format::signed(&number.to_string())
}

fn fault_text(language: Language, fault: Fault) -> String {
    match fault {
        Fault::Number { first, last } => language.fault_number(&limit(first), &limit(last)),
        Fault::Item { at, first, last } => language.fault_item(at, &limit(first), &limit(last)),
        Fault::Count { first, last } if first == last => language.fault_count_exact(first),
        Fault::Count { first, last } => language.form_count(first, last),
        Fault::Bit => language.fault_bit().to_owned(),
        Fault::Hex(error) => bytes_fault(language, error),
        Fault::Line(line) => language.fault_line(line),
        Fault::Record => language.fault_record().to_owned(),
        Fault::TooLong => language.form_too_long().to_owned(),
    }
}
