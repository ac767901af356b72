//! Every way in which a procedure ends that is no plain success.

mod common;

use std::time::Duration;

use buslens_bus::sim::{Device as Sim, Lvdt, Motion, Reply};
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_configure::{
    Edit, Ending, Hazard, Phase, Procedure, Reach, Read, Refusal, Scope, StepOutcome, StepState, Task, Unfit, Way,
};
use common::{Bench, Trouble, file, sensor};

const FIVE: &[(&str, &str)] =
    &[("sample_rate", "50"), ("address", "9"), ("parity", "none"), ("baud", "115200"), ("output_mode", "ASCII")];

/// An LVDT with a fault of its own.
struct Faulty {
    lvdt: Lvdt,
    /// Writes to this register are refused by this exception.
    refuses: Option<(u16, u8)>,
    /// Writes to this register are acknowledged and forgotten.
    ignores: Option<u16>,
    /// After a write to this register it is dead.
    dies: Option<u16>,
    dead: bool,
    /// So many of the next writes never reach it.
    deaf_to: u32,
}

impl Faulty {
    fn new() -> Self {
        let lvdt = Lvdt::new(1, Motion::Rest { micrometres: -328, decidegrees: 255 });
        Self { lvdt, refuses: None, ignores: None, dies: None, dead: false, deaf_to: 0 }
    }
}

impl Sim for Faulty {
    fn line(&self) -> LineSettings {
        self.lvdt.line()
    }

    fn mode(&self) -> Mode {
        self.lvdt.mode()
    }

    fn is_listening(&self, now: Instant) -> bool {
        !self.dead && self.lvdt.is_listening(now)
    }

    fn serve(&mut self, now: Instant, unit: UnitId, pdu: &[u8]) -> Option<Reply> {
        let written = match *pdu {
            [0x10, high, low, ..] => Some(u16::from_be_bytes([high, low])),
            _ => None,
        };
        if matches!(pdu, [5 | 0x10, ..]) && self.deaf_to > 0 {
            self.deaf_to -= 1;
            return None;
        }
        let mut copy = self.lvdt.clone();
        let reply = self.lvdt.serve(now, unit, pdu)?;
        if written.is_some() && written == self.ignores {
            self.lvdt = copy;
        } else if let Some((_, code)) = self.refuses.filter(|(register, _)| written == Some(*register)) {
            let refused = Reply { pdu: vec![0x90, code], line: copy.line(), mode: copy.mode(), ..reply };
            std::mem::swap(&mut self.lvdt, &mut copy);
            return Some(refused);
        } else if written.is_some() && written == self.dies {
            self.dead = true;
            return None;
        }
        Some(reply)
    }

    fn power_cycle(&mut self, now: Instant) {
        self.lvdt.power_cycle(now);
    }
}

fn faulty(change: impl FnOnce(&mut Faulty)) -> Bench<Faulty> {
    let mut device = Faulty::new();
    change(&mut device);
    Bench::new(file("lvdt"), [device])
}

fn lvdt(preset: &[(u16, u16)]) -> Box<dyn Sim> {
    let mut lvdt = Lvdt::new(1, Motion::Rest { micrometres: 1, decidegrees: 1 });
    assert!(preset.iter().all(|(register, value)| lvdt.preset(*register, *value)));
    Box::new(lvdt)
}

fn factory(unit: u8) -> Reach {
    Reach { unit: UnitId(unit), line: LineSettings::new(9600, Parity::Even), mode: Mode::Rtu }
}

#[test]
fn a_refused_step_undoes_everything_before_it() {
    for register in [0x3F, 0x30, 0x60, 0x32, 0x31] {
        let mut bench = faulty(|device| device.refuses = Some((register, 4)));
        let report = bench.apply(FIVE);
        let Ending::RolledBack(why) = &report.ending else { panic!("{register:#x}: {:?}", report.ending) };
        assert_eq!(why.outcome, StepOutcome::Refused(4));
        assert_eq!(report.reach, Some(factory(1)));
        let (_, held) = bench.truth(0);
        assert_eq!((held["sample_rate"][0], held["address"][0], held["baud"][0]), (4, 1, 3));
        bench.assert_true(&report);
        bench.assert_polls(&report);
    }
}

