//! The wire: characters take their time, and everybody who drives it at once loses.

use std::collections::VecDeque;

use buslens_codec::line::{LineSettings, Mode, Parity};

use super::faults::{Chance, Faults};
use super::station::{Device, Outgoing, Station, understands};
use crate::time::Instant;

/// A half-duplex line with one host and any number of devices.
pub struct Line<D> {
    /// What goes wrong on it.
    pub faults: Faults,
    host: LineSettings,
    stations: Vec<Station<D>>,
    /// Characters that the host is sending, by the time at which each has left.
    from_host: VecDeque<Character>,
    /// Characters on their way to the host, by the time at which each has come.
    to_host: VecDeque<Character>,
    arrived: Vec<u8>,
    chance: Chance,
}

#[derive(Clone, Copy)]
struct Character {
    start: Instant,
    end: Instant,
    byte: u8,
    line: LineSettings,
    /// The device that sends it; `None` is the host.
    station: Option<usize>,
}

impl<D: Device> Line<D> {
    /// A perfect line with `devices` on it; `seed` decides about garbage and about which bit is turned.
    pub fn new(devices: impl IntoIterator<Item = D>, seed: u64) -> Self {
        Self {
            faults: Faults::default(),
            host: LineSettings::new(9600, Parity::None),
            stations: devices.into_iter().map(Station::new).collect(),
            from_host: VecDeque::new(),
            to_host: VecDeque::new(),
            arrived: Vec::new(),
            chance: Chance::new(seed),
        }
    }

    /// The device at `index`, in the order given to [`Line::new`].
    pub fn device_mut(&mut self, index: usize) -> Option<&mut D> {
        self.stations.get_mut(index).map(|station| &mut station.device)
    }

    /// The host's port is now set to `settings`. What is on the wire already stays as it was sent.
    pub fn handle_settings(&mut self, now: Instant, settings: LineSettings) {
        self.handle_timeout(now);
        self.host = settings;
    }

    /// The supply of every device on the line is cut and comes back at once. What a device has not said by then it never
    /// says; what the host is sending goes on.
    pub fn power_cycle(&mut self, now: Instant) {
        self.handle_timeout(now);
        self.to_host.retain(|character| character.station.is_none());
        for station in &mut self.stations {
            station.power_cycle(now);
        }
    }

    /// The host hands bytes to its port, which sends them one after the other.
    pub fn handle_bytes(&mut self, now: Instant, bytes: &[u8]) {
        self.handle_timeout(now);
        let mut start = self.from_host.back().map_or(now, |last| last.end.max(now));
        for &byte in bytes {
            let end = start + self.host.character_time(1);
            let character = Character { start, end, byte, line: self.host, station: None };
            let character = self.collide(character);
            self.from_host.push_back(character);
            if self.faults.echo {
                self.queue_for_host(character);
            }
            start = end;
        }
    }

    /// Carries everything that happens up to `now`.
    pub fn handle_timeout(&mut self, now: Instant) {
        while let Some(at) = self.next_happening().filter(|&at| at <= now) {
            let mut answers = Vec::new();
            if let Some(character) = self.from_host.pop_front_if(|character| character.end <= at) {
                for (index, station) in self.stations.iter_mut().enumerate() {
                    let answer = station.hear(character.end, character.byte, character.line);
                    answers.extend(answer.map(|answer| (index, answer)));
                }
            }
            for (index, station) in self.stations.iter_mut().enumerate() {
                answers.extend(station.handle_silence(at).map(|answer| (index, answer)));
            }
            for (index, answer) in answers {
                self.send(index, answer);
            }
            while let Some(character) = self.to_host.pop_front_if(|character| character.end <= at) {
                self.arrive(character);
            }
        }
    }

    /// When something happens next.
    pub fn poll_timeout(&self) -> Option<Instant> {
        self.next_happening()
    }

    /// Bytes that have come to the host since the last call.
    pub fn poll_transmit(&mut self) -> Option<Vec<u8>> {
        if self.arrived.is_empty() { None } else { Some(core::mem::take(&mut self.arrived)) }
    }

    fn next_happening(&self) -> Option<Instant> {
        let sent = self.from_host.front().map(|character| character.end);
        let came = self.to_host.front().map(|character| character.end);
        let silence = self.stations.iter().filter_map(Station::frame_end).min();
        // A frame is not over while its next character is on the way.
        let silence = silence.filter(|&end| self.from_host.front().is_none_or(|next| next.start >= end));
        [sent, came, silence].into_iter().flatten().min()
    }

    /// Puts a device's frame on the wire, with the faults that are due.
    fn send(&mut self, station: usize, mut frame: Outgoing) {
        let fate = self.faults.fate_of_reply();
        if fate.lost {
            return;
        }
        if fate.corrupted {
            let bit = usize::from(self.chance.byte()) % (frame.bytes.len() * 8);
            frame.bytes[bit / 8] ^= 1 << (bit % 8);
        }
        let noisy = self.faults.noise_before.iter().chain(&frame.bytes).chain(&self.faults.noise_after);
        let bytes: Vec<u8> = noisy.copied().collect();
        let mut start = frame.start + fate.delay;
        for byte in bytes {
            let end = start + frame.line.character_time(1);
            let character = self.collide(Character { start, end, byte, line: frame.line, station: Some(station) });
            self.queue_for_host(character);
            start = end;
        }
    }

    /// Garbles `character` and whatever somebody else has on the wire at the same time.
    fn collide(&mut self, mut character: Character) -> Character {
        let (garbage, other_garbage) = (self.chance.byte(), self.chance.byte());
        for other in self.to_host.iter_mut().chain(&mut self.from_host) {
            let overlaps = other.start < character.end && character.start < other.end;
            if other.station != character.station && overlaps {
                other.byte ^= other_garbage;
                character.byte ^= garbage;
            }
        }
        character
    }

    /// Characters reach the host in the order in which they end.
    fn queue_for_host(&mut self, character: Character) {
        let at = self.to_host.partition_point(|earlier| earlier.end <= character.end);
        self.to_host.insert(at, character);
    }

    /// The host's port makes a byte of a character; at wrong settings any byte, or none.
    fn arrive(&mut self, character: Character) {
        // A pty cannot show the host's data bits, and every sensor answers with eight or its text in seven.
        if understands(self.host, Mode::Ascii, character.line) {
            self.arrived.push(character.byte);
        } else {
            let garbage = self.chance.byte();
            if garbage.is_multiple_of(2) {
                self.arrived.push(garbage);
            }
        }
    }
}
