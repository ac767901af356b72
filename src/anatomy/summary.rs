//! What a frame says, in a line of a list.

use buslens_codec::dissect::{Direction, Dissection, FieldKind};
use buslens_codec::pdu::SubFunction;

use super::points::place_name;
use super::{Words, address_text, legible, names, shortened};
use crate::format::{self, hex_spaced};

/// Most registers or other things that one line lists.
const MOST: usize = 8;

impl Words<'_> {
    /// Short: values where there are any, else what is asked, else why it is none.
    pub(super) fn meaning(self, found: &Dissection) -> String {
        let t = self.language;
        if let Some(code) = found.exception {
            return t.exception_is(code.code(), t.exception_name(code.code()));
        }
        if let Some(fault) = found.fault {
            return names::fault_text(t, fault);
        }
        let values = found.points.iter().filter_map(|named| {
            let point = self.profile?.point(&named.point)?;
            Some(self.sentence(point, named))
        });
        let values: Vec<String> = values.collect();
        if !values.is_empty() {
            return values.join(t.list_comma());
        }
        match found.function {
            0x01 | 0x02 if !found.bits.is_empty() => self.states(found.function, found.address, 0, &found.bits),
            0x01..=0x04 | 0x0F | 0x10 | 0x17 if found.registers.is_empty() && found.bits.is_empty() => {
                self.asked(found)
            }
            0x03 | 0x04 => hex_words(self, &found.registers),
            0x05 | 0x0F if found.bits.len() == 1 => self.named_place(found, self.state(found.bits == [true])),
            0x06 => self.named_place(found, &["= ", &first(&found.registers).to_string()].concat()),
            0x07 | 0x08 | 0x0B | 0x0C | 0x11 | 0x14 | 0x15 | 0x2B => self.of_fields(found),
            0x0F => {
                let states = self.states(found.function, found.address, 0, &found.bits);
                [&self.asked(found), t.colon(), &states].concat()
            }
            0x10 => [&self.asked(found), t.colon(), &hex_words(self, &found.registers)].concat(),
            0x16 => {
                let mask = |at: usize| address_text(found.registers.get(at).copied().unwrap_or_default());
                [&self.asked(found), t.colon(), &t.and_or(&mask(0), &mask(1))].concat()
            }
            0x17 if found.direction == Direction::Response => hex_words(self, &found.registers),
            0x17 => self.read_and_write(found),
            0x18 if found.direction == Direction::Response => {
                let count = t.queue_is(u16::try_from(found.registers.len()).unwrap_or(u16::MAX));
                if found.registers.is_empty() {
                    count
                } else {
                    [&count, t.colon(), &hex_words(self, &found.registers)].concat()
                }
            }
            0x18 => self.asked(found),
            _ => String::new(),
        }
    }

    /// `4 registers from 0x0002: Temperature, Displacement`.
    fn asked(self, found: &Dissection) -> String {
        let Some(address) = found.address else { return String::new() };
        let quantity = found.quantity.unwrap_or(1);
        let names = self.names_at(found.function, address, quantity);
        let places = self.places(found.function, address, quantity);
        if names.is_empty() { places } else { [&places, self.language.colon(), &names].concat() }
    }

    /// `coil 0x0050 on`.
    fn named_place(self, found: &Dissection, value: &str) -> String {
        let place = found.address.map(|address| place_name(self.language, found.function, address)).unwrap_or_default();
        [&place, " ", value].concat()
    }

    fn read_and_write(self, found: &Dissection) -> String {
        let written = found.fields.iter().find_map(|field| match field.kind {
            FieldKind::WriteAddress(address) => Some(address),
            _ => None,
        });
        let quantity = u16::try_from(found.registers.len()).unwrap_or(u16::MAX);
        let place = written.map(|address| self.places(found.function, address, quantity)).unwrap_or_default();
        [&self.asked(found), self.language.list_pause(), &self.language.writes_too(&place)].concat()
    }

    /// Functions that consist of fields: what the telling ones say.
    fn of_fields(self, found: &Dissection) -> String {
        let t = self.language;
        let is_reply = found.direction == Direction::Response;
        let mut words = Vec::new();
        let (mut sub_function, mut file, mut record) = (SubFunction::RETURN_QUERY_DATA, 0, 0);
        let (mut wants_object, mut object) = (false, 0);
        for field in &found.fields {
            let content = || self.spelled(found.mode, field.range.clone());
            let word = match field.kind {
                FieldKind::ExceptionStatus(value) => super::bits::set_bits(t, value),
                FieldKind::SubFunction(code) => {
                    sub_function = code;
                    names::sub_function_name(t, code).to_owned()
                }
                FieldKind::DiagnosticValue(0) if !is_reply => continue,
                FieldKind::DiagnosticValue(value) => self.diagnostic(sub_function, value, found.direction),
                FieldKind::Status(0xFFFF) => t.status_busy().to_owned(),
                FieldKind::EventCount(count) => t.events_are(count),
                FieldKind::MessageCount(count) => t.messages_are(count),
                FieldKind::ServerId => legible(&content()),
                FieldKind::RunIndicator(value) => run_text(self, value).to_owned(),
                FieldKind::FileNumber(number) => {
                    file = number;
                    continue;
                }
                FieldKind::RecordNumber(number) => {
                    record = number;
                    continue;
                }
                FieldKind::RecordLength(count) => {
                    [&t.record_at(file, record), t.colon(), &names::registers_text(t, count)].concat()
                }
                FieldKind::RecordByteCount(count) => names::registers_text(t, u16::from(count / 2)),
                FieldKind::DeviceIdCode(code) if !is_reply => {
                    wants_object = code == 4;
                    names::device_id_name(t, code).to_owned()
                }
                FieldKind::ObjectId(id) => {
                    object = id;
                    if !wants_object {
                        continue;
                    }
                    names::object_name(t, id)
                }
                FieldKind::ObjectValue => [&names::object_name(t, object), t.colon(), &legible(&content())].concat(),
                FieldKind::Data => hex_spaced(&content()),
                _ => continue,
            };
            words.push(word);
        }
        words.retain(|word| !word.is_empty());
        let between = if matches!(found.function, 0x14 | 0x15) { t.list_pause() } else { t.list_comma() };
        shortened(t, words, between, MOST)
    }
}

/// What a run indicator says.
pub(super) fn run_text(words: Words<'_>, value: u8) -> &'static str {
    match value {
        0xFF => words.language.run_on(),
        0 => words.language.run_off(),
        _ => words.language.value_invalid(),
    }
}

fn hex_words(words: Words<'_>, registers: &[u16]) -> String {
    let word = |register: &u16| {
        let mut text = String::new();
        format::push_hex(&mut text, &register.to_be_bytes());
        text
    };
    shortened(words.language, registers.iter().map(word).collect(), " ", MOST)
}

fn first(registers: &[u16]) -> u16 {
    registers.first().copied().unwrap_or_default()
}
