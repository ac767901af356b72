//! The log: its tools, its list, and what is said when there is nothing in it.

use std::cell::Cell;
use std::time::Duration;

use buslens_analyst::message::{Format, Row, ToConsole};
use buslens_codec::dissect::Direction;
use js_sys::JsString;
use web_sys::Event;

use super::state::{Console, RINGS};
use super::{compact, replay, send};
use crate::anatomy::Facts;
use crate::clipboard;
use crate::components::bring::{self, Dropped};
use crate::components::button::{bare, button, icon_button, menu};
use crate::components::desk::tools::{counts_text, export_menu, filter_bar};
use crate::components::desk::{Bytes, Opened, Times, event, frame_list};
use crate::components::icon::{Icon, icon};
use crate::device::Device;
use crate::dom::{self, El, el};
use crate::format::{self, hex_spaced};
use crate::reactive::prelude::*;
use crate::storage;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// What the log can be saved as.
const FORMATS: [(&str, Label, Format); 5] = [
    ("export-text", Language::export_text, Format::Text),
    ("export-jsonl", Language::export_jsonl, Format::JsonLines),
    ("export-csv", Language::export_csv, Format::Csv),
    ("export-pcap", Language::export_pcap, Format::Pcap),
    ("export-session", Language::export_session, Format::Session),
];

/// The id of the list.
pub(super) const LIST: &str = "console-rows";
/// The id of the filter's text.
pub(super) const FILTER: &str = "filter-text";
/// The id of the field for a mark's words.
pub(super) const COMMENT: &str = "mark-comment";

/// The card.
pub(super) fn log_card(app: &'static Workbench) -> El {
    let console = &app.console;
    let desk = &console.desk;
    count_rate(console);
    let any = Memo::new(move |_| desk.progress.with(|progress| progress.entries > 0));
    let none_shown = Memo::new(move |_| desk.progress.with(|progress| progress.entries > 0 && progress.shown == 0));
    let after = Memo::new(move |_| desk.progress.with(|progress| progress.after.clone()));
    el("section")
        .class("card log-card")
        .test("console-log")
        .state("data-raw", move || console.raw.get())
        .child(header(app))
        .child(replay::banner(app))
        .child(
            filter_bar(app, desk)
                .on("keydown", move |event| {
                    // What was found stays chosen, among all that was around it.
                    if dom::key(&event) == "Escape" {
                        event.prevent_default();
                        desk.show_in_context();
                        dom::focus(LIST);
                    }
                })
                .child(view_switches(app)),
        )
        .child(el("div").class("contents").live_one(move || console.marking.get().map(|index| comment_bar(app, index))))
        .child(
            el("div").class("log-list").live_class("hidden", move || !any.get()).child(frame_list(app, desk)).live_one(
                move || none_shown.get().then(|| el("p").class("empty-page").say(app, Language::filter_empty)),
            ),
        )
        .live_one(move || (!any.get()).then(|| empty(app)))
        .child(el("div").class("log-after").live(move || {
            let language = app.language.get();
            after.with(|after| after.iter().map(|happened| event(language, *happened)).collect())
        }))
}

/// Counts the entries of each second while the page is shown.
fn count_rate(console: &'static Console) {
    let total = || console.desk.progress.with_untracked(|progress| progress.first.wrapping_add(progress.entries));
    let before = Cell::new(total());
    let tick = move || {
        let now = total();
        // A log that was emptied or changed for another one begins anew.
        console.rate.set(now.saturating_sub(before.replace(now)));
    };
    if let Ok(timer) = set_interval_with_handle(tick, Duration::from_secs(1)) {
        on_cleanup(move || timer.clear());
    }
}

