//! The Decoder page: pasted bytes become frames, the chosen frame is taken apart.

mod reading;

use buslens_codec::dissect::Direction;
use buslens_codec::intake::IntakeFault;
use leptos::prelude::*;

use crate::anatomy::{Anatomy, Facts};
use crate::app::App;
use crate::components::bytes::byte_groups;
use crate::components::icon::{Icon, icon};
use crate::device::Device;
use crate::format::hex_spaced;
use crate::route::{self, Route};
use crate::storage::kept;
use crate::text::Language;
use reading::read;

/// A text of the page.
type Label = fn(Language) -> &'static str;

/// Texts to begin with: label and bytes. The reply stands behind its request, which alone tells its registers.
const EXAMPLES: [(&str, Label, &str); 4] = [
    ("request", Language::example_request, "0C 04 00 04 00 02 31 17"),
    ("reply", Language::example_reply, "0C 04 00 04 00 02 31 17\n0C 04 04 80 00 01 48 0F 22"),
    ("exception", Language::example_exception, "0C 04 00 04 00 01 71 16\n0C 84 02 53 02"),
    ("ascii", Language::example_ascii, ":010300310001CA"),
];

/// What was typed, and what stood there before an example or a link replaced it. Both outlive a reload.
#[derive(Clone, Copy)]
struct Texts {
    typed: RwSignal<String>,
    previous: RwSignal<String>,
}

impl Texts {
    fn replace(self, text: String) {
        let old = self.typed.get_untracked();
        if old != text {
            if !old.trim().is_empty() {
                self.previous.set(old);
            }
            self.typed.set(text);
        }
    }
}

/// The page.
pub(crate) fn decoder_page(app: &'static App) -> AnyView {
    let texts = Texts { typed: kept("decoder", ""), previous: kept("decoder-previous", "") };
    Effect::new(move |_| {
        if let Route::Decoder { frames } = app.route.get()
            && !frames.is_empty()
        {
            texts.replace(frames.iter().map(|frame| spaced(frame)).collect::<Vec<_>>().join("\n"));
            route::forget_frames();
        }
    });
    let chosen = RwSignal::new(0_usize);
    let frames = Memo::new(move |_| {
        let device: &'static Device = app.settings.device();
        texts.typed.with(|text| read(app.language.get(), device.profile(), text))
    });
    view! {
        <div class="page decoder" data-test="page-decoder">
            <h1 class="visually-hidden">{app.text(Language::decoder)}</h1>
            {input_card(app, texts)}
            {move || match frames.get() {
                Err(error) => view! {
                    <p class="parse-error" role="alert" data-test="decoder-error">
                        {icon(Icon::Fault)}
                        {error_text(app.language.get(), error)}
                    </p>
                }
                .into_any(),
                Ok(frames) if frames.is_empty() => {
                    view! { <p class="empty-page">{app.text(Language::decoder_empty)}</p> }.into_any()
                }
                Ok(frames) => {
                    let last = frames.len() - 1;
                    let shown = frames.clone();
                    view! {
                        {frame_list(app, frames, chosen)}
                        {move || shown.get(chosen.get().min(last)).map(|frame| detail(app, frame))}
                    }
                    .into_any()
                }
            }}
        </div>
    }
    .into_any()
}

fn input_card(app: &'static App, texts: Texts) -> AnyView {
    let examples: Vec<_> = EXAMPLES
        .iter()
        .map(|&(test, label, text)| {
            view! {
                <button
                    type="button"
                    class="button small"
                    data-test=["example-", test].concat()
                    on:click=move |_| texts.replace(text.to_owned())
                >
                    {app.text(label)}
                </button>
            }
        })
        .collect();
    let restorable = move || texts.previous.with(|previous| !previous.is_empty());
    view! {
        <section class="card input">
            <header>
                <h2>{app.text(Language::decoder_title)}</h2>
                <span class="space"></span>
                <Show when=restorable>
                    <button
                        type="button"
                        class="button quiet small"
                        data-test="restore-text"
                        on:click=move |_| texts.replace(texts.previous.get_untracked())
                    >
                        {icon(Icon::Reset)}
                        {app.text(Language::restore_text)}
                    </button>
                </Show>
            </header>
            <label class="visually-hidden" for="decoder-input">
                {app.text(Language::decoder_input)}
            </label>
            <textarea
                id="decoder-input"
                data-test="decoder-input"
                rows="4"
                spellcheck="false"
                autocapitalize="off"
                autocomplete="off"
                placeholder=app.text(Language::decoder_placeholder)
                prop:value=move || texts.typed.get()
                on:input=move |event| texts.typed.set(event_target_value(&event))
            ></textarea>
            <footer>
                <span class="muted">{app.text(Language::examples)}</span>
                {examples}
            </footer>
        </section>
    }
    .into_any()
}

