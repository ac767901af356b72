//! A frame decoded as far as lists, filters and statistics need, borrowed from its bytes and without any allocation.
//!
//! [`Outline`] says what the fields of a well-formed PDU hold; it neither judges limits nor names values, which is the part
//! of [`dissect`](mod@crate::dissect). It takes any bytes: a field that they are too short for is `None` or empty.

use crate::UnitId;
use crate::pdu::ExceptionCode;
use crate::rtu::MIN_ADU_LEN;
use crate::stream::Shape;

/// What a frame says (application protocol, clause 6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outline<'a> {
    /// Addressed or answering.
    pub unit: UnitId,
    /// The function code, without an exception's top bit.
    pub function: u8,
    /// Which way the frame goes.
    pub shape: Shape,
    /// Why the device refuses, if it does.
    pub exception: Option<ExceptionCode>,
    /// First coil or register: read or written (function 17: read), or the FIFO's.
    pub address: Option<u16>,
    /// How many coils or registers are read or written (function 17: read).
    pub quantity: Option<u16>,
    /// First register written by a request of function 17.
    pub write_address: Option<u16>,
    /// The values that are carried, without address, quantity and byte count: registers with the high byte first, bits with
    /// the lowest first. Of other functions everything after the function code.
    pub data: &'a [u8],
}

impl<'a> Outline<'a> {
    /// Reads an RTU frame with a right check, which is not looked at. `None` for fewer bytes than the shortest frame has.
    /// A frame that can be [either](Shape::Either) is read as a request.
    #[inline]
    pub fn of_rtu(frame: &'a [u8], shape: Shape) -> Option<Self> {
        match frame {
            [unit, function, data @ .., _, _] if frame.len() >= MIN_ADU_LEN => {
                Some(Self::of_parts(UnitId(*unit), *function, data, shape))
            }
            _ => None,
        }
    }

    /// Reads a PDU of 1 to 253 bytes. `None` for no bytes.
    #[inline]
    pub fn of_pdu(unit: UnitId, pdu: &'a [u8], shape: Shape) -> Option<Self> {
        let (function, data) = pdu.split_first()?;
        Some(Self::of_parts(unit, *function, data, shape))
    }

    #[inline]
    fn of_parts(unit: UnitId, function: u8, data: &'a [u8], shape: Shape) -> Self {
        let plain = Self {
            unit,
            function: function & 0x7F,
            shape,
            exception: None,
            address: None,
            quantity: None,
            write_address: None,
            data,
        };
        let reply = shape == Shape::Response;
        match (function, data) {
            (0x80.., _) => plain.refused(),
            (0x01..=0x04 | 0x17, [_, values @ ..]) if reply => Self { data: values, ..plain },
            (0x01..=0x04, _) => plain.block(),
            (0x0F | 0x10, _) => plain.block().counted(),
            (0x17, _) => plain.read_write(),
            (0x18, [_, _, high, low, values @ ..]) if reply => {
                Self { quantity: Some(u16::from_be_bytes([*high, *low])), data: values, ..plain }
            }
            (0x05 | 0x06 | 0x16 | 0x18, _) => plain.single(),
            _ => plain,
        }
    }

    #[inline]
    fn refused(self) -> Self {
        Self { exception: self.data.first().copied().map(ExceptionCode::from), ..self }
    }

    /// Address, then values.
    #[inline]
    fn single(self) -> Self {
        match *self.data {
            [high, low, ref data @ ..] => Self { address: Some(u16::from_be_bytes([high, low])), data, ..self },
            _ => self,
        }
    }

    /// Address, quantity, then what follows.
    #[inline]
    fn block(self) -> Self {
        match *self.data {
            [a, b, c, d, ref data @ ..] => Self {
                address: Some(u16::from_be_bytes([a, b])),
                quantity: Some(u16::from_be_bytes([c, d])),
                data,
                ..self
            },
            _ => self,
        }
    }

    /// Leaves the byte count out.
    #[inline]
    fn counted(self) -> Self {
        Self { data: self.data.get(1..).unwrap_or_default(), ..self }
    }

    fn read_write(self) -> Self {
        let read = self.block();
        let write = Self { address: None, quantity: None, ..read }.block().counted();
        Self { write_address: write.address, data: write.data, ..read }
    }

