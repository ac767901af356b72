//! Why a device refuses: by its profile where that tells, else what the exception usually means.

use buslens_codec::pdu::Request;
use buslens_codec::profile::{Known, Point, Profile};

use super::{Case, sentences};
use crate::anatomy::{address_text, allowed, function_name, place_name, push_bracketed};
use crate::device::{pick, value_text};
use crate::format::hex;
use crate::text::Language;

/// The sentences that explain an exception code.
pub(super) fn why(t: Language, case: &Case<'_>, code: u8) -> String {
    let Some(found) = case.dissection else { return usual(t, code).to_owned() };
    let function = found.function;
    let asked = Asked {
        t,
        function,
        address: found.address,
        quantity: found.quantity.unwrap_or(1),
        request: case.request.filter(|request| request.function() == function),
    };
    let refused = t.refused_function(&hex(function), function_name(t, function));
    let told = case.profile.and_then(|profile| asked.told_by(profile, code));
    sentences(t, &[if code == 5 { "" } else { &refused }, told.as_deref().unwrap_or(usual(t, code))])
}

/// What an exception code usually means.
fn usual(t: Language, code: u8) -> &'static str {
    match code {
        1 => t.refused_1(),
        2 => t.refused_2(),
        3 => t.refused_3(),
        4 => t.refused_4(),
        5 => t.refused_5(),
        6 => t.refused_6(),
        8 => t.refused_8(),
        10 => t.refused_10(),
        11 => t.refused_11(),
        _ => t.refused_other(),
    }
}

/// What was asked for and refused.
#[derive(Clone, Copy)]
struct Asked<'a> {
    t: Language,
    function: u8,
    address: Option<u16>,
    quantity: u16,
    request: Option<&'a Request>,
}

impl Asked<'_> {
    fn told_by(self, profile: &Profile, code: u8) -> Option<String> {
        match code {
            1 => self.wrong_function(profile).or_else(|| self.unused_function(profile)),
            2 => self.wrong_function(profile).or_else(|| self.wrong_address(profile)),
            3 => self.wrong_value(profile).or_else(|| self.wrong_address(profile)),
            _ => None,
        }
    }

    fn writes(self) -> bool {
        matches!(self.function, 0x05 | 0x06 | 0x0F | 0x10 | 0x16)
    }

    fn reads(self) -> bool {
        matches!(self.function, 0x01..=0x04)
    }

    /// The functions of a point that do what was asked.
    fn functions_of(self, point: &Point) -> &[u8] {
        if self.writes() { &point.write } else { &point.read }
    }

    /// The points of which something was asked, whatever functions they have.
    fn touched(self, profile: &Profile) -> impl Iterator<Item = &Point> {
        let first = self.address.map(usize::from);
        let end = first.map(|first| first + usize::from(self.quantity));
        profile.points.iter().filter(move |point| {
            let at = usize::from(point.register);
            end.is_some_and(|end| at < end) && first.is_some_and(|first| first < at + point.encoding.registers())
        })
    }

    /// Something is there, but another function reads or writes it.
    fn wrong_function(self, profile: &Profile) -> Option<String> {
        let t = self.t;
        if !self.writes() && !self.reads()
            || self.touched(profile).any(|point| self.functions_of(point).contains(&self.function))
        {
            return None;
        }
        let able = self.touched(profile).find(|point| !self.functions_of(point).is_empty());
        let Some(point) = able else {
            let name = pick(t, &self.touched(profile).next()?.name);
            return Some(if self.writes() { t.only_read(name) } else { t.only_written(name) });
        };
        let (name, function) = (pick(t, &point.name), hex(self.function));
        let functions = named_functions(t, self.functions_of(point));
        Some(if self.writes() {
            t.written_with(name, &functions, &function)
        } else {
            t.read_with(name, &functions, &function)
        })
    }

    /// No point has this function.
    fn unused_function(self, profile: &Profile) -> Option<String> {
        let mut used: Vec<u8> = Vec::new();
        for function in profile.points.iter().flat_map(|point| point.read.iter().chain(&point.write)) {
            if !used.contains(function) {
                used.push(*function);
            }
        }
        used.sort_unstable();
        (!used.contains(&self.function)).then(|| self.t.only_functions(&listed(self.t, &used)))
    }

    /// Half of a value, a gap, or more than the device gives at once.
    fn wrong_address(self, profile: &Profile) -> Option<String> {
        let (t, first) = (self.t, self.address?);
        if !self.writes() && !self.reads() {
            return None;
        }
        let own = || self.touched(profile).filter(|point| self.functions_of(point).contains(&self.function));
        if let Some(point) = own().find(|point| point.offset_in(first, self.quantity.into()).is_none()) {
            let address = address_text(point.register);
            return Some(t.belongs_together(pick(t, &point.name), point.encoding.registers(), &address));
        }
        let is_known = |address: usize| {
            own().any(|point| {
                let at = usize::from(point.register);
                (at..at + point.encoding.registers()).contains(&address)
            })
        };
        let mut asked = usize::from(first)..usize::from(first) + usize::from(self.quantity);
        if let Some(gap) = asked.find(|address| !is_known(*address)) {
            let place = u16::try_from(gap).map(|gap| place_name(t, self.function, gap)).unwrap_or_default();
            return Some(if own().next().is_some() { t.goes_over_gap(&place) } else { t.nothing_there(&place) });
        }
        let promised = profile.groups.iter().any(|group| {
            !group.tentative && group.function == self.function && {
                let (start, end) =
                    (usize::from(group.address), usize::from(group.address) + usize::from(group.quantity));
                start <= usize::from(first) && usize::from(first) + usize::from(self.quantity) <= end
            }
        });
        if promised || self.writes() || own().count() < 2 {
            return None;
        }
        let names: Vec<&str> = own().map(|point| pick(t, &point.name)).collect();
        Some(t.not_in_one_read(&names.join(t.list_of_names())))
    }

    /// A value that its point does not take.
    fn wrong_value(self, profile: &Profile) -> Option<String> {
        let t = self.t;
        let registers = match self.request? {
            Request::WriteSingleCoil { on, .. } => vec![if *on { 0xFF00 } else { 0 }],
            Request::WriteSingleRegister { value, .. } => vec![*value],
            Request::WriteMultipleRegisters { values, .. } => values.clone(),
            _ => return None,
        };
        let found = profile.decode_points(self.function, self.address?, &registers, &mut Known::default());
        let wrong = found.into_iter().find(|found| match found.value {
            Ok(value) => found.scaled && !found.point.allows(value),
            Err(_) => true,
        })?;
        let value = match wrong.value {
            Ok(value) => value_text(t, wrong.point, value),
            Err(_) => address_text(registers.get(wrong.offset).copied().unwrap_or_default()),
        };
        let allowed = allowed(t, wrong.point);
        let allowed = if allowed.is_empty() { String::new() } else { t.value_may_be(&allowed) };
        Some(sentences(t, &[&t.value_refused(pick(t, &wrong.point.name), &value), &allowed]))
    }
}

/// `03, 04, 10`.
fn listed(t: Language, functions: &[u8]) -> String {
    let functions: Vec<String> = functions.iter().map(|function| hex(*function)).collect();
    functions.join(t.list_of_names())
}

/// `10 (write multiple registers)`, or a bare list of several.
fn named_functions(t: Language, functions: &[u8]) -> String {
    let [function] = functions else { return listed(t, functions) };
    let mut text = hex(*function);
    push_bracketed(t, &mut text, function_name(t, *function));
    text
}
