//! What commands have made the device be, as far as that is known: shown beside its name until it is taken back, or until
//! nobody can know any more.

use buslens_codec::profile::{Effect, Point, Texts};

use super::Command;
use crate::device;
use crate::dom::{El, el};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// Something that the device has been made to be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mark {
    /// The id of the point that was written.
    point: String,
    /// What it is now.
    state: Texts,
    /// The time of day when that was confirmed, as `12:03:04`.
    since: String,
}

/// The marks after a command that the device has confirmed.
pub(super) fn after(mut marks: Vec<Mark>, point: &Point, command: &Command, time: &str) -> Vec<Mark> {
    let forgets = |effect: &Effect| matches!(effect, Effect::Restart | Effect::Defaults | Effect::Search);
    if point.effects.iter().any(forgets) {
        return Vec::new();
    }
    marks.retain(|mark| mark.point != point.id);
    if let Some(state) = point.code(command.code).and_then(|code| code.leaves.clone()) {
        marks.push(Mark { point: point.id.clone(), state, since: time.to_owned() });
    }
    marks
}

/// A tag for each.
pub(crate) fn marks(app: &'static Workbench) -> El {
    el("span").class("contents").live(move || {
        let language = app.language.get();
        app.handling.marks.with(|marks| marks.iter().map(|mark| tag(language, mark)).collect())
    })
}

fn tag(language: Language, mark: &Mark) -> El {
    let text = language.mark_since(device::pick(language, &mark.state), &mark.since);
    el("span").class("tag mark").test("mark").attr("data-point", &mark.point).text(&text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::find;

    #[test]
    fn a_mark_lasts_until_it_is_taken_back() {
        let profile = find("lvdt").profile();
        let after = |marks, point: &str, code, time| {
            let command = Command { point: point.to_owned(), code };
            after(marks, profile.point(point).unwrap(), &command, time)
        };
        let zeroed = after(Vec::new(), "zero", 0xFF00, "12:00:00");
        assert_eq!(zeroed.len(), 1);
        assert_eq!(zeroed[0].state.en, "zeroed");
        let again = after(zeroed.clone(), "zero", 0xFF00, "12:00:01");
        assert_eq!((again.len(), again[0].since.as_str()), (1, "12:00:01"));
        assert_eq!(after(again.clone(), "zero", 0, "12:00:02"), []);
        assert_eq!(after(again, "factory_reset", 0xFF00, "12:00:03"), []);
    }
}
