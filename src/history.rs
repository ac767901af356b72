//! What has been read since connecting: statistics of all of it, and the last minute sample by sample.

use std::collections::VecDeque;

use crate::message::Sample;

/// How far back samples are kept, in seconds.
pub(crate) const SPAN_S: f64 = 60.0;

/// Every point's past.
#[derive(Debug, Default)]
pub(crate) struct History {
    series: Vec<Series>,
}

impl History {
    /// Takes new samples, oldest first.
    pub(crate) fn take(&mut self, samples: &[Sample]) {
        for sample in samples {
            let known = self.series.iter().position(|series| series.point == sample.point);
            let at = known.unwrap_or_else(|| {
                self.series.push(Series::new(&sample.point));
                self.series.len() - 1
            });
            self.series[at].push(sample.at_s, sample.value);
        }
    }

    /// The past of one point, if it has one.
    pub(crate) fn of(&self, point: &str) -> Option<&Series> {
        self.series.iter().find(|series| series.point == point)
    }

    /// Starts the statistics anew. The last minute stays.
    pub(crate) fn reset_statistics(&mut self) {
        for series in &mut self.series {
            series.statistics = None;
        }
    }
}

/// One point's past.
#[derive(Debug)]
pub(crate) struct Series {
    point: String,
    recent: VecDeque<(f64, f64)>,
    statistics: Option<Statistics>,
}

impl Series {
    fn new(point: &str) -> Self {
        Self { point: point.to_owned(), recent: VecDeque::new(), statistics: None }
    }

    fn push(&mut self, at_s: f64, value: f64) {
        if !value.is_finite() {
            return;
        }
        while self.recent.front().is_some_and(|(oldest, _)| at_s - oldest > SPAN_S) {
            self.recent.pop_front();
        }
        self.recent.push_back((at_s, value));
        match &mut self.statistics {
            Some(statistics) => statistics.add(value),
            None => self.statistics = Some(Statistics { min: value, max: value, mean: value, count: 1 }),
        }
    }

    /// Seconds and values of the last minute, oldest first.
    pub(crate) fn recent(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.recent.iter().copied()
    }

    /// When the newest sample came, in seconds.
    pub(crate) fn last_s(&self) -> Option<f64> {
        self.recent.back().map(|(at_s, _)| *at_s)
    }

    /// Since the connection was made or the statistics were reset.
    pub(crate) fn statistics(&self) -> Option<Statistics> {
        self.statistics
    }
}

/// Statistics of a point's values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Statistics {
    /// The smallest.
    pub(crate) min: f64,
    /// The largest.
    pub(crate) max: f64,
    /// The arithmetic mean, kept running so that a long time loses no digits.
    pub(crate) mean: f64,
    count: u64,
}

impl Statistics {
    fn add(&mut self, value: f64) {
        self.count += 1;
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        // A count beyond 2^53 takes ages.
        #[allow(clippy::cast_precision_loss)]
        let count = self.count as f64;
        self.mean += (value - self.mean) / count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(point: &str, at_s: f64, value: f64) -> Sample {
        Sample { point: point.to_owned(), at_s, value }
    }

    #[test]
    fn statistics_outlive_the_last_minute() {
        let mut history = History::default();
        history.take(&[sample("a", 0.0, -3.0), sample("b", 0.0, 7.0), sample("a", 1.0, 1.0)]);
        history.take(&[sample("a", 61.5, 5.0)]);
        let series = history.of("a").unwrap();
        assert_eq!(series.recent().collect::<Vec<_>>(), [(61.5, 5.0)]);
        let statistics = series.statistics().unwrap();
        assert_eq!((statistics.min, statistics.max, statistics.mean), (-3.0, 5.0, 1.0));
        assert!((history.of("b").unwrap().statistics().unwrap().mean - 7.0).abs() < 1e-12);
        assert!(history.of("c").is_none());
    }

    #[test]
    fn a_reset_keeps_the_curve() {
        let mut history = History::default();
        history.take(&[sample("a", 0.0, 1.0)]);
        history.reset_statistics();
        assert_eq!(history.of("a").unwrap().statistics(), None);
        assert_eq!(history.of("a").unwrap().recent().count(), 1);
        history.take(&[sample("a", 1.0, 2.0)]);
        assert!((history.of("a").unwrap().statistics().unwrap().min - 2.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_number_is_no_sample() {
        let mut history = History::default();
        history.take(&[sample("a", 0.0, f64::NAN)]);
        assert_eq!(history.of("a").unwrap().statistics(), None);
    }
}
