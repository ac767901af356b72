use alloc::vec::Vec;
use core::ops::Range;

use super::{Direction, Field, FieldKind};
use crate::UnitId;
use crate::pdu::{EXCEPTION, ExceptionCode, MEI_READ_DEVICE_ID, Request, SubFunction, unpack_bits};

const COIL_ON: u16 = 0xFF00;
const COIL_OFF: u16 = 0x0000;

/// The body's bytes in fields, and what they say.
#[derive(Default)]
pub(super) struct Layout {
    pub(super) fields: Vec<Field>,
    pub(super) exception: Option<ExceptionCode>,
    pub(super) address: Option<u16>,
    pub(super) quantity: Option<u16>,
    pub(super) bits: Vec<bool>,
    /// Registers, or the value of a coil as sent.
    pub(super) words: Vec<u16>,
    /// Where they begin in the body.
    pub(super) words_at: usize,
    /// The address of the first, where they are in a row and it is known.
    pub(super) words_from: Option<u16>,
}

/// Lays the body out: unit id and PDU, at least two bytes.
pub(super) fn lay_out(body: &[u8], direction: Direction, request: Option<&Request>) -> Layout {
    let mut walk = Walk { body, at: 0, layout: Layout::default() };
    walk.byte(|unit| FieldKind::Unit(UnitId(unit)));
    let function = walk.byte(FieldKind::Function).unwrap_or_default();
    if direction == Direction::Response {
        walk.layout.address = request.and_then(Request::address);
        walk.layout.quantity = request.and_then(Request::quantity);
    }
    if function & EXCEPTION != 0 {
        let code = walk.byte(|code| FieldKind::Exception(code.into()));
        walk.layout.exception = code.map(ExceptionCode::from);
    } else if direction == Direction::Response {
        walk.response(function);
    } else {
        walk.request(function);
    }
    walk.rest(FieldKind::Data);
    walk.layout
}

/// Goes through the body and never over its end.
struct Walk<'a> {
    body: &'a [u8],
    at: usize,
    layout: Layout,
}

