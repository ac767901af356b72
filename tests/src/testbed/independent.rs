//! A Modbus server that this project did not write, at the far end of the wire: tokio-modbus' RTU server on a pty of its
//! own, with the line's pace in between.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::future::{Ready, ready};
use std::io::{Read, Write};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use buslens_bus::time::Instant;
use buslens_codec::line::{LineSettings, Parity};
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use tokio_modbus::prelude::{ExceptionCode, Request, Response, SlaveRequest};
use tokio_modbus::server::{Service, rtu::Server};
use tokio_serial::SerialStream;

use super::pty::Pty;
use super::wire::{FarEnd, Wire};

/// What the server serves at one unit id.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Registers {
    /// Its unit id.
    pub unit: u8,
    /// Coils by address.
    pub coils: BTreeMap<u16, bool>,
    /// Discrete inputs by address.
    pub discrete: BTreeMap<u16, bool>,
    /// Input registers by address.
    pub input: BTreeMap<u16, u16>,
    /// Holding registers by address.
    pub holding: BTreeMap<u16, u16>,
    /// Holding registers that take no value: a write is refused with exception 03.
    pub locked: BTreeSet<u16>,
}

impl Registers {
    /// Puts values into the holding registers from an address on.
    #[must_use]
    pub fn hold(mut self, address: u16, values: &[u16]) -> Self {
        self.holding.extend((address..).zip(values.iter().copied()));
        self
    }

    /// The same with the input registers.
    #[must_use]
    pub fn input(mut self, address: u16, values: &[u16]) -> Self {
        self.input.extend((address..).zip(values.iter().copied()));
        self
    }
}

/// What a server holds, and what it was asked to write.
#[derive(Debug)]
struct Held {
    registers: Registers,
    /// Every write that it understood, carried out or refused, in the order of their coming.
    writes: Vec<Request<'static>>,
}

/// The server's side of what it holds; the other side is the test's.
struct Holder(Arc<Mutex<Held>>);

impl Service for Holder {
    type Request = SlaveRequest<'static>;
    type Response = Option<Response>;
    type Exception = ExceptionCode;
    type Future = Ready<Result<Option<Response>, ExceptionCode>>;

    fn call(&self, request: Self::Request) -> Self::Future {
        let mut held = lock(&self.0);
        if request.slave != held.registers.unit {
            return ready(Ok(None));
        }
        let request = request.request;
        ready(if is_write(&request) {
            held.writes.push(request.clone());
            held.registers.write(request)
        } else {
            held.registers.read(&request)
        })
    }
}

impl Registers {
    fn read(&self, request: &Request<'_>) -> Result<Option<Response>, ExceptionCode> {
        match *request {
            Request::ReadCoils(address, quantity) => {
                read(&self.coils, address, quantity).map(|values| Some(Response::ReadCoils(values)))
            }
            Request::ReadDiscreteInputs(address, quantity) => {
                read(&self.discrete, address, quantity).map(|values| Some(Response::ReadDiscreteInputs(values)))
            }
            Request::ReadInputRegisters(address, quantity) => {
                read(&self.input, address, quantity).map(|values| Some(Response::ReadInputRegisters(values)))
            }
            Request::ReadHoldingRegisters(address, quantity) => {
                read(&self.holding, address, quantity).map(|values| Some(Response::ReadHoldingRegisters(values)))
            }
            _ => Err(ExceptionCode::IllegalFunction),
        }
    }

    fn write(&mut self, request: Request<'static>) -> Result<Option<Response>, ExceptionCode> {
        let quantity = |count: usize| u16::try_from(count).map_err(|_| ExceptionCode::IllegalDataValue);
        match request {
            Request::WriteSingleCoil(address, on) => {
                write(&mut self.coils, &BTreeSet::new(), address, &[on])?;
                Ok(Some(Response::WriteSingleCoil(address, on)))
            }
            Request::WriteMultipleCoils(address, values) => {
                write(&mut self.coils, &BTreeSet::new(), address, &values)?;
                Ok(Some(Response::WriteMultipleCoils(address, quantity(values.len())?)))
            }
            Request::WriteSingleRegister(address, value) => {
                write(&mut self.holding, &self.locked, address, &[value])?;
                Ok(Some(Response::WriteSingleRegister(address, value)))
            }
            Request::WriteMultipleRegisters(address, values) => {
                write(&mut self.holding, &self.locked, address, &values)?;
                Ok(Some(Response::WriteMultipleRegisters(address, quantity(values.len())?)))
            }
            _ => Err(ExceptionCode::IllegalFunction),
        }
    }
}

