//! What a demonstration is given on: a simulated line with the chosen sensor, which stays what it has become.

use buslens_codec::profile::Profile;

use super::line::Line;
use super::sensor::sensor;
use super::station::Device;
use crate::time::Instant;

/// Any number will do; a fixed one makes every demonstration the same.
const SEED: u64 = 0x0B05_1E45;

/// One sensor for each profile that was ever chosen, each alone on a line of its own. A sensor keeps what was written to it
/// when the host's port is closed or another sensor is chosen, as one that stays under power does.
#[derive(Default)]
pub struct Demonstration {
    lines: Vec<Demonstrated>,
}

struct Demonstrated {
    /// The packed profile that the sensor is made of.
    profile: Vec<u8>,
    line: Line<Box<dyn Device>>,
}

impl Demonstration {
    /// The line with the sensor that a packed profile describes; at first it has its factory settings. `None` if the
    /// profile cannot be read.
    pub fn line(&mut self, now: Instant, packed: &[u8]) -> Option<&mut Line<Box<dyn Device>>> {
        let known = self.lines.iter().position(|shown| shown.profile == packed);
        if known.is_none() {
            let line = Line::new([sensor(Profile::unpack(packed)?, now)], SEED);
            self.lines.push(Demonstrated { profile: packed.to_vec(), line });
        }
        let at = known.unwrap_or(self.lines.len() - 1);
        self.lines.get_mut(at).map(|shown| &mut shown.line)
    }
}

#[cfg(test)]
mod tests {
    use buslens_codec::profile::BUILT_IN;

    use super::*;

    #[test]
    fn a_sensor_stays_what_it_has_become() {
        let packed: Vec<_> = BUILT_IN.iter().map(|text| Profile::from_json(text).unwrap().pack()).collect();
        let mut demonstration = Demonstration::default();
        let mut settings = |at: usize, second: u64, preset: &[(u16, u16)]| {
            let line = demonstration.line(Instant::from_micros(second * 1_000_000), &packed[at]).unwrap();
            let sensor = line.device_mut(0).unwrap();
            assert!(preset.iter().all(|&(register, value)| sensor.preset(register, value)));
            sensor.line()
        };
        let factory: Vec<_> = (0..packed.len()).map(|at| settings(at, 1, &[])).collect();
        for (at, register) in (0..packed.len()).filter_map(|at| {
            let profile = Profile::unpack(&packed[at])?;
            Some((at, profile.points.iter().find(|point| point.id == "baud")?.register))
        }) {
            let changed = settings(at, 2, &[(register, 5)]);
            assert_ne!(changed, factory[at]);
            for other in 0..packed.len() {
                settings(other, 3, &[]);
            }
            assert_eq!(settings(at, 4, &[]), changed);
        }
        assert!(demonstration.line(Instant::ZERO, b"no profile").is_none());
    }
}
