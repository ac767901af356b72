//! How long an RTU frame can be, told by its first bytes (application protocol, clause 6, and serial line guide, 2.5.1).
//!
//! Lengths are those of the whole frame: unit id, PDU and CRC.

use super::Shape;
use crate::rtu::MAX_ADU_LEN;

/// Lengths that the first bytes of a frame let expect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lengths {
    /// Shorter first.
    pub(super) short: Candidate,
    pub(super) long: Candidate,
    /// Bytes that are still to come may tell another length.
    pub(super) more: bool,
    /// The function tells no length, or not all: the check alone can show the end.
    pub(super) search: Search,
}

/// A length of 4 to 256 and what a frame of that length is; a length of zero is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Candidate {
    pub(super) len: usize,
    pub(super) shape: Shape,
}

/// Which lengths a frame can have when the function does not tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Search {
    /// The function tells.
    No,
    /// Any.
    Any,
    /// Unit id, function, sub-function and any number of words.
    Words,
}

/// What is known of one length.
#[derive(Clone, Copy)]
enum Told {
    Is(usize),
    Never,
    /// A byte is still to come.
    Later,
}

impl Candidate {
    const NONE: Self = Self { len: 0, shape: Shape::Either };
}

impl Lengths {
    const LATER: Self = Self { short: Candidate::NONE, long: Candidate::NONE, more: true, search: Search::No };
    const NEVER: Self = Self { more: false, ..Self::LATER };
    const ANY: Self = Self { search: Search::Any, ..Self::NEVER };

    #[inline]
    const fn one(len: usize, shape: Shape) -> Self {
        Self { short: Candidate { len, shape }, ..Self::NEVER }
    }

    /// A request or a reply.
    #[inline]
    fn two(request: Told, reply: Told) -> Self {
        match (request, reply) {
            (Told::Is(request), Told::Is(reply)) => {
                let a = Candidate { len: request, shape: Shape::Request };
                let b = Candidate { len: reply, shape: Shape::Response };
                match request.cmp(&reply) {
                    core::cmp::Ordering::Less => Self { short: a, long: b, ..Self::NEVER },
                    core::cmp::Ordering::Greater => Self { short: b, long: a, ..Self::NEVER },
                    core::cmp::Ordering::Equal => Self::one(request, Shape::Either),
                }
            }
            (Told::Is(len), other) => Self { more: matches!(other, Told::Later), ..Self::one(len, Shape::Request) },
            (other, Told::Is(len)) => Self { more: matches!(other, Told::Later), ..Self::one(len, Shape::Response) },
            (Told::Never, Told::Never) => Self::NEVER,
            _ => Self::LATER,
        }
    }

    /// The greatest length, 0 if there is none.
    #[inline]
    pub(super) fn longest(&self) -> usize {
        self.long.len.max(self.short.len)
    }
}

/// The lengths that a frame beginning with `bytes` can have. More bytes never take a length away that fewer bytes told.
#[inline]
pub(super) fn lengths(bytes: &[u8]) -> Lengths {
    let &[_, function, ref data @ ..] = bytes else { return Lengths::LATER };
    match function {
        0x01..=0x04 => read(function, data),
        0x05 | 0x06 => Lengths::one(8, Shape::Either),
        0x81.. => Lengths::one(5, Shape::Response),
        0x07 => Lengths::two(Told::Is(4), Told::Is(5)),
        0x08 => diagnostics(data),
        0x0B => Lengths::two(Told::Is(4), Told::Is(8)),
        // Status, event count, message count, and up to 64 events.
        0x0C => Lengths::two(Told::Is(4), counted(data, 6..=70)),
        0x0F => Lengths::two(multiple_write(data, 1968, |coils| coils.div_ceil(8)), Told::Is(8)),
        0x10 => Lengths::two(multiple_write(data, 123, |registers| registers * 2), Told::Is(8)),
        0x11 => Lengths::two(Told::Is(4), counted(data, 1..=251)),
        0x14 => either(counted(data, 2..=251)),
        0x15 => either(counted(data, 9..=251)),
        0x16 => Lengths::one(10, Shape::Either),
        0x17 => Lengths::two(read_write(data), even(counted(data, 2..=250))),
        0x18 => Lengths::two(Told::Is(6), fifo(data)),
        0x2B => match data.first() {
            Some(0x0E) => Lengths::two(Told::Is(7), identification(bytes)),
            Some(_) => Lengths::ANY,
            None => Lengths::LATER,
        },
        // The standard uses neither 0 nor the refusal of it (clause 4.1).
        0x00 | 0x80 => Lengths::NEVER,
        _ => Lengths::ANY,
    }
}

