//! Bytes that say what a law is tried with.

use buslens_codec::dissect::Direction;

/// The bytes that have not been read.
#[derive(Clone, Copy)]
pub(super) struct Input<'a>(pub(super) &'a [u8]);

impl<'a> Input<'a> {
    /// A text, which ends at the first byte FF, and what stands behind it.
    pub(super) fn text_and_rest(data: &'a [u8]) -> (String, Self) {
        // No text holds this byte.
        let mut parts = data.splitn(2, |byte| *byte == 0xFF);
        let text = String::from_utf8_lossy(parts.next().unwrap_or_default()).into_owned();
        (text, Self(parts.next().unwrap_or_default()))
    }

    pub(super) fn is_empty(self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn byte(&mut self) -> u8 {
        self.take(1).first().copied().unwrap_or_default()
    }

    pub(super) fn word(&mut self) -> u16 {
        u16::from_be_bytes([self.byte(), self.byte()])
    }

    /// So many bytes, or as many as there are.
    pub(super) fn take(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        taken
    }

    /// A byte and as many bytes as it says.
    pub(super) fn counted(&mut self) -> &'a [u8] {
        let count = self.byte();
        self.take(count.into())
    }

    /// Sizes of chunks, 1 to 256, over and over.
    pub(super) fn sizes(&mut self, count: usize) -> impl Iterator<Item = usize> + Clone + use<'a> {
        let sizes = self.take(count);
        let sizes = if sizes.is_empty() { &[6][..] } else { sizes };
        sizes.iter().map(|size| usize::from(*size) + 1).cycle()
    }
}

/// Two bits say a direction.
pub(super) fn direction(bits: u8) -> Direction {
    match bits & 3 {
        1 => Direction::Request,
        2 => Direction::Response,
        _ => Direction::Unknown,
    }
}
