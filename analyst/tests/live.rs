//! A live line's log.

mod common;

use buslens_analyst::Desk;
use buslens_analyst::message::{Filter, ProfileChoice, Row};
use buslens_bus::record::{Event, Note, Origin, What};
use buslens_codec::dissect::Direction;
use buslens_codec::line::Mode;
use buslens_codec::profile::BUILT_IN;
use common::*;
use proptest::prelude::*;

fn indices(desk: &Desk) -> Vec<u32> {
    rows(desk).iter().map(|row| row.index).collect()
}

fn errors() -> Filter {
    Filter { errors_only: true, ..Filter::default() }
}

#[test]
fn a_poll_and_its_reply_have_times_of_their_own() {
    let mut desk = Desk::live(0);
    let reply = answer(1, &[1, 2, 3, 4]);
    assert_eq!(reply.len(), 13);
    desk.record(&[
        opened(900_000),
        sent(1_000_000, Origin::Poll, ask(1, 2, 4)),
        received(1_016_000, reply[..5].to_vec()),
        received(1_024_000, reply[5..].to_vec()),
    ]);
    // Nothing else can begin like this reply: no silence is waited for.
    let [request, response] = rows(&desk).try_into().unwrap();
    assert_eq!((request.time_us, request.origin, request.gap_us), (Some(1_000_000), Origin::Poll, None));
    assert_eq!(request.before, [Event::Opened(LINE, Mode::Rtu)]);
    // At 9600 8E1 a character takes 1145.8 us: five of them before the chunk was there, eight of the request before.
    assert_eq!(response.time_us, Some(1_016_000 - 5729));
    assert_eq!(response.gap_us, Some(1_016_000 - 5729 - 1_009_166));
    assert_eq!((response.round_trip_us, response.origin), (Some(24_000), Origin::Poll));
    assert_eq!((request.pair, response.pair), (Some(1), Some(0)));
}

#[test]
fn frames_within_one_chunk_follow_each_other() {
    let mut desk = Desk::live(0);
    let heard = [ask(1, 2, 1), answer(1, &[7]), ask(2, 2, 1), answer(2, &[8])].concat();
    desk.record(&[opened(0), received(1_000_000, heard.clone())]);
    desk.settle(u64::MAX);
    let rows = rows(&desk);
    let directions: Vec<Direction> = rows.iter().map(|row| row.direction).collect();
    assert_eq!(directions, [Direction::Request, Direction::Response, Direction::Request, Direction::Response]);
    let times: Vec<u64> = rows.iter().map(|row| row.time_us.unwrap()).collect();
    let begin = 1_000_000 - u64::try_from(LINE.character_time(heard.len()).as_micros()).unwrap();
    let character = |count: u64| begin + (1_000_000 - begin) * count / 30;
    assert_eq!(times, [begin, character(8), character(15), character(23)]);
    assert_eq!(rows[3].round_trip_us, Some(1_000_000 - times[2]));
    assert!(rows.iter().skip(1).all(|row| row.gap_us == Some(0)), "{rows:?}");
}

#[test]
fn a_request_is_unanswered_when_its_answer_can_no_longer_come() {
    let mut desk = Desk::live(0);
    desk.set_filter(errors());
    desk.record(&[opened(0), sent(1_000_000, Origin::Poll, ask(1, 0, 1))]);
    assert!(indices(&desk).is_empty());
    desk.settle(1_900_000);
    assert!(indices(&desk).is_empty());
    desk.settle(2_000_000);
    assert_eq!(indices(&desk), [0]);
    assert_eq!(desk.statistics().unwrap().total.unanswered, 1);
    // It came late all the same.
    desk.record(&[received(2_100_000, answer(1, &[7]))]);
    desk.settle(2_200_000);
    assert!(indices(&desk).is_empty());
    // The next request says that nobody answered.
    desk.record(&[sent(3_000_000, Origin::Poll, ask(1, 0, 1)), sent(3_100_000, Origin::Poll, ask(1, 0, 1))]);
    assert_eq!(indices(&desk), [2]);
    let total = desk.statistics().unwrap().total;
    assert_eq!((total.requests, total.responses, total.unanswered, total.orphans), (3, 1, 1, 0));
}

