//! One device's connection to the line: it hears characters, finds frames by silence or by their end marks, checks them,
//! and answers after a while. What it answers is the [`Device`]'s business.

use core::time::Duration;

use buslens_codec::line::{DataBits, LineSettings, Mode};
use buslens_codec::{UnitId, adu, ascii, rtu};

use crate::time::Instant;

/// A simulated device, as far as frames go.
pub trait Device: Send {
    /// The settings it listens at now.
    fn line(&self) -> LineSettings;

    /// The mode it listens in now.
    fn mode(&self) -> Mode;

    /// Whether it hears anything at all now.
    fn is_listening(&self, now: Instant) -> bool;

    /// Its answer to a PDU with a right check that was addressed to `unit`; `None` is silence.
    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply>;

    /// Its supply was cut and has come back at `now`. A device that does not say otherwise is none the worse for it.
    fn power_cycle(&mut self, _: Instant) {}

    /// Sets a holding register as earlier writes or the maker would have, without counting it as a write; false, and
    /// nothing is changed, where it keeps no such register or value.
    fn preset(&mut self, _register: u16, _value: u16) -> bool {
        false
    }

    /// How often its lasting memory has been written to: one for every request that did, whatever it changed.
    fn flash_writes(&self) -> u32 {
        0
    }
}

/// A device's answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reply {
    /// The unit id it answers with.
    pub unit: UnitId,
    /// The answer.
    pub pdu: Vec<u8>,
    /// Time from the end of the request to the start of the answer.
    pub after: Duration,
    /// The settings the answer is sent at: a device that has just changed them may use either.
    pub line: LineSettings,
    /// The mode the answer is sent in.
    pub mode: Mode,
}

/// A frame on its way out of a station.
pub(crate) struct Outgoing {
    pub(crate) start: Instant,
    pub(crate) line: LineSettings,
    pub(crate) bytes: Vec<u8>,
}

pub(crate) struct Station<D> {
    pub(crate) device: D,
    heard: Vec<u8>,
    /// The data bits of the last character.
    heard_bits: DataBits,
    /// A character came that broke the device's settings: the frame is lost.
    broken: bool,
    heard_at: Instant,
}

impl<D: Device> Station<D> {
    pub(crate) fn new(device: D) -> Self {
        Self { device, heard: Vec::new(), heard_bits: DataBits::Eight, broken: false, heard_at: Instant::ZERO }
    }

    /// Hears one character that ended at `now` and was sent at `line`.
    pub(crate) fn hear(&mut self, now: Instant, byte: u8, line: LineSettings) -> Option<Outgoing> {
        if !self.device.is_listening(now) {
            self.forget();
            return None;
        }
        let understood = understands(self.device.line(), self.device.mode(), line);
        self.heard_at = now;
        self.heard_bits = line.data_bits;
        match self.device.mode() {
            Mode::Rtu => {
                self.broken |= !understood;
                // A device has room for one frame only.
                if self.heard.len() < rtu::MAX_ADU_LEN {
                    self.heard.push(byte);
                } else {
                    self.broken = true;
                }
                None
            }
            Mode::Ascii => {
                if !understood {
                    return None;
                }
                match byte & 0x7F {
                    b':' => {
                        self.heard.clear();
                        self.heard.push(b':');
                        None
                    }
                    b'\n' => {
                        self.heard.push(b'\n');
                        self.answer(now)
                    }
                    other => {
                        if self.heard.len() < ascii::MAX_ADU_LEN {
                            self.heard.push(other);
                        }
                        None
                    }
                }
            }
        }
    }

    /// When silence will have ended the frame that is being heard.
    pub(crate) fn frame_end(&self) -> Option<Instant> {
        let waits = self.device.mode() == Mode::Rtu && !self.heard.is_empty();
        waits.then(|| self.heard_at + self.device.line().frame_gap())
    }

    /// Answers the frame that silence has ended, if any.
    pub(crate) fn handle_silence(&mut self, now: Instant) -> Option<Outgoing> {
        if self.frame_end().is_some_and(|end| end <= now) { self.answer(now) } else { None }
    }

    fn answer(&mut self, now: Instant) -> Option<Outgoing> {
        let (heard, broken) = (core::mem::take(&mut self.heard), self.broken);
        self.forget();
        if broken || !self.device.is_listening(now) {
            return None;
        }
        let (unit, pdu) = match self.device.mode() {
            Mode::Rtu => rtu::decode(&heard).ok().map(|adu| (adu.unit, adu.pdu.to_vec()))?,
            Mode::Ascii => ascii::decode(&heard).ok().map(|adu| (adu.unit, adu.pdu))?,
        };
        let reply = self.device.serve(now, unit, &pdu)?;
        let bytes = adu::encode(reply.mode, reply.unit, &reply.pdu)?;
        let mut line = reply.line;
        if reply.mode == Mode::Ascii {
            // Seven and eight are taken alike, so the answer comes as the question did.
            line.data_bits = self.heard_bits;
        }
        Some(Outgoing { start: now + reply.after, line, bytes })
    }

    /// Its supply was cut: what it has half heard is lost.
    pub(crate) fn power_cycle(&mut self, now: Instant) {
        self.forget();
        self.device.power_cycle(now);
    }

    fn forget(&mut self) {
        self.heard.clear();
        self.broken = false;
    }
}

/// Whether a receiver set to `own` gets characters right that were sent at `sent`. In ASCII mode the sensors take seven
/// and eight data bits alike; a second stop bit is but a longer pause.
pub(crate) fn understands(own: LineSettings, mode: Mode, sent: LineSettings) -> bool {
    let data = mode == Mode::Ascii || own.data_bits == sent.data_bits;
    own.baud == sent.baud && own.parity == sent.parity && data
}
