//! Criterion's measurement of the same contenders on streams of 1 MB, and of designs of the CRC on frames of common sizes.

use std::hint::black_box;
use std::time::Duration;

use buslens_bench::contenders::Contender;
use buslens_bench::streams::{Kind, stream};
use buslens_codec::check::crc16;
use crc::{CRC_16_MODBUS, Crc, Table};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

fn streams(criterion: &mut Criterion) {
    for kind in Kind::ALL {
        let stream = stream(kind, 1_000_000);
        let mut group = criterion.benchmark_group(kind.name());
        group.sample_size(20).throughput(Throughput::Elements(stream.frames as u64));
        for contender in Contender::ALL {
            if contender.run(&stream).is_some() {
                group.bench_function(contender.name(), |bench| bench.iter(|| contender.run(black_box(&stream))));
            }
        }
    }
}

fn crcs(criterion: &mut Criterion) {
    const ONE: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_MODBUS);
    const SIXTEEN: Crc<u16, Table<16>> = Crc::<u16, Table<16>>::new(&CRC_16_MODBUS);
    let mut group = criterion.benchmark_group("crc");
    for len in [8usize, 15, 25, 256] {
        let frame: Vec<u8> = (0..=255).cycle().take(len).collect();
        group.sample_size(20).throughput(Throughput::Bytes(len as u64));
        let mut of = |name: &str, crc: &dyn Fn(&[u8]) -> u16| {
            group.bench_function(BenchmarkId::new(name, len), |bench| bench.iter(|| crc(black_box(&frame))));
        };
        of("ours", &crc16);
        of("crc, 1 table", &|frame| ONE.checksum(frame));
        of("crc, 16 tables", &|frame| SIXTEEN.checksum(frame));
    }
}

/// Short, for a machine that does other things too: the ratios matter, and `ratios` measures them in turns.
fn quick() -> Criterion {
    Criterion::default().warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2))
}

criterion_group! { name = benches; config = quick(); targets = streams, crcs }
criterion_main!(benches);
