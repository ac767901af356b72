//! The geometry of the trend strip: a scale with round steps, and the curve as an SVG path with one stroke a pixel
//! column, so that no peak is lost however many samples there are.

use crate::format::fixed;

/// A vertical scale whose lines stand at round values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// Value at the bottom.
    pub(crate) low: f64,
    /// Value at the top.
    pub(crate) high: f64,
    /// Distance of two lines.
    pub(crate) step: f64,
    /// Decimals that tell two lines apart.
    pub(crate) decimals: u8,
}

impl Scale {
    /// A scale of about four steps around `min..=max`, never finer than half of the point's resolution
    /// (`decimals` places).
    pub(crate) fn around(min: f64, max: f64, decimals: u8) -> Self {
        let finest = 10_f64.powi(-i32::from(decimals));
        let span = (max - min).max(finest * 4.0);
        let middle = f64::midpoint(min, max);
        let (min, max) = (middle - span / 2.0, middle + span / 2.0);
        let rough = span / 3.0;
        let mut step = finest / 10.0;
        let mut places = i32::from(decimals) + 1;
        // 1, 2, 5, 10, 20 ... from below the resolution: a dozen turns at most for a real quantity.
        let mut factors = [2.0, 2.5, 2.0].into_iter().cycle();
        let mut turns = 0;
        while step < rough && turns < 120 {
            step *= factors.next().unwrap_or(2.0);
            turns += 1;
            if turns % 3 == 0 {
                places -= 1;
            }
        }
        let low = (min / step).floor() * step;
        let high = (max / step).ceil() * step;
        Self { low, high, step, decimals: u8::try_from(places.max(0)).unwrap_or(0) }
    }

    /// The values of the lines with their labels, from the bottom up.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (f64, String)> + '_ {
        let mut next = 0_u32;
        std::iter::from_fn(move || {
            let value = self.low + f64::from(next) * self.step;
            next += 1;
            (value <= self.high + self.step / 2.0 && next < 20).then(|| (value, fixed(value, self.decimals)))
        })
    }

    /// Height above the bottom, 0 to 1 within the scale.
    pub(crate) fn height(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

/// Where the curve is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// Left edge in pixels.
    pub(crate) left: f64,
    /// Upper edge in pixels.
    pub(crate) top: f64,
    /// Width in pixels.
    pub(crate) width: f64,
    /// Height in pixels.
    pub(crate) height: f64,
    /// Time at the right edge in seconds.
    pub(crate) now_s: f64,
    /// Seconds from the left to the right edge.
    pub(crate) span_s: f64,
    /// A longer time without a sample is a gap.
    pub(crate) gap_s: f64,
}

/// The curve of samples (seconds, value; oldest first) as the `d` of an SVG path.
pub(crate) fn path(samples: impl Iterator<Item = (f64, f64)>, frame: &Frame, scale: &Scale) -> String {
    let mut path = Path { text: String::new(), pen_down: false };
    let mut column: Option<Column> = None;
    for (at_s, value) in samples {
        let age = frame.now_s - at_s;
        if age > frame.span_s || age < 0.0 {
            continue;
        }
        let x = (frame.left + frame.width * (1.0 - age / frame.span_s)).round();
        let y = frame.top + frame.height * (1.0 - scale.height(value));
        match &mut column {
            Some(open) if at_s - open.last_s > frame.gap_s => {
                path.draw(open);
                path.pen_down = false;
                column = Some(Column::new(x, y, at_s));
            }
            Some(open) if x > open.x => {
                path.draw(open);
                column = Some(Column::new(x, y, at_s));
            }
            Some(open) => open.add(y, at_s),
            None => column = Some(Column::new(x, y, at_s)),
        }
    }
    if let Some(open) = &column {
        path.draw(open);
    }
    path.text
}

/// The samples of one pixel column.
struct Column {
    x: f64,
    first: f64,
    last: f64,
    top: f64,
    bottom: f64,
    last_s: f64,
}

impl Column {
    fn new(x: f64, y: f64, at_s: f64) -> Self {
        Self { x, first: y, last: y, top: y, bottom: y, last_s: at_s }
    }

    fn add(&mut self, y: f64, at_s: f64) {
        self.last = y;
        self.top = self.top.min(y);
        self.bottom = self.bottom.max(y);
        self.last_s = at_s;
    }
}

struct Path {
    text: String,
    pen_down: bool,
}

impl Path {
    fn draw(&mut self, column: &Column) {
        if self.pen_down {
            self.to('L', column.x, column.first);
        } else {
            self.to('M', column.x, column.first);
            // A lone sample is a dot: a stroke without length has round ends.
            self.text.push_str("h0");
            self.pen_down = true;
        }
        if column.top < column.bottom {
            for y in [column.top, column.bottom, column.last] {
                self.text.push('V');
                self.number(y);
            }
        }
    }

    fn to(&mut self, command: char, x: f64, y: f64) {
        self.text.push(command);
        self.number(x);
        self.text.push(' ');
        self.number(y);
    }

    fn number(&mut self, pixels: f64) {
        self.text.push_str(&pixel(pixels));
    }
}

/// A length for SVG: tenths of a pixel, with a plain hyphen as its minus.
pub(crate) fn pixel(length: f64) -> String {
    fixed(length, 1).replace('\u{2212}', "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame =
        Frame { left: 0.0, top: 0.0, width: 100.0, height: 100.0, now_s: 60.0, span_s: 60.0, gap_s: 1.0 };

    fn unit_scale() -> Scale {
        Scale { low: 0.0, high: 1.0, step: 0.5, decimals: 1 }
    }

    #[test]
    fn scales_have_round_steps_and_hold_the_data() {
        for (min, max, decimals) in
            [(-12.003, 12.4, 3), (0.0, 0.0, 3), (25.4, 25.6, 1), (-311.3, -311.3, 3), (0.0, 6e6, 0)]
        {
            let scale = Scale::around(min, max, decimals);
            assert!(scale.low <= min && max <= scale.high, "{scale:?}");
            let lines: Vec<_> = scale.lines().collect();
            assert!((3..=7).contains(&lines.len()), "{scale:?} {lines:?}");
            let mut labels: Vec<_> = lines.iter().map(|(_, label)| label).collect();
            labels.dedup();
            assert_eq!(labels.len(), lines.len(), "{lines:?}");
            let mantissa = scale.step / 10_f64.powf(scale.step.log10().floor());
            assert!([1.0, 2.0, 5.0, 10.0].iter().any(|round| (mantissa - round).abs() < 1e-6), "{scale:?}");
        }
    }

    #[test]
    fn a_column_keeps_its_peaks() {
        let samples = [(30.0, 0.5), (30.01, 1.0), (30.02, 0.0), (30.03, 0.5)];
        assert_eq!(path(samples.into_iter(), &FRAME, &unit_scale()), "M50.0 50.0h0V0.0V100.0V50.0");
    }

    #[test]
    fn silence_is_a_gap_not_a_line() {
        let samples = [(10.0, 0.0), (10.6, 1.0), (30.0, 0.0)];
        assert_eq!(path(samples.into_iter(), &FRAME, &unit_scale()), "M17.0 100.0h0L18.0 0.0M50.0 100.0h0");
    }

    #[test]
    fn what_is_older_than_the_strip_is_left_out() {
        assert_eq!(path([(-1.0, 0.5)].into_iter(), &FRAME, &unit_scale()), "");
    }
}
