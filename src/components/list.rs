//! A list of any length, of which only the rows in sight exist.

use std::cell::{Cell, RefCell};
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
    /// How many rows have gone before the first one: when more go, what is in sight stays in sight.
    pub(crate) gone: RwSignal<u32>,
    /// Changes whenever rows have become other ones or have come in.
    pub(crate) turn: RwSignal<u32>,
    /// Tells a row's contents apart, or `None` until it is there: a row whose number has not changed is not drawn anew.
    pub(crate) stamp: Box<dyn Fn(u32) -> Option<u64>>,
    /// Draws a row that is there. Nothing in it may listen or follow signals.
    pub(crate) draw: Box<dyn Fn(u32) -> Option<El>>,
    /// Told which rows will be looked at.
    pub(crate) want: Box<dyn Fn(Range<u32>)>,
    /// The place of a row that is to be brought in sight, once: what was looked for, as soon as it is there.
    pub(crate) seek: Box<dyn Fn() -> Option<u32>>,
    /// The chosen row; one beyond the last stands for none.
    pub(crate) chosen: RwSignal<u32>,
    /// Of a list that grows, what else it needs.
    pub(crate) growing: Option<Growing>,
    /// A row's name for the tests.
    pub(crate) hook: &'static str,
}

/// What a list needs that grows while it is looked at.
#[derive(Clone, Copy)]
pub(crate) struct Growing {
    /// Whether the newest row is kept in sight. Scrolling up and choosing a row end it; the end of the list resumes it.
    pub(crate) follow: RwSignal<bool>,
    /// The other end of the chosen rows, where several are.
    pub(crate) anchor: RwSignal<u32>,
    /// Changes when the list is to be shown from its beginning.
    pub(crate) rewound: RwSignal<u32>,
}

impl Source {
    /// Whether a row is among the chosen ones.
    fn is_chosen(&self, row: u32) -> bool {
        let chosen = self.chosen.get_untracked();
        if chosen >= self.total.get_untracked() {
            return false;
        }
        let anchor = self.growing.map_or(chosen, |growing| growing.anchor.get_untracked());
        (chosen.min(anchor)..=chosen.max(anchor)).contains(&row)
    }

    /// Chooses a row, or with `more` all rows from the one that was chosen first.
    fn choose(&self, row: u32, more: bool) {
        if let Some(growing) = self.growing {
            growing.follow.set(false);
            if !more || growing.anchor.get_untracked() >= self.total.get_untracked() {
                growing.anchor.set(row);
            }
        }
        self.chosen.set(row);
    }
}

