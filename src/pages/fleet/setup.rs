//! What every device of a new series is given.

use buslens_codec::profile::{Point, Profile};
use buslens_configure::Hazard;

use super::now_ms;
use super::state::Fleet;
use crate::components::button::button;
use crate::components::field::{Note, choice, field, number, option};
use crate::components::icon::{Icon, icon};
use crate::configure::{row, words};
use crate::device::Device;
use crate::dom::{self, El, el};
use crate::fleet::addresses::{Addresses, Wrong};
use crate::fleet::series::{Series, can_be_set_up};
use crate::fleet::setup::{self, Check, Setup};
use crate::reactive::prelude::*;
use crate::text::Language;
use crate::workbench::Workbench;

/// Unit ids that the preview names.
const PREVIEW: usize = 6;

/// The card.
pub(super) fn setup_card(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let device = Memo::new(move |_| fleet.device(app).map(|device| device.id().to_owned()));
    let about = move || device.get().map(|id| crate::device::find(&id).name(app.language.get()).to_owned());
    el("section")
        .class("card")
        .test("setup")
        .child(
            el("header")
                .child(el("h2").say(app, Language::fleet_new_series))
                .child(el("span").class("muted").live_text(move || about().unwrap_or_default())),
        )
        .child(el("p").class("fleet-lead").say(app, Language::fleet_series_lead))
        .live(move || match device.get().map(|id| crate::device::find(&id)) {
            None => vec![el("p").class("empty").test("setup-empty").say(app, Language::fleet_series_connect)],
            Some(device) if !can_be_set_up(device.profile()) => {
                vec![el("p").class("empty").test("setup-empty").say(app, Language::fleet_series_no_unit)]
            }
            Some(device) => form(app, device),
        })
}

fn form(app: &'static Workbench, device: &'static Device) -> Vec<El> {
    let fleet = &app.fleet;
    let profile = device.profile();
    let addresses = Memo::new(move |_| fleet.addresses(profile));
    let check = Memo::new(move |_| {
        addresses
            .with(|addresses| addresses.as_ref().ok().map(|all| fleet.setup(profile, all.clone()).check(profile)))
            .unwrap_or_default()
    });
    let is = move |wrong: Wrong| addresses.with(|addresses| *addresses == Err(wrong));
    let note = move |wrong: Wrong, text: fn(Language) -> &'static str, hint: fn(Language) -> &'static str| {
        move || {
            let language = app.language.get();
            Some(if is(wrong) { Note::Wrong(text(language).to_owned()) } else { Note::Hint(hint(language).to_owned()) })
        }
    };
    let range = move |language: Language| language.fleet_first_wrong(profile.units.first.max(1), profile.units.last);
    let first_note = move || {
        let language = app.language.get();
        Some(if is(Wrong::First) { Note::Wrong(range(language)) } else { Note::Hint(String::new()) })
    };
    let skip_note = move || {
        let language = app.language.get();
        Some(match addresses.with(|addresses| addresses.as_ref().err().copied()) {
            Some(Wrong::Skip) => Note::Wrong(language.cfg_find_units_wrong().to_owned()),
            Some(Wrong::Empty) => Note::Wrong(language.fleet_none_left().to_owned()),
            _ => Note::Hint(language.fleet_skip_hint().to_owned()),
        })
    };
    let units = el("div")
        .class("fleet-grid")
        .child(field(
            app,
            "series-first",
            Language::fleet_first,
            number("series-first", fleet.first, "", move || is(Wrong::First)),
            first_note,
        ))
        .child(field(
            app,
            "series-step",
            Language::fleet_step,
            number("series-step", fleet.step, "", move || is(Wrong::Step)),
            note(Wrong::Step, Language::fleet_step_wrong, Language::fleet_step_hint),
        ))
        .child(field(
            app,
            "series-skip",
            Language::fleet_skip,
            number("series-skip", fleet.skip, "", move || is(Wrong::Skip) || is(Wrong::Empty)),
            skip_note,
        ));
    let preview = move || {
        addresses.with(|addresses| {
            let all = addresses.as_ref().ok()?;
            let mut numbers: Vec<String> = all.all().take(PREVIEW + 1).map(|unit| unit.to_string()).collect();
            let more = numbers.len() > PREVIEW;
            numbers.truncate(PREVIEW);
            let language = app.language.get();
            let list = words::listed(language, &numbers) + if more { "\u{2026}" } else { "" };
            Some(el("p").class("fleet-preview").test("series-preview").text(&language.fleet_preview(&list)))
        })
    };
    let given = setup::settings(profile).map(|point| setting(app, profile, point, check));
    let settings = el("fieldset")
        .class("fleet-settings")
        .child(el("legend").say(app, Language::fleet_common))
        .child(el("div").class("fleet-grid").children(given).children(finish(app, profile)));
    let everywhere = el("input")
        .attr("type", "checkbox")
        .attr("id", "series-everywhere")
        .test("series-everywhere")
        .live_checked(move || fleet.everywhere.get())
        .click(move || fleet.everywhere.update(|on| *on = !*on));
    let search = el("label")
        .class("cfg-check")
        .attr("for", "series-everywhere")
        .child(everywhere)
        .child(el("span").say(app, Language::fleet_everywhere))
        .child(el("span").class("muted").say(app, Language::fleet_everywhere_hint));
    let body = el("div").class("fleet-form").child(units).live_one(preview).child(settings).child(search);
    let dangers = el("div").class("contents").live_one(move || {
        let hazards = check.with(|check| check.hazards.clone());
        (!hazards.is_empty()).then(|| hazard_boxes(app, profile, &hazards))
    });
    vec![body, dangers, foot(app, profile, addresses, check)]
}

