//! What a run knows: the last exchange, what was read, variables.

use std::collections::BTreeMap;
use std::sync::Arc;

use buslens_bus::record::{End, Outcome};
use buslens_codec::line::Mode;
use buslens_codec::pdu::{Request, Response, unpack_bits};
use buslens_codec::profile::{Known, Point, Profile};
use buslens_codec::value::Decimal;
use buslens_codec::{UnitId, ascii, rtu};

use super::datum::{Datum, Seen};
use crate::report::{Compared, Heard, Reason};
use crate::script::{Condition, Expression, Operand, Piece};

#[derive(Debug, Default)]
pub(super) struct Memory {
    pub(super) profile: Option<Arc<Profile>>,
    /// What scales values, of each unit id.
    known: BTreeMap<u8, Known>,
    /// The last value of each point, by its place in the profile.
    seen: BTreeMap<usize, Seen>,
    variables: BTreeMap<String, Datum>,
    last: Option<Last>,
}

/// The last exchange.
#[derive(Debug)]
struct Last {
    unit: UnitId,
    request: Option<Request>,
    response: Option<Response>,
    heard: Vec<u8>,
    round_trip_us: Option<u32>,
    what: Heard,
}

impl Memory {
    pub(super) fn new(profile: Option<Arc<Profile>>) -> Self {
        Self { profile, ..Self::default() }
    }

    pub(super) fn known(&self, unit: UnitId) -> Known {
        self.known.get(&unit.0).cloned().unwrap_or_default()
    }

    pub(super) fn point(&self, id: &str) -> Option<&Point> {
        self.profile.as_ref()?.point(id)
    }

    /// Takes in what came of a request to `unit`, or of bytes that are none, and says in short what was heard.
    pub(super) fn take(&mut self, mode: Mode, unit: UnitId, request: Option<Request>, outcome: &Outcome) -> Heard {
        let response = match (outcome.end, &request) {
            (End::Answered, Some(request)) => pdu_in(mode, &outcome.heard)
                .and_then(|(_, pdu)| Response::decode(&pdu).ok())
                .filter(|response| request.accepts(response)),
            _ => None,
        };
        let what = match (outcome.end, &response) {
            (_, Some(Response::Exception { code, .. })) => Heard::Exception(code.code()),
            (End::Answered, _) => Heard::Reply,
            (End::Broadcast, _) => Heard::Broadcast,
            (End::Damaged, _) => Heard::Damaged,
            (End::Doubtful, _) => Heard::Doubtful,
            (_, _) if outcome.heard.is_empty() => Heard::Silence,
            _ => Heard::Bytes,
        };
        if let (Some(profile), Some(request)) = (self.profile.clone(), &request) {
            self.learn(&profile, unit, request, response.as_ref());
        }
        self.last = Some(Last {
            unit,
            request,
            response,
            heard: outcome.heard.clone(),
            round_trip_us: outcome.round_trip_us,
            what,
        });
        what
    }

    /// Forgets what the request is about, and keeps what the reply says of it.
    fn learn(&mut self, profile: &Profile, unit: UnitId, request: &Request, response: Option<&Response>) {
        let function = request.function();
        let (Some(address), Some(quantity)) = (request.address(), request.quantity().or(Some(1))) else { return };
        let end = u32::from(address) + u32::from(quantity);
        for (at, point) in profile.points.iter().enumerate().filter(|(_, point)| point.uses(function)) {
            let first = u32::from(point.register);
            let last = first + u32::try_from(point.encoding.registers()).unwrap_or(1);
            if first < end && u32::from(address) < last {
                self.seen.remove(&at);
            }
        }
        let known = self.known.entry(unit.0).or_default();
        let found = match (request, response) {
            (
                Request::ReadHoldingRegisters { .. } | Request::ReadInputRegisters { .. },
                Some(Response::ReadHoldingRegisters { values } | Response::ReadInputRegisters { values }),
            ) => profile.decode_points(function, address, values, known),
            (
                Request::ReadCoils { .. } | Request::ReadDiscreteInputs { .. },
                Some(Response::ReadCoils { status } | Response::ReadDiscreteInputs { status }),
            ) => profile.decode_bits(function, address, &unpack_bits(status, quantity.into())),
            // What was written has to be read again.
            (Request::WriteSingleRegister { value, .. }, _) => {
                profile.decode_points(function, address, &[*value], known);
                return;
            }
            (Request::WriteMultipleRegisters { values, .. }, _) => {
                profile.decode_points(function, address, values, known);
                return;
            }
            _ => return,
        };
        for value in found {
            if let Some(at) = profile.points.iter().position(|point| point.id == value.point.id) {
                self.seen.insert(at, Seen::of(&value));
            }
        }
    }

