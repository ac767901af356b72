//! What stands on the devices of a series: labels, and the list of them as a file.

use buslens_codec::profile::Profile;

use super::comparison;
use super::series::{Sensor, Series, State};
use super::setup::unit_point;
use super::table::csv;
use crate::components::shell::mode_name;
use crate::configure::row::Held;
use crate::configure::words;
use crate::text::{Label, Language};

/// A label's size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// Its name for storage and styles, which draw it.
    pub(crate) key: &'static str,
    /// Its name for people.
    pub(crate) text: Label,
}

/// The sizes, the usual one first. The style sheet has their measures.
pub(crate) const SIZES: [Size; 4] = [
    Size { key: "62x29", text: Language::fleet_size_62x29 },
    Size { key: "50x25", text: Language::fleet_size_50x25 },
    Size { key: "a4", text: Language::fleet_size_a4 },
    Size { key: "list", text: Language::fleet_size_list },
];

/// A label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Tag {
    /// Unit id.
    pub(crate) unit: String,
    /// Name or serial number as typed.
    pub(crate) name: String,
    /// `9600 8E1 · RTU`.
    pub(crate) line: String,
    /// Settings of the series that are not those of the line, each with its name.
    pub(crate) settings: Vec<String>,
    /// When it was set up, in milliseconds since the Unix epoch.
    pub(crate) unix_ms: u64,
}

/// The labels of the devices that are set up.
pub(crate) fn tags(language: Language, profile: &Profile, series: &Series) -> Vec<Tag> {
    let done = series.sensors.iter().filter(|sensor| sensor.state == State::Done);
    done.map(|sensor| tag(language, profile, series, sensor)).collect()
}

fn tag(language: Language, profile: &Profile, series: &Series, sensor: &Sensor) -> Tag {
    let given = series.setup.settings.iter().filter_map(|(id, _)| profile.point(id));
    // The effects of a parameter on the line stand in the line's own words.
    let own = given.filter(|point| point.effects.is_empty());
    let setting = |point: &buslens_codec::profile::Point| {
        let found = Held::of(language, profile, point, sensor.snapshot.as_ref());
        [words::pick(language, &point.name), " ", &comparison::text(&found)].concat()
    };
    Tag {
        unit: sensor.unit.to_string(),
        name: sensor.name.clone(),
        line: line(sensor),
        settings: own.map(setting).collect(),
        unix_ms: sensor.unix_ms,
    }
}

/// `9600 8E1 · RTU`; empty where the device has not been seen.
pub(crate) fn line(sensor: &Sensor) -> String {
    let place = sensor.places.first();
    place.map(|at| [&at.line.to_string(), " \u{B7} ", mode_name(at.mode)].concat()).unwrap_or_default()
}

/// How a device of the series stands, in a word.
pub(crate) fn state(language: Language, state: &State) -> &'static str {
    match state {
        State::UnderWay(_) => language.fleet_state_under_way(),
        State::Done => language.fleet_state_done(),
        State::Failed(_) => language.fleet_state_failed(),
        State::LeftOut => language.fleet_state_left_out(),
    }
}

/// The list of the series as a table's file: every device that was begun, with all that it was last read to hold. `date`
/// tells a time in milliseconds since the Unix epoch.
pub(crate) fn file(language: Language, profile: &Profile, series: &Series, date: impl Fn(u64) -> String) -> String {
    let t = language;
    let of_unit = unit_point(profile).map(|point| point.id.as_str());
    let read = |id: &str| {
        series.sensors.iter().any(|sensor| sensor.snapshot.as_ref().is_some_and(|all| all.read(id).is_some()))
    };
    let points: Vec<_> =
        profile.points.iter().filter(|point| Some(point.id.as_str()) != of_unit && read(&point.id)).collect();
    let mut titles = vec![
        t.fleet_number().to_owned(),
        t.fleet_unit_id().to_owned(),
        t.fleet_name_or_serial().to_owned(),
        t.fleet_device().to_owned(),
        t.fleet_line().to_owned(),
    ];
    titles.extend(points.iter().map(|point| words::pick(t, &point.name).clone()));
    titles.extend([t.fleet_state().to_owned(), t.fleet_when().to_owned()]);
    let row = |(at, sensor): (usize, &Sensor)| {
        let mut row = vec![
            (at + 1).to_string(),
            if sensor.unit == 0 { String::new() } else { sensor.unit.to_string() },
            sensor.name.clone(),
            words::pick(t, &profile.name).clone(),
            line(sensor),
        ];
        let value = |point: &&buslens_codec::profile::Point| {
            let found = Held::of(t, profile, point, sensor.snapshot.as_ref());
            if sensor.snapshot.is_some() { comparison::text(&found).replace('\u{2212}', "-") } else { String::new() }
        };
        row.extend(points.iter().map(value));
        row.extend([state(t, &sensor.state).to_owned(), date(sensor.unix_ms)]);
        row
    };
    csv(&titles, &series.sensors.iter().enumerate().map(row).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use buslens_codec::UnitId;
    use buslens_configure::{Datum, Reach, Read, Snapshot};

    use super::*;
    use crate::device;
    use crate::fleet::addresses::Addresses;
    use crate::fleet::series::Failure;
    use crate::fleet::setup::Setup;

    fn series(profile: &Profile) -> Series {
        let setup = Setup {
            profile: profile.id.clone(),
            addresses: Addresses::parse(profile, "10", "1", "").unwrap(),
            settings: vec![("baud".into(), "115200".into()), ("sample_rate".into(), "50".into())],
            finish: None,
            everywhere: true,
            accepted: Vec::new(),
        };
        let mut series = Series::new(0, setup);
        let mut reach = Reach { unit: UnitId(10), ..Reach::of_factory(profile) };
        reach.line.baud = 115_200;
        let mut snapshot = Snapshot::empty(profile, reach);
        for (point, register) in [("address", 10), ("baud", 7), ("sample_rate", 6)] {
            snapshot.data.push(Datum { point: point.into(), read: Read::Registers(vec![register]) });
        }
        series.sensors.push(Sensor {
            name: "SN 0815, left".into(),
            unit: 10,
            unix_ms: 5,
            state: State::Done,
            places: vec![reach],
            snapshot: Some(snapshot),
        });
        series.sensors.push(Sensor {
            name: String::new(),
            unit: 11,
            unix_ms: 6,
            state: State::Failed(Box::new(Failure::Broken)),
            places: Vec::new(),
            snapshot: None,
        });
        series
    }

    #[test]
    fn a_label_says_how_the_device_is_reached() {
        let profile = device::find("lvdt").profile();
        let tags = tags(Language::En, profile, &series(profile));
        let wanted = Tag {
            unit: "10".into(),
            name: "SN 0815, left".into(),
            line: "115200 8E1 · RTU".into(),
            settings: vec!["Sample rate 50 Hz".into()],
            unix_ms: 5,
        };
        assert_eq!(tags, [wanted]);
    }

    #[test]
    fn the_list_tells_the_failed_ones_too() {
        let profile = device::find("lvdt").profile();
        let text = file(Language::En, profile, &series(profile), |unix_ms| format!("t{unix_ms}"));
        let lines: Vec<&str> = text.lines().collect();
        let name = &profile.name.en;
        assert_eq!(lines[0], "\u{FEFF}No.,Unit id,Name or serial number,Device,Line,Baud rate,Sample rate,State,Time");
        assert_eq!(lines[1], format!("1,10,\"SN 0815, left\",{name},115200 8E1 · RTU,115200 Bd,50 Hz,set up,t5"));
        assert_eq!(lines[2], format!("2,11,,{name},,,,failed,t6"));
    }
}
