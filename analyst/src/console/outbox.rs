//! What the console has to say, until somebody takes it.

use std::collections::VecDeque;

use crate::line::ToLine;
use crate::message::FromConsole;

/// Messages to both sides, and the numbers under which the engine knows what it is to send.
#[derive(Debug, Default)]
pub(super) struct Outbox {
    pub(super) line: VecDeque<ToLine>,
    pub(super) window: VecDeque<FromConsole>,
    last_number: u32,
}

impl Outbox {
    /// A number that names something to be sent and nothing before it.
    pub(super) fn number(&mut self) -> u32 {
        self.last_number = self.last_number.wrapping_add(1);
        self.last_number
    }

    pub(super) fn order(&mut self, order: ToLine) {
        self.line.push_back(order);
    }

    pub(super) fn tell(&mut self, news: FromConsole) {
        self.window.push_back(news);
    }
}
