//! The list of frames.

use std::hash::{DefaultHasher, Hash, Hasher};

use buslens_analyst::message::Row;
use buslens_bus::record::{Event, Origin};
use buslens_codec::dissect::{Direction, Dissection, dissect_known};
use buslens_codec::pdu::Request;
use buslens_codec::profile::{Known, Profile};

use super::Desk;
use super::stamps::{MOST, span};
use crate::anatomy::Facts;
use crate::components::icon::{Icon, icon};
use crate::components::list::{Growing, Source, list};
use crate::components::shell::mode_name;
use crate::device::Device;
use crate::dom::{El, el};
use crate::format;
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// The list with its head.
pub(crate) fn frame_list(app: &'static Workbench, desk: &'static Desk) -> El {
    let timed = Memo::new(move |_| {
        desk.turn.track();
        desk.is_live() || desk.row(0).is_some_and(|row| row.time_us.is_some())
    });
    let source = Source {
        total: Memo::new(move |_| desk.progress.with(|progress| progress.shown)),
        gone: desk.gone,
        turn: desk.turn,
        stamp: Box::new(move |at| desk.with_row(at, |row| stamp(app, desk, at, row))),
        draw: Box::new(move |at| desk.with_row(at, |row| draw(app, desk, row))),
        want: Box::new(move |places| desk.want(places)),
        seek: Box::new(move || desk.sought()),
        chosen: desk.chosen,
        growing: desk.is_live().then_some(Growing { follow: desk.follow, anchor: desk.anchor, rewound: desk.rewound }),
        hook: if desk.is_live() { "console-row" } else { "frame-row" },
    };
    let class = if desk.is_live() { "frames log" } else { "frames" };
    let list = list(app, class, Language::frames, head(app, desk), source);
    el("div").class("contents").child(list.state("data-timed", move || timed.get()))
}

fn head(app: &'static Workbench, desk: &'static Desk) -> El {
    let heads = [
        ("cell-direction", Language::direction as Label),
        ("cell-origin", Language::origin),
        ("cell-unit number", Language::unit_short),
        ("cell-function", Language::function),
        ("cell-meaning", Language::meaning),
        ("cell-check", Language::check),
        ("cell-gap number", Language::gap),
        ("cell-trip number", Language::round_trip_short),
        ("cell-bytes", Language::bytes),
    ];
    let of_lines = |class: &str| ["cell-origin", "cell-gap number", "cell-trip number"].contains(&class);
    let cells = heads.into_iter().filter(|(class, _)| desk.is_live() || !of_lines(class));
    el("div")
        .class("list-row list-head")
        .attr("aria-hidden", "true")
        .child(el("span").class("cell-number number").text("#"))
        .child(el("span").class("cell-time").say(app, Language::time))
        .children(cells.map(|(class, text)| el("span").class(class).say(app, text)))
}

/// A row that has been drawn is drawn anew when the analyst has new words on it, or other words are wanted.
fn stamp(app: &'static Workbench, desk: &'static Desk, at: u32, row: &Row) -> u64 {
    let edition = desk.progress.with_untracked(|progress| progress.edition);
    let zh = app.language.get_untracked() == Language::Zh;
    if !desk.is_live() {
        let counted = desk.statistics.with_untracked(Option::is_some);
        return u64::from(edition) << 34 | u64::from(at ^ row.index) << 2 | u64::from(counted) << 1 | u64::from(zh);
    }
    let mut hasher = DefaultHasher::new();
    let told = (desk.times.get_untracked() as u8, desk.bytes.get_untracked() as u8, desk.clock.get_value());
    (row.index, row.pair, row.unanswered, row.orphan, &row.mark, row.diagnoses.len()).hash(&mut hasher);
    (row.before.len(), row.length, row.round_trip_us, row.gap_us, told, zh).hash(&mut hasher);
    desk.progress.with_untracked(|progress| progress.profile.hash(&mut hasher));
    hasher.finish()
}

/// A row's frame taken apart.
pub(crate) struct Opened {
    /// What it answers, if that is known.
    pub(crate) request: Option<Request>,
    /// `None` for noise.
    pub(crate) dissection: Option<Dissection>,
}