#[test]
fn a_row_that_changes_makes_another_edition() {
    let mut desk = Desk::live(0);
    desk.record(&[opened(0), sent(1_000_000, Origin::Poll, ask(1, 0, 1))]);
    let edition = desk.rows(0, 10).edition;
    desk.record(&[received(1_020_000, answer(1, &[7]))]);
    desk.settle(1_200_000);
    assert_ne!(desk.progress().edition, edition);
    // What was not shown yet changes nothing.
    let edition = desk.rows(0, 2).edition;
    desk.record(&[sent(2_000_000, Origin::Poll, ask(1, 0, 1)), received(2_020_000, answer(1, &[7]))]);
    desk.settle(2_200_000);
    assert_eq!(desk.progress().edition, edition);
}

#[test]
fn what_was_wrong_with_the_entry_behind_is_looked_at_again() {
    let mut desk = Desk::live(0);
    desk.choose(ProfileChoice::None);
    let mismatches = |desk: &Desk| {
        let diagnoses = desk.statistics().unwrap().diagnoses;
        diagnoses.iter().find(|(id, _)| id == "byte_count_mismatch").map_or(0, |(_, count)| *count)
    };
    desk.record(&[opened(0), sent(1_000_000, Origin::Poll, ask(1, 0, 1)), received(1_020_000, answer(1, &[7, 8]))]);
    desk.settle(1_200_000);
    assert_eq!(mismatches(&desk), 1);
    // The reply that fits comes after all: what came before it answered something else.
    desk.record(&[received(1_300_000, answer(1, &[7]))]);
    desk.settle(1_500_000);
    assert_eq!(mismatches(&desk), 0);
    assert_eq!(rows(&desk)[1].diagnoses, []);
}

#[test]
fn what_happens_to_the_port_stands_before_the_next_entry() {
    let mut desk = Desk::live(0);
    let reply = answer(1, &[7]);
    desk.record(&[
        opened(0),
        sent(1_000_000, Origin::Console, ask(1, 0, 1)),
        received(1_010_000, reply[..3].to_vec()),
        note(1_011_000, What::Port(Event::LineError)),
        received(1_012_000, reply[3..].to_vec()),
        note(1_100_000, What::Port(Event::Lost)),
    ]);
    assert_eq!(desk.progress().after, [Event::LineError, Event::Lost]);
    let seen = rows(&desk);
    assert_eq!((seen.len(), &seen[1].bytes, &seen[1].before), (2, &reply, &vec![]));
    desk.record(&[opened(2_000_000), received(2_100_000, vec![0xFF])]);
    desk.settle(u64::MAX);
    assert_eq!(rows(&desk)[2].before, [Event::LineError, Event::Lost, Event::Opened(LINE, Mode::Rtu)]);
    assert_eq!(desk.progress().after, []);
}

#[test]
fn a_line_of_nothing_but_faults_fills_no_memory() {
    let mut desk = Desk::live(0);
    let faults: Vec<Note> = (0..100_000).map(|at| note(at, What::Port(Event::LineError))).collect();
    desk.record(&faults);
    assert_eq!(desk.progress().after.len(), 256);
}

#[test]
fn a_million_entries_take_less_than_sixty_megabytes() {
    let mut desk = Desk::live(0);
    let exchanges = notes(&vec![Act::Exchange(1, 0, vec![7, 8], 1); 50_000]);
    desk.record(&exchanges);
    desk.settle(u64::MAX);
    let entries = desk.progress().entries as usize;
    assert_eq!(entries, 100_000);
    assert!(desk.footprint() < 60 * entries, "{} bytes", desk.footprint());
}

#[test]
fn pause_holds_the_list_still_and_loses_nothing() {
    let all = notes(&vec![Act::Exchange(1, 0, vec![7], 1); 60]);
    let mut desk = Desk::live(0);
    let (early, late) = all.split_at(41);
    desk.record(early);
    desk.settle(u64::MAX);
    desk.pause(true);
    let before = rows(&desk);
    let edition = desk.progress().edition;
    desk.record(late);
    desk.settle(u64::MAX);
    assert_eq!(rows(&desk), before);
    let progress = desk.progress();
    assert_eq!((progress.entries, progress.shown, progress.held, progress.edition), (40, 40, 80, edition));
    desk.set_filter(Filter { direction: Some(Direction::Request), ..Filter::default() });
    while desk.work(10) {}
    assert_eq!(desk.progress().shown, 20);
    desk.set_filter(Filter::default());
    desk.pause(false);
    assert_eq!((desk.progress().held, rows(&desk)), (0, rows(&live(&all, 7))));
}

