//! The simulated sensors.

use buslens_bus::sim::{Course, Device as Sim, GaugeCable, Level, Lvdt, Motion};
use buslens_bus::time::Instant;

/// A sensor of each kind with factory settings.
pub fn sensor(id: &str) -> Box<dyn Sim> {
    match id {
        "lvdt" => Box::new(Lvdt::new(1, Motion::Rest { micrometres: -328, decidegrees: 255 })),
        "gauge-cable" => Box::new(GaugeCable::new(1, Course::Rest(1234), Instant::ZERO)),
        "level" => Box::new(Level::new(1, Course::Rest(4321))),
        other => panic!("nobody simulates {other}"),
    }
}
