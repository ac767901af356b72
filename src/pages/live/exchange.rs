//! The last exchange byte by byte.

use buslens_codec::dissect::Direction;
use buslens_codec::line::Mode;
use leptos::prelude::*;

use crate::anatomy::{Anatomy, request_in};
use crate::app::App;
use crate::components::bytes::byte_groups;
use crate::components::icon::{Icon, icon};
use crate::message::Frames;
use crate::route::decoder_link;
use crate::text::Language;

/// The card with request and reply.
pub(super) fn last_exchange(app: &'static App) -> AnyView {
    let frames = Memo::new(move |_| app.status.with(|status| status.exchange.clone().unwrap_or_default()));
    view! {
        <section class="card exchange">
            <header>
                <h2>{app.text(Language::last_exchange)}</h2>
                <span class="space"></span>
                <a
                    class="button quiet small"
                    data-test="open-in-decoder"
                    href=move || frames.with(|frames| decoder_link(&[&frames.sent, &frames.received]))
                >
                    {app.text(Language::open_in_decoder)}
                    {icon(Icon::Go)}
                </a>
            </header>
            {move || halves(app, &frames.get())}
        </section>
    }
    .into_any()
}

fn halves(app: &'static App, frames: &Frames) -> AnyView {
    let language = app.language.get();
    let profile = app.settings.device().profile();
    let mode = app.connection.with(|used| used.as_ref().map_or(Mode::Rtu, |used| used.mode));
    let request = request_in(&frames.sent, mode).map(|(_, request)| request);
    let bytes = |bytes: &[u8], direction, request: Option<_>, empty: &'static str| {
        if bytes.is_empty() {
            return view! { <p class="empty">{empty}</p> }.into_any();
        }
        byte_groups(&Anatomy::of(language, profile, bytes, mode, direction, request), RwSignal::new(None))
    };
    view! {
        <div class="half">
            <span class="direction tx">"TX"</span>
            {bytes(&frames.sent, Direction::Request, None, language.nothing_sent())}
        </div>
        <div class="half">
            <span class="direction rx">"RX"</span>
            {bytes(&frames.received, Direction::Response, request.as_ref(), language.nothing_received())}
        </div>
    }
    .into_any()
}
