//! Foreign recordings: the real ones where they are at hand, and small ones with every flaw that a
//! log can have.

mod time;

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::FileError;
use crate::log::map::{LogMap, Signal};
use crate::log::{Log, read_log};
use crate::mcap::chunk::Entry;
use crate::mcap::open::open_mcap;
use crate::mcap::read::{Part, scan};
use crate::mcap::write::RosWriter;
use crate::ros::definition;
use crate::ros::joint_state::JointState;
use crate::ros::value::decode;

/// Recordings of others that are read where they are; the test is skipped, visibly, where they are
/// not.
fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data")
        .join(name);
    if !path.exists() {
        eprintln!("SKIPPED: {} is not here", path.display());
    }
    path.exists().then_some(path)
}

fn signal(source: &str, unit: &str) -> Signal {
    Signal::of(source, unit)
}

fn map(u: &str, y: &str) -> LogMap {
    LogMap::new(vec![signal(u, "A")], vec![signal(y, "rad/s")])
}

/// The same measurement, once as published (CSV) and once as somebody else's writer wrapped it
/// (MCAP).
#[test]
fn the_motor_bench_is_the_same_from_csv_and_mcap() {
    let (Some(csv), Some(mcap)) = (
        shared("motor_bench/multisine_type_a.csv.gz"),
        shared("rosbags/motor_bench_a.mcap"),
    ) else {
        return;
    };
    let from_mcap = LogMap {
        r: vec![signal("/joint_commands:effort[0]", "A")],
        position: vec![signal("/joint_states:position[motor_joint]", "rad")],
        ..map(
            "/joint_states:effort[motor_joint]",
            "/joint_states:velocity[motor_joint]",
        )
    };
    let from_csv = LogMap {
        r: vec![signal("current_reference_A", "A")],
        position: vec![signal("motor_position_rad", "rad")],
        time: Some(signal("time_s", "s")),
        ..map("current_A", "motor_velocity_rad_per_s")
    };
    let csv = read_log(&csv, &from_csv).expect("sound");
    let mcap = read_log(&mcap, &from_mcap).expect("sound");
    assert_eq!(
        (csv.record.n_samples(), csv.record.sample_time_s),
        (50_000, 4e-4)
    );
    assert_eq!(csv.record, mcap.record);
    assert!(
        csv.losses.is_empty() && mcap.losses.is_empty(),
        "{:?}",
        mcap.losses
    );
    assert!(mcap.warnings.is_empty(), "{:?}", mcap.warnings);
    assert_eq!(csv.record.u[[0, 0]], 10.9882);
    assert_eq!(csv.output_units, ["rad/s"]);
}

#[test]
fn the_load_side_counts_the_other_way_round() {
    let (Some(csv), Some(mcap)) = (
        shared("motor_bench/multisine_type_a.csv.gz"),
        shared("rosbags/motor_bench_a.mcap"),
    ) else {
        return;
    };
    let mut columns = map("current_A", "load_velocity_rad_per_s");
    columns.time = Some(signal("time_s", "s"));
    columns.y[0].scale = -1.0;
    let topics = map(
        "/joint_states:effort[motor_joint]",
        "/joint_states:velocity[load_joint]",
    );
    let csv = read_log(&csv, &columns).expect("sound");
    assert_eq!(csv.record, read_log(&mcap, &topics).expect("sound").record);
}

#[test]
fn emps_has_no_velocity_and_says_so() {
    let Some(path) = shared("rosbags/emps.mcap") else {
        return;
    };
    let mut emps = map(
        "/joint_states:effort[slide_joint]",
        "/joint_states:position[slide_joint]",
    );
    emps.u[0].unit = "N".into();
    emps.y[0].unit = "m".into();
    let log = read_log(&path, &emps).expect("sound");
    assert_eq!(
        (log.record.n_samples(), log.record.sample_time_s),
        (24_841, 1e-3)
    );
    assert_eq!(
        (log.record.u[[0, 0]], log.record.y[[0, 0]]),
        (89.234_432_211_167_23, 7.45e-6)
    );
    let dead = map("/joint_states:effort[0]", "/joint_states:velocity[0]");
    assert!(
        matches!(read_log(&path, &dead), Err(FileError::Content { found, .. }) if found.contains("no number"))
    );
}