fn frame_list(app: &'static App, frames: Vec<Anatomy>, chosen: RwSignal<usize>) -> AnyView {
    let last = frames.len() - 1;
    let rows: Vec<_> = frames
        .into_iter()
        .enumerate()
        .map(|(number, frame)| {
            let selected = move || chosen.get().min(last) == number;
            let bytes = hex_spaced(&frame.bytes);
            let select = move || chosen.set(number);
            view! {
                <tr
                    data-test="frame-row"
                    class:selected=selected
                    tabindex="0"
                    aria-selected=move || selected().to_string()
                    on:click=move |_| select()
                    on:keydown=move |event| {
                        if matches!(event.key().as_str(), "Enter" | " ") {
                            event.prevent_default();
                            select();
                        }
                    }
                >
                    {row(app.language.get(), &frame, bytes)}
                </tr>
            }
        })
        .collect();
    view! {
        <section class="card">
            <header>
                <h2>{app.text(Language::frames)}</h2>
                <span class="muted">{last + 1}</span>
            </header>
            <div class="scroll">
                <table class="frames">
                    <thead>
                        <tr>
                            <th>{app.text(Language::direction)}</th>
                            <th class="number">{app.text(Language::unit_short)}</th>
                            <th>{app.text(Language::function)}</th>
                            <th>{app.text(Language::meaning)}</th>
                            <th>{app.text(Language::check)}</th>
                            <th>{app.text(Language::bytes)}</th>
                        </tr>
                    </thead>
                    <tbody>{rows}</tbody>
                </table>
            </div>
        </section>
    }
    .into_any()
}

fn row(language: Language, frame: &Anatomy, bytes: String) -> AnyView {
    let Some(Facts { direction, unit, function, meaning, check_ok, expected, .. }) = frame.facts.clone() else {
        return view! {
            <td></td>
            <td></td>
            <td></td>
            <td class="muted">{language.no_frame()}</td>
            <td>
                <span class="tag">{language.noise()}</span>
            </td>
            <td class="mono">{bytes}</td>
        }
        .into_any();
    };
    let (class, direction) = match direction {
        Direction::Request => ("direction tx", "TX"),
        Direction::Response => ("direction rx", "RX"),
        Direction::Unknown => ("direction", language.unknown_direction()),
    };
    let check = if check_ok {
        view! { <span class="tag ok">{language.check_ok()}</span> }.into_any()
    } else {
        view! {
            <span class="tag bad">{language.check_bad()}</span>
            <span class="expected">{language.check_expected(&expected)}</span>
        }
        .into_any()
    };
    view! {
        <td class=class>{direction}</td>
        <td class="number">{unit}</td>
        <td>{function}</td>
        <td>{meaning}</td>
        <td>{check}</td>
        <td class="mono">{bytes}</td>
    }
    .into_any()
}

fn detail(app: &'static App, frame: &Anatomy) -> AnyView {
    let lit = RwSignal::new(None);
    let rows: Vec<_> = frame
        .parts
        .iter()
        .enumerate()
        .map(|(number, part)| {
            let texts: Vec<String> = part.range.clone().map(|at| frame.byte_text(at)).collect();
            view! {
                <tr
                    data-test="field-row"
                    data-kind=part.kind
                    class:lit=move || lit.get() == Some(number)
                    tabindex="0"
                    on:mouseenter=move |_| lit.set(Some(number))
                    on:mouseleave=move |_| lit.set(None)
                    on:focus=move |_| lit.set(Some(number))
                    on:blur=move |_| lit.set(None)
                >
                    <td><i class="swatch"></i>{part.name.clone()}</td>
                    <td class="mono">{texts.join(" ")}</td>
                    <td class="part-value">{part.value.clone()}</td>
                    <td class="muted">{part.meaning.clone()}</td>
                </tr>
            }
        })
        .collect();
    let nameless = frame.facts.as_ref().is_some_and(|facts| facts.direction == Direction::Response)
        && frame.parts.iter().any(|part| part.kind == "data" && part.name == app.language.get_untracked().register());
    view! {
        <section class="card detail">
            <header>
                <h2>{app.text(Language::selected_frame)}</h2>
                <span class="muted hint">{app.text(Language::pick_a_frame)}</span>
            </header>
            {byte_groups(frame, lit)}
            {nameless.then(|| view! { <p class="note-line">{icon(Icon::Info)}{app.text(Language::reply_needs_request)}</p> })}
            <div class="scroll">
                <table class="fields-table">
                    <thead>
                        <tr>
                            <th>{app.text(Language::field)}</th>
                            <th>{app.text(Language::bytes)}</th>
                            <th>{app.text(Language::value)}</th>
                            <th>{app.text(Language::meaning)}</th>
                        </tr>
                    </thead>
                    <tbody>{rows}</tbody>
                </table>
            </div>
        </section>
    }
    .into_any()
}

fn error_text(language: Language, error: buslens_codec::intake::IntakeError) -> String {
    let what = match error.fault {
        IntakeFault::Unexpected(character) => language.unexpected_character(character),
        IntakeFault::OddDigits => language.odd_digits().to_owned(),
    };
    language.parse_error_at(error.line, error.column, &what)
}

/// Digits of a link in pairs, as long as they are digits; anything else stays for the parser to complain about.
fn spaced(digits: &str) -> String {
    let mut text = String::with_capacity(digits.len() * 3 / 2);
    for (at, character) in digits.chars().enumerate() {
        if at > 0 && at % 2 == 0 {
            text.push(' ');
        }
        text.push(character);
    }
    text
}
