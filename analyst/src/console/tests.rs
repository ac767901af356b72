use std::time::Duration;

use buslens_bus::record::{Note, Origin, What};
use buslens_bus::time::Instant;
use buslens_codec::dissect::Direction;
use buslens_codec::line::{LineSettings, Mode, Parity};
use proptest::prelude::*;

use super::Console;
use super::playback::Playback;
use crate::line::{End, FromLine, LineState, Outcome, PortState, Signals, ToLine};
use crate::message::{FromConsole, ProfileChoice, Repeat, Sending, ToConsole, Until};

mod configuring;
mod sequences;

const LINE: LineSettings = LineSettings::new(9600, Parity::Even);
const REQUEST: [u8; 8] = [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5];
const REPLY: [u8; 7] = [0x01, 0x03, 0x02, 0x00, 0x07, 0xF9, 0x86];
const REFUSAL: [u8; 5] = [0x01, 0x83, 0x02, 0xC0, 0xF1];

fn ms(milliseconds: u64) -> Instant {
    Instant::ZERO + Duration::from_millis(milliseconds)
}

fn state(replay: bool) -> LineState {
    LineState {
        open: true,
        port: PortState::Open,
        replay,
        simulated: false,
        line: LINE,
        mode: Mode::Rtu,
        buffer_bytes: 8192,
        polling: false,
        read_only: false,
        signals: Signals::default(),
    }
}

/// A console on a line.
fn attached() -> Console {
    let mut console = Console::new();
    console.hear(ms(0), ToConsole::Attach);
    console.hear_line(ms(0), 0, FromLine::Clock(0));
    console.hear_line(ms(0), 0, FromLine::State(state(false)));
    drain(&mut console);
    console
}

fn drain(console: &mut Console) -> (Vec<ToLine>, Vec<FromConsole>) {
    while console.work() {}
    let orders = std::iter::from_fn(|| console.poll_line()).filter(|order| *order != ToLine::Clock);
    (orders.collect(), std::iter::from_fn(|| console.poll_news()).collect())
}

fn sending(id: u32, repeat: impl Into<Option<Repeat>>) -> Sending {
    Sending { id, bytes: REQUEST.to_vec(), wait_ms: None, repeat: repeat.into() }
}

fn every(every_ms: u32, times: Option<u32>, until: Until) -> Repeat {
    Repeat { every_ms, times, until }
}

fn outcome(end: End, heard: &[u8]) -> Outcome {
    Outcome { at_us: 0, heard: heard.to_vec(), round_trip_us: None, end }
}

/// Nothing more is heard for a long time.
fn be_quiet(console: &mut Console) {
    console.hear_line(ms(0), 0, FromLine::Clock(10_000_000_000));
}

#[test]
fn only_the_engine_knows_that_nothing_was_heard() {
    let mut console = attached();
    console.hear_line(ms(1), 0, FromLine::Notes(vec![Note { at_us: 1000, what: What::Received(REPLY[..3].to_vec()) }]));
    // The rest of the frame is on its way for a second already.
    for at in [100, 700, 1300] {
        console.handle_time(ms(at));
    }
    let rest = Note { at_us: 9000, what: What::Received(REPLY[3..].to_vec()) };
    console.hear_line(ms(1301), 0, FromLine::Notes(vec![rest]));
    drain(&mut console);
    console.handle_time(ms(1360));
    assert_eq!(console.poll_line(), Some(ToLine::Clock));
    console.hear_line(ms(1361), 0, FromLine::Clock(70_000));
    assert_eq!(console.rows(0, 9).rows.into_iter().map(|row| row.bytes).collect::<Vec<_>>(), [REPLY]);
}

/// Number of the one thing that is to be sent.
fn asked(console: &mut Console) -> Option<u32> {
    match drain(console).0.as_slice() {
        [] => None,
        [ToLine::Send { id, origin: Origin::Console, bytes, .. }] if *bytes == REQUEST => Some(*id),
        other => panic!("{other:?}"),
    }
}

fn answer(console: &mut Console, now: Instant, id: u32, outcome: Outcome) -> Vec<FromConsole> {
    console.hear_line(now, 0, FromLine::Done { id, outcome });
    std::iter::from_fn(|| console.poll_news()).collect()
}

