//! Those who take streams apart, each as its user would write it.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use buslens_codec::line::Mode;
use buslens_codec::outline::Outline;
use buslens_codec::stream::{PieceKind, split};
use crc::{CRC_16_MODBUS, Crc};
use rmodbus::client::ModbusRequest;
use rmodbus::server::ModbusFrame;
use rmodbus::{ModbusProto, guess_request_frame_len, guess_response_frame_len};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio_modbus::client::{Reader, rtu};
use tokio_modbus::slave::Slave;

use crate::streams::{Kind, Stream};

/// What was found: the compiler must not leave the work out, and all must have done the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Frames with a right check.
    pub frames: usize,
    /// The sum of the registers in them.
    pub sum: u64,
}

/// One who takes streams apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contender {
    /// Splits, decodes each frame and adds its registers.
    Buslens,
    /// The same with `rmodbus`: the expected length, then the client's or the server's parser.
    Rmodbus,
    /// Reads each reply with `tokio-modbus`' RTU client. Its codec is private, so requests are made as well, and each reply
    /// comes alone from a transport in memory.
    TokioModbus,
    /// Goes from length byte to length byte and checks with the `crc` crate's default table; decodes nothing.
    BareLoop,
}

impl Contender {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Buslens, Self::Rmodbus, Self::TokioModbus, Self::BareLoop];

    /// Its name in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Buslens => "buslens",
            Self::Rmodbus => "rmodbus",
            Self::TokioModbus => "tokio-modbus",
            Self::BareLoop => "bare loop",
        }
    }

    /// Takes `stream` apart; `None` if that is beyond it.
    pub fn run(self, stream: &Stream) -> Option<Tally> {
        match (self, stream.kind) {
            (Self::Buslens, _) => Some(buslens(&stream.bytes)),
            (Self::Rmodbus, Kind::Mixed) => Some(rmodbus_mixed(&stream.bytes)),
            (Self::Rmodbus, _) => Some(rmodbus_replies(&stream.bytes)),
            (Self::TokioModbus, Kind::Clean) => Some(tokio_modbus(&stream.bytes)),
            (Self::BareLoop, Kind::Clean | Kind::Noisy) => Some(bare_loop(&stream.bytes)),
            _ => None,
        }
    }
}

fn buslens(bytes: &[u8]) -> Tally {
    let mut tally = Tally::default();
    for piece in split(Mode::Rtu, bytes) {
        let PieceKind::Frame(shape) = piece.kind else { continue };
        if let Some(frame) = Outline::of_rtu(&bytes[piece.range], shape) {
            tally.frames += 1;
            tally.sum += frame.registers().map(u64::from).sum::<u64>();
        }
    }
    tally
}

/// Whatever does not parse is skipped by one byte.
fn rmodbus_replies(bytes: &[u8]) -> Tally {
    let mut tally = Tally::default();
    let request = asking(0x03);
    let mut registers = Vec::<u16>::new();
    let mut at = 0;
    while at < bytes.len() {
        let len = guess_response_frame_len(&bytes[at..], ModbusProto::Rtu).map_or(0, usize::from);
        let frame = bytes.get(at..at + len).filter(|frame| !frame.is_empty());
        registers.clear();
        if frame.is_some_and(|frame| request.parse_u16(frame, &mut registers).is_ok()) {
            tally.frames += 1;
            tally.sum += registers.iter().copied().map(u64::from).sum::<u64>();
            at += len;
        } else {
            at += 1;
        }
    }
    tally
}

