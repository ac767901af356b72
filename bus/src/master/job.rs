//! What can be asked of a master, and what goes out for it.

use std::time::Duration;

use buslens_codec::line::Mode;
use buslens_codec::pdu::Request;
use buslens_codec::{UnitId, ascii, rtu};

use super::expect::{Expected, ascii_lines};
use crate::record::Origin;
use crate::time::Instant;

/// Length of an RTU frame that reads: functions 01 to 04 have two words each (application protocol, clause 6.1).
const READ_ADU_LEN: usize = 8;
/// So many requests are looked for in bytes that are no frame.
const MOST_HIDDEN: usize = 8;

/// Something to be sent once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// What.
    pub content: Content,
    /// Who wants it.
    pub origin: Origin,
    /// How long to wait for an answer, from the last bit sent; `None` leaves it to the master. What an adapter may hold
    /// back is always waited for, 50 ms.
    pub wait: Option<Duration>,
    /// How often a read may be repeated after a failure that a repetition can mend. Writes and raw bytes are never
    /// repeated.
    pub retries: u8,
}

/// What a job sends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Content {
    /// A request, in a frame of the line's mode.
    Request {
        /// To whom.
        unit: UnitId,
        /// What.
        request: Request,
    },
    /// Bytes as they are. One whole frame of the line's mode with a right check, whose function code is not an
    /// exception's, is a request like any other, were it beyond the standard's limits. Other bytes hold the line until
    /// something was heard and it is quiet, or until the wait is over. No bytes at all keep the line free for the whole
    /// wait.
    Raw(Vec<u8>),
}

impl Job {
    /// A request without retries.
    pub fn new(unit: UnitId, request: Request) -> Self {
        Self { content: Content::Request { unit, request }, origin: Origin::Unknown, wait: None, retries: 0 }
    }

    /// Bytes as they are.
    pub fn raw(bytes: Vec<u8>, wait: Option<Duration>) -> Self {
        Self { content: Content::Raw(bytes), origin: Origin::Unknown, wait, retries: 0 }
    }

    /// The same job, wanted by `origin`.
    #[must_use]
    pub fn by(self, origin: Origin) -> Self {
        Self { origin, ..self }
    }

    /// Whom it is for, as far as that is known before it leaves.
    pub(super) fn unit(&self, mode: Mode) -> Option<UnitId> {
        match &self.content {
            Content::Request { unit, .. } => Some(*unit),
            Content::Raw(bytes) => request_of(mode, bytes).map(|(unit, _)| unit),
        }
    }
}

/// Names a submitted job in its [`super::Event::Done`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobId(pub(super) u64);

/// Bytes to be sent now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transmit {
    /// Since when the line is theirs: the exchange's time of sending.
    pub at: Instant,
    /// Who wants it.
    pub origin: Origin,
    /// The bytes; none where the line is only kept free.
    pub bytes: Vec<u8>,
}

/// A request and the unit that it is for.
pub(super) type Addressed = (UnitId, Request);

/// The request that `bytes` are, if they are one frame of `mode` and nothing else.
pub(super) fn request_of(mode: Mode, bytes: &[u8]) -> Option<Addressed> {
    let (unit, pdu) = match mode {
        Mode::Rtu => rtu::decode(bytes).ok().map(|adu| (adu.unit, adu.pdu.to_vec()))?,
        Mode::Ascii => ascii::decode(bytes).ok().map(|adu| (adu.unit, adu.pdu))?,
    };
    let (&function, data) = pdu.split_first().filter(|(function, _)| (1..0x80).contains(*function))?;
    // What a device must refuse can be asked too.
    let request = Request::decode(&pdu).unwrap_or_else(|_| Request::Other { function, data: data.to_vec() });
    Some((unit, request))
}

/// The reads that a device could see in `sent`, which is no frame as a whole, and to which no reply stands in `heard`.
/// A device that takes every silence for a border, or every colon, may still answer them.
pub(super) fn unanswered_reads(mode: Mode, sent: &[u8], heard: &[u8]) -> Vec<Addressed> {
    let whole = |frame: &[u8]| request_of(mode, frame).filter(|(_, request)| !request.is_write());
    let hidden: Vec<_> = match mode {
        Mode::Rtu => sent.windows(READ_ADU_LEN).filter_map(whole).take(MOST_HIDDEN).collect(),
        Mode::Ascii => ascii_lines(sent).filter_map(|line| whole(sent.get(line)?)).take(MOST_HIDDEN).collect(),
    };
    let unanswered = |(unit, request): &Addressed| Expected { mode, unit: *unit, request }.find(heard, true).is_none();
    hidden.into_iter().filter(unanswered).collect()
}
