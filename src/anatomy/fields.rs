//! Each field of a frame in words.

use buslens_codec::dissect::{Check, Direction, Dissection, FieldKind, NamedValue};
use buslens_codec::pdu::{Request, SubFunction};

use super::bits::{binary, labelled, set_bits};
use super::{Part, Words, address_text, capital, check_texts, legible, names};
use crate::device::pick;
use crate::format::{self, hex, hex_spaced};

/// One field among the others.
#[derive(Clone, Copy)]
struct At<'a> {
    found: &'a Dissection,
    request: Option<&'a Request>,
    index: usize,
}

impl<'a> At<'a> {
    fn kind(self) -> FieldKind {
        self.found.fields.get(self.index).map_or(FieldKind::Data, |field| field.kind)
    }

    fn part(self, kind: &'static str, name: &str, value: &str, meaning: &str, caption: &str) -> Part {
        let range = self.found.fields.get(self.index).map_or(0..0, |field| field.range.clone());
        Part::new(range, kind, name, value, meaning, caption)
    }

    /// What stands before it, the nearest first.
    fn before(self) -> impl Iterator<Item = FieldKind> + use<'a> {
        let before = self.found.fields.get(..self.index).unwrap_or_default();
        before.iter().rev().map(|field| field.kind)
    }
}

