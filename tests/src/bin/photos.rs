//! Takes pictures of every page in its main states, in both languages and themes and at three widths, to be looked at by
//! people: `photos <address of the site> <folder> [beginning of the scenes' names]`. A new page adds its states to
//! [`SCENES`].

use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{env, fs};

use buslens_bus::sim::{Device, Line, Lvdt, Motion};
use buslens_codec::line::Parity;
use buslens_tests::pages::{
    BuilderPage, ConfigurePage, ConsolePage, DecoderPage, FleetPage, Handling, HelpSheet, LivePage, ProfilesPage,
    State, set_read_only,
};
use buslens_tests::testbed::{Bench, Browser, Look};

const LANGUAGES: [&str; 2] = ["en", "zh-CN"];
const WIDTHS: [(u32, u32); 3] = [(1440, 900), (1024, 768), (390, 844)];

/// A page in a state.
#[derive(Clone, Copy)]
enum Scene {
    LiveEmpty,
    LiveReading,
    LiveLevel,
    LiveCable,
    LiveReadOnly,
    LiveFault,
    ConsoleEmpty,
    ConsoleLog,
    ConsoleSnippets,
    ConsoleFault,
    ConsoleKeys,
    ConsoleBuild,
    ConsoleSequence,
    ConsoleBrought,
    DecoderEmpty,
    DecoderFrames,
    DecoderDamaged,
    DecoderError,
    BuilderEmpty,
    BuilderFrame,
    BuilderError,
    ProfilesList,
    ProfilesForm,
    ProfilesFault,
    HelpLvdt,
    HelpGauge,
    HelpLevel,
    FleetSnapshots,
    FleetSetup,
    FleetNext,
    FleetFailed,
    FleetLabels,
    FleetLog,
    ConfigureTable,
    ConfigureStaged,
    ConfigureReview,
    ConfigureDone,
    ConfigureLost,
    ConfigureJournal,
    Crash,
}

/// Every scene with the name of its pictures. The crash comes last: the page does not survive it.
const SCENES: [(&str, Scene); 40] = [
    ("live-empty", Scene::LiveEmpty),
    ("live-reading", Scene::LiveReading),
    ("live-level", Scene::LiveLevel),
    ("live-cable", Scene::LiveCable),
    ("live-read-only", Scene::LiveReadOnly),
    ("live-fault", Scene::LiveFault),
    ("console-empty", Scene::ConsoleEmpty),
    ("console-log", Scene::ConsoleLog),
    ("console-snippets", Scene::ConsoleSnippets),
    ("console-fault", Scene::ConsoleFault),
    ("console-keys", Scene::ConsoleKeys),
    ("console-build", Scene::ConsoleBuild),
    ("console-sequence", Scene::ConsoleSequence),
    ("console-brought", Scene::ConsoleBrought),
    ("decoder-empty", Scene::DecoderEmpty),
    ("decoder-frames", Scene::DecoderFrames),
    ("decoder-damaged", Scene::DecoderDamaged),
    ("decoder-error", Scene::DecoderError),
    ("builder-empty", Scene::BuilderEmpty),
    ("builder-frame", Scene::BuilderFrame),
    ("builder-error", Scene::BuilderError),
    ("profiles-list", Scene::ProfilesList),
    ("profiles-form", Scene::ProfilesForm),
    ("profiles-fault", Scene::ProfilesFault),
    ("help-lvdt", Scene::HelpLvdt),
    ("help-gauge", Scene::HelpGauge),
    ("help-level", Scene::HelpLevel),
    ("fleet-snapshots", Scene::FleetSnapshots),
    ("fleet-setup", Scene::FleetSetup),
    ("fleet-next", Scene::FleetNext),
    ("fleet-failed", Scene::FleetFailed),
    ("fleet-labels", Scene::FleetLabels),
    ("fleet-log", Scene::FleetLog),
    ("configure-table", Scene::ConfigureTable),
    ("configure-staged", Scene::ConfigureStaged),
    ("configure-review", Scene::ConfigureReview),
    ("configure-done", Scene::ConfigureDone),
    ("configure-lost", Scene::ConfigureLost),
    ("configure-journal", Scene::ConfigureJournal),
    ("crash", Scene::Crash),
];