    /// The registers that the frame carries: read, written, or the two masks of function 16. None for other functions.
    #[inline]
    pub fn registers(&self) -> impl ExactSizeIterator<Item = u16> + use<'a> {
        let words = match self.function {
            0x03 | 0x04 | 0x06 | 0x10 | 0x16..=0x18 if self.exception.is_none() => self.data,
            _ => &[],
        };
        words.as_chunks::<2>().0.iter().map(|word| u16::from_be_bytes(*word))
    }

    /// The coils or inputs that the frame carries, none for other functions. A reply tells whole bytes: what is beyond the
    /// quantity of its request is padding.
    pub fn bits(&self) -> impl Iterator<Item = bool> + use<'a> {
        let bytes = match self.function {
            0x01 | 0x02 | 0x0F if self.exception.is_none() => self.data,
            // FF00 or 0000.
            0x05 if self.exception.is_none() => self.data.get(..1).unwrap_or_default(),
            _ => &[],
        };
        let count = if self.function == 0x05 { Some(1) } else { self.quantity };
        let bits = bytes.iter().flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1 == 1));
        bits.take(count.map_or(usize::MAX, usize::from))
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use proptest::prelude::*;

    use super::*;
    use crate::line::Mode;
    use crate::pdu::{Request, Response};
    use crate::stream::{PieceKind, split};

    fn of(pdu: &[u8], shape: Shape) -> Outline<'_> {
        Outline::of_pdu(UnitId(1), pdu, shape).unwrap()
    }

    fn registers(outline: Outline<'_>) -> Vec<u16> {
        outline.registers().collect()
    }

    #[test]
    fn reads_and_their_replies() {
        let frame = [0x01, 0x04, 0x08, 0x00, 0x00, 0x01, 0x1D, 0x00, 0x7B, 0x01, 0xC8, 0xB9, 0xC1];
        let piece = split(Mode::Rtu, &frame).next().unwrap();
        let PieceKind::Frame(shape) = piece.kind else { panic!("no frame: {piece:?}") };
        let reply = Outline::of_rtu(&frame, shape).unwrap();
        assert_eq!((reply.unit, reply.function, reply.shape), (UnitId(1), 4, Shape::Response));
        assert_eq!((reply.address, reply.quantity), (None, None));
        assert_eq!(registers(reply), [0, 0x11D, 0x7B, 0x1C8]);
        let request = of(&[0x04, 0, 2, 0, 4], Shape::Request);
        assert_eq!((request.address, request.quantity, request.data), (Some(2), Some(4), &[][..]));
    }

    #[test]
    fn bits_come_lowest_first_and_as_many_as_there_are() {
        let write = of(&[0x0F, 0, 0x13, 0, 10, 2, 0xCD, 0x01], Shape::Request);
        assert_eq!((write.address, write.quantity), (Some(0x13), Some(10)));
        let bits: Vec<bool> = write.bits().collect();
        assert_eq!(bits, [true, false, true, true, false, false, true, true, true, false]);
        assert_eq!(of(&[0x01, 1, 0x05], Shape::Response).bits().filter(|bit| *bit).count(), 2);
        assert!(of(&[0x05, 0, 0x50, 0xFF, 0], Shape::Either).bits().eq([true]));
        assert!(of(&[0x05, 0, 0x50, 0, 0], Shape::Either).bits().eq([false]));
        assert_eq!(registers(write), []);
    }

    #[test]
    fn functions_with_two_parts() {
        let both = of(&[0x17, 0, 3, 0, 6, 0, 14, 0, 2, 4, 0, 0xFF, 1, 2], Shape::Request);
        assert_eq!((both.address, both.quantity, both.write_address), (Some(3), Some(6), Some(14)));
        assert_eq!(registers(both), [0xFF, 0x102]);
        assert_eq!(registers(of(&[0x17, 4, 0, 1, 0, 2], Shape::Response)), [1, 2]);
        let mask = of(&[0x16, 0, 4, 0, 0xF2, 0, 0x25], Shape::Either);
        assert_eq!((mask.address, registers(mask)), (Some(4), [0xF2, 0x25].to_vec()));
        let fifo = of(&[0x18, 0, 6, 0, 2, 1, 0xB8, 0x12, 0x84], Shape::Response);
        assert_eq!((fifo.quantity, registers(fifo)), (Some(2), [0x1B8, 0x1284].to_vec()));
        assert_eq!(of(&[0x18, 4, 0xDE], Shape::Request).address, Some(0x4DE));
    }

    #[test]
    fn an_exception_carries_no_values() {
        let refused = of(&[0x83, 0x02], Shape::Response);
        assert_eq!((refused.function, refused.exception), (3, Some(ExceptionCode::IllegalDataAddress)));
        assert_eq!(registers(refused), []);
        assert_eq!(Outline::of_pdu(UnitId(1), &[], Shape::Either), None);
        assert_eq!(Outline::of_rtu(&[1, 3, 0], Shape::Request), None);
    }

    proptest! {
        /// What the full decoder reads, the outline reads too.
        #[test]
        fn requests_and_responses_agree(address: u16, values in prop::collection::vec(any::<u16>(), 1..=123)) {
            let quantity = u16::try_from(values.len()).unwrap();
            let pdu = Request::WriteMultipleRegisters { address, values: values.clone() }.encode().unwrap();
            let write = of(&pdu, Shape::Request);
            prop_assert_eq!((write.address, write.quantity), (Some(address), Some(quantity)));
            prop_assert_eq!(registers(write), values.clone());
            let pdu = Response::WriteMultipleRegisters { address, quantity }.encode().unwrap();
            let written = of(&pdu, Shape::Response);
            prop_assert_eq!((written.address, written.quantity), (Some(address), Some(quantity)));
            let pdu = Response::ReadHoldingRegisters { values: values.clone() }.encode().unwrap();
            prop_assert_eq!(registers(of(&pdu, Shape::Response)), values);
        }

        #[test]
        fn any_bytes_can_be_read(
            pdu in prop::collection::vec(any::<u8>(), 1..40),
            function in 0u8..0x30,
            shape in prop_oneof![Just(Shape::Request), Just(Shape::Response), Just(Shape::Either)],
        ) {
            let mut pdu = pdu;
            pdu[0] = function;
            let outline = of(&pdu, shape);
            prop_assert!(outline.registers().len() <= pdu.len() / 2);
            prop_assert!(outline.bits().count() <= 8 * pdu.len());
        }
    }
}
