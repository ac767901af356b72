//! When to read what does not change by itself: limits, offsets, and whatever else measurements are seen with. One read
//! after a round of the poll, so that no round waits for more than one of them.

use std::time::Duration;

use buslens_bus::time::Instant;
use buslens_bus::{Answer, Exchange, Failure, JobId};
use buslens_codec::line::Mode;
use buslens_codec::pdu::Request;

/// Others on the line may change things too: time until all of it is read again.
const PERIOD: Duration = Duration::from_secs(20);

#[derive(Default)]
pub(super) struct Context {
    /// With their places; without those that the device has refused.
    reads: Vec<(usize, Request)>,
    /// How many of them have been read since [`Self::again`].
    done: usize,
    /// What is being read.
    current: Option<(JobId, usize)>,
    /// Nothing is read before this.
    due: Instant,
}

impl Context {
    pub(super) fn new(requests: Vec<Request>) -> Self {
        Self { reads: requests.into_iter().enumerate().collect(), ..Self::default() }
    }

    /// It may be different now: read all of it.
    pub(super) fn again(&mut self) {
        (self.done, self.due) = (0, Instant::ZERO);
    }

    /// A round has ended: what to read before the next one.
    pub(super) fn next(&mut self, now: Instant) -> Option<Request> {
        if self.current.is_some() || now < self.due {
            return None;
        }
        if self.done >= self.reads.len() {
            self.done = 0;
        }
        self.reads.get(self.done).map(|(_, request)| request.clone())
    }

    /// What [`Self::next`] gave is on its way.
    pub(super) fn submitted(&mut self, job: JobId) {
        if let Some((place, _)) = self.reads.get(self.done) {
            self.current = Some((job, *place));
        }
    }

    /// The place of the read that has ended with this job, if it is one of these.
    pub(super) fn ended(&mut self, job: JobId, exchange: &Exchange) -> Option<usize> {
        let (_, place) = self.current.take_if(|(current, _)| *current == job)?;
        match &exchange.result {
            Ok(Answer::Reply(_)) => {
                // After a write it is all to be read again, this one too.
                if self.reads.get(self.done).is_some_and(|(other, _)| *other == place) {
                    self.done += 1;
                }
                if self.done >= self.reads.len() {
                    self.due = exchange.at + PERIOD;
                }
            }
            Err(Failure::Exception { .. }) => self.reads.retain(|(other, _)| *other != place),
            _ => self.due = exchange.at + PERIOD,
        }
        Some(place)
    }
}

/// Whether a frame that was sent may have changed something in a device.
pub(super) fn may_have_written(mode: Mode, sent: &[u8]) -> bool {
    let reads = match mode {
        Mode::Rtu => matches!(sent.get(1), Some(1..=4)),
        Mode::Ascii => matches!(sent.get(3..5), Some([b'0', b'1'..=b'4'])),
    };
    !reads && !sent.is_empty()
}

#[cfg(test)]
mod tests {
    use buslens_bus::{Config, Job, Master};
    use buslens_codec::UnitId;
    use buslens_codec::line::{LineSettings, Parity};
    use buslens_codec::pdu::{ExceptionCode, Response};

    use super::*;

    fn read(address: u16) -> Request {
        Request::ReadHoldingRegisters { address, quantity: 1 }
    }

    fn at(ms: u64) -> Instant {
        Instant::from_micros(ms * 1000)
    }

    /// Gives out jobs as the master of a session does.
    struct Session {
        master: Master,
        context: Context,
    }

    impl Session {
        fn new(addresses: &[u16]) -> Self {
            let config = Config::new(LineSettings::new(9600, Parity::None), Mode::Rtu);
            let context = Context::new(addresses.iter().copied().map(read).collect());
            Self { master: Master::new(config), context }
        }

        /// A round has ended, and what is read then ends so; the place of what was read.
        fn round(&mut self, ms: u64, result: Result<Answer, Failure>) -> Option<usize> {
            let request = self.context.next(at(ms))?;
            let job = self.master.submit(at(ms), Job::new(UnitId(1), request));
            self.context.submitted(job);
            assert_eq!(self.context.next(at(ms)), None, "one at a time");
            let exchange =
                Exchange { sent: vec![], received: vec![], sent_at: at(ms), at: at(ms), round_trip: None, result };
            self.context.ended(job, &exchange)
        }
    }

    fn answered(session: &mut Session, ms: u64) -> Option<usize> {
        session.round(ms, Ok(Answer::Reply(Response::ReadHoldingRegisters { values: vec![7] })))
    }

    #[test]
    fn everything_is_read_once_and_after_a_while_again() {
        let mut session = Session::new(&[5, 6]);
        let places = [0, 100, 200, 19_000, 20_200, 20_300].map(|ms| answered(&mut session, ms));
        assert_eq!(places, [Some(0), Some(1), None, None, Some(0), Some(1)]);
    }

    #[test]
    fn after_a_write_it_is_read_at_once() {
        let mut session = Session::new(&[5, 6]);
        answered(&mut session, 0);
        session.context.again();
        let places = [100, 200, 300].map(|ms| answered(&mut session, ms));
        assert_eq!(places, [Some(0), Some(1), None]);
        session.context.again();
        assert_eq!(answered(&mut session, 400), Some(0));
    }

    #[test]
    fn what_is_refused_is_not_asked_again_and_silence_is_given_time() {
        let mut session = Session::new(&[5, 6]);
        let refused = Failure::Exception { function: 3, code: ExceptionCode::IllegalDataAddress };
        assert_eq!(session.round(0, Err(refused)), Some(0));
        let silent = Failure::NoAnswer { heard: vec![], line_errors: 0 };
        assert_eq!(session.round(100, Err(silent)), Some(1));
        let places = [200, 20_100, 40_200].map(|ms| answered(&mut session, ms));
        assert_eq!(places, [None, Some(1), Some(1)]);
    }

    #[test]
    fn reads_are_told_from_writes_in_both_modes() {
        assert!(!may_have_written(Mode::Rtu, &[1, 4, 0, 2, 0, 4, 0x50, 9]));
        assert!(may_have_written(Mode::Rtu, &[1, 5, 0, 0x50, 0xFF, 0, 0x8C, 0x2B]));
        assert!(!may_have_written(Mode::Ascii, b":010300310001CA\r\n"));
        assert!(may_have_written(Mode::Ascii, b":01050050FF00AB\r\n"));
        assert!(may_have_written(Mode::Rtu, &[0x55]), "nobody knows what a device takes it for");
        assert!(!may_have_written(Mode::Rtu, &[]));
    }
}
