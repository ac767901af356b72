//! A list of any length, of which only the rows in sight exist.

use std::cell::RefCell;
use std::ops::Range;
use std::rc::Rc;

use crate::dom::{self, El, el};
use crate::reactive::prelude::*;
use crate::text::Label;
use crate::workbench::Workbench;

/// Height of a row in pixels; the style sheet draws them so.
const ROW: f64 = 32.0;
/// Rows beyond both edges that are drawn too.
const MARGIN: u32 = 8;
/// Browsers draw nothing that is taller than some 33 million pixels: a longer list is scrolled in larger steps.
const TALLEST: f64 = 30_000_000.0;
/// The most rows that are in sight before the list scrolls.
const MOST_IN_SIGHT: f64 = 14.0;

/// What a list shows.
pub(crate) struct Source {
    /// How many rows there are.
    pub(crate) total: Memo<u32>,
    /// Changes whenever rows have become other ones or have come in.
    pub(crate) turn: RwSignal<u32>,
    /// Tells a row's contents apart, or `None` until it is there: a row whose number has not changed is not drawn anew.
    pub(crate) stamp: fn(&'static Workbench, u32) -> Option<u64>,
    /// Draws a row that is there. Nothing in it may listen or follow signals.
    pub(crate) draw: fn(&'static Workbench, u32) -> Option<El>,
    /// Told which rows will be looked at.
    pub(crate) want: fn(&'static Workbench, Range<u32>),
    /// The chosen row.
    pub(crate) chosen: RwSignal<u32>,
    /// A row's name for the tests.
    pub(crate) hook: &'static str,
}

/// The list, below a head that does not scroll.
pub(crate) fn list(app: &'static Workbench, class: &str, label: Label, head: El, source: Source) -> El {
    let source = Rc::new(source);
    let canvas = el("div").class("list-canvas").attr("role", "presentation");
    let frame =
        el("div").class("list-frame").attr("tabindex", "0").attr("role", "listbox").label(app, label).live_attr(
            "aria-activedescendant",
            {
                let source = Rc::clone(&source);
                move || Some(row_id(source.hook, source.chosen.get()))
            },
        );
    let painter = Rc::new(Painter {
        app,
        frame: frame.handle(),
        canvas: canvas.handle(),
        source: Rc::clone(&source),
        shown: RefCell::new(Vec::new()),
    });
    let frame = {
        let (scrolled, keyed, clicked) = (Rc::clone(&painter), Rc::clone(&painter), Rc::clone(&source));
        let frame = frame.on("scroll", move |_| scrolled.paint()).on("keydown", move |event| {
            if keyed.key(&dom::key(&event)) {
                event.prevent_default();
            }
        });
        // Rows come and go too fast to listen each for itself.
        frame.on("click", move |event| {
            if let Some(row) = dom::attribute_around(&event, "data-row").and_then(|row| row.parse().ok()) {
                clicked.chosen.set(row);
            }
        })
    };
    let frame = frame.child(canvas);
    dom::react(move || {
        source.turn.track();
        source.chosen.track();
        app.language.track();
        app.size_turn.track();
        painter.resize(source.total.get());
        painter.paint();
    });
    el("div").class(&["list ", class].concat()).child(head).child(frame)
}

fn row_id(hook: &str, row: u32) -> String {
    [hook, "-", &row.to_string()].concat()
}

/// A row that exists.
struct Drawn {
    row: u32,
    content: Option<u64>,
    chosen: bool,
    element: El,
    /// Where it is drawn, in pixels.
    top: f64,
}

impl Drawn {
    fn at(mut self, top: f64) -> Self {
        // Not a number until it is placed for the first time, and so never equal.
        if self.top.to_bits() != top.to_bits() {
            self.top = top;
            self.element.handle().set_style("top", &px(top));
        }
        self
    }
}

struct Painter {
    app: &'static Workbench,
    frame: dom::Handle,
    canvas: dom::Handle,
    source: Rc<Source>,
    shown: RefCell<Vec<Drawn>>,
}

impl Painter {
    fn resize(&self, total: u32) {
        self.canvas.set_style("height", &px((f64::from(total) * ROW).min(TALLEST)));
        self.frame.set_style("height", &px((f64::from(total).min(MOST_IN_SIGHT)) * ROW));
    }

    /// Draws what is in sight.
    fn paint(&self) {
        let total = self.source.total.get_untracked();
        let chosen = self.source.chosen.get_untracked();
        let (top, shift) = self.place(total);
        let first = rows(top / ROW).saturating_sub(MARGIN);
        let last = rows((top + self.frame.height()) / ROW).saturating_add(1 + MARGIN).min(total);
        (self.source.want)(self.app, first..last);
        let mut shown = self.shown.borrow_mut();
        let mut old = std::mem::take(&mut *shown);
        for row in first..last {
            let content = (self.source.stamp)(self.app, row);
            let kept = old.iter().position(|drawn| drawn.row == row);
            let kept = kept.map(|at| old.swap_remove(at));
            let drawn = match kept {
                Some(drawn) if drawn.content == content && drawn.chosen == (row == chosen) => drawn,
                kept => {
                    if let Some(kept) = kept {
                        kept.element.remove();
                    }
                    self.draw(row, content, row == chosen)
                }
            };
            shown.push(drawn.at(f64::from(row) * ROW - shift));
        }
        for drawn in old {
            drawn.element.remove();
        }
    }

    fn draw(&self, row: u32, content: Option<u64>, chosen: bool) -> Drawn {
        let drawn = content.and_then(|_| (self.source.draw)(self.app, row));
        let element = drawn.unwrap_or_else(|| el("div").class("list-row waiting"));
        let hook = self.source.hook;
        let element = element
            .attr("role", "option")
            .attr("id", &row_id(hook, row))
            .attr("data-row", &row.to_string())
            .test(if content.is_some() { hook } else { "" })
            .attr("aria-selected", if chosen { "true" } else { "false" });
        self.canvas.append(&element);
        Drawn { row, content, chosen, element, top: f64::NAN }
    }

    /// The place of the window's upper edge in a list of full height, and how far above that its rows are drawn.
    fn place(&self, total: u32) -> (f64, f64) {
        let (full, height) = (f64::from(total) * ROW, self.frame.height());
        let scrolled = self.frame.scroll_top();
        if full <= TALLEST {
            return (scrolled, 0.0);
        }
        let top = scrolled * (full - height) / (TALLEST - height).max(1.0);
        (top, top - scrolled)
    }

    /// Moves by a key; whether it was one.
    fn key(&self, key: &str) -> bool {
        let total = self.source.total.get_untracked();
        let Some(last) = total.checked_sub(1) else { return false };
        let chosen = self.source.chosen.get_untracked();
        let page = rows(self.frame.height() / ROW).max(2) - 1;
        let next = match key {
            "ArrowDown" => chosen.saturating_add(1),
            "ArrowUp" => chosen.saturating_sub(1),
            "PageDown" => chosen.saturating_add(page),
            "PageUp" => chosen.saturating_sub(page),
            "Home" => 0,
            "End" => last,
            _ => return false,
        };
        let next = next.min(last);
        self.source.chosen.set(next);
        self.reveal(next, total);
        true
    }

    /// Scrolls so that a row is in sight.
    fn reveal(&self, row: u32, total: u32) {
        let (top, _) = self.place(total);
        let (place, height) = (f64::from(row) * ROW, self.frame.height());
        let wanted = if place < top {
            place
        } else if place + ROW > top + height {
            place + ROW - height
        } else {
            return;
        };
        let full = f64::from(total) * ROW;
        let scale = if full <= TALLEST { 1.0 } else { (TALLEST - height) / (full - height) };
        self.frame.set_scroll_top(wanted * scale);
    }
}

fn px(pixels: f64) -> String {
    // Whole pixels: rows are drawn sharp, and the float formatter stays out of the download.
    #[allow(clippy::cast_possible_truncation)]
    let pixels = pixels as i64;
    [&pixels.to_string(), "px"].concat()
}

/// Whole rows; a list has at most as many as fit a u32.
fn rows(number: f64) -> u32 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let number = number.max(0.0) as u32;
    number
}
