//! What the window is told, gathered from what the master tells.

use std::collections::VecDeque;
use std::time::Duration;

use buslens_bus::time::Instant;
use buslens_bus::{Answer, Counters, Exchange, Failure};
use buslens_codec::pdu::{Response, unpack_bits};
use buslens_codec::profile::{Known, Profile};
use buslens_codec::value::Value;

use crate::message::{Frames, Health, Link, Reading, Sample, Status, Trouble};

/// One miss is normal on a real line; this many in a row are told.
const MISSES: u32 = 2;
/// The rate is counted over so much time, or over three periods if they take longer.
const RATE_WINDOW: Duration = Duration::from_secs(3);

pub(super) struct Progress {
    /// Whose registers they are, where that is known.
    profile: Option<Profile>,
    known: Known,
    period: Duration,
    status: Status,
    changed: bool,
    misses: u32,
    /// Before this the device may still be starting and owes no answer.
    patient_until: Instant,
    rounds: VecDeque<Instant>,
}

impl Progress {
    pub(super) fn new(profile: Option<Profile>, period: Duration) -> Self {
        Self {
            profile,
            known: Known::default(),
            period,
            status: Status::default(),
            changed: true,
            misses: 0,
            patient_until: Instant::ZERO,
            rounds: VecDeque::new(),
        }
    }

    pub(super) fn has_news(&self) -> bool {
        self.changed
    }

    /// The status as of now. Samples are given out once.
    pub(super) fn status(&mut self, now: Instant, counters: Counters) -> Status {
        self.changed = false;
        self.status.counters = counters;
        self.status.rate_hz = self.rate_hz(now);
        let samples = std::mem::take(&mut self.status.samples);
        Status { samples, ..self.status.clone() }
    }

    pub(super) fn link_changed(&mut self, now: Instant, link: Link) {
        self.changed = true;
        if link == Link::Open {
            self.misses = 0;
            let silence_ms = self.profile.as_ref().map_or(0, |profile| profile.timing.startup_silence_ms);
            self.patient_until = now + Duration::from_millis(silence_ms.into());
        }
        self.status.health = Health::Waiting;
        self.status.round_trip_us = None;
        self.rounds.clear();
        self.status.link = link;
    }

    pub(super) fn polled(&mut self, index: usize, exchange: &Exchange) {
        self.changed = true;
        self.status.exchange = Some(Frames { sent: exchange.sent.clone(), received: exchange.received.clone() });
        if let Some(round_trip) = exchange.round_trip {
            self.status.round_trip_us = u32::try_from(round_trip.as_micros()).ok();
        }
        match &exchange.result {
            Ok(Answer::Reply(response)) => self.answered(index, exchange.at, response),
            Ok(Answer::BroadcastSent | Answer::Heard) => {}
            Err(failure) => self.failed(exchange.at, failure),
        }
    }

    fn answered(&mut self, index: usize, at: Instant, response: &Response) {
        let Some(profile) = &self.profile else { return };
        let groups = profile.live_groups();
        let Some(group) = groups.get(index) else { return };
        let is_last = index + 1 == groups.len();
        let points = match response {
            Response::ReadHoldingRegisters { values } | Response::ReadInputRegisters { values } => {
                profile.decode_points(group.function, group.address, values, &mut self.known)
            }
            Response::ReadCoils { status } | Response::ReadDiscreteInputs { status } => {
                profile.decode_bits(group.function, group.address, &unpack_bits(status, group.quantity.into()))
            }
            _ => return,
        };
        if points.iter().any(|point| point.value.is_err()) {
            self.status.health = Health::Failing(Trouble::BadValue);
            return;
        }
        // A number without its scale is no reading.
        let values: Vec<(String, Value)> = points
            .into_iter()
            .filter(|point| point.scaled)
            .filter_map(|point| Some((point.point.id.clone(), point.value.ok()?)))
            .collect();
        for (point, value) in values {
            self.read(at, &point, value);
        }
        self.misses = 0;
        self.status.health = Health::Reading;
        // A round is done with its last group.
        if is_last {
            self.rounds.push_back(at);
        }
    }

    fn read(&mut self, at: Instant, point: &str, value: Value) {
        if let Some(number) = value.to_f64() {
            #[allow(clippy::cast_precision_loss)] // exact for centuries
            let at_s = at.as_micros() as f64 / 1e6;
            self.status.samples.push(Sample { point: point.to_owned(), at_s, value: number });
        }
        match self.status.readings.iter_mut().find(|reading| reading.point == point) {
            Some(reading) => reading.value = value,
            None => self.status.readings.push(Reading { point: point.to_owned(), value }),
        }
    }

    fn failed(&mut self, at: Instant, failure: &Failure) {
        let trouble = match failure {
            Failure::NoAnswer { heard, line_errors: 0 } if heard.is_empty() => Trouble::Silence,
            Failure::NoAnswer { .. } => Trouble::Garbage,
            Failure::BadCheck { .. } => Trouble::BadCheck,
            Failure::Doubtful => Trouble::Late,
            Failure::Exception { function, code } => {
                // The device is there and says no: nothing to wait for.
                let trouble = Trouble::Exception { function: *function, code: *code };
                self.status.health = Health::Failing(trouble);
                return;
            }
            Failure::Unproven | Failure::LinkLost | Failure::ReadOnly | Failure::Invalid(_) => return,
        };
        self.misses += 1;
        if self.misses >= MISSES && at >= self.patient_until {
            self.status.health = Health::Failing(trouble);
        }
    }

