//! A device that is read, written or searched for. One at a time, and nobody else sends meanwhile.

use std::time::Duration;

use buslens_bus::record::{Origin, Outcome};
use buslens_bus::time::Instant;
use buslens_codec::UnitId;
use buslens_codec::line::Mode;
use buslens_configure::{Device, Journal, Line, Order, Port, Procedure, Reach, Task, Way};

use super::Console;
use super::ledger::{Ledger, UNKNOWN_LINE, tell};
use super::outbox::{News, Outbox};
use crate::configure::{AuditRow, DeviceKey, FromConfigure, FromStore, Hindrance, ToConfigure, ToStore};
use crate::line::{LineState, PortState, ToLine};

/// Nobody reads faster how far it is. Its end is told at once.
const NEWS_PERIOD: Duration = Duration::from_millis(60);

/// What is done to devices.
#[derive(Debug, Default)]
pub(super) struct Configuring {
    doing: Option<Doing>,
    /// A journal is fetched, to go on from it.
    fetching: Option<Fetching>,
    /// The device that was last worked with, as far as it is known.
    device: Option<Device>,
}

/// Something under way.
#[derive(Debug)]
struct Doing {
    run: u32,
    procedure: Procedure,
    /// The engine's number and the procedure's of what has not ended.
    asked: Vec<(u32, u32)>,
    buffer_bytes: u32,
    simulated: bool,
    /// It may give the device another unit id. A search only finds one.
    writes: bool,
    news: News,
}

#[derive(Debug)]
struct Fetching {
    run: u32,
    journal: u64,
    way: Way,
}

/// What a procedure is begun with.
pub(super) struct Wish {
    /// Names the answers.
    pub(super) run: u32,
    pub(super) task: Task,
    /// The device's profile, as the text of its file.
    pub(super) profile: String,
    pub(super) reach: Reach,
}

/// What is around a procedure.
pub(super) struct Around<'a> {
    pub(super) state: Option<&'a LineState>,
    /// The time of day, in milliseconds since the Unix epoch.
    pub(super) unix_ms: u64,
    pub(super) ledger: &'a mut Ledger,
    pub(super) out: &'a mut Outbox,
}

impl Console {
    /// Takes a wish of the window.
    pub(super) fn hear_configure(&mut self, now: Instant, wish: ToConfigure) {
        let Some(wish) = self.ledger.hear(wish, &mut self.out) else { return };
        let hindrance = if self.running.is_some() {
            Some(Hindrance::Sequence)
        } else {
            self.sends.repeats().then_some(Hindrance::Sending)
        };
        let (configuring, around) = self.around(now);
        match wish {
            ToConfigure::Begin { run, task, profile, reach } => {
                configuring.begin(now, Wish { run, task, profile, reach }, hindrance, around);
            }
            ToConfigure::Recover { run, journal, way } => {
                configuring.recover((run, journal, way), hindrance, around.state, around.out);
            }
            ToConfigure::Cancel => configuring.cancel(now, around.out),
            ToConfigure::Discard(journal) => around.out.store(ToStore::Discard(journal)),
            _ => {}
        }
        self.drain_configuring(now);
    }

    /// What is done to devices, and what is around it.
    pub(super) fn around(&mut self, now: Instant) -> (&mut Configuring, Around<'_>) {
        let unix_ms = self.unix_ms(now);
        let Self { configuring, ledger, out, line, .. } = self;
        (configuring, Around { state: line.as_ref(), unix_ms, ledger, out })
    }

    /// The time of day, in milliseconds since the Unix epoch.
    pub(super) fn unix_ms(&self, now: Instant) -> u64 {
        self.epoch_us.saturating_add(now.as_micros()) / 1000
    }

    pub(super) fn drain_configuring(&mut self, now: Instant) {
        self.configuring.drain(now, &mut self.ledger, &mut self.out);
    }
}

impl Configuring {
    /// Whether something is done to a device.
    pub(super) fn is_busy(&self) -> bool {
        self.doing.is_some() || self.fetching.is_some()
    }

    /// Begins. What is in the way for reasons of the console comes as `hindrance`.
    pub(super) fn begin(&mut self, now: Instant, wish: Wish, hindrance: Option<Hindrance>, mut around: Around<'_>) {
        let Wish { run, task, profile, reach } = wish;
        let writes = matches!(task, Task::Apply { .. } | Task::Recover { .. });
        let begun = match hindrance.or_else(|| self.hindrance(around.state, writes)) {
            Some(why) => Err(why),
            None => self.device(&profile, reach),
        };
        match begun {
            Ok(device) => self.start(now, run, task, device, reach.unit, &mut around),
            Err(why) => tell(FromConfigure::Refused { run, why }, around.out),
        }
    }