#[test]
fn marks_are_found_by_their_comments_and_go_with_their_entries() {
    let all = notes(&vec![Act::Exchange(1, 0, vec![7], 1); 10]);
    let mut desk = live(&all, 5);
    assert!(desk.mark(3, Some("After the Thaw".to_owned())) && desk.mark(5, Some(String::new())));
    assert!(!desk.mark(99, Some(String::new())));
    desk.set_filter(Filter { text: "thaw".to_owned(), ..Filter::default() });
    while desk.work(3) {}
    assert_eq!(indices(&desk), [3]);
    assert!(desk.mark(7, Some("thaw again".to_owned())) && desk.mark(3, None));
    assert_eq!(indices(&desk), [7]);
    desk.set_filter(Filter::default());
    let marks: Vec<Option<String>> = rows(&desk).into_iter().map(|row| row.mark).collect();
    assert_eq!((marks[3].as_deref(), marks[5].as_deref(), marks[7].as_deref()), (None, Some(""), Some("thaw again")));
    desk.clear_log();
    assert_eq!((desk.progress().entries, rows(&desk)), (0, vec![]));
    desk.record(&[received(99_000_000, vec![0xFF])]);
    desk.settle(u64::MAX);
    let row = &rows(&desk)[0];
    assert_eq!((row.index, &row.mark, row.before.len()), (0, &None, 0));
}

#[test]
fn characters_are_found() {
    let mut desk = Desk::live(0);
    desk.record(&[opened(0), sent(1, Origin::Console, b"AT+Read\r".to_vec())]);
    desk.set_filter(Filter { text: "read".to_owned(), ..Filter::default() });
    while desk.work(3) {}
    assert_eq!(indices(&desk), [0]);
}

#[test]
fn the_device_is_found_as_it_speaks() {
    // Table 14 of a gauge's manual asks for four registers from 2 on with function 04.
    let request = frame(1, &[4, 0, 2, 0, 4]);
    let reply = frame(1, &[4, 8, 0, 0, 1, 0x1D, 0, 0x7B, 1, 0xC8]);
    let mut desk = Desk::live(0);
    let exchange = |at: u64| [sent(at, Origin::Poll, request.clone()), received(at + 20_000, reply.clone())];
    for second in 1..20 {
        desk.record(&exchange(second * 1_000_000));
    }
    while desk.work(1000) {}
    let found = desk.progress().profile;
    assert_eq!(found, read("01 04 00 02 00 04 50 09 01 04 08 00 00 01 1D 00 7B 01 C8 B9 C1").progress().profile);
    assert!(found.is_some());
}

#[test]
fn scales_outlive_the_registers_that_told_them() {
    let mut desk = Desk::live(0);
    desk.choose(ProfileChoice::File(BUILT_IN[2].to_owned()));
    desk.set_ring(1000);
    // The register with the decimal places is read once, the value again and again.
    let mut all = notes(&[Act::Exchange(1, 3, vec![3], 1)]);
    all.extend(notes(&vec![Act::Exchange(1, 4, vec![6000], 1); 1200]));
    desk.record(&all);
    desk.settle(u64::MAX);
    let last = rows(&desk).pop().unwrap();
    assert_eq!((last.told, desk.progress().first > 1000), (vec![(3, 3, 3)], true));
    assert!(
        text(&desk, buslens_analyst::message::Format::JsonLines).lines().last().unwrap().contains("\"value\":6.000")
    );
}

/// Entries whose rows tell something of the one before them, which may be gone.
const NEIGHBOURS: u32 = 6;

