//! Bytes and registers bit by bit.

use super::{Words, address_text, shortened};
use crate::text::Language;

/// Most addresses in one list.
const MOST: usize = 8;

/// One bit of some flags.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Bit {
    /// 0 is the least significant one.
    pub(crate) position: u8,
    /// Whether it is 1.
    pub(crate) on: bool,
    /// What it stands for, empty where nobody knows.
    pub(crate) label: String,
}

/// The bits of a register with their positions, the highest first.
pub(super) fn bits_of(value: u16) -> [(u8, bool); 16] {
    let mut bits = [(0, false); 16];
    for (position, bit) in (0_u8..16).rev().zip(&mut bits) {
        *bit = (position, value >> position & 1 == 1);
    }
    bits
}

/// The lowest `count` bits, the highest first, with labels by their positions.
pub(super) fn labelled(value: u16, count: usize, label: &dyn Fn(u8) -> String) -> Vec<Bit> {
    let bits = bits_of(value);
    let bit = |&(position, on): &(u8, bool)| Bit { position, on, label: label(position) };
    bits.iter().skip(bits.len().saturating_sub(count)).map(bit).collect()
}

/// `1100 1101`: the lowest `count` bits in groups of four.
pub(super) fn binary(value: u16, count: usize) -> String {
    let mut text = String::with_capacity(count + count / 4);
    for (position, on) in bits_of(value).into_iter().filter(|(position, _)| usize::from(*position) < count) {
        text.push(if on { '1' } else { '0' });
        if position > 0 && position % 4 == 0 {
            text.push(' ');
        }
    }
    text
}

/// Which bits of a byte are set, by their positions.
pub(super) fn set_bits(language: Language, value: u8) -> String {
    let set = (0..8).filter(|position| value >> position & 1 == 1).map(|position: u8| position.to_string());
    let set: Vec<String> = set.collect();
    if set.is_empty() {
        return language.bits_clear().to_owned();
    }
    language.bits_set(&set.join(language.list_of_names()))
}

impl Words<'_> {
    /// Which of these coils or inputs are on and which are off. Without a first address they are counted from where the
    /// request began: `+0`.
    pub(super) fn states(self, function: u8, first: Option<u16>, skipped: usize, bits: &[bool]) -> String {
        let t = self.language;
        let list = |wanted: bool| {
            let chosen = bits.iter().enumerate().filter(|(_, bit)| **bit == wanted);
            let list: Vec<String> = chosen.map(|(at, _)| self.bit_name(function, first, skipped + at)).collect();
            shortened(t, list, t.list_of_names(), MOST)
        };
        match bits {
            [] => String::new(),
            [bit] => [&self.bit_name(function, first, skipped), " ", self.state(*bit)].concat(),
            _ if !bits.contains(&false) => t.all_on().to_owned(),
            _ if !bits.contains(&true) => t.all_off().to_owned(),
            _ => [&t.are_on(&list(true)), t.list_pause(), &t.are_off(&list(false))].concat(),
        }
    }

    /// On or off.
    pub(super) fn state(self, bit: bool) -> &'static str {
        if bit { self.language.coil_on() } else { self.language.coil_off() }
    }

    /// A coil's or an input's address, with its name under the profile.
    pub(super) fn bit_name(self, function: u8, first: Option<u16>, at: usize) -> String {
        let address = first.and_then(|first| first.checked_add(u16::try_from(at).ok()?));
        let Some(address) = address else { return ["+", &at.to_string()].concat() };
        let names = self.names_at(function, address, 1);
        if names.is_empty() { address_text(address) } else { [&address_text(address), " ", &names].concat() }
    }
}
