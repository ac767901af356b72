use super::*;

const LOG: &str = "\
10:00:01.000 TX: 01 03 00 03 00 01 74 0A
10:00:01.020 RX: 01 03 02 00 03 F8 45
10:00:01.100 TX: 01 03 00 04 00 01 C5 CB
10:00:01.120 RX: 01 03 02 17 70 B6 50
10:00:02.000 TX: 07 04 00 02 00 04 50 6F
10:00:02.020 RX: 07 84 02 22 C0
10:00:03.000 TX: 01 03 00 05 00 01 94 0B
10:00:04.000 RX: 01 03 02 00 03 F8 44
";

fn read(text: &str, choice: ProfileChoice) -> Desk {
    let mut desk = Desk::new();
    desk.choose(choice);
    desk.begin(1, None, text.len() as u64);
    for part in text.as_bytes().chunks(7) {
        desk.push(std::str::from_utf8(part).unwrap(), part.len() as u64);
    }
    desk.finish();
    while desk.work(2) {}
    desk
}

fn level() -> ProfileChoice {
    ProfileChoice::File(BUILT_IN[2].to_owned())
}

#[test]
fn a_log_becomes_rows_with_their_requests_and_scales() {
    let desk = read(LOG, level());
    let progress = desk.progress();
    assert_eq!((progress.entries, progress.finished, progress.form), (8, true, Some(Form::Log)));
    assert_eq!(progress.profile.as_deref(), Some("level"));
    let rows = desk.rows(0, 100).rows;
    assert_eq!(rows.len(), 8);
    assert_eq!(rows[3].request, [0x03, 0x00, 0x04, 0x00, 0x01]);
    assert_eq!(rows[3].told, [(3, 3, 3)]);
    assert_eq!(rows[1].pair, Some(0));
    assert_eq!(rows[5].diagnoses[0].id(), "exception");
    assert!(rows[7].diagnoses.iter().any(|found| found.id() == "single_bit_error"), "{:?}", rows[7]);
    assert_eq!(desk.rows(7, 100).rows.len(), 1);
    assert_eq!(desk.rows(8, 100).rows.len(), 0);
}

#[test]
fn the_counts_are_right() {
    let statistics = read(LOG, ProfileChoice::None).statistics().unwrap();
    let total = statistics.total;
    assert_eq!((total.frames, total.requests, total.responses), (7, 4, 3));
    assert_eq!((total.exceptions, total.damaged, total.stretches), (1, 1, 0));
    assert_eq!(
        statistics.units.iter().map(|(unit, tally)| (*unit, tally.frames)).collect::<Vec<_>>(),
        [(1, 5), (7, 2)]
    );
    assert_eq!(statistics.functions, [(3, 5), (4, 2)]);
    assert!(statistics.diagnoses.contains(&("bad_crc".to_owned(), 1)));
}

#[test]
fn filters_let_through_what_they_say() {
    let mut desk = read(LOG, level());
    let mut shown = |filter: Filter| {
        let edition = desk.progress().edition;
        desk.set_filter(filter);
        while desk.work(3) {}
        assert_ne!(desk.progress().edition, edition);
        desk.rows(0, 100).rows.iter().map(|row| row.index).collect::<Vec<_>>()
    };
    assert_eq!(shown(Filter { unit: Some(7), ..Filter::default() }), [4, 5]);
    assert_eq!(shown(Filter { function: Some(4), ..Filter::default() }), [4, 5]);
    assert_eq!(shown(Filter { errors_only: true, ..Filter::default() }), [5, 7]);
    assert_eq!(shown(Filter { text: "17 70".to_owned(), ..Filter::default() }), [3]);
    assert_eq!(shown(Filter { text: "single_bit".to_owned(), ..Filter::default() }), [7]);
    assert_eq!(shown(Filter { text: "小数".to_owned(), ..Filter::default() }), [1]);
    assert_eq!(shown(Filter::default()), [0, 1, 2, 3, 4, 5, 6, 7]);
}