    /// Goes on from a journal, when it has been fetched.
    pub(super) fn recover(
        &mut self,
        (run, journal, way): (u32, u64, Way),
        hindrance: Option<Hindrance>,
        state: Option<&LineState>,
        out: &mut Outbox,
    ) {
        if let Some(why) = hindrance.or_else(|| self.hindrance(state, true)) {
            return tell(FromConfigure::Refused { run, why }, out);
        }
        self.fetching = Some(Fetching { run, journal, way });
        out.store(ToStore::Take(journal));
    }

    /// Takes what has come of keeping a journal.
    pub(super) fn hear_store(&mut self, now: Instant, answer: FromStore, around: Around<'_>) {
        match answer {
            FromStore::Journals(journals) => tell(FromConfigure::Open(journals), around.out),
            FromStore::Failed(fault) => tell(FromConfigure::Store(Some(fault)), around.out),
            FromStore::Kept(id, kept) => {
                if let Some(doing) = &mut self.doing {
                    match &kept {
                        Ok(()) => doing.procedure.kept(now, id),
                        Err(_) => doing.procedure.not_kept(now, id),
                    }
                    doing.news.change();
                }
                tell(FromConfigure::Store(kept.err()), around.out);
            }
            FromStore::Taken(id, taken) => match self.fetching.take_if(|fetching| fetching.journal == id) {
                Some(fetching) => self.go_on_from(now, &fetching, taken, around),
                // Cancelled meanwhile.
                None => around.out.store(ToStore::Release),
            },
            FromStore::Counts(_) | FromStore::Audit(_) | FromStore::Snapshots(_) => {}
        }
    }

    fn go_on_from(
        &mut self,
        now: Instant,
        fetching: &Fetching,
        taken: Result<Box<Journal>, Hindrance>,
        mut around: Around<'_>,
    ) {
        let Fetching { run, way, .. } = *fetching;
        let hindrance = self.hindrance(around.state, true);
        let begun = taken.and_then(|journal| hindrance.map_or(Ok(journal), Err)).and_then(|journal| {
            let device = journal.device().map_err(|error| Hindrance::Profile(error.into()))?;
            Ok((journal, device))
        });
        match begun {
            Ok((journal, device)) => {
                let unit = journal.reach.unit;
                self.start(now, run, Task::Recover { journal: *journal, way }, device, unit, &mut around);
            }
            Err(why) => {
                around.out.store(ToStore::Release);
                tell(FromConfigure::Refused { run, why }, around.out);
            }
        }
    }

    fn start(&mut self, now: Instant, run: u32, task: Task, device: Device, unit: UnitId, around: &mut Around<'_>) {
        let writes = matches!(task, Task::Apply { .. } | Task::Recover { .. });
        let simulated = around.state.is_some_and(|state| state.simulated);
        let key = DeviceKey { profile: device.profile.id.clone(), unit: unit.0, simulated };
        around.ledger.configure(Some(key), None, around.out);
        let procedure = Procedure::begin(now, around.unix_ms, task, device, line_of(around.state));
        let buffer_bytes = around.state.map_or(8192, |state| state.buffer_bytes);
        let mut news = News::every(NEWS_PERIOD);
        news.change();
        self.doing = Some(Doing { run, procedure, asked: Vec::new(), buffer_bytes, simulated, writes, news });
    }

    /// It shall stop.
    pub(super) fn cancel(&mut self, now: Instant, out: &mut Outbox) {
        if let Some(Fetching { run, .. }) = self.fetching.take() {
            tell(FromConfigure::Refused { run, why: Hindrance::Cancelled }, out);
        }
        if let Some(doing) = &mut self.doing {
            doing.procedure.cancel(now);
            doing.news.change();
        }
    }

    /// Something with this number of the engine's has ended; whether it was this one's.
    pub(super) fn done(&mut self, now: Instant, id: u32, outcome: &Outcome) -> bool {
        let Some(doing) = &mut self.doing else { return false };
        let Some(place) = doing.asked.iter().position(|(asked, _)| *asked == id) else { return false };
        let (_, id) = doing.asked.remove(place);
        doing.procedure.done(now, id, outcome);
        doing.news.change();
        true
    }

