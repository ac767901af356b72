//! From text to steps. All faults are found; a text with any is no sequence.

mod condition;
mod cursor;
mod payload;
mod step;

use buslens_codec::profile::Profile;

use crate::fault::{Fault, FaultKind};
use crate::lex::{self, Token};
use crate::script::{Action, Sequence, Step};
use cursor::Cursor;

/// Bytes of a text that are read.
pub const MAX_TEXT: usize = 256 * 1024;
/// Steps of a sequence.
pub const MAX_STEPS: usize = 5_000;
/// Blocks within blocks.
pub const MAX_DEPTH: usize = 16;
/// Faults that are told.
pub const MAX_FAULTS: usize = 100;

/// Reads a text. Points are those of `profile`; without one only bytes and registers can be named. Never panics, and the
/// time it takes is bounded by the text's length.
pub fn parse(text: &str, profile: Option<&Profile>) -> Result<Sequence, Vec<Fault>> {
    if text.len() > MAX_TEXT {
        let limit = u32::try_from(MAX_TEXT).unwrap_or(u32::MAX);
        return Err(vec![Fault { line: 1, column: 1, kind: FaultKind::TextTooLong(limit) }]);
    }
    let mut parser = Parser { profile, ..Parser::default() };
    for (at, text) in text.lines().enumerate() {
        let line = u32::try_from(at + 1).unwrap_or(u32::MAX);
        parser.sequence.source.push(text.trim().to_owned());
        parser.take_line(line, text);
        if parser.faults.len() >= MAX_FAULTS {
            parser.faults.push(Fault { line, column: 1, kind: FaultKind::TooManyFaults });
            return Err(parser.faults);
        }
    }
    for open in core::mem::take(&mut parser.open) {
        parser.faults.push(Fault { line: open.line, column: open.column, kind: FaultKind::NotClosed });
    }
    if parser.faults.is_empty() {
        return Ok(parser.sequence);
    }
    parser.faults.sort_by_key(|fault| (fault.line, fault.column));
    Err(parser.faults)
}

#[derive(Default)]
struct Parser<'a> {
    profile: Option<&'a Profile>,
    sequence: Sequence,
    faults: Vec<Fault>,
    open: Vec<Open>,
    variables: Vec<String>,
}

/// A block that has begun.
struct Open {
    line: u32,
    column: u32,
    /// The `if` or `repeat`.
    begin: usize,
    /// The last of `if`, `else if`, `else` or `repeat`.
    last: usize,
    kind: Block,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Block {
    If,
    Else,
    Repeat,
}

impl Parser<'_> {
    fn take_line(&mut self, line: u32, text: &str) {
        let (tokens, comment) = match lex::line(line, text) {
            Ok(parts) => parts,
            Err(fault) => {
                self.faults.push(fault);
                return;
            }
        };
        if let Some(comment) = comment {
            self.sequence.comments.push((line, comment));
        }
        let Some(first) = tokens.first() else { return };
        let fault = |kind| Fault { line, column: first.column, kind };
        let opens = first.is_word("if") || first.is_word("repeat");
        if self.sequence.steps.len() >= MAX_STEPS {
            self.faults.push(fault(FaultKind::TooManySteps(u32::try_from(MAX_STEPS).unwrap_or(u32::MAX))));
            return;
        }
        if opens && self.open.len() >= MAX_DEPTH {
            self.faults.push(fault(FaultKind::TooDeep(u32::try_from(MAX_DEPTH).unwrap_or(u32::MAX))));
        }
        if first.is_word("else") || first.is_word("end") {
            self.take_turn(line, &tokens);
            return;
        }
        let action = match self.action(line, &tokens) {
            Ok(action) => action,
            Err(fault) => {
                self.faults.push(fault);
                // The block is open all the same, or its end would be a fault as well.
                if !opens {
                    return;
                }
                Action::Stop
            }
        };
        let here = self.sequence.steps.len();
        self.push(line, self.open.len(), action);
        if opens {
            let kind = if first.is_word("if") { Block::If } else { Block::Repeat };
            self.open.push(Open { line, column: first.column, begin: here, last: here, kind });
        }
    }

    /// `else`, `else if` and `end`.
    fn take_turn(&mut self, line: u32, tokens: &[Token]) {
        let Some((first, rest)) = tokens.split_first() else { return };
        let fault = |kind| Fault { line, column: first.column, kind };
        let here = self.sequence.steps.len();
        let Some(open) = self.open.last() else {
            self.faults.push(fault(FaultKind::NothingOpen));
            return;
        };
        let (begin, last, depth) = (open.begin, open.last, self.open.len().saturating_sub(1));
        if first.is_word("end") {
            if let Some(more) = rest.first() {
                self.faults.push(Fault { line, column: more.column, kind: FaultKind::LeftOver(more.text()) });
            }
            self.open.pop();
            self.push(line, depth, Action::End { begin });
            self.close(begin, last, here);
            return;
        }
        if open.kind != Block::If {
            self.faults.push(fault(FaultKind::ElseNotHere));
            return;
        }
        let mut kind = Block::Else;
        let mut action = Action::Else { end: 0 };
        if let Some(second) = rest.first() {
            if second.is_word("if") {
                kind = Block::If;
                match self.condition_of(line, rest) {
                    Ok(condition) => action = Action::ElseIf { condition, next: 0, end: 0 },
                    Err(fault) => self.faults.push(fault),
                }
            } else {
                self.faults.push(Fault { line, column: second.column, kind: FaultKind::LeftOver(second.text()) });
            }
        }
        self.push(line, depth, action);
        self.set_next(last, here);
        if let Some(open) = self.open.last_mut() {
            (open.last, open.kind) = (here, kind);
        }
    }

    fn condition_of(&mut self, line: u32, tokens: &[Token]) -> Result<crate::script::Condition, Fault> {
        let mut cursor = Cursor::new(line, tokens);
        cursor.skip();
        let condition = self.condition(&mut cursor)?;
        cursor.finish()?;
        Ok(condition)
    }

    fn push(&mut self, line: u32, depth: usize, action: Action) {
        let depth = u8::try_from(depth).unwrap_or(u8::MAX);
        self.sequence.steps.push(Step { line, depth, action });
    }

    fn set_next(&mut self, step: usize, to: usize) {
        if let Some(Action::If { next, .. } | Action::ElseIf { next, .. }) =
            self.sequence.steps.get_mut(step).map(|step| &mut step.action)
        {
            *next = to;
        }
    }

    /// Tells every part of a block where it ends.
    fn close(&mut self, begin: usize, last: usize, here: usize) {
        self.set_next(last, here);
        let Some(depth) = self.sequence.steps.get(begin).map(|step| step.depth) else { return };
        for step in self.sequence.steps.iter_mut().skip(begin).filter(|step| step.depth == depth) {
            if let Action::ElseIf { end, .. } | Action::Else { end } | Action::Repeat { end, .. } = &mut step.action {
                *end = here;
            }
        }
    }
}
