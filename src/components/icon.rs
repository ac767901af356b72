//! One family of line icons: 18 px, stroke 1.6, the text's colour.

use crate::dom::{El, svg};

/// An icon's shape.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Icon {
    /// A curve: live readings.
    Live,
    /// Angle brackets: taking frames apart.
    Decoder,
    /// Blocks in a row: building frames.
    Builder,
    /// A prompt in a frame: the console.
    Console,
    /// Cards in a box: the devices' profiles.
    Profiles,
    /// Three sliders: settings of a device.
    Configure,
    /// Sheets one behind the other: many devices.
    Fleet,
    /// A star: a mark.
    Mark,
    /// A pencil: words.
    Comment,
    /// An arrow to a line: the newest.
    Follow,
    /// Two bars: hold.
    Pause,
    /// A triangle: go on.
    Play,
    /// A square: stop.
    Stop,
    /// A sheet of keys.
    Keys,
    /// Half-filled disc: theme as the system.
    ThemeAuto,
    /// Sun.
    ThemeLight,
    /// Moon.
    ThemeDark,
    /// A triangle with a mark: fault.
    Fault,
    /// A ring with an i: information.
    Info,
    /// A ring with a question mark: help.
    Help,
    /// Turn back: reset.
    Reset,
    /// A tick: done.
    Done,
    /// A plug: port.
    Plug,
    /// A padlock: only reads.
    Lock,
    /// An arrow to the right: go there.
    Go,
    /// A sheet with a folded corner: a file.
    File,
    /// A cross: one more.
    Plus,
    /// An arrow to the left: back.
    Back,
    /// An arrow up.
    Up,
    /// An arrow down.
    Down,
    /// Two strokes across: take away.
    Remove,
}

impl Icon {
    fn path(self) -> &'static str {
        match self {
            Self::Live => "M2 10h3l2-6 4 11 2-5h3",
            Self::Decoder => "M6 4 2 9l4 5M12 4l4 5-4 5",
            Self::Builder => "M2 7h4v5H2zM6 7h5v5H6zM13.5 9.5h4M15.5 7.5v4",
            Self::Console => "M2 3.5h14v11H2zM5 7l2.4 2L5 11M9 11.5h4",
            Self::Configure => "M2.5 4.5h13M2.5 9h13M2.5 13.5h13M6 3v3M12 7.5v3M7.5 12v3",
            Self::Fleet => "M2.5 7.5h9v8h-9zM5 5h9v8M7.5 2.5h8v8",
            Self::Mark => "M9 2.2l2 4.4 4.8.5-3.6 3.2 1 4.7L9 12.6 4.8 15l1-4.7L2.2 7.1 7 6.6z",
            Self::Comment => "M3 15l.8-3.4L12.2 3.2l2.6 2.6-8.4 8.4zM10.6 4.8l2.6 2.6",
            Self::Follow => "M9 2.5v8.5M5 7.5l4 4 4-4M3.5 15h11",
            Self::Pause => "M6 4v10M12 4v10",
            Self::Play => "M5.5 3.5l9 5.5-9 5.5z",
            Self::Stop => "M4.5 4.5h9v9h-9z",
            Self::Keys => "M2 5h14v8.5H2zM4.6 7.6v.1M7.5 7.6v.1M10.4 7.6v.1M13.3 7.6v.1M5.5 11h7",
            Self::ThemeAuto => "M9 2.5a6.5 6.5 0 1 0 0 13 6.5 6.5 0 1 0 0-13zM9 2.5v13M9 6l5.7 0M9 9h6.5M9 12h5.7",
            Self::Profiles => "M5 5.5V3h8v2.5M3 8.2V5.5h12v2.7M2 8.2h14v7H2zM7 11.7h4",
            Self::ThemeLight => {
                "M9 6a3 3 0 1 0 0 6 3 3 0 1 0 0-6zM9 1.5v1.7M9 14.8v1.7M1.5 9h1.7M14.8 9h1.7M3.7 3.7l1.2 1.2M13.1 13.1l1.2 1.2M3.7 14.3l1.2-1.2M13.1 4.9l1.2-1.2"
            }
            Self::ThemeDark => "M15 10.8A6.5 6.5 0 0 1 7.2 3a6.5 6.5 0 1 0 7.8 7.8z",
            Self::Fault => "M9 2.5 16.5 15.5h-15zM9 7.5v3.6M9 13.2v.1",
            Self::Info => "M9 2.2a6.8 6.8 0 1 0 0 13.6 6.8 6.8 0 1 0 0-13.6zM9 8.2v4.3M9 5.5v.1",
            Self::Help => {
                "M9 2.2a6.8 6.8 0 1 0 0 13.6 6.8 6.8 0 1 0 0-13.6zM7 7.3a2 2 0 1 1 3 1.7c-.7.4-1 .7-1 1.4M9 12.7v.1"
            }
            Self::Reset => "M3.5 3.5v4h4M3.9 7.5A6 6 0 1 1 3.2 11",
            Self::Done => "M3.5 9.5l4 4 7-8.5",
            Self::Plug => "M6.5 2v4M11.5 2v4M4.5 6h9v3a4.5 4.5 0 0 1-9 0zM9 13.5V16.5",
            Self::Lock => "M4 8h10v7.5H4zM6 8V5.5a3 3 0 0 1 6 0V8M9 11v1.6",
            Self::Go => "M3 9h11M10 5l4 4-4 4",
            Self::Plus => "M9 3.5v11M3.5 9h11",
            Self::Back => "M15 9H4M8 5L4 9l4 4",
            Self::Up => "M9 15V4M5 8l4-4 4 4",
            Self::Down => "M9 3v11M5 10l4 4 4-4",
            Self::Remove => "M4.5 4.5l9 9M13.5 4.5l-9 9",
            Self::File => "M4.5 2.5h6l3 3v10h-9zM10.5 2.5v3h3",
        }
    }
}

/// Draws an icon. It says nothing to a screen reader: its button or heading does.
pub(crate) fn icon(icon: Icon) -> El {
    svg("svg")
        .class("icon")
        .attr("viewBox", "0 0 18 18")
        .attr("aria-hidden", "true")
        .child(svg("path").attr("d", icon.path()))
}
