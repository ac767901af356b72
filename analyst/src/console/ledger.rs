//! What is remembered of every write that has left, whoever wanted it: the audit log, and how often each device was
//! written. And the snapshots, which are kept in the same place.

use buslens_bus::record::{Origin, Outcome};
use buslens_codec::line::{LineSettings, Mode};
use buslens_codec::pdu::Request;
use buslens_codec::{UnitId, ascii, rtu};
use buslens_configure::{AuditEntry, Reach};

use super::outbox::Outbox;
use crate::audit;
use crate::configure::{
    AuditFilter, AuditForm, AuditPage, AuditRow, DeviceKey, FromConfigure, FromStore, ToConfigure, ToStore, has_left,
};
use crate::line::{LineState, ToLine};
use crate::message::FromConsole;

/// The audit log as far as it has been asked for, and the writes that have not ended.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    /// The device that is connected.
    connected: Option<DeviceKey>,
    /// The device that is being configured, as it was reached when that began: its writes are its own, whatever unit id it
    /// gets meanwhile.
    configured: Option<DeviceKey>,
    under_way: Vec<Write>,
    /// The audit log, the oldest first, once somebody has wanted to see it.
    rows: Option<Vec<AuditRow>>,
    asked_for_rows: bool,
    /// What of it is looked at.
    looked_at: Option<(AuditFilter, u32, u32)>,
    /// Files that are wanted of it.
    wanted: Vec<(AuditFilter, AuditForm)>,
}

/// A write that is on its way.
#[derive(Debug)]
struct Write {
    /// The engine's number.
    id: u32,
    origin: Origin,
    reach: Reach,
    bytes: Vec<u8>,
    new: Vec<u16>,
    simulated: bool,
}

impl Ledger {
    /// Takes a wish of the window, if it is one of these; else gives it back.
    pub(super) fn hear(&mut self, wish: ToConfigure, out: &mut Outbox) -> Option<ToConfigure> {
        match wish {
            ToConfigure::Device(device) => self.connected = device,
            ToConfigure::Audit { filter, from, count } => {
                self.looked_at = Some((filter, from, count));
                self.want_rows(out);
            }
            ToConfigure::ExportAudit { filter, form } => {
                self.wanted.push((filter, form));
                self.want_rows(out);
            }
            ToConfigure::ClearAudit => {
                out.store(ToStore::ClearAudit);
                self.rows = self.rows.take().map(|_| Vec::new());
                self.tell_page(out);
            }
            ToConfigure::Snapshots => out.store(ToStore::Snapshots),
            ToConfigure::KeepSnapshot(number, snapshot) => out.store(ToStore::KeepSnapshot(number, snapshot)),
            ToConfigure::ForgetSnapshot(number) => out.store(ToStore::ForgetSnapshot(number)),
            other => return Some(other),
        }
        None
    }

    /// Takes what comes of keeping things, if it is one of these; else gives it back.
    pub(super) fn hear_store(&mut self, answer: FromStore, out: &mut Outbox) -> Option<FromStore> {
        match answer {
            FromStore::Counts(counts) => tell(FromConfigure::Writes(counts), out),
            FromStore::Snapshots(snapshots) => tell(FromConfigure::Snapshots(snapshots), out),
            FromStore::Audit(rows) => {
                for (filter, form) in std::mem::take(&mut self.wanted) {
                    tell(FromConfigure::AuditFile(form, audit::file(&rows, &filter, form)), out);
                }
                self.rows = Some(rows);
                self.tell_page(out);
            }
            other => return Some(other),
        }
        None
    }

    /// From now on this device is configured, or none. Whether it has got another unit id meanwhile is told by `found`.
    pub(super) fn configure(&mut self, device: Option<DeviceKey>, found: Option<UnitId>, out: &mut Outbox) {
        if let Some(before) = self.configured.take()
            && let Some(unit) = found.filter(|unit| unit.0 != before.unit)
        {
            let after = DeviceKey { unit: unit.0, ..before.clone() };
            out.store(ToStore::Move(before, after));
        }
        self.configured = device;
    }

    /// Takes note of what is handed to the engine.
    pub(super) fn note_order(&mut self, order: &ToLine, line: Option<&LineState>) {
        let (ToLine::Send { id, origin, bytes, .. }, Some(state)) = (order, line) else { return };
        if let Some((unit, new)) = written(state.mode, bytes) {
            let reach = Reach { unit, line: state.line, mode: state.mode };
            let simulated = state.simulated;
            self.under_way.push(Write { id: *id, origin: *origin, reach, bytes: bytes.clone(), new, simulated });
        }
    }