#[test]
fn a_value_that_is_acknowledged_and_not_held_is_found_out() {
    for register in [0x3F, 0x30, 0x60, 0x32, 0x31] {
        let mut bench = faulty(|device| device.ignores = Some(register));
        let report = bench.apply(FIVE);
        let Ending::RolledBack(why) = &report.ending else { panic!("{register:#x}: {:?}", report.ending) };
        assert!(matches!(why.outcome, StepOutcome::NotHeld(Read::Registers(_))), "{register:#x}: {why:?}");
        bench.assert_true(&report);
        bench.assert_polls(&report);
    }
}

#[test]
fn a_dead_device_is_told_with_where_it_may_be_and_comes_back_with_its_power() {
    for (register, way) in [(0x3F, Way::Finish), (0x30, Way::Undo), (0x31, Way::Finish), (0x60, Way::Undo)] {
        let mut bench = faulty(|device| device.dies = Some(register));
        let report = bench.apply(FIVE);
        assert!(matches!(&report.ending, Ending::Lost(_)), "{register:#x}: {:?}", report.ending);
        assert_eq!(report.reach, None);
        let place = bench.truth(0).0;
        assert!(report.candidates.iter().take(2).any(|reach| *reach == place), "{:?}", report.candidates);
        // Nobody answers: the journal stays.
        let report = bench.recover(way);
        assert_eq!((&report.ending, report.reach), (&Ending::NotFound { garbled: false }, None));
        assert!(report.candidates.contains(&place) && report.journal.is_some());
        (bench.sensor().dead, bench.sensor().dies) = (false, None);
        let report = bench.recover(way);
        let wanted = if way == Way::Finish { Ending::Done } else { Ending::Undone };
        assert_eq!(report.ending, wanted, "{register:#x}");
        bench.assert_true(&report);
        bench.assert_polls(&report);
        assert!(bench.journals.is_empty());
    }
}

#[test]
fn a_place_where_somebody_answers_is_not_taken() {
    // Unit 9 at the same line; unit 1 at the line that it will have; unit 9 at both of the new ones.
    for (other, typed) in [
        (lvdt(&[(0x30, 9)]), &[("address", "9")][..]),
        (lvdt(&[(0x31, 7)]), &[("baud", "115200")][..]),
        (lvdt(&[(0x30, 9), (0x31, 7)]), &[("address", "9"), ("baud", "115200")][..]),
        (lvdt(&[(0x60, 2)]), &[("output_mode", "ASCII")][..]),
    ] {
        let mut bench = Bench::new(file("lvdt"), [sensor("lvdt"), other]);
        let report = bench.apply(typed);
        assert!(matches!(report.ending, Ending::Occupied(_)), "{typed:?}: {:?}", report.ending);
        assert_eq!((report.writes, report.reach), (0, Some(factory(1))));
        bench.assert_true(&report);
        bench.assert_polls(&report);
    }
}

#[test]
fn a_device_joins_a_line_whose_others_have_the_factorys_unit_id() {
    let mut bench = Bench::new(file("lvdt"), [sensor("lvdt"), lvdt(&[(0x31, 7)])]);
    let report = bench.apply(&[("address", "9"), ("baud", "115200")]);
    assert_eq!(report.ending, Ending::Done);
    bench.assert_true(&report);
    bench.assert_polls(&report);
}

