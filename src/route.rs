//! Which page is shown, and what it is given to read: the part of the address after `#`.

use crate::reactive::prelude::*;
use serde::{Deserialize, Serialize};
use wasm_bindgen::JsValue;

use crate::dom::on_window;

/// A page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Page {
    /// `#/live`, and everything unknown.
    Live,
    /// `#/decoder?frame=HEX`, with any number of frames, or `#/decoder?text=TEXT`.
    Decoder,
    /// `#/builder`.
    Builder,
    /// `#/profiles`.
    Profiles,
    /// `#/console`, or `#/console?send=HEX` with bytes to be sent.
    Console,
    /// `#/configure`.
    Configure,
    /// `#/fleet`.
    Fleet,
}

impl Page {
    /// The page of an address's part from `#` on.
    pub(crate) fn of(hash: &str) -> Self {
        match parts(hash).0 {
            "decoder" => Self::Decoder,
            "builder" => Self::Builder,
            "console" => Self::Console,
            "profiles" => Self::Profiles,
            "configure" => Self::Configure,
            "fleet" => Self::Fleet,
            _ => Self::Live,
        }
    }
}

/// The page as a signal that follows the address.
pub(crate) fn follow() -> RwSignal<Page> {
    follow_as(Page::of)
}

/// What the address brings to be read, as a signal that follows it; empty for nothing.
pub(crate) fn follow_text() -> RwSignal<String> {
    follow_as(text_of)
}

/// The digits of the bytes that the address brings to be sent, as a signal that follows it; empty for none.
pub(crate) fn follow_send() -> RwSignal<String> {
    follow_as(send_of)
}

fn follow_as<T: Send + Sync + 'static>(read: fn(&str) -> T) -> RwSignal<T> {
    let current = move || read(&window().location().hash().unwrap_or_default());
    let signal = RwSignal::new(current());
    on_window("hashchange", move |_| signal.set(current()));
    signal
}

/// Path and query of an address's part from `#` on.
fn parts(hash: &str) -> (&str, &str) {
    let address = hash.trim_start_matches('#');
    let (path, query) = address.split_once('?').unwrap_or((address, ""));
    (path.trim_matches('/'), query)
}

/// What an address of the decoder brings.
fn text_of(hash: &str) -> String {
    let (path, query) = parts(hash);
    if path != "decoder" {
        return String::new();
    }
    let values = |key: &'static str| query.split('&').filter_map(move |pair| pair.strip_prefix(key));
    let frames: Vec<String> = values("frame=").filter(|frame| !frame.is_empty()).map(spaced).collect();
    values("text=").next().and_then(decoded).unwrap_or_else(|| frames.join("\n"))
}

/// What an address of the console brings to be sent.
fn send_of(hash: &str) -> String {
    let (path, query) = parts(hash);
    let digits = query.split('&').find_map(|pair| pair.strip_prefix("send=")).filter(|_| path == "console");
    digits.unwrap_or_default().to_owned()
}

/// Takes the text out of the address once it is on the page, so that a reload does not bring it back over what was typed
/// since.
pub(crate) fn forget_text() {
    forget("#/decoder");
}

/// The same for bytes to be sent.
pub(crate) fn forget_send() {
    forget("#/console");
}

fn forget(page: &str) {
    if let Ok(history) = window().history() {
        let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(page));
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

/// The address that puts bytes into the console's send line.
pub(crate) fn console_link(bytes: &[u8]) -> String {
    let mut link = String::from("#/console?send=");
    crate::format::push_hex(&mut link, bytes);
    link
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_console_is_brought_bytes_to_send() {
        let link = console_link(&[0x0C, 0xFF]);
        assert_eq!(link, "#/console?send=0CFF");
        assert_eq!((Page::of(&link), send_of(&link).as_str(), text_of(&link).as_str()), (Page::Console, "0CFF", ""));
        assert_eq!((send_of("#/console"), send_of("#/decoder?send=00")), (String::new(), String::new()));
    }

    #[test]
    fn unknown_addresses_lead_to_the_live_page() {
        for hash in ["", "#", "#/live", "#/nowhere", "#live?frame=00"] {
            assert_eq!((Page::of(hash), text_of(hash)), (Page::Live, String::new()), "{hash}");
        }
    }

    #[test]
    fn pages_have_addresses() {
        assert_eq!(Page::of("#/builder"), Page::Builder);
        assert_eq!(Page::of("#/configure"), Page::Configure);
        assert_eq!(Page::of("#/fleet"), Page::Fleet);
    }

    #[test]
    fn the_profiles_have_an_address() {
        assert_eq!(Page::of("#/profiles"), Page::Profiles);
    }

    #[test]
    fn a_link_brings_its_frames_back() {
        let link = decoder_link(&[&[0x0C, 0x04], &[], &[0xFF]]);
        assert_eq!(link, "#/decoder?frame=0C04&frame=FF");
        assert_eq!((Page::of(&link), text_of(&link).as_str()), (Page::Decoder, "0C 04\nFF"));
        assert_eq!((Page::of(&decoder_link(&[])), text_of(&decoder_link(&[]))), (Page::Decoder, String::new()));
    }

    #[test]
    fn a_text_in_a_link_is_taken_as_it_was() {
        let text = |query: &str| text_of(&["#/decoder?text=", query].concat());
        assert_eq!(text("%E5%8F%91%3A%2001%0A%26"), "发: 01\n&");
        assert_eq!((text("01%2"), text("%FF")), (String::new(), String::new()));
    }
}
