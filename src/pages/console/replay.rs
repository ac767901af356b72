//! A log in place of the line's: brought in, or played again.

use buslens_analyst::message::ToConsole;

use crate::components::button::{bare, button, icon_button, menu};
use crate::components::desk::reading::understood;
use crate::components::icon::Icon;
use crate::dom::{El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// Speeds in thousandths of a recording's own; 0 for as fast as it goes.
const SPEEDS: [(&str, &str); 6] = [
    ("100", "0.1\u{D7}"),
    ("500", "0.5\u{D7}"),
    ("1000", "1\u{D7}"),
    ("2000", "2\u{D7}"),
    ("10000", "10\u{D7}"),
    ("0", ""),
];

/// Begins a replay of what is in the list, at one of the speeds.
pub(super) fn play_menu(app: &'static Workbench) -> El {
    let console = &app.console;
    let hint = el("p").class("menu-words").say(app, Language::replay_hint);
    let item = |(key, text): (&'static str, &'static str)| {
        bare("quiet small", &["replay-", key].concat())
            .flag("disabled", move || !console.can_play())
            .live_text(move || if text.is_empty() { app.language.get().fastest() } else { text }.to_owned())
            .click(move || {
                console.speed.set(key.to_owned());
                console.play();
            })
    };
    menu(app, "replay", Language::replay, [hint].into_iter().chain(SPEEDS.map(item)).collect())
}

/// Tells that the list is not the line's, and how far it has come.
pub(super) fn banner(app: &'static Workbench) -> El {
    let console = &app.console;
    let brought = Memo::new(move |_| console.brought.with(Option::is_some));
    let replayed = Memo::new(move |_| console.replayed.get());
    let playing = Memo::new(move |_| console.replay.with(|replay| replay.playing));
    let shown = Memo::new(move |_| brought.get() || replayed.get());
    el("div").class("contents").live_one(move || {
        shown.get().then(|| {
            el("div")
                .class("log-banner")
                .test("log-banner")
                .child(
                    el("div")
                        .class("banner-row")
                        .live_one(move || Some(if playing.get() { progress(app) } else { words(app) }))
                        .child(el("span").class("space"))
                        .child(
                            button(app, "small", "back-to-live", Language::back_to_live)
                                .attr("id", "back-to-live")
                                .click(move || console.go_live()),
                        ),
                )
                .live_one(move || {
                    (brought.get() && !replayed.get()).then(|| {
                        understood(app, &console.desk, console.unreadable, move |form| console.read(Some(form)))
                    })
                })
        })
    })
}

fn words(app: &'static Workbench) -> El {
    let console = &app.console;
    el("span").live_text(move || {
        let language = app.language.get();
        if console.replayed.get() { language.banner_replayed() } else { language.banner_brought() }.to_owned()
    })
}

fn progress(app: &'static Workbench) -> El {
    let console = &app.console;
    let percent = move || {
        console.replay.with(|replay| {
            let percent = replay.at_us.saturating_mul(100).checked_div(replay.total_us).unwrap_or(0);
            u32::try_from(percent.min(100)).unwrap_or(100)
        })
    };
    let told = move || {
        let (at, total) = console.replay.with(|replay| (replay.at_us, replay.total_us));
        app.language.get().replaying(&seconds(at), &seconds(total))
    };
    let bar = el("progress").attr("max", "100").live_attr("value", move || Some(percent().to_string()));
    el("div")
        .class("progress")
        .attr("role", "status")
        .test("replay-progress")
        .child(bar)
        .child(el("span").live_text(told))
        .child(
            icon_button(app, "small", "replay-stop", Icon::Stop, Language::stop)
                .click(move || console.tell(ToConsole::StopReplay)),
        )
}

/// `1:02.5`.
fn seconds(microseconds: u64) -> String {
    let tenths = microseconds / 100_000;
    format!("{}:{:02}.{}", tenths / 600, tenths / 10 % 60, tenths % 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_a_replay_are_minutes_and_tenths_of_seconds() {
        assert_eq!(
            (seconds(0), seconds(62_549_999), seconds(3_600_000_000)),
            ("0:00.0".into(), "1:02.5".into(), "60:00.0".into())
        );
    }
}