#[test]
fn settings_that_the_port_refuses_are_never_written() {
    let mut bench = Bench::of("lvdt");
    bench.refuses = vec![115_200];
    let report = bench.apply(&[("sample_rate", "50"), ("baud", "115200")]);
    let there = Reach { line: LineSettings::new(115_200, Parity::Even), ..factory(1) };
    assert_eq!((&report.ending, report.writes), (&Ending::PortRefuses(there), 0));
    bench.assert_true(&report);
    bench.assert_polls(&report);
}

#[test]
fn nothing_is_written_that_was_not_confirmed_kept_or_let_out() {
    let mut bench = Bench::of("lvdt");
    let before = bench.read();
    let edits = vec![bench.edit("baud", "2400", &before), bench.edit("factory_reset", "reset and restart", &before)];
    let confirmed = vec![Hazard::SlowBaud { baud: 2400 }];
    let report = bench.carry_out(Task::Apply { before: before.clone(), edits, confirmed });
    let open = Hazard::Defaults { point: "factory_reset".to_owned() };
    assert_eq!((report.ending, report.writes), (Ending::Unconfirmed(vec![open]), 0));

    bench.keeps_journals = false;
    let report = bench.apply(FIVE);
    assert_eq!((&report.ending, report.writes, report.journal), (&Ending::NotKept, 0, None));
    bench.assert_polls(&report);
    bench.keeps_journals = true;

    bench.read_only = true;
    bench.master.set_read_only(true);
    assert_eq!(bench.apply(FIVE).ending, Ending::ReadOnly);
    // Also where nobody has told so before.
    bench.read_only = false;
    let report = bench.apply(FIVE);
    assert_eq!((&report.ending, report.writes, report.journal), (&Ending::ReadOnly, 0, None));
    bench.assert_polls(&report);
    bench.master.set_read_only(false);

    let wrong = Edit { point: "baud".to_owned(), registers: vec![8] };
    let report = bench.apply_edits(before, vec![wrong]);
    let refused = vec![Refusal { point: "baud".to_owned(), why: Unfit::NotInTable }];
    assert_eq!((report.ending, report.writes), (Ending::Refused(refused), 0));
    assert!(bench.audit.is_empty() && bench.journals.is_empty());
}

#[test]
fn a_device_that_is_not_as_it_was_shown_is_not_written() {
    let mut bench = Bench::new(file("lvdt"), [Lvdt::new(1, Motion::Rest { micrometres: 1, decidegrees: 1 })]);
    let before = bench.read();
    let edits = vec![bench.edit("sample_rate", "50", &before)];
    assert!(bench.sensor().preset(0x3F, 1));
    let report = bench.apply_edits(before, edits);
    let Ending::Differs(differences) = &report.ending else { panic!("{:?}", report.ending) };
    assert_eq!(differences[0].left, Some(Read::Registers(vec![4])));
    assert_eq!(differences[0].right, Some(Read::Registers(vec![1])));
    assert_eq!(report.writes, 0);
    bench.assert_true(&report);
    bench.assert_polls(&report);
}

#[test]
fn what_changes_nothing_is_not_written() {
    let mut bench = Bench::of("lvdt");
    let report = bench.apply(&[("sample_rate", "10"), ("baud", "9600")]);
    assert_eq!((report.ending, report.writes, report.steps.len()), (Ending::Done, 0, 0));
}

#[test]
fn a_silent_device_is_not_written() {
    let mut bench = faulty(|device| device.dead = true);
    bench.sensor().dead = false;
    let before = bench.read();
    bench.sensor().dead = true;
    let edits = vec![bench.edit("sample_rate", "50", &before)];
    let report = bench.apply_edits(before, edits);
    assert_eq!((&report.ending, report.reach, report.writes), (&Ending::NoAnswer, None, 0));
    assert_eq!(bench.carry_out(Task::Read).ending, Ending::NoAnswer);
}

