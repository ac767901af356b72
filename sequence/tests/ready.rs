//! The ready-made acceptance tests, run against the simulated sensors through a real master.

mod common;

use std::time::Duration;

use buslens_bus::sim::{Course, Device, GaugeCable, Level, Lvdt, Motion, Reply};
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode};
use buslens_sequence::{Ended, Mark, READY, Report, Verdict};
use common::{Bench, START, failed, line_of, profile};

fn ready(id: &str) -> &'static str {
    READY.iter().find(|text| text.contains(&format!("\ndevice {id}\n"))).unwrap()
}

#[track_caller]
fn assert_passed(report: &Report) {
    assert_eq!(failed(report), [], "{:#?}", report.summary);
    assert_eq!((report.summary.verdict, report.summary.ended), (Verdict::Passed, Some(Ended::Finished)));
    assert!(report.summary.passed > 20 && report.summary.left_out == 0);
}

#[test]
fn the_lvdt_passes_and_is_written_twice() {
    for answers_at_new_settings in [false, true] {
        let mut sensor = Lvdt::new(1, Motion::Swing);
        sensor.answers_at_new_settings = answers_at_new_settings;
        let mut bench = Bench::new(profile("lvdt"), sensor);
        assert_passed(&bench.run(ready("lvdt")));
        assert_eq!(bench.sensor().flash_writes(), 2);
    }
}

#[test]
fn the_gauge_cable_passes_and_keeps_its_record() {
    let mut bench = Bench::new(profile("gauge-cable"), GaugeCable::new(1, Course::Swing, START));
    assert_passed(&bench.run(ready("gauge-cable")));
}

#[test]
fn the_level_transmitter_passes_also_where_it_answers_single_registers_only() {
    for answers_blocks in [false, true] {
        let mut sensor = Level::new(1, Course::Swing);
        sensor.answers_blocks = answers_blocks;
        let mut bench = Bench::new(profile("level"), sensor);
        let report = bench.run(ready("level"));
        assert_passed(&report);
        let logged = report.entries.iter().find(|entry| entry.text.starts_with("Range"));
        assert_eq!(logged.unwrap().text, "Range 0.000 mH₂O to 10.000 mH₂O, unit mH₂O, zero offset 0.000 mH₂O");
    }
}

#[test]
fn each_passes_with_every_setting_that_the_device_can_have() {
    let text = ready("lvdt");
    for (rate, other_rate) in [(1u8, 5), (5, 4), (6, 5)] {
        let mut sensor = Lvdt::new(1, Motion::Swing);
        assert!(sensor.preset(0x3F, rate.into()));
        let mut bench = Bench::new(profile("lvdt"), sensor);
        let report = bench.run(text);
        assert_passed(&report);
        let other = report.entries.iter().flat_map(|entry| &entry.exchanges);
        let written = other.filter(|exchange| exchange.sent.get(1..4) == Some(&[0x10, 0x00, 0x3F]));
        let written: Vec<u8> = written.map(|exchange| exchange.sent[8]).collect();
        // The value that no table knows, another one, the old one.
        assert_eq!(written, [7, other_rate, rate]);
    }
    let mut sensor = Level::new(1, Course::Swing);
    for (register, value) in [(3, 1), (5, 0xFF9C), (6, 2000), (0xC, 5), (2, 1)] {
        assert!(sensor.preset(register, value));
    }
    assert_passed(&Bench::new(profile("level"), sensor).run(ready("level")));
}

/// A device whose replies are changed on their way.
struct Mutant<D> {
    inner: D,
    change: fn(&[u8], &mut Vec<u8>),
    deaf_to_broadcast: bool,
}

impl<D: Device> Device for Mutant<D> {
    fn line(&self) -> LineSettings {
        self.inner.line()
    }

    fn mode(&self) -> Mode {
        self.inner.mode()
    }

    fn is_listening(&self, now: Instant) -> bool {
        self.inner.is_listening(now)
    }

    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
        if self.deaf_to_broadcast && unit == UnitId::BROADCAST {
            return None;
        }
        let mut reply = self.inner.serve(now, unit, pdu)?;
        (self.change)(pdu, &mut reply.pdu);
        Some(reply)
    }
}

#[track_caller]
fn fails_at(id: &str, device: impl Device, change: fn(&[u8], &mut Vec<u8>), lines: &[&str]) -> Report {
    let mut bench = Bench::new(profile(id), Mutant { inner: device, change, deaf_to_broadcast: false });
    let report = bench.run(ready(id));
    let mut found: Vec<u32> = failed(&report).iter().map(|(line, _)| *line).collect();
    found.dedup();
    let text: Vec<&str> = ready(id).lines().map(str::trim).collect();
    let found: Vec<&str> = found.iter().map(|line| text[*line as usize - 1]).collect();
    assert_eq!(found, lines, "{:#?}", failed(&report));
    assert_eq!(report.summary.verdict, Verdict::Failed);
    report
}

