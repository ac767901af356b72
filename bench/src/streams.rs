//! Streams as a monitor records them, the same in each run.

use buslens_codec::{UnitId, rtu};

/// What is in a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Replies of function 03 with 1 to 10 registers, back to back.
    Clean,
    /// Requests and their replies of functions 01, 03, 04, 05, 10 and refusals, back to back.
    Mixed,
    /// As clean, but every twentieth frame has a wrong bit and every tenth has noise before it.
    Noisy,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Clean, Self::Mixed, Self::Noisy];

    /// Its name in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Mixed => "mixed",
            Self::Noisy => "noisy",
        }
    }
}

/// A stream and what is in it.
#[derive(Clone, Debug)]
pub struct Stream {
    /// What kind it is.
    pub kind: Kind,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Frames in it with a right check.
    pub frames: usize,
}

/// A stream of at least `len` bytes, ended with its last frame.
pub fn stream(kind: Kind, len: usize) -> Stream {
    let mut dice = Dice(0x9E37_79B9_7F4A_7C15);
    let mut stream = Stream { kind, bytes: Vec::with_capacity(len + 512), frames: 0 };
    while stream.bytes.len() < len {
        match kind {
            Kind::Clean => stream.add(&registers(&mut dice, 0x03)),
            Kind::Noisy => stream.add_noisy(&mut dice),
            Kind::Mixed => {
                let (request, reply) = transaction(&mut dice);
                stream.add(&request);
                stream.add(&reply);
            }
        }
    }
    stream
}

impl Stream {
    fn add(&mut self, pdu: &[u8]) {
        self.bytes.extend(rtu::encode(UnitId(1), pdu).expect("a PDU fits a frame"));
        self.frames += 1;
    }

    fn add_noisy(&mut self, dice: &mut Dice) {
        if dice.below(10) == 0 {
            let len = 1 + dice.below(8);
            self.bytes.extend((0..len).map(|_| dice.byte()));
        }
        let start = self.bytes.len();
        self.add(&registers(dice, 0x03));
        if dice.below(20) == 0 {
            let at = start + dice.below(self.bytes.len() - start);
            self.bytes[at] ^= 1 << dice.below(8);
            self.frames -= 1;
        }
    }
}

fn registers(dice: &mut Dice, function: u8) -> Vec<u8> {
    let count = 2 * u8::try_from(1 + dice.below(10)).expect("at most ten");
    [function, count].into_iter().chain((0..count).map(|_| dice.byte())).collect()
}

fn transaction(dice: &mut Dice) -> (Vec<u8>, Vec<u8>) {
    let address = [dice.byte(), dice.byte()];
    let asked = |function: u8, quantity: u8| [&[function][..], &address, &[0, quantity]].concat();
    match dice.below(8) {
        0 => {
            let bytes = u8::try_from(1 + dice.below(4)).expect("at most four");
            let reply = [0x01, bytes].into_iter().chain((0..bytes).map(|_| dice.byte())).collect();
            (asked(0x01, 8 * bytes), reply)
        }
        1..=3 => {
            let reply = registers(dice, 0x03);
            (asked(0x03, reply[1] / 2), reply)
        }
        4 => {
            let reply = registers(dice, 0x04);
            (asked(0x04, reply[1] / 2), reply)
        }
        5 => {
            let coil = [&[0x05][..], &address, &[0xFF, 0x00]].concat();
            (coil.clone(), coil)
        }
        6 => {
            let values = registers(dice, 0x10);
            let request = [&asked(0x10, values[1] / 2), &values[1..]].concat();
            (request, asked(0x10, values[1] / 2))
        }
        _ => (asked(0x04, 1), vec![0x84, 0x02]),
    }
}

/// Numbers that look random (xorshift).
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from((self.0 >> 32) % limit as u64).expect("below the limit")
    }

    fn byte(&mut self) -> u8 {
        u8::try_from(self.below(256)).expect("below 256")
    }
}
