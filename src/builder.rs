//! The model of the Frame builder: what stands in its fields becomes a message, or says field by field why it does not.
//!
//! A field is a text that somebody types, so nothing of it is ever lost. Which fields a message has follows from reading
//! them: there is no second list of them. A field that makes no sense counts as the least that it could be, so that the
//! others are judged all the same.

pub(crate) mod parse;
pub(crate) mod point;
pub(crate) mod spell;

use buslens_codec::intake::IntakeError;
use buslens_codec::pdu::{
    DeviceIdCode, DeviceIdObject, FileRecord, FileRecordRange, MAX_READ_BITS, MAX_READ_QUANTITY, MAX_WRITE_COILS,
    MAX_WRITE_QUANTITY, PduError, Request, Response, SubFunction, pack_bits,
};

/// The function codes that have a form of their own; any other is typed and goes with raw data.
pub(crate) const FUNCTIONS: [u8; 19] =
    [0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x08, 0x0B, 0x0C, 0x0F, 0x10, 0x11, 0x14, 0x15, 0x16, 0x17, 0x18, 0x2B];

/// What is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// What a master sends.
    Request,
    /// What a device answers.
    Response,
    /// How a device refuses.
    Exception,
}

/// A field of the form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    /// Unit id.
    Unit,
    /// A function code without a form of its own.
    Code,
    /// Why a device refuses.
    Exception,
    /// Which diagnostic.
    SubFunction,
    /// First register, coil or input.
    Address,
    /// How many of them.
    Quantity,
    /// `on` or `off`.
    Coil,
    /// One register.
    Value,
    /// First register that function 17 writes.
    WriteAddress,
    /// Registers.
    Values,
    /// Coils or inputs, each 0 or 1.
    Bits,
    /// Eight bits of function 07.
    Status,
    /// Bytes as hexadecimal digits.
    Data,
    /// Bits that stay.
    AndMask,
    /// Values of the bits that do not.
    OrMask,
    /// A range of a file in each line: file, record, registers.
    Ranges,
    /// A record of a file in each line: file, record, values.
    Records,
    /// The values of a record in each line.
    Contents,
    /// Which identification.
    IdCode,
    /// First or only object.
    Object,
    /// What the device knows of its identification.
    Conformity,
    /// 255 if more objects follow, else 0.
    More,
    /// An object in each line: number, text.
    Objects,
    /// Status word of functions 0B and 0C.
    Busy,
    /// Events counted.
    EventCount,
    /// Messages counted.
    MessageCount,
}

impl Slot {
    /// All of them, each at the place that its number tells.
    pub(crate) const ALL: [Self; 26] = [
        Self::Unit,
        Self::Code,
        Self::Exception,
        Self::SubFunction,
        Self::Address,
        Self::Quantity,
        Self::Coil,
        Self::Value,
        Self::WriteAddress,
        Self::Values,
        Self::Bits,
        Self::Status,
        Self::Data,
        Self::AndMask,
        Self::OrMask,
        Self::Ranges,
        Self::Records,
        Self::Contents,
        Self::IdCode,
        Self::Object,
        Self::Conformity,
        Self::More,
        Self::Objects,
        Self::Busy,
        Self::EventCount,
        Self::MessageCount,
    ];

    /// Its place in [`Self::ALL`].
    pub(crate) const fn index(self) -> usize {
        self as usize
    }