fn ending(news: &[FromConsole]) -> Option<(u32, u32, End)> {
    news.iter().rev().find_map(|news| match news {
        FromConsole::Sent { id, times, more: false, outcome } => Some((*id, *times, outcome.end)),
        _ => None,
    })
}

fn notes(pairs: u64) -> Vec<Note> {
    let pair = |at: u64| {
        let sent = What::Sent { origin: Origin::Poll, bytes: REQUEST.to_vec() };
        [
            Note { at_us: at * 100_000, what: sent },
            Note { at_us: at * 100_000 + 30_000, what: What::Received(REPLY.to_vec()) },
        ]
    };
    (0..pairs).flat_map(pair).collect()
}

fn entries(console: &Console) -> u32 {
    console.progress().entries
}

#[test]
fn what_is_sent_once_is_told_once() {
    let mut console = attached();
    console.hear(ms(0), ToConsole::Send(sending(7, None)));
    let id = asked(&mut console).unwrap();
    let news = answer(&mut console, ms(30), id, outcome(End::Answered, &REPLY));
    assert_eq!(news, [FromConsole::Sent { id: 7, times: 1, more: false, outcome: outcome(End::Answered, &REPLY) }]);
}

#[test]
fn without_a_line_nothing_is_sent() {
    let mut console = Console::new();
    console.hear(ms(0), ToConsole::Send(sending(7, None)));
    let (orders, news) = drain(&mut console);
    assert_eq!((orders.len(), ending(&news)), (0, Some((7, 0, End::NoPort))));
}

#[test]
fn repetition_goes_from_beginning_to_beginning() {
    let mut console = attached();
    console.hear(ms(0), ToConsole::Send(sending(1, every(100, Some(4), Until::Never))));
    let mut begun = Vec::new();
    let mut now = ms(0);
    // The third exchange takes longer than the period: it is waited for, and nothing is caught up.
    for took in [30, 40, 250, 10] {
        let id = asked(&mut console).unwrap();
        begun.push(now.as_micros() / 1000);
        now = now + Duration::from_millis(took);
        let news = answer(&mut console, now, id, outcome(End::Answered, &REPLY));
        assert_eq!(ending(&news).is_some(), begun.len() == 4);
        while begun.len() < 4 && console.out.line.is_empty() {
            now = now.max(console.sends.due().unwrap());
            console.handle_time(now);
        }
    }
    assert_eq!(begun, [0, 100, 200, 450]);
}

#[test]
fn conditions_end_a_repetition() {
    let exception = outcome(End::Answered, &REFUSAL);
    let reply = outcome(End::Answered, &REPLY);
    let other = outcome(End::Answered, &[0x01, 0x03, 0x02, 0x00, 0x08, 0xB9, 0x82]);
    let silence = outcome(End::Silence, &[]);
    let cases: [(Until, Vec<Outcome>); 5] = [
        (Until::Answered, vec![silence.clone(), exception.clone(), reply.clone()]),
        (Until::Failed, vec![reply.clone(), other.clone(), exception.clone()]),
        (Until::Failed, vec![reply.clone(), silence.clone()]),
        (Until::Changed, vec![silence.clone(), reply.clone(), reply.clone(), other.clone()]),
        (Until::Heard("01 03 ?? ?? 08 CRC".into()), vec![silence, reply, exception, other]),
    ];
    for (until, outcomes) in cases {
        let mut console = attached();
        console.hear(ms(0), ToConsole::Send(sending(1, every(0, None, until.clone()))));
        let last = outcomes.len();
        for (place, outcome) in outcomes.into_iter().enumerate() {
            let id = asked(&mut console).unwrap();
            let news = answer(&mut console, ms(place as u64), id, outcome);
            assert_eq!(ending(&news).is_some(), place + 1 == last, "{until:?} {place}");
            console.handle_time(ms(place as u64 + 1));
        }
        assert_eq!(asked(&mut console), None, "{until:?}");
    }
}

