//! Tests of exported plans: every format, read back as far as this crate reads it.

use std::path::Path;

use frfid_signals::Playback;

use crate::atomic_write::Overwrite;
use crate::error::FileError;
use crate::mcap::chunk::Entry;
use crate::mcap::read::{Part, scan_file};
use crate::playback::formats::{PLAY_FORMATS, PlayFormat};
use crate::playback::order::{OrderEntry, write_order};
use crate::playback::testing::{file, motion, torque};
use crate::playback::{PlaybackFile, signals};
use crate::ros::cdr_read::CdrReader;

fn written(name: &str, file: &PlaybackFile) -> tempfile::NamedTempFile {
    let target = tempfile::NamedTempFile::new().expect("a temporary file");
    let format = PlayFormat::named(name).expect("a format");
    (format.write)(target.path(), Overwrite::Replace, file).expect("sound");
    target
}

/// Topic, time and content of every message.
fn messages(path: &Path) -> Vec<(String, u64, Vec<u8>)> {
    let mut found = Vec::new();
    let damages = scan_file(path, Part::All, &mut |entry| {
        if let Entry::Message {
            channel, message, ..
        } = entry
        {
            let data = message.data.to_vec();
            found.push((channel.topic.clone(), message.log_time_ns, data));
        }
        Ok(())
    });
    assert!(damages.expect("readable").is_empty());
    found
}

#[test]
fn every_format_has_a_name_of_its_own_and_keeps_what_exists() {
    for (place, format) in PLAY_FORMATS.iter().enumerate() {
        let named = PlayFormat::named(format.name).expect("it is in the table");
        assert!(named.name == format.name && !format.describes.is_empty());
        assert!(
            PLAY_FORMATS[..place]
                .iter()
                .all(|other| other.name != format.name)
        );
        let target = tempfile::NamedTempFile::new().expect("a temporary file");
        let kept = (format.write)(target.path(), Overwrite::Refuse, &file(vec![motion(2)]));
        assert!(matches!(kept, Err(FileError::Exists { .. })));
    }
    assert_eq!(
        PlayFormat::of_suffix(Path::new("a.MAT")).map(|found| found.name),
        Some("mat")
    );
    assert!(PlayFormat::of_suffix(Path::new("folder")).is_none());
    let unknown = PlayFormat::named("npz")
        .expect_err("of results")
        .to_string();
    assert!(
        unknown.contains("csv, mat, joint-trajectory, float64-array"),
        "{unknown}"
    );
}

#[test]
fn a_message_for_each_sample_and_an_event_for_each_run() {
    let run = motion(3);
    let target = written("float64-array", &file(vec![run.clone(), run.clone()]));
    let found = messages(target.path());
    let of =
        |topic: &str| -> Vec<_> { found.iter().filter(|message| message.0 == topic).collect() };
    let (events, commands) = (of("/frfid/events"), of("/commands"));
    assert_eq!((events.len(), commands.len()), (2, 6));
    let text = String::from_utf8_lossy(&events[1].2);
    assert!(text.contains("p000-m0-q1") && text.contains("\"k\":3") && text.contains("3735928559"));
    assert_eq!((events[1].1, commands[3].1), (1_006_000_000, 1_006_000_000));
    for (k, (_, _, data)) in commands.iter().enumerate() {
        assert_eq!(values(data), signals(&run)[1].column(k % 3).to_vec());
    }
}

fn values(message: &[u8]) -> Vec<f64> {
    let mut cdr = CdrReader::new(message).expect("a message");
    let dim_and_offset = (cdr.u32(), cdr.u32());
    assert_eq!(dim_and_offset, (Ok(0), Ok(0)));
    cdr.f64s().expect("values")
}

#[test]
fn torques_are_commanded_where_there_is_no_velocity() {
    let run = torque(2);
    let target = written("float64-array", &file(vec![run.clone()]));
    let found = messages(target.path());
    assert_eq!(values(&found[2].2), signals(&run)[0].column(1).to_vec());
}

#[test]
fn a_trajectory_is_one_message_that_names_run_and_plan() {
    let found = messages(written("joint-trajectory", &file(vec![motion(3), motion(3)])).path());
    assert_eq!(found.len(), 2, "one event, one trajectory");
    let mut cdr = CdrReader::new(&found[1].2).expect("a message");
    assert_eq!((cdr.u32(), cdr.u32()), (Ok(0), Ok(0)));
    assert_eq!(cdr.text(), Ok("frfid p000-m0-q0 3735928559"));
    assert_eq!(cdr.texts(), Ok(vec!["a", "b,\"2\""]));
    assert_eq!(cdr.u32(), Ok(6));
}

#[test]
fn a_mat_begins_with_what_simulink_takes() {
    let target = written("mat", &file(vec![motion(3)]));
    let bytes = std::fs::read(target.path()).expect("written");
    let place = |name: &[u8]| bytes.windows(name.len()).position(|window| window == name);
    let names = [
        "from_file",
        "table",
        "time",
        "position",
        "columns",
        "plan_id",
        "run",
    ];
    let places = names.map(|name| place(name.as_bytes()).expect(name));
    assert!(places[0] < 200 && places.is_sorted(), "{places:?}");
}

#[test]
fn the_order_of_play_is_a_table() {
    let entry = OrderEntry {
        run: "p000-m0-q0".into(),
        n_repetitions: 2,
        file: "campaign.csv".into(),
        first_k: 10,
        n_samples: 5,
        run_first_k: 1,
        run_samples: 3,
        duration_s: 0.01,
        plan_id: 7,
    };
    let target = tempfile::NamedTempFile::new().expect("a temporary file");
    write_order(target.path(), Overwrite::Replace, &[entry]).expect("written");
    let text = std::fs::read_to_string(target.path()).expect("readable");
    let row = text.lines().nth(1);
    assert_eq!(row, Some("1,p000-m0-q0,2,campaign.csv,10,5,1,3,0.01,7"));
}

#[test]
fn more_numbers_than_a_file_should_hold_are_refused() {
    let run = motion(1 << 12);
    let many = file(vec![run; 1 << 15]);
    let refused = many.check().expect_err("2^27 samples").to_string();
    assert!(
        refused.contains("a file for each run, or a lower rate"),
        "{refused}"
    );
    let n: usize = many
        .playbacks
        .iter()
        .map(|run: &std::sync::Arc<Playback>| run.n_samples())
        .sum();
    assert_eq!((n, many.duration_s()), (many.n_samples(), n as f64 / 500.0));
}
