use super::Direction;
use crate::pdu::{PduError, Request, Response};

/// What is wrong with a PDU: by itself, or as the answer to its request.
pub(super) fn fault_of(pdu: &[u8], direction: Direction, request: Option<&Request>) -> Option<PduError> {
    if direction != Direction::Response {
        return Request::decode(pdu).err();
    }
    match Response::decode(pdu) {
        Err(error) => Some(error),
        Ok(response) => disagreement(pdu, &response, request?),
    }
}

fn disagreement(pdu: &[u8], response: &Response, request: &Request) -> Option<PduError> {
    if request.accepts(response) {
        return padding(response, request.quantity()?);
    }
    let counted = matches!(
        response,
        Response::ReadCoils { .. }
            | Response::ReadDiscreteInputs { .. }
            | Response::ReadHoldingRegisters { .. }
            | Response::ReadInputRegisters { .. }
            | Response::ReadWriteMultipleRegisters { .. }
            | Response::ReadFileRecord { .. }
    );
    match (pdu.get(1), request.response_pdu_len()) {
        (Some(&found), Some(len)) if counted && len != pdu.len() => {
            Some(PduError::ByteCount { found, expected: len.saturating_sub(2) })
        }
        _ => Some(PduError::Mismatch),
    }
}

/// Bits beyond the quantity must be zero (clauses 6.1 and 6.2).
fn padding(response: &Response, quantity: u16) -> Option<PduError> {
    let (Response::ReadCoils { status } | Response::ReadDiscreteInputs { status }) = response else { return None };
    let (found, used) = (*status.last()?, quantity % 8);
    (used != 0 && found >> used != 0).then_some(PduError::Padding { found })
}
