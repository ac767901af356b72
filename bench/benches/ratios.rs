//! All contenders on the same streams in one run, and the ratios. `cargo bench -p buslens-bench --bench ratios`; a number
//! behind `--` limits the size of the streams in MB.

use std::hint::black_box;
use std::time::{Duration, Instant};

use buslens_bench::contenders::Contender;
use buslens_bench::streams::{Kind, Stream, stream};

const MB: usize = 1_000_000;

fn main() {
    let most = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(100);
    let sizes: Vec<usize> = [1, 10, 100].into_iter().filter(|size| *size <= most).collect();
    let mut rows = Vec::new();
    for &size in &sizes {
        for kind in Kind::ALL {
            let stream = stream(kind, size * MB);
            rows.extend(measure(&stream, size));
        }
    }
    print_table(&rows);
    print_ratios(&rows, &sizes);
}

struct Row {
    kind: Kind,
    size: usize,
    contender: Contender,
    bytes: usize,
    frames: usize,
    time: Duration,
}

impl Row {
    fn bytes_per_second(&self) -> f64 {
        number(self.bytes) / self.time.as_secs_f64()
    }

    fn frames_per_second(&self) -> f64 {
        number(self.frames) / self.time.as_secs_f64()
    }
}

/// The best of several rounds, in which all take turns: what else runs on the machine hits all alike.
fn measure(stream: &Stream, size: usize) -> Vec<Row> {
    let rounds = match size {
        1 => 25,
        10 => 9,
        _ => 7,
    };
    let mut rows: Vec<Row> = Vec::new();
    let mut first = None;
    for contender in Contender::ALL {
        let Some(tally) = contender.run(stream) else { continue };
        let wrong = tally.frames.abs_diff(stream.frames);
        // A check is right by chance once in 65536 tries: seldom where it matters, but in noise.
        let allowed = stream.frames / if stream.kind == Kind::Noisy { 1000 } else { 1_000_000 };
        assert!(wrong <= allowed, "{} finds {} of {}", contender.name(), tally.frames, stream.frames);
        if stream.kind != Kind::Noisy && contender != Contender::BareLoop {
            let first = *first.get_or_insert(tally);
            assert!(tally.frames != first.frames || tally.sum == first.sum, "{} reads other values", contender.name());
        }
        let Stream { kind, ref bytes, .. } = *stream;
        rows.push(Row { kind, size, contender, bytes: bytes.len(), frames: tally.frames, time: Duration::MAX });
    }
    for _ in 0..rounds {
        for row in &mut rows {
            let start = Instant::now();
            black_box(row.contender.run(black_box(stream)));
            row.time = row.time.min(start.elapsed());
        }
    }
    rows
}

fn print_table(rows: &[Row]) {
    println!("{:7} {:>6}  {:13} {:>9} {:>12} {:>10}", "stream", "MB", "by", "MB/s", "k frames/s", "buslens is");
    for row in rows {
        let ours = find(rows, row.kind, row.size, Contender::Buslens).expect("it takes every stream");
        println!(
            "{:7} {:>6}  {:13} {:>9.1} {:>12.0} {:>9.2}x",
            row.kind.name(),
            row.size,
            row.contender.name(),
            row.bytes_per_second() / number(MB),
            row.frames_per_second() / 1000.0,
            ours.frames_per_second() / row.frames_per_second(),
        );
    }
}

fn print_ratios(rows: &[Row], sizes: &[usize]) {
    let ours = |kind, size| find(rows, kind, size, Contender::Buslens);
    println!();
    for &size in sizes {
        let Some(clean) = ours(Kind::Clean, size) else { continue };
        for (peer, target) in [(Contender::Rmodbus, 4.0), (Contender::BareLoop, 0.5)] {
            if let Some(peer) = find(rows, Kind::Clean, size, peer) {
                let ratio = clean.frames_per_second() / peer.frames_per_second();
                verdict(
                    &format!("clean, {size} MB: frames/s of {}", peer.contender.name()),
                    ratio,
                    target,
                    ratio >= target,
                );
            }
        }
        if let Some(noisy) = ours(Kind::Noisy, size) {
            let ratio = clean.bytes_per_second() / noisy.bytes_per_second();
            verdict(&format!("noisy, {size} MB: time of clean"), ratio, 3.0, ratio <= 3.0);
        }
    }
    if sizes.contains(&100) {
        for kind in Kind::ALL {
            let ratio = growth(kind);
            verdict(&format!("{}: time of 100 MB to that of 10 MB", kind.name()), ratio, 10.5, ratio <= 10.5);
        }
    }
}

/// How much longer 100 MB take than 10 MB. Ten times 10 MB last as long as once 100 MB, so that both find a quiet moment of
/// the machine equally often.
fn growth(kind: Kind) -> f64 {
    let (ten, hundred) = (stream(kind, 10 * MB), stream(kind, 100 * MB));
    let time = |stream: &Stream, runs: u32| {
        let start = Instant::now();
        for _ in 0..runs {
            black_box(Contender::Buslens.run(black_box(stream)));
        }
        start.elapsed().as_secs_f64() / f64::from(runs)
    };
    let rounds = (0..9).map(|_| (time(&ten, 10), time(&hundred, 1)));
    let (ten, hundred) = rounds.fold((f64::MAX, f64::MAX), |best, now| (best.0.min(now.0), best.1.min(now.1)));
    hundred / ten
}

fn verdict(what: &str, ratio: f64, target: f64, holds: bool) {
    let word = if holds { "holds" } else { "FALLS SHORT" };
    println!("{what:44} {ratio:>7.2}x  (target {target}x) {word}");
}

fn find(rows: &[Row], kind: Kind, size: usize, contender: Contender) -> Option<&Row> {
    rows.iter().find(|row| (row.kind, row.size, row.contender) == (kind, size, contender))
}

/// Exact: all that is counted here is far below 2^53.
#[expect(clippy::cast_precision_loss, reason = "counts of bytes and frames")]
fn number(count: usize) -> f64 {
    count as f64
}
