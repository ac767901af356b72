//! The Profiles page: profiles of the user's own, from the first letter to a reading.

use std::collections::{BTreeMap, BTreeSet};

use buslens_bus::sim::{Line, Lvdt, Motion};
use buslens_codec::profile::{BUILT_IN, Profile};
use buslens_tests::pages::{BuilderPage, ConfigurePage, DecoderPage, LivePage, ProfilesPage, State};
use buslens_tests::testbed::{Bench, Look, Registers, Relay, site};
use tokio_modbus::prelude::Request;

fn lvdt() -> Line<Lvdt> {
    Line::new([Lvdt::new(1, Motion::Rest { micrometres: 1000, decidegrees: 255 })], 1)
}

/// A sensor that nobody has built in: every kind of value, each in a table of its own and in an order of its own.
const STATION: &str = r#"{
  "format": 1,
  "id": "weather-station",
  "name": { "en": "Weather station WS9", "zh": "WS9 气象站" },
  "line": { "baud": 9600, "parity": "none" },
  "mode": "rtu",
  "unit": 42,
  "units": { "first": 1, "last": 247 },
  "timing": { "response_timeout_ms": 400, "poll_period_ms": 300 },
  "points": [
    { "id": "wind", "name": { "en": "Wind", "zh": "风速" }, "register": 0, "encoding": { "type": "f32", "order": "CDAB" },
      "read": [3], "unit": "m/s", "role": "measurement", "primary": true },
    { "id": "rain", "name": { "en": "Rain", "zh": "雨量" }, "register": 2, "encoding": { "type": "u32", "decimals": 1 },
      "read": [3], "unit": "mm", "role": "measurement" },
    { "id": "height", "name": { "en": "Height", "zh": "海拔" }, "register": 4, "encoding": { "type": "i32", "order": "DCBA" },
      "read": [3], "unit": "m", "role": "measurement" },
    { "id": "pressure", "name": { "en": "Pressure", "zh": "气压" }, "register": 6, "encoding": { "type": "f64" },
      "read": [3], "unit": "hPa", "role": "measurement" },
    { "id": "pulses", "name": { "en": "Pulses", "zh": "脉冲数" }, "register": 10, "encoding": { "type": "u64", "order": "CDAB" },
      "read": [3], "role": "measurement" },
    { "id": "sky", "name": { "en": "Sky", "zh": "天空" }, "register": 14, "encoding": { "type": "bits", "mask": "0x0C00" },
      "read": [3], "role": "measurement",
      "codes": [ { "code": 0, "name": { "en": "clear", "zh": "晴" } }, { "code": 2, "name": { "en": "overcast", "zh": "阴" } } ] },
    { "id": "serial", "name": { "en": "Serial number", "zh": "序列号" }, "register": 16, "encoding": { "type": "text", "registers": 3 },
      "read": [3], "role": "measurement" },
    { "id": "temperature", "name": { "en": "Temperature", "zh": "温度" }, "register": 0, "encoding": { "type": "i16", "decimals": 1, "order": "BADC" },
      "read": [4], "unit": "°C", "role": "measurement" },
    { "id": "cabinet", "name": { "en": "Cabinet", "zh": "机箱温度" }, "register": 1, "encoding": { "type": "u16" },
      "scale": 0.1, "offset": -40, "read": [4], "unit": "°C", "role": "measurement" },
    { "id": "heater", "name": { "en": "Heater", "zh": "加热器" }, "register": 7, "encoding": { "type": "code" },
      "read": [1], "write": [5], "role": "measurement",
      "codes": [ { "code": "0xFF00", "name": { "en": "on", "zh": "开" } }, { "code": 0, "name": { "en": "off", "zh": "关" } } ] },
    { "id": "door", "name": { "en": "Door", "zh": "柜门" }, "register": 3, "encoding": { "type": "code" },
      "read": [2], "role": "measurement",
      "codes": [ { "code": "0xFF00", "name": { "en": "open", "zh": "打开" } }, { "code": 0, "name": { "en": "shut", "zh": "关闭" } } ] }
  ],
  "groups": [
    { "function": 3, "address": 0, "quantity": 15 },
    { "function": 4, "address": 0, "quantity": 2 }
  ],
  "examples": [
    { "point": "wind", "registers": ["0x0000", "0x4148"], "text": "12.5" },
    { "point": "serial", "registers": ["0x5753", "0x392D", "0x3037"], "text": "WS9-07" }
  ]
}
"#;