/// An exchange, a refusal, a reply with a wrong bit, the manual's misprint.
const FRAMES: &str = "0C 04 00 04 00 02 31 17\n0C 04 04 80 00 01 48 0F 22\n0C 04 00 04 00 01 71 16\n0C 84 02 53 02\n\
                      0C 04 00 04 00 02 31 17\n0C 04 04 80 00 01 49 0F 22\n01 05 00 50 FF 00 8C 2B\n01 05 00 50 FF 00 8C 2B";

#[tokio::main]
async fn main() {
    let mut arguments = env::args_os().skip(1);
    let (Some(site), Some(album)) = (arguments.next(), arguments.next()) else {
        panic!("photos <address of the site> <folder>");
    };
    let site = site.into_string().expect("an address is text");
    let album = PathBuf::from(album);
    let wanted = arguments.next().and_then(|wanted| wanted.into_string().ok()).unwrap_or_default();
    for language in LANGUAGES {
        let look = Look { language, ..Look::default() };
        let line = Line::new([Lvdt::new(1, Motion::Swing)], 1);
        let bench = Bench::at(&site, buslens_tests::testbed::Wire::new(line), look).await;
        for (name, scene) in SCENES.into_iter().filter(|(name, _)| name.starts_with(&wanted)) {
            set(&bench, &site, scene).await;
            photograph(&bench, &album, name, look).await;
            println!("{name} {language}");
        }
    }
}

/// Brings the page into a scene.
async fn set(bench: &Bench<Line<Lvdt>>, site: &str, scene: Scene) {
    let browser = &bench.browser;
    match scene {
        Scene::LiveEmpty
        | Scene::LiveReading
        | Scene::LiveLevel
        | Scene::LiveCable
        | Scene::LiveReadOnly
        | Scene::LiveFault => set_live(browser, scene).await,
        Scene::ConsoleEmpty
        | Scene::ConsoleLog
        | Scene::ConsoleSnippets
        | Scene::ConsoleFault
        | Scene::ConsoleKeys
        | Scene::ConsoleBuild
        | Scene::ConsoleSequence
        | Scene::ConsoleBrought => set_console(browser, site, scene).await,
        Scene::DecoderEmpty => {
            disconnect(browser).await;
            DecoderPage::open_at(browser, site).await;
        }
        Scene::DecoderFrames => {
            let page = DecoderPage::open_at(browser, site).await;
            page.paste(FRAMES).await;
            page.rows(8).await;
            browser.click_nth("frame-row", 1).await;
        }
        Scene::DecoderDamaged => {
            let page = DecoderPage::open_at(browser, site).await;
            page.paste(FRAMES).await;
            page.rows(8).await;
            browser.click_nth("frame-row", 5).await;
            page.diagnosis("single_bit_error").await;
            browser.click("views").await;
            browser.fill("shown-value", "-0.328").await;
        }
        Scene::DecoderError => {
            let page = DecoderPage::open_at(browser, site).await;
            page.paste("01 03 00 31 00 01 D5 C5 01 03 02 00 07 F9 8G").await;
            page.error().await;
        }
        Scene::BuilderEmpty => {
            BuilderPage::open_at(browser, site).await;
        }
        Scene::BuilderFrame => {
            let page = BuilderPage::open_at(browser, site).await;
            page.choose_point("lvdt", "write:parity").await;
            page.choose_value(2).await;
            page.wait_for_rtu("01 10 00 32 00 01 02 00 02 23 83").await;
            page.calculate("01 03 00 31 00 01 D5 C5").await;
        }
        Scene::BuilderError => {
            let page = BuilderPage::open_at(browser, site).await;
            page.fill("values", "2 70000").await;
            page.fill("unit", "300").await;
            page.calculate("01 03 00 31\n00 0x").await;
            browser.wait_for("document.querySelector('[data-test=calculator-error]')").await;
        }
        Scene::ProfilesList | Scene::ProfilesForm | Scene::ProfilesFault => set_profiles(browser, site, scene).await,
        Scene::HelpLvdt => open_help(browser, "lvdt").await,
        Scene::HelpGauge => open_help(browser, "gauge-cable").await,
        Scene::HelpLevel => open_help(browser, "level").await,
        Scene::FleetSnapshots
        | Scene::FleetSetup
        | Scene::FleetNext
        | Scene::FleetFailed
        | Scene::FleetLabels
        | Scene::FleetLog => set_fleet(bench, site, scene).await,
        Scene::ConfigureTable
        | Scene::ConfigureStaged
        | Scene::ConfigureReview
        | Scene::ConfigureDone
        | Scene::ConfigureLost
        | Scene::ConfigureJournal => set_configure(bench, site, scene).await,
        Scene::Crash => {
            browser.open(site).await;
            LivePage::open(browser).await;
            browser.click("demo").await;
            browser.wait_for("document.querySelector('[data-test=state][data-state=reading]')").await;
            browser.break_the_worker().await;
            browser.wait_for("document.querySelector('[data-test=crash]')").await;
        }
    }
}

