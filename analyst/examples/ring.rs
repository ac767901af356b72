//! How fast a live log takes notes in, and how much memory it takes: `cargo run --release -p buslens-analyst --example ring`.

use std::time::Instant;

use buslens_analyst::Desk;
use buslens_analyst::message::{Filter, Format};
use buslens_bus::record::{Event, Note, Origin, What};
use buslens_codec::UnitId;
use buslens_codec::line::{LineSettings, Mode, Parity};
use buslens_codec::pdu::{Request, Response};
use buslens_codec::rtu;

/// Exchanges, each of a request and a reply.
const EXCHANGES: u32 = 1_000_000;
/// Exchanges between two looks at the clock.
const BLOCK: usize = 125;

fn frame(pdu: &[u8]) -> Vec<u8> {
    rtu::encode(UnitId(1), pdu).expect("a PDU fits a frame")
}

/// A poll of two registers at `at_us`, its reply in one chunk.
fn exchange(at_us: u64, value: u16) -> [Note; 2] {
    let request = Request::ReadHoldingRegisters { address: 2, quantity: 2 };
    let reply = Response::ReadHoldingRegisters { values: vec![value, !value] };
    let sent = What::Sent { origin: Origin::Poll, bytes: frame(&request.encode().expect("a request")) };
    let received = What::Received(frame(&reply.encode().expect("a reply")));
    [Note { at_us, what: sent }, Note { at_us: at_us + 100, what: received }]
}

/// Seconds for which this thread has had a processor: other programs' share does not count. Elsewhere than on Linux the
/// time that has passed.
fn seconds(begin: Instant) -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanos = told.and_then(|told| told.split(' ').next()?.parse::<f64>().ok());
    nanos.map_or_else(|| begin.elapsed().as_secs_f64(), |nanos| nanos / 1e9)
}

fn run(name: &str, portion: usize, filter: &Filter) -> Desk {
    let mut desk = Desk::live(0);
    desk.set_filter(filter.clone());
    let line = LineSettings::new(1_000_000, Parity::None);
    desk.record(&[Note { at_us: 0, what: What::Port(Event::Opened(line, Mode::Rtu)) }]);
    let (clock, mut spent, mut longest) = (Instant::now(), 0.0_f64, 0.0_f64);
    let numbers: Vec<u32> = (0..EXCHANGES).collect();
    for block in numbers.chunks(BLOCK) {
        let value = |number: u32| u16::try_from(number % 65_536).unwrap_or(0);
        let notes: Vec<Note> =
            block.iter().flat_map(|number| exchange(200 * u64::from(*number), value(*number))).collect();
        let begin = seconds(clock);
        for some in notes.chunks(portion) {
            desk.record(some);
        }
        let took = seconds(clock) - begin;
        (spent, longest) = (spent + took, longest.max(took));
    }
    let entries = 2.0 * f64::from(EXCHANGES);
    let footprint = u32::try_from(desk.footprint()).map_or(f64::INFINITY, f64::from);
    let progress = desk.progress();
    println!(
        "{name}: {:.2} M entries/s, {:.2} % of a core at 10 000 frames/s, the slowest {} entries in {:.2} ms; \
         {} kept, {} shown, {:.1} bytes an entry, {:.1} MB",
        entries / spent / 1e6,
        spent / entries * 1e6,
        2 * BLOCK,
        longest * 1e3,
        progress.entries,
        progress.shown,
        footprint / f64::from(progress.entries),
        footprint / 1e6
    );
    desk
}

fn main() {
    let errors = Filter { errors_only: true, ..Filter::default() };
    let desk = run("one by one", 1, &Filter::default());
    run("in batches of 250", 250, &Filter::default());
    run("errors only", 250, &errors);
    run("text", 250, &Filter { text: "12 34".to_owned(), ..Filter::default() });
    for format in [Format::Text, Format::JsonLines, Format::Csv, Format::Pcap, Format::Session] {
        let (clock, mut size) = (Instant::now(), 0);
        let begin = seconds(clock);
        desk.export(format, |part| size += part.len());
        println!(
            "{format:?}: {:.1} MB in {:.2} s",
            f64::from(u32::try_from(size).unwrap_or(0)) / 1e6,
            seconds(clock) - begin
        );
    }
}