    /// Its stable name: for the store, the tests and the label.
    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::Unit => "builder-unit",
            Self::Code => "builder-code",
            Self::Exception => "builder-exception",
            Self::SubFunction => "builder-sub-function",
            Self::Address => "builder-address",
            Self::Quantity => "builder-quantity",
            Self::Coil => "builder-coil",
            Self::Value => "builder-value",
            Self::WriteAddress => "builder-write-address",
            Self::Values => "builder-values",
            Self::Bits => "builder-bits",
            Self::Status => "builder-status",
            Self::Data => "builder-data",
            Self::AndMask => "builder-and-mask",
            Self::OrMask => "builder-or-mask",
            Self::Ranges => "builder-ranges",
            Self::Records => "builder-records",
            Self::Contents => "builder-contents",
            Self::IdCode => "builder-id-code",
            Self::Object => "builder-object",
            Self::Conformity => "builder-conformity",
            Self::More => "builder-more",
            Self::Objects => "builder-objects",
            Self::Busy => "builder-busy",
            Self::EventCount => "builder-event-count",
            Self::MessageCount => "builder-message-count",
        }
    }

    /// What stands in it at first.
    pub(crate) const fn default(self) -> &'static str {
        match self {
            Self::Unit | Self::Quantity | Self::IdCode | Self::Conformity => "1",
            Self::Code => "0x41",
            Self::Exception => "2",
            Self::Coil => "on",
            Self::Bits => "1 0 1",
            Self::Data => "00 00",
            Self::AndMask => "0xFFFF",
            Self::Ranges => "1 0 2",
            Self::Records => "1 0 0 0",
            Self::Objects => "0 Maker\n1 Product\n2 1.0",
            _ => "0",
        }
    }

    /// Whether it holds more than one line takes.
    pub(crate) const fn is_long(self) -> bool {
        matches!(
            self,
            Self::Values | Self::Bits | Self::Data | Self::Ranges | Self::Records | Self::Contents | Self::Objects
        )
    }
}

/// Why a field makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// It must be a whole number from `first` to `last`.
    Number {
        /// The least.
        first: i32,
        /// The most.
        last: i32,
    },
    /// The same of an entry of a list.
    Item {
        /// Which one, counted from 1.
        at: usize,
        /// The least.
        first: i32,
        /// The most.
        last: i32,
    },
    /// There must be `first` to `last` entries.
    Count {
        /// The fewest.
        first: u16,
        /// The most.
        last: u16,
    },
    /// Something other than 0 and 1.
    Bit,
    /// Bytes that cannot be read.
    Hex(IntakeError),
    /// A line that does not have what it needs.
    Line(usize),
    /// A file, a record or a length that the standard does not have.
    Record,
    /// More than one frame holds, here or in the reply that is asked for.
    TooLong,
}

/// A field as it was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    /// Which one.
    pub(crate) slot: Slot,
    /// Its bytes as they go over the line, without counts; or why there are none.
    pub(crate) bytes: Result<Vec<u8>, Fault>,
}

/// What is sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Message {
    /// By a master.
    Request(Request),
    /// By a device.
    Response(Response),
}

/// What the fields make.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Draft {
    /// All fields of this message in the order of the line, the unit id first.
    pub(crate) fields: Vec<Field>,
    /// The unit id; 0 while it is at fault.
    pub(crate) unit: u8,
    /// The function code, with an exception's top bit.
    pub(crate) function: u8,
    /// The message and its PDU, if no field is at fault.
    pub(crate) whole: Option<(Message, Vec<u8>)>,
}

impl Draft {
    /// Reads the fields of a message. `function` is one of [`FUNCTIONS`], or `None` for a typed one.
    pub(crate) fn of(way: Way, function: Option<u8>, text: &dyn Fn(Slot) -> String) -> Self {
        let mut reader = Reader { text, fields: Vec::new() };
        let unit = reader.byte(Slot::Unit);
        let message = match way {
            Way::Request => Message::Request(reader.request(function)),
            Way::Response => Message::Response(reader.response(function)),
            Way::Exception => Message::Response(Response::Exception {
                function: function.unwrap_or_else(|| reader.code(0x7F)),
                code: reader.byte(Slot::Exception).into(),
            }),
        };
        let mut fields = reader.fields;
        let (function, encoded) = match &message {
            Message::Request(request) => (request.function(), request.encode()),
            Message::Response(response @ Response::Exception { function, .. }) => (function | 0x80, response.encode()),
            Message::Response(response) => (response.function(), response.encode()),
        };
        let pdu = match encoded {
            Ok(pdu) => Some(pdu),
            Err(error) => {
                // What the standard limits beyond a single number stands last in every message.
                if let Some(field) = fields.last_mut().filter(|field| field.bytes.is_ok()) {
                    field.bytes = Err(fault_of(error));
                }
                None
            }
        };
        let right = fields.iter().all(|field| field.bytes.is_ok());
        Self { unit, function, whole: pdu.filter(|_| right).map(|pdu| (message, pdu)), fields }
    }

