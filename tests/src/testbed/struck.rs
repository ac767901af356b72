//! A line on which something goes wrong just when a certain request goes over it.

use std::time::Duration;

use buslens_bus::sim::{Device, Line};
use buslens_bus::time::Instant;
use buslens_codec::line::LineSettings;
use buslens_codec::{ascii, rtu};

use super::wire::FarEnd;

/// What goes wrong with the request or its reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strike {
    /// The reply never leaves the device.
    Lost,
    /// One of the reply's bits is turned.
    Corrupted,
    /// The reply comes so much later.
    Late(Duration),
    /// The reply and all that follow never leave the device, which does what it is told.
    Dumb,
    /// The request and all that follow never reach the device.
    Deaf,
    /// The device loses its supply once it has done what it was told, before its reply, and has it back at once.
    PowerCut,
}

/// A line that strikes once.
pub struct Struck<D> {
    /// The line.
    pub line: Line<D>,
    armed: Option<(Trigger, Strike)>,
    host: Option<LineSettings>,
    /// All that was heard, or since the last whole frame.
    heard: Vec<u8>,
    writes: usize,
    is_deaf: bool,
    power_cut_at: Option<Instant>,
}

/// The request at which it strikes.
enum Trigger {
    /// The one with these bytes in it.
    Bytes(Vec<u8>),
    /// The write after so many others.
    Write(usize),
}

impl<D: Device> Struck<D> {
    /// A line that strikes when the browser has sent `trigger`.
    pub fn new(line: Line<D>, trigger: &[u8], strike: Strike) -> Self {
        Self::armed(line, Trigger::Bytes(trigger.to_vec()), strike)
    }

    /// A line that strikes at the browser's write after `earlier` others.
    pub fn at_write(line: Line<D>, earlier: usize, strike: Strike) -> Self {
        Self::armed(line, Trigger::Write(earlier), strike)
    }

    fn armed(line: Line<D>, trigger: Trigger, strike: Strike) -> Self {
        Self {
            line,
            armed: Some((trigger, strike)),
            host: None,
            heard: Vec::new(),
            writes: 0,
            is_deaf: false,
            power_cut_at: None,
        }
    }

    /// Whether it has struck.
    pub fn has_struck(&self) -> bool {
        self.armed.is_none() && self.power_cut_at.is_none()
    }

    /// From now on everything is heard and answered again.
    pub fn recover(&mut self) {
        self.line.faults.lost_replies = 0;
        self.is_deaf = false;
    }

    fn is_triggered(&mut self) -> bool {
        let Some((trigger, _)) = &self.armed else { return false };
        match trigger {
            Trigger::Bytes(wanted) => self.heard.windows(wanted.len()).any(|window| window == wanted),
            Trigger::Write(earlier) => {
                let Some(function) = function_of(&self.heard) else { return false };
                self.heard.clear();
                let is_write = matches!(function, 0x05 | 0x06 | 0x0F | 0x10);
                self.writes += usize::from(is_write);
                is_write && self.writes == earlier + 1
            }
        }
    }

    /// Lets it happen, with a request of so many bytes that is handed over now.
    fn strike(&mut self, now: Instant, len: usize) {
        let Some((_, strike)) = self.armed.take() else { return };
        let faults = &mut self.line.faults;
        match strike {
            Strike::Lost => faults.lost_replies = 1,
            Strike::Corrupted => faults.corrupted_replies = 1,
            Strike::Late(delay) => {
                faults.reply_delay = delay;
                faults.delayed_replies = Some(1);
            }
            Strike::Dumb => faults.lost_replies = u32::MAX,
            Strike::Deaf => self.is_deaf = true,
            Strike::PowerCut => {
                faults.lost_replies = 1;
                let host = self.host.expect("the browser has opened the port");
                let carried_out = now + host.character_time(len) + host.frame_gap() + Duration::from_millis(1);
                self.power_cut_at = Some(carried_out);
            }
        }
    }
}

fn function_of(frame: &[u8]) -> Option<u8> {
    let rtu = rtu::decode(frame).ok().and_then(|adu| adu.pdu.first().copied());
    rtu.or_else(|| ascii::decode(frame).ok().and_then(|adu| adu.pdu.first().copied()))
}

impl<D: Device + 'static> FarEnd for Struck<D> {
    fn handle_settings(&mut self, now: Instant, settings: LineSettings) {
        self.host = Some(settings);
        self.line.handle_settings(now, settings);
    }

    fn handle_bytes(&mut self, now: Instant, bytes: &[u8]) {
        self.heard.extend_from_slice(bytes);
        // The reply comes when the last of them has gone over the line.
        if self.is_triggered() {
            self.strike(now, bytes.len());
        }
        if !self.is_deaf {
            self.line.handle_bytes(now, bytes);
        }
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.line.handle_timeout(now);
        if self.power_cut_at.take_if(|at| *at <= now).is_some() {
            self.line.power_cycle(now);
        }
    }

    fn poll_timeout(&self) -> Option<Instant> {
        self.line.poll_timeout().into_iter().chain(self.power_cut_at).min()
    }

    fn poll_transmit(&mut self) -> Option<Vec<u8>> {
        self.line.poll_transmit()
    }
}
