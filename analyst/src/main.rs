//! The analyst's worker: takes texts and files in, gives rows and counts out. Between two portions it listens, so that a
//! list can be looked at and a reading be stopped while it goes on.

mod scope;
mod source;

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use buslens_analyst::Desk;
use buslens_analyst::message::{Format, FromAnalyst, Sums, ToAnalyst};
use js_sys::{Array, Uint8Array};
use wasm_bindgen::JsValue;
use wasm_bindgen_futures::spawn_local;

use scope::{milliseconds, post, post_with, turn};
use source::Source;

/// Entries that are counted or sifted before the worker listens again.
const ENTRIES: usize = 8192;
/// Nobody reads progress faster, in milliseconds.
const NEWS_PERIOD: f64 = 60.0;

fn main() {
    std::panic::set_hook(Box::new(|info| post(&FromAnalyst::Panicked(info.to_string()))));
    let analyst = Rc::new(Analyst { desk: RefCell::default(), reading: Cell::new(0), working: Cell::new(false) });
    scope::on_message(move |message, beside| analyst.hear(message, beside));
}

struct Analyst {
    desk: RefCell<Desk>,
    /// The reading that is wanted; an older one stops by itself.
    reading: Cell<u32>,
    working: Cell<bool>,
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
                self.desk.borrow_mut().cancel();
                self.tell();
                self.work();
            }
            ToAnalyst::Profile(choice) => {
                self.desk.borrow_mut().choose(choice);
                self.tell();
                self.work();
            }
            ToAnalyst::Filter(filter) => {
                self.desk.borrow_mut().set_filter(filter);
                self.work();
            }
            ToAnalyst::Rows { from, count } => {
                let rows = self.desk.borrow().rows(from, count);
                post(&FromAnalyst::Rows(rows));
            }
            ToAnalyst::Look { index, shown } => {
                let look = self.desk.borrow().look(index, &shown);
                post(&FromAnalyst::Look(look));
            }
            ToAnalyst::Export(format) => self.export(format),
            ToAnalyst::Sums(text) => {
                let sums = Sums::of(&text);
                post(&FromAnalyst::Sums(text, sums));
            }
            ToAnalyst::Forget => spawn_local(source::forget()),
            ToAnalyst::Console(_) => {}
        }
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
        self.desk.borrow_mut().begin(reading, form, source.size());
        let mut portions = source.portions();
        let mut told_at = 0.0;
        while let Some((text, weight)) = portions.next().await? {
            if self.reading.get() != reading {
                return Ok(());
            }
            self.desk.borrow_mut().push(&text, weight);
            if milliseconds() - told_at > NEWS_PERIOD {
                self.tell();
                told_at = milliseconds();
            }
            turn().await;
        }
        if self.reading.get() == reading {
            self.desk.borrow_mut().finish();
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
            while analyst.desk.borrow_mut().work(ENTRIES) {
                if milliseconds() - told_at > NEWS_PERIOD {
                    analyst.tell();
                    told_at = milliseconds();
                }
                turn().await;
            }
            analyst.working.set(false);
            analyst.tell();
            let statistics = analyst.desk.borrow().statistics();
            if let Some(statistics) = statistics {
                post(&FromAnalyst::Statistics(statistics));
            }
        });
    }

    fn tell(&self) {
        post(&FromAnalyst::Progress(self.desk.borrow().progress()));
    }

    fn export(&self, format: Format) {
        let parts = Array::new();
        self.desk.borrow().export(format, |part| {
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
