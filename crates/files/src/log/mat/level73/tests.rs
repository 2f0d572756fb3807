//! MAT files v7.3 as MATLAB lays them out, by h5py (`tests/clients/matlab73.py`), whole and damaged.

use std::path::PathBuf;

use hdf5_pure::FileBuilder;

use crate::error::FileError;
use crate::log::listing::list_recording;
use crate::log::map::{LogMap, Signal};
use crate::log::{Log, read_log};

const PLAIN: &[u8] = include_bytes!("../../../../../../tests/golden/matlab73_plain.mat");
const PACKED: &[u8] = include_bytes!("../../../../../../tests/golden/matlab73_packed.mat");
const TEXT: &[u8] = b"MATLAB 7.3 MAT-file, by hand";

fn map(u: &str, y: &str, time: &str) -> LogMap {
    LogMap {
        time: Some(Signal::of(time, "s")),
        ..LogMap::new(vec![Signal::of(u, "1")], vec![Signal::of(y, "1")])
    }
}

fn read(bytes: &[u8], map: &LogMap) -> Result<Log, FileError> {
    let (_folder, path) = file(bytes);
    read_log(&path, map)
}

fn file(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("log.mat");
    std::fs::write(&path, bytes).expect("written");
    (folder, path)
}

fn refused(bytes: &[u8], map: &LogMap) -> String {
    read(bytes, map).expect_err("refused").to_string()
}

/// The bytes of a file behind MATLAB's text.
fn behind_text(mut builder: FileBuilder) -> Vec<u8> {
    builder.with_userblock(512);
    let mut bytes = builder.finish().expect("written");
    bytes[..TEXT.len()].copy_from_slice(TEXT);
    bytes
}

#[test]
fn arrays_structs_and_arrays_of_structs_are_read() {
    for bytes in [PLAIN, PACKED] {
        for (u, y, time) in [
            ("out.signals(1).values", "out.signals(2).values", "t"),
            ("out.signals(1).values", "m[1]", "out.time"),
            ("n", "m[0]", "t"),
        ] {
            let log = read(bytes, &map(u, y, time)).unwrap_or_else(|error| panic!("{u}: {error}"));
            assert_eq!(log.record.n_samples(), 12, "{u}");
            assert!((log.record.sample_time_s - 1e-3).abs() < 1e-12, "{u}");
            for k in 0..12 {
                let value = k as f64;
                let of = |source: &str| match source {
                    "n" => value,
                    "m[0]" => value + 0.5,
                    "m[1]" => 10.0 * value,
                    "out.signals(1).values" => value - 3.0,
                    _ => value / 4.0,
                };
                assert_eq!(log.record.u[[0, k]], of(u), "{u}");
                assert_eq!(log.record.y[[0, k]], of(y), "{y}");
            }
        }
    }
}

#[test]
fn what_holds_no_numbers_is_named_with_the_way_out() {
    for (source, said) in [
        ("ts", "save('log.mat', 't', 'v', '-v7')"),
        ("note", "a text"),
        ("c", "a cell array"),
        ("z", "complex numbers"),
        ("none", "nothing"),
        ("out", "out.signals(1).values, out.signals(2).values"),
        ("out.signals.values", "no such array"),
        ("m", "channel"),
        ("#refs#", "one of"),
        ("nothing", "one of"),
    ] {
        for bytes in [PLAIN, PACKED] {
            let told = refused(bytes, &map("n", source, "t"));
            assert!(told.contains(said), "{source}: {told}");
            assert!(!told.contains("#subsystem#"), "{told}");
        }
    }
}

#[test]
fn every_array_is_listed() {
    for bytes in [PLAIN, PACKED] {
        let (_folder, path) = file(bytes);
        let listing = list_recording(&path).expect("arrays");
        let signals = listing.groups.iter().flat_map(|group| &group.signals);
        let sources: Vec<&str> = signals.map(|signal| signal.source.as_str()).collect();
        // not the struct that holds itself, whose listing has no end
        assert_eq!(
            sources,
            [
                "m[0]",
                "m[1]",
                "n",
                "t",
                "out.time",
                "out.signals(1).values",
                "out.signals(2).values"
            ]
        );
    }
}

#[test]
fn an_array_that_is_not_in_the_file_takes_no_memory() {
    let mut builder = FileBuilder::new();
    builder.create_dataset("t").with_f64_data(&[0.0, 1.0, 2.0]);
    builder.create_dataset("u").with_f64_data(&[1.0, 2.0, 7.0]);
    let sound = behind_text(builder);
    let map = map("u", "u", "t");
    let log = read(&sound, &map).expect("read");
    assert_eq!(log.record.u[[0, 2]], 7.0);
    // the side of the arrays, wherever it is declared
    let side = 3_u64.to_le_bytes();
    let places: Vec<usize> = (0..sound.len() - 8)
        .filter(|&place| sound[place..].starts_with(&side))
        .collect();
    assert!(!places.is_empty());
    for place in places {
        for huge in [1_u64 << 20, 1 << 40, u64::MAX] {
            let mut bytes = sound.clone();
            bytes[place..place + 8].copy_from_slice(&huge.to_le_bytes());
            let told = refused(&bytes, &map);
            assert!(told.contains("undamaged MAT file"), "{told}");
        }
    }
}

#[test]
fn a_struct_that_holds_itself_ends() {
    let told = refused(PLAIN, &map("loop.values", "n", "t"));
    assert!(told.contains("nested more than 16 deep"), "{told}");
}

#[test]
fn every_cut_is_refused() {
    let map = map("out.signals(1).values", "out.signals(2).values", "t");
    for bytes in [PLAIN, PACKED] {
        for cut in (0..bytes.len() - 1).step_by(211) {
            assert!(!refused(&bytes[..cut], &map).is_empty(), "{cut}");
        }
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(500))]

    #[test]
    fn any_flips_are_read_or_refused(flips in proptest::collection::vec((512_usize..13_000, 0_u8..), 1..6), is_packed: bool) {
        let mut bytes = if is_packed { PACKED } else { PLAIN }.to_vec();
        for (place, with) in flips {
            bytes[place] ^= with;
        }
        let _ = read(&bytes, &map("out.signals(1).values", "m[1]", "t"));
    }
}
