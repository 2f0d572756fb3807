//! MAT files of our own writer and of chance.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::log::map::{LogMap, Signal};
use crate::log::mat::level5::HEADER;
use crate::log::read_log;

fn map() -> LogMap {
    let signal = |source: &str| Signal::of(source, "1");
    LogMap {
        sample_time_s: Some(0.1),
        ..LogMap::new(vec![signal("s.u")], vec![signal("y[0]")])
    }
}

fn refused(body: &[u8]) -> String {
    let mut file = tempfile::NamedTempFile::new().expect("a file");
    let mut head = b"MATLAB 5.0 MAT-file".to_vec();
    head.resize(HEADER - 4, b' ');
    head.extend([0, 1, b'I', b'M']);
    file.write_all(&[&head, body].concat()).expect("written");
    let log = read_log(file.path(), &map());
    log.map_or_else(|error| error.to_string(), |_| String::new())
}

/// A tag and data, padded.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn matrix(class: u32, lengths: &[i32], name: &str, rest: &[u8]) -> Vec<u8> {
    let flags: Vec<u8> = [class, 0]
        .iter()
        .flat_map(|part| part.to_le_bytes())
        .collect();
    let lengths: Vec<u8> = lengths
        .iter()
        .flat_map(|length| length.to_le_bytes())
        .collect();
    let parts = [
        element(6, &flags),
        element(5, &lengths),
        element(1, name.as_bytes()),
        rest.to_vec(),
    ];
    element(14, &parts.concat())
}

fn doubles(values: &[f64]) -> Vec<u8> {
    element(
        9,
        &values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect::<Vec<u8>>(),
    )
}

#[test]
fn arrays_and_structs_are_read_and_what_is_neither_is_named() {
    let field = matrix(6, &[3, 1], "", &doubles(&[1.0, 2.0, 3.0]));
    let names = [
        &element(5, &2_i32.to_le_bytes())[..],
        &element(1, b"u\0")[..],
        &field[..],
    ]
    .concat();
    let u = matrix(2, &[1, 1], "s", &names);
    let y = matrix(6, &[3, 2], "y", &doubles(&[4.0, 5.0, 6.0, 7.0, 8.0, 9.0]));
    assert_eq!(refused(&[u.clone(), y].concat()), "");
    let square = matrix(6, &[2, 2], "y", &doubles(&[4.0, 5.0, 6.0, 7.0]));
    assert!(refused(&[u.clone(), square].concat()).contains("two unequal sides"));
    let cell = matrix(1, &[0, 0], "y", &[]);
    assert!(refused(&[u.clone(), cell].concat()).contains("a cell array"));
    let short = matrix(6, &[3, 2], "y", &doubles(&[4.0]));
    assert!(refused(&[u.clone(), short].concat()).contains("cannot be unpacked"));
    let missing = refused(&u);
    assert!(
        missing.contains("no such array") && missing.contains("one of s.u"),
        "{missing}"
    );
    let huge = matrix(6, &[i32::MAX, i32::MAX], "y", &doubles(&[4.0]));
    assert!(refused(&[u, huge].concat()).contains("cannot be unpacked"));
}

proptest::proptest! {
    #[test]
    fn any_bytes_are_refused(bytes: Vec<u8>) {
        assert!(!refused(&bytes).is_empty());
    }

    #[test]
    fn any_cut_and_flip_is_read_or_refused(cut in 0_usize..400, at in 0_usize..400, with: u8) {
        let field = matrix(6, &[3, 1], "", &doubles(&[1.0, 2.0, 3.0]));
        let names = [&element(5, &2_i32.to_le_bytes())[..], &element(1, b"u\0")[..], &field[..]].concat();
        let y = matrix(6, &[3, 2], "y", &doubles(&[4.0, 5.0, 6.0, 7.0, 8.0, 9.0]));
        let mut bytes = [matrix(2, &[1, 1], "s", &names), y].concat();
        bytes.truncate(cut);
        if let Some(byte) = bytes.get_mut(at) {
            *byte ^= with;
        }
        let _ = refused(&bytes);
    }
}

#[test]
fn a_packed_array_whose_checksum_fails_is_not_believed() {
    let packed = |array: &[u8]| {
        let mut pack = ZlibEncoder::new(Vec::new(), Compression::none());
        pack.write_all(array).expect("in memory");
        let data = pack.finish().expect("in memory");
        let mut bytes = [15_u32.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        bytes.extend(data);
        bytes
    };
    let field = matrix(6, &[3, 1], "", &doubles(&[1.0, 2.0, 3.0]));
    let names = [element(5, &2_i32.to_le_bytes()), element(1, b"u\0"), field].concat();
    let u = matrix(2, &[1, 1], "s", &names);
    let numbers = doubles(&[4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
    let y = packed(&matrix(6, &[3, 2], "y", &numbers));
    assert_eq!(refused(&[u.clone(), y.clone()].concat()), "");
    let mut flipped = y;
    let number = flipped.len() - 7; // a byte of the last number, before the checksum
    flipped[number] ^= 1;
    let text = refused(&[u, flipped].concat());
    assert!(text.contains("cannot be unpacked"), "{text}");
}