/// What a parameter becomes in every device.
fn setting(app: &'static Workbench, profile: &'static Profile, point: &'static Point, check: Memo<Check>) -> El {
    let fleet = &app.fleet;
    let id = ["give-", &point.id].concat();
    let note_id = [&id, "-note"].concat();
    let label = el("label").attr("for", &id).live_text(move || words::pick(app.language.get(), &point.name).clone());
    let text = move || fleet.given.with(|given| given.text(&point.id).unwrap_or_default().to_owned());
    let refusal = move || {
        let found = check.with(|check| check.refused.iter().find(|one| one.point == point.id).cloned())?;
        Some(words::unfit(app.language.get(), profile, &found.point, &found.why))
    };
    let put = move |text: &str| {
        fleet.give(|given| if text.trim().is_empty() { given.revert(&point.id) } else { given.put(&point.id, text) });
    };
    let control = if point.codes.is_empty() {
        el("input")
            .attr("type", "text")
            .attr("autocomplete", "off")
            .live_attr("placeholder", move || Some(app.language.get().fleet_leave().to_owned()))
            .live_attr("aria-invalid", move || refusal().map(|_| "true".to_owned()))
            .live_value(text)
            .on("input", move |event| put(&dom::value(&event)))
    } else {
        let turn = RwSignal::new(0_u32);
        el("select")
            .live(move || {
                turn.update(|turn| *turn = turn.wrapping_add(1));
                let language = app.language.get();
                let codes = row::options(language, point).into_iter().map(|(key, label)| option(&key, &label));
                std::iter::once(option("", language.fleet_leave())).chain(codes).collect()
            })
            .live_value(move || {
                turn.track();
                text()
            })
            .on("change", move |event| put(&dom::value(&event)))
    };
    el("div")
        .class("field")
        .child(label)
        .child(control.attr("id", &id).test(&id).attr("aria-describedby", &note_id))
        .child(
            el("p")
                .class("note")
                .attr("id", &note_id)
                .live_attr("data-kind", move || refusal().map(|_| "wrong".to_owned()))
                .live_text(move || refusal().unwrap_or_default()),
        )
}