    /// Something with this number of the engine's has ended.
    pub(super) fn done(&mut self, unix_ms: u64, id: u32, outcome: &Outcome, out: &mut Outbox) {
        let Some(place) = self.under_way.iter().position(|write| write.id == id) else { return };
        let Write { origin, reach, bytes, new, simulated, .. } = self.under_way.remove(place);
        if !has_left(outcome.end) {
            return;
        }
        let device = self.written_device(origin, reach.unit, simulated);
        out.store(ToStore::Count(vec![(device.clone(), 1)]));
        // Who configures knows better what it was, and tells.
        if origin != Origin::Configuration {
            let (received, end) = (outcome.heard.clone(), outcome.end);
            let (profile, point, old) = (device.profile, String::new(), None);
            let entry = AuditEntry { unix_ms, profile, reach, point, old, new, sent: bytes, received, end };
            self.append(AuditRow { simulated, origin, entry }, out);
        }
    }

    /// Keeps a row.
    pub(super) fn append(&mut self, row: AuditRow, out: &mut Outbox) {
        out.store(ToStore::Append(Box::new(row.clone())));
        if let Some(rows) = &mut self.rows {
            rows.push(row);
            self.tell_page(out);
        }
    }

    /// Whose write it is.
    fn written_device(&self, origin: Origin, unit: UnitId, simulated: bool) -> DeviceKey {
        if let Some(device) = self.configured.as_ref().filter(|_| origin == Origin::Configuration) {
            return device.clone();
        }
        // What is for everybody is at least for the device that is connected.
        let connected = self.connected.as_ref().filter(|key| unit.0 == key.unit || unit == UnitId::BROADCAST);
        let unknown = DeviceKey { profile: String::new(), unit: unit.0, simulated };
        connected.map_or(unknown, |key| DeviceKey { simulated, ..key.clone() })
    }

    fn want_rows(&mut self, out: &mut Outbox) {
        if !self.asked_for_rows {
            self.asked_for_rows = true;
            out.store(ToStore::Audit);
            return;
        }
        if let Some(rows) = self.rows.take() {
            // As if they had just been read.
            self.hear_store(FromStore::Audit(rows), out);
        }
    }

    fn tell_page(&self, out: &mut Outbox) {
        let (Some(rows), Some((filter, from, count))) = (&self.rows, &self.looked_at) else { return };
        let fitting = || rows.iter().rev().filter(|row| filter.lets(row));
        let place = |number: u32| usize::try_from(number).unwrap_or(usize::MAX);
        let page = AuditPage {
            filter: filter.clone(),
            total: u32::try_from(fitting().count()).unwrap_or(u32::MAX),
            from: *from,
            rows: fitting().skip(place(*from)).take(place(*count)).cloned().collect(),
        };
        tell(FromConfigure::Audit(page), out);
    }
}

pub(super) fn tell(news: FromConfigure, out: &mut Outbox) {
    out.tell(FromConsole::Configure(news));
}

/// Settings of a line that nobody knows.
pub(super) const UNKNOWN_LINE: LineSettings = LineSettings::new(9600, buslens_codec::line::Parity::None);

/// To whom these bytes write, and what, if they are one whole frame that writes coils or registers: functions 05, 06, 0F,
/// 10, 16 and 17.
fn written(mode: Mode, bytes: &[u8]) -> Option<(UnitId, Vec<u16>)> {
    let (unit, pdu) = match mode {
        Mode::Rtu => rtu::decode(bytes).ok().map(|adu| (adu.unit, adu.pdu.to_vec()))?,
        Mode::Ascii => ascii::decode(bytes).ok().map(|adu| (adu.unit, adu.pdu))?,
    };
    let coil = |on: &bool| if *on { 0xFF00 } else { 0 };
    let new = match Request::decode(&pdu) {
        Ok(Request::WriteSingleCoil { on, .. }) => vec![coil(&on)],
        Ok(Request::WriteSingleRegister { value, .. }) => vec![value],
        Ok(Request::WriteMultipleCoils { coils, .. }) => coils.iter().map(coil).collect(),
        Ok(Request::WriteMultipleRegisters { values, .. }) => values,
        // Bytes that a device should refuse may still be written.
        _ if matches!(pdu.first(), Some(0x05 | 0x06 | 0x0F | 0x10 | 0x16 | 0x17)) => Vec::new(),
        _ => return None,
    };
    Some((unit, new))
}