/// Every bag opens or is refused with words; none panics.
#[test]
fn the_bags_of_others_open_or_fail_cleanly() {
    for name in [
        "array_msgs_0",
        "base_msgs_0",
        "cdr_test_0",
        "only_topics",
        "talker",
        "wbag_0",
    ] {
        let Some(path) = shared(&format!("rosbags/{name}.mcap")) else {
            return;
        };
        let error = read_log(&path, &map("/nowhere:effort[0]", "/nowhere:velocity[0]"))
            .expect_err("not a log");
        assert!(error.to_string().contains("/nowhere"), "{error}");
    }
}

/// A JointState log of one joint; `edit` spoils the samples `(stamp in ns, velocity, effort)`.
fn log_of(edit: impl FnOnce(&mut Vec<(u64, f64, f64)>)) -> Result<Log, FileError> {
    let mut samples: Vec<_> = (1..=400_u32)
        .map(|k| (1_000_000 * u64::from(k), f64::from(k), -f64::from(k)))
        .collect();
    edit(&mut samples);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("log.mcap");
    let mut writer =
        RosWriter::new(std::fs::File::create(&path).expect("created")).expect("written");
    let mut topic = writer.joint_topic("/joint_states").expect("written");
    for (stamp_ns, velocity, effort) in samples {
        let state = JointState {
            stamp_ns,
            velocity: vec![velocity],
            effort: vec![effort],
            ..Default::default()
        };
        writer
            .joint_state(&mut topic, &["j".to_string()], &state)
            .expect("written");
    }
    writer.finish().expect("written");
    read_log(
        &path,
        &map("/joint_states:effort[j]", "/joint_states:velocity[j]"),
    )
}

#[test]
fn gaps_and_values_that_are_no_numbers_are_listed() {
    let log = log_of(|samples| {
        samples[10].1 = f64::NAN;
        samples.drain(100..120);
    });
    let log = log.expect("usable");
    assert_eq!(log.record.n_samples(), 400);
    let found: Vec<_> = log.losses.iter().map(ToString::to_string).collect();
    assert_eq!(
        found,
        [
            "/joint_states 0.1 s to 0.12 s: 20 samples are missing",
            "/joint_states:velocity[j] 0.01 s to 0.011 s: 1 samples are not numbers"
        ]
    );
    assert!(
        log.record.y[[0, 110]].is_nan()
            && log.record.y[[0, 120]] == 121.0
            && log.record.u[[0, 10]] == -11.0
    );
}

#[test]
fn duplicates_are_dropped_and_contradictions_refused() {
    let log = log_of(|samples| samples.insert(5, samples[5])).expect("usable");
    assert!(log.record.n_samples() == 400 && log.warnings[0].contains("twice"));
    let torn = log_of(|samples| samples.insert(5, (samples[5].0, 7.7, 7.7))).expect("usable");
    assert!(torn.record.n_samples() == 400 && torn.record.y[[0, 5]].is_nan());
    assert_eq!(
        torn.losses[0].to_string(),
        "/joint_states 0.005 s to 0.006 s: 1 samples have two messages of one stamp and different values"
    );
    let mixed = log_of(|samples| {
        for place in (10..390).step_by(20).rev() {
            samples.insert(place, (samples[place].0, 7.7, 7.7));
        }
    });
    let mixed = mixed.expect_err("refused").to_string();
    assert!(
        mixed.contains("19 stamps that are there twice with different values"),
        "{mixed}"
    );
    let swapped = log_of(|samples| samples.swap(7, 8)).expect("usable");
    assert!(swapped.warnings[0].contains("1 messages out of order"));
    assert_eq!((swapped.record.y[[0, 7]], swapped.losses.len()), (8.0, 0));
}

#[test]
fn jitter_is_told_or_refused() {
    let jittered = |share: f64| {
        log_of(move |samples| {
            for (k, sample) in samples.iter_mut().enumerate() {
                sample.0 += (1e6 * share * (1.0 + (k as f64 * 12.9898).sin())) as u64;
            }
        })
    };
    assert!(jittered(0.005).expect("usable").warnings.is_empty());
    assert!(jittered(0.05).expect("usable").warnings[0].contains("phase error"));
    assert!(
        jittered(0.45)
            .expect_err("refused")
            .to_string()
            .contains("does not resample")
    );
}