#[test]
fn a_sensor_that_measures_nonsense_fails_at_its_values() {
    // 8000 mm.
    let nonsense: fn(&[u8], &mut Vec<u8>) = |asked, reply| {
        if asked.first() == Some(&4) && reply.len() == 10 {
            reply[6..8].copy_from_slice(&8000u16.to_be_bytes());
        }
    };
    let text = "expect displacement between -100 mm and 100 mm";
    let report = fails_at("lvdt", Lvdt::new(1, Motion::Swing), nonsense, &[text, text]);
    let compared = failed(&report)[0].1.compared.clone().unwrap();
    assert!(compared.found.starts_with("8000.") && compared.found.ends_with(" mm"), "{compared:?}");
    assert_eq!(compared.wanted, ["-100 mm", "100 mm"]);
}

#[test]
fn a_sensor_that_answers_what_it_should_refuse_fails_there() {
    let takes_all: fn(&[u8], &mut Vec<u8>) = |asked, reply| {
        if asked == [4, 0, 4, 0, 1] {
            *reply = vec![4, 2, 0, 0];
        }
    };
    let report = fails_at("lvdt", Lvdt::new(1, Motion::Swing), takes_all, &["expect exception 02"]);
    assert_eq!(failed(&report).len(), 1);
}

#[test]
fn a_setting_that_does_not_stay_fails_where_it_is_read_back() {
    let forgets: fn(&[u8], &mut Vec<u8>) = |asked, reply| {
        if asked == [3, 0, 0x3F, 0, 1] {
            reply[3] = 4;
        }
    };
    fails_at("lvdt", Lvdt::new(1, Motion::Swing), forgets, &["expect sample_rate = 20"]);
}

#[test]
fn a_record_that_is_not_kept_fails_at_the_maximum() {
    let forgets: fn(&[u8], &mut Vec<u8>) = |asked, reply| {
        if asked == [3, 1, 0, 0, 2] {
            *reply = vec![3, 4, 1, 0, 0xFF, 0xFF];
        }
    };
    let report = fails_at("gauge-cable", GaugeCable::new(1, Course::Swing, START), forgets, &["expect maximum >= now"]);
    assert_eq!(failed(&report)[0].1.compared.as_ref().unwrap().found, "-65.535 mm");
}

#[test]
fn a_transmitter_beyond_its_range_fails_at_its_value() {
    let beyond: fn(&[u8], &mut Vec<u8>) = |asked, reply| {
        if asked == [3, 0, 4, 0, 1] {
            reply[2..4].copy_from_slice(&12_000u16.to_be_bytes());
        }
    };
    let line = "expect value between range_zero + zero_offset and range_full + zero_offset";
    let report = fails_at("level", Level::new(1, Course::Swing), beyond, &[line]);
    let compared = failed(&report)[0].1.compared.clone().unwrap();
    assert_eq!((compared.found.as_str(), compared.wanted[1].as_str()), ("12.000 mH₂O", "10.000 mH₂O"));
}

#[test]
fn a_slow_sensor_fails_at_the_round_trip_alone() {
    struct Slow(Lvdt);
    impl Device for Slow {
        fn line(&self) -> LineSettings {
            self.0.line()
        }
        fn mode(&self) -> Mode {
            self.0.mode()
        }
        fn is_listening(&self, now: Instant) -> bool {
            self.0.is_listening(now)
        }
        fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
            let reply = self.0.serve(now, unit, pdu)?;
            Some(Reply { after: Duration::from_millis(150), ..reply })
        }
    }
    let report = Bench::new(profile("lvdt"), Slow(Lvdt::new(1, Motion::Swing))).run(ready("lvdt"));
    let lines: Vec<u32> = failed(&report).iter().map(|(line, _)| *line).collect();
    assert_eq!(lines, [line_of(ready("lvdt"), "expect round trip < 100 ms")]);
}

#[test]
fn a_sensor_that_is_not_there_fails_everywhere_and_ends() {
    let mut absent = Lvdt::new(1, Motion::Swing);
    absent.power_cycle(START + Duration::from_secs(100_000));
    let report = Bench::new(profile("lvdt"), absent).run(ready("lvdt"));
    assert_eq!((report.summary.verdict, report.summary.ended), (Verdict::Failed, Some(Ended::Finished)));
    let silence = line_of(ready("lvdt"), "expect silence");
    let passed = report.entries.iter().filter(|entry| entry.mark == Mark::Passed).map(|entry| entry.line);
    assert!(passed.into_iter().any(|line| line == silence));
}