/// Brings the Live page into a scene.
async fn set_live(browser: &Browser, scene: Scene) {
    match scene {
        Scene::LiveEmpty => {
            LivePage::open(browser).await;
            browser.wait_for("document.querySelector('[data-test=port]')?.value").await;
        }
        Scene::LiveReading => {
            let page = LivePage::open(browser).await;
            browser.click("demo").await;
            page.wait_for(State::Reading).await;
            // Enough of a curve to be looked at.
            page.wait_for_count("replies", 150).await;
        }
        Scene::LiveLevel => {
            let page = demonstrate(browser, "level").await;
            page.live().show_in("psi").await;
            page.unfold_risky().await;
            page.press("save", 1).await;
            page.question().await;
            page.live().wait_for_count("replies", 60).await;
        }
        Scene::LiveCable => {
            let page = demonstrate(browser, "gauge-cable").await;
            page.live().wait_for_count("replies", 60).await;
            page.give("clear_record", 0).await;
            page.outcome("done").await;
            page.frames().await;
        }
        Scene::LiveReadOnly => {
            let page = demonstrate(browser, "lvdt").await;
            page.set_read_only(true).await;
            page.locked("read-only").await;
        }
        Scene::LiveFault => {
            let page = LivePage::open(browser).await;
            set_read_only(browser, false).await;
            browser.click("disconnect").await;
            page.wait_for(State::Closed).await;
            page.set_line(19_200, Parity::Even).await;
            page.connect().await;
            page.fault("silence").await;
        }
        _ => {}
    }
}

/// Reads another simulated device.
async fn demonstrate<'a>(browser: &'a Browser, device: &str) -> Handling<'a> {
    let page = LivePage::open(browser).await;
    browser.click("disconnect").await;
    page.wait_for(State::Closed).await;
    page.choose_device(device).await;
    browser.click("demo").await;
    page.wait_for(State::Reading).await;
    Handling::open(browser).await
}

/// Brings the Profiles page into a scene.
async fn set_profiles(browser: &Browser, site: &str, scene: Scene) {
    match scene {
        Scene::ProfilesList => {
            ProfilesPage::open_at(browser, site).await;
        }
        Scene::ProfilesForm => {
            let page = ProfilesPage::open_at(browser, site).await;
            page.choose("level").await;
            browser.click("profile-duplicate").await;
            page.save().await;
            page.show_form().await;
            browser.click_nth("profile-point", 1).await;
            // The driver scrolls a row into view that is wider than its place.
            browser.run("document.querySelector('[data-test=profile-point]').closest('.scroll').scrollLeft = 0").await;
        }
        Scene::ProfilesFault => {
            let page = ProfilesPage { browser };
            page.show_text().await;
            let text = page.text().await;
            page.write(&text.replacen("\"rtu\"", "\"rtx\"", 1)).await;
            page.fault().await;
        }
        _ => {}
    }
}

/// Ends the connection that an earlier scene has left, if there is one.
async fn disconnect(browser: &Browser) {
    browser.run("document.querySelector('[data-test=disconnect]')?.click()").await;
}

/// Opens the help of a device over the Live page.
async fn open_help(browser: &Browser, device: &str) {
    if device != "lvdt" {
        HelpSheet { browser }.close().await;
    }
    browser.click("nav-live").await;
    LivePage::open(browser).await;
    browser.choose("profile", device).await;
    HelpSheet::open(browser).await;
}

