//! Where a measurement stands between the limits that the device itself tells.

use buslens_codec::profile::Point;

use super::shown;
use crate::device::{self, Device};
use crate::dom::{self, El, el};
use crate::format::fixed;
use crate::message::Status;
use crate::reactive::prelude::*;
use crate::workbench::Workbench;

/// A bar from the lower limit to the upper one, with a mark where the value is.
pub(super) fn range(app: &'static Workbench, device: &'static Device, point: &'static Point) -> El {
    let share = move || app.handling.live.with(|live| share(&live.as_ref()?.status, point));
    let mark = el("i").class("range-mark");
    let handle = mark.handle();
    dom::react(move || {
        // Beyond its ends the mark stays in sight.
        let percent = share().unwrap_or(0.0).clamp(-0.03, 1.03) * 100.0;
        handle.set_style("left", &[&fixed(percent, 2).replace('\u{2212}', "-"), "%"].concat());
    });
    let end = move |which: fn(&Point) -> Option<&str>| {
        el("span").live_text(move || {
            let language = app.language.get();
            app.handling
                .live
                .with(|live| {
                    let live = live.as_ref()?;
                    let limit = device.profile().point(which(point)?)?;
                    Some(shown::value(language, live, device, limit)?.text())
                })
                .unwrap_or_else(|| "\u{2013}".to_owned())
        })
    };
    let told = move || {
        let language = app.language.get();
        match share() {
            None => language.range_unknown().to_owned(),
            Some(share) => language.range_percent(&fixed(share * 100.0, 1)),
        }
    };
    let bar = el("div")
        .class("range-bar")
        .attr("role", "meter")
        .test("range-bar")
        .live_attr("aria-label", move || {
            let language = app.language.get();
            Some(language.range_of(device::pick(language, &point.name)))
        })
        .attr("aria-valuemin", "0")
        .attr("aria-valuemax", "100")
        .live_attr("aria-valuenow", move || share().map(|share| fixed(share.clamp(0.0, 1.0) * 100.0, 0)))
        .live_attr("aria-valuetext", move || Some(told()))
        .state("data-beyond", move || share().is_some_and(|share| !(0.0..=1.0).contains(&share)))
        .state("data-known", move || share().is_some())
        .child(mark);
    el("div").class("range").test("range").child(bar).child(
        el("div")
            .class("range-ends")
            .child(end(|point| point.limits_from.as_ref().map(|limits| limits.first.as_str())))
            .child(el("span").class("range-share").test("range-share").live_text(told))
            .child(end(|point| point.limits_from.as_ref().map(|limits| limits.last.as_str()))),
    )
}

/// How far a value stands between its limits: 0 at the lower one, 1 at the upper one.
fn share(status: &Status, point: &Point) -> Option<f64> {
    let number = |id: &str| device::reading(status, id)?.to_f64();
    let limits = point.limits_from.as_ref()?;
    let (first, last) = (number(&limits.first)?, number(&limits.last)?);
    let share = (number(&point.id)? - first) / (last - first);
    share.is_finite().then_some(share)
}
