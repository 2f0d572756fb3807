//! Reading of recordings: 200 000 JointState messages of three joints from an MCAP in zstd chunks, beside the bare `mcap`
//! crate, which takes the messages out and does not look into them; a million numbers from a CSV, beside the
//! `csv` crate, which takes the cells apart and does not look into them either.

mod paper;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use frfid::files::{Log, LogMap, Signal, read_log};
use mcap::records::MessageHeader;
use mcap::{MessageStream, WriteOptions, Writer};
use tempfile::TempDir;

const MESSAGES: usize = 200_000;
const ROWS: usize = 100_000;
const COLUMNS: usize = 10;

const JOINT_STATE: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// A message of three joints, little endian.
fn message(k: usize, time_ns: u64) -> Vec<u8> {
    let mut body: Vec<u8> = Vec::new();
    body.extend(((time_ns / 1_000_000_000) as i32).to_le_bytes());
    body.extend(((time_ns % 1_000_000_000) as u32).to_le_bytes());
    body.extend([1, 0, 0, 0, 0, 0, 0, 0]); // an empty frame, padded
    body.extend(3_u32.to_le_bytes());
    for name in ["j1", "j2", "j3"] {
        body.extend(3_u32.to_le_bytes());
        body.extend(name.as_bytes());
        body.extend([0, 0]); // closed, padded
    }
    for array in 0..3 {
        body.extend(3_u32.to_le_bytes());
        body.resize(body.len().next_multiple_of(8), 0);
        for joint in 0..3 {
            let phase = 1e-3 * (k * (joint + 1)) as f64 + f64::from(array);
            body.extend(phase.sin().to_le_bytes());
        }
    }
    [&[0, 1, 0, 0], &body[..]].concat()
}

fn write_mcap(path: &Path) {
    let file = std::fs::File::create(path).expect("room for the recording");
    let options = WriteOptions::new().compression(Some(mcap::Compression::Zstd));
    let mut writer: Writer<_> = options.create(file).expect("an MCAP");
    let schema = writer.add_schema(
        "sensor_msgs/msg/JointState",
        "ros2msg",
        JOINT_STATE.as_bytes(),
    );
    let channel = writer.add_channel(
        schema.expect("room"),
        "/joint_states",
        "cdr",
        &BTreeMap::new(),
    );
    let channel_id = channel.expect("room");
    for k in 0..MESSAGES {
        let log_time = 1_700_000_000_000_000_000 + 1_000_000 * k as u64;
        let header = MessageHeader {
            channel_id,
            sequence: k as u32,
            log_time,
            publish_time: log_time,
        };
        writer
            .write_to_known_channel(&header, &message(k, log_time))
            .expect("room");
    }
    writer.finish().expect("room");
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