/// It is told that requests and replies take turns. A write's values are read from the request's bytes: its server hands
/// them only to a register store.
fn rmodbus_mixed(bytes: &[u8]) -> Tally {
    let mut tally = Tally::default();
    let asked: Vec<Option<ModbusRequest>> =
        (0..=0x10).map(|function| KNOWN.contains(&function).then(|| asking(function))).collect();
    let (mut registers, mut bits, mut answer) = (Vec::<u16>::new(), Vec::<bool>::new(), Vec::<u8>::new());
    let mut at = 0;
    while let Ok(len) = guess_request_frame_len(&bytes[at..], ModbusProto::Rtu) {
        let frame = &bytes[at..at + usize::from(len)];
        let mut request = ModbusFrame::new(1, frame, ModbusProto::Rtu, &mut answer);
        if request.parse().is_err() {
            break;
        }
        tally.frames += 1;
        if frame[1] == 0x10 {
            tally.sum += words(&frame[7..frame.len() - 2]);
        }
        at += frame.len();
        let Some(request) = &asked[usize::from(frame[1])] else { break };
        let Ok(len) = guess_response_frame_len(&bytes[at..], ModbusProto::Rtu) else { break };
        let reply = &bytes[at..at + usize::from(len)];
        registers.clear();
        bits.clear();
        // A refusal is an error here.
        let _ = match reply[1] {
            0x01 => request.parse_bool(reply, &mut bits),
            0x03 | 0x04 => request.parse_u16(reply, &mut registers),
            _ => request.parse_ok(reply),
        };
        tally.frames += 1;
        tally.sum += registers.iter().copied().map(u64::from).sum::<u64>();
        at += reply.len();
    }
    tally
}

const KNOWN: [u8; 5] = [0x01, 0x03, 0x04, 0x05, 0x10];

/// A request whose replies are to be read: as many values as they carry, up to the quantity.
fn asking(function: u8) -> ModbusRequest {
    let mut request = ModbusRequest::new(1, ModbusProto::Rtu);
    let mut bytes = Vec::<u8>::new();
    match function {
        0x01 => request.generate_get_coils(0, 2000, &mut bytes),
        0x04 => request.generate_get_inputs(0, 125, &mut bytes),
        0x05 => request.generate_set_coil(0, true, &mut bytes),
        0x10 => request.generate_set_holdings_bulk(0, &[0], &mut bytes),
        _ => request.generate_get_holdings(0, 125, &mut bytes),
    }
    .expect("a quantity within the limits");
    request
}

fn words(bytes: &[u8]) -> u64 {
    bytes.as_chunks::<2>().0.iter().map(|word| u64::from(u16::from_be_bytes(*word))).sum()
}

fn bare_loop(bytes: &[u8]) -> Tally {
    const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_MODBUS);
    let mut tally = Tally::default();
    let mut at = 0;
    while at + 5 <= bytes.len() {
        let len = usize::from(bytes[at + 2]) + 5;
        match bytes.get(at..at + len) {
            Some([body @ .., low, high]) if CRC.checksum(body) == u16::from_le_bytes([*low, *high]) => {
                tally.frames += 1;
                at += len;
            }
            _ => at += 1,
        }
    }
    tally
}

fn tokio_modbus(bytes: &[u8]) -> Tally {
    let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime of one thread");
    let bytes: Arc<[u8]> = bytes.into();
    let replay = Replay { bytes: bytes.clone(), at: 0, end: 0 };
    runtime.block_on(async {
        let mut tally = Tally::default();
        let mut client = rtu::attach_slave(replay, Slave(1));
        let mut at = 0;
        while at < bytes.len() {
            let count = bytes[at + 2];
            let Ok(Ok(registers)) = client.read_holding_registers(0, u16::from(count) / 2).await else { break };
            tally.frames += 1;
            tally.sum += registers.into_iter().map(u64::from).sum::<u64>();
            at += usize::from(count) + 5;
        }
        tally
    })
}

/// Swallows requests and gives the next reply for each read.
struct Replay {
    bytes: Arc<[u8]>,
    at: usize,
    /// The end of the reply that is being read.
    end: usize,
}

impl AsyncRead for Replay {
    fn poll_read(mut self: Pin<&mut Self>, _: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        if self.at == self.end {
            let Some(count) = self.bytes.get(self.at + 2) else { return Poll::Ready(Ok(())) };
            self.end += usize::from(*count) + 5;
        }
        let end = self.end.min(self.at + into.remaining());
        into.put_slice(&self.bytes[self.at..end]);
        self.at = end;
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for Replay {
    fn poll_write(self: Pin<&mut Self>, _: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        Poll::Ready(Ok(bytes.len()))
    }

    fn poll_flush(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }
}
