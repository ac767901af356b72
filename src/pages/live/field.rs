//! A labelled field of the connection card: control, hint, and what is wrong with it.

use leptos::prelude::*;

/// One field. `note` is a hint, `wrong` an error that replaces it; both are tied to the control by `id`.
pub(super) fn field(
    id: &'static str,
    label: impl Fn() -> &'static str + Copy + Send + Sync + 'static,
    control: AnyView,
    note: impl Fn() -> Option<Note> + Copy + Send + Sync + 'static,
) -> AnyView {
    view! {
        <div class="field">
            <label for=id>{label}</label>
            {control}
            <p class="note" id=[id, "-note"].concat() data-kind=move || note().map(|note| note.kind())>
                {move || note().map(Note::text)}
            </p>
        </div>
    }
    .into_any()
}

/// What stands under a field.
pub(super) enum Note {
    /// An explanation.
    Hint(String),
    /// Allowed, but think twice.
    Warning(String),
    /// Not allowed.
    Wrong(String),
}

impl Note {
    fn kind(&self) -> &'static str {
        match self {
            Self::Hint(_) => "hint",
            Self::Warning(_) => "warning",
            Self::Wrong(_) => "wrong",
        }
    }

    fn text(self) -> String {
        match self {
            Self::Hint(text) | Self::Warning(text) | Self::Wrong(text) => text,
        }
    }
}

/// A list to choose from, bound to a signal. `options` are values with their labels.
pub(super) fn choice(
    id: &'static str,
    test: &'static str,
    value: RwSignal<String>,
    options: impl Fn() -> Vec<(String, String)> + Copy + Send + Sync + 'static,
) -> AnyView {
    view! {
        <select
            id=id
            data-test=test
            aria-describedby=[id, "-note"].concat()
            on:change=move |event| value.set(event_target_value(&event))
        >
            {move || {
                let chosen = value.get();
                options()
                    .into_iter()
                    .map(|(key, label)| {
                        let selected = key == chosen;
                        view! { <option value=key prop:selected=selected>{label}</option> }
                    })
                    .collect::<Vec<_>>()
            }}
        </select>
    }
    .into_any()
}

/// A number to type, bound to a signal.
pub(super) fn number(
    id: &'static str,
    test: &'static str,
    value: RwSignal<String>,
    unit: &'static str,
    wrong: impl Fn() -> bool + Copy + Send + Sync + 'static,
) -> AnyView {
    view! {
        <span class="number">
            <input
                id=id
                data-test=test
                type="text"
                inputmode="numeric"
                autocomplete="off"
                spellcheck="false"
                aria-describedby=[id, "-note"].concat()
                aria-invalid=move || wrong().then_some("true")
                    prop:value=move || value.get()
                on:input=move |event| value.set(event_target_value(&event))
            />
            <span class="suffix">{unit}</span>
        </span>
    }
    .into_any()
}