    /// Registers of the last reply that a point lies in.
    pub(super) fn registers_of(&self, point: &Point) -> Option<Vec<u16>> {
        let last = self.last.as_ref()?;
        let offset = point.offset_in(last.request.as_ref()?.address()?, last.registers()?.len())?;
        last.registers()?.get(offset..offset + point.encoding.registers()).map(<[u16]>::to_vec)
    }

    pub(super) fn keep(&mut self, name: &str, datum: Datum) {
        self.variables.insert(name.to_owned(), datum.kept());
    }

    pub(super) fn evaluate(&self, expression: &Expression) -> Result<Datum, Reason> {
        let first = self.operand(&expression.first)?;
        expression.rest.iter().try_fold(first, |sum, (sign, operand)| sum.plus(*sign, &self.operand(operand)?))
    }

    fn operand(&self, operand: &Operand) -> Result<Datum, Reason> {
        match operand {
            Operand::Point(id) => self.seen_of(id),
            Operand::Variable(name) => self.variables.get(name).cloned().ok_or_else(|| Reason::NoValue(name.clone())),
            Operand::Register(address) => {
                let last = self.last.as_ref().ok_or(Reason::NothingSent)?;
                let register = last.at(*address).and_then(|offset| last.registers()?.get(offset).copied());
                let register = register.ok_or(Reason::NotInReply(*address))?;
                Ok(Datum::number(Decimal::whole(register.into()), "", false))
            }
            Operand::Coil(address) => {
                let last = self.last.as_ref().ok_or(Reason::NothingSent)?;
                let bit = last.at(*address).and_then(|offset| last.bits()?.get(offset).copied());
                bit.map(Datum::bit).ok_or(Reason::NotInReply(*address))
            }
            Operand::RoundTrip => {
                let last = self.last.as_ref().ok_or(Reason::NothingSent)?;
                let micros = last.round_trip_us.ok_or(Reason::NoRoundTrip)?;
                Ok(Datum::number(Decimal { mantissa: micros.into(), decimals: 3 }, "ms", false))
            }
            Operand::Number { number, unit } => Ok(Datum::number(*number, unit, true)),
            Operand::Name(name) => Ok(Datum::name(name)),
            Operand::Code(code) => Ok(Datum::code(*code)),
        }
    }

    fn seen_of(&self, id: &str) -> Result<Datum, Reason> {
        let at = self.profile.as_ref().and_then(|profile| profile.points.iter().position(|point| point.id == id));
        let seen = at.and_then(|at| self.seen.get(&at)).ok_or_else(|| Reason::NotRead(id.to_owned()))?;
        if !seen.scaled {
            return Err(Reason::NotScaled(id.to_owned()));
        }
        seen.datum.clone().ok_or_else(|| Reason::NotRead(id.to_owned()))
    }

