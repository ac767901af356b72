//! A recording happens again: the master steps through it as through live traffic, and nothing leaves.

use buslens_codec::UnitId;

use super::job::request_of;
use super::poll::Schedule;
use super::{Asker, Config, Current, LinkEvent, LinkState, Master};
use crate::record::{Event, Origin, What};
use crate::time::Instant;

impl Master {
    /// A master for [`Master::replay`], whose link counts as open. [`Master::set_poll`] tells it which requests were the
    /// poll's; its unit is that of the first one that comes. It sends nothing, whatever is submitted; jobs wait for ever.
    pub fn replaying(config: Config) -> Self {
        let mut master = Self::new(config);
        master.link.pretend(LinkState::Open);
        master.replay = true;
        master
    }

    /// Lets `what` happen, and before it whatever time alone brings. A recorded request begins without being sent; one
    /// that equals a request of the poll, and is not known to be somebody else's, ends in an [`super::Event::Polled`].
    /// Time must not go back.
    pub fn replay(&mut self, now: Instant, what: &What) {
        while let Some(due) = self.poll_timeout().filter(|&due| due < now) {
            self.handle_timeout(due);
        }
        match what {
            What::Sent { origin, bytes } if !bytes.is_empty() => self.replay_sent(now, *origin, bytes),
            What::Received(bytes) => self.handle_bytes(now, bytes),
            What::Port(Event::LineError) => self.handle_link(now, LinkEvent::LineError),
            What::Port(Event::Opened(line, mode)) => {
                (self.config.line, self.config.mode) = (*line, *mode);
                self.abandon(now);
                self.link.pretend(LinkState::Open);
                self.start_afresh(now);
            }
            What::Port(Event::Closed) => self.interrupted(now, LinkState::Closed),
            What::Port(Event::Lost) => self.interrupted(now, LinkState::Lost),
            What::Sent { .. } | What::Port(Event::Break(_) | Event::Forgotten(_)) => {}
        }
    }

    /// Whom the poll asks; in a replay known from its first request on.
    pub fn polled_unit(&self) -> Option<UnitId> {
        self.schedule.as_ref().map(Schedule::unit)
    }

    /// The next request was made, so that nothing more answered the one before.
    fn replay_sent(&mut self, now: Instant, origin: Origin, bytes: &[u8]) {
        self.link.pretend(LinkState::Open);
        self.handle_timeout(now);
        let exchange = match &mut self.current {
            Some(Current::Request(current)) => Some(current.cut_short(now, &mut self.inbox)),
            Some(Current::Raw(_)) | None => None,
        };
        match exchange {
            Some(exchange) => self.finish(now, exchange),
            None => self.current = None,
        }
        let request = request_of(self.config.mode, bytes);
        let schedule = self.schedule.as_mut().filter(|_| matches!(origin, Origin::Poll | Origin::Unknown));
        let index =
            schedule.zip(request.as_ref()).and_then(|(schedule, (unit, request))| schedule.recognise(*unit, request));
        let asker = index.map_or(Asker::Recorded, Asker::Poll);
        self.begin(now, asker, None, request, bytes.to_vec());
    }

    /// The link of the recording is gone until it is opened or something is sent again.
    fn interrupted(&mut self, now: Instant, state: LinkState) {
        self.abandon(now);
        self.link.pretend(state);
    }
}