fn header(app: &'static Workbench) -> El {
    let console = &app.console;
    let desk = &console.desk;
    let held = Memo::new(move |_| desk.progress.with(|progress| progress.held));
    let title = move || {
        let language = app.language.get();
        let title = if console.replayed.get() { language.log_replayed() } else { language.log() };
        console.brought.with(|name| name.clone().unwrap_or_else(|| title.to_owned()))
    };
    let rate = move || {
        let rate = console.rate.get();
        if rate == 0 || console.brought.with(Option::is_some) {
            String::new()
        } else {
            app.language.get().frames_per_second(&format::count(rate.into()))
        }
    };
    dom::react(move || {
        desk.chosen.track();
        console.copied.set(None);
    });
    let copied = move || {
        console.copied.get().map(|rows| app.language.get().copied_rows(&format::count(rows as u64))).unwrap_or_default()
    };
    let pause = bare("small toggle", "pause")
        .state("aria-pressed", move || console.paused.get())
        .live_one(move || Some(icon(if console.paused.get() { Icon::Play } else { Icon::Pause })))
        .child(el("span").live_text(move || {
            let language = app.language.get();
            match (console.paused.get(), held.get()) {
                (false, _) => language.pause().to_owned(),
                (true, 0) => language.go_on().to_owned(),
                (true, held) => language.go_on_held(&format::count(held.into())),
            }
        }))
        .click(move || console.pause());
    let follow = tool(app, "small toggle", "follow", Icon::Follow, Language::follow)
        .state("aria-pressed", move || desk.follow.get())
        .click(move || desk.follow.update(|follow| *follow = !*follow));
    let chosen = move || {
        let chosen = desk.chosen.get();
        desk.progress.with(|progress| chosen < progress.shown)
    };
    let mark = tool(app, "small quiet", "mark", Icon::Mark, Language::mark)
        .flag("disabled", move || !chosen())
        .click(move || console.mark(false));
    let comment = tool(app, "small quiet", "comment", Icon::Comment, Language::comment)
        .flag("disabled", move || !chosen())
        .click(move || console.mark(true));
    el("header")
        .child(el("h2").test("log-title").live_text(title))
        .child(el("span").class("muted").test("frame-count").live_text(move || counts_text(app, desk)))
        .child(el("span").class("muted rate").test("log-rate").live_text(rate))
        .child(el("span").class("muted copied").attr("role", "status").test("copied").live_text(copied))
        .child(el("span").class("space"))
        .child(
            el("div").class("log-tools").children([
                pause,
                follow,
                mark,
                comment,
                copy_menu(app),
                file_button(app),
                replay::play_menu(app),
                export_menu(app, desk, &FORMATS),
                clear_menu(app),
                tool(app, "small quiet", "keys", Icon::Keys, Language::keys)
                    .click(move || console.keys_open.update(|open| *open = !*open)),
            ]),
        )
}

/// A button whose words are left out where there is little room.
pub(super) fn tool(app: &'static Workbench, look: &str, hook: &str, mark: Icon, text: Label) -> El {
    icon_button(app, look, hook, mark, text).live_attr("title", move || Some(text(app.language.get()).to_owned()))
}

/// How times and bytes are told, and how much is kept.
fn view_switches(app: &'static Workbench) -> El {
    let console = &app.console;
    let desk = &console.desk;
    let times = compact::tabs(
        app,
        Language::times,
        "times",
        move || desk.times.get().key(),
        move |key| {
            desk.times.set(Times::of(key));
            storage::save("console-times", key);
            redraw(console);
        },
        [("clock", Language::times_clock as Label), ("start", Language::times_start), ("gap", Language::times_gap)],
    );
    let bytes = compact::tabs(
        app,
        Language::bytes,
        "bytes",
        move || desk.bytes.get().key(),
        move |key| {
            desk.bytes.set(Bytes::of(key));
            storage::save("console-bytes", key);
            redraw(console);
        },
        [("hex", Language::as_hex as Label), ("ascii", |_| "ASCII"), ("both", Language::bytes_both)],
    );
    let ring = compact::select("ring-size", console.ring, move || {
        let language = app.language.get();
        RINGS.iter().map(|size| (size.to_string(), language.keep_entries(&format::count((*size).into())))).collect()
    })
    .label(app, Language::ring)
    .on("change", move |_| console.tell(ToConsole::RingSize(console.ring_size())));
    el("div").class("view-switches").children([times, bytes, ring])
}

fn redraw(console: &Console) {
    console.desk.turn.update(|turn| *turn = turn.wrapping_add(1));
}

/// The words of a mark, written in place.
fn comment_bar(app: &'static Workbench, index: u32) -> El {
    let console = &app.console;
    let before = console.chosen_mark().filter(|(chosen, _)| *chosen == index).and_then(|(_, mark)| mark);
    let words = RwSignal::new(before.unwrap_or_default());
    let close = move || {
        console.marking.set(None);
        dom::focus(LIST);
    };
    let input = el("input")
        .attr("id", COMMENT)
        .test(COMMENT)
        .attr("autocomplete", "off")
        .attr("maxlength", "500")
        .label(app, Language::comment)
        .live_attr("placeholder", move || Some(app.language.get().comment_placeholder().to_owned()))
        .on("keydown", move |event| {
            if dom::key(&event) == "Escape" {
                event.stop_propagation();
                close();
            }
        })
        .bind("input", words);
    super::panes::focus_soon(COMMENT);
    let number = format::count(u64::from(index) + 1);
    el("form")
        .class("comment-bar")
        .on("submit", move |event| {
            event.prevent_default();
            console.tell(ToConsole::Mark { index, comment: Some(words.get_untracked()) });
            close();
        })
        .child(icon(Icon::Mark))
        .child(el("span").class("muted").live_text(move || app.language.get().comment_on(&number)))
        .child(input)
        .child(button(app, "small primary", "comment-save", Language::save).attr("type", "submit"))
        .child(button(app, "small quiet", "comment-cancel", Language::cancel).click(close))
}