#[test]
fn a_repetition_is_stopped_on_the_line_and_between() {
    let mut console = attached();
    console.hear(ms(0), ToConsole::Send(sending(1, every(100, None, Until::Never))));
    let id = asked(&mut console).unwrap();
    answer(&mut console, ms(10), id, outcome(End::Answered, &REPLY));
    console.hear(ms(20), ToConsole::StopSending);
    let (orders, news) = drain(&mut console);
    assert_eq!((orders.len(), ending(&news)), (0, Some((1, 1, End::Answered))));
    console.hear(ms(30), ToConsole::Send(sending(2, every(100, None, Until::Never))));
    let id = asked(&mut console).unwrap();
    console.hear(ms(31), ToConsole::StopSending);
    assert_eq!(drain(&mut console).0, [ToLine::Withdraw(id)]);
    // It was on the line already: what came of it is told.
    let news = answer(&mut console, ms(40), id, outcome(End::Answered, &REPLY));
    assert_eq!(ending(&news), Some((2, 1, End::Answered)));
    console.handle_time(ms(1000));
    assert_eq!(asked(&mut console), None);
}

#[test]
fn a_line_that_is_gone_or_refuses_ends_a_repetition() {
    for end in [End::NoPort, End::ReadOnly, End::Withdrawn] {
        let mut console = attached();
        console.hear(ms(0), ToConsole::Send(sending(1, every(10, None, Until::Never))));
        let id = asked(&mut console).unwrap();
        assert_eq!(ending(&answer(&mut console, ms(1), id, outcome(end, &[]))), Some((1, 0, end)));
        console.handle_time(ms(1000));
        assert_eq!(asked(&mut console), None);
    }
}

#[test]
fn a_condition_that_cannot_be_read_sends_nothing() {
    let mut console = attached();
    console.hear(ms(0), ToConsole::Send(sending(1, every(10, None, Until::Heard("zz".into())))));
    let (orders, news) = drain(&mut console);
    assert_eq!((orders.len(), ending(&news)), (0, Some((1, 0, End::Withdrawn))));
}

#[test]
fn fast_repetition_is_told_at_display_rate() {
    let mut console = attached();
    console.hear(ms(0), ToConsole::Send(sending(1, every(1, Some(1000), Until::Never))));
    let mut told = 0;
    for at in 0..1000 {
        let id = asked(&mut console).unwrap();
        console.hear_line(ms(at), 0, FromLine::Done { id, outcome: outcome(End::Answered, &REPLY) });
        console.handle_time(ms(at + 1));
        told += std::iter::from_fn(|| console.poll_news()).count();
    }
    assert!(told <= 1000 / 60 + 2, "{told}");
}

#[test]
fn notes_become_the_list_in_portions() {
    let mut console = attached();
    console.hear_line(ms(1), 0, FromLine::Notes(notes(2000)));
    assert!(console.work(), "4000 notes are more than a portion");
    let some = entries(&console);
    assert!(some > 0 && some < 4000);
    drain(&mut console);
    be_quiet(&mut console);
    assert_eq!(entries(&console), 4000);
    assert_eq!(console.rows(0, 2).rows[1].direction, Direction::Response);
}

/// An engine that plays back whatever it is given, `lag` messages late.
fn play_to_the_end(console: &mut Console, lag: usize) -> (u64, Vec<FromConsole>) {
    let mut now = ms(10_000);
    let (mut away, mut all_news) = (std::collections::VecDeque::new(), Vec::new());
    let mut played = 0;
    for _ in 0..1_000_000 {
        let (orders, news) = drain(console);
        all_news.extend(news);
        for order in orders {
            match order {
                ToLine::Replay { .. } => console.hear_line(now, 0, FromLine::State(state(true))),
                ToLine::Play(notes) => away.push_back(notes),
                ToLine::ReplayEnded => {
                    for notes in away.drain(..) {
                        console.hear_line(now, 0, FromLine::Notes(notes));
                    }
                    drain(console);
                    console.handle_time(now + Duration::from_secs(10));
                    return (now.as_micros(), all_news);
                }
                other => panic!("{other:?}"),
            }
        }
        if away.len() > lag {
            let notes: Vec<Note> = away.pop_front().unwrap();
            played += notes.len() as u64;
            console.hear_line(now, 0, FromLine::Notes(notes));
            continue;
        }
        now = now.max(console.playback.as_ref().and_then(Playback::due).unwrap_or(now));
        console.handle_time(now);
    }
    panic!("the replay does not end; {played} notes were played");
}

