//! Opening of a file that should be an MCAP; anything else is named, with the tool that converts it.

use std::fs::File;
use std::io::{BufReader, Seek};
use std::path::Path;

use crate::error::FileError;
use crate::file_kind::{first_bytes, kind_of};

/// Opens an MCAP for reading.
///
/// # Errors
/// [`FileError::Io`], or [`FileError::Format`] naming what the file is instead.
pub(crate) fn open_mcap(path: &Path) -> Result<BufReader<File>, FileError> {
    let failed = FileError::cannot("open", path);
    let mut file = BufReader::with_capacity(1 << 16, File::open(path).map_err(failed)?);
    let start = first_bytes(&mut file).map_err(failed)?;
    file.rewind().map_err(failed)?;
    if start.starts_with(mcap::MAGIC) {
        return Ok(file);
    }
    let (found, advice) = other_kind(&start);
    Err(FileError::format(path, found, "an MCAP file", advice))
}

/// What a file is that does not begin as an MCAP does, and what to do with it.
fn other_kind(start: &[u8]) -> (&'static str, &'static str) {
    if !start.is_empty() && mcap::MAGIC.starts_with(start) {
        return ("the first bytes of an MCAP", "the rest is lost");
    }
    kind_of(start).unwrap_or(("an unknown kind of file", "give an .mcap file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_named_with_the_tool_that_converts_them() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("x");
        for (start, named) in [
            (&b"SQLite format 3\0..."[..], "ros2 bag convert"),
            (&[0x28, 0xb5, 0x2f, 0xfd, 0], "zstd -d"),
            (b"#ROSBAG V2.0\n", "ROS 1"),
            (b"", "empty"),
            (&mcap::MAGIC[..5], "the rest is lost"),
            (b"time,u,y\n", "unknown"),
        ] {
            std::fs::write(&path, start).expect("written");
            let error = open_mcap(&path).expect_err("not an MCAP").to_string();
            assert!(error.contains(named), "{error}");
        }
        assert!(matches!(
            open_mcap(&folder.path().join("none")),
            Err(FileError::Io { .. })
        ));
    }
}
