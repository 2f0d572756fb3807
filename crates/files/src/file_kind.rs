//! Kinds of files that frfid does not read, by their first bytes.

use std::io::{self, Read};

/// First bytes, what the file is, and what to do.
const KINDS: [(&[u8], &str, &str); 6] = [
    (
        b"MATLAB 5.0 MAT-file",
        "a MATLAB file",
        "export the signals to CSV or MCAP",
    ),
    (
        b"SQLite format 3\0",
        "a rosbag2 .db3 file",
        "convert it: ros2 bag convert, or rosbags-convert --dst-storage mcap",
    ),
    (
        &[0x28, 0xb5, 0x2f, 0xfd],
        "a zstd-compressed file",
        "unpack it first: zstd -d FILE.mcap.zstd",
    ),
    (
        b"#ROSBAG V2.0",
        "a ROS 1 bag",
        "convert it: mcap convert, or rosbags-convert",
    ),
    (
        &[0x1f, 0x8b],
        "a gzip-compressed file",
        "unpack it first: gunzip FILE",
    ),
    (
        b"\x89HDF",
        "an HDF5 or MATLAB v7.3 file",
        "export the signals to CSV or MCAP",
    ),
];

/// As many bytes of the start of a file as its kind needs.
pub(crate) fn first_bytes(file: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    file.take(32).read_to_end(&mut start)?;
    Ok(start)
}

/// What the file is and what to do with it, by its first bytes; `None` if they say nothing.
pub(crate) fn kind_of(start: &[u8]) -> Option<(&'static str, &'static str)> {
    if start.is_empty() {
        return Some(("an empty file", "its writer did not get to write anything"));
    }
    let kind = KINDS.iter().find(|(magic, ..)| start.starts_with(magic));
    kind.map(|&(_, found, advice)| (found, advice))
}
