//! Recording that frfid did not make: `read_log`, and the `look` at every signal of it, which should cost
//! less than a quarter.

mod paper;

use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use frfid::estimate::look;
use frfid::files::{Log, LogMap, Signal, read_log};
use frfid::signals::random::{normal, stream};
use frfid::signals::{Draw, Phasing};
use paper::{PERIOD, SAMPLE_TIME_S, multisine};
use tempfile::TempDir;

const PERIODS: usize = 20;

/// A table of time, torque and speed, as a logger writes it: nine digits, some noise.
fn table() -> String {
    let draw = Draw {
        seed: 1,
        realization: 0,
        phasing: Phasing::Orthogonal,
    };
    let period = multisine(vec![1.0]).realize(&draw).expect("sound").signal;
    let mut rng = stream(1, "bench", &[]);
    let mut text = "t,torque,speed\n".to_string();
    for k in 0..PERIODS * PERIOD {
        let (time, torque) = (k as f64 * SAMPLE_TIME_S, period[[0, 0, k % PERIOD]]);
        let speed = 0.5 * torque + 1e-3 * normal(&mut rng);
        writeln!(text, "{time:.3},{torque:.9},{speed:.9}").expect("a text takes all");
    }
    text
}

fn map() -> LogMap {
    let mut map = LogMap::new(
        vec![Signal::of("torque", "N m")],
        vec![Signal::of("speed", "rad/s")],
    );
    map.time = Some(Signal::of("t", "s"));
    map
}

fn read(path: &Path, map: &LogMap) -> Log {
    let log = read_log(path, map).expect("sound");
    assert_eq!(log.record.u.dim(), (1, PERIODS * PERIOD));
    log
}

/// Nothing is odd about a sound recording.
fn look_at(log: &Log) {
    let signals = [&log.record.u, &log.record.y];
    for signal in signals.iter().flat_map(|signal| signal.rows()) {
        assert_eq!(look(signal), []);
    }
}

fn recording(criterion: &mut Criterion) {
    let folder = TempDir::new().expect("a folder for the table");
    let path = folder.path().join("bench.csv");
    std::fs::write(&path, table()).expect("room for the table");
    let (map, log) = (map(), read(&path, &map()));
    let mut group = criterion.benchmark_group("recording of 245760 rows");
    group.bench_function("read_log, CSV", |bencher| {
        bencher.iter(|| read(black_box(&path), &map));
    });
    group.bench_function("look, input and output", |bencher| {
        bencher.iter(|| look_at(black_box(&log)));
    });
    group.finish();
}

criterion_group! { name = benches; config = paper::criterion(); targets = recording }
criterion_main!(benches);
