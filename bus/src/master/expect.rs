//! Finding a reply by what its request lets expect, wherever it stands among other bytes.

use std::ops::Range;

use buslens_codec::line::Mode;
use buslens_codec::pdu::{Request, Response};
use buslens_codec::{UnitId, ascii, rtu};

/// Unit id and check around an RTU PDU.
const RTU_OVERHEAD: usize = 3;
const EXCEPTION_ADU_LEN: usize = 2 + RTU_OVERHEAD;

/// A request as far as its reply goes.
#[derive(Clone, Copy)]
pub(super) struct Expected<'a> {
    pub(super) mode: Mode,
    pub(super) unit: UnitId,
    pub(super) request: &'a Request,
}

/// A reply among other bytes.
pub(super) struct Found {
    pub(super) range: Range<usize>,
    pub(super) response: Response,
}

impl Expected<'_> {
    /// The first whole reply with a right check. `silent` says that no more bytes are to come for now, which is the only
    /// end of a reply whose length the request does not tell.
    pub(super) fn find(&self, bytes: &[u8], silent: bool) -> Option<Found> {
        match self.mode {
            Mode::Rtu => (0..bytes.len()).find_map(|start| {
                let lengths = self.rtu_lengths(&bytes[start..], silent);
                lengths.into_iter().flatten().find_map(|len| {
                    let adu = rtu::decode(bytes.get(start..start + len)?).ok()?;
                    let response = self.response(adu.unit, adu.pdu)?;
                    Some(Found { range: start..start + len, response })
                })
            }),
            Mode::Ascii => ascii_lines(bytes).find_map(|range| {
                let adu = ascii::decode(&bytes[range.clone()]).ok()?;
                let response = self.response(adu.unit, &adu.pdu)?;
                Some(Found { range, response })
            }),
        }
    }

    /// Whether a reply's shape with a wrong check stands anywhere.
    pub(super) fn finds_damaged(&self, bytes: &[u8]) -> bool {
        match self.mode {
            Mode::Rtu => (0..bytes.len()).any(|start| {
                let [normal, exception] = self.rtu_lengths(&bytes[start..], false);
                let Some(len) = normal.or(exception) else { return false };
                let Some(frame) = bytes.get(start..start + len) else { return false };
                matches!(rtu::decode(frame), Err(rtu::AduError::BadCrc { .. }))
            }),
            Mode::Ascii => ascii_lines(bytes)
                .any(|range| matches!(ascii::decode(&bytes[range]), Err(ascii::AduError::BadLrc { .. }))),
        }
    }

    /// Length of the normal reply on the wire, the longest possible where the request does not tell it.
    pub(super) fn reply_len(&self) -> usize {
        match (self.mode, self.request.response_pdu_len()) {
            (Mode::Rtu, Some(pdu)) => pdu + RTU_OVERHEAD,
            (Mode::Rtu, None) => rtu::MAX_ADU_LEN,
            (Mode::Ascii, Some(pdu)) => 2 * (pdu + 2) + 3,
            (Mode::Ascii, None) => ascii::MAX_ADU_LEN,
        }
    }

    /// Whether a reply to this request could be taken for a reply to `other`.
    pub(super) fn is_confusable_with(&self, other: &Expected<'_>) -> bool {
        self.unit == other.unit
            && self.request.function() == other.request.function()
            && self.request.response_pdu_len() == other.request.response_pdu_len()
    }

    /// Lengths that a frame at the start of `bytes` can have, judged by its first bytes: normal reply, exception.
    fn rtu_lengths(&self, bytes: &[u8], silent: bool) -> [Option<usize>; 2] {
        let &[unit, function, ..] = bytes else { return [None, None] };
        let (unit, wanted) = (UnitId(unit), self.request.function());
        let normal = unit == self.unit && function == wanted;
        let exception = self.may_refuse(unit) && function == wanted | 0x80;
        let len = match self.request.response_pdu_len() {
            Some(pdu) => Some(pdu + RTU_OVERHEAD),
            None if silent => Some(bytes.len()),
            None => None,
        };
        [len.filter(|_| normal), exception.then_some(EXCEPTION_ADU_LEN)]
    }

    fn response(&self, unit: UnitId, pdu: &[u8]) -> Option<Response> {
        let response = Response::decode(pdu).ok()?;
        let from_right_unit = match response {
            Response::Exception { .. } => self.may_refuse(unit),
            _ => unit == self.unit,
        };
        (from_right_unit && self.request.accepts(&response)).then_some(response)
    }

    /// An exception may come with the broadcast address, whoever was asked (LVDT manual, section 3.6).
    fn may_refuse(&self, unit: UnitId) -> bool {
        unit == self.unit || unit == UnitId::BROADCAST
    }
}

/// Everything from a colon to the next line feed.
pub(super) fn ascii_lines(bytes: &[u8]) -> impl Iterator<Item = Range<usize>> {
    let mut from = 0;
    let ends = bytes.iter().enumerate().filter(|(_, byte)| **byte & 0x7F == b'\n').map(|(end, _)| end);
    ends.filter_map(move |end| {
        let line = from..end;
        from = end + 1;
        // A colon always starts anew (serial line guide, clause 2.5.2.1).
        let colon = bytes[line.clone()].iter().rposition(|byte| byte & 0x7F == b':')?;
        Some(line.start + colon..end + 1)
    })
}