#[test]
fn a_replay_shows_its_own_list_and_keeps_the_log() {
    let mut console = attached();
    console.hear_line(ms(1), 0, FromLine::Notes(notes(50)));
    drain(&mut console);
    be_quiet(&mut console);
    let log: Vec<_> =
        console.rows(0, 500).rows.into_iter().map(|row| (row.time_us, row.bytes, row.direction)).collect();
    assert_eq!(log.len(), 100);
    let edition = console.progress().edition;
    console.hear(ms(10_000), ToConsole::Replay { speed_permille: 1000, profile: String::new() });
    assert_eq!(entries(&console), 0);
    assert_ne!(console.progress().edition, edition);
    let (ended, news) = play_to_the_end(&mut console, 0);
    assert!((4_930_000..5_100_000).contains(&(ended - 10_000_000)), "{ended}");
    let replayed: Vec<_> =
        console.rows(0, 500).rows.into_iter().map(|row| (row.time_us, row.bytes, row.direction)).collect();
    assert_eq!(replayed, log);
    let told = news.iter().filter(|news| matches!(news, FromConsole::Replay(_))).count();
    assert!((40..=52).contains(&told), "{told} times in five seconds");
    assert!(
        matches!(news.last(), Some(FromConsole::Replay(replay)) if !replay.playing && replay.at_us == replay.total_us)
    );
    // The log is still there, and what is in view can be told from what was.
    let edition = console.progress().edition;
    console.hear(ms(20_000), ToConsole::Live);
    assert_eq!(entries(&console), 100);
    assert_ne!(console.progress().edition, edition);
}

#[test]
fn a_replay_at_another_speed_and_as_fast_as_it_goes() {
    for (speed_permille, from, to) in [(100, 49_300_000, 49_500_000), (10_000, 493_000, 530_000), (0, 0, 10_000)] {
        let mut console = attached();
        console.hear_line(ms(1), 0, FromLine::Notes(notes(50)));
        drain(&mut console);
        be_quiet(&mut console);
        console.hear(ms(10_000), ToConsole::Replay { speed_permille, profile: String::new() });
        let (ended, _) = play_to_the_end(&mut console, 3);
        assert!((from..to).contains(&(ended - 10_000_000)), "{speed_permille}: {ended}");
        assert_eq!(entries(&console), 100);
    }
}

#[test]
fn a_replay_stops_at_once_and_keeps_what_was_played() {
    let mut console = attached();
    console.hear_line(ms(1), 0, FromLine::Notes(notes(20_000)));
    drain(&mut console);
    be_quiet(&mut console);
    console.hear(ms(10_000), ToConsole::Replay { speed_permille: 0, profile: String::new() });
    drain(&mut console);
    console.hear_line(ms(10_001), 0, FromLine::State(state(true)));
    let (orders, _) = drain(&mut console);
    let played: Vec<Note> =
        orders.into_iter().flat_map(|order| if let ToLine::Play(notes) = order { notes } else { vec![] }).collect();
    assert!(!played.is_empty() && played.len() < 3000, "{}", played.len());
    console.handle_time(ms(10_002));
    assert_eq!(drain(&mut console).0, [], "more is played when this has come back");
    console.hear(ms(10_003), ToConsole::StopReplay);
    let (orders, news) = drain(&mut console);
    assert_eq!(orders, [ToLine::ReplayEnded]);
    assert!(matches!(news.last(), Some(FromConsole::Replay(replay)) if !replay.playing));
    console.hear_line(ms(10_004), 0, FromLine::Notes(played.clone()));
    drain(&mut console);
    console.handle_time(ms(20_000));
    assert_eq!(entries(&console) as usize, played.len());
}

