//! Time as recorders write it: two clocks, stamps from 0, topics and columns with rows of their own,
//! times in ns, headers behind a comment mark, damage.

use npyz::WriterBuilder;

use super::*;
use crate::ros::cdr_write::CdrWriter;
use crate::ros::joint_state::JOINT_STATE;

/// A bag in memory.
struct Bag {
    mcap: mcap::Writer<mcap::write::NoSeek<std::io::Cursor<Vec<u8>>>>,
}

impl Bag {
    fn new() -> Self {
        let file = mcap::write::NoSeek::new(std::io::Cursor::new(Vec::new()));
        let options = crate::mcap::write::options().chunk_size(Some(4096));
        Self {
            mcap: options.create(file).expect("memory"),
        }
    }

    fn topic(&mut self, name: &str, definition: &str) -> u16 {
        let schema = self
            .mcap
            .add_schema("t/msg/T", "ros2msg", definition.as_bytes())
            .expect("memory");
        self.mcap
            .add_channel(schema, name, "cdr", &Default::default())
            .expect("memory")
    }

    fn write(&mut self, channel_id: u16, log_ns: u64, payload: &[u8]) {
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: 0,
            log_time: log_ns,
            publish_time: log_ns,
        };
        self.mcap
            .write_to_known_channel(&header, payload)
            .expect("memory");
    }

    /// A message of one joint: velocity k, effort -k.
    fn joint(&mut self, topic: u16, (log_ns, stamp_ns): (u64, u64), joint: &str, k: usize) {
        let state = JointState {
            stamp_ns,
            velocity: vec![k as f64],
            effort: vec![-(k as f64)],
            ..Default::default()
        };
        let mut cdr = CdrWriter::default();
        state.encode(&[joint.to_owned()], &mut cdr);
        self.write(topic, log_ns, cdr.bytes());
    }

    fn bytes(mut self) -> Vec<u8> {
        self.mcap.finish().expect("memory");
        self.mcap.into_inner().into_inner().into_inner()
    }
}

const MS: u64 = 1_000_000;

fn read(name: &str, bytes: &[u8], map: &LogMap) -> Result<Log, FileError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("written");
    read_log(&path, map)
}

fn joints(u: &str, y: &str) -> LogMap {
    map(
        &format!("/joint_states:effort[{u}]"),
        &format!("/joint_states:velocity[{y}]"),
    )
}

/// What was said of a log that must be sound.
fn told(log: &Log) -> String {
    let losses: Vec<_> = log.losses.iter().map(ToString::to_string).collect();
    format!("{} {}", log.warnings.join("; "), losses.join("; "))
}

#[test]
fn messages_without_the_joint_are_no_samples() {
    let mut bag = Bag::new();
    let topic = bag.topic("/joint_states", JOINT_STATE.definition);
    for k in 0..2000 {
        let stamp = 5_000 * MS + k as u64 * MS;
        bag.joint(topic, (stamp, stamp), "elbow", k);
        if k % 20 == 7 {
            bag.joint(topic, (stamp, stamp + 300_000), "finger", 9999);
        }
    }
    let log = read("a.mcap", &bag.bytes(), &joints("elbow", "elbow")).expect("the arm alone");
    assert_eq!(told(&log), " ");
    assert_eq!((log.record.n_samples(), log.clock.n_lost), (2000, 0));
    assert_eq!((log.record.u[[0, 1999]], log.times_s), (-1999.0, None));
}

#[test]
fn two_arms_on_one_topic_are_paired_by_cycle() {
    let mut bag = Bag::new();
    let topic = bag.topic("/joint_states", JOINT_STATE.definition);
    for k in 0..500 {
        let stamp = 5_000 * MS + k as u64 * MS;
        bag.joint(topic, (stamp, stamp), "left", k);
        bag.joint(topic, (stamp, stamp + 40_000), "right", k);
    }
    let log = read("a.mcap", &bag.bytes(), &joints("left", "right")).expect("both");
    assert_eq!((told(&log), log.record.n_samples()), (" ".into(), 500));
    assert!((0..500).all(|k| log.record.u[[0, k]] == -log.record.y[[0, k]]));
}

#[test]
fn no_message_with_the_joint_is_told() {
    let mut bag = Bag::new();
    let topic = bag.topic("/joint_states", JOINT_STATE.definition);
    (0..50).for_each(|k| bag.joint(topic, (k * MS, k * MS), "a", 0));
    let error = read("a.mcap", &bag.bytes(), &joints("b", "b")).expect_err("no b");
    assert!(
        error.to_string().contains("50 messages, none of which"),
        "{error}"
    );
}

