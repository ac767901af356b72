//! A device asked by the master: what its registers hold, and how it takes what it is told.

use std::time::Duration;

use buslens_bus::sim::Device;
use buslens_bus::{Answer, Failure};
use buslens_codec::pdu::{ExceptionCode, Request, Response};
use buslens_codec::profile::{BUILT_IN, Group, Known, Profile};

use super::Bench;

pub const fn read(address: u16, quantity: u16) -> Request {
    Request::ReadHoldingRegisters { address, quantity }
}

pub const fn write(address: u16, value: u16) -> Request {
    Request::WriteSingleRegister { address, value }
}

pub fn built_in(id: &str) -> Profile {
    BUILT_IN.iter().map(|text| Profile::from_json(text).unwrap()).find(|profile| profile.id == id).unwrap()
}

/// Id, value and unit of every point that these reads bring.
pub fn shown<D: Device>(bench: &mut Bench<D>, profile: &Profile, groups: &[Group]) -> Vec<String> {
    let (mut known, mut all) = (Known::default(), Vec::new());
    for group in groups {
        let exchange = bench.ask(profile.unit, group.request().unwrap());
        let Ok(Answer::Reply(Response::ReadHoldingRegisters { values } | Response::ReadInputRegisters { values })) =
            exchange.result
        else {
            panic!("{group:?}: {exchange:?}");
        };
        for found in profile.decode_points(group.function, group.address, &values, &mut known) {
            assert!(found.scaled);
            let text = found.point.text(found.value.unwrap(), |texts| &texts.en);
            all.push([&found.point.id, " ", &text, " ", found.unit].concat().trim_end().to_owned());
        }
    }
    all
}

pub fn registers<D: Device>(bench: &mut Bench<D>, unit: u8, request: Request) -> Vec<u16> {
    match bench.ask(unit, request).result {
        Ok(Answer::Reply(Response::ReadHoldingRegisters { values } | Response::ReadInputRegisters { values })) => {
            values
        }
        other => panic!("{other:?}"),
    }
}

pub fn is_echoed<D: Device>(bench: &mut Bench<D>, unit: u8, request: Request) -> bool {
    let exchange = bench.ask(unit, request);
    // Before a read the master does not know whether the adapter echoes; here it does not.
    matches!(exchange.result, Ok(_) | Err(Failure::Unproven)) && exchange.sent == exchange.received
}

pub fn is_silent<D: Device>(bench: &mut Bench<D>, unit: u8, request: Request) -> bool {
    let exchange = bench.ask(unit, request);
    // A late answer would be one to the next question.
    bench.run(Duration::from_secs(5));
    matches!(exchange.result, Err(Failure::NoAnswer { .. }))
}

#[track_caller]
pub fn assert_refused<D: Device>(bench: &mut Bench<D>, refused: impl IntoIterator<Item = (Request, ExceptionCode)>) {
    for (request, code) in refused {
        let exchange = bench.ask(1, request.clone());
        assert_eq!(exchange.result, Err(Failure::Exception { function: request.function(), code }), "{request:?}");
        assert_eq!(exchange.received.len(), 5);
    }
}
