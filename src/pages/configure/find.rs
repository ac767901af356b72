//! A device that does not answer any more, or whose settings nobody knows, is searched.

use buslens_codec::UnitId;
use buslens_configure::{Reach, Scope};

use super::state::{Blocked, Configure};
use super::{focus_soon, hint};
use crate::components::button::icon_button;
use crate::components::icon::Icon;
use crate::configure::words;
use crate::dom::{El, el};
use crate::fleet::addresses::unit_ids;
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// Unit ids that are tried of a device that does not tell its own, unless others are typed.
const USUAL_UNITS: std::ops::RangeInclusive<u8> = 1..=16;

/// The card.
pub(super) fn find_card(app: &'static Workbench) -> El {
    let configure = &app.configure;
    let wrong = Memo::new(move |_| configure.units.with(|text| unit_ids(text).is_none()));
    let blocked = move || app.blocked(false);
    let settings = move || {
        let count = configure.device(app).map_or(0, |device| device.profile().line_candidates().len());
        if count == 0 { String::new() } else { app.language.get().cfg_find_count(count) }
    };
    let likely = move || {
        let language = app.language.get();
        let all: Vec<String> = configure.likely(app).iter().map(|reach| words::reach(language, reach)).collect();
        (!all.is_empty()).then(|| {
            el("p")
                .class("cfg-place")
                .child(el("span").class("muted").text(language.cfg_find_likely()))
                .children(all.iter().map(|text| el("span").class("tag").text(text)))
        })
    };
    let everywhere = el("input")
        .attr("type", "checkbox")
        .attr("id", "find-everywhere")
        .test("find-everywhere")
        .live_checked(move || configure.everywhere.get())
        .click(move || configure.everywhere.update(|on| *on = !*on));
    let units = el("input")
        .attr("type", "text")
        .attr("id", "find-units")
        .test("find-units")
        .attr("autocomplete", "off")
        .attr("inputmode", "numeric")
        .attr("aria-describedby", "find-units-note")
        .live_attr("aria-invalid", move || wrong.get().then(|| "true".to_owned()))
        .bind("input", configure.units);
    let note = move || {
        let language = app.language.get();
        if wrong.get() { language.cfg_find_units_wrong() } else { language.cfg_find_units_hint() }.to_owned()
    };
    let search = icon_button(app, "", "find", Icon::Go, Language::cfg_find)
        .flag("disabled", move || blocked().is_some() || wrong.get() || configure.device(app).is_none())
        .click(move || configure.search(app, &[]));
    el("section")
        .class("card cfg-find")
        .test("find-card")
        .child(
            el("header")
                .child(el("h2").say(app, Language::cfg_find_title))
                .child(el("span").class("muted").say(app, Language::cfg_find_hint)),
        )
        .child(
            el("div")
                .class("cfg-body")
                .live_one(likely)
                .child(
                    el("label")
                        .class("cfg-check")
                        .attr("for", "find-everywhere")
                        .child(everywhere)
                        .child(el("span").say(app, Language::cfg_find_everywhere))
                        .child(el("span").class("muted").live_text(settings)),
                )
                .child(
                    el("div")
                        .class("field cfg-units")
                        .child(el("label").attr("for", "find-units").say(app, Language::cfg_find_units))
                        .child(units)
                        .child(
                            el("p")
                                .class("note")
                                .attr("id", "find-units-note")
                                .live_attr("data-kind", move || wrong.get().then(|| "wrong".to_owned()))
                                .live_text(note),
                        ),
                ),
        )
        .child(el("footer").child(search).live_one(move || {
            let why = blocked().filter(|why| *why != Blocked::Running)?;
            Some(hint("info", why.text(app.language.get())))
        }))
}

impl Configure {
    /// Where the device may be, the likeliest first: what journals say of one of its kind, then where it was last read.
    fn likely(&self, app: &'static Workbench) -> Vec<Reach> {
        let Some(device) = self.device(app) else { return Vec::new() };
        let kept = app.configuring.open.with(|open| {
            let of_kind = open.iter().filter(|journal| journal.profile == device.id());
            of_kind.flat_map(buslens_configure::Journal::candidates).collect::<Vec<_>>()
        });
        let read =
            self.held.with(|held| held.as_ref().filter(|held| held.profile == device.id()).map(|held| held.reach));
        let mut all = Vec::new();
        for reach in kept.into_iter().chain(read) {
            if !all.contains(&reach) {
                all.push(reach);
            }
        }
        all
    }

    /// Searches, these places first.
    pub(super) fn search(&self, app: &'static Workbench, first: &[Reach]) {
        let Some(typed) = self.units.with_untracked(|text| unit_ids(text)) else { return };
        let Some(profile) = untrack(|| self.device(app)).map(crate::device::Device::profile) else { return };
        if untrack(|| app.blocked(false)).is_some() {
            return;
        }
        let mut reaches = first.to_vec();
        reaches.extend(untrack(|| self.likely(app)).into_iter().filter(|reach| !first.contains(reach)));
        let known = untrack(|| self.have(app, profile)).reach.unit;
        let tells = !profile.discovery.is_empty();
        let units = match typed {
            typed if !typed.is_empty() => typed.into_iter().map(UnitId).collect(),
            _ if tells => Vec::new(),
            _ => [known, UnitId(profile.unit)].into_iter().chain(USUAL_UNITS.map(UnitId)).collect(),
        };
        let mut each = Vec::new();
        for unit in units {
            if !each.contains(&unit) {
                each.push(unit);
            }
        }
        self.report.set(None);
        self.reviewing.set(None);
        app.find_device(Scope { reaches, everywhere: self.everywhere.get_untracked(), units: each });
        focus_soon("configure-work");
    }
}