#[test]
fn stamps_from_0_are_stamps_and_zeros_alone_are_none() {
    let bag = |stamp: fn(u64) -> u64| {
        let mut bag = Bag::new();
        let topic = bag.topic("/joint_states", JOINT_STATE.definition);
        for k in 0..800 {
            bag.joint(
                topic,
                (9_000 * MS + k * MS + k % 7, stamp(k)),
                "j",
                k as usize,
            );
        }
        read("a.mcap", &bag.bytes(), &joints("j", "j")).expect("sound")
    };
    let simulated = bag(|k| k * MS);
    assert_eq!(
        (told(&simulated), simulated.clock.jitter),
        (" ".into(), 0.0)
    );
    assert_eq!(simulated.record.n_samples(), 800);
    let unset = bag(|_| 0);
    assert_eq!(
        (unset.record.n_samples(), unset.two_clocks.is_none()),
        (800, true)
    );
    assert!(
        told(&unset).contains("no header stamps"),
        "{}",
        told(&unset)
    );
}

#[test]
fn a_command_without_header_is_on_another_clock() {
    let mut bag = Bag::new();
    let commands = bag.topic("/commands", "float64 data");
    let states = bag.topic("/joint_states", JOINT_STATE.definition);
    for k in 0..3000_u64 {
        let stamp = 5_000 * MS + k * MS;
        let late = 3 * MS + (k * 7919) % 100_000;
        let payload = [&[0, 1, 0, 0][..], &(k as f64).to_le_bytes()].concat();
        bag.write(commands, stamp + late, &payload);
        bag.joint(states, (stamp + 500_000, stamp), "j", k as usize);
    }
    let bag = bag.bytes();
    let two = map("/commands:data", "/joint_states:velocity[j]");
    let log = read("a.mcap", &bag, &two).expect("paired as well as can be");
    let told = told(&log);
    let two_clocks = log.two_clocks.expect("told");
    assert!(
        two_clocks.contains("two clocks: u (/commands)") && two_clocks.contains("3.6 deg at 10 Hz"),
        "{two_clocks}"
    );
    assert!(!told.contains("is stamped"), "{told}");
    assert!(
        told.contains("/commands has no header stamps") && told.contains("jitter"),
        "{told}"
    );
    // the reference's delay cancels
    let mut reference = joints("j", "j");
    reference.r = vec![signal("/commands:data", "A")];
    let log = read("a.mcap", &bag, &reference).expect("one clock for u and y");
    assert_eq!(log.two_clocks, None);
}

/// Simulated time beside the recorder's has nothing in common with it.
#[test]
fn clocks_of_other_days_are_named() {
    let mut bag = Bag::new();
    let commands = bag.topic("/commands", "float64 data");
    let states = bag.topic("/joint_states", JOINT_STATE.definition);
    for k in 0..100_u64 {
        let payload = [&[0, 1, 0, 0][..], &[0; 8]].concat();
        bag.write(commands, 1_700_000_000_000 * MS + k * MS, &payload);
        bag.joint(states, (1_700_000_000_000 * MS, k * MS), "j", k as usize);
    }
    let two = map("/commands:data", "/joint_states:velocity[j]");
    let error = read("a.mcap", &bag.bytes(), &two)
        .expect_err("no overlap")
        .to_string();
    assert!(
        error.contains("y (/joint_states) from 0.000 s to 0.099 s"),
        "{error}"
    );
}

/// Two topics with stamps of their own; the second `late_ns` behind.
fn two_topics(late_ns: u64, role: &str) -> Log {
    let mut bag = Bag::new();
    let (a, b) = (
        bag.topic("/joint_states", JOINT_STATE.definition),
        bag.topic("/b", JOINT_STATE.definition),
    );
    for k in 0..400 {
        let stamp = 5_000 * MS + k * MS;
        bag.joint(a, (stamp, stamp), "j", k as usize);
        bag.joint(
            b,
            (stamp, stamp + late_ns + (k * 7919) % 5000),
            "j",
            k as usize,
        );
    }
    let mut both = joints("j", "j");
    let other = vec![signal("/b:velocity[j]", "rad/s")];
    *(if role == "y" {
        &mut both.y
    } else {
        &mut both.r
    }) = other;
    read("a.mcap", &bag.bytes(), &both).expect("sound")
}

#[test]
fn delays_within_a_cycle_are_told_where_they_count() {
    for (late_ns, role, is_told) in [
        (40_000, "y", false),
        (90_000, "y", false),
        (300_000, "y", true),
        (300_000, "r", false),
    ] {
        let log = two_topics(late_ns, role);
        assert_eq!(
            told(&log).contains("is stamped 0.30"),
            is_told,
            "{}",
            told(&log)
        );
        assert!((0..log.record.n_samples()).all(|k| log.record.u[[0, k]] == -(k as f64)));
        let other = if role == "y" {
            &log.record.y
        } else {
            log.record.r.as_ref().expect("there")
        };
        assert!((0..log.record.n_samples()).all(|k| other[[0, k]] == k as f64));
    }
    assert!(told(&two_topics(300_000, "y")).contains("1.09 deg at 10 Hz"));
}