impl Opened {
    pub(crate) fn of(profile: Option<&Profile>, row: &Row) -> Self {
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

fn draw(app: &'static Workbench, desk: &'static Desk, row: &Row) -> El {
    let language = app.language.get_untracked();
    let profile = desk.device_untracked().map(Device::profile);
    let opened = Opened::of(profile, row);
    let facts = opened.dissection.as_ref().map(|found| Facts::of(language, profile, &row.bytes, found));
    let clock = desk.clock.get_value();
    let time = desk.times.get_untracked().text(row, clock.start_us, clock.zero_us);
    let mut bytes = desk.bytes.get_untracked().text(&row.bytes);
    if row.bytes.len() > MOST {
        bytes = language.more_bytes(&format::count(row.length.into()));
    }
    let live = desk.is_live();
    let shell = el("div").class(if row.mark.is_some() { "list-row marked" } else { "list-row" });
    let shell = shell
        .child(cell("cell-number number muted", &format::count(u64::from(row.index) + 1)))
        .child(cell("cell-time mono", &time));
    let way = facts.as_ref().map_or(row.direction, |facts| facts.direction);
    let (class, way) = match way {
        Direction::Request => ("cell-direction direction tx", "TX"),
        Direction::Response => ("cell-direction direction rx", "RX"),
        // A chunk of bytes on a line that is listened to comes from somebody.
        Direction::Unknown if facts.is_none() => ("cell-direction", ""),
        Direction::Unknown => ("cell-direction direction", "?"),
    };
    let shell = shell.child(cell(class, way)).children(live.then(|| origin_cell(language, row)));
    let shell = if let Some(Facts { unit, function, meaning, check_ok, expected, .. }) = &facts {
        shell
            .child(cell("cell-unit number", &unit.to_string()))
            .child(cell("cell-function", function))
            .child(words_cell("cell-meaning", language, row, meaning))
            .child(check_cell(language, row, *check_ok, expected))
    } else {
        let tag = el("span").class("tag").text(language.noise());
        shell
            .child(cell("cell-unit", ""))
            .child(cell("cell-function", ""))
            .child(words_cell("cell-meaning muted", language, row, language.no_frame()))
            .child(el("span").class("cell-check").child(tag))
    };
    let shell = if live {
        shell
            .child(cell("cell-gap number", &row.gap_us.map(span).unwrap_or_default()))
            .child(cell("cell-trip number", &row.round_trip_us.map(span).unwrap_or_default()))
    } else {
        shell
    };
    shell.child(cell("cell-bytes mono", &bytes))
}

fn cell(class: &str, text: &str) -> El {
    el("span").class(class).text(text)
}

/// What a row says, behind what is to be noted of it.
fn words_cell(class: &str, language: Language, row: &Row, words: &str) -> El {
    let notes = notes(language, row);
    if notes.is_empty() {
        return cell(class, words);
    }
    el("span").class(&["noted ", class].concat()).children(notes).child(cell("", words))
}

/// Who had it sent; nothing where nobody knows.
fn origin_cell(language: Language, row: &Row) -> El {
    let (class, text) = match row.origin {
        Origin::Unknown => return cell("cell-origin", ""),
        Origin::Poll => ("origin", language.origin_poll()),
        Origin::Console => ("origin console", language.origin_console()),
        Origin::Sequence => ("origin sequence", language.origin_sequence()),
        Origin::Configuration => ("origin configuration", language.origin_configuration()),
    };
    el("span").class("cell-origin").child(el("span").class(class).text(text))
}

/// What happened to the port before a row, and the user's mark with its words.
fn notes(language: Language, row: &Row) -> Vec<El> {
    let mark = row.mark.as_ref().map(|comment| {
        let star = el("span").class("star").attr("title", comment).child(icon(Icon::Mark));
        if comment.is_empty() { star } else { star.child(el("span").text(comment)) }
    });
    mark.into_iter().chain(row.before.iter().map(|happened| event(language, *happened))).collect()
}

/// Something that happened to the port, in a few words.
pub(crate) fn event(language: Language, event: Event) -> El {
    let (kind, text) = match event {
        Event::Opened(line, mode) => ("opened", language.event_opened(&line.to_string(), mode_name(mode))),
        Event::Closed => ("closed", language.event_closed().to_owned()),
        Event::Lost => ("lost", language.event_lost().to_owned()),
        Event::LineError => ("error", language.event_line_error().to_owned()),
        Event::Break(milliseconds) => ("break", language.event_break(milliseconds)),
        Event::Forgotten(bytes) => ("error", language.event_forgotten(&format::count(bytes))),
    };
    el("span").class("event").test("event").attr("data-kind", kind).attr("title", &text).text(&text)
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