/// What a frame with a right check is, for the lengths that say it only together with what is in the frame.
#[inline]
pub(super) fn shape_within(frame: &[u8], told: Shape) -> Shape {
    match frame {
        [_, 0x14, _, groups @ .., _, _] => file_read(groups),
        _ => told,
    }
}

/// Functions 01 to 04: bits or registers, and a request that can look like the start of a short reply.
#[inline]
fn read(function: u8, data: &[u8]) -> Lengths {
    let Some(&count) = data.first() else { return Lengths::LATER };
    let registers = function >= 0x03;
    if count == 0 || count > 250 || (registers && count % 2 == 1) {
        return Lengths::one(8, Shape::Request);
    }
    let reply = Candidate { len: usize::from(count) + 5, shape: Shape::Response };
    let request = Candidate { len: 8, shape: Shape::Request };
    match reply.len {
        ..8 => Lengths { short: reply, long: request, ..Lengths::NEVER },
        8 => Lengths::one(8, Shape::Either),
        _ => Lengths { short: request, long: reply, ..Lengths::NEVER },
    }
}

/// Function 08: two bytes of data, but as many words as the master likes for sub-function 0, which returns them.
fn diagnostics(data: &[u8]) -> Lengths {
    match data {
        [0, 0, ..] => Lengths { search: Search::Words, ..Lengths::one(8, Shape::Either) },
        [_, _, ..] => Lengths::one(8, Shape::Either),
        _ => Lengths::LATER,
    }
}

/// A byte count after the function, and so many bytes.
fn counted(data: &[u8], limits: core::ops::RangeInclusive<u8>) -> Told {
    match data.first() {
        Some(count) if limits.contains(count) => Told::Is(usize::from(*count) + 5),
        Some(_) => Told::Never,
        None => Told::Later,
    }
}

fn even(told: Told) -> Told {
    match told {
        Told::Is(len) if len.is_multiple_of(2) => Told::Never,
        told => told,
    }
}

/// A length that requests and replies share.
fn either(told: Told) -> Lengths {
    match told {
        Told::Is(len) => Lengths::one(len, Shape::Either),
        Told::Never => Lengths::NEVER,
        Told::Later => Lengths::LATER,
    }
}

/// Functions 0F and 10: address, quantity, byte count, values.
fn multiple_write(data: &[u8], most: u16, bytes_of: impl Fn(u16) -> u16) -> Told {
    let &[_, _, high, low, ref rest @ ..] = data else { return Told::Later };
    let quantity = u16::from_be_bytes([high, low]);
    match rest.first() {
        _ if !(1..=most).contains(&quantity) => Told::Never,
        Some(count) if u16::from(*count) == bytes_of(quantity) => Told::Is(usize::from(*count) + 9),
        Some(_) => Told::Never,
        None => Told::Later,
    }
}

/// A request of function 17: what to read, what to write, byte count, values.
fn read_write(data: &[u8]) -> Told {
    let &[_, _, high, low, ref rest @ ..] = data else { return Told::Later };
    if !(1..=125).contains(&u16::from_be_bytes([high, low])) {
        return Told::Never;
    }
    match multiple_write(rest, 121, |registers| registers * 2) {
        Told::Is(len) => Told::Is(len + 4),
        told => told,
    }
}

/// A reply of function 18: a byte count of two bytes, the number of registers (up to 31), the registers.
fn fifo(data: &[u8]) -> Told {
    let &[high, low, ref rest @ ..] = data else { return Told::Later };
    let bytes = u16::from_be_bytes([high, low]);
    if !(2..=64).contains(&bytes) {
        return Told::Never;
    }
    match *rest {
        [high, low, ..] if u16::from_be_bytes([high, low]) == bytes / 2 - 1 && bytes.is_multiple_of(2) => {
            Told::Is(usize::from(bytes) + 6)
        }
        [_, _, ..] => Told::Never,
        _ => Told::Later,
    }
}