#[test]
fn two_topics_are_aligned_by_stamp_and_rates_must_agree() {
    let two = |from: u64, step: u64, late: u64| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("log.mcap");
        let mut writer =
            RosWriter::new(std::fs::File::create(&path).expect("created")).expect("written");
        let (mut a, mut b) = (
            writer.joint_topic("/a").expect("written"),
            writer.joint_topic("/b").expect("written"),
        );
        for k in 1..=100 {
            let state = |stamp_ns| JointState {
                stamp_ns,
                effort: vec![stamp_ns as f64],
                ..Default::default()
            };
            writer
                .joint_state(&mut a, &["j".to_string()], &state(1_000_000 * k))
                .expect("written");
            writer
                .joint_state(&mut b, &["j".to_string()], &state(step * (k + from) + late))
                .expect("written");
        }
        writer.finish().expect("written");
        read_log(&path, &map("/a:effort[0]", "/b:effort[0]"))
    };
    let log = two(3, 1_000_000, 120_000).expect("the overlap");
    assert_eq!(
        (
            log.record.n_samples(),
            log.record.u[[0, 0]],
            log.record.y[[0, 0]]
        ),
        (97, 4e6, 4.12e6)
    );
    assert!(
        log.warnings[0].contains("0.1200 ms after u (/a)"),
        "{:?}",
        log.warnings
    );
    assert!(
        two(0, 2_000_000, 0)
            .expect_err("other rate")
            .to_string()
            .contains("u (/a) every 1 ms, y (/b) every 2 ms")
    );
    assert!(
        two(500, 1_000_000, 0)
            .expect_err("no overlap")
            .to_string()
            .contains("no time that all topics cover")
    );
}

fn csv(text: &[u8], map: &LogMap) -> Result<Log, FileError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("log.csv");
    std::fs::write(&path, text).expect("written");
    read_log(&path, map)
}

#[test]
fn a_csv_with_flaws_is_told_line_by_line() {
    let columns = LogMap {
        time: Some(signal("t", "ms")),
        ..map("u", "y")
    };
    let log = csv(b"t;\"u\";y\r\n0;1;2\r\n1;3;4\r\n2;;6\r\n", &columns).expect("usable");
    assert_eq!(
        (log.record.sample_time_s, log.record.y[[0, 2]]),
        (1e-3, 6.0)
    );
    assert_eq!(log.losses.len(), 1);
    let counted = LogMap {
        time: None,
        sample_time_s: Some(0.5),
        ..columns.clone()
    };
    assert_eq!(
        csv(b"u,y\n1,2\n3,4", &counted)
            .expect("usable")
            .warnings
            .len(),
        1
    );
    let cut = csv(b"u,y\n1,2\n3,4\n5", &counted).expect("two rows");
    assert!(
        cut.record.n_samples() == 2 && cut.losses[0].reason.contains("breaks off in line 4"),
        "{:?}",
        cut.losses
    );
    for (text, told) in [
        (&b"t,u\n0,1\n"[..], "one of t, u"),
        (b"t,u,y\n0,1,2\n1,2\n", "line 3"),
        (b"t,u,y\n0,1,2\n1,x,2\n", "`x`"),
        (b"t,u,u,y\n0,1,2,3\n", "two of that name"),
        (b"", "no such column"),
        (b"t,u,y\n0,1,2\n", "at least 2"),
        (b"t,u,y\n0,1,2\n1,1,2\n1e300,1,2\n", "samples"),
        (b"t,u,y\n,1,2\n,1,2\n", "at least 2"),
    ] {
        let error = csv(text, &columns).expect_err("refused").to_string();
        assert!(error.contains(told), "{error}");
    }
    let wrong_unit = LogMap {
        y: vec![signal("y", "furlong")],
        ..columns
    };
    assert!(
        csv(b"t,u,y\n0,1,2\n1,1,2\n", &wrong_unit)
            .expect_err("refused")
            .to_string()
            .contains("deg/s")
    );
}

#[test]
fn a_cut_gzip_gives_what_is_there_and_says_so() {
    let mut text = String::from("u,y\n");
    for k in 0..5000 {
        text += &format!("{},{}\n", k, (f64::from(k)).sin());
    }
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    gzip.write_all(text.as_bytes()).expect("memory");
    let gzip = gzip.finish().expect("memory");
    let counted = LogMap {
        sample_time_s: Some(0.5),
        ..map("u", "y")
    };
    let log = csv(&gzip[..gzip.len() / 2], &counted).expect("the first half");
    let n = log.record.n_samples();
    assert!(
        n > 1000 && n < 4000 && log.losses[0].reason.contains("behind line"),
        "{n}"
    );
    assert!((0..n).all(|k| log.record.y[[0, k]] == (k as f64).sin()));
}

