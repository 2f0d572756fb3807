//! Recordings of others cut, flipped and with sizes that are not theirs: read or refused, soon and in little memory.

use std::io::Write;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;
use proptest::prelude::*;
use rusqlite::Connection;

use crate::hostile_tests::alone::{address_space, alone};
use crate::log::listing::list_recording;
use crate::log::map::{LogMap, Signal};
use crate::log::read_log;
use crate::ros::cdr_write::CdrWriter;
use crate::ros::joint_state::JointState;

/// No damaged file of some 10 kB takes longer,
const LONGEST: Duration = Duration::from_secs(20);
/// nor may all of them together take more address space than this.
const MOST_MEMORY: u64 = 1 << 30;

/// A sound recording and its map.
struct Sound {
    ending: &'static str,
    bytes: Vec<u8>,
    map: LogMap,
}

impl Sound {
    fn of(ending: &'static str, bytes: Vec<u8>, [time, u, y]: [&str; 3]) -> Self {
        let time = (!time.is_empty()).then(|| Signal::of(time, "s"));
        let map = LogMap {
            time,
            ..LogMap::new(vec![Signal::of(u, "1")], vec![Signal::of(y, "1")])
        };
        Self { ending, bytes, map }
    }

    /// Reads and lists bytes in place of its own; returns whether they are a recording.
    fn replay(&self, bytes: &[u8]) -> bool {
        let mut file = tempfile::Builder::new()
            .suffix(self.ending)
            .tempfile()
            .expect("a file");
        file.write_all(bytes).expect("written");
        let begin = Instant::now();
        let log = read_log(file.path(), &self.map);
        let _ = list_recording(file.path());
        assert!(
            begin.elapsed() < LONGEST,
            "{} took {:?}",
            self.ending,
            begin.elapsed()
        );
        log.is_ok()
    }
}

/// The recordings that are damaged here.
static RECORDINGS: LazyLock<Vec<Sound>> = LazyLock::new(recordings);

fn recordings() -> Vec<Sound> {
    let golden = |bytes: &[u8]| {
        Sound::of(
            ".mat",
            bytes.to_vec(),
            ["t", "out.signals(1).values", "m[1]"],
        )
    };
    let scope = Sound {
        map: LogMap {
            time: None,
            ..csv().map
        },
        ..Sound::of(".csv", scope(), ["", "u", "y"])
    };
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(&csv().bytes).expect("memory");
    vec![
        csv(),
        Sound {
            ending: ".csv.gz",
            bytes: packed.finish().expect("memory"),
            ..csv()
        },
        scope,
        Sound::of(".csv", foxglove(), ["receive time", "/u", "/y"]),
        Sound::of(".db3", db3(), ["", "/js:effort[0]", "/js:velocity[0]"]),
        golden(include_bytes!("../../../../tests/golden/matlab5_plain.mat")),
        golden(include_bytes!(
            "../../../../tests/golden/matlab5_packed.mat"
        )),
        golden(include_bytes!(
            "../../../../tests/golden/matlab73_plain.mat"
        )),
        golden(include_bytes!(
            "../../../../tests/golden/matlab73_packed.mat"
        )),
    ]
}

fn csv() -> Sound {
    let row = |k: usize| format!("{},{},{}\n", k as f64 / 100.0, k % 7, k % 5);
    let rows: String = (0..60).map(row).collect();
    Sound::of(
        ".csv",
        format!("t,u,y\n{rows}").into_bytes(),
        ["t", "u", "y"],
    )
}

fn scope() -> Vec<u8> {
    let row = |k: usize| match k {
        0..40 => format!("{k}\t{}\t{k}\t{}\n", k % 7, k % 5),
        _ => format!("{k}\t{}\n", k % 7),
    };
    let rows: String = (0..60).map(row).collect();
    let head = "Name\tx\n\nName\tu\tName\ty\nSampleTime[ms]\t1\tSampleTime[ms]\t1\nUnit\t(None)\tUnit\tV (Voltage)\n\n";
    format!("{head}{rows}EOF\n").into_bytes()
}

fn foxglove() -> Vec<u8> {
    let row = |k: usize| {
        let t = k as f64 / 100.0;
        format!("{t},{t:.9},,/u,{}\n{t},{t:.9},,/y,{}\n", k % 7, k % 5)
    };
    let rows: String = (0..40).map(row).collect();
    format!("elapsed time,receive time,header.stamp,topic,value\n{rows}").into_bytes()
}

fn db3() -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bag.db3");
    let database = Connection::open(&path).expect("a database");
    let tables = "PRAGMA page_size = 1024; PRAGMA synchronous = OFF;
        CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
        CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
        INSERT INTO topics VALUES(1, '/js', 'sensor_msgs/msg/JointState', 'cdr');";
    database.execute_batch(tables).expect("written");
    let mut cdr = CdrWriter::default();
    for k in 1..40_u64 {
        let value = || vec![(k % 7) as f64];
        let message = JointState {
            stamp_ns: 10_000_000 * k,
            position: value(),
            velocity: value(),
            effort: value(),
        };
        message.encode(&["a".into()], &mut cdr);
        let row = (1, 10_000_000 * k as i64, cdr.bytes());
        let insert = "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)";
        database.execute(insert, row).expect("written");
    }
    drop(database);
    std::fs::read(&path).expect("written")
}

