//! The simulated sensors, and what tests do to them beside talking with them.

use buslens_bus::sim::{Course, Described, Device as Sim, GaugeCable, Level, Lvdt, Motion, Reply};
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};

/// A sensor of each kind with factory settings.
pub fn sensor(id: &str) -> Box<dyn Simulated> {
    match id {
        "lvdt" => Box::new(Lvdt::new(1, Motion::Rest { micrometres: -328, decidegrees: 255 })),
        "gauge-cable" => Box::new(GaugeCable::new(1, Course::Rest(1234), Instant::ZERO)),
        "level" => Box::new(Level::new(1, Course::Rest(4321))),
        other => panic!("nobody simulates {other}"),
    }
}

/// What the tests do to a sensor beside talking with it.
pub trait Simulated: Sim {
    /// Its supply was cut and has come back.
    fn cut_power(&mut self, now: Instant);
}

impl Simulated for Lvdt {
    fn cut_power(&mut self, now: Instant) {
        self.power_cycle(now);
    }
}

impl Simulated for Level {
    fn cut_power(&mut self, _: Instant) {
        self.power_cycle();
    }
}

impl Simulated for GaugeCable {
    fn cut_power(&mut self, now: Instant) {
        *self = Self::new(1, Course::Rest(1234), now);
    }
}

impl Simulated for Described {
    fn cut_power(&mut self, _: Instant) {}
}

impl Sim for Box<dyn Simulated> {
    fn line(&self) -> LineSettings {
        self.as_ref().line()
    }

    fn mode(&self) -> Mode {
        self.as_ref().mode()
    }

    fn is_listening(&self, now: Instant) -> bool {
        self.as_ref().is_listening(now)
    }

    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
        self.as_mut().serve(now, unit, pdu)
    }
}

impl Simulated for Box<dyn Simulated> {
    fn cut_power(&mut self, now: Instant) {
        self.as_mut().cut_power(now);
    }
}
