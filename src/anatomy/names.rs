//! The standard's names (application protocol V1.1b3, clause 6), and why bytes are none of its PDUs.

use buslens_codec::dissect::{Dissection, FieldKind};
use buslens_codec::pdu::{PduError, SubFunction};

use crate::format::hex;
use crate::text::Language;

/// The MEI type of read device identification (clause 6.21).
const MEI_DEVICE_ID: u8 = 0x0E;

/// What a function does, in the standard's words.
pub(crate) fn function_name(t: Language, function: u8) -> &'static str {
    match function {
        0x01 => t.function_1(),
        0x02 => t.function_2(),
        0x03 => t.function_3(),
        0x04 => t.function_4(),
        0x05 => t.function_5(),
        0x06 => t.function_6(),
        0x07 => t.function_7(),
        0x08 => t.function_8(),
        0x0B => t.function_11(),
        0x0C => t.function_12(),
        0x0F => t.function_15(),
        0x10 => t.function_16(),
        0x11 => t.function_17(),
        0x14 => t.function_20(),
        0x15 => t.function_21(),
        0x16 => t.function_22(),
        0x17 => t.function_23(),
        0x18 => t.function_24(),
        0x2B => t.function_43_14(),
        // Left to the makers: 65 to 72 and 100 to 110 (clause 5).
        0x41..=0x48 | 0x64..=0x6E => t.function_own(),
        _ => t.function_other(),
    }
}

/// The function of a frame, also by what function 2B carries.
pub(super) fn function_in(t: Language, found: &Dissection) -> &'static str {
    let carries = |kind| matches!(kind, FieldKind::MeiType(mei) if mei != MEI_DEVICE_ID);
    if found.fields.iter().any(|field| carries(field.kind)) {
        return t.function_43();
    }
    function_name(t, found.function)
}

/// What a diagnostic does (clause 6.8.1).
pub(super) fn sub_function_name(t: Language, code: SubFunction) -> &'static str {
    match code.0 {
        0 => t.sub_function_0(),
        1 => t.sub_function_1(),
        2 => t.sub_function_2(),
        3 => t.sub_function_3(),
        4 => t.sub_function_4(),
        10 => t.sub_function_10(),
        11 => t.sub_function_11(),
        12 => t.sub_function_12(),
        13 => t.sub_function_13(),
        14 => t.sub_function_14(),
        15 => t.sub_function_15(),
        16 => t.sub_function_16(),
        17 => t.sub_function_17(),
        18 => t.sub_function_18(),
        20 => t.sub_function_20(),
        _ => t.sub_function_other(),
    }
}

/// What an object of a device's identification is (clause 6.21).
pub(super) fn object_name(t: Language, id: u8) -> String {
    let name = match id {
        0 => t.object_0(),
        1 => t.object_1(),
        2 => t.object_2(),
        3 => t.object_3(),
        4 => t.object_4(),
        5 => t.object_5(),
        6 => t.object_6(),
        0x80.. => return t.object_private(id),
        _ => return t.object_reserved(id),
    };
    name.to_owned()
}

/// Which identification is asked for.
pub(super) fn device_id_name(t: Language, code: u8) -> &'static str {
    match code {
        1 => t.id_basic(),
        2 => t.id_regular(),
        3 => t.id_extended(),
        4 => t.id_specific(),
        _ => t.value_invalid(),
    }
}

/// `2 registers`.
pub(super) fn registers_text(t: Language, count: u16) -> String {
    if count == 1 { t.registers_one().to_owned() } else { t.registers_many(count) }
}

/// `2 bytes`.
pub(super) fn bytes_text(t: Language, count: u16) -> String {
    if count == 1 { t.bytes_one().to_owned() } else { t.bytes_many(count) }
}

/// What an entry of the event log tells (clause 6.10).
pub(super) fn event_name(t: Language, event: u8) -> &'static str {
    match event {
        0x00 => t.event_restart(),
        // 04 by the clause's text, 20 in its example.
        0x04 | 0x20 => t.event_listen_only(),
        0x80.. => t.event_received(),
        0x40.. => t.event_sent(),
        _ => t.event_unknown(),
    }
}