/// The list, below a head that does not scroll.
pub(crate) fn list(app: &'static Workbench, class: &str, label: Label, head: El, source: Source) -> El {
    let source = Rc::new(source);
    let canvas = el("div").class("list-canvas").attr("role", "presentation");
    let frame = el("div")
        .class("list-frame")
        .attr("id", &[source.hook, "s"].concat())
        .attr("tabindex", "0")
        .attr("role", "listbox")
        .label(app, label)
        .live_attr("aria-activedescendant", {
            let source = Rc::clone(&source);
            move || Some(row_id(source.hook, source.chosen.get()))
        });
    let frame = if source.growing.is_some() { frame.attr("aria-multiselectable", "true") } else { frame };
    let painter = Rc::new(Painter {
        frame: frame.handle(),
        canvas: canvas.handle(),
        gone: Cell::new(source.gone.get_untracked()),
        scrolled: Cell::new(0.0),
        rewound: Cell::new(source.growing.map_or(0, |growing| growing.rewound.get_untracked())),
        source: Rc::clone(&source),
        shown: RefCell::new(Vec::new()),
    });
    let frame = {
        let (scrolled, keyed, clicked) = (Rc::clone(&painter), Rc::clone(&painter), Rc::clone(&source));
        let frame = frame
            .on("scroll", move |_| {
                scrolled.notice();
                scrolled.paint();
            })
            .on("keydown", move |event| {
                if keyed.key(&dom::key(&event), dom::is_shifted(&event)) {
                    event.prevent_default();
                }
            });
        // Rows come and go too fast to listen each for itself.
        frame.on("click", move |event| {
            if let Some(row) = dom::attribute_around(&event, "data-row").and_then(|row| row.parse().ok()) {
                clicked.choose(row, dom::is_shifted(&event));
            }
        })
    };
    let frame = frame.child(canvas);
    dom::react(move || {
        source.turn.track();
        source.chosen.track();
        if let Some(growing) = source.growing {
            growing.follow.track();
            growing.anchor.track();
            growing.rewound.track();
        }
        app.language.track();
        app.size_turn.track();
        let total = source.total.get();
        painter.resize(total, source.gone.get());
        if let Some(row) = (source.seek)() {
            painter.reveal(row, total);
        }
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
    frame: dom::Handle,
    canvas: dom::Handle,
    /// [`Source::gone`] as it was drawn.
    gone: Cell<u32>,
    /// How far it was scrolled down when that was last looked at, in pixels.
    scrolled: Cell<f64>,
    /// [`Growing::rewound`] as it was obeyed.
    rewound: Cell<u32>,
    source: Rc<Source>,
    shown: RefCell<Vec<Drawn>>,
}

impl Painter {
    fn resize(&self, total: u32, gone: u32) {
        let height = (f64::from(total) * ROW).min(TALLEST);
        self.canvas.set_style("height", &px(height));
        let Some(growing) = self.source.growing else {
            return self.frame.set_style("height", &px((f64::from(total).min(MOST_IN_SIGHT)) * ROW));
        };
        let went = gone.wrapping_sub(self.gone.replace(gone));
        let rewound = growing.rewound.get_untracked();
        if self.rewound.replace(rewound) != rewound {
            self.frame.set_scroll_top(0.0);
        } else if growing.follow.get_untracked() {
            self.frame.set_scroll_top(height);
        } else if went > 0 {
            self.frame.set_scroll_top((self.frame.scroll_top() - f64::from(went) * ROW * self.scale(total)).max(0.0));
        }
        self.scrolled.set(self.frame.scroll_top());
    }

    /// Takes note of a scrolling: up ends following, down to the end resumes it.
    fn notice(&self) {
        let Some(growing) = self.source.growing else { return };
        let top = self.frame.scroll_top();
        let end = (f64::from(self.source.total.get_untracked()) * ROW).min(TALLEST) - self.frame.height();
        let before = self.scrolled.replace(top);
        let followed = growing.follow.get_untracked();
        let follow = if top >= end - 1.0 { followed || top > before } else { followed && top >= before };
        if follow != followed {
            growing.follow.set(follow);
        }
    }

    /// Draws what is in sight.
    fn paint(&self) {
        let total = self.source.total.get_untracked();
        let (top, shift) = self.place(total);
        let first = rows(top / ROW).saturating_sub(MARGIN);
        let last = rows((top + self.frame.height()) / ROW).saturating_add(1 + MARGIN).min(total);
        (self.source.want)(first..last);
        let mut shown = self.shown.borrow_mut();
        let mut old = std::mem::take(&mut *shown);
        for row in first..last {
            let content = (self.source.stamp)(row);
            let chosen = self.source.is_chosen(row);
            let kept = old.iter().position(|drawn| drawn.row == row);
            let kept = kept.map(|at| old.swap_remove(at));
            let drawn = match kept {
                Some(drawn) if drawn.content == content && drawn.chosen == chosen => drawn,
                kept => {
                    if let Some(kept) = kept {
                        kept.element.remove();
                    }
                    self.draw(row, content, chosen)
                }
            };
            shown.push(drawn.at(f64::from(row) * ROW - shift));
        }
        for drawn in old {
            drawn.element.remove();
        }
    }

    fn draw(&self, row: u32, content: Option<u64>, chosen: bool) -> Drawn {
        let drawn = content.and_then(|_| (self.source.draw)(row));
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
    fn key(&self, key: &str, more: bool) -> bool {
        let total = self.source.total.get_untracked();
        let Some(last) = total.checked_sub(1) else { return false };
        let chosen = self.source.chosen.get_untracked();
        let page = rows(self.frame.height() / ROW).max(2) - 1;
        let next = match key {
            // Where none is chosen, the newest is the first to be.
            "ArrowDown" | "ArrowUp" if chosen > last => last,
            "ArrowDown" => chosen.saturating_add(1),
            "ArrowUp" => chosen.saturating_sub(1),
            "PageDown" => chosen.saturating_add(page),
            "PageUp" => chosen.min(last).saturating_sub(page),
            "Home" => 0,
            "End" => last,
            _ => return false,
        };
        let next = next.min(last);
        self.source.choose(next, more);
        self.reveal(next, total);
        if let (Some(growing), "End", false) = (self.source.growing, key, more) {
            growing.follow.set(true);
        }
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
        self.frame.set_scroll_top(wanted * self.scale(total));
        self.scrolled.set(self.frame.scroll_top());
    }

    /// Scrolled pixels to a pixel of a list of full height.
    fn scale(&self, total: u32) -> f64 {
        let (full, height) = (f64::from(total) * ROW, self.frame.height());
        if full <= TALLEST { 1.0 } else { (TALLEST - height) / (full - height) }
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
