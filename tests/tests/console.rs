//! The Console page on a line, through the browser's own serial port stack.

use std::process::Command;
use std::time::Duration;

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_codec::line::{LineSettings, Parity};
use buslens_codec::rtu;
use buslens_tests::pages::{ConsolePage, LivePage, State};
use buslens_tests::testbed::{Bench, Chatter, FarEnd};

const FACTORY: LineSettings = LineSettings::new(9600, Parity::Even);
/// Reads the register of the baud rate; the sensor answers that it is 9600 Bd.
const REQUEST: &str = "01 03 00 31 00 01 D5 C5";
const REPLY: &str = "01 03 02 00 03 F8 45";

fn lvdt() -> Line<Lvdt> {
    Line::new([Lvdt::new(1, Motion::Rest { micrometres: 123_456, decidegrees: 255 })], 1)
}

/// The Console page over a line that is being polled.
async fn polled<F: FarEnd>(bench: &Bench<F>) -> ConsolePage<'_> {
    let live = LivePage::open(&bench.browser).await;
    live.connect().await;
    live.wait_for(State::Reading).await;
    let page = ConsolePage::open(&bench.browser).await;
    page.wait_for_line("open").await;
    page
}

/// The same with the line left to the console, and an empty log.
async fn quiet<F: FarEnd>(bench: &Bench<F>) -> ConsolePage<'_> {
    let page = polled(bench).await;
    page.switch("polling", false).await;
    page.clear().await;
    page.wait_for_count("0").await;
    page
}

/// The Console page over a line on which others talk.
async fn listening(bench: &Bench<Chatter>) -> ConsolePage<'_> {
    let page = ConsolePage::open(&bench.browser).await;
    page.connect_listening().await;
    page.wait_for_line("open").await;
    page
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
}

/// An entry of a saved session.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Entry {
    way: String,
    origin: String,
    bytes: Vec<u8>,
    time: String,
}

/// Reads what goes over the line from a saved session.
fn entries(session: &[u8]) -> Vec<Entry> {
    let text = std::str::from_utf8(session).expect("a session is text");
    assert!(text.starts_with("Buslens session 1\n"), "{text}");
    let entry = |line: &str| {
        let words: Vec<&str> = line.split(" * ").next()?.split(' ').collect();
        let [time, _, way @ ("TX" | "RX" | "??"), origin, bytes @ ..] = words.as_slice() else { return None };
        let bytes = bytes.iter().map(|byte| u8::from_str_radix(byte, 16).expect("hexadecimal")).collect();
        Some(Entry { way: (*way).into(), origin: (*origin).into(), bytes, time: (*time).into() })
    };
    text.lines().filter_map(entry).collect()
}

