//! Opening the link, keeping it open, and getting it back.

use std::collections::VecDeque;

use buslens_codec::line::LineSettings;

use super::Config;
use crate::time::Instant;

/// What the port did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkEvent {
    /// Open as ordered.
    Opened,
    /// Could not be opened.
    OpenFailed,
    /// Vanished.
    Lost,
    /// An adapter was plugged in.
    Plugged,
    /// Closed as ordered.
    Closed,
    /// A framing, parity, break or overrun error; the port stays open.
    LineError,
}

/// What the port shall do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkOrder {
    /// Open with these settings.
    Open(LineSettings),
    /// Close.
    Close,
}

/// State of the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkState {
    /// Closed, and wanted so.
    Closed,
    /// Being opened for the first time.
    Opening,
    /// Open.
    Open,
    /// Vanished; tried again until it is back or [`super::Master::disconnect`] ends it.
    Lost,
    /// Being closed.
    Closing,
}

#[derive(Debug)]
pub(super) struct LinkControl {
    state: LinkState,
    told: LinkState,
    orders: VecDeque<LinkOrder>,
    /// When a lost port is tried again; `None` while a try is under way.
    retry_at: Option<Instant>,
    /// A port was plugged in while a try was under way.
    plugged_meanwhile: bool,
    settings: Option<LineSettings>,
    /// Orders to open that the port has not answered yet: only the last answer counts.
    unanswered: u32,
}

impl LinkControl {
    pub(super) fn new() -> Self {
        Self {
            state: LinkState::Closed,
            told: LinkState::Closed,
            orders: VecDeque::new(),
            retry_at: None,
            plugged_meanwhile: false,
            settings: None,
            unanswered: 0,
        }
    }

    pub(super) fn state(&self) -> LinkState {
        self.state
    }

    /// Whether a job submitted now can be carried out without the port coming back first.
    pub(super) fn is_hopeful(&self) -> bool {
        matches!(self.state, LinkState::Opening | LinkState::Open)
    }

    pub(super) fn connect(&mut self, settings: LineSettings) {
        self.settings = Some(settings);
        self.state = LinkState::Opening;
        self.order_open(settings);
    }

    /// Opens an open port again with other settings; any other will be opened with them.
    pub(super) fn reopen(&mut self, settings: LineSettings) {
        self.settings = Some(settings);
        match self.state {
            LinkState::Opening | LinkState::Open => self.connect(settings),
            LinkState::Lost if self.retry_at.is_none() => self.order_open(settings),
            LinkState::Lost | LinkState::Closed | LinkState::Closing => {}
        }
    }

    fn order_open(&mut self, settings: LineSettings) {
        self.unanswered += 1;
        self.orders.push_back(LinkOrder::Open(settings));
    }

    /// A replay has a link that nobody opened.
    pub(super) fn pretend(&mut self, state: LinkState) {
        self.state = state;
    }

    pub(super) fn disconnect(&mut self) {
        if self.state != LinkState::Closed {
            self.state = LinkState::Closing;
            self.orders.push_back(LinkOrder::Close);
        }
    }

    pub(super) fn handle(&mut self, now: Instant, event: LinkEvent, config: Config) {
        if matches!(event, LinkEvent::Opened | LinkEvent::OpenFailed) {
            self.unanswered = self.unanswered.saturating_sub(1);
            if self.unanswered > 0 {
                return;
            }
        }
        match (self.state, event) {
            (LinkState::Opening | LinkState::Lost, LinkEvent::Opened) => self.state = LinkState::Open,
            (LinkState::Opening, LinkEvent::OpenFailed | LinkEvent::Closed | LinkEvent::Lost)
            | (LinkState::Closing, LinkEvent::Closed) => self.state = LinkState::Closed,
            (LinkState::Open, LinkEvent::Lost | LinkEvent::Closed) => {
                self.state = LinkState::Lost;
                self.plugged_meanwhile = false;
                self.retry_at = Some(now + config.reopen_period);
            }
            (LinkState::Lost, LinkEvent::OpenFailed) => {
                let wait = if self.plugged_meanwhile { std::time::Duration::ZERO } else { config.reopen_period };
                self.plugged_meanwhile = false;
                self.retry_at = Some(now + wait);
            }
            (LinkState::Lost, LinkEvent::Plugged) => match &mut self.retry_at {
                Some(at) => *at = now,
                None => self.plugged_meanwhile = true,
            },
            _ => {}
        }
    }

    /// Tries a lost port again when it is time.
    pub(super) fn handle_timeout(&mut self, now: Instant, config: Config) {
        if self.state == LinkState::Lost && self.retry_at.is_some_and(|at| at <= now) {
            self.retry_at = None;
            self.order_open(self.settings.unwrap_or(config.line));
        }
    }

    pub(super) fn timeout(&self) -> Option<Instant> {
        self.retry_at.filter(|_| self.state == LinkState::Lost)
    }

    pub(super) fn poll_order(&mut self) -> Option<LinkOrder> {
        self.orders.pop_front()
    }

    /// The state, if it has changed since it was last told.
    pub(super) fn poll_change(&mut self) -> Option<LinkState> {
        if self.told == self.state {
            return None;
        }
        self.told = self.state;
        Some(self.state)
    }
}