    pub(super) fn hear_state(&mut self, now: Instant, state: &LineState) {
        if let Some(doing) = &mut self.doing {
            doing.buffer_bytes = state.buffer_bytes;
            doing.procedure.state(now, line_of(Some(state)));
            doing.news.change();
        }
    }

    pub(super) fn handle_time(&mut self, now: Instant) {
        if let Some(doing) = &mut self.doing
            && doing.procedure.poll_timeout().is_some_and(|due| due <= now)
        {
            doing.procedure.timeout(now);
            doing.news.change();
        }
    }

    /// Hands on what is wanted, and tells how far it is. Due after everything above.
    pub(super) fn drain(&mut self, now: Instant, ledger: &mut Ledger, out: &mut Outbox) {
        let Some(doing) = &mut self.doing else { return };
        while let Some(order) = doing.procedure.poll_order() {
            doing.obey(order, ledger, out);
        }
        let run = doing.run;
        let report = doing.procedure.report().cloned();
        if (doing.news.take(now) || report.is_some())
            && let Some(progress) = doing.procedure.poll_progress()
        {
            tell(FromConfigure::Progress { run, progress }, out);
        }
        if let Some(report) = report {
            let found = report.reach.filter(|_| doing.writes);
            ledger.configure(None, found.map(|reach| reach.unit), out);
            out.store(ToStore::Release);
            tell(FromConfigure::Report { run, report: Box::new(report) }, out);
            self.device = self.doing.take().map(|doing| doing.procedure.device());
        }
    }

    /// When [`Self::handle_time`] and [`Self::drain`] have something to do next.
    pub(super) fn due(&self) -> Option<Instant> {
        let doing = self.doing.as_ref()?;
        [doing.procedure.poll_timeout(), doing.news.due()].into_iter().flatten().min()
    }

    /// What is in the way.
    fn hindrance(&self, state: Option<&LineState>, writes: bool) -> Option<Hindrance> {
        match state {
            _ if self.is_busy() => Some(Hindrance::Busy),
            Some(state) if state.replay => Some(Hindrance::Replay),
            Some(state) if state.port == PortState::Gone => Some(Hindrance::NoPort),
            Some(state) if writes && state.read_only => Some(Hindrance::ReadOnly),
            Some(_) => None,
            None => Some(Hindrance::NoPort),
        }
    }

    /// The device that is meant, with what is known of it.
    fn device(&self, profile: &str, reach: Reach) -> Result<Device, Hindrance> {
        match &self.device {
            Some(known) if *known.file == *profile => Ok(Device { reach, ..known.clone() }),
            _ => Device::new(profile, reach).map_err(|error| Hindrance::Profile(error.into())),
        }
    }
}

impl Doing {
    fn obey(&mut self, order: Order, ledger: &mut Ledger, out: &mut Outbox) {
        match order {
            Order::Send { id, bytes, wait_ms } => {
                let number = out.number();
                self.asked.push((number, id));
                out.order(ToLine::Send { id: number, origin: Origin::Configuration, bytes, wait_ms });
            }
            Order::Withdraw(id) => {
                let asked = self.asked.iter().find(|(_, own)| *own == id);
                // What has ended cannot be withdrawn, and number 0 is nobody's.
                out.order(ToLine::Withdraw(asked.map_or(0, |(number, _)| *number)));
            }
            Order::Settings { line, mode } => {
                out.order(ToLine::Settings { line, mode, buffer_bytes: self.buffer_bytes });
            }
            Order::Poll(on) => out.order(ToLine::Poll(on)),
            Order::Unit(unit) => out.order(ToLine::Unit(unit.0)),
            Order::Keep(journal) => out.store(ToStore::Keep { journal, simulated: self.simulated }),
            Order::Forget(journal) => out.store(ToStore::Forget(journal)),
            Order::Audit(entry) => {
                let (simulated, origin) = (self.simulated, Origin::Configuration);
                ledger.append(AuditRow { simulated, origin, entry: *entry }, out);
            }
        }
    }
}

/// The line as a procedure sees it.
fn line_of(state: Option<&LineState>) -> Line {
    match state {
        Some(state) => Line {
            port: match state.port {
                _ if state.replay => Port::Gone,
                PortState::Open => Port::Open,
                PortState::Changing => Port::Changing,
                PortState::Refused => Port::Refused,
                PortState::Gone => Port::Gone,
            },
            line: state.line,
            mode: state.mode,
            polling: state.polling,
            read_only: state.read_only,
        },
        None => Line { port: Port::Gone, line: UNKNOWN_LINE, mode: Mode::Rtu, polling: false, read_only: false },
    }
}
