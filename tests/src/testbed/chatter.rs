//! Two strangers on the line: a master and a device that talk to each other, while the browser only listens.

use std::time::Duration;

use buslens_bus::time::Instant;
use buslens_codec::line::LineSettings;
use buslens_codec::{UnitId, rtu};

use super::wire::FarEnd;

/// Bytes that wait for room at the most.
const PORTION: usize = 2048;

/// A master that reads one register of a device again and again. Each reply holds the number of its exchange, so that a
/// lost one is missed.
pub struct Chatter {
    pace: Duration,
    left: u32,
    next: u32,
    /// When the next frame begins, and whether it is a reply.
    due: Option<Instant>,
    is_reply: bool,
    /// What is on its way.
    said: Vec<u8>,
    written: Vec<Vec<u8>>,
    keeps: bool,
    count: u32,
}

impl Chatter {
    /// Silent until it is told to talk. With `keeps` it remembers what it has said.
    pub fn silent(keeps: bool) -> Self {
        Self {
            pace: Duration::ZERO,
            left: 0,
            next: 0,
            due: None,
            is_reply: false,
            said: Vec::new(),
            written: Vec::new(),
            keeps,
            count: 0,
        }
    }

    /// Talks from now on: so many exchanges, with `pace` from frame to frame. At 50 microseconds a pty still has room; one
    /// that was full is read slowly from then on.
    pub fn talk(&mut self, now: Instant, exchanges: u32, pace: Duration) {
        (self.pace, self.left, self.due) = (pace, exchanges, Some(now));
    }

    /// Whether everything has been said.
    pub fn is_done(&self) -> bool {
        self.left == 0
    }

    /// How many frames have been said.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// What has been said, a frame each, where it is kept.
    pub fn written(&self) -> &[Vec<u8>] {
        &self.written
    }

    /// Says the next frame.
    fn say(&mut self) {
        let number = self.next;
        // The value names the exchange.
        let [_, high, middle, low] = number.to_be_bytes();
        let request = [0x04, middle & 0x7F, low, 0x00, 0x02];
        let reply = [0x04, 0x04, 0x00, high, middle, low];
        let pdu: &[u8] = if self.is_reply { &reply } else { &request };
        let frame = rtu::encode(UnitId(1), pdu).expect("a short PDU");
        self.said.extend_from_slice(&frame);
        if self.keeps {
            self.written.push(frame);
        }
        self.count += 1;
        if self.is_reply {
            self.next += 1;
            self.left -= 1;
        }
        self.is_reply = !self.is_reply;
    }
}

impl FarEnd for Chatter {
    fn handle_settings(&mut self, _: Instant, _: LineSettings) {}

    fn handle_bytes(&mut self, _: Instant, _: &[u8]) {}

    fn handle_timeout(&mut self, now: Instant) {
        while let Some(due) = self.poll_timeout().filter(|&due| due <= now) {
            self.say();
            self.due = Some(due + self.pace);
        }
    }

    /// Nothing more is said before what has been said is heard.
    fn poll_timeout(&self) -> Option<Instant> {
        self.due.filter(|_| self.left > 0 && self.said.len() < PORTION)
    }

    fn poll_transmit(&mut self) -> Option<Vec<u8>> {
        if self.said.is_empty() { None } else { Some(std::mem::take(&mut self.said)) }
    }
}
