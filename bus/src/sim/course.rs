//! How a measured value goes with time.

/// How a measured value goes with time, in the unit of its last digit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// It stays.
    Rest(i32),
    /// It swings slowly through most of the sensor's range, with a little ripple.
    Swing,
}

/// A smooth swing of +-`amplitude` with a period of `period` microseconds: two parabolas, close to a sine.
pub(super) fn swing(micros: u64, period: u64, amplitude: i32) -> i32 {
    let half = period / 2;
    let phase = micros % period;
    let (x, sign) = if phase < half { (phase, 1) } else { (phase - half, -1) };
    let height = i128::from(x) * i128::from(half.saturating_sub(x)) * 4 * i128::from(amplitude);
    sign * i32::try_from(height / (i128::from(half) * i128::from(half)).max(1)).unwrap_or(0)
}