    /// What is wrong with a field.
    pub(crate) fn fault(&self, slot: Slot) -> Option<Fault> {
        self.field(slot)?.bytes.as_ref().err().copied()
    }

    /// The number in a field of one or two bytes.
    pub(crate) fn number(&self, slot: Slot) -> Option<u16> {
        match *self.bytes(slot)? {
            [byte] => Some(byte.into()),
            [high, low] => Some(u16::from_be_bytes([high, low])),
            _ => None,
        }
    }

    /// The bytes of a field that is right.
    pub(crate) fn bytes(&self, slot: Slot) -> Option<&[u8]> {
        self.field(slot)?.bytes.as_deref().ok()
    }

    fn field(&self, slot: Slot) -> Option<&Field> {
        self.fields.iter().find(|field| field.slot == slot)
    }
}

/// The codec's limits of lists, as a fault of the list.
fn fault_of(error: PduError) -> Fault {
    match error {
        PduError::Quantity { limit, .. } => Fault::Count { first: 1, last: limit },
        PduError::Count { limit, .. } => Fault::Count { first: 0, last: limit },
        // The two bytes of a diagnostic.
        PduError::Length { .. } => Fault::Count { first: 2, last: 2 },
        PduError::FileNumber | PduError::RecordNumber { .. } | PduError::RecordLength { .. } => Fault::Record,
        _ => Fault::TooLong,
    }
}

/// Reads fields and notes what it has read.
struct Reader<'a> {
    text: &'a dyn Fn(Slot) -> String,
    fields: Vec<Field>,
}