#[test]
fn a_text_that_is_brought_in_takes_the_place_of_the_log_which_goes_on() {
    let mut console = attached();
    console.hear_line(ms(1), 0, FromLine::Notes(notes(5)));
    drain(&mut console);
    console.choose(ProfileChoice::None);
    console.begin(1, None, 10);
    console.text_mut().unwrap().push("01 03 00 31 00 01 D5 C5\n01 03 02 00 07 F9 86\n", 10);
    console.text_mut().unwrap().finish();
    assert_eq!(entries(&console), 2);
    console.hear_line(ms(2), 0, FromLine::Notes(notes(5)));
    drain(&mut console);
    be_quiet(&mut console);
    assert_eq!(entries(&console), 2);
    // A replay of what was brought in.
    console.hear(ms(10_000), ToConsole::Replay { speed_permille: 0, profile: String::new() });
    play_to_the_end(&mut console, 0);
    assert_eq!(entries(&console), 2);
    console.hear(ms(30_000), ToConsole::Live);
    assert_eq!(entries(&console), 20);
    assert!(console.text_mut().is_none(), "a reading that goes on is for nobody");
}

#[test]
fn a_port_that_is_opened_during_a_replay_ends_it() {
    let mut console = attached();
    console.hear_line(ms(1), 0, FromLine::Notes(notes(5)));
    drain(&mut console);
    be_quiet(&mut console);
    console.hear(ms(2000), ToConsole::Replay { speed_permille: 1000, profile: String::new() });
    console.hear_line(ms(2000), 0, FromLine::State(state(true)));
    drain(&mut console);
    console.hear_line(ms(2010), 0, FromLine::State(state(false)));
    let (orders, news) = drain(&mut console);
    assert_eq!(orders, []);
    assert!(news.contains(&FromConsole::Replay(crate::message::Replay::default())));
    console.handle_time(ms(9000));
    assert_eq!(drain(&mut console).0, []);
}

#[test]
fn an_empty_log_is_not_replayed() {
    let mut console = attached();
    console.hear(ms(0), ToConsole::Replay { speed_permille: 1000, profile: String::new() });
    assert_eq!(drain(&mut console), (vec![], vec![FromConsole::Replay(crate::message::Replay::default())]));
}

proptest! {
    /// Whatever the pace and however late the engine is: all is played once, in order, never before its time, and never
    /// much is away.
    #[test]
    fn everything_is_played_once_in_order(
        gaps in prop::collection::vec((0_u64..200_000, 1_usize..300), 1..200),
        speed_permille in prop_oneof![Just(0), 100_u32..100_000],
        lag in 0_usize..4,
    ) {
        let mut at_us = 5_000_000;
        let recorded: Vec<Note> = gaps.iter().map(|&(gap, len)| {
            at_us += gap;
            Note { at_us, what: What::Received(vec![0x55; len]) }
        }).collect();
        let (first_us, last_us) = (recorded[0].at_us, at_us);
        let mut rest = recorded.clone();
        let mut playback = Playback::new(ms(0), speed_permille, first_us, last_us);
        let mut out = super::Outbox::default();
        let (mut now, mut away, mut played) = (ms(1000), std::collections::VecDeque::<Vec<Note>>::new(), Vec::new());
        playback.begin(now);
        loop {
            let ended = playback.play(now, |count| rest.drain(..count.min(rest.len())).collect(), &mut out);
            while let Some(order) = out.line.pop_front() {
                let ToLine::Play(notes) = order else { panic!("{order:?}") };
                for note in &notes {
                    let recorded_us = note.at_us - first_us;
                    let elapsed = now.saturating_since(ms(1000)).as_micros();
                    prop_assert!(speed_permille == 0 || elapsed * u128::from(speed_permille) / 1000 >= recorded_us.into());
                }
                away.push_back(notes);
            }
            let bytes: usize = away.iter().flatten().map(super::playback::weight).sum();
            prop_assert!(bytes < (16 << 10) + 256 * 300, "{bytes}");
            if ended {
                played.extend(away.drain(..).flatten());
                break;
            }
            if away.len() > lag {
                let notes = away.pop_front().unwrap();
                playback.take_back(now, &notes);
                played.extend(notes);
            } else {
                let due = playback.due();
                prop_assert!(due.is_some());
                now = now.max(due.unwrap());
            }
        }
        prop_assert_eq!(played, recorded);
    }
}
