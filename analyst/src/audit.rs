//! The audit log as a file: a table, or an object a line, with the frames as they went over the line.

use std::fmt::Write as _;

use buslens_codec::json;
use buslens_codec::line::Mode;

use crate::configure::{AuditFilter, AuditForm, AuditRow};
use crate::export::text::write_moment;
use crate::export::{hex, quoted};

/// The rows that the filter lets through, as a file's text.
pub(crate) fn file(rows: &[AuditRow], filter: &AuditFilter, form: AuditForm) -> String {
    let mut out = String::new();
    if form == AuditForm::Csv {
        out.push_str("time,origin,profile,unit,simulated,line,mode,point,old,new,sent,received,end\r\n");
    }
    for row in rows.iter().filter(|row| filter.lets(row)) {
        match form {
            AuditForm::Csv => write_cells(row, &mut out),
            AuditForm::JsonLines => write_object(row, &mut out),
        }
    }
    out
}

/// A row of a table (RFC 4180).
fn write_cells(row: &AuditRow, out: &mut String) {
    let entry = &row.entry;
    let cells = [
        time(row),
        row.origin.name().to_owned(),
        quoted(&entry.profile),
        entry.reach.unit.0.to_string(),
        row.simulated.to_string(),
        entry.reach.line.to_string(),
        mode(entry.reach.mode).to_owned(),
        quoted(&entry.point),
        entry.old.as_deref().map(words).unwrap_or_default(),
        words(&entry.new),
        bytes(&entry.sent),
        bytes(&entry.received),
        entry.end.name().to_owned(),
    ];
    out.push_str(&cells.join(","));
    out.push_str("\r\n");
}

fn write_object(row: &AuditRow, out: &mut String) {
    let entry = &row.entry;
    let mut text = |key: &str, value: &str| {
        out.push_str(if key == "time" { "{\"" } else { ",\"" });
        out.push_str(key);
        out.push_str("\":");
        json::string(out, value);
    };
    text("time", &time(row));
    text("origin", row.origin.name());
    text("profile", &entry.profile);
    text("line", &entry.reach.line.to_string());
    text("mode", mode(entry.reach.mode));
    text("point", &entry.point);
    text("new", &words(&entry.new));
    if let Some(old) = &entry.old {
        text("old", &words(old));
    }
    text("sent", &bytes(&entry.sent));
    text("received", &bytes(&entry.received));
    text("end", entry.end.name());
    // Writing to a string cannot fail.
    let _ = writeln!(out, ",\"unit\":{},\"simulated\":{}}}", entry.reach.unit.0, row.simulated);
}

fn time(row: &AuditRow) -> String {
    let mut text = String::new();
    write_moment(&mut text, row.entry.unix_ms.saturating_mul(1000));
    text
}

fn mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Rtu => "rtu",
        Mode::Ascii => "ascii",
    }
}

/// Registers, four digits each.
fn words(registers: &[u16]) -> String {
    registers.iter().map(|register| format!("{register:04X}")).collect::<Vec<_>>().join(" ")
}

fn bytes(bytes: &[u8]) -> String {
    let mut text = String::new();
    hex(bytes, Some(' '), &mut text);
    text
}

#[cfg(test)]
mod tests {
    use buslens_bus::record::{End, Origin};
    use buslens_codec::UnitId;
    use buslens_codec::line::{LineSettings, Parity};
    use buslens_configure::{AuditEntry, Reach};

    use super::*;

    fn row(unit: u8, old: Option<Vec<u16>>) -> AuditRow {
        let entry = AuditEntry {
            unix_ms: 1_700_000_000_123,
            profile: "a,\"b\"".into(),
            reach: Reach { unit: UnitId(unit), line: LineSettings::new(9600, Parity::Even), mode: Mode::Rtu },
            point: "baud".into(),
            old,
            new: vec![7],
            sent: vec![0x01, 0x06, 0x00],
            received: vec![],
            end: End::Silence,
        };
        AuditRow { simulated: false, origin: Origin::Configuration, entry }
    }

    #[test]
    fn a_table_has_a_head_and_the_exact_frames() {
        let rows = [row(1, Some(vec![3])), row(2, None)];
        let wanted = AuditFilter { unit: Some(1), ..AuditFilter::default() };
        assert_eq!(
            file(&rows, &wanted, AuditForm::Csv),
            "time,origin,profile,unit,simulated,line,mode,point,old,new,sent,received,end\r\n\
             2023-11-14T22:13:20.123000Z,configuration,\"a,\"\"b\"\"\",1,false,9600 8E1,rtu,\"baud\",0003,0007,01 06 00,,silence\r\n"
        );
        assert_eq!(file(&rows, &AuditFilter::default(), AuditForm::Csv).lines().count(), 3);
    }

    #[test]
    fn each_line_is_an_object() {
        let text = file(&[row(1, Some(vec![3])), row(2, None)], &AuditFilter::default(), AuditForm::JsonLines);
        let objects: Vec<serde_json::Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!((objects[0]["unit"].as_u64(), objects[0]["old"].as_str()), (Some(1), Some("0003")));
        assert_eq!((objects[1]["sent"].as_str(), objects[1].get("old")), (Some("01 06 00"), None));
        assert_eq!(objects[1]["profile"], "a,\"b\"");
    }
}
