//! Bytes that have come and have not been understood yet.

use std::ops::Range;

use crate::time::Instant;

/// Room for some frames; older bytes fall out.
const CAPACITY: usize = 4096;

#[derive(Debug, Default)]
pub(super) struct Inbox {
    bytes: Vec<u8>,
    last_at: Option<Instant>,
}

impl Inbox {
    /// Takes bytes in and says how many old ones fell out.
    pub(super) fn push(&mut self, now: Instant, bytes: &[u8]) -> u64 {
        if bytes.is_empty() {
            return 0;
        }
        self.bytes.extend_from_slice(bytes);
        self.last_at = Some(now);
        self.keep(CAPACITY)
    }

    /// Lets all but the last `most` bytes fall out and says how many those were.
    pub(super) fn keep(&mut self, most: usize) -> u64 {
        let excess = self.bytes.len().saturating_sub(most);
        self.bytes.drain(..excess);
        excess as u64
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// When the last byte came that is still here or was part of the same burst.
    pub(super) fn last_at(&self) -> Option<Instant> {
        self.last_at
    }

    /// The first place where `pattern` stands.
    pub(super) fn find(&self, pattern: &[u8], from: usize) -> Option<Range<usize>> {
        let window = self.bytes.get(from..)?;
        let start = window.windows(pattern.len().max(1)).position(|bytes| bytes == pattern)? + from;
        Some(start..start + pattern.len())
    }

    /// Takes one frame out and leaves everything else.
    pub(super) fn remove(&mut self, range: Range<usize>) -> Vec<u8> {
        self.bytes.drain(range).collect()
    }

    /// Takes everything out.
    pub(super) fn take(&mut self) -> Vec<u8> {
        self.last_at = None;
        std::mem::take(&mut self.bytes)
    }

    /// Throws everything away and says how many bytes there were.
    pub(super) fn clear(&mut self) -> u64 {
        self.take().len() as u64
    }
}