fn is_write(request: &Request<'_>) -> bool {
    matches!(
        request,
        Request::WriteSingleCoil(..)
            | Request::WriteMultipleCoils(..)
            | Request::WriteSingleRegister(..)
            | Request::WriteMultipleRegisters(..)
    )
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Neighbouring entries of a table, all of which must be there.
fn read<T: Copy>(table: &BTreeMap<u16, T>, address: u16, quantity: u16) -> Result<Vec<T>, ExceptionCode> {
    let values = (0..quantity).map(|offset| table.get(&address.checked_add(offset)?).copied());
    values.collect::<Option<Vec<T>>>().ok_or(ExceptionCode::IllegalDataAddress)
}

/// Writes neighbouring entries of a table, all of which must be there, or none.
fn write<T: Copy>(
    table: &mut BTreeMap<u16, T>,
    locked: &BTreeSet<u16>,
    address: u16,
    values: &[T],
) -> Result<(), ExceptionCode> {
    let places = (0..values.len()).map(|offset| address.checked_add(u16::try_from(offset).ok()?));
    let places = places.collect::<Option<Vec<u16>>>().filter(|all| all.iter().all(|place| table.contains_key(place)));
    let places = places.ok_or(ExceptionCode::IllegalDataAddress)?;
    if places.iter().any(|place| locked.contains(place)) {
        return Err(ExceptionCode::IllegalDataValue);
    }
    table.extend(places.into_iter().zip(values.iter().copied()));
    Ok(())
}

/// Carries bytes to and from the server, each character in its time. The server's line is 9600 8N1.
pub struct Relay {
    server: Pty,
    from_server: Arc<Mutex<Vec<u8>>>,
    held: Arc<Mutex<Held>>,
    host: LineSettings,
    to_server: VecDeque<(Instant, u8)>,
    to_host: VecDeque<(Instant, u8)>,
    due: Vec<u8>,
}

/// The settings at which the relay understands the browser.
const LINE: LineSettings = LineSettings::new(9600, Parity::None);

impl Relay {
    /// A server with these registers, and the wire to it. Must be called within a tokio runtime, which the server runs on.
    pub fn serve(registers: Registers) -> Wire<Self> {
        let server = Pty::open();
        let serial = SerialStream::open(&tokio_serial::new(server.device().to_string_lossy(), LINE.baud));
        let held = Arc::new(Mutex::new(Held { registers, writes: Vec::new() }));
        let service = Holder(Arc::clone(&held));
        tokio::spawn(Server::new(serial.expect("a pty opens as a serial port")).serve_forever(service));
        let from_server = Arc::new(Mutex::new(Vec::new()));
        let reader = server.master.try_clone().expect("a file");
        let wire = Wire::new(Self {
            server,
            from_server: Arc::clone(&from_server),
            held,
            host: LINE,
            to_server: VecDeque::new(),
            to_host: VecDeque::new(),
            due: Vec::new(),
        });
        let waker = wire.waker();
        thread::spawn(move || listen(&reader, &from_server, &waker));
        wire
    }

    /// What the server holds now.
    pub fn registers(&self) -> Registers {
        lock(&self.held).registers.clone()
    }

    /// Every write that the server has understood, carried out or refused, in the order of their coming.
    pub fn writes(&self) -> Vec<Request<'static>> {
        lock(&self.held).writes.clone()
    }
}

/// Hands on what the server says until the wire is gone.
fn listen(mut server: &std::fs::File, said: &Mutex<Vec<u8>>, waker: &UnixStream) {
    let mut buffer = [0; 512];
    loop {
        let mut ready = [PollFd::new(server.as_fd(), PollFlags::POLLIN)];
        if poll(&mut ready, PollTimeout::NONE).is_err() {
            return;
        }
        let Ok(count @ 1..) = server.read(&mut buffer) else { return };
        lock(said).extend_from_slice(&buffer[..count]);
        if let Err(error) = (&*waker).write(&[0])
            && error.kind() != std::io::ErrorKind::WouldBlock
        {
            return;
        }
    }
}

impl FarEnd for Relay {
    fn handle_settings(&mut self, _: Instant, settings: LineSettings) {
        self.host = settings;
    }

    fn handle_bytes(&mut self, now: Instant, bytes: &[u8]) {
        if self.host == LINE {
            pace(&mut self.to_server, now, bytes);
        }
    }

    fn handle_timeout(&mut self, now: Instant) {
        let said = std::mem::take(&mut *lock(&self.from_server));
        pace(&mut self.to_host, now, &said);
        self.due.extend(take_due(&mut self.to_host, now));
        // The server lives as long as the test's runtime.
        let _ = self.server.master.write_all(&take_due(&mut self.to_server, now));
    }

    fn poll_timeout(&self) -> Option<Instant> {
        [self.to_server.front(), self.to_host.front()].into_iter().flatten().map(|(at, _)| *at).min()
    }

    fn poll_transmit(&mut self) -> Option<Vec<u8>> {
        if self.due.is_empty() { None } else { Some(std::mem::take(&mut self.due)) }
    }
}

/// Queues bytes to arrive one character after the other.
fn pace(queue: &mut VecDeque<(Instant, u8)>, now: Instant, bytes: &[u8]) {
    let character: Duration = LINE.character_time(1);
    for byte in bytes {
        let start = queue.back().map_or(now, |(last, _)| (*last).max(now));
        queue.push_back((start + character, *byte));
    }
}

fn take_due(queue: &mut VecDeque<(Instant, u8)>, now: Instant) -> Vec<u8> {
    std::iter::from_fn(|| queue.pop_front_if(|(at, _)| *at <= now).map(|(_, byte)| byte)).collect()
}