/// What is done at the end, where the profile has a harmless command.
fn finish(app: &'static Workbench, profile: &'static Profile) -> Option<El> {
    let all: Vec<_> = setup::finishes(profile).collect();
    if all.is_empty() {
        return None;
    }
    let options = move || {
        let language = app.language.get();
        let named = |(point, code): &(&Point, &buslens_codec::profile::Code)| {
            let command = words::pick(language, &point.name);
            let name = code.name.as_ref().map(|name| words::pick(language, name).clone()).unwrap_or_default();
            (finish_key(&point.id, code.code), [command, " \u{2013} ", &name].concat())
        };
        let none = (String::new(), language.fleet_finish_none().to_owned());
        std::iter::once(none).chain(all.iter().map(named)).collect()
    };
    let control = choice("series-finish", app.fleet.finish, options);
    let hint = move || Some(Note::Hint(app.language.get().fleet_finish_hint().to_owned()));
    Some(field(app, "series-finish", Language::fleet_finish, control, hint))
}

fn finish_key(point: &str, code: u16) -> String {
    format!("{point}/{code}")
}

/// A box to tick for each danger: it names the consequence.
fn hazard_boxes(app: &'static Workbench, profile: &'static Profile, hazards: &[Hazard]) -> El {
    let fleet = &app.fleet;
    let tick = |(at, hazard): (usize, &Hazard)| {
        let text = words::hazard(app.language.get(), profile, hazard);
        let (shown, hazard) = (hazard.clone(), hazard.clone());
        let id = format!("series-hazard-{at}");
        let tick = el("input")
            .attr("type", "checkbox")
            .attr("id", &id)
            .test("series-hazard")
            .live_checked(move || fleet.accepted.with(|accepted| accepted.contains(&shown)))
            .click(move || {
                fleet.accepted.update(|accepted| match accepted.iter().position(|known| *known == hazard) {
                    Some(place) => {
                        accepted.remove(place);
                    }
                    None => accepted.push(hazard.clone()),
                });
            });
        el("label").class("cfg-hazard").attr("for", &id).child(tick).child(el("span").text(&text))
    };
    el("fieldset")
        .class("cfg-hazards")
        .test("series-hazards")
        .child(el("legend").child(icon(Icon::Fault)).child(el("span").say(app, Language::cfg_confirm_title)))
        .children(hazards.iter().enumerate().map(tick))
}

fn foot(
    app: &'static Workbench,
    profile: &'static Profile,
    addresses: Memo<Result<Addresses, Wrong>>,
    check: Memo<Check>,
) -> El {
    let fleet = &app.fleet;
    let why = move || {
        let language = app.language.get();
        if addresses.with(Result::is_err) || check.with(|check| !check.refused.is_empty()) {
            return Some(language.fleet_faults_first());
        }
        let open = fleet
            .accepted
            .with(|accepted| check.with(|check| check.hazards.iter().any(|hazard| !accepted.contains(hazard))));
        open.then(|| language.cfg_confirm_missing())
    };
    let begin = button(app, "primary", "series-begin", Language::fleet_begin)
        .flag("disabled", move || why().is_some())
        .click(move || {
            let Ok(addresses) = addresses.get_untracked() else { return };
            let accepted = fleet.accepted.get_untracked();
            let setup = Setup { accepted, ..untrack(|| fleet.setup(profile, addresses)) };
            fleet.ended.set(None);
            fleet.series.set(Some(Series::new(now_ms(), setup)));
            super::series::focus_name();
        });
    el("footer").child(begin).live_one(move || why().map(|why| super::hint("info", why).test("series-blocked")))
}

impl Fleet {
    fn addresses(&self, profile: &Profile) -> Result<Addresses, Wrong> {
        let text = |signal: RwSignal<String>| signal.get();
        Addresses::parse(profile, &text(self.first), &text(self.step), &text(self.skip))
    }

    /// What is typed, as far as it is anything.
    fn setup(&self, profile: &Profile, addresses: Addresses) -> Setup {
        let given = |point: &Point| {
            self.given.with(|given| given.text(&point.id).map(|text| (point.id.clone(), text.to_owned())))
        };
        let finish = self.finish.with(|key| {
            let (point, code) = key.split_once('/')?;
            setup::command(profile.point(point)?, code.parse().ok()?)
        });
        Setup {
            profile: profile.id.clone(),
            addresses,
            settings: setup::settings(profile).filter_map(given).collect(),
            finish,
            everywhere: self.everywhere.get(),
            accepted: Vec::new(),
        }
    }
}