impl Reader<'_> {
    fn request(&mut self, function: Option<u8>) -> Request {
        match function {
            Some(0x01) => {
                Request::ReadCoils { address: self.word(Slot::Address), quantity: self.quantity(MAX_READ_BITS) }
            }
            Some(0x02) => Request::ReadDiscreteInputs {
                address: self.word(Slot::Address),
                quantity: self.quantity(MAX_READ_BITS),
            },
            Some(0x03) => Request::ReadHoldingRegisters {
                address: self.word(Slot::Address),
                quantity: self.quantity(MAX_READ_QUANTITY),
            },
            Some(0x04) => Request::ReadInputRegisters {
                address: self.word(Slot::Address),
                quantity: self.quantity(MAX_READ_QUANTITY),
            },
            Some(0x05) => Request::WriteSingleCoil { address: self.word(Slot::Address), on: self.coil() },
            Some(0x06) => {
                Request::WriteSingleRegister { address: self.word(Slot::Address), value: self.word(Slot::Value) }
            }
            Some(0x07) => Request::ReadExceptionStatus,
            Some(0x08) => Request::Diagnostics {
                sub_function: SubFunction(self.word(Slot::SubFunction)),
                data: self.bytes(Slot::Data),
            },
            Some(0x0B) => Request::GetCommEventCounter,
            Some(0x0C) => Request::GetCommEventLog,
            Some(0x0F) => Request::WriteMultipleCoils { address: self.word(Slot::Address), coils: self.bits() },
            Some(0x10) => {
                Request::WriteMultipleRegisters { address: self.word(Slot::Address), values: self.words(Slot::Values) }
            }
            Some(0x11) => Request::ReportServerId,
            Some(0x14) => Request::ReadFileRecord { records: self.ranges() },
            Some(0x15) => Request::WriteFileRecord { records: self.records() },
            Some(0x16) => Request::MaskWriteRegister {
                address: self.word(Slot::Address),
                and_mask: self.word(Slot::AndMask),
                or_mask: self.word(Slot::OrMask),
            },
            Some(0x17) => Request::ReadWriteMultipleRegisters {
                read_address: self.word(Slot::Address),
                read_quantity: self.quantity(MAX_READ_QUANTITY),
                write_address: self.word(Slot::WriteAddress),
                values: self.words(Slot::Values),
            },
            Some(0x18) => Request::ReadFifoQueue { address: self.word(Slot::Address) },
            Some(0x2B) => Request::ReadDeviceIdentification { code: self.id_code(), object: self.byte(Slot::Object) },
            _ => Request::Other { function: self.code(0xFF), data: self.bytes(Slot::Data) },
        }
    }

    fn response(&mut self, function: Option<u8>) -> Response {
        match function {
            Some(0x01) => Response::ReadCoils { status: pack_bits(&self.bits()) },
            Some(0x02) => Response::ReadDiscreteInputs { status: pack_bits(&self.bits()) },
            Some(0x03) => Response::ReadHoldingRegisters { values: self.words(Slot::Values) },
            Some(0x04) => Response::ReadInputRegisters { values: self.words(Slot::Values) },
            Some(0x05) => Response::WriteSingleCoil { address: self.word(Slot::Address), on: self.coil() },
            Some(0x06) => {
                Response::WriteSingleRegister { address: self.word(Slot::Address), value: self.word(Slot::Value) }
            }
            Some(0x07) => Response::ReadExceptionStatus { status: self.byte(Slot::Status) },
            Some(0x08) => Response::Diagnostics {
                sub_function: SubFunction(self.word(Slot::SubFunction)),
                data: self.bytes(Slot::Data),
            },
            Some(0x0B) => Response::GetCommEventCounter {
                status: self.word(Slot::Busy),
                event_count: self.word(Slot::EventCount),
            },
            Some(0x0C) => Response::GetCommEventLog {
                status: self.word(Slot::Busy),
                event_count: self.word(Slot::EventCount),
                message_count: self.word(Slot::MessageCount),
                events: self.bytes(Slot::Data),
            },
            Some(0x0F) => Response::WriteMultipleCoils {
                address: self.word(Slot::Address),
                quantity: self.quantity(MAX_WRITE_COILS),
            },
            Some(0x10) => Response::WriteMultipleRegisters {
                address: self.word(Slot::Address),
                quantity: self.quantity(MAX_WRITE_QUANTITY),
            },
            Some(0x11) => Response::ReportServerId { data: self.bytes(Slot::Data) },
            Some(0x14) => Response::ReadFileRecord { records: self.lines(Slot::Contents, 1) },
            Some(0x15) => Response::WriteFileRecord { records: self.records() },
            Some(0x16) => Response::MaskWriteRegister {
                address: self.word(Slot::Address),
                and_mask: self.word(Slot::AndMask),
                or_mask: self.word(Slot::OrMask),
            },
            Some(0x17) => Response::ReadWriteMultipleRegisters { values: self.words(Slot::Values) },
            Some(0x18) => Response::ReadFifoQueue { values: self.words(Slot::Values) },
            Some(0x2B) => Response::ReadDeviceIdentification {
                code: self.id_code(),
                conformity: self.byte(Slot::Conformity),
                more_follows: self.byte(Slot::More) != 0,
                next_object: self.byte(Slot::Object),
                objects: self.objects(),
            },
            _ => Response::Other { function: self.code(0x7F), data: self.bytes(Slot::Data) },
        }
    }

    fn text(&self, slot: Slot) -> String {
        (self.text)(slot)
    }

    fn note(&mut self, slot: Slot, bytes: Result<Vec<u8>, Fault>) {
        self.fields.push(Field { slot, bytes });
    }

    /// A whole number of these limits. Negative ones become two's complements.
    fn number(&mut self, slot: Slot, first: i32, last: i32) -> u16 {
        let number = parse::number(&self.text(slot)).filter(|number| (first..=last).contains(number));
        let word = parse::word(number.unwrap_or(first.max(0)));
        let bytes =
            if last > 0xFF || slot == Slot::Quantity { word.to_be_bytes().to_vec() } else { vec![parse::low(word)] };
        self.note(slot, if number.is_some() { Ok(bytes) } else { Err(Fault::Number { first, last }) });
        word
    }

    fn byte(&mut self, slot: Slot) -> u8 {
        parse::low(self.number(slot, 0, 0xFF))
    }

    fn word(&mut self, slot: Slot) -> u16 {
        self.number(slot, if slot == Slot::Value { parse::FIRST } else { 0 }, parse::LAST)
    }

    fn code(&mut self, last: i32) -> u8 {
        parse::low(self.number(Slot::Code, 0, last))
    }

    fn quantity(&mut self, limit: u16) -> u16 {
        self.number(Slot::Quantity, 1, limit.into())
    }

    fn id_code(&mut self) -> DeviceIdCode {
        DeviceIdCode::try_from(parse::low(self.number(Slot::IdCode, 1, 4))).unwrap_or(DeviceIdCode::Basic)
    }

    fn coil(&mut self) -> bool {
        let on = self.text(Slot::Coil) != "off";
        self.note(Slot::Coil, Ok(vec![if on { 0xFF } else { 0 }, 0]));
        on
    }

    fn words(&mut self, slot: Slot) -> Vec<u16> {
        let words = parse::words(&self.text(slot));
        self.note(slot, words.as_ref().map(|words| word_bytes(words)).map_err(|fault| *fault));
        words.unwrap_or_else(|_| vec![0])
    }

    fn bits(&mut self) -> Vec<bool> {
        let bits = parse::bits(&self.text(Slot::Bits));
        self.note(Slot::Bits, bits.as_ref().map(|bits| pack_bits(bits)).map_err(|fault| *fault));
        bits.unwrap_or_else(|_| vec![false])
    }

    fn bytes(&mut self, slot: Slot) -> Vec<u8> {
        let bytes = parse::bytes(&self.text(slot));
        self.note(slot, bytes.clone());
        bytes.unwrap_or_else(|_| vec![0, 0])
    }

    /// Numbers line by line, in each line at least so many.
    fn lines(&mut self, slot: Slot, least: usize) -> Vec<Vec<u16>> {
        let lines = parse::lines(&self.text(slot), least);
        self.note(slot, lines.as_ref().map(|lines| word_bytes(&lines.concat())).map_err(|fault| *fault));
        lines.unwrap_or_else(|_| vec![vec![1; least]])
    }

    fn ranges(&mut self) -> Vec<FileRecordRange> {
        let range = |line: Vec<u16>| match *line.as_slice() {
            [file_number, record_number, record_length] => {
                Some(FileRecordRange { file_number, record_number, record_length })
            }
            _ => None,
        };
        let lines = self.lines(Slot::Ranges, 3);
        let count = lines.len();
        let ranges: Vec<_> = lines.into_iter().map_while(range).collect();
        if ranges.len() < count {
            self.fault_last(Fault::Line(ranges.len() + 1));
        }
        ranges
    }

    fn records(&mut self) -> Vec<FileRecord> {
        let record = |line: Vec<u16>| match line.as_slice() {
            [file, record, values @ ..] => {
                Some(FileRecord { file_number: *file, record_number: *record, values: values.to_vec() })
            }
            _ => None,
        };
        self.lines(Slot::Records, 3).into_iter().filter_map(record).collect()
    }

    fn objects(&mut self) -> Vec<DeviceIdObject> {
        let objects = parse::objects(&self.text(Slot::Objects));
        let bytes = |objects: &Vec<DeviceIdObject>| objects.iter().flat_map(|object| object.value.clone()).collect();
        self.note(Slot::Objects, objects.as_ref().map(bytes).map_err(|fault| *fault));
        objects.unwrap_or_default()
    }

    fn fault_last(&mut self, fault: Fault) {
        if let Some(field) = self.fields.last_mut() {
            field.bytes = Err(fault);
        }
    }
}