/// Cancels as soon as the procedure writes this step, and once more if that is wished.
fn cancelled(bench: &mut Bench, at_step: u32, twice: bool) -> buslens_configure::Report {
    let before = bench.read();
    let edits: Vec<Edit> = FIVE.iter().map(|(point, text)| bench.edit(point, text, &before)).collect();
    let mut procedure = bench.begin(Task::Apply { before, edits, confirmed: Vec::new() });
    let limit = bench.now + Duration::from_mins(1);
    let mut wishes = 0;
    while procedure.as_ref().is_some_and(|procedure| !procedure.has_ended()) {
        let phase = bench.told.last().map(|told| &told.phase);
        let wish = match phase {
            Some(Phase::Writing { step }) => wishes == 0 && *step == at_step,
            Some(Phase::Undoing { .. }) => wishes == 1 && twice,
            _ => false,
        };
        if let Some(procedure) = procedure.as_mut().filter(|_| wish) {
            procedure.cancel(bench.now);
            wishes += 1;
        }
        bench.settle(&mut procedure);
        assert!(procedure.as_ref().is_some_and(Procedure::has_ended) || bench.step(&mut procedure, limit));
    }
    assert_eq!(wishes, if twice { 2 } else { 1 });
    bench.run(procedure).unwrap()
}

#[test]
fn a_cancelled_transaction_leaves_the_device_as_it_was() {
    for step in 0..5 {
        let mut bench = Bench::of("lvdt");
        let report = cancelled(&mut bench, step, false);
        assert_eq!((&report.ending, report.reach), (&Ending::Cancelled, Some(factory(1))), "{step}");
        bench.assert_true(&report);
        bench.assert_polls(&report);
    }
}

#[test]
fn a_cancelled_undoing_leaves_the_journal_open() {
    let mut bench = Bench::of("lvdt");
    let report = cancelled(&mut bench, 3, true);
    assert!(matches!(report.ending, Ending::Partly(_) | Ending::Lost(_)), "{:?}", report.ending);
    assert!(report.journal.is_some());
    bench.assert_true(&report);
    let report = bench.recover(Way::Undo);
    assert_eq!(report.ending, Ending::Undone);
    bench.assert_true(&report);
    bench.assert_polls(&report);
}

#[test]
fn a_failure_behind_a_command_undoes_nothing_that_may_have_been_saved() {
    // The transmitter saves, then does not restore.
    let mut bench = Bench::of("level");
    let before = bench.read();
    let typed =
        [("zero_offset", "0.025"), ("save", "to the user area"), ("restore_factory", "restore factory settings")];
    let edits: Vec<Edit> = typed.iter().map(|(point, text)| bench.edit(point, text, &before)).collect();
    bench.trouble_after(1, Trouble::ReplyLost);
    let report = bench.apply_edits(before, edits);
    let Ending::Unproven(why) = &report.ending else { panic!("{:?}", report.ending) };
    assert_eq!(why.step, 1);
    assert_eq!(report.steps[0].outcome, StepOutcome::Confirmed);
    assert_eq!(report.steps[2].outcome, StepOutcome::Waiting);
    bench.assert_true(&report);
}

#[test]
fn a_forgotten_device_is_found_wherever_it_is() {
    for preset in [&[(0x30, 77), (0x31, 1), (0x32, 1), (0x60, 2)][..], &[(0x31, 7), (0x32, 3)][..]] {
        let mut bench = Bench::new(file("lvdt"), [lvdt(preset)]);
        let scope = Scope { reaches: vec![factory(1)], everywhere: true, units: Vec::new() };
        let report = bench.carry_out(Task::Find { scope });
        assert_eq!(report.ending, Ending::Found);
        assert!(bench.told.iter().any(|told| told.left_ms.is_some_and(|left| left > 1000) && told.total >= 42));
        bench.assert_true(&report);
        bench.assert_polls(&report);
    }
}

