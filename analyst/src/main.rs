//! The analyst's worker: takes texts and files in, or what goes over a line, and gives rows and counts out. Between two
//! portions it listens, so that a list can be looked at and a reading be stopped while it goes on.

mod scope;
mod source;
mod store;

use std::cell::{Cell, RefCell};
use std::rc::{Rc, Weak};

use buslens_analyst::Console;
use buslens_analyst::line::FromLine;
use buslens_analyst::message::{Format, FromAnalyst, Sums, ToAnalyst, ToConsole};
use js_sys::{Array, Uint8Array};
use wasm_bindgen::JsValue;
use wasm_bindgen_futures::spawn_local;

use scope::{Line, Timer, milliseconds, now, post, post_with, turn};
use source::Source;
use store::Store;

/// Entries that are counted or sifted before the clock is looked at.
const ENTRIES: usize = 1024;
/// Milliseconds of work before the worker listens again.
const PATIENCE: f64 = 5.0;
/// Nobody reads progress faster, in milliseconds.
const NEWS_PERIOD: f64 = 60.0;

fn main() {
    std::panic::set_hook(Box::new(|info| post(&FromAnalyst::Panicked(info.to_string()))));
    let analyst = Rc::new_cyclic(|weak: &Weak<Analyst>| Analyst {
        store: Store::new({
            let analyst = Weak::clone(weak);
            move |answer| {
                if let Some(analyst) = analyst.upgrade() {
                    analyst.console.borrow_mut().hear_store(now(), answer);
                    analyst.drain();
                }
            }
        }),
        console: RefCell::default(),
        line: RefCell::new(None),
        timer: Timer::new(),
        reading: Cell::new(0),
        working: Cell::new(false),
        taking_notes: Cell::new(false),
    });
    let for_timer = Rc::downgrade(&analyst);
    analyst.timer.on_time(move || {
        if let Some(analyst) = for_timer.upgrade() {
            analyst.console.borrow_mut().handle_time(now());
            analyst.drain();
        }
    });
    scope::on_message(move |message, beside| analyst.hear(message, beside));
}

struct Analyst {
    console: RefCell<Console>,
    line: RefCell<Option<Line>>,
    store: Rc<Store>,
    timer: Timer,
    /// The reading that is wanted; an older one stops by itself.
    reading: Cell<u32>,
    working: Cell<bool>,
    taking_notes: Cell<bool>,
}

impl Analyst {
    fn hear(self: &Rc<Self>, message: ToAnalyst, beside: JsValue) {
        match message {
            ToAnalyst::Read { reading, form, keep } => {
                self.reading.set(reading);
                let analyst = Rc::clone(self);
                spawn_local(async move {
                    match Source::find(beside, keep).await {
                        Some(source) => {
                            if let Err(words) = analyst.read(reading, form, &source).await {
                                post(&FromAnalyst::Unreadable(words));
                            }
                        }
                        None => post(&FromAnalyst::NothingKept),
                    }
                });
            }
            ToAnalyst::Cancel => {
                self.reading.set(0);
                if let Some(text) = self.console.borrow_mut().text_mut() {
                    text.cancel();
                }
                self.tell();
                self.work();
            }
            ToAnalyst::Profile(choice) => {
                self.console.borrow_mut().choose(choice);
                self.tell();
                self.work();
            }
            ToAnalyst::Filter(filter) => {
                self.console.borrow_mut().set_filter(filter);
                self.work();
            }
            ToAnalyst::Rows { from, count } => {
                let rows = self.console.borrow().rows(from, count);
                post(&FromAnalyst::Rows(rows));
            }
            ToAnalyst::Look { index, shown } => {
                let look = self.console.borrow().desk().look(index, &shown);
                post(&FromAnalyst::Look(look));
            }
            ToAnalyst::Export(format) => self.export(format),
            ToAnalyst::Sums(text) => {
                let sums = Sums::of(&text);
                post(&FromAnalyst::Sums(text, sums));
            }
            ToAnalyst::Forget => spawn_local(source::forget()),
            ToAnalyst::Console(message) => {
                match message {
                    ToConsole::Attach => self.attach(beside),
                    ToConsole::Live => self.reading.set(0),
                    _ => {}
                }
                self.console.borrow_mut().hear(now(), message);
                self.drain();
                self.work();
            }
        }
    }

