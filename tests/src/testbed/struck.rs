//! A line on which something goes wrong just when certain bytes go over it.

use std::time::Duration;

use buslens_bus::sim::{Device, Line};
use buslens_bus::time::Instant;
use buslens_codec::line::LineSettings;

use super::wire::FarEnd;

/// What goes wrong with the reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strike {
    /// It never leaves the device.
    Lost,
    /// One of its bits is turned.
    Corrupted,
    /// It comes so much later.
    Late(Duration),
    /// It and all that follow never leave the device.
    Dumb,
}

/// A line that strikes at the request with certain bytes in it, once.
pub struct Struck<D> {
    /// The line.
    pub line: Line<D>,
    armed: Option<(Vec<u8>, Strike)>,
    heard: Vec<u8>,
}

impl<D: Device> Struck<D> {
    /// A line that strikes when the browser has sent `trigger`.
    pub fn new(line: Line<D>, trigger: &[u8], strike: Strike) -> Self {
        Self { line, armed: Some((trigger.to_vec(), strike)), heard: Vec::new() }
    }

    /// Whether it has struck.
    pub fn has_struck(&self) -> bool {
        self.armed.is_none()
    }

    fn strike(&mut self) {
        let Some((trigger, strike)) = &self.armed else { return };
        if !self.heard.windows(trigger.len()).any(|window| window == trigger) {
            return;
        }
        match *strike {
            Strike::Lost => self.line.faults.lost_replies = 1,
            Strike::Corrupted => self.line.faults.corrupted_replies = 1,
            Strike::Late(delay) => {
                self.line.faults.reply_delay = delay;
                self.line.faults.delayed_replies = Some(1);
            }
            Strike::Dumb => self.line.faults.lost_replies = u32::MAX,
        }
        self.armed = None;
    }
}

impl<D: Device + 'static> FarEnd for Struck<D> {
    fn handle_settings(&mut self, now: Instant, settings: LineSettings) {
        self.line.handle_settings(now, settings);
    }

    fn handle_bytes(&mut self, now: Instant, bytes: &[u8]) {
        self.heard.extend_from_slice(bytes);
        // The reply comes when the last of them has gone over the line.
        self.strike();
        self.line.handle_bytes(now, bytes);
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.line.handle_timeout(now);
    }

    fn poll_timeout(&self) -> Option<Instant> {
        self.line.poll_timeout()
    }

    fn poll_transmit(&mut self) -> Option<Vec<u8>> {
        self.line.poll_transmit()
    }
}