#[test]
fn a_device_that_answers_no_broadcast_is_found_by_its_unit_ids() {
    let mut bench = Bench::of("level");
    assert_eq!(bench.apply(&[("address", "200"), ("baud", "1200")]).ending, Ending::Done);
    let scope = |units: &[u8]| Scope {
        reaches: Vec::new(),
        everywhere: true,
        units: units.iter().copied().map(UnitId).collect(),
    };
    let former = bench.device.reach;
    bench.device.slowest_us = 0;
    let report = bench.carry_out(Task::Find { scope: scope(&[1, 2]) });
    assert_eq!(report.ending, Ending::NotFound { garbled: false });
    // The port is as it was.
    assert_eq!(bench.device.reach, former);
    assert!(bench.poll_for(Duration::from_secs(5)) > 2);
    let report = bench.carry_out(Task::Find { scope: scope(&[1, 200]) });
    assert_eq!(report.ending, Ending::Found);
    bench.assert_true(&report);
    bench.assert_polls(&report);
}

#[test]
fn a_search_skips_settings_that_the_port_refuses() {
    let mut bench = Bench::new(file("lvdt"), [lvdt(&[(0x31, 2)])]);
    bench.refuses = vec![2400, 115_200, 19_200];
    let scope = Scope { reaches: Vec::new(), everywhere: true, units: Vec::new() };
    let report = bench.carry_out(Task::Find { scope });
    assert_eq!(report.ending, Ending::Found);
    bench.assert_polls(&report);
}

#[test]
fn a_cancelled_search_leaves_the_line_quiet_and_the_port_as_it_was() {
    let mut bench = Bench::of("lvdt");
    bench.sensor().power_cycle(Instant::from_micros(u64::MAX / 2));
    let scope = Scope { reaches: Vec::new(), everywhere: true, units: Vec::new() };
    let mut procedure = bench.begin(Task::Find { scope });
    let limit = bench.now + Duration::from_secs(5);
    while bench.step(&mut procedure, limit) {}
    procedure.as_mut().unwrap().cancel(bench.now);
    let now = bench.now;
    bench.settle(&mut procedure);
    let report = bench.run(procedure).unwrap();
    assert_eq!(report.ending, Ending::Cancelled);
    assert!(bench.now.saturating_since(now) < Duration::from_secs(2));
    assert_eq!(bench.device.reach, factory(1));
}

#[test]
fn a_restored_transmitter_is_found_by_the_procedure_itself() {
    for unit in [1, 250] {
        let level = buslens_bus::sim::Level::new(unit, buslens_bus::sim::Course::Rest(1));
        let mut bench = Bench::new(file("level"), [level]);
        bench.follow();
        assert_eq!(bench.apply(&[("address", "3"), ("baud", "57600")]).ending, Ending::Done);
        let report = bench.apply(&[("restore_factory", "restore factory settings")]);
        assert_eq!(report.ending, Ending::Done, "{unit}");
        assert_eq!(report.reach.map(|reach| reach.unit), Some(UnitId(unit)));
        bench.assert_true(&report);
        bench.assert_polls(&report);
    }
}

#[test]
fn a_reset_sensor_is_found_by_the_number_on_its_housing() {
    let mut bench = Bench::new(file("lvdt"), [Lvdt::new(42, Motion::Rest { micrometres: 1, decidegrees: 1 })]);
    bench.follow();
    assert_eq!(bench.apply(&[("address", "3"), ("baud", "57600"), ("output_mode", "ASCII")]).ending, Ending::Done);
    let report = bench.apply(&[("factory_reset", "reset and restart")]);
    assert_eq!((&report.ending, &report.steps[0].outcome), (&Ending::Done, &StepOutcome::Confirmed));
    assert_eq!(report.reach, Some(factory(42)));
    bench.assert_true(&report);
    bench.assert_polls(&report);
}

