//! The fault matrix of `docs/fault-matrix.md`, cell by cell, through the page, the browser and a pty: how each change ends
//! that goes wrong, what the device holds then, and that the page alone brings it back.

use std::collections::BTreeMap;
use std::time::Duration;

use buslens_bus::sim::{Course, Device, GaugeCable, Level, Line, Lvdt, Motion};
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::Mode;
use buslens_codec::profile::{BUILT_IN, Effect, Point, Profile, Role};
use buslens_tests::pages::{ConfigurePage, LivePage, State};
use buslens_tests::testbed::{Bench, Strike, Struck, Wire};

const MATRIX: &str = include_str!("../../docs/fault-matrix.md");
const TROUBLES: [Trouble; 7] = [
    Trouble::Struck(Strike::Lost),
    Trouble::Struck(Strike::Corrupted),
    Trouble::Struck(Strike::Late(Duration::from_millis(700))),
    Trouble::Unplugged(Strike::Deaf),
    Trouble::Unplugged(Strike::Dumb),
    Trouble::Reloaded,
    Trouble::Struck(Strike::PowerCut),
];
/// How a sensor is reached before something that brings back its defaults: unit id, register of the baud rate.
const AWAY: (u8, u16) = (9, 4);
const AWAY_BAUD: u32 = 19_200;
/// Long, because a busy machine is no failure.
const LIMIT: Duration = Duration::from_secs(30);
/// A day after everything: no device is deaf any more.
const LATER: Duration = Duration::from_hours(24);

/// A column of the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Trouble {
    /// On the line; the page goes on by itself.
    Struck(Strike),
    /// The adapter is unplugged at the write.
    Unplugged(Strike),
    /// The page is loaded again at the write.
    Reloaded,
}

/// A row of the matrix.
struct Row {
    /// Points and values, as typed.
    edits: Vec<(String, String)>,
    /// With which of its writes it goes wrong.
    write: usize,
    cells: Vec<&'static str>,
}

/// How a device is reached, and what it holds at its parameters.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Truth {
    settings: String,
    held: BTreeMap<String, u16>,
}

fn profile(id: &str) -> Profile {
    let all = BUILT_IN.iter().map(|text| Profile::from_json(text).expect("a built-in profile"));
    all.into_iter().find(|profile| profile.id == id).expect("it is built in")
}

/// The rows of one device.
fn rows(profile: &Profile) -> Vec<Row> {
    let section =
        MATRIX.split("\n## ").find(|section| section.starts_with(&profile.name.en)).expect("it has a section");
    let lines = section.lines().filter_map(|line| line.strip_prefix("| "));
    let mut rows: Vec<Row> = Vec::new();
    for line in lines.filter(|line| !line.starts_with("step |") && !line.starts_with("---")) {
        let mut cells: Vec<&str> = line.trim_end_matches(" |").split(" | ").collect();
        let step = cells.remove(0);
        assert_eq!(cells.len(), TROUBLES.len(), "{line}");
        let (edits, write) = if let Some((_, write)) = step.split_once(" parameters at once, write ") {
            let write: usize = write.parse().expect("a number");
            let is_parameter = |row: &&Row| {
                row.edits.len() == 1
                    && profile.point(&row.edits[0].0).is_some_and(|point| point.role == Role::Parameter)
            };
            (rows.iter().filter(is_parameter).map(|row| row.edits[0].clone()).collect(), write - 1)
        } else {
            let (point, typed) = step.split_once(" = ").expect("a point and a value");
            (vec![(point.trim_matches('`').to_owned(), typed.to_owned())], 0)
        };
        rows.push(Row { edits, write, cells });
    }
    rows
}

/// What a point holds when `typed` is written to it.
fn register(point: &Point, typed: &str) -> u16 {
    let named = |name: &str| name == typed;
    let code = point.codes.iter().find(|code| {
        code.number.is_some_and(|number| named(&number.to_string()))
            || code.name.as_ref().is_some_and(|name| named(&name.en))
    });
    // A number with a point has all the decimals that the device has.
    code.map_or_else(|| typed.replace('.', "").parse().expect("a number"), |code| code.code)
}

