//! The list of frames.

use buslens_analyst::message::Row;
use buslens_codec::dissect::{Direction, Dissection, dissect_known};
use buslens_codec::pdu::Request;
use buslens_codec::profile::{Known, Profile};

use crate::anatomy::Facts;
use crate::components::list::{Source, list};
use crate::device::Device;
use crate::dom::{El, el};
use crate::format::{self, hex_spaced};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// Bytes of a row that are drawn; the rest is cut off by the row's edge anyway.
const BYTES: usize = 64;

/// The list with its head.
pub(super) fn frame_list(app: &'static Workbench) -> El {
    let desk = &app.decoder;
    let heads = [
        ("cell-direction", Language::direction as Label),
        ("cell-unit number", Language::unit_short),
        ("cell-function", Language::function),
        ("cell-meaning", Language::meaning),
        ("cell-check", Language::check),
        ("cell-bytes", Language::bytes),
    ];
    let cells = heads.into_iter().map(|(class, text)| el("span").class(class).say(app, text));
    let head = el("div")
        .class("list-row list-head")
        .attr("aria-hidden", "true")
        .child(el("span").class("cell-number number").text("#"))
        .child(el("span").class("cell-time").say(app, Language::time))
        .children(cells);
    let timed = Memo::new(move |_| {
        desk.turn.track();
        desk.row(0).is_some_and(|row| row.time_us.is_some())
    });
    let source = Source {
        total: Memo::new(move |_| desk.progress.with(|progress| progress.shown)),
        turn: desk.turn,
        stamp: |app, at| app.decoder.with_row(at, |row| stamp(app, at, row)),
        draw: |app, at| app.decoder.with_row(at, |row| draw(app, row)),
        want: |app, places| app.decoder.want(places),
        chosen: desk.chosen,
        hook: "frame-row",
    };
    el("div")
        .class("contents")
        .child(list(app, "frames", Language::frames, head, source).state("data-timed", move || timed.get()))
}

/// A row that has been drawn is drawn anew when the analyst has new words on it.
fn stamp(app: &'static Workbench, at: u32, row: &Row) -> u64 {
    let edition = app.decoder.progress.with_untracked(|progress| progress.edition);
    let counted = app.decoder.statistics.with_untracked(Option::is_some);
    let zh = app.language.get_untracked() == Language::Zh;
    u64::from(edition) << 34 | u64::from(at ^ row.index) << 2 | u64::from(counted) << 1 | u64::from(zh)
}

/// A row's frame taken apart.
pub(super) struct Opened {
    /// What it answers, if that is known.
    pub(super) request: Option<Request>,
    /// `None` for noise.
    pub(super) dissection: Option<Dissection>,
}

impl Opened {
    pub(super) fn of(profile: Option<&Profile>, row: &Row) -> Self {
        let request = Request::decode(&row.request).ok();
        let mut known = Known::default();
        if let Some(profile) = profile {
            for (function, address, value) in &row.told {
                profile.decode_points(*function, *address, &[*value], &mut known);
            }
        }
        let taken = || dissect_known(&row.bytes, row.mode, row.direction, request.as_ref(), profile, &mut known);
        let dissection = row.is_frame.then(taken).flatten();
        Self { request, dissection }
    }
}

fn draw(app: &'static Workbench, row: &Row) -> El {
    let language = app.language.get_untracked();
    let profile = app.decoder.device_untracked().map(Device::profile);
    let opened = Opened::of(profile, row);
    let facts = opened.dissection.as_ref().map(|found| Facts::of(language, profile, &row.bytes, found));
    let cell = |class: &str, text: &str| el("span").class(class).text(text);
    let time = row.time_us.map(format::clock).unwrap_or_default();
    let mut bytes = hex_spaced(&row.bytes[..row.bytes.len().min(BYTES)]);
    if row.bytes.len() > BYTES {
        bytes = language.more_bytes(&format::count(row.length.into()));
    }
    let shell = el("div").class("list-row");
    let shell = shell
        .child(cell("cell-number number muted", &format::count(u64::from(row.index) + 1)))
        .child(cell("cell-time mono", &time));
    let Some(Facts { direction, unit, function, meaning, check_ok, expected, .. }) = &facts else {
        let tag = el("span").class("tag").text(language.noise());
        return shell
            .child(cell("cell-direction", ""))
            .child(cell("cell-unit", ""))
            .child(cell("cell-function", ""))
            .child(cell("cell-meaning muted", language.no_frame()))
            .child(el("span").class("cell-check").child(tag))
            .child(cell("cell-bytes mono", &bytes));
    };
    let (class, direction) = match direction {
        Direction::Request => ("cell-direction direction tx", "TX"),
        Direction::Response => ("cell-direction direction rx", "RX"),
        Direction::Unknown => ("cell-direction direction", "?"),
    };
    shell
        .child(cell(class, direction))
        .child(cell("cell-unit number", &unit.to_string()))
        .child(cell("cell-function", function))
        .child(cell("cell-meaning", meaning))
        .child(check_cell(language, row, *check_ok, expected))
        .child(cell("cell-bytes mono", &bytes))
}

fn check_cell(language: Language, row: &Row, check_ok: bool, expected: &str) -> El {
    let tag = |class: &str, text: &str| el("span").class(class).text(text);
    let cell = el("span").class("cell-check");
    if !check_ok {
        return cell
            .child(tag("tag bad", language.check_bad()))
            .child(tag("expected", &language.check_expected(expected)));
    }
    let cell = cell.child(tag("tag ok", language.check_ok()));
    if row.unanswered {
        cell.child(tag("tag warn", language.unanswered()))
    } else if row.orphan {
        cell.child(tag("tag warn", language.orphan()))
    } else {
        cell
    }
}