#[test]
fn a_transmitter_that_knows_no_blocks_is_read_one_by_one_and_that_is_remembered() {
    let mut level = buslens_bus::sim::Level::new(1, buslens_bus::sim::Course::Rest(1));
    level.answers_blocks = false;
    let mut bench = Bench::new(file("level"), [level]);
    let first = bench.carry_out(Task::Read);
    assert_eq!((first.ending, bench.asked), (Ending::Done, 8));
    bench.asked = 0;
    let again = bench.carry_out(Task::Read);
    assert_eq!(bench.asked, 7);
    assert_eq!(again.snapshot.unwrap().data, first.snapshot.unwrap().data);
}

#[test]
fn writes_keep_their_distance_and_every_one_is_kept_for_the_audit() {
    let mut bench = Bench::of("lvdt");
    let report = bench.apply(FIVE);
    assert_eq!((&report.ending, report.writes), (&Ending::Done, 5));
    let writes: Vec<Instant> = bench
        .sent
        .iter()
        .filter(|(_, bytes)| bytes.get(1) == Some(&0x10) || bytes.get(3..5) == Some(b"10"))
        .map(|(at, _)| *at)
        .collect();
    assert_eq!(writes.len(), 5);
    assert!(writes.windows(2).all(|pair| pair[1].saturating_since(pair[0]) >= Duration::from_millis(100)));
    let audit: Vec<(&str, u16, u16)> =
        bench.audit.iter().map(|entry| (entry.point.as_str(), entry.old.as_ref().unwrap()[0], entry.new[0])).collect();
    let wanted = [("sample_rate", 4, 6), ("address", 1, 9), ("output_mode", 1, 2), ("parity", 2, 3), ("baud", 3, 7)];
    assert_eq!(audit, wanted);
    assert!(bench.audit.iter().all(|entry| !entry.sent.is_empty() && !entry.received.is_empty()));
    assert!(bench.audit.iter().all(|entry| entry.unix_ms > common::UNIX_MS));
}

#[test]
fn the_journal_is_kept_before_the_first_byte_of_each_step() {
    let mut bench = Bench::of("lvdt");
    bench.trouble_after(2, Trouble::Reload);
    let before = bench.read();
    let edits: Vec<Edit> = FIVE.iter().map(|(point, text)| bench.edit(point, text, &before)).collect();
    let procedure = bench.begin(Task::Apply { before, edits, confirmed: Vec::new() });
    assert!(bench.run(procedure).is_none());
    let journal = bench.journals.values().next().unwrap();
    let states: Vec<StepState> = journal.steps.iter().map(|step| step.state).collect();
    let (done, open) = (StepState::Confirmed, StepState::Waiting);
    assert_eq!(states, [done, done, StepState::Sent, open, open]);
    assert_eq!(journal.candidates().len(), 5);
    assert!(journal.has_written());
}

#[test]
fn a_write_that_never_arrives_is_made_once_more_but_a_command_is_not() {
    for typed in FIVE {
        let mut bench = faulty(|device| device.deaf_to = 1);
        let report = bench.apply(&[*typed]);
        assert_eq!((&report.ending, report.writes), (&Ending::Done, 2), "{typed:?}");
        bench.assert_true(&report);
        bench.assert_polls(&report);
        let mut bench = faulty(|device| device.deaf_to = 9);
        let report = bench.apply(&[*typed]);
        assert!(matches!(report.ending, Ending::RolledBack(_)), "{typed:?}: {:?}", report.ending);
        assert_eq!(report.writes, 2);
        bench.assert_true(&report);
        bench.assert_polls(&report);
    }
    let mut bench = faulty(|_| {});
    assert_eq!(bench.apply(&[("sample_rate", "50")]).ending, Ending::Done);
    bench.sensor().deaf_to = 1;
    let report = bench.apply(&[("factory_reset", "reset and restart")]);
    // It still holds what no sensor leaves the factory with.
    let Ending::RolledBack(why) = &report.ending else { panic!("{:?}", report.ending) };
    assert_eq!((&why.outcome, report.writes), (&StepOutcome::NotDone, 1));
    bench.assert_true(&report);
    bench.assert_polls(&report);
}
