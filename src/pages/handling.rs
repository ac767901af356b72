//! What can be done with the device that is being read, and what its readings are seen with. All of it is made of its
//! profile: commands, limits, parameters that change by hand only, notes. Stands under the figures of the Live page.

mod commands;
mod marks;
mod range;
mod run;
mod shown;
mod words;

use buslens_codec::profile::{Danger, Point, Role};

use crate::device::{self, Device};
use crate::dom::{El, el};
use crate::message::Live;
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;
use run::Run;

pub(crate) use marks::marks;

/// What this part of the page knows. It outlives a visit to another page.
pub(crate) struct Handling {
    /// The device and what it says, while the Live page shows it.
    live: RwSignal<Option<Live>>,
    /// The command that the user is being asked about.
    asked: RwSignal<Option<Command>>,
    /// The last command.
    run: RwSignal<Option<Run>>,
    /// What commands have made the device be.
    marks: RwSignal<Vec<marks::Mark>>,
}

/// One of the values of a point that makes the device do something.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Command {
    /// The point's id.
    point: String,
    /// The value that is written.
    code: u16,
}

impl Handling {
    pub(crate) fn new() -> Self {
        Self {
            live: RwSignal::new(None),
            asked: RwSignal::new(None),
            run: RwSignal::new(None),
            marks: RwSignal::new(Vec::new()),
        }
    }

    /// Hands commands on for as long as the page lives.
    pub(crate) fn follow(app: &'static Workbench) {
        run::follow(app);
    }

    /// The device is connected, or none is.
    pub(crate) fn connected(&self, connected: bool) {
        // What has become of a device meanwhile nobody knows.
        if !connected && self.marks.with_untracked(|marks| !marks.is_empty()) {
            self.marks.set(Vec::new());
        }
    }

    /// Takes over what the first program says of the device.
    pub(crate) fn hear(&self, live: Option<Live>) {
        if live.as_ref().is_some_and(|live| !live.is_open) {
            self.asked.set(None);
            self.connected(false);
        }
        self.live.set(live);
    }

    /// Part of what the first program says, followed only where that part changes.
    fn live<T: PartialEq + Send + Sync + 'static>(
        &'static self,
        pick: impl Fn(&Live) -> T + Send + Sync + 'static,
    ) -> Memo<Option<T>> {
        Memo::new(move |_| self.live.with(|live| live.as_ref().map(&pick)))
    }
}

/// The card; nothing for a device of which there is nothing to be told.
pub(crate) fn handling(app: &'static Workbench) -> El {
    let chosen = app.handling.live(|live| live.device.clone());
    el("div").class("contents").live_one(move || {
        let device = device::find(&chosen.get()?);
        let profile = device.profile();
        let limited = device.measurements().into_iter().filter(|point| point.limits_from.is_some());
        let ranges: Vec<El> = limited.map(|point| range::range(app, device, point)).collect();
        let parameters: Vec<&Point> = profile.points.iter().filter(|point| is_context(device, point)).collect();
        let notes = notes(app, device);
        if !has_commands(device) && ranges.is_empty() && parameters.is_empty() && notes.is_empty() {
            return None;
        }
        let parameters = (!parameters.is_empty()).then(|| {
            el("dl").class("context").children(parameters.into_iter().map(|point| parameter(app, device, point)))
        });
        let header = el("header").child(el("h2").say(app, Language::handling));
        let body = el("div")
            .class("handling-body")
            .children(has_commands(device).then(|| commands::commands(app, device)))
            .children(ranges)
            .children(parameters)
            .children(notes);
        Some(el("section").class("card handling").test("handling").child(header).child(body))
    })
}

fn has_commands(device: &Device) -> bool {
    device.profile().points.iter().any(|point| point.role == Role::Command)
}

/// Whether a point is worth to be seen beside the measurements: it does not tell how the line is set, or how another point
/// is to be read.
fn is_context(device: &Device, point: &Point) -> bool {
    let all = || device.profile().points.iter();
    point.role == Role::Parameter
        && !point.read.is_empty()
        && point.effects.is_empty()
        && !all().flat_map(Point::refers_to).any(|id| id == point.id)
}

fn parameter(app: &'static Workbench, device: &'static Device, point: &'static Point) -> El {
    let value = move || {
        let language = app.language.get();
        app.handling.live.with(|live| {
            let shown = live.as_ref().and_then(|live| shown::value(language, live, device, point));
            shown.map_or_else(|| "\u{2013}".to_owned(), |shown| shown.text())
        })
    };
    el("div")
        .child(el("dt").live_text(move || device::pick(app.language.get(), &point.name).to_owned()))
        .child(el("dd").test(&["context-", &point.id].concat()).live_text(value))
}

/// What users must know of single points, and, folded, of the device as a whole.
fn notes(app: &'static Workbench, device: &'static Device) -> Vec<El> {
    // Of a command that can lose settings its question tells everything.
    let told =
        |point: &&Point| matches!(point.role, Role::Measurement | Role::Command) && point.danger != Danger::Danger;
    let points = device.profile().points.iter().filter(told);
    let notes: Vec<El> = points
        .filter_map(|point| Some((point, point.note.as_ref()?)))
        .map(|(point, note)| {
            el("li").live_text(move || {
                let language = app.language.get();
                language.note_of(device::pick(language, &point.name), device::pick(language, note))
            })
        })
        .collect();
    let of_device = device
        .profile()
        .notes
        .iter()
        .map(|note| el("li").live_text(move || device::pick(app.language.get(), note).to_owned()));
    let listed = (!notes.is_empty()).then(|| el("ul").class("notes").test("point-notes").children(notes));
    let folded = (!device.profile().notes.is_empty()).then(|| {
        el("details")
            .class("notes")
            .child(el("summary").say(app, Language::notes_of_device))
            .child(el("ul").children(of_device))
    });
    listed.into_iter().chain(folded).collect()
}
