//! The devices of a series as they stand.

use super::labels;
use super::series::told;
use super::{moment, now_ms, plain_day, plain_moment};
use crate::components::button::{bare, button};
use crate::dom::{self, El, el};
use crate::fleet::labels::{file, line, state};
use crate::fleet::series::{Sensor, State};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// The card; an empty box before the first device.
pub(super) fn sensors_card(app: &'static Workbench) -> El {
    let fleet = &app.fleet;
    let any =
        Memo::new(move |_| fleet.series.with(|series| series.as_ref().is_some_and(|all| !all.sensors.is_empty())));
    el("div").class("contents").live_one(move || any.get().then(|| card(app)))
}

fn card(app: &'static Workbench) -> El {
    el("section")
        .class("card")
        .test("sensors")
        .child(
            el("header")
                .child(el("h2").say(app, Language::fleet_sensors))
                .child(el("span").class("space"))
                .child(button(app, "quiet small", "series-export", Language::fleet_save_csv).click(move || save(app)))
                .child(
                    button(app, "small", "labels-print", Language::fleet_print)
                        .flag("disabled", move || labels::none(app))
                        .click(labels::print),
                ),
        )
        .live_one(move || table(app))
}

fn save(app: &'static Workbench) {
    let fleet = &app.fleet;
    let Some(device) = untrack(|| fleet.device(app)) else { return };
    let text = fleet.series.with_untracked(|series| {
        let series = series.as_ref()?;
        Some(file(app.language.get_untracked(), device.profile(), series, plain_moment))
    });
    if let Some(text) = text {
        let name = ["buslens-series-", device.id(), "-", &plain_day(now_ms()), ".csv"].concat();
        dom::save_text(&text, "text/csv", &name);
    }
}

fn table(app: &'static Workbench) -> Option<El> {
    let fleet = &app.fleet;
    let language = app.language.get();
    let titles: [Label; 6] = [
        Language::fleet_number,
        Language::fleet_unit_id,
        Language::fleet_name_or_serial,
        Language::fleet_state,
        Language::fleet_line,
        Language::fleet_when,
    ];
    let titles = titles.map(|title| el("th").attr("scope", "col").text(title(language)));
    let rows = fleet.series.with(|series| {
        let sensors = series.as_ref()?.sensors.iter().enumerate();
        Some(sensors.map(|(place, sensor)| row(app, language, place, sensor)).collect::<Vec<_>>())
    })?;
    let table = el("table")
        .class("fleet-table fleet-sensors")
        .child(el("thead").child(el("tr").children(titles).child(el("th"))))
        .child(el("tbody").children(rows));
    Some(el("div").class("scroll").child(table))
}

fn row(app: &'static Workbench, language: Language, place: usize, sensor: &Sensor) -> El {
    let fleet = &app.fleet;
    let renamed = move |event: web_sys::Event| {
        let name = dom::value(&event).trim().to_owned();
        fleet.series.update(|series| {
            if let Some(sensor) = series.as_mut().and_then(|all| all.sensors.get_mut(place)) {
                sensor.name = name;
            }
        });
    };
    let name = el("input")
        .class("fleet-rename")
        .attr("type", "text")
        .test("sensor-rename")
        .attr("maxlength", "60")
        .attr("autocomplete", "off")
        .attr("aria-label", language.fleet_name_or_serial())
        .attr("value", &sensor.name)
        .on("change", renamed);
    let (key, class) = match sensor.state {
        State::UnderWay(_) => ("under-way", "tag"),
        State::Done => ("done", "tag ok"),
        State::Failed(_) => ("failed", "tag bad"),
        State::LeftOut => ("left-out", "tag"),
    };
    let why = match &sensor.state {
        State::Failed(failure) => fleet.device(app).map(|device| told(language, device.profile(), failure).title),
        _ => None,
    };
    let again = matches!(sensor.state, State::Failed(_) | State::Done | State::LeftOut).then(|| {
        bare("quiet small", "sensor-again")
            .attr("aria-label", &language.fleet_again_names(place + 1))
            .text(language.fleet_again())
            .flag("disabled", move || !fleet.can_set_up(app))
            .click(move || fleet.set_up(app, Some(place)))
    });
    let unit = if sensor.unit == 0 { "\u{2013}".to_owned() } else { sensor.unit.to_string() };
    el("tr")
        .test("sensor-row")
        .attr("data-state", key)
        .attr("data-unit", &sensor.unit.to_string())
        .child(el("td").class("fleet-number").text(&(place + 1).to_string()))
        .child(el("td").class("fleet-unit-cell").text(&unit))
        .child(el("td").class("fleet-name").child(name))
        .child(
            el("td")
                .class("fleet-state")
                .child(el("span").class(class).text(state(language, &sensor.state)))
                .children(why.map(|why| el("small").text(&why))),
        )
        .child(el("td").text(&line(sensor)))
        .child(el("td").text(&moment(language, sensor.unix_ms)))
        .child(el("td").class("fleet-actions").children(again))
}