#[test]
fn a_file_without_sound_messages_says_why() {
    let mut bag = Bag::new();
    let topic = bag.topic("/joint_states", JOINT_STATE.definition);
    (0..30).for_each(|k| bag.joint(topic, (k * MS, k * MS), "j", 0));
    let mut bytes = bag.bytes();
    let chunk = bytes
        .windows(4)
        .position(|at| at == b"zstd")
        .expect("a chunk");
    bytes[chunk + 30..chunk + 60].fill(0x55);
    let error = read("a.mcap", &bytes, &joints("j", "j")).expect_err("no chunk left");
    let error = error.to_string();
    assert!(
        error.contains("no messages (the file is damaged: the chunk"),
        "{error}"
    );
}

fn timed(unit: &str) -> LogMap {
    LogMap {
        time: Some(signal("t", unit)),
        ..map("u", "y")
    }
}

/// A CSV of the columns t, u, y.
fn table(rows: impl Iterator<Item = (String, String, String)>) -> String {
    let lines = rows.map(|(t, u, y)| format!("{t},{u},{y}\n"));
    format!("t,u,y\n{}", lines.collect::<String>())
}

#[test]
fn columns_of_two_topics_are_paired_by_their_own_rows() {
    let rows = (0..1000).flat_map(|k| {
        let time = |late: u32| format!("{:.6}", 1e-3 * f64::from(k) + 1e-6 * f64::from(late));
        [
            (time(0), k.to_string(), String::new()),
            (time(200), String::new(), k.to_string()),
        ]
    });
    let log = csv(table(rows).as_bytes(), &timed("s")).expect("one rate");
    assert_eq!((log.record.n_samples(), log.losses.len()), (1000, 0));
    assert_eq!(log.record.u, log.record.y);
    assert!(
        told(&log).contains("y (y) is stamped 0.2000 ms after u (u)"),
        "{}",
        told(&log)
    );
}

#[test]
fn a_slow_command_is_refused_with_both_rates() {
    let rows = (0..1000).map(|k| {
        let command = if k % 4 == 0 {
            k.to_string()
        } else {
            String::new()
        };
        (
            format!("{:.3}", 1e-3 * f64::from(k)),
            command,
            k.to_string(),
        )
    });
    let error = csv(table(rows).as_bytes(), &timed("s")).expect_err("two rates");
    let error = error.to_string();
    assert!(
        error.contains("u (u) every 4 ms, y (y) every 1 ms, needed one rate"),
        "{error}"
    );
}

#[test]
fn lost_cells_are_no_other_clock() {
    let rows = (0..1000).map(|k| {
        let u = if k % 10 == 3 {
            String::new()
        } else {
            k.to_string()
        };
        (k.to_string(), u, k.to_string())
    });
    let log = csv(table(rows).as_bytes(), &timed("ms")).expect("usable");
    assert_eq!((log.record.n_samples(), log.losses.len()), (1000, 100));
    assert!(
        log.losses[0]
            .to_string()
            .contains("u 0.003 s to 0.004 s: 1 samples are not numbers")
    );
}

#[test]
fn times_in_ns_of_today_keep_their_digits() {
    let stamp = |k: i64| 1_425_315_906_000_000_000 + 1_000_000 * k + 37 * (k % 2);
    let rows = (0..200).map(|k| (stamp(k).to_string(), k.to_string(), k.to_string()));
    let log = csv(table(rows).as_bytes(), &timed("ns")).expect("even");
    assert!((log.clock.jitter - 18.5e-6).abs() < 1e-9, "{:?}", log.clock);
    let rows = (0..200).map(|k| {
        let (whole, fraction) = (stamp(k) / 1_000_000_000, stamp(k) % 1_000_000_000);
        (
            format!("{whole}.{fraction:09}"),
            k.to_string(),
            k.to_string(),
        )
    });
    let seconds = csv(table(rows).as_bytes(), &timed("s")).expect("even");
    assert_eq!(seconds.clock, log.clock);
}

fn add<T: npyz::AutoSerialize + Copy>(
    npz: &mut npyz::npz::NpzWriter<std::io::BufWriter<std::fs::File>>,
    name: &str,
    numbers: &[T],
) {
    let array = npz.array(name, Default::default()).expect("begun");
    let shape = [numbers.len() as u64];
    let mut writer = array
        .default_dtype()
        .shape(&shape)
        .begin_nd()
        .expect("begun");
    writer.extend(numbers.iter().copied()).expect("written");
    writer.finish().expect("written");
}