/// A reply of function 2B/0E: the object list, gone through by the length of each object.
fn identification(frame: &[u8]) -> Told {
    let head = frame.iter().skip(3);
    let fits = |(at, byte): (usize, &u8)| match at {
        0 => (1..=4).contains(byte),
        1 => matches!(byte, 0x01..=0x03 | 0x81..=0x83),
        2 => matches!(byte, 0x00 | 0xFF),
        _ => true,
    };
    if !head.take(3).enumerate().all(fits) {
        return Told::Never;
    }
    let Some(&objects) = frame.get(7) else { return Told::Later };
    let mut end = 8;
    for _ in 0..objects {
        if end + 2 > MAX_ADU_LEN - 2 {
            return Told::Never;
        }
        let Some(&len) = frame.get(end + 1) else { return Told::Later };
        end += 2 + usize::from(len);
    }
    if end + 2 > MAX_ADU_LEN { Told::Never } else { Told::Is(end + 2) }
}

/// Function 14: a request is a list of groups of seven bytes, a reply a list of counted groups; each group names the
/// reference type 6.
fn file_read(groups: &[u8]) -> Shape {
    let (sevens, rest) = groups.as_chunks::<7>();
    let request = rest.is_empty() && sevens.iter().all(|group| group[0] == 6);
    let mut left = groups;
    let reply = loop {
        match *left {
            [] => break true,
            [len, 6, ref rest @ ..] if len > 0 => match rest.get(usize::from(len) - 1..) {
                Some(rest) => left = rest,
                None => break false,
            },
            _ => break false,
        }
    };
    match (request, reply) {
        (true, false) => Shape::Request,
        (false, true) => Shape::Response,
        _ => Shape::Either,
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Any bytes behind any function, and more bytes never unsay what fewer told.
        #[test]
        fn more_bytes_only_add(function in any::<u8>(), bytes in prop::collection::vec(any::<u8>(), 0..40), small: bool) {
            let data = bytes.iter().map(|byte| if small { byte & 0x0F } else { *byte });
            let bytes: Vec<u8> = [1, function].into_iter().chain(data).collect();
            let mut before = Lengths::LATER;
            for len in 0..=bytes.len() {
                let now = lengths(&bytes[..len]);
                prop_assert!(now.longest() <= MAX_ADU_LEN);
                prop_assert!(now.long.len == 0 || (now.short.len > 0 && now.short.len < now.long.len));
                if !before.more {
                    prop_assert_eq!(now, before);
                }
                for told in [before.short, before.long] {
                    let still = [now.short, now.long].iter().any(|candidate| candidate.len == told.len);
                    prop_assert!(told.len == 0 || still);
                }
                before = now;
            }
        }
    }

    #[test]
    fn a_file_read_is_told_by_its_groups() {
        let told = |groups: &[u8]| shape_within(&[&[1, 0x14, 0][..], groups, &[0, 0]].concat(), Shape::Either);
        assert_eq!(told(&[6, 0, 4, 0, 1, 0, 2]), Shape::Request);
        assert_eq!(told(&[5, 6, 0x0D, 0xFE, 0, 0x20, 5, 6, 0x33, 0xCD, 0, 0x40]), Shape::Response);
        assert_eq!(told(&[6, 6, 0, 1, 0, 2, 0]), Shape::Either);
        assert_eq!(told(&[0, 6, 1]), Shape::Either);
    }

    #[test]
    fn an_object_list_ends_behind_its_last_object() {
        let list = [1, 0x2B, 0x0E, 1, 1, 0, 0, 2, 0, 2, b'A', b'B', 1, 1, b'C', 0, 0];
        assert_eq!(lengths(&list).long, Candidate { len: 17, shape: Shape::Response });
        assert!(lengths(&list[..13]).more);
        // Two objects of 200 bytes fit no frame.
        let long = [&[1, 0x2B, 0x0E, 1, 1, 0, 0, 2, 0, 200][..], &[0; 200], &[1, 200]].concat();
        assert_eq!(lengths(&long).longest(), 7);
    }
}