    fn attach(self: &Rc<Self>, end: JsValue) {
        let analyst = Rc::downgrade(self);
        let hear = move |message: FromLine| {
            if let Some(analyst) = analyst.upgrade() {
                analyst.console.borrow_mut().hear_line(now(), scope::unix_us(), message);
                analyst.drain();
            }
        };
        *self.line.borrow_mut() = Some(Line::attach(end, hear));
    }

    /// Hands on what the console wants and tells, and takes notes into its lists in portions.
    fn drain(self: &Rc<Self>) {
        self.hand_on();
        if self.taking_notes.replace(true) {
            return;
        }
        let analyst = Rc::clone(self);
        spawn_local(async move {
            while analyst.console.borrow_mut().work() {
                analyst.hand_on();
                turn().await;
            }
            analyst.taking_notes.set(false);
            analyst.hand_on();
        });
    }

    fn hand_on(&self) {
        let mut console = self.console.borrow_mut();
        let now = now();
        while let Some(order) = console.poll_line() {
            if let Some(line) = &*self.line.borrow() {
                line.post(&order);
            }
        }
        while let Some(order) = console.poll_store() {
            self.store.order(order);
        }
        while let Some(news) = console.poll_news() {
            post(&FromAnalyst::Console(news));
        }
        if let Some(progress) = console.poll_progress(now) {
            post(&FromAnalyst::Progress(progress));
        }
        if let Some(statistics) = console.poll_statistics(now) {
            post(&FromAnalyst::Statistics(statistics));
        }
        self.timer.set(now, console.poll_timeout());
    }

    /// Reads a source to its end, or until another reading is wanted.
    async fn read(
        self: &Rc<Self>,
        reading: u32,
        form: Option<buslens_codec::intake::Form>,
        source: &Source,
    ) -> Result<(), String> {
        if self.reading.get() != reading {
            return Ok(());
        }
        self.console.borrow_mut().begin(reading, form, source.size());
        let mut portions = source.portions();
        let mut told_at = 0.0;
        while let Some((text, weight)) = portions.next().await? {
            if self.reading.get() != reading {
                return Ok(());
            }
            if let Some(desk) = self.console.borrow_mut().text_mut() {
                desk.push(&text, weight);
            }
            if milliseconds() - told_at > NEWS_PERIOD {
                self.tell();
                told_at = milliseconds();
            }
            turn().await;
        }
        if self.reading.get() == reading {
            if let Some(desk) = self.console.borrow_mut().text_mut() {
                desk.finish();
            }
            self.tell();
            self.work();
        }
        Ok(())
    }

    /// Counts and sifts until all is done, listening in between.
    fn work(self: &Rc<Self>) {
        if self.working.replace(true) {
            return;
        }
        let analyst = Rc::clone(self);
        spawn_local(async move {
            let mut told_at = milliseconds();
            while analyst.work_a_while() {
                if milliseconds() - told_at > NEWS_PERIOD {
                    analyst.tell();
                    told_at = milliseconds();
                }
                turn().await;
            }
            analyst.working.set(false);
            analyst.tell();
            let statistics = analyst.console.borrow().desk().statistics();
            if let Some(statistics) = statistics {
                post(&FromAnalyst::Statistics(statistics));
            }
        });
    }

    /// Whether there is more to do.
    fn work_a_while(&self) -> bool {
        let begun = milliseconds();
        let mut console = self.console.borrow_mut();
        while console.desk_mut().work(ENTRIES) {
            if milliseconds() - begun > PATIENCE {
                return true;
            }
        }
        false
    }

    fn tell(&self) {
        post(&FromAnalyst::Progress(self.console.borrow().progress()));
    }

    fn export(&self, format: Format) {
        let parts = Array::new();
        self.console.borrow().desk().export(format, |part| {
            parts.push(&Uint8Array::from(part));
        });
        let kind = match format {
            Format::JsonLines => "application/jsonl",
            Format::Csv => "text/csv",
            Format::Hex | Format::Text | Format::Session => "text/plain",
            Format::Pcap => "application/vnd.tcpdump.pcap",
        };
        post_with(&FromAnalyst::Exported(format), &scope::blob(&parts, kind));
    }
}