fn word_bytes(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_be_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use buslens_codec::pdu::ExceptionCode;

    use super::*;

    /// The draft of a message whose fields hold these texts, the others what they hold at first.
    fn draft(way: Way, function: Option<u8>, texts: &[(Slot, &str)]) -> Draft {
        Draft::of(way, function, &|slot| {
            let text = texts.iter().find(|(found, _)| *found == slot);
            text.map_or(slot.default(), |(_, text)| text).to_owned()
        })
    }

    fn slots(draft: &Draft) -> Vec<Slot> {
        draft.fields.iter().map(|field| field.slot).collect()
    }

    #[test]
    fn every_field_has_its_place_and_a_name_of_its_own() {
        for (at, slot) in Slot::ALL.into_iter().enumerate() {
            assert_eq!(slot.index(), at);
            assert_eq!(Slot::ALL.iter().filter(|other| other.key() == slot.key()).count(), 1);
        }
    }

    #[test]
    fn every_form_begins_whole_and_survives_its_trip() {
        for function in FUNCTIONS.map(Some).into_iter().chain([None]) {
            for way in [Way::Request, Way::Response, Way::Exception] {
                let draft = draft(way, function, &[]);
                let (message, pdu) = draft.whole.unwrap_or_else(|| panic!("{function:?} {way:?}"));
                assert_eq!(pdu[0], draft.function);
                match message {
                    Message::Request(request) => assert_eq!(Request::decode(&pdu), Ok(request)),
                    Message::Response(response) => assert_eq!(Response::decode(&pdu), Ok(response)),
                }
            }
        }
    }

    #[test]
    fn a_quantity_beyond_the_standard_is_told_with_its_limits() {
        let limit = |function, quantity, last| {
            let draft = draft(Way::Request, Some(function), &[(Slot::Quantity, quantity)]);
            assert_eq!(draft.fault(Slot::Quantity), Some(Fault::Number { first: 1, last }), "{function} {quantity}");
            assert_eq!(draft.whole, None);
        };
        limit(0x03, "126", 125);
        limit(0x04, "0", 125);
        limit(0x01, "2001", 2000);
        limit(0x17, "", 125);
        assert!(draft(Way::Request, Some(0x03), &[(Slot::Quantity, "0x7D")]).whole.is_some());
        let response = draft(Way::Response, Some(0x10), &[(Slot::Quantity, "124")]);
        assert_eq!(response.fault(Slot::Quantity), Some(Fault::Number { first: 1, last: 123 }));
    }

    #[test]
    fn lists_have_the_limits_of_their_function() {
        let many = |count: usize| vec!["7"; count].join(" ");
        let fault = |way, function, slot, text: &str| draft(way, Some(function), &[(slot, text)]).fault(slot);
        let request = |function, text: &str| fault(Way::Request, function, Slot::Values, text);
        assert_eq!(request(0x10, &many(123)), None);
        assert_eq!(request(0x10, &many(124)), Some(Fault::Count { first: 1, last: 123 }));
        assert_eq!(request(0x10, ""), Some(Fault::Count { first: 1, last: 123 }));
        assert_eq!(request(0x17, &many(122)), Some(Fault::Count { first: 1, last: 121 }));
        assert_eq!(fault(Way::Response, 0x18, Slot::Values, &many(32)), Some(Fault::Count { first: 0, last: 31 }));
        let bits = "1".repeat(1969);
        assert_eq!(fault(Way::Request, 0x0F, Slot::Bits, &bits), Some(Fault::Count { first: 1, last: 1968 }));
        assert_eq!(fault(Way::Request, 0x08, Slot::Data, "00"), None);
        let restart = draft(Way::Request, Some(0x08), &[(Slot::SubFunction, "1"), (Slot::Data, "00")]);
        assert_eq!(restart.fault(Slot::Data), Some(Fault::Count { first: 2, last: 2 }));
        assert_eq!(fault(Way::Request, 0x14, Slot::Ranges, "0 0 1"), Some(Fault::Record));
        assert_eq!(fault(Way::Request, 0x14, Slot::Ranges, "1 0 1 9"), Some(Fault::Line(1)));
        assert_eq!(fault(Way::Request, 0x14, Slot::Ranges, "1 0 200"), Some(Fault::TooLong));
        let raw = draft(Way::Request, None, &[(Slot::Data, &"00".repeat(253))]);
        assert_eq!(raw.fault(Slot::Data), Some(Fault::TooLong));
    }

    #[test]
    fn a_field_at_fault_leaves_the_others_their_bytes_and_their_faults() {
        let texts = [(Slot::Unit, "256"), (Slot::Address, "0x32"), (Slot::Quantity, "126")];
        let draft = draft(Way::Request, Some(0x03), &texts);
        assert_eq!(slots(&draft), [Slot::Unit, Slot::Address, Slot::Quantity]);
        assert_eq!(draft.fault(Slot::Unit), Some(Fault::Number { first: 0, last: 255 }));
        assert_eq!(draft.fields[1].bytes, Ok(vec![0, 0x32]));
        assert_eq!(draft.number(Slot::Address), Some(0x32));
        assert_eq!(draft.fault(Slot::Quantity), Some(Fault::Number { first: 1, last: 125 }));
    }

    #[test]
    fn the_fields_stand_in_the_order_of_the_line() {
        for function in FUNCTIONS {
            for way in [Way::Request, Way::Response] {
                let draft = draft(way, Some(function), &[]);
                let Some((_, pdu)) = draft.whole else { continue };
                let mut rest = &pdu[1..];
                for field in &draft.fields[1..] {
                    let bytes = field.bytes.clone().unwrap();
                    // Between them stand counts and marks that nobody types; lists of records have them inside.
                    if !matches!(field.slot, Slot::Ranges | Slot::Records | Slot::Contents | Slot::Objects) {
                        let at = rest.windows(bytes.len()).position(|found| found == bytes);
                        rest = &rest[at.unwrap_or_else(|| panic!("{function:02X} {way:?} {field:?}")) + bytes.len()..];
                    }
                }
            }
        }
    }

    #[test]
    fn negative_values_are_twos_complements_and_addresses_are_not() {
        let texts = [(Slot::Value, "-2"), (Slot::Address, "-1")];
        let draft = draft(Way::Request, Some(0x06), &texts);
        assert_eq!(draft.number(Slot::Value), Some(0xFFFE));
        assert_eq!(draft.fault(Slot::Address), Some(Fault::Number { first: 0, last: 0xFFFF }));
    }

    #[test]
    fn a_device_refuses_with_any_code() {
        let draft = draft(Way::Exception, Some(0x04), &[(Slot::Unit, "0x0C"), (Slot::Exception, "2")]);
        let exception = Response::Exception { function: 4, code: ExceptionCode::IllegalDataAddress };
        assert_eq!((draft.unit, draft.function), (12, 0x84));
        assert_eq!(draft.whole, Some((Message::Response(exception), vec![0x84, 2])));
    }

    #[test]
    fn a_response_has_no_function_code_with_the_exceptions_bit() {
        let fault = |way| draft(way, None, &[(Slot::Code, "0x83")]).fault(Slot::Code);
        assert_eq!(fault(Way::Request), None);
        assert_eq!(fault(Way::Response), Some(Fault::Number { first: 0, last: 127 }));
        assert_eq!(fault(Way::Exception), Some(Fault::Number { first: 0, last: 127 }));
    }
}
