//! Kinds of files that frfid does not read, or not everywhere, by their first bytes.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::error::FileError;

/// From MATLAB to a file with something in it.
const MAT_ADVICE: &str = "save arrays of numbers: in MATLAB save('log.mat', 't', 'u', 'y'), or writetable(table(t, u, y), 'log.csv')";

/// First bytes, what the file is, and what to do.
const KINDS: [(&[u8], &str, &str); 7] = [
    (
        b"SQLite format 3\0",
        "a rosbag2 .db3 file",
        "frfid estimate reads it with a log map (--map); as MCAP: ros2 bag convert, or rosbags-convert --dst-storage mcap",
    ),
    (b"MATLAB 5.0 MAT-file", "a MATLAB file (MAT v5)", MAT_ADVICE),
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
        b"MATLAB 7.3 MAT-file",
        "a MATLAB file (MAT v7.3)",
        MAT_ADVICE,
    ),
    (
        b"\x89HDF",
        "an HDF5 file",
        "save its arrays as NPZ: numpy.savez('log.npz', t=.., u=.., y=..)",
    ),
];

/// As many bytes of the start of a file as its kind needs.
pub(crate) fn first_bytes(file: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    file.take(32).read_to_end(&mut start)?;
    Ok(start)
}

/// The first bytes of a file of this name.
pub(crate) fn start_of(path: &Path) -> Result<Vec<u8>, FileError> {
    let read = || first_bytes(&mut File::open(path)?);
    read().map_err(FileError::cannot("open", path))
}

/// What the file is and what to do with it, by its first bytes; `None` if they say nothing.
pub(crate) fn kind_of(start: &[u8]) -> Option<(&'static str, &'static str)> {
    if start.is_empty() {
        return Some(("an empty file", "its writer did not get to write anything"));
    }
    let kind = KINDS.iter().find(|(magic, ..)| start.starts_with(magic));
    kind.map(|&(_, found, advice)| (found, advice))
}