#[test]
fn integer_times_of_an_npz_keep_their_digits() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("log.npz");
    let mut npz = npyz::npz::NpzWriter::create(&path).expect("created");
    let stamp = |k: i64| 1_425_315_906_000_000_000 + 1_000_000 * k + 37 * (k % 2);
    let values: Vec<f64> = (0..200).map(f64::from).collect();
    for name in ["u", "y"] {
        add(&mut npz, name, &values);
    }
    add(&mut npz, "t", &(0..200).map(stamp).collect::<Vec<_>>());
    npz.zip_writer().finish().expect("written");
    let log = read_log(&path, &timed("ns")).expect("even");
    assert!((log.clock.jitter - 18.5e-6).abs() < 1e-9, "{:?}", log.clock);
}

#[test]
fn headers_behind_a_comment_mark() {
    for text in [
        "#t,u,y\n0,1,2\n1,3,4\n",
        "# t, u, y\n0,1,2\n1,3,4\n",
        "%t,u,y\n0,1,2\n1,3,4\n",
        "# made by hand, on Monday\nt,u,y\n# and a comment\n0,1,2\n1,3,4\n",
        "# made by hand\n\n# t,u,y\n# v1\n0,1,2\n1,3,4\n",
    ] {
        let log = csv(text.as_bytes(), &timed("ms")).expect(text);
        assert_eq!(log.record.y.row(0).to_vec(), [2.0, 4.0], "{text}");
    }
    let as_written = LogMap {
        time: Some(signal("%t", "ms")),
        ..map("u", "y")
    };
    assert!(csv(b"%t,u,y\n0,1,2\n1,3,4\n", &as_written).is_ok());
    let error = csv(b"# t,u,x\n0,1,2\n1,3,4\n", &timed("ms")).expect_err("no y");
    assert!(error.to_string().contains("one of t, u, x"), "{error}");
}

#[test]
fn rows_without_a_time_are_told() {
    let log = csv(b"t,u,y\n0,1,2\n,3,4\n2,5,6\nnan,3,4\n3,7,8\n", &timed("ms")).expect("usable");
    assert_eq!(log.record.n_samples(), 4);
    assert!(
        told(&log).contains("2 rows have no sample time, the first one in line 3"),
        "{}",
        told(&log)
    );
}

#[test]
fn a_stated_sample_time_stands_beside_times() {
    let rows = (0..4000).map(|k| ((k / 2).to_string(), k.to_string(), k.to_string()));
    let text = table(rows);
    let stated = LogMap {
        sample_time_s: Some(5e-4),
        ..timed("ms")
    };
    let log = csv(text.as_bytes(), &stated).expect("2 kHz in whole ms");
    assert_eq!(
        (log.record.sample_time_s, log.record.n_samples()),
        (5e-4, 4000)
    );
    assert!(
        told(&log).contains("stamps are in whole 1 ms, at 500 us"),
        "{}",
        told(&log)
    );
    let error = csv(text.as_bytes(), &timed("ms"))
        .expect_err("half of the rows repeat")
        .to_string();
    assert!(error.contains("state the sample time"), "{error}");
}

#[test]
fn true_sample_times_are_kept_where_they_are_uneven() {
    let time = |k: usize| 1e-3 * (k as f64 + 0.1 * (k as f64 * 2.3).sin());
    let kept = (0..1000).filter(|k| *k != 500);
    let rows = kept.map(|k| {
        (
            format!("{:.9}", 7.0 + time(k)),
            k.to_string(),
            k.to_string(),
        )
    });
    let log = csv(table(rows).as_bytes(), &timed("s")).expect("10 % of jitter");
    let times = log.times_s.as_ref().expect("uneven");
    assert_eq!((times.len(), times[0]), (1000, 0.0));
    let off = |k: usize| (times[k] - (time(k) - time(0))).abs();
    assert!((0..1000).filter(|k| *k != 500).all(|k| off(k) < 2e-9));
    assert!((times[500] - 0.5).abs() < 2e-5, "{}", times[500]);
    assert!((log.duration_s - 1.0).abs() < 1e-5 && log.clock.n_lost == 1);
    let rounded = (0..1000).map(|k| (((k * 5) / 4).to_string(), k.to_string(), k.to_string()));
    let log = csv(table(rounded).as_bytes(), &timed("ms")).expect("800 Hz");
    assert_eq!((log.times_s, log.clock.resolution_s), (None, Some(1e-3)));
    assert_eq!(
        log.warnings,
        ["rows: stamps are in whole 1 ms, at 1.25 ms for each sample: rounded; taken as even"]
    );
}