    fn rate_hz(&mut self, now: Instant) -> Option<f32> {
        let window = RATE_WINDOW.max(self.period * 3);
        while self.rounds.front().is_some_and(|at| now.saturating_since(*at) > window) {
            self.rounds.pop_front();
        }
        let (first, last) = (self.rounds.front()?, self.rounds.back()?);
        let seconds = last.saturating_since(*first).as_secs_f32();
        #[allow(clippy::cast_precision_loss)] // a window holds hundreds
        let intervals = (self.rounds.len() - 1) as f32;
        (seconds > 0.0).then(|| intervals / seconds)
    }
}

#[cfg(test)]
mod tests {
    use buslens_codec::pdu::ExceptionCode;

    use super::*;

    const LVDT: &str = include_str!("../../codec/profiles/lvdt.json");

    fn progress() -> Progress {
        let mut progress = Progress::new(Profile::from_json(LVDT).ok(), Duration::from_millis(100));
        progress.link_changed(Instant::ZERO, Link::Open);
        progress
    }

    fn exchange(at_ms: u64, result: Result<Answer, Failure>) -> Exchange {
        let at = Instant::from_micros(at_ms * 1000);
        Exchange { sent: vec![1], received: vec![], sent_at: at, at, round_trip: None, result }
    }

    fn reply(values: &[u16]) -> Answer {
        Answer::Reply(Response::ReadInputRegisters { values: values.to_vec() })
    }

    #[test]
    fn a_reply_becomes_readings_and_samples_that_are_given_out_once() {
        let mut progress = progress();
        progress.polled(0, &exchange(100, Ok(reply(&[0, 255, 0x8000, 0x0148]))));
        let status = progress.status(Instant::from_micros(100_000), Counters::default());
        assert_eq!(status.health, Health::Reading);
        let displacement = status.samples.iter().find(|sample| sample.point == "displacement").unwrap();
        assert!((displacement.value + 0.328).abs() < 1e-9);
        assert!(progress.status(Instant::from_micros(200_000), Counters::default()).samples.is_empty());
    }

    #[test]
    fn a_value_is_read_once_its_scale_is() {
        const LEVEL: &str = include_str!("../../codec/profiles/level.json");
        let mut progress = Progress::new(Profile::from_json(LEVEL).ok(), Duration::from_millis(500));
        let reply = |value| Ok(Answer::Reply(Response::ReadHoldingRegisters { values: vec![value] }));
        // Decimals, unit and value are three reads in this order.
        progress.polled(2, &exchange(100, reply(6000)));
        assert!(progress.status.readings.is_empty());
        progress.polled(0, &exchange(200, reply(3)));
        progress.polled(2, &exchange(300, reply(6000)));
        let value = progress.status.readings.iter().find(|reading| reading.point == "value").unwrap();
        assert_eq!(value.value.to_string(), "6.000");
    }

    #[test]
    fn a_row_of_bits_becomes_readings() {
        const PUMP: &str = r#""id": "pump", "name": { "en": "Pump", "zh": "泵" }, "register": 6, "encoding": { "type": "code" }, "read": [2], "role": "measurement""#;
        let text = LVDT.replacen("\"id\": \"temperature\"", &[PUMP, " }, { \"id\": \"temperature\""].concat(), 1);
        let profile = Profile::from_json(&text).unwrap();
        let index = profile.live_groups().iter().position(buslens_codec::profile::Group::is_bits).unwrap();
        let mut progress = Progress::new(Some(profile), Duration::from_millis(100));
        let reply = Answer::Reply(Response::ReadDiscreteInputs { status: vec![1] });
        progress.polled(index, &exchange(100, Ok(reply)));
        assert_eq!(progress.status.readings, [Reading { point: "pump".to_owned(), value: Value::Code(0xFF00) }]);
        assert_eq!(progress.status.health, Health::Reading);
    }

    #[test]
    fn one_miss_is_not_told_and_two_are_but_not_while_the_device_may_start() {
        let silence = || Err(Failure::NoAnswer { heard: vec![], line_errors: 0 });
        let mut progress = progress();
        progress.polled(0, &exchange(500, silence()));
        progress.polled(0, &exchange(1000, silence()));
        assert_eq!(progress.status.health, Health::Waiting);
        progress.polled(0, &exchange(2000, Ok(reply(&[0, 255, 0, 0]))));
        progress.polled(0, &exchange(2500, silence()));
        assert_eq!(progress.status.health, Health::Reading);
        progress.polled(0, &exchange(3000, silence()));
        assert_eq!(progress.status.health, Health::Failing(Trouble::Silence));
    }

    #[test]
    fn an_exception_is_told_at_once() {
        let mut progress = progress();
        let failure = Failure::Exception { function: 4, code: ExceptionCode::IllegalDataAddress };
        progress.polled(0, &exchange(10, Err(failure)));
        assert!(matches!(progress.status.health, Health::Failing(Trouble::Exception { function: 4, .. })));
    }

    #[test]
    fn a_value_that_the_format_does_not_allow_is_no_reading() {
        let mut progress = progress();
        progress.polled(0, &exchange(100, Ok(reply(&[0, 255, 0x0001, 1000]))));
        assert_eq!(progress.status.health, Health::Failing(Trouble::BadValue));
        assert!(progress.status.samples.is_empty());
    }
}
