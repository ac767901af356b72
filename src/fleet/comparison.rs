//! Two snapshots side by side.

use buslens_codec::profile::Profile;
use buslens_configure::{Snapshot, compare};

use super::table::csv;
use crate::configure::row::Held;
use crate::configure::words;
use crate::text::Language;

/// A parameter in both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    /// The point's id.
    pub(crate) point: String,
    /// Its name.
    pub(crate) name: String,
    /// Its first register.
    pub(crate) register: u16,
    /// What the first snapshot says.
    pub(crate) left: Held,
    /// What the second one says.
    pub(crate) right: Held,
    /// Whether they differ.
    pub(crate) differs: bool,
}

/// Every parameter that either knows, in the profile's order.
pub(crate) fn rows(language: Language, profile: &Profile, left: &Snapshot, right: &Snapshot) -> Vec<Row> {
    let differences = compare(profile, left, right);
    let known = profile.points.iter().filter(|point| left.read(&point.id).is_some() || right.read(&point.id).is_some());
    let row = |point: &buslens_codec::profile::Point| Row {
        point: point.id.clone(),
        name: words::pick(language, &point.name).clone(),
        register: point.register,
        left: Held::of(language, profile, point, Some(left)),
        right: Held::of(language, profile, point, Some(right)),
        differs: differences.iter().any(|difference| difference.point == point.id),
    };
    known.map(row).collect()
}

/// A value with its unit, or why there is none.
pub(crate) fn text(held: &Held) -> String {
    if held.unit.is_empty() { held.text.clone() } else { [&held.text, " ", &held.unit].concat() }
}

/// The comparison as a table's file, with the names of both snapshots in its head.
pub(crate) fn file(language: Language, rows: &[Row], names: (&str, &str)) -> String {
    let t = language;
    let raw = |name: &str| [name, " ", t.cfg_register()].concat();
    let head = [
        t.cfg_point().to_owned(),
        t.cfg_register().to_owned(),
        names.0.to_owned(),
        raw(names.0),
        names.1.to_owned(),
        raw(names.1),
        t.fleet_differs().to_owned(),
    ];
    let line = |row: &Row| {
        vec![
            row.name.clone(),
            format!("0x{:04X}", row.register),
            plain(&text(&row.left)),
            row.left.registers.clone(),
            plain(&text(&row.right)),
            row.right.registers.clone(),
            if row.differs { t.fleet_yes() } else { t.fleet_no() }.to_owned(),
        ]
    };
    csv(&head, &rows.iter().map(line).collect::<Vec<_>>())
}

/// A number for a spreadsheet: with the minus sign of a keyboard.
fn plain(text: &str) -> String {
    text.replace('\u{2212}', "-")
}

#[cfg(test)]
mod tests {
    use buslens_configure::{Datum, Reach, Read};

    use super::*;
    use crate::device;

    fn snapshot(data: &[(&str, Read)]) -> Snapshot {
        let profile = device::find("level").profile();
        let mut snapshot = Snapshot::empty(profile, Reach::of_factory(profile));
        snapshot.data = data.iter().map(|(id, read)| Datum { point: (*id).to_owned(), read: read.clone() }).collect();
        snapshot
    }

    #[test]
    fn values_are_compared_with_their_own_scale() {
        let profile = device::find("level").profile();
        let of = |value: u16, decimals: u16| {
            snapshot(&[
                ("baud", Read::Registers(vec![3])),
                ("unit", Read::Registers(vec![7])),
                ("decimals", Read::Registers(vec![decimals])),
                ("zero_offset", Read::Registers(vec![value])),
            ])
        };
        let rows = rows(Language::En, profile, &of(0xFFFF, 3), &of(250, 1));
        let offset = rows.iter().find(|row| row.point == "zero_offset").unwrap();
        assert_eq!((text(&offset.left).as_str(), text(&offset.right).as_str()), ("−0.001 mH₂O", "25.0 mH₂O"));
        let differing: Vec<&str> = rows.iter().filter(|row| row.differs).map(|row| row.point.as_str()).collect();
        assert_eq!(differing, ["decimals", "zero_offset"]);
        assert_eq!(rows.len(), 4);
    }

    #[test]
    fn what_one_does_not_know_is_told() {
        let profile = device::find("level").profile();
        let left = snapshot(&[("baud", Read::Registers(vec![7]))]);
        let right = snapshot(&[("baud", Read::NoAnswer), ("unit", Read::Refused(2))]);
        let rows = rows(Language::En, profile, &left, &right);
        assert_eq!(rows.len(), 2);
        assert!(rows.iter().all(|row| row.differs));
        assert_eq!((text(&rows[0].left).as_str(), rows[0].right.text.as_str()), ("115200 Bd", "not read: no answer"));
        assert_eq!(rows[1].left.text, "not read");
    }

    #[test]
    fn the_file_has_a_line_a_parameter() {
        let profile = device::find("level").profile();
        let left = snapshot(&[("baud", Read::Registers(vec![7]))]);
        let right = snapshot(&[("baud", Read::Registers(vec![3]))]);
        let file = file(Language::En, &rows(Language::En, profile, &left, &right), ("A", "B"));
        assert_eq!(file.lines().nth(1), Some("Baud rate,0x0001,115200 Bd,0007,9600 Bd,0003,yes"));
    }
}
