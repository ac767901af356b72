//! Which page is shown: the part of the address after `#`.

use crate::reactive::*;
use wasm_bindgen::JsValue;

use crate::dom::on_window;

/// A page with what its address carries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Route {
    /// `#/live`, and everything unknown.
    Live,
    /// `#/decoder?frame=HEX`, with any number of frames.
    Decoder {
        /// The frames as written in the address.
        frames: Vec<String>,
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
                let frames = query.split('&').filter_map(|pair| pair.strip_prefix("frame="));
                Self::Decoder { frames: frames.filter(|frame| !frame.is_empty()).map(str::to_owned).collect() }
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

/// Takes the frames out of the address once they are on the page, so that a reload does not bring them back over what
/// was typed since.
pub(crate) fn forget_frames() {
    if let Ok(history) = window().history() {
        let _ = history.replace_state_with_url(&JsValue::NULL, "", Some("#/decoder"));
    }
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
        assert_eq!(Route::parse(&link), Route::Decoder { frames: vec!["0C04".to_owned(), "FF".to_owned()] });
        assert_eq!(Route::parse(&decoder_link(&[])), Route::Decoder { frames: Vec::new() });
    }
}
