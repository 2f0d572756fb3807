//! Reading of recordings: 200 000 JointState messages of three joints from an MCAP in zstd chunks, beside the bare `mcap`
//! crate, which takes the messages out and does not look into them; a million numbers from a CSV, beside the
//! `csv` crate, which takes the cells apart and does not look into them either.

mod paper;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use frfid::files::{Log, LogMap, Overwrite, RunFile, Signal, read_log, write_run};
use frfid::signals::{Injection, InputKind, Record, RunId};
use mcap::{Compression, MessageStream, WriteOptions};
use ndarray::Array2;
use tempfile::TempDir;

const MESSAGES: usize = 200_000;
const ROWS: usize = 100_000;
const COLUMNS: usize = 10;

/// One topic of JointState in the chunks that the `mcap` crate makes by itself.
fn write_mcap(path: &Path) {
    let run = path.with_extension("run");
    write_three_joints(&run);
    let bytes = std::fs::read(&run).expect("there");
    let file = std::fs::File::create(path).expect("room for the recording");
    let options = WriteOptions::new().compression(Some(Compression::Zstd));
    let mut writer = options.create(file).expect("an MCAP");
    for message in MessageStream::new(&bytes).expect("an MCAP") {
        let message = message.expect("sound");
        if message.channel.topic == "/joint_states" {
            writer.write(&message).expect("room");
        }
    }
    writer.finish().expect("room");
}

/// A run of three joints as frfid writes it.
fn write_three_joints(path: &Path) {
    let phase = |joint: usize, k: usize| 1e-3 * (k * (joint + 1)) as f64;
    let record = Record {
        sample_time_s: 1e-3,
        u: Array2::from_shape_fn((3, MESSAGES), |(joint, k)| phase(joint, k).cos()),
        y: Array2::from_shape_fn((3, MESSAGES), |(joint, k)| phase(joint, k).sin()),
        r: None,
        position_rad: None,
        input_kind: InputKind::Measured,
        events: Vec::new(),
    };
    let file = RunFile {
        joint_names: ["j1", "j2", "j3"].map(str::to_owned).to_vec(),
        run: RunId::excitation(0, 0, 0),
        injection: Injection::Torque,
        record,
        metadata: BTreeMap::new(),
        experiment_toml: String::new(),
    };
    write_run(path, Overwrite::Refuse, &file).expect("room for the recording");
}

fn map() -> LogMap {
    let signal = |field: &str, joint: usize, unit| {
        Signal::of(&format!("/joint_states:{field}[j{joint}]"), unit)
    };
    let u = (1..=3)
        .map(|joint| signal("effort", joint, "N m"))
        .collect();
    let y = (1..=3)
        .map(|joint| signal("velocity", joint, "rad/s"))
        .collect();
    LogMap::new(u, y)
}

fn read(path: &Path, map: &LogMap, n_samples: usize) -> Log {
    let log = read_log(path, map).expect("sound");
    assert_eq!(log.record.n_samples(), n_samples);
    assert!(log.losses.is_empty());
    log
}

fn bare_mcap(path: &Path) -> usize {
    let bytes = std::fs::read(path).expect("there");
    let messages = MessageStream::new(&bytes).expect("an MCAP");
    messages
        .map(|message| message.expect("sound").data.len())
        .sum()
}

fn table() -> String {
    let mut text = String::from("t");
    for column in 1..COLUMNS {
        let _ = write!(text, ",c{column}");
    }
    for k in 0..ROWS {
        let _ = write!(text, "\n{:.3}", 1e-3 * k as f64);
        for column in 1..COLUMNS {
            let _ = write!(text, ",{:.9}", (1e-3 * (k * column) as f64).sin());
        }
    }
    text + "\n"
}

fn table_map() -> LogMap {
    let signal = |column: usize| Signal::of(&format!("c{column}"), "1");
    let y = (2..COLUMNS).map(signal).collect();
    LogMap {
        time: Some(Signal::of("t", "s")),
        ..LogMap::new(vec![signal(1)], y)
    }
}

fn bare_csv(path: &Path) -> usize {
    let mut reader = csv::Reader::from_path(path).expect("there");
    let mut row = csv::ByteRecord::new();
    let mut n_cells = 0;
    while reader.read_byte_record(&mut row).expect("sound") {
        n_cells += row.len();
    }
    n_cells
}

fn reading(criterion: &mut Criterion) {
    let folder = TempDir::new().expect("a folder for the recordings");
    let (bag, csv) = (
        folder.path().join("bench.mcap"),
        folder.path().join("bench.csv"),
    );
    write_mcap(&bag);
    std::fs::write(&csv, table()).expect("room for the table");
    let mut group = criterion.benchmark_group("reading");
    group.throughput(Throughput::Elements(MESSAGES as u64));
    group.bench_function("read_log, MCAP", |bencher| {
        bencher.iter(|| read(black_box(&bag), &map(), MESSAGES));
    });
    group.bench_function("mcap alone", |bencher| {
        bencher.iter(|| bare_mcap(black_box(&bag)));
    });
    group.throughput(Throughput::Elements((ROWS * COLUMNS) as u64));
    group.bench_function("read_log, CSV", |bencher| {
        bencher.iter(|| read(black_box(&csv), &table_map(), ROWS));
    });
    group.bench_function("csv alone", |bencher| {
        bencher.iter(|| bare_csv(black_box(&csv)));
    });
    group.finish();
}

criterion_group! { name = benches; config = paper::criterion(); targets = reading }
criterion_main!(benches);