#[test]
fn the_profile_that_explains_most_is_found() {
    let desk = read("01 04 00 02 00 04 50 09 01 04 08 00 00 01 1D 00 7B 01 C8 B9 C1", ProfileChoice::default());
    assert_eq!(desk.progress().profile.as_deref(), Some("lvdt"));
    assert_eq!(read("FF FF FF", ProfileChoice::default()).progress().profile, None);
}

#[test]
fn a_profile_of_the_users_own_is_found_as_well() {
    let own = BUILT_IN[2].replace("\"id\": \"level\"", "\"id\": \"well\"").replace("\"0x0004\"", "\"0x0104\"");
    let log = "01 03 01 04 00 01 C4 37 01 03 02 17 70 B6 50";
    let found = |own: &[String]| read(log, ProfileChoice::Auto(own.to_vec())).progress().profile;
    assert_ne!(found(&[]).as_deref(), Some("well"));
    assert_eq!(found(&["no profile".to_owned(), own]).as_deref(), Some("well"));
}

#[test]
fn requests_alone_are_no_errors() {
    let mut desk = read("01 03 00 31 00 01 D5 C5\n01 03 00 31 00 01 D5 C5", ProfileChoice::default());
    desk.set_filter(Filter { errors_only: true, ..Filter::default() });
    while desk.work(100) {}
    assert_eq!(desk.progress().shown, 0);
    assert_eq!(desk.statistics().unwrap().total.unanswered, 0);
}

#[test]
fn a_reading_that_is_stopped_keeps_what_it_has() {
    let mut desk = Desk::new();
    desk.begin(3, None, 1 << 20);
    let half = LOG.repeat(400);
    desk.push(&half, half.len() as u64);
    desk.cancel();
    while desk.work(1000) {}
    let progress = desk.progress();
    assert!(progress.cancelled && progress.finished && progress.done < progress.total);
    assert_eq!(progress.entries, 3200);
    assert!(desk.statistics().is_some());
}

#[test]
fn another_way_to_read_is_offered_and_taken() {
    let text = "1 3 0 49 0 1 13 97";
    let first = read(text, ProfileChoice::None).progress();
    let mut desk = Desk::new();
    desk.begin(2, first.alternative, 0);
    desk.push(text, 0);
    desk.finish();
    let second = desk.progress();
    assert_eq!((second.form, second.alternative), (first.alternative, first.form));
}

#[test]
fn files_of_the_list_hold_what_is_shown() {
    let mut desk = read(LOG, level());
    let export = |desk: &Desk, format| {
        let mut text = String::new();
        desk.export(format, |part| text.push_str(std::str::from_utf8(part).unwrap()));
        text
    };
    assert_eq!(export(&desk, Format::JsonLines).lines().count(), 8);
    assert!(export(&desk, Format::JsonLines).lines().nth(3).unwrap().contains("\"value\":6.000"));
    desk.set_filter(Filter { unit: Some(7), ..Filter::default() });
    while desk.work(100) {}
    assert_eq!(export(&desk, Format::Hex), "TX: 07 04 00 02 00 04 50 6F\nRX: 07 84 02 22 C0\n");
    let csv = export(&desk, Format::Csv);
    assert_eq!(
        csv.lines().nth(2),
        Some("5,38,6,36002020000,frame,rtu,response,7,4,ok,4,07840222C0,exception,,20000,20000,")
    );
    assert!(export(&desk, Format::JsonLines).lines().all(|line| line.contains("\"unit\":7")));
}

#[test]
fn a_close_look_finds_what_shows_a_number() {
    let desk = read("0C 04 00 04 00 02 31 17 0C 04 04 80 00 01 48 0F 22", ProfileChoice::default());
    let look = desk.look(1, " \u{2212}0.328 ");
    assert!(look.understood);
    let fit = &look.fits[0];
    assert_eq!((fit.name.as_str(), fit.offset), ("sign_magnitude_thousandths", 0));
    assert_eq!(look.views.len(), 2);
    assert!(look.views[0].views.iter().any(|view| (view.name.as_str(), view.text.as_str()) == ("hex", "8000")));
    assert!(look.json.starts_with("{\"kind\":\"frame\",\"index\":1,") && look.json.contains("\"value\":-0.328"));
    assert!(!desk.look(1, "much").understood);
    assert!(desk.look(99, "").views.is_empty());
}
