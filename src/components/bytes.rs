//! Bytes coloured by what they are, in groups that belong together, each with a few words below.

use leptos::prelude::*;

use crate::anatomy::Anatomy;

/// The bytes of a frame. `lit` is the part pointed at, here or wherever else the same parts are shown.
pub(crate) fn byte_groups(anatomy: &Anatomy, lit: RwSignal<Option<usize>>) -> AnyView {
    let groups: Vec<_> = anatomy
        .parts
        .iter()
        .enumerate()
        .map(|(number, part)| {
            let bytes: Vec<_> = part
                .range
                .clone()
                .map(|at| view! { <span class="byte" data-test="byte">{anatomy.byte_text(at)}</span> })
                .collect();
            view! {
                <div
                    class="part"
                    class:lit=move || lit.get() == Some(number)
                    data-kind=part.kind
                    title=part.name.clone()
                    tabindex="0"
                    on:mouseenter=move |_| lit.set(Some(number))
                    on:mouseleave=move |_| lit.set(None)
                    on:focus=move |_| lit.set(Some(number))
                    on:blur=move |_| lit.set(None)
                >
                    <span class="part-bytes">{bytes}</span>
                    <small>{part.caption.clone()}</small>
                </div>
            }
        })
        .collect();
    view! { <div class="bytes">{groups}</div> }.into_any()
}