/// What the station's registers hold.
fn station() -> Registers {
    let pressure = 1013.25_f64.to_bits().to_be_bytes();
    let pressure: Vec<u16> = pressure.chunks(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect();
    // Minus 12 m with the last byte first.
    let height = (-12_i32).to_le_bytes();
    let (coils, discrete) = (BTreeMap::from([(7, true)]), BTreeMap::from([(3, false)]));
    Registers { unit: 42, coils, discrete, ..Registers::default() }
        .hold(0, &[0x0000, 0x4148])
        .hold(2, &[0x0001, 0x86A1])
        .hold(4, &[u16::from_be_bytes([height[0], height[1]]), u16::from_be_bytes([height[2], height[3]])])
        .hold(6, &pressure)
        .hold(10, &[0x0003, 0x0002, 0x0001, 0x0000])
        .hold(14, &[0xF8FF])
        .hold(16, &[0x5753, 0x392D, 0x3037])
        .input(0, &[u16::from_be_bytes((-55_i16).to_le_bytes()), 655])
}

/// Every reading of the station in the page's words.
const READINGS: [(&str, &str); 11] = [
    ("wind", "12.5 m/s"),
    ("rain", "10000.1 mm"),
    ("height", "−12 m"),
    ("pressure", "1013.25 hPa"),
    ("pulses", "4295098371"),
    ("sky", "overcast"),
    ("serial", "WS9-07"),
    ("temperature", "−5.5 °C"),
    ("cabinet", "25.5 °C"),
    ("heater", "on"),
    ("door", "shut"),
];

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_profile_that_nobody_built_in_reads_a_server_that_nobody_here_wrote() {
    let bench = Bench::with_wire(Relay::serve(station())).await;
    let page = ProfilesPage::open(&bench.browser).await;
    page.choose_file("ws9.json", STATION).await;
    page.wait_for_own(&["weather-station"]).await;
    assert!(page.told().await.contains("Weather station WS9"));
    bench.browser.open(&format!("{}/#/live", site())).await;
    let live = LivePage::open(&bench.browser).await;
    bench.browser.choose("profile", "weather-station").await;
    live.set_unit(42).await;
    live.connect().await;
    live.wait_for(State::Reading).await;
    for (point, text) in READINGS {
        let part = |name: &str| {
            format!("document.querySelector('[data-test=point-{point}] [data-test={name}]')?.innerText.trim()")
        };
        let shown = format!("[{}, {}].filter(Boolean).join(' ') === {text:?}", part("value"), part("unit"));
        bench.browser.wait_for(&shown).await;
    }
    assert!(live.is_faultless().await);
    bench.browser.wait_for("document.querySelector('.exchange')?.innerText.includes('read discrete inputs')").await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_profile_is_added_by_the_form_alone() {
    let bench = Bench::with_wire(Relay::serve(Registers { unit: 9, ..Registers::default() }.input(8, &[2345]))).await;
    let page = ProfilesPage::open(&bench.browser).await;
    bench.browser.click("profile-new").await;
    page.show_form().await;
    page.fill("id", "probe").await;
    page.fill("name.en", "Probe").await;
    page.fill("name.zh", "探头").await;
    page.fill("points.0.name.en", "Depth").await;
    page.fill("points.0.register", "8").await;
    page.tick("points.0.read.3", false).await;
    page.tick("points.0.read.4", true).await;
    page.pick("points.0.encoding.type", "u16").await;
    page.fill("points.0.encoding.decimals", "2").await;
    page.fill("points.0.unit", "m").await;
    page.fill("groups.0.function", "4").await;
    page.fill("groups.0.address", "8").await;
    bench.browser.click("add-examples").await;
    page.pick("examples.0.point", "value").await;
    page.fill("examples.0.registers", "2345").await;
    page.fill("examples.0.text", "23.4").await;
    // The worked example is wrong, and the field says so.
    let fault = page.fault().await;
    assert!(fault.contains("these registers are 23.45, not 23.4"), "{fault}");
    page.fill("examples.0.text", "23.45").await;
    page.wait_until_ready().await;
    page.save().await;
    page.show_text().await;
    let profile = Profile::from_json(&page.text().await).expect("what is saved loads");
    assert_eq!((profile.id.as_str(), profile.name.zh.as_str()), ("probe", "探头"));
    bench.browser.open(&format!("{}/#/live", site())).await;
    let live = LivePage::open(&bench.browser).await;
    bench.browser.choose("profile", "probe").await;
    live.set_unit(9).await;
    live.connect().await;
    let shown = "document.querySelector('[data-test=point-value] [data-test=value]')?.innerText.trim() === '23.45'";
    bench.browser.wait_for(shown).await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_fault_is_told_with_line_and_reason_and_nothing_typed_is_lost() {
    let bench = Bench::new(lvdt()).await;
    let page = ProfilesPage::open(&bench.browser).await;
    page.drop_file("ws9.json", STATION).await;
    page.wait_for_own(&["weather-station"]).await;
    page.show_text().await;
    let faulty = STATION.replace("\"parity\": \"none\"", "\"parity\": \"nome\"");
    page.write(&faulty).await;
    let line = STATION.lines().position(|line| line.contains("parity")).unwrap() + 1;
    let fault = page.fault().await;
    assert!(fault.starts_with(&format!("Line {line}, column ")), "{fault}");
    assert!(fault.contains("nome is none of none, odd, even"), "{fault}");
    let marked = "document.querySelector('.sheet-numbers [data-mark=fault]')?.innerText";
    bench.browser.wait_for(&format!("{marked} === '{line}'")).await;
    // The way to the fault puts the cursor in front of it.
    bench.browser.click("profile-go-to-fault").await;
    let at = faulty.find("\"nome\"").unwrap();
    let cursor = "document.activeElement?.dataset.test === 'profile-text' && document.activeElement.selectionStart";
    let units = faulty[..at].encode_utf16().count();
    bench.browser.wait_for(&format!("({cursor}) === {units}")).await;
    // The form shows it at its field, and it is there after a reload.
    page.show_form().await;
    assert_eq!(page.field("line.parity").await, "nome");
    bench.browser.reload().await;
    page.wait().await;
    assert!(page.fault().await.contains("nome"));
    page.show_text().await;
    assert_eq!(page.text().await, faulty);
    // Half a text is no form, and stays too.
    page.write("{ \"format\": 1,").await;
    assert!(page.fault().await.contains("ends too early"));
    bench.browser.click("profile-view-form").await;
    bench.browser.wait_for("document.querySelector('[data-test=profile-no-form]')").await;
    page.show_text().await;
    assert_eq!(page.text().await, "{ \"format\": 1,");
    // What was saved is still the device.
    bench.browser.click("profile-revert").await;
    page.wait_until_saved().await;
    assert_eq!(page.text().await, STATION);
    bench.browser.click("profile-undo").await;
    assert!(page.fault().await.contains("ends too early"));
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_built_in_profile_is_looked_at_copied_exported_and_brought_back() {
    let bench = Bench::new(lvdt()).await;
    let page = ProfilesPage::open(&bench.browser).await;
    page.choose("lvdt").await;
    page.show_text().await;
    assert_eq!(page.text().await, BUILT_IN[0]);
    assert_eq!(bench.browser.run("return document.querySelector('[data-test=profile-text]').readOnly").await, true);
    let (name, text) = page.export().await;
    assert_eq!((name.as_str(), text.as_str()), ("lvdt.json", BUILT_IN[0]));
    bench.browser.click("profile-duplicate").await;
    page.wait_for_own(&["lvdt-2"]).await;
    page.save().await;
    let copy = page.text().await;
    let profile = Profile::from_json(&copy).expect("a copy loads");
    assert_eq!((profile.id.as_str(), profile.name.en.ends_with(" (2)")), ("lvdt-2", true));
    // The same file again: its id is taken, and another one is offered.
    page.paste(&copy).await;
    let taken = "document.querySelector('[data-test=profile-id-taken]')?.innerText";
    let told = bench.browser.wait_for(taken).await;
    assert!(told.as_str().unwrap().contains("lvdt-2") && told.as_str().unwrap().contains("lvdt-3"), "{told}");
    bench.browser.click("profile-use-id").await;
    page.wait_until_ready().await;
    page.save().await;
    page.wait_for_own(&["lvdt-2", "lvdt-3"]).await;
    // Deleted by a second step, and had back.
    page.delete().await;
    page.wait_for_own(&["lvdt-2"]).await;
    bench.browser.click("profile-undo").await;
    page.wait_for_own(&["lvdt-2", "lvdt-3"]).await;
    bench.browser.reload().await;
    page.wait().await;
    page.wait_for_own(&["lvdt-2", "lvdt-3"]).await;
    // What is no profile at all is told, and nothing is added.
    page.drop_file("picture.png", "\u{0}PNG").await;
    assert!(page.told().await.contains("picture.png"));
    assert_eq!(page.own().await.len(), 2);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_profile_of_the_users_own_is_offered_wherever_devices_are() {
    let bench = Bench::new(lvdt()).await;
    let page = ProfilesPage::open(&bench.browser).await;
    page.drop_file("ws9.json", STATION).await;
    page.wait_for_own(&["weather-station"]).await;
    let builder = BuilderPage::open(&bench.browser).await;
    builder.choose_point("weather-station", "read:temperature").await;
    builder.wait_for_rtu("01 04 00 00 00 01 31 CA").await;
    let decoder = DecoderPage::open(&bench.browser).await;
    decoder.paste("2A 04 00 00 00 01 37 D1\n2A 04 02 C9 FF 8B 26").await;
    bench.browser.choose("decoder-profile", "weather-station").await;
    bench.browser.wait_for("document.body.innerText.includes('−5.5')").await;
    // Chosen for the connection, it is there after a reload, before anybody asks for the second program.
    bench.browser.open(&format!("{}/#/live", site())).await;
    let live = LivePage::open(&bench.browser).await;
    bench.browser.choose("profile", "weather-station").await;
    bench.browser.reload().await;
    bench.browser.wait_for("document.querySelector('[data-test=profile]')?.value === 'weather-station'").await;
    // It can be tried without hardware, and is deleted while it is read: the reading goes on.
    bench.browser.click("demo").await;
    live.wait_for(State::Reading).await;
    let page = ProfilesPage::open(&bench.browser).await;
    page.choose("weather-station").await;
    bench.browser.wait_for("document.querySelector('[data-test=profile-in-use]')").await;
    page.delete().await;
    page.wait_for_own(&[]).await;
    bench.browser.open(&format!("{}/#/live", site())).await;
    live.wait_for(State::Reading).await;
    bench.browser.wait_for("document.querySelector('[data-test=point-wind]')").await;
    bench.browser.click("disconnect").await;
    live.wait_for(State::Closed).await;
    bench.browser.wait_for("document.querySelector('[data-test=profile]')?.value === 'lvdt'").await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn two_tabs_see_each_others_profiles_and_a_full_storage_is_told() {
    let bench = Bench::new(lvdt()).await;
    let page = ProfilesPage::open(&bench.browser).await;
    let browser = &bench.browser;
    let address = format!("{}/#/profiles", site());
    let add = async || {
        page.wait().await;
        page.drop_file("ws9.json", STATION).await;
        page.wait_for_own(&["weather-station"]).await;
    };
    browser.in_another_tab(&address, add).await;
    page.wait_for_own(&["weather-station"]).await;
    page.choose("weather-station").await;
    page.show_text().await;
    // From now on the browser stores nothing more.
    bench.browser.run("Storage.prototype.setItem = () => { throw new DOMException('', 'QuotaExceededError'); };").await;
    page.write(&STATION.replace("WS9\"", "WS10\"")).await;
    bench.browser.wait_for("document.querySelector('[data-test=profile-refused]')").await;
    page.wait_until_ready().await;
    page.save().await;
    assert!(page.text().await.contains("WS10"));
    assert!(page.export().await.1.contains("WS10"));
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_device_with_single_bits_is_described_too() {
    let registers = Registers {
        unit: 3,
        coils: BTreeMap::from([(0, true), (1, false)]),
        discrete: BTreeMap::from([(5, true)]),
        ..Registers::default()
    }
    .hold(0, &[7]);
    let bench = Bench::with_wire(Relay::serve(registers)).await;
    let page = ProfilesPage::open(&bench.browser).await;
    bench.browser.click("profile-new").await;
    page.show_form().await;
    bench.browser.click("add-point").await;
    page.pick("points.1.encoding.type", "code").await;
    page.pick("points.1.role", "parameter").await;
    page.tick("points.1.read.3", false).await;
    page.tick("points.1.read.1", true).await;
    page.tick("points.1.write.5", true).await;
    page.fill("points.1.register", "0").await;
    page.wait_until_ready().await;
    page.save().await;
    page.show_text().await;
    let profile = Profile::from_json(&page.text().await).expect("what is saved loads");
    assert_eq!(
        (profile.points[1].read.as_slice(), profile.points[1].write.as_slice()),
        ([1].as_slice(), [5].as_slice())
    );
    let builder = BuilderPage::open(&bench.browser).await;
    builder.choose_point("my-sensor", "read:point").await;
    builder.wait_for_rtu("01 01 00 00 00 01 FD CA").await;
}

/// A device that nobody has built in, with a parameter of every kind. Each is written as its entry says.
const DRIVE: &str = include_str!("../devices/pump-drive.json");

/// What the drive holds: a period of 60 s, a stroke of -1.234 mm, a gain of 1.25, and so on.
fn drive() -> Registers {
    let coils = BTreeMap::from([(6, true), (7, true), (8, false), (9, true)]);
    Registers { unit: 17, coils, ..Registers::default() }
        .input(0, &[345])
        .hold(0x0010, &[60])
        // FFFF FB2E with the bytes of each register exchanged.
        .hold(0x0012, &[0xFFFF, 0x2EFB])
        // 1.25 is 3FA0 0000.
        .hold(0x0014, &[0x0000, 0x3FA0])
        .hold(0x0016, &[0])
        .hold(0x0017, &[0xA29F])
        .hold(0x0018, &[0x5044, 0x332D, 0x3037, 0x0000])
        .hold(0x001C, &[25])
        .hold(0x001D, &[0xFFF4])
}

/// The page over the drive, imported, connected, and read to its end.
async fn configured(bench: &Bench<Relay>) -> ConfigurePage<'_> {
    let page = ProfilesPage::open(&bench.browser).await;
    page.choose_file("pd3.json", DRIVE).await;
    page.wait_for_own(&["pump-drive"]).await;
    bench.browser.open(&format!("{}/#/live", site())).await;
    let live = LivePage::open(&bench.browser).await;
    live.choose_device("pump-drive").await;
    live.set_unit(17).await;
    live.connect().await;
    live.wait_for(State::Reading).await;
    let page = ConfigurePage::open(&bench.browser).await;
    page.wait_until_read().await;
    page
}

/// Every parameter of the drive, from the top.
const HELD: [(&str, &str); 11] = [
    ("period", "60"),
    ("stroke", "−1.234"),
    ("gain", "1.25"),
    ("mode", "stand-by"),
    ("alarm", "high"),
    ("filter", "weak"),
    ("tag", "PD3-07"),
    ("ramp", "2.5"),
    ("limit", "−12"),
    ("heater", "on"),
    ("horn", "off"),
];

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn every_kind_of_parameter_of_the_users_own_device_is_written_as_its_profile_says() {
    let bench = Bench::with_wire(Relay::serve(drive())).await;
    let page = configured(&bench).await;
    assert_eq!(page.points().await, HELD.map(|(point, _)| point));
    for (point, value) in HELD {
        assert_eq!(page.value(point).await, value, "{point}");
    }
    // The bar below the table hides no editor that the Tab key comes to.
    bench.browser.look(Look { height: 500, ..Look::default() }).await;
    assert_eq!(page.hidden_by_focus().await, [""; 0]);
    bench.browser.look(Look::default()).await;
    // What the profile does not allow is refused with what it allows.
    for (point, typed, why) in [
        ("period", "0", "allowed: 1 to 3600"),
        ("period", "65596", "allowed: 1 to 3600"),
        ("stroke", "50.001", "allowed: −50 to 50"),
        ("stroke", "1.2345", "at most 3 digits behind the point"),
        ("gain", "10.5", "allowed: 0 to 10"),
        ("tag", "PD3-07-09", "at most 8 ASCII characters"),
        ("ramp", "6553.6", "allowed: 0.0 to 6553.5"),
        ("limit", "12.5", "a whole number is needed"),
    ] {
        page.type_value(point, typed).await;
        assert_eq!(page.refusal(point).await, why, "{point} {typed}");
        page.revert(point).await;
    }
    page.wait_for_staged("Nothing staged").await;
    // A code that the table does not know cannot be chosen, and is not taken from a file either.
    assert_eq!(page.choices("mode").await, ["0x0000", "0x0004"]);
    page.bring_file("codes.json", UNKNOWN_CODES).await;
    bench
        .browser
        .wait_for("document.querySelector('[data-test=file-told]')?.innerText.includes('cannot be written')")
        .await;
    let told = bench.browser.text("file-told").await;
    assert_eq!(told, "Differs, but cannot be written: Mode, Alarm");
    page.wait_for_staged("Nothing staged").await;
    assert_eq!(bench.wire().with(|relay, _| relay.writes()), []);
    // All but the limit.
    page.type_value("period", "3600").await;
    page.type_value("stroke", "49.999 mm").await;
    page.type_value("gain", "0.1").await;
    page.choose("mode", 4).await;
    page.choose("alarm", 2).await;
    page.choose("filter", 5).await;
    page.type_value("tag", "P-1").await;
    page.type_value("ramp", "6553.5").await;
    page.choose("heater", 0).await;
    page.choose("horn", 0xFF00).await;
    page.wait_for_staged("10 changes staged").await;
    page.write_all().await;
    page.wait_for_ending("done").await;
    let points = ["period", "stroke", "gain", "mode", "alarm", "filter", "tag", "ramp", "heater", "horn"];
    assert_eq!(page.outcomes().await, points.map(|point| format!("{point}: confirmed")));
    let mut wanted = drive()
        .hold(0x0010, &[3600])
        // C34F is 49999.
        .hold(0x0012, &[0x0000, 0x4FC3])
        // 0.1 is 3DCC CCCD.
        .hold(0x0014, &[0xCCCD, 0x3DCC])
        .hold(0x0016, &[4])
        .hold(0x0017, &[0xA5AF])
        .hold(0x0018, &[0x502D, 0x3100, 0x0000, 0x0000])
        .hold(0x001C, &[0xFFFF]);
    wanted.coils.extend([(7, false), (8, true)]);
    assert_eq!(bench.wire().with(|relay, _| relay.registers()), wanted);
    assert_eq!(
        bench.wire().with(|relay, _| relay.writes()),
        [
            Request::WriteSingleRegister(0x0010, 3600),
            Request::WriteMultipleRegisters(0x0012, vec![0x0000, 0x4FC3].into()),
            Request::WriteMultipleRegisters(0x0014, vec![0xCCCD, 0x3DCC].into()),
            Request::WriteSingleRegister(0x0016, 4),
            // First the alarm beside the old filter, then the filter beside the new alarm.
            Request::WriteSingleRegister(0x0017, 0xA2AF),
            Request::WriteSingleRegister(0x0017, 0xA5AF),
            Request::WriteMultipleRegisters(0x0018, vec![0x502D, 0x3100, 0x0000, 0x0000].into()),
            Request::WriteMultipleRegisters(0x001C, vec![0xFFFF].into()),
            Request::WriteSingleCoil(7, false),
            Request::WriteMultipleCoils(8, vec![true].into()),
        ]
    );
    for (point, value) in [("stroke", "49.999"), ("gain", "0.1"), ("filter", "strong"), ("tag", "P-1"), ("horn", "on")]
    {
        page.wait_for_value(point, value).await;
    }
    // A text can be emptied.
    page.write_value("tag", "", "empty").await;
    let emptied = Request::WriteMultipleRegisters(0x0018, vec![0; 4].into());
    assert_eq!(bench.wire().with(|relay, _| relay.writes()).last(), Some(&emptied));
    page.wait_for_staged("Nothing staged").await;
    page.wait_for_no_journal().await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}

/// Parameters of the drive with codes that its tables do not know.
const UNKNOWN_CODES: &str = r#"{
  "format": 1,
  "kind": "buslens-snapshot",
  "profile": "pump-drive",
  "name": "",
  "taken": "2026-05-04T03:02:01.000Z",
  "reach": { "unit": 17, "baud": 9600, "data_bits": "eight", "parity": "none", "stop_bits": "one", "mode": "rtu" },
  "data": [
    { "point": "mode", "registers": ["0x0003"] },
    { "point": "alarm", "registers": ["0x0030"] },
    { "point": "filter", "registers": ["0x0200"] }
  ]
}
"#;

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a browser: cargo xtask test"]
async fn a_write_that_the_users_own_device_refuses_is_told_by_its_meaning_and_the_rest_is_put_back() {
    let held = Registers { locked: BTreeSet::from([0x001D]), ..drive() };
    let bench = Bench::with_wire(Relay::serve(held.clone())).await;
    let page = configured(&bench).await;
    page.type_value("gain", "9.5").await;
    page.choose("filter", 5).await;
    page.type_value("limit", "40").await;
    page.choose("horn", 0xFF00).await;
    page.write_all().await;
    let text = page.wait_for_ending("rolled-back").await;
    assert!(text.contains("Limit: refused: exception 03, value out of range"), "{text}");
    // What came after the refusal was never sent.
    let outcomes = ["gain: undone", "filter: undone", "limit: refused", "horn: waiting"];
    assert_eq!(page.outcomes().await, outcomes);
    assert_eq!(
        bench.wire().with(|relay, _| relay.writes()),
        [
            Request::WriteMultipleRegisters(0x0014, vec![0x0000, 0x4118].into()),
            Request::WriteSingleRegister(0x0017, 0xA59F),
            Request::WriteSingleRegister(0x001D, 40),
            Request::WriteSingleRegister(0x0017, 0xA29F),
            Request::WriteMultipleRegisters(0x0014, vec![0x0000, 0x3FA0].into()),
        ]
    );
    assert_eq!(bench.wire().with(|relay, _| relay.registers()), held);
    page.wait_until_read().await;
    for (point, value) in HELD {
        page.wait_for_value(point, value).await;
    }
    // What is wanted is still typed, and the rest can be written without it.
    page.wait_for_staged("4 changes staged").await;
    assert_eq!(page.typed("limit").await, "40");
    page.revert("limit").await;
    page.write_all().await;
    page.wait_for_ending("done").await;
    let mut wanted = held.hold(0x0014, &[0x0000, 0x4118]).hold(0x0017, &[0xA59F]);
    wanted.coils.insert(8, true);
    assert_eq!(bench.wire().with(|relay, _| relay.registers()), wanted);
    page.wait_for_no_journal().await;
    assert_eq!(bench.browser.complaints().await, [""; 0]);
}
