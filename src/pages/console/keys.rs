//! The keys of the page, and the sheet that tells them.

use buslens_analyst::message::ToConsole;
use web_sys::Event;

use super::log::{Copied, FILTER, LIST, copy};
use super::panes::PANES;
use super::send;
use crate::components::button::{bare, button};
use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// A key: as the browser names it, as the sheet shows it, what it does in words, and what it does.
struct Key {
    name: &'static str,
    shift: bool,
    shown: &'static str,
    what: Label,
    act: fn(&'static Workbench),
}

const fn key(name: &'static str, shown: &'static str, what: Label, act: fn(&'static Workbench)) -> Key {
    Key { name, shift: false, shown, what, act }
}

const fn shifted(name: &'static str, shown: &'static str, what: Label, act: fn(&'static Workbench)) -> Key {
    Key { name, shift: true, shown, what, act }
}

/// The keys that work wherever nothing is typed.
const KEYS: [Key; 38] = [
    key("/", "/", Language::key_search, |_| {
        dom::focus(FILTER);
    }),
    key("s", "S", Language::key_send_line, |_| {
        dom::focus(send::LINE);
    }),
    key("l", "L", Language::key_list, |_| {
        dom::focus(LIST);
    }),
    key("p", "P", Language::key_pause, |app| app.console.pause()),
    key("f", "F", Language::key_follow, |app| app.console.desk.follow.update(|follow| *follow = !*follow)),
    key("e", "E", Language::key_errors, |app| app.console.desk.errors_only.update(|on| *on = !*on)),
    key("x", "X", Language::key_clear_filter, |app| app.console.desk.show_in_context()),
    key("m", "M", Language::key_mark, |app| app.console.mark(false)),
    shifted("M", "\u{21E7} M", Language::key_comment, |app| app.console.mark(true)),
    key("o", "O", Language::to_pair, |app| {
        let desk = &app.console.desk;
        let pair = desk.with_row(desk.chosen.get_untracked(), |row| row.pair).flatten();
        if let Some(pair) = pair {
            desk.go_to(pair);
        }
    }),
    key("c", "C", Language::key_copy_hex, |app| copy(app, Copied::Hex)),
    key("t", "T", Language::key_copy_text, |app| copy(app, Copied::Text)),
    key("j", "J", Language::key_copy_json, |app| copy(app, Copied::Json)),
    key("a", "A", Language::open_log, |_| dom::press("console-file")),
    key("w", "W", Language::export, |_| dom::open_menu("export-menu")),
    key("d", "D", Language::clear_log, |_| dom::open_menu("clear-menu")),
    key("r", "R", Language::key_replay, |app| app.console.play()),
    shifted("R", "\u{21E7} R", Language::key_replay_speed, |_| dom::open_menu("replay-menu")),
    key("0", "0", Language::back_to_live, |_| dom::press("back-to-live")),
    key("n", "N", Language::key_times, |_| dom::press_next("times")),
    key("q", "Q", Language::key_bytes, |_| dom::press_next("bytes")),
    key("y", "Y", Language::ring, |_| {
        dom::focus("ring-size");
    }),
    key("u", "U", Language::repeat, |_| dom::press("repeat")),
    key("z", "Z", Language::key_stop, |app| {
        app.console.tell(ToConsole::StopSending);
        app.console.tell(ToConsole::StopReplay);
    }),
    key("k", "K", Language::key_keep, |_| dom::press("keep-line")),
    key("i", "I", Language::key_line, |_| {
        dom::focus("line-baud");
    }),
    key("v", "V", Language::polling, |_| dom::press("line-polling")),
    shifted("V", "\u{21E7} V", Language::read_only, |_| dom::press("line-read-only")),
    shifted("B", "\u{21E7} B", Language::break_line, |_| dom::press("line-break")),
    shifted("D", "\u{21E7} D", |_| "DTR", |_| dom::press("line-dtr")),
    shifted("T", "\u{21E7} T", |_| "RTS", |_| dom::press("line-rts")),
    key("b", "B", Language::key_build, |app| app.console.builder_open.set(true)),
    key("g", "G", Language::key_sequence_run, super::sequence::run),
    key("h", "H", Language::key_sequence_stop, super::sequence::stop),
    key("1", "1", Language::pane_frame, |app| open_pane(app, 0)),
    key("2", "2", Language::statistics, |app| open_pane(app, 1)),
    key("3", "3", Language::pane_snippets, |app| open_pane(app, 2)),
    key("4", "4", Language::pane_sequence, |app| open_pane(app, 3)),
];

/// Those that work anywhere, or in one place only: shown, and what they do in words.
const OTHERS: [(&str, Label); 7] = [
    ("F6", Language::key_next_part),
    ("Ctrl L", Language::key_send_line),
    ("\u{2191} \u{2193}", Language::key_arrows),
    ("\u{21E7} \u{2191} \u{2193}", Language::key_more_rows),
    ("End", Language::key_end),
    ("Enter", Language::key_enter),
    ("Esc", Language::key_escape),
];

/// Acts on a key that was pressed anywhere on the page.
pub(super) fn pressed(app: &'static Workbench, event: &Event) {
    let console = &app.console;
    let name = dom::key(event);
    let commanded = dom::is_commanded(event);
    match name.as_str() {
        "F6" => next_part(dom::is_shifted(event)),
        "l" | "L" if commanded => {
            dom::focus(send::LINE);
        }
        "Escape" if console.builder_open.get_untracked() || console.keys_open.get_untracked() => {
            console.builder_open.set(false);
            console.keys_open.set(false);
            super::panes::focus_soon(LIST);
        }
        "Escape" if dom::is_typing(event) => {
            dom::focus(LIST);
        }
        _ if commanded || dom::is_typing(event) => return,
        "?" => console.keys_open.update(|open| *open = !*open),
        _ => {
            // Letters are the same with the capitals' lock on; the shift key tells the two apart.
            let shift = dom::is_shifted(event) && name != "/";
            let wanted = if shift { name.to_uppercase() } else { name.to_lowercase() };
            let Some(found) = KEYS.iter().find(|known| known.name == wanted && known.shift == shift) else { return };
            (found.act)(app);
        }
    }
    event.prevent_default();
}

/// From the list to the send line to the filter and around.
fn next_part(back: bool) {
    let parts = [LIST, send::LINE, FILTER];
    let now = parts.iter().position(|part| dom::has_focus(part));
    let next = match (now, back) {
        (None, _) => 0,
        (Some(at), false) => (at + 1) % parts.len(),
        (Some(at), true) => (at + parts.len() - 1) % parts.len(),
    };
    if let Some(part) = parts.get(next) {
        dom::focus(part);
    }
}

fn open_pane(app: &'static Workbench, at: usize) {
    if let Some((pane, _)) = PANES.get(at) {
        app.console.tab.set((*pane).to_owned());
    }
}

/// The sheet of keys.
pub(super) fn sheet(app: &'static Workbench) -> El {
    let close = move || {
        app.console.keys_open.set(false);
        super::panes::focus_soon(LIST);
    };
    let line = |shown: &str, what: Label| el("div").child(el("kbd").text(shown)).child(el("span").say(app, what));
    let lines = OTHERS.iter().map(|(shown, what)| line(shown, *what));
    let lines = lines.chain(KEYS.iter().map(|key| line(key.shown, key.what))).chain([line("?", Language::keys)]);
    super::panes::focus_soon("keys-close");
    el("div")
        .class("overlay")
        .child(bare("overlay-back", "keys-back").attr("tabindex", "-1").label(app, Language::close).click(close))
        .child(
            el("section")
                .class("card dialog keys-sheet")
                .attr("role", "dialog")
                .attr("aria-modal", "true")
                .label(app, Language::keys)
                .test("keys-sheet")
                .child(
                    el("header").child(el("h2").say(app, Language::keys)).child(el("span").class("space")).child(
                        button(app, "small", "keys-close", Language::close).attr("id", "keys-close").click(close),
                    ),
                )
                .child(el("div").class("keys-list").children(lines)),
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_stands_for_two_things() {
        for (at, one) in KEYS.iter().enumerate() {
            assert!(
                KEYS[at + 1..].iter().all(|other| (other.name, other.shift) != (one.name, one.shift)),
                "{}",
                one.name
            );
            assert_eq!(one.name, if one.shift { one.name.to_uppercase() } else { one.name.to_lowercase() });
        }
    }
}
