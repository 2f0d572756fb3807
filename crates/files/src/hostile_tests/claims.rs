//! Files that claim, or unpack to, far more than they are long: refused by number, before the memory is taken.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use mcap::WriteOptions;
use npyz::WriterBuilder;
use npyz::npz::NpzWriter;
use npyz::zip::{CompressionMethod, write::FileOptions};
use tempfile::{TempDir, tempdir};

use crate::error::FileError;
use crate::hostile_tests::alone::{address_space, alone};
use crate::log::map::{LogMap, Signal};
use crate::log::read_log;
use crate::mcap::read::{Part, scan};
use crate::mcap::write::RosWriter;
use crate::run::header;
use crate::run::read::read_run;
use crate::run::tests::run;
use crate::run::write::structure_of;

/// None of these files may take more address space.
const MOST_MEMORY: u64 = 400 << 20;

fn file(name: &str, bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("written");
    (folder, path)
}

fn map() -> LogMap {
    LogMap {
        sample_time_s: Some(0.001),
        ..LogMap::new(vec![Signal::of("u", "1")], vec![Signal::of("y", "1")])
    }
}

/// An NPZ whose array `u` is 80 MB of zeros.
fn packed_array() -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut npz = NpzWriter::new(&mut file);
    let options = FileOptions::default().compression_method(CompressionMethod::Deflated);
    let array = npz.array("u", options).expect("memory");
    let mut writer = array
        .default_dtype()
        .shape(&[10_000_000])
        .begin_nd()
        .expect("memory");
    writer
        .extend(std::iter::repeat_n(0.0_f64, 10_000_000))
        .expect("memory");
    writer.finish().expect("memory");
    npz.zip_writer().finish().expect("memory");
    drop(npz);
    file.into_inner()
}

/// A gzipped table of 80 MB, of comments for the most part.
fn packed_table() -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed
        .write_all(b"u,y\n1.25,2.5\n2.5,1.25\n")
        .expect("memory");
    let comment = format!("# {}\n", "-".repeat(1 << 20));
    for _ in 0..80 {
        packed.write_all(comment.as_bytes()).expect("memory");
    }
    packed.finish().expect("memory")
}

/// A run of ours that says it has 2^26 samples and has none.
fn empty_run() -> Vec<u8> {
    let mut structure = structure_of(&run(10));
    structure.n_samples = 1 << 26;
    let mut file = Vec::new();
    let mut writer = RosWriter::new(&mut file).expect("memory");
    header::write(&mut writer, &BTreeMap::new(), (header::RUN, &structure), "").expect("memory");
    writer.finish().expect("memory");
    file
}

#[test]
fn what_a_file_claims_takes_no_memory() {
    alone(module_path!(), "what_a_file_claims_takes_no_memory", || {
        let refused = [
            ("a.npz", packed_array(), "array u would take 80.0 MB"),
            ("a.csv.gz", packed_table(), "its text would take 6"),
        ];
        let before = address_space();
        for (name, bytes, told) in refused {
            let (_folder, path) = file(name, &bytes);
            let error = read_log(&path, &map()).expect_err(name);
            assert!(matches!(error, FileError::TooLarge { .. }), "{error}");
            assert!(error.to_string().contains(told), "{error}");
        }
        let (_folder, path) = file("a.mcap", &empty_run());
        let error = read_run(&path).expect_err("no samples");
        assert!(error.to_string().contains("would take 4.3 GB"), "{error}");
        if let (Some(before), Some(after)) = (before, address_space()) {
            assert!(after - before < MOST_MEMORY, "{} bytes", after - before);
        }
    });
}

/// What is told of an MCAP.
fn damages(bytes: &[u8]) -> Vec<String> {
    let ignore = &mut |_: crate::mcap::chunk::Entry| Ok(());
    let damages = scan(Cursor::new(bytes), Path::new("x.mcap"), Part::All, ignore);
    let damages = damages.expect("readable").into_iter();
    damages.map(|damage| damage.reason).collect()
}

#[test]
fn schemas_and_chunks_of_an_mcap_are_bounded() {
    let with = |options: WriteOptions, schema: &[u8], message: &[u8]| {
        let mut file = Cursor::new(Vec::new());
        let mut writer = options.create(&mut file).expect("memory");
        let schema = writer
            .add_schema("a/msg/B", "ros2msg", schema)
            .expect("memory");
        let channel = writer
            .add_channel(schema, "/b", "cdr", &BTreeMap::new())
            .expect("memory");
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: 1,
            publish_time: 1,
        };
        writer
            .write_to_known_channel(&header, message)
            .expect("memory");
        writer.finish().expect("memory");
        drop(writer);
        file.into_inner()
    };
    let whole = || WriteOptions::new().chunk_size(None);
    let sound = with(whole(), b"float64 x\n", &[0; 12]);
    assert_eq!(damages(&sound), [""; 0]);
    for options in [whole().use_chunks(false), whole()] {
        let told = damages(&with(options, &vec![b'#'; 2 << 20], &[0; 12])).join("\n");
        assert!(
            told.contains("no message type needs more than 1048576"),
            "{told}"
        );
    }
    let zeros = vec![0; 65 << 20];
    let told = damages(&with(whole(), b"float64 x\n", &zeros)).join("\n");
    assert!(told.contains("the limit is 67108864"), "{told}");
}