/// A sensor as the row begins with it.
fn sensor(profile: &Profile, row: &Row) -> Box<dyn Device> {
    let mut sensor: Box<dyn Device> = match profile.id.as_str() {
        "lvdt" => Box::new(Lvdt::new(1, Motion::Rest { micrometres: -328, decidegrees: 255 })),
        "gauge-cable" => Box::new(GaugeCable::new(1, Course::Rest(1234), Instant::ZERO)),
        _ => Box::new(Level::new(1, Course::Rest(4321))),
    };
    if brings_defaults(profile, row) {
        let register = |id: &str| profile.point(id).expect("it has one").register;
        assert!(sensor.preset(register("address"), AWAY.0.into()) && sensor.preset(register("baud"), AWAY.1));
    }
    sensor
}

fn brings_defaults(profile: &Profile, row: &Row) -> bool {
    let mut effects = row.edits.iter().filter_map(|(point, _)| profile.point(point)).flat_map(|point| &point.effects);
    effects.any(|effect| matches!(effect, Effect::Defaults | Effect::Search))
}

/// Asks the device past the line.
fn truth(profile: &Profile, sensor: &mut dyn Device) -> Truth {
    let now = Instant::ZERO + LATER;
    let mut ask = |unit: u8, function: u8, register: u16, quantity: u8| {
        let ([high, low], quantity) = (register.to_be_bytes(), [0, quantity]);
        let reply = sensor.serve(now, UnitId(unit), &[&[function, high, low][..], &quantity].concat())?;
        (reply.pdu[0] == function).then_some(reply.pdu)
    };
    let sign = profile.live_groups()[0];
    let quantity = u8::try_from(sign.quantity).expect("a short read");
    let unit = (1..=255).find(|unit| ask(*unit, sign.function, sign.address, quantity).is_some()).expect("it answers");
    let parameters = profile.points.iter().filter(|point| point.role == Role::Parameter && !point.write.is_empty());
    let held = parameters.map(|point| {
        let pdu = ask(unit, 3, point.register, 1).expect("a parameter can be read");
        (point.id.clone(), u16::from_be_bytes([pdu[2], pdu[3]]))
    });
    let held = held.collect();
    let mode = if sensor.mode() == Mode::Ascii { "ASCII" } else { "RTU" };
    Truth { settings: format!("{} · {mode} · unit {unit}", sensor.line()), held }
}

/// A bench on which one cell after the other happens.
struct Cells {
    bench: Bench<Struck<Box<dyn Device>>>,
    profile: Profile,
}

impl Cells {
    async fn new(id: &str) -> Self {
        let profile = profile(id);
        let calm = Row { edits: Vec::new(), write: 0, cells: Vec::new() };
        let line = Line::new([sensor(&profile, &calm)], 7);
        Self { bench: Bench::new(Struck::at_write(line, 0, Strike::Lost)).await, profile }
    }

