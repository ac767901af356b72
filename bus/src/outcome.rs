//! How an exchange ended, classed by what the caller does next.

use core::time::Duration;

use buslens_codec::pdu::{ExceptionCode, PduError, Response};
use serde::{Deserialize, Serialize};

use crate::record::{End, Outcome};
use crate::time::Instant;

/// What a completed job brought.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The unit's reply, never an exception.
    Reply(Response),
    /// A broadcast write has left and the turnaround has passed; nobody answers a broadcast.
    BroadcastSent,
    /// Bytes that are no request have left, something was heard, and the line is quiet.
    Heard,
}

/// Why a job brought no answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// The unit refused by an exception reply.
    #[error("exception {} from the device", .code.code())]
    Exception {
        /// The function code that was refused.
        function: u8,
        /// The device's reason.
        code: ExceptionCode,
    },
    /// Nothing that could be the reply came in time.
    #[error("no answer")]
    NoAnswer {
        /// Bytes that came instead; empty when the line was silent.
        heard: Vec<u8>,
        /// Framing, parity, break and overrun errors that the port reported meanwhile.
        line_errors: u32,
    },
    /// A frame of the reply's shape came with a wrong check.
    #[error("wrong check")]
    BadCheck {
        /// The frame as it came.
        heard: Vec<u8>,
    },
    /// A reply came that may belong to an earlier, timed-out request of the same shape. It was not used.
    #[error("the reply may be an earlier request's")]
    Doubtful,
    /// The only thing heard equals the request: this may be the adapter's echo or the device's answer.
    #[error("echo or answer: cannot be told apart")]
    Unproven,
    /// The port closed or vanished before the reply.
    #[error("the port is gone")]
    LinkLost,
    /// It may change something in a device, and only reads are let out. Not sent.
    #[error("only reads are let out")]
    ReadOnly,
    /// The request breaks a limit of the standard and was not sent.
    #[error(transparent)]
    Invalid(#[from] PduError),
}

/// What the caller can do about a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextStep {
    /// Ask again: nothing has changed in the device.
    Retry,
    /// The write may have taken effect: read back before writing again.
    ReadBack,
    /// The device is there and says no: change the request.
    ChangeRequest,
    /// Wait for the port and open it again.
    ReopenPort,
}

impl Failure {
    /// What to do next, where `wrote` says whether the request was a write.
    pub fn next_step(&self, wrote: bool) -> NextStep {
        match self {
            Self::Exception { code: ExceptionCode::Acknowledge | ExceptionCode::ServerDeviceBusy, .. } => {
                NextStep::Retry
            }
            Self::Exception { .. } | Self::ReadOnly | Self::Invalid(_) => NextStep::ChangeRequest,
            Self::LinkLost => NextStep::ReopenPort,
            Self::NoAnswer { .. } | Self::BadCheck { .. } | Self::Doubtful | Self::Unproven => {
                if wrote {
                    NextStep::ReadBack
                } else {
                    NextStep::Retry
                }
            }
        }
    }
}

/// A finished exchange: what was sent and how it ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exchange {
    /// The whole frame that was sent; empty if none was.
    pub sent: Vec<u8>,
    /// The whole frame that answered, or whatever was heard instead.
    pub received: Vec<u8>,
    /// When the bytes were handed to the port; of bytes that were not sent, when it ended.
    pub sent_at: Instant,
    /// When it ended.
    pub at: Instant,
    /// From the first byte handed to the port to the last byte of the reply, if there was one.
    pub round_trip: Option<Duration>,
    /// The answer or the reason why there is none.
    pub result: Result<Answer, Failure>,
}

impl Exchange {
    /// Nothing was sent.
    pub(crate) fn unsent(now: Instant, failure: Failure) -> Self {
        Self { sent: Vec::new(), received: Vec::new(), sent_at: now, at: now, round_trip: None, result: Err(failure) }
    }
}

/// The exchange in a word, for whoever sent the bytes from outside.
impl From<&Exchange> for Outcome {
    fn from(exchange: &Exchange) -> Self {
        let end = match &exchange.result {
            Ok(Answer::Reply(_)) | Err(Failure::Exception { .. }) => End::Answered,
            Ok(Answer::BroadcastSent) => End::Broadcast,
            Ok(Answer::Heard) => End::Heard,
            Err(Failure::NoAnswer { .. }) if exchange.received.is_empty() => End::Silence,
            Err(Failure::NoAnswer { .. } | Failure::BadCheck { .. }) => End::Damaged,
            Err(Failure::Doubtful | Failure::Unproven) => End::Doubtful,
            Err(Failure::ReadOnly) => End::ReadOnly,
            Err(Failure::LinkLost | Failure::Invalid(_)) => End::NoPort,
        };
        Self {
            at_us: exchange.sent_at.as_micros(),
            heard: exchange.received.clone(),
            round_trip_us: exchange.round_trip.and_then(|round_trip| u32::try_from(round_trip.as_micros()).ok()),
            end,
        }
    }
}

/// Counts since the link was first opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Requests sent.
    pub requests: u64,
    /// Replies that answered a request, exceptions not among them.
    pub replies: u64,
    /// Requests that nothing answered in time.
    pub no_answers: u64,
    /// Replies with a wrong check.
    pub bad_checks: u64,
    /// Exception replies.
    pub exceptions: u64,
    /// Replies that came after their time, or that could not be told from such.
    pub late_replies: u64,
    /// Bytes that belonged to no frame of ours.
    pub noise_bytes: u64,
    /// Framing, parity, break and overrun errors reported by the port.
    pub line_errors: u64,
    /// Requests heard back from a half-duplex adapter.
    pub echoes: u64,
}

impl Counters {
    /// Counts an exchange that has ended.
    pub(crate) fn count(&mut self, exchange: &Exchange) {
        match &exchange.result {
            Ok(Answer::Reply(_)) => self.replies += 1,
            Err(Failure::Exception { .. }) => self.exceptions += 1,
            Err(Failure::NoAnswer { .. } | Failure::Doubtful | Failure::Unproven) => self.no_answers += 1,
            Err(Failure::BadCheck { .. }) => self.bad_checks += 1,
            Ok(Answer::BroadcastSent | Answer::Heard)
            | Err(Failure::LinkLost | Failure::ReadOnly | Failure::Invalid(_)) => {}
        }
    }
}