/// A row without what it tells of a request that is gone.
fn without_forgotten(mut row: Row, first: u32) -> Row {
    if row.pair.is_some_and(|pair| pair < first) {
        (row.origin, row.round_trip_us) = (Origin::Unknown, None);
        row.request.clear();
        row.diagnoses.clear();
    }
    row
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// However the notes are told, and whatever the bytes' chunks are, the same entries come of them.
    #[test]
    fn portions_and_chunks_mean_nothing(all in any_notes(0..40), portion in 1usize..9, size in 1usize..7) {
        let chunked: Vec<Note> = all.iter().flat_map(|told| match &told.what {
            What::Received(bytes) => bytes.chunks(size).map(|chunk| received(told.at_us, chunk.to_vec())).collect(),
            _ => vec![told.clone()],
        }).collect();
        let bare = |mut row: Row| {
            // Of chunks that arrive together only the first tells when its bytes were on the line.
            (row.time_us, row.gap_us, row.round_trip_us) = (None, None, None);
            row
        };
        let whole = live(&all, usize::MAX);
        prop_assert_eq!(rows(&live(&all, portion)), rows(&whole));
        let cut: Vec<Row> = rows(&live(&chunked, portion)).into_iter().map(bare).collect();
        prop_assert_eq!(cut, rows(&whole).into_iter().map(bare).collect::<Vec<_>>());
    }

    /// Counts and filters that follow as things happen end where those end that look at everything afterwards.
    #[test]
    fn keeping_up_is_the_same_as_looking_afterwards(
        all in any_notes(0..60),
        portion in 1usize..9,
        errors_only: bool,
        direction in prop::option::of(prop_oneof![Just(Direction::Request), Just(Direction::Response)]),
        text in prop_oneof![Just(""), Just("01 03"), Just("crc"), Just("exception")],
    ) {
        let filter = Filter { errors_only, direction, text: text.to_owned(), ..Filter::default() };
        let mut early = Desk::live(0);
        early.choose(ProfileChoice::None);
        early.set_filter(filter.clone());
        for some in all.chunks(portion) {
            early.record(some);
            let end = early.progress().entries;
            prop_assert!(rows(&early).iter().all(|row| row.index < end));
        }
        early.settle(u64::MAX);
        let mut late = live(&all, 100);
        late.choose(ProfileChoice::None);
        late.set_filter(filter);
        while late.work(7) {}
        prop_assert_eq!(rows(&early), rows(&late));
        prop_assert_eq!(early.statistics(), late.statistics());
        let times: Vec<u64> = rows(&late).iter().map(|row| row.time_us.unwrap()).collect();
        prop_assert!(times.is_sorted(), "{:?}", times);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

    /// A ring holds the last entries as a list without end would have them, and everything else goes.
    #[test]
    fn a_ring_keeps_the_last(all in any_notes(1500..2500), portion in 1usize..600, errors_only: bool) {
        let filter = Filter { errors_only, ..Filter::default() };
        let whole = {
            let mut desk = live(&all, 1000);
            desk.choose(ProfileChoice::None);
            desk.set_filter(filter.clone());
            while desk.work(1000) {}
            desk
        };
        let mut ring = Desk::live(0);
        ring.choose(ProfileChoice::None);
        ring.set_ring(1);
        ring.set_filter(filter);
        for some in all.chunks(portion) {
            ring.record(some);
            let progress = ring.progress();
            prop_assert!(progress.entries <= 1125, "{}", progress.entries);
        }
        ring.settle(u64::MAX);
        let (progress, all_of_it) = (ring.progress(), whole.progress());
        let first = progress.first;
        prop_assert!((1000..=1125).contains(&progress.entries), "{}", progress.entries);
        prop_assert_eq!(first + progress.entries, all_of_it.entries);
        let expected = rows(&whole).into_iter().filter(|row| row.index >= first + NEIGHBOURS);
        let found = rows(&ring).into_iter().filter(|row| row.index >= first + NEIGHBOURS);
        let bare = |row| without_forgotten(row, first);
        prop_assert_eq!(found.map(bare).collect::<Vec<_>>(), expected.map(bare).collect::<Vec<_>>());
        // What is counted is what is there.
        let counted = ring.statistics();
        ring.choose(ProfileChoice::None);
        while ring.work(1000) {}
        prop_assert_eq!(ring.statistics(), counted);
    }
}