async fn saved_entries(page: &ConsolePage<'_>) -> Vec<Entry> {
    entries(&page.export("session").await)
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_hand_made_frame_gets_the_sensors_reply_decoded() {
    let bench = Bench::new(lvdt()).await;
    let page = quiet(&bench).await;
    page.type_line("01 03 00 31 00 01").await;
    assert_eq!(page.preview().await.replace('\n', " "), REQUEST);
    page.send("010300310001").await;
    let result = page.result("answered").await;
    assert!(result.contains("9600"), "{result}");
    page.wait_for_row("TX", REQUEST).await;
    let heard = page.wait_for_row("RX", REPLY).await;
    assert!(heard.contains("9600"), "{heard}");
    assert_eq!(page.cells("origin").await, ["console", "console"]);
    // Bytes that are no frame go out as they are, and what comes of it is said.
    page.set_check("none").await;
    page.send("55 AA").await;
    page.result("silence").await;
    page.wait_for_row("TX", "55 AA").await;
    assert!(bench.wire().sent().ends_with(&[0x55, 0xAA]));
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_wrong_check_on_purpose_gets_silence() {
    let bench = Bench::new(lvdt()).await;
    let page = quiet(&bench).await;
    page.set_check("wrong").await;
    page.send("01 03 00 31 00 01").await;
    page.result("silence").await;
    let rows = page.rows().await;
    assert_eq!(rows.len(), 1, "{rows:?}");
    assert_eq!(page.cells("direction").await, ["TX"]);
    let sent = bench.wire().sent();
    assert!(rtu::decode(&sent[sent.len() - 8..]).is_err());
    page.toggle_errors().await;
    page.wait_for_count("1").await;
    // The line is not spoiled by it.
    page.set_check("crc").await;
    page.send("01 03 00 31 00 01").await;
    page.result("answered").await;
}

/// A minute in which two masters want the line: the poll, and a hand at the console that repeats.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn polling_and_sending_share_the_line_without_tearing_each_other() {
    const POLL: [u8; 8] = [0x01, 0x04, 0x00, 0x02, 0x00, 0x04, 0x50, 0x09];
    let bench = Bench::new(lvdt()).await;
    let live = LivePage::open(&bench.browser).await;
    live.set_period(100).await;
    bench.wire().keep_delivered();
    live.connect().await;
    live.wait_for(State::Reading).await;
    live.watch_displacement().await;
    let page = ConsolePage::open(&bench.browser).await;
    page.catch_files().await;
    page.repeat(130, 460).await;
    page.send("01 03 00 31 00 01").await;
    // A minute, and whatever the poll takes.
    for times in [115, 230, 345, 460] {
        page.wait_for_repetitions(times).await;
    }
    page.result("answered").await;
    page.switch("polling", false).await;
    page.wait_for_quiet().await;
    let session = page.export("session").await;
    let log = entries(&session);
    let joined = |way: &str| -> Vec<u8> {
        log.iter().filter(|entry| entry.way == way).flat_map(|entry| entry.bytes.clone()).collect()
    };
    assert_eq!(hex(&joined("TX")), hex(&bench.wire().sent()));
    assert_eq!(hex(&joined("RX")), hex(&bench.wire().delivered()));
    let request = [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5];
    let mut polls = 0;
    for pair in log.chunks(2) {
        let [asked, answer] = pair else { panic!("{:?} has no answer", pair[0]) };
        let (expected, origin) = match asked.bytes.as_slice() {
            bytes if bytes == POLL => ("01 04 08 00 00 01 1D 00 7B 01 C8", "poll"),
            bytes if bytes == request => ("01 03 02 00 03", "console"),
            // What is read beside the poll now and then: compensation and sample rate.
            [0x01, 0x03, 0x00, 0x34 | 0x3F, 0x00, 0x01, ..] => ("01 03 02 00", "poll"),
            other => panic!("torn: {}", hex(other)),
        };
        polls += u32::from(asked.bytes == POLL);
        assert_eq!((asked.way.as_str(), asked.origin.as_str()), ("TX", origin));
        let heard = rtu::decode(&answer.bytes).unwrap_or_else(|error| panic!("{}: {error}", hex(&answer.bytes)));
        assert!(hex(&answer.bytes).starts_with(&expected[..8]), "{asked:?} {answer:?}");
        if origin == "console" {
            assert!(hex(&answer.bytes).starts_with(expected), "{heard:?}");
        }
    }
    assert!(polls >= 400, "{polls} readings in a minute");
    // Not one reading was anything but what the sensor measured.
    let live = page.go_to_live().await;
    assert_eq!(live.count("bad-checks").await + live.count("exceptions").await + live.count("no-answers").await, 0);
    assert_eq!(live.watched_displacements().await, [123.456]);
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_capture_is_opened_by_others_with_the_same_transactions() {
    let bench = Bench::new(lvdt()).await;
    let page = quiet(&bench).await;
    page.catch_files().await;
    for line in ["01 03 00 31 00 01", "01 04 00 02 00 04", "01 03 7F FF 00 01"] {
        page.send(line).await;
        page.wait_for_ended().await;
    }
    page.wait_for_count("6").await;
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join("log.pcap");
    std::fs::write(&path, page.export("pcap").await).expect("the folder is writable");
    let fields = ["modbus.func_code", "mbrtu.unit_id", "modbus.exception_code", "frame.time_epoch"];
    let mut tshark = Command::new("tshark");
    tshark.args(["-r"]).arg(&path).args(["-T", "fields", "-E", "separator=,"]);
    for field in fields {
        tshark.args(["-e", field]);
    }
    let output = tshark.output().expect("tshark starts (package tshark)");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let read: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let seen: Vec<[&str; 3]> = read.iter().map(|line| [line[0], line[1], line[2]]).collect();
    let expected = [["3", "1", ""], ["3", "1", ""], ["4", "1", ""], ["4", "1", ""], ["3", "1", ""], ["3", "1", "2"]];
    assert_eq!(seen, expected, "{text}\n{}", String::from_utf8_lossy(&output.stderr));
    let times: Vec<f64> = read.iter().filter_map(|line| line[3].parse().ok()).collect();
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).expect("after 1970").as_secs_f64();
    assert!(times.iter().all(|time| (now - 600.0..now + 1.0).contains(time)), "{times:?} at {now}");
    assert!(times.is_sorted());
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_saved_session_is_brought_in_and_played_to_the_same_list() {
    let bench = Bench::new(lvdt()).await;
    let page = polled(&bench).await;
    page.catch_files().await;
    page.send("01 03 00 31 00 01").await;
    page.result("answered").await;
    page.wait_for_count_at_least(40).await;
    page.switch("polling", false).await;
    page.wait_for_quiet().await;
    let session = page.export("session").await;
    let live = page.count().await;
    page.drop_file("saved.session", std::str::from_utf8(&session).expect("text")).await;
    page.wait_for_count(&live).await;
    // Played to the whole app: the readings are there as if live.
    page.replay(500).await;
    page.go_to_live().await.wait_for_displacement("123.456 mm").await;
    let page = ConsolePage::open(&bench.browser).await;
    page.wait_for_replay_end().await;
    page.wait_for_count(&live).await;
    let (saved, replayed) = (entries(&session), saved_entries(&page).await);
    let content = |entries: &[Entry]| -> Vec<_> {
        entries.iter().map(|entry| (entry.way.clone(), entry.origin.clone(), hex(&entry.bytes))).collect()
    };
    assert_eq!(content(&replayed), content(&saved));
    page.go_live().await;
    page.wait_for_count(&live).await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn malformed_hex_is_told_with_its_place_and_stays() {
    let bench = Bench::new(lvdt()).await;
    let page = quiet(&bench).await;
    let before = bench.wire().sent().len();
    page.type_line("01 03 G0 31").await;
    let (column, words) = page.fault().await;
    assert_eq!(column, 7, "{words}");
    assert!(words.contains('G'), "{words}");
    page.press_in("send-line", "Enter").await;
    assert_eq!(page.line().await, "01 03 G0 31");
    // Once it is right it goes, and nothing went before.
    page.send("01 03 00 31 00 01").await;
    page.result("answered").await;
    assert_eq!(hex(&bench.wire().sent()[before..]), REQUEST);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn read_only_lets_no_write_out() {
    let bench = Bench::new(lvdt()).await;
    let page = quiet(&bench).await;
    page.switch("read-only", true).await;
    let before = bench.wire().sent().len();
    page.send("01 06 00 31 00 03").await;
    page.result("read-only").await;
    page.send("01 03 00 31 00 01").await;
    page.result("answered").await;
    assert_eq!(hex(&bench.wire().sent()[before..]), REQUEST);
    page.switch("read-only", false).await;
    page.send("01 06 00 31 00 03").await;
    page.result("answered").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn other_settings_keep_the_log() {
    let bench = Bench::new(lvdt()).await;
    let page = quiet(&bench).await;
    page.send("01 03 00 31 00 01").await;
    page.result("answered").await;
    page.wait_for_count("2").await;
    page.set_line("baud", "19200").await;
    page.set_line("parity", "none").await;
    page.apply_line().await;
    bench.wire().wait_for_settings(LineSettings::new(19_200, Parity::None), Duration::from_secs(10));
    page.send("01 03 00 31 00 01").await;
    page.wait_for_ended().await;
    page.wait_for_row("RX", REPLY).await;
    page.set_line("baud", "9600").await;
    page.set_line("parity", "even").await;
    page.apply_line().await;
    bench.wire().wait_for_settings(FACTORY, Duration::from_secs(10));
    page.send("01 03 00 31 00 01").await;
    page.result("answered").await;
    // The first exchange is still at the head, and what happened to the port stands between.
    let rows = page.rows().await;
    assert!(rows[0].contains(REQUEST) && rows[1].contains(REPLY), "{rows:?}");
    assert!(rows.iter().any(|row| row.contains("19200 8N1")), "{rows:?}");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_ring_keeps_the_latest_and_says_so() {
    let bench = Bench::new(Chatter::silent(true)).await;
    let page = listening(&bench).await;
    page.catch_files().await;
    page.set_ring(1000).await;
    bench.wire().with(|others, now| others.talk(now, 3000, Duration::from_micros(50)));
    page.wait_for_number(6000).await;
    let count: u32 = page.count().await.parse().expect("a count");
    assert!((1000..=1125).contains(&count), "{count}");
    let kept = saved_entries(&page).await;
    let written = bench.wire().with(|others, _| others.written().to_vec());
    let kept: Vec<Vec<u8>> = kept.into_iter().map(|entry| entry.bytes).collect();
    assert_eq!(kept, written[written.len() - kept.len()..]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_pause_loses_nothing() {
    let bench = Bench::new(Chatter::silent(true)).await;
    let page = listening(&bench).await;
    page.catch_files().await;
    let talk = async |exchanges| {
        bench.wire().with(|others, now| others.talk(now, exchanges, Duration::from_micros(500)));
    };
    talk(50).await;
    page.wait_for_count("100").await;
    page.toggle_pause().await;
    talk(1000).await;
    page.wait_for_held(2000).await;
    assert_eq!(page.count().await, "100");
    page.toggle_pause().await;
    page.wait_for_count("2100").await;
    let kept: Vec<Vec<u8>> = saved_entries(&page).await.into_iter().map(|entry| entry.bytes).collect();
    assert_eq!(kept, bench.wire().with(|others, _| others.written().to_vec()));
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn marks_are_found_and_saved() {
    let bench = Bench::new(lvdt()).await;
    let page = quiet(&bench).await;
    page.catch_files().await;
    for line in ["01 03 00 31 00 01", "01 04 00 02 00 04"] {
        page.send(line).await;
        page.wait_for_ended().await;
    }
    page.wait_for_count("4").await;
    page.choose_row(1).await;
    page.comment("after the thaw").await;
    page.choose_row(2).await;
    page.toggle_mark().await;
    page.filter("text", "thaw").await;
    page.wait_for_count("1 of 4").await;
    assert_eq!(page.cells("bytes").await, [REPLY]);
    page.clear_filter().await;
    let session = String::from_utf8(page.export("session").await).expect("text");
    assert!(session.lines().any(|line| line.contains(&format!("{REPLY} * \"after the thaw\""))), "{session}");
    assert!(session.lines().any(|line| line.ends_with(" * \"\"")), "{session}");
    page.choose_row(2).await;
    page.toggle_mark().await;
    let session = String::from_utf8(page.export("session").await).expect("text");
    assert!(!session.lines().any(|line| line.ends_with(" * \"\"")), "{session}");
}

/// From the connect card to the reply in the list, without a mouse.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_frame_is_sent_and_found_by_keys_alone() {
    let bench = Bench::new(lvdt()).await;
    let page = ConsolePage::open(&bench.browser).await;
    bench.browser.wait_for("document.querySelector('[data-test=port]')?.value").await;
    page.tab_to("connect").await;
    page.press(&["Enter"]).await;
    page.wait_for_line("open").await;
    page.wait_for_count_at_least(4).await;
    page.press(&["s"]).await;
    page.wait_for_focus("send-line").await;
    page.type_keys("010300310001").await;
    page.press(&["Enter"]).await;
    page.result("answered").await;
    // Out of the line, to the filter, and the reply is found.
    page.press(&["Escape", "/"]).await;
    page.wait_for_focus("filter-text").await;
    page.type_keys("02 00 03 F8 45").await;
    bench.browser.wait_for("document.querySelectorAll('[data-test=console-row]').length === 1").await;
    assert_eq!(page.cells("bytes").await, [REPLY]);
    // Back in the whole list it is the chosen one still, and its other half is a key away.
    page.press(&["Escape"]).await;
    let chosen = "document.querySelector('[data-test=console-row][aria-selected=true] .cell-bytes')?.textContent";
    page.press(&["Home"]).await;
    bench.browser.wait_for(chosen).await;
    // The line that was sent comes back with the arrow key.
    page.press(&["s", "ArrowUp"]).await;
    bench.browser.wait_for("document.querySelector('[data-test=send-line]').value === '010300310001'").await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn switches_menus_and_fields_have_keys() {
    let bench = Bench::new(lvdt()).await;
    let page = polled(&bench).await;
    page.catch_files().await;
    let is = |hook: &str, state: &str| format!("document.querySelector('[data-test={hook}]')?.{state} === 'true'");
    page.press(&["v"]).await;
    bench.browser.wait_for(&format!("!({})", is("line-polling", "ariaChecked"))).await;
    page.wait_for_quiet().await;
    page.press(&["n", "q", "q"]).await;
    bench.browser.wait_for(&is("times-start", "ariaPressed")).await;
    bench.browser.wait_for(&is("bytes-both", "ariaPressed")).await;
    page.press(&["u"]).await;
    bench.browser.wait_for("document.querySelector('[data-test=repeat-every]')").await;
    // The menu's first item has the focus: the text export.
    page.press(&["w"]).await;
    page.wait_for_focus("export-text").await;
    page.press(&["Enter"]).await;
    let text = String::from_utf8(page.saved().await).expect("text");
    assert!(text.contains("01 04 00 02 00 04 50 09"), "{text}");
    for (key, field) in [("y", "ring-size"), ("i", "line-baud")] {
        bench.browser.run("document.activeElement.blur()").await;
        page.press(&[key]).await;
        page.wait_for_focus(field).await;
    }
    bench.browser.run("document.activeElement.blur()").await;
    page.press(&["?"]).await;
    bench.browser.wait_for("document.querySelectorAll('[data-test=keys-sheet] kbd').length > 40").await;
}