/// Brings the Console page into a scene.
async fn set_console(browser: &Browser, site: &str, scene: Scene) {
    match scene {
        Scene::ConsoleEmpty => {
            disconnect(browser).await;
            ConsolePage::open_at(browser, site).await.wait_for_line("closed").await;
        }
        Scene::ConsoleLog => {
            let page = ConsolePage::open_at(browser, site).await;
            browser.click("demo").await;
            page.wait_for_count_at_least(60).await;
            page.send("01 03 00 31 00 01").await;
            page.result("answered").await;
            browser.click("follow").await;
            // The list stands still, and what is in sight of it has come.
            let come = "document.querySelector('[data-test=follow][aria-pressed=false]') && \
                        [...document.querySelectorAll('[data-test=console-row]')].every((row) => row.innerText.trim())";
            browser.wait_for(come).await;
            page.choose_row(3).await;
            page.comment("nudged by hand").await;
        }
        Scene::ConsoleSnippets => {
            let page = ConsolePage::open_at(browser, site).await;
            page.open_pane("snippets").await;
            browser.fill("snippet-name", "Baud rate").await;
            browser.fill("snippet-folder", "Bench 3").await;
            browser.click("snippet-save").await;
            page.set_check("wrong").await;
            page.repeat(200, 3).await;
        }
        Scene::ConsoleFault => {
            let page = ConsolePage::open_at(browser, site).await;
            browser.click("repeat").await;
            page.set_check("crc").await;
            page.open_pane("counts").await;
            page.type_line("01 03 00 31 00 0").await;
            page.set_line("baud", "19200").await;
        }
        Scene::ConsoleKeys => {
            browser.click("keys").await;
            browser.wait_for("document.querySelector('[data-test=keys-sheet]')").await;
        }
        Scene::ConsoleBuild => {
            browser.click("keys-close").await;
            browser.click("build").await;
            browser.wait_for("document.querySelector('[data-test=builder-dialog]')").await;
        }
        Scene::ConsoleSequence => {
            browser.click("builder-close").await;
            let page = ConsolePage { browser };
            page.open_sequences().await;
            page.choose_ready_made(0).await;
            page.wait_for_right_sequence().await;
            page.run_sequence().await;
            page.wait_for_verdict("passed").await;
        }
        Scene::ConsoleBrought => {
            let page = ConsolePage { browser };
            page.open_pane("frame").await;
            page.drop_file("bench.log", FRAMES).await;
            page.wait_for_count("8").await;
            page.choose_row(5).await;
        }
        _ => {}
    }
}

/// Brings the Fleet page into a scene. They follow each other.
async fn set_fleet(bench: &Bench<Line<Lvdt>>, site: &str, scene: Scene) {
    let browser = &bench.browser;
    let page = FleetPage { browser };
    let plug = |presets: &[(u16, u16)]| {
        bench.wire().with(|line, _| {
            let sensor = line.device_mut(0).expect("the line has a sensor");
            *sensor = Lvdt::new(1, Motion::Swing);
            assert!(presets.iter().all(|&(register, value)| sensor.preset(register, value)), "{presets:?}");
        });
    };
    match scene {
        Scene::FleetSnapshots => {
            browser.open(&format!("{site}/#/live")).await;
            // What lay over the page before does not any more.
            browser.reload().await;
            let live = LivePage::open(browser).await;
            browser.wait_for("document.querySelector('[data-test=port]')?.value").await;
            live.choose_device("lvdt").await;
            live.set_line(9600, Parity::Even).await;
            live.set_unit(1).await;
            live.connect().await;
            live.wait_for(State::Reading).await;
            let page = FleetPage::open_at(browser, site).await;
            page.take("Press 4, left").await;
            plug(&[(0x003F, 6), (0x0034, 1)]);
            page.take("Press 4, after service").await;
            page.compare_with_device(1).await;
            page.wait_for_differences(2).await;
        }
        Scene::FleetSetup => {
            plug(&[]);
            page.pane("series").await;
            browser.fill("series-first", "10").await;
            browser.fill("series-skip", "12, 20-24").await;
            browser.choose("give-baud", "0x0001").await;
            browser.choose("give-sample_rate", "0x0006").await;
            browser.wait_for("document.querySelector('[data-test=series-hazard]')").await;
        }
        Scene::FleetNext => {
            page.begin_series(10, &[("baud", 4)]).await;
            page.set_up("SN 2026-0815").await;
            plug(&[]);
            page.set_up("SN 2026-0816").await;
        }
        Scene::FleetFailed => page.set_up("").await,
        Scene::FleetLabels => {
            browser.click("series-later").await;
            browser.choose("label-size", "list").await;
        }
        Scene::FleetLog => {
            page.pane("audit").await;
            // Those of this page's scenes, and what came of the ones before.
            let all = "document.querySelector('[data-test=audit-count]')?.dataset.count >= 6";
            browser.wait_for(all).await;
            browser.click_nth("audit-row", 1).await;
            plug(&[]);
            browser.click("disconnect").await;
            LivePage { browser }.wait_for(State::Closed).await;
        }
        _ => {}
    }
}