impl Walk<'_> {
    fn request(&mut self, function: u8) {
        match function {
            0x01..=0x04 => self.address_and_quantity(),
            0x05 | 0x06 | 0x08 | 0x15 | 0x16 => self.echoed(function),
            0x0F => {
                self.address_and_quantity();
                self.byte(FieldKind::ByteCount);
                self.bits();
            }
            0x10 => {
                self.address_and_quantity();
                self.byte(FieldKind::ByteCount);
                self.registers(self.layout.address);
            }
            0x14 => {
                self.byte(FieldKind::ByteCount);
                while self.record_range().is_some() {}
            }
            0x17 => {
                self.address_and_quantity();
                let address = self.word(FieldKind::WriteAddress);
                self.word(FieldKind::WriteQuantity);
                self.byte(FieldKind::ByteCount);
                self.registers(address);
            }
            0x18 => self.layout.address = self.word(FieldKind::Address),
            0x2B if self.byte(FieldKind::MeiType) == Some(MEI_READ_DEVICE_ID) => {
                self.byte(FieldKind::DeviceIdCode);
                self.byte(FieldKind::ObjectId);
            }
            _ => {}
        }
    }

    fn response(&mut self, function: u8) {
        match function {
            0x01 | 0x02 => {
                self.byte(FieldKind::ByteCount);
                self.bits();
            }
            0x03 | 0x04 | 0x17 => {
                self.byte(FieldKind::ByteCount);
                self.registers(self.layout.address);
            }
            0x05 | 0x06 | 0x08 | 0x15 | 0x16 => self.echoed(function),
            0x07 => {
                self.byte(FieldKind::ExceptionStatus);
            }
            0x0B => {
                self.word(FieldKind::Status);
                self.word(FieldKind::EventCount);
            }
            0x0C => {
                self.byte(FieldKind::ByteCount);
                self.word(FieldKind::Status);
                self.word(FieldKind::EventCount);
                self.word(FieldKind::MessageCount);
                while self.byte(FieldKind::Event).is_some() {}
            }
            0x0F | 0x10 => self.address_and_quantity(),
            0x11 => {
                self.byte(FieldKind::ByteCount);
                self.server_id();
            }
            0x14 => {
                self.byte(FieldKind::ByteCount);
                while let Some(count) = self.byte(FieldKind::RecordByteCount) {
                    self.record_contents(usize::from(count));
                }
            }
            0x18 => {
                self.word(FieldKind::FifoByteCount);
                self.word(FieldKind::FifoCount);
                self.registers(None);
            }
            0x2B if self.byte(FieldKind::MeiType) == Some(MEI_READ_DEVICE_ID) => self.device_id(),
            _ => {}
        }
    }

    /// What looks the same in both directions.
    fn echoed(&mut self, function: u8) {
        match function {
            0x05 => {
                let address = self.word(FieldKind::Address);
                self.layout.address = address;
                self.start_words(address);
                if let Some(value @ (COIL_ON | COIL_OFF)) = self.value(FieldKind::Coil) {
                    self.layout.bits.push(value == COIL_ON);
                }
            }
            0x06 => {
                let address = self.word(FieldKind::Address);
                self.layout.address = address;
                self.start_words(address);
                self.value(|value| FieldKind::Register { address, value });
            }
            0x08 => {
                let sub_function = self.word(|code| FieldKind::SubFunction(SubFunction(code))).map(SubFunction);
                if sub_function.is_some_and(|code| code.is_known() && code != SubFunction::RETURN_QUERY_DATA) {
                    self.word(FieldKind::DiagnosticValue);
                }
            }
            0x15 => {
                self.byte(FieldKind::ByteCount);
                while let Some(length) = self.record_range() {
                    for _ in 0..length {
                        if self.word(|value| FieldKind::Register { address: None, value }).is_none() {
                            break;
                        }
                    }
                }
            }
            _ => {
                self.layout.address = self.word(FieldKind::Address);
                self.start_words(None);
                self.value(FieldKind::AndMask);
                self.value(FieldKind::OrMask);
            }
        }
    }

    fn address_and_quantity(&mut self) {
        self.layout.address = self.word(FieldKind::Address);
        self.layout.quantity = self.word(FieldKind::Quantity);
    }

    fn start_words(&mut self, address: Option<u16>) {
        self.layout.words_at = self.at;
        self.layout.words_from = address;
    }

    /// Registers to the end.
    fn registers(&mut self, address: Option<u16>) {
        self.start_words(address);
        let mut address = address;
        while self.value(|value| FieldKind::Register { address, value }).is_some() {
            address = address.and_then(|address| address.checked_add(1));
        }
    }

    /// Coils or inputs to the end; those beyond the quantity, where it is known, fill up.
    fn bits(&mut self) {
        let bytes = self.body.get(self.at..).unwrap_or_default();
        let mut left = self.layout.quantity.map_or(usize::MAX, usize::from);
        self.layout.bits = unpack_bits(bytes, left);
        let mut address = self.layout.address;
        loop {
            let count = left.min(8);
            let bits = |value| FieldKind::Bits { address, count: u8::try_from(count).unwrap_or(8), value };
            if self.byte(bits).is_none() {
                return;
            }
            left -= count;
            address = address.and_then(|address| address.checked_add(8));
        }
    }

    /// The run indicator is FF or 00 and follows at least one byte of the id. Only if there is one such byte, the data show
    /// where the id ends.
    fn server_id(&mut self) {
        let data = self.body.get(self.at..).unwrap_or_default();
        let mut candidates = data.iter().enumerate().skip(1).filter(|(_, byte)| matches!(byte, 0x00 | 0xFF));
        match (candidates.next(), candidates.next()) {
            (Some((len, _)), None) => {
                self.bytes(len, FieldKind::ServerId);
                self.byte(FieldKind::RunIndicator);
            }
            _ => self.rest(FieldKind::ServerId),
        }
    }

    /// A range of functions 14 and 15; the record length if all of it is there.
    fn record_range(&mut self) -> Option<u16> {
        self.byte(FieldKind::ReferenceType)?;
        self.word(FieldKind::FileNumber)?;
        self.word(FieldKind::RecordNumber)?;
        self.word(FieldKind::RecordLength)
    }

    /// Reference type and registers, `count` bytes in all or as many as there are.
    fn record_contents(&mut self, count: usize) {
        let end = self.at.saturating_add(count).min(self.body.len());
        if self.at < end {
            self.byte(FieldKind::ReferenceType);
        }
        while end - self.at >= 2 {
            self.word(|value| FieldKind::Register { address: None, value });
        }
        self.bytes(end - self.at, FieldKind::Data);
    }

    fn device_id(&mut self) {
        self.byte(FieldKind::DeviceIdCode);
        self.byte(FieldKind::Conformity);
        self.byte(FieldKind::MoreFollows);
        self.byte(FieldKind::NextObject);
        self.byte(FieldKind::ObjectCount);
        while self.byte(FieldKind::ObjectId).is_some() {
            let length = self.byte(FieldKind::ObjectLength).unwrap_or_default();
            self.bytes(usize::from(length), FieldKind::ObjectValue);
        }
    }

    fn byte(&mut self, kind: impl Fn(u8) -> FieldKind) -> Option<u8> {
        let value = *self.body.get(self.at)?;
        self.push(self.at..self.at + 1, kind(value));
        Some(value)
    }

    fn word(&mut self, kind: impl Fn(u16) -> FieldKind) -> Option<u16> {
        let bytes = self.body.get(self.at..)?.first_chunk()?;
        let value = u16::from_be_bytes(*bytes);
        self.push(self.at..self.at + 2, kind(value));
        Some(value)
    }

    /// A word that is data.
    fn value(&mut self, kind: impl Fn(u16) -> FieldKind) -> Option<u16> {
        let value = self.word(kind)?;
        self.layout.words.push(value);
        Some(value)
    }

    /// So many bytes or as many as there are.
    fn bytes(&mut self, count: usize, kind: FieldKind) {
        let end = self.at.saturating_add(count).min(self.body.len());
        if self.at < end {
            self.push(self.at..end, kind);
        }
    }

    fn rest(&mut self, kind: FieldKind) {
        self.bytes(self.body.len(), kind);
    }

    fn push(&mut self, range: Range<usize>, kind: FieldKind) {
        self.at = range.end;
        self.layout.fields.push(Field { range, kind });
    }
}
