//! Tests of runs: bit for bit when all is well; cut, flipped and full disks when not.

use std::io::{self, Cursor, Write};
use std::path::Path;

use frfid_signals::{Event, EventKind, Injection, InputKind, Limit, Record, RunId, RunKind};
use ndarray::Array2;

use crate::atomic_write::Overwrite;
use crate::error::FileError;
use crate::loss::Loss;
use crate::run::read::{read_from, read_run};
use crate::run::write::{RunFile, write_run, write_to};

/// Values that show any rounding: signed zero, subnormals, the ends of the range, and noise of all
/// sizes.
fn signal(rows: usize, n: usize, salt: u64) -> Array2<f64> {
    let special = [
        -0.0,
        5e-324,
        f64::MAX,
        f64::MIN_POSITIVE,
        0.1 + 0.2,
        -1.0 / 3.0,
    ];
    Array2::from_shape_fn((rows, n), |(row, k)| match (row + k) % 9 {
        hit if hit < special.len() && k < 60 => special[hit],
        _ => {
            ((k as u64 * 2 + row as u64 + salt).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64
                * 1e-13
                - 300.0
        }
    })
}

pub(crate) fn run(n: usize) -> RunFile {
    let event = |time_s, kind| Event { time_s, kind };
    let limit = EventKind::Limit {
        channel: 1,
        limit: Limit::Torque,
        value: 0.1 + 0.2,
        allowed: 0.3,
    };
    RunFile {
        joint_names: vec!["axis_1".into(), "axis_2".into()],
        run: RunId {
            kind: RunKind::Excitation,
            realization: 3,
            experiment: 1,
            repetition: 2,
        },
        injection: Injection::Velocity,
        record: Record {
            sample_time_s: 1e-3,
            u: signal(2, n, 1),
            y: signal(2, n, 2),
            r: Some(signal(2, n, 3)),
            position_rad: Some(signal(2, n, 4)),
            input_kind: InputKind::Measured,
            events: vec![
                event(0.0, EventKind::PeriodStart { period: 0 }),
                event(1e-3 * (n / 2) as f64, EventKind::PeriodStart { period: 1 }),
                event(0.1 * n as f64, limit),
                event(
                    1.0 / 3.0 * n as f64,
                    EventKind::Stopped {
                        reason: "end \"of\" test ü".into(),
                        since_s: Some(0.25),
                    },
                ),
            ],
        },
        metadata: [("seed", "42"), ("frfid", "0.1.0")]
            .map(|(k, v)| (k.into(), v.into()))
            .into(),
        experiment_toml: "[robot]\nname = \"demo\"\n".into(),
    }
}

fn bytes(run: &RunFile) -> Vec<u8> {
    let mut file = Vec::new();
    write_to(&mut file, run).expect("memory does not fail");
    file
}

fn read(file: &[u8]) -> Result<(RunFile, Vec<Loss>), FileError> {
    read_from(Cursor::new(file), Path::new("run.mcap"))
}

/// Bits, so that -0.0 is not 0.0 and NaN equals itself.
fn bits(run: &RunFile) -> Vec<Vec<u64>> {
    let record = &run.record;
    let signals = [
        Some(&record.u),
        Some(&record.y),
        record.r.as_ref(),
        record.position_rad.as_ref(),
    ];
    signals
        .iter()
        .map(|signal| {
            signal
                .iter()
                .flat_map(|s| s.iter().map(|v| v.to_bits()))
                .collect()
        })
        .collect()
}

#[test]
fn a_run_comes_back_bit_for_bit() {
    for (kind, injection) in [
        (InputKind::Measured, Injection::Velocity),
        (InputKind::Commanded, Injection::Torque),
        (InputKind::Commanded, Injection::Velocity),
    ] {
        let mut written = run(3000);
        (written.record.input_kind, written.injection) = (kind, injection);
        let (read, losses) = read(&bytes(&written)).expect("sound");
        assert_eq!(losses, []);
        assert_eq!(bits(&read), bits(&written));
        assert_eq!(read, written);
        assert_eq!(bytes(&written), bytes(&written));
    }
}

#[test]
fn channels_may_be_fewer_than_joints_and_signals_may_be_absent() {
    let mut written = run(50);
    written.record = Record {
        u: signal(1, 50, 0),
        r: None,
        position_rad: None,
        events: vec![],
        ..written.record
    };
    assert_eq!(read(&bytes(&written)).expect("sound"), (written, vec![]));
}

/// Whatever is delivered from a damaged file is as it was written, or NaN; and where it is NaN, a
/// loss says so.
fn assert_honest(
    written: &RunFile,
    found: Result<(RunFile, Vec<Loss>), FileError>,
    what: &str,
) -> usize {
    let Ok((read, losses)) = found else { return 0 };
    assert!(
        !losses.is_empty() || read == *written,
        "{what}: damage without a word"
    );
    let mut kept = 0;
    for (original, delivered) in bits(written).iter().zip(bits(&read)) {
        assert_eq!(original.len(), delivered.len(), "{what}");
        for (original, delivered) in original.iter().zip(delivered) {
            let is_lost = f64::from_bits(delivered).is_nan();
            assert!(is_lost || delivered == *original, "{what}: a wrong number");
            assert!(
                !is_lost || losses.iter().any(|loss| loss.to_s > loss.from_s),
                "{what}: NaN without a loss"
            );
            kept += usize::from(!is_lost);
        }
    }
    assert_eq!(
        (read.run, &read.joint_names),
        (written.run, &written.joint_names),
        "{what}"
    );
    kept
}

#[test]
fn a_run_cut_anywhere_is_told_and_never_wrong() {
    let written = run(60);
    let file = bytes(&written);
    for length in 0..file.len() {
        let found = read(&file[..length]);
        assert!(
            found
                .as_ref()
                .map_or(true, |(_, losses)| !losses.is_empty()),
            "cut at {length} unnoticed"
        );
        assert_honest(&written, found, &format!("cut at {length}"));
    }
    assert_eq!(
        assert_honest(
            &written,
            read(&file[..file.len() - 40]),
            "cut in the footer"
        ),
        480
    );
}

#[test]
fn a_flipped_bit_is_told_and_never_wrong() {
    let written = run(60);
    let file = bytes(&written);
    for bit in (0..8 * file.len()).step_by(11) {
        let mut flipped = file.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let found = read(&flipped);
        assert_honest(
            &written,
            found,
            &format!("bit {} of byte {} of {}", bit % 8, bit / 8, file.len()),
        );
    }
}

#[test]
fn a_broken_chunk_costs_itself_only() {
    let written = run(6000);
    let mut file = bytes(&written);
    let middle = file.len() / 2;
    file[middle] ^= 4;
    let (read_back, losses) = read(&file).expect("the rest is sound");
    let kept = assert_honest(&written, Ok((read_back, losses.clone())), "middle");
    assert!(
        kept > 8 * 6000 * 8 / 10 && kept < 8 * 6000,
        "{kept} of {} values kept",
        8 * 6000
    );
    assert!(
        losses
            .iter()
            .any(|loss| loss.reason.contains("Chunk CRC failed")
                || loss.reason.contains("ecompress"))
    );
    let states: Vec<_> = losses
        .iter()
        .filter(|loss| loss.topic == "/joint_states")
        .collect();
    assert!(
        states.len() == 1 && states[0].from_s > 1.0 && states[0].to_s < 5.0,
        "{losses:?}"
    );
}

/// Fails at the n-th write and ever after, as a full disk does.
struct FullDisk {
    kept: Vec<u8>,
    writes_left: usize,
}

impl Write for FullDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writes_left = self
            .writes_left
            .checked_sub(1)
            .ok_or(io::ErrorKind::StorageFull)?;
        self.kept.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_disk_that_fills_up_at_any_write_is_told_and_keeps_what_was_written() {
    let written = run(600);
    for writes_left in 0.. {
        let mut disk = FullDisk {
            kept: vec![],
            writes_left,
        };
        let result = write_to(&mut disk, &written);
        if result.is_ok() {
            assert!(writes_left > 20);
            break;
        }
        let error = result.expect_err("the disk is full");
        assert!(
            crate::error::chain(&error).contains("no storage space"),
            "{}",
            crate::error::chain(&error)
        );
        let found = read(&disk.kept);
        assert_honest(&written, found, &format!("full after {writes_left} writes"));
    }
}

#[test]
fn a_finished_period_survives_the_process() {
    let written = run(3000);
    let file = bytes(&written);
    // the second period begins with a chunk of its own: cut shortly behind its head
    let heads: Vec<usize> = (8..file.len())
        .filter(|&k| record_starts(&file).contains(&k) && file[k] == 6)
        .collect();
    let kept: Vec<usize> = heads
        .iter()
        .map(|&head| assert_honest(&written, read(&file[..head + 60]), "cut in a chunk"))
        .collect();
    assert!(kept.contains(&(8 * 1500)), "{kept:?}");
}

fn record_starts(file: &[u8]) -> Vec<usize> {
    let mut starts = vec![8];
    while let Some(&last) = starts.last() {
        let Some(head) = file.get(last..last + 9) else {
            break;
        };
        let size = u64::from_le_bytes(std::array::from_fn(|k| head[1 + k])) as usize;
        starts.push(last + 9 + size);
    }
    starts
}

#[test]
fn what_does_not_fit_is_refused_before_the_file_is_touched() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("run.mcap");
    let twins = RunFile {
        joint_names: vec!["a".into(), "a".into()],
        ..run(10)
    };
    let mut ragged = run(10);
    ragged.record.y = signal(2, 9, 0);
    let mut too_fast = run(10);
    too_fast.record.sample_time_s = 1e-10;
    let missing_name = RunFile {
        joint_names: vec!["a".into()],
        ..run(10)
    };
    for bad in [twins, ragged, too_fast, missing_name] {
        assert!(matches!(
            write_run(&path, Overwrite::Refuse, &bad),
            Err(FileError::Shape { .. })
        ));
    }
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("readable").count(),
        0
    );
    write_run(&path, Overwrite::Refuse, &run(10)).expect("sound");
    assert_eq!(read_run(&path).expect("sound"), (run(10), vec![]));
}
