//! What counts and filters need to know of an entry, in four bytes.

use buslens_codec::diagnose::Diagnosis;
use buslens_codec::dissect::Direction;
use buslens_codec::transcript::{Entry, EntryKind};

/// Ids of all diagnoses; a diagnosis is known by its place here.
pub(crate) const IDS: [&str; 16] = [
    "single_bit_error",
    "swapped_crc",
    "missing_byte",
    "extra_byte",
    "bad_crc",
    "bad_lrc",
    "lrc_in_rtu",
    "crc_in_ascii",
    "ascii_not_hex",
    "truncated",
    "echo",
    "byte_count_mismatch",
    "exception",
    "unit_reserved",
    "value_out_of_range",
    "manual_erratum",
];

/// The bit of an exception.
const EXCEPTION: u16 = 1 << 12;

/// What is known of an entry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Facts {
    /// A bit for each of [`IDS`].
    diagnoses: u16,
    /// Bits of what it is.
    is: u8,
}

impl Facts {
    /// A frame with a right check.
    pub(crate) const FRAME: u8 = 1;
    pub(crate) const REQUEST: u8 = 2;
    pub(crate) const RESPONSE: u8 = 4;
    /// A frame with a wrong check.
    pub(crate) const DAMAGED: u8 = 8;
    pub(crate) const UNANSWERED: u8 = 16;
    pub(crate) const ORPHAN: u8 = 32;
    pub(crate) const NOISE: u8 = 64;
    /// It was sent from here.
    pub(crate) const SENT: u8 = 128;

    /// `waits` says that its answer may still come.
    pub(crate) fn new(entry: &Entry, diagnoses: &[Diagnosis], waits: bool) -> Self {
        let facts = [
            (entry.check_ok, Self::FRAME),
            (entry.direction == Direction::Request, Self::REQUEST),
            (entry.direction == Direction::Response, Self::RESPONSE),
            (entry.kind == EntryKind::Frame && !entry.check_ok, Self::DAMAGED),
            (entry.is_unanswered() && !waits, Self::UNANSWERED),
            (entry.is_orphan(), Self::ORPHAN),
            (entry.kind == EntryKind::Noise, Self::NOISE),
            (entry.mark == Direction::Request, Self::SENT),
        ];
        let is = facts.iter().filter(|(holds, _)| *holds).fold(0, |is, (_, fact)| is | fact);
        Self { diagnoses: Self::bits(diagnoses), is }
    }

    fn bits(diagnoses: &[Diagnosis]) -> u16 {
        let places = diagnoses.iter().filter_map(|found| IDS.iter().position(|id| *id == found.id()));
        places.fold(0, |bits, place| bits | 1 << place)
    }

    /// Whether any of these holds.
    pub(crate) fn is(self, any: u8) -> bool {
        self.is & any != 0
    }

    /// Whether it has any of the diagnoses with these bits.
    pub(crate) fn has(self, diagnoses: u16) -> bool {
        self.diagnoses & diagnoses != 0
    }

    pub(crate) fn is_exception(self) -> bool {
        self.is(Self::FRAME) && self.has(EXCEPTION)
    }

    /// Places in [`IDS`] of its diagnoses.
    pub(crate) fn diagnoses(self) -> impl Iterator<Item = usize> {
        let mut left = self.diagnoses;
        std::iter::from_fn(move || {
            let place = left.trailing_zeros();
            left &= left.checked_sub(1)?;
            usize::try_from(place).ok()
        })
    }

    /// Whether anything is wrong with it. In `one_sided` lists nobody misses the other half.
    pub(crate) fn is_wrong(self, one_sided: bool) -> bool {
        let alone = if one_sided { 0 } else { Self::UNANSWERED | Self::ORPHAN };
        self.is(Self::NOISE | Self::DAMAGED | alone) || self.diagnoses != 0
    }
}

/// Bits of the diagnoses whose ids fit.
pub(crate) fn bits_of(fits: impl Fn(&str) -> bool) -> u16 {
    let places = IDS.iter().enumerate().filter(|(_, id)| fits(id));
    places.fold(0, |bits, (place, _)| bits | 1 << place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_diagnosis_has_its_bit() {
        let all = [
            Diagnosis::SingleBitError { byte: 0, bit: 0, repaired: Vec::new() },
            Diagnosis::SwappedCrc { repaired: Vec::new() },
            Diagnosis::MissingByte { repair: None },
            Diagnosis::ExtraByte { repair: None },
            Diagnosis::BadCrc { expected: [0; 2] },
            Diagnosis::BadLrc { expected: 0 },
            Diagnosis::LrcInRtu,
            Diagnosis::CrcInAscii,
            Diagnosis::AsciiNotHex { at: 0 },
            Diagnosis::Truncated { expected: None },
            Diagnosis::Echo,
            Diagnosis::ByteCountMismatch { found: 0, expected: 0 },
            Diagnosis::Exception { code: 1 },
            Diagnosis::UnitReserved { unit: 250 },
            Diagnosis::ValueOutOfRange { point: String::new() },
            Diagnosis::ManualErratum { number: 1 },
        ];
        assert_eq!(all.each_ref().map(Diagnosis::id), IDS);
        assert_eq!(size_of::<Facts>(), 4);
        assert_eq!(bits_of(|id| id == "exception"), EXCEPTION);
        let exception = [Diagnosis::Exception { code: 1 }, Diagnosis::Echo];
        let facts = Facts { diagnoses: Facts::bits(&exception), is: Facts::FRAME };
        assert_eq!((facts.is_exception(), facts.diagnoses().collect::<Vec<_>>()), (true, vec![10, 12]));
    }
}
