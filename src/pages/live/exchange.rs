//! The last exchange byte by byte.

use crate::reactive::prelude::*;
use buslens_codec::dissect::Direction;
use buslens_codec::line::Mode;
use buslens_codec::pdu::Request;
use buslens_codec::profile::Known;

use crate::anatomy::{Anatomy, request_in};
use crate::app::App;
use crate::components::bytes::byte_groups;
use crate::components::icon::{Icon, icon};
use crate::device;
use crate::dom::{El, el};
use crate::loader;
use crate::message::{Exchange, ToWorkbench};
use crate::route::decoder_link;
use crate::text::Language;
use crate::workbench::Workbench;

/// The card with request and reply.
pub(super) fn last_exchange(app: &'static App) -> El {
    let frames = Memo::new(move |_| app.status.with(|status| status.exchange.clone().unwrap_or_default()));
    let open = el("a")
        .class("button quiet small")
        .test("open-in-decoder")
        .live_attr("href", move || Some(frames.with(|frames| decoder_link(&[&frames.sent, &frames.received]))))
        .child(el("span").say(app, Language::open_in_decoder))
        .child(icon(Icon::Go));
    let header =
        el("header").child(el("h2").say(app, Language::last_exchange)).child(el("span").class("space")).child(open);
    let exchange = move || {
        let mode = app.connection.with(|used| used.as_ref().map_or(Mode::Rtu, |used| used.mode));
        let device = app.settings.device().id().to_owned();
        ToWorkbench::Exchange(Some(Exchange { device, mode, frames: frames.get() }))
    };
    let body = loader::place(app, exchange, ToWorkbench::Exchange(None));
    el("section").class("card exchange").child(header).child(body)
}

/// Request and reply, as the workbench explains them.
pub(crate) fn exchange_halves(app: &'static Workbench) -> El {
    // What the device has told of scales and units since the page was opened or the device was chosen.
    let (mut device, mut known) = (String::new(), Known::default());
    el("div").class("contents").live(move || {
        app.exchange.with(|exchange| {
            let Some(exchange) = exchange else { return Vec::new() };
            if device != exchange.device {
                (device, known) = (exchange.device.clone(), Known::default());
            }
            halves(app.language.get(), exchange, &mut known)
        })
    })
}

/// The same of an exchange that stands for itself.
pub(crate) fn exchange_of(language: Language, exchange: &Exchange) -> Vec<El> {
    halves(language, exchange, &mut Known::default())
}

fn halves(language: Language, exchange: &Exchange, known: &mut Known) -> Vec<El> {
    let Exchange { device, mode, frames } = exchange;
    let profile = device::find(device).profile();
    let request = request_in(&frames.sent, *mode).map(|(_, request)| request);
    let mut half = |class, name, bytes: &[u8], direction, request: Option<&Request>, empty| {
        let shown = if bytes.is_empty() {
            el("p").class("empty").text(empty)
        } else {
            let anatomy = Anatomy::of(language, Some(profile), bytes, *mode, direction, request, known);
            byte_groups(&anatomy, RwSignal::new(None))
        };
        el("div").class("half").child(el("span").class(class).text(name)).child(shown)
    };
    let (nothing_sent, nothing_received) = (language.nothing_sent(), language.nothing_received());
    vec![
        half("direction tx", "TX", &frames.sent, Direction::Request, None, nothing_sent),
        half("direction rx", "RX", &frames.received, Direction::Response, request.as_ref(), nothing_received),
    ]
}
