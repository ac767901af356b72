//! Which page is shown: the part of the address after `#`.

use crate::reactive::prelude::*;
use wasm_bindgen::JsValue;

use crate::dom::on_window;

/// A page with what its address carries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Route {
    /// `#/live`, and everything unknown.
    Live,
    /// `#/decoder?frame=HEX`, with any number of frames, or `#/decoder?text=TEXT`.
    Decoder {
        /// What the address brings to be read; empty for nothing.
        text: String,
    },
    /// `#/builder`.
    Builder,
}

impl Route {
    /// Reads the address's part from `#` on.
    pub(crate) fn parse(hash: &str) -> Self {
        let (path, query) = hash.trim_start_matches('#').split_once('?').unwrap_or((hash.trim_start_matches('#'), ""));
        match path.trim_matches('/') {
            "decoder" => {
                let values = |key: &'static str| query.split('&').filter_map(move |pair| pair.strip_prefix(key));
                let frames: Vec<String> = values("frame=").filter(|frame| !frame.is_empty()).map(spaced).collect();
                let text = values("text=").next().and_then(decoded).unwrap_or_else(|| frames.join("\n"));
                Self::Decoder { text }
            }
            "builder" => Self::Builder,
            _ => Self::Live,
        }
    }
}

/// The route as a signal that follows the address.
pub(crate) fn follow() -> RwSignal<Route> {
    let route = RwSignal::new(current());
    on_window("hashchange", move |_| route.set(current()));
    route
}

/// Takes the text out of the address once it is on the page, so that a reload does not bring it back over what was typed
/// since.
pub(crate) fn forget_text() {
    if let Ok(history) = window().history() {
        let _ = history.replace_state_with_url(&JsValue::NULL, "", Some("#/decoder"));
    }
}

/// The whole address that opens the decoder with a text. The part behind `#` is never sent to a server.
pub(crate) fn text_link(text: &str) -> String {
    let here = window().location().href().unwrap_or_default();
    let page = here.split('#').next().unwrap_or_default();
    [page, "#/decoder?text=", &String::from(js_sys::encode_uri_component(text))].concat()
}

/// Digits in pairs, as long as they are digits; anything else stays for the reader to complain about.
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

/// Undoes the percent signs of an address; `None` where they make no text.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let digit = |byte: u8| char::from(byte).to_digit(16);
            let (high, low) = (digit(rest.next()?)?, digit(rest.next()?)?);
            bytes.push(u8::try_from(high * 16 + low).ok()?);
        } else {
            bytes.push(byte);
        }
    }
    String::from_utf8(bytes).ok()
}

/// The address that opens the decoder with these frames.
pub(crate) fn decoder_link(frames: &[&[u8]]) -> String {
    let mut link = String::from("#/decoder");
    let mut mark = "?frame=";
    for frame in frames.iter().filter(|frame| !frame.is_empty()) {
        link.push_str(mark);
        crate::format::push_hex(&mut link, frame);
        mark = "&frame=";
    }
    link
}

fn current() -> Route {
    Route::parse(&window().location().hash().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_addresses_lead_to_the_live_page() {
        for hash in ["", "#", "#/live", "#/nowhere", "#live?frame=00"] {
            assert_eq!(Route::parse(hash), Route::Live, "{hash}");
        }
    }

    #[test]
    fn the_builder_has_an_address() {
        assert_eq!(Route::parse("#/builder"), Route::Builder);
    }

    #[test]
    fn a_link_brings_its_frames_back() {
        let link = decoder_link(&[&[0x0C, 0x04], &[], &[0xFF]]);
        assert_eq!(link, "#/decoder?frame=0C04&frame=FF");
        assert_eq!(Route::parse(&link), Route::Decoder { text: "0C 04\nFF".to_owned() });
        assert_eq!(Route::parse(&decoder_link(&[])), Route::Decoder { text: String::new() });
    }

    #[test]
    fn a_text_in_a_link_is_taken_as_it_was() {
        let parse = |query: &str| Route::parse(&["#/decoder?text=", query].concat());
        assert_eq!(parse("%E5%8F%91%3A%2001%0A%26"), Route::Decoder { text: "发: 01\n&".to_owned() });
        assert_eq!(parse("01%2"), Route::Decoder { text: String::new() });
        assert_eq!(parse("%FF"), Route::Decoder { text: String::new() });
    }
}