/// Brings the Configure page into a scene. They follow each other.
async fn set_configure(bench: &Bench<Line<Lvdt>>, site: &str, scene: Scene) {
    let browser = &bench.browser;
    let page = ConfigurePage { browser };
    match scene {
        Scene::ConfigureTable => {
            browser.open(&format!("{site}/#/live")).await;
            let live = LivePage::open(browser).await;
            live.set_line(9600, Parity::Even).await;
            live.set_unit(1).await;
            live.connect().await;
            live.wait_for(State::Reading).await;
            ConfigurePage::open_at(browser, site).await.wait_until_read().await;
            // The sensor is another one than an earlier scene has read.
            browser.click("read-again").await;
            page.wait_until_read().await;
        }
        Scene::ConfigureStaged => {
            page.choose("baud", 7).await;
            page.choose("sample_rate", 6).await;
            page.type_value("address", "300").await;
            page.refusal("address").await;
        }
        Scene::ConfigureReview => {
            page.type_value("address", "12").await;
            page.choose("baud", 1).await;
            page.review().await;
        }
        Scene::ConfigureDone => {
            browser.click("review-back").await;
            page.type_value("address", "1").await;
            page.choose("baud", 7).await;
            page.write_all().await;
            page.wait_for_ending("done").await;
            page.wait_until_read().await;
        }
        Scene::ConfigureLost => {
            browser.click("report-close").await;
            page.choose("parity", 3).await;
            let from = bench.wire().sent().len();
            page.write_all().await;
            let write = [0x10, 0x00, 0x32];
            let has_written = |sent: &[u8]| sent.windows(write.len()).any(|window| window == write);
            bench.wire().wait_for_sent(from, Duration::from_secs(30), has_written);
            bench.wire().with(|line, _| line.faults.lost_replies = u32::MAX);
            // The search of all settings takes longer than anything else here: half of it is waited for by itself.
            let half = "(bar => bar && bar.max > 42 && bar.value > bar.max / 2)(document.querySelector('[data-test=run-card] progress'))";
            browser.wait_for(half).await;
            page.wait_for_ending("lost").await;
        }
        Scene::ConfigureJournal => {
            browser.run("location.hash = '#/live'").await;
            browser.reload().await;
            bench.wire().with(|line, _| line.faults.lost_replies = 0);
            page.wait_for_journal().await;
        }
        _ => {}
    }
}

async fn photograph(bench: &Bench<Line<Lvdt>>, album: &Path, name: &str, look: Look) {
    for dark in [false, true] {
        for (width, height) in WIDTHS {
            bench.browser.look(Look { dark, width, height, ..look }).await;
            // A page that does not fit a phone is shown smaller.
            let fits = format!("return document.documentElement.scrollWidth <= {width}");
            if bench.browser.run(&fits).await != true {
                println!("{name} {} is wider than {width}", look.language);
            }
            let picture = bench.browser.picture().await;
            let theme = if dark { "dark" } else { "light" };
            let file = album.join(format!("{name}-{}-{theme}-{width}.png", look.language));
            fs::write(&file, picture).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        }
    }
    bench.browser.look(look).await;
}