impl Words<'_> {
    /// Every byte of the frame in exactly one part.
    pub(super) fn parts(self, found: &Dissection, request: Option<&Request>) -> Vec<Part> {
        let mut parts: Vec<Part> = Vec::with_capacity(found.fields.len());
        let mut end = 0;
        for (index, field) in found.fields.iter().enumerate() {
            let start = field.range.start;
            // The first of a value's registers brought the whole value.
            if start < end {
                continue;
            }
            let named: Vec<&NamedValue> = found.points.iter().filter(|named| named.range.start == start).collect();
            let longest = named.iter().map(|named| named.range.end).max();
            let point = longest.and_then(|end| self.point_part(found.function, start..end, &named));
            let part = point.unwrap_or_else(|| self.field_part(At { found, request, index }));
            end = part.range.end;
            parts.push(part);
        }
        parts
    }

    fn field_part(self, at: At<'_>) -> Part {
        let t = self.language;
        let mut part = match at.kind() {
            FieldKind::Start => at.part("mark", t.field_start(), ":", "", t.field_start()),
            FieldKind::End => at.part("mark", t.field_end(), "CR LF", "", t.field_end()),
            FieldKind::Check => self.check(at),
            FieldKind::Unit(unit) => {
                let meaning = match unit.0 {
                    0 => t.unit_is_broadcast(),
                    248.. => t.unit_is_reserved(),
                    _ => "",
                };
                at.part("unit", t.unit(), &unit.to_string(), meaning, &t.unit_id(unit.0))
            }
            FieldKind::Function(code) => {
                let (name, text) = (names::function_in(t, at.found), hex(code));
                if code & 0x80 == 0 {
                    at.part("function", t.function(), &text, name, name)
                } else {
                    at.part("wrong", t.function(), &text, &t.function_refused(name), t.exception_word())
                }
            }
            FieldKind::Exception(code) => {
                let name = t.exception_name(code.code());
                at.part("wrong", t.exception_code(), &hex(code.code()), name, name)
            }
            FieldKind::Data => self.data(at),
            FieldKind::Address(_)
            | FieldKind::Quantity(_)
            | FieldKind::ByteCount(_)
            | FieldKind::WriteAddress(_)
            | FieldKind::WriteQuantity(_)
            | FieldKind::FifoByteCount(_)
            | FieldKind::FifoCount(_) => self.place_part(at),
            FieldKind::Register { .. }
            | FieldKind::Coil(_)
            | FieldKind::Bits { .. }
            | FieldKind::AndMask(_)
            | FieldKind::OrMask(_) => self.value_part(at),
            FieldKind::ReferenceType(_)
            | FieldKind::FileNumber(_)
            | FieldKind::RecordNumber(_)
            | FieldKind::RecordLength(_)
            | FieldKind::RecordByteCount(_) => self.file_part(at),
            FieldKind::MeiType(_)
            | FieldKind::DeviceIdCode(_)
            | FieldKind::Conformity(_)
            | FieldKind::MoreFollows(_)
            | FieldKind::NextObject(_)
            | FieldKind::ObjectCount(_)
            | FieldKind::ObjectId(_)
            | FieldKind::ObjectLength(_)
            | FieldKind::ObjectValue => self.identity_part(at),
            _ => self.health_part(at),
        };
        if let Some(fault) = at.found.fault.filter(|fault| names::is_blamed(*fault, at.kind())) {
            part.kind = "wrong";
            part.meaning = names::fault_text(t, fault);
        }
        part
    }

    fn check(self, at: At<'_>) -> Part {
        let t = self.language;
        let check: Check = at.found.check;
        let (name, found, expected) = check_texts(check);
        if check.is_ok() {
            at.part("check", name, &found, t.check_ok(), &t.check_caption_ok(name))
        } else {
            at.part("wrong", name, &found, &t.check_wrong_expected(&expected), &t.check_expected(&expected))
        }
    }

    fn data(self, at: At<'_>) -> Part {
        let t = self.language;
        let echoed = at.before().any(|kind| kind == FieldKind::SubFunction(SubFunction::RETURN_QUERY_DATA));
        let meaning = if echoed { t.data_comes_back() } else { t.data_unknown() };
        at.part("data", t.data(), &hex_spaced(&self.content(at)), meaning, t.data())
    }

    /// Where something is and how much of it.
    fn place_part(self, at: At<'_>) -> Part {
        let (t, function) = (self.language, at.found.function);
        let place = |name: &str, address: u16| {
            let text = address_text(address);
            at.part("place", name, &text, &self.names_at(function, address, 1), &text)
        };
        let quantity = |name: &str, first: Option<u16>, quantity: u16| {
            let names = first.filter(|_| quantity > 1).map(|first| self.names_at(function, first, quantity));
            let text = quantity.to_string();
            at.part("place", name, &text, &names.unwrap_or_default(), &["×", &text].concat())
        };
        let count = |count: u16| at.part("place", t.byte_count(), &count.to_string(), "", &names::bytes_text(t, count));
        match at.kind() {
            FieldKind::Address(address) => {
                let name = match function {
                    0x01 | 0x05 | 0x0F => t.coil_address(),
                    0x02 => t.input_address(),
                    0x17 => t.read_address(),
                    0x18 => t.queue_address(),
                    _ => t.register_address(),
                };
                place(name, address)
            }
            FieldKind::WriteAddress(address) => place(t.write_address(), address),
            FieldKind::Quantity(value) => {
                let name = if function == 0x17 { t.read_quantity() } else { t.quantity() };
                quantity(name, at.found.address, value)
            }
            FieldKind::WriteQuantity(value) => {
                let first = at.before().find_map(|kind| match kind {
                    FieldKind::WriteAddress(address) => Some(address),
                    _ => None,
                });
                quantity(t.write_quantity(), first, value)
            }
            FieldKind::ByteCount(value) => count(value.into()),
            FieldKind::FifoByteCount(value) => count(value),
            FieldKind::FifoCount(value) => at.part(
                "place",
                t.queue_count(),
                &value.to_string(),
                &t.queue_is(value),
                &["×", &value.to_string()].concat(),
            ),
            _ => self.data(at),
        }
    }

    /// Registers, coils, masks.
    fn value_part(self, at: At<'_>) -> Part {
        let (t, function) = (self.language, at.found.function);
        match at.kind() {
            FieldKind::Register { address, value } => {
                let mut meaning = String::new();
                if value > 0x7FFF {
                    meaning = t.signed_is(&format::signed(&value.cast_signed().to_string()));
                }
                let name = match (address, record_of(at)) {
                    (Some(address), _) => {
                        let point =
                            self.points_at(function, address, 1).into_iter().find(|p| p.encoding.registers() > 1);
                        if let Some(point) = point {
                            meaning = t.part_of(pick(t, &point.name), point.encoding.registers());
                        }
                        t.register_at(&address_text(address))
                    }
                    (None, Some((file, record))) => t.record_at(file, record),
                    (None, None) => t.register().to_owned(),
                };
                let text = value.to_string();
                let mut part = at.part("data", &capital(&name), &text, &meaning, &text);
                part.registers.push(value);
                part
            }
            FieldKind::Coil(value) => {
                let state = match value {
                    0xFF00 => t.coil_on(),
                    0 => t.coil_off(),
                    _ => t.value_invalid(),
                };
                at.part("data", t.coil_value(), &hex_spaced(&value.to_be_bytes()), state, state)
            }
            FieldKind::Bits { address, count, value } => {
                let skipped = 8 * at.before().take_while(|kind| matches!(kind, FieldKind::Bits { .. })).count();
                // The address is that of this byte, the count of skipped ones serves where it is not known.
                let skipped = if address.is_some() { 0 } else { skipped };
                let used: Vec<bool> = (0..count.min(8)).map(|position| value >> position & 1 == 1).collect();
                let name = if function == 0x02 { t.input_states() } else { t.coil_states() };
                let text = binary(value.into(), 8);
                let mut part = at.part("data", name, &text, &self.states(function, address, skipped, &used), &text);
                part.bits = Some(labelled(value.into(), 8, &|position| {
                    if position < count {
                        self.bit_name(function, address, skipped + usize::from(position))
                    } else {
                        t.bit_fills_up().to_owned()
                    }
                }));
                part
            }
            FieldKind::AndMask(mask) => {
                let mut part = at.part("data", t.and_mask(), &binary(mask, 16), t.and_mask_is(), t.and_mask());
                let label = |position: u8| if mask >> position & 1 == 1 { t.bit_stays() } else { t.bit_is_set() };
                part.bits = Some(labelled(mask, 16, &|position| label(position).to_owned()));
                part
            }
            FieldKind::OrMask(mask) => {
                let mut part = at.part("data", t.or_mask(), &binary(mask, 16), t.or_mask_is(), t.or_mask());
                let kept = at.before().find_map(|kind| match kind {
                    FieldKind::AndMask(mask) => Some(mask),
                    _ => None,
                });
                let kept = kept.unwrap_or_default();
                part.bits = Some(labelled(mask, 16, &|position| {
                    let label = match (kept >> position & 1, mask >> position & 1) {
                        (1, _) => t.bit_stays(),
                        (_, 1) => "→ 1",
                        _ => "→ 0",
                    };
                    label.to_owned()
                }));
                part
            }
            _ => self.data(at),
        }
    }

    /// Functions 14 and 15.
    fn file_part(self, at: At<'_>) -> Part {
        let t = self.language;
        let number = |name: &str, value: u16| {
            let text = value.to_string();
            at.part("place", name, &text, "", &[name, " ", &text].concat())
        };
        match at.kind() {
            FieldKind::ReferenceType(value) => {
                let is_file = if value == 6 { t.reference_type_is() } else { t.value_invalid() };
                at.part("place", t.reference_type(), &value.to_string(), is_file, is_file)
            }
            FieldKind::FileNumber(value) => number(t.file_number(), value),
            FieldKind::RecordNumber(value) => number(t.record_number(), value),
            FieldKind::RecordLength(value) => {
                let text = value.to_string();
                at.part("place", t.record_length(), &text, &names::registers_text(t, value), &["×", &text].concat())
            }
            FieldKind::RecordByteCount(value) => {
                at.part("place", t.record_byte_count(), &value.to_string(), "", &names::bytes_text(t, value.into()))
            }
            _ => self.data(at),
        }
    }

    /// Function 2B.
    fn identity_part(self, at: At<'_>) -> Part {
        let t = self.language;
        let plain = |name: &str, value: u8| at.part("place", name, &value.to_string(), "", &value.to_string());
        match at.kind() {
            FieldKind::MeiType(value) => {
                let name = match value {
                    0x0D => t.mei_canopen(),
                    0x0E => t.function_43_14(),
                    _ => t.mei_unknown(),
                };
                at.part("function", t.mei_type(), &hex(value), name, name)
            }
            FieldKind::DeviceIdCode(code) => {
                let name = names::device_id_name(t, code);
                at.part("place", t.device_id_code(), &hex(code), name, name)
            }
            FieldKind::Conformity(level) => {
                let name = match level & 0x7F {
                    code @ 1..=3 => names::device_id_name(t, code),
                    _ => t.value_invalid(),
                };
                let access = if level & 0x80 == 0 { t.conformity_stream() } else { t.conformity_single() };
                at.part("data", t.conformity(), &hex(level), &[name, t.list_comma(), access].concat(), name)
            }
            FieldKind::MoreFollows(value) => {
                let name = match value {
                    0xFF => t.more_follows_yes(),
                    0 => t.more_follows_no(),
                    _ => t.value_invalid(),
                };
                at.part("data", t.more_follows(), &hex(value), name, name)
            }
            FieldKind::NextObject(id) => {
                // It counts only where there are more.
                let more = at.before().any(|kind| kind == FieldKind::MoreFollows(0xFF));
                let name = if more { names::object_name(t, id) } else { String::new() };
                at.part("data", t.next_object(), &hex(id), &name, &hex(id))
            }
            FieldKind::ObjectCount(count) => plain(t.object_count(), count),
            FieldKind::ObjectId(id) => {
                let name = names::object_name(t, id);
                at.part("place", t.object_id(), &hex(id), &name, &name)
            }
            FieldKind::ObjectLength(length) => {
                at.part("place", t.object_length(), &length.to_string(), "", &names::bytes_text(t, length.into()))
            }
            FieldKind::ObjectValue => {
                let id = at.before().find_map(|kind| match kind {
                    FieldKind::ObjectId(id) => Some(id),
                    _ => None,
                });
                let name = id.map_or_else(|| t.data().to_owned(), |id| names::object_name(t, id));
                let text = legible(&self.content(at));
                at.part("data", &name, &text, "", &text)
            }
            _ => self.data(at),
        }
    }

    /// Functions 07, 08, 0B, 0C and 11: how the device is.
    fn health_part(self, at: At<'_>) -> Part {
        let t = self.language;
        let plain = |name: &str, value: u16, meaning: &str| {
            at.part("data", name, &value.to_string(), meaning, &value.to_string())
        };
        match at.kind() {
            FieldKind::ExceptionStatus(value) => {
                let text = binary(value.into(), 8);
                let meaning = [&set_bits(t, value), t.list_pause(), t.bits_are_the_makers()].concat();
                let mut part = at.part("data", t.exception_status(), &text, &meaning, &text);
                part.bits = Some(labelled(value.into(), 8, &|_| String::new()));
                part
            }
            FieldKind::SubFunction(code) => {
                let name = names::sub_function_name(t, code);
                at.part("function", t.sub_function(), &hex_spaced(&code.0.to_be_bytes()), name, name)
            }
            FieldKind::DiagnosticValue(value) => {
                let code = at.before().find_map(|kind| match kind {
                    FieldKind::SubFunction(code) => Some(code),
                    _ => None,
                });
                let meaning = code.map(|code| self.diagnostic(code, value, at.found.direction)).unwrap_or_default();
                let text = hex_spaced(&value.to_be_bytes());
                let mut part = at.part("data", t.diagnostic_data(), &text, &meaning, &text);
                if code == Some(SubFunction::RETURN_DIAGNOSTIC_REGISTER) && at.found.direction == Direction::Response {
                    part.value = binary(value, 16);
                    part.bits = Some(labelled(value, 16, &|_| String::new()));
                }
                part
            }
            FieldKind::Status(value) => {
                let name = match value {
                    0 => t.status_ready(),
                    0xFFFF => t.status_busy(),
                    _ => t.value_invalid(),
                };
                at.part("data", t.status_word(), &hex_spaced(&value.to_be_bytes()), name, name)
            }
            FieldKind::EventCount(count) => plain(t.event_count(), count, t.event_count_is()),
            FieldKind::MessageCount(count) => plain(t.message_count(), count, t.message_count_is()),
            FieldKind::Event(event) => self.event(at, event),
            FieldKind::ServerId => {
                let content = self.content(at);
                let text = legible(&content);
                at.part("data", t.server_id(), &text, &hex_spaced(&content), &text)
            }
            FieldKind::RunIndicator(value) => {
                let name = super::summary::run_text(self, value);
                at.part("data", t.run_indicator(), &hex(value), name, name)
            }
            _ => self.data(at),
        }
    }

    /// What the data of a diagnostic say; empty where they say nothing.
    pub(super) fn diagnostic(self, code: SubFunction, value: u16, direction: Direction) -> String {
        let t = self.language;
        match code {
            SubFunction::RESTART_COMMUNICATIONS if value == 0xFF00 => t.log_is_cleared().to_owned(),
            SubFunction::RESTART_COMMUNICATIONS if value == 0 => t.log_is_kept().to_owned(),
            SubFunction::CHANGE_ASCII_DELIMITER => t.delimiter_is(&legible(&value.to_be_bytes()[..1])),
            SubFunction::RETURN_DIAGNOSTIC_REGISTER if direction == Direction::Response => {
                t.bits_are_the_makers().to_owned()
            }
            SubFunction(11..=18) if direction == Direction::Response => t.counter_is(value),
            _ if value == 0 => t.parameter_is_zero().to_owned(),
            _ => String::new(),
        }
    }

    /// An entry of the event log.
    fn event(self, at: At<'_>, event: u8) -> Part {
        let t = self.language;
        let older = at.before().take_while(|kind| matches!(kind, FieldKind::Event(_))).count();
        let name = if older == 0 { t.newest_event().to_owned() } else { t.event(older + 1) };
        let what = names::event_name(t, event);
        let flags = (0..6).filter(|position| event >> position & 1 == 1);
        let mut told: Vec<&str> = vec![what];
        told.extend(flags.map(|position| names::event_bit_name(t, event, position)).filter(|name| !name.is_empty()));
        if event & 0xC0 == 0xC0 {
            told.push(t.event_bit_broadcast());
        }
        let mut part = at.part("data", &name, &hex(event), &told.join(t.list_comma()), what);
        part.bits = Some(labelled(event.into(), 8, &|position| names::event_bit_name(t, event, position).to_owned()));
        part
    }

    /// The bytes of a field: of characters in ASCII mode what they spell.
    fn content(self, at: At<'_>) -> Vec<u8> {
        let Some(field) = at.found.fields.get(at.index) else { return Vec::new() };
        self.spelled(at.found.mode, field.range.clone())
    }
}

/// File and record of a register of functions 14 and 15.
fn record_of(at: At<'_>) -> Option<(u16, u16)> {
    let (mut before, mut passed) = (at.before(), 0_u16);
    let first = loop {
        match before.next()? {
            FieldKind::Register { .. } => passed = passed.checked_add(1)?,
            other => break other,
        }
    };
    let (file, record) = match first {
        FieldKind::RecordLength(_) => match (before.next()?, before.next()?) {
            (FieldKind::RecordNumber(record), FieldKind::FileNumber(file)) => (file, record),
            _ => return None,
        },
        FieldKind::ReferenceType(_) => {
            // The request tells which record is the so-and-so-many-th of its reply.
            let number = before.filter(|kind| matches!(kind, FieldKind::RecordByteCount(_))).count().checked_sub(1)?;
            let Some(Request::ReadFileRecord { records }) = at.request else { return None };
            records.get(number).map(|range| (range.file_number, range.record_number))?
        }
        _ => return None,
    };
    Some((file, record.checked_add(passed)?))
}
