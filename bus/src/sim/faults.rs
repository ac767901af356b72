//! What can go wrong on a line, switched on by a test. The default is a perfect line.

use core::time::Duration;

/// Faults that the line applies to what the host hears.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// The adapter hears itself: every character sent comes back.
    pub echo: bool,
    /// Replies start this much later than the device would.
    pub reply_delay: Duration,
    /// So many of the next replies are delayed by `reply_delay`; `None` means all.
    pub delayed_replies: Option<u32>,
    /// So many of the next replies never leave the device.
    pub lost_replies: u32,
    /// So many of the next replies have one bit turned, at a place that the line's seed chooses.
    pub corrupted_replies: u32,
    /// Characters that come before every reply, as from a driver that is switched on.
    pub noise_before: Vec<u8>,
    /// Characters that come after every reply, as from a driver that is switched off.
    pub noise_after: Vec<u8>,
}

/// What becomes of one reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Fate {
    pub(crate) lost: bool,
    pub(crate) corrupted: bool,
    pub(crate) delay: Duration,
}

impl Faults {
    /// Counts one reply.
    pub(crate) fn fate_of_reply(&mut self) -> Fate {
        let delay = match &mut self.delayed_replies {
            None => self.reply_delay,
            Some(0) => Duration::ZERO,
            Some(left) => {
                *left -= 1;
                self.reply_delay
            }
        };
        Fate { lost: count_down(&mut self.lost_replies), corrupted: count_down(&mut self.corrupted_replies), delay }
    }
}

fn count_down(left: &mut u32) -> bool {
    let some = *left > 0;
    *left = left.saturating_sub(1);
    some
}

/// A small seeded generator (xorshift64): the same seed gives the same line, on every machine.
#[derive(Clone, Debug)]
pub(crate) struct Chance(u64);

impl Chance {
    pub(crate) fn new(seed: u64) -> Self {
        // Zero is the one state that xorshift never leaves.
        Self(seed | 1)
    }

    pub(crate) fn byte(&mut self) -> u8 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.to_be_bytes()[2]
    }
}