#[test]
fn other_encodings_are_named_with_the_way_out() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("log.mcap");
    for (schema, encoding, payload, told) in [
        ("ros1msg", "ros1", &[0_u8; 8][..], "rosbags-convert"),
        ("jsonschema", "json", b"{}", "CSV"),
        ("ros2msg", "cdr", &[0, 7, 0, 0, 0, 0, 0, 0], "XCDR2"),
    ] {
        let mut mcap = crate::mcap::write::options()
            .create(std::io::Cursor::new(Vec::new()))
            .expect("memory");
        let schema = mcap
            .add_schema("std_msgs/msg/Float64", schema, b"float64 data")
            .expect("memory");
        let channel = mcap
            .add_channel(schema, "/t", encoding, &Default::default())
            .expect("memory");
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: 1,
            publish_time: 1,
        };
        mcap.write_to_known_channel(&header, payload)
            .expect("memory");
        mcap.finish().expect("memory");
        std::fs::write(&path, mcap.into_inner().into_inner()).expect("written");
        let error = read_log(&path, &map("/t:data", "/t:data"))
            .expect_err("refused")
            .to_string();
        assert!(error.contains(told) && error.contains("/t"), "{error}");
    }
}

/// Every message in the bags of rosbag2's own tests is decoded to its last byte: every type, arrays
/// of messages, types without fields.
#[test]
fn the_messages_of_others_decode_to_their_last_byte() {
    let bags = [
        "array_msgs_0",
        "base_msgs_0",
        "cdr_test_0",
        "only_topics",
        "talker",
        "wbag_0",
    ];
    let mut decoded = 0;
    for name in bags {
        let Some(path) = shared(&format!("rosbags/{name}.mcap")) else {
            return;
        };
        let file = open_mcap(&path).expect("there");
        let damages = scan(file, &path, Part::All, &mut |entry| {
            let Entry::Message {
                channel,
                schema: Some(schema),
                message,
            } = entry
            else {
                return Ok(());
            };
            let definition =
                definition::parse(&String::from_utf8_lossy(&schema.text)).expect(&schema.name);
            decode(&definition, message.data).expect(&channel.topic);
            decoded += 1;
            Ok(())
        });
        assert_eq!(damages.expect("readable"), []);
    }
    assert_eq!(decoded, 1285);
}

#[test]
fn an_npz_is_read_by_arrays_and_rows() {
    let (Some(silverbox), Some(f16)) = (
        shared("silverbox/snls80mv.npz"),
        shared("f16/F16Data_FullMSine_Level1.npz"),
    ) else {
        return;
    };
    let counted = |u, y, sample_time_s| LogMap {
        sample_time_s: Some(sample_time_s),
        ..map(u, y)
    };
    let log = read_log(&silverbox, &counted("u", "y", 1.0 / 610.35)).expect("sound");
    assert_eq!(
        (log.record.n_samples(), log.record.sample_time_s),
        (131_072, 1.0 / 610.35)
    );
    assert!(
        log.losses.is_empty() && log.warnings.is_empty(),
        "{:?}",
        log.warnings
    );
    let log =
        read_log(&f16, &counted("force", "acceleration[2]", 0.0025)).expect("float32 in C order");
    assert_eq!(
        (log.record.n_samples(), log.record.sample_time_s),
        (73_728, 0.0025)
    );
    let error = read_log(&f16, &counted("force", "acceleration", 0.0025))
        .expect_err("three rows")
        .to_string();
    assert!(error.contains("[3, 73728]"), "{error}");
}

/// The same CSV under a name without an ending is unknown, an MCAP is known by its first bytes, and
/// a file of another kind is named.
#[test]
fn a_format_is_known_by_its_first_bytes_or_by_its_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let read = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        let map = LogMap {
            sample_time_s: Some(1e-3),
            ..map("u", "y")
        };
        read_log(&path, &map)
    };
    let csv = b"u,y\n1,2\n3,4\n";
    assert!(read("x.TXT", csv).is_ok());
    for (name, bytes, named) in [
        (
            "x.log",
            &csv[..],
            "frfid reads MCAP (.mcap), rosbag2 SQLite (.db3), CSV (.csv",
        ),
        ("x.db3", b"SQLite format 3\0", "topic:field"),
        ("x.mat", b"MATLAB 5.0 MAT-file, ...", "a MATLAB file"),
        (
            "x.mat",
            b"MATLAB 7.3 MAT-file, ...",
            "an undamaged MAT file",
        ),
        ("x", b"", "an empty file"),
        ("x.bin", b"PK\x03\x04", "NPZ"),
        ("x.csv", ::mcap::MAGIC, "topic"),
    ] {
        let error = read(name, bytes).expect_err(name).to_string();
        assert!(error.contains(named), "{name}: {error}");
    }
}
