//! Ports by name: what a user picks from, and how a choice is found again after a reload.

use crate::adapter;
use crate::message::PortId;
use crate::text::Language;

/// A key that names the same port after a reload, as far as a browser lets a page know: USB ids and the place among
/// adapters of the same kind.
pub(crate) fn key(ports: &[PortId], at: usize) -> String {
    let Some(port) = ports.get(at) else { return String::new() };
    let mut key =
        port.usb.map_or_else(|| "serial".to_owned(), |(vendor, product)| format!("{vendor:04x}:{product:04x}"));
    let twin = twin(ports, at);
    if twin > 1 {
        key = format!("{key}#{twin}");
    }
    key
}

/// The port that a key names; without such a port the first one.
pub(crate) fn find(ports: &[PortId], wanted: &str) -> Option<PortId> {
    let found = (0..ports.len()).find(|&at| key(ports, at) == wanted).unwrap_or(0);
    ports.get(found).copied()
}

/// The name to show for a port.
pub(crate) fn title(language: Language, ports: &[PortId], port: PortId) -> String {
    let mut title =
        port.usb.map_or_else(|| language.serial_port().to_owned(), |(vendor, product)| adapter::title(vendor, product));
    let at = ports.iter().position(|other| *other == port).unwrap_or(0);
    let twin = twin(ports, at);
    if twin > 1 {
        title = format!("{title} ({twin})");
    }
    title
}

/// Which of the adapters of one kind this is, counted from 1.
fn twin(ports: &[PortId], at: usize) -> usize {
    let kind = ports.get(at).map(|port| port.usb);
    ports.iter().take(at).filter(|port| Some(port.usb) == kind).count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(index: u32, usb: Option<(u16, u16)>) -> PortId {
        PortId { index, usb }
    }

    #[test]
    fn twins_are_told_apart_and_found_again() {
        let ch340 = Some((0x1A86, 0x7523));
        let ports = [port(0, ch340), port(1, None), port(2, ch340)];
        assert_eq!(key(&ports, 0), "1a86:7523");
        assert_eq!(key(&ports, 1), "serial");
        assert_eq!(key(&ports, 2), "1a86:7523#2");
        for (at, port) in ports.iter().enumerate() {
            assert_eq!(find(&ports, &key(&ports, at)), Some(*port));
        }
        assert_eq!(title(Language::En, &ports, ports[2]), "CH340 (2)");
        assert_eq!(title(Language::Zh, &ports, ports[1]), "串口");
    }

    #[test]
    fn an_unknown_key_means_the_first_port() {
        let ports = [port(0, None)];
        assert_eq!(find(&ports, "1a86:7523"), Some(ports[0]));
        assert_eq!(find(&[], "serial"), None);
    }
}
