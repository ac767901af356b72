//! The third program: the simulated line of a demonstration, in the engine's worker. It has no clock and no timer of its
//! own: the engine's port brings the time with every message and is told when to come back.

use std::cell::RefCell;

use buslens_bus::sim::Demonstration;
use buslens_bus::time::Instant;

use crate::message::{FromSimulator, ToSimulator};

thread_local! {
    static STAGE: RefCell<Stage> = RefCell::default();
}

/// The demonstration, and whose sensor is on the line now, by its packed profile.
#[derive(Default)]
struct Stage {
    demonstration: Demonstration,
    chosen: Vec<u8>,
}

/// Makes a fault of this program one of the engine's worker, which tells the window.
pub fn start() {
    std::panic::set_hook(Box::new(|info| wasm_bindgen::throw_str(&info.to_string())));
}

/// Takes a message of the engine at a time on its clock, in microseconds, and answers it. What cannot be read changes
/// nothing and is answered by nothing.
pub fn hear(now_us: f64, message: &[u8]) -> Vec<u8> {
    // Never negative, and exact for centuries.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let now = Instant::from_micros(now_us as u64);
    let Ok(message) = postcard::from_bytes(message) else { return Vec::new() };
    let news = STAGE.with_borrow_mut(|stage| stage.hear(now, message));
    postcard::to_allocvec(&news).unwrap_or_default()
}

impl Stage {
    fn hear(&mut self, now: Instant, message: ToSimulator) -> FromSimulator {
        if let ToSimulator::Open { profile, .. } = &message {
            self.chosen.clone_from(profile);
        }
        let Some(line) = self.demonstration.line(now, &self.chosen) else { return FromSimulator::default() };
        match message {
            ToSimulator::Open { line: settings, .. } => {
                line.handle_settings(now, settings);
                line.poll_transmit();
            }
            ToSimulator::Write(bytes) => line.handle_bytes(now, &bytes),
            ToSimulator::PowerCycle => line.power_cycle(now),
            ToSimulator::Time => line.handle_timeout(now),
        }
        let arrived = line.poll_transmit().unwrap_or_default();
        FromSimulator { arrived, due_us: line.poll_timeout().map(Instant::as_micros) }
    }
}

#[cfg(test)]
mod tests {
    use buslens_codec::line::{LineSettings, Parity};
    use buslens_codec::profile::{BUILT_IN, Profile};

    use super::*;

    const FACTORY: LineSettings = LineSettings::new(9600, Parity::Even);
    const FASTER: LineSettings = LineSettings::new(19_200, Parity::Even);
    /// Unit 1, function 10: register 0x0031 becomes 4, 19200 Bd; and its echo.
    const WRITE_BAUD: [u8; 11] = [0x01, 0x10, 0x00, 0x31, 0x00, 0x01, 0x02, 0x00, 0x04, 0xA3, 0xB2];
    const READ_BAUD: [u8; 8] = [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5];
    const BAUD_IS_4: [u8; 7] = [0x01, 0x03, 0x02, 0x00, 0x04, 0xB9, 0x87];

    /// The program as the engine's port drives it, in virtual time.
    struct Driver {
        now_us: u64,
        profile: Vec<u8>,
    }

    impl Driver {
        fn tell(&self, message: &ToSimulator) -> FromSimulator {
            #[allow(clippy::cast_precision_loss)]
            let answer = hear(self.now_us as f64, &postcard::to_allocvec(message).unwrap());
            postcard::from_bytes(&answer).unwrap()
        }

        fn open(&self, line: LineSettings) -> FromSimulator {
            self.tell(&ToSimulator::Open { profile: self.profile.clone(), line })
        }

        /// All that comes back until nothing more happens.
        fn ask(&mut self, bytes: &[u8]) -> Vec<u8> {
            let mut news = self.tell(&ToSimulator::Write(bytes.to_vec()));
            let mut arrived = std::mem::take(&mut news.arrived);
            while let Some(due_us) = news.due_us {
                self.now_us = self.now_us.max(due_us);
                news = self.tell(&ToSimulator::Time);
                arrived.append(&mut news.arrived);
            }
            arrived
        }
    }

    #[test]
    fn a_changed_sensor_is_found_changed_when_the_port_is_opened_again() {
        let packed = |text: &str| Profile::from_json(text).unwrap().pack();
        let lvdt = BUILT_IN.iter().find(|text| text.contains("0x0031")).unwrap();
        let other = BUILT_IN.iter().find(|text| !text.contains("0x0031")).unwrap();
        let mut driver = Driver { now_us: 3_000_000, profile: packed(lvdt) };
        driver.open(FACTORY);
        assert_eq!(driver.ask(&WRITE_BAUD)[..6], WRITE_BAUD[..6]);
        // Another sensor in between, and the port at the settings that are no longer right.
        driver.now_us += 1_000_000;
        driver.profile = packed(other);
        driver.open(FACTORY);
        driver.profile = packed(lvdt);
        driver.open(FACTORY);
        assert_ne!(driver.ask(&READ_BAUD), BAUD_IS_4);
        driver.now_us += 1_000_000;
        driver.open(FASTER);
        assert_eq!(driver.ask(&READ_BAUD), BAUD_IS_4);
    }

    #[test]
    fn what_came_while_the_port_was_closed_is_lost() {
        let text = BUILT_IN.iter().find(|text| text.contains("0x0031")).unwrap();
        let mut driver = Driver { now_us: 0, profile: Profile::from_json(text).unwrap().pack() };
        driver.open(FACTORY);
        assert!(driver.tell(&ToSimulator::Write(READ_BAUD.to_vec())).due_us.is_some());
        driver.now_us += 1_000_000;
        assert_eq!(driver.open(FACTORY), FromSimulator::default());
        assert_eq!(driver.ask(&READ_BAUD).len(), 7);
    }

    #[test]
    fn what_cannot_be_read_is_answered_by_nothing() {
        assert!(hear(0.0, &[0xFF]).is_empty());
        let message = ToSimulator::Open { profile: b"no profile".to_vec(), line: FACTORY };
        assert_eq!(Stage::default().hear(Instant::ZERO, message), FromSimulator::default());
        assert_eq!(Stage::default().hear(Instant::ZERO, ToSimulator::Time), FromSimulator::default());
    }
}
