//! What is wrong with a frame, as hints: none of them changes a value.
//!
//! A frame with a wrong check is explained by the one change that would make it whole, if that leaves a PDU that the
//! standard knows: a flipped bit, a lost or an added byte, swapped check bytes, the other mode's check. Several hints may
//! apply; the most likely one comes first, the wrong check itself always last, so that every damaged frame carries it.

pub(crate) mod ascii;
pub(crate) mod repair;
pub(crate) mod rtu;
pub(crate) mod shape;

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::dissect::{Direction, Dissection, NamedValue};
use crate::line::Mode;
use crate::profile::Profile;

/// Something that is wrong or remarkable about a frame.
///
/// Places count from 0: bytes of the frame in RTU mode; characters of the frame, the colon being 0, in ASCII mode.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Diagnosis {
    /// One bit is wrong.
    SingleBitError {
        /// Place of its byte, or of its character in ASCII mode.
        byte: usize,
        /// 0 is the least significant bit, which the line carries first.
        bit: u8,
        /// The whole frame: unit id, PDU and check.
        repaired: Vec<u8>,
    },
    /// The check is sent high byte first.
    SwappedCrc {
        /// The whole frame, its check low byte first.
        repaired: Vec<u8>,
    },
    /// A byte is lost.
    MissingByte {
        /// Where it would stand, and the whole frame with it; `None` where several bytes at several places would do. In a
        /// run of equal bytes, the first place.
        repair: Option<Placed>,
    },
    /// There is a byte too many.
    ExtraByte {
        /// Where it stands, in a run of equal bytes the first place, and the whole frame without it; `None` where the loss
        /// of one of several bytes would do.
        repair: Option<Placed>,
    },
    /// The CRC is wrong (serial line guide, clause 2.5.1.2).
    BadCrc {
        /// What it should be, low byte first as on the wire.
        expected: [u8; 2],
    },
    /// The LRC is wrong (serial line guide, clause 2.5.2.2).
    BadLrc {
        /// What it should be.
        expected: u8,
    },
    /// An RTU frame ends with an LRC.
    LrcInRtu,
    /// An ASCII frame ends with a CRC.
    CrcInAscii,
    /// A character that is no hexadecimal digit, or a digit without its twin.
    AsciiNotHex {
        /// Place of the character.
        at: usize,
    },
    /// The frame ends too early.
    Truncated {
        /// Bytes of the whole frame (characters in ASCII mode), where what is left of it tells.
        expected: Option<usize>,
    },
    /// The adapter hears what it sends: the request again, before the answer.
    Echo,
    /// The byte count contradicts the frame's length or the quantity that was asked for.
    ByteCountMismatch {
        /// As in the frame.
        found: u8,
        /// What it should be.
        expected: usize,
    },
    /// The device refuses (application protocol, clause 7).
    Exception {
        /// The exception code.
        code: u8,
    },
    /// The unit id is kept for later use: 248 to 255 (serial line guide, clause 2.2).
    UnitReserved {
        /// The unit id.
        unit: u8,
    },
    /// A value that the profile does not allow.
    ValueOutOfRange {
        /// The point's id.
        point: String,
    },
    /// The frame is printed like this in a device's manual, which is wrong.
    ManualErratum {
        /// Its number among the profile's errata, from 1.
        number: usize,
    },
}

/// A repair and its place.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Placed {
    /// The place.
    pub at: usize,
    /// The whole frame: unit id, PDU and check.
    pub repaired: Vec<u8>,
}

impl Diagnosis {
    /// Its stable name for programs.
    pub const fn id(&self) -> &'static str {
        match self {
            Self::SingleBitError { .. } => "single_bit_error",
            Self::SwappedCrc { .. } => "swapped_crc",
            Self::MissingByte { .. } => "missing_byte",
            Self::ExtraByte { .. } => "extra_byte",
            Self::BadCrc { .. } => "bad_crc",
            Self::BadLrc { .. } => "bad_lrc",
            Self::LrcInRtu => "lrc_in_rtu",
            Self::CrcInAscii => "crc_in_ascii",
            Self::AsciiNotHex { .. } => "ascii_not_hex",
            Self::Truncated { .. } => "truncated",
            Self::Echo => "echo",
            Self::ByteCountMismatch { .. } => "byte_count_mismatch",
            Self::Exception { .. } => "exception",
            Self::UnitReserved { .. } => "unit_reserved",
            Self::ValueOutOfRange { .. } => "value_out_of_range",
            Self::ManualErratum { .. } => "manual_erratum",
        }
    }

    /// The whole frame that it takes this one for: unit id, PDU and check.
    pub fn repaired(&self) -> Option<&[u8]> {
        match self {
            Self::SingleBitError { repaired, .. } | Self::SwappedCrc { repaired } => Some(repaired),
            Self::MissingByte { repair } | Self::ExtraByte { repair } => Some(&repair.as_ref()?.repaired),
            _ => None,
        }
    }
}

/// What is known of a frame from around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Surroundings<'a> {
    /// Which way it goes, as far as that is known.
    pub direction: Direction,
    /// The request that it may answer: unit id and PDU.
    pub request: Option<&'a [u8]>,
}

impl Surroundings<'_> {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { direction: Direction::Unknown, request: None };

    fn admits(self, sides: shape::Sides) -> bool {
        (sides.request && self.direction != Direction::Response)
            || (sides.response && self.direction != Direction::Request)
    }
}

/// What is wrong with a frame of `mode` whose check is wrong or missing, most likely first. Empty where the bytes are
/// neither a damaged frame nor like one: bare noise. In ASCII mode the frame is its characters, CR LF included.
pub fn damage(mode: Mode, frame: &[u8], surroundings: Surroundings<'_>) -> Vec<Diagnosis> {
    match mode {
        Mode::Rtu => rtu::damage(frame, surroundings),
        Mode::Ascii => ascii::damage(frame, surroundings),
    }
}

/// Values that the profile does not allow: codes that its table lacks, values beyond its range, registers that hold no
/// value of their encoding. A value whose scale is not known is not judged.
pub fn values_out_of_range(dissection: &Dissection, profile: &Profile) -> Vec<Diagnosis> {
    let is_wrong = |named: &&NamedValue| match named.value {
        Ok(value) => named.scaled && profile.point(&named.point).is_some_and(|point| !point.allows(value)),
        Err(_) => true,
    };
    let found = dissection.points.iter().filter(is_wrong);
    found.map(|named| Diagnosis::ValueOutOfRange { point: named.point.clone() }).collect()
}

/// Whether the device's manual prints exactly this frame, and is wrong. In ASCII mode the frame is its characters, CR LF
/// included.
pub fn manual_erratum(frame: &[u8], profile: &Profile) -> Option<Diagnosis> {
    let place = profile.errata.iter().position(|erratum| !frame.is_empty() && erratum.printed == frame)?;
    Some(Diagnosis::ManualErratum { number: place.saturating_add(1) })
}