#[test]
fn the_recordings_are_sound() {
    for sound in RECORDINGS.iter() {
        assert!(
            sound.replay(&sound.bytes),
            "{} {:?}",
            sound.ending,
            read_log_error(sound)
        );
    }
}

fn read_log_error(sound: &Sound) -> String {
    let mut file = tempfile::Builder::new()
        .suffix(sound.ending)
        .tempfile()
        .expect("a file");
    file.write_all(&sound.bytes).expect("written");
    read_log(file.path(), &sound.map).map_or_else(|error| error.to_string(), |_| String::new())
}

#[test]
fn every_cut_is_read_or_refused() {
    for sound in RECORDINGS.iter() {
        let step = (sound.bytes.len() / 60).max(1);
        for cut in (0..sound.bytes.len()).step_by(step) {
            sound.replay(&sound.bytes[..cut]);
        }
    }
}

/// Wherever a file has a size it may have another one.
#[test]
fn other_sizes_take_no_memory() {
    alone(
        module_path!(),
        "other_sizes_take_no_memory",
        replay_other_sizes,
    );
}

fn replay_other_sizes() {
    let before = address_space();
    for sound in RECORDINGS.iter() {
        let step = (sound.bytes.len() / 120).max(1);
        for place in (0..sound.bytes.len().saturating_sub(8)).step_by(step) {
            for (size, width) in [
                (u64::MAX, 8),
                (1 << 40, 8),
                (0x7fff_fff0, 4),
                (0x4000_0000, 4),
            ] {
                let mut bytes = sound.bytes.clone();
                bytes[place..place + width].copy_from_slice(&size.to_le_bytes()[..width]);
                sound.replay(&bytes);
            }
        }
    }
    if let (Some(before), Some(after)) = (before, address_space()) {
        let taken = after - before;
        assert!(taken < MOST_MEMORY, "{taken} bytes");
    }
}

/// Lines, cells and numbers of any length, and a packed file that unpacks to a thousand times its size.
#[test]
fn tables_without_measure_are_refused() {
    let name = "tables_without_measure_are_refused";
    alone(module_path!(), name, refuse_tables_without_measure);
}

fn refuse_tables_without_measure() {
    let before = address_space();
    let long = |text: &str, count: usize| text.repeat(count);
    for text in [
        long("x", 20 << 20),
        long(",", 1 << 20),
        long("time,", 100_000) + "\n" + &long("1,", 100_000) + "\n",
        format!("t,u,y\n{},1,2\n", long("1", 1 << 20)),
        format!("t,u,y\n0,1,2\n\"{}", long("1,\n", 1 << 20)),
        long("Name\tName\t", 20_000) + "\nSampleTime[ms]\t1\n1\t2\n",
        long("t u y ", 1 << 18),
    ] {
        assert!(!csv().replay(text.as_bytes()));
    }
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(b"t,u,y\n0,1,2\n").expect("memory");
    for _ in 0..256 {
        packed.write_all(&[b'1'; 1 << 20]).expect("memory");
    }
    let packed = packed.finish().expect("memory");
    assert!(packed.len() < 2 << 20);
    assert!(
        !Sound {
            ending: ".csv.gz",
            ..csv()
        }
        .replay(&packed)
    );
    if let (Some(before), Some(after)) = (before, address_space()) {
        let taken = after - before;
        assert!(taken < MOST_MEMORY, "{taken} bytes");
    }
}

/// A database may answer every query with rows without end.
#[test]
fn views_in_place_of_tables_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bag.db3");
    let database = Connection::open(&path).expect("a database");
    let tables = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
        INSERT INTO topics VALUES(1, '/js', 'sensor_msgs/msg/JointState', 'cdr');
        CREATE VIEW messages AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c)
            SELECT x AS id, 1 AS topic_id, x AS timestamp, zeroblob(1000) AS data FROM c;";
    database.execute_batch(tables).expect("written");
    drop(database);
    let bytes = std::fs::read(&path).expect("written");
    let bag = Sound::of(".db3", bytes, ["", "/js:effort[0]", "/js:velocity[0]"]);
    assert!(!bag.replay(&bag.bytes));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn any_flips_are_read_or_refused(which in 0_usize..9, flips in prop::collection::vec((any::<usize>(), 1_u8..), 1..8)) {
        let sound = &RECORDINGS[which];
        let mut bytes = sound.bytes.clone();
        for (place, with) in flips {
            let place = place % bytes.len();
            bytes[place] ^= with;
        }
        sound.replay(&bytes);
    }
}
