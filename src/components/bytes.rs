//! Bytes coloured by what they are, in groups that belong together, each with a few words below.

use crate::reactive::prelude::*;

use crate::anatomy::Anatomy;
use crate::dom::{El, el};

/// The bytes of a frame. `lit` is the part pointed at, here or wherever else the same parts are shown.
pub(crate) fn byte_groups(anatomy: &Anatomy, lit: RwSignal<Option<usize>>) -> El {
    let groups = anatomy.parts.iter().enumerate().map(|(number, part)| {
        let bytes = part.range.clone().map(|at| el("span").class("byte").test("byte").text(&anatomy.byte_text(at)));
        let group = el("div").class("part").attr("data-kind", part.kind).attr("title", &part.name);
        lights(group, number, lit)
            .child(el("span").class("part-bytes").children(bytes))
            .child(el("small").text(&part.caption))
    });
    el("div").class("bytes").children(groups)
}

/// Makes an element light up together with everything else that shows the same part.
pub(crate) fn lights(element: El, number: usize, lit: RwSignal<Option<usize>>) -> El {
    element
        .attr("tabindex", "0")
        .live_class("lit", move || lit.get() == Some(number))
        .on("mouseenter", move |_| lit.set(Some(number)))
        .on("mouseleave", move |_| lit.set(None))
        .on("focus", move |_| lit.set(Some(number)))
        .on("blur", move |_| lit.set(None))
}