/// What a bit of an entry of the event log stands for, empty for none (clause 6.10).
pub(super) fn event_bit_name(t: Language, event: u8, position: u8) -> &'static str {
    match (event, position) {
        (0x80.., 7) => t.event_received(),
        (0x80.., 6) => t.event_bit_broadcast(),
        (0x40.., 5) => t.event_bit_listen_only(),
        (0x80.., 4) => t.event_bit_overrun(),
        (0x80.., 1) => t.event_bit_communication_error(),
        (0x80.., _) => "",
        (0x40.., 6) => t.event_sent(),
        (0x40.., 4) => t.event_bit_write_timeout(),
        (0x40.., 3) => t.event_bit_nak(),
        (0x40.., 2) => t.event_bit_busy(),
        (0x40.., 1) => t.event_bit_abort(),
        (0x40.., 0) => t.event_bit_read_exception(),
        _ => "",
    }
}

/// Why bytes are no PDU of their function.
pub(crate) fn fault_text(t: Language, fault: PduError) -> String {
    let text = match fault {
        PduError::Length { found, expected } => return t.fault_length(found, expected),
        PduError::Quantity { found, limit } => return t.fault_quantity(found, limit),
        PduError::Count { found, limit } => return t.fault_count(found, limit),
        PduError::ByteCount { found, expected } => return t.fault_byte_count(found.into(), expected),
        PduError::FifoByteCount { found, expected } => return t.fault_byte_count(found, expected),
        PduError::OddByteCount { found } => return t.fault_odd_byte_count(found),
        PduError::CoilValue { found } => {
            let [high, low] = found.to_be_bytes().map(hex);
            return t.fault_coil_value(&(high + &low));
        }
        PduError::ReferenceType { found } => return t.fault_reference_type(found),
        PduError::RecordNumber { found } => return t.fault_record_number(found),
        PduError::RecordLength { found } => return t.fault_record_length(found),
        PduError::ReplyTooLong { found } => return t.fault_reply_too_long(found),
        PduError::DeviceIdCode { found } => return t.fault_device_id_code(found),
        PduError::MoreFollows { found } => return t.fault_more_follows(found),
        PduError::Empty | PduError::TooLong => t.fault_too_long(),
        PduError::Padding { .. } => t.fault_padding(),
        PduError::FunctionCode { .. } => t.fault_function_code(),
        PduError::FileNumber => t.fault_file_number(),
        PduError::Mismatch => t.fault_mismatch(),
    };
    text.to_owned()
}

/// Whether a fault lies in this very field.
pub(super) fn is_blamed(fault: PduError, kind: FieldKind) -> bool {
    match (fault, kind) {
        (PduError::Quantity { found, .. }, FieldKind::Quantity(value) | FieldKind::WriteQuantity(value))
        | (PduError::Count { found, .. }, FieldKind::FifoCount(value))
        | (PduError::FifoByteCount { found, .. }, FieldKind::FifoByteCount(value))
        | (PduError::CoilValue { found }, FieldKind::Coil(value))
        | (PduError::RecordNumber { found }, FieldKind::RecordNumber(value))
        | (PduError::RecordLength { found }, FieldKind::RecordLength(value)) => found == value,
        (PduError::ByteCount { found, .. } | PduError::OddByteCount { found }, FieldKind::ByteCount(value))
        | (PduError::ReferenceType { found }, FieldKind::ReferenceType(value))
        | (PduError::DeviceIdCode { found }, FieldKind::DeviceIdCode(value))
        | (PduError::MoreFollows { found }, FieldKind::MoreFollows(value)) => found == value,
        (PduError::RecordLength { found }, FieldKind::RecordByteCount(value)) => found == u16::from(value),
        (PduError::Padding { found }, FieldKind::Bits { count, value, .. }) => found == value && count < 8,
        (PduError::FileNumber, FieldKind::FileNumber(0)) | (PduError::FunctionCode { .. }, FieldKind::Function(_)) => {
            true
        }
        _ => false,
    }
}