fn clear_menu(app: &'static Workbench) -> El {
    let console = &app.console;
    let items = vec![
        el("p").class("menu-words").say(app, Language::clear_question),
        button(app, "quiet small", "clear-save", Language::save_session_first)
            .click(move || console.desk.analyst.send(&buslens_analyst::message::ToAnalyst::Export(Format::Session))),
        button(app, "small danger", "clear-confirm", Language::clear_now).click(move || {
            console.desk.choose(crate::components::desk::NOTHING);
            console.desk.follow.set(true);
            console.tell(ToConsole::Clear);
        }),
    ];
    menu(app, "clear", Language::clear_log, items)
}

fn copy_menu(app: &'static Workbench) -> El {
    let item =
        |hook: &str, text: Label, what: Copied| button(app, "quiet small", hook, text).click(move || copy(app, what));
    let items = vec![
        item("copy-rows-hex", Language::copy_hex, Copied::Hex),
        item("copy-rows-text", Language::copy_text, Copied::Text),
        item("copy-rows-json", Language::copy_json, Copied::Json),
    ];
    menu(app, "copy-rows", Language::copy, items)
}

/// As what rows are copied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Copied {
    /// Their bytes as digits, a row each line.
    Hex,
    /// Time, direction, bytes and meaning, a row each line.
    Text,
    /// As the exported objects, a row each line.
    Json,
}

/// Copies the chosen rows.
pub(super) fn copy(app: &'static Workbench, what: Copied) {
    let desk = &app.console.desk;
    let rows = desk.chosen_rows();
    if rows.is_empty() {
        return;
    }
    let (count, copied) = (rows.len(), app.console.copied);
    let told = move |well: bool| copied.set(well.then_some(count));
    let lines = |line: &dyn Fn(&Row) -> String| rows.iter().map(line).collect::<Vec<_>>().join("\n");
    match what {
        Copied::Hex => clipboard::write(&lines(&|row| hex_spaced(&row.bytes)), told),
        Copied::Text => clipboard::write(&lines(&|row| text_line(app, row)), told),
        Copied::Json => {
            let wanted = rows.iter().map(|row| row.index).collect();
            desk.collect_json(wanted, Box::new(move |text| clipboard::write(text, told)));
        }
    }
}

/// A row as a line of text that the decoder reads as a log.
fn text_line(app: &'static Workbench, row: &Row) -> String {
    let language = app.language.get_untracked();
    let profile = app.console.desk.device_untracked().map(Device::profile);
    let found = Opened::of(profile, row).dissection;
    let meaning = found.map(|found| Facts::of(language, profile, &row.bytes, &found).meaning).unwrap_or_default();
    let clock = app.console.desk.clock.get_value();
    let time = row.time_us.map(|time| format::clock(time.wrapping_add(clock.zero_us))).unwrap_or_default();
    let way = match row.direction {
        Direction::Request => "TX",
        Direction::Response | Direction::Unknown => "RX",
    };
    let parts = [time.as_str(), way, &hex_spaced(&row.bytes)];
    let line = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ");
    if meaning.is_empty() { line } else { [&line, "  # ", &meaning].concat() }
}

/// Opens a log or a saved session.
fn file_button(app: &'static Workbench) -> El {
    let console = &app.console;
    let chooser = bring::chooser("console-file", move |file| console.bring(&file.name(), &file));
    el("label")
        .class("button small quiet file")
        .live_attr("title", move || Some(app.language.get().open_log().to_owned()))
        .child(icon(Icon::File))
        .child(el("span").say(app, Language::open_log))
        .child(chooser)
}

/// A log that is dropped on the page.
pub(super) fn dropped(app: &'static Workbench, event: &Event) {
    match bring::dropped(event) {
        Some(Dropped::File(file)) => app.console.bring(&file.name(), &file),
        Some(Dropped::Text(text)) => bring_text(app, &text),
        None => {}
    }
}

/// A log that is pasted where nothing is typed.
pub(super) fn pasted(app: &'static Workbench, event: &Event) {
    if dom::is_typing(event) {
        return;
    }
    if let Some(text) = bring::pasted(event) {
        event.prevent_default();
        bring_text(app, &text);
    }
}

fn bring_text(app: &'static Workbench, text: &JsString) {
    if text.length() > 0 {
        app.console.bring(app.language.get_untracked().pasted_text(), text);
    }
}

/// Nothing in the log: what to do next.
fn empty(app: &'static Workbench) -> El {
    let console = &app.console;
    let open = Memo::new(move |_| console.is_open());
    let reading = Memo::new(move |_| console.brought.with(Option::is_some));
    el("div").class("log-empty").test("log-empty").child(icon(Icon::Console)).live(move || {
        let say = |text: Label| el("p").say(app, text);
        if reading.get() {
            vec![say(Language::log_empty_brought)]
        } else if open.get() {
            vec![
                say(Language::log_empty_open),
                button(app, "primary", "go-send", Language::go_to_send_line).click(|| {
                    dom::focus(send::LINE);
                }),
            ]
        } else {
            vec![
                say(Language::log_empty_closed),
                el("label").class("button").attr("for", "console-file").say(app, Language::open_log),
            ]
        }
    })
}