    /// Whether a condition holds, with what was compared; if it does not, why.
    pub(super) fn judge(&self, condition: &Condition) -> (Result<(), Reason>, Option<Compared>) {
        match condition {
            Condition::Compare { left, how, right } => {
                let sides = self.evaluate(left).and_then(|left| Ok((left, self.evaluate(right)?)));
                let (left, right) = match sides {
                    Ok(sides) => sides,
                    Err(reason) => return (Err(reason), None),
                };
                let compared = Compared { found: left.to_string(), wanted: vec![right.to_string()] };
                (verdict(left.holds(*how, &right)), Some(compared))
            }
            Condition::Between { value, least, most } => {
                let sides =
                    self.evaluate(value).and_then(|value| Ok((value, self.evaluate(least)?, self.evaluate(most)?)));
                let (value, least, most) = match sides {
                    Ok(sides) => sides,
                    Err(reason) => return (Err(reason), None),
                };
                let compared = Compared { found: value.to_string(), wanted: vec![least.to_string(), most.to_string()] };
                let above = value.holds(crate::script::Comparison::GreaterOrEqual, &least);
                let below = value.holds(crate::script::Comparison::LessOrEqual, &most);
                (verdict(above.and_then(|above| Ok(above && below?))), Some(compared))
            }
            about => (self.judge_answer(about), None),
        }
    }

    fn judge_answer(&self, condition: &Condition) -> Result<(), Reason> {
        let last = self.last.as_ref().ok_or(Reason::NothingSent)?;
        let fits = match (condition, last.what) {
            (Condition::Heard(pattern), _) => {
                return if pattern.matches(&last.heard, Some(last.unit)) { Ok(()) } else { Err(Reason::DoesNotFit) };
            }
            (Condition::Exception(wanted), Heard::Exception(code)) => wanted.is_none_or(|wanted| wanted == code),
            (Condition::Reply, Heard::Reply)
            | (Condition::Silence, Heard::Silence | Heard::Broadcast)
            | (Condition::Damage, Heard::Damaged) => true,
            _ => false,
        };
        if fits { Ok(()) } else { Err(Reason::OtherwiseHeard(last.what)) }
    }

    /// A text for the report; what has no value is shown as a question mark.
    pub(super) fn fill(&self, pieces: &[Piece]) -> String {
        let one = |piece: &Piece| match piece {
            Piece::Text(text) => text.clone(),
            Piece::Value(value) => self.evaluate(value).map_or_else(|_| "?".to_owned(), |datum| datum.to_string()),
        };
        pieces.iter().map(one).collect()
    }
}

impl Last {
    fn at(&self, address: u16) -> Option<usize> {
        address.checked_sub(self.request.as_ref()?.address()?).map(usize::from)
    }

    fn registers(&self) -> Option<&[u16]> {
        match self.response.as_ref()? {
            Response::ReadHoldingRegisters { values } | Response::ReadInputRegisters { values } => Some(values),
            _ => None,
        }
    }

    fn bits(&self) -> Option<Vec<bool>> {
        match self.response.as_ref()? {
            Response::ReadCoils { status } | Response::ReadDiscreteInputs { status } => {
                Some(unpack_bits(status, self.request.as_ref()?.quantity()?.into()))
            }
            _ => None,
        }
    }
}

fn verdict(holds: Result<bool, Reason>) -> Result<(), Reason> {
    if holds? { Ok(()) } else { Err(Reason::DoesNotHold) }
}

/// The request that bytes are, whole and with a right check.
pub(super) fn request_in(mode: Mode, bytes: &[u8]) -> Option<(UnitId, Request)> {
    let (unit, pdu) = pdu_in(mode, bytes)?;
    Some((unit, Request::decode(&pdu).ok()?))
}

fn pdu_in(mode: Mode, bytes: &[u8]) -> Option<(UnitId, Vec<u8>)> {
    match mode {
        Mode::Rtu => rtu::decode(bytes).ok().map(|adu| (adu.unit, adu.pdu.to_vec())),
        Mode::Ascii => ascii::decode(bytes).ok().map(|adu| (adu.unit, adu.pdu)),
    }
}