    fn page(&self) -> ConfigurePage<'_> {
        ConfigurePage { browser: &self.bench.browser }
    }

    fn truth(&self) -> Truth {
        self.bench.wire().with(|line, _| truth(&self.profile, line.line.device_mut(0).expect("it is on the line")))
    }

    /// A new sensor and a page that knows nothing, up to the write at which it goes wrong. Returns what the device held.
    async fn begin(&mut self, row: &Row, strike: Strike) -> Truth {
        self.bench.browser.run("localStorage.clear(); location.hash = '#/live'").await;
        self.bench.browser.reload().await;
        drop(self.bench.wire.take().map(Wire::take_apart));
        let line = Line::new([sensor(&self.profile, row)], 7);
        self.bench.plug_silently(Struck::at_write(line, row.write, strike));
        let before = self.truth();
        let page = LivePage::open(&self.bench.browser).await;
        page.choose_device(&self.profile.id).await;
        if brings_defaults(&self.profile, row) {
            self.bench.browser.choose("baud", &AWAY_BAUD.to_string()).await;
            page.set_unit(AWAY.0).await;
        }
        page.connect().await;
        page.wait_for(State::Reading).await;
        let page = ConfigurePage::open(&self.bench.browser).await;
        page.wait_until_read().await;
        for (id, typed) in &row.edits {
            let point = self.profile.point(id).expect("it is a point");
            match point.role {
                Role::Command => page.command(id, register(point, typed)).await,
                _ if point.codes.is_empty() => page.type_value(id, typed).await,
                _ => page.choose(id, register(point, typed)).await,
            }
        }
        if row.edits.iter().all(|(id, _)| self.profile.point(id).is_some_and(|point| point.role == Role::Parameter)) {
            page.review().await;
        }
        page.confirm_all().await;
        page.write().await;
        before
    }

    /// How it ends where the page goes on by itself.
    async fn goes_on(&mut self, row: &Row, strike: Strike, cell: &str) {
        let before = self.begin(row, strike).await;
        self.ends(row, cell, &before).await;
        assert!(self.bench.wire().with(|line, _| line.has_struck()));
    }

    /// How it ends where the page is cut off, and is asked to finish or undo later.
    async fn is_cut_off(&mut self, row: &Row, trouble: Trouble, way: &str, word: &str) {
        let strike = if let Trouble::Unplugged(strike) = trouble { strike } else { Strike::Dumb };
        let before = self.begin(row, strike).await;
        self.bench.wire().wait_until(LIMIT, Struck::has_struck);
        if trouble == Trouble::Reloaded {
            self.bench.browser.reload().await;
            self.bench.wire().with(|line, _| line.recover());
            self.page().wait_for_journal().await;
            self.bench.browser.run("location.hash = '#/live'").await;
            LivePage::open(&self.bench.browser).await.connect().await;
            self.bench.browser.click(&format!("journal-{way}")).await;
            self.page().wait().await;
        } else {
            let mut line = self.bench.unplug();
            self.page().wait_for_ending("interrupted").await;
            line.recover();
            self.bench.plug(line);
            self.bench.browser.click(&format!("report-{way}")).await;
        }
        self.ends(row, word, &before).await;
    }

    /// The page says how it ended, truly, and reads on.
    async fn ends(&self, row: &Row, word: &str, before: &Truth) {
        let ending = match word {
            "rolled back" => "rolled-back",
            "stays" => "undone",
            other => other,
        };
        let page = self.page();
        page.wait_for_ending(ending).await;
        let outcomes = page.outcomes().await;
        let all = |wanted: &str| outcomes.iter().all(|outcome| outcome.ends_with(&format!(": {wanted}")));
        let after = self.truth();
        match word {
            "done" if brings_defaults(&self.profile, row) => assert_ne!(after, *before),
            "done" => {
                let mut wanted = before.held.clone();
                for (id, typed) in &row.edits {
                    wanted.insert(id.clone(), register(self.profile.point(id).expect("it is a point"), typed));
                }
                assert!(all("confirmed"), "{outcomes:?}");
                assert_eq!(after.held, wanted);
            }
            "undone" => {
                assert!(all("undone"), "{outcomes:?}");
                assert_eq!(after, *before);
            }
            "rolled back" => assert_eq!(after, *before),
            "stays" => assert!(!all("undone"), "{outcomes:?}"),
            "unproven" => assert!(all("unproven"), "{outcomes:?}"),
            other => panic!("{other} is no word of the matrix"),
        }
        page.wait_for_reading_at(&after.settings).await;
        page.wait_for_no_journal().await;
    }
}

/// Lets every cell of some rows happen.
async fn happens(id: &str, wanted: impl Fn(&Row) -> bool) {
    let mut cells = Cells::new(id).await;
    let rows: Vec<Row> = rows(&cells.profile).into_iter().filter(wanted).collect();
    assert!(!rows.is_empty());
    for row in &rows {
        for (trouble, cell) in TROUBLES.into_iter().zip(&row.cells) {
            println!("{id} {:?}, write {}: {trouble:?}: {cell}", row.edits, row.write + 1);
            let Trouble::Struck(strike) = trouble else {
                let begun = if trouble == Trouble::Reloaded { "reloaded; " } else { "interrupted; " };
                let ways = cell.strip_prefix(begun).unwrap_or_else(|| panic!("{cell}"));
                for way in ways.split("; ") {
                    let (way, word) = way.split_once(": ").expect("a way and how it ends");
                    cells.is_cut_off(row, trouble, way, word).await;
                }
                continue;
            };
            cells.goes_on(row, strike, cell).await;
        }
    }
    assert_eq!(cells.bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn each_step_of_the_lvdt_ends_as_the_matrix_says() {
    happens("lvdt", |row| row.edits.len() == 1).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn all_steps_of_the_lvdt_at_once_end_as_the_matrix_says() {
    happens("lvdt", |row| row.edits.len() > 1).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn each_step_of_the_gauge_cable_ends_as_the_matrix_says() {
    happens("gauge-cable", |_| true).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn each_step_of_the_level_transmitter_ends_as_the_matrix_says() {
    happens("level", |_| true).await;
}
